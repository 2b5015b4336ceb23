//! Drag of one link.
//!
//! Along the link −(c₁ u + c₂ u|u|), and what flow across it does along it, −(x₁ |v| + x₂ v²) u/√(u² + ε²), which resists where the bracket is positive, both at its centre. Across it
//! −(c₁ v + c₂ v|v|). Either by strips, whose speed w = v + xω differs along the link, or at the centre with a torque of turning:
//!
//! | form | load across and moment | source |
//! | --- | --- | --- |
//! | `Strip` | ∫ −(c₁ w + c₂ w\|w\|) (1, x) dx/2l, w = v + xω, at four Gauss points | cross-flow principle, our derivation |
//! | `Lumped` | −(c₁ v + c₂ v\|v\|), −(λ₂ ω + λ₃ ω\|ω\|) | USR eq. 6 and 7 |
//!
//! A strip contains the torque: both together would count it twice. Where w changes its sign within the link, four points are off by at most 2 % of the moment of a
//! link that turns about its centre. The papers print what v does along the link for u ≥ 0 only (eq. 12 and 13); a bare sign would jump where a link lies broadside, hence ε.

use crate::planar::{Load, Motion};

/// What a link's drag depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkDrag {
    /// Along it: of u, kg/s, and of u|u|, kg/m.
    pub along: [f64; 2],
    /// Across it, of the whole link: of v, kg/s, and of v|v|, kg/m.
    pub across: [f64; 2],
    /// Along it by flow across it; `None` for none.
    pub cross: Option<Cross>,
    /// How it turns.
    pub turning: Turning,
}

/// Force along a link by flow across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cross {
    /// Of |v|, kg/s, and of v², kg/m, against the motion.
    pub of_speed: [f64; 2],
    /// ε, m/s, above zero.
    pub smooth_m_s: f64,
}

/// Where the drag across acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turning {
    /// Along the link.
    Strip,
    /// At its centre, with a torque: of ω, N m s, and of ω|ω|, N m s².
    Lumped([f64; 2]),
}

/// Gauss's points on −1 to 1 …
pub(crate) const POINTS: [f64; 4] =
    [-0.861_136_311_594_052_6, -0.339_981_043_584_856_26, 0.339_981_043_584_856_26, 0.861_136_311_594_052_6];
/// … and half of their weights.
pub(crate) const WEIGHTS: [f64; 4] =
    [0.173_927_422_568_726_93, 0.326_072_577_431_273_07, 0.326_072_577_431_273_07, 0.173_927_422_568_726_93];

impl LinkDrag {
    /// None.
    pub const NONE: Self = Self { along: [0.0; 2], across: [0.0; 2], cross: None, turning: Turning::Strip };

    /// Load of the water on a link that moves through it.
    #[must_use]
    #[inline(always)]
    pub fn load(&self, half_length_m: f64, [w, u, v]: Motion) -> Load {
        let x = self.cross.map_or(0.0, |cross| cross.force(u, v)) - law(self.along, u);
        match self.turning {
            Turning::Lumped(torque) => [-law(torque, w), x, -law(self.across, v)],
            Turning::Strip => {
                let at = POINTS.map(|point| half_length_m * point);
                let strips: [f64; 4] = std::array::from_fn(|k| WEIGHTS[k] * law(self.across, v + at[k] * w));
                let moment = (at[0] * strips[0] + at[1] * strips[1]) + (at[2] * strips[2] + at[3] * strips[3]);
                [-moment, x, -((strips[0] + strips[1]) + (strips[2] + strips[3]))]
            }
        }
    }

    /// Power that still water gives a link that moves without turning, W; drag keeps it below zero.
    #[must_use]
    pub fn power_w(&self, [u, v]: [f64; 2]) -> f64 {
        let along = self.cross.map_or(0.0, |cross| cross.force(u, v)) - law(self.along, u);
        along * u - law(self.across, v) * v
    }
}

impl Cross {
    #[inline(always)]
    pub(crate) fn force(&self, u: f64, v: f64) -> f64 {
        -(self.of_speed[0] + self.of_speed[1] * v.abs()) * v.abs() * u / u.hypot(self.smooth_m_s)
    }
}

#[inline(always)]
fn law([linear, quadratic]: [f64; 2], speed: f64) -> f64 {
    (linear + quadratic * speed.abs()) * speed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A link that turns about its centre: ∫ c₂ xω|xω| x dx/2l = c₂ ω|ω| l³/4, and c₁ l²/3.
    #[test]
    fn a_turning_strip_has_the_integrals_of_its_law() {
        let drag = LinkDrag { along: [0.0; 2], across: [3.0, 7.0], cross: None, turning: Turning::Strip };
        let [moment, _, force] = drag.load(0.09, [2.0, 0.0, 0.0]);
        let linear = -3.0 * 2.0 * 0.09_f64.powi(2) / 3.0;
        let quadratic = -7.0 * 4.0 * 0.09_f64.powi(3) / 4.0;
        // Four points are exact for x²; |x|³ has a corner of its third derivative.
        assert!(((moment - linear) / quadratic - 1.0).abs() < 0.02, "{}", (moment - linear) / quadratic);
        assert!(force.abs() < 1e-15);
    }

    #[test]
    fn a_strip_that_moves_across_is_the_lumped_one() {
        let strip = LinkDrag { along: [1.0, 2.0], across: [3.0, 7.0], cross: None, turning: Turning::Strip };
        let lumped = LinkDrag { turning: Turning::Lumped([0.0; 2]), ..strip };
        let (a, b) = (strip.load(0.09, [0.0, 0.3, -0.2]), lumped.load(0.09, [0.0, 0.3, -0.2]));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
