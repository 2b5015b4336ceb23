//! What the runs of one wave give, as an estimate: a law of that frequency alone, whose name says it, so that only estimates of one period are compared.

use crate::names::EXCITED_RESPONSE;
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{Clusters, Diagnostics, Estimate, Law, Measured, NamedCorrelation, Range, Status};
use froude_records::number;
use indexmap::IndexMap;

use super::coefficients::{AtPeriod, NAMES, UNITS};
use super::response::DOF;
use super::setup::{Setup, WaveRun};
use crate::joint::DeclaredError;
use crate::joint::record::{about, by_part, errors, type_a};
use froude_identify::record::coefficient;

/// What an estimate is made from beside its numbers.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The source.
    pub source: &'a Source,
    /// What is declared.
    pub setup: &'a Setup,
    /// The runs.
    pub runs: &'a [WaveRun<'a>],
}

/// The period whose A33 is known best: a source recommends one estimate.
#[must_use]
pub fn narrowest(found: &[AtPeriod]) -> usize {
    let width = |at: &AtPeriod| at.combined[0].standard;
    (0..found.len()).min_by(|&a, &b| width(&found[a]).total_cmp(&width(&found[b]))).unwrap_or(0)
}

/// The estimate of one period.
#[must_use]
pub fn estimate(at: &AtPeriod, context: &Context<'_>, is_recommended: bool) -> Estimate {
    let Context { campaign, source, setup, runs } = *context;
    // Without a declared window B33 is not determined.
    let stated = if at.is_declared { 2 } else { 1 };
    let of = |j: usize| {
        let is_stated = j < stated;
        let status = if is_stated { Status::Free } else { Status::Undetermined };
        let (value, combined) = (is_stated.then_some(at.values[j]), is_stated.then_some(at.combined[j]));
        (NAMES[j].to_owned(), coefficient(value, UNITS[j], status, combined))
    };
    let declared: Vec<DeclaredError> = at
        .errors
        .clone()
        .into_iter()
        .map(|error| DeclaredError { sensitivity: error.sensitivity[..stated].to_vec(), ..error })
        .collect();
    let samples = at.used().map(|used| used.response.rows.len()).sum();
    let period = format!("{:.3} s", at.period_s);
    let largest_correlation = at.is_declared.then(|| NamedCorrelation {
        first: NAMES[0].to_owned(),
        second: NAMES[1].to_owned(),
        value: at.correlation(),
    });
    let lines = format!("power at {} lines beside the wave's frequency, and scatter of repeated runs", DOF / 2.0);
    let type_a = type_a(&NAMES[..stated], &at.parts, lines);
    let id = format!("{EXCITED_RESPONSE} at {period}");
    let inputs = [("v_z", "m/s"), ("v_z_dot", "m/s^2")];
    let formula = Some("-A33*v_z_dot - B33*v_z".to_owned());
    let law = Law::of(format!("added_mass_damping at {period}"), inputs).giving("f_z", "N", formula);
    let constants = [
        ("omega", Measured::of(at.omega_rad_s, "rad/s")),
        ("mass", Measured::of(setup.mass_kg.value, "kg")),
        ("restoring", Measured::of(setup.restoring_n_m.value, "N/m")),
    ];
    Estimate {
        law: Law { constants: constants.into_iter().map(|(name, of)| (name.to_owned(), of)).collect(), ..law },
        n_observations: samples,
        clusters: Some(Clusters::of("run", at.used().count())),
        dof: IndexMap::from([("f_z".to_owned(), type_a.dof[0])]),
        coefficients: [0, 1].map(of).into_iter().collect(),
        type_a: Some(type_a),
        errors: errors(&declared, campaign),
        validity: validity(at, runs),
        diagnostics: Diagnostics { largest_correlation, notes: notes(at, stated), ..Diagnostics::default() },
        recommended: is_recommended,
        reason: is_recommended
            .then(|| "the period whose A33 is known best; each period has an estimate of its own".to_owned()),
        ..about((campaign, source), [&id, EXCITED_RESPONSE], method_words(at, setup))
    }
}

fn method_words(at: &AtPeriod, setup: &Setup) -> String {
    let declared = if at.is_declared {
        "declared"
    } else {
        "not declared: where force and motion have come up and the wavemaker runs"
    };
    format!(
        "from {:.2} s to {:.2} s after the wavemaker's start ({declared}), whole cycles; {} harmonics of the wavemaker's frequency; force over motion, each per stroke of its wavemaker; force taken {} \
         ms before its stamp",
        at.window_s[0],
        at.window_s[1],
        setup.harmonics,
        number::plain(1e3 * setup.delay_s.value, 4)
    )
}

fn validity(at: &AtPeriod, runs: &[WaveRun<'_>]) -> IndexMap<String, Range> {
    let mut out = IndexMap::from([("period".to_owned(), Range::of([at.period_s; 2], "s"))]);
    let w = at.omega_rad_s;
    let amplitudes = at.free.iter().map(|used| {
        let size = used.response.amplitude;
        if runs[used.run].shows == super::setup::Shows::Acceleration { size / (w * w) } else { size }
    });
    let (low, high) = amplitudes.fold((f64::INFINITY, 0.0_f64), |(low, high), z| (low.min(z), high.max(z)));
    out.insert("amplitude".to_owned(), Range::of([low, high], "m"));
    out.insert("speed".to_owned(), Range::of([w * low, w * high], "m/s"));
    out
}

/// The budget of each coefficient, in sentences.
fn notes(at: &AtPeriod, stated: usize) -> Vec<String> {
    let named: Vec<(&str, &str)> = NAMES.into_iter().zip(UNITS).take(stated).collect();
    let mut out = by_part(&at.parts, &named, 2);
    if !at.is_declared {
        out.push("B33 only with the declared window before reflections".to_owned());
    }
    out
}
