//! What is said of a swim, beside its figures.

use froude_hydro::Link;
use froude_records::number::{percent, significant};

use super::answer::Figures;
use super::balance;
use crate::dynamics::Dynamics;
use crate::joints::{Drives, Limits};
use crate::robot_file::RobotFile;

/// A body is neutral when it weighs less than this part of itself in water.
pub(super) const NEUTRAL: f64 = 0.005;
/// Lengths that differ by less than this part are the same.
const SAME: f64 = 0.01;

impl<C: Dynamics> Figures<'_, C> {
    /// All of it.
    pub(super) fn sentences(&self, file: &RobotFile, drives: &Drives) -> Vec<String> {
        let mut out = Vec::new();
        if let Some(space) = &self.space {
            balance::trim(&space.balance, &mut out);
            balance::water(self, space, file, &mut out);
        }
        self.losses(&mut out);
        self.dissipation(&mut out);
        self.servos(drives, &mut out);
        self.beyond(&mut out);
        if let Some(fastest) = self.fastest_rad_s {
            out.push(format!("the motors allow this gait up to {} deg/s", significant(fastest.to_degrees(), 3)));
        }
        if self.space.is_none() {
            self.body(file, &mut out);
        }
        out.extend(file.remarks.iter().cloned());
        out
    }

    fn dissipation(&self, out: &mut Vec<String>) {
        if let Some((module, power)) = self.effort.gain_w {
            out.push(format!(
                "not dissipative: module {module} gains up to {} W from still water at speeds up to those reached; choose a law that takes power at every speed or, where it is by-origin, distribution = \"uniform\"",
                significant(power, 2)
            ));
        }
    }

    fn servos(&self, drives: &Drives, out: &mut Vec<String>) {
        let Some(stiffness) = self.effort.stiffness else { return };
        out.push(format!(
            "largest stable time step of the servo loop: {} s (largest eigenvalue of k_d over the inertia of the joints: {} 1/s)",
            significant(stiffness.longest_step_s, 3),
            significant(stiffness.damping_per_s, 3)
        ));
        let needs = &self.effort.needs;
        let least = |of: fn(&Limits) -> Option<f64>| drives.limits.iter().filter_map(of).fold(f64::INFINITY, f64::min);
        let reached =
            [(needs.angle_rad, least(|l| l.angle_rad), "deg"), (needs.rate_rad_s, least(|l| l.rate_rad_s), "deg/s")];
        for (reached, limit, unit) in reached {
            if reached > limit {
                out.push(format!(
                    "beyond the joints: servos take a joint to {} {unit}, and the joints allow {} {unit}",
                    significant(reached.to_degrees(), 3),
                    significant(limit.to_degrees(), 3)
                ));
            }
        }
        if needs.at_limit > 0.0 {
            out.push(format!(
                "at their limit: over all joints, servos give all that they can for {} of the time",
                percent(needs.at_limit)
            ));
        }
    }

    /// What joints that follow exactly need, and their drives do not give.
    fn beyond(&self, out: &mut Vec<String>) {
        let needs = &self.effort.needs;
        if self.effort.stiffness.is_some() {
            return;
        }
        if let Some((joint, torque, limit)) = needs.beyond {
            out.push(format!(
                "beyond the drives: joint {joint} needs {} N m, and it gives {} N m",
                significant(torque, 3),
                significant(limit, 3)
            ));
        }
        if needs.share > 1.0 {
            let by = if needs.share.is_finite() {
                format!("{} times what its motor gives at its speed", significant(needs.share, 3))
            } else {
                "a torque at a speed at which its motor gives none".to_owned()
            };
            out.push(format!("beyond the motors: a joint needs {by}"));
        }
    }

    fn body(&self, file: &RobotFile, out: &mut Vec<String>) {
        if let (Some(id), true) = (&self.robot.estimates.1, self.robot.is_by_link) {
            out.push(format!(
                "C_A of {id} refers to links without head and tail; here every module has the added mass of a link"
            ));
        }
        if self.robot.heavy_kg.is_none() {
            out.push("not every module states its volume: whether the robot is neutral is not known".to_owned());
        }
        let of = &self.robot.refers_to;
        let lengths: [(&str, f64, fn(&Link) -> f64); 3] = [
            ("half height", of.major_semi_axis_m, |l| l.major_semi_axis_m),
            ("half width", of.minor_semi_axis_m, |l| l.minor_semi_axis_m),
            ("half length", of.half_length_m, |l| l.half_length_m),
        ];
        for (name, of, own) in lengths {
            if let Some(own) = file.modules.iter().map(|m| own(&m.link)).find(|own| (own / of - 1.0).abs() > SAME) {
                out.push(format!(
                    "the drag refers to a link whose {name} is {} mm, and a module's is {} mm: its forces are those of the link that was measured",
                    significant(1e3 * of, 4),
                    significant(1e3 * own, 4)
                ));
            }
        }
        if let Some(heavy) = self.robot.heavy_kg.filter(|heavy| heavy.abs() > NEUTRAL * self.robot.mass_kg) {
            let way = if heavy > 0.0 { "heavier" } else { "lighter" };
            out.push(format!(
                "not neutral: the robot is {} kg {way} than the water that its modules displace ({} of its mass); it swims in a plane only if something holds it there",
                significant(heavy.abs(), 2),
                percent(heavy.abs() / self.robot.mass_kg)
            ));
        }
    }
}
