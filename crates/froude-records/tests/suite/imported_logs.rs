//! Servo logs of other programs.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use froude_records::finding::Severity;
use froude_records::run::{Frame, GapCause, import_run};
use froude_records::units::Dimension;

const SIDECAR: &str = "\
schema = 1
[constants]
drive_gain = \"35.15065188 N/V\"
[columns]
t_s = { name = \"time\", unit = \"s\" }
q_ref_m = { name = \"reference_position\", unit = \"m\" }
q_meas_m = { name = \"position\", unit = \"mm\" }
u_ctrl_V = { name = \"command\", unit = \"V\", sign = -1 }
";

fn log(folder: &Path, times: impl IntoIterator<Item = f64>) -> PathBuf {
    let mut text = String::from("t_s,q_ref_m,q_meas_m,u_ctrl_V,other\n");
    for (k, t) in times.into_iter().enumerate() {
        writeln!(text, "{t},0.1,{k},2.5,left out").unwrap();
    }
    let path = folder.join("log.csv");
    std::fs::write(&path, text).unwrap();
    std::fs::write(folder.join("log.toml"), SIDECAR).unwrap();
    path
}

#[test]
fn a_servo_log_becomes_a_run_of_axis_y_in_si() {
    let folder = tempfile::tempdir().unwrap();
    // Steps of 1 ms that differ by 24 ns, as a 41.67 MHz counter gives them.
    let times = (0..1000).map(|k| f64::from(k) * 1e-3 + f64::from(k % 3) * 2.4e-8);
    let imported = import_run(&log(folder.path(), times), None).unwrap();
    let log = imported.log;
    assert_eq!(log.channels.keys().collect::<Vec<_>>(), ["y/reference_position", "y/position", "y/command"]);
    assert_eq!(log.channel("y/position", Dimension::LENGTH).unwrap()[7], 7e-3);
    assert_eq!(log.channel("y/command", Dimension::VOLTAGE).unwrap()[7], -2.5);
    let gain = &log.meta.constants["drive_gain"];
    assert_eq!((gain.value, gain.unit.as_str()), (35.15065188, "N/V"));
    assert!((log.meta.log_rate_hz - 1000.0).abs() < 0.1);
    assert_eq!(log.lost, []);
    let [finding] = imported.findings.as_slice() else { panic!() };
    assert_eq!((finding.severity, finding.code.as_str()), (Severity::Note, "time-steps"));
    assert!(finding.message.starts_with("time steps have a median of 1.0000"), "{}", finding.message);
}

#[test]
fn uneven_time_steps_are_reported_and_nothing_is_resampled() {
    let folder = tempfile::tempdir().unwrap();
    let times = (0..1000).map(|k| f64::from(k) * 1e-3 + f64::from(k * 7 % 11) * 1e-5);
    let imported = import_run(&log(folder.path(), times), None).unwrap();
    assert_eq!(imported.log.len(), 1000);
    let finding = &imported.findings[0];
    assert_eq!((finding.severity, finding.code.as_str()), (Severity::Warning, "uneven-time-steps"));
    assert!((imported.steps.shortest_s - 0.96e-3).abs() < 1e-12 && (imported.steps.longest_s - 1.07e-3).abs() < 1e-12);
    assert!(
        finding.message.contains("the stamps fit no even times within half their resolution (0.01 ms)"),
        "{}",
        finding.message
    );
}

#[test]
fn ticks_missing_in_a_log_are_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let times = (0..1000).filter(|k| !(400..450).contains(k)).map(|k| f64::from(k) * 1e-3);
    let imported = import_run(&log(folder.path(), times), None).unwrap();
    let [gap] = imported.log.lost.as_slice() else { panic!("{:?}", imported.log.lost) };
    assert_eq!((gap.ticks, gap.cause), (Some(50), GapCause::Link));
    assert_eq!((gap.from_s, gap.to_s), (Some(0.399), Some(0.45)));
    assert_eq!(imported.findings[0].code, "time-gaps");
}

#[test]
fn a_time_that_goes_back_or_is_not_there_is_reported_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path(), [0.0, 0.1, 0.1, 0.2]);
    assert_eq!(
        import_run(&path, None).unwrap_err().to_string(),
        format!(
            "{}:4: `time` is 0.1 s as in the row before, and rounding at an even rate does not explain it: delete the row if it was logged \
             twice, or log the time with more digits",
            path.display()
        )
    );
    std::fs::write(folder.path().join("log.toml"), SIDECAR.replace("t_s = { name = \"time\", unit = \"s\" }\n", ""))
        .unwrap();
    let error = import_run(&path, None).unwrap_err().to_string();
    assert!(
        error.starts_with(&format!("{}: there is no column `time`; a log needs its times:", path.display())),
        "{error}"
    );
}

#[test]
fn an_entry_says_what_its_channel_is_and_else_its_name_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = log(folder.path(), [0.0, 1e-3, 2e-3]);
    let entry = "name = \"position\", unit = \"mm\"";
    let write = |to: &str| {
        assert!(SIDECAR.contains(entry));
        std::fs::write(folder.path().join("log.toml"), SIDECAR.replace(entry, to)).unwrap();
    };
    let plain = import_run(&path, None).unwrap().log;
    let position = &plain.channels["y/position"].meaning;
    assert_eq!((position.quantity.as_str(), position.unit.as_str()), ("position", "m"));
    // Nobody said along what, nor which clock wrote the times.
    assert_eq!((position.frame, position.sign, position.clock.as_str()), (Frame::None, 1, "log"));
    assert_eq!(plain.meta.channels["y/command"], plain.channels["y/command"].meaning);

    write(&format!("{entry}, quantity = \"draught\", frame = \"body\", clock = \"camera\", sign = -1"));
    let told = import_run(&path, None).unwrap().log;
    let own = &told.channels["y/position"];
    let meaning = &own.meaning;
    assert_eq!((meaning.quantity.as_str(), meaning.frame, meaning.clock.as_str()), ("draught", Frame::Body, "camera"));
    // A sign in the table is undone when it is read: what is left is what the name means.
    assert_eq!((own.values[2], meaning.sign), (-2e-3, 1));

    let at = folder.path().join("log.toml");
    let error = |to: &str| {
        write(to);
        import_run(&path, None).unwrap_err().to_string()
    };
    let place = format!("{}:7:", at.display());
    assert_eq!(
        error(&format!("{entry}, quantity = \"velocity\"")),
        format!("{place}57: `quantity` is \"velocity\", a speed (m/s); expected a length (m), as its unit says")
    );
    assert_eq!(
        error(&format!("{entry}, quantity = \"postion\"")),
        format!("{place}57: `quantity` is \"postion\"; did you mean `position`?")
    );
    assert_eq!(
        error(&format!("{entry}, frame = \"bodyy\"")),
        format!("{place}54: `frame` is \"bodyy\"; did you mean `body`?")
    );
}

/// Stamps in whole milliseconds of 60 Hz: the even times come back, and the sentence says so.
#[test]
fn rounded_stamps_give_the_even_times_and_lost_samples_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let stamp = |k: u32| (f64::from(k) / 60.0 * 1e3).round() / 1e3;
    let whole = import_run(&log(folder.path(), (0..1440).map(stamp)), None).unwrap();
    assert!(whole.log.time_s.iter().enumerate().all(|(k, t)| (t - k as f64 / 60.0).abs() < 2e-5));
    assert_eq!((whole.findings[0].severity, whole.findings[0].code.as_str()), (Severity::Note, "uneven-time-steps"));
    assert_eq!(
        whole.findings[0].message,
        "time steps have a median of 17.000000 ms, from 16.000000 ms to 17.000000 ms: the stamps are rounded to 1 ms; they fit even times \
         16.66667 ms apart within half of that, and these even times are used instead"
    );
    let kept = (0..1440).filter(|k| k % 40 != 7 && !(600..720).contains(k));
    let lost = import_run(&log(folder.path(), kept.map(stamp)), None).unwrap();
    let message = &lost.findings[0].message;
    assert!(message.contains("2.5 % of the samples (33) are missing, at most 1 in a row"), "{message}");
    assert!(message.contains("120 ticks are missing in 1 gap, the longest of 2.017 s from 9.98333 s on"), "{message}");
    assert_eq!((lost.findings[0].code.as_str(), lost.log.lost.len()), ("time-gaps", 1));
}

/// A counter of 16 bits of milliseconds, and a clock that was set back by a third of a second: each refusal says what to write, and what is written is done.
#[test]
fn a_clock_that_goes_back_says_what_it_may_be_and_what_to_declare() {
    let folder = tempfile::tempdir().unwrap();
    let wrapped = (0..1000).map(|k| f64::from((64_000 + 5 * k) % 65_536) / 1e3);
    let path = log(folder.path(), wrapped);
    assert_eq!(
        import_run(&path, None).unwrap_err().to_string(),
        format!(
            "{}:310: `time` is 0.004 s after 65.535 s: a counter of 16 bits in milliseconds wraps around there, and goes on by 0.005 s as usual. Write \
             clock_wraps = \"65.536 s\" at the head of its sidecar, {} or the one of the folder whose `files` covers it (to create one: schema = 1, this line, and [columns] with each header); do not sort the rows",
            path.display(),
            path.with_extension("toml").display()
        )
    );
    let declare = |line: &str| {
        std::fs::write(
            folder.path().join("log.toml"),
            SIDECAR.replace("schema = 1\n", &format!("schema = 1\n{line}\n")),
        )
        .unwrap();
    };
    declare("clock_wraps = \"65.536 s\"");
    let found = import_run(&path, None).unwrap();
    assert!((found.log.duration_s() - 4.995).abs() < 1e-9 && found.log.len() == 1000);
    assert!(found.findings.iter().any(|f| f.code == "clock-unwrapped" && f.message.contains("1 wrap is undone")));
    declare("clock_wraps = \"60 s\"");
    let error = import_run(&path, None).unwrap_err().to_string();
    assert!(error.contains("not a wrap of the declared 60 s: the step would be −5.531 s"), "{error}");
    declare("clock_wraps = \"60 s\"\nsplit_at_clock_jumps = true");
    assert!(import_run(&path, None).unwrap_err().to_string().contains("exclude each other"));

    let set_back = (0..1000).map(|k| f64::from(k) * 5e-3 - if k < 700 { 0.0 } else { 0.3 });
    let path = log(folder.path(), set_back);
    let error = import_run(&path, None).unwrap_err().to_string();
    assert!(
        error.contains("the clock was set back by 0.295 s") && error.contains("split_at_clock_jumps = true"),
        "{error}"
    );
    assert!(!error.contains("sort the rows,"), "{error}");
    declare("split_at_clock_jumps = true");
    let found = import_run(&path, None).unwrap();
    assert_eq!(found.log.len(), 700);
    assert_eq!(found.log.channels["y/position"].values.len(), 700);
    let split = found.findings.iter().find(|f| f.code == "clock-split").unwrap();
    assert!(split.message.contains("of 2 stretches the longest is used, 700 of 1000 rows"), "{}", split.message);

    let shuffled = (0..1000).map(|k| f64::from(k * 617 % 1000) * 5e-3);
    let error = import_run(&log(folder.path(), shuffled), None).unwrap_err().to_string();
    assert!(error.contains("the rows are not in the order of their times"), "{error}");
}
