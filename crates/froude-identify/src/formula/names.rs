//! What a name in a formula means.

use super::affine::Affine;
use super::error::FormulaError;
use super::part::Part;
use super::program::Op;
use super::similarity::Number;
use super::unit::Unit;
use crate::formula::limits::COEFFICIENT_LIMIT;
use crate::formula::unit::Dim;

/// Column name of an alias: `u v w p q r` of the motion, `rho nu` of the water.
#[must_use]
pub fn channel_of_alias(name: &str) -> Option<&'static str> {
    Some(match name {
        "u" => "v_x",
        "v" => "v_y",
        "w" => "v_z",
        "p" => "w_x",
        "q" => "w_y",
        "r" => "w_z",
        "rho" => "density",
        "nu" => "kinematic_viscosity",
        _ => return None,
    })
}

/// Column name of a load, itself or by its alias: `X Y Z K M N`.
#[must_use]
pub fn load_column(name: &str) -> Option<&'static str> {
    Some(match name {
        "X" | "f_x" => "f_x",
        "Y" | "f_y" => "f_y",
        "Z" | "f_z" => "f_z",
        "K" | "m_x" => "m_x",
        "M" | "m_y" => "m_y",
        "N" | "m_z" => "m_z",
        _ => return None,
    })
}

/// The column behind `u v w p q r rho nu` and `X Y Z K M N`; any other name is itself.
#[must_use]
pub fn aliased(name: &str) -> &str {
    channel_of_alias(name).or_else(|| load_column(name)).unwrap_or(name)
}

/// Names of columns that a table may have: never a coefficient by oversight. SNAME's angles are among them, which no column of Froude's has.
fn is_column_name(name: &str) -> bool {
    let base = name.strip_suffix("_dot").unwrap_or(name);
    matches!(
        base,
        "v_x"
            | "v_y"
            | "v_z"
            | "w_x"
            | "w_y"
            | "w_z"
            | "speed"
            | "angle"
            | "temperature"
            | "n_links"
            | "density"
            | "kinematic_viscosity"
            | "repeat"
            | "configuration"
            | "phi"
            | "theta"
            | "psi"
    ) || base.starts_with("std_")
}

/// The names of a formula with what they stand for.
pub(super) struct Resolved<'a> {
    /// The value of each name, in their order.
    pub values: Vec<Affine>,
    /// Columns that are read, in order of first appearance.
    pub columns: Vec<String>,
    /// The names that are coefficients, in order of first appearance.
    pub coefficients: Vec<&'a str>,
    /// The known numbers that are read.
    pub constants: Vec<Constant>,
}

/// A known number by name, SI, with its dimension.
pub type Constant = (String, f64, Dim);

/// What names may stand for: columns of the table with their dimensions, and known numbers.
pub(super) struct Known<'k> {
    pub channels: &'k dyn Fn(&str) -> Option<Dim>,
    pub constants: &'k [Constant],
    /// Names that are coefficients whatever else they may stand for.
    pub is_coefficient: &'k dyn Fn(&str) -> bool,
}

/// Finds what each of `names` is; they are in order of first appearance, each once.
///
/// # Errors
///
/// A name that could be meant otherwise, a constant that is not finite, too many coefficients.
pub(super) fn resolve<'a>(names: &[&'a str], known: &Known<'_>) -> Result<Resolved<'a>, FormulaError> {
    let mut out = Resolved {
        values: Vec::with_capacity(names.len()),
        columns: Vec::new(),
        coefficients: Vec::new(),
        constants: Vec::new(),
    };
    for name in names {
        let value = out.value_of(name, known)?;
        out.values.push(value);
    }
    if out.coefficients.len() > COEFFICIENT_LIMIT {
        let count = out.coefficients.len();
        let problem = format!("the formula has {count} coefficients; at most {COEFFICIENT_LIMIT} are read");
        return Err(FormulaError(problem));
    }
    Ok(out)
}

impl<'a> Resolved<'a> {
    fn value_of(&mut self, name: &'a str, known: &Known<'_>) -> Result<Affine, FormulaError> {
        let Known { channels, is_coefficient, .. } = known;
        if let Some((op, dim)) = self.constant(name, known)? {
            return Ok(Affine::known_as(name, op, Unit::of(dim)));
        }
        if name == "pi" {
            return Ok(Affine::known_as(name, Op::Number(std::f64::consts::PI), Unit::ONE));
        }
        let load = load_column(name);
        // A column of the table hides a letter, never the other way round; a load itself is what the formula gives.
        let own = channels(name).filter(|_| load != Some(name));
        if load.is_some() && own.is_none() && is_coefficient(name) {
            self.coefficients.push(name);
            return Ok(Affine::coefficient(name));
        }
        if load.is_some() && own.is_none() {
            return Err(FormulaError(format!(
                "{name} is the name of a load and cannot stand in a formula; give a coefficient another name"
            )));
        }
        let of = |column: &'static str| channels(column).map(|dim| (column, dim));
        let aliased = channel_of_alias(name);
        if let Some((column, dim)) = own.map(|dim| (name, dim)).or_else(|| of(aliased?)) {
            return Ok(Affine::known_as(name, Op::Channel(self.index_of(column)), Unit::of(dim)));
        }
        if let Some(column) = aliased {
            let problem = format!("{name} stands for the column {column}, which the table does not have");
            return Err(FormulaError(problem));
        }
        if let Some(number) = Number::named(name) {
            return Ok(Affine::fixed(Part::named(name, self.similarity(number, known)?)));
        }
        if is_column_name(name) {
            let problem = format!("{name} is the name of a column, which the table does not have");
            return Err(FormulaError(problem));
        }
        self.coefficients.push(name);
        Ok(Affine::coefficient(name))
    }

    /// A known number, which is remembered as read.
    fn constant(&mut self, name: &str, known: &Known<'_>) -> Result<Option<(Op, Dim)>, FormulaError> {
        let Some(constant) = known.constants.iter().find(|(own, ..)| own == name) else { return Ok(None) };
        let &(_, value, dim) = constant;
        if !value.is_finite() {
            return Err(FormulaError::not_finite(name));
        }
        if !self.constants.contains(constant) {
            self.constants.push(constant.clone());
        }
        Ok(Some((Op::Number(value), dim)))
    }

    /// What computes a number of similarity.
    fn similarity(&mut self, number: Number, known: &Known<'_>) -> Result<Vec<Op>, FormulaError> {
        let mut ops = [Op::Number(f64::NAN); 3];
        for (op, quantity) in ops.iter_mut().zip(number.quantities()) {
            let mut found = None;
            for name in quantity.names {
                if found.is_none() {
                    found = self.constant(name, known)?;
                }
                if let (None, Some(dim)) = (found, (known.channels)(name)) {
                    found = Some((Op::Channel(self.index_of(name)), dim));
                }
            }
            *op = number.quantity(&quantity, found)?;
        }
        Ok(number.program(ops))
    }

    /// The place of a column among those that are read.
    fn index_of(&mut self, column: &str) -> usize {
        self.columns.iter().position(|known| known == column).unwrap_or_else(|| {
            self.columns.push(column.to_owned());
            self.columns.len() - 1
        })
    }
}
