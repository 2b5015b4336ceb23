//! Dissipativity of the published sets, as printed and in the smooth odd form.

use crate::common::{index_of, published, setting};
use froude_hydro::dissipation::VelocityGrid;
use froude_hydro::{CrossTerm, DragModel, Setting};

const RANGE_M_S: f64 = 1.0;

const FORMS: [CrossTerm; 3] =
    [CrossTerm::AsPrinted, CrossTerm::Smooth { epsilon_m_s: 0.01 }, CrossTerm::Smooth { epsilon_m_s: 0.1 }];

/// The largest `f·v / (|f||v|)` \[-\] over the grid: above zero the model drives the body, up to rounding of the sum (1e-12).
fn largest_cosine(model: DragModel, s: &Setting, c: &[f64]) -> f64 {
    let cosine = |v: [f64; 2]| {
        let f = model.force_n(s, v, c);
        let product = f[0].hypot(f[1]) * v[0].hypot(v[1]);
        if product > 0.0 { (f[0] * v[0] + f[1] * v[1]) / product } else { 0.0 }
    };
    VelocityGrid::over(RANGE_M_S).points().map(cosine).fold(-1.0, f64::max)
}

/// The design says that none of the published sets delivers power.
#[test]
fn every_published_set_dissipates_in_all_quadrants() {
    for set in published() {
        for k in 1..=9u8 {
            for cross_term in FORMS {
                let s = Setting { cross_term, ..setting(f64::from(k)) };
                let worst = largest_cosine(set.model, &s, &set.c);
                assert!(
                    worst <= 1e-12,
                    "{} Table {} {} with {k} links, {cross_term:?}: {worst:?}",
                    set.source,
                    set.table,
                    set.model.name()
                );
            }
        }
    }
}

/// Not only on the grid: at every speed in ±1 m/s the linear parts of f4 are a
/// quadratic form in (|v_x|, |v_y|) and the rest is above it, see the comment.
#[test]
fn published_f4_sets_dissipate_by_their_quadratic_forms() {
    // −P ≥ A x² − G_XY C_XY_I x y + B y² + (terms that are all ≥ 0), with x = |v_x|,
    // y = |v_y|, for either form of the cross term (its direction is at most 1 and has
    // the sign of v_x). 4AB ≥ (G_XY C_XY_I)² is enough at any speed.
    for set in published().iter().filter(|set| set.model == DragModel::F4) {
        for k in 1..=9u8 {
            let s = setting(f64::from(k));
            let value = |name: &str| {
                let j = index_of(set.model, name).unwrap();
                set.model.coefficients()[j].factor.value(&s) * set.c[j]
            };
            let a = value("C_f_I") + value("C_fHT_I");
            let b = value("C_d_I") + value("C_dHT_I");
            let cross = value("C_XY_I");
            assert!(
                4.0 * a * b >= cross * cross,
                "{} with {k} links: 4AB = {:.4}, cross² = {:.4} (kg²/s²)",
                set.source,
                4.0 * a * b,
                cross * cross
            );
            assert!(set.c.iter().all(|c| *c >= 0.0));
        }
    }
}

#[test]
fn a_set_made_to_violate_is_found() {
    let mut c = published().into_iter().find(|s| s.model == DragModel::F4).unwrap().c;
    let j = index_of(DragModel::F4, "C_XY_I").unwrap();
    c[j] = 0.5; // pushes forward ninety times as hard as published
    for cross_term in FORMS {
        let s = Setting { cross_term, ..setting(1.0) };
        let worst = largest_cosine(DragModel::F4, &s, &c);
        assert!(worst > 0.05, "{cross_term:?}: {worst:?}");
    }
}

#[test]
fn grid_fills_the_square_and_leaves_out_rest() {
    let points: Vec<[f64; 2]> = VelocityGrid::over(0.5).points().collect();
    assert_eq!(points.len(), 184 * 31);
    assert!(points.iter().all(|v| v[0].abs() <= 0.5 + 1e-15 && v[1].abs() <= 0.5 + 1e-15));
    assert!(points.iter().all(|v| *v != [0.0, 0.0]));
    assert!(points.contains(&[0.5, 0.0]) && points.contains(&[0.0, -0.5]));
    assert!(points.iter().any(|v| (v[0] - 0.5).abs() < 1e-12 && (v[1] - 0.5).abs() < 1e-12));
    let quadrant = |x: f64, y: f64| points.iter().filter(|v| v[0] * x > 0.0 && v[1] * y > 0.0).count();
    let n = quadrant(1.0, 1.0);
    assert!(n > 1000);
    assert_eq!([n; 3], [quadrant(-1.0, 1.0), quadrant(1.0, -1.0), quadrant(-1.0, -1.0)]);
}
