//! Two masses and a chain, simulated.
//!
//! Between two commands the chain is linear but for the signs in Coulomb friction. The linear part is that of the carriage's twin, exact for
//! constant forces ([`froude_rig::propagator`]); friction over a short step is the force, within ± its limit, that
//! brings the speed to zero at the end of the step, or the limit itself where it cannot: sticking needs no threshold and no
//! regularised sign. A step in which a mass stops, breaks away or turns is taken again in 32 pieces: only there does
//! the instant of a change matter.
//!
//! **Gear.** The chain's force F loads the motor by F/η while the motor drives (F·ṗ > 0) and by η_b F while it is driven. That is a mean
//! load ½(1/η + η_b) F, which is linear, and a friction ½(1/η − η_b)|F|, which adds to the motor's own and locks it at rest. F and the drag
//! of the load, D ẏ|ẏ|, are those of mid-step (second order).
//!
//! **Observer.** [`Stepper::innovations`] corrects the state at every sample by what the encoder says, with the stationary gain of a Kalman
//! filter of the sliding axis whose unrecorded forces are white. What is left is what the past does not predict: a force that
//! nobody recorded acts once, where a free simulation carries it along for seconds.
//!
//! # Source
//!
//! Moreau (1988), *Unilateral contact and dry friction in finite freedom dynamics*, CISM 302 (time stepping of friction impulses);
//! Anderson & Moore (1979), *Optimal Filtering*, 4.4 (the stationary gain). The gear's law, too, is that of the twin. Friction is not: a twin
//! must stick bit for bit and in the same step on any machine, an estimate must change little where a parameter does.

use froude_rig::propagator::{Both, both};
use froude_signal::two_mass::TwoMasses;

use crate::servo::error::ServoError;

/// Position beyond which a simulation has run away, m.
const RUN_AWAY_M: f64 = 1e3;

/// A motor and a load joined by a chain, at the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMass {
    /// The linear part.
    pub masses: TwoMasses,
    /// `C_m n/R`, N.
    pub motor_coulomb_n: f64,
    /// `C`, N.
    pub load_coulomb_n: f64,
    /// Force per volt, N/V, without the gear's losses.
    pub force_per_volt_n_v: f64,
    /// η: the motor drives the chain. 1 without a gear.
    pub efficiency_forward: f64,
    /// η_b: the chain drives the motor. 1 without a gear.
    pub efficiency_backward: f64,
    /// Drag of the load over ẏ|ẏ|, N s²/m².
    pub load_drag_n_s2_m2: f64,
    /// From the command to the force, s.
    pub delay_s: f64,
}

impl TwoMass {
    /// All forces zero: the base of `..TwoMass::of(masses)` where friction, gear, drag or delay play no part.
    #[must_use]
    pub const fn of(masses: TwoMasses) -> Self {
        Self {
            masses,
            motor_coulomb_n: 0.0,
            load_coulomb_n: 0.0,
            force_per_volt_n_v: 0.0,
            efficiency_forward: 1.0,
            efficiency_backward: 1.0,
            load_drag_n_s2_m2: 0.0,
            delay_s: 0.0,
        }
    }
}

/// Motor position, load position, motor speed, load speed.
const STATES: usize = 4;

/// Most steps of the filter's covariance, and the part by which a settled gain still moves in one.
const GAIN_STEPS: usize = 20_000;
const GAIN_TOLERANCE: f64 = 1e-7;

/// Pieces of a step in which something stops, breaks away or turns.
const PIECES: usize = 32;

/// An axis ready to be stepped.
#[derive(Debug, Clone)]
pub struct Stepper {
    step: Both,
    piece: Both,
    /// Over a sample.
    sample: Both,
    /// Largest Coulomb friction, N.
    limit_n: [f64; 2],
    /// ½(1/η − η_b).
    gear_loss: f64,
    stiffness_n_m: f64,
    damping_n_s_m: f64,
    load_drag_n_s2_m2: f64,
    force_per_volt_n_v: f64,
    /// Delay in samples: whole ones, and the rest.
    delay: (usize, f64),
    /// Steps between two commands.
    steps: usize,
    sample_s: f64,
}

/// Where the masses are, and what holds them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    state: [f64; STATES],
    friction_n: [f64; 2],
    /// Which way each friction stands at its limit; 0 within it.
    side: [i8; 2],
}

impl Moment {
    pub(crate) const AT_REST: Self = Self { state: [0.0; STATES], friction_n: [0.0; 2], side: [0; 2] };

    /// Of the motor, from where it was at rest.
    pub(crate) fn motor_m(&self) -> f64 {
        self.state[0]
    }
}

impl Stepper {
    /// Steps of `longest_step_s` or shorter, a whole number of them between two commands.
    ///
    /// # Errors
    ///
    /// [`ServoError::Setting`] for a mass or stiffness that is not positive, Coulomb friction that drives, a gear that gives
    /// power, or a negative delay.
    pub fn new(axis: &TwoMass, sample_s: f64, longest_step_s: f64) -> Result<Self, ServoError> {
        let masses = axis.masses;
        let limit_n = [axis.motor_coulomb_n, axis.load_coulomb_n];
        let numbers = [masses.motor_mass_kg, masses.load_mass_kg, masses.stiffness_n_m];
        let is_possible = numbers.iter().all(|x| x.is_finite() && *x > 0.0) && limit_n.iter().all(|c| *c >= 0.0);
        if !is_possible {
            let found = numbers.into_iter().chain(limit_n).fold(f64::INFINITY, f64::min);
            let must = "masses and stiffness must be positive, Coulomb friction not negative";
            return Err(ServoError::Setting { what: "least of masses, stiffness and friction", found, must });
        }
        let (drive, driven) = (axis.efficiency_forward.recip(), axis.efficiency_backward);
        let is_gear = axis.efficiency_forward > 0.0 && drive >= driven && driven >= 0.0;
        if !is_gear {
            let must = "it must be positive and, with the backward one, dissipate power, not supply it";
            return Err(ServoError::Setting { what: "efficiency of the gear", found: axis.efficiency_forward, must });
        }
        if axis.delay_s.is_nan() || axis.delay_s < 0.0 {
            let must = "the force cannot precede the command";
            return Err(ServoError::Setting { what: "delay (s)", found: axis.delay_s, must });
        }
        let steps = (sample_s / longest_step_s - 1e-9).ceil().max(1.0);
        let over = |step_s: f64| both(&masses, step_s, 0.5 * (drive + driven));
        let late = axis.delay_s / sample_s;
        Ok(Self {
            step: over(sample_s / steps),
            piece: over(sample_s / steps / PIECES as f64),
            sample: over(sample_s),
            limit_n,
            gear_loss: 0.5 * (drive - driven),
            stiffness_n_m: masses.stiffness_n_m,
            damping_n_s_m: masses.damping_n_s_m,
            load_drag_n_s2_m2: axis.load_drag_n_s2_m2,
            force_per_volt_n_v: axis.force_per_volt_n_v,
            delay: (late as usize, late.fract()),
            steps: steps as usize,
            sample_s,
        })
    }

    /// Motor positions, one per command, from rest with the chain slack at `start_m`.
    ///
    /// # Errors
    ///
    /// [`ServoError::RanAway`].
    pub fn run(&self, command_v: &[f64], start_m: f64) -> Result<Vec<f64>, ServoError> {
        // Positions from the start: the numbers stay small.
        let mut moment = Moment::AT_REST;
        let mut out = Vec::with_capacity(command_v.len());
        for k in 0..command_v.len() {
            self.check(&moment, k)?;
            out.push(start_m + moment.state[0]);
            self.sample(&mut moment, self.force_n(command_v, k));
        }
        Ok(out)
    }

    /// Measured motor positions less predicted ones, m; each corrects the state by `gain` before the next is predicted.
    ///
    /// # Errors
    ///
    /// [`ServoError::RanAway`].
    pub fn innovations(
        &self,
        command_v: &[f64],
        measured_m: &[f64],
        gain: &[f64; STATES],
    ) -> Result<Vec<f64>, ServoError> {
        let start_m = measured_m.first().copied().unwrap_or(0.0);
        let mut moment = Moment::AT_REST;
        let mut out = Vec::with_capacity(measured_m.len());
        for (k, measured) in measured_m.iter().enumerate() {
            self.check(&moment, k)?;
            let apart = (measured - start_m) - moment.state[0];
            out.push(apart);
            for (x, g) in moment.state.iter_mut().zip(gain) {
                *x += g * apart;
            }
            self.sample(&mut moment, self.force_n(command_v, k));
        }
        Ok(out)
    }

    /// The stationary gain of the Kalman filter of the sliding axis.
    ///
    /// `force_over_noise_n_m` is the standard deviation of a white force on each mass, constant over a sample, over that of the
    /// measured position.
    #[must_use]
    pub fn gain(&self, force_over_noise_n_m: f64) -> [f64; STATES] {
        let over = &self.sample;
        // A place keeps what it was; what it gains, and the speeds, follow from the extension and the speeds.
        let a: [[f64; STATES]; STATES] = std::array::from_fn(|i| {
            let [by_extension, by_motor, by_load, ..] = over[i];
            let was = |j: usize| f64::from(u8::from(i == j));
            [by_extension + was(0), was(1) - by_extension, by_motor, by_load]
        });
        let q = force_over_noise_n_m * force_over_noise_n_m;
        let noise: [[f64; STATES]; STATES] =
            std::array::from_fn(|i| std::array::from_fn(|j| q * (over[i][3] * over[j][3] + over[i][4] * over[j][4])));
        let mut covariance = noise;
        let mut gain = [0.0; STATES];
        for _ in 0..GAIN_STEPS {
            let variance = covariance[0][0] + 1.0;
            let next: [f64; STATES] = std::array::from_fn(|i| covariance[i][0] / variance);
            let is_settled = next.iter().zip(&gain).all(|(n, g)| (n - g).abs() <= GAIN_TOLERANCE * n.abs());
            gain = next;
            if is_settled {
                break;
            }
            let left: [[f64; STATES]; STATES] =
                std::array::from_fn(|i| std::array::from_fn(|j| covariance[i][j] - gain[i] * covariance[0][j]));
            let moved: [[f64; STATES]; STATES] =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..STATES).map(|k| a[i][k] * left[k][j]).sum()));
            covariance = std::array::from_fn(|i| {
                std::array::from_fn(|j| noise[i][j] + (0..STATES).map(|k| moved[i][k] * a[j][k]).sum::<f64>())
            });
        }
        gain
    }

    fn check(&self, moment: &Moment, k: usize) -> Result<(), ServoError> {
        if moment.state[0].is_nan() || moment.state[0].abs() > RUN_AWAY_M {
            return Err(ServoError::RanAway { time_s: k as f64 * self.sample_s });
        }
        Ok(())
    }

    /// Mean force of the drive over the sample that begins with command `k`, N.
    #[inline]
    fn force_n(&self, command_v: &[f64], k: usize) -> f64 {
        let (whole, part) = self.delay;
        let at = |late: usize| k.checked_sub(late).map_or(0.0, |i| command_v[i]);
        let volts = if part > 0.0 { (1.0 - part) * at(whole) + part * at(whole + 1) } else { at(whole) };
        self.force_per_volt_n_v * volts
    }

    /// Steps from one command to the next under a constant force on the motor.
    #[inline]
    pub(crate) fn sample(&self, moment: &mut Moment, force_n: f64) {
        for _ in 0..self.steps {
            let next = self.after(&self.step, moment, force_n);
            if next.side == moment.side {
                *moment = next;
                continue;
            }
            for _ in 0..PIECES {
                *moment = self.after(&self.piece, moment, force_n);
            }
        }
    }

    /// After one step under a constant force on the motor.
    #[inline]
    fn after(&self, over: &Both, moment: &Moment, force_n: f64) -> Moment {
        let [q, y, v_q, v_y] = moment.state;
        let on_motor = over.map(|row| row[3]);
        let on_load = over.map(|row| row[4]);
        // Forces on motor and load for a unit change of their own speeds.
        let stopping = [on_motor[2].recip(), on_load[3].recip()];
        let gained = over.map(|row| row[0] * (q - y) + row[1] * v_q + row[2] * v_y + row[3] * force_n);
        let mut free = [q + gained[0], y + gained[1], gained[2], gained[3]];
        if self.load_drag_n_s2_m2 != 0.0 {
            // v = v without drag − ½ response · D v|v|, solved for v.
            let v = 0.5 * (v_y + free[3] - on_load[3] * moment.friction_n[1]);
            let v = 2.0 * v / (1.0 + (1.0 + 2.0 * on_load[3] * self.load_drag_n_s2_m2 * v.abs()).sqrt());
            let drag_n = self.load_drag_n_s2_m2 * v * v.abs();
            (0..STATES).for_each(|i| free[i] -= on_load[i] * drag_n);
        }
        let [mut motor_limit_n, load_limit_n] = self.limit_n;
        if self.gear_loss != 0.0 {
            let mean_m = 0.5 * (q - y + free[0] - free[1]);
            let mean_m_s = 0.5 * (v_q - v_y + free[2] - free[3]);
            motor_limit_n += self.gear_loss * (self.stiffness_n_m * mean_m + self.damping_n_s_m * mean_m_s).abs();
        }
        // Friction that stops each mass at the end of the step, within its limit. The masses hardly act on each other within a
        // step, so that two sweeps settle it. No `clamp`: the limit of a motion that has run away is no number, and `check` says so.
        let [mut f_m, mut f_l] = moment.friction_n;
        for _ in 0..2 {
            let v = free[2] - on_load[2] * f_l;
            f_m = (v * stopping[0]).max(-motor_limit_n).min(motor_limit_n);
            let v = free[3] - on_motor[3] * f_m;
            f_l = (v * stopping[1]).max(-load_limit_n).min(load_limit_n);
        }
        let side = |f: f64, limit: f64| i8::from(f >= limit) - i8::from(f <= -limit);
        Moment {
            state: std::array::from_fn(|i| free[i] - on_motor[i] * f_m - on_load[i] * f_l),
            friction_n: [f_m, f_l],
            side: [side(f_m, motor_limit_n), side(f_l, load_limit_n)],
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn axis() -> TwoMass {
        let masses = TwoMasses {
            motor_mass_kg: 2.0,
            load_mass_kg: 4.0,
            stiffness_n_m: 2.0e4,
            damping_n_s_m: 10.0,
            motor_viscous_n_s_m: 0.0,
            load_viscous_n_s_m: 0.0,
        };
        TwoMass { force_per_volt_n_v: 6.0, ..TwoMass::of(masses) }
    }

    #[test]
    fn without_friction_the_centre_of_mass_obeys_newton() {
        let p = Stepper::new(&axis(), 1e-3, 1e-3).unwrap().run(&vec![1.0; 2001], 0.0).unwrap();
        // 6 N on 6 kg: 1 m/s² for 2 s; the motor leads by the chain's stretch of the load, M/(m + M) · F_chain/K, and swings about it.
        let lead = 4.0 / 2e4 * 4.0 / 6.0;
        assert!((p[2000] - 2.0 - lead).abs() < lead);
    }

    #[test]
    fn steps_of_any_length_agree_where_friction_does_not_reverse() {
        let masses = TwoMasses { load_viscous_n_s_m: 2.0, ..axis().masses };
        let axis = TwoMass { masses, motor_coulomb_n: 1.0, load_coulomb_n: 1.5, ..axis() };
        let coarse = Stepper::new(&axis, 1e-3, 1e-3).unwrap().run(&vec![2.0; 3000], 0.0).unwrap();
        let fine = Stepper::new(&axis, 1e-3, 1e-5).unwrap().run(&vec![2.0; 3000], 0.0).unwrap();
        // Only the piece in which the load breaks away is rounded: 1.5 N over 1/32 ms on 6 kg, coasting for 3 s.
        let worst = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1.5 * 1e-3 / 32.0 / 6.0 * 3.0, "{worst}");
    }

    #[test]
    fn a_force_below_the_friction_of_the_motor_moves_nothing() {
        let axis = TwoMass { motor_coulomb_n: 7.0, load_coulomb_n: 1.0, ..axis() };
        let p = Stepper::new(&axis, 1e-3, 2.5e-4).unwrap().run(&[1.0; 500], 0.25).unwrap();
        assert!(p.iter().all(|p| (p - 0.25).abs() < 1e-15));
    }

    #[test]
    fn both_modes_have_their_textbook_frequencies() {
        // √(K/M) and √(K(1/m + 1/M)).
        assert!((axis().masses.antiresonance_hz() - 5000.0_f64.sqrt() / TAU).abs() < 1e-12);
        assert!((axis().masses.resonance_hz() - 15000.0_f64.sqrt() / TAU).abs() < 1e-12);
    }

    /// Driven up by a constant force, the gear's load is the chain's force over η; coasting, η_b times it.
    #[test]
    fn a_gear_makes_the_load_heavier_for_a_motor_that_drives_and_lighter_for_one_that_is_driven() {
        let axis = TwoMass { efficiency_forward: 0.8, efficiency_backward: 0.75, motor_coulomb_n: 1.0, ..axis() };
        let command: Vec<f64> = (0..3000).map(|k| if k < 1500 { 2.0 } else { 0.0 }).collect();
        let p = Stepper::new(&axis, 1e-3, 2e-4).unwrap().run(&command, 0.0).unwrap();
        let acceleration = |from: usize, to: usize| {
            let speed = |k: usize| (p[k + 100] - p[k - 100]) / 0.2;
            (speed(to) - speed(from)) / ((to - from) as f64 * 1e-3)
        };
        // 11 N on 2 + 4/0.8 kg; then 1 N of friction at the motor, which the load drives on, slows 2 + 4·0.75 kg.
        // What is left of the swing after a step, some 0.02 m/s, over 0.7 s.
        let (up, down) = (acceleration(600, 1300), acceleration(2100, 2800));
        assert!((up - 11.0 / 7.0).abs() < 0.03, "{up}");
        assert!((down + 1.0 / 5.0).abs() < 0.03, "{down}");
    }

    #[test]
    fn drag_on_the_load_ends_in_the_speed_where_it_balances_the_drive() {
        let axis = TwoMass { load_drag_n_s2_m2: 12.0, ..axis() };
        let p = Stepper::new(&axis, 1e-3, 1e-3).unwrap().run(&vec![2.0; 8000], 0.0).unwrap();
        // 12 N = 12 v|v|; after 8 s, e^{-2·8·12/6} is left of the way there.
        assert!(((p[7999] - p[7899]) / 0.1 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_delay_of_one_and_a_half_samples_is_one_and_a_half_samples() {
        let late = TwoMass { delay_s: 1.5e-3, ..axis() };
        let run = |axis: &TwoMass| Stepper::new(axis, 1e-3, 1e-3).unwrap().run(&[1.0; 2000], 0.0).unwrap();
        let (now, then) = (run(&axis()), run(&late));
        // Linear in the command, so the mean of one and two samples late.
        assert!((then[1999] - 0.5 * (now[1998] + now[1997])).abs() < 1e-12);
    }

    #[test]
    fn an_observer_of_the_true_axis_is_left_with_nothing_and_forgets_a_wrong_start() {
        let axis = TwoMass { motor_coulomb_n: 1.0, load_coulomb_n: 1.5, ..axis() };
        let stepper = Stepper::new(&axis, 1e-3, 2e-4).unwrap();
        let command: Vec<f64> = (0..4000).map(|k| 2.0 * (0.01 * f64::from(k)).sin()).collect();
        let p = stepper.run(&command, 0.0).unwrap();
        let gain = stepper.gain(1e5);
        let left = stepper.innovations(&command, &p, &gain).unwrap();
        assert!(left.iter().all(|e| e.abs() < 1e-12));
        let mut shifted = p;
        shifted[0] += 1e-3;
        let left = stepper.innovations(&command, &shifted, &gain).unwrap();
        assert!(left[1].abs() > 1e-4 && left[3900..].iter().all(|e| e.abs() < 1e-7), "{} {}", left[1], left[3999]);
    }
}
