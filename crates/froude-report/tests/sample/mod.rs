//! A whole report with invented forces around published coefficients.

use froude_records::comparison::{
    AddedTerms, CoefficientComparison, Comparison, JointComparison, LargestCoefficient, LoadComparison, Side, Verdict,
};
use froude_records::estimate::{
    Coefficient, Diagnostics, Estimate, Frame, Law, Measured, MethodUsed, NamedCorrelation, Range, ReferencePoint,
    Status, TypeA,
};
use froude_records::finding::{Finding, Severity};
use froude_report::{Against, BudgetRow, Curve, InputFile, Observed, Point, Report, SelectionRow, SourceSection};
use indexmap::IndexMap;

/// Names of the coefficients of f1 … f6 in the order of the paper's tables.
const NAMES: [&str; 12] = [
    "C_f", "C_d", "C_f_I", "C_d_I", "C_f_II", "C_d_II", "C_fHT_I", "C_dHT_I", "C_fHT_II", "C_dHT_II", "C_XY_I",
    "C_XY_II",
];

const NONE: f64 = f64::NAN;

/// Tables 5 and 9 of the paper.
#[rustfmt::skip]
const CFD: [(&str, [f64; 12]); 6] = [
    ("f1", [0.0046, 0.1206, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE]),
    ("f2", [NONE, NONE, 0.0, 0.0374, 0.0112, 0.4063, NONE, NONE, NONE, NONE, NONE, NONE]),
    ("f3", [NONE, NONE, 0.0, 0.0191, 0.0066, 0.4064, 0.0, 0.1956, 0.1106, 0.0, NONE, NONE]),
    ("f4", [NONE, NONE, 0.0, 0.0191, 0.0066, 0.4064, 0.0063, 0.1956, 0.1050, 0.0, 0.0055, 0.1957]),
    ("f5", [NONE, NONE, 0.0003, 0.0374, 0.0062, 0.3484, NONE, NONE, 0.1134, 0.6186, NONE, 0.1779]),
    ("f6", [0.2361, 0.4807, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE]),
];
#[rustfmt::skip]
const TANK: [(&str, [f64; 12]); 6] = [
    ("f1", [0.0207, 0.3268, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE]),
    ("f2", [NONE, NONE, 0.0, 0.0603, 0.0544, 1.8601, NONE, NONE, NONE, NONE, NONE, NONE]),
    ("f3", [NONE, NONE, 0.0, 0.0, 0.0133, 1.4272, 0.0, 0.1769, 0.2602, 1.1770, NONE, NONE]),
    ("f4", [NONE, NONE, 0.0, 0.0, 0.0133, 1.4272, 0.0148, 0.1769, 0.2451, 1.1770, 0.0351, 0.4612]),
    ("f5", [NONE, NONE, 0.0032, 0.0602, 0.0088, 1.1142, NONE, NONE, 0.2675, 2.0963, NONE, 0.2963]),
    ("f6", [0.3363, 1.6066, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE]),
];
#[rustfmt::skip]
const TOWING: [(&str, [f64; 12]); 2] = [
    ("f3", [NONE, NONE, 0.0109, 0.0, 0.0149, 1.5249, 0.0, 0.0795, 0.2363, 1.8852, NONE, NONE]),
    ("f4", [NONE, NONE, 0.0152, 0.0, 0.0045, 1.5249, 0.0, 0.0795, 0.2498, 1.8852, 0.0870, 0.8704]),
];

/// A small generator of even numbers between 0 and 1, the same on every machine.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Nearly normal: the sum of twelve, less six.
    fn noise(&mut self) -> f64 {
        (0..12).map(|_| self.roll()).sum::<f64>() - 6.0
    }
}

/// Force of f4 on a body of k links, along x and y.
fn force(c: &[f64; 12], k: f64, speed: f64, angle: f64) -> [f64; 2] {
    let (rho, a, b, l) = (1000.0, 0.0588, 0.0394, 0.09);
    let pi = std::f64::consts::PI;
    let (g_t, g_n) = (0.5 * rho * pi * 0.5 * (a + b) * 2.0 * l, 0.5 * rho * 2.0 * a * 2.0 * l);
    let (g_htx, g_hty, g_xy) = (0.5 * rho * pi * a * b, 0.5 * rho * 0.019, rho * a * l);
    let (vx, vy) = (speed * angle.cos(), -speed * angle.sin());
    let q = |v: f64| v * v.abs();
    let fx = k * g_t * (c[2] * vx + c[4] * q(vx))
        + g_htx * (c[6] * vx + c[8] * q(vx))
        + g_xy * (-c[10] * vy.abs() + c[11] * vy * vy);
    let fy = k * g_n * (c[3] * vy + c[5] * q(vy)) + g_hty * (c[7] * vy + c[9] * q(vy));
    [-fx, -fy]
}

fn coefficient(value: f64, relative: f64, name: &str) -> Coefficient {
    if value == 0.0 {
        return Coefficient {
            interval_95: Some([0.0, 0.0117]),
            ..Coefficient::of(Some(0.0), unit_of(name), Status::AtBound)
        };
    }
    let u = (value.abs() * relative).max(0.0008);
    Coefficient {
        standard_uncertainty: Some(u),
        type_a: Some(u * 0.8),
        type_b: Some(u * 0.6),
        interval_95: Some([(value - 2.01 * u).max(0.0), value + 2.01 * u]),
        effective_dof: Some(57.3),
        ..Coefficient::of(Some(value), unit_of(name), Status::Free)
    }
}

fn unit_of(name: &str) -> &'static str {
    if name.ends_with("_I") { "m/s" } else { "1" }
}

fn estimates(source: &str, kind: &str, table: &[(&str, [f64; 12])], relative: f64, best: &str) -> Vec<Estimate> {
    table
        .iter()
        .map(|(model, values)| {
            let coefficients: IndexMap<String, Coefficient> = NAMES
                .iter()
                .zip(values)
                .filter(|(_, v)| !v.is_nan())
                .enumerate()
                .map(|(i, (name, v))| {
                    ((*name).to_owned(), coefficient(*v, relative * (1.0 + 0.4 * (i % 4) as f64), name))
                })
                .collect();
            let names: Vec<String> = coefficients.keys().cloned().collect();
            let quality = match *model {
                "f4" => 1.0,
                "f3" => 1.9,
                "f5" => 1.4,
                "f2" => 3.3,
                _ => 5.1,
            };
            Estimate {
                id: format!("{source}/{model}"),
                source: source.to_owned(),
                kind: kind.to_owned(),
                law: Law {
                    constants: [("v_ref".to_owned(), Measured::of(1.0, "m/s"))].into(),
                    name: (*model).to_owned(),
                    version: 1,
                    ..Law::default()
                },
                refers_to: [
                    ("density".to_owned(), Measured::of(998.2, "kg/m^3")),
                    ("major_semi_axis".to_owned(), Measured::of(0.0588, "m")),
                    ("minor_semi_axis".to_owned(), Measured::of(0.0394, "m")),
                    ("half_length".to_owned(), Measured::of(0.09, "m")),
                ]
                .into(),
                frame: Frame::body(),
                point: ReferencePoint { words: "centre of the body".to_owned(), stated: true },
                method: MethodUsed {
                    words: "least squares, bounded below by zero, per load component".to_owned(),
                    ..MethodUsed::default()
                },
                dof: [("f_x".to_owned(), Some(284.0 - names.len() as f64)), ("f_y".to_owned(), Some(286.0))].into(),
                sigma: [
                    ("f_x".to_owned(), Measured::of(0.0213 * quality, "N")),
                    ("f_y".to_owned(), Measured::of(0.0498 * quality, "N")),
                ]
                .into(),
                n_observations: 268,
                type_a: Some(TypeA {
                    matrix: vec![vec![0.0; names.len()]; names.len()],
                    dof: vec![None; names.len()],
                    names,
                    kind: if kind == "cfd" { "CR3 by configuration" } else { "classical" }.to_owned(),
                }),
                coefficients,
                validity: [
                    ("speed".to_owned(), Range::of([0.1, 1.0], "m/s")),
                    ("angle".to_owned(), Range::of([0.0, 39f64.to_radians()], "rad")),
                    ("Reynolds number".to_owned(), Range::of([5.39e4, 5.39e5], "1")),
                    ("Froude number by depth".to_owned(), Range::of([0.032, 0.319], "1")),
                    ("blockage".to_owned(), Range::of([0.0012, 0.0093], "1")),
                ]
                .into(),
                diagnostics: Diagnostics {
                    condition_number: Some(18.4 * quality),
                    largest_correlation: Some(NamedCorrelation {
                        first: "C_f_II".to_owned(),
                        second: "C_fHT_II".to_owned(),
                        value: -0.913,
                    }),
                    relative_residual: [("f_x".to_owned(), 0.031 * quality), ("f_y".to_owned(), 0.022 * quality)]
                        .into(),
                    durbin_watson: [("f_x".to_owned(), 1.93), ("f_y".to_owned(), 2.04)].into(),
                    largest_power_w: Some(-1.2e-4),
                    ..Diagnostics::default()
                },
                recommended: *model == best,
                not_contradicted: Vec::new(),
                ..Estimate::default()
            }
        })
        .collect()
}

fn loads(
    configurations: &[usize],
    c: &[f64; 12],
    sigma: f64,
    step: usize,
    most: usize,
    seed: u64,
) -> (Vec<Point>, Vec<Curve>) {
    let mut dice = Dice(seed);
    let mut points = Vec::new();
    let mut curves = Vec::new();
    for &k in configurations {
        let configuration = format!("H{k}LT");
        let mut places: Vec<(f64, f64)> = (1..=10).map(|i| (f64::from(i) * 0.1, 0.0)).collect();
        for speed in [0.1, 0.2, 0.3, 0.4] {
            places.extend((0..=most).step_by(step).map(|a| (speed, (a as f64).to_radians())));
        }
        let bodies = k as f64;
        let twice: Vec<(f64, f64)> = places.iter().chain(&places).copied().collect();
        for (speed_m_s, angle_rad) in twice {
            let fitted = force(c, bodies, speed_m_s, angle_rad);
            for (i, component) in ["f_x", "f_y"].into_iter().enumerate() {
                let u = sigma * (1.0 + i as f64);
                points.push(Point {
                    of: Observed {
                        configuration: configuration.clone(),
                        component: component.to_owned(),
                        unit: "N".to_owned(),
                        other: None,
                    }
                    .into(),
                    speed_m_s,
                    angle_rad,
                    other: 0.0,
                    measured: fitted[i] + u * dice.noise(),
                    standard: Some(u),
                    fitted: fitted[i],
                });
            }
        }
        for (i, component) in ["f_x", "f_y"].into_iter().enumerate() {
            let mut curve = |against: Against, x: Vec<f64>, at: &dyn Fn(f64) -> [f64; 2], model: &str| {
                let scale = if model == "f2" { 0.9 } else { 1.0 };
                let y: Vec<f64> = x.iter().map(|x| at(*x)[i] * scale).collect();
                let half = |y: &f64| 0.02 + 0.05 * y.abs();
                curves.push(Curve {
                    configuration: configuration.clone(),
                    component: component.to_owned(),
                    unit: "N".to_owned(),
                    model: model.to_owned(),
                    against,
                    held: Vec::new(),
                    low: y.iter().map(|y| y - half(y)).collect(),
                    high: y.iter().map(|y| y + half(y)).collect(),
                    x,
                    y,
                });
            };
            for degrees in [0.0, 15.0, 30.0, 39.0f64] {
                let angle = degrees.to_radians();
                let end = if degrees == 0.0 { 1.0 } else { 0.4 };
                let x = (0..=40).map(|i| f64::from(i) / 40.0 * end).collect();
                curve(Against::Speed { angle_rad: angle }, x, &|v| force(c, bodies, v, angle), "f4");
            }
            for speed in [0.1, 0.2, 0.3, 0.4] {
                let x = (0..=45).map(|i| (f64::from(i) / 45.0 * most as f64).to_radians()).collect();
                curve(Against::Angle { speed_m_s: speed }, x, &|a| force(c, bodies, speed, a), "f4");
            }
        }
    }
    (points, curves)
}

fn budget(model: &str, e: &Estimate) -> Vec<BudgetRow> {
    let mut rows = Vec::new();
    for (i, (name, c)) in e.coefficients.iter().enumerate() {
        let Some(u) = c.standard_uncertainty else { continue };
        let tilt = 0.06 * (i % 5) as f64;
        let parts = [
            ("scatter", "", 0.46 - tilt),
            ("f_x, f_y calibration", "campaign", 0.27 + tilt / 2.0),
            ("zero of the force sensor", "setup", 0.14),
            ("speed", "campaign", 0.08 + tilt / 2.0),
            ("angle", "setup", 0.05),
        ];
        for (input, shared, share) in parts {
            rows.push(BudgetRow {
                model: model.to_owned(),
                coefficient: name.clone(),
                input: input.to_owned(),
                shared: shared.to_owned(),
                contribution: u * share.sqrt(),
                unit: c.unit.clone(),
                share,
            });
        }
    }
    rows
}

fn selection(is_scorable: bool) -> Vec<SelectionRow> {
    let mut rows = Vec::new();
    for (component, sigma) in [("f_x", 0.0213), ("f_y", 0.0498)] {
        for (model, n, factor, delta) in [
            ("f1", 1, 5.1, 812.4),
            ("f2", 2, 3.3, 541.0),
            ("f3", 4, 1.9, 203.7),
            ("f4", 5, 1.0, 0.0),
            ("f5", 3, 1.4, 97.2),
            ("f6", 1, 4.7, 760.9),
        ] {
            rows.push(SelectionRow {
                model: model.to_owned(),
                component: component.to_owned(),
                n_coefficients: n,
                sigma: sigma * factor,
                unit: "N".to_owned(),
                relative_residual: 0.02 * factor,
                delta_aicc: Ok(delta),
                cross_validation: if is_scorable {
                    Ok(sigma * factor * 1.1)
                } else {
                    Err("leaving one configuration out needs at least three, this source has two".to_owned())
                },
                range_blocks: vec![("angle > 30°".to_owned(), sigma * factor * 1.4)],
                lack_of_fit_p: Some(if model == "f4" { 0.31 } else { 1e-5 }),
            });
        }
    }
    rows
}

fn tests() -> Vec<AddedTerms> {
    [
        ("f1", "f2", 310.2, 1e-9),
        ("f2", "f3", 96.1, 1e-9),
        ("f3", "f4", 14.9, 4e-7),
        ("f6", "f5", 201.0, 1e-9),
        ("f5", "f4", 1.81, 0.166),
    ]
    .into_iter()
    .map(|(law, of, f, p)| AddedTerms {
        law: law.to_owned(),
        of: of.to_owned(),
        component: "f_x".to_owned(),
        f,
        dof: [2.0, 263.0],
        p,
    })
    .collect()
}

fn section(
    name: &str,
    kind: &str,
    table: &[(&str, [f64; 12])],
    configurations: &[usize],
    relative: f64,
    seed: u64,
) -> SourceSection {
    let estimates = estimates(name, kind, table, relative, "f4");
    let f4 =
        table.iter().find(|(m, _)| *m == "f4").map_or([0.0; 12], |(_, c)| c.map(|x| if x.is_nan() { 0.0 } else { x }));
    let most = if kind == "cfd" { 90 } else { 39 };
    let (points, curves) = loads(configurations, &f4, if kind == "cfd" { 0.004 } else { 0.02 }, 3, most, seed);
    let best = estimates.iter().find(|e| e.recommended).cloned();
    SourceSection {
        not_fitted: Vec::new(),
        name: name.to_owned(),
        kind: kind.to_owned(),
        facts: vec![
            (
                "Configurations".to_owned(),
                configurations.iter().map(|k| format!("H{k}LT")).collect::<Vec<_>>().join(", "),
            ),
            ("Kept rows".to_owned(), "angle ≤ 39°".to_owned()),
        ],
        budget: best.as_ref().map(|e| budget("f4", e)).unwrap_or_default(),
        estimates,
        points,
        sample_of: None,
        curves,
        selection: selection(configurations.len() > 2),
        tests: tests(),
        recommendation:
            "f4: every restriction to a simpler model is contradicted by the F tests (p < 0.001) except f5 in f4 \
                         (p = 0.166), and f4 predicts the range block above 30° best."
                .to_owned(),
    }
}

/// The report.
pub fn report() -> Report {
    let published = |source: &str, table: &[(&str, [f64; 12])]| -> Vec<Estimate> {
        estimates(source, "published", table, 0.0, "")
            .into_iter()
            .map(|mut e| {
                for c in e.coefficients.values_mut() {
                    if c.status == Status::Free {
                        c.status = Status::Fixed;
                    }
                    (c.standard_uncertainty, c.type_a, c.type_b, c.interval_95, c.effective_dof) =
                        (None, None, None, None, None);
                }
                e.sigma.clear();
                e.dof.clear();
                e.validity.clear();
                e.n_observations = 0;
                e.diagnostics = Diagnostics::default();
                e.type_a = None;
                e
            })
            .collect()
    };
    let mut sources = vec![
        section("circulation tank", "tank", &TANK, &[1, 2], 0.04, 7),
        section("CFD", "cfd", &CFD, &[1, 2, 3, 4, 5, 6, 7, 8, 9], 0.06, 11),
        section("towing rig", "towing", &TOWING, &[1], 0.09, 23),
    ];
    // One configuration does not tell link and head/tail apart.
    if let Some(towing) = sources.get_mut(2) {
        for e in &mut towing.estimates {
            for name in ["C_f_I", "C_f_II", "C_fHT_I", "C_fHT_II", "C_d_I", "C_d_II", "C_dHT_I", "C_dHT_II"] {
                if let Some(c) = e.coefficients.get_mut(name) {
                    c.value = None;
                    c.status = Status::Undetermined;
                    (c.standard_uncertainty, c.type_a, c.type_b, c.interval_95, c.effective_dof) =
                        (None, None, None, None, None);
                }
            }
            e.undetermined =
                vec!["k*G_T*C_f_II + G_HTx*C_fHT_II".to_owned(), "k*G_N*C_d_II + G_HTy*C_dHT_II".to_owned()];
            e.diagnostics.notes =
                vec!["one configuration: head/tail columns are parallel to the link columns".to_owned()];
        }
        towing.budget.retain(|r| r.coefficient.starts_with("C_XY"));
        "No coefficient of link, head and tail is determined by one configuration; add a second length."
            .clone_into(&mut towing.recommendation);
    }
    let mut all = published("Kelasidi et al., circulation tank", &TANK);
    all.extend(published("Kelasidi et al., CFD", &CFD));
    all.extend(published("Kelasidi et al., towing rig", &TOWING));
    let side = |source: &str, value: f64, standard: Option<f64>| Side {
        source: source.to_owned(),
        value: Some(value),
        standard_uncertainty: standard,
        expanded_uncertainty: standard.map(|u| 2.0 * u),
        ..Side::default()
    };
    Report {
        blocks: Vec::new(),
        title: "Mamba in the circulation tank".to_owned(),
        subtitle: "Drag coefficients of an underwater snake robot from tank, CFD and towing (invented sample)".to_owned(),
        date: Some("21 November 2026".to_owned()),
        method: vec![
            "Steady forces on the body were regressed on the whole-robot drag models f1 to f6 (Kelasidi et al., eq. 9 to 14), \
             each load component with its own residual variance and degrees of freedom. Coefficients are bounded below by zero; \
             the interval of a coefficient at its bound is the unconstrained t-interval cut by the bound."
                .to_owned(),
            "Uncertainties follow the GUM: type A from the scatter, type B from the declared sensor budget. Errors shared by a \
             setup or a campaign do not average down with the number of observations."
                .to_owned(),
        ],
        sources,
        published: all,
        findings: vec![
            Finding::new(
                Severity::Warning,
                "one-sided-angle",
                "only angles θ ≥ 0 were run (0° to 39°): an angle offset of 1° between sensor and body moves C_XY_II by 0.3 to 0.5 and cannot be \
                 distinguished from it; run a few points at −θ"
                    .to_owned(),
            )
            .of_source("circulation tank"),
            Finding::new(
                Severity::Error,
                "volume-not-additive",
                "volume of H1LT is 1.893e-3 m³, head, tail and one link add up to 1.897e-3 m³; steps from H1LT to H2LT contradict both".to_owned(),
            ),
            Finding::new(Severity::Note, "identical-copies", "4 rows are exact copies of others and were dropped".to_owned()).of_source("CFD"),
            Finding {
                place: Some("tank.csv:118".to_owned()),
                ..Finding::new(Severity::Warning, "force-along-motion", "f_x = +0.012 N at v_x = 0.10 m/s pushes the body forward".to_owned())
                    .of_source("circulation tank")
            },
        ],
        data: vec![
            InputFile {
                path: "tank.csv".to_owned(),
                sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08".to_owned(),
                n_rows: Some(268),
                n_used: Some(264),
                source: Some("circulation tank".to_owned()),
            },
            InputFile {
                path: "cfd/forces.parquet".to_owned(),
                sha256: "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752".to_owned(),
                n_rows: Some(15_660),
                n_used: Some(15_656),
                source: Some("CFD".to_owned()),
            },
        ],
        versions: [("froude".to_owned(), "0.1.0".to_owned()), ("rustc".to_owned(), "1.95.0".to_owned())].into(),
        citations: vec![
            "E. Kelasidi, G. Elgenes, H. Kilvær: Fluid parameter identification for underwater snake robots. Proc. OMAE, 2018.".to_owned(),
            "The Froude developers: Froude 0.1.0.".to_owned(),
        ],
        comparison: Some(Comparison {
            verdicts: vec![Verdict {
                first: "circulation tank".to_owned(),
                second: "CFD".to_owned(),
                agree: false,
                load: None,
                coefficient: Some(LargestCoefficient { coefficient: "C_d_II".to_owned(), e_n: 8.25 }),
                p: Some(1e-12),
            }],
            coefficients: vec![
                CoefficientComparison {
                    model: "f4".to_owned(),
                    coefficient: "C_d_II".to_owned(),
                    label: None,
                    unit: "1".to_owned(),
                    first: side("circulation tank", 1.4272, Some(0.057)),
                    second: side("CFD", 0.4064, Some(0.024)),
                    e_n: Some(8.25),
                    note: String::new(),
                },
                CoefficientComparison {
                    model: "f4".to_owned(),
                    coefficient: "C_XY_II".to_owned(),
                    label: None,
                    unit: "1".to_owned(),
                    first: side("circulation tank", 0.4612, Some(0.14)),
                    second: side("CFD", 0.1957, Some(0.04)),
                    e_n: Some(0.91),
                    note: String::new(),
                },
                CoefficientComparison {
                    model: "f4".to_owned(),
                    coefficient: "C_XY_II".to_owned(),
                    label: None,
                    unit: "1".to_owned(),
                    first: side("circulation tank", 0.4612, Some(0.14)),
                    second: side("Kelasidi et al., circulation tank", 0.4612, None),
                    e_n: None,
                    note: "no uncertainty stated".to_owned(),
                },
            ],
            joint: vec![JointComparison {
                model: "f4".to_owned(),
                first: "circulation tank".to_owned(),
                second: "CFD".to_owned(),
                chi_squared: Some(412.7),
                dof: Some(7),
                p: Some(1e-12),
                note: "the two do not measure the same".to_owned(),
            }],
            loads: [0.1, 0.2, 0.3, 0.4]
                .into_iter()
                .flat_map(|speed| {
                    [(0, "f_x"), (1, "f_y")].map(|(i, component)| {
                        let angle: f64 = 30f64.to_radians();
                        let (a, b) = (force(&TANK[3].1, 1.0, speed, angle)[i], force(&CFD[3].1, 1.0, speed, angle)[i]);
                        let (ua, ub) = (0.01 + 0.02 * a.abs(), 0.005 + 0.03 * b.abs());
                        LoadComparison {
                            n_links: Some(1.0),
                            component: component.to_owned(),
                            unit: "N".to_owned(),
                            speed_m_s: speed,
                            angle_rad: angle,
                            first: side("circulation tank", a, Some(ua)),
                            second: side("CFD", b, Some(ub)),
                            e_n: Some((a - b) / (2.0 * ua.hypot(ub))),
                            note: String::new(),
                        }
                    })
                })
                .collect(),
            validation: Vec::new(),
            coverage: vec![
                "circulation tank: k = 2.00 (Student's t, effective degrees of freedom 57.3)".to_owned(),
                "CFD: k = 2.00 (Student's t, effective degrees of freedom 57.3)".to_owned(),
            ],
            findings: vec![Finding::new(
                Severity::Note,
                "not-compared",
                "f3 of the towing rig is not determined and was not compared.".to_owned(),
            )],
        }),
    }
}
