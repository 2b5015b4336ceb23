//! Several rigid parts in one flow: the links of the robot, straight or bent, or the disconnected parts of a mesh.
//!
//! The matrix has six rows and columns a part, in the part's own axes about its own point: force and moment on one part from the motion of
//! another.

use crate::body_file::{Shape, read_body};
use froude_hydro::similarity::GRAVITY_M_S2;
use froude_identify::method::Export;
use froude_mesh::Mesh;
use froude_mesh::measure::Measure;
use froude_mesh::parts::parts;
use froude_mesh::refine::subdivided;
use froude_mesh::robot::Robot;
use froude_mesh::sections::Resolution;
use froude_mesh::vector::{norm, sub};
use froude_panel::chain::{Chain, ChainError, DiagonalForm, diagonal_form, whole};
use froude_panel::family::Family;
use froude_panel::matrix::AddedMass;
use froude_panel::problem::{Frame, Problem, Solution};
use froude_panel::refine::{Levels, RefineError, RefinedParts, Stop, refine_parts};
use froude_panel::study::Size;
use froude_records::block::{Block, ResultTable, TableBuilder};
use froude_records::estimate::{Diagnostics, Estimate, Measured};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::text::counted;
use indexmap::IndexMap;

use super::exports::{export, of_parts_for_program, words_of_parts};
use super::facets;
use super::frame::{Axes, sentence};
use super::load::{is_body_file, load, of_a_mesh_only};
use super::options::Asked;
use super::record::{MOTIONS, diagonal_head, diagonal_key, entry, entry_name_of_parts, of_panels, unit};
use crate::error::AddedMassError;
use crate::files::AddedMassFile;
use crate::options::Apart;
use crate::uncertain::{expanded, told};
use crate::water::Water;

/// What came out.
#[derive(Debug, Clone)]
pub struct SeveralOutcome {
    /// Name.
    pub name: String,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Axes and points, in words.
    pub place: String,
    /// Names of the parts, in the order of the matrix.
    pub parts: Vec<String>,
    /// Entries over ρ, `6n × 6n`.
    pub value: Vec<Vec<f64>>,
    /// Their numerical uncertainty.
    pub uncertainty: Vec<Vec<f64>>,
    /// Tables for the reader.
    pub tables: Vec<Block>,
    /// Sentences.
    pub notes: Vec<String>,
    /// Doubts.
    pub findings: Vec<Finding>,
    /// The record.
    pub estimate: Estimate,
    /// The matrix as a table, and what was asked for beside it.
    pub exports: Vec<Export>,
}

/// Multiples of the coarsest cells of a chain, one after the other.
const MULTIPLES: [usize; 9] = [3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Meshes from elsewhere: as given, and subdivided.
const MESHES: usize = 9;

/// Computes; the estimate is called after `source`, or after the body where that is empty.
///
/// # Errors
///
/// See [`AddedMassError`].
pub fn several(
    job: &Asked,
    apart: Apart,
    water: &Water,
    source: &str,
    progress: &dyn Fn(&str),
) -> Result<SeveralOutcome, AddedMassError> {
    let loaded = match apart {
        Apart::Links { joint_angle_rad } => links_of(job, joint_angle_rad)?,
        Apart::Parts => parts_of(job)?,
    };
    let density_kg_m3 = water.density_kg_m3(job, loaded.density_kg_m3)?;
    let wanted = &job.wanted;
    let mut refined = refine_parts(loaded.levels.as_ref(), loaded.size, wanted, progress)?;
    let mut findings = loaded.findings;
    findings.extend(refined.stopped.as_ref().map(|why| not_within(refined.worst, wanted.tolerance, why)));
    let mut notes = loaded.notes;
    if let Some(given) = &loaded.given {
        if job.is_polyhedron {
            notes.push(facets::IS_POLYHEDRON.to_owned());
        } else {
            progress("the same with facets rounded");
            let of_mesh = |mesh: &Mesh| given.on(mesh);
            let largest = facets::correct_parts(&mut refined, &given.mesh, &of_mesh, wanted, job.is_smooth);
            facets::report(largest, job.is_smooth, &mut notes, &mut findings);
        }
    }
    let RefinedParts { value, uncertainty, panels, finest, .. } = refined;
    let mut tables: Vec<Block> = vec![diagonal_table(&loaded.parts, &value, &uncertainty, density_kg_m3).into()];
    notes.extend(words_of_parts(job, matches!(apart, Apart::Links { .. })));
    tables.extend(coupling_table(&loaded.parts, &value, density_kg_m3).map(Block::from));
    let together = whole(
        &Solution { matrix: value.clone(), ..finest.clone() },
        &Frame { axes: axes_of(job), ..Frame::at([0.0; 3]) },
    );
    tables.push(whole_table(&together, density_kg_m3).into());
    if let Apart::Links { .. } = apart {
        let form = diagonal_form(&Solution { matrix: value.clone(), ..finest });
        tables.push(diagonal_form_table(&form, density_kg_m3).into());
        notes.push(
            "Equation 4 of the USR paper gives each link an added mass across itself, none along, and no coupling of one link with another; with \
             links of one size it is one number. It is fitted here to the plain links while all parts sway alike, each in its own axes."
                .to_owned(),
        );
        notes.push(
            "Parts are cut at the joints: only motions in which neighbours meet there have a meaning. A part that moves alone opens its joints, and \
             an end that surges alone contains a source of water."
                .to_owned(),
        );
    }
    let name = loaded.name;
    let frame = match apart {
        Apart::Links { .. } => format!("each part's own axes: {}", own_axes(job.axes)),
        Apart::Parts => job.axes.words(job.orientation.unwrap_or_default()),
    };
    let source = if source.is_empty() { &name } else { source };
    let estimate = record(source, &loaded.parts, &value, &uncertainty, density_kg_m3, &panels, &frame, &notes);
    let mut outcome = SeveralOutcome {
        density_kg_m3,
        place: sentence(&frame, "each part's own point"),
        parts: loaded.parts,
        value,
        uncertainty,
        tables,
        notes,
        findings,
        estimate,
        exports: Vec::new(),
        name,
    };
    outcome.exports = exports(&outcome, job)?;
    Ok(outcome)
}

/// What is solved.
struct Several {
    name: String,
    density_kg_m3: Option<f64>,
    parts: Vec<String>,
    levels: Box<dyn Levels>,
    /// The mesh, where it was given as one.
    given: Option<Subdivided>,
    /// Of one part.
    size: Size,
    notes: Vec<String>,
    findings: Vec<Finding>,
}

/// A finding where the tolerance was not reached.
fn not_within(worst: f64, tolerance: f64, why: &Stop) -> Finding {
    let known = if worst.is_finite() {
        format!("is {:.1} %", 100.0 * worst)
    } else {
        "cannot be estimated from one mesh".to_owned()
    };
    let message = format!(
        "the largest numerical uncertainty of an entry, as part of the diagonal, {known} where {:.1} % was asked for: {why}",
        100.0 * tolerance
    );
    Finding::new(Severity::Warning, "not-converged", message)
}

/// A chain, meshed as finely as one likes.
struct Bent {
    robot: Robot,
    links: usize,
    angle_rad: f64,
    /// Axes of the result in those of a link.
    axes: [[f64; 3]; 3],
}

impl Bent {
    fn chain(&self, number: usize) -> Result<Chain, ChainError> {
        let along = MULTIPLES[number];
        let resolution = Resolution { along, around: 8 * along };
        let angles = vec![self.angle_rad; self.links + 1];
        let mut chain = Chain::new(&self.robot, self.links, &angles, self.robot.pitch_m() / 4.0, resolution)?;
        for frame in &mut chain.frames {
            let own = frame.axes;
            frame.axes = self.axes.map(|a| core::array::from_fn(|k| (0..3).map(|m| a[m] * own[m][k]).sum()));
        }
        Ok(chain)
    }
}

impl Levels for Bent {
    fn count(&self) -> usize {
        MULTIPLES.len()
    }

    fn panels(&self, number: usize) -> Result<usize, RefineError> {
        let coarsest = self.chain(0)?.surface.mesh.panels.len();
        Ok(coarsest * MULTIPLES[number].pow(2) / MULTIPLES[0].pow(2))
    }

    fn problem(&self, number: usize) -> Result<(f64, Problem), RefineError> {
        let chain = self.chain(number)?;
        let problem = chain.problem(true).or_else(|_| chain.problem(false))?;
        Ok((MULTIPLES[0] as f64 / MULTIPLES[number] as f64, problem))
    }

    fn is_foreign(&self) -> bool {
        false
    }
}

/// The parts of a mesh, each panel divided into four as often as one likes.
#[derive(Clone)]
struct Subdivided {
    mesh: Mesh,
    frames: Vec<Frame>,
}

impl Subdivided {
    /// Of a mesh with the same parts, and the volume of each, m³.
    fn on(&self, mesh: &Mesh) -> (Problem, Vec<f64>) {
        let volumes = parts(mesh).iter().map(|part| part.volume_m3).collect();
        (Problem::of_parts(mesh, &tags(mesh), &self.frames, &[]), volumes)
    }
}

impl Levels for Subdivided {
    fn count(&self) -> usize {
        MESHES
    }

    fn panels(&self, number: usize) -> Result<usize, RefineError> {
        Ok(self.mesh.panels.len() << (2 * number))
    }

    fn problem(&self, number: usize) -> Result<(f64, Problem), RefineError> {
        let finer = (0..number).fold(self.mesh.clone(), |mesh, _| subdivided(&mesh));
        Ok((0.5_f64.powi(number as i32), self.on(&finer).0))
    }

    fn is_foreign(&self) -> bool {
        true
    }
}

/// The part that each panel belongs to.
fn tags(mesh: &Mesh) -> Vec<usize> {
    let mut out = vec![0; mesh.panels.len()];
    for (part, found) in parts(mesh).iter().enumerate() {
        found.panels.iter().for_each(|panel| out[*panel] = part);
    }
    out
}

/// Axes of the result in those of the mesh, or of a link.
fn axes_of(job: &Asked) -> [[f64; 3]; 3] {
    job.axes.vectors(job.orientation.unwrap_or_default())
}

const fn own_axes(axes: Axes) -> &'static str {
    match axes {
        Axes::Mesh => "x along it towards the head, z vertical",
        Axes::Ned => "x along it towards the head, y to starboard, z down (SNAME, Fossen)",
        Axes::Enu => "x along it towards the head, y to port, z up (ROS REP 103)",
    }
}

fn links_of(job: &Asked, angle_rad: f64) -> Result<Several, AddedMassError> {
    let why = || AddedMassError::input(&job.input, "a chain is a body file of shape \"robot\" with --links");
    if !is_body_file(&job.input) {
        return Err(why());
    }
    of_a_mesh_only(job)?;
    let body = read_body(&job.input)?;
    let (Shape::Robot(robot), Some(&links)) = (body.shape, job.links.first()) else { return Err(why()) };
    Ok(Several { density_kg_m3: body.density_kg_m3, ..chain(&body.name, robot, links, angle_rad, job)? })
}

fn chain(name: &str, robot: Robot, links: usize, angle: f64, job: &Asked) -> Result<Several, AddedMassError> {
    let bent = Bent { robot, links, angle_rad: angle, axes: axes_of(job) };
    // What cannot be bent so is reported before anything is computed.
    bent.chain(0)?;
    let mut parts = vec!["tail".to_owned()];
    parts.extend((1..=links).map(|k| format!("link {k}")));
    parts.push("head".to_owned());
    let notes = vec![format!(
        "H{links}LT: head, {}, tail. Joints bent by {} each about z, the tail end stays where it is in the straight robot; every link has its point half-way between its joints, an \
         end half-way between joint and tip. Links count from the tail.",
        counted(links, "link", "links"),
        number::degrees(angle)
    )];
    let name = format!("{name}, H{links}LT, link by link");
    let volume_m3 = robot.link.volume_m3();
    let size = Size { volume_m3, length_m: robot.pitch_m() };
    Ok(Several {
        size,
        name,
        density_kg_m3: None,
        parts,
        levels: Box::new(bent),
        given: None,
        notes,
        findings: Vec::new(),
    })
}

fn parts_of(job: &Asked) -> Result<Several, AddedMassError> {
    let loaded = load(job)?;
    let Family::Mesh(mesh) = loaded.family else {
        return Err(AddedMassError::input(&job.input, "--apart takes a mesh of several closed parts"));
    };
    let found = parts(&mesh);
    if found.len() < 2 {
        let why = "the mesh is one connected part; omit --apart";
        return Err(AddedMassError::input(&job.input, why));
    }
    let tags = tags(&mesh);
    let frames: Vec<Frame> =
        (0..found.len()).map(|part| Frame { origin_m: centroid(&mesh, &tags, part), axes: axes_of(job) }).collect();
    let names = (1..=found.len()).map(|k| format!("part {k}")).collect();
    let mut notes = loaded.notes;
    for (k, frame) in frames.iter().enumerate() {
        let [x, y, z] = frame.origin_m.map(|x| number::plain(x, 4));
        notes.push(format!("Part {}: about its centre of buoyancy, ({x}, {y}, {z}) m in the axes of the mesh.", k + 1));
    }
    let mut findings = loaded.findings;
    findings.extend(too_close(&Problem::of_parts(&mesh, &tags, &frames, &[])));
    let largest = found.iter().map(|p| p.volume_m3.abs()).fold(0.0, f64::max);
    let size = Size { volume_m3: largest, length_m: largest.cbrt() };
    let given = Subdivided { mesh, frames };
    Ok(Several {
        size,
        name: loaded.name,
        density_kg_m3: None,
        parts: names,
        levels: Box::new(given.clone()),
        given: Some(given),
        notes,
        findings,
    })
}

fn centroid(mesh: &Mesh, tags: &[usize], part: usize) -> [f64; 3] {
    let panels = mesh.panels.iter().zip(tags).filter(|(_, t)| **t == part).map(|(p, _)| *p).collect();
    Measure::of(&Mesh { vertices: mesh.vertices.clone(), panels }).centroid_m
}

/// A finding where parts are closer than their panels are large: constant panels do not see the flow through the gap.
fn too_close(problem: &Problem) -> Option<Finding> {
    let all: Vec<_> = problem.facets.iter().zip(&problem.parts).collect();
    let mut closest: Option<(f64, f64)> = None;
    for (i, (f, part)) in all.iter().enumerate() {
        for (g, other) in &all[i + 1..] {
            let gap = norm(sub(f.centroid, g.centroid));
            if part != other && closest.is_none_or(|(least, _)| gap < least) {
                closest = Some((gap, f.radius.max(g.radius)));
            }
        }
    }
    let (gap, radius) = closest.filter(|(gap, radius)| gap < radius)?;
    let message = format!(
        "parts come as close as {} m where panels have a radius of {} m: the flow through the gap is not resolved and the equations are nearly \
         singular there; give finer panels, or a gap of a panel's size",
        number::plain(gap, 3),
        number::plain(radius, 3)
    );
    Some(Finding::new(Severity::Warning, "parts-touch", message))
}

fn diagonal_table(parts: &[String], value: &[Vec<f64>], uncertainty: &[Vec<f64>], density_kg_m3: f64) -> ResultTable {
    let caption =
        "Each part moving alone, the others held: added mass in its own motions. ± is the numerical uncertainty.";
    let rows: Vec<usize> = (0..parts.len()).collect();
    let t = TableBuilder::new("parts", caption, &rows);
    let mut columns = vec![t.text("part", "part", |p| parts[*p].clone())];
    for i in 0..6 {
        let of = |p: &usize| [value, uncertainty].map(|all| density_kg_m3 * all[6 * p + i][6 * p + i]);
        columns.extend(expanded(&t, &diagonal_key(i), &diagonal_head(i), of));
    }
    t.build(columns)
}

/// Parts of which all pairs are reported.
const MOST_PARTS: usize = 12;

fn coupling_table(parts: &[String], value: &[Vec<f64>], density_kg_m3: f64) -> Option<ResultTable> {
    let caption = "A22 of each pair: the force across a part (row) from the sway of a part (column), kg.";
    let rows: Vec<usize> = (0..parts.len()).collect();
    let t = TableBuilder::new("sway_coupling", caption, &rows);
    let of = |(q, name): (usize, &String)| {
        let key = format!("{}_kg", name.replace(' ', "_"));
        t.number(&key, name, |p| density_kg_m3 * value[6 * p + 1][6 * q + 1]).plain(4)
    };
    let first = t.text("part", "part", |p| parts[*p].clone());
    let columns = std::iter::once(first).chain(parts.iter().enumerate().map(of));
    (parts.len() <= MOST_PARTS).then(|| t.build(columns.collect()))
}

fn whole_table(together: &AddedMass, density_kg_m3: f64) -> ResultTable {
    let caption = "All parts as one rigid body, from the matrix, about the origin of the mesh (of a robot the middle of the straight chain, whose \
                   tail stays where it was; its axes are the tail's): kg, kg m².";
    let rows = [together.matrix];
    let t = TableBuilder::new("whole", caption, &rows);
    let of = |i: usize| t.number(&diagonal_key(i), MOTIONS[i], |a| density_kg_m3 * a[i][i]).plain(6);
    let columns = std::iter::once(t.text("", "body", |_| "whole".to_owned())).chain((0..6).map(of));
    t.build(columns.collect())
}

fn diagonal_form_table(form: &DiagonalForm, density_kg_m3: f64) -> ResultTable {
    let rows =
        [("all alike", form.alike), ("neighbours opposed", form.alternating), ("a travelling wave", form.travelling)];
    let caption = format!(
        "Error of the diagonal form of equation 4 with {} kg a link (the mean force on a link when all sway alike), by how the links sway.",
        number::plain(density_kg_m3 * form.per_link_m3, 5)
    );
    let t = TableBuilder::new("diagonal_form", caption, &rows);
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let mut columns = vec![t.text("sway", "sway", |(name, _)| (*name).to_owned())];
    columns.extend(told(&t, "largest_error", "largest error of a link's force", |(_, e)| e.largest, percent));
    columns.extend(told(&t, "rms_error", "root mean square", |(_, e)| e.rms, percent));
    t.build(columns)
}

fn record(
    name: &str,
    parts: &[String],
    value: &[Vec<f64>],
    uncertainty: &[Vec<f64>],
    density_kg_m3: f64,
    panels: &[usize],
    frame: &str,
    notes: &[String],
) -> Estimate {
    let mut coefficients = IndexMap::new();
    for i in 0..value.len() {
        for j in i..value.len() {
            let (a, u) = (density_kg_m3 * value[i][j], density_kg_m3 * uncertainty[i][j]);
            coefficients.insert(entry_name_of_parts((i, j)), entry(a, u, unit(i % 6, j % 6)));
        }
    }
    let point = format!("each part's own point; rows and columns six a part: {}", parts.join(", "));
    let words = format!(
        "potential flow, constant-strength panels, direct formulation, unbounded water; meshes of {} panels{}; numerical uncertainty of each \
         entry alone, 95 %",
        panels.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        if panels.len() > 1 { ", extrapolated" } else { "" }
    );
    let density = Measured { value: density_kg_m3, unit: "kg/m^3".to_owned() };
    Estimate {
        refers_to: IndexMap::from([("density".to_owned(), density)]),
        coefficients,
        diagnostics: Diagnostics { notes: notes.to_vec(), ..Diagnostics::default() },
        ..of_panels(name, ("added_mass_parts", 2), frame, point, words)
    }
}

/// The matrix for other programs.
fn exports(outcome: &SeveralOutcome, job: &Asked) -> Result<Vec<Export>, AddedMassError> {
    // Zeros without a sign.
    let rows: Vec<Vec<f64>> =
        outcome.value.iter().map(|row| row.iter().map(|a| outcome.density_kg_m3 * a + 0.0).collect()).collect();
    let mut formats = vec!["csv"];
    formats.extend(job.export.iter().filter(|e| **e != "csv"));
    let of = |extension: &'static str| {
        let turned = of_parts_for_program(&rows, extension, job);
        let file = AddedMassFile {
            density_kg_m3: outcome.density_kg_m3,
            gravity_m_s2: GRAVITY_M_S2,
            length_m: 1.0,
            bodies: &outcome.parts,
            zero_frequency: Some(&turned),
            infinite_frequency: Some(&turned),
        };
        export(&file, extension)
    };
    formats.into_iter().map(of).collect()
}
