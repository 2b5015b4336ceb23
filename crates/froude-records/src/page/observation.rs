//! Observations and the lines of a model through them, as a page draws them.
//!
//! **Units.** SI; angles in radians. A load carries its unit as text beside it.

use std::sync::Arc;

/// What many observations share.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Observed {
    /// Configuration (`H1LT`, …); empty when there is only one.
    pub configuration: String,
    /// Load component: `f_x`, `m_z`, …
    pub component: String,
    /// Unit of `measured`, `standard` and `fitted`.
    pub unit: String,
    /// Another abscissa, for loads that do not go with speed or angle (a rotor's rate): name of the channel, and its unit.
    pub other: Option<[String; 2]>,
}

/// One steady observation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// What was observed.
    pub of: Arc<Observed>,
    /// Speed through the water.
    pub speed_m_s: f64,
    /// Angle `atan2(−v_y, v_x)`.
    pub angle_rad: f64,
    /// The other abscissa.
    pub other: f64,
    /// The measured load.
    pub measured: f64,
    /// Its standard uncertainty, where one is known.
    pub standard: Option<f64>,
    /// What the recommended model gives there.
    pub fitted: f64,
}

/// A channel at one value: an abscissa, or what a curve holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Abscissa {
    /// Name of the channel, e.g. `w_z`.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Its value, in `unit`.
    pub value: f64,
}

/// What a curve runs against, and what is held on it.
#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    /// `x` is the speed \[m/s\] at this angle.
    Speed {
        /// Angle held on the curve.
        angle_rad: f64,
    },
    /// `x` is the angle \[rad\] at this speed.
    Angle {
        /// Speed held on the curve.
        speed_m_s: f64,
    },
    /// `x` is another channel, in `unit`.
    Other {
        /// Name of the channel, as in [`Abscissa::quantity`].
        quantity: String,
        /// Its unit.
        unit: String,
    },
}

/// A model line with its 95 % band.
///
/// `x`, `y`, `low` and `high` have one entry per place on the line; an empty
/// `low` or `high` means that no band is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Configuration, as in [`Observed::configuration`].
    pub configuration: String,
    /// Load component, as in [`Observed::component`].
    pub component: String,
    /// Unit of `y`, `low` and `high`.
    pub unit: String,
    /// The model that it belongs to; lines of the recommended model are drawn
    /// solid, others dashed and without band.
    pub model: String,
    /// What `x` is.
    pub against: Against,
    /// What else the law reads and the observations vary in, at the value that it has all along the curve.
    pub held: Vec<Abscissa>,
    /// Abscissae, rising.
    pub x: Vec<f64>,
    /// Loads.
    pub y: Vec<f64>,
    /// Lower edge of the 95 % band.
    pub low: Vec<f64>,
    /// Upper edge of the 95 % band.
    pub high: Vec<f64>,
}
