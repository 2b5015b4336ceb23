//! One axis as two masses and a chain, with friction that truly sticks.
//!
//! J_m θ̈ + B_m θ̇ + (gear and Coulomb loss) + (R/n) F_s = τ_m, M ÿ + B ẏ + C(y, ẏ, load) sgn ẏ + D_d ẏ|ẏ| + W = F_s,
//! F_s = K_e s + B_e ṡ, s = Rθ/n − y: MCD eq. 2 with the drag on its right-hand side and what the paper left out.
//!
//! **Setting.** One run: masses and wheel load do not change. **Frame.** Chain coordinate; q = Rθ/n is the motor, y the load.
//! **Units.** SI; forces at the chain, so the rotor is the mass J_m (n/R)².
//!
//! **Steps.** The linear part, gear included, is exact ([`crate::propagator`]). Drag and friction of the sliding load are
//! extrapolated to mid-step (second order, Adams–Bashforth). A mass at rest stays there, bit for bit, while the force on it is below
//! breakaway; one whose speed passes zero within a step stops, or turns when the force carries it on.
//!
//! **Gear.** Torque T from the chain loads the motor by T/η while the motor drives and by η_b T while it is driven. At rest it may be
//! anything between: the gear is a mean load ½(1/η + η_b) T and a friction ½(1/η − η_b)|T| that locks it.
//!
//! **Friction of the load.** C = (C₀ + μ_r N)·run·bump(y)·stribeck(v)·(1 ± asymmetry) + slow noise + pulley, with
//! stribeck = 1 + e/(1 + (v/v_s)²) (Hess & Soom 1990) and bump = 1 + b(1 − u²), u from −1 to 1 along the travel.

use crate::load::Load;
use crate::parameters::AxisParameters;
use crate::propagator::Propagators;
use froude_signal::two_mass::TwoMasses;

/// Stiffness of a hard stop, N/m, and its damping, N s/m (chosen: a rubber buffer).
const STOP: (f64, f64) = (1.0e5, 200.0);

/// One mass of the two.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mass {
    position_m: f64,
    speed_m_s: f64,
    /// Direction of sliding: +1, −1, or 0 at rest.
    direction: f64,
}

impl Mass {
    fn at_rest(position_m: f64) -> Self {
        Self { position_m, speed_m_s: 0.0, direction: 0.0 }
    }

    /// Breaks away when the force exceeds the friction.
    fn release(&mut self, net_n: f64, friction_n: f64) {
        if self.direction == 0.0 && net_n.abs() > friction_n {
            self.direction = 1.0_f64.copysign(net_n);
        }
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
    }
}

/// What acted on the sliding load in the steps before, N, for the extrapolation to mid-step.
///
/// Friction is taken from the two steps before this one, so that no step waits for its division.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Memory {
    /// Direction of sliding that it belongs to; 0 when there is none.
    direction: f64,
    outer_n: f64,
    friction_n: [f64; 2],
}

impl Memory {
    const NONE: Self = Self { direction: 0.0, outer_n: 0.0, friction_n: [0.0; 2] };

    /// The load's force at mid-step; takes the values at the step's start.
    #[inline]
    fn extrapolated(&mut self, outer_n: f64, friction_n: f64) -> f64 {
        let [before_n, last_n] = self.friction_n;
        let outer_mid_n = outer_n + 0.5 * (outer_n - self.outer_n);
        let friction_mid_n = last_n + 1.5 * (last_n - before_n);
        self.outer_n = outer_n;
        self.friction_n = [last_n, friction_n];
        outer_mid_n - self.direction * friction_mid_n
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
    memory: Memory,
    linear: TwoMasses,
    propagators: Propagators,
    step_s: f64,
    /// Reaction of the chain on the motor: driving 1/η, driven η_b.
    reactions: [f64; 2],
    motor_friction_n: f64,
    sliding_n: f64,
    pulley_n: f64,
    stribeck_excess: f64,
    per_stribeck_speed_s_m: f64,
    bump: f64,
    mid_m: f64,
    per_half_travel_1_m: f64,
    asymmetry: f64,
    drag_n_s2_m2: f64,
    hung_n: f64,
    floor_m: f64,
    low_m: f64,
    high_m: f64,
    /// Friction that neither place nor speed changes: slow noise, a jam, the pulley.
    added_n: f64,
    friction_n: f64,
}

impl Plant {
    /// At rest at `position_m` with the chain slack; `friction_factor` scales this run's Coulomb friction.
    #[must_use]
    pub fn new(axis: &AxisParameters, load: &Load, step_s: f64, position_m: f64, friction_factor: f64) -> Self {
        let r = axis.chain_m_rad();
        let linear = TwoMasses {
            motor_mass_kg: axis.motor_mass_kg(),
            load_mass_kg: load.mass_kg(axis),
            stiffness_n_m: axis.stiffness_n_m,
            damping_n_s_m: axis.chain_damping_n_s_m,
            motor_viscous_n_s_m: axis.motor_viscous_n_m_s_rad / (r * r),
            load_viscous_n_s_m: axis.load_viscous_n_s_m,
        };
        let reactions = [1.0 / axis.efficiency_forward, axis.efficiency_backward];
        Self {
            motor: Mass::at_rest(position_m),
            load: Mass::at_rest(position_m),
            memory: Memory::NONE,
            linear,
            propagators: Propagators::of(&linear, step_s, reactions),
            step_s,
            reactions,
            motor_friction_n: axis.motor_coulomb_n_m / r * friction_factor,
            sliding_n: axis.load_friction_n(load.wheel_load_n(axis)) * friction_factor,
            pulley_n: load.hung.pulley_friction * load.hung.weight_n.abs(),
            stribeck_excess: axis.stribeck_excess,
            per_stribeck_speed_s_m: 1.0 / axis.stribeck_speed_m_s,
            bump: axis.bump,
            mid_m: 0.5 * (axis.hard_low_m + axis.hard_high_m),
            per_half_travel_1_m: 2.0 / (axis.hard_high_m - axis.hard_low_m),
            asymmetry: axis.asymmetry,
            drag_n_s2_m2: load.drag_n_s2_m2() + load.strut_n_s2_m2(axis),
            hung_n: load.hung.weight_n,
            floor_m: load.hung.floor_m,
            low_m: axis.hard_low_m,
            high_m: axis.hard_high_m,
            added_n: load.hung.pulley_friction * load.hung.weight_n.abs(),
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

    /// Several steps under the motor's forces at the chain, N: the same as [`Self::step`] for each, bit for bit, with the state kept in
    /// registers while both masses slide on.
    #[inline]
    pub fn steps<const COUNT: usize>(&mut self, motor_n: [f64; COUNT]) {
        let mut done = 0;
        while done < COUNT {
            done += self.slide(&motor_n[done..]);
            done += self.rest(&motor_n[done..]);
            if let Some(&motor_n) = motor_n.get(done) {
                self.step(motor_n);
                done += 1;
            }
        }
    }

    /// As many of the steps as both masses stay at rest: nothing changes meanwhile but the motor's force.
    #[inline]
    fn rest(&mut self, motor_n: &[f64]) -> usize {
        if self.motor.direction != 0.0 || self.load.direction != 0.0 {
            return 0;
        }
        let (spring_n, outer_n) = (self.spring_n(), self.outer_n());
        let load_friction_n = self.load_friction_at(spring_n + outer_n);
        if (spring_n + outer_n).abs() > load_friction_n {
            return 0;
        }
        self.friction_n = load_friction_n;
        let [drive, driven] = self.reactions;
        let mean_n = 0.5 * (drive + driven) * spring_n;
        let friction_n = self.motor_friction_n + 0.5 * (drive - driven) * spring_n.abs();
        motor_n.iter().take_while(|&motor_n| (motor_n - mean_n).abs() <= friction_n).count()
    }

    /// As many of the steps as both masses slide through without an event.
    #[inline]
    fn slide(&mut self, motor_n: &[f64]) -> usize {
        let (d_q, d_y) = (self.motor.direction, self.load.direction);
        if d_q == 0.0 || d_y == 0.0 || self.memory.direction != d_y {
            return 0;
        }
        let Self { mut memory, mut friction_n, high_m, .. } = *self;
        let low_m = self.low_m.max(self.floor_m);
        let (mut q, mut v_q) = (self.motor.position_m, self.motor.speed_m_s);
        let (mut y, mut v_y) = (self.load.position_m, self.load.speed_m_s);
        let is_driven = d_q * self.spring_n() < 0.0;
        let [to_q, to_y, to_vq, to_vy] = self.propagators.both[usize::from(is_driven)];
        let mut done = 0;
        for &motor_n in motor_n {
            let extension_m = q - y;
            let spring_n = self.linear.stiffness_n_m * extension_m + self.linear.damping_n_s_m * (v_q - v_y);
            let now_n = self.friction_of(y, v_y, d_y);
            let mut next = memory;
            let f_q = motor_n - d_q * self.motor_friction_n;
            let f_y = next.extrapolated(-self.drag_n_s2_m2 * v_y * v_y.abs() - self.hung_n, now_n);
            let row = |r: [f64; 5]| ((r[0] * extension_m + r[1] * v_q) + (r[2] * v_y + r[3] * f_q)) + r[4] * f_y;
            let (dq, dy, vq, vy) = (row(to_q), row(to_y), row(to_vq), row(to_vy));
            let is_plain = (d_q * spring_n < 0.0) == is_driven && y >= low_m && y <= high_m;
            if !(vq * d_q > 0.0 && vy * d_y > 0.0 && is_plain) {
                break;
            }
            (q, y, v_q, v_y) = (q + dq, y + dy, vq, vy);
            (memory, friction_n) = (next, now_n);
            done += 1;
        }
        (self.motor.position_m, self.motor.speed_m_s) = (q, v_q);
        (self.load.position_m, self.load.speed_m_s) = (y, v_y);
        (self.memory, self.friction_n) = (memory, friction_n);
        done
    }

    /// One step under the motor's force at the chain, (n/R) τ_m, N.
    pub fn step(&mut self, motor_n: f64) {
        let extension_m = self.motor.position_m - self.load.position_m;
        let spring_n = self.spring_at(extension_m);
        let outer_n = self.outer_n();
        let [drive, driven] = self.reactions;
        let motor_net_n = motor_n - 0.5 * (drive + driven) * spring_n;
        let motor_friction_n = self.motor_friction_n + 0.5 * (drive - driven) * spring_n.abs();
        let load_net_n = spring_n + outer_n;
        let load_friction_n = self.load_friction_at(load_net_n);
        self.friction_n = load_friction_n;
        self.motor.release(motor_net_n, motor_friction_n);
        self.load.release(load_net_n, load_friction_n);

        let (d_q, d_y) = (self.motor.direction, self.load.direction);
        if self.memory.direction != d_y {
            self.memory = Memory { direction: d_y, outer_n, friction_n: [load_friction_n; 2] };
        }
        let f_q = motor_n - d_q * self.motor_friction_n;
        let reaction = usize::from(d_q * spring_n < 0.0);
        let (v_q, v_y) = (self.motor.speed_m_s, self.load.speed_m_s);
        if d_q != 0.0 && d_y != 0.0 {
            let f_y = self.memory.extrapolated(outer_n, load_friction_n);
            let [dq, dy, vq, vy] = self.propagators.both[reaction]
                .map(|r| ((r[0] * extension_m + r[1] * v_q) + (r[2] * v_y + r[3] * f_q)) + r[4] * f_y);
            self.motor.advance(dq, vq, motor_net_n, motor_friction_n);
            self.load.advance(dy, vy, load_net_n, load_friction_n);
        } else if d_q != 0.0 {
            let [dq, vq] = self.propagators.motor[reaction].map(|r| r[0] * extension_m + r[1] * v_q + r[2] * f_q);
            self.motor.advance(dq, vq, motor_net_n, motor_friction_n);
        } else if d_y != 0.0 {
            let f_y = self.memory.extrapolated(outer_n, load_friction_n);
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
        let hung_n = if y >= self.floor_m { self.hung_n } else { 0.0 };
        let free_n = -self.drag_n_s2_m2 * v * v.abs() - hung_n;
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
        self.friction_of(self.load.position_m, self.load.speed_m_s, direction)
    }

    #[inline]
    fn friction_of(&self, position_m: f64, speed_m_s: f64, direction: f64) -> f64 {
        let u = (position_m - self.mid_m) * self.per_half_travel_1_m;
        let bump = 1.0 + self.bump * (1.0 - u * u).max(0.0);
        let w = speed_m_s * self.per_stribeck_speed_s_m;
        let stribeck = 1.0 + self.stribeck_excess / (1.0 + w * w);
        let sliding_n = self.sliding_n * bump * stribeck * (1.0 + self.asymmetry * direction);
        (sliding_n + self.added_n).max(0.0)
    }

    /// Sets what changes from outside.
    pub fn disturb(&mut self, disturbance: Disturbance) {
        self.added_n = self.pulley_n + disturbance.noise_n + disturbance.jam_n;
    }

    /// The chain breaks: from here on the two masses know nothing of each other.
    pub fn break_chain(&mut self) {
        self.linear.stiffness_n_m = 0.0;
        self.linear.damping_n_s_m = 0.0;
        self.propagators = Propagators::of(&self.linear, self.step_s, self.reactions);
    }

    /// Sets both masses moving at one speed, the chain slack (a test's initial state).
    pub fn launch(&mut self, speed_m_s: f64) {
        for mass in [&mut self.motor, &mut self.load] {
            mass.speed_m_s = speed_m_s;
            mass.direction = if speed_m_s == 0.0 { 0.0 } else { 1.0_f64.copysign(speed_m_s) };
        }
        self.memory = Memory::NONE;
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
    pub fn friction_n(&self) -> f64 {
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
}
