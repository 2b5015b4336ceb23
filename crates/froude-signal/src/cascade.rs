//! A long record through recursive sections, eight stretches at a time.
//!
//! A recursion waits for its own result. Eight stretches of a record run side by side: each begins so far before its own
//! samples that where it began is forgotten, below the rounding of a number ([`LowPass::memory`]).

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use crate::butterworth::LowPass;
use froude_lanes::{Kernel, LANES, Lane, Vectors, eight, run};

/// A record is cut where a stretch is this many times as long as what it must forget.
const WORTH: usize = 2;

/// Samples of each of the eight stretches; `None` for a record that is too short.
///
/// An odd number of lines, so that the stretches do not compete for the same places of a cache.
pub(crate) fn stretch(low_pass: &LowPass, samples: usize) -> Option<usize> {
    let lines = samples / (LANES * LANES);
    let stretch = lines.checked_sub(1 - lines % 2)? * LANES;
    (stretch / WORTH >= low_pass.memory()).then_some(stretch)
}

/// Samples before a stretch, in whole registers; of a filter whose memory fits a stretch.
fn settling(low_pass: &LowPass) -> usize {
    low_pass.memory().next_multiple_of(LANES)
}

/// Filters the first `LANES · stretch` samples of `from` into `to`, first sample first, and leaves `states`, those of
/// the transposed form, where the last one left them. Returns whether all samples were finite: what is not never leaves
/// a recursion.
pub(crate) fn forward(
    low_pass: &LowPass,
    states: &mut [[f64; 2]],
    stretch: usize,
    from: &[f64],
    to: &mut [f64],
) -> bool {
    run(Stretches::<false> { low_pass, states, stretch, from: Some(from), to })
}

/// The same in place, the last `LANES · stretch` samples, last sample first.
pub(crate) fn backward(low_pass: &LowPass, states: &mut [[f64; 2]], stretch: usize, record: &mut [f64]) {
    let start = record.len() - LANES * stretch;
    run(Stretches::<true> { low_pass, states, stretch, from: None, to: &mut record[start..] });
}

struct Stretches<'a, const IS_BACKWARD: bool> {
    low_pass: &'a LowPass,
    states: &'a mut [[f64; 2]],
    stretch: usize,
    /// `None`: in place.
    from: Option<&'a [f64]>,
    to: &'a mut [f64],
}

/// Where the stretches lie.
#[derive(Clone, Copy)]
struct Source {
    stretch: usize,
    is_backward: bool,
}

impl Source {
    /// First of eight samples of a stretch, the `block`-th from its start in the direction of the pass.
    #[inline(always)]
    fn place(self, lane: usize, block: isize) -> usize {
        let (start, stretch) = ((lane * self.stretch) as isize, self.stretch as isize);
        let at = if self.is_backward { start + stretch - 8 * (block + 1) } else { start + 8 * block };
        at.clamp(0, LANES as isize * stretch - 8) as usize
    }

    /// Those eight of every stretch.
    #[inline(always)]
    fn read<V: Vectors>(self, vectors: V, record: &[f64], block: isize) -> [Lane; LANES] {
        let mut rows = [&[0.0; LANES]; LANES];
        for (l, row) in rows.iter_mut().enumerate() {
            *row = eight(record, self.place(l, block));
        }
        vectors.turned(&rows)
    }
}

/// Coefficients `b₀ b₁ b₂ a₁ a₂` and states of a section, in all lanes.
struct InLanes {
    coefficients: [f64; 5],
    states: [Lane; 2],
}

impl<const IS_BACKWARD: bool> Kernel for Stretches<'_, IS_BACKWARD> {
    /// Whether every stretch ended finite.
    type Output = bool;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> bool {
        let Self { low_pass, states, stretch, from, to } = self;
        // The stretch that the given states belong to, and the one that leaves them behind.
        let (begins, ends) = if IS_BACKWARD { (LANES - 1, 0) } else { (0, LANES - 1) };
        let source = Source { stretch, is_backward: IS_BACKWARD };
        let before = (settling(low_pass) / LANES) as isize;
        let first = source.read(vectors, from.unwrap_or(to), -before)[if IS_BACKWARD { LANES - 1 } else { 0 }];
        let mut sections: Vec<_> = (low_pass.sections.iter())
            .map(|s| InLanes {
                coefficients: [s.b[0], s.b[1], s.b[2], s.a[0], s.a[1]],
                states: s.steady_state().map(|z| Lane(first.0.map(|x| x * z))),
            })
            .collect();
        for block in -before..0 {
            through::<V, IS_BACKWARD>(vectors, &mut sections, &mut source.read(vectors, from.unwrap_or(to), block));
        }
        for (section, state) in sections.iter_mut().zip(&*states) {
            for (lane, &state) in section.states.iter_mut().zip(state) {
                lane.0[begins] = state;
            }
        }
        for block in 0..(stretch / LANES) as isize {
            let mut samples = source.read(vectors, from.unwrap_or(to), block);
            through::<V, IS_BACKWARD>(vectors, &mut sections, &mut samples);
            let rows = vectors.turned(&samples.each_ref().map(|lane| &lane.0));
            for (l, row) in rows.iter().enumerate() {
                let at = source.place(l, block);
                to[at..at + LANES].copy_from_slice(&row.0);
            }
        }
        for (section, state) in sections.iter().zip(states) {
            *state = section.states.map(|lane| lane.0[ends]);
        }
        sections.iter().all(|section| section.states.iter().all(|lane| lane.0.iter().all(|z| z.is_finite())))
    }
}

/// Eight neighbours in time through every section.
#[inline(always)]
fn through<V: Vectors, const IS_BACKWARD: bool>(vectors: V, sections: &mut [InLanes], samples: &mut [Lane; LANES]) {
    for section in sections {
        let [b0, b1, b2, a1, a2] = section.coefficients;
        let (b0, b1, b2) = (vectors.splat(b0), vectors.splat(b1), vectors.splat(b2));
        let (a1, a2) = (vectors.splat(a1), vectors.splat(a2));
        for part in 0..V::PARTS {
            let mut z1 = vectors.load(&section.states[0], part);
            let mut z2 = vectors.load(&section.states[1], part);
            for i in 0..LANES {
                let lane = &mut samples[if IS_BACKWARD { LANES - 1 - i } else { i }];
                let x = vectors.load(lane, part);
                let y = vectors.multiply_add(b0, x, z1);
                z1 = vectors.subtract_product(a1, y, vectors.multiply_add(b1, x, z2));
                z2 = vectors.subtract_product(a2, y, vectors.multiply(b2, x));
                vectors.store(lane, part, y);
            }
            vectors.store(&mut section.states[0], part, z1);
            vectors.store(&mut section.states[1], part, z2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::butterworth::low_pass;
    use crate::zero_phase::Pass;
    use froude_lanes::Level;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(30))]

        /// Numbers up to 1 and a gain of 1; a response that rings for some 60 samples gathers as many roundings.
        #[test]
        fn stretches_are_the_whole_record_with_every_instruction_set(
            x in prop::collection::vec(-1.0..1.0_f64, 5000..12_000), order in 1_usize..8, corner_hz in 60.0..400.0_f64,
        ) {
            let f = low_pass(order, corner_hz, 1000.0).unwrap();
            let length = stretch(&f, x.len());
            prop_assume!(length.is_some());
            let length = length.unwrap();
            let x = &x[..LANES * length];
            let rest = |value: f64| f.sections.iter().map(|s| s.steady_state().map(|z| z * value)).collect::<Vec<_>>();
            let (mut there, mut back) = (x.to_vec(), x.to_vec());
            Pass::at_rest(&f, 0.5).forward(&mut there);
            Pass::at_rest(&f, 0.5).backward(&mut back);
            let mut forward: Vec<_> = (0..3).map(|_| (rest(0.5), x.to_vec())).collect();
            let mut backward = forward.clone();
            let (mut free_forward, mut free_backward) = (forward.iter_mut(), backward.iter_mut());
            let mut ran = Vec::new();
            for level in Level::available() {
                let (states, to) = free_forward.next().unwrap();
                ran.push(level.run(Stretches::<false> { low_pass: &f, states, stretch: length, from: Some(x), to }));
                let (states, to) = free_backward.next().unwrap();
                level.run(Stretches::<true> { low_pass: &f, states, stretch: length, from: None, to });
            }
            prop_assert!(ran.iter().all(|is_finite| *is_finite));
            for (found, expected) in [(&forward, &there), (&backward, &back)] {
                for (_, found) in &found[..ran.len()] {
                    for (a, b) in found.iter().zip(expected) {
                        prop_assert!((a - b).abs() < 60.0 * f64::EPSILON, "{} {}", a, b);
                    }
                }
            }
        }
    }
}
