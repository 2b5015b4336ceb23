//! What a run of the twin is done with, and what is logged of it.

use froude_records::campaign::SensorSpec;
use froude_rig::steady::{self, Reading};

use super::settings::{Plan, loads_at};
use crate::sensors::reading;
use crate::twin::{Draws, seed_of};

/// Loads of the true law on a body at the angle of a run.
#[derive(Debug, Clone, Copy)]
pub struct Loads<'a> {
    pub(super) plan: &'a Plan,
    pub(super) row: usize,
    pub(super) angle_rad: f64,
}

impl Loads<'_> {
    /// All loads at a speed, N, in the order of [`Self::names`].
    #[must_use]
    pub fn at(&self, speed_m_s: f64) -> Vec<f64> {
        loads_at(self.plan, self.row, speed_m_s, self.angle_rad)
    }

    /// One of them; zero of one that the law does not have.
    #[must_use]
    pub fn of(&self, name: &str, speed_m_s: f64) -> f64 {
        self.names().iter().position(|own| own == name).map_or(0.0, |k| self.at(speed_m_s)[k])
    }

    /// The true angle of the body, rad.
    #[must_use]
    pub const fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Their names.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.plan.law.responses
    }
}

/// What a run of the twin is done with.
#[derive(Debug)]
pub struct Rig<'a> {
    /// True values of the constants.
    pub constants: &'a [f64],
    /// The speed that it is observed at by the declared constants, m/s.
    pub speed_m_s: f64,
    /// Loads of the water on the body at its true angle.
    pub loads: Loads<'a>,
    /// Factor by which a log overstates the speed \[-\].
    pub stretch: f64,
    /// How each load is read.
    pub readings: Vec<Reading>,
    pub(crate) sensors: &'a [SensorSpec],
    pub(crate) draws: &'a mut Draws,
    pub(crate) seed: u64,
}

impl Rig<'_> {
    /// A log of channels that are no loads, as their sensors show them.
    #[must_use]
    pub fn log(&self, time_s: Vec<f64>, channels: &[(&str, Vec<f64>)]) -> Trace {
        let shown = |(k, (name, values)): (usize, &(&str, Vec<f64>))| {
            let reading = reading(self.sensors, &[name], 0.0, 1.0);
            ((*name).to_owned(), steady::read(&reading, &time_s, values, seed_of(self.seed, k)))
        };
        let columns = channels.iter().enumerate().map(shown).collect();
        Trace { time_s, columns }
    }
}

/// What is logged of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Channels by name, SI.
    pub columns: Vec<(String, Vec<f64>)>,
}
