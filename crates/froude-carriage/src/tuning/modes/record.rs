//! Modes of a carriage as estimates, one for each state of the body.

use froude_records::estimate::{Derived, Diagnostics, Estimate, MethodUsed};
use froude_records::number::finite;
use indexmap::IndexMap;

use super::page::free_without_loss;
use super::{CarriageModes, StateModes};
use crate::tuning::record::{Spread, of_response};
use crate::tuning::resonance::TwoMassModes;

/// Estimates of the states whose response shows two modes, with which state each is of.
#[must_use]
pub fn estimates(source: &str, modes: &CarriageModes) -> Vec<(usize, Estimate)> {
    let of = |(i, state): (usize, &StateModes)| {
        let found = state.modes.as_ref().ok()?;
        Some((i, estimate(source, state, found, modes)))
    };
    modes.states.iter().enumerate().filter_map(of).collect()
}

fn estimate(source: &str, state: &StateModes, m: &TwoMassModes, of: &CarriageModes) -> Estimate {
    let efficiency = of.efficiency;
    let law = match state.body.as_str() {
        "none" => "modes_bare".to_owned(),
        body => format!("modes_{body}"),
    };
    let readings = [
        ("load_frequency", "Hz", Some(m.load.frequency_hz)),
        ("load_damping", "1", Some(m.load.damping)),
        ("free_frequency", "Hz", Some(m.free.frequency_hz)),
        ("free_damping", "1", Some(m.free.damping)),
    ];
    let standards = m.standards();
    let is_known = standards.iter().all(|u| u.is_finite());
    let covariance: Vec<Vec<f64>> = (0..readings.len())
        .map(|a| (0..readings.len()).map(|b| m.correlation[a][b] * standards[a] * standards[b]).collect())
        .collect();
    let band_hz = [state.plant.first(), state.plant.last()].map(|p| p.map_or(0.0, |p| p.frequency_hz));
    let spread = is_known.then(|| Spread { covariance, dof: vec![m.dof; readings.len()] });
    let of_response = of_response(source, (&law, ("response", "rad/V")), &readings, spread.as_ref(), band_hz);
    let ratio = Derived::of("(free_frequency/load_frequency)^2 - 1", Some(m.inertia_ratio), "1");
    let mut derived = IndexMap::from([("inertia_ratio".to_owned(), ratio)]);
    if let Some((e, (hz, standard))) = efficiency.zip(free_without_loss(m, efficiency)) {
        let formula = format!("load_frequency*sqrt(1 + {:e}*inertia_ratio), the gear's loss taken out", e.value);
        let number = Derived { standard_uncertainty: finite(Some(standard)), ..Derived::of(formula, Some(hz), "Hz") };
        derived.insert("free_frequency_without_loss".to_owned(), number);
    }
    if let Some((hz, damping)) = of.proposed {
        let frequency = Derived::of("geometric mean of load_frequency with the body, to shape for", Some(hz), "Hz");
        let damping = Derived::of("mean of load_damping with the body, to shape for", Some(damping), "1");
        derived.extend([("shaped_mode".to_owned(), frequency), ("shaped_damping".to_owned(), damping)]);
    }
    Estimate {
        method: MethodUsed::of("resonance", "least squares of the logarithm of the response, two masses and a chain"),
        n_observations: state.plant.len(),
        derived,
        diagnostics: Diagnostics {
            relative_residual: IndexMap::from([("response".to_owned(), m.relative_residual)]),
            ..Diagnostics::default()
        },
        ..of_response
    }
}
