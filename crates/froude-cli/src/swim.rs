//! `froude swim`: parse, call, print.

use std::path::PathBuf;

use froude::report::write::{write_files, write_folder};
use froude::swim::gait::{Envelope, Gait};
use froude::swim::verb::typed::{NotUnderstood, angle, frequency, objectives, ranges, step};
use froude::swim::verb::{Drawing, Job, Moves, Pitching, Ranges, SweepJob, Typed, optimise, sweep, swim as run};

use crate::args::SwimArgs;
use crate::failure::Failure;
use crate::out::Bar;
use crate::print::{self, Form};

pub fn swim(args: SwimArgs, form: Form) -> Result<(), Failure> {
    if let Some(ranges) = &args.sweep {
        return swept(ranges, &args, form);
    }
    let job = Job {
        moves: moves(&args)?,
        pitching: pitching(&args)?,
        draws: drawing(&args),
        robot: args.robot,
        motor: args.motor,
        step_s: typed(args.step.as_deref(), step)?,
        out: args.out,
        periods: args.periods as usize,
        date: Some(crate::today()),
        is_sensitive: args.sensitivity,
    };
    let bar = Bar::of("draws");
    let found = run(&job, &|done, all| bar.is_at(done, all));
    drop(bar);
    let found = found?;
    if let Some(out) = &job.out {
        write_folder(&found, out)?;
    }
    print::answer(&found, form)
}

/// The wave of the joints that pitch; what is left out says nothing.
fn pitching(args: &SwimArgs) -> Result<Pitching, Failure> {
    let angle_of = |option, text: &Option<String>| typed(text.as_deref(), |text| angle(option, text));
    Ok(Pitching {
        amplitude_rad: angle_of("--pitch-amplitude", &args.pitch_amplitude)?,
        ahead_rad: angle_of("--pitch-ahead", &args.pitch_ahead)?,
        turn_rad: angle_of("--pitch-turn", &args.pitch_turn)?,
    })
}

fn moves(args: &SwimArgs) -> Result<Moves, Failure> {
    if let Some(track) = &args.track {
        return Ok(Moves::Track(track.clone()));
    }
    let angle_of = |option, text: &Option<String>| typed(text.as_deref(), |text| angle(option, text));
    let given = Typed {
        amplitude_rad: angle_of("--amplitude", &args.amplitude)?,
        frequency_rad_s: typed(args.frequency.as_deref(), frequency)?,
        phase_rad: angle_of("--phase", &args.phase)?,
        turn_rad: angle_of("--turn", &args.turn)?,
    };
    let envelope = match args.gait.as_str() {
        "lateral" => Envelope::Lateral,
        "eel" => Envelope::Eel,
        file => return Ok(Moves::File { path: PathBuf::from(file), typed: given }),
    };
    let need = |given: Option<f64>, option, example| {
        let why = format!("a gait has {option}: write {option} '{example}', or name a gait file: --gait gait.toml");
        given.ok_or(Failure::Refused(why))
    };
    Ok(Moves::Wave(Gait {
        amplitude: need(given.amplitude_rad, "--amplitude", "30 deg")?,
        frequency: need(given.frequency_rad_s, "--frequency", "80 deg/s")?,
        phase: need(given.phase_rad, "--phase", "40 deg")?,
        turn: given.turn_rad.unwrap_or(0.0),
        envelope,
        pitching: None,
    }))
}

/// What an option says, where it is given.
fn typed<T>(text: Option<&str>, read: impl Fn(&str) -> Result<T, NotUnderstood>) -> Result<Option<T>, Failure> {
    text.map(read).transpose().map_err(Failure::refused)
}

fn drawing(args: &SwimArgs) -> Option<Drawing> {
    args.draws.map(|n| Drawing { n: n as usize, seed: args.seed })
}

/// Ranges of the numbers of a gait.
fn swept(text: &str, args: &SwimArgs, form: Form) -> Result<(), Failure> {
    let ranges = ranges(text).map_err(Failure::refused)?;
    let job = SweepJob {
        robot: args.robot.clone(),
        moves: moves(&one_of(args, &ranges)?)?,
        ranges,
        motor: args.motor.clone(),
        step_s: typed(args.step.as_deref(), step)?,
        draws: drawing(args),
        out: args.out.clone().unwrap_or_default(),
    };
    let objectives = objectives(&args.optimise).map_err(Failure::refused)?;
    let bar = Bar::of("rows");
    let tell = |done, all| bar.is_at(done, all);
    let found = match objectives {
        Some(of) => optimise(&job, of, &tell),
        None => sweep(&job, &tell),
    };
    drop(bar);
    let found = found?;
    write_files(&found)?;
    print::answer(&found, form)
}

/// What was typed, with a value of each range where a gait needs one.
fn one_of(args: &SwimArgs, ranges: &Ranges) -> Result<SwimArgs, Failure> {
    let mut args = args.clone();
    let both = [
        ("--amplitude", &mut args.amplitude, ranges.amplitude, "rad"),
        ("--frequency", &mut args.frequency, ranges.frequency, "rad/s"),
        ("--phase", &mut args.phase, ranges.phase, "rad"),
        ("--turn", &mut args.turn, ranges.turn, "rad"),
    ];
    for (option, typed, range, unit) in both {
        let Some(range) = range else { continue };
        if let Some(text) = typed {
            let problem = "is swept already".to_owned();
            let found = NotUnderstood { option, text: text.clone(), problem, example: "it in --sweep only" };
            return Err(Failure::refused(found));
        }
        *typed = Some(format!("{} {unit}", range.low));
    }
    Ok(args)
}
