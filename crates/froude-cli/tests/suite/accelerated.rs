//! Accelerated tows at the verbs: plan, simulate and identify of the example campaign, few runs and many, and what is refused.

use crate::tank::{example, froude, json, refused, said, simulated};

const EXAMPLE: &str = "mamba-accelerated";
/// The arguments of what is refused.
const IDENTIFY: &[&str] = &["identify", "campaign.toml"];

/// Truth within half again of the interval, and the interval as wide as planned within `band`.
fn is_as_planned(plan: &serde_json::Value, estimate: &serde_json::Value, band: std::ops::Range<f64>) {
    for expected in plan["sources"][0]["expected"].as_array().unwrap() {
        let name = expected["coefficient"].as_str().unwrap();
        let interval = &estimate["coefficients"][name]["interval_95"];
        let (low, high) = (interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap());
        let (truth, half) = (expected["value"].as_f64().unwrap(), 0.5 * (high - low));
        // One campaign: an interval of 95 % may miss by a little.
        assert!((truth - 0.5 * (low + high)).abs() < 1.5 * half, "{name}: {truth} not near [{low}, {high}]");
        let ratio = half / expected["half_width_95"].as_f64().unwrap();
        assert!(band.contains(&ratio), "{name}: {ratio}");
    }
}

#[test]
fn nine_runs_are_planned_simulated_and_identified() {
    let folder = example(EXAMPLE, &[]);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    assert_eq!(plan["sources"][0]["runs"].as_u64(), Some(9));
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "accelerated: 9 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimate = &record["estimates"][0];
    assert_eq!(estimate["method"]["name"].as_str(), Some("accelerated_tow"));
    assert_eq!(estimate["clusters"]["by"].as_str(), Some("run"));
    assert_eq!(estimate["clusters"]["n"].as_u64(), Some(9));
    let volume = estimate["refers_to"]["link_volume"]["value"].as_f64().unwrap();
    // As declared.
    assert!((volume - 1.2723e-3).abs() < 1e-12);
    // C_A ρ V of the one body.
    let (added, c_a) = (&estimate["derived"]["added_mass"], &estimate["coefficients"]["C_Ay"]);
    let ratio = added["value"].as_f64().unwrap() / c_a["value"].as_f64().unwrap();
    assert!((ratio - 1000.0 * 1.2723e-3).abs() < 1e-9, "{ratio}");
    let formula = estimate["law"]["outputs"]["f_y"]["formula"].as_str().unwrap();
    assert!(formula.ends_with("- C_Ay*density*volume*v_y_dot"), "{formula}");
    // χ with 8 degrees of freedom has a standard deviation of a quarter.
    is_as_planned(&plan, estimate, 0.4..1.9);
    let errors: Vec<&String> = estimate["errors"].as_object().unwrap().keys().collect();
    for shared in ["mass of H1LT", "delay", "gain of the force"] {
        assert!(errors.iter().any(|key| key.contains(shared)), "{shared}: {errors:?}");
    }
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    for caption in ["Force and windows", "Fitted beside measured", "Spectrum of the residuals"] {
        assert!(page.contains(caption), "{caption}");
    }
}

const ONE: [(&str, &str); 2] = [
    ("speed        = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\"]", "speed        = \"0.3 m/s\""),
    ("acceleration = [\"0.1 m/s^2\", \"0.2 m/s^2\", \"0.3 m/s^2\"]", "acceleration = \"0.1 m/s^2\""),
];

/// One run gives drag and added mass with their correlation; its mass is weighed by runs in air where none is declared.
#[test]
fn one_run_gives_drag_and_added_mass_together() {
    let dry = (
        "[simulate]\nseed",
        "[[source.plan]]\nconfigurations = [\"H1LT\"]\nmedium = \"air\"\nspeed = \"0.3 m/s\"\nacceleration = \"0.3 m/s^2\"\nrepeats = 3\n\n[simulate]\nseed",
    );
    let folder = simulated(EXAMPLE, &[ONE[0], ONE[1], dry]);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimate = &record["estimates"][0];
    let names = estimate["type_a"]["names"].as_array().unwrap();
    assert!(names.iter().any(|n| n == "C_Ay") && names.iter().any(|n| n == "D_y_II"), "{names:?}");
    // One run of twenty correlation times: its scatter has some six degrees of freedom, so that u scatters by a third, and Student's factor with it.
    is_as_planned(&plan, estimate, 0.3..3.0);
    let errors: Vec<&String> = estimate["errors"].as_object().unwrap().keys().collect();
    assert!(errors.iter().any(|key| key.contains("mass of H1LT by runs in air")), "{errors:?}");
}

/// An added mass of potential flow as a prior of what the ramps show: C_A = A22/(ρV).
#[test]
fn an_added_mass_of_a_record_is_a_prior() {
    let folder = simulated(EXAMPLE, &ONE);
    // An ellipsoid of some 1 kg across: 6 × 6 by closed form.
    let body = "[body]\nshape = \"ellipsoid\"\nsemi_axis_x = \"150 mm\"\nsemi_axis_y = \"45 mm\"\nsemi_axis_z = \"45 mm\"\n\n[fluid]\ndensity = \"1000 kg/m^3\"\n";
    std::fs::write(folder.path().join("ellipsoid.toml"), format!("schema = 1\n{body}")).unwrap();
    let output = froude(folder.path(), &["added-mass", "ellipsoid.toml", "--out", "am"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let path = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let with = |prior: &str| {
        std::fs::write(&path, text.replace("[simulate]\n", &format!("[identify]\nprior = [{prior}]\n\n[simulate]\n")))
            .unwrap();
    };
    let record: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("am/estimate.json")).unwrap()).unwrap();
    let a22 = record["estimates"][0]["coefficients"]["A22"]["value"].as_f64().unwrap();
    with(
        "{ coefficient = \"C_Ay\", record = \"am/estimate.json\", entry = \"A22\", volume = \"1.2723e-3 m^3\", model_form = \"0.01 %\" }",
    );
    let found = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let added = &found["estimates"][0]["coefficients"]["C_Ay"];
    assert_eq!(added["status"].as_str(), Some("prior"));
    // The prior is a hundred times narrower than the data: C_A = A22/(ρV).
    let value = added["value"].as_f64().unwrap();
    assert!((value / (a22 / (1000.0 * 1.2723e-3)) - 1.0).abs() < 1e-3, "{value} {a22}");
    with("{ coefficient = \"C_Ay\", record = \"am/estimate.json\", entry = \"A22\", model_form = \"5 %\" }");
    let error = refused(folder.path(), IDENTIFY);
    assert!(error.contains("C_Ay is a pure number and A22 is in kg; write volume"), "{error}");
    with("{ coefficient = \"C_Ay\", record = \"am/estimate.json\", entry = \"A77\", model_form = \"5 %\" }");
    assert!(refused(folder.path(), IDENTIFY).contains("is \"A77\", which"), "{}", refused(folder.path(), IDENTIFY));
    with("{ coefficient = \"C_Ay\", record = \"none.json\", entry = \"A22\", model_form = \"5 %\" }");
    assert!(refused(folder.path(), IDENTIFY).contains("none.json"), "{}", refused(folder.path(), IDENTIFY));
}

#[test]
fn what_is_not_declared_is_refused_with_what_to_write() {
    let folder = simulated(EXAMPLE, &ONE);
    let path = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replace(from, to)).unwrap();
        refused(folder.path(), IDENTIFY)
    };
    let error = with("mass   = {", "# mass   = {");
    assert!(error.contains("the mass below the load cell is not known of H1LT: write mass = { value"), "{error}");
    // The other sign: the water would drive the body.
    std::fs::write(&path, &text).unwrap();
    let sidecar = folder.path().join("runs/001.toml");
    let own = std::fs::read_to_string(&sidecar).unwrap();
    std::fs::write(&sidecar, own.replace("unit = \"N\", sign = 1", "unit = \"N\", sign = -1")).unwrap();
    let found = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let error = found["findings"].as_array().unwrap().iter().find(|f| f["code"] == "force-along-motion").unwrap();
    assert_eq!(error["severity"].as_str(), Some("error"));
    std::fs::write(&sidecar, own).unwrap();
    let error = with("axis   = \"y\"", "# axis");
    assert!(error.contains("state which axis of the body lies along the travel"), "{error}");
    let error = with("link_volume = \"1.2723e-3 m^3\"", "");
    assert!(error.contains("C_A means nothing without the volume that it refers to"), "{error}");
    let error = with("models = [\"linear_quadratic\"]", "models = [\"power_law\"]");
    assert!(error.contains("is not written as a formula of the load along y"), "{error}");
    let error = with("standard = \"0.5 %\"", "standard = \"0.1 N\"");
    assert!(error.contains("is a gain that all runs share: write it as a percentage"), "{error}");
    let error = with("window = \"0.5 s\"", "window = \"0.05 s\"");
    assert!(error.contains("a window of 0.05 s holds 5.0 samples, and 8 are needed"), "{error}");
}

#[test]
fn a_channel_whose_sign_is_not_declared_and_a_cut_log_are_refused() {
    let folder = simulated(EXAMPLE, &ONE);
    let sidecar = folder.path().join("runs/001.toml");
    let text = std::fs::read_to_string(&sidecar).unwrap();
    let unsigned = text.replace("name = \"force\", unit = \"N\", sign = 1", "name = \"force\", unit = \"N\"");
    std::fs::write(&sidecar, unsigned).unwrap();
    let error = refused(folder.path(), IDENTIFY);
    assert!(error.contains("force states no sign; drag and added mass are wrong"), "{error}");
    std::fs::write(&sidecar, text).unwrap();
    // The log begins and ends while it moves.
    let log = folder.path().join("runs/001.csv");
    let rows = std::fs::read_to_string(&log).unwrap();
    let mut lines: Vec<&str> = rows.lines().collect();
    lines.drain(lines.len() - 700..);
    lines.drain(1..600);
    std::fs::write(&log, lines.join("\n") + "\n").unwrap();
    let error = refused(folder.path(), IDENTIFY);
    assert!(error.contains("the zero of the cell is unknown: the body stands still for 0.00 s before"), "{error}");
}

/// One sample of a million newtons decided every coefficient; it is named, and a mark leaves it out.
#[test]
fn a_wild_sample_is_refused_until_a_mark_leaves_it_out() {
    let folder = simulated(EXAMPLE, &ONE);
    let log = folder.path().join("runs/001.csv");
    let rows = std::fs::read_to_string(&log).unwrap();
    let force = rows.lines().next().unwrap().split(',').position(|head| head.starts_with("force")).unwrap();
    let mut time = String::new();
    let spoilt = rows.lines().enumerate().map(|(i, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if i == 700 {
            time = cells[0].to_owned();
            cells[force] = "1234567";
        }
        cells.join(",") + "\n"
    });
    let spoilt: String = spoilt.collect();
    std::fs::write(&log, spoilt).unwrap();
    let error = refused(folder.path(), IDENTIFY);
    assert!(
        error.contains("001.csv") && error.contains("force is 1.235 × 10⁶ N at 6.99 s") && error.contains("[[marks]]"),
        "{error}"
    );
    let sidecar = folder.path().join("runs/001.toml");
    let text = std::fs::read_to_string(&sidecar).unwrap();
    let at: f64 = time.parse().unwrap();
    let mark = format!(
        "\n[[marks]]\nfrom = \"{} s\"\nto = \"{} s\"\nwhy = \"spike\"\nby = \"test\"\n",
        at - 0.005,
        at + 0.005
    );
    std::fs::write(&sidecar, text + &mark).unwrap();
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let drag = record["estimates"][0]["coefficients"]["D_y_II"]["value"].as_f64().unwrap();
    assert!((0.0..100.0).contains(&drag), "{drag}");
}

/// A force that a filter holds back is late by 60 ms: it is found, and declaring it removes the finding.
#[test]
fn a_force_that_is_late_is_found_and_declaring_it_removes_the_finding() {
    let folder = simulated(EXAMPLE, &[]);
    let late = |log: &std::path::Path| {
        let rows = std::fs::read_to_string(log).unwrap();
        let mut lines: Vec<Vec<String>> = rows.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
        let force = lines[0].iter().position(|head| head.starts_with("force")).unwrap();
        let seconds = |row: &[String]| row[0].parse::<f64>().unwrap();
        let step_s = seconds(&lines[2]) - seconds(&lines[1]);
        let by = (0.06 / step_s).round() as usize;
        for i in (1 + by..lines.len()).rev() {
            lines[i][force] = lines[i - by][force].clone();
        }
        let text: Vec<String> = lines.into_iter().map(|cells| cells.join(",")).collect();
        std::fs::write(log, text.join("\n") + "\n").unwrap();
    };
    let lag = |folder: &std::path::Path| {
        let record = json(&froude(folder, &["identify", "campaign.toml", "--json"]));
        let findings = record["findings"].as_array().unwrap().clone();
        findings.iter().find(|f| f["code"] == "lag").map(|f| f["message"].as_str().unwrap().to_owned())
    };
    assert_eq!(lag(folder.path()), None);
    for entry in std::fs::read_dir(folder.path().join("runs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "csv") {
            late(&path);
        }
    }
    let said = lag(folder.path()).expect("a lag");
    // A delay that these runs show must not be declared beside them: the filter's own is.
    assert!(said.contains("not one found from these same runs"), "{said}");
    let delay = "delay = { value = \"60 ms\", standard = \"2 ms\" }";
    let campaign = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&campaign).unwrap();
    let lines = text.lines().map(|line| if line.starts_with("delay") { delay } else { line });
    std::fs::write(&campaign, lines.collect::<Vec<_>>().join("\n")).unwrap();
    assert_eq!(lag(folder.path()), None, "after {delay}");
}

/// With drag that varies by 2 % from run to run, the intervals of three runs contain the truth in at least 94 % of campaigns, within three standard deviations. For one run a finding reports
/// that this variation is missing.
#[test]
fn three_runs_include_what_changes_from_run_to_run() {
    let plan = [ONE[0], ONE[1], ("still        = \"5 s\"", "still        = \"5 s\"\nrepeats      = 3")];
    // A sum of twelve even numbers is normal to 2.5 standard deviations.
    let mut state = 29_u64;
    let mut even = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut held = 0;
    let seeds = 60;
    for seed in 0..seeds {
        let of_seed = format!("seed  = {}", 100 + seed);
        let folder = simulated(EXAMPLE, &[plan[0], plan[1], plan[2], ("seed  = 7", of_seed.as_str())]);
        for run in 1..=3 {
            let z = (0..12).map(|_| even()).sum::<f64>() - 6.0;
            with_drag(&folder.path().join(format!("runs/00{run}.csv")), 0.02 * z);
        }
        let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
        let interval = &record["estimates"][0]["coefficients"]["D_y_II"]["interval_95"];
        let ends = [0, 1].map(|k| interval[k].as_f64().unwrap());
        held += i32::from(ends[0] <= 25.0 && 25.0 <= ends[1]);
    }
    assert!(held >= 51, "{held} of {seeds}");
    let folder = simulated(EXAMPLE, &ONE);
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let few = record["findings"].as_array().unwrap().iter().find(|f| f["code"] == "few-runs").unwrap();
    assert!(few["message"].as_str().unwrap().contains("1 run: what changes from run to run"), "{few}");
}

/// Adds a part of the drag of [simulate] to the force of a log.
fn with_drag(log: &std::path::Path, part: f64) {
    let rows = std::fs::read_to_string(log).unwrap();
    let head: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|h| *h == name).unwrap();
    let (force, position) = (column("force"), column("x"));
    let cells: Vec<Vec<f64>> =
        rows.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().unwrap()).collect()).collect();
    let wide = 20;
    let mut out = head.join(",") + "\n";
    for i in 0..cells.len() {
        let (a, b) = (i.saturating_sub(wide), (i + wide).min(cells.len() - 1));
        let v = (cells[b][position] - cells[a][position]) / (cells[b][0] - cells[a][0]);
        let mut row = cells[i].clone();
        row[force] += part * (0.5 * v + 25.0 * v * v.abs());
        out += &(row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n");
    }
    std::fs::write(log, out).unwrap();
}
