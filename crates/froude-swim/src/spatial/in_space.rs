//! A chain in three dimensions as the one swimmer has it.
//!
//! Along and across, the drag of a module is that of the plane, by its record ([`crate::robot`]). Up and down it is a part of that across: the file's, or the minor over the major semi-axis, the area seen from above with
//! the same coefficient. No record of a robot in the plane knows it.

use froude_hydro::similarity::GRAVITY_M_S2;

use super::attitude::{LEVEL, Quaternion, angles, of_angles, rate, to_world, unit, world_from_body};
use super::chain::{Chain, Link, Pose as Lies};
use super::drag::LinkDrag;
use super::engine::{Head, Workspace};
use super::vector::{Inertia, Motion, dot, parts};
use crate::dynamics::{Balance, Dragged, Dynamics, Evaluated, StateOf};
use crate::engine::{Given, Joints};
use crate::gait::Course;
use crate::moving::Exact;
use crate::newton::Map;
use crate::path::Swimmer;
use crate::robot_file::{ModuleFile, RobotFile};
use crate::state::{ENERGIES, Numbers, State};
use crate::stepped::Stepped;
use crate::{chain, drag, planar};

/// A body whose mass is written in one or two digits is neutral within this part of it at most.
const NEUTRAL: f64 = 0.005;
/// A sum of masses is exact to this part.
const SUMMED: f64 = 1e-12;

/// Place, m, and how the head lies.
pub type Pose = [f64; 7];

fn attitude(pose: &Pose) -> Quaternion {
    Quaternion::first_of(&pose[3..])
}

fn lies(pose: &Pose) -> Lies {
    Lies { place_m: Chain::place_m(pose), world_from_link: world_from_body(attitude(pose)) }
}

impl Dynamics for Chain {
    type Pose = Pose;
    type Motion = Motion;
    type Work = Workspace;

    const TILTS: bool = true;
    const REST: StateOf<Self> = State {
        pose: [0.0, 0.0, 0.0, LEVEL[0], LEVEL[1], LEVEL[2], LEVEL[3]],
        head: [0.0; 6],
        energy_j: [0.0; ENERGIES],
    };

    fn built(file: &RobotFile, drags: &[drag::LinkDrag], added: &[[[f64; 6]; 6]]) -> Self {
        let displaced = displaced_kg(&file.modules, file.density_kg_m3);
        let link = |i: usize| {
            let (module, drag) = (&file.modules[i], &drags[i]);
            let [roll, pitch, yaw] = module.inertia_kg_m2;
            let tensor = [[roll, 0.0, 0.0], [0.0, pitch, 0.0], [0.0, 0.0, yaw]];
            Link {
                half_length_m: module.link.half_length_m,
                rigid: Inertia::rigid(module.mass_kg, tensor, module.centre_of_mass_m),
                added: Inertia::of_added_mass(&added[i]),
                drag: LinkDrag {
                    along: drag.along,
                    sideways: drag.across,
                    upright: drag.across.map(|c| file.heave_drag(module) * c),
                    cross: drag.cross,
                    roll: file.model.roll_drag,
                },
                weight_n: module.mass_kg * GRAVITY_M_S2,
                centre_of_mass_m: module.centre_of_mass_m,
                buoyancy_n: displaced[i] * GRAVITY_M_S2,
                centre_of_buoyancy_m: module.centre_of_buoyancy_m,
            }
        };
        Self { links: (0..file.modules.len()).map(link).collect(), joints: file.axes.clone() }
    }

    fn flat(&self) -> chain::Chain {
        let inertia = |Inertia(a): &Inertia| planar::Inertia {
            turn: a[2][2],
            turn_x: a[2][3],
            turn_y: a[2][4],
            x: a[3][3],
            xy: a[3][4],
            y: a[4][4],
        };
        let link = |link: &Link| chain::Link {
            half_length_m: link.half_length_m,
            rigid: inertia(&link.rigid),
            added: inertia(&link.added),
            drag: drag::LinkDrag {
                along: link.drag.along,
                across: link.drag.sideways,
                cross: link.drag.cross,
                turning: drag::Turning::Strip,
            },
        };
        chain::Chain { links: self.links.iter().map(link).collect(), added_mass: chain::AddedMass::Full }
    }

    fn joints(&self) -> usize {
        self.joints.len()
    }

    fn work(&self) -> Workspace {
        Workspace::new(self)
    }

    fn evaluate(
        &self,
        work: &mut Workspace,
        (pose, motion): (&Pose, Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Motion> {
        let head = Head { motion, down: world_from_body(attitude(pose))[2] };
        work.evaluate(self, head, joints, given)
    }

    fn recursion(
        &self,
        work: &mut Workspace,
        head: (&Pose, Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Motion> {
        self.evaluate(work, head, joints, given)
    }

    fn evaluated(work: &Workspace) -> Evaluated<'_, Motion> {
        Evaluated { motions: work.motions(), answer: &work.answer, loss_w: work.loss_w }
    }

    fn pose_rate(pose: &Pose, head: Motion, current_m_s: [f64; 3]) -> Pose {
        let [turning, moving] = parts(head);
        let [x, y, z] = to_world(&world_from_body(attitude(pose)), moving);
        let [a, b, c, d] = rate(attitude(pose), turning);
        [x + current_m_s[0], y + current_m_s[1], z + current_m_s[2], a, b, c, d]
    }

    /// On the unit sphere.
    fn settle(pose: &mut [f64]) {
        let on_sphere = unit(Quaternion::first_of(&pose[3..]));
        pose[3..].copy_from_slice(&on_sphere);
    }

    fn pose([x, y, z]: [f64; 3], angles: [f64; 3]) -> Pose {
        let [a, b, c, d] = of_angles(angles);
        [x, y, z, a, b, c, d]
    }

    fn place_m(pose: &Pose) -> [f64; 3] {
        <[f64; 3]>::first_of(pose)
    }

    fn angles(pose: &Pose) -> [f64; 3] {
        angles(attitude(pose))
    }

    fn six(motion: &Motion) -> [f64; 6] {
        *motion
    }

    fn level([r, u, v]: [f64; 3]) -> Motion {
        [0.0, 0.0, r, u, v, 0.0]
    }

    fn centre_m(&self, pose: &Pose, angle: &[f64]) -> [f64; 3] {
        Self::centre_m(self, lies(pose), angle)
    }

    fn energy_j(&self, pose: &Pose, angle: &[f64], motions: &[Motion]) -> [f64; 2] {
        [self.kinetic_j(motions), self.potential_j(lies(pose), angle)]
    }

    fn dragged(&self, link: usize, motion: Motion) -> Dragged {
        let link = &self.links[link];
        let load = link.drag.load(link.half_length_m, motion);
        let ([_, velocity_m_s], [_, force_n]) = (parts(motion), parts(load));
        Dragged { velocity_m_s, force_n, power_w: -dot(load, motion) }
    }

    fn balance(&self) -> Option<Balance> {
        let [trim_m, righting_m] = self.apart_m();
        let sum = |of: fn(&Link) -> f64| self.links.iter().map(of).sum::<f64>() / GRAVITY_M_S2;
        let (mass_kg, heavy_kg) = (sum(|link| link.weight_n), sum(|link| link.weight_n - link.buoyancy_n));
        // The sum of so many masses is rounded.
        let heavy_kg = if heavy_kg.abs() > SUMMED * mass_kg { heavy_kg } else { 0.0 };
        Some(Balance { righting_m, trim_m, heavy_kg })
    }

    fn map<'a>(&'a self, course: &'a dyn Course, steps: usize) -> Option<Box<dyn Map + 'a>> {
        let moving = Exact::new(Swimmer::new(self, course), Self::REST);
        Some(Box::new(Stepped::new(moving, self, (course.period_s(), steps))))
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
