//! Pure sway on its twin.

use froude_fit::coverage::Count;
use froude_records::campaign::Identify;
use froude_tank::driven::fit::{fit, motions};
use froude_tank::driven::forecast::forecast;
use froude_tank::driven::run::Run;
use froude_tank::driven::setup::Setup;
use froude_tank::driven::twin::{Simulated, Twin};
use froude_tank::joint::JointFit;
use froude_tank::sway::Sway;
use froude_tank::sway::by_itself::by_itself;
use rayon::prelude::*;

use crate::declared::campaign;

const CAMPAIGN: &str = include_str!("../../../../examples/sway/campaign.toml");
const TRUTH: [(&str, f64); 4] = [("Y_v_dot", -38.0), ("Y_v", -42.0), ("N_v_dot", 1.5), ("N_v", -35.0)];
const MASS_KG: f64 = 46.0;
const X_G_M: f64 = 0.012;

fn twin(changes: &[(&str, &str)]) -> Twin<Sway> {
    let campaign = campaign(CAMPAIGN, changes);
    Twin::of(&campaign, &campaign.sources[0]).unwrap()
}

fn views(logged: &[Simulated]) -> Vec<Run<'_>> {
    logged.iter().map(Simulated::view).collect()
}

fn fitted(logged: &[Simulated], setup: &Setup<Sway>) -> JointFit {
    let runs = views(logged);
    fit(&runs, &motions(&runs, setup, &[]).unwrap(), setup, &Identify::default()).unwrap()
}

/// The runs of a twin on which everything is exactly what is declared.
fn exactly(twin: &Twin<Sway>) -> Vec<Simulated> {
    let mut setup = twin.setup.clone();
    setup.constants.iter_mut().filter_map(|c| c.known.as_mut()).for_each(|known| known.standard = 0.0);
    Twin { setup, planned: twin.planned.clone(), truth: twin.truth.clone() }.simulated(&[], 1).unwrap()
}

fn value(fit: &JointFit, name: &str) -> f64 {
    fit.unknown(name).expect(name).value.unwrap()
}

/// Start-up decays with the servo, 18 rad/s, and is gone after one period; the steps of the servo err by 3e-9.
#[test]
fn without_noise_the_truth_comes_out() {
    let found = ("delay  = { value = \"0 ms\", standard = \"2 ms\" }", "");
    let twin = twin(&[found, ("N_v     = \"-35 N s\"", "N_v = \"-35 N s\"\ndelay = \"13 ms\"")]);
    let fit = fitted(&exactly(&twin), &twin.setup);
    for (name, truth) in TRUTH {
        assert!((value(&fit, name) / truth - 1.0).abs() < 1e-6, "{name}: {}", value(&fit, name));
    }
    assert!((value(&fit, "delay") - 0.013).abs() < 1e-8, "{}", value(&fit, "delay"));
}

/// The classical analysis of one run by amplitude and phase, and the joint fit of that run: two ways to one number.
#[test]
fn amplitude_and_phase_of_a_run_give_the_same_coefficients() {
    let twin = twin(&[("delay  = { value = \"0 ms\", standard = \"2 ms\" }", "delay = \"13 ms\"")]);
    let logged = exactly(&twin);
    for (i, one) in logged.iter().enumerate() {
        let alone = std::slice::from_ref(one);
        let fit = fitted(alone, &twin.setup);
        let runs = views(alone);
        let motions = motions(&runs, &twin.setup, &[]).unwrap();
        let [force, moment] = [0, 1].map(|load| by_itself(&runs[0], &motions[0], load, 0.013).unwrap());
        let found = [
            MASS_KG - force.of_acceleration,
            -force.of_velocity,
            MASS_KG * X_G_M - moment.of_acceleration,
            -moment.of_velocity,
        ];
        for ((name, truth), found) in TRUTH.into_iter().zip(found) {
            // The servo's steps err by 3e-9; N_v̇ is what 0.55 kg m of the rigid body leaves, and the moment is mostly damping: a hundred times that.
            assert!((found / truth - 1.0).abs() < 1e-6, "run {i}, {name}: {found}");
            assert!((found / value(&fit, name) - 1.0).abs() < 1e-6, "run {i}, {name}: {}", value(&fit, name));
        }
        // The part of the force in phase with the sway is inertia, −(m − Y_v̇)ω²a; the part a quarter period ahead is damping.
        let omega = motions[0].angle.omega_rad_s;
        let expected = (42.0 * omega).atan2(-(MASS_KG + 38.0) * omega * omega);
        assert!((force.ahead_rad - expected).abs() < 1e-6, "run {i}: {} {expected}", force.ahead_rad);
    }
}

/// With y and z reversed, sway, f_y and m_z change sign and the coefficients stay; with x and z reversed, m_z and x_G change sign, and so do N_v̇ and N_v.
#[test]
fn turned_axes_give_turned_coefficients() {
    let twin = twin(&[]);
    let logged = exactly(&twin);
    let here = fitted(&logged, &twin.setup);
    let turned = |signs: [f64; 3]| {
        let mut logged = logged.clone();
        for run in &mut logged {
            let all = std::iter::once(&mut run.trace.motion).chain(&mut run.trace.loads);
            all.zip(signs).for_each(|(values, sign)| values.iter_mut().for_each(|x| *x *= sign));
        }
        logged
    };
    let there = fitted(&turned([-1.0; 3]), &twin.setup);
    for (name, _) in TRUTH {
        assert!((value(&here, name) / value(&there, name) - 1.0).abs() < 1e-9, "{name}");
    }
    // Bow and stern exchanged: the moment changes its sign, and so does its arm.
    let mut setup = twin.setup.clone();
    let x_g = setup.constants.iter_mut().find(|c| c.name == "x_g").and_then(|c| c.known.as_mut()).unwrap();
    x_g.value = -X_G_M;
    let there = fitted(&turned([1.0, 1.0, -1.0]), &setup);
    for ((name, _), sign) in TRUTH.into_iter().zip([1.0, 1.0, -1.0, -1.0]) {
        assert!((value(&here, name) / value(&there, name) * sign - 1.0).abs() < 1e-6, "{name}");
    }
}

/// ∂Y_v̇/∂m = 1 and ∂N_v̇/∂x_G = m: what is declared of the rigid body is removed, and its error stays.
#[test]
fn errors_of_the_rigid_body_are_errors_of_the_added_mass() {
    let twin = twin(&[]);
    let fit = fitted(&exactly(&twin), &twin.setup);
    let of = |name: &str| fit.errors.iter().find(|e| e.name == name).unwrap().sensitivity.clone();
    // The fit reads q where q + e is there: what is there shows as an added mass larger by e, and Y_v̇ smaller.
    for (name, expected) in [("mass", [-1.0, 0.0, -X_G_M, 0.0]), ("x_g", [0.0, 0.0, -MASS_KG, 0.0])] {
        let found = of(name);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5 * MASS_KG), "{name}: {found:?}");
    }
}

/// Runs in air find the mass.
#[test]
fn runs_in_air_determine_the_mass() {
    let in_air =
        "[[source.plan]]\nmedium = \"air\"\namplitude = \"80 mm\"\nfrequency = [\"0.2 Hz\", \"0.3 Hz\"]\n\n[simulate]";
    let twin = twin(&[
        ("value = \"46 kg\", standard = \"0.05 kg\"", "value = \"47 kg\", standard = \"1 kg\""),
        ("[simulate]", in_air),
        ("[simulate.coefficients]", "[simulate.coefficients]\nmass = \"46 kg\""),
    ]);
    let fit = fitted(&exactly(&twin), &twin.setup);
    assert!((value(&fit, "mass") / MASS_KG - 1.0).abs() < 1e-6, "{}", value(&fit, "mass"));
    assert!((value(&fit, "Y_v_dot") / TRUTH[0].1 - 1.0).abs() < 1e-6);
}

#[test]
fn runs_of_two_speeds_are_refused() {
    let twin = twin(&[]);
    let mut logged = exactly(&twin);
    logged[0].planned.point.conditions["speed"] = 1.1;
    let runs = views(&logged);
    let motions = motions(&runs, &twin.setup, &[]).unwrap();
    let text = fit(&runs, &motions, &twin.setup, &Identify::default()).unwrap_err().to_string();
    assert!(text.contains("speeds from 1 to 1.1 m/s") && text.contains("[[source]] of its own"), "{text}");
}

/// The error over the plan's forecast, and how often the interval holds the truth.
#[test]
fn intervals_cover_and_the_plan_forecasts_the_errors() {
    const SEEDS: u64 = 200;
    let campaign = campaign(CAMPAIGN, &[]);
    let twin = Twin::<Sway>::of(&campaign, &campaign.sources[0]).unwrap();
    let sensors = campaign.simulate.unwrap().sensors;
    let plan = forecast(&twin, &twin.setup, &sensors, &Identify::default()).unwrap();
    let fits: Vec<JointFit> =
        (0..SEEDS).into_par_iter().map(|seed| fitted(&twin.simulated(&sensors, seed).unwrap(), &twin.setup)).collect();
    for (j, (name, truth)) in TRUTH.into_iter().enumerate() {
        let (mut count, mut squares) = (Count::default(), 0.0);
        for fit in &fits {
            let (found, combined) = (fit.unknowns[j].value.unwrap(), fit.unknowns[j].combined.unwrap());
            let [low, high] = combined.interval(found);
            count.add((low..=high).contains(&truth));
            squares += (found - truth).powi(2);
        }
        // Four binomial deviations; a root mean square of 200 errors scatters by 5 %.
        assert!(count.z_score(0.95).abs() < 4.0, "{name}: {}", count.rate());
        let ratio = (squares / SEEDS as f64).sqrt() / plan.expected[j].combined.standard;
        assert!((ratio - 1.0).abs() < 0.2, "{name}: {ratio}");
    }
}
