//! What the joints of a robot allow, and what drives them.
//!
//! **Units.** SI; angles in rad.

use crate::drive::{Following, Motor};
use crate::robot_file::JointFile;

/// Limits of a joint, where they are declared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Largest angle, rad.
    pub angle_rad: Option<f64>,
    /// Largest rate, rad/s.
    pub rate_rad_s: Option<f64>,
    /// Largest torque, N m.
    pub torque_n_m: Option<f64>,
}

impl Limits {
    /// With those of another where it has none.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            angle_rad: self.angle_rad.or(other.angle_rad),
            rate_rad_s: self.rate_rad_s.or(other.rate_rad_s),
            torque_n_m: self.torque_n_m.or(other.torque_n_m),
        }
    }
}

/// All joints, from the head.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drives {
    /// Of each.
    pub limits: Vec<Limits>,
    /// Servos of each; empty where the joints follow their gait exactly.
    pub following: Vec<Following>,
    /// The motor that all of them have.
    pub motor: Motor,
}

impl Drives {
    /// Joints that follow a gait exactly, without limits.
    #[must_use]
    pub fn free(joints: usize) -> Self {
        Self { limits: vec![Limits::default(); joints], ..Self::default() }
    }

    /// The joints of a robot file, without a motor's curve: what all have, and each of them.
    #[must_use]
    pub fn of(all: &JointFile, each: &[JointFile]) -> Self {
        let following = |file: &JointFile| Some(Following { torque_n_m: file.limits.torque_n_m, ..file.servo? });
        Self {
            limits: each.iter().map(|file| file.limits).collect(),
            following: each.iter().filter_map(following).collect(),
            motor: Motor { curve: Vec::new(), efficiency: all.efficiency, regeneration: all.regeneration },
        }
    }
}
