use super::setup;
use super::*;
use crate::carriage::plan::{Experiments, Step, plan, tuning};
use crate::carriage::{CarriageCampaign, declared};
use crate::load::TowedBody;

/// The example's campaign with some texts replaced.
fn campaign(changes: &[(&str, &str)]) -> CarriageCampaign {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(path).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    let campaign = froude_records::campaign_file::parse_campaign(std::path::Path::new("c.toml"), &text).unwrap();
    declared(&campaign).unwrap().unwrap()
}

fn told(changes: &[(&str, &str)], assumed_volume_m3: Option<f64>) -> (Vec<Forecast>, Vec<Objection>) {
    let campaign = campaign(changes);
    let asked = campaign.plan.clone().unwrap();
    let start_m = asked.start_m.unwrap_or(0.5 * (4.95 - 0.05 - asked.distance_m));
    let steps = plan(&asked, start_m, 1);
    let tests = tuning(&asked, start_m, &Experiments::default());
    judged(&campaign, &[steps, tests].concat(), assumed_volume_m3)
}

fn judged(
    campaign: &CarriageCampaign,
    steps: &[Step],
    assumed_volume_m3: Option<f64>,
) -> (Vec<Forecast>, Vec<Objection>) {
    let asked = campaign.plan.clone().unwrap();
    let displaced_kg = 998.2 * TowedBody::CYLINDER.displaced_m3;
    let control = setup::control(campaign, 3.0 * displaced_kg).unwrap();
    let expected = Expected {
        drag_n_s2_m2: 20.0,
        wet_mass_kg: 3.0 * displaced_kg,
        dry_mass_kg: displaced_kg,
        efficiency: 0.8,
        assumed_volume_m3,
    };
    let (mut forecasts, mut objections) = (Vec::new(), check_campaign(&asked, &campaign.rig, &control));
    for step in steps {
        if let Step::Run(run) = step {
            let (forecast, against) = check(run, &asked, &control, &expected);
            forecasts.push(forecast);
            objections.extend(against);
        }
    }
    (forecasts, objections)
}

fn objections(changes: &[(&str, &str)]) -> Vec<Objection> {
    told(changes, None).1
}

fn kinds<'a>(objections: &'a [Objection], run: &str) -> Vec<&'a str> {
    objections.iter().filter(|o| o.id.contains(run)).map(|o| o.kind).collect()
}

/// What stands between two texts of a sentence, as a number.
fn between(text: &str, before: &str, after: &str) -> f64 {
    text.split(before).nth(1).unwrap().split(after).next().unwrap().parse().unwrap()
}

#[test]
fn the_example_passes_with_its_experiments() {
    assert_eq!(objections(&[]), []);
}

#[test]
fn excitations_are_held_against_command_peak_and_continuous_current() {
    let amplitude = |to| objections(&[(r#"amplitude = "2 V""#, to)]);
    assert_eq!(kinds(&amplitude(r#"amplitude = "20 V""#), "pulses"), ["command", "current", "heating"]);
    // 9 V are 3.17 A of 3.5 A; 60 % of the time that is 2.45 A root mean square, and 2 A are allowed.
    let warm = amplitude(r#"amplitude = "9 V""#);
    assert_eq!(kinds(&warm, "pulses"), ["heating"]);
    assert_eq!(
        warm[0].text,
        "it heats the motor with 2.45 A root mean square, 2.00 A are allowed continuously: lower the amplitude of \
         [carriage.excitation]"
    );
    let weak = objections(&[(r#"command_limit = "9.5 V""#, r#"command_limit = "0.9 V""#)]);
    for run in ["jog-forward", "jog-backward", "pulses", "relay", "sweep"] {
        assert!(kinds(&weak, run).contains(&"command"), "{run}: {weak:?}");
    }
    // The sine comes on top of the friction below it: 9.4 V alone would be within the range of 9.5 V.
    let example = campaign(&[]);
    let loud = Experiments { sweep_v: 9.4, ..Experiments::default() };
    let steps = tuning(example.plan.as_ref().unwrap(), 1.35, &loud);
    assert_eq!(kinds(&judged(&example, &steps, None).1, "sweep"), ["command", "current", "heating"]);
}

#[test]
fn pulses_that_a_soft_limit_would_end_are_refused_with_where_and_when() {
    let period = |to: &str| objections(&[(r#"period = "1 s""#, to)]);
    assert_eq!(period(r#"period = "2 s""#), []);
    let found = period(r#"period = "6 s""#);
    assert_eq!(kinds(&found, "pulses"), ["travel"]);
    // From 2.45 m at up to 0.6 m/s; without torque the axis with the heaviest body goes on for 1.5 m, to the soft limit at 4.89 m.
    let text = &found[0].text;
    let (end_m, cut_s) = (between(text, "predicted to reach ", " m after"), between(text, " m after ", " s of"));
    assert!((3.2..3.4).contains(&end_m) && (1.4..1.8).contains(&cut_s), "{text}");
    assert!(text.contains("of 20 s, where the controller ends") && text.contains("[carriage.excitation]"), "{text}");
    // Near an end they are cut sooner.
    let near = objections(&[(r#"distance = "2.2 m""#, "start = \"2.3 m\"\ndistance = \"2.2 m\"")]);
    assert!(kinds(&near, "pulses").contains(&"travel"), "{near:?}");
}

#[test]
fn what_the_controller_itself_would_refuse_of_an_excitation_is_refused_here() {
    let long = objections(&[(r#"duration = "20 s""#, r#"duration = "3 h""#)]);
    assert_eq!(kinds(&long, "pulses"), ["controller"]);
}

#[test]
fn a_configuration_that_the_controller_does_not_take_is_reported_with_its_key_and_advice_that_can_be_followed() {
    let key = r#"unhomed_speed_limit = "0.018 m/s""#;
    let found = objections(&[(key, r#"unhomed_speed_limit = "0.3 m/s""#)]);
    assert_eq!((found[0].id.as_str(), found[0].kind), ("[rig.y]", "controller"));
    let text = &found[0].text;
    assert!(
        text.starts_with("unhomed_speed_limit is 0.3 m/s; from a fault at that speed the axis coasts up to"),
        "{text}"
    );
    assert!(text.contains("the low end switch opens 0.050 m before its hard stop"), "{text}");
    let advised = between(text, "Write unhomed_speed_limit = \"", " m/s\" or less");
    let with = |speed: f64| objections(&[(key, &format!("unhomed_speed_limit = \"{speed} m/s\""))]);
    assert_eq!(with(advised), []);
    assert_eq!(with(advised + 0.001).len(), 1);
    let found = objections(&[(r#"shaped_damping = "1.7 %""#, r#"shaped_damping = "0.95 1""#)]);
    assert_eq!(found[0].text, "controller.shaped_damping is 0.95; the controller accepts 0 to 0.9");
}

#[test]
fn a_shaper_and_a_jerk_bound_take_their_time_from_the_steady_part() {
    let fastest = |changes: &[(&str, &str)]| {
        let (forecasts, _) = told(changes, None);
        let f = forecasts.into_iter().find(|f| f.id.contains("wet") && f.id.contains("550mm_s")).unwrap();
        (f.steady_s, f.duration_s)
    };
    // 2.2 m at 0.55 m/s take 4 s; a ramp 0.55/0.6 s; ZVD a damped period of 3.6 Hz.
    let (ramp_s, zvd_s) = (0.55 / 0.6, 1.0 / (3.6 * (1.0 - 0.017_f64.powi(2)).sqrt()));
    let is_near = |(steady, total): (f64, f64), delay: f64, jerk_s: f64| {
        (steady - (4.0 - ramp_s - jerk_s - delay)).abs() < 1e-9
            && (total - (4.0 + ramp_s + jerk_s + delay)).abs() < 1e-9
    };
    assert!(is_near(fastest(&[]), zvd_s, 0.0), "{:?}", fastest(&[]));
    let jerk = ("acceleration = \"0.6 m/s^2\"", "jerk = \"1.2 m/s^3\"\nacceleration = \"0.6 m/s^2\"");
    assert!(is_near(fastest(&[jerk]), zvd_s, 0.5), "{:?}", fastest(&[jerk]));
    let zv = ("robust_shaper = true", "robust_shaper = false");
    assert!(is_near(fastest(&[zv]), 0.5 * zvd_s, 0.0), "{:?}", fastest(&[zv]));
}

#[test]
fn a_way_that_the_ramps_use_up_is_reported_with_a_way_that_is_enough() {
    let way = |to: f64| objections(&[(r#"distance = "2.2 m""#, &format!("distance = \"{to} m\""))]);
    let short = way(0.6);
    let text = &short.iter().find(|o| o.id.contains("550mm_s")).unwrap().text;
    // 0.55 (0.917 + 0.278) m.
    assert!(
        text.starts_with(
            "its ramps alone (with the shaper) need 0.66 m of travel and it has 0.60 m: no part of it is steady at 0.550 m/s"
        ),
        "{text}"
    );
    let enough_m = between(text, "1.55 s are needed, ", " m of travel in all");
    assert!(kinds(&way(enough_m), "550mm_s").is_empty());
    let less = way(enough_m - 0.02);
    assert!(less.iter().any(|o| o.text.starts_with("only 1.5")), "{less:?}");
    assert!(short.iter().chain(&less).all(|o| !o.text.contains("-0.")));
}

#[test]
fn a_stand_still_that_gives_no_zero_after_the_tow_is_refused_where_there_is_a_sensor() {
    let still = |to: &str| objections(&[(r#"still = "5 s""#, to)]);
    let short = still(r#"still = "1 s""#);
    assert_eq!((short.len(), short[0].id.as_str(), short[0].kind), (1, "[carriage]", "still"));
    assert!(short[0].text.starts_with("still is 1 s; the force sensor's zero after a tow takes 0.5 s"), "{short:?}");
    assert_eq!(still(r#"still = "1.5 s""#), []);
    assert_eq!(still("").len(), 0);
    let sensor = "[rig.force_sensor]\nrange = \"125 N\"\nresolution = \"0.0208333 N\"        # 1/48 N\nnoise = \"0.05 N\"                  \
                  # not in the paper\ndrift = \"0.2 N\"\ngain_standard = \"0.2 %\"           # of its certificate; not in the paper";
    assert_eq!(objections(&[(r#"still = "5 s""#, r#"still = "1 s""#), (sensor, "")]), []);
}

#[test]
fn the_weight_that_is_advised_may_be_hung() {
    let weights = |heavy: f64| {
        objections(&[(r#"weights = ["1.5 N", "10 N"]"#, &format!("weights = [\"1.5 N\", \"{heavy} N\"]"))])
    };
    let found = weights(100.0);
    let text = &found.iter().find(|o| o.kind == "weight").unwrap().text;
    let advised = between(text, "hang at most ", " N");
    assert!(kinds(&weights(advised), "calibration").iter().all(|k| *k != "weight"), "{advised}");
    assert!(kinds(&weights(advised + 0.02), "calibration").contains(&"weight"), "{advised}");
}

#[test]
fn a_floor_outside_the_travel_is_refused_by_itself() {
    let found = objections(&[(r#"floor = "4.05 m""#, r#"floor = "-1 m""#)]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].id.as_str(), found[0].kind), ("[carriage.calibration]", "weight"));
    assert!(found[0].text.contains("at -1.000 m, outside the travel from -0.050 to 4.950 m"), "{found:?}");
}

#[test]
fn an_assumed_volume_is_reported_where_the_coast_hangs_on_it() {
    let far = [(r#"distance = "2.2 m""#, r#"distance = "4.7 m""#)];
    let guessed = told(&far, Some(6.283e-3)).1;
    let coasts: Vec<_> = guessed.iter().filter(|o| o.kind == "coast").collect();
    assert!(!coasts.is_empty());
    for o in coasts {
        assert!(o.text.ends_with("There is no volume in [body]: that of a 6.3 litre body is assumed"), "{}", o.text);
    }
    assert!(told(&far, None).1.iter().all(|o| !o.text.contains("litre")));
}
