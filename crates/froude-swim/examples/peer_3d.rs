//! Accelerations and paths in three dimensions for comparison with other programs; numbers come and go as little-endian doubles on standard input and output.
//!
//! | call | input | output |
//! | --- | --- | --- |
//! | `peer_3d accelerations` | [`Robot`], then of each state q (4), head (6), φ, φ̇, τ | of each state the rate of the head (6), φ̈ |
//! | `peer_3d path` | [`Robot`], k_p, k_d, amplitude, frequency, phase, step, steps, steps between rows | of each row the centre of mass, m |
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::io::{Read, Write};

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_swim::drive::{Following, Motor, Servo};
use froude_swim::driven::Driven;
use froude_swim::dynamics::Dynamics;
use froude_swim::engine::{Given, Joints};
use froude_swim::gait::{Envelope, Gait};
use froude_swim::spatial::attitude::{LEVEL, world_from_body};
use froude_swim::spatial::chain::{Chain, Link};
use froude_swim::spatial::drag::LinkDrag;
use froude_swim::spatial::engine::{Head, Workspace};
use froude_swim::spatial::vector::{Axis, Inertia};

fn main() {
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let numbers: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let (chain, rest) = robot(&numbers);
    let out = match std::env::args().nth(1).expect("accelerations or path").as_str() {
        "accelerations" => accelerations(&chain, rest),
        "path" => path(&chain, rest),
        other => panic!("there is no {other}"),
    };
    let bytes: Vec<u8> = out.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::io::stdout().write_all(&bytes).unwrap();
}

/// n; of each link half-length, mass, three inertias, centre of mass (3), buoyancy N, its centre (3), drag along, sideways, upright and of roll (2 each); of each joint 0 for yaw and 1 for pitch.
type Robot = [f64];
const OF_A_LINK: usize = 20;

fn robot(x: &Robot) -> (Chain, &[f64]) {
    let (n, rest) = (x[0] as usize, &x[1..]);
    let (links, rest) = rest.split_at(OF_A_LINK * n);
    let (joints, rest) = rest.split_at(n - 1);
    let link = |x: &[f64]| {
        let centre = [x[5], x[6], x[7]];
        Link {
            half_length_m: x[0],
            rigid: Inertia::rigid(x[1], [[x[2], 0.0, 0.0], [0.0, x[3], 0.0], [0.0, 0.0, x[4]]], centre),
            added: Inertia::default(),
            drag: LinkDrag {
                along: [x[12], x[13]],
                sideways: [x[14], x[15]],
                upright: [x[16], x[17]],
                cross: None,
                roll: [x[18], x[19]],
            },
            weight_n: x[1] * GRAVITY_M_S2,
            centre_of_mass_m: centre,
            buoyancy_n: x[8],
            centre_of_buoyancy_m: [x[9], x[10], x[11]],
        }
    };
    let axis = |x: &f64| if *x == 0.0 { Axis::Yaw } else { Axis::Pitch };
    let chain =
        Chain { links: links.chunks_exact(OF_A_LINK).map(link).collect(), joints: joints.iter().map(axis).collect() };
    (chain, rest)
}

fn accelerations(chain: &Chain, states: &[f64]) -> Vec<f64> {
    let j = chain.joints.len();
    let (mut work, mut out) = (Workspace::new(chain), Vec::new());
    for state in states.chunks_exact(10 + 3 * j) {
        let attitude = std::array::from_fn(|k| state[k]);
        let head = Head { motion: std::array::from_fn(|k| state[4 + k]), down: world_from_body(attitude)[2] };
        let (angle, rest) = state[10..].split_at(j);
        let (rate, torque) = rest.split_at(j);
        out.extend(work.evaluate(chain, head, Joints { angle, rate }, Given::Torque(torque)).unwrap());
        out.extend(&work.answer);
    }
    out
}

fn path(chain: &Chain, x: &[f64]) -> Vec<f64> {
    let gait = Gait::wave(x[2], x[3], x[4], Envelope::Lateral);
    let (h, steps, every) = (x[5], x[6] as usize, x[7] as usize);
    let how = Following { stiffness_n_m: x[0], damping_n_m_s: x[1], ..Following::default() };
    let (following, motor) = (vec![how; chain.joints.len()], Motor::default());
    let mut driven = Driven::new(chain, Servo::new(&gait, &following, &motor));
    let mut state = vec![0.0; driven.size()];
    state[3..7].copy_from_slice(&LEVEL);
    let mut out = Vec::new();
    for i in 0..=steps {
        if i % every == 0 {
            out.extend(Dynamics::centre_m(chain, &std::array::from_fn(|k| state[k]), &state[7..]));
        }
        driven.step(i as f64 * h, h, &mut state).unwrap();
    }
    out
}
