//! What the fit of a law gives, with all that it was made from.

use froude_records::campaign::Campaign;

use super::derived::Derived;
use super::run::Run;
use super::setup::Setup;
use crate::joint::JointFit;
use crate::motion::Motion;

/// What a law found.
#[derive(Debug)]
pub struct Fitted<'a, M> {
    /// The fit.
    pub fit: &'a JointFit,
    /// What is declared.
    pub setup: &'a Setup<M>,
    /// The runs.
    pub runs: &'a [Run<'a>],
    /// Their motions.
    pub motions: &'a [Motion],
    /// What follows from the coefficients.
    pub derived: &'a [Derived],
    /// The campaign.
    pub campaign: &'a Campaign,
}
