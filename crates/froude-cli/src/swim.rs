//! `froude swim`: parse, call, print.

mod sweep;

use std::path::PathBuf;

use froude::report::write::write_folder;
use froude::swim::gait::{Envelope, Gait};
use froude::swim::verb::typed::{angle, frequency, step};
use froude::swim::verb::{Drawing, Job, Moves, Pitching, Typed, swim as run};

use crate::args::SwimArgs;
use crate::failure::Failure;
use crate::out::Bar;
use crate::print;

pub fn swim(args: SwimArgs, json: bool) -> Result<(), Failure> {
    if let Some(ranges) = &args.sweep {
        return sweep::sweep(ranges, &args, json);
    }
    let job = Job {
        moves: moves(&args)?,
        pitching: pitching(&args)?,
        draws: drawing(&args),
        robot: args.robot,
        motor: args.motor,
        step_s: args.step.as_deref().map(step).transpose().map_err(Failure::Quantity)?,
        out: args.out,
        periods: args.periods as usize,
        date: Some(crate::today()),
        is_sensitive: args.sensitivity,
    };
    let bar = Bar::of("draws");
    let found = run(&job, &|done, all| bar.is_at(done, all));
    bar.finish_and_clear();
    let found = found?;
    if let Some(out) = &job.out {
        write_folder(&found, out)?;
    }
    print::answer(&found, json)
}

/// The wave of the joints that pitch; what is left out says nothing.
fn pitching(args: &SwimArgs) -> Result<Pitching, Failure> {
    let angle_of = |option, text: &Option<String>| {
        text.as_deref().map(|text| angle(option, text)).transpose().map_err(Failure::Quantity)
    };
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
    let angle_of = |option, text: &Option<String>| {
        text.as_deref().map(|text| angle(option, text)).transpose().map_err(Failure::Quantity)
    };
    let typed = Typed {
        amplitude_rad: angle_of("--amplitude", &args.amplitude)?,
        frequency_rad_s: args.frequency.as_deref().map(frequency).transpose().map_err(Failure::Quantity)?,
        phase_rad: angle_of("--phase", &args.phase)?,
        turn_rad: angle_of("--turn", &args.turn)?,
    };
    let envelope = match args.gait.as_str() {
        "lateral" => Envelope::Lateral,
        "eel" => Envelope::Eel,
        file => return Ok(Moves::File { path: PathBuf::from(file), typed }),
    };
    let need = |given: Option<f64>, option, example| given.ok_or(Failure::NoGait { option, example });
    Ok(Moves::Wave(Gait {
        amplitude: need(typed.amplitude_rad, "--amplitude", "30 deg")?,
        frequency: need(typed.frequency_rad_s, "--frequency", "80 deg/s")?,
        phase: need(typed.phase_rad, "--phase", "40 deg")?,
        turn: typed.turn_rad.unwrap_or(0.0),
        envelope,
    }))
}

/// What is to be drawn.
fn drawing(args: &SwimArgs) -> Option<Drawing> {
    args.draws.map(|n| Drawing { n: n as usize, seed: args.seed })
}
