//! Drag of one link by strips, across it in two directions.
//!
//! Each strip at x along the link has the speed (v + x r, w − x q) across it, s the size of it. With what the link resists to starboard, (c₁, c₂), and up or down, (e₁, e₂):
//!
//! | part | load | source |
//! | --- | --- | --- |
//! | across | ∫ −((c₁ + c₂ s) (v + x r), (e₁ + e₂ s) (w − x q)) dx/2l, at four Gauss points | cross-flow principle by components: Hoerner (1965), *Fluid-Dynamic Drag*, ch. 3 and 7; Faltinsen (1990), *Sea Loads*, ch. 7; Fossen (2021), 6.4 |
//! | along | −(c₁ u + c₂ u\|u\|) at the centre | the law of the plane |
//! | along, by flow across | −(x₁ s + x₂ s²) u/√(u² + ε²), s at the centre | the law of the plane, with v² + w² for v² |
//! | roll | −(k₁ p + k₂ p\|p\|) | declared |
//!
//! The size s carries both components: a link whose section is round has the drag of its direction, whichever that is. It is the form of Morison's drag for a slanted cylinder, with a
//! coefficient for each axis of the section where its axes differ; between the axes the force then turns towards the one that resists more. It takes power at every motion where no
//! coefficient is negative and there is no flow across that pushes along (x₁, x₂). In the plane, w = p = q = 0, it is [`crate::drag`] with `Strip`, digit by digit.
//!
//! **Range.** No measurement of a slanted elliptic section is behind it; what heave and roll resist is no part of the records of the plane.

use super::vector::{Load, Motion};
use crate::drag::{Cross, POINTS, WEIGHTS};

/// What a link's drag depends on; forces are those of the whole link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkDrag {
    /// Along it: of u, kg/s, and of u|u|, kg/m.
    pub along: [f64; 2],
    /// To starboard or port: of v, kg/s, and of s v, kg/m.
    pub sideways: [f64; 2],
    /// Up or down: of w, kg/s, and of s w, kg/m.
    pub upright: [f64; 2],
    /// Along it by flow across it; `None` for none.
    pub cross: Option<Cross>,
    /// Of p, N m s, and of p|p|, N m s².
    pub roll: [f64; 2],
}

impl LinkDrag {
    /// None.
    pub const NONE: Self = Self { along: [0.0; 2], sideways: [0.0; 2], upright: [0.0; 2], cross: None, roll: [0.0; 2] };

    /// Load of the water on a link that moves through it.
    #[must_use]
    pub fn load(&self, half_length_m: f64, [p, q, r, u, v, w]: Motion) -> Load {
        let law = |[linear, quadratic]: [f64; 2], speed: f64, size: f64| (linear + quadratic * size) * speed;
        let size = |v: f64, w: f64| (v * v + w * w).sqrt();
        let along = self.cross.map_or(0.0, |cross| cross.force(u, size(v, w))) - law(self.along, u, u.abs());
        let (mut force, mut moment) = ([0.0; 2], [0.0; 2]);
        for (point, weight) in POINTS.iter().zip(WEIGHTS) {
            let x = half_length_m * point;
            let (v, w) = (v + x * r, w - x * q);
            let s = size(v, w);
            let strip = [weight * law(self.sideways, v, s), weight * law(self.upright, w, s)];
            for k in 0..2 {
                force[k] -= strip[k];
                moment[k] -= x * strip[k];
            }
        }
        // (x, 0, 0) × (0, Y, Z) = (0, −x Z, x Y).
        [-law(self.roll, p, p.abs()), -moment[1], moment[0], along, force[0], force[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::Turning;

    fn drag() -> LinkDrag {
        LinkDrag {
            along: [0.1, 0.4],
            sideways: [0.2, 15.0],
            upright: [0.1, 7.0],
            cross: Some(Cross { of_speed: [0.02, 0.3], smooth_m_s: 1e-2 }),
            roll: [1e-3, 2e-3],
        }
    }

    /// The sums run in another order: they round apart by a few units.
    #[test]
    fn in_the_plane_it_is_the_law_of_the_plane() {
        let d = drag();
        let plane =
            crate::drag::LinkDrag { along: d.along, across: d.sideways, cross: d.cross, turning: Turning::Strip };
        for [r, u, v] in [[0.7, 0.2, -0.1], [-2.0, -0.3, 0.05], [0.0, 0.0, 0.4]] {
            let [moment, along, across] = plane.load(0.09, [r, u, v]);
            let found = d.load(0.09, [0.0, 0.0, r, u, v, 0.0]);
            for (a, b) in found.into_iter().zip([0.0, 0.0, moment, along, across, 0.0]) {
                assert!((a - b).abs() <= 4.0 * f64::EPSILON * b.abs().max(0.1), "{found:?}");
            }
        }
    }

    /// A round section that rolls by 0.6 rad feels the same force, turned by as much.
    #[test]
    fn a_round_section_has_no_preferred_direction() {
        let round = LinkDrag { upright: drag().sideways, cross: None, roll: [0.0; 2], ..drag() };
        let (s, c) = 0.6_f64.sin_cos();
        let turn = |[a, b]: [f64; 2]| [c * a - s * b, s * a + c * b];
        let [_, q, r, u, v, w] = [0.0, 0.4, -0.9, 0.2, 0.3, -0.1];
        let ([q2, r2], [v2, w2]) = (turn([q, r]), turn([v, w]));
        let (f, g) = (round.load(0.09, [0.0, q, r, u, v, w]), round.load(0.09, [0.0, q2, r2, u, v2, w2]));
        let (moment, force) = (turn([f[1], f[2]]), turn([f[4], f[5]]));
        for (a, b) in [moment[0], moment[1], force[0], force[1]].into_iter().zip([g[1], g[2], g[4], g[5]]) {
            assert!((a - b).abs() < 1e-14, "{f:?} {g:?}");
        }
    }

    /// A link that pitches feels what a link that yaws feels, with the coefficients of the other direction.
    #[test]
    fn it_resists_pitch_as_it_resists_yaw() {
        let swapped = LinkDrag { sideways: drag().upright, upright: drag().sideways, ..drag() };
        let yaw = drag().load(0.09, [0.0, 0.0, 0.8, 0.0, 0.2, 0.0]);
        let pitch = swapped.load(0.09, [0.0, 0.8, 0.0, 0.0, 0.0, -0.2]);
        assert!((yaw[2] - pitch[1]).abs() < 1e-15 && (yaw[4] + pitch[5]).abs() < 1e-15, "{yaw:?} {pitch:?}");
    }
}
