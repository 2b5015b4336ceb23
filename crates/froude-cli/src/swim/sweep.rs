//! `froude swim --sweep`: ranges of a gait's numbers.

use froude::records::units::{Dimension, parse_quantity};
use froude::report::write::write_files;
use froude::swim::front::Objective;
use froude::swim::sweep::Axis;
use froude::swim::verb::{Ranges, SweepJob, optimise, sweep as run};

use crate::args::SwimArgs;
use crate::failure::Failure;
use crate::out::Bar;
use crate::print;

const EXAMPLE: &str = "ranges with their unit and how many values: 'amplitude=10..50 deg:9, phase=10..80 deg:8'";
/// Most values of a range.
const MOST: usize = 1_000_000;

pub fn sweep(text: &str, args: &SwimArgs, json: bool) -> Result<(), Failure> {
    let ranges = ranges(text)?;
    let job = SweepJob {
        robot: args.robot.clone(),
        moves: super::moves(&swept(args, &ranges)?)?,
        ranges,
        motor: args.motor.clone(),
        step_s: args.step.as_deref().map(super::step).transpose()?,
        draws: super::drawing(args),
        out: args.out.clone().unwrap_or_default(),
    };
    let objectives = objectives(&args.optimise)?;
    let bar = Bar::of("rows");
    let tell = |done, all| bar.is_at(done, all);
    let found = match objectives {
        Some(of) => optimise(&job, of, &tell),
        None => run(&job, &tell),
    };
    bar.finish_and_clear();
    let found = found?;
    write_files(&found)?;
    print::answer(&found, json)
}

/// Two objectives that differ; `None` where a sweep is asked for.
fn objectives(names: &[String]) -> Result<Option<[Objective; 2]>, Failure> {
    let of =
        |name: &String| [Objective::Speed, Objective::Power, Objective::Cost].into_iter().find(|o| o.name() == name);
    let found: Vec<Objective> = names.iter().filter_map(of).collect();
    match found[..] {
        [] => Ok(None),
        [a, b] if a != b => Ok(Some([a, b])),
        _ => Err(Failure::Quantity {
            option: "--optimise",
            text: names.join(","),
            problem: "is not two different objectives".to_owned(),
            example: "two of speed, power, cost: --optimise speed,power",
        }),
    }
}

/// What was typed, with a value of each range where a gait needs one.
fn swept(args: &SwimArgs, ranges: &Ranges) -> Result<SwimArgs, Failure> {
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
            return Err(Failure::Quantity { option, text: text.clone(), problem, example: "it in --sweep only" });
        }
        *typed = Some(format!("{} {unit}", range.low));
    }
    Ok(args)
}

fn ranges(text: &str) -> Result<Ranges, Failure> {
    let mut found = Ranges::default();
    for part in text.split(',') {
        let wrong = |problem: String| failure(part.trim(), problem);
        let (name, rest) = part.split_once('=').ok_or_else(|| wrong("has no '='".to_owned()))?;
        let (place, of): (_, fn(&str) -> Result<f64, String>) = match name.trim() {
            "amplitude" => (&mut found.amplitude, angle),
            "frequency" => (&mut found.frequency, frequency),
            "phase" => (&mut found.phase, angle),
            "turn" => (&mut found.turn, angle),
            other => {
                return Err(wrong(format!("begins with {other:?}; swept are amplitude, frequency, phase and turn")));
            }
        };
        if place.is_some() {
            return Err(wrong("is there twice".to_owned()));
        }
        *place = Some(axis(rest, of).map_err(wrong)?);
    }
    Ok(found)
}

/// `10..50 deg:9`; the first number may have a unit of its own.
fn axis(text: &str, of: fn(&str) -> Result<f64, String>) -> Result<Axis, String> {
    let (ends, n) = text.rsplit_once(':').ok_or("does not say how many values (':9')")?;
    let n: usize = n.trim().parse().map_err(|_| format!("has {:?} where a number of values stands", n.trim()))?;
    if !(2..=MOST).contains(&n) {
        return Err(format!("has {n} values; a range has two at least and {MOST} at most"));
    }
    let (low, high) = ends.split_once("..").ok_or("has no '..' between its ends")?;
    let unit = parse_quantity(high).map_err(|e| format!("cannot be read: {e}"))?.unit.text;
    let low = if low.trim().parse::<f64>().is_ok() { format!("{} {unit}", low.trim()) } else { low.to_owned() };
    let (low, high) = (of(&low)?, of(high)?);
    if low >= high {
        return Err("does not go up: its first number is not below its last".to_owned());
    }
    Ok(Axis { low, high, n })
}

fn angle(text: &str) -> Result<f64, String> {
    let found = parse_quantity(text).map_err(|e| format!("cannot be read: {e}"))?;
    if found.unit.dimension != Dimension::ANGLE || found.unit.text == "1" {
        return Err(format!("is {}, and an angle is asked for", found.unit.dimension.describe()));
    }
    Ok(found.value_si)
}

fn frequency(text: &str) -> Result<f64, String> {
    let found = parse_quantity(text).map_err(|e| format!("cannot be read: {e}"))?;
    froude::swim::gait_file::angular_frequency(&found)
}

fn failure(text: &str, problem: String) -> Failure {
    Failure::Quantity { option: "--sweep", text: text.to_owned(), problem, example: EXAMPLE }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn ranges_are_read_in_their_unit() {
        let found = ranges("amplitude=10..50 deg:9, frequency=0.1..0.3 Hz:3,turn=-0.1 rad..10 deg:2").unwrap();
        let amplitude = found.amplitude.unwrap();
        assert_eq!((amplitude.low, amplitude.high, amplitude.n), (10_f64.to_radians(), 50_f64.to_radians(), 9));
        assert!((found.frequency.unwrap().at(1) - std::f64::consts::TAU * 0.2).abs() < 1e-15);
        assert_eq!((found.turn.unwrap().low, found.phase), (-0.1, None));
    }

    #[test]
    fn what_is_no_range_is_said() {
        for (text, problem) in [
            ("amplitude", "has no '='"),
            ("size=1..2 deg:3", "begins with \"size\""),
            ("phase=1..2 deg:3, phase=1..2 deg:3", "is there twice"),
            ("phase=1..2 deg", "how many values"),
            ("phase=1..2 deg:1", "two at least"),
            ("phase=1..2 deg:x", "\"x\""),
            ("phase=1 deg:3", "'..'"),
            ("phase=2..1 deg:3", "does not go up"),
            ("phase=1..2:3", "cannot be read"),
            ("phase=1..2 m:3", "an angle is asked for"),
            ("frequency=0..2 Hz:3", "not above zero"),
            ("frequency=1..2 1/s:3", "radians or cycles"),
        ] {
            let told = ranges(text).unwrap_err().to_string();
            assert!(told.starts_with("--sweep") && told.contains(problem), "{text}: {told}");
        }
    }
}
