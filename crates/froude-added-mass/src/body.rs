//! One body or mesh: what is computed of it, in which frame, and what results.

use froude_mesh::measure::Measure;
use froude_mesh::{Mesh, Vec3};
use froude_panel::family::Family;
use froude_panel::problem::Frame;
use froude_panel::refine::{Forecast, Wanted, plan, refine};
use froude_records::block::{Block, TableBuilder, facts};
use froude_records::number;

use super::exports::{self, extras};
use super::facets::{self, correct};
use super::frame::{Axes, Orientation, Point, inertia_m5, sentence};
use super::load::{Loaded, load};
use super::options::Asked;
use super::record::{About, estimate};
use super::surroundings::surroundings;
use super::{cross_checks, limits, spectral};
use crate::error::AddedMassError;
use crate::outcome::{BodyOutcome, Case, not_within};
use crate::uncertain::with_uncertainty;
use crate::water::Water;

/// A centre of gravity that nobody gave.
fn no_gravity(job: &Asked, is_body_file: bool) -> AddedMassError {
    let why = if is_body_file {
        "no centre of gravity is known; write centre_of_gravity = [\"0 mm\", \"0 mm\", \"-12 mm\"] in [body], or the point: --at \"0 mm, 0 mm, -12 mm\""
    } else {
        "a mesh says nothing of masses; write the point in the axes of the mesh: --at \"0 mm, 0 mm, -12 mm\""
    };
    AddedMassError::input(&job.input, format!("--at cg: {why}"))
}

/// What each mesh would take, with nothing computed.
///
/// # Errors
///
/// As [`body`].
pub fn forecasts(job: &Asked) -> Result<(Loaded, Vec<(usize, Forecast)>), AddedMassError> {
    let loaded = load(job)?;
    let mut around = surroundings(job, &loaded.family.member(0)?.mesh.mesh)?;
    // The last takes most: it has mirrors, or the walls of a tank.
    let wanted = match around.pop() {
        Some(s) => Wanted { mirrors: s.mirrors, tank: s.tank, ..job.wanted.clone() },
        None => job.wanted.clone(),
    };
    let steps = plan(&loaded.family, &wanted)?;
    Ok((loaded, steps))
}

/// Computes; `progress` gets every step, the estimates are called after `source`, or after the body where that is empty.
///
/// # Errors
///
/// See [`AddedMassError`].
pub fn body(job: &Asked, water: &Water, source: &str, progress: &dyn Fn(&str)) -> Result<BodyOutcome, AddedMassError> {
    let loaded = load(job)?;
    let density_kg_m3 = water.density_kg_m3(job, loaded.density_kg_m3)?;
    let coarse = loaded.family.member(0)?.mesh.mesh;
    let measure = Measure::of(&coarse);
    let mesh = job.orientation.unwrap_or_default();
    let at = job.at.unwrap_or(Point::At([0.0; 3]));
    let origin_m = match at {
        Point::At(at) => at,
        Point::Buoyancy => measure.centroid_m,
        Point::Gravity => loaded.centre_of_gravity_m.ok_or_else(|| no_gravity(job, loaded.shape.is_some()))?,
    };
    let frame = Frame { origin_m, axes: job.axes.vectors(mesh) };
    let (axes, point) = (axes_words(job, mesh, &loaded), at.words(origin_m, job.axes));
    let mut findings = loaded.findings.clone();
    let mut cases = Vec::new();
    for s in surroundings(job, &coarse)? {
        let wanted = Wanted { frame, mirrors: s.mirrors, tank: s.tank, ..job.wanted.clone() };
        let refined = refine(&loaded.family, &wanted, &|step| progress(&format!("{}: {step}", s.title)))?;
        findings.extend(not_within(&s.title, &refined));
        cases.push(Case { title: s.title, surroundings: s.words, is_lid: s.is_lid, refined, facets: None });
    }
    let length_m = extent_along(&coarse, mesh.forward().axis);
    let mut notes = vec![format!(
        "Density {density_kg_m3} kg/m³; tolerance {} %; froude {}.",
        number::plain(100.0 * job.wanted.tolerance, 3),
        env!("CARGO_PKG_VERSION")
    )];
    notes.extend(loaded.notes);
    if let Some(exact) = loaded.shape.as_ref().and_then(spectral::solve) {
        notes.push(spectral::replace(&mut cases[0].refined, &exact, &frame));
    }
    if let Family::Mesh(mesh) = &loaded.family {
        if job.is_polyhedron {
            notes.push(facets::IS_POLYHEDRON.to_owned());
        } else {
            progress("the same with facets rounded");
            let found = facets::of_mesh(mesh, &cases[0], &job.wanted, &frame, job.is_smooth);
            if let Ok(Some(found)) = &found {
                correct(&mut cases, found);
            }
            let largest = found.map(|found| found.map(|found| found.largest));
            facets::report(largest, job.is_smooth, &mut notes, &mut findings);
        }
    }
    let mut tables = Vec::from(hydrostatics(&cases[0], loaded.shape.is_none(), density_kg_m3, &frame));
    let (shape, refined) = (loaded.shape.as_ref(), &cases[0].refined);
    tables.extend(cross_checks::table(shape, &coarse, refined, density_kg_m3, &frame).map(Block::from));
    tables.extend(facets::table(&cases[0], density_kg_m3, job.is_smooth).map(Block::from));
    if let (Some(tank), Some(surface_m)) = (job.tank_m, job.surface_m) {
        findings.push(limits::clearance(&coarse, tank, surface_m));
    }
    let source = if source.is_empty() { &loaded.name } else { source };
    let estimates = cases.iter().map(|case| {
        let source = if cases.len() == 1 { source.to_owned() } else { format!("{source}, {}", case.surroundings) };
        let about = About {
            source,
            density_kg_m3,
            frame: axes.clone(),
            reference_point: point.clone(),
            length_m,
            surroundings: case.surroundings.clone(),
        };
        estimate(&case.refined, case.facets.as_ref(), &about)
    });
    let estimates = estimates.collect();
    let depth_m = job.surface_m.map(|surface_m| surface_m - mesh.up().coordinate(measure.centroid_m));
    notes.extend(limits::words(depth_m, job.tank_m));
    notes.extend(exports::words(job));
    notes.push("Nothing here depends on frequency: no waves are computed.".to_owned());
    let mut outcome = BodyOutcome {
        name: loaded.name,
        density_kg_m3,
        length_m,
        frame,
        place: sentence(&axes, &point),
        cases,
        notes,
        tables,
        findings,
        estimates,
        exports: Vec::new(),
    };
    outcome.exports = extras(&outcome, job)?;
    Ok(outcome)
}

/// Axes in words: of a body file they are known, of a mesh they were said.
fn axes_words(job: &Asked, mesh: Orientation, loaded: &Loaded) -> String {
    match (&loaded.shape, job.axes) {
        (None, _) | (_, Axes::Mesh) => job.axes.words(mesh),
        (Some(_), axes) => axes.own_words().to_owned(),
    }
}

fn extent_along(mesh: &Mesh, axis: usize) -> f64 {
    let x = mesh.vertices.iter().map(|v| v[axis]);
    let (low, high) = x.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    high - low
}

/// Volume, centre of buoyancy, displaced mass and its inertia: in words, and as numbers.
fn hydrostatics(case: &Case, is_mesh: bool, density_kg_m3: f64, frame: &Frame) -> [Block; 2] {
    let Case { refined, facets, .. } = case;
    let volume_m3 = refined.volume_m3;
    let expanded_m3 = facets.as_ref().map(|facets| facets.volume_uncertainty_m3);
    let known = |scale: f64| match expanded_m3 {
        Some(expanded_m3) => with_uncertainty([scale * volume_m3, scale * expanded_m3]),
        None => number::plain(scale * volume_m3, 6),
    };
    let of = match facets {
        Some(facets) => {
            let of_facets = number::plain(volume_m3 - facets.volume_m3, 6);
            format!("of the smooth body; that of the facets is {of_facets} m³")
        }
        None if is_mesh => "exactly that of the facets".to_owned(),
        None => "exact for the given dimensions".to_owned(),
    };
    let mut rows = vec![
        ("volume", format!("{} m³, {of}", known(1.0))),
        ("displaced mass", format!("{} kg", known(density_kg_m3))),
    ];
    let finest = refined.steps.last().map(|s| s.measure);
    let inertia_kg_m2 =
        |m: Measure| inertia_m5(m.inertia_m5(), m.volume_m3, m.centroid_m, frame).map(|j| density_kg_m3 * j);
    if let Some(m) = finest {
        let list = |v: Vec3| v.map(|x| number::plain(if x.abs() < 1e-12 { 0.0 } else { x }, 5)).join(", ");
        rows.push(("wetted area", format!("{} m²", number::plain(m.area_m2, 6))));
        rows.push(("centre of buoyancy, in the axes of the mesh", format!("({}) m", list(m.centroid_m))));
        let inertia = list(inertia_kg_m2(m));
        rows.push(("inertia of the displaced water about the stated point, xx, yy, zz", format!("({inertia}) kg m²")));
    }
    let caption = "Hydrostatics; area, centre and inertia are those of the finest mesh with its flat facets.";
    let t = TableBuilder::new("", caption, &rows);
    let shown = t.build(vec![
        t.text("", "quantity", |(name, _)| (*name).to_owned()),
        t.text("", "value", |(_, value)| value.clone()),
    ]);
    let f = facts("hydrostatics", "", &finest);
    let numbers = f.build(vec![
        f.number("volume_m3", "", |_| volume_m3),
        f.number("expanded_95/volume_m3", "", |_| expanded_m3),
        f.number("displaced_mass_kg", "", |_| density_kg_m3 * volume_m3),
        f.number("expanded_95/displaced_mass_kg", "", |_| expanded_m3.map(|m3| density_kg_m3 * m3)),
        f.number("wetted_area_m2", "", |m| m.map(|m| m.area_m2)),
        f.numbers("centre_of_buoyancy_m", "", |m| m.map(|m| m.centroid_m.to_vec())),
        f.numbers("inertia_kg_m2", "", |m| m.map(|m| inertia_kg_m2(m).to_vec())),
    ]);
    [shown.into(), numbers.into()]
}
