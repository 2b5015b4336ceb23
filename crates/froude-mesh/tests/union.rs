//! Unions of solids: against the closed form of two spheres, against Manifold on 200 pairs, and on hostile ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

use froude_mesh::check::{Kind, check};
use froude_mesh::crossing::crossings;
use froude_mesh::files::write_obj;
use froude_mesh::measure::Measure;
use froude_mesh::parts::part_troubles;
use froude_mesh::repair::{merged, repaired};
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::solids::deck_trouble;
use froude_mesh::union::united;
use froude_mesh::{Mesh, Panel, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn sphere(radius_m: f64, around: usize) -> Mesh {
    SectionBody::ellipsoid([radius_m; 3], 2).mesh(Resolution { along: around / 4, around }).unwrap().mesh
}

fn cylinder(length_m: f64, radius_m: f64, around: usize) -> Mesh {
    let body = SectionBody::flat_cylinder(length_m, radius_m, radius_m, [2, 4]);
    body.mesh(Resolution { along: around / 8, around }).unwrap().mesh
}

/// A box from the origin in cells, its outward normals as those of all bodies.
fn cuboid(sides_m: Vec3, cells: u32) -> Mesh {
    let n = cells + 1;
    let mut out = Mesh::default();
    for axis in 0..3 {
        for high in [0.0, 1.0] {
            let first = out.vertices.len() as u32;
            for i in 0..n {
                for j in 0..n {
                    let mut p = [0.0; 3];
                    p[axis] = high * sides_m[axis];
                    p[(axis + 1) % 3] = f64::from(i) / f64::from(cells) * sides_m[(axis + 1) % 3];
                    p[(axis + 2) % 3] = f64::from(j) / f64::from(cells) * sides_m[(axis + 2) % 3];
                    out.vertices.push(p);
                }
            }
            for i in 0..cells {
                for j in 0..cells {
                    let at = |i: u32, j: u32| first + i * n + j;
                    let panel = Panel::quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                    out.panels.push(if high > 0.0 { panel } else { panel.turned() });
                }
            }
        }
    }
    merged(out).0
}

fn moved(mesh: &Mesh, by_m: Vec3) -> Mesh {
    mesh.mapped(|v| [v[0] + by_m[0], v[1] + by_m[1], v[2] + by_m[2]])
}

/// Turned about an axis through the origin (Rodrigues).
fn rotated(mesh: &Mesh, axis: Vec3, angle_rad: f64) -> Mesh {
    let n = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / n);
    let (s, c) = angle_rad.sin_cos();
    mesh.mapped(|v| {
        let along = (x * v[0] + y * v[1] + z * v[2]) * (1.0 - c);
        let around = [y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0]];
        [0, 1, 2].map(|i| c * v[i] + s * around[i] + along * [x, y, z][i])
    })
}

struct Random(Pcg64);

impl Random {
    fn of(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    fn point(&mut self, size_m: f64) -> Vec3 {
        [0; 3].map(|_| self.of(-size_m, size_m))
    }

    fn body(&mut self) -> Mesh {
        let size = self.of(0.5, 1.0);
        match self.0.random_range(0..3) {
            0 => sphere(size, 16),
            1 => cylinder(2.0 * size, 0.5 * size, 16),
            _ => moved(&cuboid([size, 0.8 * size, 1.3 * size], 3), [-0.5 * size; 3]),
        }
    }
}

/// 200 pairs: bodies anywhere, coplanar faces, copies turned, distances near those at which they touch.
fn pairs() -> Vec<(String, Mesh, Mesh)> {
    let mut random = Random(Pcg64::seed_from_u64(7));
    let mut out = Vec::new();
    for i in 0..200 {
        let a = random.body();
        let (name, a, b) = match i % 5 {
            0 | 1 => {
                let (axis, by) = (random.point(1.0), random.point(0.6));
                let angle = random.of(0.0, PI);
                ("anywhere", a, moved(&rotated(&random.body(), axis, angle), by))
            }
            // Faces in one plane: boxes that are shifted along their sides, by parts of their cells and by any.
            2 => {
                let sides = [random.of(0.5, 1.0), random.of(0.5, 1.0), random.of(0.5, 1.0)];
                let box_m = cuboid(sides, 3);
                let mut by = [0.0; 3];
                by[i / 5 % 3] = sides[i / 5 % 3] * if i % 2 == 0 { 1.0 } else { random.of(0.2, 0.9) };
                if i % 3 == 0 {
                    by[(i / 5 + 1) % 3] = random.of(0.1, 0.4);
                }
                ("coplanar", box_m.clone(), moved(&cuboid(sides.map(|s| 0.9 * s), 2), by))
            }
            3 => {
                let axis = if i % 2 == 0 { [0.0, 0.0, 1.0] } else { random.point(1.0) };
                let angle = if i % 4 < 2 { PI / 6.0 } else { random.of(1e-7, 1e-3) };
                ("turned copy", a.clone(), rotated(&a, axis, angle))
            }
            _ => {
                let gap = [1e-3, 1e-6, 1e-9, -1e-9, -1e-6, -1e-3][i / 5 % 6];
                let sides = [1.0, 0.7, 0.5];
                ("nearly touching", cuboid(sides, 2), moved(&cuboid(sides, 3), [1.0 + gap, 0.1, 0.1]))
            }
        };
        out.push((name.to_owned(), a, b));
    }
    out
}

fn troubles(mesh: &Mesh) -> Vec<String> {
    let all = check(mesh).into_iter().chain(part_troubles(mesh)).chain(crossings(mesh));
    all.filter(|trouble| trouble.kind != Kind::Slivers).map(|trouble| trouble.to_string()).collect()
}

#[test]
fn two_hundred_unions_have_the_volume_and_the_area_of_manifold() {
    let folder = tempfile::tempdir().unwrap();
    let pairs = pairs();
    for (i, (_, a, b)) in pairs.iter().enumerate() {
        for (letter, mesh) in [("a", a), ("b", b)] {
            std::fs::write(folder.path().join(format!("{letter}{i}.obj")), write_obj(mesh)).unwrap();
        }
    }
    let oracle = python(folder.path(), SCRIPT);
    let mut refused = Vec::new();
    for ((i, (name, a, b)), line) in pairs.iter().enumerate().zip(oracle.lines()) {
        let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
        let whole = merged(a.clone().with(b)).0;
        let Some(found) = sound(&whole) else {
            refused.push(format!("{i} {name}"));
            continue;
        };
        let found = Measure::of(&found);
        let (volume, area) = (found.volume_m3 / numbers[0] - 1.0, found.area_m2 / numbers[1] - 1.0);
        assert!(volume.abs() <= VOLUME_PART && area.abs() <= AREA_PART, "{i} {name}: {volume:e} {area:e}");
    }
    assert_eq!(refused, <[&str; 0]>::default());
}

/// What a union may miss: the most that cleaning its seam may change.
const VOLUME_PART: f64 = 1e-3;
/// The same of the area, whose part is two thirds of the volume's where a body shrinks alike on all sides, and more at a seam.
const AREA_PART: f64 = 1e-3;

/// The solids of a mesh as one that potential flow can be computed on.
fn sound(mesh: &Mesh) -> Option<Mesh> {
    let out = united(mesh).ok()?.map_or_else(|| mesh.clone(), |found| found.mesh);
    troubles(&out).is_empty().then_some(out)
}

/// V = 8/3 π R³ − π (4 R + d) (2 R − d)²/12: twice the sphere less the lens of both, two caps (Harris and Stocker 1998, ch. 4.8.4).
#[test]
fn two_spheres_have_the_volume_of_the_closed_form() {
    let (radius, apart) = (1.0_f64, 1.1_f64);
    let exact = 8.0 / 3.0 * PI * radius.powi(3) - PI * (4.0 * radius + apart) * (2.0 * radius - apart).powi(2) / 12.0;
    let way = [0.6, 0.0, 0.8].map(|x| apart * x);
    let volume = |around| {
        let mesh = sphere(radius, around);
        Measure::of(&sound(&mesh.clone().with(&moved(&mesh, way))).unwrap()).volume_m3
    };
    let (coarse, fine) = (volume(16), volume(32));
    // Facets lack volume with the square of their size; what cleaning may change stays.
    let limit = fine + (fine - coarse) / 3.0;
    assert!((limit / exact - 1.0).abs() < VOLUME_PART, "{coarse} {fine} {limit} {exact}");
}

#[test]
fn boxes_that_were_merged_at_a_common_face_are_one_box() {
    let side = cuboid([1.0; 3], 1);
    let mesh = merged(side.clone().with(&moved(&side, [1.0, 0.0, 0.0]))).0;
    assert!(!troubles(&mesh).is_empty());
    let found = united(&mesh).unwrap().unwrap();
    let m = Measure::of(&found.mesh);
    assert_eq!(troubles(&found.mesh), <[&str; 0]>::default());
    assert!((m.volume_m3 - 2.0).abs() < 1e-12 && (m.area_m2 - 10.0).abs() < 1e-12);
    let note = "2 solids that overlap or touch, the first at [0.0, 0.0, 0.0] m, were united: of 12 panels there are 20, of 2.0000e0 m³ there are 2.0000e0 m³";
    assert_eq!(found.notes[0], note);
}

/// Three boxes with corners on a grid: what is inside is counted, cell by cell.
#[test]
fn boxes_on_a_grid_have_the_volume_of_the_cells_that_they_cover() {
    let mut random = Pcg64::seed_from_u64(11);
    let mut done = 0;
    for case in 0..200 {
        let mut draw = || {
            let low = [0; 3].map(|_| random.random_range(0..4_i32));
            (low, low.map(|l| l + random.random_range(1..4_i32)))
        };
        let boxes = [draw(), draw(), draw()];
        let is_in =
            |(low, high): &([i32; 3], [i32; 3]), cell: [i32; 3]| (0..3).all(|k| low[k] <= cell[k] && cell[k] < high[k]);
        let cells = (0..8 * 8 * 8).map(|c| [c % 8, c / 8 % 8, c / 64]);
        let covered = cells.filter(|cell| boxes.iter().any(|b| is_in(b, *cell))).count();
        let mesh = boxes.iter().fold(Mesh::default(), |mesh, (low, high)| {
            let sides = [0, 1, 2].map(|k| f64::from(high[k] - low[k]));
            mesh.with(&moved(&cuboid(sides, 1), low.map(f64::from)))
        });
        // Boxes that touch at an edge only, and such as lie inside another, are refused.
        if let Some(found) = sound(&merged(mesh).0) {
            let volume = Measure::of(&found).volume_m3;
            assert!((volume - covered as f64).abs() < 1e-9, "{case} {boxes:?}: {volume} {covered}");
            done += 1;
        }
    }
    // The others touch along an edge or in a point, or one lies inside another, and are refused: at most a quarter.
    assert!(done >= 150, "{done}");
}

/// A box of two layers with a sheet between them.
fn decked(turned: bool, height_m: f64, is_loose: bool) -> Mesh {
    let mut mesh = cuboid([1.0; 3], 2);
    let inset = if is_loose { 0.25 } else { 0.0 };
    let first = mesh.vertices.len() as u32;
    for i in 0..3 {
        for j in 0..3 {
            let at = |k: u32| inset + (1.0 - 2.0 * inset) * 0.5 * f64::from(k);
            mesh.vertices.push([at(i), at(j), height_m]);
        }
    }
    for i in 0..2 {
        for j in 0..2 {
            let at = |i: u32, j: u32| first + 3 * i + j;
            let panel = Panel::quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            mesh.panels.push(if turned { panel.turned() } else { panel });
        }
    }
    merged(mesh).0
}

#[test]
fn decks_are_named_and_taken_out_whichever_way_they_face() {
    for (turned, is_loose) in [(false, false), (true, false), (false, true), (true, true)] {
        let mesh = decked(turned, 0.5, is_loose);
        let said = deck_trouble(&mesh).unwrap().to_string();
        let at = if is_loose { 0.375 } else { 0.25 };
        let expected = format!(
            "4 panels lie inside the hull, which is closed without them, as a deck or a bulkhead is, the first at [{at}, {at}, 0.5] m: no water \
             reaches them; take them out"
        );
        assert_eq!(said, expected);
        let (hull, _) = repaired(&mesh, 0.0);
        assert!(troubles(&hull).is_empty() && (Measure::of(&hull).volume_m3 - 1.0).abs() < 1e-12);
    }
    // A sheet above the box, a plate through its side, and a box that is inside out.
    assert_eq!(deck_trouble(&decked(false, 1.5, true)), None);
    assert_eq!(
        deck_trouble(&decked(false, 0.5, true).mapped(|[x, y, z]| {
            if z == 0.5 && (0.1..0.9).contains(&x) && (0.1..0.9).contains(&y) { [x + 0.5, y, z] } else { [x, y, z] }
        })),
        None
    );
    let mut turned = decked(false, 0.5, false);
    turned.panels.iter_mut().for_each(|panel| *panel = panel.turned());
    assert_eq!(deck_trouble(&turned), None);
}

const SCRIPT: &str = r#"
import numpy as np, manifold3d as m3
def solid(name):
    v, t = [], []
    for line in open(name):
        w = line.split()
        if not w: continue
        if w[0] == "v": v.append([float(x) for x in w[1:4]])
        if w[0] == "f":
            f = [int(x) - 1 for x in w[1:]]
            if len(f) == 4:
                d = lambda i, j: np.linalg.norm(np.subtract(v[f[i]], v[f[j]]))
                t += [[f[0], f[1], f[2]], [f[0], f[2], f[3]]] if d(0, 2) <= d(1, 3) else [[f[0], f[1], f[3]], [f[1], f[2], f[3]]]
            else: t.append(f)
    out = m3.Manifold(m3.Mesh64(np.array(v), np.array(t, dtype=np.uint64)))
    assert out.status() == m3.Error.NoError, (name, out.status())
    return out
for i in range(200):
    u = solid(f"a{i}.obj") + solid(f"b{i}.obj")
    print(u.volume(), u.surface_area())
"#;

/// What a script prints, run by the Python of `target/oracles`.
fn python(folder: &Path, script: &str) -> String {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let found = here.ancestors().map(|folder| folder.join("target/oracles/bin/python")).find(|path| path.exists());
    let python = found.expect("no Python with the packages of xtask/oracles.txt: run `cargo xtask oracles`");
    let output = Command::new(python).args(["-c", script]).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "if a package is missing, run `cargo xtask oracles`\n{said}");
    String::from_utf8(output.stdout).unwrap()
}
