//! What a decay test gives: releases over time, and what is declared about body and springs.

use crate::decay::axis::Motion;
use froude_fit::budget::Uncertain;

use crate::error::TankError;

/// One release: columns of one length, time increasing.
#[derive(Debug, Clone, Copy)]
pub struct DecayRun<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Position, m or rad; its zero is free.
    pub position: &'a [f64],
}

impl DecayRun<'_> {
    /// Mean step of time, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let n = self.time_s.len();
        if n < 2 { f64::NAN } else { (self.time_s[n - 1] - self.time_s[0]) / (n - 1) as f64 }
    }

    /// The run is what [`DecayRun`] says.
    pub(super) fn check(&self) -> Result<(), TankError> {
        let (n, found) = (self.time_s.len(), self.position.len());
        if n != found {
            return Err(TankError::of_run(self.id, format!("position has {found} samples where time has {n}")));
        }
        for (column, values) in [("time", self.time_s), ("position", self.position)] {
            if let Some(index) = values.iter().position(|x| !x.is_finite()) {
                return Err(TankError::of_run(self.id, format!("{column} at sample {index} is not finite")));
            }
        }
        if let Some(index) = self.time_s.windows(2).position(|w| w[1] <= w[0]) {
            let what = format!(
                "the time at sample {} is {} s after {} s; it must increase",
                index + 1,
                self.time_s[index + 1],
                self.time_s[index]
            );
            return Err(TankError::of_run(self.id, what));
        }
        if n < 2 {
            return Err(TankError::of_run(self.id, format!("{n} samples are no log")));
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
    /// A peak is the extreme of a half cycle that is further from rest than this many standard deviations of a sample's noise.
    pub smallest_over_noise: f64,
    /// That standard deviation, m or rad, where it is declared; from the fourth differences of each log where not, which noise that is correlated from
    /// sample to sample escapes.
    pub noise: Option<f64>,
    /// Largest swing and period as somebody saw them, m or rad, and s: a factor of two decides whether the units of the logs are right.
    pub seen: [Option<f64>; 2],
}

impl Default for DecayWindow {
    fn default() -> Self {
        Self { free_from_s: None, skip_half_cycles: 0, smallest_over_noise: 8.0, noise: None, seen: [None; 2] }
    }
}

/// What is declared of a body beside its logs, and turns rates into forces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Known {
    /// C, N/m or N m/rad: the moving inertia is C/ω².
    Stiffness(Uncertain),
    /// All that moves, added mass included, kg or kg m².
    MovingInertia(Uncertain),
}

impl Known {
    /// Its key and its number.
    #[must_use]
    pub const fn named(self) -> (&'static str, Uncertain) {
        match self {
            Self::Stiffness(c) => ("stiffness", c),
            Self::MovingInertia(inertia) => ("moving_inertia", inertia),
        }
    }
}

/// What drives a displaced body back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Restoring {
    /// C (q − q₀): springs or hydrostatics, N/m or N m/rad.
    Spring(Uncertain),
    /// B r sin(q − q₀): a buoyancy that exceeds the weight, at a radius from the axis of a rotation.
    Buoyancy {
        /// B, N.
        force_n: Uncertain,
        /// r, m.
        radius_m: Uncertain,
    },
    /// ω² (q − q₀) of a moving inertia of one: neither is declared, and coefficients are per moving inertia.
    PerInertia {
        /// ω², 1/s².
        omega2: f64,
        /// What turns them into forces, where it is declared.
        known: Option<Known>,
    },
}

impl Restoring {
    /// C: its slope at rest, N/m or N m/rad; 1/s² per moving inertia.
    #[must_use]
    pub fn stiffness(self) -> f64 {
        match self {
            Self::Spring(c) => c.value,
            Self::Buoyancy { force_n, radius_m } => force_n.value * radius_m.value,
            Self::PerInertia { omega2, .. } => omega2,
        }
    }

    /// Whether coefficients are per moving inertia.
    #[must_use]
    pub const fn is_per_inertia(self) -> bool {
        matches!(self, Self::PerInertia { .. })
    }

    /// Whether it is a sine.
    #[must_use]
    pub const fn is_pendulum(self) -> bool {
        matches!(self, Self::Buoyancy { .. })
    }

    /// What is declared of it: name, number, and ∂C by it.
    #[must_use]
    pub fn parts(self) -> Vec<(&'static str, Uncertain, f64)> {
        match self {
            Self::Spring(c) => vec![("stiffness", c, 1.0)],
            Self::Buoyancy { force_n, radius_m } => {
                vec![("buoyancy", force_n, radius_m.value), ("radius", radius_m, force_n.value)]
            }
            Self::PerInertia { .. } => Vec::new(),
        }
    }

    /// Its energy at a distance from rest, J.
    #[must_use]
    pub fn energy_j(self, off: f64) -> f64 {
        self.stiffness() * if self.is_pendulum() { 1.0 - off.cos() } else { 0.5 * off * off }
    }
}

/// What is declared about body and springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecaySetup {
    /// The axis that moves.
    pub axis: Motion,
    /// M: dry inertia of all that moves, kg or kg m².
    pub inertia: Uncertain,
    /// What drives the body back.
    pub restoring: Restoring,
    /// The part of each release that is used.
    pub window: DecayWindow,
}

impl DecaySetup {
    /// On springs of a stiffness; the whole of each release from its first passage through rest.
    #[must_use]
    pub fn new(axis: Motion, inertia: Uncertain, stiffness: Uncertain) -> Self {
        Self { axis, inertia, restoring: Restoring::Spring(stiffness), window: DecayWindow::default() }
    }

    /// Of a body of which the log is known and little else: coefficients are per moving inertia.
    #[must_use]
    pub fn per_inertia(axis: Motion, known: Option<Known>) -> Self {
        let restoring = Restoring::PerInertia { omega2: 1.0, known };
        Self { restoring, ..Self::new(axis, Uncertain::new(0.0, 0.0), Uncertain::new(1.0, 0.0)) }
    }

    /// Names of the coefficients.
    #[must_use]
    pub fn names(&self) -> [String; 3] {
        if self.restoring.is_per_inertia() { self.axis.rate_names() } else { self.axis.decay_names() }
    }

    /// Unit of a force on the body; per moving inertia that of an acceleration.
    #[must_use]
    pub const fn force_unit(&self) -> &'static str {
        match (self.restoring.is_per_inertia(), self.axis.is_rotation()) {
            (false, false) => "N",
            (false, true) => "N m",
            (true, false) => "m/s^2",
            (true, true) => "rad/s^2",
        }
    }

    /// The distance from rest that a peak exceeds, m or rad, where a sample has a noise.
    pub(super) fn level(&self, noise: f64) -> f64 {
        self.window.smallest_over_noise * noise
    }

    pub(super) fn check(&self) -> Result<(), TankError> {
        let refuse =
            |what: &str, value: f64, must: &str| Err(TankError::new(format!("{what} is {value}; it must be {must}")));
        let (m, w) = (self.inertia, self.window);
        if !(m.value >= 0.0 && m.value.is_finite()) {
            return refuse("the dry inertia", m.value, "zero or more and finite");
        }
        let parts = self.restoring.parts();
        for (what, u, _) in &parts {
            if !(u.value > 0.0 && u.value.is_finite()) {
                return refuse(what, u.value, "above zero and finite");
            }
        }
        let stiffness = self.restoring.stiffness();
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return refuse("what drives the body back", stiffness, "above zero and finite");
        }
        for u in parts.iter().map(|(_, u, _)| *u).chain([m]) {
            if !(u.standard >= 0.0 && u.standard.is_finite()) {
                return refuse("a declared standard uncertainty", u.standard, "zero or more and finite");
            }
        }
        if let Some(noise) = w.noise.filter(|x| !(*x > 0.0 && x.is_finite())) {
            return refuse("the noise of a sample", noise, "above zero and finite");
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
