//! A chain of links in three dimensions: inertia, weight and buoyancy of each, and the joints between them.
//!
//! **Frame.** Link axes at the link's centre ([`super::vector`]). Link 1 is the head; the front joint of a link lies half a length ahead of its centre, the other as far behind. φ_i is the yaw, or the
//! pitch, of link i less that of link i + 1, as in the plane.
//! **Units.** SI.
//!
//! The load of the fluid's inertia is Kirchhoff's, −(A ṁ + m ×* A m): Lamb (1932), §124. Weight acts at the centre of mass and buoyancy at that of the displaced water.

use super::drag::LinkDrag;
use super::vector::{Axis, Inertia, Load, Motion, Turn, cross, joined, turned};

/// One link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Half of the distance between its joints, m.
    pub half_length_m: f64,
    /// Of the body.
    pub rigid: Inertia,
    /// Of the water that it takes along.
    pub added: Inertia,
    /// Its drag.
    pub drag: LinkDrag,
    /// m g, N.
    pub weight_n: f64,
    /// Where it acts, m.
    pub centre_of_mass_m: [f64; 3],
    /// ρ V g, N.
    pub buoyancy_n: f64,
    /// Where it acts, m.
    pub centre_of_buoyancy_m: [f64; 3],
}

/// A swimmer.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// From head to tail; one at least.
    pub links: Vec<Link>,
    /// What the joints turn about, from the head; one less than links.
    pub joints: Vec<Axis>,
}

/// Where a link lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Its centre, m.
    pub place_m: [f64; 3],
    /// Rows: x, y, z of the tank by vectors of the link.
    pub world_from_link: [[f64; 3]; 3],
}

impl Link {
    /// Of body and water.
    #[must_use]
    pub fn inertia(&self) -> Inertia {
        self.rigid.plus(&self.added)
    }

    /// Load of weight and buoyancy, with where down is in its own axes.
    #[must_use]
    pub fn hydrostatic(&self, down: [f64; 3]) -> Load {
        let weight = down.map(|d| self.weight_n * d);
        let buoyancy = down.map(|d| -self.buoyancy_n * d);
        let (a, b) = (cross(self.centre_of_mass_m, weight), cross(self.centre_of_buoyancy_m, buoyancy));
        joined([std::array::from_fn(|k| a[k] + b[k]), std::array::from_fn(|k| weight[k] + buoyancy[k])])
    }

    /// p of I ṁ + p = what the joints put on it: momenta that turn with the axes, less drag, weight and buoyancy.
    #[must_use]
    pub fn bias(&self, inertia: &Inertia, motion: Motion, down: [f64; 3]) -> Load {
        let momenta = turned(motion, inertia.times(motion));
        let (drag, static_) = (self.drag.load(self.half_length_m, motion), self.hydrostatic(down));
        std::array::from_fn(|k| momenta[k] - drag[k] - static_[k])
    }

    /// Potential energy of weight and buoyancy, J, against a centre at the origin of the tank's z.
    #[must_use]
    pub fn potential_j(&self, pose: &Pose) -> f64 {
        let depth = |at: [f64; 3]| {
            let [x, y, z] = pose.world_from_link[2];
            pose.place_m[2] + x * at[0] + y * at[1] + z * at[2]
        };
        self.buoyancy_n * depth(self.centre_of_buoyancy_m) - self.weight_n * depth(self.centre_of_mass_m)
    }
}

impl Chain {
    /// Where the links lie, of a head at a place, m, and joints at these angles.
    pub fn poses(&self, head: Pose, angle: &[f64]) -> impl Iterator<Item = Pose> {
        let (mut pose, mut before) = (head, 0.0);
        self.links.iter().enumerate().map(move |(i, link)| {
            if i > 0 {
                let turn = Turn::new(self.joints[i - 1], angle[i - 1]);
                let to_joint = pose.world_from_link.map(|row| -before * row[0]);
                let world_from_link = pose.world_from_link.map(|row| turn.behind(row));
                pose = Pose {
                    place_m: std::array::from_fn(|k| {
                        pose.place_m[k] + to_joint[k] - link.half_length_m * world_from_link[k][0]
                    }),
                    world_from_link,
                };
            }
            before = link.half_length_m;
            pose
        })
    }

    /// Kinetic energy of body and water, J.
    #[must_use]
    pub fn kinetic_j(&self, motions: &[Motion]) -> f64 {
        self.links.iter().zip(motions).map(|(link, m)| link.inertia().energy(*m)).sum()
    }

    /// Potential energy of weight and buoyancy, J.
    #[must_use]
    pub fn potential_j(&self, head: Pose, angle: &[f64]) -> f64 {
        self.links.iter().zip(self.poses(head, angle)).map(|(link, pose)| link.potential_j(&pose)).sum()
    }

    /// Centre of mass, m.
    #[must_use]
    pub fn centre_m(&self, head: Pose, angle: &[f64]) -> [f64; 3] {
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for (link, pose) in self.links.iter().zip(self.poses(head, angle)) {
            let mass = link.rigid.0[3][3];
            let at = super::attitude::to_world(&pose.world_from_link, link.centre_of_mass_m);
            for k in 0..3 {
                sum[k] += mass * (pose.place_m[k] + at[k]);
            }
            all += mass;
        }
        sum.map(|x| x / all)
    }

    /// How far the mass lies ahead of and below the buoyancy of the straight, level chain, by weight, m.
    #[must_use]
    pub fn apart_m(&self) -> [f64; 2] {
        // Of weight and of buoyancy: their sum, with their moments along x and z.
        let mut sums = [[0.0; 3]; 2];
        let mut centre = 0.0;
        for (i, link) in self.links.iter().enumerate() {
            if i > 0 {
                centre -= self.links[i - 1].half_length_m + link.half_length_m;
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
}
