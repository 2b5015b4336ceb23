//! What is said of a swim, to a person and to a program.

use froude_records::number::{count, degrees, fixed, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_swim::joints::Limits;
use froude_swim::seen::Needs;
use froude_swim::stability::Stiffness;
use serde_json::{Value, json};

use super::leaves::Repeating;
use super::{Came, Swum};

/// A body is neutral when it weighs less than this part of itself in water.
pub(super) const NEUTRAL: f64 = 0.005;
/// Lengths that differ by less than this part are the same.
const SAME: f64 = 0.01;

/// Where the loss is: outside of the fitted speeds and angles, by angle, along the links.
pub(super) fn losses(extrapolated: [Option<f64>; 2], median_angle_rad: f64, along: f64, out: &mut Vec<String>) {
    for (share, what) in extrapolated.iter().zip(["speed", "angle to the flow"]) {
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
        degrees(median_angle_rad),
        percent(along)
    ));
}

/// Numbers that a gait and a recording both have.
struct Figures {
    speed_m_s: f64,
    turn: f64,
    net_w: f64,
    positive_w: f64,
    absolute_w: f64,
    loss_w: f64,
    friction_w: f64,
    electric_w: Option<f64>,
    needs: Needs,
    steps: usize,
    stiffness: Option<Stiffness>,
    extrapolated: [Option<f64>; 2],
    along: f64,
    median_angle_rad: f64,
    gain_w: Option<(usize, f64)>,
}

impl Figures {
    fn of(came: &Came) -> Self {
        match came {
            Came::Gait(s) => {
                let p = &s.periodic;
                Self {
                    speed_m_s: p.speed_m_s,
                    turn: p.turn,
                    net_w: p.net_w,
                    positive_w: p.positive_w,
                    absolute_w: p.absolute_w,
                    loss_w: p.loss_w,
                    friction_w: p.friction_w,
                    electric_w: s.electric_w,
                    needs: s.needs,
                    steps: s.steps,
                    stiffness: s.stiffness,
                    extrapolated: s.extrapolated,
                    along: s.along,
                    median_angle_rad: s.median_angle_rad,
                    gain_w: s.gain_w,
                }
            }
            Came::Track(t) => Self {
                speed_m_s: t.speed_m_s,
                turn: t.turn,
                net_w: t.net_w,
                positive_w: t.positive_w,
                absolute_w: t.absolute_w,
                loss_w: t.loss_w,
                friction_w: t.friction_w,
                electric_w: t.electric_w,
                needs: t.needs,
                steps: t.steps,
                stiffness: t.stiffness,
                extrapolated: t.extrapolated,
                along: t.along,
                median_angle_rad: t.median_angle_rad,
                gain_w: t.gain_w,
            },
        }
    }
}

impl Swum {
    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let f = Figures::of(&self.came);
        let row = |name: &str, value: String, unit: &str| vec![name.to_owned(), value, unit.to_owned()];
        let mut rows: Vec<Vec<String>> =
            self.asked.words().into_iter().map(|(name, value, unit)| row(name, value, unit)).collect();
        rows.push(row("speed", significant(f.speed_m_s, 4), "m/s"));
        rows.extend([
            row("cost of transport", significant(f.net_w / f.speed_m_s, 4), "J/m"),
            row("the same by positive power", significant(f.positive_w / f.speed_m_s, 4), "J/m"),
        ]);
        if let Came::Gait(s) = &self.came {
            rows.push(row("cost of transport over m g U", significant(s.cost, 3), "1"));
        }
        let net = if f.friction_w > 0.0 {
            "net power: what water and friction take"
        } else {
            "net power: what the water takes"
        };
        rows.extend([
            row(net, significant(f.net_w, 4), "W"),
            row("positive power: drives without recovery", significant(f.positive_w, 4), "W"),
            row("power in both directions", significant(f.absolute_w, 4), "W"),
        ]);
        if f.friction_w > 0.0 {
            rows.push(row("friction of the joints", significant(f.friction_w, 4), "W"));
        }
        if let Some(electric) = f.electric_w {
            rows.push(row("power from the battery", significant(electric, 4), "W"));
            rows.push(row("cost of transport from the battery", significant(electric / f.speed_m_s, 4), "J/m"));
        }
        rows.push(row("largest torque of a motor", significant(f.needs.torque_n_m, 3), "N m"));
        rows.push(row("largest rate of a joint", significant(f.needs.rate_rad_s.to_degrees(), 4), "deg/s"));
        if f.stiffness.is_some() {
            rows.push(row("largest distance of a joint from its gait", fixed(f.needs.away_rad.to_degrees(), 2), "deg"));
        }
        if !self.drives.motor.curve.is_empty() && f.stiffness.is_none() {
            rows.push(row("largest part of what the motor gives at its speed", significant(f.needs.share, 3), "1"));
        }
        match &self.came {
            Came::Gait(s) => {
                rows.push(row("turn per period", fixed(f.turn.to_degrees(), 2), "deg"));
                rows.push(row("largest Floquet multiplier", significant(s.periodic.multipliers[0], 3), "1"));
                rows.extend(s.unstable.iter().flat_map(|unstable| Repeating::from(&**unstable).rows()));
            }
            Came::Track(t) => {
                rows.push(row("turn of the head", fixed(f.turn.to_degrees(), 2), "deg"));
                rows.push(row("kinetic energy gained", significant(t.gained_j, 3), "J"));
                rows.push(row("length of the recording", significant(t.length_s, 4), "s"));
            }
        }
        DocumentSection {
            title: self.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![TextTable {
                caption: format!(
                    "{}: {} modules, drag of {}",
                    self.name,
                    count(self.robot.chain.links.len()),
                    self.robot.estimates.0
                ),
                head: vec!["quantity".to_owned(), "value".to_owned(), "unit".to_owned()],
                rows,
            }],
            charts: Vec::new(),
        }
    }

    /// What is to be read before the figures: a motion that the swimmer leaves.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        let Came::Gait(s) = &self.came else { return out };
        let settled = Repeating::from(&s.periodic);
        match &s.unstable {
            Some(unstable) => out.push(Repeating::from(&**unstable).leaves(&settled, self.period_s)),
            None if s.periodic.multipliers[0] > 1.0 => out.push(settled.stays(true)),
            None => {}
        }
        out
    }

    fn sentences(&self) -> Vec<String> {
        let f = Figures::of(&self.came);
        let mut out = self.warnings();
        Self::drag(&f, &mut out);
        self.joints(&f, &mut out);
        self.body(&mut out);
        out.extend(self.remarks.iter().cloned());
        out
    }

    fn drag(f: &Figures, out: &mut Vec<String>) {
        losses(f.extrapolated, f.median_angle_rad, f.along, out);
        if let Some((module, power)) = f.gain_w {
            out.push(format!(
                "not dissipative: module {module} gains up to {} W from still water at speeds up to those reached; choose a law that takes power at every speed or, where it is by-origin, distribution = \"uniform\"",
                significant(power, 2)
            ));
        }
    }

    fn joints(&self, f: &Figures, out: &mut Vec<String>) {
        if let Some(stiffness) = f.stiffness {
            out.push(format!(
                "servos follow the gait in steps of which the longest that is stable is {} s (largest eigenvalue of k_d over the inertia of the joints: {} 1/s)",
                significant(stiffness.longest_step_s, 3),
                significant(stiffness.damping_per_s, 3)
            ));
        }
        if f.stiffness.is_some() {
            let least =
                |of: fn(&Limits) -> Option<f64>| self.drives.limits.iter().filter_map(of).fold(f64::INFINITY, f64::min);
            let reached = [
                (f.needs.angle_rad, least(|l| l.angle_rad), "deg"),
                (f.needs.rate_rad_s, least(|l| l.rate_rad_s), "deg/s"),
            ];
            for (reached, limit, unit) in reached {
                if reached > limit {
                    out.push(format!(
                        "beyond the joints: servos take a joint to {} {unit}, and the joints allow {} {unit}",
                        significant(reached.to_degrees(), 3),
                        significant(limit.to_degrees(), 3)
                    ));
                }
            }
        }
        if f.needs.at_limit > 0.0 {
            out.push(format!(
                "at their limit: over all joints, servos give all that they can for {} of the time",
                percent(f.needs.at_limit)
            ));
        }
        if let (None, Some((joint, torque, limit))) = (f.stiffness, f.needs.beyond) {
            out.push(format!(
                "beyond the drives: joint {joint} needs {} N m, and it gives {} N m",
                significant(torque, 3),
                significant(limit, 3)
            ));
        }
        if f.stiffness.is_none() && f.needs.share > 1.0 {
            let by = if f.needs.share.is_finite() {
                format!("{} times what its motor gives at its speed", significant(f.needs.share, 3))
            } else {
                "a torque at a speed at which its motor gives none".to_owned()
            };
            out.push(format!("beyond the motors: a joint needs {by}"));
        }
        if let Some(fastest) = self.fastest_rad_s {
            out.push(format!("the motors allow this gait up to {} deg/s", significant(fastest.to_degrees(), 3)));
        }
    }

    fn body(&self, out: &mut Vec<String>) {
        if let (Some(id), true) = (&self.robot.estimates.1, self.robot.is_by_link) {
            out.push(format!(
                "C_A of {id} refers to links without head and tail; here every module has the added mass of a link"
            ));
        }
        if self.robot.heavy_kg.is_none() {
            out.push("not every module states its volume: whether the robot is neutral is not known".to_owned());
        }
        let of = &self.robot.refers_to;
        let of = [of.major_semi_axis_m, of.minor_semi_axis_m, of.half_length_m];
        let words = ["half height", "half width", "half length"];
        for (k, name) in words.iter().enumerate() {
            let other = self.sections.iter().map(|s| s[k]).find(|own| (own / of[k] - 1.0).abs() > SAME);
            if let Some(own) = other {
                out.push(format!(
                    "the drag refers to a link whose {name} is {} mm, and a module's is {} mm: its forces are those of the link that was measured",
                    significant(1e3 * of[k], 4),
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

    /// The same for a program, each number in SI with its unit in the name.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let f = Figures::of(&self.came);
        let mut out = json!({
            "robot": self.name,
            "data": self.data,
            "modules": self.robot.chain.links.len(),
            "drag": self.robot.estimates.0,
            "added_mass": self.robot.estimates.1,
            "speed_m_s": f.speed_m_s,
            "cost_of_transport_j_m": f.net_w / f.speed_m_s,
            "cost_of_transport_positive_j_m": f.positive_w / f.speed_m_s,
            "power_net_w": f.net_w,
            "power_positive_w": f.positive_w,
            "power_absolute_w": f.absolute_w,
            "power_loss_w": f.loss_w,
            "power_friction_w": f.friction_w,
            "power_electric_w": f.electric_w,
            "torque_peak_n_m": f.needs.torque_n_m,
            "rate_peak_rad_s": f.needs.rate_rad_s,
            "motor_share_peak": (!self.drives.motor.curve.is_empty()).then_some(f.needs.share),
            "motor_fastest_rad_s": self.fastest_rad_s,
            "steps": f.steps,
            "servo": f.stiffness.map(|s| json!({
                "away_from_gait_rad": f.needs.away_rad,
                "time_at_limit": f.needs.at_limit,
                "damping_eigenvalue_per_s": s.damping_per_s,
                "longest_stable_step_s": s.longest_step_s,
            })),
            "extrapolated_loss_by_speed": f.extrapolated[0],
            "extrapolated_loss_by_angle": f.extrapolated[1],
            "median_angle_of_loss_rad": f.median_angle_rad,
            "loss_along_links": f.along,
            "gains_power": f.gain_w.map(|(module, watts)| json!({"module": module, "power_w": watts})),
            "mass_less_displaced_kg": self.robot.heavy_kg,
            "trajectory": self.written.as_ref().map(|w| &w.trajectory),
            "report": self.written.as_ref().map(|w| &w.report),
            "animation": self.written.as_ref().map(|w| &w.animation),
            "remarks": self.sentences(),
        });
        let own = match &self.came {
            Came::Gait(s) => json!({
                "cost_of_transport": s.cost,
                "turn_per_period_rad": f.turn,
                "floquet_multipliers": s.periodic.multipliers,
                "periodic_residual": s.periodic.residual,
                "unstable_motion": s.unstable.as_ref().map(|u| Repeating::from(&**u).as_json()),
            }),
            Came::Track(t) => json!({
                "length_s": t.length_s,
                "turn_rad": f.turn,
                "energy_gained_j": t.gained_j,
            }),
        };
        if let (Value::Object(out), Value::Object(own)) = (&mut out, own) {
            out.extend(own);
            out.insert("asked".to_owned(), self.asked.as_json());
            if let Some(uncertain) = &self.uncertain {
                out.insert("uncertainty".to_owned(), uncertain.as_json());
            }
        }
        out
    }
}
