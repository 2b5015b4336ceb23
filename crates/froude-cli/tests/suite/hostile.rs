//! Nothing that is read makes the program panic, hang, end by a signal, or fail without a sentence.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longest that any of these may take; they take a tenth of a second on an idle machine.
const PATIENCE: Duration = Duration::from_mins(2);

/// What a run said and how it ended.
struct Ended {
    code: Option<i32>,
    said: String,
    told: String,
}

/// Runs the program; it must end by itself with 0, 1 or 2, and with a sentence where it failed.
fn froude(folder: &Path, args: &[&str]) -> Ended {
    let [out, err] = ["out.txt", "err.txt"].map(|name| folder.join(name));
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(File::create(&out).unwrap())
        .stderr(File::create(&err).unwrap())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break Some(status);
        }
        if begun.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let read = |path: &Path| {
        let mut text = Vec::new();
        File::open(path).unwrap().take(1 << 20).read_to_end(&mut text).unwrap();
        String::from_utf8_lossy(&text).into_owned()
    };
    let ended = Ended { code: status.and_then(|s| s.code()), said: read(&out), told: read(&err) };
    let told = &ended.told;
    assert!(status.is_some(), "{args:?} does not end");
    assert!(matches!(ended.code, Some(0..=2)), "{args:?} ends with {status:?}: {told}");
    assert!(!told.contains("panicked") && !told.contains("internal error"), "{args:?}: {told}");
    let is_sentence = told.starts_with("froude: ") || told.starts_with("error: ");
    assert!(ended.code == Some(0) || is_sentence, "{args:?} says why it failed: {told:?}");
    ended
}

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";

#[test]
fn a_load_that_no_test_has_is_refused_with_its_line() {
    let folder = folder(&[("t.csv", &TABLE.replace("-8.1", "-1e308"))]);
    let ended = froude(folder.path(), &["identify", "t.csv"]);
    assert_eq!(ended.code, Some(2));
    assert_eq!(
        ended.told.trim_end(),
        "froude: t.csv:5: column `f_x [N]`: `-1e308` exceeds the limit of 1e50 (SI); correct it or delete the row"
    );
}

#[test]
fn a_fixed_coefficient_of_absurd_size_is_refused_with_its_place() {
    let campaign = "schema = 1\nname = \"x\"\n[[source]]\nname = \"tank\"\nkind = \"tank\"\ntable = \"t.csv\"\n[identify]\n\
                    models = [\"linear_quadratic\"]\nfixed = { D_x_I = 1e300 }\n";
    let folder = folder(&[("t.csv", TABLE), ("c.toml", campaign)]);
    let ended = froude(folder.path(), &["identify", "c.toml"]);
    assert_eq!(ended.code, Some(2));
    assert_eq!(
        ended.told.trim_end(),
        "froude: c.toml:9:19: `D_x_I` is 1e300, which exceeds the limit of 1e50 (SI): correct it"
    );
}

/// Two records whose uncertainties claim to be known with hardly any degrees of freedom: every interval is infinite, and that is said
/// without a panic.
#[test]
fn records_with_hardly_any_degrees_of_freedom_are_compared() {
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/estimate_json/1.json");
    let text = std::fs::read_to_string(seed).unwrap();
    let mut record: serde_json::Value = serde_json::from_str(&text).unwrap();
    fn few(value: &mut serde_json::Value) -> usize {
        match value {
            serde_json::Value::Object(map) => {
                let is_coefficient = map.contains_key("standard_uncertainty");
                if is_coefficient {
                    map.insert("effective_dof".to_owned(), serde_json::json!(1e-300));
                }
                usize::from(is_coefficient) + map.values_mut().map(few).sum::<usize>()
            }
            serde_json::Value::Array(all) => all.iter_mut().map(few).sum(),
            _ => 0,
        }
    }
    assert!(few(&mut record) > 0, "the seed has uncertainties");
    let folder = folder(&[("a.json", &record.to_string()), ("b.json", &text)]);
    froude(folder.path(), &["compare", "a.json", "b.json", "--all"]);
    froude(folder.path(), &["compare", "a.json", "a.json", "--all", "--json"]);
    froude(folder.path(), &["inspect", "a.json"]);
}

/// Sway with its sign turned: a power law in y has nothing to hold on to. It costs its row; what is wrong is found and printed.
#[test]
fn a_power_law_that_cannot_be_fitted_costs_its_row_and_hides_no_finding() {
    let folder = folder(&[("t.csv", TURNED)]);
    let ended = froude(folder.path(), &["identify", "t.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.told);
    let why = "f_y opposes v_y in 2 of the 20 rows that move, and a power law is a resistance: check the sign of f_y, or leave this law out";
    let said = ended.said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains(&format!(" not fitted: power_law_y: {why}")), "{}", ended.said);
    assert!(ended.said.contains("[not-fitted]"), "{}", ended.said);
    assert!(ended.said.contains("[force-along-motion]"), "{}", ended.said);
    assert!(ended.said.contains("also fitted: linear_quadratic, power_law_x"), "{}", ended.said);
    let report = std::fs::read_to_string(folder.path().join("t-results/report.html")).unwrap();
    assert!(report.contains("Not fitted") && report.contains(why), "the report has its row");
    // Asked for alone, it is the error, with what explains it.
    let alone = froude(folder.path(), &["identify", "t.csv", "--models", "power_law"]);
    assert_eq!(alone.code, Some(0), "power_law_x is fitted: {}", alone.told);
}

/// A quadratic drag in x and y at speeds of 0.1 to 0.5 m/s and angles of 0 to 20°, with a scatter of 0.01 N and 0.03 N; the sign of f_y is
/// turned.
const TURNED: &str = "speed [m/s],angle [deg],f_x [N],f_y [N]
0.1,0,-0.02905,0.03750
0.1,5,-0.03909,0.02825
0.1,10,-0.03169,-0.01388
0.1,15,-0.00899,-0.00867
0.1,20,-0.02692,-0.00151
0.2,0,-0.10873,-0.00093
0.2,5,-0.11321,-0.03529
0.2,10,-0.12005,-0.03727
0.2,15,-0.12528,-0.09885
0.2,20,-0.12223,-0.10074
0.3,0,-0.27172,-0.00961
0.3,5,-0.26726,-0.05374
0.3,10,-0.26265,-0.04713
0.3,15,-0.24440,-0.14596
0.3,20,-0.24241,-0.27102
0.4,0,-0.48504,-0.06590
0.4,5,-0.49055,0.00874
0.4,10,-0.48754,-0.07253
0.4,15,-0.44457,-0.22373
0.4,20,-0.41926,-0.35851
0.5,0,-0.73955,-0.00691
0.5,5,-0.75023,-0.05612
0.5,10,-0.73725,-0.15212
0.5,15,-0.70762,-0.30288
0.5,20,-0.68096,-0.61770
";

/// A 1.2 m tank, no force sensor, short weak pulses: the search for the two masses runs away. It costs its method, with a sentence that says so.
#[test]
fn two_masses_that_cannot_be_found_cost_their_method_and_not_the_report() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(example).unwrap();
    let without = |text: &str, from: &str, to: &str| {
        let (head, rest) = text.split_once(from).unwrap();
        format!("{head}{to}{}", rest.split_once(to).unwrap().1)
    };
    text = without(&text, "[rig.force_sensor]", "[rig.twin]");
    text = without(&text, "[carriage.calibration]", "[carriage.excitation]");
    for (from, to) in [
        (r#"travel = ["-0.05 m", "4.95 m"]"#, r#"travel = ["-0.05 m", "1.15 m"]"#),
        (r#"log_rate = "1 kHz""#, r#"log_rate = "2 kHz""#),
        (
            r#"speeds = ["0.05 m/s", "0.15 m/s", "0.25 m/s", "0.35 m/s", "0.45 m/s", "0.55 m/s"]"#,
            r#"speeds = ["0.1 m/s", "0.2 m/s"]"#,
        ),
        (r#"distance = "2.2 m""#, r#"distance = "0.6 m""#),
        ("repeats = 5  ", "repeats = 2  "),
        (r#"settling = { dry = "5 s", wet = "120 s" }"#, r#"settling = { dry = "1 s", wet = "1 s" }"#),
        (r#"still = "5 s""#, r#"still = "1 s""#),
        (
            r#"speeds = ["0.02 m/s", "0.05 m/s", "0.1 m/s", "0.2 m/s", "0.35 m/s", "0.55 m/s"]"#,
            r#"speeds = ["0.1 m/s", "0.2 m/s"]"#,
        ),
        (r#"duration = "1 min""#, r#"duration = "10 s""#),
        (r#"speed = "0.3 m/s""#, r#"speed = "0.2 m/s""#),
        (r#"stop_when = "2.5 %""#, ""),
        (r#"amplitude = "2 V""#, r#"amplitude = "1.1 V""#),
        (r#"period = "1 s""#, r#"period = "0.3 s""#),
    ] {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    let folder = folder(&[("c.toml", &text)]);
    assert_eq!(froude(folder.path(), &["run", "c.toml", "--yes"]).code, Some(0));
    let ended = froude(folder.path(), &["carriage", "drag", "c-runs"]);
    assert_eq!(ended.code, Some(0), "{}", ended.told);
    assert!(ended.said.contains("motor current difference of wet and dry"), "{}", ended.said);
    assert!(ended.said.contains("[two-mass]") || ended.said.contains("(mbdp_flexible)"), "{}", ended.said);
    assert!(folder.path().join("c-runs-drag/report.html").exists());

    // A sidecar that says there are more samples in a second than a computer counts.
    let runs = folder.path().join("c-runs");
    for entry in std::fs::read_dir(&runs).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.contains("pulses") {
            std::fs::remove_file(&path).unwrap();
        } else if path.extension().is_some_and(|e| e == "toml") && name.contains("-wet-p1-") {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.contains("log_rate = \"2000 Hz\""), "{text}");
            std::fs::write(&path, text.replace("log_rate = \"2000 Hz\"", "log_rate = \"1e49 Hz\"")).unwrap();
        }
    }
    for verb in ["drag", "identify", "calibrate"] {
        froude(folder.path(), &["carriage", verb, "c-runs"]);
    }
}

/// Where nothing at all can be written any more, not even the message, the exit code still says it.
#[cfg(target_os = "linux")]
#[test]
fn where_no_message_can_be_written_the_program_ends_with_its_code() {
    let folder = folder(&[("t.csv", TABLE)]);
    for (args, code) in [(["identify", "t.csv"], 1), (["inspect", "t.csv"], 1), (["identify", "gone.csv"], 2)] {
        let [out, err] = [(); 2].map(|()| File::options().write(true).open("/dev/full").unwrap());
        let status = Command::new(env!("CARGO_BIN_EXE_froude"))
            .args(args)
            .current_dir(folder.path())
            .stdout(out)
            .stderr(err)
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{args:?}");
    }
}

/// With less and less memory: done, or a sentence and 1; a sentence of the file where the memory was for a file.
#[cfg(target_os = "linux")]
#[test]
fn without_memory_the_program_ends_with_a_sentence() {
    let mut big = "speed [m/s],f_x [N]\n".to_owned();
    for i in 1..40_000 {
        let speed = 0.01 * f64::from(i % 100 + 1);
        big.push_str(&format!("{speed},{:.4}\n", -3.0 * speed * speed + 1e-3 * f64::from(i % 7)));
    }
    let folder = folder(&[("t.csv", &big)]);
    let limited = |kib: u32, args: &str| -> Output {
        let program = env!("CARGO_BIN_EXE_froude");
        Command::new("sh")
            .args(["-c", &format!("ulimit -v {kib}; exec {program} {args}")])
            .env("RAYON_NUM_THREADS", "2")
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let enough = 4 << 20;
    assert_eq!(limited(enough, "identify t.csv --models quadratic").status.code(), Some(0));
    let (mut failed, mut done, mut is_loaded) = (0, 0, false);
    let mut kib = 30_000;
    while kib < 400_000 {
        let ended = limited(kib, "identify t.csv --models quadratic");
        let told = String::from_utf8_lossy(&ended.stderr).into_owned();
        // Below some tens of megabytes the system cannot even load the program: then it is the system that says so.
        is_loaded |= ended.status.code().is_some();
        match ended.status.code() {
            Some(0) => done += 1,
            Some(1) => {
                assert!(told.contains("memory"), "{kib} KiB: {told:?}");
                failed += 1;
            }
            Some(126 | 127) => {}
            // Where not even its image fits, the system ends it without a word; where that just fits, the standard library, before `main`.
            None if !is_loaded && (told.is_empty() || told.contains("failed to allocate an alternative stack")) => {}
            other => panic!("{kib} KiB: ends with {other:?}: {told:?}"),
        }
        kib += kib / 6;
    }
    assert!(failed > 0 && done > 0, "{failed} {done}: the limits span the need");
}

/// A small generator (Steele, Lea & Flood 2014), so that a failure is found again by its number.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// What is put in place of a number, or anywhere.
const ODD: [&str; 26] = [
    "1e308",
    "-1e308",
    "1e300",
    "1e49",
    "-1e49",
    "1e-300",
    "-1e-300",
    "5e-324",
    "0",
    "-0",
    "-1",
    "1",
    "nan",
    "inf",
    "",
    "1,5",
    "99999999999999999999",
    "4294967296",
    "0x10",
    "\u{202e}",
    "\u{1b}[2J",
    "=1+1",
    "é",
    "[",
    "\"",
    "\n",
];

/// A file with something changed: a number, a line, a byte, its end.
fn mutated(seed: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut out = seed.to_vec();
    for _ in 0..=noise.below(3) {
        if out.is_empty() {
            break;
        }
        let at = noise.below(out.len());
        match noise.below(8) {
            0..=2 => {
                // The next number becomes another one.
                let is_digit = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'-');
                if let Some(from) = (at..out.len()).find(|&i| out[i].is_ascii_digit()) {
                    let to = from + out[from..].iter().take_while(|b| is_digit(b)).count();
                    out.splice(from..to, ODD[noise.below(ODD.len())].bytes());
                }
            }
            3 => {
                out.splice(at..at, ODD[noise.below(ODD.len())].bytes());
            }
            4 => out[at] ^= 1 << noise.below(8),
            5 => {
                let to = (at + 1 + noise.below(40)).min(out.len());
                out.drain(at..to);
            }
            6 => {
                let lines: Vec<Vec<u8>> = out.split_inclusive(|&b| b == b'\n').map(<[u8]>::to_vec).collect();
                let (i, j) = (noise.below(lines.len()), noise.below(lines.len()));
                let mut lines = lines;
                let twice = lines[i].clone();
                lines.insert(j, twice);
                out = lines.concat();
            }
            _ => out.truncate(at),
        }
    }
    out
}

fn seeds(of: &str) -> Vec<(String, Vec<u8>)> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(of);
    let mut out: Vec<(String, Vec<u8>)> = std::fs::read_dir(path)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).unwrap())
        })
        .collect();
    out.sort();
    out
}

fn example(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(path)).unwrap()
}

/// A file of one kind, and what is done with it.
struct Case {
    name: String,
    seed: Vec<u8>,
    /// Files that it needs beside it.
    beside: Vec<(&'static str, Vec<u8>)>,
    verbs: Vec<Vec<&'static str>>,
}

/// Every verb with a seed of every kind of file that it reads.
fn cases() -> Vec<Case> {
    let mut out = Vec::new();
    let mut add = |name: &str, seed: &[u8], beside: &[(&'static str, &[u8])], verbs: &[&[&'static str]]| {
        out.push(Case {
            name: name.to_owned(),
            seed: seed.to_vec(),
            beside: beside.iter().map(|(name, bytes)| (*name, bytes.to_vec())).collect(),
            verbs: verbs.iter().map(|v| v.to_vec()).collect(),
        });
    };
    let towed = (example("unh-rm2/Tare-drag.csv"), example("unh-rm2/Tare-drag.toml"));
    add("t.csv", &towed.0, &[("t.toml", &towed.1)], &[&["identify", "t.csv"], &["inspect", "t.csv"]]);
    add("t.toml", &towed.1, &[("t.csv", &towed.0)], &[&["identify", "t.csv"], &["inspect", "t.csv"]]);
    for table in [TABLE.as_bytes(), TURNED.as_bytes()] {
        add(
            "t.csv",
            table,
            &[],
            &[&["identify", "t.csv"], &["identify", "t.csv", "--models", "power_law_log"], &["inspect", "t.csv"]],
        );
    }
    for (_, seed) in seeds("csv_table") {
        add("t.csv", &seed, &[], &[&["identify", "t.csv"], &["inspect", "t.csv", "--json"]]);
    }
    for (_, seed) in seeds("parquet_table") {
        add("t.parquet", &seed, &[], &[&["identify", "t.parquet"], &["inspect", "t.parquet"]]);
    }
    let tank = b"configuration,setup,speed [m/s],angle [deg],f_x [N],f_y [N]\nH1LT,a,0.1,3,-0.1,0.01\nH1LT,a,0.2,10,-0.4,0.1\n\
                 H2LT,a,0.3,20,-0.9,0.4\nH2LT,b,0.4,30,-1.5,0.9\nH3LT,b,0.3,5,-0.9,0.1\nH3LT,b,0.5,15,-2.4,0.7\n";
    for (_, seed) in seeds("campaign") {
        let beside: [(&'static str, &[u8]); 2] = [("tank.csv", tank), ("twin.csv", tank)];
        add(
            "c.toml",
            &seed,
            &beside,
            &[&["identify", "c.toml"], &["inspect", "c.toml"], &["simulate", "c.toml", "--replace"]],
        );
    }
    let mine = b"schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nreference_length = \"1 m\"\nreference_area = \"0.1 m^2\"\n\
        [[source]]\nname = \"tank\"\nkind = \"tank\"\ntable = \"tank.csv\"\nkeep = \"speed > 0.05 m/s\"\n[[source.uncertainty]]\n\
        quantity = \"f_x\"\nstandard = \"1 %\"\nshared = \"campaign\"\ndof = 9\n[[source.uncertainty]]\nquantity = \"speed\"\n\
        standard = \"1 mm/s\"\nshared = \"sample\"\n[identify]\nmodels = [\"quadratic\", \"power_law\"]\n\
        fixed = { D_x_I = 0.5 }\nbounds = { D_x_II = [0.1, 30] }\n[[identify.model]]\nname = \"mine\"\nf_x = \"-a*v_x - b*v_x*abs(v_x)\"\n";
    add("c.toml", mine, &[("tank.csv", tank)], &[&["identify", "c.toml"], &["inspect", "c.toml"]]);
    for (_, seed) in seeds("estimate_json") {
        add(
            "e.json",
            &seed,
            &[("f.json", &seed)],
            &[&["compare", "e.json", "f.json", "--all"], &["inspect", "e.json"]],
        );
    }
    for (_, seed) in seeds("run_mcap") {
        let verbs: [&[&'static str]; 4] = [
            &["inspect", "r.mcap"],
            &["carriage", "drag", "r.mcap"],
            &["carriage", "identify", "r.mcap"],
            &["carriage", "calibrate", "r.mcap"],
        ];
        add("r.mcap", &seed, &[], &verbs);
    }
    for (_, seed) in seeds("sidecar") {
        let table = b"speed_col,force\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n";
        add("t.toml", &seed, &[("t.csv", table)], &[&["identify", "t.csv"], &["inspect", "t.csv"]]);
    }
    for (kind, seed) in seeds("mesh_file") {
        let name: &'static str = match kind.split('-').next() {
            Some("stl") => "m.stl",
            Some("obj") => "m.obj",
            Some("ply") => "m.ply",
            Some("gdf") => "m.gdf",
            Some("dat") => "m.dat",
            _ => "m.msh",
        };
        // The first byte picks the format in the fuzzer.
        add(
            name,
            &seed[1..],
            &[],
            &[&["added-mass", name, "--check"], &["added-mass", name, "--most-panels", "300", "--tolerance", "50 %"]],
        );
    }
    let body = example("mamba-necked/body.toml");
    add(
        "body.toml",
        &body,
        &[],
        &[
            &["added-mass", "body.toml", "--links", "1", "--most-panels", "300", "--tolerance", "50 %"],
            &["added-mass", "body.toml", "--links", "2", "--check"],
        ],
    );
    let carriage = example("towing-carriage/campaign.toml");
    add("c.toml", &carriage, &[], &[&["run", "c.toml", "--check"], &["inspect", "c.toml"]]);
    out
}

/// As many changed files as FROUDE_TEST_MUTATIONS says, through the verb that reads them. Run with 8,000 before a release.
#[test]
fn no_changed_file_makes_any_verb_fail_without_a_sentence() {
    let wanted = std::env::var("FROUDE_TEST_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(240);
    let first = std::env::var("FROUDE_TEST_FIRST").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    let cases = cases();
    let turns: Vec<(usize, usize)> =
        cases.iter().enumerate().flat_map(|(i, c)| (0..c.verbs.len()).map(move |j| (i, j))).collect();
    let folder = tempfile::tempdir().unwrap();
    for k in first..first + wanted {
        let (i, j) = turns[k % turns.len()];
        let Case { name, seed, beside, verbs } = &cases[i];
        let mut noise = Noise(k as u64);
        // Every seed once as it is.
        let bytes = if k < turns.len() { seed.clone() } else { mutated(seed, &mut noise) };
        let work = folder.path().join("work");
        std::fs::create_dir(&work).unwrap();
        for (name, bytes) in beside {
            std::fs::write(work.join(name), bytes).unwrap();
        }
        std::fs::write(work.join(name), &bytes).unwrap();
        let outcome = std::panic::catch_unwind(|| froude(&work, &verbs[j]));
        if outcome.is_err() {
            let kept = std::env::temp_dir().join(format!("froude-mutation-{k}"));
            let _ = std::fs::create_dir_all(&kept);
            let _ = std::fs::write(kept.join(name), &bytes);
            panic!("mutation {k} (FROUDE_TEST_FIRST={k} FROUDE_TEST_MUTATIONS=1), file in {}", kept.display());
        }
        std::fs::remove_dir_all(&work).unwrap();
    }
}
