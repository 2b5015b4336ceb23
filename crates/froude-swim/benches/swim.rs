//! What a step, an evaluation and a gait cost. MuJoCo's step of the fourth order (10 links, no added mass) takes 25 µs, Pinocchio's accelerations of 50 links 19 µs.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::Bencher;
use divan::counter::ItemsCount;
use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::drag::{LinkDrag, Turning};
use froude_swim::drive::{Following, Motor, Servo};
use froude_swim::driven::Driven;
use froude_swim::engine::{Given, Joints, Workspace};
use froude_swim::gait::{Envelope, Gait};
use froude_swim::path::Swimmer;
use froude_swim::planar::Inertia;

fn main() {
    divan::main();
}

fn chain(n: usize) -> Chain {
    let (mass, sway, l) = (1.343, 1.653, 0.09);
    let link = Link {
        half_length_m: l,
        rigid: Inertia::rigid(mass, mass * l * l / 3.0, 0.0),
        added: Inertia { turn: sway * l * l / 3.0, y: sway, ..Inertia::default() },
        drag: LinkDrag { along: [0.0, 0.6], across: [0.65, 20.0], cross: None, turning: Turning::Strip },
    };
    Chain { links: vec![link; n], added_mass: AddedMass::Full }
}

fn gait(n: usize) -> Gait {
    Gait::wave(3.0_f64.min(0.15 * n as f64) / n as f64, 1.4, std::f64::consts::TAU / n as f64, Envelope::Lateral)
}

/// A second of steps of 1 ms with servos at the joints.
#[divan::bench(args = [5, 10, 20, 50, 100, 200])]
fn second_of_driven_steps(bencher: Bencher<'_, '_>, n: usize) {
    let (chain, gait, motor) = (chain(n), gait(n), Motor::default());
    let following = vec![Following { stiffness_n_m: 2.0, damping_n_m_s: 0.1, ..Following::default() }; n - 1];
    let mut driven = Driven::new(&chain, Servo::new(&gait, &following, &motor));
    bencher.counter(ItemsCount::new(1000_usize)).bench_local(|| {
        let mut state = vec![0.0; driven.size()];
        for i in 0..1000 {
            driven.step(1e-3 * f64::from(i), 1e-3, &mut state).unwrap();
        }
        state
    });
}

/// Accelerations alone.
#[divan::bench(args = [10, 50])]
fn forward_dynamics(bencher: Bencher<'_, '_>, n: usize) {
    let chain = chain(n);
    let (angle, rate, torque) = (vec![0.3; n - 1], vec![0.2; n - 1], vec![0.1; n - 1]);
    let mut work = Workspace::new(&chain);
    bencher.counter(ItemsCount::new(n)).bench_local(|| {
        work.evaluate([0.1, 0.2, 0.0], Joints { angle: &angle, rate: &rate }, Given::Torque(&torque)).unwrap()
    });
}

/// A gait to its periodic state.
#[divan::bench(args = [10, 50])]
fn periodic_gait(bencher: Bencher<'_, '_>, n: usize) {
    let (chain, gait) = (chain(n), gait(n));
    bencher.bench_local(|| Swimmer::new(&chain, &gait).periodic(400).unwrap());
}
