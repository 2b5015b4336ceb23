//! The tables of the page, numbered through.

mod budget;
mod coefficients;
pub(crate) mod counter;
mod selection;
pub(crate) mod symbols;
pub(crate) mod typed;

use std::collections::BTreeSet;

use froude_records::block::TableBuilder;
use froude_records::estimate::words;
use froude_records::estimate::{Coefficient, Estimate, Range, Status};
use froude_records::number;
use maud::{Markup, html};

use self::counter::Tables;
use self::symbols::{html_symbol, html_unit};
use self::typed::table_markup;
use crate::symbol::unit_text;

/// The range of a coefficient, where other laws make that wider than its interval.
pub(crate) fn wider_range(c: &Coefficient) -> Option<[f64; 2]> {
    c.range_95.filter(|range| c.interval_95.is_none_or(|own| range[0] < own[0] || own[1] < range[1]))
}

/// A count with its noun.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", number::count(n), if n == 1 { one } else { many })
}

/// A quantity of the range of validity in words; channels of the table stay symbols.
fn quantity(name: &str) -> String {
    let words = match name {
        "n_links" => "links of the body",
        "Re" => "Reynolds number",
        "Fr_length" => "Froude number of the reference length",
        "Fr_depth" => "Froude number of the water's depth",
        "Fr_submergence" => "Froude number of the submergence",
        "KC" => "Keulegan–Carpenter number",
        _ if name.len() > 2 && name.as_bytes()[1] == b'_' => name,
        _ => return name.replace('_', " "),
    };
    words.to_owned()
}

/// What an estimate is called beside others: its law, or, where several have that one, what its id ends with.
pub(crate) fn called<'a>(e: &'a Estimate, beside: &[&Estimate]) -> &'a str {
    let is_alone = beside.iter().filter(|other| other.law.name == e.law.name).count() < 2;
    if is_alone { &e.law.name } else { e.id.rsplit_once('/').map_or(e.id.as_str(), |(_, method)| method) }
}

/// A coefficient's symbol, with what a paper calls it.
pub(crate) fn named(name: &str, c: &Coefficient) -> Markup {
    html! { (html_symbol(name)) @if let Some(label) = &c.label { " (" (html_symbol(label)) ")" } }
}

/// Whether a value is given without any uncertainty although one belongs to it.
fn is_bare(c: &Coefficient, estimate: &Estimate) -> bool {
    let is_given = match c.status {
        Status::Free | Status::Prior => true,
        Status::Fixed => estimate.kind == "published",
        _ => false,
    };
    is_given
        && number::finite(c.value).is_some()
        && number::usable(c.standard_uncertainty).is_none()
        && c.interval_95.is_none()
}

fn dagger() -> Markup {
    html! { span class="mark" title="no interval stated" { "†" } }
}

/// Value ± U with its unit, for the summary; the unit goes with a number only.
pub(crate) fn expanded(c: &Coefficient, estimate: &Estimate) -> Markup {
    let has_number = number::finite(c.value).is_some() && !matches!(c.status, Status::Undetermined | Status::Excluded);
    html! {
        (words::coefficient_expanded(c))
        @if is_bare(c, estimate) { (dagger()) }
        @if has_number { (html_unit(&c.unit)) }
    }
}

/// Distinct texts in the order of their appearance.
pub(crate) fn distinct<'a, T: AsRef<str> + ?Sized + 'a>(texts: impl IntoIterator<Item = &'a T>) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    texts.into_iter().map(AsRef::as_ref).filter(|text| seen.insert(*text)).collect()
}

impl Tables {
    /// Ranges of the observations behind an estimate.
    pub(crate) fn validity(&mut self, e: &Estimate) -> Markup {
        let caption = format!(
            "Range of the observations behind model {}. Outside it every prediction is extrapolation.",
            e.law.name
        );
        let shown =
            |range: &Range, end: f64| number::plain(if range.unit == "rad" { end.to_degrees() } else { end }, 4);
        let rows: Vec<(&String, &Range)> = e.validity.iter().collect();
        let t = TableBuilder::new("", caption, &rows);
        let columns = vec![
            t.text("", "Quantity", |(name, _)| quantity(name)).symbol(),
            t.text("", "From", |(_, range)| shown(range, range.low)),
            t.text("", "To", |(_, range)| shown(range, range.high)),
            t.text("", "Unit", |(_, range)| if range.unit == "rad" { "°".to_owned() } else { unit_text(&range.unit) }),
        ];
        table_markup(&t.build(columns), self)
    }
}

/// σ of a load; of its logarithm where a force or a moment has a σ without unit.
pub(crate) fn sigma(component: &str, unit: &str) -> Markup {
    let is_load = component.starts_with("f_") || component.starts_with("m_");
    html! { "σ(" @if is_load && unit == "1" { "ln " } (html_symbol(component)) ")" }
}
