//! What is said of a sweep.

use std::collections::BTreeMap;

use froude_records::block::{Block, ResultTable, TableBuilder, facts};
use froude_records::number::count;
use froude_records::text::counted;

use super::{Swept, gaits};
use crate::draws::envelope_95;
use crate::sweep::Row;
use crate::swim::Status;
use crate::verb::uncertain::{bodies, of_draws};

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

    /// Its best gaits, and what else is to be known.
    pub(super) fn blocks(&self) -> Vec<Block> {
        vec![
            self.about().into(),
            self.statuses_table().into(),
            self.best_table().into(),
            Block::text("remarks", self.sentences()),
        ]
    }

    fn about(&self) -> ResultTable {
        let f = facts("", "", self);
        let mut columns = vec![
            f.text("robot", "", |s| s.name.clone()),
            f.count("rows", "", |s| s.rows.len()),
            f.count("gaits", "", |s| s.rows.len() / s.each),
            f.count("resumed_rows", "", |s| s.resumed),
        ];
        columns.extend(self.drawn.iter().flat_map(of_draws));
        f.build(columns)
    }

    fn statuses_table(&self) -> ResultTable {
        let f = facts("statuses", "", self);
        let one = |(status, n): (Status, usize)| f.count(status.name(), "", move |_| n);
        let columns = self.statuses().into_iter().map(one).collect();
        f.build(columns)
    }

    fn best_table(&self) -> ResultTable {
        let caption = format!("{}: {}", self.name, counted(self.rows.len() / self.each, "gait", "gaits"));
        let best = self.best();
        let t = TableBuilder::new("best", caption, &best);
        let mut columns = vec![t.text("name", "gait", |(name, _)| (*name).to_owned())];
        columns.extend(gaits::columns(&t, |(_, at)| &self.rows[*at]));
        if self.drawn.is_some() {
            columns.extend([
                t.interval("speed_interval_95_m_s", "speed, 95 % [m/s]", |(_, at)| self.interval(*at, "speed")),
                t.interval("power_net_interval_95_w", "", |(_, at)| self.interval(*at, "power_net")),
                t.interval("cost_of_transport_interval_95_j_m", "cost, 95 % [J/m]", |(_, at)| {
                    self.interval(*at, "cot")
                }),
            ]);
        }
        t.build(columns)
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
            out.push(format!("{} were resumed from an earlier run", counted(self.resumed, "row", "rows")));
        }
        for folder in &self.others {
            out.push(format!(
                "{} holds an unfinished sweep of another robot, record or gait set; delete it if you will not resume it",
                folder.display()
            ));
        }
        out
    }
}
