//! The runs that a rig would log, observation by observation: a fast stand-in for the dynamic twin.
//!
//! Tracking is perfect and the chain rigid, so that a campaign of a hundred tows takes milliseconds: this is to prove
//! intervals over hundreds of seeds, not to tune a controller. Everything that makes drag uncertain is here: friction that
//! grows mid-tank, changes from run to run and wanders, K_T that drifts, a gear that loses, a sensor that drifts.
//!
//! **Setting.** Trapezoids of one acceleration, still before and after; pairs of dry and wet runs in turn (dry, wet, wet,
//! dry). The friction's Coulomb part carries the bump and the run-to-run change unless stated otherwise.

// Each user takes a part of it.
#![allow(dead_code)]

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use froude_carriage::drag::{BodyState, DragRun, RunKind};

/// The truth about a rig, its noise and its campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// D_d of the body, N s²/m².
    pub drag_n_s2_m2: f64,
    /// Added mass and water in the body, kg.
    pub added_mass_kg: f64,
    /// Moving mass at the chain, dry, kg.
    pub moving_mass_kg: f64,
    /// (n/R)·K_T·K_amp, N/V.
    pub ideal_force_per_volt_n: f64,
    /// Efficiency of the gear, driving forward.
    pub efficiency: f64,
    /// Coulomb friction at the chain at the ends of the tank, N.
    pub coulomb_n: f64,
    /// Coulomb friction of the motor itself, before the gear, at the chain, N; in addition to [`Scenario::coulomb_n`].
    pub motor_coulomb_n: f64,
    /// Part by which friction is larger along +y and smaller along −y.
    pub one_way: f64,
    /// Viscous friction at the chain, N s/m.
    pub viscous_n_s_m: f64,
    /// Growth of the Coulomb part mid-tank, as a part.
    pub bump: f64,
    /// Standard deviation of the bump over position, m.
    pub bump_width_m: f64,
    /// Length of the tank, m; the bump is at its middle.
    pub tank_m: f64,
    /// Change of the friction from run to run, standard deviation, as a part.
    pub run_to_run: f64,
    /// Whether the viscous part changes from run to run too.
    pub viscous_changes: bool,
    /// Wandering friction: rms, N, and its correlation time, s.
    pub noise_n: f64,
    /// See [`Scenario::noise_n`].
    pub noise_time_s: f64,
    /// Change of K_T from run to run, standard deviation, as a part.
    pub torque_drift: f64,
    /// Friction that buoyancy removes from the wheels in wet runs, N.
    pub buoyancy_friction_n: f64,
    /// Drift of the sensor over a run: uniform, half-width, N.
    pub sensor_drift_n: f64,
    /// Noise of a sensor sample, N.
    pub sensor_noise_n: f64,
    /// Step of the sensor, N.
    pub sensor_step_n: f64,
    /// Speeds, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Number of pairs.
    pub pairs: u32,
    /// Whether every tow is run out and back.
    pub out_and_back: bool,
    /// Start and end of the tows, m.
    pub tow_m: [f64; 2],
    /// Start and end of friction runs (body dry), m; `None`: none are run.
    pub friction_m: Option<[f64; 2]>,
    /// Acceleration of the ramps, m/s².
    pub acceleration_m_s2: f64,
    /// Still before and after, s.
    pub still_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Friction of the pulley that calibration weights hang over, as a part of the weight.
    pub pulley_loss: f64,
    /// True gain of the sensor over its declared one.
    pub sensor_gain: f64,
}

/// What one tow is.
#[derive(Debug, Clone, Copy)]
struct Tow {
    kind: RunKind,
    body: BodyState,
    pair: u32,
    speed_m_s: f64,
    from_m: f64,
    to_m: f64,
    weight_n: f64,
}

impl Scenario {
    /// The pinned scenario: friction of the MCD paper at the chain (C_eff n/R, B_eff (n/R)²), +20 % mid-tank, 2 % from run
    /// to run, 0.05 N rms with 0.3 s, K_T 0.5 % a run, sensor ± 0.2 N, efficiency 0.8, six speeds, five pairs out and back.
    ///
    /// The scenario gives the bump's height, not its width: 0.27 m makes it about half its height in the (tapered) mean over the
    /// steady windows, so that friction identified near one end is wrong there by 0.24 N.
    #[must_use]
    pub fn pinned(drag_n_s2_m2: f64) -> Self {
        let ratio = 34.97 / 0.055;
        Self {
            drag_n_s2_m2,
            added_mass_kg: 6.0,
            moving_mass_kg: 1.502e-5 * ratio * ratio,
            ideal_force_per_volt_n: ratio * 26.7e-3 * 0.352,
            efficiency: 0.8,
            coulomb_n: 3.9e-3 * ratio,
            motor_coulomb_n: 0.0,
            one_way: 0.0,
            viscous_n_s_m: 4.657e-6 * ratio * ratio,
            bump: 0.2,
            bump_width_m: 0.27,
            tank_m: 5.0,
            run_to_run: 0.02,
            viscous_changes: false,
            noise_n: 0.05,
            noise_time_s: 0.3,
            torque_drift: 0.005,
            buoyancy_friction_n: 0.0,
            sensor_drift_n: 0.2,
            sensor_noise_n: 0.02,
            sensor_step_n: 1.0 / 48.0,
            speeds_m_s: (0..6).map(|k| 0.05 + 0.1 * f64::from(k)).collect(),
            pairs: 5,
            out_and_back: true,
            tow_m: [1.4, 3.6],
            friction_m: None,
            acceleration_m_s2: 1.0,
            still_s: 2.0,
            rate_hz: 200.0,
            pulley_loss: 0.01,
            sensor_gain: 1.0,
        }
    }

    /// Coulomb friction at a position, N.
    #[must_use]
    pub fn coulomb_at_n(&self, position_m: f64) -> f64 {
        let x = (position_m - 0.5 * self.tank_m) / self.bump_width_m;
        self.coulomb_n * (1.0 + self.bump * (-0.5 * x * x).exp())
    }

    /// True force per volt, driving forward.
    #[must_use]
    pub fn force_per_volt_n(&self) -> f64 {
        self.ideal_force_per_volt_n * self.efficiency
    }

    /// All runs of a campaign; the same seed gives the same runs.
    #[must_use]
    pub fn runs(&self, seed: u64) -> Vec<Logged> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut out = Vec::new();
        if let Some(within) = self.friction_m {
            for pair in 1..=self.pairs {
                self.sweep(&mut out, RunKind::Friction, BodyState::Dry, pair, within, &mut rng);
            }
        }
        for pair in 1..=self.pairs {
            let [first, second] =
                if pair % 2 == 1 { [BodyState::Dry, BodyState::Wet] } else { [BodyState::Wet, BodyState::Dry] };
            for body in [first, second] {
                self.sweep(&mut out, RunKind::Tow, body, pair, self.tow_m, &mut rng);
            }
        }
        out
    }

    /// All speeds once, or out and back.
    fn sweep(
        &self,
        out: &mut Vec<Logged>,
        kind: RunKind,
        body: BodyState,
        pair: u32,
        [from_m, to_m]: [f64; 2],
        rng: &mut Pcg64,
    ) {
        for &speed_m_s in &self.speeds_m_s {
            let out_tow = Tow { kind, body, pair, speed_m_s, from_m, to_m, weight_n: 0.0 };
            out.push(self.tow(out_tow, rng));
            if self.out_and_back {
                out.push(self.tow(Tow { from_m: to_m, to_m: from_m, ..out_tow }, rng));
            }
        }
    }

    /// Calibration runs: every weight lifted and lowered `repeats` times over the same 0.6 m at 0.1 m/s.
    #[must_use]
    pub fn calibration_runs(&self, weights_n: &[f64], repeats: u32, seed: u64) -> Vec<Logged> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut out = Vec::new();
        for pair in 1..=repeats {
            for &weight_n in weights_n {
                let [from_m, to_m] = [0.5 * self.tank_m - 0.3, 0.5 * self.tank_m + 0.3];
                let (kind, body) = (RunKind::Calibration, BodyState::Dry);
                let lift = Tow { kind, body, pair, speed_m_s: 0.1, from_m, to_m, weight_n };
                out.push(self.tow(lift, &mut rng));
                out.push(self.tow(Tow { from_m: to_m, to_m: from_m, ..lift }, &mut rng));
            }
        }
        out
    }

    /// One tow.
    fn tow(&self, tow: Tow, rng: &mut Pcg64) -> Logged {
        let Tow { kind, body, pair, speed_m_s: speed, from_m, to_m, weight_n } = tow;
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let friction_factor = 1.0 + self.run_to_run * normal();
        let torque_factor = 1.0 + self.torque_drift * normal();
        let mut wander = self.noise_n * normal();
        let direction = (to_m - from_m).signum();
        let profile = Trapezoid::new((to_m - from_m).abs(), speed, self.acceleration_m_s2);
        let n = ((profile.duration_s + 2.0 * self.still_s) * self.rate_hz).round() as usize + 2;
        let kept = (-1.0 / (self.rate_hz * self.noise_time_s)).exp();
        let fresh = self.noise_n * (1.0 - kept * kept).sqrt();
        let drift_n = self.sensor_drift_n * (2.0 * rng.random::<f64>() - 1.0);
        // The drift is an exponential of time, rising early or late: not a straight line.
        let bend = 6.0 * rng.random::<f64>() - 3.0;
        // The profile starts anywhere between two samples.
        let starts_s = self.still_s + rng.random::<f64>() / self.rate_hz;
        let is_wet = body == BodyState::Wet;
        let (drag, added) = if is_wet { (self.drag_n_s2_m2, self.added_mass_kg) } else { (0.0, 0.0) };
        let unloaded_n = if is_wet { self.buoyancy_friction_n } else { 0.0 };
        let name = match body {
            BodyState::Wet => "wet",
            BodyState::Dry => "dry",
            BodyState::None => "none",
        };
        let mut run = Logged {
            id: format!("{name} {pair} {:+.2} m/s", speed * direction),
            time_s: Vec::with_capacity(n),
            position_m: Vec::with_capacity(n),
            reference_speed_m_s: Vec::with_capacity(n),
            command_v: Vec::with_capacity(n),
            force_n: Vec::with_capacity(n),
            kind,
            body,
            target_speed_m_s: speed,
            direction,
            pair,
            is_ballasted: self.buoyancy_friction_n == 0.0,
            hung_weight_n: (kind == RunKind::Calibration).then_some(weight_n),
        };
        for i in 0..n {
            let time_s = i as f64 / self.rate_hz;
            let (s, v, a) = profile.at(time_s - starts_s);
            let (position_m, v, a) = (from_m + direction * s, direction * v, direction * a);
            wander = kept * wander + fresh * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, rng);
            let viscous = self.viscous_n_s_m * if self.viscous_changes { friction_factor } else { 1.0 };
            let friction_n = if v == 0.0 {
                0.0
            } else {
                let along = self.coulomb_at_n(position_m) * friction_factor - unloaded_n + wander;
                (v.signum() * along + viscous * v) * (1.0 + self.one_way * v.signum())
            };
            let water_n = drag * v * v.abs() + added * a;
            let hung_n = if v == 0.0 { weight_n } else { weight_n + v.signum() * self.pulley_loss * weight_n };
            let chain_n = friction_n + water_n + hung_n + self.moving_mass_kg * a;
            // The gear loses either way: a load that drives gives the motor less than its force.
            let through = if chain_n * v >= 0.0 { 1.0 / self.efficiency } else { self.efficiency };
            let late = i as f64 / (n - 1) as f64;
            let bent = if bend.abs() < 1e-6 { late } else { (1.0 - (-bend * late).exp()) / (1.0 - (-bend).exp()) };
            let z: f64 = StandardNormal.sample(rng);
            let sensed_n = self.sensor_gain * water_n + drift_n * bent + self.sensor_noise_n * z;
            run.time_s.push(time_s);
            run.position_m.push(position_m);
            run.reference_speed_m_s.push(v);
            let motor_n = if v == 0.0 { 0.0 } else { v.signum() * self.motor_coulomb_n };
            run.command_v.push((chain_n * through + motor_n) / (self.ideal_force_per_volt_n * torque_factor));
            run.force_n.push((sensed_n / self.sensor_step_n).round() * self.sensor_step_n);
        }
        run
    }
}

/// A trapezoid of speed over a length, from rest to rest.
struct Trapezoid {
    speed: f64,
    acceleration: f64,
    ramp_s: f64,
    length: f64,
    duration_s: f64,
}

impl Trapezoid {
    fn new(length: f64, speed: f64, acceleration: f64) -> Self {
        let speed = speed.min((length * acceleration).sqrt());
        let ramp_s = speed / acceleration;
        Self { speed, acceleration, ramp_s, length, duration_s: length / speed + ramp_s }
    }

    /// Way, speed and acceleration at a time.
    fn at(&self, t: f64) -> (f64, f64, f64) {
        let left = self.duration_s - t;
        if t <= 0.0 {
            (0.0, 0.0, 0.0)
        } else if left <= 0.0 {
            (self.length, 0.0, 0.0)
        } else if t < self.ramp_s {
            (0.5 * self.acceleration * t * t, self.acceleration * t, self.acceleration)
        } else if left < self.ramp_s {
            (self.length - 0.5 * self.acceleration * left * left, self.acceleration * left, -self.acceleration)
        } else {
            (self.speed * (t - 0.5 * self.ramp_s), self.speed, 0.0)
        }
    }
}

/// A run that owns its columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Logged {
    /// See [`DragRun::id`].
    pub id: String,
    /// See [`DragRun::time_s`].
    pub time_s: Vec<f64>,
    /// See [`DragRun::position_m`].
    pub position_m: Vec<f64>,
    /// See [`DragRun::reference_speed_m_s`].
    pub reference_speed_m_s: Vec<f64>,
    /// See [`DragRun::command_v`].
    pub command_v: Vec<f64>,
    /// See [`DragRun::force_n`].
    pub force_n: Vec<f64>,
    /// See [`DragRun::kind`].
    pub kind: RunKind,
    /// See [`DragRun::body`].
    pub body: BodyState,
    /// See [`DragRun::target_speed_m_s`].
    pub target_speed_m_s: f64,
    /// See [`DragRun::direction`].
    pub direction: f64,
    /// See [`DragRun::pair`].
    pub pair: u32,
    /// See [`DragRun::is_ballasted`].
    pub is_ballasted: bool,
    /// See [`DragRun::hung_weight_n`].
    pub hung_weight_n: Option<f64>,
}

impl Logged {
    /// The run as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> DragRun<'_> {
        DragRun {
            id: &self.id,
            time_s: &self.time_s,
            position_m: &self.position_m,
            reference_speed_m_s: &self.reference_speed_m_s,
            command_v: &self.command_v,
            force_n: Some(&self.force_n),
            kind: self.kind,
            body: self.body,
            target_speed_m_s: self.target_speed_m_s,
            direction: self.direction,
            pair: self.pair,
            is_ballasted: self.is_ballasted,
            hung_weight_n: self.hung_weight_n,
            held: None,
        }
    }
}
