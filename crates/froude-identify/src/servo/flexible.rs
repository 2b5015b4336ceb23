//! Two masses and a chain, simulated.
//!
//! Between two commands the chain is linear but for the signs in Coulomb friction. The linear part is stepped by its matrix
//! exponential, exact for constant forces; friction over a short step is the force, within ± its limit, that
//! brings the speed to zero at the end of the step, or the limit itself where it cannot: sticking needs no threshold and no
//! regularised sign. A step in which a mass stops, breaks away or turns is taken again in 32 pieces: only there does
//! the instant of a change matter.
//!
//! # Source
//!
//! Moreau (1988), *Unilateral contact and dry friction in finite freedom dynamics*, CISM 302 (time stepping of friction impulses);
//! Golub & Van Loan (2013), *Matrix Computations*, 9.3 (exponential by scaling and squaring).

use std::f64::consts::TAU;

use crate::servo::error::ServoError;

/// Position beyond which a simulation has run away, m.
const RUN_AWAY_M: f64 = 1e3;

/// A motor and a load joined by a chain, at the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMass {
    /// `J_m (n/R)²`, kg.
    pub motor_mass_kg: f64,
    /// `M`, kg.
    pub load_mass_kg: f64,
    /// `K_e`, N/m.
    pub stiffness_n_m: f64,
    /// `B_e`, N s/m.
    pub damping_n_s_m: f64,
    /// `B_m (n/R)²`, N s/m.
    pub motor_viscous_n_s_m: f64,
    /// `B`, N s/m.
    pub load_viscous_n_s_m: f64,
    /// `C_m n/R`, N.
    pub motor_coulomb_n: f64,
    /// `C`, N.
    pub load_coulomb_n: f64,
    /// Force per volt, N/V.
    pub force_per_volt_n_v: f64,
}

impl TwoMass {
    /// Frequency at which the load swings against a held motor, `√(K/M)/2π`, Hz.
    #[must_use]
    pub fn antiresonance_hz(&self) -> f64 {
        (self.stiffness_n_m / self.load_mass_kg).sqrt() / TAU
    }

    /// Frequency at which both swing against each other, Hz.
    #[must_use]
    pub fn resonance_hz(&self) -> f64 {
        (self.stiffness_n_m * (1.0 / self.load_mass_kg + 1.0 / self.motor_mass_kg)).sqrt() / TAU
    }
}

/// Motor position, motor speed, load position, load speed.
const STATES: usize = 4;

/// Pieces of a step in which something stops, breaks away or turns.
const PIECES: usize = 32;

/// The linear part over one step.
#[derive(Debug, Clone)]
struct Linear {
    transition: [[f64; STATES]; STATES],
    /// Response of the state to a unit force on the motor and on the load.
    response: [[f64; STATES]; 2],
}

/// An axis ready to be stepped.
#[derive(Debug, Clone)]
pub struct Stepper {
    step: Linear,
    piece: Linear,
    /// Largest friction, N.
    limit_n: [f64; 2],
    force_per_volt_n_v: f64,
    /// Steps between two commands.
    steps: usize,
    sample_s: f64,
}

impl Stepper {
    /// Steps of `longest_step_s` or shorter, a whole number of them between two commands.
    ///
    /// # Errors
    ///
    /// [`ServoError::Setting`] for a mass or stiffness that is not positive, or Coulomb friction that drives.
    pub fn new(axis: &TwoMass, sample_s: f64, longest_step_s: f64) -> Result<Self, ServoError> {
        let TwoMass { motor_mass_kg: m, load_mass_kg: load, stiffness_n_m: k, damping_n_s_m: d, .. } = *axis;
        let limit_n = [axis.motor_coulomb_n, axis.load_coulomb_n];
        let numbers = [m, load, k];
        let is_possible = numbers.iter().all(|x| x.is_finite() && *x > 0.0) && limit_n.iter().all(|c| *c >= 0.0);
        if !is_possible {
            let found = numbers.into_iter().chain(limit_n).fold(f64::INFINITY, f64::min);
            let must = "masses and stiffness must be positive, Coulomb friction not negative";
            return Err(ServoError::Setting { what: "least of masses, stiffness and friction", found, must });
        }
        let steps = (sample_s / longest_step_s - 1e-9).ceil().max(1.0);
        let (b_m, b) = (axis.motor_viscous_n_s_m, axis.load_viscous_n_s_m);
        // d/dt [p, ṗ, y, ẏ, F_motor, F_load], forces constant.
        let generator = [
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [-k / m, -(d + b_m) / m, k / m, d / m, 1.0 / m, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [k / load, d / load, -k / load, -(d + b) / load, 0.0, 1.0 / load],
            [0.0; 6],
            [0.0; 6],
        ];
        let over = |step_s: f64| {
            let whole = exponential(&generator.map(|row| row.map(|x| x * step_s)));
            Linear {
                transition: std::array::from_fn(|i| std::array::from_fn(|j| whole[i][j])),
                response: std::array::from_fn(|f| std::array::from_fn(|i| whole[i][STATES + f])),
            }
        };
        Ok(Self {
            step: over(sample_s / steps),
            piece: over(sample_s / steps / PIECES as f64),
            limit_n,
            force_per_volt_n_v: axis.force_per_volt_n_v,
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
        let mut state = [0.0_f64; STATES];
        let mut friction_n = [0.0_f64; 2];
        let mut out = Vec::with_capacity(command_v.len());
        for (k, command) in command_v.iter().enumerate() {
            if state[0].is_nan() || state[0].abs() > RUN_AWAY_M {
                return Err(ServoError::RanAway { time_s: k as f64 * self.sample_s });
            }
            out.push(start_m + state[0]);
            let force_n = self.force_per_volt_n_v * command;
            for _ in 0..self.steps {
                let (next, friction) = self.after(&self.step, &state, friction_n, force_n);
                if self.side(friction) == self.side(friction_n) {
                    (state, friction_n) = (next, friction);
                    continue;
                }
                for _ in 0..PIECES {
                    (state, friction_n) = self.after(&self.piece, &state, friction_n, force_n);
                }
            }
        }
        Ok(out)
    }

    /// Which way each friction stands at its limit; 0 within it.
    fn side(&self, friction_n: [f64; 2]) -> [i8; 2] {
        std::array::from_fn(|i| {
            i8::from(friction_n[i] >= self.limit_n[i]) - i8::from(friction_n[i] <= -self.limit_n[i])
        })
    }

    /// State and friction after one step under a constant force on the motor.
    #[inline]
    fn after(
        &self,
        linear: &Linear,
        state: &[f64; STATES],
        friction_n: [f64; 2],
        force_n: f64,
    ) -> ([f64; STATES], [f64; 2]) {
        let [on_motor, on_load] = &linear.response;
        let free: [f64; STATES] = std::array::from_fn(|i| {
            let row = &linear.transition[i];
            row[0] * state[0] + row[1] * state[1] + row[2] * state[2] + row[3] * state[3] + on_motor[i] * force_n
        });
        // Friction that stops each mass at the end of the step, within its limit. The masses hardly act on each other within a
        // step, so that two sweeps settle it.
        let [mut f_m, mut f_l] = friction_n;
        for _ in 0..2 {
            let v = free[1] - on_load[1] * f_l;
            f_m = (v / on_motor[1]).clamp(-self.limit_n[0], self.limit_n[0]);
            let v = free[3] - on_motor[3] * f_m;
            f_l = (v / on_load[3]).clamp(-self.limit_n[1], self.limit_n[1]);
        }
        (std::array::from_fn(|i| free[i] - on_motor[i] * f_m - on_load[i] * f_l), [f_m, f_l])
    }
}

type Square = [[f64; 6]; 6];

/// `e^A` of a matrix: Taylor's series on a 2⁻ˢ-th of it, squared s times.
fn exponential(a: &Square) -> Square {
    let size = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = if size > 0.25 { (size / 0.25).log2().ceil() as i32 } else { 0 };
    let a = a.map(|row| row.map(|x| x * 0.5_f64.powi(halvings)));
    let mut out: Square = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut term = out;
    // 0.25¹²/12! is 1e-16.
    for k in 1..=12 {
        term = product(&term, &a).map(|row| row.map(|x| x / f64::from(k)));
        for i in 0..6 {
            for j in 0..6 {
                out[i][j] += term[i][j];
            }
        }
    }
    for _ in 0..halvings {
        out = product(&out, &out);
    }
    out
}

fn product(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> TwoMass {
        TwoMass {
            motor_mass_kg: 2.0,
            load_mass_kg: 4.0,
            stiffness_n_m: 2.0e4,
            damping_n_s_m: 10.0,
            motor_viscous_n_s_m: 0.0,
            load_viscous_n_s_m: 0.0,
            motor_coulomb_n: 0.0,
            load_coulomb_n: 0.0,
            force_per_volt_n_v: 6.0,
        }
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
        let axis = TwoMass { motor_coulomb_n: 1.0, load_coulomb_n: 1.5, load_viscous_n_s_m: 2.0, ..axis() };
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
        assert!((axis().antiresonance_hz() - 5000.0_f64.sqrt() / TAU).abs() < 1e-12);
        assert!((axis().resonance_hz() - 15000.0_f64.sqrt() / TAU).abs() < 1e-12);
    }
}
