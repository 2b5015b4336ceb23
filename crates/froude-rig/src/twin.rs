//! The digital twin: both axes with amplifiers, encoders, switches and force sensor, one controller tick at a time.
//!
//! ```text
//! Command ─► amplifier ─► plant (five steps of 50 µs) ─► encoder, switches, current monitor ─► Tick
//! ```
//!
//! **Setting.** Independent axes, as in MCD III.B; 0 is the long axis y, 1 the short axis x. The force sensor is on y.
//! **Time.** A tick is 250 µs of the board's clock; a command acts one plant step after the tick that it answers.
//! **Chance.** All of it comes from one seed: the same commands give the same ticks, bit for bit.
//!
//! What differs from run to run ([`Spread`]): friction and K_T by a factor each, the sensor's zero. What wanders within a run:
//! the load's friction (Ornstein–Uhlenbeck).
//!
//! Not here: coupling between axes, waves and wake, temperature, torque ripple, quadrature below one count.

use crate::amplifier::{Amplifier, AmplifierConfig};
use crate::encoder::Encoder;
use crate::force_sensor::{ForceSensor, ForceSensorConfig};
use crate::injection::{Injection, Scheduled};
use crate::load::Load;
use crate::noise::OrnsteinUhlenbeck;
use crate::parameters::AxisParameters;
use crate::plant::{Disturbance, Plant};
use froude_control::tick::{AXES, AxisCommand, AxisInput, Command, Tick};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// The controller's tick, µs.
pub const TICK_US: u32 = 250;
/// The same, s.
pub const TICK_S: f64 = 250e-6;
/// Plant steps in a tick.
pub const STEPS: usize = 5;

/// What chance does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Run-to-run standard deviation of all Coulomb friction, as a fraction.
    pub friction_run: f64,
    /// Run-to-run standard deviation of K_T, as a fraction.
    pub torque_constant_run: f64,
    /// Standard deviation of the slow friction noise, N.
    pub friction_noise_n: f64,
    /// Its correlation time, s.
    pub friction_noise_s: f64,
}

impl Default for Spread {
    fn default() -> Self {
        Self { friction_run: 0.02, torque_constant_run: 0.005, friction_noise_n: 0.05, friction_noise_s: 0.3 }
    }
}

impl Spread {
    /// No chance at all.
    pub const NONE: Self =
        Self { friction_run: 0.0, torque_constant_run: 0.0, friction_noise_n: 0.0, friction_noise_s: 1.0 };

    fn friction_noise(&self, rng: &mut Pcg64Mcg) -> OrnsteinUhlenbeck {
        OrnsteinUhlenbeck::new(self.friction_noise_n, self.friction_noise_s, TICK_S, rng)
    }
}

/// One axis of the twin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisTwin {
    /// The mechanics.
    pub parameters: AxisParameters,
    /// What rides on it.
    pub load: Load,
    /// The drive.
    pub amplifier: AmplifierConfig,
    /// Where it stands at power-up, m.
    pub start_m: f64,
    /// What the board's counter reads at power-up.
    pub counter_start: u32,
}

/// The whole rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwinConfig {
    /// The axes.
    pub axes: [AxisTwin; AXES],
    /// The force sensor on y.
    pub force_sensor: ForceSensorConfig,
    /// Chance.
    pub spread: Spread,
    /// The board's clock at power-up, µs.
    pub clock_start_us: u32,
}

impl Default for TwinConfig {
    /// The paper's carriage without a body; every counter starts just before its wrap.
    fn default() -> Self {
        Self::loaded(Load::default())
    }
}

impl TwinConfig {
    /// The paper's carriage with this load. The body rides on both axes, a hung weight pulls on y only.
    #[must_use]
    pub fn loaded(load: Load) -> Self {
        let axis = |parameters, load, start_m| AxisTwin {
            parameters,
            load,
            amplifier: AmplifierConfig::default(),
            start_m,
            counter_start: u32::MAX - 1_000,
        };
        let short = Load { hung: crate::load::HungWeight::default(), ..load };
        Self {
            axes: [axis(AxisParameters::long(), load, 0.5), axis(AxisParameters::short(), short, 0.3)],
            force_sensor: ForceSensorConfig::default(),
            spread: Spread::default(),
            clock_start_us: u32::MAX - 1_000_000,
        }
    }
}

/// What the twin knows of an axis and no sensor shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// y, m.
    pub load_position_m: f64,
    /// ẏ, m/s.
    pub load_speed_m_s: f64,
    /// Rθ/n, m.
    pub motor_position_m: f64,
    /// Its speed, m/s.
    pub motor_speed_m_s: f64,
    /// Drag of the body, resistance to +y positive, N.
    pub drag_n: f64,
    /// Force of the chain on the load, N.
    pub spring_n: f64,
    /// Friction of the load (sliding, or breakaway at rest), N ≥ 0.
    pub friction_n: f64,
    /// Motor current, A.
    pub current_a: f64,
    /// Motor torque, N m.
    pub torque_n_m: f64,
    /// True encoder count from coordinate zero.
    pub count: i64,
}

#[derive(Debug, Clone, PartialEq)]
struct Axis {
    config: AxisTwin,
    plant: Plant,
    amplifier: Amplifier,
    encoder: Encoder,
    noise: OrnsteinUhlenbeck,
    friction_factor: f64,
    torque_factor: f64,
    newtons_per_ampere: f64,
    jam_n: f64,
    is_low_wire_cut: bool,
    is_high_wire_cut: bool,
    is_current_bad: bool,
    acceleration_m_s2: f64,
}

impl Axis {
    fn new(config: &AxisTwin, spread: &Spread, rng: &mut Pcg64Mcg) -> Self {
        let p = &config.parameters;
        let step_s = TICK_S / STEPS as f64;
        let counts_per_m = p.encoder_sign / p.metres_per_count();
        let mut axis = Self {
            plant: Plant::new(p, &config.load, step_s, config.start_m, 1.0),
            amplifier: Amplifier::new(config.amplifier, step_s),
            encoder: Encoder::powered_up(counts_per_m, config.counter_start, config.start_m),
            noise: OrnsteinUhlenbeck::new(0.0, 1.0, TICK_S, rng),
            friction_factor: 1.0,
            torque_factor: 1.0,
            newtons_per_ampere: 0.0,
            jam_n: 0.0,
            is_low_wire_cut: false,
            is_high_wire_cut: false,
            is_current_bad: false,
            acceleration_m_s2: 0.0,
            config: *config,
        };
        axis.begin_run(config.load, spread, rng);
        axis
    }

    /// New load, new draws; the axis stays where it is, at rest.
    fn begin_run(&mut self, load: Load, spread: &Spread, rng: &mut Pcg64Mcg) {
        let mut factor = |std: f64| {
            let draw: f64 = rng.sample(StandardNormal);
            1.0 + std * draw
        };
        self.friction_factor = factor(spread.friction_run);
        self.torque_factor = factor(spread.torque_constant_run);
        self.noise = spread.friction_noise(rng);
        self.config.load = load;
        let p = &self.config.parameters;
        self.newtons_per_ampere = p.torque_constant_n_m_a * self.torque_factor / p.chain_m_rad();
        self.plant = self.plant.reloaded(p, &load, self.friction_factor);
    }

    fn disturb(&mut self, rng: &mut Pcg64Mcg) {
        self.plant.disturb(Disturbance { noise_n: self.noise.step(rng), jam_n: self.jam_n });
    }

    fn command(&mut self, command: AxisCommand, is_estop: bool) {
        self.amplifier.command(command.volts, command.is_enabled);
        self.amplifier.interlock(is_estop, self.is_low_end(), self.is_high_end());
    }

    /// One tick of the mechanics. The command arrives one step after the tick that it answers.
    fn advance(&mut self, command: AxisCommand, is_estop: bool) {
        let before_m_s = self.plant.load_speed_m_s();
        let mut current_a = [0.0; STEPS];
        current_a[0] = self.amplifier.step();
        self.command(command, is_estop);
        for mean_a in &mut current_a[1..] {
            *mean_a = self.amplifier.step();
        }
        self.plant.steps(current_a.map(|a| self.newtons_per_ampere * a));
        self.acceleration_m_s2 = (self.plant.load_speed_m_s() - before_m_s) * (1.0 / TICK_S);
    }

    fn is_low_end(&self) -> bool {
        self.is_low_wire_cut || self.plant.load_position_m() < self.config.parameters.low_switch_m()
    }

    fn is_high_end(&self) -> bool {
        self.is_high_wire_cut || self.plant.load_position_m() > self.config.parameters.high_switch_m()
    }

    fn latch(&mut self, rng: &mut Pcg64Mcg) -> AxisInput {
        let current_a = self.amplifier.monitor(rng);
        AxisInput {
            encoder_count: self.encoder.read(self.plant.motor_position_m(), TICK_S, rng),
            encoder_errors: self.encoder.errors(),
            current_a: if self.is_current_bad { f64::NAN } else { current_a },
            is_low_end: self.is_low_end(),
            is_high_end: self.is_high_end(),
            is_amplifier_ready: self.amplifier.is_ready(),
        }
    }
}

/// The rig in motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Twin {
    axes: [Axis; AXES],
    sensor: ForceSensor,
    force_sensor: ForceSensorConfig,
    spread: Spread,
    rng: Pcg64Mcg,
    ticks: u64,
    latched_us: u32,
    force_n: f64,
    is_estop_open: bool,
    is_host_silent: bool,
    schedule: Vec<Scheduled>,
}

impl Twin {
    /// Powers up: at rest, drives off.
    #[must_use]
    pub fn new(config: &TwinConfig, seed: u64) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let axes = [0, 1].map(|i| Axis::new(&config.axes[i], &config.spread, &mut rng));
        Self {
            axes,
            sensor: ForceSensor::new(config.force_sensor, TICK_S, &mut rng),
            force_sensor: config.force_sensor,
            spread: config.spread,
            rng,
            ticks: 0,
            latched_us: config.clock_start_us,
            force_n: 0.0,
            is_estop_open: false,
            is_host_silent: false,
            schedule: Vec::new(),
        }
    }

    /// The operator mounts a load and a new run begins: friction, K_T and the sensor's zero are drawn anew from this seed.
    ///
    /// The axes are at rest where they were; counters, clock and coordinate go on.
    pub fn begin_run(&mut self, loads: [Load; AXES], seed: u64) {
        self.rng = Pcg64Mcg::seed_from_u64(seed);
        for (axis, load) in self.axes.iter_mut().zip(loads) {
            axis.begin_run(load, &self.spread, &mut self.rng);
        }
        self.sensor = ForceSensor::new(self.force_sensor, TICK_S, &mut self.rng);
    }

    /// What is noise within a run is drawn anew from this seed: the record does not depend on the way to its start.
    pub fn begin_recording(&mut self, seed: u64) {
        self.rng = Pcg64Mcg::seed_from_u64(seed);
        for axis in &mut self.axes {
            axis.noise = self.spread.friction_noise(&mut self.rng);
        }
        self.sensor.wander_anew(TICK_S, &mut self.rng);
    }

    /// Breaks something later.
    pub fn inject(&mut self, scheduled: Scheduled) {
        self.schedule.push(scheduled);
    }

    /// Applies a command for one tick and latches the inputs at its end.
    ///
    /// The host is heard every tick; its request is the caller's to add.
    pub fn tick(&mut self, command: Command) -> Tick {
        let late_us = if self.schedule.is_empty() { 0 } else { self.break_what_is_due() };
        for _ in 0..=late_us / TICK_US {
            for (axis, command) in self.axes.iter_mut().zip(command.axes) {
                axis.disturb(&mut self.rng);
                axis.advance(command, self.is_estop_open);
            }
        }
        self.latched_us = self.latched_us.wrapping_add(TICK_US + late_us / TICK_US * TICK_US);
        self.ticks += 1;
        let y = &self.axes[0];
        let felt_n = self.sensed_drag_n() + y.config.load.body_inertia_kg() * y.acceleration_m_s2;
        self.force_n = self.sensor.read(felt_n, &mut self.rng);
        Tick {
            latched_us: self.latched_us,
            axes: [self.axes[0].latch(&mut self.rng), self.axes[1].latch(&mut self.rng)],
            is_estop_open: self.is_estop_open,
            is_host_heard: !self.is_host_silent,
            request: None,
        }
    }

    fn sensed_drag_n(&self) -> f64 {
        let Axis { config: AxisTwin { parameters, load, .. }, plant, .. } = &self.axes[0];
        let v = plant.load_speed_m_s();
        let strut = if load.is_strut_below_sensor { load.strut_n_s2_m2(parameters) } else { 0.0 };
        (load.drag_n_s2_m2() + strut) * v * v.abs()
    }

    /// Applies what is scheduled for this tick; returns by how much the tick is late.
    fn break_what_is_due(&mut self) -> u32 {
        let mut late_us = 0;
        let now = self.ticks;
        for s in self.schedule.extract_if(.., |s| s.tick <= now).collect::<Vec<_>>() {
            let Some(axis) = self.axes.get_mut(s.axis) else { continue };
            let at_m = axis.plant.motor_position_m();
            match s.injection {
                Injection::Encoder(fault) => axis.encoder.set_fault(fault, at_m),
                Injection::EncoderJump(counts) => axis.encoder.jump(counts),
                Injection::Amplifier(fault) => axis.amplifier.set_fault(fault),
                Injection::EmergencyStop => self.is_estop_open = true,
                Injection::LowEndSwitch => axis.is_low_wire_cut = true,
                Injection::HighEndSwitch => axis.is_high_wire_cut = true,
                Injection::TickLate(us) => late_us += us,
                Injection::HostSilent => self.is_host_silent = true,
                Injection::NotFiniteCurrent => axis.is_current_bad = true,
                Injection::FrictionJam(newtons) => axis.jam_n = newtons,
                Injection::TorqueLoss(part) => axis.newtons_per_ampere *= part,
                Injection::ChainBreak => axis.plant.break_chain(),
            }
        }
        late_us
    }

    /// The force sensor's reading at the last tick, N; resistance to +y motion is positive.
    #[must_use]
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    /// The sensor's zero error, N (truth).
    #[must_use]
    pub fn force_drift_n(&self) -> f64 {
        self.sensor.drift_n()
    }

    /// Ticks since power-up.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// Simulated time since power-up, s (late ticks not counted).
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.ticks as f64 * TICK_S
    }

    /// What no sensor shows, of axis 0 (y) or 1 (x).
    #[must_use]
    pub fn truth(&self, axis: usize) -> Truth {
        let a = &self.axes[axis];
        let v = a.plant.load_speed_m_s();
        Truth {
            load_position_m: a.plant.load_position_m(),
            load_speed_m_s: v,
            motor_position_m: a.plant.motor_position_m(),
            motor_speed_m_s: a.plant.motor_speed_m_s(),
            drag_n: a.config.load.drag_n_s2_m2() * v * v.abs(),
            spring_n: a.plant.spring_n(),
            friction_n: a.plant.friction_n(),
            current_a: a.amplifier.current_a(),
            torque_n_m: a.newtons_per_ampere * a.amplifier.current_a() * a.config.parameters.chain_m_rad(),
            count: a.encoder.true_count(a.plant.motor_position_m()),
        }
    }

    /// The factors drawn for this run on an axis: friction and K_T.
    #[must_use]
    pub fn run_factors(&self, axis: usize) -> (f64, f64) {
        (self.axes[axis].friction_factor, self.axes[axis].torque_factor)
    }

    /// Whether both loads are off their hard stops.
    #[must_use]
    pub fn is_inside_travel(&self) -> bool {
        self.axes.iter().all(|a| a.plant.is_inside_travel())
    }

    /// Commands that were not finite, on both axes.
    #[must_use]
    pub fn refused_inputs(&self) -> u64 {
        self.axes.iter().map(|a| a.amplifier.refused_inputs()).sum()
    }
}
