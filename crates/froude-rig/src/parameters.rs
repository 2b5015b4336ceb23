//! The constants of the twin's axes: what was published, what had to be chosen, what follows.
//!
//! The paper (MCD, Table II) gives J_eff, B_eff, C_eff, K_T, K_amp, n and R, and the frequencies of the chain's modes. It never
//! gives J_m, M, K_e, B_e, nor how friction is split between motor and load, nor anything of the short axis but its 45 Hz. Those
//! are chosen here, once, so that the published sums come out.
//!
//! **Setting.** The bare carriage: no body, no ballast. **Frame.** Axis coordinate along the chain, y = Rθ/n. **Units.** SI.
//!
//! | relation | function | source |
//! | --- | --- | --- |
//! | J_eff = J_m + M(R/n)² and so on | [`AxisParameters::effective`] | MCD eq. 3b |
//! | (2πf)² = K_e (1/M + (R/n)²/J_m) | [`AxisParameters::motor_side_mode_hz`] | both masses free |
//! | (2πf)² = K_e / M | [`AxisParameters::load_mode_hz`] | motor held by the position loop |
//! | the values | [`AxisParameters::long`], [`AxisParameters::short`] | MCD Table II; chosen; derived |
//!
//! Two things to keep apart. The **motor-side mode** (13 Hz, 45 Hz) is the free-free one: the motor swings against the load, and
//! the drive current sees it. The **load mode** is what the load does when a stiff loop holds the motor still: it is lower
//! (6.7 Hz bare on the long axis, below 4 Hz with a wet body), the encoder hardly sees it, and it is what ripples the tow.
//!
//! Gear efficiency is not in eq. 3b. With it, the motor that drives sees `M (R/n)²/η` and `C R/(n η)`:
//! [`AxisParameters::apparent`].

use core::f64::consts::PI;

use froude_hydro::similarity::GRAVITY_M_S2;

/// Published J_eff, kg m² (MCD Table II).
pub const J_EFF_KG_M2: f64 = 1.502e-5;
/// Published B_eff, N m s/rad.
pub const B_EFF_N_M_S_RAD: f64 = 4.657e-6;
/// Published C_eff, N m.
pub const C_EFF_N_M: f64 = 3.9e-3;
/// Published K_T, N m/A (printed N/m).
pub const TORQUE_CONSTANT_N_M_A: f64 = 26.7e-3;
/// Published K_amp, A/V.
pub const AMPLIFIER_A_V: f64 = 0.352;
/// Published n.
pub const GEAR_RATIO: f64 = 34.97;
/// Published R, m.
pub const SPROCKET_RADIUS_M: f64 = 0.055;
/// 1000 lines, decoded four times.
pub const COUNTS_PER_REVOLUTION: f64 = 4000.0;
/// Published mode of the long axis, Hz.
pub const LONG_MODE_HZ: f64 = 13.0;
/// Published mode of the short axis, Hz.
pub const SHORT_MODE_HZ: f64 = 45.0;

/// R/n of both axes, m/rad.
const CHAIN_M_RAD: f64 = SPROCKET_RADIUS_M / GEAR_RATIO;

/// One axis of the bare carriage, as the twin knows it. The controller has declared values of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisParameters {
    /// J_m, kg m²: rotor, gearbox and sprocket at the motor.
    pub motor_inertia_kg_m2: f64,
    /// M, kg: what moves with the chain, without body and ballast.
    pub load_mass_kg: f64,
    /// K_e, N/m.
    pub stiffness_n_m: f64,
    /// B_e, N s/m.
    pub chain_damping_n_s_m: f64,
    /// B_m, N m s/rad.
    pub motor_viscous_n_m_s_rad: f64,
    /// B, N s/m.
    pub load_viscous_n_s_m: f64,
    /// C_m, N m.
    pub motor_coulomb_n_m: f64,
    /// Part of C that does not depend on the wheel load, N.
    pub load_coulomb_n: f64,
    /// Rolling friction per wheel load \[-\]; the rest of C.
    pub rolling_coefficient: f64,
    /// Breakaway over sliding friction of the load, less one \[-\].
    pub stribeck_excess: f64,
    /// Speed at which half of that excess is left, m/s.
    pub stribeck_speed_m_s: f64,
    /// Growth of the load's friction at mid-travel, as a fraction; a parabola that is zero at both ends of travel.
    pub bump: f64,
    /// Friction is `1 + asymmetry` times C forward and `1 − asymmetry` times C backward.
    pub asymmetry: f64,
    /// η: part of the motor's torque that reaches the chain when the motor drives.
    pub efficiency_forward: f64,
    /// η_b: part of the chain's torque that reaches the motor when the load drives.
    pub efficiency_backward: f64,
    /// K_T, N m/A.
    pub torque_constant_n_m_a: f64,
    /// n.
    pub gear_ratio: f64,
    /// R, m.
    pub sprocket_radius_m: f64,
    /// Counts per revolution of the motor.
    pub counts_per_revolution: f64,
    /// +1 or −1: sign of counts for positive motion.
    pub encoder_sign: f64,
    /// Hard stops, m.
    pub hard_low_m: f64,
    /// The far one, m.
    pub hard_high_m: f64,
    /// End switches open this far before the hard stops, m.
    pub switch_margin_m: f64,
    /// Strut in the water: tare drag over v|v|, N s²/m².
    pub strut_drag_n_s2_m2: f64,
}

/// The three sums of MCD eq. 3b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effective {
    /// J_eff, kg m².
    pub inertia_kg_m2: f64,
    /// B_eff, N m s/rad.
    pub viscous_n_m_s_rad: f64,
    /// C_eff, N m.
    pub coulomb_n_m: f64,
}

impl AxisParameters {
    /// The long axis `y`, bare, with the published sums; the gear has the declared efficiency of 0.8.
    #[must_use]
    pub const fn long() -> Self {
        let motor_inertia_kg_m2 = 4.0e-6; // chosen: rotor of a 60 W motor, gearbox and coupling
        let load_mass_kg = (J_EFF_KG_M2 - motor_inertia_kg_m2) / (CHAIN_M_RAD * CHAIN_M_RAD);
        let load_viscous_n_s_m = 1.0; // chosen: about half of B_eff
        let motor_coulomb_n_m = 0.4 * C_EFF_N_M; // chosen: 40 % of C_eff at brushes and gear
        let rolling_coefficient = 0.01; // chosen: rollers on ball bearings, C − C_0 = μ_r · wheel load
        let load_total_n = (C_EFF_N_M - motor_coulomb_n_m) / CHAIN_M_RAD;
        // Damping ratio chosen: a plastic chain with steel wire.
        let (stiffness_n_m, chain_damping_n_s_m) = spring(LONG_MODE_HZ, 0.05, motor_inertia_kg_m2, load_mass_kg);
        Self {
            motor_inertia_kg_m2,
            load_mass_kg,
            stiffness_n_m,
            chain_damping_n_s_m,
            motor_viscous_n_m_s_rad: B_EFF_N_M_S_RAD - load_viscous_n_s_m * CHAIN_M_RAD * CHAIN_M_RAD,
            load_viscous_n_s_m,
            motor_coulomb_n_m,
            load_coulomb_n: load_total_n - rolling_coefficient * load_mass_kg * GRAVITY_M_S2,
            rolling_coefficient,
            stribeck_excess: 0.1,      // chosen: breakaway 10 % above sliding friction of the load
            stribeck_speed_m_s: 0.005, // chosen: below the slowest tow, 1 % of the excess left at 0.05 m/s
            bump: 0.2,                 // friction grows mid-tank (seen, not modelled, in MCD)
            asymmetry: 0.0,
            efficiency_forward: 0.8,   // chosen: two-stage planetary gearbox; MCD leaves it out
            efficiency_backward: 0.75, // chosen: back-driven it loses more
            torque_constant_n_m_a: TORQUE_CONSTANT_N_M_A,
            gear_ratio: GEAR_RATIO,
            sprocket_radius_m: SPROCKET_RADIUS_M,
            counts_per_revolution: COUNTS_PER_REVOLUTION,
            encoder_sign: 1.0,
            hard_low_m: -0.05,
            hard_high_m: 4.95,
            switch_margin_m: 0.05,
            strut_drag_n_s2_m2: 1.5, // chosen: tare of the strut when the body is wet
        }
    }

    /// The short axis `x`, bare: all chosen but the 45 Hz, and the drive line, which the paper says is the same on both axes.
    #[must_use]
    pub const fn short() -> Self {
        let motor_inertia_kg_m2 = 1.2e-6; // chosen: rotor of a 20 W motor, gearbox and coupling
        let load_mass_kg = 1.5; // chosen: the platform alone
        let (stiffness_n_m, chain_damping_n_s_m) = spring(SHORT_MODE_HZ, 0.05, motor_inertia_kg_m2, load_mass_kg);
        Self {
            motor_inertia_kg_m2,
            load_mass_kg,
            stiffness_n_m,
            chain_damping_n_s_m,
            motor_viscous_n_m_s_rad: 1.0e-6, // chosen: half of the long axis's
            load_viscous_n_s_m: 0.5,         // chosen: linear shaft bearings
            motor_coulomb_n_m: 0.9e-3,       // chosen: a smaller motor
            load_coulomb_n: 0.5,             // chosen: linear shaft bearings
            hard_high_m: 1.15,               // chosen: the tank's width less the platform
            ..Self::long()
        }
    }

    /// The same axis without any loss: no friction, no viscous force, no chain damping, a perfect gear, no strut.
    ///
    /// For tests of the integrator.
    #[must_use]
    pub const fn lossless(self) -> Self {
        Self {
            chain_damping_n_s_m: 0.0,
            motor_viscous_n_m_s_rad: 0.0,
            load_viscous_n_s_m: 0.0,
            motor_coulomb_n_m: 0.0,
            load_coulomb_n: 0.0,
            rolling_coefficient: 0.0,
            efficiency_forward: 1.0,
            efficiency_backward: 1.0,
            strut_drag_n_s2_m2: 0.0,
            ..self
        }
    }

    /// R/n, m/rad.
    #[must_use]
    pub const fn chain_m_rad(&self) -> f64 {
        self.sprocket_radius_m / self.gear_ratio
    }

    /// Where the low end switch opens, m.
    #[must_use]
    pub const fn low_switch_m(&self) -> f64 {
        self.hard_low_m + self.switch_margin_m
    }

    /// Where the high end switch opens, m.
    #[must_use]
    pub const fn high_switch_m(&self) -> f64 {
        self.hard_high_m - self.switch_margin_m
    }

    /// J_m (n/R)²: the rotor's inertia as a mass at the chain, kg.
    #[must_use]
    pub const fn motor_mass_kg(&self) -> f64 {
        self.motor_inertia_kg_m2 / (self.chain_m_rad() * self.chain_m_rad())
    }

    /// Metres of chain per encoder count.
    #[must_use]
    pub const fn metres_per_count(&self) -> f64 {
        2.0 * PI * self.chain_m_rad() / self.counts_per_revolution
    }

    /// Sliding friction of the load at the ends of travel for a wheel load, N.
    #[must_use]
    pub const fn load_friction_n(&self, wheel_load_n: f64) -> f64 {
        let rolling = self.rolling_coefficient * wheel_load_n;
        self.load_coulomb_n + if rolling > 0.0 { rolling } else { 0.0 }
    }

    /// The sums of MCD eq. 3b as printed, for the bare carriage: the published values on the long axis.
    #[must_use]
    pub const fn effective(&self) -> Effective {
        self.seen_by_motor(self.load_mass_kg, self.load_mass_kg * GRAVITY_M_S2, 1.0)
    }

    /// What a motor that drives through a gear of efficiency η really sees with a load of this mass and wheel load.
    ///
    /// This is what an identification from currents finds, and what a feed-forward needs.
    #[must_use]
    pub const fn apparent(&self, load_mass_kg: f64, wheel_load_n: f64) -> Effective {
        self.seen_by_motor(load_mass_kg, wheel_load_n, self.efficiency_forward)
    }

    const fn seen_by_motor(&self, load_mass_kg: f64, wheel_load_n: f64, efficiency: f64) -> Effective {
        let r = self.chain_m_rad();
        Effective {
            inertia_kg_m2: self.motor_inertia_kg_m2 + load_mass_kg * r * r / efficiency,
            viscous_n_m_s_rad: self.motor_viscous_n_m_s_rad + self.load_viscous_n_s_m * r * r / efficiency,
            coulomb_n_m: self.motor_coulomb_n_m + self.load_friction_n(wheel_load_n) * r / efficiency,
        }
    }

    /// Free-free mode of motor and load, undamped, Hz: 13 and 45 for the bare carriage.
    ///
    /// `load_mass_kg` is M with all that rides on it: body, ballast, the body's water, added mass.
    #[must_use]
    pub fn motor_side_mode_hz(&self, load_mass_kg: f64) -> f64 {
        libm::sqrt(self.stiffness_n_m * (1.0 / load_mass_kg + 1.0 / self.motor_mass_kg())) / (2.0 * PI)
    }

    /// Mode of the load on the chain while the position loop holds the motor, √(K_e/M)/2π, Hz.
    #[must_use]
    pub fn load_mode_hz(&self, load_mass_kg: f64) -> f64 {
        libm::sqrt(self.stiffness_n_m / load_mass_kg) / (2.0 * PI)
    }

    /// Damping ratio of that mode from the chain and the load's viscous force, without Coulomb friction and drag \[-\].
    #[must_use]
    pub fn load_mode_damping(&self, load_mass_kg: f64) -> f64 {
        0.5 * (self.chain_damping_n_s_m + self.load_viscous_n_s_m) / libm::sqrt(self.stiffness_n_m * load_mass_kg)
    }
}

/// K_e and B_e that put the free-free mode at a frequency with a damping ratio.
const fn spring(mode_hz: f64, damping: f64, motor_inertia_kg_m2: f64, load_mass_kg: f64) -> (f64, f64) {
    let omega = 2.0 * PI * mode_hz;
    let motor_mass_kg = motor_inertia_kg_m2 / (CHAIN_M_RAD * CHAIN_M_RAD);
    let reduced_kg = motor_mass_kg * load_mass_kg / (motor_mass_kg + load_mass_kg);
    (omega * omega * reduced_kg, 2.0 * damping * omega * reduced_kg)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A handful of roundings.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;

    fn agree(a: f64, b: f64) {
        assert!((a - b).abs() <= ROUNDING * b.abs(), "{a} is not {b}");
    }

    #[test]
    fn the_published_sums_come_out() {
        let e = AxisParameters::long().effective();
        agree(e.inertia_kg_m2, J_EFF_KG_M2);
        agree(e.viscous_n_m_s_rad, B_EFF_N_M_S_RAD);
        agree(e.coulomb_n_m, C_EFF_N_M);
    }

    #[test]
    fn the_bare_carriage_has_the_published_modes() {
        for (axis, hz) in [(AxisParameters::long(), 13.0), (AxisParameters::short(), 45.0)] {
            agree(axis.motor_side_mode_hz(axis.load_mass_kg), hz);
        }
    }

    #[test]
    fn a_heavier_load_lowers_both_modes_and_the_held_motor_the_second() {
        let y = AxisParameters::long();
        let (bare, wet) = (y.load_mass_kg, y.load_mass_kg + 10.0);
        assert!(y.motor_side_mode_hz(wet) < y.motor_side_mode_hz(bare));
        assert!(y.load_mode_hz(wet) < y.load_mode_hz(bare));
        assert!(y.load_mode_hz(bare) < y.motor_side_mode_hz(bare));
        // With an endless load only the motor swings, with an endless motor only the load.
        agree(y.motor_side_mode_hz(f64::INFINITY), y.load_mode_hz(y.motor_mass_kg()));
    }
}
