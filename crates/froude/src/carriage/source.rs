//! Runs as a source of a campaign: each method that reduces them gives its observations, its fit and its estimate.

use std::path::Path;

use froude_identify::IdentifyError;
use froude_identify::carriage::coefficient::{Coefficient, Method};
use froude_identify::carriage::report::recommended;
use froude_identify::selection::{Recommendation, leave_one_out};
use froude_identify::source::SourceResult;
use froude_records::campaign::Source;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::nearest::meant;

use super::drag::{KINDS, Reduction, reduce};
use super::runs::read;
use crate::Error;

/// Reduces the runs of a source by its methods: a result for each, in the order asked for.
///
/// # Errors
///
/// A method that there is not, runs that cannot be read, or none that any of the methods can use.
pub(crate) fn identify(source: &Source, folder: &Path, progress: &dyn Fn(&str)) -> Result<Vec<SourceResult>, Error> {
    let methods = methods(source)?;
    progress("reading the runs");
    let Reduction { runs, mut report, .. } = reduce(read(&[folder.to_owned()], &KINDS, None)?)?;
    let files: Vec<_> = runs.logs.iter().map(|log| log.path.clone()).collect();
    // What is said of a method that nobody asked for is none of this source's.
    let is_asked = |finding: &Finding| {
        let others = Method::ALL.into_iter().filter(|method| !methods.contains(method));
        others.map(Method::name).all(|name| !finding.message.starts_with(&format!("{name}: ")))
    };
    report.findings.retain(is_asked);
    let mut out = Vec::new();
    let fitted = std::mem::take(&mut report.coefficients).into_iter().zip(std::mem::take(&mut report.estimates));
    let mut fitted: Vec<(Coefficient, Estimate)> = fitted.collect();
    // One of the methods that were asked for.
    let chosen = recommended(fitted.iter().map(|(coefficient, _)| coefficient).filter(|c| methods.contains(&c.method)));
    for &method in &methods {
        let Some(i) = fitted.iter().position(|(coefficient, _)| coefficient.method == method) else {
            // Whoever names no method gets those that the runs allow.
            if !source.methods.is_empty() {
                let text = format!("{}: these runs do not give what it needs ({})", method.name(), method.words());
                report.findings.push(Finding::new(Severity::Warning, "not-fitted", text));
            }
            continue;
        };
        let (coefficient, estimate) = fitted.swap_remove(i);
        let estimate = Estimate { recommended: chosen == Some(method), ..estimate };
        out.push(result(source, coefficient, estimate, runs.logs.len()));
    }
    if runs.campaign.is_none() {
        report.findings.push(Finding::new(
            Severity::Warning,
            "no-campaign-of-runs",
            format!(
                "{}: no copy of their campaign lies with the runs: fresh water at 20 degC is taken, no area, and of the rig what the runs say",
                folder.display()
            ),
        ));
    }
    let Some(first) = out.first_mut() else {
        let why: String = report.findings.iter().map(|finding| format!("; {}", finding.message)).collect();
        return Err(Error::Nothing(format!(
            "{}: none of the methods asked for can use these runs{why}",
            folder.display()
        )));
    };
    first.findings = report.findings.into_iter().map(|finding| finding.of_source(&source.name)).collect();
    first.files = files;
    Ok(out)
}

/// The methods that a source asks for; all of them where it asks for none.
fn methods(source: &Source) -> Result<Vec<Method>, Error> {
    if source.methods.is_empty() {
        return Ok(Method::ALL.to_vec());
    }
    let of = |(i, name): (usize, &String)| {
        Method::ALL.into_iter().find(|method| method.name() == name).ok_or_else(|| {
            let known = Method::ALL.map(Method::name);
            let advice = meant(name, known).unwrap_or_else(|| format!("there are {}", known.join(", ")));
            let place = source.method_places.get(i).map_or_else(String::new, ToString::to_string);
            Error::Identify(IdentifyError::Campaign { place, what: format!("method {name:?} is not known; {advice}") })
        })
    };
    let methods: Vec<Method> = source.methods.iter().enumerate().map(of).collect::<Result<_, Error>>()?;
    match (1..methods.len()).find(|&i| methods[..i].contains(&methods[i])) {
        None => Ok(methods),
        Some(i) => {
            let place = source.method_places.get(i).map_or_else(String::new, ToString::to_string);
            let what = format!("method {:?} is named twice", methods[i].name());
            Err(Error::Identify(IdentifyError::Campaign { place, what }))
        }
    }
}

fn result(source: &Source, coefficient: Coefficient, estimate: Estimate, n_read: usize) -> SourceResult {
    let Coefficient { method, model, data, .. } = coefficient;
    let estimate = Estimate {
        id: format!("{}/{}", source.name, method.name()),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        ..estimate
    };
    SourceResult {
        name: format!("{}, {}", source.name, method.name()),
        kind: source.kind,
        n_read,
        not_fitted: Vec::new(),
        tests: Vec::new(),
        scores: vec![leave_one_out(&model, &data)],
        blocks: Vec::new(),
        recommendation: Some(Recommendation { index: 0, reason: method.words().to_owned() }),
        validity: estimate.validity.clone(),
        findings: Vec::new(),
        files: Vec::new(),
        models: vec![model],
        estimates: vec![estimate],
        data,
    }
}
