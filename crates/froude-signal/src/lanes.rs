//! Short convolutions at the speed of the arithmetic.
//!
//! Eight stretches of a record are interleaved, so that every lane of a register works on its own stretch: loads
//! are aligned and each tap is fetched once for several outputs. The compiler makes the vectors; the function is
//! compiled for what the processor has, asked once a call.

/// Stretches worked on side by side.
const LANES: usize = 8;
/// Outputs of a stretch between two interleavings: with its taps it stays in the first-level cache.
const STRETCH: usize = 256;
/// Outputs that share the loading of a tap.
const SHARE: usize = 8;

/// Eight numbers, one of each stretch.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Lane([f64; LANES]);

/// `y[i] = Σ_j taps[j] · x(i + j − ⌊taps/2⌋)` for `i < n`; `x` is `record` inside it and `beyond` outside.
pub(crate) fn convolve(taps: &[f64], n: usize, beyond: impl Fn(isize) -> f64, record: &[f64]) -> Vec<f64> {
    let half = (taps.len() / 2) as isize;
    let mut out = vec![0.0; n];
    let mut lanes = vec![Lane([0.0; LANES]); STRETCH + taps.len() - 1];
    let mut results = vec![Lane([0.0; LANES]); STRETCH];
    let kernel = kernel();
    for (block, out) in out.chunks_mut(LANES * STRETCH).enumerate() {
        let first = (block * LANES * STRETCH) as isize - half;
        let stretch = out.len().div_ceil(LANES).next_multiple_of(SHARE);
        let lanes = &mut lanes[..stretch + taps.len() - 1];
        let results = &mut results[..stretch];
        for l in 0..LANES {
            let start = first + (l * stretch) as isize;
            let inside = usize::try_from(start).ok().and_then(|s| record.get(s..s + lanes.len()));
            match inside {
                Some(samples) => lanes.iter_mut().zip(samples).for_each(|(lane, &x)| lane.0[l] = x),
                None => lanes.iter_mut().zip(start..).for_each(|(lane, i)| {
                    lane.0[l] =
                        usize::try_from(i).ok().and_then(|i| record.get(i)).copied().unwrap_or_else(|| beyond(i));
                }),
            }
        }
        kernel(taps, lanes, results);
        for (l, out) in out.chunks_mut(stretch).enumerate() {
            for (out, result) in out.iter_mut().zip(&*results) {
                *out = result.0[l];
            }
        }
    }
    out
}

type Kernel = fn(&[f64], &[Lane], &mut [Lane]);

/// The kernel for this processor.
fn kernel() -> Kernel {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("fma") {
            return x86::avx512;
        }
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return x86::avx2;
        }
    }
    plain
}

fn plain(taps: &[f64], lanes: &[Lane], out: &mut [Lane]) {
    sums(taps, lanes, out, |a, b, c| a * b + c);
}

/// `SHARE` outputs at a time, all their sums in registers.
#[allow(clippy::inline_always)]
#[inline(always)]
fn sums(taps: &[f64], lanes: &[Lane], out: &mut [Lane], multiply_add: impl Fn(f64, f64, f64) -> f64 + Copy) {
    for (group, out) in out.chunks_exact_mut(SHARE).enumerate() {
        let under = &lanes[group * SHARE..group * SHARE + taps.len() + SHARE - 1];
        let mut sum = [[0.0; LANES]; SHARE];
        for (&tap, window) in taps.iter().zip(under.windows(SHARE)) {
            for s in 0..SHARE {
                for l in 0..LANES {
                    sum[s][l] = multiply_add(tap, window[s].0[l], sum[s][l]);
                }
            }
        }
        for (out, sum) in out.iter_mut().zip(sum) {
            *out = Lane(sum);
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod x86 {
    use super::{Lane, sums};

    /// Only to be called when the processor was asked: [`super::kernel`] does.
    pub(super) fn avx512(taps: &[f64], lanes: &[Lane], out: &mut [Lane]) {
        #[target_feature(enable = "avx512f,avx2,fma")]
        fn compiled(taps: &[f64], lanes: &[Lane], out: &mut [Lane]) {
            sums(taps, lanes, out, f64::mul_add);
        }
        // SAFETY: `kernel`, the only caller, has found both features.
        unsafe { compiled(taps, lanes, out) }
    }

    /// Only to be called when the processor was asked: [`super::kernel`] does.
    pub(super) fn avx2(taps: &[f64], lanes: &[Lane], out: &mut [Lane]) {
        #[target_feature(enable = "avx2,fma")]
        fn compiled(taps: &[f64], lanes: &[Lane], out: &mut [Lane]) {
            sums(taps, lanes, out, f64::mul_add);
        }
        // SAFETY: `kernel`, the only caller, has found both features.
        unsafe { compiled(taps, lanes, out) }
    }
}
