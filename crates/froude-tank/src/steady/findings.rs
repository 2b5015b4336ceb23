//! What a run shows: a load that changes over its window, a zero that moves, a window that a person has named.

use froude_records::finding::{Finding, Severity};
use froude_records::run::marks::SegmentKind;

use super::point::{Point, Run};
use super::section::SteadySpec;
use crate::findings::{note, warning};
use crate::log::TankLog;

/// A drift of the zero this many of its standard uncertainties is none of chance.
const DRIFTS: f64 = 4.0;

/// Whether a window that a person has named is steady by the rule.
pub(super) fn of_named_window(log: &TankLog, run: &Run<'_>, point: &Point, spec: &SteadySpec) -> Option<Finding> {
    let segment = log.declared.segments.iter().find(|segment| segment.kind == SegmentKind::Steady)?;
    let (rows, time_s) = (point.window.steady.clone(), run.time_s);
    let block = ((spec.block_s / log.steps.median_s).round() as usize).clamp(1, rows.len());
    let speeds = (rows.start..=rows.end - block).step_by(block).map(|at| run.motion.mean_m_s(time_s, at..at + block));
    let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let who = if segment.by.is_empty() { "somebody" } else { &segment.by };
    let (text, severity, code) = if half > spec.tolerance * middle.abs() {
        let text = format!(
            "the speed of its blocks of {} s differs by ± {:.2} % of {middle:.4} m/s, and {:.2} % is steady by the rule; it is used as it was named",
            spec.block_s,
            1e2 * half / middle.abs(),
            1e2 * spec.tolerance
        );
        (text, Severity::Warning, "named-window-not-steady")
    } else {
        ("it is steady by the rule too".to_owned(), Severity::Note, "named-window")
    };
    let id = &log.log.meta.id;
    let text = format!(
        "run {id:?}: its window from {:.3} s to {:.3} s was named by {who}; {text}",
        segment.from_s, segment.to_s
    );
    Some(Finding::new(severity, code, text))
}

/// What one observation shows.
pub(super) fn of_point(run: &str, point: &Point) -> Vec<Finding> {
    let mut out = Vec::new();
    for load in &point.loads {
        let unit = if load.name.starts_with('m') { "N m" } else { "N" };
        if load.read.has_trend() {
            out.push(warning("load-not-steady",
                format!(
                    "run {run:?}: {} changes by {:.3e} ± {:.1e} {unit} over its window: the water has not settled, or the zero drifts; settle longer, or wait longer before \
                     the run",
                    load.name, load.read.trend, load.read.trend_standard
                ),
            ));
        }
        if let Some([drift, standard]) = load.drift.filter(|[d, s]| d.abs() > DRIFTS * s) {
            out.push(note("zero-drift",
                format!(
                    "run {run:?}: the zero of {} moves by {drift:.3e} ± {standard:.1e} {unit} from before to after the tow; the straight line between them is subtracted",
                    load.name
                ),
            ));
        }
    }
    out
}
