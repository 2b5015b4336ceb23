//! The meshes of a shape that a body file gives.

use crate::body_file::Shape;
use froude_mesh::robot::sections;
use froude_mesh::sections::SectionBody;
use froude_panel::family::Family;

/// Similar meshes of a shape; of a robot with a number of links.
#[must_use]
pub fn family(shape: &Shape, links: usize) -> Family {
    let mut first = 0;
    let (body, planes) = match *shape {
        Shape::Robot(robot) => {
            // Two cells on a ramp are too few: the surge of a necked robot is then off by twice its uncertainty.
            first = 1;
            (sections(&robot, links, robot.pitch_m() / 4.0), vec![1, 2])
        }
        Shape::Ellipsoid { semi_axes_m } => {
            let [a, b, c] = semi_axes_m;
            // Half of the meridian's length over the width of a panel around.
            let cells = (a.max(0.5 * (b + c)) / (b * c).sqrt() * 1.5).round().clamp(2.0, 40.0) as usize;
            (SectionBody::ellipsoid(semi_axes_m, cells), vec![0, 1, 2])
        }
        Shape::Capsule { length_m, section, end_m } => {
            let width = core::f64::consts::FRAC_PI_4 * (section.major_m + section.minor_m) / 2.0;
            let middle = 0.5 * length_m - end_m;
            let cells = |length: f64| (length / width).round().clamp(2.0, 60.0) as usize;
            let along = 2 * cells(middle);
            (
                SectionBody::capsule(middle, section.minor_m, section.major_m, end_m, [cells(1.5 * end_m), along]),
                vec![0, 1, 2],
            )
        }
        Shape::Cylinder { length_m, section } => {
            let width = core::f64::consts::FRAC_PI_4 * (section.major_m + section.minor_m) / 2.0;
            let along = 2 * (0.5 * length_m / width).round().clamp(2.0, 60.0) as usize;
            let cells = ((section.major_m / width).round() as usize).max(2);
            (
                SectionBody::flat_cylinder(0.5 * length_m, section.minor_m, section.major_m, [cells, along]),
                vec![0, 1, 2],
            )
        }
    };
    Family::of_sections(body, planes, first, flatness(shape))
}

/// Height over width of the section, or the other way round.
fn flatness(shape: &Shape) -> f64 {
    let (major, minor) = match *shape {
        Shape::Robot(robot) => (robot.link.major_semi_axis_m, robot.link.minor_semi_axis_m),
        Shape::Capsule { section, .. } | Shape::Cylinder { section, .. } => (section.major_m, section.minor_m),
        Shape::Ellipsoid { semi_axes_m: [_, b, c] } => (b, c),
    };
    (major / minor).max(minor / major)
}
