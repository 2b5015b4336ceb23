//! Where a swimmer goes that leaves an unstable motion.
//!
//! The unstable motion is disturbed in all its numbers and followed period by period, until a period changes it by little beside its distance from where it began. Newton's method goes on from there. Motions
//! that repeat only after several periods are not found.
//!
//! **Units.** None: each number is measured by the size that the search of the motion has for it. **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, ch. 3 (bifurcations of periodic solutions).

/// By how much the unstable motion is disturbed.
const DISTURBED: f64 = 0.01;
/// It is near when a period changes it by less than this part of its distance from where it began.
const NEAR: f64 = 1e-4;

/// The motion near which a swimmer comes to rest that leaves `start`; `over` follows it over a period, `size` has the sizes of its numbers. `None` where it comes to no rest in so many periods.
pub(crate) fn settled(
    start: &[f64],
    size: &[f64],
    most_periods: usize,
    mut over: impl FnMut(&[f64]) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let apart = |a: &[f64], b: &[f64]| (0..a.len()).map(|k| ((a[k] - b[k]) / size[k]).abs()).fold(0.0, f64::max);
    let mut here: Vec<f64> = start.iter().zip(size).map(|(z, size)| z + DISTURBED * size).collect();
    for _ in 0..most_periods {
        let next = over(&here)?;
        if next.iter().any(|z| !z.is_finite()) {
            return None;
        }
        let change = apart(&next, &here);
        here = next;
        if change < NEAR * apart(&here, start) {
            return Some(here);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x ← x + r x − x³ leaves 0 for √r where r is below one; with r above one √r is unstable as well, and it alternates.
    #[test]
    fn a_pitchfork_is_left_for_its_stable_branch() {
        let over = |r: f64| move |z: &[f64]| Some(vec![z[0] + r * z[0] - z[0].powi(3)]);
        let found = settled(&[0.0], &[1.0], 4000, over(0.2)).unwrap();
        assert!((found[0] - 0.2_f64.sqrt()).abs() < 1e-3, "{found:?}");
        assert_eq!(settled(&[0.0], &[1.0], 4000, over(1.2)), None);
        assert_eq!(settled(&[0.0], &[1.0], 4000, |z| Some(vec![3.0 * z[0]])), None, "it grows for ever");
    }
}
