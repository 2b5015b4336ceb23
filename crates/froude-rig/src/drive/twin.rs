//! The twin as a rig: the same controller that runs on the board, in the loop with the simulated plant.

use froude_control::Controller;
use froude_control::config::Config;
use froude_control::request::Request;
use froude_control::tick::{AXES, Command, Tick};

use super::{AxisSample, Rig, RigError, Sample};
use crate::load::{HungWeight, Load};
use crate::twin::{TICK_US, Twin, TwinConfig};

/// Controller and plant, tick by tick.
#[derive(Debug, Clone)]
pub struct TwinRig {
    twin: Twin,
    controller: Controller,
    command: Command,
    seed: u64,
    run_seed: u64,
    hung_n: f64,
    has_force_sensor: bool,
}

/// Steps in which a weight is let down, and ticks of each: half a second.
const LETTING_DOWN: u32 = 50;
const TICKS_A_STEP: u32 = 40;

impl TwinRig {
    /// Powers both up.
    ///
    /// # Errors
    ///
    /// [`RigError::Config`].
    pub fn new(twin: &TwinConfig, config: Config, seed: u64) -> Result<Self, RigError> {
        Ok(Self {
            twin: Twin::new(twin, seed),
            controller: Controller::new(config).map_err(RigError::Config)?,
            command: Command::default(),
            seed,
            run_seed: seed,
            hung_n: 0.0,
            has_force_sensor: true,
        })
    }

    /// The same rig without its force sensor.
    #[must_use]
    pub fn without_force_sensor(mut self) -> Self {
        self.has_force_sensor = false;
        self
    }

    /// The plant, for injections and for what only it knows.
    pub fn twin_mut(&mut self) -> &mut Twin {
        &mut self.twin
    }

    /// The tick that the plant gives for the last command; the controller has not seen it yet.
    fn latch(&mut self, request: Option<Request>) -> Tick {
        let mut tick = self.twin.tick(self.command);
        tick.request = request;
        tick
    }
}

impl Rig for TwinRig {
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RigError> {
        let tick = self.latch(request);
        let output = self.controller.step(&tick);
        self.command = output.command;
        let mut axes = [AxisSample::default(); AXES];
        let parts = axes.iter_mut().zip(&output.status.axes).zip(&output.command.axes).zip(&tick.axes);
        for (((sample, status), command), input) in parts {
            *sample = AxisSample {
                count: status.count,
                position_m: status.position_m,
                reference_m: status.reference_m,
                reference_m_s: status.reference_m_s,
                reference_m_s2: status.reference_m_s2,
                command_v: command.volts,
                current_a: input.current_a,
                phase: status.phase,
                is_homed: status.is_homed,
            };
        }
        Ok(Sample {
            tick: self.twin.ticks(),
            axes,
            force_n: self.has_force_sensor.then(|| self.twin.force_n()),
            fault: output.status.fault,
            refusal: output.status.refusal,
            stranger: None,
            truth: Some([self.twin.truth(0), self.twin.truth(1)]),
        })
    }

    fn rate_hz(&self) -> f64 {
        1e6 / f64::from(TICK_US)
    }

    fn begin_run(&mut self, load: &Load, run_number: u64) {
        // A stream of its own for each run, so that a resumed campaign draws what it would have drawn.
        let seed = self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(run_number);
        self.run_seed = seed;
        let hung_n = load.hung.weight_n;
        // Nobody drops a weight onto the cord: it is let down in half a second, while the loop holds.
        let steps = if hung_n == self.hung_n { 1 } else { LETTING_DOWN };
        for k in 1..=steps {
            let weight_n = self.hung_n + (hung_n - self.hung_n) * f64::from(k) / f64::from(steps);
            let long = Load { hung: HungWeight { weight_n, ..load.hung }, ..*load };
            let short = Load { hung: HungWeight::default(), ..*load };
            self.twin.begin_run([long, short], seed);
            for _ in 0..if steps > 1 { TICKS_A_STEP } else { 0 } {
                let tick = self.latch(None);
                self.command = self.controller.step(&tick).command;
            }
        }
        self.hung_n = hung_n;
    }

    fn begin_recording(&mut self) {
        // Homing takes its draws too, and only the first run of a session homes.
        self.twin.begin_recording(!self.run_seed);
    }

    fn version(&self) -> String {
        format!("twin {}", env!("CARGO_PKG_VERSION"))
    }
}
