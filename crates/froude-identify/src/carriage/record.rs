//! D_d as an estimate record: `D_x_II` of the law `quadratic`, as a table has it; C_D is made from it.

use std::f64::consts::{FRAC_PI_2, PI};

use froude_records::campaign::BodyAxis;
use froude_records::estimate::{
    Attitude, Clusters, Derived, Diagnostics, Estimate, Frame, Interval, Measured, MethodUsed, Range, ReferencePoint,
    Signs, Status,
};
use froude_records::text::counted;
use indexmap::IndexMap;

use super::coefficient::{Coefficient, Method, name};
use super::run::{DragRun, DragSetup, Efficiency};
use crate::record;
use crate::validity::{ALONG, OFF_AXIS};

/// Name of the frame of a carriage where nobody has said which axis of the body lies along its travel.
pub(crate) const CHAIN: &str = "chain";

fn frame(setup: &DragSetup) -> Frame {
    match setup.travel {
        Some(_) => Frame::body(),
        None => Frame {
            name: CHAIN.to_owned(),
            axes: Vec::new(),
            words: "x along the chain; f_x of the fluid on the body".to_owned(),
        },
    }
}

/// The record of one method's result.
pub(super) fn estimate(c: &Coefficient, setup: &DragSetup, runs: &[DragRun<'_>], recommended: bool) -> Estimate {
    let name = name(setup);
    let recorded = froude_records::estimate::Coefficient {
        label: Some("D_d".to_owned()),
        value: Some(c.value),
        unit: "kg/m".to_owned(),
        status: Status::Free,
        nuisance: false,
        standard_uncertainty: c.standard,
        type_a: c.type_a,
        type_b: Some(c.type_b),
        interval_95: c.interval_95,
        effective_dof: Some(c.dof).filter(|d| d.is_finite()),
    };
    let mut refers_to =
        IndexMap::from([("density".to_owned(), Measured { value: setup.density_kg_m3, unit: "kg/m^3".to_owned() })]);
    let mut derived = IndexMap::new();
    if let Some(area) = setup.reference_area_m2 {
        refers_to.insert("area".to_owned(), Measured { value: area, unit: "m^2".to_owned() });
        let scale = 2.0 / (setup.density_kg_m3 * area);
        let drag = Derived {
            formula: format!("2*{name}/(density*area)"),
            value: Some(c.value * scale),
            unit: "1".to_owned(),
            standard_uncertainty: c.standard.map(|u| u * scale),
            interval_95: c.interval_95.map(|[low, high]| [low * scale, high * scale]),
        };
        derived.insert("C_D".to_owned(), drag);
    }
    let mut constants = IndexMap::new();
    if c.method.is_sensorless() {
        let value = setup.force_per_volt_n();
        constants.insert("force_per_volt".to_owned(), Measured { value, unit: "N/V".to_owned() });
    }
    // Without pairs or runs to leave out nothing tells the scatter, and the estimate states no covariance.
    let is_stated = c.standard.is_some();
    let type_a = record::type_a(&c.model).filter(|_| is_stated);
    let (by, n) = if c.pairs >= 2 { ("pair", c.pairs) } else { ("run", c.points.len()) };
    Estimate {
        id: format!("{}/{}", setup.name, c.method.name()),
        source: setup.name.clone(),
        kind: "towing".to_owned(),
        method: MethodUsed {
            name: c.method.name().to_owned(),
            version: 1,
            words: format!("{}; least squares over v|v| through the origin", c.method.words()),
        },
        frame: frame(setup),
        point: ReferencePoint::default(),
        signs: Signs::default(),
        attitude: setup.travel.map(|axis| Attitude { travel: axis.name().to_owned() }),
        law: record::law(&c.model, &c.data, constants),
        refers_to,
        data: Vec::new(),
        n_observations: c.points.len(),
        clusters: Some(Clusters { by: by.to_owned(), n }),
        dof: IndexMap::from([(setup.load().to_owned(), type_a.as_ref().and_then(|a| a.dof[0]))]),
        sigma: IndexMap::new(),
        coefficients: IndexMap::from([(name, recorded)]),
        derived,
        type_a,
        errors: if is_stated { record::errors(&c.model) } else { IndexMap::new() },
        interval: Interval { looks: c.looks, ..Interval::default() },
        undetermined: Vec::new(),
        validity: validity(c, setup),
        diagnostics: Diagnostics { notes: notes(c, setup, runs), ..Diagnostics::default() },
        recommended,
        reason: None,
    }
}

/// Speeds, and the angle to the flow that the attitude makes.
fn validity(c: &Coefficient, setup: &DragSetup) -> IndexMap<String, Range> {
    let speeds = super::fsm::reach(&c.points.iter().map(|p| p.speed_m_s.abs()).collect::<Vec<_>>());
    let ways = super::fsm::reach(&c.points.iter().map(|p| p.speed_m_s).collect::<Vec<_>>());
    // Astern is the other way round, where it went nowhere else.
    let along = if ways[1] > 0.0 { 0.0 } else { PI };
    let ranges: &[(&str, [f64; 2], &str)] = match setup.travel {
        None | Some(BodyAxis::X) => &[("angle", [along; 2], "rad"), (OFF_AXIS, [0.0; 2], "rad"), (ALONG, ways, "m/s")],
        Some(BodyAxis::Y) => {
            // Towards starboard where it went there at all: the law is odd, and between the two ways nothing was towed.
            let angle = if ways[1] > 0.0 { -FRAC_PI_2 } else { FRAC_PI_2 };
            &[("angle", [angle; 2], "rad"), (OFF_AXIS, [FRAC_PI_2; 2], "rad"), (ALONG, [0.0; 2], "m/s")]
        }
        Some(BodyAxis::Z) => &[],
    };
    std::iter::once(&("speed", speeds, "m/s"))
        .chain(ranges)
        .map(|&(name, [low, high], unit)| (name.to_owned(), Range { low, high, unit: unit.to_owned() }))
        .collect()
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
    if setup.strut_n_s2_m2.is_none() {
        out.push("of body and strut together: no drag of the strut is declared".to_owned());
    }
    out.push(format!(
        "{} given, {} used, {}",
        counted(runs.len(), "run", "runs"),
        counted(c.points.len(), "point", "points"),
        counted(c.pairs, "pair", "pairs")
    ));
    out
}
