//! Eight rows at a time: vector arithmetic chosen by what the processor has.
//!
//! A kernel is written once, over [`Vectors`], and compiled for AVX-512, for AVX2
//! with fused multiply-add, and plainly. A value of [`Avx512`] or [`Avx2`] exists
//! only after the processor was asked, so holding one is the proof that its
//! instructions may be used: that is all the `unsafe` here rests on.

// What a kernel calls must become part of it, or it is compiled plainly.
#![allow(clippy::inline_always)]

/// Rows in a group.
pub(crate) const LANES: usize = 8;

/// One column of a group of eight rows, on a cache line of its own.
#[repr(C, align(64))]
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// How many pairs of column and sum the registers hold in a sweep.
    const TILE: usize;
    /// Columns in a panel: the registers hold all products of two panels.
    const PANEL: usize;

    /// The same number everywhere.
    fn splat(self, value: f64) -> Self::Vector;
    /// Part `part` of a lane.
    fn load(self, lane: &Lane, part: usize) -> Self::Vector;
    /// Writes part `part` of a lane.
    fn store(self, lane: &mut Lane, part: usize, value: Self::Vector);
    /// `a·b + c`.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// `c − a·b`.
    fn subtract_product(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;
    /// Sum of the numbers in a register, in a fixed order.
    fn sum(self, a: Self::Vector) -> f64;
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

/// Instruction set that kernels run with.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Level {
    /// What every processor of the target has.
    Plain(Plain),
    /// AVX2 with fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Avx2(x86::Avx2),
    /// AVX-512 F.
    #[cfg(target_arch = "x86_64")]
    Avx512(x86::Avx512),
}

impl Level {
    /// All that this processor has, the best first.
    pub(crate) fn available() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let vectors = [x86::Avx512::detect().map(Self::Avx512), x86::Avx2::detect().map(Self::Avx2)];
        #[cfg(not(target_arch = "x86_64"))]
        let vectors: [Option<Self>; 0] = [];
        vectors.into_iter().flatten().chain([Self::Plain(Plain)])
    }

    /// The best that this processor has.
    pub(crate) fn detect() -> Self {
        Self::available().next().unwrap_or(Self::Plain(Plain))
    }

    /// Runs a kernel.
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
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
pub(crate) struct Plain;

impl Vectors for Plain {
    type Vector = [f64; 2];
    const PARTS: usize = 4;
    const TILE: usize = 4;
    const PANEL: usize = 3;

    #[inline(always)]
    fn splat(self, value: f64) -> Self::Vector {
        [value; 2]
    }

    #[inline(always)]
    fn load(self, lane: &Lane, part: usize) -> Self::Vector {
        [lane.0[2 * part], lane.0[2 * part + 1]]
    }

    #[inline(always)]
    fn store(self, lane: &mut Lane, part: usize, value: Self::Vector) {
        [lane.0[2 * part], lane.0[2 * part + 1]] = value;
    }

    #[inline(always)]
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        [a[0] * b[0] + c[0], a[1] * b[1] + c[1]]
    }

    #[inline(always)]
    fn subtract_product(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector {
        [c[0] - a[0] * b[0], c[1] - a[1] * b[1]]
    }

    #[inline(always)]
    fn sum(self, a: Self::Vector) -> f64 {
        a[0] + a[1]
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod x86 {
    use std::arch::x86_64::{
        __m256d, __m512d, _mm_add_pd, _mm_add_sd, _mm_cvtsd_f64, _mm_unpackhi_pd, _mm256_castpd256_pd128,
        _mm256_extractf128_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_set1_pd, _mm256_storeu_pd,
        _mm512_fmadd_pd, _mm512_fnmadd_pd, _mm512_load_pd, _mm512_reduce_add_pd, _mm512_set1_pd, _mm512_store_pd,
    };

    use super::{Kernel, Lane, Vectors};

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

    // SAFETY, for every block below: `self` proves that the processor has the
    // instruction; a lane is 64 bytes, aligned to 64, and `part < PARTS` (checked).
    impl Vectors for Avx512 {
        type Vector = __m512d;
        const PARTS: usize = 1;
        const TILE: usize = 10;
        const PANEL: usize = 5;

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
    }

    impl Vectors for Avx2 {
        type Vector = __m256d;
        const PARTS: usize = 2;
        const TILE: usize = 5;
        const PANEL: usize = 3;

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
    }
}
