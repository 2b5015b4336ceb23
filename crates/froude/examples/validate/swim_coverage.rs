//! Whether the intervals of `froude swim --draws` hold the speed and the cost that the true coefficients swim with.
//!
//! A seeded twin of the tank's campaign is identified by the verb's pipeline, its record drawn from as the verb does it, and the ends compared with what the truth comes to. The truths are published: f4 of the tank, in which two coefficients are at
//! their bounds of zero, and f2.

use std::error::Error;
use std::path::Path;

use froude::fit::coverage::{Count, z_limit};
use froude::hydro::drag::DragModel;
use froude::pipeline::{Job, identify};
use froude::records::write::write_atomically;
use froude::swim::blueprint::Blueprint;
use froude::swim::draws::interval_95;
use froude::swim::gait::Envelope;
use froude::swim::robot::Robot;
use froude::swim::robot_file::{FromRecord, RobotFile, read_robot};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::Claims;
use crate::coverage::normal;
use crate::swim::{gait, swim};

const SECTION: &str = "Swimming: coverage of the intervals of speed and cost";
/// Draws from a covariance.
const DRAWS: usize = 400;
/// Speed and cost of four kinds of campaign.
const INTERVALS: usize = 8;
/// Standard uncertainty of a scale, as the example declares it.
const SCALE: f64 = 0.005;

type Failed = Box<dyn Error + Send + Sync>;

/// One kind of campaign.
struct Kind {
    law: DragModel,
    /// Bounds of zero, or none.
    is_bounded: bool,
    /// Errors of force and speed that are declared, and drawn for each campaign.
    errs: bool,
    /// N.
    noise_n: f64,
}

impl Kind {
    fn words(&self) -> String {
        format!(
            "truth {}, {} N of noise, {}{}",
            self.law.name(),
            self.noise_n,
            if self.is_bounded { "non-negative" } else { "no bounds" },
            if self.errs { ", errors of scale declared" } else { "" }
        )
    }

    /// The campaign of the example with this truth and law alone.
    fn campaign(&self, text: &str, seed: usize) -> String {
        let name = self.law.name();
        let mut out = String::new();
        // Its first source alone, which is the twin.
        let (mut table, mut is_left_out) = (String::new(), false);
        let mut sources = 0;
        for line in text.lines() {
            if line.starts_with('[') {
                line.clone_into(&mut table);
                sources += usize::from(table == "[[source]]");
                let is_uncertainty = table == "[[source.uncertainty]]" && !self.errs;
                let is_other_source = sources > 1 && table.starts_with("[[source");
                is_left_out = is_uncertainty || is_other_source;
            }
            let changed = match line.split('=').next().map(str::trim) {
                _ if is_left_out => continue,
                Some("models") => format!("models = [\"{name}\"]"),
                Some("bounds") if !self.is_bounded => continue,
                Some("seed") => format!("seed = {seed}"),
                Some("select") => format!("select = \"circulation_tank_restricted/{name}\""),
                Some("noise") => format!("noise = \"{} N\"", self.noise_n),
                _ => line.to_owned(),
            };
            out += &changed;
            out.push('\n');
        }
        out
    }

    /// Whether the intervals of speed and cost of one campaign hold the truth's; with how many draws were brought back.
    fn one(&self, root: &Path, robot: &RobotFile, truth: [f64; 2], seed: usize) -> Result<([bool; 2], usize), Failed> {
        let example = root.join("examples/mamba");
        let folder = tempfile::tempdir()?;
        let campaign = folder.path().join("campaign.toml");
        let record = "published/circulation_tank_restricted.json";
        std::fs::create_dir(folder.path().join("published"))?;
        std::fs::copy(example.join(record), folder.path().join(record))?;
        let text = std::fs::read_to_string(example.join("campaign.toml"))?;
        std::fs::write(&campaign, self.campaign(&text, seed))?;
        froude::twin::simulate(&campaign, false)?;
        if self.errs {
            let mut rng = Pcg64::new(seed as u128, 15);
            let scales = [(); 3].map(|()| 1.0 + SCALE * normal(&mut rng));
            err(&folder.path().join("tank.csv"), scales)?;
        }
        let mut job = Job::new(campaign);
        job.out = Some(folder.path().join("results"));
        let file = identify(&job, &|_| {})?.file;
        let id = file.estimates.first().ok_or("no estimate")?.id.clone();
        let from = FromRecord {
            path: folder.path().join("results/estimate.json"),
            select: Some(id),
            place: robot.drag.place.clone(),
        };
        let blueprint = Blueprint::of(&RobotFile { drag: from, ..robot.clone() })?;
        let draws = blueprint.draws(DRAWS, seed as u64)?;
        let swum: Vec<[f64; 2]> = draws.values.iter().filter_map(|values| answer(&blueprint.robot(values))).collect();
        let mut holds = [false; 2];
        for k in 0..2 {
            let [low, high] = interval_95(&swum.iter().map(|x| x[k]).collect::<Vec<f64>>()).ok_or("no draw swims")?;
            holds[k] = (low..=high).contains(&truth[k]);
        }
        Ok((holds, draws.beyond.brought_back))
    }
}

fn answer(robot: &Robot) -> Option<[f64; 2]> {
    let found = swim(robot, &gait(Envelope::Lateral)).ok()?;
    Some([found.periodic.means.speed_m_s, found.periodic.means.cost_j_m()])
}

/// Scales the forces and the speeds of a table.
fn err(path: &Path, [f_x, f_y, speed]: [f64; 3]) -> Result<(), Failed> {
    let text = std::fs::read_to_string(path)?;
    let mut lines = text.lines();
    let head = lines.next().ok_or("an empty table")?;
    let scale = |name: &str| match name {
        _ if name.starts_with("f_x") => f_x,
        _ if name.starts_with("f_y") => f_y,
        _ if name.starts_with("speed") => speed,
        _ => 1.0,
    };
    let scales: Vec<f64> = head.split(',').map(scale).collect();
    let cell = |(cell, scale): (&str, &f64)| match cell.parse::<f64>() {
        Ok(number) if *scale != 1.0 => (number * scale).to_string(),
        _ => cell.to_owned(),
    };
    let row = |line: &str| line.split(',').zip(&scales).map(cell).collect::<Vec<String>>().join(",");
    let out: Vec<String> = std::iter::once(head.to_owned()).chain(lines.map(row)).collect();
    write_atomically(path, (out.join("\n") + "\n").as_bytes())?;
    Ok(())
}

/// The lines.
pub fn all(claims: &mut Claims, root: &Path, campaigns: usize) -> Result<(), Box<dyn Error>> {
    let robot = read_robot(&root.join("examples/mamba-swim/robot.toml"))?;
    let limit = z_limit(0.01, INTERVALS);
    let kinds = [
        Kind { law: DragModel::F2, is_bounded: false, errs: false, noise_n: 0.02 },
        Kind { law: DragModel::F4, is_bounded: true, errs: false, noise_n: 0.02 },
        Kind { law: DragModel::F4, is_bounded: true, errs: true, noise_n: 0.02 },
        Kind { law: DragModel::F4, is_bounded: false, errs: false, noise_n: 0.1 },
    ];
    for kind in kinds {
        let select = Some(format!("circulation_tank_restricted/{}", kind.law.name()));
        let drag = FromRecord {
            path: root.join("examples/mamba/published/circulation_tank_restricted.json"),
            select,
            place: robot.drag.place.clone(),
        };
        let truth = answer(&Robot::of(&RobotFile { drag, ..robot.clone() })?).ok_or("the truth does not swim")?;
        let found: Vec<([bool; 2], usize)> = (1..=campaigns)
            .into_par_iter()
            .map(|seed| kind.one(root, &robot, truth, seed).map_err(|e| format!("seed {seed}: {e}")))
            .collect::<Result<_, _>>()?;
        let mut counts = [Count::default(); 2];
        for (holds, _) in &found {
            for k in 0..2 {
                counts[k].add(holds[k]);
            }
        }
        let back = found.iter().map(|(_, back)| back).sum::<usize>() as f64 / (DRAWS * campaigns) as f64;
        let words = ["speed", "cost of transport"]
            .iter()
            .zip(counts)
            .map(|(name, count)| format!("{name} {:.1} % (z {:+.2})", 100.0 * count.rate(), count.z_score(0.95)));
        claims.holds(
            SECTION,
            &format!("{}: {campaigns} campaigns", kind.words()),
            &format!("not below 95 % by more than chance allows: z ≥ −{limit:.2} (1 % family-wise over the {INTERVALS} intervals)"),
            format!("{}; {:.0} % of draws brought back", words.collect::<Vec<_>>().join(", "), 100.0 * back),
            counts.iter().all(|count| count.z_score(0.95) >= -limit),
        );
    }
    Ok(())
}
