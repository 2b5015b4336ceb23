//! The closed form of [`crate::influence::near`] for many points at once: the same formulas in the panel's own plane, without branches.
//!
//! In axes ξ, η, ζ of the panel the distance of the foot from an edge is linear in ξ and η, the products of vectors in the solid angle are
//! those of distances, a·b = ½ (r_a² + r_b² − |a − b|²), and its numerators are ζ times the areas. What is left for a point are four roots,
//! four logarithms and one arctangent, in loops that the compiler turns into vector instructions; they are compiled once more for
//! processors with AVX2 and AVX-512. Logarithm and arctangent are those of Sun's fdlibm on their reduced ranges.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use froude_lanes::{Kernel, Vectors, run};
use froude_mesh::panel::Facet;
use froude_mesh::vector::{Vec3, cross, dot, norm, scale, sub};

/// A panel in its own axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polygon {
    centroid: Vec3,
    axes: [Vec3; 3],
    /// ξ, η of the corners; a triangle has its last one twice.
    corners: [[f64; 2]; 4],
    /// Lengths of the edges, and a, b, c with the distance of the foot from the edge a ξ + b η + c.
    edges: [[f64; 4]; 4],
    /// Twice the signed areas of the triangles 012 and 023.
    twice: [f64; 2],
    /// |0 − 2|².
    diagonal: f64,
}

/// Squares of the lengths below which an edge is none.
const POINT: f64 = 1e-300;

impl Polygon {
    /// Of a panel; a warped one is taken in its mean plane.
    pub(crate) fn of(facet: &Facet) -> Self {
        let n = facet.normal;
        // Along the longer diagonal, so that a triangle with its fourth corner on the third has one.
        let along = sub(facet.corners[2], facet.corners[0]);
        let flat = sub(along, scale(n, dot(along, n)));
        let x = scale(flat, 1.0 / norm(flat));
        let axes = [x, cross(n, x), n];
        let corners = facet.corners.map(|c| {
            let d = sub(c, facet.centroid);
            [dot(d, axes[0]), dot(d, axes[1])]
        });
        let edges = core::array::from_fn(|i| {
            let ([xi, eta], [xj, etaj]) = (corners[i], corners[(i + 1) % 4]);
            let (dx, dy) = (xj - xi, etaj - eta);
            let square = dx * dx + dy * dy;
            if square < POINT {
                return [0.0; 4];
            }
            let length = square.sqrt();
            let (a, b) = (-dy / length, dx / length);
            [length, a, b, -(a * xi + b * eta)]
        });
        let twice =
            |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let [a, b, c, d] = corners;
        let diagonal = (c[0] - a[0]).powi(2) + (c[1] - a[1]).powi(2);
        Self { centroid: facet.centroid, axes, corners, edges, twice: [twice(a, b, c), twice(a, c, d)], diagonal }
    }
}

/// Points as three rows of coordinates of one length.
#[derive(Debug, Clone, Default)]
pub(crate) struct Points {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
}

impl FromIterator<Vec3> for Points {
    fn from_iter<I: IntoIterator<Item = Vec3>>(points: I) -> Self {
        let mut out = Self::default();
        for p in points {
            out.x.push(p[0]);
            out.y.push(p[1]);
            out.z.push(p[2]);
        }
        out
    }
}

/// ∫ 1/r dS and ∫ ∂(1/r)/∂n_y dS of a panel at points, into two rows as long as theirs.
pub(crate) fn near(polygon: &Polygon, points: &Points, source: &mut [f64], dipole: &mut [f64]) {
    run(Near { polygon, points, source, dipole });
}

/// Adds to sums, `8 × points`, what strengths give there: `values` has the points of the first strength, then of the next.
pub(crate) fn accumulate(values: &[f32], strengths: &[[f64; 8]], sums: &mut [f64]) {
    run(Accumulate { values, strengths, sums });
}

struct Near<'a> {
    polygon: &'a Polygon,
    points: &'a Points,
    source: &'a mut [f64],
    dipole: &'a mut [f64],
}

impl Kernel for Near<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        near_plain(self.polygon, self.points, self.source, self.dipole);
    }
}

struct Accumulate<'a> {
    values: &'a [f32],
    strengths: &'a [[f64; 8]],
    sums: &'a mut [f64],
}

impl Kernel for Accumulate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        accumulate_plain(self.values, self.strengths, self.sums);
    }
}

#[inline(always)]
fn accumulate_plain(values: &[f32], strengths: &[[f64; 8]], sums: &mut [f64]) {
    let points = sums.len() / 8;
    // Four strengths at a time: a sum is read and written once for them.
    let (fours, rest) = strengths.as_chunks::<4>();
    let (of_fours, of_rest) = values.split_at(4 * points * fours.len());
    for (four, values) in fours.iter().zip(of_fours.chunks_exact(4 * points)) {
        let (a, values) = values.split_at(points);
        let (b, values) = values.split_at(points);
        let (c, d) = values.split_at(points);
        for (l, sums) in sums.chunks_exact_mut(points).enumerate() {
            let [p, q, r, s] = [four[0][l], four[1][l], four[2][l], four[3][l]];
            for ((((sum, a), b), c), d) in sums.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *sum += f64::from(*a) * p + f64::from(*b) * q + f64::from(*c) * r + f64::from(*d) * s;
            }
        }
    }
    for (strength, values) in rest.iter().zip(of_rest.chunks_exact(points)) {
        for (sums, strength) in sums.chunks_exact_mut(points).zip(strength) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += f64::from(*value) * strength;
            }
        }
    }
}

#[inline(always)]
fn near_plain(polygon: &Polygon, points: &Points, source: &mut [f64], dipole: &mut [f64]) {
    let n = source.len();
    let (px, py, pz) = (&points.x[..n], &points.y[..n], &points.z[..n]);
    let dipole = &mut dipole[..n];
    for i in 0..n {
        (source[i], dipole[i]) = at(polygon, px[i], py[i], pz[i]);
    }
}

#[inline(always)]
fn at(p: &Polygon, x: f64, y: f64, z: f64) -> (f64, f64) {
    let d = [x - p.centroid[0], y - p.centroid[1], z - p.centroid[2]];
    let [xi, eta, zeta] = [
        d[0] * p.axes[0][0] + d[1] * p.axes[0][1] + d[2] * p.axes[0][2],
        d[0] * p.axes[1][0] + d[1] * p.axes[1][1] + d[2] * p.axes[1][2],
        d[0] * p.axes[2][0] + d[1] * p.axes[2][1] + d[2] * p.axes[2][2],
    ];
    // Written out: the compiler turns loops within into no vectors.
    let squared = |k: usize| {
        let (u, v) = (xi - p.corners[k][0], eta - p.corners[k][1]);
        u * u + v * v + zeta * zeta
    };
    let square = [squared(0), squared(1), squared(2), squared(3)];
    let r = [square[0].sqrt(), square[1].sqrt(), square[2].sqrt(), square[3].sqrt()];
    let edge = |k: usize, both: f64| {
        let [length, a, b, c] = p.edges[k];
        // On the edge itself the logarithm is infinite and the distance zero.
        (a * xi + b * eta + c) * ln_ratio(both + length, (both - length).max(1e-30 * both))
    };
    let sum = edge(0, r[0] + r[1]) + edge(1, r[1] + r[2]) + edge(2, r[2] + r[3]) + edge(3, r[3] + r[0]);
    let inner = |i: usize, j: usize, edge: f64| 0.5 * (square[i] + square[j] - edge);
    let length = |k: usize| p.edges[k][0] * p.edges[k][0];
    let ac = inner(0, 2, p.diagonal);
    let (ab, bc) = (inner(0, 1, length(0)), inner(1, 2, length(1)));
    let (cd, ad) = (inner(2, 3, length(2)), inner(0, 3, length(3)));
    let height = zeta.abs();
    let first = [r[0] * r[1] * r[2] + ab * r[2] + ac * r[1] + bc * r[0], height * p.twice[0]];
    let second = [r[0] * r[2] * r[3] + ac * r[3] + ad * r[2] + cd * r[0], height * p.twice[1]];
    let half = arg(first[0] * second[0] - first[1] * second[1], first[0] * second[1] + first[1] * second[0]);
    let angle = 2.0 * half;
    let signed = if zeta == 0.0 { 0.0 } else { angle.copysign(zeta) };
    (sum - height * angle, signed)
}

/// Logarithm of a ratio of positive numbers, to rounding (fdlibm's polynomial), with a single division.
#[inline(always)]
fn ln_ratio(over: f64, under: f64) -> f64 {
    const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const MAGIC: u64 = 0x4330_0000_0000_0000;
    // over/under = 2ᵏ f/g, f and g between 1 and 2; k brings the quotient between √½ and √2.
    let (f, g) = (f64::from_bits(over.to_bits() & MANTISSA | ONE), f64::from_bits(under.to_bits() & MANTISSA | ONE));
    let exponent = |x: f64| f64::from_bits(x.to_bits() >> 52 | MAGIC);
    let k = exponent(over) - exponent(under);
    let is_high = f > core::f64::consts::SQRT_2 * g;
    let is_low = f < core::f64::consts::FRAC_1_SQRT_2 * g;
    let f = if is_high { 0.5 * f } else { f };
    let f = if is_low { 2.0 * f } else { f };
    let k = if is_high { k + 1.0 } else { k };
    let k = if is_low { k - 1.0 } else { k };
    let s = (f - g) / (f + g);
    let z = s * s;
    let odd = 1.479819860511658591e-01;
    let odd = odd * z + 1.531383769920937332e-01;
    let odd = odd * z + 1.818357216161805012e-01;
    let odd = odd * z + 2.222219843214978396e-01;
    let odd = odd * z + 2.857142874366239149e-01;
    let odd = odd * z + 3.999999999940941908e-01;
    let odd = odd * z + 6.666666666666735130e-01;
    k * core::f64::consts::LN_2 + (2.0 * s + s * z * odd)
}

/// Argument of re + i im without its sign, 0 to π (fdlibm's polynomial).
#[inline(always)]
fn arg(re: f64, im: f64) -> f64 {
    let (x, y) = (re.abs(), im.abs());
    let (low, high) = (x.min(y), x.max(y));
    let part = low / high.max(f64::MIN_POSITIVE);
    let is_large = part > 0.414_213_562_373_095;
    let t = if is_large { (low - high) / (low + high) } else { part };
    let z = t * t;
    let sum = 1.62858201153657823623e-02;
    let sum = sum * z - 3.65315727442169155270e-02;
    let sum = sum * z + 4.97687799461593236017e-02;
    let sum = sum * z - 5.83357013379057348645e-02;
    let sum = sum * z + 6.66107313738753120669e-02;
    let sum = sum * z - 7.69187620504482999495e-02;
    let sum = sum * z + 9.09088713343650656196e-02;
    let sum = sum * z - 1.11111104054623557880e-01;
    let sum = sum * z + 1.42857142725034663711e-01;
    let sum = sum * z - 1.99999999998764832476e-01;
    let sum = sum * z + 3.33333333333329318027e-01;
    let angle = t - t * z * sum + if is_large { FRAC_PI_4 } else { 0.0 };
    let angle = if y > x { FRAC_PI_2 - angle } else { angle };
    if re < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::influence;
    use froude_mesh::{Mesh, Panel};

    #[test]
    fn it_is_the_readable_form() {
        let vertices = vec![[0.0, 0.0, 0.1], [1.0, 0.1, 0.3], [1.2, 0.9, 0.4], [0.1, 0.7, 0.2]];
        let panels = vec![Panel::quad(0, 1, 2, 3), Panel::triangle(0, 1, 2), Panel::triangle(2, 1, 0)];
        let mesh = Mesh { vertices: vertices.clone(), panels };
        let mut points: Vec<Vec3> = Vec::new();
        for i in 0..400_u32 {
            let t = f64::from(i);
            let reach = 10.0_f64.powf(t / 200.0 - 1.0);
            points.push([0.6 + reach * (1.7 * t).sin(), 0.5 + reach * (2.3 * t).cos(), 0.25 + reach * (3.1 * t).sin()]);
        }
        let rows: Points = points.iter().copied().collect();
        for panel in &mesh.panels {
            let mut facet = Facet::of(&mesh, *panel);
            // In its plane: the readable form takes the corners as they are.
            for c in &mut facet.corners {
                let off = dot(sub(*c, facet.centroid), facet.normal);
                *c = sub(*c, scale(facet.normal, off));
            }
            let (mut s, mut k) = (vec![0.0; 400], vec![0.0; 400]);
            near(&Polygon::of(&facet), &rows, &mut s, &mut k);
            for (i, p) in points.iter().enumerate() {
                let expected = influence::near(&facet, *p);
                // Distances cancel where the panel is small from the point: its area over theirs is what is left.
                assert!((s[i] - expected.source).abs() < 2e-13, "{i}: {} {expected:?}", s[i]);
                assert!((k[i] - expected.dipole).abs() < 2e-13, "{i}: {} {expected:?}", k[i]);
            }
        }
    }

    #[test]
    fn logarithm_and_argument_are_those_of_the_library() {
        for i in 0..2000 {
            let x = 1.0 + 1e-6 * 1.02_f64.powi(i);
            assert!((ln_ratio(x * 0.37, 0.37) - x.ln()).abs() <= 6e-16 * (1.0 + x.ln()), "{x}");
            let (sin, cos) = (PI * f64::from(i) / 2000.0).sin_cos();
            assert!((arg(cos, sin) - sin.atan2(cos)).abs() < 1e-15, "{i}");
        }
    }
}
