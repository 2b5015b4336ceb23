//! Convolution with weights that are mirrored about their centre, at the speed of the arithmetic.
//!
//! Samples left and right of an output are added (or subtracted) first, then weighted: half the products. Eight
//! neighbouring outputs share what they load. The sum runs from the centre outwards, so that small weights come last.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use crate::error::{SignalError, all_finite};
use crate::pages::zeros;
use froude_lanes::{Kernel, LANES, Lane, Vectors, eight, run};

/// Outputs of a stretch between two interleavings: with its neighbours it stays in the first-level cache.
const STRETCH: usize = 256;

/// How the weights right of the centre follow from those left of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parity {
    /// Equal.
    Even,
    /// Opposite; the centre is zero.
    Odd,
}

/// `y[i] = Σ_j weights[j] · x(i + j − ⌊weights/2⌋)`; `x` is `record` inside it and `beyond` outside.
///
/// # Errors
///
/// [`SignalError::NotFinite`].
///
/// # Panics
///
/// When the weights, an odd number of them, are not of that parity.
pub(crate) fn convolve(
    weights: &[f64],
    parity: Parity,
    beyond: impl Fn(isize) -> f64,
    record: &[f64],
) -> Result<Vec<f64>, SignalError> {
    let half = weights.len() / 2;
    let sign = if parity == Parity::Even { 1.0 } else { -1.0 };
    assert!((0..=half).all(|k| weights[half + k] == sign * weights[half - k]), "weights are not mirrored");
    let mut side = weights[half + 1..].to_vec();
    side.resize(half.next_multiple_of(LANES), 0.0);
    run(Convolve { centre: weights[half], side: &side, parity, beyond, record, out: zeros(record.len()) })
}

struct Convolve<'a, B> {
    centre: f64,
    /// Weights right of the centre, as many as fill registers.
    side: &'a [f64],
    parity: Parity,
    beyond: B,
    record: &'a [f64],
    /// As long as the record.
    out: Vec<f64>,
}

impl<B: Fn(isize) -> f64> Kernel for Convolve<'_, B> {
    type Output = Result<Vec<f64>, SignalError>;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Self::Output {
        let Self { centre, side, parity, beyond, record, out: mut whole_out } = self;
        let half = side.len();
        let mut lanes = vec![Lane::ZERO; STRETCH + 2 * half];
        let mut spare = Vec::new();
        for (block, out) in whole_out.chunks_mut(LANES * STRETCH).enumerate() {
            let first = block * LANES * STRETCH;
            finite_from(&record[first..first + out.len()], first)?;
            let stretch = out.len().div_ceil(LANES).next_multiple_of(LANES);
            let lanes = &mut lanes[..stretch + 2 * half];
            match first.checked_sub(half).and_then(|start| record.get(start..first + LANES * stretch + half)) {
                Some(samples) => interleave(vectors, samples, stretch, lanes),
                None => {
                    let sample = |i: isize| {
                        usize::try_from(i).ok().and_then(|i| record.get(i)).copied().unwrap_or_else(|| beyond(i))
                    };
                    for (i, lane) in (first as isize - half as isize..).zip(&mut *lanes) {
                        lane.0 = std::array::from_fn(|l| sample(i + (l * stretch) as isize));
                    }
                }
            }
            let whole = LANES * stretch;
            if out.len() == whole {
                sums(vectors, parity, centre, side, lanes, out);
            } else {
                spare.resize(whole, 0.0);
                sums(vectors, parity, centre, side, lanes, &mut spare);
                out.copy_from_slice(&spare[..out.len()]);
            }
        }
        Ok(whole_out)
    }
}

/// Refuses what is not finite; the samples begin at `first` of the record.
#[inline(always)]
fn finite_from(samples: &[f64], first: usize) -> Result<(), SignalError> {
    let are_finite = samples.iter().fold(true, |all, x| all & (x.abs() < f64::INFINITY));
    if are_finite {
        return Ok(());
    }
    all_finite(samples).map_err(|e| match e {
        SignalError::NotFinite { index } => SignalError::NotFinite { index: first + index },
        other => other,
    })
}

/// Lane `l` of place `t` becomes `samples[l·stretch + t]`.
#[inline(always)]
fn interleave<V: Vectors>(vectors: V, samples: &[f64], stretch: usize, lanes: &mut [Lane]) {
    let (own, shared) = lanes.split_at_mut(stretch);
    for (t, own) in (0..).step_by(LANES).zip(own.chunks_exact_mut(LANES)) {
        let mut rows = [&[0.0; LANES]; LANES];
        for (l, row) in rows.iter_mut().enumerate() {
            *row = eight(samples, l * stretch + t);
        }
        own.copy_from_slice(&vectors.turned(&rows));
    }
    // Beyond its own end a stretch runs into the next one, which is there already, a lane further.
    let last = &samples[LANES * stretch..];
    for t in 0..shared.len() {
        let next = if t < stretch { own[t] } else { shared[t - stretch] };
        let mut lane = [last[t]; LANES];
        lane[..LANES - 1].copy_from_slice(&next.0[1..]);
        shared[t] = Lane(lane);
    }
}

/// Outputs that share what they load: their sums and both of their sides, three registers each, stay in the processor.
const fn share<V: Vectors>() -> usize {
    if V::REGISTERS >= 32 { 8 } else { 4 }
}

#[inline(always)]
fn sums<V: Vectors>(vectors: V, parity: Parity, centre: f64, side: &[f64], lanes: &[Lane], out: &mut [f64]) {
    match (share::<V>(), parity) {
        (8, Parity::Even) => folded::<V, 8, false>(vectors, centre, side, lanes, out),
        (8, Parity::Odd) => folded::<V, 8, true>(vectors, centre, side, lanes, out),
        (_, Parity::Even) => folded::<V, 4, false>(vectors, centre, side, lanes, out),
        (_, Parity::Odd) => folded::<V, 4, true>(vectors, centre, side, lanes, out),
    }
}

/// `SHARE` outputs at a time: their sums and all that they load stay in registers.
#[inline(always)]
fn folded<V: Vectors, const SHARE: usize, const IS_ODD: bool>(
    vectors: V,
    centre: f64,
    side: &[f64],
    lanes: &[Lane],
    out: &mut [f64],
) {
    let (half, stretch) = (side.len(), out.len() / LANES);
    let centre = vectors.splat(centre);
    for group in (0..stretch).step_by(LANES) {
        let mut done = [Lane::ZERO; LANES];
        for (start, part) in (0..LANES).step_by(SHARE).flat_map(|start| (0..V::PARTS).map(move |p| (start, p))) {
            let under = &lanes[group + start..group + start + 2 * half + SHARE];
            let mut middle = [centre; SHARE];
            let mut sum = [centre; SHARE];
            for s in 0..SHARE {
                middle[s] = vectors.load(&under[half + s], part);
                sum[s] = vectors.multiply(centre, middle[s]);
            }
            // Sample `half + k + s` on the right lies in register `(k + s) % SHARE`, so that one is loaded a step; the left
            // likewise.
            let (mut right, mut left) = (middle, middle);
            for (c, taps) in side.as_chunks::<SHARE>().0.iter().enumerate() {
                for u in 0..SHARE {
                    let k = c * SHARE + u + 1;
                    right[u] = vectors.load(&under[half + k + SHARE - 1], part);
                    left[SHARE - 1 - u] = vectors.load(&under[half - k], part);
                    let tap = vectors.splat(taps[u]);
                    for s in 0..SHARE {
                        let (r, l) = (right[(u + 1 + s) % SHARE], left[(SHARE - 1 - u + s) % SHARE]);
                        let both = if IS_ODD { vectors.subtract(r, l) } else { vectors.add(r, l) };
                        sum[s] = vectors.multiply_add(tap, both, sum[s]);
                    }
                }
            }
            for s in 0..SHARE {
                vectors.store(&mut done[start + s], part, sum[s]);
            }
        }
        for (l, lane) in vectors.turned(&done.each_ref().map(|lane| &lane.0)).iter().enumerate() {
            out[l * stretch + group..l * stretch + group + LANES].copy_from_slice(&lane.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_lanes::Level;
    use proptest::prelude::*;

    proptest! {
        /// Sums of up to 121 products of numbers below 1, in another order.
        #[test]
        fn every_instruction_set_gives_the_sum_of_the_definition(
            x in prop::collection::vec(-1.0..1.0_f64, 1..6000),
            mut side in prop::collection::vec(-1.0..1.0_f64, 0..60),
            is_odd: bool,
        ) {
            let (parity, sign, centre) = if is_odd { (Parity::Odd, -1.0, 0.0) } else { (Parity::Even, 1.0, 0.5) };
            let sample = |i: isize| usize::try_from(i).ok().and_then(|i| x.get(i)).copied().unwrap_or(0.25);
            let plain = |i: isize| {
                let pairs = side.iter().zip(1..).map(|(w, k)| w * (sample(i + k) + sign * sample(i - k)));
                centre * sample(i) + pairs.sum::<f64>()
            };
            let expected: Vec<f64> = (0..x.len() as isize).map(plain).collect();
            side.resize(side.len().next_multiple_of(LANES), 0.0);
            let kernel = || {
                let out = vec![0.0; x.len()];
                Convolve { centre, side: &side, parity, beyond: |_| 0.25, record: &x, out }
            };
            for found in Level::available().map(|level| level.run(kernel())) {
                for (a, b) in found.unwrap().iter().zip(&expected) {
                    prop_assert!((a - b).abs() < 121.0 * f64::EPSILON, "{} {}", a, b);
                }
            }
        }
    }

    #[test]
    fn the_first_number_that_is_none_is_named() {
        let mut x = vec![1.0; 5000];
        (x[4321], x[4400]) = (f64::INFINITY, f64::NAN);
        let error = convolve(&[0.5, 0.0, 0.5], Parity::Even, |_| 0.0, &x).unwrap_err();
        assert_eq!(error, SignalError::NotFinite { index: 4321 });
    }
}
