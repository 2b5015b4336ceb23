//! Eight stretches of a record at a time: vector arithmetic chosen by what the processor has.
//!
//! Eight stretches are interleaved, so that every lane of a register works on its own: loads are aligned, neighbours in
//! time are whole registers, and a recursion runs eight times at once. A kernel is written once, over [`Vectors`], and
//! compiled for AVX-512, for AVX2 with fused multiply-add, and plainly. A value of [`x86::Avx512`] or [`x86::Avx2`]
//! exists only after the processor was asked, so holding one is the proof that its instructions may be used: that is
//! all the `unsafe` here rests on.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

/// Stretches worked on side by side.
pub(crate) const LANES: usize = 8;

/// Eight numbers, one of each stretch, on a cache line of their own.
#[repr(C, align(64))]
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lane(pub(crate) [f64; LANES]);

impl Lane {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);
}

/// Vector arithmetic of one instruction set.
pub(crate) trait Vectors: Copy {
    /// A register of numbers.
    type Vector: Copy;
    /// Registers that hold a [`Lane`].
    const PARTS: usize;
    /// Neighbours in time whose sums, and both of whose sides, the registers hold: 4 or 8.
    const SHARE: usize;

    /// The same number everywhere.
    fn splat(self, value: f64) -> Self::Vector;
    /// Part `part` of a lane.
    fn load(self, lane: &Lane, part: usize) -> Self::Vector;
    /// Writes part `part` of a lane.
    fn store(self, lane: &mut Lane, part: usize, value: Self::Vector);
    /// `a + b`.
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a − b`.
    fn subtract(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a·b`.
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;
    /// `a·b + c`.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// `c − a·b`.
    fn subtract_product(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// Rows into columns: number `j` of row `i` becomes number `i` of lane `j`.
    fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES];
}

/// A kernel, to be compiled for every instruction set.
///
/// `run` must be `#[inline(always)]`, and what it calls as well.
pub(crate) trait Kernel {
    /// What it returns.
    type Output;
    /// The kernel.
    fn run<V: Vectors>(self, vectors: V) -> Self::Output;
}

/// Runs a kernel with the best that this processor has.
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if let Some(avx512) = x86::Avx512::detect() {
            return avx512.run(kernel);
        }
        if let Some(avx2) = x86::Avx2::detect() {
            return avx2.run(kernel);
        }
    }
    kernel.run(Plain)
}

/// No instruction that a processor may lack.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain;

impl Vectors for Plain {
    type Vector = [f64; 2];
    const PARTS: usize = 4;
    const SHARE: usize = 4;

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
    fn add(self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }

    #[inline(always)]
    fn subtract(self, a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
        [a[0] - b[0], a[1] - b[1]]
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
    fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES] {
        std::array::from_fn(|j| Lane(std::array::from_fn(|i| rows[i][j])))
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
pub(crate) mod x86 {
    use std::arch::x86_64::{
        __m256d, __m512d, _mm256_add_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_mul_pd,
        _mm256_permute2f128_pd, _mm256_set1_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_unpackhi_pd,
        _mm256_unpacklo_pd, _mm512_add_pd, _mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_load_pd, _mm512_loadu_pd,
        _mm512_mul_pd, _mm512_set1_pd, _mm512_shuffle_f64x2, _mm512_store_pd, _mm512_sub_pd, _mm512_unpackhi_pd,
        _mm512_unpacklo_pd,
    };

    use super::{Kernel, LANES, Lane, Vectors};

    /// Proof that the processor has AVX2 and fused multiply-add.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Avx2(());

    /// Proof that the processor has AVX-512 F.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Avx512(());

    impl Avx2 {
        pub(crate) fn detect() -> Option<Self> {
            let has = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            has.then_some(Self(()))
        }

        pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
            #[target_feature(enable = "avx2,fma")]
            fn compiled<K: Kernel>(kernel: K, proof: Avx2) -> K::Output {
                kernel.run(proof)
            }
            // SAFETY: `self` proves that the processor has both features.
            unsafe { compiled(kernel, self) }
        }
    }

    impl Avx512 {
        pub(crate) fn detect() -> Option<Self> {
            let has = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("fma");
            has.then_some(Self(()))
        }

        pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
            #[target_feature(enable = "avx512f,avx2,fma")]
            fn compiled<K: Kernel>(kernel: K, proof: Avx512) -> K::Output {
                kernel.run(proof)
            }
            // SAFETY: `self` proves that the processor has these features.
            unsafe { compiled(kernel, self) }
        }
    }

    // SAFETY, for every block below: `self` proves that the processor has the instruction; a lane is 64 bytes, aligned
    // to 64; what else is read or written is a slice of as many numbers as the register holds (checked).
    impl Vectors for Avx512 {
        type Vector = __m512d;
        const PARTS: usize = 1;
        const SHARE: usize = 8;

        #[inline(always)]
        fn splat(self, value: f64) -> __m512d {
            unsafe { _mm512_set1_pd(value) }
        }

        #[inline(always)]
        fn load(self, lane: &Lane, _: usize) -> __m512d {
            unsafe { _mm512_load_pd(lane.0.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, lane: &mut Lane, _: usize, value: __m512d) {
            unsafe { _mm512_store_pd(lane.0.as_mut_ptr(), value) }
        }

        #[inline(always)]
        fn add(self, a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_add_pd(a, b) }
        }

        #[inline(always)]
        fn subtract(self, a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_sub_pd(a, b) }
        }

        #[inline(always)]
        fn multiply(self, a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_mul_pd(a, b) }
        }

        #[inline(always)]
        fn multiply_add(self, a: __m512d, b: __m512d, c: __m512d) -> __m512d {
            unsafe { _mm512_fmadd_pd(a, b, c) }
        }

        #[inline(always)]
        fn subtract_product(self, a: __m512d, b: __m512d, c: __m512d) -> __m512d {
            unsafe { _mm512_fnmadd_pd(a, b, c) }
        }

        #[inline(always)]
        fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES] {
            let mut out = [Lane::ZERO; LANES];
            unsafe {
                for odd in 0..2 {
                    // Closures would be compiled without the instructions.
                    macro_rules! pair {
                        ($i:literal) => {{
                            let (a, b) = (_mm512_loadu_pd(rows[$i].as_ptr()), _mm512_loadu_pd(rows[$i + 1].as_ptr()));
                            if odd == 0 { _mm512_unpacklo_pd(a, b) } else { _mm512_unpackhi_pd(a, b) }
                        }};
                    }
                    let (a, b, c, d) = (pair!(0), pair!(2), pair!(4), pair!(6));
                    let (ab_even, ab_odd) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0xdd>(a, b));
                    let (cd_even, cd_odd) = (_mm512_shuffle_f64x2::<0x88>(c, d), _mm512_shuffle_f64x2::<0xdd>(c, d));
                    self.store(&mut out[odd], 0, _mm512_shuffle_f64x2::<0x88>(ab_even, cd_even));
                    self.store(&mut out[odd + 2], 0, _mm512_shuffle_f64x2::<0x88>(ab_odd, cd_odd));
                    self.store(&mut out[odd + 4], 0, _mm512_shuffle_f64x2::<0xdd>(ab_even, cd_even));
                    self.store(&mut out[odd + 6], 0, _mm512_shuffle_f64x2::<0xdd>(ab_odd, cd_odd));
                }
            }
            out
        }
    }

    impl Vectors for Avx2 {
        type Vector = __m256d;
        const PARTS: usize = 2;
        const SHARE: usize = 4;

        #[inline(always)]
        fn splat(self, value: f64) -> __m256d {
            unsafe { _mm256_set1_pd(value) }
        }

        #[inline(always)]
        fn load(self, lane: &Lane, part: usize) -> __m256d {
            let half = &lane.0[4 * part..4 * part + 4];
            unsafe { _mm256_loadu_pd(half.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, lane: &mut Lane, part: usize, value: __m256d) {
            let half = &mut lane.0[4 * part..4 * part + 4];
            unsafe { _mm256_storeu_pd(half.as_mut_ptr(), value) }
        }

        #[inline(always)]
        fn add(self, a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_add_pd(a, b) }
        }

        #[inline(always)]
        fn subtract(self, a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_sub_pd(a, b) }
        }

        #[inline(always)]
        fn multiply(self, a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_mul_pd(a, b) }
        }

        #[inline(always)]
        fn multiply_add(self, a: __m256d, b: __m256d, c: __m256d) -> __m256d {
            unsafe { _mm256_fmadd_pd(a, b, c) }
        }

        #[inline(always)]
        fn subtract_product(self, a: __m256d, b: __m256d, c: __m256d) -> __m256d {
            unsafe { _mm256_fnmadd_pd(a, b, c) }
        }

        #[inline(always)]
        fn turned(self, rows: &[&[f64; LANES]; LANES]) -> [Lane; LANES] {
            let mut out = [Lane::ZERO; LANES];
            // Four quarters of four by four.
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                unsafe {
                    let a = _mm256_loadu_pd(rows[4 * i][4 * j..4 * j + 4].as_ptr());
                    let b = _mm256_loadu_pd(rows[4 * i + 1][4 * j..4 * j + 4].as_ptr());
                    let c = _mm256_loadu_pd(rows[4 * i + 2][4 * j..4 * j + 4].as_ptr());
                    let d = _mm256_loadu_pd(rows[4 * i + 3][4 * j..4 * j + 4].as_ptr());
                    let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                    let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
                    self.store(&mut out[4 * j], i, _mm256_permute2f128_pd::<0x20>(ab_even, cd_even));
                    self.store(&mut out[4 * j + 1], i, _mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd));
                    self.store(&mut out[4 * j + 2], i, _mm256_permute2f128_pd::<0x31>(ab_even, cd_even));
                    self.store(&mut out[4 * j + 3], i, _mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd));
                }
            }
            out
        }
    }
}

/// Eight numbers of a record.
///
/// # Panics
///
/// When the record ends before.
#[inline(always)]
pub(crate) fn eight(record: &[f64], at: usize) -> &[f64; LANES] {
    let (chunks, _) = record[at..at + LANES].as_chunks();
    &chunks[0]
}

/// As [`run`], with each instruction set that this processor has: for tests.
#[cfg(test)]
pub(crate) fn run_all<K: Kernel>(mut kernel: impl FnMut() -> K) -> Vec<K::Output> {
    let mut out = vec![kernel().run(Plain)];
    #[cfg(target_arch = "x86_64")]
    {
        out.extend(x86::Avx2::detect().map(|v| v.run(kernel())));
        out.extend(x86::Avx512::detect().map(|v| v.run(kernel())));
    }
    out
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
        for turned in run_all(|| Turn) {
            for (j, lane) in turned.iter().enumerate() {
                assert_eq!(lane.0, std::array::from_fn(|i| (10 * i + j) as f64));
            }
        }
    }
}
