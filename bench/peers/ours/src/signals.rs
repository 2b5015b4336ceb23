//! Filters of a record of 10⁷ samples.

use std::path::Path;

use froude_signal::savitzky_golay::{self, Window};
use froude_signal::{butterworth, gaussian, zero_phase};

use crate::meter::{Row, measure};
use crate::{Outcome, make};

/// Every so many samples of a result are compared, and its ends.
const SHOWN: usize = 1009;

pub fn filter(dir: &Path, which: &str) -> Outcome<Row> {
    let record = make::read(&dir.join(make::RAW[0]))?;
    let low_pass = butterworth::low_pass(4, 10.0, 1000.0)?;
    let derivative = Window { samples: 41, order: 3, derivative: 1 };
    measure(5, || {
        let out = match which {
            "gaussian" => gaussian::smooth(&record, 20.0)?,
            "savitzky-golay" => savitzky_golay::filter(&record, derivative, 1e-3)?,
            _ => zero_phase::filter(&low_pass, &record)?,
        };
        let ends = out.iter().take(50).chain(out.iter().rev().take(50));
        Ok(ends.chain(out.iter().step_by(SHOWN)).copied().collect())
    })
}
