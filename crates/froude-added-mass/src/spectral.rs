//! Bodies of revolution: the matrix in azimuthal modes, to eight digits and more, and the meshes beside it as a check.

use crate::body_file::Shape;
use froude_panel::matrix::AddedMass;
use froude_panel::problem::Frame;
use froude_panel::refine::Refined;
use froude_panel::revolution::{Revolution, Stretch, rounded_cylinder, solve as modes, spheroid};

use super::record::entry_name;

/// A matrix over ρ about the middle of the body, and the uncertainty of its entries as part of √(A_ii A_jj).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectral {
    /// The matrix.
    pub added_mass: AddedMass,
    /// Its uncertainty.
    pub relative: f64,
}

/// Change from a coarse meridian to a fine one above which the meshes are better.
const USELESS: f64 = 1e-5;
/// Factor on that change, and the least uncertainty.
const SAFETY: f64 = 10.0;
const LEAST: f64 = 1e-9;
/// Halvings of the stretches towards the junctions of a capsule.
const HALVINGS: [usize; 2] = [8, 12];
/// Stretches at most.
const MOST: usize = 60;

/// Solves, where the body is one of revolution about x and its meridian smooth but for jumps of curvature.
#[must_use]
pub fn solve(shape: &Shape) -> Option<Spectral> {
    let (coarse, fine): (Vec<Stretch>, Vec<Stretch>) = match *shape {
        Shape::Ellipsoid { semi_axes_m: [a, b, c] } if b == c => {
            let count = ((a / b).max(b / a).ceil() as usize).clamp(4, MOST);
            (spheroid(a, b, count), spheroid(a, b, count + count / 2))
        }
        Shape::Capsule { length_m, section, end_m } if section.major_m == section.minor_m => {
            let (half, radius) = (0.5 * length_m - end_m, section.major_m);
            let middle = ((half / radius).ceil() as usize).clamp(4, MOST);
            let of = |halvings, middle| rounded_cylinder(half, radius, end_m, halvings, middle);
            (of(HALVINGS[0], middle), of(HALVINGS[1], middle + middle / 2))
        }
        _ => return None,
    };
    let (coarse, fine) = (modes(&coarse), modes(&fine));
    let change = [
        (coarse.axial_m3, fine.axial_m3, fine.axial_m3),
        (coarse.transverse_m3, fine.transverse_m3, fine.transverse_m3),
        // That of a sphere is zero: judged as a body that is as long as its volume is wide.
        (coarse.rotary_m5, fine.rotary_m5, fine.rotary_m5.max(fine.transverse_m3.powf(5.0 / 3.0))),
    ]
    .iter()
    .map(|(a, b, size)| ((a - b) / size).abs())
    .fold(0.0, f64::max);
    (change < USELESS).then(|| Spectral { added_mass: matrix(&fine), relative: (SAFETY * change).max(LEAST) })
}

/// Along x: surge is axial, sway and heave transverse, pitch and yaw turn end over end; the middle is the centre.
fn matrix(r: &Revolution) -> AddedMass {
    let diagonal = [r.axial_m3, r.transverse_m3, r.transverse_m3, 0.0, r.rotary_m5, r.rotary_m5];
    of_diagonal(diagonal)
}

/// About the middle of the body, in its axes.
fn of_diagonal(diagonal: [f64; 6]) -> AddedMass {
    let matrix = core::array::from_fn(|i| core::array::from_fn(|j| if i == j { diagonal[i] } else { 0.0 }));
    AddedMass { matrix, asymmetry: 0.0, frame: Frame::at([0.0; 3]) }
}

/// Puts the spectral values in the place of those from meshes; says how far these are from them.
///
/// Three numbers make the matrix, each with the relative uncertainty r: then −rA ≤ E ≤ rA for the error E in every frame, and by Cauchy and
/// Schwarz |E_ij| ≤ r √(A_ii A_jj) there.
pub fn replace(refined: &mut Refined, spectral: &Spectral, frame: &Frame) -> String {
    let middle = spectral.added_mass.matrix;
    let exact = spectral.added_mass.seen_from(frame).matrix;
    let mut furthest = (0.0_f64, 0);
    for i in 0..6 {
        if exact[i][i] > 0.0 {
            let ratio = (refined.value[i][i] - exact[i][i]).abs() / refined.uncertainty[i][i];
            if ratio > furthest.0 {
                furthest = (ratio, i);
            }
        }
    }
    let size = |i: usize| exact[i][i].max(1e-6 * refined.volume_m3.powf(if i < 3 { 1.0 } else { 5.0 / 3.0 }));
    refined.value = exact;
    refined.uncertainty = core::array::from_fn(|i| {
        core::array::from_fn(|j| if exact[i][j] == 0.0 { 0.0 } else { spectral.relative * (size(i) * size(j)).sqrt() })
    });
    let alike: [&[usize]; 3] = [&[0], &[1, 2], &[4, 5]];
    refined.shared =
        alike
            .map(|motions| {
                let part = core::array::from_fn(|i| {
                    if motions.contains(&i) { 0.5 * spectral.relative * middle[i][i] } else { 0.0 }
                });
                of_diagonal(part).seen_from(frame).matrix
            })
            .to_vec();
    refined.worst = spectral.relative;
    refined.is_within = true;
    refined.stopped = None;
    format!(
        "A body of revolution: the values are those of azimuthal modes on its meridian, the meshes a check: in {} they differ by {:.2} of their own \
         uncertainty.",
        entry_name((furthest.1, furthest.1)),
        furthest.0
    )
}
