//! The engine against the closed form, for random chains and states.

use crate::closed_form::{Absolute, motions, places, rates};
use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::drag::{Cross, LinkDrag, Turning};
use froude_swim::engine::{Given, Joints, Workspace};
use froude_swim::planar::Inertia;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn chain(n: usize, rng: &mut Pcg64Mcg) -> Chain {
    let mut any = |low: f64, high: f64| rng.random_range(low..high);
    let link = |_| {
        let half_length_m = any(0.05, 0.12);
        let mass_kg = any(0.8, 1.6);
        let sway_kg = any(0.5, 2.0);
        // A22 and A26 of a strip whose added mass lies ahead of the centre; A11 small.
        let ahead_m = any(-0.02, 0.02);
        let added = Inertia {
            turn: sway_kg * (half_length_m.powi(2) / 3.0 + ahead_m * ahead_m),
            turn_y: sway_kg * ahead_m,
            x: any(0.0, 0.2),
            y: sway_kg,
            ..Inertia::default()
        };
        let turning = if any(0.0, 1.0) < 0.5 { Turning::Strip } else { Turning::Lumped([1e-3, 2e-3]) };
        let cross = Cross { of_speed: [any(-0.1, 0.1), any(0.0, 1.0)], smooth_m_s: 1e-2 };
        let drag = LinkDrag {
            along: [any(0.0, 0.2), any(0.0, 2.0)],
            across: [any(0.0, 0.5), any(0.0, 20.0)],
            cross: Some(cross),
            turning,
        };
        let rigid = Inertia::rigid(mass_kg, mass_kg * half_length_m.powi(2) / 3.0, any(-0.02, 0.02));
        Link { half_length_m, rigid, added, drag }
    };
    let links = (0..n).map(link).collect();
    Chain { links, added_mass: if n.is_multiple_of(2) { AddedMass::Full } else { AddedMass::Usr } }
}

/// Rounding grows with the chain: 1e-12 for each link, relative to the largest acceleration.
#[test]
fn the_engine_has_the_accelerations_of_the_closed_form() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for n in 1..=50 {
        let chain = chain(n, &mut rng);
        let g = places(&chain);
        let mut any = |size: f64| rng.random_range(-size..size);
        let state = Absolute {
            heading: (0..n).map(|_| any(1.5)).collect(),
            turn_rate: (0..n).map(|_| any(2.0)).collect(),
            velocity: [any(0.5), any(0.5)],
        };
        let torque: Vec<f64> = (1..n).map(|_| any(0.5)).collect();
        let expected = rates(&chain, &state, &torque).unwrap();
        let between = |x: &[f64]| x.windows(2).map(|w| w[0] - w[1]).collect::<Vec<f64>>();
        let (angle, rate) = (between(&state.heading), between(&state.turn_rate));
        let joints = Joints { angle: &angle, rate: &rate };
        let head = motions(&g, &state)[0];
        let mut work = Workspace::new(&chain);
        let found = work.evaluate(head, joints, Given::Torque(&torque)).unwrap();
        let acceleration = between(&expected.turn);
        let largest = expected.turn.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        let near = |a: f64, b: f64, what: &str| {
            assert!((a - b).abs() <= 1e-12 * n as f64 * largest, "{n} links, {what}: {a} {b}");
        };
        near(found[0], expected.turn[0], "head");
        for (a, b) in work.answer.iter().zip(&acceleration) {
            near(*a, *b, "joint");
        }
        // The centre of mass: Ẍ of the head less its way from it.
        let (s, c) = state.heading[0].sin_cos();
        let (u, v) = (found[1] - head[0] * head[2], found[2] + head[0] * head[1]);
        let way = |of: &dyn Fn(usize) -> f64| (0..n).map(|k| g[(0, k)] * of(k)).sum::<f64>();
        let x =
            way(&|k| state.heading[k].sin() * expected.turn[k] + state.heading[k].cos() * state.turn_rate[k].powi(2));
        let y =
            way(&|k| state.heading[k].cos() * expected.turn[k] - state.heading[k].sin() * state.turn_rate[k].powi(2));
        near(c * u - s * v + x, expected.velocity[0], "x");
        near(s * u + c * v - y, expected.velocity[1], "y");
        // Prescribed, the same accelerations need the same torques.
        let again = work.evaluate(head, joints, Given::Acceleration(&acceleration)).unwrap();
        near(again[0], found[0], "head, prescribed");
        for (a, b) in work.answer.iter().zip(&torque) {
            near(*a, *b, "torque");
        }
    }
}
