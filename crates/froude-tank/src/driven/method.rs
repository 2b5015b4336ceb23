//! What a method with a motor-driven body does itself: how it is read, and its equation.

use froude_identify::declare::Values;
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::block::{Block, ResultColumn, TableBuilder};
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{Law, Measured, ReferencePoint};
use froude_records::finding::Finding;
use indexmap::IndexMap;

use super::derived::Sum;
use super::fitted::Fitted;
use super::setup::Setup;
use super::spec::{Coefficient, Constant, Number, Point, Spec, Terms};
use super::still_run::Zeroing;
use crate::error::TankError;
use crate::joint::forecast::Forecast;

/// What a method is declared in.
#[derive(Debug, Clone, Copy)]
pub struct Declared<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The source.
    pub source: &'a Source,
    /// Its section.
    pub values: &'a Values,
    /// Configurations of its runs.
    pub configurations: &'a [String],
}

/// A method with a motor-driven body, as a campaign declares it, with one law.
pub trait MotorDriven: Clone + std::fmt::Debug + Send + Sync + 'static {
    /// What it is.
    const SPEC: Spec;

    /// Checks keys against each other.
    ///
    /// # Errors
    ///
    /// The first contradiction, with its place.
    fn check(_: &Values) -> Result<(), RecordError> {
        Ok(())
    }

    /// Checks the keys of a block of the plan against each other.
    ///
    /// # Errors
    ///
    /// The first contradiction, with its place.
    fn check_plan(_: &Values) -> Result<(), RecordError> {
        Ok(())
    }

    /// How the load cell was zeroed for still runs; `None` where that is not declared, or the method uses no still runs.
    ///
    /// # Errors
    ///
    /// A cell that was zeroed for each run.
    fn zeroing(_: &Values) -> Result<Option<Zeroing>, RecordError> {
        Ok(None)
    }

    /// One method for each requested law, or for `law` alone if it is given.
    ///
    /// # Errors
    ///
    /// What is missing, and what to write.
    fn read(declared: &Declared<'_>, law: Option<&str>) -> Result<Vec<Self>, MethodError>;

    /// Its constants, in the order in which the twin draws them.
    ///
    /// # Errors
    ///
    /// What is missing, and what to write.
    fn constants(&self, declared: &Declared<'_>) -> Result<Vec<Constant>, MethodError>;

    /// Its coefficients.
    fn coefficients(&self) -> Vec<Coefficient>;

    /// Name of its law.
    fn law(&self) -> &str {
        Self::SPEC.law
    }

    /// Other names allowed in `[simulate.coefficients]`: coefficients of the law that act on another load.
    fn unused(&self) -> Vec<String> {
        Vec::new()
    }

    /// The equation: each load of the rig on what is mounted, without its zero, as a sum of terms. `constants` belong to [`Self::constants`]; `motion` has value and
    /// two derivatives at each sample.
    ///
    /// # Errors
    ///
    /// A law that cannot be evaluated.
    fn terms(&self, run: &Point, constants: &[f64], motion: &[[f64; 3]], add: &mut Terms<'_>) -> Result<(), TankError>;

    /// How the rig is set up or what is subtracted; ends a sentence of page and record.
    fn held(&self) -> String;

    /// What is mounted, as columns of the table of runs.
    fn mounted<'p>(&self, _: &TableBuilder<'p, &'p Point>) -> Vec<ResultColumn> {
        Vec::new()
    }

    /// Refuses runs that do not share one set of coefficients.
    ///
    /// # Errors
    ///
    /// What differs, and what to do.
    fn check_runs(&self, _runs: &[&Point]) -> Result<(), TankError> {
        Ok(())
    }

    /// Numbers of a run with this amplitude, rad or m, and angular frequency, rad/s.
    fn numbers(&self, _run: &Point, _setup: &Setup<Self>, _amplitude: f64, _omega_rad_s: f64) -> Vec<Number> {
        Vec::new()
    }

    /// What follows linearly from the coefficients.
    fn sums(&self, _setup: &Setup<Self>, _runs: &[&Point]) -> Vec<Sum> {
        Vec::new()
    }

    /// The law of a record.
    fn law_of_record(&self, setup: &Setup<Self>) -> Law;

    /// What the coefficients refer to.
    fn refers_to(&self, _setup: &Setup<Self>, _runs: &[&Point]) -> IndexMap<String, Measured> {
        IndexMap::new()
    }

    /// The reference point.
    fn reference_point(&self, campaign: &Campaign) -> ReferencePoint {
        crate::joint::record::reference_point(campaign)
    }

    /// Findings about the runs, whichever the law.
    fn about_runs(&self, _fitted: &Fitted<'_, Self>) -> Vec<Finding> {
        Vec::new()
    }

    /// Findings that only this method has, about the fit.
    fn about_fit(&self, _fitted: &Fitted<'_, Self>) -> Vec<Finding> {
        Vec::new()
    }

    /// Notes of the record that only this method has.
    fn notes(&self, _fitted: &Fitted<'_, Self>) -> Vec<String> {
        Vec::new()
    }

    /// What only this method has on the page, behind the coefficients.
    fn blocks(&self, _fitted: &Fitted<'_, Self>) -> Vec<Block> {
        Vec::new()
    }

    /// What only this method says about a plan; `rates` are the smallest and the largest amplitude of the rate of its runs in water.
    fn about_plan(&self, _forecast: &Forecast, _rates: [f64; 2]) -> Vec<String> {
        Vec::new()
    }
}
