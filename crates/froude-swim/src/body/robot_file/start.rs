//! `[start]`: where a trajectory begins.

use froude_records::RecordError;
use froude_records::section::Section;
use froude_records::units::Dimension;

use super::pair;

/// Of the head's centre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StartFile {
    /// In the tank, m.
    pub place_m: [f64; 2],
    /// rad from x to y.
    pub heading_rad: f64,
    /// Turn rate, rad/s, and speed through the water along and across the head, m/s.
    pub motion: [f64; 3],
}

pub(super) fn start(s: &Section<'_>) -> Result<StartFile, RecordError> {
    s.only(&["place", "heading", "velocity", "turn_rate"])?;
    let place_m = pair(s, "place", Dimension::LENGTH, "two lengths: [\"0 m\", \"0 m\"]")?.unwrap_or_default();
    let velocity = pair(s, "velocity", Dimension::SPEED, "two speeds: [\"0.1 m/s\", \"0 m/s\"]")?;
    let [u, v] = velocity.unwrap_or_default();
    let turn_rate = s.quantity("turn_rate", Dimension::ANGULAR_SPEED)?.unwrap_or(0.0);
    Ok(StartFile {
        place_m,
        heading_rad: s.quantity("heading", Dimension::ANGLE)?.unwrap_or(0.0),
        motion: [turn_rate, u, v],
    })
}
