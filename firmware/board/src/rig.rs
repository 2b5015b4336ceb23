//! A small rig for the emulated board and the tests: two axes, each a motor with inertia, friction and true stick.
//!
//! J θ̈ = K_T K_amp v − B θ̇ − C sgn θ̇, stepped at the tick (semi-implicit Euler), the encoder is θ in whole counts. It is
//! here to move when it is told to, the same way on every machine; for physics there is the twin.

use froude_control::config::{AxisConfig, Config, Drive, Gains, Limits};
use froude_control::tick::{AXES, AxisInput, Command};

/// Drive of the paper's long axis (its Table II).
const DRIVE: Drive = Drive {
    inertia_kg_m2: 1.502e-5,
    viscous_n_m_s_rad: 4.657e-6,
    coulomb_n_m: 3.9e-3,
    coulomb_lower_n_m: 3.5e-3,
    drag_n_s2_m2: 0.0,
    torque_constant_n_m_a: 26.7e-3,
    amplifier_a_v: 0.352,
    gear_ratio: 34.97,
    sprocket_radius_m: 0.055,
    counts_per_revolution: 4000.0,
    encoder_sign: 1.0,
};

/// A carriage like the paper's, with gains that hold it.
#[must_use]
pub fn config() -> Config {
    let axis = AxisConfig {
        gains: Gains {
            proportional_v_rad: 0.8,
            derivative_v_s_rad: 0.02,
            integral_v_rad_s: 0.8,
            derivative_filter_hz: 200.0,
        },
        drive: DRIVE,
        limits: Limits {
            hard_low_m: -0.1,
            hard_high_m: 5.0,
            speed_m_s: 0.8,
            unhomed_speed_m_s: 0.1,
            acceleration_m_s2: 1.0,
            command_v: 10.0,
            current_a: 6.0,
            continuous_current_a: 3.0,
            thermal_time_s: 30.0,
            following_error_m: 0.02,
            saturation_s: 0.5,
            encoder_errors_per_s: 10,
            polarity_m: 0.005,
            stuck_s: 0.1,
        },
        mode_hz: 13.0,
        mode_damping: 0.02,
        is_robust_shaper: false,
    };
    let short = AxisConfig { limits: Limits { hard_low_m: -0.05, hard_high_m: 0.6, ..axis.limits }, mode_hz: 45.0, ..axis };
    Config { axes: [axis, short], tick_us: 250, late_us: 2000, host_silence_us: 200_000 }
}

/// One axis of the rig.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigAxis {
    /// Motor angle since power-up, rad.
    pub angle_rad: f64,
    /// Its speed, rad/s.
    pub speed_rad_s: f64,
    /// Motor current, A.
    pub current_a: f64,
    /// Chain position of the power-up above the low hard stop, m.
    pub start_m: f64,
    /// Length between the hard stops, m.
    pub travel_m: f64,
}

/// Both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rig {
    /// The axes.
    pub axes: [RigAxis; AXES],
}

impl Default for Rig {
    fn default() -> Self {
        let axis = |start_m, travel_m| RigAxis { start_m, travel_m, ..RigAxis::default() };
        Self { axes: [axis(0.05, 5.1), axis(0.02, 0.65)] }
    }
}

/// Distance from a hard stop at which its end switch opens, m.
const SWITCH_M: f64 = 0.005;

impl RigAxis {
    /// Moves on by one tick.
    pub fn step(&mut self, volts: f64, is_enabled: bool, tick_s: f64) {
        self.current_a = if is_enabled { DRIVE.amplifier_a_v * volts } else { 0.0 };
        let driving = DRIVE.torque_constant_n_m_a * self.current_a - DRIVE.viscous_n_m_s_rad * self.speed_rad_s;
        // Friction takes at most what stops the motor within the tick: that is stick.
        let free = self.speed_rad_s + driving / DRIVE.inertia_kg_m2 * tick_s;
        let most = DRIVE.coulomb_n_m / DRIVE.inertia_kg_m2 * tick_s;
        self.speed_rad_s = if libm::fabs(free) <= most { 0.0 } else { free - libm::copysign(most, free) };
        self.angle_rad += self.speed_rad_s * tick_s;
        let metre_per_rad = DRIVE.sprocket_radius_m / DRIVE.gear_ratio;
        let place = self.start_m + self.angle_rad * metre_per_rad;
        let held = place.max(0.0).min(self.travel_m);
        if held != place {
            self.speed_rad_s = 0.0;
            self.angle_rad = (held - self.start_m) / metre_per_rad;
        }
    }

    /// Chain position above the low hard stop, m.
    #[must_use]
    pub fn place_m(&self) -> f64 {
        self.start_m + self.angle_rad * (DRIVE.sprocket_radius_m / DRIVE.gear_ratio)
    }

    /// What the controller sees of it.
    #[must_use]
    pub fn input(&self) -> AxisInput {
        let counts = self.angle_rad * (DRIVE.counts_per_revolution / core::f64::consts::TAU);
        AxisInput {
            encoder_count: libm::floor(counts) as i64 as u32,
            encoder_errors: 0,
            current_a: self.current_a,
            is_low_end: self.place_m() < SWITCH_M,
            is_high_end: self.place_m() > self.travel_m - SWITCH_M,
            is_amplifier_ready: true,
        }
    }
}

impl Rig {
    /// Moves on by one tick under these commands.
    pub fn step(&mut self, command: &Command, tick_s: f64) {
        for (axis, out) in self.axes.iter_mut().zip(&command.axes) {
            axis.step(out.volts, out.is_enabled, tick_s);
        }
    }
}
