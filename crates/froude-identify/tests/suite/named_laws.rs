//! Laws by name: coefficients of published and own bodies out of small tables with scatter, and what is said where a table lacks something.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use froude_fit::coverage::{Count, z_limit};
use froude_identify::IdentifyError;
use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::Estimate;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Tables of a law. That the intervals of one coefficient hold its truth in all of them is chance enough (0.6 %); that those of all coefficients do is not.
const SEEDS: u128 = 100;
/// Chance of a rate beyond the limits among all coefficients of all laws, where each interval holds its truth in 95 of 100.
const FAMILY_WISE: f64 = 0.01;

fn result(text: &str, keys: &str) -> Result<SourceResult, IdentifyError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), text).unwrap();
    std::fs::write(folder.path().join("c.toml"), format!("schema = 1\nname = \"a\"\n{keys}")).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    identify_source(&campaign, &campaign.sources[0], &|_| {})
}

fn source(law: &str) -> String {
    format!("[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"{law}\"]\n")
}

/// A body in a table: what is set, what it does, and what is known of it.
struct Case {
    law: &'static str,
    /// Sections of the campaign before the source.
    keys: &'static str,
    header: &'static str,
    /// Settings, one a row.
    settings: Vec<Vec<f64>>,
    /// Its loads in a setting.
    loads: fn(&[f64]) -> Vec<f64>,
    noise: &'static [f64],
    truths: &'static [(&'static str, f64)],
}

impl Case {
    fn table(&self, seed: u128) -> String {
        let mut rng = Pcg64::new(seed, 5);
        let mut out = format!("{}\n", self.header);
        for setting in &self.settings {
            let scattered = (self.loads)(setting).into_iter().zip(self.noise).map(|(load, standard)| {
                let z: f64 = StandardNormal.sample(&mut rng);
                load + standard * z
            });
            let cells: Vec<String> = setting.iter().copied().chain(scattered).map(|x| x.to_string()).collect();
            writeln!(out, "{}", cells.join(",")).unwrap();
        }
        out
    }

    /// How often the interval of each coefficient holds the truth; a truth by the name of a prime is one of the record's derived numbers.
    fn coverage(&self) -> Vec<Count> {
        let of = |seed: u128| -> Vec<bool> {
            let found = result(&self.table(seed), &format!("{}{}", self.keys, source(self.law))).unwrap();
            let estimate: &Estimate = &found.estimates[0];
            let is_held = |(name, truth): &(&str, f64)| {
                let prime = || estimate.derived[*name].interval_95;
                let interval = estimate.coefficients.get(*name).map_or_else(prime, |c| c.interval_95);
                let [low, high] = interval.unwrap_or_else(|| panic!("{} has no interval of {name}", self.law));
                low <= *truth && *truth <= high
            };
            self.truths.iter().map(is_held).collect()
        };
        let held: Vec<Vec<bool>> = (1..=SEEDS).into_par_iter().map(of).collect();
        let mut counts = vec![Count::default(); self.truths.len()];
        for held in &held {
            counts.iter_mut().zip(held).for_each(|(count, is_held)| count.add(*is_held));
        }
        counts
    }
}

/// Every combination of some values.
fn grid(axes: &[&[f64]]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |rows, axis| {
        rows.iter().flat_map(|row| axis.iter().map(move |x| [row.as_slice(), &[*x]].concat())).collect()
    })
}

/// `n` rows that fill a box evenly, by Weyl's sequences.
fn filled(n: u32, half: &[f64]) -> Vec<Vec<f64>> {
    let primes = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0];
    let at =
        |i: u32| half.iter().zip(primes).map(move |(half, p)| half * (2.0 * (f64::from(i) * p.sqrt()).fract() - 1.0));
    (1..=n).map(|i| at(i).collect()).collect()
}

fn sq(x: f64) -> f64 {
    x * x.abs()
}

const FRESH: &str = "[fluid]\ndensity = \"1000 kg/m^3\"\n";

fn cases() -> Vec<Case> {
    vec![
        Case {
            law: "oblique",
            keys: "",
            header: "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]",
            settings: grid(&[&[0.5, 1.0, 1.5], &[-12.0, -6.0, 0.0, 6.0, 12.0]]),
            loads: |s| {
                let (sin, cos) = s[1].to_radians().sin_cos();
                let (u, v) = (s[0] * cos, -s[0] * sin);
                vec![-4.2 * u * u, -6.0 * v - 28.0 * u * v - 115.0 * sq(v), -1.5 * v - 14.0 * u * v + 3.0 * sq(v)]
            },
            noise: &[0.03, 0.08, 0.02],
            truths: &[
                ("X_uu", -4.2),
                ("Y_v", -6.0),
                ("Y_uv", -28.0),
                ("Y_vv", -115.0),
                ("N_v", -1.5),
                ("N_uv", -14.0),
                ("N_vv", 3.0),
            ],
        },
        Case {
            law: "fossen_3dof",
            keys: "",
            header: "v_x [m/s],v_y [m/s],w_z [rad/s],v_x_dot [m/s^2],v_y_dot [m/s^2],w_z_dot [rad/s^2],f_x [N],f_y [N],m_z [N m]",
            settings: filled(60, &[0.5, 0.4, 0.3, 0.2, 0.2, 0.2]),
            loads: |s| {
                let [u, v, r, du, dv, dr] = s else { panic!() };
                let y = -170.0 * dv - 8.0 * dr - 220.0 * v + 60.0 * r - 300.0 * sq(*v) - 40.0 * r.abs() * v;
                let n = -8.0 * dv - 110.0 * dr - 130.0 * v - 190.0 * r - 60.0 * sq(*r) + 25.0 * v.abs() * r;
                // X_A = X_u̇ u̇ − Y_v̇ v r − Y_ṙ r².
                let x = -30.0 * du - 12.0 * u - 80.0 * sq(*u) + 170.0 * v * r + 8.0 * r * r;
                vec![x, y, n]
            },
            noise: &[0.4, 1.5, 1.0],
            truths: &[
                ("X_u_dot", -30.0),
                ("X_u", -12.0),
                ("X_uu", -80.0),
                ("X_vr", 170.0),
                ("X_rr", 8.0),
                ("Y_v_dot", -170.0),
                ("Y_r_dot", -8.0),
                ("Y_v", -220.0),
                ("Y_r", 60.0),
                ("Y_vv", -300.0),
                ("Y_rv", -40.0),
                ("Y_vr", 0.0),
                ("N_v_dot", -8.0),
                ("N_r_dot", -110.0),
                ("N_v", -130.0),
                ("N_r", -190.0),
                ("N_rr", -60.0),
                ("N_vr", 25.0),
            ],
        },
        Case {
            law: "fossen_6dof",
            keys: "",
            header: "v_x [m/s],v_y [m/s],v_z [m/s],w_x [rad/s],w_y [rad/s],w_z [rad/s],v_x_dot [m/s^2],v_y_dot [m/s^2],v_z_dot [m/s^2],\
                     w_x_dot [rad/s^2],w_y_dot [rad/s^2],w_z_dot [rad/s^2],f_x [N],f_y [N],f_z [N],m_x [N m],m_y [N m],m_z [N m]",
            settings: filled(40, &[0.6, 0.5, 0.4, 0.8, 0.7, 0.9, 0.3, 0.3, 0.3, 0.5, 0.5, 0.5]),
            loads: |s| {
                let of =
                    |k: usize, mass: f64, linear: f64, square: f64| mass * s[k + 6] + linear * s[k] + square * sq(s[k]);
                vec![
                    of(0, -5.5, -4.0, -18.2),
                    of(1, -12.7, -6.2, -21.7),
                    of(2, -14.6, -5.2, -37.0),
                    of(3, -0.12, -0.07, -1.55),
                    of(4, -0.12, -0.07, -1.55),
                    of(5, -0.12, -0.07, -1.55),
                ]
            },
            noise: &[0.3, 0.3, 0.3, 0.02, 0.02, 0.02],
            truths: &[
                ("X_u_dot", -5.5),
                ("Y_v", -6.2),
                ("Z_ww", -37.0),
                ("K_p_dot", -0.12),
                ("M_q", -0.07),
                ("M_qq", -1.55),
                ("N_r", -0.07),
                ("N_rr", -1.55),
            ],
        },
        // The primes of the Mariner class, Chislett & Strøm-Tejsen (1965), on a model of 4 m.
        Case {
            law: "abkowitz",
            keys: "[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nreference_length = \"4 m\"\n",
            header: "speed [m/s],angle [deg],w_z [rad/s],rudder [deg],f_x [N],f_y [N],m_z [N m]",
            settings: filled(90, &[0.0, 18.0, 0.25, 30.0])
                .into_iter()
                .enumerate()
                .map(|(i, s)| vec![[1.0, 1.3, 1.6][i % 3], s[1], s[2], s[3]])
                .collect(),
            loads: |s| {
                let (u, v, r, d) = (s[0], -s[1].to_radians().sin(), s[2] * 4.0 / s[0], s[3].to_radians());
                let (v3, v2r) = (v.powi(3), v * v * r);
                let x = -899.0 * v * v + 18.0 * r * r - 95.0 * d * d + 798.0 * v * r + 93.0 * v * d - 300.0;
                let y = -4.0 - 1160.0 * v - 499.0 * r - 8078.0 * v3 + 15356.0 * v2r + 278.0 * d - 90.0 * d.powi(3)
                    + 1190.0 * v * v * d;
                let n = 3.0 - 264.0 * v - 166.0 * r + 1636.0 * v3 - 5483.0 * v2r - 139.0 * d + 45.0 * d.powi(3)
                    - 489.0 * v * v * d;
                let force = 0.5 * 1000.0 * 16.0 * u * u * 1e-5;
                vec![x * force, y * force, n * force * 4.0]
            },
            noise: &[0.4, 1.0, 2.0],
            truths: &[
                ("X_vv_prime", -899e-5),
                ("X_rr_prime", 18e-5),
                ("X_dd_prime", -95e-5),
                ("X_vr_prime", 798e-5),
                ("X_vd_prime", 93e-5),
                ("X_0_prime", -300e-5),
                ("Y_0_prime", -4e-5),
                ("Y_v_prime", -1160e-5),
                ("Y_r_prime", -499e-5),
                ("Y_vvv_prime", -8078e-5),
                ("Y_vvr_prime", 15356e-5),
                ("Y_d_prime", 278e-5),
                ("Y_vvd_prime", 1190e-5),
                ("N_v_prime", -264e-5),
                ("N_r_prime", -166e-5),
                ("N_vvv_prime", 1636e-5),
                ("N_vvr_prime", -5483e-5),
                ("N_d_prime", -139e-5),
                ("N_ddd_prime", 45e-5),
                ("N_vvd_prime", -489e-5),
            ],
        },
        // KVLCC2 as printed by Yasukawa & Yoshimura (2015), on a model of 7 m and 0.455 m.
        Case {
            law: "mmg",
            keys: "[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nreference_length = \"7 m\"\n[constants]\nd = \"0.455 m\"\n",
            header: "speed [m/s],angle [deg],w_z [rad/s],f_x [N],f_y [N],m_z [N m]",
            settings: grid(&[&[0.76], &[-20.0, -12.0, -6.0, 0.0, 6.0, 12.0, 20.0], &[-0.08, -0.04, 0.0, 0.04, 0.08]]),
            loads: |s| {
                let (v, r) = (-s[1].to_radians().sin(), s[2] * 7.0 / s[0]);
                let x = -0.022 - 0.040 * v * v + 0.002 * v * r + 0.011 * r * r + 0.771 * v.powi(4);
                let y = -0.315 * v + 0.083 * r - 1.607 * v.powi(3) + 0.379 * v * v * r - 0.391 * v * r * r
                    + 0.008 * r.powi(3);
                let n = -0.137 * v - 0.049 * r - 0.030 * v.powi(3) - 0.294 * v * v * r + 0.055 * v * r * r
                    - 0.013 * r.powi(3);
                let force = 0.5 * 1000.0 * 7.0 * 0.455 * s[0] * s[0];
                vec![x * force, y * force, n * force * 7.0]
            },
            noise: &[0.5, 2.0, 5.0],
            truths: &[
                ("X_0", -0.022),
                ("X_vv", -0.040),
                ("X_vr", 0.002),
                ("X_rr", 0.011),
                ("X_vvvv", 0.771),
                ("Y_v", -0.315),
                ("Y_r", 0.083),
                ("Y_vvv", -1.607),
                ("Y_vvr", 0.379),
                ("Y_vrr", -0.391),
                ("Y_rrr", 0.008),
                ("N_v", -0.137),
                ("N_r", -0.049),
                ("N_vvv", -0.030),
                ("N_vvr", -0.294),
                ("N_vrr", 0.055),
                ("N_rrr", -0.013),
            ],
        },
        // REMUS, Prestero (2001), tables 5 to 7 of its appendix.
        Case {
            law: "torpedo",
            keys: "",
            header: "v_x [m/s],v_y [m/s],w_z [rad/s],delta_r [deg],f_x [N],f_y [N],m_z [N m]",
            settings: filled(50, &[0.3, 0.15, 0.3, 12.0])
                .into_iter()
                .map(|s| vec![1.4 + s[0], s[1], s[2], s[3]])
                .collect(),
            loads: |s| {
                let (u, v, r, d) = (s[0], s[1], s[2], s[3].to_radians());
                vec![
                    -1.62 * u * u + 35.5 * v * r - 1.93 * r * r,
                    -1310.0 * sq(v) + 0.632 * sq(r) - 28.6 * u * v + 5.22 * u * r + 9.64 * u * u * d,
                    -3.18 * sq(v) - 94.0 * sq(r) - 24.0 * u * v - 2.0 * u * r - 6.15 * u * u * d,
                ]
            },
            noise: &[0.05, 0.3, 0.2],
            truths: &[
                ("X_uu", -1.62),
                ("X_vr", 35.5),
                ("X_rr", -1.93),
                ("Y_vv", -1310.0),
                ("Y_rr", 0.632),
                ("Y_uv", -28.6),
                ("Y_ur", 5.22),
                ("Y_uud", 9.64),
                ("N_vv", -3.18),
                ("N_rr", -94.0),
                ("N_uv", -24.0),
                ("N_ur", -2.0),
                ("N_uud", -6.15),
            ],
        },
        Case {
            law: "thruster",
            keys: "",
            header: "voltage [V],thrust [N],torque [N m]",
            settings: grid(&[&[-12.0, -10.0, -8.0, -6.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0]]),
            loads: |s| {
                let beyond = (s[0].abs() - 0.6).max(0.0).powi(2);
                let side = |ahead: f64, astern: f64| if s[0] > 0.0 { ahead * beyond } else { -astern * beyond };
                vec![side(0.32, 0.25), side(0.006, 0.005)]
            },
            noise: &[0.3, 0.008],
            truths: &[
                ("T_ahead", 0.32),
                ("T_astern", 0.25),
                ("dead_band_ahead", 0.6),
                ("dead_band_astern", 0.6),
                ("Q_ahead", 0.006),
                ("Q_astern", 0.005),
                ("dead_band_Q_ahead", 0.6),
                ("dead_band_Q_astern", 0.6),
            ],
        },
        // As the table of the command line's tests: the thrust one step beyond the dead band is a third of the scatter.
        Case {
            law: "thruster",
            keys: "",
            header: "voltage [V],thrust [N]",
            settings: (1..=12).flat_map(|x| [vec![-f64::from(x)], vec![f64::from(x)]]).collect(),
            loads: |s| {
                let beyond = (s[0].abs() - 0.6).max(0.0).powi(2);
                vec![if s[0] > 0.0 { 0.32 * beyond } else { -0.25 * beyond }]
            },
            noise: &[0.15],
            truths: &[("T_ahead", 0.32), ("T_astern", 0.25), ("dead_band_ahead", 0.6), ("dead_band_astern", 0.6)],
        },
        Case {
            law: "thruster",
            keys: "",
            header: "rpm [rpm],speed [m/s],thrust [N]",
            settings: grid(&[&[-1500.0, -900.0, -300.0, 300.0, 900.0, 1500.0], &[0.0, 0.5, 1.0]]),
            loads: |s| {
                let x = s[0] * TAU / 60.0;
                let beyond = (x.abs() - 8.0).max(0.0);
                let still = if x > 0.0 { 0.0021 } else { -0.0016 } * beyond * beyond;
                vec![still - 0.05 * beyond * s[1]]
            },
            noise: &[0.4],
            truths: &[
                ("T_ahead", 0.0021),
                ("T_astern", 0.0016),
                ("T_inflow", -0.05),
                ("dead_band_ahead", 8.0),
                ("dead_band_astern", 8.0),
            ],
        },
        Case {
            law: "propeller",
            keys: "[fluid]\ndensity = \"1000 kg/m^3\"\n[constants]\nD = \"0.25 m\"\n",
            header: "rpm [rpm],speed [m/s],thrust [N],torque [N m]",
            settings: grid(&[&[600.0, 900.0], &[0.0, 0.4, 0.8, 1.2, 1.6, 2.0]])
                .into_iter()
                .chain(grid(&[&[-600.0, -900.0], &[0.0, -0.5, -1.0, -1.5]]))
                .collect(),
            loads: |s| {
                let n = s[0] / 60.0;
                let j = s[1] / (n * 0.25);
                let k = |ahead: [f64; 3], astern: [f64; 3]| {
                    let [a, b, c] = if n > 0.0 { ahead } else { astern };
                    1000.0 * n * n.abs() * (a + b * j + c * j * j)
                };
                let d4 = 0.25_f64.powi(4);
                vec![
                    k([0.45, -0.32, -0.12], [0.30, -0.25, -0.05]) * d4,
                    k([0.060, -0.030, -0.018], [0.045, -0.02, -0.01]) * d4 * 0.25,
                ]
            },
            noise: &[1.5, 0.06],
            truths: &[
                ("K_T0", 0.45),
                ("K_T1", -0.32),
                ("K_T2", -0.12),
                ("K_Q0", 0.060),
                ("K_Q1", -0.030),
                ("K_Q2", -0.018),
                ("K_T0_astern", 0.30),
                ("K_T1_astern", -0.25),
                ("K_Q2_astern", -0.01),
            ],
        },
    ]
}

/// The intervals of a law in all of its tables.
fn hold_the_truth(law: &str) {
    let all = cases();
    let limit = z_limit(FAMILY_WISE, all.iter().map(|case| case.truths.len()).sum());
    for case in all.iter().filter(|case| case.law == law) {
        let counts = case.coverage();
        assert!(counts.iter().any(|count| count.hits < count.trials), "{law}: {counts:?}");
        for ((name, _), count) in case.truths.iter().zip(&counts) {
            let z = count.z_score(0.95);
            println!("{law} {name}: {} of {}, z = {z:.2}", count.hits, count.trials);
            assert!(z.abs() < limit, "{law}, {name}: {} of {} intervals", count.hits, count.trials);
        }
        // Coefficients of one table are correlated, at worst wholly: 95 % less 1.64 binomial deviations of so many tables.
        let (hits, trials) = counts.iter().fold((0, 0), |(h, n), count| (h + count.hits, n + count.trials));
        let [part, tables] = [hits as f64 / trials as f64, counts[0].trials as f64];
        assert!(part > 0.95 - 1.64 * (0.95 * 0.05 / tables).sqrt(), "{law}: {hits} of {trials}");
    }
}

#[test]
fn intervals_of_oblique_towing_hold_the_truth() {
    hold_the_truth("oblique");
}

#[test]
fn intervals_of_linear_and_quadratic_damping_hold_the_truth() {
    hold_the_truth("fossen_3dof");
    hold_the_truth("fossen_6dof");
}

#[test]
fn intervals_of_the_mariner_hold_its_published_primes() {
    hold_the_truth("abkowitz");
}

#[test]
fn intervals_of_kvlcc2_hold_its_published_coefficients() {
    hold_the_truth("mmg");
}

#[test]
fn intervals_of_remus_hold_its_published_coefficients() {
    hold_the_truth("torpedo");
}

#[test]
fn intervals_of_thrusters_hold_the_truth() {
    hold_the_truth("thruster");
    hold_the_truth("propeller");
}

/// What the finding on a law says.
fn said(found: &SourceResult) -> &str {
    found.findings.iter().find(|f| f.code == "named-law").map_or("", |f| f.message.as_str())
}

#[test]
fn terms_that_a_table_lacks_are_left_out_by_name() {
    let oblique = cases().remove(0);
    let table = oblique.table(1);
    // Without the moment, and straight ahead.
    let without: String = table.lines().map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0)).collect();
    let found = result(&without, &source("oblique")).unwrap();
    assert!(said(&found).ends_with("Left out: N_v, N_uv, N_vv (no column m_z)."), "{}", said(&found));
    let ahead: String = table
        .lines()
        .filter(|line| line.starts_with("speed") || line.contains(",0,"))
        .map(|line| format!("{line}\n"))
        .collect();
    let found = result(&ahead, &source("oblique")).unwrap();
    let text = "Left out: Y_v, Y_uv, Y_vv, N_v, N_uv, N_vv (v_y is zero in every row).";
    assert!(said(&found).ends_with(text), "{}", said(&found));
}

/// At one angle u·v and v|v| have one shape: their sum is determined, and neither has an interval.
#[test]
fn terms_of_one_angle_have_no_interval() {
    let mut case = cases().remove(0);
    case.settings = grid(&[&[0.5, 0.8, 1.1, 1.4], &[-10.0, 0.0, 10.0]]);
    let found = result(&case.table(1), &source("oblique")).unwrap();
    let of = |name: &str| found.estimates[0].coefficients[name].interval_95;
    assert!(of("Y_uv").is_none() && of("Y_vv").is_none() && of("X_uu").is_some(), "{:?}", found.estimates[0]);
    assert!(found.estimates[0].undetermined.iter().any(|what| what.contains("Y_uv") && what.contains("Y_vv")));
}

/// T = 0.3 (x + 0.5)², which no thruster does.
#[test]
fn a_dead_band_below_zero_is_noted() {
    let mut table = "voltage [V],thrust [N]\n".to_owned();
    for x in 1..=8 {
        let x = f64::from(x);
        writeln!(table, "{x},{}", 0.3 * (x + 0.5).powi(2)).unwrap();
    }
    let found = result(&table, &source("thruster")).unwrap();
    let note = found.findings.iter().find(|f| f.code == "negative-dead-band").unwrap();
    assert!(
        note.message.starts_with("dead_band_ahead is below zero, which is impossible for a thruster; "),
        "{}",
        note.message
    );
}

#[test]
fn what_a_law_needs_is_asked_with_the_lines_to_write() {
    let mmg = "speed [m/s],angle [deg],f_x [N],f_y [N]\n1,5,-1,2\n1,10,-2,4\n1,15,-3,8\n1.2,12,-3,8\n";
    let error = result(mmg, &format!("{FRESH}{}", source("mmg"))).unwrap_err().to_string();
    assert!(
        error.contains("a number is not declared; write [body] reference_length = \"2 m\" and [constants] d = \"0.1 m\", the draught"),
        "{error}"
    );
    let two = "voltage [V],rpm [rpm],thrust [N]\n1,100,1\n2,200,2\n3,300,4\n4,400,8\n";
    let error = result(two, &source("thruster")).unwrap_err().to_string();
    assert!(error.contains("the columns voltage and rpm may both be its command"), "{error}");
    let error = result("speed [m/s],f_x [N]\n1,-1\n2,-2\n3,-4\n", &source("oblik")).unwrap_err().to_string();
    assert!(error.contains("model \"oblik\" is not known; built in are f1 to f6"), "{error}");
}

/// A thrust drives the body, and so does a load that is declared so; one of the water that does is an error as before.
#[test]
fn a_load_of_an_actuator_may_drive_the_body() {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for k in 1..=8 {
        let u = 0.2 * f64::from(k);
        writeln!(table, "{u},{}", 12.0 * u * u + 0.01 * f64::from(k % 3)).unwrap();
    }
    let own = "[[identify.model]]\nname = \"own\"\nf_x = \"D*u*abs(u)\"\n[identify]\nmodels = [\"own\"]\n";
    let keys =
        |actuator: &str| format!("[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{actuator}{own}");
    let has_error = |keys: &str| {
        let found = result(&table, keys).unwrap();
        found.findings.iter().any(|f| f.code == "force-along-motion")
    };
    assert!(has_error(&keys("")) && !has_error(&keys("actuator = [\"f_x\"]\n")));
    let refused = result(&table, &keys("actuator = [\"f_x\"]\n").replace(own, "")).unwrap_err().to_string();
    assert!(
        refused.contains("f_x is exerted by an actuator, and the built-in laws describe water loads: write a law"),
        "{refused}"
    );
    let log = "time [s],thrust [N],speed [m/s]\n0,30,0\n0.1,30,0.03\n0.2,29,0.06\n0.3,30,0.09\n";
    let refused = result(log, &keys("").replace(own, "")).unwrap_err().to_string();
    let advice =
        "method = \"servo\" with friction = \"viscous\" and loads = [\"D_II*speed*abs(speed)\"] (froude new servo)";
    assert!(refused.contains(advice), "{refused}");
    let refused = result(&table, &keys("actuator = [\"f_q\"]\n")).unwrap_err().to_string();
    assert!(refused.contains("actuator = [\"f_q\"]: the table has no such column; its loads are f_x"), "{refused}");
}
