//! Least squares with a realistic uncertainty; independent of any fluid.
//!
//! A [`Problem`] (design, responses of one or several components, weights,
//! clusters) and [`Options`] (bounds, constraints, priors, covariance)
//! go into [`fit`]; out comes a [`Fit`] in which every number is either
//! supported by the data or absent: what cannot be determined is `None`, and
//! the combinations that can are named.
//!
//! | module          | what                                                                 |
//! |-----------------|----------------------------------------------------------------------|
//! | [`linear`]      | the fit: pivoted QR, separate σ per component                        |
//! | [`bounded`]     | bounds, by an exact active-set method                                |
//! | `constrained`   | linear inequalities: interior point, polished by QR                  |
//! | `covariance`    | classical, HC3, CR3                                                  |
//! | [`rank`]        | what is determined                                                   |
//! | [`diagnostics`] | serial correlation, collinearity                                     |
//! | [`select`]      | F tests, AICc, cross-validation, lack of fit                         |
//! | [`nonlinear`]   | models that are not linear in their parameters, by runs              |
//! | [`odr`]         | orthogonal distance regression: uncertain inputs                     |
//! | [`stream`]      | more rows than memory holds, one pass                                |
//! | [`propagate`]   | combined and expanded uncertainty, effective degrees of freedom      |
//! | [`budget`]      | what each error does to the coefficients, intervals, jackknife       |
//! | [`residuals`], [`ratio`] | residuals of a component, exact tests of their independence and equal variances |
//! | [`replicates`]  | scatter from replicates left out in turn, sums of such, a floor      |
//! | [`series`]      | mean of a correlated series                                          |
//! | [`serial`]      | scatter of few runs whose errors are correlated in time              |
//! | [`long_run`]    | long-run covariance of scores (HAC), automatic lag                   |
//! | [`coverage`]    | whether an interval covers as often as it says                       |
//!
//! All of it runs on one thread except [`stream::reduce_columns`], whose result does not
//! depend on how many there are.
//!
//! Not here: correlated noise other than by cluster (and, for one long run, by
//! [`nonlinear::Scatter::Serial`]), a search for the best of several minima, Bayesian
//! posteriors beyond normal priors. No R² is reported: without an intercept it has
//! no agreed meaning, and with one it praises the range of the test.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
// Matrix loops read like the formula with indices.
#![allow(clippy::needless_range_loop)]

pub mod autocorrelation;
mod block;
pub mod bounded;
pub mod budget;
mod complement;
mod constrained;
mod covariance;
pub mod coverage;
mod dense;
mod determined;
pub mod diagnostics;
pub mod distribution;
mod error;
mod estimate;
pub mod freedom;
pub mod jackknife;
pub mod linear;
pub mod long_run;
pub mod nonlinear;
pub mod odr;
mod options;
mod outcome;
mod problem;
pub mod propagate;
pub mod rank;
pub mod ratio;
pub mod replicates;
mod report;
pub mod residuals;
pub mod select;
pub mod serial;
pub mod series;
mod shape;
pub mod stream;

pub use complement::complement;
pub use covariance::FEWEST_CLUSTERS;
pub use error::FitError;
pub use faer;
pub use linear::fit;
pub use options::{Bound, Constraint, CovarianceKind, Options, Prior};
pub use outcome::{Combination, ComponentSummary, Fit, FitCoefficient, Optimality, Status};
pub use problem::Problem;
pub use report::{End, Report};
