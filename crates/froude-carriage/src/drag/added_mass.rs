//! Added mass from the ramps: what the wet carriage must be given more than the dry one to reach its speed.
//!
//! At one time of the same profile the inertia of motor, carriage and body is in both runs. The difference F of the two motor forces,
//! integrated from the first sample in motion to a time T in the steady window (speed gained v), is
//!
//! ∫F dt = m v + D ∫u|u| dt + f T,
//!
//! with m the added mass plus entrained water (the water inside the body) and the ballast that the wet carriage carries more than the dry
//! one, u the reference speed, D and f what the steady part of the same pair gives: its mean difference is F_s = D v|v| + f. With D from
//! all pairs (a line through F_s over v|v|), one pair gives
//!
//! m v = ∫F dt − F_s T + D (v|v| T − ∫u|u| dt).
//!
//! An integral does not ask when in the ramp the chain passed the force on: ripple of a flexible chain does not bias it, as it does
//! a fit sample by sample. The load still swings about the reference speed at any one T, alike in every pair, and would have that speed
//! counted for its own; so m v is the mean over all T of the steady window, with the weights of its tapered mean, and so is F_s. Braking is left out: through the gear it has another efficiency. Pairs are weighted by v²/T (friction that
//! wanders faster than a ramp); the jackknife over pairs gives the uncertainty. Source: impulse balance, our derivation.
//!
//! Valid from rest; flow history (start-up of the wake) is in the result.

use froude_fit::budget::{Uncertain, jackknife_of_one};
use froude_fit::series::tapered;

use super::run::{BodyState, DragRun, RunKind};
use super::steady::{SteadySettings, driving_part, window};
use crate::drag::setup::{Ballast, DragSetup, Efficiency};

/// Added mass plus entrained water of the body.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedMass {
    /// Added mass and water inside, kg; with the ballast where its mass is not known.
    pub mass_kg: Uncertain,
    /// Its 95 % interval, kg.
    pub interval_95: [f64; 2],
    /// Ballast that was subtracted, kg; `None` where it is not known and is still in the mass.
    pub ballast_kg: Option<f64>,
    /// Pairs of runs used.
    pub runs: usize,
}

/// Impulse balance of a wet and a dry run.
#[derive(Debug, Clone, Copy)]
struct Ramp {
    pair: u32,
    /// v at the end of the ramp, m/s.
    speed_m_s: f64,
    /// What the speed has grown by since the first sample in motion, m/s.
    gained_m_s: f64,
    /// T, s: its mean over the window.
    duration_s: f64,
    /// ∫F dt − F_s T, its mean over T in the window, N s.
    excess_n_s: f64,
    /// v|v| T − ∫u|u| dt, the same for every T at constant speed, m²/s.
    missing_m2_s: f64,
    /// F_s, N.
    steady_n: f64,
}

impl Ramp {
    fn square(&self) -> f64 {
        self.speed_m_s * self.speed_m_s.abs()
    }

    /// m v of this pair, N s.
    fn momentum(&self, drag_n_s2_m2: f64) -> f64 {
        self.excess_n_s + drag_n_s2_m2 * self.missing_m2_s
    }
}

/// The ramp of one pair; `None` without a steady window, or where the two references differ.
fn ramp(wet: &DragRun<'_>, dry: &DragRun<'_>, force_per_volt_n: f64, settings: SteadySettings) -> Option<Ramp> {
    let start = |run: &DragRun<'_>| run.reference_speed_m_s.iter().position(|&v| v != 0.0);
    let (i, j) = (start(wet)?, start(dry)?);
    let (w, d) = (window(wet, settings).ok()?, window(dry, settings).ok()?);
    // A swing that turns the chain's force around in the window has done so before it: the gear's loss is then in the impulse.
    let friction_v = tapered(d.of(dry.command_v));
    for (run, window) in [(wet, w), (dry, d)] {
        if driving_part(run, window, friction_v, settings).ok()?.first != window.first {
            return None;
        }
    }
    let step = wet.step_s();
    let first = (w.first - i).max(d.first - j);
    let end = (w.end - i).min(d.end - j);
    let slack = 0.01 * wet.target_speed_m_s;
    let differs = |k: &usize| (wet.reference_speed_m_s[i + k] - dry.reference_speed_m_s[j + k]).abs() > slack;
    if first + 1 >= end || (dry.step_s() - step).abs() > 1e-6 * step || (0..first).any(|k| differs(&k)) {
        return None;
    }
    let force_n = |k: usize| force_per_volt_n * (wet.command_v[i + k] - dry.command_v[j + k]);
    let square = |k: usize| wet.reference_speed_m_s[i + k] * wet.reference_speed_m_s[i + k].abs();
    let speed_m_s = wet.target_speed_m_s * wet.direction;
    let (mut impulse_n_s, mut squares_m2_s) = (0.0, 0.0);
    let (mut in_window, mut forces) = (Vec::new(), Vec::new());
    for k in 1..end {
        impulse_n_s += 0.5 * step * (force_n(k - 1) + force_n(k));
        if k <= first {
            squares_m2_s += 0.5 * step * (square(k - 1) + square(k));
        }
        if k >= first {
            in_window.push((impulse_n_s, k as f64 * step));
            forces.push(force_n(k));
        }
    }
    let steady_n = tapered(&forces);
    let excess: Vec<f64> = in_window.iter().map(|(impulse, t)| impulse - steady_n * t).collect();
    Some(Ramp {
        pair: wet.pair,
        speed_m_s,
        gained_m_s: speed_m_s - wet.reference_speed_m_s[i],
        duration_s: 0.5 * (first + end - 1) as f64 * step,
        excess_n_s: tapered(&excess),
        missing_m2_s: speed_m_s * speed_m_s.abs() * first as f64 * step - squares_m2_s,
        steady_n,
    })
}

/// D of a line through the steady differences over v|v|; through zero where there is one speed only.
fn drag(ramps: &[&Ramp]) -> f64 {
    let slowest = ramps.iter().map(|r| r.speed_m_s.abs()).fold(f64::INFINITY, f64::min);
    let is_one_speed = ramps.iter().all(|r| r.speed_m_s.abs() <= 1.01 * slowest);
    // Resistance against the motion, so that runs out and back share one offset.
    let n = if is_one_speed { 0.0 } else { ramps.len() as f64 };
    let (mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0);
    for r in ramps {
        let (square, force) = (r.square().abs(), r.steady_n * r.speed_m_s.signum());
        (x, y, xx, xy) = (x + square, y + force, xx + square * square, xy + square * force);
    }
    if n == 0.0 { xy / xx } else { (n * xy - x * y) / (n * xx - x * x) }
}

fn mass<'a>(ramps: impl Iterator<Item = &'a Ramp>) -> Option<f64> {
    let ramps: Vec<&Ramp> = ramps.collect();
    let d = drag(&ramps);
    let (mut top, mut bottom) = (0.0, 0.0);
    for r in &ramps {
        top += r.momentum(d) * r.gained_m_s / r.duration_s;
        bottom += r.gained_m_s * r.gained_m_s / r.duration_s;
    }
    (bottom > 0.0).then_some(top / bottom)
}

/// Added mass by motor current difference; `None` without ramps in at least two pairs, or without the force per volt.
#[must_use]
pub fn added_mass(runs: &[DragRun<'_>], setup: &DragSetup) -> Option<AddedMass> {
    // Ramps of a log without a reference have no sharp beginning.
    if runs.iter().any(|r| r.held.is_some()) {
        return None;
    }
    let tows = |body: BodyState| runs.iter().filter(move |r| r.kind == RunKind::Tow && r.body == body);
    let k = setup.force_per_volt_n();
    let all: Vec<Ramp> = tows(BodyState::Wet)
        .filter_map(|wet| {
            tows(BodyState::Dry).find(|d| d.is_partner_of(wet)).and_then(|d| ramp(wet, d, k, setup.steady))
        })
        .collect();
    let mut pairs: Vec<u32> = all.iter().map(|a| a.pair).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let of = |skip: Option<u32>| mass(all.iter().filter(|a| Some(a.pair) != skip));
    let moved = of(None)?;
    let (scatter, dof) = jackknife_of_one(pairs.len(), |g| of(Some(pairs[g])))?;
    let scale = match (setup.calibration, setup.efficiency) {
        (Some(force_per_volt), _) => force_per_volt.relative(),
        (None, Efficiency::Declared(e)) => e.relative().hypot(setup.torque_constant_relative),
        (None, Efficiency::Undeclared) => return None,
    };
    let carried = match setup.ballast {
        Ballast::Matched { carried_kg } => carried_kg,
        Ballast::Unballasted { .. } => Some(Uncertain::new(0.0, 0.0)),
    };
    let ballast = carried.unwrap_or(Uncertain::new(0.0, 0.0));
    let value = moved - ballast.value;
    let entries = [
        (scatter * scatter, dof),
        ((scale * moved).powi(2), f64::INFINITY),
        (ballast.standard * ballast.standard, ballast.dof),
    ];
    let e = froude_fit::propagate::expanded(&entries, 0.95);
    Some(AddedMass {
        mass_kg: Uncertain { value, standard: e.standard, dof: e.dof },
        interval_95: [value - e.expanded, value + e.expanded],
        ballast_kg: carried.map(|c| c.value),
        runs: all.len(),
    })
}
