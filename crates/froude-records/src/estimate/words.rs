//! A coefficient in the words of a table cell.

use crate::estimate::{Coefficient, Status};
use crate::number::{MISSING, finite, half_width, interval, plain, plus_minus, short_form, usable};

/// The coefficient in words for a table cell: `0.0133(12)`, `0 (bound)`, `—`.
///
/// An undetermined coefficient is [`MISSING`], whatever stands in its value.
#[must_use]
pub fn coefficient(c: &Coefficient) -> String {
    let Some(value) = finite(c.value) else {
        return if c.status == Status::Excluded { "excluded" } else { MISSING }.to_owned();
    };
    let number = usable(c.standard_uncertainty).map_or_else(|| plain(value, 5), |u| short_form(value, u));
    match c.status {
        Status::Free => number,
        Status::AtBound => format!("{} (bound)", plain(value, 5)),
        Status::BoundContradicted => format!("{} (bound contradicted)", plain(value, 5)),
        Status::Fixed => format!("{number} (fixed)"),
        Status::Prior => format!("{number} (prior)"),
        Status::Excluded => "excluded".to_owned(),
        Status::Undetermined => MISSING.to_owned(),
    }
}

/// The coefficient with its expanded uncertainty: `0.0133 ± 0.0024` if its 95 % interval is symmetric about the value, otherwise the short form with the interval.
/// Without an interval, the short form alone.
#[must_use]
pub fn coefficient_expanded(c: &Coefficient) -> String {
    let is_found = matches!(c.status, Status::Free | Status::Prior);
    let Some(value) = finite(c.value).filter(|_| is_found) else { return coefficient(c) };
    let number = usable(c.standard_uncertainty).map_or_else(|| plain(value, 5), |u| short_form(value, u));
    // There is no U without an interval, even if a standard uncertainty is known.
    let has_width = |[low, high]: &[f64; 2]| (high / 2.0 - low / 2.0).is_finite() && high / 2.0 - low / 2.0 > 0.0;
    let Some(ends) = c.interval_95.filter(has_width) else { return number };
    half_width(value, ends).map_or_else(|| format!("{number} {}", interval(ends)), |half| plus_minus(value, half))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_undetermined_coefficient_is_a_dash_whatever_it_holds() {
        let mut c =
            Coefficient { standard_uncertainty: Some(0.1), ..Coefficient::of(Some(0.0), "1", Status::Undetermined) };
        assert_eq!(coefficient(&c), MISSING);
        assert_eq!(coefficient_expanded(&c), MISSING);
        c.status = Status::AtBound;
        assert_eq!(coefficient(&c), "0 (bound)");
        c.status = Status::Free;
        c.value = Some(0.0133);
        c.standard_uncertainty = Some(0.0012);
        assert_eq!(coefficient_expanded(&c), "0.0133(12)");
        c.interval_95 = Some([0.0107, 0.0159]);
        assert_eq!(coefficient_expanded(&c), "0.0133 ± 0.0026");
        c.interval_95 = Some([0.0, 0.0159]);
        assert_eq!(coefficient_expanded(&c), "0.0133(12) [0, 0.0159]");
        c.value = Some(f64::NAN);
        assert_eq!(coefficient(&c), MISSING);
    }
}
