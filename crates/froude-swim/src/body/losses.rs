//! What links lose to the water, and at which speeds and angles to the flow.
//!
//! **Units.** SI.

use crate::dynamics::Dragged;

/// A link at a moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loss {
    pub(crate) speed_m_s: f64,
    /// From fore and aft alike.
    pub(crate) angle_rad: f64,
    pub(crate) power_w: f64,
    /// Of it by the force along the link.
    pub(crate) along_w: f64,
}

impl Loss {
    pub(crate) fn of(drag: &Dragged) -> Self {
        let ([u, v, w], [x, ..]) = (drag.velocity_m_s, drag.force_n);
        let across = v.hypot(w);
        Self {
            speed_m_s: u.hypot(across),
            // Fore and aft, and to all sides, are alike.
            angle_rad: across.atan2(u.abs()),
            // A link that gains energy from the water loses nothing here.
            power_w: drag.power_w.max(0.0),
            along_w: -x * u,
        }
    }
}

/// Of all links at all moments.
#[derive(Debug, Clone, Default)]
pub(crate) struct Losses(pub(crate) Vec<Loss>);

impl Losses {
    pub(crate) fn fastest_m_s(&self) -> f64 {
        self.0.iter().map(|l| l.speed_m_s).fold(0.0, f64::max)
    }

    /// Share of the loss outside of the fitted speeds, and outside of the fitted angles; `None` where the record does not say them.
    pub(crate) fn extrapolated(&self, speed_m_s: Option<[f64; 2]>, angle_rad: Option<[f64; 2]>) -> [Option<f64>; 2] {
        let all: f64 = self.0.iter().map(|l| l.power_w).sum();
        let beyond = |range: Option<[f64; 2]>, of: &dyn Fn(&Loss) -> f64| {
            range.map(|range| {
                let [low, high] = folded(range);
                let outside = self.0.iter().filter(|l| !(low..=high).contains(&of(l)));
                outside.map(|l| l.power_w).fold(0.0, |sum, power| sum + power) / all
            })
        };
        [beyond(speed_m_s, &|l| l.speed_m_s), beyond(angle_rad, &|l| l.angle_rad)]
    }

    /// Share of the loss by the forces along the links.
    pub(crate) fn along(&self) -> f64 {
        let sum = |of: fn(&Loss) -> f64| self.0.iter().map(of).sum::<f64>();
        sum(|l| l.along_w) / sum(|l| l.power_w)
    }

    /// The angle below which half of the loss is, rad.
    pub(crate) fn median_angle_rad(&self) -> f64 {
        let mut losses = self.0.clone();
        losses.sort_by(|a, b| a.angle_rad.total_cmp(&b.angle_rad));
        let half = 0.5 * losses.iter().map(|l| l.power_w).sum::<f64>();
        let mut sum = 0.0;
        let reaches = |l: &Loss| {
            sum += l.power_w;
            (sum >= half).then_some(l.angle_rad)
        };
        losses.iter().find_map(reaches).unwrap_or(0.0)
    }
}

/// A range of sizes: of −39° to −10° that of 10° to 39°.
fn folded([low, high]: [f64; 2]) -> [f64; 2] {
    let least = if low <= 0.0 && high >= 0.0 { 0.0 } else { low.abs().min(high.abs()) };
    [least, low.abs().max(high.abs())]
}
