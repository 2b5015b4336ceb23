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
use crate::reduce::{conditioned, kept_rows, zeros_of};
use crate::source::models::MOMENTS;
use crate::validity::{self, AT_REST, off_axis, per_observation};

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

    fn has_velocity(&self) -> bool {
        self.read("v_x").is_some() || self.read("v_y").is_some()
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
        for (name, channel) in &data.channels {
            let ends = self.ends.entry(name.clone()).or_default();
            ends.take(chunk.placed(&channel.values), table);
        }
        for load in LOADS {
            if let [Some(before), Some(after)] = zeros_of(data, load) {
                let drift: Vec<f64> = before.iter().zip(after).map(|(b, a)| a - b).collect();
                self.ends.entry(format!("drift of {load}")).or_default().take(chunk.placed(&drift), table);
            }
        }
        if data.channels.contains_key("v_z") {
            let across = across(data, "v_x", "v_z");
            self.ends.entry("across v_z".to_owned()).or_default().take(chunk.placed(&across), table);
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

/// Speed in the plane of two axes.
fn across(data: &Dataset, x: &str, y: &str) -> Vec<f64> {
    let (u, v) = (data.values(x).unwrap_or_default(), data.values(y).unwrap_or_default());
    u.iter().zip(v).map(|(u, v)| u.hypot(*v)).collect()
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
        let mut put = |name: &str, numbers: &mut dyn Iterator<Item = (usize, f64)>| {
            self.ends.entry(name.to_owned()).or_default().take(numbers, table);
        };
        let fastest = facts.largest("speed");
        if let Some(speed) = data.values("speed") {
            let faster = |part: f64| (0..data.rows).filter(move |&i| speed[i].abs() > part * fastest);
            if let Some(angle) = data.values("angle") {
                put("angle", &mut faster(AT_REST).map(|i| (keep[i], angle[i])));
                let none = vec![0.0; data.rows];
                let along = |name| data.values(name).unwrap_or(&none);
                let (v_x, v_y) = (along("v_x"), along("v_y"));
                let off: Vec<(usize, f64)> = faster(AT_REST).map(|i| (keep[i], off_axis([v_x[i], v_y[i]]))).collect();
                put("off axis", &mut off.iter().copied());
                put("askew", &mut off.iter().map(|(i, angle)| (*i, (2.0 * angle).sin())));
            }
            if let Some(v_x) = data.values(validity::ALONG) {
                put("along", &mut faster(AT_REST).map(|i| (keep[i], v_x[i])));
            }
            if chunk.has_velocity() {
                let stated_speed = chunk.read("speed");
                if let (Some(stated), Some(derived)) = (chunk.read("angle"), data.values("angle")) {
                    let apart = |i: usize| {
                        lint::motion::angles_apart(stated[keep[i]], stated_speed.map(|u| u[keep[i]]), derived[i])
                    };
                    put("angles apart", &mut faster(lint::motion::AT_REST).map(|i| (keep[i], apart(i))));
                }
                if let Some(stated) = stated_speed {
                    put(
                        "speeds apart",
                        &mut (0..data.rows).map(|i| (keep[i], lint::motion::speeds_apart(stated[keep[i]], speed[i]))),
                    );
                }
            }
            for load in ["f_x", "f_y", "f_z"] {
                if let Some(f) = data.values(load) {
                    put(&format!("near {load}"), &mut faster(lint::NEAR_LARGEST_SPEED).map(|i| (keep[i], f[i])));
                }
            }
        }
        for (moment, along, athwart, _) in MOMENTS {
            if let (true, Some(u), Some(v)) =
                (data.channels.contains_key(moment), data.values(along), data.values(athwart))
            {
                let largest = if athwart == "v_z" { facts.largest("across v_z") } else { fastest };
                let askew = (0..data.rows).filter(|&i| v[i].abs() > 1e-9 * largest);
                put(&format!("angle of {athwart}"), &mut askew.map(|i| (keep[i], v[i].abs().atan2(u[i]))));
            }
        }
        for (name, values) in per_observation(data, campaign) {
            put(name, &mut chunk.placed(&values));
        }
        self.counts.take(data, &|name| facts.range(name));
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Rc<Row>> {
        self.ends.values().flat_map(Ends::rows)
    }
}
