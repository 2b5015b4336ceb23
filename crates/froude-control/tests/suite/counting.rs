//! Counters: wraps and illegal transitions.

use froude_control::encoder::{QuadratureDecoder, Unwrap};
use proptest::prelude::*;

/// A then B: one period forward.
const FORWARD: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];

proptest! {
    #[test]
    fn the_unwrapped_count_is_the_sum_of_all_steps(start: u32, steps in prop::collection::vec(any::<i32>(), 0..200)) {
        let mut unwrap = Unwrap::default();
        let mut hardware = start;
        unwrap.step(hardware);
        for step in &steps {
            hardware = hardware.wrapping_add_signed(*step);
            prop_assert_eq!(unwrap.step(hardware), *step);
        }
        prop_assert_eq!(unwrap.count(), steps.iter().map(|s| i64::from(*s)).sum::<i64>());
    }

    #[test]
    fn the_decoder_counts_quarter_periods_either_way(start: u32, walk in prop::collection::vec(any::<bool>(), 0..300), phase in 0_usize..4) {
        let mut decoder = QuadratureDecoder::starting_at(start);
        let (mut at, mut sum) = (phase, 0_i32);
        decoder.step(FORWARD[at].0, FORWARD[at].1);
        for is_forward in walk {
            at = if is_forward { at + 1 } else { at + 3 } % 4;
            sum += if is_forward { 1 } else { -1 };
            decoder.step(FORWARD[at].0, FORWARD[at].1);
            prop_assert_eq!(decoder.count(), start.wrapping_add_signed(sum));
        }
        prop_assert_eq!(decoder.errors(), 0);
    }
}

#[test]
fn all_sixteen_transitions_are_decoded() {
    for (i, from) in FORWARD.iter().enumerate() {
        for (j, to) in FORWARD.iter().enumerate() {
            let mut decoder = QuadratureDecoder::starting_at(u32::MAX);
            decoder.step(from.0, from.1);
            decoder.step(to.0, to.1);
            let (count, errors) = match (4 + j - i) % 4 {
                0 => (u32::MAX, 0),
                1 => (0, 0),
                2 => (u32::MAX, 1),
                _ => (u32::MAX - 1, 0),
            };
            assert_eq!((decoder.count(), decoder.errors()), (count, errors), "{from:?} to {to:?}");
        }
    }
}
