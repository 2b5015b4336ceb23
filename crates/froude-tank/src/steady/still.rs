//! Still runs: the zero of runs that log no part at rest, from what the cell showed before and after them.

use froude_identify::method::MethodError;
use froude_records::run::Role;
use froude_records::units::Dimension;

use super::channels::LOADS;
use super::point::{Run, Zero};
use super::section::SteadySpec;
use crate::conditioning::stretches::still_part;
use crate::error::TankError;
use crate::log::TankLog;
use crate::logs;

/// A still run: when it was, and its mean loads.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Still {
    at_s: f64,
    loads: Vec<(String, Zero)>,
}

/// The still runs, in the order in which they were.
pub(super) fn stills(logs: &[TankLog]) -> Result<Vec<Still>, MethodError> {
    let mut out = Vec::new();
    for log in logs.iter().filter(|log| log.log.meta.role == Role::Still) {
        let at_s = logs::condition(log, "at", Dimension::TIME)?.ok_or_else(|| {
            MethodError::input(
                &log.log.path,
                "a still run states when it was: write [conditions] at = \"0 s\" in its sidecar, counted from the same moment as those of the tests",
            )
        })?;
        let step_s = log.steps.median_s;
        let rows = still_part(log)?;
        let of = |name: &str| {
            let mean = log.log.channels.get(name).map(|c| froude_fit::series::mean(&c.values[rows.clone()], step_s));
            mean.map(|m| (name.to_owned(), Zero { value: m.value, standard: m.standard }))
        };
        out.push(Still { at_s, loads: LOADS.iter().filter_map(|load| of(load.name)).collect() });
    }
    out.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    Ok(out)
}

/// The zero of a run that was at `at_s`, from the still runs before and after it; `None` where there is none.
///
/// # Errors
///
/// The nearest still run is too far away.
pub(super) fn zero(
    at_s: f64,
    run: &Run<'_>,
    stills: &[Still],
    spec: &SteadySpec,
) -> Result<Option<Vec<Zero>>, TankError> {
    let before = stills.iter().rfind(|still| still.at_s <= at_s);
    let after = stills.iter().find(|still| still.at_s > at_s);
    let away_s = [before, after].iter().flatten().map(|s| (s.at_s - at_s).abs()).fold(f64::INFINITY, f64::min);
    let drift_n = spec.drift.map_or(0.0, |drift| drift.rate_n_s * away_s);
    if let Some(drift) = spec.drift.filter(|drift| drift_n > drift.most_n) {
        let what = format!(
            "the nearest still run is {away_s:.0} s away, over which the zero may drift by {drift_n:.3e} N, and {:.3e} N is allowed; take a still run \
             nearer to it, or state a smaller drift (drift in [source.steady])",
            drift.most_n
        );
        return Err(TankError::of_run(run.id, what));
    }
    let of = |still: &Still, name: &str| still.loads.iter().find(|(n, _)| n == name).map(|(_, zero)| *zero);
    let one = |name: &str| -> Option<Zero> {
        // What drifts between, evenly in ± that.
        let unknown = drift_n / 3.0_f64.sqrt();
        match (before, after) {
            (Some(a), Some(b)) => {
                let part = (at_s - a.at_s) / (b.at_s - a.at_s);
                let (x, y) = (of(a, name)?, of(b, name)?);
                let standard = ((1.0 - part) * x.standard).hypot(part * y.standard);
                Some(Zero { value: x.value + part * (y.value - x.value), standard })
            }
            (Some(only), None) | (None, Some(only)) => {
                let zero = of(only, name)?;
                Some(Zero { standard: zero.standard.hypot(unknown), ..zero })
            }
            (None, None) => None,
        }
    };
    Ok(run.loads.iter().map(|(name, _)| one(name)).collect())
}
