//! D_d over the seam: `D_x_II` of the law `quadratic`, as a table has it, with the paper's name as its label; C_D is made from it.

use std::f64::consts::{FRAC_PI_2, PI};

use froude_identify::IdentifyError;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::regression::Weight;
use froude_identify::seam::{Choice, Derived, Reduced, Stated};
use froude_identify::validity::{ALONG, OFF_AXIS};
use froude_records::campaign::{BodyAxis, SourceKind};
use froude_records::estimate::{Attitude, Frame, Measured, Range};
use froude_records::text::counted;
use froude_records::texts::Texts;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::coefficient::Coefficient;
use super::errors;
use super::observed::Observed;
use super::run::DragRun;
use super::steady::reach;
use crate::drag::point::{Method, Point, slope};
use crate::drag::setup::{DragSetup, Efficiency};

fn frame(setup: &DragSetup) -> Frame {
    match setup.travel {
        Some(_) => Frame::body(),
        None => Frame::chain(),
    }
}

/// Name of the coefficient, which the paper calls D_d.
fn name(setup: &DragSetup) -> String {
    format!("D_{}_II", setup.axis())
}

/// The points of a method as they are fitted, by the law that a table's `quadratic` is along one axis; `None` without a moving point.
///
/// # Errors
///
/// A law that cannot be made.
pub(super) fn reduced(observed: &Observed, setup: &DragSetup) -> Result<Option<Reduced>, IdentifyError> {
    let Observed { method, points, scatter, errors, .. } = observed;
    let Some(measured) = slope(points) else { return Ok(None) };
    let data = observations(points, setup);
    let (axis, name) = (setup.axis(), name(setup));
    let formula = format!("-{name}*v_{axis}*abs(v_{axis})");
    let law = ForceLaw::formulas("quadratic", &IndexMap::from([(setup.load().to_owned(), formula)]), &data)?;
    Ok(Some(Reduced {
        choice: Choice::Method(method.words().to_owned()),
        weight: Weight::One,
        scatter: scatter.clone(),
        errors: errors::shared(*method, points, measured, setup).into_iter().chain(errors.clone()).collect(),
        looks: setup.looks,
        stated: stated(*method, name, setup),
        validity: validity(points, setup),
        ..Reduced::new(&setup.name, SourceKind::Towing, method.name(), data, vec![law])
    }))
}

/// The points as observations, with the drag of the strut subtracted: loads of the fluid on the body, against the motion.
fn observations(points: &[Point], setup: &DragSetup) -> Dataset {
    let strut = setup.strut_n_s2_m2.map_or(0.0, |s| s.value);
    let speed: Vec<f64> = points.iter().map(|p| p.speed_m_s).collect();
    let load = points.iter().map(|p| strut * p.speed_m_s * p.speed_m_s.abs() - p.force_n).collect();
    let texts = |of: &dyn Fn(&Point) -> String| points.iter().map(of).collect();
    let mut data = Dataset {
        rows: points.len(),
        configuration: Texts::repeated("", points.len()),
        setup: Texts::repeated("", points.len()),
        run: texts(&|p| p.run.clone()),
        group: Some(texts(&|p| p.pair.to_string())),
        line: (1..=points.len()).collect(),
        ..Dataset::default()
    };
    data.put(setup.velocity(), speed, Dimension::SPEED);
    data.put("density", vec![setup.density_kg_m3; points.len()], Dimension::DENSITY);
    data.put(setup.load(), load, Dimension::FORCE);
    data
}

/// What the record says beside the fit.
fn stated(method: Method, name: String, setup: &DragSetup) -> Stated {
    let mut refers_to = IndexMap::from([("density".to_owned(), Measured::of(setup.density_kg_m3, "kg/m^3"))]);
    let mut derived = Vec::new();
    if let Some(area) = setup.reference_area_m2 {
        refers_to.insert("area".to_owned(), Measured::of(area, "m^2"));
        derived.push(Derived {
            name: "C_D".to_owned(),
            formula: format!("2*{name}/(density*area)"),
            of: name.clone(),
            factor: 2.0 / (setup.density_kg_m3 * area),
            factor_relative: setup.reference_relative,
            unit: "1".to_owned(),
        });
    }
    let mut constants = IndexMap::new();
    if method.is_sensorless() {
        constants.insert(setup.drive.name.to_owned(), Measured::of(setup.force_per_volt_n(), setup.drive.unit));
    }
    Stated {
        method: method.name().to_owned(),
        words: Some(format!("{}; least squares over v|v| through the origin", method.words())),
        frame: frame(setup),
        attitude: setup.travel.map(|axis| Attitude { travel: axis.name().to_owned() }),
        refers_to,
        constants,
        labels: IndexMap::from([(name, "D_d".to_owned())]),
        derived,
        ..Stated::default()
    }
}

/// Speeds, and the angle to the flow that the attitude makes.
fn validity(points: &[Point], setup: &DragSetup) -> IndexMap<String, Range> {
    let speeds = reach(&points.iter().map(|p| p.speed_m_s.abs()).collect::<Vec<_>>());
    let ways = reach(&points.iter().map(|p| p.speed_m_s).collect::<Vec<_>>());
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
        .map(|&(name, ends, unit)| (name.to_owned(), Range::of(ends, unit)))
        .collect()
}

/// The budget and what the value rests on, in sentences.
pub(super) fn notes(c: &Coefficient, setup: &DragSetup, runs: &[DragRun<'_>]) -> Vec<String> {
    let mut out: Vec<String> = c
        .budget
        .iter()
        .map(|p| {
            let held = if p.in_scatter { ", already in the scatter, not added" } else { "" };
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
        out.push("the sensor also carries what hangs below it besides the body".to_owned());
    }
    if setup.strut_n_s2_m2.is_none() {
        out.push("the drag is that of body and strut together: none of the strut is declared".to_owned());
    }
    out.push(format!(
        "{} given, {} used, {}",
        counted(runs.len(), "run", "runs"),
        counted(c.points.len(), "point", "points"),
        counted(c.pairs, "pair", "pairs")
    ));
    out
}
