//! Thrust and torque of a thruster over its command, with a dead band in each direction.
//!
//! ```text
//! s = x − δ₊ for x > δ₊,  x + δ₋ for x < −δ₋,  else 0
//! T = k₊ s² for s > 0,  −k₋ s² for s < 0,  + c |s| u
//! ```
//!
//! **Setting.** A thruster at a steady command `x`, a voltage or a rate of rotation, in water that flows in
//! at `u`; a torque has the same form. **Units.** SI: `T` in N (N m), `x` in V or rad/s, `u` in m/s.
//!
//! **Source.** Fossen (2021), Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., ch. 9: thrust
//! `T_|n|n |n|n + T_|n|u |n|u`, bilinear in rate and inflow. The dead bands are ours: brushes, seals and the
//! converter absorb the first part of a command, by different amounts in the two directions.
//! **Range.** Steady commands; inflow along the axis, without reversing the flow through the disc.

/// What a thruster does to a command: of each pair ahead first, then astern.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Thruster {
    /// k₊ and k₋; positive where it pushes the way it turns.
    pub(crate) slope: [f64; 2],
    /// c, of the inflow.
    pub(crate) inflow: f64,
    /// δ₊ and δ₋, in the unit of the command.
    pub(crate) dead_band: [f64; 2],
}

/// Numbers of a [`Thruster`], in the order of [`Thruster::sensitivity`].
pub(crate) const COEFFICIENTS: usize = 5;

impl Thruster {
    /// From k₊, k₋, c, δ₊ and δ₋.
    pub(crate) const fn of([ahead, astern, inflow, band_ahead, band_astern]: [f64; COEFFICIENTS]) -> Self {
        Self { slope: [ahead, astern], inflow, dead_band: [band_ahead, band_astern] }
    }

    /// Derivatives of the load by k₊, k₋, c, δ₊ and δ₋; the load is linear in the first three.
    pub(crate) fn sensitivity(&self, command: f64, inflow_m_s: f64) -> [f64; COEFFICIENTS] {
        let mut out = [0.0; COEFFICIENTS];
        let (side, sign) = if command > 0.0 { (0, 1.0) } else { (1, -1.0) };
        let beyond = command.abs() - self.dead_band[side];
        if command != 0.0 && beyond > 0.0 {
            out[side] = sign * beyond * beyond;
            out[2] = beyond * inflow_m_s;
            out[3 + side] = -2.0 * sign * self.slope[side] * beyond - self.inflow * inflow_m_s;
        }
        out
    }

    /// The command that gives a load in still water, and √(|T|/k) beyond the dead band; `None` where none does, as of a small load and a dead band below zero.
    pub(crate) fn command(&self, load: f64) -> Option<[f64; 2]> {
        let side = usize::from(load < 0.0);
        let beyond = (load.abs() / self.slope[side]).sqrt();
        let size = self.dead_band[side] + beyond;
        (load != 0.0 && size > 0.0 && size.is_finite()).then(|| [size.copysign(load), beyond])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T = 2 (x + 1)² ahead: nothing gives less than 2 N.
    #[test]
    fn a_dead_band_below_zero_has_no_command_for_small_loads() {
        let thruster = Thruster::of([2.0, 2.0, 0.0, -1.0, 0.5]);
        assert_eq!(thruster.command(8.0), Some([1.0, 2.0]));
        assert_eq!(thruster.command(1.9), None);
        assert_eq!(thruster.command(-8.0), Some([-2.5, 2.0]));
    }
}
