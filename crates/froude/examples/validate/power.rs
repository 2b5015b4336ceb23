//! Operating characteristics of the tests: how often each finding is there at five sizes of its fault, beside the best test that knows more than the program can.
//!
//! The 80 % point is where the count passes 80 % between two sizes; [`crate::best`] has those of the best tests, at the level of the finding.

use std::error::Error;
use std::fmt::Write as _;

use froude::fit::distribution::normal_quantile;
use froude::fit::faer::Mat;
use froude::identify::source::SourceResult;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use crate::best::{known, of_covariance, one_row};
use crate::claims::{Claims, Verdict};
use crate::coverage::normal;
use crate::intervals::{Said, Tally, campaign, run, six_setups};

const ROOM: &str = "Findings at five sizes of their fault";
/// Share of the best test's 80 % point that an 80 % point may be.
const MOST: f64 = 1.25;
const TABLES: u64 = 500;

/// Rows of a table with a fault of a size.
type Table = fn(f64, &mut Pcg64) -> String;

/// What the best test of a fault knows, and where that test is.
enum Best {
    /// The fault and σ; its 80 % point.
    Known(f64),
    /// The fault, and neither row nor σ; its 80 % point.
    OneRow(f64),
    /// The covariance of errors of a size; the columns of the law, and the level of the finding.
    Covariance { design: Mat<f64>, of: fn(f64) -> Mat<f64>, level: f64 },
}

impl Best {
    fn words(&self) -> &'static str {
        match self {
            Self::Known(_) => "a test that knows the fault and σ",
            Self::OneRow(_) => "the best of those that know neither row nor σ",
            Self::Covariance { .. } => "the best invariant test, which knows the size",
        }
    }

    /// Its 80 % point; of a covariance between sizes, as of the counts.
    fn point(&self, sizes: &[f64]) -> Option<f64> {
        match self {
            Self::Known(point) | Self::OneRow(point) => Some(*point),
            Self::Covariance { design, of, level } => {
                let percents: Option<Vec<f64>> =
                    sizes.iter().map(|size| Some(100.0 * of_covariance(design, &of(*size), *level)?)).collect();
                passes(sizes, &percents?)
            }
        }
    }
}

/// A fault: its finding, its words, the campaign's keys, sizes, table, and its best test.
struct Fault {
    code: &'static str,
    words: &'static str,
    rest: &'static str,
    sizes: [f64; 5],
    table: Table,
    best: Best,
}

fn head(rows: impl Iterator<Item = [f64; 2]>) -> String {
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for [u, f] in rows {
        let _ = writeln!(out, "{u},{f}");
    }
    out
}

/// Twelve speeds, each twice.
fn speed(i: i32) -> f64 {
    0.3 + 0.15 * f64::from(i / 2)
}

fn truth(u: f64) -> f64 {
    -(3.0 * u + 14.0 * u * u)
}

/// One row, anywhere, that is so many σ off.
fn outlier(size: f64, rng: &mut Pcg64) -> String {
    let which = rng.random_range(0..24);
    let rows: Vec<[f64; 2]> = (0..24)
        .map(|i| [speed(i), truth(speed(i)) + 0.3 * (normal(rng) + if i == which { size } else { 0.0 })])
        .collect();
    head(rows.into_iter())
}

/// A cubic term of so many of its own standard uncertainties beside linear and quadratic ones.
fn cubic(size: f64, rng: &mut Pcg64) -> String {
    let u_c = 0.3 * unexplained();
    let rows: Vec<[f64; 2]> =
        (0..24).map(|i| [speed(i), truth(speed(i)) - size * u_c * speed(i).powi(3) + 0.3 * normal(rng)]).collect();
    head(rows.into_iter())
}

/// 1/√(Σ r²), r what linear and quadratic terms leave over of the cubes of the speeds: u/σ of a cubic term.
fn unexplained() -> f64 {
    let sum = |p: i32| (0..24).map(|i| speed(i).powi(p)).sum::<f64>();
    let (a, b, d) = (sum(2), sum(3), sum(4));
    let [p, q] = [sum(4), sum(5)];
    let determinant = a * d - b * b;
    let explained = (d * p * p - 2.0 * b * p * q + a * q * q) / determinant;
    1.0 / (sum(6) - explained).sqrt()
}

/// Thirty rows in random order whose errors follow each other.
fn serial(rho: f64, rng: &mut Pcg64) -> String {
    let mut order: Vec<usize> = (0..30).collect();
    order.shuffle(rng);
    let mut error = normal(rng);
    let rows: Vec<[f64; 2]> = order
        .into_iter()
        .map(|i| {
            let u = 0.3 + 0.05 * i as f64;
            error = rho * error + (1.0 - rho * rho).sqrt() * normal(rng);
            [u, truth(u) + 0.2 * error]
        })
        .collect();
    head(rows.into_iter())
}

/// Thirty rows whose errors go with a power of the load.
fn uneven(power: f64, rng: &mut Pcg64) -> String {
    let rows: Vec<[f64; 2]> = (0..30)
        .map(|i| {
            let u = 0.3 + 0.05 * f64::from(i);
            let load = 12.0 * u * u;
            [u, -load + 0.3 * (load / 12.0).powf(power) * normal(rng)]
        })
        .collect();
    head(rows.into_iter())
}

/// σ over √(Σ a²) of the accelerations below: the standard uncertainty of a mass beside a drag, all but orthogonal.
fn accelerations() -> impl Iterator<Item = (f64, f64)> {
    (0..30).map(|i| (0.4 + 0.1 * f64::from(i % 10), [-0.4, 0.1, 0.3][i as usize / 10]))
}

/// An added mass of the wrong sign, by so many of its standard uncertainties.
fn negative(size: f64, rng: &mut Pcg64) -> String {
    let squares: f64 = accelerations().map(|(_, a)| a * a).sum();
    let mass = -size * 0.2 / squares.sqrt();
    let mut out = "v_x [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
    for (v, a) in accelerations() {
        let _ = writeln!(out, "{v},{a},{}", -15.0 * v * v - mass * a + 0.2 * normal(rng));
    }
    out
}

/// A coefficient bounded below by zero that is so many of its standard uncertainties below.
fn below_its_bound(size: f64, rng: &mut Pcg64) -> String {
    let sum = |p: i32| (0..24).map(|i| speed(i).powi(p)).sum::<f64>();
    let u_b = 0.3 * (sum(4) / (sum(2) * sum(4) - sum(3).powi(2))).sqrt();
    let rows: Vec<[f64; 2]> =
        (0..24).map(|i| [speed(i), -(14.0 * speed(i).powi(2) - size * u_b * speed(i)) + 0.3 * normal(rng)]).collect();
    head(rows.into_iter())
}

/// A prior that is so many of its standard uncertainties off beyond its own error, and as uncertain as the data: √2 of their difference.
fn prior(size: f64, rng: &mut Pcg64) -> String {
    let u_d = 0.3 / (0..24).map(|i| speed(i).powi(4)).sum::<f64>().sqrt();
    let truth = 14.0 - size * u_d + u_d * normal(rng);
    let rows: Vec<[f64; 2]> = (0..24).map(|i| [speed(i), -truth * speed(i).powi(2) + 0.3 * normal(rng)]).collect();
    head(rows.into_iter())
}

/// Columns of powers of speeds.
fn columns(speed: &[f64], powers: &[i32]) -> Mat<f64> {
    Mat::from_fn(speed.len(), powers.len(), |i, k| speed[i].powi(powers[k]))
}

/// Speeds of thirty rows.
fn thirty() -> Vec<f64> {
    (0..30).map(|i| 0.3 + 0.05 * f64::from(i)).collect()
}

/// The same in an order without a drift: steps of 11 modulo 30 pass all.
fn in_no_order() -> Vec<f64> {
    (0..30).map(|i| thirty()[(11 * i) % 30]).collect()
}

fn of_serial(rho: f64) -> Mat<f64> {
    Mat::from_fn(30, 30, |i, k| rho.powi(i.abs_diff(k) as i32))
}

fn of_uneven(power: f64) -> Mat<f64> {
    let speed = thirty();
    Mat::from_fn(30, 30, |i, k| if i == k { speed[i].powf(4.0 * power) } else { 0.0 })
}

fn of_setups(size: f64) -> Mat<f64> {
    Mat::from_fn(48, 48, |i, k| f64::from(u8::from(i == k)) + if i / 8 == k / 8 { size * size } else { 0.0 })
}

fn faults() -> [Fault; 8] {
    const LINEAR: &str = "models = [\"linear_quadratic\"]\n";
    const QUADRATIC: &str = "models = [\"quadratic\"]\n";
    [
        Fault {
            code: "outlying-row",
            words: "one row of 24 off by σ times",
            rest: LINEAR,
            sizes: [3.0, 4.0, 5.0, 6.0, 7.0],
            table: outlier,
            best: Best::OneRow(one_row(0.004, 24.0, 22.0, (22.0_f64 / 24.0).sqrt())),
        },
        Fault {
            code: "lack-of-fit",
            words: "a cubic term beside linear and quadratic ones, 12 speeds twice, of its u times",
            rest: LINEAR,
            sizes: [2.0, 4.0, 6.0, 8.0, 10.0],
            table: cubic,
            best: Best::Known(known(0.002)),
        },
        Fault {
            code: "serial-correlation",
            words: "30 rows whose errors follow each other by",
            rest: LINEAR,
            sizes: [0.2, 0.4, 0.6, 0.8, 0.9],
            table: serial,
            best: Best::Covariance { design: columns(&in_no_order(), &[1, 2]), of: of_serial, level: 0.006 },
        },
        Fault {
            code: "uneven-scatter",
            words: "30 rows whose errors go with the load to the power",
            rest: QUADRATIC,
            sizes: [0.25, 0.5, 0.75, 1.0, 1.5],
            table: uneven,
            // Half of the level: errors that fall are looked for too.
            best: Best::Covariance { design: columns(&thirty(), &[2]), of: of_uneven, level: 0.002 },
        },
        Fault {
            code: "setup-offset",
            words: "6 setups of 8 rows with a zero of σ times",
            rest: LINEAR,
            sizes: [0.25, 0.5, 0.75, 1.0, 1.5],
            table: six_setups,
            best: Best::Covariance {
                design: Mat::from_fn(48, 2, |i, k| (0.3 + 0.2 * (i % 8) as f64).powi([1, 2][k])),
                of: of_setups,
                level: 0.006,
            },
        },
        Fault {
            code: "negative-added-mass",
            words: "an added mass below zero by its u times",
            rest: "models = [\"free\"]\n[[identify.model]]\nname = \"free\"\nf_x = \"-A*v_x_dot - X_uu*v_x*abs(v_x)\"\n",
            sizes: [2.0, 3.0, 4.0, 5.0, 6.0],
            table: negative,
            best: Best::Known(known(0.004)),
        },
        Fault {
            code: "bound-contradicted",
            words: "a coefficient below its bound by its u times",
            rest: "models = [\"linear_quadratic\"]\n[identify]\nbounds = { D_x_I = \"non-negative\" }\n",
            sizes: [1.0, 2.0, 3.0, 4.0, 5.0],
            table: below_its_bound,
            best: Best::Known(known(0.01)),
        },
        Fault {
            code: "prior-contradicted",
            words: "a prior off by its u times, the data as uncertain",
            rest: "models = [\"quadratic\"]\n[identify]\nprior = [{ coefficient = \"D_x_II\", value = 14, standard_uncertainty = PRIOR }]\n",
            sizes: [1.0, 2.0, 3.0, 5.0, 7.0],
            table: prior,
            best: Best::Known(std::f64::consts::SQRT_2 * known(0.005)),
        },
    ]
}

/// Where counts pass 80 %: the normal quantiles of the counts lie on lines between sizes.
fn passes(sizes: &[f64], percents: &[f64]) -> Option<f64> {
    let quantile =
        |percent: f64| normal_quantile((0.01 * percent).clamp(0.5 / TABLES as f64, 1.0 - 0.5 / TABLES as f64));
    let ends: Vec<(f64, f64)> = sizes.iter().zip(percents).map(|(x, y)| (*x, quantile(*y))).collect();
    let at = quantile(80.0);
    ends.windows(2).find_map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        (y0 < at && y1 >= at).then(|| x0 + (x1 - x0) * (at - y0) / (y1 - y0))
    })
}

/// All faults, at `TABLES` tables a size.
pub fn all(claims: &mut Claims) -> Result<(), Box<dyn Error>> {
    let u_d = 0.3 / (0..24).map(|i| speed(i).powi(4)).sum::<f64>().sqrt();
    for (k, fault) in faults().iter().enumerate() {
        let rest = fault.rest.replace("PRIOR", &u_d.to_string());
        let mut percents = Vec::new();
        for (i, size) in fault.sizes.into_iter().enumerate() {
            let judge = |found: &SourceResult| {
                let is_said = found.findings.iter().any(|f| f.code == fault.code);
                vec![(fault.code.to_owned(), Said { holds: is_said, width: 0.0 })]
            };
            let stream = 3000 + 10 * k as u128 + i as u128;
            let tallies = run(&campaign(&rest), TABLES, stream, |rng| (fault.table)(size, rng), judge)?;
            percents.push(tallies.first().map_or(0.0, Tally::percent));
        }
        let said: Vec<String> =
            fault.sizes.iter().zip(&percents).map(|(size, percent)| format!("{size}: {percent:.1} %")).collect();
        let found = passes(&fault.sizes, &percents);
        let at = found.map_or_else(|| "80 % is not passed between them".to_owned(), |at| format!("80 % at {at:.2}"));
        let what = format!("{}: {}", fault.code, fault.words);
        let words = fault.best.words();
        match (fault.best.point(&fault.sizes), found) {
            (Some(best), Some(at_80)) => claims.add(
                ROOM,
                &what,
                &format!("80 % at {MOST} times {best:.2} at most, that of {words}"),
                format!("{}; {at}, {:.2} times", said.join(", "), at_80 / best),
                if at_80 <= MOST * best { Verdict::Pass } else { Verdict::Finding },
            ),
            (best, _) => {
                let expected = format!("80 % between these sizes, as {words} has it ({best:?})");
                claims.add(ROOM, &what, &expected, format!("{}; {at}", said.join(", ")), Verdict::Miss);
            }
        }
    }
    Ok(())
}
