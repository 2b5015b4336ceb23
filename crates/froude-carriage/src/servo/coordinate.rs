//! Linear or rotary axes: the equations are the same; names and units differ.

use froude_records::units::Dimension;

/// The coordinate of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coordinate {
    /// Along a line, m: masses and forces.
    #[default]
    Linear,
    /// About an axis, rad: moments of inertia and torques.
    Rotary,
}

/// Names and units of one coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Names {
    /// The coefficient of the acceleration, and its unit.
    pub inertia: [&'static str; 2],
    /// Unit of viscous friction.
    pub viscous: &'static str,
    /// Unit of Coulomb friction, of the offset and of the drive.
    pub load: &'static str,
    /// The position in formulas, and its unit.
    pub position: [&'static str; 2],
    /// The speed in formulas, and its unit.
    pub speed: [&'static str; 2],
    /// The acceleration in formulas, and its unit.
    pub acceleration: [&'static str; 2],
    /// What the drive gives, as a law calls it.
    pub drive: &'static str,
    /// The same in words.
    pub words: &'static str,
}

const LINEAR: Names = Names {
    inertia: ["M", "kg"],
    viscous: "N s/m",
    load: "N",
    position: ["position", "m"],
    speed: ["v_y", "m/s"],
    acceleration: ["v_y_dot", "m/s^2"],
    drive: "drive_force",
    words: "force",
};

const ROTARY: Names = Names {
    inertia: ["J", "kg m^2"],
    viscous: "N m s",
    load: "N m",
    position: ["angle", "rad"],
    speed: ["angle_dot", "rad/s"],
    acceleration: ["angle_dot_dot", "rad/s^2"],
    drive: "drive_torque",
    words: "torque",
};

impl Coordinate {
    /// Its names and units.
    #[must_use]
    pub const fn names(self) -> &'static Names {
        match self {
            Self::Linear => &LINEAR,
            Self::Rotary => &ROTARY,
        }
    }

    /// m/s or rad/s.
    #[must_use]
    pub const fn speed_dimension(self) -> Dimension {
        match self {
            Self::Linear => Dimension::SPEED,
            Self::Rotary => Dimension::ANGULAR_SPEED,
        }
    }
}

/// Whether a coefficient is that of the acceleration.
pub(crate) fn is_inertia(name: &str) -> bool {
    name == LINEAR.inertia[0] || name == ROTARY.inertia[0]
}

/// Whether a number of a fit says when or where the law changes, and is no coefficient of it.
pub(crate) fn is_place(name: &str) -> bool {
    name == DELAY || name == FILTER || name == STRIBECK_SPEED
}

/// The delay of the command.
pub(crate) const DELAY: &str = "delay";
/// Time constant of the filter of a recorded speed.
pub(crate) const FILTER: &str = "filter";
/// The speed at which Stribeck's term has fallen to 1/e.
pub(crate) const STRIBECK_SPEED: &str = "v_s";
