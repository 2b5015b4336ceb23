//! What a motion comes to over a time: its means, and what it needs.
//!
//! **Units.** SI.

use crate::seen::Needs;
use crate::stability::Stiffness;

/// Means of a motion over a period or a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Means {
    /// Speed of the centre of mass through the water, level, from beginning to end, m/s.
    pub speed_m_s: f64,
    /// By how much the head turns, rad.
    pub turn: f64,
    /// Mean of Σ τφ̇, W.
    pub net_w: f64,
    /// Mean of Σ max(τφ̇, 0), W.
    pub positive_w: f64,
    /// Mean of Σ |τφ̇|, W.
    pub absolute_w: f64,
    /// Mean of what drag takes, W.
    pub loss_w: f64,
    /// Mean of what friction of the joints takes, W.
    pub friction_w: f64,
    /// Mean of what weight and buoyancy take by the change of depth, W; zero in the plane.
    pub lifting_w: f64,
}

impl Means {
    /// Net power over speed, J/m.
    #[must_use]
    pub fn cost_j_m(&self) -> f64 {
        self.net_w / self.speed_m_s
    }

    /// Positive power over speed, J/m.
    #[must_use]
    pub fn cost_positive_j_m(&self) -> f64 {
        self.positive_w / self.speed_m_s
    }
}

/// What a motion needs of its joints, and where its losses are.
#[derive(Debug, Clone, PartialEq)]
pub struct Effort {
    /// What motors take from the battery, W; `None` where their efficiency is not stated.
    pub electric_w: Option<f64>,
    /// What the joints need.
    pub needs: Needs,
    /// Steps of the time.
    pub steps: usize,
    /// What servos ask of a step; `None` where the joints follow exactly.
    pub stiffness: Option<Stiffness>,
    /// Share of the loss outside of the fitted speeds, and outside of the fitted angles; `None` where the record does not say them.
    pub extrapolated: [Option<f64>; 2],
    /// Share of the loss by the forces along the links.
    pub along: f64,
    /// Half of the loss is at smaller angles to the flow, rad.
    pub median_angle_rad: f64,
    /// Largest power that a module gains from still water at the speeds reached, W, with its number from the head; less than a thousandth of the net power is none.
    pub gain_w: Option<(usize, f64)>,
}
