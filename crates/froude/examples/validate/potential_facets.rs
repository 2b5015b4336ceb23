//! Tessellations of smooth bodies at the verb: how often the interval of the record holds the smooth body.

use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write as _;

use froude::hydro::ellipsoid::ellipsoid_added_mass;
use froude::mesh::refine::subdivided;
use froude::mesh::{Mesh, Panel};
use froude::methods::added_mass::body::body;
use froude::methods::added_mass::options::Asked;
use froude::methods::added_mass::water::Water;
use froude::panel::refine::Wanted;
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};

const ROOM: &str = "Added mass from potential flow: facets of meshes from elsewhere";
/// Entries counted at least, per cent.
const COVERED: f64 = 95.0;

/// One entry of a tessellated ellipsoid, over ρ.
struct Entry {
    exact: f64,
    /// Of the record.
    value: f64,
    expanded: f64,
    /// The same without what facets change: the polyhedron with the uncertainty of its panels.
    polyhedron: [f64; 2],
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
fn tessellation(rng: &mut Pcg64, number: u64, largest: usize) -> (Mesh, [f64; 3]) {
    let around = rng.random_range(8..largest);
    let along = (rng.random_range(around / 2..around + around / 2)).max(5);
    let times = 2 + usize::from(largest > 16 && number / 4 % 2 == 1);
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

fn entries(number: u64, largest: usize) -> Result<Vec<Entry>, String> {
    let (mesh, axes) = tessellation(&mut Pcg64::new(u128::from(number), 2200), number, largest);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let path = folder.path().join("body.obj");
    let mut text = String::new();
    for [x, y, z] in &mesh.vertices {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for panel in &mesh.panels {
        let corners: Vec<String> = panel.corners().iter().map(|c| (c + 1).to_string()).collect();
        let _ = writeln!(text, "f {}", corners.join(" "));
    }
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    let job = Asked {
        density_kg_m3: Some(1.0),
        unit_m: Some(1.0),
        wanted: Wanted { tolerance: 0.05, ..Wanted::default() },
        ..Asked::of(&path)
    };
    let found = body(&job, &Water::default(), "", &|_| {}).map_err(|e| format!("{number}: {e}"))?;
    let exact = ellipsoid_added_mass(axes).map_err(|e| e.to_string())?;
    let (record, case) = (&found.estimates[0], &found.cases[0]);
    let facets = case.facets.as_ref().ok_or_else(|| format!("{number}: no facets"))?;
    (0..6)
        .map(|i| {
            let name = format!("A{0}{0}", i + 1);
            let c = &record.coefficients[&name];
            let [low, high] = c.interval_95.ok_or("no interval")?;
            let of_panels = (case.refined.uncertainty[i][i].powi(2) - facets.uncertainty[i][i].powi(2)).max(0.0).sqrt();
            Ok(Entry {
                exact: exact[i],
                value: 0.5 * (low + high),
                expanded: 0.5 * (high - low),
                polyhedron: [case.refined.value[i][i] - facets.correction[i][i], of_panels],
            })
        })
        .collect()
}

/// So many tessellations of ellipsoids.
pub fn facets(claims: &mut Claims, full: bool) -> Result<(), Box<dyn Error>> {
    let (count, largest) = if full { (200, 24) } else { (8, 12) };
    let bodies = (0..count).into_par_iter().map(|k| entries(k, largest)).collect::<Result<Vec<_>, String>>()?;
    let all = || bodies.iter().flatten();
    let n = all().count() as f64;
    let percent = |k: usize, of: f64| 100.0 * k as f64 / of;
    let holds = |e: &&Entry| (e.value - e.exact).abs() <= e.expanded;
    let covered = percent(all().filter(holds).count(), n);
    let whole = bodies.iter().filter(|body| body.iter().all(|e| holds(&e))).count();
    let of_polyhedron = all().filter(|e| (e.polyhedron[0] - e.exact).abs() <= e.polyhedron[1]).count();
    let median = |mut of: Vec<f64>| {
        of.sort_by(f64::total_cmp);
        of[of.len() / 2]
    };
    let over_error = median(all().map(|e| e.expanded / (e.value - e.exact).abs()).collect());
    let over_correction = median(all().map(|e| e.expanded / (e.value - e.polyhedron[0]).abs()).collect());
    claims.add(
        ROOM,
        &format!("{count} tessellations of ellipsoids, 8 to {largest} segments around or 128 to 512 triangles: the record's interval holds the smooth body"),
        &format!("{COVERED} % of the diagonal's entries at least"),
        format!(
            "{covered:.1} % of {n}, all six entries in {:.1} % of the bodies; median U/|error| {over_error:.2}, U over the correction {over_correction:.2}",
            percent(whole, bodies.len() as f64)
        ),
        match (full, covered >= COVERED) {
            (false, _) => Verdict::Measured,
            (true, true) => Verdict::Pass,
            (true, false) => Verdict::Miss,
        },
    );
    claims.add(
        ROOM,
        "the same by the polyhedron with the uncertainty of its panels",
        "how wrong it is to take the facets for the body",
        format!("{:.1} % of {n}", percent(of_polyhedron, n)),
        Verdict::Measured,
    );
    Ok(())
}
