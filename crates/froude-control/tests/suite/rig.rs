//! A rigid carriage for the tests: J θ̈ + B θ̇ + C sgn θ̇ = K_T K_amp v_c, with stick, end switches and an encoder.

use froude_control::Controller;
use froude_control::config::{AxisConfig, Config, Drive};
use froude_control::request::Request;
use froude_control::status::{Output, Phase};
use froude_control::tick::{AXES, AxisCommand, AxisInput, Tick};

/// Steps of the plant in a tick.
const SUBSTEPS: u32 = 10;

/// One axis, rigid.
#[derive(Debug, Clone, Copy)]
pub struct Plant {
    pub drive: Drive,
    pub low_switch_m: f64,
    pub high_switch_m: f64,
    pub position_m: f64,
    pub speed_m_s: f64,
    /// True Coulomb friction, N m.
    pub coulomb_n_m: f64,
    /// Force on the carriage along the axis, N.
    pub load_n: f64,
    /// −1 when the encoder's lines are exchanged.
    pub encoder_polarity: f64,
    pub count_at_zero: u32,
    pub frozen_count: Option<u32>,
    pub current_a: f64,
}

impl Plant {
    pub fn new(config: &AxisConfig, position_m: f64) -> Self {
        Self {
            drive: config.drive,
            low_switch_m: config.limits.low_switch_m,
            high_switch_m: config.limits.high_switch_m,
            position_m,
            speed_m_s: 0.0,
            coulomb_n_m: config.drive.coulomb_n_m,
            load_n: 0.0,
            encoder_polarity: 1.0,
            count_at_zero: 0,
            frozen_count: None,
            current_a: 0.0,
        }
    }

    /// Moves on by one tick under a command.
    pub fn step(&mut self, command: AxisCommand, tick_s: f64) {
        let d = self.drive;
        let per_motor = d.sprocket_radius_m / d.gear_ratio;
        let volts = if command.is_enabled { command.volts } else { 0.0 };
        self.current_a = d.amplifier_a_v * volts;
        let torque = d.torque_constant_n_m_a * self.current_a + self.load_n * per_motor;
        let dt = tick_s / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            let omega = self.speed_m_s / per_motor;
            let free = torque - d.viscous_n_m_s_rad * omega;
            // Friction takes at most what stops the motor within the step.
            let stop = free + d.inertia_kg_m2 * omega / dt;
            let friction = stop.clamp(-self.coulomb_n_m, self.coulomb_n_m);
            self.speed_m_s += per_motor * (free - friction) / d.inertia_kg_m2 * dt;
            self.position_m += self.speed_m_s * dt;
        }
    }

    pub fn input(&self) -> AxisInput {
        let d = self.drive;
        let counts_per_m = d.gear_ratio / d.sprocket_radius_m * d.counts_per_revolution / (2.0 * std::f64::consts::PI);
        let count = (self.position_m * counts_per_m * d.encoder_sign * self.encoder_polarity).floor() as i64;
        let encoder_count = self.count_at_zero.wrapping_add(count as u32);
        AxisInput {
            encoder_count: self.frozen_count.unwrap_or(encoder_count),
            encoder_errors: 0,
            current_a: self.current_a,
            is_low_end: self.position_m <= self.low_switch_m,
            is_high_end: self.position_m >= self.high_switch_m,
            is_amplifier_ready: true,
        }
    }
}

/// Controller and plants.
#[derive(Debug, Clone, Copy)]
pub struct Rig {
    pub config: Config,
    pub controller: Controller,
    pub plants: [Plant; AXES],
    pub tick: Tick,
    pub output: Output,
}

impl Rig {
    pub fn new(config: &Config, start_m: f64) -> Self {
        let plants = config.axes.map(|axis| Plant::new(&axis, start_m));
        let mut tick = Tick { is_host_heard: true, ..Tick::default() };
        for (input, plant) in tick.axes.iter_mut().zip(&plants) {
            *input = plant.input();
        }
        Self { config: *config, controller: Controller::new(*config).unwrap(), plants, tick, output: Output::default() }
    }

    /// One tick; `change` may spoil its inputs.
    pub fn step_with(&mut self, request: Option<Request>, change: impl FnOnce(&mut Tick)) -> Output {
        for (input, plant) in self.tick.axes.iter_mut().zip(&self.plants) {
            *input = plant.input();
        }
        self.tick.request = request;
        let mut tick = self.tick;
        change(&mut tick);
        self.output = self.controller.step(&tick);
        for (plant, command) in self.plants.iter_mut().zip(self.output.command.axes) {
            plant.step(command, f64::from(self.config.tick_us) * 1e-6);
        }
        self.tick.latched_us = tick.latched_us.wrapping_add(self.config.tick_us);
        self.output
    }

    pub fn step(&mut self, request: Option<Request>) -> Output {
        self.step_with(request, |_| {})
    }

    /// Asks, and steps until both axes are as `wanted` says, for at most `seconds`.
    pub fn until(&mut self, request: Option<Request>, seconds: f64, wanted: impl Fn(&Output) -> bool) -> Output {
        let ticks = (seconds / (f64::from(self.config.tick_us) * 1e-6)) as u64;
        let mut output = self.step(request);
        assert_eq!(output.status.refusal, None, "{request:?} was refused");
        for _ in 0..ticks {
            if wanted(&output) {
                return output;
            }
            output = self.step(None);
        }
        panic!("not reached in {seconds} s: {:?}", output.status);
    }
}

/// A rig whose long axis is enabled and homed; it stands where homing leaves it.
pub fn homed_at(start_m: f64) -> Rig {
    homed(&Config::PUBLISHED, start_m)
}

/// The same with another configuration.
pub fn homed(config: &Config, start_m: f64) -> Rig {
    let mut rig = Rig::new(config, start_m);
    rig.until(Some(Request::Enable { axis: 0 }), 0.1, |o| o.status.axes[0].phase == Phase::Holding);
    rig.until(Some(Request::Home { axis: 0 }), 120.0, |o| o.status.axes[0].phase == Phase::Holding);
    rig
}
