//! `froude swim --draws` and `--sensitivity`: what the coefficients' uncertainty makes of a gait.

use std::sync::atomic::{AtomicUsize, Ordering};

use froude_records::number::{interval, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use froude_swim::blueprint::Blueprint;
use froude_swim::draws::{Beyond, envelope_95};
use froude_swim::robot::Robot;
use froude_swim::sensitivity::{Effect, Sensitivities};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::moves::{Moves, Periodically, Wave, flat_gait_of};
use super::{Job, SwimInput};
use crate::Error;

/// How many draws, and the seed of their random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Drawing {
    /// How many.
    pub n: usize,
    /// Of the same draws the same.
    pub seed: u64,
}

/// What came of the draws.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// What was asked for.
    pub asked: Drawing,
    /// The laws that they are of, that of the estimate first: the others are those that the data do not contradict either. Each has as many draws.
    pub laws: Vec<String>,
    /// Laws that the data do not contradict either, and that this robot cannot have, or that cannot be drawn.
    pub left_out: Vec<String>,
    /// Draws that were no bodies.
    pub beyond: Beyond,
    /// Draws with which the gait has no answer.
    pub without_answer: usize,
    /// Draws whose figures are those of the motion that an unstable one settles into, and of a motion that stays unstable.
    pub unstable: [usize; 2],
    /// 95 % of speed, m/s, net and positive power, W, and cost of transport, J/m: the envelope over the laws.
    pub intervals: [[f64; 2]; 4],
}

/// What the uncertainty of coefficients makes of a gait.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    /// By draws.
    pub drawn: Option<Drawn>,
    /// By derivatives.
    pub sensitivities: Option<Sensitivities>,
}

/// Draws the coefficients, and changes each by itself, for the gait of a job; `tell` hears how many draws are done.
///
/// # Errors
///
/// As [`super::swim`]; records without a covariance where draws are asked for.
pub fn uncertain(
    job: &Job,
    drawing: Option<Drawing>,
    is_sensitive: bool,
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Uncertain, Error> {
    let file = super::planar(&job.robot)?;
    let drives = super::drives(&file, job.motor.as_deref())?;
    let blueprint = Blueprint::of(&file)?;
    let of = match &job.moves {
        Moves::Wave(gait) => Periodically { wave: Wave::Gait(gait.clone()), pitch: None, ramp_s: None },
        Moves::File { path, typed } => flat_gait_of(path, typed, file.modules.len() - 1)?,
        Moves::Track(path) => {
            let problem = "is a recording; draws and sensitivities are of a gait".to_owned();
            return Err(SwimInput { path: path.clone(), problem }.into());
        }
    };
    let swim = |robot: &Robot| robot.swim(of.course(), &drives, job.step_s);
    // A gait without an answer says why before anything is drawn.
    swim(&blueprint.estimated())?;
    let drawn = match drawing {
        None => None,
        Some(asked) => {
            let (laws, left_out) = Blueprint::of_all_laws(&file)?;
            let (done, all) = (AtomicUsize::new(0), asked.n * laws.len());
            let mut beyond = Beyond::default();
            let mut by_law: Vec<Vec<([f64; 4], [bool; 2])>> = Vec::new();
            for law in &laws {
                let draws = law.draws(asked.n, asked.seed)?;
                beyond += draws.beyond;
                let one = |values: &Vec<f64>| {
                    let found = swim(&law.robot(values)).ok()?;
                    tell(done.fetch_add(1, Ordering::Relaxed) + 1, all);
                    let p = &found.periodic;
                    let is = [found.unstable.is_some(), p.multipliers[0] > 1.0];
                    Some(([p.speed_m_s, p.net_w, p.positive_w, found.cost_j_m], is))
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
    let sensitivities = if is_sensitive {
        let answer = |robot: &Robot| swim(robot).ok().map(|s| [s.periodic.speed_m_s, s.cost_j_m]);
        blueprint.sensitivities(answer)
    } else {
        None
    };
    Ok(Uncertain { drawn, sensitivities })
}

/// What intervals are of, with the unit and the name in JSON.
const OF: [(&str, &str, &str); 4] = [
    ("speed", "m/s", "speed_m_s"),
    ("net power", "W", "power_net_w"),
    ("positive power", "W", "power_positive_w"),
    ("cost of transport", "J/m", "cost_of_transport_j_m"),
];

impl Uncertain {
    /// What a person reads.
    #[must_use]
    pub fn sections(&self) -> Vec<DocumentSection> {
        let drawn = self.drawn.as_ref().map(Drawn::section);
        drawn.into_iter().chain(self.sensitivities.as_ref().map(of_sensitivities)).collect()
    }

    /// The same for a program, each number in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        json!({
            "draws": self.drawn.as_ref().map(|d| json!({
                "n": d.asked.n,
                "laws": d.laws,
                "left_out": d.left_out,
                "seed": d.asked.seed,
                "brought_back": d.beyond.brought_back,
                "refused": d.beyond.refused,
                "without_answer": d.without_answer,
                "settled_from_unstable": d.unstable[0],
                "unstable": d.unstable[1],
                "interval_95": OF.iter().zip(d.intervals).map(|((.., key), ends)| ((*key).to_owned(), json!(ends))).collect::<serde_json::Map<_, _>>(),
            })),
            "sensitivities": self.sensitivities.as_ref().map(|s| json!({
                "standard_uncertainty": s.standard.map(|[speed, cost]| json!({"speed_m_s": speed, "cost_of_transport_j_m": cost})),
                "coefficients": s.each.iter().map(|one| {
                    let effect = |e: Effect| json!({"elasticity": e.elasticity, "derivative": e.derivative, "variance_gone_if_known": e.known});
                    json!({
                        "name": one.number.name,
                        "unit": one.number.unit,
                        "value": one.number.value,
                        "standard_uncertainty": one.number.standard,
                        "speed": one.effects.map(|[speed, _]| effect(speed)),
                        "cost_of_transport": one.effects.map(|[_, cost]| effect(cost)),
                    })
                }).collect::<Vec<_>>(),
            })),
        })
    }
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

impl Drawn {
    fn section(&self) -> DocumentSection {
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
        let row = |((name, unit, _), ends): (&(&str, &str, &str), [f64; 2])| {
            vec![(*name).to_owned(), interval(ends), (*unit).to_owned()]
        };
        DocumentSection {
            title: "Intervals".to_owned(),
            paragraphs,
            tables: vec![TextTable {
                caption: format!(
                    "95 % intervals from the coefficients' covariance ({}, seed {})",
                    counted(self.asked.n, "draw", "draws"),
                    self.asked.seed
                ),
                head: ["quantity", "95 %", "unit"].map(str::to_owned).to_vec(),
                rows: OF.iter().zip(self.intervals).map(row).collect(),
            }],
            charts: Vec::new(),
        }
    }
}

fn of_sensitivities(found: &Sensitivities) -> DocumentSection {
    let mut paragraphs = Vec::new();
    match found.standard {
        None => paragraphs.push(
            "the records state no uncertainty: elasticities are said, and not which coefficient to measure next"
                .to_owned(),
        ),
        Some(standard) => {
            for (k, (of, unit)) in [("speed", "m/s"), ("cost of transport", "J/m")].iter().enumerate() {
                let known = |s: &froude_swim::sensitivity::Sensitivity| s.effects.and_then(|e| e[k].known);
                let most = found.each.iter().filter_map(|s| Some((known(s)?, &s.number.name)));
                if let Some((part, name)) = most.max_by(|a, b| a.0.total_cmp(&b.0)) {
                    paragraphs.push(format!(
                        "{of}: standard uncertainty {} {unit} by the coefficients; measure {name} next: known exactly, it would take {} of the variance away",
                        significant(standard[k], 2),
                        percent(part)
                    ));
                }
            }
        }
    }
    let cell = |x: Option<f64>| x.map_or_else(String::new, |x| significant(x, 3));
    let rows = found.each.iter().map(|s| {
        let of = |k: usize| s.effects.map(|e| e[k]);
        let known = |k: usize| of(k).and_then(|e| e.known).map_or_else(String::new, percent);
        let number = format!("{} {}", significant(s.number.value, 4), s.number.unit).trim_end_matches(" 1").to_owned();
        let own = [s.number.name.clone(), number, cell(s.number.standard)];
        let effects = [cell(of(0).map(|e| e.elasticity)), cell(of(1).map(|e| e.elasticity)), known(0), known(1)];
        [own.to_vec(), effects.to_vec()].concat()
    });
    let head = [
        "coefficient",
        "value",
        "standard",
        "% of speed per %",
        "% of cost per %",
        "of the speed's variance",
        "of the cost's variance",
    ];
    DocumentSection {
        title: "Sensitivities".to_owned(),
        paragraphs,
        tables: vec![TextTable {
            caption: "what speed and cost owe to each coefficient, and the part of their variance that goes when it is known exactly".to_owned(),
            head: head.map(str::to_owned).to_vec(),
            rows: rows.collect(),
        }],
        charts: Vec::new(),
    }
}
