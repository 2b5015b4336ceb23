//! What a fit came to, for the reader of a terminal; a program reads the record.

use froude_records::block::{Block, TableBuilder};
use froude_records::estimate::words;
use froude_records::estimate::{Coefficient, Estimate, Status};
use froude_records::text::counted;

use super::named;
use crate::answer::Answer;
use crate::result::SourceResult;

/// A source: which of its laws is recommended, its coefficients, and what else was fitted.
#[must_use]
pub fn source(answer: &Answer) -> Vec<Block> {
    let head = match answer.observations() {
        0 => answer.name().to_owned(),
        n => format!("{} ({})", answer.name(), counted(n, "observation", "observations")),
    };
    let mut out = vec![Block::words(std::iter::once(head).chain(answer.fitted().map(choice).unwrap_or_default()))];
    // Of several models the recommended one; of a method's only one, that.
    let all = answer.estimates();
    let (shown, others): (Vec<&Estimate>, Vec<&Estimate>) = all.iter().partition(|e| e.recommended || all.len() == 1);
    let mut said = Vec::new();
    for estimate in shown {
        out.push(coefficients(estimate));
        said.extend(estimate.undetermined.iter().map(|what| format!("  determined only together: {what}")));
    }
    out.extend(named::sections(answer).into_iter().map(Block::from));
    let others: Vec<&str> = others.into_iter().map(|e| e.law.name.as_str()).collect();
    if !others.is_empty() {
        said.push(format!("  also fitted: {} (see the report)", others.join(", ")));
    }
    let not_fitted = answer.fitted().into_iter().flat_map(|source| &source.not_fitted);
    said.extend(not_fitted.map(|n| format!("  not fitted: {}: {}", n.model, n.why)));
    out.push(Block::words(said));
    out
}

/// Which of the fitted models, and why.
fn choice(source: &SourceResult) -> Vec<String> {
    let Some(r) = &source.recommendation else { return Vec::new() };
    let is_recommended = source.estimates[r.index].recommended;
    let mut out = vec![format!("  {}: {}", if is_recommended { "recommended" } else { "method" }, r.reason)];
    let note = source.scores[r.index].note.as_ref().filter(|_| source.data.configurations().len() > 1);
    out.extend(note.map(|why| format!("  cross-validation: {why}")));
    out
}

fn coefficients(estimate: &Estimate) -> Block {
    let derived = estimate.derived_coefficients();
    let rows: Vec<(&String, &Coefficient)> = estimate.coefficients.iter().chain(&derived).collect();
    let t = TableBuilder::new("", "", &rows);
    let has_others = estimate.not_contradicted.len() > 1;
    let interval = if has_others { "95 % interval if law is true" } else { "95 % interval" };
    let mut columns = vec![
        t.text("", "coefficient", |(name, _)| (*name).clone()).symbol(),
        t.text("", "value", |(_, c)| words::coefficient(c)),
        t.text("", "unit", |(_, c)| c.unit.clone()),
        t.interval("", interval, |(_, c)| c.interval_95),
    ];
    if has_others {
        columns.push(t.interval("", "range over laws", |(_, c)| c.range_95));
    }
    columns.push(t.number("", "type A", |(_, c)| c.type_a).significant(2));
    columns.push(t.number("", "type B", |(_, c)| c.type_b).significant(2));
    let is_derived = |name: &String| derived.contains_key(name) && !estimate.coefficients.contains_key(name);
    let in_words = |name: &String, c: &Coefficient| if is_derived(name) { "derived" } else { status(c.status) };
    columns.push(t.text("", "status", |(name, c)| in_words(name, c).to_owned()));
    t.build(columns).into()
}

/// A status in words; none where it is free.
#[must_use]
pub const fn status(status: Status) -> &'static str {
    match status {
        Status::Free => "",
        Status::AtBound => "at bound",
        Status::Fixed => "fixed",
        Status::Excluded => "excluded",
        Status::Prior => "with prior",
        Status::Undetermined => "not determined",
        Status::BoundContradicted => "bound contradicted",
    }
}
