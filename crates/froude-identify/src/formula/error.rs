//! What can be wrong with a formula, stated with the place or the part.

use crate::formula::limits::{COEFFICIENT_LIMIT, DEPTH_LIMIT, LENGTH_LIMIT};

/// Why a formula cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaError {
    /// Nothing but blanks.
    #[error("the formula is empty; write for example \"Y_v*v + Y_vav*v*abs(v)\"")]
    Empty,
    /// More characters than [`LENGTH_LIMIT`].
    #[error("the formula has {length} characters; at most {LENGTH_LIMIT} are read")]
    TooLong {
        /// How many it has.
        length: usize,
    },
    /// More parentheses open than [`DEPTH_LIMIT`].
    #[error("at character {position} more than {DEPTH_LIMIT} parentheses are open at once")]
    TooDeep {
        /// Counted from 1.
        position: usize,
    },
    /// A character that no formula has.
    #[error(
        "character {position} is {character:?}; a formula is made of names, numbers, \
         + - * / ^ and parentheses"
    )]
    Character {
        /// Counted from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// A number that is too large, or not one.
    #[error("{text:?} at character {position} is not a finite number")]
    Number {
        /// Counted from 1.
        position: usize,
        /// As written.
        text: String,
    },
    /// Something in a place where it cannot stand.
    #[error("at character {position} stands {found}, but {expected} is expected there")]
    Syntax {
        /// Counted from 1.
        position: usize,
        /// What stands there, in words or in quotes.
        found: String,
        /// What would be right.
        expected: &'static str,
    },
    /// `a^b^c`.
    #[error(
        "at character {position} a power is raised to a power; write (a^b)^c or a^(b^c) to say \
         which is meant"
    )]
    PowerOfPower {
        /// Counted from 1.
        position: usize,
    },
    /// A name before a parenthesis that is no function.
    #[error(
        "{name} at character {position} is not a function; known are abs, sqrt, sin, cos, tan, \
         exp, ln and sign; a product is written {name}*(…)"
    )]
    UnknownFunction {
        /// Counted from 1.
        position: usize,
        /// The name.
        name: String,
    },
    /// The name of a column that the table does not have.
    #[error("{name} is the name of a column, which the table does not have")]
    MissingColumn {
        /// The name.
        name: String,
    },
    /// An alias of a column that the table does not have.
    #[error("{name} stands for the column {column}, which the table does not have")]
    MissingAlias {
        /// As written.
        name: String,
        /// The column's name.
        column: String,
    },
    /// A load on the right side.
    #[error("{name} is the name of a load and cannot stand in a formula; give a coefficient another name")]
    LoadName {
        /// The name.
        name: String,
    },
    /// Coefficients multiplied, or inside a function.
    #[error("the formula is not linear in its coefficients: {term}")]
    NotLinear {
        /// The offending part.
        term: String,
    },
    /// A term without a coefficient.
    #[error(
        "the part {part} has no coefficient; give it one, and fix its value in [identify.fixed] \
         if it is known"
    )]
    FixedPart {
        /// The part.
        part: String,
    },
    /// No coefficient at all.
    #[error("the formula has no coefficient: every name in it is a channel or a constant")]
    NoCoefficient,
    /// More coefficients than [`COEFFICIENT_LIMIT`].
    #[error("the formula has {count} coefficients; at most {COEFFICIENT_LIMIT} are read")]
    TooManyCoefficients {
        /// How many it has.
        count: usize,
    },
    /// A sum of unlike quantities.
    #[error("{left} is {left_unit} and {right} is {right_unit}: they cannot be added")]
    UnlikeSum {
        /// First part.
        left: String,
        /// Its unit.
        left_unit: String,
        /// Second part.
        right: String,
        /// Its unit.
        right_unit: String,
    },
    /// One coefficient beside two units.
    #[error(
        "the coefficient {coefficient} stands beside {first} in one term and beside {second} in \
         another; give the two terms different names"
    )]
    CoefficientUnits {
        /// Its name.
        coefficient: String,
        /// Unit of the first regressor.
        first: String,
        /// Unit of the second.
        second: String,
    },
    /// A function of a quantity with a unit.
    #[error("{function}({argument}) needs a pure number, but {argument} is {unit}")]
    DimensionalArgument {
        /// The function.
        function: &'static str,
        /// Its argument.
        argument: String,
        /// The argument's unit.
        unit: String,
    },
    /// An exponent with a unit, or one that varies under a base with a unit.
    #[error("the exponent {exponent} of {base} {reason}")]
    Exponent {
        /// The exponent.
        exponent: String,
        /// The base.
        base: String,
        /// What is wrong.
        reason: String,
    },
    /// The unit of a coefficient would have a fractional power, or a huge one.
    #[error(
        "the coefficient {coefficient} would have the unit {unit}; only whole powers up to 127 \
         can be recorded"
    )]
    CoefficientUnit {
        /// Its name.
        coefficient: String,
        /// The unit it would have.
        unit: String,
    },
    /// A constant part that cannot be computed.
    #[error("{part} is not a finite number")]
    NotFinite {
        /// The part.
        part: String,
    },
    /// A coefficient times zero.
    #[error("the coefficient {coefficient} is multiplied by zero")]
    ZeroRegressor {
        /// Its name.
        coefficient: String,
    },
}
