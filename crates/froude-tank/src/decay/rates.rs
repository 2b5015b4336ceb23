//! What a release shows without inertia or stiffness: frequency, damping per moving inertia, and the ratios and periods that follow.
//!
//! With I = M + A, the equation of motion over I is q̈ + d_I q̇ + d_II q̇|q̇| + ω² (q − q₀) = 0: ω = √(C/I), d_I = D_I/I, d_II = D_II/I. Errors of M and C cancel in all three, so that
//! their uncertainty is that of the scatter alone.
//!
//! | number                  | formula                                   | unit |
//! |-------------------------|-------------------------------------------|------|
//! | damping ratio           | ζ = d_I/2ω                                | 1    |
//! | undamped, damped period | 2π/ω, 2π/√(ω² − d_I²/4)                   | s    |
//! | logarithmic decrement   | 2πζ/√(1 − ζ²)                             | 1    |
//! | … of a swing from a     | ln a − ln of the next peak on that side   | 1    |
//!
//! The first three rows are those of swings so small that quadratic damping takes no part. The last follows from the motion itself, integrated ([`super::motion`]).
//!
//! **Source.** The definitions of a linear oscillator; Froude (1874) for the decrement over the amplitude.

use std::f64::consts::TAU;

use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, combine};
use froude_fit::faer::Mat;
use froude_records::estimate::Derived;
use indexmap::IndexMap;

use super::envelope::envelope;
use super::error::DecayError;
use super::fit::{DecayFit, Method, Scatter};
use super::motion::Motion;
use super::output_error::output_error;
use super::run::{DecayRun, DecaySetup, Known, Restoring};

/// Relative step of a difference quotient: its own error is of the order of its square.
const STEP: f64 = 1e-5;
/// Points of the period in which the next peak is looked for.
const POINTS: usize = 400;

/// ω, d_I and d_II of a fit, with their scatter.
#[derive(Debug, Clone)]
pub struct Rates {
    /// ω in rad/s, d_I in 1/s, d_II in 1/m or 1/rad.
    pub values: [f64; 3],
    scatter: Option<Scatter>,
    is_pendulum: bool,
}

/// A swing beside the decrement of the law.
#[derive(Debug, Clone, PartialEq)]
pub struct Swing {
    /// The release.
    pub run: String,
    /// The peak that it begins at, from 0.
    pub number: usize,
    /// Distance of that from rest, m or rad.
    pub amplitude: f64,
    /// Time to the next peak on the same side, s.
    pub period_s: f64,
    /// ln of the one over the other; `None` where noise hides the second.
    pub decrement: Option<f64>,
    /// Decrement of the law at that amplitude, with its 95 % interval.
    pub law: Option<f64>,
    /// That interval.
    pub interval_95: Option<[f64; 2]>,
}

/// A fit by a method. Where neither inertia nor stiffness is declared it is made twice: of a unit stiffness first, which shows the frequency, and with that as the stiffness, of a
/// unit inertia.
///
/// # Errors
///
/// As [`envelope`] and [`output_error`].
pub fn fitted_by(method: Method, runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<DecayFit, DecayError> {
    let of = match method {
        Method::Envelope => envelope,
        Method::OutputError => output_error,
    };
    let Restoring::PerInertia { known, .. } = setup.restoring else { return of(runs, setup) };
    let [per_stiffness, ..] = of(runs, setup)?.values;
    let restoring = Restoring::PerInertia { omega2: per_stiffness.recip(), known };
    of(runs, &DecaySetup { restoring, ..*setup }).map(DecayFit::per_inertia)
}

impl DecayFit {
    /// Frequency and damping per moving inertia.
    #[must_use]
    pub fn rates(&self) -> Rates {
        let is_pendulum = self.restoring.is_pendulum();
        if self.restoring.is_per_inertia() {
            return Rates { values: self.values, scatter: self.type_a.clone(), is_pendulum };
        }
        self.ratios()
    }

    /// The same fit in terms of these: what is left to report where neither inertia nor stiffness is declared.
    #[must_use]
    fn per_inertia(mut self) -> Self {
        let Rates { values, scatter, .. } = self.ratios();
        let moving = |added: f64| (self.restoring.stiffness() / (self.inertia.value + added)).sqrt();
        self.runs.iter_mut().for_each(|run| run.added = moving(run.added));
        (self.values, self.type_a) = (values, scatter);
        self
    }

    fn ratios(&self) -> Rates {
        let moving = self.inertia.value + self.values[0];
        let omega = (self.restoring.stiffness() / moving).sqrt();
        let [linear, quadratic] = [1, 2].map(|j| self.values[j] / moving);
        let by = [
            [-0.5 * omega / moving, 0.0, 0.0],
            [-linear / moving, 1.0 / moving, 0.0],
            [-quadratic / moving, 0.0, 1.0 / moving],
        ];
        let by = Mat::from_fn(3, 3, |i, j| by[i][j]);
        let scatter = self.type_a.clone().map(|a| Scatter { covariance: &by * &a.covariance * by.transpose(), ..a });
        Rates { values: [omega, linear, quadratic], scatter, is_pendulum: self.restoring.is_pendulum() }
    }

    /// Numbers that follow from the coefficients, as a record has them.
    #[must_use]
    pub fn derived(&self) -> IndexMap<String, Derived> {
        let rates = self.rates();
        let [omega, linear, quadratic] = self.axis.rate_names();
        let [of_omega, of_linear, of_quadratic] = self.axis.rate_units();
        let [added, own_linear, own_quadratic] = &self.names;
        let mut out = IndexMap::new();
        let mut put = |name: &str, formula: String, unit: &str, of: &dyn Fn([f64; 3]) -> f64, others: Vec<Part>| {
            let (value, combined) = rates.propagated(&|x| Some(of(x)), others);
            let Some(value) = value.filter(|x| x.is_finite()) else { return };
            let number = Derived {
                standard_uncertainty: combined.map(|c| c.standard),
                interval_95: combined.map(|c| c.interval(value)),
                ..Derived::of(formula, Some(value), unit)
            };
            out.insert(name.to_owned(), number);
        };
        match self.restoring {
            Restoring::PerInertia { known: None, .. } => {}
            Restoring::PerInertia { known: Some(known), .. } => {
                let [_, damping, of_square] = self.axis.decay_names();
                let (declared, number) = known.named();
                let is_inertia = matches!(known, Known::MovingInertia(_));
                let per = if is_inertia { declared.to_owned() } else { format!("{declared}/{omega}^2") };
                let all: [(&str, String, &dyn Fn([f64; 3]) -> f64); 3] = [
                    ("moving_inertia", per.clone(), &|_| 1.0),
                    (&damping, format!("{linear}*{per}"), &|x| x[1]),
                    (&of_square, format!("{quadratic}*{per}"), &|x| x[2]),
                ];
                // An inertia that is declared is no result.
                let found = all.into_iter().zip(self.axis.decay_units()).skip(usize::from(is_inertia));
                for ((name, formula, factor), unit) in found {
                    let of =
                        |x: [f64; 3]| factor(x) * number.value * if is_inertia { 1.0 } else { (x[0] * x[0]).recip() };
                    let standard = (of(rates.values) * number.relative()).abs();
                    put(name, formula, unit, &of, vec![part_of(declared, standard, number.dof)]);
                }
            }
            _ => {
                let moving = format!("(inertia + {added})");
                put(&omega, format!("sqrt(stiffness/{moving})"), of_omega, &|x| x[0], Vec::new());
                put(&linear, format!("{own_linear}/{moving}"), of_linear, &|x| x[1], Vec::new());
                put(&quadratic, format!("{own_quadratic}/{moving}"), of_quadratic, &|x| x[2], Vec::new());
            }
        }
        put("zeta", format!("{linear}/(2*{omega})"), "1", &zeta, Vec::new());
        put("undamped_period", format!("2*pi/{omega}"), "s", &|x| TAU / x[0], Vec::new());
        let text = format!("2*pi/sqrt({omega}^2 - {linear}^2/4)");
        put("damped_period", text, "s", &|x| TAU / (x[0] * (1.0 - zeta(x).powi(2)).sqrt()), Vec::new());
        let text = "2*pi*zeta/sqrt(1 - zeta^2)".to_owned();
        put("log_decrement", text, "1", &|x| TAU * zeta(x) / (1.0 - zeta(x).powi(2)).sqrt(), Vec::new());
        out
    }

    /// The swings of all releases, one after the other.
    #[must_use]
    pub fn swings(&self) -> Vec<Swing> {
        let rates = self.rates();
        let mut out = Vec::new();
        for run in &self.runs {
            for (number, of) in run.turns.windows(3).enumerate() {
                let [[from_s, amplitude], _, [to_s, next]] = *of else { continue };
                let (law, combined) = rates.propagated(&|x| rates.decrement(x, amplitude), Vec::new());
                out.push(Swing {
                    run: run.id.clone(),
                    number,
                    amplitude,
                    period_s: to_s - from_s,
                    decrement: (next > 0.0 && amplitude > 0.0).then(|| (amplitude / next).ln()),
                    law,
                    interval_95: law.zip(combined).map(|(value, c)| c.interval(value)),
                });
            }
        }
        out
    }
}

fn part_of(name: &str, standard: f64, dof: f64) -> Part {
    Part::of_one(name.to_owned(), "campaign", Kind::B, standard, dof)
}

fn zeta([omega, linear, _]: [f64; 3]) -> f64 {
    0.5 * linear / omega
}

impl Rates {
    /// A number that follows from the three, with its uncertainty, that of other errors added; `None` where it has none.
    pub fn propagated(
        &self,
        of: &dyn Fn([f64; 3]) -> Option<f64>,
        others: Vec<Part>,
    ) -> (Option<f64>, Option<Combined>) {
        let value = of(self.values);
        let by = |j: usize| {
            // A coefficient of zero has a step too, by its uncertainty.
            let own = self.scatter.as_ref().map_or(0.0, |a| a.covariance[(j, j)].max(0.0).sqrt());
            let step = STEP * self.values[j].abs().max(own);
            let moved = |by: f64| of(std::array::from_fn(|k| self.values[k] + if k == j { by } else { 0.0 }));
            if step > 0.0 { Some((moved(step)? - moved(-step)?) / (2.0 * step)) } else { Some(0.0) }
        };
        let combined = || {
            let scatter = self.scatter.as_ref()?;
            let by = [by(0)?, by(1)?, by(2)?];
            let covariance = |i: usize, j: usize| by[i] * by[j] * scatter.covariance[(i, j)];
            let variance: f64 = (0..3).map(|i| (0..3).map(|j| covariance(i, j)).sum::<f64>()).sum();
            // The degrees of freedom of what weighs most.
            let most = (0..3).max_by(|i, j| covariance(*i, *i).total_cmp(&covariance(*j, *j)))?;
            let (standard, dof) = (variance.max(0.0).sqrt(), scatter.dof[most]);
            let scatter = Part::of_one(scatter.kind.clone(), scatter.shared, Kind::A, standard, dof);
            let parts: Vec<Part> = std::iter::once(scatter).chain(others).collect();
            Some(combine(&parts, 0, OUTSIDE_95)).filter(|c| c.standard.is_finite())
        };
        (value, value.and_then(|_| combined()))
    }

    /// Logarithmic decrement of a swing that begins at rest at an amplitude; `None` where it does not come back to that side.
    #[must_use]
    pub fn decrement(&self, [omega, linear, quadratic]: [f64; 3], amplitude: f64) -> Option<f64> {
        let motion =
            Motion { omega2: omega * omega, linear, quadratic, coulomb: 0.0, rest: 0.0, is_pendulum: self.is_pendulum };
        let step_s = 1.5 * TAU / (omega * POINTS as f64);
        let time_s: Vec<f64> = (0..POINTS).map(|i| step_s * i as f64).collect();
        let path = motion.path([amplitude, 0.0], &time_s)?;
        // Out and back: the speed turns from positive to negative at the next peak on this side.
        let turned = path.windows(2).skip(1).find(|w| w[0][1] > 0.0 && w[1][1] <= 0.0)?;
        let [q, v] = turned[1];
        // A parabola from the last sample back to where the speed is zero.
        let peak = q + 0.5 * v * v / (motion.omega2 * q);
        (amplitude > 0.0 && peak > 0.0).then(|| (amplitude / peak).ln())
    }
}
