//! The force per volt as an estimate: calibrated with known weights, and as the constants of the drive declare it.
//!
//! Two calibrations whose campaigns declare the same weights have the error of the weights in common, by its key, and two on one rig that of the
//! pulley that neither measured.

use froude_fit::distribution::coverage_factor;
use froude_records::estimate::{
    Coefficient, Derived, Diagnostics, Estimate, Frame, Law, MethodUsed, OWN, SharedError, Signs, Status, TypeA,
};
use froude_records::number::finite;
use indexmap::IndexMap;

use super::Calibration;
use crate::drag::setup::{DragSetup, Efficiency, UNDECLARED_EFFICIENCY};

/// Name of the coefficient and of its law: `drive_force = force_per_volt · command`.
pub(super) const FORCE_PER_VOLT: &str = "force_per_volt";

/// What is known of the errors of a calibration beside its scatter.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Standard uncertainty of the weights, as a part.
    pub weight_relative: f64,
    /// Key of that error, where a campaign declares the weights.
    pub weights: Option<String>,
    /// Standard uncertainty of the pulley's loss as declared, as a part of the weight.
    pub pulley_standard: f64,
    /// Key of that error, where the rig is known.
    pub pulley: Option<String>,
}

/// The calibration as an estimate of `source`.
#[must_use]
pub fn calibrated(source: &str, c: &Calibration, known: &Known) -> Estimate {
    let k = c.force_per_volt;
    let from_weights = k.value * known.weight_relative;
    // The covariance is that of what errs, alike in every calibration that has it; the slope is this calibration's (GUM F.1.2).
    let error = |names: [&str; 2], standard, slope| SharedError::declared(names, standard, f64::INFINITY, [slope]);
    let own = |key: &Option<String>, name: &str| key.clone().unwrap_or_else(|| format!("{OWN}{name}"));
    let weights = error(["known weights", "hung_weight"], known.weight_relative, k.value);
    let mut errors = IndexMap::from([(own(&known.weights, "weights"), weights)]);
    if c.from_pulley > 0.0 && known.pulley_standard > 0.0 {
        let slope = c.from_pulley / known.pulley_standard;
        let loss = error(["declared loss of the pulley", "pulley_loss"], known.pulley_standard, slope);
        errors.insert(own(&known.pulley, "pulley"), loss);
    }
    let coefficient = Coefficient {
        standard_uncertainty: Some(k.standard),
        type_a: Some(c.type_a),
        type_b: Some(from_weights.hypot(c.from_pulley)),
        interval_95: Some(c.interval_95),
        effective_dof: finite(Some(k.dof)),
        ..Coefficient::of(Some(k.value), "N/V", Status::Free)
    };
    let formula = format!("{FORCE_PER_VOLT}/{:e} N/V", k.value / c.efficiency.value);
    let half = coverage_factor(0.95, c.efficiency.dof) * c.efficiency.standard;
    let efficiency = Derived {
        standard_uncertainty: Some(c.efficiency.standard),
        interval_95: Some([c.efficiency.value - half, c.efficiency.value + half]),
        ..Derived::of(formula, Some(c.efficiency.value), "1")
    };
    let scatter = if c.is_pulley_measured {
        "scatter of the runs (HC3), the declared loss of the pulley as a prior"
    } else {
        "scatter of the runs (HC3)"
    };
    Estimate {
        type_a: Some(TypeA::of(
            vec![FORCE_PER_VOLT.to_owned()],
            vec![vec![c.type_a * c.type_a]],
            &[c.type_a_dof],
            scatter,
        )),
        errors,
        n_observations: c.used,
        derived: IndexMap::from([("efficiency".to_owned(), efficiency)]),
        diagnostics: Diagnostics { notes: c.notes.clone(), ..Diagnostics::default() },
        recommended: true,
        reason: Some("from known weights, gear and chain included".to_owned()),
        ..estimate(source, "calibration", "least squares of the command on known weights, both directions", coefficient)
    }
}

/// What the constants of the drive declare: (n/R) K_T K_amp times the gear's efficiency, which lies anywhere in
/// [`UNDECLARED_EFFICIENCY`] where nobody declares it.
#[must_use]
pub fn declared(source: &str, setup: &DragSetup) -> Estimate {
    let ideal = setup.ideal_force_per_volt_n;
    let constants = setup.torque_constant_relative.hypot(setup.speed_scale_relative);
    let (efficiency, of_gear) = match setup.efficiency {
        Efficiency::Declared(e) => (e.value, e.standard),
        Efficiency::Undeclared => {
            let [low, high] = UNDECLARED_EFFICIENCY;
            // Uniform between the two (GUM 4.3.7).
            (0.5 * (low + high), (high - low) / 12.0_f64.sqrt())
        }
    };
    let standard = ideal * of_gear.hypot(efficiency * constants);
    let coefficient = Coefficient {
        standard_uncertainty: Some(standard),
        type_a: Some(0.0),
        type_b: Some(standard),
        ..Coefficient::of(Some(ideal * efficiency), "N/V", Status::Fixed)
    };
    estimate(&format!("{source}, declared"), "declared", "the constants of the drive as declared", coefficient)
}

fn estimate(source: &str, method: &str, words: &str, coefficient: Coefficient) -> Estimate {
    Estimate {
        id: format!("{source}/{FORCE_PER_VOLT}"),
        source: source.to_owned(),
        kind: "towing".to_owned(),
        method: MethodUsed::of(method, words),
        frame: Frame { words: "y along the travel of the carriage".to_owned(), ..Frame::chain() },
        signs: Signs(
            "force of the drive on the carriage at the chain per volt of its command, the motor driving the gear"
                .to_owned(),
        ),
        law: Law::of(FORCE_PER_VOLT, [("command", "V")]).giving("drive_force", "N", None),
        coefficients: IndexMap::from([(FORCE_PER_VOLT.to_owned(), coefficient)]),
        ..Estimate::default()
    }
}
