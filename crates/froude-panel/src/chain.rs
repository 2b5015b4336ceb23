//! Chains: the matrix of all links of a modular robot, straight or bent.
//!
//! Joint angles are about z, positive to the left seen along the robot. Between joints the centre line is straight; at a joint it is an arc of
//! a circle whose tangents meet in the joint, so that joints keep their distances. Sections stay square to the centre line. The arc takes the
//! neck; in a smooth chain, which has none, it reaches one half-width to each side of the joint. The neck's centre line, 2b long when straight, is
//! 2b (θ/2)/tan(θ/2) when bent: 2.3 % shorter at θ = 30°.
//!
//! **Frames.** Part 0 is the tail's end, parts 1 to k the links, part k + 1 the head; each has its point half-way between its joints (an end:
//! between joint and tip), x along it towards the head, z that of the mesh. The tail's end lies as in the straight robot.

use froude_mesh::panel::facets;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::{PartMesh, Resolution, SectionError};
use froude_mesh::vector::{Vec3, add, scale, sub};

use crate::frame::Frame;
use crate::matrix::AddedMass;
use crate::mirror::{Across, Mirror, positive_part};
use crate::problem::{Problem, Solution};

/// A chain, bent.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Its panels and whose they are.
    pub surface: PartMesh,
    /// Frame of each part.
    pub frames: Vec<Frame>,
}

/// Why a chain cannot be bent so.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// An angle for each joint.
    #[error("{found} joint angles for {links} links, which have {} joints", links + 1)]
    Angles {
        /// Links.
        links: usize,
        /// Angles.
        found: usize,
    },
    /// On the inner side of the bend the sections run into each other.
    #[error(
        "joint {joint} bends by {:.1} degrees: its arc has a radius of {radius_m:.4} m and the body there a half-width of \
         {half_width_m:.4} m; the largest angle is {:.1} degrees",
        angle_rad.to_degrees(), largest_rad.to_degrees()
    )]
    Folds {
        /// The joint, from 0 at the tail.
        joint: usize,
        /// Its angle.
        angle_rad: f64,
        /// Radius of the arc, m.
        radius_m: f64,
        /// Half-width in the arc, m.
        half_width_m: f64,
        /// Angle at which both are equal.
        largest_rad: f64,
    },
    /// No mesh of the straight robot.
    #[error(transparent)]
    Sections(#[from] SectionError),
}

impl Chain {
    /// Of a robot with `links` links, `angles_rad` at its `links + 1` joints from the tail on, in cells of about `cell_m` at the coarsest.
    ///
    /// # Errors
    ///
    /// [`ChainError`] for another number of angles, or one that folds the surface.
    pub fn new(
        robot: &Robot,
        links: usize,
        angles_rad: &[f64],
        cell_m: f64,
        resolution: Resolution,
    ) -> Result<Self, ChainError> {
        if angles_rad.len() != links + 1 {
            return Err(ChainError::Angles { links, found: angles_rad.len() });
        }
        let straight = sections(robot, links, cell_m).mesh(resolution)?;
        let line = CentreLine::new(robot, links, angles_rad);
        for (joint, &angle_rad) in angles_rad.iter().enumerate() {
            let inside = |x: f64| (x - line.joints_m[joint]).abs() <= line.reach_m + 1e-12;
            let half_width_m =
                straight.mesh.vertices.iter().filter(|v| inside(v[0])).map(|v| v[1].abs()).fold(0.0, f64::max);
            let radius_m = line.reach_m / (0.5 * angle_rad.abs()).tan();
            if angle_rad.abs() >= core::f64::consts::PI || radius_m <= half_width_m {
                let largest_rad = 2.0 * (line.reach_m / half_width_m).atan();
                return Err(ChainError::Folds { joint, angle_rad, radius_m, half_width_m, largest_rad });
            }
        }
        let mesh = straight.mesh.mapped(|v| line.place(v));
        Ok(Self { surface: PartMesh { mesh, parts: straight.parts }, frames: line.frames() })
    }

    /// The problem of all its parts; with its own plane z = 0 half of the panels.
    ///
    /// # Errors
    ///
    /// [`Across`] when panels lie across the plane.
    pub fn problem(&self, is_halved: bool) -> Result<Problem, Across> {
        let PartMesh { mesh, parts } = &self.surface;
        if !is_halved {
            return Ok(Problem::of_parts(mesh, parts, &self.frames, &[]));
        }
        let plane = [Mirror::body(2)];
        let half = positive_part(mesh, &plane)?;
        let parts: Vec<usize> =
            facets(mesh).iter().zip(parts).filter(|(f, _)| f.centroid[2] > 0.0).map(|(_, p)| *p).collect();
        Ok(Problem::of_parts(&half, &parts, &self.frames, &plane))
    }
}

/// Where sections go.
struct CentreLine {
    joints_m: Vec<f64>,
    /// Half of what bends at a joint.
    reach_m: f64,
    /// Middles of the straight parts along x, before bending.
    middles_m: Vec<f64>,
    /// Where the joints are, and each part's direction.
    pivots: Vec<Vec3>,
    headings: Vec<f64>,
    angles: Vec<f64>,
}

fn along(heading: f64) -> Vec3 {
    [heading.cos(), heading.sin(), 0.0]
}

fn beside(heading: f64) -> Vec3 {
    [-heading.sin(), heading.cos(), 0.0]
}

impl CentreLine {
    fn new(robot: &Robot, links: usize, angles: &[f64]) -> Self {
        let tip_m = 0.5 * robot.length_m(links);
        let reach_m = if robot.neck.is_some() { 0.5 * robot.neck_length_m() } else { robot.link.minor_semi_axis_m };
        let joints_m: Vec<f64> = (0..=links)
            .map(|j| -tip_m + robot.end_m + 0.5 * robot.neck_length_m() + robot.pitch_m() * j as f64)
            .collect();
        let bounds: Vec<f64> = [-tip_m].into_iter().chain(joints_m.iter().copied()).chain([tip_m]).collect();
        let middles_m = bounds.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let mut headings = vec![0.0];
        for angle in angles {
            headings.push(headings[headings.len() - 1] + angle);
        }
        let mut pivots = vec![[joints_m[0], 0.0, 0.0]];
        for heading in &headings[1..=links] {
            pivots.push(add(pivots[pivots.len() - 1], scale(along(*heading), robot.pitch_m())));
        }
        Self { joints_m, reach_m, middles_m, pivots, headings, angles: angles.to_vec() }
    }

    /// A point of the straight robot, bent.
    fn place(&self, [x, y, z]: Vec3) -> Vec3 {
        let lifted = |p: Vec3| [p[0], p[1], p[2] + z];
        for (j, (&joint, &angle)) in self.joints_m.iter().zip(&self.angles).enumerate() {
            let offset = x - joint;
            if offset.abs() > self.reach_m || angle == 0.0 {
                continue;
            }
            // Tangents of length b from the joint touch the circle of radius b/tan(θ/2).
            let radius = self.reach_m / (0.5 * angle).tan();
            let start = sub(self.pivots[j], scale(along(self.headings[j]), self.reach_m));
            let centre = add(start, scale(beside(self.headings[j]), radius));
            let turned = self.headings[j] + angle * (0.5 + 0.5 * offset / self.reach_m);
            return lifted(sub(centre, scale(beside(turned), radius - y)));
        }
        let part = self.joints_m.iter().filter(|j| x > **j).count();
        let nearest = part.saturating_sub(1);
        let heading = self.headings[part];
        let on_line = add(self.pivots[nearest], scale(along(heading), x - self.joints_m[nearest]));
        lifted(add(on_line, scale(beside(heading), y)))
    }

    fn frames(&self) -> Vec<Frame> {
        let of = |(&heading, &middle): (&f64, &f64)| {
            let part = self.joints_m.iter().filter(|j| middle > **j).count();
            let nearest = part.saturating_sub(1);
            let origin_m = add(self.pivots[nearest], scale(along(heading), middle - self.joints_m[nearest]));
            Frame { origin_m, axes: [along(heading), beside(heading), [0.0, 0.0, 1.0]] }
        };
        self.headings.iter().zip(&self.middles_m).map(of).collect()
    }
}

/// The matrix of all parts moving as one rigid body with a frame: Σ T_iᵀ A_ij T_j, T_i from the motion of the body to that of part i.
#[must_use]
pub fn whole(solution: &Solution, body: &Frame) -> AddedMass {
    let transforms: Vec<[[f64; 6]; 6]> = solution.frames.iter().map(|f| f.motions_from(body)).collect();
    let mut raw = [[0.0; 6]; 6];
    for (p, row) in solution.matrix.iter().enumerate() {
        for (q, a) in row.iter().enumerate() {
            let (left, right) = (&transforms[p / 6][p % 6], &transforms[q / 6][q % 6]);
            for i in 0..6 {
                for j in 0..6 {
                    raw[i][j] += left[i] * a * right[j];
                }
            }
        }
    }
    AddedMass::of(raw, *body)
}

/// Error of a diagonal matrix with one lateral coefficient, for a pattern of lateral accelerations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatternError {
    /// Largest error of a link's force, over the root mean square of the true forces.
    pub largest: f64,
    /// Root mean square of the errors, over that.
    pub rms: f64,
}

/// How far a chain is from "every link its added mass across itself, and no coupling" (equation 4 of the paper).
///
/// For H3LT, necked or smooth, with a joint bent by up to 30 degrees: root mean square errors of 2 to 3 % for parts alike, 16 to 19 % for a wave
/// over the body, 53 to 61 % for neighbours against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagonalForm {
    /// The one coefficient over ρ, m³: mean force on a link when all parts accelerate alike.
    pub per_link_m3: f64,
    /// All parts alike.
    pub alike: PatternError,
    /// Neighbours against each other.
    pub alternating: PatternError,
    /// A wave of one length over all parts that travels along them: two phases a quarter apart.
    pub travelling: PatternError,
}

/// Compares lateral forces on the links (not on the ends, which move with the pattern) with those of the diagonal form.
#[must_use]
pub fn diagonal_form(solution: &Solution) -> DiagonalForm {
    let parts = solution.frames.len();
    let links = 1..parts - 1;
    let force = |pattern: &[f64]| -> Vec<f64> {
        let of = |i: usize| (0..parts).map(|j| solution.matrix[6 * i + 1][6 * j + 1] * pattern[j]).sum();
        links.clone().map(of).collect()
    };
    let ones = vec![1.0; parts];
    let per_link_m3 = force(&ones).iter().sum::<f64>() / links.len() as f64;
    let error = |patterns: &[Vec<f64>]| {
        let (mut square, mut true_square, mut largest, mut count) = (0.0, 0.0, 0.0_f64, 0);
        for pattern in patterns {
            for (f, a) in force(pattern).iter().zip(&pattern[1..]) {
                let e = per_link_m3 * a - f;
                square += e * e;
                true_square += f * f;
                largest = largest.max(e.abs());
                count += 1;
            }
        }
        let size = (true_square / f64::from(count)).sqrt();
        PatternError { largest: largest / size, rms: (square / f64::from(count)).sqrt() / size }
    };
    let alternating: Vec<f64> = (0..parts).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let wave = |phase: f64| -> Vec<f64> {
        (0..parts).map(|i| (2.0 * core::f64::consts::PI * i as f64 / parts as f64 + phase).sin()).collect()
    };
    DiagonalForm {
        per_link_m3,
        alike: error(&[ones]),
        alternating: error(&[alternating]),
        travelling: error(&[wave(0.0), wave(0.5 * core::f64::consts::PI)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_mesh::measure::Measure;
    use froude_mesh::vector::dot;

    const RESOLUTION: Resolution = Resolution { along: 1, around: 8 };

    #[test]
    fn a_straight_chain_is_the_robot_and_a_bent_one_keeps_its_joints() {
        let robot = Robot::NECKED_MAMBA;
        let straight = Chain::new(&robot, 3, &[0.0; 4], 0.03, RESOLUTION).unwrap();
        let body = sections(&robot, 3, 0.03).mesh(RESOLUTION).unwrap();
        for (a, b) in straight.surface.mesh.vertices.iter().zip(&body.mesh.vertices) {
            assert!(dot(sub(*a, *b), sub(*a, *b)) < 1e-28);
        }
        let bent = Chain::new(&robot, 3, &[0.3, -0.5, 0.2, 0.1], 0.03, RESOLUTION).unwrap();
        let volume = |c: &Chain| Measure::of(&c.surface.mesh).volume_m3;
        // Only necks lose length: the arc is shorter than its tangents.
        assert!((volume(&bent) / volume(&straight) - 1.0).abs() < 0.005);
        for w in bent.frames[1..=3].windows(2) {
            let [a, b] = [&w[0], &w[1]];
            let joint = add(a.origin_m, scale(a.axes[0], 0.09));
            let other = sub(b.origin_m, scale(b.axes[0], 0.09));
            assert!(dot(sub(joint, other), sub(joint, other)) < 1e-28);
        }
    }

    #[test]
    fn an_angle_that_folds_the_surface_is_refused_with_the_largest() {
        let why = Chain::new(&Robot::SMOOTH_MAMBA, 2, &[0.0, 1.7, 0.0], 0.03, RESOLUTION).unwrap_err();
        assert_eq!(
            why.to_string(),
            "joint 1 bends by 97.4 degrees: its arc has a radius of 0.0327 m and the body there a half-width of 0.0372 m; the largest \
             angle is 90.0 degrees"
        );
        assert!(matches!(
            Chain::new(&Robot::SMOOTH_MAMBA, 2, &[0.0; 2], 0.03, RESOLUTION),
            Err(ChainError::Angles { links: 2, found: 2 })
        ));
    }
}
