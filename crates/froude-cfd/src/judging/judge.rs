//! Whether a case may be believed: judged on its forces, not on its residuals.
//!
//! Half of all steady cases settle in a small cycle and never bring their residuals down; others bring them down and then blow up far from the body with forces that look sound. So the mean force must stand still from one half of a window to the other, the largest speed must stay within three times the body's (more at a flat one), and residuals must not rise by a power of ten above where they were.
//!
//! | found | status |
//! | --- | --- |
//! | drift and spread within the case's limits | converged |
//! | drift within, spread beyond; or to and fro about a mean that stands still | oscillating |
//! | drift beyond at the last iteration, and at most 1 % of ½ρU²A | oscillating, what it still has to go being its error |
//! | drift beyond that, residuals that rise, a speed beyond 3 U, forces that are no numbers, a floating-point trap | diverged |
//! | an error of the solver, or fewer iterations than the window | failed |

use crate::case::{Case, Stop};
use crate::history::Sample;
use crate::openfoam::End;
use crate::outcome::{Loads, Status};
use crate::solver_log::{Fastest, SolverLog};
use crate::window::Window;

/// Speeds beyond this many times the body's are none of water, whatever the body: potential flow reaches 1 + a/b at an ellipse across the flow, 2.5 at one of 1.5 to 1.
const LARGEST_SPEED: f64 = 3.0;
/// At a flatter body, those beyond so many times what potential flow reaches.
const BEYOND_POTENTIAL: f64 = 1.2;
/// Residuals this many times as high as they were rise.
const RISE: f64 = 10.0;
/// Drift over ½ρU²A that a case which has done all its iterations may still have: a wake that goes over from one state to another does so for thousands of them.
const SLOW: f64 = 0.01;
/// An oscillation has this many windows to die down before its case is ended.
const PATIENCE: usize = 3;

/// All that a case is judged on.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// Loads of its iterations.
    pub samples: &'a [Sample],
    /// The solver's log.
    pub log: &'a SolverLog,
    /// Largest speeds in the field.
    pub fastest: &'a [Fastest],
    /// How the solver ended.
    pub end: End,
    /// Iteration that it was to end at.
    pub until: usize,
}

/// What a case came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// How it ended.
    pub status: Status,
    /// Why, in words with numbers.
    pub reason: String,
    /// Whether more iterations would not change it.
    pub is_final: bool,
    /// The window that its loads are the means of.
    pub window: Option<Window>,
}

/// Judges a case.
#[must_use]
pub fn judge(case: &Case, evidence: Evidence) -> Judgement {
    let samples = evidence.samples;
    let iterations = samples.len();
    let without_loads = |status, is_final, reason| Judgement { status, reason, is_final, window: None };
    match (evidence.end, &evidence.log.fatal) {
        (End::Code(_), Some(fatal)) => {
            let advice = if fatal.contains("error in IOstream") { "; is the disk full?" } else { "" };
            return without_loads(Status::Failed, true, format!("the solver ended with the error: {fatal}{advice}"));
        }
        (End::Code(code), None) => {
            let how = if code < 0 {
                format!("was ended by the signal {}", -code)
            } else {
                format!("ended with the code {code} and no word why")
            };
            return without_loads(Status::Failed, true, format!("the solver {how}"));
        }
        (End::Whole | End::FloatingPoint, _) => {}
    }
    let window = case.stop.window.max(4);
    let with_loads = |status, is_final, reason, window| Judgement { status, reason, is_final, window: Some(window) };
    if let Some((reason, is_final)) = growth(case, &evidence) {
        let found = Window::of(samples, window);
        return if found.mean.iter().all(|load| load.is_finite()) {
            with_loads(Status::Diverged, is_final, reason, found)
        } else {
            without_loads(Status::Diverged, is_final, reason)
        };
    }
    if evidence.end == End::Whole && iterations < evidence.until {
        let reason = format!(
            "the solver ended without a word, and forces of {iterations} iterations are there where it was to do {}; is the disk full?",
            evidence.until
        );
        return without_loads(Status::Failed, true, reason);
    }
    if iterations < window {
        let reason = format!("it has forces of {iterations} iterations, and {window} are needed to judge it");
        return without_loads(Status::Failed, false, reason);
    }

    let scales = case.load_scales();
    let (standing, found) = standing(case.stop, &scales, samples);
    let (drift, spread) = (largest(&scales, &found.drift, &|_| true), largest(&scales, &found.spread, &|_| true));
    let words = format!(
        "over {} iterations the mean force changes by {drift:.1e} of ½ρU²A and a force is at most {spread:.1e} from it",
        found.length
    );
    match standing {
        Standing::Still => with_loads(Status::Converged, true, words, found),
        Standing::Swings => with_loads(Status::Oscillating, iterations >= PATIENCE * found.length, words, found),
        Standing::Drifts if drift <= SLOW && iterations >= case.stop.iterations => {
            let reason = format!(
                "after {iterations} iterations, which is all, the mean force still changes by {drift:.1e} of ½ρU²A from one half of {} iterations to the other; what it still has to go is counted as its error",
                found.length
            );
            with_loads(Status::Oscillating, true, reason, found)
        }
        Standing::Drifts => {
            let reason = format!(
                "after {iterations} iterations the mean force still changes by {drift:.1e} of ½ρU²A from one half of {} iterations to the other; {:.1e} is allowed",
                found.length, case.stop.drift
            );
            with_loads(Status::Diverged, false, reason, found)
        }
    }
}

/// How forces are over a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Standing {
    Still,
    /// They swing about a mean that stands still.
    Swings,
    Drifts,
}

/// How the forces stand over `scales`, and over which window: that of `stop`, or that doubled, and doubled again, up to half of the iterations. A cycle drifts within a window shorter than its period, and is one in a window of several. The first is that of forces that drift in all of them.
pub(crate) fn standing(stop: Stop, scales: &Loads, samples: &[Sample]) -> (Standing, Window) {
    let of = |length: usize| {
        let found = Window::of(samples, length);
        let (drift, spread) = (largest(scales, &found.drift, &|_| true), largest(scales, &found.spread, &|_| true));
        let standing = if drift <= stop.drift && spread <= stop.spread {
            Standing::Still
        } else if largest(scales, &found.drift, &|load| !found.is_cycle[load]) <= stop.drift {
            Standing::Swings
        } else {
            Standing::Drifts
        };
        (standing, found)
    };
    let first = of(stop.window.max(4));
    let longer = std::iter::successors(Some(2 * first.1.length), |n| Some(2 * n));
    let mut all = std::iter::once(first).chain(longer.take_while(|n| *n > 0 && 2 * n <= samples.len()).map(of));
    all.find(|(standing, _)| *standing != Standing::Drifts).unwrap_or(first)
}

/// The window that the forces of a case were judged over; `None` where there are fewer than it takes.
#[must_use]
pub fn judged_window(case: &Case, samples: &[Sample]) -> Option<Window> {
    (samples.len() >= case.stop.window.max(4)).then(|| standing(case.stop, &case.load_scales(), samples).1)
}

/// Largest of the loads that count, each over its scale.
pub(crate) fn largest(scales: &Loads, loads: &Loads, counts: &dyn Fn(usize) -> bool) -> f64 {
    let parts = loads.iter().zip(scales).enumerate().filter(|(load, _)| counts(*load));
    parts.map(|(_, (load, scale))| load.abs() / scale).fold(0.0, f64::max)
}

/// Why its field grows without bound, and whether that is more than the wild beginning of a flow from rest.
fn growth(case: &Case, evidence: &Evidence) -> Option<(String, bool)> {
    let iterations = evidence.samples.len();
    if evidence.end == End::FloatingPoint {
        return Some((format!("a number left the range of floating point after iteration {iterations}"), true));
    }
    if let Some(sample) = evidence.samples.iter().find(|sample| !sample.total().iter().all(|load| load.is_finite())) {
        return Some((format!("its forces are no numbers at iteration {}", sample.time), true));
    }
    let has_begun = iterations >= 2 * case.stop.window;
    let half = (case.stop.window / 2).max(2);
    let most = largest_speed(case);
    let limit_m_s = most * case.flow.speed_m_s;
    let mut recent = evidence.fastest.iter().skip(evidence.fastest.len().saturating_sub(half));
    if let Some(found) = recent.find(|f| f.speed_m_s.is_nan() || f.speed_m_s > limit_m_s) {
        let reason = format!(
            "the water reaches {:.3} m/s at {} m in iteration {}, which is {:.1} times the body's speed; beyond {most:.1} is no flow",
            found.speed_m_s,
            found.place,
            found.time,
            found.speed_m_s / case.flow.speed_m_s
        );
        return Some((reason, has_begun));
    }
    let means: Vec<f64> = evidence
        .log
        .residuals
        .rchunks_exact(half)
        .map(|part| (part.iter().map(|r| r.max(f64::MIN_POSITIVE).ln()).sum::<f64>() / half as f64).exp())
        .collect();
    let (now, before) = means.split_first()?;
    let least = before.iter().copied().fold(f64::INFINITY, f64::min);
    (*now > RISE * least).then(|| {
        let reason =
            format!("residuals of the pressure rise: {now:.1e} over the last {half} iterations, and were {least:.1e}");
        (reason, has_begun)
    })
}

/// Speed over the body's that no water has.
///
/// Source: the ellipse in potential flow (Lamb, Hydrodynamics, 6th ed., art. 71): the section's height is taken as the side area over the length.
fn largest_speed(case: &Case) -> f64 {
    let flatness = case.reference.area_m2 / (case.reference.length_m * case.reference.width_m);
    LARGEST_SPEED.max(BEYOND_POTENTIAL * (1.0 + flatness.max(flatness.recip())))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::case::{Flow, Model, Reference, Stop, Water};

    /// ½ρU²A = 50 N; a window of 40 iterations.
    fn case() -> Case {
        Case {
            id: "c".to_owned(),
            configuration: "H3LT".to_owned(),
            mesh: "m".to_owned(),
            is_half: true,
            flow: Flow { speed_m_s: 1.0, angle_rad: 0.0, pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 400, window: 40, drift: 0.002, spread: 0.005 },
            reference: Reference { length_m: 1.0, width_m: 0.1, area_m2: 0.1, point_m: [0.0; 3] },
            start_from: None,
        }
    }

    fn samples(count: usize, force_n: impl Fn(f64) -> f64) -> Vec<Sample> {
        let sample = |i: usize| Sample {
            time: i as f64,
            pressure: [0.25 * force_n(i as f64), 0.0, 0.0, 0.0, 0.0, 0.0],
            viscous: [0.75 * force_n(i as f64), 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        (1..=count).map(sample).collect()
    }

    fn of(samples: &[Sample]) -> Judgement {
        let log = SolverLog::default();
        judge(&case(), Evidence { samples, log: &log, fastest: &[], end: End::Whole, until: samples.len() })
    }

    #[test]
    fn forces_that_stand_still_are_converged_with_their_mean_and_its_part_by_pressure() {
        let found = of(&samples(100, |i| -20.0 - 3.0 * (-i / 8.0).exp()));
        assert_eq!((found.status, found.is_final), (Status::Converged, true), "{}", found.reason);
        assert!((found.window.unwrap().mean[0] + 20.0).abs() < 1e-2);
        assert!((found.window.unwrap().pressure[0] + 5.0).abs() < 1e-2);
    }

    #[test]
    fn a_drift_is_allowed_up_to_its_limit_and_said_beyond_it() {
        // A ramp drifts by 20 iterations of its slope from half to half; the limit is 0.1 N.
        let ramp = |slope: f64| of(&samples(100, |i| slope * i));
        assert_eq!(ramp(0.99 * 0.1 / 20.0).status, Status::Converged);
        let beyond = ramp(1.01 * 0.1 / 20.0);
        assert_eq!((beyond.status, beyond.is_final), (Status::Diverged, false));
        assert_eq!(
            beyond.reason,
            "after 100 iterations the mean force still changes by 2.0e-3 of ½ρU²A from one half of 40 iterations to the other; 2.0e-3 is allowed"
        );
    }

    #[test]
    fn a_slow_drift_at_the_last_iteration_is_its_error() {
        // 20 iterations of the slope from half to half, of 50 N.
        let ramp = |drift: f64, count| of(&samples(count, |i| drift * 50.0 / 20.0 * i));
        let slow = ramp(0.0099, 400);
        assert_eq!((slow.status, slow.is_final), (Status::Oscillating, true), "{}", slow.reason);
        assert!(slow.window.unwrap().std_of_mean[0] > 0.0099 * 50.0, "{slow:?}");
        assert!(slow.reason.contains("after 400 iterations, which is all") && slow.reason.contains("9.9e-3"));
        // Before the last it goes on, and a faster one is none.
        assert_eq!(ramp(0.0099, 399).status, Status::Diverged);
        assert_eq!(ramp(0.0101, 400).status, Status::Diverged);
    }

    #[test]
    fn a_cycle_within_the_spread_is_converged_and_beyond_it_oscillating() {
        let cycle = |amplitude: f64, count| of(&samples(count, move |i| -20.0 + amplitude * (TAU * i / 10.0).sin()));
        assert_eq!(cycle(0.24, 100).status, Status::Converged);
        let early = cycle(0.28, 100);
        assert_eq!((early.status, early.is_final), (Status::Oscillating, false), "{}", early.reason);
        assert!(cycle(0.28, 120).is_final);
    }

    #[test]
    fn a_slow_cycle_is_judged_over_several_of_its_periods() {
        let series = samples(400, |i| -20.0 + 2.0 * (TAU * i / 60.0).sin());
        let found = of(&series);
        // 40 iterations are less than a period, 80 little more.
        assert_eq!(judged_window(&case(), &series).map(|w| w.length), Some(160));
        assert_eq!(judged_window(&case(), &series[..39]), None);
        assert_eq!(found.status, Status::Oscillating, "{}", found.reason);
        assert!((found.window.unwrap().mean[0] + 20.0).abs() < 3.0 * found.window.unwrap().std_of_mean[0]);
    }

    #[test]
    fn a_field_that_grows_is_diverged_whatever_its_forces_say() {
        let still = samples(100, |_| -20.0);
        let judged = |log: &SolverLog, speed: f64, end| {
            let at = |i: usize, speed_m_s| Fastest { time: i as f64, speed_m_s, place: "(1 2 3)".to_owned() };
            // A flow from rest begins wild, and is not judged by that.
            let fastest: Vec<Fastest> = (1..=100).map(|i| at(i, if i <= 80 { 9.0 } else { speed })).collect();
            judge(&case(), Evidence { samples: &still, log, fastest: &fastest, end, until: 100 })
        };
        let calm = SolverLog { residuals: vec![1e-4; 100], ..SolverLog::default() };
        assert_eq!(judged(&calm, 3.0, End::Whole).status, Status::Converged);
        let fast = judged(&calm, 3.001, End::Whole);
        assert_eq!((fast.status, fast.is_final), (Status::Diverged, true));
        assert!(
            fast.reason.starts_with("the water reaches 3.001 m/s at (1 2 3) m in iteration 81, which is 3.0 times"),
            "{}",
            fast.reason
        );
        assert_eq!(judged(&calm, f64::NAN, End::Whole).status, Status::Diverged);
        // A section four times as high as wide: 1.2 (1 + 4).
        let flat = Case { reference: Reference { width_m: 0.025, ..case().reference }, ..case() };
        assert!((largest_speed(&flat) - 6.0).abs() < 1e-12);

        let rise = |factor: f64| SolverLog {
            residuals: (0..100).map(|i| if i < 80 { 1e-4 } else { factor * 1e-4 }).collect(),
            ..SolverLog::default()
        };
        assert_eq!(judged(&rise(9.9), 1.0, End::Whole).status, Status::Converged);
        assert_eq!(judged(&rise(10.1), 1.0, End::Whole).status, Status::Diverged);
        let trapped = judged(&calm, 1.0, End::FloatingPoint);
        assert_eq!(trapped.reason, "a number left the range of floating point after iteration 100");
        let nan = of(&samples(100, |i| if i == 77.0 { f64::NAN } else { 1.0 }));
        assert_eq!((nan.status, nan.reason.as_str()), (Status::Diverged, "its forces are no numbers at iteration 77"));
    }

    #[test]
    fn a_solver_that_did_not_end_has_failed_with_its_own_words() {
        let log = SolverLog { fatal: Some("cannot find file \"p\"".to_owned()), ..SolverLog::default() };
        let evidence = Evidence { samples: &[], log: &log, fastest: &[], end: End::Code(1), until: 40 };
        let found = judge(&case(), evidence);
        assert_eq!((found.status, found.window), (Status::Failed, None));
        assert_eq!(found.reason, "the solver ended with the error: cannot find file \"p\"");
        let log = SolverLog { fatal: Some("error in IOstream \"60/phi\"".to_owned()), ..SolverLog::default() };
        let unwritten = judge(&case(), Evidence { log: &log, ..evidence });
        assert!(unwritten.reason.ends_with("\"60/phi\"; is the disk full?"), "{}", unwritten.reason);
        let killed = judge(&case(), Evidence { log: &SolverLog::default(), end: End::Code(-9), ..evidence });
        assert_eq!(killed.reason, "the solver was ended by the signal 9");
        let full = judge(&case(), Evidence { log: &SolverLog::default(), end: End::Whole, ..evidence });
        assert_eq!((full.status, full.is_final), (Status::Failed, true));
        assert!(
            full.reason.ends_with("0 iterations are there where it was to do 40; is the disk full?"),
            "{}",
            full.reason
        );
        let short = of(&samples(39, |_| 1.0));
        assert_eq!((short.status, short.is_final), (Status::Failed, false));
        assert_eq!(short.reason, "it has forces of 39 iterations, and 40 are needed to judge it");
        assert_eq!(of(&[]).status, Status::Failed);
    }
}
