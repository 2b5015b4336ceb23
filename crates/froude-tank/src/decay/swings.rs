//! Turning points and passages of one release.
//!
//! A swing begins where the position leaves a band about rest to one side and ends where it leaves it to the other; noise about a passage does not
//! reach the band's edge. Guesses from there are refined by [`super::local`]. A peak is the turning point of a swing as refined, further from rest than the
//! level that the setup states; the first one that is not ends the motion. The swing before the first passage has the release in it and is used only where
//! the setup says that the motion is free by then.

use std::f64::consts::PI;

use super::error::DecayError;
use super::fit::Method;
use super::local::{self, FEWEST, REACH_RAD, Spot};
use super::run::{DecayRun, DecaySetup};
use crate::error::TankError;
use froude_records::text::counted;

/// The band about rest, as part of the distance that a peak exceeds.
const BAND: f64 = 0.625;
/// Turning points that show the position of rest; from fewer it is that of the body at rest again, where it is.
const FEWEST_ROUGH: usize = 5;
/// Where there is no noise, swings count down to this part of the largest.
const NOISELESS: f64 = 1e-3;

/// What one release shows.
#[derive(Debug, Clone)]
pub struct Swings {
    /// Turning points, one after the other, to alternate sides.
    pub turns: Vec<Spot>,
    /// Passages through the rest position; `passages[k]` comes before `turns[k]`.
    pub passages: Vec<Spot>,
    /// Rest position as first guessed, m or rad.
    pub rest: f64,
    /// +1 where the first turn is on the positive side.
    pub side: f64,
    /// Standard deviation of a sample's noise, m or rad.
    pub noise: f64,
    /// Passages after the last one used: a half cycle there has no turning point near its middle.
    pub unread: usize,
    /// First sample that is used, and the one after the last.
    pub samples: [usize; 2],
}

impl Swings {
    /// Mean period, s, and the added mass that it is of.
    pub(super) fn period_and_added(&self, setup: &DecaySetup) -> [f64; 2] {
        let (first, last) = (&self.passages[0], &self.passages[self.passages.len() - 1]);
        let period_s = 2.0 * (last.time_s - first.time_s) / (self.passages.len() - 1).max(1) as f64;
        [period_s, setup.restoring.stiffness() * (period_s / (2.0 * PI)).powi(2) - setup.inertia.value]
    }
}

impl Swings {
    /// The used part of a run, with as many peaks as a method needs.
    pub fn of(run: &DecayRun<'_>, setup: &DecaySetup, method: Method) -> Result<Self, DecayError> {
        run.check()?;
        let window = setup.window;
        let first = window.free_from_s.map_or(0, |t| run.time_s.partition_point(|s| *s < t));
        if let (Some(free_from_s), Some(last_s)) =
            (window.free_from_s, run.time_s.last().filter(|_| first == run.time_s.len()))
        {
            let what = format!(
                "free_from = {free_from_s} s, and the log ends at {last_s} s: it counts in the log's times, those of a calendar from the first sample"
            );
            return Err(TankError::of_run(run.id, what).into());
        }
        let (time_s, q) = (&run.time_s[first..], &run.position[first..]);
        let noise = window.noise.unwrap_or_else(|| local::noise_of(time_s, q));
        let mut rest = midrange(&q[q.len() / 2..]);
        let range = q.iter().fold(0.0_f64, |m, x| m.max((x - rest).abs()));
        if range.is_nan() || range <= setup.level(noise) {
            let what = format!(
                "the motion reaches {range:.3e} where the noise of a sample is {noise:.3e}; release from further out"
            );
            return Err(DecayError::of_release(run.id, what));
        }
        let level = setup.level(noise).max(NOISELESS * range);
        let band = BAND * level;
        // The rest of the record's second half is crude; that of the swings themselves is not.
        for _ in 0..2 {
            let turns = rough_turns(q, rest, band);
            let of_rest = quiet(q, rest, band).filter(|_| turns.len() < FEWEST_ROUGH);
            rest = of_rest.or_else(|| rest_between(&turns)).unwrap_or(rest);
        }
        let mut crossed = crossings(time_s, q, rest, band);
        let above = crossed.iter().skip(window.skip_half_cycles).take_while(|c| c.furthest > level).count();
        let few = |found: usize| {
            let why = format!(
                "{} further than {level:.3e} {} from rest ({} times the noise of a sample), and {} needs {}; {}",
                counted(found, "peak", "peaks"),
                setup.axis.position_unit(),
                window.smallest_over_noise,
                method.name(),
                method.fewest_peaks(),
                method.of_few_peaks()
            );
            DecayError::Release { run: run.id.to_owned(), why, peaks: Some(found) }
        };
        if crossed.len() < 2 {
            let tail = &q[q.len() - q.len() / 10 - 1..];
            let is_back = tail.iter().all(|x| (x - rest).abs() <= band);
            let over_damped = "the body returns without passing its rest position (over-damped); stiffer springs or a smaller \
                               release make it swing";
            let is_damped = is_back && crossed.is_empty();
            return Err(if is_damped { DecayError::of_release(run.id, over_damped) } else { few(above) });
        }
        let mut gaps: Vec<f64> = crossed.windows(2).map(|w| w[1].time_s - w[0].time_s).collect();
        let middle = gaps.len() / 2;
        let half_period_s = *gaps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let reach_s = REACH_RAD * half_period_s / PI;
        let in_half_cycle = half_period_s / run.step_s();
        if 2.0 * reach_s / run.step_s() < FEWEST as f64 {
            let needed = (FEWEST as f64 * PI / (2.0 * REACH_RAD)).ceil() as usize;
            let what = format!("{in_half_cycle:.1} samples in a half cycle, {needed} are needed; sample faster");
            return Err(TankError::of_run(run.id, what).into());
        }
        crossed.truncate(window.skip_half_cycles + above);
        let (mut passages, mut turns) = (Vec::new(), Vec::new());
        let (mut side, mut unread) = (0.0, 0);
        for k in window.skip_half_cycles..crossed.len() {
            let guess_s = crossed[k].time_s;
            let next_s = crossed.get(k + 1).map_or(guess_s + half_period_s, |c| c.time_s);
            let passage = local::passage(time_s, q, guess_s, reach_s, rest);
            let turn = local::turn(time_s, q, 0.5 * (guess_s + next_s), reach_s, noise);
            let (Some(passage), Some(turn)) = (passage, turn) else {
                // Too near the record's start the first passage has no window: the next one is the first.
                if turns.is_empty() {
                    continue;
                }
                unread = crossed.len() - 1 - k;
                break;
            };
            if (turn.position - rest).abs() <= level {
                break;
            }
            if turns.is_empty() {
                side = crossed[k].side;
            }
            passages.push(passage);
            turns.push(turn);
        }
        if turns.len() < method.fewest_peaks() && unread > 0 {
            let what = format!(
                "half cycle {} has no turning point near its middle: two modes beat, or a wave disturbs it; restrain the \
                 other mode, or count swings only while they are larger (smallest over noise)",
                turns.len()
            );
            return Err(DecayError::of_release(run.id, what));
        }
        if turns.len() < method.fewest_peaks() {
            return Err(few(turns.len()));
        }
        let begins = match window.free_from_s {
            Some(_) if window.skip_half_cycles == 0 => first,
            _ => first + time_s.partition_point(|t| *t < passages[0].time_s),
        };
        let last_s = turns[turns.len() - 1].time_s;
        let end = first + time_s.partition_point(|t| *t <= last_s);
        Ok(Self { turns, passages, rest, side, noise, unread, samples: [begins, end] })
    }

    /// +1 or −1: the side of turn `k`.
    pub fn side_of(&self, k: usize) -> f64 {
        if k.is_multiple_of(2) { self.side } else { -self.side }
    }

    /// Mean amplitude of the half cycle from turn `k` to the next, m or rad; the rest position cancels.
    pub fn amplitude(&self, k: usize) -> f64 {
        0.5 * self.side_of(k) * (self.turns[k].position - self.turns[k + 1].position)
    }

    /// Time, s, and distance from rest of each turning point.
    pub fn about(&self, rest: f64) -> Vec<[f64; 2]> {
        let of = |(k, turn): (usize, &Spot)| [turn.time_s, self.side_of(k) * (turn.position - rest)];
        self.turns.iter().enumerate().map(of).collect()
    }

    /// Half cycles between peaks.
    pub fn half_cycles(&self) -> usize {
        self.turns.len() - 1
    }
}

fn midrange(q: &[f64]) -> f64 {
    let [low, high] = q.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| [a.min(x), b.max(x)]);
    0.5 * (low + high)
}

/// Furthest sample of each whole swing.
fn rough_turns(q: &[f64], rest: f64, band: f64) -> Vec<f64> {
    let mut out = Vec::new();
    let (mut side, mut furthest) = (0.0, 0.0_f64);
    for x in q {
        let off = x - rest;
        if off.abs() > band && off.signum() != side {
            if side != 0.0 {
                out.push(rest + furthest);
            }
            (side, furthest) = (off.signum(), 0.0);
        }
        if off * side > furthest * side {
            furthest = off;
        }
    }
    if out.is_empty() { out } else { out.split_off(1) }
}

/// Rest between turning points to alternate sides: (x₀ + 2 x₁ + x₂)/4, in which a steady decrement cancels. The median of all: what the change
/// of the decrement leaves has alternate signs and is least in small swings.
fn rest_between(turns: &[f64]) -> Option<f64> {
    let mut rests: Vec<f64> = turns.windows(3).map(|w| 0.25 * (w[0] + 2.0 * w[1] + w[2])).collect();
    rests.sort_by(f64::total_cmp);
    let n = rests.len();
    (n > 0).then(|| 0.5 * (rests[(n - 1) / 2] + rests[n / 2]))
}

/// The mean of a body that is at rest again over a tenth of its record or more: of the last half of that.
fn quiet(q: &[f64], rest: f64, band: f64) -> Option<f64> {
    let from = q.iter().rposition(|x| (x - rest).abs() > band).map_or(0, |i| i + 1);
    let tail = &q[from..];
    let last = &tail[tail.len() / 2..];
    (10 * tail.len() >= q.len() && !last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
}

/// A passage as it is guessed, and the swing after it.
struct Crossing {
    time_s: f64,
    /// +1 or −1: where the body goes to.
    side: f64,
    /// How far from rest any sample of the swing is, m or rad.
    furthest: f64,
}

/// Guessed passages, each from beyond the band to beyond it on the other side.
fn crossings(time_s: &[f64], q: &[f64], rest: f64, band: f64) -> Vec<Crossing> {
    let mut out: Vec<Crossing> = Vec::new();
    let mut last: Option<usize> = None;
    for (i, x) in q.iter().enumerate() {
        let off = x - rest;
        if off.abs() <= band {
            continue;
        }
        if let Some(before) = last.filter(|&j| (q[j] - rest) * off < 0.0) {
            // The straight line between where it left the band and where it left it again.
            let part = (rest - q[before]) / (x - q[before]);
            let time_s = time_s[before] + part * (time_s[i] - time_s[before]);
            out.push(Crossing { time_s, side: off.signum(), furthest: 0.0 });
        }
        if let Some(swing) = out.last_mut() {
            swing.furthest = swing.furthest.max(off.abs());
        }
        last = Some(i);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i)).collect();
        let q = time_s.iter().map(|t| f(*t)).collect();
        (time_s, q)
    }

    fn swings(time_s: &[f64], position: &[f64]) -> Result<Swings, DecayError> {
        let exact = |value| froude_fit::budget::Uncertain::new(value, 0.0);
        let setup = DecaySetup::new(crate::decay::axis::Motion::Heave, exact(1.0), exact(1.0));
        Swings::of(&DecayRun { id: "r", time_s, position }, &setup, Method::Envelope)
    }

    #[test]
    fn a_held_body_that_is_let_go_is_used_from_its_first_passage() {
        // Held 3 s at 0.1 beyond a rest of 0.5, then a damped cosine of period 2 s.
        let (t, q) = record(|t| {
            let s = (t - 3.0).max(0.0);
            0.5 + 0.1 * (-0.1 * s).exp() * (PI * s).cos()
        });
        let found = swings(&t, &q).unwrap();
        assert!((found.passages[0].time_s - 3.5).abs() < 2e-4 && found.side == -1.0, "{:?}", found.passages[0]);
        assert!((found.rest - 0.5).abs() < 1e-4, "{}", found.rest);
        // The speed is zero at tan φ = −γ/ω_d, a little before the cosine is −1.
        let early = (0.1 / PI).atan();
        let expected = 0.1 * (-0.1 * (1.0 - early / PI)).exp() * early.cos();
        assert!((0.5 - found.turns[0].position - expected).abs() < 2e-4 * expected);
    }

    #[test]
    fn what_does_not_swing_is_refused_with_its_reason() {
        let (t, q) = record(|t| 0.1 * (-t).exp());
        let refused = |t: &[f64], q: &[f64]| swings(t, q).unwrap_err().to_string();
        assert!(refused(&t, &q).contains("(over-damped)"), "{}", refused(&t, &q));
        let (t, q) = record(|t| if t < 3.0 { t.cos() } else { 0.0 });
        assert!(swings(&t, &q).is_err());
        let (t, q) = record(|_| 0.25);
        assert!(refused(&t, &q).starts_with("run \"r\": the motion reaches 0"), "{}", refused(&t, &q));
        let (t, mut q) = record(f64::cos);
        q[7] = f64::NAN;
        assert_eq!(refused(&t, &q), "run \"r\": position at sample 7 is not finite");
        let (mut t, q) = record(f64::cos);
        t[500] = t[499];
        assert_eq!(refused(&t, &q), "run \"r\": the time at sample 500 is 9.98 s after 9.98 s; it must increase");
        assert_eq!(refused(&t[..10], &q), "run \"r\": position has 1000 samples where time has 10");
        assert!(swings(&[], &[]).is_err() && swings(&[0.0], &[0.0]).is_err());
    }
}
