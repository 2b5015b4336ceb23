//! What was found in a file, as a verb returns it.

use froude_records::block::{Block, ResultTable, Section, TableBuilder, facts};
use froude_records::estimate::{Coefficient, Diagnostics, Estimate, Range, Status};
use froude_records::number;
use froude_records::outcome::Outcome;
use froude_records::text::counted;

use super::{ColumnFacts, Inspection, SourceFacts};
use crate::page::told::status;

impl Inspection {
    /// As a verb returns it.
    #[must_use]
    pub fn outcome(self) -> Outcome {
        let kind = facts("", "", &self.kind);
        let t = TableBuilder::new("facts", "", &self.facts);
        let named =
            t.build(vec![t.text("name", "", |fact| fact.0.clone()), t.text("value", "", |fact| fact.1.clone())]);
        let said = std::iter::once(self.kind.clone());
        let said = said.chain(self.facts.iter().map(|(name, value)| format!("  {name}: {value}")));
        let mut blocks = vec![
            kind.build(vec![kind.text("kind", "", |kind: &String| kind.clone())]).into(),
            named.into(),
            Block::words(said),
        ];
        blocks.extend((!self.columns.is_empty()).then(|| columns(&self.columns).into()));
        blocks.extend(self.sources.iter().map(|source| of_source(source).into()));
        blocks.extend(self.estimates.iter().flat_map(of_estimate));
        blocks.extend((!self.estimates.is_empty()).then_some(Block::Estimates(self.estimates)));
        Outcome { blocks, findings: Some(self.findings), ..Outcome::default() }
    }
}

fn columns(columns: &[ColumnFacts]) -> ResultTable {
    let t = TableBuilder::new("columns", "", columns);
    let mut out = vec![
        t.text("name", "column", |c| c.name.clone()),
        t.text("unit", "", |c| c.unit.clone()),
        t.text("", "unit", |c| if c.unit.is_empty() { "text".to_owned() } else { c.unit.clone() }),
        t.number("low", "from", |c| c.low).plain(7),
        t.number("high", "to", |c| c.high).plain(7),
        t.count("distinct", "distinct", |c| c.distinct),
    ];
    if columns.iter().any(|c| c.channel.is_some()) {
        let along = |c: &ColumnFacts| {
            let channel = c.channel.as_ref().filter(|channel| channel.frame != "none")?;
            Some(format!("{}{}", if channel.sign < 0 { "−" } else { "+" }, channel.frame))
        };
        out.extend([
            t.text("quantity", "quantity", |c| c.channel.as_ref().map(|channel| channel.quantity.clone())),
            t.text("frame", "", |c| c.channel.as_ref().map(|channel| channel.frame.clone())),
            t.number("sign", "", |c| c.channel.as_ref().map(|channel| f64::from(channel.sign))),
            t.text("", "positive along", along),
            t.text("clock", "clock", |c| c.channel.as_ref().map(|channel| channel.clock.clone())),
        ]);
    }
    t.build(out)
}

fn of_source(s: &SourceFacts) -> Section {
    let observations = |n: usize| counted(n, "observation", "observations");
    let there = match (s.rows, s.kept, s.exists) {
        (Some(rows), Some(kept), _) if kept == rows => format!(", {}", observations(rows)),
        (Some(rows), Some(kept), _) => {
            format!(", {kept} of {} {} fitted", observations(rows), if kept == 1 { "is" } else { "are" })
        }
        (_, _, true) => String::new(),
        (_, _, false) => {
            let verb = match (s.input.as_str(), s.kind.as_str()) {
                ("cases", _) => "froude cfd plan",
                ("runs", "cfd") => "froude cfd swing",
                _ => "froude simulate",
            };
            format!(", not there yet: {verb} makes it")
        }
    };
    let mut said = vec![format!("source {} ({})", s.name, s.kind), format!("  {}: {}{there}", s.input, s.path)];
    said.extend(s.planned_runs.map(|runs| format!("  plan: {}", counted(runs, "run", "runs"))));
    let what = if s.input == "record" { "estimates" } else { "models" };
    said.extend((!s.models.is_empty()).then(|| format!("  {what}: {}", s.models.join(", "))));
    if s.input == "table" && s.budget.is_empty() {
        let none = "  budget: none; without [[source.uncertainty]] the uncertainties include the scatter only";
        said.push(none.to_owned());
    }
    let f = facts("", "", s);
    let about = f.build(vec![
        f.text("name", "", |s| s.name.clone()),
        f.text("kind", "", |s| s.kind.clone()),
        f.text("input", "", |s| s.input.clone()),
        f.text("path", "", |s| s.path.clone()),
        f.flag("exists", "", |s| s.exists),
        f.count("rows", "", |s| s.rows),
        f.count("kept", "", |s| s.kept),
        f.texts("models", "", |s| s.models.clone()),
        f.count("planned_runs", "", |s| s.planned_runs),
    ]);
    let t = TableBuilder::new("budget", "", &s.budget);
    let budget = t.build(vec![
        t.text("quantity", "budget", |b| b.quantity.clone()),
        t.text("standard", "standard uncertainty", |b| b.standard.clone()),
        t.text("shared", "shared by", |b| b.shared.clone()),
        t.number("dof", "", |b| b.dof),
        t.text("", "dof", |b| number::dof(b.dof.unwrap_or(f64::INFINITY))),
        t.text("name", "name", |b| b.name.clone()),
    ]);
    let blocks = [about.into(), Block::words(said), columns(&s.columns).into(), budget.into()];
    Section { key: "sources[]".to_owned(), ..Section::new("", blocks) }
}

/// An estimate for a person; a program reads it as the record has it.
fn of_estimate(e: &Estimate) -> Vec<Block> {
    let mut said = vec![format!("{}{}", e.id, if e.recommended { " (recommended)" } else { "" })];
    said.extend(e.reason.iter().map(|reason| format!("  {reason}")));
    if e.not_contradicted.len() > 1 {
        let laws = e.not_contradicted.join(", ");
        said.push(format!("  laws of this source that the data do not contradict: {laws}"));
    }
    let about = [e.kind.as_str(), &e.method.words, e.covariance_kind()];
    let about = about.into_iter().filter(|text| !text.is_empty()).map(|text| format!("; {text}"));
    said.push(format!("  {}{}", counted(e.n_observations, "observation", "observations"), about.collect::<String>()));
    let rows: Vec<(&String, &Coefficient)> = e.coefficients.iter().collect();
    let t = TableBuilder::new("", "", &rows);
    let free = |c: &Coefficient| if c.status == Status::Free { "free" } else { status(c.status) }.to_owned();
    let coefficients = t.build(vec![
        t.text("", "coefficient", |(name, _)| (*name).clone()).symbol(),
        t.number("", "value", |(_, c)| c.value).plain(5),
        t.text("", "unit", |(_, c)| c.unit.clone()),
        t.number("", "standard uncertainty", |(_, c)| c.standard_uncertainty).plain(2),
        t.interval("", "95 % interval", |(_, c)| c.interval_95),
        t.interval("", "range", |(_, c)| c.range_95),
        t.text("", "status", |(_, c)| free(c)),
    ]);
    let rows: Vec<(&String, &Range)> = e.validity.iter().collect();
    let t = TableBuilder::new("", "", &rows);
    let validity = t.build(vec![
        t.text("", "valid for", |(name, _)| (*name).clone()),
        t.number("", "from", |(_, r)| r.low).plain(5),
        t.number("", "to", |(_, r)| r.high).plain(5),
        t.text("", "unit", |(_, r)| r.unit.clone()),
    ]);
    let together = e.undetermined.iter().map(|what| format!("  determined only together: {what}"));
    let more =
        together.chain(diagnostics(&e.diagnostics).into_iter().map(|(name, value)| format!("  {name}: {value}")));
    vec![Block::words(said), coefficients.into(), validity.into(), Block::words(more)]
}

/// The diagnostics that a record has, in words.
fn diagnostics(d: &Diagnostics) -> Vec<(&'static str, String)> {
    let by_load = |values: &mut dyn Iterator<Item = (&String, &f64)>| {
        values.map(|(load, x)| format!("{load} {}", number::plain(*x, 3))).collect::<Vec<_>>().join(", ")
    };
    let one = |x: Option<f64>| x.map_or(String::new(), |x| number::plain(x, 4));
    let correlation = d.largest_correlation.as_ref();
    let mut out = vec![
        ("relative residual", by_load(&mut d.relative_residual.iter())),
        ("Durbin–Watson", by_load(&mut d.durbin_watson.iter())),
        ("lack of fit, p", by_load(&mut d.lack_of_fit_p.iter())),
        ("cross-validation, rms error", by_load(&mut d.cross_validation_rmse.iter())),
        ("cross-validation", d.cross_validation_note.clone().unwrap_or_default()),
        ("AICc", one(d.aicc)),
        ("condition number", one(d.condition_number)),
        (
            "largest correlation",
            correlation
                .map_or(String::new(), |c| format!("{} of {} and {}", number::plain(c.value, 3), c.first, c.second)),
        ),
        ("largest leverage", one(d.largest_leverage)),
        ("largest power fed to the body (at most 0 where dissipative), W", one(d.largest_power_w)),
    ];
    out.extend(d.notes.iter().map(|note| ("note", note.clone())));
    out.retain(|(_, value)| !value.is_empty());
    out
}
