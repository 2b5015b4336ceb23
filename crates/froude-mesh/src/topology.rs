//! Which panels meet at which edge.

use crate::mesh::Mesh;

/// An edge as one panel passes it.
#[derive(Clone, Copy)]
pub(crate) struct Side {
    /// Its vertices, the smaller number first.
    pub edge: (u32, u32),
    pub panel: u32,
    /// The corner of the panel at which it begins.
    pub corner: u8,
    /// From the smaller number to the larger.
    pub is_forward: bool,
}

/// Sides of all panels, those of one edge in a row.
pub(crate) fn sides(mesh: &Mesh) -> Vec<Side> {
    let mut out = Vec::with_capacity(4 * mesh.panels.len());
    for (number, panel) in (0..).zip(&mesh.panels) {
        let corners = panel.corners();
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            if from != to {
                let edge = (from.min(to), from.max(to));
                out.push(Side { edge, panel: number, corner: i as u8, is_forward: from < to });
            }
        }
    }
    out.sort_unstable_by_key(|side| (side.edge, side.panel, side.corner));
    out
}

/// The sides of each edge.
pub(crate) fn by_edge(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| a.edge == b.edge)
}

/// Groups of numbers that grow together.
pub(crate) struct Groups(Vec<u32>);

impl Groups {
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The number that stands for the group of one.
    pub fn of(&mut self, mut number: u32) -> u32 {
        while self.0[number as usize] != number {
            let above = self.0[self.0[number as usize] as usize];
            self.0[number as usize] = above;
            number = above;
        }
        number
    }

    /// Makes two groups one; the smaller number stands for it.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
