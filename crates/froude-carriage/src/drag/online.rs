//! D_d while the campaign runs, and when it may stop.
//!
//! Every look is the whole reduction of the differences so far, with the whole budget: an interval without the errors that all runs
//! share (efficiency, calibration, buoyancy) would stop a campaign without information. Looking after every pair and stopping at the first
//! interval that is short enough is sequential testing: the interval that stops a campaign is one that chance made short. Two things hold
//! against it: looks only after whole pairs, from the third on, and Bonferroni over the looks that are planned
//! ([`DragSetup::looks`]), so that all intervals shown cover together with 95 %. The price is some 40 % of width over ten looks. After an
//! early stop, quote the interval shown here; the report does.

use froude_fit::budget::{Part, combine};
use froude_fit::propagate::expanded;

use super::coefficient::Coefficient;
use super::detectability::{DryMean, predict};
use crate::drag::differences::of_differences;
use crate::drag::point::{Point, pairs};
use crate::drag::setup::DragSetup;

/// Fewest whole pairs to look at: two have one degree of freedom, and an interval of chance.
pub const FEWEST_PAIRS: usize = 3;

/// The estimator.
#[derive(Debug, Clone, PartialEq)]
pub struct OnLine {
    points: Vec<Point>,
    dry: Vec<DryMean>,
    /// Differences at each speed that one pair gives.
    per_pair: usize,
    target_relative: f64,
}

/// What the display shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// D_d so far, N s²/m².
    pub value: f64,
    /// Half-width of its interval (the longer arm), Bonferroni over the planned looks; `None` before two pairs.
    pub half_width: Option<f64>,
    /// The half-width to reach, N s²/m².
    pub target: f64,
    /// Half-width that no number of pairs goes below, from what all of them share, N s²/m².
    pub floor: f64,
    /// Pairs seen.
    pub pairs: usize,
    /// Whether the campaign may stop: half-width at or below the target.
    pub may_stop: bool,
    /// Pairs that will do, if the scatter stays; `None` where the shared errors alone are wider than the target.
    pub pairs_needed: Option<usize>,
}

impl OnLine {
    /// A fresh estimator: the relative half-width to reach, and how many differences at each speed one pair gives (one, or two for
    /// runs out and back).
    #[must_use]
    pub fn new(target_relative: f64, per_pair: usize) -> Self {
        Self { points: Vec::new(), dry: Vec::new(), per_pair: per_pair.max(1), target_relative }
    }

    /// Takes the mean of a dry tow: what scatter to expect at least.
    pub fn push_dry(&mut self, mean: DryMean) {
        self.dry.push(mean);
    }

    /// The differences so far.
    #[cfg(test)]
    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    /// Takes one steady difference, in newtons of the setup of the next look.
    pub fn push(&mut self, point: Point) {
        self.points.push(point);
    }

    /// Where the estimate stands; to be asked after whole pairs, with the number of planned pairs as the setup's looks. `None` before
    /// the first moving point.
    #[must_use]
    pub fn status(&self, setup: &DragSetup) -> Option<Status> {
        let n = pairs(&self.points).len();
        let promised = predict(&self.dry, n * self.per_pair, n, setup);
        let c = of_differences(self.points.clone(), promised.as_ref(), setup).ok()??;
        let target = self.target_relative * c.value.abs();
        // One pair alone has an interval of its runs about the law, which is none of repeats.
        let half_width = c.interval_95.filter(|_| n > 1).map(|[low, high]| (high - c.value).max(c.value - low));
        Some(Status {
            value: c.value,
            half_width,
            target,
            floor: floor(&c, setup),
            pairs: n,
            may_stop: n >= FEWEST_PAIRS && half_width.is_some_and(|h| h <= target),
            pairs_needed: pairs_needed(&c, n, target, setup),
        })
    }
}

/// That of one look, so that all planned ones hold together with 95 %.
fn confidence(setup: &DragSetup) -> f64 {
    1.0 - 0.05 / setup.looks.max(1) as f64
}

/// The longer arm that the errors which all pairs share have alone.
fn floor(c: &Coefficient, setup: &DragSetup) -> f64 {
    let is_shared = |part: &&Part| part.kind.is_type_b() && !part.in_scatter;
    let shared: Vec<Part> = c.budget.iter().filter(is_shared).cloned().collect();
    let [low, high] = combine(&shared, 0, 1.0 - confidence(setup)).arms;
    low.max(high)
}

/// Pairs until the half-width is at the target, with the scatter of now and the shared errors as they are.
fn pairs_needed(c: &Coefficient, n: usize, target: f64, setup: &DragSetup) -> Option<usize> {
    let of_one = c.type_a? * (n as f64).sqrt();
    let shared = (c.type_b * c.type_b, f64::INFINITY);
    (FEWEST_PAIRS.max(n)..=10 * setup.looks.max(n)).find(|&m| {
        let scatter = (of_one * of_one / m as f64, m as f64 - 1.0);
        expanded(&[scatter, shared], confidence(setup)).expanded <= target
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::point::slope;
    use crate::drag::setup::Efficiency;
    use froude_fit::budget::Uncertain;

    fn point(pair: u32, v: f64, force_n: f64) -> Point {
        Point {
            run: String::new(),
            speed_m_s: v,
            force_n,
            standard_n: 0.01,
            effective_n: 10.0,
            pair,
            position_m: [0.0, 1.0],
            trend_n: None,
        }
    }

    /// Force per volt known to a part, five looks.
    fn setup(relative: f64) -> DragSetup {
        let calibration = Some(Uncertain::new(4.8, 4.8 * relative));
        DragSetup { calibration, looks: 5, ..DragSetup::of_the_paper() }
    }

    fn after(points: &[Point], target: f64, setup: &DragSetup) -> Status {
        let mut live = OnLine::new(target, 2);
        for p in points {
            live.push(p.clone());
        }
        live.status(setup).unwrap()
    }

    #[test]
    fn pairs_that_agree_stop_the_campaign_and_give_the_slope_of_all_points() {
        let points: Vec<Point> = (0..5)
            .flat_map(|k| [0.15, 0.35, -0.55].map(|v: f64| point(k, v, (20.0 + 0.1 * f64::from(k)) * v * v.abs())))
            .collect();
        let status = after(&points, 0.025, &setup(0.005));
        assert!((status.value - slope(&points).unwrap()).abs() < 1e-12);
        assert!(status.may_stop, "{status:?}");
    }

    #[test]
    fn two_pairs_that_agree_by_chance_do_not_stop_the_campaign() {
        let status = after(&[point(0, 0.5, 5.0), point(1, 0.5, 5.0)], 0.025, &setup(0.005));
        assert!(!status.may_stop && status.half_width.unwrap() / status.value < 0.025, "{status:?}");
    }

    /// Five pairs that agree to the last digit, and a gear of which nobody knows more than that it takes up to 40 %.
    #[test]
    fn what_all_runs_share_keeps_the_campaign_from_stopping() {
        let points: Vec<Point> = (0..5).map(|k| point(k, 0.5, 5.0 + 0.001 * f64::from(k))).collect();
        let unknown = DragSetup { calibration: None, efficiency: Efficiency::Undeclared, ..setup(0.0) };
        let status = after(&points, 0.025, &unknown);
        assert!(!status.may_stop && status.half_width.unwrap() > 0.3 * status.value, "{status:?}");
        assert_eq!(after(&points, 0.005, &setup(0.005)).pairs_needed, None);
    }
}
