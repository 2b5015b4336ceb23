//! Runs that repeat a motion, in rows that follow each other in time.
//!
//! What a law leaves of a motion it leaves of the same motion again: repeated runs show how well a rig repeats, and not whether the law holds. As clusters of their own they
//! make an interval too narrow; so all runs of a motion are one cluster.
//!
//! Two runs are of one motion where they last as long and, at [`PROBES`] times since their start, move alike in every velocity. Of tables of means nothing is merged: days of a
//! tank repeat the speeds of other days on purpose, and are independent all the same.

use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;
use indexmap::IndexMap;

use crate::dataset::{Dataset, GroupedBy};

/// Times of a run at which its velocities are compared.
const PROBES: usize = 64;
/// Root mean square of the difference of two runs, over the standard deviation of the channel over all of them, below which they move alike: a start that is 0.1 s late moves a
/// period of 10 s by 0.06.
const ALIKE: f64 = 0.1;
/// Difference of two durations over the longer one, below which they are equal.
const AS_LONG: f64 = 0.02;
/// Standard deviation of a velocity over the largest of its kind, below which it is constant in all runs.
const CONSTANT: f64 = 0.02;
/// Rows that a run in time has at least: a day of means that were taken one after the other has fewer.
const FEWEST_ROWS: usize = 50;

/// Velocities of a body.
const VELOCITIES: [&str; 6] = ["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"];

/// The motions of the groups of a table, which is read twice: [`Self::span`], then [`Self::probe`].
#[derive(Debug, Default)]
pub(crate) struct Motions {
    velocities: Vec<&'static str>,
    of_group: IndexMap<String, Motion>,
}

#[derive(Debug)]
struct Motion {
    configuration: String,
    first_s: f64,
    last_s: f64,
    rows: usize,
    rises: bool,
    /// The velocities at each probe, once its time has come.
    probes: Vec<Vec<f64>>,
}

impl Motions {
    /// Takes in when each group begins and ends.
    pub(crate) fn span(&mut self, data: &Dataset) {
        let (Some(time), Some(group)) = (data.values("time"), &data.group) else { return };
        self.velocities = VELOCITIES.into_iter().filter(|name| data.channels.contains_key(*name)).collect();
        for (i, (&at_s, group)) in time.iter().zip(group).enumerate() {
            if let Some(motion) = self.of_group.get_mut(group) {
                motion.rises &= at_s > motion.last_s;
                motion.last_s = at_s;
                motion.rows += 1;
            } else {
                let configuration = data.configuration.get(i).cloned().unwrap_or_default();
                let motion =
                    Motion { configuration, first_s: at_s, last_s: at_s, rows: 1, rises: true, probes: Vec::new() };
                self.of_group.insert(group.clone(), motion);
            }
        }
    }

    /// Takes in the velocities of each group at its probes.
    pub(crate) fn probe(&mut self, data: &Dataset) {
        let (Some(time), Some(group)) = (data.values("time"), &data.group) else { return };
        let channels: Vec<&[f64]> = self.velocities.iter().filter_map(|name| data.values(name)).collect();
        for (i, (&at_s, group)) in time.iter().zip(group).enumerate() {
            let Some(motion) = self.of_group.get_mut(group) else { continue };
            let part = (at_s - motion.first_s) / (motion.last_s - motion.first_s);
            while motion.probes.len() < PROBES && part >= motion.probes.len() as f64 / (PROBES - 1) as f64 {
                motion.probes.push(channels.iter().map(|values| values[i]).collect());
            }
        }
    }

    /// The cluster of each group, called after the first run of its motion; `None` where rows are not in time, or no motion is repeated.
    pub(crate) fn clusters(&self) -> Option<IndexMap<String, String>> {
        let is_run = |m: &Motion| m.rises && m.rows >= FEWEST_ROWS && m.probes.len() == PROBES;
        if self.velocities.is_empty() || self.of_group.len() < 2 || !self.of_group.values().all(is_run) {
            return None;
        }
        let scales: Vec<f64> = (0..self.velocities.len()).map(|k| self.scale(k)).collect();
        let mut first: Vec<(&String, &Motion)> = Vec::new();
        let mut out = IndexMap::new();
        for (name, motion) in &self.of_group {
            let known = first.iter().find(|(_, other)| motion.is_like(other, &scales));
            let of = known.map_or(name, |(of, _)| of);
            if of == name {
                first.push((name, motion));
            }
            out.insert(name.clone(), of.clone());
        }
        (first.len() < self.of_group.len()).then_some(out)
    }

    /// Standard deviation of a velocity over all probes, infinite where it is constant.
    fn scale(&self, k: usize) -> f64 {
        let of = |k: usize| self.of_group.values().flat_map(move |m| m.probes.iter().map(move |at| at[k]));
        let is_alike = |name: &&str| name.starts_with('w') == self.velocities[k].starts_with('w');
        let alike = (0..self.velocities.len()).filter(|&j| is_alike(&self.velocities[j]));
        let largest = alike.flat_map(of).fold(0.0_f64, |m, v| m.max(v.abs()));
        let n = of(k).count() as f64;
        let mean = of(k).sum::<f64>() / n;
        let std = (of(k).map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        if std > CONSTANT * largest { std } else { f64::INFINITY }
    }
}

impl Motion {
    fn is_like(&self, other: &Self, scales: &[f64]) -> bool {
        let [a, b] = [self, other].map(|m| m.last_s - m.first_s);
        let is_near = |(k, scale): (usize, &f64)| {
            let squares = self.probes.iter().zip(&other.probes).map(|(p, q)| (p[k] - q[k]).powi(2));
            (squares.sum::<f64>() / PROBES as f64).sqrt() <= ALIKE * scale
        };
        self.configuration == other.configuration
            && (a - b).abs() <= AS_LONG * a.max(b)
            && scales.iter().enumerate().all(is_near)
    }
}

/// The groups of rows in time, those that repeat a motion merged, with a note that says so.
pub(crate) fn merge(data: &mut Dataset) -> Option<Finding> {
    let mut motions = Motions::default();
    motions.span(data);
    motions.probe(data);
    let clusters = motions.clusters()?;
    rename(data, &clusters);
    Some(merged(&clusters))
}

/// Puts the cluster of each row in the place of its group.
pub(crate) fn rename(data: &mut Dataset, clusters: &IndexMap<String, String>) {
    for group in data.group.iter_mut().flatten() {
        if let Some(of) = clusters.get(group) {
            group.clone_from(of);
        }
    }
    data.grouped_by = GroupedBy::Motion;
    if let Some(all) = &mut data.sample {
        all.clusters = clusters.iter().filter(|(name, of)| name == of).count();
    }
}

/// How many groups are how many motions.
pub(crate) fn merged(clusters: &IndexMap<String, String>) -> Finding {
    let motions = clusters.iter().filter(|(name, of)| name == of).count();
    let example = clusters.iter().find(|(name, of)| name != of);
    let example = example.map_or_else(String::new, |(name, of)| format!(" ({name:?} that of {of:?})"));
    let text = format!(
        "{} of the {} in time repeat the motion of another{example}: clusters are the {}, since what a law leaves of a motion it leaves of its repeats too",
        clusters.len() - motions,
        counted(clusters.len(), "group", "groups"),
        counted(motions, "motion", "motions"),
    );
    Finding::new(Severity::Note, "repeated-motions", text)
}

#[cfg(test)]
mod tests {
    use froude_records::units::Dimension;

    use super::*;

    /// Runs of a sway of 10 s: amplitude m/s, how late the log begins, s.
    fn runs(of: &[(f64, f64)]) -> Dataset {
        let mut data = Dataset::default();
        let (mut time, mut u, mut v, mut group) = (vec![], vec![], vec![], vec![]);
        for (k, (amplitude, late_s)) in of.iter().enumerate() {
            for i in 0..400 {
                let t = 0.05 * f64::from(i);
                time.push(100.0 * k as f64 + t);
                u.push(1.0 + 0.001 * f64::from(i % 3));
                v.push(amplitude * (std::f64::consts::TAU * 0.1 * (t + late_s)).sin() + 0.002 * f64::from(i % 2));
                group.push(format!("run {k}"));
            }
        }
        data.rows = time.len();
        data.configuration = vec![String::new(); data.rows];
        data.put("time", time, Dimension::ONE);
        data.put("v_x", u, Dimension::SPEED);
        data.put("v_y", v, Dimension::SPEED);
        data.group = Some(group);
        data
    }

    fn clusters(data: &Dataset) -> Vec<String> {
        crate::dataset::distinct(data.group.as_ref().unwrap())
    }

    #[test]
    fn runs_of_one_motion_are_one_cluster() {
        let mut data = runs(&[(0.2, 0.0), (0.3, 0.0), (0.2, 0.05), (0.3, 0.0), (0.2, 2.5)]);
        let said = merge(&mut data).unwrap();
        // The last begins a quarter of a period later.
        assert_eq!(clusters(&data), ["run 0", "run 1", "run 4"]);
        assert!(
            said.message
                .starts_with("2 of the 5 groups in time repeat the motion of another (\"run 2\" that of \"run 0\")")
        );
        assert_eq!(data.grouped_by, GroupedBy::Motion);
    }

    #[test]
    fn means_other_bodies_and_other_durations_are_not_merged() {
        let alike = [(0.2, 0.0), (0.2, 0.0)];
        let mut means = runs(&alike);
        means.channels.shift_remove("time");
        assert!(merge(&mut means).is_none());
        let mut bodies = runs(&alike);
        bodies.configuration = (0..bodies.rows).map(|i| format!("H{}LT", i / 400)).collect();
        assert!(merge(&mut bodies).is_none());
        let all = runs(&alike);
        let shorter: Vec<usize> = (0..all.rows).filter(|i| i % 400 < 350 || *i < 400).collect();
        assert!(merge(&mut all.subset(&shorter)).is_none());
        // Rows that do not follow each other.
        let back: Vec<usize> = (0..all.rows).rev().collect();
        assert!(merge(&mut all.subset(&back)).is_none());
    }
}
