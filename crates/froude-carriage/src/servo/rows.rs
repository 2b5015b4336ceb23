//! Rows of a regression.

use std::borrow::Cow;

/// Rows of the regression `force = Σ column · coefficient`.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Rate after decimation, Hz.
    pub rate_hz: f64,
    /// Time of each row, s.
    pub time_s: Vec<f64>,
    /// Force, N.
    pub force_n: Vec<f64>,
    /// Name and unit of each coefficient.
    pub names: Vec<(String, Cow<'static, str>)>,
    /// A column per coefficient.
    pub columns: Vec<Vec<f64>>,
}

impl Rows {
    /// Rows of another record of the same model behind these; intervals then treat the seam as any other place.
    pub fn append(&mut self, mut other: Self) {
        self.time_s.append(&mut other.time_s);
        self.force_n.append(&mut other.force_n);
        self.columns.iter_mut().zip(&mut other.columns).for_each(|(all, more)| all.append(more));
    }

    /// The rows whose time lies in one of the spans, s.
    #[must_use]
    pub fn within(&self, spans_s: &[[f64; 2]]) -> Self {
        let is_in = |t: f64| spans_s.iter().any(|[from, to]| (*from..*to).contains(&t));
        let keep: Vec<usize> = (0..self.time_s.len()).filter(|&i| is_in(self.time_s[i])).collect();
        self.chosen(&keep)
    }

    /// Some of the rows.
    pub(crate) fn chosen(&self, keep: &[usize]) -> Self {
        let of = |column: &[f64]| keep.iter().map(|&i| column[i]).collect::<Vec<f64>>();
        Self {
            rate_hz: self.rate_hz,
            time_s: of(&self.time_s),
            force_n: of(&self.force_n),
            names: self.names.clone(),
            columns: self.columns.iter().map(|c| of(c)).collect(),
        }
    }

    /// `force − Σ column · coefficient`, N.
    #[must_use]
    pub fn residuals_n(&self, coefficients: &[f64]) -> Vec<f64> {
        let mut out = self.force_n.clone();
        for (column, c) in self.columns.iter().zip(coefficients) {
            for (r, x) in out.iter_mut().zip(column) {
                *r -= c * x;
            }
        }
        out
    }

    /// `‖force − model‖/‖force‖`.
    #[must_use]
    pub fn relative_error(&self, coefficients: &[f64]) -> f64 {
        norm(&self.residuals_n(coefficients)) / norm(&self.force_n)
    }
}

pub(crate) fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
