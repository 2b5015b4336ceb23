//! Excited response at the verbs: the real section in waves, its twin, and what is refused.

use crate::tank::{froude, json, refused, replace_in, said};
use std::path::{Path, PathBuf};

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ntnu-section")
}

/// The real logs whose names hold one of some texts, in a folder of their own, with the campaign changed.
fn real(of: &[&str], replaced: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("waves")).unwrap();
    for entry in std::fs::read_dir(example().join("waves")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if of.iter().any(|text| name.contains(text)) {
            std::fs::copy(&path, folder.path().join("waves").join(name)).unwrap();
        }
    }
    written(folder, "campaign.toml", replaced)
}

fn written(folder: tempfile::TempDir, name: &str, replaced: &[(&str, &str)]) -> tempfile::TempDir {
    let mut text = std::fs::read_to_string(example().join(name)).unwrap();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(folder.path().join(name), text).unwrap();
    folder
}

fn messages(record: &serde_json::Value, code: &str) -> Vec<String> {
    let all = record["findings"].as_array().unwrap().iter().filter(|f| f["code"] == code);
    all.map(|f| f["message"].as_str().unwrap().to_owned()).collect()
}

fn coefficient<'a>(record: &'a serde_json::Value, period: &str, name: &str) -> &'a serde_json::Value {
    let all = record["estimates"].as_array().unwrap();
    let of = all.iter().find(|e| e["id"].as_str().unwrap().contains(period)).unwrap();
    &of["coefficients"][name]
}

/// A33 from accelerometers, computed beforehand by a second program: 31.8, 31.3, 32.7 (± 1.0) and 35.7 kg (± 2.5).
#[test]
fn the_real_section_has_the_added_mass_that_was_computed_beforehand() {
    let folder = real(&[""], &[]);
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let expected = [("1.210 s", 31.8, 1.0), ("1.074 s", 31.3, 1.0), ("0.802 s", 32.7, 1.0), ("0.733 s", 35.7, 2.5)];
    for (period, kg, within) in expected {
        let found = coefficient(&record, period, "A33")["value"].as_f64().unwrap();
        assert!((found - kg).abs() <= within, "{period}: {found}");
        let damping = coefficient(&record, period, "B33");
        assert_eq!(damping["status"], "free");
        assert!(damping["value"].as_f64().unwrap() > 0.0);
    }
    assert_eq!(record["estimates"].as_array().unwrap().iter().filter(|e| e["recommended"] == true).count(), 1);
    let keys: Vec<&String> = record["estimates"][0]["errors"].as_object().unwrap().keys().collect();
    for name in
        ["mass", "restoring coefficient C33", "gain of the force", "gain of the acceleration", "delay of the force"]
    {
        assert!(keys.iter().any(|key| key.contains(name)), "{name}: {keys:?}");
    }
    // Skews of −7.3, −6.6 and +8.5 ms/s within 1.5, and gains of 0.86 to 0.87.
    let clocks = messages(&record, "camera-clock");
    for (run, skew) in [("6041_1", -7.3), ("6041_2", -6.6), ("6081_1", 8.5)] {
        let text = clocks.iter().find(|t| t.contains(run)).unwrap();
        let number = |after: &str| -> f64 {
            let rest = text.split(after).nth(1).unwrap().trim_start();
            rest.split([' ', ',']).next().unwrap().parse().unwrap()
        };
        assert!((number("skew ") - skew).abs() <= 1.5, "{text}");
        assert!((0.855..0.875).contains(&number("gain ")), "{text}");
        assert!(text.contains("reported and not repaired"), "{text}");
    }
    let lost = messages(&record, "camera-not-alignable");
    assert!(lost.iter().any(|t| t.contains("6111") && t.contains("not alignable by offset and skew")), "{lost:?}");
    assert_eq!(messages(&record, "guides-in-damping").len(), 1);
}

/// 100 N s/m before reflections, 176 after: no fit shows which.
#[test]
fn damping_needs_the_declared_window() {
    let window = "window    = { from = \"14 s\", to = \"20.5 s\" }";
    let folder = real(&["2041", "6041_1"], &[(window, "# no window")]);
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let damping = coefficient(&record, "1.210 s", "B33");
    assert_eq!(
        (&damping["status"], damping["value"].is_null()),
        (&serde_json::json!("undetermined"), true),
        "{damping}"
    );
    let added = coefficient(&record, "1.210 s", "A33")["value"].as_f64().unwrap();
    assert!((added - 31.8).abs() <= 1.0, "{added}");
    let text = messages(&record, "window-not-declared");
    assert!(text.len() == 1 && text[0].contains("B33 only with the declared window before reflections"), "{text:?}");
    let page = froude(folder.path(), &["identify", "campaign.toml"]);
    assert!(String::from_utf8_lossy(&page.stdout).contains("not determined"));
    let damping = |from: &str, to: &str| {
        let other = format!("window    = {{ from = \"{from}\", to = \"{to}\" }}");
        let folder = real(&["2041", "6041_1"], &[(window, &other)]);
        let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
        coefficient(&record, "1.210 s", "B33")["value"].as_f64().unwrap()
    };
    // Computed beforehand: 108, 125 and 176 from windows that begin 12, 15 and 18 s after the start.
    let [early, late] = [damping("12 s", "22 s"), damping("20 s", "30 s")];
    assert!((early - 108.0).abs() < 5.0 && late > 150.0, "{early} {late}");
}

#[test]
fn the_page_shows_the_signals_the_window_the_spectrum_and_the_budget() {
    let folder = real(&["2081", "6081"], &[]);
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    for words in [
        "Runs and fit",
        "time after the wavemaker",
        "fitted, where used",
        "Standard uncertainties, by error.",
        "scatter of the motion, body free (A)",
        "Power density of what the fits leave",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn what_a_run_lacks_is_said_with_its_place() {
    let folder = real(&["2081", "6081"], &[]);
    let sidecar = folder.path().join("waves/sway_clamped_6081_1.toml");
    let original = std::fs::read_to_string(&sidecar).unwrap();
    let identify = || refused(folder.path(), &["identify", "campaign.toml"]);
    for (key, lacking) in
        [("unit = \"m/s^2\", sign = 1, ", "unit = \"m/s^2\", "), ("clock = \"log\"", "quantity = \"x\"")]
    {
        std::fs::write(&sidecar, original.replace(key, lacking)).unwrap();
        let text = identify();
        assert!(text.contains("sway_clamped_6081_1.toml:") && text.contains("states no"), "{text}");
    }
    let without = original.lines().filter(|l| !l.contains("acc_heave") && !l.contains("heave_m"));
    std::fs::write(&sidecar, without.collect::<Vec<_>>().join("\n")).unwrap();
    let text = identify();
    assert!(text.contains("a run with the free body needs its motion"), "{text}");
    std::fs::write(&sidecar, original.replace("1.074 s", "1.21 s")).unwrap();
    let text = identify();
    assert!(text.contains("its wavemaker has a period of 1.072") && text.contains("says 1.21 s"), "{text}");
    std::fs::write(&sidecar, &original).unwrap();
    let campaign = folder.path().join("campaign.toml");
    let declared = std::fs::read_to_string(&campaign).unwrap();
    for (from, to, words) in [
        ("to = \"20.5 s\"", "to = \"18 s\"", "whole cycles of 1.072 s, and 5 are needed"),
        ("to = \"20.5 s\"", "to = \"90 s\"", "does not lie within the log"),
        ("to = \"20.5 s\"", "to = \"3 s\"", "makes a window from 14 s to 3 s"),
        ("axis      = \"heave\"", "axis = \"sway\"", "coupled"),
        ("quantity = \"f_z\"", "quantity = \"angle\"", "is not a quantity of an excited response"),
        ("mass      = {", "# mass = {", "write mass"),
    ] {
        std::fs::write(&campaign, declared.replace(from, to)).unwrap();
        let text = identify();
        assert!(text.contains(words), "{from}: {text}");
    }
    std::fs::write(&campaign, &declared).unwrap();
    replace_in(&folder.path().join("waves/fixed_2081.toml"), "role   = \"held\"", "role   = \"still\"");
    let text = identify();
    assert!(text.contains("no run with the held body (role \"held\") has its wave of 1.072 s"), "{text}");
}

/// The wavemaker of the held run taken for that of another wave: half the stroke.
#[test]
fn wavemakers_that_differ_are_refused() {
    let folder = real(&["2081", "6081"], &[]);
    let log = folder.path().join("waves/fixed_2081.csv");
    let text = std::fs::read_to_string(&log).unwrap();
    let halved = text.lines().enumerate().map(|(i, line)| {
        if i == 0 {
            return line.to_owned();
        }
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[1] = (0.5 * cells[1].parse::<f64>().unwrap()).to_string();
        cells.join(",")
    });
    std::fs::write(&log, halved.collect::<Vec<_>>().join("\n")).unwrap();
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("a ratio of 2.00") && text.contains("repeat one of them"), "{text}");
}

#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = written(tempfile::tempdir().unwrap(), "twin.toml", &[]);
    let plan = json(&froude(folder.path(), &["plan", "twin.toml", "--json"]));
    assert_eq!(plan["sources"][0]["runs"].as_u64(), Some(6));
    // Six runs of 2 s of rest and 28 s of waves.
    assert!((plan["sources"][0]["duration_s"].as_f64().unwrap() - 180.0).abs() < 1e-9, "{plan}");
    let output = froude(folder.path(), &["simulate", "twin.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "wave flume: 6 runs in twin-runs");
    let record = json(&froude(folder.path(), &["identify", "twin.toml", "--json"]));
    for expected in plan["sources"][0]["expected"].as_array().unwrap() {
        let (model, name) = (expected["model"].as_str().unwrap(), expected["coefficient"].as_str().unwrap());
        let interval = &coefficient(&record, model, name)["interval_95"];
        let (low, high) = (interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap());
        let (truth, half) = (expected["value"].as_f64().unwrap(), 0.5 * (high - low));
        // One campaign of six intervals: one of 95 % may miss by a little.
        assert!((truth - 0.5 * (low + high)).abs() < 1.6 * half, "{model} {name}: {truth} not near [{low}, {high}]");
        // χ with eight degrees of freedom has a standard deviation of a quarter.
        let ratio = half / expected["half_width_95"].as_f64().unwrap();
        assert!((0.4..1.8).contains(&ratio), "{model} {name}: {ratio}");
    }
    let without = written(tempfile::tempdir().unwrap(), "twin.toml", &[("window    = {", "# window = {")]);
    let text = refused(without.path(), &["plan", "twin.toml"]);
    assert!(text.contains("a plan in waves needs the window that the tank allows"), "{text}");
}
