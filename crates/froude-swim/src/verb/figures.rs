//! The way of a swimmer in the plane, in figures.

use froude_records::block::Block;
use froude_records::number::{degrees, significant};
use froude_records::page::{Chart, ChartPanel, Mark, Series};

use crate::planar::dot;
use crate::robot::Robot;
use crate::trajectory::Moment;

/// Most joints that get a line each.
const MOST_LINES: usize = 5;
/// Points of a distribution.
const POINTS: usize = 90;

fn column(moments: &[Moment], of: impl Fn(&Moment) -> f64) -> Vec<f64> {
    moments.iter().map(of).collect()
}

pub(super) fn line(name: &str, x: &[f64], y: Vec<f64>) -> Series {
    Series { name: name.to_owned(), x: x.to_vec(), y, ..Series::default() }
}

pub(super) fn panel(y_label: &str, series: Vec<Series>) -> ChartPanel {
    ChartPanel { y_label: y_label.to_owned(), series, ..ChartPanel::default() }
}

pub(super) fn chart(name: &str, title: &str, caption: &str, x_label: &str, panels: Vec<ChartPanel>) -> Block {
    let [name, title, caption, x_label] = [name, title, caption, x_label].map(str::to_owned);
    Block::Chart(Chart { name, title, caption, x_label, panels, ..Chart::default() })
}

pub(super) fn path(moments: &[Moment]) -> Block {
    let centre = line("centre of mass", &column(moments, |m| m.centre_m[0]), column(moments, |m| m.centre_m[1]));
    let head = line("head", &column(moments, |m| m.state.place_m[0]), column(moments, |m| m.state.place_m[1]));
    chart(
        "path",
        "Path in the tank",
        "Path of the head's centre and of the centre of mass over the ground; x and y have scales of their own.",
        "x [m]",
        vec![panel("y [m]", vec![head, centre])],
    )
}

pub(super) fn motion(moments: &[Moment]) -> Block {
    let time = column(moments, |m| m.time_s);
    let turning = column(moments, |m| m.state.head[0].to_degrees());
    chart(
        "motion",
        "Motion of the head",
        "Speed of the head through the water along and across its own axis, and its turn rate.",
        "time [s]",
        vec![
            panel(
                "speed [m/s]",
                vec![
                    line("along", &time, column(moments, |m| m.state.head[1])),
                    line("across", &time, column(moments, |m| m.state.head[2])),
                ],
            ),
            panel("turn rate [deg/s]", vec![line("turn rate", &time, turning)]),
        ],
    )
}

pub(super) fn joints(moments: &[Moment]) -> Block {
    let n = moments.first().map_or(0, |m| m.torque_n_m.len());
    joint_chart(&column(moments, |m| m.time_s), n, &|i| column(moments, |m| m.shape.angle[i].to_degrees()), &|i| {
        column(moments, |m| m.torque_n_m[i])
    })
}

/// Angles, deg, and torques, N m, of n joints over time.
pub(super) fn joint_chart(
    time_s: &[f64],
    n: usize,
    angle_deg: &dyn Fn(usize) -> Vec<f64>,
    torque_n_m: &dyn Fn(usize) -> Vec<f64>,
) -> Block {
    // Of many joints those that are evenly spaced from the head to the tail.
    let shown: Vec<usize> = if n <= MOST_LINES {
        (0..n).collect()
    } else {
        (0..MOST_LINES).map(|i| i * (n - 1) / (MOST_LINES - 1)).collect()
    };
    let lines = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<Series> {
        shown.iter().map(|i| line(&format!("joint {}", i + 1), time_s, of(*i))).collect()
    };
    chart(
        "joints",
        "Joints",
        &format!("Angles of {} joints of {n} from the head, and the torques of their motors.", shown.len()),
        "time [s]",
        vec![panel("angle [deg]", lines(angle_deg)), panel("torque [N m]", lines(torque_n_m))],
    )
}

pub(super) fn powers(moments: &[Moment]) -> Block {
    let time = column(moments, |m| m.time_s);
    let mut series = vec![
        line("net, of the motors", &time, column(moments, |m| m.power_w[0])),
        line("positive", &time, column(moments, |m| m.power_w[1])),
        line("drag", &time, column(moments, |m| m.power_w[2])),
    ];
    if moments.iter().any(|m| m.power_w[3] > 0.0) {
        series.push(line("friction of the joints", &time, column(moments, |m| m.power_w[3])));
    }
    chart(
        "powers",
        "Powers",
        "What the motors give, its positive part, and what drag takes; between net power and drag lies kinetic energy of body and water.",
        "time [s]",
        vec![panel("power [W]", series)],
    )
}

/// Shares of the loss by angle to the flow and by speed, with what the drag was fitted at.
pub(super) fn losses(robot: &Robot, moments: &[Moment]) -> Vec<Block> {
    // Angle, speed, power of each link at each moment.
    let mut all: Vec<[f64; 3]> = Vec::new();
    for moment in moments {
        for (link, motion) in robot.chain.links.iter().zip(&moment.motions) {
            let [_, u, v] = *motion;
            let power = -dot(link.drag.load(link.half_length_m, *motion), *motion);
            all.push([v.abs().atan2(u.abs()).to_degrees(), u.hypot(v), power.max(0.0)]);
        }
    }
    let sum: f64 = all.iter().map(|l| l[2]).sum();
    let below = |k: usize, most: f64| {
        let x: Vec<f64> = (0..=POINTS).map(|i| most * i as f64 / POINTS as f64).collect();
        let mut bins = vec![0.0; POINTS + 1];
        for loss in &all {
            bins[((loss[k] / most * POINTS as f64).ceil() as usize).min(POINTS)] += loss[2] / sum;
        }
        let mut total = 0.0;
        let y = bins.iter().map(|b| {
            total += 100.0 * b;
            total
        });
        (x, y.collect::<Vec<f64>>())
    };
    let fastest = all.iter().map(|l| l[1]).fold(f64::MIN_POSITIVE, f64::max);
    let mut charts: Vec<Block> = Vec::new();
    let mut paragraphs = vec![
        "How much of what drag takes is of links below an angle to the flow, and below a speed. What lies outside of the fitted range is extrapolated by the law."
            .to_owned(),
    ];
    let ranges = [robot.angle_rad.map(|r| r.map(|a| a.to_degrees().abs())), robot.speed_m_s.map(|r| r.map(f64::abs))];
    let axes = [("angle", "angle to the flow [deg]", 90.0), ("speed", "speed of the link [m/s]", fastest)];
    for (k, (name, label, most)) in axes.into_iter().enumerate() {
        let (x, y) = below(k, most);
        let mut series = vec![line("share of the loss", &x, y)];
        if let Some([a, b]) = ranges[k] {
            let [low, high] = [a.min(b), a.max(b)];
            for (end, at) in [("fitted from", low), ("fitted to", high)] {
                if at > 0.0 && at < most {
                    let mark = Mark::Dashed;
                    series.push(Series {
                        name: end.to_owned(),
                        mark,
                        x: vec![at, at],
                        y: vec![0.0, 100.0],
                        ..Series::default()
                    });
                }
            }
            let article = if k == 0 { "an" } else { "a" };
            let unit = if k == 0 {
                [degrees(low.to_radians()), degrees(high.to_radians())]
            } else {
                [low, high].map(|s| format!("{} m/s", significant(s, 3)))
            };
            paragraphs.push(format!("The drag was fitted at {article} {name} of {} to {}.", unit[0], unit[1]));
        }
        charts.push(chart(
            &format!("loss-by-{name}"),
            &format!("Loss by {name}"),
            &format!("Share of the loss that is of links whose {name} is below the abscissa."),
            label,
            vec![panel("share of the loss [%]", series)],
        ));
    }
    [vec![Block::text("", paragraphs)], charts].concat()
}
