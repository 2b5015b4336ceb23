//! A small rig for the emulated board and the tests: two axes, each a motor with inertia, friction and true stick.
//!
//! J θ̈ = K_T K_amp v − B θ̇ − C sgn θ̇, stepped at the tick (semi-implicit Euler); the encoder is θ in whole counts. It is
//! here to move when commanded, the same way on every machine; for physics there is the twin.

use froude_control::config::{AxisConfig, Config, Limits};
use froude_control::tick::{AXES, AxisInput, Command};

/// Tick, s.
pub const TICK_S: f64 = 250e-6;

/// The paper's carriage: the long axis as published with its 13 Hz mode, the short one 0.65 m long with 45 Hz.
pub const CONFIG: Config = {
    let y = AxisConfig { mode_hz: 13.0, mode_damping: 0.02, ..AxisConfig::PUBLISHED };
    let limits = Limits { hard_high_m: 0.70, high_switch_m: 0.65, ..y.limits };
    let x = AxisConfig { limits, mode_hz: 45.0, ..y };
    Config { axes: [y, x], ..Config::PUBLISHED }
};

/// One axis of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigAxis {
    config: AxisConfig,
    /// Motor angle, rad; 0 where the axis coordinate is 0.
    pub angle_rad: f64,
    /// Its speed, rad/s.
    pub speed_rad_s: f64,
    /// Motor current, A.
    pub current_a: f64,
}

/// Both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rig {
    /// The axes.
    pub axes: [RigAxis; AXES],
}

impl Default for Rig {
    fn default() -> Self {
        let [y, x] = &CONFIG.axes;
        Self { axes: [RigAxis::at(y, 0.03), RigAxis::at(x, 0.02)] }
    }
}

impl RigAxis {
    fn at(config: &AxisConfig, position_m: f64) -> Self {
        let angle_rad = position_m * config.drive.gear_ratio / config.drive.sprocket_radius_m;
        Self { config: *config, angle_rad, speed_rad_s: 0.0, current_a: 0.0 }
    }

    /// Moves on by one tick.
    pub fn step(&mut self, volts: f64, is_enabled: bool) {
        let drive = &self.config.drive;
        self.current_a = if is_enabled { drive.amplifier_a_v * volts } else { 0.0 };
        let torque = drive.torque_constant_n_m_a * self.current_a - drive.viscous_n_m_s_rad * self.speed_rad_s;
        // Friction takes at most what stops the motor within the tick: that is stick.
        let free = self.speed_rad_s + torque / drive.inertia_kg_m2 * TICK_S;
        let most = drive.coulomb_n_m / drive.inertia_kg_m2 * TICK_S;
        self.speed_rad_s = if libm::fabs(free) <= most { 0.0 } else { free - libm::copysign(most, free) };
        self.angle_rad += self.speed_rad_s * TICK_S;
        let limits = &self.config.limits;
        let held_m = self.position_m().max(limits.hard_low_m).min(limits.hard_high_m);
        if held_m != self.position_m() {
            self.speed_rad_s = 0.0;
            self.angle_rad = held_m * drive.gear_ratio / drive.sprocket_radius_m;
        }
    }

    /// Axis coordinate, m.
    #[must_use]
    pub fn position_m(&self) -> f64 {
        self.angle_rad * (self.config.drive.sprocket_radius_m / self.config.drive.gear_ratio)
    }

    /// What the controller sees of it.
    #[must_use]
    pub fn input(&self) -> AxisInput {
        let counts = self.angle_rad * (self.config.drive.counts_per_revolution / core::f64::consts::TAU);
        AxisInput {
            encoder_count: libm::floor(counts) as i32 as u32,
            encoder_errors: 0,
            current_a: self.current_a,
            is_low_end: self.position_m() <= self.config.limits.low_switch_m,
            is_high_end: self.position_m() >= self.config.limits.high_switch_m,
            is_amplifier_ready: true,
        }
    }
}

impl Rig {
    /// Moves on by one tick under these commands.
    pub fn step(&mut self, command: &Command) {
        for (axis, out) in self.axes.iter_mut().zip(&command.axes) {
            axis.step(out.volts, out.is_enabled);
        }
    }
}
