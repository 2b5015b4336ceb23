//! What a robot's gait comes to: speed, powers, cost, torques, stability, and how much of the loss lies outside of the fit.
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

use froude_hydro::similarity::GRAVITY_M_S2;

use crate::chain::Chain;
use crate::drive::Servo;
use crate::driven::Driven;
use crate::dynamics::{Balance, Dynamics};
use crate::gait::{Course, Gait};
use crate::head::COARSE;
use crate::joints::Drives;
use crate::means::{Effort, Means};
use crate::moving::Instant;
use crate::path::Swimmer;
use crate::period::Periodic;
use crate::robot::Robot;
use crate::seen::Seen;
use crate::shares::gains;
use crate::stability::{REAL_LIMIT, Stiffness, stiffness};

/// Where roll and pitch need not repeat.
const NOT_PERIODIC: &str = "no motion of this gait repeats itself from period to period within reach; check its lengths, masses and added masses, where a slip of a unit does this; else take a smaller amplitude, or a frequency at which the drag settles it";
/// Steps of a period, at least.
pub const STEPS: usize = 400;
/// A step is at most this part of the longest that is stable about shapes at rest.
const SHORTER: f64 = 0.5;
/// Most links times steps of a period.
const MOST_LINK_STEPS: f64 = 4e6;
/// Of powers, between which a period is one that repeats.
const BALANCED: f64 = 1e-4;
/// Doublings and halvings of a frequency.
const MOST_DOUBLINGS: usize = 20;
/// Of the highest frequency.
const FOUND: f64 = 1e-3;
/// A gait that moves a swimmer by less than this part of its length in a period does not swim.
const STILL: f64 = 1e-9;
/// A gain of less than this part of the net power is none.
pub(crate) const NO_GAIN: f64 = 1e-3;

/// Why a gait has no answer, or that it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// It repeats itself.
    Periodic,
    /// Joints beyond their limits.
    Limit,
    /// No motion repeats itself.
    NotPeriodic,
    /// Nothing moves.
    Still,
    /// An inertia that is not positive.
    Inertia,
    /// A step that the servos do not allow.
    Step,
    /// A period of too many steps.
    TooSlow,
    /// It repeats itself, and needs more than the drives give or goes beyond the joints' limits.
    Drives,
}

impl Status {
    /// All of them, in the order of their codes.
    pub const ALL: [Self; 8] = [
        Self::Periodic,
        Self::Limit,
        Self::NotPeriodic,
        Self::Still,
        Self::Inertia,
        Self::Step,
        Self::TooSlow,
        Self::Drives,
    ];

    /// As a column has it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Periodic => "periodic",
            Self::Limit => "limit",
            Self::NotPeriodic => "not_periodic",
            Self::Still => "still",
            Self::Inertia => "inertia",
            Self::Step => "step",
            Self::TooSlow => "too_slow",
            Self::Drives => "drives",
        }
    }
}

/// Why a gait has no answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{words}")]
pub struct SwimError {
    /// As a row of a sweep has it.
    pub status: Status,
    words: String,
}

impl SwimError {
    pub(crate) fn of(status: Status, words: impl Into<String>) -> Self {
        Self { status, words: words.into() }
    }

    pub(crate) fn inertia() -> Self {
        Self::of(Status::Inertia, "an inertia of the chain is not positive: masses and added masses must be")
    }
}

/// What a gait comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Swim<C: Dynamics = Chain> {
    /// The motion that repeats; of a gait whose motion is unstable, the one that it settles into, where there is one. All figures are of this motion.
    pub periodic: Periodic<C>,
    /// The unstable motion that `periodic` takes the place of.
    pub unstable: Option<Box<Periodic<C>>>,
    /// Net power over m g U.
    pub cost: f64,
    /// What it needs and loses.
    pub effort: Effort,
}

impl<C: Dynamics> Robot<C> {
    /// Swims a gait to the motion that repeats, in steps of `step_s` at most where it is given.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: joints beyond their limits, no motion that repeats, an inertia that is not positive, a step that is not stable.
    pub fn swim(&self, gait: &dyn Course, drives: &Drives, step_s: Option<f64>) -> Result<Swim<C>, SwimError> {
        within(gait, drives)?;
        let mut swimmer = Swimmer::new(&self.chain, gait);
        if swimmer.rates(0.0, &C::REST).is_none() {
            return Err(SwimError::inertia());
        }
        let (steps, stiffness) = self.steps(gait, drives, step_s)?;
        let driven = || Driven::new(&self.chain, Servo::new(gait, &drives.following, &drives.motor));
        let mut seen = Seen::new(&self.chain, drives, gait);
        let mut see = |now: &Instant<'_, C::Motion>| seen.see(now);
        let found = if drives.following.is_empty() {
            swimmer.periodic_seen(steps, &mut see)
        } else {
            // Where joints follow exactly is where the search begins.
            let head = swimmer.periodic(STEPS).map_or(C::REST, |exact| exact.start);
            driven().periodic_seen(&head, steps, &mut see)
        };
        let mut periodic = found.ok_or_else(|| self.not_periodic())?;
        let mut unstable = None;
        // Without a righting moment, roll and pitch do not settle.
        if periodic.is_unstable() && self.chain.is_righted() {
            let mut again = Seen::new(&self.chain, drives, gait);
            let mut see = |now: &Instant<'_, C::Motion>| again.see(now);
            let settled = if drives.following.is_empty() {
                swimmer.settled_seen(&periodic, steps, &mut see)
            } else {
                driven().settled_seen(&periodic, steps, &mut see)
            };
            if let Some(settled) = settled {
                unstable = Some(Box::new(std::mem::replace(&mut periodic, settled)));
                seen = again;
            }
        }
        let means = periodic.means;
        if means.speed_m_s * gait.period_s() < STILL * self.chain.flat().length_m() {
            let speed_m_s = means.speed_m_s;
            let words = format!(
                "the gait does not swim: its speed is {speed_m_s:e} m/s; give it an amplitude, and a phase from joint to joint"
            );
            return Err(SwimError::of(Status::Still, words));
        }
        let given = means.loss_w + means.friction_w + means.lifting_w;
        // What is no number is not balanced either.
        let is_balanced = (given - means.net_w).abs() <= BALANCED * means.net_w.abs().max(means.loss_w);
        if !is_balanced {
            return Err(self.not_periodic());
        }
        Ok(Swim {
            cost: means.net_w / (self.mass_kg * GRAVITY_M_S2 * means.speed_m_s),
            effort: self.effort(&seen, drives, &means, (steps, stiffness), NO_GAIN * means.net_w),
            periodic,
            unstable,
        })
    }

    fn not_periodic(&self) -> SwimError {
        let restless = |balance: Balance| {
            let righting_mm = 1e3 * balance.righting_m;
            format!(
                "no motion of this gait repeats itself from period to period within reach, roll and pitch among it; the mass lies {righting_mm:.2} mm below the buoyancy, and where that is little nothing rights the body: lower center_of_mass or raise center_of_buoyancy; else take a smaller amplitude, or check lengths, masses and added masses for a slip of a unit"
            )
        };
        SwimError::of(Status::NotPeriodic, self.chain.balance().map_or_else(|| NOT_PERIODIC.to_owned(), restless))
    }

    /// What a motion needed and lost, in so many steps; a module that gains less than `least_w` gains nothing.
    pub(crate) fn effort(
        &self,
        seen: &Seen<'_, C>,
        drives: &Drives,
        means: &Means,
        (steps, stiffness): (usize, Option<Stiffness>),
        least_w: f64,
    ) -> Effort {
        let losses = &seen.losses;
        Effort {
            electric_w: drives.motor.electric_w(means.positive_w, means.absolute_w - means.positive_w),
            needs: seen.needs(),
            steps,
            stiffness,
            extrapolated: losses.extrapolated(self.speed_m_s, self.angle_rad),
            along: losses.along(),
            median_angle_rad: losses.median_angle_rad(),
            gain_w: self.gain(losses.fastest_m_s(), least_w),
        }
    }

    /// The module that gains the most power from still water at speeds up to one, counted from 1, where it is above `least_w`.
    fn gain(&self, fastest_m_s: f64, least_w: f64) -> Option<(usize, f64)> {
        // Modules alike follow each other, and what one gains the next one does.
        let mut last = None;
        let gain = |(i, link): (usize, &crate::chain::Link)| {
            let own = last
                .filter(|(drag, _)| *drag == link.drag)
                .map_or_else(|| gains(&link.drag, fastest_m_s), |(_, own)| own);
            last = Some((link.drag, own));
            let (power, _) = own?;
            (power > least_w).then_some((i + 1, power))
        };
        self.chain.flat().links.iter().enumerate().filter_map(gain).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Steps of a course's time: enough for its waves, the drag and the servos.
    pub(crate) fn steps(
        &self,
        course: &dyn Course,
        drives: &Drives,
        step_s: Option<f64>,
    ) -> Result<(usize, Option<Stiffness>), SwimError> {
        let period_s = course.period_s();
        let stiffness = match &drives.following[..] {
            [] => None,
            following => Some(stiffness(&self.chain, course, following).ok_or_else(SwimError::inertia)?),
        };
        // The search for the motion that repeats begins with longer steps.
        let settled_s = REAL_LIMIT / (COARSE as f64 * self.chain.flat().settles_per_s());
        let (longest_s, why) = match stiffness {
            Some(s) if s.longest_step_s < settled_s => (s.longest_step_s, "servos"),
            _ => (settled_s, "linear drag settles it many times within a period"),
        };
        if let (Some(asked_s), Some(s)) = (step_s.filter(|asked| *asked > longest_s), stiffness) {
            let Stiffness { damping_per_s, .. } = s;
            let by_damping_s = REAL_LIMIT / damping_per_s;
            let would_do_s = period_s / (period_s / (SHORTER * longest_s)).ceil();
            let words = format!(
                "a step of {asked_s} s is not stable: the largest eigenvalue of k_d over the inertia of the joints (friction in k_d) is {damping_per_s:.6} 1/s, which by itself allows 2.785/{damping_per_s:.6} = {by_damping_s:.3e} s; with k_p the limit is {longest_s:.3e} s: take --step '{would_do_s:.6} s', which is half of it and divides the period, or a smaller kd"
            );
            return Err(SwimError::of(Status::Step, words));
        }
        let step_s = step_s.unwrap_or((period_s / STEPS as f64).min(SHORTER * longest_s));
        let steps = (period_s / step_s).ceil();
        let most = MOST_LINK_STEPS / (self.chain.joints() + 1) as f64;
        if steps > most {
            let words = format!(
                "a period of {period_s:e} s needs steps of {step_s:e} s at most ({why}), which are more than {most:e} for this chain: take a higher frequency or, for servos, a smaller kd"
            );
            return Err(SwimError::of(Status::TooSlow, words));
        }
        Ok((steps as usize, stiffness))
    }

    /// The highest frequency, rad/s, at which motors give what a gait of joints that follow exactly needs; `None` where they have no curve or give none of it.
    ///
    /// Torques grow with the frequency: it is sought between doubled and halved ones, to a thousandth.
    #[must_use]
    pub fn fastest(&self, gait: &Gait, drives: &Drives) -> Option<f64> {
        if drives.motor.curve.is_empty() || !drives.following.is_empty() {
            return None;
        }
        let free = Drives { motor: drives.motor.clone(), ..Drives::free(self.chain.joints()) };
        let gives = |frequency: f64| {
            let gait = Gait { frequency, ..gait.clone() };
            self.swim(&gait, &free, None).is_ok_and(|swim| swim.effort.needs.share <= 1.0)
        };
        let (mut low, mut high) = (gait.frequency, gait.frequency);
        let mut tries = 0..MOST_DOUBLINGS;
        while gives(high) {
            (low, high) = (high, 2.0 * high);
            tries.next()?;
        }
        while !gives(low) {
            (low, high) = (0.5 * low, low);
            tries.next()?;
        }
        while high / low > 1.0 + FOUND {
            let middle = (low * high).sqrt();
            if gives(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }
}

/// Whether a course stays within the limits of the joints.
pub(crate) fn within(gait: &dyn Course, drives: &Drives) -> Result<(), SwimError> {
    let joints = drives.limits.len();
    for (joint, limits) in (1..).zip(&drives.limits) {
        let [angle, rate] = gait.extremes(joint - 1, joints);
        let degrees = |x: f64| format!("{:.4}", x.to_degrees()).trim_end_matches('0').trim_end_matches('.').to_owned();
        let refused = |asked, allowed, unit: &str| {
            let words = format!(
                "the gait asks for {} {unit} at joint {joint}, and the joints allow {} {unit}: take a smaller amplitude or, for a rate, a lower frequency",
                degrees(asked),
                degrees(allowed)
            );
            Err(SwimError::of(Status::Limit, words))
        };
        if let Some(allowed) = limits.angle_rad.filter(|limit| angle > *limit) {
            return refused(angle, allowed, "deg");
        }
        if let Some(allowed) = limits.rate_rad_s.filter(|limit| rate > *limit) {
            return refused(rate, allowed, "deg/s");
        }
    }
    Ok(())
}
