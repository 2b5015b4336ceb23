//! How often the numerical uncertainty holds, and how generous it is: random bodies against closed forms, the solver for bodies of revolution,
//! or meshes twice as fine.
//!
//! `coverage [--short] [--tuning] [--bodies N] [--raw FILE]`: 1,000 bodies, 40 with `--short`. The factors of `froude_panel::convergence`
//! were chosen on the seeds of `--tuning`; the seeds without it judge. Fails when an entry of a class is covered less often than 95 % or
//! its U is, at the median, more than 3 times the error (10 for the extrapolated value). The short run has too few bodies for that: it fails
//! when less than 90 % of all entries are covered.
//!
//! Levels 4, 6, 8; 4 panels around for each (8 where the section is flatter than 2:1). Errors are normalised by ρV, ρV L/2, ρV L²/4.
//! **Found**, 1,000 bodies, seed 20,261: no row missed; covered 98.8 to 100 % (finest) and 96.2 to 100 % (extrapolated), U over the error 1.4 to
//! 2.4 and 4.0 to 7.0. By the rule first asked for five rows of the near-sphere class miss: A11 94 % and 90 %, A55 94 %, A66 95.2 % and 94.9 %, and
//! U of the couplings is 4.3 and 4.4 times the error. Seed 20,260 judged first, with a lower bound of ⅔ |x₂₁ − x₃₂|: A66 of that class had 93.7 %. The
//! bound was raised on the tuning bodies, and a new seed judged.
//!
//! The roll of a body of revolution and couplings of a body with a middle plane are zero by symmetry: they are no entries here.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod bodies;
mod exact;

use std::collections::BTreeMap;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use bodies::{Body, Class, Random, Reference};
use froude_mesh::measure::Measure;
use froude_mesh::sections::Resolution;
use froude_panel::convergence::{Converged, Estimate, converged};
use froude_panel::mirror::positive_part;
use froude_panel::problem::{Problem, Solution};
use froude_panel::study::{Size, study};
use froude_panel::{dense, fast, revolution};
use rayon::prelude::*;

const LEVELS: [usize; 3] = [4, 6, 8];
/// Of the reference: twice as fine.
const REFERENCE: [usize; 2] = [12, 16];
const ENTRIES: [(usize, usize); 8] = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (1, 5), (2, 4)];
/// Entries below this part of ρV L²/4 are zero by symmetry.
const ZERO: f64 = 1e-9;
/// Unknowns from which the fast solver is quicker with four and eight images.
const FAST: usize = 200;

const COVERED: f64 = 0.95;
/// Largest median of U over the error: of the finest value, of the extrapolated one.
const GENEROUS: [f64; 2] = [3.0, 10.0];
const SHORT_COVERED: f64 = 0.9;

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
            for (i, a) in exact::ellipsoid(*axes).into_iter().enumerate() {
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
struct Row {
    class: Class,
    kind: &'static str,
    entry: (usize, usize),
    values: [f64; 3],
    exact: f64,
    /// The last two by the rule that was asked for first.
    estimates: [Estimate; 6],
}

/// The rule that was asked for first: outside orders of 1.5 to 2.5 the finest value is taken for both, with three times its distance from the
/// others; inside, 1.5 times what extrapolation takes off, and 3 times the change of the extrapolated value.
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

fn rows(class: Class, body: &Body) -> Vec<Row> {
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
fn summary(rows: &[&Row], which: usize) -> [f64; 3] {
    let errors: Vec<f64> = rows.iter().map(|r| (r.estimates[which].value - r.exact).abs()).collect();
    let held = rows.iter().filter(|r| r.estimates[which].holds(r.exact)).count();
    let mut ratios: Vec<f64> =
        rows.iter().zip(&errors).map(|(r, e)| r.estimates[which].uncertainty / e.max(f64::MIN_POSITIVE)).collect();
    let mut errors = errors;
    ratios.sort_by(f64::total_cmp);
    errors.sort_by(f64::total_cmp);
    [held as f64 / rows.len() as f64, ratios[rows.len() / 2], errors[rows.len() / 2]]
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|a| a == name);
    let after = |name: &str| arguments.iter().position(|a| a == name).and_then(|i| arguments.get(i + 1));
    let is_short = has("--short");
    let count = after("--bodies").map_or(if is_short { 40 } else { 1000 }, |n| n.parse().unwrap());
    let seed = if has("--tuning") { 301 } else { 20_261 };
    let started = Instant::now();
    let mut random = Random(seed);
    let cases: Vec<(Class, Body)> = (0..count)
        .map(|k| {
            let class = Class::ALL[k % 3];
            (class, bodies::body(class, k / 3, &mut random))
        })
        .collect();
    let rows: Vec<Row> = cases.par_iter().flat_map_iter(|(class, body)| rows(*class, body)).collect();
    if let Some(file) = after("--raw") {
        let mut file = std::fs::File::create(file).unwrap();
        for r in &rows {
            let [a, b, c] = r.values;
            let (i, j) = r.entry;
            writeln!(file, "{} {} {i}{j} {a:e} {b:e} {c:e} {:e}", r.class.name(), r.kind.replace(' ', "_"), r.exact)
                .unwrap();
        }
    }
    let mut cells: BTreeMap<(usize, (usize, usize)), Vec<&Row>> = BTreeMap::new();
    for row in &rows {
        let class = Class::ALL.iter().position(|c| *c == row.class).unwrap();
        cells.entry((class, row.entry)).or_default().push(row);
    }
    println!(
        "| class | entry | bodies | finest: covered | U/error | error | extrapolated: covered | U/error | error |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut misses = 0;
    let mut misses_as_asked = 0;
    for ((class, (i, j)), rows) in &cells {
        let both = [0, 1].map(|which| summary(rows, which));
        let text = |s: &[f64; 3]| format!("{:.1} % | {:.2} | {:.1e}", 100.0 * s[0], s[1], s[2]);
        let name = Class::ALL[*class].name();
        let misses_one =
            |both: &[[f64; 3]; 2]| both.iter().zip(GENEROUS).any(|(s, most)| s[0] < COVERED || s[1] > most);
        let is_missed = misses_one(&both);
        misses += usize::from(is_missed);
        misses_as_asked += usize::from(misses_one(&[4, 5].map(|which| summary(rows, which))));
        println!(
            "| {name} | A{}{} | {} | {} | {} |{}",
            i + 1,
            j + 1,
            rows.len(),
            text(&both[0]),
            text(&both[1]),
            if is_missed { " missed" } else { "" }
        );
    }
    let all: Vec<&Row> = rows.iter().collect();
    let names = [
        "finest",
        "extrapolated",
        "finest of two meshes",
        "extrapolated from two meshes",
        "finest, by the rule first asked for",
        "extrapolated, by the rule first asked for",
    ];
    for (which, name) in names.iter().enumerate() {
        let [covered, ratio, error] = summary(&all, which);
        println!("{name}: {:.1} % of {} entries, U/error {ratio:.2}, error {error:.1e}", 100.0 * covered, all.len());
    }
    let kinds: std::collections::BTreeSet<&str> = rows.iter().map(|r| r.kind).collect();
    for kind in kinds {
        let of: Vec<&Row> = rows.iter().filter(|r| r.kind == kind).collect();
        let [a, b] = [0, 1].map(|which| 100.0 * summary(&of, which)[0]);
        println!("{kind}: {a:.1} %, {b:.1} % of {} entries", of.len());
    }
    println!(
        "{count} bodies, seed {seed}: {:.1} s, {misses} of {} rows missed, {misses_as_asked} by the rule first asked for",
        started.elapsed().as_secs_f64(),
        cells.len()
    );
    let fails = if is_short { is_seldom_covered(&all) } else { misses > 0 };
    if fails { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Whether fewer entries than the short run asks for are covered.
fn is_seldom_covered(all: &[&Row]) -> bool {
    (0..2).any(|which| summary(all, which)[0] < SHORT_COVERED)
}
