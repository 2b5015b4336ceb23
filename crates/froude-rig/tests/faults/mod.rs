//! The fault catalogue: what is broken, what the controller may call it, and by when it must have said so.
//!
//! **Setting.** A homed carriage on a random move of both axes, the body off, dry or wet; one thing breaks on a moving axis.
//! **Time.** From the tick that the injection is scheduled for to the tick whose status names the fault.
//!
//! | injection | accepted | latest |
//! | --- | --- | --- |
//! | emergency stop, end switch, amplifier off, NaN current | its own fault | 2 ticks |
//! | tick late (over 1 ms) | tick late | 2 ticks |
//! | encoder jump (over 20 counts) | jump, or stuck when the jump cancels the motion | 2 ticks |
//! | encoder silent, stuck, reversed | stuck, jump, polarity, following error, saturated, over-current, over-speed | 1.5 s (at creep; at 0.06 m/s and more, 2 ticks) |
//! | illegal transitions (over 100 a second) | illegal, jump, stuck (lost counts cancel the motion) | 0.5 s |
//! | current runaway | over-current, saturated, over-speed, following error, jump (a light motor outruns its load) | 15 ms |
//! | host silent | host silent | 0.21 s |
//! | jam beyond the peak force | following error, saturated, stuck (the counts cannot tell), over-current | 1.5 s |
//! | no torque at all | following error, stuck, saturated, soft limit | 3 s |
//! | a dead encoder, a jam or no torque within the last counts of a move | the above, or none: the axis stands on its target | as above |
//! | chain break | none needed: the motor's encoder cannot see it | – |
//!
//! A detection that comes from somewhere else first (a following error because of the same cause) is what the set is for. In every
//! run the loads stay off their hard stops and no command that is not finite reaches an amplifier. The chain break is the
//! exception that the table states: a load without a chain coasts as far as its own friction lets it.

#![allow(dead_code)] // Each program uses a part.

use froude_control::config::ConfigError;
use froude_control::fault::Fault;
use froude_control::request::{Move, Request};
use froude_control::status::Phase;
use froude_rig::amplifier::AmplifierFault;
use froude_rig::closed_loop::ClosedLoop;
use froude_rig::defaults::control_config;
use froude_rig::encoder::EncoderFault;
use froude_rig::injection::{Injection, Scheduled};
use froude_rig::load::{BodyState, Load};
use froude_rig::twin::{TICK_S, TwinConfig};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;

/// What an injected fault must come to.
pub trait Faults: Sized {
    /// Faults that the controller may latch for it; empty when none can be asked for.
    fn accepted(&self) -> &'static [Fault];

    /// Its name in tables.
    fn name(&self) -> &'static str;

    /// Latest detection after it acts, s.
    fn latest_s(&self) -> f64;

    /// Broken within the last counts of a move, these show nothing until the axis is asked to move again.
    fn is_unseen_at_rest(&self) -> bool;

    /// A random one, strong enough to matter.
    fn random(rng: &mut impl Rng) -> Self;
}

impl Faults for Injection {
    fn accepted(&self) -> &'static [Fault] {
        match self {
            Self::EmergencyStop => &[Fault::EmergencyStop],
            Self::LowEndSwitch | Self::HighEndSwitch => &[Fault::EndSwitch],
            Self::Amplifier(AmplifierFault::Off) => &[Fault::AmplifierNotReady],
            Self::NotFiniteCurrent => &[Fault::NotFinite],
            Self::TickLate(_) => &[Fault::TickLate],
            Self::HostSilent => &[Fault::HostSilent],
            Self::EncoderJump(_) => &[Fault::EncoderJump, Fault::EncoderStuck],
            Self::Encoder(EncoderFault::BitFlips { .. }) => {
                &[Fault::EncoderIllegal, Fault::EncoderJump, Fault::EncoderStuck]
            }
            Self::Encoder(_) => &[
                Fault::EncoderStuck,
                Fault::EncoderJump,
                Fault::Polarity,
                Fault::FollowingError,
                Fault::Saturated,
                Fault::OverCurrent,
                Fault::OverSpeed,
            ],
            Self::Amplifier(AmplifierFault::Runaway) => {
                &[Fault::OverCurrent, Fault::Saturated, Fault::OverSpeed, Fault::FollowingError, Fault::EncoderJump]
            }
            Self::FrictionJam(_) => &[Fault::FollowingError, Fault::Saturated, Fault::EncoderStuck, Fault::OverCurrent],
            Self::TorqueLoss(_) => {
                &[Fault::FollowingError, Fault::EncoderStuck, Fault::Saturated, Fault::SoftLimit, Fault::Polarity]
            }
            Self::ChainBreak => &[],
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Encoder(EncoderFault::Silent) => "encoder silent",
            Self::Encoder(EncoderFault::Stuck) => "encoder stuck",
            Self::EncoderJump(_) => "encoder jump",
            Self::Encoder(EncoderFault::BitFlips { .. }) => "illegal transitions",
            Self::Encoder(EncoderFault::Reversed) => "encoder reversed",
            Self::Amplifier(AmplifierFault::Off) => "amplifier off",
            Self::Amplifier(AmplifierFault::Runaway) => "current runaway",
            Self::EmergencyStop => "emergency stop",
            Self::LowEndSwitch => "low end switch",
            Self::HighEndSwitch => "high end switch",
            Self::TickLate(_) => "tick late",
            Self::HostSilent => "host silent",
            Self::NotFiniteCurrent => "NaN current",
            Self::FrictionJam(_) => "jam",
            Self::TorqueLoss(_) => "no torque",
            Self::ChainBreak => "chain break",
        }
    }

    fn latest_s(&self) -> f64 {
        match self {
            Self::EmergencyStop
            | Self::LowEndSwitch
            | Self::HighEndSwitch
            | Self::Amplifier(AmplifierFault::Off)
            | Self::NotFiniteCurrent
            | Self::TickLate(_)
            | Self::EncoderJump(_) => 2.0 * TICK_S,
            Self::Amplifier(AmplifierFault::Runaway) => 0.015,
            Self::HostSilent => 0.21,
            Self::Encoder(EncoderFault::BitFlips { .. }) => 0.5,
            Self::Encoder(_) | Self::FrictionJam(_) => 1.5,
            Self::TorqueLoss(_) => 3.0,
            Self::ChainBreak => f64::INFINITY,
        }
    }

    fn is_unseen_at_rest(&self) -> bool {
        matches!(
            self,
            Self::TorqueLoss(_)
                | Self::FrictionJam(_)
                | Self::Encoder(EncoderFault::Silent | EncoderFault::Stuck | EncoderFault::Reversed)
        )
    }

    fn random(rng: &mut impl Rng) -> Self {
        match rng.random_range(0..16) {
            0 => Self::Encoder(EncoderFault::Silent),
            1 => Self::Encoder(EncoderFault::Stuck),
            2 => {
                let counts = rng.random_range(20..100_000);
                Self::EncoderJump(if rng.random() { counts } else { -counts })
            }
            3 => Self::Encoder(EncoderFault::BitFlips { per_second: rng.random_range(100..2_000) }),
            4 => Self::Encoder(EncoderFault::Reversed),
            5 => Self::Amplifier(AmplifierFault::Off),
            6 => Self::Amplifier(AmplifierFault::Runaway),
            7 => Self::EmergencyStop,
            8 => Self::LowEndSwitch,
            9 => Self::HighEndSwitch,
            10 => Self::TickLate(rng.random_range(1_000..20_000)),
            11 => Self::HostSilent,
            12 => Self::NotFiniteCurrent,
            13 => Self::FrictionJam(rng.random_range(150.0..400.0)),
            14 => Self::TorqueLoss(0.0),
            _ => Self::ChainBreak,
        }
    }
}

/// How a run with an injection ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// What was broken.
    pub injection: Injection,
    /// On which axis.
    pub axis: usize,
    /// How the body was mounted.
    pub mounting: BodyState,
    /// What the controller latched, and how long after, s.
    pub detected: Option<(Fault, f64)>,
    /// A load touched a hard stop.
    pub has_left_travel: bool,
    /// A command was not finite.
    pub has_bad_command: bool,
    /// Both axes were at rest without torque at the end.
    pub is_at_rest: bool,
    /// The broken axis ended its move as if nothing had happened: it stands on its target.
    pub has_arrived: bool,
}

impl Outcome {
    /// Whether the catalogue allows it.
    #[must_use]
    pub fn is_allowed(&self) -> bool {
        let accepted = self.injection.accepted();
        let is_unseen = self.has_arrived && self.injection.is_unseen_at_rest();
        let is_told = match self.detected {
            Some((fault, after_s)) => accepted.contains(&fault) && after_s <= self.injection.latest_s() + 0.5 * TICK_S,
            None => accepted.is_empty() || is_unseen,
        };
        let is_held = !self.has_left_travel && (self.is_at_rest || accepted.is_empty() || is_unseen);
        let is_chain = matches!(self.injection, Injection::ChainBreak);
        !self.has_bad_command && (is_chain || (is_told && is_held))
    }
}

/// An axis that stands this close to its target has arrived, m.
const ARRIVED_M: f64 = 1e-4;
/// Longest wait for a detection, and for rest after it, ticks.
const WAIT_TICKS: u64 = 16_000;
const REST_TICKS: u64 = 48_000;

/// How the body of a scene may be mounted.
pub const MOUNTINGS: [BodyState; 3] = [BodyState::None, BodyState::Dry, BodyState::Wet];

/// Homed rigs to break, one for each mounting of the body.
#[derive(Debug, Clone)]
pub struct Catalogue {
    homed: Vec<(BodyState, ClosedLoop)>,
}

impl Catalogue {
    /// Homes the rigs and moves y to 0.5 m and x to 0.3 m.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] from the controller.
    pub fn new() -> Result<Self, ConfigError> {
        let homed = MOUNTINGS.map(|mounting| {
            let load = Load::mounted(mounting);
            let mut config = TwinConfig::loaded(load);
            config.axes[0].start_m = 0.02;
            config.axes[1].start_m = 0.02;
            let mut rig = ClosedLoop::new(&config, control_config(&[load; 2]), 0)?;
            let is_homed = rig.home();
            let is_there = (0..2).all(|axis| {
                let profile = Move {
                    target_m: [0.5, 0.3][axis],
                    speed_m_s: 0.1,
                    acceleration_m_s2: 0.3,
                    jerk_m_s3: 3.0,
                    is_shaped: true,
                };
                rig.carry_out(Request::Move { axis, profile }, axis, 100_000)
            });
            debug_assert!(is_homed && is_there, "{:?}", rig.output.status);
            Ok((mounting, rig))
        });
        Ok(Self { homed: homed.into_iter().collect::<Result<_, _>>()? })
    }

    /// One random move with one random injection; everything from the seed.
    #[must_use]
    pub fn run(&self, seed: u64) -> Outcome {
        let scene = Scene::drawn(&mut Pcg64Mcg::seed_from_u64(seed));
        let (mounting, homed) = &self.homed[scene.mounting];
        let mut rig = homed.clone();
        rig.twin.begin_run([Load::mounted(*mounting); 2], scene.load_seed);
        let axis = scene.axis;
        for (number, profile) in scene.moves.into_iter().enumerate() {
            rig.request(Request::Move { axis: number, profile });
            rig.step();
        }
        // On the way, once the axis really moves.
        for _ in 0..scene.after_ticks {
            rig.step();
        }
        let mut waited = 0;
        while rig.output.status.axes[axis].reference_m_s.abs() < 0.02 && waited < WAIT_TICKS {
            rig.step();
            waited += 1;
        }
        broken(rig, Scheduled { tick: 0, axis, injection: scene.injection }, *mounting)
    }
}

/// What is moved, what breaks, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Which of [`MOUNTINGS`].
    pub mounting: usize,
    /// What this run's friction and torque are drawn from.
    pub load_seed: u64,
    /// The axis that breaks.
    pub axis: usize,
    /// The moves of y and x.
    pub moves: [Move; 2],
    /// What breaks.
    pub injection: Injection,
    /// So many ticks after the moves began.
    pub after_ticks: i32,
}

impl Scene {
    /// A random one.
    #[must_use]
    pub fn drawn(rng: &mut impl Rng) -> Self {
        let mounting = rng.random_range(0..MOUNTINGS.len());
        let load_seed = rng.random();
        let axis = usize::from(rng.random_bool(0.3));
        let moves = [0, 1].map(|number: usize| Move {
            target_m: rng.random_range([1.5..3.5, 0.5..0.8][number].clone()),
            speed_m_s: rng.random_range([0.03..0.55, 0.03..0.15][number].clone()),
            acceleration_m_s2: rng.random_range(0.2..0.8),
            jerk_m_s3: 5.0,
            is_shaped: rng.random(),
        });
        let injection = Injection::random(rng);
        Self { mounting, load_seed, axis, moves, injection, after_ticks: rng.random_range(800..8_000) }
    }
}

/// What a series of runs gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sweep {
    /// For each injection and what it was called: how often, and the latest detection, s.
    pub reported: BTreeMap<(&'static str, String), (u64, f64)>,
    /// Runs that the catalogue does not allow, by seed.
    pub refused: Vec<(u64, Outcome)>,
}

impl Sweep {
    fn add(&mut self, seed: u64, outcome: Outcome) {
        let called = outcome.detected.map_or_else(|| "nothing".to_owned(), |(fault, _)| format!("{fault:?}"));
        let row = self.reported.entry((outcome.injection.name(), called)).or_default();
        *row = (row.0 + 1, row.1.max(outcome.detected.map_or(0.0, |(_, after_s)| after_s)));
        if !outcome.is_allowed() {
            self.refused.push((seed, outcome));
        }
    }

    /// Joins another series to this one.
    pub fn join(&mut self, other: Self) {
        for (what, (n, latest_s)) in other.reported {
            let row = self.reported.entry(what).or_default();
            *row = (row.0 + n, row.1.max(latest_s));
        }
        self.refused.extend(other.refused);
    }
}

impl Catalogue {
    /// Runs these seeds, one after the other. The result does not depend on how seeds are divided among threads.
    #[must_use]
    pub fn sweep(&self, seeds: impl IntoIterator<Item = u64>) -> Sweep {
        let mut sweep = Sweep::default();
        for seed in seeds {
            sweep.add(seed, self.run(seed));
        }
        sweep
    }
}

/// Breaks it now and watches.
fn broken(mut rig: ClosedLoop, scheduled: Scheduled, mounting: BodyState) -> Outcome {
    let Scheduled { axis, injection, .. } = scheduled;
    let mut outcome = Outcome {
        injection,
        axis,
        mounting,
        detected: rig.output.status.fault.map(|(fault, _)| (fault, 0.0)),
        has_left_travel: false,
        has_bad_command: false,
        is_at_rest: false,
        has_arrived: false,
    };
    rig.twin.inject(scheduled);
    let mut left = WAIT_TICKS;
    let mut waited = 0_u64;
    while left > 0 && !outcome.is_at_rest {
        left -= 1;
        waited += 1;
        let output = *rig.step();
        if outcome.detected.is_none()
            && let Some((fault, _)) = output.status.fault
        {
            outcome.detected = Some((fault, waited as f64 * TICK_S));
            left = REST_TICKS;
        }
        outcome.has_left_travel |= !rig.twin.is_inside_travel();
        outcome.has_bad_command |= output.command.axes.iter().any(|c| !c.volts.is_finite());
        let is_off = output.status.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Coasting));
        outcome.is_at_rest = is_off && (0..2).all(|i| rig.twin.truth(i).load_speed_m_s == 0.0);
    }
    outcome.has_bad_command |= rig.twin.refused_inputs() > 0;
    let ended = rig.output.status.axes[axis];
    outcome.has_arrived = ended.phase == Phase::Holding && (ended.reference_m - ended.position_m).abs() < ARRIVED_M;
    outcome
}
