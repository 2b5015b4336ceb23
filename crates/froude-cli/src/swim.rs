//! `froude swim`: parse, call, print.

use froude::records::units::{Dimension, parse_quantity};
use froude::swim::{Job, swim as run};
use froude::swimmer::gait::{Envelope, Gait};

use crate::args::{GaitKind, SwimArgs};
use crate::failure::Failure;
use crate::out::say;
use crate::print;

pub fn swim(args: SwimArgs, json: bool) -> Result<(), Failure> {
    let gait = Gait {
        amplitude: angle("--amplitude", &args.amplitude)?,
        frequency: frequency(&args.frequency)?,
        phase: angle("--phase", &args.phase)?,
        turn: angle("--turn", &args.turn)?,
        envelope: match args.gait {
            GaitKind::Lateral => Envelope::Lateral,
            GaitKind::Eel => Envelope::Eel,
        },
    };
    let job = Job { robot: args.robot, gait, out: args.out, periods: args.periods as usize };
    let swum = run(&job)?;
    if json {
        return print::json(&swum.as_json());
    }
    print::summary(&swum.section());
    if let Some(path) = &swum.written {
        say!("\ntrajectory {}", path.display());
    }
    Ok(())
}

fn angle(option: &'static str, text: &str) -> Result<f64, Failure> {
    quantity(option, text, Dimension::ANGLE, "an angle with its unit: '30 deg'")
}

/// rad/s, from an angular speed or from cycles a second.
fn frequency(text: &str) -> Result<f64, Failure> {
    let example = "an angular speed or a frequency with its unit: '80 deg/s' or '0.22 Hz'";
    let found = quantity("--frequency", text, Dimension::ANGULAR_SPEED, example)?;
    let is_cycles = parse_quantity(text).is_ok_and(|q| q.unit.text.ends_with("Hz"));
    // One over a second is either.
    if !is_cycles && !["deg", "rad", "rev", "rpm"].iter().any(|angle| text.contains(angle)) {
        let problem = "does not say whether it counts radians or cycles".to_owned();
        return Err(Failure::Quantity { option: "--frequency", text: text.to_owned(), problem, example });
    }
    let found = if is_cycles { std::f64::consts::TAU * found } else { found };
    if found > 0.0 && found.is_finite() {
        return Ok(found);
    }
    Err(Failure::Quantity {
        option: "--frequency",
        text: text.to_owned(),
        problem: "is not above zero".to_owned(),
        example,
    })
}

fn quantity(option: &'static str, text: &str, dimension: Dimension, example: &'static str) -> Result<f64, Failure> {
    let wrong = |problem: String| Failure::Quantity { option, text: text.to_owned(), problem, example };
    if text.trim().parse::<f64>().is_ok() {
        return Err(wrong("has no unit".to_owned()));
    }
    let found = parse_quantity(text).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    // A pure number is an angle by its dimension, and hardly ever by what was meant.
    if found.unit.dimension != dimension || found.unit.text == "1" {
        return Err(wrong(format!("is {}", found.unit.dimension.describe())));
    }
    Ok(found.value_si)
}
