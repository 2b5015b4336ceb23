//! From what is asked for to runs in order.

use froude_control::request::Excitation;
use froude_records::estimate::Measured;
use froude_records::run::{Axis, BodyState, Direction, Role};
use indexmap::IndexMap;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use super::{CarriagePlan, Directions, Order, RigKind};

/// What the operator does before the next runs.
#[derive(Debug, Clone, PartialEq)]
pub struct OperatorStep {
    /// What the operator is asked.
    pub prompt: String,
    /// What hangs on the strut then.
    pub body: BodyState,
    /// Weight over the pulley, N; positive pulls against +y.
    pub hung_weight_n: f64,
}

/// How an axis is driven in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// A profile from `from_m` to `to_m`.
    Profile {
        /// Start, m.
        from_m: f64,
        /// End, m.
        to_m: f64,
        /// Steady speed, m/s.
        speed_m_s: f64,
    },
    /// What the controller is asked for at `from_m`; a jog is far enough from the soft limits that they do not end it.
    Excitation {
        /// Start, m.
        from_m: f64,
        /// The signal.
        excitation: Excitation,
    },
}

impl Drive {
    /// Where the run starts, m.
    #[must_use]
    pub fn from_m(&self) -> f64 {
        match *self {
            Self::Profile { from_m, .. } | Self::Excitation { from_m, .. } => from_m,
        }
    }

    /// What a relay or a sweep is driven with, as constants of its run: whoever reads the log needs them, and they are in no channel.
    #[must_use]
    pub fn constants(&self) -> IndexMap<String, Measured> {
        let Self::Excitation { excitation, .. } = *self else { return IndexMap::new() };
        let named = |constants: &[(&str, f64, &str)]| {
            constants.iter().map(|&(name, value, unit)| (name.to_owned(), Measured::of(value, unit))).collect()
        };
        match excitation {
            Excitation::Relay { volts, hysteresis_m, .. } => {
                named(&[(RELAY_HEIGHT, volts, "V"), (RELAY_HYSTERESIS, hysteresis_m, "m")])
            }
            Excitation::Sweep { speed_m_s, volts, from_hz, to_hz, duration_s } => named(&[
                (SWEEP_SPEED, speed_m_s, "m/s"),
                (SWEEP_AMPLITUDE, volts, "V"),
                (SWEEP_FROM, from_hz, "Hz"),
                (SWEEP_TO, to_hz, "Hz"),
                (SWEEP_DURATION, duration_s, "s"),
            ]),
            Excitation::Pulses { .. } | Excitation::Jog { .. } => IndexMap::new(),
        }
    }
}

/// Constant of a run: height of its relay, V.
pub const RELAY_HEIGHT: &str = "relay_height";
/// Half width of the relay's hysteresis, m.
pub const RELAY_HYSTERESIS: &str = "relay_hysteresis";
/// Speed below a sweep, m/s.
pub const SWEEP_SPEED: &str = "sweep_speed";
/// Amplitude of a sweep, V.
pub const SWEEP_AMPLITUDE: &str = "sweep_amplitude";
/// Its first frequency, Hz.
pub const SWEEP_FROM: &str = "sweep_from";
/// Its last, Hz.
pub const SWEEP_TO: &str = "sweep_to";
/// Its length, s.
pub const SWEEP_DURATION: &str = "sweep_duration";

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Name, unique; also the stem of its files. It sorts in order of the plan.
    pub id: String,
    /// What it is for.
    pub role: Role,
    /// Axis.
    pub axis: Axis,
    /// ABBA block, from 1.
    pub set: Option<u32>,
    /// Wet/dry pair, from 1.
    pub pair: Option<u32>,
    /// How it is driven.
    pub drive: Drive,
    /// Body.
    pub body: BodyState,
    /// Whether ballast makes the wheel load the same wet and dry.
    pub is_ballasted: bool,
    /// Weight over the pulley, N.
    pub hung_weight_n: f64,
    /// Where that weight rests on the floor, m; `None` where it is not stated.
    pub floor_m: Option<f64>,
    /// Wait before it, s.
    pub settle_s: f64,
}

impl PlannedRun {
    /// Which way a profile goes.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        let is_forward = match self.drive {
            Drive::Profile { from_m, to_m, .. } => to_m > from_m,
            Drive::Excitation { excitation: Excitation::Sweep { .. }, .. } => true,
            Drive::Excitation { excitation: Excitation::Jog { volts, .. }, .. } => volts > 0.0,
            Drive::Excitation { .. } => return None,
        };
        Some(if is_forward { Direction::Forward } else { Direction::Backward })
    }

    /// Steady speed of a profile, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> Option<f64> {
        match self.drive {
            Drive::Profile { speed_m_s, .. }
            | Drive::Excitation { excitation: Excitation::Sweep { speed_m_s, .. }, .. } => Some(speed_m_s),
            Drive::Excitation { .. } => None,
        }
    }
}

/// A step of the campaign.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// The operator does something.
    Operator(OperatorStep),
    /// The carriage does something.
    Run(PlannedRun),
}

/// Way of the jog test, m: a reversed polarity is caught within it.
const JOG_M: f64 = 0.01;
/// It ends after this time in any case, s.
const JOG_S: f64 = 1.0;
/// Its command, V: twice breakaway of the paper's rig.
const JOG_V: f64 = 1.0;

struct Planner<'a> {
    asked: &'a CarriagePlan,
    start_m: f64,
    steps: Vec<Step>,
    body: BodyState,
    hung_weight_n: f64,
    number: u32,
}

/// The whole campaign in order: jog, warm-up and pulses bare; friction and calibration with the body dry; then dry and wet halves of the pairs.
///
/// `start_m` is where forward runs begin. The order of the speeds within a half is drawn from `order_seed`.
#[must_use]
pub fn plan(asked: &CarriagePlan, start_m: f64, order_seed: u64) -> Vec<Step> {
    let mut planner = Planner::new(asked, start_m);
    for (name, volts) in [("jog-forward", JOG_V), ("jog-backward", -JOG_V)] {
        let jog = Excitation::Jog { volts, distance_m: JOG_M, duration_s: JOG_S };
        planner.excite(name, Role::Jog, start_m, jog);
    }
    planner.warm_up();
    if let Some(p) = &asked.excitation {
        let (volts, period_s, duty, duration_s) = (p.amplitude_v, p.period_s, p.duty, p.duration_s);
        let pulses = Excitation::Pulses { volts, period_s, duty, duration_s };
        planner.excite("pulses", Role::Excitation, start_m + 0.5 * asked.distance_m, pulses);
    }
    // Friction and force per volt are those of the wheel load that is towed: the body rides along, dry.
    if asked.friction.is_some() || asked.calibration.is_some() {
        planner.mount(BodyState::Dry, 0.0);
    }
    planner.friction();
    planner.calibration();
    planner.pairs(order_seed);
    planner.steps
}

/// Experiments on the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experiments {
    /// Relay's height, V.
    pub relay_v: f64,
    /// Its hysteresis, m.
    pub hysteresis_m: f64,
    /// Its length, s.
    pub relay_s: f64,
    /// Sweep's amplitude, V.
    pub sweep_v: f64,
    /// First and last frequency, Hz.
    pub sweep_hz: [f64; 2],
    /// Its length, s.
    pub sweep_s: f64,
    /// Speed below it, m/s.
    pub sweep_m_s: f64,
}

impl Default for Experiments {
    /// For a carriage like the paper's: the relay at two and a half times breakaway, the sweep beside 50 mm/s from 2 to 40 Hz.
    fn default() -> Self {
        Self {
            relay_v: 1.0,
            hysteresis_m: 2e-5,
            relay_s: 6.0,
            sweep_v: 3.0,
            sweep_hz: [2.0, 40.0],
            sweep_s: 40.0,
            sweep_m_s: 0.05,
        }
    }
}

/// Relay and sweep on the bare carriage.
#[must_use]
pub fn tuning(asked: &CarriagePlan, start_m: f64, experiments: &Experiments) -> Vec<Step> {
    let mut planner = Planner::new(asked, start_m);
    let &Experiments { relay_v: volts, hysteresis_m, relay_s: duration_s, .. } = experiments;
    let relay = Excitation::Relay { volts, hysteresis_m, duration_s };
    planner.excite("relay", Role::Relay, start_m + 0.5 * asked.distance_m, relay);
    planner.sweep("sweep", experiments);
    planner.steps
}

/// The same sweep bare, with the body dry, and wet: the load mode in each state.
#[must_use]
pub fn resonance(asked: &CarriagePlan, start_m: f64, experiments: &Experiments) -> Vec<Step> {
    let mut planner = Planner::new(asked, start_m);
    planner.sweep("sweep-bare", experiments);
    planner.mount(BodyState::Dry, 0.0);
    planner.sweep("sweep-dry", experiments);
    planner.mount(BodyState::Wet, 0.0);
    planner.sweep("sweep-wet", experiments);
    planner.steps
}

impl<'a> Planner<'a> {
    fn new(asked: &'a CarriagePlan, start_m: f64) -> Self {
        Self { asked, start_m, steps: Vec::new(), body: BodyState::None, hung_weight_n: 0.0, number: 0 }
    }

    fn excite(&mut self, name: &str, role: Role, from_m: f64, excitation: Excitation) {
        self.run(name, role, Drive::Excitation { from_m, excitation }, None);
    }

    fn sweep(&mut self, name: &str, experiments: &Experiments) {
        let &Experiments {
            sweep_v: volts, sweep_hz: [from_hz, to_hz], sweep_s: duration_s, sweep_m_s: speed_m_s, ..
        } = experiments;
        let sweep = Excitation::Sweep { speed_m_s, volts, from_hz, to_hz, duration_s };
        self.excite(name, Role::Sweep, self.start_m, sweep);
    }

    fn run(&mut self, name: &str, role: Role, drive: Drive, pair: Option<(u32, u32)>) {
        self.number += 1;
        let is_wet = self.body == BodyState::Wet;
        self.steps.push(Step::Run(PlannedRun {
            id: format!("{:03}-{name}", self.number),
            role,
            axis: self.asked.axis,
            set: pair.map(|p| p.0),
            pair: pair.map(|p| p.1),
            drive,
            body: self.body,
            is_ballasted: self.body != BodyState::None && self.asked.is_ballasted,
            hung_weight_n: self.hung_weight_n,
            floor_m: self.asked.calibration.as_ref().and_then(|c| c.floor_m),
            settle_s: if is_wet { self.asked.settling_wet_s } else { self.asked.settling_dry_s },
        }));
    }

    fn mount(&mut self, body: BodyState, hung_weight_n: f64) {
        if self.body == body && self.hung_weight_n == hung_weight_n {
            return;
        }
        let mut prompts = Vec::new();
        if self.body != body {
            prompts.push(match body {
                BodyState::None => "take the body off".to_owned(),
                BodyState::Dry if self.asked.is_ballasted => {
                    "mount the body dry, on top of the platform, without the ballast".to_owned()
                }
                BodyState::Dry => "mount the body dry, on top of the platform".to_owned(),
                BodyState::Wet if self.asked.is_ballasted => {
                    "mount the body wet, below the platform, and put on the ballast that weighs as much as the water that it displaces"
                        .to_owned()
                }
                BodyState::Wet => "mount the body wet, below the platform".to_owned(),
            });
        }
        if self.hung_weight_n != hung_weight_n {
            prompts.push(if hung_weight_n == 0.0 {
                "take the weight off the pulley".to_owned()
            } else {
                let floor_m = self.asked.calibration.as_ref().and_then(|c| c.floor_m);
                let floor = floor_m.map_or_else(String::new, |y| {
                    format!(", with as much cord as lets it rest on the floor when the carriage is at {y:.3} m")
                });
                format!("hang {hung_weight_n:.3} N over the pulley, pulling against +y{floor}")
            });
        }
        (self.body, self.hung_weight_n) = (body, hung_weight_n);
        self.steps.push(Step::Operator(OperatorStep { prompt: prompts.join("; "), body, hung_weight_n }));
    }

    /// There, or there and back, where the tows go; each way is a run of its own.
    fn strokes(&mut self, name: &str, role: Role, speed_m_s: f64, is_both: bool, pair: Option<(u32, u32)>) {
        self.strokes_over(self.start_m, self.asked.distance_m, name, role, speed_m_s, is_both, pair);
    }

    fn strokes_over(
        &mut self,
        from_m: f64,
        way_m: f64,
        name: &str,
        role: Role,
        speed_m_s: f64,
        is_both: bool,
        pair: Option<(u32, u32)>,
    ) {
        let to_m = from_m + way_m;
        self.run(&format!("{name}-forward"), role, Drive::Profile { from_m, to_m, speed_m_s }, pair);
        if is_both {
            let back = Drive::Profile { from_m: to_m, to_m: from_m, speed_m_s };
            self.run(&format!("{name}-backward"), role, back, pair);
        }
    }

    fn warm_up(&mut self) {
        let Some(warm_up) = self.asked.warm_up else { return };
        let stroke_s = self.asked.distance_m / warm_up.speed_m_s;
        for _ in 0..(0.5 * warm_up.duration_s / stroke_s).ceil().clamp(1.0, 1e3) as usize {
            self.strokes("warm-up", Role::WarmUp, warm_up.speed_m_s, true, None);
        }
    }

    fn friction(&mut self) {
        let Some(sweep) = &self.asked.friction else { return };
        // A repeat of all speeds is what the friction's scatter is taken over.
        for repeat in 1..=sweep.repeats as u32 {
            for &speed_m_s in &sweep.speed_m_s {
                let name = format!("friction-{:.0}mm_s", 1e3 * speed_m_s);
                self.strokes(&name, Role::Friction, speed_m_s, true, Some((repeat, repeat)));
            }
        }
    }

    /// No weight, then each weight, then no weight again: the drift of friction shows between the two.
    fn calibration(&mut self) {
        let Some(calibration) = &self.asked.calibration else { return };
        let from_m = calibration.start_m.unwrap_or(self.start_m);
        let way_m = calibration.distance_m.unwrap_or(self.asked.distance_m);
        let weights = calibration.weights_n.iter().copied();
        for weight_n in std::iter::once(0.0).chain(weights).chain(std::iter::once(0.0)) {
            self.mount(self.body, weight_n);
            for _ in 0..calibration.repeats {
                let name = format!("calibration-{weight_n}N");
                self.strokes_over(from_m, way_m, &name, Role::Calibration, calibration.speed_m_s, true, None);
            }
        }
    }

    /// The halves of the pairs in the order asked for.
    fn pairs(&mut self, order_seed: u64) {
        let mut rng = Pcg64Mcg::seed_from_u64(order_seed);
        let n = self.asked.repeats as u32;
        let (dry, wet) = (BodyState::Dry, BodyState::Wet);
        let halves: Vec<(u32, BodyState)> = match self.asked.order {
            Order::Abba => {
                (1..=n).flat_map(|p| if p % 2 == 1 { [(p, dry), (p, wet)] } else { [(p, wet), (p, dry)] }).collect()
            }
            Order::Ab => (1..=n).flat_map(|p| [(p, dry), (p, wet)]).collect(),
            Order::Blocks => (1..=n).map(|p| (p, dry)).chain((1..=n).map(|p| (p, wet))).collect(),
        };
        for (set, (pair, body)) in (1..).zip(halves) {
            self.mount(body, 0.0);
            let role = if body == wet { Role::Wet } else { Role::Dry };
            let mut speeds = self.asked.speed_m_s.clone();
            speeds.shuffle(&mut rng);
            for speed_m_s in speeds {
                let name = format!("{}-p{pair}-{:.0}mm_s", role.name(), 1e3 * speed_m_s);
                let is_both = self.asked.directions == Directions::Both;
                self.strokes(&name, role, speed_m_s, is_both, Some((set, pair)));
            }
        }
    }
}

/// What the order of the speeds within a half of a pair is drawn from.
#[must_use]
pub fn order_seed(rig: &RigKind) -> u64 {
    match rig {
        RigKind::Twin { seed, .. } => *seed,
        RigKind::Serial { .. } => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::carriage::{Calibration, FrictionSweep};
    use froude_records::Place;

    fn asked() -> CarriagePlan {
        CarriagePlan {
            axis: Axis::Y,
            speed_m_s: vec![0.05, 0.25, 0.55],
            repeats: 4,
            order: Order::Abba,
            directions: Directions::Forward,
            distance_m: 2.2,
            start_m: None,
            acceleration_m_s2: 0.6,
            jerk_m_s3: None,
            settling_dry_s: 2.0,
            settling_wet_s: 20.0,
            still_s: 1.0,
            warm_up: None,
            friction: Some(FrictionSweep { speed_m_s: vec![0.1], repeats: 1 }),
            calibration: Some(Calibration {
                weights_n: vec![10.0],
                weight_standard_n: 0.01,
                pulley_loss: None,
                speed_m_s: 0.1,
                repeats: 1,
                start_m: None,
                distance_m: None,
                floor_m: None,
            }),
            excitation: None,
            is_ballasted: true,
            stop_at_relative_half_width: None,
            expected_scatter_n: None,
            expected_drag_n_s2_m2: Some(20.0),
            strut_drag_n_s2_m2: None,
            place: Place::whole("campaign.toml".as_ref()),
        }
    }

    fn runs(steps: &[Step]) -> Vec<&PlannedRun> {
        steps.iter().filter_map(|s| if let Step::Run(r) = s { Some(r) } else { None }).collect()
    }

    #[test]
    fn blocks_stand_in_abba_order_and_the_operator_is_asked_once_between_them() {
        let steps = plan(&asked(), 0.5, 1);
        let mut blocks: Vec<Role> = Vec::new();
        let mut asked = 0;
        for step in &steps {
            match step {
                Step::Run(r) if matches!(r.role, Role::Dry | Role::Wet) && r.speed_m_s() == Some(0.25) => {
                    blocks.push(r.role);
                }
                Step::Operator(o) if o.body != BodyState::None => asked += 1,
                _ => {}
            }
        }
        let (a, b) = (Role::Dry, Role::Wet);
        assert_eq!(blocks, [a, b, b, a, a, b, b, a]);
        // Dry for friction; on with the weight and off again; then dry, wet, dry, wet, dry without a change at the beginning.
        assert_eq!(asked, 7);
    }

    #[test]
    fn every_pair_has_each_speed_once_dry_and_once_wet_over_the_same_way() {
        let steps = plan(&asked(), 0.5, 1);
        for pair in 1..=4 {
            for speed in [0.05, 0.25, 0.55] {
                let of = |role| -> Vec<Drive> {
                    runs(&steps)
                        .iter()
                        .filter(|r| r.pair == Some(pair) && r.role == role && r.speed_m_s() == Some(speed))
                        .map(|r| r.drive)
                        .collect()
                };
                assert_eq!(of(Role::Dry).len(), 1);
                assert_eq!(of(Role::Dry), of(Role::Wet));
            }
        }
    }

    #[test]
    fn the_weight_hangs_for_the_calibration_only() {
        let steps = plan(&asked(), 0.5, 1);
        let weights: Vec<f64> =
            runs(&steps).iter().filter(|r| r.role == Role::Calibration).map(|r| r.hung_weight_n).collect();
        assert_eq!(weights, [0.0, 0.0, 10.0, 10.0, 0.0, 0.0]);
        assert!(runs(&steps).iter().filter(|r| r.role != Role::Calibration).all(|r| r.hung_weight_n == 0.0));
    }

    #[test]
    fn every_order_has_the_same_runs() {
        let names = |order| {
            let plan = CarriagePlan { order, directions: Directions::Both, ..asked() };
            let steps = super::plan(&plan, 0.5, 1);
            let mut names: Vec<String> = runs(&steps).iter().map(|r| r.id[4..].to_owned()).collect();
            names.sort();
            names
        };
        assert_eq!(names(Order::Abba), names(Order::Ab));
        assert_eq!(names(Order::Abba), names(Order::Blocks));
    }

    #[test]
    fn names_are_unique_and_sort_in_the_order_of_the_plan() {
        let steps = plan(&asked(), 0.5, 1);
        let names: Vec<&str> = runs(&steps).iter().map(|r| r.id.as_str()).collect();
        assert!(names.windows(2).all(|w| w[0] < w[1]));
    }
}
