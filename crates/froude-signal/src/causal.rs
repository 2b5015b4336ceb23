//! Forward only: a filter that runs beside the measurement, with its phase.
//!
//! What it gives is late, by the phase of the filter: every channel that is compared with it must pass the same filter. Where the whole record is
//! there, [`zero_phase`](crate::zero_phase) delays nothing.
//!
//! # Source
//!
//! Conventions of `scipy.signal.sosfilt`: with `zi` zero, or `sosfilt_zi` times the first sample.

use crate::butterworth::LowPass;
use crate::error::{SignalError, all_finite};
use crate::zero_phase::Pass;

/// A filter on its way through a record, a chunk at a time; however the record is cut, the result is the same to the last bit.
#[derive(Debug, Clone)]
pub struct Causal(Pass);

impl Causal {
    /// As if the input had been `before` for ever: 0 for a filter that was empty, the first sample for one that has settled.
    #[must_use]
    pub fn new(low_pass: &LowPass, before: f64) -> Self {
        Self(Pass::at_rest(low_pass, before))
    }

    /// Filters what comes next, in place.
    pub fn pass(&mut self, samples: &mut [f64]) {
        self.0.forward(samples);
    }
}

/// Filters a whole record forward, as if the input had been `before` for ever.
///
/// # Errors
///
/// [`SignalError::NotFinite`].
pub fn filter(low_pass: &LowPass, record: &[f64], before: f64) -> Result<Vec<f64>, SignalError> {
    all_finite(record)?;
    let mut out = record.to_vec();
    Causal::new(low_pass, before).pass(&mut out);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::butterworth::low_pass;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn chunks_are_the_whole_bit_for_bit(
            x in prop::collection::vec(-1.0..1.0_f64, 1..2000), cut in 1_usize..300, order in 1_usize..8,
        ) {
            let f = low_pass(order, 60.0, 1000.0).unwrap();
            let mut parts = x.clone();
            let mut causal = Causal::new(&f, x[0]);
            parts.chunks_mut(cut).for_each(|chunk| causal.pass(chunk));
            prop_assert_eq!(filter(&f, &x, x[0]).unwrap(), parts);
        }
    }

    #[test]
    fn a_settled_filter_keeps_a_constant_and_an_empty_one_rises_to_it() {
        let f = low_pass(4, 60.0, 1000.0).unwrap();
        // Rounding through two sections whose states are some 1/(1 − |z|) ≈ 7 times the value.
        assert!(filter(&f, &[2.5; 300], 2.5).unwrap().iter().all(|y| (y - 2.5).abs() < 1e-13));
        let risen = filter(&f, &[2.5; 300], 0.0).unwrap();
        assert!(risen[0] < 0.01 && (risen[299] - 2.5).abs() < 1e-12, "{} {}", risen[0], risen[299]);
        assert_eq!(filter(&f, &[1.0, f64::NAN], 0.0), Err(SignalError::NotFinite { index: 1 }));
    }
}
