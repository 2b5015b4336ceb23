//! The count itself: random bodies solved on three similar meshes, their entries beside references, how often the uncertainty holds.

use std::collections::BTreeMap;

use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_mesh::measure::Measure;
use froude_mesh::sections::Resolution;
use froude_panel::convergence::{Converged, Estimate, converged};
use froude_panel::mirror::positive_part;
use froude_panel::problem::{Problem, Solution};
use froude_panel::study::{Size, study};
use froude_panel::{dense, fast, revolution};
use rayon::prelude::*;

use crate::bodies::{Body, Class, Random, Reference, body};

const LEVELS: [usize; 3] = [4, 6, 8];
/// Of the reference: twice as fine.
const REFERENCE: [usize; 2] = [12, 16];
const ENTRIES: [(usize, usize); 8] = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (1, 5), (2, 4)];
/// Entries below this part of ρV L²/4 are zero by symmetry.
const ZERO: f64 = 1e-9;
/// Unknowns from which the fast solver is quicker with four and eight images.
const FAST: usize = 200;

pub const COVERED: f64 = 0.95;
/// Largest median of U over the error: of the finest value, of the extrapolated one.
pub const GENEROUS: [f64; 2] = [3.0, 4.0];
pub const SHORT_COVERED: f64 = 0.9;

fn solve(body: &Body, level: usize) -> (Solution, Size) {
    let mesh = body.shape.mesh(Resolution { along: level, around: body.around * level }).unwrap().mesh;
    let x = mesh.vertices.iter().map(|v| v[0]);
    let [low, high] = x.fold([f64::MAX, f64::MIN], |[l, h], x| [l.min(x), h.max(x)]);
    let size = Size { volume_m3: Measure::of(&mesh).volume_m3, length_m: high - low };
    let problem = Problem::rigid(&positive_part(&mesh, &body.planes).unwrap(), &body.planes);
    let solution = if problem.facets.len() < FAST { dense::solve(&problem) } else { fast::solve(&problem) };
    (solution, size)
}

fn reference(body: &Body) -> [[f64; 6]; 6] {
    let mut out = [[0.0; 6]; 6];
    match &body.reference {
        Reference::Ellipsoid(axes) => {
            for (i, a) in ellipsoid_added_mass(*axes).unwrap().into_iter().enumerate() {
                out[i][i] = a;
            }
        }
        Reference::Revolution(meridian) => {
            let r = revolution::solve(meridian);
            for (i, a) in
                [r.axial_m3, r.transverse_m3, r.transverse_m3, 0.0, r.rotary_m5, r.rotary_m5].iter().enumerate()
            {
                out[i][i] = *a;
            }
            // The axis there is z, here x.
            (out[1][5], out[2][4]) = (r.coupling_m4, -r.coupling_m4);
        }
        Reference::Finer => {
            let [coarse, fine] = REFERENCE.map(|m| solve(body, m).0.added_mass(0).matrix);
            let sizes = REFERENCE.map(|m| 1.0 / m as f64);
            for i in 0..6 {
                for j in 0..6 {
                    out[i][j] = converged(&sizes, &[coarse[i][j], fine[i][j]], 0.0).extrapolated.value;
                }
            }
        }
    }
    out
}

/// An entry of a body: finest value, extrapolated one, and both from the two finest meshes alone; normalised.
pub struct Row {
    /// Which of the bodies.
    pub body: usize,
    pub class: Class,
    pub kind: &'static str,
    pub entry: (usize, usize),
    pub values: [f64; 3],
    pub exact: f64,
    /// The last two by the rule that was asked for first.
    estimates: [Estimate; 6],
}

/// The rule that was asked for first: outside orders of 1.5 to 2.5 the finest value is taken for both, with three times its distance from the
/// others; inside, 1.5 times what extrapolation subtracts, and 3 times the change of the extrapolated value.
fn asked(values: [f64; 3], now: &Converged) -> [Estimate; 2] {
    let [f3, f2, f1] = values;
    if now.order.is_some_and(|p| (1.5..=2.5).contains(&p)) {
        let limit = |fine: usize, coarse: usize| {
            let q = LEVELS[fine] as f64 / LEVELS[coarse] as f64;
            values[fine] + (values[fine] - values[coarse]) / (q * q - 1.0)
        };
        let (finer, coarser) = (limit(2, 1), limit(1, 0));
        let estimate = |value, uncertainty| Estimate { value, uncertainty };
        [estimate(f1, 1.5 * (f1 - finer).abs()), estimate(finer, 3.0 * (finer - coarser).abs())]
    } else {
        [Estimate { value: f1, uncertainty: 3.0 * (f1 - f2).abs().max((f1 - f3).abs()) }; 2]
    }
}

fn rows(number: usize, class: Class, body: &Body) -> Vec<Row> {
    let solved = LEVELS.map(|m| solve(body, m));
    let size = solved[2].1;
    let solutions = solved.map(|s| s.0);
    let sizes = LEVELS.map(|m| 1.0 / m as f64);
    let (three, two) = (study(&sizes, &solutions, size), study(&sizes[1..], &solutions[1..], size));
    let reference = reference(body);
    let of = |entry: (usize, usize)| {
        let (i, j) = entry;
        let reach = |i: usize| if i < 3 { 1.0 } else { 0.5 * size.length_m };
        let unit = size.volume_m3 * reach(i) * reach(j);
        let scaled = |e: Estimate| Estimate { value: e.value / unit, uncertainty: e.uncertainty / unit };
        let [a, b] = [three.entries[i][j], two.entries[i][j]];
        let values = [0, 1, 2].map(|l| solutions[l].added_mass(0).matrix[i][j]);
        let [fine, extrapolated] = asked(values, &a);
        Row {
            body: number,
            class,
            kind: body.kind,
            entry,
            values: values.map(|v| v / unit),
            exact: reference[i][j] / unit,
            estimates: [a.fine, a.extrapolated, b.fine, b.extrapolated, fine, extrapolated].map(scaled),
        }
    };
    ENTRIES.into_iter().map(of).filter(|r| r.exact.abs() > ZERO).collect()
}

/// Part covered, median of U over the error, median error.
pub fn summary(rows: &[&Row], which: usize) -> [f64; 3] {
    let errors: Vec<f64> = rows.iter().map(|r| (r.estimates[which].value - r.exact).abs()).collect();
    let held = rows.iter().filter(|r| r.estimates[which].holds(r.exact)).count();
    let mut ratios: Vec<f64> =
        rows.iter().zip(&errors).map(|(r, e)| r.estimates[which].uncertainty / e.max(f64::MIN_POSITIVE)).collect();
    let mut errors = errors;
    ratios.sort_by(f64::total_cmp);
    errors.sort_by(f64::total_cmp);
    [held as f64 / rows.len() as f64, ratios[rows.len() / 2], errors[rows.len() / 2]]
}

/// Seeds that the rule's factors were chosen on, and the one that judges.
pub const SEEDS: [u64; 2] = [301, 20_261];

/// Rows of random bodies.
pub fn run(count: usize, seed: u64) -> Vec<Row> {
    let mut random = Random(seed);
    let cases: Vec<(Class, Body)> = (0..count)
        .map(|k| {
            let class = Class::ALL[k % 3];
            (class, body(class, k / 3, &mut random))
        })
        .collect();
    cases.par_iter().enumerate().flat_map_iter(|(number, (class, body))| rows(number, *class, body)).collect()
}

/// Rows by class and entry.
pub fn cells(rows: &[Row]) -> BTreeMap<(usize, (usize, usize)), Vec<&Row>> {
    let mut out: BTreeMap<_, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        let class = Class::ALL.iter().position(|c| *c == row.class).unwrap();
        out.entry((class, row.entry)).or_default().push(row);
    }
    out
}

/// Bodies, and the part of them whose extrapolated entries are all covered.
pub fn whole(rows: &[&Row]) -> (usize, f64) {
    let mut bodies: BTreeMap<usize, bool> = BTreeMap::new();
    for row in rows {
        *bodies.entry(row.body).or_insert(true) &= row.estimates[1].holds(row.exact);
    }
    (bodies.len(), bodies.values().filter(|held| **held).count() as f64 / bodies.len() as f64)
}

/// Whether a class's entry is covered too seldom, or its uncertainty too generous.
pub fn is_missed(both: &[[f64; 3]; 2]) -> bool {
    both.iter().zip(GENEROUS).any(|(s, most)| s[0] < COVERED || s[1] > most)
}
