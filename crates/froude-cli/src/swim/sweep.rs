//! `froude swim --sweep`: ranges of a gait's numbers.

use froude::report::write::write_files;
use froude::swim::verb::typed::{self, NotUnderstood, objectives, ranges};
use froude::swim::verb::{Ranges, SweepJob, optimise, sweep as run};

use crate::args::SwimArgs;
use crate::failure::Failure;
use crate::out::Bar;
use crate::print;

pub fn sweep(text: &str, args: &SwimArgs, json: bool) -> Result<(), Failure> {
    let ranges = ranges(text).map_err(Failure::Quantity)?;
    let job = SweepJob {
        robot: args.robot.clone(),
        moves: super::moves(&swept(args, &ranges)?)?,
        ranges,
        motor: args.motor.clone(),
        step_s: args.step.as_deref().map(typed::step).transpose().map_err(Failure::Quantity)?,
        draws: super::drawing(args),
        out: args.out.clone().unwrap_or_default(),
    };
    let objectives = objectives(&args.optimise).map_err(Failure::Quantity)?;
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
            let found = NotUnderstood { option, text: text.clone(), problem, example: "it in --sweep only" };
            return Err(Failure::Quantity(found));
        }
        *typed = Some(format!("{} {unit}", range.low));
    }
    Ok(args)
}
