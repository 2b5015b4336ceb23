//! The modular snake robot: elliptic links, narrower necks at its joints, half-ellipsoid ends.
//!
//! HkLT has a head, k links and a tail; the joints between them, k + 1, are where the section narrows: a neck, reached over a short
//! conical ramp on each side. Water that a flooded neck holds is not in the mesh. The head points to +x; part 0 is the tail's end, part
//! `i` the i-th link from the tail, part `k + 1` the head. A neck belongs half to each of its neighbours.

pub use froude_hydro::geometry::{Neck, Robot};

use crate::sections::{Curve, Grading, Piece, Section, SectionBody};

/// The body of HkLT, its middle at the origin, in cells of about `cell_m`.
#[must_use]
pub fn sections(robot: &Robot, links: usize, cell_m: f64) -> SectionBody {
    let Neck { length_m: neck_m, scale, ramp_m } =
        robot.neck.unwrap_or(Neck { length_m: 0.0, scale: 1.0, ramp_m: 0.0 });
    let (half_width_m, half_height_m) = (robot.link.minor_semi_axis_m, robot.link.major_semi_axis_m);
    let full = |x_m| Section::new(x_m, half_width_m, half_height_m);
    let narrow = |x_m| Section::new(x_m, scale * half_width_m, scale * half_height_m);
    let mut x_m = -0.5 * robot.length_m(links);
    let mut pieces = Vec::new();
    let mut last = Section::new(x_m, 0.0, 0.0);
    let mut go = |to: fn(f64) -> f64, section: &dyn Fn(f64) -> Section, length_m: f64, curve, grading, part| {
        if length_m == 0.0 {
            return;
        }
        x_m += length_m;
        let next = section(x_m);
        let cells = (to(length_m) / cell_m).round().max(1.0) as usize;
        pieces.push(Piece { ends: [last, next], curve, grading, cells, part });
        last = next;
    };
    let whole = |l: f64| l;
    // A quarter of an ellipse is longer than its axis.
    let arc = |l: f64| 1.5 * l;
    let neck = neck_m - 2.0 * ramp_m;
    // The shoulders of a neck are sharp: cells are finer towards them on both sides.
    let [after, before] = if neck_m > 0.0 { [Grading::End, Grading::Start] } else { [Grading::Even; 2] };
    go(arc, &full, robot.end_m, Curve::Elliptic, after, 0);
    for joint in 0..=links {
        go(whole, &narrow, ramp_m, Curve::Straight, Grading::Both, joint);
        go(whole, &narrow, 0.5 * neck, Curve::Straight, Grading::Start, joint);
        go(whole, &narrow, 0.5 * neck, Curve::Straight, Grading::End, joint + 1);
        go(whole, &full, ramp_m, Curve::Straight, Grading::Both, joint + 1);
        if joint < links {
            let length_m = robot.pitch_m() - neck_m;
            go(whole, &full, length_m, Curve::Straight, Grading::Both, joint + 1);
        }
    }
    let tip = |x_m| Section::new(x_m, 0.0, 0.0);
    go(arc, &tip, robot.end_m, Curve::Elliptic, before, links + 1);
    SectionBody { pieces }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Measure;
    use crate::sections::Resolution;

    /// 1.1013e-3 m³ a link + 0.529e-3 m³, as the source of the stand-in gives them, in the last digit printed.
    #[test]
    fn the_necked_mamba_has_the_volume_of_its_source() {
        for links in [1, 3, 9] {
            let volume = |along: usize| {
                let body = sections(&Robot::NECKED_MAMBA, links, 0.03);
                Measure::of(&body.mesh(Resolution { along, around: 24 * along }).unwrap().mesh).volume_m3
            };
            let (coarse, fine) = (volume(2), volume(4));
            let limit = fine + (fine - coarse) / 3.0;
            let exact = sections(&Robot::NECKED_MAMBA, links, 0.03).volume_m3();
            assert!((limit / exact - 1.0).abs() < 1e-3, "{links}: {limit} {exact}");
            let printed = 1.1013e-3 * links as f64 + 0.529e-3;
            assert!((limit - printed).abs() < 0.5e-7 * links as f64 + 0.5e-6, "{links}: {limit} {printed}");
        }
    }
}
