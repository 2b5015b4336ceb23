//! Laws of the force models: one expression, symmetry, scaling.

use crate::common::{published, setting};
use froude_hydro::{Body, CrossTerm, DragModel, Factor, Link, MAX_COEFFICIENTS, Motion, Setting};
use proptest::prelude::*;

fn any_model() -> impl Strategy<Value = DragModel> {
    (0..6usize).prop_map(|i| DragModel::ALL[i])
}

fn any_setting() -> impl Strategy<Value = Setting> {
    (
        (0.01..0.2f64, 0.01..0.2f64, 0.02..0.5f64, 0.0..0.1f64, 0.0..0.1f64),
        0..12u8,
        (990.0..1030.0f64, 0.1..2.0f64),
        prop_oneof![Just(None), (1e-4..0.1f64).prop_map(Some)],
    )
        .prop_map(|((a, b, l, head, tail), k, (density, v_ref), epsilon)| Setting {
            body: Body {
                link: Link { major_semi_axis_m: a, minor_semi_axis_m: b, half_length_m: l },
                head_side_area_m2: head,
                tail_side_area_m2: tail,
            },
            n_links: f64::from(k),
            density_kg_m3: density,
            v_ref_m_s: v_ref,
            cross_term: epsilon.map_or(CrossTerm::AsPrinted, |epsilon_m_s| CrossTerm::Smooth { epsilon_m_s }),
        })
}

fn any_velocity() -> impl Strategy<Value = [f64; 2]> {
    [-2.0..2.0f64, -2.0..2.0f64]
}

fn any_coefficients() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-3.0..3.0f64, MAX_COEFFICIENTS)
}

/// The law of DESIGN.md's table, written out by hand and apart from the crate's.
fn by_hand(model: DragModel, s: &Setting, v: [f64; 2], c: &[f64]) -> [f64; 2] {
    let (a, b, l) = (s.body.link.major_semi_axis_m, s.body.link.minor_semi_axis_m, s.body.link.half_length_m);
    let pi = std::f64::consts::PI;
    let (rho, k, n) = (s.density_kg_m3, s.n_links, s.n_links + 2.0);
    let (h, t) = (s.body.head_side_area_m2, s.body.tail_side_area_m2);
    let g_t = 0.5 * rho * pi * 0.5 * (a + b) * 2.0 * l;
    let g_n = 0.5 * rho * 2.0 * a * 2.0 * l;
    let (g_x, g_y, g_xy) = (0.5 * rho * pi * a * b, 0.5 * rho * (h + t), rho * a * l);
    let [x, y] = v;
    let (qx, qy) = (x * x.abs(), y * y.abs());
    let s_x = match s.cross_term {
        CrossTerm::AsPrinted => {
            if x < 0.0 {
                -1.0
            } else {
                1.0
            }
        }
        CrossTerm::Smooth { epsilon_m_s: e } => x / (x * x + e * e).sqrt(),
    };
    let (r_x, r_y) = match model {
        DragModel::F1 => (n * g_t * c[0] * (s.v_ref_m_s * x + qx), n * g_n * c[1] * (s.v_ref_m_s * y + qy)),
        DragModel::F2 => (n * g_t * (c[0] * x + c[2] * qx), n * g_n * (c[1] * y + c[3] * qy)),
        DragModel::F3 => (
            k * g_t * (c[0] * x + c[2] * qx) + g_x * (c[4] * x + c[6] * qx),
            k * g_n * (c[1] * y + c[3] * qy) + g_y * (c[5] * y + c[7] * qy),
        ),
        DragModel::F4 => (
            k * g_t * (c[0] * x + c[2] * qx)
                + g_x * (c[4] * x + c[6] * qx)
                + s_x * g_xy * (-c[8] * y.abs() + c[9] * y * y),
            k * g_n * (c[1] * y + c[3] * qy) + g_y * (c[5] * y + c[7] * qy),
        ),
        DragModel::F5 => (
            k * g_t * (c[0] * x + c[2] * qx) + g_x * c[4] * qx + s_x * g_xy * c[6] * y * y,
            k * g_n * (c[1] * y + c[3] * qy) + g_y * c[5] * qy,
        ),
        DragModel::F6 => (0.5 * rho * pi * a * b * c[0] * qx, 0.5 * rho * (h + k * 2.0 * l * 2.0 * a + t) * c[1] * qy),
    };
    [-r_x, -r_y]
}

/// Sum of the magnitudes of all terms: what rounding is relative to.
fn magnitude(model: DragModel, s: &Setting, v: [f64; 2], c: &[f64]) -> f64 {
    let mut unit = [0.0; MAX_COEFFICIENTS];
    model.regressor(s, v, &mut unit);
    unit.iter().zip(c).map(|(u, c)| (u * c).abs()).sum()
}

proptest! {
    /// The simulator uses `force_n`, the fit uses the regressor: one physics.
    #[test]
    fn force_is_regressor_times_coefficients(
        model in any_model(), s in any_setting(), v in any_velocity(), c in any_coefficients(),
    ) {
        let mut unit = [0.0; MAX_COEFFICIENTS];
        model.regressor(&s, v, &mut unit);
        let mut fitted = [0.0; 2];
        for (j, info) in model.coefficients().iter().enumerate() {
            fitted[info.axis.index()] += unit[j] * c[j];
        }
        let force = model.force_n(&s, v, &c);
        let bound = 1e-13 * magnitude(model, &s, v, &c);
        prop_assert!((force[0] - fitted[0]).abs() <= bound && (force[1] - fitted[1]).abs() <= bound);
    }

    /// And it is the law of the design, term by term.
    #[test]
    fn force_is_the_law_written_out_by_hand(
        model in any_model(), s in any_setting(), v in any_velocity(), c in any_coefficients(),
    ) {
        let (force, hand) = (model.force_n(&s, v, &c), by_hand(model, &s, v, &c));
        let bound = 1e-12 * magnitude(model, &s, v, &c);
        prop_assert!((force[0] - hand[0]).abs() <= bound, "{force:?} {hand:?}");
        prop_assert!((force[1] - hand[1]).abs() <= bound, "{force:?} {hand:?}");
    }

    /// A body that is its own mirror image: port and starboard, fore and aft.
    #[test]
    fn forces_mirror_with_the_motion(
        model in any_model(), s in any_setting(), v in any_velocity(), c in any_coefficients(),
    ) {
        let [f_x, f_y] = model.force_n(&s, v, &c);
        prop_assert_eq!(model.force_n(&s, [v[0], -v[1]], &c), [f_x, -f_y]);
        prop_assume!(v[0] != 0.0); // the printed form chooses a side there
        prop_assert_eq!(model.force_n(&s, [-v[0], v[1]], &c), [-f_x, f_y]);
    }

    /// Terms of second degree grow with the square of the speed, linear ones with it.
    #[test]
    fn each_term_has_its_degree_in_speed(
        model in any_model(), s in any_setting(), v in any_velocity(), factor in 0.01..100.0f64,
    ) {
        // The printed direction has no speed in it; the smooth one has.
        let s = Setting { cross_term: CrossTerm::AsPrinted, ..s };
        let (mut slow, mut fast) = ([0.0; MAX_COEFFICIENTS], [0.0; MAX_COEFFICIENTS]);
        model.regressor(&s, v, &mut slow);
        model.regressor(&s, [factor * v[0], factor * v[1]], &mut fast);
        for (j, info) in model.coefficients().iter().enumerate() {
            let expected = match info.motion {
                Motion::Linear | Motion::CrossLinear => factor * slow[j],
                Motion::Quadratic | Motion::CrossQuadratic => factor * factor * slow[j],
                Motion::LinearAndQuadratic => continue,
            };
            prop_assert!((fast[j] - expected).abs() <= 1e-12 * expected.abs());
        }
    }

    /// Density scales every force alike.
    #[test]
    fn force_is_proportional_to_density(
        model in any_model(), s in any_setting(), v in any_velocity(), c in any_coefficients(),
    ) {
        let twice = Setting { density_kg_m3: 2.0 * s.density_kg_m3, ..s };
        let (f, g) = (model.force_n(&s, v, &c), model.force_n(&twice, v, &c));
        let bound = 1e-12 * magnitude(model, &s, v, &c);
        prop_assert!((g[0] - 2.0 * f[0]).abs() <= bound && (g[1] - 2.0 * f[1]).abs() <= bound);
    }
}

#[test]
fn f6_is_quadratic_as_a_whole() {
    let s = setting(3.0);
    let [x, y] = DragModel::F6.force_n(&s, [0.3, -0.2], &[0.3363, 1.6066]);
    let [xx, yy] = DragModel::F6.force_n(&s, [0.6, -0.4], &[0.3363, 1.6066]);
    assert!((xx - 4.0 * x).abs() < 1e-14 && (yy - 4.0 * y).abs() < 1e-13);
}

#[test]
fn a_body_at_rest_feels_nothing() {
    for set in published() {
        for cross_term in [CrossTerm::AsPrinted, CrossTerm::Smooth { epsilon_m_s: 0.01 }] {
            let s = Setting { cross_term, ..setting(2.0) };
            let [x, y] = set.model.force_n(&s, [0.0, 0.0], &set.c);
            assert!(x == 0.0 && y == 0.0);
        }
    }
}

#[test]
fn smooth_form_tends_to_the_printed_one() {
    let s = setting(2.0);
    let smooth = Setting { cross_term: CrossTerm::Smooth { epsilon_m_s: 1e-9 }, ..s };
    for set in published() {
        for v in [[0.4, 0.3], [0.4, -0.3], [-0.4, 0.3], [-0.4, -0.3]] {
            let (p, q) = (set.model.force_n(&s, v, &set.c), set.model.force_n(&smooth, v, &set.c));
            assert!((p[0] - q[0]).abs() < 1e-12 && p[1] == q[1]);
        }
    }
}

#[test]
fn names_and_counts_are_those_of_the_paper() {
    let counts = DragModel::ALL.map(|model| model.coefficients().len());
    assert_eq!(counts, [2, 4, 8, 10, 7, 2]);
    for model in DragModel::ALL {
        assert_eq!(DragModel::from_name(model.name()), Some(model));
        for info in model.coefficients() {
            let is_linear = info.name.ends_with("_I");
            assert_eq!(info.unit, if is_linear { "m/s" } else { "1" }, "{}", info.name);
        }
    }
    assert_eq!(DragModel::from_name("F4"), None);
    assert_eq!(DragModel::from_name("f7"), None);
}

#[test]
fn factors_carry_modules_and_links() {
    let s = setting(3.0);
    let per_link = Factor::LinksGN.value(&s) / 3.0;
    assert!((Factor::ModulesGN.value(&s) - 5.0 * per_link).abs() < 1e-12);
    let side = Factor::GHTy.value(&s) + Factor::LinksGN.value(&s);
    assert!((Factor::SideY.value(&s) - side).abs() < 1e-12);
    assert_eq!(Factor::FrontalX.value(&s), Factor::GHTx.value(&s));
    assert_eq!(Factor::LinksGT.symbol(), "k*G_T");
}
