//! Excited response on its twin: the NTNU section, 46.8 kg and 2299.5 N/m, in waves of 1.2 s and 0.8 s.

use std::borrow::Cow;
use std::f64::consts::TAU;

use froude_fit::budget::Uncertain;
use froude_records::finding::Finding;
use froude_rig::excited_response::{WaveReadings, WaveRig, WaveTrace};
use froude_signal::resample::Spline;
use froude_tank::TankError;
use froude_tank::excited_response::findings::findings;
use froude_tank::excited_response::plan::forecast;
use froude_tank::excited_response::simulate::{Planned, simulated};
use froude_tank::excited_response::{AtPeriod, Setup, Shows, WaveRun, fit};

const ADDED_KG: f64 = 32.0;
const DAMPING: f64 = 95.0;

fn rig(period_s: f64, lasts_s: f64) -> WaveRig {
    WaveRig {
        mass_kg: 46.8,
        added_kg: ADDED_KG,
        damping_n_s_m: DAMPING,
        restoring_n_m: 2_299.5,
        omega_rad_s: TAU / period_s,
        stroke_m: 8.4e-3,
        force_n: 12.0,
        phase_rad: -0.7,
        still_s: 2.0,
        ramp_s: 2.0,
        travel_s: 5.0,
        lasts_s,
        rate_hz: 200.0,
        thrown_back: None,
    }
}

fn setup(window_s: Option<[f64; 2]>) -> Setup {
    Setup { window_s, ..Setup::new(Uncertain::new(46.8, 0.1), Uncertain::new(2_299.5, 11.5)) }
}

fn view<'a>(id: &'a str, trace: &'a WaveTrace, shows: Shows) -> WaveRun<'a> {
    WaveRun {
        id,
        period_s: None,
        time_s: &trace.time_s,
        reference: &trace.reference_m,
        shows,
        signal: Cow::Borrowed(&trace.signal),
        camera_m: None,
    }
}

/// Held and free runs of a rig without any error.
fn exact(rig: WaveRig) -> [WaveTrace; 2] {
    [rig.held(WaveReadings::exact(), 1), rig.free(WaveReadings::exact(), 2)]
}

fn fitted([held, free]: [&WaveTrace; 2], setup: &Setup) -> Result<AtPeriod, TankError> {
    let runs = [view("held", held, Shows::Force), view("free", free, Shows::Acceleration)];
    fit(&runs, setup).map(|mut all| all.remove(0))
}

fn said(runs: &[WaveRun<'_>], setup: &Setup, code: &str) -> Vec<String> {
    let all: Vec<Finding> = findings(&fit(runs, setup).unwrap(), runs, setup);
    all.into_iter().filter(|f| f.code == code).map(|f| f.message).collect()
}

/// (−ω²(m + A) + iωB + C) z = F, when the start has decayed: by e^(−B t/2(m + A)) = e^(−0.6·33) = 2e-9 from the wave's arrival to the window. The twin's own step errs by 3e-8 of
/// the motion, which is 1e-6 of A and B where the spring and the mass nearly cancel.
#[test]
fn a_twin_without_noise_gives_its_coefficients_back() {
    for period_s in [1.21, 1.0, 0.8] {
        let [held, free] = exact(rig(period_s, 70.0));
        let at = fitted([&held, &free], &setup(Some([40.0, 65.0]))).unwrap();
        let [added, damping] = at.values;
        assert!((added / ADDED_KG - 1.0).abs() < 1e-6, "{period_s}: {added}");
        assert!((damping / DAMPING - 1.0).abs() < 1e-6, "{period_s}: {damping}");
        for half in at.halves {
            assert!((half[0] / ADDED_KG - 1.0).abs() < 1e-6 && (half[1] / DAMPING - 1.0).abs() < 1e-6, "{half:?}");
        }
        assert!(at.correlation().abs() < 0.01, "C33 and mass err in A33 alone");
    }
}

#[test]
fn a_position_serves_as_well_as_an_acceleration() {
    let [held, free] = exact(rig(1.21, 70.0));
    let omega = TAU / 1.21;
    let heave: Vec<f64> = free.signal.iter().map(|a| -a / (omega * omega)).collect();
    let motion = WaveRun { signal: Cow::Owned(heave), ..view("free", &free, Shows::Position) };
    let runs = [view("held", &held, Shows::Force), motion.clone()];
    let setup = Setup { position_relative: 0.01, ..setup(Some([40.0, 65.0])) };
    let at = fit(&runs, &setup).unwrap().remove(0);
    assert!((at.values[0] / ADDED_KG - 1.0).abs() < 1e-6 && (at.values[1] / DAMPING - 1.0).abs() < 1e-6);
    assert!(at.parts.iter().any(|p| p.name == "gain of the position"));
    let both = [runs[0].clone(), motion, view("other", &free, Shows::Acceleration)];
    let refused = fit(&both, &setup).unwrap_err().to_string();
    assert!(refused.contains("the two have gains of their own"), "{refused}");
}

/// The table of sensitivities against what a changed declaration or signal does; differences of 1e-4 leave 2e-4 of the slope for the gains, and ωδ/2 = 3e-4 for the delay.
/// Twins and fits are the same on both sides, so that their own errors drop out.
#[test]
fn what_is_declared_errs_as_the_table_says() {
    let [held, free] = exact(rig(1.21, 70.0));
    let window = Some([40.0, 65.0]);
    let all = Setup {
        delay_s: Uncertain::new(0.0, 1e-3),
        force_relative: 0.01,
        acceleration_relative: 0.01,
        ..setup(window)
    };
    let at = fitted([&held, &free], &all).unwrap();
    let step = 1e-4;
    let times = |trace: &WaveTrace| WaveTrace {
        signal: trace.signal.iter().map(|x| x * (1.0 + step)).collect(),
        ..trace.clone()
    };
    let heavy = Setup { mass_kg: Uncertain::new(46.8 + step, 0.1), ..all.clone() };
    let stiff = Setup { restoring_n_m: Uncertain::new(2_299.5 + step, 11.5), ..all.clone() };
    let late = Setup { delay_s: Uncertain::new(step, 1e-3), ..all.clone() };
    let moved = [
        ("mass", fitted([&held, &free], &heavy)),
        ("restoring coefficient C33", fitted([&held, &free], &stiff)),
        ("delay of the force", fitted([&held, &free], &late)),
        ("gain of the force", fitted([&times(&held), &free], &all)),
        ("gain of the acceleration", fitted([&held, &times(&free)], &all)),
    ];
    assert_eq!(at.errors.len(), moved.len());
    for (name, other) in moved {
        let error = at.errors.iter().find(|e| e.name == name).unwrap();
        for j in 0..2 {
            let found = (other.as_ref().unwrap().values[j] - at.values[j]) / step;
            let scale = error.sensitivity.iter().fold(1.0_f64, |m, s| m.max(s.abs()));
            assert!((found - error.sensitivity[j]).abs() < 1e-3 * scale, "{name} {j}: {found} {:?}", error.sensitivity);
        }
    }
}

/// The force is divided by the stroke of its own wavemaker.
#[test]
fn strokes_that_differ_are_scaled_and_said_and_other_waves_refused() {
    let at = |stroke_m: f64, force_n: f64| WaveRig { stroke_m, force_n, ..rig(1.21, 70.0) };
    let [held, _] = exact(at(8.4e-3, 12.0));
    let [_, free] = exact(at(9.24e-3, 13.2));
    let runs = [view("held", &held, Shows::Force), view("free", &free, Shows::Acceleration)];
    let setup = setup(Some([40.0, 65.0]));
    let found = fit(&runs, &setup).unwrap().remove(0);
    assert!((found.values[0] / ADDED_KG - 1.0).abs() < 1e-6 && (found.values[1] / DAMPING - 1.0).abs() < 1e-6);
    let text = said(&runs, &setup, "wave-differs");
    assert!(text.len() == 1 && text[0].contains("1.100 of that with it held"), "{text:?}");
    let [_, large] = exact(at(12e-3, 17.0));
    let error = fitted([&held, &large], &setup).unwrap_err();
    assert!(error.to_string().contains("a ratio of 1.43"), "{error}");
}

/// Reflections in half of the window move B33; a window before them gives it, and one that is not declared gives none.
#[test]
fn a_window_with_reflections_is_said() {
    let reflecting = WaveRig { thrown_back: Some([0.3, 25.0]), ..rig(1.21, 45.0) };
    let [held, free] = exact(reflecting);
    let runs = [view("held", &held, Shows::Force), view("free", &free, Shows::Acceleration)];
    let before = setup(Some([17.0, 24.5]));
    assert_eq!(said(&runs, &before, "window-not-steady"), Vec::<String>::new());
    // e^(−0.6·10) of the start is left at the beginning of the window: 0.25 %, and a tenth of that in its mean.
    let at = fit(&runs, &before).unwrap().remove(0);
    assert!((at.values[0] / ADDED_KG - 1.0).abs() < 3e-3 && (at.values[1] / DAMPING - 1.0).abs() < 3e-3, "{at:?}");
    let over = setup(Some([18.0, 34.0]));
    let text = said(&runs, &over, "window-not-steady");
    assert!(text.iter().any(|t| t.contains("B33 is") && t.contains("reflections are back")), "{text:?}");
    let undeclared = setup(None);
    let at = fit(&runs, &undeclared).unwrap().remove(0);
    assert!(!at.is_declared);
    let text = said(&runs, &undeclared, "window-not-declared");
    assert!(text.len() == 1 && text[0].contains("B33 only with the declared window before reflections"), "{text:?}");
}

#[test]
fn what_cannot_be_used_is_refused_with_what_was_found() {
    let [held, free] = exact(rig(1.21, 40.0));
    let [other, _] = exact(rig(0.8, 40.0));
    let good = setup(Some([17.0, 24.5]));
    let refused = |runs: &[WaveRun<'_>], setup: &Setup, words: &str| {
        let text = fit(runs, setup).unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    };
    let held_run = || view("h", &held, Shows::Force);
    let free_run = || view("f", &free, Shows::Acceleration);
    refused(&[held_run()], &good, "no run with the free body");
    refused(&[free_run()], &good, "there is none at all");
    refused(&[free_run(), view("o", &other, Shows::Force)], &good, "there are \"o\" of 0.800 s");
    refused(&[held_run(), free_run()], &setup(Some([17.0, 22.0])), "holds 4 whole cycles of 1.210 s, and 5 are needed");
    refused(&[held_run(), free_run()], &setup(Some([30.0, 41.0])), "does not lie within the log");
    let wrong = WaveRun { period_s: Some(1.0), ..free_run() };
    refused(&[held_run(), wrong], &good, "has a period of 1.2100 s, and [conditions] period says 1 s");
    let still = WaveTrace { reference_m: vec![0.0; free.time_s.len()], ..free.clone() };
    refused(
        &[held_run(), view("s", &still, Shows::Acceleration)],
        &good,
        "run \"s\": the wavemaker runs for 0.0 cycles",
    );
    let nothing = WaveTrace { signal: vec![0.0; free.time_s.len()], ..free.clone() };
    refused(&[held_run(), view("n", &nothing, Shows::Acceleration)], &good, "no part at the wave's frequency");
    let broken = WaveTrace { signal: vec![f64::NAN; free.time_s.len()], ..free.clone() };
    refused(&[held_run(), view("b", &broken, Shows::Acceleration)], &good, "not finite");
    // A held run that no free one goes with is left out, and said.
    let runs = [held_run(), free_run(), view("o", &other, Shows::Force)];
    assert_eq!(said(&runs, &good, "run-left-out").len(), 1);
}

/// A camera on a clock of its own, read off by a spline: −7 ms/s and a gain of 0.86; one whose clock wanders.
#[test]
fn a_camera_with_a_skew_is_reported_and_not_repaired() {
    let [held, free] = exact(rig(1.21, 60.0));
    let omega = TAU / 1.21;
    let heave: Vec<f64> = free.signal.iter().map(|a| -a / (omega * omega)).collect();
    let spline = Spline::through(&free.time_s, &heave).unwrap();
    let seen = |lead: &dyn Fn(f64) -> f64| -> Vec<f64> {
        free.time_s.iter().map(|t| 0.86 * spline.at(t + lead(*t)).unwrap_or(0.0)).collect()
    };
    let setup = setup(Some([17.0, 25.0]));
    let of = |camera: &[f64], code: &str| {
        let runs = [
            view("h", &held, Shows::Force),
            WaveRun { camera_m: Some(camera), ..view("f", &free, Shows::Acceleration) },
        ];
        said(&runs, &setup, code)
    };
    let skewed = seen(&|t| 0.2 - 7e-3 * t);
    let text = of(&skewed, "camera-clock");
    assert!(text.len() == 1 && text[0].contains("skew -7.0 ms/s") && text[0].contains("gain 0.86"), "{text:?}");
    let wandering = seen(&|t| 0.1 * (0.3 * t).sin());
    let text = of(&wandering, "camera-not-alignable");
    assert!(text.len() == 1 && text[0].contains("not alignable by offset and skew"), "{text:?}");
    let even = free.signal.iter().map(|a| -a / (omega * omega)).collect::<Vec<f64>>();
    assert!(of(&even, "camera-clock").is_empty() && of(&even, "camera-not-alignable").is_empty());
}

/// Over seeds the errors are those that the plan forecasts, and the stated ones on average: 100 of them, whose root mean square scatters by 7 %.
#[test]
fn the_plan_forecasts_the_scatter_of_the_seeds() {
    let rig = WaveRig { rate_hz: 100.0, ..rig(0.8, 30.0) };
    let run = |is_held: bool| Planned { id: format!("{is_held}"), is_held, period_s: 0.8, rig };
    let planned = [run(true), run(false)];
    let window = [18.0, 28.0];
    let setup = Setup { window_s: Some(window), ..Setup::new(Uncertain::new(46.8, 0.0), Uncertain::new(2_299.5, 0.0)) };
    let sensor = |quantity: &str, noise: f64, correlation_s: Option<f64>| froude_records::campaign::SensorSpec {
        quantity: quantity.to_owned(),
        noise: Some(noise),
        correlation_s,
        ..Default::default()
    };
    let sensors =
        [sensor("f_z", 0.3, Some(0.5)), sensor("acceleration", 0.02, Some(0.5)), sensor("reference", 5e-5, None)];
    let expected = forecast(&planned, &setup, window, &sensors).unwrap().remove(0);
    let seeds = 100;
    let (mut squares, mut stated) = ([0.0; 2], [0.0; 2]);
    for seed in 0..seeds {
        let logs = simulated(&planned, &setup, &sensors, seed);
        let views: Vec<WaveRun<'_>> = logs.iter().map(|log| log.view()).collect();
        let at = fit(&views, &setup).unwrap().remove(0);
        for (j, truth) in [ADDED_KG, DAMPING].into_iter().enumerate() {
            squares[j] += (at.values[j] - truth).powi(2) / seeds as f64;
            stated[j] += at.combined[j].standard.powi(2) / seeds as f64;
        }
    }
    for j in 0..2 {
        let forecast = expected.combined[j].standard;
        let ratio = squares[j].sqrt() / forecast;
        // 0.9 to 1.1, and three deviations of 100 seeds.
        assert!((0.69..1.31).contains(&ratio), "{j}: {ratio}");
        let ratio = stated[j].sqrt() / forecast;
        // The lines beside the wave's see 1.03 of the power of noise correlated over 0.5 s.
        assert!((0.9..1.15).contains(&ratio), "{j}: {ratio}");
    }
}
