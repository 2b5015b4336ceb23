//! A wagon on a rail that a hanging weight pulls through water, and the camera that films it: the twin of that rig.
//!
//! (M + W/g) v̇ = W − F − D(v), with M all that moves with the wagon and its water, W the weight, F the friction of pulleys and rail, and D the drag along
//! the rail. At the end of the way the wagon stops. The camera sees a mark in pixels; a load cell below the wagon shows the loads of the water on the body.
//!
//! **Setting.** Friction constant while it moves; the string is stiff and stays taut. **Units.** SI, and pixels.
//!
//! Not here: strings that stretch, waves that the wall throws back, a shutter that smears the mark.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::steady::{Channel, Reading};

/// Gravity, m/s².
pub const G_M_S2: f64 = 9.80665;
/// Step of the motion as part of a frame.
const STEPS: usize = 10;
/// A run that has not arrived after so long is cut, s.
const LONGEST_S: f64 = 600.0;

/// Wagon, weight and way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightRig {
    /// M: wagon, rod, body and their water, kg.
    pub moving_mass_kg: f64,
    /// m + A of what hangs below the load cell, kg: what the cell shows of the acceleration.
    pub below_cell_kg: f64,
    /// W, N.
    pub weight_n: f64,
    /// F, N.
    pub friction_n: f64,
    /// Way to the stop, m.
    pub travel_m: f64,
    /// At rest before and after, s.
    pub still_s: f64,
    /// Frames and samples a second.
    pub rate_hz: f64,
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WeightTrace {
    /// Time, s, in even steps from 0.
    pub time_s: Vec<f64>,
    /// Position of the wagon, m, without error.
    pub position_m: Vec<f64>,
    /// Loads of the water on the body as sensed, N, along and across the rail as `loads_n` gives them.
    pub loads_n: Vec<Vec<f64>>,
}

/// One run as it is logged.
///
/// `drag_n` is the drag along the rail at a speed, N; `loads_n` the loads on the body there, whose acceleration along the rail adds `along[l]` times its
/// inertia to load l. The same seed gives the same log.
#[must_use]
pub fn pull(
    rig: WeightRig,
    readings: &[Reading],
    drag_n: &dyn Fn(f64) -> f64,
    loads_n: &dyn Fn(f64) -> Vec<f64>,
    along: &[f64],
    seed: u64,
) -> WeightTrace {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let frame_s = 1.0 / rig.rate_hz;
    let mass = rig.moving_mass_kg + rig.weight_n / G_M_S2;
    let pull_n = (rig.weight_n - rig.friction_n).max(0.0);
    let acceleration = |v: f64| (pull_n - drag_n(v)) / mass;
    let mut channels = Channel::of(readings, frame_s, &mut rng);
    let mut out = WeightTrace { loads_n: vec![Vec::new(); readings.len()], ..WeightTrace::default() };
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    let h = frame_s / STEPS as f64;
    let mut stopped_s: Option<f64> = None;
    let mut frame = 0_usize;
    loop {
        let t = frame as f64 * frame_s;
        let is_moving = t >= rig.still_s && stopped_s.is_none();
        let there = if v > 0.0 { loads_n(v) } else { vec![0.0; readings.len()] };
        let inertia = if is_moving { rig.below_cell_kg * acceleration(v) } else { 0.0 };
        out.time_s.push(t);
        out.position_m.push(x);
        for (k, load) in there.into_iter().enumerate() {
            out.loads_n[k].push(channels[k].read(load - along[k] * inertia, t, &mut rng));
        }
        if stopped_s.is_some_and(|s| t > s + rig.still_s) || t > LONGEST_S {
            return out;
        }
        if is_moving {
            for _ in 0..STEPS {
                let k1 = acceleration(v);
                let k2 = acceleration(v + 0.5 * h * k1);
                let k3 = acceleration(v + 0.5 * h * k2);
                let k4 = acceleration(v + h * k3);
                let next = v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
                x += h * (v + h / 6.0 * (k1 + k2 + k3));
                v = next;
            }
            if x >= rig.travel_m {
                (x, v, stopped_s) = (rig.travel_m, 0.0, Some(t));
            }
        }
        frame += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIG: WeightRig = WeightRig {
        moving_mass_kg: 4.0,
        below_cell_kg: 3.0,
        weight_n: 0.113,
        friction_n: 0.0,
        travel_m: 0.8,
        still_s: 1.0,
        rate_hz: 50.0,
    };

    /// v² = v_∞² (1 − e^{−2 D x/(m v_∞²)}): 0.113 N at 0.3 m/s with 4 kg reaches 0.63 of it in 0.8 m (the weight's own 12 g take off a little).
    #[test]
    fn four_kilograms_reach_063_of_their_speed_in_08_metres() {
        let k = 0.113 / 0.09;
        let trace = pull(RIG, &[], &|v| k * v * v, &|_| Vec::new(), &[], 1);
        let at = trace.position_m.iter().position(|x| *x >= 0.8).unwrap();
        let v = (trace.position_m[at - 1] - trace.position_m[at - 3]) / 0.04;
        let x = trace.position_m[at - 2];
        let mass = 4.0 + 0.113 / G_M_S2;
        let exact = 0.3 * (1.0 - (-2.0 * k * x / mass).exp()).sqrt();
        // Of a central difference over 40 ms: v̈ h²/6 is below 1e-6 of it.
        assert!((v / exact - 1.0).abs() < 1e-5, "{v} {exact}");
        let end = 0.3 * (1.0 - (-2.0 * k * 0.8 / mass).exp()).sqrt();
        assert!((end / 0.3 - 0.63).abs() < 0.005, "{end}");
    }
}
