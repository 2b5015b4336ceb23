//! `froude predict`: a record's forces on the rows of any table, with bands, errors and one number over all rows.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use froude_identify::compare::observations;
use froude_identify::dataset::{Dataset, LOADS};
use froude_identify::lint::repeats::identical_copies;
use froude_identify::predict::{Joint, Predicted, Row, predict as of_estimate};
use froude_identify::reduce::rows_of;
use froude_records::RecordError;
use froude_records::csv_table::csv_bytes;
use froude_records::estimate::{Estimate, EstimateFile, beside};
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::json::read_estimates;
use froude_records::manifest::take_own_place;
use froude_records::number::{dof, p_equation, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::table::{Column, ColumnData, Table};
use froude_records::text::{counted, in_a_file_name};
use froude_records::units::{Dimension, Unit, parse_unit};
use froude_records::write::Prepared;
use indexmap::IndexMap;
use serde_json::{Value, json};

use crate::Error;
use crate::results::spares;

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
    /// What the reader of the table found.
    pub findings: Vec<Finding>,
    /// Tables that were written.
    pub written: Vec<PathBuf>,
    /// Why these rows are rows that an estimate was fitted to, by its id.
    seen: IndexMap<String, String>,
    data: Dataset,
}

/// Predicts.
///
/// # Errors
///
/// A record or a table that cannot be read; a law that the record does not have, that is none of forces, or that reads what the table lacks; a folder that cannot be written.
pub fn predict(job: &Job) -> Result<Prediction, Error> {
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
    let mut out = of_rows(&record.estimates.iter().collect::<Vec<_>>(), &chosen, data)?.seen(seen);
    out.findings = [findings, out.findings].concat();
    if let Some(folder) = &job.out {
        std::fs::create_dir_all(folder).map_err(|source| RecordError::output(folder, &source))?;
        for predicted in &out.estimates {
            let path = folder.join(format!("predicted-{}.csv", in_a_file_name(&predicted.id)));
            spares(&path, [job.record.as_path(), job.table.as_path()].into_iter().chain(job.sidecar.as_deref()))?;
            let bytes = csv_bytes(&out.table(predicted, &path))?;
            take_own_place(Prepared::new(&path, |file| file.write_all(&bytes))?)?;
            out.written.push(path);
        }
    }
    Ok(out)
}

/// The same of rows that are reduced already; `all` are the estimates that those may have laws beside them in.
///
/// # Errors
///
/// A law that reads what the rows lack.
pub fn of_rows(all: &[&Estimate], estimates: &[&Estimate], data: Dataset) -> Result<Prediction, Error> {
    let of = |estimate: &&Estimate| {
        of_estimate(estimate, &beside(all.iter().copied(), estimate), &with_density(&data, estimate))
    };
    let mut findings: Vec<Finding> = estimates.iter().filter_map(|estimate| without_bands(estimate)).collect();
    findings.extend(estimates.iter().filter_map(|estimate| load_at_rest(estimate, &data)));
    let estimates = estimates.iter().map(of).collect::<Result<_, _>>()?;
    Ok(Prediction { estimates, findings, written: Vec::new(), seen: IndexMap::new(), data })
}

/// Why the rows of a table are rows that an estimate was fitted to: its file by the fingerprint, or its rows where that file is still beside the record.
fn fitted_to(job: &Job, record: &EstimateFile, estimate: &Estimate, data: &Dataset) -> Result<Option<String>, Error> {
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
pub(crate) fn same_rows(data: &Dataset, fitted: &Dataset) -> Option<String> {
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
    let mut at_rest = with_density(data, estimate).subset(&[0]);
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

fn refused(record: &Path, what: String) -> Error {
    froude_identify::IdentifyError::Campaign { place: record.display().to_string(), what }.into()
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

/// A table that states no density is in the water that the coefficients refer to.
fn with_density(data: &Dataset, estimate: &Estimate) -> Dataset {
    let mut data = data.clone();
    if let (None, Some(density)) = (data.values("density"), estimate.density()) {
        data.put("density", vec![density.value; data.rows], Dimension::DENSITY);
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
    pub(crate) fn seen(self, seen: IndexMap<String, String>) -> Self {
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

    /// What a person reads of an estimate.
    #[must_use]
    pub fn section(&self, predicted: &Predicted) -> DocumentSection {
        let dash = || "–".to_owned();
        let number = |x: Option<f64>| x.map_or_else(dash, |x| significant(x, 3));
        let row = |of: &OfLoad| {
            vec![
                format!("{}, {}", of.load, of.unit),
                of.rows.to_string(),
                of.outside.to_string(),
                number(of.u_law),
                number(of.errors.map(|[mean, _]| mean)),
                number(of.errors.map(|[_, root]| root)),
                of.errors.map_or_else(dash, |[_, root]| percent(root / of.size)),
                if of.measured > 0 { format!("{} of {}", of.beyond, of.measured) } else { dash() },
            ]
        };
        let loads = by_load(predicted);
        let head =
            ["load", "rows", "outside", "u of the law", "mean error", "rms error", "of the rms load", "|E_n| > 1"];
        let mut tables = Vec::new();
        if predicted.rows.iter().any(|row| row.measured.is_some()) {
            tables.push(TextTable {
                caption: format!("{} on {}", predicted.id, counted(self.data.rows, "row", "rows")),
                head: head.map(str::to_owned).to_vec(),
                rows: loads.iter().map(row).collect(),
            });
        }
        let mut worst: Vec<&Row> = predicted.rows.iter().filter(|row| row.e_n.is_some()).collect();
        worst.sort_by(|a, b| b.e_n.unwrap_or_default().abs().total_cmp(&a.e_n.unwrap_or_default().abs()));
        let band = |row: &Row| {
            row.band_95.map_or_else(dash, |[low, high]| format!("{} to {}", significant(low, 3), significant(high, 3)))
        };
        let line = |row: &&Row| {
            vec![
                self.data.row_name(row.row),
                format!("{}, {}", row.load, row.unit),
                number(row.measured),
                number(Some(row.predicted)),
                band(row),
                number(row.error()),
                number(row.e_n),
                if row.outside.is_empty() { String::new() } else { row.outside.join(", ") },
            ]
        };
        if !worst.is_empty() {
            let head = ["row", "load", "measured", "predicted", "95 % band", "error", "E_n", "outside its range of"];
            tables.push(TextTable {
                caption: "rows with the largest |E_n|".to_owned(),
                head: head.map(str::to_owned).to_vec(),
                rows: worst.iter().take(SHOWN).map(line).collect(),
            });
        }
        let mut paragraphs: Vec<String> = predicted.joint.iter().map(joint).collect();
        if tables.is_empty() {
            let mut all: Vec<&Row> = predicted.rows.iter().collect();
            all.sort_by_key(|row| row.row);
            let line = |row: &&Row| {
                let load = format!("{}, {}", row.load, row.unit);
                let predicted = significant(row.predicted, 4);
                vec![self.data.row_name(row.row), load, predicted, band(row), row.outside.join(", ")]
            };
            tables.push(TextTable {
                caption: format!("{} on {}", predicted.id, counted(self.data.rows, "row", "rows")),
                head: ["row", "load", "predicted", "95 % band", "outside its range of"].map(str::to_owned).to_vec(),
                rows: all.iter().take(MOST_SHOWN).map(line).collect(),
            });
            if all.len() > MOST_SHOWN {
                let all = counted(all.len(), "load", "loads");
                paragraphs.push(format!("{MOST_SHOWN} of {all} are shown; `--out FOLDER` writes them all"));
            }
        }
        if predicted.laws.len() > 1 {
            paragraphs.push(format!(
                "Bands and E_n come from the envelope of this law and all others that the data of the record do not contradict ({}). χ² is that of the law that agrees best.",
                predicted.laws.join(", ")
            ));
        }
        if !predicted.left_out.is_empty() {
            paragraphs.push(format!(
                "Not in the envelope, as these rows lack what they read: {}; the bands may be too narrow.",
                predicted.left_out.join(", ")
            ));
        }
        if let Some(why) = self.seen.get(&predicted.id) {
            paragraphs.push(format!("On {}", no_validation(why)));
        }
        let outside = predicted.rows.iter().filter(|row| !row.outside.is_empty()).count();
        if outside > 0 {
            paragraphs.push(format!(
                "{} outside of the ranges of the record: extrapolated, and counted in no error and in no χ²",
                counted(outside, "load lies", "loads lie")
            ));
        }
        if predicted.rows.iter().any(|row| row.u_law.is_none()) {
            paragraphs.push(
                "the record states no covariance, so that there is no band and E_n holds the scatter alone".to_owned(),
            );
        }
        if predicted.rows.iter().any(|row| row.measured.is_some() && row.scatter.is_none()) {
            paragraphs
                .push("neither the table (std_f_x) nor the record states a scatter, so that there is no χ²".to_owned());
        }
        DocumentSection { title: format!("Predicted by {}", predicted.id), paragraphs, tables, charts: Vec::new() }
    }

    /// All rows of an estimate.
    fn table(&self, predicted: &Predicted, path: &Path) -> Table {
        let data = &self.data;
        let of_unit = |name: &str, unit: &str, si: Vec<f64>| {
            let unit = parse_unit(unit).unwrap_or_else(|_| Unit::one());
            Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } }
        };
        let mut columns = vec![of_unit("line", "1", data.line.iter().map(|l| *l as f64).collect())];
        for (name, texts) in [("configuration", &data.configuration), ("run", &data.run)] {
            if texts.iter().any(|text| !text.is_empty()) {
                columns.push(Column { name: name.to_owned(), data: ColumnData::Text(texts.clone()) });
            }
        }
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

    /// The same for a program.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let row = |row: &Row| {
            json!({
                "line": self.data.line.get(row.row),
                "load": row.load,
                "unit": row.unit,
                "predicted": row.predicted,
                "u_law": row.u_law,
                "band_95": row.band_95,
                "measured": row.measured,
                "scatter": row.scatter,
                "error": row.error(),
                "e_n": row.e_n,
                "outside": row.outside,
            })
        };
        let of = |predicted: &Predicted| {
            let joint = predicted.joint.map(|j| {
                json!({"chi_squared": j.chi_squared, "n": j.n, "dof": froude_records::number::finite(Some(j.dof)), "p": j.p})
            });
            json!({
                "estimate": predicted.id,
                "law": predicted.law,
                "laws": predicted.laws,
                "left_out": predicted.left_out,
                "fitted_to_these_rows": self.seen.get(&predicted.id),
                "joint": joint,
                "rows": predicted.rows.iter().map(row).collect::<Vec<_>>(),
            })
        };
        json!({
            "estimates": self.estimates.iter().map(of).collect::<Vec<_>>(),
            "findings": self.findings,
            "written": self.written,
        })
    }
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
