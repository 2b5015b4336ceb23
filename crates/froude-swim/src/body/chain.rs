//! A chain of links in water: what each weighs, takes along and drags.
//!
//! **Frame.** Link axes at the link's centre ([`crate::planar`]). Link 1 is the head, and φ_i = θ_i − θ_{i+1}.
//! **Units.** SI.
//!
//! The fluid's inertia belongs to the motion through the water. Two forms of its load are offered:
//!
//! | form | load of the fluid on a link | source |
//! | --- | --- | --- |
//! | `Full` | −(A ṁ + m ×* A m) | Kirchhoff's equations, Lamb (1932), §124 |
//! | `Usr`  | −A ṁ, which leaves out f_x = μ ω v and the Munk moment −μ u v | USR eq. 4 |
//!
//! `Full` conserves energy and both momenta of body and fluid, `Usr` the energy only.

use crate::drag::LinkDrag;
use crate::planar::{Inertia, Motion};

/// Load of the fluid's inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AddedMass {
    /// With the pair that turning axes make.
    #[default]
    Full,
    /// As the paper prints it.
    Usr,
}

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
}

/// A swimmer.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// From head to tail; one at least.
    pub links: Vec<Link>,
    /// Load of the fluid's inertia.
    pub added_mass: AddedMass,
}

impl Chain {
    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.links.len().saturating_sub(1)
    }

    /// Its length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.links.iter().map(|link| 2.0 * link.half_length_m).sum()
    }

    /// A link length in a period, by which motions are measured: as a turn rate, rad/s, of the chain's length, and as a speed, m/s.
    #[must_use]
    pub fn per_period(&self, period_s: f64) -> [f64; 2] {
        let length = self.length_m();
        let speed = length / self.links.len() as f64 / period_s;
        [speed / length, speed]
    }

    /// Centres and headings of the links, of a head at a place, m, with a heading, rad, and joints at these angles.
    pub fn places(&self, place_m: [f64; 2], heading: f64, angle: &[f64]) -> impl Iterator<Item = ([f64; 2], f64)> {
        let (mut place, mut heading, mut before) = (place_m, heading, 0.0);
        self.links.iter().enumerate().map(move |(i, link)| {
            if i > 0 {
                let (s, c) = heading.sin_cos();
                place = [place[0] - before * c, place[1] - before * s];
                heading -= angle[i - 1];
                let (s, c) = heading.sin_cos();
                place = [place[0] - link.half_length_m * c, place[1] - link.half_length_m * s];
            }
            before = link.half_length_m;
            (place, heading)
        })
    }

    /// Centre of mass of the body with such a head and such angles, m.
    #[must_use]
    pub fn centre_m(&self, place_m: [f64; 2], heading: f64, angle: &[f64]) -> [f64; 2] {
        let (mut sum, mut mass) = ([0.0; 2], 0.0);
        for (link, (place, heading)) in self.links.iter().zip(self.places(place_m, heading, angle)) {
            let (s, c) = heading.sin_cos();
            let (m, ahead) = (link.rigid.x, link.rigid.turn_y);
            sum = [sum[0] + m * place[0] + ahead * c, sum[1] + m * place[1] + ahead * s];
            mass += m;
        }
        sum.map(|x| x / mass)
    }

    /// Kinetic energy of body and water, J.
    #[must_use]
    pub fn energy_j(&self, motions: &[Motion]) -> f64 {
        self.links.iter().zip(motions).map(|(link, m)| link.inertia().energy(*m)).sum()
    }
}

impl Link {
    /// Of body and water.
    #[must_use]
    #[inline(always)]
    pub fn inertia(&self) -> Inertia {
        self.rigid.plus(&self.added)
    }
}
