//! Releases of which the log alone is known: frequency, damping ratio, decrement and damping per inertia.

use std::f64::consts::TAU;

use froude_fit::budget::Uncertain;
use froude_fit::coverage::{Count, z_limit};
use froude_tank::decay::axis::Motion;
use froude_tank::decay::rates::fitted_by;
use froude_tank::decay::releases::Logged;
use froude_tank::decay::{DecayFit, DecayRun, DecaySetup, Known, Method};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// A roll decay: θ̈ = −ω²θ − 2ζω θ̇ − d θ̇|θ̇|.
#[derive(Clone, Copy)]
struct Roll {
    omega: f64,
    zeta: f64,
    quadratic: f64,
}

const ROLL: Roll = Roll { omega: 2.244, zeta: 0.0539, quadratic: 0.15 };
const BOTH: [Method; 2] = Method::ALL;

impl Roll {
    /// By Runge and Kutta's steps of 5 ms, a sample each tenth step.
    fn released(self, from_rad: f64, noise_rad: f64, rng: &mut Pcg64, duration_s: f64) -> (Vec<f64>, Vec<f64>) {
        let h = 5e-3;
        let rate = |[q, v]: [f64; 2]| {
            [v, -self.omega * self.omega * q - 2.0 * self.zeta * self.omega * v - self.quadratic * v * v.abs()]
        };
        let along = |[q, v]: [f64; 2], [dq, dv]: [f64; 2], h: f64| [q + h * dq, v + h * dv];
        let mut state = [from_rad, 0.0];
        let (mut time_s, mut position) = (Vec::new(), Vec::new());
        for i in 0..(duration_s / h) as u32 {
            if i % 10 == 0 {
                let noise: f64 = StandardNormal.sample(rng);
                time_s.push(f64::from(i) * h);
                position.push(state[0] + noise_rad * noise);
            }
            let a = rate(state);
            let b = rate(along(state, a, 0.5 * h));
            let c = rate(along(state, b, 0.5 * h));
            let d = rate(along(state, c, h));
            let mean = |k: usize| (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0;
            state = along(state, [mean(0), mean(1)], h);
        }
        (time_s, position)
    }

    fn campaign(self, seed: u64, noise_rad: f64, from_deg: [f64; 3]) -> Vec<Logged> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let one = |(k, deg): (usize, &f64)| {
            let (time_s, position) = self.released(deg.to_radians(), noise_rad, &mut rng, 30.0);
            Logged { id: format!("{k}"), time_s, position }
        };
        from_deg.iter().enumerate().map(one).collect()
    }

    /// ln of the largest position of the first period over that of the second.
    fn decrement(self, from_rad: f64) -> f64 {
        let fine = self.released(from_rad, 0.0, &mut Pcg64::seed_from_u64(0), 4.0);
        // Samples are 0.05 s apart: a parabola through the largest three.
        let q = &fine.1;
        let k = (40..q.len() - 1).max_by(|a, b| q[*a].total_cmp(&q[*b])).unwrap();
        let (a, b, c) = (q[k - 1], q[k], q[k + 1]);
        (from_rad / (b - (c - a).powi(2) / (8.0 * (a - 2.0 * b + c)))).ln()
    }
}

fn fitted(method: Method, logged: &[Logged], setup: &DecaySetup) -> DecayFit {
    let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
    fitted_by(method, &runs, setup).unwrap()
}

fn alone() -> DecaySetup {
    DecaySetup::per_inertia(Motion::Roll, None)
}

fn derived(fit: &DecayFit, name: &str) -> (f64, [f64; 2]) {
    let number = fit.derived()[name].clone();
    (number.value.unwrap(), number.interval_95.unwrap())
}

/// A linear oscillator: every swing has the decrement 2πζ/√(1 − ζ²), and the damped period is 2π/(ω√(1 − ζ²)).
#[test]
fn a_linear_oscillator_has_one_decrement() {
    let roll = Roll { quadratic: 0.0, ..ROLL };
    let logged = roll.campaign(1, 1e-7, [12.0, 10.0, 8.0]);
    let root = (1.0 - roll.zeta * roll.zeta).sqrt();
    let expected = TAU * roll.zeta / root;
    let fit = fitted(Method::OutputError, &logged, &alone());
    assert_eq!(fit.names, ["omega_rx", "d_rx_I", "d_rx_II"]);
    assert_eq!(fit.units(), ["rad/s", "1/s", "1"]);
    for swing in fit.swings() {
        let (law, measured) = (swing.law.unwrap(), swing.decrement.unwrap());
        assert!((law / expected - 1.0).abs() < 1e-3, "{swing:?}");
        // The last swings are as small as a thousandth of the first.
        let is_large = swing.amplitude > 1e-3;
        assert!(!is_large || (measured / expected - 1.0).abs() < 0.01, "{swing:?} {expected}");
        assert!((swing.period_s - TAU / (roll.omega * root)).abs() < 5e-3, "{swing:?}");
    }
    for (name, value) in [
        ("zeta", roll.zeta),
        ("log_decrement", expected),
        ("undamped_period", TAU / roll.omega),
        ("damped_period", TAU / (roll.omega * root)),
    ] {
        let (found, _) = derived(&fit, name);
        assert!((found / value - 1.0).abs() < 2e-3, "{name} {found} {value}");
    }
}

/// What is said of a fit has the names of its record.
#[test]
fn findings_name_the_coefficients_of_the_record() {
    let roll = Roll { quadratic: -0.3, zeta: 0.05, ..ROLL };
    let logged = roll.campaign(3, 1e-7, [12.0, 10.0, 8.0]);
    for method in BOTH {
        let fit = fitted(method, &logged, &alone());
        let said: Vec<&str> = fit.findings.iter().map(|f| f.message.as_str()).collect();
        assert!(said.iter().any(|text| text.starts_with("d_rx_II is -")), "{said:?}");
        assert!(!said.iter().any(|text| text.contains("D_rx") || text.contains("A44")), "{said:?}");
    }
}

/// Inertia and stiffness are a scale: with them the frequency and the damping per inertia are those of the log alone, and their uncertainty too.
#[test]
fn what_is_declared_of_the_body_does_not_change_the_rates() {
    let logged = ROLL.campaign(2, 3e-4, [12.0, 10.0, 8.0]);
    for method in BOTH {
        let own = fitted(method, &logged, &alone());
        let declared = DecaySetup::new(Motion::Roll, Uncertain::new(0.3, 0.03), Uncertain::new(2.0, 0.2));
        let other = fitted(method, &logged, &declared);
        for (j, name) in own.names.iter().enumerate() {
            let (value, ends) = derived(&other, name);
            assert!((value / own.values[j] - 1.0).abs() < 1e-6, "{name} {value} {}", own.values[j]);
            let [low, high] = own.interval_95(j).unwrap();
            assert!(((ends[1] - ends[0]) / (high - low) - 1.0).abs() < 1e-3, "{name}: {ends:?} [{low}, {high}]");
        }
        // C alone: the moving inertia is C/ω², and has the uncertainty of C.
        let stiffness = Uncertain::new(2.0, 0.02);
        let third = fitted(method, &logged, &DecaySetup::per_inertia(Motion::Roll, Some(Known::Stiffness(stiffness))));
        let (inertia, [low, high]) = derived(&third, "moving_inertia");
        assert!((inertia / (2.0 / own.values[0].powi(2)) - 1.0).abs() < 1e-9);
        assert!(((high - low) / (2.0 * 1.96 * 0.01 * inertia) - 1.0).abs() < 0.1, "{low} {high}");
        let (linear, _) = derived(&third, "D_rx_I");
        assert!((linear / (own.values[1] * inertia) - 1.0).abs() < 1e-9);
        // I alone: damping is I d, and has the uncertainties of both.
        let [exact, rough] = [0.0, 0.004].map(|standard| {
            let moving = Known::MovingInertia(Uncertain::new(0.4, standard));
            let fit = fitted(method, &logged, &DecaySetup::per_inertia(Motion::Roll, Some(moving)));
            let all = fit.derived();
            assert!(!all.contains_key("moving_inertia"));
            (all["D_rx_I"].value.unwrap(), all["D_rx_I"].standard_uncertainty.unwrap())
        });
        assert!((exact.0 / (0.4 * own.values[1]) - 1.0).abs() < 1e-9 && (exact.0 / rough.0 - 1.0).abs() < 1e-12);
        assert!((rough.1 / f64::hypot(exact.1, 0.01 * exact.0) - 1.0).abs() < 1e-9, "{exact:?} {rough:?}");
    }
}

/// The unit of the position is a scale of quadratic damping and of nothing else.
#[test]
fn a_wrong_unit_changes_quadratic_damping_alone() {
    let logged = ROLL.campaign(3, 3e-4, [12.0, 10.0, 8.0]);
    let in_degrees: Vec<Logged> = logged
        .iter()
        .map(|run| Logged { position: run.position.iter().map(|q| q.to_degrees()).collect(), ..run.clone() })
        .collect();
    let [own, other] = [&logged, &in_degrees].map(|logged| fitted(Method::OutputError, logged, &alone()));
    assert!(
        (0..2).all(|j| (own.values[j] / other.values[j] - 1.0).abs() < 1e-6),
        "{:?} {:?}",
        own.values,
        other.values
    );
    assert!((own.values[2] / other.values[2].to_degrees() - 1.0).abs() < 1e-6);
}

/// Releases of one generator with noise from 0.005 to 0.1 degrees and amplitudes of 8 to 20: how often 95 % intervals hold the truth.
#[test]
fn intervals_of_a_log_alone_hold_the_truth_as_often_as_they_say() {
    let campaigns: u64 = std::env::var("FROUDE_DECAY_CAMPAIGNS").ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    let names = ["omega", "zeta", "d_II", "decrement from 8 degrees", "damped period"];
    let from_rad = 8.0_f64.to_radians();
    let root = (1.0 - ROLL.zeta * ROLL.zeta).sqrt();
    let truth = [ROLL.omega, ROLL.zeta, ROLL.quadratic, ROLL.decrement(from_rad), TAU / (ROLL.omega * root)];
    for method in BOTH {
        let mut counts = [Count::default(); 5];
        for seed in 0..campaigns {
            let noise_deg = [0.005, 0.02, 0.05, 0.1][(seed % 4) as usize];
            let largest = 12.0 + (seed % 9) as f64;
            let logged = ROLL.campaign(100 + seed, f64::to_radians(noise_deg), [largest, largest - 2.0, largest - 4.0]);
            let fit = fitted(method, &logged, &alone());
            let rates = fit.rates();
            let (decrement, combined) = rates.propagated(&|x| rates.decrement(x, from_rad), Vec::new());
            let intervals = [
                fit.interval_95(0).unwrap(),
                derived(&fit, "zeta").1,
                fit.interval_95(2).unwrap(),
                combined.unwrap().interval(decrement.unwrap()),
                derived(&fit, "damped_period").1,
            ];
            for ((count, [low, high]), truth) in counts.iter_mut().zip(intervals).zip(truth) {
                count.add(low <= truth && truth <= high);
            }
        }
        for (name, count) in names.iter().zip(&counts) {
            println!("{} {name}: {}", method.name(), count.rate());
            assert!(count.z_score(0.95) > -z_limit(0.01, 10), "{} {name}: {}", method.name(), count.rate());
        }
    }
}
