//! The decay test: laws that hold for any release, bias, findings, coverage of the intervals.

use crate::scenario::Scenario;
use froude_fit::budget::{OUTSIDE_95, Uncertain, combine};
use froude_fit::coverage::{Count, z_limit};
use froude_records::run::stamps::even_times;
use froude_tank::decay::axis::Motion;
use froude_tank::decay::releases::Logged;
use froude_tank::decay::{DecayFit, DecayRun, DecaySetup, DecayWindow, Method, envelope, output_error};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// What [`Scenario::heave`] is made of: A33, D_z_I, D_z_II.
const TRUTH: [f64; 3] = [8.0, 4.0, 40.0];

fn declared(inertia: f64, stiffness: f64) -> DecaySetup {
    DecaySetup::new(Motion::Heave, Uncertain::new(inertia, 0.0), Uncertain::new(stiffness, 0.0))
}

fn setup() -> DecaySetup {
    declared(12.0, 180.0)
}

fn both(logged: &[Logged], setup: &DecaySetup) -> [DecayFit; 2] {
    let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
    [envelope(&runs, setup).unwrap(), output_error(&runs, setup).unwrap()]
}

fn clean() -> Scenario {
    Scenario { noise: 0.0, step: 0.0, ..Scenario::heave() }
}

fn codes(fit: &DecayFit) -> Vec<&str> {
    fit.findings.iter().map(|f| f.code.as_str()).collect()
}

/// The same releases in other numbers.
fn moved(logged: &[Logged], time: impl Fn(f64) -> f64, position: impl Fn(f64) -> f64) -> Vec<Logged> {
    let of = |run: &Logged| Logged {
        id: run.id.clone(),
        time_s: run.time_s.iter().map(|t| time(*t)).collect(),
        position: run.position.iter().map(|q| position(*q)).collect(),
    };
    logged.iter().map(of).collect()
}

fn assert_near(found: [f64; 3], expected: [f64; 3], relative: f64, what: &str) {
    // A is small beside M + A, of which it is a difference.
    let scale = [expected[0].abs() + 12.0, expected[1].abs().max(0.1), expected[2].abs().max(1.0)];
    for j in 0..3 {
        assert!((found[j] - expected[j]).abs() <= relative * scale[j], "{what}: {found:?} {expected:?}");
    }
}

/// Without noise the output error is right to its integrator; what is left of the envelope's bias is of fourth order (A) and fifth
/// (damping), beside 1e-4 from turning points by quartics. Columns: D_I, D_II, then the bias of A/(M+A), and of b_eq at the mean speed.
#[test]
fn without_noise_the_output_error_is_exact_and_the_envelope_nearly_so() {
    #[rustfmt::skip]
    let table = [
        (4.0, 0.0, 2e-5, 1e-4), (12.0, 0.0, 2e-5, 3e-4), (0.0, 40.0, 1e-4, 3e-4),
        (4.0, 40.0, 2e-4, 3e-4), (8.0, 160.0, 8e-3, 5e-3),
    ];
    for (linear, quadratic, of_inertia, of_damping) in table {
        let scenario = Scenario { linear, quadratic, ..clean() };
        let [near, exact] = both(&scenario.releases(1), &setup());
        assert_near(exact.values, [8.0, linear, quadratic], 1e-9, "output error");
        let u = 0.5 * (near.range.speed[0] + near.range.speed[1]);
        let damping = |[_, i, ii]: [f64; 3]| i + 0.849 * ii * u;
        let (a, b) = ((near.values[0] - 8.0) / 20.0, damping(near.values) / damping([8.0, linear, quadratic]) - 1.0);
        let [gamma, swing] = [linear / 120.0, quadratic / 20.0 * near.range.amplitude[1]];
        println!("| {linear}, {quadratic} | {gamma:.2} | {swing:.2} | {a:+.0e} | {b:+.0e} |");
        assert!(a.abs() < of_inertia && b.abs() < of_damping, "{linear} {quadratic}: {a:e} {b:e}");
    }
}

/// The sign of q, its zero and that of the clock are nobody's business.
#[test]
fn sign_and_zeros_do_not_matter() {
    let logged = Scenario::heave().releases(3);
    let first = both(&logged, &setup());
    for other in
        [moved(&logged, |t| t, |q| -q), moved(&logged, |t| t + 1000.0, |q| q), moved(&logged, |t| t, |q| q + 5.0)]
    {
        for (a, b) in both(&other, &setup()).iter().zip(&first) {
            assert_near(a.values, b.values, 1e-6, a.method.name());
        }
    }
}

/// Units: lengths by λ, times by τ, masses by μ. A goes as μ, D_I as μ/τ, D_II as μ/λ.
#[test]
fn coefficients_scale_as_their_dimensions() {
    let logged = Scenario::heave().releases(4);
    let first = both(&logged, &setup());
    let (length, time, mass) = (3.0, 0.25, 2.0);
    let other = moved(&logged, |t| t * time, |q| q * length);
    for (fit, base) in both(&other, &declared(12.0 * mass, 180.0 * mass / (time * time))).iter().zip(&first) {
        let [a, i, ii] = base.values;
        let back = [fit.values[0] / mass, fit.values[1] * time / mass, fit.values[2] * length / mass];
        assert_near(back, [a, i, ii], 1e-6, fit.method.name());
        for j in 0..3 {
            let [u, v] = [fit, base].map(|f| f.combined(j).unwrap().standard);
            let scale = [mass, mass / time, mass / length][j];
            assert!((u / scale / v - 1.0).abs() < 1e-3, "{j} {u} {v}");
        }
    }
}

#[test]
fn what_inertia_and_stiffness_do_is_exact() {
    let logged = Scenario::heave().releases(5);
    let first = both(&logged, &setup());
    let (dm, dc) = (0.3, 2.0);
    for (fit, base) in both(&logged, &declared(12.0 + dm, 180.0 + dc)).iter().zip(&first) {
        let expected = std::array::from_fn(|j| {
            base.values[j] + base.errors[0].sensitivity[j] * dm + base.errors[1].sensitivity[j] * dc
        });
        assert_near(fit.values, expected, 1e-7, fit.method.name());
    }
}

/// The common regression on the rows is the envelope's.
#[test]
fn rows_give_the_damping_again() {
    let [fit, _] = both(&Scenario::heave().releases(6), &setup());
    let (mut n, mut r) = ([[0.0; 2]; 2], [0.0; 2]);
    for row in &fit.rows {
        let u = row.speed_amplitude;
        let x = [u, 8.0 / (3.0 * std::f64::consts::PI) * u * u];
        for i in 0..2 {
            r[i] += x[i] * row.force_amplitude;
            for j in 0..2 {
                n[i][j] += x[i] * x[j];
            }
        }
    }
    let determinant = n[0][0] * n[1][1] - n[0][1] * n[1][0];
    let linear = (n[1][1] * r[0] - n[0][1] * r[1]) / determinant;
    let quadratic = (n[0][0] * r[1] - n[1][0] * r[0]) / determinant;
    assert_near([fit.values[0], linear, quadratic], fit.values, 1e-9, "rows");
}

#[test]
fn the_two_methods_agree_within_their_intervals_and_find_nothing_to_doubt() {
    let [a, b] = both(&Scenario::heave().releases(7), &setup());
    for j in 0..3 {
        let [p, q] = [&a, &b].map(|f| f.combined(j).unwrap());
        let apart = (a.values[j] - b.values[j]).abs();
        assert!(apart < p.arms[0].hypot(q.arms[0]), "{j}: {apart}");
    }
    assert!(codes(&a).is_empty() && codes(&b).is_empty(), "{:?} {:?}", a.findings, b.findings);
    assert_eq!(b.names, ["A33", "D_z_I", "D_z_II"]);
    assert_eq!(b.type_a.unwrap().kind, "jackknife over 5 runs");
}

#[test]
fn few_releases_say_what_their_intervals_rest_on() {
    let logged = Scenario::heave().releases(8);
    for (n, [of_envelope, of_fit]) in [
        (1, ["half cycles about the law, in 1 run", "samples of 1 run, correlated over"]),
        (2, ["half cycles about the law, in 2 runs", "samples of 2 runs, correlated over"]),
        (3, ["jackknife over 3 runs", "jackknife over 3 runs"]),
    ] {
        let fits = both(&logged[..n], &setup());
        for (fit, kind) in fits.iter().zip([of_envelope, of_fit]) {
            assert_eq!(codes(fit).contains(&"few-runs"), n < 3, "{n}");
            assert!(fit.type_a.as_ref().unwrap().kind.starts_with(kind), "{:?}", fit.type_a);
            // Six of its standard uncertainties: nothing is far off, whatever the number of releases.
            for j in 0..3 {
                let u = fit.combined(j).unwrap().standard;
                assert!(u > 0.0 && (n == 3 || (fit.values[j] - TRUTH[j]).abs() < 6.0 * u), "{n} {j} {:?}", fit.values);
            }
        }
    }
}

#[test]
fn what_is_doubtful_is_found() {
    let found = |scenario: Scenario| {
        let [a, b] = both(&scenario.releases(9), &setup());
        (
            codes(&a).iter().map(ToString::to_string).collect::<Vec<_>>(),
            codes(&b).iter().map(ToString::to_string).collect::<Vec<_>>(),
        )
    };
    let has = |scenario: Scenario, code: &str| {
        let (a, b) = found(scenario);
        a.iter().chain(&b).any(|c| c == code)
    };
    let heave = Scenario::heave;
    assert!(has(Scenario { coulomb: 0.1, ..heave() }, "coulomb-friction"));
    assert!(has(Scenario { second_mode: (0.01, 1.1), ..heave() }, "second-mode"));
    // One that is larger than the last swings makes passages of its own.
    let beating = Scenario { second_mode: (0.1, 1.1), ..heave() }.releases(9);
    let runs: Vec<DecayRun<'_>> = beating.iter().map(Logged::view).collect();
    let refused = envelope(&runs, &setup()).unwrap_err().to_string();
    assert!(refused.contains("has no turning point near its middle"), "{refused}");
    for code in ["swing-grows", "swings-unread"] {
        assert!(has(Scenario { second_mode: (0.03, 0.6), ..heave() }, code), "{code}");
    }
    assert!(has(Scenario { linear: 0.3, quadratic: 2.0, free_s: 8.0, ..heave() }, "damping-not-split"));
    assert!(has(Scenario { drift_per_s: 2e-4, ..heave() }, "rest-drifts"));
    assert!(has(Scenario { linear: 4.0, quadratic: -8.0, ..heave() }, "negative-damping"));
    // The water's start: 3 % less swing after the first half cycle, from the passage at 1 + ¾ · 2.09 s on.
    let late = |run: &Logged| Logged {
        position: run
            .time_s
            .iter()
            .zip(&run.position)
            .map(|(t, q)| if *t > 2.57 { 0.3 + 0.97 * (q - 0.3) } else { *q })
            .collect(),
        ..run.clone()
    };
    let logged: Vec<Logged> = heave().releases(9).iter().map(late).collect();
    let [a, _] = both(&logged, &setup());
    assert!(codes(&a).contains(&"start-not-free"), "{:?}", a.findings);
}

#[test]
fn a_release_that_shows_nothing_is_left_out_aloud_and_a_damaged_log_is_refused() {
    let mut logged = Scenario::heave().releases(10);
    logged[2].position.iter_mut().for_each(|q| *q = 0.3);
    let [a, b] = both(&logged, &setup());
    for fit in [a, b] {
        assert_eq!(fit.runs.len(), 4);
        assert!(
            fit.findings[0].message.starts_with("left out: run \"release 3\": the motion reaches 0"),
            "{:?}",
            fit.findings[0]
        );
    }
    logged[1].position[5] = f64::NAN;
    let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
    let damaged = "run \"release 2\": position at sample 5 is not finite";
    assert_eq!(output_error(&runs, &setup()).unwrap_err().to_string(), damaged);
    let none = "no release was given; a decay test needs at least one";
    assert_eq!(envelope(&[], &setup()).unwrap_err().to_string(), none);
    let empty = DecayRun { id: "none", time_s: &[], position: &[] };
    assert!(envelope(&[empty], &setup()).is_err());
    let refused = envelope(&runs, &declared(12.0, -1.0)).unwrap_err().to_string();
    assert_eq!(refused, "stiffness is -1; it must be above zero and finite");
}

/// Runs of unequal length and rate go together, and a release may be used from where it is free.
#[test]
fn releases_need_not_be_alike() {
    let logged: Vec<Logged> = [(18.0, 50.0), (9.0, 50.0), (15.0, 100.0)]
        .into_iter()
        .map(|(free_s, rate_hz)| Scenario { free_s, rate_hz, held_s: 0.0, ..clean() }.releases(2).swap_remove(0))
        .collect();
    let window = DecayWindow { free_from_s: Some(0.0), ..DecayWindow::default() };
    for setup in [setup(), DecaySetup { window, ..setup() }] {
        let [a, b] = both(&logged, &setup);
        assert_near(a.values, TRUTH, 3e-4, "envelope");
        assert_near(b.values, TRUTH, 1e-9, "output error");
    }
}

/// Campaigns of the coverage test; `FROUDE_DECAY_CAMPAIGNS` asks for more.
fn campaigns() -> u64 {
    std::env::var("FROUDE_DECAY_CAMPAIGNS").ok().and_then(|n| n.parse().ok()).unwrap_or(100)
}

/// One release and two, alike: the interval is that of the half cycles or of the samples, and holds the truth as often as it says or more. More by
/// the envelope: neighbours share a turning point with opposite signs, and the classical variance does not know. The table of 1000 campaigns is in
/// the book.
#[test]
fn intervals_of_few_releases_hold_the_truth_where_releases_are_alike() {
    let scenario = Scenario { rate_hz: 25.0, free_s: 14.0, ..Scenario::heave() };
    let n = campaigns();
    let mut counts = [[[Count::default(); 3]; 2]; 2];
    for seed in 0..n {
        let logged = scenario.releases(seed);
        for (few, counts) in counts.iter_mut().enumerate() {
            for (m, fit) in both(&logged[..=few], &setup()).iter().enumerate() {
                for j in 0..3 {
                    let [low, high] = fit.interval_95(j).unwrap();
                    counts[m][j].add((low..=high).contains(&TRUTH[j]));
                }
            }
        }
    }
    let limit = z_limit(0.01, 12);
    for (few, counts) in counts.iter().enumerate() {
        for (m, method) in Method::ALL.into_iter().enumerate() {
            for j in 0..3 {
                let (name, rate) = (&setup().axis.decay_names()[j], counts[m][j].rate());
                println!("| {} | {} | {name} | {:.1} % |", few + 1, method.name(), 100.0 * rate);
                assert!(counts[m][j].z_score(0.95) > -limit, "{} {} {name}: {rate}", few + 1, method.name());
            }
        }
    }
}

/// A camera: 30 frames a second stamped to hundredths, of which 3 % are lost.
fn filmed(logged: Vec<Logged>, rng: &mut Pcg64) -> Vec<Logged> {
    let of = |run: Logged| {
        let keep: Vec<usize> = (0..run.time_s.len()).filter(|_| rng.random::<f64>() >= 0.03).collect();
        let stamps: Vec<f64> = keep.iter().map(|i| (run.time_s[*i] * 100.0).round() / 100.0).collect();
        let even = even_times(&stamps, 0.01).unwrap();
        Logged { id: run.id, time_s: even.times_s(), position: keep.iter().map(|i| run.position[*i]).collect() }
    };
    logged.into_iter().map(of).collect()
}

/// Stamps that jitter by a tenth of a step, each as it is written.
fn jittered(logged: Vec<Logged>, rng: &mut Pcg64) -> Vec<Logged> {
    let of = |run: Logged| {
        let step_s = run.time_s[1] - run.time_s[0];
        let time_s = run.time_s.iter().map(|t| t + 0.2 * step_s * (rng.random::<f64>() - 0.5)).collect();
        Logged { time_s, ..run }
    };
    logged.into_iter().map(of).collect()
}

/// Lost frames, rounded and jittering stamps: the output error holds the truth in 95 of 100 campaigns of five releases, less 2.3 standard deviations of 200.
#[test]
fn intervals_hold_the_truth_with_lost_frames_rounded_and_jittering_stamps() {
    let scenario = Scenario { rate_hz: 30.0, free_s: 14.0, ..Scenario::heave() };
    let ways: [fn(Vec<Logged>, &mut Pcg64) -> Vec<Logged>; 2] = [filmed, jittered];
    for (way, degraded) in ways.into_iter().enumerate() {
        let mut counts = [Count::default(); 3];
        for seed in 0..200 {
            let mut rng = Pcg64::seed_from_u64(seed ^ 0xca3e);
            let logged = degraded(scenario.releases(seed), &mut rng);
            let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
            let fit = output_error(&runs, &setup()).unwrap();
            for (j, count) in counts.iter_mut().enumerate() {
                let [low, high] = fit.interval_95(j).unwrap();
                count.add((low..=high).contains(&TRUTH[j]));
            }
        }
        for (count, name) in counts.iter().zip(setup().axis.decay_names()) {
            println!("{way} {name}: {:.1} %", 100.0 * count.rate());
            assert!(count.z_score(0.95) > -z_limit(0.01, 6), "{way} {name}: {}", count.rate());
        }
    }
}

/// A release of a body of twice the added mass, and one in mm under [m], are named.
#[test]
fn a_release_of_another_body_or_in_another_unit_stands_out() {
    let others = Scenario::heave().releases(1);
    let heavy = Scenario { moving: 28.0, ..Scenario::heave() }.releases(2);
    let mixed = [&others[..4], &heavy[..1]].concat();
    let stands_out = |logged: &[Logged], fit: usize| -> Vec<String> {
        let found = &both(logged, &setup())[fit].findings;
        found.iter().filter(|f| f.code == "release-stands-out").map(|f| f.message.clone()).collect()
    };
    let mut renamed = mixed.clone();
    renamed[4].id = "other".to_owned();
    for fit in 0..2 {
        let found = stands_out(&renamed, fit);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("run \"other\" has a period of 2.4"), "{found:?}");
        assert!(stands_out(&others, fit).is_empty());
    }
    let mut in_mm = others.clone();
    in_mm[2].position.iter_mut().for_each(|q| *q *= 1000.0);
    let runs: Vec<DecayRun<'_>> = in_mm.iter().map(Logged::view).collect();
    let fit = envelope(&runs, &setup()).unwrap();
    assert!(fit.findings.iter().any(|f| f.message.starts_with("run \"release 3\" swings by")), "{:?}", fit.findings);
}

/// Five releases a campaign: how often the 95 % interval of each coefficient holds the truth, from the scatter alone, and with M and C known to
/// 0.5 % and 0.3 %. The table of 4000 campaigns is in the book.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let scenario = Scenario { rate_hz: 25.0, free_s: 14.0, ..Scenario::heave() };
    let n = campaigns();
    let mut counts = [[[Count::default(); 3]; 2]; 2];
    let mut widths = [[[0.0; 3]; 2]; 2];
    let (mut means, mut squares) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
    let mut doubted = 0;
    for seed in 0..n {
        let fits = both(&scenario.releases(seed), &setup());
        let mut rng = Pcg64::seed_from_u64(seed ^ 0xdec1);
        let mut z = || -> f64 { StandardNormal.sample(&mut rng) };
        let (dm, dc) = (0.06 * z(), 0.54 * z());
        doubted += u64::from(fits.iter().any(|f| !f.findings.is_empty()));
        for (m, fit) in fits.into_iter().enumerate() {
            for j in 0..3 {
                let error = fit.values[j] - TRUTH[j];
                means[m][j] += error / n as f64;
                squares[m][j] += error * error / n as f64;
                // To first order; `what_inertia_and_stiffness_do_is_exact` says that this is all.
                let off = error + fit.errors[0].sensitivity[j] * dm + fit.errors[1].sensitivity[j] * dc;
                let mut with = fit.clone();
                (with.errors[0].standard, with.errors[1].standard) = (0.06, 0.54);
                for (b, (fit, error)) in [(&fit, error), (&with, off)].into_iter().enumerate() {
                    let [low, high] = combine(&fit.budget(), j, OUTSIDE_95).arms;
                    counts[b][m][j].add(-high <= error && error <= low);
                    widths[b][m][j] += 0.5 * (low + high) / n as f64;
                }
            }
        }
    }
    println!(
        "{n} campaigns, {doubted} with a finding; two binomial standard deviations are {:.2} %",
        200.0 * (0.0475 / n as f64).sqrt()
    );
    let limit = z_limit(0.01, 12);
    for (b, what) in ["scatter", "whole budget"].into_iter().enumerate() {
        for (m, method) in Method::ALL.into_iter().enumerate() {
            for j in 0..3 {
                let count = counts[b][m][j];
                println!(
                    "| {what} | {} | {} | {:.1} % | {:.4} | {:+.5} | {:.5} |",
                    method.name(),
                    setup().axis.decay_names()[j],
                    100.0 * count.rate(),
                    widths[b][m][j],
                    means[m][j],
                    squares[m][j].sqrt(),
                );
                assert!(count.z_score(0.95).abs() < limit, "{b} {m} {j}: {}", count.rate());
            }
        }
    }
    assert!(doubted as f64 <= 0.03 * n as f64 + 4.0, "{doubted}");
}
