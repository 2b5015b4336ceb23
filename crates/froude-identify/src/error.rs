//! Why a campaign gives no coefficients.

use froude_fit::FitError;
use froude_records::RecordError;

use crate::dataset::Dataset;

/// Why a campaign gives no coefficients; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// The fit refused.
    #[error("source {source_name:?}, model {model}: {source}")]
    Fit {
        /// Name of the source.
        source_name: String,
        /// Name of the model.
        model: String,
        /// Why.
        source: Box<FitError>,
    },

    /// A law that these observations cannot give.
    #[error("source {source_name:?}, model {model}: {why}")]
    NoFit {
        /// Name of the source.
        source_name: String,
        /// Name of the model.
        model: String,
        /// Why, and what to do.
        why: String,
    },

    /// None of the models of a source could be fitted, and the observations themselves look wrong.
    #[error("{}{}", .reasons.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
        .found.iter().map(|f| format!("\nfound in the data: {f}")).collect::<String>())]
    NothingFitted {
        /// Why, model by model.
        reasons: Vec<IdentifyError>,
        /// Errors that were found in the observations before anything was fitted.
        found: Vec<String>,
    },

    /// Nothing is left to fit.
    #[error("source {source_name:?}: no observation is left after `keep`; {n_read} were read")]
    NothingKept {
        /// Name of the source.
        source_name: String,
        /// Rows before `keep`.
        n_read: usize,
    },

    /// A campaign key that contradicts another or the data.
    #[error("{place}: {what}")]
    Campaign {
        /// Where.
        place: String,
        /// What is wrong and what to do.
        what: String,
    },

    /// Anything else that is wrong with a campaign, a record or a table, in words with its place.
    #[error("{0}")]
    Refused(String),
}

impl IdentifyError {
    /// A column that a law needs and the table does not have.
    pub(crate) fn no_such_channel(model: &str, channel: &str, data: &Dataset) -> Self {
        let known = data.channels.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        Self::Refused(format!(
            "model {model}: needs the column {channel}, which the table does not have; it has {known}"
        ))
    }
}
