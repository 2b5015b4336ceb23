//! Sources side by side: E_n per coefficient, a joint χ², and predicted forces.
//!
//! Coefficients of one model are compared with those of the same model only:
//! C_f of f1 and C_f of f6 share a name and nothing else. A published value
//! without uncertainty is shown as such; it never counts as exact.
//!
//! E_n = (a − b)/√(U_a² + U_b²) with U the expanded (95 %) uncertainties
//! (ISO 13528:2022, 9.7): |E_n| ≤ 1 says that the two agree within them.

use faer::Mat;
use faer::linalg::solvers::Solve;
use froude_records::estimate::{Coefficient, Estimate, EstimateFile, Range};
use froude_records::finding::{Finding, Severity};
use froude_records::units::Dimension;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::uncertainty::coverage_factor;

/// Speeds and angles at which forces are predicted, per axis of the common range.
const FORCE_POINTS: usize = 5;

/// One coefficient of two estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientRow {
    /// The model of both.
    pub model: String,
    /// Name of the coefficient.
    pub coefficient: String,
    /// Its unit.
    pub unit: String,
    /// Id of the first estimate.
    pub first: String,
    /// Id of the second.
    pub second: String,
    /// Value of the first, null when undetermined.
    pub value_first: Option<f64>,
    /// Value of the second.
    pub value_second: Option<f64>,
    /// E_n, or why there is none.
    pub e_n: Result<f64, String>,
}

/// The joint χ² of two estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRow {
    /// The model of both.
    pub model: String,
    /// Id of the first estimate.
    pub first: String,
    /// Id of the second.
    pub second: String,
    /// χ², degrees of freedom and p-value, or why there are none.
    pub result: Result<(f64, usize, f64), String>,
}

/// A force predicted by several estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceRow {
    /// Load component.
    pub component: String,
    /// Links of the configuration.
    pub n_links: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Angle, rad.
    pub angle_rad: f64,
    /// Force by each estimate in the order of [`Comparison::force_ids`], N, with its standard uncertainty where stated.
    pub forces: Vec<(f64, Option<f64>)>,
}

/// Estimates side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Comparison {
    /// Coefficient by coefficient, pair by pair.
    pub coefficients: Vec<CoefficientRow>,
    /// Jointly, pair by pair.
    pub joint: Vec<JointRow>,
    /// Ids of the estimates whose forces are predicted.
    pub force_ids: Vec<String>,
    /// Predicted forces over the common range.
    pub forces: Vec<ForceRow>,
    /// What was found on the way: contradictions, missing ranges.
    pub findings: Vec<Finding>,
}

/// An estimate with the file it comes from.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// The file, as the user named it.
    pub file: &'a str,
    /// The estimate.
    pub estimate: &'a Estimate,
}

/// All estimates of some files.
#[must_use]
pub fn named<'a>(files: &'a [(String, EstimateFile)]) -> Vec<Named<'a>> {
    files
        .iter()
        .flat_map(|(file, record)| record.estimates.iter().map(move |estimate| Named { file, estimate }))
        .collect()
}

/// Compares every pair of estimates of the same model, and predicts forces by the recommended ones.
#[must_use]
pub fn compare(all: &[Named<'_>]) -> Comparison {
    let mut out = Comparison::default();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            if a.estimate.model != b.estimate.model {
                continue;
            }
            if a.estimate.source == b.estimate.source {
                out.findings.extend(contradiction(a, b));
            }
            out.coefficients.extend(coefficient_rows(a, b));
            out.joint.push(joint(a, b));
        }
    }
    out.findings.extend(differing_constants(all));
    predict_forces(all, &mut out);
    out
}

fn label(n: &Named<'_>, other: &Named<'_>) -> String {
    if n.estimate.id == other.estimate.id { format!("{} ({})", n.estimate.id, n.file) } else { n.estimate.id.clone() }
}

fn coefficient_rows(a: &Named<'_>, b: &Named<'_>) -> Vec<CoefficientRow> {
    let (first, second) = (label(a, b), label(b, a));
    a.estimate
        .coefficients
        .iter()
        .filter_map(|(name, x)| b.estimate.coefficients.get(name).map(|y| (name, x, y)))
        .map(|(name, x, y)| CoefficientRow {
            model: a.estimate.model.clone(),
            coefficient: name.clone(),
            unit: x.unit.clone(),
            first: first.clone(),
            second: second.clone(),
            value_first: x.value,
            value_second: y.value,
            e_n: e_n(x, y, &first, &second),
        })
        .collect()
}

/// Expanded (95 %) uncertainty of a coefficient, if it states one.
fn expanded(c: &Coefficient) -> Option<f64> {
    let standard = c.standard_uncertainty?;
    Some(standard * c.effective_dof.map_or(1.959_963_984_540_054, coverage_factor))
}

fn e_n(x: &Coefficient, y: &Coefficient, first: &str, second: &str) -> Result<f64, String> {
    if x.unit != y.unit {
        return Err(format!("units differ: {} and {}", x.unit, y.unit));
    }
    let (Some(a), Some(b)) = (x.value, y.value) else { return Err("undetermined".to_owned()) };
    let without: Vec<&str> =
        [(x, first), (y, second)].into_iter().filter(|(c, _)| expanded(c).is_none()).map(|(_, id)| id).collect();
    if !without.is_empty() {
        return Err(format!("no uncertainty stated by {}", without.join(" and ")));
    }
    let u = expanded(x).unwrap_or(f64::NAN).hypot(expanded(y).unwrap_or(f64::NAN));
    if u > 0.0 { Ok((a - b) / u) } else { Err("both uncertainties are zero".to_owned()) }
}

/// χ² = dᵀ(C_a + C_b)⁻¹d over the coefficients that both estimate, for independent sources.
fn joint(a: &Named<'_>, b: &Named<'_>) -> JointRow {
    let (first, second) = (label(a, b), label(b, a));
    let result = (|| {
        let (Some(ca), Some(cb)) = (&a.estimate.covariance, &b.estimate.covariance) else {
            let without: Vec<&str> =
                [(&a.estimate.covariance, first.as_str()), (&b.estimate.covariance, second.as_str())]
                    .into_iter()
                    .filter(|(c, _)| c.is_none())
                    .map(|(_, id)| id)
                    .collect();
            return Err(format!("no uncertainty stated by {}", without.join(" and ")));
        };
        let names: Vec<&String> = ca.names.iter().filter(|n| cb.names.contains(n)).collect();
        if names.is_empty() {
            return Err("no coefficient is estimated by both".to_owned());
        }
        let value = |e: &Estimate, n: &str| e.coefficients.get(n).and_then(|c| c.value).unwrap_or(f64::NAN);
        let at = |c: &froude_records::estimate::Covariance, p: &str, q: &str| {
            let i = c.names.iter().position(|n| n == p);
            let j = c.names.iter().position(|n| n == q);
            i.zip(j).and_then(|(i, j)| c.matrix.get(i).and_then(|r| r.get(j)).copied()).unwrap_or(f64::NAN)
        };
        let m = names.len();
        let sum = Mat::from_fn(m, m, |i, j| at(ca, names[i], names[j]) + at(cb, names[i], names[j]));
        // Scaled to unit diagonal: the coefficients' sizes differ by orders of magnitude.
        let scale: Vec<f64> = (0..m).map(|i| sum[(i, i)].sqrt()).collect();
        let correlation = Mat::from_fn(m, m, |i, j| sum[(i, j)] / (scale[i] * scale[j]));
        let d = Mat::from_fn(m, 1, |i, _| (value(a.estimate, names[i]) - value(b.estimate, names[i])) / scale[i]);
        let solved = correlation
            .llt(faer::Side::Lower)
            .map_err(|_| "the joint covariance is not positive definite".to_owned())?
            .solve(&d);
        let chi2: f64 = (0..m).map(|i| d[(i, 0)] * solved[(i, 0)]).sum();
        if !chi2.is_finite() {
            return Err("a covariance is not finite".to_owned());
        }
        let p = ChiSquared::new(m as f64).map_or(f64::NAN, |x| x.sf(chi2));
        Ok((chi2, m, p))
    })();
    JointRow { model: a.estimate.model.clone(), first, second, result }
}

/// Two records of the same source and model that say different things, with what looks like a slip.
fn contradiction(a: &Named<'_>, b: &Named<'_>) -> Option<Finding> {
    let value = |n: &Named<'_>, name: &str| n.estimate.coefficients.get(name).and_then(|c| c.value);
    let differing: Vec<(&String, f64, f64)> = a
        .estimate
        .coefficients
        .keys()
        .filter_map(|name| Some((name, value(a, name)?, value(b, name)?)))
        .filter(|(_, x, y)| (x - y).abs() > 1e-9 * x.abs().max(y.abs()))
        .collect();
    if differing.is_empty() {
        return None;
    }
    let mut slips = Vec::new();
    for (i, (p, p_a, p_b)) in differing.iter().enumerate() {
        for (q, q_a, q_b) in &differing[i + 1..] {
            if p_a == q_b && q_a == p_b {
                slips.push(format!("the values of {p} and {q} are exchanged ({p_a} and {q_a})"));
            }
        }
        if digits_exchanged(*p_a, *p_b) {
            slips.push(format!("{p}: {p_a} and {p_b} differ by two exchanged digits"));
        }
    }
    let list: Vec<String> = differing.iter().map(|(n, x, y)| format!("{n} {x} against {y}")).collect();
    let slips = if slips.is_empty() { String::new() } else { format!("; {}", slips.join("; ")) };
    Some(
        Finding::new(
            Severity::Error,
            "contradiction",
            format!(
                "{} states different values for the same fit in {} and {}: {}{slips}",
                a.estimate.id,
                a.file,
                b.file,
                list.join(", ")
            ),
        )
        .of_source(&a.estimate.source),
    )
}

/// True where the decimal digits of two numbers differ by one exchange of two digits.
fn digits_exchanged(a: f64, b: f64) -> bool {
    let (x, y) = (format!("{a}"), format!("{b}"));
    let (x, y) = (x.as_bytes(), y.as_bytes());
    if x.len() != y.len() {
        return false;
    }
    let wrong: Vec<usize> = (0..x.len()).filter(|&i| x[i] != y[i]).collect();
    matches!(wrong.as_slice(), [i, j] if x[*i] == y[*j] && x[*j] == y[*i])
}

/// Geometry or density that differ between estimates of one model: coefficients then mean different things.
fn differing_constants(all: &[Named<'_>]) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            if a.estimate.model != b.estimate.model {
                continue;
            }
            for (key, x) in &a.estimate.geometry {
                if let Some(y) = b.estimate.geometry.get(key)
                    && (x.value - y.value).abs() > 1e-9 * x.value.abs()
                {
                    out.push(Finding::new(
                        Severity::Warning,
                        "geometry-differs",
                        format!(
                            "{} and {} refer to different bodies ({key} {} {} and {} {}): compare their forces, not their coefficients",
                            a.estimate.id, b.estimate.id, x.value, x.unit, y.value, y.unit
                        ),
                    ));
                }
            }
        }
    }
    out
}

/// Forces by the recommended estimates over the common range of speed and angle.
fn predict_forces(all: &[Named<'_>], out: &mut Comparison) {
    let recommended: Vec<&Named<'_>> = all.iter().filter(|n| n.estimate.recommended).collect();
    let chosen: Vec<&Named<'_>> = if recommended.len() >= 2 { recommended } else { all.iter().collect() };
    let range = |name: &str| -> Option<Range> {
        let stated: Vec<&Range> = chosen.iter().filter_map(|n| n.estimate.validity.get(name)).collect();
        let first = stated.first()?;
        Some(Range {
            low: stated.iter().map(|r| r.low).fold(f64::NEG_INFINITY, f64::max),
            high: stated.iter().map(|r| r.high).fold(f64::INFINITY, f64::min),
            unit: first.unit.clone(),
        })
    };
    let Some(speed) = range("speed") else { return };
    let angle = range("angle").unwrap_or(Range { low: 0.0, high: 0.0, unit: "rad".to_owned() });
    if speed.low > speed.high || angle.low > angle.high {
        out.findings.push(Finding::new(
            Severity::Warning,
            "no-common-range",
            "the fitted ranges of speed or angle do not overlap: no force can be compared without extrapolation"
                .to_owned(),
        ));
        return;
    }
    for n in &chosen {
        if !n.estimate.validity.contains_key("speed") {
            out.findings.push(
                Finding::new(
                    Severity::Note,
                    "range-not-stated",
                    format!(
                        "{} states no range of speed and angle: whether its forces are extrapolated is not known",
                        n.estimate.id
                    ),
                )
                .of_source(&n.estimate.source),
            );
        }
    }
    let links = range("n_links").filter(|r| r.low <= r.high);
    let links: Vec<f64> =
        links.map_or_else(|| vec![1.0], |r| if r.low == r.high { vec![r.low] } else { vec![r.low, r.high] });
    let data = operating_points(
        &speed,
        &angle,
        &links,
        chosen.first().and_then(|n| n.estimate.density.as_ref()).map_or(1000.0, |d| d.value),
    );
    let mut predictions = Vec::new();
    for n in &chosen {
        let Ok(law) = ForceLaw::of_estimate(n.estimate, &data) else { continue };
        let values: Option<Vec<f64>> =
            law.coefficients.iter().map(|c| n.estimate.coefficients.get(&c.name)?.value).collect();
        let Some(values) = values else { continue };
        let (Ok(force), Ok(slopes)) = (law.predict(&data, &values), law.regressors(&data, &values)) else { continue };
        let id = if chosen.iter().filter(|m| m.estimate.id == n.estimate.id).count() > 1 {
            format!("{} ({})", n.estimate.id, n.file)
        } else {
            n.estimate.id.clone()
        };
        out.force_ids.push(id);
        predictions.push((law, force, slopes, n.estimate));
    }
    if predictions.len() < 2 {
        out.force_ids.clear();
        return;
    }
    for component in ["f_x", "f_y"] {
        for i in 0..data.rows {
            let forces: Vec<(f64, Option<f64>)> = predictions
                .iter()
                .map(|(law, force, slopes, estimate)| {
                    let Some(r) = law.responses.iter().position(|n| n == component) else { return (f64::NAN, None) };
                    let row = r * data.rows + i;
                    (force[row], prediction_std(law, slopes, row, estimate))
                })
                .collect();
            if forces.iter().any(|(f, _)| f.is_finite()) {
                out.forces.push(ForceRow {
                    component: component.to_owned(),
                    n_links: data.values("n_links").map_or(1.0, |v| v[i]),
                    speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                    angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                    forces,
                });
            }
        }
    }
}

fn prediction_std(law: &ForceLaw, slopes: &Mat<f64>, row: usize, estimate: &Estimate) -> Option<f64> {
    let covariance = estimate.covariance.as_ref()?;
    let places: Vec<Option<usize>> = covariance.names.iter().map(|n| law.position(n)).collect();
    let mut variance = 0.0;
    for (a, i) in places.iter().enumerate() {
        for (b, j) in places.iter().enumerate() {
            if let (Some(i), Some(j)) = (i, j) {
                variance += slopes[(row, *i)] * slopes[(row, *j)] * covariance.matrix.get(a)?.get(b)?;
            }
        }
    }
    Some(variance.max(0.0).sqrt())
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
    data.put("f_x", vec![0.0; rows], Dimension::FORCE);
    data.put("f_y", vec![0.0; rows], Dimension::FORCE);
    data.velocity_from_speed_and_angle();
    data
}
