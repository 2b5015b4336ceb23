//! Vertices and panels.

use crate::vector::Vec3;

/// A flat panel with three or four corners, by the numbers of its vertices; counter-clockwise seen from the fluid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Panel([u32; 4]);

impl Panel {
    /// Three corners.
    #[must_use]
    pub const fn triangle(a: u32, b: u32, c: u32) -> Self {
        Self([a, b, c, a])
    }

    /// Four corners; where two neighbours are one vertex, a triangle.
    #[must_use]
    pub const fn quad(a: u32, b: u32, c: u32, d: u32) -> Self {
        if a == b {
            Self([b, c, d, b])
        } else if b == c || c == d {
            Self([a, b, d, a])
        } else {
            Self([a, b, c, d])
        }
    }

    /// Its corners in order: three or four numbers.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        if self.0[3] == self.0[0] { &self.0[..3] } else { &self.0 }
    }

    /// The same panel seen from the other side.
    #[must_use]
    pub fn turned(&self) -> Self {
        match *self.corners() {
            [a, b, c, d] => Self([a, d, c, b]),
            _ => Self([self.0[0], self.0[2], self.0[1], self.0[0]]),
        }
    }

    /// The same panel over vertices with other numbers.
    #[must_use]
    pub(crate) fn renumbered(&self, number: impl Fn(u32) -> u32) -> Self {
        Self(self.0.map(number))
    }

    /// The same panel of vertices whose numbers are larger by `offset`.
    #[must_use]
    pub fn moved_by(&self, offset: u32) -> Self {
        Self(self.0.map(|v| v + offset))
    }
}

/// A surface of flat panels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Vertices, m.
    pub vertices: Vec<Vec3>,
    /// Panels over them.
    pub panels: Vec<Panel>,
}

impl Mesh {
    /// Corners of a panel, m.
    pub fn corners(&self, panel: Panel) -> impl Iterator<Item = Vec3> + '_ {
        let n = panel.corners().len();
        (0..n).map(move |i| self.vertices[panel.corners()[i] as usize])
    }

    /// Every vertex moved by a function of the point; the orientation stays, so the function must not mirror.
    #[must_use]
    pub fn mapped(&self, f: impl Fn(Vec3) -> Vec3) -> Self {
        Self { vertices: self.vertices.iter().map(|v| f(*v)).collect(), panels: self.panels.clone() }
    }

    /// Mirrored in the plane where coordinate `axis` is zero, its normals still pointing outward.
    #[must_use]
    pub fn mirrored(&self, axis: usize) -> Self {
        let mut out = self.mapped(|mut v| {
            v[axis] = -v[axis];
            v
        });
        out.panels.iter_mut().for_each(|p| *p = p.turned());
        out
    }

    /// A half with its mirror image in the plane where coordinate `axis` is zero; vertices on that plane belong to both.
    #[must_use]
    pub fn with_mirror_image(&self, axis: usize) -> Self {
        let mut out = self.clone();
        let images: Vec<u32> = (0..)
            .zip(&self.vertices)
            .map(|(number, vertex)| {
                if vertex[axis] == 0.0 {
                    return number;
                }
                let mut image = *vertex;
                image[axis] = -image[axis];
                out.vertices.push(image);
                out.vertices.len() as u32 - 1
            })
            .collect();
        out.panels.extend(self.panels.iter().map(|p| p.renumbered(|v| images[v as usize]).turned()));
        out
    }

    /// Takes out the vertices that no panel uses; how many they were.
    pub(crate) fn drop_unused_vertices(&mut self) -> usize {
        let mut is_used = vec![false; self.vertices.len()];
        self.panels.iter().flat_map(|p| p.0).for_each(|v| is_used[v as usize] = true);
        let mut kept = 0;
        let numbers: Vec<u32> = is_used
            .iter()
            .map(|is_used| {
                kept += u32::from(*is_used);
                kept.saturating_sub(1)
            })
            .collect();
        let before = self.vertices.len();
        let mut is_used = is_used.into_iter();
        self.vertices.retain(|_| is_used.next().unwrap_or(true));
        self.panels.iter_mut().for_each(|p| *p = p.renumbered(|v| numbers[v as usize]));
        before - self.vertices.len()
    }

    /// Both meshes in one; vertices are not merged.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        let offset = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.panels.extend(other.panels.iter().map(|p| p.moved_by(offset)));
        self
    }
}
