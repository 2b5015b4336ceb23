//! Force laws as a person writes them: `f_y = "Y_v*v + Y_vav*v*abs(v)"`.
//!
//! A text becomes tokens, these an expression, and the expression is computed over
//! values that are affine in the coefficients: each carries, per coefficient, the
//! program that computes its regressor and the unit of that program. So reading a law
//! proves that it is linear in its coefficients, and finds the unit of each of them.
//!
//! **Names.** A constant given by name, `pi`, a column of the table, else an alias
//! (`u v w p q r` for `v_x v_y v_z w_x w_y w_z`, `rho nu` for the water's density and
//! kinematic viscosity), else `Re` or `Fr`; every other name is a coefficient, unless
//! it is the name of a load or of a column that the table could have had (`phi theta
//! psi` among them). A column of the table that is called like an alias or like the
//! letter of a load (`X Y Z K M N`) comes before it.
//! **Grammar.** `+ - * / ^`, parentheses, `abs sqrt sin cos tan exp ln sign CF_ITTC57`.
//! `-v^2` is `-(v^2)`, `a/b*c` is `(a/b)*c`; `a^b^c` is refused as ambiguous.
//! **Units.** SI dimensions; a coefficient has the load's unit over its regressor's.
//! An angle is a pure number.
//!
//! Not here: products of coefficients, terms without a coefficient (fix that
//! coefficient's value instead), fractional units of a coefficient.

mod affine;
mod error;
mod grammar;
mod limits;
mod names;
mod part;
mod program;
mod similarity;
#[cfg(test)]
mod tests;
mod token;
pub(crate) mod unit;

use program::{Op, run};
use unit::Unit;

pub use crate::formula::limits::{COEFFICIENT_LIMIT, DEPTH_LIMIT, LENGTH_LIMIT};
pub use crate::formula::unit::Dim;
pub use error::FormulaError;
pub use names::{Constant, aliased, channel_of_alias, load_column};

/// A law for one load, linear in its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// The load that it gives, by its column name: `f_x` … `m_z`.
    pub load: String,
    /// The text as written.
    pub text: String,
    /// Coefficients and their dimensions, in order of first appearance.
    pub coefficients: Vec<(String, Dim)>,
    /// Channels that it reads, by column name, in order of first appearance.
    pub channels: Vec<String>,
    /// The known numbers that it reads.
    pub constants: Vec<Constant>,
    /// Whether one of the coefficients is an offset: its regressor reads no channel.
    pub offset: bool,
    /// A program per coefficient.
    programs: Vec<Vec<Op>>,
}

impl Formula {
    /// Reads a formula for `load` (column name or alias).
    ///
    /// `channels` gives the dimension of a column of the table, `None` where there is
    /// none; `load_dim` is the load's; `constants` are known numbers in SI by name, and
    /// come before channels of the same name.
    ///
    /// # Errors
    ///
    /// [`FormulaError`]: bad text, not linear, unlike units, nothing to find.
    ///
    /// # Example
    ///
    /// ```
    /// use froude_identify::formula::Formula;
    /// let speed = [1, 0, -1, 0, 0];
    /// let newton = [1, 1, -2, 0, 0];
    /// let columns = |name: &str| (name == "v_y").then_some(speed);
    /// let sway = Formula::parse("Y", "Y_v*v + Y_vav*v*abs(v)", &columns, newton, &[])?;
    /// assert_eq!(sway.channels, ["v_y"]);
    /// assert_eq!(sway.coefficients[1], ("Y_vav".to_owned(), [-1, 1, 0, 0, 0])); // kg/m
    /// let mut row = [0.0; 2];
    /// sway.regressor(&[-0.5], &mut row);
    /// assert_eq!(row, [-0.5, -0.25]);
    /// # Ok::<(), froude_identify::formula::FormulaError>(())
    /// ```
    pub fn parse(
        load: &str,
        text: &str,
        channels: &dyn Fn(&str) -> Option<Dim>,
        load_dim: Dim,
        constants: &[Constant],
    ) -> Result<Self, FormulaError> {
        Self::with_coefficients(load, text, channels, load_dim, constants, &|_| false)
    }

    /// The same where some names are coefficients whatever else they may stand for: those of a record, as the mass M of an axis.
    ///
    /// # Errors
    ///
    /// As [`Self::parse`].
    pub fn with_coefficients(
        load: &str,
        text: &str,
        channels: &dyn Fn(&str) -> Option<Dim>,
        load_dim: Dim,
        constants: &[Constant],
        is_coefficient: &dyn Fn(&str) -> bool,
    ) -> Result<Self, FormulaError> {
        let tokens = token::tokens(text)?;
        let (expression, names) = grammar::expression(&tokens)?;
        let known = names::Known { channels, constants, is_coefficient };
        let names::Resolved { values, columns, coefficients, constants } = names::resolve(&names, &known)?;
        let affine = expression.value(&values)?;

        if affine.parts.is_empty() {
            let problem = "the formula has no coefficient: every name in it is a channel or a constant";
            return Err(FormulaError(problem.to_owned()));
        }
        if let Some(part) = affine.fixed.as_ref().filter(|part| !part.is_zero()) {
            return Err(FormulaError(format!(
                "the part {} has no coefficient; give it one, and fix its value in [identify.fixed] if it is known",
                part.text
            )));
        }
        let mut out = Self {
            load: load_column(load).unwrap_or(load).to_owned(),
            text: text.to_owned(),
            coefficients: Vec::new(),
            channels: columns,
            constants,
            offset: false,
            programs: Vec::new(),
        };
        for name in coefficients {
            let own = affine.parts.iter().find(|(known, part)| known == name && !part.is_zero());
            let Some((_, part)) = own else {
                return Err(FormulaError(format!("the coefficient {name} is multiplied by zero")));
            };
            let unit = Unit::of(load_dim).over(part.unit);
            let dim = unit.whole().ok_or_else(|| {
                FormulaError(format!(
                    "the coefficient {name} would have the unit {unit}; only whole powers up to 127 can be recorded"
                ))
            })?;
            out.offset |= !part.program.iter().any(|op| matches!(op, Op::Channel(_)));
            out.coefficients.push((name.to_owned(), dim));
            out.programs.push(part.program.clone());
        }
        Ok(out)
    }

    /// What a unit of each coefficient adds to the load, SI.
    ///
    /// `values` are the channels in the order of [`Formula::channels`], SI; `out[j]`
    /// belongs to `coefficients[j]`. A channel without a value counts as NaN; of `out`
    /// as many are written as it holds. A regressor outside a function's domain
    /// (`sqrt`, `ln` of a negative number) is NaN.
    ///
    /// For f = Σ β_j x_j, `out[j]` is x_j = ∂f/∂β_j, in SI units of the load over those of coefficient j.
    pub fn regressor(&self, values: &[f64], out: &mut [f64]) {
        let mut stack = Vec::with_capacity(16);
        for (value, program) in out.iter_mut().zip(&self.programs) {
            *value = run(program, values, &mut stack);
        }
    }
}
