//! `froude added-mass`: parse, call, print.

use froude::methods::added_mass::options::{Asked, weld_m};
use froude::methods::added_mass::record::{place_in, replaces_another_frame};
use froude::methods::added_mass::verb::{check, put_right};
use froude::pipeline::{Input, Job};

use crate::args::AddedMassArgs;
use crate::failure::Failure;
use crate::out::{note, say};
use crate::print;

pub fn added_mass(args: AddedMassArgs, json: bool) -> Result<(), Failure> {
    renamed(&args)?;
    if let Some(target) = &args.repair {
        let asked = Asked::read(&args.input, &args.options.0)?;
        let weld_m = args.weld.as_deref().map(weld_m).transpose()?;
        return print::answer(&put_right(&asked, &args.input, weld_m, target)?, json);
    }
    if args.weld.is_some() {
        return Err(Failure::WeldWithoutRepair);
    }
    if args.check {
        return print::answer(&check(&Asked::read(&args.input, &args.options.0)?)?, json);
    }
    let job = Job { out: args.out, ..Job::of(Input::Mesh { path: args.input, options: args.options.0 }) };
    // Two matrices of one body in two frames look alike.
    let before = job.folder().and_then(|out| Some((place_in(&out)?, out)));
    let outcome = crate::identified(job)?;
    let replaced = before.and_then(|(place, out)| replaces_another_frame(&out, &place, &outcome.file));
    match replaced {
        Some(text) if json => note!("{text}"),
        Some(text) => say!("{}", froude::report::terminal::wrapped(&text)),
        None => {}
    }
    print::answer(&outcome.outcome(), json)
}

/// What an option was called before says what it is called now.
fn renamed(args: &AddedMassArgs) -> Result<(), Failure> {
    if let Some(z) = &args.z {
        let up = if z == "down" { "--up -z" } else { "--up z" };
        let instead = format!("{up} for how the mesh lies, and --axes ned or enu for the axes of the result");
        return Err(Failure::Renamed { old: "--z", new: "--up", instead });
    }
    if let Some(origin) = &args.origin {
        let at = if origin.trim() == "buoyancy" { "cb".to_owned() } else { format!("{origin:?}") };
        return Err(Failure::Renamed { old: "--origin", new: "--at", instead: format!("--at {at}") });
    }
    Ok(())
}
