//! A number as its record states it.

use froude_records::comparison::Side;

use crate::uncertainty::coverage_factor;

/// A number as one estimate states it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stated {
    pub value: Option<f64>,
    /// Standard uncertainty, in the unit of the value; `None` where none is stated.
    pub standard: Option<f64>,
    /// Effective degrees of freedom of it; `None` where the record states no finite ones.
    pub dof: Option<f64>,
    /// Whether the record gives no interval, as one cluster decides the number.
    pub is_refused: bool,
    /// Largest distance by which the envelope of the laws that are not contradicted exceeds the interval.
    pub beyond: f64,
}

impl Stated {
    /// As a side of a comparison: with the coverage factor k of the 95 % uncertainty U = k·u, and what other laws add to it.
    pub(super) fn of(self, source: &str) -> Side {
        let coverage_factor =
            self.standard.filter(|_| !self.is_refused).map(|_| self.dof.map_or(NORMAL_COVERAGE, coverage_factor));
        Side {
            source: source.to_owned(),
            value: self.value,
            standard_uncertainty: self.standard,
            effective_dof: self.dof,
            coverage_factor,
            expanded_uncertainty: coverage_factor.zip(self.standard).map(|(k, u)| k * u + self.beyond),
        }
    }
}

/// Coverage factor where no degrees of freedom are stated: two-sided 95 % of the normal distribution.
pub(super) const NORMAL_COVERAGE: f64 = 1.959_963_984_540_054;
