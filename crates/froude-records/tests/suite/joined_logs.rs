//! Two logs with clocks of their own: joined as declared, joined by what both recorded, and what is refused.

use std::fmt::Write as _;
use std::path::Path;

use froude_records::finding::Severity;
use froude_records::run::import_run;
use froude_records::sidecar_file::is_part;
use froude_records::table_file::read_table;
use froude_records::units::Dimension;

/// A log of one channel, of these times.
fn write(
    folder: &Path,
    name: &str,
    header: &str,
    times: impl Iterator<Item = f64>,
    value: impl Fn(f64) -> f64,
    stamp: impl Fn(f64) -> f64,
) {
    let mut text = format!("{header}\n");
    for t in times {
        writeln!(text, "{:.6},{:.9}", stamp(t), value(t)).unwrap();
    }
    std::fs::write(folder.join(name), text).unwrap();
}

fn ticks(from_s: f64, to_s: f64, rate_hz: f64) -> impl Iterator<Item = f64> {
    (0..((to_s - from_s) * rate_hz).round() as u32).map(move |i| from_s + f64::from(i) / rate_hz)
}

const OWN: &str = "schema = 1\nmethod = \"steady\"\nrole = \"test\"\n[columns]\nt = { name = \"time\", unit = \"s\" }\n\
                   x = { name = \"position\", unit = \"m\", sign = 1, frame = \"body\", clock = \"log\" }\n";
const OTHER: &str = "schema = 1\n[columns]\ns = { name = \"time\", unit = \"s\" }\n\
                     f = { name = \"f_x\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }\n";
const STATED: &str = "[[log.join]]\nfile = \"load.csv\"\nlag = { value = \"0.37 s\", standard = \"2 ms\" }\ndrift = { value = \"50 ppm\", standard = \"10 ppm\" }\norigin = \"0 s\"\n";

/// A cubic in the load log, which a spline reads exactly; t = s − 0.37 s − 50 ppm s.
fn cubic(t: f64) -> f64 {
    1.0 + t * (0.3 + t * (-0.02 + 4e-4 * t))
}

fn late(t: f64) -> f64 {
    (t + 0.37) / (1.0 - 50e-6)
}

fn two(join: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "motion.csv", "t,x", ticks(0.0, 40.0, 20.0), f64::sin, |t| t);
    write(folder.path(), "load.csv", "s,f", ticks(5.0, 45.0, 25.0), cubic, late);
    std::fs::write(folder.path().join("motion.toml"), format!("{OWN}{join}")).unwrap();
    std::fs::write(folder.path().join("load.toml"), OTHER).unwrap();
    folder
}

/// The microsecond of the stamps times a slope of 0.6 N/s.
const SAME_N: f64 = 1e-6;

#[test]
fn a_declared_lag_and_drift_read_the_other_log_at_the_rows_of_this_one() {
    let folder = two(STATED);
    let path = folder.path().join("motion.csv");
    let run = import_run(&path, None).unwrap();
    // From 5 s on, and to the end of the motion.
    assert!((run.log.time_s[0] - 5.0).abs() < 0.051 && run.log.len() >= 699, "{}", run.log.len());
    for (t, f) in run.log.time_s.iter().zip(run.log.channel("f_x", Dimension::FORCE).unwrap()) {
        assert!((f - cubic(*t)).abs() < SAME_N, "{t}: {f} for {}", cubic(*t));
    }
    // 2 ms and 10 ppm over 5 to 40 s about 0: 10 ppm · √(35²/12 + 22.5²) s = 0.25 ms.
    let standard_s = run.told["f_x"].time_standard_s;
    assert!((standard_s - 2e-3_f64.hypot(0.2466e-3)).abs() < 1e-6, "{standard_s}");
    assert_eq!((run.told["y/position"].time_standard_s, run.told["f_x"].undeclared.len()), (0.0, 0));
    let said = run.findings.iter().find(|f| f.code == "logs-joined").unwrap();
    assert_eq!(said.severity, Severity::Note);
    assert!(said.message.contains("700 of 800 rows") || said.message.contains("699 of 800 rows"), "{}", said.message);
    assert!(
        said.message.contains(
            "stamps of load.csv read 0.37 s ± 3.9 ms more than the time in motion.csv (at the stamp 0 s), and gain 50 ± 20 ppm on it (95 %, as declared)"
        ),
        "{}",
        said.message
    );
    assert_eq!(run.done[0].step, "join");
    assert!((run.done[0].parameters["drift"].value / 50e-6 - 1.0).abs() < 1e-12);
    // A table, and a run of no folder.
    assert_eq!(read_table(&path, None).unwrap().columns.len(), 3);
    assert!(is_part(&folder.path().join("load.csv")) && !is_part(&path));
}

/// Ten samples of the load for one of the motion, and a sine of 1 Hz: the mean of ten has sin(0.1 π)/(0.1 π) = 0.984 of its amplitude, and what is read has all of it.
#[test]
fn means_of_a_faster_log_keep_its_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    let sine = |t: f64| (std::f64::consts::TAU * t).sin();
    write(folder.path(), "motion.csv", "t,x", ticks(0.0, 40.0, 10.0), sine, |t| t);
    write(folder.path(), "load.csv", "s,f", ticks(-1.0, 45.0, 100.0), sine, late);
    std::fs::write(folder.path().join("motion.toml"), format!("{OWN}{STATED}")).unwrap();
    std::fs::write(folder.path().join("load.toml"), OTHER).unwrap();
    let run = import_run(&folder.path().join("motion.csv"), None).unwrap();
    let loads = run.log.channel("f_x", Dimension::FORCE).unwrap();
    // By the correction to second order: 2e-3 of the amplitude, by sums over two phases of the rows.
    for (t, f) in run.log.time_s.iter().zip(loads).filter(|(t, _)| (1.0..39.0).contains(*t)) {
        assert!((f - sine(*t)).abs() < 2e-3, "{t}: {f} for {}", sine(*t));
    }
}

/// Nothing is made up where the other log has no samples, and a lost sample is no gap.
#[test]
fn a_gap_of_the_other_log_is_a_gap_of_both() {
    let folder = two(STATED);
    let kept = ticks(5.0, 45.0, 25.0).filter(|t| !(20.0..23.0).contains(t) && (t - 30.0).abs() > 0.02);
    write(folder.path(), "load.csv", "s,f", kept, cubic, late);
    let run = import_run(&folder.path().join("motion.csv"), None).unwrap();
    assert!(run.log.time_s.iter().all(|t| !(20.01..22.97).contains(t)));
    assert!(run.log.time_s.iter().any(|t| (t - 30.0).abs() < 0.026));
    assert_eq!(run.log.lost.len(), 1);
    for (t, f) in run.log.time_s.iter().zip(&run.log.channels["f_x"].values) {
        assert!((f - cubic(*t)).abs() < SAME_N, "{t}");
    }
}

/// One sidecar for a folder: the star of `files` is that of `file`. Columns may be written beside it.
#[test]
fn one_sidecar_joins_the_logs_of_a_folder_pair_by_pair() {
    let folder = tempfile::tempdir().unwrap();
    for k in 1..3 {
        write(folder.path(), &format!("motion_{k}.csv"), "t,x", ticks(0.0, 40.0, 20.0), f64::sin, |t| t);
        write(
            folder.path(),
            &format!("load_{k}.csv"),
            "s,f",
            ticks(5.0, 45.0, 25.0),
            |t| f64::from(k) * cubic(t),
            late,
        );
    }
    let columns = OTHER.replace("schema = 1\n[columns]", "[log.join.columns]");
    let sidecar = OWN.replacen("schema = 1\n", "schema = 1\nfiles = \"motion_*.csv\"\n", 1)
        + &STATED.replace("load.csv", "load_*.csv")
        + &columns;
    std::fs::write(folder.path().join("logs.toml"), sidecar).unwrap();
    for k in 1..3 {
        let table = read_table(&folder.path().join(format!("motion_{k}.csv")), None).unwrap();
        let (time, f) =
            (table.number("time", Dimension::TIME).unwrap(), table.number("f_x", Dimension::FORCE).unwrap());
        assert!((f[9] - f64::from(k) * cubic(time[9])).abs() < 2.0 * SAME_N);
        assert!(is_part(&folder.path().join(format!("load_{k}.csv"))));
    }
}

/// A sweep in frequency that both logs recorded; the load log has the velocity.
#[test]
fn what_both_recorded_tells_lag_and_drift_and_is_not_kept_twice() {
    let folder = two("[[log.join]]\nfile = \"load.csv\"\nsame = [\"position\", \"speed\"]\n");
    let phase = |t: f64| 0.5 * t + 0.02 * t * t;
    let noise = |t: f64| 2e-3 * (9973.0 * t * t).sin();
    write(folder.path(), "motion.csv", "t,x", ticks(0.0, 40.0, 20.0), |t| phase(t).sin() + noise(t), |t| t);
    let mut text = "s,u,f\n".to_owned();
    for t in ticks(1.0, 39.0, 50.0) {
        let u = (0.5 + 0.04 * t) * phase(t).cos() + noise(t + 0.3);
        writeln!(text, "{:.6},{u:.6},{:.9}", late(t), cubic(t)).unwrap();
    }
    std::fs::write(folder.path().join("load.csv"), text).unwrap();
    let columns =
        format!("{OTHER}u = {{ name = \"speed\", unit = \"m/s\", sign = 1, frame = \"body\", clock = \"log\" }}\n");
    std::fs::write(folder.path().join("load.toml"), columns).unwrap();
    let run = import_run(&folder.path().join("motion.csv"), None).unwrap();
    assert_eq!(run.log.channels.keys().collect::<Vec<_>>(), ["y/position", "f_x"]);
    let of = |name: &str| run.done[0].parameters[name].value;
    assert!((of("lag") - 0.37 - 50e-6 * of("origin")).abs() < 3.0 * of("standard_of_lag"), "{:?}", run.done);
    assert!((of("drift") - 50e-6).abs() < 3.0 * of("standard_of_drift"), "{:?}", run.done);
    assert!(of("standard_uncertainty") < 3e-3, "{:?}", run.done);
    assert!(
        run.findings.iter().any(|f| f.message.contains("from position and speed (position differentiated once)")),
        "{:?}",
        run.findings
    );
}

#[test]
fn what_cannot_be_joined_is_refused_with_what_to_write() {
    let refused = |join: &str| import_run(&two(join).path().join("motion.csv"), None).unwrap_err().to_string();
    let join = |keys: &str| format!("[[log.join]]\nfile = \"load.csv\"\n{keys}\n");
    for (join, words) in [
        (join(""), "[[log.join]] has no `lag`; write same = [\"position\", \"position\"]"),
        (join("lag = { value = \"0.37 s\", standard = \"2 ms\" }"), "has no `drift`; write same"),
        (
            join("lag = \"0.37 s\""),
            "`lag` has no standard uncertainty; write lag = { value = \"…\", standard = \"2 ms\" }",
        ),
        (join("same = \"position\""), "`same` names 1 channel; write two"),
        (join("same = [\"position\", \"heave\"]"), "names \"heave\", which"),
        (
            join("same = [\"position\", \"f_x\"]"),
            "the clocks cannot be aligned from position of motion.csv and f_x of load.csv",
        ),
        (STATED.replace("0.37 s", "900 s"), "overlap in only"),
        (STATED.replace("50 ppm", "20 %"), "is beyond 100 ms/s"),
        (STATED.replace("load.csv", "lod.csv"), "there is no file"),
        (STATED.replace("load.csv", "motion.csv"), "the log that it is joined to"),
        (STATED.replace("load.csv", "load_*.csv"), "stands for what the one * of `files` stands for"),
        (STATED.replace("file", "fille"), "unknown key `fille`"),
        (
            format!(
                "{STATED}[log.join.columns]\ns = {{ name = \"time\", unit = \"s\" }}\nf = {{ name = \"position\", unit = \"m\" }}\n"
            ),
            "both motion.csv and load.csv have it",
        ),
    ] {
        let text = refused(&join);
        assert!(text.contains(words), "{words}\n{text}");
        assert!(text.contains("motion.toml:"), "{text}");
    }
}
