//! `froude predict`: a record's forces on the rows of any table, with bands, errors and one number over all rows.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use froude_records::block::{Block, ResultTable, Section, TableBuilder, facts};
use froude_records::estimate::{Estimate, EstimateFile, beside};
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::json::read_estimates;
use froude_records::number::{dof, p_equation, percent, significant};
use froude_records::outcome::{Content, Outcome, OutputFile};
use froude_records::results::spares;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::text::{counted, in_a_file_name};
use froude_records::units::{Dimension, Unit, parse_unit};
use indexmap::IndexMap;

use crate::IdentifyError;
use crate::compare::observations;
use crate::dataset::{Dataset, LOADS};
use crate::lint::repeats::identical_copies;
use crate::predict::{Joint, Predicted, Row, predict as of_estimate};
use crate::reduce::rows_of;

/// Chance below which a record does not hold.
const CONTRADICTED: f64 = 0.01;
/// Rows that a person sees of those that are predicted worst.
const SHOWN: usize = 8;
/// Loads that a person sees of a table without measured ones.
const MOST_SHOWN: usize = 40;

/// A record that forces of a table are wanted of.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The record.
    pub record: PathBuf,
    /// The table.
    pub table: PathBuf,
    /// A sidecar that is not beside it.
    pub sidecar: Option<PathBuf>,
    /// Laws or ids of estimates; empty: the recommended ones, and of a record that recommends none all of them.
    pub laws: Vec<String>,
    /// Folder of a table of all rows for each estimate; `None`: nothing is written.
    pub out: Option<PathBuf>,
}

/// What was predicted.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// One for each estimate.
    pub estimates: Vec<Predicted>,
    /// What the laws and the table are not fit for.
    pub findings: Vec<Finding>,
    /// Why these rows are rows that an estimate was fitted to, by its id.
    seen: IndexMap<String, String>,
    data: Dataset,
}

/// Predicts.
///
/// # Errors
///
/// A record or a table that cannot be read; a law that the record does not have, that is none of forces, or that reads what the table lacks; results in the place of what is read.
pub fn predict(job: &Job) -> Result<Outcome, IdentifyError> {
    let found = predicted(job)?;
    let mut files = Vec::new();
    for (folder, predicted) in job.out.iter().flat_map(|out| found.estimates.iter().map(move |one| (out, one))) {
        let path = folder.join(format!("predicted-{}.csv", in_a_file_name(&predicted.id)));
        spares(&path, [job.record.as_path(), job.table.as_path()].into_iter().chain(job.sidecar.as_deref()))?;
        let content = Content::Table(found.table(predicted, &path));
        files.push(OutputFile { key: "written[]", path, content });
    }
    let blocks = found.estimates.iter().map(|predicted| found.section(predicted).into()).collect();
    Ok(Outcome { blocks, findings: Some(found.findings), files, ..Outcome::default() })
}

/// The same, not yet said.
///
/// # Errors
///
/// As [`predict`].
pub fn predicted(job: &Job) -> Result<Prediction, IdentifyError> {
    let record = read_estimates(&job.record)?;
    let (mut data, mut findings) = rows_of(&job.table, job.sidecar.as_deref())?;
    // Settings without a load are no observations: they may repeat.
    if !data.loads().is_empty() {
        let (unique, copies) = identical_copies(&data);
        data = data.subset(&unique);
        findings.extend(copies);
    }
    let chosen = chosen(&record.estimates, &job.laws).map_err(|what| refused(&job.record, what))?;
    let mut seen = IndexMap::new();
    for estimate in &chosen {
        if let Some(why) = fitted_to(job, &record, estimate, &data)? {
            seen.insert(estimate.id.clone(), why);
        }
    }
    let mut found = of_rows(&record.estimates.iter().collect::<Vec<_>>(), &chosen, data)?.seen(seen);
    found.findings.splice(0..0, findings);
    Ok(found)
}

/// The same of rows that are reduced already; `all` are the estimates that those may have laws beside them in.
///
/// # Errors
///
/// A law that reads what the rows lack.
pub fn of_rows(all: &[&Estimate], estimates: &[&Estimate], data: Dataset) -> Result<Prediction, IdentifyError> {
    let of = |estimate: &&Estimate| {
        of_estimate(estimate, &beside(all.iter().copied(), estimate), &in_water(&data, estimate))
    };
    let mut findings: Vec<Finding> = estimates.iter().filter_map(|estimate| without_bands(estimate)).collect();
    findings.extend(estimates.iter().filter_map(|estimate| load_at_rest(estimate, &data)));
    let estimates = estimates.iter().map(of).collect::<Result<_, _>>()?;
    Ok(Prediction { estimates, findings, seen: IndexMap::new(), data })
}

/// Why the rows of a table are rows that an estimate was fitted to: its file by the fingerprint, or its rows where that file is still beside the record.
fn fitted_to(
    job: &Job,
    record: &EstimateFile,
    estimate: &Estimate,
    data: &Dataset,
) -> Result<Option<String>, IdentifyError> {
    let own = sha256_of_file(&job.table)?;
    let fitted = observations(record, estimate).into_iter();
    for file in fitted.filter(|file| file.role.as_deref().is_none_or(|role| role == "table")) {
        if file.sha256 == own {
            return Ok(Some(format!(
                "{} has the SHA-256 of {}, which it was fitted to",
                job.table.display(),
                file.path
            )));
        }
        // A record lies beside its campaign, or in a folder of results there.
        let folders = job.record.ancestors().skip(1).take(2).map(|folder| folder.join(&file.path));
        let is_as_fitted = |path: &PathBuf| path.is_file() && sha256_of_file(path).is_ok_and(|sum| sum == file.sha256);
        if let Some((fitted, _)) = folders.into_iter().find(is_as_fitted).and_then(|path| rows_of(&path, None).ok())
            && let Some(why) = same_rows(data, &fitted)
        {
            return Ok(Some(format!("{why} of {}, which it was fitted to", file.path)));
        }
    }
    Ok(None)
}

/// That more than half of the rows of a data set are rows of another one, in every number that both tables have, a load among them: readings of coarse steps coincide in fewer.
#[must_use]
pub fn same_rows(data: &Dataset, fitted: &Dataset) -> Option<String> {
    const DIGITS: usize = 9;
    let names: Vec<&String> = data.channels.keys().filter(|name| fitted.channels.contains_key(*name)).collect();
    let has_load = names.iter().any(|name| LOADS.contains(&name.as_str()));
    let key = |of: &Dataset, row: usize| -> Vec<String> {
        let digits = |name: &&String| of.values(name).map_or_else(String::new, |v| format!("{:.DIGITS$e}", v[row]));
        names.iter().map(digits).collect()
    };
    let known: BTreeSet<Vec<String>> = (0..fitted.rows).map(|row| key(fitted, row)).collect();
    let same = (0..data.rows).filter(|&row| known.contains(&key(data, row))).count();
    (has_load && 2 * same > data.rows).then(|| format!("{same} of {} are rows", counted(data.rows, "row", "rows")))
}

/// That one cluster decides a coefficient, and what follows for forces.
fn without_bands(estimate: &Estimate) -> Option<Finding> {
    let clusters = estimate.clusters.as_ref()?;
    let names = estimate.without_interval();
    (!names.is_empty()).then(|| {
        let text = format!(
            "{}: {} without an interval, as one of its {} decides: forces that go with them have no band and no E_n",
            estimate.id,
            names.join(", "),
            counted(clusters.n, &clusters.by, &format!("{}s", clusters.by))
        );
        Finding::new(Severity::Warning, "no-band", text)
    })
}

/// Loads that a law gives in water at rest: its constants, which may be those of the rig.
fn load_at_rest(estimate: &Estimate, data: &Dataset) -> Option<Finding> {
    if data.rows == 0 {
        return None;
    }
    let mut at_rest = in_water(data, estimate).subset(&[0]);
    let names: Vec<(String, Dimension)> =
        at_rest.channels.iter().map(|(name, c)| (name.clone(), c.dimension)).collect();
    for (name, dimension) in names.into_iter().filter(|(name, _)| name != "density") {
        at_rest.put(&name, vec![0.0; 1], dimension);
    }
    let predicted = of_estimate(estimate, &[], &at_rest).ok()?;
    let constant = |row: &&Row| row.predicted != 0.0 && row.predicted.is_finite();
    let of = |row: &Row| format!("{} {} {}", row.load, significant(row.predicted, 3), row.unit);
    let loads: Vec<String> = predicted.rows.iter().filter(constant).map(of).collect();
    (!loads.is_empty()).then(|| {
        let text = format!(
            "{}: the law gives a load at rest ({}), which is part of each prediction. If it is of the rig (a load cell that was not zeroed, friction) and not of the water, subtract it \
             from the loads before the fit, or fit it as the offset of a group (group_offset = \"estimate\"), which is no part of a prediction",
            estimate.id,
            loads.join(", ")
        );
        Finding::new(Severity::Note, "constant-load", text)
    })
}

fn refused(record: &Path, what: String) -> IdentifyError {
    IdentifyError::Campaign { place: record.display().to_string(), what }
}

fn chosen<'a>(all: &'a [Estimate], laws: &[String]) -> Result<Vec<&'a Estimate>, String> {
    if laws.is_empty() {
        let recommended: Vec<&Estimate> = all.iter().filter(|e| e.recommended).collect();
        return Ok(if recommended.is_empty() { all.iter().collect() } else { recommended });
    }
    let mut out = Vec::new();
    for law in laws {
        let found: Vec<&Estimate> = all.iter().filter(|e| e.id == *law || e.law.name == *law).collect();
        if found.is_empty() {
            let names: Vec<&str> = all.iter().map(|e| e.id.as_str()).collect();
            return Err(format!("has no estimate or law {law:?}; it has {}", names.join(", ")));
        }
        out.extend(found);
    }
    Ok(out)
}

/// A table that states no density, and no viscosity, is in the water that the coefficients refer to.
fn in_water(data: &Dataset, estimate: &Estimate) -> Dataset {
    let mut data = data.clone();
    for (name, dimension) in [("density", Dimension::DENSITY), ("kinematic_viscosity", Dimension::KINEMATIC_VISCOSITY)]
    {
        if let (None, Some(stated)) = (data.values(name), estimate.refers_to.get(name)) {
            data.put(name, vec![stated.value; data.rows], dimension);
        }
    }
    data
}

/// What the rows of a load come to.
struct OfLoad {
    load: String,
    unit: String,
    rows: usize,
    measured: usize,
    outside: usize,
    /// Mean, and root of the mean square, of measured less predicted.
    errors: Option<[f64; 2]>,
    /// Root of the mean square of what was measured.
    size: f64,
    beyond: usize,
    u_law: Option<f64>,
}

fn by_load(predicted: &Predicted) -> Vec<OfLoad> {
    let mut out: Vec<OfLoad> = Vec::new();
    let mut loads: Vec<&String> = Vec::new();
    for row in &predicted.rows {
        if !loads.contains(&&row.load) {
            loads.push(&row.load);
        }
    }
    for load in loads {
        let all: Vec<&Row> = predicted.rows.iter().filter(|row| row.load == *load).collect();
        let inside: Vec<&Row> =
            all.iter().copied().filter(|row| row.outside.is_empty() && row.measured.is_some()).collect();
        let n = inside.len() as f64;
        let mean = |of: &dyn Fn(&Row) -> f64| inside.iter().map(|row| of(row)).sum::<f64>() / n;
        let error = |row: &Row| row.error().unwrap_or_default();
        let u_laws: Option<Vec<f64>> = all.iter().map(|row| row.u_law).collect();
        out.push(OfLoad {
            load: load.clone(),
            unit: all.first().map(|row| row.unit.clone()).unwrap_or_default(),
            rows: all.len(),
            measured: inside.len(),
            outside: all.iter().filter(|row| !row.outside.is_empty()).count(),
            errors: (!inside.is_empty()).then(|| [mean(&error), mean(&|row| error(row).powi(2)).sqrt()]),
            size: mean(&|row| row.measured.unwrap_or_default().powi(2)).sqrt(),
            beyond: inside.iter().filter(|row| row.e_n.is_some_and(|e| e.abs() > 1.0)).count(),
            u_law: u_laws.map(|u| (u.iter().map(|u| u * u).sum::<f64>() / u.len().max(1) as f64).sqrt()),
        });
    }
    out
}

impl Prediction {
    /// With what says that rows are no others than those of a fit, by the ids of estimates.
    #[must_use]
    pub fn seen(self, seen: IndexMap<String, String>) -> Self {
        Self { seen, ..self }
    }

    /// What an estimate is worth on these rows, as a finding: its errors by load, |E_n| beyond 1, and the one number over all rows.
    #[must_use]
    pub fn finding(&self, predicted: &Predicted) -> Finding {
        let of = |of: &OfLoad| {
            let [mean, root] = of.errors?;
            Some(format!(
                "{} errs by {} {} in the mean, {} rms ({} of the load), |E_n| > 1 in {} of {}",
                of.load,
                significant(mean, 3),
                of.unit,
                significant(root, 3),
                percent(root / of.size),
                of.beyond,
                counted(of.measured, "row", "rows")
            ))
        };
        let loads: Vec<String> = by_load(predicted).iter().filter_map(of).collect();
        let is_contradicted = predicted.joint.and_then(|joint| joint.p).is_some_and(|p| p < CONTRADICTED);
        let seen = self.seen.get(&predicted.id);
        let (severity, code) = match (seen, is_contradicted) {
            (Some(_), _) => (Severity::Warning, "validation-on-fitted-rows"),
            (None, true) => (Severity::Warning, "validation-fails"),
            (None, false) => (Severity::Note, "validation"),
        };
        let number = predicted.joint.as_ref().map_or_else(|| "no scatter is known, and so no χ²".to_owned(), joint);
        let loads = if loads.is_empty() { "no load lies within its ranges".to_owned() } else { loads.join("; ") };
        let on = seen.map_or_else(|| "rows that it was not fitted to".to_owned(), |why| no_validation(why));
        Finding::new(severity, code, format!("{} on {on}: {loads}; {number}", predicted.id))
    }

    /// What an estimate gives on these rows.
    #[must_use]
    pub fn section(&self, predicted: &Predicted) -> Section {
        let has_measured = predicted.rows.iter().any(|row| row.measured.is_some());
        let caption = format!("{} on {}", predicted.id, counted(self.data.rows, "row", "rows"));
        let mut blocks: Vec<Block> = vec![self.about(predicted).into()];
        if has_measured {
            blocks.push(of_loads(&by_load(predicted), &caption).into());
        }
        let (rows, hidden) = self.rows(predicted, has_measured, caption);
        blocks.push(rows.into());
        blocks.push(Block::text("", self.sentences(predicted, hidden)));
        let title = format!("Predicted by {}", predicted.id);
        Section { key: "estimates[]".to_owned(), title, blocks, ..Section::default() }
    }

    fn about(&self, predicted: &Predicted) -> ResultTable {
        let f = facts("", "", predicted);
        f.build(vec![
            f.text("estimate", "", |p| p.id.clone()),
            f.text("law", "", |p| p.law.clone()),
            f.texts("laws", "", |p| p.laws.clone()),
            f.texts("left_out", "", |p| p.left_out.clone()),
            f.text("fitted_to_these_rows", "", |p| self.seen.get(&p.id).cloned()),
            f.number("joint/chi_squared", "", |p| p.joint.map(|joint| joint.chi_squared)),
            f.count("joint/n", "", |p| p.joint.map(|joint| joint.n)),
            f.number("joint/dof", "", |p| p.joint.map(|joint| joint.dof)),
            f.number("joint/p", "", |p| p.joint.and_then(|joint| joint.p)),
        ])
    }

    /// All rows, of which a person sees those with the largest |E_n|, or the first where nothing was measured; and how many loads that leaves out.
    fn rows(&self, predicted: &Predicted, has_measured: bool, caption: String) -> (ResultTable, usize) {
        let all = &predicted.rows;
        let mut order: Vec<usize> = (0..all.len()).collect();
        let e_n = |i: usize| all[i].e_n.unwrap_or_default().abs();
        let (caption, most) = if has_measured {
            order.retain(|i| all[*i].e_n.is_some());
            order.sort_by(|a, b| e_n(*b).total_cmp(&e_n(*a)));
            ("rows with the largest |E_n|".to_owned(), SHOWN)
        } else {
            order.sort_by_key(|i| all[*i].row);
            (caption, MOST_SHOWN)
        };
        let hidden = if has_measured { 0 } else { order.len().saturating_sub(most) };
        order.truncate(most);
        let shown = |head: &'static str| if has_measured { head } else { "" };
        let t = TableBuilder::new("rows", caption, all);
        let mut table = t.build(vec![
            t.text("", "row", |row| self.data.row_name(row.row)),
            t.count("line", "", |row| self.data.line.get(row.row).copied()),
            t.text("load", "load", |row| row.load.clone()),
            t.text("unit", "unit", |row| row.unit.clone()),
            t.number("measured", shown("measured"), |row| row.measured).significant(3),
            t.number("predicted", "predicted", |row| row.predicted),
            t.number("u_law", "", |row| row.u_law),
            t.interval("band_95", "95 % band", |row| row.band_95),
            t.number("scatter", "", |row| row.scatter),
            t.number("error", shown("error"), Row::error).significant(3),
            t.number("e_n", shown("E_n"), |row| row.e_n).significant(3),
            t.texts("outside", "outside its range of", |row| row.outside.clone()),
        ]);
        table.shown_rows = Some(order);
        (table, hidden)
    }

    fn sentences(&self, predicted: &Predicted, hidden: usize) -> Vec<String> {
        let mut out: Vec<String> = predicted.joint.iter().map(joint).collect();
        if hidden > 0 {
            let all = counted(predicted.rows.len(), "load", "loads");
            out.push(format!("{MOST_SHOWN} of {all} are shown; `--out FOLDER` writes them all"));
        }
        if predicted.laws.len() > 1 {
            out.push(format!(
                "Bands and E_n come from the envelope of this law and all others that the data of the record do not contradict ({}). χ² is that of the law that agrees best.",
                predicted.laws.join(", ")
            ));
        }
        if !predicted.left_out.is_empty() {
            out.push(format!(
                "Not in the envelope, as these rows lack what they read: {}; the bands may be too narrow.",
                predicted.left_out.join(", ")
            ));
        }
        if let Some(why) = self.seen.get(&predicted.id) {
            out.push(format!("On {}", no_validation(why)));
        }
        let outside = predicted.rows.iter().filter(|row| !row.outside.is_empty()).count();
        if outside > 0 {
            out.push(format!(
                "{} outside of the ranges of the record: extrapolated; excluded from errors and χ²",
                counted(outside, "load lies", "loads lie")
            ));
        }
        if predicted.rows.iter().any(|row| row.u_law.is_none()) {
            out.push(
                "the record states no covariance, so there is no band, and E_n includes only the scatter".to_owned(),
            );
        }
        if predicted.rows.iter().any(|row| row.measured.is_some() && row.scatter.is_none()) {
            out.push("neither the table (std_f_x) nor the record states a scatter, so that there is no χ²".to_owned());
        }
        out
    }

    /// All rows of an estimate.
    fn table(&self, predicted: &Predicted, path: &Path) -> Table {
        let data = &self.data;
        let of_unit = |name: &str, unit: &str, si: Vec<f64>| {
            let unit = parse_unit(unit).unwrap_or_else(|_| Unit::one());
            Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } }
        };
        let mut columns = vec![of_unit("line", "1", data.line.iter().map(|l| *l as f64).collect())];
        columns.extend(data.named_columns().filter(|column| column.name != "setup"));
        for (name, unit) in [("speed", "m/s"), ("angle", "deg")] {
            columns.extend(data.values(name).map(|values| of_unit(name, unit, values.to_vec())));
        }
        for load in by_load(predicted) {
            let rows: Vec<&Row> = predicted.rows.iter().filter(|row| row.load == load.load).collect();
            let mut put = |end: &str, unit: &str, of: &dyn Fn(&Row) -> Option<f64>| {
                let values: Option<Vec<f64>> = rows.iter().map(|row| of(row)).collect();
                columns.extend(values.map(|values| of_unit(&format!("{}{end}", load.load), unit, values)));
            };
            put("", &load.unit, &|row| row.measured);
            put("_predicted", &load.unit, &|row| Some(row.predicted));
            put("_u_law", &load.unit, &|row| row.u_law);
            put("_low_95", &load.unit, &|row| row.band_95.map(|[low, _]| low));
            put("_high_95", &load.unit, &|row| row.band_95.map(|[_, high]| high));
            put("_scatter", &load.unit, &|row| row.scatter);
            put("_error", &load.unit, &Row::error);
            put("_e_n", "1", &|row| row.e_n);
        }
        let first = predicted.rows.iter().take(data.rows);
        let outside = first.map(|row| if row.outside.is_empty() { "no".to_owned() } else { row.outside.join(" ") });
        columns.push(Column { name: "outside".to_owned(), data: ColumnData::Text(outside.collect()) });
        Table { n_rows: data.rows, ..Table::of(path.to_owned(), columns, data.line.clone()) }
    }
}

/// What the rows of each load come to.
fn of_loads(loads: &[OfLoad], caption: &str) -> ResultTable {
    let t = TableBuilder::new("loads", caption, loads);
    t.build(vec![
        t.text("load", "load", |of| of.load.clone()),
        t.text("unit", "unit", |of| of.unit.clone()),
        t.count("rows", "rows", |of| of.rows),
        t.count("outside", "outside", |of| of.outside),
        t.number("u_law_rms", "u of the law", |of| of.u_law).significant(3),
        t.number("mean_error", "mean error (measured − predicted)", |of| of.errors.map(|[mean, _]| mean))
            .significant(3),
        t.number("rms_error", "rms error", |of| of.errors.map(|[_, root]| root)).significant(3),
        t.number("of_rms_load", "rms error / rms load", |of| of.errors.map(|[_, root]| root / of.size)).percent(),
        t.count("beyond", "rows with |E_n| > 1", |of| (of.measured > 0).then_some(of.beyond)),
        t.count("measured", "rows measured", |of| (of.measured > 0).then_some(of.measured)),
    ])
}

fn no_validation(why: &str) -> String {
    format!(
        "rows that it was fitted to ({why}), so this does not validate it: errors and χ² are smaller there than on new rows"
    )
}

fn joint(found: &Joint) -> String {
    let Joint { chi_squared, n, dof: of_scatter, p } = found;
    let number = format!(
        "χ² = {} over {}, with the covariance between rows",
        significant(*chi_squared, 4),
        counted(*n, "load in a row", "loads in rows")
    );
    let Some(p) = p else {
        return format!("{number}; no p, since the scatter of the record is that of clusters, in which rows err alike");
    };
    let verdict = if *p < CONTRADICTED {
        "the record does not hold here: its errors and its scatter together do not explain what was measured"
    } else {
        "no more than its errors and its scatter together explain"
    };
    let with = if of_scatter.is_finite() {
        format!("F({n}, {}), as the scatter was estimated", dof(*of_scatter))
    } else {
        format!("χ²({n})")
    };
    format!("{number}; {} by {with}: {verdict}", p_equation(*p))
}
