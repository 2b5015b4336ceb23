//! Units of a record: every number is converted to SI when the record is read.
//!
//! This is the only place where a unit of a record is interpreted. Whoever takes a number of an [`EstimateFile`] gets it in SI.
//!
//! | field | a unit other than SI |
//! | --- | --- |
//! | `coefficients` | converted: value, unconstrained, standard uncertainty and its parts, interval, rows and columns of `type_a`, rows of every `sensitivity` |
//! | `refers_to`, `law.constants`, `sigma`, `run_scatter`, `validity`, `derived`, parameters of `data` steps | converted |
//! | `law.inputs`, `law.outputs` | rejected: a formula is evaluated in SI |
//! | `comparison` | rejected: it is a result, not an input |
//! | `errors`, `diagnostics` | no unit in the file: SI of the quantity |
//!
//! A unit that cannot be read, or that measures something else than the field is for, is rejected. The dimension of a coefficient is known for
//! f1 to f6, power laws, `added_mass_6x6`, and C_A beside a drag law; that of a formula follows from the formula, where the law is built.

use froude_hydro::DragModel;
use indexmap::IndexMap;

use super::{Coefficient, Derived, Estimate, EstimateFile, Measured, Range, RunScatter};
use crate::known_columns::known_dimension;
use crate::units::{Dimension, Unit, parse_unit};

/// A unit that is rejected, and where it stands.
pub(crate) struct BadUnit {
    /// Id of the estimate; `None` outside of estimates.
    pub(crate) estimate: Option<String>,
    /// Keys on the way to the unit.
    pub(crate) path: Vec<String>,
    /// The unit as written.
    pub(crate) unit: String,
    /// What is wrong and what was expected.
    pub(crate) problem: String,
}

/// What a unit is checked for.
struct Field<'a> {
    path: &'a [&'a str],
    expected: Option<Dimension>,
}

impl Field<'_> {
    fn bad(&self, unit: &str, problem: String) -> BadUnit {
        let path = self.path.iter().map(|key| (*key).to_owned()).collect();
        BadUnit { estimate: None, path, unit: unit.to_owned(), problem }
    }

    fn read(&self, text: &str) -> Result<Unit, BadUnit> {
        let unit = parse_unit(text).map_err(|e| self.bad(text, e.to_string()))?;
        match self.expected {
            Some(expected) if unit.dimension != expected => {
                let [found, expected] = [unit.dimension, expected].map(Dimension::describe);
                Err(self.bad(text, format!("`{text}` is {found}; expected {expected}")))
            }
            _ => Ok(unit),
        }
    }

    /// The unit of a number that is converted; its text becomes that of the SI unit.
    fn converted(&self, text: &mut String) -> Result<Unit, BadUnit> {
        let unit = self.read(text)?;
        if !is_si(&unit) {
            *text = Unit::si(unit.dimension).text;
        }
        Ok(unit)
    }

    /// A unit of numbers that are not converted.
    fn si(&self, text: &str) -> Result<(), BadUnit> {
        let unit = self.read(text)?;
        if is_si(&unit) {
            return Ok(());
        }
        Err(self.bad(text, format!("`{text}` is not converted here; write the SI unit, {}", Unit::si(unit.dimension))))
    }
}

fn is_si(unit: &Unit) -> bool {
    unit.factor == 1.0 && unit.offset == 0.0
}

/// Converts all numbers of a record to SI.
pub(crate) fn to_si(file: &mut EstimateFile) -> Result<(), BadUnit> {
    for (key, data) in &mut file.data {
        for step in &mut data.steps {
            for (name, m) in &mut step.parameters {
                measured(m, &Field { path: &["data", key, "steps", name], expected: None })?;
            }
        }
    }
    for estimate in &mut file.estimates {
        estimate_to_si(estimate).map_err(|bad| BadUnit { estimate: Some(estimate.id.clone()), ..bad })?;
    }
    let Some(comparison) = &file.comparison else { return Ok(()) };
    let coefficients = comparison.coefficients.iter().map(|c| ("coefficients", &c.unit));
    let loads = comparison.loads.iter().map(|c| ("loads", &c.unit));
    let validation = comparison.validation.iter().map(|c| ("validation", &c.unit));
    for (section, unit) in coefficients.chain(loads).chain(validation).filter(|(_, unit)| !unit.is_empty()) {
        Field { path: &["comparison", section], expected: None }.si(unit)?;
    }
    Ok(())
}

fn estimate_to_si(e: &mut Estimate) -> Result<(), BadUnit> {
    for (name, unit) in &e.law.inputs {
        Field { path: &["law", "inputs", name], expected: known_dimension(name) }.si(unit)?;
    }
    // Records of version 1 state no unit of a load.
    for (name, output) in e.law.outputs.iter().filter(|(_, output)| !output.unit.is_empty()) {
        Field { path: &["law", "outputs", name], expected: known_dimension(name) }.si(&output.unit)?;
    }
    for (name, m) in &mut e.law.constants {
        // A user's own constants have any dimension.
        let expected = matches!(name.as_str(), "v_ref" | "U_ref" | "epsilon").then_some(Dimension::SPEED);
        measured(m, &Field { path: &["law", "constants", name], expected })?;
    }
    for (name, m) in &mut e.refers_to {
        measured(m, &Field { path: &["refers_to", name], expected: of_reference(name) })?;
    }
    // A fit in logarithms has a relative scatter.
    let is_relative = power_law(&e.law.name) == Some(PowerLaw::InLogarithms);
    for (name, m) in &mut e.sigma {
        let expected = if is_relative { Some(Dimension::ONE) } else { known_dimension(name) };
        scatter(m, &Field { path: &["sigma", name], expected })?;
    }
    for (name, RunScatter { constant, part: _, dof: _ }) in &mut e.run_scatter {
        scatter(constant, &Field { path: &["run_scatter", name], expected: known_dimension(name) })?;
    }
    for (name, range) in &mut e.validity {
        let Range { low, high, unit } = range;
        let unit = Field { path: &["validity", name], expected: of_range(name) }.converted(unit)?;
        (*low, *high) = (unit.to_si(*low), unit.to_si(*high));
    }
    for (name, number) in &mut e.derived {
        let Derived { formula: _, value, unit, standard_uncertainty, interval_95 } = number;
        let unit = Field { path: &["derived", name], expected: None }.converted(unit)?;
        values(&unit, [value]);
        differences(&unit, [standard_uncertainty]);
        ends(&unit, interval_95);
    }
    let law = e.law.name.clone();
    let mut factors = IndexMap::new();
    for (name, c) in &mut e.coefficients {
        let field = Field { path: &["coefficients", name], expected: of_coefficient(&law, name) };
        factors.insert(name.clone(), coefficient(c, &field)?);
    }
    let Some(own) = &mut e.type_a else { return Ok(()) };
    let factors: Vec<f64> = own.names.iter().map(|name| factors.get(name).copied().unwrap_or(1.0)).collect();
    if factors.iter().all(|f| *f == 1.0) {
        return Ok(());
    }
    for (row, f) in own.matrix.iter_mut().zip(&factors) {
        row.iter_mut().zip(&factors).for_each(|(entry, g)| *entry *= f * g);
    }
    for error in e.errors.values_mut() {
        for (row, f) in error.sensitivity.iter_mut().zip(&factors) {
            for entry in row.iter_mut() {
                *entry *= f;
            }
        }
    }
    Ok(())
}

fn measured(m: &mut Measured, field: &Field<'_>) -> Result<(), BadUnit> {
    m.value = field.converted(&mut m.unit)?.to_si(m.value);
    Ok(())
}

fn scatter(m: &mut Measured, field: &Field<'_>) -> Result<(), BadUnit> {
    m.value = field.converted(&mut m.unit)?.difference_to_si(m.value);
    Ok(())
}

/// Converts a coefficient; the factor of its differences.
fn coefficient(c: &mut Coefficient, field: &Field<'_>) -> Result<f64, BadUnit> {
    let Coefficient {
        label: _,
        value,
        unconstrained,
        unit,
        status: _,
        nuisance: _,
        standard_uncertainty,
        type_a,
        type_b,
        interval_95,
        range_95,
        effective_dof: _,
    } = c;
    let unit = field.converted(unit)?;
    values(&unit, [value, unconstrained]);
    differences(&unit, [standard_uncertainty, type_a, type_b]);
    ends(&unit, interval_95);
    ends(&unit, range_95);
    Ok(unit.factor)
}

fn values<const N: usize>(unit: &Unit, all: [&mut Option<f64>; N]) {
    all.into_iter().flatten().for_each(|x| *x = unit.to_si(*x));
}

fn differences<const N: usize>(unit: &Unit, all: [&mut Option<f64>; N]) {
    all.into_iter().flatten().for_each(|x| *x = unit.difference_to_si(*x));
}

fn ends(unit: &Unit, interval: &mut Option<[f64; 2]>) {
    interval.iter_mut().flatten().for_each(|x| *x = unit.to_si(*x));
}

/// Dimension of what coefficients refer to.
fn of_reference(name: &str) -> Option<Dimension> {
    Some(match name {
        "density" => Dimension::DENSITY,
        "kinematic_viscosity" => Dimension::KINEMATIC_VISCOSITY,
        "area" | "head_side_area" | "tail_side_area" => Dimension::AREA,
        "volume" | "link_volume" => Dimension::VOLUME,
        "length" | "major_semi_axis" | "minor_semi_axis" | "half_length" => Dimension::LENGTH,
        "v_ref" => Dimension::SPEED,
        _ => return None,
    })
}

/// Dimension of a range of observations.
fn of_range(name: &str) -> Option<Dimension> {
    match name {
        "angle_off_axis" | "Re" | "KC" | "blockage" => Some(Dimension::ONE),
        _ if name.starts_with("Fr_") => Some(Dimension::ONE),
        _ => known_dimension(name),
    }
}

#[derive(PartialEq)]
enum PowerLaw {
    Plain,
    InLogarithms,
}

/// The built-in power law behind a name, which may state its axis: `power_law_log_rx`. A law of a user with a similar name is none.
fn power_law(name: &str) -> Option<PowerLaw> {
    let rest = name.strip_prefix("power_law")?;
    let (rest, kind) = match rest.strip_prefix("_log") {
        Some(rest) => (rest, PowerLaw::InLogarithms),
        None => (rest, PowerLaw::Plain),
    };
    matches!(rest, "" | "_x" | "_y" | "_z" | "_rx" | "_ry" | "_rz").then_some(kind)
}

/// Dimension of a coefficient of a built-in law; `None` for laws whose formula decides it.
fn of_coefficient(law: &str, name: &str) -> Option<Dimension> {
    if power_law(law).is_some() {
        return match name.split_at_checked(2)? {
            ("n_", _) => Some(Dimension::ONE),
            ("k_", axis) if axis.starts_with('r') => Some(Dimension::MOMENT),
            ("k_", _) => Some(Dimension::FORCE),
            _ => None,
        };
    }
    if matches!(law, "added_mass_6x6" | "added_mass_parts") {
        return of_matrix(name);
    }
    // Methods name their laws after the drag law beside the added mass.
    let with_added_mass = law.strip_prefix("added_mass_");
    if with_added_mass.is_some() && matches!(name, "C_A" | "C_Ax" | "C_Ay" | "C_Az") {
        return Some(Dimension::ONE);
    }
    let model = DragModel::from_name(with_added_mass.unwrap_or(law))?;
    let info = model.coefficients().iter().find(|c| c.name == name)?;
    parse_unit(info.unit).ok().map(|unit| unit.dimension)
}

/// Dimension of an entry `A11` to `A66`: a mass, a first moment or an inertia.
fn of_matrix(name: &str) -> Option<Dimension> {
    let [i, j] = <[u8; 2]>::try_from(name.strip_prefix('A')?.as_bytes()).ok()?;
    let is_place = |at: u8| (b'1'..=b'6').contains(&at);
    let turns = [i, j].iter().filter(|at| **at > b'3').count();
    let dimension = [Dimension::MASS, Dimension::new(1, 1, 0), Dimension::new(2, 1, 0)].get(turns).copied();
    dimension.filter(|_| is_place(i) && is_place(j))
}
