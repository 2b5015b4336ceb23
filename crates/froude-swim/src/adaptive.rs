//! A path to a stated accuracy: Dormand and Prince's eighth order with steps of its own.
//!
//! A drag law by |v| has corners, where the order falls: the step control pays for them.
//!
//! # Source
//!
//! Hairer, Nørsett & Wanner (1993), *Solving Ordinary Differential Equations I*, II.5 (DOP853), by the crate `differential-equations`.

use std::cell::{Cell, RefCell};

use differential_equations::prelude::*;

/// Most steps between two times that are asked for.
const MOST_STEPS: usize = 1_000_000;

/// A path that could not be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The matrix of masses was not positive definite.
    #[error("at {time_s} s an inertia of the chain is not positive: its masses and added masses must be")]
    Inertia {
        /// Time, s.
        time_s: f64,
    },
    /// The step control gave up.
    #[error(
        "the path could not be followed beyond {time_s} s to a tolerance of {tolerance:e}: {found}; take a larger one"
    )]
    Steps {
        /// Time, s.
        time_s: f64,
        /// Relative.
        tolerance: f64,
        /// What the integration said.
        found: &'static str,
    },
}

/// Rates by a closure that may have none.
struct Rates<F> {
    of: RefCell<F>,
    failed: Cell<Option<f64>>,
}

impl<F: FnMut(f64, &[f64], &mut [f64]) -> Option<()>> ODE<f64, Vec<f64>> for Rates<F> {
    fn diff(&self, time_s: f64, state: &Vec<f64>, rates: &mut Vec<f64>) {
        if (self.of.borrow_mut())(time_s, state, rates).is_none() {
            self.failed.set(self.failed.get().or(Some(time_s)));
            rates.fill(f64::NAN);
        }
    }
}

/// States at `times_s`, which grow, from the `start` at the first of them.
///
/// `tolerance` is that of a step, relative to each number of the state and to one.
///
/// # Errors
///
/// [`PathError`]: no positive inertia, steps that become too many or too small.
pub fn path(
    times_s: &[f64],
    start: &[f64],
    tolerance: f64,
    rates: impl FnMut(f64, &[f64], &mut [f64]) -> Option<()>,
) -> Result<Vec<Vec<f64>>, PathError> {
    let system = Rates { of: RefCell::new(rates), failed: Cell::new(None) };
    let mut out = vec![start.to_vec()];
    for pair in times_s.windows(2) {
        let from = out[out.len() - 1].clone();
        let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(MOST_STEPS);
        let found = IVP::ode(&system, pair[0], pair[1], from).method(method).solve();
        if let Some(time_s) = system.failed.get() {
            return Err(PathError::Inertia { time_s });
        }
        let refused = |time_s, found| PathError::Steps { time_s, tolerance, found };
        match found {
            Ok(mut solution) => out.push(solution.y.pop().ok_or(refused(pair[0], "it gave no state"))?),
            Err(Error::MaxSteps { t, .. }) => return Err(refused(t, "too many steps")),
            Err(Error::StepSize { t, .. }) => return Err(refused(t, "steps became too small")),
            Err(Error::Stiffness { t, .. }) => return Err(refused(t, "it is stiff")),
            Err(_) => return Err(refused(pair[0], "it does not start")),
        }
    }
    Ok(out)
}
