//! `froude swim --optimise`: gaits that no other beats in both of two objectives, and how sure that is.

use std::sync::atomic::{AtomicUsize, Ordering};

use froude_records::RecordError;
use froude_records::block::{Block, ResultTable, TableBuilder, facts};
use froude_records::manifest::may_replace;
use froude_records::number::count;
use froude_records::outcome::{Content, Outcome, OutputFile};
use froude_records::text::counted;
use rayon::prelude::*;

use super::VerbError;
use super::answer::files_read;
use super::sweep::{Drawn, Ready, SweepJob, gaits, table};
use super::uncertain::{bodies, of_draws};
use crate::chain::Chain;
use crate::dynamics::Dynamics;
use crate::front::{Objective, Search};
use crate::gait::Gait;
use crate::robot_file::{RobotFile, read_robot};
use crate::spatial;
use crate::sweep::Row;
use crate::swim::Status;

/// How often the distance of the grid is halved.
const HALVINGS: u32 = 4;
/// Gaits of a front that are printed, and compared by draws.
const SHOWN: usize = 12;

/// What came of it.
struct Found {
    name: String,
    /// What was sought.
    of: [Objective; 2],
    /// How many gaits are on the front.
    front: usize,
    /// Those that are printed and compared, the best of the first objective first.
    shown: Vec<Shown>,
    drawn: Option<Drawn>,
    /// Gaits that were swum.
    swum: usize,
}

/// A gait of the front.
struct Shown {
    /// Its place there, from 1.
    number: usize,
    row: Row,
    /// The probability that it is better than its next in each objective, by draws in which both have an answer; `None` without such.
    beats: Option<[f64; 2]>,
}

/// Sweeps, refines the front and compares its gaits; `tell` hears how many gaits are swum, of how many that are known of.
///
/// # Errors
///
/// As [`super::sweep::sweep`].
pub fn optimise(
    job: &SweepJob,
    of: [Objective; 2],
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Outcome, VerbError> {
    let file = read_robot(&job.robot)?;
    if file.model.is_3d {
        best::<spatial::chain::Chain>(file, job, of, tell)
    } else {
        best::<Chain>(file, job, of, tell)
    }
}

fn best<C: Dynamics>(
    file: RobotFile,
    job: &SweepJob,
    of: [Objective; 2],
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Outcome, VerbError> {
    let ready = Ready::<C>::new(file, job)?;
    let (done, all) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let row = |(draw, gait): (usize, &Gait)| {
        let row = ready.row(gait, draw);
        tell(done.fetch_add(1, Ordering::Relaxed) + 1, all.load(Ordering::Relaxed));
        row
    };
    let written = job.out.join("front.parquet");
    may_replace(&written)?;
    ready.reads.spared_by(&written)?;
    let swim = |gaits: &[Gait]| -> Result<Vec<Row>, VerbError> {
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
            let numbers = ["amplitude", "frequency", "phase", "turn"].map(|name| front[*place].get(name));
            let gait = ready.grid.with(numbers);
            (1..=n).into_par_iter().map(|draw| row((draw, &gait))).collect::<Vec<Row>>()
        };
        let drawn: Vec<Vec<Row>> = shown.iter().map(of_gait).collect();
        drawn.windows(2).map(|pair| beats(&pair[0], &pair[1], of)).collect()
    } else {
        Vec::new()
    };
    let drawn = job.draws.map(|drawing| (drawing, (ready.robots.len() - 1) / drawing.n.max(1), ready.beyond));
    let mut files = Vec::new();
    if !front.is_empty() {
        std::fs::create_dir_all(&job.out).map_err(|e| RecordError::output(&job.out, &e))?;
        let content = Content::Table(table(&front, &written));
        files.push(OutputFile { key: "front", path: written, content });
    }
    let one = |(k, place): (usize, &usize)| Shown {
        number: place + 1,
        row: front[*place],
        beats: beats.get(k).copied().flatten(),
    };
    let shown = shown.iter().enumerate().map(one).collect();
    let data = ready.reads.data()?;
    let found = Found { name: ready.name, of, front: front.len(), shown, drawn, swum: search.rows() };
    let blocks = [vec![files_read(&data).into()], found.blocks()].concat();
    Ok(Outcome { blocks, files, ..Outcome::default() })
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
    fn blocks(&self) -> Vec<Block> {
        vec![self.about().into(), self.gaits().into(), Block::text("remarks", self.sentences())]
    }

    fn about(&self) -> ResultTable {
        let f = facts("", "", self);
        let mut columns = vec![
            f.text("robot", "", |found| found.name.clone()),
            f.texts("objectives", "", |found| found.of.map(|o| o.name().to_owned()).to_vec()),
            f.count("front_gaits", "", |found| found.front),
            f.count("swum_gaits", "", |found| found.swum),
        ];
        columns.extend(self.drawn.iter().flat_map(of_draws));
        f.build(columns)
    }

    fn gaits(&self) -> ResultTable {
        let caption = format!(
            "{}: {} that no other beats in both {} and {}, of {} swum",
            self.name,
            counted(self.front, "gait", "gaits"),
            self.of[0].name(),
            self.of[1].name(),
            count(self.swum)
        );
        let t = TableBuilder::new("gaits", caption, &self.shown);
        let mut columns = vec![t.count("number", "gait", |s| s.number)];
        columns.extend(gaits::columns(&t, |s| &s.row));
        if self.drawn.is_some() {
            let better = |(o, of): (usize, &Objective)| {
                let head = format!("p({} better than next)", of.name());
                t.number(&format!("better_than_next/{}", of.name()), &head, move |s| s.beats.map(|p| p[o])).p_value()
            };
            columns.extend(self.of.iter().enumerate().map(better));
        }
        t.build(columns)
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = Vec::new();
        if self.front == 0 {
            out.push("no gait of these ranges repeats itself and is stable: nothing is written".to_owned());
        }
        out.extend(self.drawn.iter().flat_map(|(drawing, laws, beyond)| bodies(drawing.n * laws, *beyond)));
        let close = self.shown.iter().filter_map(|shown| {
            let p = shown.beats?;
            let near = (0..2).filter(|k| (0.05..=0.95).contains(&p[*k])).map(|k| self.of[k].name());
            let near: Vec<&str> = near.collect();
            (!near.is_empty()).then(|| format!("gait {} and its next, in {}", shown.number, near.join(" and ")))
        });
        let close: Vec<String> = close.collect();
        if !close.is_empty() {
            out.push(format!("the coefficients do not tell apart: {}", close.join("; ")));
        }
        out
    }
}
