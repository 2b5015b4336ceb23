//! From a schedule to runs in order.

use froude_records::run::{Axis, BodyState, Direction, RunKind};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

/// What a campaign is to do, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Steady speeds of the dry and wet runs, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Wet/dry pairs at every speed.
    pub pairs: u32,
    /// Where profiles begin, m.
    pub start_m: f64,
    /// Longest way of a profile, m.
    pub travel_m: f64,
    /// Longest steady part, s: slow runs need not go the whole way.
    pub longest_steady_s: f64,
    /// Acceleration of the profiles, m/s².
    pub acceleration_m_s2: f64,
    /// Jerk, m/s³; 0 is a trapezoid.
    pub jerk_m_s3: f64,
    /// Shape the reference for the load's mode.
    pub is_shaped: bool,
    /// Speed of returns and of the way to the start, m/s.
    pub return_speed_m_s: f64,
    /// Rest before and after each profile that is recorded (sensor zero), s.
    pub still_s: f64,
    /// Wait for the water to come to rest before each wet run, s.
    pub settle_wet_s: f64,
    /// The same before other runs (structure), s.
    pub settle_dry_s: f64,
    /// Warm-up strokes over the profile's way.
    pub warm_up_strokes: u32,
    /// Speeds of the friction sweep, m/s; each forward and backward over the travel. Empty for none.
    pub friction_speeds_m_s: Vec<f64>,
    /// Known weights over the pulley, N; each forward and backward. Empty for none.
    pub calibration_weights_n: Vec<f64>,
    /// Speed of calibration strokes, m/s.
    pub calibration_speed_m_s: f64,
    /// Strokes per weight.
    pub calibration_strokes: u32,
    /// Whether dry runs carry ballast for the wet wheel load.
    pub is_ballasted: bool,
    /// Identification pulses (MCD: 60 %, 1 s): amplitude V and length s; `None` for none.
    pub pulses: Option<(f64, f64)>,
    /// Seed of the order of speeds.
    pub order_seed: u64,
}

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
    /// Pulses from `from_m` on.
    Pulses {
        /// Start, m.
        from_m: f64,
        /// Amplitude, V.
        volts: f64,
        /// Length, s.
        duration_s: f64,
    },
    /// A short open-loop jog from where it stands.
    Jog {
        /// Command, V.
        volts: f64,
        /// It ends after this way, m.
        distance_m: f64,
    },
}

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Name, unique; also the stem of its files. It sorts in order of the plan.
    pub id: String,
    /// What it is for.
    pub kind: RunKind,
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
    /// Whether the dry carriage is ballasted.
    pub is_ballasted: bool,
    /// Weight over the pulley, N.
    pub hung_weight_n: f64,
    /// Wait before it, s.
    pub settle_s: f64,
}

impl PlannedRun {
    /// Which way a profile goes.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        match self.drive {
            Drive::Profile { from_m, to_m, .. } => {
                Some(if to_m > from_m { Direction::Forward } else { Direction::Backward })
            }
            Drive::Pulses { .. } => None,
            Drive::Jog { volts, .. } => Some(if volts > 0.0 { Direction::Forward } else { Direction::Backward }),
        }
    }

    /// Steady speed of a profile, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> Option<f64> {
        match self.drive {
            Drive::Profile { speed_m_s, .. } => Some(speed_m_s),
            _ => None,
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

struct Planner<'a> {
    schedule: &'a Schedule,
    steps: Vec<Step>,
    body: BodyState,
    hung_weight_n: f64,
    number: u32,
}

/// The whole campaign in order: jog, warm-up, friction, calibration, pulses, then dry and wet blocks in ABBA order.
#[must_use]
pub fn plan(schedule: &Schedule) -> Vec<Step> {
    let mut planner =
        Planner { schedule, steps: Vec::new(), body: BodyState::None, hung_weight_n: 0.0, number: 0 };
    for volts in [1.0, -1.0] {
        let name = if volts > 0.0 { "jog-forward" } else { "jog-backward" };
        planner.run(name, RunKind::Jog, Drive::Jog { volts, distance_m: JOG_M }, None);
    }
    planner.warm_up();
    planner.friction();
    planner.calibration();
    if let Some((volts, duration_s)) = schedule.pulses {
        let from_m = schedule.start_m + 0.5 * schedule.travel_m;
        planner.run("pulses", RunKind::Excitation, Drive::Pulses { from_m, volts, duration_s }, None);
    }
    planner.blocks();
    planner.steps
}

impl Planner<'_> {
    /// Way of a profile at this speed, m.
    fn way_m(&self, speed_m_s: f64) -> f64 {
        let ramps_m = speed_m_s * speed_m_s / self.schedule.acceleration_m_s2;
        self.schedule.travel_m.min(ramps_m + speed_m_s * self.schedule.longest_steady_s)
    }

    fn run(&mut self, name: &str, kind: RunKind, drive: Drive, pair: Option<(u32, u32)>) {
        self.number += 1;
        let settle_s =
            if self.body == BodyState::Wet { self.schedule.settle_wet_s } else { self.schedule.settle_dry_s };
        self.steps.push(Step::Run(PlannedRun {
            id: format!("{:03}-{name}", self.number),
            kind,
            axis: Axis::Y,
            set: pair.map(|p| p.0),
            pair: pair.map(|p| p.1),
            drive,
            body: self.body,
            is_ballasted: self.body == BodyState::Dry && self.schedule.is_ballasted,
            hung_weight_n: self.hung_weight_n,
            settle_s,
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
                BodyState::Dry if self.schedule.is_ballasted => {
                    "mount the body dry, on top of the platform, with the ballast that makes up for its buoyancy".to_owned()
                }
                BodyState::Dry => "mount the body dry, on top of the platform".to_owned(),
                BodyState::Wet => "mount the body wet, below the platform".to_owned(),
            });
        }
        if self.hung_weight_n != hung_weight_n {
            prompts.push(if hung_weight_n == 0.0 {
                "take the weight off the pulley".to_owned()
            } else {
                format!("hang {hung_weight_n:.3} N over the pulley, pulling against +y")
            });
        }
        (self.body, self.hung_weight_n) = (body, hung_weight_n);
        self.steps.push(Step::Operator(OperatorStep { prompt: prompts.join("; "), body, hung_weight_n }));
    }

    /// Strokes there and back; every stroke is a run of its own.
    fn strokes(&mut self, name: &str, kind: RunKind, speed_m_s: f64, way_m: f64) {
        let (from_m, to_m) = (self.schedule.start_m, self.schedule.start_m + way_m);
        self.run(&format!("{name}-forward"), kind, Drive::Profile { from_m, to_m, speed_m_s }, None);
        self.run(&format!("{name}-backward"), kind, Drive::Profile { from_m: to_m, to_m: from_m, speed_m_s }, None);
    }

    fn warm_up(&mut self) {
        let speed_m_s = self.schedule.return_speed_m_s;
        for _ in 0..self.schedule.warm_up_strokes {
            self.strokes("warm-up", RunKind::WarmUp, speed_m_s, self.schedule.travel_m);
        }
    }

    fn friction(&mut self) {
        for &speed_m_s in &self.schedule.friction_speeds_m_s {
            let name = format!("friction-{:.0}mm_s", 1e3 * speed_m_s);
            self.strokes(&name, RunKind::Friction, speed_m_s, self.schedule.travel_m);
        }
    }

    /// No weight, then each weight, then no weight again: the drift of friction shows between the two.
    fn calibration(&mut self) {
        if self.schedule.calibration_weights_n.is_empty() {
            return;
        }
        let weights = self.schedule.calibration_weights_n.clone();
        let all = std::iter::once(0.0).chain(weights).chain(std::iter::once(0.0));
        for weight_n in all {
            self.mount(self.body, weight_n);
            for _ in 0..self.schedule.calibration_strokes {
                let name = format!("calibration-{weight_n:.0}N");
                let speed_m_s = self.schedule.calibration_speed_m_s;
                self.strokes(&name, RunKind::Calibration, speed_m_s, self.way_m(speed_m_s));
            }
        }
    }

    /// Blocks of one pair: dry then wet, then wet then dry, …: ABBA over two pairs.
    fn blocks(&mut self) {
        let mut rng = Pcg64Mcg::seed_from_u64(self.schedule.order_seed);
        for pair in 1..=self.schedule.pairs {
            let mut halves = [BodyState::Dry, BodyState::Wet];
            if pair % 2 == 0 {
                halves.reverse();
            }
            for (half, body) in (0..).zip(halves) {
                self.mount(body, 0.0);
                let kind = if body == BodyState::Wet { RunKind::Wet } else { RunKind::Dry };
                let mut speeds = self.schedule.speeds_m_s.clone();
                speeds.shuffle(&mut rng);
                for speed_m_s in speeds {
                    let (from_m, to_m) = (self.schedule.start_m, self.schedule.start_m + self.way_m(speed_m_s));
                    let name = format!("{}-p{pair}-{:.0}mm_s", kind.name(), 1e3 * speed_m_s);
                    let drive = Drive::Profile { from_m, to_m, speed_m_s };
                    self.run(&name, kind, drive, Some((2 * (pair - 1) + half + 1, pair)));
                }
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn schedule() -> Schedule {
        Schedule {
            speeds_m_s: vec![0.05, 0.25, 0.55],
            pairs: 4,
            start_m: 0.5,
            travel_m: 2.2,
            longest_steady_s: 10.0,
            acceleration_m_s2: 0.7,
            jerk_m_s3: 0.0,
            is_shaped: true,
            return_speed_m_s: 0.3,
            still_s: 1.0,
            settle_wet_s: 20.0,
            settle_dry_s: 2.0,
            warm_up_strokes: 1,
            friction_speeds_m_s: vec![0.1],
            calibration_weights_n: vec![10.0],
            calibration_speed_m_s: 0.1,
            calibration_strokes: 1,
            is_ballasted: true,
            pulses: Some((2.0, 10.0)),
            order_seed: 1,
        }
    }

    fn runs(steps: &[Step]) -> Vec<&PlannedRun> {
        steps.iter().filter_map(|s| if let Step::Run(r) = s { Some(r) } else { None }).collect()
    }

    #[test]
    fn blocks_stand_in_abba_order_and_the_operator_is_asked_once_between_them() {
        let steps = plan(&schedule());
        let mut blocks: Vec<RunKind> = Vec::new();
        let mut asked = 0;
        for step in &steps {
            match step {
                Step::Run(r) if matches!(r.kind, RunKind::Dry | RunKind::Wet) && r.speed_m_s() == Some(0.25) => {
                    blocks.push(r.kind);
                }
                Step::Operator(o) if o.body != BodyState::None => asked += 1,
                _ => {}
            }
        }
        let (a, b) = (RunKind::Dry, RunKind::Wet);
        assert_eq!(blocks, [a, b, b, a, a, b, b, a]);
        // dry, wet, dry, wet, dry: a change only where the body moves.
        assert_eq!(asked, 5);
    }

    #[test]
    fn every_pair_has_each_speed_once_dry_and_once_wet_over_the_same_way() {
        let steps = plan(&schedule());
        for pair in 1..=4 {
            for speed in [0.05, 0.25, 0.55] {
                let of = |kind| -> Vec<Drive> {
                    runs(&steps)
                        .iter()
                        .filter(|r| r.pair == Some(pair) && r.kind == kind && r.speed_m_s() == Some(speed))
                        .map(|r| r.drive)
                        .collect()
                };
                assert_eq!(of(RunKind::Dry).len(), 1);
                assert_eq!(of(RunKind::Dry), of(RunKind::Wet));
            }
        }
    }

    #[test]
    fn a_slow_run_is_cut_at_the_longest_steady_part_and_none_leaves_the_travel() {
        let s = schedule();
        for run in runs(&plan(&s)) {
            if let Drive::Profile { from_m, to_m, speed_m_s } = run.drive {
                assert!((to_m - from_m).abs() <= s.travel_m + 1e-12);
                if run.kind == RunKind::Dry && speed_m_s == 0.05 {
                    assert!(((to_m - from_m) - (0.05 * 10.0 + 0.05 * 0.05 / 0.7)).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn names_are_unique_and_sort_in_the_order_of_the_plan() {
        let steps = plan(&schedule());
        let names: Vec<&str> = runs(&steps).iter().map(|r| r.id.as_str()).collect();
        assert!(names.windows(2).all(|w| w[0] < w[1]));
    }
}
