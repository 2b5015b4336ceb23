//! What is to be fitted: rows, components, weights and clusters.

use std::collections::BTreeMap;

use faer::Mat;

use crate::error::FitError;

/// Rows of a linear model `y = X β + e`.
///
/// Several response components (say the two forces of a towing test) are
/// stacked in one problem. Each has its own standard deviation σ; the variance
/// of row `i` is `σ² / weight[i]`, with σ that of its component.
#[derive(Debug, Clone)]
pub struct Problem {
    /// `X`, `n × p`: a row per observed component, a column per coefficient.
    pub design: Mat<f64>,
    /// `y`, length `n`.
    pub response: Vec<f64>,
    /// Relative 1/variance of each row, 0 to ignore the row; `None` if all are 1.
    pub weight: Option<Vec<f64>>,
    /// Component of each row, an index into `components`.
    pub component: Vec<usize>,
    /// Names of the components.
    pub components: Vec<String>,
    /// Cluster of each row: rows of one cluster may have correlated errors.
    pub cluster: Option<Vec<usize>>,
    /// Names of the coefficients, length `p`.
    pub names: Vec<String>,
}

impl Problem {
    /// A problem with one component named `y`, no weights and no clusters.
    #[must_use]
    pub fn single(design: Mat<f64>, response: Vec<f64>, names: Vec<String>) -> Self {
        let n = response.len();
        Self {
            design,
            response,
            weight: None,
            component: vec![0; n],
            components: vec!["y".to_owned()],
            cluster: None,
            names,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn n_rows(&self) -> usize {
        self.design.nrows()
    }

    /// Number of coefficients.
    #[must_use]
    pub fn n_coefficients(&self) -> usize {
        self.design.ncols()
    }

    /// The rows named, in the order given, as a problem of its own.
    ///
    /// Components that lose all their rows stay named; [`crate::fit`] refuses
    /// them, so take care to leave them some.
    #[must_use]
    pub fn rows(&self, rows: &[usize]) -> Self {
        Self {
            design: Mat::from_fn(rows.len(), self.design.ncols(), |i, j| self.design[(rows[i], j)]),
            response: rows.iter().map(|&i| self.response[i]).collect(),
            weight: self.weight.as_ref().map(|w| rows.iter().map(|&i| w[i]).collect()),
            component: rows.iter().map(|&i| self.component[i]).collect(),
            components: self.components.clone(),
            cluster: self.cluster.as_ref().map(|c| rows.iter().map(|&i| c[i]).collect()),
            names: self.names.clone(),
        }
    }

    /// Rows of a component that are observations: those of a weight above zero.
    #[must_use]
    pub fn rows_of(&self, component: usize) -> Vec<usize> {
        (0..self.n_rows()).filter(|&i| self.component[i] == component && self.weight_of(i) > 0.0).collect()
    }

    /// Weight of row `i`.
    pub(crate) fn weight_of(&self, i: usize) -> f64 {
        self.weight.as_ref().map_or(1.0, |w| w[i])
    }

    /// Checks sizes, numbers and names.
    ///
    /// # Errors
    ///
    /// The first thing found wrong.
    pub fn check(&self) -> Result<(), FitError> {
        let (n, p) = self.design.shape();
        if n == 0 {
            return Err(FitError::NoRows);
        }
        if p == 0 {
            return Err(FitError::no_coefficients());
        }
        let of_rows = "one per row of the design";
        size("response", self.response.len(), n, of_rows)?;
        size("component", self.component.len(), n, of_rows)?;
        size("names", self.names.len(), p, "one per column of the design")?;
        if let Some(weight) = &self.weight {
            size("weight", weight.len(), n, of_rows)?;
            for (row, &weight) in weight.iter().enumerate() {
                if !(weight.is_finite() && weight >= 0.0) {
                    return Err(FitError::Refused(format!(
                        "weight of row {row} is {weight}; a weight is a relative 1/variance, finite and not negative (0 ignores the row)"
                    )));
                }
            }
        }
        if let Some(cluster) = &self.cluster {
            size("cluster", cluster.len(), n, of_rows)?;
        }
        unique(&self.names)?;
        for row in 0..n {
            for j in 0..p {
                let value = self.design[(row, j)];
                if !value.is_finite() {
                    return Err(FitError::design_not_finite(row, &self.names[j], value));
                }
            }
            if !self.response[row].is_finite() {
                return Err(FitError::response_not_finite(row, self.response[row]));
            }
        }
        let count = self.components.len();
        let mut has_rows = vec![false; count];
        for (row, &component) in self.component.iter().enumerate() {
            match has_rows.get_mut(component) {
                Some(flag) => *flag |= self.weight_of(row) > 0.0,
                None => {
                    let problem = format!("row {row} belongs to component {component}, but only {count} are named");
                    return Err(FitError::Refused(problem));
                }
            }
        }
        if let Some(empty) = has_rows.iter().position(|&has| !has) {
            let name = &self.components[empty];
            let problem = format!("component {name:?} has no rows; leave it out or add its observations");
            return Err(FitError::Refused(problem));
        }
        Ok(())
    }
}

pub(crate) fn size(what: &str, found: usize, expected: usize, of: &str) -> Result<(), FitError> {
    if found == expected {
        return Ok(());
    }
    Err(FitError::Refused(format!("{what} has {found} entries where {expected} are needed ({of})")))
}

/// Refuses a name that two coefficients have.
pub(crate) fn unique(names: &[String]) -> Result<(), FitError> {
    let mut seen = BTreeMap::new();
    for (second, name) in names.iter().enumerate() {
        if let Some(first) = seen.insert(name, second) {
            let problem = format!("coefficient {name:?} is named twice (columns {first} and {second}); rename one");
            return Err(FitError::Refused(problem));
        }
    }
    Ok(())
}
