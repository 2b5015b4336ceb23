//! A swimmer in three dimensions whose joints are driven by torques, over time.
//!
//! **State**, one number after the other: place of the head (3), how it lies (4), φ (n − 1), motion of the head through the water in its own axes (6), φ̇ (n − 1), and the integrals of the powers
//! ([`Energy`]).
//!
//! **Units.** SI.

// Each test program uses a part of it.
#![allow(dead_code)]

use froude_swim::drive::Drive;
use froude_swim::driven::Energy;
use froude_swim::engine::{Given, Joints};
use froude_swim::spatial::attitude::{rate, to_world, unit, world_from_body};
use froude_swim::spatial::chain::{Chain, Pose};
use froude_swim::spatial::engine::{Head, Workspace};
use froude_swim::spatial::vector::{Motion, cross, parts};

/// Number of integrals.
const ENERGIES: usize = 5;

/// A chain with its drive.
#[derive(Debug, Clone)]
pub struct Driven<'a, D> {
    /// Its links.
    pub chain: &'a Chain,
    /// What drives its joints.
    pub drive: D,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 3],
    /// Memory of the engine.
    pub work: Workspace,
    /// Torques of the motors at the last evaluation, N m.
    pub torque: Vec<f64>,
    /// The same less friction.
    net: Vec<f64>,
    stages: [Vec<f64>; 3],
}

impl<'a, D: Drive> Driven<'a, D> {
    /// In still water.
    pub fn new(chain: &'a Chain, drive: D) -> Self {
        let (work, torque) = (Workspace::new(chain), vec![0.0; chain.joints.len()]);
        let stages = [(); 3].map(|()| vec![0.0; 13 + 2 * chain.joints.len() + ENERGIES]);
        Self { chain, drive, current_m_s: [0.0; 3], work, net: torque.clone(), torque, stages }
    }

    /// Length of a state.
    pub fn size(&self) -> usize {
        self.stages[0].len()
    }

    /// Where an integral stands in a state.
    pub fn at(&self, energy: Energy) -> usize {
        13 + 2 * self.chain.joints.len() + energy as usize
    }

    /// Where the head's motion stands in a state.
    pub fn head_at(&self) -> usize {
        7 + self.chain.joints.len()
    }

    /// Where the head of a state lies.
    pub fn pose(state: &[f64]) -> Pose {
        let attitude = std::array::from_fn(|k| state[3 + k]);
        Pose { place_m: std::array::from_fn(|k| state[k]), world_from_link: world_from_body(attitude) }
    }

    /// Rates of a state; `None` where an inertia is not positive.
    pub fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        let j = self.chain.joints.len();
        let (attitude, angle) = (std::array::from_fn(|k| state[3 + k]), &state[7..7 + j]);
        let (motion, joint_rate): (Motion, _) = (std::array::from_fn(|k| state[7 + j + k]), &state[13 + j..13 + 2 * j]);
        self.drive.torque(time_s, angle, joint_rate, &mut self.torque);
        let mut energy = [0.0; ENERGIES];
        for i in 0..j {
            let (torque, rate) = (self.torque[i], joint_rate[i]);
            let friction = self.drive.friction_n_m(i, rate);
            self.net[i] = torque - friction;
            let power = torque * rate;
            energy[Energy::Work as usize] += power;
            energy[Energy::Positive as usize] += power.max(0.0);
            energy[Energy::Absolute as usize] += power.abs();
            energy[Energy::Friction as usize] += friction * rate;
        }
        let world = world_from_body(attitude);
        let joints = Joints { angle, rate: joint_rate };
        let head = Head { motion, down: world[2] };
        let turned = self.work.evaluate(self.chain, head, joints, Given::Torque(&self.net))?;
        energy[Energy::Loss as usize] = self.work.loss_w;
        let [turning, moving] = parts(motion);
        let over_ground = to_world(&world, moving);
        for k in 0..3 {
            rates[k] = over_ground[k] + self.current_m_s[k];
        }
        rates[3..7].copy_from_slice(&rate(attitude, turning));
        rates[7..7 + j].copy_from_slice(joint_rate);
        rates[7 + j..13 + j].copy_from_slice(&turned);
        rates[13 + j..13 + 2 * j].copy_from_slice(&self.work.answer);
        rates[13 + 2 * j..].copy_from_slice(&energy);
        Some(())
    }

    /// One step of Runge and Kutta's fourth order, in place, which ends on the unit sphere; `None` where an inertia is not positive, and the state stays.
    pub fn step(&mut self, time_s: f64, h: f64, state: &mut [f64]) -> Option<()> {
        let mut stages = std::mem::take(&mut self.stages);
        let found = self.mean_rate(time_s, h, state, &mut stages);
        if found.is_some() {
            add(state, h, &stages[0]);
            let attitude = unit(std::array::from_fn(|k| state[3 + k]));
            state[3..7].copy_from_slice(&attitude);
        }
        self.stages = stages;
        found
    }

    /// The weighed mean of the four rates of a step, into the first of the three.
    fn mean_rate(&mut self, time_s: f64, h: f64, state: &[f64], [mean, rate, there]: &mut [Vec<f64>; 3]) -> Option<()> {
        self.rates(time_s, state, rate)?;
        mean.fill(0.0);
        add(mean, 1.0 / 6.0, rate);
        for (part, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            there.copy_from_slice(state);
            add(there, part * h, rate);
            self.rates(time_s + part * h, there, rate)?;
            add(mean, weight / 6.0, rate);
        }
        Some(())
    }

    /// Kinetic and potential energy, J, of the state that was evaluated last.
    pub fn energy_j(&self, state: &[f64]) -> [f64; 2] {
        [self.chain.kinetic_j(self.work.motions()), self.chain.potential_j(Self::pose(state), &state[7..])]
    }

    /// Momentum of body and water, kg m/s, and its moment about the tank's origin, kg m²/s, of the state that was evaluated last.
    pub fn momentum(&self, state: &[f64]) -> [[f64; 3]; 2] {
        let mut sum = [[0.0; 3]; 2];
        let poses = self.chain.poses(Self::pose(state), &state[7..]);
        for ((link, motion), pose) in self.chain.links.iter().zip(self.work.motions()).zip(poses) {
            let [turning, moving] = parts(link.inertia().times(*motion)).map(|x| to_world(&pose.world_from_link, x));
            let about = cross(pose.place_m, moving);
            for k in 0..3 {
                sum[0][k] += moving[k];
                sum[1][k] += turning[k] + about[k];
            }
        }
        sum
    }
}

/// to += by · of.
fn add(to: &mut [f64], by: f64, of: &[f64]) {
    for (to, of) in to.iter_mut().zip(of) {
        *to += by * of;
    }
}
