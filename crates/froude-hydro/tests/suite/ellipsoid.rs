//! Ellipsoids: Lamb's quotients at 80 digits, the spheroids of the literature, discs, long cylinders, laws.

use std::f64::consts::PI;

use froude_hydro::ellipsoid::{ellipsoid_added_mass, ellipsoid_volume_m3};
use proptest::prelude::*;

/// Semi-axes, and the diagonal over ρ, as `ellipsoid_reference.py` prints them (mpmath 1.4.1).
#[rustfmt::skip]
const REFERENCE: &[([f64; 3], [f64; 6])] = &[
    ([1.0, 1.0, 1.0], [2.0943951023931955, 2.0943951023931955, 2.0943951023931955, 0.0, 0.0, 0.0]),
    ([3.0, 2.0, 1.0], [4.6560012697568818, 9.1619709065627375, 3.4218917658492723e+1, 9.6325576313697077, 3.5599830507687977e+1, 3.9141914749957226]),
    ([1.0, 2.0, 3.0], [3.4218917658492723e+1, 9.1619709065627375, 4.6560012697568818, 3.9141914749957226, 3.5599830507687977e+1, 9.6325576313697077]),
    ([2.0, 1.0, 3.0], [9.1619709065627375, 3.4218917658492723e+1, 4.6560012697568818, 3.5599830507687977e+1, 3.9141914749957226, 9.6325576313697077]),
    ([5.0, 1.0, 1.0], [1.2382309077616357, 1.8729348944434049e+1, 1.8729348944434049e+1, 0.0, 7.6219756099669968e+1, 7.6219756099669968e+1]),
    ([1.0, 1.0, 5.0], [1.8729348944434049e+1, 1.8729348944434049e+1, 1.2382309077616357, 7.6219756099669968e+1, 7.6219756099669968e+1, 0.0]),
    ([1.0, 1.0, 0.2], [1.1941504131050921e-1, 1.1941504131050921e-1, 2.5197731270494916, 3.12444118881301e-1, 3.12444118881301e-1, 0.0]),
    ([1.0, 1.0, 1e-06], [3.2898665287630222e-12, 3.2898665287630222e-12, 2.6666658731822375, 3.5555547230912742e-1, 3.5555547230912742e-1, 0.0]),
    ([1e-06, 1.0, 2.0], [6.9175816148265192, 7.5054962680762127e-12, 2.6402200676721937e-12, 2.9191650104765844e-12, 4.3913132821467834, 7.9522954736010775e-1]),
    ([1000000.0, 1.0, 2.0], [2.1954609977344498e-4, 1.675516081814504e+7, 4.1887902045425432e+6, 3.7699111842992696e+6, 8.377580408097129e+17, 3.3510321632438781e+18]),
    ([1000.0, 1.0, 0.001], [3.0549079079055349e-8, 4.188775946873881e-3, 4.188773852555159e+3, 4.1887807779248293e+2, 8.3774865023660285e+8, 8.3774823125976277e+2]),
    ([1.0, 1e-12, 1e-06], [5.9488377146602385e-35, 4.1887902047555992e-12, 4.1887902047576938e-24, 4.1887902047769654e-25, 8.377580409388033e-25, 8.3775804093922213e-13]),
    ([0.09, 0.0394, 0.0588], [1.9683335213265426e-4, 8.6696570996446477e-4, 4.0709523202854449e-4, 1.1401407363868222e-7, 1.630716750205339e-7, 6.6957145173475616e-7]),
    ([2.0, 1.0, 1.00000001], [1.759417989106991, 5.8995795713888974, 5.8995794594509572, 2.8552457068859795e-16, 2.0057928864915979, 2.0057929497472437]),
    ([2.0, 1.0, 1.001], [1.762327171269166, 5.9099395058862823, 5.8987426289437845, 2.8577583807244917e-6, 2.0027206871261306, 2.0090467860426468]),
    ([2.0, 1.000000000001, 1.0], [1.759417960025088, 5.8995794678199879, 5.8995794678311826, 2.8557534050506452e-24, 2.0057929172186259, 2.0057929172122997]),
    ([1.0, 1.00001, 0.99999], [2.0943951019503809, 2.0943574034147957, 2.0944328016384814, 4.4680428851073288e-10, 1.1170186997929499e-10, 1.1170027425217349e-10]),
    ([1.0, 0.999, 1.001], [2.0943906742461468, 2.0981663477119963, 2.0906265259322055, 4.4680428141836744e-6, 1.1162116441498047e-6, 1.1178073731480575e-6]),
    ([0.01, 1.0, 1.000001], [2.6587679611851817, 3.2738615410935705e-4, 3.2738566127056765e-4, 1.9636450220224472e-16, 3.5465360984653097e-1, 3.5465272415783296e-1]),
    ([1e-50, 2e-50, 3e-50], [3.4218917658492721e-149, 9.1619709065627372e-150, 4.656001269756882e-150, 3.9141914749957217e-250, 3.5599830507687973e-249, 9.6325576313697076e-250]),
    ([1e+60, 2e+59, 3e+60], [4.5819227172002857e+179, 1.1025906433297038e+181, 8.156178471559416e+178, 1.6785643387025237e+301, 5.8315640703334256e+299, 1.1185090948621118e+300]),
];

/// Up to 8 steps of a handful of roundings each, all terms positive: 1e-14 at most.
const ROUNDING: f64 = 1e-14;

fn relative(found: f64, expected: f64) -> f64 {
    if expected == 0.0 { found.abs() } else { (found / expected - 1.0).abs() }
}

#[test]
fn diagonals_are_those_of_lambs_quotients_at_80_digits() {
    let mut worst = 0.0_f64;
    for &(axes, reference) in REFERENCE {
        let found = ellipsoid_added_mass(axes).unwrap();
        for i in 0..6 {
            let error = relative(found[i], reference[i]);
            assert!(error <= ROUNDING, "{axes:?}, element {i}: {} for {}", found[i], reference[i]);
            worst = worst.max(error);
        }
    }
    println!("worst relative error {worst:.1e}");
}

/// Lamb's α₀, β₀, γ₀ from the coefficients of translation: `k = α₀/(2 − α₀)`.
fn lamb_integrals(axes: [f64; 3]) -> [f64; 3] {
    let found = ellipsoid_added_mass(axes).unwrap();
    [0, 1, 2].map(|i| {
        let k = found[i] / ellipsoid_volume_m3(axes);
        2.0 * k / (1.0 + k)
    })
}

/// Lamb (1918), R&M 623, p. 128: with `e² = 1 − 1/ratio²`, `γ₀ = 2(1−e²)/e³ (atanh e − e)` along the axis, `1 − γ₀/2` across it.
/// Cancels as 1e-16/e³ in `γ₀`, and once more by e² and e⁴ in turning.
#[test]
fn prolate_spheroids_are_those_of_lamb_1918() {
    for ratio in [1.5, 2.99, 6.0, 40.0, 1e3] {
        let volume = 4.0 / 3.0 * PI * ratio;
        let e = f64::sqrt(1.0 - 1.0 / (ratio * ratio));
        let gamma = 2.0 / (ratio * ratio) * ((ratio * (1.0 + e)).ln() - e) / (e * e * e);
        let (axial, across) = (volume * gamma / (2.0 - gamma), volume * (2.0 - gamma) / (2.0 + gamma));
        let (difference, q) = (1.0 - 1.5 * gamma, 2.0 - e * e);
        let turning =
            volume / 5.0 * (ratio * ratio + 1.0) * e * e * difference / (q * (2.0 - q * difference / (e * e)));
        for long in 0..3 {
            let mut axes = [1.0; 3];
            axes[long] = ratio;
            let found = ellipsoid_added_mass(axes).unwrap();
            for i in 0..3 {
                let (mass, inertia) = if i == long { (axial, 0.0) } else { (across, turning) };
                assert!(relative(found[i], mass) < 1e-13, "{ratio} {long} {i}");
                assert!(relative(found[3 + i], inertia) < 1e-13, "{ratio} {long} {i}");
            }
        }
    }
}

/// Lamb (1932), §108: an oblate spheroid of axes a, a, c has, with `e² = 1 − c²/a²`,
/// `γ₀ = 2/e² (1 − √(1−e²)/e · asin e)`. Cancels as 1e-16/e²: e from 0.6 up.
#[test]
fn oblate_spheroids_have_their_elementary_form() {
    for c in [0.8, 0.5, 0.1, 1e-3] {
        let e = f64::sqrt(1.0 - c * c);
        let gamma = 2.0 / (e * e) * (1.0 - c / e * e.asin());
        let found = lamb_integrals([1.0, 1.0, c]);
        assert!(relative(found[2], gamma) < 4e-15, "{c}: {found:?}, {gamma}");
        assert!(relative(found[0], 1.0 - 0.5 * gamma) < 4e-15 / (1.0 - 0.5 * gamma), "{c}");
    }
}

/// Lamb (1932), §102 and §108: a disc moving face-on `8/3 ρa³`, turning about a diameter `16/45 ρa⁵`. The
/// thickness c adds terms of order c/a.
#[test]
fn a_flat_spheroid_tends_to_the_disc() {
    for thickness in [1e-6, 1e-9, 1e-12] {
        let found = ellipsoid_added_mass([1.0, 1.0, thickness]).unwrap();
        assert!(relative(found[2], 8.0 / 3.0) < thickness + ROUNDING);
        assert!(relative(found[3], 16.0 / 45.0) < thickness + ROUNDING);
        assert!(relative(found[4], 16.0 / 45.0) < thickness + ROUNDING);
        assert_eq!(found[5], 0.0);
    }
}

/// In the middle of a long ellipsoid the flow is that of an elliptic cylinder: per length `ρπc²` across (Lamb 1932,
/// §71), `ρπ(b²−c²)²/8` rolling; along the axis the squared sections weigh 2/3·2a, their fourth powers 8/15·2a, and
/// with x² 2/15·2a³. What is left is of order `ln(a/b) (b/a)²`.
#[test]
fn a_long_ellipsoid_is_an_elliptic_cylinder_section_by_section() {
    let (a, b, c) = (1e4_f64, 1.0, 2.0);
    let found = ellipsoid_added_mass([a, b, c]).unwrap();
    let left = 20.0 / (a * a);
    let (sway, heave) = (PI * c * c, PI * b * b);
    let roll = PI * (b * b - c * c) * (b * b - c * c) / 8.0;
    let expected = [sway * 4.0 / 3.0 * a, heave * 4.0 / 3.0 * a, roll * 16.0 / 15.0 * a];
    for (element, expected) in [(1, expected[0]), (2, expected[1]), (3, expected[2])] {
        assert!(relative(found[element], expected) < left * 10.0, "{element}: {}", found[element] / expected - 1.0);
    }
    assert!(relative(found[4], heave * 4.0 / 15.0 * a * a * a) < 10.0 * left);
    assert!(relative(found[5], sway * 4.0 / 15.0 * a * a * a) < 10.0 * left);
}

#[test]
fn a_sphere_takes_half_its_mass_and_turns_freely() {
    let found = ellipsoid_added_mass([0.3; 3]).unwrap();
    let half = 0.5 * ellipsoid_volume_m3([0.3; 3]);
    assert!(found[..3].iter().all(|a| relative(*a, half) < 1e-15));
    assert_eq!(found[3..], [0.0; 3]);
}

#[test]
fn what_is_no_ellipsoid_is_refused() {
    for axes in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, f64::NAN, 1.0], [1.0, f64::INFINITY, 1.0], [1.0, 1.0, 1e-13]]
    {
        assert!(ellipsoid_added_mass(axes).is_err(), "{axes:?}");
    }
    assert_eq!(
        ellipsoid_added_mass([1.0, 2.0, 0.0]).unwrap_err().to_string(),
        "semi-axes [1.0, 2.0, 0.0] m are not those of an ellipsoid; all three must be finite and above 0, and the \
         longest at most 1e12 times the shortest"
    );
}

fn semi_axis() -> impl Strategy<Value = f64> {
    (-6.0..6.0_f64).prop_map(|power| 10.0_f64.powf(power))
}

proptest! {
    /// Lamb (1932), §114: `α₀ + β₀ + γ₀ = 2`, for the integrand is a derivative.
    #[test]
    fn the_three_integrals_add_up_to_two(a in semi_axis(), b in semi_axis(), c in semi_axis()) {
        let sum: f64 = lamb_integrals([a, b, c]).iter().sum();
        prop_assert!((sum - 2.0).abs() < 2.0 * ROUNDING, "{sum}");
    }

    /// Names of axes do not matter, and lengths scale: m³ and m⁵.
    #[test]
    fn axes_may_be_named_in_any_order_and_scale(a in semi_axis(), b in semi_axis(), c in semi_axis()) {
        let found = ellipsoid_added_mass([a, b, c]).unwrap();
        let turned = ellipsoid_added_mass([4.0 * b, 4.0 * c, 4.0 * a]).unwrap();
        for i in 0..3 {
            prop_assert!(relative(turned[i], 64.0 * found[(i + 1) % 3]) < ROUNDING);
            prop_assert!(relative(turned[3 + i], 1024.0 * found[3 + (i + 1) % 3]) < ROUNDING);
        }
    }

    /// A longer axis lets the fluid pass more easily: `k` falls along it.
    #[test]
    fn a_longer_body_takes_less_along(a in 0.01..100.0_f64, b in 0.01..100.0_f64, c in 0.01..100.0_f64) {
        let k = |axes| ellipsoid_added_mass(axes).unwrap()[0] / ellipsoid_volume_m3(axes);
        prop_assert!(k([1.01 * a, b, c]) < k([a, b, c]));
    }
}
