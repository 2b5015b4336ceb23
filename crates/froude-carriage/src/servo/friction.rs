//! Friction laws that are linear in their coefficients.
//!
//! | term          | regressor                             | coefficient                    |
//! |---------------|---------------------------------------|--------------------------------|
//! | viscous       | `v`, or `v` of each direction         | `F_v`; `F_v+`, `F_v-`          |
//! | Coulomb       | `sgn v`, or one of each direction     | `F_c`; `F_c+`, `F_c-`          |
//! | over position | `sgn v` times a hat over each knot    | `F_c(y = …)`, linear between   |
//! | Stribeck      | `sgn v exp(−(v/v_s)²)`                | `F_s`, with `v_s` given         |
//! | of the load   | `sgn v` times the size of the load     | `F_l` (in the chain, which has the load) |
//! | offset        | 1                                     | `offset`                       |
//!
//! Two Coulomb terms of different size in both directions are an offset and a mean: the offset is left out
//! where directions are distinguished.

use std::borrow::Cow;

use crate::servo::coordinate::{Coordinate, STRIBECK_SPEED};
use crate::servo::error::ServoError;

/// Which terms friction has.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Friction {
    /// Viscous and Coulomb friction of each direction by itself.
    pub is_asymmetric: bool,
    /// A constant force (gravity on a slope, drift of the drive).
    pub has_offset: bool,
    /// Viscous friction alone.
    pub is_viscous: bool,
    /// Characteristic speed of the Stribeck term, m/s.
    pub stribeck_speed_m_s: Option<f64>,
    /// That this speed is fitted, and `F_s` where it is; 0 before the first fit.
    pub fitted_stribeck: Option<f64>,
    /// Coulomb friction in proportion to the load.
    pub is_of_load: bool,
    /// Knots of Coulomb friction over position, m, rising; empty for one number everywhere.
    pub knots_m: Vec<f64>,
}

/// One column of the regression.
#[derive(Debug, Clone, PartialEq)]
pub struct Regressor {
    /// Coefficient it belongs to.
    pub name: String,
    /// Unit of the coefficient.
    pub unit: Cow<'static, str>,
    /// A number per sample.
    pub values: Vec<f64>,
}

impl Friction {
    /// `F_v v + F_c sgn v + offset`.
    #[must_use]
    pub fn symmetric() -> Self {
        Self { has_offset: true, ..Self::default() }
    }

    /// `F_v± v + F_c± sgn v`.
    #[must_use]
    pub fn asymmetric() -> Self {
        Self { is_asymmetric: true, ..Self::default() }
    }

    /// Columns at every sample, from speed and position.
    ///
    /// # Errors
    ///
    /// [`ServoError::Setting`] for knots that do not rise or a speed that is not positive.
    pub fn regressors(
        &self,
        velocity_m_s: &[f64],
        position_m: &[f64],
        coordinate: Coordinate,
    ) -> Result<Vec<Regressor>, ServoError> {
        self.check()?;
        let names = coordinate.names();
        let (viscous, load) = (names.viscous, names.load);
        let sign: Vec<f64> = velocity_m_s.iter().map(|v| signum(*v)).collect();
        let mut out = Vec::new();
        let mut add = |name: String, unit: &'static str, values| {
            out.push(Regressor { name, unit: unit.into(), values });
        };
        if self.is_asymmetric {
            let of =
                |side: f64, x: &[f64]| x.iter().zip(&sign).map(|(x, s)| if *s == side { *x } else { 0.0 }).collect();
            add("F_v+".to_owned(), viscous, of(1.0, velocity_m_s));
            add("F_v-".to_owned(), viscous, of(-1.0, velocity_m_s));
            if self.knots_m.is_empty() {
                add("F_c+".to_owned(), load, of(1.0, &sign));
                add("F_c-".to_owned(), load, of(-1.0, &sign));
            }
        } else {
            add("F_v".to_owned(), viscous, velocity_m_s.to_vec());
            if self.knots_m.is_empty() && !self.is_viscous {
                add("F_c".to_owned(), load, sign.clone());
            }
        }
        for (k, &knot_m) in self.knots_m.iter().enumerate() {
            let hats = position_m.iter().map(|y| hat(&self.knots_m, k, *y));
            add(format!("F_c(y = {knot_m} m)"), load, hats.zip(&sign).map(|(h, s)| h * s).collect());
        }
        if let Some(speed_m_s) = self.stribeck_speed_m_s {
            let bump = |v: &f64| signum(*v) * (-(v / speed_m_s).powi(2)).exp();
            add("F_s".to_owned(), load, velocity_m_s.iter().map(bump).collect());
            if let Some(height) = self.fitted_stribeck.filter(|height| *height != 0.0) {
                // ∂/∂v_s of F_s sgn v exp(−(v/v_s)²).
                let slope = |v: &f64| height * bump(v) * 2.0 * v * v / speed_m_s.powi(3);
                add(STRIBECK_SPEED.to_owned(), names.speed[1], velocity_m_s.iter().map(slope).collect());
            }
        }
        if self.has_offset {
            add("offset".to_owned(), load, vec![1.0; sign.len()]);
        }
        Ok(out)
    }

    fn check(&self) -> Result<(), ServoError> {
        if let Some(pair) = self.knots_m.windows(2).find(|w| w[0].is_nan() || w[0] >= w[1]) {
            return Err(ServoError::Setting {
                what: "knot of friction over position (m)",
                found: pair[1],
                must: "knots rise",
            });
        }
        if self.knots_m.len() == 1 {
            let must = "two knots at least; one is friction without a map";
            return Err(ServoError::Setting { what: "number of knots", found: 1.0, must });
        }
        match self.stribeck_speed_m_s {
            Some(found) if !(found.is_finite() && found > 0.0) => {
                Err(ServoError::Setting { what: "Stribeck speed (m/s)", found, must: "it must be positive" })
            }
            _ => Ok(()),
        }
    }
}

/// −1, 0 or 1; a standing axis has no direction.
pub(crate) fn signum(v: f64) -> f64 {
    if v > 0.0 {
        1.0
    } else if v < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The piecewise linear function that is 1 at knot `k` and 0 at the others, constant beyond the ends.
fn hat(knots: &[f64], k: usize, y: f64) -> f64 {
    let (low, high) = (knots[0], knots[knots.len() - 1]);
    let y = y.max(low).min(high);
    if k > 0 && y < knots[k] {
        ((y - knots[k - 1]) / (knots[k] - knots[k - 1])).max(0.0)
    } else if k + 1 < knots.len() && y > knots[k] {
        ((knots[k + 1] - y) / (knots[k + 1] - knots[k])).max(0.0)
    } else if y == knots[k] {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_add_up_to_one_everywhere() {
        let knots = [0.0, 0.4, 1.0];
        for i in -10..30 {
            let y = 0.05 * f64::from(i);
            let sum: f64 = (0..3).map(|k| hat(&knots, k, y)).sum();
            assert!((sum - 1.0).abs() < 1e-15, "{y}: {sum}");
        }
    }

    #[test]
    fn the_columns_of_both_directions_add_up_to_the_symmetric_ones() {
        let v = [0.3, -0.2, 0.0, 1.0];
        let one = Friction::symmetric().regressors(&v, &v, Coordinate::Linear).unwrap();
        let two = Friction::asymmetric().regressors(&v, &v, Coordinate::Linear).unwrap();
        for i in 0..4 {
            assert_eq!(one[0].values[i], two[0].values[i] + two[1].values[i]);
            assert_eq!(one[1].values[i], two[2].values[i] + two[3].values[i]);
        }
    }
}
