//! A mesh from elsewhere has one uncertainty, as one body or as one of several parts.

use froude_mesh::mesh::{Mesh, Panel};
use froude_mesh::refine::subdivided;
use froude_panel::family::Family;

use froude_panel::problem::{Frame, Problem};
use froude_panel::refine::{Levels, RefineError, Wanted, refine, refine_parts};
use froude_panel::study::Size;

/// A brick of 2 m by 1 m by 0.2 m: edges that panels of one size do not resolve.
fn brick() -> Mesh {
    let vertices = (0..8)
        .map(|k: i32| {
            [if k & 1 > 0 { 1.0 } else { -1.0 }, if k & 2 > 0 { 0.5 } else { -0.5 }, if k & 4 > 0 { 0.1 } else { -0.1 }]
        })
        .collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = sides.into_iter().flat_map(|[a, b, c, d]| [Panel::triangle(a, b, c), Panel::triangle(a, c, d)]);
    Mesh { vertices, panels: halves.collect() }
}

struct OnePart {
    mesh: Mesh,
    is_foreign: bool,
}

impl OnePart {
    fn of(mesh: Mesh) -> Self {
        Self { mesh, is_foreign: true }
    }
}

impl Levels for OnePart {
    fn count(&self) -> usize {
        4
    }

    fn panels(&self, number: usize) -> Result<usize, RefineError> {
        Ok(self.mesh.panels.len() << (2 * number))
    }

    fn problem(&self, number: usize) -> Result<(f64, Problem), RefineError> {
        let finer = (0..number).fold(self.mesh.clone(), |mesh, _| subdivided(&mesh));
        let parts = vec![0; finer.panels.len()];
        Ok((0.5_f64.powi(number as i32), Problem::of_parts(&finer, &parts, &[Frame::at([0.0; 3])], &[])))
    }

    fn is_foreign(&self) -> bool {
        self.is_foreign
    }
}

#[test]
fn one_part_has_the_uncertainty_of_the_body() {
    let wanted = Wanted { tolerance: 0.0, most_panels: 12 << 6, ..Wanted::default() };
    let body = refine(&Family::Mesh(brick()), &wanted, &|_| {}).unwrap();
    let size = Size { volume_m3: 0.4, length_m: 2.0 };
    let parts = refine_parts(&OnePart::of(brick()), size, &wanted, &|_| {}).unwrap();
    for i in 0..6 {
        for j in 0..6 {
            let root = (body.value[i][i] * body.value[j][j]).sqrt();
            let apart = (body.uncertainty[i][j] - parts.uncertainty[i][j]).abs();
            assert!(
                apart < 1e-9 * root,
                "{i} {j}: {} as a body, {} as a part",
                body.uncertainty[i][j],
                parts.uncertainty[i][j]
            );
        }
    }
    // Of a mesh that was made for its body extrapolation alone would count.
    let made = refine_parts(&OnePart { is_foreign: false, ..OnePart::of(brick()) }, size, &wanted, &|_| {}).unwrap();
    let widened = |i: usize, j: usize| parts.uncertainty[i][j] > 1.5 * made.uncertainty[i][j];
    assert!((0..6).any(|i| (0..6).any(|j| widened(i, j))), "{:?}", made.uncertainty);
}
