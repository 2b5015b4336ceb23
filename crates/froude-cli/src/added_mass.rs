//! `froude added-mass`: parse, call, print.

use std::path::Path;

use froude::methods::added_mass::body::forecasts as forecasts_of;
use froude::methods::added_mass::load::Loaded;
use froude::methods::added_mass::options::{Asked, weld_m};
use froude::methods::added_mass::record::{place_in, replaces_another_frame};
use froude::methods::added_mass::repair::repair;
use froude::panel::refine::Forecast;
use froude::pipeline::{Input, Job};
use froude::records::number::duration;
use froude::records::page::TextTable;

use crate::args::AddedMassArgs;
use crate::failure::Failure;
use crate::out::{note, say};
use crate::print;

pub fn added_mass(args: AddedMassArgs, json: bool) -> Result<(), Failure> {
    renamed(&args)?;
    if let Some(target) = &args.repair {
        return put_right(&args, target, json);
    }
    if args.weld.is_some() {
        return Err(Failure::WeldWithoutRepair);
    }
    if args.check {
        return check(&Asked::read(&args.input, &args.options.0)?, json);
    }
    let job = Job { out: args.out, ..Job::of(Input::Mesh { path: args.input, options: args.options.0 }) };
    // Two matrices of one body in two frames look alike.
    let before = job.folder().and_then(|out| Some((place_in(&out)?, out)));
    let outcome = crate::identified(job)?;
    let replaced = before.and_then(|(place, out)| replaces_another_frame(&out, &place, &outcome.file));
    match replaced {
        Some(text) if json => note!("{text}"),
        Some(text) => say!("{}", print::wrapped(&text)),
        None => {}
    }
    if json {
        return print::json(&outcome.file);
    }
    print::outcome(&outcome, false);
    Ok(())
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

fn put_right(args: &AddedMassArgs, target: &Path, json: bool) -> Result<(), Failure> {
    let unit_m = Asked::read(&args.input, &args.options.0)?.unit_m;
    let weld_m = args.weld.as_deref().map(weld_m).transpose()?;
    let done = repair(&args.input, unit_m, weld_m, target)?;
    if json {
        return print::json(&serde_json::json!({"written": target, "repairs": done.repairs, "left": done.left}));
    }
    for line in done.notes.iter().chain(&done.repairs) {
        say!("  {line}");
    }
    if done.repairs.is_empty() {
        say!("  nothing to correct");
    }
    say!("{}: {}, in metres", target.display(), froude::records::text::counted(done.panels, "panel", "panels"));
    for line in &done.left {
        say!("  still: {line}");
    }
    if !done.left.is_empty() {
        return Err(Failure::NotYetFit { path: target.to_owned() });
    }
    say!("Next: froude added-mass {}", target.display());
    Ok(())
}

/// Each number of links, or the one body where there is none.
fn check(asked: &Asked, json: bool) -> Result<(), Failure> {
    let of = |links: &usize| Asked { links: vec![*links], ..asked.clone() };
    let mut all: Vec<Asked> = asked.links.iter().map(of).collect();
    if all.is_empty() {
        all.push(asked.clone());
    }
    let checked = all.iter().map(forecasts_of).collect::<Result<Vec<_>, _>>()?;
    if json {
        let bodies: Vec<_> = checked
            .iter()
            .map(|(loaded, steps)| {
                let step = |(panels, f): &(usize, Forecast)| {
                    serde_json::json!({"panels": panels, "unknowns": f.unknowns, "seconds": f.seconds, "memory_bytes": f.memory_bytes})
                };
                let meshes: Vec<_> = steps.iter().map(step).collect();
                serde_json::json!({"name": loaded.name, "notes": loaded.notes, "findings": loaded.findings, "meshes": meshes})
            })
            .collect();
        return print::json(&bodies);
    }
    for (loaded, steps) in &checked {
        forecasts(loaded, steps);
    }
    Ok(())
}

fn forecasts(loaded: &Loaded, steps: &[(usize, Forecast)]) {
    say!("{}: fit for use", loaded.name);
    for note in loaded.notes.iter().chain(loaded.findings.iter().map(|f| &f.message)) {
        say!("  {note}");
    }
    let rows = steps
        .iter()
        .map(|(panels, f)| {
            vec![
                panels.to_string(),
                f.unknowns.to_string(),
                duration(f.seconds),
                format!("{:.0}", f.memory_bytes / 1e6),
            ]
        })
        .collect();
    say!("\nWhat each mesh would take; the computation ends with the first that holds the tolerance.");
    print::text_table(&TextTable {
        caption: String::new(),
        head: ["panels", "unknowns", "time", "memory [MB]"].map(str::to_owned).to_vec(),
        rows,
    });
}
