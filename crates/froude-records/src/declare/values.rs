//! The values of a section by its declared keys.

use crate::error::{Place, RecordError};
use crate::run::{Declared, declared_value};
use crate::section::{Section, Source, Value, found, parse};
use crate::section_values::{at_most, count, one_of, series};
use indexmap::IndexMap;

use crate::declare::by_configuration::ByConfiguration;
use crate::declare::frequency::angular;
use crate::declare::key::{IfMissing, Key, Kind, Range, names};

/// The values of a section, in SI, each with its place.
#[derive(Debug, Clone)]
pub struct Values {
    /// As messages call the section.
    label: String,
    place: Place,
    /// Of every key that is declared.
    all: IndexMap<&'static str, Option<Parsed>>,
    places: IndexMap<&'static str, Place>,
}

#[derive(Debug, Clone)]
enum Parsed {
    Number(f64),
    Constant(Declared),
    PerConfiguration(ByConfiguration),
    Numbers(Vec<f64>),
    Count(usize),
    Word(usize),
    Text(String),
    Texts(Vec<String>),
    Flag(bool),
    Table(Values),
    /// What the reader of the section reads.
    Unread,
}

impl Values {
    /// Reads a section that has these keys and no others.
    ///
    /// # Errors
    ///
    /// An unknown key with the nearest known one, a key that is missing, a value of another kind or outside of its range, with its place.
    pub fn read(s: &Section<'_>, keys: &'static [Key]) -> Result<Self, RecordError> {
        s.only(&names(keys))?;
        let mut out = Self { label: s.label(), place: s.place(), all: IndexMap::new(), places: IndexMap::new() };
        for key in keys {
            // A table of configurations that names none says nothing.
            let is_empty =
                |value: &&Value<'_>| value.get_ref().as_table().is_some_and(|table| table.iter().next().is_none());
            let is_missing = |value: &&Value<'_>| matches!(key.kind, Kind::PerConfiguration(_)) && is_empty(value);
            let key = &Key { kind: out.chosen(key.kind), ..*key };
            let parsed = match s.get(key.name).filter(|value| !is_missing(value)) {
                Some(value) => {
                    out.places.insert(key.name, s.source.place(value.span().start));
                    Some(parsed(s, key, value)?)
                }
                None => missing(s, key)?,
            };
            out.all.insert(key.name, parsed);
        }
        Ok(out)
    }

    /// The values where nobody writes the section.
    ///
    /// # Errors
    ///
    /// A key that has no default.
    pub fn defaults(section: &'static str, keys: &'static [Key]) -> Result<Self, RecordError> {
        let text = Source { path: std::path::Path::new(""), text: "" };
        let document = parse(text)?;
        Self::read(&Section::new(text, section, document.get_ref(), 0), keys)
    }

    /// The kind that an earlier key chooses.
    fn chosen(&self, kind: Kind) -> Kind {
        match kind {
            Kind::By(by, kinds) => self.word(by, kinds).unwrap_or(Kind::Any),
            other => other,
        }
    }

    /// The value of a declared key, as what its kind makes it; another key or kind is a mistake in the program.
    fn of<'a, T>(&'a self, key: &str, take: impl Fn(&'a Parsed) -> Option<T>) -> Option<T> {
        debug_assert!(self.all.contains_key(key), "{} declares no {key}", self.label);
        let parsed = self.all.get(key)?.as_ref()?;
        let taken = take(parsed);
        debug_assert!(taken.is_some(), "{key} of {} is of another kind: {parsed:?}", self.label);
        taken
    }

    /// A quantity, or a plain number.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        self.of(key, |parsed| if let Parsed::Number(x) = parsed { Some(*x) } else { None })
    }

    /// A constant.
    #[must_use]
    pub fn constant(&self, key: &str) -> Option<Declared> {
        self.of(key, |parsed| if let Parsed::Constant(x) = parsed { Some(*x) } else { None })
    }

    /// A constant of each configuration, or of all; empty if not declared.
    #[must_use]
    pub fn by_configuration(&self, key: &str) -> ByConfiguration {
        let found =
            self.of(key, |parsed| if let Parsed::PerConfiguration(x) = parsed { Some(x.clone()) } else { None });
        found.unwrap_or_default()
    }

    /// The numbers of an axis, or of frequencies; empty if not declared.
    #[must_use]
    pub fn numbers(&self, key: &str) -> Vec<f64> {
        self.of(key, |parsed| if let Parsed::Numbers(x) = parsed { Some(x.clone()) } else { None }).unwrap_or_default()
    }

    /// A count, or another whole number.
    #[must_use]
    pub fn count(&self, key: &str) -> Option<usize> {
        self.of(key, |parsed| if let Parsed::Count(n) = parsed { Some(*n) } else { None })
    }

    /// What a word stands for: `meant` has a value for each word of its kind.
    #[must_use]
    pub fn word<T: Copy>(&self, key: &str, meant: &[T]) -> Option<T> {
        self.of(key, |parsed| if let Parsed::Word(i) = parsed { meant.get(*i).copied() } else { None })
    }

    /// A text.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.of(key, |parsed| if let Parsed::Text(x) = parsed { Some(x.as_str()) } else { None })
    }

    /// True or false; false if not declared.
    #[must_use]
    pub fn flag(&self, key: &str) -> bool {
        self.of(key, |parsed| if let Parsed::Flag(x) = parsed { Some(*x) } else { None }).unwrap_or_default()
    }

    /// Texts; empty if not declared.
    #[must_use]
    pub fn texts(&self, key: &str) -> &[String] {
        self.of(key, |parsed| if let Parsed::Texts(x) = parsed { Some(x.as_slice()) } else { None }).unwrap_or_default()
    }

    /// A table.
    #[must_use]
    pub fn table(&self, key: &str) -> Option<&Self> {
        self.of(key, |parsed| if let Parsed::Table(x) = parsed { Some(x) } else { None })
    }

    /// Whether the section has a key, rather than its default.
    #[must_use]
    pub fn is_stated(&self, key: &str) -> bool {
        self.places.contains_key(key)
    }

    /// What a required key or one with a default has, which [`Self::read`] has seen to.
    ///
    /// # Errors
    ///
    /// Nothing was found: the program asks for a key that its section does not declare so.
    pub fn need<T>(&self, key: &str, found: Option<T>) -> Result<T, RecordError> {
        found.ok_or_else(|| self.missing(key, "the method needs it"))
    }

    /// The error of a key that contradicts another one, at its value.
    #[must_use]
    pub fn wrong(&self, key: &str, problem: impl Into<String>) -> RecordError {
        RecordError::value(self.places.get(key).unwrap_or(&self.place).clone(), key, problem)
    }

    /// The error of a key that another one requires; `advice` is what to write.
    #[must_use]
    pub fn missing(&self, key: &str, advice: &str) -> RecordError {
        RecordError::syntax(self.place.clone(), format!("{} has no `{key}`; {advice}", self.label))
    }

    /// The factors of a run matrix, in the order of the keys: texts, axes and `repeats`, each with its number.
    fn factors(&self) -> Vec<(&'static str, usize)> {
        let number = |(key, parsed): (&&'static str, &Option<Parsed>)| match parsed {
            Some(Parsed::Texts(texts)) if !texts.is_empty() => Some((*key, texts.len())),
            Some(Parsed::Numbers(numbers)) => Some((*key, numbers.len())),
            Some(Parsed::Count(n)) if *key == "repeats" => Some((*key, *n)),
            _ => None,
        };
        self.all.iter().filter_map(number).collect()
    }

    /// Checks the number of runs of the matrix.
    ///
    /// # Errors
    ///
    /// The product of the factors exceeds `most`.
    pub fn at_most(&self, most: usize) -> Result<(), RecordError> {
        at_most(&self.place, &self.factors(), most)
    }
}

/// What holds where a key is missing: a default is read as if it were written.
fn missing(s: &Section<'_>, key: &Key) -> Result<Option<Parsed>, RecordError> {
    let default = match key.default {
        IfMissing::Required(advice) => return Err(s.missing(key.name, advice)),
        IfMissing::Nothing(_) => return Ok(None),
        IfMissing::Is(text) => text,
    };
    let text =
        if key.kind.is_bare() { format!("{} = {default}", key.name) } else { format!("{} = {default:?}", key.name) };
    let source = Source { path: s.source.path, text: &text };
    let document = parse(source)?;
    let written = Section::new(source, &s.name, document.get_ref(), 0);
    written.get(key.name).map(|value| parsed(&written, key, value)).transpose()
}

fn parsed<'a>(s: &Section<'a>, key: &Key, value: &'a Value<'a>) -> Result<Parsed, RecordError> {
    let name = key.name;
    // A number that is out of range is shown where it stands: an item of a list, a configuration of a table.
    let shown = |at: &Value<'_>, si: f64| if at.get_ref().is_table() { format!("{si} in SI") } else { found(at) };
    let within = |at: &Value<'_>, si: f64, all: &str| match key.range {
        Range::Positive if si.is_nan() || si <= 0.0 => {
            Err(s.wrong(name, at, format!("is {}; {all} must be larger than zero", shown(at, si))))
        }
        Range::NotNegative(why) if si < 0.0 => Err(s.wrong(name, at, format!("is negative; {why}"))),
        Range::Between(low, high) if !(low..=high).contains(&si) => {
            Err(s.wrong(name, at, format!("is {}; expected a number from {low} to {high}", shown(at, si))))
        }
        Range::Part(what) if !(si > 0.0 && si < 1.0) => {
            Err(s.wrong(name, at, format!("is {}; {what} lies between 0 and 100 %", shown(at, si))))
        }
        Range::NotZero(why) if si == 0.0 => Err(s.wrong(name, at, format!("is zero; {why}"))),
        _ => Ok(()),
    };
    let numbers = |of_axis: Vec<f64>| {
        let items = value.get_ref().as_array();
        let each = |(i, si): (usize, &f64)| match items.and_then(|items| items.get(i)) {
            Some(item) => within(item, *si, "it"),
            None => within(value, *si, "all"),
        };
        of_axis.iter().enumerate().try_for_each(each)?;
        Ok::<_, RecordError>(Parsed::Numbers(of_axis))
    };
    Ok(match key.kind {
        Kind::Number => {
            let x = s.as_number(name, value)?;
            within(value, x, "it")?;
            Parsed::Number(x)
        }
        Kind::Quantity(dimension) => {
            let si = s.as_quantity_of(name, value, dimension)?;
            within(value, si, "it")?;
            Parsed::Number(si)
        }
        Kind::Constant(dimension) => {
            let constant = declared_value(s, name, value, dimension)?;
            within(value, constant.value, "it")?;
            Parsed::Constant(constant)
        }
        Kind::PerConfiguration(dimension) => {
            let constants = ByConfiguration::read(s, name, value, dimension)?;
            constants.all.iter().try_for_each(|all| within(value, all.value, "it"))?;
            let entries = value.get_ref().as_table().into_iter().flat_map(|table| table.iter());
            for (configuration, at) in entries {
                let own = constants.named.get(configuration.get_ref().as_ref());
                own.map_or(Ok(()), |own| within(at, own.value, "it"))?;
            }
            Parsed::PerConfiguration(constants)
        }
        Kind::Axis(dimension) => numbers(series(s, name, value, dimension)?)?,
        Kind::Frequency => numbers(angular(s, name, value)?)?,
        Kind::Count(most) => Parsed::Count(count(s, name, most)?.unwrap_or_default()),
        Kind::Whole => Parsed::Count(s.integer(name)?.unwrap_or_default() as usize),
        Kind::Word(words) => {
            let indices: Vec<usize> = (0..words.len()).collect();
            Parsed::Word(one_of(s, name, words, &indices)?.unwrap_or_default())
        }
        Kind::Text => Parsed::Text(s.as_text(name, value)?.to_owned()),
        Kind::Texts => Parsed::Texts(s.texts(name)?),
        Kind::Flag => Parsed::Flag(s.flag(name)?.unwrap_or_default()),
        Kind::Table(keys) => Parsed::Table(Values::read(&s.as_section(name, value)?, keys)?),
        Kind::AnyQuantity
        | Kind::By(..)
        | Kind::Coefficient
        | Kind::Named(..)
        | Kind::List(_)
        | Kind::Either(_)
        | Kind::Any => Parsed::Unread,
    })
}
