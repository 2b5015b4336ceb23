//! Householder QR as the textbook has it: slow, plain, and what the fast path is
//! tested against.

/// Replaces a row-major `rows × columns` matrix by its upper triangle `R`.
///
/// Entries below the diagonal become zero; `RᵀR` equals `AᵀA` up to rounding.
///
/// # Source
///
/// Golub & Van Loan (2013), *Matrix Computations*, 4th ed., algorithm 5.2.1.
pub fn triangularise(matrix: &mut [f64], rows: usize, columns: usize) {
    for k in 0..columns.min(rows) {
        let norm = (k..rows).map(|i| matrix[i * columns + k].powi(2)).sum::<f64>().sqrt();
        if norm == 0.0 {
            continue;
        }
        let alpha = matrix[k * columns + k];
        let beta = -norm.copysign(alpha);
        let mut v: Vec<f64> = (k..rows).map(|i| matrix[i * columns + k]).collect();
        v[0] = alpha - beta;
        let scale = 2.0 / v.iter().map(|v| v * v).sum::<f64>();
        for j in k + 1..columns {
            let dot: f64 = (k..rows).map(|i| v[i - k] * matrix[i * columns + j]).sum();
            for i in k..rows {
                matrix[i * columns + j] -= scale * dot * v[i - k];
            }
        }
        matrix[k * columns + k] = beta;
        for i in k + 1..rows {
            matrix[i * columns + k] = 0.0;
        }
    }
}

/// Least squares of a row-major `rows × (p + 1)` matrix `[A | b]`, which is used up.
///
/// `A` must have full column rank.
#[must_use]
pub fn least_squares(matrix: &mut [f64], rows: usize, p: usize) -> Vec<f64> {
    let columns = p + 1;
    triangularise(matrix, rows, columns);
    let mut beta = vec![0.0; p];
    for i in (0..p).rev() {
        let right: f64 = (i + 1..p).map(|j| matrix[i * columns + j] * beta[j]).sum();
        beta[i] = (matrix[i * columns + p] - right) / matrix[i * columns + i];
    }
    beta
}
