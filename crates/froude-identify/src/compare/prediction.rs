//! Forces that the estimates predict over the range that they share.

use faer::Mat;
use froude_records::comparison::{Comparison, LoadComparison, coverage_note};
use froude_records::estimate::{Estimate, Range, beside};
use froude_records::finding::{Finding, Severity};
use froude_records::units::Dimension;

use super::coefficients::{e_n, noted};
use super::contradiction::{axes_not_tied, density_differs};
use super::independence::{origins, same_data};
use crate::common::{self, Common, Number};
use crate::compare::named::Named;
use crate::compare::stated::Stated;
use crate::dataset::{Dataset, LOADS, unit_text};
use crate::law::ForceLaw;

/// Speeds and angles at which forces are predicted, per axis of the common range.
const FORCE_POINTS: usize = 5;

/// Why an estimate gives no load from a steady motion of stated speed and angle; `None` where it gives one. Others have no part in the common range.
pub(super) fn gives_no_load(estimate: &Estimate) -> Option<String> {
    let one = Range::of([1.0; 2], "");
    let data = operating_points(&one, &one, &[1.0], 1000.0);
    let law = match ForceLaw::of_estimate(estimate, &data) {
        Ok(law) => law,
        Err(why) => return Some(format!("its law cannot be evaluated at a stated speed and angle ({why})")),
    };
    if !law.responses.iter().any(|r| LOADS.contains(&r.as_str())) {
        return Some(format!("its law gives {}, which is not a force or moment", law.responses.join(", ")));
    }
    let lacking: Vec<&str> = law.channels().into_iter().filter(|c| data.values(c).is_none()).collect();
    if !lacking.is_empty() {
        return Some(format!("its law needs {}, which does not follow from speed and angle", lacking.join(", ")));
    }
    let has_value = |name: &str| estimate.coefficients.get(name).is_some_and(|c| c.value.is_some());
    let unknown: Vec<&str> = law.coefficients.iter().map(|c| c.name.as_str()).filter(|name| !has_value(name)).collect();
    (!unknown.is_empty()).then(|| format!("its record gives no value for {}", unknown.join(", ")))
}

/// Forces by the recommended estimates over the common range of speed and angle.
pub(super) fn predict_forces(all: &[Named<'_>], labels: &[String], out: &mut Comparison) {
    let all: Vec<(&Named<'_>, &String)> =
        all.iter().zip(labels).filter(|(n, _)| gives_no_load(n.estimate).is_none()).collect();
    let recommended: Vec<_> = all.iter().copied().filter(|(n, _)| n.estimate.recommended).collect();
    let chosen = if recommended.len() >= 2 { recommended } else { all };
    let points = match Points::shared(&chosen) {
        Ok(Some(points)) => points,
        Ok(None) => return,
        Err(what) => {
            out.findings.push(Finding::new(
                Severity::Warning,
                "no-common-range",
                format!("{what} do not overlap: no force can be compared without extrapolation"),
            ));
            return;
        }
    };
    let predictions: Vec<Prediction<'_>> =
        chosen.iter().filter_map(|&(named, label)| Prediction::of(named, label, &points.data)).collect();
    if predictions.len() < 2 {
        return;
    }
    out.findings.extend(doubts(&predictions));
    out.loads = loads(&predictions, &points);
    let of = |label: &String| {
        let sides = out.loads.iter().flat_map(|row| [&row.first, &row.second]);
        coverage_note(label, sides.filter(|side| &side.source == label))
    };
    out.coverage = if out.loads.is_empty() { Vec::new() } else { predictions.iter().map(|p| of(p.label)).collect() };
}

/// Motions at which forces are set side by side.
struct Points {
    data: Dataset,
    /// Whether the number of links means anything to these laws.
    has_links: bool,
}

impl Points {
    /// Over the range that all share; `None` where none states a range of speed, `Err` with what does not overlap.
    fn shared(chosen: &[(&Named<'_>, &String)]) -> Result<Option<Self>, &'static str> {
        let range = |name: &str| -> Option<Range> {
            let stated: Vec<&Range> = chosen.iter().filter_map(|(n, _)| n.estimate.validity.get(name)).collect();
            let first = stated.first()?;
            let low = stated.iter().map(|r| r.low).fold(f64::NEG_INFINITY, f64::max);
            let high = stated.iter().map(|r| r.high).fold(f64::INFINITY, f64::min);
            Some(Range::of([low, high], &first.unit))
        };
        let Some(speed) = range("speed") else { return Ok(None) };
        let angle = range("angle").unwrap_or(Range::of([0.0; 2], "rad"));
        if speed.low > speed.high || angle.low > angle.high {
            return Err("the fitted ranges of speed or angle");
        }
        let links = range("n_links");
        if links.as_ref().is_some_and(|r| r.low > r.high) {
            return Err("the numbers of links that were tested");
        }
        let is_of_links = |law: &str| froude_hydro::DragModel::from_name(law).is_some();
        let has_links = links.is_some() || chosen.iter().any(|(n, _)| is_of_links(&n.estimate.law.name));
        let links =
            links.map_or_else(|| vec![1.0], |r| if r.low == r.high { vec![r.low] } else { vec![r.low, r.high] });
        let density = chosen.first().and_then(|(n, _)| n.estimate.density()).map_or(1000.0, |d| d.value);
        let mut data = operating_points(&speed, &angle, &links, density);
        let viscosity = chosen.iter().find_map(|(n, _)| n.estimate.refers_to.get("kinematic_viscosity"));
        if let Some(viscosity) = viscosity {
            let values = vec![viscosity.value; data.rows];
            data.put("kinematic_viscosity", values, Dimension::KINEMATIC_VISCOSITY);
        }
        Ok(Some(Self { data, has_links }))
    }
}

/// Forces of one estimate at these points.
struct Prediction<'a> {
    named: Named<'a>,
    label: &'a String,
    law: ForceLaw,
    force: Vec<f64>,
    slopes: Mat<f64>,
    /// The same of the other laws of its source that the data do not contradict.
    others: Vec<Self>,
}

impl<'a> Prediction<'a> {
    /// `None` where a coefficient has no value, or the law needs what the points do not have.
    fn of(named: &Named<'a>, label: &'a String, data: &Dataset) -> Option<Self> {
        let others = beside(&named.record.estimates, named.estimate).into_iter();
        let others = others.filter_map(|estimate| Self::of_law(&Named { estimate, ..*named }, label, data)).collect();
        Some(Self { others, ..Self::of_law(named, label, data)? })
    }

    /// Without others.
    fn of_law(named: &Named<'a>, label: &'a String, data: &Dataset) -> Option<Self> {
        let law = ForceLaw::of_estimate(named.estimate, data).ok()?;
        let values = law.values_of(named.estimate).ok()?;
        let (force, slopes) = (law.predict(data, &values).ok()?, law.regressors(data, &values).ok()?);
        Some(Self { named: *named, label, law, force, slopes, others: Vec::new() })
    }

    /// The load of one point, with the envelope of all laws.
    fn number(&self, component: &str, point: usize, points: usize) -> Number<'_> {
        let others: Vec<Number<'_>> = self.others.iter().map(|of| of.by_law(component, point, points)).collect();
        self.by_law(component, point, points).around(&others)
    }

    /// The load of one point, with its slope in each coefficient.
    fn by_law(&self, component: &str, point: usize, points: usize) -> Number<'_> {
        let Some(r) = self.law.responses.iter().position(|name| name == component) else {
            return Number::of_nothing(self.named.estimate);
        };
        let row = r * points + point;
        let slope = |name: &str| self.law.position(name).map_or(0.0, |j| self.slopes[(row, j)]);
        Number::of_number(self.named.estimate, Some(self.force[row]).filter(|f| f.is_finite()), slope)
    }
}

/// What stands against setting these estimates beside the first of them.
fn doubts(predictions: &[Prediction<'_>]) -> Vec<Finding> {
    let mut out = Vec::new();
    for estimate in predictions.iter().map(|p| p.named.estimate) {
        if !estimate.validity.contains_key("speed") {
            let text = format!(
                "{} states no range of speed and angle: whether its forces are extrapolated is not known",
                estimate.id
            );
            out.push(Finding::new(Severity::Note, "range-not-stated", text).of_source(&estimate.source));
        }
    }
    let first = predictions[0].named.estimate;
    for other in predictions[1..].iter().map(|p| p.named.estimate) {
        // Of one model it is said already.
        if first.law.name != other.law.name {
            out.extend(axes_not_tied(first, other));
            out.extend(density_differs(first, other));
            out.extend(common::findings(&[Common::of(first, other)]));
        }
    }
    out
}

/// Each load at each point by the first estimate, beside every other.
fn loads(predictions: &[Prediction<'_>], points: &Points) -> Vec<LoadComparison> {
    let data = &points.data;
    let named: Vec<Named<'_>> = predictions.iter().map(|p| p.named).collect();
    let origins = origins(&named);
    let is_same_data: Vec<bool> =
        (0..named.len()).map(|j| same_data([&named[0], &named[j]], [&origins[0], &origins[j]])).collect();
    let commons: Vec<Common<'_>> = named.iter().map(|n| Common::of(named[0].estimate, n.estimate)).collect();
    let mut out = Vec::new();
    for component in LOADS {
        for i in 0..data.rows {
            let sides: Vec<Number<'_>> = predictions.iter().map(|p| p.number(component, i, data.rows)).collect();
            let forces: Vec<Stated> = sides.iter().map(|side| side.stated).collect();
            if forces.iter().all(|f| f.value.is_none()) {
                continue;
            }
            for j in 1..forces.len() {
                let (first, second) = (predictions[0].label, predictions[j].label);
                let missing = [0, j].into_iter().find(|k| forces[*k].value.is_none());
                let apart = || other_point(named[0].estimate, named[j].estimate);
                let (e_n, note) = noted(match missing {
                    Some(k) => Err(format!("{} gives no {component}", predictions[k].label)),
                    None if component.starts_with("m_")
                        && let Some(why) = apart() =>
                    {
                        Err(why)
                    }
                    None => e_n([&sides[0], &sides[j]], &commons[j], [first, second], is_same_data[j]),
                });
                out.push(LoadComparison {
                    component: component.to_owned(),
                    unit: unit_text(data, component),
                    n_links: data.values("n_links").map(|v| v[i]).filter(|_| points.has_links),
                    speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                    angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                    first: forces[0].of(first),
                    second: forces[j].of(second),
                    e_n,
                    note,
                });
            }
        }
    }
    out
}

/// Why moments of two estimates are not compared: they are about different points, and a force at an arm lies between them.
fn other_point(first: &Estimate, second: &Estimate) -> Option<String> {
    let [a, b] = [first, second].map(|e| e.point.words.as_str());
    (a != b).then(|| {
        let point =
            |words: &str| if words.is_empty() { "a point that is not stated".to_owned() } else { words.to_owned() };
        format!("moments about different points: {} and {}", point(a), point(b))
    })
}

fn operating_points(speed: &Range, angle: &Range, links: &[f64], density: f64) -> Dataset {
    let grid = |r: &Range| -> Vec<f64> {
        if r.high - r.low <= 1e-12 {
            vec![r.high]
        } else {
            (0..FORCE_POINTS).map(|k| r.low + (r.high - r.low) * k as f64 / (FORCE_POINTS - 1) as f64).collect()
        }
    };
    let (mut u, mut a, mut k) = (Vec::new(), Vec::new(), Vec::new());
    for &n in links {
        for &s in &grid(speed) {
            for &t in &grid(angle) {
                u.push(s);
                a.push(t);
                k.push(n);
            }
        }
    }
    let rows = u.len();
    let mut data = Dataset { rows, ..Dataset::default() };
    data.put("speed", u, Dimension::SPEED);
    data.put("angle", a, Dimension::ONE);
    data.put("n_links", k, Dimension::ONE);
    data.put("density", vec![density; rows], Dimension::DENSITY);
    for load in LOADS {
        let dimension = if load.starts_with("m_") { Dimension::MOMENT } else { Dimension::FORCE };
        data.put(load, vec![0.0; rows], dimension);
    }
    data.velocity_from_speed_and_angle();
    data
}
