//! Lints that count rows, of a table at once or a chunk at a time: the ends of every range are known before.

use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::lint::motion::{ALONG, has_other_cause};

/// Share of rows at one extreme value that looks like a saturated sensor.
const SATURATED_SHARE: f64 = 0.02;
/// A linear and a quadratic term need at least this many distinct speeds.
const DISTINCT_SPEEDS_NEEDED: usize = 3;
/// Angles all below this, over at least eight rows, were probably typed in radians (π/2 read as degrees).
const RADIAN_SUSPICION_RAD: f64 = 1.6 * std::f64::consts::PI / 180.0;
/// A load below this share of the largest is too small for its sign to say anything.
pub(crate) const SIGN_MATTERS_ABOVE: f64 = 0.05;

/// What is counted of all rows.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    rows: usize,
    /// The ends of each load, and the rows there.
    at_ends: IndexMap<&'static str, [(f64, usize); 2]>,
    /// By load and motion.
    pushed: IndexMap<(&'static str, &'static str), Pushed>,
    /// Of the sizes of each speed, and of the angle.
    steps: IndexMap<String, Steps>,
}

/// Rows in which a load points along the motion.
#[derive(Debug, Default)]
struct Pushed {
    /// Rows large enough to tell.
    large: usize,
    along: usize,
    /// Line of the first of them.
    line: usize,
}

/// Steps of a channel that some row has, from that of its largest size below zero to that above. Settings are typed with few digits; a thousandth of the largest separates them.
#[derive(Debug, Default)]
struct Steps {
    largest: f64,
    has: Vec<bool>,
}

impl Steps {
    const MOST: i64 = 1000;

    fn take(&mut self, values: impl Iterator<Item = f64>) {
        self.has.resize(2 * Self::MOST as usize + 1, false);
        for x in values {
            let step = (x / self.largest.max(f64::MIN_POSITIVE) * Self::MOST as f64).round() as i64;
            if let Some(has) = usize::try_from(step + Self::MOST).ok().and_then(|step| self.has.get_mut(step)) {
                *has = true;
            }
        }
    }

    fn count(&self) -> usize {
        self.has.iter().filter(|has| **has).count()
    }
}

impl Counts {
    /// Of rows that are there at once.
    pub(crate) fn of(data: &Dataset) -> Self {
        let mut out = Self::default();
        out.take(data, &|name| {
            let values = data.values(name).unwrap_or_default();
            let [low, high] =
                values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(*x), h.max(*x)]);
            [low, high]
        });
        out
    }

    /// Takes in a chunk of rows; `range` is that of a channel in all of them.
    pub(crate) fn take(&mut self, data: &Dataset, range: &dyn Fn(&str) -> [f64; 2]) {
        let largest = |name: &str| range(name).into_iter().fold(0.0_f64, |m, end| m.max(end.abs()));
        self.rows += data.rows;
        for load in data.loads() {
            let f = data.values(load).unwrap_or_default();
            for (end, count) in self.at_ends.entry(load).or_insert_with(|| range(load).map(|end| (end, 0))) {
                *count += f.iter().filter(|x| **x == *end).count();
            }
        }
        for (load, motion) in ALONG {
            let (Some(f), Some(v)) = (data.values(load), data.values(motion)) else { continue };
            let pushed = self.pushed.entry((load, motion)).or_default();
            let [least_f, least_v] = [load, motion].map(|name| SIGN_MATTERS_ABOVE * largest(name));
            for (i, (f, v)) in f.iter().zip(v).enumerate().filter(|(_, (f, v))| f.abs() > least_f && v.abs() > least_v)
            {
                pushed.large += 1;
                if f * v > 0.0 {
                    if pushed.along == 0 {
                        pushed.line = data.line.get(i).copied().unwrap_or(0);
                    }
                    pushed.along += 1;
                }
            }
        }
        for (name, channel) in data.channels.iter().filter(|(name, _)| is_speed(name) || *name == "angle") {
            let steps = self.steps.entry(name.clone()).or_default();
            steps.largest = largest(name);
            // The laws are odd in the speed: ahead and astern are one.
            let is_odd = is_speed(name);
            steps.take(channel.values.iter().map(|x| if is_odd { x.abs() } else { *x }));
        }
    }

    /// What they show; `data` has the rows at the ends of the ranges.
    pub(crate) fn findings(&self, data: &Dataset, laws: &[ForceLaw]) -> Vec<Finding> {
        let mut out: Vec<Finding> =
            self.pushed.iter().filter_map(|(of, pushed)| self.along_motion(*of, pushed, data, laws)).collect();
        let read = self.at_ends.iter().filter(|(load, _)| data.stated.iter().all(|stated| stated != *load));
        for (load, [smallest, largest]) in read {
            out.extend([("largest", largest), ("smallest", smallest)].into_iter().filter_map(
                |(word, (end, there))| {
                    let is_much = *there >= 3 && *there as f64 > SATURATED_SHARE * self.rows as f64;
                    let text = format!(
                        "{load}: {there} rows lie exactly at the {word} value {end}; the sensor may be saturated"
                    );
                    (*end != 0.0 && is_much).then(|| Finding::new(Severity::Warning, "saturation", text))
                },
            ));
        }
        out.extend(self.angle_in_radians(data));
        out.extend(self.few_speeds(data, laws));
        out
    }

    /// Loads along the motion: a drag that pushes.
    fn along_motion(
        &self,
        (load, motion): (&str, &str),
        Pushed { large, along, line }: &Pushed,
        data: &Dataset,
        laws: &[ForceLaw],
    ) -> Option<Finding> {
        // What slows down is pushed by the water that goes with it.
        let slows = data.values(&format!("{motion}_dot")).is_some_and(|a| a.iter().any(|a| *a != 0.0));
        if *along == 0 || slows || !data.is_of_water(load) || has_other_cause(load, laws) {
            return None;
        }
        let of = if *large == self.rows {
            format!("in {along} of {large} rows")
        } else {
            format!("in {along} of the {large} rows large enough to tell ({} in all)", self.rows)
        };
        Some(if along * 2 > *large {
            let text = format!(
                "{load} points along {motion} {of}: a drag must oppose the motion; if the sensor is mounted the other \
                 way round, write sign = -1 for its column, or remove it if it is there; if an actuator exerts it, call the column {} or write actuator = [\"{load}\"] in \
                 [[source]]{}",
                if load.starts_with("m_") { "torque" } else { "thrust" },
                if motion == "v_y" && data.channels.contains_key("angle") {
                    "; if the angle is counted in the opposite sense (Fossen's sideslip angle, asin(v/U)), write sign = -1 for the angle column instead"
                } else {
                    ""
                }
            );
            Finding::new(Severity::Error, "force-along-motion", text)
        } else {
            let text = format!(
                "{load} points along {motion} {of}, first on line {line}; check zero and mounting of these runs"
            );
            Finding::new(Severity::Warning, "force-along-motion", text)
        })
    }

    /// Angles so small that they look like radians in a column of degrees.
    fn angle_in_radians(&self, data: &Dataset) -> Option<Finding> {
        let angle = self.steps.get("angle")?;
        // One that follows from velocities was typed by nobody.
        let is_typed =
            data.headers.is_empty() || data.headers.iter().any(|header| header.split(" [").next() == Some("angle"));
        let (distinct, largest) = (angle.count(), angle.largest);
        (is_typed && distinct >= 5 && largest > 0.0 && largest <= RADIAN_SUSPICION_RAD).then(|| {
            let text = format!(
                "all {distinct} angles lie within ±{:.3} deg: they look like radians in a column of degrees; \
                 head the column `angle [rad]` if so",
                largest.to_degrees()
            );
            Finding::new(Severity::Warning, "angle-in-radians", text)
        })
    }

    /// Too few distinct speeds to distinguish a linear from a quadratic term, along every axis that a law reads.
    fn few_speeds(&self, data: &Dataset, laws: &[ForceLaw]) -> Option<Finding> {
        data.values("speed")?;
        // A law that also reads a tip speed ratio, say, has its terms in that.
        let is_known = |name: &str| is_speed(name) || matches!(name, "angle" | "density" | "n_links");
        let of_speeds =
            laws.iter().map(ForceLaw::channels).filter(|channels| channels.iter().all(|name| is_known(name)));
        let distinct = |name: &str| Some(self.steps.get(name).filter(|_| is_speed(name))?.count());
        let most = of_speeds.flatten().filter_map(distinct).max()?;
        (most < DISTINCT_SPEEDS_NEEDED).then(|| {
            let text = format!(
                "{}: a linear and a quadratic term cannot be distinguished with fewer than {DISTINCT_SPEEDS_NEEDED}",
                counted(most, "distinct speed", "distinct speeds")
            );
            Finding::new(Severity::Warning, "few-speeds", text)
        })
    }
}

fn is_speed(name: &str) -> bool {
    name == "speed" || name.starts_with("v_") && !name.ends_with("_dot")
}
