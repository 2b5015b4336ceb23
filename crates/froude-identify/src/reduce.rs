//! From a source's table to observations: motion, water, zeros, tare, what is kept.
//!
//! Every step that changes a number or drops a row is reported as a finding.

use std::path::Path;

use froude_hydro::fluid::Water;
use froude_records::campaign::{Campaign, Comparison, Input, Keep, KeepValue, Source, SourceKind};
use froude_records::finding::{Finding, Severity};
use froude_records::nearest::meant;
use froude_records::plausible;
use froude_records::run::step::Step;
use froude_records::sidecar::read_sidecar;
use froude_records::table::{Column, ColumnData, Table, links_of_configuration};
use froude_records::table_file::{read_table, read_table_with_blanks};
use froude_records::text::counted;
use froude_records::texts::Texts;
use froude_records::units::Dimension;

use crate::data_files::PART;
use crate::dataset::{Channel, Dataset, GroupedBy, LOADS};
use crate::error::IdentifyError;
use crate::lint::motion::motion_contradictions;
use crate::result::ReadFile;
use crate::source::models;
use crate::uncertainty::SharedError;
use crate::{columns, idle, tare, two_units};

/// The observations of a table.
#[derive(Debug, Clone)]
pub struct Observations {
    /// The observations that are kept.
    pub data: Dataset,
    /// Rows in the file.
    pub n_read: usize,
    /// What was found on the way.
    pub findings: Vec<Finding>,
    /// Errors shared by observations, from subtracted tares.
    pub shared_errors: Vec<SharedError>,
    /// Files that were read.
    pub files: Vec<ReadFile>,
}

/// Reads and reduces the table of a source.
///
/// # Errors
///
/// Whatever the table reader finds; a source without table; nothing kept; impossible water.
pub fn reduce(campaign: &Campaign, source: &Source) -> Result<Observations, IdentifyError> {
    let path = match &source.input {
        Input::Table(path) => path.clone(),
        other => return Err(not_a_table(source, other)),
    };
    let table = read_table_with_blanks(&path, source.sidecar.as_deref())?;
    reduce_table(campaign, source, &table, files_of(&table))
}

/// The files of a table.
pub(crate) fn files_of(table: &Table) -> Vec<ReadFile> {
    let sidecar = table.sidecar.clone().map(|path| ReadFile::new(path, "sidecar"));
    let joined = table.joined.iter().flat_map(|joined| {
        let sidecar = joined.sidecar.clone().map(|path| ReadFile::new(path, "joined"));
        std::iter::once(ReadFile::new(joined.path.clone(), "joined")).chain(sidecar)
    });
    // Two sheets of a workbook are different data.
    let words = table.sidecar.as_deref().and_then(|path| read_sidecar(path).ok()).and_then(|own| own.file.part_words());
    let part = words.map(|words| Step::new(PART, "", words));
    let own = ReadFile { steps: part.into_iter().collect(), ..ReadFile::new(table.path.clone(), "table") };
    std::iter::once(own).chain(sidecar).chain(joined).collect()
}

/// Reduces a table in memory, made of `files`: of a file, or of the windows of raw runs.
///
/// # Errors
///
/// As [`reduce`].
pub fn reduce_table(
    campaign: &Campaign,
    source: &Source,
    table: &Table,
    mut files: Vec<ReadFile>,
) -> Result<Observations, IdentifyError> {
    let mut findings = table.findings();
    let data = observed(table, campaign, source, &mut findings)?;
    let n_read = data.rows;
    let mut keep = kept_rows(&data, source)?;
    findings.extend(left_out(keep.len(), n_read));
    if keep.is_empty() {
        return Err(IdentifyError::NothingKept { source_name: source.name.clone(), n_read });
    }
    let mut data = data.keeping(&keep);
    let (unique, dropped) = crate::lint::repeats::identical_copies(&data);
    if let Some(finding) = dropped {
        findings.push(finding);
        data = data.keeping(&unique);
        keep = unique.iter().map(|&i| keep[i]).collect();
    }
    // Computed loads are zero by symmetry.
    if source.kind != SourceKind::Cfd {
        findings.extend(idle::mark(&mut data));
    }
    // The findings about the observations concern those that are fitted.
    findings.extend(motion_and_zeros(table, &keep, &data));
    one_unit(table, &data, campaign, source)?;
    let mut shared_errors = Vec::new();
    if let Some(tare) = &source.tare {
        let (errors, found) = tare::subtract(&mut data, tare)?;
        files.push(ReadFile::new(tare.record.clone(), "record"));
        findings.extend(found);
        shared_errors.extend(errors);
    }
    let findings = findings.into_iter().map(|f| f.of_source(&source.name)).collect();
    Ok(Observations { data, n_read, findings, shared_errors, files })
}

/// All rows of a table that no campaign names, as observations, with what was found on the way.
///
/// # Errors
///
/// Whatever the table reader finds; impossible water.
pub fn rows_of(path: &Path, sidecar: Option<&Path>) -> Result<(Dataset, Vec<Finding>), IdentifyError> {
    let table = read_table(path, sidecar)?;
    let campaign = Campaign::of_table(path, sidecar.map(Path::to_owned));
    let mut findings = Vec::new();
    let data = observed(&table, &campaign, &campaign.sources[0], &mut findings)?;
    Ok((data, findings))
}

/// All rows of a table as observations: motion, water, zeros subtracted.
pub(crate) fn observed(
    table: &Table,
    campaign: &Campaign,
    source: &Source,
    findings: &mut Vec<Finding>,
) -> Result<Dataset, IdentifyError> {
    conditioned(table, campaign, source, findings, true)
}

/// As [`observed`]; without speed and angle of velocities where nothing reads them, which are a seventh of the time of a long table.
pub(crate) fn conditioned(
    table: &Table,
    campaign: &Campaign,
    source: &Source,
    findings: &mut Vec<Finding>,
    has_speed: bool,
) -> Result<Dataset, IdentifyError> {
    let mut data = dataset(table, source, has_speed)?;
    idle::of_blanks(table, &mut data)?;
    water_or_air(table, campaign)?;
    water(&mut data, campaign, findings)?;
    subtract_zeros(&mut data);
    Ok(data)
}

/// Rows that `keep` leaves.
pub(crate) fn kept_rows(data: &Dataset, source: &Source) -> Result<Vec<usize>, IdentifyError> {
    source.keep.as_ref().map_or_else(|| Ok((0..data.rows).collect()), |clauses| kept(clauses, data, source))
}

/// What `keep` left out.
pub(crate) fn left_out(kept: usize, n_read: usize) -> Option<Finding> {
    (kept < n_read).then(|| {
        let satisfy = counted(n_read, "observation satisfies", "observations satisfy");
        Finding::new(Severity::Note, "kept", format!("{kept} of {satisfy} `keep`; the others are left out"))
    })
}

/// The loads that a law of the source gives or has; all of them where its laws cannot be made.
fn fitted_loads(campaign: &Campaign, source: &Source, data: &Dataset) -> Vec<&'static str> {
    let mut loads = data.loads();
    if let Ok(laws) = models::laws(campaign, source, data) {
        loads.retain(|load| columns::is_in(load, &laws));
    }
    loads
}

/// Refuses a load whose rows stand in two units: their mean is the load of nothing. A load that nothing fits does no harm.
pub(crate) fn one_unit(
    table: &Table,
    data: &Dataset,
    campaign: &Campaign,
    source: &Source,
) -> Result<(), IdentifyError> {
    let loads = fitted_loads(campaign, source, data);
    let found = two_units::found(data, &loads).filter(|found| !two_units::is_predicted(found, data, campaign, source));
    let Some(found) = found else { return Ok(()) };
    let [large, small] = found.rows;
    let place = |row: usize| {
        let line = data.line.get(row);
        table.place_of_row(table.line_of_row.iter().position(|l| Some(l) == line).unwrap_or(row))
    };
    let header = data.header(found.load).to_owned();
    let unit = table.columns.iter().find(|c| c.name == found.load).and_then(|c| match &c.data {
        ColumnData::Number { unit, .. } => Some(unit),
        ColumnData::Text(_) => None,
    });
    let written = |row: usize| {
        let si = data.values(found.load).map_or(f64::NAN, |f| f[row]);
        let number = unit.map_or(si, |unit| unit.from_si(si));
        let speed = data.values("speed").map_or_else(String::new, |u| format!(" at {:.4} m/s", u[row]));
        format!("{number:.4}{speed}")
    };
    let problem = format!(
        "is {} here and {} in {}, at one setting; there are two groups of rows a factor of {} apart, as loads of one body are not: {}, \
         probably. Convert them; if they are correct, give the two groups different names in a column `configuration`: rows of different configurations are not compared",
        written(large),
        written(small),
        place(small),
        digits(found.factor),
        found.cause()
    );
    Err(IdentifyError::Record(froude_records::RecordError::Value { place: place(large), key: header, problem }))
}

/// Three digits.
fn digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

fn not_a_table(source: &Source, input: &Input) -> IdentifyError {
    let what = match input {
        Input::Runs { .. } => "`runs` are reduced by the methods of their rig",
        Input::Cases(_) => "`cases` are computed by CFD; collect them into a table first",
        Input::Mesh(_) => "`mesh` gives added mass; give its result as `record`",
        Input::Record { .. } | Input::Table(_) => "a published record is compared, not fitted",
    };
    IdentifyError::Refused(format!("source {:?}: {what}", source.name))
}

/// The table's columns as channels, with velocity from speed and angle or the other way round.
fn dataset(table: &Table, source: &Source, has_speed: bool) -> Result<Dataset, IdentifyError> {
    let mut data = Dataset { rows: table.n_rows, ..Dataset::default() };
    let text = |name: &str| -> Texts {
        table.columns.iter().find(|c| c.name == name).map_or_else(
            || Texts::repeated("", table.n_rows),
            |c| match &c.data {
                ColumnData::Text(t) => t.clone(),
                ColumnData::Number { si, .. } => si.iter().map(f64::to_string).collect(),
            },
        )
    };
    data.configuration = text("configuration");
    data.setup = text("setup");
    data.run = text("run");
    data.line.clone_from(&table.line_of_row);
    data.left_out.clone_from(&table.left_out);
    data.headers = table.columns.iter().map(Column::header).collect();
    for column in &table.columns {
        if let ColumnData::Number { si, dimension, .. } = &column.data {
            let channel = Channel { values: si.clone(), dimension: *dimension };
            data.channels.insert(column.name.clone(), channel);
        }
    }
    if let Some(group) = &source.group {
        if !table.columns.iter().any(|c| &c.name == group) {
            return Err(IdentifyError::Campaign {
                place: source.place.to_string(),
                what: format!("group = {group:?}: the table has no such column{}", {
                    let names = table.columns.iter().map(|c| c.name.as_str());
                    meant(group, names).map_or_else(String::new, |advice| format!("; {advice}"))
                }),
            });
        }
        let group = text(group);
        data.grouped_by = if group == data.run { GroupedBy::Run } else { GroupedBy::Column };
        data.group = Some(group);
    }
    for load in &source.actuator {
        let load = data.meant(load);
        if !data.channels.contains_key(load) {
            let loads = data.loads().join(", ");
            let what = format!("actuator = [{load:?}]: the table has no such column; its loads are {loads}");
            return Err(IdentifyError::Campaign { place: source.place.to_string(), what });
        }
        data.actuators.push(load.to_owned());
    }
    if !data.channels.contains_key("n_links") {
        links_from_configuration(&mut data);
    }
    if data.channels.contains_key("v_x") || data.channels.contains_key("v_y") {
        for axis in ["v_x", "v_y"] {
            if !data.channels.contains_key(axis) {
                data.put(axis, vec![0.0; data.rows], Dimension::SPEED);
            }
        }
        if has_speed {
            data.speed_and_angle_from_velocity();
        }
    } else {
        data.velocity_from_speed_and_angle();
    }
    Ok(data)
}

/// `n_links` from names like H3LT, where every configuration is of that form.
fn links_from_configuration(data: &mut Dataset) {
    let links: Option<Vec<f64>> =
        data.configuration.iter().map(|c| links_of_configuration(c)).map(|k| k.map(f64::from)).collect();
    if let Some(links) = links {
        data.put("n_links", links, Dimension::ONE);
    }
}

/// Refuses a density of the table that is neither that of water nor, by the viscosity beside it, that of air.
fn water_or_air(table: &Table, campaign: &Campaign) -> Result<(), IdentifyError> {
    let Some(Column { data: ColumnData::Number { unit, si, .. }, .. }) =
        table.columns.iter().find(|c| c.name == "density")
    else {
        return Ok(());
    };
    let measured = table.number("kinematic_viscosity", Dimension::KINEMATIC_VISCOSITY).ok();
    let viscosity = |row: usize| campaign.fluid.kinematic_viscosity_m2_s.or_else(|| Some(measured?[row]));
    let doubtful = |(row, rho): (usize, &f64)| Some((row, *rho, plausible::density(*rho, viscosity(row))?));
    match si.iter().enumerate().find_map(doubtful) {
        Some((row, rho, problem)) => Err(IdentifyError::Record(froude_records::RecordError::Value {
            place: table.place_of_row(row),
            key: format!("density [{}]", unit.text),
            problem: format!("is {}, which {problem}", unit.from_si(rho)),
        })),
        None => Ok(()),
    }
}

/// Density and kinematic viscosity per row, from the campaign or the temperature of the run.
fn water(data: &mut Dataset, campaign: &Campaign, findings: &mut Vec<Finding>) -> Result<(), IdentifyError> {
    let stated = &campaign.fluid;
    let salinity = stated.salinity_g_kg.unwrap_or(0.0);
    let temperature: Option<Vec<f64>> = data
        .values("temperature")
        .map(|t| t.iter().map(|k| k - 273.15).collect())
        .or_else(|| stated.temperature_degc.map(|t| vec![t; data.rows]));
    // Nothing of air follows from a temperature here: its viscosity is stated, or it would be no air.
    let is_air = match stated.density_kg_m3 {
        Some(rho) => plausible::AIR_KG_M3.contains(&rho),
        None => data.values("density").is_some_and(|d| d.iter().all(|rho| plausible::AIR_KG_M3.contains(rho))),
    };
    let water: Option<Vec<Water>> = temperature
        .filter(|_| !is_air)
        .map(|t| t.iter().map(|&t| Water::at(t, salinity)).collect::<Result<_, _>>())
        .transpose()
        .map_err(|e| IdentifyError::Campaign { place: "[fluid]".to_owned(), what: e.to_string() })?;
    if let (Some(stated), Some(measured)) = (stated.temperature_degc, data.values("temperature"))
        && measured.iter().any(|t| (t - 273.15 - stated).abs() > 1e-9)
    {
        findings.push(Finding::new(
            Severity::Note,
            "measured-over-stated",
            format!(
                "density and viscosity, where they follow from a temperature, use the table's temperatures; \
                 temperature = {stated:.2} degC of [fluid] is not used"
            ),
        ));
    }
    // What is stated goes before what was measured, and that before what follows from a temperature.
    findings.extend(measured_water(data, "density", stated.density_kg_m3));
    findings.extend(measured_water(data, "kinematic_viscosity", stated.kinematic_viscosity_m2_s));
    if let Some(density) = stated.density_kg_m3 {
        data.put("density", vec![density; data.rows], Dimension::DENSITY);
        if data.channels.contains_key("temperature") {
            findings.push(Finding::new(
                Severity::Note,
                "stated-density",
                format!("density {density} kg/m^3 is stated in [fluid] and used for every run, although the table has temperatures"),
            ));
        }
    } else if let Some(water) = &water
        && !data.channels.contains_key("density")
    {
        data.put("density", water.iter().map(|w| w.density_kg_m3).collect(), Dimension::DENSITY);
    }
    if let Some(nu) = stated.kinematic_viscosity_m2_s {
        data.put("kinematic_viscosity", vec![nu; data.rows], Dimension::KINEMATIC_VISCOSITY);
    } else if let Some(water) = &water
        && !data.channels.contains_key("kinematic_viscosity")
    {
        let nu = water.iter().map(Water::kinematic_viscosity_m2_s).collect();
        data.put("kinematic_viscosity", nu, Dimension::KINEMATIC_VISCOSITY);
    }
    Ok(())
}

/// A column of the table that a value in `[fluid]` replaces.
fn measured_water(data: &Dataset, name: &str, stated: Option<f64>) -> Option<Finding> {
    let (stated, measured, dimension) = (stated?, data.values(name)?, data.dimension(name)?);
    let low = measured.iter().copied().fold(f64::INFINITY, f64::min);
    let high = measured.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low == stated && high == stated {
        return None;
    }
    Some(Finding::new(
        Severity::Warning,
        "stated-over-measured",
        format!(
            "{name} = {stated} {dimension} of [fluid] is used for every run, and the table's column {name} ({low} to {high} {dimension}) \
             is not; take {name} out of [fluid] to use what was measured"
        ),
    ))
}

/// Zeros before and after each run.
pub(crate) fn zeros_of<'a>(data: &'a Dataset, load: &str) -> [Option<&'a [f64]>; 2] {
    ["before", "after"].map(|when| data.values(&format!("zero_{when}_{load}")))
}

/// Their mean, or the only one; `None` where there is none.
fn mean_zero(data: &Dataset, load: &str) -> Option<Vec<f64>> {
    match zeros_of(data, load) {
        [Some(b), Some(a)] => Some(b.iter().zip(a).map(|(b, a)| 0.5 * (b + a)).collect()),
        [Some(only), None] | [None, Some(only)] => Some(only.to_vec()),
        [None, None] => None,
    }
}

/// Subtracts the mean of the zeros before and after each run.
fn subtract_zeros(data: &mut Dataset) {
    for load in LOADS {
        let Some(zero) = mean_zero(data, load) else { continue };
        let Some(channel) = data.channels.get_mut(load) else { continue };
        for (value, zero) in channel.values.iter_mut().zip(&zero) {
            *value -= zero;
        }
    }
}

/// What is doubtful about the zeros and the motion of some rows of a table.
pub(crate) fn motion_and_zeros(table: &Table, rows: &[usize], data: &Dataset) -> Vec<Finding> {
    [zero_drift(data), motion_contradictions(table, rows, data)].concat()
}

/// How far the zeros moved that were subtracted.
fn zero_drift(data: &Dataset) -> Vec<Finding> {
    let mut findings = Vec::new();
    for load in LOADS {
        let (Some(zero), Some(values)) = (mean_zero(data, load), data.values(load)) else { continue };
        let [before, after] = zeros_of(data, load);
        // As the sensor showed it.
        let largest = values.iter().zip(&zero).fold(0.0_f64, |m, (f, zero)| m.max((f + zero).abs()));
        if before.is_none() || after.is_none() {
            let (there, not) = if before.is_some() { ("before", "after") } else { ("after", "before") };
            findings.push(Finding::new(
                Severity::Note,
                "zero-drift",
                format!(
                    "{load}: the zero {there} each run is subtracted; its drift is unknown, since there is no reading {not} \
                     the run (a column zero_{not}_{load})"
                ),
            ));
            continue;
        }
        let drift = before.iter().zip(&after).flat_map(|(b, a)| b.iter().zip(*a)).map(|(b, a)| (a - b).abs());
        let drift = drift.fold(0.0, f64::max);
        let grave = drift > 0.01 * largest;
        findings.push(Finding::new(
            if grave { Severity::Warning } else { Severity::Note },
            "zero-drift",
            format!(
                "{load}: the zero of each run is subtracted; between before and after it moved by up to {drift:.3e} \
                 (largest load {largest:.3e}){}",
                if grave { "; declare it in the budget, shared by run" } else { "" }
            ),
        ));
    }
    findings
}

/// Rows that satisfy every clause of `keep`.
fn kept(keep: &Keep, data: &Dataset, source: &Source) -> Result<Vec<usize>, IdentifyError> {
    // A limit typed in degrees is not the same double as an angle read in degrees: one part in 10¹² is equal.
    let mut rows: Vec<usize> = (0..data.rows).collect();
    for clause in &keep.clauses {
        let unknown = || IdentifyError::Campaign {
            place: source.place.to_string(),
            what: format!("keep: the table has no column {:?}", clause.column),
        };
        match &clause.value {
            KeepValue::Quantity(limit) => {
                let column = data.meant(&clause.column);
                let values = data.values(column).ok_or_else(unknown)?;
                let dimension = data.dimension(column);
                if dimension != Some(limit.unit.dimension) {
                    return Err(IdentifyError::Campaign {
                        place: source.place.to_string(),
                        what: format!(
                            "keep: {} is in {}, its limit in {}",
                            clause.column,
                            dimension.unwrap_or(Dimension::ONE),
                            limit.unit.dimension
                        ),
                    });
                }
                let at = limit.value_si;
                let is_thin = |rho: &f64| plausible::AIR_KG_M3.contains(rho);
                if clause.column == "density"
                    && !values.iter().any(is_thin)
                    && let Some(problem) = plausible::density(at, None)
                {
                    return Err(IdentifyError::Campaign {
                        place: source.place.to_string(),
                        what: format!("keep: density is compared with {at} kg/m^3, which {problem}"),
                    });
                }
                let slack = 1e-12 * at.abs();
                rows.retain(|&i| match clause.comparison {
                    Comparison::Lt => values[i] < at - slack,
                    Comparison::Le => values[i] <= at + slack,
                    Comparison::Gt => values[i] > at + slack,
                    Comparison::Ge => values[i] >= at - slack,
                    Comparison::Eq => (values[i] - at).abs() <= slack,
                    Comparison::Ne => (values[i] - at).abs() > slack,
                });
            }
            KeepValue::Text(wanted) => {
                let column = match clause.column.as_str() {
                    "configuration" => &data.configuration,
                    "setup" => &data.setup,
                    "run" => &data.run,
                    _ => return Err(unknown()),
                };
                if column.iter().all(String::is_empty) {
                    return Err(unknown());
                }
                rows.retain(|&i| match clause.comparison {
                    Comparison::Ne => &column[i] != wanted,
                    _ => &column[i] == wanted,
                });
            }
        }
    }
    Ok(rows)
}
