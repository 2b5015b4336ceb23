//! Planar motion with rotation: the body carried by the x and y axes and a yaw stage. What the paper names as future work.
//!
//! **Setting.** One body whose centre hangs on the yaw axis, still water, rigid axes (the chains' swing is [`crate::plant`]'s).
//! **Frames.** World: x along the short axis, y along the long one, yaw ψ from x towards y, so that z points down. Body: x forward,
//! y to starboard (SNAME); ν = (u, v, r) with (u, v) = Rᵀ(ψ)(ẋ, ẏ). **Units.** SI. Forces are the water's on the body.
//!
//! | what | where | source |
//! | --- | --- | --- |
//! | drag on body axes, yaw torque | [`froude_hydro::link_parameters::LinkParameters`] | USR eq. 2, 3, 7 |
//! | −(μ_x u̇ − μ_y r v), −(μ_y v̇ + μ_x r u), −(λ₁ ṙ + (μ_y − μ_x) u v) | [`PlanarBody::water_body_n`] | Kirchhoff; the Munk moment is in the last |
//! | M(ψ) q̈ = Q_servo − friction + Jᵀ(…) | [`PlanarRig::acceleration`] | Lagrange |
//! | what each axis feels of the water | [`PlanarRig::loads`] | Jᵀ f |
//!
//! Coulomb friction has its sign smoothed over 1 mm/s: this model is for loads at speed, not for stick.

use froude_hydro::axes::{body_from_world, world_from_body};
use froude_hydro::link_parameters::LinkParameters;

/// (x, y, ψ) or a rate of it, or the generalised forces along it.
pub type Three = [f64; 3];

/// Speed over which the sign of Coulomb friction changes, m/s or rad/s.
const SMOOTH: f64 = 1e-3;

/// The body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarBody {
    /// Mass with enclosed water, kg.
    pub mass_kg: f64,
    /// Moment of inertia about its centre, kg m².
    pub yaw_inertia_kg_m2: f64,
    /// μ_x, kg.
    pub added_x_kg: f64,
    /// c, μ_y and λ of the body as one link.
    pub link: LinkParameters,
    /// v_ref of the linear drag terms, m/s; 0 leaves only the quadratic ones.
    pub v_ref_m_s: f64,
}

impl PlanarBody {
    /// (μ_x, μ_y, λ₁).
    fn added(&self) -> Three {
        [self.added_x_kg, self.link.added_mass_kg, self.link.lambda_1_kg_m2]
    }

    /// Drag and drag torque in body axes, N and N m.
    #[must_use]
    pub fn drag_body_n(&self, velocity_body: Three) -> Three {
        let [u, v, r] = velocity_body;
        let [x, y] = self.link.drag_n(self.v_ref_m_s, [u, v]);
        [x, y, self.link.torque_n_m(self.v_ref_m_s, r, 0.0)]
    }

    /// All that the water does to the body, body axes, for a velocity and its rate of change in body axes.
    #[must_use]
    pub fn water_body_n(&self, velocity_body: Three, rate_body: Three) -> Three {
        let (a, drag, turning) = (self.added(), self.drag_body_n(velocity_body), self.turning_body_n(velocity_body));
        core::array::from_fn(|i| drag[i] + turning[i] - a[i] * rate_body[i])
    }

    /// The part of the water's inertia that steady turning has: centripetal forces and the Munk moment.
    fn turning_body_n(&self, [u, v, r]: Three) -> Three {
        let [a_x, a_y, _] = self.added();
        [a_y * r * v, -a_x * r * u, -(a_y - a_x) * u * v]
    }
}

/// One axis of the three.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarAxis {
    /// What it moves besides the body: kg, or kg m² for yaw. The y axis carries the x axis: give it that mass too.
    pub inertia: f64,
    /// Viscous friction, N s/m or N m s/rad.
    pub viscous: f64,
    /// Coulomb friction, N or N m.
    pub coulomb: f64,
}

impl PlanarAxis {
    fn friction(&self, rate: f64) -> f64 {
        self.viscous * rate + self.coulomb * libm::tanh(rate / SMOOTH)
    }
}

/// A servo: stiffness and damping about a reference, with its force limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarServo {
    /// N/m or N m/rad.
    pub stiffness: f64,
    /// N s/m or N m s/rad.
    pub damping: f64,
    /// Largest force, N or N m.
    pub limit: f64,
}

impl PlanarServo {
    /// Force for a reference and a state; `forward` is added (what a model expects).
    #[must_use]
    pub fn force(&self, reference: [f64; 2], state: [f64; 2], forward: f64) -> f64 {
        let wanted = self.stiffness * (reference[0] - state[0]) + self.damping * (reference[1] - state[1]) + forward;
        wanted.clamp(-self.limit, self.limit)
    }
}

/// Where the body is and how it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarState {
    /// (x, y, ψ).
    pub pose: Three,
    /// (ẋ, ẏ, ψ̇), world axes.
    pub rate: Three,
}

impl PlanarState {
    /// (u, v, r).
    #[must_use]
    pub fn velocity_body(&self) -> Three {
        let [x, y, r] = self.rate;
        let [u, v] = body_from_world(self.pose[2], [x, y]);
        [u, v, r]
    }
}

/// Axes, yaw stage and body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarRig {
    /// x, y, yaw.
    pub axes: [PlanarAxis; 3],
    /// The body.
    pub body: PlanarBody,
}

impl PlanarRig {
    /// What each axis feels of the water, world axes, N and N m: the water's force on the body, the axis must hold against it.
    #[must_use]
    pub fn loads(&self, state: &PlanarState, acceleration: Three) -> Three {
        let nu = state.velocity_body();
        let [u, v] = body_from_world(state.pose[2], [acceleration[0], acceleration[1]]);
        let rate_body = [u + nu[2] * nu[1], v - nu[2] * nu[0], acceleration[2]];
        to_world(state.pose[2], self.body.water_body_n(nu, rate_body))
    }

    /// Accelerations (ẍ, ÿ, ψ̈) under servo forces.
    #[must_use]
    pub fn acceleration(&self, state: &PlanarState, servo: Three) -> Three {
        let heading = state.pose[2];
        let rest = self.loads(state, [0.0; 3]); // the water without its reaction to acceleration
        let force: Three = core::array::from_fn(|i| servo[i] + rest[i] - self.axes[i].friction(state.rate[i]));
        let [a_x, a_y, a_r] = self.body.added();
        let (s, c) = (libm::sin(heading), libm::cos(heading));
        let m = self.body.mass_kg;
        let m_xx = self.axes[0].inertia + m + a_x * c * c + a_y * s * s;
        let m_yy = self.axes[1].inertia + m + a_x * s * s + a_y * c * c;
        let m_xy = (a_x - a_y) * s * c;
        let determinant = m_xx * m_yy - m_xy * m_xy;
        [
            (m_yy * force[0] - m_xy * force[1]) / determinant,
            (m_xx * force[1] - m_xy * force[0]) / determinant,
            force[2] / (self.axes[2].inertia + self.body.yaw_inertia_kg_m2 + a_r),
        ]
    }

    /// One step of Runge–Kutta (fourth order) with the servo forces held.
    #[must_use]
    pub fn step(&self, state: &PlanarState, servo: Three, step_s: f64) -> PlanarState {
        let along = |rate: Three, acceleration: Three, h: f64| PlanarState {
            pose: core::array::from_fn(|i| state.pose[i] + h * rate[i]),
            rate: core::array::from_fn(|i| state.rate[i] + h * acceleration[i]),
        };
        let (v1, a1) = (state.rate, self.acceleration(state, servo));
        let s2 = along(v1, a1, 0.5 * step_s);
        let (v2, a2) = (s2.rate, self.acceleration(&s2, servo));
        let s3 = along(v2, a2, 0.5 * step_s);
        let (v3, a3) = (s3.rate, self.acceleration(&s3, servo));
        let s4 = along(v3, a3, step_s);
        let (v4, a4) = (s4.rate, self.acceleration(&s4, servo));
        let mean = |a: Three, b: Three, c: Three, d: Three| -> Three {
            core::array::from_fn(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0)
        };
        along(mean(v1, v2, v3, v4), mean(a1, a2, a3, a4), step_s)
    }

    /// Kinetic energy of rig, body and the water's added mass, J.
    #[must_use]
    pub fn energy_j(&self, state: &PlanarState) -> f64 {
        let (q, nu, a) = (state.rate, state.velocity_body(), self.body.added());
        let body = [self.body.mass_kg, self.body.mass_kg, self.body.yaw_inertia_kg_m2];
        0.5 * (0..3).map(|i| (self.axes[i].inertia + body[i]) * q[i] * q[i] + a[i] * nu[i] * nu[i]).sum::<f64>()
    }

    /// Power that drag and friction take, W ≥ 0 for a drag that resists.
    #[must_use]
    pub fn lost_w(&self, state: &PlanarState) -> f64 {
        let (nu, drag) = (state.velocity_body(), self.body.drag_body_n(state.velocity_body()));
        (0..3).map(|i| self.axes[i].friction(state.rate[i]) * state.rate[i] - drag[i] * nu[i]).sum()
    }
}

fn to_world(heading_rad: f64, [x, y, n]: Three) -> Three {
    let [x, y] = world_from_body(heading_rad, [x, y]);
    [x, y, n]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rig() -> PlanarRig {
        PlanarRig {
            axes: [
                PlanarAxis { inertia: 1.5, viscous: 0.5, coulomb: 0.8 },
                PlanarAxis { inertia: 6.0, viscous: 1.9, coulomb: 2.0 },
                PlanarAxis { inertia: 0.05, viscous: 0.01, coulomb: 0.02 },
            ],
            body: PlanarBody {
                mass_kg: 5.0,
                yaw_inertia_kg_m2: 0.12,
                added_x_kg: 0.8,
                link: LinkParameters {
                    c_t_kg_m: 1.0,
                    c_n_kg_m: 19.0,
                    added_mass_kg: 6.0,
                    lambda_1_kg_m2: 0.06,
                    lambda_2_kg_m: 0.01,
                    lambda_3_kg_m2: 0.05,
                },
                v_ref_m_s: 0.0,
            },
        }
    }

    fn turned(state: &PlanarState, by: f64) -> PlanarState {
        let turn = |[x, y, n]: Three| {
            let [x, y] = world_from_body(by, [x, y]);
            [x, y, n]
        };
        let mut pose = turn(state.pose);
        pose[2] += by;
        PlanarState { pose, rate: turn(state.rate) }
    }

    fn any_state() -> impl Strategy<Value = PlanarState> {
        let three = || [-1.0..1.0, -1.0..1.0, -2.0..2.0_f64];
        (three(), three()).prop_map(|(pose, rate)| PlanarState { pose, rate })
    }

    proptest! {
        /// The water does not know where north is.
        #[test]
        fn loads_turn_with_the_world(state in any_state(), a in [-1.0..1.0, -1.0..1.0, -1.0..1.0_f64], by in -3.0..3.0_f64) {
            let [x, y] = world_from_body(by, [a[0], a[1]]);
            let here = rig().loads(&state, a);
            let there = rig().loads(&turned(&state, by), [x, y, a[2]]);
            let [x, y] = world_from_body(by, [here[0], here[1]]);
            for (expected, found) in [x, y, here[2]].into_iter().zip(there) {
                prop_assert!((expected - found).abs() < 1e-12 * (1.0 + expected.abs()) * 100.0);
            }
        }

        /// Forward and inverse dynamics are one law: inertia of rig and body, water and friction add up to the servo.
        #[test]
        fn servo_less_friction_plus_water_is_mass_times_acceleration(state in any_state(), servo in [-9.0..9.0, -9.0..9.0, -1.0..1.0_f64]) {
            let rig = rig();
            let a = rig.acceleration(&state, servo);
            let water = rig.loads(&state, a);
            let body = [rig.body.mass_kg, rig.body.mass_kg, rig.body.yaw_inertia_kg_m2];
            for i in 0..3 {
                let left = (rig.axes[i].inertia + body[i]) * a[i];
                let right = servo[i] + water[i] - rig.axes[i].friction(state.rate[i]);
                prop_assert!((left - right).abs() < 1e-11 * (1.0 + right.abs() + servo[i].abs() + water[i].abs()) * 100.0);
            }
        }

        /// Turning forces of the added mass do no work; drag and friction only take.
        #[test]
        fn the_water_gives_no_power(state in any_state()) {
            let nu = state.velocity_body();
            let power: f64 = rig().body.turning_body_n(nu).iter().zip(nu).map(|(f, v)| f * v).sum();
            prop_assert!(power.abs() < 1e-13);
            prop_assert!(rig().lost_w(&state) >= 0.0);
        }
    }

    #[test]
    fn power_of_the_servos_is_found_again_in_energy_drag_and_friction() {
        let rig = rig();
        let defect_j = |step_s: f64| {
            let mut state = PlanarState { pose: [0.0, 0.0, 0.4], rate: [0.1, 0.3, 0.5] };
            let (before_j, mut work_j) = (rig.energy_j(&state), 0.0);
            let steps = (2.0 / step_s).round() as u32;
            for i in 0..steps {
                let t = f64::from(i) * step_s;
                let servo = [4.0 + 3.0 * (2.0 * t).sin(), 9.0, 0.8 * (3.0 * t).cos()];
                let next = rig.step(&state, servo, step_s);
                work_j += (0..3).map(|j| servo[j] * (next.pose[j] - state.pose[j])).sum::<f64>();
                let middle = rig.step(&state, servo, 0.5 * step_s);
                let lost = rig.lost_w(&state) + 4.0 * rig.lost_w(&middle) + rig.lost_w(&next);
                work_j -= lost * step_s / 6.0;
                state = next;
            }
            (rig.energy_j(&state) - before_j - work_j).abs()
        };
        // Fourth order while no axis passes rest within its smoothing: sixteen times less at half the step.
        let (coarse, fine) = (defect_j(2e-3), defect_j(1e-3));
        assert!(fine < 1e-8 && coarse / fine > 8.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn towed_askew_the_body_feels_drag_on_its_own_axes_and_the_munk_moment() {
        let rig = rig();
        let (speed, heading) = (0.5_f64, 0.3_f64);
        let state = PlanarState { pose: [0.0, 0.0, heading], rate: [speed, 0.0, 0.0] };
        let (u, v) = (speed * heading.cos(), -speed * heading.sin());
        let [x, y] = world_from_body(heading, [-u * u.abs(), -19.0 * v * v.abs()]);
        let loads = rig.loads(&state, [0.0; 3]);
        let munk = -(6.0 - 0.8) * u * v;
        for (found, expected) in loads.into_iter().zip([x, y, munk]) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn along_y_at_constant_heading_it_is_the_one_axis_law() {
        // M ÿ + B ẏ + C + D v² = F: what MCD assumes, with the body broadside.
        let rig = rig();
        let heading = 0.0;
        let state = PlanarState { pose: [0.0, 0.0, heading], rate: [0.0, 0.4, 0.0] };
        let a = rig.acceleration(&state, [0.0, 12.0, 0.0]);
        let expected = (12.0 - 1.9 * 0.4 - 2.0 - 19.0 * 0.16) / (6.0 + 5.0 + 6.0);
        assert!((a[1] - expected).abs() < 1e-12 && a[0].abs() < 1e-12 && a[2].abs() < 1e-12, "{a:?}");
    }

    #[test]
    fn three_servos_hold_a_circle_with_the_heading_along_it() {
        let rig = rig();
        let servos = [(4e3, 250.0, 60.0), (8e3, 600.0, 60.0), (40.0, 5.0, 10.0)]
            .map(|(stiffness, damping, limit)| PlanarServo { stiffness, damping, limit });
        let (radius, rate) = (0.3, 0.8);
        let at = |t: f64| {
            let (s, c) = (rate * t).sin_cos();
            PlanarState {
                pose: [radius * c, radius * s, rate * t + core::f64::consts::FRAC_PI_2],
                rate: [-radius * rate * s, radius * rate * c, rate],
            }
        };
        let (mut state, h) = (at(0.0), 250e-6);
        for i in 0..40_000 {
            let reference = at(f64::from(i) * h);
            let servo = core::array::from_fn(|j| {
                servos[j].force([reference.pose[j], reference.rate[j]], [state.pose[j], state.rate[j]], 0.0)
            });
            state = rig.step(&state, servo, h);
        }
        let end = at(10.0);
        // Without feed-forward the servos need load/stiffness: some 10 N over 4 N/mm, 0.3 N m over 40 N m/rad.
        assert!(
            (0..2).all(|j| (state.pose[j] - end.pose[j]).abs() < 5e-3) && (state.pose[2] - end.pose[2]).abs() < 0.03,
            "{state:?} {end:?}"
        );
        // Along the circle the body goes ahead, hardly sideways, and turns steadily.
        let [u, v, r] = state.velocity_body();
        assert!((u - radius * rate).abs() < 5e-3 && v.abs() < 5e-3 && (r - rate).abs() < 0.02, "{u} {v} {r}");
    }
}
