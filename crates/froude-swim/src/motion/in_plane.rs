//! A chain in the plane as the one swimmer has it.

use crate::chain::{Chain, Link};
use crate::drag::LinkDrag;
use crate::dynamics::{Balance, Dragged, Dynamics, Evaluated, StateOf};
use crate::engine::{Given, Joints, Workspace};
use crate::gait::Course;
use crate::head::HeadMap;
use crate::newton::Map;
use crate::planar::{Inertia, Motion, dot};
use crate::robot_file::RobotFile;
use crate::state::{ENERGIES, State};

/// Place, m, and heading, rad.
pub type Pose = [f64; 3];

impl Dynamics for Chain {
    type Pose = Pose;
    type Motion = Motion;
    type Work = Workspace;

    const TILTS: bool = false;
    const REST: StateOf<Self> = State { pose: [0.0; 3], head: [0.0; 3], energy_j: [0.0; ENERGIES] };

    fn built(file: &RobotFile, drags: &[LinkDrag], added: &[[[f64; 6]; 6]]) -> Self {
        let links = file.modules.iter().zip(drags).zip(added).map(|((module, drag), a)| {
            let [turn, turn_x, turn_y, x, xy, y] = [a[5][5], a[0][5], a[1][5], a[0][0], a[0][1], a[1][1]];
            Link {
                half_length_m: module.link.half_length_m,
                rigid: Inertia::rigid(module.mass_kg, module.inertia_kg_m2[2], module.centre_of_mass_m[0]),
                added: Inertia { turn, turn_x, turn_y, x, xy, y },
                drag: *drag,
            }
        });
        Self { links: links.collect(), added_mass: file.model.added_mass }
    }

    fn flat(&self) -> Self {
        self.clone()
    }

    fn joints(&self) -> usize {
        Self::joints(self)
    }

    fn work(&self) -> Workspace {
        Workspace::new(self)
    }

    fn evaluate(
        &self,
        work: &mut Workspace,
        (_, head): (&Pose, Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Motion> {
        work.evaluate(head, joints, given)
    }

    #[inline(always)]
    fn recursion(
        &self,
        work: &mut Workspace,
        (_, head): (&Pose, Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Motion> {
        work.recursion(head, joints, given)
    }

    #[inline(always)]
    fn evaluated(work: &Workspace) -> Evaluated<'_, Motion> {
        Evaluated { motions: work.motions(), answer: &work.answer, loss_w: work.loss_w }
    }

    #[inline(always)]
    fn pose_rate([_, _, heading]: &Pose, [w, u, v]: Motion, current_m_s: [f64; 3]) -> Pose {
        let (s, c) = heading.sin_cos();
        [c * u - s * v + current_m_s[0], s * u + c * v + current_m_s[1], w]
    }

    fn pose([x, y, _]: [f64; 3], [_, _, heading]: [f64; 3]) -> Pose {
        [x, y, heading]
    }

    fn place_m([x, y, _]: &Pose) -> [f64; 3] {
        [*x, *y, 0.0]
    }

    fn angles([_, _, heading]: &Pose) -> [f64; 3] {
        [0.0, 0.0, *heading]
    }

    fn six([w, u, v]: &Motion) -> [f64; 6] {
        [0.0, 0.0, *w, *u, *v, 0.0]
    }

    fn level(motion: [f64; 3]) -> Motion {
        motion
    }

    fn centre_m(&self, [x, y, heading]: &Pose, angle: &[f64]) -> [f64; 3] {
        let [x, y] = Self::centre_m(self, [*x, *y], *heading, angle);
        [x, y, 0.0]
    }

    fn energy_j(&self, _: &Pose, _: &[f64], motions: &[Motion]) -> [f64; 2] {
        [Self::energy_j(self, motions), 0.0]
    }

    fn dragged(&self, link: usize, motion: Motion) -> Dragged {
        let link = &self.links[link];
        let load = link.drag.load(link.half_length_m, motion);
        let level = |[_, x, y]: [f64; 3]| [x, y, 0.0];
        Dragged { velocity_m_s: level(motion), force_n: level(load), power_w: -dot(load, motion) }
    }

    fn balance(&self) -> Option<Balance> {
        None
    }

    fn map<'a>(&'a self, course: &'a dyn Course, steps: usize) -> Option<Box<dyn Map + 'a>> {
        Some(Box::new(HeadMap::new(self, course, course.period_s(), steps)?))
    }
}
