//! The instruction sets of x86-64.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always, unsafe_code)]

use std::arch::x86_64::{
    __m256d, __m512d, _mm_add_pd, _mm_add_sd, _mm_cvtsd_f64, _mm_unpackhi_pd, _mm256_castpd256_pd128,
    _mm256_extractf128_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_permute2f128_pd,
    _mm256_set1_pd, _mm256_storeu_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm512_fmadd_pd, _mm512_fnmadd_pd,
    _mm512_load_pd, _mm512_loadu_pd, _mm512_mul_pd, _mm512_reduce_add_pd, _mm512_set1_pd, _mm512_shuffle_f64x2,
    _mm512_store_pd, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
};

use super::{Kernel, LANES, Lane, Vectors};

/// Proof that the processor has AVX2 and fused multiply-add.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(());

/// Proof that the processor has AVX-512 F, DQ and VL.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(());

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
        let has = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
            && is_x86_feature_detected!("fma");
        has.then_some(Self(()))
    }

    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
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
    const REGISTERS: usize = 32;

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
    fn sum(self, a: __m512d) -> f64 {
        unsafe { _mm512_reduce_add_pd(a) }
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
    const REGISTERS: usize = 16;

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
    fn sum(self, a: __m256d) -> f64 {
        unsafe {
            let halves = _mm_add_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd::<1>(a));
            _mm_cvtsd_f64(_mm_add_sd(halves, _mm_unpackhi_pd(halves, halves)))
        }
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
