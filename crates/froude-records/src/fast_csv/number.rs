//! Decimal numbers, eight digits at a time.

// The compiler's own judgement costs a third of the speed here.
#![allow(clippy::inline_always)]

/// Powers of ten that a double holds exactly, as far as they are needed.
const POWERS: [f64; 17] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16];

/// The same as integers, to eight digits.
const SHIFTS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Integers below this lie in the fraction of a double between 2⁵² and 2⁵³.
const EXACT: u64 = 1 << 52;

/// The double 2⁵².
const EXACT_BITS: u64 = 0x4330_0000_0000_0000;

/// Reads the cell `start..end` if it has a point and at most eight digits: what logs
/// are full of. Otherwise leaves it to [`longer_number`].
///
/// `text` goes on for 16 bytes at least behind `end`.
#[inline(always)]
pub(super) fn fast_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let is_negative = *text.get(start)? == b'-';
    let at = start + usize::from(is_negative);
    let [first, rest @ ..] = *text.get(at..)?.first_chunk::<9>()?;
    let behind = u64::from_le_bytes(rest);
    let word = behind << 8 | u64::from(first);
    let count = end.wrapping_sub(at + 1); // digits, if there is one point
    // Bits up to the point; the digits behind it move up into its place.
    let point = zero_bytes(word ^ 0x2E2E_2E2E_2E2E_2E2E).trailing_zeros() & !7;
    if point >= 64 || count.wrapping_sub(1) >= 8 || point as usize > 8 * count {
        return longer_number(text, start, end);
    }
    let before = (1 << point) - 1;
    let joined = ((word & before) | (behind & !before)) ^ 0x3030_3030_3030_3030;
    // Shifted up, what is missing in front counts as zeros.
    let digits = joined << (64 - 8 * count);
    if !are_digits(digits) {
        return longer_number(text, start, end);
    }
    Some(quotient(eight_digits(digits), count - point as usize / 8, is_negative))
}

/// A number from its digits, all of them, and how many of them are behind the point.
#[inline(always)]
fn quotient(digits: u64, behind_point: usize, is_negative: bool) -> f64 {
    // An integer as the fraction of a double: the processor's own conversion would wait
    // for the division of the cell before (it keeps the other half of its register).
    let whole = f64::from_bits(EXACT_BITS | digits) - EXACT as f64;
    let size = whole / POWERS[behind_point];
    // The sign by its bit: a branch on it would be guessed wrong half the time.
    f64::from_bits(size.to_bits() | u64::from(is_negative) << 63)
}

/// Reads the cell `start..end` if it is `-12.345` or the like.
///
/// None when it is anything but up to 8 digits, with up to 16 more behind a point, below
/// 2⁵² together: such a number is an exact integer over an exact power of ten, and their
/// quotient rounds once, correctly. `text` goes on for 16 bytes at least behind `end`.
///
/// # Source
///
/// Clinger (1990), *How to read floating point numbers accurately*, PLDI '90, section 3.
#[inline(never)]
fn longer_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
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
    if *text.get(at)? == b'.' {
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
    }
    if digits >= EXACT || at != end {
        return None;
    }
    Some(quotient(digits, behind_point, is_negative))
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

/// Whether all bytes are 0 to 9.
#[inline(always)]
fn are_digits(bytes: u64) -> bool {
    let carried = (bytes & 0x7F7F_7F7F_7F7F_7F7F) + 0x7676_7676_7676_7676;
    (carried | bytes) & 0x8080_8080_8080_8080 == 0
}

/// Value of the first `count` bytes, digits all, `1..=8`.
#[inline(always)]
fn value_of(word: u64, count: usize) -> u64 {
    // Shifted up, what is missing in front counts as zeros.
    eight_digits((word << (64 - 8 * count)) & 0x0F0F_0F0F_0F0F_0F0F)
}

/// Value of eight bytes of 0 to 9, the lowest byte first: digits are joined to pairs,
/// pairs to fours, fours to eight.
#[inline(always)]
fn eight_digits(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10 << 8 | 1) >> 8) & 0x00FF_00FF_00FF_00FF;
    let fours = (pairs.wrapping_mul(100 << 16 | 1) >> 16) & 0x0000_FFFF_0000_FFFF;
    fours.wrapping_mul(10_000 << 32 | 1) >> 32
}

/// Reads any finite decimal number, blanks around it allowed.
#[cold]
pub(super) fn slow_number(cell: &[u8]) -> Option<f64> {
    let value: f64 = fast_float2::parse(without_blanks(cell)).ok()?;
    value.is_finite().then_some(value)
}

/// A cell without the blanks around it.
fn without_blanks(mut cell: &[u8]) -> &[u8] {
    while let [b' ' | b'\t', rest @ ..] | [rest @ .., b' ' | b'\t'] = cell {
        cell = rest;
    }
    cell
}

/// Writes where the commas and line ends of `text` are, in order; returns how many.
///
/// `text` is a multiple of 16 bytes long. `places` has room for 16 more than are expected;
/// when that is not enough, the rest is left out.
///
/// Where cells end is found beforehand so that reading one cell need not wait for the
/// one before it.
pub(super) fn separators(text: &[u8], places: &mut [u32]) -> usize {
    let mut found = 0;
    for (block, first) in text.as_chunks::<16>().0.iter().zip((0_u32..).step_by(16)) {
        let mut marks = marks_in(block);
        let Some(room) = places.get_mut(found..).and_then(|rest| rest.first_chunk_mut::<16>()) else {
            break;
        };
        // Three at once without asking: sixteen bytes seldom hold more, and which hold how
        // many cannot be predicted.
        for place in &mut room[..3] {
            *place = first + marks.trailing_zeros();
            found += usize::from(marks != 0);
            marks &= marks.wrapping_sub(1);
        }
        for place in &mut room[3..] {
            if marks == 0 {
                break;
            }
            *place = first + marks.trailing_zeros();
            found += 1;
            marks &= marks - 1;
        }
    }
    found
}

/// A bit for every byte that is a comma or a line end.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn marks_in(block: &[u8; 16]) -> u32 {
    use std::arch::x86_64::{_mm_cmpeq_epi8, _mm_movemask_epi8, _mm_or_si128, _mm_set_epi64x, _mm_set1_epi8};
    let all = u128::from_le_bytes(*block);
    #[allow(unsafe_code)]
    // SAFETY: SSE2 belongs to every x86_64 processor, and no pointer is involved.
    unsafe {
        let bytes = _mm_set_epi64x((all >> 64) as i64, all as i64);
        let commas = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(b','.cast_signed()));
        let ends = _mm_cmpeq_epi8(bytes, _mm_set1_epi8(b'\n'.cast_signed()));
        _mm_movemask_epi8(_mm_or_si128(commas, ends)).cast_unsigned()
    }
}

/// A bit for every byte that is a comma or a line end.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn marks_in(block: &[u8; 16]) -> u32 {
    (0..16).filter(|&i| matches!(block[i], b',' | b'\n')).fold(0, |marks, i| marks | 1 << i)
}

/// The high bit of every byte that is zero.
#[inline(always)]
fn zero_bytes(word: u64) -> u64 {
    !(((word & 0x7F7F_7F7F_7F7F_7F7F) + 0x7F7F_7F7F_7F7F_7F7F) | word) & 0x8080_8080_8080_8080
}
