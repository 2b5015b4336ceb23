//! Does a fitted drag model take power from the body everywhere?
//!
//! **Setting.** The power of the fluid on the body is `P = f·v` \[W\]; drag must keep
//! it at or below zero. Cross terms and negative coefficients can break that.
//! **Frame.** Body axes. **Units.** SI.
//!
//! The power is linear in the coefficients, so no power at the velocities of [`VelocityGrid::points`] is a
//! set of linear constraints for the fit. A grid is no proof between its points;
//! its defaults leave no gap larger than 2° and a factor 1.26 in speed.

/// Velocities that fill the square `±range` by direction and by level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityGrid {
    /// Half the square's side, m/s.
    pub range_m_s: f64,
    /// Directions over the full circle; a multiple of 8 includes both axes and the
    /// corners.
    pub n_directions: usize,
    /// Levels per direction, from `range` down by a factor `10^(−1/10)` each.
    pub n_levels: usize,
}

impl VelocityGrid {
    /// 184 directions by 31 levels: down to a thousandth of the range.
    #[must_use]
    pub const fn over(range_m_s: f64) -> Self {
        Self { range_m_s, n_directions: 184, n_levels: 31 }
    }

    /// The velocities, m/s, body axes; rest is not among them.
    pub fn points(self) -> impl Iterator<Item = [f64; 2]> {
        let Self { range_m_s, n_directions, n_levels } = self;
        (0..n_levels).flat_map(move |level| {
            let reach = range_m_s * libm::exp10(-(level as f64) / 10.0);
            (0..n_directions).map(move |i| {
                let turn = core::f64::consts::TAU * i as f64 / n_directions as f64;
                let (sin, cos) = libm::sincos(turn);
                let scale = reach / cos.abs().max(sin.abs());
                [snap(cos) * scale, snap(sin) * scale]
            })
        })
    }
}

/// The axes exactly, not to within rounding of `cos 90°`.
fn snap(x: f64) -> f64 {
    if x.abs() < 1e-12 { 0.0 } else { x }
}
