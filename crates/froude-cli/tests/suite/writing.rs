//! Where files go: nothing a person wrote is overwritten, results of two runs never mix, a received campaign writes in its own folder.

use std::path::Path;
use std::process::{Command, Output};

use crate::small_disk::SmallDisk;

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

fn succeeds(folder: &Path, args: &[&str]) {
    let output = froude(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
}

/// Exit code 2 and exactly this message.
fn refuses(folder: &Path, args: &[&str], message: &str) {
    let output = froude(folder, args);
    assert_eq!(
        (said(&output).as_str(), output.status.code()),
        (format!("froude: {message}").as_str(), Some(2)),
        "{args:?}"
    );
}

fn names(folder: &Path) -> Vec<String> {
    let mut out: Vec<String> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    out.sort();
    out
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";

const ROBOT: &str = r#"schema = 1
name = "snake"
[fluid]
density = "1025 kg/m^3"
[body]
shape = "robot"
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
joint = { length = "60 mm", scale = 0.7, ramp = "4 mm" }
ends = { length = "31 mm" }
"#;

/// A twin of as many sources as tables are named.
fn twin(tables: &[&str]) -> String {
    let sources: String = tables
        .iter()
        .enumerate()
        .map(|(i, table)| {
            format!(
                "[[source]]\nname = \"tank {i}\"\nkind = \"tank\"\ntable = {table:?}\n[[source.plan]]\n\
                 speed = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\", \"0.4 m/s\"]\n"
            )
        })
        .collect();
    format!(
        "schema = 1\nname = \"twin\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n{sources}[identify]\nmodels = [\"quadratic\"]\n\
         [simulate]\nseed = 7\nmodel = \"quadratic\"\n[simulate.coefficients]\nD_x_II = 50.0\n[[simulate.sensor]]\nquantity = \"f_x\"\n\
         noise = \"0.02 N\"\n"
    )
}

#[test]
fn a_report_that_somebody_else_wrote_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    std::fs::create_dir(at.join("mine")).unwrap();
    write(at, "mine/report.html", "my own");
    refuses(
        at,
        &["identify", "t.csv", "--out", "mine"],
        "mine/report.html was not written by Froude, and the folder mine is replaced as a whole; move the file out of it, or name another \
         folder with --out",
    );
    assert_eq!(
        (names(&at.join("mine")), read(at, "mine/report.html")),
        (vec!["report.html".to_owned()], "my own".to_owned())
    );
    assert_eq!(names(at), ["mine", "t.csv"]);
}

#[test]
fn results_that_a_person_changed_or_added_to_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    succeeds(at, &["identify", "t.csv"]);
    let page = read(at, "t-results/report.html");
    write(at, "t-results/report.html", &page.replace("quadratic", "cubic"));
    refuses(
        at,
        &["identify", "t.csv"],
        "t-results/report.html was changed after Froude wrote it, and the folder t-results is replaced as a whole; move the file out of it, \
         or name another folder with --out",
    );
    assert!(read(at, "t-results/report.html").contains("cubic"));
    write(at, "t-results/report.html", &page);
    std::fs::create_dir(at.join("t-results/photos")).unwrap();
    write(at, "t-results/photos/day1.jpg", "a photo");
    let refused = said(&froude(at, &["identify", "t.csv"]));
    assert!(refused.starts_with("froude: t-results/photos/day1.jpg was not written by Froude"), "{refused}");
    assert_eq!(read(at, "t-results/photos/day1.jpg"), "a photo");
    // A file browser's own is nobody's, and a file that somebody deleted is no hindrance.
    std::fs::remove_dir_all(at.join("t-results/photos")).unwrap();
    std::fs::remove_file(at.join("t-results/report.html")).unwrap();
    write(at, "t-results/.DS_Store", "");
    succeeds(at, &["identify", "t.csv"]);
    assert_eq!(read(at, "t-results/report.html"), page);
}

#[test]
fn results_of_an_earlier_run_are_gone_when_new_ones_come() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "a.csv", TABLE);
    write(at, "b.csv", "v_y [m/s],f_y [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n");
    succeeds(at, &["identify", "a.csv", "--out", "results"]);
    let old = names(&at.join("results/figures"));
    assert!(at.join("results/observations-a.csv").exists());
    succeeds(at, &["identify", "b.csv", "--out", "results", "--models", "quadratic"]);
    assert_eq!(
        names(&at.join("results")),
        ["estimate.json", "figures", "froude-files.json", "observations-b.csv", "report.html", "result.json"]
    );
    let new = names(&at.join("results/figures"));
    assert!(new.iter().all(|name| !old.contains(name)), "{old:?} and {new:?}");
    assert_eq!(names(at), ["a.csv", "b.csv", "results"]);
}

#[test]
fn the_list_of_results_has_every_file_with_its_fingerprint() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    succeeds(at, &["identify", "t.csv"]);
    let list: serde_json::Value = serde_json::from_str(&read(at, "t-results/froude-files.json")).unwrap();
    let files = list["files"].as_object().unwrap();
    let own = froude::records::hash::sha256_of_file(&at.join("t-results/estimate.json")).unwrap();
    assert_eq!(files["estimate.json"], own.as_str());
    let figures = names(&at.join("t-results/figures"));
    assert!(!figures.is_empty() && figures.iter().all(|f| files.contains_key(&format!("figures/{f}"))), "{files:?}");
    // Record, result, report, observations.
    assert_eq!(files.len(), 4 + figures.len(), "{files:?}");
}

#[test]
fn the_folder_that_one_works_in_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    std::fs::create_dir(at.join("here")).unwrap();
    refuses(
        &at.join("here"),
        &["identify", "../t.csv", "--out", "."],
        "cannot write .: the program was started in it, and the folder is replaced as a whole; name a folder inside it",
    );
    assert!(names(&at.join("here")).is_empty());
}

#[test]
fn a_disk_that_is_mounted_where_results_should_be_is_named_before_anything_is_computed() {
    let Some(disk) = SmallDisk::mount("300k") else {
        eprintln!("this user may not mount a small disk");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "t.csv", TABLE);
    let out = disk.path().to_str().unwrap();
    let output = froude(folder.path(), &["identify", "t.csv", "--out", out]);
    assert_eq!(
        (said(&output), output.status.code()),
        (
            format!(
                "froude: cannot write {out}: a disk is mounted there; name a folder inside it; nothing was changed"
            ),
            Some(1)
        )
    );
    succeeds(folder.path(), &["identify", "t.csv", "--models", "quadratic", "--out", &format!("{out}/results")]);
}

#[test]
fn the_campaign_of_a_table_of_links_is_not_taken_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "body.toml", ROBOT);
    write(at, "campaign.toml", "mine");
    let links = |out: &'static str| ["added-mass", "body.toml", "--links", "1,2", "--tolerance", "50 %", "--out", out];
    let refused = said(&froude(at, &links(".")));
    assert!(refused.starts_with("froude: ./body.toml was not written by Froude"), "{refused}");
    assert_eq!((read(at, "campaign.toml").as_str(), names(at).len()), ("mine", 2));

    succeeds(at, &links("links"));
    let edited = read(at, "links/campaign.toml").replace("affine", "straight");
    write(at, "links/campaign.toml", &edited);
    let refused = said(&froude(at, &links("links")));
    assert!(refused.starts_with("froude: links/campaign.toml was changed after Froude wrote it"), "{refused}");
    assert_eq!(read(at, "links/campaign.toml"), edited);
}

#[test]
fn a_name_of_any_characters_is_written_as_toml() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // Rust would write the first as \u{80}, which is no TOML.
    write(at, "body.toml", &ROBOT.replace("\"snake\"", r#""s\u0080n\u202e\"a\\k\u0007e'''""#));
    succeeds(at, &["added-mass", "body.toml", "--links", "1,2", "--tolerance", "50 %", "--out", "links"]);
    let campaign = froude::records::campaign_file::read_campaign(&at.join("links/campaign.toml")).unwrap();
    assert_eq!(campaign.name, "s\u{80}n\u{202e}\"a\\k\u{7}e'''");
}

#[test]
fn a_repair_writes_over_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    write(at, "n.obj", "mine");
    refuses(
        at,
        &["added-mass", "m.obj", "--repair", "n.obj"],
        "n.obj already exists and is not overwritten; name another file, or delete that one",
    );
    assert_eq!(read(at, "n.obj"), "mine");
}

#[test]
fn a_received_campaign_writes_in_its_own_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let own = at.join("received");
    std::fs::create_dir_all(own.join("sub")).unwrap();
    std::fs::create_dir(at.join("elsewhere")).unwrap();
    let absolute = at.join("elsewhere/t.csv").to_str().unwrap().to_owned();
    for table in ["../t.csv", "sub/../../t.csv", "sub/../t.csv", absolute.as_str()] {
        write(&own, "c.toml", &twin(&[table]));
        for replace in [&[][..], &["--replace"]] {
            refuses(
                &own,
                &[&["simulate", "c.toml"], replace].concat(),
                &format!(
                    "c.toml:8:9: `table` is {table:?}, which leads out of the campaign's folder; froude simulate writes inside it only: \
                     name a table there, such as table = \"twin.csv\""
                ),
            );
        }
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../elsewhere", own.join("link")).unwrap();
        write(&own, "c.toml", &twin(&["link/t.csv"]));
        let refused = said(&froude(&own, &["simulate", "c.toml"]));
        assert!(refused.contains("c.toml:8:9: `table` is \"link/t.csv\", which leads out"), "{refused}");
    }
    assert!(names(&at.join("elsewhere")).is_empty());
    write(&own, "c.toml", &twin(&["sub/t.csv"]));
    succeeds(at, &["simulate", "received/c.toml"]);
    assert_eq!(names(&own.join("sub")), ["froude-files.json", "t.csv"]);
    // Reading from elsewhere is nobody's harm.
    write(at, "elsewhere/t.csv", TABLE);
    write(
        &own,
        "c.toml",
        "schema = 1\nname = \"reads\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"a\"\nkind = \"tank\"\n\
        table = \"../elsewhere/t.csv\"\n[identify]\nmodels = [\"quadratic\"]\n",
    );
    succeeds(&own, &["identify", "c.toml"]);
}

#[test]
fn a_measured_table_is_not_replaced_by_a_simulated_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "c.toml", &twin(&["t.csv"]));
    write(at, "t.csv", TABLE);
    let not_ours = "t.csv was not written by Froude, and would be replaced; move it away, or name another folder";
    refuses(at, &["simulate", "c.toml", "--replace"], not_ours);
    assert_eq!(read(at, "t.csv"), TABLE);
    std::fs::remove_file(at.join("t.csv")).unwrap();
    succeeds(at, &["simulate", "c.toml"]);
    succeeds(at, &["simulate", "c.toml", "--replace"]);
    let corrected = read(at, "t.csv").replacen('1', "2", 1);
    write(at, "t.csv", &corrected);
    let changed =
        "t.csv was changed after Froude wrote it, and would be replaced; move it away, or name another folder";
    refuses(at, &["simulate", "c.toml", "--replace"], changed);
    assert_eq!(read(at, "t.csv"), corrected);
}

#[test]
fn two_sources_never_share_a_table() {
    let folder = tempfile::tempdir().unwrap();
    for (one, other) in [("a.csv", "a.csv"), ("a.csv", "./a.csv"), ("a.csv", "A.csv")] {
        write(folder.path(), "c.toml", &twin(&[one, other]));
        refuses(
            folder.path(),
            &["simulate", "c.toml"],
            "c.toml:14:9: `table` is the table of source \"tank 0\", too; give each source a table of its own",
        );
        assert_eq!(names(folder.path()), ["c.toml"]);
    }
}

#[test]
fn the_name_of_a_table_decides_its_format() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "c.toml", &twin(&["a.parquet", "b.csv"]));
    succeeds(at, &["simulate", "c.toml"]);
    let bytes = std::fs::read(at.join("a.parquet")).unwrap();
    assert_eq!((&bytes[..4], &bytes[bytes.len() - 4..]), (&b"PAR1"[..], &b"PAR1"[..]));
    succeeds(at, &["identify", "c.toml"]);
    write(at, "c.toml", &twin(&["a.xlsx"]));
    refuses(at, &["simulate", "c.toml"], "c.toml:8:9: `table` is \"a.xlsx\"; a table is written as .csv or .parquet");
}

#[test]
fn observations_of_names_that_come_out_alike_lie_in_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    let long = "x".repeat(300);
    let sources: String = ["day 1", "day-1", "Day/1", "=day", &long]
        .iter()
        .map(|name| format!("[[source]]\nname = \"{name}\"\nkind = \"tank\"\ntable = \"t.csv\"\n"))
        .collect();
    write(
        at,
        "c.toml",
        &format!(
            "schema = 1\nname = \"c\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n{sources}[identify]\nmodels = [\"quadratic\"]\n"
        ),
    );
    succeeds(at, &["identify", "c.toml"]);
    let observations: Vec<String> =
        names(&at.join("c-results")).into_iter().filter(|n| n.starts_with("observations")).collect();
    let long = format!("observations-{}.csv", "x".repeat(100));
    assert_eq!(
        observations,
        [
            "observations--day.csv",
            "observations-Day-1-3.csv",
            "observations-day-1-2.csv",
            "observations-day-1.csv",
            long.as_str()
        ]
    );
    let mut lower: Vec<String> = observations.iter().map(|n| n.to_lowercase()).collect();
    lower.sort();
    lower.dedup();
    assert_eq!(lower.len(), 5, "some disks do not tell Day from day");
}

#[test]
fn cells_of_observations_are_no_formulas_and_read_back_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let runs = ["=cmd|' /C calc'!A0", "+1", "-1", "@SUM(A1)", "\tx", "''=quoted", "plain", "＝wide"];
    let rows: String =
        runs.iter().enumerate().map(|(i, run)| format!("0.{},-{}.5,\"{run}\"\n", i + 1, i + 1)).collect();
    write(at, "t.csv", &format!("speed [m/s],f_x [N],run\n{rows}"));
    succeeds(at, &["identify", "t.csv", "--models", "quadratic"]);
    let path = at.join("t-results/observations-t.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let column = reader.headers().unwrap().iter().position(|h| h == "run").unwrap();
    for row in reader.records() {
        let cell = row.unwrap()[column].to_owned();
        assert!(!cell.starts_with(['=', '+', '-', '@', '\t', '＝']), "{cell}");
    }
    let back = froude::records::table_file::read_table(&path, None).unwrap();
    // A numeral that begins with a sign stays a number.
    let forces = back.number("f_x", froude::records::units::Dimension::FORCE).unwrap();
    let named: Vec<&String> = back.text("run").unwrap().iter().collect();
    assert_eq!((named, forces[0]), (runs.map(|r| r.replace("''", "'")).iter().collect(), -1.5));
}

#[cfg(unix)]
#[test]
fn what_dead_processes_left_is_cleared_and_what_a_living_one_holds_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "t.csv", TABLE);
    let (dead, alive) = (at.join(".froude-unfinished-dead00"), at.join(".froude-unfinished-alive0"));
    std::fs::create_dir_all(dead.join("figures")).unwrap();
    write(&dead, "estimate.json", "half");
    write(at, ".froude-unfinished-file00", "half a table");
    std::fs::create_dir(&alive).unwrap();
    let held = std::fs::File::open(&alive).unwrap();
    held.lock().unwrap();
    // Nobody's but a person's.
    write(at, ".froude-notes", "mine");
    std::os::unix::fs::symlink(at.join("t.csv"), at.join(".froude-unfinished-link00")).unwrap();
    succeeds(at, &["identify", "t.csv"]);
    assert_eq!(
        names(at),
        [".froude-notes", ".froude-unfinished-alive0", ".froude-unfinished-link00", "t-results", "t.csv"]
    );
    drop(held);
    succeeds(at, &["identify", "t.csv"]);
    assert!(!alive.exists());
}

#[test]
fn a_demo_on_a_full_disk_leaves_nothing() {
    let Some(disk) = SmallDisk::mount("300k") else {
        eprintln!("this user may not mount a small disk; the faults of interrupted.rs are tested instead");
        return;
    };
    let output = froude(disk.path(), &["demo", "here"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).starts_with("froude: cannot write here/"), "{}", said(&output));
    assert!(said(&output).ends_with("the disk is full; nothing was changed"), "{}", said(&output));
    assert!(names(disk.path()).is_empty(), "{:?}", names(disk.path()));
}
