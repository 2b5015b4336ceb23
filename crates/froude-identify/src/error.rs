//! Why a campaign gives no coefficients.

use std::path::PathBuf;

use froude_fit::FitError;
use froude_records::Place;
use froude_records::RecordError;

use crate::formula::FormulaError;

/// Why a campaign gives no coefficients; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// Data behind a record are fitted too.
    #[error(
        "{}: {key}: {} was itself fitted to {file}, which this job fits again: the same data would count twice, and the interval would be too \
         narrow. Take the {key} from a record of other data, or leave it out",
        .campaign.display(),
        .record.display()
    )]
    CountedTwice {
        /// The campaign.
        campaign: PathBuf,
        /// `prior`, `known` or `tare`.
        key: &'static str,
        /// The record.
        record: PathBuf,
        /// The file in common, as this job names it.
        file: String,
    },

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

    /// A user-written formula cannot be used.
    #[error("model {model:?}, {response}: {source}")]
    Formula {
        /// Name of the model.
        model: String,
        /// The load that the formula gives.
        response: String,
        /// Why.
        source: Box<FormulaError>,
    },

    /// One coefficient name stands for two units.
    #[error(
        "model {model:?}: coefficient {coefficient} would be {first} in one formula and {second} \
         in another; give the two terms different names"
    )]
    CoefficientUnits {
        /// Name of the model.
        model: String,
        /// Name of the coefficient.
        coefficient: String,
        /// Unit where it stands first.
        first: String,
        /// Unit where it stands again.
        second: String,
    },

    /// A model asks for a channel that the table does not have.
    #[error(
        "model {model}: needs the column {channel}, which the table does not have; it has {}",
        .known.join(", ")
    )]
    NoSuchChannel {
        /// Name of the model.
        model: String,
        /// The channel.
        channel: String,
        /// What the table has.
        known: Vec<String>,
    },

    /// f1 … f6 without the body that their areas come from.
    #[error("model {model}: needs the body's geometry; the campaign lacks {}", .missing.join(", "))]
    NoBody {
        /// Name of the model.
        model: String,
        /// The missing keys, as the campaign would write them.
        missing: Vec<String>,
    },

    /// A model name that nothing answers to.
    #[error("{}model {model:?} is not known; {advice}", .place.as_ref().map_or_else(String::new, |p| format!("{p}: ")))]
    UnknownModel {
        /// Where it is named, if a file names it.
        place: Option<Place>,
        /// The name asked for.
        model: String,
        /// The name that was probably meant, or what there is.
        advice: String,
    },

    /// A record without the geometry that its law needs.
    #[error("estimate {id}: its law needs geometry.{key}, which the record does not carry")]
    NoGeometry {
        /// Id of the estimate.
        id: String,
        /// The missing key.
        key: String,
    },

    /// A record whose model is not a force law that can be evaluated.
    #[error("estimate {id}: model {model} is not a force law that can be evaluated here")]
    NoForceLaw {
        /// Id of the estimate.
        id: String,
        /// Its model.
        model: String,
    },

    /// A channel of the data that is another quantity than the input of that name in a record.
    #[error(
        "estimate {id}: its law reads {channel} in {recorded}, and the data have {channel} in {found}: another quantity under the same name; \
         rename it in the data, or map it with a sidecar"
    )]
    InputUnit {
        /// Id of the estimate.
        id: String,
        /// The channel.
        channel: String,
        /// SI unit in the record.
        recorded: String,
        /// SI unit in the data.
        found: String,
    },

    /// A coefficient that a prediction needs and its record has no value of.
    #[error(
        "estimate {id}: {coefficient} has no value, as its data do not determine it; forces follow from a law whose coefficients all have one"
    )]
    NoValue {
        /// Id of the estimate.
        id: String,
        /// The coefficient.
        coefficient: String,
    },

    /// Nothing is left to fit.
    #[error("source {source_name:?}: no observation is left after `keep`; {n_read} were read")]
    NothingKept {
        /// Name of the source.
        source_name: String,
        /// Rows before `keep`.
        n_read: usize,
    },

    /// The table has no load with a motion along or about the same axis.
    #[error("{}: no load to fit: {lacks}; the table has {}", path.display(), .columns.join(", "))]
    NoLoad {
        /// The table.
        path: PathBuf,
        /// What it lacks, and what to do.
        lacks: String,
        /// The columns that it has.
        columns: Vec<String>,
    },

    /// A source whose kind of input another verb makes.
    #[error("source {source_name:?}: {what}")]
    NotATable {
        /// Name of the source.
        source_name: String,
        /// What to do instead.
        what: String,
    },

    /// A campaign key that contradicts another or the data.
    #[error("{place}: {what}")]
    Campaign {
        /// Where.
        place: String,
        /// What is wrong and what to do.
        what: String,
    },
}
