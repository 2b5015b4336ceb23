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

    /// There is nothing to fit.
    #[error("the design has no columns; name at least one coefficient")]
    NoCoefficients,

    /// Two parts of the problem do not have the same length.
    #[error("{what} has {found} entries where {expected} are needed ({of})")]
    Size {
        /// The part that has the wrong length.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
        /// What sets that length.
        of: &'static str,
    },

    /// An entry of the design is NaN or infinite.
    #[error("design row {row}, column {name:?} is {value}; every entry must be finite")]
    DesignNotFinite {
        /// Row of the entry.
        row: usize,
        /// Name of the coefficient of that column.
        name: String,
        /// The entry.
        value: f64,
    },

    /// A response is NaN or infinite.
    #[error("response of row {row} is {value}; every entry must be finite")]
    ResponseNotFinite {
        /// Row of the response.
        row: usize,
        /// The response.
        value: f64,
    },

    /// A weight is below zero or not finite.
    #[error(
        "weight of row {row} is {weight}; a weight is a relative 1/variance, finite and \
         not negative (0 ignores the row)"
    )]
    Weight {
        /// Row of the weight.
        row: usize,
        /// The weight.
        weight: f64,
    },

    /// Two coefficients have the same name.
    #[error("coefficient {name:?} is named twice (columns {first} and {second}); rename one")]
    DuplicateName {
        /// The name.
        name: String,
        /// First column with that name.
        first: usize,
        /// Second column with that name.
        second: usize,
    },

    /// A row belongs to a component that does not exist.
    #[error("row {row} belongs to component {component}, but only {count} are named")]
    NoSuchComponent {
        /// The row.
        row: usize,
        /// Its component.
        component: usize,
        /// How many components there are.
        count: usize,
    },

    /// A component has no row.
    #[error("component {name:?} has no rows; leave it out or add its observations")]
    EmptyComponent {
        /// The component.
        name: String,
    },

    /// An option names a coefficient by an index that does not exist.
    #[error("{option} names coefficient {index}, but the design has {count}")]
    NoSuchCoefficient {
        /// The option.
        option: &'static str,
        /// The index.
        index: usize,
        /// How many coefficients there are.
        count: usize,
    },

    /// Two options say different things about one coefficient.
    #[error("coefficient {name:?} is {first} and {second} at once; choose one")]
    Conflict {
        /// The coefficient.
        name: String,
        /// One option.
        first: &'static str,
        /// The other.
        second: &'static str,
    },

    /// The bounds of a coefficient leave nothing.
    #[error("bounds of {name:?} are [{lower}, {upper}]; the lower must not exceed the upper")]
    Bounds {
        /// The coefficient.
        name: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A fixed value lies outside the bounds of its coefficient.
    #[error("coefficient {name:?} is fixed at {value}, outside its bounds [{lower}, {upper}]")]
    FixedOutsideBounds {
        /// The coefficient.
        name: String,
        /// Its value.
        value: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A number given as an option is not usable.
    #[error("{option} is {value}; it must be {must}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// No coefficients satisfy all constraints.
    #[error("no coefficients satisfy all constraints at once; drop or widen one")]
    Infeasible,

    /// The interior-point solver gave up and its result could not be repaired.
    #[error("the constrained fit did not end: {reason}; rescale or drop a constraint")]
    Solver {
        /// What the solver said.
        reason: String,
    },

    /// Cluster covariance without clusters.
    #[error(
        "cluster-robust covariance needs a cluster for every row, and none are given: name the column that has them, group = \"run\" say"
    )]
    NoClusters,

    /// Too few clusters for an interval that means anything.
    #[error(
        "component {component:?} has {found} {}; cluster-robust covariance (CR3) is \
         refused below {needed}, where its interval is unreliable",
        if *found == 1 { "cluster" } else { "clusters" }
    )]
    TooFewClusters {
        /// The component.
        component: String,
        /// How many clusters it has.
        found: usize,
        /// How many are needed.
        needed: usize,
    },

    /// One cluster alone determines some coefficient.
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

    /// One row alone determines some coefficient.
    #[error(
        "row {row} alone determines a coefficient (leverage 1); HC3 needs every one \
         determined by the other rows"
    )]
    RowDecides {
        /// The row.
        row: usize,
    },

    /// A method does not do what was asked.
    #[error("{method} does not accept {what}")]
    Unsupported {
        /// The method.
        method: &'static str,
        /// What it does not take.
        what: &'static str,
    },

    /// A component has no degrees of freedom left where some are needed.
    #[error(
        "component {component:?} has {n} rows for {rank} coefficients: none is left to \
         estimate its standard deviation from"
    )]
    NoDegreesOfFreedom {
        /// The component.
        component: String,
        /// Its rows.
        n: usize,
        /// The coefficients they determine.
        rank: usize,
    },
}
