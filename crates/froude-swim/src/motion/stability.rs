//! How long a step may be: servos pull a joint back faster than a step of Runge and Kutta's fourth order can follow where they are stiff and its inertia is small, and drag settles a slow
//! gait many times within a period.
//!
//! Small motions of the joints about a shape have M φ̈ = −k_p φ − k_d φ̇, with M the inertia that a torque feels while the head is free. A step h is stable where |R(h s)| ≤ 1 for each
//! eigenvalue s of these equations, R(z) = 1 + z + z²/2 + z³/6 + z⁴/24. Of damping alone that is h ≤ 2.785/λ, λ the largest eigenvalue of M⁻¹ k_d.
//!
//! **Units.** SI. **Source.** Hairer & Wanner (1996), *Solving Ordinary Differential Equations II*, IV.2 (2.785 on the real axis).

use faer::Mat;
use faer::c64;

use crate::chain::{Chain, Link};
use crate::drag::Turning;
use crate::drive::Following;
use crate::dynamics::Dynamics;
use crate::engine::{Given, Joints};
use crate::gait::{Course, Shape};

/// Where |R| = 1 on the negative real axis.
pub const REAL_LIMIT: f64 = 2.785;
/// Shapes of a course at which the joints are looked at.
const SHAPES: usize = 8;
/// Points on the way of h s at which |R| is looked at; none is stable beyond |h s| of 3 in the left half.
const POINTS: usize = 3000;
const FARTHEST: f64 = 3.0;

/// What the servos of a chain ask of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness {
    /// λ, the largest eigenvalue of M⁻¹ k_d with friction in k_d, 1/s.
    pub damping_per_s: f64,
    /// The longest step that is stable, s.
    pub longest_step_s: f64,
}

/// The stiffest of a course's shapes; `None` where an inertia is not positive or there is no joint. Weight and buoyancy, which answer too, are left out.
#[must_use]
pub fn stiffness<C: Dynamics>(chain: &C, course: &dyn Course, following: &[Following]) -> Option<Stiffness> {
    let n = chain.joints();
    let mut work = chain.work();
    let mut shape = Shape::straight(n);
    let still = vec![0.0; n];
    let mut out: Option<Stiffness> = None;
    for k in 0..SHAPES {
        course.at(course.period_s() * k as f64 / SHAPES as f64, &mut shape);
        let mut answer = |torque: &[f64]| {
            let joints = Joints { angle: &shape.angle, rate: &still };
            chain.evaluate(&mut work, (&C::REST.pose, C::REST.head), joints, Given::Torque(torque))?;
            Some(C::evaluated(&work).answer.to_vec())
        };
        let by_weight = answer(&still)?;
        let mut inverse = Mat::<f64>::zeros(n, n);
        for j in 0..n {
            let torque: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
            let found = answer(&torque)?;
            (0..n).for_each(|i| inverse[(i, j)] = found[i] - by_weight[i]);
        }
        let here = of(&inverse, following)?;
        out = Some(out.map_or(here, |worst| Stiffness {
            damping_per_s: worst.damping_per_s.max(here.damping_per_s),
            longest_step_s: worst.longest_step_s.min(here.longest_step_s),
        }));
    }
    out
}

fn of(inverse: &Mat<f64>, following: &[Following]) -> Option<Stiffness> {
    let n = inverse.nrows();
    let damped = Mat::from_fn(n, n, |i, j| inverse[(i, j)] * following[j].steepest_n_m_s());
    let damping_per_s = damped.eigenvalues().ok()?.iter().map(|s| s.re).fold(0.0, f64::max);
    let motion = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(j == i + n)),
        (false, true) => -inverse[(i - n, j)] * following[j].stiffness_n_m,
        (false, false) => -damped[(i - n, j - n)],
    });
    let longest_step_s = motion.eigenvalues().ok()?.iter().map(|s| longest(*s)).fold(f64::INFINITY, f64::min);
    Some(Stiffness { damping_per_s, longest_step_s })
}

/// The longest stable step for an eigenvalue of the left half, s.
fn longest(s: c64) -> f64 {
    let size = s.norm();
    let along = |r: f64| {
        let z = s * (r / size);
        // Horner.
        let mut sum = c64::new(1.0, 0.0);
        for k in [4.0, 3.0, 2.0, 1.0] {
            sum = sum * z / k + 1.0;
        }
        sum.norm()
    };
    // What neither grows nor fades is met to rounding only.
    let is_stable = |r: f64| along(r) <= 1.0 + 1e-9;
    let reach = (1..=POINTS).map(|i| FARTHEST * i as f64 / POINTS as f64).take_while(|r| is_stable(*r)).last();
    reach.unwrap_or(0.0) / size
}

impl Chain {
    /// The fastest that linear drag settles any motion of the chain, 1/s: at most the fastest of its links by themselves.
    #[must_use]
    pub fn settles_per_s(&self) -> f64 {
        self.links.iter().map(Link::settles_per_s).fold(0.0, f64::max)
    }
}

impl Link {
    fn settles_per_s(&self) -> f64 {
        let inertia = self.inertia();
        let l = self.half_length_m;
        let turning = match self.drag.turning {
            Turning::Strip => self.drag.across[0] * l * l / 3.0,
            Turning::Lumped([linear, _]) => linear,
        };
        let about_centre = inertia.turn - inertia.turn_y * inertia.turn_y / inertia.y;
        [self.drag.along[0] / inertia.x, self.drag.across[0] / inertia.y, turning / about_centre]
            .into_iter()
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::AddedMass;
    use crate::drag::LinkDrag;
    use crate::drive::{Motor, Servo};
    use crate::driven::Driven;
    use crate::gait::{Envelope, Gait};
    use crate::planar::Inertia;

    fn pair() -> Chain {
        let link = Link {
            half_length_m: 0.09,
            rigid: Inertia::rigid(1.3, 4e-3, 0.0),
            added: Inertia { turn: 4e-3, y: 1.6, ..Inertia::default() },
            drag: LinkDrag::NONE,
        };
        Chain { links: vec![link; 2], added_mass: AddedMass::Full }
    }

    /// Damping alone: 2.785 on the real axis; stiffness alone: 2.828 on the imaginary one. Points lie 0.001 apart.
    #[test]
    fn limits_of_the_axes_are_those_of_the_method() {
        assert!((longest(c64::new(-2.0, 0.0)) * 2.0 - REAL_LIMIT).abs() < 1.1e-3);
        assert!((longest(c64::new(0.0, 5.0)) * 5.0 - 8.0_f64.sqrt()).abs() < 1.1e-3);
    }

    /// Straight and with φ̇ alone, each link turns by φ̇/2 and no momentum is left: both centres rest, and the energy is 2 · J (φ̇/2)²/2, that of an inertia J/2.
    #[test]
    fn a_pair_of_links_has_the_inertia_of_its_mirror_motion() {
        let chain = pair();
        let gait = Gait::wave(1e-9, 1.0, 0.0, Envelope::Lateral);
        let following = [Following { stiffness_n_m: 1e-6, damping_n_m_s: 0.5, ..Following::default() }];
        let found = stiffness(&chain, &gait, &following).unwrap();
        let inertia = 0.5 * 8e-3;
        assert!((found.damping_per_s * inertia / 0.5 - 1.0).abs() < 1e-9, "{}", found.damping_per_s);
        assert!((found.longest_step_s * found.damping_per_s - REAL_LIMIT).abs() < 2e-3);
    }

    /// A step of 0.98 of the longest settles, one of 1.02 grows.
    #[test]
    fn the_longest_step_is_the_longest_that_settles() {
        let chain = pair();
        let gait = Gait::wave(0.0, 1.0, 0.0, Envelope::Lateral);
        let following = [Following { stiffness_n_m: 20.0, damping_n_m_s: 0.5, ..Following::default() }];
        let motor = Motor::default();
        let longest = stiffness(&chain, &gait, &following).unwrap().longest_step_s;
        for (part, grows) in [(0.98, false), (1.02, true)] {
            let mut driven = Driven::new(&chain, Servo::new(&gait, &following, &motor));
            let mut state = vec![0.0; driven.size()];
            state[3] = 1e-6;
            state[7] = 1e-4;
            let mut size = 0.0;
            for i in 0..2000 {
                driven.step(part * longest * f64::from(i), part * longest, &mut state).unwrap();
                size = state[3].abs() + state[7].abs();
                if size > 1e-3 {
                    break;
                }
            }
            assert_eq!(size > 1e-4, grows, "{part}: {size}");
        }
    }
}
