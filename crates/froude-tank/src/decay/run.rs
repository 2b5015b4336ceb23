//! What a decay test gives: releases over time, and what is declared about body and springs.

use froude_fit::budget::Uncertain;
use froude_records::campaign::Motion;

use super::error::DecayError;

/// One release: columns of one length, time in even steps.
#[derive(Debug, Clone, Copy)]
pub struct DecayRun<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Position, m or rad; its zero is free.
    pub position: &'a [f64],
}

/// Part of a step by which a time stamp may be off the even clock: stamps printed in milliseconds at 50 a second are
/// off by 2.5 %.
const EVEN: f64 = 0.05;

impl DecayRun<'_> {
    /// Mean step of time, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let n = self.time_s.len();
        if n < 2 { f64::NAN } else { (self.time_s[n - 1] - self.time_s[0]) / (n - 1) as f64 }
    }

    /// The run is what [`DecayRun`] says.
    pub(super) fn check(&self) -> Result<(), DecayError> {
        let run = || self.id.to_owned();
        let (n, found) = (self.time_s.len(), self.position.len());
        if n != found {
            return Err(DecayError::Length { run: run(), found, expected: n });
        }
        for (column, values) in [("time", self.time_s), ("position", self.position)] {
            if let Some(index) = values.iter().position(|x| !x.is_finite()) {
                return Err(DecayError::NotFinite { run: run(), column, index });
            }
        }
        let step_s = self.step_s();
        let late = |i: usize| self.time_s[i] - self.time_s[0] - i as f64 * step_s;
        let worst = (0..n).max_by(|&a, &b| late(a).abs().total_cmp(&late(b).abs()));
        if let Some(index) = worst.filter(|&i| step_s.is_nan() || step_s <= 0.0 || late(i).abs() > EVEN * step_s) {
            return Err(DecayError::UnevenTime { run: run(), index, late_s: late(index), step_s });
        }
        Ok(())
    }
}

/// Which part of a release is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayWindow {
    /// The motion is free from here on, s of the run's clock. `None`: from its first passage through rest, so that the
    /// hand and the first swing are left out.
    pub free_from_s: Option<f64>,
    /// Half cycles left out after that: the water needs some to forget that it was at rest.
    pub skip_half_cycles: usize,
    /// A swing counts while its amplitude is above this many standard deviations of a sample's noise.
    pub smallest_over_noise: f64,
}

impl Default for DecayWindow {
    fn default() -> Self {
        Self { free_from_s: None, skip_half_cycles: 0, smallest_over_noise: 5.0 }
    }
}

/// What is declared about body and springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecaySetup {
    /// The axis that moves.
    pub axis: Motion,
    /// M: dry inertia of all that moves, kg or kg m².
    pub inertia: Uncertain,
    /// C: springs or hydrostatics, N/m or N m/rad.
    pub stiffness: Uncertain,
    /// The part of each release that is used.
    pub window: DecayWindow,
}

impl DecaySetup {
    /// The whole of each release from its first passage through rest.
    #[must_use]
    pub fn new(axis: Motion, inertia: Uncertain, stiffness: Uncertain) -> Self {
        Self { axis, inertia, stiffness, window: DecayWindow::default() }
    }

    pub(super) fn check(&self) -> Result<(), DecayError> {
        let refuse = |what, value, must| Err(DecayError::Declared { what, value, must });
        let (m, c, w) = (self.inertia, self.stiffness, self.window);
        if !(m.value >= 0.0 && m.value.is_finite()) {
            return refuse("the dry inertia", m.value, "zero or more and finite");
        }
        if !(c.value > 0.0 && c.value.is_finite()) {
            return refuse("the stiffness", c.value, "above zero and finite");
        }
        for (what, u) in [("the uncertainty of the inertia", m), ("the uncertainty of the stiffness", c)] {
            if !(u.standard >= 0.0 && u.standard.is_finite()) {
                return refuse(what, u.standard, "zero or more and finite");
            }
        }
        if !(w.smallest_over_noise >= 2.0 && w.smallest_over_noise.is_finite()) {
            return refuse("the smallest swing over noise", w.smallest_over_noise, "2 or more and finite");
        }
        if let Some(t) = w.free_from_s.filter(|t| !t.is_finite()) {
            return refuse("the time from which the motion is free", t, "finite");
        }
        Ok(())
    }
}
