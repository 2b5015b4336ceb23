//! `froude cfd collect`: the forces that count, as a table of observations; and how far cases that should agree do.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::section::CfdSpec;
use froude_records::RecordError;
use froude_records::block::{Block, ResultColumn, ResultTable, Section, TableBuilder, facts};
use froude_records::csv_table::csv_bytes;
use froude_records::manifest::take_own_place;
use froude_records::number::significant;
use froude_records::read;
use froude_records::table::{Column, ColumnData, Table, links_of_configuration};
use froude_records::text::counted;
use froude_records::units::{Dimension, Unit, parse_unit};
use froude_records::write::Prepared;

use super::asked::Asked;
use super::error::VerbError;
use super::loads::{LOADS, loads_of, unit};
use super::numerical;
use crate::again::Again;
use crate::case::Model;
use crate::collect::{Collected as Row, collect as results};
use crate::mirror::{OneSided, is_symmetric, take_means};
use crate::numerical::Numerical;
use crate::outcome::Status;
use crate::store::Store;
use crate::wall::{MeshQuality, std_of_wall};

/// Name of the table.
const TABLE: &str = "observations.csv";
/// Of a table that is compared with the new one.
const LARGEST_TABLE: u64 = 64 << 20;
/// Part of ½ρU²A beyond which a flow that leans to one side is worth a sentence.
const SEEN: f64 = 0.01;

/// What was collected.
#[derive(Debug)]
pub(super) struct Collected {
    /// The table's file.
    pub path: PathBuf,
    /// Whether the campaign or its body was changed after the cases were planned.
    pub is_outdated: bool,
    pub(super) table: Table,
    /// Those of the table.
    pub(super) rows: Vec<Row>,
    /// Names of cases without a result that counts, and why.
    pub without: Vec<(String, String)>,
    /// A repeat from the inflow, or by the other model, with the case it repeats.
    pairs: Vec<Pair>,
    /// Loads that were set to the mean of a flow and its mirror image.
    pub one_sided: Vec<OneSided>,
    /// What the mesh and the domain do.
    pub(super) numerical: Numerical,
}

/// Two computations of one setting.
#[derive(Debug, Clone)]
struct Pair {
    what: &'static str,
    first: Row,
    second: Row,
}

/// Collects a campaign and writes its table; the caller reports it.
pub(super) fn collected(campaign: &Path, source: Option<&str>) -> Result<Collected, VerbError> {
    let asked = Asked::read(campaign, source)?;
    of_folder(&asked.folder, &asked.spec, Some(&asked.inputs_sha256()), || Ok(()))
}

/// Collects a folder of cases computed with `spec`; `inputs_sha256`, if known, tells whether the plan is outdated. `may_write` is called before a missing table is written.
pub(super) fn of_folder(
    folder: &Path,
    spec: &CfdSpec,
    inputs_sha256: Option<&str>,
    may_write: impl FnOnce() -> Result<(), RecordError>,
) -> Result<Collected, VerbError> {
    let store = Store::open(folder)?;
    let is_outdated = inputs_sha256.is_some_and(|inputs_sha256| !store.was_planned_from(inputs_sha256));
    let found = results(&store);
    let numerical = Numerical::of(&found.rows, spec);
    let (mut rows, pairs) = paired(found.rows);
    if rows.is_empty() {
        let why = found.without.first().map_or_else(String::new, |(id, why)| format!(" ({id}: {why})"));
        let problem = format!("no case has a result that counts{why}; froude cfd run computes what has none");
        return Err(VerbError::input(folder, problem));
    }
    for row in &mut rows {
        let correction = numerical.correction(&row.case);
        row.loads = std::array::from_fn(|k| row.loads[k] + correction[k]);
    }
    let one_sided = if is_symmetric(spec) { take_means(&mut rows) } else { Vec::new() };
    let path = folder.join(TABLE);
    let table = table(&rows, &numerical, &path);
    let bytes = csv_bytes(&table)?;
    if read::if_there(&path, LARGEST_TABLE, "a table")?.as_deref() != Some(&bytes[..]) {
        may_write()?;
        take_own_place(Prepared::new(&path, |out| out.write_all(&bytes))?)?;
    }
    Ok(Collected { path, is_outdated, table, rows, without: found.without, pairs, one_sided, numerical })
}

/// The rows of the table, and the repeats, without what was computed on other grids and in other domains: of a setting that both models computed the one with turbulence counts, and of one that was repeated from the inflow the first.
fn paired(all: Vec<Row>) -> (Vec<Row>, Vec<Pair>) {
    let (mut rows, mut others): (Vec<Row>, Vec<(&'static str, Row)>) = (Vec::new(), Vec::new());
    let key = |row: &Row| (row.case.configuration.clone(), row.case.flow.velocity_m_s().map(f64::to_bits));
    let again = |row: &Row| Again::of(&row.case.id).map(|(_, again)| again);
    let (turbulent, laminar): (Vec<Row>, Vec<Row>) = all
        .into_iter()
        .filter(|row| matches!(again(row), None | Some(Again::Cold)))
        .partition(|row| matches!(row.case.model, Model::Sst { .. }));
    for (what, of_model) in [("from the inflow", turbulent), ("laminar", laminar)] {
        let is_other_model = what == "laminar";
        for row in of_model {
            let is_cold = again(&row) == Some(Again::Cold);
            let is_there = rows.iter().any(|r: &Row| key(r) == key(&row));
            match (is_cold, is_there && is_other_model) {
                (true, _) => others.push(("from the inflow", row)),
                (false, true) => others.push((what, row)),
                (false, false) => rows.push(row),
            }
        }
    }
    let mut pairs = Vec::new();
    for (what, second) in others {
        let is_same = |r: &&Row| key(r) == key(&second) && (what == "laminar" || r.case.model == second.case.model);
        match rows.iter().find(is_same).cloned() {
            Some(first) => pairs.push(Pair { what, first, second }),
            // The case that it repeats has no result that counts.
            None if what == "from the inflow" => rows.push(second),
            None => {}
        }
    }
    rows.sort_by(|a, b| a.case.id.cmp(&b.case.id));
    (rows, pairs)
}

fn table(rows: &[Row], numerical: &Numerical, path: &Path) -> Table {
    let text = |name: &str, of: &dyn Fn(&Row) -> String| Column {
        name: name.to_owned(),
        data: ColumnData::Text(rows.iter().map(of).collect()),
    };
    let number = |name: &str, unit: &str, dimension: Dimension, of: &dyn Fn(&Row) -> f64| Column {
        name: name.to_owned(),
        data: ColumnData::Number {
            // The units of this file are units.
            unit: parse_unit(unit).unwrap_or_else(|_| Unit::si(dimension)),
            dimension,
            si: rows.iter().map(of).collect(),
        },
    };
    let mut columns = vec![
        text("configuration", &|r| r.case.configuration.clone()),
        text("run", &|r| r.case.id.clone()),
        text("model", &|r| if r.case.model == Model::Laminar { "laminar" } else { "sst" }.to_owned()),
        text("ended", &|r| r.outcome.status.word().to_owned()),
        text("start_from", &|r| r.outcome.start_from.clone().unwrap_or_else(|| "inflow".to_owned())),
    ];
    let links = |r: &Row| links_of_configuration(&r.case.configuration).map_or(f64::NAN, f64::from);
    if rows.iter().all(|r| links(r).is_finite()) {
        columns.push(number("n_links", "1", Dimension::ONE, &links));
    }
    if rows.iter().all(|r| r.case.flow.pitch_rad == 0.0) {
        columns.push(number("speed", "m/s", Dimension::SPEED, &|r| r.case.flow.speed_m_s));
        columns.push(number("angle", "deg", Dimension::ONE, &|r| r.case.flow.angle_rad));
    } else {
        for (k, name) in ["v_x", "v_y", "v_z"].into_iter().enumerate() {
            columns.push(number(name, "m/s", Dimension::SPEED, &|r| r.case.flow.velocity_m_s()[k]));
        }
    }
    let is_half = rows.iter().all(|r| r.case.is_half);
    let dimension = |load: usize| if load < 3 { Dimension::FORCE } else { Dimension::MOMENT };
    let is_of_wall = rows.iter().any(|r| std_of_wall(&r.case, &r.outcome).iter().any(|std| *std > 0.0));
    let mut of_loads = |prefix: &str, of: &dyn Fn(&Row) -> Option<[f64; 6]>| {
        // What some rows do not have is no column.
        if rows.iter().all(|r| of(r).is_some()) {
            for k in loads_of(is_half) {
                let name = format!("{prefix}{}", LOADS[k]);
                columns.push(number(&name, unit(k), dimension(k), &|r| of(r).map_or(f64::NAN, |loads| loads[k])));
            }
        }
    };
    of_loads("", &|r| Some(r.loads));
    of_loads("correction_", &|r| (!numerical.fine.is_empty()).then(|| numerical.correction(&r.case)));
    of_loads("std_iterative_", &|r| r.outcome.std_iterative);
    of_loads("std_numerical_", &|r| {
        let (mesh, wall) = (numerical.std_of_mesh(&r.case), std_of_wall(&r.case, &r.outcome));
        if mesh.is_none() && !is_of_wall {
            return None;
        }
        let (mesh, iterative) = (mesh.unwrap_or_default(), r.outcome.std_iterative?);
        Some(std::array::from_fn(|k| mesh[k].hypot(iterative[k]).hypot(wall[k])))
    });
    if rows.iter().all(|r| r.outcome.mesh.is_some()) {
        let of = |what: fn(&MeshQuality) -> f64| move |r: &Row| r.outcome.mesh.as_ref().map_or(f64::NAN, what);
        columns.push(number("non_orthogonality", "deg", Dimension::ONE, &of(|m| m.max_non_orthogonality_rad)));
        columns.push(number("skewness", "1", Dimension::ONE, &of(|m| m.max_skewness)));
        columns.push(number("layer_coverage", "1", Dimension::ONE, &of(MeshQuality::area_coverage)));
        if rows.iter().all(|r| r.outcome.mesh.is_some_and(|m| m.layers.is_some())) {
            columns.push(number(
                "layers_requested",
                "1",
                Dimension::ONE,
                &of(|m| m.layers.map_or(f64::NAN, |l| l.requested as f64)),
            ));
            columns.push(number("layers", "1", Dimension::ONE, &of(|m| m.layers.map_or(f64::NAN, |l| l.achieved))));
        }
    }
    if rows.iter().all(|r| r.outcome.y_plus.is_some()) {
        let y_plus = |k: usize| move |r: &Row| r.outcome.y_plus.map_or(f64::NAN, |y| y[k]);
        columns.push(number("y_plus_mean", "1", Dimension::ONE, &y_plus(1)));
        columns.push(number("y_plus_largest", "1", Dimension::ONE, &y_plus(2)));
    }
    columns.push(number("iterations", "1", Dimension::ONE, &|r| r.outcome.iterations as f64));
    let line_of_row = (2..2 + rows.len()).collect();
    Table::of(path.to_owned(), columns, line_of_row)
}

impl Collected {
    /// Flows that lean to a side of a plane of symmetry by more than a hundredth of ½ρU²A.
    pub(super) fn of_one_side(&self) -> Option<String> {
        let seen: Vec<&OneSided> = self.one_sided.iter().filter(|o| o.part.abs() > SEEN && o.load < 3).collect();
        let most = seen.iter().max_by(|a, b| a.part.abs().total_cmp(&b.part.abs()))?;
        Some(format!(
            "{} to one side of a plane of symmetry that the body moves in ({} of {} is {} {}); the mirrored flow is a solution as well, and the loads that change sign with it are set to the mean of both, zero",
            counted(seen.len(), "force leans", "forces lean"),
            LOADS[most.load],
            most.case,
            significant(most.value, 3),
            unit(most.load)
        ))
    }

    /// Largest difference of repeats of one kind: of f_x and f_y, each over ½ρU²A of its case, with how many there are.
    pub(super) fn apart(&self, what: &str) -> Option<([f64; 2], usize)> {
        let own: Vec<&Pair> = self.pairs.iter().filter(|p| p.what == what).collect();
        let of = |k: usize| {
            let part = |p: &&Pair| (p.first.loads[k] - p.second.loads[k]).abs() / p.first.case.load_scales()[k];
            own.iter().map(part).fold(0.0, f64::max)
        };
        (!own.is_empty()).then(|| ([of(0), of(1)], own.len()))
    }

    /// What a page of several sources shows: the table, then each setting that was computed again, then the correction.
    pub(super) fn blocks(&self) -> Vec<Block> {
        let mut said = Vec::new();
        if !self.without.is_empty() {
            let cases = counted(self.without.len(), "case has", "cases have");
            said.push(format!("{cases} no result that counts; froude cfd status says why"));
        }
        let numerical = Section {
            key: "numerical".to_owned(),
            blocks: numerical::blocks(&self.numerical, &self.rows),
            ..Section::default()
        };
        vec![
            self.about().into(),
            self.loads().into(),
            self.without_result().into(),
            self.one_sided_loads().into(),
            Block::text("", said),
            numerical.into(),
        ]
    }

    fn about(&self) -> ResultTable {
        let f = facts("", "", self);
        let mut columns: Vec<ResultColumn> = vec![
            f.text("table", "", |c| c.path.display().to_string()),
            f.flag("is_outdated", "", |c| c.is_outdated),
            f.count("observations", "", |c| c.rows.len()),
        ];
        for (key, what) in [("repeated_from_the_inflow", "from the inflow"), ("laminar_beside_turbulent", "laminar")] {
            let apart = self.apart(what);
            columns.extend([
                f.count(&format!("{key}/cases"), "", |_| apart.map(|(_, n)| n)),
                f.number(&format!("{key}/f_x"), "", |_| apart.map(|([x, _], _)| x)),
                f.number(&format!("{key}/f_y"), "", |_| apart.map(|([_, y], _)| y)),
            ]);
        }
        f.build(columns)
    }

    fn loads(&self) -> ResultTable {
        let is = |status: Status| self.rows.iter().filter(|r| r.outcome.status == status).count();
        let caption = format!(
            "{} ({} converged, {} oscillating) in {}",
            counted(self.rows.len(), "observation", "observations"),
            is(Status::Converged),
            is(Status::Oscillating),
            self.path.display()
        );
        let loads = loads_of(self.rows.iter().all(|r| r.case.is_half));
        let end = |k: usize, of: fn(f64, f64) -> f64, from: f64| self.rows.iter().map(|r| r.loads[k]).fold(from, of);
        let t = TableBuilder::new("loads", caption, &loads);
        t.build(vec![
            t.text("load", "load", |k| LOADS[*k].to_owned()),
            t.number("least", "min", |k| end(*k, f64::min, f64::INFINITY)),
            t.number("largest", "max", |k| end(*k, f64::max, f64::NEG_INFINITY)),
            t.text("unit", "unit", |k| unit(*k).to_owned()),
        ])
    }

    fn without_result(&self) -> ResultTable {
        let t = TableBuilder::new("without", "", &self.without);
        t.build(vec![t.text("case", "", |(id, _)| id.clone()), t.text("reason", "", |(_, why)| why.clone())])
    }

    fn one_sided_loads(&self) -> ResultTable {
        let t = TableBuilder::new("one_sided", "", &self.one_sided);
        t.build(vec![
            t.text("case", "", |o| o.case.clone()),
            t.text("load", "", |o| LOADS[o.load].to_owned()),
            t.number("value", "", |o| o.value),
            t.text("unit", "", |o| unit(o.load).to_owned()),
        ])
    }
}
