//! The frame of a result: how a mesh lies, which axes its matrix is wanted in, and about which point.
//!
//! x is forward in both sets of body axes; they differ by half a turn about it.
//!
//! | axes | y | z | of |
//! | --- | --- | --- | --- |
//! | [`Axes::Ned`] | starboard | down | SNAME 1950; Fossen 2021 |
//! | [`Axes::Enu`] | port | up | ROS REP 103 |
//!
//! A mesh file says neither where its bow is nor where is up: [`Orientation`] does.

use core::fmt;

use froude_mesh::Vec3;
use froude_mesh::vector::{cross, dot, scale};
use froude_panel::problem::Frame;

use super::place;

/// A direction along an axis of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Direction {
    /// 0, 1, 2: x, y, z.
    pub axis: usize,
    /// Whether it is against the axis.
    pub is_against: bool,
}

impl Direction {
    /// Along x.
    pub const X: Self = Self { axis: 0, is_against: false };
    /// Along z.
    pub const Z: Self = Self { axis: 2, is_against: false };

    /// 1 along the axis, −1 against it.
    #[must_use]
    pub const fn sign(self) -> f64 {
        if self.is_against { -1.0 } else { 1.0 }
    }

    /// Coordinate of a point along this direction, m.
    #[must_use]
    pub fn coordinate(self, point: Vec3) -> f64 {
        self.sign() * point[self.axis]
    }

    fn unit(self) -> Vec3 {
        core::array::from_fn(|i| if i == self.axis { self.sign() } else { 0.0 })
    }

    fn letter(self) -> &'static str {
        ["x", "y", "z"][self.axis]
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", if self.is_against { "-" } else { "" }, self.letter())
    }
}

/// How a mesh lies: square to each other, one axis of it points forward and one up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orientation {
    forward: Direction,
    up: Direction,
}

impl Default for Orientation {
    /// x forward, z up, as wave programs and body files have it.
    fn default() -> Self {
        Self { forward: Direction::X, up: Direction::Z }
    }
}

impl Orientation {
    /// `None` where both lie along one axis.
    #[must_use]
    pub fn new(forward: Direction, up: Direction) -> Option<Self> {
        (forward.axis != up.axis).then_some(Self { forward, up })
    }

    /// Where the bow is.
    #[must_use]
    pub const fn forward(self) -> Direction {
        self.forward
    }

    /// Against gravity.
    #[must_use]
    pub const fn up(self) -> Direction {
        self.up
    }

    /// What wave programs take: z up, about the origin of the mesh. A mesh whose z points up keeps its axes.
    #[must_use]
    pub fn wave_axes(self) -> Axes {
        if self.up == Direction::Z { Axes::Mesh } else { Axes::Enu }
    }
}

/// Axes that a matrix is wanted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axes {
    /// Those of the mesh.
    #[default]
    Mesh,
    /// x forward, y starboard, z down.
    Ned,
    /// x forward, y port, z up.
    Enu,
}

impl Axes {
    /// Unit vectors in the axes of a mesh.
    #[must_use]
    pub fn vectors(self, mesh: Orientation) -> [Vec3; 3] {
        let (forward, up) = (mesh.forward.unit(), mesh.up.unit());
        let port = cross(up, forward);
        match self {
            Self::Mesh => Frame::at([0.0; 3]).axes,
            Self::Enu => [forward, port, up],
            Self::Ned => [forward, scale(port, -1.0), scale(up, -1.0)],
        }
        .map(|v| v.map(|x| x + 0.0))
    }

    /// In words: of body axes what each is; of a mesh which of its axes is vertical.
    #[must_use]
    pub fn words(self, mesh: Orientation) -> String {
        match self {
            Self::Mesh => {
                format!("axes of the mesh, {} {}", mesh.up.letter(), if mesh.up.is_against { "down" } else { "up" })
            }
            Self::Ned | Self::Enu => {
                format!("{}; in the mesh {} is forward and {} up", self.own_words(), mesh.forward, mesh.up)
            }
        }
    }

    /// The same of a body whose axes are known: a body file, the links of a robot.
    #[must_use]
    pub const fn own_words(self) -> &'static str {
        match self {
            Self::Mesh => "x forward along the body, y lateral, z vertical",
            Self::Ned => "x forward, y starboard, z down (SNAME, Fossen)",
            Self::Enu => "x forward, y port, z up (ROS REP 103)",
        }
    }
}

/// The point that moments are about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Point {
    /// A point in the axes of the mesh, m from its origin.
    At(Vec3),
    /// The centre of buoyancy.
    Buoyancy,
    /// The centre of gravity that the body file gives.
    Gravity,
}

impl Point {
    /// In words, with where it lies.
    #[must_use]
    pub fn words(self, at_m: Vec3, axes: Axes) -> String {
        let place = place::point(at_m, "the origin of the mesh");
        let place = match (self, axes) {
            (Self::At([0.0, 0.0, 0.0]), _) | (_, Axes::Mesh) => place,
            _ => format!("{place}, in the axes of the mesh"),
        };
        match self {
            Self::At(_) => place,
            Self::Buoyancy => format!("{place} (the centre of buoyancy)"),
            Self::Gravity => format!("{place} (the centre of gravity)"),
        }
    }
}

/// Axes and point in one sentence.
#[must_use]
pub fn sentence(frame: &str, point: &str) -> String {
    format!("Frame: {frame}; moments about {point}.")
}

/// Second moments of a body about a point, in axes: ∫ (|x|² − (a·x)²) dV for each axis a, from those about the origin, the volume and its
/// centre (Huygens–Steiner, with the distances of the centre from both).
#[must_use]
pub fn inertia_m5(about_origin_m5: [[f64; 3]; 3], volume_m3: f64, centre_m: Vec3, frame: &Frame) -> Vec3 {
    let apart: Vec3 = core::array::from_fn(|k| centre_m[k] - frame.origin_m[k]);
    frame.axes.map(|a| {
        let own = dot(a, about_origin_m5.map(|row| dot(row, a)));
        let square = |p: Vec3| dot(p, p) - dot(a, p).powi(2);
        own + volume_m3 * (square(apart) - square(centre_m))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Orientation> {
        let directions = (0..6).map(|k| Direction { axis: k / 2, is_against: k % 2 == 1 });
        directions.clone().flat_map(|f| directions.clone().filter_map(move |u| Orientation::new(f, u))).collect()
    }

    #[test]
    fn every_mesh_has_right_handed_body_axes_with_x_forward() {
        assert_eq!(all().len(), 24);
        for mesh in all() {
            for axes in [Axes::Mesh, Axes::Ned, Axes::Enu] {
                let [x, y, z] = axes.vectors(mesh);
                assert_eq!(cross(x, y), z.map(|c| c + 0.0), "{mesh:?} {axes:?}");
            }
            let [[x, port, up], [forward, starboard, down]] = [Axes::Enu, Axes::Ned].map(|a| a.vectors(mesh));
            assert_eq!((x, x[mesh.forward.axis]), (forward, mesh.forward.sign()));
            assert_eq!(up[mesh.up.axis], mesh.up.sign());
            assert_eq!([dot(port, starboard), dot(up, down)], [-1.0, -1.0]);
        }
    }

    #[test]
    fn a_mesh_as_wave_programs_have_it_is_in_enu() {
        assert_eq!(Axes::Enu.vectors(Orientation::default()), Axes::Mesh.vectors(Orientation::default()));
        let down = Orientation::new(Direction::X, Direction { axis: 2, is_against: true }).unwrap();
        assert_eq!(Axes::Ned.vectors(down), Axes::Mesh.vectors(down));
        assert_eq!([Orientation::default().wave_axes(), down.wave_axes()], [Axes::Mesh, Axes::Enu]);
    }
}
