//! A path to a stated accuracy: Dormand and Prince's eighth order with steps of its own.
//!
//! A drag law by |v| has corners, where the order falls: the step control pays for them.
//!
//! The reference of the steps of a swimmer.
//!
//! # Source
//!
//! Hairer, Nørsett & Wanner (1993), *Solving Ordinary Differential Equations I*, II.5 (DOP853), by the crate `differential-equations`.

use std::cell::RefCell;

use differential_equations::prelude::*;
use froude_swim::dynamics::{Dynamics, StateOf};
use froude_swim::path::Swimmer;
use froude_swim::state::{ENERGIES, Numbers, State};

/// Most steps between two times that are asked for.
const MOST_STEPS: usize = 1_000_000;

/// Rates by a closure.
struct Rates<F>(RefCell<F>);

impl<F: FnMut(f64, &[f64], &mut [f64]) -> Option<()>> ODE<f64, Vec<f64>> for Rates<F> {
    fn diff(&self, time_s: f64, state: &Vec<f64>, rates: &mut Vec<f64>) {
        (self.0.borrow_mut())(time_s, state, rates).unwrap();
    }
}

/// States at `times_s`, which grow, from the `start` at the first of them.
///
/// `tolerance` is that of a step, relative to each number of the state and to one.
pub fn path(
    times_s: &[f64],
    start: &[f64],
    tolerance: f64,
    rates: impl FnMut(f64, &[f64], &mut [f64]) -> Option<()>,
) -> Vec<Vec<f64>> {
    let system = Rates(RefCell::new(rates));
    let mut out = vec![start.to_vec()];
    for pair in times_s.windows(2) {
        let from = out[out.len() - 1].clone();
        let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(MOST_STEPS);
        let mut solution = IVP::ode(&system, pair[0], pair[1], from).method(method).solve().unwrap();
        out.push(solution.y.pop().unwrap());
    }
    out
}

/// The path of a swimmer whose joints follow exactly.
pub fn followed<C: Dynamics>(
    swimmer: &mut Swimmer<'_, C>,
    times_s: &[f64],
    start: &StateOf<C>,
    tolerance: f64,
) -> Vec<StateOf<C>> {
    let state = |n: &[f64]| State {
        pose: C::Pose::first_of(n),
        head: C::Motion::first_of(&n[C::Pose::LEN..]),
        energy_j: <[f64; ENERGIES]>::first_of(&n[C::Pose::LEN + C::Motion::LEN..]),
    };
    let numbers = |s: &StateOf<C>| [s.pose.as_ref(), s.head.as_ref(), &s.energy_j].concat();
    let rates = |time_s: f64, from: &[f64], out: &mut [f64]| {
        out.copy_from_slice(&numbers(&swimmer.rates(time_s, &state(from))?));
        Some(())
    };
    let found = path(times_s, &numbers(start), tolerance, rates);
    let settled = |n: &Vec<f64>| {
        let mut state = state(n);
        C::settle(state.pose.as_mut());
        state
    };
    found.iter().map(settled).collect()
}
