//! Logs that are not what they say, at the verbs that read them: gone, cut off, exchanged, doubled, of another campaign, edited, and of
//! earlier versions. Each sentence that a user meets is asserted word for word.

use std::path::Path;

use serde_json::Value;

use crate::bench::{Bench, copy, driven, id, json, refusal, text};

/// Code and sentence of the findings that are of a set of logs.
fn findings(value: &Value) -> Vec<(String, String)> {
    let all = value["findings"].as_array().unwrap().iter();
    let own = |f: &Value| (f["code"].as_str().unwrap().to_owned(), f["message"].as_str().unwrap().to_owned());
    let is_of_a_set = |code: &str| code == "campaign-changed" || (code.starts_with("run-") && code != "run-left-out");
    all.map(own).filter(|(code, _)| is_of_a_set(code)).collect()
}

#[test]
fn runs_as_they_were_driven_give_no_finding_and_a_folder_says_what_is_in_it() {
    let bench = Bench::new();
    let inside = bench.inspect();
    assert_eq!(inside["kind"], "runs");
    assert_eq!(findings(&inside), []);
    let facts = inside["facts"].to_string();
    let n = bench.logs("").len();
    assert!(facts.contains(&format!("{n} complete")), "{facts}");
    assert!(facts.contains(&format!("froude carriage drag {} reduces them together", text(&bench.runs))), "{facts}");
    assert_eq!(findings(&bench.drag()), []);
    let wet = &bench.logs("wet")[0];
    let one = json(&["inspect", text(wet), "--json"]);
    assert_eq!(findings(&one), []);
    let bytes = std::fs::metadata(wet).unwrap().len();
    assert!(one["facts"].to_string().contains(&format!("{bytes} bytes, as they were recorded (SHA-256 ")), "{one}");
    assert_eq!(bench.run().0, 0);
}

#[test]
fn a_log_that_is_gone_is_reported_and_driven_again() {
    let bench = Bench::new();
    let log = &bench.logs("dry")[1];
    std::fs::remove_file(log).unwrap();
    let told = format!(
        "the log {} is gone: its sidecar says that {} was completed; copy it back, or froude run drives it again",
        text(log),
        id(log)
    );
    assert_eq!(findings(&bench.inspect()), [("run-gone".to_owned(), told.clone())]);
    assert_eq!(findings(&bench.drag()), [("run-gone".to_owned(), format!("{told}. It was left out"))]);
    let error = refusal(&["inspect", text(&log.with_extension("toml"))]);
    assert_eq!(error, format!("froude: {told}\n"));

    let (n, said) = bench.run();
    assert_eq!(n, 1);
    let reason =
        format!("the log {0}.mcap is gone; {0}.toml says complete: kept as {0}.interrupted-1, driven again", id(log));
    assert!(said.contains(&reason), "{said}");
    assert!(log.exists());
    // What is left of the first drive lies aside and is counted nowhere.
    assert_eq!((findings(&bench.drag()), findings(&bench.inspect())), (vec![], vec![]));
}

#[test]
fn a_log_that_was_cut_off_is_left_out_and_driven_again() {
    let bench = Bench::new();
    let log = &bench.logs("dry")[1];
    let whole = std::fs::read(log).unwrap();
    std::fs::write(log, &whole[..whole.len() / 2]).unwrap();
    let told = format!(
        "{} has {} of the {} bytes that were recorded: it was cut off; copy it again from where it was recorded",
        text(log),
        whole.len() / 2,
        whole.len()
    );
    assert_eq!(findings(&bench.inspect()), [("run-damaged".to_owned(), told.clone())]);
    assert_eq!(findings(&json(&["inspect", text(log), "--json"]))[0], ("run-damaged".to_owned(), told.clone()));
    assert_eq!(findings(&bench.drag()), [("run-damaged".to_owned(), format!("{told}. It was left out"))]);
    let (n, said) = bench.run();
    assert_eq!(n, 1);
    assert!(said.contains(": it was cut off: kept as "), "{said}");
    assert!(said.contains(&format!("kept as {}.interrupted-1, driven again", id(log))), "{said}");
}

#[test]
fn a_log_with_other_bytes_is_left_out_and_driven_again() {
    let bench = Bench::new();
    let log = &bench.logs("dry")[1];
    let mut bytes = std::fs::read(log).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    std::fs::write(log, &bytes).unwrap();
    let told = format!(
        "{} is not the file that was recorded, its SHA-256 is another; copy it again from where it was recorded",
        text(log)
    );
    assert_eq!(findings(&bench.inspect()), [("run-damaged".to_owned(), told.clone())]);
    assert_eq!(findings(&bench.drag()), [("run-damaged".to_owned(), format!("{told}. It was left out"))]);
    assert_eq!(bench.run().0, 1);
}

#[test]
fn a_log_whose_very_beginning_is_another_costs_itself_and_no_other_run() {
    let bench = Bench::new();
    let log = &bench.logs("dry")[1];
    let mut bytes = std::fs::read(log).unwrap();
    bytes[2] ^= 4;
    std::fs::write(log, &bytes).unwrap();
    let found = findings(&bench.drag());
    assert_eq!(found.len(), 1, "{found:?}");
    let (code, message) = &found[0];
    assert_eq!(code, "run-damaged");
    assert!(message.starts_with(text(log)) && message.ends_with(". It was left out"), "{message}");
}

fn swap(a: &Path, b: &Path) {
    let aside = a.with_extension("aside");
    std::fs::rename(a, &aside).unwrap();
    std::fs::rename(b, a).unwrap();
    std::fs::rename(aside, b).unwrap();
}

#[test]
fn logs_that_were_exchanged_are_refused_by_every_verb_and_nothing_moves() {
    let bench = Bench::new();
    let (dry, wet) = (&bench.logs("dry")[0], &bench.logs("wet")[0]);
    swap(dry, wet);
    let told = |log: &Path, own: &Path| {
        format!(
            "{} is the log of run {} and its sidecar is that of {}: they were exchanged or renamed; give each log and each sidecar \
             the name of its own run",
            text(log),
            id(own),
            id(log)
        )
    };
    let (first, second) = if dry < wet { (dry, wet) } else { (wet, dry) };
    let both = [(first, second), (second, first)].map(|(log, own)| ("run-exchanged".to_owned(), told(log, own)));
    assert_eq!(findings(&bench.inspect()), both);
    assert_eq!(refusal(&["carriage", "drag", text(&bench.runs)]), format!("froude: {}\n", both[0].1));
    assert_eq!(refusal(&["carriage", "identify", text(&bench.runs)]), format!("froude: {}\n", told(dry, wet)));
    assert_eq!(refusal(&["run", text(&bench.campaign), "--yes"]), format!("froude: {}\n", both[0].1));
    assert!(!bench.folder.path().join("campaign-runs-drag").exists());
}

#[test]
fn a_jog_with_the_log_of_another_run_is_refused_by_calibrate() {
    let bench = Bench::new();
    let (jog, wet) = (&bench.logs("jog")[0], &bench.logs("wet")[0]);
    swap(jog, wet);
    let error = refusal(&["carriage", "calibrate", text(&bench.runs)]);
    assert!(error.starts_with(&format!("froude: {} is the log of run {} and", text(jog), id(wet))), "{error}");
}

#[test]
fn the_same_folder_twice_is_refused_by_every_verb() {
    let bench = Bench::new();
    for verb in ["drag", "identify", "calibrate"] {
        let error = refusal(&["carriage", verb, text(&bench.runs), text(&bench.runs)]);
        let first = match verb {
            "drag" => bench.logs("")[0..].iter().find(|l| !text(l).contains("jog")).unwrap().clone(),
            "identify" => {
                bench.logs("").into_iter().find(|l| ["dry", "pulses"].iter().any(|k| id(l).contains(k))).unwrap()
            }
            _ => bench.logs("jog")[0].clone(),
        };
        let told = format!("froude: {} is named twice: name every folder and every run once (", text(&first));
        assert!(error.starts_with(&told), "{verb}: {error}\n{told}");
    }
}

#[test]
fn a_copy_is_refused_in_another_folder_and_under_another_name() {
    let bench = Bench::new();
    let other = bench.folder.path().join("copy");
    copy(&bench.runs, &other);
    let error = refusal(&["carriage", "drag", text(&bench.runs), text(&other)]);
    let told = " byte for byte: a run that counts twice makes every interval too narrow. Name one of them, or move the copy out (";
    assert!(error.contains(told), "{error}");

    // One run under another name.
    let wet = &bench.logs("wet")[0];
    let named = bench.runs.join("999-mine.mcap");
    std::fs::copy(wet, &named).unwrap();
    std::fs::copy(wet.with_extension("toml"), named.with_extension("toml")).unwrap();
    let told = format!(
        "{} is the same log as {}, byte for byte: a run that counts twice makes every interval too narrow. Name one of them, or move \
         the copy out",
        text(&named),
        text(wet)
    );
    assert_eq!(refusal(&["carriage", "drag", text(&bench.runs)]), format!("froude: {told}\n"));
    let renamed = format!("{} is the log of run {}: the file was copied or renamed", text(&named), id(wet));
    let both = [("run-doubled".to_owned(), told), ("run-renamed".to_owned(), renamed)];
    assert_eq!(findings(&bench.inspect()), both);

    // Without its sidecar it is the same log still.
    std::fs::remove_file(named.with_extension("toml")).unwrap();
    let error = refusal(&["carriage", "drag", text(&bench.runs)]);
    assert!(error.starts_with(&format!("froude: {} is the same log as ", text(&named))), "{error}");
}

#[test]
fn a_campaign_that_was_driven_twice_is_not_counted_twice() {
    let bench = Bench::new();
    let again = bench.folder.path().join("again");
    json(&["run", text(&bench.campaign), "--yes", "--json", "--out", text(&again)]);
    // The twin drives the same numbers again; another date or version would make other bytes of them.
    let sidecar = bench.logs("wet")[0].with_extension("toml");
    let changed = std::fs::read_to_string(&sidecar).unwrap();
    assert!(changed.contains("campaign_sha256 = \""), "{changed}");
    let error = refusal(&["carriage", "drag", text(&bench.runs), text(&again)]);
    assert!(error.contains("is the same log as") || error.contains("it was driven twice"), "{error}");
}

#[test]
fn a_log_of_another_campaign_is_refused() {
    let bench = Bench::new();
    let wet = &bench.logs("wet")[0];
    let stranger = driven(2).join("campaign-runs").join(wet.file_name().unwrap());
    // Its log alone: it contradicts the sidecar.
    std::fs::copy(&stranger, wet).unwrap();
    let error = refusal(&["carriage", "drag", text(&bench.runs)]);
    let told = format!("froude: {} is of campaign \"Drag of a cylinder", text(wet));
    assert!(
        error.starts_with(&told) && error.ends_with("put the files that belong together side by side\n"),
        "{error}"
    );
    // Log and sidecar: they contradict the campaign beside them.
    std::fs::copy(stranger.with_extension("toml"), wet.with_extension("toml")).unwrap();
    let error = refusal(&["carriage", "drag", text(&bench.runs)]);
    let told = format!(
        "froude: {} is of another campaign (\"Drag of a cylinder from the motor current of a towing carriage\", SHA-256 ",
        text(wet)
    );
    assert!(error.starts_with(&told) && error.ends_with("…): move it out, with its sidecar\n"), "{error}");
    let error = refusal(&["run", text(&bench.campaign), "--yes"]);
    let told = format!(
        "is driven here: move {0}.mcap and {0}.toml out of the folder, or name another folder with --out\n",
        id(wet)
    );
    assert!(error.ends_with(&told), "{error}");
    assert_eq!(findings(&bench.inspect())[0].0, "run-of-another-campaign");
}

#[test]
fn a_sidecar_that_was_edited_says_how_the_edit_is_adopted() {
    let bench = Bench::new();
    let sidecar = bench.logs("wet")[0].with_extension("toml");
    let written = std::fs::read_to_string(&sidecar).unwrap();
    let edited = written.replace("note = \"\"", "note = \"ripples\"");
    assert_ne!(edited, written);
    std::fs::write(&sidecar, &edited).unwrap();
    let told = format!(
        "froude: {}:3:12: the content is not what this checksum was written for: the file was edited or damaged. Copy it \
         again from where it was written; to adopt an edit, delete this line\n",
        text(&sidecar)
    );
    assert_eq!(refusal(&["carriage", "drag", text(&bench.runs)]), told);
    assert_eq!(refusal(&["run", text(&bench.campaign), "--yes"]), told);
    let adopted: Vec<&str> = edited.lines().filter(|line| !line.starts_with("checksum")).collect();
    std::fs::write(&sidecar, adopted.join("\n")).unwrap();
    let wet = sidecar.with_extension("mcap");
    let note = format!("{} has a sidecar that was edited: it gives other values of note than the log", text(&wet));
    assert_eq!(findings(&bench.drag()), [("run-edited".to_owned(), note)]);
    assert_eq!(bench.run().0, 0);
}

#[test]
fn runs_of_earlier_versions_are_read_and_not_trusted_in_silence() {
    let bench = Bench::new();
    let logs = bench.logs("");
    for log in &logs {
        let sidecar = log.with_extension("toml");
        let text = std::fs::read_to_string(&sidecar).unwrap();
        let old = text.lines().filter(|line| {
            let key = line.split(' ').next().unwrap();
            !["checksum", "campaign_sha256", "[log]", "bytes", "sha256"].contains(&key)
        });
        std::fs::write(&sidecar, old.collect::<Vec<_>>().join("\n")).unwrap();
    }
    let told = format!(
        "{} is not compared with anything: {}.toml has no SHA-256 of it, as runs of earlier versions; only the log's own checksums \
         vouch for it (so it is with {} more)",
        text(&logs[0]),
        id(&logs[0]),
        logs.len() - 1
    );
    let all = findings(&bench.inspect());
    assert!(all.contains(&("run-without-hash".to_owned(), told)), "{all:?}");
    assert!(findings(&bench.drag()).iter().any(|(code, _)| code == "run-without-hash"));
    let (n, said) = bench.run();
    assert_eq!(n, 0);
    assert!(said.contains("carry no SHA-256 of their logs"), "{said}");
    // Exchanged, they are found still: the logs say what they are.
    swap(&bench.logs("dry")[0], &bench.logs("wet")[0]);
    assert!(refusal(&["carriage", "drag", text(&bench.runs)]).contains("they were exchanged or renamed"));
}

#[test]
fn a_record_that_was_edited_is_refused_and_one_without_a_checksum_is_read() {
    let bench = Bench::new();
    bench.drag();
    let record = bench.folder.path().join("campaign-runs-drag/estimate.json");
    let written = std::fs::read_to_string(&record).unwrap();
    assert!(written.starts_with("{\n  \"schema\": \"froude/estimate/2\",\n  \"checksum\": \""), "{written}");
    let (key, value) = written.split_once("\"value\": ").map(|(_, rest)| ("\"value\": ", &rest[..6])).unwrap();
    std::fs::write(&record, written.replacen(&format!("{key}{value}"), &format!("{key}1{value}"), 1)).unwrap();
    let told = format!(
        "froude: {}:3: the content is not what this checksum was written for: the file was edited or damaged. Copy it again \
         from where it was written; to adopt an edit, delete this line\n",
        text(&record)
    );
    assert_eq!(refusal(&["inspect", text(&record)]), told);
    assert_eq!(refusal(&["compare", text(&record), text(&record)]), told);
    let adopted: Vec<&str> = written.lines().filter(|line| !line.starts_with("  \"checksum\"")).collect();
    std::fs::write(&record, adopted.join("\n")).unwrap();
    json(&["inspect", text(&record), "--json"]);
}
