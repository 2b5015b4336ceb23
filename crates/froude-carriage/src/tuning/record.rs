//! What the records of loops and of modes have in common: numbers read off a measured response, with its covariance.

use froude_fit::distribution::coverage_factor;
use froude_records::estimate::{Coefficient, Estimate, Frame, Law, Output, Range, Signs, Status, TypeA};
use indexmap::IndexMap;

/// A number read off a response: name, unit, value where there is one.
pub(super) type Reading = (&'static str, &'static str, Option<f64>);

/// An estimate of `source` with these readings and their covariance, `None` where nothing is known of it; `law` and `output` say of what response,
/// `band_hz` where it was measured.
pub(super) fn of_response(
    source: &str,
    (law, output): (&str, (&str, &str)),
    readings: &[Reading],
    covariance: Option<&[Vec<f64>]>,
    band_hz: [f64; 2],
) -> Estimate {
    let known: Vec<usize> = (0..readings.len()).filter(|&j| readings[j].2.is_some()).collect();
    let type_a = covariance.map(|c| TypeA {
        names: known.iter().map(|&j| readings[j].0.to_owned()).collect(),
        matrix: known.iter().map(|&a| known.iter().map(|&b| c[a][b]).collect()).collect(),
        dof: vec![None; known.len()],
        kind: "points of the measured response, each by its coherence".to_owned(),
    });
    let coefficients = readings.iter().enumerate().map(|(j, &(name, unit, value))| {
        let standard = value.and(covariance).map(|c| c[j][j].max(0.0).sqrt());
        let half = standard.map(|u| coverage_factor(0.95, f64::INFINITY) * u);
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
            effective_dof: None,
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
