//! Laws that leave most of the load unexplained, of every method.
//!
//! What a law leaves is the root mean square of its residuals over that of the load, as the record has it. Noise of a usual sensor leaves a few per cent: above a half something else moves the load.

use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::number::percent;

/// Part of a load that a law may leave.
const MOST: f64 = 0.5;

/// The loads of a recommended estimate that its law does not explain.
#[must_use]
pub fn unexplained(estimate: &Estimate) -> Vec<Finding> {
    let left = estimate.diagnostics.relative_residual.iter().filter(|(_, left)| estimate.recommended && **left > MOST);
    left.map(|(load, left)| {
        let law = &estimate.law.name;
        let text = format!("{law}, {load}: the law leaves {} of the load (root mean square)", percent(*left));
        if *left > 1.0 + 1e-9 {
            let text = format!("{text}: it is no better than no law; check the sign of the load and the fixed values");
            return Finding::new(Severity::Warning, "no-better-than-nothing", text);
        }
        let text = format!(
            "{text}: most of the load has another cause, so the coefficients and intervals cannot be trusted; look for a lag between motion and load, a variable missing from the \
             law, or a load that is mostly noise"
        );
        Finding::new(Severity::Warning, "mostly-unexplained", text)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recommended_law_that_leaves_most_of_a_load_is_reported() {
        let mut estimate = Estimate { recommended: true, ..Estimate::default() };
        let codes = |estimate: &Estimate| unexplained(estimate).into_iter().map(|f| f.code).collect::<Vec<_>>();
        for (left, code) in
            [(0.03, None), (0.49, None), (0.64, Some("mostly-unexplained")), (1.2, Some("no-better-than-nothing"))]
        {
            estimate.diagnostics.relative_residual.insert("f_x".to_owned(), left);
            assert_eq!(codes(&estimate), code.into_iter().map(str::to_owned).collect::<Vec<_>>(), "{left}");
        }
        estimate.recommended = false;
        assert!(codes(&estimate).is_empty());
    }
}
