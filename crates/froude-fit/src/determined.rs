//! What a rank-deficient design still determines.
//!
//! With null vectors `N` of the design (after priors), a
//! coefficient is determined when its row of `N` vanishes, and a combination
//! `a · β` when `aᵀ N = 0`. Restricted to the undetermined coefficients, those
//! combinations are given in reduced echelon form: each holds one coefficient
//! that no other combination holds, and no combination could do with fewer of
//! its coefficients.

use faer::{Mat, MatRef};

use crate::dense::norm;
use crate::rank::PivotedQr;

/// A scaled coefficient with a smaller part in every unit null vector is determined.
const PART_TOLERANCE: f64 = 1e-8;

/// Null space of a scaled design.
#[derive(Debug, Clone)]
pub(crate) struct Indeterminacy {
    /// Orthonormal null vectors, `p × k`, in scaled units.
    pub null: Mat<f64>,
    /// Which coefficients are determined.
    pub determined: Vec<bool>,
}

impl Indeterminacy {
    /// From null vectors in scaled units, not necessarily orthonormal.
    pub(crate) fn new(null: MatRef<'_, f64>) -> Self {
        let null = PivotedQr::new(null).q;
        let determined =
            (0..null.nrows()).map(|j| norm(&crate::dense::row(null.as_ref(), j)) < PART_TOLERANCE).collect();
        Self { null, determined }
    }

    /// The determined combinations as `(coefficient, factor)` in scaled units.
    pub(crate) fn combinations(&self) -> Vec<Vec<(usize, f64)>> {
        let open: Vec<usize> = (0..self.determined.len()).filter(|&j| !self.determined[j]).collect();
        let k = self.null.ncols();
        if open.len() <= k {
            return Vec::new();
        }
        // Columns of the transposed null space, one per open coefficient: the
        // first k pivots can be chosen at will, the others follow from them.
        let transposed = Mat::from_fn(k, open.len(), |i, j| self.null[(open[j], i)]);
        let order = PivotedQr::new(transposed.as_ref()).order;
        let (chosen, follow) = order.split_at(k);
        let square = Mat::from_fn(k, k, |i, j| transposed[(i, chosen[j])]);
        let square = PivotedQr::new(square.as_ref());
        let mut out: Vec<Vec<(usize, f64)>> = follow
            .iter()
            .map(|&f| {
                let own: Vec<f64> = (0..k).map(|i| transposed[(i, f)]).collect();
                let share = square.solve(&own);
                let mut terms = vec![(open[f], 1.0)];
                for (&c, share) in chosen.iter().zip(share) {
                    if share.abs() > PART_TOLERANCE {
                        terms.push((open[c], -share));
                    }
                }
                terms.sort_by_key(|&(j, _)| j);
                terms
            })
            .collect();
        out.sort_by_key(|terms| terms.iter().map(|&(j, _)| j).collect::<Vec<_>>());
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_columns_determine_their_sum() {
        // β₀ and β₂ parallel: null vector (1, 0, −1)/√2.
        let null = Mat::from_fn(3, 1, |j, _| [1.0, 0.0, -1.0][j]);
        let found = Indeterminacy::new(null.as_ref());
        assert_eq!(found.determined, [false, true, false]);
        let combinations = found.combinations();
        assert_eq!(combinations.len(), 1);
        let terms = &combinations[0];
        assert_eq!((terms[0].0, terms[1].0), (0, 2));
        assert!((terms[1].1 / terms[0].1 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn two_mixed_null_vectors_still_give_the_two_sums() {
        // Pairs (0, 2) and (1, 3), null vectors mixed.
        let null = Mat::from_fn(4, 2, |j, k| {
            let a = [1.0, 0.0, -1.0, 0.0][j];
            let b = [0.0, 1.0, 0.0, -1.0][j];
            if k == 0 { a + 2.0 * b } else { 3.0 * a - b }
        });
        let combinations = Indeterminacy::new(null.as_ref()).combinations();
        let members: Vec<Vec<usize>> = combinations.iter().map(|terms| terms.iter().map(|t| t.0).collect()).collect();
        assert_eq!(members, [vec![0, 2], vec![1, 3]]);
    }

    #[test]
    fn a_column_of_zeros_is_in_no_combination() {
        let null = Mat::from_fn(2, 1, |j, _| [0.0, 1.0][j]);
        let found = Indeterminacy::new(null.as_ref());
        assert_eq!(found.determined, [true, false]);
        assert!(found.combinations().is_empty());
    }
}
