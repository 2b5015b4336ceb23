//! Twin and controller in one loop, as on the carriage.
//!
//! A tick's inputs go to the controller, its command to the twin, whose next tick comes 250 µs later.

use crate::twin::{Twin, TwinConfig};
use froude_control::Controller;
use froude_control::config::{Config, ConfigError};
use froude_control::request::Request;
use froude_control::status::{Output, Phase};
use froude_control::tick::{Command, Tick};

/// The loop.
#[derive(Debug, Clone)]
pub struct ClosedLoop {
    /// The rig.
    pub twin: Twin,
    /// The controller.
    pub controller: Controller,
    /// The tick that the controller answered last.
    pub tick: Tick,
    /// Its answer, on its way to the rig.
    pub output: Output,
    request: Option<Request>,
}

impl ClosedLoop {
    /// Both just powered up.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] from the controller.
    pub fn new(twin: &TwinConfig, control: Config, seed: u64) -> Result<Self, ConfigError> {
        Ok(Self {
            twin: Twin::new(twin, seed),
            controller: Controller::new(control)?,
            tick: Tick::default(),
            output: Output::default(),
            request: None,
        })
    }

    /// Sends a request with the next tick; one that is still waiting is replaced.
    pub fn request(&mut self, request: Request) {
        self.request = Some(request);
    }

    /// One tick: the rig moves on under the last command, the controller answers.
    pub fn step(&mut self) -> &Output {
        let command: Command = self.output.command;
        self.tick = self.twin.tick(command);
        self.tick.request = self.request.take();
        self.output = self.controller.step(&self.tick);
        &self.output
    }

    /// Sends a request and goes on until the axis holds or is off, at most `ticks`; whether it was carried out without a fault.
    pub fn carry_out(&mut self, request: Request, axis: usize, ticks: u64) -> bool {
        self.request(request);
        if self.step().status.refusal.is_some() {
            return false;
        }
        for _ in 0..ticks {
            let status = &self.output.status;
            if status.fault.is_some() {
                return false;
            }
            if matches!(status.axes[axis].phase, Phase::Holding | Phase::Disabled) {
                return true;
            }
            self.step();
        }
        false
    }

    /// Enables and homes both axes; whether both are homed.
    pub fn home(&mut self) -> bool {
        self.step();
        // At the capped speed over the longest travel, and as long again.
        let longest = 4_000_000;
        (0..froude_control::tick::AXES).all(|axis| {
            self.carry_out(Request::Enable { axis }, axis, 1) && self.carry_out(Request::Home { axis }, axis, longest)
        })
    }
}
