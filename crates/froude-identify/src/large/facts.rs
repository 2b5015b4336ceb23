//! What all rows of a long table show without a fit: how many there are, the ends of their ranges, what the lints count.
//!
//! A lint looks at few rows: the fastest, the most turned, those with the largest loads. The first pass finds the ends of every channel, the
//! second those among rows that move or move fast, which only the first can tell. On these rows the lints themselves are run.

use std::rc::Rc;

use froude_records::campaign::{Campaign, Source};
use froude_records::table::{ColumnData, Table};
use froude_records::texts::Texts;
use froude_records::units::Dimension;
use indexmap::{IndexMap, IndexSet};

use super::rows::{Ends, Row, Sample, without_rows};
use crate::dataset::{Dataset, LOADS};
use crate::error::IdentifyError;
use crate::large::limits::{MOST_CLUSTERS, MOST_CONFIGURATIONS, refusal};
use crate::lint;
use crate::lint::counts::Counts;
use crate::lint::motion::apart;
use crate::reduce::{conditioned, kept_rows, zeros_of};
use crate::source::models::MOMENTS;
use crate::validity::{AT_REST, off_axis, per_observation};

/// A chunk of a table: its rows, and the observations that are kept of them.
pub(super) struct Chunk {
    pub(super) table: Table,
    pub(super) data: Dataset,
    /// Row of the table of each observation.
    keep: Vec<usize>,
}

impl Chunk {
    /// `has_speed`: with the speed and angle of its velocities.
    pub(super) fn of(
        table: Table,
        campaign: &Campaign,
        source: &Source,
        has_speed: bool,
    ) -> Result<Self, IdentifyError> {
        let all = conditioned(&table, campaign, source, &mut Vec::new(), has_speed)?;
        let keep = kept_rows(&all, source)?;
        Ok(Self { data: all.keeping(&keep), table, keep })
    }

    /// Numbers of the observations, each with its row of the table.
    fn placed<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.keep.iter().copied().zip(values.iter().copied())
    }

    /// A column of the table as it was read.
    fn read(&self, name: &str) -> Option<&[f64]> {
        self.table.columns.iter().find(|c| c.name == name).and_then(|c| match &c.data {
            ColumnData::Number { si, .. } => Some(si.as_slice()),
            ColumnData::Text(_) => None,
        })
    }
}

/// Columns of the table that a campaign may replace.
const OF_WATER: [&str; 3] = ["density", "kinematic_viscosity", "temperature"];

/// The first pass.
pub(super) struct Facts {
    /// Columns of the table.
    pub(super) like: Option<Table>,
    pub(super) n_read: usize,
    pub(super) n_used: usize,
    channels: Vec<(String, Dimension)>,
    ends: IndexMap<String, Ends>,
    sample: Sample,
    /// Last value of each column of numbers that has risen from row to row.
    rising: IndexMap<String, f64>,
    pub(super) configurations: IndexSet<String>,
    groups: IndexSet<String>,
    /// The cluster of each group, where that is not itself.
    merged: IndexMap<String, String>,
    density: f64,
}

impl Facts {
    pub(super) fn new(sample: usize) -> Self {
        Self {
            like: None,
            n_read: 0,
            n_used: 0,
            channels: Vec::new(),
            ends: IndexMap::new(),
            sample: Sample::of(sample),
            rising: IndexMap::new(),
            configurations: IndexSet::new(),
            groups: IndexSet::new(),
            merged: IndexMap::new(),
            density: 0.0,
        }
    }

    pub(super) fn take(&mut self, chunk: &Chunk, source: &Source) -> Result<(), IdentifyError> {
        let Chunk { table, data, keep } = chunk;
        let channels = || data.channels.iter().map(|(name, channel)| (name.clone(), channel.dimension)).collect();
        if self.like.is_none() {
            self.like = Some(without_rows(table));
            self.channels = channels();
            let numbers = table.columns.iter().filter(|c| matches!(c.data, ColumnData::Number { .. }));
            self.rising = numbers.map(|c| (c.name.clone(), f64::NEG_INFINITY)).collect();
        } else if self.channels != channels() {
            // Links are read from names, viscosity from temperatures: what some rows have, others may lack.
            return Err(refusal(
                source,
                "rows that do not all state the same quantities (configurations HkLT beside others, air beside water)",
            ));
        }
        self.n_read += table.n_rows;
        self.n_used += data.rows;
        for name in OF_WATER {
            if let Some(values) = chunk.read(name) {
                self.ends.entry(format!("read {name}")).or_default().take(values.iter().copied().enumerate(), table);
            }
        }
        let mut put = |name: String, values: &[f64]| {
            self.ends.entry(name).or_default().take(chunk.placed(values), table);
        };
        data.channels.iter().for_each(|(name, channel)| put(name.clone(), &channel.values));
        for load in LOADS {
            if let [Some(before), Some(after)] = zeros_of(data, load) {
                let drift: Vec<f64> = before.iter().zip(after).map(|(b, a)| a - b).collect();
                put(format!("drift of {load}"), &drift);
            }
        }
        if let (Some(u), Some(w)) = (data.values("v_x"), data.values("v_z")) {
            let across: Vec<f64> = u.iter().zip(w).map(|(u, w)| u.hypot(*w)).collect();
            put("across v_z".to_owned(), &across);
        }
        if let Some(density) = data.values("density") {
            self.density = density.iter().fold(self.density, |sum, rho| sum + rho);
        }
        self.rising.retain(|name, last| {
            let values = chunk.read(name).unwrap_or_default();
            keep.iter().all(|&i| values.get(i).is_some_and(|x| *x > std::mem::replace(last, *x)))
        });
        for &i in keep {
            self.sample.take(table, i);
        }
        // Where the table names none, all rows are of the one without a name.
        let is_named = table.columns.iter().any(|column| column.name == "configuration");
        let configurations = data.configuration.iter().take(if is_named { data.rows } else { 1 });
        add(&mut self.configurations, configurations, MOST_CONFIGURATIONS, source, "configurations")?;
        add(&mut self.groups, data.group.iter().flatten(), MOST_CLUSTERS, source, "clusters of `group`")
    }

    /// Whether no row can be a copy of another: a column rises from each to the next.
    pub(super) fn has_no_copies(&self) -> bool {
        !self.rising.is_empty()
    }

    /// Puts clusters in the place of groups.
    pub(super) fn merge(&mut self, clusters: &IndexMap<String, String>) {
        self.groups = clusters.values().cloned().collect();
        self.merged.clone_from(clusters);
    }

    /// How many clusters there are.
    pub(super) fn clusters(&self) -> usize {
        self.groups.len()
    }

    /// The number of the cluster of each group.
    pub(super) fn numbered(&self, groups: &Texts) -> Vec<u64> {
        let number = |group: &String| self.groups.get_index_of(self.merged.get(group).unwrap_or(group)).unwrap_or(0);
        groups.iter().map(|group| number(group) as u64).collect()
    }

    /// Mean density, where there is one.
    pub(super) fn density(&self) -> Option<f64> {
        self.ends.contains_key("density").then(|| self.density / self.n_used as f64)
    }

    pub(super) fn sample(&self) -> &[Rc<Row>] {
        self.sample.rows()
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Rc<Row>> {
        self.ends.values().flat_map(Ends::rows).chain(self.sample())
    }

    /// The smallest and the largest value of a channel.
    fn range(&self, name: &str) -> [f64; 2] {
        self.ends.get(name).map_or([0.0; 2], Ends::range)
    }

    fn largest(&self, name: &str) -> f64 {
        let [low, high] = self.range(name);
        low.abs().max(high.abs())
    }
}

/// Distinct texts, up to so many.
fn add<'a>(
    to: &mut IndexSet<String>,
    texts: impl Iterator<Item = &'a String>,
    most: usize,
    source: &Source,
    what: &str,
) -> Result<(), IdentifyError> {
    let mut last: Option<&String> = None;
    for text in texts {
        if last != Some(text) && !to.contains(text) {
            to.insert(text.clone());
        }
        last = Some(text);
    }
    if to.len() > most { Err(refusal(source, &format!("more than {most} {what}"))) } else { Ok(()) }
}

/// The second pass.
#[derive(Default)]
pub(super) struct Seconds {
    ends: IndexMap<String, Ends>,
    pub(super) counts: Counts,
}

impl Seconds {
    pub(super) fn take(&mut self, chunk: &Chunk, facts: &Facts, campaign: &Campaign) {
        let Chunk { table, data, keep } = chunk;
        let (velocity, fastest) = (data.velocities_m_s(), facts.largest("speed"));
        // A row that does not count is no number.
        let mut all: Vec<(String, Vec<f64>)> = Vec::new();
        if let Some(speed) = data.values("speed") {
            let mut put = |name: &str, part: f64, at: &dyn Fn(usize) -> f64| {
                let of = |i: usize| if speed[i].abs() > part * fastest { at(i) } else { f64::NAN };
                all.push((name.to_owned(), (0..data.rows).map(of).collect()));
            };
            if let Some(angle) = data.values("angle") {
                put("angle", AT_REST, &|i| angle[i]);
                put("off axis", AT_REST, &|i| off_axis(velocity(i)));
                put("askew", AT_REST, &|i| (2.0 * off_axis(velocity(i))).sin());
            }
            put("along", AT_REST, &|i| velocity(i)[0]);
            for load in ["f_x", "f_y", "f_z"] {
                if let Some(f) = data.values(load) {
                    put(&format!("near {load}"), lint::NEAR_LARGEST_SPEED, &|i| f[i]);
                }
            }
            let [angles, speeds] = apart(table, keep, data);
            if let Some(apart) = angles {
                put("angles apart", lint::motion::AT_REST, &|i| apart[i]);
            }
            all.extend(speeds.map(|apart| ("speeds apart".to_owned(), apart)));
        }
        for (moment, along, athwart, _) in MOMENTS {
            let (Some(u), Some(v)) = (data.values(along), data.values(athwart)) else { continue };
            if data.channels.contains_key(moment) {
                let largest = if athwart == "v_z" { facts.largest("across v_z") } else { fastest };
                let of = |(u, v): (&f64, &f64)| if v.abs() > 1e-9 * largest { v.abs().atan2(*u) } else { f64::NAN };
                all.push((format!("angle of {athwart}"), u.iter().zip(v).map(of).collect()));
            }
        }
        all.extend(per_observation(data, campaign).into_iter().map(|(name, values)| (name.to_owned(), values)));
        for (name, values) in all {
            self.ends.entry(name).or_default().take(chunk.placed(&values), table);
        }
        self.counts.take(data, &|name| facts.range(name));
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Rc<Row>> {
        self.ends.values().flat_map(Ends::rows)
    }
}
