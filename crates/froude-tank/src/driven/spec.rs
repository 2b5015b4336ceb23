//! What a method with a motor-driven body states, as data.

use froude_fit::budget::Uncertain;
use froude_identify::declare::Key;
use froude_records::run::Role;
use froude_records::units::Dimension;

pub use crate::channel::Channel;
pub use crate::matrix::Point;

/// A method as data.
#[derive(Debug, Clone, Copy)]
pub struct Spec {
    /// Name of the method and of its section.
    pub name: &'static str,
    /// In a message, with its article: `a rotation`.
    pub called: &'static str,
    /// The keys of its section.
    pub keys: &'static [Key],
    /// What to write where there is no section.
    pub missing: &'static str,
    /// The keys of a block of its plan.
    pub plan: &'static [Key],
    /// The key of the plan that states the role of a run, and the role of each of its words. The first one is needed.
    pub roles: (&'static str, &'static [Role]),
    /// What changes between runs, in words.
    pub changed: &'static str,
    /// Conditions of a run.
    pub conditions: &'static [Condition],
    /// The motion.
    pub motion: Channel,
    /// The loads.
    pub loads: &'static [Channel],
    /// What a guessed sign of a channel costs, in words.
    pub guessed: &'static str,
    /// What a residual that repeats may be, in words.
    pub repeats: &'static str,
    /// Why runs may leave coefficients undetermined, and what to do.
    pub undetermined: &'static str,
    /// The same of a plan.
    pub unplanned: &'static str,
    /// What the fit finds together with the loads, in words.
    pub found: &'static str,
    /// Name of its law in the record; empty where a campaign chooses between laws.
    pub law: &'static str,
    /// Why the only law is recommended.
    pub only_law: &'static str,
    /// The added mass, which is shown for each law where there are several, and the sign that it has on every body.
    pub added: (&'static str, f64),
}

impl Spec {
    /// Texts that fit most methods; the others have to be stated.
    pub const GENERAL: Self = Self {
        name: "",
        called: "",
        keys: &[],
        missing: "",
        plan: &[],
        roles: ("", &[Role::Test]),
        changed: "what is mounted",
        conditions: &[],
        motion: Channel::GENERAL,
        loads: &[],
        guessed: "a wrong guess can make the added mass wrong by its own size",
        repeats: "a load that the law lacks, or a wrong sign",
        undetermined: "Drive at another frequency or amplitude, or declare the delay",
        unplanned: "the planned runs do not tell its coefficients apart; plan another frequency or amplitude, or declare the delay",
        found: "the coefficients",
        law: "",
        only_law: "the only law of the method",
        added: ("", 1.0),
    };
}

/// A condition that a run is done in.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// In `[conditions]`, and as a key of the plan if it is one.
    pub name: &'static str,
    /// Of its value.
    pub dimension: Dimension,
    /// SI.
    pub unit: &'static str,
    /// Value for a run of this role, from its declared value if there is one; the error says what to do.
    pub of: fn(Role, Option<f64>) -> Result<f64, String>,
}

/// A coefficient that the method looks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficient {
    /// Its name.
    pub name: String,
    /// SI unit text.
    pub unit: String,
    /// Whether it is of the body; a nuisance otherwise.
    pub is_wanted: bool,
    /// Whether it cannot be negative, unless the campaign states otherwise.
    pub is_bounded: bool,
    /// Its part of the load may change from run to run, as drag does with mount and wake: by a fraction that all coefficients of this group share.
    pub varies: Option<usize>,
    /// It is looked for where there are runs of this role.
    pub role: Role,
}

/// A constant that is declared, and that may be an unknown too.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// In words: `mass of H1LT`.
    pub name: String,
    /// As declared.
    pub known: Option<Uncertain>,
    /// Where it enters.
    pub enters: Enters,
    /// Names by which `[[source.uncertainty]]` states its uncertainty.
    pub quantities: &'static [&'static str],
    /// It matters for runs of this role alone.
    pub role: Option<Role>,
    /// It matters for this configuration alone.
    pub configuration: Option<String>,
    /// As an unknown; `None` of one that never is.
    pub unknown: Option<Unknown>,
    /// Value where it is neither declared nor stated; the error says what to declare.
    pub otherwise: Result<f64, &'static str>,
}

/// Where a constant enters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Enters {
    /// The equation; the number is its scale, of which finite differences take a small part as step. A constant that enters linearly has scale one.
    Equation(f64),
    /// As a factor of the equation's: its uncertainty is relative.
    Factor,
    /// As the delay of the loads behind the motion.
    Delay,
    /// As the gain of the motion's sensor.
    Motion,
    /// As the gain of a load, by its place.
    Load(usize),
    /// Derived quantities only, not the fit.
    Derived,
}

/// A constant as an unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Name of the coefficient.
    pub name: String,
    /// SI unit text.
    pub unit: &'static str,
    /// Role of the runs that determine it.
    pub role: Role,
    /// Whether it is fitted even if it is declared as exact.
    pub if_exact: bool,
}

impl Constant {
    /// A constant of the equation that is declared, or else the advice on what to declare.
    #[must_use]
    pub fn new(name: impl Into<String>, known: Option<Uncertain>, size: f64, advice: &'static str) -> Self {
        Self {
            name: name.into(),
            known,
            enters: Enters::Equation(size),
            quantities: &[],
            role: None,
            configuration: None,
            unknown: None,
            otherwise: Err(advice),
        }
    }

    /// A factor that is one, with a relative uncertainty: the gain of a sensor, or of the stream.
    #[must_use]
    pub fn gain(name: impl Into<String>, enters: Enters, quantities: &'static [&'static str]) -> Self {
        Self { enters, quantities, ..Self::new(name, Some(Uncertain::new(1.0, 0.0)), 1.0, "") }
    }

    /// The delay of the loads behind the motion; found if it is not declared.
    #[must_use]
    pub fn delay(known: Option<Uncertain>) -> Self {
        let delay = crate::joint::DELAY;
        let unknown = Unknown { name: delay.to_owned(), unit: "s", role: Role::Test, if_exact: false };
        Self { enters: Enters::Delay, otherwise: Ok(0.0), ..Self::new(delay, known, 1.0, "").or_found(unknown) }
    }

    /// Runs may look for it.
    #[must_use]
    pub fn or_found(self, unknown: Unknown) -> Self {
        Self { unknown: Some(unknown), ..self }
    }

    /// It matters for runs of this role alone.
    #[must_use]
    pub fn of_role(self, role: Role) -> Self {
        Self { role: Some(role), ..self }
    }

    /// Whether it matters for any of these runs.
    #[must_use]
    pub fn matters<'p>(&self, mut points: impl Iterator<Item = &'p Point>) -> bool {
        points.any(|p| {
            self.role.is_none_or(|role| role == p.role)
                && self.configuration.as_ref().is_none_or(|name| *name == p.configuration)
        })
    }

    /// As an unknown, where these runs look for it.
    #[must_use]
    pub fn looked_for<'p>(&self, mut points: impl Iterator<Item = &'p Point>) -> Option<&Unknown> {
        let unknown = self.unknown.as_ref()?;
        let is_exact = self.known.is_some_and(|known| known.standard <= 0.0);
        let is_there = points.any(|p| {
            // A delay is that of all runs.
            let of_role = self.enters == Enters::Delay || unknown.role == p.role;
            of_role && self.configuration.as_ref().is_none_or(|name| *name == p.configuration)
        });
        (is_there && (unknown.if_exact || !is_exact)).then_some(unknown)
    }
}

/// What multiplies a motion in the equation, by its place among the coefficients or the constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Factor {
    /// A coefficient.
    Coefficient(usize),
    /// A constant that enters linearly.
    Constant(usize),
}

/// Takes a term of a load, by its place: its factor, and the motion at each sample.
pub type Terms<'t> = dyn FnMut(usize, Factor, &[f64]) + 't;

/// A number of a run that its amplitude and frequency give.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Key and head of its column in the plan; `None` of one that is not shown there.
    pub column: Option<[&'static str; 2]>,
    /// Name and unit in the validity of a record; `None` of one that is not stated there.
    pub validity: Option<[&'static str; 2]>,
    /// Its value, where what it needs is declared.
    pub value: Option<f64>,
}
