//! The way of a swimmer in figures.

use froude_records::block::Block;
use froude_records::number::{degrees, significant};
use froude_records::page::{Chart, ChartPanel, Mark, Series};

use crate::dynamics::Dynamics;
use crate::losses::Loss;
use crate::robot::Robot;
use crate::trajectory::Moment;

/// Most joints that get a line each.
const MOST_LINES: usize = 5;
/// Points of a distribution.
const POINTS: usize = 90;

fn column<C: Dynamics>(moments: &[Moment<C>], of: impl Fn(&Moment<C>) -> f64) -> Vec<f64> {
    moments.iter().map(of).collect()
}

fn line(name: &str, x: &[f64], y: Vec<f64>) -> Series {
    Series { name: name.to_owned(), x: x.to_vec(), y, ..Series::default() }
}

fn panel(y_label: &str, series: Vec<Series>) -> ChartPanel {
    ChartPanel { y_label: y_label.to_owned(), series, ..ChartPanel::default() }
}

fn chart(name: &str, title: &str, caption: &str, x_label: &str, panels: Vec<ChartPanel>) -> Block {
    let [name, title, caption, x_label] = [name, title, caption, x_label].map(str::to_owned);
    Block::Chart(Chart { name, title, caption, x_label, panels, ..Chart::default() })
}

/// The path and what the head does on it.
pub(super) fn way<C: Dynamics>(moments: &[Moment<C>]) -> Vec<Block> {
    let x = column(moments, |m| m.centre_m[0]);
    let centre = |k: usize| line("centre of mass", &x, column(moments, |m| m.centre_m[k]));
    let time = column(moments, |m| m.time_s);
    let moves =
        |name: &str, k: usize, scale: f64| line(name, &time, column(moments, |m| scale * C::six(&m.state.head)[k]));
    let (path, of_path, motion, of_motion) = ("path", "Path in the tank", "motion", "Motion of the head");
    let degrees = 1_f64.to_degrees();
    if !C::TILTS {
        let place = |k: usize| column(moments, |m| C::place_m(&m.state.pose)[k]);
        return vec![
            chart(
                path,
                of_path,
                "Path of the head's centre and of the centre of mass over the ground; x and y have scales of their own.",
                "x [m]",
                vec![panel("y [m]", vec![line("head", &place(0), place(1)), centre(1)])],
            ),
            chart(
                motion,
                of_motion,
                "Speed of the head through the water along and across its own axis, and its turn rate.",
                "time [s]",
                vec![
                    panel("speed [m/s]", vec![moves("along", 3, 1.0), moves("across", 4, 1.0)]),
                    panel("turn rate [deg/s]", vec![moves("turn rate", 2, degrees)]),
                ],
            ),
        ];
    }
    let lies = |name: &str, k: usize| line(name, &time, column(moments, |m| C::angles(&m.state.pose)[k].to_degrees()));
    vec![
        chart(
            path,
            of_path,
            "Path of the centre of mass over the ground, from above and as depth (z is down); each axis has its scale.",
            "x [m]",
            vec![panel("y [m]", vec![centre(1)]), panel("z [m]", vec![centre(2)])],
        ),
        chart(
            "attitude",
            "How the head lies",
            "Roll (starboard down), pitch (bow up) and heading of the head.",
            "time [s]",
            vec![
                panel("angle [deg]", vec![lies("roll", 0), lies("pitch", 1)]),
                panel("heading [deg]", vec![lies("heading", 2)]),
            ],
        ),
        chart(
            motion,
            of_motion,
            "Motion of the head through the water in its own axes: forward, to starboard, down.",
            "time [s]",
            vec![
                panel("speed [m/s]", vec![moves("surge", 3, 1.0), moves("sway", 4, 1.0), moves("heave", 5, 1.0)]),
                panel(
                    "turn rate [deg/s]",
                    vec![moves("roll", 0, degrees), moves("pitch", 1, degrees), moves("yaw", 2, degrees)],
                ),
            ],
        ),
    ]
}

pub(super) fn joints<C: Dynamics>(moments: &[Moment<C>]) -> Block {
    let (time, n) = (column(moments, |m| m.time_s), moments.first().map_or(0, |m| m.torque_n_m.len()));
    // Of many joints those that are evenly spaced from the head to the tail.
    let shown: Vec<usize> = if n <= MOST_LINES {
        (0..n).collect()
    } else {
        (0..MOST_LINES).map(|i| i * (n - 1) / (MOST_LINES - 1)).collect()
    };
    let lines = |of: &dyn Fn(&Moment<C>, usize) -> f64| -> Vec<Series> {
        shown.iter().map(|i| line(&format!("joint {}", i + 1), &time, column(moments, |m| of(m, *i)))).collect()
    };
    chart(
        "joints",
        "Joints",
        &format!("Angles of {} joints of {n} from the head, and the torques of their motors.", shown.len()),
        "time [s]",
        vec![
            panel("angle [deg]", lines(&|m, i| m.shape.angle[i].to_degrees())),
            panel("torque [N m]", lines(&|m, i| m.torque_n_m[i])),
        ],
    )
}

pub(super) fn powers<C: Dynamics>(moments: &[Moment<C>]) -> Block {
    let time = column(moments, |m| m.time_s);
    let has_friction = moments.iter().any(|m| m.power_w[3] > 0.0);
    let names = ["net, of the motors", "positive", "drag", "friction of the joints"].into_iter().enumerate();
    let series = names.take(if has_friction { 4 } else { 3 });
    let height = if C::TILTS { " and potential" } else { "" };
    chart(
        "powers",
        "Powers",
        &format!(
            "What the motors give, its positive part, and what drag takes. Net power less drag and joint friction is the rate of change of kinetic{height} energy, that of the water included."
        ),
        "time [s]",
        vec![panel(
            "power [W]",
            series.map(|(k, name)| line(name, &time, column(moments, |m| m.power_w[k]))).collect(),
        )],
    )
}

/// Shares of the loss by angle to the flow and by speed, with what the drag was fitted at.
pub(super) fn losses<C: Dynamics>(robot: &Robot<C>, moments: &[Moment<C>]) -> Vec<Block> {
    // Angle, speed, power of each link at each moment.
    let mut all: Vec<[f64; 3]> = Vec::new();
    for moment in moments {
        let each = moment.motions.iter().enumerate().map(|(i, motion)| Loss::of(&robot.chain.dragged(i, *motion)));
        all.extend(each.map(|loss| [loss.angle_rad.to_degrees(), loss.speed_m_s, loss.power_w]));
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
