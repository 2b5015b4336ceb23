//! The little statistics that drawing needs: normal quantiles and a mean.

/// Quantile of the standard normal distribution.
///
/// `p` outside the open interval 0..1 gives an infinity. Relative error below
/// 1.2e-9, far finer than a drawn point.
///
/// # Source
///
/// P. J. Acklam, "An algorithm for computing the inverse normal cumulative
/// distribution function" (2003): rational approximations in three regions.
pub(crate) fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969683028665376e1,
        2.209460984245205e2,
        -2.759285104469687e2,
        1.38357751867269e2,
        -3.066479806614716e1,
        2.506628277459239,
    ];
    const B: [f64; 5] =
        [-5.447609879822406e1, 1.615858368580409e2, -1.556989798598866e2, 6.680131188771972e1, -1.328068155288572e1];
    const C: [f64; 6] = [
        -7.784894002430293e-3,
        -3.223964580411365e-1,
        -2.400758277161838,
        -2.549732539343734,
        4.374664141464968,
        2.938163982698783,
    ];
    const D: [f64; 4] = [7.784695709041462e-3, 3.224671290700398e-1, 2.445134137142996, 3.754408661907416];
    const LOW: f64 = 0.02425;
    let horner = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, a| sum * x + a);
    let tail = |p: f64| {
        let q = (-2.0 * p.ln()).sqrt();
        horner(&C, q) / (horner(&D, q) * q + 1.0)
    };
    if p <= 0.0 {
        f64::NEG_INFINITY
    } else if p >= 1.0 {
        f64::INFINITY
    } else if p < LOW {
        tail(p)
    } else if p > 1.0 - LOW {
        -tail(1.0 - p)
    } else {
        let q = p - 0.5;
        let r = q * q;
        horner(&A, r) * q / (horner(&B, r) * r + 1.0)
    }
}

/// Mean and standard deviation (n − 1) of the finite numbers; zeros when there are too few.
pub(crate) fn mean_and_deviation(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for x in numbers.filter(|x| x.is_finite()) {
        n += 1.0;
        let step = x - mean;
        mean += step / n;
        squares += step * (x - mean);
    }
    if n < 2.0 { (mean, 0.0) } else { (mean, (squares / (n - 1.0)).sqrt()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tabulated quantiles of the standard normal distribution.
    #[test]
    fn quantiles_agree_with_the_tables() {
        for (p, z) in [(0.5, 0.0), (0.975, 1.959963985), (0.995, 2.575829304), (0.001, -3.090232306)] {
            assert!((normal_quantile(p) - z).abs() < 1e-8, "{p}: {}", normal_quantile(p));
        }
    }

    #[test]
    fn mean_and_deviation_of_a_handful() {
        let (mean, deviation) = mean_and_deviation([1.0, 2.0, 3.0, f64::NAN].into_iter());
        assert_eq!((mean, deviation), (2.0, 1.0));
    }
}
