//! Which settings a campaign should compute next: those beside settings that the others foretell worst.
//!
//! **Leave one out.** At a speed, the load over ½ρU²A (moments also over the length) of each angle between the first and the last is foretold by the cubic through two others on each side (the parabola, where on one side there is only one), and of each speed head on between the slowest and the fastest likewise over ln U. What that misses, over the largest of that load and configuration, is the disagreement. Where loads are smooth it is small, and more settings tell nothing new; at a bend it is large.
//! **New settings.** Halfway to both neighbours of the worst setting, then of the next, until there are as many as are asked for.
//! **Enough.** A miss below twice its own iterative uncertainty, or below a hundredth, is not counted: where no other is left, nothing is suggested.
//!
//! A cubic over a gap twice as wide as that of the campaign errs more than one over the campaign's own, so that disagreements are on the safe side.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::case::Flow;
use crate::collect::Collected;

/// Others on each side that a cubic goes through.
const BESIDE: usize = 2;
/// Speeds this close, as a part, and angles, rad, are one.
const SAME: f64 = 1e-6;
/// Iterative uncertainties that a miss must exceed.
const COVERAGE: f64 = 2.0;
/// Least miss that counts, over the largest load: the mesh errs by more.
const LEAST: f64 = 0.01;

/// A setting that the others foretell badly.
#[derive(Debug, Clone, PartialEq)]
pub struct Miss {
    /// Configuration.
    pub configuration: String,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Angle, rad.
    pub angle_rad: f64,
    /// The load that is foretold worst, 0 to 5.
    pub load: usize,
    /// By how much, over the largest of this load and configuration over ½ρU²A \[-\].
    pub missed_part: f64,
    /// The standard uncertainty of that, from what is known of the iterations \[-\].
    pub std: f64,
    /// Settings halfway to its neighbours: speed, m/s, and angle, rad.
    pub beside: Vec<[f64; 2]>,
}

impl Miss {
    /// Whether it says more than the uncertainty of the iterations and of the mesh.
    #[must_use]
    pub fn counts(&self) -> bool {
        self.missed_part > LEAST.max(COVERAGE * self.std)
    }
}

/// The settings between others, the worst foretold first; `planned` are the flows of all cases, with a result or without.
///
/// Rows out of the plane of symmetry are passed over, as is what has fewer than five settings in a row.
#[must_use]
pub fn misses(rows: &[Collected], planned: &[(String, Flow)]) -> Vec<Miss> {
    let mut lines: BTreeMap<(String, u64), Vec<&Collected>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.case.flow.pitch_rad == 0.0) {
        let name = &row.case.configuration;
        lines.entry((name.clone(), row.case.flow.speed_m_s.to_bits())).or_default().push(row);
        if row.case.flow.angle_rad == 0.0 {
            lines.entry((name.clone(), 0)).or_default().push(row);
        }
    }
    let mut out: Vec<Miss> =
        lines.iter().flat_map(|((name, speed), line)| of_line(rows, planned, name, line, *speed == 0)).collect();
    out.sort_by(worse);
    out
}

/// Speeds, m/s, and angles, rad, by configuration, of at most so many new settings.
#[must_use]
pub fn suggested(misses: &[Miss], most: usize) -> Vec<(String, [f64; 2])> {
    let mut out: Vec<(String, [f64; 2])> = Vec::new();
    for miss in misses.iter().filter(|miss| miss.counts()) {
        for &beside in &miss.beside {
            let is_there = out.iter().any(|(name, other)| *name == miss.configuration && *other == beside);
            if !is_there && out.len() < most {
                out.push((miss.configuration.clone(), beside));
            }
        }
    }
    out
}

/// The settings of one speed by angle, or of those head on by speed.
fn of_line(
    all: &[Collected],
    planned: &[(String, Flow)],
    name: &str,
    line: &[&Collected],
    is_by_speed: bool,
) -> Vec<Miss> {
    let place = |row: &Collected| if is_by_speed { row.case.flow.speed_m_s.ln() } else { row.case.flow.angle_rad };
    let mut line = line.to_vec();
    line.sort_by(|a, b| place(a).total_cmp(&place(b)));
    line.dedup_by(|a, b| place(a) == place(b));
    if line.len() < 1 + 2 * BESIDE {
        return Vec::new();
    }
    let largest = |k: usize| {
        let own = all.iter().filter(|row| row.case.configuration == name);
        own.map(|row| over(row, k).abs()).fold(0.0, f64::max)
    };
    // Head on a body of symmetry has no force across, and what there is of it is the solver's.
    let loads: Vec<(usize, f64)> = if is_by_speed { &[0][..] } else { &[0, 1, 5] }
        .iter()
        .map(|k| (*k, largest(*k)))
        .filter(|(_, largest)| *largest > 0.0)
        .collect();
    let inner = 1..line.len() - 1;
    let misses = inner.filter_map(|i| {
        let (row, x) = (line[i], place(line[i]));
        let near = i.saturating_sub(BESIDE)..=(i + BESIDE).min(line.len() - 1);
        let others: Vec<&Collected> = near.filter(|j| *j != i).map(|j| line[j]).collect();
        let weights = lagrange(&others.iter().map(|row| place(row)).collect::<Vec<_>>(), x);
        let flow = row.case.flow;
        let halfway = |other: &Collected| {
            let middle = 0.5 * (x + place(other));
            if is_by_speed { [middle.exp(), flow.angle_rad] } else { [flow.speed_m_s, middle] }
        };
        let is_new = |[speed_m_s, angle_rad]: &[f64; 2]| {
            !planned.iter().any(|(other, flow)| {
                other == name
                    && flow.pitch_rad == 0.0
                    && (flow.speed_m_s / speed_m_s - 1.0).abs() < SAME
                    && (flow.angle_rad - angle_rad).abs() < SAME
            })
        };
        let of_load = |(load, largest): &(usize, f64)| {
            let foretold: f64 = others.iter().zip(&weights).map(|(row, w)| w * over(row, *load)).sum();
            let squares: f64 = others.iter().zip(&weights).map(|(row, w)| (w * std(row, *load)).powi(2)).sum();
            Miss {
                configuration: name.to_owned(),
                speed_m_s: flow.speed_m_s,
                angle_rad: flow.angle_rad,
                load: *load,
                missed_part: (over(row, *load) - foretold).abs() / largest,
                std: (squares + std(row, *load).powi(2)).sqrt() / largest,
                beside: [line[i - 1], line[i + 1]].map(halfway).into_iter().filter(is_new).collect(),
            }
        };
        loads.iter().map(of_load).min_by(worse)
    });
    misses.collect()
}

/// Those that count first, and of them the largest.
fn worse(a: &Miss, b: &Miss) -> Ordering {
    b.counts().cmp(&a.counts()).then(b.missed_part.total_cmp(&a.missed_part))
}

/// A load over ½ρU²A, of a moment also over the length.
fn over(row: &Collected, load: usize) -> f64 {
    row.loads[load] / row.case.load_scales()[load]
}

/// Its standard uncertainty from the iterations, likewise.
fn std(row: &Collected, load: usize) -> f64 {
    row.outcome.std_iterative.map_or(0.0, |std| std[load] / row.case.load_scales()[load])
}

/// Weights of values at some places for the value of the polynomial through them at another.
fn lagrange(places: &[f64], x: f64) -> Vec<f64> {
    let weight = |i: usize| {
        let others = places.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| (x - other) / (places[i] - other)).product()
    };
    (0..places.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, Model, Reference, Stop, Water};
    use crate::outcome::{Outcome, Status};

    fn row(speed_m_s: f64, angle_deg: f64, over: impl Fn(f64) -> f64, std: f64) -> Collected {
        let case = Case {
            id: String::new(),
            configuration: "H1LT".to_owned(),
            mesh: String::new(),
            is_half: true,
            flow: Flow { speed_m_s, angle_rad: angle_deg.to_radians(), pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 1, window: 1, drift: 0.0, spread: 0.0 },
            reference: Reference { length_m: 1.0, width_m: 1.0, area_m2: 1.0, point_m: [0.0; 3] },
            start_from: None,
        };
        let scale = case.load_scales()[0];
        let mut loads = [0.0; 6];
        loads[1] = scale * over(angle_deg);
        let outcome = Outcome {
            status: Status::Converged,
            reason: String::new(),
            loads: Some(loads),
            pressure: None,
            std_iterative: Some([std * scale; 6]),
            iterations: 1,
            cpu_s: 1.0,
            y_plus: None,
            mesh: None,
            start_from: None,
            cells: 1,
            solver_version: String::new(),
        };
        Collected { case, outcome, loads }
    }

    #[test]
    fn a_bend_is_found_and_settings_are_put_on_both_sides_of_it() {
        // A cubic, and above 50° a steep rise.
        let bent = |a: f64| (a / 90.0).powi(3) + if a > 50.0 { (a - 50.0) / 20.0 } else { 0.0 };
        let angles = [0.0, 12.0, 24.0, 33.0, 45.0, 57.0, 66.0, 78.0, 90.0];
        let rows: Vec<Collected> = angles.iter().map(|a| row(0.4, *a, bent, 1e-3)).collect();
        let of = |rows: &[Collected]| {
            let planned: Vec<(String, Flow)> =
                rows.iter().map(|row| (row.case.configuration.clone(), row.case.flow)).collect();
            misses(rows, &planned)
        };
        let found = of(&rows);
        assert_eq!(found.len(), 7);
        assert!((45.0..58.0).contains(&found[0].angle_rad.to_degrees()) && found[0].load == 1, "{:?}", found[0]);
        let next = suggested(&found, 2);
        let angles: Vec<f64> = next.iter().map(|(_, [_, angle])| angle.to_degrees()).collect();
        assert!(angles.iter().any(|a| (a - 51.0).abs() < 1e-9), "{angles:?}");
        assert!(next.iter().all(|(name, [speed, _])| name == "H1LT" && *speed == 0.4));
        // A parabola is foretold, and where the solver's own scatter is as large nothing is suggested.
        let smooth: Vec<Collected> = angles_of(|a| row(0.4, a, |a| (a / 90.0).powi(2), 1e-6));
        assert!(of(&smooth).iter().all(|m| m.missed_part < 1e-12) && suggested(&of(&smooth), 9).is_empty());
        let noisy: Vec<Collected> = angles_of(|a| row(0.4, a, bent, 0.5));
        assert_eq!(suggested(&of(&noisy), 9), []);
        // What is planned already, with a result or without, is no suggestion.
        let mut planned: Vec<(String, Flow)> =
            rows.iter().map(|row| (row.case.configuration.clone(), row.case.flow)).collect();
        for (name, [speed_m_s, angle_rad]) in suggested(&found, 99) {
            planned.push((name, Flow { speed_m_s, angle_rad, pitch_rad: 0.0 }));
        }
        assert_eq!(suggested(&misses(&rows, &planned), 9), []);
    }

    fn angles_of(row: impl Fn(f64) -> Collected) -> Vec<Collected> {
        [0.0, 12.0, 24.0, 33.0, 45.0, 57.0, 66.0, 78.0, 90.0].map(row).into_iter().collect()
    }
}
