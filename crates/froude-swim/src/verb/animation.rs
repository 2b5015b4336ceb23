//! A page on which the robot swims: seen from above, to scale, with the drag on each link as an arrow.
//!
//! One file that loads nothing and sends nothing. Numbers are whole counts of a unit of their own, as fine as what is seen.
//!
//! **Frame.** The tank's x to the right and its y, to starboard of x, downwards: z is down. **Units.** SI.

use froude_records::text::visible;
use serde::Serialize;

use super::water;
use crate::dynamics::Dynamics;
use crate::robot::Robot;
use crate::robot_file::RobotFile;
use crate::trajectory::Moment;

const PAGE: &str = include_str!("animation.html");
/// Most numbers of a page, of about six signs each.
const MOST_NUMBERS: usize = 250_000;
/// Units of length on a robot's length.
const FINE: f64 = 2e4;
/// Units of a force, a speed or a power on its largest.
const PARTS: f64 = 2e3;

/// What the page draws.
#[derive(Serialize)]
struct Data {
    half_length_m: Vec<f64>,
    half_width_m: Vec<f64>,
    apart_s: f64,
    /// Moments that are left out.
    cut: usize,
    current_m_s: [f64; 2],
    length_unit_m: f64,
    force_unit_n: f64,
    speed_unit_m_s: f64,
    power_unit_w: f64,
    /// Moment by moment, two numbers a link.
    place: Vec<Vec<i64>>,
    heading_mrad: Vec<Vec<i64>>,
    force: Vec<Vec<i64>>,
    centre: Vec<[i64; 2]>,
    speed: Vec<i64>,
    power: Vec<i64>,
}

/// The animation as one self-contained HTML file.
pub(super) fn html<C: Dynamics>(file: &RobotFile, robot: &Robot<C>, moments: &[Moment<C>]) -> String {
    let chain = &robot.chain.flat();
    let n = chain.links.len();
    let shown = &moments[..moments.len().min(MOST_NUMBERS / (5 * n + 4))];
    let length_m: f64 = chain.links.iter().map(|link| 2.0 * link.half_length_m).sum();
    let links: Vec<Vec<water::LinkInWater>> =
        shown.iter().map(|m| water::links((&robot.chain, chain), m).collect()).collect();
    let place = |at: [f64; 2]| at.map(|x| (x * FINE / length_m).round() as i64);
    let (force_unit_n, force) = counted(links.iter().flatten().flat_map(|link| link.drag_n));
    let (speed_unit_m_s, speed) = counted(shown.iter().map(|m| water::speed_m_s(chain, m)));
    let (power_unit_w, power) = counted(shown.iter().map(|m| m.power_w[0]));
    let data = Data {
        half_length_m: chain.links.iter().map(|link| link.half_length_m).collect(),
        half_width_m: file.modules.iter().map(|m| m.link.minor_semi_axis_m).collect(),
        apart_s: shown.get(1).map_or(0.0, |m| m.time_s - shown[0].time_s),
        cut: moments.len() - shown.len(),
        current_m_s: file.current_m_s,
        length_unit_m: length_m / FINE,
        force_unit_n,
        speed_unit_m_s,
        power_unit_w,
        place: links.iter().map(|all| all.iter().flat_map(|l| place(l.place_m)).collect()).collect(),
        heading_mrad: links.iter().map(|all| all.iter().map(|l| (1e3 * l.heading).round() as i64).collect()).collect(),
        force: force.chunks(2 * n).map(<[i64]>::to_vec).collect(),
        centre: shown.iter().map(|m| place([m.centre_m[0], m.centre_m[1]])).collect(),
        speed,
        power,
    };
    // Numbers alone: they are always written.
    let data = serde_json::to_string(&data).unwrap_or_default();
    let (head, rest) = PAGE.split_once("{{DATA}}").unwrap_or((PAGE, ""));
    let name = escaped(&visible(&file.name));
    [head.replace("{{NAME}}", &name), data, rest.replace("{{NAME}}", &name)].concat()
}

/// Numbers as counts of a unit, with it.
fn counted(numbers: impl Iterator<Item = f64>) -> (f64, Vec<i64>) {
    let numbers: Vec<f64> = numbers.collect();
    let most = numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let unit = if most > 0.0 { most / PARTS } else { 1.0 };
    (unit, numbers.iter().map(|x| (x / unit).round() as i64).collect())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
