//! Exact motion of two masses and a chain over one step of constant forces.
//!
//! The linear part of MCD eq. 2 (inertia, spring, chain damping, viscous forces: [`TwoMasses`]) is carried over a step by its matrix exponential,
//! so neither the modes nor the energy depend on the step. What is not linear (friction, drag, gear loss, stops) enters as forces
//! held constant within the step.
//!
//! **Frame.** Chain coordinate: motor position q = Rθ/n, load position y. **Units.** SI; the rotor counts as the mass J_m (n/R)².

use froude_signal::exponential::{Square, exponential};
use froude_signal::two_mass::TwoMasses;

/// Rows and columns of the augmented system: Δq, Δy, v_q, v_y, then the constants s₀ = q₀ − y₀, f_q, f_y.
const N: usize = 7;
type Matrix = Square<N>;

/// One step with both masses sliding: each row gives one of Δq, Δy, v_q', v_y' from (s, v_q, v_y, f_q, f_y).
pub type Both = [[f64; 5]; 4];
/// One step with one mass held: rows Δ and v' of the other from (s, its v, its f).
pub type One = [[f64; 3]; 2];

/// The propagators of one step: which masses slide, and which of two reactions of the chain the motor feels, is all that changes
/// from step to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propagators {
    /// Both slide; for each reaction.
    pub both: [Both; 2],
    /// Only the motor slides; for each reaction.
    pub motor: [One; 2],
    /// Only the load slides.
    pub load: One,
}

impl Propagators {
    /// Those of a step. The motor feels the chain's force times a reaction factor: 1 for a perfect gear, two values for a
    /// lossy one (driving, driven).
    #[must_use]
    pub fn of(masses: &TwoMasses, step_s: f64, reactions: [f64; 2]) -> Self {
        let pick = |m: &Matrix, row: usize, columns: [usize; 3]| columns.map(|c| m[row][c]);
        Self {
            both: reactions.map(|reaction| both(masses, step_s, reaction)),
            motor: reactions.map(|reaction| {
                let m = step(masses, step_s, Some(reaction), false);
                [0, 2].map(|r| pick(&m, r, [4, 2, 5]))
            }),
            load: {
                let m = step(masses, step_s, None, true);
                [1, 3].map(|r| pick(&m, r, [4, 3, 6]))
            },
        }
    }
}

/// One step with both masses sliding; the motor feels the chain's force times `reaction`.
#[must_use]
pub fn both(masses: &TwoMasses, step_s: f64, reaction: f64) -> Both {
    let m = step(masses, step_s, Some(reaction), true);
    [0, 1, 2, 3].map(|r| [4, 2, 3, 5, 6].map(|c| m[r][c]))
}

/// `reaction`: of the chain on a sliding motor; none when the motor is held.
fn step(masses: &TwoMasses, step_s: f64, reaction: Option<f64>, load_slides: bool) -> Matrix {
    // Of the increments; the extension at the start goes in as the motor's position does.
    let row = |[q, y, v_q, v_y, f_q, f_y]: [f64; 6]| [q, y, v_q, v_y, q, f_q, f_y];
    let mut a = [[0.0; N]; N];
    if let Some(reaction) = reaction {
        a[0][2] = 1.0;
        a[2] = row(masses.motor(reaction));
    }
    if load_slides {
        a[1][3] = 1.0;
        a[3] = row(masses.load());
    }
    for row in &mut a {
        for x in row {
            *x *= step_s;
        }
    }
    exponential(a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spring of 100 N/m between 1 kg and 4 kg: ω² = 100 (1 + 1/4) = 125.
    const FREE: TwoMasses = TwoMasses {
        motor_mass_kg: 1.0,
        load_mass_kg: 4.0,
        stiffness_n_m: 100.0,
        damping_n_s_m: 0.0,
        motor_viscous_n_s_m: 0.0,
        load_viscous_n_s_m: 0.0,
    };

    #[test]
    fn the_free_mode_is_a_cosine_at_any_step() {
        let omega = 125.0_f64.sqrt();
        for step_s in [1e-4, 1e-2, 0.3] {
            let p = Propagators::of(&FREE, step_s, [1.0; 2]).both[0];
            // From rest with extension 1 the extension is cos ωt: Δq takes 4/5 of the change, Δy 1/5.
            let change = (omega * step_s).cos() - 1.0;
            // Each squaring doubles the rounding; ‖A‖ = 400 h halved eight times at most: 2⁸ · 4 · ε · 1/2.
            assert!((p[0][0] - 0.8 * change).abs() < 2e-13, "{step_s}");
            assert!((p[1][0] + 0.2 * change).abs() < 2e-13, "{step_s}");
        }
    }

    #[test]
    fn a_force_on_both_masses_by_their_weight_moves_them_as_one() {
        let t = 0.25;
        let p = Propagators::of(&FREE, t, [1.0; 2]).both[0];
        let of = |row: [f64; 5]| row[3] * 1.0 + row[4] * 4.0;
        assert!((of(p[0]) - 0.5 * t * t).abs() < 1e-15 && (of(p[2]) - t).abs() < 1e-15);
        assert!((of(p[1]) - 0.5 * t * t).abs() < 1e-15 && (of(p[3]) - t).abs() < 1e-15);
    }

    #[test]
    fn with_one_mass_held_the_other_swings_alone() {
        let t = 0.2;
        let p = Propagators::of(&FREE, t, [1.0; 2]);
        assert!((p.motor[0][1][1] - (10.0 * t).cos()).abs() < 1e-14);
        assert!((p.load[1][1] - (5.0 * t).cos()).abs() < 1e-14);
    }

    #[test]
    fn a_reaction_factor_acts_as_a_lighter_motor_on_the_same_chain() {
        // m v̇ = −κ F is (m/κ) v̇ = −F: a motor of half the mass, and half its own force.
        let t = 0.1;
        let light = Propagators::of(&TwoMasses { motor_mass_kg: 0.5, ..FREE }, t, [1.0; 2]).both[0];
        let driven = Propagators::of(&FREE, t, [1.0, 2.0]).both[1];
        for (l, d) in light.iter().zip(&driven) {
            for (i, (l, d)) in l.iter().zip(d).enumerate() {
                let scale = if i == 3 { 0.5 } else { 1.0 };
                assert!((l * scale - d).abs() < 1e-13, "{l} {d}");
            }
        }
    }

    #[test]
    fn a_lone_viscous_mass_decays_exponentially() {
        let slow = TwoMasses { stiffness_n_m: 0.0, load_viscous_n_s_m: 3.0, ..FREE };
        assert!((Propagators::of(&slow, 2.0, [1.0; 2]).both[0][3][2] - (-1.5_f64).exp()).abs() < 1e-15);
    }
}
