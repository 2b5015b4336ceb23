//! A chain in three dimensions from a robot file and the records that it names.
//!
//! Along and across, the drag of a module is that of the plane, by its record ([`crate::robot`]). Up and down it is a part of that across: the file's, or the minor over the major semi-axis, the area seen from above with
//! the same coefficient. No record of a robot in the plane knows it.
//!
//! **Units.** SI.

use froude_hydro::similarity::GRAVITY_M_S2;

use super::chain::{Chain, Link};
use super::drag::LinkDrag;
use super::vector::Inertia;
use crate::added::added_masses;
use crate::robot::{Robot, RobotError};
use crate::robot_file::{ModuleFile, RobotFile};

/// A body whose mass is written in one or two digits is neutral within this part of it at most.
const NEUTRAL: f64 = 0.005;
/// A sum of masses is exact to this part.
const SUMMED: f64 = 1e-12;

/// A body rights itself when its buoyancy lies above its mass by this much, m.
pub const RIGHTS_ITSELF_M: f64 = 1e-5;

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
    /// Its mass less that of the water that it displaces, kg; zero where both are equal within the digits in which they are written.
    pub heavy_kg: f64,
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
            file.model.heave_drag.unwrap_or(module.link.minor_semi_axis_m / module.link.major_semi_axis_m)
        };
        let displaced = displaced_kg(&file.modules, file.density_kg_m3);
        let links: Vec<Link> = file
            .modules
            .iter()
            .zip(&plane.chain.links)
            .zip(added.iter().zip(&displaced))
            .map(|((module, flat), (added, displaced_kg))| {
                let [roll, pitch, yaw] = module.inertia_kg_m2;
                let tensor = [[roll, 0.0, 0.0], [0.0, pitch, 0.0], [0.0, 0.0, yaw]];
                Link {
                    half_length_m: flat.half_length_m,
                    rigid: Inertia::rigid(module.mass_kg, tensor, module.centre_of_mass_m),
                    added: Inertia::of_added_mass(&added.matrix),
                    drag: LinkDrag {
                        along: flat.drag.along,
                        sideways: flat.drag.across,
                        upright: flat.drag.across.map(|c| heave(module) * c),
                        cross: flat.drag.cross,
                        roll: file.model.roll_drag,
                    },
                    weight_n: module.mass_kg * GRAVITY_M_S2,
                    centre_of_mass_m: module.centre_of_mass_m,
                    buoyancy_n: displaced_kg * GRAVITY_M_S2,
                    centre_of_buoyancy_m: module.centre_of_buoyancy_m,
                }
            })
            .collect();
        let [trim_m, righting_m] = apart(&links);
        let heavy_kg = plane.mass_kg - displaced.iter().sum::<f64>();
        // The sum of so many masses is rounded.
        let heavy_kg = if heavy_kg.abs() > SUMMED * plane.mass_kg { heavy_kg } else { 0.0 };
        Ok(Self {
            chain: Chain { links, joints: file.axes.clone() },
            plane,
            righting_m,
            trim_m,
            heavy_kg,
            heave_by_area: file.model.heave_drag.is_none().then(|| file.modules.iter().map(heave).collect()),
        })
    }
}

/// Water that each module displaces, kg. A robot that is neutral within the digits of its masses, volumes and density is exactly neutral: a difference beyond these digits
/// would turn a body that nothing rights, and lift or sink it. Modules that are neutral within their own digits are so by themselves, and the rest is scaled in equal parts.
fn displaced_kg(modules: &[ModuleFile], density_kg_m3: f64) -> Vec<f64> {
    // A file of three dimensions has all volumes.
    let stated = |m: &ModuleFile| m.volume_m3.unwrap_or(0.0) * density_kg_m3;
    let within = |m: &ModuleFile| m.neutral_within.min(NEUTRAL) * m.mass_kg;
    let heavy_kg: f64 = modules.iter().map(|m| m.mass_kg - stated(m)).sum();
    if heavy_kg.abs() > modules.iter().map(within).sum() {
        return modules.iter().map(stated).collect();
    }
    let own = |m: &ModuleFile| if (m.mass_kg - stated(m)).abs() <= within(m) { m.mass_kg } else { stated(m) };
    let mass_kg: f64 = modules.iter().map(|m| m.mass_kg).sum();
    let factor = mass_kg / modules.iter().map(own).sum::<f64>();
    modules.iter().map(|m| factor * own(m)).collect()
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
