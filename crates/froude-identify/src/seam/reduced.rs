//! What a method hands over the seam: observations, laws and what else it states.

use froude_records::campaign::{BudgetEntry, Identify, SourceKind};
use froude_records::estimate::{Attitude, Frame, Measured, Range, ReferencePoint};
use froude_records::finding::Finding;
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::regression::{Scatter, Settings, Weight};
use crate::result::ReadFile;
use crate::uncertainty::SharedError;

/// Observations of one method, and how they are to be fitted.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// Name of the source.
    pub source: String,
    /// Its kind.
    pub kind: SourceKind,
    /// The observations.
    pub data: Dataset,
    /// Rows, or runs, that were read.
    pub n_read: usize,
    /// The laws, each fitted to all of them.
    pub laws: Vec<ForceLaw>,
    /// Laws that a zero of the load cell is looked for beside, further to these; empty where it is not looked for.
    pub beside_zero: Vec<ForceLaw>,
    /// Which of the laws is recommended.
    pub choice: Choice,
    /// What the observations weigh.
    pub weight: Weight,
    /// Where their scatter comes from.
    pub scatter: Scatter,
    /// Declared errors of the channels.
    pub budget: Vec<BudgetEntry>,
    /// Key of the campaign that declares them; empty where none does.
    pub campaign: String,
    /// Errors that observations share, of subtracted tares and of the method itself.
    pub errors: Vec<SharedError>,
    /// Looks that an interval pays for (Bonferroni), 1 or more.
    pub looks: usize,
    /// What the record states beside the fit.
    pub stated: Stated,
    /// Ranges of the observations.
    pub validity: IndexMap<String, Range>,
    /// What was found on the way.
    pub findings: Vec<Finding>,
    /// Files that were read.
    pub files: Vec<ReadFile>,
}

impl Reduced {
    /// Observations of which nothing more is known: weights of their `std_*` columns, scatter of their residuals, no errors, the law chosen by
    /// the data.
    #[must_use]
    pub fn new(source: &str, kind: SourceKind, method: &str, data: Dataset, laws: Vec<ForceLaw>) -> Self {
        Self {
            source: source.to_owned(),
            kind,
            n_read: data.rows,
            data,
            laws,
            beside_zero: Vec::new(),
            choice: Choice::Selection,
            weight: Weight::Std,
            scatter: Scatter::Classical,
            budget: Vec::new(),
            campaign: String::new(),
            errors: Vec::new(),
            looks: 1,
            stated: Stated { method: method.to_owned(), frame: Frame::body(), ..Stated::default() },
            validity: IndexMap::new(),
            findings: Vec::new(),
            files: Vec::new(),
        }
    }

    /// How its laws are regressed.
    pub(crate) fn settings<'a>(&'a self, identify: &'a Identify) -> Settings<'a> {
        Settings {
            source_name: &self.source,
            kind: self.kind,
            identify,
            weight: self.weight,
            scatter: &self.scatter,
            budget: &self.budget,
            campaign: &self.campaign,
            shared_errors: &self.errors,
            looks: self.looks,
            condensed: None,
        }
    }
}

/// Who says which law is recommended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Choice {
    /// The data, among all laws; each estimate is called after its law.
    Selection,
    /// The method, which has one law, in words; the estimate is called after the method, and whether it is better than those of other methods is
    /// for these to say.
    Method(String),
}

/// What a record states that no fit tells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stated {
    /// Name of the method: `table`, `mcd`, ….
    pub method: String,
    /// How the numbers were made, in words; `None` for those of the regression.
    pub words: Option<String>,
    /// Axes of the coefficients.
    pub frame: Frame,
    /// The point that moments are about.
    pub point: ReferencePoint,
    /// How the body was held.
    pub attitude: Option<Attitude>,
    /// What the coefficients refer to, beside the mean density and the geometry in the law.
    pub refers_to: IndexMap<String, Measured>,
    /// Constants of the method, beside those of the law.
    pub constants: IndexMap<String, Measured>,
    /// Names that papers give to coefficients.
    pub labels: IndexMap<String, String>,
    /// Numbers made from coefficients, outside the covariance.
    pub derived: Vec<Derived>,
}

/// A number that is a coefficient times a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: String,
    /// How it is made, in symbols of the record.
    pub formula: String,
    /// The coefficient.
    pub of: String,
    /// The factor, above zero.
    pub factor: f64,
    /// Standard uncertainty of the factor, as a part of it.
    pub factor_relative: f64,
    /// SI unit text of the product.
    pub unit: String,
}
