//! Numbers as they stand in a report: digits follow the uncertainty.
//!
//! An uncertainty is given with two significant digits and the value to the same
//! decimal place (GUM 7.2.6). The short form `0.0133(12)` is that of GUM 7.2.2:
//! the digits in brackets are the standard uncertainty in units of the last
//! digits of the value. Where no uncertainty is stated, digits are counted
//! instead, and nothing is said about how many of them can be trusted.
//!
//! | function        | gives                              |
//! |-----------------|------------------------------------|
//! | [`short_form`]  | `0.0133(12)`, `1.204(31) × 10⁻⁶`   |
//! | [`plus_minus`]  | `0.0133 ± 0.0024`                  |
//! | [`interval`]    | `[0.0109, 0.0157]`                 |
//! | [`significant`] | `0.01330`, `1.2 × 10⁹`             |
//! | [`percent`]     | `62 %`                             |
//! | [`p_value`]     | `0.043`, `< 0.001`                 |
//!
//! A number that is not finite is printed as [`MISSING`], in every function. The
//! minus sign is U+2212, as in print.

use crate::units::SUPERSCRIPTS;

/// What stands for a number that does not exist.
pub const MISSING: &str = "—";

/// Decimal digits that a double carries for certain.
const DOUBLE_DIGITS: i32 = 15;

/// Exponents from here on are written as a power of ten.
const LARGE_EXPONENT: i32 = 6;

/// Exponents up to here are written as a power of ten.
const SMALL_EXPONENT: i32 = -5;

/// Two-digit mantissa and exponent of a positive number: `0.0996` is `(10, -1)`, 1.0e-1.
fn two_digits(positive: f64) -> Option<(u32, i32)> {
    if !positive.is_finite() || positive <= 0.0 {
        return None;
    }
    let text = format!("{positive:.1e}");
    let (mantissa, exponent) = text.split_once('e')?;
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    Some((digits.parse().ok()?, exponent.parse().ok()?))
}

/// Decimal exponent of a finite number as it is printed with `digits` digits; 0 for zero.
fn exponent(x: f64, digits: usize) -> i32 {
    let text = format!("{:.*e}", digits.saturating_sub(1), x.abs());
    text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// `x · 10^shift` without leaving the range of doubles on the way.
fn shifted(x: f64, shift: i32) -> f64 {
    let half = shift / 2;
    x * 10f64.powi(half) * 10f64.powi(shift - half)
}

/// A finite number with `decimals` decimal places, or rounded to a power
/// of ten before it when `decimals` is negative.
fn decimals(x: f64, decimals: i32) -> String {
    let text = if decimals >= 0 {
        format!("{x:.*}", decimals as usize)
    } else {
        let step = 10f64.powi(-decimals);
        format!("{:.0}", (x / step).round() * step)
    };
    with_minus(&text)
}

/// Replaces the hyphen by a minus sign and drops the sign of a zero.
fn with_minus(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().any(|c| ('1'..='9').contains(&c)) => format!("−{rest}"),
        Some(rest) => rest.to_owned(),
        None => text.to_owned(),
    }
}

/// ` × 10ⁿ` in superscript digits.
fn power_of_ten(exponent: i32) -> String {
    let superscript = |c: char| c.to_digit(10).map_or('⁻', |digit| SUPERSCRIPTS[digit as usize]);
    format!(" × 10{}", exponent.to_string().chars().map(superscript).collect::<String>())
}

/// A number with a count of significant digits, `1 ≤ digits ≤ 15`.
///
/// Numbers from 10⁻⁴ up to 10⁶ are written out, others with a power of ten.
#[must_use]
pub fn significant(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return MISSING.to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.clamp(1, DOUBLE_DIGITS as usize);
    let e = exponent(x, digits);
    if e <= SMALL_EXPONENT || e >= LARGE_EXPONENT {
        let text = format!("{:.*e}", digits - 1, x);
        let mantissa = text.split_once('e').map_or(text.as_str(), |(m, _)| m);
        return format!("{}{}", with_minus(mantissa), power_of_ten(e));
    }
    decimals(x, i32::try_from(digits).unwrap_or(DOUBLE_DIGITS) - 1 - e)
}

/// A number as a person would have typed it: at most `digits` significant
/// digits, without zeros at the end.
#[must_use]
pub fn plain(x: f64, digits: usize) -> String {
    let text = significant(x, digits);
    let (number, rest) = text.split_at(text.find(' ').unwrap_or(text.len()));
    if number.contains('.') {
        let number = number.trim_end_matches('0').trim_end_matches('.');
        return format!("{number}{rest}");
    }
    text
}

/// How a value and an uncertainty are written together.
struct Together {
    value: String,
    uncertainty: String,
    /// Two or more digits of the uncertainty in units of the value's last place.
    last_digits: String,
    power: String,
}

/// Rounds both to the place of the uncertainty's second digit.
///
/// `None` when there is no usable uncertainty, or when it is so small that a
/// double does not carry the digits.
fn together(value: f64, uncertainty: f64) -> Option<Together> {
    if !value.is_finite() {
        return None;
    }
    let (digits, e_u) = two_digits(uncertainty)?;
    let e_value = if value == 0.0 { e_u } else { exponent(value, DOUBLE_DIGITS as usize) };
    let e_top = e_value.max(e_u);
    if e_top - (e_u - 1) > DOUBLE_DIGITS {
        return None;
    }
    let written_out = e_top < LARGE_EXPONENT && e_top > SMALL_EXPONENT && e_u > -9;
    let shift = if written_out { 0 } else { e_top };
    let places = 1 - (e_u - shift);
    // The rounded uncertainty itself, so that 0.0996 reads 0.10 and not 0.100.
    let rounded_u = shifted(f64::from(digits), e_u - 1 - shift);
    let last_digits = if places < 0 { decimals(rounded_u, 0) } else { digits.to_string() };
    Some(Together {
        value: decimals(shifted(value, -shift), places),
        uncertainty: decimals(rounded_u, places.max(0)),
        last_digits,
        power: if shift == 0 { String::new() } else { power_of_ten(shift) },
    })
}

/// Value and standard uncertainty in the short form of GUM 7.2.2: `0.0133(12)`.
///
/// Without a usable uncertainty (not finite, zero or negative) the value stands
/// alone with four significant digits: a missing uncertainty is never shown as zero.
#[must_use]
pub fn short_form(value: f64, standard: f64) -> String {
    if let Some(t) = together(value, standard) {
        return format!("{}({}){}", t.value, t.last_digits, t.power);
    }
    lonely(value, standard)
}

/// Value and expanded uncertainty: `0.0133 ± 0.0024`, `(1.20 ± 0.31) × 10⁻⁶`.
#[must_use]
pub fn plus_minus(value: f64, expanded: f64) -> String {
    if let Some(t) = together(value, expanded) {
        if t.power.is_empty() {
            return format!("{} ± {}", t.value, t.uncertainty);
        }
        return format!("({} ± {}){}", t.value, t.uncertainty, t.power);
    }
    lonely(value, expanded)
}

/// An interval that is symmetric about the value within this part of its half-width is written as `±`.
const SYMMETRIC: f64 = 0.01;

/// Half of an interval that is symmetric about the value.
pub(crate) fn half_width(value: f64, [low, high]: [f64; 2]) -> Option<f64> {
    let half = high / 2.0 - low / 2.0;
    let offset = (low / 2.0 + high / 2.0 - value).abs();
    (half.is_finite() && half > 0.0 && offset <= SYMMETRIC * half).then_some(half)
}

/// Value and interval: `20.1 ± 0.2` where that is symmetric about the value, `0.22 [−0.18, 0.82]` where it is not.
#[must_use]
pub fn value_and_interval(value: f64, ends: [f64; 2]) -> String {
    match half_width(value, ends) {
        Some(half) => plus_minus(value, half),
        None => {
            let half = ends[1] / 2.0 - ends[0] / 2.0;
            let number = together(value, half).map_or_else(|| plain(value, 4), |t| format!("{}{}", t.value, t.power));
            format!("{number} {}", interval(ends))
        }
    }
}

/// A value whose uncertainty is missing, or far below its own digits.
fn lonely(value: f64, uncertainty: f64) -> String {
    if value.is_finite() && uncertainty.is_finite() && uncertainty > 0.0 {
        return format!("{} ± {}", plain(value, DOUBLE_DIGITS as usize), significant(uncertainty, 2));
    }
    significant(value, 4)
}

/// A closed interval, its ends rounded to two digits of the half-width.
#[must_use]
pub fn interval(ends: [f64; 2]) -> String {
    let [low, high] = ends;
    if !low.is_finite() || !high.is_finite() {
        let text = |x: f64| match x {
            f64::INFINITY => "∞".to_owned(),
            f64::NEG_INFINITY => "−∞".to_owned(),
            x => plain(x, 4),
        };
        return format!("[{}, {}]", text(low), text(high));
    }
    let half = high / 2.0 - low / 2.0;
    match (together(low, half), together(high, half)) {
        (Some(l), Some(h)) => {
            let (l, h) = (format!("{}{}", l.value, l.power), format!("{}{}", h.value, h.power));
            let zero = |text: String, x: f64| if x == 0.0 { "0".to_owned() } else { text };
            format!("[{}, {}]", zero(l, low), zero(h, high))
        }
        _ => format!("[{}, {}]", plain(low, 6), plain(high, 6)),
    }
}

/// A part of the whole in percent: `62 %`, `3.1 %`, `< 0.1 %`.
#[must_use]
pub fn percent(part: f64) -> String {
    if !part.is_finite() {
        return MISSING.to_owned();
    }
    let percent = part * 100.0;
    if !percent.is_finite() {
        "> 10⁹ %".to_owned()
    } else if percent == 0.0 {
        "0 %".to_owned()
    } else if percent.abs() < 0.1 {
        "< 0.1 %".to_owned()
    } else if percent.abs() < 9.95 {
        format!("{} %", decimals(percent, 1))
    } else {
        format!("{} %", fixed(percent, 0))
    }
}

/// A p-value: three places, and `< 0.001` below.
#[must_use]
pub fn p_value(p: f64) -> String {
    if !p.is_finite() {
        MISSING.to_owned()
    } else if p < 0.001 {
        "< 0.001".to_owned()
    } else {
        fixed(p, 3)
    }
}

/// The same in a sentence: `p = 0.012`, or `p < 0.001`.
#[must_use]
pub fn p_equation(p: f64) -> String {
    let value = p_value(p);
    if value.starts_with('<') { format!("p {value}") } else { format!("p = {value}") }
}

/// A number with a fixed count of places: `2.04`, or a power of ten when it is huge.
#[must_use]
pub fn fixed(x: f64, places: usize) -> String {
    if !x.is_finite() {
        MISSING.to_owned()
    } else if x.abs() >= 1e6 {
        significant(x, 3)
    } else {
        decimals(x, i32::try_from(places.min(12)).unwrap_or(0))
    }
}

/// A count, with thin spaces between thousands from 10 000 on.
#[must_use]
pub fn count(n: usize) -> String {
    let digits = n.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut out = String::with_capacity(digits.len() + 6);
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// A time as a person says it.
#[must_use]
pub fn duration(seconds: f64) -> String {
    if seconds < 1.0 {
        "less than a second".to_owned()
    } else if seconds < 120.0 {
        format!("{seconds:.0} s")
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}

/// A size in bytes, as MB or GB (decimal).
#[must_use]
pub fn bytes(n: f64) -> String {
    if n < 1e9 { format!("{} MB", significant(n / 1e6, 2)) } else { format!("{} GB", significant(n / 1e9, 2)) }
}

/// An angle in degrees, without zeros at the end.
#[must_use]
pub fn degrees(angle_rad: f64) -> String {
    let rounded = (angle_rad.to_degrees() * 100.0).round() / 100.0;
    format!("{}°", plain(rounded, 6))
}

/// Degrees of freedom: whole where they are whole, else one place.
#[must_use]
pub fn dof(dof: f64) -> String {
    if dof == f64::INFINITY {
        "∞".to_owned()
    } else if !dof.is_finite() {
        MISSING.to_owned()
    } else if (dof - dof.round()).abs() < 0.05 {
        fixed(dof, 0)
    } else {
        fixed(dof, 1)
    }
}

/// The same with its noun: `1 degree of freedom`, `4.3 degrees of freedom`.
#[must_use]
pub fn degrees_of_freedom(n: f64) -> String {
    let digits = dof(n);
    let noun = if digits == "1" { "degree" } else { "degrees" };
    format!("{digits} {noun} of freedom")
}

/// A finite value that the record really holds.
#[must_use]
pub fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}

/// A standard uncertainty that can be used: finite and above zero.
#[must_use]
pub fn usable(standard: Option<f64>) -> Option<f64> {
    standard.filter(|u| u.is_finite() && *u > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_interval_that_is_not_symmetric_is_an_interval() {
        assert_eq!(value_and_interval(0.22, [-0.18, 0.82]), "0.22 [−0.18, 0.82]");
        assert_eq!(value_and_interval(20.1, [19.9, 20.3]), "20.10 ± 0.20");
        assert_eq!(value_and_interval(0.22, [-0.18, f64::INFINITY]), "0.22 [−0.18, ∞]");
    }

    #[test]
    fn the_short_form_follows_the_uncertainty() {
        #[rustfmt::skip]
        let table: &[(f64, f64, &str)] = &[
            (0.0133, 0.0012, "0.0133(12)"),
            (1.42719, 0.0314, "1.427(31)"),
            (47.8312, 0.5249, "47.83(52)"),
            (47.8312, 5.249, "47.8(52)"),
            (478.3, 52.49, "478(52)"),
            (47831.2, 524.9, "47830(520)"),
            // A nine that rounds up takes the next place with it.
            (0.5, 0.0996, "0.50(10)"),
            (0.5, 0.00996, "0.500(10)"),
            (0.01234, 0.5, "0.01(50)"),
            (-1.853, 0.021, "−1.853(21)"),
            (0.0, 0.0123, "0.000(12)"),
            (-0.0001, 0.12, "0.00(12)"),
            (1.2345e-9, 3.1e-11, "1.234(31) × 10⁻⁹"),
            (6.02214e23, 1.1e18, "6.022140(11) × 10²³"),
            (2.5e6, 1.0e4, "2.500(10) × 10⁶"),
            // 9.5 rounded up in both digits of u
            (12.0, 9.96, "12(10)"),
            (120.0, 99.6, "120(100)"),
        ];
        for &(value, u, expected) in table {
            assert_eq!(short_form(value, u), expected, "value {value}, u {u}");
        }
    }

    #[test]
    fn a_missing_uncertainty_is_never_shown_as_zero() {
        for u in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(short_form(0.0133, u), "0.01330");
            assert_eq!(plus_minus(0.0133, u), "0.01330");
        }
        assert_eq!(short_form(f64::NAN, 0.1), MISSING);
    }

    #[test]
    fn expanded_forms_and_intervals_share_their_places() {
        assert_eq!(plus_minus(0.0133, 0.00237), "0.0133 ± 0.0024");
        assert_eq!(plus_minus(47831.2, 1050.0), "47800 ± 1000");
        assert_eq!(plus_minus(1.2e-6, 3.1e-7), "(1.20 ± 0.31) × 10⁻⁶");
        assert_eq!(interval([0.01093, 0.01567]), "[0.0109, 0.0157]");
        assert_eq!(interval([0.0, 0.0211]), "[0, 0.021]");
        assert_eq!(interval([-0.31, 0.62]), "[−0.31, 0.62]");
        assert_eq!(interval([0.1, f64::INFINITY]), "[0.1, ∞]");
        assert_eq!(interval([f64::NAN, 1.0]), "[—, 1]");
        assert_eq!(interval([2.0, 2.0]), "[2, 2]");
    }

    #[test]
    fn other_numbers_read_as_in_print() {
        assert_eq!(significant(0.013304, 3), "0.0133");
        assert_eq!(significant(999.96, 4), "1000");
        assert_eq!(significant(123_456_789.0, 3), "1.23 × 10⁸");
        assert_eq!(significant(f64::NAN, 3), MISSING);
        assert_eq!(plain(0.1, 6), "0.1");
        assert_eq!(plain(100.0, 6), "100");
        assert_eq!(plain(1.5e-7, 4), "1.5 × 10⁻⁷");
        assert_eq!(percent(0.6249), "62 %");
        assert_eq!(percent(0.0312), "3.1 %");
        assert_eq!(percent(0.0002), "< 0.1 %");
        assert_eq!(p_value(0.04321), "0.043");
        assert_eq!(p_value(1e-12), "< 0.001");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(1234), "1234");
        assert_eq!(degrees(39f64.to_radians()), "39°");
        assert_eq!(dof(28.0), "28");
        assert_eq!(dof(f64::INFINITY), "∞");
        assert_eq!(fixed(-0.001, 2), "0.00");
    }

    /// Reads the short form back: value, and uncertainty in units of the last place.
    fn read_back(text: &str) -> (f64, f64) {
        let (mantissa, power) = text.split_once(" × 10").unwrap_or((text, ""));
        let power: String = power
            .chars()
            .map(|c| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|d| d == c).map_or('-', |d| (b'0' + d as u8) as char))
            .collect();
        let (value, digits) = mantissa.split_once('(').unwrap();
        let value = value.replace('−', "-");
        let places = value.split_once('.').map_or(0, |(_, f)| f.len());
        let digits = digits.trim_end_matches(')');
        let mut u = "0".repeat(places.saturating_sub(digits.len()) + 1) + digits;
        u.insert(u.len() - places, '.');
        let e = if power.is_empty() { "0" } else { &power };
        (format!("{value}e{e}").parse().unwrap(), format!("{u}e{e}").parse().unwrap())
    }

    proptest! {
        /// What is printed holds the value to half of its last place, and the
        /// uncertainty to 5 %: two digits of it.
        #[test]
        fn the_short_form_reads_back(m in -9.99f64..9.99, e in -30i32..30, r in -6i32..2, um in 1.0f64..9.99) {
            let value = m * 10f64.powi(e);
            let u = um * 10f64.powi(e + r);
            let (v, s) = read_back(&short_form(value, u));
            prop_assert!((s / u - 1.0).abs() <= 0.051, "{} {} {}", value, u, short_form(value, u));
            prop_assert!((v - value).abs() <= 0.051 * u, "{} {} {}", value, u, short_form(value, u));
        }

        /// No bit pattern brings a formatter down or prints NaN.
        #[test]
        fn any_bits_give_text(a in any::<f64>(), b in any::<f64>(), n in 0usize..40) {
            for text in [
                short_form(a, b), plus_minus(a, b), interval([a, b]), significant(a, n), plain(a, n),
                percent(a), p_value(a), fixed(a, n), degrees(a), dof(a),
            ] {
                prop_assert!(!text.is_empty());
                prop_assert!(!text.contains("NaN") && !text.contains("inf"), "{}", text);
                prop_assert!(text.chars().count() < 64, "{}", text);
            }
        }
    }
}
