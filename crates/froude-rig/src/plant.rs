//! One axis as two masses and a chain, with friction that truly sticks.
//!
//! J_m θ̈ + B_m θ̇ + (gear and Coulomb loss) + (R/n) F_s = τ_m, M ÿ + B ẏ + C(y, ẏ, load) sgn ẏ + D_d ẏ|ẏ| + W = F_s,
//! F_s = K_e s + B_e ṡ, s = Rθ/n − y: MCD eq. 2 with the drag on its right-hand side and what the paper left out.
//!
//! **Setting.** One run: masses and wheel load do not change. **Frame.** Chain coordinate; q = Rθ/n is the motor, y the load.
//! **Units.** SI; forces at the chain, so the rotor is the mass J_m (n/R)².
//!
//! **Steps.** The linear part is exact ([`crate::propagator`]). What else acts while sliding is extrapolated to mid-step (second
//! order, Adams–Bashforth). A mass at rest stays there, bit for bit, while the force on it is below breakaway; one whose speed
//! passes zero within a step stops, or turns when the force carries it on.
//!
//! **Gear.** Torque T from the chain loads the motor by T/η while the motor drives and by η_b T while it is driven. Both are one
//! law: ½(1/η + η_b) T, and a Coulomb friction of ½(1/η − η_b)|T| that also locks the gear at rest.
//!
//! **Friction of the load.** C = (C₀ + μ_r N)·run·bump(y)·stribeck(v)·(1 ± asymmetry) + slow noise + pulley, with
//! stribeck = 1 + e/(1 + (v/v_s)²) (Hess & Soom 1990) and bump = 1 + b(1 − u²), u from −1 to 1 along the travel.

use crate::load::Load;
use crate::parameters::AxisParameters;
use crate::propagator::{Linear, Propagators};

/// Stiffness of a hard stop, N/m, and its damping, N s/m (chosen: a rubber buffer).
const STOP: (f64, f64) = (1.0e5, 200.0);

/// One mass of the two.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mass {
    position_m: f64,
    speed_m_s: f64,
    /// Direction of sliding: +1, −1, or 0 at rest.
    direction: f64,
    /// What acted on it besides the linear part in the last step, N; NaN when it has just begun to slide.
    last_n: f64,
}

impl Mass {
    fn at_rest(position_m: f64) -> Self {
        Self { position_m, speed_m_s: 0.0, direction: 0.0, last_n: f64::NAN }
    }

    /// Breaks away when the force exceeds the friction.
    fn release(&mut self, net_n: f64, friction_n: f64) {
        if self.direction == 0.0 && net_n.abs() > friction_n {
            self.direction = 1.0_f64.copysign(net_n);
            self.last_n = f64::NAN;
        }
    }

    /// The force at mid-step, from this step's start and the last one's.
    fn extrapolated(&mut self, now_n: f64) -> f64 {
        let last_n = if self.last_n.is_nan() { now_n } else { self.last_n };
        self.last_n = now_n;
        now_n + 0.5 * (now_n - last_n)
    }

    /// Takes the new speed; where it passed zero the mass stops, or goes on backwards with friction now against it.
    fn advance(&mut self, by_m: f64, speed_m_s: f64, net_n: f64, friction_n: f64) {
        self.position_m += by_m;
        self.speed_m_s = speed_m_s;
        if speed_m_s * self.direction > 0.0 {
            return;
        }
        let back_n = -net_n * self.direction;
        if back_n > friction_n {
            self.speed_m_s *= (back_n - friction_n) / (back_n + friction_n);
            self.direction = -self.direction;
        } else {
            self.speed_m_s = 0.0;
            self.direction = 0.0;
        }
        self.last_n = f64::NAN;
    }
}

/// What changes while a run goes on, set from outside.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbance {
    /// Added to the load's friction, N: slow noise.
    pub noise_n: f64,
    /// Added to the load's friction, N: a jam.
    pub jam_n: f64,
}

/// Two masses, their chain, their friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plant {
    motor: Mass,
    load: Mass,
    linear: Linear,
    propagators: Propagators,
    step_s: f64,
    gear_mean: f64,
    gear_loss: f64,
    motor_friction_n: f64,
    load_friction_n: f64,
    pulley_n: f64,
    stribeck_excess: f64,
    per_stribeck_speed_s_m: f64,
    bump: f64,
    mid_m: f64,
    per_half_travel_1_m: f64,
    asymmetry: f64,
    drag_n_s2_m2: f64,
    hung_n: f64,
    low_m: f64,
    high_m: f64,
    disturbance: Disturbance,
    friction_n: f64,
}

impl Plant {
    /// At rest at `position_m` with the chain slack; `friction_factor` scales this run's Coulomb friction.
    #[must_use]
    pub fn new(axis: &AxisParameters, load: &Load, step_s: f64, position_m: f64, friction_factor: f64) -> Self {
        let r = axis.chain_m_rad();
        let linear = Linear {
            motor_mass_kg: axis.motor_mass_kg(),
            load_mass_kg: load.mass_kg(axis),
            stiffness_n_m: axis.stiffness_n_m,
            damping_n_s_m: axis.chain_damping_n_s_m,
            motor_viscous_n_s_m: axis.motor_viscous_n_m_s_rad / (r * r),
            load_viscous_n_s_m: axis.load_viscous_n_s_m,
        };
        let (drive, driven) = (1.0 / axis.efficiency_forward, axis.efficiency_backward);
        Self {
            motor: Mass::at_rest(position_m),
            load: Mass::at_rest(position_m),
            linear,
            propagators: linear.propagators(step_s),
            step_s,
            gear_mean: 0.5 * (drive + driven),
            gear_loss: 0.5 * (drive - driven),
            motor_friction_n: axis.motor_coulomb_n_m / r * friction_factor,
            load_friction_n: axis.load_friction_n(load.wheel_load_n(axis)) * friction_factor,
            pulley_n: load.hung.pulley_friction * load.hung.weight_n.abs(),
            stribeck_excess: axis.stribeck_excess,
            per_stribeck_speed_s_m: 1.0 / axis.stribeck_speed_m_s,
            bump: axis.bump,
            mid_m: 0.5 * (axis.hard_low_m + axis.hard_high_m),
            per_half_travel_1_m: 2.0 / (axis.hard_high_m - axis.hard_low_m),
            asymmetry: axis.asymmetry,
            drag_n_s2_m2: load.drag_n_s2_m2() + load.strut_n_s2_m2(axis),
            hung_n: load.hung.weight_n,
            low_m: axis.hard_low_m,
            high_m: axis.hard_high_m,
            disturbance: Disturbance::default(),
            friction_n: 0.0,
        }
    }

    /// The same axis where it stands, at rest, with another load and another run's friction.
    ///
    /// The chain keeps no tension: who mounts a body moves the platform that little.
    #[must_use]
    pub fn reloaded(&self, axis: &AxisParameters, load: &Load, friction_factor: f64) -> Self {
        Self::new(axis, load, self.step_s, self.motor.position_m, friction_factor)
    }

    /// One step under the motor's force at the chain, (n/R) τ_m, N.
    #[inline]
    pub fn step(&mut self, motor_n: f64) {
        let extension_m = self.motor.position_m - self.load.position_m;
        let spring_n = self.spring_at(extension_m);
        let outer_n = self.outer_n();
        let motor_net_n = motor_n - self.gear_mean * spring_n;
        let motor_friction_n = self.motor_friction_n + self.gear_loss * spring_n.abs();
        let load_net_n = spring_n + outer_n;
        let load_friction_n = self.load_friction_at(load_net_n);
        self.friction_n = load_friction_n;
        self.motor.release(motor_net_n, motor_friction_n);
        self.load.release(load_net_n, load_friction_n);

        let (is_motor, is_load) = (self.motor.direction != 0.0, self.load.direction != 0.0);
        let motor_extra_n = (1.0 - self.gear_mean) * spring_n - self.motor.direction * motor_friction_n;
        let load_extra_n = outer_n - self.load.direction * load_friction_n;
        let (v_q, v_y) = (self.motor.speed_m_s, self.load.speed_m_s);
        if is_motor && is_load {
            let f_q = motor_n + self.motor.extrapolated(motor_extra_n);
            let f_y = self.load.extrapolated(load_extra_n);
            let [dq, dy, vq, vy] = self
                .propagators
                .both
                .map(|r| (r[0] * extension_m + r[1] * v_q) + (r[2] * v_y + r[3] * f_q) + r[4] * f_y);
            self.motor.advance(dq, vq, motor_net_n, motor_friction_n);
            self.load.advance(dy, vy, load_net_n, load_friction_n);
        } else if is_motor {
            let f_q = motor_n + self.motor.extrapolated(motor_extra_n);
            let [dq, vq] = self.propagators.motor.map(|r| r[0] * extension_m + r[1] * v_q + r[2] * f_q);
            self.motor.advance(dq, vq, motor_net_n, motor_friction_n);
        } else if is_load {
            let f_y = self.load.extrapolated(load_extra_n);
            let [dy, vy] = self.propagators.load.map(|r| r[0] * extension_m + r[1] * v_y + r[2] * f_y);
            self.load.advance(dy, vy, load_net_n, load_friction_n);
        }
    }

    fn spring_at(&self, extension_m: f64) -> f64 {
        self.linear.stiffness_n_m * extension_m
            + self.linear.damping_n_s_m * (self.motor.speed_m_s - self.load.speed_m_s)
    }

    /// Drag, hung weight and hard stops on the load, N, signed along +y.
    fn outer_n(&self) -> f64 {
        let (y, v) = (self.load.position_m, self.load.speed_m_s);
        let free_n = -self.drag_n_s2_m2 * v * v.abs() - self.hung_n;
        if y < self.low_m {
            free_n + (STOP.0 * (self.low_m - y) - STOP.1 * v).max(0.0)
        } else if y > self.high_m {
            free_n - (STOP.0 * (y - self.high_m) + STOP.1 * v).max(0.0)
        } else {
            free_n
        }
    }

    /// Friction of the load, N ≥ 0; at rest, breakaway in the direction of the force on it.
    fn load_friction_at(&self, net_n: f64) -> f64 {
        let direction = if self.load.direction == 0.0 { 1.0_f64.copysign(net_n) } else { self.load.direction };
        let u = (self.load.position_m - self.mid_m) * self.per_half_travel_1_m;
        let bump = 1.0 + self.bump * (1.0 - u * u).max(0.0);
        let w = self.load.speed_m_s * self.per_stribeck_speed_s_m;
        let stribeck = 1.0 + self.stribeck_excess / (1.0 + w * w);
        let sliding_n = self.load_friction_n * bump * stribeck * (1.0 + self.asymmetry * direction);
        (sliding_n + self.pulley_n + self.disturbance.noise_n + self.disturbance.jam_n).max(0.0)
    }

    /// Sets what changes from outside.
    pub fn disturb(&mut self, disturbance: Disturbance) {
        self.disturbance = disturbance;
    }

    /// The chain breaks: from here on the two masses know nothing of each other.
    pub fn break_chain(&mut self) {
        self.linear.stiffness_n_m = 0.0;
        self.linear.damping_n_s_m = 0.0;
        self.propagators = self.linear.propagators(self.step_s);
    }

    /// Sets both masses moving at one speed, the chain slack (a test's initial state).
    pub fn launch(&mut self, speed_m_s: f64) {
        for mass in [&mut self.motor, &mut self.load] {
            mass.speed_m_s = speed_m_s;
            mass.direction = if speed_m_s == 0.0 { 0.0 } else { 1.0_f64.copysign(speed_m_s) };
            mass.last_n = f64::NAN;
        }
    }

    /// Moves the load against the motor by this much at rest (a test's initial state: a tensioned chain).
    pub fn stretch(&mut self, extension_m: f64) {
        self.load.position_m = self.motor.position_m - extension_m;
    }

    /// Rθ/n, m: the motor seen at the chain.
    #[must_use]
    pub fn motor_position_m(&self) -> f64 {
        self.motor.position_m
    }

    /// Its speed, m/s.
    #[must_use]
    pub fn motor_speed_m_s(&self) -> f64 {
        self.motor.speed_m_s
    }

    /// y, m.
    #[must_use]
    pub fn load_position_m(&self) -> f64 {
        self.load.position_m
    }

    /// ẏ, m/s.
    #[must_use]
    pub fn load_speed_m_s(&self) -> f64 {
        self.load.speed_m_s
    }

    /// Force of the chain on the load, N.
    #[must_use]
    pub fn spring_n(&self) -> f64 {
        self.spring_at(self.motor.position_m - self.load.position_m)
    }

    /// Sliding (or, at rest, breakaway) friction of the load at the last step, N ≥ 0.
    #[must_use]
    pub fn load_friction_n(&self) -> f64 {
        self.friction_n
    }

    /// Whether the load is off its hard stops.
    #[must_use]
    pub fn is_inside_travel(&self) -> bool {
        (self.low_m..=self.high_m).contains(&self.load.position_m)
    }

    /// Kinetic energy of both masses and what the chain stores, J.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        let s = self.motor.position_m - self.load.position_m;
        0.5 * (self.linear.motor_mass_kg * self.motor.speed_m_s * self.motor.speed_m_s
            + self.linear.load_mass_kg * self.load.speed_m_s * self.load.speed_m_s
            + self.linear.stiffness_n_m * s * s)
    }

    /// The bits of the moving state, for replay tests.
    #[must_use]
    pub fn state_bits(&self) -> [u64; 6] {
        [
            self.motor.position_m.to_bits(),
            self.motor.speed_m_s.to_bits(),
            self.load.position_m.to_bits(),
            self.load.speed_m_s.to_bits(),
            self.motor.direction.to_bits(),
            self.load.direction.to_bits(),
        ]
    }
}
