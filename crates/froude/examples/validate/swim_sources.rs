//! How much the source of the coefficients and the law move a swimmer: a page of the book with its figures, and its lines.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use froude::hydro::drag::DragModel;
use froude::pipeline::{Job, identify};
use froude::records::estimate::Estimate;
use froude::records::page::{Chart, ChartPanel, Mark, Series};
use froude::records::write::write_atomically;
use froude::report::chart;
use froude::swim::blueprint::Blueprint;
use froude::swim::draws::interval_95;
use froude::swim::gait::{Envelope, Gait};
use froude::swim::robot::Robot;
use froude::swim::robot_file::{FromRecord, RobotFile, read_robot};
use froude::swim::shares::Torque;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::swim::{Mamba, SOURCES, coefficients, gait, of_remark, published, ranged, record, swim};

const SECTION: &str = "Swimming: how much the source of the coefficients and the law move";
const LAWS: [(DragModel, &str); 6] = [
    (DragModel::F1, "f1"),
    (DragModel::F2, "f2"),
    (DragModel::F3, "f3"),
    (DragModel::F4, "f4"),
    (DragModel::F5, "f5"),
    (DragModel::F6, "f6"),
];
/// Draws from a covariance.
const DRAWS: usize = 200;

/// What a law of a source comes to.
struct Cell {
    speed_m_s: f64,
    net_w: f64,
    cost_j_m: f64,
    multiplier: f64,
    turn_rad: f64,
    median_angle_rad: f64,
    along: f64,
    /// Shares of the loss outside of the fitted speeds and angles.
    extrapolated: [Option<f64>; 2],
    /// Amplitude and phase, deg, of the fastest gait of the grid, with its speed, m/s.
    fastest: Option<[f64; 3]>,
}

/// The lines, and the page with its figures where it is asked for.
pub fn all(claims: &mut Claims, root: &Path, pages: Option<&Path>) -> Result<(), Box<dyn Error>> {
    let mamba = Mamba::of(root)?;
    let mut cells: Vec<Vec<Option<Cell>>> = Vec::new();
    for (source, _) in SOURCES {
        let of_law = |(model, _): &(DragModel, &str)| -> Result<Option<Cell>, Box<dyn Error>> {
            let estimate = record(root, source, *model)?;
            let robot = mamba.with(*model, &coefficients(&estimate, *model)?, Torque::Strip);
            Ok(cell(&ranged(robot, &estimate)))
        };
        cells.push(LAWS.iter().map(of_law).collect::<Result<_, _>>()?);
    }
    let costs = |of: &dyn Fn(usize, usize) -> bool| -> Vec<f64> {
        let all = (0..SOURCES.len()).flat_map(|s| (0..LAWS.len()).map(move |l| (s, l)));
        all.filter(|(s, l)| of(*s, *l)).filter_map(|(s, l)| cells[s][l].as_ref().map(|c| c.cost_j_m)).collect()
    };
    let (laws, sources) = (spread(&costs(&|s, _| s == 2)), spread(&costs(&|_, l| l == 1)));
    claims.add(
        SECTION,
        "cost of transport, largest over least of the six laws of the tank",
        "4.3 of f1 over f4; f6 is below",
        format!("{laws:.2}"),
        Verdict::Measured,
    );
    claims.add(
        SECTION,
        "the same of the three sources by f2",
        "6.8 at the links' centres, which is 6.1 by strips",
        format!("{sources:.2}"),
        Verdict::Measured,
    );
    let scans = scans(root, &mamba)?;
    for (what, scan) in ["amplitude", "phase"].iter().zip(&scans) {
        for (name, points) in scan {
            let speeds: Vec<f64> = points.iter().map(|p| p[1]).collect();
            let peaks = peaks(&speeds);
            let claim = format!("circulation tank, {name}: maxima of the speed over {what}");
            claims.holds(SECTION, &claim, "one", peaks.to_string(), peaks == 1);
        }
    }
    let drawn = drawn(root)?;
    for law in &drawn {
        let [low, middle, high] = law.cost_j_m;
        claims.add(
            SECTION,
            &format!("twin of the tank, {}: cost and its 95 % interval from the covariance", law.name),
            "what the campaign's noise and declared errors do, if the law is right",
            format!("{middle:.4} ({low:.4} to {high:.4}) J/m, {} of {DRAWS} draws without an answer", law.failed),
            Verdict::Measured,
        );
    }
    let Some(pages) = pages else { return Ok(()) };
    let remark = [(0.3, 1.75, 1.5), (0.01, 1.0, 1.0), (0.03, 1.0, 1.0)];
    let mut sets = String::new();
    for (c_f, c_d, c_a) in remark {
        let found = of_remark(&mamba, c_f, c_d, c_a)?;
        let p = &found.periodic;
        writeln!(
            sets,
            "| C_f {c_f}, C_D {c_d}, C_A {c_a} | {:.4} | {:.4} | {:.3} |",
            p.means.speed_m_s,
            p.means.net_w,
            found.periodic.means.cost_j_m()
        )?;
    }
    let figures = [costs_figure(&cells, &drawn), scan_figure("amplitude", &scans[0]), scan_figure("phase", &scans[1])];
    for figure in &figures {
        write_atomically(&pages.join(format!("{}.svg", figure.name)), chart::svg(figure).as_bytes())?;
    }
    write_atomically(&pages.join("swim-sources.md"), page(&cells, &drawn, &sets, [laws, sources]).as_bytes())?;
    Ok(())
}

fn cell(robot: &Robot) -> Option<Cell> {
    let found = swim(robot, &gait(Envelope::Lateral)).ok()?;
    let p = &found.periodic;
    let grid: Vec<(f64, f64)> =
        (2..=12).flat_map(|a| (2..=16).map(move |d| (5.0 * f64::from(a), 5.0 * f64::from(d)))).collect();
    let speed = |&(amplitude, phase): &(f64, f64)| Some([amplitude, phase, speed_at(robot, amplitude, phase)?.0]);
    let fastest = grid.par_iter().filter_map(speed).max_by(|a, b| a[2].total_cmp(&b[2]));
    Some(Cell {
        speed_m_s: p.means.speed_m_s,
        net_w: p.means.net_w,
        cost_j_m: found.periodic.means.cost_j_m(),
        multiplier: p.multipliers[0],
        turn_rad: p.means.turn,
        median_angle_rad: found.effort.median_angle_rad,
        along: found.effort.along,
        extrapolated: found.effort.extrapolated,
        fastest,
    })
}

/// Speed, m/s, and cost, J/m, at an amplitude and a phase, deg.
fn speed_at(robot: &Robot, amplitude: f64, phase: f64) -> Option<(f64, f64)> {
    let wave = Gait { amplitude: amplitude.to_radians(), phase: phase.to_radians(), ..gait(Envelope::Lateral) };
    let found = swim(robot, &wave).ok().filter(|found| found.periodic.multipliers[0] <= 1.0)?;
    Some((found.periodic.means.speed_m_s, found.periodic.means.cost_j_m()))
}

fn spread(numbers: &[f64]) -> f64 {
    let (low, high) = numbers.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(*x), h.max(*x)));
    high / low
}

/// Points that are above both neighbours, the ends as they are.
fn peaks(y: &[f64]) -> usize {
    let above = |i: usize| (i == 0 || y[i - 1] < y[i]) && (i + 1 == y.len() || y[i + 1] < y[i]);
    (0..y.len()).filter(|i| above(*i)).count()
}

/// What is scanned, speed, cost of each law.
type Scan = Vec<(&'static str, Vec<[f64; 3]>)>;

/// Over the amplitude at 40 deg from joint to joint, and over the phase at 30 deg.
fn scans(root: &Path, mamba: &Mamba) -> Result<[Scan; 2], Box<dyn Error>> {
    let (mut over_amplitude, mut over_phase) = (Vec::new(), Vec::new());
    for (model, name) in LAWS {
        let robot = mamba.with(model, &published(root, SOURCES[2].0, model)?, Torque::Strip);
        let scan = |ends: [i32; 2], of: &(dyn Fn(f64) -> (f64, f64) + Sync)| -> Vec<[f64; 3]> {
            let at = |x: i32| {
                let (amplitude, phase) = of(2.5 * f64::from(x));
                let (speed, cost) = speed_at(&robot, amplitude, phase)?;
                Some([2.5 * f64::from(x), speed, cost])
            };
            (ends[0]..=ends[1]).into_par_iter().filter_map(at).collect()
        };
        over_amplitude.push((name, scan([2, 26], &|x| (x, 40.0))));
        over_phase.push((name, scan([4, 36], &|x| (30.0, x))));
    }
    Ok([over_amplitude, over_phase])
}

/// A law of the twin's campaign.
struct Drawn {
    name: String,
    /// 2.5 %, the estimate, 97.5 %.
    speed_m_s: [f64; 3],
    cost_j_m: [f64; 3],
    /// Draws that still water would drive, taken as the nearest law that it does not.
    brought_back: usize,
    failed: usize,
}

/// Fits the six laws to the example campaign, and swims draws from each one's covariance.
fn drawn(root: &Path) -> Result<Vec<Drawn>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let example = root.join("examples/mamba");
    std::fs::create_dir(folder.path().join("published"))?;
    for entry in std::fs::read_dir(example.join("published"))? {
        let from = entry?;
        std::fs::copy(from.path(), folder.path().join("published").join(from.file_name()))?;
    }
    let campaign = folder.path().join("campaign.toml");
    std::fs::copy(example.join("campaign.toml"), &campaign)?;
    froude::twin::simulate(&campaign, false)?;
    let mut job = Job::new(campaign);
    job.out = Some(folder.path().join("results"));
    let file = identify(&job, &|_| {})?.file;
    let own = file.estimates.iter().filter(|e| e.source == "circulation tank twin");
    let robot = read_robot(&root.join("examples/mamba-swim/robot.toml"))?;
    let from = |e: &Estimate| FromRecord {
        path: folder.path().join("results/estimate.json"),
        select: Some(e.id.clone()),
        place: robot.drag.place.clone(),
    };
    own.filter(|e| DragModel::from_name(&e.law.name).is_some())
        .map(|e| draws(&RobotFile { drag: from(e), ..robot.clone() }, &e.law.name))
        .collect()
}

/// As `froude swim --draws` does it.
fn draws(file: &RobotFile, law: &str) -> Result<Drawn, Box<dyn Error>> {
    let blueprint = Blueprint::of(file)?;
    let draws = blueprint.draws(DRAWS, 1)?;
    let of = |robot: &Robot| {
        let found = swim(robot, &gait(Envelope::Lateral)).ok()?;
        Some([found.periodic.means.speed_m_s, found.periodic.means.cost_j_m()])
    };
    let best = of(&blueprint.estimated()).ok_or_else(|| format!("{law} does not swim"))?;
    let all: Vec<[f64; 2]> = draws.values.par_iter().filter_map(|values| of(&blueprint.robot(values))).collect();
    let interval = |k: usize| -> Result<[f64; 3], String> {
        let numbers: Vec<f64> = all.iter().map(|x| x[k]).collect();
        let [low, high] = interval_95(&numbers).ok_or_else(|| format!("{law}: no two draws swim"))?;
        Ok([low, best[k], high])
    };
    Ok(Drawn {
        name: law.to_owned(),
        speed_m_s: interval(0)?,
        cost_j_m: interval(1)?,
        brought_back: draws.beyond.brought_back,
        failed: DRAWS - all.len(),
    })
}

fn series(name: &str, mark: Mark, x: Vec<f64>, y: Vec<f64>) -> Series {
    Series { name: name.to_owned(), mark, x, y, ..Series::default() }
}

fn panel(y_label: &str, series: Vec<Series>) -> ChartPanel {
    ChartPanel { y_label: y_label.to_owned(), series, ..ChartPanel::default() }
}

/// Speed and cost by law, a mark for each source, and the intervals of the twin.
fn costs_figure(cells: &[Vec<Option<Cell>>], drawn: &[Drawn]) -> Chart {
    let of = |of: &dyn Fn(&Cell) -> f64, drawn_of: &dyn Fn(&Drawn) -> [f64; 3]| -> Vec<Series> {
        let mut all: Vec<Series> = SOURCES
            .iter()
            .zip(cells)
            .map(|((_, name), laws)| {
                let points = laws.iter().enumerate().filter_map(|(l, c)| Some((l as f64 + 1.0, of(c.as_ref()?))));
                let (x, y) = points.unzip();
                series(name, Mark::Points, x, y)
            })
            .collect();
        let place = |name: &str| LAWS.iter().position(|(_, law)| *law == name).map_or(f64::NAN, |l| l as f64 + 1.2);
        let three: Vec<(f64, [f64; 3])> = drawn.iter().map(|d| (place(&d.name), drawn_of(d))).collect();
        all.push(Series {
            low: three.iter().map(|(_, t)| t[0]).collect(),
            high: three.iter().map(|(_, t)| t[2]).collect(),
            ..series(
                "twin of the tank, with its 95 % interval",
                Mark::Points,
                three.iter().map(|(x, _)| *x).collect(),
                three.iter().map(|(_, t)| t[1]).collect(),
            )
        });
        all
    };
    Chart {
        name: "swim-sources-laws".to_owned(),
        title: "Speed and cost of transport by law and source".to_owned(),
        caption: "Speed and cost of transport of the lateral undulation by each law and source.".to_owned(),
        x_label: "law f1 to f6".to_owned(),
        panels: vec![
            panel("speed [m/s]", of(&|c| c.speed_m_s, &|d| d.speed_m_s)),
            panel("cost of transport [J/m]", of(&|c| c.cost_j_m, &|d| d.cost_j_m)),
        ],
        ..Chart::default()
    }
}

fn scan_figure(what: &str, scan: &Scan) -> Chart {
    let of = |k: usize| {
        let line = |(name, points): &(&str, Vec<[f64; 3]>)| {
            let (x, y) = points.iter().map(|p| (p[0], p[k])).unzip();
            series(name, Mark::Line, x, y)
        };
        scan.iter().map(line).collect()
    };
    Chart {
        name: format!("swim-sources-{what}"),
        title: format!("Speed and cost of transport over the {what}"),
        caption: format!("Speed and cost of transport over the {what} by the six laws of the circulation tank."),
        x_label: format!("{what} [deg]"),
        panels: vec![panel("speed [m/s]", of(1)), panel("cost of transport [J/m]", of(2))],
        ..Chart::default()
    }
}

fn share(of: Option<f64>) -> String {
    of.map_or("not stated".to_owned(), |part| format!("{:.1} %", 100.0 * part))
}

/// Which intervals hold what the truth of the twin, published f4 of the tank, comes to.
fn truth(of: &Cell, drawn: &[Drawn]) -> String {
    let held = |truth: f64, ends: &dyn Fn(&Drawn) -> [f64; 3]| {
        let names: Vec<&str> =
            drawn.iter().filter(|d| (ends(d)[0]..=ends(d)[2]).contains(&truth)).map(|d| d.name.as_str()).collect();
        if names.is_empty() { "no law".to_owned() } else { names.join(", ") }
    };
    format!(
        "The truth, f4 as it was published, swims at {:.4} m/s for {:.3} J/m. It lies in the interval of speed of {}, and in that of the cost of {}; the other intervals miss it.\n\n",
        of.speed_m_s,
        of.cost_j_m,
        held(of.speed_m_s, &|d| d.speed_m_s),
        held(of.cost_j_m, &|d| d.cost_j_m)
    )
}

fn page(cells: &[Vec<Option<Cell>>], drawn: &[Drawn], sets: &str, [laws, sources]: [f64; 2]) -> String {
    let cost_of = |cell: &Option<Cell>| cell.as_ref().map(|c| c.cost_j_m);
    let over_laws = |source: usize| spread(&cells[source].iter().filter_map(cost_of).collect::<Vec<f64>>());
    let (of_cfd, of_rig) = (over_laws(0), over_laws(1));
    let of_f6 = spread(&cells.iter().filter_map(|row| cost_of(&row[5])).collect::<Vec<f64>>());
    let own = spread(&drawn.iter().map(|d| d.cost_j_m[1]).collect::<Vec<f64>>());
    let mut out = format!(
        "# What the coefficients do to a swimmer\n\nThis page is written by `cargo xtask validate`, with every number of its tables. The robot of `examples/mamba-swim` swims with the published coefficients of the three sources of the USR paper and its six laws: \
         lateral undulation, amplitude 30 deg, 80 deg/s, 40 deg from joint to joint, drag by strips, added mass as measured.\n\n\
         Over the six laws of the tank the cost of transport differs by a factor of {laws:.1}, over the three sources within f2 by {sources:.1}; over the laws of CFD by {of_cfd:.1}, of the towing rig by {of_rig:.1}, over the sources within f6 by {of_f6:.1}. Published fits differ by more than their laws: fitted to the same observations (below), the six laws differ by {own:.1}. A cost of transport without the law and the source of its drag says little.\n\n\
         ![Speed and cost of transport by law and source](swim-sources-laws.svg)\n\n\
         | source | law | speed, m/s | net power, W | cost, J/m | largest Floquet multiplier | turn per period, deg | median angle of the loss, deg | loss along the links | outside of the fitted speeds | outside of the fitted angles | fastest gait: amplitude, phase, deg; speed, m/s |\n\
         | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n"
    );
    for ((_, source), row) in SOURCES.iter().zip(cells) {
        for ((_, law), cell) in LAWS.iter().zip(row) {
            let line = match cell {
                None => format!("| {source} | {law} | no motion that repeats | | | | | | | | | |\n"),
                Some(c) => {
                    let fastest = c.fastest.map_or("none".to_owned(), |[a, d, u]| format!("{a:.0}, {d:.0}; {u:.4}"));
                    format!(
                        "| {source} | {law} | {:.4} | {:.4} | {:.3} | {:.3} | {:.2} | {:.1} | {:.0} % | {} | {} | {fastest} |\n",
                        c.speed_m_s,
                        c.net_w,
                        c.cost_j_m,
                        c.multiplier,
                        c.turn_rad.to_degrees(),
                        c.median_angle_rad.to_degrees(),
                        100.0 * c.along,
                        share(c.extrapolated[0]),
                        share(c.extrapolated[1]),
                    )
                }
            };
            out += &line;
        }
    }
    out += &format!(
        "\nThe fastest gait is of a grid from 10 to 60 deg of amplitude and 10 to 80 deg of phase, in steps of 5 deg, at 80 deg/s. It is the fastest of those that are stable. A multiplier above 1 means that the swimmer leaves this motion. The laws f3 to f6 of CFD turn: these robots swim on a circle, whose mirror image is another motion of theirs, and their speed is that of a period's chord. Where the fastest gait has 10 deg of phase it lies in a corner of the grid: the joints bend almost together, by more than 360 deg in all, so that the body would cross itself, which the model does not see.\n\n\
            Half of the loss is at small angles to the flow, where the drag across is small and hard to measure, and much of it along the links. What the coefficients were fitted at is in their records; the share of the loss at speeds and angles outside of it stands beside.\n\n\
            ## Is the difference one of noise?\n\n\
            The twin of the tank's campaign (`examples/mamba`) has f4 as its truth and 0.02 N of noise. All laws are fitted to the same 536 observations, and {DRAWS} draws from each one's covariance swim:\n\n\
            | law | speed, m/s | 95 % | cost, J/m | 95 % | draws brought back | draws without an answer |\n| --- | --: | --: | --: | --: | --: | --: |\n"
    );
    for d in drawn {
        let ([u0, u, u1], [c0, c, c1]) = (d.speed_m_s, d.cost_j_m);
        out += &format!(
            "| {} | {u:.4} | {u0:.4} to {u1:.4} | {c:.3} | {c0:.3} to {c1:.3} | {} | {} |\n",
            d.name, d.brought_back, d.failed
        );
    }
    let truth = cells[2][3].as_ref().map_or_else(String::new, |c| truth(c, drawn));
    out += &format!(
        "\n{truth}An interval holds what the noise of the campaign and its declared errors do, if the law is right. It does not hold the choice of the law. Draws are those of `froude swim --draws`; those that still water would drive are taken as the nearest law that it does not. The bodies that were measured have one and two links, so that eight are beyond what any law was fitted at.\n\n\
         ## Amplitude and phase\n\n![Speed and cost of transport over the amplitude](swim-sources-amplitude.svg)\n\n![Speed and cost of transport over the phase](swim-sources-phase.svg)\n\n\
         ## The two sets of Remark 1\n\nThe USR paper names two sets that are in use: C_f 0.3, C_D 1.75, C_A 1.5, and the theoretical C_f 0.01 to 0.03, C_D 1, C_A 1. C_M 1 of both has no part in the planar gait here: λ₁ is μ l²/3. \
         With f1 (linear and quadratic terms alike) at the links' centres they swim as follows:\n\n\
         | set | speed, m/s | net power, W | cost, J/m |\n| --- | --: | --: | --: |\n{sets}\n\
         The first needs 30 times what f2 of the tank does at the links' centres (0.923 J/m). Its linear terms, which are those of 1 m/s, make the larger part of that.\n"
    );
    out
}
