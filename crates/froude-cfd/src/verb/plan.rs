//! `froude cfd plan`: meshes are made, cases are written, and priced before anything runs.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use froude_hydro::similarity::{friction_ittc57, friction_laminar};
use froude_records::block::{Block, TableBuilder, facts};
use froude_records::number::{bytes, count, duration, percent, significant};
use froude_records::outcome::Outcome;
use froude_records::text::counted;

use super::asked::Asked;
use super::bodies;
use super::error::VerbError;
use super::meshes::{Group, Ready, of_body};
use crate::again::Again;
use crate::case::{Case, LAMINAR_REYNOLDS, Water};
use crate::change::{Change, plan as plan_cases};
use crate::cost::Cost;
use crate::matrix::{Meshed, cases, computed_again};
use crate::snappy::Made;
use crate::store::{State, Store};

/// Disk that a cell takes with one set of fields and a history of forces, bytes.
const BYTES_PER_CELL: f64 = 110.0;

/// Most meshes of a plan: a thousand bodies of ten meshes each are a day's work of a processor.
const MOST_MESHES: usize = 10_000;

/// A campaign that is planned.
pub(super) struct Planned {
    /// The campaign's folder.
    pub store: Store,
    /// A row per configuration and mesh.
    configurations: Vec<PlannedConfiguration>,
    /// Whether the cost is measured on this machine.
    is_measured: bool,
    /// Time of a processor for one cell and iteration, s.
    s_per_cell_iteration: f64,
    /// What is worth saying.
    pub said: Vec<String>,
}

/// What is planned of a configuration.
struct PlannedConfiguration {
    body: Meshed,
    ready: Ready,
    /// Empty for the campaign's own mesh; of others as their cases end: `fine`, `coarser`, `finer2`, `r6`.
    mesh: String,
    /// y+ to expect of the mean over the body at the highest speed, from the friction of a plate of its length \[-\].
    y_plus: f64,
    /// Part of a tank's section that the body blocks \[-\].
    blockage: Option<f64>,
    cases: usize,
    /// Those without a result.
    open: usize,
    /// Time of a processor that these are expected to take, s.
    cpu_s: f64,
    /// Disk that all of them take.
    bytes: f64,
    /// Smallest and largest Reynolds number of the width.
    reynolds: [f64; 2],
}

/// Plans a campaign: its only source with cases, or the one of a name, of which `processors` will work side by side. `tell` hears what is done.
///
/// Meshes are made here, also those by snappyHexMesh, which take a second to a minute: without them nobody knows how many cells there are, and so no price. Each is made once.
///
/// # Errors
///
/// A campaign, a body file or a surface that cannot be used; a body that no mesh fits; OpenFOAM is not installed and a mesh needs it; a folder that cannot be written, or that another process runs.
pub fn plan(
    campaign: &Path,
    source: Option<&str>,
    processors: usize,
    cancel: &AtomicBool,
    tell: &dyn Fn(&str),
) -> Result<Outcome, VerbError> {
    let blocks = planned(campaign, source, cancel, tell)?.blocks(processors);
    Ok(Outcome { blocks, ..Outcome::default() })
}

/// The same, not yet said.
pub(super) fn planned(
    campaign: &Path,
    source: Option<&str>,
    cancel: &AtomicBool,
    tell: &dyn Fn(&str),
) -> Result<Planned, VerbError> {
    let asked = Asked::read(campaign, source)?;
    // A body that is edited while meshes are made is not what was planned.
    let inputs_sha256 = asked.inputs_sha256();
    let refused = |problem: String| VerbError::input(campaign, problem);
    let mut meshed: Vec<Group> = Vec::new();
    let named = asked.source.plan.iter().flat_map(|block| &block.configurations);
    let names: BTreeSet<&String> = named.clone().collect();
    let meshes: usize = names.into_iter().map(|name| 1 + computed_again(&asked.spec, name).len()).sum();
    if meshes > MOST_MESHES {
        let problem = format!(
            "source {:?} asks for {meshes} meshes, of its configurations and of studies and fine with them; at most {MOST_MESHES} are made: split the campaign",
            asked.source.name
        );
        return Err(refused(problem));
    }
    bodies::each(&asked, named, &mut |body| {
        if cancel.load(Ordering::SeqCst) {
            return Err(VerbError::Stopped);
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
            body: group.meshed.clone(),
            ready: ready.clone(),
            mesh: ready.again.map_or_else(String::new, Again::suffix),
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

impl PlannedConfiguration {
    fn name(&self) -> String {
        let configuration = &self.body.configuration;
        match self.body.angle_rad {
            Some(angle) => format!("{configuration} at {:.1}°", angle.to_degrees()).trim_start().to_owned(),
            None => format!("{configuration} {}", self.mesh).trim().to_owned(),
        }
    }
}

impl Planned {
    fn blocks(&self, processors: usize) -> Vec<Block> {
        let f = facts("", "", self);
        let about = f.build(vec![
            f.text("folder", "", |p| p.store.root().display().to_string()),
            f.number("s_per_cell_iteration", "", |p| p.s_per_cell_iteration),
            f.flag("is_measured", "", |p| p.is_measured),
        ]);
        let all = &self.configurations;
        let t = TableBuilder::new("configurations", format!("cases in {}", self.store.root().display()), all);
        let cases = t.build(vec![
            t.text("", "body", PlannedConfiguration::name),
            t.text("configuration", "", |c| c.body.configuration.clone()),
            t.text("mesh", "", |c| c.mesh.clone()),
            t.number("angle_rad", "", |c| c.body.angle_rad),
            t.count("cells", "cells", |c| c.ready.cells),
            t.interval("reynolds", "Re of the width", |c| c.reynolds).range(),
            t.count("cases", "cases", |c| c.cases),
            t.count("open", "to compute", |c| c.open),
            t.number("cpu_s", "CPU time", |c| c.cpu_s).duration(),
            t.number("bytes", "disk", |c| c.bytes).bytes(),
        ]);
        let caption = "meshes; y+ is estimated from flat-plate friction at the highest speed";
        let t = TableBuilder::new("configurations", caption, all);
        let of = |c: &PlannedConfiguration, of: fn(&Made) -> f64| c.ready.cubes.as_ref().map(of);
        let meshes = t.build(vec![
            t.text("", "body", PlannedConfiguration::name),
            t.text("mesher", "mesh", |c| if c.ready.cubes.is_some() { "snappyHexMesh" } else { "O-grid" }.to_owned()),
            t.number("max_non_orthogonality_rad", "non-orthogonality [deg]", |c| {
                c.ready.quality.max_non_orthogonality_rad
            })
            .places(0),
            t.number("max_skewness", "skewness", |c| c.ready.quality.max_skewness).significant(2),
            t.number("layers/mean", "mean layers", |c| of(c, |made| made.layers)).significant(3),
            t.count("layers/asked", "layers requested", |c| c.ready.cubes.as_ref().map(|made| made.layers_asked)),
            t.number("layers/coverage", "", |c| of(c, |made| made.coverage)),
            t.number("layers/area_coverage", "layer coverage of the area", |c| of(c, |made| made.area_coverage))
                .percent(),
            t.number("layers/thickness_m", "", |c| of(c, |made| made.layers_m)),
            t.number("y_plus_expected", "y+", |c| c.y_plus).significant(2),
            t.number("blockage", "blockage", |c| c.blockage).percent(),
        ]);
        let caption = "reference lengths, area and moment reference point, x forward, y to starboard, z down";
        let t = TableBuilder::new("configurations", caption, all);
        let lengths = t.build(vec![
            t.text("", "body", PlannedConfiguration::name),
            t.number("length_m", "length [m]", |c| c.body.reference.length_m),
            t.number("width_m", "width [m]", |c| c.body.reference.width_m),
            t.number("area_m2", "area [m²]", |c| c.body.reference.area_m2),
            t.numbers("point_m", "point [m]", |c| c.body.reference.point_m.to_vec()).significant(3),
        ]);
        let sum = |of: fn(&PlannedConfiguration) -> f64| all.iter().map(of).sum::<f64>();
        let cpu_s = sum(|c| c.cpu_s);
        let how = if self.is_measured { "measured here" } else { "assumed until a case has run here" };
        let price = format!(
            "{} to compute: {} CPU time, {} on {}, {} of disk; {} µs per cell and iteration, {how}",
            counted(sum(|c| c.open as f64) as usize, "case", "cases"),
            duration(cpu_s),
            duration(cpu_s / processors as f64),
            counted(processors, "processor", "processors"),
            bytes(sum(|c| c.bytes)),
            significant(1e6 * self.s_per_cell_iteration, 2),
        );
        let said = Block::text("said", self.said.clone());
        vec![about.into(), cases.into(), meshes.into(), lengths.into(), Block::text("", vec![price]), said]
    }
}
