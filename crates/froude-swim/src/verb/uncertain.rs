//! `froude swim --draws` and `--sensitivity`: what the coefficients' uncertainty makes of a gait.

use std::sync::atomic::{AtomicUsize, Ordering};

use froude_records::block::{Block, ResultColumn, Section, TableBuilder, facts};
use froude_records::number::{percent, significant};
use froude_records::text::counted;
use rayon::prelude::*;

use super::{Job, VerbError};
use crate::blueprint::Blueprint;
use crate::draws::{Beyond, envelope_95};
use crate::dynamics::Dynamics;
use crate::robot::Robot;
use crate::robot_file::RobotFile;
use crate::sensitivity::{Effect, Sensitivities, Sensitivity};

/// How many draws, and the seed of their random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drawing {
    /// How many.
    pub n: usize,
    /// Of the same draws the same.
    pub seed: u64,
}

/// What came of the draws.
struct Drawn {
    asked: Drawing,
    /// The laws that they are of, that of the estimate first: the others are those that the data do not contradict either. Each has as many draws.
    laws: Vec<String>,
    /// Laws that the data do not contradict either, and that this robot cannot have, or that cannot be drawn.
    left_out: Vec<String>,
    beyond: Beyond,
    without_answer: usize,
    /// Draws whose figures are those of the motion that an unstable one settles into, and of a motion that stays unstable.
    unstable: [usize; 2],
    /// 95 % of speed, m/s, net and positive power, W, and cost of transport, J/m: the envelope over the laws.
    intervals: [[f64; 2]; 4],
}

/// Draws the coefficients, and changes each by itself, for the gait of a job; `tell` hears how many draws are done.
///
/// # Errors
///
/// A gait without an answer; records without a covariance where draws are asked for.
pub(super) fn uncertain<C: Dynamics>(
    file: &RobotFile,
    job: &Job,
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<Block>, VerbError> {
    if job.draws.is_none() && !job.is_sensitive {
        return Ok(Vec::new());
    }
    let drives = super::drives(file, job.motor.as_deref())?;
    let blueprint = Blueprint::of(file)?.fitting::<C>()?;
    let no_recording = "is a recording; draws and sensitivities are of a gait";
    let of = job.moves.periodically((&job.robot, file), &job.pitching, no_recording)?;
    let swim = |robot: &Robot<C>| robot.swim(of.course(), &drives, job.step_s);
    // A gait without an answer says why before anything is drawn.
    swim(&blueprint.estimated())?;
    let drawn = match job.draws {
        None => None,
        Some(asked) => {
            let (laws, left_out) = Blueprint::of_all_laws(file)?;
            let (done, all) = (AtomicUsize::new(0), asked.n * laws.len());
            let mut beyond = Beyond::default();
            let mut by_law: Vec<Vec<([f64; 4], [bool; 2])>> = Vec::new();
            for law in &laws {
                let draws = law.draws(asked.n, asked.seed)?;
                beyond += draws.beyond;
                let one = |values: &Vec<f64>| {
                    let found = swim(&law.robot(values)).ok()?;
                    tell(done.fetch_add(1, Ordering::Relaxed) + 1, all);
                    let (p, m) = (&found.periodic, &found.periodic.means);
                    let is = [found.unstable.is_some(), p.is_unstable()];
                    Some(([m.speed_m_s, m.net_w, m.positive_w, m.cost_j_m()], is))
                };
                by_law.push(draws.values.par_iter().filter_map(one).collect());
            }
            let column = |k: usize| -> Vec<Vec<f64>> {
                by_law.iter().map(|found| found.iter().map(|(row, _)| row[k]).collect()).collect()
            };
            let envelope = |k: usize| envelope_95(column(k).iter().map(Vec::as_slice)).unwrap_or([f64::NAN; 2]);
            let unstable = [0, 1].map(|k| by_law.iter().flatten().filter(|(_, is)| is[k]).count());
            let answers: usize = by_law.iter().map(Vec::len).sum();
            let laws = laws.iter().map(|law| law.id().to_owned()).collect();
            let intervals = [0, 1, 2, 3].map(envelope);
            Some(Drawn { asked, laws, left_out, beyond, unstable, without_answer: all - answers, intervals })
        }
    };
    let sensitivities = if job.is_sensitive {
        let answer =
            |robot: &Robot<C>| swim(robot).ok().map(|s| [s.periodic.means.speed_m_s, s.periodic.means.cost_j_m()]);
        blueprint.sensitivities(answer)
    } else {
        None
    };
    let sensitivities = sensitivities.map(|found| of_sensitivities(&found));
    Ok(drawn.map(|drawn| drawn.section()).into_iter().chain(sensitivities).map(Block::from).collect())
}

/// What became of draws that are no bodies in water.
pub(super) fn bodies(n: usize, beyond: Beyond) -> Vec<String> {
    let mut said = Vec::new();
    if beyond.brought_back > 0 {
        said.push(format!(
            "still water would give power to the robot by {} of {}: each was moved to the nearest law that takes power, where an interval may end",
            beyond.brought_back,
            counted(n, "draw", "draws")
        ));
    }
    if 2 * beyond.brought_back > n {
        said.push("most draws lie outside of what water allows: the interval is that of the boundary, and too narrow; choose a law with fewer terms".to_owned());
    }
    if beyond.refused > 0 {
        said.push(format!(
            "{} refused and drawn again: the added mass is not positive, or no law near it takes power; the intervals are of those that are left",
            counted(beyond.refused, "draw was", "draws were")
        ));
    }
    said
}

/// How often the coefficients of a sweep were drawn, for programs.
pub(super) fn of_draws((drawing, laws, beyond): &(Drawing, usize, Beyond)) -> Vec<ResultColumn> {
    let f = facts("", "", drawing);
    vec![
        f.count("draws/n", "", |d| d.n),
        f.count("draws/laws", "", |_| *laws),
        f.count("draws/seed", "", |d| d.seed as usize),
        f.count("draws/brought_back", "", |_| beyond.brought_back),
        f.count("draws/refused", "", |_| beyond.refused),
    ]
}

impl Drawn {
    fn section(&self) -> Section {
        let mut paragraphs = bodies(self.asked.n * self.laws.len(), self.beyond);
        if self.laws.len() > 1 {
            paragraphs.push(format!(
                "each interval is the envelope over the laws that the data do not contradict and this robot can use, with as many draws of each: {}",
                self.laws.join(", ")
            ));
        }
        if !self.left_out.is_empty() {
            paragraphs.push(format!(
                "not in the intervals, as this robot cannot have them or they cannot be drawn: {}; the intervals may be too narrow",
                self.left_out.join(", ")
            ));
        }
        if self.without_answer > 0 {
            let words = counted(self.without_answer, "draw has", "draws have");
            paragraphs.push(format!("{words} no motion that repeats, and are in no interval"));
        }
        let [settled, stays] = self.unstable;
        if settled > 0 {
            let words = counted(settled, "draw has", "draws have");
            paragraphs.push(format!("{words} an unstable motion; the intervals use the motion that it settles into"));
        }
        if stays > 0 {
            let words = counted(stays, "draw has", "draws have");
            paragraphs.push(format!(
                "{words} an unstable motion that settles into none that repeats each period; the intervals use the unstable motion"
            ));
        }
        let caption = format!(
            "95 % intervals from the coefficients' covariance ({}, seed {})",
            counted(self.asked.n, "draw", "draws"),
            self.asked.seed
        );
        let f = facts("interval_95", caption, self);
        let intervals = f.build(vec![
            f.interval("speed_m_s", "speed [m/s]", |d| d.intervals[0]),
            f.interval("power_net_w", "net power [W]", |d| d.intervals[1]),
            f.interval("power_positive_w", "positive power [W]", |d| d.intervals[2]),
            f.interval("cost_of_transport_j_m", "cost of transport [J/m]", |d| d.intervals[3]),
        ]);
        let f = facts("", "", self);
        let about = f.build(vec![
            f.count("n", "", |d| d.asked.n),
            f.texts("laws", "", |d| d.laws.clone()),
            f.texts("left_out", "", |d| d.left_out.clone()),
            f.count("seed", "", |d| d.asked.seed as usize),
            f.count("brought_back", "", |d| d.beyond.brought_back),
            f.count("refused", "", |d| d.beyond.refused),
            f.count("without_answer", "", |d| d.without_answer),
            f.count("settled_from_unstable", "", |d| d.unstable[0]),
            f.count("unstable", "", |d| d.unstable[1]),
        ]);
        let blocks = vec![about.into(), intervals.into(), Block::text("", paragraphs)];
        let (key, title) = ("uncertainty/draws".to_owned(), "Intervals".to_owned());
        Section { key, title, blocks, ..Section::default() }
    }
}

fn of_sensitivities(found: &Sensitivities) -> Section {
    let mut paragraphs = Vec::new();
    match found.standard {
        None => paragraphs.push(
            "the records state no uncertainty: only elasticities are given; what to measure next cannot be ranked"
                .to_owned(),
        ),
        Some(standard) => {
            for (k, (of, unit)) in [("speed", "m/s"), ("cost of transport", "J/m")].iter().enumerate() {
                let known = |s: &Sensitivity| s.effects.and_then(|e| e[k].known);
                let most = found.each.iter().filter_map(|s| Some((known(s)?, &s.number.name)));
                if let Some((part, name)) = most.max_by(|a, b| a.0.total_cmp(&b.0)) {
                    paragraphs.push(format!(
                        "{of}: standard uncertainty {} {unit} by the coefficients; measure {name} next: knowing it exactly would remove {} of the variance",
                        significant(standard[k], 2),
                        percent(part)
                    ));
                }
            }
        }
    }
    let f = facts("standard_uncertainty", "", found);
    let standard = f.build(vec![
        f.number("speed_m_s", "", |f| f.standard.map(|[speed, _]| speed)),
        f.number("cost_of_transport_j_m", "", |f| f.standard.map(|[_, cost]| cost)),
    ]);
    let caption =
        "sensitivity of speed and cost to each coefficient, and the share of variance removed if it were known exactly";
    let t = TableBuilder::new("coefficients", caption, &found.each);
    let effect = |s: &Sensitivity, k: usize, of: fn(&Effect) -> Option<f64>| s.effects.as_ref().and_then(|e| of(&e[k]));
    let elasticity = |e: &Effect| Some(e.elasticity);
    let coefficients = t.build(vec![
        t.text("name", "coefficient", |s| s.number.name.clone()),
        t.number("value", "value", |s| s.number.value),
        t.text("unit", "unit", |s| s.number.unit.clone()),
        t.number("standard_uncertainty", "standard uncertainty", |s| s.number.standard).significant(3),
        t.number("speed/elasticity", "speed elasticity", |s| effect(s, 0, elasticity)).significant(3),
        t.number("speed/derivative", "", |s| effect(s, 0, |e| Some(e.derivative))),
        t.number("speed/variance_gone_if_known", "share of speed variance", |s| effect(s, 0, |e| e.known)).percent(),
        t.number("cost_of_transport/elasticity", "cost elasticity", |s| effect(s, 1, elasticity)).significant(3),
        t.number("cost_of_transport/derivative", "", |s| effect(s, 1, |e| Some(e.derivative))),
        t.number("cost_of_transport/variance_gone_if_known", "share of cost variance", |s| effect(s, 1, |e| e.known))
            .percent(),
    ]);
    let blocks = vec![standard.into(), coefficients.into(), Block::text("", paragraphs)];
    let (key, title) = ("uncertainty/sensitivities".to_owned(), "Sensitivities".to_owned());
    Section { key, title, blocks, ..Section::default() }
}
