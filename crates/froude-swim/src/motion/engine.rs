//! Accelerations of a chain in O(n): articulated bodies.
//!
//! All is written in the head's axes, and the inertia and load of a link about the joint before it, at P. Each link by itself has α, the rate of its turning, and a, the acceleration of
//! P, with
//!
//! I (α, a) + p = what its joints put on it.
//!
//! From tail to head each joint is taken out. A torque τ on φ puts −τ on the link behind it and τ on the one before, and so the first row gives α by a: what is left is a force J a + g, which the link before
//! feels at its end. A joint whose angle is prescribed has α of the link before less φ̈, and passes all of I. The head is then one body, and from head to tail each link gets its acceleration.
//!
//! What links do by themselves (their motion, drag and inertia) is worked out four side by side; only the taking out goes from link to link.
//!
//! All motions are those through the water. A uniform steady current is a frame that moves evenly: it enters the path only.
//!
//! # Source
//!
//! Featherstone (2008), *Rigid Body Dynamics Algorithms*, 7.3 and 9.2 (hybrid dynamics).

use crate::chain::{AddedMass, Chain, Link};
use crate::drag::LinkDrag;
use crate::drag_lanes::{DragLanes, Four, LANES, Three};
use crate::planar::{Inertia, Load, Motion};
use crate::sine::sin_cos;

/// Numbers of four links that stay.
#[derive(Debug, Clone, Copy)]
struct Constants {
    half_length_m: Four,
    /// turn, turn_x, turn_y, x, xy, y of body and water.
    inertia: [Four; 6],
    /// Of what has momenta that turn with the axes.
    turning: [Four; 6],
    drag: DragLanes,
}

/// Numbers of four links at a moment.
#[derive(Debug, Clone, Copy, Default)]
struct Moment {
    heading: Four,
    turn_rate: Four,
    cos: Four,
    sin: Four,
    /// Velocity of the joint before the link.
    joint: [Four; 2],
    /// Motion of the link in its own axes.
    own: Three,
    /// Power that drag takes.
    loss_w: Four,
}

/// A link with all that hangs on it.
#[derive(Debug, Clone, Copy, Default)]
struct Hanging {
    inertia: Inertia,
    load: Load,
    /// Of the way to the next joint, m.
    way: [f64; 2],
    /// What the turning of the link adds to the acceleration of the next joint, m/s².
    towards: [f64; 2],
}

/// Links of a chain with the memory of one evaluation.
#[derive(Debug, Clone)]
pub struct Workspace {
    constants: Vec<Constants>,
    moments: Vec<Moment>,
    hanging: Vec<Hanging>,
    /// 1/turn of each joint that a torque drives, and what the torque has left for it.
    free: Vec<[f64; 2]>,
    motions: Vec<Motion>,
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
    /// For a chain.
    #[must_use]
    pub fn new(chain: &Chain) -> Self {
        let n = chain.links.len();
        let constants: Vec<Constants> = chain.links.chunks(LANES).map(|four| Constants::of(chain, four)).collect();
        Self {
            moments: vec![Moment::default(); constants.len()],
            constants,
            hanging: vec![Hanging::default(); n],
            free: vec![[0.0; 2]; n],
            motions: vec![[0.0; 3]; n],
            answer: vec![0.0; chain.joints()],
            loss_w: 0.0,
        }
    }

    /// Rate of the head's motion in its own axes; the joints' part is in `answer`. `None` where an inertia is not positive.
    ///
    /// `head` is its motion through the water.
    pub fn evaluate(&mut self, head: Motion, joints: Joints<'_>, given: Given<'_>) -> Option<Motion> {
        froude_lanes::run(Evaluate { work: self, head, joints, given })
    }

    /// Motions of the links of the last evaluation.
    #[must_use]
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// The same as part of a kernel.
    #[inline(always)]
    pub(crate) fn recursion(&mut self, head: Motion, joints: Joints<'_>, given: Given<'_>) -> Option<Motion> {
        self.places(head, joints);
        self.by_themselves();
        let n = self.hanging.len();
        for i in (1..n).rev() {
            let Hanging { inertia, load, .. } = self.hanging[i];
            let before = &mut self.hanging[i - 1];
            match given {
                Given::Torque(torque) => {
                    if inertia.turn.is_nan() || inertia.turn <= 0.0 {
                        return None;
                    }
                    let (d, left) = (1.0 / inertia.turn, -torque[i - 1] - load[0]);
                    self.free[i] = [d, left];
                    let (x, y) = (d * inertia.turn_x, d * inertia.turn_y);
                    let passed = Inertia {
                        x: inertia.x - x * inertia.turn_x,
                        xy: inertia.xy - x * inertia.turn_y,
                        y: inertia.y - y * inertia.turn_y,
                        ..Inertia::default()
                    };
                    before.load[0] -= torque[i - 1];
                    before.feels(&passed, [0.0, load[1] + x * left, load[2] + y * left]);
                }
                Given::Acceleration(rate) => {
                    let by_joint = inertia.times([-rate[i - 1], 0.0, 0.0]);
                    before.feels(&inertia, [0, 1, 2].map(|k| load[k] + by_joint[k]));
                }
            }
        }
        let first = &self.hanging[0];
        let [turn, x, y] = first.inertia.solve(first.load.map(|l| -l))?;
        let (mut alpha, mut a) = (turn, [x, y]);
        for i in 1..n {
            let before = &self.hanging[i - 1];
            let [rx, ry] = before.way;
            a = [a[0] - alpha * ry + before.towards[0], a[1] + alpha * rx + before.towards[1]];
            let Hanging { inertia, load, .. } = &self.hanging[i];
            self.answer[i - 1] = match given {
                Given::Torque(_) => {
                    let [d, left] = self.free[i];
                    let own = d * (left - (inertia.turn_x * a[0] + inertia.turn_y * a[1]));
                    let found = alpha - own;
                    alpha = own;
                    found
                }
                Given::Acceleration(rate) => {
                    alpha -= rate[i - 1];
                    -(inertia.turn * alpha + inertia.turn_x * a[0] + inertia.turn_y * a[1] + load[0])
                }
            };
        }
        // From the acceleration of the head's front to the rate of its centre's motion in its own axes.
        let [w, u, v] = head;
        let half = self.constants[0].half_length_m[0];
        Some([turn, x + half * w * w + w * v, y - half * turn - w * u])
    }

    /// Headings of the links in the head's axes and velocities of their joints.
    #[inline(always)]
    fn places(&mut self, [mut w, u, v]: Motion, joints: Joints<'_>) {
        let mut heading = 0.0;
        for (i, moment) in self.moments.iter_mut().enumerate() {
            for k in 0..LANES {
                // The head has no joint before it, and beyond the tail there is none.
                let joint = (LANES * i + k).wrapping_sub(1);
                if let (Some(angle), Some(rate)) = (joints.angle.get(joint), joints.rate.get(joint)) {
                    heading -= angle;
                    w -= rate;
                }
                (moment.heading[k], moment.turn_rate[k]) = (heading, w);
            }
            (moment.sin, moment.cos) = sin_cos(&moment.heading);
        }
        let half = self.constants[0].half_length_m[0];
        let mut joint = [u, v + half * self.moments[0].turn_rate[0]];
        for (moment, constants) in self.moments.iter_mut().zip(&self.constants) {
            for k in 0..LANES {
                (moment.joint[0][k], moment.joint[1][k]) = (joint[0], joint[1]);
                let by = 2.0 * constants.half_length_m[k] * moment.turn_rate[k];
                joint = [joint[0] + by * moment.sin[k], joint[1] - by * moment.cos[k]];
            }
        }
    }

    /// Motions, loads and inertias of the links by themselves.
    #[inline(always)]
    fn by_themselves(&mut self) {
        self.loss_w = 0.0;
        for ((four, moment), (hanging, motions)) in self
            .constants
            .iter()
            .zip(&mut self.moments)
            .zip(self.hanging.chunks_mut(LANES).zip(self.motions.chunks_mut(LANES)))
        {
            let (inertia, load) = four.at(moment);
            for (k, (hanging, motion)) in hanging.iter_mut().zip(motions).enumerate() {
                let (c, s, w, half) = (moment.cos[k], moment.sin[k], moment.turn_rate[k], four.half_length_m[k]);
                let (length, turned) = (2.0 * half, 2.0 * half * w * w);
                *hanging = Hanging {
                    inertia: Inertia {
                        turn: inertia[0][k],
                        turn_x: inertia[1][k],
                        turn_y: inertia[2][k],
                        x: inertia[3][k],
                        xy: inertia[4][k],
                        y: inertia[5][k],
                    },
                    load: [load[0][k], load[1][k], load[2][k]],
                    way: [-length * c, -length * s],
                    towards: [turned * c, turned * s],
                };
                *motion = [moment.own[0][k], moment.own[1][k], moment.own[2][k]];
                self.loss_w += moment.loss_w[k];
            }
        }
    }
}

impl Hanging {
    /// Takes what hangs on its end, of inertia and load about that joint.
    #[inline(always)]
    fn feels(&mut self, i: &Inertia, load: Load) {
        let [rx, ry] = self.way;
        let [bx, by] = self.towards;
        // At the end a = (a of P) + α (−r_y, r_x) + towards.
        let (kx, ky) = (i.xy * rx - i.x * ry, i.y * rx - i.xy * ry);
        let (fx, fy) = (load[1] + i.x * bx + i.xy * by, load[2] + i.xy * bx + i.y * by);
        let coupled = i.turn_y * rx - i.turn_x * ry;
        self.inertia.turn += i.turn + 2.0 * coupled + (rx * ky - ry * kx);
        self.inertia.turn_x += i.turn_x + kx;
        self.inertia.turn_y += i.turn_y + ky;
        self.inertia.x += i.x;
        self.inertia.xy += i.xy;
        self.inertia.y += i.y;
        self.load[0] += load[0] + i.turn_x * bx + i.turn_y * by + rx * fy - ry * fx;
        self.load[1] += fx;
        self.load[2] += fy;
    }
}

impl Constants {
    fn of(chain: &Chain, four: &[Link]) -> Self {
        // Beyond the tail stands nothing.
        let nothing =
            Link { half_length_m: 0.0, rigid: Inertia::default(), added: Inertia::default(), drag: LinkDrag::NONE };
        let links: [Link; LANES] = std::array::from_fn(|k| four.get(k).copied().unwrap_or(nothing));
        let inertia = |of: &dyn Fn(&Link) -> Inertia| {
            let all = links.each_ref().map(of);
            let each = |of: &dyn Fn(&Inertia) -> f64| all.each_ref().map(of);
            [
                each(&|i| i.turn),
                each(&|i| i.turn_x),
                each(&|i| i.turn_y),
                each(&|i| i.x),
                each(&|i| i.xy),
                each(&|i| i.y),
            ]
        };
        Self {
            half_length_m: links.each_ref().map(|link| link.half_length_m),
            inertia: inertia(&Link::inertia),
            turning: match chain.added_mass {
                AddedMass::Full => inertia(&Link::inertia),
                AddedMass::Usr => inertia(&|link| link.rigid),
            },
            drag: DragLanes::of(&links.map(|link| (link.drag, link.half_length_m))),
        }
    }

    /// Inertia and load of four links about the joints before them, in the head's axes.
    #[inline(always)]
    fn at(&self, m: &mut Moment) -> ([Four; 6], Three) {
        let half = &self.half_length_m;
        for k in 0..LANES {
            let by = half[k] * m.turn_rate[k];
            let (x, y) = (m.joint[0][k] + by * m.sin[k], m.joint[1][k] - by * m.cos[k]);
            m.own[0][k] = m.turn_rate[k];
            m.own[1][k] = m.cos[k] * x + m.sin[k] * y;
            m.own[2][k] = m.cos[k] * y - m.sin[k] * x;
        }
        let drag = self.drag.load(&m.own);
        let mut inertia = [[0.0; LANES]; 6];
        let mut load = [[0.0; LANES]; 3];
        let [turn, turn_x, turn_y, x, xy, y] = &self.inertia;
        let [_, tx, ty, mx, mxy, my] = &self.turning;
        for k in 0..LANES {
            let [w, u, v] = [m.own[0][k], m.own[1][k], m.own[2][k]];
            m.loss_w[k] = -(drag[0][k] * w + drag[1][k] * u + drag[2][k] * v);
            // What the axes make of a motion that stays as it is, and momenta that turn with them.
            let (bx, by) = (w * v + half[k] * w * w, -w * u);
            let (hx, hy) = (tx[k] * w + mx[k] * u + mxy[k] * v, ty[k] * w + mxy[k] * u + my[k] * v);
            let n = turn_x[k] * bx + turn_y[k] * by + u * hy - v * hx - drag[0][k];
            let fx = x[k] * bx + xy[k] * by - w * hy - drag[1][k];
            let fy = xy[k] * bx + y[k] * by + w * hx - drag[2][k];
            let (c, s, l) = (m.cos[k], m.sin[k], half[k]);
            load[0][k] = n - l * fy;
            load[1][k] = c * fx - s * fy;
            load[2][k] = s * fx + c * fy;
            // From the centre to the joint, then into the head's axes.
            let (ox, oy) = (turn_x[k] - l * xy[k], turn_y[k] - l * y[k]);
            inertia[0][k] = turn[k] - l * (2.0 * turn_y[k] - l * y[k]);
            inertia[1][k] = c * ox - s * oy;
            inertia[2][k] = s * ox + c * oy;
            let (cc, cs, ss) = (c * c, c * s, s * s);
            inertia[3][k] = cc * x[k] - 2.0 * cs * xy[k] + ss * y[k];
            inertia[4][k] = cs * (x[k] - y[k]) + (cc - ss) * xy[k];
            inertia[5][k] = ss * x[k] + 2.0 * cs * xy[k] + cc * y[k];
        }
        (inertia, load)
    }
}

/// An evaluation, compiled for what the processor has.
struct Evaluate<'a> {
    work: &'a mut Workspace,
    head: Motion,
    joints: Joints<'a>,
    given: Given<'a>,
}

impl froude_lanes::Kernel for Evaluate<'_> {
    type Output = Option<Motion>;

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Option<Motion> {
        self.work.recursion(self.head, self.joints, self.given)
    }
}
