//! The modules of a snake robot and the areas that their drag refers to.
//!
//! **Setting.** A chain head + `k` links + tail (`HkLT`), so `n = k + 2` modules.
//! A link is an elliptic cylinder: semi-axis `a` vertical (along `z`), semi-axis
//! `b` lateral, length `2l` along `x`.
//! **Units.** m, m², m³.
//!
//! | quantity                   | formula              | source        |
//! |----------------------------|----------------------|---------------|
//! | side area of a link        | `2a · 2l`            | USR eq. 8     |
//! | section area               | `πab`                | USR eq. 14    |
//! | half the wetted area       | `π ½(a+b) · 2l`      | USR eq. 8     |
//! | volume of a link           | `πab · 2l`           | elliptic cylinder |
//! | side area of `HkLT`        | `A_yH + k·2l·2a + A_yT` | USR eq. 14 |
//! | length of `HkLT`, a solid  | `2·end + neck + k·2l` | half-ellipsoid ends, necks at the joints |

use core::f64::consts::PI;

/// One link: an elliptic cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// `a`, vertical: `2a` by `2l` is what a sideways motion meets, m.
    pub major_semi_axis_m: f64,
    /// `b`, lateral, m.
    pub minor_semi_axis_m: f64,
    /// `l`; the link is `2l` long, m.
    pub half_length_m: f64,
}

/// The geometry of every configuration `HkLT` of one robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// The link that is repeated.
    pub link: Link,
    /// `A_yH`, side area of the head, m².
    pub head_side_area_m2: f64,
    /// `A_yT`, side area of the tail, m².
    pub tail_side_area_m2: f64,
}

/// The narrower part at a joint of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neck {
    /// Its length with both ramps, m.
    pub length_m: f64,
    /// Its section over that of the link, both ways \[-\].
    pub scale: f64,
    /// Length of the conical ramp on each side, m.
    pub ramp_m: f64,
}

/// A modular robot as a solid: `k` links, `k + 1` joints between and around them, a half-ellipsoid at each end.
///
/// The links are `2l` long from joint to joint; water that a flooded neck holds is not part of the solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// The link that is repeated.
    pub link: Link,
    /// What narrows at every joint; `None` for a smooth chain.
    pub neck: Option<Neck>,
    /// Length of the half-ellipsoid at each end, m.
    pub end_m: f64,
}

impl Link {
    /// Side area `2a · 2l`, m² (USR eq. 8).
    #[must_use]
    pub fn side_area_m2(&self) -> f64 {
        2.0 * self.major_semi_axis_m * 2.0 * self.half_length_m
    }

    /// Section area `πab`, m² (USR eq. 14, `A_x`).
    #[must_use]
    pub fn section_area_m2(&self) -> f64 {
        PI * self.major_semi_axis_m * self.minor_semi_axis_m
    }

    /// Half the wetted area as USR eq. 8 has it: `π · ½(a+b) · 2l`, m².
    ///
    /// `C_f` refers to it, so `C_f = 2 C_F` of the ITTC line. The perimeter of the
    /// ellipse is taken as `π(a+b)`: low by 1 % at `a/b = 1.5`, by 3.1 % at 2.
    #[must_use]
    pub fn friction_area_m2(&self) -> f64 {
        PI * 0.5 * (self.major_semi_axis_m + self.minor_semi_axis_m) * 2.0 * self.half_length_m
    }

    /// Volume `πab · 2l`, m³.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        self.section_area_m2() * 2.0 * self.half_length_m
    }
}

impl Robot {
    /// The stand-in that reproduces Table 6 of the USR paper for H3LT to H9LT (not unique; `data/usr-fluid-parameters`).
    pub const NECKED_MAMBA: Self = Self {
        link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
        neck: Some(Neck { length_m: 0.060, scale: 0.7, ramp_m: 0.004 }),
        end_m: 0.031,
    };

    /// The smooth stand-in of the same source.
    pub const SMOOTH_MAMBA: Self = Self {
        link: Link { major_semi_axis_m: 0.0524, minor_semi_axis_m: 0.0372, half_length_m: 0.09 },
        neck: None,
        end_m: 0.0772,
    };

    /// From joint to joint, `2l`, m.
    #[must_use]
    pub fn pitch_m(&self) -> f64 {
        2.0 * self.link.half_length_m
    }

    /// Length of a neck with its ramps, m; 0 for a smooth chain.
    #[must_use]
    pub fn neck_length_m(&self) -> f64 {
        self.neck.map_or(0.0, |neck| neck.length_m)
    }

    /// From tip to tip with `links` links, m.
    #[must_use]
    pub fn length_m(&self, links: usize) -> f64 {
        2.0 * self.end_m + self.neck_length_m() + self.pitch_m() * links as f64
    }
}

impl Body {
    /// `A_HT = A_yH + A_yT`, side area of head and tail together, m².
    #[must_use]
    pub fn head_tail_side_area_m2(&self) -> f64 {
        self.head_side_area_m2 + self.tail_side_area_m2
    }

    /// `A_y = A_yH + k·2l·2a + A_yT`, side area of `HkLT`, m² (USR eq. 14).
    ///
    /// # Example
    ///
    /// ```
    /// use froude_hydro::{Body, Link};
    /// let body = Body {
    ///     link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
    ///     head_side_area_m2: 0.011,
    ///     tail_side_area_m2: 0.008,
    /// };
    /// assert!((body.side_area_m2(2.0) - 0.061_336).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn side_area_m2(&self, n_links: f64) -> f64 {
        self.head_tail_side_area_m2() + n_links * self.link.side_area_m2()
    }
}
