//! Bodies of revolution: the same equation in azimuthal modes on the meridian, to nine digits and more.
//!
//! φ and ∂φ/∂n of surge do not change around the axis (mode 0); those of motions across it go as cos θ (mode 1). For both the equation
//! (½ − K)φ = −S ∂φ/∂n becomes one on the meridian, its kernels complete elliptic integrals:
//! with R² = a − b cos α, a = r² + r′² + (z − z′)², b = 2 r r′,
//!
//! I₀ = ∫ dα/R, I₁ = ∫ cos α dα/R, J₀ = ∫ dα/R³, J₁ = ∫ cos α dα/R³ over a turn,
//!
//! S_m = r′ I_m/4π and K_m = r′/4π (n′·(x − x′)|_{α=0} J_m − n_r r L_m), L_m = ∫ cos mα (1 − cos α)/R³ dα = (I_m − (a − b) J_m)/b.
//!
//! Nyström with 16 Gauss–Legendre nodes a panel; panels are halved towards where the curvature jumps. On a panel around or beside a point its
//! integral is taken over stretches that shrink towards the point, the unknown interpolated. Source: our derivation; kernels from Gradshteyn
//! & Ryzhik 2.57.
//!
//! **Setting.** A smooth closed body (edges and flat ends are not for this module), unbounded fluid. **Frame.** z along the axis. **Units.** SI.

use core::cmp::Ordering;
use core::f64::consts::PI;

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

use crate::elliptic::complete;

/// Nodes of a panel.
const NODES: usize = 16;
/// Closer than this part of the panel the curvature stands for the difference of two rounded points.
const CLOSE: f64 = 1e-6;

/// Stretch, in halves of the panel, whose logarithm the rule takes as it is: 1e-2 of its length is the error.
const NOTHING: f64 = 1e-10;

/// The next stretch begins here. The rule converges as ρ⁻³² with ρ = 5.8, 2.4 and 1.9 for these ratios, against the stretch's length; the
/// long ones have the interpolation to follow as well.
fn shrunk(outer: f64) -> f64 {
    let ratio = if outer > 0.25 {
        0.5
    } else if outer > 0.01 {
        1.0 / 6.0
    } else {
        0.1
    };
    ratio * outer
}

/// A point of the meridian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeridianPoint {
    /// Distance from the axis, m.
    pub r_m: f64,
    /// Along it, m.
    pub z_m: f64,
    /// Unit normal into the fluid: its radial and axial part.
    pub normal: [f64; 2],
    /// Curvature of the meridian, 1/m; positive where it bends away from the fluid.
    pub curvature_1_m: f64,
    /// Length of the meridian for a unit of the parameter, m.
    pub speed_m: f64,
}

/// A smooth piece of the meridian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meridian {
    /// Part of an ellipse about the axis: centre, semi-axis along z, across, and the range of the angle from the lower pole, rad.
    Ellipse {
        /// z of the centre, m.
        centre_m: f64,
        /// Semi-axis along z, m.
        along_m: f64,
        /// Across, m.
        across_m: f64,
        /// From and to.
        angle_rad: [f64; 2],
    },
    /// A cylinder.
    Cylinder {
        /// Radius, m.
        radius_m: f64,
        /// From and to along z, m.
        z_m: [f64; 2],
    },
}

impl Meridian {
    /// The point at a parameter from 0 to 1.
    #[must_use]
    pub fn at(&self, t: f64) -> MeridianPoint {
        match *self {
            Self::Ellipse { centre_m, along_m, across_m, angle_rad: [from, to] } => {
                let angle = from + (to - from) * t;
                let (sin, cos) = angle.sin_cos();
                let (dr, dz) = (across_m * cos, along_m * sin);
                let length = dr.hypot(dz);
                MeridianPoint {
                    r_m: across_m * sin,
                    z_m: centre_m - along_m * cos,
                    normal: [dz / length, -dr / length],
                    curvature_1_m: along_m * across_m / length.powi(3),
                    speed_m: (to - from) * length,
                }
            }
            Self::Cylinder { radius_m, z_m: [from, to] } => MeridianPoint {
                r_m: radius_m,
                z_m: from + (to - from) * t,
                normal: [1.0, 0.0],
                curvature_1_m: 0.0,
                speed_m: to - from,
            },
        }
    }
}

/// A panel of the meridian: a stretch of a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The piece.
    pub piece: Meridian,
    /// From and to in its parameter.
    pub t: [f64; 2],
}

/// Matrix over ρ of a body of revolution about the origin of its frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Revolution {
    /// Along the axis, m³.
    pub axial_m3: f64,
    /// Across it, m³.
    pub transverse_m3: f64,
    /// Turning end over end about the origin, m⁵.
    pub rotary_m5: f64,
    /// Coupling of a motion along x with turning about y, m⁴.
    pub coupling_m4: f64,
    /// Unknowns of each mode.
    pub unknowns: usize,
}

/// A spheroid about the origin in equal panels.
#[must_use]
pub fn spheroid(along_m: f64, across_m: f64, panels: usize) -> Vec<Stretch> {
    let piece = Meridian::Ellipse { centre_m: 0.0, along_m, across_m, angle_rad: [0.0, PI] };
    (0..panels).map(|i| Stretch { piece, t: [i as f64 / panels as f64, (i + 1) as f64 / panels as f64] }).collect()
}

/// A cylinder with hemispheres, its middle at the origin: `half_length_m` of the cylinder, its radius, halvings towards the junctions
/// where the curvature jumps, equal panels in between.
#[must_use]
pub fn capsule(half_length_m: f64, radius_m: f64, halvings: usize, middle: usize) -> Vec<Stretch> {
    rounded_cylinder(half_length_m, radius_m, radius_m, halvings, middle)
}

/// The same with half-spheroids of length `end_m` at its ends.
#[must_use]
pub fn rounded_cylinder(half_length_m: f64, radius_m: f64, end_m: f64, halvings: usize, middle: usize) -> Vec<Stretch> {
    let cap = |centre_m, angle_rad| Meridian::Ellipse { centre_m, along_m: end_m, across_m: radius_m, angle_rad };
    let tube = Meridian::Cylinder { radius_m, z_m: [-half_length_m, half_length_m] };
    // 0, 1/2, 3/4, …, 1 − 2⁻ⁿ, 1: fine at the end.
    let towards_end: Vec<f64> = (0..=halvings).map(|i| 1.0 - 0.5_f64.powi(i as i32)).chain([1.0]).collect();
    let towards_start: Vec<f64> = towards_end.iter().rev().map(|t| 1.0 - t).collect();
    let part = 1.0 / middle as f64;
    let mut along: Vec<f64> = towards_start.iter().map(|t| t * part).collect();
    along.extend((2..middle).map(|i| i as f64 * part));
    along.extend(towards_end.iter().map(|t| 1.0 - (1.0 - t) * part));
    along.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    let stretches = |piece: Meridian, cuts: Vec<f64>| {
        cuts.windows(2).map(move |w| Stretch { piece, t: [w[0], w[1]] }).collect::<Vec<_>>()
    };
    let mut out = stretches(cap(-half_length_m, [0.0, 0.5 * PI]), towards_end);
    out.extend(stretches(tube, along));
    out.extend(stretches(cap(half_length_m, [0.5 * PI, PI]), towards_start));
    out
}

/// Solves both modes.
#[must_use]
pub fn solve(panels: &[Stretch]) -> Revolution {
    let rule = Rule::new();
    let nodes: Vec<(usize, f64, MeridianPoint, f64)> = panels
        .iter()
        .enumerate()
        .flat_map(|(p, s)| {
            let half = 0.5 * (s.t[1] - s.t[0]);
            rule.nodes.iter().zip(&rule.weights).map(move |(x, w)| {
                let point = s.piece.at(s.t[0] + half * (1.0 + x));
                (p, *x, point, w * half * point.speed_m)
            })
        })
        .collect();
    let n = nodes.len();
    // ½ − K and S, for modes 0 and 1.
    let mut left = [Mat::<f64>::zeros(n, n), Mat::zeros(n, n)];
    let mut single = [Mat::<f64>::zeros(n, n), Mat::zeros(n, n)];
    for (i, (own, _, x, _)) in nodes.iter().enumerate() {
        for (p, panel) in panels.iter().enumerate() {
            let first = p * NODES;
            let near = own.abs_diff(p) <= 1;
            let mut row = [[[0.0; NODES]; 2]; 2];
            if near {
                let at = match own.cmp(&p) {
                    Ordering::Equal => nodes[i].1,
                    Ordering::Less => -1.0,
                    Ordering::Greater => 1.0,
                };
                rule.close(panel, x, at, *own == p, &mut row);
            } else {
                for j in 0..NODES {
                    let (_, _, y, w) = nodes[first + j];
                    let kernels = kernels(x, &y, [x.r_m - y.r_m, x.z_m - y.z_m], None);
                    for m in 0..2 {
                        row[m][0][j] = w * kernels[m][0];
                        row[m][1][j] = w * kernels[m][1];
                    }
                }
            }
            for m in 0..2 {
                for j in 0..NODES {
                    single[m][(i, first + j)] = row[m][0][j];
                    left[m][(i, first + j)] = -row[m][1][j];
                }
            }
        }
        left[0][(i, i)] += 0.5;
        left[1][(i, i)] += 0.5;
    }
    // Normal velocities: surge n_z; across n_r cos θ; turning about y, (z n_x − x n_z) = (z n_r − r n_z) cos θ.
    let velocity = |k: usize, x: &MeridianPoint| match k {
        0 => x.normal[1],
        1 => x.normal[0],
        _ => x.z_m * x.normal[0] - x.r_m * x.normal[1],
    };
    let potential = |m: usize, modes: &[usize]| {
        let v = Mat::from_fn(n, modes.len(), |i, k| velocity(modes[k], &nodes[i].2));
        PartialPivLu::new(left[m].as_ref()).solve(-(&single[m] * v))
    };
    let (axial, across) = (potential(0, &[0]), potential(1, &[1, 2]));
    // −∫ φ v dS: a turn has 2π for mode 0 and π for mode 1.
    let force = |phi: &Mat<f64>, column: usize, mode: usize, turn: f64| -> f64 {
        -turn
            * nodes
                .iter()
                .enumerate()
                .map(|(i, (_, _, x, w))| w * x.r_m * phi[(i, column)] * velocity(mode, x))
                .sum::<f64>()
    };
    Revolution {
        axial_m3: force(&axial, 0, 0, 2.0 * PI),
        transverse_m3: force(&across, 0, 1, PI),
        rotary_m5: force(&across, 1, 2, PI),
        coupling_m4: 0.5 * (force(&across, 0, 2, PI) + force(&across, 1, 1, PI)),
        unknowns: n,
    }
}

/// S and K of modes 0 and 1 between a point and a ring; `difference` of their (r, z) apart, and (n′·(x − x′))/|x − x′|² where it is known better.
fn kernels(x: &MeridianPoint, y: &MeridianPoint, difference: [f64; 2], bend: Option<f64>) -> [[f64; 2]; 2] {
    let [dr, dz] = difference;
    let apart = dr * dr + dz * dz;
    let b = 2.0 * x.r_m * y.r_m;
    let (a, sum) = (apart + b, apart + 2.0 * b);
    let root = sum.sqrt();
    let (k, e) = complete(apart / sum);
    let i0 = 4.0 * k / root;
    // (a − b) J₀, and J₀ times what faces the point.
    let flat0 = 4.0 * e / root;
    let facing = bend.unwrap_or_else(|| (y.normal[0] * dr + y.normal[1] * dz) / apart);
    let (i1, flat1) = if b > 0.02 * a {
        ((a * i0 - root * root * flat0) / b, (a * flat0 - apart * i0) / b)
    } else {
        far(a, b, apart)
    };
    let scale = y.r_m / (4.0 * PI);
    let l0 = (i0 - flat0) / b;
    let l1 = (i1 - flat1) / b;
    let bent = y.normal[0] * x.r_m;
    [[scale * i0, scale * (facing * flat0 - bent * l0)], [scale * i1, scale * (facing * flat1 - bent * l1)]]
}

/// I₁ and (a − b) J₁ for b ≪ a, where the closed forms cancel: series in u = b/a to u⁷.
///
/// I₁ = Σ_odd C_k ∫ cos^{k+1} with (1 − u c)^{−1/2} = Σ (2k−1)!!/(2k)!! (u c)ᵏ, and likewise for the power −3/2.
fn far(a: f64, b: f64, apart: f64) -> (f64, f64) {
    let u = b / a;
    let (mut half, mut three) = (1.0, 1.0);
    let (mut i1, mut j1) = (0.0, 0.0);
    // ∫ cos^{k+1} over a turn: 2π (k)!!/(k+1)!! for odd k.
    let mut mean = PI;
    for k in 1..=9_i32 {
        let order = f64::from(k);
        half *= (order - 0.5) / order * u;
        three *= (order + 0.5) / order * u;
        if k % 2 == 1 {
            if k > 1 {
                mean *= order / (order + 1.0);
            }
            i1 += half * mean;
            j1 += three * mean;
        }
    }
    let root = a.sqrt();
    (i1 / root, apart * j1 / (a * root))
}

/// Gauss–Legendre nodes with the weights of interpolation between them.
struct Rule {
    nodes: [f64; NODES],
    weights: [f64; NODES],
    barycentric: [f64; NODES],
}

impl Rule {
    /// Newton on the Legendre polynomial.
    fn new() -> Self {
        let (mut nodes, mut weights) = ([0.0; NODES], [0.0; NODES]);
        let n = NODES as f64;
        for (i, (node, weight)) in nodes.iter_mut().zip(&mut weights).enumerate() {
            let mut x = -(PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..NODES {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = n * (x * p - before) / (x * x - 1.0);
                let step = p / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (*node, *weight) = (x, 2.0 / ((1.0 - x * x) * slope * slope));
        }
        let barycentric =
            core::array::from_fn(|i| (0..NODES).filter(|&j| j != i).map(|j| 1.0 / (nodes[i] - nodes[j])).product());
        Self { nodes, weights, barycentric }
    }

    /// Values of the Lagrange polynomials at a point of the panel, −1 to 1.
    fn interpolation(&self, x: f64) -> [f64; NODES] {
        if let Some(hit) = self.nodes.iter().position(|n| *n == x) {
            return core::array::from_fn(|i| f64::from(u8::from(i == hit)));
        }
        let terms: [f64; NODES] = core::array::from_fn(|i| self.barycentric[i] / (x - self.nodes[i]));
        let sum: f64 = terms.iter().sum();
        terms.map(|t| t / sum)
    }

    /// Integrals over a panel near the point: stretches that shrink towards `at`, the place in the panel nearest to it.
    fn close(&self, panel: &Stretch, x: &MeridianPoint, at: f64, is_own: bool, row: &mut [[[f64; NODES]; 2]; 2]) {
        let half = 0.5 * (panel.t[1] - panel.t[0]);
        let start = panel.piece.at(panel.t[0] + half * (1.0 + at));
        // A point beside the panel is as far from its end as this, in units of half the panel.
        let gap = if is_own {
            0.0
        } else {
            (x.r_m - start.r_m).hypot(x.z_m - start.z_m) / (half * start.speed_m).max(1e-300)
        };
        for side in [-1.0, 1.0] {
            let reach = if side < 0.0 { at + 1.0 } else { 1.0 - at };
            if reach <= 0.0 {
                continue;
            }
            let mut outer = reach;
            while outer > 0.0 {
                // What the rule leaves of the logarithm counts with the length of the stretch.
                let inner = if outer < (0.5 * gap).max(NOTHING) { 0.0 } else { shrunk(outer) };
                for (node, weight) in self.nodes.iter().zip(&self.weights) {
                    let offset = 0.5 * (inner + outer) + 0.5 * (outer - inner) * node;
                    let s = at + side * offset;
                    let y = panel.piece.at(panel.t[0] + half * (1.0 + s));
                    let step = half * side * offset * y.speed_m;
                    let bend = (is_own && offset < CLOSE).then_some(-0.5 * y.curvature_1_m);
                    let difference = if bend.is_some() {
                        // Along the tangent (−n_z, n_r): x lies behind y by the step.
                        [step * y.normal[1], -step * y.normal[0]]
                    } else {
                        [x.r_m - y.r_m, x.z_m - y.z_m]
                    };
                    let kernels = kernels(x, &y, difference, bend);
                    let w = 0.5 * (outer - inner) * weight * half * y.speed_m;
                    let lagrange = self.interpolation(s);
                    for m in 0..2 {
                        for (j, l) in lagrange.iter().enumerate() {
                            row[m][0][j] += w * kernels[m][0] * l;
                            row[m][1][j] += w * kernels[m][1] * l;
                        }
                    }
                }
                outer = inner;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernels against a sum over equal angles (exponentially exact for points apart), near the axis too.
    #[test]
    fn kernels_are_those_of_a_ring() {
        let point = |r_m: f64, z_m: f64, angle: f64| MeridianPoint {
            r_m,
            z_m,
            normal: [angle.sin(), -angle.cos()],
            curvature_1_m: 0.0,
            speed_m: 1.0,
        };
        for (x, y) in [
            (point(1.0, 0.0, 1.0), point(0.7, 1.1, 2.0)),
            (point(1e-3, 0.0, 0.1), point(0.9, 1.5, 2.0)),
            (point(0.8, 0.2, 1.0), point(2e-4, 2.0, 3.0)),
        ] {
            let n = 400;
            let mut expected = [[0.0; 2]; 2];
            for i in 0..n {
                let alpha = 2.0 * PI * f64::from(i) / f64::from(n);
                let d = [x.r_m - y.r_m * alpha.cos(), -y.r_m * alpha.sin(), x.z_m - y.z_m];
                let r = d.iter().map(|c| c * c).sum::<f64>().sqrt();
                let normal = [y.normal[0] * alpha.cos(), y.normal[0] * alpha.sin(), y.normal[1]];
                let facing: f64 = normal.iter().zip(d).map(|(n, d)| n * d).sum();
                let w = 2.0 * PI / f64::from(n) * y.r_m / (4.0 * PI);
                for (m, e) in expected.iter_mut().enumerate() {
                    let c = (m as f64 * alpha).cos();
                    e[0] += w * c / r;
                    e[1] += w * c * facing / r.powi(3);
                }
            }
            let found = kernels(&x, &y, [x.r_m - y.r_m, x.z_m - y.z_m], None);
            for m in 0..2 {
                for k in 0..2 {
                    let size = expected[0][k].abs();
                    assert!((found[m][k] - expected[m][k]).abs() < 1e-12 * size, "{m} {k}: {found:?} {expected:?}");
                }
            }
        }
    }
}
