//! Rotation on its twin: the Mamba link about its own centre, λ₃ of the cross-flow law, λ₂ of the friction law (f2 of the circulation tank, USR Table 9).

use froude_records::campaign::{Campaign, Identify, PriorSpec, SensorSpec};
use froude_records::finding::Finding;
use froude_tank::TankError;
use froude_tank::driven::derived::derived;
use froude_tank::driven::fit::{fit, motions};
use froude_tank::driven::fitted::Fitted;
use froude_tank::driven::forecast::{Forecast, forecast};
use froude_tank::driven::method::MotorDriven as _;
use froude_tank::driven::run::Run;
use froude_tank::driven::setup::Setup;
use froude_tank::driven::source::of_fit;
use froude_tank::driven::twin::{Simulated, Twin};
use froude_tank::joint::{DELAY, JointFit};
use froude_tank::rotation::Rotation;
use froude_tank::rotation::derive::law_behind;

use crate::declared::campaign;

const INERTIA: f64 = 3.4e-3;
/// ⅔ρπC_A a²l³ with C_A = 1.277, ρπC_f(a+b)l³/6 with C_f = 0.0544, ½ρC_D a l⁴ with C_D = 1.8601.
const LAMBDAS: [f64; 3] = [6.909_64e-3, 2.090_07e-3, 3.677_71e-3];

/// The gait of the paper: 30 to 60 deg, 60 to 80 deg/s. Still water before it is longer than a quarter of a period, so that the rest is told from a log that
/// begins in the motion.
const CAMPAIGN: &str = r#"
schema = 1
name = "a link about its centre"

[fluid]
density = "1025 kg/m^3"

[body]
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }

[[source]]
name   = "rig"
kind   = "tank"
runs   = "runs"
method = "rotation"

[source.rotation]
axis    = "upright"
inertia = "3.4e-3 kg m^2"
delay   = "0 s"

[[source.plan]]
amplitude = ["30 deg", "45 deg", "60 deg"]
frequency = ["60 deg/s", "70 deg/s", "80 deg/s"]
periods   = 7
still     = "2 s"

[simulate]
seed  = 1
model = "rotation"

[simulate.coefficients]
lambda_1 = "6.90964e-3 kg m^2"
lambda_2 = "2.09007e-3 N m s"
lambda_3 = "3.67771e-3 N m s^2"
inertia  = "3.4e-3 kg m^2"
delay    = "0 s"
"#;
/// Runs in air, and runs of the shaft, beside those of the gait.
const IN_AIR: &str = "\n[[source.plan]]\nrole = \"dry_air\"\namplitude = [\"30 deg\", \"60 deg\"]\nfrequency = [\"60 deg/s\", \"80 deg/s\"]\nstill = \"2 s\"\n";
const OF_SHAFT: &str = "\n[[source.plan]]\nrole = \"tare\"\namplitude = [\"30 deg\", \"60 deg\"]\nfrequency = [\"60 deg/s\", \"80 deg/s\"]\nstill = \"2 s\"\n";

/// The twin of the campaign with these changes of its text.
fn twin(changes: &[(&str, &str)]) -> Twin<Rotation> {
    let campaign = campaign(CAMPAIGN, changes);
    Twin::of(&campaign, &campaign.sources[0]).unwrap()
}

fn noise(noise: f64) -> Vec<SensorSpec> {
    vec![SensorSpec {
        quantity: "torque".to_owned(),
        noise: Some(noise),
        correlation_s: Some(0.5),
        ..SensorSpec::default()
    }]
}

fn views(logged: &[Simulated]) -> Vec<Run<'_>> {
    logged.iter().map(Simulated::view).collect()
}

fn fitted(logged: &[Simulated], setup: &Setup<Rotation>, identify: &Identify) -> Result<JointFit, TankError> {
    let runs = views(logged);
    fit(&runs, &motions(&runs, setup, &[])?, setup, identify)
}

/// The fit of a twin's runs without noise.
fn exactly(twin: &Twin<Rotation>) -> JointFit {
    fitted(&twin.simulated(&[], 1).unwrap(), &twin.setup, &Identify::default()).unwrap()
}

/// What the fit of these runs shows.
fn findings(logged: &[Simulated], setup: &Setup<Rotation>) -> Vec<Finding> {
    let runs = views(logged);
    let motions = motions(&runs, setup, &[]).unwrap();
    let fit = fit(&runs, &motions, setup, &Identify::default()).unwrap();
    let derived = derived(&fit, &setup.method.sums(setup, &[]));
    let campaign = Campaign::default();
    of_fit(&Fitted { fit: &fit, setup, runs: &runs, motions: &motions, derived: &derived, campaign: &campaign })
}

fn expected(twin: &Twin<Rotation>, sensors: &[SensorSpec], identify: &Identify) -> Forecast {
    forecast(twin, &twin.setup, sensors, identify).unwrap()
}

fn value(fit: &JointFit, name: &str) -> f64 {
    fit.unknown(name).expect(name).value.unwrap()
}

/// What the harmonics leave of the start-up decays with the servo, 18 rad/s: e^{−18·4.5} after one period.
fn is_true(fit: &JointFit) {
    for (name, truth) in ["lambda_1", "lambda_2", "lambda_3"].into_iter().zip(LAMBDAS) {
        assert!((value(fit, name) / truth - 1.0).abs() < 1e-6, "{name}: {} {truth}", value(fit, name));
    }
}

#[test]
fn without_noise_the_truth_comes_out_over_whole_and_broken_periods() {
    for periods in ["6.3", "7", "8.7"] {
        let mut twin = twin(&[("delay   = \"0 s\"\n", ""), ("delay    = \"0 s\"", "delay = \"13 ms\"")]);
        twin.planned.iter_mut().for_each(|run| run.swing.periods = periods.parse().unwrap());
        let fit = exactly(&twin);
        is_true(&fit);
        assert!((value(&fit, DELAY) - 0.013).abs() < 1e-7, "{}", value(&fit, DELAY));
    }
}

/// A level axis, an inertia that nobody declared, and a shaft that the water holds too: runs in air and runs of the shaft find what they are for.
#[test]
fn runs_in_air_and_of_the_shaft_determine_what_is_not_the_body_s() {
    let level = "axis    = \"stream\"\ntare_inertia = \"2e-4 kg m^2\"\nrestoring = { value = \"3.5 mN m\", standard = \"0.5 mN m\" }";
    let stated = "[simulate.coefficients]\ntare_1 = \"3e-4 kg m^2\"\ntare_2 = \"4e-4 N m s\"\ntare_3 = \"5e-4 N m s^2\"\nrestoring = \"4 mN m\"\nrestoring_air = \"0.11 N m\"";
    let blocks = format!("{IN_AIR}{OF_SHAFT}\n[simulate]");
    let mut twin = twin(&[
        ("axis    = \"upright\"", level),
        ("inertia = \"3.4e-3 kg m^2\"\ndelay   =", "delay   ="),
        ("\n[simulate]", &blocks),
        ("[simulate.coefficients]", stated),
    ]);
    let fit = exactly(&twin);
    is_true(&fit);
    let shaft = [3e-4, 4e-4, 5e-4];
    for (name, truth) in [
        ("inertia", INERTIA),
        ("tare_1", shaft[0]),
        ("tare_2", shaft[1]),
        ("tare_3", shaft[2]),
        ("restoring", 4e-3),
        ("restoring_air", 0.11),
    ] {
        assert!((value(&fit, name) / truth - 1.0).abs() < 1e-5, "{name}: {} {truth}", value(&fit, name));
    }
    // Without the runs of the shaft its water counts as the body's: λ is the sum.
    twin.planned.truncate(9 + 4);
    let fit = exactly(&twin);
    for ((name, own), shaft) in ["lambda_1", "lambda_2", "lambda_3"].into_iter().zip(LAMBDAS).zip(shaft) {
        assert!((value(&fit, name) / (own + shaft) - 1.0).abs() < 1e-5, "{name}");
    }
}

/// λ₁ is what is left of the inertia: ∂λ₁/∂J = −1, and J does nothing to λ₂ and λ₃.
#[test]
fn an_error_of_the_inertia_is_one_of_lambda_1() {
    let wrong = "inertia = { value = \"3.74e-3 kg m^2\", standard = \"1e-4 kg m^2\" }\ndelay   =";
    let fit = exactly(&twin(&[("inertia = \"3.4e-3 kg m^2\"\ndelay   =", wrong)]));
    assert!((value(&fit, "lambda_1") - (LAMBDAS[0] - 0.1 * INERTIA)).abs() < 1e-8);
    let error = fit.errors.iter().find(|e| e.name == "inertia").unwrap();
    // The fit reads q where q + e is there: what is there shows as λ₁ larger by e.
    assert!((error.sensitivity[0] - 1.0).abs() < 1e-6 && error.sensitivity[1].abs() < 1e-6, "{error:?}");
    assert!((value(&fit, "lambda_3") / LAMBDAS[2] - 1.0).abs() < 1e-6);
}

/// Runs in air find the inertia, whatever was declared as exact; a declared one that is 20 % off is said, 24 standard uncertainties of theirs with two degrees of freedom, and one that is right is not.
#[test]
fn an_exact_inertia_that_runs_in_air_contradict_is_said() {
    let twin = twin(&[("\n[simulate]", &format!("{IN_AIR}\n[simulate]"))]);
    let logged = twin.simulated(&noise(2e-4), 1).unwrap();
    let contradicted = |declared: f64| {
        let mut setup = twin.setup.clone();
        let inertia = setup.constants.iter_mut().find(|c| c.name == "inertia").unwrap();
        inertia.known = Some(froude_fit::budget::Uncertain::new(declared, 0.0));
        let all = findings(&logged, &setup).into_iter().filter(|f| f.code == "declared-contradicted");
        all.map(|f| f.message).collect::<Vec<_>>()
    };
    assert_eq!(contradicted(INERTIA), Vec::<String>::new());
    let text = contradicted(1.2 * INERTIA);
    assert!(text.len() == 1 && text[0].contains("inertia is declared as 0.00408"), "{text:?}");
}

/// Turning the axis round changes no coefficient: both angle and torque change their sign.
#[test]
fn the_sign_of_the_axis_does_not_matter() {
    let twin = twin(&[]);
    let mut logged = twin.simulated(&noise(1e-3), 3).unwrap();
    let here = fitted(&logged, &twin.setup, &Identify::default()).unwrap();
    for run in &mut logged {
        run.trace.motion.iter_mut().for_each(|x| *x = -*x);
        run.trace.loads[0].iter_mut().for_each(|x| *x = -*x);
    }
    let there = fitted(&logged, &twin.setup, &Identify::default()).unwrap();
    for (a, b) in here.unknowns.iter().zip(&there.unknowns) {
        assert!((a.value.unwrap() - b.value.unwrap()).abs() < 1e-9 * a.value.unwrap().abs(), "{}", a.name);
        assert!((a.combined.unwrap().standard / b.combined.unwrap().standard - 1.0).abs() < 1e-6, "{}", a.name);
    }
}

/// By an independent program (golden/rotation_forecast.py): dense covariance matrices, a sine for the servo's, 1 mN m correlated as e^{−t/0.5 s}, five periods of nine runs.
///
/// The servo swings 0.06 % further than a sine: 0.5 % is allowed.
#[test]
fn the_forecast_is_that_of_a_second_program() {
    let twin = twin(&[("axis    = \"upright\"", "axis    = \"upright\"\ncycles = { used = 5 }")]);
    let found = expected(&twin, &noise(1e-3), &Identify::default());
    let relative = |j: usize| found.expected[j].combined.standard / LAMBDAS[j];
    for (j, beforehand) in [9.218e-3, 0.106_426, 0.059_486].into_iter().enumerate() {
        assert!((relative(j) / beforehand - 1.0).abs() < 0.005, "{j}: {} {beforehand}", relative(j));
    }
    let r = found.correlation("lambda_2", "lambda_3").unwrap();
    assert!((r + 0.936).abs() < 0.001, "{r}");
    // Within what the prior leaves, λ₃ held makes λ₂ better by √(1 − r²) or more.
    let fixed = Identify { fixed: [("lambda_3".to_owned(), LAMBDAS[2])].into_iter().collect(), ..Identify::default() };
    let held = expected(&twin, &noise(1e-3), &fixed);
    assert_eq!(held.expected[2].combined.standard, 0.0);
    assert!(held.expected[1].combined.standard < 0.5 * found.expected[1].combined.standard);
}

/// A prior, and a value that is held: both act by name.
#[test]
fn lambdas_are_held_or_known_beforehand_by_name() {
    let twin = twin(&[]);
    let logged = twin.simulated(&noise(1e-3), 5).unwrap();
    let with = |identify: &Identify| fitted(&logged, &twin.setup, identify).unwrap();
    let fixed = Identify { fixed: [("lambda_2".to_owned(), LAMBDAS[1])].into_iter().collect(), ..Identify::default() };
    assert_eq!(value(&with(&fixed), "lambda_2"), LAMBDAS[1]);
    let free = with(&Identify::default());
    let prior = PriorSpec {
        coefficient: "lambda_1".to_owned(),
        value: LAMBDAS[0],
        standard_uncertainty: 1e-7,
        dof: None,
        model: None,
        record: None,
    };
    let known = with(&Identify { prior: vec![prior], ..Identify::default() });
    assert!((value(&known, "lambda_1") - LAMBDAS[0]).abs() < 1e-7);
    let of = |fit: &JointFit| fit.unknown("lambda_1").unwrap().combined.unwrap().standard;
    assert!(of(&known) < 0.1 * of(&free), "{} {}", of(&known), of(&free));
}

#[test]
fn the_law_behind_lambda_3_is_named() {
    let twin = twin(&[]);
    let logged = twin.simulated(&noise(1e-3), 7).unwrap();
    let fit = fitted(&logged, &twin.setup, &Identify::default()).unwrap();
    let found = law_behind(&derived(&fit, &twin.setup.method.sums(&twin.setup, &[]))).unwrap();
    let words = found.words();
    assert!(
        found.e_n < -1.0 && words.starts_with("one friction coefficient cannot explain lambda_2 and lambda_3"),
        "{words}"
    );
    assert!(
        (found.c_d[0] - 1.8601).abs() < found.c_d[1]
            && (found.from_lambda_2[0] - 0.0544).abs() < found.from_lambda_2[1]
    );
    let all = findings(&logged, &twin.setup);
    assert!(all.iter().any(|f| f.code == "law-behind-lambda-3" && f.message == words), "{all:?}");
    assert!(all.iter().all(|f| f.code != "not-told-apart" && f.code != "misfit-repeats"), "{all:?}");
    assert!(all.iter().any(|f| f.code == "declared-as-exact"), "{all:?}");
}

/// θ̇ and θ̇|θ̇| of one amplitude differ by the third harmonic alone: with white noise r = −(4/3π)/√(½·⅜) = −0.980.
#[test]
fn one_amplitude_and_frequency_is_marked() {
    let twin = twin(&[
        ("[\"30 deg\", \"45 deg\", \"60 deg\"]", "\"45 deg\"\nrepeats = 6"),
        ("[\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]", "\"70 deg/s\""),
    ]);
    let white = vec![SensorSpec { correlation_s: None, ..noise(1e-3).remove(0) }];
    let found = expected(&twin, &white, &Identify::default());
    let r = found.correlation("lambda_2", "lambda_3").unwrap();
    // The broken cycle and the servo's own third harmonic: some 1e-3.
    assert!((r + 0.9803).abs() < 2e-3, "{r}");
    let all = findings(&twin.simulated(&white, 7).unwrap(), &twin.setup);
    let text = &all.iter().find(|f| f.code == "not-told-apart").unwrap().message;
    assert!(text.contains("alone (correlation -0.9") && text.contains("0.960 to 0.960 rad/s"), "{text}");
    assert!(text.contains("Add runs at half of it"), "{text}");
}

#[test]
fn what_cannot_be_used_is_refused_with_what_to_do() {
    let twin = twin(&[
        ("\n[simulate]", &format!("{OF_SHAFT}\n[simulate]")),
        ("axis    = \"upright\"", "axis = \"upright\"\ntare_inertia = \"2e-4 kg m^2\""),
        (
            "[simulate.coefficients]",
            "[simulate.coefficients]\ntare_1 = \"0 kg m^2\"\ntare_2 = \"0 N m s\"\ntare_3 = \"0 N m s^2\"",
        ),
    ]);
    let both = twin.simulated(&noise(1e-3), 7).unwrap();
    let (logged, shaft) = both.split_at(9);
    let refused = |logged: &[Simulated], setup: &Setup<Rotation>| {
        fitted(logged, setup, &Identify::default()).map(|fit| fit.unknowns).unwrap_err().to_string()
    };
    let without = |name: &str| {
        let mut setup = twin.setup.clone();
        setup.constants.iter_mut().filter(|c| c.name == name).for_each(|c| c.known = None);
        setup
    };
    let text = refused(logged, &without("inertia"));
    assert!(text.contains("neither declared nor measured") && text.contains("role = \"dry_air\""), "{text}");
    assert!(refused(shaft, &twin.setup).contains("no run with the body in water"));
    assert!(refused(&both, &without("inertia of the shaft")).contains("write [source.rotation] tare_inertia"));
    let mut setup = twin.setup.clone();
    setup.cycles.fewest = 9;
    let text = refused(logged, &setup);
    assert!(text.contains("9 are needed: record longer"), "{text}");
    // A cell at the end of its range, half-way up to the largest torque.
    let mut clipped = logged.to_vec();
    let torque = &mut clipped[4].trace.loads[0];
    let (low, high) = torque.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    for x in torque.iter_mut() {
        *x = x.min(low + 0.7 * (high - low));
    }
    let refused = motions(&views(&clipped), &twin.setup, &[]).unwrap_err().to_string();
    assert!(refused.contains(": torque stays at ") && refused.contains(" N m for "), "{refused}");
}
