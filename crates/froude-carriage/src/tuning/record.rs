//! What the records of loops and of modes have in common: numbers read off a measured response, with its covariance.

use froude_fit::distribution::coverage_factor;
use froude_records::estimate::{Coefficient, Estimate, Frame, Law, Output, Range, Signs, Status, TypeA};
use indexmap::IndexMap;

/// A number read off a response: name, unit, value where there is one.
pub(super) type Reading = (&'static str, &'static str, Option<f64>);

/// What is known of the readings' errors.
pub(super) struct Spread {
    /// Covariance of all of them.
    pub(super) covariance: Vec<Vec<f64>>,
    /// Degrees of freedom of each.
    pub(super) dof: Vec<f64>,
}

/// An estimate of `source` with these readings and their spread, `None` where nothing is known of it; `law` and `output` say of what response,
/// `band_hz` where it was measured.
pub(super) fn of_response(
    source: &str,
    (law, output): (&str, (&str, &str)),
    readings: &[Reading],
    spread: Option<&Spread>,
    band_hz: [f64; 2],
) -> Estimate {
    let known: Vec<usize> = (0..readings.len()).filter(|&j| readings[j].2.is_some()).collect();
    let finite = |x: f64| Some(x).filter(|x| x.is_finite());
    let type_a = spread.map(|s| TypeA {
        names: known.iter().map(|&j| readings[j].0.to_owned()).collect(),
        matrix: known.iter().map(|&a| known.iter().map(|&b| s.covariance[a][b]).collect()).collect(),
        dof: known.iter().map(|&j| finite(s.dof[j])).collect(),
        kind: "scatter of the response points, each estimated from its neighbours".to_owned(),
    });
    let coefficients = readings.iter().enumerate().map(|(j, &(name, unit, value))| {
        let own = value.and(spread).map(|s| (s.covariance[j][j].max(0.0).sqrt(), s.dof[j]));
        let standard = own.map(|(u, _)| u);
        let half = own.map(|(u, dof)| coverage_factor(0.95, dof) * u);
        let coefficient = Coefficient {
            label: None,
            value,
            unit: unit.to_owned(),
            status: if value.is_some() { Status::Free } else { Status::Undetermined },
            nuisance: false,
            standard_uncertainty: standard,
            type_a: standard,
            type_b: None,
            interval_95: value.zip(half).map(|(x, half)| [x - half, x + half]),
            effective_dof: own.and_then(|(_, dof)| finite(dof)),
            unconstrained: None,
            range_95: None,
        };
        (name.to_owned(), coefficient)
    });
    let (load, unit) = output;
    Estimate {
        id: format!("{source}/{law}"),
        source: source.to_owned(),
        kind: "towing".to_owned(),
        frame: Frame { words: "shaft of the motor".to_owned(), ..Frame::chain() },
        signs: Signs("angle of the motor, positive where a positive command turns it".to_owned()),
        law: Law {
            name: law.to_owned(),
            version: 1,
            inputs: IndexMap::from([("frequency".to_owned(), "Hz".to_owned())]),
            outputs: IndexMap::from([(load.to_owned(), Output { unit: unit.to_owned(), formula: None })]),
            constants: IndexMap::new(),
        },
        coefficients: coefficients.collect(),
        type_a,
        validity: IndexMap::from([(
            "frequency".to_owned(),
            Range { low: band_hz[0], high: band_hz[1], unit: "Hz".to_owned() },
        )]),
        ..Estimate::default()
    }
}
