//! Layers from a wall outwards, each thicker than the one before by the same ratio.

use crate::mesh_error::MeshError;

/// Growths that solvers like: beyond, neighbours differ too much.
const MAX_GROWTH: f64 = 2.0;

/// Layers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layers {
    /// How many.
    pub count: usize,
    /// Each over the one before \[-\].
    pub growth: f64,
    /// All of them, m.
    pub length_m: f64,
}

impl Layers {
    /// From the thickness of the first, by solving `first = length (g − 1)/(gⁿ − 1)` for the growth.
    ///
    /// # Errors
    ///
    /// [`MeshError::Refused`]: a first layer that is not above 0 or is thicker than equal layers, or a growth above 2.
    pub fn of_first(count: usize, first_m: f64, length_m: f64) -> Result<Self, MeshError> {
        let equal_m = length_m / count as f64;
        let thinnest_m = Self { count, growth: MAX_GROWTH, length_m }.first_m();
        if !(thinnest_m..=equal_m).contains(&first_m) {
            let expected = format!(
                "from {thinnest_m:.3e} m (each of {count} layers twice the one before) to {equal_m:.3e} m (all equal)"
            );
            return Err(MeshError::number("the thickness of the first layer", first_m, expected));
        }
        // The first layer falls with the growth: halving 60 times is exact to the last bit.
        let (mut low, mut high) = (1.0, MAX_GROWTH);
        for _ in 0..60 {
            let growth = 0.5 * (low + high);
            if (Self { count, growth, length_m }).first_m() > first_m {
                low = growth;
            } else {
                high = growth;
            }
        }
        Ok(Self { count, growth: 0.5 * (low + high), length_m })
    }

    /// Thickness of the first, m.
    #[must_use]
    pub fn first_m(&self) -> f64 {
        self.length_m * self.part(1)
    }

    /// Part of the length that the first `layers` take \[-\].
    #[must_use]
    pub fn part(&self, layers: usize) -> f64 {
        // (gʲ − 1)/(gⁿ − 1), with its limit j/n as g goes to 1.
        let log = self.growth.ln();
        let part = if log * self.count as f64 > 1e-9 {
            (log * layers as f64).exp_m1() / (log * self.count as f64).exp_m1()
        } else {
            layers as f64 / self.count as f64
        };
        if layers == self.count { 1.0 } else { part }
    }

    /// Their thickness, m.
    #[must_use]
    pub fn distance_m(&self, layers: usize) -> f64 {
        self.length_m * self.part(layers)
    }

    /// The same length in another number of layers, similar: the last is as many times the first, to the power of how many more there are.
    #[must_use]
    pub fn in_layers(&self, count: usize) -> Self {
        let growth = (self.growth.ln() * self.count as f64 / count as f64).exp();
        Self { count, growth, length_m: self.length_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.12 mm (1.3³⁵ − 1)/0.3 = 3.8915 m.
    #[test]
    fn the_growth_follows_from_the_first_layer() {
        let length_m = 0.12e-3 * (1.3_f64.powi(35) - 1.0) / 0.3;
        let layers = Layers::of_first(35, 0.12e-3, length_m).unwrap();
        assert!((layers.growth - 1.3).abs() < 1e-13);
        let [a, b, c] = [1, 2, 3].map(|j| layers.distance_m(j));
        assert!((a - 0.12e-3).abs() < 1e-16 && ((c - b) / (b - a) - 1.3).abs() < 1e-9);
        assert!((layers.in_layers(70).growth - 1.3_f64.sqrt()).abs() < 1e-13);
        let even = Layers::of_first(4, 0.25, 1.0).unwrap();
        assert!((even.distance_m(3) - 0.75).abs() < 1e-9);
    }

    #[test]
    fn a_first_layer_that_no_growth_has_is_refused() {
        for first_m in [0.0, -1.0, f64::NAN, 0.3, 0.06] {
            assert!(
                Layers::of_first(4, first_m, 1.0)
                    .unwrap_err()
                    .to_string()
                    .starts_with("the thickness of the first layer is")
            );
        }
    }
}
