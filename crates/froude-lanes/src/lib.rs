//! Kernels written once and compiled for what the processor has: AVX-512, AVX2 with fused multiply-add, or nothing special.
//!
//! A kernel is written over [`Vectors`], eight numbers ([`Lane`]) at a time: eight rows of a table, eight stretches of a record. [`run`]
//! compiles it for every instruction set and goes to the best one that this processor has. A kernel that is a plain loop may leave the
//! vectors alone: the compiler then vectorises the loop with those instructions.
//!
//! A value of [`Avx512`] or [`Avx2`] exists only after the processor was asked, so holding one is the proof that its instructions may be
//! used: that is all the `unsafe` here rests on.
//!
//! Why not a library: `pulp`, which the linear algebra brings along, has AVX-512 behind a feature that would also change how that algebra
//! sums, and has no transposition of eight by eight.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
pub use x86::{Avx2, Avx512};

/// Numbers worked on side by side.
pub const LANES: usize = 8;

/// Eight numbers on a cache line of their own.
#[repr(C, align(64))]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lane(pub [f64; LANES]);

impl Lane {
    /// Eight zeros.
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// Vector arithmetic of one instruction set.
pub trait Vectors: Copy {
    /// A register of numbers.
    type Vector: Copy;
    /// Registers that hold a [`Lane`].
    const PARTS: usize;
    /// Registers that there are: what a kernel keeps at hand must fit them.
    const REGISTERS: usize;

    /// The same number everywhere.
    fn splat(self, value: f64) -> Self::Vector;
    /// Part `part` of a lane.
    fn load(self, lane: &Lane, part: usize) -> Self::Vector;
    /// Writes part `part` of a lane.
    fn store(self, lane: &mut Lane, part: usize, value: Self::Vector);
    /// `a·b`.
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a·b + c`, rounded once where the processor can.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// `c − a·b`, rounded once where the processor can.
    fn subtract_product(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// Sum of the numbers in a register, in a fixed order.
    fn sum(self, a: Self::Vector) -> f64;
    /// Rows into columns: number `j` of row `i` becomes number `i` of lane `j`.
    fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES];
}

/// A kernel, to be compiled for every instruction set.
///
/// `run` must be `#[inline(always)]`, and what it calls as well.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// The kernel.
    fn run<V: Vectors>(self, vectors: V) -> Self::Output;
}

/// Runs a kernel with the best that this processor has.
pub fn run<K: Kernel>(kernel: K) -> K::Output {
    Level::detect().run(kernel)
}

/// Instruction set that kernels run with.
#[derive(Debug, Clone, Copy)]
pub enum Level {
    /// What every processor of the target has.
    Plain(Plain),
    /// AVX2 with fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// AVX-512 F, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Level {
    /// All that this processor has, the best first.
    pub fn available() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let vectors = [Avx512::detect().map(Self::Avx512), Avx2::detect().map(Self::Avx2)];
        #[cfg(not(target_arch = "x86_64"))]
        let vectors: [Option<Self>; 0] = [];
        vectors.into_iter().flatten().chain([Self::Plain(Plain)])
    }

    /// The best that this processor has.
    #[must_use]
    pub fn detect() -> Self {
        Self::available().next().unwrap_or(Self::Plain(Plain))
    }

    /// Runs a kernel.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Plain(plain) => kernel.run(plain),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(avx2) => avx2.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(avx512) => avx512.run(kernel),
        }
    }
}

/// No instruction that a processor may lack.
#[derive(Debug, Clone, Copy)]
pub struct Plain;

impl Vectors for Plain {
    type Vector = [f64; 2];
    const PARTS: usize = 4;
    const REGISTERS: usize = 16;

    #[inline(always)]
    fn splat(self, value: f64) -> [f64; 2] {
        [value; 2]
    }

    #[inline(always)]
    fn load(self, lane: &Lane, part: usize) -> [f64; 2] {
        [lane.0[2 * part], lane.0[2 * part + 1]]
    }

    #[inline(always)]
    fn store(self, lane: &mut Lane, part: usize, value: [f64; 2]) {
        [lane.0[2 * part], lane.0[2 * part + 1]] = value;
    }

    #[inline(always)]
    fn multiply(self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        [a[0] * b[0], a[1] * b[1]]
    }

    #[inline(always)]
    fn multiply_add(self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> [f64; 2] {
        [a[0] * b[0] + c[0], a[1] * b[1] + c[1]]
    }

    #[inline(always)]
    fn subtract_product(self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> [f64; 2] {
        [c[0] - a[0] * b[0], c[1] - a[1] * b[1]]
    }

    #[inline(always)]
    fn sum(self, a: [f64; 2]) -> f64 {
        a[0] + a[1]
    }

    #[inline(always)]
    fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES] {
        std::array::from_fn(|j| Lane(std::array::from_fn(|i| rows[i][j])))
    }
}

/// Eight numbers of a record.
///
/// # Panics
///
/// When the record ends before.
#[must_use]
#[inline(always)]
pub fn eight(record: &[f64], at: usize) -> &[f64; LANES] {
    let (chunks, _) = record[at..at + LANES].as_chunks();
    &chunks[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Turn;

    impl Kernel for Turn {
        type Output = [Lane; LANES];

        #[inline(always)]
        fn run<V: Vectors>(self, vectors: V) -> [Lane; LANES] {
            let rows: [[f64; LANES]; LANES] = std::array::from_fn(|i| std::array::from_fn(|j| (10 * i + j) as f64));
            vectors.turned(&rows.each_ref())
        }
    }

    #[test]
    fn rows_become_columns_with_every_instruction_set() {
        for turned in Level::available().map(|level| level.run(Turn)) {
            for (j, lane) in turned.iter().enumerate() {
                assert_eq!(lane.0, std::array::from_fn(|i| (10 * i + j) as f64));
            }
        }
    }
}
