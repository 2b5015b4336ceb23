//! The axis of a body that lies along the travel.

/// An axis of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BodyAxis {
    /// Forward.
    X,
    /// To starboard.
    Y,
    /// Down.
    Z,
}

impl BodyAxis {
    /// Each of them.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];
    /// Their letters.
    pub const NAMES: [&'static str; 3] = ["x", "y", "z"];

    /// Its letter.
    #[must_use]
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}
