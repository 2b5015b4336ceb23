//! Meshes refined until the tolerance is met, with the cost stated beforehand.

mod forecast;
mod stop;

use froude_mesh::Mesh;
use froude_mesh::check::extent;
use froude_mesh::measure::Measure;

use crate::convergence::Converged;
use crate::family::{Family, Member};
use crate::frame::Frame;
use crate::matrix::AddedMass;
use crate::mirror::{Mirror, positive_part};
use crate::problem::{Problem, Report, Solution};
use crate::solve;
use crate::study::{SLOW, Size, Study, study};
use crate::tank::{Surface, Tank};

use crate::refine::forecast::duration;
pub use crate::refine::forecast::{Forecast, forecast};
pub use crate::refine::stop::{NoMemory, RefineError, Stop};

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Axes of the matrix and the point that it is about, as the mesh has them.
    pub frame: Frame,
    /// Largest numerical uncertainty: of a diagonal entry as part of itself, of another as part of √(A_ii A_jj).
    pub tolerance: f64,
    /// Largest number of panels.
    pub most_panels: usize,
    /// Memory at most, bytes; `None`: four fifths of what is free when each mesh begins.
    pub memory_bytes: Option<f64>,
    /// Mirror planes that are not the body's: a wall, the water's surface.
    pub mirrors: Vec<Mirror>,
    /// A tank around the body, instead of mirrors.
    pub tank: Option<Placed>,
}

/// A tank with a limit of its surface; the origin of the mesh lies in the middle of its plan, below the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// The tank.
    pub tank: Tank,
    /// The limit.
    pub surface: Surface,
    /// Height of the surface over the origin of the mesh, m.
    pub over_origin_m: f64,
}

impl Step {
    /// As a solution without its potentials.
    fn solution(&self) -> Solution {
        let report = Report { iterations: self.iterations, ..Report::default() };
        let matrix = self.added_mass.matrix.iter().map(|row| row.to_vec()).collect();
        Solution { potentials: Vec::new(), matrix, frames: Vec::new(), report }
    }
}

impl Default for Wanted {
    fn default() -> Self {
        Self {
            frame: Frame::at([0.0; 3]),
            tolerance: 0.01,
            most_panels: 120_000,
            memory_bytes: None,
            mirrors: Vec::new(),
            tank: None,
        }
    }
}

/// One mesh and its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Panels of the whole body.
    pub panels: usize,
    /// Unknowns that were solved for, after the body's own mirror planes.
    pub unknowns: usize,
    /// Size of the cells over those of the coarsest mesh.
    pub size: f64,
    /// Iterations; 0 for a direct solution.
    pub iterations: usize,
    /// Matrix over ρ.
    pub added_mass: AddedMass,
    /// Volume, area, centre of buoyancy of this mesh.
    pub measure: Measure,
}

/// A matrix with its numerical uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// Entries over ρ, extrapolated where the meshes allow: m³, m⁴, m⁵.
    pub value: [[f64; 6]; 6],
    /// Their numerical uncertainty, as an expanded one; infinite where there is one mesh only.
    pub uncertainty: [[f64; 6]; 6],
    /// Parts of the standard uncertainty (half of the numerical one) that all entries have in common, over ρ: each goes through turns and
    /// shifts as the matrix does. What an entry has beyond them is its own.
    pub shared: Vec<[[f64; 6]; 6]>,
    /// Observed order of convergence; `None` where the values do not fall in a row.
    pub order: [[Option<f64>; 6]; 6],
    /// Volume of the body, m³; of a mesh from elsewhere that of its facets. Exact but for rounding.
    pub volume_m3: f64,
    /// From the coarsest on; all of them, not only those that the value is from.
    pub steps: Vec<Step>,
    /// Largest relative uncertainty, as the tolerance counts it.
    pub worst: f64,
    /// Whether it is within the tolerance.
    pub is_within: bool,
    /// Why it is not, where it is not.
    pub stopped: Option<Stop>,
    /// The finest mesh that was solved on.
    pub finest: Finest,
}

/// The finest mesh and its potentials.
#[derive(Debug, Clone, PartialEq)]
pub struct Finest {
    /// Panels that were solved for: on the positive side of the body's own planes.
    pub mesh: Mesh,
    /// Those planes, and any other mirrors.
    pub mirrors: Vec<Mirror>,
    /// Potentials about the origin of the mesh.
    pub solution: Solution,
}

/// An entry with its numerical uncertainty.
#[derive(Debug, Clone, Copy)]
struct Entry {
    value: f64,
    uncertainty: f64,
    shared: f64,
    order: Option<f64>,
}

/// Least uncertainty at edges that are not resolved, as part of what extrapolation subtracts: an order of 0.8 leaves three times that.
const AT_EDGES: f64 = 3.0;
/// Meshes that an uncertainty to be trusted asks for.
const ENOUGH: usize = 3;
/// Residual above which a solution is none.
const LOOSE: f64 = 1e-6;
/// Part of the free memory that may be asked for.
const MEMORY_PART: f64 = 0.8;

/// Free memory of the machine, bytes; `None` where it cannot be known.
#[must_use]
pub fn free_memory_bytes() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kib| 1024.0 * kib)
}

/// Memory that may be used now, bytes.
#[must_use]
pub fn memory_bytes(wanted: &Wanted) -> f64 {
    wanted.memory_bytes.or_else(|| Some(MEMORY_PART * free_memory_bytes()?)).unwrap_or(f64::INFINITY)
}

/// Cells of a tank's walls, as part of its shortest side, in a multiple of one.
const WALL_CELL: f64 = 0.25;

/// The problem of a mesh about the origin of its frame, and what is solved of the mesh: its part on the positive side of its own planes.
fn problem(family: &Family, member: &Member, wanted: &Wanted) -> Result<(Mesh, Problem), RefineError> {
    let mesh = &member.mesh;
    let frame = [Frame::at([0.0; 3])];
    let whole = |mirrors: &[Mirror]| Problem::of_parts(&mesh.mesh, &vec![0; mesh.mesh.panels.len()], &frame, mirrors);
    if let Some(Placed { tank, surface, over_origin_m }) = wanted.tank {
        let cells =
            tank.cells(WALL_CELL * tank.length_m.min(tank.width_m).min(tank.depth_m)).map(|n| n * member.multiple);
        let problem = tank.around(&whole(&[]), [0.0, 0.0, -over_origin_m], cells, surface)?;
        return Ok((mesh.mesh.clone(), problem));
    }
    if let Family::Sections { planes, .. } = family {
        let own = planes.iter().filter(|axis| wanted.mirrors.iter().all(|m| m.axis != **axis));
        let mirrors: Vec<Mirror> = own.map(|axis| Mirror::body(*axis)).chain(wanted.mirrors.iter().copied()).collect();
        if let Ok(part) = positive_part(&mesh.mesh, &mirrors) {
            let problem = Problem::of_parts(&part, &vec![0; part.panels.len()], &frame, &mirrors);
            return Ok((part, problem));
        }
    }
    Ok((mesh.mesh.clone(), whole(&wanted.mirrors)))
}

/// Several parts on one mesh after the other, each finer than the one before.
pub trait Levels {
    /// How many there are.
    fn count(&self) -> usize;

    /// Panels of one, without making it.
    ///
    /// # Errors
    ///
    /// Dimensions that give no body.
    fn panels(&self, number: usize) -> Result<usize, RefineError>;

    /// One of them, and the size of its cells over those of the coarsest.
    ///
    /// # Errors
    ///
    /// Dimensions that give no body; a body that does not fit into its tank.
    fn problem(&self, number: usize) -> Result<(f64, Problem), RefineError>;

    /// Whether the meshes are subdivisions of one from elsewhere, as those of [`Family::Mesh`] are.
    fn is_foreign(&self) -> bool;
}

/// Solves one level after the other until `is_enough` of what was solved, or panels, memory or levels end; why it ended before.
fn climb<L>(
    levels: usize,
    panels_of: &dyn Fn(usize) -> Result<usize, RefineError>,
    level: &dyn Fn(usize) -> Result<(L, Problem), RefineError>,
    wanted: &Wanted,
    progress: &dyn Fn(&str),
    mut is_enough: impl FnMut(usize, L, Problem, Solution) -> bool,
) -> Result<Option<Stop>, RefineError> {
    for number in 0..levels {
        let panels = panels_of(number)?;
        if panels > wanted.most_panels {
            if number == 0 {
                return Err(too_fine(panels, panels_of(ENOUGH - 1)?, wanted));
            }
            return Ok(Some(Stop::Panels { panels, most: wanted.most_panels }));
        }
        let (level, problem) = level(number)?;
        let forecast = forecast(&problem);
        let free = memory_bytes(wanted);
        if forecast.memory_bytes > free {
            let fits = (panels as f64 * free / forecast.memory_bytes) as usize;
            let why = NoMemory { panels, needed_bytes: forecast.memory_bytes, free_bytes: free, fits };
            return if number == 0 { Err(RefineError::Memory(why)) } else { Ok(Some(Stop::Memory(why))) };
        }
        progress(&format!(
            "{panels} panels, {} unknowns: some {} and {:.0} MB",
            forecast.unknowns,
            duration(forecast.seconds),
            forecast.memory_bytes / 1e6
        ));
        let solution = solve(&problem);
        if solution.report.residual > LOOSE {
            let Report { iterations, residual, .. } = solution.report;
            return Err(RefineError::Unsolved { panels, iterations, residual });
        }
        if is_enough(panels, level, problem, solution) {
            return Ok(None);
        }
    }
    Ok(None)
}

/// Refines until the tolerance is met, or panels, memory or members end; `progress` hears of every step before it starts.
///
/// # Errors
///
/// Dimensions that give no body; a mesh that does not fit into the memory even as it is, with the number of panels that would; one of more
/// panels than are allowed.
pub fn refine(family: &Family, wanted: &Wanted, progress: &dyn Fn(&str)) -> Result<Refined, RefineError> {
    let length_m = extent(&family.member(0)?.mesh.mesh);
    let least_m5 = 0.25 * length_m * length_m * Measure::of(&family.member(0)?.mesh.mesh).volume_m3;
    let is_foreign = matches!(family, Family::Mesh(_));
    let mut steps: Vec<Step> = Vec::new();
    let mut finest = None;
    let level = |number: usize| {
        let member = family.member(number)?;
        let (mesh, problem) = problem(family, &member, wanted)?;
        Ok(((member, mesh), problem))
    };
    let panels_of = |number: usize| Ok(family.panels(number)?);
    let mut stopped =
        climb(family.members(), &panels_of, &level, wanted, progress, |_, (member, mesh), solved, solution| {
            steps.push(Step {
                panels: member.mesh.mesh.panels.len(),
                unknowns: solved.facets.len(),
                size: member.size,
                iterations: solution.report.iterations,
                added_mass: solution.added_mass(0).seen_from(&wanted.frame),
                measure: Measure::of(&member.mesh.mesh),
            });
            finest = Some(Finest { mesh, mirrors: solved.mirrors, solution });
            steps.len() >= ENOUGH && worst(&entries(&steps, length_m, is_foreign), least_m5) <= wanted.tolerance
        })?;
    let Some(finest) = finest else {
        return Err(RefineError::NoMesh);
    };
    let entries = entries(&steps, length_m, is_foreign);
    let worst = worst(&entries, least_m5);
    let is_within = worst <= wanted.tolerance;
    if !is_within && stopped.is_none() {
        stopped = Some(Stop::Finest);
    }
    let shared = if steps.len() > 1 { vec![entries.map(|row| row.map(|e| e.shared))] } else { Vec::new() };
    Ok(Refined {
        value: entries.map(|row| row.map(|e| e.value)),
        uncertainty: entries.map(|row| row.map(|e| e.uncertainty)),
        shared,
        order: entries.map(|row| row.map(|e| e.order)),
        volume_m3: family.volume_m3(),
        steps,
        worst,
        is_within,
        stopped: stopped.filter(|_| !is_within),
        finest,
    })
}

/// The matrix of several parts with its numerical uncertainty.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinedParts {
    /// Entries over ρ, extrapolated where the meshes allow, six rows and columns a part: m³, m⁴, m⁵.
    pub value: Vec<Vec<f64>>,
    /// Their numerical uncertainty, as an expanded one; infinite where there is one mesh only.
    pub uncertainty: Vec<Vec<f64>>,
    /// Panels of the meshes, from the coarsest on.
    pub panels: Vec<usize>,
    /// Largest uncertainty of an entry over √(A_ii A_jj), as the tolerance counts it.
    pub worst: f64,
    /// Why it is not within the tolerance, where it is not.
    pub stopped: Option<Stop>,
    /// The solution on the finest mesh.
    pub finest: Solution,
    /// Matrix on the second mesh.
    pub once_divided: Option<Vec<Vec<f64>>>,
}

/// Refines several parts as [`refine`] does one body; `size` is that of one part.
///
/// # Errors
///
/// As [`refine`].
pub fn refine_parts(
    levels: &dyn Levels,
    size: Size,
    wanted: &Wanted,
    progress: &dyn Fn(&str),
) -> Result<RefinedParts, RefineError> {
    let (mut sizes, mut panels, mut solutions) = (Vec::new(), Vec::new(), Vec::new());
    let is_foreign = levels.is_foreign();
    let (panels_of, level) = (|number: usize| levels.panels(number), |number: usize| levels.problem(number));
    let mut stopped = climb(levels.count(), &panels_of, &level, wanted, progress, |of_body, cells, _, solution| {
        sizes.push(cells);
        panels.push(of_body);
        solutions.push(solution);
        solutions.len() >= ENOUGH
            && worst_of_parts(&parts_of(&sizes, &solutions, size, is_foreign), size) <= wanted.tolerance
    })?;
    let Some(finest) = solutions.last().cloned() else {
        return Err(RefineError::NoMesh);
    };
    let entries = parts_of(&sizes, &solutions, size, is_foreign);
    let worst = worst_of_parts(&entries, size);
    let is_within = worst <= wanted.tolerance;
    if !is_within && stopped.is_none() {
        stopped = Some(Stop::Finest);
    }
    let of = |k: usize| entries.iter().map(|row| row.iter().map(|e| e[k]).collect()).collect();
    Ok(RefinedParts {
        value: of(0),
        uncertainty: of(1),
        panels,
        worst,
        stopped: stopped.filter(|_| !is_within),
        finest,
        once_divided: solutions.get(1).map(|s| s.matrix.clone()),
    })
}

/// Values and uncertainties of the entries of parts; of one mesh no uncertainty.
fn parts_of(sizes: &[f64], solutions: &[Solution], size: Size, is_foreign: bool) -> Vec<Vec<[f64; 2]>> {
    match solutions {
        [] => Vec::new(),
        [only] => only.matrix.iter().map(|row| row.iter().map(|a| [*a, f64::INFINITY]).collect()).collect(),
        [.., finest] => {
            let study = study(sizes, solutions, size);
            let foreign = is_foreign.then(|| Foreign::of(&study, study.asymmetry));
            let of = |(i, j): (usize, usize)| {
                let c = &study.entries[i][j];
                let root = (finest.matrix[i][i] * finest.matrix[j][j]).abs().sqrt();
                [c.extrapolated.value, Foreign::uncertainty(foreign, c, (i == j, root))]
            };
            let n = study.entries.len();
            (0..n).map(|i| (0..n).map(|j| of((i, j))).collect()).collect()
        }
    }
}

/// As for one body: a roll that hardly resists counts as a part of what turning a part of this size takes.
fn worst_of_parts(entries: &[Vec<[f64; 2]>], size: Size) -> f64 {
    let half = 0.5 * size.length_m;
    let least = |i: usize| size.volume_m3 * if i % 6 < 3 { 1.0 } else { half * half };
    let own = |i: usize| entries[i][i][0].abs().max(ZERO * least(i));
    let mut out = 0.0_f64;
    for (i, row) in entries.iter().enumerate() {
        for (j, [_, uncertainty]) in row.iter().enumerate() {
            let part = uncertainty / (own(i) * own(j)).sqrt();
            out = if part.is_nan() { f64::INFINITY } else { out.max(part) };
        }
    }
    out
}

const fn too_fine(coarsest: usize, third: usize, wanted: &Wanted) -> RefineError {
    RefineError::TooFine { coarsest, third, most: wanted.most_panels }
}

/// What each mesh would take, up to the panels allowed: panels of the body, and the forecast.
///
/// # Errors
///
/// Dimensions that give no body, and a mesh of more panels than are allowed.
pub fn plan(family: &Family, wanted: &Wanted) -> Result<Vec<(usize, Forecast)>, RefineError> {
    let mut out = Vec::new();
    for number in 0..family.members() {
        let panels = family.panels(number)?;
        if panels > wanted.most_panels {
            if out.is_empty() {
                return Err(too_fine(panels, family.panels(ENOUGH - 1)?, wanted));
            }
            break;
        }
        out.push((panels, forecast(&problem(family, &family.member(number)?, wanted)?.1)));
    }
    Ok(out)
}

/// What a mesh from elsewhere leaves uncertain beyond extrapolation, of one body or of several parts.
#[derive(Debug, Clone, Copy)]
struct Foreign {
    /// Least uncertainty as part of what extrapolation subtracts. Cells of such a mesh are not finer towards its edges: where two diagonal
    /// entries of a part say so, every value may be further off than extrapolation goes.
    edges: f64,
    /// Raw asymmetry of the finest mesh. Triangles break the symmetry of a body: what a coupling owes to that does not fall in a row from mesh to
    /// mesh.
    asymmetry: f64,
}

impl Foreign {
    fn of(study: &Study, asymmetry: f64) -> Self {
        let is_slow = |i: &usize| study.entries[*i][*i].order.is_some_and(|p| SLOW.contains(&p));
        let mut parts = (0..study.entries.len()).step_by(6);
        let is_coarse = parts.any(|first| (first..first + 6).filter(is_slow).count() > 1);
        Self { edges: if is_coarse { AT_EDGES } else { 0.0 }, asymmetry }
    }

    /// Of an entry, on the diagonal or not, with √(A_ii A_jj); of a mesh that was made for the body that of the extrapolation alone.
    fn uncertainty(foreign: Option<Self>, c: &Converged, (is_diagonal, root): (bool, f64)) -> f64 {
        let own = c.extrapolated.uncertainty;
        let Some(foreign) = foreign else { return own };
        let off = (c.fine.value - c.extrapolated.value).abs();
        let broken = if is_diagonal { 0.0 } else { foreign.asymmetry * root };
        own.max(broken).max(foreign.edges * off)
    }
}

/// Entries of the last three meshes together, or of two; of one no uncertainty.
fn entries(steps: &[Step], length_m: f64, is_foreign: bool) -> [[Entry; 6]; 6] {
    let sizes: Vec<f64> = steps.iter().map(|s| s.size).collect();
    let solutions: Vec<Solution> = steps.iter().map(Step::solution).collect();
    let Some(last) = steps.last() else {
        return [[Entry { value: f64::NAN, uncertainty: f64::INFINITY, shared: 0.0, order: None }; 6]; 6];
    };
    if steps.len() == 1 {
        let alone = |value| Entry { value, uncertainty: f64::INFINITY, shared: 0.0, order: None };
        return last.added_mass.matrix.map(|row| row.map(alone));
    }
    let size = Size { volume_m3: last.measure.volume_m3, length_m };
    let study = study(&sizes, &solutions, size);
    let foreign = is_foreign.then(|| Foreign::of(&study, last.added_mass.asymmetry));
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let c = &study.entries[i][j];
            let root = (last.added_mass.matrix[i][i] * last.added_mass.matrix[j][j]).abs().sqrt();
            Entry {
                value: c.extrapolated.value,
                uncertainty: Foreign::uncertainty(foreign, c, (i == j, root)),
                shared: c.shared,
                order: c.order,
            }
        })
    })
}

/// Part of what turning takes, the largest of a body or ρV(L/2)², that a rotation is judged as at least: the roll of a slender body.
const ZERO: f64 = 1e-2;

/// Largest uncertainty of an entry over √(A_ii A_jj); `least_m5` is what turning a body of this size may take.
fn worst(entries: &[[Entry; 6]; 6], least_m5: f64) -> f64 {
    let turning = (3..6).map(|k| entries[k][k].value.abs()).fold(least_m5, f64::max);
    let size = |i: usize| entries[i][i].value.abs().max(if i < 3 { 0.0 } else { ZERO * turning });
    let mut out = 0.0_f64;
    for (i, row) in entries.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let part = entry.uncertainty / (size(i) * size(j)).sqrt();
            // `max` would pass over what is no number.
            out = if part.is_nan() { f64::INFINITY } else { out.max(part) };
        }
    }
    out
}
