//! What the pre-flight says of a campaign, before anything moves.

use crate::carriage::plan::PlannedRun;
use froude_records::block::{Block, ResultTable, TableBuilder, facts};
use froude_records::number::duration;
use froude_records::outcome::{Exit, Outcome};
use froude_records::run::{Direction, Role};
use froude_records::text::counted;
use indexmap::IndexMap;

use super::{Forecast, Objection};
use crate::campaign::prepare::Prepared;

/// More different objections than this are reported by kind.
const MOST_SENTENCES: usize = 10;

/// A run with its forecast, and how many are like it.
struct Row<'a> {
    run: &'a PlannedRun,
    forecast: &'a Forecast,
    alike: usize,
}

impl Row<'_> {
    fn kind(&self) -> String {
        match self.run.role {
            Role::Calibration => format!("{} {} N", self.run.role.name(), self.run.hung_weight_n),
            role => role.name().to_owned(),
        }
    }

    /// What a person sees of it, to the digits that are printed.
    fn key(&self) -> String {
        let f = self.forecast;
        let (speed, way, drag_n) = (self.run.speed_m_s(), self.run.direction(), f.drag_n);
        let numbers = format!(
            "{:.1} {:.1} {:.2} {:.2} {:.3} {:.3}",
            f.duration_s, f.steady_s, f.command_v, f.rms_current_a, f.coast_m, f.margin_m
        );
        format!("{} {speed:.3?} {way:?} {numbers} {drag_n:.3?}", self.kind())
    }
}

impl Prepared {
    /// What the pre-flight found: a forecast for each run, and what speaks against the campaign.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        let objections = self.objections_in_words();
        let exit = if objections.is_empty() {
            Exit::Done
        } else {
            Exit::Refused(format!(
                "the pre-flight refuses this campaign; nothing was moved:\n{}",
                objections.join("\n")
            ))
        };
        let mut said = self.said();
        if objections.is_empty() {
            said.push("Pre-flight passed. Nothing was moved.".to_owned());
        }
        let tables = [self.about(), self.forecast_table(), self.objection_table()].map(Block::from);
        let blocks = [tables.to_vec(), self.beside.clone(), vec![Block::text("", said)]].concat();
        Outcome { blocks, exit, ..Outcome::default() }
    }

    /// What is said before it is driven.
    #[must_use]
    pub fn blocks(&self) -> Vec<Block> {
        [vec![self.forecast_table().into()], self.beside.clone(), vec![Block::text("", self.said())]].concat()
    }

    fn about(&self) -> ResultTable {
        let f = facts("", "", self);
        f.build(vec![
            f.text("name", "", |p| p.name().to_owned()),
            f.number("duration_s", "", Self::duration_s),
            f.number("detectable_n", "", Self::detectable_n),
        ])
    }

    fn forecast_table(&self) -> ResultTable {
        let mut rows: Vec<Row<'_>> =
            self.runs().zip(&self.forecasts).map(|(run, forecast)| Row { run, forecast, alike: 0 }).collect();
        let keys: Vec<String> = rows.iter().map(Row::key).collect();
        let mut alike: IndexMap<&str, (usize, usize)> = IndexMap::new();
        for (i, key) in keys.iter().enumerate() {
            alike.entry(key).or_insert((i, 0)).1 += 1;
        }
        for (row, key) in rows.iter_mut().zip(&keys) {
            row.alike = alike.get(key.as_str()).map_or(1, |(_, n)| *n);
        }
        let first = alike.values().map(|(i, _)| *i).collect();
        let detectable_n = self.detectable_n();
        let runs = counted(rows.len(), "run", "runs");
        let caption = format!("{}: {runs}, about {} on the rig", self.name(), duration(self.duration_s()));
        let t = TableBuilder::new("runs", caption, &rows);
        let pairs = |row: &Row<'_>| row.forecast.drag_n.filter(|d| *d > 0.0).map(|d| pairs_to_see(detectable_n, d));
        let mut table = t.build(vec![
            t.text("run", "", |row| row.forecast.id.clone()),
            t.text("kind", "kind", Row::kind),
            t.number("speed_m_s", "speed [m/s]", |row| row.run.speed_m_s()).places(3),
            t.text("direction", "direction", |row| row.run.direction().map(|d| Direction::name(d).to_owned())),
            t.number("duration_s", "time [s]", |row| row.forecast.duration_s).places(1),
            t.number("steady_s", "steady [s]", |row| row.forecast.steady_s).places(1),
            t.number("command_v", "command [V]", |row| row.forecast.command_v).places(2),
            t.number("rms_current_a", "rms current [A]", |row| row.forecast.rms_current_a).places(2),
            t.number("coast_m", "coast [m]", |row| row.forecast.coast_m).places(3),
            t.number("margin_m", "margin [m]", |row| row.forecast.margin_m).places(3),
            t.number("drag_n", "drag [N]", |row| row.forecast.drag_n).places(3),
            t.number("differences_to_see_it", "wet − dry to see it", pairs).places(0),
            t.count("alike", "runs", |row| row.alike),
        ]);
        table.shown_rows = Some(first);
        table
    }

    fn objection_table(&self) -> ResultTable {
        let t = TableBuilder::new("objections", "", &self.objections);
        t.build(vec![
            t.text("run", "", |o| o.id.clone()),
            t.text("kind", "", |o| o.kind.to_owned()),
            t.text("text", "", |o| o.text.clone()),
        ])
    }

    fn said(&self) -> Vec<String> {
        let detectable_n = self.detectable_n();
        let mut out = vec![format!(
            "One wet-minus-dry difference is expected to show {detectable_n:.2} N ({}",
            if self.asked.expected_scatter_n.is_some() {
                "its scatter as declared)."
            } else {
                "friction repeating within 2 %, assumed until the dry runs show it)."
            }
        )];
        if self.runs().zip(&self.forecasts).any(|(_, f)| !f.margin_m.is_finite()) {
            out.push(
                "Runs without a margin (—) are pulses and jogs; the controller's soft limits keep them inside."
                    .to_owned(),
            );
        }
        if !self.is_shaped() {
            out.push(
                "The reference is not shaped (shaped_mode): after each ramp the load swings on the chain, and runs in which it then drives the gear \
                 are left out of the evaluation by motor current. froude carriage resonance finds the mode."
                    .to_owned(),
            );
        }
        out.extend(few_pairs(self, detectable_n));
        out
    }

    /// The objections, a line each.
    fn objections_in_words(&self) -> Vec<String> {
        // The same sentence for many runs is printed once, with their number.
        let mut sentences: Vec<(&str, &str, usize)> = Vec::new();
        for o in &self.objections {
            match sentences.iter_mut().find(|t| t.1 == o.text) {
                Some(t) => t.2 += 1,
                None => sentences.push((&o.id, &o.text, 0)),
            }
        }
        let more = |n: usize, one: &str, many: &str| match n {
            0 => String::new(),
            n => format!(" (and {})", counted(n, one, many)),
        };
        let mut lines: Vec<String> = sentences
            .iter()
            .map(|(id, text, n)| format!("  {id}{}: {text}", more(*n, "more run", "more runs")))
            .collect();
        if sentences.len() > MOST_SENTENCES {
            // One cause gives a sentence for each run; the first of each kind is enough.
            let mut kinds: Vec<(&str, &Objection, usize)> = Vec::new();
            for o in &self.objections {
                match kinds.iter_mut().find(|k| k.0 == o.kind) {
                    Some(k) => k.2 += 1,
                    None => kinds.push((o.kind, o, 0)),
                }
            }
            lines = kinds
                .iter()
                .map(|(_, o, n)| format!("  {}{}: {}", o.id, more(*n, "more like it", "more like it"), o.text))
                .collect();
            let is_refused = |run: &PlannedRun| self.objections.iter().any(|o| o.id == run.id);
            let (refused, all) = (self.runs().filter(|r| is_refused(r)).count(), self.runs().count());
            let are = if refused == 1 { "is" } else { "are" };
            lines.push(format!(
                "{refused} of {} {are} refused; froude run --check --json has a sentence for each",
                counted(all, "run", "runs")
            ));
        }
        lines
    }
}

/// Speeds that are planned with fewer differences than their drag needs; `None` where all have enough, or no drag is expected.
fn few_pairs(prepared: &Prepared, detectable_n: f64) -> Option<String> {
    let drags = prepared.runs().zip(&prepared.forecasts).filter_map(|(run, f)| run.speed_m_s().zip(f.drag_n));
    // Speed, drag, wet runs: each gives one difference.
    let mut planned: Vec<(f64, f64, usize)> = Vec::new();
    for (speed, drag) in drags.filter(|d| d.1 > 0.0) {
        match planned.iter_mut().find(|p| p.0 == speed) {
            Some(p) => p.2 += 1,
            None => planned.push((speed, drag, 1)),
        }
    }
    let few: Vec<String> = planned
        .iter()
        .filter_map(|&(speed, drag, runs)| {
            let needed = pairs_to_see(detectable_n, drag);
            let are = counted(runs, "is", "are");
            (needed > runs as f64).then(|| format!("{needed:.0} at {speed:.3} m/s, where {are} planned"))
        })
        .collect();
    (!few.is_empty()).then(|| {
        format!(
            "To detect the drag at each speed separately, more runs are needed: {} (out and back count as two). D_d depends on the fast runs and does \
             not need them.",
            few.join("; ")
        )
    })
}

/// Wet-minus-dry differences until a drag exceeds what one of them shows.
fn pairs_to_see(detectable_n: f64, drag_n: f64) -> f64 {
    (detectable_n / drag_n).powi(2).ceil().max(1.0)
}
