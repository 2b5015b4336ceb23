//! Doubts about a mesh that is sound: a body drawn in millimetres, a body through the water's surface.

use crate::check::extent;
use crate::files::soup::counted;
use crate::measure::Measure;
use crate::mesh::Mesh;
use crate::vector::Vec3;

/// Largest extent of a body in a tank or of a vehicle, m: one that is larger was drawn in millimetres. A robot of 0.1 m is 100 then.
pub const LARGEST_M: f64 = 50.0;

/// A body too large for its unit.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the mesh is {extent_m:.4} m long and encloses {volume_m3:.4e} m³ (doubtful above {LARGEST_M} m); drawn in millimetres it is {:.4} m \
     and {:.4e} m³, in inches {:.4} m: give `--unit mm` or `--unit in`, or `--unit m` if it is that large",
    1e-3 * extent_m,
    1e-9 * volume_m3,
    0.0254 * extent_m
)]
pub struct TooLarge {
    /// Largest side of the box around it, m.
    pub extent_m: f64,
    /// Its volume, m³.
    pub volume_m3: f64,
}

/// Whether a mesh in metres is so large that it must have been drawn in millimetres.
#[must_use]
pub fn too_large(mesh: &Mesh) -> Option<TooLarge> {
    let extent_m = extent(mesh);
    (extent_m > LARGEST_M).then(|| TooLarge { extent_m, volume_m3: Measure::of(mesh).volume_m3 })
}

/// Panels on both sides of a plane.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{} {letter} = {at_m} m, the first {panel} from {from:?} to {to:?} m", counted(*count, "panel crosses", "panels cross"), letter = ["x", "y", "z"][axis % 3])]
pub struct Crosses {
    /// The axis that the plane is across, 0 to 2.
    pub axis: usize,
    /// Where on it, m.
    pub at_m: f64,
    /// How many panels.
    pub count: usize,
    /// The first.
    pub panel: usize,
    /// Its corner farthest below, m.
    pub from: Vec3,
    /// Its corner farthest above, m.
    pub to: Vec3,
}

/// The panels that have corners on both sides of the plane where coordinate `axis` (0 to 2) is `at_m`, such as the water's surface.
///
/// A corner on the plane is on neither side.
#[must_use]
pub fn crosses(mesh: &Mesh, axis: usize, at_m: f64) -> Option<Crosses> {
    let mut out: Option<Crosses> = None;
    for (number, panel) in mesh.panels.iter().enumerate() {
        let farthest = |is_farther: fn(f64, f64) -> bool| {
            mesh.corners(*panel).reduce(|a, b| if is_farther(b[axis], a[axis]) { b } else { a })
        };
        let (Some(from), Some(to)) = (farthest(|b, a| b < a), farthest(|b, a| b > a)) else { continue };
        if from[axis] < at_m && at_m < to[axis] {
            let first = Crosses { axis, at_m, count: 0, panel: number, from, to };
            out.get_or_insert(first).count += 1;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sections::{Resolution, SectionBody};

    fn hull(length_m: f64) -> Mesh {
        let semi_axes_m = [0.5 * length_m, 0.05 * length_m, 0.05 * length_m];
        SectionBody::ellipsoid(semi_axes_m, 2).mesh(Resolution { along: 2, around: 16 }).unwrap().mesh
    }

    #[test]
    fn a_body_in_millimetres_is_doubted_with_both_numbers() {
        assert_eq!(too_large(&hull(5.0)), None);
        let told = "the mesh is 100.0000 m long and encloses 4.5346e3 m³ (doubtful above 50 m); drawn in millimetres it is 0.1000 m and \
                    4.5346e-6 m³, in inches 2.5400 m: give `--unit mm` or `--unit in`, or `--unit m` if it is that large";
        let volume_m3 = Measure::of(&hull(100.0)).volume_m3;
        let told = told
            .replace("4.5346e3", &format!("{volume_m3:.4e}"))
            .replace("4.5346e-6", &format!("{:.4e}", 1e-9 * volume_m3));
        assert_eq!(too_large(&hull(100.0)).unwrap().to_string(), told);
    }

    #[test]
    fn panels_through_the_water_are_reported_and_those_that_end_there_are_not() {
        let mesh = hull(2.0);
        assert_eq!(crosses(&mesh, 2, 0.0), None);
        assert_eq!(crosses(&mesh, 2, 0.2), None);
        let found = crosses(&mesh, 0, -0.9).unwrap();
        assert_eq!((found.count, found.panel), (16, 16));
        let sentence = found.to_string();
        assert!(
            sentence.starts_with("16 panels cross x = -0.9 m, the first 16 from [-0.9238795325112867, 0.0"),
            "{sentence}"
        );
    }
}
