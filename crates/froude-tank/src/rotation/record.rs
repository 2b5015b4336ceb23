//! A rotation as an estimate.

use froude_hydro::swing::Pivot;
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{
    self, Clusters, Diagnostics, Estimate, Frame, Law, Measured, MethodUsed, Output, Range, ReferencePoint,
};
use froude_records::run::ROTATION;
use froude_records::units::{Dimension, Unit};
use froude_rig::rotation::Mounted;
use indexmap::IndexMap;

use super::derive::{Derived, law_behind};
use super::findings::correlation;
use super::fit::{LAMBDAS, LAW, RotationFit};
use super::setup::{RotationRun, Setup, tip_kc};
use crate::joint::record;
use crate::motion::Motion;

/// The load of the record: the fluid's moment about the body's z axis.
const LOAD: &str = "m_z";

/// What an estimate is made from beside its fit.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The source.
    pub source: &'a Source,
    /// What is declared.
    pub setup: &'a Setup,
    /// The runs.
    pub runs: &'a [RotationRun<'a>],
    /// Their motions.
    pub motions: &'a [Motion],
    /// What follows from the λs.
    pub derived: &'a [Derived],
}

/// The estimate.
#[must_use]
pub fn estimate(fit: &RotationFit, context: &Context<'_>) -> Estimate {
    let Context { campaign, source, setup, derived, .. } = *context;
    let measured = |value: f64, unit: &str| Measured { value, unit: unit.to_owned() };
    let mut refers_to = IndexMap::new();
    if let Some(density) = setup.density_kg_m3 {
        refers_to.insert("density".to_owned(), measured(density.value, "kg/m^3"));
    }
    if let Some(link) = setup.link {
        let axes = [("a", link.major_semi_axis_m), ("b", link.minor_semi_axis_m), ("l", link.half_length_m)];
        refers_to.extend(axes.map(|(name, value)| (name.to_owned(), measured(value, "m"))));
        refers_to.insert("v_ref".to_owned(), measured(1.0, "m/s"));
    }
    let unit = |dimension| Unit::si(dimension).text;
    let [l1, l2, l3] = LAMBDAS;
    let formula = format!("-{l1}*w_z_dot - {l2}*w_z - {l3}*w_z*abs(w_z)");
    let mut notes = record::notes(fit, "N m");
    notes.extend(correlation(fit).map(|r| format!("correlation of {l2} and {l3}: {r:.3}")));
    notes.extend(law_behind(derived).map(|found| format!("the law behind {l3}: {}", found.words())));
    let of_derived = |d: &Derived| {
        let number = estimate::Derived {
            formula: d.formula.to_owned(),
            value: Some(d.value),
            unit: d.unit.to_owned(),
            standard_uncertainty: Some(d.combined.standard),
            interval_95: Some(d.combined.interval(d.value)),
        };
        (d.name.to_owned(), number)
    };
    let axis = match setup.axis {
        Pivot::Upright => "the axis is upright",
        Pivot::Stream => "the axis lies level, and the restoring moment is taken off",
    };
    let words = record::words(fit, setup.cycles, setup.harmonics, "torque", axis);
    Estimate {
        id: format!("{}/{ROTATION}", source.name),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        method: MethodUsed { name: ROTATION.to_owned(), version: 1, words },
        frame: Frame::body(),
        point: ReferencePoint { words: "the axis that it turned about".to_owned(), stated: false },
        law: Law {
            name: LAW.to_owned(),
            version: 1,
            inputs: IndexMap::from([
                ("w_z".to_owned(), unit(Dimension::ANGULAR_SPEED)),
                ("w_z_dot".to_owned(), unit(Dimension::ANGULAR_ACCELERATION)),
            ]),
            outputs: IndexMap::from([(
                LOAD.to_owned(),
                Output { unit: unit(Dimension::MOMENT), formula: Some(formula) },
            )]),
            constants: IndexMap::new(),
        },
        refers_to,
        n_observations: fit.samples,
        clusters: Some(Clusters { by: fit.by.to_owned(), n: fit.clusters }),
        dof: IndexMap::from([(LOAD.to_owned(), fit.parts[0].dof.first().copied().filter(|d| d.is_finite()))]),
        coefficients: record::coefficients(fit, &|name| !LAMBDAS.contains(&name)),
        derived: derived.iter().map(of_derived).collect(),
        type_a: Some(record::type_a(fit)),
        errors: record::errors(fit, campaign),
        validity: validity(context),
        diagnostics: Diagnostics { notes, ..Diagnostics::default() },
        recommended: true,
        reason: Some("the only law of the fluid torque".to_owned()),
        ..Estimate::default()
    }
}

/// Where the coefficients are supported: amplitudes, rates, periods, and the number of oscillation of the tip.
fn validity(context: &Context<'_>) -> IndexMap<String, Range> {
    let Context { setup, runs, motions, campaign, .. } = *context;
    let mut out: IndexMap<String, Range> = IndexMap::new();
    let mut take = |name: &str, value: f64, unit: &str| {
        let range = out.entry(name.to_owned()).or_insert(Range { low: value, high: value, unit: unit.to_owned() });
        (range.low, range.high) = (range.low.min(value), range.high.max(value));
    };
    for (_, motion) in runs.iter().zip(motions).filter(|(run, _)| run.mounted == Mounted::Body) {
        let (amplitude, period) = (motion.angle.amplitude(1), motion.angle.period_s());
        take("amplitude", amplitude, "rad");
        take("period", period, "s");
        take("speed", amplitude * motion.angle.omega_rad_s, "rad/s");
        if let Some(kc) = tip_kc(setup, amplitude) {
            take("KC", kc, "1");
        }
        if let Some((link, viscosity)) = setup.link.zip(campaign.fluid.kinematic_viscosity_m2_s) {
            take("beta", (2.0 * link.major_semi_axis_m).powi(2) / (viscosity * period), "1");
        }
    }
    out
}
