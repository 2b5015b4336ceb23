//! What drag a campaign can see, said from still and dry repeats alone, before a body is mounted wet.
//!
//! Dry runs of one speed and direction differ by what will scatter the difference of wet and dry: two such runs make a
//! variance of 2s². A drag D_d v² at one speed is seen when it exceeds its expanded uncertainty t·√2·s/√m over m
//! differences. The prediction is then held against the scatter of the wet runs: the ratio of the two variances follows
//! Fisher's F when they agree (χ² of the repeats over χ² of the repeats).

use froude_fit::distribution::{coverage_factor, f_upper};

use super::coefficient::Point;
use super::run::{BodyState, DragRun, DragSetup, RunKind};
use super::steady::{mean, still_windows, window};

/// More repeats than this are no advice.
const MOST_REPEATS: usize = 1000;

/// Prediction from dry repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Detectability {
    /// Standard deviation of one wet-less-dry difference of window means, N.
    pub difference_n: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Standard deviation of the sensor's still windows from one side of a run to the other, N; `None` without sensor.
    pub zero_change_n: Option<f64>,
    /// Differences at each speed that the campaign has or plans.
    pub differences: usize,
    /// Expanded uncertainty (95 %) of the drag at one speed from these, N.
    pub expanded_n: f64,
    /// Smallest D_d that exceeds its expanded uncertainty over all speeds, N s²/m²; scatter only.
    pub smallest_n_s2_m2: f64,
}

impl Detectability {
    /// Slowest speed at which a drag D_d v² exceeds its expanded uncertainty, m/s.
    #[must_use]
    pub fn slowest_m_s(&self, d_n_s2_m2: f64) -> f64 {
        (self.expanded_n / d_n_s2_m2.abs()).sqrt()
    }

    /// Differences needed at a speed until its drag exceeds its expanded uncertainty; `None` beyond 1000.
    #[must_use]
    pub fn repeats_needed(&self, d_n_s2_m2: f64, speed_m_s: f64) -> Option<usize> {
        let drag_n = d_n_s2_m2.abs() * speed_m_s * speed_m_s;
        let coverage = coverage_factor(0.95, self.dof);
        let needed = (coverage * self.difference_n / drag_n).powi(2).ceil();
        (needed <= MOST_REPEATS as f64).then_some(needed.max(1.0) as usize)
    }

    /// The sentence for the operator, for the slowest speed of the campaign; `None` when that is seen.
    #[must_use]
    pub fn advice(&self, d_n_s2_m2: f64, slowest_planned_m_s: f64) -> Option<String> {
        let limit = self.slowest_m_s(d_n_s2_m2);
        (slowest_planned_m_s < limit).then(|| {
            let repeats = self.repeats_needed(d_n_s2_m2, slowest_planned_m_s);
            let repeat = repeats.map_or_else(
                || format!("{MOST_REPEATS} repeats would not do at {slowest_planned_m_s:.3} m/s"),
                |n| format!("repeat {n} times at {slowest_planned_m_s:.3} m/s"),
            );
            format!("below {limit:.3} m/s your drag is under its uncertainty: tow faster or {repeat}")
        })
    }
}

/// Prediction for `differences` wet-less-dry differences at each of the dry runs' speeds and directions together.
///
/// `None` without two dry runs of one speed and direction.
#[must_use]
pub fn predict(runs: &[DragRun<'_>], differences: usize, setup: &DragSetup) -> Option<Detectability> {
    let k = setup.force_per_volt_n();
    let dry: Vec<&DragRun<'_>> = runs.iter().filter(|r| r.body == BodyState::Dry && r.kind == RunKind::Tow).collect();
    let means: Vec<(&DragRun<'_>, f64)> = dry
        .iter()
        .filter_map(|r| window(r, setup.steady).ok().map(|w| (*r, k * mean(w.of(r.command_v), r.step_s()).value)))
        .collect();
    let (sum, dof) = pooled(&means, |a, b| a.is_like(b));
    if dof < 1.0 {
        return None;
    }
    let difference_n = (2.0 * sum / dof).sqrt();
    let mut speeds: Vec<f64> = means.iter().map(|m| m.0.target_speed_m_s).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let quartic: f64 = speeds.iter().map(|v| v.powi(4)).sum();
    let coverage = coverage_factor(0.95, dof);
    let count = differences.max(1) as f64;
    Some(Detectability {
        difference_n,
        dof,
        zero_change_n: zero_change(runs, setup),
        differences,
        expanded_n: coverage * difference_n / count.sqrt(),
        smallest_n_s2_m2: coverage * difference_n / (count * quartic).sqrt(),
    })
}

/// Root mean square change of the sensor's zero over a run, N.
fn zero_change(runs: &[DragRun<'_>], setup: &DragSetup) -> Option<f64> {
    let changes: Vec<f64> = runs
        .iter()
        .filter_map(|run| {
            let force = run.force_n?;
            let [before, after] = still_windows(run, setup.steady);
            let of = |w: super::steady::Window| w.of(force).iter().sum::<f64>() / w.len() as f64;
            Some(of(after?) - of(before?))
        })
        .collect();
    (!changes.is_empty()).then(|| (changes.iter().map(|c| c * c).sum::<f64>() / changes.len() as f64).sqrt())
}

/// Sum of squares about the mean of each group, and its degrees of freedom.
fn pooled<T>(values: &[(T, f64)], is_same: impl Fn(&T, &T) -> bool) -> (f64, f64) {
    let mut is_done = vec![false; values.len()];
    let (mut sum, mut dof) = (0.0, 0.0);
    for i in 0..values.len() {
        if is_done[i] {
            continue;
        }
        let group: Vec<usize> = (i..values.len()).filter(|&j| is_same(&values[i].0, &values[j].0)).collect();
        let mean = group.iter().map(|&j| values[j].1).sum::<f64>() / group.len() as f64;
        for &j in &group {
            is_done[j] = true;
            sum += (values[j].1 - mean).powi(2);
        }
        dof += group.len() as f64 - 1.0;
    }
    (sum, dof)
}

/// Scatter that the wet runs show, against the prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Standard deviation of one difference at one speed, as the wet repeats show it, N.
    pub observed_n: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// The same as predicted: dry repeats, and the declared drift of K_T on the drag itself, N.
    pub predicted_n: f64,
    /// Observed over predicted variance.
    pub ratio: f64,
    /// Two-sided probability of a ratio as far from one, if they agree.
    pub p: f64,
}

impl Agreement {
    /// Whether prediction and wet repeats agree (the ratio lies in its 95 % band).
    #[must_use]
    pub fn is_within_band(&self) -> bool {
        self.p > 0.05
    }
}

/// Holds the scatter of motor current differences against the prediction; `None` without repeats.
#[must_use]
pub fn agreement(points: &[Point], predicted: &Detectability, setup: &DragSetup) -> Option<Agreement> {
    let values: Vec<(f64, f64)> = points.iter().map(|p| (p.speed_m_s, p.force_n)).collect();
    let (sum, dof) = pooled(&values, |a, b| (a - b).abs() < 0.01 * a.abs().max(b.abs()));
    if dof < 1.0 {
        return None;
    }
    let on_drag = points.iter().map(|p| (setup.torque_constant_drift_relative * p.force_n).powi(2)).sum::<f64>();
    let predicted_variance = predicted.difference_n.powi(2) + on_drag / points.len() as f64;
    let ratio = sum / dof / predicted_variance;
    let upper = f_upper(ratio, dof, predicted.dof);
    Some(Agreement {
        observed_n: (sum / dof).sqrt(),
        dof,
        predicted_n: predicted_variance.sqrt(),
        ratio,
        p: (2.0 * upper.min(1.0 - upper)).min(1.0),
    })
}
