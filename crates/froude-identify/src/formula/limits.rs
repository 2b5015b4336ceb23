//! Bounds of what a formula may be.

/// Most characters of a formula.
pub const LENGTH_LIMIT: usize = 4096;

/// Most parentheses open at once.
pub const DEPTH_LIMIT: usize = 24;

/// Most coefficients of a formula.
pub const COEFFICIENT_LIMIT: usize = 64;
