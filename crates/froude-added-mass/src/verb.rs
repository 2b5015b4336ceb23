//! `froude added-mass --check` and `--repair`: what a mesh is fit for, before anything is computed.

use std::path::Path;

use froude_panel::refine::Forecast;
use froude_records::block::{Block, Section, TableBuilder, facts};
use froude_records::outcome::{Exit, Outcome};
use froude_records::text::counted;

use crate::body::forecasts;
use crate::error::AddedMassError;
use crate::load::Loaded;
use crate::options::Asked;
use crate::repair::repair;

/// Forecast of time and memory for every mesh: of each number of links, or of the single body.
///
/// # Errors
///
/// As [`forecasts`].
pub fn check(asked: &Asked) -> Result<Outcome, AddedMassError> {
    let of = |links: &usize| Asked { links: vec![*links], ..asked.clone() };
    let mut all: Vec<Asked> = asked.links.iter().map(of).collect();
    if all.is_empty() {
        all.push(asked.clone());
    }
    let one = |asked: &Asked| Ok(section(&forecasts(asked)?).into());
    let blocks = all.iter().map(one).collect::<Result<Vec<Block>, AddedMassError>>()?;
    Ok(Outcome { blocks, ..Outcome::default() })
}

fn section((loaded, steps): &(Loaded, Vec<(usize, Forecast)>)) -> Section {
    let f = facts("", "", loaded);
    let name = f.build(vec![f.text("name", "", |l| l.name.clone())]);
    let t = TableBuilder::new("findings", "", &loaded.findings);
    let findings = t.build(vec![
        t.text("code", "", |found| found.code.clone()),
        t.text("message", "", |found| found.message.clone()),
    ]);
    let caption = "What each mesh would take; the computation ends with the first that holds the tolerance.";
    let t = TableBuilder::new("meshes", caption, steps);
    let meshes = t.build(vec![
        t.count("panels", "panels", |(panels, _)| *panels),
        t.count("unknowns", "unknowns", |(_, f)| f.unknowns),
        t.number("seconds", "time", |(_, f)| f.seconds).duration(),
        t.number("memory_bytes", "memory", |(_, f)| f.memory_bytes).bytes(),
    ]);
    let said: Vec<String> = loaded.findings.iter().map(|found| found.message.clone()).collect();
    let blocks = vec![
        name.into(),
        Block::text("", vec![format!("{}: fit for use", loaded.name)]),
        Block::text("notes", loaded.notes.clone()),
        findings.into(),
        Block::text("", said),
        meshes.into(),
    ];
    Section { key: "bodies[]".to_owned(), title: loaded.name.clone(), blocks, ..Section::default() }
}

/// Writes a mesh with the unambiguous faults corrected.
///
/// # Errors
///
/// As [`repair`].
pub fn put_right(asked: &Asked, weld_m: Option<f64>, target: &Path) -> Result<Outcome, AddedMassError> {
    let done = repair(asked, weld_m, target)?;
    let f = facts("", "", &done);
    let about = f.build(vec![
        f.text("written", "", |_| target.display().to_string()),
        f.count("panels", "", |done| done.panels),
    ]);
    let mut end = vec![format!("{}: {}, in metres", target.display(), counted(done.panels, "panel", "panels"))];
    let exit = if done.left.is_empty() {
        end.push(format!("Next: froude added-mass {}", target.display()));
        Exit::Done
    } else {
        end.push("Still:".to_owned());
        Exit::Refused(format!(
            "{}: written, but not yet fit for use; unite what is left of bodies that cross, and close holes, where the mesh was drawn",
            target.display()
        ))
    };
    let nothing = done.repairs.is_empty().then(|| "nothing to correct".to_owned());
    let blocks = vec![
        about.into(),
        Block::text("notes", done.notes.clone()),
        Block::text("repairs", done.repairs.clone()),
        Block::text("", nothing.into_iter().collect()),
        Block::text("", end),
        Block::text("left", done.left),
    ];
    Ok(Outcome { blocks, exit, ..Outcome::default() })
}
