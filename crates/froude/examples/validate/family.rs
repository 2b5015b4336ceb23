//! The intervals of the tank methods are judged in one simultaneous test: 1 % family-wise over all of them, whichever part of the page runs.
//!
//! Those at the noise that a campaign declares; at ten times the noise they are reported.

use froude::fit::coverage::{Count, z_limit};
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};

/// Intervals that a whole page judges: oscillation 8, still runs 10, rotation 5, sway 5, decay 6, steady tows 10, weights 10, accelerated tows 6, excited response 6.
const INTERVALS: usize = 66;

/// How intervals of 95 % are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bar {
    /// The procedure is exact, or nearly: neither too often nor too seldom.
    Exactly,
    /// It is an approximation that is meant to err on the wide side: not too seldom, and its width is a line of its own.
    AtLeast,
}

/// Campaigns of a noise: where it is shown and not judged a tenth, and no fewer than thirty.
pub fn campaigns_of(is_judged: bool, campaigns: usize) -> usize {
    if is_judged { campaigns } else { campaigns.div_ceil(10).max(campaigns.min(30)) }
}

/// A line about intervals that each cover 95 %; `is_whole` where every campaign gave all of them.
pub fn covers(
    claims: &mut Claims,
    section: &'static str,
    claim: &str,
    each: &[(String, Count)],
    (is_whole, is_judged): (bool, bool),
    bar: Bar,
) {
    let limit = z_limit(0.01, INTERVALS);
    let z = |count: &Count| count.z_score(0.95);
    let words = each.iter().map(|(name, c)| format!("{name} {:.2} % (z {:+.2})", 100.0 * c.rate(), z(c)));
    let (expected, holds): (String, fn(f64, f64) -> bool) = match bar {
        Bar::Exactly => (format!("95 %, |z| ≤ {limit:.2}"), |z, limit| z.abs() <= limit),
        Bar::AtLeast => (format!("95 % or more, z ≥ −{limit:.2}"), |z, limit| z >= -limit),
    };
    claims.add(
        section,
        claim,
        &format!("{expected} (1 % family-wise over the {INTERVALS} intervals of the tank methods)"),
        words.collect::<Vec<_>>().join(", "),
        Verdict::of(is_judged, is_whole && each.iter().all(|(_, c)| holds(z(c), limit))),
    );
    claims.tank_intervals += if is_judged { each.len() } else { 0 };
}

/// What each run has of a law's loads where these change by 2 % from run to run.
pub fn factors(runs: usize, seed: u64) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 229);
    (0..runs).map(|_| 1.0 + FROM_RUN_TO_RUN * crate::coverage::normal(&mut rng)).collect()
}

const FROM_RUN_TO_RUN: f64 = 0.02;

/// What campaigns come to, and why some come to nothing.
pub fn answered<T: Send, E: std::fmt::Display>(
    seeds: usize,
    one: impl Fn(u64) -> Result<T, E> + Sync,
) -> (Vec<T>, Vec<String>) {
    let of = |seed: usize| one(seed as u64).map_err(|why| format!("seed {seed}: {why}"));
    let found: Vec<Result<T, String>> = (0..seeds).into_par_iter().map(of).collect();
    let (mut fits, mut refused) = (Vec::new(), Vec::new());
    for one in found {
        match one {
            Ok(fit) => fits.push(fit),
            Err(why) => refused.push(why),
        }
    }
    (fits, refused)
}

/// A line about the same intervals where the drag changes by 2 % from run to run: each covers 94 % or more, but for three binomial deviations, and every campaign has an answer; `refused` says why one has none.
pub fn between_runs(
    claims: &mut Claims,
    section: &'static str,
    campaigns: &str,
    each: &[(String, Count)],
    refused: &[String],
) {
    let words = each.iter().map(|(name, c)| format!("{name} {:.1} %", 100.0 * c.rate()));
    let without = refused.first().map(|why| format!("{} without an answer, the first: {why}", refused.len()));
    let holds = each.iter().all(|(_, c)| c.z_score(0.94) >= -3.0);
    claims.holds(
        section,
        &format!("the same with drag that varies by 2 % from run to run, {campaigns}: coverage"),
        "94 % or more each, less three binomial deviations",
        words.chain(without).collect::<Vec<_>>().join(", "),
        refused.is_empty() && holds,
    );
}

/// The family of a whole page is the one that its limit is of.
pub fn whole(claims: &mut Claims) {
    let found = claims.tank_intervals;
    let claim = "intervals of the tank methods that were judged together";
    claims.holds(
        "Tank methods: their intervals in one test",
        claim,
        &INTERVALS.to_string(),
        found.to_string(),
        found == INTERVALS,
    );
}
