//! Thrust and torque of a thruster over its command, with a dead band.
//!
//! ```text
//! s = sgn(x) max(|x| − δ, 0)
//! T = k₊ s² for s > 0,  −k₋ s² for s < 0,  + c |s| u
//! ```
//!
//! **Setting.** A thruster at a steady command `x`, a voltage or a rate of rotation, in water that flows in
//! at `u`; a torque has the same form. **Units.** SI: `T` in N (N m), `x` in V or rad/s, `u` in m/s.
//!
//! **Source.** Fossen (2011), Handbook of Marine Craft Hydrodynamics and Motion Control, 9.1: thrust
//! `T_|n|n |n|n + T_|n|u |n|u`, bilinear in rate and inflow. The dead band is ours: brushes, seals and the
//! converter take the first part of a command.
//! **Range.** Steady commands; inflow along the axis, without reversing the flow through the disc.

/// What a thruster does to a command.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Thruster {
    /// k₊, for commands above zero.
    pub ahead: f64,
    /// k₋, for commands below zero; positive where they pull backwards.
    pub astern: f64,
    /// c, of the inflow.
    pub inflow: f64,
    /// δ, in the unit of the command.
    pub dead_band: f64,
}

impl Thruster {
    /// Derivatives of the load by `ahead`, `astern`, `inflow` and `dead_band`; the load is linear in the first three.
    #[must_use]
    pub fn sensitivity(&self, command: f64, inflow_m_s: f64) -> [f64; 4] {
        let beyond = (command.abs() - self.dead_band).max(0.0);
        if command == 0.0 || beyond == 0.0 {
            return [0.0; 4];
        }
        let square = beyond * beyond;
        let [by_ahead, by_astern] = if command > 0.0 { [square, 0.0] } else { [0.0, -square] };
        let slope = if command > 0.0 { self.ahead } else { -self.astern };
        let by_band = -2.0 * slope * beyond - self.inflow * inflow_m_s;
        [by_ahead, by_astern, beyond * inflow_m_s, by_band]
    }

    /// The load, N or N m.
    #[must_use]
    pub fn load(&self, command: f64, inflow_m_s: f64) -> f64 {
        let [ahead, astern, inflow, _] = self.sensitivity(command, inflow_m_s);
        self.ahead * ahead + self.astern * astern + self.inflow * inflow
    }

    /// The command that gives a load in still water; `None` where none does.
    #[must_use]
    pub fn command(&self, load: f64) -> Option<f64> {
        let factor = if load > 0.0 { self.ahead } else { self.astern };
        let beyond = libm::sqrt(load.abs() / factor);
        (load != 0.0 && beyond.is_finite()).then(|| libm::copysign(self.dead_band + beyond, load))
    }
}
