//! What can be wrong with a model or its parameters, and what to do about it.

/// Why a non-linear fit, or a number asked of it, could not be made.
///
/// Runs, rows and parameters count from 0, in the order in which they were given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NonlinearError {
    /// There is nothing to fit.
    #[error("no parameters are given; name at least one")]
    NoParameters,

    /// There is nothing to fit to.
    #[error("the model has no runs; give at least one")]
    NoRuns,

    /// A run has no residuals.
    #[error("run {run} has no residuals; leave it out")]
    NoRows {
        /// The run.
        run: usize,
    },

    /// Fewer residuals than parameters.
    #[error("{rows} residuals cannot determine {parameters} free parameters; add data or fix some")]
    TooFewRows {
        /// Residuals of all runs.
        rows: usize,
        /// Parameters that are not fixed by equal bounds.
        parameters: usize,
    },

    /// Two parameters have the same name.
    #[error("parameter {name:?} is named twice (parameters {first} and {second}); rename one")]
    DuplicateName {
        /// The name.
        name: String,
        /// First parameter with that name.
        first: usize,
        /// Second parameter with that name.
        second: usize,
    },

    /// A number of a parameter is not usable.
    #[error("{what} of {name:?} is {value}; it must be {must}")]
    Number {
        /// The parameter.
        name: String,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// The bounds of a parameter leave nothing.
    #[error("bounds of {name:?} are [{lower}, {upper}]; the lower must not exceed the upper")]
    Bounds {
        /// The parameter.
        name: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A start lies outside the bounds of its parameter.
    #[error("{name:?} starts at {start}, outside its bounds [{lower}, {upper}]; start inside or widen them")]
    StartOutsideBounds {
        /// The parameter.
        name: String,
        /// Its start.
        start: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },

    /// A nuisance parameter belongs to a run that does not exist.
    #[error("{name:?} belongs to run {run}, but the model has {runs}")]
    NoSuchRun {
        /// The parameter.
        name: String,
        /// Its run.
        run: usize,
        /// How many runs there are.
        runs: usize,
    },

    /// A setting is not usable.
    #[error("{setting} is {value}; it must be {must}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// The model says that it is impossible at the start.
    #[error("the model of run {run} is impossible at the start; start elsewhere")]
    Impossible {
        /// The run.
        run: usize,
    },

    /// A residual at the start is NaN, or its square is not finite.
    #[error("residual {row} of run {run} is {value} at the start; it and its square must be finite")]
    ResidualNotFinite {
        /// The run.
        run: usize,
        /// The residual.
        row: usize,
        /// Its value.
        value: f64,
    },

    /// The model gave arrays of a length that does not fit.
    #[error("{what} of run {run}: {found} entries where {expected} are needed")]
    Size {
        /// Which array.
        what: &'static str,
        /// The run.
        run: usize,
        /// Its length.
        found: usize,
        /// The length it should have.
        expected: usize,
    },

    /// A derivative at the start cannot be taken or is not finite.
    #[error(
        "the derivative of run {run} with respect to {name:?} does not exist at the start; start further from where the model is \
         impossible, or make the parameter's scale smaller"
    )]
    NoDerivative {
        /// The run.
        run: usize,
        /// The parameter.
        name: String,
    },

    /// Nothing is left to estimate the noise from.
    #[error("{rows} residuals for {rank} determined parameters leave none to estimate the noise from; add data")]
    NoDegreesOfFreedom {
        /// Residuals of all runs.
        rows: usize,
        /// Parameters they determine.
        rank: usize,
    },
}
