//! The observations of one source, as channels in SI units over rows.
//!
//! **Frame.** Body axes, x forward, y to starboard, z down; loads are those the
//! fluid exerts on the body. `speed` and `angle` belong to the velocity by
//! v = (U cos θ, −U sin θ), so that `angle ≡ atan2(−v_y, v_x)`.

use froude_records::table::{Column, ColumnData};
use froude_records::texts::Texts;
use froude_records::units::Dimension;
use indexmap::{IndexMap, IndexSet};

use crate::formula::aliased;

/// One channel: a number per row, SI, with its dimension.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Values in SI, one per row.
    pub values: Vec<f64>,
    /// What they are.
    pub dimension: Dimension,
}

/// The rows of one source after reduction.
#[derive(Debug, Clone, Default)]
pub struct Dataset {
    /// Number of rows.
    pub rows: usize,
    /// Numbers by name: `v_x`, `speed`, `angle`, `f_x`, `n_links`, `density`, …
    pub channels: IndexMap<String, Channel>,
    /// Configuration of each row; empty text where the table has none.
    pub configuration: Texts,
    /// Setup of each row.
    pub setup: Texts,
    /// Run of each row.
    pub run: Texts,
    /// Cluster that each row belongs to, by the source's `group` column.
    pub group: Option<Texts>,
    /// What its clusters are.
    pub grouped_by: GroupedBy,
    /// Line of each row in its file.
    pub line: Vec<usize>,
    /// Headers of the table's columns, with the units that its numbers were written in; empty where no table was read.
    pub headers: Vec<String>,
    /// Headers of columns in the file that its sidecar does not name.
    pub left_out: Vec<String>,
    /// Loads that were not measured in some rows: whether each row is an observation of the load.
    pub observed: IndexMap<String, Vec<bool>>,
    /// Loads that no sensor read, as a declared weight: that repeats have one value says nothing of its scatter.
    pub stated: Vec<String>,
    /// Loads that an actuator exerts, and not the water.
    pub actuators: Vec<String>,
    /// What these rows were drawn from, where they are a sample.
    pub sample: Option<Drawn>,
}

/// What the clusters of observations are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GroupedBy {
    /// What a column of the table says.
    #[default]
    Column,
    /// Runs, whose rows follow each other in time where there are several.
    Run,
    /// Motions, each of one run or of several that repeat it.
    Motion,
}

impl GroupedBy {
    /// The word of one of them.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Column => "group",
            Self::Run => "run",
            Self::Motion => "motion",
        }
    }

    /// The word of several.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Column => "groups",
            Self::Run => "runs",
            Self::Motion => "motions",
        }
    }
}

/// What is known of all observations of which a data set holds a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawn {
    /// How many there are.
    pub rows: usize,
    /// Distinct texts of the `group` column.
    pub clusters: usize,
    /// Distinct configurations, in order of first appearance.
    pub configurations: Vec<String>,
}

/// Unit text of a channel; `1` where the table has none of that name.
#[must_use]
pub fn unit_text(data: &Dataset, channel: &str) -> String {
    data.dimension(channel).unwrap_or(Dimension::ONE).to_string()
}

/// Names of the loads, in the order of the axes.
pub const LOADS: [&str; 6] = ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"];

impl Dataset {
    /// The values of a channel, if the table has it.
    #[must_use]
    pub fn values(&self, name: &str) -> Option<&[f64]> {
        self.channels.get(name).map(|c| c.values.as_slice())
    }

    /// Configuration, setup and run as columns, where they have names.
    pub(crate) fn named_columns(&self) -> impl Iterator<Item = Column> {
        let all = [("configuration", &self.configuration), ("setup", &self.setup), ("run", &self.run)];
        let named = all.into_iter().filter(|(_, texts)| texts.iter().any(|text| !text.is_empty()));
        named.map(|(name, texts)| Column { name: name.to_owned(), data: ColumnData::Text(texts.clone()) })
    }

    /// The dimension of a channel, if the table has it.
    #[must_use]
    pub fn dimension(&self, name: &str) -> Option<Dimension> {
        self.channels.get(name).map(|c| c.dimension)
    }

    /// The channel that a name means: the table's own column of that name, else the one that `u v w p q r` or `X Y Z K M N` stands for.
    #[must_use]
    pub fn meant<'a>(&self, name: &'a str) -> &'a str {
        if self.channels.contains_key(name) { name } else { aliased(name) }
    }

    /// The loads that the table measures.
    #[must_use]
    pub fn loads(&self) -> Vec<&'static str> {
        LOADS.into_iter().filter(|l| self.channels.contains_key(*l)).collect()
    }

    /// Whether a load is one of the water: no actuator exerts it.
    #[must_use]
    pub fn is_of_water(&self, load: &str) -> bool {
        self.actuators.iter().all(|other| other != load)
    }

    /// Whether row `i` is an observation of a load.
    #[must_use]
    pub fn observes(&self, load: &str, i: usize) -> bool {
        self.observed.get(load).is_none_or(|is| is[i])
    }

    /// Header of a column, `f_x [mN]` say; the bare name where no table was read.
    #[must_use]
    pub fn header<'a>(&'a self, name: &'a str) -> &'a str {
        let is_of = |header: &&String| header.split(" [").next() == Some(name);
        self.headers.iter().find(is_of).map_or(name, String::as_str)
    }

    /// What to call row `i` in a message: `line 7`, and the run where it has one.
    #[must_use]
    pub fn row_name(&self, i: usize) -> String {
        let line = self.line.get(i).copied().unwrap_or(i + 1);
        match self.run.get(i).filter(|run| !run.is_empty()) {
            Some(run) => format!("line {line}, run {run}"),
            None => format!("line {line}"),
        }
    }

    /// Velocity of row `i` through the water, m/s, body axes; zero where the table has no motion.
    #[must_use]
    pub fn velocity_m_s(&self, i: usize) -> [f64; 2] {
        self.velocities_m_s()(i)
    }

    /// [`Self::velocity_m_s`] of many rows, the channels looked up once.
    pub fn velocities_m_s(&self) -> impl Fn(usize) -> [f64; 2] {
        let channels = ["v_x", "v_y"].map(|name| self.values(name));
        move |i| channels.map(|v| v.map_or(0.0, |v| v[i]))
    }

    /// A copy in which `name` of every row is moved by `shift[row]`, with what depends on it.
    ///
    /// A shift of `speed` or `angle` moves the velocity, one of `v_x` or `v_y` moves speed and angle.
    ///
    /// `shift` has one entry per row, in SI units of the channel (m/s, rad, N, …).
    #[must_use]
    pub fn shifted(&self, name: &str, shift: &[f64]) -> Self {
        let mut moved = self.clone();
        if let Some(channel) = moved.channels.get_mut(name) {
            for (value, by) in channel.values.iter_mut().zip(shift) {
                *value += by;
            }
        }
        match name {
            "speed" | "angle" => moved.velocity_from_speed_and_angle(),
            "v_x" | "v_y" => moved.speed_and_angle_from_velocity(),
            _ => {}
        }
        moved
    }

    /// Sets `v_x`, `v_y` from `speed` and `angle` (zero where the table has none).
    ///
    /// v = (U cos θ, −U sin θ), m/s, with θ in rad.
    ///
    /// # Source
    ///
    /// USR eq. 5 with ẋ = (U, 0) and no current.
    pub fn velocity_from_speed_and_angle(&mut self) {
        let Some(speed) = self.values("speed").map(<[f64]>::to_vec) else { return };
        let angle = self.values("angle").map_or_else(|| vec![0.0; self.rows], <[f64]>::to_vec);
        // The axes exactly: the rounding of cos 90° is no motion.
        let snap = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
        let v_x = speed.iter().zip(&angle).map(|(u, a)| u * snap(a.cos())).collect();
        let v_y = speed.iter().zip(&angle).map(|(u, a)| -u * snap(a.sin())).collect();
        self.put("v_x", v_x, Dimension::SPEED);
        self.put("v_y", v_y, Dimension::SPEED);
        self.put("angle", angle, Dimension::ONE);
    }

    /// Sets `speed` and `angle` from `v_x`, `v_y`.
    ///
    /// U = √(v_x² + v_y²), m/s, and θ = atan2(−v_y, v_x), rad, in (−π, π].
    pub fn speed_and_angle_from_velocity(&mut self) {
        let along = |name| self.values(name).map_or_else(|| vec![0.0; self.rows], <[f64]>::to_vec);
        let (v_x, v_y) = (along("v_x"), along("v_y"));
        self.put("speed", v_x.iter().zip(&v_y).map(|(x, y)| x.hypot(*y)).collect(), Dimension::SPEED);
        self.put("angle", v_x.iter().zip(&v_y).map(|(x, y)| (-y).atan2(*x)).collect(), Dimension::ONE);
    }

    /// Sets a channel.
    ///
    /// `values` are in SI, one per row.
    pub fn put(&mut self, name: &str, values: Vec<f64>, dimension: Dimension) {
        self.channels.insert(name.to_owned(), Channel { values, dimension });
    }

    /// The rows named by `keep`, in that order.
    #[must_use]
    pub fn subset(&self, keep: &[usize]) -> Self {
        Self {
            rows: keep.len(),
            channels: self
                .channels
                .iter()
                .map(|(name, c)| {
                    let values = keep.iter().map(|&i| c.values[i]).collect();
                    (name.clone(), Channel { values, dimension: c.dimension })
                })
                .collect(),
            configuration: self.configuration.subset(keep),
            setup: self.setup.subset(keep),
            run: self.run.subset(keep),
            group: self.group.as_ref().map(|group| group.subset(keep)),
            grouped_by: self.grouped_by,
            line: keep.iter().filter_map(|&i| self.line.get(i).copied()).collect(),
            headers: self.headers.clone(),
            left_out: self.left_out.clone(),
            observed: (self.observed.iter())
                .map(|(load, is)| (load.clone(), keep.iter().map(|&i| is[i]).collect()))
                .collect(),
            stated: self.stated.clone(),
            actuators: self.actuators.clone(),
            sample: self.sample.clone(),
        }
    }

    /// The rows of `keep`, which is in order; no copy where these are all.
    pub(crate) fn keeping(self, keep: &[usize]) -> Self {
        if keep.len() < self.rows { self.subset(keep) } else { self }
    }

    /// Distinct configurations in order of first appearance.
    #[must_use]
    pub fn configurations(&self) -> Vec<String> {
        distinct(&self.configuration)
    }

    /// Observations: the rows, or those that they were drawn from.
    #[must_use]
    pub fn observations(&self) -> usize {
        self.sample.as_ref().map_or(self.rows, |all| all.rows)
    }

    /// Clusters of the observations; 0 without a `group`.
    #[must_use]
    pub fn clusters(&self) -> usize {
        let of_rows = || self.group.as_ref().map_or(0, |group| distinct(group).len());
        self.sample.as_ref().map_or_else(of_rows, |all| all.clusters)
    }
}

/// Distinct texts in order of first appearance.
#[must_use]
pub fn distinct<'a>(texts: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let seen: IndexSet<&String> = texts.into_iter().collect();
    seen.into_iter().cloned().collect()
}

/// Index of each text among the distinct ones.
#[must_use]
pub fn labels<'a>(texts: impl IntoIterator<Item = &'a String>) -> Vec<usize> {
    let mut seen = IndexSet::new();
    texts.into_iter().map(|text| seen.insert_full(text).0).collect()
}
