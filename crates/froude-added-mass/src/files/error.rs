//! Why a file of another program gives no added mass.

/// Why an added mass cannot be put into a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Neither limit is there.
    #[error("there is neither an added mass at zero nor one at infinite frequency; at least one is needed")]
    Empty,
    /// A scale of the file is not positive.
    #[error("{what} is {value}; it must be finite and above 0")]
    Scale {
        /// Which one.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// No body, or more than a file holds.
    #[error("{count} bodies; a file holds 1 to {MOST_BODIES}")]
    BodyCount {
        /// What was given.
        count: usize,
    },
    /// A name that readers would take apart, or one that comes twice.
    #[error("the name {name:?} of body {body} {problem}")]
    BodyName {
        /// Counted from 1.
        body: usize,
        /// The name.
        name: String,
        /// What is wrong, as the rest of a sentence.
        problem: &'static str,
    },
    /// A matrix of another size than the bodies ask for.
    #[error("added mass at {limit} frequency: {what} {found}; {expected} are needed, 6 a body")]
    Shape {
        /// `zero` or `infinite`.
        limit: &'static str,
        /// Rows, or which row.
        what: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A number that is none.
    #[error("added mass at {limit} frequency: element {row}, {column} is {value}, not a finite number")]
    NotFinite {
        /// `zero` or `infinite`.
        limit: &'static str,
        /// Counted from 1.
        row: usize,
        /// Counted from 1.
        column: usize,
        /// What it is.
        value: f64,
    },
    /// A file name that names no format.
    #[error("the name of the file ends in none of .1 (WAMIT), .nc (NetCDF), .csv")]
    Format,
}

/// Most bodies of a file: a file of NetCDF-3 is smaller than 2 GiB.
pub(super) const MOST_BODIES: usize = 999;
