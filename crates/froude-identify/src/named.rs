//! Laws by name: sets of terms that the literature uses, of which a table gets those whose loads and columns it has.
//!
//! A set is a table of data ([`crate::law::terms`]). Its terms become the formulas of an ordinary law, so that fit, choice, record and page are those of every law. A term whose load or column the table
//! lacks, or that is zero in every row, is left out, and a finding says so. What the rest of the table does not determine has no interval.
//!
//! Coefficients in SI become primes by their dimension alone: C' = C/(½ρ Lᵖ U^q), q being the inverse seconds in the unit of C beside kg, and p what makes it a pure number.
//!
//! Source of the primes: SNAME (1952), Technical and Research Bulletin 1-5.

mod inverse;

use froude_records::finding::{Finding, Severity};
use froude_records::units::{Dimension, parse_unit};
use indexmap::IndexMap;

use crate::dataset::{Dataset, LOADS};
use crate::error::IdentifyError;
use crate::formula::{Constant, Formula};
use crate::law::terms::{LAWS, NamedLaw, THRUSTER};
use crate::law::{CoefficientSpec, ForceLaw, exponents};
use crate::lint::motion::moving;
use crate::seam::reduced::Derived;

pub(crate) use inverse::commands;

/// Relative spread of the speed below which a table has one speed.
const ONE_SPEED: f64 = 0.02;

/// Columns that stand for one quantity, by any of their names.
const ALSO_CALLED: [(&str, &[&str]); 2] = [
    ("rudder", &["rudder", "rudder_angle", "delta", "delta_r"]),
    ("elevator", &["elevator", "stern_plane", "delta_s"]),
];

/// A term that a table lacks, and why.
struct LeftOut {
    coefficient: String,
    why: String,
}

impl NamedLaw {
    /// The set of this name.
    pub(crate) fn of_name(name: &str) -> Option<&'static Self> {
        LAWS.iter().find(|law| law.name == name)
    }

    /// The law over the columns of a table.
    ///
    /// # Errors
    ///
    /// A number that it needs and nobody declares, a column that may be two things, or no term at all.
    pub(crate) fn law(&'static self, data: &Dataset, constants: &[Constant]) -> Result<ForceLaw, IdentifyError> {
        if self.name == THRUSTER {
            return self.thruster(data);
        }
        let (texts, left_out) = self.terms(data, constants)?;
        if texts.is_empty() {
            return Err(self.refused(&format!("none of its terms is in the table: {}", listed(&left_out))));
        }
        let law = ForceLaw::with_constants(self.name, &texts, data, constants)?;
        Ok(ForceLaw { named: Some(self), ..law })
    }

    fn refused(&self, why: &str) -> IdentifyError {
        IdentifyError::Refused(format!("model {:?} ({}): {why}", self.name, self.words))
    }

    /// The formula of each load that the table has, and what is not in them.
    fn terms(
        &self,
        data: &Dataset,
        constants: &[Constant],
    ) -> Result<(IndexMap<String, String>, Vec<LeftOut>), IdentifyError> {
        let is_known = |name: &str| constants.iter().any(|(own, ..)| own == name);
        let missing: Vec<&str> = self.needs.iter().filter(|(name, _)| !is_known(name)).map(|(_, how)| *how).collect();
        if !missing.is_empty() {
            return Err(self.refused(&format!("a number is not declared; write {}", missing.join(" and "))));
        }
        let (mut texts, mut left_out): (IndexMap<String, String>, Vec<LeftOut>) = (IndexMap::new(), Vec::new());
        for (load, factor, terms) in self.loads {
            for term in terms.split(" + ") {
                let (coefficient, regressor) = term.split_once('*').unwrap_or((term, "1"));
                let regressor = self.with_columns(regressor, data)?;
                let factor = if factor.is_empty() { String::new() } else { format!("{factor}*") };
                let text = format!("{coefficient}*{factor}{regressor}");
                match lacks(load, &text, data, constants) {
                    Some(why) => left_out.push(LeftOut { coefficient: coefficient.to_owned(), why }),
                    None => {
                        let entry = texts.entry((*load).to_owned());
                        entry.and_modify(|own| *own = format!("{own} + {text}")).or_insert(text);
                    }
                }
            }
        }
        Ok((texts, left_out))
    }

    /// A regressor with the names that the table has for its columns.
    fn with_columns(&self, regressor: &str, data: &Dataset) -> Result<String, IdentifyError> {
        let mut out = regressor.to_owned();
        for (name, also) in ALSO_CALLED.iter().filter(|(name, _)| columns(regressor).contains(name)) {
            let there: Vec<&str> = also.iter().copied().filter(|column| data.values(column).is_some()).collect();
            match there.as_slice() {
                [] => {}
                [one] => out = replaced(&out, name, one),
                several => return Err(self.ambiguous(several, name)),
            }
        }
        if columns(regressor).contains(&"rotation_rate")
            && let Some(rate) = self.one_of(data, Dimension::ANGULAR_SPEED, "rate of rotation")?
        {
            out = replaced(&out, "rotation_rate", &rate);
        }
        Ok(out)
    }

    fn ambiguous(&self, several: &[&str], what: &str) -> IdentifyError {
        self.refused(&format!(
            "the columns {} may both be its {what}; keep only one of them in the table or the sidecar",
            several.join(" and ")
        ))
    }

    /// The only column of a kind that is no motion of the body.
    fn one_of(&self, data: &Dataset, dimension: Dimension, what: &str) -> Result<Option<String>, IdentifyError> {
        let is_motion = |name: &str| ["w_", "std_", "zero_"].iter().any(|prefix| name.starts_with(prefix));
        let of_kind = data.channels.iter().filter(|(name, c)| c.dimension == dimension && !is_motion(name));
        let found: Vec<&str> = of_kind.map(|(name, _)| name.as_str()).collect();
        match found.as_slice() {
            [] => Ok(None),
            [one] => Ok(Some((*one).to_owned())),
            several => Err(self.ambiguous(several, what)),
        }
    }

    /// A thruster over its command.
    fn thruster(&'static self, data: &Dataset) -> Result<ForceLaw, IdentifyError> {
        let loads = thruster_loads(data);
        let command = match self.command(data)? {
            Some(command) if !loads.is_empty() => command,
            _ => {
                return Err(self.refused(
                    "it needs a column thrust [N] or torque [N m] (or f_x, m_x), and one of the command, in V or rpm",
                ));
            }
        };
        let inflow = data.values("v_x").filter(|u| u.iter().any(|u| *u != 0.0)).map(|_| "v_x");
        let has = |side: f64| data.values(&command).is_some_and(|x| x.iter().any(|x| x * side > 0.0));
        let law = ForceLaw::thruster(data, &loads, (&command, inflow), [has(1.0), has(-1.0)]);
        Ok(ForceLaw { named: Some(self), ..law })
    }

    /// The column of the command: a voltage, or else a rate of rotation.
    fn command(&self, data: &Dataset) -> Result<Option<String>, IdentifyError> {
        let volts = self.one_of(data, Dimension::VOLTAGE, "command")?;
        let rate = self.one_of(data, Dimension::ANGULAR_SPEED, "command")?;
        match (volts, rate) {
            (Some(volts), Some(rate)) => Err(self.ambiguous(&[&volts, &rate], "command")),
            (volts, rate) => Ok(volts.or(rate)),
        }
    }
}

/// The loads that a thruster exerts: `thrust` and `torque`, or else f_x and m_x.
fn thruster_loads(data: &Dataset) -> Vec<&'static str> {
    let pairs = [["thrust", "f_x"], ["torque", "m_x"]];
    pairs.into_iter().filter_map(|names| names.into_iter().find(|name| data.values(name).is_some())).collect()
}

/// Whether a table is that of a thruster and of nothing else, so that its law needs no name.
pub(crate) fn is_thruster(data: &Dataset) -> bool {
    let has_own = ["thrust", "torque"].iter().any(|load| data.values(load).is_some());
    let law = NamedLaw::of_name(THRUSTER);
    data.loads().iter().all(|load| !data.is_of_water(load))
        && has_own
        && law.is_some_and(|law| !matches!(law.command(data), Ok(None)))
}

/// The laws by name that have a column in a load of the table.
pub(crate) fn having(column: &str, data: &Dataset) -> Vec<&'static str> {
    let reads = |law: &&NamedLaw| {
        law.loads.iter().any(|(load, _, terms)| data.values(load).is_some() && columns(terms).contains(&column))
    };
    LAWS.iter().filter(reads).map(|law| law.name).collect()
}

/// The names in a text that are columns: those that begin with a small letter, but for functions and constants.
fn columns(text: &str) -> Vec<&str> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
    let is_column = |word: &&str| {
        word.starts_with(|c: char| c.is_ascii_lowercase()) && !matches!(*word, "abs" | "sign" | "pi" | "d")
    };
    words.filter(is_column).collect()
}

/// A text with one name in the place of another.
fn replaced(text: &str, name: &str, by: &str) -> String {
    let mut out = String::new();
    let mut word = String::new();
    for c in text.chars().map(Some).chain([None]) {
        match c {
            Some(c) if c.is_ascii_alphanumeric() || c == '_' => word.push(c),
            other => {
                out += if word == name { by } else { &word };
                word.clear();
                out.extend(other);
            }
        }
    }
    out
}

/// Why a table has nothing of a term; `None` where it has.
fn lacks(load: &str, text: &str, data: &Dataset, constants: &[Constant]) -> Option<String> {
    let Some(dimension) = data.dimension(load) else { return Some(format!("no column {load}")) };
    let regressor = text.split_once('*').map_or(text, |(_, regressor)| regressor);
    let names = columns(regressor);
    if let Some(missing) = names.iter().find(|name| data.values(name).is_none()) {
        let how = if *missing == "density" { "; write [fluid] density = \"998 kg/m^3\"" } else { "" };
        return Some(format!("no column {missing}{how}"));
    }
    let channel = |name: &str| data.dimension(name).map(exponents);
    // What is wrong with the formula is said where the law is made.
    let formula = Formula::parse(load, text, &channel, exponents(dimension), constants).ok()?;
    let read: Vec<&[f64]> = formula.channels.iter().filter_map(|name| data.values(name)).collect();
    let mut row = [0.0];
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, x| most.max(x.abs()));
    let is_zero = |name: &&&str| {
        let speed = largest(&mut data.values("speed").unwrap_or_default().iter().copied());
        // cos 90° is 6e-17, which is no motion.
        let least = if name.starts_with("v_") && !name.ends_with("_dot") { 1e-9 * speed } else { 0.0 };
        largest(&mut data.values(name).unwrap_or_default().iter().copied()) <= least
    };
    if let Some(zero) = names.iter().find(is_zero) {
        return Some(format!("{zero} is zero in every row"));
    }
    let values = (0..data.rows).filter(|i| data.observes(load, *i)).map(|i| {
        formula.regressor(&read.iter().map(|values| values[i]).collect::<Vec<_>>(), &mut row);
        row[0]
    });
    (largest(&mut values.into_iter()) == 0.0).then(|| "zero in every row".to_owned())
}

/// Terms by the reason why they are left out.
fn listed(left_out: &[LeftOut]) -> String {
    let mut by_why: IndexMap<&str, Vec<&str>> = IndexMap::new();
    for term in left_out {
        by_why.entry(&term.why).or_default().push(&term.coefficient);
    }
    by_why.iter().map(|(why, names)| format!("{} ({why})", names.join(", "))).collect::<Vec<_>>().join("; ")
}

/// What a thruster has no coefficient for.
fn thruster_lacks(law: &ForceLaw) -> Vec<LeftOut> {
    let parts = [
        ("ahead", "no command above zero"),
        ("astern", "no command below zero"),
        ("inflow", "no column v_x, or zero in every row"),
    ];
    let is_there = |part: &str| law.coefficients.iter().any(|c| c.name.ends_with(part));
    let left_out = parts.into_iter().filter(|(part, _)| !is_there(part));
    left_out.map(|(part, why)| LeftOut { coefficient: part.to_owned(), why: why.to_owned() }).collect()
}

/// What each law by name is, and which of its terms are not in the table.
pub(crate) fn findings(laws: &[ForceLaw], data: &Dataset) -> Vec<Finding> {
    let of = |law: &ForceLaw| {
        let named = law.named?;
        let left_out =
            if named.name == THRUSTER { thruster_lacks(law) } else { named.terms(data, &law.constants()).ok()?.1 };
        let left_out = if left_out.is_empty() { String::new() } else { format!(" Left out: {}.", listed(&left_out)) };
        let text =
            format!("{}: {}. Source: {}. Range: {}.{left_out}", named.name, named.words, named.source, named.range);
        Some(Finding::new(Severity::Note, "named-law", text))
    };
    laws.iter().filter_map(of).collect()
}

/// The primes of a law's coefficients, where length and density are known; those that need a speed where the table has one alone.
pub(crate) fn primes(law: &ForceLaw, data: &Dataset, length_m: f64) -> (Vec<Derived>, Option<f64>) {
    let is_of_body = law.named.is_some() && law.responses.iter().all(|load| LOADS.contains(&load.as_str()));
    let Some(density) = data.values("density").filter(|_| is_of_body && law.named.is_some()) else {
        return (Vec::new(), None);
    };
    let density = density.iter().sum::<f64>() / density.len() as f64;
    let speed = one_speed(data);
    let of = |spec: &CoefficientSpec| {
        let Dimension { m, kg: 1, s, k: 0, a: 0 } = parse_unit(&spec.unit).ok()?.dimension else { return None };
        let (of_length, of_speed) = (i32::from(m) + 3 + i32::from(s), -i32::from(s));
        let speed = if of_speed == 0 { 1.0 } else { speed? };
        let power = |name: &str, n: i32| match n {
            0 => String::new(),
            1 => format!("*{name}"),
            n => format!("*{name}^{n}"),
        };
        Some(Derived {
            name: format!("{}_prime", spec.name),
            formula: format!("{}/(0.5*density{}{})", spec.name, power("length", of_length), power("speed", of_speed)),
            of: spec.name.clone(),
            factor: 1.0 / (0.5 * density * length_m.powi(of_length) * speed.powi(of_speed)),
            factor_relative: 0.0,
            unit: "1".to_owned(),
        })
    };
    let primes: Vec<Derived> = law.coefficients.iter().filter_map(of).collect();
    let needs_speed = primes.iter().any(|prime| prime.formula.contains("speed"));
    (primes, speed.filter(|_| needs_speed))
}

/// The speed of all rows that move, where it is one.
fn one_speed(data: &Dataset) -> Option<f64> {
    let speed = data.values("speed")?;
    let moving: Vec<f64> = moving(speed, 0.05).into_iter().map(|i| speed[i].abs()).collect();
    let [low, high] =
        moving.iter().fold([f64::INFINITY, 0.0], |[low, high], u| [f64::min(low, *u), f64::max(high, *u)]);
    (high > 0.0 && high - low <= ONE_SPEED * high).then(|| moving.iter().sum::<f64>() / moving.len() as f64)
}
