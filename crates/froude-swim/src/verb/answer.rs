//! The figures of a swim, of a gait or a recording, in the plane or in three dimensions.

use froude_records::block::{Block, ResultColumn, ResultTable, TableBuilder, facts};
use froude_records::estimate::DataFile;
use froude_records::number::{count, degrees, percent};

pub(super) use super::leaves::Repeats;
use super::moves::Asked;
use crate::dynamics::{Balance, Dynamics};
use crate::means::{Effort, Means};
use crate::robot::Robot;

/// What a swim comes to.
#[derive(Debug)]
pub(super) struct Figures<'a, C> {
    pub name: &'a str,
    pub robot: &'a Robot<C>,
    /// The files that were read.
    pub data: &'a [DataFile],
    pub asked: &'a Asked,
    pub means: Means,
    pub effort: Effort,
    /// Largest part of what a motor gives at its speed, where it has a curve.
    pub motor_share: Option<f64>,
    /// The highest frequency that the motors allow.
    pub fastest_rad_s: Option<f64>,
    /// Of a gait.
    pub repeats: Option<Repeats>,
    /// Of a recording: its length, s, and the kinetic energy gained, J.
    pub track: Option<[f64; 2]>,
    /// In three dimensions.
    pub space: Option<Space>,
}

/// What only three dimensions have.
#[derive(Debug)]
pub(super) struct Space {
    pub balance: Balance,
    /// Least and largest roll and pitch, rad.
    pub tilt: [[f64; 2]; 2],
    /// Way of the centre of mass, m, and its time, s.
    pub way_m: [f64; 3],
    pub time_s: f64,
}

impl Space {
    pub(super) fn sinking_m_s(&self) -> f64 {
        self.way_m[2] / self.time_s
    }
}

impl<C: Dynamics> Figures<'_, C> {
    /// Who swims, with what, in a line.
    pub(super) fn subtitle(&self) -> String {
        let space = if self.space.is_some() { " in three dimensions" } else { "" };
        format!("{} modules{space}, drag of {}", count(self.robot.chain.joints() + 1), self.robot.estimates.0)
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
            f.count("modules", "", |f| f.robot.chain.joints() + 1),
            f.text("drag", "", |f| f.robot.estimates.0.clone()),
            f.text("added_mass", "", |f| f.robot.estimates.1.clone()),
        ];
        columns.extend(self.asked.columns());
        columns.extend(self.speeds_and_powers(&f));
        columns.extend(self.joints(&f));
        columns.extend(self.motion(&f));
        columns.extend([
            f.number("extrapolated_loss_by_speed", "", |f| f.effort.extrapolated[0]),
            f.number("extrapolated_loss_by_angle", "", |f| f.effort.extrapolated[1]),
            f.number("median_angle_of_loss_rad", "", |f| f.effort.median_angle_rad),
            f.number("loss_along_links", "", |f| f.effort.along),
            f.count("gains_power/module", "", |f| f.effort.gain_w.map(|(module, _)| module)),
            f.number("gains_power/power_w", "", |f| f.effort.gain_w.map(|(_, watts)| watts)),
            f.number("mass_less_displaced_kg", "", |f| f.robot.heavy_kg),
            f.count("steps", "", |f| f.effort.steps),
        ]);
        f.build(columns)
    }

    fn speeds_and_powers<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        let speed = if self.space.is_some() { "speed, level [m/s]" } else { "speed [m/s]" };
        let net = if self.means.friction_w > 0.0 {
            "net power: what water and friction take [W]"
        } else {
            "net power: what the water takes [W]"
        };
        vec![
            f.number("speed_m_s", speed, |f| f.means.speed_m_s),
            f.number("cost_of_transport_j_m", "energy per distance, net power/U [J/m]", |f| f.means.cost_j_m()),
            f.number("cost_of_transport_positive_j_m", "energy per distance, positive power/U [J/m]", |f| {
                f.means.cost_positive_j_m()
            }),
            f.number("cost_of_transport", "cost of transport, net power/(m g U) [1]", |f| {
                f.repeats.as_ref().map(|r| r.cost)
            })
            .significant(3),
            f.number("power_net_w", net, |f| f.means.net_w),
            f.number("power_positive_w", "positive power: drives without recovery [W]", |f| f.means.positive_w),
            f.number("power_absolute_w", "power in both directions [W]", |f| f.means.absolute_w),
            f.number("power_loss_w", "", |f| f.means.loss_w),
            f.number("power_friction_w", "friction of the joints [W]", |f| {
                Some(f.means.friction_w).filter(|watts| *watts > 0.0)
            }),
            f.number("power_lifting_w", "", |f| f.space.as_ref().map(|_| f.means.lifting_w)),
            f.number("power_electric_w", "power from the battery [W]", |f| f.effort.electric_w),
            f.number("cost_of_transport_electric_j_m", "energy per distance from the battery [J/m]", |f| {
                f.effort.electric_w.map(|electric| electric / f.means.speed_m_s)
            }),
        ]
    }

    fn joints<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        // A servo gets no more than its motor gives.
        let share =
            if self.effort.stiffness.is_none() { "largest part of what the motor gives at its speed [1]" } else { "" };
        vec![
            f.number("torque_peak_n_m", "largest torque of a motor [N m]", |f| f.effort.needs.torque_n_m)
                .significant(3),
            f.number("rate_peak_rad_s", "largest rate of a joint [deg/s]", |f| f.effort.needs.rate_rad_s),
            f.number("servo/away_from_gait_rad", "largest distance of a joint from its gait [deg]", |f| {
                f.effort.stiffness.map(|_| f.effort.needs.away_rad)
            })
            .places(2),
            f.number("servo/time_at_limit", "", |f| f.effort.stiffness.map(|_| f.effort.needs.at_limit)),
            f.number("servo/damping_eigenvalue_per_s", "", |f| f.effort.stiffness.map(|s| s.damping_per_s)),
            f.number("servo/longest_stable_step_s", "", |f| f.effort.stiffness.map(|s| s.longest_step_s)),
            f.number("motor_share_peak", share, |f| f.motor_share).significant(3),
            f.number("motor_fastest_rad_s", "", |f| f.fastest_rad_s),
        ]
    }

    fn motion<'a>(&'a self, f: &TableBuilder<'a, Self>) -> Vec<ResultColumn> {
        let [turn_key, turn] = match &self.track {
            Some(_) => ["turn_rad", "turn of the head [deg]"],
            None => ["turn_per_period_rad", "turn per period [deg]"],
        };
        let turn = f.number(turn_key, turn, |f| f.means.turn).places(2);
        let mut out = Vec::new();
        if self.space.is_some() {
            let space = |f: &'a Self| f.space.as_ref();
            let [per_period, sinks] =
                if self.track.is_some() { ["", ""] } else { ["_per_period", "sinks per period [mm]"] };
            out.extend([
                f.interval("roll_rad", "roll of the head [deg]", move |f| space(f).map(|s| s.tilt[0])).range(),
                f.interval("pitch_rad", "pitch of the head [deg]", move |f| space(f).map(|s| s.tilt[1])).range(),
                turn,
                f.number(&format!("sinking{per_period}_m"), sinks, move |f| space(f).map(|s| s.way_m[2])).places(2),
                f.number("sinking_m_s", "", move |f| space(f).map(Space::sinking_m_s)),
                f.numbers(&format!("way{per_period}_m"), "", move |f| space(f).map(|s| s.way_m.to_vec())),
                f.number("righting_m", "", move |f| space(f).map(|s| s.balance.righting_m)),
                f.number("trim_m", "", move |f| space(f).map(|s| s.balance.trim_m)),
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
                of(f).map(|r| r.own.multipliers[0])
            })
            .significant(3),
            f.numbers("floquet_multipliers", "", |f| of(f).map(|r| r.own.multipliers.clone())),
            f.number("periodic_residual", "", |f| of(f).map(|r| r.own.residual)),
            f.number("unstable_motion/speed_m_s", "speed of the unstable motion [m/s]", |f| {
                left(f).map(|u| u.means.speed_m_s)
            }),
            f.number("unstable_motion/power_net_w", "net power of the unstable motion [W]", |f| {
                left(f).map(|u| u.means.net_w)
            }),
            f.number("unstable_motion/power_positive_w", "", |f| left(f).map(|u| u.means.positive_w)),
            f.number("unstable_motion/cost_of_transport_j_m", "", |f| left(f).map(|u| u.means.cost_j_m())),
            f.number("unstable_motion/turn_per_period_rad", "", |f| left(f).map(|u| u.means.turn)),
            f.numbers("unstable_motion/floquet_multipliers", "", |f| left(f).map(|u| u.multipliers.clone())),
        ]);
        out
    }

    /// Where the loss is: outside of the fitted speeds and angles, by angle, along the links.
    pub(super) fn losses(&self, out: &mut Vec<String>) {
        for (share, what) in self.effort.extrapolated.iter().zip(["speed", "angle to the flow"]) {
            if share.is_none() {
                out.push(format!(
                    "the record does not say at what {what} its drag was fitted: the extrapolation cannot be assessed"
                ));
            }
            if let Some(share) = share.filter(|share| *share > 0.0) {
                out.push(format!(
                    "extrapolated: {} of the loss is of links whose {what} lies outside the fitted range",
                    percent(share)
                ));
            }
        }
        out.push(format!(
            "half of the loss occurs at flow angles below {}; axial forces account for {} of the total loss",
            degrees(self.effort.median_angle_rad),
            percent(self.effort.along)
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
