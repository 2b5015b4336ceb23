//! Which drag a campaign can detect, predicted from still and dry repeats alone, before a body is mounted wet.
//!
//! Dry runs of one speed and direction differ by what will scatter the difference of wet and dry. Part of it all runs of a pair share
//! (mount, hour: standard deviation s_p), part not (s_r). One difference then scatters by √2 √(s_p² + s_r²), its mean over m differences
//! in P pairs by √2 √(s_p²/P + s_r²/m); a drag D_d v² at one speed is seen when it exceeds that times Student's t. The two parts are
//! those of a two-way layout (cells of speed and direction against pairs, no interaction); s_p = 0 where the mean square between pairs is
//! not above that of the rest, which then are pooled.
//!
//! The prediction is compared with the scatter of the wet runs: the ratio of the two variances follows Fisher's F when they agree.
//!
//! **Source.** Searle, Casella & McCulloch (1992), *Variance Components*, 4.3; Satterthwaite (1946) for the degrees of freedom of sums.

use froude_fit::distribution::{coverage_factor, f_upper};
use froude_fit::propagate::effective_dof;
use froude_fit::series::mean;
use froude_records::text::counted;

use super::run::{BodyState, DragRun, RunKind};
use super::steady::{still_windows, window};
use crate::drag::point::Point;
use crate::drag::setup::DragSetup;

/// More repeats than this are no advice.
const MOST_REPEATS: usize = 1000;

/// Prediction from dry repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Detectability {
    /// Standard deviation of one wet-minus-dry difference of window means, N.
    pub difference_n: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Standard deviation of the sensor's still windows from one side of a run to the other, N; `None` without sensor.
    pub zero_change_n: Option<f64>,
    /// Standard deviation of D_d from all differences which no pairing takes off: from what runs of one pair do not share, N s²/m², and its degrees
    /// of freedom. No wet repeats can truly scatter less.
    pub floor_n_s2_m2: (f64, f64),
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
                || format!("{MOST_REPEATS} repeats would not suffice at {slowest_planned_m_s:.3} m/s"),
                |n| format!("repeat {} at {slowest_planned_m_s:.3} m/s", counted(n, "time", "times")),
            );
            format!(
                "below {limit:.3} m/s the drag is smaller than its expanded uncertainty: tow faster or {repeat} (a repeat is one wet-minus-dry difference; \
                 a pair out and back gives two)"
            )
        })
    }
}

/// Resistance of a dry tow over its steady window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DryMean {
    /// Speed of the steady part, m/s, signed.
    pub velocity_m_s: f64,
    /// Its pair.
    pub pair: u32,
    /// Mean resistance along the motion, V: a change of friction that a pair's runs share has one sign both ways.
    pub resistance_v: f64,
}

impl DryMean {
    /// `None` for a run that is no dry tow, or without a steady window.
    #[must_use]
    pub fn of(run: &DragRun<'_>, setup: &DragSetup) -> Option<Self> {
        if run.body != BodyState::Dry || run.kind != RunKind::Tow {
            return None;
        }
        let w = window(run, setup.steady).ok()?;
        let resistance_v = run.direction * mean(w.of(run.command_v), run.step_s()).value;
        Some(Self { velocity_m_s: run.direction * run.target_speed_m_s, pair: run.pair, resistance_v })
    }
}

/// Prediction for `differences` wet-minus-dry differences at each speed, both directions together, from as many `pairs`.
///
/// `None` without two dry runs of one speed and direction.
#[must_use]
pub fn predict(means: &[DryMean], differences: usize, pairs: usize, setup: &DragSetup) -> Option<Detectability> {
    let k = setup.force_per_volt_n();
    let is_like = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (1.0 + a.abs());
    let rows: Vec<Row> = means
        .iter()
        .map(|m| Row {
            cell: means.iter().position(|o| is_like(o.velocity_m_s, m.velocity_m_s)).unwrap_or(0),
            pair: m.pair,
            value: k * m.resistance_v,
        })
        .collect();
    let scatter = Scatter::of(&rows)?;
    let (variance, dof) = scatter.of_one();
    let difference_n = (2.0 * variance).sqrt();
    let mut speeds: Vec<f64> = means.iter().map(|m| m.velocity_m_s.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    let quartic: f64 = speeds.iter().map(|v| v.powi(4)).sum();
    let pairs = pairs.max(1) as f64;
    let differences_at_each = differences.max(1) as f64;
    let (of_mean, mean_dof) = scatter.of_mean(differences_at_each, pairs);
    // Σ over the speeds of x ε over Σ x²: what pairs share does not average over speeds, the rest does.
    let squares: f64 = speeds.iter().map(|v| v * v).sum();
    let (sum, slope_dof) = scatter.of_slope(differences_at_each, pairs, squares, quartic);
    let of_slope = (2.0 * sum).sqrt() / quartic;
    let (rest, rest_dof) = scatter.squares[1];
    Some(Detectability {
        difference_n,
        dof,
        zero_change_n: None,
        differences,
        floor_n_s2_m2: ((2.0 * rest / (differences_at_each * quartic)).sqrt(), rest_dof),
        expanded_n: coverage_factor(0.95, mean_dof) * (2.0 * of_mean).sqrt(),
        smallest_n_s2_m2: coverage_factor(0.95, slope_dof) * of_slope,
    })
}

/// Root mean square change of the sensor's zero over a run, N; `None` without a sensor.
#[must_use]
pub fn zero_change(runs: &[DragRun<'_>], setup: &DragSetup) -> Option<f64> {
    let changes: Vec<f64> = runs
        .iter()
        .filter_map(|run| {
            let force = run.force_n?;
            let [before, after] = still_windows(run, setup.steady);
            let of = |w: super::run::Window| w.of(force).iter().sum::<f64>() / w.len() as f64;
            Some(of(after?) - of(before?))
        })
        .collect();
    (!changes.is_empty()).then(|| (changes.iter().map(|c| c * c).sum::<f64>() / changes.len() as f64).sqrt())
}

/// A value of a two-way layout.
#[derive(Debug, Clone, Copy)]
struct Row {
    cell: usize,
    pair: u32,
    value: f64,
}

/// Variance components of repeats.
#[derive(Debug, Clone, Copy)]
struct Scatter {
    /// s_p².
    between: f64,
    /// s_r².
    within: f64,
    /// Mean squares with their degrees of freedom: between pairs (none where s_p = 0), the rest.
    squares: [(f64, f64); 2],
    cells: f64,
}

impl Scatter {
    /// `None` without two values in one cell.
    fn of(rows: &[Row]) -> Option<Self> {
        let mean = |of: &dyn Fn(&Row) -> bool, value: &dyn Fn(&Row) -> f64| {
            let (mut n, mut sum) = (0.0, 0.0);
            for r in rows.iter().filter(|r| of(r)) {
                (n, sum) = (n + 1.0, sum + value(r));
            }
            (n, sum / n)
        };
        let distinct = |mut keys: Vec<u32>| {
            keys.sort_unstable();
            keys.dedup();
            keys
        };
        let cells = distinct(rows.iter().map(|r| r.cell as u32).collect());
        let pairs = distinct(rows.iter().map(|r| r.pair).collect());
        let about_cell = |r: &Row| r.value - mean(&|o| o.cell == r.cell, &|o| o.value).1;
        let total: f64 = rows.iter().map(|r| about_cell(r).powi(2)).sum();
        let dof = rows.len() as f64 - cells.len() as f64;
        if dof < 1.0 {
            return None;
        }
        let between: f64 = pairs
            .iter()
            .map(|&p| {
                let (n, effect) = mean(&|o| o.pair == p, &about_cell);
                n * effect * effect
            })
            .sum();
        let dof_pairs = pairs.len() as f64 - 1.0;
        let dof_rest = dof - dof_pairs;
        let per_pair = rows.len() as f64 / pairs.len() as f64;
        let of_pairs = between / dof_pairs;
        let rest = (total - between) / dof_rest;
        let cells = cells.len() as f64;
        if dof_pairs >= 1.0 && dof_rest >= 1.0 && of_pairs > rest {
            let squares = [(of_pairs, dof_pairs), (rest, dof_rest)];
            return Some(Self { between: (of_pairs - rest) / per_pair, within: rest, squares, cells });
        }
        Some(Self { between: 0.0, within: total / dof, squares: [(0.0, 1.0), (total / dof, dof)], cells })
    }

    /// `a` of the mean square between pairs and `b` of the rest: their sum, and its degrees of freedom.
    fn combined(&self, a: f64, b: f64) -> (f64, f64) {
        let [(p, p_dof), (r, r_dof)] = self.squares;
        let (p, r) = (a * p, b * r);
        (p + r, effective_dof(&[(p, p_dof), (r.max(f64::MIN_POSITIVE), r_dof)]))
    }

    /// Variance of one value.
    fn of_one(&self) -> (f64, f64) {
        if self.between == 0.0 {
            return (self.within, self.squares[1].1);
        }
        self.combined(1.0 / self.cells, 1.0 - 1.0 / self.cells)
    }

    /// Variance of a mean of `count` values from so many pairs.
    fn of_mean(&self, count: f64, pairs: f64) -> (f64, f64) {
        if self.between == 0.0 {
            return (self.within / count, self.squares[1].1);
        }
        let of_pairs = 1.0 / (pairs * self.cells);
        self.combined(of_pairs, (1.0 / count - of_pairs).max(0.0))
    }

    /// Variance of Σ x ε over speeds, ε the mean of `count` values at each of them from so many pairs; Σx and Σx² given.
    fn of_slope(&self, count: f64, pairs: f64, sum: f64, squares: f64) -> (f64, f64) {
        if self.between == 0.0 {
            return (self.within * squares / count, self.squares[1].1);
        }
        let of_pairs = sum * sum / (pairs * self.cells);
        self.combined(of_pairs, (squares / count - of_pairs).max(0.0))
    }
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
    let is_like = |a: f64, b: f64| (a - b).abs() < 0.01 * a.abs().max(b.abs());
    let rows: Vec<Row> = points
        .iter()
        .map(|p| Row {
            cell: points.iter().position(|o| is_like(o.speed_m_s, p.speed_m_s)).unwrap_or(0),
            pair: p.pair,
            value: p.speed_m_s.signum() * p.force_n,
        })
        .collect();
    let (variance, dof) = Scatter::of(&rows)?.of_one();
    let on_drag = points.iter().map(|p| (setup.torque_constant_drift_relative * p.force_n).powi(2)).sum::<f64>();
    let predicted_variance = predicted.difference_n.powi(2) + on_drag / points.len() as f64;
    let ratio = variance / predicted_variance;
    let upper = f_upper(ratio, dof, predicted.dof);
    Some(Agreement {
        observed_n: variance.sqrt(),
        dof,
        predicted_n: predicted_variance.sqrt(),
        ratio,
        p: (2.0 * upper.min(1.0 - upper)).min(1.0),
    })
}
