//! Tessellations of bodies that are round, flat, or both, as drawing programs export them; each also finer, towards the body that is meant.

use std::f64::consts::PI;

use froude::mesh::refine::subdivided;
use froude::mesh::{Mesh, Panel};
use rand::RngExt;
use rand_pcg::Pcg64;

/// Names of the kinds, in the order of [`Intended::random`].
pub const KINDS: [&str; 6] = ["cone", "cone-cylinder", "ogive", "plate", "prism", "finned hull"];

/// A body that somebody means, with the coarsest tessellation of it.
pub enum Intended {
    /// A body of revolution about x.
    Round(Round),
    /// A polyhedron: its own tessellation.
    Flat(Mesh),
}

/// Sections along x, from the bow on: rows between them, and the radius over x.
pub struct Round {
    pieces: Vec<Piece>,
    around: usize,
    is_quads: bool,
    fins: Option<Fins>,
}

/// A piece of the meridian from x₀ to x₁ with its rows.
struct Piece {
    from_m: [f64; 2],
    to_m: [f64; 2],
    rows: usize,
    /// An arc that leaves or reaches the axis parallel to it at this end; a straight line where there is none.
    arc: Option<bool>,
}

/// Four flat plates on one of the pieces.
struct Fins {
    piece: usize,
    /// Chords of the hull under each.
    under: usize,
    half_thickness_rad: f64,
    height_m: f64,
}

impl Intended {
    /// One of six kinds.
    pub fn random(rng: &mut Pcg64, kind: usize) -> Self {
        let around = 4 * rng.random_range(2..5);
        let radius_m = 0.5;
        let of = |rng: &mut Pcg64, low: f64, high: f64| rng.random_range(low..high);
        let straight = |from_m, to_m, rows| Piece { from_m, to_m, rows, arc: None };
        let is_quads = rng.random_range(0..2) == 1;
        match kind {
            0 => {
                let (length, rows) = (of(rng, 0.7, 3.0), rng.random_range(1..4));
                let pieces = vec![straight([length, 0.0], [0.0, radius_m], rows)];
                Self::Round(Round { pieces, around, is_quads, fins: None })
            }
            1 => {
                let (nose, middle, tail) = (of(rng, 0.8, 2.5), of(rng, 0.5, 3.0), of(rng, 0.8, 3.0));
                let mut pieces = vec![
                    straight([middle + nose, 0.0], [middle, radius_m], rng.random_range(1..3)),
                    straight([middle, radius_m], [0.0, radius_m], rng.random_range(1..4)),
                ];
                if rng.random_range(0..2) == 1 {
                    pieces.push(straight([0.0, radius_m], [-tail, 0.0], 1));
                }
                Self::Round(Round { pieces, around, is_quads, fins: None })
            }
            2 | 5 => {
                let (nose, middle, tail) = (of(rng, 0.6, 2.0), of(rng, 0.5, 2.5), of(rng, 0.6, 2.0));
                let rows = rng.random_range(3..7);
                let mut pieces = vec![
                    Piece { from_m: [middle + nose, 0.0], to_m: [middle, radius_m], rows, arc: Some(true) },
                    straight([middle, radius_m], [0.0, radius_m], rng.random_range(1..3)),
                ];
                if rng.random_range(0..2) == 1 {
                    let from_m = [0.0, radius_m];
                    pieces.push(Piece { from_m, to_m: [-tail, 0.0], rows: rng.random_range(3..7), arc: Some(false) });
                }
                let fins = (kind == 5).then(|| Fins {
                    piece: 1,
                    under: rng.random_range(1..3),
                    half_thickness_rad: of(rng, 0.03, 0.2),
                    height_m: of(rng, 0.2, 0.5),
                });
                Self::Round(Round { pieces, around, is_quads, fins })
            }
            3 => {
                let size = [1.0, of(rng, 0.3, 1.0), of(rng, 0.08, 0.2)];
                let cells = [rng.random_range(2..6), rng.random_range(2..5), 1];
                Self::Flat(plate(size, cells))
            }
            _ => {
                let (sides, length_m) = (rng.random_range(3..13), of(rng, 0.6, 3.0));
                let pieces = vec![straight([length_m, radius_m], [0.0, radius_m], rng.random_range(1..3))];
                Self::Flat(Round { pieces, around: sides, is_quads, fins: None }.mesh(1))
            }
        }
    }

    /// Its tessellation in cells a whole number of times smaller.
    pub fn mesh(&self, finer: usize) -> Mesh {
        match self {
            Self::Round(round) => round.mesh(finer),
            Self::Flat(mesh) => (0..finer.ilog2()).fold(mesh.clone(), |mesh, _| subdivided(&mesh)),
        }
    }

    /// Axes across which all its tessellations are their own images.
    pub fn planes(&self) -> Vec<usize> {
        match self {
            Self::Round(_) => vec![1, 2],
            Self::Flat(_) => Vec::new(),
        }
    }
}

impl Piece {
    /// The meridian at a part of the piece.
    fn at(&self, part: f64) -> [f64; 2] {
        let [[x, r], [y, s]] = [self.from_m, self.to_m];
        match self.arc {
            None => [x + part * (y - x), r + part * (s - r)],
            // A tangent ogive, in equal angles: parallel to the axis where it is widest.
            Some(is_bow) => {
                let (length, radius) = ((x - y).abs(), r.max(s));
                let arc = (radius * radius + length * length) / (2.0 * radius);
                let whole = (length / arc).asin();
                let angle = whole * if is_bow { 1.0 - part } else { part };
                let along = arc * angle.sin();
                [if is_bow { y + along } else { x - along }, (radius - arc * (1.0 - angle.cos())).max(0.0)]
            }
        }
    }
}

/// A mesh that grows: vertices at one place are one.
#[derive(Default)]
struct Growing {
    mesh: Mesh,
}

impl Growing {
    fn vertex(&mut self, at: [f64; 3]) -> u32 {
        let near = |v: &[f64; 3]| v.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-9);
        let found = self.mesh.vertices.iter().position(near);
        found.unwrap_or_else(|| {
            self.mesh.vertices.push(at);
            self.mesh.vertices.len() - 1
        }) as u32
    }

    /// A quadrilateral, two triangles, or one where two corners are one.
    fn cell(&mut self, corners: [[f64; 3]; 4], is_quad: bool) {
        let corners = corners.map(|at| self.vertex(at));
        let mut distinct: Vec<u32> = Vec::new();
        for c in corners {
            if !distinct.contains(&c) {
                distinct.push(c);
            }
        }
        match distinct[..] {
            [a, b, c, d] if is_quad => self.mesh.panels.push(Panel::quad(a, b, c, d)),
            [a, b, c, d] => self.mesh.panels.extend([Panel::triangle(a, b, c), Panel::triangle(a, c, d)]),
            [a, b, c] => self.mesh.panels.push(Panel::triangle(a, b, c)),
            _ => {}
        }
    }
}

impl Round {
    /// Angles around, symmetric about y = 0 and z = 0.
    fn angles(&self, finer: usize) -> (Vec<f64>, Vec<bool>) {
        let (mut angles, mut is_fin) = (Vec::new(), Vec::new());
        let mut add = |from: f64, to: f64, cells: usize, fin: bool| {
            for k in 0..cells {
                angles.push(from + (to - from) * k as f64 / cells as f64);
                is_fin.push(fin);
            }
        };
        let Some(fins) = &self.fins else {
            add(0.0, 2.0 * PI, self.around * finer, false);
            return (angles, is_fin);
        };
        let half = fins.half_thickness_rad;
        for quarter in 0..4 {
            let middle = 0.5 * PI * f64::from(quarter);
            add(middle - half, middle + half, fins.under * finer, true);
            add(middle + half, middle + 0.5 * PI - half, (self.around / 4).max(2) * finer, false);
        }
        (angles, is_fin)
    }

    fn mesh(&self, finer: usize) -> Mesh {
        let (angles, is_fin) = self.angles(finer);
        let n = angles.len();
        let mut out = Growing::default();
        let point = |[x, r]: [f64; 2], k: usize| [x, r * angles[k % n].cos(), r * angles[k % n].sin()];
        for (number, piece) in self.pieces.iter().enumerate() {
            let rows = piece.rows * finer;
            for row in 0..rows {
                let [bow, stern] = [row, row + 1].map(|i| piece.at(i as f64 / rows as f64));
                for k in 0..n {
                    let under_fin = self.fins.as_ref().is_some_and(|fins| fins.piece == number) && is_fin[k];
                    if !under_fin {
                        out.cell(
                            [point(bow, k), point(stern, k), point(stern, k + 1), point(bow, k + 1)],
                            self.is_quads,
                        );
                    }
                }
            }
        }
        let disc = |out: &mut Growing, end: [f64; 2], is_bow: bool| {
            for ring in 0..2 * finer {
                let [inner, outer] = [ring, ring + 1].map(|i| [end[0], end[1] * i as f64 / (2 * finer) as f64]);
                for k in 0..n {
                    let mut cell = [point(inner, k), point(outer, k), point(outer, k + 1), point(inner, k + 1)];
                    if !is_bow {
                        cell.reverse();
                    }
                    out.cell(cell, self.is_quads);
                }
            }
        };
        for (end, is_bow) in [(self.pieces[0].from_m, true), (self.pieces[self.pieces.len() - 1].to_m, false)] {
            if end[1] > 0.0 {
                disc(&mut out, end, is_bow);
            }
        }
        if let Some(fins) = &self.fins {
            self.add_fins(&mut out, fins, finer);
        }
        out.mesh
    }

    fn add_fins(&self, out: &mut Growing, fins: &Fins, finer: usize) {
        let piece = &self.pieces[fins.piece];
        let (rows, up, across) = (piece.rows * finer, 2 * finer, fins.under * finer);
        let (radius, half) = (piece.from_m[1], fins.half_thickness_rad);
        for quarter in 0..4 {
            let (sin, cos) = (0.5 * PI * f64::from(quarter)).sin_cos();
            // Along the piece, across the fin, out of the hull: from 0 to 1 each; the root is the hull's.
            let at = |i: usize, j: usize, k: usize| {
                let [x, _] = piece.at(i as f64 / rows as f64);
                let (turn, height) = (half * (2.0 * j as f64 / across as f64 - 1.0), k as f64 / up as f64);
                let [y, z] =
                    [(1.0 - height) * radius * turn.cos() + height * (radius + fins.height_m), radius * turn.sin()];
                [x, y * cos - z * sin, y * sin + z * cos]
            };
            let quads = self.is_quads;
            for i in 0..rows {
                for k in 0..up {
                    out.cell([at(i, 0, k), at(i + 1, 0, k), at(i + 1, 0, k + 1), at(i, 0, k + 1)], quads);
                    out.cell(
                        [at(i, across, k), at(i, across, k + 1), at(i + 1, across, k + 1), at(i + 1, across, k)],
                        quads,
                    );
                }
                for j in 0..across {
                    out.cell([at(i, j, up), at(i + 1, j, up), at(i + 1, j + 1, up), at(i, j + 1, up)], quads);
                }
            }
            for j in 0..across {
                for k in 0..up {
                    out.cell([at(0, j, k), at(0, j, k + 1), at(0, j + 1, k + 1), at(0, j + 1, k)], quads);
                    out.cell([at(rows, j, k), at(rows, j + 1, k), at(rows, j + 1, k + 1), at(rows, j, k + 1)], quads);
                }
            }
        }
    }
}

/// A box of triangles.
fn plate(size: [f64; 3], cells: [usize; 3]) -> Mesh {
    let mut out = Growing::default();
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for (side, is_far) in [(0.0, false), (size[axis], true)] {
            for i in 0..cells[a] {
                for j in 0..cells[b] {
                    let at = |i: usize, j: usize| {
                        let mut v = [0.0; 3];
                        v[axis] = side - 0.5 * size[axis];
                        v[a] = size[a] * (i as f64 / cells[a] as f64 - 0.5);
                        v[b] = size[b] * (j as f64 / cells[b] as f64 - 0.5);
                        v
                    };
                    let mut cell = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    if !is_far {
                        cell.reverse();
                    }
                    out.cell(cell, false);
                }
            }
        }
    }
    out.mesh
}
