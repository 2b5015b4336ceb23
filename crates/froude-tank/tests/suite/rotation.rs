//! Rotation on its twin: the Mamba link about its own centre, λ₃ of the cross-flow law, λ₂ of the friction law (f2 of the circulation tank, USR Table 9).

use froude_fit::budget::Uncertain;
use froude_hydro::Link;
use froude_records::campaign::{Identify, PriorSpec, SensorSpec};
use froude_rig::rotation::Mounted;
use froude_rig::swung::Swing;
use froude_tank::TankError;
use froude_tank::joint::DELAY;
use froude_tank::rotation::findings::of_fit;
use froude_tank::rotation::forecast::forecast;
use froude_tank::rotation::simulate::{Planned, Simulated, Truths, simulated};
use froude_tank::rotation::{Axis, Cycles, RotationFit, RotationRun, Setup, derived, fit, law_behind, motions};

const LINK: Link = Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 };
const INERTIA: f64 = 3.4e-3;
/// ⅔ρπC_A a²l³ with C_A = 1.277, ρπC_f(a+b)l³/6 with C_f = 0.0544, ½ρC_D a l⁴ with C_D = 1.8601.
const LAMBDAS: [f64; 3] = [6.909_64e-3, 2.090_07e-3, 3.677_71e-3];

const TRUTH: Truths = Truths {
    lambdas: LAMBDAS,
    shaft: [0.0; 3],
    inertia_kg_m2: Some(INERTIA),
    restoring_n_m: None,
    restoring_in_air_n_m: 0.0,
    delay_s: Some(0.0),
};

fn setup() -> Setup {
    Setup {
        delay_s: Some(Uncertain::new(0.0, 0.0)),
        density_kg_m3: Some(Uncertain::new(1025.0, 0.0)),
        link: Some(LINK),
        ..Setup::new(Some(Uncertain::new(INERTIA, 0.0)))
    }
}

fn plan(mounted: Mounted, amplitudes_deg: &[f64], omegas_deg: &[f64], periods: f64) -> Vec<Planned> {
    let mut out = Vec::new();
    for amplitude in amplitudes_deg {
        for omega in omegas_deg {
            let turn = Swing {
                amplitude_rad: amplitude.to_radians(),
                omega_rad_s: omega.to_radians(),
                // Longer than a quarter of a period, so that the rest is told from a log that begins in the motion.
                still_s: 2.0,
                periods,
            };
            out.push(Planned { id: format!("{mounted:?} {amplitude} {omega}"), mounted, swing: turn, rate_hz: 100.0 });
        }
    }
    out
}

/// The gait of the paper: 30 to 60 deg, 60 to 80 deg/s.
fn gait(periods: f64) -> Vec<Planned> {
    plan(Mounted::Body, &[30.0, 45.0, 60.0], &[60.0, 70.0, 80.0], periods)
}

fn noise(noise: f64) -> Vec<SensorSpec> {
    vec![SensorSpec {
        quantity: "torque".to_owned(),
        noise: Some(noise),
        correlation_s: Some(0.5),
        ..SensorSpec::default()
    }]
}

fn views(logged: &[Simulated]) -> Vec<RotationRun<'_>> {
    logged.iter().map(Simulated::view).collect()
}

fn fitted(logged: &[Simulated], setup: &Setup, identify: &Identify) -> Result<RotationFit, TankError> {
    let runs = views(logged);
    fit(&runs, &motions(&runs, setup)?, setup, identify)
}

fn value(fit: &RotationFit, name: &str) -> f64 {
    fit.unknown(name).expect(name).value.unwrap()
}

/// What the harmonics leave of the start-up decays with the servo, 18 rad/s: e^{−18·4.5} after one period.
fn is_true(fit: &RotationFit) {
    for (name, truth) in ["lambda_1", "lambda_2", "lambda_3"].into_iter().zip(LAMBDAS) {
        assert!((value(fit, name) / truth - 1.0).abs() < 1e-6, "{name}: {} {truth}", value(fit, name));
    }
}

#[test]
fn without_noise_the_truth_comes_out_over_whole_and_broken_periods() {
    for periods in [6.3, 7.0, 8.7] {
        let truth = Truths { delay_s: Some(0.013), ..TRUTH };
        let setup = Setup { delay_s: None, ..setup() };
        let logged = simulated(&gait(periods), &setup, &truth, &[], 1);
        let fit = fitted(&logged, &setup, &Identify::default()).unwrap();
        is_true(&fit);
        assert!((value(&fit, DELAY) - 0.013).abs() < 1e-7, "{}", value(&fit, DELAY));
    }
}

/// A level axis, an inertia that nobody declared, and a shaft that the water holds too: runs in air and runs of the shaft find what they are for.
#[test]
fn runs_in_air_and_of_the_shaft_determine_what_is_not_the_body_s() {
    let shaft = [3e-4, 4e-4, 5e-4];
    let truth =
        Truths { shaft, restoring_n_m: Some(4e-3), restoring_in_air_n_m: 0.11, inertia_kg_m2: Some(INERTIA), ..TRUTH };
    let setup = Setup {
        axis: Axis::Stream,
        inertia_kg_m2: None,
        tare_inertia_kg_m2: Some(Uncertain::new(2e-4, 0.0)),
        restoring_n_m: Some(Uncertain::new(3.5e-3, 5e-4)),
        ..setup()
    };
    let mut planned = gait(7.0);
    planned.extend(plan(Mounted::BodyInAir, &[30.0, 60.0], &[60.0, 80.0], 7.0));
    planned.extend(plan(Mounted::Shaft, &[30.0, 60.0], &[60.0, 80.0], 7.0));
    let fit = fitted(&simulated(&planned, &setup, &truth, &[], 1), &setup, &Identify::default()).unwrap();
    is_true(&fit);
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
    let in_water: Vec<Planned> = planned.into_iter().filter(|p| p.mounted != Mounted::Shaft).collect();
    let fit = fitted(&simulated(&in_water, &setup, &truth, &[], 1), &setup, &Identify::default()).unwrap();
    for ((name, own), shaft) in ["lambda_1", "lambda_2", "lambda_3"].into_iter().zip(LAMBDAS).zip(shaft) {
        assert!((value(&fit, name) / (own + shaft) - 1.0).abs() < 1e-5, "{name}");
    }
}

/// λ₁ is what is left of the inertia: ∂λ₁/∂J = −1, and J does nothing to λ₂ and λ₃.
#[test]
fn an_error_of_the_inertia_is_one_of_lambda_1() {
    let setup = Setup { inertia_kg_m2: Some(Uncertain::new(1.1 * INERTIA, 1e-4)), ..setup() };
    let fit = fitted(&simulated(&gait(7.0), &setup, &TRUTH, &[], 1), &setup, &Identify::default()).unwrap();
    assert!((value(&fit, "lambda_1") - (LAMBDAS[0] - 0.1 * INERTIA)).abs() < 1e-8);
    let error = fit.errors.iter().find(|e| e.name == "inertia").unwrap();
    // The fit reads q where q + e is there: what is there shows as λ₁ larger by e.
    assert!((error.sensitivity[0] - 1.0).abs() < 1e-6 && error.sensitivity[1].abs() < 1e-6, "{error:?}");
    assert!((value(&fit, "lambda_3") / LAMBDAS[2] - 1.0).abs() < 1e-6);
}

/// Runs in air find the inertia, whatever was declared as exact; a declared one that is 20 % off is said, 24 standard uncertainties of theirs with two degrees of freedom, and one that is right is not.
#[test]
fn an_exact_inertia_that_runs_in_air_contradict_is_said() {
    let mut planned = gait(7.0);
    planned.extend(plan(Mounted::BodyInAir, &[30.0, 60.0], &[60.0, 80.0], 7.0));
    let logged = simulated(&planned, &setup(), &TRUTH, &noise(2e-4), 1);
    let runs = views(&logged);
    let contradicted = |declared: f64| {
        let setup = Setup { inertia_kg_m2: Some(Uncertain::new(declared, 0.0)), ..setup() };
        let motions = motions(&runs, &setup).unwrap();
        let fit = fit(&runs, &motions, &setup, &Identify::default()).unwrap();
        let all = of_fit(&fit, &[], &runs, &motions, &setup);
        all.into_iter().filter(|f| f.code == "declared-contradicted").map(|f| f.message).collect::<Vec<_>>()
    };
    assert_eq!(contradicted(INERTIA), Vec::<String>::new());
    let text = contradicted(1.2 * INERTIA);
    assert!(text.len() == 1 && text[0].contains("inertia is declared as 0.00408"), "{text:?}");
}

/// Turning the axis round changes no coefficient: both angle and torque change their sign.
#[test]
fn the_sign_of_the_axis_does_not_matter() {
    let mut logged = simulated(&gait(7.0), &setup(), &TRUTH, &noise(1e-3), 3);
    let here = fitted(&logged, &setup(), &Identify::default()).unwrap();
    for run in &mut logged {
        run.trace.angle_rad.iter_mut().for_each(|x| *x = -*x);
        run.trace.load.iter_mut().for_each(|x| *x = -*x);
    }
    let there = fitted(&logged, &setup(), &Identify::default()).unwrap();
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
    let setup = Setup { cycles: Cycles { used: Some(5), ..Cycles::default() }, ..setup() };
    let found = forecast(&gait(7.0), &setup, &TRUTH, &noise(1e-3), &Identify::default()).unwrap();
    let relative = |j: usize| found.expected[j].combined.standard / LAMBDAS[j];
    for (j, beforehand) in [9.218e-3, 0.106_426, 0.059_486].into_iter().enumerate() {
        assert!((relative(j) / beforehand - 1.0).abs() < 0.005, "{j}: {} {beforehand}", relative(j));
    }
    let r = found.correlation("lambda_2", "lambda_3").unwrap();
    assert!((r + 0.936).abs() < 0.001, "{r}");
    // Within what the prior leaves, λ₃ held makes λ₂ better by √(1 − r²) or more.
    let fixed = Identify { fixed: [("lambda_3".to_owned(), LAMBDAS[2])].into_iter().collect(), ..Identify::default() };
    let held = forecast(&gait(7.0), &setup, &TRUTH, &noise(1e-3), &fixed).unwrap();
    assert_eq!(held.expected[2].combined.standard, 0.0);
    assert!(held.expected[1].combined.standard < 0.5 * found.expected[1].combined.standard);
}

/// A prior, and a value that is held: both act by name.
#[test]
fn lambdas_are_held_or_known_beforehand_by_name() {
    let logged = simulated(&gait(7.0), &setup(), &TRUTH, &noise(1e-3), 5);
    let fixed = Identify { fixed: [("lambda_2".to_owned(), LAMBDAS[1])].into_iter().collect(), ..Identify::default() };
    let held = fitted(&logged, &setup(), &fixed).unwrap();
    assert_eq!(value(&held, "lambda_2"), LAMBDAS[1]);
    let free = fitted(&logged, &setup(), &Identify::default()).unwrap();
    let prior = PriorSpec {
        coefficient: "lambda_1".to_owned(),
        value: LAMBDAS[0],
        standard_uncertainty: 1e-7,
        dof: None,
        model: None,
        record: None,
    };
    let known = fitted(&logged, &setup(), &Identify { prior: vec![prior], ..Identify::default() }).unwrap();
    assert!((value(&known, "lambda_1") - LAMBDAS[0]).abs() < 1e-7);
    let of = |fit: &RotationFit| fit.unknown("lambda_1").unwrap().combined.unwrap().standard;
    assert!(of(&known) < 0.1 * of(&free), "{} {}", of(&known), of(&free));
}

#[test]
fn the_law_behind_lambda_3_is_named() {
    let logged = simulated(&gait(7.0), &setup(), &TRUTH, &noise(1e-3), 7);
    let fit = fitted(&logged, &setup(), &Identify::default()).unwrap();
    let derived = derived(&fit, &setup());
    let found = law_behind(&derived).unwrap();
    let words = found.words();
    assert!(
        found.e_n < -1.0 && words.starts_with("one friction coefficient cannot explain lambda_2 and lambda_3"),
        "{words}"
    );
    assert!(
        (found.c_d[0] - 1.8601).abs() < found.c_d[1]
            && (found.from_lambda_2[0] - 0.0544).abs() < found.from_lambda_2[1]
    );
    let runs = views(&logged);
    let all = of_fit(&fit, &derived, &runs, &motions(&runs, &setup()).unwrap(), &setup());
    assert!(all.iter().any(|f| f.code == "law-behind-lambda-3" && f.message == words), "{all:?}");
    assert!(all.iter().all(|f| f.code != "not-told-apart" && f.code != "misfit-repeats"), "{all:?}");
    assert!(all.iter().any(|f| f.code == "declared-as-exact"), "{all:?}");
}

/// θ̇ and θ̇|θ̇| of one amplitude differ by the third harmonic alone: with white noise r = −(4/3π)/√(½·⅜) = −0.980.
#[test]
fn one_amplitude_and_frequency_is_marked() {
    let planned: Vec<Planned> = (0..6)
        .map(|i| Planned { id: format!("{i}"), ..plan(Mounted::Body, &[45.0], &[70.0], 7.0).remove(0) })
        .collect();
    let white = vec![SensorSpec { correlation_s: None, ..noise(1e-3).remove(0) }];
    let found = forecast(&planned, &setup(), &TRUTH, &white, &Identify::default()).unwrap();
    let r = found.correlation("lambda_2", "lambda_3").unwrap();
    // The broken cycle and the servo's own third harmonic: some 1e-3.
    assert!((r + 0.9803).abs() < 2e-3, "{r}");
    let logged = simulated(&planned, &setup(), &TRUTH, &white, 7);
    let fit = fitted(&logged, &setup(), &Identify::default()).unwrap();
    let runs = views(&logged);
    let all = of_fit(&fit, &[], &runs, &motions(&runs, &setup()).unwrap(), &setup());
    let text = &all.iter().find(|f| f.code == "not-told-apart").unwrap().message;
    assert!(text.contains("hardly told apart (correlation -0.9") && text.contains("0.960 to 0.960 rad/s"), "{text}");
    assert!(text.contains("add runs at half of it"), "{text}");
}

#[test]
fn what_cannot_be_used_is_refused_with_what_to_do() {
    let logged = simulated(&gait(7.0), &setup(), &TRUTH, &noise(1e-3), 7);
    let refused = |logged: &[Simulated], setup: &Setup| {
        fitted(logged, setup, &Identify::default()).map(|fit| fit.unknowns).unwrap_err().to_string()
    };
    let text = refused(&logged, &Setup { inertia_kg_m2: None, ..setup() });
    assert!(text.contains("neither declared nor measured") && text.contains("role = \"dry_air\""), "{text}");
    let shaft = simulated(&plan(Mounted::Shaft, &[30.0], &[60.0], 7.0), &setup(), &TRUTH, &[], 1);
    assert!(refused(&shaft, &setup()).contains("no run with the body in water"));
    let both: Vec<Simulated> = logged.iter().chain(&shaft).cloned().collect();
    assert!(refused(&both, &setup()).contains("write [source.rotation] tare_inertia"));
    let text = refused(&logged, &Setup { cycles: Cycles { fewest: 9, ..Cycles::default() }, ..setup() });
    assert!(text.contains("9 are needed: record longer"), "{text}");
    // A cell at the end of its range, half-way up to the largest torque.
    let mut clipped = logged.clone();
    let torque = &mut clipped[4].trace.load;
    let (low, high) = torque.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    for x in torque.iter_mut() {
        *x = x.min(low + 0.7 * (high - low));
    }
    let runs = views(&clipped);
    let refused = motions(&runs, &setup()).unwrap_err().to_string();
    assert!(refused.contains(": torque stays at ") && refused.contains(" N m for "), "{refused}");
}
