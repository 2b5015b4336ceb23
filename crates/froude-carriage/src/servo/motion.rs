//! The motion of an axis that a law is evaluated at.

/// Filtered motion at the full rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Position, m.
    pub position_m: Vec<f64>,
    /// Speed, m/s.
    pub velocity_m_s: Vec<f64>,
    /// Acceleration, m/s².
    pub acceleration_m_s2: Vec<f64>,
}

impl Motion {
    /// Speeds alone, for laws that read nothing else.
    pub(crate) fn at_speeds(velocity_m_s: Vec<f64>) -> Self {
        let none = vec![0.0; velocity_m_s.len()];
        Self { position_m: none.clone(), velocity_m_s, acceleration_m_s2: none }
    }
}
