//! A force law as the fit and the prediction see it: responses, coefficients and regressors.
//!
//! The built-in drag models come from `froude-hydro`; everything else that is
//! linear in its coefficients is a formula. The power law F = k·(U/U_ref)ⁿ and the
//! thruster with a dead band are not linear: for them the regressors are the
//! derivatives at the current coefficients.

pub(crate) mod terms;
pub(crate) mod thrust;
mod thruster;

use faer::Mat;
use froude_hydro::power_law::PowerLaw;
use froude_hydro::{Axis, Body, CrossTerm, DragModel, Link, Setting};
use froude_records::estimate::{Estimate, Measured};
use froude_records::units::{Dimension, parse_unit};
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::formula::unit::Dim;
use crate::formula::{Constant, Formula, channel_of_alias, load_column};

use terms::{NamedLaw, THRUSTER};

/// Reference speed of the linear coefficients of f1 and of the power law, m/s.
pub const REFERENCE_SPEED_M_S: f64 = 1.0;

/// Relative difference of two reference speeds that the conversion of a unit explains: some units in the last place.
const SAME_SPEED: f64 = 1e-12;

/// A coefficient as the record names it.
#[derive(Debug, Clone, PartialEq)]
pub struct CoefficientSpec {
    /// Name, unique in the law.
    pub name: String,
    /// SI unit text, `1` for a pure number.
    pub unit: String,
}

/// What a law computes.
#[derive(Debug, Clone)]
pub enum Kind {
    /// f1 … f6 of the USR paper.
    Drag {
        /// Which of the six.
        model: DragModel,
        /// The body that the coefficients refer to.
        body: Body,
        /// How the cross terms continue to v_x < 0.
        cross_term: CrossTerm,
    },
    /// Formulas, linear in their coefficients, one per response.
    Formulas(Vec<Formula>),
    /// F = −k·sgn(v)·|v|ⁿ along one axis, v in units of 1 m/s.
    PowerLaw {
        /// The velocity channel, for example `v_x`.
        channel: String,
        /// True: fitted as ln|F| = ln k + n·ln|v| (relative errors); false: in newtons (absolute errors).
        in_logarithms: bool,
    },
    /// Thrust and torque over a command, with a dead band.
    Thruster {
        /// The channel of the command, V or rad/s.
        command: String,
        /// The channel of the inflow, where the water moves.
        inflow: Option<String>,
        /// Response of each coefficient, and its place among the slopes of a thruster.
        parts: Vec<[usize; 2]>,
    },
}

/// A named force law.
#[derive(Debug, Clone)]
pub struct ForceLaw {
    /// `f4`, `linear_quadratic`, a user's name.
    pub name: String,
    /// What it computes.
    pub kind: Kind,
    /// The responses in stacking order: `f_x`, `f_y`, or any channel that a formula gives.
    pub responses: Vec<String>,
    /// The coefficients in order.
    pub coefficients: Vec<CoefficientSpec>,
    /// The formulas' text by response; empty for built-in laws.
    pub texts: IndexMap<String, String>,
    /// The set of terms that it was made of.
    pub(crate) named: Option<&'static NamedLaw>,
}

impl ForceLaw {
    /// One of f1 … f6 for a body.
    ///
    /// # Source
    ///
    /// USR eq. 9 to 14, with the corrections listed in [`froude_hydro::drag`].
    #[must_use]
    pub fn drag(model: DragModel, body: Body, cross_term: CrossTerm) -> Self {
        Self {
            name: model.name().to_owned(),
            kind: Kind::Drag { model, body, cross_term },
            responses: vec!["f_x".to_owned(), "f_y".to_owned()],
            coefficients: model
                .coefficients()
                .iter()
                .map(|c| CoefficientSpec { name: c.name.to_owned(), unit: c.unit.to_owned() })
                .collect(),
            texts: IndexMap::new(),
            named: None,
        }
    }

    /// A law made of formulas, one per response, over the channels of `data`.
    ///
    /// # Errors
    ///
    /// What is wrong with a formula, with the model's name and the load.
    pub fn formulas(name: &str, texts: &IndexMap<String, String>, data: &Dataset) -> Result<Self, IdentifyError> {
        Self::with_constants(name, texts, data, &[])
    }

    /// The same with known numbers by name, in SI.
    ///
    /// # Errors
    ///
    /// As [`Self::formulas`].
    pub fn with_constants(
        name: &str,
        texts: &IndexMap<String, String>,
        data: &Dataset,
        constants: &[Constant],
    ) -> Result<Self, IdentifyError> {
        Self::reading(name, texts, data, &|name| data.dimension(name), constants, &|_| false)
    }

    /// Other formulas under the constants of this law.
    ///
    /// # Errors
    ///
    /// As [`Self::formulas`].
    pub fn rewritten(
        &self,
        name: &str,
        texts: &IndexMap<String, String>,
        data: &Dataset,
    ) -> Result<Self, IdentifyError> {
        Self::with_constants(name, texts, data, &self.constants())
    }

    /// The known numbers that its formulas read, in SI.
    #[must_use]
    pub fn constants(&self) -> Vec<Constant> {
        let Kind::Formulas(formulas) = &self.kind else { return Vec::new() };
        let mut out: Vec<Constant> = Vec::new();
        for constant in formulas.iter().flat_map(|formula| &formula.constants) {
            if !out.contains(constant) {
                out.push(constant.clone());
            }
        }
        out
    }

    /// The same over the channels that `channel` knows.
    fn reading(
        name: &str,
        texts: &IndexMap<String, String>,
        data: &Dataset,
        channel: &dyn Fn(&str) -> Option<Dimension>,
        constants: &[Constant],
        is_coefficient: &dyn Fn(&str) -> bool,
    ) -> Result<Self, IdentifyError> {
        let mut formulas = Vec::new();
        let mut coefficients: IndexMap<String, Dimension> = IndexMap::new();
        for (response, text) in texts {
            let target = response_of(data, response);
            let wanted = data.dimension(target).ok_or_else(|| IdentifyError::no_such_channel(name, target, data))?;
            let channel = |n: &str| channel(n).map(exponents);
            let formula =
                Formula::with_coefficients(target, text, &channel, exponents(wanted), constants, is_coefficient)
                    .map_err(|source| IdentifyError::Refused(format!("model {name:?}, {response}: {source}")))?;
            for (coefficient, dimension) in &formula.coefficients {
                let dimension = dimension_of(*dimension);
                if let Some(before) = coefficients.insert(coefficient.clone(), dimension)
                    && before != dimension
                {
                    return Err(IdentifyError::Refused(format!(
                        "model {name:?}: coefficient {coefficient} would be {before} in one formula and {dimension} in another; give the two \
                         terms different names"
                    )));
                }
            }
            formulas.push(formula);
        }
        let read = formulas.iter().flat_map(|formula| &formula.channels).filter_map(|name| channel(name));
        let beside: Vec<Dimension> = read.collect();
        Ok(Self {
            name: name.to_owned(),
            kind: Kind::Formulas(formulas),
            responses: texts.keys().map(|r| response_of(data, r).to_owned()).collect(),
            coefficients: coefficients
                .iter()
                .map(|(name, d)| CoefficientSpec { name: name.clone(), unit: d.written_beside(&beside) })
                .collect(),
            texts: texts.clone(),
            named: None,
        })
    }

    /// The power law along the axis of a load (`f_x` goes with `v_x`).
    ///
    /// F = −k·sgn(v)·(|v|/v_ref)ⁿ with v_ref = 1 m/s (1 rad/s for a moment); k in N (N m), n dimensionless.
    #[must_use]
    pub fn power_law(response: &str, channel: &str, in_logarithms: bool) -> Self {
        let axis = response.replace("f_", "").replace("m_", "r");
        let unit = if response.starts_with("m_") { "N m" } else { "N" };
        Self {
            name: if in_logarithms { "power_law_log" } else { "power_law" }.to_owned(),
            kind: Kind::PowerLaw { channel: channel.to_owned(), in_logarithms },
            responses: vec![response.to_owned()],
            coefficients: vec![
                CoefficientSpec { name: format!("k_{axis}"), unit: unit.to_owned() },
                CoefficientSpec { name: format!("n_{axis}"), unit: "1".to_owned() },
            ],
            texts: IndexMap::new(),
            named: None,
        }
    }

    /// The law that a record belongs to, over the channels of `data`.
    ///
    /// # Errors
    ///
    /// A built-in drag model without its geometry, an unknown model, a coefficient in a unit that does not fit the law, or a reference speed other
    /// than 1 m/s.
    pub fn of_estimate(estimate: &Estimate, data: &Dataset) -> Result<Self, IdentifyError> {
        let law = Self::named_by(estimate, data)?;
        let wrong = |what: String| IdentifyError::Campaign { place: format!("estimate {}", estimate.id), what };
        for spec in &law.coefficients {
            let Some(c) = estimate.coefficients.get(&spec.name) else { continue };
            let [own, stated] = [&spec.unit, &c.unit].map(|unit| parse_unit(unit).ok().map(|unit| unit.dimension));
            if own.is_some() && own != stated {
                return Err(wrong(format!(
                    "coefficient {} is in {}, and its law needs it in {}: correct the unit in the record",
                    spec.name, c.unit, spec.unit
                )));
            }
        }
        for key in ["v_ref", "U_ref"] {
            if let Some(m) = estimate.law.constants.get(key)
                && (m.value / REFERENCE_SPEED_M_S - 1.0).abs() > SAME_SPEED
            {
                return Err(wrong(format!(
                    "its {key} is {} m/s; laws are evaluated with {REFERENCE_SPEED_M_S} m/s: state the coefficients for this speed",
                    m.value
                )));
            }
        }
        Ok(law)
    }

    /// The law by its name or its formulas.
    fn named_by(estimate: &Estimate, data: &Dataset) -> Result<Self, IdentifyError> {
        if let Some(model) = DragModel::from_name(&estimate.law.name) {
            let body = body_of(estimate)?;
            let cross_term = match estimate.law.constants.get("epsilon") {
                Some(Measured { value, .. }) => CrossTerm::Smooth { epsilon_m_s: *value },
                None => CrossTerm::AsPrinted,
            };
            return Ok(Self::drag(model, body, cross_term));
        }
        let formulas = estimate.law.formulas();
        if !formulas.is_empty() {
            return Self::as_recorded(estimate, &formulas, data);
        }
        if estimate.law.name.starts_with("power_law")
            && let Some(axis) = estimate.coefficients.keys().find_map(|n| n.strip_prefix("n_"))
        {
            let in_logarithms = estimate.law.name.contains("_log");
            let (response, channel) = match axis.strip_prefix('r') {
                Some(axis) => (format!("m_{axis}"), format!("w_{axis}")),
                None => (format!("f_{axis}"), format!("v_{axis}")),
            };
            return Ok(Self { name: estimate.law.name.clone(), ..Self::power_law(&response, &channel, in_logarithms) });
        }
        if estimate.law.name == THRUSTER
            && let Some(command) = estimate.law.inputs.keys().next()
        {
            let loads: Vec<&str> = estimate.law.outputs.keys().map(String::as_str).collect();
            let inflow = estimate.law.inputs.keys().nth(1).map(String::as_str);
            let has = |end: &str| estimate.coefficients.keys().any(|name| name.ends_with(end));
            return Ok(Self::thruster(data, &loads, (command, inflow), [has("_ahead"), has("_astern")]));
        }
        let (id, model) = (&estimate.id, &estimate.law.name);
        let problem = format!("estimate {id}: model {model} is not a force law that can be evaluated here");
        Err(IdentifyError::Refused(problem))
    }

    /// A record's formulas over the channels that it names as its inputs; a letter that it does not name is read as in a campaign.
    fn as_recorded(
        estimate: &Estimate,
        texts: &IndexMap<String, String>,
        data: &Dataset,
    ) -> Result<Self, IdentifyError> {
        let inputs = &estimate.law.inputs;
        let stated = |name: &str| inputs.get(name).and_then(|unit| parse_unit(unit).ok()).map(|unit| unit.dimension);
        for name in inputs.keys() {
            if let (Some(recorded), Some(found)) = (stated(name), data.dimension(name))
                && recorded != found
            {
                return Err(IdentifyError::Refused(format!(
                    "estimate {}: its law reads {name} in {recorded}, and the data have {name} in {found}: another quantity under the same \
                     name; rename it in the data, or map it with a sidecar",
                    estimate.id
                )));
            }
        }
        // The letter of an input that the record names by its column is that column, whatever else the table holds.
        let is_other = |name: &str| {
            !inputs.contains_key(name) && channel_of_alias(name).is_some_and(|column| inputs.contains_key(column))
        };
        let channel = |name: &str| stated(name).or_else(|| data.dimension(name).filter(|_| !is_other(name)));
        let is_other = |name: &String| inputs.contains_key(name) || estimate.coefficients.contains_key(name);
        let stated = estimate.law.constants.iter().filter(|(name, _)| !is_other(name));
        let constants = stated.filter_map(|(name, m)| {
            let unit = parse_unit(&m.unit).ok()?;
            Some((name.clone(), unit.to_si(m.value), exponents(unit.dimension)))
        });
        let is_coefficient = |name: &str| estimate.coefficients.contains_key(name);
        Self::reading(&estimate.law.name, texts, data, &channel, &constants.collect::<Vec<_>>(), &is_coefficient)
    }

    /// Derivatives of every response by every coefficient: rows stacked response by response,
    /// `responses·rows × coefficients`. For linear laws this is the design matrix and `at` is not read.
    ///
    /// Entries are in SI units of the response (N, N m) over those of the coefficient; `at` holds the coefficients in SI, in the order of the law.
    ///
    /// # Errors
    ///
    /// A channel that the law needs and the data lack.
    pub fn regressors(&self, data: &Dataset, at: &[f64]) -> Result<Mat<f64>, IdentifyError> {
        let (n, p) = (data.rows, self.coefficients.len());
        let mut out = Mat::zeros(n * self.responses.len(), p);
        match &self.kind {
            Kind::Drag { model, body, cross_term } => {
                let links = self.channel(data, "n_links")?;
                let density = self.channel(data, "density")?;
                let velocity = data.velocities_m_s();
                let mut row = vec![0.0; p];
                for i in 0..n {
                    let setting = Setting {
                        body: *body,
                        n_links: links[i],
                        density_kg_m3: density[i],
                        v_ref_m_s: REFERENCE_SPEED_M_S,
                        cross_term: *cross_term,
                    };
                    model.regressor(&setting, velocity(i), &mut row);
                    for (j, info) in model.coefficients().iter().enumerate() {
                        let r = match info.axis {
                            Axis::X => 0,
                            Axis::Y => 1,
                        };
                        out[(r * n + i, j)] = row[j];
                    }
                }
            }
            Kind::Formulas(formulas) => {
                for (r, formula) in formulas.iter().enumerate() {
                    let columns =
                        formula.channels.iter().map(|c| self.channel(data, c)).collect::<Result<Vec<_>, _>>()?;
                    let place: Vec<usize> =
                        formula.coefficients.iter().filter_map(|(name, _)| self.position(name)).collect();
                    let mut values = vec![0.0; columns.len()];
                    let mut row = vec![0.0; place.len()];
                    for i in 0..n {
                        for (value, column) in values.iter_mut().zip(&columns) {
                            *value = column[i];
                        }
                        formula.regressor(&values, &mut row);
                        for (&j, &x) in place.iter().zip(&row) {
                            out[(r * n + i, j)] = x;
                        }
                    }
                }
            }
            Kind::PowerLaw { channel, .. } => {
                let v = self.channel(data, channel)?;
                for i in 0..n {
                    // What the fluid does to the body opposes the motion.
                    let [by_k, by_n] = PowerLaw { k_n: at[0], exponent: at[1] }.sensitivity(v[i] / REFERENCE_SPEED_M_S);
                    out[(i, 0)] = -by_k;
                    out[(i, 1)] = -by_n;
                }
            }
            Kind::Thruster { command, inflow, .. } => {
                let x = self.channel(data, command)?;
                let u = inflow.as_ref().map(|inflow| self.channel(data, inflow)).transpose()?;
                self.of_thruster(x, u, at, |row, j, slope| out[(row, j)] = slope);
            }
        }
        Ok(out)
    }

    /// The responses for given coefficients, stacked response by response.
    ///
    /// In SI units of the responses (N, N m); `at` holds the coefficients in SI, in the order of the law.
    ///
    /// # Errors
    ///
    /// A channel that the law needs and the data lack.
    pub fn predict(&self, data: &Dataset, at: &[f64]) -> Result<Vec<f64>, IdentifyError> {
        let x = self.regressors(data, at)?;
        // An exponent and a dead band have a slope, and no part of their own.
        let terms: Vec<usize> = (0..at.len()).filter(|j| self.is_factor(*j)).collect();
        Ok((0..x.nrows()).map(|i| terms.iter().map(|&j| x[(i, j)] * at[j]).sum()).collect())
    }

    /// The channels that it reads, each once.
    #[must_use]
    pub fn channels(&self) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        let all: Vec<&str> = match &self.kind {
            Kind::Drag { .. } => vec!["v_x", "v_y", "n_links", "density"],
            Kind::PowerLaw { channel, .. } => vec![channel],
            Kind::Thruster { command, inflow, .. } => {
                std::iter::once(command).chain(inflow).map(String::as_str).collect()
            }
            Kind::Formulas(formulas) => formulas.iter().flat_map(|f| &f.channels).map(String::as_str).collect(),
        };
        for channel in all {
            if !out.contains(&channel) {
                out.push(channel);
            }
        }
        out
    }

    /// Whether a response depends on the speed or the angle of the motion through the water.
    #[must_use]
    pub fn moves(&self, response: usize) -> bool {
        self.reads(response, |c| matches!(c, "v_x" | "v_y" | "v_z" | "speed" | "angle"))
    }

    /// Whether a response depends on the density already.
    #[must_use]
    pub fn has_density(&self, response: usize) -> bool {
        matches!(self.kind, Kind::Drag { .. }) || self.reads(response, |c| c == "density")
    }

    fn reads(&self, response: usize, is_meant: impl Fn(&str) -> bool) -> bool {
        match &self.kind {
            Kind::Drag { .. } => is_meant("v_x"),
            Kind::PowerLaw { channel, .. } => is_meant(channel),
            Kind::Thruster { .. } => self.channels().into_iter().any(is_meant),
            Kind::Formulas(formulas) => formulas[response].channels.iter().any(|c| is_meant(c)),
        }
    }

    /// The measured responses, stacked like those of [`Self::predict`].
    ///
    /// # Errors
    ///
    /// A response that the table does not have.
    pub fn measured(&self, data: &Dataset) -> Result<Vec<f64>, IdentifyError> {
        let mut out = Vec::with_capacity(self.responses.len() * data.rows);
        for response in &self.responses {
            out.extend_from_slice(self.channel(data, response)?);
        }
        Ok(out)
    }

    /// What an estimate gives its coefficients, in their order; the name of the first that has no value.
    pub(crate) fn values_of<'a>(&'a self, estimate: &Estimate) -> Result<Vec<f64>, &'a str> {
        let value = |name: &'a str| estimate.coefficients.get(name).and_then(|c| c.value).ok_or(name);
        self.coefficients.iter().map(|c| value(&c.name)).collect()
    }

    /// Place of a coefficient by name.
    #[must_use]
    pub fn position(&self, name: &str) -> Option<usize> {
        self.coefficients.iter().position(|c| c.name == name)
    }

    /// True where the fit compares logarithms of the responses.
    #[must_use]
    pub fn in_logarithms(&self) -> bool {
        matches!(self.kind, Kind::PowerLaw { in_logarithms: true, .. })
    }

    /// True where the fit has to iterate.
    #[must_use]
    pub fn is_nonlinear(&self) -> bool {
        matches!(self.kind, Kind::PowerLaw { .. } | Kind::Thruster { .. })
    }

    /// Symbol of the physical factor of each coefficient (`k*G_T`) for built-in laws.
    #[must_use]
    pub fn factor_symbols(&self) -> Option<Vec<&'static str>> {
        match &self.kind {
            Kind::Drag { model, .. } => Some(model.coefficients().iter().map(|c| c.factor.symbol()).collect()),
            _ => None,
        }
    }

    fn channel<'a>(&self, data: &'a Dataset, name: &str) -> Result<&'a [f64], IdentifyError> {
        data.values(name).ok_or_else(|| IdentifyError::no_such_channel(&self.name, name, data))
    }
}

/// Whether a load is a moment.
pub(crate) fn is_torque(load: &str) -> bool {
    load.starts_with("m_") || load == "torque"
}

/// A dimension as the formula room writes it: exponents of m, kg, s, K and A.
pub(crate) fn exponents(d: Dimension) -> Dim {
    [d.m, d.kg, d.s, d.k, d.a]
}

pub(crate) fn dimension_of([m, kg, s, k, a]: Dim) -> Dimension {
    Dimension { m, kg, s, k, a }
}

/// The body in a record's geometry.
fn body_of(estimate: &Estimate) -> Result<Body, IdentifyError> {
    let get = |key: &str| {
        let lacks =
            || format!("estimate {}: its law needs geometry.{key}, which the record does not carry", estimate.id);
        estimate.refers_to.get(key).map(|m| m.value).ok_or_else(|| IdentifyError::Refused(lacks()))
    };
    Ok(Body {
        link: Link {
            major_semi_axis_m: get("major_semi_axis")?,
            minor_semi_axis_m: get("minor_semi_axis")?,
            half_length_m: get("half_length")?,
        },
        head_side_area_m2: get("head_side_area")?,
        tail_side_area_m2: get("tail_side_area")?,
    })
}

/// Geometry of a body as a record carries it.
#[must_use]
pub fn geometry_of(body: &Body) -> IndexMap<String, Measured> {
    let all = [
        ("major_semi_axis", body.link.major_semi_axis_m, "m"),
        ("minor_semi_axis", body.link.minor_semi_axis_m, "m"),
        ("half_length", body.link.half_length_m, "m"),
        ("head_side_area", body.head_side_area_m2, "m^2"),
        ("tail_side_area", body.tail_side_area_m2, "m^2"),
    ];
    all.map(|(name, value, unit)| (name.to_owned(), Measured::of(value, unit))).into()
}

/// The channel that a law gives: on the left of a formula `X Y Z K M N` are loads, also beside a column of the table with that name.
fn response_of<'a>(data: &Dataset, name: &'a str) -> &'a str {
    load_column(name).unwrap_or_else(|| data.meant(name))
}
