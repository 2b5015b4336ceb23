//! The meridian of a body of elliptic sections, from tip to tip, and where a mesh cuts it.
//!
//! **Stations.** The length of a cell grows with the radius of curvature and with the distance from where it is small, so that neighbours differ by a constant ratio; any number of stations has the same distribution, and families of meshes are similar.
//!
//! Lengths along the meridian are those of the body of revolution of equal sectional area, r = √(wh).

use froude_mesh::sections::{Piece, Section, SectionBody};

use crate::mesh_error::MeshError;

/// Samples of a piece: the length of an arc is good to 1e-7 of it.
const SAMPLES: usize = 1024;
/// Turn of the meridian in a cell, rad, before the count of cells scales it.
const TURN_RAD: f64 = 0.12;
/// Growth of a cell's length with the distance along the meridian.
const GROWTH: f64 = 0.2;
/// Longest cell over the body's largest width, likewise.
const LONGEST: f64 = 0.5;
/// Smallest radius of curvature that is taken, over the largest half-width: a sharp edge has none.
const SHARPEST: f64 = 0.1;

/// A section and how it changes along the meridian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// The section.
    pub section: Section,
    /// Direction of (x, half-width, half-height).
    pub tangent: [f64; 3],
}

impl Station {
    /// √(wh), m.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        radius_m(self.section)
    }
}

/// A meridian.
#[derive(Debug, Clone, PartialEq)]
pub struct Meridian {
    pieces: Vec<Piece>,
    samples: Vec<Sample>,
    largest_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    piece: usize,
    t: f64,
    section: Section,
    tangent: [f64; 3],
    arc_m: f64,
    // How many cells there are before it, to a factor.
    before: f64,
}

fn radius_m(section: Section) -> f64 {
    (section.half_width_m * section.half_height_m).sqrt()
}

impl Meridian {
    /// That of a body.
    ///
    /// # Errors
    ///
    /// [`MeshError::Refused`]: lengths that are not finite, a body that does not begin and end with a point, or is one in between, pieces that do not meet.
    pub fn new(body: &SectionBody) -> Result<Self, MeshError> {
        let pieces = body.pieces.clone();
        check(&pieces)?;
        let mut samples: Vec<Sample> = Vec::new();
        for (number, piece) in pieces.iter().enumerate() {
            for step in usize::from(number > 0)..=SAMPLES {
                let t = step as f64 / SAMPLES as f64;
                // The last of the curve is the end itself, without the cosine's rounding.
                let section = if step == SAMPLES { piece.ends[1] } else { piece.at(t) };
                let arc_m = samples.last().map_or(0.0, |last| {
                    last.arc_m + (section.x_m - last.section.x_m).hypot(radius_m(section) - radius_m(last.section))
                });
                samples.push(Sample { piece: number, t, section, tangent: [1.0, 0.0, 0.0], arc_m, before: 0.0 });
            }
        }
        let largest_m = samples.iter().map(|s| radius_m(s.section)).fold(0.0, f64::max);
        find_tangents(&mut samples);
        count_cells(&mut samples, largest_m);
        Ok(Self { pieces, samples, largest_m })
    }

    /// x of the tail's and of the head's tip, m.
    #[must_use]
    pub fn tips_m(&self) -> [f64; 2] {
        [self.samples.first(), self.samples.last()].map(|s| s.map_or(0.0, |s| s.section.x_m))
    }

    /// The largest √(wh), m.
    #[must_use]
    pub fn largest_radius_m(&self) -> f64 {
        self.largest_m
    }

    /// Mean radius of curvature of the two tips, m.
    pub(crate) fn tip_radius_m(&self) -> f64 {
        // r² = 2 ρ δx of a sphere that touches.
        let at = |tip: Section, near: Section| {
            radius_m(near).powi(2) / (2.0 * (near.x_m - tip.x_m).abs()).max(f64::MIN_POSITIVE)
        };
        let n = self.samples.len();
        let of = |tip: usize, near: usize| match (self.samples.get(tip), self.samples.get(near)) {
            (Some(tip), Some(near)) => at(tip.section, near.section),
            _ => 0.0,
        };
        0.5 * (of(0, 8) + of(n - 1, n - 9))
    }

    /// How many stations' cells the body takes where neighbours differ by 20 % and ends turn by 0.12 rad a cell.
    #[must_use]
    pub fn natural_cells(&self) -> f64 {
        self.samples.last().map_or(0.0, |s| s.before)
    }

    /// Sections between `cells` cells, both tips among them.
    #[must_use]
    pub fn stations(&self, cells: usize) -> Vec<Station> {
        let all = self.natural_cells();
        let mut found = Vec::with_capacity(cells + 1);
        let mut upper = 1;
        for i in 0..=cells {
            let wanted = all * i as f64 / cells.max(1) as f64;
            while upper + 1 < self.samples.len() && self.samples[upper].before < wanted {
                upper += 1;
            }
            let (a, b) = (&self.samples[upper - 1], &self.samples[upper]);
            let part = ((wanted - a.before) / (b.before - a.before)).clamp(0.0, 1.0);
            // Up to the first sample of a piece, the last of the one before is its t = 0.
            let from = if a.piece == b.piece { a.t } else { 0.0 };
            let section = if i == 0 {
                a.section
            } else if i == cells {
                b.section
            } else {
                self.pieces[b.piece].at(from + part * (b.t - from))
            };
            let tangent = core::array::from_fn(|c| a.tangent[c] + part * (b.tangent[c] - a.tangent[c]));
            found.push(Station { section, tangent });
        }
        found
    }
}

fn check(pieces: &[Piece]) -> Result<(), MeshError> {
    let refuse = |x_m: f64, problem: &str| Err(MeshError::Refused(format!("the body at x = {x_m} m: {problem}")));
    let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
        return refuse(0.0, "it has no piece; give it sections from tip to tip");
    };
    let mut before = first.ends[0];
    for (number, piece) in pieces.iter().enumerate() {
        let [a, b] = piece.ends;
        let numbers = [a.x_m, a.half_width_m, a.half_height_m, b.x_m, b.half_width_m, b.half_height_m];
        if numbers.iter().any(|v| !v.is_finite()) {
            return refuse(a.x_m, "a length is not finite; give sections of finite extent");
        }
        if a != before || b.x_m < a.x_m {
            return refuse(
                a.x_m,
                "its pieces do not follow each other by increasing x; let each begin where the one before ends",
            );
        }
        if number + 1 < pieces.len() && (b.half_width_m <= 0.0 || b.half_height_m <= 0.0) {
            return refuse(b.x_m, "its section has no extent between the tips; an O-grid goes around one body");
        }
        before = b;
    }
    for tip in [first.ends[0], last.ends[1]] {
        if tip.half_width_m != 0.0 || tip.half_height_m != 0.0 {
            return refuse(tip.x_m, "it does not end in a point; close it by an end, however short");
        }
    }
    if last.ends[1].x_m <= first.ends[0].x_m || pieces.len() < 2 {
        return refuse(
            first.ends[0].x_m,
            "it has no length or no section between its tips; give it two pieces at least",
        );
    }
    Ok(())
}

/// Chords over both neighbours: exact to the second order, and the mean at an edge.
fn find_tangents(samples: &mut [Sample]) {
    let along = |s: Section| [s.x_m, s.half_width_m, s.half_height_m];
    let sections: Vec<[f64; 3]> = samples.iter().map(|s| along(s.section)).collect();
    let n = sections.len();
    for i in 0..n {
        let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
        let chord: [f64; 3] = core::array::from_fn(|c| sections[high][c] - sections[low][c]);
        let length = froude_mesh::vector::norm(chord).max(f64::MIN_POSITIVE);
        samples[i].tangent = chord.map(|v| v / length);
    }
}

fn count_cells(samples: &mut [Sample], largest_m: f64) {
    let n = samples.len();
    let slope = |s: &Sample| {
        let [x, w, h] = s.tangent;
        (0.5 * (w + h)).atan2(x)
    };
    let mut cell_m: Vec<f64> = (0..n)
        .map(|i| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            let turn = (slope(&samples[high]) - slope(&samples[low])).abs();
            let radius = (samples[high].arc_m - samples[low].arc_m) / turn.max(1e-12);
            TURN_RAD * radius.clamp(SHARPEST * largest_m, 2.0 * LONGEST / TURN_RAD * largest_m)
        })
        .collect();
    // No cell is longer than its neighbours let it be, on either side.
    for i in 1..n {
        cell_m[i] = cell_m[i].min(cell_m[i - 1] + GROWTH * (samples[i].arc_m - samples[i - 1].arc_m));
    }
    for i in (0..n - 1).rev() {
        cell_m[i] = cell_m[i].min(cell_m[i + 1] + GROWTH * (samples[i + 1].arc_m - samples[i].arc_m));
    }
    for i in 1..n {
        let step_m = samples[i].arc_m - samples[i - 1].arc_m;
        samples[i].before = samples[i - 1].before + 0.5 * step_m * (1.0 / cell_m[i] + 1.0 / cell_m[i - 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_of_a_sphere_are_equal_arcs() {
        let meridian = Meridian::new(&SectionBody::ellipsoid([0.5; 3], 1)).unwrap();
        for (i, station) in meridian.stations(12).iter().enumerate() {
            let (sin, cos) = (core::f64::consts::PI * i as f64 / 12.0).sin_cos();
            assert!((station.section.x_m + 0.5 * cos).abs() < 1e-4 && (station.radius_m() - 0.5 * sin).abs() < 1e-4);
        }
        assert!((meridian.tip_radius_m() - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_finer_cut_has_the_stations_of_the_coarse_one_and_neighbours_grow_evenly() {
        let meridian = Meridian::new(&SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2])).unwrap();
        let (coarse, fine) = (meridian.stations(40), meridian.stations(80));
        for (i, station) in coarse.iter().enumerate() {
            assert!((station.section.x_m - fine[2 * i].section.x_m).abs() < 1e-12);
        }
        let steps: Vec<f64> = fine
            .windows(2)
            .map(|w| (w[1].section.x_m - w[0].section.x_m).hypot(w[1].radius_m() - w[0].radius_m()))
            .collect();
        // A natural cell grows by GROWTH of the way, one of a finer cut by so much less; a tenth is for chords that are no arcs.
        let growth = 1.1 * GROWTH * meridian.natural_cells() / 80.0;
        for pair in steps.windows(2) {
            assert!((pair[1] / pair[0]).ln().abs() < growth, "{pair:?}, {growth}");
        }
    }

    #[test]
    fn what_is_no_body_is_refused_with_its_place() {
        let refused = |change: fn(&mut SectionBody)| {
            let mut body = SectionBody::capsule(0.4, 0.05, 0.06, 0.1, [1; 2]);
            change(&mut body);
            Meridian::new(&body).unwrap_err().to_string()
        };
        assert_eq!(
            refused(|b| b.pieces.clear()),
            "the body at x = 0 m: it has no piece; give it sections from tip to tip"
        );
        assert!(
            refused(|b| {
                b.pieces.pop();
            })
            .starts_with("the body at x = 0.4 m: it does not end in a point")
        );
        assert!(refused(|b| b.pieces[1].ends[0].x_m = 0.0).contains("do not follow each other"));
        assert!(refused(|b| b.pieces[1].ends[1].half_width_m = f64::NAN).contains("not finite"));
        assert!(refused(|b| b.pieces.truncate(0)).contains("no piece"));
    }
}
