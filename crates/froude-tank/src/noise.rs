//! What noise of an exponential correlation does to sums over its samples: the forecast of every plan.

/// Σ_j keep^|i−j| x_j, by one pass forward and one backward.
#[must_use]
pub(crate) fn correlated(x: &[f64], keep: f64) -> Vec<f64> {
    let mut out = Vec::with_capacity(x.len());
    let mut sum = 0.0;
    for value in x {
        sum = sum * keep + value;
        out.push(sum);
    }
    sum = 0.0;
    for (value, out) in x.iter().zip(&mut out).rev() {
        *out += sum;
        sum = (sum + value) * keep;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_passes_are_the_sum_over_all_samples() {
        let x: Vec<f64> = (0..40).map(|i| f64::from(i * i % 13) - 6.0).collect();
        let keep = 0.7_f64;
        for (i, fast) in correlated(&x, keep).into_iter().enumerate() {
            let slow: f64 = x.iter().enumerate().map(|(j, x)| keep.powi((i as i32 - j as i32).abs()) * x).sum();
            // Forty terms of some ten, each rounded.
            assert!((fast - slow).abs() < 1e-12, "{i}");
        }
    }
}
