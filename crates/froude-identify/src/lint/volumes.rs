//! Volumes of configurations that do not add up.

use froude_records::campaign::BodySpec;
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;

/// Steps of volume per link that differ by more than this from the median do not add up.
pub(crate) const VOLUME_STEP_TOLERANCE: f64 = 0.02;

/// Volumes of the configurations that do not grow by one link's volume a link.
pub(crate) fn volumes(body: &BodySpec) -> Vec<Finding> {
    let mut points: Vec<(f64, f64)> = body
        .volumes
        .iter()
        .filter_map(|(name, v)| froude_records::table::links_of_configuration(name).map(|k| (f64::from(k), *v)))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    volume_steps(&points, body.link_volume_m3)
}

/// The same for a `volume` channel of the table.
pub(crate) fn volume_channel(data: &Dataset, link_m3: Option<f64>) -> Vec<Finding> {
    let (Some(k), Some(v)) = (data.values("n_links"), data.values("volume")) else { return Vec::new() };
    let mut points: Vec<(f64, f64)> = k.iter().copied().zip(v.iter().copied()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup();
    volume_steps(&points, link_m3)
}

/// Steps of volume between configurations against their median and the stated link.
pub(crate) fn volume_steps(points: &[(f64, f64)], link_m3: Option<f64>) -> Vec<Finding> {
    let steps: Vec<(f64, f64)> = points
        .windows(2)
        .filter(|w| w[1].0 > w[0].0)
        .map(|w| (w[1].0, (w[1].1 - w[0].1) / (w[1].0 - w[0].0)))
        .collect();
    if steps.len() < 3 {
        return Vec::new();
    }
    let mut sorted: Vec<f64> = steps.iter().map(|s| s.1).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let mut findings = Vec::new();
    let odd: Vec<String> = steps
        .iter()
        .filter(|(_, step)| (step - median).abs() > VOLUME_STEP_TOLERANCE * median.abs())
        .map(|(k, step)| format!("{step:.4e} m^3 to {k} links"))
        .collect();
    if !odd.is_empty() {
        findings.push(Finding::new(
            Severity::Warning,
            "volumes-do-not-add-up",
            format!(
                "the volume grows by {median:.4e} m^3 per link (median), but by {}: these configurations are not the same body with one more link",
                odd.join(", ")
            ),
        ));
    }
    if let Some(link) = link_m3
        && (link - median).abs() > VOLUME_STEP_TOLERANCE * median
    {
        findings.push(Finding::new(
            Severity::Warning,
            "link-volume",
            format!(
                "a link displaces {link:.4e} m^3 on its own, but the body grows by {median:.4e} m^3 per link: joints overlap, \
                 or the coefficient's reference volume is not the link's"
            ),
        ));
    }
    findings
}
