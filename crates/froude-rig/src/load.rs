//! What rides on the carriage: body, ballast, hung weight; its mass, its weight on the wheels, its drag.
//!
//! **Setting.** One body below (wet) or on top of (dry) the platform. **Frame.** Along the axis. **Units.** SI.
//!
//! | state | inertia | wheel load | drag |
//! | --- | --- | --- | --- |
//! | none | M | M g | – |
//! | dry | M + m | (M + m) g | – |
//! | wet | M + m + body water + added mass | (M + m) g − ρ g V | D_d v\|v\| |
//!
//! [`Strut`] says when its tare is added. Ballast adds its mass to inertia and wheel load, a hung weight its mass to the inertia only.
//! The body's water (free-flooding spaces) is carried along but weighs nothing in water.

use crate::parameters::AxisParameters;
use froude_hydro::similarity::GRAVITY_M_S2;

pub use froude_records::run::BodyState;

/// When the strut is in the water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strut {
    /// Never, or too thin to matter.
    #[default]
    Out,
    /// With the body: the difference of wet and dry holds its tare.
    WithBody,
    /// Always: the difference of wet and dry is free of it.
    Always,
}

/// The towed body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TowedBody {
    /// Its mass, kg.
    pub mass_kg: f64,
    /// Water it displaces, m³: what unloads the wheels.
    pub displaced_m3: f64,
    /// Water it carries along in free-flooding spaces, kg.
    pub body_water_kg: f64,
    /// Added mass along the axis, kg.
    pub added_mass_kg: f64,
    /// D_d, N s²/m².
    pub drag_n_s2_m2: f64,
}

impl TowedBody {
    /// A sealed cylinder of the paper's size (radius 0.10 m, height 0.20 m) of 6.0 kg, standing upright, with C_D = 1 (D_d = 20).
    ///
    /// Added mass: 0.6 of the displaced water (chosen; between the sphere's 0.5 and the long cylinder's 1).
    pub const CYLINDER: Self = Self {
        mass_kg: 6.0,
        displaced_m3: 6.283_185_307e-3,
        body_water_kg: 0.3,
        added_mass_kg: 3.77,
        drag_n_s2_m2: 20.0,
    };
}

/// A known weight over a pulley, for calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HungWeight {
    /// Its pull on the load against +y, N (negative: along +y).
    pub weight_n: f64,
    /// Friction of the pulley over the weight \[-\].
    pub pulley_friction: f64,
    /// Below this coordinate the weight rests on the floor and the cord is slack, m.
    pub floor_m: f64,
}

impl Default for HungWeight {
    /// None; one that is hung finds no floor.
    fn default() -> Self {
        Self { weight_n: 0.0, pulley_friction: 0.0, floor_m: f64::NEG_INFINITY }
    }
}

/// Everything that rides on an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// The body.
    pub body: TowedBody,
    /// Where it is.
    pub mounting: BodyState,
    /// Ballast on the carriage, kg. [`Load::balancing_ballast_kg`] gives the wet run the dry run's wheel load.
    pub ballast_kg: f64,
    /// Density of the water, kg/m³.
    pub density_kg_m3: f64,
    /// A weight over a pulley.
    pub hung: HungWeight,
    /// When the strut is in the water.
    pub strut: Strut,
    /// The strut is below the force sensor, so that its tare is measured with the body's drag.
    pub is_strut_below_sensor: bool,
}

impl Default for Load {
    fn default() -> Self {
        Self {
            body: TowedBody::CYLINDER,
            mounting: BodyState::None,
            ballast_kg: 0.0,
            density_kg_m3: 1000.0,
            hung: HungWeight::default(),
            strut: Strut::default(),
            is_strut_below_sensor: false,
        }
    }
}

impl Load {
    /// This load with the body mounted so.
    #[must_use]
    pub fn mounted(mounting: BodyState) -> Self {
        Self { mounting, ..Self::default() }
    }

    fn is_wet(&self) -> bool {
        self.mounting == BodyState::Wet
    }

    /// Buoyancy of the submerged body as a mass, ρV, kg: the ballast that restores the dry wheel load in the wet run.
    #[must_use]
    pub fn balancing_ballast_kg(&self) -> f64 {
        self.density_kg_m3 * self.body.displaced_m3
    }

    /// What the force sensor accelerates: the body, and in water its water and added mass, kg.
    #[must_use]
    pub fn body_inertia_kg(&self) -> f64 {
        match self.mounting {
            BodyState::None => 0.0,
            BodyState::Dry => self.body.mass_kg,
            BodyState::Wet => self.body.mass_kg + self.body.body_water_kg + self.body.added_mass_kg,
        }
    }

    /// M with all that rides on it, kg.
    #[must_use]
    pub fn mass_kg(&self, axis: &AxisParameters) -> f64 {
        axis.load_mass_kg + self.ballast_kg + self.body_inertia_kg() + self.hung.weight_n.abs() / GRAVITY_M_S2
    }

    /// Weight on the wheels, N; never below zero (the carriage would lift).
    #[must_use]
    pub fn wheel_load_n(&self, axis: &AxisParameters) -> f64 {
        let carried_kg = match self.mounting {
            BodyState::None => 0.0,
            BodyState::Dry => self.body.mass_kg,
            BodyState::Wet => self.body.mass_kg - self.balancing_ballast_kg(),
        };
        ((axis.load_mass_kg + self.ballast_kg + carried_kg) * GRAVITY_M_S2).max(0.0)
    }

    /// D_d of the body where it is, N s²/m².
    #[must_use]
    pub fn drag_n_s2_m2(&self) -> f64 {
        if self.is_wet() { self.body.drag_n_s2_m2 } else { 0.0 }
    }

    /// The strut's, N s²/m².
    #[must_use]
    pub fn strut_n_s2_m2(&self, axis: &AxisParameters) -> f64 {
        let is_in = match self.strut {
            Strut::Out => false,
            Strut::WithBody => self.is_wet(),
            Strut::Always => true,
        };
        if is_in { axis.strut_drag_n_s2_m2 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_cylinder_takes_62_newton_off_the_wheels() {
        let y = AxisParameters::long();
        let load = |mounting| Load::mounted(mounting).wheel_load_n(&y);
        let relief_n = load(BodyState::Dry) - load(BodyState::Wet);
        // pi 0.1^2 0.2 m^3 of water.
        assert!((relief_n - 61.617).abs() < 1e-3, "{relief_n}");
        // At 0.01 that is the 0.6 N of friction which an unballasted pair of runs takes for drag.
        let friction = |mounting| y.load_friction_n(load(mounting));
        assert!((friction(BodyState::Dry) - friction(BodyState::Wet) - 0.616).abs() < 1e-3);
    }

    #[test]
    fn balancing_ballast_restores_the_dry_wheel_load() {
        let y = AxisParameters::long();
        let dry = Load::mounted(BodyState::Dry);
        let wet = Load { ballast_kg: dry.balancing_ballast_kg(), ..Load::mounted(BodyState::Wet) };
        assert!((wet.wheel_load_n(&y) - dry.wheel_load_n(&y)).abs() < 1e-12);
    }
}
