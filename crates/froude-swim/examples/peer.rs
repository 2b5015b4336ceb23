//! Accelerations, paths and times for comparison with other programs; numbers come and go as little-endian doubles on standard input and output.
//!
//! | call | input | output |
//! | --- | --- | --- |
//! | `peer accelerations` | n, m, J, l, then of each state head (ω, u, v), φ, φ̇, τ | of each state (ω̇, u̇, v̇), φ̈ |
//! | `peer path` | [`Problem`], steps between rows | of each row the centre of mass, m |
//! | `peer time` | [`Problem`] | a line of JSON: least microseconds a step of three rounds, mean speed of the centre of mass |
//! | `peer forward` | n | a line of JSON: least microseconds of an evaluation |
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::io::{Read, Write};
use std::time::Instant;

use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::drag::{LinkDrag, Turning};
use froude_swim::drive::{Following, Motor, Servo};
use froude_swim::driven::Driven;
use froude_swim::engine::{Given, Joints, Workspace};
use froude_swim::gait::{Envelope, Gait};
use froude_swim::planar::Inertia;

fn main() {
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let numbers: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let mode = std::env::args().nth(1).expect("accelerations, path, time or forward");
    let out = match mode.as_str() {
        "accelerations" => accelerations(&numbers),
        "path" => path(&numbers),
        "time" => return time(&numbers),
        "forward" => return forward(numbers[0] as usize),
        other => panic!("there is no {other}"),
    };
    let bytes: Vec<u8> = out.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::io::stdout().write_all(&bytes).unwrap();
}

fn chain(n: usize, mass: f64, inertia: f64, l: f64, sway: f64, drag: LinkDrag) -> Chain {
    let link = Link {
        half_length_m: l,
        rigid: Inertia::rigid(mass, inertia, 0.0),
        added: Inertia { turn: sway * l * l / 3.0, y: sway, ..Inertia::default() },
        drag,
    };
    Chain { links: vec![link; n], added_mass: AddedMass::Full }
}

fn accelerations(numbers: &[f64]) -> Vec<f64> {
    let [n, mass, inertia, l, states @ ..] = numbers else { panic!("too few numbers") };
    let n = *n as usize;
    let chain = chain(n, *mass, *inertia, *l, 0.0, LinkDrag::NONE);
    let mut work = Workspace::new(&chain);
    let mut out = Vec::new();
    for state in states.chunks_exact(3 + 3 * (n - 1)) {
        let (head, joints) = state.split_at(3);
        let (angle, rest) = joints.split_at(n - 1);
        let (rate, torque) = rest.split_at(n - 1);
        let head = [head[0], head[1], head[2]];
        out.extend(work.evaluate(head, Joints { angle, rate }, Given::Torque(torque)).unwrap());
        out.extend(&work.answer);
    }
    out
}

/// n, mass, inertia, half-length, added mass across; drag along and across by v and v|v|; kp, kd, viscous; amplitude, frequency, phase; step, steps.
struct Problem {
    chain: Chain,
    following: Vec<Following>,
    gait: Gait,
    h: f64,
    steps: usize,
}

impl Problem {
    fn of(x: &[f64]) -> Self {
        let n = x[0] as usize;
        let drag = LinkDrag { along: [x[5], x[6]], across: [x[7], x[8]], cross: None, turning: Turning::Strip };
        let servo =
            Following { stiffness_n_m: x[9], damping_n_m_s: x[10], viscous_n_m_s: x[11], ..Following::default() };
        Self {
            chain: chain(n, x[1], x[2], x[3], x[4], drag),
            following: vec![servo; n - 1],
            gait: Gait::wave(x[12], x[13], x[14], Envelope::Lateral),
            h: x[15],
            steps: x[16] as usize,
        }
    }

    /// Calls with the place of the centre of mass at the beginning and after every so many steps; at rest and straight at first.
    fn go(&self, every: usize, see: &mut dyn FnMut([f64; 2])) {
        let motor = Motor::default();
        let mut driven = Driven::new(&self.chain, Servo::new(&self.gait, &self.following, &motor));
        let mut state = vec![0.0; driven.size()];
        let j = self.chain.joints();
        see(self.chain.centre_m([state[0], state[1]], state[2], &state[3..3 + j]));
        for i in 0..self.steps {
            driven.step(i as f64 * self.h, self.h, &mut state).unwrap();
            if (i + 1) % every == 0 {
                see(self.chain.centre_m([state[0], state[1]], state[2], &state[3..3 + j]));
            }
        }
    }
}

fn path(numbers: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    Problem::of(numbers).go(numbers[17] as usize, &mut |place| out.extend(place));
    out
}

fn time(numbers: &[f64]) {
    let problem = Problem::of(numbers);
    let (mut least, mut ends) = (f64::INFINITY, Vec::new());
    for _ in 0..3 {
        ends.clear();
        let start = Instant::now();
        problem.go(problem.steps, &mut |place| ends.push(place));
        least = least.min(start.elapsed().as_secs_f64());
    }
    let way = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
    let (us, speed) = (1e6 * least / problem.steps as f64, way / (problem.h * problem.steps as f64));
    println!("{{\"us_per_step\": {us}, \"speed_m_s\": {speed}}}");
}

fn forward(n: usize) {
    let drag = LinkDrag { along: [0.0, 0.6], across: [0.65, 20.0], cross: None, turning: Turning::Strip };
    let chain = chain(n, 1.343, 4e-3, 0.09, 1.653, drag);
    let mut work = Workspace::new(&chain);
    let (angle, rate, torque) = (vec![0.3; n - 1], vec![0.2; n - 1], vec![0.1; n - 1]);
    let rounds = 20_000;
    let mut least = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        for i in 0..rounds {
            let head = [0.1, 0.2, 1e-9 * f64::from(i)];
            let joints = Joints { angle: &angle, rate: &rate };
            std::hint::black_box(work.evaluate(head, joints, Given::Torque(&torque)).unwrap());
        }
        least = least.min(start.elapsed().as_secs_f64());
    }
    println!("{{\"us\": {}}}", 1e6 * least / f64::from(rounds));
}
