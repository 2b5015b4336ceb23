//! A tare in another setting than its own: another fluid, other speeds or angles, the other way; or one whose own record reports errors.

use froude_records::estimate::{CHAIN, Estimate, EstimateFile, Range};
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::angles::SAME_ANGLE_RAD;
use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::lint::motion::moving;
use crate::tare::size::size;
use crate::validity::{ALONG, AT_REST, OFF_AXIS, off_axis};

/// Speeds this far beyond those of the tare runs are still theirs.
const SAME_SPEED: f64 = 0.05;
/// Velocities along x below this part of the speed go neither ahead nor astern.
const ACROSS: f64 = 0.02;

/// What the tare's loads are where it is used.
pub(super) struct Use<'a> {
    pub data: &'a Dataset,
    pub estimate: &'a Estimate,
    pub law: &'a ForceLaw,
    /// Its loads in every row, response by response, N or N m.
    pub predicted: &'a [f64],
}

impl Use<'_> {
    /// For each load of the tare that goes with the motion, the size of a part of it in the measured load, over some rows.
    fn sizes(&self, rows: &[usize], part: &dyn Fn(usize, usize) -> f64) -> Vec<String> {
        let n = self.data.rows;
        let of = |(r, load): (usize, &String)| {
            let (most, percent) = size(rows, &|i| part(r, i) * self.predicted[r * n + i], self.data.values(load)?)?;
            let unit = if load.starts_with('m') { "N m" } else { "N" };
            Some(format!("up to {most:.3} {unit}, over all rows {percent:.1} % of the measured {load}"))
        };
        self.law.responses.iter().enumerate().filter(|(r, _)| self.law.moves(*r)).filter_map(of).collect()
    }

    /// Rows that move and are as `is_meant` says.
    fn rows(&self, is_meant: impl Fn(usize) -> bool) -> Vec<usize> {
        let speed = self.data.values("speed").unwrap_or_default();
        moving(speed, AT_REST).into_iter().filter(|&i| is_meant(i)).collect()
    }

    /// `N of M rows`.
    fn of_all(&self, rows: &[usize]) -> String {
        format!("{} of {}", rows.len(), counted(self.data.rows, "row", "rows"))
    }

    /// Drag is proportional to the density: fresh water and the sea differ by 2.7 %. A law that reads the density has that of these rows.
    pub fn other_fluid(&self) -> Option<Finding> {
        let own = self.estimate.density()?.value;
        let here = self.data.values("density")?;
        let rows: Vec<usize> = (0..self.data.rows).collect();
        let part = |r: usize, i: usize| if self.law.has_density(r) { 0.0 } else { here[i] / own - 1.0 };
        let left = self.sizes(&rows, &part);
        let furthest = here.iter().copied().max_by(|a, b| (a - own).abs().total_cmp(&(b - own).abs()))?;
        (!left.is_empty()).then(|| {
            let text = format!(
                "the tare {} was taken at {own:.2} kg/m^3 and is used at {furthest:.2} kg/m^3: a drag is proportional to the density, so \
                 {} are not subtracted correctly; take the tare in the same fluid",
                self.estimate.id,
                left.join(", ")
            );
            Finding::new(Severity::Warning, "tare-in-another-fluid", text)
        })
    }

    /// The drag of a carriage is along its chain, and subtracted along x.
    pub fn along_the_chain(&self) -> Option<Finding> {
        (self.estimate.frame.name == CHAIN).then(|| {
            let text = format!(
                "the tare {} is along the chain of its carriage and is subtracted from f_x: that is right only where x was along the travel",
                self.estimate.id
            );
            Finding::new(Severity::Note, "tare-along-the-chain", text)
        })
    }

    /// Beyond the speeds of the tare runs its law is a guess.
    pub fn other_speeds(&self) -> Option<Finding> {
        let (low, high) = sizes_of(self.estimate.validity.get("speed")?);
        let speed = self.data.values("speed")?;
        let rows =
            self.rows(|i| speed[i].abs() > (1.0 + SAME_SPEED) * high || speed[i].abs() < (1.0 - SAME_SPEED) * low);
        let taken = self.sizes(&rows, &|_, _| 1.0);
        (!taken.is_empty()).then(|| {
            let text = format!(
                "the tare {} was taken at {low:.3} to {high:.3} m/s and is used beyond that in {}: what it subtracts there ({}) was not \
                 measured; tow the strut alone at the speeds of the test, or leave the others out with `keep`",
                self.estimate.id,
                self.of_all(&rows),
                taken.join(", ")
            );
            Finding::new(Severity::Warning, "tare-beyond-its-speeds", text)
        })
    }

    /// Nearer to straight ahead than any of the tare runs. (Further from it: [`super::angles`].)
    pub fn smaller_angles(&self) -> Option<Finding> {
        let least = self.estimate.validity.get(OFF_AXIS)?.low;
        let rows = self.rows(|i| off_axis(self.data.velocity_m_s(i)) < least - SAME_ANGLE_RAD);
        let taken = self.sizes(&rows, &|_, _| 1.0);
        (!taken.is_empty()).then(|| {
            let text = format!(
                "the tare {} was taken at {:.1} deg from straight ahead and more, and is used nearer to it in {}: what it subtracts there \
                 ({}) was not measured; tow the strut alone at the angles of the test, straight ahead included",
                self.estimate.id,
                least.to_degrees(),
                self.of_all(&rows),
                taken.join(", ")
            );
            Finding::new(Severity::Warning, "tare-beyond-its-angles", text)
        })
    }

    /// A tare that was towed one way only, and is used the other way.
    pub fn other_way(&self) -> Option<Finding> {
        let (ahead, astern) = self.ways()?;
        let speed = self.data.values("speed")?;
        let rows = self.rows(|i| {
            let along = self.data.velocity_m_s(i)[0];
            along.abs() > ACROSS * speed[i].abs() && !(if along > 0.0 { ahead } else { astern })
        });
        let taken = self.sizes(&rows, &|_, _| 1.0);
        (!taken.is_empty()).then(|| {
            let [own, here] = if ahead { ["ahead", "astern"] } else { ["astern", "ahead"] };
            let text = format!(
                "the tare {} was towed {own} only and is used {here} in {}: what it subtracts there ({}) was not measured; it holds for a \
                 strut that is the same fore and aft, by a law that is odd in the velocity",
                self.estimate.id,
                self.of_all(&rows),
                taken.join(", ")
            );
            Finding::new(Severity::Note, "tare-of-the-other-way", text)
        })
    }

    /// Whether the tare was towed ahead and astern; `None` where its record does not say.
    fn ways(&self) -> Option<(bool, bool)> {
        let validity = &self.estimate.validity;
        let range = match (validity.get(ALONG), validity.get("speed")) {
            (Some(along), _) => along,
            (None, Some(speed)) if !validity.contains_key("angle") => speed,
            _ => return None,
        };
        let least = ACROSS * range.low.abs().max(range.high.abs());
        let (ahead, astern) = (range.high > least, range.low < -least);
        (ahead || astern).then_some((ahead, astern))
    }

    /// A strut resists. A law that is even in the velocity, or at other angles than its own, may push the body along.
    pub fn pushes(&self) -> Option<Finding> {
        let n = self.data.rows;
        let of = |load: &str| self.law.responses.iter().position(|response| response == load);
        let power = |i: usize| {
            let velocity = self.data.velocity_m_s(i);
            let of_axis = |(load, v): (&str, f64)| of(load).map_or(0.0, |r| self.predicted[r * n + i] * v);
            [("f_x", velocity[0]), ("f_y", velocity[1])].into_iter().map(of_axis).sum::<f64>()
        };
        let rows = self.rows(|i| power(i) > 0.0);
        let taken = self.sizes(&rows, &|_, _| 1.0);
        (!taken.is_empty()).then(|| {
            let text = format!(
                "the tare {} propels the body in {}, which no strut does: {}. Check the sign of the speed where the strut went \
                 astern, a law that is even in it, and the angles of the tare runs",
                self.estimate.id,
                self.of_all(&rows),
                taken.join(", ")
            );
            Finding::new(Severity::Warning, "tare-pushes", text)
        })
    }
}

/// Smallest and largest size of a signed speed, m/s.
fn sizes_of(range: &Range) -> (f64, f64) {
    let low = if range.low <= 0.0 && range.high >= 0.0 { 0.0 } else { range.low.abs().min(range.high.abs()) };
    (low, range.low.abs().max(range.high.abs()))
}

/// What the record itself calls an error of this estimate.
pub(super) fn own_errors(file: &EstimateFile, estimate: &Estimate) -> Option<Finding> {
    let is_own = |f: &&Finding| {
        f.severity == Severity::Error && f.source.as_ref().is_none_or(|source| *source == estimate.source)
    };
    let errors: Vec<&Finding> = file.findings.iter().filter(is_own).collect();
    let first = errors.first()?;
    let text = format!(
        "the record of the tare {} has {} of its own, [{}] first: {}",
        estimate.id,
        counted(errors.len(), "ERROR", "ERRORs"),
        first.code,
        first.message
    );
    Some(Finding::new(Severity::Warning, "tare-with-errors", text))
}
