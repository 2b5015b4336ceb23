//! Accelerations of a chain in three dimensions, link by link and joint by joint, dense: the reference of the O(n) engine.
//!
//! Every link is a free body in the axes of the tank, with its acceleration (ω̇, v̇) unknown, and at every joint a force and a moment are unknown:
//!
//! I_i (ω̇, v̇)_i + p_i = what the joints put on it,
//!
//! and both links of a joint give its point one acceleration, and one turning but about the axis. A prescribed φ̈ takes that freedom away, and its torque is the moment about the axis. One linear system of
//! 12 n − 6 numbers at most, by LU with partial pivoting. Rotations are Rodrigues', and nothing of the engine's recursion is used.
//!
//! # Source
//!
//! Newton's and Euler's equations with Lagrange's multipliers: Featherstone (2008), 3.5; our derivation.

use faer::Mat;
use faer::prelude::*;

use froude_swim::engine::Given;
use froude_swim::spatial::attitude::{Quaternion, to_world, world_from_body};
use froude_swim::spatial::chain::Chain;
use froude_swim::spatial::vector::{Load, Motion, cross, joined, parts};

/// A state; all motion is through the water.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// How the head lies.
    pub attitude: Quaternion,
    /// Its motion in its own axes.
    pub head: Motion,
    /// φ, rad.
    pub angle: Vec<f64>,
    /// φ̇, rad/s.
    pub rate: Vec<f64>,
}

/// Rate of the head's motion in its own axes, and torques of prescribed joints, or else their accelerations.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Of the head.
    pub head: Motion,
    /// Of the joints.
    pub joints: Vec<f64>,
}

/// A link in the axes of the tank.
struct Body {
    /// Columns: its x, y and z.
    axes: [[f64; 3]; 3],
    /// Of its turning and its centre.
    turning: [f64; 3],
    moving: [f64; 3],
    /// Of its front joint and its rear joint, from its centre.
    arms: [[f64; 3]; 2],
}

impl Body {
    fn to_own(&self, v: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, v))
    }

    /// ω × (ω × arm).
    fn towards(&self, arm: usize) -> [f64; 3] {
        cross(self.turning, cross(self.turning, self.arms[arm]))
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn plus(a: [f64; 3], by: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + by * b[k])
}

/// A vector turned about a unit axis by an angle.
fn rodrigues(v: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    plus(plus(v.map(|x| c * x), s, cross(axis, v)), (1.0 - c) * dot(axis, v), axis)
}

/// Accelerations; `None` where the system has no finite solution.
#[must_use]
pub fn rates(chain: &Chain, state: &State, given: Given<'_>) -> Option<Answer> {
    let bodies = bodies(chain, state);
    let (n, joints) = (bodies.len(), chain.joints.len());
    let size = 6 * (n + joints);
    let (mut left, mut right) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, 1));
    for (i, (body, link)) in bodies.iter().zip(&chain.links).enumerate() {
        let inertia = link.inertia();
        let own = |a: [[f64; 3]; 2]| joined(a.map(|x| body.to_own(x)));
        // Rows: the equation in the link's own axes.
        for column in 0..6 {
            let mut unit = [[0.0; 3]; 2];
            unit[column / 3][column % 3] = 1.0;
            for (row, x) in inertia.times(own(unit)).into_iter().enumerate() {
                left[(6 * i + row, 6 * i + column)] = x;
            }
        }
        let motion = own([body.turning, body.moving]);
        // v̇ in the tank is R (u̇ + ω × u).
        let [w, u] = parts(motion);
        let axes_turn = inertia.times(joined([[0.0; 3], cross(w, u)]));
        let down = body.axes.map(|axis| axis[2]);
        for (row, (p, b)) in link.bias(&inertia, motion, down).into_iter().zip(axes_turn).enumerate() {
            right[(6 * i + row, 0)] = b - p;
        }
        // The joint before it puts (moment, force) on it, and the one behind takes as much.
        for (sign, joint, arm) in [(1.0, i.checked_sub(1), 0), (-1.0, (i < joints).then_some(i), 1)] {
            let Some(joint) = joint else { continue };
            for column in 0..6 {
                let mut unit = [[0.0; 3]; 2];
                unit[column / 3][column % 3] = 1.0;
                let load: Load = own([plus(unit[0], 1.0, cross(body.arms[arm], unit[1])), unit[1]]);
                for (row, x) in load.into_iter().enumerate() {
                    left[(6 * i + row, 6 * (n + joint) + column)] -= sign * x;
                }
            }
        }
    }
    for joint in 0..joints {
        let (before, behind) = (&bodies[joint], &bodies[joint + 1]);
        let row = 6 * (n + joint);
        let axis = before.axes[chain.joints[joint].index()];
        // One acceleration of the point: v̇ + ω̇ × arm + ω × (ω × arm).
        for k in 0..3 {
            for (sign, body, at, arm) in [(1.0, before, joint, 1), (-1.0, behind, joint + 1, 0)] {
                for column in 0..3 {
                    let mut unit = [0.0; 3];
                    unit[column] = 1.0;
                    left[(row + k, 6 * at + column)] = sign * cross(unit, body.arms[arm])[k];
                }
                left[(row + k, 6 * at + 3 + k)] = sign;
                right[(row + k, 0)] -= sign * body.towards(arm)[k];
            }
        }
        // ω behind = ω before − φ̇ axis, and the axis turns with the link before.
        let axis_turns = cross(before.turning, axis);
        for (k, direction) in before.axes.into_iter().enumerate() {
            let row = row + 3 + k;
            let is_axis = k == chain.joints[joint].index();
            if let (true, Given::Torque(torque)) = (is_axis, given) {
                // The moment on the link behind, about the axis, is −τ.
                for c in 0..3 {
                    left[(row, 6 * (n + joint) + c)] = axis[c];
                }
                right[(row, 0)] = -torque[joint];
                continue;
            }
            for c in 0..3 {
                left[(row, 6 * joint + c)] = direction[c];
                left[(row, 6 * (joint + 1) + c)] = -direction[c];
            }
            let free = match given {
                Given::Acceleration(rate) if is_axis => rate[joint],
                _ => 0.0,
            };
            right[(row, 0)] = free + state.rate[joint] * dot(direction, axis_turns);
        }
    }
    let found = left.partial_piv_lu().solve(&right);
    let three = |at: usize| -> [f64; 3] { std::array::from_fn(|k| found[(at + k, 0)]) };
    let first = &bodies[0];
    let head = joined([first.to_own(three(0)), first.to_own(plus(three(3), -1.0, cross(first.turning, first.moving)))]);
    let axis = |joint: usize| bodies[joint].axes[chain.joints[joint].index()];
    let joints: Vec<f64> = (0..joints)
        .map(|j| match given {
            Given::Torque(_) => dot(axis(j), plus(three(6 * j), -1.0, three(6 * (j + 1)))),
            Given::Acceleration(_) => -dot(axis(j), three(6 * (n + j))),
        })
        .collect();
    head.iter().chain(&joints).all(|x| x.is_finite()).then_some(Answer { head, joints })
}

fn bodies(chain: &Chain, state: &State) -> Vec<Body> {
    let r = world_from_body(state.attitude);
    let arms = |axes: &[[f64; 3]; 3], half: f64| [axes[0].map(|x| half * x), axes[0].map(|x| -half * x)];
    let axes: [[f64; 3]; 3] = std::array::from_fn(|k| [r[0][k], r[1][k], r[2][k]]);
    let [turning, moving] = parts(state.head).map(|x| to_world(&r, x));
    let mut all = vec![Body { axes, turning, moving, arms: arms(&axes, chain.links[0].half_length_m) }];
    for (i, joint) in chain.joints.iter().enumerate() {
        let before = &all[i];
        let axis = before.axes[joint.index()];
        let axes = before.axes.map(|v| rodrigues(v, axis, -state.angle[i]));
        let arms = arms(&axes, chain.links[i + 1].half_length_m);
        let turning = plus(before.turning, -state.rate[i], axis);
        let point = plus(before.moving, 1.0, cross(before.turning, before.arms[1]));
        all.push(Body { axes, turning, moving: plus(point, -1.0, cross(turning, arms[0])), arms });
    }
    all
}
