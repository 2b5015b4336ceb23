//! Relative or absolute error: what fits assume, and which the residuals support.

use froude_records::number;

use crate::dataset::unit_text;
use crate::regression::ModelFit;
use crate::result::SourceResult;
use crate::unevenness::{FEWEST_FOR_SCATTER, unevenness};

/// AICc differences below this are no evidence.
const NO_EVIDENCE_BELOW: f64 = 2.0;

/// What the fit of logarithms assumes, what the fit in the load's unit assumes, and which the residuals support:
/// a sentence for every load that was fitted both ways.
pub(super) fn error_models(source: &SourceResult) -> Vec<String> {
    let position = |wanted: &dyn Fn(&ModelFit) -> bool| source.models.iter().position(wanted);
    let mut out = Vec::new();
    for (i, logarithmic) in source.models.iter().enumerate().filter(|(_, m)| m.law.in_logarithms()) {
        let Some(load) = logarithmic.law.responses.first() else { continue };
        let is_plain = |m: &ModelFit| !m.law.in_logarithms() && m.law.responses.contains(load);
        // The same law in the load's unit tells the two error models apart best; any other law will do.
        let plain = position(&|m| is_plain(m) && m.law.is_nonlinear()).or_else(|| position(&is_plain));
        let has_std = source.data.channels.contains_key(&format!("std_{load}"));
        let assumes = format!(
            "{}, {load}: {} is fitted to logarithms and assumes every point to have {}",
            source.name,
            logarithmic.law.name,
            if has_std { "the relative error of its std column" } else { "the same relative error" }
        );
        let Some(j) = plain else {
            out.push(format!("{assumes}; no law was fitted in {} to compare it with.", unit_text(&source.data, load)));
            continue;
        };
        let newton = &source.models[j];
        let unit = unit_text(&source.data, load);
        let support = supported(source, (i, logarithmic), (j, newton), load);
        out.push(format!(
            "{assumes}, {} is fitted in {unit} and assumes every point to have {}; {support}.",
            newton.law.name,
            if has_std { "the absolute error of that column" } else { "the same absolute error" }
        ));
    }
    out
}

/// Which of the two error models the residuals support, with the numbers.
fn supported(
    source: &SourceResult,
    (i, logarithmic): (usize, &ModelFit),
    (j, newton): (usize, &ModelFit),
    load: &str,
) -> String {
    let (Some(of_log), Some(of_newton)) =
        (unevenness(logarithmic, &source.data, load), unevenness(newton, &source.data, load))
    else {
        return format!(
            "whether the residuals support one of them is not judged from fewer than {FEWEST_FOR_SCATTER} observations"
        );
    };
    // AICc compares the two only where they explain the same loads; that of the logarithms is carried over.
    let gain = source.estimates[j]
        .diagnostics
        .aicc
        .zip(source.estimates[i].diagnostics.aicc)
        .map(|(n, l)| n - l)
        .filter(|_| newton.law.responses == logarithmic.law.responses);
    let numbers = format!(
        "rank correlation of |residual| with speed {} ({:.1} standard errors) relative, {} ({:.1}) absolute{}",
        number::fixed(of_log.rho, 2),
        of_log.z.abs(),
        number::fixed(of_newton.rho, 2),
        of_newton.z.abs(),
        gain.map_or_else(String::new, |g| format!(
            "; AICc is {:.1} {} for the relative error",
            g.abs(),
            if g > 0.0 { "smaller" } else { "larger" }
        ))
    );
    let favoured = gain.filter(|g| g.abs() > NO_EVIDENCE_BELOW).map(|g| g > 0.0);
    // AICc weighs the whole likelihood; where it does not decide, the scatter alone may.
    let verdict = match (favoured, of_log.contradicts(), of_newton.contradicts()) {
        (Some(true), false, _) | (None, false, true) => "the residuals support the same relative error",
        (Some(false), _, false) | (None, true, false) => "the residuals support the same absolute error",
        (Some(_), ..) => "AICc favours one whose own residuals are uneven: they support neither",
        (None, true, true) => "the residuals support neither",
        (None, false, false) => "the residuals do not distinguish the two",
    };
    format!("{verdict} ({numbers})")
}
