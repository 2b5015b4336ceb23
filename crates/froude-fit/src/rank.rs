//! Column-pivoted Householder QR, and what it says about rank.
//!
//! Columns are scaled to unit length before they come here, so that the
//! unit of a coefficient does not decide whether it is determined.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_left_in_place_scratch as apply_scratch,
    apply_block_householder_sequence_on_the_left_in_place_with_conj as apply,
};
use faer::linalg::qr::{col_pivoting::factor, no_pivoting::factor::recommended_block_size};
use faer::{Conj, Mat, MatRef, Par};

use crate::dense::{mul_vec, tr_mul_vec};

/// A column is dependent when its pivot falls below this part of the largest.
///
/// Forming a regressor costs a few units of the last place (2·10⁻¹⁶), and the
/// factorisation up to √n times as much; 10⁻¹² leaves a factor of a hundred
/// above that for 10⁴ rows, and still calls the tenth-degree polynomial of
/// NIST's Filip data (pivot ratio near 10⁻¹⁰) determined.
pub const RANK_TOLERANCE: f64 = 1e-12;

/// `A Π = Q R`, cut at the numerical rank.
#[derive(Debug, Clone)]
pub(crate) struct PivotedQr {
    /// Orthonormal columns, `m × rank` (or `m × m` when the full factor was asked).
    pub q: Mat<f64>,
    /// Upper trapezoidal, `rank × n`, in permuted order.
    pub r: Mat<f64>,
    /// Permuted position → column.
    pub order: Vec<usize>,
    /// Numerical rank.
    pub rank: usize,
    a: Mat<f64>,
}

impl PivotedQr {
    pub(crate) fn new(a: MatRef<'_, f64>) -> Self {
        Self::factor(a, false)
    }

    /// As [`Self::new`], with the square orthogonal factor.
    pub(crate) fn with_full_q(a: MatRef<'_, f64>) -> Self {
        Self::factor(a, true)
    }

    fn factor(a: MatRef<'_, f64>, is_full: bool) -> Self {
        let (m, n) = a.shape();
        let size = m.min(n);
        let mut packed = a.to_owned();
        if size == 0 {
            return Self {
                q: Mat::identity(m, if is_full { m } else { 0 }),
                r: Mat::zeros(0, n),
                order: (0..n).collect(),
                rank: 0,
                a: packed,
            };
        }
        let mut order = vec![0_usize; n];
        let mut inverse = vec![0_usize; n];
        let block = recommended_block_size::<f64>(m, n);
        let mut coefficients = Mat::zeros(block, size);
        let scratch = factor::qr_in_place_scratch::<usize, f64>(m, n, block, Par::Seq, faer::prelude::default());
        factor::qr_in_place(
            packed.as_mut(),
            coefficients.as_mut(),
            &mut order,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            faer::prelude::default(),
        );
        let largest = packed[(0, 0)].abs();
        let rank = (0..size).take_while(|&k| largest > 0.0 && packed[(k, k)].abs() > RANK_TOLERANCE * largest).count();
        let columns = if is_full { m } else { size };
        let mut q = Mat::identity(m, columns);
        apply(
            packed.get(.., ..size),
            coefficients.as_ref(),
            Conj::No,
            q.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(apply_scratch::<f64>(m, block, columns))),
        );
        if !is_full {
            q.truncate(m, rank);
        }
        let r = Mat::from_fn(rank, n, |i, j| if j >= i { packed[(i, j)] } else { 0.0 });
        Self { q, r, order, rank, a: a.to_owned() }
    }

    /// Number of columns of `A`.
    pub(crate) fn n_columns(&self) -> usize {
        self.order.len()
    }

    /// The solution of `min ‖A x − b‖` whose dependent columns stay at zero.
    ///
    /// One step of refinement on the residual follows the first solve.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = self.solve_once(b);
        let mut residual = b.to_vec();
        for (r, fitted) in residual.iter_mut().zip(mul_vec(self.a.as_ref(), &x)) {
            *r -= fitted;
        }
        for (x, dx) in x.iter_mut().zip(self.solve_once(&residual)) {
            *x += dx;
        }
        x
    }

    fn solve_once(&self, b: &[f64]) -> Vec<f64> {
        let mut y = tr_mul_vec(self.q.get(.., ..self.rank), b);
        self.back_substitute(&mut y);
        let mut x = vec![0.0; self.n_columns()];
        for (k, &value) in y.iter().enumerate() {
            x[self.order[k]] = value;
        }
        x
    }

    /// `R₁₁⁻¹ y`, in place.
    pub(crate) fn back_substitute(&self, y: &mut [f64]) {
        for i in (0..self.rank).rev() {
            let mut sum = y[i];
            for k in i + 1..self.rank {
                sum -= self.r[(i, k)] * y[k];
            }
            y[i] = sum / self.r[(i, i)];
        }
    }

    /// `R₁₁⁻ᵀ y`, in place.
    pub(crate) fn forward_substitute(&self, y: &mut [f64]) {
        for i in 0..self.rank {
            let mut sum = y[i];
            for k in 0..i {
                sum -= self.r[(k, i)] * y[k];
            }
            y[i] = sum / self.r[(i, i)];
        }
    }

    /// `Π (R₁₁⁻¹; 0)`, `n × rank`: from the coordinates `Qᵀ b` to the solution.
    pub(crate) fn lift(&self) -> Mat<f64> {
        let mut out = Mat::zeros(self.n_columns(), self.rank);
        for j in 0..self.rank {
            let mut column = vec![0.0; self.rank];
            column[j] = 1.0;
            self.back_substitute(&mut column);
            for (k, &value) in column.iter().enumerate() {
                out[(self.order[k], j)] = value;
            }
        }
        out
    }

    /// Basis of the null space of `A`, `n × (n − rank)`; not orthonormal.
    pub(crate) fn null_space(&self) -> Mat<f64> {
        let n = self.n_columns();
        let mut out = Mat::zeros(n, n - self.rank);
        for j in self.rank..n {
            let mut column: Vec<f64> = (0..self.rank).map(|i| -self.r[(i, j)]).collect();
            self.back_substitute(&mut column);
            for (k, &value) in column.iter().enumerate() {
                out[(self.order[k], j - self.rank)] = value;
            }
            out[(self.order[j], j - self.rank)] = 1.0;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dense::mul;

    #[test]
    fn the_factors_give_the_matrix_back() {
        let a = Mat::from_fn(7, 4, |i, j| ((i * 3 + j * 5) % 7) as f64 + 0.1 * j as f64);
        let qr = PivotedQr::new(a.as_ref());
        let product = mul(qr.q.as_ref(), qr.r.as_ref());
        for i in 0..7 {
            for (k, &j) in qr.order.iter().enumerate() {
                assert!((product[(i, k)] - a[(i, j)]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn a_repeated_column_lowers_the_rank_and_spans_the_null_space() {
        let a = Mat::from_fn(6, 3, |i, j| match j {
            0 => i as f64,
            1 => 1.0,
            _ => 2.0 * i as f64 - 3.0,
        });
        let qr = PivotedQr::new(a.as_ref());
        assert_eq!(qr.rank, 2);
        let null = qr.null_space();
        let zero = mul(a.as_ref(), null.as_ref());
        assert!((0..6).all(|i| zero[(i, 0)].abs() < 1e-13));
    }

    #[test]
    fn the_full_factor_is_square_and_orthogonal() {
        let a = Mat::from_fn(5, 2, |i, j| (i + j * j) as f64 + 1.0);
        let qr = PivotedQr::with_full_q(a.as_ref());
        let gram = mul(qr.q.transpose(), qr.q.as_ref());
        for i in 0..5 {
            for j in 0..5 {
                let expected = f64::from(u8::from(i == j));
                assert!((gram[(i, j)] - expected).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_matrix_without_columns_has_rank_zero() {
        let qr = PivotedQr::new(Mat::zeros(3, 0).as_ref());
        assert_eq!((qr.rank, qr.solve(&[1.0, 2.0, 3.0]).len()), (0, 0));
    }
}
