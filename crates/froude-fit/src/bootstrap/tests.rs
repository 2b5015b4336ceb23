//! The batch against a loop over refits, and the draws against their distribution.

use super::kernel::{Table, resample_counts};
use super::*;
use crate::stream::lanes::Level;
use crate::stream::reference::least_squares;

/// A seeded stream of numbers between −1/2 and 1/2.
fn numbers(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// Regressors, then the response, with noise that grows along the rows.
fn data(n: usize) -> Vec<Vec<f64>> {
    let mut next = numbers(88_172_645_463_325_252);
    let mut columns = vec![Vec::new(); 4];
    for i in 0..n {
        let (u, v) = (4.0 * next(), 2.0 * next());
        let noise = (0.1 + i as f64 / n as f64) * next();
        for (column, value) in columns.iter_mut().zip([u, u * u.abs(), v, 0.3 * u + 1.2 * u * u.abs() - v + noise]) {
            column.push(value);
        }
    }
    columns
}

fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

/// Fits with every row as often as it was drawn.
fn refit(columns: &[Vec<f64>], times: impl Fn(usize) -> u8) -> Vec<f64> {
    let p = columns.len() - 1;
    let mut matrix = Vec::new();
    let mut rows = 0;
    for i in 0..columns[0].len() {
        for _ in 0..times(i) {
            matrix.extend(columns.iter().map(|column| column[i]));
            rows += 1;
        }
    }
    least_squares(&mut matrix, rows, p)
}

#[test]
fn every_resample_is_the_fit_of_the_rows_drawn() {
    let columns = data(150);
    let all = slices(&columns);
    let options = Resampling { resamples: 37, seed: 5 };
    let result = pairs(&all[..3], all[3], None, options).unwrap();
    assert_eq!((result.coefficients.nrows(), result.undetermined), (37, 0));
    for b in 0..37 {
        let counts = resample_counts(150, 5, b);
        assert_eq!(counts.iter().map(|&c| usize::from(c)).sum::<usize>(), 150);
        let expected = refit(&columns, |i| counts[i]);
        for j in 0..3 {
            let error = (result.coefficients[(b as usize, j)] - expected[j]).abs();
            assert!(error < 1e-12, "resample {b}: {error:e}");
        }
    }
}

#[test]
fn every_instruction_set_gives_the_same_resamples() {
    let columns = data(150);
    let all = slices(&columns);
    let whole = Whole::new(&all[..3], all[3], None).unwrap();
    let options = Resampling { resamples: 20, seed: 2 };
    let results: Vec<Bootstrap> = Level::available()
        .map(|level| {
            let mut table = Table::at_level(150, 3, level);
            for (row, basis) in whole.basis.chunks_exact(4).enumerate() {
                table.add(row, basis);
            }
            whole.resample(&table, options).unwrap()
        })
        .collect();
    for other in &results[1..] {
        for b in 0..20 {
            for j in 0..3 {
                let error = results[0].coefficients[(b, j)] - other.coefficients[(b, j)];
                assert!(error.abs() < 1e-13);
            }
        }
    }
}

#[test]
fn clusters_are_drawn_whole() {
    let columns = data(150);
    let all = slices(&columns);
    let cluster: Vec<usize> = (0..150).map(|i| 1000 - i / 7).collect();
    let options = Resampling { resamples: 20, seed: 9 };
    let result = cluster_pairs(&all[..3], all[3], None, &cluster, options).unwrap();
    let units = 150_usize.div_ceil(7);
    for b in 0..20 {
        let counts = resample_counts(units as u32, 9, b);
        // Clusters are numbered by name: the last rows have the lowest.
        let expected = refit(&columns, |i| counts[units - 1 - i / 7]);
        for j in 0..3 {
            let error = (result.coefficients[(b as usize, j)] - expected[j]).abs();
            assert!(error < 1e-12, "{error:e}");
        }
    }
}

#[test]
fn weights_are_those_of_weighted_least_squares() {
    let mut columns = data(150);
    let weight: Vec<f64> = (0..150).map(|i| 1.0 + f64::from(i % 4)).collect();
    let options = Resampling { resamples: 5, seed: 3 };
    let all = slices(&columns);
    let found = pairs(&all[..3], all[3], Some(&weight), options).unwrap();
    for column in &mut columns {
        for (value, weight) in column.iter_mut().zip(&weight) {
            *value *= weight.sqrt();
        }
    }
    let all = slices(&columns);
    let expected = pairs(&all[..3], all[3], None, options).unwrap();
    assert!(found.coefficients == expected.coefficients);
}

#[test]
fn the_number_of_threads_changes_no_bit_and_the_seed_changes_all() {
    let columns = data(200);
    let all = slices(&columns);
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = Resampling { resamples: 333, seed };
        pool.install(|| pairs(&all[..3], all[3], None, options).unwrap().coefficients)
    };
    assert!(run(1, 1) == run(2, 1) && run(1, 1) == run(3, 1));
    let (one, two) = (run(1, 1), run(1, 2));
    assert!((0..333).all(|b| one[(b, 0)] != two[(b, 0)]));
}

/// The pairs bootstrap estimates the heteroscedastic sandwich: in 20,000 resamples its
/// standard deviation is known to 1/√40000 = 0.5 %; the small-sample difference at
/// n = 1000 and p = 3 adds about as much.
#[test]
fn the_spread_is_that_of_the_sandwich() {
    let columns = data(1000);
    let all = slices(&columns);
    let options = Resampling { resamples: 20_000, seed: 4 };
    let result = pairs(&all[..3], all[3], None, options).unwrap();
    let beta = &result.estimate;
    let gram = |i: usize, j: usize| -> f64 { all[i].iter().zip(all[j]).map(|(a, b)| a * b).sum() };
    let mut influence = vec![[0.0; 3]; 1000];
    let residual: Vec<f64> = (0..1000).map(|i| all[3][i] - (0..3).map(|j| all[j][i] * beta[j]).sum::<f64>()).collect();
    for (i, influence) in influence.iter_mut().enumerate() {
        let mut matrix = Vec::new();
        for a in 0..3 {
            matrix.extend((0..3).map(|b| gram(a, b)));
            matrix.push(all[a][i] * residual[i]);
        }
        influence.copy_from_slice(&least_squares(&mut matrix, 3, 3));
    }
    for (j, standard) in result.standard().into_iter().enumerate() {
        let sandwich = influence.iter().map(|i| i[j] * i[j]).sum::<f64>().sqrt();
        assert!((standard / sandwich - 1.0).abs() < 0.02, "{j}: {}", standard / sandwich);
    }
    let interval = result.interval(0.95).unwrap();
    for (j, [low, high]) in interval.into_iter().enumerate() {
        let half = 0.5 * (high - low) / result.standard()[j];
        assert!((half - 1.96).abs() < 0.08, "{half}");
    }
}

/// Counts are multinomial: mean 1, variance 1 − 1/n, covariance −1/n; both generators
/// (16 and 32 bits). Tolerances are four standard errors.
#[test]
fn counts_are_multinomial() {
    for units in [10_u32, 1000, 5000] {
        let draws = 2_000_000 / u64::from(units);
        let (mut first, mut squares, mut neighbours) = (vec![0.0; units as usize], 0.0, 0.0);
        for b in 0..draws {
            let counts = resample_counts(units, 11, b);
            for (total, count) in first.iter_mut().zip(&counts) {
                *total += f64::from(*count);
            }
            squares += counts.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>();
            neighbours += (counts.windows(2)).map(|w| f64::from(w[0]) * f64::from(w[1])).sum::<f64>();
        }
        let n = f64::from(units);
        let all = draws as f64 * n;
        // Chi-square of the totals: mean n − 1, standard deviation √(2(n − 1)).
        let expected = draws as f64;
        let chi: f64 = first.iter().map(|total| (total - expected).powi(2) / expected).sum();
        assert!(((chi - (n - 1.0)) / (2.0 * (n - 1.0)).sqrt()).abs() < 4.0, "{units}: {chi}");
        // E c² = 2 − 1/n with variance about 15 − 4 = 11 per count; E c c′ = 1 − 1/n.
        assert!((squares / all - (2.0 - 1.0 / n)).abs() < 4.0 * (11.0 / all).sqrt());
        let pairs = draws as f64 * (n - 1.0);
        assert!((neighbours / pairs - (1.0 - 1.0 / n)).abs() < 4.0 * (6.0 / pairs).sqrt());
    }
}

#[test]
fn quantiles_are_linear_between_neighbours() {
    let mut values = [3.0, 1.0, 4.0, 2.0, 5.0];
    assert_eq!(quantile(&mut values, 0.0), 1.0);
    assert_eq!(quantile(&mut values, 1.0), 5.0);
    assert_eq!(quantile(&mut values, 0.5), 3.0);
    assert!((quantile(&mut values, 0.1) - 1.4).abs() < 1e-15);
}

#[test]
fn resamples_that_miss_the_decisive_row_are_counted() {
    let mut columns = data(50);
    columns[2] = vec![0.0; 50];
    columns[2][7] = 1.0;
    let all = slices(&columns);
    let result = pairs(&all[..3], all[3], None, Resampling::default()).unwrap();
    // A row is missed with probability (1 − 1/50)^50 = 0.364, ± 0.005.
    let share = result.undetermined as f64 / 10_000.0;
    assert!((share - 0.364).abs() < 0.02, "{share}");
    assert_eq!(result.coefficients.nrows() + result.undetermined, 10_000);
}

#[test]
fn what_is_wrong_is_said() {
    let columns = data(50);
    let all = slices(&columns);
    let options = Resampling::default();
    let message = |result: Result<Bootstrap, BootstrapError>| result.unwrap_err().to_string();
    assert_eq!(
        message(pairs(&all[..3], all[3], Some(&[1.0]), options)),
        "1 weights are given for 50 rows; give one for each row"
    );
    assert_eq!(
        message(pairs(&all[..3], all[3], Some(&[0.0; 50]), options)),
        "weight of row 0 is 0; a weight is positive and finite"
    );
    assert_eq!(
        message(cluster_pairs(&all[..3], all[3], None, &[1], options)),
        "1 clusters are given for 50 rows; give one for each row"
    );
    assert_eq!(
        message(pairs(&all[..3], all[3], None, Resampling { resamples: 1, seed: 1 })),
        "1 of 1 resamples determine the coefficients; at least 2 are needed"
    );
    assert_eq!(
        message(pairs(&all[..3], &all[3][..3], None, options)),
        "column 3 has 3 rows, column 0 has 50; give equal lengths"
    );
    let result = pairs(&all[..3], all[3], None, options).unwrap();
    assert_eq!(
        result.interval(1.0).unwrap_err().to_string(),
        "confidence is 1; it must lie between 0 and 1, such as 0.95"
    );
}
