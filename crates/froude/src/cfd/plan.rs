//! `froude cfd plan`: meshes are made, cases are written, and priced before anything runs.

use std::path::Path;

use froude_cfd::again::Again;
use froude_cfd::body::{Shaped, shaped};
use froude_cfd::case::{Case, LAMINAR_REYNOLDS};
use froude_cfd::change::{Change, plan as plan_cases};
use froude_cfd::cost::Cost;
use froude_cfd::matrix::{Meshed, cases, computed_again};
use froude_cfd::mesh_error::MeshError;
use froude_cfd::o_grid::OGrid;
use froude_cfd::quality::Quality;
use froude_cfd::store::{State, Store};
use froude_panel::refine::duration;
use froude_records::body::read_body;
use froude_records::number::{count, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;
use serde_json::{Value, json};

use super::{Asked, CfdInput, MESHES};
use crate::Error;

/// Disk that a cell takes with one set of fields and a history of forces, bytes.
const BYTES_PER_CELL: f64 = 110.0;

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
    /// Length of the body, m.
    pub length_m: f64,
    /// Cells of its mesh.
    pub cells: usize,
    /// Largest non-orthogonality of the mesh, rad.
    pub non_orthogonality_rad: f64,
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
/// # Errors
///
/// A campaign or a body file that cannot be used; a body that no O-grid fits; a folder that cannot be written, or that another process runs.
pub fn plan(campaign: &Path, source: Option<&str>, tell: &dyn Fn(&str)) -> Result<Planned, Error> {
    let asked = Asked::read(campaign, source)?;
    let shapes = shapes(&asked)?;
    let mut meshed = Vec::with_capacity(shapes.len());
    for shape in &shapes {
        tell(&format!("mesh of {}", shape.configuration));
        meshed.push(mesh(&asked, shape)?);
    }
    let bodies: Vec<Meshed> = meshed.iter().map(|(body, _)| body.clone()).collect();
    let refused = |problem| CfdInput { path: campaign.to_owned(), problem };
    let cases = cases(&asked.source, &asked.spec, asked.water, &bodies).map_err(refused)?;
    tell("cases");
    let (store, change) = plan_cases(&asked.folder, &cases)?;
    let mut cost = Cost::default();
    for made in meshed.iter().flat_map(|(_, meshes)| meshes) {
        cost.knows(&made.name, made.cells);
    }
    let states = store.states();
    for case in &cases {
        if let Some(State::Done(done)) = states.get(&case.id) {
            cost.learn(case, &done.outcome);
        }
    }
    let rows = meshed.iter().flat_map(|(body, meshes)| meshes.iter().map(move |made| (body, made)));
    let configurations = rows.map(|(body, made)| {
        let again = |c: &Case| Again::of(&c.id).map(|(_, again)| again).filter(|again| *again != Again::Cold);
        let is_own = |c: &&Case| c.configuration == body.configuration && again(c) == made.again;
        let own: Vec<&Case> = cases.iter().filter(is_own).collect();
        let open = || own.iter().filter(|c| states.get(&c.id).is_none_or(State::is_open));
        let reynolds = own.iter().map(|c| c.reynolds());
        PlannedConfiguration {
            configuration: body.configuration.clone(),
            mesh: made.again.map_or_else(String::new, Again::suffix),
            length_m: body.reference.length_m,
            cells: made.cells,
            non_orthogonality_rad: made.quality.max_non_orthogonality_rad.value,
            cases: own.len(),
            open: open().count(),
            cpu_s: open().map(|c| cost.expected_s(c)).sum(),
            bytes: BYTES_PER_CELL * made.cells as f64 * own.len() as f64,
            reynolds: reynolds.fold([f64::INFINITY, 0.0], |[low, high], re| [low.min(re), high.max(re)]),
        }
    });
    Ok(Planned {
        configurations: configurations.collect(),
        is_measured: cost.is_measured(),
        s_per_cell_iteration: cost.s_per_cell_iteration(),
        said: said(&asked, &cases, &change),
        store,
        change,
    })
}

/// The bodies that the plan names, in the order in which it does.
fn shapes(asked: &Asked) -> Result<Vec<Shaped>, Error> {
    let file = read_body(&asked.body)?;
    let mut names: Vec<&String> = Vec::new();
    for name in asked.source.plan.iter().flat_map(|block| &block.configurations) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let refused = |problem| CfdInput { path: asked.body.clone(), problem }.into();
    names.into_iter().map(|name| shaped(&file, name).map_err(refused)).collect()
}

/// A mesh that is written.
struct Made {
    /// Which cases run on it; `None`: those of the plan.
    again: Option<Again>,
    name: String,
    cells: usize,
    quality: Quality,
}

/// The meshes of a configuration, written, its own first.
fn mesh(asked: &Asked, shape: &Shaped) -> Result<(Meshed, Vec<Made>), Error> {
    let refused = |e: &dyn std::fmt::Display| {
        let name = if shape.configuration.is_empty() { "the body" } else { &shape.configuration };
        CfdInput { path: asked.body.clone(), problem: format!("no mesh of {name}: {e}") }
    };
    let again = computed_again(&asked.spec, &shape.configuration);
    let mut meshes = Vec::with_capacity(1 + again.len());
    for again in std::iter::once(None).chain(again.into_iter().map(Some)) {
        let grid = grid(asked, shape, again).map_err(|e| refused(&e))?;
        let (mesh, quality) = grid.mesh(&shape.body).map_err(|e| refused(&e))?;
        let folder = mesh.write(&asked.folder.join(MESHES)).map_err(|e| refused(&e))?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        meshes.push(Made { again, name, cells: mesh.cells, quality });
    }
    let of = |again: Option<Again>| meshes.iter().find(|m| m.again == again).map(|m| m.name.clone());
    let body = Meshed {
        configuration: shape.configuration.clone(),
        mesh: of(None).unwrap_or_default(),
        reference: shape.reference,
        others: meshes.iter().filter_map(|m| Some((m.again?, m.name.clone()))).collect(),
    };
    Ok((body, meshes))
}

/// The grid of the plan's cases, or of those that compute its settings again.
fn grid(asked: &Asked, shape: &Shaped, again: Option<Again>) -> Result<OGrid, MeshError> {
    let own = shape.grid(&asked.spec);
    match (again, asked.spec.fine) {
        (Some(Again::Fine), Some(fine)) => Ok(shape.grid_of(&asked.spec, fine.mesh)),
        (Some(Again::Grid(level)), _) => own.at_level(&shape.body, level),
        (Some(Again::Domain(radius)), _) => own.of_radius(&shape.body, radius * shape.reference.length_m),
        (None | Some(Again::Cold | Again::Fine), _) => Ok(own),
    }
}

fn said(asked: &Asked, cases: &[Case], change: &Change) -> Vec<String> {
    let mut out = Vec::new();
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
        let row = |c: &PlannedConfiguration| {
            vec![
                format!("{} {}", c.configuration, c.mesh).trim().to_owned(),
                significant(c.length_m, 4),
                count(c.cells),
                format!("{:.0}", c.non_orthogonality_rad.to_degrees()),
                format!("{} to {}", significant(c.reynolds[0], 2), significant(c.reynolds[1], 2)),
                c.cases.to_string(),
                c.open.to_string(),
                duration(c.cpu_s),
                significant(c.bytes / 1e6, 2),
            ]
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
        let head = [
            "body",
            "length, m",
            "cells",
            "non-orthogonality, deg",
            "Re of the width",
            "cases",
            "to compute",
            "time",
            "disk, MB",
        ];
        DocumentSection {
            title: "Planned".to_owned(),
            paragraphs,
            tables: vec![TextTable {
                caption: format!("cases in {}", self.store.root().display()),
                head: head.map(str::to_owned).to_vec(),
                rows: self.configurations.iter().map(row).collect(),
            }],
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
                "length_m": c.length_m,
                "cells": c.cells,
                "max_non_orthogonality_rad": c.non_orthogonality_rad,
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
