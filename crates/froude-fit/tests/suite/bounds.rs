//! Bounded fits against all active sets tried one by one.

use faer::Mat;
use froude_fit::bounded::bounded_least_squares;
use froude_fit::{Bound, End, Options, Status, fit};
use proptest::prelude::*;

use crate::{assert_close, single};

fn squares(rows: &[Vec<f64>], y: &[f64], x: &[f64]) -> f64 {
    rows.iter()
        .zip(y)
        .map(|(row, y)| {
            let fitted: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
            (y - fitted) * (y - fitted)
        })
        .sum()
}

/// The best of all `3^p` ways to hold coefficients at bounds.
fn brute_force(rows: &[Vec<f64>], y: &[f64], lower: &[f64], upper: &[f64]) -> f64 {
    let p = lower.len();
    let mut best = f64::INFINITY;
    for code in 0..3_usize.pow(p as u32) {
        let mut rest = code;
        let mut fixed = Vec::new();
        for j in 0..p {
            match rest % 3 {
                1 => fixed.push((j, lower[j])),
                2 => fixed.push((j, upper[j])),
                _ => {}
            }
            rest /= 3;
        }
        if fixed.iter().any(|f| f.1.is_infinite()) {
            continue;
        }
        let options = Options { fixed, ..Options::default() };
        let found = fit(&single(rows, y), &options).unwrap();
        let x: Vec<f64> = found.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect();
        let is_inside = (0..p).all(|j| x[j] >= lower[j] - 1e-12 && x[j] <= upper[j] + 1e-12);
        if is_inside {
            best = best.min(squares(rows, y, &x));
        }
    }
    best
}

prop_compose! {
    fn any_case()(p in 1_usize..=6)(
        p in Just(p),
        rows in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, p), 12),
        y in prop::collection::vec(-1.0..1.0_f64, 12),
        low in prop::collection::vec(prop_oneof![Just(f64::NEG_INFINITY), Just(0.0), -0.5..0.2_f64], p),
        width in prop::collection::vec(prop_oneof![Just(f64::INFINITY), 0.01..0.6_f64], p),
    ) -> (Vec<Vec<f64>>, Vec<f64>, Vec<f64>, Vec<f64>) {
        let upper = low.iter().zip(&width)
            .map(|(l, w)| if l.is_finite() { l + w } else { 0.1 * w })
            .collect();
        assert_eq!(p, low.len());
        (rows, y, low, upper)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_bounded_fit_is_the_best_of_all_active_sets((rows, y, lower, upper) in any_case()) {
        let p = lower.len();
        let a = Mat::from_fn(rows.len(), p, |i, j| rows[i][j]);
        let found = bounded_least_squares(a.as_ref(), &y, &lower, &upper);
        prop_assert_eq!(found.report.end, End::Converged);
        prop_assert!(found.kkt < 1e-12, "{}", found.kkt);
        for j in 0..p {
            prop_assert!(found.x[j] >= lower[j] && found.x[j] <= upper[j]);
        }
        let best = brute_force(&rows, &y, &lower, &upper);
        let own = squares(&rows, &y, &found.x);
        prop_assert!((own - best).abs() <= 1e-12 * best.max(1.0), "{} {}", own, best);
    }

    /// The same bounds as inequalities go the other way, through the interior-point solver.
    #[test]
    fn bounds_and_the_same_inequalities_agree((rows, y, lower, upper) in any_case()) {
        let p = lower.len();
        let problem = single(&rows, &y);
        let bounded = Options {
            bounds: lower.iter().zip(&upper).map(|(&lower, &upper)| Bound { lower, upper }).collect(),
            ..Options::default()
        };
        let mut inequalities = Vec::new();
        for j in 0..p {
            for (sign, value) in [(1.0, upper[j]), (-1.0, -lower[j])] {
                if value.is_finite() {
                    let mut row = vec![0.0; p];
                    row[j] = sign;
                    inequalities.push(froude_fit::Constraint { row, value });
                }
            }
        }
        let general = Options { inequalities, ..Options::default() };
        let one = fit(&problem, &bounded).unwrap();
        let other = fit(&problem, &general).unwrap();
        for (a, b) in one.coefficients.iter().zip(&other.coefficients) {
            let (a, b) = (a.value.unwrap(), b.value.unwrap());
            prop_assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{} {}", a, b);
        }
        prop_assert!(other.optimality.is_none_or(|o| o.kkt < 1e-10));
    }
}

#[test]
fn a_bound_that_holds_gives_that_very_number_and_cuts_the_interval() {
    // y = −0.1 + x with noise: the intercept is held at 0.
    let x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let y = [0.95, 1.85, 2.92, 3.90, 4.93, 5.87];
    let problem = single(&x.map(|x| vec![1.0, x]), &y);
    let free = fit(&problem, &Options::default()).unwrap();
    let options = Options { bounds: vec![Bound::NON_NEGATIVE; 2], ..Options::default() };
    let bounded = fit(&problem, &options).unwrap();
    let (b0, b1) = (&bounded.coefficients[0], &bounded.coefficients[1]);
    assert_eq!((b0.value, b0.status), (Some(0.0), Status::AtBound));
    assert_eq!(b0.unconstrained, free.coefficients[0].value);
    assert_eq!(b0.standard, free.coefficients[0].standard);
    assert_eq!(b0.interval.unwrap()[0], 0.0);
    assert_eq!(b0.interval.unwrap()[1], free.coefficients[0].interval.unwrap()[1]);
    let sxy: f64 = x.iter().zip(&y).map(|(x, y)| x * y).sum();
    assert_close(b1.value.unwrap(), sxy / 91.0, 1e-14);
    assert_eq!(b1.interval, free.coefficients[1].interval);
    assert_eq!(bounded.components[0].sigma, free.components[0].sigma);
    assert!(bounded.components[0].rss > free.components[0].rss);
}

#[test]
fn a_bound_far_from_the_interval_is_contradicted() {
    let x = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let y = [-1.1, -1.9, -3.05, -3.9, -5.1, -6.0];
    let options = Options { bounds: vec![Bound::NON_NEGATIVE], ..Options::default() };
    let fit = fit(&single(&x.map(|x| vec![x]), &y), &options).unwrap();
    let c = &fit.coefficients[0];
    assert_eq!(c.status, Status::BoundContradicted);
    assert_eq!((c.value, c.interval), (Some(0.0), None));
    assert!(c.unconstrained.unwrap() < -0.9);
}

#[test]
fn bounds_do_not_make_parallel_columns_determined() {
    let x = [1.0, 2.0, 3.0, 4.0];
    let y = [-2.1, -3.9, -6.1, -7.9];
    let options = Options { bounds: vec![Bound::FREE, Bound::NON_NEGATIVE], ..Options::default() };
    let fit = fit(&single(&x.map(|x| vec![x, 2.0 * x]), &y), &options).unwrap();
    assert!(fit.coefficients.iter().all(|c| c.status == Status::Undetermined));
    assert!(fit.coefficients.iter().all(|c| c.value.is_none()));
    // b0 is free, so the sum reaches its unconstrained value.
    let sum = &fit.undetermined[0];
    assert_close(sum.value, -59.8 / 30.0, 1e-12);
    let both = Options { bounds: vec![Bound::NON_NEGATIVE; 2], ..Options::default() };
    let fit = froude_fit::fit(&single(&x.map(|x| vec![x, 2.0 * x]), &y), &both).unwrap();
    assert_eq!(fit.undetermined[0].value, 0.0);
}
