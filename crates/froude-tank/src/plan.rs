//! What every plan says: how long its runs take, and the interval to expect of each coefficient.

use froude_fit::budget::{Combined, OUTSIDE_95, Part, combine};
use froude_identify::method::Prospect;
use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::campaign::Source;
use froude_records::number::significant;
use froude_records::text::counted;

/// A coefficient with the interval to expect.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// The force law.
    pub law: String,
    /// Its name.
    pub name: String,
    /// SI unit text.
    pub unit: String,
    /// The truth that it was computed at.
    pub value: f64,
    /// Standard uncertainty and interval.
    pub combined: Combined,
    /// The largest error behind it, and its standard uncertainty.
    pub mostly: (String, f64),
}

impl Expected {
    /// By coefficient `j` of a budget.
    pub(crate) fn of(law: &str, (name, unit): (&str, &str), value: f64, parts: &[Part], j: usize) -> Self {
        let [law, name, unit] = [law, name, unit].map(str::to_owned);
        let largest = parts.iter().max_by(|a, b| a.standard(j).total_cmp(&b.standard(j)));
        let mostly = largest.map_or_else(Default::default, |part| (part.name.clone(), part.standard(j)));
        Self { law, name, unit, value, combined: combine(parts, j, OUTSIDE_95), mostly }
    }
}

/// The intervals to expect; `law` names it in the caption.
pub(crate) fn intervals(expected: &[Expected], law: &str) -> ResultTable {
    let caption = format!(
        "Intervals to expect{law}: true value, half-width of the 95 % interval (U95), and the largest of the standard uncertainties (u) behind it."
    );
    let t = TableBuilder::new("expected", caption, expected);
    t.build(vec![
        t.text("model", "", |e| e.law.clone()),
        t.text("coefficient", "coefficient", |e| e.name.clone()),
        t.text("unit", "unit", |e| e.unit.clone()),
        t.number("value", "value", |e| e.value),
        t.number("standard_uncertainty", "", |e| e.combined.standard),
        t.number("half_width_95", "U95", |e| e.combined.arms[1]).significant(2),
        t.number("relative_half_width_95", "relative U95", |e| {
            (e.value != 0.0).then(|| (e.combined.arms[1] / e.value).abs())
        })
        .percent(),
        t.text("mostly_from", "", |e| e.mostly.0.clone()),
        t.number("mostly_from_standard", "", |e| e.mostly.1),
        t.text("", "dominant uncertainty (u)", |e| format!("{} ({})", e.mostly.0, significant(e.mostly.1, 2))),
    ])
}

/// A plan; its tables are the run matrix, what a method adds, and the intervals to expect.
pub(crate) fn prospect(
    source: &Source,
    (runs, duration_s): (usize, f64),
    tables: impl IntoIterator<Item = ResultTable>,
    said: Vec<String>,
) -> Prospect {
    let blocks = tables.into_iter().map(Block::from).chain([Block::words(said)]);
    let section = Section::new(format!("Plan of {}", source.name), blocks);
    Prospect { source: source.name.clone(), runs, duration_s, section }
}

/// A time as a person says it.
pub(crate) fn minutes(seconds: f64) -> String {
    if seconds < 120.0 { format!("{seconds:.0} s") } else { format!("{:.1} min", seconds / 60.0) }
}

/// What the plan of a joint fit says; `changed` is what is changed between its runs.
pub(crate) fn of_joint_fit(runs: usize, duration_s: f64, changed: &str) -> String {
    format!(
        "{} of {} in all on the log, waits between them and changes of {changed} not counted. The intervals are those of the linearised joint fit at the true coefficients of \
         [simulate], with the noise of [[simulate.sensor]] and everything that is declared.",
        counted(runs, "run", "runs"),
        minutes(duration_s)
    )
}
