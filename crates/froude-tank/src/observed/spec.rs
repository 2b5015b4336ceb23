//! What a method of single observations states, as data.

use froude_fit::budget::Uncertain;
use froude_identify::declare::Key;
use froude_records::block::Digits;
use froude_records::run::Role;
use froude_records::units::Dimension;

use crate::channel::Channel;
use crate::error::TankError;
use crate::matrix::Plan;
use crate::steady::window::Told;

pub use crate::matrix::Point;

/// A method as data.
#[derive(Debug, Clone, Copy)]
pub struct Spec {
    /// Name of the method and of its section.
    pub name: &'static str,
    /// In a message, with its article: `a drop`.
    pub called: &'static str,
    /// Roles of the runs that are read. Those of the role test are observed; a still run is not reduced.
    pub roles: &'static [Role],
    /// The keys of its section.
    pub keys: &'static [Key],
    /// What to write where there is no section; empty where all keys have defaults.
    pub missing: &'static str,
    /// The keys of a block of its plan: `configurations`, `repeats`, and an axis for each condition that is planned.
    pub plan: &'static [Key],
    /// What a log has, in words: `time and depth`.
    pub reads: &'static str,
    /// Conditions that a run states.
    pub conditions: &'static [Condition],
    /// Channels that a log may have.
    pub channels: &'static [Channel],
    /// Channels of the twin's sensors other than loads, and whether their noise may be correlated.
    pub senses: &'static [(&'static str, bool)],
    /// Loads that it observes.
    pub loads: &'static [&'static str],
    /// What a guessed sign of a channel costs, in words.
    pub guessed: &'static str,
    /// What the budget calls the error that the speed of each run has for itself.
    pub speed_error: &'static str,
}

impl Spec {
    /// Its plan: what is simulated is as long as its rig makes it.
    pub(super) const fn planned(&self) -> Plan {
        Plan::of(self.plan, |_| (1, 0.0))
    }

    /// Texts that fit most methods; the others have to be stated.
    pub const GENERAL: Self = Self {
        name: "",
        called: "",
        roles: &[Role::Test],
        keys: &[],
        missing: "",
        plan: &[],
        reads: "",
        conditions: &[],
        channels: &[],
        senses: &[],
        loads: &["f_x"],
        guessed: "drag is wrong by its size or its sign where one is guessed",
        speed_error: "errors of the speeds",
    };
}

/// A condition that a run is done in.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// In `[conditions]`, and as a key of the plan.
    pub name: &'static str,
    /// Of its value.
    pub dimension: Dimension,
    /// Key and head of its column in the plan: `weight_n`, `weight [N]`.
    pub column: [&'static str; 2],
    /// Of its column.
    pub digits: Digits,
    /// What holds where a run states none.
    pub otherwise: Unstated,
}

/// What holds where a run does not state a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unstated {
    /// This value, SI.
    Is(f64),
    /// The run is refused with what to write.
    Refused(&'static str),
    /// It has none; another channel may tell it, or nobody needs it.
    Nothing,
}

/// The angle of attack, whose loads lie along the axes of the body.
pub const ANGLE: Condition = Condition {
    name: "angle",
    dimension: Dimension::ONE,
    column: ["angle_rad", "angle [deg]"],
    digits: Digits::Plain(4),
    otherwise: Unstated::Is(0.0),
};

/// A log as a method takes it: columns of one length, time increasing.
#[derive(Debug, Clone)]
pub struct Run<'a> {
    /// What it is.
    pub point: Point,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Channels that [`super::method::Observed::takes`] names.
    pub channels: Vec<(&'a str, &'a [f64])>,
    /// What its sidecar declares of its parts.
    pub told: Told<'a>,
}

impl<'a> Run<'a> {
    /// A channel; empty where the run has none of this name.
    #[must_use]
    pub fn channel(&self, name: &str) -> &'a [f64] {
        self.channels.iter().find(|(own, _)| *own == name).map_or(&[], |(_, values)| values)
    }

    /// That it cannot be reduced, and what to do; the message starts with its name.
    pub fn refused(&self, what: impl Into<String>) -> TankError {
        TankError::of_run(&self.point.id, what)
    }
}

/// A number that is declared, and that errs for all runs alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// In words, as the budget calls it: `scale of the picture`.
    pub name: &'static str,
    /// As declared.
    pub known: Option<Uncertain>,
    /// Its value where nothing is declared.
    pub otherwise: f64,
}

/// What a standard uncertainty of a declared number moves an observation by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Moves {
    /// Its speed, m/s.
    pub speed_m_s: f64,
    /// Its loads, N.
    pub loads_n: Vec<f64>,
}

/// Values of constants where nothing is drawn.
pub(super) fn values(constants: &[Constant]) -> Vec<f64> {
    constants.iter().map(|c| c.known.map_or(c.otherwise, |known| known.value)).collect()
}
