//! `froude swim --sweep`: many gaits, in parallel, into one table.
//!
//! **Parts.** Rows are made in parts of consecutive ones, each written whole beside the table that they become (`.sweep-KEY/`). The key is a hash of all that the numbers depend on: robot file, records, motor, gaits. Started
//! again, a sweep goes on from the parts that are there and the table is the same to the byte; of another robot or other gaits the key is another, and nothing is mixed.
//!
//! **Order.** Amplitude, frequency, phase, turn, draw, the last the fastest.

mod figures;
pub(super) mod gaits;
mod parts;
mod told;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use froude_records::RecordError;
use froude_records::block::Block;
use froude_records::manifest::may_replace;
use froude_records::outcome::{Content, Head, Outcome, OutputFile};
use froude_records::table::{Column, ColumnData, Table};
use rayon::prelude::*;

use super::answer::files_read;
use super::columns::column;
use super::moves::{Moves, Wave};
use super::reads::Reads;
use super::uncertain::Drawing;
use super::{Pitching, VerbError};
use crate::blueprint::Blueprint;
use crate::chain::Chain;
use crate::draws::Beyond;
use crate::dynamics::Dynamics;
use crate::gait::Gait;
use crate::joints::Drives;
use crate::robot::Robot;
use crate::robot_file::{RobotFile, read_robot};
use crate::spatial;
use crate::sweep::{Axis, COLUMNS, Grid, Row};
use parts::Parts;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepJob {
    /// The robot file.
    pub robot: PathBuf,
    /// The gait whose numbers are swept.
    pub moves: Moves,
    /// What is swept.
    pub ranges: Ranges,
    /// The motor of the joints.
    pub motor: Option<PathBuf>,
    /// The longest step, s.
    pub step_s: Option<f64>,
    /// Coefficients that are drawn, for every gait the same.
    pub draws: Option<Drawing>,
    /// Folder of `sweep.parquet`.
    pub out: PathBuf,
}

/// Numbers that take the place of a gait's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ranges {
    /// rad.
    pub amplitude: Option<Axis>,
    /// rad/s.
    pub frequency: Option<Axis>,
    /// rad.
    pub phase: Option<Axis>,
    /// rad.
    pub turn: Option<Axis>,
}

impl Ranges {
    /// The grid of them about a gait.
    fn about(&self, gait: &Gait) -> Grid {
        let own = Grid::of(gait);
        Grid {
            amplitude: self.amplitude.unwrap_or(own.amplitude),
            frequency: self.frequency.unwrap_or(own.frequency),
            phase: self.phase.unwrap_or(own.phase),
            turn: self.turn.unwrap_or(own.turn),
            ..own
        }
    }
}

/// What came of it.
struct Swept {
    name: String,
    /// A row per gait and draw; of each gait the estimate comes first, then the draws law by law.
    rows: Vec<Row>,
    /// Rows of a gait.
    each: usize,
    drawn: Option<Drawn>,
    /// Rows that were there from an earlier start.
    resumed: usize,
    /// Folders with parts of other sweeps that never came to their end.
    others: Vec<PathBuf>,
}

/// Draws per law, number of laws, and draws that were no bodies.
pub(super) type Drawn = (Drawing, usize, Beyond);

/// Most rows of a table.
const MOST_ROWS: usize = 1_000_000;

/// Sweeps; `tell` hears how many rows of how many are done.
///
/// # Errors
///
/// A robot file, record or gait that cannot be used, too many gaits, a folder that cannot be written. A gait without an answer is a row.
pub fn sweep(job: &SweepJob, tell: &(dyn Fn(usize, usize) + Sync)) -> Result<Outcome, VerbError> {
    let file = read_robot(&job.robot)?;
    if file.model.is_3d { of::<spatial::chain::Chain>(file, job, tell) } else { of::<Chain>(file, job, tell) }
}

fn of<C: Dynamics>(
    file: RobotFile,
    job: &SweepJob,
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Outcome, VerbError> {
    let ready = Ready::<C>::new(file, job)?;
    let each = ready.robots.len();
    let rows = ready.gaits * each;
    std::fs::create_dir_all(&job.out).map_err(|e| RecordError::output(&job.out, &e))?;
    let [written, report, result] = ["sweep.parquet", "report.html", "result.json"].map(|name| job.out.join(name));
    for path in [&written, &report, &result] {
        may_replace(path)?;
        ready.reads.spared_by(path)?;
    }
    let data = ready.reads.data()?;
    let asked = format!("{:?} {:?} {:?}", ready.grid, job.step_s, job.draws);
    let parts = Parts::begin(&job.out, &parts::key(&ready.reads.but_the_gait(), &asked)?, rows)?;
    let done = AtomicUsize::new(0);
    let resumed = AtomicUsize::new(0);
    let count = |n: usize| tell(done.fetch_add(n, Ordering::Relaxed) + n, rows);
    let of_part = |part: usize| -> Result<Vec<Row>, VerbError> {
        if let Some(found) = parts.read(part)? {
            resumed.fetch_add(found.len(), Ordering::Relaxed);
            count(found.len());
            return Ok(found);
        }
        let made = parts.rows(part).map(|i| {
            let row = ready.row(&ready.grid.gait(i / each), i % each);
            count(1);
            row
        });
        let made: Vec<Row> = made.collect();
        parts.write(part, &made)?;
        Ok(made)
    };
    let all: Vec<Vec<Row>> = (0..parts.count()).into_par_iter().map(of_part).collect::<Result<_, _>>()?;
    let all = all.concat();
    let drawn = job.draws.map(|drawing| (drawing, (ready.robots.len() - 1) / drawing.n.max(1), ready.beyond));
    let others = parts.others.clone();
    let swept = Swept { name: ready.name, rows: all, each, drawn, resumed: resumed.into_inner(), others };
    let mut blocks = vec![files_read(&data).into()];
    blocks.extend(swept.blocks());
    blocks.extend(swept.figures().map(Block::from));
    let head = Head {
        sort: "Swimming robot · sweep of gaits".to_owned(),
        title: swept.name.clone(),
        summary: "What stands out".to_owned(),
        ..Head::default()
    };
    let rows = table(&swept.rows, &written);
    let files = vec![
        OutputFile { key: "report", path: report, content: Content::Page(head) },
        OutputFile { key: "sweep", path: written, content: Content::Table(rows) },
        OutputFile { key: "record", path: result, content: Content::Result },
    ];
    Ok(Outcome { blocks, files, scratch: Some(parts.scratch()), ..Outcome::default() })
}

/// All that the rows are made from.
#[derive(Debug)]
pub(super) struct Ready<'a, C> {
    job: &'a SweepJob,
    pub(super) name: String,
    pub(super) grid: Grid,
    pub(super) gaits: usize,
    drives: Drives,
    /// The estimated robot first, then one per draw, law by law.
    pub(super) robots: Vec<Robot<C>>,
    /// Draws that were no bodies.
    pub(super) beyond: Beyond,
    pub(super) reads: Reads,
}

impl<'a, C: Dynamics> Ready<'a, C> {
    pub(super) fn new(file: RobotFile, job: &'a SweepJob) -> Result<Self, VerbError> {
        Blueprint::of(&file)?.fitting::<C>()?;
        let (laws, _) = Blueprint::of_all_laws(&file)?;
        let drives = super::drives(&file, job.motor.as_deref())?;
        let grid = job.ranges.about(&base(&file, job)?);
        let too_many = |rows: String| {
            VerbError::Refused(format!(
                "the sweep has {rows}, limit {MOST_ROWS}: take fewer values, or sweep its parts into folders of their own"
            ))
        };
        let each = job.draws.map_or(0, |drawing| drawing.n * laws.len()) + 1;
        let rows = grid.gaits().and_then(|gaits| gaits.checked_mul(each));
        match rows {
            None => return Err(too_many("too many rows to count".to_owned())),
            Some(rows) if rows > MOST_ROWS => return Err(too_many(format!("{rows} rows"))),
            Some(_) => {}
        }
        let (mut robots, mut beyond) = (vec![laws[0].estimated()], Beyond::default());
        for (drawing, law) in job.draws.iter().flat_map(|drawing| laws.iter().map(move |law| (drawing, law))) {
            let draws = law.draws(drawing.n, drawing.seed)?;
            beyond += draws.beyond;
            robots.extend(draws.values.iter().map(|values| law.robot(values)));
        }
        let gaits = grid.gaits().unwrap_or_default();
        let reads = Reads::of(&file, &job.robot, &job.moves, job.motor.as_deref());
        Ok(Self { job, name: file.name, grid, gaits, drives, robots, beyond, reads })
    }

    pub(super) fn row(&self, gait: &Gait, draw: usize) -> Row {
        Row::of(&self.robots[draw], &self.drives, self.job.step_s, gait, draw)
    }
}

/// The gait in numbers.
fn base(file: &RobotFile, job: &SweepJob) -> Result<Gait, VerbError> {
    let no_recording = "is a recording, which has no numbers to sweep: name a gait";
    let found = job.moves.periodically((&job.robot, file), &Pitching::default(), no_recording)?;
    match (found.wave, &job.moves) {
        (Wave::Gait(gait), _) => Ok(gait),
        (Wave::Table(_), Moves::File { path, .. }) => {
            Err(VerbError::input(path, "is a table, which has no numbers to sweep: take another kind"))
        }
        (Wave::Table(_), _) => Err(VerbError::input(&job.robot, no_recording)),
    }
}

/// Columns with their units; a column that no row has is left out.
pub(super) fn table(rows: &[Row], path: &Path) -> Table {
    let of = |(j, (name, unit)): (usize, &(&str, &str))| {
        let si: Vec<f64> = rows.iter().map(|row| row.numbers[j]).collect();
        si.iter().any(|x| x.is_finite()).then(|| column(name, unit, si))
    };
    let mut columns: Vec<Column> = COLUMNS.iter().enumerate().filter_map(of).collect();
    let status: Vec<String> = rows.iter().map(|row| row.status.name().to_owned()).collect();
    columns.push(Column { name: "status".to_owned(), data: ColumnData::Text(status.into()) });
    let line_of_row = (1..=rows.len()).collect();
    Table::of(path.to_owned(), columns, line_of_row)
}
