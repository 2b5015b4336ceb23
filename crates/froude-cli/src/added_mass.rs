//! `froude added-mass`: parse, call, print.

use froude::methods::added_mass::options::{Asked, renamed, weld_m};
use froude::methods::added_mass::record::{place_in, replaces_another_frame};
use froude::methods::added_mass::verb::{check, put_right};
use froude::pipeline::{Input, Job};

use crate::args::AddedMassArgs;
use crate::failure::Failure;
use crate::out::{note, say};
use crate::print::{self, Form};

pub fn added_mass(args: AddedMassArgs, form: Form) -> Result<(), Failure> {
    if let Some(why) = renamed(args.z.as_deref(), args.origin.as_deref()) {
        return Err(Failure::refused(why));
    }
    if let Some(target) = &args.repair {
        let asked = Asked::read(&args.input, &args.options.0)?;
        let weld_m = args.weld.as_deref().map(weld_m).transpose()?;
        return print::answer(&put_right(&asked, weld_m, target)?, form);
    }
    if args.weld.is_some() {
        let why = "--weld is for a repair: add --repair FILE, the mesh to be written (.obj or .stl)";
        return Err(Failure::refused(why));
    }
    if args.check {
        return print::answer(&check(&Asked::read(&args.input, &args.options.0)?)?, form);
    }
    let job = Job { out: args.out, ..Job::of(Input::Mesh { path: args.input, options: args.options.0 }) };
    // Two matrices of one body in two frames look alike.
    let before = job.folder().and_then(|out| Some((place_in(&out)?, out)));
    let outcome = crate::identified(job)?;
    let replaced = before.and_then(|(place, out)| replaces_another_frame(&out, &place, &outcome.file));
    match replaced {
        Some(text) if form != Form::Lines => note!("{text}"),
        Some(text) => say!("{}", froude::report::terminal::wrapped(&text)),
        None => {}
    }
    print::answer(&outcome.outcome(), form)
}
