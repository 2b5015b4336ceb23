//! The fast path against the textbook, published numbers, and itself.

use std::collections::BTreeMap;

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use super::kernel::put;
use super::kernel::{Ahead, absorb};
use super::*;
use crate::stream::reference::triangularise;
use froude_lanes::{Lane, Level};

fn uniform(generator: &mut Pcg64) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

/// Columns like those of a drag fit, with their response last.
fn drag_columns(n: usize, seed: u128) -> Vec<Vec<f64>> {
    let mut generator = Pcg64::new(seed, 1);
    let mut columns: Vec<Vec<f64>> = (0..5).map(|_| Vec::with_capacity(n)).collect();
    for _ in 0..n {
        let (u, v) = (4.0 * uniform(&mut generator), 4.0 * uniform(&mut generator));
        let row = [u, u * u.abs(), v, v * v.abs()];
        let noise = 0.1 * uniform(&mut generator);
        let force = 0.02 * row[0] + 1.2 * row[1] + 0.4 * row[2] + 2.2 * row[3] + noise;
        for (column, value) in columns.iter_mut().zip(row.into_iter().chain([force])) {
            column.push(value);
        }
    }
    columns
}

fn assert_close(found: &[f64], expected: &[f64], relative: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs();
        assert!(
            error <= relative * expected.abs().max(1e-300),
            "{found} differs from {expected} by {:e}",
            error / expected.abs()
        );
    }
}

/// `RᵀR`, which does not depend on the signs of the diagonal.
fn products(r: &[f64], rows: usize, width: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for i in 0..width {
        for j in 0..width {
            out.push((0..rows).map(|k| r[k * width + i] * r[k * width + j]).sum());
        }
    }
    out
}

#[test]
fn every_instruction_set_gives_the_textbook_triangle() {
    let mut generator = Pcg64::new(3, 1);
    for width in 1..24 {
        for rows in [1, 7, 8, 50] {
            let mut matrix: Vec<f64> = (0..rows * width).map(|_| uniform(&mut generator)).collect();
            let mut old: Vec<f64> = vec![0.0; width * width];
            for i in 0..width {
                for j in i..width {
                    old[i * width + j] = uniform(&mut generator);
                }
            }
            let mut stacked = old.clone();
            stacked.extend_from_slice(&matrix);
            triangularise(&mut stacked, width + rows, width);
            let expected = products(&stacked, width, width);
            for level in Level::available() {
                let mut block = vec![Lane::ZERO; rows.div_ceil(LANES) * width];
                for j in 0..width {
                    let column: Vec<f64> = (0..rows).map(|i| matrix[i * width + j]).collect();
                    put(&mut block, width, j, 0, &column);
                }
                let mut found = old.clone();
                absorb(level, &mut found, &mut block, &mut vec![0.0; 2 * width], Ahead::nothing());
                let found_products = products(&found, width, width);
                for (found, expected) in found_products.iter().zip(&expected) {
                    assert!((found - expected).abs() < 1e-13 * (rows + width) as f64, "{level:?}");
                }
            }
            matrix.clear();
        }
    }
}

/// A whole-number design whose least-squares solution is known exactly.
///
/// Every row comes twice, with opposite noise, so the noise is orthogonal to all
/// columns; the columns share a part `2^bits` times their own: the condition number.
fn exact_problem(n: usize, p: usize, bits: i32) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut generator = Pcg64::new(5, 1);
    let beta: Vec<f64> = (0..p).map(|j| (j as f64 - 1.5) * 2.0).collect();
    let mut columns = vec![Vec::with_capacity(n); p + 1];
    let mut whole = |size: f64| (uniform(&mut generator) * size).round();
    for _ in 0..n / 2 {
        let shared = whole(64.0) * 2.0_f64.powi(bits);
        let row: Vec<f64> = (0..p).map(|_| shared + whole(64.0)).collect();
        let clean: f64 = row.iter().zip(&beta).map(|(x, b)| x * b).sum();
        let noise = whole(64.0);
        for sign in [1.0, -1.0] {
            for (column, value) in columns.iter_mut().zip(&row) {
                column.push(*value);
            }
            columns[p].push(clean + sign * noise);
        }
    }
    (columns, beta)
}

fn worst_error(found: &[f64], truth: &[f64]) -> f64 {
    let size = truth.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
    found.iter().zip(truth).fold(0.0_f64, |m, (f, t)| m.max((f - t).abs())) / size
}

/// QR by `faer`, the whole design at once.
fn by_faer(columns: &[Vec<f64>]) -> Vec<f64> {
    use faer::prelude::*;
    let p = columns.len() - 1;
    let design = Mat::from_fn(columns[0].len(), p, |i, j| columns[j][i]);
    let response = Mat::from_fn(columns[0].len(), 1, |i, _| columns[p][i]);
    let solution = design.qr().solve_lstsq(&response);
    solution.col(0).iter().copied().collect()
}

/// By normal equations, to show what is avoided.
fn by_normal_equations(columns: &[Vec<f64>]) -> Vec<f64> {
    let p = columns.len() - 1;
    let product = |i: usize, j: usize| -> f64 { columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum() };
    let mut matrix = Vec::new();
    for i in 0..p {
        matrix.extend((0..=p).map(|j| product(i, j)));
    }
    reference::least_squares(&mut matrix, p, p)
}

/// The error stays within this factor of `faer`'s QR (or of one rounding times the
/// condition number): blocks of rows cost or win no more than a digit.
const OF_QR: f64 = 10.0;

#[test]
fn coefficients_are_as_exact_as_by_qr_of_the_whole_design() {
    for bits in [0, 3, 10, 17, 23] {
        let (columns, truth) = exact_problem(300_000, 4, bits);
        let all = slices(&columns);
        let qr = worst_error(&by_faer(&columns), &truth);
        let normal = worst_error(&by_normal_equations(&columns), &truth);
        let fit = reduce_columns(&all[..4], &all[4..]).unwrap().solve(0).unwrap();
        let error = worst_error(&fit.coefficients, &truth);
        println!(
            "condition number {:8.1e}: {error:.1e}, QR {qr:.1e}, normal equations {normal:.1e}",
            fit.condition_number
        );
        let rounding = f64::EPSILON * fit.condition_number;
        assert!(error <= OF_QR * qr.max(rounding), "{error:e} against {qr:e}");
    }
}

#[test]
fn residual_scatter_of_the_exact_problem_is_exact() {
    let (columns, _) = exact_problem(300_000, 4, 10);
    let clean: f64 = {
        // The noise is half the difference within each pair of rows.
        let y = columns[4].as_chunks::<2>().0;
        y.iter().map(|[a, b]| 2.0 * (0.5 * (a - b)).powi(2)).sum()
    };
    let all = slices(&columns);
    let factor = reduce_columns(&all[..4], &all[4..]).unwrap();
    assert_close(&[factor.residual_squares(0)], &[clean], 1e-12);
}

/// Longley's data (NIST StRD, linear regression, "Longley"): certified to 15 digits.
#[test]
fn longleys_certified_values() {
    const RAW: [[f64; 7]; 16] = [
        [60323., 83.0, 234289., 2356., 1590., 107608., 1947.],
        [61122., 88.5, 259426., 2325., 1456., 108632., 1948.],
        [60171., 88.2, 258054., 3682., 1616., 109773., 1949.],
        [61187., 89.5, 284599., 3351., 1650., 110929., 1950.],
        [63221., 96.2, 328975., 2099., 3099., 112075., 1951.],
        [63639., 98.1, 346999., 1932., 3594., 113270., 1952.],
        [64989., 99.0, 365385., 1870., 3547., 115094., 1953.],
        [63761., 100.0, 363112., 3578., 3350., 116219., 1954.],
        [66019., 101.2, 397469., 2904., 3048., 117388., 1955.],
        [67857., 104.6, 419180., 2822., 2857., 118734., 1956.],
        [68169., 108.4, 442769., 2936., 2798., 120445., 1957.],
        [66513., 110.8, 444546., 4681., 2637., 121950., 1958.],
        [68655., 112.6, 482704., 3813., 2552., 123366., 1959.],
        [69564., 114.2, 502601., 3931., 2514., 125368., 1960.],
        [69331., 115.7, 518173., 4806., 2572., 127852., 1961.],
        [70551., 116.9, 554894., 4007., 2827., 130081., 1962.],
    ];
    const COEFFICIENTS: [f64; 7] = [
        -3482258.63459582,
        15.0618722713733,
        -0.358191792925910e-01,
        -2.02022980381683,
        -1.03322686717359,
        -0.511041056535807e-01,
        1829.15146461355,
    ];
    const STANDARD: [f64; 7] = [
        890420.383607373,
        84.9149257747669,
        0.334910077722432e-01,
        0.488399681651699,
        0.214274163161675,
        0.226073200069370,
        455.478499142212,
    ];
    let mut columns = vec![vec![1.0; 16]];
    for j in 1..7 {
        columns.push(RAW.iter().map(|row| row[j]).collect());
    }
    columns.push(RAW.iter().map(|row| row[0]).collect());
    let all = slices(&columns);
    let fit = reduce_columns(&all[..7], &all[7..]).unwrap().solve(0).unwrap();
    // Scaled condition number 4.3e4; the intercept is far outside the data: some 9 digits.
    assert_close(&fit.coefficients, &COEFFICIENTS, 1e-8);
    assert_close(&fit.standard, &STANDARD, 1e-8);
    assert_close(&[fit.sigma], &[304.854073561965], 1e-10);
    assert_eq!(fit.dof, 9.0);
}

#[test]
fn the_cut_into_chunks_and_the_number_of_threads_change_no_bit() {
    let columns = drag_columns(300_000, 6);
    let all = slices(&columns);
    let whole = reduce_columns(&all[..4], &all[4..]).unwrap();
    let shape = whole.shape();
    for sizes in [vec![300_000], vec![1, 2, 3, 499, 512, 513], vec![100_000], vec![7777, 1]] {
        let mut rows = Accumulator::new(shape);
        let mut start = 0;
        for size in sizes.iter().cycle() {
            let end = (start + size).min(300_000);
            let chunk: Vec<&[f64]> = all.iter().map(|column| &column[start..end]).collect();
            rows.push(&chunk[..4], &chunk[4..]).unwrap();
            start = end;
            if start == 300_000 {
                break;
            }
        }
        assert_eq!(rows.rows(), 300_000);
        assert!(rows.finish() == whole, "chunks of {sizes:?}");
    }
    let reduced = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reduce_columns(&all[..4], &all[4..]).unwrap())
    });
    assert!(reduced[0] == reduced[1] && reduced[1] == reduced[2]);
}

#[test]
fn a_noiseless_response_is_fitted_to_rounding() {
    let mut columns = drag_columns(300_000, 9);
    let exact: Vec<f64> = columns[0].iter().map(|u| 3.0 * u).collect();
    columns[4] = exact;
    let all = slices(&columns);
    let fit = reduce_columns(&all[..4], &all[4..]).unwrap().solve(0).unwrap();
    assert!((fit.coefficients[0] - 3.0).abs() < 1e-13);
    assert!(fit.sigma < 1e-14, "{}", fit.sigma);
}

#[test]
fn merged_factors_are_the_factor_of_all_rows() {
    let columns = drag_columns(5000, 10);
    let all = slices(&columns);
    let whole = reduce_columns(&all[..4], &all[4..]).unwrap();
    let part = |range: Range<usize>| {
        let part: Vec<&[f64]> = all.iter().map(|column| &column[range.clone()]).collect();
        reduce_columns(&part[..4], &part[4..]).unwrap()
    };
    let mut merged = part(0..3);
    merged.merge(&part(3..1234)).unwrap();
    merged.merge(&part(1234..5000)).unwrap();
    assert_eq!(merged.rows(), 5000);
    let (a, b) = (merged.solve(0).unwrap(), whole.solve(0).unwrap());
    assert_close(&a.coefficients, &b.coefficients, 1e-12);
    assert_close(&a.standard, &b.standard, 1e-12);
}

#[test]
fn two_responses_share_their_design_and_not_their_scatter() {
    let columns = drag_columns(2000, 12);
    let all = slices(&columns);
    let other: Vec<f64> = columns[4].iter().zip(&columns[0]).map(|(y, u)| 2.0 * y + u).collect();
    let factor = reduce_columns(&all[..4], &[all[4], &other]).unwrap();
    let (a, b) = (factor.solve(0).unwrap(), factor.solve(1).unwrap());
    assert_close(&[b.coefficients[3], b.sigma], &[2.0 * a.coefficients[3], 2.0 * a.sigma], 1e-11);
}

/// Rows in clusters of unequal size, with a shared part in the noise.
fn clustered() -> (Vec<Vec<f64>>, Vec<u64>) {
    let mut columns = drag_columns(600, 13);
    let mut generator = Pcg64::new(14, 1);
    let mut clusters = Vec::new();
    for g in 0..9_u64 {
        let shared = uniform(&mut generator);
        for i in clusters.len()..clusters.len() + 13 * (g as usize + 1) {
            columns[4][i] += shared;
            clusters.push(10 * g);
        }
    }
    clusters.resize(600, 80);
    (columns, clusters)
}

fn clustered_factors(columns: &[Vec<f64>], clusters: &[u64]) -> BTreeMap<u64, Factor> {
    let all = slices(columns);
    let shape = Shape { regressors: 4, responses: 1 };
    let mut rows = ClusterAccumulator::new(shape, 100);
    rows.push(clusters, &all[..4], &all[4..]).unwrap();
    rows.finish().unwrap()
}

#[test]
fn clusters_may_come_in_any_order_and_in_parts() {
    let (columns, clusters) = clustered();
    let together = clustered_factors(&columns, &clusters);
    let order: Vec<usize> = (0..600).map(|i| i * 7 % 600).collect();
    let mixed: Vec<Vec<f64>> = (columns.iter()).map(|column| order.iter().map(|&i| column[i]).collect()).collect();
    let mixed_clusters: Vec<u64> = order.iter().map(|&i| clusters[i]).collect();
    let mut rows = ClusterAccumulator::new(Shape { regressors: 4, responses: 1 }, 100);
    for range in [0..250, 250..600] {
        let part: Vec<&[f64]> = mixed.iter().map(|column| &column[range.clone()]).collect();
        rows.push(&mixed_clusters[range], &part[..4], &part[4..]).unwrap();
    }
    let mixed = rows.finish().unwrap();
    assert_eq!(mixed.len(), 9);
    for ((cluster, a), (of, b)) in together.iter().zip(&mixed) {
        assert_eq!((cluster, a.rows()), (of, b.rows()));
        let (a, b) = (a.solve(0).unwrap(), b.solve(0).unwrap());
        assert_close(&a.coefficients, &b.coefficients, 1e-9);
        assert_close(&a.standard, &b.standard, 1e-9);
    }
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let mut columns = drag_columns(200_000, 15);
    columns[2][187_654] = f64::NAN;
    let all = slices(&columns);
    let message = "row 187654, column 2 is NaN; every entry must be finite and below 1e150 in size";
    let shape = Shape { regressors: 4, responses: 1 };
    let error = reduce_columns(&all[..4], &all[4..]).unwrap_err();
    assert_eq!(error.to_string(), message);
    let mut rows = Accumulator::new(shape);
    for start in (0..200_000).step_by(1000) {
        let chunk: Vec<&[f64]> = all.iter().map(|column| &column[start..start + 1000]).collect();
        let pushed = rows.push(&chunk[..4], &chunk[4..]);
        if start == 187_000 {
            assert_eq!(pushed.unwrap_err().to_string(), message);
        }
    }
    assert_eq!(rows.rows(), 199_000);

    let (u, other) = (vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0]);
    let error = |regressors: &[&[f64]], y: &[f64]| {
        let factor = reduce_columns(regressors, &[y]);
        factor.and_then(|factor| factor.solve(0)).unwrap_err().to_string()
    };
    assert!(error(&[&u, &other], &u).contains("the data do not determine coefficient"));
    assert_eq!(error(&[&u], &[1.0]), "column 1 has 1 rows, column 0 has 3; give equal lengths");
    assert_eq!(error(&[&u[..1]], &[1.0]), "1 rows do not determine 1 coefficients and their scatter");
    let big = [1e200, 1.0, 1.0];
    assert_eq!(
        error(&[&u], &big),
        format!("row 0, column 1 is {}; every entry must be finite and below 1e150 in size", 1e200)
    );
    let mut few = ClusterAccumulator::new(shape, 1);
    let one: Vec<&[f64]> = all.iter().map(|column| &column[..2]).collect();
    few.push(&[4, 7], &one[..4], &one[4..]).unwrap();
    assert_eq!(
        few.finish().unwrap_err().to_string(),
        "cluster 7 is one more than the limit of 1: each keeps a triangle of its own; raise \
         the limit, or use longer clusters"
    );
}

#[test]
fn nothing_in_gives_nothing_out() {
    let factor = reduce_columns(&[&[]], &[&[]]).unwrap();
    assert_eq!(factor.rows(), 0);
    let error = factor.solve(0).unwrap_err();
    assert_eq!(error.to_string(), "0 rows do not determine 1 coefficients and their scatter");
    assert!(factor.solve(1).is_err());
    let none = reduce_columns(&[], &[]).unwrap();
    assert_eq!(none.shape().width(), 0);
}
