//! How much of the tank a body takes at the angle of a run, and how far it is from the walls.
//!
//! A chain of links at an angle θ to its motion shows S |sin θ| + π a b |cos θ| to the stream, S its side area, and spans (S/2a) |sin θ| + 2b |cos θ| of the tank's
//! width, in whose middle it is towed. Flow between it and the walls is faster than in unbounded water by about the part that it blocks, and its drag larger by twice
//! that and more.
//!
//! **Units.** m, m², rad.
//!
//! # Source
//!
//! Areas: USR eq. 14 and [`froude_hydro::geometry`]. The limit is that of [`froude_identify::validity`].

use froude_hydro::geometry::Body;
use froude_hydro::similarity::blockage;
use froude_identify::validity::BLOCKAGE_LIMIT;
use froude_records::campaign::Campaign;
use froude_records::finding::Finding;
use froude_records::table::links_of_configuration;

use super::row::Row;
use crate::findings::warning;

/// Body and section of the tank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walls {
    /// The chain of links.
    pub body: Body,
    /// Of the water, m.
    pub width_m: f64,
    /// Of the water, m.
    pub depth_m: f64,
}

impl Walls {
    /// Of a campaign that declares them; `None` where it declares no width and depth, or no links.
    #[must_use]
    pub fn of(campaign: &Campaign) -> Option<Self> {
        let (tank, body) = (campaign.tank.as_ref()?, campaign.body.as_ref()?);
        let body = Body {
            link: body.link?,
            head_side_area_m2: body.head_side_area_m2.unwrap_or(0.0),
            tail_side_area_m2: body.tail_side_area_m2.unwrap_or(0.0),
        };
        Some(Self { body, width_m: tank.width_m?, depth_m: tank.depth_m? })
    }

    /// Part of the section that the body blocks.
    #[must_use]
    pub fn blocked(&self, n_links: f64, angle_rad: f64) -> f64 {
        let (sin, cos) = angle_rad.sin_cos();
        let area = self.body.side_area_m2(n_links) * sin.abs() + self.body.link.section_area_m2() * cos.abs();
        blockage(area, self.width_m * self.depth_m)
    }

    /// From the body's end to either wall, m; below zero where it does not fit.
    #[must_use]
    pub fn clearance_m(&self, n_links: f64, angle_rad: f64) -> f64 {
        let (sin, cos) = angle_rad.sin_cos();
        let link = self.body.link;
        let length_m = self.body.side_area_m2(n_links) / (2.0 * link.major_semi_axis_m);
        0.5 * (self.width_m - length_m * sin.abs() - 2.0 * link.minor_semi_axis_m * cos.abs())
    }

    /// The angle, rad, beyond which more than a part is blocked; `None` where none is, zero where all are.
    #[must_use]
    pub fn angle_of(&self, n_links: f64, part: f64) -> Option<f64> {
        let (side, section) = (self.body.side_area_m2(n_links), self.body.link.section_area_m2());
        let ratio = part * self.width_m * self.depth_m / side.hypot(section);
        (ratio < 1.0).then(|| (ratio.asin() - section.atan2(side)).max(0.0))
    }

    /// What is said of an observation that blocks more than the limit.
    #[must_use]
    pub fn finding(&self, row: &Row) -> Option<Finding> {
        let n_links = f64::from(links_of_configuration(&row.configuration)?);
        let (blocked, clearance_m) = (self.blocked(n_links, row.angle_rad), self.clearance_m(n_links, row.angle_rad));
        let limit = self.angle_of(n_links, BLOCKAGE_LIMIT)?.to_degrees();
        (blocked > BLOCKAGE_LIMIT).then(|| {
            let text = format!(
                "run {:?}: {} at {:.1} deg blocks {:.1} % of the tank's {} m by {} m and ends {clearance_m:.2} m from its walls; it passes {:.0} % beyond {limit:.1} deg, where the \
                 drag is no longer that of unbounded water: leave such runs out with keep, or state the drag as that of this tank",
                row.run,
                row.configuration,
                row.angle_rad.to_degrees(),
                100.0 * blocked,
                self.width_m,
                self.depth_m,
                100.0 * BLOCKAGE_LIMIT
            );
            warning("blockage-of-run", text)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_hydro::geometry::Link;

    /// Side area of H1LT 0.019 + 0.18 · 0.1176 = 0.040168 m² and section π · 0.0588 · 0.0394 = 0.0072782 m² in a tank of 1 m by 0.6 m.
    const WALLS: Walls = Walls {
        body: Body {
            link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
            head_side_area_m2: 0.011,
            tail_side_area_m2: 0.008,
        },
        width_m: 1.0,
        depth_m: 0.6,
    };

    #[test]
    fn what_a_body_blocks_is_its_areas_at_the_angle() {
        let right = std::f64::consts::FRAC_PI_2;
        assert!((WALLS.blocked(1.0, right) - 0.040168 / 0.6).abs() < 1e-12);
        assert!((WALLS.blocked(1.0, 0.0) - 0.0072782 / 0.6).abs() < 1e-6);
        assert!((WALLS.blocked(1.0, -0.4) - WALLS.blocked(1.0, 0.4)).abs() < 1e-15);
        // 0.040168/0.1176 = 0.34156 m long across, 0.0788 m wide ahead.
        assert!((WALLS.clearance_m(1.0, right) - 0.5 * (1.0 - 0.34156)).abs() < 1e-5);
        assert!((WALLS.clearance_m(1.0, 0.0) - 0.5 * (1.0 - 0.0788)).abs() < 1e-12);
        let limit = WALLS.angle_of(1.0, 0.05).unwrap();
        assert!((WALLS.blocked(1.0, limit) - 0.05).abs() < 1e-12 && limit > 0.0);
        assert_eq!(Walls { width_m: 10.0, ..WALLS }.angle_of(1.0, 0.05), None);
        assert_eq!(Walls { width_m: 0.1, ..WALLS }.angle_of(1.0, 0.05), Some(0.0));
    }
}
