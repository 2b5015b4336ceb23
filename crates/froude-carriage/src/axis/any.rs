//! Any axis that a servo drives, along a line or about an axis, from logs of any program: the method `servo`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use froude_identify::IdentifyError;
use froude_identify::answer::Made;
use froude_identify::method::{Declares, Found, Logs, Method, MethodError, Need};
use froude_identify::runs::logs_in;
use froude_identify::source::ReadFile;
use froude_identify::wild;
use froude_records::RecordError;
use froude_records::block::Section;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::estimate::{Estimate, OWN};
use froude_records::finding::{Finding, Severity};
use froude_records::number::plain;
use froude_records::run::stamps::{parts, usual_step_s};
use froude_records::run::{channel_name, run_of_table};
use froude_records::sidecar_file::sidecar_of;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::read_table;
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::declared::{Axis, KEYS, SERVO, VISCOUS};
use super::page::sections;
use super::{ASYMMETRIC, AxisModels, Model, SLOWEST_HZ, by_direction, doubts, files_of_table, one_excitation};
use crate::runs::{implausible, not_applied};
use crate::servo::log::is_even;
use crate::servo::scale::{Errs, ForcePerVolt, Scale};
use crate::servo::settle::uncertain;
use crate::servo::{Chain, Coordinate, Delay, ServoError, ServoLog, SpeedLog, identify_logs, identify_speeds, record};

/// The method `servo`.
#[derive(Debug)]
pub struct AnyServo;

impl Method for AnyServo {
    fn names(&self) -> &'static [&'static str] {
        &[SERVO]
    }

    fn words(&self, _: &str) -> &'static str {
        "inertia, friction and loads of an axis from its position and command"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const NEEDS: [Need; 1] = [Need::of(&["table"], &[])];
        &NEEDS
    }

    fn runs(&self) -> &'static str {
        SERVO
    }

    fn takes(&self) -> &'static [&'static str] {
        &[SERVO]
    }

    fn logs(&self) -> Option<Logs> {
        let told_by = "`method = \"servo\"` in its campaign";
        Some(Logs { words: "the log of a servo", told_by, is_one: |_, _| Ok(false), names: &[SERVO], hold_against })
    }

    fn declares(&self) -> Option<Declares> {
        Some(Declares { section: SERVO, keys: KEYS, plan: &[] })
    }

    fn check(&self, source: &Source) -> Result<(), RecordError> {
        source.section(SERVO)?.map(|s| Axis::read(&s)).transpose().map(drop)
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let axis = declared(source)?;
        progress("reading the logs");
        let logs = read(source, &axis)?;
        progress("identifying the axis");
        fitted(campaign, source, &axis, logs)
    }
}

/// What `[source.servo]` declares; refuses what belongs to the rows of a table.
pub(super) fn declared(source: &Source) -> Result<Axis, MethodError> {
    let refused = |what: &str| {
        MethodError::from(IdentifyError::Campaign { place: source.place.to_string(), what: what.to_owned() })
    };
    let of_rows = [
        (source.keep.is_some(), "`keep` is for a table of loads, and this is the log of a servo: cut the log itself"),
        (source.group.is_some(), "`group` is for a table of loads, and this is the log of a servo; leave it out"),
        (source.tare.is_some(), "`tare` is for a table of loads, and this is the log of a servo; leave it out"),
        (
            !source.models.is_empty(),
            "`models` is for a table of loads; the law of a servo is `friction` and `loads` of [source.servo]",
        ),
        (
            !source.uncertainty.is_empty(),
            "the method servo takes the error of the drive as drive_gain = { value = \"0.35 N m/A\", standard = \"2 %\" } in [source.servo]",
        ),
    ];
    if let Some((_, what)) = of_rows.into_iter().find(|(is, _)| *is) {
        return Err(refused(what));
    }
    let section = source.section(SERVO)?.map(|s| Axis::read(&s)).transpose()?;
    section.ok_or_else(|| {
        refused(
            "nothing is declared of the axis: write [source.servo] with drive_gain = \"0.35 N m/A\" (or \"35 N/V\")",
        )
    })
}

/// Logs as the fit takes them.
struct Read {
    paths: Vec<PathBuf>,
    /// With speeds in the place of the positions where `is_speed`.
    logs: Vec<ServoLog>,
    coordinate: Coordinate,
    is_speed: bool,
    gain: ForcePerVolt<'static>,
    files: Vec<ReadFile>,
    findings: Vec<Finding>,
}

/// Reads the logs of a source.
fn read(source: &Source, axis: &Axis) -> Result<Read, MethodError> {
    let paths = match &source.input {
        Input::Runs { paths, .. } => {
            let mut all = Vec::new();
            for path in paths {
                if path.is_dir() { all.extend(logs_in(path)?) } else { all.push(path.clone()) }
            }
            all
        }
        input => vec![input.path().to_owned()],
    };
    let mut out: Option<Read> = None;
    for path in paths {
        let sidecar = source.sidecar.as_deref();
        let table = read_table(&path, sidecar)?;
        let own = sidecar_of(&path, sidecar)?;
        let imported = run_of_table(&table, own.as_ref())?;
        if !imported.declared.marks.is_empty() {
            return Err(MethodError::input(
                &path,
                "its sidecar marks parts of it, which the method servo does not leave out; cut the log there",
            ));
        }
        let is_speed = is_speed(&table, axis);
        let (position, scale, coordinate) = if is_speed { speed(&table, axis)? } else { position(&table, axis)? };
        let (command, dimension) = command(&table, axis)?;
        let channels = [&position, &command].map(|name| channel_name(name));
        if let Some(what) = not_applied(&imported, &|name| channels.iter().any(|own| own == name), &|_| false) {
            return Err(MethodError::input(
                &path,
                format!("{what} is not applied by the method servo; take it out, or apply it to the log"),
            ));
        }
        let values = |name: &str, factor: f64| -> Result<Vec<f64>, MethodError> {
            let channel = imported.log.channels.get(&channel_name(name));
            let values = channel
                .map(|channel| channel.values.iter().map(|x| factor * x).collect::<Vec<f64>>())
                .unwrap_or_default();
            match values.iter().position(|x| implausible(*x)) {
                None => Ok(values),
                Some(i) => {
                    let time_s = imported.log.time_s.get(i).copied().unwrap_or(f64::NAN);
                    Err(MethodError::input(
                        &path,
                        format!(
                            "{name} is {:e} in SI at {} s, which no axis has: the log is damaged, or its unit is wrong",
                            values[i],
                            plain(time_s, 6)
                        ),
                    ))
                }
            }
        };
        let (coordinate, motor) = at_axis(&table, axis, coordinate)?;
        let gain = gain(&table, axis, &command, dimension, coordinate)?;
        let log = ServoLog {
            time_s: imported.log.time_s.clone(),
            position_m: values(&position, scale / motor)?,
            command_v: values(&command, 1.0)?,
        };
        let names = coordinate.names();
        let [_, unit] = if is_speed { names.speed } else { names.position };
        if let Some(what) = wild::sample_of(&position, unit, &log.time_s, &log.position_m, &[]) {
            return Err(MethodError::input(&path, format!("{what}; correct the sample, or cut the log there")));
        }
        let even = log.evenly().map_err(|error| MethodError::input(&path, error.to_string()))?;
        // Of several logs with even steps nothing need be said.
        let mut findings = imported.findings;
        findings.retain(|finding| finding.code != "time-steps");
        findings.extend(table.findings());
        let name = path.display();
        let done = if is_speed { simulated_over(&log.time_s) } else { even.done };
        findings
            .extend(done.map(|done| Finding::new(Severity::Warning, "uneven-time-steps", format!("{name}: {done}"))));
        findings.extend(
            wild::times(&log.time_s, if is_speed { SLOWEST_SPEED_HZ } else { SLOWEST_HZ })
                .map(|what| Finding::new(Severity::Warning, "implausible-times", format!("{name}: {what}"))),
        );
        let files = files_of_table(&path, sidecar);
        match &mut out {
            None => {
                out = Some(Read { paths: vec![path], logs: vec![log], coordinate, is_speed, gain, files, findings });
            }
            Some(all) => {
                let first = all.paths[0].display().to_string();
                if (coordinate, is_speed) != (all.coordinate, all.is_speed) || gain.unit != all.gain.unit {
                    return Err(MethodError::input(
                        &path,
                        format!(
                            "has different units from {first}; give logs of another axis a [[source]] of their own"
                        ),
                    ));
                }
                if let Some(twin) = all
                    .logs
                    .iter()
                    .position(|other| other.position_m == log.position_m && other.command_v == log.command_v)
                {
                    return Err(MethodError::input(
                        &path,
                        format!(
                            "holds the same samples as {}: a log that counts twice makes every interval too narrow; delete one",
                            all.paths[twin].display()
                        ),
                    ));
                }
                let rate_hz = all.logs[0].evenly().map_err(MethodError::refused)?.rate_hz;
                if (even.rate_hz / rate_hz - 1.0).abs() > SAME_RATE {
                    return Err(MethodError::input(
                        &path,
                        format!(
                            "has {} samples a second, and {first} has {}; give logs of another rate a [[source]] of their own",
                            plain(even.rate_hz, 4),
                            plain(rate_hz, 4)
                        ),
                    ));
                }
                all.paths.push(path);
                all.logs.push(log);
                all.files.extend(files);
                all.findings.extend(findings);
            }
        }
    }
    out.ok_or_else(|| {
        MethodError::input(
            source.input.path(),
            "no logs: put them there as CSV with `time [s]`, `angle [rad]` and `current [A]`, for example",
        )
    })
}

/// What a simulation makes of uneven steps and gaps.
fn simulated_over(time_s: &[f64]) -> Option<String> {
    let step_s = usual_step_s(time_s)?;
    let gaps = parts(time_s).len() - 1;
    let uneven = time_s.windows(2).filter(|w| !is_even(w[1] - w[0], step_s)).count();
    (uneven > 0).then(|| {
        let parts = if gaps > 0 {
            "; each stretch between gaps starts at a speed of its own, and short ones are left out"
        } else {
            ""
        };
        format!(
            "{} from {} ms: the speed is simulated at the stamps as they are{parts}",
            counted(uneven, "step differs", "steps differ"),
            plain(1e3 * step_s, 6)
        )
    })
}

/// Slowest rate of speeds that is not doubted, Hz: a Doppler log may give one in two seconds.
const SLOWEST_SPEED_HZ: f64 = 0.5;

/// Part by which rates of logs may differ: clocks drift.
const SAME_RATE: f64 = 0.02;

/// The column that a key names, or the one of `usual` that is there.
fn column<'t>(table: &'t Table, axis: &Axis, key: &'static str, usual: &[&str]) -> Result<&'t str, MethodError> {
    let bare = |name: &str| name.trim_start_matches("y/").to_owned();
    let names = || {
        table
            .columns
            .iter()
            .filter(|column| matches!(column.data, ColumnData::Number { .. }))
            .map(|column| column.name.as_str())
    };
    if let Some(asked) = axis.values.text(key) {
        let found = names().find(|name| bare(name) == asked || *name == asked);
        return found.ok_or_else(|| {
            axis.values
                .wrong(
                    key,
                    format!(
                        "names {asked:?}, which {} does not have; it has {}",
                        table.path.display(),
                        names().collect::<Vec<_>>().join(", ")
                    ),
                )
                .into()
        });
    }
    let found: Vec<&str> = names().filter(|name| usual.contains(&bare(name).as_str())).collect();
    match found.as_slice() {
        [one] => Ok(*one),
        [] => Err(MethodError::input(
            &table.path,
            format!(
                "has no column {}; it has {}. Write {key} = \"COLUMN\"{} in [source.servo]",
                usual.join(" or "),
                names().collect::<Vec<_>>().join(", "),
                if key == "position" { ", or speed = \"COLUMN\" of a log without a position," } else { "" }
            ),
        )),
        several => {
            let lines: Vec<String> = several.iter().map(|name| format!("{key} = {:?}", bare(name))).collect();
            Err(MethodError::input(
                &table.path,
                format!("has several columns that may be the {key}; write {} in [source.servo]", lines.join(" or ")),
            ))
        }
    }
}

/// How angles are written; any other number without a dimension is taken for counts.
const ANGLES: [&str; 16] = [
    "rad",
    "radian",
    "radians",
    "mrad",
    "deg",
    "°",
    "degree",
    "degrees",
    "gon",
    "rev",
    "revs",
    "revolution",
    "revolutions",
    "turn",
    "turns",
    "arcmin",
];

/// The column of the position, its factor to m or rad, and along what it is.
fn position(table: &Table, axis: &Axis) -> Result<(String, f64, Coordinate), MethodError> {
    let name = column(table, axis, "position", &POSITIONS)?;
    let found = table.columns.iter().find(|column| column.name == name).map(|column| &column.data);
    let Some(ColumnData::Number { unit, dimension, .. }) = found else {
        return Err(MethodError::input(&table.path, format!("{name} holds no numbers")));
    };
    let is_number = *dimension == Dimension::ONE && !ANGLES.contains(&unit.text.as_str());
    match (&axis.count, is_number) {
        (Some(count), true) if count.unit.dimension == Dimension::LENGTH => {
            Ok((name.to_owned(), count.value_si, Coordinate::Linear))
        }
        (Some(count), true) if count.unit.dimension == Dimension::ANGLE => {
            Ok((name.to_owned(), count.value_si, Coordinate::Rotary))
        }
        (Some(_), true) => Err(axis
            .values
            .wrong("count", "is neither a length nor an angle; write count = \"0.1 mm\" or count = \"0.088 deg\"")
            .into()),
        (Some(_), false) => Err(axis
            .values
            .wrong(
                "count",
                format!(
                    "is of a position in counts, and {name} of {} is in {unit}; leave it out",
                    table.path.display()
                ),
            )
            .into()),
        (None, true) => Err(MethodError::input(
            &table.path,
            format!(
                "{name} is a plain number ({unit}); write count = \"0.1 mm\" or count = \"0.088 deg\" in [source.servo], or its unit in the header: `{name} [rad]`"
            ),
        )),
        (None, false) if *dimension == Dimension::LENGTH => Ok((name.to_owned(), 1.0, Coordinate::Linear)),
        (None, false) if *dimension == Dimension::ANGLE => Ok((name.to_owned(), 1.0, Coordinate::Rotary)),
        (None, false) => Err(MethodError::input(
            &table.path,
            format!("{name} is {}; expected a length, an angle or counts", dimension.describe()),
        )),
    }
}

/// Usual names of a column with the speed of an axis.
const SPEEDS: [&str; 3] = ["speed", "angular_speed", "angle_dot"];
const POSITIONS: [&str; 2] = ["position", "angle"];

/// Whether `speed` is declared, or the log has a speed and no position.
fn is_speed(table: &Table, axis: &Axis) -> bool {
    let has = |names: &[&str]| table.columns.iter().any(|c| names.contains(&c.name.trim_start_matches("y/")));
    axis.values.is_stated("speed") || !axis.values.is_stated("position") && !has(&POSITIONS) && has(&SPEEDS)
}

/// The column of the speed, and along what it is.
fn speed(table: &Table, axis: &Axis) -> Result<(String, f64, Coordinate), MethodError> {
    let name = column(table, axis, "speed", &SPEEDS)?;
    let found = table.columns.iter().find(|column| column.name == name).map(|column| &column.data);
    let coordinate = match found {
        Some(ColumnData::Number { dimension: Dimension::SPEED, .. }) => Coordinate::Linear,
        Some(ColumnData::Number { dimension: Dimension::ANGULAR_SPEED, .. }) => Coordinate::Rotary,
        Some(ColumnData::Number { dimension, .. }) => {
            let what = format!("{name} is {}; expected a speed, m/s or rad/s", dimension.describe());
            return Err(MethodError::input(&table.path, what));
        }
        _ => return Err(MethodError::input(&table.path, format!("{name} holds no numbers"))),
    };
    if axis.values.is_stated("count") {
        let what = format!("applies to a position in counts, but {} records a speed; delete it", table.path.display());
        return Err(axis.values.wrong("count", what).into());
    }
    Ok((name.to_owned(), 1.0, coordinate))
}

/// Along what the axis moves, and by what its position is divided: a motor's angle by the gear.
fn at_axis(table: &Table, axis: &Axis, measured: Coordinate) -> Result<(Coordinate, f64), MethodError> {
    let Some((gear, dimension)) = axis.gear.filter(|_| axis.values.word("encoder", &[true, false]) == Some(true))
    else {
        return Ok((measured, 1.0));
    };
    let is_line = dimension != Dimension::ONE;
    if is_line && measured == Coordinate::Linear {
        let what = format!(
            "is \"motor\", but the position of {} is a length and that of a motor is an angle; write encoder = \"axis\"",
            table.path.display()
        );
        return Err(axis.values.wrong("encoder", what).into());
    }
    Ok((if is_line { Coordinate::Linear } else { measured }, gear))
}

/// The column of the command and its dimension.
fn command(table: &Table, axis: &Axis) -> Result<(String, Dimension), MethodError> {
    let name = column(table, axis, "command", &["command", "current", "voltage", "torque", "force", "thrust"])?;
    let found = table.columns.iter().find(|column| column.name == name).map(|column| &column.data);
    match found {
        Some(ColumnData::Number { dimension, .. }) => Ok((name.to_owned(), *dimension)),
        _ => Err(MethodError::input(&table.path, format!("{name} holds no numbers"))),
    }
}

/// What a unit of the command is at the axis.
fn gain(
    table: &Table,
    axis: &Axis,
    command: &str,
    of_command: Dimension,
    coordinate: Coordinate,
) -> Result<ForcePerVolt<'static>, MethodError> {
    let (wanted, example) = match coordinate {
        Coordinate::Linear => (Dimension::FORCE, ["35 N/V", "12 N/A"]),
        Coordinate::Rotary => (Dimension::MOMENT, ["0.2 N m/V", "0.35 N m/A"]),
    };
    let example = example[usize::from(of_command == Dimension::CURRENT)];
    let (gear, of_gear) = axis.gear.unwrap_or((1.0, Dimension::ONE));
    let (declared, dimension) = match (axis.gain, of_command == Dimension::FORCE || of_command == Dimension::MOMENT) {
        (Some(gain), _) => gain,
        (None, true) => (froude_records::run::Declared::exact(1.0), Dimension::ONE),
        (None, false) => {
            return Err(axis
                .values
                .missing(
                    "drive_gain",
                    &format!("write drive_gain = {example:?}: what the motor gives for one unit of {command}"),
                )
                .into());
        }
    };
    let found = of_command.checked_mul(dimension).and_then(|load| load.checked_mul(of_gear));
    if found != Some(wanted) {
        let found = found.map_or_else(|| "no quantity".to_owned(), Dimension::describe);
        let what = format!(
            "times {command} of {} ({}){} is {found}, and the position there is {}: expected {}, as with drive_gain = {example:?}{}",
            table.path.display(),
            of_command.describe(),
            if axis.gear.is_some() { " times gear" } else { "" },
            if coordinate == Coordinate::Linear { "a length" } else { "an angle" },
            wanted.describe(),
            if coordinate == Coordinate::Linear {
                "; of a motor that turns write gear = \"2000 rad/m\" too"
            } else {
                ""
            }
        );
        let key = if axis.gain.is_some() { "drive_gain" } else { "command" };
        return Err(axis.values.wrong(key, what).into());
    }
    let relative = declared.standard_uncertainty / declared.value.abs();
    let scale = (relative > 0.0).then(|| Scale {
        key: format!("{OWN}drive_gain"),
        name: "drive gain, declared".to_owned(),
        quantity: "drive_gain".to_owned(),
        relative,
        dof: None,
        errs: Errs::Factor,
    });
    let unit = dimension.checked_mul(of_gear).map_or_else(String::new, |unit| unit.written_beside(&[of_command]));
    let exact = "the drive gain is taken as exact: an error of it scales all coefficients alike; declare it by drive_gain = { value = \"…\", standard = \"2 %\" }";
    let name = if axis.gear.is_some() { "drive_gain_at_axis" } else { "drive_gain" };
    Ok(ForcePerVolt { name, unit, exact, ..ForcePerVolt::of_log(gear * declared.value, scale) })
}

/// One fit of all logs.
fn fitted(campaign: &Campaign, source: &Source, axis: &Axis, read: Read) -> Result<Found, MethodError> {
    let Read { paths, logs, coordinate, is_speed, gain, files, mut findings } = read;
    let positions = || logs.iter().flat_map(|log| log.position_m.iter().copied());
    let range = [positions().fold(f64::INFINITY, f64::min), positions().fold(f64::NEG_INFINITY, f64::max)];
    if coordinate == Coordinate::Rotary && !is_speed && axis.count.is_none() && range.iter().any(|end| end.abs() > TAU)
    {
        let text = format!(
            "the angle goes from {} to {} rad, beyond a whole turn: a joint that turns on may; degrees under a header in radians would make inertia and viscous friction 57 times too small",
            plain(range[0], 4),
            plain(range[1], 4)
        );
        findings.push(Finding::new(Severity::Note, "angle-beyond-a-turn", text));
    }
    let rate_hz = logs[0].evenly().map_err(MethodError::refused)?.rate_hz;
    if is_speed && axis.law() != VISCOUS {
        let what = "must be \"viscous\" here: the logs have a speed but no position, and dry friction cannot be identified from a speed alone; write friction = \"viscous\", or record the position";
        return Err(axis.values.wrong("friction", what).into());
    }
    let mut chain = Chain {
        coordinate,
        load: axis.load(campaign, coordinate, (!is_speed).then_some(range))?,
        ..Chain::of_log(gain.n_v, rate_hz, axis.friction(coordinate)?)
    };
    let refused = |error: ServoError| MethodError::input(source.input.path(), error.to_string());
    let delay = axis.values.constant("delay");
    if let Some(delay) = &delay {
        chain.delay = Delay { at_s: delay.value, is_estimated: false, changes: Vec::new() };
    }
    let delay_standard_s = delay.map_or(0.0, |delay| delay.standard_uncertainty);
    let report = if is_speed {
        let of = |log: ServoLog| SpeedLog { time_s: log.time_s, speed: log.position_m, command_v: log.command_v };
        let logs: Vec<SpeedLog> = logs.into_iter().map(of).collect();
        identify_speeds(&logs, &chain, delay_standard_s).map_err(refused)?
    } else {
        // Each by itself first: its error names it.
        for (path, log) in paths.iter().zip(&logs) {
            chain.rows(log).map_err(|error| MethodError::input(path, error.to_string()))?;
        }
        if delay_standard_s > 0.0 {
            chain = uncertain(&logs, &chain, delay_standard_s).map_err(refused)?;
        }
        identify_logs(&logs, &chain).map_err(refused)?
    };
    let model = Model { name: axis.law().to_owned(), report };
    findings.extend(doubts(&model.name, &model.report.fit));
    let estimate = record::rigid(&source.name, &model.name, &model.report.fit, &gain);
    let estimate = Estimate {
        id: format!("{}/{SERVO}", source.name),
        kind: source.kind.name().to_owned(),
        method: froude_records::estimate::MethodUsed { name: SERVO.to_owned(), ..estimate.method },
        ..estimate
    };
    let models = vec![model];
    if models.iter().any(|model| model.name == ASYMMETRIC) && by_direction(&models).is_none() {
        let text = "no difference of friction between the directions is detected: friction = \"coulomb\" has fewer coefficients";
        findings.push(Finding::new(Severity::Note, "servo", text.to_owned()));
    }
    if paths.len() == 1 {
        findings.push(one_excitation("give the source several logs of different motions (runs = \"FOLDER\")"));
    }
    let models = AxisModels { models, estimates: vec![(estimate, files)], ..AxisModels::default() };
    let (summary, blocks) = sections(&models);
    let results = models
        .estimates
        .into_iter()
        .map(|(estimate, files)| Made { name: format!("{}, {SERVO}", source.name), estimate, files }.into());
    Ok(Found { results: results.collect(), summary: Some(summary), blocks, findings, ..Found::default() })
}

/// Estimates of the method held against a log that none of them was fitted to.
fn hold_against(source: &Source, _: &[&Estimate]) -> Result<(Vec<Finding>, Section), MethodError> {
    Err(MethodError::input(
        source.input.path(),
        "is the log of a servo that is to validate a fit, which the method servo does not do: fit it as a source of its own and compare the coefficients",
    ))
}
