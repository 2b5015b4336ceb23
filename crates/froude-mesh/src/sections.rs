//! Bodies of elliptic sections along x: ellipsoids, capsules, elliptic cylinders, necks.
//!
//! A body is a row of [`Piece`]s, each a smooth curve of the section (x, half-width along y, half-height along z) cut into cells. The
//! corners of a section lie at equal parameters θ of its ellipse, (x, w cos θ, h sin θ). Pieces meet on panel lines.
//!
//! **Similar families.** A [`Resolution`] multiplies the cells of every piece and the panels around by one whole number: the vertices
//! of the coarse mesh are among those of the fine one wherever the number divides, cells keep their proportions, and the error of a
//! second-order method falls by exactly its square. That is what extrapolation needs.

use core::f64::consts::PI;

use crate::mesh::{Mesh, Panel};
use crate::vector::Vec3;

/// A section of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Where, m.
    pub x_m: f64,
    /// Half of its extent along y, m.
    pub half_width_m: f64,
    /// Half of its extent along z, m.
    pub half_height_m: f64,
}

impl Section {
    /// A section.
    #[must_use]
    pub const fn new(x_m: f64, half_width_m: f64, half_height_m: f64) -> Self {
        Self { x_m, half_width_m, half_height_m }
    }

    const fn is_point(&self) -> bool {
        self.half_width_m == 0.0 && self.half_height_m == 0.0
    }
}

/// How the section changes along a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// Straight: a cylinder, a cone, or a flat end where x does not change.
    Straight,
    /// A quarter of an ellipse from a point to the full section, or back: half an ellipsoid.
    Elliptic,
}

/// Where the cells of a piece are finer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grading {
    /// Equal in the curve's parameter.
    Even,
    /// Towards the start.
    Start,
    /// Towards the end.
    End,
    /// Towards both.
    Both,
}

impl Grading {
    /// From equal steps to graded ones; 0 and 1 stay. Cosines: the finest cell is that of the square of the number of cells.
    fn at(self, s: f64) -> f64 {
        match self {
            Self::Even => s,
            Self::Start => 1.0 - (0.5 * PI * s).cos(),
            Self::End => (0.5 * PI * s).sin(),
            Self::Both => 0.5 * (1.0 - (PI * s).cos()),
        }
    }
}

/// A stretch of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Its sections at the smaller and the larger x.
    pub ends: [Section; 2],
    /// Between them.
    pub curve: Curve,
    /// Where its cells are finer.
    pub grading: Grading,
    /// Cells of the coarsest mesh.
    pub cells: usize,
    /// Whom its panels belong to: the number of a link.
    pub part: usize,
}

impl Piece {
    /// Section at a part of the way, 0 to 1: along x where it is straight, of the angle where it is elliptic.
    #[must_use]
    pub fn at(&self, t: f64) -> Section {
        let [a, b] = self.ends;
        let mix = |p: f64, q: f64, t: f64| p + (q - p) * t;
        let (along, across) = match self.curve {
            Curve::Straight => (t, t),
            // The point's end has the tangent across: x = 1 − cos, section = sin of the angle.
            Curve::Elliptic if a.is_point() => (1.0 - (0.5 * PI * t).cos(), (0.5 * PI * t).sin()),
            Curve::Elliptic => ((0.5 * PI * t).sin(), 1.0 - (0.5 * PI * t).cos()),
        };
        Section::new(
            mix(a.x_m, b.x_m, along),
            mix(a.half_width_m, b.half_width_m, across),
            mix(a.half_height_m, b.half_height_m, across),
        )
    }
}

impl Piece {
    fn volume_m3(&self) -> f64 {
        let [a, b] = self.ends;
        let area = |s: Section| PI * s.half_width_m * s.half_height_m;
        let mean = match self.curve {
            Curve::Straight => (area(a) + 4.0 * area(self.at(0.5)) + area(b)) / 6.0,
            Curve::Elliptic => {
                let [small, large] = if a.is_point() { [a, b] } else { [b, a] };
                let (w, h) = (small.half_width_m, small.half_height_m);
                let (dw, dh) = (large.half_width_m - w, large.half_height_m - h);
                PI * (w * h + (w * dh + h * dw) * PI / 4.0 + dw * dh * 2.0 / 3.0)
            }
        };
        (b.x_m - a.x_m) * mean
    }
}

/// How fine a mesh of a body of sections is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    /// Cells of every piece, in multiples of those it declares.
    pub along: usize,
    /// Panels around.
    pub around: usize,
}

/// A body of elliptic sections.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionBody {
    /// Its pieces by increasing x; each begins with the section that the one before ends with. The first begins, and the last ends, with
    /// a point.
    pub pieces: Vec<Piece>,
}

/// A mesh whose panels know their part.
#[derive(Debug, Clone, PartialEq)]
pub struct PartMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Part of each panel.
    pub parts: Vec<usize>,
}

impl SectionBody {
    /// An ellipsoid with its centre at the origin: semi-axes along x, y, z.
    #[must_use]
    pub fn ellipsoid(semi_axes_m: Vec3, cells: usize) -> Self {
        let [a, b, c] = semi_axes_m;
        let middle = Section::new(0.0, b, c);
        let half = |ends| Piece { ends, curve: Curve::Elliptic, grading: Grading::Even, cells, part: 0 };
        Self { pieces: vec![half([Section::new(-a, 0.0, 0.0), middle]), half([middle, Section::new(a, 0.0, 0.0)])] }
    }

    /// A cylinder of elliptic section between two half-ellipsoids, centre at the origin.
    ///
    /// `half_length_m` is that of the cylinder alone, `end_m` the length of each end. The cylinder's cells are finer at the junctions.
    #[must_use]
    pub fn capsule(half_length_m: f64, half_width_m: f64, half_height_m: f64, end_m: f64, cells: [usize; 2]) -> Self {
        let section = |x_m| Section::new(x_m, half_width_m, half_height_m);
        let tip = |x_m| Section::new(x_m, 0.0, 0.0);
        let [low, high] = [section(-half_length_m), section(half_length_m)];
        let piece = |ends, curve, grading, cells| Piece { ends, curve, grading, cells, part: 0 };
        let out = half_length_m + end_m;
        Self {
            pieces: vec![
                piece([tip(-out), low], Curve::Elliptic, Grading::Even, cells[0]),
                piece([low, high], Curve::Straight, Grading::Both, cells[1]),
                piece([high, tip(out)], Curve::Elliptic, Grading::Even, cells[0]),
            ],
        }
    }

    /// A cylinder of elliptic section with flat ends, centre at the origin; cells are finer towards the edges.
    #[must_use]
    pub fn flat_cylinder(half_length_m: f64, half_width_m: f64, half_height_m: f64, cells: [usize; 2]) -> Self {
        let section = |x_m| Section::new(x_m, half_width_m, half_height_m);
        let tip = |x_m| Section::new(x_m, 0.0, 0.0);
        let [low, high] = [section(-half_length_m), section(half_length_m)];
        let piece = |ends, grading, cells| Piece { ends, curve: Curve::Straight, grading, cells, part: 0 };
        Self {
            pieces: vec![
                piece([tip(-half_length_m), low], Grading::End, cells[0]),
                piece([low, high], Grading::Both, cells[1]),
                piece([high, tip(half_length_m)], Grading::Start, cells[0]),
            ],
        }
    }

    /// Volume of the body itself, m³, exact: what its meshes come to.
    ///
    /// Section by section, w and h being its half-width and half-height: ∫ π w h dx. A straight piece has w h of second order in x, and Simpson's
    /// rule is exact. An elliptic one has both grow with the sine of an angle, x going with its cosine: ∫ sin = 1, ∫ sin² = π/4 and
    /// ∫ sin³ = 2/3 over a quarter.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        self.pieces.iter().map(Piece::volume_m3).sum()
    }

    /// The mesh at a resolution.
    ///
    /// # Errors
    ///
    /// [`SectionError`] for a body without pieces, pieces that do not meet, or a resolution that encloses nothing.
    pub fn mesh(&self, resolution: Resolution) -> Result<PartMesh, SectionError> {
        let first = self.pieces.first().ok_or(SectionError::NoPiece)?;
        if resolution.along == 0 || resolution.around < 3 {
            return Err(SectionError::TooCoarse { resolution });
        }
        let mut last = first.ends[0];
        let mut sections = vec![last];
        let mut part_of = Vec::new();
        for (number, piece) in self.pieces.iter().enumerate() {
            let n = piece.cells * resolution.along;
            if last != piece.ends[0] || n == 0 {
                return Err(SectionError::Apart { piece: number, begins: piece.ends[0], before: last, cells: n });
            }
            for i in 1..=n {
                let s = piece.grading.at(i as f64 / n as f64);
                last = if i == n { piece.ends[1] } else { piece.at(s) };
                sections.push(last);
                part_of.push(piece.part);
            }
        }
        let around = resolution.around;
        let mut out = PartMesh { mesh: Mesh::default(), parts: Vec::new() };
        let mut before: Option<Vec<u32>> = None;
        for (i, section) in sections.iter().enumerate() {
            let ring = ring(&mut out.mesh, section, around);
            if let Some(before) = &before {
                for k in 0..around {
                    let next = (k + 1) % around;
                    out.mesh.panels.push(Panel::quad(before[k], before[next], ring[next], ring[k]));
                    out.parts.push(part_of[i - 1]);
                }
            }
            before = Some(ring);
        }
        Ok(out)
    }
}

/// Why a row of pieces is no body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SectionError {
    /// Nothing in it.
    #[error("the body has no piece")]
    NoPiece,
    /// Too few cells to enclose anything.
    #[error("{} cells for each of a piece and {} panels around enclose nothing; 1 and 3 at least", resolution.along, resolution.around)]
    TooCoarse {
        /// What was asked for.
        resolution: Resolution,
    },
    /// A piece that begins elsewhere than the one before ends, or has no cell.
    #[error(
        "piece {piece} has {cells} cells and begins with {begins:?} where the one before ends with {before:?}; let them meet"
    )]
    Apart {
        /// The piece, from 0.
        piece: usize,
        /// Its first section.
        begins: Section,
        /// The last section before it.
        before: Section,
        /// Its cells.
        cells: usize,
    },
}

/// Vertices of a section: as many as go around, or one.
fn ring(mesh: &mut Mesh, section: &Section, around: usize) -> Vec<u32> {
    let first = mesh.vertices.len() as u32;
    if section.is_point() {
        mesh.vertices.push([section.x_m, 0.0, 0.0]);
        return vec![first; around];
    }
    for k in 0..around {
        let (sin, cos) = circle(k, around);
        mesh.vertices.push([section.x_m, section.half_width_m * cos, section.half_height_m * sin]);
    }
    (0..around as u32).map(|k| first + k).collect()
}

/// Sine and cosine of k of n steps around, with the symmetries of the circle exact to the bit where n is a multiple of four.
fn circle(k: usize, n: usize) -> (f64, f64) {
    let of = |k: usize| {
        let angle = 2.0 * PI * k as f64 / n as f64;
        (angle.sin(), angle.cos())
    };
    if !n.is_multiple_of(4) {
        return of(k);
    }
    let quarter = n / 4;
    let (turn, rest) = (k / quarter, k % quarter);
    let (s, c) = if rest == 0 { (0.0, 1.0) } else { of(rest) };
    match turn {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Measure;

    #[test]
    fn volumes_converge_to_those_of_the_bodies_with_the_square_of_the_cells() {
        let ellipsoid = SectionBody::ellipsoid([3.0, 1.0, 2.0], 2);
        let capsule = SectionBody::capsule(2.0, 0.5, 0.8, 0.7, [2, 4]);
        let cylinder = SectionBody::flat_cylinder(2.0, 0.5, 0.8, [2, 4]);
        let section = PI * 0.5 * 0.8;
        for (body, exact) in
            [(ellipsoid, 4.0 / 3.0 * PI * 6.0), (capsule, section * (4.0 + 4.0 / 3.0 * 0.7)), (cylinder, section * 4.0)]
        {
            let error = |along| {
                let mesh = body.mesh(Resolution { along, around: 8 * along }).unwrap().mesh;
                1.0 - Measure::of(&mesh).volume_m3 / exact
            };
            let (coarse, fine) = (error(4), error(8));
            assert!(fine > 0.0 && (coarse / fine - 4.0).abs() < 0.03, "{coarse} {fine}");
            assert!((body.volume_m3() / exact - 1.0).abs() < 1e-14, "{} {exact}", body.volume_m3());
        }
    }

    /// A cone's frustum, and arcs that end in a section and not in a point, against meshes of 256 panels around.
    #[test]
    fn the_exact_volume_is_what_meshes_come_to() {
        let piece = |ends, curve| Piece { ends, curve, grading: Grading::Even, cells: 4, part: 0 };
        let at = Section::new;
        let [tip, one, two, three, end] =
            [at(-1.0, 0.0, 0.0), at(0.0, 0.3, 0.5), at(0.7, 0.6, 0.2), at(1.5, 0.4, 0.1), at(1.8, 0.0, 0.0)];
        let body = SectionBody {
            pieces: vec![
                piece([tip, one], Curve::Elliptic),
                piece([one, two], Curve::Straight),
                piece([two, three], Curve::Elliptic),
                piece([three, end], Curve::Straight),
            ],
        };
        let mesh =
            |along: usize| Measure::of(&body.mesh(Resolution { along, around: 16 * along }).unwrap().mesh).volume_m3;
        let (coarse, fine) = (mesh(8), mesh(16));
        let limit = fine + (fine - coarse) / 3.0;
        assert!((limit / body.volume_m3() - 1.0).abs() < 1e-6, "{limit} {}", body.volume_m3());
    }

    #[test]
    fn pieces_that_do_not_meet_are_refused() {
        let mut body = SectionBody::ellipsoid([3.0, 1.0, 2.0], 2);
        let resolution = Resolution { along: 1, around: 8 };
        assert_eq!(
            body.mesh(Resolution { around: 2, ..resolution }).unwrap_err().to_string().split(' ').next(),
            Some("1")
        );
        body.pieces[1].ends[0].x_m = 0.5;
        assert!(body.mesh(resolution).unwrap_err().to_string().starts_with("piece 1 has 2 cells and begins with"));
        body.pieces.clear();
        assert_eq!(body.mesh(resolution), Err(SectionError::NoPiece));
    }

    #[test]
    fn the_vertices_of_a_coarse_mesh_are_among_those_of_the_fine_one() {
        let body = SectionBody::capsule(2.0, 0.5, 0.8, 0.7, [2, 4]);
        let [coarse, fine] = [1, 2].map(|m| body.mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh);
        for v in &coarse.vertices {
            assert!(fine.vertices.iter().any(|w| v.iter().zip(w).all(|(a, b)| (a - b).abs() < 1e-15)), "{v:?}");
        }
    }
}
