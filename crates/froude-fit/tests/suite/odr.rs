//! Orthogonal distance regression.

use faer::Mat;
use froude_fit::coverage::{Count, z_limit};
use froude_fit::odr::{InputModel, OdrProblem, Sigma, odr};
use froude_fit::{End, Options, Status, fit};

use crate::{assert_close, names, normal, rng, single};

/// `y = b₀ + b₁ x`.
struct Line;

impl InputModel for Line {
    fn n_coefficients(&self) -> usize {
        2
    }
    fn n_components(&self) -> usize {
        1
    }
    fn n_inputs(&self) -> usize {
        1
    }
    fn regressors(&self, _: usize, z: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&[1.0, z[0]]);
    }
    fn derivatives(&self, _: usize, _: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&[0.0, 1.0]);
    }
}

/// Towing at speed and angle: linear and quadratic drag along and across.
struct Towing;

impl InputModel for Towing {
    fn n_coefficients(&self) -> usize {
        4
    }
    fn n_components(&self) -> usize {
        2
    }
    fn n_inputs(&self) -> usize {
        2
    }
    fn regressors(&self, _: usize, z: &[f64], out: &mut [f64]) {
        let (x, y) = (z[0] * z[1].cos(), -z[0] * z[1].sin());
        out.copy_from_slice(&[-x, -x * x.abs(), 0.0, 0.0, 0.0, 0.0, -y, -y * y.abs()]);
    }
}

fn line(x: &[f64], y: &[f64], s: f64, sigma: Sigma) -> OdrProblem {
    OdrProblem {
        inputs: Mat::from_fn(x.len(), 1, |i, _| x[i]),
        input_standard: Mat::full(x.len(), 1, s),
        response: Mat::from_fn(y.len(), 1, |i, _| y[i]),
        sigma: vec![sigma],
        components: vec!["y".into()],
        names: names(2),
    }
}

fn sample() -> (Vec<f64>, Vec<f64>) {
    let mut rng = rng(31);
    (0..25)
        .map(|i| {
            let x = 0.2 * f64::from(i);
            (x + 0.2 * normal(&mut rng), 1.0 + 2.0 * x + 0.3 * normal(&mut rng))
        })
        .unzip()
}

/// Deming (1943): the closed form for one input with a known ratio of variances.
#[test]
fn a_straight_line_is_demings() {
    let (x, y) = sample();
    let (s, sigma) = (0.2, 0.3);
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sxx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let syy: f64 = y.iter().map(|y| (y - my).powi(2)).sum();
    let sxy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let ratio = sigma * sigma / (s * s);
    let d = syy - ratio * sxx;
    let slope = (d + (d * d + 4.0 * ratio * sxy * sxy).sqrt()) / (2.0 * sxy);
    let found = odr(&Line, &line(&x, &y, s, Sigma::Known(sigma)), 0.95).unwrap();
    assert_eq!(found.report.end, End::Converged);
    assert_close(found.coefficients[1].value.unwrap(), slope, 1e-9);
    assert_close(found.coefficients[0].value.unwrap(), my - slope * mx, 1e-9);
    // The sum of squares: Σ(y − a − b x)²/(σ² + b² s²).
    let sum: f64 = x.iter().zip(&y).map(|(x, y)| (y - my - slope * (x - mx)).powi(2)).sum();
    assert_close(found.objective, sum / (sigma * sigma + slope * slope * s * s), 1e-10);
    assert_eq!(found.coefficients[1].dof, Some(f64::INFINITY));
    // Each correction and residual share the distance to the line.
    for i in 0..x.len() {
        let r = found.residuals[(i, 0)];
        let d = found.input_correction[(i, 0)];
        assert_close(d, r * slope * s * s / (sigma * sigma), 1e-7);
    }
}

/// Fuller (1987), *Measurement Error Models*, equation 1.3.33, for known variances:
/// `Var b = (m_xx σ_vv + σ_uu σ_ee)/(n m_xx²)`, `m_xx` the scatter of the true inputs.
#[test]
fn the_variance_of_a_straight_line_is_fullers() {
    let (x, y) = sample();
    let (s, sigma) = (0.2, 0.3);
    let found = odr(&Line, &line(&x, &y, s, Sigma::Known(sigma)), 0.95).unwrap();
    let n = x.len() as f64;
    let slope = found.coefficients[1].value.unwrap();
    let sigma_vv = sigma * sigma + slope * slope * s * s;
    let estimated: Vec<f64> = (0..x.len()).map(|i| x[i] + found.input_correction[(i, 0)]).collect();
    let mean = estimated.iter().sum::<f64>() / n;
    let scatter: f64 = estimated.iter().map(|x| (x - mean).powi(2)).sum();
    // The estimated inputs scatter by their own error more than the true ones.
    let own = s * s * sigma * sigma / sigma_vv;
    let true_scatter = scatter - n * own;
    let fuller = (true_scatter * sigma_vv + n * s * s * sigma * sigma) / true_scatter.powi(2);
    let variance = found.coefficients[1].standard.unwrap().powi(2);
    // They agree but for the square of the correction, 3 (n own/scatter)² of the variance.
    let correction = n * own / scatter;
    assert!((variance / fuller - 1.0).abs() < 4.0 * correction * correction, "{variance} {fuller}");
    assert!(variance > sigma_vv / scatter * (1.0 + 1.9 * correction));
}

#[test]
fn exact_inputs_make_it_least_squares() {
    let (x, y) = sample();
    let rows: Vec<Vec<f64>> = x.iter().map(|&x| vec![1.0, x]).collect();
    let squares = fit(&single(&rows, &y), &Options::default()).unwrap();
    for s in [0.0, 1e-9] {
        let found = odr(&Line, &line(&x, &y, s, Sigma::Estimated), 0.95).unwrap();
        for (a, b) in found.coefficients.iter().zip(&squares.coefficients) {
            assert_close(a.value.unwrap(), b.value.unwrap(), 1e-9);
            assert_close(a.standard.unwrap(), b.standard.unwrap(), 1e-9);
            assert_close(a.dof.unwrap(), 23.0, 1e-6);
        }
        assert_close(found.sigma[0].sigma, squares.components[0].sigma.unwrap(), 1e-9);
        assert_close(found.sigma[0].dof, 23.0, 1e-6);
    }
}

#[test]
fn derivatives_by_differences_are_those_by_hand() {
    struct ByDifferences;
    impl InputModel for ByDifferences {
        fn n_coefficients(&self) -> usize {
            2
        }
        fn n_components(&self) -> usize {
            1
        }
        fn n_inputs(&self) -> usize {
            1
        }
        fn regressors(&self, _: usize, z: &[f64], out: &mut [f64]) {
            out.copy_from_slice(&[z[0], z[0] * z[0].abs()]);
        }
    }
    let mut out = [0.0; 2];
    ByDifferences.derivatives(0, &[-0.7], &mut out);
    assert_close(out[0], 1.0, 1e-9);
    assert_close(out[1], 1.4, 1e-9);
}

const TRUTH: [f64; 4] = [0.5, 2.0, 1.0, 8.0];

fn campaign(seed: u64, s: [f64; 2], sigma: [f64; 2], kind: [Sigma; 2]) -> OdrProblem {
    let mut rng = rng(seed);
    let settings: Vec<(f64, f64)> =
        (1..=6).flat_map(|u| (1..=7).map(move |a| (0.1 * f64::from(u), 0.15 * f64::from(a)))).collect();
    let n = settings.len();
    let mut inputs = Mat::zeros(n, 2);
    let mut response = Mat::zeros(n, 2);
    let mut x = [0.0; 8];
    for (i, &(u, a)) in settings.iter().enumerate() {
        Towing.regressors(i, &[u, a], &mut x);
        for c in 0..2 {
            let exact: f64 = (0..4).map(|j| x[c * 4 + j] * TRUTH[j]).sum();
            response[(i, c)] = exact + sigma[c] * normal(&mut rng);
        }
        inputs[(i, 0)] = u + s[0] * normal(&mut rng);
        inputs[(i, 1)] = a + s[1] * normal(&mut rng);
    }
    OdrProblem {
        inputs,
        input_standard: Mat::from_fn(n, 2, |_, m| s[m]),
        response,
        sigma: kind.to_vec(),
        components: vec!["f_x".into(), "f_y".into()],
        names: names(4),
    }
}

/// Speed and angle uncertain by 0.01 m/s and 1°: each interval covers, with σ
/// known and with σ estimated beside it; so does σ itself.
#[test]
fn intervals_cover_under_speed_and_angle_error() {
    let repetitions = 600;
    let (s, sigma) = ([0.01, 0.0175], [0.02, 0.05]);
    for kind in [[Sigma::Known(0.02), Sigma::Known(0.05)], [Sigma::Estimated; 2]] {
        let mut counts = [Count::default(); 4];
        let mut mean = [0.0; 2];
        for seed in 0..repetitions {
            let found = odr(&Towing, &campaign(seed, s, sigma, kind), 0.95).unwrap();
            assert_eq!(found.report.end, End::Converged);
            for (j, c) in found.coefficients.iter().enumerate() {
                let [low, high] = c.interval.unwrap();
                counts[j].add(low <= TRUTH[j] && TRUTH[j] <= high);
            }
            for (mean, estimate) in mean.iter_mut().zip(&found.sigma) {
                *mean += estimate.sigma.powi(2) / repetitions as f64;
            }
        }
        let limit = z_limit(0.01, 8);
        for count in counts {
            let z = count.z_score(0.95);
            assert!(z.abs() < limit, "{kind:?} {} ({z})", count.rate());
        }
        for c in 0..2 {
            assert!((mean[c] / sigma[c].powi(2) - 1.0).abs() < 0.1, "{mean:?}");
        }
    }
}

/// Least squares on the same data is not honest: its slope is too small.
#[test]
fn least_squares_is_attenuated_and_this_is_not() {
    let mut squares = 0.0;
    let mut orthogonal = 0.0;
    let repetitions = 200;
    for seed in 0..repetitions {
        let mut rng = rng(500 + seed);
        let (x, y): (Vec<f64>, Vec<f64>) = (0..40)
            .map(|i| {
                let x = 0.1 * f64::from(i);
                (x + 0.5 * normal(&mut rng), 3.0 * x + 0.2 * normal(&mut rng))
            })
            .unzip();
        let rows: Vec<Vec<f64>> = x.iter().map(|&x| vec![1.0, x]).collect();
        squares += fit(&single(&rows, &y), &Options::default()).unwrap().coefficients[1].value.unwrap();
        let found = odr(&Line, &line(&x, &y, 0.5, Sigma::Known(0.2)), 0.95).unwrap();
        orthogonal += found.coefficients[1].value.unwrap();
    }
    let n = repetitions as f64;
    // Attenuation 1/(1 + s²/Var x) with Var x = 1.33.
    assert_close(squares / n, 3.0 / (1.0 + 0.25 / 1.3325), 0.02);
    assert_close(orthogonal / n, 3.0, 0.02);
}

#[test]
fn scatter_explained_by_the_inputs_leaves_sigma_negligible() {
    let mut rng = rng(3);
    let (x, y): (Vec<f64>, Vec<f64>) = (0..30)
        .map(|i| {
            let x = 0.1 * f64::from(i);
            (x + 0.05 * normal(&mut rng), 3.0 * x)
        })
        .unzip();
    // Twice the true input error: nothing is left for σ.
    let found = odr(&Line, &line(&x, &y, 0.1, Sigma::Estimated), 0.95).unwrap();
    assert!(found.sigma[0].sigma < 1e-3, "{:?}", found.sigma);
    assert!((found.coefficients[1].value.unwrap() - 3.0).abs() < 0.15);
}

#[test]
fn what_is_not_determined_has_no_value() {
    struct Parallel;
    impl InputModel for Parallel {
        fn n_coefficients(&self) -> usize {
            3
        }
        fn n_components(&self) -> usize {
            1
        }
        fn n_inputs(&self) -> usize {
            1
        }
        fn regressors(&self, _: usize, z: &[f64], out: &mut [f64]) {
            out.copy_from_slice(&[1.0, z[0], 4.0 * z[0]]);
        }
    }
    let (x, y) = sample();
    let problem = OdrProblem { names: names(3), ..line(&x, &y, 0.1, Sigma::Estimated) };
    let found = odr(&Parallel, &problem, 0.95).unwrap();
    let status: Vec<Status> = found.coefficients.iter().map(|c| c.status).collect();
    assert_eq!(status, [Status::Free, Status::Undetermined, Status::Undetermined]);
    assert!(found.coefficients[1].value.is_none());
}

#[test]
fn bad_input_is_refused_in_words() {
    let (x, y) = sample();
    let words = |problem: &OdrProblem| odr(&Line, problem, 0.95).unwrap_err().to_string();
    let mut bad = line(&x, &y, -1.0, Sigma::Estimated);
    assert_eq!(words(&bad), "the standard deviation of an input is -1; it must be zero or positive, and finite");
    bad = line(&x, &y, 0.1, Sigma::Known(0.0));
    assert_eq!(words(&bad), "a known σ is 0; it must be positive and finite");
    bad = line(&x, &y, 0.1, Sigma::Estimated);
    bad.names.pop();
    assert_eq!(words(&bad), "names has 1 entries where 2 are needed (set by the model)");
    bad = line(&x[..2], &y[..2], 0.1, Sigma::Estimated);
    let left = "has 2 rows for 2 coefficients: none is left to estimate its standard deviation from";
    assert!(words(&bad).ends_with(left), "{}", words(&bad));
}
