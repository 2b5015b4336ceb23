//! What the sources of a campaign ask for, taken together.

use std::collections::BTreeSet;

use froude_records::campaign::{Campaign, Identify, Input, Source};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::nearest::meant;

use crate::error::IdentifyError;
use crate::source::asked_models;

/// Refuses the same runs in two sources: readings of one current would be compared as if they were independent.
///
/// # Errors
///
/// Two sources name one folder.
pub fn runs_once(campaign: &Campaign) -> Result<(), IdentifyError> {
    let folder = |source: &Source| {
        let path = source.input.path();
        let is_runs = matches!(source.input, Input::Runs { .. });
        is_runs.then(|| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()))
    };
    for (i, b) in campaign.sources.iter().enumerate() {
        if let Some(a) = campaign.sources[..i].iter().find(|a| folder(a).is_some() && folder(a) == folder(b)) {
            let what =
                format!("{} and {} name the same runs; name them once, with all methods in `method`", a.name, b.name);
            return Err(IdentifyError::Campaign { place: b.place.to_string(), what });
        }
    }
    Ok(())
}

/// What `[identify]` says of a coefficient that none of the laws has: where, and in words. A slip of the keyboard would leave free what is meant to be held.
pub fn held_by_no_law<'a>(identify: &Identify, estimates: impl Iterator<Item = &'a Estimate>) -> Option<[String; 2]> {
    let names: BTreeSet<&str> =
        estimates.flat_map(|estimate| estimate.coefficients.keys()).map(String::as_str).collect();
    let stated = [("prior", &identify.prior), ("known", &identify.known)];
    let stated = stated.into_iter().flat_map(|(key, list)| list.iter().map(move |one| (key, &one.coefficient)));
    let fixed = identify.fixed.keys().map(|name| ("fixed", name));
    let excluded = identify.exclude.iter().map(|name| ("exclude", name));
    let (key, name) = stated.chain(fixed).chain(excluded).find(|(_, name)| !names.contains(name.as_str()))?;
    let known = names.iter().copied();
    let advice =
        meant(name, known.clone()).unwrap_or_else(|| format!("they have {}", known.collect::<Vec<_>>().join(", ")));
    let stated = identify.stated_units.iter().find(|stated| stated.coefficient == *name);
    let place = stated.map_or_else(|| "[identify]".to_owned(), |stated| stated.place.to_string());
    Some([place, format!("`{key}` names {name:?}, a coefficient of none of the laws that were fitted; {advice}")])
}

/// Laws of a person that no source is fitted with: a source that names its models is fitted with these alone.
#[must_use]
pub fn laws_not_asked(campaign: &Campaign) -> Option<Finding> {
    let tables: Vec<_> = campaign.sources.iter().filter(|s| matches!(s.input, Input::Table(_))).collect();
    let asked: Vec<String> =
        tables.iter().flat_map(|source| asked_models(campaign, source).unwrap_or_default()).collect();
    let own = campaign.identify.user_models.iter().map(|model| model.name.as_str());
    let left: Vec<&str> = own.filter(|name| !asked.iter().any(|a| a == name)).collect();
    (!left.is_empty() && !tables.is_empty()).then(|| {
        let it = if left.len() == 1 { "it" } else { "them" };
        let text = format!(
            "[[identify.model]] {}: fitted to no source, since each names its models without {it}; add {it} to `models`",
            left.join(", "),
        );
        Finding::new(Severity::Warning, "law-not-asked", text)
    })
}
