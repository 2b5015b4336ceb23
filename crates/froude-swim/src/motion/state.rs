//! Where a swimmer is, how it moves, and what its joints and the water have taken: the same numbers are the rates of all of it.
//!
//! Work and loss are integrated as states, so that W − E_loss − ΔE is what the integration itself loses.
//!
//! **Units.** SI.

use std::fmt::Debug;

/// A few numbers in a row.
pub trait Numbers: Copy + Debug + PartialEq + Send + Sync + AsRef<[f64]> + AsMut<[f64]> {
    /// How many.
    const LEN: usize;
    /// All zero.
    const ZERO: Self;

    /// The first of a slice.
    #[must_use]
    #[inline(always)]
    fn first_of(slice: &[f64]) -> Self {
        let mut out = Self::ZERO;
        out.as_mut().copy_from_slice(&slice[..Self::LEN]);
        out
    }
}

impl<const N: usize> Numbers for [f64; N] {
    const LEN: usize = N;
    const ZERO: Self = [0.0; N];
}

/// Integrals of the powers, in their order, J: Σ τφ̇ of the motors, what drag takes, Σ max(τφ̇, 0), Σ |τφ̇|, and what friction of the joints takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Energy {
    /// Σ τφ̇.
    Work,
    /// Of drag.
    Loss,
    /// Σ max(τφ̇, 0).
    Positive,
    /// Σ |τφ̇|.
    Absolute,
    /// Of the joints.
    Friction,
}

/// Number of integrals.
pub const ENERGIES: usize = 5;

/// A state; the same numbers are its rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<P, M> {
    /// Place of the head's centre in the tank, and how it lies.
    pub pose: P,
    /// Its motion through the water, in its own axes.
    pub head: M,
    /// In the order of [`Energy`].
    pub energy_j: [f64; ENERGIES],
}

impl<P: Numbers, M: Numbers> State<P, M> {
    /// With nothing given or taken yet.
    #[must_use]
    pub fn new(pose: P, head: M) -> Self {
        Self { pose, head, energy_j: [0.0; ENERGIES] }
    }

    /// One of its integrals, J.
    #[must_use]
    pub fn energy(&self, of: Energy) -> f64 {
        self.energy_j[of as usize]
    }

    /// self + h rate; a quaternion is not normalised here.
    #[must_use]
    #[inline(always)]
    pub fn moved(&self, h: f64, rate: &Self) -> Self {
        let mut out = *self;
        add(out.pose.as_mut(), h, rate.pose.as_ref());
        add(out.head.as_mut(), h, rate.head.as_ref());
        add(&mut out.energy_j, h, &rate.energy_j);
        out
    }
}

/// to += by · of.
#[inline(always)]
pub(crate) fn add(to: &mut [f64], by: f64, of: &[f64]) {
    for (to, of) in to.iter_mut().zip(of) {
        *to += by * of;
    }
}
