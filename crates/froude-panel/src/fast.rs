//! The fast solver: near panels in closed form, far ones by expansion over a tree of boxes, iterations for the solution.
//!
//! The near part of K is stored in single precision, the far part not at all; S acts once, while the near part is made. Work and memory
//! grow in proportion to the panels.

use std::collections::BTreeMap;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use froude_mesh::panel::Facet;
use froude_mesh::vector::Vec3;
use rayon::prelude::*;

use crate::closed::{Points, Polygon, accumulate, near};
use crate::expansion::{Expansion, POINTS};
use crate::gmres::{self, LANES, Lane};
use crate::mirror::{Mirror, image};
use crate::problem::{Problem, Report, Solution};
use crate::tree::{Cell, Cube, Placed, Side};

/// 4π.
const FOUR_PI: f64 = 4.0 * core::f64::consts::PI;
/// Residual over right-hand side at which iterations end: below what single precision leaves.
const TOLERANCE: f64 = 1e-8;
/// Iterations at most; bodies without deep recesses need 8 to 12.
const LIMIT: usize = 200;

/// What a solution will take, known before it starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Unknowns.
    pub unknowns: usize,
    /// Pairs of panel and point in closed form.
    pub near_pairs: usize,
    /// Pairs of boxes.
    pub far_pairs: usize,
    /// Memory, bytes.
    pub memory_bytes: usize,
}

/// A panel or the image of one.
struct Source {
    facet: Facet,
    panel: u32,
    image: u32,
}

/// Panels and points in their boxes.
struct Layout {
    cube: Cube,
    sources: Vec<Source>,
    from: Side,
    to: Side,
    cost: Cost,
}

impl Layout {
    fn new(problem: &Problem) -> Self {
        let sources: Vec<Source> = (0..1_u32 << problem.mirrors.len())
            .flat_map(|set| {
                problem.facets.iter().enumerate().map(move |(panel, facet)| Source {
                    facet: image_of(facet, &problem.mirrors, set),
                    panel: panel as u32,
                    image: set,
                })
            })
            .collect();
        let placed = |f: &Facet| Placed { point: f.centroid, radius: f.radius };
        let there: Vec<Placed> = sources.iter().map(|s| placed(&s.facet)).collect();
        let here: Vec<Placed> = problem.facets.iter().map(placed).collect();
        // Boxes come in steps of two: where they fall is chosen for the least work.
        let (cube, from, to, [near_pairs, far_pairs]) = [1.0, 1.2, 1.45, 1.7]
            .map(|factor| {
                let cube = Cube::around(&there, factor);
                let (from, to) = (Side::new(&cube, &there), Side::new(&cube, &here));
                let pairs = pairs(&from, &to);
                (cube, from, to, pairs)
            })
            .into_iter()
            .min_by_key(|(.., [near, far])| near * NEAR_WORK + far * FAR_WORK)
            .unwrap_or_else(|| unreachable!("four were tried"));
        let boxes: usize = [&from, &to].iter().flat_map(|s| &s.levels).map(|l| l.cells.len()).sum();
        let columns = problem.columns().div_ceil(LANES) * LANES;
        let memory_bytes = 4 * near_pairs
            + 4 * POINTS * (sources.len() + here.len())
            + 4 * POINTS * LANES * boxes
            + 8 * here.len() * LANES * 16
            + 8 * here.len() * columns * 2
            + 400 * sources.len()
            + 340 * 4 * POINTS * POINTS;
        let cost = Cost { unknowns: here.len(), near_pairs, far_pairs, memory_bytes };
        Self { cube, sources, from, to, cost }
    }
}

/// Work of a near pair and of a pair of boxes, in the same unit: as measured, some 20 ns and 40 µs over a whole solution.
const NEAR_WORK: usize = 1;
const FAR_WORK: usize = 2000;

/// Near pairs and pairs of boxes.
fn pairs(from: &Side, to: &Side) -> [usize; 2] {
    let mut out = [0; 2];
    for (level, boxes) in to.levels.iter().enumerate() {
        let level = level as u32;
        for (cell, own) in boxes.cells.iter().zip(&boxes.own) {
            if !own.is_empty() {
                out[0] += own.len() * from.near(level, *cell).len();
            }
            if level >= 2 {
                out[1] += from.far(level, *cell).len();
            }
        }
    }
    out
}

/// What a problem will take.
#[must_use]
pub fn cost(problem: &Problem) -> Cost {
    Layout::new(problem).cost
}

fn image_of(facet: &Facet, mirrors: &[Mirror], set: u32) -> Facet {
    let mut out = *facet;
    for (bit, mirror) in mirrors.iter().enumerate() {
        if set >> bit & 1 == 0 {
            continue;
        }
        out.centroid = image(mirror, out.centroid);
        out.normal[mirror.axis] = -out.normal[mirror.axis];
        out.corners = out.corners.map(|c| image(mirror, c));
        // Seen from the fluid the corners still run counter-clockwise.
        let [a, b, c, d] = out.corners;
        out.corners = if out.count == 3 { [a, c, b, b] } else { [a, d, c, b] };
    }
    out
}

/// Near part of K over the points of a box.
struct Block {
    targets: Vec<u32>,
    sources: Vec<u32>,
    /// `sources × targets`.
    values: Vec<f32>,
}

/// Sources or targets of a box, with the matrix between them and the box's potential.
struct Attached {
    level: usize,
    number: usize,
    members: Vec<u32>,
    matrix: Mat<f32>,
}

/// K, ready to act.
struct Operator<'a> {
    layout: &'a Layout,
    expansion: Expansion,
    blocks: Vec<Block>,
    out: Vec<Attached>,
    into: Vec<Attached>,
    /// Pairs of boxes by level and offset: from, to; ordered by the box they act on.
    pairs: Vec<BTreeMap<Cell, Vec<[u32; 2]>>>,
    signs: Vec<Lane>,
    unknowns: usize,
}

/// Numbers of a box, one a point and column: column by column.
type Potentials = Vec<Vec<f32>>;

impl<'a> Operator<'a> {
    /// Builds K, and S v beside it. `velocities` has the normal velocities, `signs` the sign of each column on each image.
    fn new(layout: &'a Layout, points: &[Vec3], velocities: &[Lane], signs: Vec<Lane>) -> (Self, Vec<Lane>) {
        let mut pairs: Vec<BTreeMap<Cell, Vec<[u32; 2]>>> = vec![BTreeMap::new(); layout.to.levels.len()];
        for (level, boxes) in layout.to.levels.iter().enumerate().skip(2) {
            for (k, cell) in boxes.cells.iter().enumerate() {
                for (other, offset) in layout.from.far(level as u32, *cell) {
                    pairs[level].entry(offset).or_default().push([other as u32, k as u32]);
                }
            }
        }
        let mut offsets: Vec<Cell> = pairs.iter().flat_map(|p| p.keys().copied()).collect();
        offsets.sort_unstable();
        offsets.dedup();
        let expansion = Expansion::new(&offsets);
        let mut operator = Self {
            layout,
            expansion,
            blocks: Vec::new(),
            out: Vec::new(),
            into: Vec::new(),
            pairs,
            signs,
            unknowns: points.len(),
        };
        operator.into = operator.attach(&layout.to, |members, centre, half_width| {
            let own: Vec<Vec3> = members.iter().map(|i| points[*i as usize]).collect();
            operator.expansion.inside(&own, centre, half_width)
        });
        // S v and K share their expensive parts: S acts while K is made.
        let mut single_out: Vec<(usize, usize, Vec<f32>)> = Vec::new();
        let strengths: Vec<Lane> = operator.strengths(velocities);
        let made: Vec<(Attached, Vec<f32>)> = leaves(&layout.from)
            .par_iter()
            .map(|&(level, number)| operator.outgoing(level, number, &strengths))
            .collect();
        for (attached, single) in made {
            single_out.push((attached.level, attached.number, single));
            operator.out.push(attached);
        }
        let mut right = operator.far(&single_out);
        let blocks: Vec<(Block, Vec<Lane>)> = leaves(&layout.to)
            .par_iter()
            .map(|&(level, number)| operator.block(level, number, points, &strengths))
            .collect();
        for (block, sums) in blocks {
            for (t, sum) in block.targets.iter().zip(sums) {
                (0..LANES).for_each(|l| right[*t as usize][l] += sum[l]);
            }
            operator.blocks.push(block);
        }
        right.iter_mut().flatten().for_each(|x| *x = -*x);
        (operator, right)
    }

    fn attach(&self, side: &Side, matrix: impl Fn(&[u32], Vec3, f64) -> Mat<f32> + Sync) -> Vec<Attached> {
        leaves(side)
            .into_par_iter()
            .filter(|(level, _)| *level >= 2)
            .map(|(level, number)| {
                let boxes = &side.levels[level];
                let members = boxes.own[number].clone();
                let centre = self.layout.cube.centre(level as u32, boxes.cells[number]);
                let matrix = matrix(&members, centre, self.layout.cube.half_width(level as u32));
                Attached { level, number, members, matrix }
            })
            .collect()
    }

    /// Strength of each source in each column.
    fn strengths(&self, values: &[Lane]) -> Vec<Lane> {
        self.layout
            .sources
            .iter()
            .map(|s| {
                let (v, sign) = (&values[s.panel as usize], &self.signs[s.image as usize]);
                core::array::from_fn(|l| v[l] * sign[l])
            })
            .collect()
    }

    /// Potential going out of a box: its matrix for K, and its values for S v.
    fn outgoing(&self, level: usize, number: usize, strengths: &[Lane]) -> (Attached, Vec<f32>) {
        let boxes = &self.layout.from.levels[level];
        let members = boxes.own[number].clone();
        let half_width = self.layout.cube.half_width(level as u32);
        let mut single = vec![0.0_f64; POINTS * LANES];
        if level < 2 {
            return (Attached { level, number, members: Vec::new(), matrix: Mat::zeros(POINTS, 0) }, Vec::new());
        }
        let outside = self.expansion.outside(self.layout.cube.centre(level as u32, boxes.cells[number]), half_width);
        let outside: Points = outside.into_iter().collect();
        let mut matrix = Mat::<f32>::zeros(POINTS, members.len());
        let (mut source, mut dipole) = (vec![0.0; POINTS], vec![0.0; POINTS]);
        for (column, &s) in members.iter().enumerate() {
            near(&Polygon::of(&self.layout.sources[s as usize].facet), &outside, &mut source, &mut dipole);
            for i in 0..POINTS {
                matrix[(i, column)] = (half_width * dipole[i]) as f32;
            }
            for l in 0..LANES {
                let strength = half_width * strengths[s as usize][l];
                for i in 0..POINTS {
                    single[l * POINTS + i] += strength * source[i];
                }
            }
        }
        (Attached { level, number, members, matrix }, single.iter().map(|x| *x as f32).collect())
    }

    /// Near part over the points of a box: K to keep, and S v there.
    fn block(&self, level: usize, number: usize, points: &[Vec3], strengths: &[Lane]) -> (Block, Vec<Lane>) {
        let boxes = &self.layout.to.levels[level];
        let targets = boxes.own[number].clone();
        let sources = self.layout.from.near(level as u32, boxes.cells[number]);
        let at: Points = targets.iter().map(|t| points[*t as usize]).collect();
        let count = targets.len();
        let mut values = Vec::with_capacity(sources.len() * count);
        let mut sums = vec![[0.0; LANES]; count];
        let (mut single, mut double) = (vec![0.0; count], vec![0.0; count]);
        for &s in &sources {
            let source = &self.layout.sources[s as usize];
            near(&Polygon::of(&source.facet), &at, &mut single, &mut double);
            let strength = strengths[s as usize].map(|x| x / FOUR_PI);
            for (i, t) in targets.iter().enumerate() {
                (0..LANES).for_each(|l| sums[i][l] += single[i] * strength[l]);
                // A panel does not turn its own potential.
                let is_own = source.image == 0 && source.panel == *t;
                values.push(if is_own { 0.0 } else { (double[i] / FOUR_PI) as f32 });
            }
        }
        (Block { targets, sources, values }, sums)
    }

    /// K φ.
    fn apply(&self, values: &[Lane]) -> Vec<Lane> {
        let strengths = self.strengths(values);
        let gone: Vec<(usize, usize, Vec<f32>)> = self
            .out
            .par_iter()
            .map(|a| {
                let own = Mat::from_fn(a.members.len(), LANES, |i, l| strengths[a.members[i] as usize][l] as f32);
                (a.level, a.number, product(&a.matrix, own.as_ref()))
            })
            .collect();
        let mut sum = self.far(&gone);
        let near: Vec<Vec<f64>> = self.blocks.par_iter().map(|b| b.apply(&strengths)).collect();
        for (block, part) in self.blocks.iter().zip(near) {
            for (i, t) in block.targets.iter().enumerate() {
                (0..LANES).for_each(|l| sum[*t as usize][l] += part[l * block.targets.len() + i]);
            }
        }
        sum
    }

    /// Potentials at the points from those that go out of the boxes: up, across, down.
    fn far(&self, gone: &[(usize, usize, Vec<f32>)]) -> Vec<Lane> {
        let (from, to) = (&self.layout.from, &self.layout.to);
        let zeros = |side: &Side| -> Vec<Potentials> {
            side.levels.iter().map(|l| vec![vec![0.0; POINTS * LANES]; l.cells.len()]).collect()
        };
        let mut sum = vec![[0.0; LANES]; self.unknowns];
        if from.levels.len() < 3 || to.levels.len() < 3 {
            return sum;
        }
        let mut out = zeros(from);
        for (level, number, values) in gone.iter().filter(|g| g.0 >= 2) {
            out[*level][*number].iter_mut().zip(values).for_each(|(a, b)| *a += b);
        }
        for level in (3..from.levels.len()).rev() {
            let (coarse, fine) = out.split_at_mut(level);
            let links = |octant| family(from, level, octant);
            step(&self.expansion.up, &fine[0], &mut coarse[level - 1], &links, true);
        }
        let mut come = zeros(to);
        for level in 2..to.levels.len() {
            if level > 2 {
                let (coarse, fine) = come.split_at_mut(level);
                let links = |octant| family(to, level, octant);
                step(&self.expansion.down, &coarse[level - 1], &mut fine[0], &links, false);
            }
            if level < from.levels.len() {
                self.across(&self.pairs[level], &out[level], &mut come[level]);
            }
        }
        let ends: Vec<(&Attached, Vec<f32>)> = self
            .into
            .par_iter()
            .map(|a| {
                let there = MatRef::from_column_major_slice(&come[a.level][a.number], POINTS, LANES);
                (a, product(&a.matrix, there))
            })
            .collect();
        for (a, values) in ends {
            for (i, t) in a.members.iter().enumerate() {
                let n = a.members.len();
                (0..LANES).for_each(|l| sum[*t as usize][l] += f64::from(values[l * n + i]) / FOUR_PI);
            }
        }
        sum
    }

    /// Box on box over one level, stretch by stretch of the boxes acted on. Stretches, and the order of the sums, are the same on any number
    /// of threads.
    fn across(&self, pairs: &BTreeMap<Cell, Vec<[u32; 2]>>, out: &Potentials, come: &mut Potentials) {
        let share = come.len().div_ceil(STRETCHES).max(BATCH);
        come.par_chunks_mut(share).enumerate().for_each(|(chunk, come)| {
            let (first, mut from, mut to) = (chunk * share, Vec::new(), Vec::new());
            for (offset, pairs) in pairs {
                let low = pairs.partition_point(|p| (p[1] as usize) < first);
                let high = pairs.partition_point(|p| (p[1] as usize) < first + come.len());
                for part in pairs[low..high].chunks(BATCH) {
                    from.clear();
                    for p in part {
                        from.extend_from_slice(&out[p[0] as usize]);
                    }
                    to.resize(from.len(), 0.0);
                    multiply(&self.expansion.across[offset], &from, &mut to);
                    for (p, values) in part.iter().zip(to.chunks_exact(POINTS * LANES)) {
                        come[p[1] as usize - first].iter_mut().zip(values).for_each(|(a, b)| *a += b);
                    }
                }
            }
        });
    }
}

/// Boxes with something of their own.
fn leaves(side: &Side) -> Vec<(usize, usize)> {
    let all = side.levels.iter().enumerate();
    all.flat_map(|(level, boxes)| (0..boxes.own.len()).map(move |k| (level, k)))
        .filter(|(level, k)| !side.levels[*level].own[*k].is_empty())
        .collect()
}

/// Boxes multiplied together.
const BATCH: usize = 32;
/// Stretches of a level's boxes at most: enough for as many threads as there may be.
const STRETCHES: usize = 64;

/// Boxes of a level in an octant of the boxes around them: (child, parent).
fn family(side: &Side, level: usize, octant: usize) -> Vec<[usize; 2]> {
    let cells = side.levels[level].cells.iter().enumerate();
    cells
        .filter(|(_, c)| (0..3).all(|a| (c[a] & 1) as usize == octant >> a & 1))
        .filter_map(|(child, c)| Some([child, side.levels[level - 1].find(c.map(|x| x >> 1))?]))
        .collect()
}

/// From children to the boxes around them, or back.
fn step(
    matrices: &[Mat<f32>],
    from: &Potentials,
    to: &mut Potentials,
    links: &dyn Fn(usize) -> Vec<[usize; 2]>,
    is_up: bool,
) {
    let (mut gathered, mut moved) = (Vec::new(), Vec::new());
    for (octant, matrix) in matrices.iter().enumerate() {
        for part in links(octant).chunks(BATCH) {
            let ends = |l: &[usize; 2]| if is_up { (l[0], l[1]) } else { (l[1], l[0]) };
            gathered.clear();
            for l in part {
                gathered.extend_from_slice(&from[ends(l).0]);
            }
            moved.resize(gathered.len(), 0.0);
            multiply(matrix, &gathered, &mut moved);
            for (l, values) in part.iter().zip(moved.chunks_exact(POINTS * LANES)) {
                to[ends(l).1].iter_mut().zip(values).for_each(|(a, b)| *a += b);
            }
        }
    }
}

/// A matrix of a box on many columns, stored one behind the other.
fn multiply(matrix: &Mat<f32>, from: &[f32], to: &mut [f32]) {
    let columns = from.len() / POINTS;
    let from = MatRef::from_column_major_slice(from, POINTS, columns);
    let to = MatMut::from_column_major_slice_mut(to, POINTS, columns);
    matmul(to, Accum::Replace, matrix.as_ref(), from, 1.0, Par::Seq);
}

/// A product, column by column.
fn product(matrix: &Mat<f32>, right: MatRef<'_, f32>) -> Vec<f32> {
    let mut out = vec![0.0; matrix.nrows() * right.ncols()];
    let to = MatMut::from_column_major_slice_mut(&mut out, matrix.nrows(), right.ncols());
    matmul(to, Accum::Replace, matrix.as_ref(), right, 1.0, Par::Seq);
    out
}

impl Block {
    /// K φ at the block's points, `LANES × points`.
    fn apply(&self, strengths: &[Lane]) -> Vec<f64> {
        let mut sums = vec![0.0; LANES * self.targets.len()];
        let gathered: Vec<Lane> = self.sources.iter().map(|s| strengths[*s as usize]).collect();
        accumulate(&self.values, &gathered, &mut sums);
        sums
    }
}

/// Solves for all motions.
#[must_use]
pub fn solve(problem: &Problem) -> Solution {
    let layout = Layout::new(problem);
    let n = problem.facets.len();
    let columns = problem.columns();
    let points: Vec<Vec3> = problem.facets.iter().map(|f| f.centroid).collect();
    let area: f64 = problem.facets.iter().map(|f| f.area).sum();
    let mut potentials = vec![vec![0.0; columns]; n];
    let mut report = Report {
        unknowns: n,
        near_pairs: layout.cost.near_pairs,
        far_pairs: layout.cost.far_pairs,
        ..Report::default()
    };
    for first in (0..columns).step_by(LANES) {
        let lanes = |f: &dyn Fn(usize) -> f64| -> Lane {
            core::array::from_fn(|l| if first + l < columns { f(first + l) } else { 0.0 })
        };
        let velocities: Vec<Lane> = (0..n).map(|p| lanes(&|c| problem.velocity(p, c))).collect();
        let images = 1_usize << problem.mirrors.len();
        let signs: Vec<Lane> = (0..images).map(|set| lanes(&|c| problem.signs(c)[set])).collect();
        let is_even: [bool; LANES] = core::array::from_fn(|l| signs.iter().all(|s| s[l] > 0.0));
        let (operator, right) = Operator::new(&layout, &points, &velocities, signs);
        let apply = |x: &[Lane]| -> Vec<Lane> {
            let mut out = operator.apply(x);
            // As in the plain solver: a constant is fixed where no mirror turns its sign.
            let mut mean = [0.0; LANES];
            if problem.is_enclosed {
                for (x, f) in x.iter().zip(&problem.facets) {
                    (0..LANES).filter(|l| is_even[*l]).for_each(|l| mean[l] += x[l] * f.area / area);
                }
            }
            for (out, x) in out.iter_mut().zip(x) {
                (0..LANES).for_each(|l| out[l] = 0.5 * x[l] - out[l] + mean[l]);
            }
            out
        };
        let (phi, ended) = gmres::solve(apply, &right, TOLERANCE, LIMIT);
        report.iterations = report.iterations.max(ended.iterations);
        report.residual = report.residual.max(ended.residual);
        for (to, phi) in potentials.iter_mut().zip(&phi) {
            let count = LANES.min(columns - first);
            to[first..first + count].copy_from_slice(&phi[..count]);
        }
    }
    problem.solution(potentials, report)
}
