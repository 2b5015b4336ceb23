//! Accelerations of a chain in three dimensions in O(n): articulated bodies.
//!
//! From head to tail each link gets its motion and where down is; from tail to head each joint is taken out, and what hangs on it becomes inertia and load of the link before; then the head is one body.
//! A joint at φ moves the link behind it by S φ̇, S = −(axis, axis × its way from the joint): a torque τ on φ is the component Sᵀ f of what passes the joint.
//!
//! All motions are those through the water. A uniform steady current is a frame that moves evenly: it enters the path only.
//!
//! # Source
//!
//! Featherstone (2008), *Rigid Body Dynamics Algorithms*, 7.3 (articulated bodies), 9.2 (hybrid dynamics) and 9.3 (free base).

use super::chain::Chain;
use super::vector::{Axis, Inertia, Load, Motion, Turn, about, carried, dot, turned};
use crate::engine::{Given, Joints};

/// A link with all that hangs on it.
#[derive(Debug, Clone, Copy, Default)]
struct Hanging {
    inertia: Inertia,
    load: Load,
}

/// The joint before a link.
#[derive(Debug, Clone, Copy, Default)]
struct Joint {
    turn: Turn,
    /// S.
    moves: Motion,
    /// What its turning axes add to the acceleration behind it.
    bias: Motion,
    /// I S of what hangs on it.
    carries: Load,
    /// Sᵀ I S, and what the torque has left for it.
    free: [f64; 2],
}

/// Inertias of a chain with the memory of one evaluation.
#[derive(Debug, Clone)]
pub struct Workspace {
    inertias: Vec<Inertia>,
    hanging: Vec<Hanging>,
    joints: Vec<Joint>,
    motions: Vec<Motion>,
    /// Torque of each joint where it is prescribed, else its angular acceleration.
    pub answer: Vec<f64>,
    /// Power that drag takes, W.
    pub loss_w: f64,
}

/// The head of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Head {
    /// Its motion through the water.
    pub motion: Motion,
    /// Where down is in its axes, a unit vector.
    pub down: [f64; 3],
}

impl Workspace {
    /// For a chain.
    #[must_use]
    pub fn new(chain: &Chain) -> Self {
        let n = chain.links.len();
        Self {
            inertias: chain.links.iter().map(super::chain::Link::inertia).collect(),
            hanging: vec![Hanging::default(); n],
            joints: vec![Joint::default(); n],
            motions: vec![[0.0; 6]; n],
            answer: vec![0.0; chain.joints.len()],
            loss_w: 0.0,
        }
    }

    /// Motions of the links of the last evaluation.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Rate of the head's motion in its own axes; the joints' part is in `answer`. `None` where an inertia is not positive.
    pub fn evaluate(&mut self, chain: &Chain, head: Head, joints: Joints<'_>, given: Given<'_>) -> Option<Motion> {
        self.outwards(chain, head, joints);
        let n = chain.links.len();
        for i in (1..n).rev() {
            let Hanging { inertia, load } = self.hanging[i];
            let joint = &mut self.joints[i];
            let carries = inertia.times(joint.moves);
            joint.carries = carries;
            let from_bias = inertia.times(joint.bias);
            let (passed, load) = match given {
                Given::Torque(torque) => {
                    let d = dot(carries, joint.moves);
                    if d.is_nan() || d <= 0.0 {
                        return None;
                    }
                    let left = torque[i - 1] - dot(load, joint.moves);
                    joint.free = [d, left];
                    // What the joint gives by itself answers the bias too.
                    let by_joint = (left - dot(carries, joint.bias)) / d;
                    let passed = inertia.less(carries, d);
                    (passed, std::array::from_fn(|k| load[k] + from_bias[k] + by_joint * carries[k]))
                }
                Given::Acceleration(rate) => {
                    (inertia, std::array::from_fn(|k| load[k] + from_bias[k] + rate[i - 1] * carries[k]))
                }
            };
            let (own, before) = (chain.links[i].half_length_m, chain.links[i - 1].half_length_m);
            let inertia = joint.turn.inertia_before(&passed.about(-own)).about(-before);
            let load: Load = about(joint.turn.load_before(about(load, -own)), -before);
            let hangs = &mut self.hanging[i - 1];
            hangs.inertia = hangs.inertia.plus(&inertia);
            for k in 0..6 {
                hangs.load[k] += load[k];
            }
        }
        let first = &self.hanging[0];
        let head = first.inertia.solve(first.load.map(|l| -l))?;
        let mut a = head;
        for i in 1..n {
            let joint = &self.joints[i];
            let (own, before) = (chain.links[i].half_length_m, chain.links[i - 1].half_length_m);
            let mut behind = carried(joint.turn.motion_behind(carried(a, -before)), -own);
            for k in 0..6 {
                behind[k] += joint.bias[k];
            }
            let Hanging { inertia, load } = &self.hanging[i];
            let add = |a: &mut Motion, rate: f64| {
                for k in 0..6 {
                    a[k] += rate * joint.moves[k];
                }
            };
            self.answer[i - 1] = match given {
                Given::Torque(_) => {
                    let [d, left] = joint.free;
                    let found = (left - dot(joint.carries, behind)) / d;
                    add(&mut behind, found);
                    found
                }
                Given::Acceleration(rate) => {
                    add(&mut behind, rate[i - 1]);
                    dot(inertia.times(behind), joint.moves) + dot(*load, joint.moves)
                }
            };
            a = behind;
        }
        Some(head)
    }

    /// Motions of the links, and what each has by itself.
    fn outwards(&mut self, chain: &Chain, head: Head, joints: Joints<'_>) {
        let Head { mut motion, mut down } = head;
        self.loss_w = 0.0;
        for (i, link) in chain.links.iter().enumerate() {
            let own = link.half_length_m;
            if i > 0 {
                let (axis, rate) = (chain.joints[i - 1], joints.rate[i - 1]);
                let turn = Turn::new(axis, joints.angle[i - 1]);
                let before = chain.links[i - 1].half_length_m;
                down = turn.behind(down);
                let moves = moves(axis, own);
                let by_joint = moves.map(|s| s * rate);
                motion = carried(turn.motion_behind(carried(motion, -before)), -own);
                for k in 0..6 {
                    motion[k] += by_joint[k];
                }
                self.joints[i] = Joint { turn, moves, bias: passing(motion, by_joint), ..Joint::default() };
            }
            self.motions[i] = motion;
            let inertia = self.inertias[i];
            self.hanging[i] = Hanging { inertia, load: link.bias(&inertia, motion, down) };
            self.loss_w -= dot(link.drag.load(own, motion), motion);
        }
    }
}

/// S of a joint, about the centre of a link that lies half a length behind it.
fn moves(axis: Axis, half_length_m: f64) -> Motion {
    let mut turning = [0.0; 6];
    turning[axis.index()] = -1.0;
    carried(turning, -half_length_m)
}

/// What axes that turn with a motion make of another one: m × n.
fn passing(m: Motion, n: Motion) -> Motion {
    // (ω × ω', ω × v' + v × ω') is the dual of what momenta have.
    let swapped = |x: Motion| [x[3], x[4], x[5], x[0], x[1], x[2]];
    swapped(turned(m, swapped(n)))
}
