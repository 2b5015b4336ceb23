//! D_d and C_D as an estimate record.

use froude_fit::budget::Kind;
use froude_records::estimate::{
    Coefficient as Recorded, Covariance, Diagnostics, Estimate, Law, Measured, Range, Status,
};
use froude_records::text::counted;
use indexmap::IndexMap;

use super::coefficient::{Coefficient, LAW, LOAD, Method};
use super::run::{DragRun, DragSetup, Efficiency};
use crate::validity::{ALONG, OFF_AXIS};

/// The axis of a carriage's drag: nobody has said which axis of the body lies along it.
pub(crate) const FRAME: &str = "x along the chain; f_x of the fluid on the body";

/// The record of one method's result.
pub(super) fn estimate(c: &Coefficient, setup: &DragSetup, runs: &[DragRun<'_>], recommended: bool) -> Estimate {
    let mut coefficients = IndexMap::new();
    let recorded = |scale: f64, unit: &str| Recorded {
        value: Some(c.value * scale),
        unit: unit.to_owned(),
        status: Status::Free,
        standard_uncertainty: c.standard.map(|u| u * scale),
        type_a: c.type_a.map(|u| u * scale),
        type_b: Some(c.type_b * scale),
        interval_95: c.interval_95.map(|[low, high]| [low * scale, high * scale]),
        effective_dof: Some(c.dof).filter(|d| d.is_finite()),
    };
    coefficients.insert("D_d".to_owned(), recorded(1.0, "N s^2/m^2"));
    let mut geometry = IndexMap::new();
    if let Some(area) = setup.reference_area_m2 {
        coefficients.insert("C_D".to_owned(), recorded(2.0 / (setup.density_kg_m3 * area), "1"));
        geometry.insert("A".to_owned(), Measured { value: area, unit: "m^2".to_owned() });
    }
    let mut constants = IndexMap::new();
    if c.method.is_sensorless() {
        let value = setup.force_per_volt_n();
        constants.insert("force_per_volt".to_owned(), Measured { value, unit: "N/V".to_owned() });
    }
    let speeds = super::fsm::reach(&c.points.iter().map(|p| p.speed_m_s.abs()).collect::<Vec<_>>());
    let mut validity = IndexMap::new();
    let range = Range { low: speeds[0], high: speeds[1], unit: "m/s".to_owned() };
    validity.insert("speed".to_owned(), range);
    let ways = super::fsm::reach(&c.points.iter().map(|p| p.speed_m_s).collect::<Vec<_>>());
    for (name, [low, high], unit) in [("angle", [0.0, 0.0], "rad"), (OFF_AXIS, [0.0, 0.0], "rad"), (ALONG, ways, "m/s")]
    {
        validity.insert(name.to_owned(), Range { low, high, unit: unit.to_owned() });
    }
    let formulas = IndexMap::from([(LOAD.to_owned(), LAW.to_owned())]);
    let scatter = c.budget.iter().find(|p| p.kind == Kind::A);
    Estimate {
        id: format!("{}/{}", setup.name, c.method.name()),
        source: setup.name.clone(),
        kind: "towing".to_owned(),
        model: c.method.model(),
        law: Law { version: 1, constants, formulas },
        geometry,
        density: Some(Measured { value: setup.density_kg_m3, unit: "kg/m^3".to_owned() }),
        frame: FRAME.to_owned(),
        reference_point: String::new(),
        method: format!("{}; least squares over v|v| through the origin", c.method.words()),
        covariance_kind: scatter.map_or("none stated", |p| &p.name).to_owned(),
        dof: std::iter::once(("f_x".to_owned(), scatter.map(|p| p.dof[0]))).collect(),
        sigma: IndexMap::new(),
        n_observations: c.points.len(),
        coefficients,
        covariance: c.standard.map(|u| Covariance { names: vec!["D_d".to_owned()], matrix: vec![vec![u * u]] }),
        undetermined: Vec::new(),
        validity,
        diagnostics: Diagnostics { notes: notes(c, setup, runs), ..Diagnostics::default() },
        recommended,
        reason: None,
    }
}

/// The budget and what the value rests on, in sentences.
fn notes(c: &Coefficient, setup: &DragSetup, runs: &[DragRun<'_>]) -> Vec<String> {
    let mut out: Vec<String> = c
        .budget
        .iter()
        .map(|p| {
            let held = if p.in_scatter { ", in the scatter and not added" } else { "" };
            format!(
                "{} (type {}, shared by {}): {:.4} N s^2/m^2, {:.2} % of D_d{held}",
                p.name,
                p.kind,
                p.shared,
                p.standard(0),
                100.0 * p.standard(0) / c.value.abs()
            )
        })
        .collect();
    if c.method.is_sensorless() && setup.calibration.is_none() && setup.efficiency == Efficiency::Undeclared {
        out.push("not calibrated: eq. 8 and 9 as printed give F/η".to_owned());
    }
    if c.method == Method::Fsm {
        out.push("the sensor also carries what hangs below it beside the body".to_owned());
    }
    out.push(format!(
        "{} given, {} used, {}",
        counted(runs.len(), "run", "runs"),
        counted(c.points.len(), "point", "points"),
        counted(c.pairs, "pair", "pairs")
    ));
    out
}
