//! The inverse of a normal matrix.

use froude_fit::faer::linalg::solvers::Solve;
use froude_fit::faer::{Mat, Side};

/// The inverse of a symmetric positive matrix, its diagonal scaled to one first; `None` where it has none.
pub(crate) fn inverted(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    let p = matrix.nrows();
    let scale: Vec<f64> = (0..p).map(|i| matrix[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let scaled = Mat::from_fn(p, p, |i, j| matrix[(i, j)] / (scale[i] * scale[j]));
    let least = scaled.self_adjoint_eigenvalues(Side::Lower).ok()?.first().copied()?;
    if least < 1e-12 {
        return None;
    }
    let inverse = scaled.llt(Side::Lower).ok()?.solve(Mat::<f64>::identity(p, p));
    Some(Mat::from_fn(p, p, |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}
