//! What the numbers of a channel are: quantity, unit, frame, sign, clock.
//!
//! Froude's own names say all of it but the clock, so that logs without a word of it are known too:
//!
//! | name | quantity | frame, sign |
//! |---|---|---|
//! | `y/position`, `y/reference_…`, `truth/y/load_…` | position, velocity, acceleration | along the chain of axis `y`, + |
//! | `y/command`, `y/current` | voltage, current | along it, +: what pushes towards +y |
//! | `y/encoder` | count | the sensor's own, + |
//! | `y/state`, `y/fault` | code | none |
//! | `force`, `truth/y/drag` | force | along `y`, −: what the water exerts against +y motion |
//! | `truth/y/spring` | force | along `y`, +: what the chain exerts on the load |
//!
//! The same for `x`. A field of an axis without its axis (`position` of an imported log) is the quantity and has no frame; of any
//! other name the unit tells the quantity.

use toml::Spanned;
use toml::de::DeValue;

use crate::error::RecordError;
use crate::nearest::{meant, suggestion};
use crate::run::sensor::KEYS as KEYS_OF_SENSOR;
use crate::section::Section;
use crate::units::{Dimension, parse_unit};

/// The clock of the board that recorded.
pub const BOARD: &str = "board";
/// The times of a log of which nobody said what clock wrote them.
pub const LOG: &str = "log";

/// What the numbers of a channel are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Meaning {
    /// `position`, `velocity`, `force`, `voltage`, … or any other word.
    pub quantity: String,
    /// Unit, as [`parse_unit`] reads it; `1` for counts and codes.
    pub unit: String,
    /// What its direction is along.
    pub frame: Frame,
    /// +1 or −1: value times sign is along the positive direction of the frame.
    pub sign: i8,
    /// Which clock its times are of.
    pub clock: String,
}

/// What the direction of a channel is along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// The chain of the long axis, positive forward.
    Y,
    /// The chain of the short axis.
    X,
    /// The sensor's own axes.
    Sensor,
    /// The body's axes.
    Body,
    /// It has no direction, or nobody said it.
    #[default]
    None,
}

impl Frame {
    /// Each of them.
    pub const ALL: [Self; 5] = [Self::Y, Self::X, Self::Sensor, Self::Body, Self::None];
    pub(crate) const NAMES: [&'static str; 5] = ["y", "x", "sensor", "body", "none"];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Known quantities; the first of a dimension is what a unit alone tells.
const QUANTITIES: [(&str, Dimension); 20] = [
    ("number", Dimension::ONE),
    ("length", Dimension::LENGTH),
    ("velocity", Dimension::SPEED),
    ("acceleration", Dimension::ACCELERATION),
    ("angular_velocity", Dimension::ANGULAR_SPEED),
    ("angular_acceleration", Dimension::ANGULAR_ACCELERATION),
    ("force", Dimension::FORCE),
    ("moment", Dimension::MOMENT),
    ("voltage", Dimension::VOLTAGE),
    ("current", Dimension::CURRENT),
    ("temperature", Dimension::TEMPERATURE),
    ("pressure", Dimension::PRESSURE),
    ("power", Dimension::POWER),
    ("mass", Dimension::MASS),
    ("time", Dimension::TIME),
    ("density", Dimension::DENSITY),
    ("position", Dimension::LENGTH),
    ("angle", Dimension::ANGLE),
    ("count", Dimension::ONE),
    ("code", Dimension::ONE),
];

/// Quantity of the fields of an axis, and sign against it.
const FIELDS: [(&str, &str, i8); 14] = [
    ("encoder", "count", 1),
    ("position", "position", 1),
    ("reference_position", "position", 1),
    ("reference_velocity", "velocity", 1),
    ("reference_acceleration", "acceleration", 1),
    ("command", "voltage", 1),
    ("current", "current", 1),
    ("state", "code", 1),
    ("fault", "code", 1),
    ("load_position", "position", 1),
    ("load_velocity", "velocity", 1),
    ("drag", "force", -1),
    ("spring", "force", 1),
    ("angle", "angle", 1),
];

/// What a name of Froude's own says: quantity, frame, sign.
fn of_name(name: &str) -> Option<(&'static str, Frame, i8)> {
    if name == "force" {
        return Some(("force", Frame::Y, -1));
    }
    let (axis, field) = name.rsplit_once('/').map_or(("", name), |(prefix, field)| (prefix, field));
    let (_, quantity, sign) = FIELDS.into_iter().find(|(known, ..)| *known == field)?;
    let along = match axis {
        "y" | "truth/y" => Frame::Y,
        "x" | "truth/x" => Frame::X,
        "" => Frame::None,
        _ => return None,
    };
    let frame = match quantity {
        "count" if along != Frame::None => Frame::Sensor,
        "code" => Frame::None,
        _ => along,
    };
    Some((quantity, frame, if along == Frame::None { 1 } else { sign }))
}

impl Meaning {
    /// What a channel's name and unit tell.
    #[must_use]
    pub fn of(name: &str, unit: &str, clock: &str) -> Self {
        let by_unit = || {
            let dimension = parse_unit(unit).ok().map(|unit| unit.dimension);
            QUANTITIES.iter().find(|(_, own)| Some(*own) == dimension).map_or("other", |(quantity, _)| *quantity)
        };
        let (quantity, frame, sign) = of_name(name).unwrap_or_else(|| (by_unit(), Frame::None, 1));
        Self { quantity: quantity.to_owned(), unit: unit.to_owned(), frame, sign, clock: clock.to_owned() }
    }

    /// Reads what a sidecar declares of a channel; what it leaves out is what the name tells.
    ///
    /// # Errors
    ///
    /// A unit of another dimension than the quantity's, a sign against that of a name of Froude's own.
    pub(crate) fn read(s: &Section<'_>, name: &str, frames: &[&str]) -> Result<(Self, Words), RecordError> {
        s.only(&[&["quantity", "unit", "frame", "sign", "clock"], &KEYS_OF_SENSOR[..]].concat())?;
        let unit = s.need_text("unit", "write unit = \"m\", for example; \"1\" for counts and codes")?;
        let dimension =
            parse_unit(unit).map_err(|e| wrong(s, "unit", format!("is {unit:?}, which cannot be read: {e}")))?;
        let mut out = Self::of(name, unit, LOG);
        let own = of_name(name);
        if let Some(expected) = own.and_then(|(quantity, ..)| dimension_of(quantity))
            && expected != dimension.dimension
        {
            let problem = format!("is {unit:?}; expected {}, which {name} is", expected.describe());
            return Err(wrong(s, "unit", problem));
        }
        let words = Words::read(s, Some(dimension.dimension), frames)?;
        words.set(&mut out);
        if let Some(sign) = s.number("sign")? {
            out.sign = match sign {
                1.0 => 1,
                -1.0 => -1,
                _ => return Err(wrong(s, "sign", format!("is {sign}; expected 1 or -1"))),
            };
        }
        match own {
            Some((.., expected)) if expected != out.sign => {
                let problem = format!("is {}; expected {expected}: the name {name} says it", out.sign);
                Err(wrong(s, "sign", problem))
            }
            _ => Ok((out, words)),
        }
    }
}

/// Dimension of a known quantity.
fn dimension_of(quantity: &str) -> Option<Dimension> {
    QUANTITIES.iter().find(|(known, _)| *known == quantity).map(|(_, dimension)| *dimension)
}

/// What an entry of a sidecar states about a channel beside its name, unit and sign.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Words {
    quantity: Option<String>,
    frame: Option<Along>,
    clock: Option<String>,
}

/// A frame as it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Along {
    Known(Frame),
    /// One of `[frames]`.
    Declared(String),
}

impl Words {
    /// Reads `quantity`, `frame` and `clock`; `dimension` is that of the channel's unit, where it has one, `frames` are those that are declared.
    pub fn read(s: &Section<'_>, dimension: Option<Dimension>, frames: &[&str]) -> Result<Self, RecordError> {
        let quantity = s.text("quantity")?;
        if let Some(word) = quantity {
            let advice = meant(word, QUANTITIES.iter().map(|(known, _)| *known));
            let problem = match (dimension_of(word), dimension, advice) {
                (Some(own), Some(found), _) if own != found => {
                    Some(format!("is {word:?}, {}; expected {}, as its unit says", own.describe(), found.describe()))
                }
                (None, _, Some(advice)) => Some(format!("is {word:?}; {advice}")),
                _ => None,
            };
            if let Some(problem) = problem {
                return Err(wrong(s, "quantity", problem));
            }
        }
        let frame = s.text("frame")?.map(|word| {
            let known = Frame::ALL.into_iter().find(|frame| frame.name() == word).map(Along::Known);
            let declared = || frames.contains(&word).then(|| Along::Declared(word.to_owned()));
            known.or_else(declared).ok_or_else(|| {
                let all = Frame::NAMES.into_iter().chain(frames.iter().copied());
                wrong(s, "frame", format!("is {word:?}; {}", suggestion(word, all)))
            })
        });
        let frame = frame.transpose()?;
        Ok(Self { quantity: quantity.map(str::to_owned), frame, clock: s.text("clock")?.map(str::to_owned) })
    }

    /// The declared frame that the channel is along, where it is along one.
    pub fn declared_frame(&self) -> Option<&str> {
        match &self.frame {
            Some(Along::Declared(name)) => Some(name),
            _ => None,
        }
    }

    /// Puts what is declared in the place of what was assumed.
    pub fn set(&self, meaning: &mut Meaning) {
        if let Some(quantity) = &self.quantity {
            meaning.quantity.clone_from(quantity);
        }
        match &self.frame {
            Some(Along::Known(frame)) => meaning.frame = *frame,
            // Until it is turned.
            Some(Along::Declared(_)) => meaning.frame = Frame::Sensor,
            None => {}
        }
        if let Some(clock) = &self.clock {
            meaning.clock.clone_from(clock);
        }
    }
}

fn wrong(s: &Section<'_>, key: &'static str, problem: String) -> RecordError {
    let place = s.get(key).map_or_else(|| s.place(), |value: &Spanned<DeValue<'_>>| s.source.place(value.span().start));
    RecordError::value(place, key, problem)
}
