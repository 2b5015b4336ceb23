//! What somebody meets who uses the program for the first time: a file of another kind, a header as laboratories write it, a question at the
//! terminal, the exit code of a result with errors among its findings, and numbers of one.

use crate::board;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::bench::{Bench, SHORT, campaign, findings_of, froude, id, json, printed, refusal, text};

fn example(name: &str) -> String {
    text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)).to_owned()
}

#[test]
fn a_file_of_another_kind_is_called_what_it_is_with_the_command_that_takes_it() {
    let bench = Bench::new();
    bench.drag();
    let (campaign, runs) = (text(&bench.campaign), text(&bench.runs));
    let results = format!("{runs}-drag");
    let record = format!("{results}/estimate.json");
    let (body, hull) = (example("mamba-necked/body.toml"), bench.folder.path().join("hull.stl"));
    std::fs::write(&hull, "solid hull\nendsolid hull\n").unwrap();
    let table = bench.folder.path().join("t.csv");
    std::fs::write(&table, "U,f\n0.1,-0.2\n").unwrap();
    std::fs::write(table.with_extension("toml"), "schema = 1\n[columns]\nU = { name = \"speed\", unit = \"m/s\" }\n")
        .unwrap();
    let sidecar = table.with_extension("toml");
    let (table, sidecar, hull) = (text(&table), text(&sidecar), text(&hull));
    let empty = bench.folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let of_runs = "folders of runs, or runs (.mcap)";
    let of_files =
        "a table (.csv, .xlsx, .parquet, …), a campaign (.toml), a record (.json), a run (.mcap) or a folder of runs";
    for (args, told) in [
        (
            vec!["carriage", "drag", campaign],
            format!(
                "{campaign} is a campaign; froude carriage drag takes {of_runs}. Its runs are in {runs}: froude carriage drag {runs}"
            ),
        ),
        (
            vec!["carriage", "calibrate", campaign],
            format!(
                "{campaign} is a campaign; froude carriage calibrate takes {of_runs}. Its runs are in {runs}: froude carriage calibrate {runs}"
            ),
        ),
        (
            vec!["carriage", "identify", campaign],
            format!(
                "{campaign} is a campaign; froude carriage identify takes folders of runs, runs (.mcap), or a servo log (.csv). Its runs are \
                 in {runs}: froude carriage identify {runs}"
            ),
        ),
        (
            vec!["carriage", "drag", &results],
            format!(
                "{results} is a folder of results; froude carriage drag takes {of_runs}. Its record: froude inspect {record}; its report: \
                 {results}/report.html"
            ),
        ),
        (
            vec!["carriage", "drag", &record],
            format!(
                "{record} is a record; froude carriage drag takes {of_runs}. To see what is in it: froude inspect {record}"
            ),
        ),
        (
            vec!["inspect", &body],
            format!(
                "{body} is a body file; froude inspect takes {of_files}. To compute with it: froude added-mass {body}"
            ),
        ),
        (
            vec!["inspect", &results],
            format!(
                "{results} is a folder of results; froude inspect takes {of_files}. Its record: froude inspect {record}; its report: \
                 {results}/report.html"
            ),
        ),
        (
            vec!["inspect", text(&empty)],
            format!(
                "{} is a folder; froude inspect takes {of_files}. It holds no run; froude run CAMPAIGN drives them and prints where they are",
                text(&empty)
            ),
        ),
        (
            vec!["inspect", sidecar],
            format!(
                "{sidecar} is the sidecar of a table; froude inspect takes {of_files}. It describes the columns of {table}; name the table instead: \
                 froude inspect {table}"
            ),
        ),
        (
            vec!["inspect", hull],
            format!("{hull} is a mesh; froude inspect takes {of_files}. To compute with it: froude added-mass {hull}"),
        ),
        (
            vec!["identify", runs],
            format!(
                "{runs} is a folder of runs; froude identify takes a campaign (.toml) or a table (.csv, .xlsx, .parquet, …). To reduce it: froude carriage \
                 drag {runs}; to see what is in it: froude inspect {runs}"
            ),
        ),
        (
            vec!["run", &body],
            format!(
                "{body} is a body file; froude run takes a campaign with [rig] and [carriage] (.toml). To compute with it: froude added-mass {body}"
            ),
        ),
        (
            vec!["compare", campaign],
            format!(
                "{campaign} is a campaign; froude compare takes records (estimate.json). To drive it: froude run {campaign}"
            ),
        ),
        (
            vec!["added-mass", campaign],
            format!(
                "{campaign} is a campaign; froude added-mass takes a body file (.toml) or a closed mesh (.stl, .obj, …). To drive it: froude run {campaign}"
            ),
        ),
    ] {
        assert_eq!(refusal(&args), format!("froude: {told}\n"), "{args:?}");
    }
    // Not driven yet.
    let other = bench.folder.path().join("other.toml");
    std::fs::copy(campaign, &other).unwrap();
    let told = refusal(&["carriage", "drag", text(&other)]);
    assert!(told.ends_with(&format!(". Drive it first: froude run {}\n", text(&other))), "{told}");
    // A fault in a file of the right kind is told with its line.
    let broken = std::fs::read_to_string(campaign).unwrap().replace("repeats = 2  ", "repeats = \"two\"  ");
    std::fs::write(&other, broken).unwrap();
    let told = refusal(&["run", text(&other), "--check"]);
    assert!(told.starts_with(&format!("froude: {}:", text(&other))), "{told}");
    // Sidecars that lost their logs.
    for log in bench.logs("") {
        std::fs::remove_file(log).unwrap();
    }
    let told = refusal(&["inspect", runs]);
    let gone = format!(
        "froude: {runs}: 17 sidecars of runs and no log: copy the .mcap files back, or froude run drives them again\n"
    );
    assert_eq!(told, gone);
}

#[test]
fn a_unit_in_round_parentheses_is_answered_with_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("tank.csv");
    let rows = "1,0.1,-0.2\n2,0.2,-0.81\n3,0.3,-1.83\n4,0.4,-3.19\n";
    std::fs::write(&table, format!("run,U (m/s),Fx (N)\n{rows}")).unwrap();
    let told = refusal(&["inspect", text(&table)]);
    let shown = text(&table);
    assert_eq!(
        told,
        format!(
            "froude: {shown}:1: column `U [m/s]` would not be used; is it speed?\n1 more thing keeps this table from being read:\n  \
             - column `Fx [N]`: would not be used; is it f_x?\nfroude inspect {shown} --write-sidecar writes {}, which proposes names, units \
             and signs for you to check and correct\n",
            text(&table.with_extension("toml"))
        )
    );
    // What was proposed is what is read.
    printed(&["inspect", text(&table), "--write-sidecar"]);
    assert_eq!(json(&["identify", text(&table), "--json"])["estimates"][0]["n"], 4);

    // A drag is written positive: renaming it would make it a thrust.
    std::fs::remove_file(table.with_extension("toml")).unwrap();
    std::fs::write(&table, format!("run,U (m/s),drag (N)\n{}", rows.replace('-', ""))).unwrap();
    printed(&["inspect", text(&table), "--write-sidecar"]);
    let fitted = json(&["identify", text(&table), "--json"]);
    assert_eq!(fitted["estimates"][0]["n"], 4);
    assert!(findings_of(&fitted, "load-along-motion").is_empty(), "{}", fitted["findings"]);

    // No headers at all.
    std::fs::remove_file(table.with_extension("toml")).unwrap();
    std::fs::write(&table, "0.1,-0.2\n0.2,-0.81\n").unwrap();
    let told = refusal(&["inspect", text(&table)]);
    assert!(told.contains("tank.csv:1: there are numbers where the columns should be named"), "{told}");
}

/// The rule of the book: an error among the findings is for a person to read, and the result is there.
#[test]
fn a_finding_of_grade_error_does_not_change_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("tank.csv");
    std::fs::write(&table, "speed [m/s],f_x [N]\n0.1,0.2\n0.2,0.81\n0.3,1.83\n0.4,3.19\n").unwrap();
    for verb in ["inspect", "identify"] {
        let out = froude(&[verb, text(&table)]);
        assert_eq!(out.status.code(), Some(0));
        assert!(String::from_utf8_lossy(&out.stdout).contains("ERROR  "), "{verb}");
    }
    assert!(folder.path().join("tank-results/estimate.json").exists());
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../README.md")).unwrap();
    assert!(readme.contains("A finding does not change the exit code, not even one of grade\n*error*"));
}

/// What a terminal shows of a drive on the twin, whose questions are answered with `y`.
fn at_a_terminal(campaign: &Path) -> String {
    let (keyboard, screen) = board::keyboard().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["run", text(campaign)])
        .stdin(screen.try_clone().unwrap())
        .stdout(Stdio::null())
        .stderr(screen)
        .spawn()
        .unwrap();
    let (mut reads, mut types) = (keyboard.try_clone().unwrap(), keyboard);
    let (chunks, read) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let mut chunk = [0_u8; 4096];
        while let Ok(n @ 1..) = reads.read(&mut chunk) {
            let _ = chunks.send(chunk[..n].to_vec());
        }
    });
    let (mut shown, mut answered, begun) = (Vec::new(), 0, Instant::now());
    let is_asked = |shown: &[u8]| String::from_utf8_lossy(shown).matches("confirm with y").count();
    while begun.elapsed() < Duration::from_mins(2) {
        if let Ok(chunk) = read.recv_timeout(Duration::from_millis(100)) {
            shown.extend(chunk);
            continue;
        }
        // Nothing came for a while: either it waits for an answer, or it computes.
        if is_asked(&shown) > answered {
            answered += 1;
            types.write_all(b"y\n").unwrap();
        } else if child.try_wait().unwrap().is_some() {
            break;
        }
    }
    let _ = child.kill();
    let status = child.wait().unwrap();
    let shown = String::from_utf8_lossy(&shown).into_owned();
    assert!(status.success(), "{status}: {shown}");
    shown
}

#[test]
fn a_question_has_its_line_for_itself_and_the_twin_says_that_it_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let mut changes = SHORT.to_vec();
    changes[1] = ("repeats = 5  ", "repeats = 1  ");
    let shown = at_a_terminal(&campaign(folder.path(), &changes));
    let questions: Vec<&str> = shown.split(">>> ").skip(1).collect();
    // Homing, the body, the weight on and off, the body into the water.
    assert_eq!(questions.len(), 5, "{shown}");
    for question in &questions {
        let line = question.split('\n').next().unwrap();
        assert!(line.starts_with("on the twin: ") && line.contains("(anything else stops): "), "{line:?}");
        assert!(!line.contains("/13"), "the bar is on the line of the question: {line:?}");
    }
    // The bar was there, and is again after the answer.
    assert!(questions[2].contains("/13"), "{:?}", questions[2]);
    let hint =
        "This is the twin, a simulated rig: nothing real moves. It asks as the rig would; --yes confirms every step.";
    assert_eq!(shown.matches(hint).count(), 1, "{shown}");
}

#[test]
fn one_is_said_as_one() {
    let bench = Bench::new();
    let wet = &bench.logs("wet")[0];
    let said = printed(&["carriage", "drag", text(wet)]);
    assert!(said.contains("[few-pairs] fsm: 1 pair; their scatter is not known, and no interval is stated"), "{said}");
    let jog = &bench.logs("calibration")[0];
    let told = refusal(&["carriage", "drag", text(jog)]);
    assert_eq!(told, "froude: no wet run among 1 run: drag needs tows with the body in the water\n");
    let said = printed(&["carriage", "calibrate", text(jog)]);
    assert!(said.contains("1 run was named and read; the folder"), "{said}");
    for log in &bench.logs("")[..16] {
        if !id(log).contains("wet-p1-500mm_s-forward") {
            std::fs::remove_file(log.with_extension("toml")).unwrap();
            std::fs::remove_file(log).unwrap();
        }
    }
    let out = bench.run();
    assert_eq!(out.0, 15);
    let said = printed(&["run", text(&bench.campaign), "--yes"]);
    assert!(said.contains("0 runs driven, 17 were already there, 0 left out."), "{said}");

    let table = bench.folder.path().join("t.csv");
    std::fs::write(&table, "speed [m/s],f_x [N]\n0.1\n").unwrap();
    assert!(refusal(&["inspect", text(&table)]).ends_with("t.csv:2: the row has 1 cell, the header has 2\n"));
}
