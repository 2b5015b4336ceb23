//! Matrix exponential: the exact step of a linear system whose inputs stand still within it.
//!
//! With `ẋ = A x + B u` the matrix `[A B; 0 0]·h` has `[Φ Γ; 0 I]` for its exponential, `x(t + h) = Φ x(t) + Γ u`.

/// A square matrix, by rows.
pub type Square<const N: usize> = [[f64; N]; N];

/// `e^A` by halving until the norm is below 1/2, Taylor's series to 1/18! and squaring back.
///
/// Each squaring doubles the rounding: some 2ˢ·ε for a norm of 2ˢ/2. A norm beyond 2²⁹ gives what thirty halvings leave of it.
///
/// # Source
///
/// Golub & Van Loan (2013), *Matrix Computations*, 9.3.
///
/// # Example
///
/// A mass on a spring of 1 N/m and 1 kg, half a period on, is where it was with the other sign:
///
/// ```
/// let step_s = std::f64::consts::PI;
/// let over = froude_signal::exponential::exponential([[0.0, step_s], [-step_s, 0.0]]);
/// assert!((over[0][0] + 1.0).abs() < 1e-14 && over[0][1].abs() < 1e-14);
/// ```
#[must_use]
pub fn exponential<const N: usize>(a: Square<N>) -> Square<N> {
    let norm = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let mut halvings = 0;
    while norm / f64::from(1_u32 << halvings) > 0.5 && halvings < 30 {
        halvings += 1;
    }
    let scale = 1.0 / f64::from(1_u32 << halvings);
    let a = a.map(|row| row.map(|x| x * scale));
    let mut sum = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for order in (1..=18).rev() {
        sum = product(&a, &sum).map(|row| row.map(|x| x / f64::from(order)));
        for (i, row) in sum.iter_mut().enumerate() {
            row[i] += 1.0;
        }
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    sum
}

fn product<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_and_an_integrator_are_exact_at_any_step() {
        for step_s in [1e-6_f64, 0.1, 3.0, 40.0] {
            // ẋ = −2x + u, u standing still.
            let over = exponential([[-2.0 * step_s, step_s], [0.0, 0.0]]);
            let decay = (-2.0 * step_s).exp();
            // Each squaring doubles the rounding of its two products: ‖A‖ = 120 halved eight times.
            let rounding = 512.0 * f64::EPSILON;
            assert!(
                (over[0][0] - decay).abs() < rounding && (over[0][1] - 0.5 * (1.0 - decay)).abs() < rounding,
                "{step_s}"
            );
            assert_eq!(over[1], [0.0, 1.0]);
        }
    }

    #[test]
    fn what_is_no_number_stays_one_and_nothing_panics() {
        assert!(exponential([[f64::NAN]])[0][0].is_nan());
        assert!(!exponential([[1e300]])[0][0].is_finite());
        assert_eq!(exponential([[0.0; 3]; 3]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
}
