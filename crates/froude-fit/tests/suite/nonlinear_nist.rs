//! NIST Statistical Reference Datasets, non-linear regression: certified values, from both starts.
//!
//! <https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml>

use froude_fit::End;
use froude_fit::nonlinear::{Model, Parameter, Scatter, Settings, minimise};

/// The iteration stops below 1e-9 of a standard deviation or where the sum of squares has no digits left, 1e-6 of one at worst; the least
/// certain parameter here is known to its own size, the others to 0.001 of it or so. Seven digits prove data and minimum.
const PARAMETER: f64 = 1e-7;
/// Derivatives by differences of 1e-4 of a standard deviation are right to its square, 1e-8, times curvature; two of them in a variance.
const STANDARD: f64 = 1e-6;
/// The residual standard deviation moves by the square of what the parameters are off: eleven certified digits, half a unit in the last.
const SIGMA: f64 = 5e-11;

type Curve = fn(&[f64], f64) -> f64;

/// One data set: `(y, x)`, two starts, certified `(parameter, standard deviation)`, residual standard deviation.
struct Nist {
    name: &'static str,
    curve: Curve,
    data: &'static [(f64, f64)],
    starts: [&'static [f64]; 2],
    certified: &'static [(f64, f64)],
    sigma: f64,
}

impl Model for Nist {
    fn runs(&self) -> usize {
        1
    }

    fn residuals(&self, _: usize, theta: &[f64]) -> Option<Vec<f64>> {
        Some(self.data.iter().map(|&(y, x)| y - (self.curve)(theta, x)).collect())
    }
}

#[rustfmt::skip]
const SETS: [Nist; 7] = [
    Nist {
        name: "Misra1a, lower difficulty",
        curve: |b, x| b[0] * (1.0 - (-b[1] * x).exp()),
        data: &[
            (10.07, 77.6), (14.73, 114.9), (17.94, 141.1), (23.93, 190.8), (29.61, 239.9), (35.18, 289.0), (40.02, 332.8),
            (44.82, 378.4), (50.76, 434.8), (55.05, 477.3), (61.01, 536.8), (66.40, 593.1), (75.47, 689.1), (81.78, 760.0),
        ],
        starts: [&[500.0, 0.0001], &[250.0, 0.0005]],
        certified: &[(2.3894212918e2, 2.7070075241), (5.5015643181e-4, 7.2668688436e-6)],
        sigma: 1.0187876330e-1,
    },
    Nist {
        name: "DanWood, lower difficulty",
        curve: |b, x| b[0] * x.powf(b[1]),
        data: &[(2.138, 1.309), (3.421, 1.471), (3.597, 1.490), (4.340, 1.565), (4.882, 1.611), (5.660, 1.680)],
        starts: [&[1.0, 5.0], &[0.7, 4.0]],
        certified: &[(7.6886226176e-1, 1.8281973860e-2), (3.8604055871, 5.1726610913e-2)],
        sigma: 3.2853114039e-2,
    },
    Nist {
        name: "MGH17, average difficulty",
        curve: |b, x| b[0] + b[1] * (-x * b[3]).exp() + b[2] * (-x * b[4]).exp(),
        data: &[
            (0.844, 0.0), (0.908, 10.0), (0.932, 20.0), (0.936, 30.0), (0.925, 40.0), (0.908, 50.0), (0.881, 60.0),
            (0.850, 70.0), (0.818, 80.0), (0.784, 90.0), (0.751, 100.0), (0.718, 110.0), (0.685, 120.0), (0.658, 130.0),
            (0.628, 140.0), (0.603, 150.0), (0.580, 160.0), (0.558, 170.0), (0.538, 180.0), (0.522, 190.0), (0.506, 200.0),
            (0.490, 210.0), (0.478, 220.0), (0.467, 230.0), (0.457, 240.0), (0.448, 250.0), (0.438, 260.0), (0.431, 270.0),
            (0.424, 280.0), (0.420, 290.0), (0.414, 300.0), (0.411, 310.0), (0.406, 320.0),
        ],
        starts: [&[50.0, 150.0, -100.0, 1.0, 2.0], &[0.5, 1.5, -1.0, 0.01, 0.02]],
        certified: &[
            (3.7541005211e-1, 2.0723153551e-3), (1.9358469127, 2.2031669222e-1), (-1.4646871366, 2.2175707739e-1),
            (1.2867534640e-2, 4.4861358114e-4), (2.2122699662e-2, 8.9471996575e-4),
        ],
        sigma: 1.3970497866e-3,
    },
    Nist {
        name: "MGH09, higher difficulty",
        curve: |b, x| b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]),
        data: &[
            (0.1957, 4.0), (0.1947, 2.0), (0.1735, 1.0), (0.16, 0.5), (0.0844, 0.25), (0.0627, 0.167), (0.0456, 0.125),
            (0.0342, 0.1), (0.0323, 0.0833), (0.0235, 0.0714), (0.0246, 0.0625),
        ],
        starts: [&[25.0, 39.0, 41.5, 39.0], &[0.25, 0.39, 0.415, 0.39]],
        certified: &[
            (1.9280693458e-1, 1.1435312227e-2), (1.9128232873e-1, 1.9633220911e-1), (1.2305650693e-1, 8.0842031232e-2),
            (1.3606233068e-1, 9.0025542308e-2),
        ],
        sigma: 6.6279236551e-3,
    },
    Nist {
        name: "MGH10, higher difficulty",
        curve: |b, x| b[0] * (b[1] / (x + b[2])).exp(),
        data: &[
            (34780.0, 50.0), (28610.0, 55.0), (23650.0, 60.0), (19630.0, 65.0), (16370.0, 70.0), (13720.0, 75.0),
            (11540.0, 80.0), (9744.0, 85.0), (8261.0, 90.0), (7030.0, 95.0), (6005.0, 100.0), (5147.0, 105.0),
            (4427.0, 110.0), (3820.0, 115.0), (3307.0, 120.0), (2872.0, 125.0),
        ],
        starts: [&[2.0, 400000.0, 25000.0], &[0.02, 4000.0, 250.0]],
        certified: &[(5.6096364710e-3, 1.5687892471e-4), (6.1813463463e3, 2.3309021107e1), (3.4522363462e2, 7.8486103508e-1)],
        sigma: 2.6009740065,
    },
    Nist {
        name: "Rat42, higher difficulty",
        curve: |b, x| b[0] / (1.0 + (b[1] - b[2] * x).exp()),
        data: &[
            (8.93, 9.0), (10.80, 14.0), (18.59, 21.0), (22.33, 28.0), (39.35, 42.0), (56.11, 57.0), (61.73, 63.0),
            (64.62, 70.0), (67.08, 79.0),
        ],
        starts: [&[100.0, 1.0, 0.1], &[75.0, 2.5, 0.07]],
        certified: &[(7.2462237576e1, 1.7340283401), (2.6180768402, 8.8295217536e-2), (6.7359200066e-2, 3.4465663377e-3)],
        sigma: 1.1587725499,
    },
    Nist {
        name: "Rat43, higher difficulty",
        curve: |b, x| b[0] / (1.0 + (b[1] - b[2] * x).exp()).powf(1.0 / b[3]),
        data: &[
            (16.08, 1.0), (33.83, 2.0), (65.80, 3.0), (97.20, 4.0), (191.55, 5.0), (326.20, 6.0), (386.87, 7.0),
            (520.53, 8.0), (590.03, 9.0), (651.92, 10.0), (724.93, 11.0), (699.56, 12.0), (689.96, 13.0), (637.56, 14.0),
            (717.41, 15.0),
        ],
        starts: [&[100.0, 10.0, 1.0, 1.0], &[700.0, 5.0, 0.75, 1.3]],
        certified: &[
            (6.9964151270e2, 1.6302297817e1), (5.2771253025, 2.0828735829), (7.5962938329e-1, 1.9566123451e-1),
            (1.2792483859, 6.8761936385e-1),
        ],
        sigma: 2.8262414662e1,
    },
];

/// MGH10 from 400,000 instead of 6,181: a thousand steps do not reach the minimum, and the report must not say that they do.
const TOO_FAR: (&str, usize) = ("MGH10, higher difficulty", 0);

/// Scales are the certified standard deviations: what a plot would show.
#[test]
fn seven_problems_give_the_certified_digits() {
    let settings = Settings { offset: 1e-9, iterations: 1000, ..Settings::default() };
    for set in &SETS {
        for (k, start) in set.starts.iter().enumerate() {
            let parameters: Vec<Parameter> = (start.iter().zip(set.certified).enumerate())
                .map(|(j, (&start, &(_, scale)))| Parameter::new(format!("b{}", j + 1), start, scale))
                .collect();
            let found = minimise(set, &parameters, &settings).unwrap();
            let name = format!("{}, start {}, {:?}", set.name, k + 1, found.report);
            if (set.name, k) == TOO_FAR {
                assert_eq!(found.report.end, End::IterationLimit, "{name}");
                continue;
            }
            assert_eq!(found.report.end, End::Converged, "{name}");
            let covariance = found.covariance(Scatter::Independent).unwrap();
            for (j, &(value, standard)) in set.certified.iter().enumerate() {
                let off = found.values[j] / value - 1.0;
                assert!(off.abs() < PARAMETER, "{name}: b{} off by {off:.1e}", j + 1);
                let off = covariance.standard(j).unwrap() / standard - 1.0;
                assert!(off.abs() < STANDARD, "{name}: standard deviation of b{} off by {off:.1e}", j + 1);
            }
            let off = found.sigma().unwrap() / set.sigma - 1.0;
            assert!(off.abs() < SIGMA, "{name}: σ off by {off:.1e}");
        }
    }
}
