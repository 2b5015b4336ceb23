//! Generalised minimal residuals for several right-hand sides at once, each in its own Krylov space, all in one multiplication.
//!
//! Source: Saad & Schultz 1986. The matrix ½ I − K needs neither preconditioner nor restarts: its condition is 2 to 3.

/// Columns worked on side by side.
pub(crate) const LANES: usize = 8;
/// One number a column.
pub(crate) type Lane = [f64; LANES];

/// How the iterations ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ended {
    pub(crate) iterations: usize,
    /// Largest residual over right-hand side.
    pub(crate) residual: f64,
}

fn dot(a: &[Lane], b: &[Lane]) -> Lane {
    let mut sum = [0.0; LANES];
    for (x, y) in a.iter().zip(b) {
        for l in 0..LANES {
            sum[l] += x[l] * y[l];
        }
    }
    sum
}

fn add_scaled(to: &mut [Lane], factor: &Lane, a: &[Lane]) {
    for (x, y) in to.iter_mut().zip(a) {
        for l in 0..LANES {
            x[l] += factor[l] * y[l];
        }
    }
}

/// Solves A x = b for each column; a column of zeros stays zero.
pub(crate) fn solve(
    apply: impl Fn(&[Lane]) -> Vec<Lane>,
    right: &[Lane],
    tolerance: f64,
    limit: usize,
) -> (Vec<Lane>, Ended) {
    let size = dot(right, right).map(f64::sqrt);
    let inverse = |x: &Lane| x.map(|x| if x > 0.0 { 1.0 / x } else { 0.0 });
    let scaled = |v: &[Lane], factor: &Lane| -> Vec<Lane> {
        v.iter().map(|x| core::array::from_fn(|l| x[l] * factor[l])).collect()
    };
    let mut basis = vec![scaled(right, &inverse(&size))];
    // Upper triangles after the rotations, a column an iteration; what the rotations leave of the right-hand side.
    let mut upper: Vec<Vec<Lane>> = Vec::new();
    let mut turns: Vec<[Lane; 2]> = Vec::new();
    let mut left = vec![size];
    let mut ended = Ended { iterations: 0, residual: 0.0 };
    while ended.iterations < limit {
        let mut w = apply(&basis[ended.iterations]);
        let mut h = vec![[0.0; LANES]; ended.iterations + 1];
        // Twice, so that the basis stays orthogonal to rounding.
        for _ in 0..2 {
            for (v, h) in basis.iter().zip(&mut h) {
                let along = dot(&w, v);
                add_scaled(&mut w, &along.map(|x| -x), v);
                (0..LANES).for_each(|l| h[l] += along[l]);
            }
        }
        let next = dot(&w, &w).map(f64::sqrt);
        for (k, [cos, sin]) in turns.iter().enumerate() {
            for l in 0..LANES {
                let (a, b) = (h[k][l], h[k + 1][l]);
                h[k][l] = cos[l] * a + sin[l] * b;
                h[k + 1][l] = cos[l] * b - sin[l] * a;
            }
        }
        let k = ended.iterations;
        let mut turn = [[1.0; LANES], [0.0; LANES]];
        let mut last = [0.0; LANES];
        for l in 0..LANES {
            let r = h[k][l].hypot(next[l]);
            if r > 0.0 {
                (turn[0][l], turn[1][l]) = (h[k][l] / r, next[l] / r);
            }
            h[k][l] = r;
            last[l] = -turn[1][l] * left[k][l];
            left[k][l] *= turn[0][l];
        }
        turns.push(turn);
        upper.push(h);
        left.push(last);
        ended.iterations += 1;
        ended.residual = (0..LANES).filter(|l| size[*l] > 0.0).map(|l| last[l].abs() / size[l]).fold(0.0, f64::max);
        if ended.residual <= tolerance {
            break;
        }
        basis.push(scaled(&w, &inverse(&next)));
    }
    // Back substitution.
    let n = ended.iterations;
    let mut y = vec![[0.0; LANES]; n];
    for k in (0..n).rev() {
        for l in 0..LANES {
            let known: f64 = (k + 1..n).map(|j| upper[j][k][l] * y[j][l]).sum();
            if upper[k][k][l] > 0.0 {
                y[k][l] = (left[k][l] - known) / upper[k][k][l];
            }
        }
    }
    let mut x = vec![[0.0; LANES]; right.len()];
    for (v, y) in basis.iter().zip(&y) {
        add_scaled(&mut x, y, v);
    }
    (x, ended)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_system_is_solved_and_a_column_of_zeros_stays() {
        let n = 12;
        let a = |i: usize, j: usize| {
            let off = 0.3 / (1.0 + (i as f64 - 1.7 * j as f64).abs());
            if i == j { 1.0 + off } else { off }
        };
        let apply = |x: &[Lane]| -> Vec<Lane> {
            (0..n).map(|i| core::array::from_fn(|l| (0..n).map(|j| a(i, j) * x[j][l]).sum())).collect()
        };
        let right: Vec<Lane> =
            (0..n).map(|i| core::array::from_fn(|l| if l == 3 { 0.0 } else { ((i * (l + 2)) as f64).sin() })).collect();
        let (x, ended) = solve(apply, &right, 1e-13, 50);
        assert!(ended.iterations <= n && ended.residual < 1e-13, "{ended:?}");
        for (found, expected) in apply(&x).iter().zip(&right) {
            assert!((0..LANES).all(|l| (found[l] - expected[l]).abs() < 1e-12));
        }
        assert!(x.iter().all(|x| x[3] == 0.0));
    }
}
