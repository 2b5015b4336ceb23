//! The figures of a swim, of a gait or a recording, in the plane or in three dimensions.

use froude_records::block::{Block, ResultColumn, ResultTable, TableBuilder, facts};
use froude_records::estimate::DataFile;
use froude_records::number::{count, degrees, percent};

use super::leaves::Repeating;
use super::moves::Asked;
use crate::robot::Robot;
use crate::seen::Needs;
use crate::stability::Stiffness;

/// What a swim comes to.
#[derive(Debug)]
pub(super) struct Figures<'a> {
    pub name: &'a str,
    pub robot: &'a Robot,
    /// The files that were read.
    pub data: &'a [DataFile],
    pub asked: &'a Asked,
    pub speed_m_s: f64,
    /// Powers: net, positive, in both directions, of the drag.
    pub power_w: [f64; 4],
    /// Of the joints, where they have any.
    pub friction_w: Option<f64>,
    pub electric_w: Option<f64>,
    pub needs: Needs,
    /// Largest part of what a motor gives at its speed, where it has a curve.
    pub motor_share: Option<f64>,
    /// The highest frequency that the motors allow.
    pub fastest_rad_s: Option<f64>,
    pub steps: usize,
    pub stiffness: Option<Stiffness>,
    /// Share of the loss outside of the fitted speeds, and angles.
    pub extrapolated: [Option<f64>; 2],
    pub along: f64,
    pub median_angle_rad: f64,
    /// The module that gains most from still water.
    pub gain_w: Option<(usize, f64)>,
    pub turn: f64,
    /// Of a gait.
    pub repeats: Option<Repeats>,
    /// Of a recording: its length, s, and the kinetic energy gained, J.
    pub track: Option<[f64; 2]>,
    /// In three dimensions.
    pub space: Option<Space>,
}

/// How a motion repeats.
#[derive(Debug)]
pub(super) struct Repeats {
    /// Net power over m g U.
    pub cost: f64,
    pub multipliers: Vec<f64>,
    pub residual: f64,
    /// The motion that the swimmer leaves.
    pub unstable: Option<Repeating>,
}

/// What only three dimensions have.
#[derive(Debug)]
pub(super) struct Space {
    pub roll: [f64; 2],
    pub pitch: [f64; 2],
    pub way_m: [f64; 3],
    pub period_s: f64,
    pub lifting_w: f64,
    pub righting_m: f64,
    pub trim_m: f64,
}

impl Figures<'_> {
    /// Who swims, with what, in a line.
    pub(super) fn subtitle(&self) -> String {
        let space = if self.space.is_some() { " in three dimensions" } else { "" };
        format!("{} modules{space}, drag of {}", count(self.robot.chain.links.len()), self.robot.estimates.0)
    }

    /// All of them.
    pub(super) fn blocks(&self) -> [Block; 2] {
        [files_read(self.data).into(), self.table().into()]
    }

    fn table(&self) -> ResultTable {
        let f = facts("", format!("{}: {}", self.name, self.subtitle()), self);
        let mut columns = vec![
            f.text("robot", "", |f| f.name.to_owned()),
            f.text("space", "", |f| if f.space.is_some() { "3d" } else { "planar" }.to_owned()),
            f.count("modules", "", |f| f.robot.chain.links.len()),
            f.text("drag", "", |f| f.robot.estimates.0.clone()),
            f.text("added_mass", "", |f| f.robot.estimates.1.clone()),
        ];
        columns.extend(self.asked.columns());
        columns.extend(self.speeds_and_powers(&f));
        columns.extend(self.joints(&f));
        columns.extend(self.motion(&f));
        columns.extend([
            f.number("extrapolated_loss_by_speed", "", |f| f.extrapolated[0]),
            f.number("extrapolated_loss_by_angle", "", |f| f.extrapolated[1]),
            f.number("median_angle_of_loss_rad", "", |f| f.median_angle_rad),
            f.number("loss_along_links", "", |f| f.along),
            f.count("gains_power/module", "", |f| f.gain_w.map(|(module, _)| module)),
            f.number("gains_power/power_w", "", |f| f.gain_w.map(|(_, watts)| watts)),
            f.number("mass_less_displaced_kg", "", |f| f.robot.heavy_kg),
            f.count("steps", "", |f| f.steps),
        ]);
        f.build(columns)
    }

    fn speeds_and_powers<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        let speed = if self.space.is_some() { "speed, level [m/s]" } else { "speed [m/s]" };
        let net = if self.friction_w.is_some() {
            "net power: what water and friction take [W]"
        } else {
            "net power: what the water takes [W]"
        };
        vec![
            f.number("speed_m_s", speed, |f| f.speed_m_s),
            f.number("cost_of_transport_j_m", "cost of transport [J/m]", |f| f.power_w[0] / f.speed_m_s),
            f.number("cost_of_transport_positive_j_m", "the same by positive power [J/m]", |f| {
                f.power_w[1] / f.speed_m_s
            }),
            f.number("cost_of_transport", "cost of transport over m g U [1]", |f| f.repeats.as_ref().map(|r| r.cost))
                .significant(3),
            f.number("power_net_w", net, |f| f.power_w[0]),
            f.number("power_positive_w", "positive power: drives without recovery [W]", |f| f.power_w[1]),
            f.number("power_absolute_w", "power in both directions [W]", |f| f.power_w[2]),
            f.number("power_loss_w", "", |f| f.power_w[3]),
            f.number("power_friction_w", "friction of the joints [W]", |f| f.friction_w),
            f.number("power_lifting_w", "", |f| f.space.as_ref().map(|s| s.lifting_w)),
            f.number("power_electric_w", "power from the battery [W]", |f| f.electric_w),
            f.number("cost_of_transport_electric_j_m", "cost of transport from the battery [J/m]", |f| {
                f.electric_w.map(|electric| electric / f.speed_m_s)
            }),
        ]
    }

    fn joints<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        // A servo gets no more than its motor gives.
        let share = if self.stiffness.is_none() { "largest part of what the motor gives at its speed [1]" } else { "" };
        vec![
            f.number("torque_peak_n_m", "largest torque of a motor [N m]", |f| f.needs.torque_n_m).significant(3),
            f.number("rate_peak_rad_s", "largest rate of a joint [deg/s]", |f| f.needs.rate_rad_s),
            f.number("servo/away_from_gait_rad", "largest distance of a joint from its gait [deg]", |f| {
                f.stiffness.map(|_| f.needs.away_rad)
            })
            .places(2),
            f.number("servo/time_at_limit", "", |f| f.stiffness.map(|_| f.needs.at_limit)),
            f.number("servo/damping_eigenvalue_per_s", "", |f| f.stiffness.map(|s| s.damping_per_s)),
            f.number("servo/longest_stable_step_s", "", |f| f.stiffness.map(|s| s.longest_step_s)),
            f.number("motor_share_peak", share, |f| f.motor_share).significant(3),
            f.number("motor_fastest_rad_s", "", |f| f.fastest_rad_s),
        ]
    }

    fn motion<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        let [turn_key, turn] = match &self.track {
            Some(_) => ["turn_rad", "turn of the head [deg]"],
            None => ["turn_per_period_rad", "turn per period [deg]"],
        };
        let turn = f.number(turn_key, turn, |f| f.turn).places(2);
        let mut out = Vec::new();
        if self.space.is_some() {
            out.extend([
                f.interval("roll_rad", "roll of the head [deg]", |f| f.space.as_ref().map(|s| s.roll)).range(),
                f.interval("pitch_rad", "pitch of the head [deg]", |f| f.space.as_ref().map(|s| s.pitch)).range(),
                turn,
                f.number("sinking_per_period_m", "sinks per period [mm]", |f| f.space.as_ref().map(|s| s.way_m[2]))
                    .places(2),
                f.number("sinking_m_s", "", |f| f.space.as_ref().map(|s| s.way_m[2] / s.period_s)),
                f.numbers("way_per_period_m", "", |f| f.space.as_ref().map(|s| s.way_m.to_vec())),
                f.number("righting_m", "", |f| f.space.as_ref().map(|s| s.righting_m)),
                f.number("trim_m", "", |f| f.space.as_ref().map(|s| s.trim_m)),
            ]);
        } else {
            out.push(turn);
        }
        if self.track.is_some() {
            out.extend([
                f.number("energy_gained_j", "kinetic energy gained [J]", |f| f.track.map(|[_, gained]| gained))
                    .significant(3),
                f.number("length_s", "length of the recording [s]", |f| f.track.map(|[length, _]| length)),
            ]);
            return out;
        }
        let of = |f: &'a Self| f.repeats.as_ref();
        let left = |f: &'a Self| f.repeats.as_ref().and_then(|r| r.unstable.as_ref());
        out.extend([
            f.number("floquet_multiplier_largest", "largest Floquet multiplier [1]", |f| {
                of(f).map(|r| r.multipliers[0])
            })
            .significant(3),
            f.numbers("floquet_multipliers", "", |f| of(f).map(|r| r.multipliers.clone())),
            f.number("periodic_residual", "", |f| of(f).map(|r| r.residual)),
            f.number("unstable_motion/speed_m_s", "speed of the unstable motion [m/s]", |f| {
                left(f).map(|u| u.speed_m_s)
            }),
            f.number("unstable_motion/power_net_w", "net power of the unstable motion [W]", |f| {
                left(f).map(|u| u.net_w)
            }),
            f.number("unstable_motion/power_positive_w", "", |f| left(f).map(|u| u.positive_w)),
            f.number("unstable_motion/cost_of_transport_j_m", "", |f| left(f).map(|u| u.net_w / u.speed_m_s)),
            f.number("unstable_motion/turn_per_period_rad", "", |f| left(f).map(|u| u.turn)),
            f.numbers("unstable_motion/floquet_multipliers", "", |f| left(f).map(|u| u.multipliers.clone())),
        ]);
        out
    }

    /// Where the loss is: outside of the fitted speeds and angles, by angle, along the links.
    pub(super) fn losses(&self, out: &mut Vec<String>) {
        for (share, what) in self.extrapolated.iter().zip(["speed", "angle to the flow"]) {
            if share.is_none() {
                out.push(format!(
                    "the record does not say at what {what} its drag was fitted: how far it is stretched here is not known"
                ));
            }
            if let Some(share) = share.filter(|share| *share > 0.0) {
                out.push(format!(
                    "extrapolated: {} of the loss is of links whose {what} lies outside of what the drag was fitted at",
                    percent(share)
                ));
            }
        }
        out.push(format!(
            "half of the loss is at angles to the flow below {}, and {} of it by the forces along the links",
            degrees(self.median_angle_rad),
            percent(self.along)
        ));
    }
}

/// The files that were read, for programs.
pub(super) fn files_read(data: &[DataFile]) -> ResultTable {
    let t = TableBuilder::new("data", "", data);
    t.build(vec![
        t.text("path", "", |file| file.path.clone()),
        t.text("sha256", "", |file| file.sha256.clone()),
        t.text("role", "", |file| file.role.clone()),
    ])
}
