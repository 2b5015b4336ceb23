//! EMPS: a real motor-driven axis, published as a benchmark with reference parameters but white-noise intervals.

use std::error::Error;
use std::path::Path;

use froude::methods::carriage::servo::held_out::halves;
use froude::methods::carriage::servo::{Chain, Delay, Friction, ServoLog, ServoReport, identify_servo};
use froude::records::number::significant;
use froude::records::table_file::read_table;
use froude::records::units::Dimension;

use crate::claims::{Claims, Verdict};

const SECTION: &str = "EMPS: a motor-driven axis from its command and encoder (Janot, Gautier & Brunot 2019)";

/// Force per volt of command, N/V (data README).
const FORCE_PER_VOLT_N_V: f64 = 35.15065188;

/// Period of the trajectory, s: its reference repeats to the last digit after 6,240 samples (the description of the data says 6.16 s).
const PERIOD_S: f64 = 6.24;

/// `(name, value, standard deviation)` as printed, IDIM-LS, symmetric model.
const SYMMETRIC: [(&str, f64, f64); 4] =
    [("M", 95.1089, 0.1085), ("F_v", 203.5034, 1.1460), ("F_c", 20.3935, 0.1012), ("offset", -3.1648, 0.0444)];

/// The same, asymmetric model.
const ASYMMETRIC: [(&str, f64, f64); 5] = [
    ("M", 95.1540, 0.0827),
    ("F_v+", 166.7061, 1.2326),
    ("F_v-", 240.4236, 1.2346),
    ("F_c+", 20.1440, 0.1088),
    ("F_c-", 20.6277, 0.1091),
];

pub fn all(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let log = read(root)?;
    for (name, friction, printed, error_percent) in [
        ("symmetric", Friction::symmetric(), &SYMMETRIC[..], 4.083),
        ("asymmetric", Friction::asymmetric(), &ASYMMETRIC[..], 3.112),
    ] {
        let chain = Chain::new(FORCE_PER_VOLT_N_V, friction);
        let report = identify_servo(&log, &chain)?;
        parameters(claims, name, &report, printed);
        claims.near(
            SECTION,
            &format!("{name}: relative force error, %"),
            100.0 * report.fit.relative_force_error,
            error_percent,
            0.05,
            "publication; band of the issue",
        );
        honesty(claims, name, &report, printed);
        prediction(claims, name, &report, &log, &chain)?;
        as_any_log(claims, name, &log, &chain, printed)?;
    }
    Ok(())
}

fn read(root: &Path) -> Result<ServoLog, Box<dyn Error>> {
    let folder = root.join("examples/emps");
    let table = read_table(&folder.join("emps.csv"), Some(&folder.join("emps.toml")))?;
    let of = |name: &str, dimension| table.number(name, dimension).map(<[f64]>::to_vec);
    Ok(ServoLog {
        time_s: of("time", Dimension::TIME)?,
        position_m: of("position", Dimension::LENGTH)?,
        command_v: of("command", Dimension::VOLTAGE)?,
    })
}

/// As the verb fits any log, samples near rest and reversal left out: with the delay of the publication, zero, and with a fitted one.
fn as_any_log(
    claims: &mut Claims,
    name: &str,
    log: &ServoLog,
    chain: &Chain,
    printed: &[(&str, f64, f64)],
) -> Result<(), Box<dyn Error>> {
    let chain = Chain::of_log(FORCE_PER_VOLT_N_V, log.rate_hz()?, chain.friction.clone());
    let (_, mass, _) = printed[0];
    let at_once = Chain { delay: Delay::default(), ..chain.clone() };
    for (chain, words, is_judged) in [(&at_once, "delay 0 as published", true), (&chain, "delay fitted", false)] {
        let report = identify_servo(log, chain)?;
        let interval = report.fit.coefficient("M").map_or([f64::NAN; 2], |c| c.interval);
        let each = report
            .fit
            .coefficients
            .iter()
            .map(|c| format!("{} {} ± {}", c.name, significant(c.value, 5), significant(c.block_std, 2)));
        // The published fit has no delay. The 0.77 ms that the log shows lower M by 0.09 kg, so its value is no reference there.
        let contains = (interval[0]..=interval[1]).contains(&mass);
        claims.add(
            SECTION,
            &format!("{name}: as `froude identify` fits a log, without samples near rest and reversal; {words}"),
            "the interval of M contains the published value",
            format!(
                "{}, interval of M [{:.2}, {:.2}]; force error {:.2} %",
                each.collect::<Vec<_>>().join(", "),
                interval[0],
                interval[1],
                100.0 * report.fit.relative_force_error
            ),
            match (contains, is_judged) {
                (true, _) => Verdict::Pass,
                (false, true) => Verdict::Miss,
                (false, false) => Verdict::Finding,
            },
        );
    }
    Ok(())
}

/// Fit on two of the four periods, predict the force on the other two: the worst of the six choices.
fn prediction(
    claims: &mut Claims,
    name: &str,
    report: &ServoReport,
    log: &ServoLog,
    chain: &Chain,
) -> Result<(), Box<dyn Error>> {
    let bar_percent = if name == "symmetric" { 3.9 } else { 2.8 };
    let worst = |rows| -> Result<f64, Box<dyn Error>> {
        Ok(halves(rows, PERIOD_S)?.iter().map(|h| 100.0 * h.relative_error).fold(0.0, f64::max))
    };
    let pinned = worst(&report.rows)?;
    // The error of the whole fit, nothing held out, is above the bar already: on this chain it cannot be met.
    claims.add(
        SECTION,
        &format!("{name}: force on two periods predicted from the other two, pinned chain (by 10), worst of six, %"),
        &format!("≤ {bar_percent} (issue); in sample {:.2}", 100.0 * report.fit.relative_force_error),
        format!("{pinned:.2}"),
        if pinned <= bar_percent { Verdict::Pass } else { Verdict::Finding },
    );
    let by_20 = worst(&Chain { decimation: 20, ..chain.clone() }.rows(log)?)?;
    claims.holds(
        SECTION,
        &format!("{name}: the same with decimation by 20, %"),
        &format!("≤ {bar_percent} (issue)"),
        format!("{by_20:.2}"),
        by_20 <= bar_percent,
    );
    Ok(())
}

/// Each coefficient against the published one, in published standard deviations.
fn parameters(claims: &mut Claims, name: &str, report: &ServoReport, printed: &[(&str, f64, f64)]) {
    for &(coefficient, value, std) in printed {
        let found = report.fit.coefficient(coefficient).map_or(f64::NAN, |c| c.value);
        claims.near(
            SECTION,
            &format!("{name}: {coefficient}, SI"),
            found,
            value,
            std,
            "publication, its own standard deviation",
        );
    }
}

/// The published intervals against those that hold for residuals which are not white.
fn honesty(claims: &mut Claims, name: &str, report: &ServoReport, printed: &[(&str, f64, f64)]) {
    for &(coefficient, _, std) in printed {
        let Some(c) = report.fit.coefficient(coefficient) else { continue };
        claims.add(
            SECTION,
            &format!("{name}: standard deviation of {coefficient}: published, classical, HAC, blocks"),
            "blocks and HAC larger: residuals are correlated",
            format!("{std}, {:.4}, {:.4}, {:.4} {}", c.classical_std, c.hac_std, c.block_std, c.unit),
            if c.block_std > std { Verdict::Finding } else { Verdict::Measured },
        );
    }
    if let Some(w) = &report.whiteness {
        claims.add(
            SECTION,
            &format!("{name}: whiteness of the residuals"),
            "white, if the published standard deviations were to hold",
            format!(
                "r1 = {:.2}, Ljung-Box({}) = {:.0} (p = {:.1e}), correlation time {}; HAC lag {:.2} s, blocks {:.2} s",
                w.r1,
                w.lags,
                w.ljung_box,
                w.p,
                w.correlation_time_s.map_or("longer than the record can tell".to_owned(), |t| format!("{t:.2} s")),
                report.hac_lag_s,
                report.block_s
            ),
            if w.is_white() { Verdict::Measured } else { Verdict::Finding },
        );
    }
}
