//! A run as it was reduced.

use super::spec::{Moves, Point};
use crate::steady::point::Point as Observation;
use crate::steady::row::Row;

/// A run as it was reduced.
#[derive(Debug, Clone)]
pub struct Reduced<F> {
    /// What it is.
    pub point: Point,
    /// Its observation.
    pub observation: Observation,
    /// What the method found beside it.
    pub found: F,
    /// What each of the errors that all runs share moves.
    pub moves: Vec<Moves>,
}

impl<F> Reduced<F> {
    /// The place of a load.
    pub(super) fn load(&self, name: &str) -> Option<usize> {
        self.observation.loads.iter().position(|load| load.name == name)
    }
}

impl<F> From<Reduced<F>> for Row {
    /// A run of the twin as the row of a table.
    fn from(run: Reduced<F>) -> Self {
        Self {
            angle_rad: run.point.condition("angle"),
            run: run.point.id,
            configuration: run.point.configuration,
            temperature_k: None,
            point: run.observation,
        }
    }
}

/// A planned run as its row of the plan sees it.
#[derive(Debug, Clone)]
pub struct Planned<'r, F> {
    /// As it would be reduced.
    pub run: &'r Reduced<F>,
    /// The speed that it would come to, m/s.
    pub speed_m_s: f64,
    /// Length of its log, s.
    pub duration_s: f64,
}
