//! Loads that depend on position and speed: gravity on a pendulum, springs, cables, the drag of a body.
//!
//! | load   | what the drive gives for it                                      |
//! |--------|------------------------------------------------------------------|
//! | terms  | `Σ k_j φ_j(q, v)`, formulas that are linear in their coefficients |
//! | table  | a known load over position, by straight lines                     |
//!
//! Friction in proportion to the load is that of these loads; the torque of the inertia is not included, unlike Hamon et al.
//!
//! **Sign.** As friction: positive is what the drive must give in the direction of positive positions to hold the axis.

use froude_identify::formula::Formula;

use crate::servo::coordinate::Coordinate;
use crate::servo::friction::Regressor;
use crate::servo::motion::Motion;

/// What loads an axis beside its inertia and friction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    /// Formulas over position and speed, by the names of the coordinate, with the units of their coefficients.
    pub terms: Vec<(Formula, Vec<String>)>,
    /// A load that is known.
    pub known: Option<Curve>,
}

/// What a law says beside its friction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// What moves along what.
    pub coordinate: Coordinate,
    /// Formulas of the load, with their coefficients and channels.
    pub loads: Vec<Formula>,
    /// Stribeck's speed, where there is one.
    pub stribeck_speed: Option<f64>,
    /// Whether a known load is in the fit that no formula gives.
    pub is_tabled: bool,
    /// Whether the fit is that of a simulated speed, and its residuals are speeds.
    pub is_simulated: bool,
}

/// A load over position, by straight lines between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Positions, rising.
    pub position: Vec<f64>,
    /// The load there, N or N m.
    pub load: Vec<f64>,
}

impl Curve {
    /// The load at a position; at the ends that of the ends.
    #[must_use]
    pub fn at(&self, q: f64) -> f64 {
        let last = self.position.len().saturating_sub(1);
        let after = self.position.partition_point(|p| *p <= q).clamp(1.min(last), last);
        let point = |i: usize| Some((*self.position.get(i)?, *self.load.get(i)?));
        let (Some((a, f_a)), Some((b, f_b))) = (point(after.saturating_sub(1)), point(after)) else { return f64::NAN };
        let part = if b > a { ((q - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        (1.0 - part) * f_a + part * f_b
    }
}

impl Load {
    /// Whether there is none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.terms.is_empty() && self.known.is_none()
    }

    /// A column for each coefficient.
    pub(crate) fn columns(&self, motion: &Motion, coordinate: Coordinate) -> Vec<Regressor> {
        let speed = coordinate.names().speed[0];
        let n = motion.position_m.len();
        let mut out = Vec::new();
        for (formula, units) in &self.terms {
            let first = out.len();
            for ((name, _), unit) in formula.coefficients.iter().zip(units) {
                let values = Vec::with_capacity(n);
                out.push(Regressor { name: name.clone(), unit: unit.clone().into(), values });
            }
            let (mut row, mut channels) = (vec![0.0; units.len()], vec![0.0; formula.channels.len()]);
            for (q, v) in motion.position_m.iter().zip(&motion.velocity_m_s) {
                for (x, name) in channels.iter_mut().zip(&formula.channels) {
                    *x = if name == speed { *v } else { *q };
                }
                formula.regressor(&channels, &mut row);
                out[first..].iter_mut().zip(&row).for_each(|(column, x)| column.values.push(*x));
            }
        }
        out
    }

    /// The known load.
    pub(crate) fn known(&self, position: &[f64]) -> Vec<f64> {
        position.iter().map(|q| self.known.as_ref().map_or(0.0, |curve| curve.at(*q))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_load_lies_on_lines_between_its_points() {
        let curve = Curve { position: vec![-1.0, 0.0, 2.0], load: vec![3.0, 1.0, 5.0] };
        for (q, expected) in [(-2.0, 3.0), (-0.5, 2.0), (0.0, 1.0), (1.0, 3.0), (2.0, 5.0), (9.0, 5.0)] {
            assert!((curve.at(q) - expected).abs() < 1e-15, "{q}");
        }
    }
}
