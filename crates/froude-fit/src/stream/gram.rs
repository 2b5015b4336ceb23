//! Inner products of the columns of a block: half the work of a factorisation.
//!
//! A Cholesky factor of these products is as good as a QR factor only where the
//! columns are far from parallel, so [`triangle`] measures that, on the very rows
//! that it is about to replace, and gives up otherwise. Responses enter as
//! residuals of a pilot fit: what rounding there is then touches the correction
//! to the pilot, not the coefficients themselves.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use super::kernel::{Ahead, tile};
use froude_lanes::{Kernel, Lane, Level, Vectors};

/// Columns in a panel, P: the registers hold all P² products of two panels, the columns of one and a column of the other.
const fn panel<V: Vectors>() -> usize {
    if V::REGISTERS >= 32 { 5 } else { 3 }
}

/// Largest variance inflation factor at which products stand in for a QR factor.
///
/// A relative error of `ε` in the products becomes at most about `ε` times this in
/// the correction to the pilot's coefficients: three digits of sixteen.
pub(crate) const LARGEST_INFLATION: f64 = 1e3;

/// Index of the pair `(i, j)`, `j ≤ i`, among the sums.
fn pair(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Number of pairs of `width` columns.
pub(crate) fn pairs(width: usize) -> usize {
    pair(width, 0)
}

/// Adds the products of all columns of a block to `sums`.
///
/// First each response (the columns after `pilot.len() / responses` regressors)
/// loses the pilot's fit: `pilot[r·p + j]` is coefficient `j` of response `r`.
pub(crate) fn add_products(
    level: Level,
    sums: &mut [Lane],
    block: &mut [Lane],
    regressors: usize,
    pilot: &[f64],
    width: usize,
    ahead: Ahead<'_>,
) {
    level.run(AddProducts { sums, block, regressors, pilot, width, ahead });
}

struct AddProducts<'a> {
    sums: &'a mut [Lane],
    block: &'a mut [Lane],
    regressors: usize,
    pilot: &'a [f64],
    width: usize,
    ahead: Ahead<'a>,
}

impl Kernel for AddProducts<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let mut ahead = self.ahead;
        for (r, pilot) in self.pilot.chunks_exact(self.regressors.max(1)).enumerate() {
            for (k, betas) in pilot.chunks(tile::<V>()).enumerate() {
                let place = [k * tile::<V>(), self.regressors + r];
                macro_rules! tile {
                    ($($m:literal)*) => {
                        match betas.len() {
                            $($m if $m <= tile::<V>() => subtract_fit::<V, $m>(
                                vectors, self.block, self.width, place, betas, &mut ahead,
                            ),)*
                            _ => {}
                        }
                    };
                }
                tile!(1 2 3 4 5 6 7 8 9 10);
            }
        }
        // Panels of columns, as even as they go.
        let count = self.width.div_ceil(panel::<V>());
        let bound = |k: usize| k * self.width / count.max(1);
        for a in 0..count {
            for b in 0..=a {
                let (rows, columns) = (bound(a)..bound(a + 1), bound(b)..bound(b + 1));
                macro_rules! panel {
                    ($($m:literal)*) => {
                        match (rows.len(), a == b) {
                            $(($m, true) if $m <= panel::<V>() => self_products::<V, $m>(
                                vectors, self.block, self.width, rows.start, self.sums, &mut ahead,
                            ),
                            ($m, false) if $m <= panel::<V>() => cross_products::<V, $m>(
                                vectors, self.block, self.width, rows.start,
                                [columns.start, columns.len()], self.sums, &mut ahead,
                            ),)*
                            _ => {}
                        }
                    };
                }
                panel!(1 2 3 4 5);
            }
        }
        ahead.ask_for_rest();
    }
}

/// Takes `M` columns from `start`, times their coefficients, off column `response`.
#[inline(always)]
fn subtract_fit<V: Vectors, const M: usize>(
    vectors: V,
    block: &mut [Lane],
    width: usize,
    [start, response]: [usize; 2],
    betas: &[f64],
    ahead: &mut Ahead<'_>,
) {
    let mut beta = [vectors.splat(0.0); M];
    for (beta, value) in beta.iter_mut().zip(betas) {
        *beta = vectors.splat(*value);
    }
    for group in block.chunks_exact_mut(width) {
        ahead.ask();
        ahead.ask();
        let (x, y) = group.split_at_mut(response);
        let Some(x) = x[start..].first_chunk::<M>() else {
            return;
        };
        for part in 0..V::PARTS {
            // Two chains, so that their sums overlap.
            let mut rest = [vectors.load(&y[0], part), vectors.splat(0.0)];
            for m in 0..M {
                rest[m % 2] = vectors.subtract_product(vectors.load(&x[m], part), beta[m], rest[m % 2]);
            }
            let total = vectors.multiply_add(rest[1], vectors.splat(1.0), rest[0]);
            vectors.store(&mut y[0], part, total);
        }
    }
}

/// Products of `M` columns from `start` among themselves.
#[inline(always)]
fn self_products<V: Vectors, const M: usize>(
    vectors: V,
    block: &[Lane],
    width: usize,
    start: usize,
    sums: &mut [Lane],
    ahead: &mut Ahead<'_>,
) {
    let mut products = [[vectors.splat(0.0); M]; M];
    for group in block.chunks_exact(width) {
        ahead.ask();
        ahead.ask();
        let Some(x) = group[start..].first_chunk::<M>() else {
            return;
        };
        for part in 0..V::PARTS {
            let mut values = [vectors.splat(0.0); M];
            for i in 0..M {
                values[i] = vectors.load(&x[i], part);
                for j in 0..=i {
                    products[i][j] = vectors.multiply_add(values[i], values[j], products[i][j]);
                }
            }
        }
    }
    for i in 0..M {
        for j in 0..=i {
            add(vectors, &mut sums[pair(start + i, start + j)], products[i][j]);
        }
    }
}

/// Products of `M` columns from `start` with `count` columns from `other`.
#[inline(always)]
fn cross_products<V: Vectors, const M: usize>(
    vectors: V,
    block: &[Lane],
    width: usize,
    start: usize,
    [other, count]: [usize; 2],
    sums: &mut [Lane],
    ahead: &mut Ahead<'_>,
) {
    macro_rules! count {
        ($($n:literal)*) => {
            match count {
                $($n if $n <= panel::<V>() => cross_tile::<V, M, $n>(
                    vectors, block, width, start, other, sums, ahead,
                ),)*
                _ => {}
            }
        };
    }
    count!(1 2 3 4 5);
}

#[inline(always)]
fn cross_tile<V: Vectors, const M: usize, const N: usize>(
    vectors: V,
    block: &[Lane],
    width: usize,
    start: usize,
    other: usize,
    sums: &mut [Lane],
    ahead: &mut Ahead<'_>,
) {
    let mut products = [[vectors.splat(0.0); N]; M];
    for group in block.chunks_exact(width) {
        ahead.ask();
        ahead.ask();
        let (Some(x), Some(y)) = (group[start..].first_chunk::<M>(), group[other..].first_chunk::<N>()) else {
            return;
        };
        for part in 0..V::PARTS {
            let mut values = [vectors.splat(0.0); N];
            for j in 0..N {
                values[j] = vectors.load(&y[j], part);
            }
            for i in 0..M {
                let value = vectors.load(&x[i], part);
                for j in 0..N {
                    products[i][j] = vectors.multiply_add(value, values[j], products[i][j]);
                }
            }
        }
    }
    for i in 0..M {
        for j in 0..N {
            add(vectors, &mut sums[pair(start + i, other + j)], products[i][j]);
        }
    }
}

/// Adds a register to the first part of a lane; the other parts stay zero.
#[inline(always)]
fn add<V: Vectors>(vectors: V, sum: &mut Lane, value: V::Vector) {
    let total = vectors.multiply_add(value, vectors.splat(1.0), vectors.load(sum, 0));
    vectors.store(sum, 0, total);
}

/// The triangle of `[X | Y]` from the products of `[X | Y − X·pilot]`.
///
/// None when a variance inflation factor is above [`LARGEST_INFLATION`], or when a
/// response is so nearly a combination of regressors that its residual drowns.
pub(crate) fn triangle(sums: &[Lane], regressors: usize, pilot: &[f64], width: usize) -> Option<Vec<f64>> {
    let product = |i: usize, j: usize| sums[pair(i, j)].0.iter().sum::<f64>();
    let lengths: Vec<f64> = (0..width).map(|i| product(i, i).sqrt()).collect();
    // Cholesky of the products of columns of length one, transposed in place: r[j][i] = L[i][j].
    let mut r = vec![0.0; width * width];
    #[allow(clippy::needless_range_loop)] // as in the formula
    for i in 0..width {
        if lengths[i] == 0.0 && i >= regressors {
            continue; // a response that the pilot fits exactly
        }
        for j in 0..=i {
            let known: f64 = (0..j).map(|l| r[l * width + i] * r[l * width + j]).sum();
            let rest = product(i, j) / (lengths[i] * lengths[j]) - known;
            if i == j {
                if rest.is_nan() || rest * LARGEST_INFLATION < 1.0 {
                    return None;
                }
                r[i * width + i] = rest.sqrt();
            } else if lengths[j] != 0.0 {
                r[j * width + i] = rest / r[j * width + j];
            }
        }
    }
    if largest_inflation(&r, regressors, width) > LARGEST_INFLATION {
        return None;
    }
    for (i, row) in r.chunks_exact_mut(width).enumerate() {
        for j in i..width {
            row[j] *= lengths[j];
        }
        let (x, y) = row.split_at_mut(regressors);
        for (y, pilot) in y.iter_mut().zip(pilot.chunks_exact(regressors.max(1))) {
            *y += x.iter().zip(pilot).map(|(x, beta)| x * beta).sum::<f64>();
        }
    }
    Some(r)
}

/// Largest variance inflation factor of the first `p` columns of a triangle.
///
/// The factor of column `j` is `|x_j|²` times the `j`-th diagonal of `(XᵀX)⁻¹`.
/// Infinite when a diagonal entry is zero.
pub(crate) fn largest_inflation(r: &[f64], p: usize, width: usize) -> f64 {
    let mut inflation = vec![0.0; p];
    let mut column = vec![0.0; p];
    for k in 0..p {
        // Column k of R⁻¹, bottom up.
        for i in (0..=k).rev() {
            let below: f64 = (i + 1..=k).map(|l| r[i * width + l] * column[l]).sum();
            let unit = f64::from(u8::from(i == k));
            column[i] = (unit - below) / r[i * width + i];
            inflation[i] += column[i] * column[i];
        }
    }
    (0..p)
        .map(|j| {
            let length: f64 = (0..=j).map(|i| r[i * width + j].powi(2)).sum();
            let factor = inflation[j] * length;
            if factor.is_nan() { f64::INFINITY } else { factor }
        })
        .fold(0.0, f64::max)
}
