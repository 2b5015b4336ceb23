//! The nesting of DESIGN.md: restricted general models give the simple model's force.

use crate::common::setting;
use froude_hydro::DragModel::{self, F1, F2, F3, F4, F5, F6};
use froude_hydro::{MAX_COEFFICIENTS, Setting};
use proptest::prelude::*;

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

fn restrictions(simple: DragModel, general: DragModel, s: &Setting) -> Vec<Vec<f64>> {
    simple.restrictions_in(general, s).unwrap().rows().map(<[f64]>::to_vec).collect()
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
                *value = c[general.index_of(info.name).unwrap()];
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
        let violation = simple.restrictions_in(general, &base).unwrap().largest_violation(&c);
        prop_assert!(violation < 1e-12, "{violation:e}");

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

#[test]
fn nested_pairs_are_those_of_the_design_and_no_others() {
    let s = setting(2.0);
    for simple in DragModel::ALL {
        for general in DragModel::ALL {
            let listed = NESTED.iter().find(|(a, b, _)| (*a, *b) == (simple, general));
            let found = simple.restrictions_in(general, &s);
            assert_eq!(found.map(|r| r.len()), listed.map(|(_, _, n)| *n), "{simple:?} {general:?}");
            assert_eq!(simple.is_nested_in(general), listed.is_some());
            if let Some(found) = found {
                let freed = general.coefficients().len() - found.len();
                assert_eq!(freed, simple.coefficients().len());
                assert_eq!(found.general(), general);
            }
        }
    }
    assert!(F2.restrictions_in(F5, &s).is_none() && F5.restrictions_in(F2, &s).is_none());
}

#[test]
fn no_restriction_mixes_the_components() {
    let s = setting(1.0);
    for (simple, general, _) in NESTED {
        let found = simple.restrictions_in(general, &s).unwrap();
        for row in found.rows() {
            let axis = found.axis_of(row).unwrap();
            for (info, weight) in general.coefficients().iter().zip(row) {
                assert!(*weight == 0.0 || info.axis == axis);
            }
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
