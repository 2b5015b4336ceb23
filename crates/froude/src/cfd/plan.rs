//! `froude cfd plan`: meshes are made, cases are written, and priced before anything runs.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use froude_cfd::again::Again;
use froude_cfd::case::{Case, LAMINAR_REYNOLDS, Reference, Water};
use froude_cfd::change::{Change, plan as plan_cases};
use froude_cfd::cost::Cost;
use froude_cfd::matrix::{Meshed, cases, computed_again};
use froude_cfd::snappy::Made;
use froude_cfd::store::{State, Store};
use froude_hydro::similarity::{friction_ittc57, friction_laminar};
use froude_panel::refine::duration;
use froude_records::number::{count, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use serde_json::{Value, json};

use super::meshes::{Group, of_body};
use super::{Asked, CfdInput, bodies};
use crate::Error;

/// Disk that a cell takes with one set of fields and a history of forces, bytes.
const BYTES_PER_CELL: f64 = 110.0;

/// Most meshes of a plan: a thousand bodies of ten meshes each are a day's work of a processor.
const MOST_MESHES: usize = 10_000;

/// A campaign that is planned.
#[derive(Debug, Clone)]
pub struct Planned {
    /// The campaign's folder.
    pub store: Store,
    /// What became of cases that were there.
    pub change: Change,
    /// A row per configuration and mesh.
    pub configurations: Vec<PlannedConfiguration>,
    /// Whether the cost is measured on this machine.
    pub is_measured: bool,
    /// Time of a processor for one cell and iteration, s.
    pub s_per_cell_iteration: f64,
    /// What is worth saying.
    pub said: Vec<String>,
}

/// What is planned of a configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedConfiguration {
    /// Its name.
    pub configuration: String,
    /// Empty for the campaign's own mesh; of others as their cases end: `fine`, `coarser`, `finer2`, `r6`.
    pub mesh: String,
    /// The angle that its mesh is for; `None`: all.
    pub angle_rad: Option<f64>,
    /// Lengths and the point that its loads refer to.
    pub reference: Reference,
    /// Cells of its mesh.
    pub cells: usize,
    /// Largest non-orthogonality of the mesh, rad.
    pub non_orthogonality_rad: f64,
    /// Largest skewness of the mesh \[-\].
    pub skewness: f64,
    /// What snappyHexMesh made; `None`: it is an O-grid.
    pub cubes: Option<Made>,
    /// y+ to expect of the mean over the body at the highest speed, from the friction of a plate of its length \[-\].
    pub y_plus: f64,
    /// Part of a tank's section that the body blocks \[-\].
    pub blockage: Option<f64>,
    /// Its cases.
    pub cases: usize,
    /// Those without a result.
    pub open: usize,
    /// Time of a processor that these are expected to take, s.
    pub cpu_s: f64,
    /// Disk that all of them take, bytes.
    pub bytes: f64,
    /// Smallest and largest Reynolds number of the width.
    pub reynolds: [f64; 2],
}

/// Plans a campaign: its only source with cases, or the one of a name. `tell` hears what is done.
///
/// Meshes are made here, also those by snappyHexMesh, which take a second to a minute: without them nobody knows how many cells there are, and so no price. Each is made once.
///
/// # Errors
///
/// A campaign, a body file or a surface that cannot be used; a body that no mesh fits; OpenFOAM is not there and a mesh needs it; a folder that cannot be written, or that another process runs.
pub fn plan(campaign: &Path, source: Option<&str>, cancel: &AtomicBool, tell: &dyn Fn(&str)) -> Result<Planned, Error> {
    let asked = Asked::read(campaign, source)?;
    // A body that is edited while meshes are made is not what was planned.
    let inputs_sha256 = asked.inputs_sha256();
    let refused = |problem| CfdInput { path: campaign.to_owned(), problem };
    let mut meshed: Vec<Group> = Vec::new();
    let named = asked.source.plan.iter().flat_map(|block| &block.configurations);
    let names: BTreeSet<&String> = named.clone().collect();
    let meshes: usize = names.into_iter().map(|name| 1 + computed_again(&asked.spec, name).len()).sum();
    if meshes > MOST_MESHES {
        let problem = format!(
            "source {:?} asks for {meshes} meshes, of its configurations and of studies and fine with them; at most {MOST_MESHES} are made: split the campaign",
            asked.source.name
        );
        return Err(refused(problem).into());
    }
    bodies::each(&asked, named, &mut |body| {
        if cancel.load(Ordering::SeqCst) {
            return Err(Error::Stopped);
        }
        meshed.extend(of_body(&asked, &body, cancel, tell)?);
        Ok(())
    })?;
    let bodies: Vec<Meshed> = meshed.iter().map(|group| group.meshed.clone()).collect();
    let cases = cases(&asked.source, &asked.spec, asked.water, &bodies).map_err(refused)?;
    tell("cases");
    let (store, change) = plan_cases(&asked.folder, &cases, &inputs_sha256)?;
    let mut cost = Cost::default();
    for ready in meshed.iter().flat_map(|group| &group.meshes) {
        cost.knows(&ready.mesh, ready.cells);
    }
    let states = store.states();
    for case in &cases {
        if let Some(State::Done(done)) = states.get(&case.id) {
            cost.learn(case, &done.outcome);
        }
    }
    let rows = meshed.iter().flat_map(|group| group.meshes.iter().map(move |ready| (group, ready)));
    let configurations = rows.map(|(group, ready)| {
        let Meshed { configuration, reference, angle_rad, .. } = &group.meshed;
        let again = |c: &Case| Again::of(&c.id).map(|(_, again)| again).filter(|again| *again != Again::Cold);
        let is_own = |c: &&Case| {
            c.configuration == *configuration
                && again(c) == ready.again
                && (angle_rad.is_none() || c.mesh == ready.mesh)
        };
        let own: Vec<&Case> = cases.iter().filter(is_own).collect();
        let open = || own.iter().filter(|c| states.get(&c.id).is_none_or(State::is_open));
        let reynolds = own.iter().map(|c| c.reynolds());
        let speed_m_s = own.iter().map(|c| c.flow.speed_m_s).fold(0.0, f64::max);
        PlannedConfiguration {
            configuration: configuration.clone(),
            mesh: ready.again.map_or_else(String::new, Again::suffix),
            angle_rad: *angle_rad,
            reference: *reference,
            cells: ready.cells,
            non_orthogonality_rad: ready.max_non_orthogonality_rad,
            skewness: ready.max_skewness,
            cubes: ready.cubes.clone(),
            y_plus: y_plus(asked.water, reference.length_m, speed_m_s, ready.first_layer_m),
            blockage: group.blockage,
            cases: own.len(),
            open: open().count(),
            cpu_s: open().map(|c| cost.expected_s(c)).sum(),
            bytes: BYTES_PER_CELL * ready.cells as f64 * own.len() as f64,
            reynolds: reynolds.fold([f64::INFINITY, 0.0], |[low, high], re| [low.min(re), high.max(re)]),
        }
    });
    Ok(Planned {
        configurations: configurations.collect(),
        is_measured: cost.is_measured(),
        s_per_cell_iteration: cost.s_per_cell_iteration(),
        said: said(&asked, &meshed, &cases, &change),
        store,
        change,
    })
}

/// y+ of the centres of the first cells, u_τ y/ν with u_τ = U √(c_f/2).
///
/// c_f is that of the ITTC line of 1957 at the Reynolds number of the length, below 10³ that of Blasius. It is a scale for the mean and no bound: before a bluff body's shoulders the friction is some three times that.
fn y_plus(water: Water, length_m: f64, speed_m_s: f64, first_layer_m: f64) -> f64 {
    let reynolds = speed_m_s * length_m / water.viscosity_m2_s;
    let friction = friction_ittc57(reynolds).unwrap_or_else(|_| friction_laminar(reynolds));
    speed_m_s * (0.5 * friction).sqrt() * 0.5 * first_layer_m / water.viscosity_m2_s
}

/// Part of the body's area with layers below which some are said to be missing.
const COVERED: f64 = 0.9;

fn said(asked: &Asked, meshed: &[Group], cases: &[Case], change: &Change) -> Vec<String> {
    let mut out = Vec::new();
    for group in meshed {
        out.extend(group.notes.iter().map(|note| format!("{}: {note}", group.meshed.configuration)));
    }
    for (group, ready) in meshed.iter().flat_map(|group| group.meshes.iter().map(move |ready| (group, ready))) {
        let name = &group.meshed.configuration;
        if let Some(place) = &ready.instead {
            out.push(format!(
                "{name}: rays of an O-grid cross at {place}, so that snappyHexMesh made the mesh, with as many cells on the surface"
            ));
        }
        if let Some(made) = ready.cubes.as_ref().filter(|made| made.area_coverage < COVERED) {
            out.push(format!(
                "{name}: layers cover {} of the body's area; where they are missing, y+ is that of the cubes, and the same part of each load is counted as error: make surface_cell of mesh smaller, or request fewer layers",
                percent(made.area_coverage)
            ));
        }
    }
    if asked.spec.tank.is_some() {
        out.push("in a tank: its walls, its bottom and the water's surface are planes along which the water slips, as the walls move with it; the surface stays flat and makes no waves".to_owned());
    }
    let slow = cases.iter().filter(|c| c.is_tripped_too_early()).count();
    if slow > 0 {
        out.push(format!(
            "{} below a Reynolds number of {} of the width by a model of turbulence: the layer there is laminar, and the model has it turbulent from the nose on; laminar_below and both_below of [source.cfd] compute them without it",
            counted(slow, "case is", "cases are"),
            count(LAMINAR_REYNOLDS as usize)
        ));
    }
    if asked.source.uncertainty.is_empty() {
        out.push("no error of the model's form is declared: residuals of a computation do not show it; a first entry is standard = \"20 %\" of f_x and \"10 %\" of f_y in [[source.uncertainty]], shared = \"campaign\", until a tank says better".to_owned());
    }
    for (list, words) in [(&change.new, "new"), (&change.back, "back from aside"), (&change.kept, "kept")] {
        if !list.is_empty() {
            out.push(format!("{} {words}", counted(list.len(), "case is", "cases are")));
        }
    }
    if let Some((_, place)) = change.aside.first() {
        let place = place.parent().unwrap_or(place);
        out.push(format!(
            "{} no longer planned, or with other inputs: moved to {}, results and all",
            counted(change.aside.len(), "case is", "cases are"),
            place.display()
        ));
    }
    out
}

impl Planned {
    /// What a person reads; `processors` work side by side.
    #[must_use]
    pub fn section(&self, processors: usize) -> DocumentSection {
        let name = |c: &PlannedConfiguration| match c.angle_rad {
            Some(angle) => format!("{} at {:.1}°", c.configuration, angle.to_degrees()).trim_start().to_owned(),
            None => format!("{} {}", c.configuration, c.mesh).trim().to_owned(),
        };
        let row = |c: &PlannedConfiguration| {
            vec![
                name(c),
                count(c.cells),
                format!("{} to {}", significant(c.reynolds[0], 2), significant(c.reynolds[1], 2)),
                c.cases.to_string(),
                c.open.to_string(),
                duration(c.cpu_s),
                significant(c.bytes / 1e6, 2),
            ]
        };
        let mesh = |c: &PlannedConfiguration| {
            let layers = |made: &Made| format!("{} of {}", significant(made.layers, 3), made.layers_asked);
            vec![
                name(c),
                if c.cubes.is_some() { "snappyHexMesh" } else { "O-grid" }.to_owned(),
                format!("{:.0}", c.non_orthogonality_rad.to_degrees()),
                significant(c.skewness, 2),
                c.cubes.as_ref().map_or_else(|| "all".to_owned(), layers),
                percent(c.cubes.as_ref().map_or(1.0, |made| made.area_coverage)),
                significant(c.y_plus, 2),
                c.blockage.map_or_else(String::new, percent),
            ]
        };
        let lengths = |c: &PlannedConfiguration| {
            let Reference { length_m, width_m, area_m2, point_m } = c.reference;
            let point = point_m.map(|x| significant(x, 3)).join(", ");
            vec![name(c), significant(length_m, 4), significant(width_m, 4), significant(area_m2, 4), point]
        };
        let sum = |of: fn(&PlannedConfiguration) -> f64| self.configurations.iter().map(of).sum::<f64>();
        let cpu_s = sum(|c| c.cpu_s);
        let how = if self.is_measured { "measured here" } else { "assumed until a case has run here" };
        let mut paragraphs = vec![format!(
            "{} to compute: {} of a processor, {} on {}, {} GB of disk; {} µs a cell and iteration, {how}",
            counted(sum(|c| c.open as f64) as usize, "case", "cases"),
            duration(cpu_s),
            duration(cpu_s / processors as f64),
            counted(processors, "processor", "processors"),
            significant(sum(|c| c.bytes) / 1e9, 2),
            significant(1e6 * self.s_per_cell_iteration, 2),
        )];
        paragraphs.extend(self.said.iter().cloned());
        let table = |caption: String, head: &[&str], row: &dyn Fn(&PlannedConfiguration) -> Vec<String>| TextTable {
            caption,
            head: head.iter().map(|word| (*word).to_owned()).collect(),
            rows: self.configurations.iter().map(row).collect(),
        };
        let head = ["body", "cells", "Re of the width", "cases", "to compute", "time", "disk, MB"];
        let mesh_head = ["body", "mesh", "non-orthogonality, deg", "skewness", "layers", "of the area", "y+", "blocks"];
        let of_mesh = "meshes; y+ is what the friction of a plate lets expect at the highest speed";
        let of_lengths = "lengths that numbers refer to, the area of the side, and the point of the moments, x forward, y to starboard, z down";
        DocumentSection {
            title: "Planned".to_owned(),
            paragraphs,
            tables: vec![
                table(format!("cases in {}", self.store.root().display()), &head, &row),
                table(of_mesh.to_owned(), &mesh_head, &mesh),
                table(of_lengths.to_owned(), &["body", "length, m", "width, m", "area, m²", "point, m"], &lengths),
            ],
            charts: Vec::new(),
        }
    }

    /// The same for a program, in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        json!({
            "folder": self.store.root(),
            "configurations": self.configurations.iter().map(|c| json!({
                "configuration": c.configuration,
                "mesh": c.mesh,
                "angle_rad": c.angle_rad,
                "length_m": c.reference.length_m,
                "width_m": c.reference.width_m,
                "area_m2": c.reference.area_m2,
                "point_m": c.reference.point_m,
                "mesher": if c.cubes.is_some() { "snappyHexMesh" } else { "O-grid" },
                "cells": c.cells,
                "max_non_orthogonality_rad": c.non_orthogonality_rad,
                "max_skewness": c.skewness,
                "layers": c.cubes.as_ref().map(|m| json!({"asked": m.layers_asked, "mean": m.layers, "coverage": m.coverage, "area_coverage": m.area_coverage, "thickness_m": m.layers_m})),
                "y_plus_expected": c.y_plus,
                "blockage": c.blockage,
                "cases": c.cases,
                "open": c.open,
                "cpu_s": c.cpu_s,
                "bytes": c.bytes,
                "reynolds": c.reynolds,
            })).collect::<Vec<_>>(),
            "s_per_cell_iteration": self.s_per_cell_iteration,
            "is_measured": self.is_measured,
            "said": self.said,
        })
    }
}
