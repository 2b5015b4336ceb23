//! Computed flows: those whose forces are known, and the snake robot's campaign beside the paper's and the tanks'.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use froude::cfd::verb::{Engine, Job as Run, Running, plan, run, status};
use froude::identify::law::ForceLaw;
use froude::pipeline::{Identified, Job, identify};
use froude::records::comparison::Validation;
use froude::records::estimate::Estimate;
use froude_cfd::collect::{Collected, collect};
use froude_cfd::grid_error::{GridError, OnGrid, grid_error};
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::store::Store;
use froude_cfd::suggest::misses;
use serde_json::Value;

use crate::cfd_evidence::evidence;
use crate::cfd_laws;
use crate::cfd_swing::swung;
use crate::claims::{Claims, Verdict};
use crate::flows::{Room, capsule, capsule_body, capsule_grid, cylinder, plate, plate_friction, sphere};

type Failed = Box<dyn Error>;

const KNOWN: &str = "Computed flows: forces that are known";
const CAPSULE: &str = "Computed flows: a capsule beside another program's grids";
const MOVED: &str = "Computed flows: two angles and six loads";
const ROBOT: &str = "Computed flows: the snake robot's campaign";
const DESIGN: &str = "Computed flows: 44 settings in place of 170";

/// f_x and f_y of the capsule at 0.4 m/s in N, the paper's sign of f_x turned to these axes: OpenFOAM 1912 with the same conditions on O-grids of as many cells by another program.
const OTHER_E: [(f64, Option<f64>, Option<f64>); 4] = [
    (0.0, Some(-0.1870), None),
    (30.0, Some(-0.1667), Some(1.831)),
    (60.0, None, Some(4.429)),
    (90.0, None, Some(5.238)),
];
const OTHER_D: [(f64, Option<f64>, Option<f64>); 4] = [
    (0.0, Some(-0.1759), None),
    (30.0, Some(-0.162), Some(1.849)),
    (60.0, None, Some(4.548)),
    (90.0, None, Some(5.182)),
];

fn is_absent(claims: &mut Claims, section: &'static str, what: &str) -> bool {
    let is_absent = OpenFoam::find().is_err();
    if is_absent {
        let found = "OpenFOAM is not installed; cargo xtask test installs it".to_owned();
        claims.add(section, what, "", found, Verdict::Skipped);
    }
    is_absent
}

/// The snake robot's campaign, what else changes its forces, and the design of the run matrix; `pages` is where the chapter on laws is written.
pub fn campaigns(claims: &mut Claims, root: &Path, pages: Option<&Path>) -> Result<(), Failed> {
    if is_absent(claims, ROBOT, "nine configurations at 44 settings each") {
        return Ok(());
    }
    robot(claims, root, pages)?;
    design(claims, root)
}

/// Known flows, and in full the capsule too.
pub fn all(claims: &mut Claims, full: bool) -> Result<(), Failed> {
    if is_absent(claims, KNOWN, "forces of known flows") {
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let room = Room::new(folder.path().to_owned())?;
    known(claims, &room, full)?;
    if full {
        of_capsule(claims, &room, &Room::new(folder.path().join("family"))?)?;
    }
    Ok(())
}

/// Two angles, and a body that swings.
pub fn moved(claims: &mut Claims, root: &Path) -> Result<(), Failed> {
    if is_absent(claims, MOVED, "oblique flows and swings") {
        return Ok(());
    }
    two_angles(claims, root)?;
    swung(claims, root)
}

fn known(claims: &mut Claims, room: &Room, full: bool) -> Result<(), Failed> {
    let levels = if full { 0..4 } else { -2..1 };
    let mut grids = Vec::new();
    for level in levels {
        let found = sphere(room, level)?;
        let words = format!("{:.4} on {} cells", found.value, found.outcome.cells);
        if level == 1 {
            let holds = (found.value / 1.087 - 1.0).abs() <= 0.02;
            claims.holds(KNOWN, "C_D of a sphere at Re 100 on the second grid", "1.087 ± 2 %", words, holds);
        } else {
            claims.add(KNOWN, "C_D of a sphere at Re 100 on one grid", "1.087", words, Verdict::Measured);
        }
        grids.push(found.on_grid());
    }
    let found = grid_error(&grids, 3)?;
    let limit = found.extrapolated.unwrap_or(found.value);
    // The short run has coarse grids alone, which need not be in the range where an order holds.
    let band = if full { 0.01 } else { 0.05 };
    claims.holds(
        KNOWN,
        "C_D of a sphere at Re 100 from a family of grids by √2",
        &format!("1.087 ± {} % (Clift, Grace & Weber 1978)", 100.0 * band),
        in_words(&found),
        (limit / 1.087 - 1.0).abs() <= band,
    );
    if !full {
        return Ok(());
    }
    for (reynolds, far_m) in [(100.0, 8.0), (1000.0, 4.0), (1e4, 3.0)] {
        let (found, known) = (plate(room, reynolds, far_m)?.value, plate_friction(reynolds));
        let part = found / known - 1.0;
        claims.holds(
            KNOWN,
            &format!("friction of a plate at Re {reynolds}"),
            &format!("{known:.5} ± 2 %: 1.328/√Re + 2.67/Re^(7/8), with the trailing edge (Stewartson, Messiter)"),
            format!("{found:.5} ({:+.2} %)", 100.0 * part),
            part.abs() <= 0.02,
        );
    }
    let [drag, strouhal, _] = cylinder(room)?;
    claims.near(
        KNOWN,
        "C_D of a circular cylinder at Re 100 in time",
        drag,
        1.345,
        0.015,
        "Park, Kwon & Choi 1998: 1.33 to 1.36",
    );
    claims.near(KNOWN, "Strouhal number of it", strouhal, 0.1655, 0.0015, "Williamson 1989: 0.164 to 0.167");
    Ok(())
}

fn in_words(found: &GridError) -> String {
    let order = found.order.map_or("no order".to_owned(), |p| format!("order {p:.2}"));
    let limit = found.extrapolated.map_or(String::new(), |limit| format!(", {limit:.4} extrapolated"));
    format!("{:.4} ± {:.4} on the finest{limit}, {order}: {}", found.value, found.expanded, found.reason)
}

fn of_capsule(claims: &mut Claims, room: &Room, of_family: &Room) -> Result<(), Failed> {
    let e = capsule_grid(40, 35, 16, 0.12e-3);
    let grids = [("e", e, OTHER_E), ("d", capsule_grid(60, 48, 32, 0.10e-3), OTHER_D)];
    for (name, grid, other) in grids {
        for (angle, x, y) in other {
            let (_, outcome) = capsule(room, &grid, angle, 0.4, None)?;
            let loads = outcome.loads.unwrap_or([f64::NAN; 6]);
            for (load, expected, band) in [(0, x, 0.03), (1, y, 0.015)] {
                let Some(expected) = expected else { continue };
                // The other program lists f_x at 0° and 30° and f_y at 60° and 90° as those to be met.
                let is_judged = load == 0 || angle >= 60.0;
                let part: f64 = loads[load] / expected - 1.0;
                claims.add(
                    CAPSULE,
                    &format!("{} at {angle}° on mesh {name}, out to 4 m", ["f_x", "f_y"][load]),
                    &format!("{expected} N ± {} %", 100.0 * band),
                    format!(
                        "{:.4} N ({:+.1} %), {} iterations, {}",
                        loads[load],
                        100.0 * part,
                        outcome.iterations,
                        outcome.status.word()
                    ),
                    Verdict::of(is_judged, part.abs() <= band),
                );
            }
        }
    }
    let coarse = capsule_grid(28, 25, 11, 0.17e-3);
    let family = coarse.family(&capsule_body(), 4)?;
    for (angle, loads) in [(0.0, &[0][..]), (90.0, &[1])] {
        let mut outcomes = Vec::new();
        for grid in &family {
            outcomes.push(capsule(of_family, grid, angle, 0.4, None)?.1);
        }
        for &load in loads {
            let mut on_grids: Vec<OnGrid> = Vec::new();
            let mut words = String::new();
            for outcome in &outcomes {
                let of = |loads: Option<[f64; 6]>| loads.unwrap_or([f64::NAN; 6])[load];
                let found =
                    OnGrid { cells: outcome.cells, value: of(outcome.loads), std_iterative: of(outcome.std_iterative) };
                write!(words, "{} cells {:.4} ({}); ", found.cells, found.value, outcome.status.word())?;
                on_grids.extend(outcome.status.is_usable().then_some(found));
            }
            let found = grid_error(&on_grids, 3).map_or_else(|why| why, |found| in_words(&found));
            claims.add(
                CAPSULE,
                &format!("four grids by √2: {} at {angle}°, N", ["f_x", "f_y"][load]),
                "an order where grids approach a limit from one side and 0.5 < p < 3",
                words + &found,
                Verdict::Measured,
            );
        }
    }
    Ok(())
}

/// An interval in words; nothing where there is none.
fn ends(interval: Option<[f64; 2]>) -> String {
    interval.map_or(String::new(), |[low, high]| format!(" [{low:.2}, {high:.2}]"))
}

/// A capsule at two angles in the whole domain: what turns with it turns its loads, which no law was told.
const TWO_ANGLES: &str = r#"schema = 1
name = "a capsule at two angles"
[fluid]
density = "1000 kg/m^3"
kinematic_viscosity = "1e-6 m^2/s"
[[source]]
name  = "CFD"
kind  = "cfd"
cases = "cfd"
[source.cfd]
body   = "capsule.toml"
mesh   = "coarse"
domain = "full"
cold   = 0
[[source.plan]]
speed = "0.4 m/s"
angle = ["0 deg", "7.5 deg", "15 deg"]
pitch = ["0 deg", "7.5 deg", "15 deg"]
[[identify.model]]
name = "two_angles"
f_x  = "-D_x*v_x*abs(v_x) - D_xx*v_x*(v_y^2 + v_z^2)/speed"
f_y  = "-D_y*v_y*sqrt(v_y^2 + v_z^2) - L_y*abs(v_x)*v_y"
f_z  = "-D_z*v_z*sqrt(v_y^2 + v_z^2) - L_z*abs(v_x)*v_z"
m_y  = "M_y*v_x*v_z"
m_z  = "-M_z*v_x*v_y"
"#;
/// The plan of [`TWO_ANGLES`] with other settings.
const GRID: &str = "angle = [\"0 deg\", \"7.5 deg\", \"15 deg\"]\npitch = [\"0 deg\", \"7.5 deg\", \"15 deg\"]\n";
const CAPSULE_FILE: &str = "schema = 1\nname = \"capsule\"\n[body]\nshape = \"capsule\"\nlength = \"1 m\"\nmajor_semi_axis = \"45 mm\"\nminor_semi_axis = \"45 mm\"\nends = { length = \"45 mm\" }\n";

/// A velocity so far from the axis, turned about it by three and a half cells of the 32, as angle and pitch in degrees: no symmetry of the mesh, and none that holds the wake.
fn turned(from_axis_deg: f64) -> [f64; 2] {
    let (sin, cos) = (3.5 * std::f64::consts::TAU / 32.0).sin_cos();
    let (across, along) = from_axis_deg.to_radians().sin_cos();
    [(across * cos).atan2(along).to_degrees(), (across * sin).asin().to_degrees()]
}

fn moved_capsule(root: &Path, name: &str, text: &str) -> Result<PathBuf, Failed> {
    let path = campaign(root, name, text)?;
    std::fs::write(path.with_file_name("capsule.toml"), CAPSULE_FILE)?;
    finish(&path)?;
    Ok(path)
}

/// The loads that were computed at these angles in degrees.
fn loads_at(path: &Path, [angle, pitch]: [f64; 2]) -> Result<[f64; 6], Failed> {
    let rows = collect(&Store::open(&path.with_file_name("cfd"))?).rows;
    let is_it = |row: &&Collected| {
        let flow = row.case.flow;
        (flow.angle_rad.to_degrees() - angle).abs() < 0.1 && (flow.pitch_rad.to_degrees() - pitch).abs() < 0.1
    };
    Ok(rows.iter().find(is_it).map_or([f64::NAN; 6], |row| row.loads))
}

fn two_angles(claims: &mut Claims, root: &Path) -> Result<(), Failed> {
    let path = moved_capsule(root, "two-angles", TWO_ANGLES)?;
    let found = identify(&Job { out: Some(path.with_file_name("results")), ..Job::new(&path) }, &|_| {})?;
    let estimate = found.file.estimates.first().ok_or("no estimate")?;
    let of = |name: &str| {
        let c = estimate.coefficients.get(name);
        (c.and_then(|c| c.value).unwrap_or(f64::NAN), c.and_then(|c| c.interval_95))
    };
    for (one, two) in [("D_y", "D_z"), ("L_y", "L_z"), ("M_z", "M_y")] {
        let (a, b) = (of(one), of(two));
        // Oblique flows lean to one side, and not to the same in mirrored settings: that is seen, and no bar is set.
        claims.add(
            MOVED,
            &format!("{one} and {two} of its six loads at two angles, by froude identify"),
            "one number for a body of revolution, as far as its flows do not lean",
            format!("{:.4}{} and {:.4}{}", a.0, ends(a.1), b.0, ends(b.1)),
            Verdict::Measured,
        );
    }
    // A rotation about the axis takes (30°, 0) into (0, 30°).
    for angle in [7.5, 15.0] {
        let (level, upright) = (loads_at(&path, [angle, 0.0])?, loads_at(&path, [0.0, angle])?);
        let scale = level[1].abs();
        for (what, a, b, scale) in [
            ("f_x", level[0], upright[0], level[0].abs()),
            ("f_y and −f_z", level[1], -upright[2], scale),
            ("m_z and m_y", level[5], upright[4], level[5].abs()),
        ] {
            claims.holds(
                MOVED,
                &format!("{what}, turned by {angle}° in the plane and out of it"),
                "the same within 1 %",
                format!("{a:.5} and {b:.5} ({:+.2} %)", 100.0 * (b - a) / scale),
                (a - b).abs() <= 0.01 * scale,
            );
        }
    }
    let level = loads_at(&path, [15.0, 0.0])?;
    let plan = |settings: &[[f64; 2]]| {
        let block = |[angle, pitch]: &[f64; 2]| format!("angle = \"{angle} deg\"\npitch = \"{pitch} deg\"\n");
        let blocks: Vec<String> = settings.iter().map(block).collect();
        TWO_ANGLES.replace(GRID, &blocks.join("[[source.plan]]\nspeed = \"0.4 m/s\"\n"))
    };
    let (near, far) = (turned(7.5), turned(15.0));
    let about = moved_capsule(root, "turned-about", &plan(&[[0.0, 0.0], near, far]))?;
    let loads = loads_at(&about, far)?;
    let across = loads[1].hypot(loads[2]);
    claims.holds(
        MOVED,
        "force across at 15° from the axis, in the plane and turned about the axis by 39.4°, which the mesh has no symmetry of",
        "the same within 2 %",
        format!("{:.5} N and {across:.5} N ({:+.2} %)", level[1], 100.0 * (across / level[1] - 1.0)),
        (across / level[1] - 1.0).abs() <= 0.02,
    );
    let at_once = moved_capsule(root, "at-once", &plan(&[[0.0, 0.0], [15.0, 0.0]]))?;
    let other = loads_at(&at_once, [15.0, 0.0])?;
    claims.add(
        MOVED,
        "f_x, f_y and m_z at 15°, started from the flow at 7.5° and from the one head on",
        "one steady state would give the same; both are converged",
        [0, 1, 5]
            .map(|k| format!("{:.5} and {:.5} ({:+.1} %)", level[k], other[k], 100.0 * (other[k] / level[k] - 1.0)))
            .join(", "),
        Verdict::Finding,
    );
    Ok(())
}

fn target(root: &Path) -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from)
}

/// The campaign lies where builds lie, and goes on there: it takes an hour of both processors.
pub fn campaign(root: &Path, name: &str, text: &str) -> Result<PathBuf, Failed> {
    let folder = target(root).join("validation-cfd").join(name);
    std::fs::create_dir_all(&folder)?;
    let example = root.join("examples/mamba-cfd");
    std::fs::copy(example.join("body.toml"), folder.join("body.toml"))?;
    let published = root.join("examples/mamba/published");
    let text = text.replace("../mamba/published", &published.canonicalize()?.to_string_lossy());
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text)?;
    Ok(path)
}

pub fn finish(path: &Path) -> Result<(), Failed> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let job = Run { campaign: path.to_owned(), source: None, engine: Engine::Local { jobs: processors, ranks: 1 } };
    run(&job, &AtomicBool::new(false), &Running::new(&|_| {}, &|line| eprintln!("{line}")))?;
    Ok(())
}

pub fn example(root: &Path) -> Result<String, Failed> {
    Ok(std::fs::read_to_string(root.join("examples/mamba-cfd/campaign.toml"))?)
}

/// The example without its study of grids and without cases that are repeated cold.
fn once(example: &str) -> String {
    let (head, rest) = example.split_once("[[source.cfd.study]]").unwrap_or((example, ""));
    let (_, plan) = rest.split_once("[[source.plan]]").unwrap_or(("", ""));
    head.replace("mesh = \"coarse\"", "mesh = \"coarse\"\ncold = 0") + "[[source.plan]]" + plan
}

fn robot(claims: &mut Claims, root: &Path, pages: Option<&Path>) -> Result<(), Failed> {
    let path = campaign(root, "reduced", &example(root)?)?;
    finish(&path)?;
    let done = serde_json::to_value(status(&path, None)?.json())?;
    let counts = &done["counts"];
    let count = |word: &str| counts[word].as_u64().unwrap_or(0);
    let (usable, all) = (count("converged") + count("oscillating"), done["cases"].as_array().map_or(0, Vec::len));
    claims.holds(
        ROBOT,
        "nine configurations at 44 settings each, a tenth repeated cold",
        "all cases ended, none failed, at most 1 in 20 diverged",
        format!("{all} cases: {counts}; {:.0} min of a processor", minutes(&done["cpu_s"])),
        count("failed") == 0 && 20 * count("diverged") as usize <= all && usable + count("diverged") == all as u64,
    );
    let found = identify(&Job { out: Some(path.with_file_name("results")), ..Job::new(&path) }, &|_| {})?;
    coefficients(claims, &found);
    let pairs = evidence(claims, root, &path.with_file_name("cfd"))?;
    if let Some(pages) = pages {
        cfd_laws::write(&found, &pairs, pages)?;
    }
    if let Some(comparison) = &found.file.comparison {
        for number in comparison.validation.iter().filter(|number| number.flows.is_some()) {
            beside(claims, number);
        }
    }
    price(claims, root, &done)
}

fn minutes(seconds: &Value) -> f64 {
    seconds.as_f64().unwrap_or(f64::NAN) / 60.0
}

/// Coefficients of the six laws beside Table 5 and the tanks.
fn coefficients(claims: &mut Claims, found: &Identified) {
    let Some(comparison) = &found.file.comparison else { return };
    for estimate in found.file.estimates.iter().filter(|e| e.source.starts_with("CFD")) {
        let mut own = String::new();
        let mut others: Vec<(String, String)> = Vec::new();
        for (name, c) in &estimate.coefficients {
            let interval = c.interval_95.map_or(String::new(), |[low, high]| format!(" [{low:.4}, {high:.4}]"));
            let _ =
                write!(own, "{name} {}{interval}; ", c.value.map_or("undetermined".to_owned(), |v| format!("{v:.4}")));
            let pairs = comparison
                .coefficients
                .iter()
                .filter(|pair| pair.model == estimate.law.name && pair.coefficient == *name);
            for pair in pairs {
                let other = if pair.first.source == estimate.id { &pair.second } else { &pair.first };
                if pair.first.source != estimate.id && pair.second.source != estimate.id {
                    continue;
                }
                let value = other.value.map_or("–".to_owned(), |v| format!("{v:.4}"));
                match others.iter_mut().find(|(source, _)| *source == other.source) {
                    Some((_, text)) => *text += &format!("{name} {value}; "),
                    None => others.push((other.source.clone(), format!("{name} {value}; "))),
                }
            }
        }
        let beside: Vec<String> = others.iter().map(|(source, text)| format!("{source}: {text}")).collect();
        claims.add(
            ROBOT,
            &format!("{}: coefficients of {}{}", estimate.source, estimate.law.name, residual(estimate)),
            &beside.join("\n"),
            own,
            Verdict::Measured,
        );
    }
}

/// What the law leaves of the loads.
fn residual(estimate: &Estimate) -> String {
    let parts: Vec<String> =
        estimate.sigma.iter().map(|(load, s)| format!("{load} {:.3} {}", s.value, s.unit)).collect();
    let recommended = if estimate.recommended { ", recommended" } else { "" };
    format!(" (scatter {}{recommended})", parts.join(", "))
}

fn beside(claims: &mut Claims, number: &Validation) {
    let Validation {
        simulation,
        quantity,
        data,
        ratio,
        error,
        computed,
        measured,
        u_validation,
        flows,
        beyond,
        declared_model_form,
        ..
    } = number;
    claims.add(
        ROBOT,
        &format!("{quantity} of {simulation} beside {data}, by V&V 20"),
        "E within 2 u_val where the model is as good as the tank",
        format!(
            "S over D {:.3}; roots of mean squares over {} flows: S {computed:.3}, D {measured:.3}, E {error:.3}, u_val {u_validation:.3}, model form declared {declared_model_form:.3} N; beyond 2 u_val in {}",
            ratio.unwrap_or(f64::NAN),
            flows.unwrap_or(0),
            beyond.unwrap_or(0),
        ),
        Verdict::Measured,
    );
}

/// The paper's matrix: 50 speeds head on, and 31 angles at four speeds.
fn paper_matrix(example: &str, configurations: &str) -> String {
    let example = once(example);
    let (head, rest) = example.split_once("[[source.plan]]").unwrap_or((&example, ""));
    let (_, tail) = rest.split_once("[[source]]").unwrap_or(("", ""));
    let plan = format!(
        "[[source.plan]]\nconfigurations = {configurations}\nspeed = {{ start = \"0.02 m/s\", stop = \"1 m/s\", step = \"0.02 m/s\" }}\n\
         [[source.plan]]\nconfigurations = {configurations}\nspeed = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\", \"0.4 m/s\"]\n\
         angle = {{ start = \"0 deg\", stop = \"90 deg\", step = \"3 deg\" }}\n\n[[source]]"
    );
    head.to_owned() + &plan + tail
}

/// What the paper's whole matrix would take here, by the cost of a cell and iteration of the campaign that has run.
fn price(claims: &mut Claims, root: &Path, done: &Value) -> Result<(), Failed> {
    let nine: Vec<String> = (1..=9).map(|k| format!("\"H{k}LT\"")).collect();
    let path = campaign(root, "paper", &paper_matrix(&example(root)?, &format!("[{}]", nine.join(", "))))?;
    let planned = serde_json::to_value(plan(&path, None, 2, &AtomicBool::new(false), &|_| {})?.json())?;
    let of = |key: &str| {
        planned["configurations"].as_array().map_or(0.0, |all| all.iter().filter_map(|c| c[key].as_f64()).sum())
    };
    // A case costs what one of the reduced matrix did.
    let ran = done["cases"].as_array().map_or(&[][..], Vec::as_slice);
    let mean_s = minutes(&done["cpu_s"]) * 60.0 / ran.iter().filter(|c| c["cpu_s"].is_number()).count() as f64;
    let hours = of("cases") * mean_s / 3600.0;
    claims.add(
        ROBOT,
        "the paper's matrix, nine times 174 with four settings of each twice, priced by what cases cost here",
        "moonshot: one hour of two processors",
        format!(
            "{} cases at {mean_s:.1} s: {hours:.1} h of a processor, {:.1} h of two; {:.1} GB",
            of("cases"),
            hours / 2.0,
            of("bytes") / 1e9
        ),
        Verdict::Measured,
    );
    Ok(())
}

/// One configuration by the paper's matrix, and by the reduced one of the whole campaign.
fn design(claims: &mut Claims, root: &Path) -> Result<(), Failed> {
    let text = example(root)?;
    let whole = campaign(root, "h4-paper", &paper_matrix(&text, "[\"H4LT\"]"))?;
    finish(&whole)?;
    // The same campaign's flows, read again for this configuration alone.
    let (head, rest) = text.split_once("[[source]]").ok_or("no source")?;
    let (_, identify_part) = rest.split_once("[identify]").ok_or("no laws")?;
    let source = "[[source]]\nname = \"CFD\"\nkind = \"cfd\"\ncases = \"../reduced/cfd\"\nkeep = \"n_links == 4\"\n";
    let reduced = campaign(root, "h4-reduced", &format!("{head}{source}[identify]{identify_part}"))?;
    let mut fits = Vec::new();
    for path in [&whole, &reduced] {
        fits.push(identify(&Job { out: Some(path.with_file_name("results")), ..Job::new(path) }, &|_| {})?);
    }
    adaptive(claims, &whole.with_file_name("cfd"))?;
    let [whole, reduced] = &fits[..] else { return Ok(()) };
    for estimate in whole.file.estimates.iter().filter(|e| e.source == "CFD") {
        let law = &estimate.law.name;
        let other = reduced.file.estimates.iter().find(|e| e.source == "CFD" && e.law.name == *law);
        let Some(other) = other else { continue };
        for load in ["f_x", "f_y"] {
            let Some((largest, apart)) = apart(whole, estimate, other, load) else { continue };
            claims.holds(
                DESIGN,
                &format!("{load} of {law}, H4LT: largest difference of the two fits over the paper's settings"),
                "2 % of the largest |load| computed",
                format!("{:.2} % of {largest:.3} N", 100.0 * apart / largest),
                apart <= 0.02 * largest,
            );
        }
    }
    Ok(())
}

/// Nine angles that `froude cfd suggest` chooses, one after another from five, beside the nine of the reduced matrix: the worst that a cubic through them misses at the other angles of the paper's matrix.
fn adaptive(claims: &mut Claims, cases: &Path) -> Result<(), Failed> {
    let rows = collect(&Store::open(cases)?).rows;
    let degrees = |row: &Collected| row.case.flow.angle_rad.to_degrees().round() as i64;
    for speed_m_s in [0.1, 0.2, 0.3, 0.4] {
        let line: Vec<&Collected> = rows.iter().filter(|r| (r.case.flow.speed_m_s - speed_m_s).abs() < 1e-9).collect();
        let of = |angles: &[i64]| -> Vec<Collected> {
            line.iter().filter(|row| angles.contains(&degrees(row))).map(|row| (*row).clone()).collect()
        };
        let worst = |angles: &[i64]| {
            let others = line.iter().filter(|row| !angles.contains(&degrees(row)));
            let miss = |row: &&Collected| {
                let mut with = of(angles);
                with.push((*row).clone());
                let found = misses(&with, &[]);
                found.iter().find(|m| m.angle_rad == row.case.flow.angle_rad).map_or(f64::NAN, |m| m.missed_part)
            };
            // A miss that is none is no small one.
            others.map(miss).fold(0.0, |m: f64, v| if m.is_nan() || v.is_nan() { f64::NAN } else { m.max(v) })
        };
        let mut chosen = vec![0, 24, 45, 66, 90];
        while chosen.len() < 9 {
            let found = misses(&of(&chosen), &[]);
            let counted = found.iter().filter(|m| m.counts());
            let beside = counted.flat_map(|m| &m.beside).map(|[_, angle]| angle.to_degrees());
            // The nearest angle of the matrix that is not there yet.
            let next = beside.map(|a| 3 * (a / 3.0).round() as i64).find(|a| !chosen.contains(a));
            let Some(next) = next else { break };
            chosen.push(next);
        }
        chosen.sort_unstable();
        let fixed = [0, 12, 24, 33, 45, 57, 66, 78, 90];
        claims.add(
            DESIGN,
            &format!("H4LT at {speed_m_s} m/s: worst miss of a cubic through nine angles at the other 22, over the largest of the load"),
            &format!("the reduced matrix's nine: {:.2} %", 100.0 * worst(&fixed)),
            format!("{} by froude cfd suggest, {chosen:?}°: {:.2} %", chosen.len(), 100.0 * worst(&chosen)),
            Verdict::Measured,
        );
    }
    Ok(())
}

/// The largest computed load, and the largest difference of what two estimates of one law give in the computed flows.
fn apart(found: &Identified, one: &Estimate, other: &Estimate, load: &str) -> Option<(f64, f64)> {
    let data = &found.sources.iter().find_map(|s| s.fitted())?.data;
    let law = ForceLaw::of_estimate(one, data).ok()?;
    let response = law.responses.iter().position(|name| name == load)?;
    let forces = |estimate: &Estimate| {
        let values: Option<Vec<f64>> =
            law.coefficients.iter().map(|c| estimate.coefficients.get(&c.name)?.value).collect();
        law.predict(data, &values?).ok()
    };
    let (a, b) = (forces(one)?, forces(other)?);
    let largest = data.values(load)?.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let rows = response * data.rows..(response + 1) * data.rows;
    Some((largest, rows.map(|row| (a[row] - b[row]).abs()).fold(0.0, f64::max)))
}
