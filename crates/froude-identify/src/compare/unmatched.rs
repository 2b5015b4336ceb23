//! What was not compared, and why.

use std::collections::BTreeSet;

use froude_records::comparison::Comparison;
use froude_records::finding::{Finding, Severity};

use super::MOST_COMPARED;
use super::independence::{has_likes, is_one_source};
use super::prediction::gives_no_load;
use crate::compare::named::Named;

/// Estimates named where nothing could be compared.
const MOST_NAMED: usize = 6;

/// That no two estimates have anything in common, and what each has: for a command that asks for a comparison only.
#[must_use]
pub fn nothing_compared(all: &[Named<'_>], out: &Comparison) -> Option<Finding> {
    let is_said = out.findings.iter().any(|f| matches!(f.code.as_str(), "no-common-range" | "not-compared"));
    if is_said || !out.is_empty() {
        return None;
    }
    let each = all.iter().map(|n| {
        let estimate = n.estimate;
        let loads: Vec<&str> = estimate.law.outputs.keys().map(String::as_str).collect();
        let law = if loads.is_empty() { "no formula".to_owned() } else { loads.join(", ") };
        let why = gives_no_load(estimate).map_or_else(String::new, |why| format!("; predicts no load: {why}"));
        format!("{} ({}; {law}{why})", estimate.id, estimate.law.name)
    });
    let each: Vec<String> = each.take(MOST_NAMED).collect();
    let more = if all.len() > MOST_NAMED { format!(" and {} more", all.len() - MOST_NAMED) } else { String::new() };
    Some(Finding::new(
        Severity::Warning,
        "nothing-compared",
        format!(
            "nothing could be compared: no two estimates have the same model, and fewer than two give loads over a common range of \
             speed; there are {}{more}",
            each.join(", ")
        ),
    ))
}

/// Which estimates are compared with no other, and why: for a command that asks for a comparison only.
#[must_use]
pub fn left_out(all: &[Named<'_>], out: &Comparison) -> Option<Finding> {
    let of_rows = out.coefficients.iter().flat_map(|row| [&row.first, &row.second]);
    let of_loads = out.loads.iter().flat_map(|row| [&row.first, &row.second]);
    let seen: BTreeSet<&str> = of_rows.chain(of_loads).map(|side| side.source.as_str()).collect();
    let is_seen = |n: &&Named<'_>| {
        let id = &n.estimate.id;
        seen.contains(id.as_str()) || seen.contains(format!("{id} ({})", n.file).as_str())
    };
    let why = |n: &Named<'_>| {
        let is_alike = |other: &&Named<'_>| other.estimate.law.name == n.estimate.law.name && !is_one_source(n, other);
        let alike: Vec<&Named<'_>> = all.iter().filter(is_alike).collect();
        let why = match alike.len() {
            1.. if alike.iter().any(|other| !has_likes(all, n, other)) => {
                "the other sources' estimates by its model have no coefficient in common with it"
            }
            1.. => "its method is compared with its own kind only",
            0 => match gives_no_load(n.estimate) {
                Some(why) => &format!("no other source has its model, and it predicts no load: {why}"),
                None if !n.estimate.validity.contains_key("speed") => {
                    "no other source has its model, and it states no range of speed for its loads"
                }
                None if !n.estimate.recommended => {
                    "no other source has its model, and loads are compared for recommended models only"
                }
                None => "no other source has its model, and none gives loads over a range of speed that it shares",
            },
        };
        format!("{} ({}): {why}", n.estimate.id, n.estimate.law.name)
    };
    let alone: Vec<String> = all.iter().filter(|n| !is_seen(n)).map(why).collect();
    if alone.is_empty() || out.is_empty() {
        return None;
    }
    let more = alone.len().saturating_sub(MOST_NAMED);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    let alone: Vec<String> = alone.into_iter().take(MOST_NAMED).collect();
    Some(Finding::new(Severity::Note, "beside-no-other", format!("compared with no other: {}{more}", alone.join("; "))))
}

/// Why so many estimates are not compared.
#[must_use]
pub fn too_many(estimates: usize) -> String {
    format!(
        "{estimates} estimates are not compared: at most {MOST_COMPARED} are; name fewer records, or fewer models in them"
    )
}
