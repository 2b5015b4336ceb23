//! What a law by name gives beside its coefficients: primes, and the inverse of a thruster.

use froude_records::block::{Section, TableBuilder};
use froude_records::estimate::{Derived, Estimate};
use froude_records::number::plain;

use crate::answer::Answer;
use crate::named::commands;

/// Sections of a source, of the estimate that is shown first.
pub(super) fn sections(answer: &Answer) -> Vec<Section> {
    let Some(source) = answer.fitted() else { return Vec::new() };
    let Some(chosen) = &source.recommendation else { return Vec::new() };
    let model = &source.models[chosen.index];
    let estimate = &source.estimates[chosen.index];
    if model.law.named.is_none() {
        return Vec::new();
    }
    let mut out: Vec<Section> = primes(estimate).into_iter().collect();
    let commands = commands(model, &source.data);
    if !commands.is_empty() {
        let caption = "Command for a load in still water";
        let t = TableBuilder::new("", caption, &commands);
        let table = t.build(vec![
            t.text("", "load", |c| c.load.clone()).symbol(),
            t.number("", "value", |c| c.value).significant(4),
            t.text("", "unit", |c| c.unit.clone()),
            t.number("", "command", |c| c.command).significant(4),
            t.text("", "unit", |c| c.command_unit.clone()),
            t.interval("", "95 % interval", |c| c.interval),
        ]);
        out.push(Section::new(format!("{}: {caption}", estimate.id), [table.into()]));
    }
    out
}

/// Nondimensional coefficients of a manoeuvring set.
fn primes(estimate: &Estimate) -> Option<Section> {
    let rows: Vec<(&String, &Derived)> = estimate.derived.iter().filter(|(name, _)| name.ends_with("_prime")).collect();
    let of = |name: &str, unit: &str| {
        let known = estimate.refers_to.get(name)?;
        Some(format!(", {name} {} {unit}", plain(known.value, 5)))
    };
    let about = [("density", "kg/m^3"), ("length", "m"), ("speed", "m/s")];
    let about: String = about.into_iter().filter_map(|(name, unit)| of(name, unit)).collect();
    let caption = format!("Nondimensional coefficients{about}");
    let t = TableBuilder::new("", &caption, &rows);
    let table = t.build(vec![
        t.text("", "prime", |(name, _)| (*name).clone()).symbol(),
        t.number("", "value", |(_, d)| d.value).significant(4),
        t.interval("", "95 % interval", |(_, d)| d.interval_95),
        t.text("", "is", |(_, d)| d.formula.clone()),
    ]);
    (!rows.is_empty()).then(|| Section::new(format!("{}: nondimensional coefficients", estimate.id), [table.into()]))
}
