//! Rotation at the verbs: plan, simulate and identify of the example campaign, and what is refused.

use crate::tank::{example, froude, json, refused, replace_in, said, simulated};

const EXAMPLE: &str = "mamba-rotation";

/// The plan's intervals are those that the identification then states, to what nine runs let them scatter.
#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = example(EXAMPLE, &[]);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    assert_eq!(
        (plan["sources"][0]["runs"].as_u64(), plan["sources"][0]["source"].as_str()),
        (Some(9), Some("turning rig"))
    );
    // Seven periods of 6 s, of 36/7 s and of 4.5 s, and two seconds before each, three times.
    assert!((plan["sources"][0]["duration_s"].as_f64().unwrap() - 346.5).abs() < 0.5, "{plan}");
    let of = |name: &str, key: &str| {
        let all = plan["sources"][0]["expected"].as_array().unwrap();
        all.iter().find(|e| e["coefficient"] == name).unwrap()[key].as_f64().unwrap()
    };
    let words = String::from_utf8_lossy(&froude(folder.path(), &["plan", "campaign.toml"]).stdout).into_owned();
    assert!(words.contains("Correlations to expect") && words.contains("lambda_2 with lambda_3 -0.8"), "{words}");
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "turning rig: 9 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimate = &record["estimates"][0];
    assert_eq!(
        (estimate["law"]["name"].as_str(), estimate["clusters"]["by"].as_str()),
        (Some("fluid_torque"), Some("run"))
    );
    for (name, truth) in [("lambda_1", 6.9096e-3), ("lambda_2", 2.0901e-3), ("lambda_3", 3.6777e-3)] {
        let c = &estimate["coefficients"][name];
        let (low, high) = (c["interval_95"][0].as_f64().unwrap(), c["interval_95"][1].as_f64().unwrap());
        assert!(low < truth && truth < high, "{name}: {c}");
        // χ² of eight clusters: 0.5 to 1.5 of the scatter.
        let ratio = 0.5 * (high - low) / of(name, "half_width_95");
        assert!((0.45..1.6).contains(&ratio), "{name}: {ratio}");
    }
    // What is derived by strips: C_A of the truth, and a C_M that has a unit.
    let derived = &estimate["derived"];
    let c_a = &derived["C_A"];
    let (low, high) = (c_a["interval_95"][0].as_f64().unwrap(), c_a["interval_95"][1].as_f64().unwrap());
    assert!(low < 1.277 && 1.277 < high, "{c_a}");
    assert_eq!(
        (derived["C_M_as_printed"]["unit"].as_str(), derived["C_D_from_lambda_3"]["unit"].as_str()),
        (Some("1/m^2"), Some("1"))
    );
    assert_eq!(derived["C_f_from_lambda_2"]["formula"], "6*lambda_2/(density*pi*(a+b)*l^3*v_ref)");
    let findings = record["findings"].as_array().unwrap();
    let law = findings.iter().find(|f| f["code"] == "law-behind-lambda-3").unwrap();
    assert!(
        law["message"].as_str().unwrap().starts_with("one friction coefficient cannot explain lambda_2 and lambda_3"),
        "{law}"
    );
    let keys: Vec<&String> = estimate["errors"].as_object().unwrap().keys().collect();
    for name in ["inertia", "gain of the torque", "delay"] {
        assert!(keys.iter().any(|key| key.contains(name)), "{name}: {keys:?}");
    }
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    for words in [
        "Runs and fit",
        "The law behind λ₃",
        "Correlation of the coefficients",
        "Standard uncertainties, by error.",
        "Power density of measured less fitted torque",
        "that formula gives kg m⁴",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn what_the_campaign_does_not_declare_is_asked_for() {
    for (from, to, expected) in [
        ("axis    = \"upright\"", "# axis", "state how the axis of rotation lies"),
        ("axis    = \"upright\"", "axis = \"stream\"", "declare K"),
        ("axis    = \"upright\"", "restoring = \"2 mN m\"\naxis = \"upright\"", "gravity restores nothing"),
        ("inertia = {", "# inertia = {", "neither declared nor measured"),
        (
            "frequency = [\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]",
            "frequency = [\"1.0 1/s\"]",
            "neither periods nor radians",
        ),
        (
            "quantity = \"torque\"\nstandard = \"0.2 %\"",
            "quantity = \"force\"\nstandard = \"0.2 %\"",
            "is not a quantity of a rotation",
        ),
        (
            "quantity = \"torque\"\nstandard = \"0.2 %\"",
            "quantity = \"torque\"\nstandard = \"1 mN m\"",
            "write it as a percentage",
        ),
        ("model = \"rotation\"", "model = \"f2\"", "model = \"rotation\""),
        ("lambda_2 = \"2.0901e-3 N m s\"\n", "", "lambda_2 is missing"),
        (
            "lambda_2 = \"2.0901e-3 N m s\"\n",
            "lambda_2 = \"2.0901e-3 N m s\"\nC_A = 1.277\n",
            "campaign.toml:49:1: model rotation has no coefficient C_A; known: lambda_1, ",
        ),
        (
            "lambda_1 = \"6.9096e-3 kg m^2\"",
            "lambda_1 = \"8 kg\"",
            "campaign.toml:47:1: lambda_1 of rotation is in kg*m^2, and is stated in kg: write it in its unit",
        ),
        // Gravity restores nothing about an upright axis.
        (
            "lambda_2 = \"2.0901e-3 N m s\"\n",
            "lambda_2 = \"2.0901e-3 N m s\"\nrestoring = \"2 mN m\"\n",
            "campaign.toml:49:1: model rotation has no coefficient restoring",
        ),
        ("periods   = 7", "periods   = 4", "whole cycles"),
        ("method = \"rotation\"", "method = \"steady\"", "write method = \"rotation\""),
    ] {
        let folder = example(EXAMPLE, &[(from, to)]);
        let text = refused(folder.path(), &["plan", "campaign.toml"]);
        assert!(text.contains(expected), "{from}: {text}");
    }
}

#[test]
fn nothing_about_a_run_is_taken_for_granted() {
    let small = [
        ("[\"30 deg\", \"45 deg\", \"60 deg\"]", "\"45 deg\""),
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"80 deg/s\""),
        ("periods   = 7", "periods   = 7\nrepeats   = 5"),
    ];
    let folder = simulated(EXAMPLE, &small);
    let sidecar = folder.path().join("runs/002.toml");
    let identify = || refused(folder.path(), &["identify", "campaign.toml"]);
    replace_in(&sidecar, "unit = \"N m\", sign = 1, ", "unit = \"N m\", ");
    let text = identify();
    assert!(
        text.contains("002.toml") && text.contains("torque states no sign") && text.contains("the rig on the body"),
        "{text}"
    );
    replace_in(&sidecar, "unit = \"N m\", ", "unit = \"N m\", sign = 1, ");
    replace_in(&sidecar, "name = \"torque\"", "name = \"moment\"");
    let text = identify();
    assert!(text.contains("a run needs the channel torque"), "{text}");
    replace_in(&sidecar, "name = \"moment\"", "name = \"torque\"");
    replace_in(&sidecar, "[columns]", "[conditions]\nflow = \"0.2 m/s\"\n\n[columns]");
    let text = identify();
    assert!(text.contains("in a stream of 0.2 m/s"), "{text}");
    replace_in(
        &sidecar,
        "[conditions]\nflow = \"0.2 m/s\"\n\n[columns]",
        "[mounted]\nconfiguration = \"tail\"\n\n[columns]",
    );
    let text = identify();
    assert!(text.contains("the coefficients are of one body"), "{text}");
    replace_in(&sidecar, "[mounted]\nconfiguration = \"tail\"\n\n[columns]", "[columns]");
    let output = froude(folder.path(), &["inspect", "runs"]);
    let text = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("rotation, role test") && text.contains("method = \"rotation\" in a [[source]]"), "{text}");
    // One amplitude and one frequency: marked, not refused.
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let found = record["findings"].as_array().unwrap().iter().any(|f| f["code"] == "not-told-apart");
    assert!(found, "{record}");
    let output = froude(folder.path(), &["plan", "campaign.toml"]);
    let words = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(words.contains("lambda_2 and lambda_3 are separated by the third harmonic alone"), "{words}");
    // A cell at the end of its range.
    let log = folder.path().join("runs/003.csv");
    let whole = std::fs::read_to_string(&log).unwrap();
    let rows: Vec<Vec<f64>> =
        whole.lines().skip(1).map(|l| l.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    // Well below the peaks of the steady swing: the largest torque of all is that of the start.
    let steady = rows.iter().filter(|r| r[0] > 8.0);
    let (low, high) = steady.fold((f64::MAX, f64::MIN), |(low, high), r| (low.min(r[2]), high.max(r[2])));
    let limit = low + 0.65 * (high - low);
    let clipped: String = rows.iter().map(|r| format!("{},{},{}\n", r[0], r[1], r[2].min(limit))).collect();
    std::fs::write(&log, format!("time,theta,torque\n{clipped}")).unwrap();
    let text = identify();
    assert!(text.contains("\"003\"") && text.contains("torque stays at") && text.contains("it is clipped"), "{text}");
}
