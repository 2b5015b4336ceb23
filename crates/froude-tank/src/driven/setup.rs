//! Everything that a campaign declares of a method with a motor-driven body, with one law.

use froude_fit::budget::Uncertain;

use super::spec::{Constant, Enters, Point};
use super::still_run::{StillFit, Zeroing};
use crate::error::TankError;
use crate::motion::Cycles;

/// What is declared, with one law.
#[derive(Debug, Clone)]
pub struct Setup<M> {
    /// The method with its law.
    pub method: M,
    /// Its constants.
    pub constants: Vec<Constant>,
    /// Which cycles are used.
    pub cycles: Cycles,
    /// Harmonics of the motion.
    pub harmonics: usize,
    /// How the cell was zeroed for still runs, where that is declared.
    pub zeroing: Option<Zeroing>,
    /// Constants from still runs.
    pub still_fits: Vec<StillFit>,
}

impl<M> Setup<M> {
    /// A constant by its name.
    #[must_use]
    pub fn constant(&self, name: &str) -> Option<&Constant> {
        self.constants.iter().find(|c| c.name == name)
    }

    /// What is known of it.
    #[must_use]
    pub fn known(&self, name: &str) -> Option<Uncertain> {
        self.constant(name)?.known
    }

    /// The constant that enters so.
    pub(super) fn enters(&self, is: impl Fn(Enters) -> bool) -> Option<usize> {
        self.constants.iter().position(|c| is(c.enters))
    }

    /// Values of the constants where nothing is drawn or stated.
    pub(super) fn values(&self) -> Vec<f64> {
        self.constants.iter().map(|c| c.known.map_or_else(|| c.otherwise.unwrap_or(0.0), |known| known.value)).collect()
    }

    /// Refuses runs that need a constant which is neither declared nor found by them.
    pub(super) fn check(&self, points: &[&Point]) -> Result<(), TankError> {
        let lacks = |c: &&Constant| {
            let points = || points.iter().copied();
            c.known.is_none() && c.otherwise.is_err() && c.matters(points()) && c.looked_for(points()).is_none()
        };
        match self.constants.iter().find(lacks).map(|c| c.otherwise) {
            Some(Err(advice)) => Err(TankError::new(advice)),
            _ => Ok(()),
        }
    }
}
