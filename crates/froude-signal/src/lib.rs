//! Filters, decimation and spectra of uniformly sampled records.
//!
//! Knows no physics: columns of numbers at a constant rate go in, columns come out.
//! Filters that are compared with `scipy` follow its conventions at the ends of a
//! record, so that a published chain can be repeated to the last digits.
//!
//! | module              | what                                                              | ends of the record      |
//! |---------------------|-------------------------------------------------------------------|-------------------------|
//! | [`butterworth`]     | low-pass design, as second-order sections                         | –                       |
//! | [`analogue`]        | what a filter before the log does to a signal, and to noise       | –                       |
//! | [`zero_phase`]      | forward and backward: no phase, twice the attenuation             | odd extension           |
//! | [`differences`]     | central differences                                               | one-sided               |
//! | [`decimate`]        | zero-phase FIR low-pass, every q-th sample                        | zeros                   |
//! | [`block_mean`]      | means of blocks of neighbours                                     | whole blocks alone      |
//! | [`stream`]          | the same chain a chunk at a time, in bounded memory               | as above                |
//! | [`blocks`]          | indices of the moving-block bootstrap                             | –                       |
//! | [`exponential`]     | exact step of a linear system whose inputs stand still             | –                       |
//! | [`two_mass`]        | two masses and a chain: rows of their accelerations, modes         | –                       |
//! | [`harmonic`]        | mean, harmonics and their frequency, with uncertainty             | broken periods count    |
//! | [`resample`]        | values between samples, at the times of another clock             | not-a-knot              |
//! | [`clock`]           | offset, skew and gain of one channel against another              | –                       |
//! | [`smooth`]          | a record and its derivatives under a Gaussian window              | cut                     |
//! | [`lag`]             | lag and drift between two records with clocks of their own        | cut                     |
//! | [`spectrum`]        | Welch spectra                                                     | –                       |
//!
//! **Units.** A rate is in Hz, a time in s, the values are whatever they were (SI in [`two_mass`]).
//! **Time.** Samples are equidistant; gaps and jitter are the caller's, reported before they come here.
//!
//! Not here: high-pass and band-pass filters, the Ljung–Box test
//! (`froude-fit::diagnostics`, where χ² is).
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod analogue;
pub mod block_mean;
pub mod blocks;
pub mod butterworth;
mod cascade;
pub mod clock;
pub mod decimate;
pub mod differences;
mod error;
pub mod exponential;
pub mod harmonic;
pub mod lag;
mod pages;
pub mod resample;
pub mod smooth;
pub mod spectrum;
pub mod stream;
pub mod two_mass;
pub mod zero_phase;

pub use error::SignalError;
