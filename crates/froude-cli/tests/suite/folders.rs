//! Keeps the tables of the book's page on limits complete: they list every verb and every input. Each verb changes only the files listed here, which
//! the page names; each reader rejects a file one byte above the limit that the page states.

use crate::bench;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use froude::records::hash::sha256_of_file;

use crate::bench::SHORT;

use crate::bench::SMOOTH_BODY;

const PAGE: &str = include_str!("../../../../book/src/limits.md");

const CFD: &str = "schema = 1\nname = \"computed\"\n[fluid]\ndensity = \"1025 kg/m^3\"\nkinematic_viscosity = \"1.19e-6 m^2/s\"\n\
     [body]\nlink = { major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }\n\
     head_side_area = \"0.011 m^2\"\ntail_side_area = \"0.008 m^2\"\nlink_volume = \"1.2723e-3 m^3\"\n\
     [[source]]\nname = \"CFD\"\nkind = \"cfd\"\n";
const CASES: &str = "cases = \"flow\"\n[source.cfd]\nbody = \"body.toml\"\ncold = 0\niterations = 900\nwindow = 40\n\
     mesh = { stations = 20, layers = 20, azimuth = 8, first_layer = \"0.5 mm\" }\n\
     [[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.4 m/s\"\nangle = [\"0 deg\", \"45 deg\", \"90 deg\"]\n[identify]\nmodels = [\"f1\"]\n";
const SWUNG: &str = "runs = \"swung\"\nmethod = \"forced_oscillation\"\nmodels = [\"f1\"]\n\
     [source.forced_oscillation]\npivot = \"stream\"\nradius = \"476 mm\"\nmass = \"1.5 kg\"\nbuoyancy = \"0 N\"\ncycles = { skip = 1, fewest = 2 }\n\
     [source.cfd]\nbody = \"body.toml\"\nmodel = \"laminar\"\nmesh = { stations = 20, layers = 20, azimuth = 8, first_layer = \"0.5 mm\" }\n\
     [[source.plan]]\nconfigurations = [\"H1LT\"]\namplitude = \"2 deg\"\nfrequency = \"80 deg/s\"\nflow = \"0 m/s\"\nperiods = 3\n";
const PIECE: &str = "schema = 1\nname = \"piece\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\n\
     semi_axis_x = \"1 m\"\nsemi_axis_y = \"0.8 m\"\nsemi_axis_z = \"0.8 m\"\n";
const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";
/// A tetrahedron with one vertex stored twice.
const DUPLICATE_VERTEX: &str = "v 0 0 0\nv 1 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 4 2\nf 1 3 5\nf 1 5 4\nf 2 4 5\n";

/// A verb, its arguments (an underscore is a space within one), and what it writes below the folder that it is called in. Some need what those before
/// them wrote.
type Row = (&'static str, &'static str, &'static [&'static str]);

const ROWS: &[Row] = &[
    ("demo", "demo demo", &["demo/"]),
    ("identify", "identify t.csv", &["t-results/"]),
    ("inspect", "inspect t.csv", &[]),
    ("convert", "convert t.csv t.parquet", &["t.parquet"]),
    ("new", "new table --out fresh", &["fresh/campaign.toml"]),
    ("compare", "compare t-results/estimate.json u-results/estimate.json --out beside", &["beside/"]),
    (
        "predict",
        "predict t-results/estimate.json t.csv --out predicted",
        &["predicted/predicted-", "predicted/froude-files.json"],
    ),
    ("plan", "plan steady.toml", &[]),
    ("simulate", "simulate mamba/campaign.toml", &["mamba/tank.csv", "mamba/froude-files.json"]),
    ("run", "run campaign.toml --yes", &["campaign-runs/"]),
    ("carriage drag", "carriage drag campaign-runs", &["campaign-runs-drag/"]),
    ("carriage calibrate", "carriage calibrate campaign-runs", &["campaign-runs-calibration/"]),
    ("carriage identify", "carriage identify campaign-runs", &["campaign-runs-servo/"]),
    ("carriage tune", "carriage tune campaign.toml --yes", &["campaign-tune/"]),
    ("carriage resonance", "carriage resonance campaign.toml --yes", &["campaign-resonance/"]),
    ("added-mass", "added-mass piece.toml --tolerance 20_%", &["piece-added-mass/"]),
    ("added-mass --repair", "added-mass twice.obj --unit m --repair once.obj", &["once.obj"]),
    ("robot inspect", "robot inspect swim/robot.toml", &[]),
    ("swim", "swim swim/robot.toml --amplitude 30_deg --frequency 80_deg/s --phase 40_deg --out swum", &["swum/"]),
    (
        "swim --sweep",
        "swim swim/robot.toml --frequency 80_deg/s --phase 40_deg --sweep amplitude=20..30_deg:2 --out swept",
        &["swept/sweep.parquet", "swept/report.html", "swept/result.json", "swept/froude-files.json"],
    ),
    (
        "swim --optimise",
        "swim swim/robot.toml --frequency 80_deg/s --phase 40_deg --sweep amplitude=20..30_deg:2 --optimise speed,power --out best",
        &["best/front.parquet", "best/froude-files.json"],
    ),
    ("schema", "schema", &[]),
    ("cfd plan", "cfd plan cfd.toml", &["flow/campaign.json", "flow/cases/", "flow/meshes/", "flow/lock-"]),
    ("cfd status", "cfd status cfd.toml", &[]),
    ("cfd case", "cfd case flow/cases/H1LT-u0.4-a0", &["flow/cases/H1LT-u0.4-a0/"]),
    ("cfd run", "cfd run cfd.toml --jobs 2", &["flow/cases/", "flow/lock-"]),
    ("cfd collect", "cfd collect cfd.toml", &["flow/observations.csv", "flow/froude-files.json"]),
    ("cfd report", "cfd report cfd.toml", &["cfd-cfd/"]),
    ("cfd suggest", "cfd suggest cfd.toml", &[]),
    ("cfd retry", "cfd retry cfd.toml", &["flow/lock-"]),
    ("cfd swing", "cfd swing swing.toml", &["swung/", "swung-cfd/"]),
    ("inspect --write-sidecar", "inspect mamba/tank.csv --write-sidecar", &["mamba/tank.toml"]),
];

/// Verbs that need OpenFOAM or its results.
const NEED_OPENFOAM: [&str; 7] =
    ["cfd case", "cfd run", "cfd collect", "cfd report", "cfd suggest", "cfd retry", "cfd swing"];

/// Files whose names are the user's.
const NAMED_BY_USER: [&str; 4] = ["once.obj", "tank.csv", "tank.toml", "t.parquet"];

fn lab() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().join("lab");
    std::fs::create_dir(&at).unwrap();
    let example = |name: &str| std::fs::read_to_string(examples().join(name)).unwrap();
    let other = TABLE.replace("-0.5", "-0.6");
    let computed = [CFD, CASES].concat();
    let swung = [CFD, SWUNG].concat();
    for (name, text) in [
        ("t.csv", TABLE),
        ("u.csv", &other),
        ("steady.toml", &example("mamba-steady/campaign.toml")),
        ("piece.toml", PIECE),
        ("twice.obj", DUPLICATE_VERTEX),
        ("body.toml", SMOOTH_BODY),
        ("cfd.toml", &computed),
        ("swing.toml", &swung),
    ] {
        std::fs::write(at.join(name), text).unwrap();
    }
    bench::copy(&examples().join("mamba"), &at.join("mamba"));
    bench::copy(&examples().join("mamba-swim"), &at.join("swim"));
    // A calibration needs more than one lift of a weight.
    let changes: Vec<_> = SHORT.into_iter().filter(|(from, _)| *from != "repeats = 6\n").collect();
    bench::campaign(&at, &changes);
    std::fs::create_dir(folder.path().join("home")).unwrap();
    folder
}

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn froude(folder: &Path, args: &[&str]) -> std::process::Output {
    let [at, home] = ["lab", "home"].map(|name| folder.join(name));
    Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(args)
        .current_dir(at)
        .env("HOME", &home)
        .env("TMPDIR", &home)
        .output()
        .unwrap()
}

/// All files below a folder with their SHA-256, and its folders.
fn files(folder: &Path) -> BTreeMap<String, String> {
    let mut out = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                out.insert(name + "/", String::new());
                open.push(path);
            } else {
                out.insert(name, sha256_of_file(&path).unwrap());
            }
        }
    }
    out
}

/// Verbs in the first column of the page's table with what they write by the second; `a b\|c` stands for `a b` and `a c`, and arguments in capitals
/// are left out.
fn verbs_of_the_page() -> BTreeMap<String, String> {
    let table = PAGE.split("| verb | writes | replaces |").nth(1).unwrap();
    let rows = table.trim_start().lines().skip(1).take_while(|line| line.starts_with('|'));
    let mut out = BTreeMap::<String, String>::new();
    for row in rows.map(|row| row.replace("\\|", "/")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        for name in cells[1].split('`').skip(1).step_by(2) {
            let is_verb = |word: &&str| *word != "--out" && word.chars().any(char::is_lowercase);
            let words: Vec<&str> = name.split(' ').filter(is_verb).collect();
            let (last, before) = words.split_last().unwrap();
            for last in last.split('/') {
                out.entry([before, &[last]].concat().join(" ")).or_default().push_str(cells[2]);
            }
        }
    }
    out
}

/// Verbs of the program, by its own help.
fn verbs_of_the_program(folder: &Path, under: &[&str]) -> BTreeSet<String> {
    let help = froude(folder, &[under, &["--help"]].concat());
    let help = String::from_utf8(help.stdout).unwrap();
    let Some(list) = help.split("Commands:\n").nth(1) else { return BTreeSet::from([under.join(" ")]) };
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .flat_map(|name| verbs_of_the_program(folder, &[under, &[name]].concat()))
        .collect()
}

#[test]
fn each_verb_changes_only_its_files_and_the_book_lists_every_verb() {
    let folder = lab();
    let own: BTreeSet<String> = ROWS.iter().map(|(verb, ..)| (*verb).to_owned()).collect();
    let page = verbs_of_the_page();
    assert_eq!(own, page.keys().cloned().collect());
    for (verb, _, writes) in ROWS {
        let cell = &page[*verb];
        let writes_nothing =
            cell == "nothing" || cell.contains(&format!("`{}` writes nothing", verb.replace("cfd ", "")));
        assert_eq!(writes.is_empty(), writes_nothing, "{verb}: {cell}");
        // A folder of results is named by its input.
        let names = writes.iter().filter_map(|place| place.rsplit('/').next()).filter(|name| name.contains(['.', '-']));
        let missing: Vec<&str> = names.filter(|name| !cell.contains(name) && !NAMED_BY_USER.contains(name)).collect();
        assert!(missing.is_empty(), "{verb}: {missing:?} not in {cell}");
    }
    let verbs: BTreeSet<String> = own.iter().filter(|verb| !verb.contains("--")).cloned().collect();
    assert_eq!(verbs, verbs_of_the_program(folder.path(), &[]));

    froude(folder.path(), &["identify", "u.csv"]);
    let mut failures: Vec<String> = Vec::new();
    let has_openfoam = bench::has_openfoam();
    for (verb, args, writes) in ROWS.iter().filter(|(verb, ..)| has_openfoam || !NEED_OPENFOAM.contains(verb)) {
        let before = files(folder.path());
        let args: Vec<String> = args.split(' ').map(|word| word.replace('_', " ")).collect();
        let output = froude(folder.path(), &args.iter().map(String::as_str).collect::<Vec<_>>());
        if output.status.code() != Some(0) {
            failures.push(format!("{verb}: {}", String::from_utf8_lossy(&output.stderr)));
        }
        let after = files(folder.path());
        let names: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
        let changed = names.into_iter().filter(|name| before.get(*name) != after.get(*name));
        let changed: Vec<&str> = changed.map(|name| name.strip_prefix("lab/").unwrap_or(name)).collect();
        // Also the folder of a file that it may write.
        let is_own = |name: &&&str| writes.iter().any(|place| name.starts_with(place) || place.starts_with(**name));
        for name in changed.iter().filter(|name| !is_own(name)) {
            failures.push(format!("{verb} wrote {name}"));
        }
        for place in writes.iter().filter(|place| !changed.iter().any(|name| name.starts_with(**place))) {
            failures.push(format!("{verb} did not write {place}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A row of the page's table of inputs, and readers of such a file: each must reject one that is a byte longer than the row says.
const INPUTS: &[(&str, &[&str])] = &[
    ("table, CSV", &["inspect big.csv", "identify big.csv", "predict t-results/estimate.json big.csv"]),
    ("table, Parquet", &["inspect big.parquet", "identify big.parquet", "predict t-results/estimate.json big.parquet"]),
    ("sidecar, body file, sidecar of a run", &["identify t.csv --sidecar big.toml", "added-mass big.toml --check"]),
    ("workbook", &["inspect big.xlsx"]),
    ("MAT, HDF5", &["inspect big.mat", "inspect big.h5"]),
    (
        "campaign",
        &["identify big.toml", "plan big.toml", "simulate big.toml", "run big.toml --yes", "cfd plan big.toml"],
    ),
    ("estimate record", &["inspect big.json", "compare big.json big.json", "predict big.json t.csv"]),
    (
        "robot, URDF, gait, motor",
        &[
            "robot inspect big.toml",
            "robot inspect big.urdf",
            "swim big.toml --amplitude 30_deg --frequency 80_deg/s --phase 40_deg",
            "swim swim/robot.toml --gait big.toml",
            "swim swim/robot.toml --amplitude 30_deg --frequency 80_deg/s --phase 40_deg --motor big.toml",
        ],
    ),
    ("list of results, notes and sidecars of Froude's own", &["identify t.csv"]),
    ("mesh", &["added-mass big.stl --check", "added-mass big.obj --check", "added-mass big.gdf --check"]),
];

/// A row, a command whose input just exceeds the limit, and the limit as the row states it.
const OVER_LIMIT: &[(&str, &str, &str)] = &[
    ("header, cell of text", "inspect header.csv", "1,000"),
    ("number in a table, a campaign or a sidecar", "inspect number.csv", "10⁵⁰"),
    ("formula of a model", "identify formula.toml", "4,096"),
    (
        "sweep of gaits",
        "swim swim/robot.toml --frequency 80_deg/s --sweep amplitude=1..50_deg:1001,phase=10..80_deg:1000 --out swept",
        "1,000,000",
    ),
    ("computed flows", "cfd plan cells.toml", "20,000,000"),
    ("body by its dimensions", "added-mass long.toml --check", "1 km"),
];

/// Limited by its unpacked size; tested in `limits::a_small_run_cannot_stand_for_gigabytes`.
const RUN: &str = "run (MCAP)";

fn bytes_of(limit: &str) -> u64 {
    let words: Vec<&str> = limit.split([' ', ',', ';']).collect();
    let unit = |word: &str| ["MiB", "GiB"].iter().position(|unit| *unit == word).map(|unit| 20 + 10 * unit);
    let at = words.iter().position(|word| unit(word).is_some()).unwrap_or_else(|| panic!("{limit}"));
    words[at - 1].parse::<u64>().unwrap() << unit(words[at]).unwrap()
}

#[test]
fn inputs_above_the_limits_of_the_book_are_rejected() {
    let table = PAGE.split("| input | limit |").nth(1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let cells = rows.map(|row| row.split('|').map(str::trim).collect::<Vec<_>>());
    let limits: BTreeMap<&str, &str> = cells.map(|cells| (cells[1], cells[2])).collect();
    let held = INPUTS.iter().map(|(row, _)| *row).chain(OVER_LIMIT.iter().map(|(row, ..)| *row)).chain([RUN]);
    assert_eq!(held.collect::<BTreeSet<_>>(), limits.keys().copied().collect());

    let folder = lab();
    let at = folder.path().join("lab");
    froude(folder.path(), &["identify", "t.csv"]);
    let run = |args: &str| {
        let args: Vec<String> = args.split(' ').map(|word| word.replace('_', " ")).collect();
        let output = froude(folder.path(), &args.iter().map(String::as_str).collect::<Vec<_>>());
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (row, readers) in INPUTS {
        let bytes = bytes_of(limits[row]);
        for args in *readers {
            let name = args.split(' ').find(|word| word.starts_with("big.")).unwrap_or("t-results/froude-files.json");
            File::create(at.join(name)).unwrap().set_len(bytes + 1).unwrap();
            let (code, said) = run(args);
            let expected = format!("has {} bytes; the limit for ", bytes + 1);
            assert!(
                code == Some(2) && said.contains(&expected) && said.trim_end().ends_with(&bytes.to_string()),
                "{args}: {said}"
            );
        }
    }

    let formula = format!("v_x * ({}0.0)", "0.0 + ".repeat(700));
    let campaign = format!(
        "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"s\"\nkind = \"tank\"\ntable = \"t.csv\"\n\
         [[identify.model]]\nname = \"m\"\nf_x = \"C_d * {formula}\"\n"
    );
    let cells = [CFD, CASES]
        .concat()
        .replace("stations = 20, layers = 20, azimuth = 8", "stations = 2000, layers = 100, azimuth = 101");
    for (name, text) in [
        (
            "header.csv",
            TABLE.replace("speed [m/s]", &format!("speed [m/s],{}", "x".repeat(1001))).replace("\n0", "\n1,0"),
        ),
        ("number.csv", TABLE.replace("-0.5", "2e50")),
        ("formula.toml", campaign),
        ("cells.toml", cells),
        ("long.toml", PIECE.replace("1 m\"", "1001 m\"")),
    ] {
        std::fs::write(at.join(name), text).unwrap();
    }
    for (row, args, limit) in OVER_LIMIT {
        assert!(limits[row].contains(limit), "{row}: {}", limits[row]);
        let (code, said) = run(args);
        let limit = limit.replace(',', "").replace("10⁵⁰", "1e50").replace("1 km", "1000 m");
        assert!(code == Some(2) && said.contains(&limit), "{args}: {said}");
    }
}
