//! Operating characteristics of the findings: how often sound tables of every kind carry each, and that no short or odd table ends without a record or a message.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::panic::catch_unwind;

use froude::identify::source::identify_source;
use froude::records::finding::{Finding, Severity};
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};

use crate::claims::{Claims, Verdict};
use crate::coverage::normal;
use crate::intervals::{campaign, room};

const CLEAN: &str = "Findings on sound tables, by kind";
const SHORT: &str = "Short and odd tables";
/// A code designed to 0.4 % (0.6 % of those whose power few rows limit) passes with 0.68 %; one of grade error with 0.01 %.
const MOST: [f64; 2] = [0.0068, 0.0001];

/// A kind of sound table: its name, the campaign's keys, and its rows.
type Kind = (&'static str, &'static str, fn(&mut Pcg64) -> String);

const KINDS: [Kind; 15] = [
    ("steady tows", "", |rng| along(rng, 0.0)),
    ("declared clusters", "group = \"day\"\n[identify]\ncovariance = \"cluster\"\n", days),
    (
        "declared zero of each run",
        "[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"0.3 N\"\nshared = \"setup\"\n",
        setups,
    ),
    ("drift in a plane", "", drift),
    (
        "propelled",
        "[identify]\n[[identify.model]]\nname = \"ship\"\nf_x = \"-X_uu*v_x*abs(v_x) + T*rate*rate\"\n",
        propelled,
    ),
    ("turned about the axis", "[identify]\n[[identify.model]]\nname = \"yaw\"\nm_z = \"-D_w*w_z*abs(w_z)\"\n", turned),
    (
        "free-running, accelerated",
        "[identify]\n[[identify.model]]\nname = \"free\"\nf_x = \"-A*v_x_dot - X_uu*v_x*abs(v_x)\"\n",
        accelerated,
    ),
    ("a sensor of coarse steps", "", |rng| along(rng, 0.25)),
    (
        "a rotor over its tip speed ratio",
        "[identify]\n[[identify.model]]\nname = \"rotor\"\nf_x = \"-(A + B*tip_speed_ratio + C*tip_speed_ratio^2)*speed*abs(speed)\"\n",
        rotor,
    ),
    (
        "planar motion, each of eight run twice",
        "group = \"run\"\n[identify]\ncovariance = \"cluster\"\n[[identify.model]]\nname = \"sway\"\nf_y = \"-B*v_y_dot - Y_v*v_y - Y_vv*v_y*abs(v_y)\"\n",
        swayed,
    ),
    ("drift with lift", "", lifted),
    ("55 U^1.8", "", |rng| of(rng, 16, |u| 55.0 * u.powf(1.8), 1.2)),
    ("an ITTC-57 line", "", |rng| of(rng, 16, friction_line, 0.05)),
    ("five rows", "", |rng| of(rng, 5, |u| 12.0 * u * u, 0.2)),
    ("eight rows", "", |rng| of(rng, 8, |u| 4.0 * u + 9.0 * u * u, 0.2)),
];

/// So many speeds of a drag, each once.
fn of(rng: &mut Pcg64, n: u32, drag: fn(f64) -> f64, noise: f64) -> String {
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..n {
        let u = 0.4 + 1.6 * f64::from(i) / f64::from(n - 1);
        let _ = writeln!(out, "{u:.4},{:.5}", -drag(u) + noise * normal(rng));
    }
    out
}

/// Friction of a plate of 1.5 m and 0.8 m² by the ITTC line of 1957, N.
fn friction_line(u: f64) -> f64 {
    let reynolds = u * 1.5 / 1.14e-6;
    0.5 * 1000.0 * 0.8 * u * u * 0.075 / (reynolds.log10() - 2.0).powi(2)
}

/// Three speeds and nine angles of a hull with lift, each twice.
fn lifted(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]\n".to_owned();
    for i in 0..54 {
        let (u, angle) = (0.5 + 0.5 * f64::from(i % 3), 4.0 * f64::from(i / 3 % 9) - 16.0);
        let (v_x, v_y) = (u * angle.to_radians().cos(), -u * angle.to_radians().sin());
        let f_x = -4.2 * v_x * v_x.abs();
        let f_y = -6.0 * v_y - 115.0 * v_y * v_y.abs() - 28.0 * v_x * v_y;
        let m_z = -1.5 * v_y - 14.0 * v_x * v_y;
        let mut read = |load: f64, noise: f64| load + noise * normal(rng);
        let _ = writeln!(out, "{u},{angle},{:.5},{:.5},{:.5}", read(f_x, 0.05), read(f_y, 0.2), read(m_z, 0.1));
    }
    out
}

fn along(rng: &mut Pcg64, step: f64) -> String {
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..24 {
        let u = 0.3 + 0.15 * f64::from(i / 2);
        let f = -(3.0 * u + 14.0 * u * u) + 0.3 * normal(rng);
        let read = if step > 0.0 { (f / step).round() * step } else { f };
        let _ = writeln!(out, "{u:.3},{read:.5}");
    }
    out
}

fn days(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],f_x [N],day\n".to_owned();
    for day in 0..8 {
        let shared = 0.3 * normal(rng);
        for i in 0..6 {
            let u = 0.4 + 0.25 * f64::from(i);
            let _ = writeln!(out, "{u:.3},{:.5},day {day}", -(3.0 * u + 14.0 * u * u) + shared + 0.2 * normal(rng));
        }
    }
    out
}

fn setups(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],f_x [N],setup\n".to_owned();
    for setup in 0..6 {
        let zero = 0.3 * normal(rng);
        for i in 0..8 {
            let u = 0.4 + 0.2 * f64::from(i);
            let _ = writeln!(out, "{u:.3},{:.5},mount {setup}", -(3.0 * u + 14.0 * u * u) + zero + 0.2 * normal(rng));
        }
    }
    out
}

fn drift(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]\n".to_owned();
    for speed in [0.5, 0.8, 1.1] {
        for angle in [-20, -14, -7, 0, 7, 14, 20] {
            let (sin, cos) = f64::from(angle).to_radians().sin_cos();
            let (u, v) = (speed * cos, -speed * sin);
            let f_x = -20.0 * u * u.abs() + 0.1 * normal(rng);
            let f_y = -90.0 * v * v.abs() + 0.15 * normal(rng);
            let m_z = -(30.0 * u * v) + 0.05 * normal(rng);
            let _ = writeln!(out, "{speed},{angle},{f_x:.5},{f_y:.5},{m_z:.5}");
        }
    }
    out
}

fn propelled(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],rate [1/s],f_x [N]\n".to_owned();
    for i in 0..30 {
        let (u, rate) = (0.5 + 0.1 * f64::from(i % 6), 4.0 + f64::from(i / 6));
        let _ = writeln!(out, "{u:.3},{rate},{:.5}", -12.0 * u * u + 0.6 * rate * rate + 0.2 * normal(rng));
    }
    out
}

fn turned(rng: &mut Pcg64) -> String {
    let mut out = "w_z [rad/s],m_z [N m]\n".to_owned();
    for i in 1..=24 {
        let w = if i % 2 == 0 { 0.1 } else { -0.1 } * f64::from(i);
        let _ = writeln!(out, "{w:.3},{:.5}", -3.0 * w * w.abs() + 0.05 * normal(rng));
    }
    out
}

fn accelerated(rng: &mut Pcg64) -> String {
    let mut out = "v_x [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
    for i in 0..30 {
        let (v, a) = (0.4 + 0.1 * f64::from(i % 10), [-0.3, 0.1, 0.4][i as usize / 10]);
        let _ = writeln!(out, "{v:.3},{a},{:.5}", -15.0 * v * v - 30.0 * a + 0.2 * normal(rng));
    }
    out
}

fn rotor(rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],tip_speed_ratio [1],f_x [N]\n".to_owned();
    for i in 0..24 {
        let (u, ratio) = ([0.8, 1.0][i % 2], 1.0 + 0.2 * (i / 2) as f64);
        let load = (40.0 + 12.0 * ratio - 1.5 * ratio * ratio) * u * u;
        let _ = writeln!(out, "{u},{ratio:.2},{:.5}", -load + 0.4 * normal(rng));
    }
    out
}

fn swayed(rng: &mut Pcg64) -> String {
    let mut out = "time [s],v_x [m/s],v_y [m/s],v_y_dot [m/s^2],f_y [N],run\n".to_owned();
    for run in 0..16 {
        let amplitude = 0.15 + 0.05 * f64::from(run % 8);
        for i in 0..50 {
            let t = 0.2 * f64::from(i);
            let (sin, cos) = (0.2 * std::f64::consts::TAU * t).sin_cos();
            let (v, a) = (amplitude * sin, 0.2 * std::f64::consts::TAU * amplitude * cos);
            let f = -30.0 * a - 10.0 * v - 60.0 * v * v.abs() + 0.3 * normal(rng);
            let _ = writeln!(out, "{},1,{v:.5},{a:.5},{f:.5},r{run}", 100.0 * f64::from(run) + t);
        }
    }
    out
}

/// Findings of so many sound tables of each kind.
pub fn clean(claims: &mut Claims, tables: u64) -> Result<(), Box<dyn Error>> {
    for (k, (name, rest, table)) in KINDS.iter().enumerate() {
        let found: Result<Vec<Codes>, String> = (0..tables)
            .into_par_iter()
            .map_init(
                || room(&campaign(rest)),
                |room, seed| {
                    let (folder, campaign) = room.as_ref().map_err(Clone::clone)?;
                    let text = table(&mut Pcg64::new(u128::from(seed), 900 + k as u128));
                    std::fs::write(folder.path().join("table.csv"), text).map_err(|e| e.to_string())?;
                    // A sound table that is refused is an error too.
                    let Ok(found) = identify_source(campaign, &campaign.sources[0], &|_| {}) else {
                        return Ok(vec![("refused".to_owned(), Severity::Error)]);
                    };
                    Ok(codes(&found.findings))
                },
            )
            .collect();
        judged(claims, CLEAN, &format!("{tables} sound tables: {name}"), found?);
    }
    Ok(())
}

/// Codes of the warnings and errors, each once.
pub type Codes = Vec<(String, Severity)>;

/// Those of some findings.
pub fn codes(findings: &[Finding]) -> Codes {
    let told = findings.iter().filter(|f| f.severity != Severity::Note);
    let mut codes: Codes = told.map(|f| (f.code.clone(), f.severity)).collect();
    codes.sort_by(|a, b| a.0.cmp(&b.0));
    codes.dedup_by(|a, b| a.0 == b.0);
    codes
}

/// Codes of tests of the scatter and of declared errors, and no more: of a campaign of tows, others are about its design or about the law that is true.
pub fn of_scatter(findings: &[Finding]) -> Codes {
    const TESTS: [&str; 6] = [
        "declared-contradicted",
        "lack-of-fit",
        "outlying-row",
        "serial-correlation",
        "setup-offset",
        "uneven-scatter",
    ];
    codes(findings).into_iter().filter(|(code, _)| TESTS.contains(&code.as_str())).collect()
}

/// Whether a true rate of `most` gives `count` or more of `tables` with a probability above 0.00135, that of three normal deviations.
fn is_chance(count: usize, tables: usize, most: f64) -> bool {
    let is_in_reach = |found: Binomial| found.sf(count as u64 - 1) > 0.00135;
    count == 0 || Binomial::new(most, tables as u64).is_ok_and(is_in_reach)
}

/// How often sound tables carry each code.
pub fn judged(claims: &mut Claims, section: &'static str, claim: &str, found: Vec<Codes>) {
    let tables = found.len();
    let any = found.iter().filter(|codes| !codes.is_empty()).count();
    let mut by_code: BTreeMap<String, (usize, bool)> = BTreeMap::new();
    for (code, severity) in found.into_iter().flatten() {
        let entry = by_code.entry(code).or_default();
        entry.0 += 1;
        entry.1 |= severity == Severity::Error;
    }
    let n = tables as f64;
    let is_fine = |(count, is_error): &(usize, bool)| {
        let most = MOST[usize::from(*is_error)];
        if *is_error || tables >= 10_000 { *count as f64 / n <= most } else { is_chance(*count, tables, most) }
    };
    let words: Vec<String> =
        by_code.iter().map(|(code, (count, _))| format!("{code} {:.2} %", 100.0 * *count as f64 / n)).collect();
    let part = any as f64 / n;
    claims.holds(
        section,
        claim,
        "any warning in 5 % at most; each code in 0.68 %, an error in 0.01 %",
        format!(
            "{:.2} % with a warning: {}",
            100.0 * part,
            if words.is_empty() { "none".to_owned() } else { words.join(", ") }
        ),
        is_chance(any, tables, 0.05) && by_code.values().all(is_fine),
    );
}

/// One number of an odd table: zeros, equal ones, tiny, huge, signs.
fn odd(rng: &mut Pcg64) -> f64 {
    match rng.random_range(0..10) {
        0 => 0.0,
        1 => 1.0,
        2 => -1.0,
        3 => 1e-300,
        4 => 1e12 * normal(rng),
        5 => 1e-9 * normal(rng),
        6 => f64::from(rng.random_range(-3..4)),
        _ => normal(rng),
    }
}

/// Random short tables under random keys: each must end with a record or with a message, and with numbers or none.
pub fn short(claims: &mut Claims, runs: u64) {
    const COLUMNS: [&str; 9] = [
        "speed [m/s]",
        "angle [deg]",
        "v_x [m/s]",
        "v_y [m/s]",
        "f_x [N]",
        "f_y [N]",
        "m_z [N m]",
        "std_f_x [N]",
        "w_z [rad/s]",
    ];
    const KEYS: [&str; 10] = [
        "",
        "[identify]\ncovariance = \"HC3\"\n",
        "group = \"day\"\n[identify]\ncovariance = \"cluster\"\n",
        "[identify]\ncovariance = \"serial\"\n",
        "[identify]\nweights = \"fitted\"\ncovariance = \"HC3\"\n",
        "group = \"day\"\n[identify]\ngroup_offset = \"estimate\"\n",
        "[[source.uncertainty]]\nquantity = \"f_x\"\nstandard = \"5 %\"\nshared = \"setup\"\n",
        "[identify]\nbounds = { D_x_I = \"non-negative\", D_x_II = \"non-negative\" }\n",
        "[identify]\nprior = [{ coefficient = \"D_x_II\", value = 1, standard_uncertainty = 0.1 }]\n",
        "[identify]\nangle_offset = \"estimate\"\n",
    ];
    let mut broken = Vec::new();
    let [mut fitted, mut refused] = [0_u64; 2];
    for (k, key) in KEYS.iter().enumerate() {
        let each = runs / KEYS.len() as u64;
        let found: Vec<Result<bool, String>> = (0..each)
            .into_par_iter()
            .map_init(
                || room(&campaign(key)),
                |room, seed| {
                    let (folder, campaign) = room.as_ref().map_err(Clone::clone)?;
                    let mut rng = Pcg64::new(u128::from(seed), 1000 + k as u128);
                    let text = table(&COLUMNS, &mut rng);
                    std::fs::write(folder.path().join("table.csv"), &text).map_err(|e| e.to_string())?;
                    let ended = catch_unwind(|| match identify_source(campaign, &campaign.sources[0], &|_| {}) {
                        Ok(found) if found.estimates.is_empty() => Err("no estimate and no message".to_owned()),
                        Ok(found) => {
                            let record = froude::records::estimate::EstimateFile::of(found.estimates);
                            // Numbers that are none have no JSON.
                            let path = folder.path().join("estimate.json");
                            froude::records::json::write_estimates(&path, &record)
                                .map_err(|e| format!("no record: {e}"))?;
                            froude::records::json::read_estimates(&path)
                                .map(|_| true)
                                .map_err(|e| format!("no record: {e}"))
                        }
                        Err(error) if error.to_string().is_empty() => Err("an empty message".to_owned()),
                        Err(_) => Ok(false),
                    });
                    ended
                        .unwrap_or_else(|_| Err("a panic".to_owned()))
                        .map_err(|why| format!("{why} on seed {seed} under {key:?}:\n{text}"))
                },
            )
            .collect();
        for ended in found {
            match ended {
                Ok(true) => fitted += 1,
                Ok(false) => refused += 1,
                Err(why) => broken.push(why),
            }
        }
    }
    if let Some(first) = broken.first() {
        claims.add(SHORT, "the first that ends with neither", "none", first.clone(), Verdict::Miss);
    }
    claims.holds(
        SHORT,
        &format!(
            "{runs} random tables of 1 to 8 rows under {} sets of keys end with a record or a message",
            KEYS.len()
        ),
        "all",
        format!("{fitted} records, {refused} refusals in words, {} with neither", broken.len()),
        broken.is_empty(),
    );
}

fn table(columns: &[&str], rng: &mut Pcg64) -> String {
    let chosen: Vec<&&str> = columns.iter().filter(|_| rng.random_range(0..2) == 0).collect();
    let mut out = chosen.iter().map(|c| **c).chain(["day", "setup"]).collect::<Vec<_>>().join(",") + "\n";
    for _ in 0..rng.random_range(1..9) {
        for column in &chosen {
            let value = odd(rng);
            let _ = write!(out, "{},", if column.starts_with("std") { value.abs() } else { value });
        }
        let _ = writeln!(out, "day {},mount {}", rng.random_range(0..4), rng.random_range(0..3));
    }
    out
}
