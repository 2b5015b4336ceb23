//! Runs that repeat a motion, in rows that follow each other in time.
//!
//! What a law leaves of a motion it leaves of the same motion again: repeated runs show how well a rig repeats, and not whether the law holds. As clusters of their own they
//! make an interval too narrow; so all runs of a motion are one cluster.
//!
//! | of two groups | alike where |
//! | --- | --- |
//! | configuration | the same |
//! | duration | within 2 % |
//! | every velocity, and every channel of a law, at [`PROBES`] times since the start | root mean square of the difference within √((0.05 s)² + (0.01 m)² + 2 · 1.6 n²) |
//!
//! s: the smaller standard deviation of the channel in a run; m: its mean; n: its noise, √(Σ(Δ⁴x)²/70) of fourth differences, in which a motion that is sampled eight times a period leaves 0.04 s.
//!
//! A group is a run in time where its times rise and some of these channels varies within it by more than noise. Others stay clusters of their own: days of a tank repeat the speeds of
//! other days on purpose, and so do tows at constant speed.

use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;
use indexmap::IndexMap;

use crate::dataset::{Dataset, GroupedBy, LOADS};
use crate::law::ForceLaw;

/// Times of a run at which its channels are compared.
const PROBES: usize = 64;
/// Part of a standard deviation within which two runs move alike: a start that is late by 1/126 of a period.
const ALIKE: f64 = 0.05;
/// Part of a mean within which it is repeated.
const AS_FAST: f64 = 0.01;
/// Twice the variance of the noise of a run, and three standard deviations of a sum of squares of [`PROBES`] differences.
const BY_NOISE: f64 = 2.0 * 1.6;
/// Difference of two durations over the longer one, below which they are equal.
const AS_LONG: f64 = 0.02;
/// Standard deviations of noise, and part of the mean, beyond which a channel varies.
const VARIES: [f64; 2] = [3.0, 0.02];
/// Rows that a run in time has at least: a day of means that were taken one after the other has fewer.
const FEWEST_ROWS: usize = 50;
/// Motions that CR3 needs; fewer stay as they are, and a warning says for what their intervals hold.
const FEWEST_MOTIONS: usize = 3;

const VELOCITIES: [&str; 6] = ["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"];

/// The motions of the groups of a table, which is read twice: [`Self::span`], then [`Self::probe`].
#[derive(Debug, Default)]
pub(crate) struct Motions {
    channels: Vec<String>,
    of_group: IndexMap<String, Motion>,
}

#[derive(Debug, Default)]
struct Motion {
    configuration: String,
    span_s: [f64; 2],
    rows: usize,
    falls: bool,
    channels: Vec<Channel>,
    /// Time and values of the row before, of the second reading.
    before: Option<(f64, Vec<f64>)>,
    /// The channels at each probe.
    probes: Vec<Vec<f64>>,
}

/// What a run says of one channel.
#[derive(Debug, Default)]
struct Channel {
    count: f64,
    mean: f64,
    /// Σ(x − mean)².
    squares: f64,
    last: [f64; 4],
    /// Σ(Δ⁴x)².
    fourth: f64,
}

impl Channel {
    fn take(&mut self, x: f64) {
        self.count += 1.0;
        let from_mean = x - self.mean;
        self.mean += from_mean / self.count;
        self.squares += from_mean * (x - self.mean);
        if self.count > 4.0 {
            let [a, b, c, d] = self.last;
            self.fourth += (a - 4.0 * b + 6.0 * c - 4.0 * d + x).powi(2);
        }
        self.last = [self.last[1], self.last[2], self.last[3], x];
    }

    fn std(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }

    fn noise(&self) -> f64 {
        (self.fourth / (70.0 * (self.count - 4.0).max(1.0))).sqrt()
    }

    fn varies(&self) -> bool {
        let [of_noise, of_mean] = VARIES;
        self.std() > of_noise * self.noise() && self.std() > of_mean * self.mean.abs()
    }
}

impl Motions {
    /// Takes in when each group begins and ends, and how its channels vary.
    pub(crate) fn span(&mut self, data: &Dataset) {
        let (Some(time), Some(group)) = (data.values("time"), &data.group) else { return };
        let is_motion = |name: &str| {
            let is_of = |prefix: &str| name.starts_with(prefix);
            !LOADS.contains(&name)
                && !["std_", "zero_"].into_iter().any(is_of)
                && !matches!(
                    name,
                    "time"
                        | "repeat"
                        | "temperature"
                        | "density"
                        | "kinematic_viscosity"
                        | "n_links"
                        | "speed"
                        | "angle"
                )
        };
        self.channels = data.channels.keys().filter(|name| is_motion(name)).cloned().collect();
        let channels: Vec<&[f64]> = self.channels.iter().filter_map(|name| data.values(name)).collect();
        for (i, (&at_s, group)) in time.iter().zip(group).enumerate() {
            if !self.of_group.contains_key(group) {
                let configuration = data.configuration.get(i).cloned().unwrap_or_default();
                let span_s = [at_s; 2];
                self.of_group.insert(group.clone(), Motion { configuration, span_s, ..Motion::default() });
            }
            let Some(motion) = self.of_group.get_mut(group) else { continue };
            motion.rows += 1;
            // Equal times are those of a clock of few digits; NaN is none.
            motion.falls |= at_s.partial_cmp(&motion.span_s[1]).is_none_or(std::cmp::Ordering::is_lt);
            motion.span_s[1] = at_s;
            motion.channels.resize_with(channels.len(), Channel::default);
            for (channel, values) in motion.channels.iter_mut().zip(&channels) {
                channel.take(values[i]);
            }
        }
    }

    /// Takes in the channels of each group at its probes, between its rows.
    pub(crate) fn probe(&mut self, data: &Dataset) {
        let (Some(time), Some(group)) = (data.values("time"), &data.group) else { return };
        let channels: Vec<&[f64]> = self.channels.iter().filter_map(|name| data.values(name)).collect();
        for (i, (&at_s, group)) in time.iter().zip(group).enumerate() {
            if let Some(motion) = self.of_group.get_mut(group) {
                motion.probe(at_s, channels.iter().map(|values| values[i]).collect());
            }
        }
    }

    /// The cluster of each group, called after the first run of its motion; `None` where no motion is repeated.
    pub(crate) fn clusters(&self, laws: &[ForceLaw]) -> Option<IndexMap<String, String>> {
        let is_read = |name: &String| {
            VELOCITIES.contains(&name.as_str()) || laws.iter().any(|law| law.channels().contains(&name.as_str()))
        };
        let read: Vec<usize> = (0..self.channels.len()).filter(|&k| is_read(&self.channels[k])).collect();
        let mut first: Vec<(&String, &Motion)> = Vec::new();
        let mut out = IndexMap::new();
        for (name, motion) in &self.of_group {
            let is_run = motion.is_run(&read);
            let known = first.iter().find(|(_, other)| is_run && motion.is_like(other, &read));
            out.insert(name.clone(), known.map_or(name, |(of, _)| of).clone());
            if known.is_none() && is_run {
                first.push((name, motion));
            }
        }
        out.iter().any(|(name, of)| name != of).then_some(out)
    }
}

impl Motion {
    fn probe(&mut self, at_s: f64, values: Vec<f64>) {
        let [first_s, last_s] = self.span_s;
        while self.probes.len() < PROBES {
            let probe_s = first_s + (last_s - first_s) * self.probes.len() as f64 / (PROBES - 1) as f64;
            if probe_s > at_s {
                break;
            }
            let between = |(before, x): (f64, f64), part: f64| before + part * (x - before);
            let there = match &self.before {
                Some((before_s, before)) if at_s > *before_s => {
                    let part = (probe_s - before_s) / (at_s - before_s);
                    before.iter().copied().zip(values.iter().copied()).map(|pair| between(pair, part)).collect()
                }
                _ => values.clone(),
            };
            self.probes.push(there);
        }
        self.before = Some((at_s, values));
    }

    fn is_run(&self, read: &[usize]) -> bool {
        let [first_s, last_s] = self.span_s;
        !self.falls
            && self.rows >= FEWEST_ROWS
            && last_s > first_s
            && self.probes.len() == PROBES
            && read.iter().any(|&k| self.channels[k].varies())
    }

    fn is_like(&self, other: &Self, read: &[usize]) -> bool {
        let [a, b] = [self, other].map(|m| m.span_s[1] - m.span_s[0]);
        let is_near = |&k: &usize| {
            let [p, q] = [self, other].map(|m| &m.channels[k]);
            let apart = self.probes.iter().zip(&other.probes).map(|(p, q)| (p[k] - q[k]).powi(2)).sum::<f64>();
            let alike = (ALIKE * p.std().min(q.std())).powi(2)
                + (AS_FAST * p.mean.abs().max(q.mean.abs())).powi(2)
                + BY_NOISE * p.noise().max(q.noise()).powi(2);
            apart / PROBES as f64 <= alike
        };
        self.configuration == other.configuration && (a - b).abs() <= AS_LONG * a.max(b) && read.iter().all(is_near)
    }
}

/// Whether rows follow each other in time, as those of a log do; the clock of each run may begin anew.
pub(crate) fn is_in_time(data: &Dataset) -> bool {
    let rises = |time: &[f64]| {
        let falls = time.windows(2).filter(|pair| pair[1] < pair[0]).count();
        falls * FEWEST_ROWS <= 2 * time.len()
    };
    data.rows >= FEWEST_ROWS && data.values("time").is_some_and(rises)
}

/// The groups of rows in time, those that repeat a motion merged, and what is said of it.
pub(crate) fn merge(data: &mut Dataset, laws: &[ForceLaw]) -> Option<Finding> {
    let mut motions = Motions::default();
    motions.span(data);
    motions.probe(data);
    let clusters = motions.clusters(laws)?;
    if is_enough(&clusters) {
        rename(data, &clusters);
    }
    Some(found(&clusters))
}

fn count(clusters: &IndexMap<String, String>) -> usize {
    clusters.iter().filter(|(name, of)| name == of).count()
}

/// Whether there are motions enough to be clusters.
pub(crate) fn is_enough(clusters: &IndexMap<String, String>) -> bool {
    count(clusters) >= FEWEST_MOTIONS
}

/// Puts the cluster of each row in the place of its group.
pub(crate) fn rename(data: &mut Dataset, clusters: &IndexMap<String, String>) {
    let of = |group: &String| clusters.get(group).unwrap_or(group).clone();
    data.group = data.group.as_ref().map(|groups| groups.iter().map(of).collect());
    data.grouped_by = GroupedBy::Motion;
    if let Some(all) = &mut data.sample {
        all.clusters = count(clusters);
    }
}

/// How many groups are how many motions, and what that does to intervals.
pub(crate) fn found(clusters: &IndexMap<String, String>) -> Finding {
    let motions = count(clusters);
    let example = clusters.iter().find(|(name, of)| name != of);
    let example = example.map_or_else(String::new, |(name, of)| format!(" ({name:?} that of {of:?})"));
    let repeated = format!(
        "{} of the {} in time repeat the motion of another{example}",
        clusters.len() - motions,
        counted(clusters.len(), "group", "groups")
    );
    if is_enough(clusters) {
        let text = format!(
            "{repeated}: clusters are the {motions} motions, because repeats of a motion leave the same residuals"
        );
        return Finding::new(Severity::Note, "repeated-motions", text);
    }
    let text = format!(
        "{repeated}, and {} too few for clusters: the intervals by groups say how well the rig repeats, for {} alone; record other motions",
        counted(motions, "motion is", "motions are"),
        if motions == 1 { "this motion" } else { "these motions" }
    );
    Finding::new(Severity::Warning, "repeated-motions", text)
}

#[cfg(test)]
mod tests;
