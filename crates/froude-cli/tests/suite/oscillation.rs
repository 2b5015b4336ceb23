//! Forced oscillation at the verbs: plan, simulate and identify of the example campaign, and what is refused.

use crate::tank::{example, froude, json, refused, replace_in, said, simulated};

const EXAMPLE: &str = "mamba-oscillation";

/// Two amplitudes at two frequencies: eight runs.
const SMALL: [(&str, &str); 2] = [
    ("[\"10 deg\", \"15 deg\", \"20 deg\"]", "[\"10 deg\", \"20 deg\"]"),
    ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "[\"60 deg/s\", \"80 deg/s\"]"),
];

/// The plan's interval is the one that the identification then states, to what eight runs let it scatter.
#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = example(EXAMPLE, &SMALL);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    assert_eq!(
        (plan["sources"][0]["runs"].as_u64(), plan["sources"][0]["source"].as_str()),
        (Some(8), Some("circulation tank"))
    );
    // Seven periods of 6 s and of 4.5 s, and a second before each: 4·(43 + 32.5) s.
    assert!((plan["sources"][0]["duration_s"].as_f64().unwrap() - 302.0).abs() < 0.5, "{plan}");
    let of = |model: &str, name: &str| {
        let all = plan["sources"][0]["expected"].as_array().unwrap();
        all.iter().find(|e| e["model"] == model && e["coefficient"] == name).unwrap()["half_width_95"].as_f64().unwrap()
    };
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "circulation tank: 8 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimates = record["estimates"].as_array().unwrap();
    let f4 = estimates.iter().find(|e| e["law"]["name"] == "added_mass_f4").unwrap();
    let c_a = &f4["coefficients"]["C_A"];
    let (value, interval) = (c_a["value"].as_f64().unwrap(), &c_a["interval_95"]);
    let (low, high) = (interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap());
    assert!(low < 1.277 && 1.277 < high && (value - 1.277).abs() < 0.06, "{c_a}");
    let ratio = 0.5 * (high - low) / of("f4", "C_A");
    // χ² of seven clusters: 0.5 to 1.5 of the scatter, which is half of the variance.
    assert!((0.6..1.5).contains(&ratio), "{ratio}");
    assert_eq!(f4["recommended"], true, "f1 is the wrong law: {f4}");
    assert_eq!(f4["clusters"]["by"], "run");
    assert!(f4["method"]["words"].as_str().unwrap().contains("the pivot axis lies along the stream"));
    assert!((f4["refers_to"]["link_volume"]["value"].as_f64().unwrap() - 1.2723e-3).abs() < 1e-12);
    let keys: Vec<&String> = f4["errors"].as_object().unwrap().keys().collect();
    for name in ["radius", "mass of H1LT", "buoyancy of H2LT", "delay"] {
        assert!(keys.iter().any(|key| key.contains(name)), "{name}: {keys:?}");
    }
    // Simulated again, the same logs; over other files never.
    let before = std::fs::read(folder.path().join("runs/003.csv")).unwrap();
    assert!(refused(folder.path(), &["simulate", "campaign.toml"]).contains("give --replace"));
    let again = froude(folder.path(), &["simulate", "campaign.toml", "--replace"]);
    assert_eq!(again.status.code(), Some(0), "{}", said(&again));
    assert_eq!(std::fs::read(folder.path().join("runs/003.csv")).unwrap(), before);
    std::fs::write(folder.path().join("runs/my own.csv"), "a real log").unwrap();
    let text = refused(folder.path(), &["simulate", "campaign.toml", "--replace"]);
    assert!(text.contains("my own.csv, not written by the twin"), "{text}");
    assert!(folder.path().join("runs/my own.csv").exists());
}

#[test]
fn the_page_shows_the_runs_the_fit_the_spectrum_and_the_budget() {
    let folder = simulated(EXAMPLE, &SMALL);
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    for words in [
        "Runs and fit",
        "correlation time τ [samples]",
        "Standard uncertainties, by error.",
        "mass of H2LT (B)",
        "Power density of measured less fitted force",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn nothing_about_a_run_is_taken_for_granted() {
    let folder = simulated(EXAMPLE, &SMALL);
    let sidecar = folder.path().join("runs/002.toml");
    let identify = || refused(folder.path(), &["identify", "campaign.toml"]);
    replace_in(&sidecar, "unit = \"N\", sign = 1, ", "unit = \"N\", ");
    let text = identify();
    assert!(
        text.contains("002.toml:15")
            && text.contains("force states no sign")
            && text.contains("the rig on the body along +y"),
        "{text}"
    );
    replace_in(&sidecar, "unit = \"N\", ", "unit = \"N\", sign = 1, ");
    replace_in(&sidecar, "flow = \"0.2 m/s\"", "current = \"0.2 m/s\"");
    let text = identify();
    assert!(text.contains("[conditions] current is not known here"), "{text}");
    replace_in(&sidecar, "current = \"0.2 m/s\"", "flow = \"0.2 N\"");
    assert!(identify().contains("flow is in"));
    replace_in(&sidecar, "flow = \"0.2 N\"", "flow = \"0.2 m/s\"");
    replace_in(&sidecar, "method = \"forced_oscillation\"\n", "");
    let text = identify();
    assert!(text.contains("states no method") && text.contains("002.csv"), "{text}");
}

#[test]
fn what_the_campaign_does_not_declare_is_asked_for() {
    for (from, to, expected) in [
        ("pivot    = \"stream\"", "# pivot", "state how the pivot axis lies"),
        ("mass     = {", "# mass = {", "all that moves below the load cell"),
        ("radius   = {", "# radius = {", "write radius"),
        ("link_volume = \"1.2723e-3 m^3\"", "# no volume", "C_A means nothing without the volume that it refers to"),
        ("frequency = [\"60 deg/s\", \"80 deg/s\"]", "frequency = [\"1.0 1/s\"]", "neither periods nor radians"),
        ("frequency = [\"60 deg/s\", \"80 deg/s\"]", "frequency = [\"0.2 Hz\", \"80 deg/s\"]", "partly in Hz"),
        (
            "method = \"forced_oscillation\"",
            "method = \"forced_oscilation\"",
            "`forced_oscillation` is not called as the method is, \"forced_oscilation\": name both alike",
        ),
        ("C_A      = 1.277\n", "", "C_A is missing"),
    ] {
        let mut replaced = SMALL.to_vec();
        replaced.push((from, to));
        let folder = example(EXAMPLE, &replaced);
        let text = refused(folder.path(), &["plan", "campaign.toml"]);
        assert!(
            text.contains(expected) && text.contains("campaign.toml") || text.contains("C_A is missing"),
            "{from}: {text}"
        );
    }
}

#[test]
fn a_damaged_log_is_refused_with_its_run() {
    let folder = simulated(EXAMPLE, &SMALL);
    let log = folder.path().join("runs/001.csv");
    let whole = std::fs::read_to_string(&log).unwrap();
    let identify = || refused(folder.path(), &["identify", "campaign.toml"]);
    // Clipped well below the peaks of the steady swing (the largest force of all is that of the start).
    let rows: Vec<Vec<f64>> =
        whole.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let steady = || rows.iter().filter(|r| r[0] > 8.0).map(|r| r[2]);
    let largest = steady().fold(f64::MIN, f64::max);
    let smallest = steady().fold(f64::MAX, f64::min);
    let limit = largest - 0.2 * (largest - smallest);
    let clipped: String = rows.iter().map(|r| format!("{},{},{}\n", r[0], r[1], r[2].min(limit))).collect();
    std::fs::write(&log, format!("time,phi,force\n{clipped}")).unwrap();
    let text = identify();
    assert!(text.contains("\"001\"") && text.contains("it is clipped"), "{text}");
    // Too short for five cycles.
    let short: String = whole.lines().take(2_000).map(|l| format!("{l}\n")).collect();
    std::fs::write(&log, short).unwrap();
    let text = identify();
    assert!(text.contains("whole cycles of 6.") && text.contains("5 are needed"), "{text}");
    // No oscillation at all.
    let still: String =
        rows.iter().enumerate().map(|(i, r)| format!("{},{},{}\n", r[0], 1e-3 * (i % 2) as f64, r[2])).collect();
    std::fs::write(&log, format!("time,phi,force\n{still}")).unwrap();
    let text = identify();
    assert!(text.contains("\"001\""), "{text}");
}

/// The force of the body on the rig for that of the rig on the body; and a law that is not the true one.
#[test]
fn a_wrong_sign_and_a_wrong_law_are_findings() {
    let folder = simulated(EXAMPLE, &SMALL);
    let codes = |record: &serde_json::Value| -> Vec<(String, String)> {
        let text = |f: &serde_json::Value, key: &str| f[key].as_str().unwrap().to_owned();
        record["findings"].as_array().unwrap().iter().map(|f| (text(f, "code"), text(f, "message"))).collect()
    };
    let of = |all: &[(String, String)], code: &str| -> Vec<String> {
        all.iter().filter(|(c, _)| c == code).map(|(_, message)| message.clone()).collect()
    };
    let right = codes(&json(&froude(folder.path(), &["identify", "campaign.toml", "--json"])));
    let misfit = of(&right, "misfit-repeats");
    assert!(misfit.len() == 1 && misfit[0].starts_with("f1: "), "{right:?}");
    assert!(of(&right, "negative-added-mass").is_empty());
    for entry in std::fs::read_dir(folder.path().join("runs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            replace_in(&path, "unit = \"N\", sign = 1", "unit = \"N\", sign = -1");
        }
    }
    let wrong = codes(&json(&froude(folder.path(), &["identify", "campaign.toml", "--json"])));
    assert_eq!(of(&wrong, "negative-added-mass").len(), 2, "{wrong:?}");
    assert_eq!(of(&wrong, "misfit-repeats").len(), 2, "{wrong:?}");
}

#[test]
fn a_folder_of_such_runs_is_inspected_and_no_folder_of_releases() {
    let folder = simulated(EXAMPLE, &SMALL);
    let output = froude(folder.path(), &["inspect", "runs"]);
    let text = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("forced_oscillation, role test, H1LT, flow 0.2000 m/s"), "{text}");
    assert!(text.contains("method = \"forced_oscillation\" in a [[source]]"), "{text}");
    let decay = "schema = 1\nname = \"decay\"\n[[source]]\nname = \"roll\"\nkind = \"tank\"\nruns = \"runs\"\nmethod = \"decay_envelope\"\n[source.decay]\naxis = \"roll\"\ninertia = \"1 kg m^2\"\nstiffness = \"1 N m\"\n";
    std::fs::write(folder.path().join("decay.toml"), decay).unwrap();
    let text = refused(folder.path(), &["identify", "decay.toml"]);
    assert!(text.contains("001.csv: is a run of forced_oscillation, and free_decay is read here"), "{text}");
}

/// One frequency: added mass and buoyancy are both in phase with the angle, but for the sine of large angles.
#[test]
fn one_frequency_does_not_tell_added_mass_from_buoyancy() {
    let replaced = [
        SMALL[0],
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"70 deg/s\""),
        ("models = [\"f1\", \"f4\"]", "models = [\"linear_quadratic\"]"),
        ("buoyancy = {", "# buoyancy = {"),
        ("C_A      = 1.277", "C_A      = 1.277\nB_buoyancy_H1LT = \"3 N\"\nB_buoyancy_H2LT = \"3 N\""),
    ];
    let folder = example(EXAMPLE, &replaced);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    let c_a = plan["sources"][0]["expected"].as_array().unwrap().iter().find(|e| e["coefficient"] == "C_A").unwrap();
    assert!(c_a["half_width_95"].as_f64().unwrap() > 0.25 * 1.277, "{c_a}");
}

/// Still runs at four angles in place of a declared buoyancy, and a gain of the angle.
const STILL: [(&str, &str); 3] = [
    (
        "buoyancy = { value = \"3.0 N\", standard = \"0.02 N\" }           # from still runs\n",
        "still_runs = { zeroed = \"once\" }\n",
    ),
    (
        "[simulate]\n",
        "[[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\"]\nmedium = \"still\"\nangle = [\"20 deg\", \"-20 deg\", \"10 deg\", \"-10 deg\"]\n\n\
         [[source.uncertainty]]\nquantity = \"angle\"\nstandard = \"0.5 %\"\nshared = \"campaign\"\n\n[simulate]\n",
    ),
    ("C_A      = 1.277\n", "C_A      = 1.277\nB_buoyancy_H1LT = \"3 N\"\nB_buoyancy_H2LT = \"3 N\"\n"),
];

/// 4.76 mN of noise and 14.6 mN of the gain: 3 N · 0.005 · ⟨φ cos φ sin φ⟩/⟨sin² φ⟩.
#[test]
fn still_runs_determine_the_buoyancy_and_wrong_ones_are_found() {
    let folder = simulated(EXAMPLE, &[&SMALL[..], &STILL].concat());
    let identify = || json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    let number = |value: &serde_json::Value, key: &str| value[key].as_f64().unwrap();
    let planned = plan["sources"][0]["from_still_runs"].as_array().unwrap();
    assert_eq!((plan["sources"][0]["runs"].as_u64(), planned.len()), (Some(16), 2));
    for of in planned {
        assert!((number(of, "noise_N") - 4.76e-3).abs() < 2e-5, "{of}");
        assert!((number(of, "gain_of_the_angle_N") - 14.4e-3).abs() < 2e-4, "{of}");
    }
    let record = identify();
    let estimates = record["estimates"].as_array().unwrap();
    let f4 = &estimates.iter().find(|e| e["law"]["name"] == "added_mass_f4").unwrap()["coefficients"];
    for (name, truth) in [("C_A", 1.277), ("B_buoyancy_H1LT", 3.0), ("B_buoyancy_H2LT", 3.0)] {
        let [low, high] = [0, 1].map(|i| f4[name]["interval_95"][i].as_f64().unwrap());
        assert!((low..=high).contains(&truth), "{name}: {low} {high}");
    }
    let width = 0.5
        * [1, 0]
            .map(|i| f4["B_buoyancy_H1LT"]["interval_95"][i].as_f64().unwrap())
            .into_iter()
            .reduce(|a, b| a - b)
            .unwrap();
    assert!((0.025..0.035).contains(&width), "{width}");
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    assert!(page.contains("Each still run: means over it.") && page.contains("gain of the angle"));
    let codes = |record: &serde_json::Value| -> Vec<String> {
        record["findings"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap().to_owned()).collect()
    };
    assert!(codes(&record).iter().all(|code| !code.starts_with("still-runs")), "{:?}", codes(&record));
    // Somebody leaned on the rig for 5 s of the first still run: 0.5 N. Unmarked it counts as noise of all still runs, too, and still moves B; marked it
    // takes 40 s of one run, a fraction of the 4.8 mN of noise.
    let buoyancy = |record: &serde_json::Value| {
        let all = record["estimates"].as_array().unwrap();
        let f4 = all.iter().find(|e| e["law"]["name"] == "added_mass_f4").unwrap();
        f4["coefficients"]["B_buoyancy_H1LT"]["value"].as_f64().unwrap()
    };
    let (log, sidecar) = (folder.path().join("runs/009.csv"), folder.path().join("runs/009.toml"));
    let [whole, told] = [&log, &sidecar].map(|path| std::fs::read_to_string(path).unwrap());
    let leaned = |line: &str| {
        let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let more = if (20.0..25.0).contains(&row[0]) { 0.5 } else { 0.0 };
        format!("{},{},{}", row[0], row[1], row[2] + more)
    };
    let rows: Vec<String> = whole.lines().skip(1).map(leaned).collect();
    std::fs::write(&log, format!("time,phi,force\n{}\n", rows.join("\n"))).unwrap();
    let unmarked = buoyancy(&identify()) - buoyancy(&record);
    let mark = "\n[[marks]]\nfrom = \"20 s\"\nto = \"25 s\"\nwhy = \"leaned on\"\nby = \"a person\"\n";
    std::fs::write(&sidecar, format!("{told}{mark}")).unwrap();
    let marked = buoyancy(&identify()) - buoyancy(&record);
    assert!(unmarked.abs() > 0.01 && marked.abs() < 0.0024, "{unmarked} {marked}");
    std::fs::write(&log, whole).unwrap();
    std::fs::write(&sidecar, told).unwrap();
    // The angle the wrong way round in the still runs alone, then those of one side alone.
    let stills = || (9..=16).map(|i| folder.path().join(format!("runs/{i:03}.toml")));
    for path in stills() {
        replace_in(&path, "unit = \"rad\", sign = 1", "unit = \"rad\", sign = -1");
    }
    let wrong = codes(&identify());
    assert!(wrong.iter().any(|code| code == "still-runs-contradicted"), "{wrong:?}");
    stills().for_each(|path| replace_in(&path, "unit = \"rad\", sign = -1", "unit = \"rad\", sign = 1"));
    for (i, ending) in [10, 12, 14, 16].into_iter().flat_map(|i| [(i, "csv"), (i, "toml")]) {
        std::fs::remove_file(folder.path().join(format!("runs/{i:03}.{ending}"))).unwrap();
    }
    let one_sided = codes(&identify());
    assert!(one_sided.iter().any(|code| code == "still-runs-on-one-side"), "{one_sided:?}");
    let campaign = folder.path().join("campaign.toml");
    replace_in(&campaign, "zeroed = \"once\"", "zeroed = \"each run\"");
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("campaign.toml:") && text.contains("removes what the still runs are for"), "{text}");
    replace_in(&campaign, "still_runs = { zeroed = \"each run\" }", "# no still_runs");
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("nothing states how the load cell was zeroed for them: write still_runs"), "{text}");
}
