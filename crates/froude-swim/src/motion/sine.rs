//! Sine and cosine of four angles side by side, as part of a kernel: calls of a library are compiled for the plain processor and break its lanes.
//!
//! An angle is taken to −π/4 to π/4 by multiples of π/2 in three parts, which is exact up to 10⁵ rad; there sine and cosine are polynomials. Larger angles go to the standard library one by
//! one.
//!
//! **Source.** Cody & Waite (1980), *Software Manual for the Elementary Functions* (reduction); Moshier's Cephes (the polynomials' coefficients).

use crate::drag_lanes::{Four, LANES};

/// π/2 in parts: 33 bits, 33 bits, the rest.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Largest angle of the reduction, rad.
const LARGEST: f64 = 1e5;
/// 1.5 · 2⁵²: a number that is added to it is rounded to a whole one, which its lowest bits hold.
const WHOLE: f64 = 6_755_399_441_055_744.0;

const SINE: [f64; 6] = [
    1.589_623_015_765_465_7e-10,
    -2.505_074_776_285_780_7e-8,
    2.755_731_362_138_572_5e-6,
    -1.984_126_982_958_954e-4,
    8.333_333_333_322_118e-3,
    -1.666_666_666_666_663e-1,
];
const COSINE: [f64; 6] = [
    -1.135_853_652_138_768_2e-11,
    2.087_570_084_197_473e-9,
    -2.755_731_417_929_674e-7,
    2.480_158_728_885_170_5e-5,
    -1.388_888_888_887_305_6e-3,
    4.166_666_666_666_659e-2,
];

/// Sines and cosines.
#[inline(always)]
pub(crate) fn sin_cos(angle: &Four) -> (Four, Four) {
    let (mut sin, mut cos) = ([0.0; LANES], [0.0; LANES]);
    let mut is_small = true;
    for k in 0..LANES {
        let x = angle[k];
        is_small &= x.abs() <= LARGEST;
        let shifted = x * std::f64::consts::FRAC_2_PI + WHOLE;
        let (quarters, bits) = (shifted - WHOLE, shifted.to_bits());
        let r = ((x - quarters * HALF_PI[0]) - quarters * HALF_PI[1]) - quarters * HALF_PI[2];
        let z = r * r;
        let mut s = SINE[0];
        let mut c = COSINE[0];
        for i in 1..6 {
            s = s * z + SINE[i];
            c = c * z + COSINE[i];
        }
        let s = (r + r * (z * s)).to_bits();
        let c = (1.0 - (0.5 * z - z * z * c)).to_bits();
        // Odd quarters change places, the second and third (of the cosine: first and second) the sign.
        let odd = (bits & 1).wrapping_neg();
        let (from_sin, from_cos) = ((s & !odd) | (c & odd), (c & !odd) | (s & odd));
        sin[k] = f64::from_bits(from_sin ^ ((bits & 2) << 62));
        cos[k] = f64::from_bits(from_cos ^ ((bits.wrapping_add(1) & 2) << 62));
    }
    if is_small { (sin, cos) } else { (angle.map(f64::sin), angle.map(f64::cos)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two units of the last place of one: half of it each by the reduction, the polynomial, its sum and the reference.
    #[test]
    fn sines_and_cosines_are_those_of_the_library() {
        let most = 2.0 * f64::EPSILON;
        for k in 0..200_000_i32 {
            let x = f64::from(k - 100_000);
            let angles = [x * 1e-4, x * 0.013, x, x * 123.0];
            let (sin, cos) = sin_cos(&angles);
            for i in 0..LANES {
                assert!((sin[i] - angles[i].sin()).abs() <= most, "{}", angles[i]);
                assert!((cos[i] - angles[i].cos()).abs() <= most, "{}", angles[i]);
            }
        }
        let (sin, cos) = sin_cos(&[f64::NAN, 0.0, -0.0, f64::INFINITY]);
        assert!(sin[0].is_nan() && cos[3].is_nan());
        assert_eq!((sin[1], cos[2]), (0.0, 1.0));
    }
}
