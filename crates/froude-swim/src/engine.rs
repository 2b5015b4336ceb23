//! Accelerations of a chain in O(n): articulated bodies.
//!
//! From head to tail the motions, from tail to head the articulated inertia I and bias p of each link with all behind it, from head to tail the accelerations. A joint
//! that a torque drives passes I − I s sᵀI/(sᵀI s) and p with its torque; one whose angle is prescribed passes I itself and p with its acceleration, and its
//! torque follows.
//!
//! All motions are those through the water. A uniform steady current is a frame that moves evenly: it enters the path only.
//!
//! # Source
//!
//! Featherstone (2008), *Rigid Body Dynamics Algorithms*, 7.2 and 9.2 (hybrid dynamics).

use crate::chain::Chain;
use crate::planar::{Inertia, Joint, Load, Motion, dot};

/// Memory of one evaluation.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    joints: Vec<Joint>,
    motion: Vec<Motion>,
    bias: Vec<Motion>,
    inertia: Vec<Inertia>,
    load: Vec<Load>,
    momentum: Vec<Load>,
    scale: Vec<f64>,
    free: Vec<f64>,
    /// Rate of the motion of each link in its own axes, of the last evaluation.
    pub acceleration: Vec<Motion>,
    /// Torque of each joint where it is prescribed, else its angular acceleration.
    pub answer: Vec<f64>,
    /// Power that drag takes, W.
    pub loss_w: f64,
}

/// Joints of a state.
#[derive(Debug, Clone, Copy)]
pub struct Joints<'a> {
    /// φ, rad.
    pub angle: &'a [f64],
    /// φ̇, rad/s.
    pub rate: &'a [f64],
}

/// What is given of each joint.
#[derive(Debug, Clone, Copy)]
pub enum Given<'a> {
    /// φ̈, rad/s²: torques are the answer.
    Acceleration(&'a [f64]),
    /// Torque on φ, N m: accelerations are the answer.
    Torque(&'a [f64]),
}

impl Workspace {
    /// For a chain of so many links.
    #[must_use]
    pub fn new(links: usize) -> Self {
        let joints = links.saturating_sub(1);
        Self {
            joints: vec![Joint::default(); joints],
            motion: vec![[0.0; 3]; links],
            bias: vec![[0.0; 3]; joints],
            inertia: vec![Inertia::default(); links],
            load: vec![[0.0; 3]; links],
            momentum: vec![[0.0; 3]; joints],
            scale: vec![0.0; joints],
            free: vec![0.0; joints],
            acceleration: vec![[0.0; 3]; links],
            answer: vec![0.0; joints],
            loss_w: 0.0,
        }
    }

    /// Rate of the head's motion in its own axes; the joints' part is in `answer`. `None` where an inertia is not positive.
    ///
    /// `head` is its motion through the water.
    pub fn evaluate(&mut self, chain: &Chain, head: Motion, joints: Joints<'_>, given: Given<'_>) -> Option<Motion> {
        self.moves(chain, head, joints);
        for i in (0..self.joints.len()).rev() {
            let (joint, inertia, c) = (self.joints[i], self.inertia[i + 1], self.bias[i]);
            let s = joint.axis();
            let momentum = inertia.times(s);
            let mut p = add(self.load[i + 1], inertia.times(c));
            let passed = match given {
                Given::Acceleration(rates) => {
                    p = add(p, scaled(momentum, rates[i]));
                    inertia
                }
                Given::Torque(torques) => {
                    let d = joint.on_axis(momentum);
                    if d.is_nan() || d <= 0.0 {
                        return None;
                    }
                    // What the torque has left for the joint; p already holds I c.
                    let free = torques[i] - joint.on_axis(p);
                    p = add(p, scaled(momentum, free / d));
                    (self.scale[i], self.free[i], self.momentum[i]) = (1.0 / d, free, momentum);
                    inertia.without(momentum, 1.0 / d)
                }
            };
            self.inertia[i] = self.inertia[i].plus(&joint.inertia_back(&passed));
            self.load[i] = add(self.load[i], joint.back(p));
        }
        let head = self.inertia[0].solve(scaled(self.load[0], -1.0))?;
        self.acceleration[0] = head;
        for i in 0..self.joints.len() {
            let joint = self.joints[i];
            let carried = add(joint.forward(self.acceleration[i]), self.bias[i]);
            let rate = match given {
                Given::Acceleration(rates) => rates[i],
                // `free` has I c in it: of what is carried only the part of the link before remains.
                Given::Torque(_) => {
                    (self.free[i] - dot(self.momentum[i], joint.forward(self.acceleration[i]))) * self.scale[i]
                }
            };
            let own = add(carried, scaled(joint.axis(), rate));
            self.acceleration[i + 1] = own;
            self.answer[i] = match given {
                Given::Acceleration(_) => joint.on_axis(add(self.inertia[i + 1].times(own), self.load[i + 1])),
                Given::Torque(_) => rate,
            };
        }
        Some(head)
    }

    /// Motions, inertias and loads of the links by themselves.
    fn moves(&mut self, chain: &Chain, head: Motion, joints: Joints<'_>) {
        self.loss_w = 0.0;
        let mut motion = head;
        for (i, link) in chain.links.iter().enumerate() {
            if i > 0 {
                let joint = Joint::new(joints.angle[i - 1], chain.links[i - 1].half_length_m, link.half_length_m);
                let carried = joint.forward(motion);
                self.bias[i - 1] = joint.bias(carried, joints.rate[i - 1]);
                motion = add(carried, scaled(joint.axis(), joints.rate[i - 1]));
                self.joints[i - 1] = joint;
            }
            let drag = link.drag.load(link.half_length_m, motion);
            self.loss_w -= dot(drag, motion);
            self.motion[i] = motion;
            self.inertia[i] = link.inertia();
            self.load[i] = add(chain.bias(link, motion), scaled(drag, -1.0));
        }
    }

    /// Motions of the links of the last evaluation.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        &self.motion
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: [f64; 3], by: f64) -> [f64; 3] {
    [a[0] * by, a[1] * by, a[2] * by]
}
