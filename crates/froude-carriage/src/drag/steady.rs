//! The steady window of a tow, and the mean over it with a realistic uncertainty.
//!
//! The window is the longest stretch of constant reference speed, less a first part in which force and flow settle.
//! The mean over it counts the correlation of its samples ([`froude_fit::series`]).

use froude_fit::series::{Line, blocked, mean};

use super::run::{DragRun, Window};

/// How steady windows are chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadySettings {
    /// Dropped at the start of constant speed, s.
    pub settle_s: f64,
    /// Dropped at its end, s: sampling and filters smear the corner of the profile into it.
    pub corner_s: f64,
    /// Shortest window worth a mean, s.
    pub shortest_s: f64,
    /// Dropped at the start of a stand-still, s: the wake catches up with the body.
    pub still_settle_s: f64,
}

impl Default for SteadySettings {
    fn default() -> Self {
        Self { settle_s: 0.5, corner_s: 0.05, shortest_s: 1.0, still_settle_s: 0.5 }
    }
}

/// The reference counts as constant within this part of the speed asked for.
const CONSTANT_WITHIN: f64 = 1e-3;
/// A first fifth that differs from the rest by more than this many standard uncertainties has not settled.
const SETTLED_WITHIN: f64 = 3.0;
/// At most this part of the window is given up to settling.
const MOST_SETTLING: f64 = 0.4;
/// A line that holds this part of the variance is a ripple.
const RIPPLE_SHARE: f64 = 0.6;
/// Ripples with fewer periods in the window are a trend, with more it does not matter where the window is cut.
const RIPPLE_PERIODS: std::ops::Range<usize> = 3..40;

/// Why a run gives no steady point.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Rejected {
    /// The load swings on the chain until the window ends.
    #[error(
        "run {run:?}: the load swings on the chain so far that the motor's command falls to {least:.0} % of what friction alone needs \
         (less than {needed:.0} %): the gear is then back-driven by the load, and its losses differ. Shape the reference for the load mode \
         (froude carriage resonance), accelerate more gently, or tow further"
    )]
    Swings {
        /// The run.
        run: String,
        /// Least command, in per cent of the friction's.
        least: f64,
        /// What is needed, in per cent.
        needed: f64,
    },
    /// It has no steady window, or there is no run to compare it with.
    #[error("{0}")]
    Unusable(String),
}

/// Constant speed that is too short after settling.
fn too_short(run: &DragRun<'_>, found_s: f64, dropped_s: f64, needed_s: f64) -> Rejected {
    Rejected::Unusable(format!(
        "run {:?}: {found_s:.2} s of constant speed are left after {dropped_s:.2} s of settling, {needed_s:.2} s are \
         needed; tow slower or further",
        run.id
    ))
}

/// Stretches in which `is_in` holds.
fn stretches(column: &[f64], is_in: impl Fn(f64) -> bool) -> Vec<Window> {
    let mut out = Vec::new();
    let mut first = None;
    for (i, &x) in column.iter().enumerate() {
        match (is_in(x), first) {
            (true, None) => first = Some(i),
            (false, Some(f)) => {
                out.push(Window { first: f, end: i });
                first = None;
            }
            _ => {}
        }
    }
    if let Some(first) = first {
        out.push(Window { first, end: column.len() });
    }
    out
}

/// The steady window of a tow by its reference speed alone, or the one that is declared.
///
/// # Errors
///
/// [`Rejected`] when the speed is never held, or not for long enough.
pub fn window(run: &DragRun<'_>, settings: SteadySettings) -> Result<Window, Rejected> {
    if let Some(held) = run.held {
        let found_s = held.len() as f64 * run.step_s();
        return if found_s < settings.shortest_s {
            Err(too_short(run, found_s, 0.0, settings.shortest_s))
        } else {
            Ok(held)
        };
    }
    let target = run.target_speed_m_s * run.direction;
    let slack = CONSTANT_WITHIN * run.target_speed_m_s;
    let held = stretches(run.reference_speed_m_s, |v| (v - target).abs() <= slack)
        .into_iter()
        .max_by_key(|w| w.len())
        .ok_or_else(|| Rejected::Unusable(format!("run {:?}: the reference never holds {target} m/s", run.id)))?;
    let step = run.step_s();
    let (dropped, corner) = (run.samples(settings.settle_s), run.samples(settings.corner_s));
    let found_s = (held.len() as f64 - (dropped + corner) as f64) * step;
    // A run of one sample has no step.
    if found_s.is_nan() || found_s < settings.shortest_s {
        return Err(too_short(run, found_s.max(0.0), settings.settle_s, settings.shortest_s));
    }
    Ok(Window { first: held.first + dropped, end: held.end - corner })
}

/// The steady window without the settling of a force: as long as the first fifth differs from the rest, it is
/// dropped. A slow ripple is then cut to whole periods.
///
/// Differences within `slack` (unit of the force) are let pass: a sensor whose zero is known no better than that.
///
/// # Errors
///
/// [`Rejected`], also when the force has not settled after 40 % of the window.
pub fn settled_window(
    run: &DragRun<'_>,
    force: &[f64],
    slack: f64,
    settings: SteadySettings,
) -> Result<Window, Rejected> {
    let start = window(run, settings)?;
    let settled = settled_part(run, start.of(force), slack, settings)?;
    Ok(Window { first: start.first + settled.first, end: start.first + settled.end })
}

/// The settled part of a force over a steady window of `run`, as a window into `force`: as [`settled_window`].
///
/// # Errors
///
/// As there.
pub fn settled_part(
    run: &DragRun<'_>,
    force: &[f64],
    slack: f64,
    settings: SteadySettings,
) -> Result<Window, Rejected> {
    let step = run.step_s();
    let mut now = Window { first: 0, end: force.len() };
    loop {
        let fifth = now.len() / 5;
        let split = now.first + fifth;
        let (change, standard) = head_against_rest(force, now, split, step);
        if change.abs() <= SETTLED_WITHIN * standard + slack {
            break;
        }
        if split as f64 > MOST_SETTLING * force.len() as f64 {
            return Err(Rejected::Unusable(format!(
                "run {:?}: the force still drifts by {:.3} N over the window after {:.2} s of settling; wait \
                 longer between runs, or tow further",
                run.id,
                -change,
                settings.settle_s + now.first as f64 * step
            )));
        }
        now.first = split;
    }
    let now = whole_periods(force, now);
    let found_s = now.len() as f64 * step;
    if found_s < settings.shortest_s {
        return Err(too_short(run, found_s, settings.settle_s + now.first as f64 * step, settings.shortest_s));
    }
    Ok(now)
}

/// A command that falls below this part of what friction alone needs tells a load that may drive the gear: the motor's own friction, which
/// it never lets go of, is 0.35 of the paper's.
const DRIVING: f64 = 0.5;
/// Span over which a command is averaged for that, s: several times the encoder's steps, a fifth of the period of a load on its chain.
const SWING_S: f64 = 0.04;

/// The part of a steady window in which the motor drives the load throughout; `friction_v` is the mean command of a tow without drag.
///
/// A gear takes 1/η of the chain's force from a motor that drives and gives η_b of it to one that is driven. Over a swing in which the
/// force changes its sign the mean command is therefore too large, by ½(1/η − η_b) of the mean |F| less |mean F|, wet and dry not alike.
///
/// # Errors
///
/// [`Rejected::Swings`] where too little is left.
pub fn driving_part(
    run: &DragRun<'_>,
    from: Window,
    friction_v: f64,
    settings: SteadySettings,
) -> Result<Window, Rejected> {
    let command = from.of(run.command_v);
    let span = ((SWING_S / run.step_s()).round() as usize).min(command.len()).max(1);
    let needed_v = DRIVING * friction_v.abs();
    let mut sum: f64 = command[..span].iter().sum();
    let (mut after, mut least_v) = (0, f64::INFINITY);
    for end in span..=command.len() {
        if end > span {
            sum += command[end - 1] - command[end - 1 - span];
        }
        let here = run.direction * sum / span as f64;
        least_v = least_v.min(here);
        if here < needed_v {
            after = end;
        }
    }
    let left = Window { first: from.first + after, end: from.end };
    if (left.len() as f64 * run.step_s()) < settings.shortest_s {
        let percent = 100.0 / friction_v.abs();
        return Err(Rejected::Swings { run: run.id.to_owned(), least: percent * least_v, needed: 100.0 * DRIVING });
    }
    Ok(left)
}

/// The stand-still before and after the tow, without settling; `None` where there is none long enough.
#[must_use]
pub fn still_windows(run: &DragRun<'_>, settings: SteadySettings) -> [Option<Window>; 2] {
    let still = stretches(run.reference_speed_m_s, |v| v == 0.0);
    let step = run.step_s();
    let n = run.time_s.len();
    let needed = (settings.shortest_s / step).floor().min(1e9) as usize;
    let before = still.first().copied().filter(|w| w.first == 0 && w.len() >= needed && w.end < n);
    let dropped = run.samples(settings.still_settle_s);
    let after = still
        .last()
        .copied()
        .filter(|w| w.end == n && w.first > 0 && w.len() >= needed + dropped)
        .map(|w| Window { first: w.first + dropped, end: w.end });
    [before, after]
}

/// A window cut at its end to whole periods of its strongest ripple, where one stands out.
fn whole_periods(force: &[f64], window: Window) -> Window {
    let (blocks, per_block) = blocked(window.of(force));
    let n = blocks.len();
    if n < 4 * RIPPLE_PERIODS.start {
        return window;
    }
    let line = Line::through(&blocks);
    let left: Vec<f64> = blocks.iter().enumerate().map(|(i, x)| x - line.at(i)).collect();
    let total: f64 = left.iter().map(|x| x * x).sum();
    // Half periods, so that a ripple between two whole numbers is found.
    let strongest = (2 * RIPPLE_PERIODS.start..2 * RIPPLE_PERIODS.end.min(n / 4))
        .map(|half| {
            let (sin, cos) = (std::f64::consts::PI * half as f64 / n as f64).sin_cos();
            let (mut c, mut s, mut turn) = (0.0, 0.0, (1.0, 0.0));
            for x in &left {
                c += x * turn.0;
                s += x * turn.1;
                turn = (turn.0 * cos - turn.1 * sin, turn.0 * sin + turn.1 * cos);
            }
            (half, 2.0 * (c * c + s * s) / n as f64)
        })
        .max_by(|a, b| a.1.total_cmp(&b.1));
    match strongest {
        Some((half, power)) if half % 2 == 1 && power > RIPPLE_SHARE * total && total > 0.0 => {
            let kept = n * (half - 1) / half * per_block;
            Window { first: window.first, end: window.first + kept }
        }
        _ => window,
    }
}

/// Mean less a first part's mean, in standard uncertainties of that difference: noise taken about a line through the rest.
fn head_against_rest(force: &[f64], window: Window, split: usize, step_s: f64) -> (f64, f64) {
    let head = Window { first: window.first, end: split }.of(force);
    let rest = Window { first: split, end: window.end }.of(force);
    let of = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let line = Line::through(rest);
    let left: Vec<f64> = rest.iter().enumerate().map(|(i, x)| x - line.at(i)).collect();
    let noise = mean(&left, step_s).standard;
    let longer = rest.len() as f64 / head.len().max(1) as f64;
    (of(head) - of(rest), noise * (1.0 + longer).sqrt())
}

/// Mean speed over a window, m/s, from its end positions.
#[must_use]
pub fn mean_speed(run: &DragRun<'_>, window: Window) -> f64 {
    let (first, last) = (window.first, window.end - 1);
    (run.position_m[last] - run.position_m[first]) / (run.time_s[last] - run.time_s[first])
}

/// Smallest and largest of a column.
#[must_use]
pub fn reach(column: &[f64]) -> [f64; 2] {
    column.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::run::{BodyState, RunKind};
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    fn run<'a>(time_s: &'a [f64], speed: &'a [f64], force: &'a [f64]) -> DragRun<'a> {
        DragRun {
            id: "r",
            time_s,
            position_m: time_s,
            reference_speed_m_s: speed,
            command_v: force,
            force_n: Some(force),
            kind: RunKind::Tow,
            body: BodyState::Wet,
            target_speed_m_s: 0.5,
            direction: 1.0,
            pair: 1,
            is_ballasted: true,
            hung_weight_n: None,
            held: None,
        }
    }

    /// 1 s still, 0.5 s ramp, `held` s at 0.5 m/s, ramp, still; 100 samples a second.
    fn profile(held: f64) -> (Vec<f64>, Vec<f64>) {
        let n = ((held + 3.0) * 100.0) as usize;
        let speed = |t: f64| (t - 1.0).clamp(0.0, 0.5).min((2.0 + held - t).clamp(0.0, 0.5));
        let time: Vec<f64> = (0..n).map(|i| i as f64 * 0.01).collect();
        let speed = time.iter().map(|&t| speed(t)).collect();
        (time, speed)
    }

    /// A swing of 4 Hz that decays in 1 s: the window begins where it is small enough that the motor drives all the time.
    #[test]
    fn a_window_in_which_the_load_drives_is_cut_or_refused() {
        let (time, speed) = profile(5.0);
        let held = window(&run(&time, &speed, &speed), SteadySettings::default()).unwrap();
        let command = |amplitude: f64| -> Vec<f64> {
            time.iter().map(|t| 1.0 + amplitude * (-(t - 2.0)).exp() * (25.1 * t).sin()).collect()
        };
        let part = |amplitude: f64| {
            let command = command(amplitude);
            driving_part(&run(&time, &speed, &command), held, 1.0, SteadySettings::default())
        };
        assert_eq!(part(0.4).unwrap(), held);
        // 1 e^-t below 0.5 / 0.96 (what 0.04 s leave of 4 Hz) from t = 0.65 s on, that is from 2.65 s of the run.
        let cut = part(1.0).unwrap();
        assert_eq!(cut.end, held.end);
        assert!((time[cut.first] - 2.65).abs() < 0.25, "{}", time[cut.first]);
        let why = part(100.0).unwrap_err().to_string();
        assert!(why.contains("the load swings on the chain") && why.contains("froude carriage resonance"), "{why}");
    }

    #[test]
    fn a_window_too_short_says_how_much_is_missing() {
        let (time, speed) = profile(1.2);
        let why = window(&run(&time, &speed, &speed), SteadySettings::default()).unwrap_err();
        assert_eq!(
            why.to_string(),
            "run \"r\": 0.66 s of constant speed are left after 0.50 s of settling, 1.00 s are needed; tow slower or further"
        );
    }

    /// A start-up force that dies away in 1 s: what is dropped leaves less than a tenth of it in the mean.
    #[test]
    fn a_force_that_settles_slowly_loses_its_beginning() {
        let (time, speed) = profile(12.0);
        let mut rng = Pcg64::seed_from_u64(5);
        let force: Vec<f64> = time
            .iter()
            .map(|t| {
                let z: f64 = StandardNormal.sample(&mut rng);
                5.0 + 2.0 * (-(t - 1.5).max(0.0) / 1.0).exp() + 0.05 * z
            })
            .collect();
        let r = run(&time, &speed, &force);
        let plain = window(&r, SteadySettings::default()).unwrap();
        let settled = settled_window(&r, &force, 0.0, SteadySettings::default()).unwrap();
        let error = |w: Window| mean(w.of(&force), 0.01).value - 5.0;
        assert!(settled.first > plain.first);
        assert!(error(settled) < 0.3 * error(plain), "{} {}", error(settled), error(plain));
        // A force that never stops drifting is refused.
        let drifting: Vec<f64> = time.iter().zip(&force).map(|(t, f)| f + 0.2 * t).collect();
        let error = settled_window(&r, &drifting, 0.0, SteadySettings::default()).unwrap_err().to_string();
        assert!(error.contains("the force still drifts by "), "{error}");
    }

    /// 5½ periods of a ripple of 1 N: the half period left over would move the mean by 2/π/11 N.
    #[test]
    fn a_slow_ripple_is_cut_to_whole_periods() {
        let (time, speed) = profile(11.0 + 0.55);
        let force: Vec<f64> = time.iter().map(|t| 3.0 + (std::f64::consts::PI * (t - 2.0)).sin()).collect();
        let r = run(&time, &speed, &force);
        let w = settled_window(&r, &force, 0.0, SteadySettings::default()).unwrap();
        let error = mean(w.of(&force), 0.01).value - 3.0;
        assert!(error.abs() < 0.2 * 2.0 / std::f64::consts::PI / 11.0, "{error}");
    }
}
