//! What the records of loops and of modes have in common: numbers read off a measured response, with its covariance.

use froude_fit::distribution::coverage_factor;
use froude_records::estimate::{Coefficient, Estimate, Frame, Law, Range, Signs, Status, TypeA};
use froude_records::number::finite;
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
    let type_a = spread.map(|s| {
        let names = known.iter().map(|&j| readings[j].0.to_owned()).collect();
        let matrix = known.iter().map(|&a| known.iter().map(|&b| s.covariance[a][b]).collect()).collect();
        let dof: Vec<f64> = known.iter().map(|&j| s.dof[j]).collect();
        TypeA::of(names, matrix, &dof, "scatter of the response points, each estimated from its neighbours")
    });
    let coefficients = readings.iter().enumerate().map(|(j, &(name, unit, value))| {
        let own = value.and(spread).map(|s| (s.covariance[j][j].max(0.0).sqrt(), s.dof[j]));
        let standard = own.map(|(u, _)| u);
        let half = own.map(|(u, dof)| coverage_factor(0.95, dof) * u);
        let status = if value.is_some() { Status::Free } else { Status::Undetermined };
        let coefficient = Coefficient {
            standard_uncertainty: standard,
            type_a: standard,
            interval_95: value.zip(half).map(|(x, half)| [x - half, x + half]),
            effective_dof: finite(own.map(|(_, dof)| dof)),
            ..Coefficient::of(value, unit, status)
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
        law: Law::of(law, [("frequency", "Hz")]).giving(load, unit, None),
        coefficients: coefficients.collect(),
        type_a,
        validity: IndexMap::from([("frequency".to_owned(), Range::of(band_hz, "Hz"))]),
        ..Estimate::default()
    }
}
