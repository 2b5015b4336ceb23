//! A tare in another setting than its own: another fluid, other speeds, the other way; or one that its own record calls wrong.

use froude_records::estimate::{Estimate, EstimateFile, Range};
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::size;
use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::lint::moving;
use crate::validity::AT_REST;

/// Speeds this far beyond those of the tare runs are still theirs.
const SAME_SPEED: f64 = 0.05;

/// What the tare's loads would be elsewhere, and how much of a load that makes.
pub(super) struct Use<'a> {
    pub data: &'a Dataset,
    pub estimate: &'a Estimate,
    pub law: &'a ForceLaw,
    /// Its loads in every row, response by response, N or N m.
    pub predicted: &'a [f64],
}

impl Use<'_> {
    /// For each load of the tare, the size of a part of it in the measured load, over some rows.
    fn sizes(&self, rows: &[usize], part: &dyn Fn(usize) -> f64) -> Vec<String> {
        let n = self.data.rows;
        let of = |(r, load): (usize, &String)| {
            let (most, percent) = size(rows, &|i| part(i) * self.predicted[r * n + i], self.data.values(load)?)?;
            let unit = if load.starts_with('m') { "N m" } else { "N" };
            Some(format!("up to {most:.3} {unit}, {percent:.1} % of the measured {load}"))
        };
        self.law.responses.iter().enumerate().filter_map(of).collect()
    }

    /// Drag goes with the density: fresh water and the sea differ by 2.5 %.
    pub fn other_fluid(&self) -> Option<Finding> {
        let own = self.estimate.density.as_ref()?.value;
        let here = self.data.values("density")?;
        let rows: Vec<usize> = (0..self.data.rows).collect();
        let left = self.sizes(&rows, &|i| here[i] / own - 1.0);
        let furthest = here.iter().copied().max_by(|a, b| (a - own).abs().total_cmp(&(b - own).abs()))?;
        (!left.is_empty()).then(|| {
            let text = format!(
                "the tare {} was taken at {own:.2} kg/m^3 and is used at {furthest:.2} kg/m^3: a drag goes with the density, so that {} are \
                 not taken off as they should be; take the tare in the same fluid",
                self.estimate.id,
                left.join(", ")
            );
            Finding::new(Severity::Warning, "tare-in-another-fluid", text)
        })
    }

    /// Beyond the speeds of the tare runs its law is a guess.
    pub fn other_speeds(&self) -> Option<Finding> {
        let range = self.estimate.validity.get("speed")?;
        let speed = self.data.values("speed")?;
        let (low, high) = sizes_of(range);
        let is_beyond = |u: f64| u.abs() > (1.0 + SAME_SPEED) * high || u.abs() < (1.0 - SAME_SPEED) * low;
        let rows: Vec<usize> = moving(speed, AT_REST).into_iter().filter(|&i| is_beyond(speed[i])).collect();
        let taken = self.sizes(&rows, &|_| 1.0);
        (!taken.is_empty()).then(|| {
            let text = format!(
                "the tare {} was taken at {low:.3} to {high:.3} m/s and is used beyond that in {} of {}: what it takes off there ({}) was \
                 not measured; tow the strut alone at the speeds of the test",
                self.estimate.id,
                rows.len(),
                counted(self.data.rows, "row", "rows"),
                taken.join(", ")
            );
            Finding::new(Severity::Warning, "tare-beyond-its-speeds", text)
        })
    }

    /// A tare that was towed one way only, and is used the other way.
    pub fn other_way(&self) -> Option<Finding> {
        let range = self.estimate.validity.get("speed")?;
        let turned = self.estimate.validity.get("angle").map_or([false; 2], |angle| {
            let largest = angle.low.abs().max(angle.high.abs());
            let least = if angle.low <= 0.0 && angle.high >= 0.0 { 0.0 } else { angle.low.abs().min(angle.high.abs()) };
            [least.cos() < 0.0, largest.cos() < 0.0]
        });
        // Ahead: some speed above zero not turned round, or one below zero that is.
        let goes = |forth: bool, back: bool, turned: [bool; 2]| (forth && !turned[0]) || (back && turned[1]);
        let (forth, back) = (range.high > 0.0, range.low < 0.0);
        let (ahead, astern) = (goes(forth, back, turned), goes(back, forth, turned));
        let speed = self.data.values("speed")?;
        let rows: Vec<usize> = moving(speed, AT_REST)
            .into_iter()
            .filter(|&i| {
                let v_x = self.data.velocity_m_s(i)[0];
                (v_x > 0.0 && !ahead) || (v_x < 0.0 && !astern)
            })
            .collect();
        let taken = self.sizes(&rows, &|_| 1.0);
        (!taken.is_empty()).then(|| {
            let [own, here] = if ahead { ["ahead", "astern"] } else { ["astern", "ahead"] };
            let text = format!(
                "the tare {} was towed {own} only and is used {here} in {} of {}: what it takes off there ({}) is that of a strut that is the \
                 same fore and aft",
                self.estimate.id,
                rows.len(),
                counted(self.data.rows, "row", "rows"),
                taken.join(", ")
            );
            Finding::new(Severity::Note, "tare-of-the-other-way", text)
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
