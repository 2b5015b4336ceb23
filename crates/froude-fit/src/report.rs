//! How an iteration ended.

/// The end of an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The stopping rule was met.
    Converged,
    /// The largest number of iterations was reached first.
    IterationLimit,
    /// No step made progress any more; the result is the best found.
    Stalled,
}

/// How an iteration ended, and after how many steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Report {
    /// Its end.
    pub end: End,
    /// Steps taken.
    pub iterations: usize,
}

impl Report {
    /// The worse end, the larger number of steps.
    pub(crate) fn merge(self, other: Self) -> Self {
        Self {
            end: if self.end == End::Converged { other.end } else { self.end },
            iterations: self.iterations.max(other.iterations),
        }
    }
}
