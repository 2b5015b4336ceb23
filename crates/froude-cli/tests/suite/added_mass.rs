//! `froude added-mass` as a user meets it: closed forms and laws, the files it writes, bad input word for word, odd sizes.

use std::path::Path;
use std::process::{Command, Output};

use crate::small_disk::SmallDisk;
use froude::hydro::ellipsoid::ellipsoid_added_mass;
use froude::mesh::files::{write_obj, write_stl_binary};
use froude::mesh::measure::Measure;
use froude::mesh::panel::facets;
use froude::mesh::sections::{Resolution, SectionBody};
use froude::mesh::vector::Vec3;
use froude::mesh::{Mesh, Panel};
use froude::panel::family::Family;
use froude::panel::matrix::{AddedMass, congruent};
use froude::panel::problem::Frame;
use froude::panel::refine::{Wanted, refine};
use froude::records::table_file::read_table;
use froude::records::units::Dimension;
use serde_json::Value;

type Matrix = [[f64; 6]; 6];

/// What a `.1` file of WAMIT says of one body in water of 1000 kg/m³, over a length of 1 m: at frequency zero and at infinity.
fn wamit_limits(path: &Path) -> [Matrix; 2] {
    let text = std::fs::read_to_string(path).unwrap();
    assert_eq!(text.lines().count(), 72);
    let mut limits = [[[f64::NAN; 6]; 6]; 2];
    for line in text.lines() {
        let row: Vec<f64> = line.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
        let [period, i, j, bar] = row[..] else { panic!("{line}") };
        limits[usize::from(period == 0.0)][i as usize - 1][j as usize - 1] = 1000.0 * bar;
    }
    limits
}

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).arg("added-mass").args(args).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

/// The record, by --json.
fn record(folder: &Path, args: &[&str]) -> Value {
    let output = froude(folder, &[args, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The lines on standard output.
fn lines(folder: &Path, args: &[&str]) -> String {
    let output = froude(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// The matrix of an estimate, kg, kg m, kg m².
fn matrix(record: &Value, estimate: usize) -> Matrix {
    let coefficients = &record["estimates"][estimate]["coefficients"];
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let name = format!("A{}{}", i.min(j) + 1, i.max(j) + 1);
            coefficients[&name]["value"].as_f64().unwrap_or_else(|| panic!("{name} of {coefficients}"))
        })
    })
}

/// Largest difference of two matrices, over √(A_ii A_jj).
fn apart(a: &Matrix, b: &Matrix) -> f64 {
    let of = |(i, j): (usize, usize)| (a[i][j] - b[i][j]).abs() / (a[i][i] * a[j][j]).abs().sqrt();
    (0..36).map(|k| of((k / 6, k % 6))).fold(0.0, f64::max)
}

fn ellipsoid(semi_axes_m: Vec3, cells: usize, along: usize) -> Mesh {
    SectionBody::ellipsoid(semi_axes_m, cells).mesh(Resolution { along, around: 8 * along }).unwrap().mesh
}

/// 64 panels off the origin, so that every entry of the matrix is different from zero.
fn hull() -> Mesh {
    ellipsoid([0.6, 0.2, 0.3], 4, 1).mapped(|[x, y, z]| [x + 0.2, y - 0.1 + 0.3 * x, z + 0.05])
}

/// One mesh, no extrapolation: 64 panels.
const ONE_MESH: [&str; 4] = ["--density", "1000 kg/m^3", "--most-panels", "64"];

fn write(folder: &Path, name: &str, mesh: &Mesh) {
    let is_stl = Path::new(name).extension().is_some_and(|e| e == "stl");
    let content = if is_stl { write_stl_binary(mesh) } else { write_obj(mesh).into_bytes() };
    std::fs::write(folder.join(name), content).unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The polyhedron's value with "smooth body minus polyhedron" on it, against the ellipsoid that the facets stand for.
const SMOOTH: f64 = 0.002;

#[test]
fn an_ellipsoid_as_stl_is_lambs() {
    let folder = tempfile::tempdir().unwrap();
    let axes = [0.5, 0.3, 0.2];
    write(folder.path(), "egg.stl", &ellipsoid(axes, 3, 3));
    let text = lines(folder.path(), &["egg.stl", "--density", "1025 kg/m^3"]);
    let rows: Vec<Vec<&str>> = text.lines().map(|l| l.split_whitespace().collect()).collect();
    let facets = rows.iter().position(|r| r.join(" ").contains("smooth body minus polyhedron")).unwrap();
    let exact = ellipsoid_added_mass(axes).unwrap();
    for (i, motion) in ["surge", "sway", "heave", "roll", "pitch", "yaw"].into_iter().enumerate() {
        let row = rows[facets..].iter().find(|r| r.get(1) == Some(&motion)).unwrap();
        assert_eq!(row[0], format!("A{0}{0}", i + 1));
        let number = |cell: &str| cell.replace('−', "-").parse::<f64>().unwrap();
        let (value, smooth) = (number(row[2]), number(row[row.len() - 4]));
        let error = value * (1.0 + smooth / 100.0) / (1025.0 * exact[i]) - 1.0;
        // A44 goes with (b² − c²)²: what is left of the facets' error in b² and c² counts 2 (b² + c²)/(b² − c²) times there.
        let limit = if motion == "roll" { 5.2 * SMOOTH } else { SMOOTH };
        assert!(error.abs() < limit, "{motion}: {error}");
    }
    // The record is that of the smooth body, with the error of the correction as an entry of its own; the polyhedron is asked for.
    let of = |args: &[&str]| record(folder.path(), &[&["egg.stl", "--density", "1025 kg/m^3"], args].concat());
    let (smooth, flat) = (of(&[]), of(&["--polyhedron"]));
    let [smooth, flat] = [&smooth["estimates"][0], &flat["estimates"][0]];
    for (i, exact) in exact.into_iter().enumerate().filter(|(i, _)| *i != 3) {
        let name = format!("A{0}{0}", i + 1);
        let ends = |e: &Value| [0, 1].map(|k| e["coefficients"][&name]["interval_95"][k].as_f64().unwrap());
        let ([low, high], [of_flat, to_flat]) = (ends(smooth), ends(flat));
        assert!(low < 1025.0 * exact && 1025.0 * exact < high, "{name}: {low} {exact} {high}");
        assert!(to_flat < 1025.0 * exact && high - low > to_flat - of_flat, "{name}");
    }
    let error = &smooth["errors"]["own/facets"];
    assert_eq!(error["sensitivity"].as_array().unwrap().len(), 21);
    assert!(flat["errors"].as_object().is_none_or(serde_json::Map::is_empty), "{flat}");
}

/// A body of revolution about x from its stations (x, r), the bow first and a station of no radius at each end; quadrilaterals, triangles at tips.
fn revolved(stations: &[[f64; 2]], around: u32) -> Mesh {
    let rings = &stations[1..stations.len() - 1];
    let mut vertices = vec![[stations[0][0], 0.0, 0.0]];
    for [x, r] in rings {
        let angle = |k: u32| 2.0 * std::f64::consts::PI * f64::from(k) / f64::from(around);
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
            panels.push(Panel::quad(at(ring - 1, k), at(ring, k), at(ring, k + 1), at(ring - 1, k + 1)));
        }
    }
    Mesh { vertices, panels }
}

/// Value and expanded uncertainty of a coefficient.
fn coefficient(record: &Value, name: &str) -> [f64; 2] {
    let c = &record["estimates"][0]["coefficients"][name];
    let [low, high] = [0, 1].map(|k| c["interval_95"][k].as_f64().unwrap());
    [0.5 * (low + high), 0.5 * (high - low)]
}

fn refers_to(record: &Value, name: &str) -> f64 {
    record["estimates"][0]["refers_to"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name}: {record}"))
}

/// Value and expanded uncertainty of volume or displaced mass.
fn displaced(record: &Value, name: &str) -> [f64; 2] {
    let [low, high] = [0, 1].map(|k| record["estimates"][0]["derived"][name]["interval_95"][k].as_f64().unwrap());
    [0.5 * (low + high), 0.5 * (high - low)]
}

/// What 16 chords of a circle lack of its area, as a part: (2π/16)²/6 to first order.
const CHORDS: f64 = 0.0257;

#[test]
fn a_long_facet_that_meets_a_crease_or_a_tip_is_straight_along() {
    use std::f64::consts::PI;
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "cone.obj", &revolved(&[[1.0, 0.0], [0.0, 0.5], [0.0, 0.0]], 16));
    // A hemisphere, one row of cylinder facets, a conical tail of 14° half-angle.
    let mut stations: Vec<[f64; 2]> =
        (0..=4).map(|k| PI / 8.0 * f64::from(k)).map(|a| [1.1 + 0.1 * a.cos(), 0.1 * a.sin()]).collect();
    stations.extend([[0.0, 0.1], [-0.4, 0.0]]);
    write(at, "torpedo.obj", &revolved(&stations, 16));
    let torpedo_m3 = 0.01 * PI * (0.2 / 3.0 + 1.1 + 0.4 / 3.0);
    for (name, density, volume_m3, sway_kg) in
        [("cone.obj", 1000.0, PI / 12.0, 143.0), ("torpedo.obj", 1025.0, torpedo_m3, 38.6)]
    {
        let water = format!("{density} kg/m^3");
        let of = |args: &[&str]| record(at, &[&[name, "--density", &water, "--tolerance", "2 %"], args].concat());
        let [either, smooth, flat] = [of(&[]), of(&["--smooth"]), of(&["--polyhedron"])];
        let volume = refers_to(&either, "volume");
        // A row of triangles that end at a tip gains three quarters of what its chords explain: a quarter of 2.6 % is left.
        assert!((volume / volume_m3 - 1.0).abs() < 0.3 * CHORDS, "{name}: {volume} for {volume_m3}");
        let flat_m3 = refers_to(&flat, "volume");
        assert!(volume / flat_m3 - 1.0 < 1.1 * CHORDS, "{name}: {volume} {flat_m3}");
        // The interval of the displacement contains both bodies.
        let expanded = displaced(&either, "volume")[1];
        assert!((volume - expanded - flat_m3).abs() < 1e-9 * volume, "{name}: {volume} {expanded} {flat_m3}");
        let [mass, of_mass] = displaced(&either, "displaced_mass");
        assert!((mass / (density * volume) - 1.0).abs() < 1e-9);
        assert!((of_mass / (density * expanded) - 1.0).abs() < 1e-9);
        let [[value, u], [of_smooth, u_of_smooth], [of_flat, u_of_flat]] =
            [&either, &smooth, &flat].map(|record| coefficient(record, "A22"));
        // The tolerance is 2 %.
        let away = (value - sway_kg).abs();
        assert!(away < 0.02 * sway_kg && away < u, "{name}: {value} ± {u} for {sway_kg}");
        assert!(value == of_smooth && u_of_smooth < u, "{name}: {u_of_smooth} {u}");
        // At most the difference of the two bodies and the panels; it contains the polyhedron.
        let of_volume = value * expanded / volume;
        assert!(u <= (value - of_flat).max(of_volume) + u_of_flat + 1e-9 * value, "{name}: {u}");
        assert!(value - u <= of_flat && of_flat <= value + u, "{name}: {value} ± {u}, {of_flat}");
        let text = lines(at, &[name, "--density", &water, "--tolerance", "2 %"]);
        assert!(text.contains("to decide, write --smooth") && text.contains(" ± "), "{text}");
        let row = text.lines().find(|l| l.trim_start().starts_with("displaced mass")).unwrap();
        assert!(row.contains('±'), "{row}");
    }
}

#[test]
fn a_box_has_no_facets_to_round() {
    let folder = tempfile::tempdir().unwrap();
    let cells = SectionBody::flat_cylinder(0.5, 0.3, 0.2, [2, 3]);
    write(folder.path(), "box.obj", &cells.mesh(Resolution { along: 1, around: 4 }).unwrap().mesh);
    let of = |args: &[&str]| {
        record(folder.path(), &[&["box.obj", "--density", "1000 kg/m^3", "--tolerance", "5 %"], args].concat())
    };
    let (either, flat) = (of(&[]), of(&["--polyhedron"]));
    assert_eq!(matrix(&either, 0), matrix(&flat, 0));
    // Whoever states that it is smooth hears that nothing was rounded.
    let smooth = of(&["--smooth"]);
    assert_eq!(matrix(&smooth, 0), matrix(&flat, 0));
    assert!(smooth["findings"].to_string().contains("--smooth was given, and no edge belongs to a curve"), "{smooth}");
    let output = froude(folder.path(), &["box.obj", "--smooth", "--polyhedron"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(said(&output), "froude: --smooth and --polyhedron contradict each other: give one of them");
}

/// Two spheres of 320 facets, ten radii apart: what one feels of the other is 3 (a/d)⁶.
#[test]
fn parts_are_rounded_as_one_body_is() {
    let folder = tempfile::tempdir().unwrap();
    let one = icosphere(2);
    write(folder.path(), "one.obj", &one);
    let mut two = one.clone();
    two.vertices.extend(one.vertices.iter().map(|[x, y, z]| [x + 10.0, *y, *z]));
    let count = one.vertices.len() as u32;
    two.panels.extend(one.panels.iter().map(|p| {
        let [a, b, c] = *p.corners() else { panic!() };
        Panel::triangle(a + count, b + count, c + count)
    }));
    write(folder.path(), "two.obj", &two);
    let of = |args: &[&str]| record(folder.path(), &[args, &["--density", "1 kg/m^3"]].concat());
    let [alone, u_alone] = coefficient(&of(&["one.obj"]), "A11");
    let apart = of(&["two.obj", "--apart"]);
    let exact = 2.0 / 3.0 * std::f64::consts::PI;
    for name in ["A11_1_1", "A22_1_1", "A33_2_2"] {
        let [value, u] = coefficient(&apart, name);
        assert!((value / exact - 1.0).abs() < 0.001 && (value / alone - 1.0).abs() < 0.001, "{name}: {value} {alone}");
        assert!((u / u_alone - 1.0).abs() < 0.1, "{name}: {u} {u_alone}");
    }
    assert!(apart["findings"].to_string().contains("facets-rounded"), "{}", apart["findings"]);
    let [flat, u] = coefficient(&of(&["two.obj", "--apart", "--polyhedron"]), "A11_1_1");
    assert!(flat + u < exact, "{flat} {u}");
}

/// Coarse meshes of a sphere: 80 panels of an icosahedron, 80 to 192 of rings.
#[test]
fn the_interval_of_a_coarse_mesh_covers_its_error() {
    let folder = tempfile::tempdir().unwrap();
    let rings = |around: u32, along: u32| {
        let angle = |k: u32| std::f64::consts::PI * f64::from(k) / f64::from(along);
        let stations: Vec<[f64; 2]> = (0..=along).map(|k| [angle(k).cos(), angle(k).sin()]).collect();
        revolved(&stations, around)
    };
    for (number, mesh) in [icosphere(1), rings(10, 8), rings(12, 10), rings(16, 12)].into_iter().enumerate() {
        for axes in [[1.0; 3], [2.0, 1.0, 0.7], [4.0, 1.0, 0.8]] {
            let stretched = mesh.mapped(|v| core::array::from_fn(|k| v[k] * axes[k]));
            write(folder.path(), "coarse.obj", &stretched);
            let found = record(folder.path(), &["coarse.obj", "--density", "1 kg/m^3", "--tolerance", "5 %"]);
            let volume_m3 = 4.0 / 3.0 * std::f64::consts::PI * axes.iter().product::<f64>();
            let [volume, expanded] = displaced(&found, "volume");
            assert!((volume - volume_m3).abs() <= expanded, "{number} {axes:?}: {volume} ± {expanded} for {volume_m3}");
            for (i, exact) in ellipsoid_added_mass(axes).unwrap().into_iter().enumerate() {
                let [value, u] = coefficient(&found, &format!("A{0}{0}", i + 1));
                assert!((value - exact).abs() <= u, "{number} {axes:?} A{0}{0}: {value} ± {u} for {exact}", i + 1);
            }
        }
    }
}

/// An icosahedron on the unit sphere, divided so many times.
fn icosphere(times: usize) -> Mesh {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for (a, b) in [(-1.0, -g), (-1.0, g), (1.0, -g), (1.0, g)] {
        vertices.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    let unit = |v: &Vec3| v.map(|x| x / v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let near = |p: &Vec3, q: &Vec3| p.iter().zip(q).map(|(a, b)| (a - b).powi(2)).sum::<f64>() < 4.1;
    let mut panels = Vec::new();
    for a in 0..12_usize {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r]: [Vec3; 3] = [a, b, c].map(|k| vertices[k]);
                if near(&p, &q) && near(&q, &r) && near(&r, &p) {
                    let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    let [a, b, c] = if volume > 0.0 { [a, b, c] } else { [a, c, b] }.map(|k| k as u32);
                    panels.push(Panel::triangle(a, b, c));
                }
            }
        }
    }
    let mut mesh = Mesh { vertices: vertices.iter().map(unit).collect(), panels };
    for _ in 0..times {
        mesh = froude::mesh::refine::subdivided(&mesh);
        mesh.vertices = mesh.vertices.iter().map(unit).collect();
    }
    mesh
}

const EGG: &str = r#"shape = "ellipsoid"
semi_axis_x = "0.5 m"
semi_axis_y = "30 cm"
semi_axis_z = "0.2 m"
"#;
const ROBOT: &str = r#"shape = "robot"
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
joint = { length = "60 mm", scale = 0.7, ramp = "4 mm" }
ends = { length = "31 mm" }
"#;

fn body_file(shape: &str) -> String {
    format!("schema = 1\nname = \"it\"\n[fluid]\ndensity = \"1025 kg/m^3\"\n[body]\n{shape}")
}

/// The record of a body file.
fn of_shape(shape: &str, args: &[&str]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("body.toml"), body_file(shape)).unwrap();
    record(folder.path(), &[&["body.toml"], args].concat())
}

#[test]
fn body_files_of_all_shapes_give_what_closed_forms_and_strips_say() {
    let rho = 1025.0;
    let a = matrix(&of_shape(EGG, &[]), 0);
    for (i, exact) in ellipsoid_added_mass([0.5, 0.3, 0.2]).unwrap().into_iter().enumerate() {
        assert!((a[i][i] / (rho * exact) - 1.0).abs() < 0.005, "{i}: {} of {}", a[i][i], rho * exact);
    }
    // Round, so sway is heave; less than that of strips as long as the body, more than that of the cylinder alone cut at a radius.
    let round = |length: f64| rho * std::f64::consts::PI * 0.01 * length;
    let capsule = "shape = \"capsule\"\nlength = \"1 m\"\nmajor_semi_axis = \"0.1 m\"\nminor_semi_axis = \"0.1 m\"\nends = { length = \"0.1 m\" }\n";
    let a = matrix(&of_shape(capsule, &[]), 0);
    assert!((a[1][1] / a[2][2] - 1.0).abs() < 1e-3, "{a:?}");
    assert!((round(0.8)..round(1.0)).contains(&a[1][1]), "{a:?}");
    // DNV-RP-C205, table D-2: C_A is 0.90 at a length of ten radii.
    let cylinder = "shape = \"cylinder\"\nlength = \"1 m\"\nmajor_semi_axis = \"0.1 m\"\nminor_semi_axis = \"0.1 m\"\n";
    let a = matrix(&of_shape(cylinder, &["--tolerance", "5 %"]), 0);
    assert!((a[1][1] / round(1.0) - 0.90).abs() < 0.03, "{} of {}", a[1][1], round(1.0));
    // Table 6 of the USR paper: 5.1539 kg and 3.830e-3 m³ for three links.
    let robot = of_shape(ROBOT, &["--links", "3", "--tolerance", "5 %"]);
    assert_eq!(robot["estimates"][0]["source"], "it, H3LT");
    let a = matrix(&robot, 0);
    assert!((a[1][1] / 5.1539 - 1.0).abs() < 0.02, "{}", a[1][1]);
}

#[test]
fn links_are_tabled_fitted_and_written_and_the_other_verbs_take_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("body.toml"), body_file(ROBOT)).unwrap();
    let out = record(at, &["body.toml", "--links", "1..3", "--tolerance", "10 %"]);
    let results = at.join("body-added-mass");
    assert_eq!(
        names(&results),
        [
            "campaign.toml",
            "estimate.json",
            "figures",
            "froude-files.json",
            "links.csv",
            "observations-potential-flow.csv",
            "report.html",
            "result.json"
        ]
    );
    for name in ["links.csv", "campaign.toml", "estimate.json", "report.html", "observations-potential-flow.csv"] {
        let text = std::fs::read_to_string(results.join(name)).unwrap();
        assert!(!text.contains(".froude-"), "{name} speaks of the folder that it grew in");
    }
    let estimates = out["estimates"].as_array().unwrap();
    let models: Vec<&str> = estimates.iter().map(|e| e["law"]["name"].as_str().unwrap()).collect();
    for model in ["displaced_volume", "per_link", "affine"] {
        assert!(models.contains(&model), "{models:?}");
    }
    assert_eq!(models.iter().filter(|m| **m == "added_mass_6x6").count(), 3);
    let table = read_table(&results.join("links.csv"), None).unwrap();
    let mass = table.number("mu_y", Dimension::MASS).unwrap();
    for (links, mass) in mass.iter().enumerate() {
        let a = matrix(&out, estimates.len() - 3 + links);
        assert!((mass / a[1][1] - 1.0).abs() < 1e-6, "{mass} {}", a[1][1]);
    }
    let page = std::fs::read_to_string(results.join("report.html")).unwrap();
    assert!(page.contains("H3LT") && page.contains("Least squares"));

    // The record: by the schema, as printed, and as the other verbs take it.
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(&results).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let validator = jsonschema::validator_for(&run(&["schema"])).unwrap();
    let errors: Vec<String> = validator.iter_errors(&out).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let written: Value = serde_json::from_slice(&std::fs::read(results.join("estimate.json")).unwrap()).unwrap();
    assert_eq!(written, out, "--json prints what estimate.json holds");
    assert_eq!(run(&["inspect", "estimate.json", "--json"])["kind"], "estimate");
    assert!(run(&["compare", "estimate.json", "--json"]).is_object());

    // Every column of its own table is in a law.
    let fit = estimates.iter().find(|e| e["law"]["name"] == "displaced_volume").unwrap();
    let masses: [Vec<f64>; 2] = ["mu_z", "volume"].map(|name| {
        let dimension = if name == "volume" { Dimension::VOLUME } else { Dimension::MASS };
        table.number(name, dimension).unwrap().to_vec()
    });
    let (over, under) =
        masses[0].iter().zip(&masses[1]).fold((0.0, 0.0), |(o, u), (m, v)| (o + m * v, u + 1025.0 * v * v));
    assert!((fit["coefficients"]["C_Az"]["value"].as_f64().unwrap() / (over / under) - 1.0).abs() < 1e-9, "{fit}");
    let again = run(&["identify", "campaign.toml", "--out", "again", "--json"]);
    for findings in [&out["findings"], &again["findings"]] {
        assert!(findings.as_array().unwrap().iter().all(|f| f["code"] != "column-not-used"), "{findings}");
    }

    // Two configurations are no least squares, and that is said.
    let out = record(at, &["body.toml", "--links", "1,2", "--tolerance", "10 %", "--out", "two"]);
    assert_eq!(out["estimates"].as_array().unwrap().len(), 2);
    let text = lines(at, &["body.toml", "--links", "1..2", "--tolerance", "10 %", "--out", "two"]);
    let page = std::fs::read_to_string(at.join("two/report.html")).unwrap();
    for said in [text, page] {
        let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains(
                "No least squares: they need 3 configurations at least, such as --links 1..3, and there are 2. links.csv and campaign.toml are \
                 written all the same, and the record holds the matrices alone."
            ),
            "{words}"
        );
    }
    assert_eq!(
        names(&at.join("two")),
        ["campaign.toml", "estimate.json", "figures", "froude-files.json", "links.csv", "report.html", "result.json"]
    );
}

#[test]
fn exports_hold_the_matrix_of_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let args = [&["hull.obj", "--export", "wamit,capytaine,csv", "--out", "up"], &ONE_MESH[..]].concat();
    let a = matrix(&record(at, &args), 0);
    let files = [
        "added-mass.1",
        "added-mass.csv",
        "added-mass.nc",
        "estimate.json",
        "figures",
        "froude-files.json",
        "pressure.vtp",
        "report.html",
        "result.json",
    ];
    assert_eq!(names(&at.join("up")), files);
    let limits = |folder: &str| wamit_limits(&at.join(folder).join("added-mass.1"));
    let of_up: [Matrix; 2] = limits("up");
    // Deeply submerged, both limits are one.
    assert!(of_up.iter().all(|m| apart(m, &a) < 1e-12));
    let table = read_table(&at.join("up/added-mass.csv"), None).unwrap();
    let entry = |name: &str, dimension| table.number(name, dimension).unwrap().to_vec();
    assert_eq!(entry("A11", Dimension::MASS), [a[0][0]; 2]);
    assert_eq!(entry("A26", Dimension::MASS.checked_mul(Dimension::LENGTH).unwrap()), [a[1][5]; 2]);
    assert!(std::fs::read(at.join("up/added-mass.nc")).unwrap().starts_with(b"CDF"));

    // The same body in axes with z down: half a turn about x. Wave programs get the same numbers.
    write(at, "down.obj", &hull().mapped(|[x, y, z]| [x, -y, -z]));
    let args = [&["down.obj", "--up", "-z", "--export", "wamit", "--out", "down"], &ONE_MESH[..]].concat();
    let down = record(at, &args);
    assert_eq!(down["estimates"][0]["frame"]["words"], "axes of the mesh, z down");
    assert!((matrix(&down, 0)[0][1] + a[0][1]).abs() < 1e-9 * a[0][0] && a[0][1].abs() > 1e-3 * a[0][0]);
    let of_down: [Matrix; 2] = limits("down");
    assert!(of_down.iter().all(|m| apart(m, &a) < 1e-9), "{of_down:?}");
}

/// Numbers of a `DataArray` of a .vtp.
fn array(text: &str, attribute: &str) -> Vec<f64> {
    let after = text.split(attribute).nth(1).unwrap_or_else(|| panic!("no {attribute}"));
    let inside = after.split_once('>').unwrap().1.split("</DataArray>").next().unwrap();
    inside.split_whitespace().map(|x| x.parse().unwrap()).collect()
}

/// −Σ p n dA and its moment are minus the matrix: the pressure of a unit acceleration is that of its column.
fn assert_pressure_is_the_matrix(vtp: &Path, a: &Matrix, frame: &Frame) {
    let text = std::fs::read_to_string(vtp).unwrap();
    let vertices = array(&text, "NumberOfComponents=\"3\"").chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    let corners: Vec<u32> = array(&text, "Name=\"connectivity\"").into_iter().map(|x| x as u32).collect();
    let mut begin = 0;
    let mut panels = Vec::new();
    for end in array(&text, "Name=\"offsets\"") {
        panels.push(match corners[begin..end as usize] {
            [a, b, c] => Panel::triangle(a, b, c),
            [a, b, c, d] => Panel::quad(a, b, c, d),
            ref other => panic!("{other:?}"),
        });
        begin = end as usize;
    }
    let mesh = Mesh { vertices, panels };
    let mut sum = [[0.0; 6]; 6];
    let motions = ["surge", "sway", "heave", "roll", "pitch", "yaw"];
    for (j, motion) in motions.into_iter().enumerate() {
        let unit = if j < 3 { "m" } else { "rad" };
        let pressure = array(&text, &format!("Name=\"pressure {motion} [Pa/({unit}/s^2)]\""));
        assert_eq!(pressure.len(), mesh.panels.len());
        for (facet, p) in facets(&mesh).iter().zip(pressure) {
            for (i, v) in frame.normal_velocities(facet).into_iter().enumerate() {
                sum[i][j] += p * facet.area * v;
            }
        }
    }
    // The record has the symmetric part.
    let symmetric = core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (sum[i][j] + sum[j][i])));
    assert!(apart(a, &symmetric) < 1e-9, "{:e}: {a:?} {sum:?}", apart(a, &symmetric));
}

#[test]
fn the_pressure_on_the_panels_adds_up_to_the_matrix() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let origin = ["--at", "0.3 m, -20 cm, 0.1 m"];
    write(at, "hull.obj", &hull());
    let a = matrix(&record(at, &[&["hull.obj", "--out", "hull"], &ONE_MESH[..], &origin].concat()), 0);
    assert_pressure_is_the_matrix(&at.join("hull/pressure.vtp"), &a, &Frame::at([0.3, -0.2, 0.1]));
    // Motions in other axes; the points stay those of the mesh.
    let ned =
        matrix(&record(at, &[&["hull.obj", "--out", "ned", "--axes", "ned"], &ONE_MESH[..], &origin].concat()), 0);
    assert_pressure_is_the_matrix(&at.join("ned/pressure.vtp"), &ned, &starboard([0.3, -0.2, 0.1]));
    // A quarter or an eighth is solved for, and the whole is written; with and without a wall.
    std::fs::write(at.join("egg.toml"), body_file(EGG)).unwrap();
    for surface in [&[][..], &["--surface", "0.4 m"]] {
        let args = [&["egg.toml", "--out", "egg", "--most-panels", "400"], surface, &origin].concat();
        let a = matrix(&record(at, &args), 0);
        assert_pressure_is_the_matrix(&at.join("egg/pressure.vtp"), &a, &Frame::at([0.3, -0.2, 0.1]));
    }
}

#[test]
fn an_origin_moves_the_matrix_by_the_parallel_axes() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let about = |origin: &[&str]| record(at, &[&["hull.obj"], &ONE_MESH[..], origin].concat());
    let a = AddedMass { matrix: matrix(&about(&[]), 0), asymmetry: 0.0, frame: Frame::at([0.0; 3]) };
    let there = about(&["--at", "-0.3 m, 20 cm, 100 mm"]);
    assert!(apart(&a.about([-0.3, 0.2, 0.1]).matrix, &matrix(&there, 0)) < 1e-10);
    assert_eq!(there["estimates"][0]["point"]["words"], "(−0.3, 0.2, 0.1) m from the origin of the mesh");
    let buoyancy = about(&["--at", "cb"]);
    let centre = Measure::of(&hull()).centroid_m;
    assert!(apart(&a.about(centre).matrix, &matrix(&buoyancy, 0)) < 1e-10);
}

/// Standard uncertainties of an estimate, kg, kg m, kg m².
fn standard(record: &Value, estimate: usize) -> Matrix {
    let coefficients = &record["estimates"][estimate]["coefficients"];
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let name = format!("A{}{}", i.min(j) + 1, i.max(j) + 1);
            coefficients[&name]["standard_uncertainty"].as_f64().unwrap_or_else(|| panic!("{name} of {coefficients}"))
        })
    })
}

/// The covariance of the 21 entries.
fn covariance(record: &Value, estimate: usize) -> Vec<Vec<f64>> {
    let estimate = &record["estimates"][estimate];
    assert_eq!(estimate["type_a"]["names"].as_array().unwrap().len(), 21);
    let mut matrix: Vec<Vec<f64>> = serde_json::from_value(estimate["type_a"]["matrix"].clone()).unwrap();
    for error in estimate["errors"].as_object().unwrap().values() {
        let s: Vec<Vec<f64>> = serde_json::from_value(error["sensitivity"].clone()).unwrap();
        for (row, a) in matrix.iter_mut().zip(&s) {
            for (sum, b) in row.iter_mut().zip(&s) {
                *sum += a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            }
        }
    }
    matrix
}

/// Signs of y and z turned: from y port, z up to y starboard, z down.
const STARBOARD: [f64; 6] = [1.0, -1.0, -1.0, 1.0, -1.0, -1.0];

fn turned(a: &Matrix) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| STARBOARD[i] * STARBOARD[j] * a[i][j]))
}

/// Three meshes of the hull: 64, 256 and 1,024 panels.
const THREE_MESHES: [&str; 6] = ["--density", "1000 kg/m^3", "--most-panels", "1024", "--tolerance", "0.001 %"];

#[test]
fn body_axes_turn_matrix_and_covariance_however_the_mesh_lies() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // The same hull, as drawing programs have it: z up; z down; x aft; y up; all three axes exchanged.
    let lies: [(&str, fn(Vec3) -> Vec3, &[&str]); 5] = [
        ("hull.obj", |v| v, &[]),
        ("down.obj", |[x, y, z]| [x, -y, -z], &["--up", "-z"]),
        ("aft.obj", |[x, y, z]| [-x, -y, z], &["--forward", "-x"]),
        ("y-up.obj", |[x, y, z]| [x, z, -y], &["--forward", "x", "--up", "y"]),
        ("turned.obj", |[x, y, z]| [-z, x, -y], &["--forward", "y", "--up", "-x"]),
    ];
    for (name, place, _) in &lies {
        write(at, name, &hull().mapped(place));
    }
    let of = |name: &str, args: &[&str]| record(at, &[&[name], args, &THREE_MESHES[..]].concat());
    let own = of("hull.obj", &[]);
    let [a, u] = [matrix(&own, 0), standard(&own, 0)];
    assert_eq!(own["estimates"][0]["frame"]["words"], "axes of the mesh, z up");
    // The bow is not the stern, the keel is not the deck: every coupling is there, and of ned the usual three have the other sign.
    let ned = of("hull.obj", &["--axes", "ned"]);
    let down = matrix(&ned, 0);
    for (i, j) in [(0, 4), (1, 3), (3, 5)] {
        assert!(a[i][j].abs() > 1e-2 * (a[i][i] * a[j][j]).sqrt(), "A{}{} is {}", i + 1, j + 1, a[i][j]);
        assert_eq!(down[i][j], -a[i][j]);
    }
    assert_eq!((down, standard(&ned, 0)), (turned(&a), u), "turned, and every uncertainty kept");
    let sign: Vec<f64> = (0..6).flat_map(|i| (i..6).map(move |j| STARBOARD[i] * STARBOARD[j])).collect();
    let c = covariance(&own, 0);
    let expected: Vec<Vec<f64>> = (0..21).map(|i| (0..21).map(|j| sign[i] * sign[j] * c[i][j]).collect()).collect();
    assert_eq!(covariance(&ned, 0), expected);
    // Half of the interval of 95 % squared on its diagonal, and no correlation beyond one.
    for (k, (i, j)) in (0..6).flat_map(|i| (i..6).map(move |j| (i, j))).enumerate() {
        assert!((c[k][k] / u[i][j].powi(2) - 1.0).abs() < 1e-12);
        assert!((0..21).all(|l| c[k][l].powi(2) <= c[k][k] * c[l][l] * (1.0 + 1e-9)));
    }
    for (axes, expected, words) in [
        ("enu", a, "x forward, y port, z up (ROS REP 103)"),
        ("ned", down, "x forward, y starboard, z down (SNAME, Fossen)"),
        ("fossen", down, "x forward, y starboard, z down (SNAME, Fossen)"),
    ] {
        for (name, _, how) in &lies {
            let found = of(name, &[&["--axes", axes], *how].concat());
            assert!(apart(&expected, &matrix(&found, 0)) < 1e-9, "{name} {axes}: {:?}", matrix(&found, 0));
            let scale = |i: usize, j: usize| (a[i][i] * a[j][j]).sqrt();
            let w = standard(&found, 0);
            assert!(
                (0..36).all(|k| (w[k / 6][k % 6] - u[k / 6][k % 6]).abs() < 1e-9 * scale(k / 6, k % 6)),
                "{name} {axes}"
            );
            let frame = found["estimates"][0]["frame"]["words"].as_str().unwrap();
            assert!(frame.starts_with(words), "{frame}");
            if *name == "turned.obj" {
                assert!(frame.ends_with("; in the mesh y is forward and -x up"), "{frame}");
            }
        }
    }
}

/// The frame of a record with y to starboard and z down, about a point of a mesh with z up.
fn starboard(origin_m: Vec3) -> Frame {
    Frame { origin_m, axes: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]] }
}

#[test]
fn a_turn_with_a_shift_keeps_the_energy_and_an_ellipsoid_is_lambs_about_any_point() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let of = |args: &[&str]| matrix(&record(at, &[&["hull.obj"], args, &ONE_MESH[..]].concat()), 0);
    let (a, b) = (of(&[]), of(&["--axes", "ned", "--at", "-0.3 m, 20 cm, 100 mm"]));
    let t = Frame::at([0.0; 3]).motions_from(&starboard([-0.3, 0.2, 0.1]));
    assert!(apart(&congruent(&a, &t), &b) < 1e-10);
    let there = [0.7, -0.2, 0.4, 0.9, -1.3, 0.6];
    let here: [f64; 6] = t.map(|row| row.iter().zip(there).map(|(t, v)| t * v).sum());
    let energy = |m: &Matrix, v: &[f64; 6]| (0..36).map(|k| 0.5 * v[k / 6] * m[k / 6][k % 6] * v[k % 6]).sum::<f64>();
    assert!((energy(&a, &here) / energy(&b, &there) - 1.0).abs() < 1e-10);

    // An ellipsoid whose point lies astern of its centre and below it; the body file says where its centre of gravity is.
    let gravity = EGG.to_owned() + "centre_of_gravity = [\"-0.3 m\", \"0 m\", \"-10 cm\"]\n";
    let exact = ellipsoid_added_mass([0.5, 0.3, 0.2]).unwrap();
    let lamb: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1025.0 * exact[i] } else { 0.0 }));
    for (axes, z) in [("ned", -0.1), ("enu", 0.1)] {
        let found = of_shape(&gravity, &["--axes", axes, "--at", "cg", "--tolerance", "0.2 %"]);
        let (a, u) = (matrix(&found, 0), standard(&found, 0));
        let point = &found["estimates"][0]["point"]["words"];
        assert_eq!(
            point,
            "(−0.3, 0, −0.1) m from the origin of the mesh, in the axes of the mesh (the centre of gravity)"
        );
        for (i, j, expected) in [
            (0, 4, z * lamb[0][0]),
            (1, 3, -z * lamb[1][1]),
            (1, 5, 0.3 * lamb[1][1]),
            (2, 4, -0.3 * lamb[2][2]),
            (3, 5, -z * 0.3 * lamb[1][1]),
            (3, 3, lamb[3][3] + z * z * lamb[1][1]),
            (4, 4, lamb[4][4] + z * z * lamb[0][0] + 0.09 * lamb[2][2]),
            (5, 5, lamb[5][5] + 0.09 * lamb[1][1]),
        ] {
            let error = (a[i][j] - expected).abs();
            assert!(
                error < 2.0 * u[i][j] + 1e-9,
                "{axes} A{}{}: {} ± {} and {expected}",
                i + 1,
                j + 1,
                a[i][j],
                2.0 * u[i][j]
            );
            assert!(u[i][j] < 1e-3 * (a[i][i] * a[j][j]).sqrt());
        }
    }
}

#[test]
fn axes_hold_with_a_surface_a_tank_links_a_chain_and_parts() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    write(at, "two.obj", &cube(0.3).with(&hull().mapped(|[x, y, z]| [x, y + 1.0, z])));
    std::fs::write(at.join("r.toml"), body_file(ROBOT)).unwrap();
    let cases: [(&[&str], usize); 4] = [
        (&["hull.obj", "--surface", "0.6 m", "--most-panels", "64", "--density", "1000 kg/m^3"], 3),
        (
            &[
                "hull.obj",
                "--surface",
                "1 m",
                "--tank",
                "6 m x 4 m x 2 m",
                "--most-panels",
                "64",
                "--density",
                "1000 kg/m^3",
            ],
            3,
        ),
        (&["r.toml", "--links", "2", "--tolerance", "20 %"], 1),
        (&["r.toml", "--links", "1,2", "--tolerance", "20 %"], 2),
    ];
    for (args, estimates) in cases {
        let of = |axes: &[&str]| record(at, &[args, axes].concat());
        let (own, ned) = (of(&[]), of(&["--axes", "ned"]));
        for estimate in 0..estimates {
            let (a, b) = (matrix(&own, estimate), matrix(&ned, estimate));
            // As for numbers: zeros have no sign.
            assert!((0..36).all(|k| turned(&a)[k / 6][k % 6] == b[k / 6][k % 6]), "{args:?} {estimate}: {a:?} {b:?}");
            let frame = ned["estimates"][estimate]["frame"]["words"].as_str().unwrap();
            assert!(frame.starts_with("x forward, y starboard, z down"), "{frame}");
        }
    }
    // Part by part: every block is turned, each part keeps its own point; the files for wave programs do not notice.
    let parts: [&[&str]; 2] = [
        &["two.obj", "--apart", "--density", "1000 kg/m^3", "--most-panels", "300", "--export", "wamit"],
        &["r.toml", "--links", "1", "--joint-angle", "12 deg", "--most-panels", "1500", "--export", "wamit"],
    ];
    for args in parts {
        let of = |axes: &[&str]| record(at, &[args, axes].concat());
        let wamit = || {
            let folder = if args[0] == "two.obj" { "two-added-mass" } else { "r-added-mass" };
            std::fs::read_to_string(at.join(folder).join("added-mass.1")).unwrap()
        };
        let own = of(&[]);
        let of_waves = wamit();
        let ned = of(&["--axes", "fossen"]);
        assert_eq!(wamit(), of_waves, "{args:?}");
        let frame = ned["estimates"][0]["frame"]["words"].as_str().unwrap();
        assert!(frame.contains("starboard, z down (SNAME, Fossen)"), "{frame}");
        for (name, own) in own["estimates"][0]["coefficients"].as_object().unwrap() {
            // A22_1_3: rows and columns of the part's own matrix, then the parts.
            let motions = name[1..3].chars().map(|k| k.to_digit(10).unwrap() as usize - 1);
            let sign = motions.map(|k| STARBOARD[k]).product::<f64>();
            let ned = &ned["estimates"][0]["coefficients"][name];
            let value = |c: &Value| c["value"].as_f64().unwrap();
            let size = 1e-9 * (1.0 + value(own).abs());
            assert!((value(ned) - sign * value(own)).abs() < size, "{args:?} {name}: {} {}", value(own), value(ned));
        }
    }
}

#[test]
fn files_for_wave_programs_keep_their_frame_whatever_the_record_has() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let of = |args: &[&str], out: &str| {
        let all = [&["hull.obj", "--export", "wamit,capytaine,csv", "--out", out], args, &ONE_MESH[..]].concat();
        (lines(at, &all), wamit_limits(&at.join(out).join("added-mass.1"))[0])
    };
    let (_, plain) = of(&[], "plain");
    let (said, turned) = of(&["--axes", "ned", "--at", "0.3 m, -20 cm, 0.1 m"], "turned");
    for i in 0..6 {
        for j in 0..6 {
            let size = (plain[i][i] * plain[j][j]).sqrt();
            assert!((plain[i][j] - turned[i][j]).abs() < 1e-12 * size * 10.0, "{i} {j}");
        }
    }
    assert!(
        said.contains(
            "The files for WAMIT and Capytaine are about the origin of the mesh, in the axes of the mesh, z up"
        ),
        "{said}"
    );
    assert!(said.contains("The CSV has the axes and the point of the record."), "{said}");
    let record = matrix(&serde_json::from_slice(&std::fs::read(at.join("turned/estimate.json")).unwrap()).unwrap(), 0);
    let table = read_table(&at.join("turned/added-mass.csv"), None).unwrap();
    assert_eq!(table.number("A11", Dimension::MASS).unwrap(), [record[0][0]; 2]);
    let with_length = Dimension::MASS.checked_mul(Dimension::LENGTH).unwrap();
    assert_eq!(table.number("A15", with_length).unwrap(), [record[0][4]; 2]);
}

#[test]
fn page_and_terminal_have_the_matrix_once_with_its_frame() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let once = |args: &[&str], tables: usize| {
        let text = lines(at, &[&["hull.obj", "--axes", "ned", "--at", "cb"], args, &ONE_MESH[..]].concat());
        let page = std::fs::read_to_string(at.join("hull-added-mass/report.html")).unwrap();
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        // On the page every estimate says its point once more, beside its coefficients.
        for (said, estimates) in [(words(&text), 0), (words(&page), tables)] {
            assert_eq!(said.matches("force in the first three rows and moment").count(), tables, "{said}");
            assert_eq!(said.matches("Frame: x forward, y starboard, z down (SNAME, Fossen); in the mesh x is forward and z up; moments about (").count(), 1, "{said}");
            assert_eq!(said.matches("(the centre of buoyancy)").count(), 1 + estimates, "{said}");
        }
    };
    once(&[], 1);
    once(&["--surface", "0.6 m"], 3);
}

/// The displacement has no uncertainty: it is that of the dimensions, or of the facets, and the page says which.
#[test]
fn the_volume_is_exact_and_says_of_what() {
    use std::f64::consts::PI;
    let section = "major_semi_axis = \"90 mm\"\nminor_semi_axis = \"60 mm\"\n";
    let area = PI * 0.09 * 0.06;
    let capsule = format!("shape = \"capsule\"\nlength = \"0.8 m\"\n{section}ends = {{ length = \"100 mm\" }}\n");
    let cylinder = format!("shape = \"cylinder\"\nlength = \"0.8 m\"\n{section}");
    let volume = |out: &Value| out["estimates"][0]["refers_to"]["volume"]["value"].as_f64().unwrap();
    for (shape, exact_m3) in [
        (EGG, 4.0 / 3.0 * PI * 0.5 * 0.3 * 0.2),
        (capsule.as_str(), area * 0.6 + 4.0 / 3.0 * area * 0.1),
        (cylinder.as_str(), area * 0.8),
    ] {
        let found = volume(&of_shape(shape, &["--tolerance", "5 %"]));
        assert!((found / exact_m3 - 1.0).abs() < 1e-12, "{shape}: {found} for {exact_m3}");
    }
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("body.toml"), body_file(EGG)).unwrap();
    let row = |text: &str| text.lines().find(|l| l.trim_start().starts_with("volume")).unwrap().to_owned();
    let text = lines(at, &["body.toml", "--tolerance", "5 %"]);
    assert!(row(&text).contains("0.125664 m³, exact for the given dimensions"), "{}", row(&text));
    write(at, "hull.obj", &hull());
    let (text, out) =
        (lines(at, &[&["hull.obj"], &ONE_MESH[..]].concat()), record(at, &[&["hull.obj"], &ONE_MESH[..]].concat()));
    assert!(row(&text).contains(" m³, exactly that of the facets"), "{}", row(&text));
    assert!((volume(&out) / Measure::of(&hull()).volume_m3 - 1.0).abs() < 1e-6);
}

/// Two matrices of one body in two frames look alike.
#[test]
fn a_record_in_another_frame_is_replaced_with_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    let run = |args: &[&str]| {
        let output = froude(at, &[&["hull.obj"], args, &ONE_MESH[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let words = |bytes: &[u8]| String::from_utf8_lossy(bytes).split_whitespace().collect::<Vec<_>>().join(" ");
        [words(&output.stdout), words(&output.stderr)]
    };
    let word = "The earlier record in hull-added-mass is replaced. It had another frame: axes of the mesh, z up; moments about the origin of \
                the mesh. To keep both, give each its folder with --out.";
    assert!(!run(&[])[0].contains("is replaced"));
    assert!(!run(&[])[0].contains("is replaced"), "the same frame again");
    assert!(run(&["--axes", "ned"])[0].contains(word));
    assert!(
        run(&["--axes", "ned", "--at", "cb"])[0]
            .contains("is replaced. It had another frame: x forward, y starboard, z down (SNAME")
    );
    run(&[]);
    let [out, err] = run(&["--axes", "enu", "--json"]);
    assert!(out.starts_with('{') && err.contains(word), "{err}");
    // The record itself is the same whatever lay there.
    let here = std::fs::read(at.join("hull-added-mass/estimate.json")).unwrap();
    run(&["--axes", "enu", "--out", "fresh"]);
    assert_eq!(here, std::fs::read(at.join("fresh/estimate.json")).unwrap());
}

#[test]
fn millimetres_scale_by_their_powers() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "hull.obj", &hull());
    let of = |unit: &str| matrix(&record(folder.path(), &[&["hull.obj", "--unit", unit], &ONE_MESH[..]].concat()), 0);
    let (metres, millimetres) = (of("m"), of("mm"));
    let scaled = core::array::from_fn(|i| {
        core::array::from_fn(|j| millimetres[i][j] * [1e9, 1e12, 1e15][usize::from(i > 2) + usize::from(j > 2)])
    });
    assert!(apart(&metres, &scaled) < 1e-10);
}

#[test]
fn a_surface_has_two_limits_about_the_unbounded_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    write(at, "down.obj", &hull().mapped(|[x, y, z]| [x, -y, -z]));
    let of = |args: &[&str]| record(at, &[args, &ONE_MESH[..]].concat());
    let free = matrix(&of(&["hull.obj"]), 0);
    let near = of(&["hull.obj", "--surface", "0.45 m", "--export", "wamit"]);
    let (lid, fast) = (matrix(&near, 1), matrix(&near, 2));
    assert!(apart(&free, &matrix(&near, 0)) < 1e-12);
    assert!(lid[2][2] > 1.03 * free[2][2] && fast[2][2] < 0.97 * free[2][2], "{lid:?} {free:?} {fast:?}");
    let written = wamit_limits(&at.join("hull-added-mass/added-mass.1"));
    assert!((written[0][2][2] / lid[2][2] - 1.0).abs() < 1e-12);
    assert!((written[1][2][2] / fast[2][2] - 1.0).abs() < 1e-12);
    // The surface lies above the origin, wherever z points.
    let down = of(&["down.obj", "--surface", "0.45 m", "--up", "-z"]);
    for (estimate, up) in [lid, fast].into_iter().enumerate() {
        let down = matrix(&down, estimate + 1);
        assert!((0..6).all(|i| (down[i][i] / up[i][i] - 1.0).abs() < 1e-9), "{down:?} {up:?}");
    }
    // Far below, both limits are that of unbounded water.
    let deep = of(&["hull.obj", "--surface", "30 m"]);
    assert!((1..3).all(|estimate| apart(&free, &matrix(&deep, estimate)) < 1e-4));
}

#[test]
fn one_mesh_has_no_uncertainty_and_none_is_made_up() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "hull.obj", &hull());
    let text = lines(folder.path(), &[&["hull.obj"], &ONE_MESH[..]].concat());
    for sentence in [
        "One mesh only: there is no numerical uncertainty; three meshes give one.",
        "There is no finer one: the next mesh has 256 panels, and 64 are allowed (--most-panels).",
        "is unknown and not included in the uncertainty: panels or memory do not allow a second mesh",
    ] {
        assert!(text.contains(sentence), "{sentence}: {text}");
    }
    let out = record(folder.path(), &[&["hull.obj"], &ONE_MESH[..]].concat());
    assert!(out["estimates"][0]["coefficients"]["A11"]["standard_uncertainty"].is_null());
    assert_eq!(
        out["findings"][0]["message"],
        "Deeply submerged: the numerical uncertainty is not known: the next mesh has 256 panels, and 64 are allowed (--most-panels)"
    );
}

#[test]
fn a_check_computes_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "hull.obj", &hull());
    std::fs::write(at.join("body.toml"), body_file(ROBOT)).unwrap();
    let text = lines(at, &["hull.obj", "--check"]);
    assert!(text.starts_with("hull.obj: fit for use\n") && text.contains("16\u{202f}384"), "{text}");
    let text = lines(at, &["body.toml", "--check", "--links", "1..2"]);
    assert!(text.contains("it, H1LT: fit for use") && text.contains("it, H2LT: fit for use"), "{text}");
    let told = record(at, &["body.toml", "--check", "--links", "1..2"]);
    assert_eq!(told["bodies"][1]["name"], "it, H2LT");
    assert!(told["bodies"][1]["meshes"][0]["panels"].as_u64().unwrap() > 100);
    assert_eq!(names(at), ["body.toml", "hull.obj"]);
}

#[test]
fn a_repair_writes_a_mesh_that_is_fit_for_use() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let mut mesh = hull();
    mesh.panels[9] = mesh.panels[9].turned();
    mesh.panels.push(mesh.panels[20]);
    write(at, "bad.obj", &mesh);
    for target in ["good.obj", "good.stl"] {
        let text = lines(at, &["bad.obj", "--repair", target]);
        assert!(text.trim_end().ends_with(&format!("Next: froude added-mass {target}")), "{text}");
        assert!(lines(at, &[target, "--check"]).contains("fit for use"));
    }
    let told = record(at, &["bad.obj", "--repair", "third.obj"]);
    assert_eq!((told["written"].as_str(), told["left"].as_array().map(Vec::len)), (Some("third.obj"), Some(0)));
}

/// Runs on files of a fresh folder; asserts the exit code, the message and that nothing was made.
fn fails(code: i32, files: &[(&str, &[u8])], args: &[&str], message: &str) {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let before = names(folder.path());
    let output = froude(folder.path(), args);
    assert_eq!(said(&output), format!("froude: {message}"), "exact message of {args:?}");
    assert_eq!(output.status.code(), Some(code), "exit code of {args:?}");
    assert_eq!(names(folder.path()), before, "nothing is written by {args:?}");
}

fn refuses(files: &[(&str, &[u8])], args: &[&str], message: &str) {
    fails(2, files, args, message);
}

const WATER: [&str; 2] = ["--density", "1000 kg/m^3"];

/// A mesh that potential flow cannot be computed on, with what is wrong.
fn refuses_mesh(mesh: &Mesh, wrong: &str) {
    refuses(
        &[("m.obj", write_obj(mesh).as_bytes())],
        &[&["m.obj"], &WATER[..]].concat(),
        &format!("m.obj: potential flow cannot be computed on this mesh:\n{wrong}{}", advice(wrong)),
    );
}

/// No repair unites bodies that cross, or knows which of two nested ones the water touches.
fn advice(wrong: &str) -> &'static str {
    let is_nested = wrong.contains("lies inside") || wrong.contains("lie inside");
    if wrong.contains("cross or touch") || (is_nested && !wrong.contains("inside the hull")) {
        return "";
    }
    "\n  froude added-mass m.obj --repair repaired.obj writes a mesh with the unambiguous faults corrected"
}

fn cube(side_m: f64) -> Mesh {
    let vertices = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2].map(|bit| side_m * f64::from(bit))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh { vertices, panels: quads.map(|[a, b, c, d]| Panel::quad(a, b, c, d)).to_vec() }
}

/// Corners that files write once for each panel, and with other rounding each time, as programs do.
#[test]
fn corners_at_one_place_are_one_vertex_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let whole = ellipsoid([3.0, 1.5, 1.0], 4, 3);
    write(at, "whole.obj", &whole);
    // Up to 1e-8 m, a six-hundred-millionth of the length: far below a millionth, far above the rounding of a file.
    let corners: Vec<Vec<Vec3>> = whole.panels.iter().map(|p| whole.corners(*p).collect()).collect();
    let shaken = |k: usize, v: Vec3| core::array::from_fn(|i| v[i] + 1e-8 * ((7 * k + 3 * i) % 11) as f64 / 10.0);
    let shaken = |k: usize| corners[k].iter().map(move |v| shaken(k, *v));
    let all = || (0..corners.len()).flat_map(shaken);
    let (mut ascii, mut obj, mut faces) = (String::from("solid egg\n"), String::new(), String::new());
    let (mut gdf, mut nemoh, mut panels) =
        (format!("egg\n1 9.81\n0 0\n{}\n", corners.len()), String::from("2 0\n"), String::new());
    let mut msh = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", all().count());
    let mut next = 1;
    for k in 0..corners.len() {
        let own: Vec<Vec3> = shaken(k).collect();
        for triangle in [[0, 1, 2], [0, 2, 3]].iter().take(own.len() - 2) {
            ascii += "facet normal 0 0 0\nouter loop\n";
            for c in triangle {
                ascii += &format!("vertex {} {} {}\n", own[*c][0], own[*c][1], own[*c][2]);
            }
            ascii += "endloop\nendfacet\n";
        }
        let four: Vec<usize> = (0..4).map(|c| c.min(own.len() - 1)).collect();
        for c in &four {
            gdf += &format!("{} {} {}\n", own[*c][0], own[*c][1], own[*c][2]);
        }
        panels += &four.iter().map(|c| (next + c).to_string()).collect::<Vec<_>>().join(" ");
        panels += "\n";
        faces += &format!("f {}\n", (0..own.len()).map(|c| (next + c).to_string()).collect::<Vec<_>>().join(" "));
        next += own.len();
    }
    for (k, [x, y, z]) in (1..).zip(all()) {
        obj += &format!("v {x} {y} {z}\n");
        nemoh += &format!("{k} {x} {y} {z}\n");
        msh += &format!("{k} {x} {y} {z}\n");
    }
    nemoh += &format!("0 0. 0. 0.\n{panels}0 0 0 0\n");
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\nproperty list \
         uchar int vertex_indices\nend_header\n{}{}",
        next - 1,
        corners.len(),
        obj.replace("v ", ""),
        faces.lines().map(|f| format!("{} {}\n", f.split(' ').count() - 1, zero_based(&f[2..]))).collect::<String>()
    );
    msh += &format!("$EndNodes\n$Elements\n{}\n", corners.len());
    for (k, face) in (1..).zip(faces.lines()) {
        let kind = if face.split(' ').count() == 4 { 2 } else { 3 };
        msh += &format!("{k} {kind} 2 0 1 {}\n", &face[2..]);
    }
    msh += "$EndElements\n";
    let files = [
        ("egg.stl", ascii + "endsolid egg\n"),
        ("egg.obj", obj.clone() + &faces),
        ("egg.ply", ply),
        ("egg.gdf", gdf),
        ("egg.dat", nemoh),
        ("egg.msh", msh),
    ];
    let options = ["--polyhedron", "--density", "1000 kg/m^3", "--tolerance", "20 %"];
    let exact = matrix(&record(at, &[&["whole.obj"], &options[..]].concat()), 0);
    for (name, content) in files {
        std::fs::write(at.join(name), content).unwrap();
        let text = lines(at, &[&[name], &options[..]].concat());
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(" merged (closer than 0.000006"), "{name}: {text}");
        let a = matrix(&record(at, &[&[name], &options[..]].concat()), 0);
        for i in 0..6 {
            let part = a[i][i] / exact[i][i];
            let allowed = if name == "egg.stl" { DIVIDED } else { SHAKEN };
            assert!((part - 1.0).abs() < allowed, "{name}, A{0}{0}: {1} of {2}", i + 1, a[i][i], exact[i][i]);
        }
    }
}

/// 1e-8 m on semi-axes of 1 m and more change an inertia, which goes with the fifth power of a length, by 5e-8 at most; twice that.
const SHAKEN: f64 = 1e-7;
/// An STL divides every quadrilateral into two triangles, and the meshes of the others have the quadrilaterals.
const DIVIDED: f64 = 1e-3;

/// Numbers that count from 1, counted from 0.
fn zero_based(numbers: &str) -> String {
    let each = numbers.split(' ').map(|n| (n.parse::<usize>().unwrap() - 1).to_string());
    each.collect::<Vec<_>>().join(" ")
}

/// A box of 4 × 2 × 1 m below z = 0, closed by a lid in that plane.
#[test]
fn a_hull_closed_by_a_lid_at_the_surface_is_not_deeply_submerged() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let boxed = cube(1.0).mapped(|[x, y, z]| [4.0 * x - 2.0, 2.0 * y - 1.0, z - 1.0]);
    let mut gdf = format!("barge\n1 9.80665\n0 0\n{}\n", boxed.panels.len());
    for v in boxed.panels.iter().flat_map(|p| boxed.corners(*p)) {
        gdf += &format!("{} {} {}\n", v[0], v[1], v[2]);
    }
    refuses(
        &[("barge.gdf", gdf.as_bytes())],
        &[&["barge.gdf"], &WATER[..]].concat(),
        "barge.gdf: the mesh is closed by 1 panel in the plane z = 0, which is the water's surface in a WAMIT GDF file: this is a floating hull, and floating \
         bodies are not computed here. If the body is submerged, state where the surface is: --surface \"5 m\" puts it 5 m above the origin of the mesh",
    );
    // Other formats do not define where the surface is.
    write(at, "barge.obj", &boxed);
    let text = lines(at, &[&["barge.obj", "--tolerance", "20 %", "--out", "a"], &WATER[..]].concat());
    assert!(text.contains("lid-at-zero"), "{text}");
    std::fs::write(at.join("barge.gdf"), gdf).unwrap();
    let text =
        lines(at, &[&["barge.gdf", "--surface", "5 m", "--tolerance", "20 %", "--out", "b"], &WATER[..]].concat());
    assert!(text.contains("Zero-frequency limit") && !text.contains("lid-at-zero"), "{text}");
}

#[test]
fn a_mesh_that_is_no_body_is_reported_panel_by_panel() {
    let changed = |change: fn(&mut Mesh)| {
        let mut mesh = cube(1.0);
        change(&mut mesh);
        mesh
    };
    refuses_mesh(
        &changed(|m| _ = m.panels.pop()),
        "  4 edges have one panel only, the first from [1.0, 0.0, 0.0] to [1.0, 1.0, 0.0] m: the surface is open there\n  where it looks closed and is not, corners lie within edges of \
         neighbours (T-junctions): let the CAD program mesh it again",
    );
    refuses_mesh(
        &changed(|m| m.panels[2] = m.panels[2].turned()),
        "  4 edges are traversed twice in the same direction, the first from [0.0, 0.0, 0.0] to [1.0, 0.0, 0.0] m: neighbours are oriented against each other",
    );
    // Here no repair helps.
    refuses(
        &[("m.obj", write_obj(&changed(|m| m.vertices[3][1] = f64::NAN)).as_bytes())],
        &[&["m.obj"], &WATER[..]].concat(),
        "m.obj: potential flow cannot be computed on this mesh:\n  vertex 3 has the coordinates [1.0, NaN, 0.0]: each must be a finite \
         number",
    );
    refuses_mesh(
        &changed(|m| m.panels.push(m.panels[1])),
        "  panel 6 at [0.5, 0.5, 1.0] m is there twice (also as 1); take one out\n  4 edges have three panels or more, the first from \
         [0.0, 0.0, 1.0] to [1.0, 0.0, 1.0] m: surfaces touch there",
    );
    let with_a_line = changed(|m| {
        m.vertices.push([0.5, 0.0, 0.0]);
        m.panels[2] = Panel::quad(8, 1, 5, 4);
        m.panels.extend([Panel::triangle(0, 8, 4), Panel::triangle(0, 1, 8)]);
    });
    refuses_mesh(&with_a_line, "  panel 7 at [0.0, 0.0, 0.0] m has no area; take it out, or merge its corners");
    refuses_mesh(
        &changed(|m| m.panels.push(Panel::quad(0, 1, 7, 6))),
        "  1 panel lies inside the hull, which is closed without them, as a deck or a bulkhead is, the first at [0.5, 0.5, 0.5] m: no water \
         reaches them; take them out",
    );
    refuses_mesh(
        &cube(1.0).with(&cube(0.2).mapped(|v| v.map(|x| x + 0.5))),
        "  part 1 (6 panels, at [0.5, 0.5, 0.5] m, volume 8.0000e-3 m³) lies inside part 0: no water reaches it; take it out",
    );
}

/// Two cubes through one another, and two that were drawn side by side: 1.875 and 2 m³.
#[test]
fn solids_through_one_another_are_one_body_and_the_page_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "m.obj", &cube(1.0).with(&cube(1.0).mapped(|v| v.map(|x| x + 0.5))));
    write(at, "wide.obj", &cube(1.0).with(&cube(1.0).mapped(|[x, y, z]| [x + 1.0, y, z])));
    let start = "2 solids that overlap or touch, the first at [0.0, 0.0, 0.0] m, were united: of 12 panels there are ";
    for (name, volume) in [("m.obj", "1.8750e0"), ("wide.obj", "2.0000e0")] {
        let text = unwrapped(&lines(at, &[&[name, "--check"], &WATER[..]].concat()));
        let end = format!("of 2.0000e0 m³ there are {volume} m³");
        assert!(text.contains(start) && text.contains(&end), "{text}");
        let text = lines(at, &[name, "--repair", &format!("one-{name}")]);
        assert!(text.trim_end().ends_with(&format!("Next: froude added-mass one-{name}")), "{text}");
    }
    // A box of 2 m has the added mass of the two cubes that it was drawn as, but for their panels.
    let mut long = cube(1.0);
    long.vertices.iter_mut().for_each(|v| v[0] *= 2.0);
    write(at, "long.obj", &long);
    let [two, one] = ["wide.obj", "long.obj"].map(|name| record(at, &[&[name, "--polyhedron"], &WATER[..]].concat()));
    for axis in 1..4 {
        let name = format!("A{axis}{axis}");
        let [two, one] = [&two, &one].map(|record| interval(record, &name));
        assert!(two[0] <= one[1] && one[0] <= two[1], "{name}: {two:?} {one:?}");
    }
    let output = froude(at, &[&["m.obj", "--apart"], &WATER[..]].concat());
    assert!(said(&output).contains("unite the bodies, or move them apart"), "{}", said(&output));
}

/// An STL as programs write it: corners in single precision at poles that are closed but for rounding, and normals that point inward.
#[test]
fn an_stl_of_an_ellipsoid_is_merged_turned_and_computed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let point = |i: u32, j: u32| {
        let (th, ph) = (f64::from(i) / 24.0 * std::f64::consts::PI, f64::from(j % 32) / 16.0 * std::f64::consts::PI);
        [3.0 * th.cos(), 1.5 * th.sin() * ph.cos(), th.sin() * ph.sin()]
    };
    let mut mesh = Mesh::default();
    let mut push = |corners: [Vec3; 3]| {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(corners);
        mesh.panels.push(Panel::triangle(first, first + 1, first + 2));
    };
    for i in 0..24 {
        for j in 0..32 {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            if i < 23 {
                push([a, c, b]);
            }
            if i > 0 {
                push([a, d, c]);
            }
        }
    }
    std::fs::write(at.join("ellipsoid.stl"), write_stl_binary(&mesh)).unwrap();
    let text = unwrapped(&lines(at, &[&["ellipsoid.stl", "--check"], &WATER[..]].concat()));
    assert!(text.contains("31 vertices merged (closer than 0.000006 m)"), "{text}");
    assert!(text.contains("the surface was inside out: all of its 1472 panels were turned"), "{text}");
    let record = record(at, &[&["ellipsoid.stl"], &WATER[..]].concat());
    for (i, exact) in [2979.7, 9605.5, 20911.8].into_iter().enumerate() {
        let [low, high] = interval(&record, &format!("A{0}{0}", i + 1));
        assert!(low <= exact && exact <= high && high - low < 0.04 * exact, "{low} {exact} {high}");
    }
}

/// The interval of a coefficient.
fn interval(record: &Value, name: &str) -> [f64; 2] {
    [0, 1].map(|i| record["estimates"][0]["coefficients"][name]["interval_95"][i].as_f64().unwrap())
}

fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A mesh of a robot's link as Blender and others write it: inches, y up, two cubes of 2 and 1 in through one another.
const LINK: &str = r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="inch" meter="0.0254"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="cube"><mesh><source id="s"><float_array id="a" count="24">0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 3 0 3 1 4 5 7 4 7 6 0 1 5 0 5 4 2 6 7 2 7 3 0 4 6 0 6 2 1 3 7 1 7 5</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node><scale>2 2 2</scale><instance_geometry url="#cube"/></node>
<node><translate>1.5 0.5 0.5</translate><instance_geometry url="#cube"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##;

/// 8 + 1 − ½ in³.
#[test]
fn a_link_of_a_robot_as_collada_is_read_in_its_unit_and_united() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("link.dae"), LINK).unwrap();
    let text = unwrapped(&lines(at, &[&["link.dae", "--check"], &WATER[..]].concat()));
    assert!(text.contains("turned from y up, as the file states, to z up"), "{text}");
    assert!(text.contains("the unit is 0.0254 m, as the file states"), "{text}");
    let volume = format!("there are {:.4e} m³", 8.5 * 0.0254_f64.powi(3));
    assert!(text.contains(&volume), "{volume}: {text}");
    let text = unwrapped(&lines(at, &[&["link.dae", "--check", "--unit", "mm"], &WATER[..]].concat()));
    assert!(text.contains("the file states a unit of 0.0254 m; --unit, 0.001 m, counts"), "{text}");
    refuses(
        &[("link.dae", LINK.as_bytes())],
        &[&["link.dae", "--up", "y"], &WATER[..]].concat(),
        "link.dae: a Collada file states which axis points up (<up_axis>), and its mesh is turned to z up when it is read; leave --up out, or \
         correct <up_axis> in the file",
    );
}

const UNITS: &str = "write the unit of the mesh: mm, cm, m, in, ft, or a length, \"0.5 m\"; or a scale: 1:50 if the mesh is full-size and the body is a model (\"1:50 mm\": mesh in millimetres), 50:1 if the mesh is model-size and the body is full-size";

/// Added mass grows with the third power of lengths.
#[test]
fn a_unit_may_be_a_length_or_the_scale_of_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "m.obj", &cube(1.0));
    let surge = |unit: &str| {
        matrix(&record(at, &[&["m.obj", "--polyhedron", "--tolerance", "5 %", "--unit", unit], &WATER[..]].concat()), 0)
            [0][0]
    };
    let metre = surge("m");
    for (unit, length) in [
        ("0.5 m", 0.5),
        ("1:50", 0.02),
        ("50:1", 50.0),
        ("1:50 cm", 2e-4),
        ("1:50mm", 2e-5),
        ("ft", 0.3048),
        ("1 : 4 0.5 m", 0.125),
    ] {
        assert!((surge(unit) / metre / f64::powi(length, 3) - 1.0).abs() < 1e-6, "{unit}");
    }
    let text = unwrapped(&lines(at, &[&["m.obj", "--check", "--unit", "1:50"], &WATER[..]].concat()));
    assert!(text.contains("scaled by 0.02: the body's largest dimension is 0.0200 m"), "{text}");
    for unit in ["furlongs", "-1 m", "1:0", "1:", "1:50 kg", "0 m"] {
        refuses(
            &[("m.obj", write_obj(&cube(1.0)).as_bytes())],
            &[&["m.obj", "--unit", unit], &WATER[..]].concat(),
            &format!("--unit {unit:?}: {UNITS}"),
        );
    }
}

#[test]
fn a_mesh_that_is_not_where_or_as_large_as_it_should_be_is_reported() {
    let metre = write_obj(&cube(1.0));
    let small = [("m.obj", metre.as_bytes())];
    let large = write_obj(&cube(200.0));
    refuses(
        &[("m.obj", large.as_bytes())],
        &[&["m.obj"], &WATER[..]].concat(),
        "m.obj: the mesh is 200.0000 m long and encloses 8.0000e6 m³ (doubtful above 50 m); drawn in millimetres it is 0.2000 m and 8.0000e-3 m³, in inches 5.0800 m: give `--unit mm` or `--unit in`, or `--unit m` if it is that large",
    );
    refuses(
        &small,
        &[&["m.obj", "--surface", "0.4 m"], &WATER[..]].concat(),
        "m.obj: 4 panels cross z = 0.4 m, the first 2 from [0.0, 0.0, 0.0] to [1.0, 0.0, 1.0] m: the body pierces the water's surface; bodies that float are not computed here, submerge it",
    );
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "m.obj", &cube(1.0));
    let output = froude(folder.path(), &["m.obj", "--surface", "0.4 m", "--check"]);
    assert_eq!(output.status.code(), Some(2), "a check looks at the surface as well");
    refuses(
        &small,
        &[&["m.obj", "--surface", "-1 m"], &WATER[..]].concat(),
        "m.obj: the body lies above the water's surface at z = -1 m; give --surface the height of the surface over the origin of the mesh, and --up the axis of the mesh that points up, as --up -z",
    );
    refuses(
        &small,
        &[&["m.obj", "--surface", "1 m"], &WATER[..]].concat(),
        "m.obj: panel 1 lies in the water's surface at z = 1 m: bodies that float are not computed here, submerge it",
    );
    refuses(
        &small,
        &[&["m.obj", "--most-panels", "5"], &WATER[..]].concat(),
        "the coarsest mesh has 6 panels, and 5 are allowed; write --most-panels 96, because the numerical uncertainty needs three meshes, or 6 for a value without",
    );
}

#[test]
fn a_file_that_is_no_mesh_is_reported_with_its_place() {
    let stl = write_stl_binary(&cube(1.0));
    let of = |name: &str, content: &[u8], message: &str| {
        refuses(&[(name, content)], &[&[name], &WATER[..]].concat(), message);
    };
    of(
        "m.step",
        b"ISO-10303-21;",
        "m.step: neither extension nor content is that of STL, OBJ, PLY, WAMIT GDF, Nemoh, Gmsh or Collada; give it the extension of its format (.stl .obj .ply .gdf .dat .msh .dae)",
    );
    of("m.stl", b"", "m.stl, byte 0: the file ends where a header of 80 bytes should be; copy or export it again");
    of("m.obj", b"", "m.obj: potential flow cannot be computed on this mesh:\n  the mesh has no panel");
    of("m.toml", b"", "m.toml:1: `schema` is missing; expected schema = 1");
    of(
        "m.stl",
        &stl[..stl.len() - 70],
        "m.stl, byte 614: the file ends where triangle 11 of 12 should be; copy or export it again",
    );
    refuses(&[], &["m.stl"], "cannot read m.stl: there is no such file or folder");
    let told = ". is a folder; froude added-mass takes a body file (.toml) or a closed mesh (.stl, .obj, …). Name a file in it";
    refuses(&[], &["."], told);
}

#[test]
fn what_an_option_was_called_is_reported_with_its_new_name() {
    let metre = write_obj(&cube(1.0));
    let told = |args: &[&str], message: &str| {
        refuses(&[("m.obj", metre.as_bytes())], &[&["m.obj"], &WATER[..], args].concat(), message);
    };
    let z = |up| {
        format!("--z is now --up: write {up} for how the mesh lies, and --axes ned or enu for the axes of the result")
    };
    told(&["--z", "down"], &z("--up -z"));
    told(&["--z", "up"], &z("--up z"));
    told(&["--origin", "buoyancy"], "--origin is now --at: write --at cb");
    told(&["--origin", "0 m, 0 m, -0.2 m"], "--origin is now --at: write --at \"0 m, 0 m, -0.2 m\"");
}

#[test]
fn a_frame_that_cannot_be_is_refused_with_what_to_do() {
    let metre = write_obj(&cube(1.0).with(&cube(1.0).mapped(|[x, y, z]| [x + 3.0, y, z])));
    let (robot, egg) = (body_file(ROBOT), body_file(EGG));
    let files = [("m.obj", metre.as_bytes()), ("r.toml", robot.as_bytes()), ("e.toml", egg.as_bytes())];
    let told = |args: &[&str], message: &str| refuses(&files, &[args, &WATER[..]].concat(), message);
    told(
        &["m.obj", "--up", "-x"],
        "--forward x and --up -x lie along one axis of the mesh: give both, two different ones",
    );
    for args in [
        &["e.toml", "--up", "z"][..],
        &["r.toml", "--links", "2", "--forward", "-x"],
        &["r.toml", "--links", "2", "--chain", "--up", "y"],
    ] {
        let message = format!(
            "{}: --forward and --up are for a mesh; a body file has x forward along the body and z up",
            args[0]
        );
        told(args, &message);
    }
    told(
        &["m.obj", "--at", "cg"],
        "m.obj: --at cg: a mesh says nothing of masses; write the point in the axes of the mesh: --at \"0 mm, 0 mm, -12 mm\"",
    );
    told(
        &["e.toml", "--at", "cg"],
        "e.toml: --at cg: no centre of gravity is known; write centre_of_gravity = [\"0 mm\", \"0 mm\", \"-12 mm\"] in [body], or the point: \
         --at \"0 mm, 0 mm, -12 mm\"",
    );
    let apart = "--at goes with one rigid body; with --chain or --apart every part is about its own point";
    told(&["m.obj", "--apart", "--at", "cb"], apart);
    told(&["r.toml", "--links", "2", "--chain", "--at", "cb"], apart);
    told(
        &["m.obj", "--surface", "2 m", "--tank", "9 m x 9 m x 9 m", "--up", "y", "--forward", "x"],
        "m.obj: in a tank the z axis of the mesh must point up, and here y does; export the mesh with z up",
    );
}

#[test]
fn options_that_say_nothing_sensible_are_told_what_they_take() {
    let metre = write_obj(&cube(1.0));
    let robot = body_file(ROBOT);
    let files = [("m.obj", metre.as_bytes()), ("r.toml", robot.as_bytes())];
    let mesh = |args: &[&str], message: &str| refuses(&files, &[&["m.obj"], args].concat(), message);
    mesh(&[], "m.obj: no density of the water; write --density \"1025 kg/m^3\", or [fluid] density in the body file");
    mesh(&["--density", "1025"], "--density \"1025\": `1025` has no unit; write for example `1025 kg/m^3`");
    mesh(&["--density", "1025 kg"], "--density \"1025 kg\": expected a density (kg/m^3), found a mass (kg)");
    mesh(&["--density", "-5 kg/m^3"], "--density \"-5 kg/m^3\": it must be larger than zero");
    mesh(
        &["--density", "nan kg/m^3"],
        "--density \"nan kg/m^3\": `nan kg/m^3` does not begin with a number; write a quantity as `0.4 kg/m^3`",
    );
    mesh(
        &["--density", "1 kg/m^3", "--links", "3"],
        "m.obj: --links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh",
    );
    mesh(
        &["--density", "1 kg/m^3", "--links", "1..3"],
        "m.obj: --links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh",
    );
    mesh(&["--density", "1 kg/m^3", "--tolerance", "0"], "--tolerance \"0\": `0` has no unit; write for example `0 %`");
    mesh(
        &["--density", "1 kg/m^3", "--tolerance", "200 %"],
        "--tolerance \"200 %\": write a part above 0 and below 100 %: \"1 %\"",
    );
    mesh(
        &["--density", "1 kg/m^3", "--at", "1 m, 2 m"],
        "--at \"1 m, 2 m\": write cg, cb, or three lengths: \"0 m, 0 m, -0.2 m\"",
    );
    mesh(
        &["--density", "1 kg/m^3", "--at", "1 m, 2, 3 m"],
        "--at \"1 m, 2, 3 m\": `2` has no unit; write for example `2 m`",
    );
    mesh(&["--density", "1 kg/m^3", "--surface", "3 s"], "--surface \"3 s\": expected a length (m), found a time (s)");
    let tank = "--tank says how deep the water is, and not where the body lies in it: add --surface, the height of the water's surface over the \
                origin of the mesh, such as --surface \"0.5 m\"";
    mesh(&["--density", "1 kg/m^3", "--tank", "3 m x 2 m x 2 m"], tank);
    mesh(&["--weld", "1 mm"], "--weld is for a repair: add --repair FILE, the mesh to be written (.obj or .stl)");
    mesh(&["--density", "1 kg/m^3", "--unit", "kg"], &format!("--unit \"kg\": {UNITS}"));
    mesh(&["--repair", "m.obj"], "m.obj: name another file than the input; it stays as it is");
    mesh(&["--repair", "./m.obj"], "./m.obj: name another file than the input; it stays as it is");
    mesh(&["--repair", "n.ply"], "n.ply: a repaired mesh is written as .obj or .stl");
    let robot = |args: &[&str], message: &str| refuses(&files, &[&["r.toml"], args].concat(), message);
    robot(&[], "r.toml: a robot has links; say how many: --links 3, or --links 1..9 for a table");
    for links in ["0", "3..1", "3..x", "..3", "1,,2", "101", ""] {
        let message = format!("--links {links:?}: write a number of links, \"1..9\" or \"1,3,6\", between 1 and 100");
        robot(&["--links", links], &message);
    }
    robot(&["--links", "1..3", "--tank", "3 m x 2 m x 2 m"], tank);
    robot(&["--links", "3", "--unit", "mm"], "r.toml: --unit is for a mesh; a body file has a unit at each length");
    robot(&["--links", "1..3", "--at", "cb"], "--at is for one body; give one number of links with it: --links 3");
    robot(&["--repair", "n.obj"], "r.toml: --repair is for a mesh; a body file has none");
    refuses(
        &[("e.toml", body_file(EGG).as_bytes())],
        &["e.toml", "--links", "3"],
        "e.toml: --links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh",
    );
}

#[test]
fn results_that_cannot_be_written_are_reported_before_anything_is_computed() {
    let metre = write_obj(&cube(1.0));
    let robot = body_file(ROBOT);
    let files = [("m.obj", metre.as_bytes()), ("r.toml", robot.as_bytes())];
    fails(
        1,
        &files,
        &[&["m.obj", "--out", "r.toml"], &WATER[..]].concat(),
        "r.toml: cannot be written: not a directory; choose another place with --out",
    );
    fails(
        1,
        &files,
        &[&["m.obj", "--out", "r.toml/deep/er"], &WATER[..]].concat(),
        "r.toml/deep/er: cannot be written: not a directory; choose another place with --out",
    );
    fails(
        1,
        &files,
        &["m.obj", "--repair", "no/n.obj"],
        "cannot write no/n.obj: its folder does not exist; nothing was changed",
    );
    fails(
        1,
        &files,
        &["r.toml", "--links", "1..9", "--out", "m.obj"],
        "m.obj: cannot be written: not a directory; choose another place with --out",
    );
}

#[test]
fn a_full_disk_leaves_nothing_of_an_added_mass() {
    let Some(disk) = SmallDisk::mount("40k") else {
        eprintln!("this user may not mount a small disk; the failing writer of froude-records is tested instead");
        return;
    };
    write(disk.path(), "m.obj", &cube(1.0));
    let output = froude(disk.path(), &["m.obj", "--density", "1000 kg/m^3", "--most-panels", "100"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).ends_with("the disk is full; nothing was changed"), "{}", said(&output));
    assert_eq!(names(disk.path()), ["m.obj"]);
    std::fs::write(disk.path().join("r.toml"), body_file(ROBOT)).unwrap();
    let output = froude(disk.path(), &["r.toml", "--links", "1..3", "--tolerance", "50 %"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).ends_with("the disk is full; nothing was changed"), "{}", said(&output));
    assert_eq!(names(disk.path()), ["m.obj", "r.toml"]);
}

/// All files of a folder with what they hold.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = names(folder).into_iter().filter(|name| folder.join(name).is_file());
    files.map(|name| (name.clone(), std::fs::read(folder.join(&name)).unwrap())).collect()
}

/// The record and the page of the new mesh have room on the disk, and its pressure has not.
#[test]
fn an_export_that_cannot_be_written_leaves_the_old_results_as_they_were() {
    let Some(disk) = SmallDisk::mount("640k") else {
        eprintln!("this user may not mount a small disk; the writer of the facade is tested instead");
        return;
    };
    let at = disk.path();
    write(at, "hull.obj", &hull());
    record(at, &[&["hull.obj", "--export", "csv"], &ONE_MESH[..]].concat());
    let results = at.join("hull-added-mass");
    let old = contents(&results);
    let finer =
        ["hull.obj", "--export", "csv", "--density", "1000 kg/m^3", "--most-panels", "4096", "--tolerance", "0.001 %"];
    let output = froude(at, &finer);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("hull-added-mass/pressure.vtp"), "{}", said(&output));
    assert!(said(&output).ends_with("the disk is full; nothing was changed"), "{}", said(&output));
    assert_eq!(contents(&results), old);
    assert_eq!(names(at), ["hull-added-mass", "hull.obj"]);
}

/// A campaign with a mesh, in the words of the verb, beside a published record.
const EGG_CAMPAIGN: &str = r#"schema = 1
name = "the egg, computed and published"
[fluid]
density = "1025 kg/m^3"
[[source]]
name = "panels"
kind = "potential"
mesh = "egg.toml"
[source.added_mass]
axes = "ned"
tolerance = "2 %"
export = ["wamit", "csv"]
[[source]]
name = "Lamb"
kind = "published"
record = "lamb.json"
"#;

/// The closed form of an ellipsoid as a published record, each entry with a standard uncertainty of 0.1 %.
fn lamb(factor: f64) -> String {
    let exact = ellipsoid_added_mass([0.5, 0.3, 0.2]).unwrap();
    let entry = |(i, a): (usize, &f64)| {
        let (value, unit) = (1025.0 * factor * a, if i < 3 { "kg" } else { "kg*m^2" });
        let name = format!("A{0}{0}", i + 1);
        let standard = 1e-3 * value;
        (name, serde_json::json!({"value": value, "unit": unit, "status": "free", "standard_uncertainty": standard}))
    };
    let coefficients: serde_json::Map<String, Value> = exact.iter().enumerate().map(entry).collect();
    let record = serde_json::json!({
        "schema": "froude/estimate/1", "data": [], "versions": {}, "findings": [],
        "estimates": [{
            "id": "lamb/added_mass_6x6", "source": "lamb", "kind": "published", "model": "added_mass_6x6", "law": {"version": 1, "constants": {}},
            "frame": "body axes", "reference_point": "body centre", "method": "published: closed form of Lamb",
            "density": {"value": 1025.0, "unit": "kg/m^3"}, "covariance_kind": "stated", "n_observations": 0,
            "coefficients": coefficients, "covariance": null, "validity": {}, "recommended": false
        }]
    });
    record.to_string()
}

fn verb(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

#[test]
fn a_mesh_of_a_campaign_is_a_source_beside_others_and_the_verb_gives_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("egg.toml"), body_file(EGG)).unwrap();
    std::fs::write(at.join("lamb.json"), lamb(1.0)).unwrap();
    std::fs::write(at.join("c.toml"), EGG_CAMPAIGN).unwrap();
    let output = verb(at, &["identify", "c.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let of_campaign: Value = serde_json::from_slice(&output.stdout).unwrap();
    let of_verb = record(at, &["egg.toml", "--axes", "ned", "--tolerance", "2 %", "--export", "wamit,csv"]);
    let [a, b] = [&of_campaign, &of_verb].map(|r| &r["estimates"][0]);
    assert_eq!((a["id"].as_str(), b["id"].as_str()), (Some("panels/added_mass_6x6"), Some("it/added_mass_6x6")));
    for key in ["coefficients", "type_a", "law", "frame", "point", "method", "refers_to", "n"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    assert_eq!(of_campaign["data"]["d2"]["role"], "mesh");
    assert_eq!(a["data"], serde_json::json!(["d2"]));
    // A table of observations there is none; exports are the same bytes, under the source's name where there are several sources.
    let there = [
        "estimate.json",
        "figures",
        "froude-files.json",
        "panels-added-mass.1",
        "panels-added-mass.csv",
        "panels-pressure.vtp",
        "report.html",
        "result.json",
    ];
    assert_eq!(names(&at.join("c-results")), there);
    for name in ["added-mass.1", "added-mass.csv", "pressure.vtp"] {
        let [one, other] = [at.join("egg-added-mass").join(name), at.join("c-results").join(format!("panels-{name}"))]
            .map(|path| std::fs::read(path).unwrap());
        assert!(one == other, "{name}");
    }
    let page = std::fs::read_to_string(at.join("c-results/report.html")).unwrap();
    for word in ["panels: Added mass", "Convergence with the number of panels", "lamb"] {
        assert!(page.contains(word), "{word}");
    }
}

#[test]
fn an_added_mass_is_compared_with_a_published_one_by_e_n_and_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("egg.toml"), body_file(EGG)).unwrap();
    record(at, &["egg.toml", "--tolerance", "0.5 %"]);
    let told = |factor: f64| {
        std::fs::write(at.join("lamb.json"), lamb(factor)).unwrap();
        let args = ["compare", "egg-added-mass/estimate.json", "lamb.json"];
        let printed = verb(at, &args);
        assert_eq!(printed.status.code(), Some(0), "{}", said(&printed));
        let printed = String::from_utf8(printed.stdout).unwrap();
        let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        let record: Value = serde_json::from_slice(&verb(at, &[&args[..], &["--json"]].concat()).stdout).unwrap();
        let rows = record["comparison"]["coefficients"].as_array().unwrap().clone();
        (printed, rows)
    };
    // Lamb's own numbers: each entry of the diagonal agrees.
    let (printed, rows) = told(1.0);
    assert_eq!(rows.len(), 6, "{rows:?}");
    assert!(rows.iter().all(|row| row["e_n"].as_f64().unwrap().abs() < 1.0), "{rows:?}");
    assert!(
        printed.contains("it/added_mass_6x6 and lamb/added_mass_6x6 agree within their uncertainties"),
        "{printed}"
    );
    assert!(printed.contains("A22"), "{printed}");
    // A published value 2 % higher, of 0.1 %, does not.
    let (printed, rows) = told(1.02);
    assert!(rows.iter().all(|row| row["e_n"].as_f64().unwrap().abs() > 1.0), "{rows:?}");
    assert!(
        printed.contains("it/added_mass_6x6 and lamb/added_mass_6x6 differ by more than their uncertainties"),
        "{printed}"
    );
}

#[test]
fn what_a_campaign_asks_of_a_mesh_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("egg.toml"), body_file(EGG)).unwrap();
    std::fs::write(at.join("lamb.json"), lamb(1.0)).unwrap();
    let told = |from: &str, to: &str, message: &str| {
        assert!(EGG_CAMPAIGN.contains(from));
        std::fs::write(at.join("c.toml"), EGG_CAMPAIGN.replace(from, to)).unwrap();
        for verb_ in ["identify", "inspect"] {
            let output = verb(at, &[verb_, "c.toml"]);
            assert_eq!(
                (said(&output).as_str(), output.status.code()),
                (format!("froude: {message}").as_str(), Some(2))
            );
        }
    };
    let tolerance = "tolerance = \"2 %\"";
    told(
        tolerance,
        "tolerance = \"2 kg\"",
        "c.toml:11:13: tolerance = \"2 kg\": expected a pure number or angle (1), found a mass (kg)",
    );
    told(
        tolerance,
        "tollerance = \"2 %\"",
        "c.toml:11:1: unknown key `tollerance` in [source.added_mass]; did you mean `tolerance`?",
    );
    told(tolerance, "chain = 3", "c.toml:11:9: `chain` is 3; expected true or false");
    told(
        "mesh = \"egg.toml\"",
        "mesh = \"egg.toml\"\nkeep = \"speed > 1 m/s\"",
        "c.toml:9:8: `keep` belongs to the rows of a table; a mesh has none, and says its numerical uncertainty itself",
    );
    told(
        "mesh = \"egg.toml\"",
        "table = \"egg.toml\"",
        "c.toml:9:1: `added_mass` says what is asked of a mesh, but the source names none: write mesh = \"hull.stl\", or a body file",
    );
}

#[test]
fn more_than_fits_into_the_memory_is_reported_with_what_would_fit() {
    let family = Family::Mesh(hull());
    let wanted = |memory_bytes| Wanted { memory_bytes: Some(memory_bytes), ..Wanted::default() };
    let refused = refine(&family, &wanted(5e4), &|_| {}).unwrap_err();
    let told = "64 panels would take 98 kB of memory and 50 kB may be used; some 32 panels would fit";
    assert_eq!(refused.to_string(), told);
    // One that fits, and a finer one that does not: the value is there, and why it is no better.
    let one = refine(&family, &wanted(1e6), &|_| {}).unwrap();
    assert_eq!((one.steps.len(), one.is_within, one.worst), (1, false, f64::INFINITY));
    assert_eq!(
        one.stopped.unwrap().to_string(),
        "256 panels would take 1.6 MB of memory and 1.0 MB may be used; some 162 panels would fit"
    );
}

/// The diagonal is Lamb's within its stated uncertainty, whatever the size; that below `tolerance` where it is not next to nothing.
fn assert_lambs(axes: [&str; 3], axes_m: Vec3, args: &[&str], tolerance: f64) {
    let [x, y, z] = axes;
    let shape = format!("shape = \"ellipsoid\"\nsemi_axis_x = \"{x}\"\nsemi_axis_y = \"{y}\"\nsemi_axis_z = \"{z}\"\n");
    let record = of_shape(&shape, args);
    let a = matrix(&record, 0);
    let exact = ellipsoid_added_mass(axes_m).unwrap();
    let kind = |i: usize| (0..3).map(|k| exact[3 * (i / 3) + k]).fold(0.0, f64::max);
    for i in 0..6 {
        let coefficient = &record["estimates"][0]["coefficients"][format!("A{0}{0}", i + 1)];
        let expanded = 2.0 * coefficient["standard_uncertainty"].as_f64().unwrap() / 1025.0;
        let error = (a[i][i] / 1025.0 - exact[i]).abs();
        assert!(error < expanded + 1e-9 * kind(i), "{axes:?}, {i}: {error:e} is more than {expanded:e}");
        assert!(expanded < tolerance * exact[i].max(0.01 * kind(i)), "{axes:?}, {i}: {expanded:e} of {:e}", exact[i]);
    }
}

#[test]
fn odd_sizes_are_computed() {
    let coarse = ["--tolerance", "20 %"];
    assert_lambs(["2e-5 m", "1.6e-5 m", "1e-5 m"], [2e-5, 1.6e-5, 1e-5], &coarse, 0.2);
    assert_lambs(["1e3 m", "8e2 m", "5e2 m"], [1e3, 8e2, 5e2], &coarse, 0.2);
    assert_lambs(["1 m", "1 mm", "1 mm"], [1.0, 1e-3, 1e-3], &coarse, 0.2);
    assert_lambs(["1 m", "1 m", "1 cm"], [1.0, 1.0, 1e-2], &coarse, 0.2);
    assert_lambs(["1 cm", "1 m", "1 m"], [1e-2, 1.0, 1.0], &coarse, 0.2);
    let thread = ROBOT.replace("scale = 0.7", "scale = 0.01");
    let a = matrix(&of_shape(&thread, &["--links", "2", "--tolerance", "50 %"]), 0);
    assert!((0..6).all(|i| a[i][i] > 0.0), "{a:?}");
}
