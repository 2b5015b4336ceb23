//! Two masses and a chain: the linear part of MCD eq. 2.
//!
//! m q̈ = f_q − b_m q̇ − κ F, M ÿ = f_y − b ẏ + F, F = K (q − y) + B (q̇ − ẏ), with the reaction κ by which a gear lets the motor feel the chain's
//! force (1 without a gear). The twin of a carriage and the observer that identifies one are both made of these rows; their friction is their
//! own, since a twin must stick exactly and an estimate must be differentiable.
//!
//! **Frame.** Chain coordinate: motor q = Rθ/n, load y. **Units.** SI; the rotor counts as the mass J_m (n/R)².

use std::f64::consts::TAU;

/// Two masses and their chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoMasses {
    /// J_m (n/R)², kg.
    pub motor_mass_kg: f64,
    /// M with what rides on it, kg.
    pub load_mass_kg: f64,
    /// K_e, N/m.
    pub stiffness_n_m: f64,
    /// B_e, N s/m.
    pub damping_n_s_m: f64,
    /// B_m (n/R)², N s/m.
    pub motor_viscous_n_s_m: f64,
    /// B, N s/m.
    pub load_viscous_n_s_m: f64,
}

/// An acceleration by the state (q, y, q̇, ẏ) and the forces (f_q, f_y).
pub type Row = [f64; 6];

impl TwoMasses {
    /// Acceleration of the motor, which feels `reaction` times the chain's force.
    #[must_use]
    pub fn motor(&self, reaction: f64) -> Row {
        let (m, k, c) = (self.motor_mass_kg, reaction * self.stiffness_n_m, reaction * self.damping_n_s_m);
        [-k / m, k / m, -(c + self.motor_viscous_n_s_m) / m, c / m, 1.0 / m, 0.0]
    }

    /// Acceleration of the load.
    #[must_use]
    pub fn load(&self) -> Row {
        let (m, k, c) = (self.load_mass_kg, self.stiffness_n_m, self.damping_n_s_m);
        [k / m, -k / m, c / m, -(c + self.load_viscous_n_s_m) / m, 0.0, 1.0 / m]
    }

    /// Frequency at which the load swings against a held motor, √(K/M)/2π, Hz.
    #[must_use]
    pub fn antiresonance_hz(&self) -> f64 {
        (self.stiffness_n_m / self.load_mass_kg).sqrt() / TAU
    }

    /// Frequency at which both swing against each other, √(K (1/M + 1/m))/2π, Hz.
    #[must_use]
    pub fn resonance_hz(&self) -> f64 {
        (self.stiffness_n_m * (1.0 / self.load_mass_kg + 1.0 / self.motor_mass_kg)).sqrt() / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: TwoMasses = TwoMasses {
        motor_mass_kg: 2.0,
        load_mass_kg: 4.0,
        stiffness_n_m: 100.0,
        damping_n_s_m: 3.0,
        motor_viscous_n_s_m: 0.0,
        load_viscous_n_s_m: 0.0,
    };

    #[test]
    fn the_chain_gives_no_momentum_and_no_force_to_what_moves_as_one() {
        let (motor, load) = (AXIS.motor(1.0), AXIS.load());
        for k in 0..4 {
            assert!((2.0 * motor[k] + 4.0 * load[k]).abs() < 1e-12);
        }
        assert_eq!([motor[0] + motor[1], motor[2] + motor[3], load[0] + load[1], load[2] + load[3]], [0.0; 4]);
    }

    #[test]
    fn both_modes_have_their_textbook_frequencies() {
        assert!((AXIS.antiresonance_hz() - 5.0 / TAU).abs() < 1e-15);
        assert!((AXIS.resonance_hz() - 75.0_f64.sqrt() / TAU).abs() < 1e-15);
    }
}
