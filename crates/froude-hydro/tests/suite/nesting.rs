//! The nesting of DESIGN.md: restricted general models give the simple model's force.

use crate::common::{index_of, setting};
use froude_hydro::DragModel::{self, F1, F2, F3, F4, F5, F6};
use froude_hydro::{Factor, MAX_COEFFICIENTS, Setting};
use proptest::prelude::*;

/// Weights of the coefficients that a restriction names; their sum is zero.
type Row<'a> = &'a [(&'a str, f64)];

/// All nested pairs, with the number of restrictions.
const NESTED: [(DragModel, DragModel, usize); 10] = [
    (F1, F2, 2),
    (F1, F3, 6),
    (F1, F4, 8),
    (F2, F3, 4),
    (F2, F4, 6),
    (F3, F4, 2),
    (F5, F4, 3),
    (F6, F3, 6),
    (F6, F5, 5),
    (F6, F4, 8),
];

/// A basis of the null space of the restrictions, by Gauss–Jordan elimination.
fn null_space(rows: &[Vec<f64>], width: usize) -> Vec<Vec<f64>> {
    let mut m: Vec<Vec<f64>> = rows.to_vec();
    let mut pivots = Vec::new();
    let mut row = 0;
    for column in 0..width {
        let Some(best) = (row..m.len()).max_by(|&i, &j| m[i][column].abs().total_cmp(&m[j][column].abs())) else {
            continue;
        };
        if m[best][column].abs() < 1e-12 {
            continue;
        }
        m.swap(row, best);
        let pivot = m[row][column];
        m[row].iter_mut().for_each(|x| *x /= pivot);
        let pivot_row = m[row].clone();
        for (i, other) in m.iter_mut().enumerate() {
            if i != row {
                let factor = other[column];
                other.iter_mut().zip(&pivot_row).for_each(|(x, p)| *x -= factor * p);
            }
        }
        pivots.push(column);
        row += 1;
    }
    assert_eq!(pivots.len(), rows.len(), "the rows are independent");
    (0..width)
        .filter(|column| !pivots.contains(column))
        .map(|free| {
            let mut v = vec![0.0; width];
            v[free] = 1.0;
            for (i, &pivot) in pivots.iter().enumerate() {
                v[pivot] = -m[i][free];
            }
            v
        })
        .collect()
}

/// The linear restrictions under which `general` becomes `simple`, a row over the coefficients of `general` each: our derivation
/// from USR eq. 9–14. They hold for every number of links and depend on the geometry and on `v_ref`, not on the density.
///
/// | pair      | rows |
/// |-----------|------|
/// | f1 ⊂ f2   | `C^I = v_ref C^II`, per component |
/// | f2 ⊂ f3   | `2 G_T C_f = G_HTx C_fHT`, `2 G_N C_d = G_HTy C_dHT`, for I and II |
/// | f3 ⊂ f4   | `C_XY^I = C_XY^II = 0` |
/// | f6 ⊂ f5   | `C_f^I = C_f^II = C_d^I = C_XY^II = 0`, `C_d^II = C_dHT^II` |
/// | f5 ⊂ f4   | `C_fHT^I = C_dHT^I = C_XY^I = 0` |
/// | f6 ⊂ f3   | the rows of f6 ⊂ f5 without `C_XY`, and `C_fHT^I = C_dHT^I = 0` |
fn restrictions(simple: DragModel, general: DragModel, s: &Setting) -> Vec<Vec<f64>> {
    let one_link = Setting { n_links: 1.0, ..*s };
    let tie = |head_tail: Factor, link: Factor| -0.5 * head_tail.value(&one_link) / link.value(&one_link);
    let (along, across) = (tie(Factor::GHTx, Factor::LinksGT), tie(Factor::GHTy, Factor::LinksGN));
    let head_tail: &[Row] = &[
        &[("C_f_I", 1.0), ("C_fHT_I", along)],
        &[("C_f_II", 1.0), ("C_fHT_II", along)],
        &[("C_d_I", 1.0), ("C_dHT_I", across)],
        &[("C_d_II", 1.0), ("C_dHT_II", across)],
    ];
    let one_speed: &[Row] = &[&[("C_f_I", 1.0), ("C_f_II", -s.v_ref_m_s)], &[("C_d_I", 1.0), ("C_d_II", -s.v_ref_m_s)]];
    let no_linear_ends: &[Row] = &[&[("C_fHT_I", 1.0)], &[("C_dHT_I", 1.0)]];
    let areas_alone: &[Row] =
        &[&[("C_f_I", 1.0)], &[("C_f_II", 1.0)], &[("C_d_I", 1.0)], &[("C_d_II", 1.0), ("C_dHT_II", -1.0)]];
    let (cross_linear, cross_quadratic): (&[Row], &[Row]) = (&[&[("C_XY_I", 1.0)]], &[&[("C_XY_II", 1.0)]]);
    let rows = match simple {
        F1 if general == F2 => vec![one_speed],
        F1 => vec![head_tail, one_speed, cross_linear, cross_quadratic],
        F2 => vec![head_tail, cross_linear, cross_quadratic],
        F3 => vec![cross_linear, cross_quadratic],
        F5 => vec![no_linear_ends, cross_linear],
        F6 => vec![areas_alone, no_linear_ends, cross_linear, cross_quadratic],
        F4 => unreachable!("f4 is nested in nothing"),
    };
    // What the general model does not have drops out.
    let of_general = |row: &Row| {
        let mut out = vec![0.0; general.coefficients().len()];
        for (name, weight) in *row {
            out[index_of(general, name)?] = *weight;
        }
        Some(out)
    };
    rows.concat().iter().filter_map(of_general).collect()
}

/// The simple model's coefficients that reproduce the general model's force at unit
/// speeds, read off two motions per component.
fn matched(simple: DragModel, general: DragModel, s: &Setting, c: &[f64]) -> Vec<f64> {
    let mut unit_slow = [0.0; MAX_COEFFICIENTS];
    let mut unit_fast = [0.0; MAX_COEFFICIENTS];
    simple.regressor(s, [0.5, 0.0], &mut unit_slow);
    let fx = |v: f64| general.force_n(s, [v, 0.0], c)[0];
    let fy = |v: f64| general.force_n(s, [0.0, v], c)[1];
    let mut out = vec![0.0; simple.coefficients().len()];
    let x_of = |v: f64, out: &mut [f64]| simple.regressor(s, [v, 0.0], out);
    let y_of = |v: f64, out: &mut [f64]| simple.regressor(s, [0.0, v], out);
    match simple {
        F1 | F6 => {
            x_of(0.5, &mut unit_slow);
            out[0] = fx(0.5) / unit_slow[0];
            y_of(0.5, &mut unit_slow);
            out[1] = fy(0.5) / unit_slow[1];
        }
        F2 => {
            // f(v) = g (A v + B v²): two speeds give A and B.
            for (axis, f) in [(0, &fx as &dyn Fn(f64) -> f64), (1, &fy)] {
                let of = |v: f64, out: &mut [f64]| if axis == 0 { x_of(v, out) } else { y_of(v, out) };
                of(0.5, &mut unit_slow);
                of(1.0, &mut unit_fast);
                let (a, b) = (unit_slow[axis], unit_slow[axis + 2]);
                let (d, e) = (unit_fast[axis], unit_fast[axis + 2]);
                let det = a * e - b * d;
                out[axis] = (f(0.5) * e - b * f(1.0)) / det;
                out[axis + 2] = (a * f(1.0) - d * f(0.5)) / det;
            }
        }
        // Their columns are columns of f4: same names, same values.
        F3 | F5 => {
            for (value, info) in out.iter_mut().zip(simple.coefficients()) {
                *value = c[index_of(general, info.name).unwrap()];
            }
        }
        F4 => unreachable!("f4 is nested in nothing"),
    }
    out
}

proptest! {
    /// One vector that satisfies the restrictions: the simple model gives the same
    /// force, with the same coefficients, for every number of links.
    #[test]
    fn restricted_general_model_is_the_simple_model(
        pair in 0..NESTED.len(),
        weights in prop::collection::vec(-2.0..2.0f64, MAX_COEFFICIENTS),
        v_ref in 0.2..2.0f64,
        velocities in prop::collection::vec([-1.0..1.0f64, -1.0..1.0f64], 8),
    ) {
        let (simple, general, _) = NESTED[pair];
        let base = Setting { v_ref_m_s: v_ref, ..setting(2.0) };
        let width = general.coefficients().len();
        let basis = null_space(&restrictions(simple, general, &base), width);
        prop_assert_eq!(basis.len(), simple.coefficients().len());
        let mut c = vec![0.0; width];
        for (vector, weight) in basis.iter().zip(&weights) {
            c.iter_mut().zip(vector).for_each(|(c, v)| *c += weight * v);
        }
        let simple_c = matched(simple, general, &base, &c);
        for k in [0.0, 1.0, 2.0, 5.0, 9.0] {
            let s = Setting { n_links: k, ..base };
            for &v in &velocities {
                let (f, g) = (simple.force_n(&s, v, &simple_c), general.force_n(&s, v, &c));
                // newtons; forces reach some hundred
                prop_assert!((f[0] - g[0]).abs() < 1e-10 && (f[1] - g[1]).abs() < 1e-10,
                    "{simple:?} in {general:?}, k = {k}: {f:?} {g:?}");
            }
        }
    }
}

/// As many as the simple model has fewer coefficients, and none mixes the components.
#[test]
fn restrictions_leave_the_coefficients_of_the_simple_model() {
    let s = setting(2.0);
    for (simple, general, n) in NESTED {
        let found = restrictions(simple, general, &s);
        assert_eq!(found.len(), n, "{simple:?} {general:?}");
        assert_eq!(general.coefficients().len() - n, simple.coefficients().len());
        for row in found {
            let mut axes = general.coefficients().iter().zip(row).filter(|(_, w)| *w != 0.0).map(|(info, _)| info.axis);
            let axis = axes.next().unwrap();
            assert!(axes.all(|other| other == axis), "{simple:?} {general:?}");
        }
    }
}

#[test]
fn restrictions_do_not_depend_on_links_or_density() {
    let rows = |s: &Setting| restrictions(F1, F4, s);
    let other = Setting { n_links: 9.0, density_kg_m3: 1000.0, ..setting(1.0) };
    for (a, b) in rows(&setting(1.0)).iter().zip(rows(&other)) {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}
