//! Between the chain and the motor shaft.

/// The drive between motor and chain: `y = Rθ/n`, `F = (n/R) K_T K_amp v_c`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorSide {
    /// `K_T`, N m/A.
    pub torque_constant_n_m_a: f64,
    /// `K_amp`, A/V.
    pub amplifier_a_v: f64,
    /// `n`.
    pub gear_ratio: f64,
    /// `R`, m.
    pub sprocket_radius_m: f64,
}

impl MotorSide {
    /// The long axis of the towing carriage, MCD Table II.
    pub const MCD: Self =
        Self { torque_constant_n_m_a: 26.7e-3, amplifier_a_v: 0.352, gear_ratio: 34.97, sprocket_radius_m: 0.055 };

    /// `R/n`, metres of chain per radian of the motor.
    #[must_use]
    pub fn m_rad(&self) -> f64 {
        self.sprocket_radius_m / self.gear_ratio
    }

    /// Force at the chain per volt of command, without losses, N/V.
    #[must_use]
    pub fn force_per_volt_n_v(&self) -> f64 {
        self.torque_constant_n_m_a * self.amplifier_a_v / self.m_rad()
    }

    /// Inertia at the motor of a mass at the chain, kg m²: `J_eff` of the identified `M`.
    #[must_use]
    pub fn inertia_kg_m2(&self, mass_kg: f64) -> f64 {
        mass_kg * self.m_rad().powi(2)
    }

    /// Viscous coefficient at the motor, N m s/rad: `B_eff` of `F_v`.
    #[must_use]
    pub fn viscous_n_m_s_rad(&self, viscous_n_s_m: f64) -> f64 {
        viscous_n_s_m * self.m_rad().powi(2)
    }

    /// Torque at the motor of a force at the chain, N m: `C_eff` of `F_c`.
    #[must_use]
    pub fn torque_n_m(&self, force_n: f64) -> f64 {
        force_n * self.m_rad()
    }
}

/// A drive as it is declared, with what is not known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Its constants.
    pub motor: MotorSide,
    /// Standard uncertainty of `K_T K_amp`, as a part.
    pub torque_relative: f64,
    /// That of `R`, as a part.
    pub radius_relative: f64,
    /// Key of the rig: what has the same one has the same errors.
    pub rig: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_has_five_point_nine_eight_newtons_a_volt() {
        assert!((MotorSide::MCD.force_per_volt_n_v() - 5.976).abs() < 0.0005);
    }
}
