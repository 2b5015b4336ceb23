//! The matrix in other axes about another point, and what becomes of its uncertainty there.

use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_mesh::measure::Measure;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::vector::{Vec3, add, cross, scale};
use froude_panel::dense::solve;
use froude_panel::matrix::{AddedMass, congruent};
use froude_panel::mirror::{Mirror, positive_part};
use froude_panel::problem::{Frame, Problem, Solution};
use froude_panel::study::{Size, study};

type Matrix = [[f64; 6]; 6];
type Motion = [f64; 6];

const OCTANT: [Mirror; 3] = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];

fn of(matrix: &Matrix, frame: Frame) -> AddedMass {
    AddedMass { matrix: *matrix, asymmetry: 0.0, frame }
}

fn diagonal(entries: [f64; 6]) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { entries[i] } else { 0.0 }))
}

/// Numbers between 0 and 1 that look like chance, the same each time.
struct Draws(u64);

impl Draws {
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.draw()
    }

    /// Any axes, about a point within a reach along each.
    fn frame(&mut self, reach_m: f64) -> Frame {
        let [a, b, c] = [0; 3].map(|_| self.between(-3.1, 3.1).sin_cos());
        // About z, then y, then x; a proper rotation.
        let axes = [
            [a.1 * b.1, a.0 * b.1, -b.0],
            [a.1 * b.0 * c.0 - a.0 * c.1, a.0 * b.0 * c.0 + a.1 * c.1, b.1 * c.0],
            [a.1 * b.0 * c.1 + a.0 * c.0, a.0 * b.0 * c.1 - a.1 * c.0, b.1 * c.1],
        ];
        Frame { origin_m: [0; 3].map(|_| self.between(-reach_m, reach_m)), axes }
    }

    fn symmetric(&mut self) -> Matrix {
        let raw: Matrix = [[0.0; 6]; 6].map(|row| row.map(|_| self.between(-1.0, 1.0)));
        // Of the form BᵀB: a motion of any kind has a positive energy.
        congruent(&diagonal([1.0; 6]), &raw)
    }

    fn motion(&mut self) -> Motion {
        [0; 6].map(|_| self.between(-1.0, 1.0))
    }
}

fn times(a: &Matrix, v: &Motion) -> Motion {
    a.map(|row| row.iter().zip(v).map(|(a, v)| a * v).sum())
}

fn inner(a: &Motion, b: &Motion) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn halves(v: &Motion) -> [Vec3; 2] {
    [[v[0], v[1], v[2]], [v[3], v[4], v[5]]]
}

/// Load of the ideal fluid in steady motion: F = −ω × P, M = −ω × Q − v × P (Kirchhoff 1869; Lamb 1932, §124).
fn load(a: &Matrix, motion: &Motion) -> Motion {
    let [v, w] = halves(motion);
    let [p, q] = halves(&times(a, motion));
    let (force, moment) = (scale(cross(w, p), -1.0), scale(add(cross(w, q), cross(v, p)), -1.0));
    core::array::from_fn(|i| if i < 3 { force[i] } else { moment[i - 3] })
}

#[test]
fn an_ellipsoid_about_another_point_has_the_couplings_of_the_axes_that_are_asked_for() {
    let a = ellipsoid_added_mass([0.5, 0.2, 0.3]).unwrap();
    let here = of(&diagonal(a), Frame::at([0.0; 3]));
    // The point lies astern of the centre and below it; x forward, y port, z up.
    let (astern, below) = (0.3, 0.1);
    let at = Frame::at([-astern, 0.0, -below]);
    let up = here.seen_from(&at).matrix;
    let down = here.seen_from(&Frame { axes: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]], ..at }).matrix;
    // A motion with pitch rate q moves the centre forward by z q, one with roll rate p to port by −z p, one with yaw rate r by x r.
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    for (m, z) in [(up, below), (down, -below)] {
        close(m[0][4], z * a[0]);
        close(m[1][3], -z * a[1]);
        close(m[1][5], astern * a[1]);
        close(m[2][4], -astern * a[2]);
        close(m[3][5], -z * astern * a[1]);
        close(m[3][3], a[3] + z * z * a[1]);
        close(m[4][4], a[4] + z * z * a[0] + astern * astern * a[2]);
        close(m[5][5], a[5] + astern * astern * a[1]);
    }
}

#[test]
fn energy_and_load_of_a_motion_do_not_depend_on_the_frame() {
    let mut draws = Draws(1);
    for _ in 0..200 {
        let a = of(&draws.symmetric(), draws.frame(1.0));
        let other = draws.frame(3.0);
        let b = a.seen_from(&other);
        let there = draws.motion();
        let t = a.frame.motions_from(&other);
        let here = times(&t, &there);
        let energies = [inner(&here, &times(&a.matrix, &here)), inner(&there, &times(&b.matrix, &there))];
        assert!((energies[0] / energies[1] - 1.0).abs() < 1e-12, "{energies:?}");
        // A load does the same work on every motion: that there is Tᵀ of that here. Munk's moment is a part of it.
        let [own, moved] = [load(&a.matrix, &here), load(&b.matrix, &there)];
        for (j, found) in moved.iter().enumerate() {
            let expected: f64 = (0..6).map(|i| t[i][j] * own[i]).sum();
            assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

/// Entries on and above the diagonal.
fn upper(m: &Matrix) -> Vec<f64> {
    (0..6).flat_map(|i| (i..6).map(move |j| m[i][j])).collect()
}

/// What a change of frame does to the 21 entries: `21 × 21`, row by row.
fn induced(t: &Matrix) -> Vec<Vec<f64>> {
    let columns: Vec<Vec<f64>> = (0..6)
        .flat_map(|i| (i..6).map(move |j| (i, j)))
        .map(|(i, j)| {
            let mut unit = [[0.0; 6]; 6];
            (unit[i][j], unit[j][i]) = (1.0, 1.0);
            upper(&congruent(&unit, t))
        })
        .collect();
    (0..21).map(|r| columns.iter().map(|c| c[r]).collect()).collect()
}

/// L C Lᵀ.
fn moved(l: &[Vec<f64>], c: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let row = |a: &[f64], b: &[Vec<f64>]| -> Vec<f64> {
        b.iter().map(|b| a.iter().zip(b).map(|(a, b)| a * b).sum()).collect()
    };
    let half: Vec<Vec<f64>> = l.iter().map(|a| row(a, c)).collect();
    half.iter().map(|a| row(a, l)).collect()
}

#[test]
fn there_and_back_is_the_same_matrix_with_the_same_covariance() {
    let mut draws = Draws(2);
    for _ in 0..20 {
        let a = of(&draws.symmetric(), Frame::at([0.0; 3]));
        let other = draws.frame(2.0);
        let back = a.seen_from(&other).seen_from(&a.frame);
        for (found, expected) in upper(&back.matrix).iter().zip(upper(&a.matrix)) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let root: Vec<Vec<f64>> = (0..21).map(|_| (0..21).map(|_| draws.between(-1.0, 1.0)).collect()).collect();
        let one: Vec<Vec<f64>> = (0..21).map(|i| (0..21).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let covariance = moved(&root, &one);
        let [there, home] = [a.frame.motions_from(&other), other.motions_from(&a.frame)].map(|t| induced(&t));
        let again = moved(&home, &moved(&there, &covariance));
        for (found, expected) in again.iter().flatten().zip(covariance.iter().flatten()) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}

/// Similar meshes of an ellipsoid, as `froude added-mass` begins: an eighth is solved for.
fn solutions(axes: Vec3, levels: [usize; 3]) -> ([Solution; 3], Size) {
    let cells = (axes[0].max(0.5 * (axes[1] + axes[2])) / (axes[1] * axes[2]).sqrt() * 1.5).round().max(2.0) as usize;
    let body = SectionBody::ellipsoid(axes, cells);
    let meshes = levels.map(|m| body.mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh);
    let volume_m3 = Measure::of(&meshes[2]).volume_m3;
    let solved = meshes.map(|mesh| solve(&Problem::rigid(&positive_part(&mesh, &OCTANT).unwrap(), &OCTANT)));
    (solved, Size { volume_m3, length_m: 2.0 * axes.into_iter().fold(0.0, f64::max) })
}

/// The numerical uncertainty of an entry is found from its own values on the meshes, in the axes and about the point that it is asked for in:
/// it holds there as often as in the body's own axes. So does what a reader finds who takes values and covariance of the record there.
#[test]
fn the_uncertainty_holds_in_every_frame() {
    let mut draws = Draws(3);
    let levels = [2, 3, 4];
    let sizes = levels.map(|m| 1.0 / m as f64);
    // Entries that held, of all: in the body's own axes, in others by the rule, in others by covariance.
    let mut held = [[0_u32; 2]; 3];
    for _ in 0..16 {
        let width = draws.between(0.15, 0.9);
        let axes = [1.0, width, width * draws.between(0.55, 1.8)];
        let (solved, size) = solutions(axes, levels);
        let exact = of(&diagonal(ellipsoid_added_mass(axes).unwrap()), Frame::at([0.0; 3]));
        let own = study(&sizes, &solved, size).entries;
        let indices = || (0..6).flat_map(|i| (i..6).map(move |j| (i, j)));
        let mut covariance = vec![vec![0.0; 21]; 21];
        for (a, (i, j)) in indices().enumerate() {
            for (b, (k, l)) in indices().enumerate() {
                let half = 0.5 * own[i][j].extrapolated.uncertainty;
                assert!(own[i][j].shared.abs() <= half);
                covariance[a][b] = if a == b { half * half } else { own[i][j].shared * own[k][l].shared };
            }
        }
        for (i, j) in indices().filter(|(i, j)| i == j) {
            held[0][0] += u32::from(own[i][j].extrapolated.holds(exact.matrix[i][j]));
            held[0][1] += 1;
        }
        for _ in 0..12 {
            let frame = draws.frame(1.0);
            let there = solved.clone().map(|s| Solution {
                matrix: s.added_mass(0).seen_from(&frame).matrix.iter().map(|row| row.to_vec()).collect(),
                ..s
            });
            let entries = study(&sizes, &there, size).entries;
            let expected = exact.seen_from(&frame).matrix;
            let by_covariance = moved(&induced(&exact.frame.motions_from(&frame)), &covariance);
            for (a, (i, j)) in indices().enumerate() {
                let found = entries[i][j].extrapolated;
                held[1][0] += u32::from(found.holds(expected[i][j]));
                held[1][1] += 1;
                held[2][0] += u32::from((found.value - expected[i][j]).abs() <= 2.0 * by_covariance[a][a].sqrt());
                held[2][1] += 1;
            }
        }
    }
    let part = held.map(|[there, all]| f64::from(there) / f64::from(all));
    println!(
        "held: {:.4} own axes, {:.4} by the rule elsewhere, {:.4} by covariance elsewhere; {held:?}",
        part[0], part[1], part[2]
    );
    assert!(part.iter().all(|p| *p >= 0.95), "{part:?}");
}
