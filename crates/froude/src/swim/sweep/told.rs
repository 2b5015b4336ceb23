//! What is said of a sweep, to a person and to a program.

use std::collections::BTreeMap;

use froude_records::number::{count, fixed, interval, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use froude_swim::draws::envelope_95;
use froude_swim::sweep::{COLUMNS, Row, Status};
use serde_json::{Map, Value, json};

use super::Swept;
use crate::swim::uncertain::bodies;

/// What a table of gaits says of each, behind its name.
pub(in crate::swim) const HEAD: [&str; 9] = [
    "gait",
    "amplitude, deg",
    "frequency, deg/s",
    "phase, deg",
    "turn, deg",
    "speed, m/s",
    "net power, W",
    "cost, J/m",
    "torque, N m",
];

/// The same of a row.
pub(in crate::swim) fn cells(row: &Row) -> Vec<String> {
    let gait = ["amplitude", "frequency", "phase", "turn"].map(|key| fixed(row.get(key).to_degrees(), 2));
    let found = ["speed", "power_net", "cot", "torque_peak"].map(|key| significant(row.get(key), 4));
    [gait, found].concat()
}

impl Swept {
    /// Gaits with an answer by the estimate: the first row of each.
    fn answered(&self) -> impl Iterator<Item = (usize, &Row)> {
        let first = self.rows.iter().enumerate().step_by(self.each);
        first.filter(|(_, row)| row.status == Status::Periodic)
    }

    /// The gaits that somebody looks for first, among those that are stable, by name, with the place of their row.
    fn best(&self) -> Vec<(&'static str, usize)> {
        let stable = || self.answered().filter(|(_, row)| row.get("floquet") <= 1.0);
        let most = |of: &dyn Fn(&Row) -> f64| stable().max_by(|(_, a), (_, b)| of(a).total_cmp(&of(b)));
        let found = [("fastest", most(&|r| r.get("speed"))), ("least cost of transport", most(&|r| -r.get("cot")))];
        found.into_iter().filter_map(|(name, found)| Some((name, found?.0))).collect()
    }

    /// 95 % of a column over the draws of a gait, the envelope over the laws; `None` without draws.
    fn interval(&self, at: usize, column: &str) -> Option<[f64; 2]> {
        let (drawing, ..) = self.drawn?;
        let numbers = |rows: &[Row]| {
            let swim = rows.iter().filter(|row| row.status == Status::Periodic);
            swim.map(|row| row.get(column)).collect::<Vec<f64>>()
        };
        let by_law: Vec<Vec<f64>> = self.rows[at + 1..at + self.each].chunks(drawing.n.max(1)).map(numbers).collect();
        envelope_95(by_law.iter().map(Vec::as_slice))
    }

    fn statuses(&self) -> BTreeMap<Status, usize> {
        let mut all = BTreeMap::new();
        for row in &self.rows {
            *all.entry(row.status).or_default() += 1;
        }
        all
    }

    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let row = |(name, at): (&str, usize)| {
            let row = &self.rows[at];
            let cell = |column: &str| self.interval(at, column).map_or_else(String::new, interval);
            let of_draws = if self.drawn.is_some() { vec![cell("speed"), cell("cot")] } else { Vec::new() };
            [vec![name.to_owned()], cells(row), of_draws].concat()
        };
        let mut head = HEAD.to_vec();
        if self.drawn.is_some() {
            head.extend(["speed, 95 %", "cost, 95 %"]);
        }
        DocumentSection {
            title: self.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![TextTable {
                caption: format!("{}: {}", self.name, counted(self.rows.len() / self.each, "gait", "gaits")),
                head: head.into_iter().map(str::to_owned).collect(),
                rows: self.best().into_iter().map(row).collect(),
            }],
            charts: Vec::new(),
        }
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = Vec::new();
        let rows = if self.drawn.is_some() { "rows" } else { "gaits" };
        let why = |status: Status| match status {
            Status::Periodic => "repeat themselves",
            Status::Limit => "ask for more than the joints allow",
            Status::NotPeriodic => "do not repeat themselves within reach",
            Status::Still => "do not swim",
            Status::Inertia => "have an inertia that is not positive",
            Status::Step => "need a shorter step",
            Status::TooSlow => "are too slow for their drag or servos",
            Status::Drives => "need more than the drives give, or take servos beyond the joints' limits",
        };
        for (status, n) in self.statuses().into_iter().filter(|(status, _)| *status != Status::Periodic) {
            out.push(format!(
                "{} of {} {} {} (status {})",
                count(n),
                count(self.rows.len()),
                rows,
                why(status),
                status.name()
            ));
        }
        let settled = self.answered().filter(|(_, row)| row.get("unstable_floquet") > 1.0).count();
        if settled > 0 {
            out.push(format!(
                "{} unstable motion: the figures are those of the motion that follows, and those of the unstable motion are in the columns unstable_speed, unstable_power_net and unstable_floquet",
                counted(settled, "gait leaves an", "gaits leave an")
            ));
        }
        let unstable = self.answered().filter(|(_, row)| row.get("floquet") > 1.0).count();
        if unstable > 0 {
            out.push(format!(
                "{} unstable and settle into no motion that repeats each period (column floquet above 1): figures are those of the unstable motion",
                counted(unstable, "gait is", "gaits are")
            ));
        }
        out.extend(self.drawn.iter().flat_map(|(drawing, laws, beyond)| bodies(drawing.n * laws, *beyond)));
        if self.resumed > 0 {
            out.push(format!("{} were there from an earlier start", counted(self.resumed, "row", "rows")));
        }
        for folder in &self.others {
            out.push(format!(
                "{} holds parts of a sweep of another robot, record or gaits that never came to its end: remove it when that is not to go on",
                folder.display()
            ));
        }
        out
    }

    /// The same for a program, each number in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let statuses: Map<String, Value> =
            self.statuses().into_iter().map(|(status, n)| (status.name().to_owned(), json!(n))).collect();
        let best: Map<String, Value> =
            self.best().into_iter().map(|(name, at)| (name.replace(' ', "_"), self.of_gait(at))).collect();
        json!({
            "robot": self.name,
            "data": self.data,
            "rows": self.rows.len(),
            "gaits": self.rows.len() / self.each,
            "draws": self.drawn.map(|(d, laws, beyond)| json!({"n": d.n, "laws": laws, "seed": d.seed, "brought_back": beyond.brought_back, "refused": beyond.refused})),
            "statuses": statuses,
            "best": best,
            "resumed_rows": self.resumed,
            "sweep": self.written,
            "report": self.report,
            "units": COLUMNS.iter().map(|(name, unit)| ((*name).to_owned(), json!(unit))).collect::<Map<_, _>>(),
            "remarks": self.sentences(),
        })
    }

    fn of_gait(&self, at: usize) -> Value {
        let mut row = of_row(&self.rows[at]);
        if let Value::Object(row) = &mut row
            && self.drawn.is_some()
        {
            let ends = |column: &str| json!(self.interval(at, column));
            row.insert("speed_interval_95".to_owned(), ends("speed"));
            row.insert("power_net_interval_95".to_owned(), ends("power_net"));
            row.insert("cot_interval_95".to_owned(), ends("cot"));
        }
        row
    }
}

/// A row by the names of its columns; what is no number is null.
pub(in crate::swim) fn of_row(row: &Row) -> Value {
    COLUMNS.iter().zip(row.numbers).map(|((name, _), x)| ((*name).to_owned(), json!(x))).collect::<Map<_, _>>().into()
}
