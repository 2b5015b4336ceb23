//! Decimal numbers, eight digits at a time.

// The compiler's own judgement costs a third of the speed here.
#![allow(clippy::inline_always)]

use memchr::memchr2;

/// Powers of ten that a double holds exactly, as far as they are needed.
const POWERS: [f64; 17] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16];

/// The same as integers, to eight digits.
const SHIFTS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Largest integer up to which a double holds all.
const EXACT: u64 = 1 << 53;

/// Reads `-12.345` and the like, up to the comma or line end behind it.
///
/// None when the cell is anything but up to 8 digits, with up to 16 more behind a point,
/// below 2⁵³ together: such a number is an exact integer over an exact power of ten, and
/// their quotient rounds once, correctly. Returns the value and where the cell ends.
///
/// # Source
///
/// Clinger (1990), *How to read floating point numbers accurately*, PLDI '90, section 3.
#[inline(always)]
pub(super) fn fast_number(text: &[u8], start: usize) -> Option<(f64, usize)> {
    let is_negative = *text.get(start)? == b'-';
    let mut at = start + usize::from(is_negative);
    let word = word_at(text, at)?;
    let count = leading_digits(word);
    if count == 0 {
        return None;
    }
    let mut digits = value_of(word, count);
    let mut behind_point = 0;
    at += count;
    let mut next = *text.get(at)?;
    if next == b'.' {
        let word = word_at(text, at + 1)?;
        let count = leading_digits(word);
        if count == 0 {
            return None;
        }
        digits = digits * SHIFTS[count] + value_of(word, count); // below 1e16
        behind_point = count;
        at += 1 + count;
        if count == 8 {
            let word = word_at(text, at)?;
            let count = leading_digits(word);
            if count > 0 {
                let shifted = digits.checked_mul(SHIFTS[count])?;
                digits = shifted.checked_add(value_of(word, count))?;
                behind_point += count;
                at += count;
            }
        }
        next = *text.get(at)?;
    }
    if digits > EXACT || !(next == b',' || next == b'\n' || next == b'\r') {
        return None;
    }
    let size = digits.cast_signed() as f64 / POWERS[behind_point];
    Some((if is_negative { -size } else { size }, at))
}

/// Eight bytes, the first one lowest.
#[inline(always)]
fn word_at(text: &[u8], at: usize) -> Option<u64> {
    text.get(at..)?.first_chunk::<8>().map(|bytes| u64::from_le_bytes(*bytes))
}

/// How many of the eight bytes, from the first, are digits.
#[inline(always)]
fn leading_digits(word: u64) -> usize {
    // A digit becomes 0..=9; anything else has its high bit set by adding 118, or before.
    let less = word ^ 0x3030_3030_3030_3030;
    let carried = (less & 0x7F7F_7F7F_7F7F_7F7F) + 0x7676_7676_7676_7676;
    let others = (carried | less) & 0x8080_8080_8080_8080;
    (others.trailing_zeros() / 8) as usize
}

/// Value of the first `count` bytes, digits all, `1..=8`.
#[inline(always)]
fn value_of(word: u64, count: usize) -> u64 {
    // Shifted up, what is missing in front counts as zeros. Then neighbours are joined:
    // digits to pairs, pairs to fours, fours to eight.
    let digits = (word << (64 - 8 * count)) & 0x0F0F_0F0F_0F0F_0F0F;
    let pairs = (digits.wrapping_mul(10 << 8 | 1) >> 8) & 0x00FF_00FF_00FF_00FF;
    let fours = (pairs.wrapping_mul(100 << 16 | 1) >> 16) & 0x0000_FFFF_0000_FFFF;
    fours.wrapping_mul(10_000 << 32 | 1) >> 32
}

/// Reads any finite decimal number, blanks around it allowed.
#[cold]
pub(super) fn slow_number(text: &[u8], start: usize) -> Option<(f64, usize)> {
    let rest = text.get(start..)?;
    let length = memchr2(b',', b'\n', rest)?;
    let has_return = rest[length] == b'\n' && rest[..length].ends_with(b"\r");
    let length = length - usize::from(has_return);
    let value: f64 = fast_float2::parse(without_blanks(&rest[..length])).ok()?;
    value.is_finite().then_some((value, start + length))
}

/// A cell without the blanks around it.
pub(super) fn without_blanks(mut cell: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] | [rest @ .., b' ' | b'\t'] = cell {
        cell = rest;
    }
    cell
}
