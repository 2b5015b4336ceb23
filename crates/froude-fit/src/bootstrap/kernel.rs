//! The inner loops of the bootstrap: sixteen resamples side by side.
//!
//! A batch of counts lies in memory with the sixteen resamples of a row next to each
//! other, so that one product of columns, broadcast, meets all of them. The sums end
//! up the same way, and the small systems are solved eight at a time.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::stream::Factor;
use crate::stream::lanes::{Kernel, LANES, Lane, Level, Vectors};

/// Resamples in a batch.
pub(super) const BATCH: usize = 2 * LANES;

/// Rows whose counts and products stay in the first-level cache.
const ROWS: usize = 128;

/// A resample is undetermined when a pivot falls below this share of its diagonal.
const LEAST_PIVOT: f64 = 1e-10;

/// Products of columns for every unit of drawing (a row or a cluster).
///
/// The terms of a unit are `q_i q_j` for `j ≤ i`, then `q_i e`. They are kept in tiles
/// of so many terms as the registers hold sums, filled up with zeros.
pub(super) struct Table {
    level: Level,
    units: usize,
    p: usize,
    /// Terms in a tile.
    tile: usize,
    /// Tile after tile, unit after unit, term after term.
    products: Vec<f64>,
}

impl Table {
    pub(super) fn new(units: usize, p: usize) -> Self {
        Self::at_level(units, p, Level::detect())
    }

    pub(super) fn at_level(units: usize, p: usize, level: Level) -> Self {
        let tile = level.run(TileOf);
        let tiles = terms(p).div_ceil(tile);
        Self { level, units, p, tile, products: vec![0.0; tiles * tile * units] }
    }

    pub(super) fn units(&self) -> usize {
        self.units
    }

    /// Adds a row `(q, e)` to a unit.
    pub(super) fn add(&mut self, unit: usize, basis: &[f64]) {
        let (q, e) = basis.split_at(self.p);
        let squares = (0..q.len()).flat_map(|i| (0..=i).map(move |j| q[i] * q[j]));
        let term_values = squares.chain(q.iter().map(|q| q * e[0]));
        for (term, value) in term_values.enumerate() {
            let (tile, place) = (term / self.tile, term % self.tile);
            self.products[(tile * self.units + unit) * self.tile + place] += value;
        }
    }
}

/// Number of terms for `p` coefficients.
fn terms(p: usize) -> usize {
    p * (p + 1) / 2 + p
}

/// Index of `(i, j)`, `j ≤ i`, among the terms.
fn pair(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Asks for the tile that suits an instruction set.
struct TileOf;

impl Kernel for TileOf {
    type Output = usize;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> usize {
        V::TERMS
    }
}

/// Memory of one thread.
pub(super) struct Sums {
    /// Times that each unit is drawn, by resample. The mean is 1: the chance that one
    /// passes 255 is below 1e-500.
    counts: Vec<[u8; BATCH]>,
    /// The counts of some rows as numbers.
    numbers: Vec<[Lane; 2]>,
    /// Sums of products, by term.
    totals: Vec<[Lane; 2]>,
}

impl Sums {
    pub(super) fn new(table: &Table) -> Self {
        Self {
            counts: vec![[0; BATCH]; table.units],
            numbers: vec![[Lane::ZERO; 2]; ROWS],
            totals: vec![[Lane::ZERO; 2]; terms(table.p).next_multiple_of(table.tile)],
        }
    }

    /// Draws a batch, from resample `first` on.
    pub(super) fn draw(&mut self, units: u32, seed: u64, first: u64) {
        self.counts.fill([0; BATCH]);
        for k in 0..BATCH {
            draw(&mut self.counts, k, units, generator(seed, first + k as u64));
        }
    }

    /// Sums the products and solves; writes coefficients, a row per resample.
    pub(super) fn solve(&mut self, table: &Table, factor: &Factor, estimate: &[f64], out: &mut [f64]) {
        self.totals.fill([Lane::ZERO; 2]);
        table.level.run(Multiply { table, memory: self });
        let solve = Solve { p: table.p, factor, estimate, sums: &mut self.totals };
        table.level.run(solve);
        let p = table.p;
        for (k, resample) in out.chunks_exact_mut(p).enumerate() {
            for (i, value) in resample.iter_mut().enumerate() {
                *value = self.totals[pair(p, 0) + i][k / LANES].0[k % LANES];
            }
        }
    }
}

/// A generator of its own for every resample.
///
/// State and stream are both scrambled: streams of neighbouring numbers alone would be
/// correlated.
fn generator(seed: u64, resample: u64) -> Pcg64 {
    let mut state = seed ^ resample.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    // SplitMix64 (Steele, Lea & Flood 2014).
    let mut next = || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        u128::from(z ^ (z >> 31))
    };
    let (a, b, c, d) = (next(), next(), next(), next());
    Pcg64::new((a << 64) | b, (c << 64) | d)
}

/// Draws as many units as there are, each equally likely: an exact multinomial count.
///
/// A number of 16 (or 32) random bits times `units` gives the unit in its upper half;
/// those that would favour some unit are rejected by the lower half (Lemire 2019, ACM
/// Trans. Model. Comput. Simul. 29, 3).
fn draw(counts: &mut [[u8; BATCH]], resample: usize, units: u32, mut generator: Pcg64) {
    // Rejection stays below 1 in 16.
    if units <= 1 << 12 {
        draw_with::<16>(counts, resample, units, &mut generator);
    } else {
        draw_with::<32>(counts, resample, units, &mut generator);
    }
}

fn draw_with<const BITS: u32>(counts: &mut [[u8; BATCH]], resample: usize, units: u32, generator: &mut Pcg64) {
    let mask = (1_u64 << BITS) - 1;
    let surplus = (1_u64 << BITS) % u64::from(units.max(1));
    let resample = resample % BATCH;
    // One draw; 1 when it counts. Without a branch: rejections cannot be predicted.
    let mut draw_one = |random: u64| -> u32 {
        let scaled = (random & mask) * u64::from(units);
        let is_fair = scaled & mask >= surplus;
        if let Some(row) = counts.get_mut((scaled >> BITS) as usize) {
            row[resample] = row[resample].wrapping_add(u8::from(is_fair));
        }
        u32::from(is_fair)
    };
    let mut left = units;
    while left >= 64 / BITS {
        let random = generator.next_u64();
        for k in 0..64 / BITS {
            left -= draw_one(random >> (k * BITS));
        }
    }
    while left > 0 {
        left -= draw_one(generator.next_u64());
    }
}

/// The counts of one resample.
#[cfg(test)]
pub(super) fn resample_counts(units: u32, seed: u64, resample: u64) -> Vec<u8> {
    let mut counts = vec![[0; BATCH]; units as usize];
    draw(&mut counts, 0, units, generator(seed, resample));
    counts.iter().map(|row| row[0]).collect()
}

struct Multiply<'a> {
    table: &'a Table,
    memory: &'a mut Sums,
}

impl Kernel for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let (table, memory) = (self.table, self.memory);
        for start in (0..table.units).step_by(ROWS) {
            let rows = start..table.units.min(start + ROWS);
            let numbers = &mut memory.numbers[..rows.len()];
            for (number, count) in numbers.iter_mut().zip(&memory.counts[rows.clone()]) {
                for (k, count) in count.iter().enumerate() {
                    number[k / LANES].0[k % LANES] = f64::from(*count);
                }
            }
            for (tile, sums) in memory.totals.chunks_exact_mut(table.tile).enumerate() {
                let first = (tile * table.units + rows.start) * table.tile;
                let products = &table.products[first..first + rows.len() * table.tile];
                match V::TERMS {
                    13 => multiply::<V, 13, 2>(vectors, numbers, products, sums),
                    6 => multiply::<V, 6, 2>(vectors, numbers, products, sums),
                    _ => multiply::<V, 2, 4>(vectors, numbers, products, sums),
                }
            }
        }
    }
}

/// Adds counts times products to the sums of `T` terms, `N` registers of resamples at
/// a time.
#[inline(always)]
fn multiply<V: Vectors, const T: usize, const N: usize>(
    vectors: V,
    numbers: &[[Lane; 2]],
    products: &[f64],
    sums: &mut [[Lane; 2]],
) {
    let (rows, _) = products.as_chunks::<T>();
    for first in (0..2 * V::PARTS).step_by(N) {
        let place = |n: usize| ((first + n) / V::PARTS, (first + n) % V::PARTS);
        let mut totals = [[vectors.splat(0.0); N]; T];
        for (row, number) in rows.iter().zip(numbers) {
            let mut counts = [vectors.splat(0.0); N];
            for (n, count) in counts.iter_mut().enumerate() {
                let (lane, part) = place(n);
                *count = vectors.load(&number[lane], part);
            }
            for t in 0..T {
                let product = vectors.splat(row[t]);
                for n in 0..N {
                    totals[t][n] = vectors.multiply_add(product, counts[n], totals[t][n]);
                }
            }
        }
        for (sum, total) in sums.iter_mut().zip(totals) {
            for (n, total) in total.into_iter().enumerate() {
                let (lane, part) = place(n);
                let before = vectors.load(&sum[lane], part);
                let after = vectors.multiply_add(total, vectors.splat(1.0), before);
                vectors.store(&mut sum[lane], part, after);
            }
        }
    }
}

/// Solves the systems of a batch in place: the terms of the right-hand side become
/// coefficients, NaN where a resample does not determine them.
struct Solve<'a> {
    p: usize,
    factor: &'a Factor,
    estimate: &'a [f64],
    sums: &'a mut [[Lane; 2]],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) {
        let (p, sums) = (self.p, self.sums);
        let right = pair(p, 0);
        let mut is_determined = [true; BATCH];
        for lane in 0..2 {
            for j in 0..p {
                let diagonal = sums[pair(j, j)][lane];
                for part in 0..V::PARTS {
                    // Column j of the Cholesky factor, its diagonal inverted.
                    for i in j..p {
                        let mut rest = vectors.load(&sums[pair(i, j)][lane], part);
                        for l in 0..j {
                            rest = vectors.subtract_product(
                                vectors.load(&sums[pair(i, l)][lane], part),
                                vectors.load(&sums[pair(j, l)][lane], part),
                                rest,
                            );
                        }
                        let sum = &mut sums[pair(i, j)][lane];
                        vectors.store(sum, part, rest);
                    }
                }
                let pivot = sums[pair(j, j)][lane];
                for k in 0..LANES {
                    // False for a NaN, too.
                    let is_positive = pivot.0[k] > LEAST_PIVOT * diagonal.0[k];
                    is_determined[lane * LANES + k] &= is_positive;
                }
                for part in 0..V::PARTS {
                    let pivot = vectors.load(&sums[pair(j, j)][lane], part);
                    let inverse = vectors.divide(vectors.splat(1.0), vectors.square_root(pivot));
                    vectors.store(&mut sums[pair(j, j)][lane], part, inverse);
                    for i in j + 1..p {
                        let value = vectors.load(&sums[pair(i, j)][lane], part);
                        let scaled = vectors.multiply_add(value, inverse, vectors.splat(0.0));
                        vectors.store(&mut sums[pair(i, j)][lane], part, scaled);
                    }
                }
            }
            for part in 0..V::PARTS {
                // L z = QᵀWe, Lᵀ δ = z, R (β − β̂) = δ.
                for i in 0..p {
                    let mut rest = vectors.load(&sums[right + i][lane], part);
                    for l in 0..i {
                        rest = vectors.subtract_product(
                            vectors.load(&sums[pair(i, l)][lane], part),
                            vectors.load(&sums[right + l][lane], part),
                            rest,
                        );
                    }
                    let inverse = vectors.load(&sums[pair(i, i)][lane], part);
                    let z = vectors.multiply_add(rest, inverse, vectors.splat(0.0));
                    vectors.store(&mut sums[right + i][lane], part, z);
                }
                for i in (0..p).rev() {
                    let mut rest = vectors.load(&sums[right + i][lane], part);
                    for l in i + 1..p {
                        rest = vectors.subtract_product(
                            vectors.load(&sums[pair(l, i)][lane], part),
                            vectors.load(&sums[right + l][lane], part),
                            rest,
                        );
                    }
                    let inverse = vectors.load(&sums[pair(i, i)][lane], part);
                    let delta = vectors.multiply_add(rest, inverse, vectors.splat(0.0));
                    vectors.store(&mut sums[right + i][lane], part, delta);
                }
                for i in (0..p).rev() {
                    let mut rest = vectors.load(&sums[right + i][lane], part);
                    for l in i + 1..p {
                        rest = vectors.subtract_product(
                            vectors.splat(self.factor.entry(i, l)),
                            vectors.load(&sums[right + l][lane], part),
                            rest,
                        );
                    }
                    let diagonal = vectors.splat(self.factor.entry(i, i));
                    vectors.store(&mut sums[right + i][lane], part, vectors.divide(rest, diagonal));
                }
                for (i, estimate) in self.estimate.iter().enumerate() {
                    let change = vectors.load(&sums[right + i][lane], part);
                    let value = vectors.multiply_add(change, vectors.splat(1.0), vectors.splat(*estimate));
                    vectors.store(&mut sums[right + i][lane], part, value);
                }
            }
            for (k, is_determined) in is_determined[lane * LANES..].iter().take(LANES).enumerate() {
                if !is_determined {
                    sums[right][lane].0[k] = f64::NAN;
                }
            }
        }
    }
}
