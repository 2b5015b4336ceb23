//! The inner loop: one block of rows folded into a triangle by Householder
//! reflections.
//!
//! A block lies in memory as groups of eight rows; a group holds one [`Lane`]
//! per column, so a sweep over a block runs straight through memory and never
//! leaves the first-level cache. Step `k` of the factorisation reflects column
//! `k` onto the triangle's diagonal. Its sweep updates the columns right of `k`
//! and, while they are in registers, takes the inner products that step `k + 1`
//! needs: one read and one write of the block a step, two multiply-adds each.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use std::ops::Range;

use froude_lanes::{Kernel, LANES, Lane, Level, Vectors};

/// Columns that a sweep takes at a time: what is subtracted, the sum and the column itself are three registers each.
const fn tile<V: Vectors>() -> usize {
    (V::REGISTERS - 1) / 3
}

/// Bytes that a block may take: it and the two fetched ahead stay in the first-level
/// cache. Twice as much costs a third of the speed.
const BLOCK_BYTES: usize = 12 * 1024;

/// Groups in a block of `width` columns.
pub(crate) fn groups_per_block(width: usize) -> usize {
    (BLOCK_BYTES / (width.max(1) * size_of::<Lane>())).clamp(4, 64)
}

/// Folds a block into the upper triangle `r` (`width × width`, row-major):
/// afterwards `rᵀr` has grown by `blockᵀblock`. The block is used up.
///
/// `scratch` holds `2·width` numbers. Rows of zeros change nothing.
pub(crate) fn absorb(level: Level, r: &mut [f64], block: &mut [Lane], scratch: &mut [f64], ahead: Ahead<'_>) {
    level.run(Absorb { r, block, scratch, ahead });
}

struct Absorb<'a> {
    r: &'a mut [f64],
    block: &'a mut [Lane],
    scratch: &'a mut [f64],
    ahead: Ahead<'a>,
}

impl Kernel for Absorb<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let width = self.r.len().isqrt();
        let (dots, turns) = self.scratch.split_at_mut(width);
        let (block, mut ahead) = (self.block, self.ahead);
        // The first step's inner products: a sweep that turns nothing.
        turns.fill(0.0);
        sweep_all::<V, false>(vectors, block, width, 0, turns, dots, &mut ahead);
        for k in 0..width {
            let row = &mut self.r[k * width..(k + 1) * width];
            let (alpha, squares) = (row[k], dots[k]);
            if squares == 0.0 {
                turns.fill(0.0);
            } else {
                // v = (alpha − beta, x), beta = −sign(alpha)·|(alpha, x)|: no cancellation.
                let norm = (alpha * alpha + squares).sqrt();
                let head = alpha + norm.copysign(alpha);
                let scale = 1.0 / (norm * (norm + alpha.abs())); // 2/vᵀv
                row[k] = -norm.copysign(alpha);
                for j in k + 1..width {
                    turns[j] = scale * (head * row[j] + dots[j]);
                    row[j] -= head * turns[j];
                }
            }
            sweep_all::<V, true>(vectors, block, width, k + 1, turns, dots, &mut ahead);
        }
        ahead.ask_for_rest();
    }
}

/// One step over all columns from `first`: `x_j −= v·turn_j` with `v` the column
/// before `first`, then `dots[j] = x_first · x_j` of the updated columns.
///
/// `TURN` is false for the opening sweep, which has no column before it.
#[inline(always)]
fn sweep_all<V: Vectors, const TURN: bool>(
    vectors: V,
    block: &mut [Lane],
    width: usize,
    first: usize,
    turns: &[f64],
    dots: &mut [f64],
    ahead: &mut Ahead<'_>,
) {
    let mut start = first;
    while start < width {
        // Even tiles: 12 columns go as 6 + 6 where 10 is the most, not as 10 + 2.
        let left = width - start;
        let count = left.div_ceil(left.div_ceil(tile::<V>()));
        macro_rules! tile {
            ($($m:literal)*) => {
                match count {
                    $($m if $m <= tile::<V>() => sweep::<V, $m, TURN>(
                        vectors, block, width, [first, start], turns, dots, ahead,
                    ),)*
                    _ => {}
                }
            };
        }
        tile!(1 2 3 4 5 6 7 8 9 10);
        start += count;
    }
}

/// One sweep over `M` columns from `start`. When `start == first` the pivot
/// column is among them; otherwise it has been updated before.
#[inline(always)]
fn sweep<V: Vectors, const M: usize, const TURN: bool>(
    vectors: V,
    block: &mut [Lane],
    width: usize,
    [first, start]: [usize; 2],
    turns: &[f64],
    dots: &mut [f64],
    ahead: &mut Ahead<'_>,
) {
    let mut turn = [vectors.splat(0.0); M];
    for (turn, value) in turn.iter_mut().zip(&turns[start..]) {
        *turn = vectors.splat(*value);
    }
    let mut sums = [vectors.splat(0.0); M];
    for group in block.chunks_exact_mut(width) {
        ahead.ask();
        let (before, rest) = group.split_at_mut(start);
        let Some(columns) = rest.first_chunk_mut::<M>() else {
            return;
        };
        for part in 0..V::PARTS {
            let v = if TURN { vectors.load(&before[first - 1], part) } else { vectors.splat(0.0) };
            let mut pivot = v;
            if start != first {
                pivot = vectors.load(&before[first], part);
            }
            for m in 0..M {
                let mut x = vectors.load(&columns[m], part);
                if TURN {
                    x = vectors.subtract_product(v, turn[m], x);
                    vectors.store(&mut columns[m], part, x);
                }
                if m == 0 && start == first {
                    pivot = x;
                }
                sums[m] = vectors.multiply_add(pivot, x, sums[m]);
            }
        }
    }
    for (dot, sum) in dots[start..].iter_mut().zip(sums) {
        *dot = vectors.sum(sum);
    }
}

/// Copies `values` into column `column` of the block, from row `row` on.
pub(crate) fn put(block: &mut [Lane], width: usize, column: usize, row: usize, values: &[f64]) {
    let (mut group, offset) = (row / LANES, row % LANES);
    let mut rest = values;
    if offset != 0 {
        let n = rest.len().min(LANES - offset);
        block[group * width + column].0[offset..offset + n].copy_from_slice(&rest[..n]);
        rest = &rest[n..];
        group += 1;
    }
    let (whole, tail) = rest.as_chunks::<LANES>();
    let lanes = block.chunks_exact_mut(width).skip(group);
    for (lanes, chunk) in lanes.zip(whole) {
        lanes[column].0 = *chunk;
    }
    if !tail.is_empty() {
        let lane = &mut block[(group + whole.len()) * width + column];
        lane.0[..tail.len()].copy_from_slice(tail);
    }
}

/// Rows that come later, asked for line by line while the processor computes.
///
/// Memory answers only so many requests at a time: all lines of a block asked for at once
/// would hold up the arithmetic, which takes as long as the answers do.
#[derive(Debug, Clone)]
pub(crate) struct Ahead<'a> {
    columns: &'a [&'a [f64]],
    pub(super) rows: Range<usize>,
    column: usize,
    row: usize,
}

impl<'a> Ahead<'a> {
    /// These rows of every column.
    pub(crate) fn new(columns: &'a [&'a [f64]], rows: Range<usize>) -> Self {
        let column = if rows.is_empty() { columns.len() } else { 0 };
        Self { columns, row: rows.start, rows, column }
    }

    /// No rows.
    pub(crate) fn nothing() -> Self {
        Self { columns: &[], rows: 0..0, column: 0, row: 0 }
    }

    /// Asks for the next line, if one is left.
    #[inline(always)]
    fn ask(&mut self) {
        let Some(column) = self.columns.get(self.column) else { return };
        fetch(column.as_ptr().wrapping_add(self.row));
        self.row += LANES;
        if self.row >= self.rows.end {
            self.row = self.rows.start;
            self.column += 1;
        }
    }

    /// Asks for all lines that are left.
    #[inline(always)]
    fn ask_for_rest(&mut self) {
        while self.column < self.columns.len() {
            self.ask();
        }
    }
}

/// Asks for a line to be brought into the first-level cache.
#[inline(always)]
fn fetch(line: *const f64) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code)]
        // SAFETY: a hint; it reads nothing, whatever the address.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(line.cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = line;
}

/// Sets rows `row..` of the block to zero.
pub(crate) fn clear_from(block: &mut [Lane], width: usize, row: usize) {
    let (group, offset) = (row / LANES, row % LANES);
    let (first, rest) = block[group * width..].split_at_mut(if offset == 0 { 0 } else { width });
    for lane in first {
        lane.0[offset..].fill(0.0);
    }
    rest.fill(Lane::ZERO);
}
