//! Force files of cases that others computed, from folder to coefficients.
//!
//! Twelve cases at three speeds and four drift angles. The whole body has X_uu −3.9, Y_uv −24, Y_vv −98 kg/m and N_uv −11 kg; each case settles by an oscillation that decays.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use froude_cfd::forces::inspect::inspect;
use froude_cfd::forces::source::OpenFoamForces;
use froude_identify::method::{Found, Method, MethodError};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::Coefficient;

/// How the files of a folder of cases are written.
#[derive(Clone, Copy)]
struct Written {
    /// Loads in the mesh by those of the whole body, body axes.
    mesh: fn([f64; 6], f64) -> [f64; 6],
    /// The forces times this.
    scale: f64,
    family: Family,
}

#[derive(Clone, Copy, PartialEq)]
enum Family {
    Com,
    Org,
    Coefficients,
}

/// x forward, z down: the axes of the body.
const AS_BODY: Written = Written { mesh: |loads, _| loads, scale: 1.0, family: Family::Com };

/// Loads of the whole body, N and N m, at a drift angle in rad.
fn loads(speed: f64, angle: f64) -> [f64; 6] {
    let (u, v) = (speed * angle.cos(), -speed * angle.sin());
    [-3.9 * u * u, -24.0 * u * v - 98.0 * v * v.abs(), 0.0, 0.0, 0.0, -11.0 * u * v]
}

fn case(folder: &Path, name: &str, at: [f64; 2], w: Written, rows: std::ops::RangeInclusive<u32>, start: &str) {
    let [speed, angle] = at;
    let steady = (w.mesh)(loads(speed, angle), angle).map(|load| w.scale * load);
    let object = if w.family == Family::Coefficients { "forceCoeffs" } else { "forces" };
    let place = folder.join(name).join("postProcessing").join(object).join(start);
    std::fs::create_dir_all(&place).unwrap();
    let columns: Vec<String> = ["total", "pressure", "viscous"]
        .iter()
        .flat_map(|part| ["x", "y", "z"].map(|axis| format!("{part}_{axis}")))
        .collect();
    let head =
        |title: &str| format!("# {title}\n# CofR                : (0 0 0)\n# Time          \t{}\n", columns.join("\t"));
    let (mut force, mut moment) = (head("Force"), head("Moment"));
    let mut both = "# Forces\n# CofR : (0 0 0)\n# Time forces(pressure viscous) moments(pressure viscous)\n".to_owned();
    let mut coefficients = format!(
        "# Force coefficients\n# dragDir : (1 0 0)\n# sideDir : (0 1 0)\n# liftDir : (0 0 1)\n# rollAxis : (1 0 0)\n# pitchAxis : (0 1 0)\n# yawAxis : (0 0 1)\n# magUInf : {speed}\n# lRef : 2\n# Aref : 0.5\n# CofR : (0 0 0)\n# Time\tCd\tCs\tCl\tCmRoll\tCmPitch\tCmYaw\n"
    );
    for i in rows {
        let time = f64::from(i) * 0.1;
        let settles = 1.0 + 0.4 * (-f64::from(i) / 25.0).exp() * (f64::from(i) / 9.0).cos();
        let now = steady.map(|load| load * settles);
        let line = |three: &[f64]| {
            let part = |share: f64| three.iter().map(|x| format!("{:.6e}", share * x)).collect::<Vec<_>>().join("\t");
            format!("{time}\t{}\t{}\t{}\n", part(1.0), part(0.4), part(0.6))
        };
        force += &line(&now[..3]);
        moment += &line(&now[3..]);
        let group =
            |three: &[f64], share: f64| three.iter().map(|x| format!("{:.8}", share * x)).collect::<Vec<_>>().join(" ");
        let pair = |three: &[f64]| format!("(({}) ({}))", group(three, 0.4), group(three, 0.6));
        writeln!(both, "{time} {} {}", pair(&now[..3]), pair(&now[3..])).unwrap();
        let q = 0.5 * 998.0 * speed * speed * 0.5;
        let of: Vec<String> =
            now.iter().enumerate().map(|(k, load)| format!("{:.9e}", load / if k < 3 { q } else { 2.0 * q })).collect();
        writeln!(coefficients, "{time}\t{}", of.join("\t")).unwrap();
    }
    match w.family {
        Family::Com => {
            std::fs::write(place.join("force.dat"), force).unwrap();
            std::fs::write(place.join("moment.dat"), moment).unwrap();
        }
        Family::Org => std::fs::write(place.join("forces.dat"), both).unwrap(),
        Family::Coefficients => std::fs::write(place.join("coefficient.dat"), coefficients).unwrap(),
    }
}

fn settings() -> Vec<(String, [f64; 2])> {
    let mut out = Vec::new();
    for speed in [1.0, 1.5, 2.0] {
        for degrees in [0.0, 4.0, 8.0, 12.0_f64] {
            out.push((format!("U{speed}_b{degrees}"), [speed, degrees.to_radians()]));
        }
    }
    out
}

fn folder(w: Written) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, at) in settings() {
        case(&folder.path().join("cases"), &name, at, w, 1..=200, "0");
    }
    folder
}

const SECTION: &str = "pattern = \"U{speed [m/s]}_b{angle [deg]}\"\nforward = \"x\"\nup = \"-z\"\nturned = \"inflow\"\nsymmetry = \"none\"\nrho_inf = \"998 kg/m^3\"\n";

fn campaign(folder: &Path, section: &str) -> PathBuf {
    let path = folder.join("c.toml");
    let text = format!(
        "schema = 1\nname = \"hull\"\n[fluid]\ndensity = \"998 kg/m^3\"\n[[source]]\nname = \"openfoam\"\nkind = \"cfd\"\nruns = \"cases\"\nmethod = \"openfoam_forces\"\n[source.openfoam_forces]\n{section}"
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn identified(folder: &Path, section: &str) -> Result<Found, MethodError> {
    let campaign = read_campaign(&campaign(folder, section))?;
    OpenFoamForces.identify(&campaign, &campaign.sources[0], &["openfoam_forces"], &|_| {})
}

/// The recommended estimate's coefficients are the truth, inside their intervals, and these are narrow.
fn is_the_truth(found: &Found) {
    let estimate = found.results[0].estimates().iter().find(|e| e.recommended).unwrap();
    let truths = [("D_x_II", 3.9), ("Y_uv", -24.0), ("D_y_II", 98.0), ("N_uv", -11.0)];
    for (name, truth) in truths {
        let c: &Coefficient = &estimate.coefficients[name];
        let [low, high] = c.interval_95.unwrap();
        assert!((low..=high).contains(&truth), "{name}: {low} to {high} is without {truth}");
        assert!(high - low < 0.02 * f64::abs(truth), "{name}: {low} to {high}");
    }
}

fn codes(found: &Found) -> Vec<&str> {
    found.findings.iter().map(|finding| finding.code.as_str()).collect()
}

fn said<'a>(found: &'a Found, code: &str) -> &'a str {
    found
        .findings
        .iter()
        .find(|f| f.code == code)
        .map_or_else(|| panic!("{code} is not in {:?}", codes(found)), |f| f.message.as_str())
}

#[test]
fn both_families_and_coefficients_give_the_truth_of_the_whole_body() {
    for family in [Family::Com, Family::Org, Family::Coefficients] {
        let folder = folder(Written { family, ..AS_BODY });
        is_the_truth(&identified(folder.path(), SECTION).unwrap());
    }
}

#[test]
fn half_of_the_body_is_doubled_and_the_window_said() {
    let folder = folder(Written { scale: 0.5, ..AS_BODY });
    let found = identified(folder.path(), &SECTION.replace("none", "z = 0")).unwrap();
    is_the_truth(&found);
    assert!(
        said(&found, "openfoam-read").contains("half of the body up to the plane z = 0"),
        "{}",
        said(&found, "openfoam-read")
    );
    let window = said(&found, "openfoam-window");
    assert!(
        window.starts_with(
            "loads are means from the time 15.1 to 20, of cases that begin at 0.1; the start-up transient"
        ),
        "{window}"
    );
    let steps = &found.results[0].files()[0].steps;
    let [from, to] = ["from", "to"].map(|name| steps[0].parameters[name].value);
    assert!((from - 15.1).abs() < 1e-9 && (to - 20.0).abs() < 1e-9, "{steps:?}");
}

#[test]
fn half_of_the_body_that_is_declared_whole_is_doubted() {
    // The pressure on the half above the plane z = 0 presses it down.
    let half =
        Written { mesh: |[x, y, _, k, m, n], _| [x, y, 0.4 * x.abs(), k, m, n], scale: 0.5, family: Family::Com };
    let found = identified(folder(half).path(), SECTION).unwrap();
    let doubt = said(&found, "openfoam-half");
    assert!(doubt.starts_with("symmetry = \"none\", and f_z is 1.755 N in U1.5_b0 (likewise "), "{doubt}");
    let advice = "a whole, symmetric body in a single-phase flow has none. If the mesh ends at a plane of symmetry, write symmetry = \"z = 0\"; if the loads include buoyancy or lift, ignore this";
    assert!(doubt.ends_with(advice), "{doubt}");
    assert!(!codes(&identified(folder(AS_BODY).path(), SECTION).unwrap()).contains(&"openfoam-half"));
}

#[test]
fn a_mesh_along_the_flow_over_the_density_is_the_same_body() {
    // The water flows along +x and z is up.
    let inflow =
        Written { mesh: |[x, y, z, k, m, n], _| [-x, y, -z, -k, m, -n], scale: 1.0 / 998.0, family: Family::Com };
    let along = SECTION.replace("forward = \"x\"", "forward = \"-x\"").replace("\"-z\"", "\"z\"");
    let over_density = along.replace("998 kg", "1 kg");
    is_the_truth(&identified(folder(inflow).path(), &over_density).unwrap());
    // The body is turned in the mesh instead: loads are along the axes of the flow.
    let turned = Written {
        mesh: |[x, y, z, k, m, n], angle| {
            let (sin, cos) = angle.sin_cos();
            [-(x * cos - y * sin), x * sin + y * cos, -z, -(k * cos - m * sin), k * sin + m * cos, -n]
        },
        ..AS_BODY
    };
    is_the_truth(&identified(folder(turned).path(), &along.replace("\"inflow\"", "\"body\"")).unwrap());
}

#[test]
fn speeds_come_from_a_list_or_from_the_inflow_of_each_case() {
    let folder = folder(AS_BODY);
    let mut list = "case,speed [m/s],angle [deg]\n".to_owned();
    for (name, [speed, angle]) in settings() {
        writeln!(list, "{name},{speed},{}", angle.to_degrees()).unwrap();
        let zero = folder.path().join("cases").join(&name).join("0");
        std::fs::create_dir_all(&zero).unwrap();
        let inflow = format!("internalField   uniform ({} {} 0);\n", -speed * angle.cos(), speed * angle.sin());
        std::fs::write(zero.join("U"), format!("dimensions [0 1 -1 0 0 0 0];\n{inflow}")).unwrap();
    }
    std::fs::write(folder.path().join("cases.csv"), list).unwrap();
    let without = SECTION.replace("pattern = \"U{speed [m/s]}_b{angle [deg]}\"\n", "");
    is_the_truth(&identified(folder.path(), &format!("list = \"cases.csv\"\n{without}")).unwrap());
    let found = identified(folder.path(), &without).unwrap();
    is_the_truth(&found);
    // A case whose inflow is another contradicts its name.
    std::fs::write(folder.path().join("cases/U1_b4/0/U"), "internalField uniform (-1.2 0 0);\n").unwrap();
    let found = identified(folder.path(), SECTION).unwrap();
    let inflow = said(&found, "openfoam-inflow");
    assert!(inflow.contains("U1_b4: its inflow in 0/U is (-1.2000 0.0000 0.0000) m/s, and (-0.9976 0.0698 0.0000) by its speed and angle"), "{inflow}");
}

#[test]
fn a_restart_continues_and_takes_the_place_of_what_it_repeats() {
    let folder = tempfile::tempdir().unwrap();
    for (name, at) in settings() {
        let cases = folder.path().join("cases");
        case(&cases, &name, at, Written { scale: 3.0, ..AS_BODY }, 1..=100, "0");
        case(&cases, &name, at, AS_BODY, 50..=200, "5");
    }
    let found = identified(folder.path(), SECTION).unwrap();
    is_the_truth(&found);
    assert!(
        said(&found, "openfoam-files").contains("repeats 51 rows, and takes their place"),
        "{}",
        said(&found, "openfoam-files")
    );
}

#[test]
fn a_case_that_has_not_settled_is_left_out_by_name() {
    let folder = folder(AS_BODY);
    let cases = folder.path().join("cases");
    std::fs::remove_dir_all(cases.join("U2_b12")).unwrap();
    case(&cases, "U2_b12", [2.0, 12_f64.to_radians()], AS_BODY, 1..=24, "0");
    std::fs::create_dir_all(cases.join("old")).unwrap();
    std::fs::rename(cases.join("U1_b8/postProcessing"), cases.join("old/postProcessing")).unwrap();
    std::fs::remove_dir(cases.join("U1_b8")).unwrap();
    let found = identified(folder.path(), SECTION).unwrap();
    let missing = said(&found, "openfoam-cases-missing");
    assert!(
        missing.starts_with("1 case has no usable mean loads: U2_b12: its mean load still changes by "),
        "{missing}"
    );
    assert_eq!(said(&found, "openfoam-cases-left-out"), "1 folder with force files is not among the cases: old");
}

#[test]
fn what_is_not_stated_is_asked_and_what_cannot_be_is_refused() {
    let folder = folder(AS_BODY);
    let refused = |section: &str| {
        identified(folder.path(), section).err().map_or_else(|| panic!("{section} was read"), |e| e.to_string())
    };
    for (from, to, expected) in [
        ("forward = \"x\"\n", "", "has no `forward`; write forward = \"-x\""),
        ("symmetry = \"none\"\n", "", "has no `symmetry`; write symmetry = \"none\""),
        (
            "rho_inf = \"998 kg/m^3\"\n",
            "",
            "write rho_inf = \"998 kg/m^3\", as rhoInf is in the function object (system/controlDict), or rho_inf = \"1 kg/m^3\"",
        ),
        ("turned = \"inflow\"\n", "", "U1.5_b12 has a drift of 12.0000°. Write turned = \"inflow\""),
        ("none", "y = 0", "is \"y = 0\", the plane along the body's middle, and U1.5_b12 has a drift"),
        ("none", "x = 0", "is \"x = 0\", a plane across the body's axis forward"),
        ("up = \"-z\"", "up = \"-x\"", "they lie along one axis of the mesh"),
        ("{speed [m/s]}", "{speed}", "{speed} has no unit: write {speed [m/s]}"),
        ("pattern = \"U", "pattern = \"V", "matches the pattern \"V{speed [m/s]}_b{angle [deg]}\": U1.5_b0, U1.5_b12"),
        ("pattern = \"U{speed [m/s]}_b{angle [deg]}\"\n", "", "0/U has no line `internalField uniform"),
        ("none\"", "none\"\nobject = \"bow\"", "no force files of the function object \"bow\"; it has forces"),
        ("none\"", "none\"\norigin = \"1, 0, 0\"", "write three lengths: \"0 m, 0 m, -0.2 m\""),
        (
            "none\"",
            "none\"\ncentre_of_rotation = \"1 m, 0 m, 0 m\"",
            "state CofR [0.0, 0.0, 0.0]; leave out the wrong one",
        ),
        ("none\"", "none\"\nwindow = 15", "`window` is 15, and the case lasts 19.9"),
    ] {
        assert!(SECTION.contains(from), "{from}");
        let found = refused(&SECTION.replacen(from, to, 1));
        assert!(found.contains(expected), "{from} → {to}: {found}");
    }
    let cases = folder.path().join("cases");
    let system = cases.join("U1_b0/system");
    std::fs::create_dir_all(&system).unwrap();
    let stated = |kind: &str| {
        let text = format!("type {kind};\nrho rhoInf;\n    rhoInf 1000; // fresh\n");
        std::fs::write(system.join("controlDict"), text).unwrap();
    };
    // Coefficients beside the forces have a density of their own.
    stated("forceCoeffs");
    identified(folder.path(), SECTION).unwrap();
    stated("forces");
    let found = refused(SECTION);
    assert!(found.contains("is 998 kg/m^3, and rhoInf is 1000 in ") && found.contains("controlDict"), "{found}");
    std::fs::remove_dir_all(&system).unwrap();
    let start = cases.join("U1_b0/postProcessing/forces/0");
    std::fs::copy(start.join("force.dat"), start.join("force_0.dat")).unwrap();
    assert!(refused(SECTION).contains("force_0.dat and force.dat are two runs from one start"));
    std::fs::remove_file(start.join("force_0.dat")).unwrap();
    std::fs::copy(start.join("force.dat"), start.join("moment.dat")).unwrap();
    assert!(refused(SECTION).contains("its comment lines are those of forces (force.dat); expected those of moments"));
}

#[test]
fn inspection_says_what_a_folder_a_case_and_a_file_hold() {
    let folder = folder(AS_BODY);
    let cases = folder.path().join("cases");
    let found = inspect(&cases).unwrap().unwrap();
    assert_eq!(found.kind, "openfoam forces");
    assert_eq!(found.facts[0].1, "12 cases of OpenFOAM with force files");
    assert_eq!(
        found.facts[1],
        ("U1.5_b0".to_owned(), "force.dat in forces, 200 rows, time 0.1 to 20, CofR (0 0 0)".to_owned())
    );
    assert_eq!(inspect(&cases.join("U1_b0")).unwrap().unwrap().facts[0].1, "1 case of OpenFOAM with force files");
    let file = inspect(&cases.join("U1_b0/postProcessing/forces/0/moment.dat")).unwrap().unwrap();
    assert_eq!((file.kind.as_str(), file.facts[0].1.as_str()), ("openfoam force file", "moments, 200 rows"));
    assert!(inspect(folder.path()).unwrap().is_none());
}
