//! What can be wrong with a problem, and what to do about it.

/// Why a fit could not be made.
///
/// Rows and columns count from 0, in the order in which they were given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There is nothing to fit to.
    #[error("the problem has no rows; give at least one observation")]
    NoRows,

    /// An entry of the design, or a response, is NaN or infinite: in words. A search that ran away ends so.
    #[error("{0}")]
    NotFinite(String),

    /// No coefficients satisfy all constraints.
    #[error("no coefficients satisfy all constraints at once; drop or widen one")]
    Infeasible,

    /// CR3 without clusters.
    #[error(
        "cluster-robust covariance needs a cluster for every row, and none are given: name the column that has them, group = \"run\" say"
    )]
    NoClusters,

    /// CR3, and a cluster cannot be left out. Coarser or other clusters may do.
    #[error(
        "without its {}. cluster in order of appearance component {component:?} no longer determines its \
         coefficients; the cluster jackknife (CR3) needs every one determined by the others (offsets of the clusters are determined by none)",
        cluster + 1
    )]
    ClusterDecides {
        /// The cluster.
        cluster: usize,
        /// The component.
        component: String,
    },

    /// Anything else that is wrong with the problem or an option, in words.
    #[error("{0}")]
    Refused(String),
}

impl FitError {
    pub(crate) fn no_coefficients() -> Self {
        Self::Refused("the design has no columns; name at least one coefficient".to_owned())
    }

    pub(crate) fn design_not_finite(row: usize, name: &str, value: f64) -> Self {
        Self::NotFinite(format!("design row {row}, column {name:?} is {value}; every entry must be finite"))
    }

    pub(crate) fn response_not_finite(row: usize, value: f64) -> Self {
        Self::NotFinite(format!("response of row {row} is {value}; every entry must be finite"))
    }

    /// A number of an option that is not what it `must` be.
    pub(crate) fn option(option: &str, value: f64, must: &str) -> Self {
        Self::Refused(format!("{option} is {value}; it must be {must}"))
    }
}
