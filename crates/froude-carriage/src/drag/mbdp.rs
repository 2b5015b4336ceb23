//! Model based drag prediction, eq. 9: the command less what the servo alone would need.
//!
//! One wet run is enough once the friction is known, and the friction must be known *there*: a constant identified near
//! one end of the tank and used in the middle puts the whole difference into the drag (Σv²/Σv⁴ of it into D_d).
//!
//! - **constant**: C, B as printed. **mapped**: C over position.
//! - **flexible**: eq. 2. The motor side gives the chain's force, the chain's law gives how far the load lags behind, and
//!   the load's own acceleration is subtracted. At constant speed it is the mapped model; it differs on the ramps.

use froude_fit::series::mean;

use super::friction::Friction;
use super::run::{DragRun, Window};
use super::steady::reach;
use super::steady::{Rejected, SteadySettings, driving_part, window};
use crate::drag::point::Point;

/// A map may be used this far beyond its ends, m.
const BEYOND_M: f64 = 0.1;

/// The two masses and the chain of eq. 2, seen at the chain.
///
/// Only the sums J_eff, B_eff, C_eff are known from slow motion: all friction is taken to be the load's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flexible {
    /// J_m (n/R)², kg.
    pub motor_mass_kg: f64,
    /// M, kg.
    pub load_mass_kg: f64,
    /// K_e, N/m.
    pub stiffness_n_m: f64,
    /// B_e, N s/m.
    pub damping_n_s_m: f64,
    /// Span over which positions are differentiated (local parabola), s. A third of the period of the fastest mode.
    pub span_s: f64,
}

/// The steady point of a wet run.
///
/// # Errors
///
/// [`Rejected`] without a steady window, or where a map does not reach.
pub fn point(
    wet: &DragRun<'_>,
    friction: &Friction,
    force_per_volt_n: f64,
    settings: SteadySettings,
) -> Result<Point, Rejected> {
    let w = on_the_map(wet, friction, settings)?;
    let left: Vec<f64> = (w.first..w.end)
        .map(|i| {
            force_per_volt_n * (wet.command_v[i] - friction.command_v(wet.position_m[i], wet.reference_speed_m_s[i]))
        })
        .collect();
    Ok(of_force(wet, w, &left))
}

/// The steady point of a wet run by the two-mass model.
///
/// # Errors
///
/// As [`point`].
pub fn flexible_point(
    wet: &DragRun<'_>,
    friction: &Friction,
    force_per_volt_n: f64,
    efficiency: f64,
    model: Flexible,
    settings: SteadySettings,
) -> Result<Point, Rejected> {
    let w = on_the_map(wet, friction, settings)?;
    Ok(of_force(wet, w, w.of(&flexible_force_n(wet, friction, force_per_volt_n, efficiency, model))))
}

/// The steady window, if the friction is known there.
fn on_the_map(wet: &DragRun<'_>, friction: &Friction, settings: SteadySettings) -> Result<Window, Rejected> {
    let w = window(wet, settings)?;
    let middle_m = wet.position_m[w.first + w.len() / 2];
    let friction_v = friction.command_v(middle_m, wet.direction * wet.target_speed_m_s) - friction.bias_v;
    let w = driving_part(wet, w, friction_v, settings)?;
    let [from_m, to_m] = reach(w.of(wet.position_m));
    let [low, high] = friction.range_m;
    if friction.coulomb_v.len() > 1 && (from_m < low - BEYOND_M || to_m > high + BEYOND_M) {
        return Err(Rejected::Unusable(format!(
            "run {:?}: towed from {from_m:.2} to {to_m:.2} m, where the friction is not known (dry runs cover \
             {low:.2} to {high:.2} m)",
            wet.id
        )));
    }
    Ok(w)
}

fn of_force(wet: &DragRun<'_>, w: Window, force_n: &[f64]) -> Point {
    Point::of(wet, w, &mean(force_n, wet.step_s()), 1.0)
}

/// Eq. 2 solved for the resistance, sample by sample, from motor-side signals alone.
///
/// `efficiency` is what `force_per_volt_n` has of the ideal force per volt: the motor's own inertia stands before the gear, so that
/// the chain gets η (K v_c − J_m θ̈).
#[must_use]
pub fn flexible_force_n(
    run: &DragRun<'_>,
    friction: &Friction,
    force_per_volt_n: f64,
    efficiency: f64,
    model: Flexible,
) -> Vec<f64> {
    let step = run.step_s();
    let motor = Derivatives::of(run.position_m, step, model.span_s);
    // 2a: what the motor puts into the chain, smoothed like the acceleration that it is balanced with.
    let drive = smooth(run.command_v, step, model.span_s);
    let motor_kg = efficiency * model.motor_mass_kg;
    let chain: Vec<f64> =
        drive.iter().zip(&motor.acceleration).map(|(v, a)| force_per_volt_n * v - motor_kg * a).collect();
    // K_e δ + B_e δ̇ = chain: how far the load lags behind the motor.
    let lag = lag_m(&chain, step, model);
    let load_m: Vec<f64> = motor.value.iter().zip(&lag).map(|(q, d)| q - d).collect();
    let load = Derivatives::of(&load_m, step, model.span_s);
    (0..load_m.len())
        .map(|i| {
            let friction_n = force_per_volt_n * friction.command_v(load_m[i], run.reference_speed_m_s[i]);
            chain[i] - model.load_mass_kg * load.acceleration[i] - friction_n
        })
        .collect()
}

/// Solves K δ + B δ̇ = f for f a broken line, exactly; starts at rest under the first force.
fn lag_m(force_n: &[f64], step_s: f64, model: Flexible) -> Vec<f64> {
    let (k, b) = (model.stiffness_n_m, model.damping_n_s_m);
    let rate = k * step_s / b;
    if !rate.is_finite() || rate > 50.0 {
        return force_n.iter().map(|f| f / k).collect();
    }
    let decay = (-rate).exp();
    let mut lag = force_n.first().map_or(0.0, |f| f / k);
    let mut before = force_n.first().copied().unwrap_or(0.0);
    force_n
        .iter()
        .map(|&f| {
            // Particular solution for a line: (f − B f'/K)/K.
            let slope_term = (f - before) / rate;
            let (from, to) = ((before - slope_term) / k, (f - slope_term) / k);
            lag = to + (lag - from) * decay;
            before = f;
            lag
        })
        .collect()
}

/// A column with its derivatives by local parabolas (Savitzky & Golay 1964).
struct Derivatives {
    value: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Derivatives {
    fn of(column: &[f64], step_s: f64, span_s: f64) -> Self {
        if column.len() < 3 {
            // Not enough for a parabola.
            return Self { value: column.to_vec(), acceleration: vec![0.0; column.len()] };
        }
        let half = half_width(step_s, span_s, column.len());
        let m = half as f64;
        let n = 2.0 * m + 1.0;
        let s2 = m * (m + 1.0) * n / 3.0;
        let s4 = s2 * (3.0 * m * m + 3.0 * m - 1.0) / 5.0;
        let determinant = n * s4 - s2 * s2;
        let mut out = Self { value: Vec::with_capacity(column.len()), acceleration: Vec::with_capacity(column.len()) };
        for i in 0..column.len() {
            // Near the ends the parabola of the nearest whole span is used.
            let centre = i.clamp(half, column.len() - 1 - half);
            let (mut sum, mut second, mut first) = (0.0, 0.0, 0.0);
            // Measured from the centre, so that counts of metres do not cancel.
            let origin = column[centre];
            for (j, x) in column[centre - half..=centre + half].iter().enumerate() {
                let t = j as f64 - m;
                sum += x - origin;
                first += t * (x - origin);
                second += t * t * (x - origin);
            }
            let curve = (n * second - s2 * sum) / determinant;
            let level = (s4 * sum - s2 * second) / determinant;
            let t = i as f64 - centre as f64;
            out.value.push(origin + level + t * first / s2 + t * t * curve);
            out.acceleration.push(2.0 * curve / (step_s * step_s));
        }
        out
    }
}

fn smooth(column: &[f64], step_s: f64, span_s: f64) -> Vec<f64> {
    Derivatives::of(column, step_s, span_s).value
}

fn half_width(step_s: f64, span_s: f64, n: usize) -> usize {
    ((0.5 * span_s / step_s).round() as usize).clamp(1, (n.max(3) - 1) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::run::{BodyState, RunKind};

    const DRAG: f64 = 20.0;
    const ADDED_KG: f64 = 6.0;
    const COULOMB_N: f64 = 2.0;
    const VISCOUS: f64 = 1.5;
    const N_PER_VOLT: f64 = 5.0;
    /// Load mode with the motor held: 4 Hz wet, little damped, as a plastic chain has it.
    const MODEL: Flexible =
        Flexible { motor_mass_kg: 2.0, load_mass_kg: 4.0, stiffness_n_m: 6300.0, damping_n_s_m: 12.0, span_s: 0.02 };

    /// Motor side on a trapezoid of constant jerk pieces: value, speed, acceleration.
    fn motor(t: f64) -> [f64; 3] {
        // Acceleration 1 − cos over 0.5 s up to 0.4 m/s, then constant speed.
        let (ramp, top) = (0.5, 0.4);
        let t = t - 0.5;
        if t <= 0.0 {
            return [0.0; 3];
        }
        let w = std::f64::consts::TAU / ramp;
        if t < ramp {
            let a = top / ramp;
            let s = (w * t).sin();
            return [a * (0.5 * t * t - (1.0 - (w * t).cos()) / (w * w)), a * (t - s / w), a * (1.0 - (w * t).cos())];
        }
        [0.5 * top * ramp + top * (t - ramp), top, 0.0]
    }

    /// Simulates the load by Runge and Kutta; gives columns and the true resistance.
    fn logged() -> ([Vec<f64>; 4], Vec<f64>) {
        let step = 1e-3;
        let chain = |t: f64, y: f64, u: f64| {
            let [q, v, _] = motor(t);
            MODEL.stiffness_n_m * (q - y) + MODEL.damping_n_s_m * (v - u)
        };
        // Friction starts with the motion, smoothly enough for a fixed step.
        let friction = |u: f64| COULOMB_N * (u / 1e-3).tanh() + VISCOUS * u;
        let acceleration = |t: f64, y: f64, u: f64| {
            (chain(t, y, u) - friction(u) - DRAG * u * u.abs()) / (MODEL.load_mass_kg + ADDED_KG)
        };
        let (mut y, mut u) = (0.0, 0.0);
        let mut columns: [Vec<f64>; 4] = Default::default();
        let mut truth = Vec::new();
        for i in 0..4000 {
            let t = f64::from(i) * step;
            let [q, v, a] = motor(t);
            let command = (MODEL.motor_mass_kg * a + chain(t, y, u)) / N_PER_VOLT;
            for (column, x) in columns.iter_mut().zip([t, q, v, command]) {
                column.push(x);
            }
            truth.push(DRAG * u * u.abs() + ADDED_KG * acceleration(t, y, u));
            for k in 0..10 {
                let (t, h) = (t + 0.1 * step * f64::from(k), 0.1 * step);
                let (k1y, k1u) = (u, acceleration(t, y, u));
                let (k2y, k2u) = (u + 0.5 * h * k1u, acceleration(t + 0.5 * h, y + 0.5 * h * k1y, u + 0.5 * h * k1u));
                let (k3y, k3u) = (u + 0.5 * h * k2u, acceleration(t + 0.5 * h, y + 0.5 * h * k2y, u + 0.5 * h * k2u));
                let (k4y, k4u) = (u + h * k3u, acceleration(t + h, y + h * k3y, u + h * k3u));
                y += h / 6.0 * (k1y + 2.0 * k2y + 2.0 * k3y + k4y);
                u += h / 6.0 * (k1u + 2.0 * k2u + 2.0 * k3u + k4u);
            }
        }
        (columns, truth)
    }

    /// Eq. 9 sample by sample, ramps included: resistance in newtons.
    ///
    /// `moving_mass_kg` is what the chain's force accelerates: η J_eff (n/R)², since `force_per_volt_n` has η in it. The span of the derivative smooths the first and last half of itself.
    fn rigid_force_n(
        run: &DragRun<'_>,
        friction: &Friction,
        force_per_volt_n: f64,
        moving_mass_kg: f64,
        span_s: f64,
    ) -> Vec<f64> {
        let motor = Derivatives::of(run.position_m, run.step_s(), span_s);
        (0..run.position_m.len())
            .map(|i| {
                let friction_v = friction.command_v(run.position_m[i], run.reference_speed_m_s[i]);
                force_per_volt_n * (run.command_v[i] - friction_v) - moving_mass_kg * motor.acceleration[i]
            })
            .collect()
    }

    /// Both models know masses and friction; only one knows the chain. Compared from 0.1 s after the start (before, the
    /// tanh of the simulated friction and the sign of the model differ) to 0.5 s after the ramp.
    #[test]
    fn on_the_ramp_the_flexible_model_finds_the_force_that_the_rigid_one_smears() {
        let ([time_s, position_m, reference_speed_m_s, command_v], truth) = logged();
        let run = DragRun {
            id: "ramp",
            time_s: &time_s,
            position_m: &position_m,
            reference_speed_m_s: &reference_speed_m_s,
            command_v: &command_v,
            force_n: None,
            kind: RunKind::Tow,
            body: BodyState::Wet,
            target_speed_m_s: 0.4,
            direction: 1.0,
            pair: 1,
            is_ballasted: true,
            hung_weight_n: None,
            held: None,
        };
        let friction = Friction {
            coulomb_v: vec![COULOMB_N / N_PER_VOLT],
            first_knot_m: 0.0,
            spacing_m: 1.0,
            viscous_v_s_m: VISCOUS / N_PER_VOLT,
            bias_v: 0.0,
            range_m: [0.0, 2.0],
        };
        let rms = |found: &[f64], from: usize, to: usize| {
            let sum: f64 = found[from..to].iter().zip(&truth[from..to]).map(|(f, t)| (f - t).powi(2)).sum();
            (sum / (to - from) as f64).sqrt()
        };
        let mass = MODEL.motor_mass_kg + MODEL.load_mass_kg;
        let rigid = rigid_force_n(&run, &friction, N_PER_VOLT, mass, MODEL.span_s);
        let flexible = flexible_force_n(&run, &friction, N_PER_VOLT, 1.0, MODEL);
        let (r, f) = (rms(&rigid, 600, 1500), rms(&flexible, 600, 1500));
        assert!(f < 0.1 * r && r > 0.2, "rigid {r} N, flexible {f} N");
        // Once the chain is quiet both say D v².
        let quiet = DRAG * 0.4 * 0.4;
        for found in [&rigid, &flexible] {
            let mean = found[3500..3900].iter().sum::<f64>() / 400.0;
            assert!((mean - quiet).abs() < 0.02, "{mean} against {quiet}");
        }
    }
}
