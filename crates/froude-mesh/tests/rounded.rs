//! Rounding adds what chords explain and nothing more: bodies of revolution with long facets, creases and tips; flat bodies.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::PI;

use froude_mesh::measure::Measure;
use froude_mesh::refine::{rounded, subdivided};
use froude_mesh::{Mesh, Panel};

/// The crease of added masses: 52°.
const CREASE_RAD: f64 = 52.0 * PI / 180.0;

/// About x from stations (x, r), the bow first, on the axis at both ends.
fn revolved(stations: &[[f64; 2]], around: u32, is_quads: bool) -> Mesh {
    let rings = &stations[1..stations.len() - 1];
    let mut vertices = vec![[stations[0][0], 0.0, 0.0]];
    for [x, r] in rings {
        let angle = |k: u32| 2.0 * PI * f64::from(k) / f64::from(around);
        vertices.extend((0..around).map(|k| [*x, r * angle(k).cos(), r * angle(k).sin()]));
    }
    vertices.push([stations[stations.len() - 1][0], 0.0, 0.0]);
    let last = vertices.len() as u32 - 1;
    let at = |ring: usize, k: u32| 1 + ring as u32 * around + k % around;
    let mut panels = Vec::new();
    for k in 0..around {
        panels.push(Panel::triangle(0, at(0, k), at(0, k + 1)));
        panels.push(Panel::triangle(last, at(rings.len() - 1, k + 1), at(rings.len() - 1, k)));
        for ring in 1..rings.len() {
            let [a, b, c, d] = [at(ring - 1, k), at(ring, k), at(ring, k + 1), at(ring - 1, k + 1)];
            if is_quads {
                panels.push(Panel::quad(a, b, c, d));
            } else {
                panels.extend([Panel::triangle(a, b, c), Panel::triangle(a, c, d)]);
            }
        }
    }
    Mesh { vertices, panels }
}

/// Volume of the smooth body over that of the polyhedron, less one.
fn gain(mesh: &Mesh) -> f64 {
    let flat = Measure::of(mesh).volume_m3;
    4.0 / 3.0 * (Measure::of(&rounded(mesh, CREASE_RAD)).volume_m3 / flat - 1.0)
}

/// What an inscribed polygon lacks of its circle, over what it has.
fn of_chords(around: u32) -> f64 {
    let turn = 2.0 * PI / f64::from(around);
    turn / turn.sin() - 1.0
}

#[test]
fn cones_and_cylinders_gain_what_chords_around_explain() {
    for around in [8, 12, 16, 24] {
        for is_quads in [false, true] {
            let close: Vec<[f64; 2]> = (0..=80).rev().map(|k| [0.05 * f64::from(k), 1.0]).collect();
            for (name, stations) in [
                ("cone", vec![[2.0, 0.0], [0.0, 1.0], [0.0, 0.0]]),
                ("cone of rows", vec![[2.0, 0.0], [1.5, 0.25], [1.0, 0.5], [0.0, 1.0], [0.0, 0.0]]),
                ("cylinder", vec![[4.0, 0.0], [4.0, 1.0], [0.0, 1.0], [0.0, 0.0]]),
                ("cone-cylinder", vec![[6.0, 0.0], [4.0, 1.0], [0.0, 1.0], [0.0, 0.0]]),
                // Rows closer together than the bulge is high: each direction is judged by itself.
                ("close rows", [vec![[4.0, 0.0]], close, vec![[0.0, 0.0]]].concat()),
                ("blunt cone", vec![[4.5, 0.0], [4.0, 1.0], [0.0, 1.0], [0.0, 0.0]]),
                ("cone-cylinder-cone", vec![[6.0, 0.0], [4.0, 1.0], [0.0, 1.0], [-4.0, 0.0]]),
            ] {
                let gain = gain(&revolved(&stations, around, is_quads));
                let expected = of_chords(around);
                // Never more; of a row of triangles that end at the tip three quarters, since their bulge is linear and not quadratic.
                assert!(gain < 1.02 * expected && gain > 0.7 * expected, "{name} {around}: {gain} {expected}");
                if name == "cylinder" {
                    assert!((gain / expected - 1.0).abs() < 0.02 + 0.2 * expected, "{around}: {gain} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_torpedo_with_one_row_of_cylinder_facets_is_not_inflated() {
    let mut stations: Vec<[f64; 2]> = (0..=4).map(|k| PI / 8.0 * f64::from(k)).map(|a| [a.cos(), a.sin()]).collect();
    stations.extend([[-11.0, 1.0], [-15.0, 0.0]]);
    let exact = PI * (2.0 / 3.0 + 11.0 + 4.0 / 3.0);
    for around in [12, 16, 24] {
        for is_quads in [false, true] {
            let torpedo = revolved(&stations, around, is_quads);
            let smooth = Measure::of(&torpedo).volume_m3 * (1.0 + gain(&torpedo));
            assert!((smooth / exact - 1.0).abs() < 0.005, "{around}: {smooth} {exact}");
        }
    }
}

#[test]
fn flat_bodies_gain_nothing() {
    let prism = |sides| revolved(&[[4.0, 0.0], [4.0, 1.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]], sides, false);
    for sides in 3..7 {
        assert!(gain(&prism(sides)).abs() < 1e-12, "{sides}");
        // Divided in its own planes, a prism of more sides shows that they are flat.
        assert!(gain(&prism(sides + 5)) > 0.01 && gain(&subdivided(&prism(sides + 5))).abs() < 1e-12, "{sides}");
    }
    // A square bar with bevels of 45°, a sixth as wide as the sides between them; a box of four rows under a ridge of 30°.
    let bevelled = |k: u32| {
        let [y, z] = [[1.0, 0.8], [0.8, 1.0]][k as usize % 2];
        let (sin, cos) = (0.5 * PI * f64::from(k / 2)).sin_cos();
        [y * cos - z * sin, y * sin + z * cos]
    };
    assert!(gain(&bar((0..8).map(bevelled).collect())).abs() < 1e-12);
    let ridge = (PI / 12.0).tan();
    assert!(gain(&bar(vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, ridge], [-1.0, 0.0]])).abs() < 1e-12);
}

/// Four rows of a section, counterclockwise in y and z.
fn bar(section: Vec<[f64; 2]>) -> Mesh {
    let around = section.len() as u32;
    let stations: Vec<[f64; 2]> = (0..5).rev().map(|k| [f64::from(k), 1.0]).collect();
    let stations = [vec![[4.0, 0.0]], stations, vec![[0.0, 0.0]]].concat();
    let mut mesh = revolved(&stations, around, true);
    let ends = [0, mesh.vertices.len() - 1];
    for (k, vertex) in mesh.vertices.iter_mut().enumerate().filter(|(k, _)| !ends.contains(k)) {
        [vertex[1], vertex[2]] = section[(k - 1) % around as usize];
    }
    mesh
}

/// A bow of rows, a cylinder of one row with four radial fins over its length, a flat stern. `between`: chords of the hull between two fins, `under`: those
/// under a fin. Returns the mesh and the volume of the smooth body, m³.
fn finned_hull(between: u32, under: u32, half_rad: f64, is_quads: bool) -> (Mesh, f64) {
    let mut angles = Vec::new();
    for quarter in 0..4 {
        let middle = 0.5 * PI * f64::from(quarter);
        let open = 0.5 * PI - 2.0 * half_rad;
        let part = |k: u32, of: u32| f64::from(k) / f64::from(of);
        angles.extend((0..under).map(|k| middle + half_rad * (2.0 * part(k, under) - 1.0)));
        angles.extend((0..between).map(|k| middle + half_rad + open * part(k, between)));
    }
    let around = angles.len() as u32;
    let bow = (0..=6).map(|k| PI / 12.0 * f64::from(k)).map(|a| [3.0 + a.cos(), a.sin()]);
    let stations: Vec<[f64; 2]> = bow.chain([[0.0, 1.0], [0.0, 0.0]]).collect();
    let mut mesh = revolved(&stations, around, is_quads);
    let per_ring = mesh.vertices.len() - 2;
    for (k, vertex) in mesh.vertices[1..=per_ring].iter_mut().enumerate() {
        let r = vertex[1].hypot(vertex[2]);
        let angle = angles[k % around as usize];
        (vertex[1], vertex[2]) = (r * angle.cos(), r * angle.sin());
    }
    // Remove the cylinder's panels under each fin.
    let (bow, stern) = (1 + 5 * around, 1 + 6 * around);
    let is_fin = |k: u32| k % (under + between) < under;
    let on = |v: u32, k: u32| [bow + k, bow + (k + 1) % around, stern + k, stern + (k + 1) % around].contains(&v);
    mesh.panels.retain(|panel| !(0..around).any(|k| is_fin(k) && panel.corners().iter().all(|v| on(*v, k))));
    let outer = mesh.vertices.len() as u32;
    for ring in [bow, stern] {
        for k in 0..around {
            let [x, y, z] = mesh.vertices[(ring + k) as usize];
            mesh.vertices.push([x, FIN * y, FIN * z]);
        }
    }
    let mut add = |[a, b, c, d]: [u32; 4]| {
        if is_quads {
            mesh.panels.push(Panel::quad(a, b, c, d));
        } else {
            mesh.panels.extend([Panel::triangle(a, b, c), Panel::triangle(a, c, d)]);
        }
    };
    let (far_bow, far_stern) = (outer, outer + around);
    for k in (0..around).filter(|k| is_fin(*k)) {
        let next = (k + 1) % around;
        add([far_bow + k, far_stern + k, far_stern + next, far_bow + next]);
        add([bow + k, far_bow + k, far_bow + next, bow + next]);
        add([stern + k, stern + next, far_stern + next, far_stern + k]);
        if !is_fin((k + around - 1) % around) {
            add([bow + k, stern + k, far_stern + k, far_bow + k]);
        }
        if !is_fin(next) {
            add([bow + next, far_bow + next, far_stern + next, stern + next]);
        }
    }
    let chord_rad = 2.0 * half_rad / f64::from(under);
    let sector = 0.5 * f64::from(under) * chord_rad.sin();
    let fins = 4.0 * 3.0 * sector * (FIN * FIN - 1.0);
    // Under the fins the hull stays a polygon: the mesh has no panels there to show a curve.
    let hull = PI * (2.0 / 3.0 + 3.0) - 3.0 * 4.0 * (half_rad - sector);
    (mesh, hull + fins)
}

/// Radius of the fins' tips over the hull's.
const FIN: f64 = 1.8;

#[test]
fn a_hull_is_round_between_its_fins() {
    for between in 2..5 {
        for (under, half_rad) in [(2, 0.15), (1, 0.15), (1, 0.03), (2, 0.03)] {
            for is_quads in [false, true] {
                let (mesh, exact) = finned_hull(between, under, half_rad, is_quads);
                let flat = Measure::of(&mesh).volume_m3;
                let part = flat * gain(&mesh) / (exact - flat);
                // The triangles at the tip of the bow lack a quarter of theirs.
                assert!(
                    (part - 0.98).abs() < 0.02,
                    "{between} {under} {half_rad} {is_quads}: {part} of {}",
                    exact / flat - 1.0
                );
                // The sides and tips of the fins are flat.
                let round = rounded(&mesh, CREASE_RAD);
                let reach = |mesh: &Mesh| mesh.vertices.iter().map(|v| v[1].hypot(v[2])).fold(0.0, f64::max);
                assert!(reach(&round) < reach(&mesh) + 1e-12, "{between} {under} {half_rad} {is_quads}");
            }
        }
    }
}

/// A shaft of 24 segments with a flat over its length, a twelfth of the diameter deep: an arc and a chord, both on one circle.
#[test]
fn a_flat_on_a_shaft_stays_flat() {
    let depth: f64 = 1.0 / 6.0;
    let half_rad = (1.0 - depth).acos();
    let step = (2.0 * PI - 2.0 * half_rad) / 20.0;
    let section: Vec<[f64; 2]> = (0..=20).map(|k| half_rad + step * f64::from(k)).map(|a| [a.cos(), a.sin()]).collect();
    let mesh = bar(section);
    let area = |gain: f64| gain * Measure::of(&mesh).volume_m3 / 4.0;
    let of_arc = 20.0 * 0.5 * (step - step.sin());
    let found = area(gain(&mesh));
    assert!(found < 1.03 * of_arc && found > 0.9 * of_arc, "{found} {of_arc}");
}

/// A strut with bevels of one width whose sides become wider, from what is curved to what is flat: the wide rows do not move.
#[test]
fn a_curved_row_does_not_bend_a_flat_one() {
    let widths = [2.0, 2.9, 4.0, 4.0, 5.0];
    let sections = widths.map(|width| {
        let [inner, outer] = [0.5 * width, 0.5 * width + 0.5_f64.sqrt()];
        let corner = |k: u32| {
            let [y, z] = [[outer, inner], [inner, outer]][k as usize % 2];
            let (sin, cos) = (0.5 * PI * f64::from(k / 2)).sin_cos();
            [y * cos - z * sin, y * sin + z * cos]
        };
        (0..8).map(corner).collect::<Vec<_>>()
    });
    let mut mesh = bar(sections[0].clone());
    let rings = mesh.vertices.len() - 1;
    for (k, vertex) in mesh.vertices[1..rings].iter_mut().enumerate() {
        [vertex[1], vertex[2]] = sections[k / 8][k % 8];
    }
    let is_flat = |x: f64| x < 2.5;
    let [flat, round] = [subdivided(&mesh), rounded(&mesh, CREASE_RAD)];
    let moved = |x: &dyn Fn(f64) -> bool| {
        let both = flat.vertices.iter().zip(&round.vertices).filter(|(v, _)| x(v[0]));
        both.map(|(a, b)| (a[1] - b[1]).hypot(a[2] - b[2])).fold(0.0, f64::max)
    };
    assert!(moved(&|x| x > 3.5) > 0.1, "the first rows are curved");
    assert!(moved(&is_flat) < 1e-12, "{}", moved(&is_flat));
}
