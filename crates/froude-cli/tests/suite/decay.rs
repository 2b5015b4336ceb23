//! Free decay at the verb: a folder of releases from the twin, a campaign, one record.

use crate::bench;
use std::fmt::Write as _;
use std::path::Path;

use crate::bench::{findings_of, json, refusal, text};
use froude::rig::decay::{DecayRig, DecaySensor, Release};
use serde_json::Value;

/// A heaving body on springs.
const HEAVE: DecayRig = DecayRig {
    inertia: 12.0,
    added: 8.0,
    linear: 4.0,
    quadratic: 40.0,
    stiffness: 180.0,
    is_pendulum: false,
    coulomb: 0.0,
    rest: 0.31,
};

const DECLARED: &str = "[source.decay]\naxis = \"heave\"\ninertia = { value = \"12 kg\", standard = \"0.5 %\" }\nstiffness = { value = \
                        \"180 N/m\", standard = \"0.3 %\" }\n";

/// Releases as logs in a folder; what heads the position.
fn releases(folder: &Path, rig: DecayRig, n: u64, head: &str) {
    std::fs::create_dir_all(folder).unwrap();
    let sensor = DecaySensor { rate_hz: 50.0, noise: 0.2e-3, correlation_s: None, step: 0.1e-3, drift_per_s: 0.0 };
    for seed in 1..=n {
        let release = Release { displacement: 0.1 + 0.005 * seed as f64, held_s: 0.5, free_s: 14.0 };
        let trace = rig.release(sensor, release, seed);
        let mut out = format!("time [s],{head}\n");
        for (t, q) in trace.time_s.iter().zip(&trace.position) {
            writeln!(out, "{t},{q}").unwrap();
        }
        std::fs::write(folder.join(format!("release-{seed}.csv")), out).unwrap();
    }
}

fn campaign(folder: &Path, method: &str, declared: &str) -> std::path::PathBuf {
    let path = folder.join("decay.toml");
    let source = "[[source]]\nname = \"heave\"\nkind = \"tank\"\nruns = \"releases\"\n";
    let text = format!(
        "schema = 1\nname = \"springs\"\n[fluid]\ndensity = \"998 kg/m^3\"\n{source}method = {method}\n{declared}"
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Both methods hold the twin's truth in intervals that are worth something, and leave one record and one page like every other source.
#[test]
fn releases_of_a_body_on_springs_give_its_added_mass_and_damping() {
    let folder = tempfile::tempdir().unwrap();
    releases(&folder.path().join("releases"), HEAVE, 5, "position [m]");
    let campaign = campaign(folder.path(), "[\"decay_envelope\", \"decay_output_error\"]", DECLARED);
    let out = json(&["identify", text(&campaign), "--json"]);
    let estimates = out["estimates"].as_array().unwrap();
    let ids: Vec<&str> = estimates.iter().map(|e| e["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["heave/decay_envelope", "heave/decay_output_error"]);
    for estimate in estimates {
        // Five releases and the declared springs: a twentieth of each coefficient is far more than their intervals should need.
        for (name, truth) in [("A33", 8.0), ("D_z_I", 4.0), ("D_z_II", 40.0)] {
            let c = &estimate["coefficients"][name];
            let [low, high] = [0, 1].map(|k| number(&c["interval_95"][k]));
            let half = 0.5 * (high - low);
            assert!(low - half < truth && truth < high + half && half < 0.05 * truth, "{name}: {c}");
        }
        assert_eq!(estimate["law"]["outputs"]["f_z"]["formula"], "-A33*v_z_dot - D_z_I*v_z - D_z_II*v_z*abs(v_z)");
        assert_eq!(estimate["data"].as_array().unwrap().len(), 5);
        assert_eq!(estimate["clusters"], serde_json::json!({ "by": "run", "n": 5 }));
        let errors: Vec<&str> =
            estimate["errors"].as_object().unwrap().values().map(|e| e["name"].as_str().unwrap()).collect();
        assert_eq!(errors, ["dry inertia", "stiffness"]);
    }
    assert_eq!(estimates[1]["recommended"], true);
    let page = std::fs::read_to_string(folder.path().join("decay-results/report.html")).unwrap();
    assert!(page.contains("heave, decay_output_error") && page.contains("A33"));
    assert!(page.contains("Releases") && page.contains("and the fitted motion where it was used"), "its own section");
    let mut tables = std::fs::read_dir(folder.path().join("decay-results")).unwrap().map(|e| e.unwrap().path());
    let of_envelope = tables.find(|p| text(p).ends_with("envelope.csv")).unwrap();
    let rows = std::fs::read_to_string(of_envelope).unwrap();
    assert!(rows.lines().next().unwrap().contains("v_z [m/s]") && rows.lines().count() > 30, "{rows}");
    // Two readings of the same releases are no evidence for each other.
    let record = folder.path().join("decay-results/estimate.json");
    let compared = json(&["compare", text(&record), text(&record), "--json"]);
    assert!(
        compared["comparison"]["coefficients"].as_array().unwrap().iter().all(|row| row["e_n"].is_null()),
        "same data"
    );
    let inspected = json(&["inspect", text(&record), "--json"]);
    assert!(inspected.to_string().contains("heave/decay_output_error"), "{inspected}");
}

/// A folder of releases is listed, one line a log.
#[test]
fn a_folder_of_releases_is_inspected() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("releases");
    releases(&runs, HEAVE, 2, "position [m]");
    std::fs::write(runs.join("torn.csv"), "time [s],position [m]\n0,0.1\n").unwrap();
    let inside = json(&["inspect", text(&runs), "--json"]);
    assert_eq!(inside["kind"], "logs");
    let facts = inside["facts"].as_array().unwrap();
    let of = |name: &str| facts.iter().find(|f| f["name"] == name).unwrap()["value"].as_str().unwrap().to_owned();
    assert_eq!(of("release-2.csv"), "725 samples at 50.0 Hz, 14.480 s: y/position [m]");
    assert!(findings_of(&inside, "run-unreadable")[0].1.contains("torn.csv:2"), "{inside}");
    // The drag of a carriage is not read from them; what reads them is said.
    let said = refusal(&["carriage", "drag", text(&runs)]);
    assert!(
        said.contains("logs there are of other programs (a table of steady runs is what froude identify FILE reads")
            && said.contains("method = \"decay\""),
        "{said}"
    );
}

/// A wrong declaration shows in A alone: C 2 % too large is 2 % of M + A.
#[test]
fn the_springs_are_the_scale_of_everything() {
    let folder = tempfile::tempdir().unwrap();
    releases(&folder.path().join("releases"), HEAVE, 3, "position [m]");
    let of = |declared: &str| {
        let out = json(&["identify", text(&campaign(folder.path(), "\"decay_output_error\"", declared)), "--json"]);
        ["A33", "D_z_I", "D_z_II"].map(|name| number(&out["estimates"][0]["coefficients"][name]["value"]))
    };
    let (own, stiffer) = (of(DECLARED), of(&DECLARED.replace("180 N/m", "183.6 N/m")));
    assert!(((12.0 + stiffer[0]) / (12.0 + own[0]) - 1.02).abs() < 1e-6, "{own:?} {stiffer:?}");
    assert!((1..3).all(|j| (stiffer[j] / own[j] - 1.02).abs() < 1e-6), "{own:?} {stiffer:?}");
}

/// Friction in the guides is said, and an angle is read for a rotation.
#[test]
fn friction_is_said_and_a_rotation_reads_an_angle() {
    let folder = tempfile::tempdir().unwrap();
    releases(&folder.path().join("releases"), DecayRig { coulomb: 0.4, ..HEAVE }, 5, "position [m]");
    let out = json(&["identify", text(&campaign(folder.path(), "\"decay_output_error\"", DECLARED)), "--json"]);
    assert!(!findings_of(&out, "coulomb-friction").is_empty(), "{}", out["findings"]);

    let roll = DecayRig { inertia: 0.4, added: 0.1, linear: 0.02, quadratic: 0.1, stiffness: 12.0, rest: 0.0, ..HEAVE };
    let folder = tempfile::tempdir().unwrap();
    let sensor_in_degrees = "angle [rad]";
    releases(&folder.path().join("releases"), roll, 5, sensor_in_degrees);
    let declared = "[source.decay]\naxis = \"roll\"\ninertia = { value = \"0.4 kg m^2\", standard = \"0.5 %\" }\nstiffness = { value = \"12 N m\", \
                    standard = \"0.3 %\" }\n";
    let out = json(&["identify", text(&campaign(folder.path(), "\"decay_output_error\"", declared)), "--json"]);
    let a = &out["estimates"][0]["coefficients"]["A44"];
    assert!((number(&a["value"]) - 0.1).abs() < 0.01 && a["unit"] == "kg*m^2", "{a}");
}

/// What is not declared, not there or not a method of these runs is named with its place.
#[test]
fn what_is_missing_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("releases");
    let told = |method: &str, declared: &str| refusal(&["identify", text(&campaign(folder.path(), method, declared))]);
    std::fs::create_dir(&runs).unwrap();
    assert!(
        told("\"decay_envelope\"", DECLARED)
            .contains("no runs: put one log per run there, as CSV, Parquet or MCAP with `time [s]` and `position [m]`")
    );
    releases(&runs, HEAVE, 3, "force [N]");
    let said = told("\"decay_envelope\"", DECLARED);
    assert!(said.contains("release-1.csv: a release needs `position [m]`; it has force"), "{said}");
    let said = told("\"decay_envelope\"", "");
    assert!(said.contains("decay.toml:8") && said.contains("write [source.decay]"), "{said}");
    let said = told("\"mcd\"", DECLARED);
    assert!(said.contains("no method of the source is one of free decay"), "{said}");
    // Logs of another method than the one asked for: what they are, and what reads them.
    let said = told("\"mcd\"", "");
    let instead = "3 logs there are of other programs (a table of steady runs is what froude identify FILE reads, a servo's log what froude carriage \
                   identify FILE does; wet and dry tows need a sidecar, which froude new carriage-logs begins), and runs of the method tow are read here: a \
                   [[source]] with method = \"decay\" reads releases; else name a folder with runs of tow";
    assert!(said.contains(&format!("{}: {instead}", runs.display())), "{said}");
    let tows = Path::new(env!("CARGO_MANIFEST_DIR")).join("../froude-records/tests/golden/runs-1");
    let away = folder.path().join("away");
    std::fs::rename(&runs, &away).unwrap();
    bench::copy(&tows, &runs);
    let said = told("\"decay_envelope\"", DECLARED);
    let instead = "3 runs there are of the method tow (role calibration, jog, wet), and runs of the method free_decay are read here: a \
                   [[source]] with method = [\"fsm\", \"mcd\", \"mbdp_constant\", \"mbdp_mapped\", \"mbdp_flexible\", \
                   \"servo_symmetric\", \"servo_asymmetric\", \"servo_over_position\", \"servo_two_mass\", \"calibration\", \"tuning\", \
                   \"resonance\"] reads those; else name \
                   a folder with runs of free_decay";
    assert!(said.contains(&format!("{}: {instead}", runs.display())), "{said}");
    std::fs::remove_dir_all(&runs).unwrap();
    std::fs::rename(&away, &runs).unwrap();
    let said = told("[\"decay_envelope\", \"mcd\"]", DECLARED);
    assert!(said.contains("read runs of two kinds; give each a [[source]] of its own"), "{said}");
    let said = told("\"decay_envelop\"", DECLARED);
    assert!(said.contains("method \"decay_envelop\" is not known; did you mean `decay_envelope`?"), "{said}");
    let said = told("\"decay_envelope\"", &DECLARED.replace("12 kg", "12 N"));
    assert!(said.contains("is \"12 N\": expected a mass (kg), found a force (N)"), "{said}");
}

/// A start that is not free, methods that disagree, and springs that were not weighed: each is reported, and any column of lengths is the position.
#[test]
fn what_is_declared_wrongly_is_said() {
    let folder = tempfile::tempdir().unwrap();
    releases(&folder.path().join("releases"), HEAVE, 5, "height [m]");
    let both = "[\"decay_envelope\", \"decay_output_error\"]";
    let of = |declared: &str| json(&["identify", text(&campaign(folder.path(), both, declared)), "--json"]);
    let sound = of(DECLARED);
    assert_eq!(sound["findings"].as_array().unwrap().len(), 0, "{}", sound["findings"]);
    // The body is held to 0.5 s: 0.42 s is too early by little, 0.1 s by much.
    let early = of(&format!("{DECLARED}free_from = \"0.42 s\"\n"));
    assert!(!findings_of(&early, "start-not-free").is_empty(), "{}", early["findings"]);
    let earlier = of(&format!("{DECLARED}free_from = \"0.1 s\"\n"));
    assert!(!findings_of(&earlier, "methods-disagree").is_empty(), "{}", earlier["findings"]);
    let exact = of(&DECLARED.replace(", standard = \"0.3 %\"", ""));
    let said = findings_of(&exact, "declared-as-exact");
    assert!(said.len() == 1 && said[0].1.contains("the stiffness is declared without"), "{said:?}");
    let page = std::fs::read_to_string(folder.path().join("decay-results/report.html")).unwrap();
    assert!(page.contains("jackknife over 5 runs") && page.contains("dry inertia"), "the budget");
}

/// The example of the snake robot in a folder of its own, with some text replaced.
fn mamba(folder: &Path, replaced: &[(&str, &str)]) -> std::path::PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-decay/campaign.toml");
    let mut campaign = std::fs::read_to_string(example).unwrap();
    for (from, to) in replaced {
        assert!(campaign.contains(from), "{from}");
        campaign = campaign.replace(from, to);
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, campaign).unwrap();
    path
}

/// Plan, twin and fit of one campaign: four peaks, and intervals as wide as was forecast.
#[test]
fn a_campaign_of_releases_is_planned_simulated_and_identified() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = mamba(folder.path(), &[]);
    let plan = json(&["plan", text(&campaign), "--json"]);
    assert_eq!(
        (plan["sources"][0]["runs"].as_u64(), plan["sources"][0]["duration_s"].as_f64()),
        (Some(5), Some(105.0))
    );
    let output = bench::froude(&["plan", text(&campaign)]);
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(shown.contains("5 releases have fewer peaks than the 5 that decay_envelope needs"), "{shown}");
    let output = bench::froude(&["simulate", text(&campaign)]);
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("free decay: 5 runs in "), "{output:?}");
    let record = json(&["identify", text(&campaign), "--json"]);
    let estimate = &record["estimates"][0];
    for expected in plan["sources"][0]["expected"].as_array().unwrap() {
        let name = expected["coefficient"].as_str().unwrap();
        let [low, high] = [0, 1].map(|k| number(&estimate["coefficients"][name]["interval_95"][k]));
        let (truth, half) = (number(&expected["value"]), 0.5 * (high - low));
        // One campaign: an interval of 95 % may miss by a little.
        assert!((truth - 0.5 * (low + high)).abs() < 1.5 * half, "{name}: {truth} not near [{low}, {high}]");
        // The scatter of five releases, with four degrees of freedom: between 0.35 and 1.7 of its mean in 99 of 100.
        let ratio = half / number(&expected["half_width_95"]);
        assert!((0.3..2.0).contains(&ratio), "{name}: {ratio}");
    }
    let errors: Vec<&str> =
        estimate["errors"].as_object().unwrap().values().map(|e| e["name"].as_str().unwrap()).collect();
    assert_eq!(errors, ["buoyancy", "dry inertia", "radius"]);
    let doubts = record["findings"].as_array().unwrap();
    assert!(doubts.is_empty(), "{doubts:?}");
}

/// Too few peaks, a plan of the wrong kind, a truth that is none: each with what was found and what to do.
#[test]
fn releases_that_show_too_little_are_refused_before_and_after() {
    let folder = tempfile::tempdir().unwrap();
    let envelope = ("\"decay_output_error\" ", "\"decay_envelope\" ");
    let campaign = mamba(folder.path(), &[envelope]);
    bench::froude(&["simulate", text(&campaign)]);
    let said = refusal(&["identify", text(&campaign)]);
    assert!(
        said.contains(
            "decay_envelope: run \"001\": 4 peaks further than 6.981e-3 rad from rest (8 times the noise of a sample), and decay_envelope needs 5; release \
             from further out, record longer, skip fewer, or use decay_output_error, which needs 2"
        ),
        "{said}"
    );
    let ten_times = ("\"0.05 deg\"", "\"0.5 deg\"");
    let said = refusal(&["plan", text(&mamba(folder.path(), &[ten_times]))]);
    assert!(
        said.contains(
            "1 peak further than 6.981e-2 rad from rest (8 times the noise of a sample), and decay_output_error needs 2"
        ),
        "{said}"
    );
    let said =
        refusal(&["plan", text(&mamba(folder.path(), &[("angle    = \"30 deg\"", "displacement = \"0.1 m\"")]))]);
    assert!(said.contains("[[source.plan]] states displacement, but the axis is roll: write angle"), "{said}");
    let said = refusal(&[
        "plan",
        text(&mamba(folder.path(), &[("A44     = \"0.3773 kg m^2\"", "A55     = \"0.3773 kg m^2\"")])),
    ]);
    assert!(said.contains("A44 is missing; the truth needs A44, D_rx_I, D_rx_II"), "{said}");
    let said = refusal(&["simulate", text(&mamba(folder.path(), &[("\"added_mass_linear_quadratic\"", "\"f4\"")]))]);
    assert!(said.contains("the truth of a free decay is model = \"added_mass_linear_quadratic\""), "{said}");
    let twice = ("radius    = {", "stiffness = \"1.4 N m\"\nradius    = {");
    let said = refusal(&["plan", text(&mamba(folder.path(), &[twice]))]);
    assert!(said.contains("stands beside buoyancy: what drives the body back is one or the other"), "{said}");
}

/// Two bodies in one folder have two inertias.
#[test]
fn releases_of_two_bodies_need_two_sources() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = mamba(folder.path(), &[("repeats  = 5", "repeats  = 2")]);
    bench::froude(&["simulate", text(&campaign)]);
    let second = folder.path().join("releases/002.toml");
    let sidecar = std::fs::read_to_string(&second).unwrap().replace("H1LT", "H2LT");
    std::fs::write(&second, sidecar).unwrap();
    let said = refusal(&["identify", text(&campaign)]);
    assert!(
        said.contains(
            "002.csv: is of the configuration \"H2LT\" where 001 is of \"H1LT\"; the coefficients are of one body"
        ),
        "{said}"
    );
}

/// One log in milliseconds under a header in seconds took the added mass a millionfold away.
#[test]
fn a_log_in_milliseconds_among_others_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("releases");
    releases(&runs, HEAVE, 4, "position [m]");
    let path = runs.join("release-2.csv");
    let rows = std::fs::read_to_string(&path).unwrap();
    let in_ms = rows.lines().map(|line| match line.split_once(',') {
        Some((t, rest)) if t.parse::<f64>().is_ok() => format!("{},{rest}\n", 1000.0 * t.parse::<f64>().unwrap()),
        _ => format!("{line}\n"),
    });
    std::fs::write(&path, in_ms.collect::<String>()).unwrap();
    let said = refusal(&["identify", text(&campaign(folder.path(), "\"decay_envelope\"", DECLARED))]);
    assert!(said.contains("release-2.csv") && said.contains("the step of its times is 20.0 s"), "{said}");
}

/// A roll decay of which the angle alone is known: θ̈ = −ω²θ − 2ζω θ̇ − 0.15 θ̇|θ̇|, ω 2.244 rad/s, ζ 0.0539.
const ROLL: DecayRig = DecayRig {
    inertia: 1.0,
    added: 0.0,
    linear: 2.0 * 0.0539 * 2.244,
    quadratic: 0.15,
    stiffness: 2.244 * 2.244,
    is_pendulum: false,
    coulomb: 0.0,
    rest: 0.0,
};

/// Three releases in degrees, and a campaign that states the axis alone; every `lost`-th sample is not there, and stamps have so many places.
fn filmed(folder: &Path, rate_hz: f64, lost: usize, places: usize, per_rad: f64) -> std::path::PathBuf {
    let runs = folder.join("releases");
    std::fs::create_dir_all(&runs).unwrap();
    let noise = 0.02_f64.to_radians();
    let sensor = DecaySensor { rate_hz, noise, correlation_s: None, step: 0.0, drift_per_s: 0.0 };
    for (seed, deg) in [12.0_f64, 10.0, 8.0].into_iter().enumerate() {
        let release = Release { displacement: deg.to_radians(), held_s: 0.5, free_s: 30.0 };
        let trace = ROLL.release(sensor, release, 7 + seed as u64);
        let mut out = "time [s],angle [deg]\n".to_owned();
        for (i, (t, q)) in trace.time_s.iter().zip(&trace.position).enumerate() {
            if lost == 0 || i * 7 % lost != 3 {
                writeln!(out, "{t:.places$},{:.5}", q * per_rad).unwrap();
            }
        }
        std::fs::write(runs.join(format!("run_{seed}.csv")), out).unwrap();
    }
    campaign(folder, "\"decay\"", "[source.decay]\naxis = \"roll\"\n")
}

/// That the interval of a coefficient or of a derived number holds the truth, and is at most `widest` of it on each side.
fn holds(estimate: &Value, name: &str, truth: f64, widest: f64) {
    let found = [&estimate["coefficients"][name], &estimate["derived"][name]].into_iter().find(|x| !x.is_null());
    let found = found.unwrap_or_else(|| panic!("no {name} in {estimate}"));
    let [low, high] = [0, 1].map(|k| number(&found["interval_95"][k]));
    assert!(low <= truth && truth <= high, "{name}: [{low}, {high}] without {truth}");
    assert!(high - low < 2.0 * widest * truth, "{name}: [{low}, {high}] is wide");
}

/// Angle and time are enough: no inertia is asked for, and lost frames are reported.
#[test]
fn an_angle_alone_gives_period_damping_ratio_and_decrement() {
    for (rate_hz, lost, places) in [(20.0, 0, 3), (30.0, 33, 2)] {
        let folder = tempfile::tempdir().unwrap();
        let campaign = filmed(folder.path(), rate_hz, lost, places, 1.0_f64.to_degrees());
        let out = json(&["identify", text(&campaign), "--json"]);
        let estimate = &out["estimates"][1];
        assert!(estimate["recommended"] == true && estimate["method"]["name"] == "decay_output_error", "{estimate}");
        holds(estimate, "omega_rx", 2.244, 0.01);
        holds(estimate, "d_rx_I", 2.0 * 0.0539 * 2.244, 0.05);
        holds(estimate, "d_rx_II", 0.15, 0.4);
        holds(estimate, "zeta", 0.0539, 0.05);
        holds(estimate, "damped_period", 2.804, 0.01);
        holds(estimate, "log_decrement", 0.339_2, 0.05);
        assert!(
            estimate["coefficients"].get("A44").is_none()
                && estimate["errors"].as_object().is_none_or(serde_json::Map::is_empty)
        );
        assert_eq!(lost > 0, !findings_of(&out, "uneven-time-steps").is_empty(), "{}", out["findings"]);
        let result = std::fs::read_to_string(folder.path().join("decay-results/result.json")).unwrap();
        assert!(result.contains("\"decrements\""), "{result}");
        let shown = String::from_utf8(bench::froude(&["identify", text(&campaign)]).stdout).unwrap();
        assert!(shown.contains("zeta") && shown.contains("damped_period") && shown.contains("derived"), "{shown}");
    }
}

/// A wrong unit changes no frequency and no damping ratio: nothing else can find it, so that unusual sizes are asked about.
#[test]
fn releases_in_another_unit_than_their_header_says_are_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    // Radians under `[deg]`.
    let campaign_of_roll = filmed(folder.path(), 20.0, 0, 3, 1.0);
    let said = refusal(&["identify", text(&campaign_of_roll)]);
    assert!(
        said.contains("run_0.csv: the largest swing is 0.19")
            && said.contains(" deg if these are radians under a header in deg). If the unit is another one, ")
            && said.contains("write amplitude = \"0.19")
            && said.contains("`angle [rad]` or `angle [deg]` as its header"),
        "{said}"
    );
    let stated =
        |line: &str| campaign(folder.path(), "\"decay\"", &format!("[source.decay]\naxis = \"roll\"\n{line}\n"));
    json(&["identify", text(&stated("amplitude = \"0.2 deg\"")), "--json"]);
    let said = refusal(&["identify", text(&stated("amplitude = \"10 deg\""))]);
    assert!(said.contains("amplitude = \"10 deg\" is declared, and the logs swing by 0.19"), "{said}");
    let said = refusal(&["identify", text(&stated("amplitude = \"0.2 deg\"\nperiod = \"28 s\""))]);
    assert!(said.contains("period = \"28.0000 s\" is declared, and the logs swing with 2.80"), "{said}");
    // Degrees under `[rad]`, millimetres under `[m]`, numbers of frames under `[s]`.
    let runs = folder.path().join("releases");
    let rewritten = |head: [&str; 2], per: [f64; 2]| {
        std::fs::remove_dir_all(&runs).unwrap();
        let head = format!("{},{}", head[0], head[1]);
        filmed(folder.path(), 20.0, 0, 3, 1.0_f64.to_degrees());
        for path in std::fs::read_dir(&runs).unwrap().map(|entry| entry.unwrap().path()) {
            let text = std::fs::read_to_string(&path).unwrap();
            let mut out = format!("{head}\n");
            for line in text.lines().skip(1) {
                let (t, q) = line.split_once(',').unwrap();
                let [t, q] = [t.parse::<f64>().unwrap() * per[0], q.parse::<f64>().unwrap() * per[1]];
                writeln!(out, "{t:.3},{q}").unwrap();
            }
            std::fs::write(&path, out).unwrap();
        }
    };
    let heave = "[source.decay]\naxis = \"heave\"\n";
    rewritten(["time [s]", "angle [rad]"], [1.0, 1.0]);
    let said = refusal(&["identify", text(&stated(""))]);
    assert!(said.contains("degrees under a header in radians, probably"), "{said}");
    rewritten(["time [s]", "position [m]"], [1.0, 10.0]);
    let said = refusal(&["identify", text(&campaign(folder.path(), "\"decay\"", heave))]);
    assert!(said.contains("times that of gravity") && said.contains("`position [mm]` as its header"), "{said}");
    rewritten(["time [s]", "position [m]"], [20.0, 0.01]);
    let said = refusal(&["identify", text(&campaign(folder.path(), "\"decay\"", heave))]);
    assert!(said.contains("as numbers of frames are") && said.contains("write period = \"55.9"), "{said}");
    // Seconds under a header in milliseconds.
    rewritten(["time [ms]", "position [m]"], [1.0, 0.01]);
    let said = refusal(&["identify", text(&campaign(folder.path(), "\"decay\"", heave))]);
    assert!(said.contains("times are probably in a larger unit than stated: seconds under a header in ms"), "{said}");
}

/// What only one of inertia and stiffness gives, and what needs both.
#[test]
fn inertia_and_stiffness_are_asked_for_where_a_result_needs_them() {
    let folder = tempfile::tempdir().unwrap();
    filmed(folder.path(), 20.0, 0, 3, 1.0_f64.to_degrees());
    let of = |lines: &str| campaign(folder.path(), "\"decay\"", &format!("[source.decay]\naxis = \"roll\"\n{lines}\n"));
    let both = json(&["identify", text(&of("stiffness = { value = \"5.035536 N m\", standard = \"1 %\" }")), "--json"]);
    let estimate = &both["estimates"][1];
    holds(estimate, "moving_inertia", 1.0, 0.03);
    holds(estimate, "D_rx_I", 2.0 * 0.0539 * 2.244, 0.1);
    let said = refusal(&["identify", text(&of("inertia = \"0.4 kg m^2\""))]);
    assert!(
        said.contains("has no `stiffness`") && said.contains("or leave out inertia, for results per moving inertia"),
        "{said}"
    );
    let said = refusal(&["identify", text(&of("buoyancy = \"3 N\"\nradius = \"0.4 m\""))]);
    assert!(said.contains("has no `inertia`"), "{said}");
    let said = refusal(&["plan", text(&of("[[source.plan]]\nangle = \"10 deg\""))]);
    assert!(said.contains("a planned release needs the body and its springs"), "{said}");
}
