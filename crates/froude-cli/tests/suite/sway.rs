//! Pure sway at the verbs: plan, simulate and identify of the example campaign, and what is refused.

use crate::tank::{example, froude, json, refused, replace_in, simulated};

const EXAMPLE: &str = "sway";

#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = example(EXAMPLE, &[]);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    let expected = plan["sources"][0]["expected"].as_array().unwrap();
    assert_eq!(expected.len(), 5);
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "planar motion mechanism: 5 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let estimate = &record["estimates"][0];
    assert_eq!((estimate["law"]["name"].as_str(), estimate["clusters"]["by"].as_str()), (Some("sway"), Some("run")));
    assert_eq!(estimate["law"]["outputs"]["m_z"]["formula"], "N_v_dot*v_y_dot + N_v*v_y");
    for (name, truth) in [("Y_v_dot", -38.0), ("Y_v", -42.0), ("N_v_dot", 1.5), ("N_v", -35.0)] {
        let c = &estimate["coefficients"][name];
        let (low, high) = (c["interval_95"][0].as_f64().unwrap(), c["interval_95"][1].as_f64().unwrap());
        assert!(low < truth && truth < high, "{name}: {c}");
        let planned = expected.iter().find(|e| e["coefficient"] == name).unwrap()["half_width_95"].as_f64().unwrap();
        // √(χ²/4), 99 % of it, where the interval is of scatter alone.
        assert!((0.227..1.928).contains(&(0.5 * (high - low) / planned)), "{name}: {c} {planned}");
    }
    // Y_v over ½ρL²U = 1620 N s/m.
    let prime = estimate["derived"]["Y_v_prime"]["value"].as_f64().unwrap();
    assert!((prime - estimate["coefficients"]["Y_v"]["value"].as_f64().unwrap() / 1620.0).abs() < 1e-9, "{prime}");
    let result = std::fs::read_to_string(folder.path().join("campaign-results/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&result).unwrap();
    let by_run = result["sections"].as_array().unwrap().iter().find_map(|s| s["by_run"].as_array()).unwrap();
    assert_eq!(by_run.len(), 5);
    for row in by_run {
        // The slowest run: 0.1 N correlated over 0.5 s is 0.02 N of the amplitude in 50 s, 0.63 kg of its 0.0316 m/s². The gain of 0.3 % of 84 kg is 0.25 kg: four of 0.68 kg.
        assert!((row["Y_v_dot"].as_f64().unwrap() + 38.0).abs() < 2.7, "{row}");
    }
}

#[test]
fn a_plan_without_noise_says_so() {
    let folder = example(EXAMPLE, &[("noise       = \"0.05 N m\"\n", "")]);
    let output = froude(folder.path(), &["plan", "campaign.toml"]);
    let words = String::from_utf8_lossy(&output.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("Mind: no noise of m_z is declared"), "{words}");
}

#[test]
fn what_cannot_be_used_is_refused_with_its_place() {
    for (from, to, expected) in [
        ("[source.sway]", "[source.sweay]", "`sweay` is not called as the method is, \"sway\": name both alike"),
        (
            "method = \"sway\"\n",
            "",
            "is neither a key of a source nor one of its methods; write method = \"sway\", or delete the section",
        ),
        ("mass   = {", "# mass = {", "[source.sway] has no `mass`; write mass = "),
        (
            "speed     = \"1 m/s\"",
            "speed = [\"1 m/s\", \"2 m/s\"]",
            "give each speed a folder and a [[source]] of its own",
        ),
        ("\"-42 N s/m\"", "\"-42 N\"", "Y_v of sway is in N*s/m, and is stated in N: write it in its unit"),
        (
            "quantity = \"f_y\"\nstandard = \"0.3 %\"",
            "quantity = \"f_x\"\nstandard = \"0.3 %\"",
            "is not a quantity of a pure sway, which has sway, f_y, m_z, density",
        ),
        ("model = \"sway\"", "model = \"f4\"", "a pure sway has one law: write model = \"sway\""),
    ] {
        let folder = example(EXAMPLE, &[(from, to)]);
        let text = refused(folder.path(), &["plan", "campaign.toml"]);
        assert!(text.contains(expected) && text.contains("campaign.toml"), "{from}: {text}");
    }
    let folder = simulated(EXAMPLE, &[]);
    replace_in(&folder.path().join("runs/002.toml"), "speed = \"1 m/s\"", "flow = \"1 m/s\"");
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("002.csv") && text.contains("[conditions] flow is not known here"), "{text}");
    replace_in(&folder.path().join("runs/002.toml"), "flow = \"1 m/s\"", "speed = \"1 m/s\"");
    // One delay is fitted for both loads: they may be late together, but not each for itself.
    for run in 1..=5 {
        let sidecar = folder.path().join(format!("runs/{run:03}.toml"));
        replace_in(
            &sidecar,
            "sign = 1, frame = \"body\", clock = \"log\" }      #",
            "sign = 1, frame = \"body\", clock = \"daq\" }      #",
        );
        let text = std::fs::read_to_string(&sidecar).unwrap();
        let clock = "\n[clocks.daq]\noffset = \"0 ms\"\nskew = \"0 ms/s\"\nstandard = \"5 ms\"\nfound = \"by hand\"\n";
        std::fs::write(&sidecar, text + clock).unwrap();
    }
    let text = refused(folder.path(), &["identify", "campaign.toml"]);
    assert!(text.contains("the times of f_y and m_z are known relative to each other only to 5.0 ms"), "{text}");
    for run in 1..=5 {
        let sidecar = folder.path().join(format!("runs/{run:03}.toml"));
        replace_in(
            &sidecar,
            "sign = 1, frame = \"body\", clock = \"log\" }        #",
            "sign = 1, frame = \"body\", clock = \"daq\" }        #",
        );
    }
    json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
}
