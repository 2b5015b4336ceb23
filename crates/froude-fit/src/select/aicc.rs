//! Akaike's information criterion, corrected for small samples.

/// Too few rows for the corrected criterion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "AICc of {parameters} parameters (σ counted) needs more than {} rows, and there are {n}",
    parameters + 1.0
)]
pub struct TooFewRows {
    /// The rows.
    pub n: usize,
    /// The parameters, σ counted.
    pub parameters: f64,
}

/// `n ln(RSS/n) + 2K + 2K(K+1)/(n − K − 1)`, `K` = coefficients + 1 for σ.
///
/// Comparable only between models of the same rows and weights. Additive
/// constants of the likelihood are left out.
///
/// # Errors
///
/// [`TooFewRows`] when `n ≤ K + 1`: the correction has no meaning there.
///
/// # Source
///
/// Hurvich & Tsai (1989), Biometrika 76.
///
/// # Example
///
/// ```
/// // Ten rows, two coefficients: K = 3, correction 24/6.
/// let value = froude_fit::select::aicc(10, 10.0, 2.0)?;
/// assert!((value - 10.0).abs() < 1e-12);
/// # Ok::<(), froude_fit::select::TooFewRows>(())
/// ```
pub fn aicc(n: usize, rss: f64, n_coefficients: f64) -> Result<f64, TooFewRows> {
    let k = n_coefficients + 1.0;
    let count = n as f64;
    let rest = count - k - 1.0;
    if rest <= 0.0 {
        return Err(TooFewRows { n, parameters: k });
    }
    Ok(count * (rss / count).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_rows_are_refused_in_words() {
        assert_eq!(
            aicc(4, 1.0, 2.0).unwrap_err().to_string(),
            "AICc of 3 parameters (σ counted) needs more than 4 rows, and there are 4"
        );
        assert!(aicc(5, 1.0, 2.0).is_ok());
    }
}
