//! Tessellations at the verb: how often the interval of the record contains the body that is meant.

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use froude::hydro::ellipsoid::ellipsoid_added_mass;
use froude::mesh::files::write_obj;
use froude::mesh::measure::Measure;
use froude::mesh::refine::subdivided;
use froude::mesh::{Mesh, Panel};
use froude::methods::added_mass::body::body;
use froude::methods::added_mass::options::{Apart, Asked};
use froude::methods::added_mass::several::several;
use froude::methods::added_mass::water::Water;
use froude::panel::mirror::{Mirror, positive_part};
use froude::panel::problem::Problem;
use froude::panel::refine::Wanted;
use froude::records::estimate::Estimate;
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::tessellations::{Intended, KINDS};

/// Tessellations of ellipsoids, and as many of other bodies.
const BODIES: u64 = 200;
/// Segments around are fewer than this.
const MOST_AROUND: usize = 24;
const ROOM: &str = "Added mass from potential flow: facets of meshes from elsewhere";
/// Tolerance of the panels.
const TOLERANCE: f64 = 0.05;
/// Distance of the second body with `--apart`, in reaches of the first: its effect falls with the cube.
const FAR: f64 = 30.0;
/// One body of so many is computed with `--apart` too.
const APART: u64 = 2;
/// Entries counted at least, per cent.
const COVERED: f64 = 95.0;

/// Bodies counted at least with all entries at once, per cent.
const WHOLE: f64 = 90.0;

/// One entry of the diagonal, or the displaced water, over ρ.
struct Entry {
    exact: f64,
    /// Of the record.
    value: f64,
    expanded: f64,
}

impl Entry {
    fn holds(&self) -> bool {
        // A volume may lie at the end of its interval, but for rounding.
        (self.value - self.exact).abs() <= self.expanded + 1e-9 * self.exact.abs()
    }
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

/// An octahedron on the sphere, divided so many times.
fn divided(times: usize) -> Mesh {
    let vertices =
        vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let corners = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mut mesh = Mesh { vertices, panels: corners.map(|[a, b, c]| Panel::triangle(a, b, c)).to_vec() };
    for _ in 0..times {
        mesh = subdivided(&mesh);
        mesh.vertices = mesh.vertices.iter().map(|v| unit(*v)).collect();
    }
    mesh
}

/// Rings of a sphere about x, as drawing programs export it: triangles, or quadrilaterals between triangles at the poles.
fn rings(around: usize, along: usize, is_quads: bool) -> Mesh {
    let mut vertices = vec![[1.0, 0.0, 0.0]];
    for i in 1..along {
        let (sin, cos) = (PI * i as f64 / along as f64).sin_cos();
        for k in 0..around {
            let turn = 2.0 * PI * k as f64 / around as f64;
            vertices.push([cos, sin * turn.cos(), sin * turn.sin()]);
        }
    }
    vertices.push([-1.0, 0.0, 0.0]);
    let at = |ring: usize, k: usize| (1 + (ring - 1) * around + k % around) as u32;
    let last = vertices.len() as u32 - 1;
    let mut panels = Vec::new();
    for k in 0..around {
        panels.push(Panel::triangle(0, at(1, k), at(1, k + 1)));
        panels.push(Panel::triangle(last, at(along - 1, k + 1), at(along - 1, k)));
        for i in 1..along - 1 {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            if is_quads {
                panels.push(Panel::quad(a, b, c, d));
            } else {
                panels.extend([Panel::triangle(a, b, c), Panel::triangle(a, c, d)]);
            }
        }
    }
    Mesh { vertices, panels }
}

/// A tessellation of one of four kinds, stretched to an ellipsoid with these semi-axes.
fn tessellation(rng: &mut Pcg64, number: u64) -> (Mesh, [f64; 3]) {
    let around = rng.random_range(8..MOST_AROUND);
    let along = (rng.random_range(around / 2..around + around / 2)).max(5);
    let times = 2 + usize::from(number / 4 % 2 == 1);
    let mut mesh = match number % 4 {
        0 => divided(times),
        1 => rings(around, along, false),
        2 => rings(around, along, true),
        _ => {
            // Corners that lie anywhere.
            let mut mesh = divided(times);
            let reach = 0.25 * (4.0 * PI / mesh.vertices.len() as f64).sqrt();
            mesh.vertices =
                mesh.vertices.iter().map(|v| unit(v.map(|x| x + reach * rng.random_range(-1.0..1.0)))).collect();
            mesh
        }
    };
    let axes = [5.0_f64.powf(rng.random_range(0.0..1.0)), 1.0, rng.random_range(0.5..1.0)];
    mesh.vertices = mesh.vertices.iter().map(|v| [v[0] * axes[0], v[1] * axes[1], v[2] * axes[2]]).collect();
    (mesh, axes)
}

/// A file of a mesh, and what is asked of it.
fn job(folder: &Path, mesh: &Mesh) -> Result<Asked, String> {
    let path = folder.join("body.obj");
    std::fs::write(&path, write_obj(mesh)).map_err(|e| e.to_string())?;
    Ok(Asked {
        density_kg_m3: Some(1.0),
        unit_m: Some(1.0),
        wanted: Wanted { tolerance: TOLERANCE, ..Wanted::default() },
        ..Asked::of(&path)
    })
}

/// The diagonal of a record beside the exact one; `part` is that of several.
fn diagonal(record: &Estimate, part: &str, exact: &[f64]) -> Result<Vec<Entry>, String> {
    let one = |(i, exact): (usize, &f64)| {
        let [low, high] = record.coefficients[&format!("A{0}{0}{part}", i + 1)].interval_95.ok_or("no interval")?;
        Ok(Entry { exact: *exact, value: 0.5 * (low + high), expanded: 0.5 * (high - low) })
    };
    exact.iter().take(6).enumerate().map(one).collect()
}

/// The record of a mesh: the diagonal and the displaced water.
fn alone(mesh: &Mesh, exact: &[f64; 7], is_smooth: bool) -> Result<Vec<Entry>, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let job = Asked { is_smooth, ..job(folder.path(), mesh)? };
    let found = body(&job, &Water::default(), "", &|_| {}).map_err(|e| e.to_string())?;
    let mut out = diagonal(&found.estimates[0], "", exact)?;
    let volume = found.cases[0].refined.volume_m3;
    // A body of flat sides has its volume to rounding.
    let [low, high] = found.estimates[0].derived.get("volume").and_then(|d| d.interval_95).unwrap_or([volume; 2]);
    out.push(Entry { exact: exact[6], value: volume, expanded: (0.5 * (high - low)).max(1e-9 * volume) });
    Ok(out)
}

/// The same of the mesh and another like it, so far away that neither feels the other; each about its centre of buoyancy.
fn with_another(mesh: &Mesh, exact: &[f64; 7]) -> Result<Vec<Entry>, String> {
    let centre = Measure::of(mesh).centroid_m;
    let reach = mesh.vertices.iter().flatten().fold(0.0_f64, |far, x| far.max(x.abs()));
    let mut both = mesh.mapped(|v| core::array::from_fn(|k| v[k] - centre[k]));
    let count = both.vertices.len() as u32;
    let other: Vec<[f64; 3]> = both.vertices.iter().map(|[x, y, z]| [*x, *y, z + FAR * reach]).collect();
    let moved = both.panels.iter().map(|panel| match *panel.corners() {
        [a, b, c] => Panel::triangle(a + count, b + count, c + count),
        [a, b, c, d] => Panel::quad(a + count, b + count, c + count, d + count),
        _ => *panel,
    });
    let moved: Vec<Panel> = moved.collect();
    both.vertices.extend(other);
    both.panels.extend(moved);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let found = several(&job(folder.path(), &both)?, Apart::Parts, &Water::default(), "", &|_| {})
        .map_err(|e| e.to_string())?;
    diagonal(&found.estimate, "_1_1", exact)
}

/// Panels of the finest tessellation of a body that is meant, at most; its mirrored parts count once.
const FINEST: usize = 4000;

/// Diagonal and volume of the body that is meant, about a point: tessellations of it, each with cells of half the size, the last three extrapolated
/// by the order that they show. Edges of a body lower the order to one, and moments of coarse meshes are not yet on their way to the limit.
fn reference(intended: &Intended, about: [f64; 3]) -> [f64; 7] {
    let mirrors: Vec<Mirror> = intended.planes().into_iter().map(Mirror::body).collect();
    let mut found: Vec<[f64; 7]> = Vec::new();
    for finer in (0..).map(|k| 1 << k) {
        let mesh = intended.mesh(finer).mapped(|v| core::array::from_fn(|k| v[k] - about[k]));
        let problem = match positive_part(&mesh, &mirrors) {
            Ok(part) => Problem::rigid(&part, &mirrors),
            Err(_) => Problem::rigid(&mesh, &[]),
        };
        let matrix = froude::panel::solve(&problem).matrix;
        let volume = Measure::of(&mesh).volume_m3;
        found.push(core::array::from_fn(|i| if i < 6 { matrix[i][i] } else { volume }));
        if found.len() > 2 && 4 * problem.facets.len() > FINEST {
            break;
        }
    }
    let [coarse, middle, fine] = core::array::from_fn(|k| found[found.len() - 3 + k]);
    core::array::from_fn(|i| {
        let [before, last] = [middle[i] - coarse[i], fine[i] - middle[i]];
        let order = (before / last).abs().log2().clamp(1.0, 2.0);
        // A difference of rounding has no order.
        if order.is_finite() { fine[i] + last / (order.exp2() - 1.0) } else { fine[i] }
    })
}

/// Entries alone, of half of the bodies with `--apart` too, of ellipsoids with `--smooth` too.
struct Body {
    kind: usize,
    alone: Vec<Entry>,
    apart: Vec<Entry>,
    smooth: Vec<Entry>,
}

fn ellipsoid(number: u64) -> Result<Body, String> {
    let (mesh, axes) = tessellation(&mut Pcg64::new(u128::from(number), 2200), number);
    let volume = 4.0 / 3.0 * PI * axes.iter().product::<f64>();
    let added = ellipsoid_added_mass(axes).map_err(|e| e.to_string())?;
    let exact = core::array::from_fn(|i| if i < 6 { added[i] } else { volume });
    let of = |e: String| format!("ellipsoid {number}: {e}");
    let apart = if (number / 4).is_multiple_of(APART) { with_another(&mesh, &exact).map_err(of)? } else { Vec::new() };
    let smooth = alone(&mesh, &exact, true).map_err(of)?;
    Ok(Body { kind: KINDS.len(), alone: alone(&mesh, &exact, false).map_err(of)?, apart, smooth })
}

fn other(number: u64) -> Result<Body, String> {
    let kind = number as usize % KINDS.len();
    let intended = Intended::random(&mut Pcg64::new(u128::from(number), 4200), kind);
    let mesh = intended.mesh(1);
    let centre = Measure::of(&mesh).centroid_m;
    let mesh = mesh.mapped(|v| core::array::from_fn(|k| v[k] - centre[k]));
    let exact = reference(&intended, centre);
    let of = |e: String| format!("{} {number}: {e}", KINDS[kind]);
    let apart = if (number / 6).is_multiple_of(APART) { with_another(&mesh, &exact).map_err(of)? } else { Vec::new() };
    Ok(Body { kind, alone: alone(&mesh, &exact, false).map_err(of)?, apart, smooth: Vec::new() })
}

/// Per cent of entries, and of bodies with all entries at once.
fn covered(bodies: &[&Vec<Entry>]) -> [f64; 2] {
    let bodies: Vec<_> = bodies.iter().filter(|body| !body.is_empty()).collect();
    let percent = |k: usize, of: usize| 100.0 * k as f64 / of as f64;
    let all = || bodies.iter().copied().copied().flatten();
    let whole = bodies.iter().filter(|body| body.iter().all(Entry::holds)).count();
    [percent(all().filter(|e| e.holds()).count(), all().count()), percent(whole, bodies.len())]
}

/// Adds all rows of this section.
pub fn facets(claims: &mut Claims) -> Result<(), Box<dyn Error>> {
    let bodies = (0..2 * BODIES)
        .into_par_iter()
        .map(|k| if k < BODIES { ellipsoid(k) } else { other(k - BODIES) })
        .collect::<Result<Vec<_>, String>>()?;
    let mut add = |name: &str, of: Vec<&Vec<Entry>>, is_claim: bool| {
        let [entries, whole] = covered(&of);
        let mut ratios: Vec<f64> = of
            .iter()
            .copied()
            .flatten()
            .map(|e| (e.value - e.exact).abs() / e.expanded)
            .filter(|r| r.is_finite())
            .collect();
        ratios.sort_by(f64::total_cmp);
        let [median, largest] =
            [ratios.len() / 2, ratios.len().saturating_sub(1)].map(|k| ratios.get(k).copied().unwrap_or(0.0));
        claims.add(
            ROOM,
            &format!("{name}: the record's interval contains the body that is meant"),
            &format!("{COVERED} % of the entries of the diagonal and the volume, all of a body at once in {WHOLE} % of the bodies"),
            format!("{entries:.1} %, {whole:.1} % of {} bodies; |error|/U at the median {median:.2}, at most {largest:.2}", of.iter().filter(|b| !b.is_empty()).count()),
            match (is_claim, entries >= COVERED && whole >= WHOLE) {
                (false, _) => Verdict::Measured,
                (true, true) => Verdict::Pass,
                (true, false) => Verdict::Miss,
            },
        );
    };
    let (ellipsoids, others) = bodies.split_at(BODIES as usize);
    let what =
        format!("{BODIES} tessellations of ellipsoids, 8 to {MOST_AROUND} segments around or 128 to 512 triangles");
    add(&what, ellipsoids.iter().map(|b| &b.alone).collect(), true);
    add("those of ellipsoids with --apart", ellipsoids.iter().map(|b| &b.apart).collect(), true);
    add("those of ellipsoids with --smooth", ellipsoids.iter().map(|b| &b.smooth).collect(), false);
    let what = format!("{BODIES} tessellations of cones, cone-cylinders, ogives, plates, prisms, finned hulls");
    add(&what, others.iter().map(|b| &b.alone).collect(), true);
    add("those with --apart", others.iter().map(|b| &b.apart).collect(), true);
    for (kind, name) in KINDS.iter().enumerate() {
        add(name, others.iter().filter(|b| b.kind == kind).map(|b| &b.alone).collect(), false);
    }
    Ok(())
}
