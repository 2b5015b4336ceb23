//! A chain in three dimensions from a robot file and the records that it names.
//!
//! Along and across, the drag of a module is that of the plane, by its record ([`crate::robot`]). Up and down it is a part of that across: the file's, or the minor over the major semi-axis, the area seen from above with
//! the same coefficient. No record of a robot in the plane knows it.
//!
//! **Units.** SI.

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_records::robot::{JointAxis, ModuleFile, RobotFile};

use super::chain::{Chain, Link};
use super::drag::LinkDrag;
use super::vector::{Axis, Inertia};
use crate::added::added_masses;
use crate::robot::{Robot, RobotError};

/// A robot that can swim in three dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialRobot {
    /// Its links.
    pub chain: Chain,
    /// The same in the plane: where its coefficients come from, and what it weighs.
    pub plane: Robot,
    /// How far the mass lies below the buoyancy where it is straight and level, by weight, m: what rights it.
    pub righting_m: f64,
    /// How far the mass lies ahead of the buoyancy then, m: what brings its bow down.
    pub trim_m: f64,
    /// Drag up and down over that across, of each module, where the file does not say it.
    pub heave_by_area: Option<Vec<f64>>,
}

impl SpatialRobot {
    /// The robot of a file.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: records that cannot be read, estimates that are none of a robot, numbers without what they refer to, an added mass of sway alone.
    pub fn of(file: &RobotFile) -> Result<Self, RobotError> {
        let plane = Robot::in_plane(file)?;
        if let (true, Some(id)) = (plane.is_by_link, &plane.estimates.1) {
            return Err(RobotError::SwayAlone { id: id.clone() });
        }
        let (added, _) = added_masses(file)?;
        let heave = |module: &ModuleFile| {
            file.spatial.heave_drag.unwrap_or(module.link.minor_semi_axis_m / module.link.major_semi_axis_m)
        };
        let links: Vec<Link> = file
            .modules
            .iter()
            .zip(&plane.chain.links)
            .zip(&added)
            .map(|((module, flat), added)| {
                let own = &module.spatial;
                let [roll, pitch, yaw] = own.inertia_kg_m2;
                let tensor = [[roll, 0.0, 0.0], [0.0, pitch, 0.0], [0.0, 0.0, yaw]];
                Link {
                    half_length_m: flat.half_length_m,
                    rigid: Inertia::rigid(module.mass_kg, tensor, own.centre_of_mass_m),
                    added: Inertia::of_added_mass(&added.matrix),
                    drag: LinkDrag {
                        along: flat.drag.along,
                        sideways: flat.drag.across,
                        upright: flat.drag.across.map(|c| heave(module) * c),
                        cross: flat.drag.cross,
                        roll: file.spatial.roll_drag,
                    },
                    weight_n: module.mass_kg * GRAVITY_M_S2,
                    centre_of_mass_m: own.centre_of_mass_m,
                    // A file of three dimensions has all volumes.
                    buoyancy_n: module.volume_m3.unwrap_or(0.0) * file.density_kg_m3 * GRAVITY_M_S2,
                    centre_of_buoyancy_m: own.centre_of_buoyancy_m,
                }
            })
            .collect();
        let axis = |axis: &JointAxis| match axis {
            JointAxis::Yaw => Axis::Yaw,
            JointAxis::Pitch => Axis::Pitch,
        };
        let [trim_m, righting_m] = apart(&links);
        Ok(Self {
            chain: Chain { links, joints: file.axes.iter().map(axis).collect() },
            plane,
            righting_m,
            trim_m,
            heave_by_area: file.spatial.heave_drag.is_none().then(|| file.modules.iter().map(heave).collect()),
        })
    }
}

/// The centre of mass less that of buoyancy of a straight, level chain, ahead and down.
fn apart(links: &[Link]) -> [f64; 2] {
    // Of weight and of buoyancy: their sum, with their moments along x and z.
    let mut sums = [[0.0; 3]; 2];
    let mut centre = 0.0;
    for (i, link) in links.iter().enumerate() {
        if i > 0 {
            centre -= links[i - 1].half_length_m + link.half_length_m;
        }
        let both = [(link.weight_n, link.centre_of_mass_m), (link.buoyancy_n, link.centre_of_buoyancy_m)];
        for (sum, (force, at)) in sums.iter_mut().zip(both) {
            sum[0] += force;
            sum[1] += force * (centre + at[0]);
            sum[2] += force * at[2];
        }
    }
    let [mass, water] = sums;
    [1, 2].map(|k| mass[k] / mass[0] - water[k] / water[0])
}
