//! What a method gives of a source: laws fitted to observations, or an estimate that it made by a fit of its own.

use froude_records::estimate::Estimate;

use crate::result::{ReadFile, SourceResult};

/// One answer of a method.
#[derive(Debug, Clone)]
pub enum Answer {
    /// Observations with the laws that the common regression fitted to them.
    Fitted(Box<SourceResult>),
    /// An estimate with its own covariance; there is no table of observations.
    Made(Box<Made>),
}

/// An estimate that the method made by a fit of its own: of filtered time series, of a potential flow, of a frequency response.
#[derive(Debug, Clone)]
pub struct Made {
    /// Name of the answer.
    pub name: String,
    /// The estimate.
    pub estimate: Estimate,
    /// Files that it was made from.
    pub files: Vec<ReadFile>,
}

impl Answer {
    /// Its name: that of the source, with the method's where a source has several answers.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Fitted(result) => &result.name,
            Self::Made(made) => &made.name,
        }
    }

    /// Its estimates: one for each law that was fitted.
    #[must_use]
    pub fn estimates(&self) -> &[Estimate] {
        match self {
            Self::Fitted(result) => &result.estimates,
            Self::Made(made) => std::slice::from_ref(&made.estimate),
        }
    }

    /// The same, to be completed.
    pub fn estimates_mut(&mut self) -> &mut [Estimate] {
        match self {
            Self::Fitted(result) => &mut result.estimates,
            Self::Made(made) => std::slice::from_mut(&mut made.estimate),
        }
    }

    /// Files that were read for it.
    #[must_use]
    pub fn files(&self) -> &[ReadFile] {
        match self {
            Self::Fitted(result) => &result.files,
            Self::Made(made) => &made.files,
        }
    }

    /// Observations, or rows of the method's own fit.
    #[must_use]
    pub fn observations(&self) -> usize {
        match self {
            Self::Fitted(result) => result.data.observations(),
            Self::Made(made) => made.estimate.n_observations,
        }
    }

    /// Everything about the fit, where the common regression made it.
    #[must_use]
    pub fn fitted(&self) -> Option<&SourceResult> {
        match self {
            Self::Fitted(result) => Some(result),
            Self::Made(_) => None,
        }
    }
}

impl From<SourceResult> for Answer {
    fn from(result: SourceResult) -> Self {
        Self::Fitted(Box::new(result))
    }
}

impl From<Made> for Answer {
    fn from(made: Made) -> Self {
        Self::Made(Box::new(made))
    }
}
