//! What a robot's gait comes to: speed, powers, cost, torques, stability, and how far its coefficients are stretched.
//!
//! | quantity | what it is |
//! | --- | --- |
//! | speed | of the centre of mass through the water from the beginning of a period to its end, over the period |
//! | net power | mean of Σ τφ̇: what the water takes |
//! | positive power | mean of Σ max(τφ̇, 0): what drives without recovery give |
//! | cost of transport | net power over speed, J/m, and over m g U |
//! | extrapolated loss | share of the drag's power where a link's speed or angle to the flow lies outside of what its coefficients were fitted at |
//!
//! Positive over net power is between 1.5 and 10.4 in the gaits of the papers: neither is "the power".
//!
//! **Units.** SI.

use crate::gait::{Envelope, Gait, Shape};
use crate::path::{State, Swimmer};
use crate::period::Periodic;
use crate::planar::{Motion, dot};
use crate::robot::Robot;
use crate::shares::gains;

/// Steps of a period.
pub const STEPS: usize = 400;
/// Of powers, between which a period is one that repeats.
const BALANCED: f64 = 1e-4;
/// Most numbers of a trajectory: 800 MB.
const MOST_NUMBERS: f64 = 1e8;
/// A gait that moves a swimmer by less than this part of its length in a period does not swim.
const STILL: f64 = 1e-9;
/// A gain of less than this part of the net power is none.
const NO_GAIN: f64 = 1e-3;
/// m/s².
const GRAVITY: f64 = 9.80665;

/// Why a gait has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwimError {
    /// An inertia that is not positive.
    #[error("an inertia of the chain is not positive: masses and added masses must be")]
    Inertia,
    /// A gait that the joints do not allow.
    #[error(
        "the gait asks for {asked} at joint {joint}, and the joints allow {allowed}: take a smaller amplitude or, for a rate, a lower frequency"
    )]
    Limit {
        /// The joint, from the head.
        joint: usize,
        /// What it asks for, with its unit.
        asked: String,
        /// What is allowed.
        allowed: String,
    },
    /// No motion repeats itself.
    #[error(
        "no motion of this gait repeats itself from period to period within reach; check its lengths, masses and added masses, where a slip of a unit does this; else take a smaller amplitude, or a frequency at which the drag settles it"
    )]
    NotPeriodic,
    /// Nothing moves.
    #[error(
        "the gait does not swim: its speed is {speed_m_s:e} m/s; give it an amplitude, and a phase from joint to joint"
    )]
    Still {
        /// m/s.
        speed_m_s: f64,
    },
    /// A trajectory that no memory holds.
    #[error(
        "{periods} periods of {joints} joints are {numbers:e} numbers; a trajectory has {MOST_NUMBERS:e} at most: ask for fewer --periods"
    )]
    TooLong {
        /// Periods.
        periods: usize,
        /// Joints.
        joints: usize,
        /// Numbers of the trajectory.
        numbers: f64,
    },
}

/// What a gait comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Swim {
    /// The motion that repeats.
    pub periodic: Periodic,
    /// Net power over speed, J/m.
    pub cost_j_m: f64,
    /// Positive power over speed, J/m.
    pub cost_positive_j_m: f64,
    /// Net power over m g U.
    pub cost: f64,
    /// Largest rate of a joint, rad/s.
    pub rate_rad_s: f64,
    /// Share of the loss outside of the fitted speeds, and outside of the fitted angles; `None` where the record does not say them.
    pub extrapolated: [Option<f64>; 2],
    /// Half of the loss is at smaller angles to the flow, rad.
    pub median_angle_rad: f64,
    /// Largest power that a module gains from still water at the speeds reached, W, with its number from the head; less than a thousandth of the net power is none.
    pub gain_w: Option<(usize, f64)>,
}

/// Limits of the joints, where they are declared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest angle, rad.
    pub angle_rad: Option<f64>,
    /// Largest rate, rad/s.
    pub rate_rad_s: Option<f64>,
}

impl Robot {
    /// Swims a gait to the motion that repeats.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: joints beyond their limits, no motion that repeats, an inertia that is not positive.
    pub fn swim(&self, gait: &Gait, limits: Limits) -> Result<Swim, SwimError> {
        within(gait, self.chain.joints(), limits)?;
        let mut swimmer = Swimmer::new(&self.chain, gait);
        if swimmer.rates(0.0, &State::default()).is_none() {
            return Err(SwimError::Inertia);
        }
        let periodic = swimmer.periodic(STEPS).ok_or(SwimError::NotPeriodic)?;
        let length: f64 = self.chain.links.iter().map(|link| 2.0 * link.half_length_m).sum();
        if periodic.speed_m_s * gait.period_s() < STILL * length {
            return Err(SwimError::Still { speed_m_s: periodic.speed_m_s });
        }
        // What is no number is not balanced either.
        let is_balanced = (periodic.loss_w / periodic.net_w - 1.0).abs() <= BALANCED;
        if !is_balanced {
            return Err(SwimError::NotPeriodic);
        }
        let losses = self.losses(&mut swimmer, periodic.head).ok_or(SwimError::Inertia)?;
        let all: f64 = losses.iter().map(|l| l.power_w).sum();
        let share = |is_outside: &dyn Fn(&Loss) -> bool| {
            losses.iter().filter(|l| is_outside(l)).map(|l| l.power_w).fold(0.0, |sum, power| sum + power) / all
        };
        let beyond = |range: Option<[f64; 2]>, of: &dyn Fn(&Loss) -> f64| {
            range.map(|range| {
                let [low, high] = folded(range);
                share(&|l| !(low..=high).contains(&of(l)))
            })
        };
        let fastest = losses.iter().map(|l| l.speed_m_s).fold(0.0, f64::max);
        let gain = |(i, link): (usize, &crate::chain::Link)| {
            let (power, _) = gains(&link.drag, fastest)?;
            (power > NO_GAIN * periodic.net_w).then_some((i + 1, power))
        };
        Ok(Swim {
            cost_j_m: periodic.net_w / periodic.speed_m_s,
            cost_positive_j_m: periodic.positive_w / periodic.speed_m_s,
            cost: periodic.net_w / (self.mass_kg * GRAVITY * periodic.speed_m_s),
            rate_rad_s: (1..=self.chain.joints())
                .map(|i| size(gait, i, self.chain.joints()) * gait.frequency)
                .fold(0.0, f64::max),
            extrapolated: [beyond(self.speed_m_s, &|l| l.speed_m_s), beyond(self.angle_rad, &|l| l.angle_rad)],
            median_angle_rad: median(losses.clone()),
            gain_w: self.chain.links.iter().enumerate().filter_map(gain).max_by(|a, b| a.1.total_cmp(&b.1)),
            periodic,
        })
    }

    /// What each link loses over the period, at each step.
    fn losses(&self, swimmer: &mut Swimmer<'_>, head: Motion) -> Option<Vec<Loss>> {
        let h = swimmer.gait.period_s() / STEPS as f64;
        let mut state = State { head, ..State::default() };
        let mut out = Vec::new();
        for i in 0..STEPS {
            swimmer.rates(i as f64 * h, &state)?;
            for (link, motion) in self.chain.links.iter().zip(swimmer.work.motions()) {
                let [_, u, v] = *motion;
                out.push(Loss {
                    speed_m_s: u.hypot(v),
                    // Fore and aft, and port and starboard, are alike.
                    angle_rad: v.abs().atan2(u.abs()),
                    // A link that gains is told apart.
                    power_w: (-dot(link.drag.load(link.half_length_m, *motion), *motion)).max(0.0),
                });
            }
            state = swimmer.step(i as f64 * h, h, &state)?;
        }
        Some(out)
    }
}

/// A link at a moment.
#[derive(Debug, Clone, Copy)]
struct Loss {
    speed_m_s: f64,
    angle_rad: f64,
    power_w: f64,
}

/// A range of sizes: of −39° to −10° that of 10° to 39°.
fn folded([low, high]: [f64; 2]) -> [f64; 2] {
    let least = if low <= 0.0 && high >= 0.0 { 0.0 } else { low.abs().min(high.abs()) };
    [least, low.abs().max(high.abs())]
}

/// The angle below which half of the loss is.
fn median(mut losses: Vec<Loss>) -> f64 {
    losses.sort_by(|a, b| a.angle_rad.total_cmp(&b.angle_rad));
    let half = 0.5 * losses.iter().map(|l| l.power_w).sum::<f64>();
    let mut sum = 0.0;
    losses
        .iter()
        .find_map(|l| {
            sum += l.power_w;
            (sum >= half).then_some(l.angle_rad)
        })
        .unwrap_or(0.0)
}

/// Amplitude of a joint, rad.
fn size(gait: &Gait, joint: usize, joints: usize) -> f64 {
    gait.amplitude.abs()
        * match &gait.envelope {
            Envelope::Lateral => 1.0,
            Envelope::Eel => joint as f64 / (joints + 2) as f64,
            Envelope::Factors(each) => each.get(joint - 1).copied().unwrap_or(0.0).abs(),
        }
}

fn within(gait: &Gait, joints: usize, limits: Limits) -> Result<(), SwimError> {
    for joint in 1..=joints {
        let angle = size(gait, joint, joints) + gait.turn.abs();
        let rate = size(gait, joint, joints) * gait.frequency.abs();
        let degrees = |x: f64| format!("{:.4}", x.to_degrees()).trim_end_matches('0').trim_end_matches('.').to_owned();
        let refused = |asked, allowed, unit: &str| SwimError::Limit {
            joint,
            asked: format!("{} {unit}", degrees(asked)),
            allowed: format!("{} {unit}", degrees(allowed)),
        };
        if let Some(allowed) = limits.angle_rad.filter(|limit| angle > *limit) {
            return Err(refused(angle, allowed, "deg"));
        }
        if let Some(allowed) = limits.rate_rad_s.filter(|limit| rate > *limit) {
            return Err(refused(rate, allowed, "deg/s"));
        }
    }
    Ok(())
}

/// A moment of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// s.
    pub time_s: f64,
    /// The state.
    pub state: State,
    /// Centre of mass, m.
    pub centre_m: [f64; 2],
    /// Angles of the joints.
    pub shape: Shape,
    /// Torques, N m.
    pub torque_n_m: Vec<f64>,
    /// Powers: net, positive, of the drag, W.
    pub power_w: [f64; 3],
    /// Kinetic energy of body and water, J.
    pub energy_j: f64,
}

impl Robot {
    /// The trajectory over so many periods from the motion that repeats, so many moments a period, in a current. Its first period leads along x.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: more numbers than a memory holds, an inertia that is not positive.
    pub fn trajectory(
        &self,
        gait: &Gait,
        periodic: &Periodic,
        (periods, moments): (usize, usize),
        current_m_s: [f64; 2],
    ) -> Result<Vec<Moment>, SwimError> {
        let joints = self.chain.joints();
        let numbers = periods as f64 * moments as f64 * (5 * joints + 20) as f64;
        if numbers > MOST_NUMBERS {
            return Err(SwimError::TooLong { periods, joints, numbers });
        }
        let mut swimmer = Swimmer::new(&self.chain, gait);
        swimmer.current_m_s = current_m_s;
        let moments = moments.max(1);
        let each = STEPS.div_ceil(moments);
        let h = gait.period_s() / (each * moments) as f64;
        let [x, y] = periodic.way_m;
        let mut state = State { head: periodic.head, heading: -y.atan2(x), ..State::default() };
        let mut out = Vec::new();
        for i in 0..=periods * moments {
            let time_s = (i * each) as f64 * h;
            let rates = swimmer.rates(time_s, &state).ok_or(SwimError::Inertia)?;
            out.push(Moment {
                time_s,
                state,
                centre_m: swimmer.centre_m(&state),
                shape: swimmer.shape.clone(),
                torque_n_m: swimmer.work.answer.clone(),
                power_w: [rates.work_j, rates.positive_j, rates.loss_j],
                energy_j: swimmer.energy_j(),
            });
            for k in 0..each {
                state = swimmer.step((i * each + k) as f64 * h, h, &state).ok_or(SwimError::Inertia)?;
            }
        }
        Ok(out)
    }
}
