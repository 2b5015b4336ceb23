//! A campaign as a person writes it: what is to be found, on which body, from which data.
//!
//! The TOML is read with its places, so that every message names file and line:
//! an unknown key with the nearest known one, a quantity of the wrong kind with
//! both units, a file that does not exist where it is named.
//!
//! Quantities are SI here; paths are joined to the campaign's folder.

use std::path::{Path, PathBuf};

use froude_hydro::Link;
use froude_hydro::drag_curves::Shape;
use indexmap::IndexMap;

use crate::document::Document;
use crate::error::{Place, RecordError};
use crate::estimate::ErrorKind;
use crate::given_option::GivenOption;
use crate::section::Section;
use crate::units::{Dimension, Quantity, Unit};

pub use crate::body_axis::BodyAxis;
pub use crate::keep::{Comparison, Keep, KeepClause, KeepValue};

/// A whole campaign.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Campaign {
    /// The file.
    pub path: PathBuf,
    /// Start of the SHA-256 of its text, hexadecimal: what its sources share is known by it. Empty for a bare table.
    pub key: String,
    /// Its title.
    pub name: String,
    /// What a report on it has to cite.
    pub cite: Vec<String>,
    /// The water.
    pub fluid: Fluid,
    /// The body.
    pub body: Option<BodySpec>,
    /// The tank.
    pub tank: Option<Tank>,
    /// Known numbers that formulas name (`[constants]`).
    pub constants: IndexMap<String, Quantity>,
    /// Where observations and records come from.
    pub sources: Vec<Source>,
    /// How to fit.
    pub identify: Identify,
    /// How to make up observations.
    pub simulate: Option<Simulate>,
    /// Its text, for whoever reads sections of his own out of it; `None` where no file stands behind it.
    pub document: Option<Document>,
}

/// The water: density, or temperature and salinity.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fluid {
    /// Density.
    pub density_kg_m3: Option<f64>,
    /// Its standard uncertainty; 0 where it counts as exact.
    pub density_standard_kg_m3: f64,
    /// Kinematic viscosity.
    pub kinematic_viscosity_m2_s: Option<f64>,
    /// Temperature.
    pub temperature_degc: Option<f64>,
    /// Salinity, grams of salt per kilogram of water.
    pub salinity_g_kg: Option<f64>,
}

/// The body: modules, areas, volumes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BodySpec {
    /// The point that velocities are of and moments are about, in words.
    pub reference_point: Option<String>,
    /// One module.
    pub link: Option<Link>,
    /// Side area of the head, A_yH.
    pub head_side_area_m2: Option<f64>,
    /// Side area of the tail, A_yT.
    pub tail_side_area_m2: Option<f64>,
    /// Length for Reynolds and Froude numbers.
    pub reference_length_m: Option<f64>,
    /// Area for drag coefficients and blockage.
    pub reference_area_m2: Option<f64>,
    /// Its standard uncertainty; 0 where it counts as exact.
    pub reference_area_standard_m2: f64,
    /// The simple shape that it is, whose published drag stands beside its own.
    pub shape: Option<Shape>,
    /// The axis that lies along the travel of a carriage.
    pub travel: Option<BodyAxis>,
    /// Displaced volume.
    pub volume_m3: Option<f64>,
    /// Displaced volume by configuration.
    pub volumes: IndexMap<String, f64>,
    /// Displaced volume of one link.
    pub link_volume_m3: Option<f64>,
}

/// The tank.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tank {
    /// Width of the water.
    pub width_m: Option<f64>,
    /// Depth of the water.
    pub depth_m: Option<f64>,
    /// Depth of the body's axis below the surface.
    pub submergence_m: Option<f64>,
}

/// One source of observations or of published coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Its name, unique in the campaign.
    pub name: String,
    /// What it is.
    pub kind: SourceKind,
    /// Whether the fits of the others are only held against its rows (`role = "validation"`).
    pub is_validation: bool,
    /// Where its numbers lie.
    pub input: Input,
    /// Sidecar of the table, where it is not the one beside it.
    pub sidecar: Option<PathBuf>,
    /// Force models for this source; empty for those of `[identify]`.
    pub models: Vec<String>,
    /// Where each of `models` is named; empty where no file names them.
    pub model_places: Vec<Place>,
    /// Methods that reduce its runs; empty for all that they allow.
    pub methods: Vec<String>,
    /// Where each of `methods` is named.
    pub method_places: Vec<Place>,
    /// Which observations are used.
    pub keep: Option<Keep>,
    /// Text column whose values belong together (clusters, cross-validation).
    pub group: Option<String>,
    /// Loads that an actuator exerts, and not the water.
    pub actuator: Vec<String>,
    /// The sensor budget (type B).
    pub uncertainty: Vec<BudgetEntry>,
    /// A fitted tare that is subtracted.
    pub tare: Option<Tare>,
    /// What its methods read of it themselves; `None` where no campaign names it.
    pub own: Option<OwnSections>,
    /// Options given as flags, where no campaign names the mesh.
    pub given: Vec<GivenOption>,
    /// What is to be run, where no method has a form of its own for it.
    pub plan: Vec<PlanBlock>,
    /// Where it stands in the campaign.
    pub place: Place,
}

/// The sections of a source that belong to its methods: each is read by the crate that uses it.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnSections {
    /// The campaign.
    pub(crate) document: Document,
    /// Which of its sources, from 0.
    pub(crate) index: usize,
}

impl OwnSections {
    fn source(&self) -> Result<Option<Section<'_>>, RecordError> {
        let root = self.document.root();
        let list = root.get("source").and_then(|value| value.get_ref().as_array());
        list.and_then(|list| list.get(self.index)).map(|value| root.as_listed("source", value)).transpose()
    }
}

/// Kind of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceKind {
    /// Circulation tank: the body is held in a stream.
    Tank,
    /// Towing tank.
    Towing,
    /// Flow computation: residuals are model error, not noise.
    Cfd,
    /// Potential flow.
    Potential,
    /// Published coefficients.
    Published,
}

impl SourceKind {
    pub(crate) const NAMES: [&'static str; 5] = ["tank", "towing", "cfd", "potential", "published"];

    /// As written in the campaign.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Where the numbers of a source lie.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Input {
    /// A table of observations.
    Table(PathBuf),
    /// An estimate record.
    Record {
        /// The `estimate.json`.
        path: PathBuf,
        /// `source/model` in it, where it holds several.
        select: Option<String>,
    },
    /// Runs.
    Runs {
        /// Folders of runs, or runs; a campaign names one folder.
        paths: Vec<PathBuf>,
        /// A campaign other than the copy that lies with them.
        campaign: Option<PathBuf>,
    },
    /// A folder of CFD cases.
    Cases(PathBuf),
    /// A surface mesh, or a body file.
    Mesh(PathBuf),
}

impl Input {
    /// The file or folder; of several the first.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Table(path) | Self::Cases(path) | Self::Mesh(path) | Self::Record { path, .. } => path,
            Self::Runs { paths, .. } => paths.first().map_or(Path::new(""), PathBuf::as_path),
        }
    }
}

/// One entry of the sensor budget.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetEntry {
    /// What is uncertain: a column, `density`, `head_side_area`, …
    pub quantity: String,
    /// Standard uncertainty in SI, or as a fraction when `relative`.
    pub standard: f64,
    /// Whether `standard` was given in per cent of the value.
    pub relative: bool,
    /// Who shares the same error.
    pub shared: Shared,
    /// Degrees of freedom behind it; infinite when not given.
    pub dof: Option<f64>,
    /// A name for the budget table.
    pub name: Option<String>,
    /// How it was evaluated.
    pub kind: ErrorKind,
    /// What `standard` measures; a pure number when `relative`.
    pub dimension: Dimension,
    /// Where its quantity is named in the campaign.
    pub place: Place,
}

/// Who shares one error of the budget: shared errors do not average down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shared {
    /// Each observation has its own.
    Sample,
    /// All observations of a run.
    Run,
    /// All observations of a setup.
    Setup,
    /// All observations.
    Campaign,
}

impl Shared {
    pub(crate) const NAMES: [&'static str; 4] = ["sample", "run", "setup", "campaign"];

    /// As written in the campaign.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// A tare record that is subtracted from the loads, or was.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tare {
    /// The `estimate.json`.
    pub record: PathBuf,
    /// `source/model` in it.
    pub select: Option<String>,
    /// Whether the table has it removed already: its uncertainty alone is restored.
    pub is_removed: bool,
}

/// One block of the run matrix: every speed at every angle for every configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanBlock {
    /// Configurations; empty where the body has only one.
    pub configurations: Vec<String>,
    /// Speeds.
    pub speed_m_s: Vec<f64>,
    /// Angles; 0 when not given.
    pub angle_rad: Vec<f64>,
    /// Angles out of the horizontal plane, of computations; 0 when not given.
    pub pitch_rad: Vec<f64>,
    /// How often each point is run; 1 when not given.
    pub repeats: usize,
}

/// How to fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Identify {
    /// Force models; empty for all that apply.
    pub models: Vec<String>,
    /// Where each of `models` is named; empty where no file names them.
    pub model_places: Vec<Place>,
    /// Bounds of coefficients.
    pub bounds: BoundsSpec,
    /// Coefficients held at a value (SI).
    pub fixed: IndexMap<String, f64>,
    /// Coefficients left out.
    pub exclude: Vec<String>,
    /// Published values used as priors.
    pub prior: Vec<PriorSpec>,
    /// Coefficients that are known from elsewhere: held at their value, whose uncertainty is an error that all rows share.
    pub known: Vec<PriorSpec>,
    /// Covariance of the known coefficients, in their order (SI).
    pub known_covariance: Vec<Vec<f64>>,
    /// Covariance of the priors, in their order (SI); 0 between priors of different estimates.
    pub prior_covariance: Vec<Vec<f64>>,
    /// Units in which values of coefficients are written, for the laws to check.
    pub stated_units: Vec<StatedUnit>,
    /// `classical`, `HC3`, `cluster` or `serial`; `None` to choose by the data.
    pub covariance: Option<String>,
    /// Whether rows are weighted by a variance that is fitted to the residuals (`weights = "fitted"`).
    pub fitted_weights: bool,
    /// Whether each group has an offset of its own in each load (`group_offset = "estimate"`).
    pub group_offset: bool,
    /// Declared blocks: train inside, predict outside.
    pub cross_validation: Vec<RangeBlock>,
    /// What to do about the angle between sensor and body.
    pub angle_offset: AngleOffset,
    /// Whether the fit is held to f·v ≤ 0.
    pub dissipative: bool,
    /// Models written by the user.
    pub user_models: Vec<UserModel>,
    /// Whether speed and angle are uncertain too (`errors_in_variables = true`).
    pub errors_in_variables: bool,
}

/// The unit in which a value of a coefficient, or its uncertainty, is written.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedUnit {
    /// The coefficient.
    pub coefficient: String,
    /// The model; `None` for all that have the coefficient.
    pub model: Option<String>,
    /// As it is written.
    pub unit: Unit,
    /// Where it stands in the campaign.
    pub place: Place,
}

/// Bounds of coefficients.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BoundsSpec {
    /// For all that are not named.
    pub default: BoundKind,
    /// By coefficient.
    pub named: IndexMap<String, BoundKind>,
}

/// Bound of one coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BoundKind {
    /// `none` or `free`.
    #[default]
    None,
    /// `non-negative`.
    NonNegative,
}

/// A coefficient with a value and a standard uncertainty from elsewhere: a prior, or one that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorSpec {
    /// The coefficient.
    pub coefficient: String,
    /// Its value (SI).
    pub value: f64,
    /// Its standard uncertainty (SI).
    pub standard_uncertainty: f64,
    /// Degrees of freedom of the standard uncertainty, where a record states them.
    pub dof: Option<f64>,
    /// The model; `None` for all that have the coefficient.
    pub model: Option<String>,
    /// The record that value and uncertainty are taken from, where they are not written.
    pub record: Option<PriorRecord>,
}

/// Where such a value is taken from.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorRecord {
    /// `estimate.json`.
    pub path: PathBuf,
    /// `source/model`; `None` for the recommended one.
    pub select: Option<String>,
    /// Its coefficient, `A66` say.
    pub entry: String,
    /// Reference volume of a coefficient C_A that an entry in kg is a prior of, m³: C_A = A/(ρV).
    pub volume_m3: Option<f64>,
    /// What is added to its uncertainty in the mean square, as part of it: how far an ideal fluid is from a real one.
    pub model_form: f64,
    /// Where it stands in the campaign.
    pub place: Place,
}

/// A declared block of cross-validation: fitted to rows inside, compared with the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeBlock {
    /// The column.
    pub column: String,
    /// Smallest value fitted to (SI).
    pub low: f64,
    /// Largest value fitted to (SI).
    pub high: f64,
}

/// What to do about the angle between sensor and body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleOffset {
    /// Take it as zero.
    #[default]
    Ignore,
    /// Estimate one per setup, where pairs of ±θ exist.
    Estimate,
}

/// A model written by the user.
#[derive(Debug, Clone, PartialEq)]
pub struct UserModel {
    /// Its name.
    pub name: String,
    /// Formula by load (`f_x`, or `X`), or by any other column of numbers.
    pub formulas: IndexMap<String, String>,
}

/// How to make up observations for chosen true coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulate {
    /// Seed: the same seed gives the same table.
    pub seed: u64,
    /// The true coefficients.
    pub truth: Truth,
    /// Where each of them is written, and in which unit.
    pub stated: Vec<StatedTruth>,
    /// The sensors.
    pub sensors: Vec<SensorSpec>,
    /// Angle between sensor and body.
    pub misalignment_rad: Option<f64>,
}

/// How a true coefficient is written in the campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedTruth {
    /// Its name.
    pub coefficient: String,
    /// Its unit; `None` of a plain number, which is in SI.
    pub unit: Option<Unit>,
    /// Where.
    pub place: Place,
}

/// True coefficients of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub enum Truth {
    /// From an estimate record.
    Record {
        /// The `estimate.json`.
        path: PathBuf,
        /// `source/model` in it.
        select: Option<String>,
    },
    /// Written in the campaign (SI).
    Coefficients {
        /// The force model.
        model: String,
        /// Its coefficients by name.
        values: IndexMap<String, f64>,
    },
}

/// One sensor of a simulation; everything in SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SensorSpec {
    /// Where it is declared.
    pub place: Option<Place>,
    /// The column that it makes.
    pub quantity: String,
    /// Standard deviation of its noise.
    pub noise: Option<f64>,
    /// Step of its reading.
    pub resolution: Option<f64>,
    /// Standard deviation of a linear drift over one setup.
    pub drift: Option<f64>,
    /// Constant error.
    pub bias: Option<f64>,
    /// Time over which its noise is correlated, s; white where it is not given.
    pub correlation_s: Option<f64>,
}

impl Campaign {
    /// The campaign that a bare table stands for: one source, no body, no water.
    #[must_use]
    pub fn of_table(table: &Path, sidecar: Option<PathBuf>) -> Self {
        let name = table.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let source = Source { sidecar, ..Source::bare(name.clone(), Input::Table(table.to_owned())) };
        Self { path: table.to_owned(), name, sources: vec![source], ..Self::default() }
    }

    /// The campaign that named runs stand for: one source, called as the runs call theirs.
    #[must_use]
    pub fn of_runs(paths: Vec<PathBuf>, campaign: Option<PathBuf>) -> Self {
        let source = Source::bare(String::new(), Input::Runs { paths, campaign });
        Self { sources: vec![source], ..Self::default() }
    }

    /// The campaign that a mesh or a body file stands for: one source, called as the body is.
    #[must_use]
    pub fn of_mesh(path: &Path, given: Vec<GivenOption>) -> Self {
        let bare = Source::bare(String::new(), Input::Mesh(path.to_owned()));
        let source = Source { kind: SourceKind::Potential, given, ..bare };
        Self { path: path.to_owned(), sources: vec![source], ..Self::default() }
    }

    /// The campaign that records stand for, which are set side by side.
    #[must_use]
    pub fn of_records(paths: &[PathBuf]) -> Self {
        let name = |path: &PathBuf| path.display().to_string();
        let of = |path: &PathBuf| Source::bare(name(path), Input::Record { path: path.clone(), select: None });
        let names: Vec<String> = paths.iter().map(name).collect();
        Self { name: names.join(", "), sources: paths.iter().map(of).collect(), ..Self::default() }
    }

    /// Whether it drives a carriage.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        let rig = self.root().and_then(|root| root.section("rig").ok()?);
        rig.is_some_and(|rig| !matches!(rig.text("kind"), Ok(Some("logs"))))
    }

    /// A table with a plan may still have to be simulated or run, and cases to be computed, those of this source or of another that reads them; everything else must be there.
    pub(crate) fn check_files(&self) -> Result<(), RecordError> {
        let is_planned = |input: &Input| self.sources.iter().any(|s| s.input == *input && !s.plan.is_empty());
        for source in &self.sources {
            let key = match source.input {
                Input::Table(_) if !source.plan.is_empty() => continue,
                Input::Cases(_) if is_planned(&source.input) => continue,
                Input::Runs { .. } if source.plans_runs() => continue,
                Input::Table(_) => "table",
                Input::Record { .. } => "record",
                Input::Runs { .. } => "runs",
                Input::Cases(_) => "cases",
                Input::Mesh(_) => "mesh",
            };
            must_exist(&source.place, key, source.input.path())?;
            if let Some(sidecar) = &source.sidecar {
                must_exist(&source.place, "sidecar", sidecar)?;
            }
            if let Some(tare) = &source.tare {
                must_exist(&source.place, "tare.record", &tare.record)?;
            }
        }
        if let Some(Simulate { truth: Truth::Record { path, .. }, .. }) = &self.simulate {
            must_exist(&Place::whole(&self.path), "simulate.record", path)?;
        }
        Ok(())
    }
}

impl Source {
    /// Whether it plans runs of its method, not rows of a table.
    #[must_use]
    pub fn plans_runs(&self) -> bool {
        let blocks = || self.own_section().ok()??.get("plan");
        matches!(self.input, Input::Runs { .. }) && blocks().is_some()
    }

    /// A section that belongs to a method, `[source.NAME]`.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where it is no table.
    pub fn section(&self, name: &'static str) -> Result<Option<Section<'_>>, RecordError> {
        self.own_section()?.map_or(Ok(None), |source| source.section(name))
    }

    /// The whole of it as it is written; `None` where no campaign names it.
    pub(crate) fn own_section(&self) -> Result<Option<Section<'_>>, RecordError> {
        self.own.as_ref().map_or(Ok(None), OwnSections::source)
    }

    /// Whether it has such a section.
    #[must_use]
    pub fn has_section(&self, name: &'static str) -> bool {
        self.section(name).is_ok_and(|section| section.is_some())
    }

    /// The blocks of its plan, where its runs are of this method.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where they are no tables.
    pub fn blocks(&self, method: &str) -> Result<Vec<Section<'_>>, RecordError> {
        if !self.methods.iter().any(|own| own == method) {
            return Ok(Vec::new());
        }
        self.own_section()?.map_or(Ok(Vec::new()), |source| source.sections("plan"))
    }

    /// A table or a log that fits are held against, and that none is fitted to.
    #[must_use]
    pub fn of_validation(path: &Path) -> Self {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Self { is_validation: true, ..Self::bare(name, Input::Table(path.to_owned())) }
    }

    /// A source of which nothing but its input is known.
    fn bare(name: String, input: Input) -> Self {
        Self {
            name,
            kind: SourceKind::Towing,
            is_validation: false,
            place: Place::whole(input.path()),
            input,
            sidecar: None,
            models: Vec::new(),
            model_places: Vec::new(),
            methods: Vec::new(),
            method_places: Vec::new(),
            keep: None,
            group: None,
            actuator: Vec::new(),
            uncertainty: Vec::new(),
            tare: None,
            own: None,
            given: Vec::new(),
            plan: Vec::new(),
        }
    }
}

fn must_exist(place: &Place, key: &str, path: &Path) -> Result<(), RecordError> {
    if path.exists() {
        return Ok(());
    }
    Err(RecordError::MissingFile { place: place.clone(), key: key.to_owned(), path: path.to_owned() })
}
