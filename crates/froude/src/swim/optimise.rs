//! `froude swim --optimise`: gaits that no other beats in both of two objectives, and how sure that is.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use froude_records::estimate::DataFile;
use froude_records::manifest::{may_replace, take_own_place};
use froude_records::number::{count, p_value};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::table::prepare_table;
use froude_records::text::counted;
use froude_swim::draws::Beyond;
use froude_swim::front::{Objective, Search};
use froude_swim::gait::Gait;
use froude_swim::sweep::{Row, Status};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::sweep::told::{HEAD, cells, of_row};
use super::sweep::{Ready, SweepJob, table};
use super::uncertain::{Drawing, bodies};
use crate::Error;

/// How often the distance of the grid is halved.
const HALVINGS: u32 = 4;
/// Gaits of a front that are printed, and compared by draws.
const SHOWN: usize = 12;

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The robot's name.
    pub name: String,
    /// The files that were read.
    pub data: Vec<DataFile>,
    /// What was sought.
    pub of: [Objective; 2],
    /// The front, the best of the first objective first.
    pub front: Vec<Row>,
    /// Places on it of the gaits that are printed and compared.
    pub shown: Vec<usize>,
    /// For each of these and its next: the probability that it is better in each objective, by draws in which both have an answer; `None` without such.
    pub beats: Vec<Option<[f64; 2]>>,
    /// Draws per law, number of laws, and draws that were no bodies.
    pub drawn: Option<(Drawing, usize, Beyond)>,
    /// Gaits that were swum.
    pub swum: usize,
    /// The table.
    pub written: PathBuf,
}

/// Sweeps, refines the front and compares its gaits; `tell` hears how many gaits are swum, of how many that are known of.
///
/// # Errors
///
/// As [`super::sweep::sweep`].
pub fn optimise(job: &SweepJob, of: [Objective; 2], tell: &(dyn Fn(usize, usize) + Sync)) -> Result<Found, Error> {
    let ready = Ready::new(job)?;
    let (done, all) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let row = |(draw, gait): (usize, &Gait)| {
        let row = ready.row(gait, draw);
        tell(done.fetch_add(1, Ordering::Relaxed) + 1, all.load(Ordering::Relaxed));
        row
    };
    let written = job.out.join("front.parquet");
    may_replace(&written)?;
    ready.reads.spared_by(&written)?;
    let swim = |gaits: &[Gait]| -> Result<Vec<Row>, Error> {
        all.fetch_add(gaits.len(), Ordering::Relaxed);
        Ok(gaits.par_iter().map(|gait| row((0, gait))).collect())
    };
    let grid: Vec<Gait> = (0..ready.gaits).map(|i| ready.grid.gait(i)).collect();
    let mut search = Search::new(&ready.grid, &swim(&grid)?, of, HALVINGS);
    search.refine(swim)?;
    let front = search.front();
    let shown = spread(front.len());
    let beats = if job.draws.is_some() {
        let n = ready.robots.len() - 1;
        all.fetch_add(n * shown.len(), Ordering::Relaxed);
        let of_gait = |place: &usize| {
            let gait = gait(&front[*place], &ready);
            (1..=n).into_par_iter().map(|draw| row((draw, &gait))).collect::<Vec<Row>>()
        };
        let drawn: Vec<Vec<Row>> = shown.iter().map(of_gait).collect();
        drawn.windows(2).map(|pair| beats(&pair[0], &pair[1], of)).collect()
    } else {
        Vec::new()
    };
    if !front.is_empty() {
        std::fs::create_dir_all(&job.out).map_err(|source| Error::Output { path: job.out.clone(), source })?;
        take_own_place(prepare_table(&table(&front, &written), &written)?)?;
    }
    let drawn = job.draws.map(|drawing| (drawing, (ready.robots.len() - 1) / drawing.n.max(1), ready.beyond));
    let data = ready.reads.data()?;
    Ok(Found { name: ready.name, data, of, front, shown, beats, drawn, swum: search.rows(), written })
}

fn gait(row: &Row, ready: &Ready) -> Gait {
    Gait {
        amplitude: row.get("amplitude"),
        frequency: row.get("frequency"),
        phase: row.get("phase"),
        turn: row.get("turn"),
        envelope: ready.grid.envelope.clone(),
    }
}

/// Places that are spread over so many, both ends among them.
fn spread(n: usize) -> Vec<usize> {
    if n <= SHOWN { (0..n).collect() } else { (0..SHOWN).map(|k| k * (n - 1) / (SHOWN - 1)).collect() }
}

/// The parts of pairs of draws in which the first is better.
fn beats(first: &[Row], second: &[Row], of: [Objective; 2]) -> Option<[f64; 2]> {
    let both: Vec<(&Row, &Row)> =
        first.iter().zip(second).filter(|(a, b)| [a, b].iter().all(|r| r.status == Status::Periodic)).collect();
    let part = |o: Objective| both.iter().filter(|(a, b)| o.good(a) > o.good(b)).count() as f64 / both.len() as f64;
    (!both.is_empty()).then(|| of.map(part))
}

impl Found {
    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let row = |(k, place): (usize, &usize)| {
            let row = &self.front[*place];
            let beats = self.beats.get(k).and_then(|b| *b);
            let beats = [0, 1].map(|o| beats.map_or_else(String::new, |b| p_value(b[o])));
            let of_draws = if self.drawn.is_some() { beats.to_vec() } else { Vec::new() };
            [vec![(place + 1).to_string()], cells(row), of_draws].concat()
        };
        let mut head = HEAD.map(str::to_owned).to_vec();
        if self.drawn.is_some() {
            head.extend(self.of.map(|o| format!("p({} better than next)", o.name())));
        }
        DocumentSection {
            title: self.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![TextTable {
                caption: format!(
                    "{}: {} that no other beats in both {} and {}, of {} swum",
                    self.name,
                    counted(self.front.len(), "gait", "gaits"),
                    self.of[0].name(),
                    self.of[1].name(),
                    count(self.swum)
                ),
                head,
                rows: self.shown.iter().enumerate().map(row).collect(),
            }],
            charts: Vec::new(),
        }
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = Vec::new();
        if self.front.is_empty() {
            out.push("no gait of these ranges repeats itself and is stable: nothing is written".to_owned());
        }
        out.extend(self.drawn.iter().flat_map(|(drawing, laws, beyond)| bodies(drawing.n * laws, *beyond)));
        let close = self.shown.iter().zip(&self.beats).filter_map(|(place, beats)| {
            let p = (*beats)?;
            let near = (0..2).filter(|k| (0.05..=0.95).contains(&p[*k])).map(|k| self.of[k].name());
            let near: Vec<&str> = near.collect();
            (!near.is_empty()).then(|| format!("gait {} and its next, in {}", place + 1, near.join(" and ")))
        });
        let close: Vec<String> = close.collect();
        if !close.is_empty() {
            out.push(format!("the coefficients do not tell apart: {}", close.join("; ")));
        }
        out
    }

    /// The same for a program, each number in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let shown = self.shown.iter().enumerate().map(|(k, place)| {
            let mut row = of_row(&self.front[*place]);
            if let (Value::Object(row), Some(Some(p))) = (&mut row, self.beats.get(k)) {
                let beats = self.of.iter().zip(p).map(|(o, p)| (o.name().to_owned(), json!(p)));
                row.insert("better_than_next".to_owned(), beats.collect::<Map<_, _>>().into());
            }
            row
        });
        json!({
            "robot": self.name,
            "data": self.data,
            "objectives": self.of.map(Objective::name),
            "front_gaits": self.front.len(),
            "swum_gaits": self.swum,
            "gaits": shown.collect::<Vec<_>>(),
            "draws": self.drawn.map(|(d, laws, beyond)| json!({"n": d.n, "laws": laws, "seed": d.seed, "brought_back": beyond.brought_back, "refused": beyond.refused})),
            "front": (!self.front.is_empty()).then_some(&self.written),
            "remarks": self.sentences(),
        })
    }
}
