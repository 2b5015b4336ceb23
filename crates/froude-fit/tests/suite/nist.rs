//! NIST Statistical Reference Datasets, linear regression: certified values.
//!
//! <https://www.itl.nist.gov/div898/strd/lls/lls.shtml>

use froude_fit::{Fit, Options, fit};

use crate::{polynomial, single};

/// Longley (1967), higher difficulty: y, then six regressors.
#[rustfmt::skip]
const LONGLEY: [[f64; 7]; 16] = [
    [60323.0,  83.0, 234289.0, 2356.0, 1590.0, 107608.0, 1947.0],
    [61122.0,  88.5, 259426.0, 2325.0, 1456.0, 108632.0, 1948.0],
    [60171.0,  88.2, 258054.0, 3682.0, 1616.0, 109773.0, 1949.0],
    [61187.0,  89.5, 284599.0, 3351.0, 1650.0, 110929.0, 1950.0],
    [63221.0,  96.2, 328975.0, 2099.0, 3099.0, 112075.0, 1951.0],
    [63639.0,  98.1, 346999.0, 1932.0, 3594.0, 113270.0, 1952.0],
    [64989.0,  99.0, 365385.0, 1870.0, 3547.0, 115094.0, 1953.0],
    [63761.0, 100.0, 363112.0, 3578.0, 3350.0, 116219.0, 1954.0],
    [66019.0, 101.2, 397469.0, 2904.0, 3048.0, 117388.0, 1955.0],
    [67857.0, 104.6, 419180.0, 2822.0, 2857.0, 118734.0, 1956.0],
    [68169.0, 108.4, 442769.0, 2936.0, 2798.0, 120445.0, 1957.0],
    [66513.0, 110.8, 444546.0, 4681.0, 2637.0, 121950.0, 1958.0],
    [68655.0, 112.6, 482704.0, 3813.0, 2552.0, 123366.0, 1959.0],
    [69564.0, 114.2, 502601.0, 3931.0, 2514.0, 125368.0, 1960.0],
    [69331.0, 115.7, 518173.0, 4806.0, 2572.0, 127852.0, 1961.0],
    [70551.0, 116.9, 554894.0, 4007.0, 2827.0, 130081.0, 1962.0],
];
/// Certified coefficient and its standard deviation.
const LONGLEY_CERTIFIED: [(f64, f64); 7] = [
    (-3482258.63459582, 890420.383607373),
    (15.0618722713733, 84.9149257747669),
    (-0.358191792925910E-01, 0.334910077722432E-01),
    (-2.02022980381683, 0.488399681651699),
    (-1.03322686717359, 0.214274163161675),
    (-0.511041056535807E-01, 0.226073200069370),
    (1829.15146461355, 455.478499142212),
];
const LONGLEY_SIGMA: f64 = 304.854073561965;

/// Norris (NIST, unpublished), lower difficulty: y, x.
#[rustfmt::skip]
const NORRIS: [(f64, f64); 36] = [
    (0.1, 0.2), (338.8, 337.4), (118.1, 118.2), (888.0, 884.6), (9.2, 10.1), (228.1, 226.5),
    (668.5, 666.3), (998.5, 996.3), (449.1, 448.6), (778.9, 777.0), (559.2, 558.2), (0.3, 0.4),
    (0.1, 0.6), (778.1, 775.5), (668.8, 666.9), (339.3, 338.0), (448.9, 447.5), (10.8, 11.6),
    (557.7, 556.0), (228.3, 228.1), (998.0, 995.8), (888.8, 887.6), (119.6, 120.2), (0.3, 0.3),
    (0.6, 0.3), (557.6, 556.8), (339.3, 339.1), (888.0, 887.2), (998.5, 999.0), (778.9, 779.0),
    (10.2, 11.1), (117.6, 118.3), (228.9, 229.2), (668.4, 669.1), (449.2, 448.9), (0.2, 0.5),
];
const NORRIS_CERTIFIED: [(f64, f64); 2] =
    [(-0.262323073774029, 0.232818234301152), (1.00211681802045, 0.429796848199937E-03)];
const NORRIS_SIGMA: f64 = 0.884796396144373;

/// Wampler 4 and 3: what is added to `Σ xᵏ`, per hundred.
#[rustfmt::skip]
const WAMPLER_NOISE: [f64; 21] = [
    759.0, -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 1838.0, -2048.0, 2048.0,
    -2048.0, 1838.0, -2048.0, 2048.0, -2048.0, 2523.0, -2048.0, 2048.0, -2048.0, 759.0,
];
/// Certified standard deviations of Wampler 3; those of Wampler 4 are a hundred times as large.
const WAMPLER_3_STANDARD: [f64; 6] =
    [2152.32624678170, 2363.55173469681, 779.343524331583, 101.475507550350, 5.64566512170752, 0.112324854679312];
const WAMPLER_3_SIGMA: f64 = 2360.14502379268;

fn check(fit: &Fit, certified: &[(f64, f64)], sigma: f64, digits: i32) {
    let tolerance = 10.0_f64.powi(-digits);
    for (c, &(value, standard)) in fit.coefficients.iter().zip(certified) {
        let found = c.value.unwrap();
        assert!((found / value - 1.0).abs() < tolerance, "{}: {found} {value}", c.name);
        let found = c.standard.unwrap();
        assert!((found / standard - 1.0).abs() < tolerance, "{}: {found} {standard}", c.name);
    }
    let found = fit.components[0].sigma.unwrap();
    assert!((found / sigma - 1.0).abs() < tolerance, "σ: {found} {sigma}");
}

/// Scaled condition number 4·10⁴: eleven digits are what the arithmetic has.
#[test]
fn longley_to_ten_digits() {
    let rows: Vec<Vec<f64>> =
        LONGLEY.iter().map(|r| std::iter::once(1.0).chain(r[1..].iter().copied()).collect()).collect();
    let fit = fit(&single(&rows, &LONGLEY.map(|r| r[0])), &Options::default()).unwrap();
    check(&fit, &LONGLEY_CERTIFIED, LONGLEY_SIGMA, 10);
    // Belsley, Kuh & Welsch (1980) print 43 275 for the column-scaled design.
    assert!((fit.condition_number - 43275.0).abs() < 1.0, "{}", fit.condition_number);
}

#[test]
fn norris_to_twelve_digits() {
    let rows: Vec<Vec<f64>> = NORRIS.iter().map(|&(_, x)| vec![1.0, x]).collect();
    let y: Vec<f64> = NORRIS.iter().map(|&(y, _)| y).collect();
    let fit = fit(&single(&rows, &y), &Options::default()).unwrap();
    check(&fit, &NORRIS_CERTIFIED, NORRIS_SIGMA, 12);
}

fn wampler(noise: f64, coefficient: impl Fn(usize) -> f64) -> Fit {
    let x: Vec<f64> = (0..21).map(f64::from).collect();
    let rows = polynomial(&x, 6);
    let y: Vec<f64> = rows
        .iter()
        .zip(WAMPLER_NOISE)
        .map(|(row, e)| {
            let exact: f64 = row.iter().enumerate().map(|(k, x)| coefficient(k) * x).sum();
            exact + noise * e
        })
        .collect();
    fit(&single(&rows, &y), &Options::default()).unwrap()
}

#[test]
fn wampler_1_and_2_fit_without_error() {
    for c in &wampler(0.0, |_| 1.0).coefficients {
        assert!((c.value.unwrap() - 1.0).abs() < 1e-8, "{}: {:?}", c.name, c.value);
    }
    for (k, c) in wampler(0.0, |k| 0.1_f64.powi(k as i32)).coefficients.iter().enumerate() {
        let exact = 0.1_f64.powi(k as i32);
        assert!((c.value.unwrap() / exact - 1.0).abs() < 1e-10, "{}: {:?}", c.name, c.value);
    }
}

#[test]
fn wampler_3_and_4_find_ones_under_large_residuals() {
    for (noise, digits) in [(1.0, 8), (100.0, 6)] {
        let fit = wampler(noise, |_| 1.0);
        let certified: Vec<(f64, f64)> = WAMPLER_3_STANDARD.iter().map(|s| (1.0, noise * s)).collect();
        check(&fit, &certified, noise * WAMPLER_3_SIGMA, digits);
    }
}
