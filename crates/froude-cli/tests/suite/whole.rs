//! The message about a campaign that is not whole (a part of it that was named, one that was not driven to its end, one that stopped because it
//! knew enough), and that no result takes the place of one of more runs.

use crate::bench;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::bench::{Bench, SHORT, campaign, copy, findings_of, froude, id, json, printed, refusal, text};

fn drag(runs: &[&Path]) -> Value {
    let mut args = vec!["carriage", "drag", "--json"];
    args.extend(runs.iter().map(|path| text(path)));
    json(&args)
}

fn record(folder: &Path) -> Vec<u8> {
    std::fs::read(folder.join("estimate.json")).unwrap()
}

/// A campaign with its runs and their result: its folder, and the record in it.
fn reduced() -> (Bench, PathBuf, Vec<u8>) {
    let bench = Bench::new();
    bench.drag();
    let whole = bench.folder.path().join("campaign-runs-drag");
    let before = record(&whole);
    (bench, whole, before)
}

/// Both files of a run.
fn delete(log: &Path) {
    std::fs::remove_file(log).unwrap();
    std::fs::remove_file(log.with_extension("toml")).unwrap();
}

#[test]
fn one_run_has_a_result_of_its_own_name_and_recommends_nothing() {
    let (bench, whole, before) = reduced();
    let wet = &bench.logs("wet")[2];
    let one = drag(&[wet]);
    assert_eq!(record(&whole), before, "the campaign's own result stays");
    let own = bench.runs.join(format!("{}-drag", id(wet)));
    assert!(own.join("report.html").exists());
    let estimate = &one["estimates"][0];
    assert!(estimate["id"].as_str().unwrap().ends_with(&format!("carriage, {}/fsm", id(wet))), "{estimate}");
    // One pair has no interval.
    assert_eq!(
        (&estimate["recommended"], &estimate["coefficients"]["D_x_II"]["interval_95"]),
        (&false.into(), &Value::Null)
    );
    let told = format!(
        "1 of the 15 runs in the folder that determine drag was named: this is not the result of the campaign, and its record is called {:?}. froude \
         carriage drag {} takes them all",
        id(wet),
        text(&bench.runs)
    );
    assert_eq!(findings_of(&one, "part-of-a-campaign"), [("warning".to_owned(), told)]);
    let said = printed(&["carriage", "drag", text(wet)]);
    assert!(said.contains("No D_d is recommended") && said.contains("[part-of-a-campaign]"), "{said}");
    // It is no second opinion on the same fit.
    let both = json(&["compare", text(&own.join("estimate.json")), text(&whole.join("estimate.json")), "--json"]);
    assert_eq!(findings_of(&both, "contradiction"), []);
    // The folder has nothing more in it than runs.
    assert_eq!(findings_of(&bench.inspect(), "run-gone"), []);
}

#[test]
fn a_part_never_takes_the_place_of_more() {
    let (bench, whole, before) = reduced();
    // As a shell names them: `014*`, log and sidecar.
    let second: Vec<PathBuf> =
        bench.logs("p2").iter().flat_map(|log| [log.clone(), log.with_extension("toml")]).collect();
    let part = drag(&second.iter().map(PathBuf::as_path).collect::<Vec<_>>());
    assert_eq!(findings_of(&part, "run-damaged"), []);
    assert_eq!(part["data"].as_object().unwrap().len(), 4);
    assert!(part["estimates"][0]["source"].as_str().unwrap().ends_with(", 4 of 15 runs"), "{}", part["estimates"][0]);
    let p2 = bench.logs("p2");
    assert!(bench.runs.join(format!("{}-and-3-more-drag/estimate.json", id(&p2[0]))).exists());

    let told = refusal(&["carriage", "drag", text(&p2[0]), "--out", text(&whole)]);
    let expected = format!(
        "froude: {} holds the result of 15 runs, of which 14 are not named now (the first is 003-pulses.mcap); it is not replaced by that \
         of 1 run. Name another folder with --out\n",
        text(&whole)
    );
    assert_eq!(told, expected);
    // Others of the same number, whose first is the same.
    drag(&[&p2[0], &p2[1]]);
    let own = bench.runs.join(format!("{}-and-1-more-drag", id(&p2[0])));
    let of_part = record(&own);
    let mut args = vec!["carriage", "drag", text(&p2[0]), text(&p2[2])];
    let told = refusal(&args);
    assert!(told.contains("holds the result of 2 runs, of which 1 is not named now"), "{told}");
    // The same ones again, and others in a place that was chosen.
    drag(&[&p2[0], &p2[1]]);
    args.extend(["--out", text(&own), "--json"]);
    json(&args);
    assert_eq!(record(&whole), before);
    assert_ne!(record(&own), of_part);

    // All of them, one by one: that is the campaign.
    let logs = bench.logs("");
    let all = drag(&logs.iter().map(PathBuf::as_path).collect::<Vec<_>>());
    assert_eq!(findings_of(&all, "part-of-a-campaign"), []);
    assert_eq!(record(&whole), before);
}

#[test]
fn two_folders_have_a_result_of_their_own() {
    let (bench, whole, before) = reduced();
    let other = bench.folder.path().join("other-runs");
    copy(&bench::driven(2).join("campaign-runs"), &other);
    drag(&[&bench.runs, &other]);
    assert!(bench.folder.path().join("campaign-runs-and-1-more-drag/estimate.json").exists());
    assert_eq!(record(&whole), before);
}

#[test]
fn a_campaign_that_was_not_driven_to_its_end_says_what_is_missing() {
    let bench = Bench::new();
    let logs = bench.logs("");
    let ids: Vec<&str> = logs.iter().map(|log| id(log)).collect();
    let unfinished = "campaign-unfinished";
    assert_eq!((findings_of(&bench.inspect(), unfinished), findings_of(&bench.drag(), unfinished)), (vec![], vec![]));
    // The last three, one before, and a jog, which drag does not read.
    for i in [1, 9, 14, 15, 16] {
        delete(&logs[i]);
    }
    let told = format!(
        "12 of 17 planned runs are complete; missing: {}, {}, {} to {} (3 runs). froude run with the same campaign drives what is missing",
        ids[1], ids[9], ids[14], ids[16]
    );
    let expected = [("warning".to_owned(), told.clone())];
    assert_eq!(findings_of(&bench.inspect(), unfinished), expected);
    assert_eq!(findings_of(&bench.drag(), unfinished), expected);
    let page = std::fs::read_to_string(bench.folder.path().join("campaign-runs-drag/report.html")).unwrap();
    assert!(page.contains("12 of 17 planned runs are complete"), "it is in the report");
    for args in [["carriage", "drag", text(&bench.runs)].as_slice(), &["inspect", text(&bench.runs)]] {
        assert!(printed(args).contains(&format!("warning  [campaign-unfinished] {told}")), "{args:?}");
    }
    assert_eq!(bench.run().0, 5);
    assert_eq!(findings_of(&bench.drag(), unfinished), []);

    // Where nothing is missing of what is read, drag says nothing; the folder does.
    delete(&logs[0]);
    assert_eq!(findings_of(&bench.drag(), unfinished), []);
    assert!(
        findings_of(&bench.inspect(), unfinished)[0]
            .1
            .starts_with("16 of 17 planned runs are complete; missing: 001-jog")
    );
    // A run that is damaged is not there.
    std::fs::write(&logs[3], b"nothing").unwrap();
    assert!(findings_of(&bench.drag(), unfinished)[0].1.starts_with("15 of 17 planned runs"));
    // What was planned by a campaign that was edited since is not known.
    let copy = bench.runs.join("campaign.toml");
    let edited = std::fs::read_to_string(&copy).unwrap().replace("repeats = 2  ", "repeats = 9  ");
    std::fs::write(&copy, edited).unwrap();
    assert_eq!(findings_of(&bench.drag(), unfinished), []);
    assert_eq!(findings_of(&bench.drag(), "campaign-changed").len(), 1);
    std::fs::write(&copy, "schema = 1\nnme = \"x\"\n").unwrap();
    let told = findings_of(&bench.inspect(), "campaign-unreadable");
    let begins = format!("the plan is not known: {}:2:1: unknown key `nme`", text(&copy));
    assert!(told[0].1.starts_with(&begins), "{told:?}");
}

#[test]
fn a_campaign_that_stopped_by_its_rule_is_not_unfinished() {
    let folder = tempfile::tempdir().unwrap();
    let mut changes = SHORT.to_vec();
    changes.extend([("repeats = 2  ", "repeats = 5  "), (r#"stop_when = "2.5 %""#, r#"stop_when = "50 %""#)]);
    let campaign = campaign(folder.path(), &changes);
    let outcome = json(&["run", text(&campaign), "--yes", "--json"]);
    assert_eq!((&outcome["driven"], &outcome["spared"]), (&21.into(), &8.into()));
    let runs = folder.path().join("campaign-runs");
    let inside = json(&["inspect", text(&runs), "--json"]);
    assert_eq!(findings_of(&inside, "campaign-unfinished"), []);
    let [(grade, told)] = &findings_of(&inside, "stopped-early")[..] else { panic!("{inside}") };
    assert_eq!(grade, "note");
    let begins = "21 of 29 planned runs were driven: the campaign stopped by its own rule (stop_when). D_d = ";
    assert!(told.starts_with(begins) && told.ends_with("the remaining pairs are left out"), "{told}");
    let record = drag(&[&runs]);
    assert_eq!(findings_of(&record, "campaign-unfinished"), []);
    let [(_, told)] = &findings_of(&record, "stopped-early")[..] else { panic!("{record}") };
    assert!(told.starts_with("the campaign stopped after 3 of 5 pairs"), "{told}");

    // A run that was driven before it stopped, and its very last one, are missing all the same.
    let mut logs: Vec<PathBuf> = std::fs::read_dir(&runs).unwrap().map(|e| e.unwrap().path()).collect();
    logs.retain(|path| path.extension().is_some_and(|e| e == "mcap"));
    logs.sort();
    delete(&logs[10]);
    delete(&logs[20]);
    let told = format!("19 of 29 planned runs are complete; missing: {}, {}.", id(&logs[10]), id(&logs[20]));
    for found in [json(&["inspect", text(&runs), "--json"]), drag(&[&runs])] {
        assert!(findings_of(&found, "campaign-unfinished")[0].1.starts_with(&told), "{found}");
    }
    // One run of it does not say how many pairs there were.
    let one = drag(&[logs.iter().find(|log| text(log).contains("wet")).unwrap()]);
    assert!(findings_of(&one, "stopped-early")[0].1.starts_with("the campaign stopped because its interval"), "{one}");
}

#[test]
fn what_is_left_of_a_run_that_was_put_aside_is_called_that() {
    let bench = Bench::new();
    let wet = &bench.logs("wet")[0];
    let aside = bench.runs.join(format!("{}.interrupted-1.toml", id(wet)));
    let told = |again: &str| {
        format!(
            "{} was set aside and its log is missing: nothing of that drive can be read, and the file may be deleted; {again}",
            text(&aside)
        )
    };
    std::fs::copy(wet.with_extension("toml"), &aside).unwrap();
    let since = told(&format!("{} was driven again since", id(wet)));
    for found in [bench.inspect(), bench.drag()] {
        assert_eq!(findings_of(&found, "run-left-out"), [("note".to_owned(), since.clone())]);
        assert_eq!(findings_of(&found, "run-gone"), []);
    }
    assert_eq!(refusal(&["inspect", text(&aside)]), format!("froude: {since}\n"));
    assert!(bench.inspect()["facts"].to_string().contains("17 complete; 1 more was set aside"));

    // With its log, and before the run is driven again.
    let log = aside.with_extension("mcap");
    std::fs::rename(wet, &log).unwrap();
    std::fs::remove_file(wet.with_extension("toml")).unwrap();
    let told = format!("{} was set aside, and is left out; froude run drives {} again", text(&log), id(wet));
    assert_eq!(findings_of(&bench.drag(), "run-left-out"), [("note".to_owned(), told)]);
}

#[test]
fn a_sidecar_of_a_run_that_did_not_end_says_so_when_its_log_is_gone() {
    let bench = Bench::new();
    let wet = &bench.logs("wet")[0];
    let sidecar = wet.with_extension("toml");
    let written = std::fs::read_to_string(&sidecar).unwrap();
    let kept = written.lines().filter(|line| !line.starts_with("checksum"));
    let edited = kept.collect::<Vec<_>>().join("\n").replace("\"complete\"", "\"interrupted\"");
    std::fs::write(&sidecar, edited).unwrap();
    std::fs::remove_file(wet).unwrap();
    let told = format!(
        "the log {} is gone: its sidecar says that {} is interrupted; copy it back, or froude run drives it again",
        text(wet),
        id(wet)
    );
    assert_eq!(refusal(&["inspect", text(&sidecar)]), format!("froude: {told}\n"));
    assert_eq!(findings_of(&bench.inspect(), "run-gone"), [("warning".to_owned(), told)]);
    assert!(!froude(&["carriage", "drag", text(&sidecar)]).status.success());
}
