//! The way of a swimmer in three dimensions, in figures.

use froude_records::block::Block;

use super::figures::{chart, joint_chart, line, panel};
use crate::spatial::swim::SpatialMoment;

fn column(moments: &[SpatialMoment], of: impl Fn(&SpatialMoment) -> f64) -> Vec<f64> {
    moments.iter().map(of).collect()
}

fn time(moments: &[SpatialMoment]) -> Vec<f64> {
    column(moments, |m| m.time_s)
}

pub(super) fn path(moments: &[SpatialMoment]) -> Block {
    let x = column(moments, |m| m.centre_m[0]);
    chart(
        "path",
        "Path in the tank",
        "Path of the centre of mass over the ground, from above and as depth (z is down); each axis has its scale.",
        "x [m]",
        vec![
            panel("y [m]", vec![line("centre of mass", &x, column(moments, |m| m.centre_m[1]))]),
            panel("z [m]", vec![line("centre of mass", &x, column(moments, |m| m.centre_m[2]))]),
        ],
    )
}

pub(super) fn attitude(moments: &[SpatialMoment]) -> Block {
    let time = time(moments);
    let angle = |k: usize| column(moments, |m| m.angles[k].to_degrees());
    chart(
        "attitude",
        "How the head lies",
        "Roll (starboard down), pitch (bow up) and heading of the head.",
        "time [s]",
        vec![
            panel("angle [deg]", vec![line("roll", &time, angle(0)), line("pitch", &time, angle(1))]),
            panel("heading [deg]", vec![line("heading", &time, angle(2))]),
        ],
    )
}

pub(super) fn motion(moments: &[SpatialMoment]) -> Block {
    let time = time(moments);
    let lines = |from: usize, names: [&str; 3], scale: f64| {
        let one = |k: usize| line(names[k], &time, column(moments, |m| scale * m.state.head[from + k]));
        vec![one(0), one(1), one(2)]
    };
    chart(
        "motion",
        "Motion of the head",
        "Motion of the head through the water in its own axes: forward, to starboard, down.",
        "time [s]",
        vec![
            panel("speed [m/s]", lines(3, ["surge", "sway", "heave"], 1.0)),
            panel("turn rate [deg/s]", lines(0, ["roll", "pitch", "yaw"], 1_f64.to_degrees())),
        ],
    )
}

pub(super) fn joints(moments: &[SpatialMoment]) -> Block {
    let n = moments.first().map_or(0, |m| m.torque_n_m.len());
    joint_chart(&time(moments), n, &|i| column(moments, |m| m.shape.angle[i].to_degrees()), &|i| {
        column(moments, |m| m.torque_n_m[i])
    })
}

pub(super) fn powers(moments: &[SpatialMoment]) -> Block {
    let time = time(moments);
    let series = ["net, of the motors", "positive", "drag"].iter().enumerate();
    chart(
        "powers",
        "Powers",
        "What the motors give, its positive part, and what drag takes; between net power and drag lie the kinetic energy of body and water and what weight and buoyancy do.",
        "time [s]",
        vec![panel(
            "power [W]",
            series.map(|(k, name)| line(name, &time, column(moments, |m| m.power_w[k]))).collect(),
        )],
    )
}
