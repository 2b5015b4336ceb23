//! Does a fitted drag model take power from the body everywhere?
//!
//! **Setting.** The power of the fluid on the body is `P = f·v` \[W\]; drag must keep
//! it at or below zero. Cross terms and negative coefficients can break that.
//! **Frame.** Body axes. **Units.** SI.
//!
//! | what                                   | function                    |
//! |----------------------------------------|-----------------------------|
//! | the velocities looked at               | [`VelocityGrid::points`]    |
//! | largest power over them                | [`largest_power`]           |
//! | `P` as a row over the coefficients     | [`power_row`]               |
//!
//! The power is linear in the coefficients, so `power_row · c ≤ 0` over the grid is
//! a set of linear constraints for the fit. A grid is no proof between its points;
//! its defaults leave no gap larger than 2° and a factor 1.26 in speed.

use crate::drag::{DragModel, MAX_COEFFICIENTS, Setting};

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

/// Where the fluid gives the most power, or takes the least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestPower {
    /// `f·v` there, W; above zero means that the model drives the body.
    pub power_w: f64,
    /// `f·v / (|f||v|)` there, between −1 and 1 \[-\]; 0 for no force.
    pub cosine: f64,
    /// The velocity, m/s, body axes.
    pub v_m_s: [f64; 2],
}

impl LargestPower {
    /// Whether no power is delivered, up to rounding of the sum (`1e-12` of `|f||v|`).
    #[must_use]
    pub fn is_dissipative(&self) -> bool {
        self.power_w <= 0.0 || self.cosine <= 1e-12
    }
}

/// The largest `f·v` of any force law over a grid.
///
/// Ordered by the cosine between force and velocity and not by the watts, so that
/// a violation at low speed is not hidden. `None` for an empty grid or a law that
/// is nowhere finite.
pub fn largest_power(grid: VelocityGrid, mut force_n: impl FnMut([f64; 2]) -> [f64; 2]) -> Option<LargestPower> {
    let mut worst: Option<LargestPower> = None;
    for v_m_s in grid.points() {
        let f = force_n(v_m_s);
        let power_w = f[0] * v_m_s[0] + f[1] * v_m_s[1];
        let product = libm::hypot(f[0], f[1]) * libm::hypot(v_m_s[0], v_m_s[1]);
        let cosine = if product > 0.0 { power_w / product } else { 0.0 };
        if cosine.is_finite() && worst.is_none_or(|w| cosine > w.cosine) {
            worst = Some(LargestPower { power_w, cosine, v_m_s });
        }
    }
    worst
}

impl DragModel {
    /// [`largest_power`] of this model with coefficients `c`, cross terms as the
    /// setting says.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::dissipation::VelocityGrid;
    /// use froude_hydro::{Body, DragModel, Link, Setting};
    /// # let body = Body {
    /// #     link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
    /// #     head_side_area_m2: 0.011, tail_side_area_m2: 0.008 };
    /// let setting = Setting::as_published(body, 2.0, 1025.0);
    /// let grid = VelocityGrid::over(1.0);
    /// let good = DragModel::F2.largest_power(&setting, &[0.0, 0.06, 0.05, 1.86], grid);
    /// assert!(good.is_some_and(|p| p.is_dissipative()));
    /// let bad = DragModel::F2.largest_power(&setting, &[-0.1, 0.06, 0.05, 1.86], grid);
    /// assert!(bad.is_some_and(|p| !p.is_dissipative()));
    /// ```
    #[must_use]
    pub fn largest_power(self, s: &Setting, c: &[f64], grid: VelocityGrid) -> Option<LargestPower> {
        largest_power(grid, |v| self.force_n(s, v, c))
    }
}

/// The power `f·v` at one velocity as a row over the coefficients, W per unit.
///
/// `out[j]` is the power that a unit of coefficient `j` delivers; `row · c ≤ 0`
/// keeps a fit dissipative there. `out` is as for [`DragModel::regressor`].
pub fn power_row(model: DragModel, s: &Setting, v_m_s: [f64; 2], out: &mut [f64]) {
    let mut unit = [0.0; MAX_COEFFICIENTS];
    model.regressor(s, v_m_s, &mut unit);
    for ((value, info), unit) in out.iter_mut().zip(model.coefficients()).zip(unit) {
        *value = unit * v_m_s[info.axis.index()];
    }
}
