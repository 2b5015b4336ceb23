//! A volume mesh as OpenFOAM has it: points, faces, and the cells on both sides of each.

/// What lies beyond a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatchKind {
    /// Open water.
    Patch,
    /// A body's surface.
    Wall,
    /// A plane of symmetry.
    Symmetry,
    /// A surface of symmetry, which need not be plane.
    Mirror,
    /// The front and the back of a mesh in two dimensions.
    Empty,
}

/// Faces of the boundary that belong together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    /// `body`, `far`, `symmetry`, `wall`, …
    pub name: String,
    /// What lies beyond it.
    pub kind: PatchKind,
    /// First of its faces.
    pub start: usize,
    /// How many there are.
    pub count: usize,
}

impl Patch {
    /// Whether water flows over it.
    #[must_use]
    pub fn is_wall(&self) -> bool {
        self.kind == PatchKind::Wall
    }

    /// Whether water may cross it.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.kind == PatchKind::Patch
    }
}

/// A volume mesh.
///
/// Faces between cells come first, those of the patches behind them, patch by patch. Corners of a face run counter-clockwise seen from its owner's neighbour, or from beyond the boundary, so that its normal points out of the owner; the owner is the cell of the lower number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PolyMesh {
    /// Points, m, body axes.
    pub points_m: Vec<[f64; 3]>,
    /// Corners of each face.
    pub faces: Vec<Vec<u32>>,
    /// Cell behind each face.
    pub owner: Vec<u32>,
    /// Cell before each face between cells.
    pub neighbour: Vec<u32>,
    /// The boundary.
    pub patches: Vec<Patch>,
    /// How many cells there are.
    pub cells: usize,
}

/// A face in the making: its corners, counter-clockwise seen from outside of its cell, and that cell.
pub(crate) struct Side {
    pub corners: Vec<u32>,
    pub cell: u32,
}

impl PolyMesh {
    /// Puts faces into the order that OpenFOAM wants, the upper triangle: by the lower cell, then by the higher one; patches without faces are left out.
    pub(crate) fn assemble(
        points_m: Vec<[f64; 3]>,
        cells: usize,
        between: Vec<(Side, u32)>,
        boundary: Vec<(&str, PatchKind, Vec<Side>)>,
    ) -> Self {
        let mut inner: Vec<(u32, u32, Vec<u32>)> = between
            .into_iter()
            .map(|(mut side, other)| {
                if other < side.cell {
                    side.corners.reverse();
                }
                (side.cell.min(other), side.cell.max(other), side.corners)
            })
            .collect();
        inner.sort_by_key(|(owner, neighbour, _)| (*owner, *neighbour));
        let mut mesh = Self { points_m, cells, ..Self::default() };
        for (owner, neighbour, corners) in inner {
            mesh.owner.push(owner);
            mesh.neighbour.push(neighbour);
            mesh.faces.push(corners);
        }
        for (name, kind, mut sides) in boundary.into_iter().filter(|(_, _, sides)| !sides.is_empty()) {
            sides.sort_by_key(|side| side.cell);
            mesh.patches.push(Patch { name: name.to_owned(), kind, start: mesh.faces.len(), count: sides.len() });
            for side in sides {
                mesh.owner.push(side.cell);
                mesh.faces.push(side.corners);
            }
        }
        mesh
    }
}
