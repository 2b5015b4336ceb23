//! Errors that rows share: of a cluster, a setup, a motion, or neighbours.

use std::fmt::Write as _;

use froude::identify::source::SourceResult;
use froude::identify::uncertainty::coverage_factor;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::{Failed, ROOM, Said, WITHOUT, alarm, campaign, capped, interval, judged, rare, rows, run, told};
use crate::claims::{Claims, Verdict};
use crate::coverage::normal;

/// Widths of CR3 over those with t(G − 1).
const MOST_OF_CLUSTERS: f64 = 2.0;
/// An offset of each cluster as a term, over CR3, where that gives no interval: 0.3 to its digit.
const MOST_OF_OFFSETS: f64 = 0.35;
/// Declared errors of 3 σ by generalised least squares, over least squares with the declared errors added.
const MOST_OF_DECLARED: f64 = 0.5;
/// Tables of 900 rows at most.
const MOST_IN_TIME: u64 = 4_000;

pub fn all(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    clusters(claims, seeds)?;
    motions(claims, seeds)?;
    setups(claims, seeds)?;
    neighbours(claims, seeds)
}

/// What the width with another quantile is counted under.
const WITH_T: &str = "with t of all clusters but one";

/// One cluster of forty rows and five of four, with an error that the rows of a cluster share.
fn clusters(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    for (words, sizes) in [
        ("one cluster of 40 and five of 4", vec![40, 4, 4, 4, 4, 4]),
        ("two clusters of 40 and six of 4", vec![40, 40, 4, 4, 4, 4, 4, 4]),
        ("clusters of 12, 10, 8, 6, 4, 4", vec![12, 10, 8, 6, 4, 4]),
        ("six clusters of 8", vec![8; 6]),
    ] {
        let rest = "group = \"group\"\nmodels = [\"quadratic\"]\n[identify]\ncovariance = \"cluster\"\n";
        let table = |rng: &mut Pcg64| {
            let mut out = "speed [m/s],f_x [N],group\n".to_owned();
            for (g, n) in sizes.iter().enumerate() {
                let shared = normal(rng);
                for i in 0..*n {
                    let u = 0.2 + (f64::from(i) + 0.5) / f64::from(*n);
                    let _ = writeln!(out, "{u},{},day {g}", -20.0 * u * u + shared + normal(rng));
                }
            }
            out
        };
        let stream = 200 + sizes.len() as u128 * 50 + sizes[0] as u128;
        // Where no interval is given too, which is what offsets are for.
        let with_t = |found: &SourceResult| {
            let standard = found.models[0].fit.coefficients[0].standard.unwrap_or(f64::NAN);
            2.0 * coverage_factor(sizes.len() as f64 - 1.0) * standard
        };
        let by_clusters = run(&campaign(rest), seeds, stream, table, |found| {
            let dof = found.models[0].fit.coefficients[0].dof.unwrap_or(f64::NAN);
            let is_refused = found.findings.iter().any(|f| f.code == "one-group-decides");
            let said = interval(found, 0, "D_x_II", 20.0).map_or_else(
                || (format!("refused by name at {dof:.2} degrees of freedom"), Said { holds: is_refused, width: 0.0 }),
                |said| (format!("D_x_II by CR3 with {dof:.2} degrees of freedom"), said),
            );
            vec![said, (WITH_T.to_owned(), Said { holds: true, width: with_t(found) })]
        })?;
        for tally in by_clusters.iter().filter(|tally| tally.name != WITH_T) {
            let floor = if tally.name.starts_with("refused") { 100.0 } else { 94.0 };
            judged(claims, words, tally, floor, false, &format!(", mean width {:.3}", tally.width()));
        }
        let offsets = "group = \"group\"\nmodels = [\"quadratic\"]\n[identify]\ngroup_offset = \"estimate\"\n";
        let judge = |found: &SourceResult| {
            let name = "D_x_II with an offset of each cluster as a term".to_owned();
            interval(found, 0, "D_x_II", 20.0).map(|said| (name, said)).into_iter().collect()
        };
        let by_offsets = run(&campaign(offsets), seeds, stream, table, judge)?;
        for tally in &by_offsets {
            judged(claims, words, tally, 95.0, true, &format!(", mean width {:.3}", tally.width()));
        }
        if let ([of, with_t], [offsets]) = (&by_clusters[..], &by_offsets[..]) {
            let other = "that by CR3 with t of all clusters but one";
            if of.width > 0.0 {
                let what = format!("{words}: D_x_II by CR3");
                capped(claims, &what, [of.width(), with_t.width()], (Some(MOST_OF_CLUSTERS), other));
            }
            // Of even clusters CR3 is not wide.
            let most = Some(MOST_OF_OFFSETS).filter(|_| of.width <= 0.0);
            let what = format!("{words}: D_x_II with offsets as terms");
            capped(claims, &what, [offsets.width(), with_t.width()], (most, other));
        }
    }
    Ok(())
}

/// Six motions, each run three times, in rows that follow each other in time: the law leaves of a motion what it leaves of its repeats.
fn motions(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const ROWS: u32 = 50;
    let table = |has_time: bool| {
        move |rng: &mut Pcg64| {
            let mut out = if has_time { "time [s]," } else { "" }.to_owned() + "v_x [m/s],v_y [m/s],f_y [N],run\n";
            let damping: Vec<f64> = (0..6).map(|_| 40.0 + 4.0 * normal(rng)).collect();
            for run in 0..18_u32 {
                let motion = run % 6;
                for i in 0..ROWS {
                    let t = 0.2 * f64::from(i);
                    let v = (0.2 + 0.04 * f64::from(motion)) * (std::f64::consts::TAU * 0.2 * t).sin();
                    if has_time {
                        let _ = write!(out, "{},", 100.0 * f64::from(run) + t);
                    }
                    let f = -damping[motion as usize] * v + 0.5 * normal(rng);
                    let _ = writeln!(out, "1,{v},{f},r{run}");
                }
            }
            out
        }
    };
    let rest = "group = \"run\"\nmodels = [\"sway\"]\n[identify]\ncovariance = \"cluster\"\n[[identify.model]]\nname = \"sway\"\nf_y = \"-D*v_y\"\n";
    let judge =
        |found: &SourceResult| interval(found, 0, "D", 40.0).map(|said| ("D".to_owned(), said)).into_iter().collect();
    let what = "six swaying motions, each run three times, of 40 ± 4 from motion to motion";
    for tally in run(&campaign(rest), seeds.min(MOST_IN_TIME), 450, table(true), judge)? {
        judged(claims, what, &tally, 94.0, false, &format!(", mean width {:.3}", tally.width()));
    }
    for tally in run(&campaign(rest), seeds.min(MOST_IN_TIME), 450, table(false), judge)? {
        let found = format!("{:.2} % of {}, mean width {:.3}", tally.percent(), tally.count, tally.width());
        let expected = "how wrong it is where runs are taken for clusters";
        claims.add(ROOM, &format!("{what}, without their times: D"), expected, found, Verdict::Measured);
    }
    Ok(())
}

/// Width of least squares with the zeros of six setups of eight rows added, of so many σ of a row each: of the linear and the quadratic term.
fn added(size: f64) -> [f64; 2] {
    let speed: Vec<f64> = (0..48).map(|i| 0.3 + 0.2 * f64::from(i % 8)).collect();
    let sum = |p: i32| speed.iter().map(|u| u.powi(p)).sum::<f64>();
    let [a, b, d] = [sum(2), sum(3), sum(4)];
    let determinant = a * d - b * b;
    // What an offset of one setup moves both by.
    let [x, y] = [sum(1) / 6.0, sum(2) / 6.0];
    let by_offset = [(d * x - b * y) / determinant, (a * y - b * x) / determinant];
    // Of the offsets the residuals hold what the law does not take.
    let taken = 6.0 * (by_offset[0] * x + by_offset[1] * y);
    let scatter = (46.0 + size * size * (48.0 - taken)) / 46.0;
    let variance = |own: f64, k: usize| scatter * own / determinant + 6.0 * (size * by_offset[k]).powi(2);
    [variance(d, 0), variance(a, 1)].map(|v| 2.0 * coverage_factor(46.0) * v.sqrt())
}

/// Rows of six setups of eight speeds, with a zero of so many σ each.
pub fn six_setups(offset: f64, rng: &mut Pcg64) -> String {
    let mut out = "speed [m/s],f_x [N],setup\n".to_owned();
    for setup in 0..6 {
        let zero = offset * normal(rng);
        for i in 0..8 {
            let u = 0.3 + 0.2 * f64::from(i);
            let _ = writeln!(out, "{u},{},day {setup}", -(3.0 * u + 12.0 * u * u) + zero + normal(rng));
        }
    }
    out
}

/// Six setups of eight rows with a zero each: declared, estimated, and not declared.
fn setups(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let table = |offset: f64| move |rng: &mut Pcg64| six_setups(offset, rng);
    let judge = |found: &SourceResult| {
        let of = |name: &str, truth| interval(found, 0, name, truth).map(|said| (name.to_owned(), said));
        [of("D_x_I", 3.0), of("D_x_II", 12.0)].into_iter().flatten().collect::<Vec<_>>()
    };
    let laws = "models = [\"linear_quadratic\"]\n";
    for size in [1.0, 2.0, 3.0] {
        let declared = format!(
            "{laws}[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"{size} N\"\nshared = \"setup\"\n"
        );
        let what = format!("6 setups of 8 rows, their zero of {size} σ declared");
        let stream = if size > 1.0 { 410 + size as u128 } else { 400 };
        for tally in &run(&campaign(&declared), seeds, stream, table(size), judge)? {
            judged(claims, &what, tally, 95.0, true, &format!(", mean width {:.3}", tally.width()));
            let Some(k) = ["D_x_I", "D_x_II"].iter().position(|name| *name == tally.name) else { continue };
            let other =
                (Some(MOST_OF_DECLARED).filter(|_| size >= 3.0), "that of least squares with the declared error added");
            capped(claims, &format!("{what}: {}", tally.name), [tally.width(), added(size)[k]], other);
        }
    }
    let estimated = format!("group = \"setup\"\n{laws}[identify]\ngroup_offset = \"estimate\"\n");
    for tally in run(&campaign(&estimated), seeds, 401, table(1.0), judge)? {
        judged(
            claims,
            "the same with an offset of each setup estimated",
            &tally,
            95.0,
            true,
            &format!(", mean width {:.3}", tally.width()),
        );
    }
    for (size, floor) in [(0.0, None), (1.0, Some(80.0))] {
        for tally in run(&campaign(laws), seeds, 402 + (10.0 * size) as u128, table(size), alarm("setup-offset"))? {
            let what = format!("6 setups of 8 rows, an undeclared zero of {size} σ");
            match floor {
                Some(floor) => judged(claims, &what, &tally, floor, false, ""),
                None => rare(claims, &what, &tally, 0.6),
            }
        }
    }
    Ok(())
}

/// Errors that follow each other by 0.8, in 16 to 48 rows: whether it is seen, and what intervals by their correlation hold then.
fn neighbours(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const NOISE_N: f64 = 0.2;
    for (n, floor, of_serial) in [(16, 50.0, 93.0), (24, 80.0, 93.0), (30, 90.0, 93.0), (48, 99.0, 93.0)] {
        let table = |rho: f64, linear: f64| {
            move |rng: &mut Pcg64| {
                let mut error = normal(rng);
                let mut order: Vec<usize> = (0..n).collect();
                order.shuffle(rng);
                let speed: Vec<f64> = order.iter().map(|i| 0.3 + 1.5 * *i as f64 / n as f64).collect();
                rows(&speed, |_, u| {
                    error = rho * error + (1.0 - rho * rho).sqrt() * normal(rng);
                    -(linear * u + 12.0 * u * u) + NOISE_N * error
                })
            }
        };
        let law = "models = [\"linear_quadratic\"]\n";
        for rho in [0.0, 0.8] {
            let what = format!("{n} rows in random order whose errors follow each other by {rho}");
            for tally in run(&campaign(law), seeds, 500 + n as u128, table(rho, 4.0), alarm("serial-correlation"))? {
                if rho > 0.0 {
                    judged(claims, &what, &tally, floor, false, "");
                } else {
                    rare(claims, &what, &tally, 0.6);
                }
            }
        }
        let judge = |found: &SourceResult| {
            [("D_x_I", 4.0), ("D_x_II", 12.0)]
                .map(|(name, truth)| told(found, name, truth, " by their correlation"))
                .to_vec()
        };
        let rest = format!("{law}[identify]\ncovariance = \"serial\"\n");
        for tally in run(&campaign(&rest), seeds, 600 + n as u128, table(0.8, 4.0), judge)? {
            let what = format!("{n} rows in random order whose errors follow each other by 0.8, two coefficients");
            judged(claims, &what, &tally, of_serial, false, &format!(", mean width {:.3}", tally.width()));
        }
        let rest = "models = [\"quadratic\"]\n[identify]\ncovariance = \"serial\"\n";
        let judge = |found: &SourceResult| vec![told(found, "D_x_II", 12.0, " by their correlation")];
        for tally in run(&campaign(rest), seeds, 650 + n as u128, table(0.8, 0.0), judge)? {
            if tally.name.ends_with(WITHOUT) {
                continue;
            }
            claims.add(
                ROOM,
                &format!(
                    "{n} rows in random order whose errors follow each other by 0.8, one coefficient: {}",
                    tally.name
                ),
                &format!("{of_serial} % wanted"),
                format!(
                    "{:.2} % of {}, of {seeds} with an interval, mean width {:.3}",
                    tally.percent(),
                    tally.count,
                    tally.width()
                ),
                Verdict::Measured,
            );
        }
    }
    Ok(())
}
