//! Gains held against the measured response and the ramps that they must follow.

use froude_control::config::CountGains;

use super::LoopGains;
use super::margins::Margins;

/// Gains with the margins that they have on the measured response, and what they do to the campaign's ramps.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Where they come from.
    pub name: String,
    /// In SI.
    pub gains: LoopGains,
    /// The same in counts and ticks of the controller, V per unit.
    pub counts: CountGains,
    /// Margins on the measured response.
    pub margins: Margins,
    /// Margins with the heaviest body, on the fitted two-mass model; `None` where there is none.
    pub heaviest: Option<Margins>,
    /// Lowest mode of a load on a held motor, Hz: that of the heaviest body.
    pub lowest_load_hz: Option<f64>,
    /// The measured band did not hold the whole loop: beyond it the margins are the fitted two-mass model's.
    pub is_extended: bool,
    /// One encoder count moves the command by this much through the derivative, V.
    pub volts_per_count: f64,
    /// Largest following error in homing and towing, m, on the fitted two-mass model; `None` where there is none.
    pub following_error_m: Option<f64>,
    /// Largest speed of the motor in homing, m/s, likewise.
    pub homing_m_s: Option<f64>,
    /// Objections to them; none if they are fit for the campaign.
    pub objections: Vec<String>,
}
