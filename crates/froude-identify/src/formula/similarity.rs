//! Numbers of similarity that a formula may name: `Re = |U| L/ν` and `Fr = |U|/√(g L)`.
//!
//! U is the column `speed`, L the constant or column `L` (the campaign's `reference_length`), ν the water's kinematic viscosity, g standard
//! gravity where no `g` is given.

use froude_hydro::similarity::GRAVITY_M_S2;

use super::error::FormulaError;
use super::program::{Binary, Function, Op};
use super::unit::{Dim, Unit};

/// A number of similarity.
#[derive(Debug, Clone, Copy)]
pub(super) enum Number {
    Reynolds,
    Froude,
}

/// A quantity that it is made of.
pub(super) struct Quantity {
    /// The names that it may have, the first one first.
    pub names: &'static [&'static str],
    dim: Dim,
    /// Its value where it has none of the names.
    usual: Option<f64>,
    /// What to declare, where it has no usual value.
    missing: &'static str,
}

const SPEED: Quantity =
    Quantity { names: &["speed"], dim: [1, 0, -1, 0, 0], usual: None, missing: "the column speed, or v_x and v_y" };
const LENGTH: Quantity = Quantity {
    names: &["L"],
    dim: [1, 0, 0, 0, 0],
    usual: None,
    missing: "L: reference_length in [body], or L in [constants]",
};
const VISCOSITY: Quantity = Quantity {
    names: &["nu", "kinematic_viscosity"],
    dim: [2, 0, -1, 0, 0],
    usual: None,
    missing: "the water's viscosity: temperature or kinematic_viscosity, in [fluid] or as a column",
};
const GRAVITY: Quantity =
    Quantity { names: &["g"], dim: [1, 0, -2, 0, 0], usual: Some(GRAVITY_M_S2), missing: "g in [constants]" };

impl Number {
    /// The number of this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        [Self::Reynolds, Self::Froude].into_iter().find(|number| number.name() == name)
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Reynolds => "Re",
            Self::Froude => "Fr",
        }
    }

    /// What it is made of: speed, length, and viscosity or gravity.
    pub(super) const fn quantities(self) -> [Quantity; 3] {
        match self {
            Self::Reynolds => [SPEED, LENGTH, VISCOSITY],
            Self::Froude => [SPEED, LENGTH, GRAVITY],
        }
    }

    /// What gives one of its quantities; `found` is the column or constant of one of the names, with its dimension.
    ///
    /// # Errors
    ///
    /// Nothing was found, or something else.
    pub(super) fn quantity(self, of: &Quantity, found: Option<(Op, Dim)>) -> Result<Op, FormulaError> {
        let name = of.names.first().copied().unwrap_or_default();
        match (found, of.usual) {
            (Some((op, dim)), _) if dim == of.dim => Ok(op),
            (Some((_, dim)), _) => {
                let [found, expected] = [dim, of.dim].map(Unit::of);
                Err(FormulaError(format!("{} needs {name} in {expected}, and it is in {found}", self.name())))
            }
            (None, Some(usual)) => Ok(Op::Number(usual)),
            (None, None) => Err(FormulaError(format!("{} needs {}; it is not declared", self.name(), of.missing))),
        }
    }

    /// What computes it a row, from its quantities.
    pub(super) fn program(self, [speed, length, third]: [Op; 3]) -> Vec<Op> {
        let [times, over] = [Binary::Multiply, Binary::Divide].map(Op::Binary);
        let [abs, sqrt] = [Function::Abs, Function::Sqrt].map(Op::Function);
        match self {
            Self::Reynolds => vec![speed, abs, length, times, third, over],
            Self::Froude => vec![speed, abs, third, length, times, sqrt, over],
        }
    }
}
