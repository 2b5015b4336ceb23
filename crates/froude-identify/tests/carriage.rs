//! Drag from simulated campaigns of the pinned scenario.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]
use froude_identify::carriage::calibration::ForcePerVolt;
use froude_identify::carriage::coefficient::{Coefficient, Method, coefficient};
use froude_identify::carriage::simulate::Scenario;
use froude_identify::carriage::{BodyState, DragSetup, Uncertain, fsm, mcd};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

fn one(scenario: &Scenario, seed: u64) -> [Coefficient; 2] {
    let runs = scenario.runs(seed);
    let mut rng = Pcg64::seed_from_u64(seed + 1_000_000);
    let z: f64 = StandardNormal.sample(&mut rng);
    let mut setup = DragSetup::of_the_paper();
    let k = scenario.force_per_volt_n() * (1.0 + 0.005 * z);
    setup.calibration = Some(ForcePerVolt { force_per_volt_n: Uncertain::new(k, 0.005 * k) });
    let wet: Vec<_> = runs.iter().map(|r| r.view()).filter(|r| r.body == BodyState::Wet).collect();
    let dry: Vec<_> = runs.iter().map(|r| r.view()).filter(|r| r.body == BodyState::Dry).collect();
    let a = wet
        .iter()
        .map(|w| mcd::point(w, dry.iter().find(|d| d.is_partner_of(w)).unwrap(), setup.force_per_volt_n(), setup.steady).unwrap())
        .collect();
    let b = wet.iter().map(|w| fsm::point(w, 0.2, setup.steady).unwrap()).collect();
    [coefficient(Method::Mcd, a, &setup, None).unwrap(), coefficient(Method::Fsm, b, &setup, None).unwrap()]
}

#[test]
fn figures() {
    for out in [true, false] {
        for viscous in [false, true] {
            for d in [20.0, 10.0] {
                let mut s = Scenario::pinned(d);
                s.out_and_back = out;
                s.viscous_changes = viscous;
                let n = 60;
                let mut sum = [[0.0; 4]; 2];
                for seed in 0..n {
                    for (k, c) in one(&s, seed).iter().enumerate() {
                        let e = c.value / d - 1.0;
                        let [l, h] = c.interval_95.unwrap();
                        sum[k][0] += e;
                        sum[k][1] += e * e;
                        sum[k][2] += f64::from(u8::from((l..=h).contains(&d)));
                        sum[k][3] += c.standard.unwrap() / d;
                    }
                }
                for (k, name) in ["mcd", "fsm"].iter().enumerate() {
                    let m = n as f64;
                    println!(
                        "out {out} viscous {viscous} d {d} {name}: bias {:.3} % rms {:.3} % cover {} of {n} u {:.3} %",
                        100.0 * sum[k][0] / m,
                        100.0 * (sum[k][1] / m).sqrt(),
                        sum[k][2],
                        100.0 * sum[k][3] / m
                    );
                }
            }
        }
    }
}
