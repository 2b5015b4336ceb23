//! What people and programs read of every verb that returns blocks is the same: each number of a table stands in the JSON at its key, in the SI unit that
//! the key ends in, and rounds to what is shown.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use froude::identify::prediction;
use froude::inspect::inspect;
use froude::pipeline::{self, identify};
use froude::records::block::{Block, Cells, ResultColumn, ResultTable, laid_out};
use froude::records::outcome::Outcome;
use froude::report::write::{write_files, write_folder};
use froude::swim::front::Objective;
use froude::swim::gait::{Envelope, Gait};
use froude::swim::sweep::Axis;
use froude::swim::verb::{Job, Moves, Pitching, Ranges, SweepJob, look, optimise, sweep, swim};
use serde_json::Value;

/// How a key ends whose numbers are shown in a unit.
const ENDS: [(&str, &str); 17] = [
    ("1", ""),
    ("deg", "_rad"),
    ("deg/s", "_rad_s"),
    ("kg", "_kg"),
    ("mm", "_m"),
    ("m", "_m"),
    ("l", "_m3"),
    ("kg m²", "_kg_m2"),
    ("kg/s", "_kg_s"),
    ("kg/m", "_kg_m"),
    ("N m/rad", "_n_m_rad"),
    ("N", "_n"),
    ("N m", "_n_m"),
    ("m/s", "_m_s"),
    ("W", "_w"),
    ("J/m", "_j_m"),
    ("s", "_s"),
];

fn robot(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name).join("robot.toml")
}

/// A value by its path in a document.
fn at<'v>(document: &'v Value, path: &str) -> &'v Value {
    path.split('/')
        .filter(|name| !name.is_empty())
        .fold(document, |value, name| value.get(name).unwrap_or_else(|| panic!("no {name} of {path} in {value}")))
}

fn column_agrees(place: &Value, table: &ResultTable, column: &ResultColumn) {
    let unit = column.unit.as_ref().map(|unit| unit.text.as_str());
    if let (Some(unit), Cells::Number(_) | Cells::Interval(_)) = (unit, &column.cells) {
        let (_, end) = ENDS.iter().find(|(of, _)| *of == unit).unwrap_or_else(|| panic!("{unit} of {}", column.key));
        assert!(column.key.ends_with(end), "{} is shown in {unit}", column.key);
    }
    for row in 0..table.n_rows {
        let object = if table.are_facts { place } else { &place[row] };
        let value = at(object, &column.key);
        match (&column.cells, column.text(row)) {
            (_, None) => {
                assert!(value.is_null() || value.as_array().is_some_and(Vec::is_empty), "{}: {value}", column.key);
            }
            (Cells::Number(all), Some(_)) => assert_eq!(value.as_f64(), Some(all[row]), "{}", column.key),
            (Cells::Count(all), Some(_)) => assert_eq!(value.as_u64(), all[row].map(|n| n as u64), "{}", column.key),
            (Cells::Interval(all), Some(_)) => {
                assert_eq!(value[1].as_f64(), all[row].map(|ends| ends[1]), "{}", column.key);
            }
            (Cells::Text(_), Some(text)) => assert_eq!(value.as_str(), Some(text.as_str()), "{}", column.key),
            (_, Some(_)) => assert!(!value.is_null(), "{}", column.key),
        }
    }
}

/// All numbers of a document.
fn numbers(document: &Value, into: &mut BTreeSet<u64>) {
    match document {
        Value::Number(x) => drop(x.as_f64().map(|x| into.insert(x.to_bits()))),
        Value::Array(all) => all.iter().for_each(|value| numbers(value, into)),
        Value::Object(all) => all.values().for_each(|value| numbers(value, into)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// What has no key is text, or stands in the record; every other cell is in the document.
fn agrees(blocks: &[Block], place: &Value, recorded: &BTreeSet<u64>) {
    let mut items: BTreeMap<&str, usize> = BTreeMap::new();
    for block in blocks {
        match block {
            Block::Table(table) => {
                for column in table.columns.iter().filter(|column| column.key.is_empty()) {
                    let shown = match &column.cells {
                        Cells::Number(all) => all.clone(),
                        Cells::Interval(all) => all.iter().flatten().flatten().copied().collect(),
                        Cells::Text(_) | Cells::Texts(_) => continue,
                        _ => panic!("{} has no key", column.head),
                    };
                    for x in shown.into_iter().filter(|x| x.is_finite()) {
                        assert!(recorded.contains(&x.to_bits()), "{x} of {} is in no record", column.head);
                    }
                }
                let mut keyed = table.columns.iter().filter(|column| !column.key.is_empty()).peekable();
                if keyed.peek().is_some() && (table.n_rows > 0 || table.are_facts) {
                    let place = at(place, &table.key);
                    keyed.for_each(|column| column_agrees(place, table, column));
                }
                if let Some(text) = laid_out(table) {
                    assert!(text.rows.iter().all(|row| row.len() == text.head.len()));
                }
            }
            Block::Text { key, texts } if !key.is_empty() => {
                let said = at(place, key).as_array().unwrap();
                assert!(texts.iter().all(|text| said.iter().any(|said| said == text)), "{key}");
            }
            Block::Section(section) => match section.key.strip_suffix("[]") {
                Some(key) => {
                    let item = items.entry(key).or_default();
                    agrees(&section.blocks, &at(place, key)[*item], recorded);
                    *item += 1;
                }
                None => agrees(&section.blocks, at(place, &section.key), recorded),
            },
            Block::Estimates(estimates) => {
                assert_eq!(at(place, "estimates").as_array().unwrap().len(), estimates.len());
            }
            Block::Text { .. } | Block::Chart(_) | Block::Map(_) | Block::Field(_) => {}
        }
    }
}

fn holds(outcome: &Outcome) {
    let read = |text: String| -> Value { serde_json::from_str(&text).unwrap() };
    let document = read(serde_json::to_string(&outcome.result()).unwrap());
    let mut recorded = BTreeSet::new();
    numbers(&read(serde_json::to_string(&outcome.json()).unwrap()), &mut recorded);
    agrees(&outcome.blocks, &document, &recorded);
    for file in &outcome.files {
        if let Some(path) = document[file.key].as_str() {
            assert_eq!(Some(path), file.path.to_str(), "{}", file.key);
        }
        assert!(file.path.exists(), "{}", file.path.display());
    }
}

fn gait() -> Gait {
    let [amplitude, frequency, phase] = [30_f64, 80.0, 40.0].map(f64::to_radians);
    Gait { amplitude, frequency, phase, turn: 0.0, envelope: Envelope::Lateral }
}

#[test]
fn robots_and_swimmers() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["mamba-swim", "mamba-3d"] {
        let robot = robot(name);
        if !robot.is_file() {
            continue;
        }
        holds(&look(&robot).unwrap());
        let out = folder.path().join(name);
        let job = Job {
            robot,
            moves: Moves::Wave(gait()),
            pitching: Pitching::default(),
            motor: None,
            step_s: None,
            out: Some(out.clone()),
            periods: 1,
            date: None,
            draws: None,
            is_sensitive: name == "mamba-swim",
        };
        let found = swim(&job, &|_, _| {}).unwrap();
        write_folder(&found, &out).unwrap();
        holds(&found);
    }
}

/// What is fitted, compared, predicted, planned and looked at.
#[test]
fn identify_and_what_reads_its_records() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let rows =
        "speed [m/s],f_x [N]\n0.1,-0.05\n0.2,-0.19\n0.3,-0.46\n0.4,-0.79\n0.5,-1.26\n0.6,-1.78\n0.7,-2.47\n0.8,-3.19\n";
    std::fs::write(path("monday.csv"), rows).unwrap();
    std::fs::write(path("tuesday.csv"), rows.replace("-1.26", "-1.24").replace("-0.46", "-0.44")).unwrap();
    for day in ["monday", "tuesday"] {
        let found = identify(&pipeline::Job::new(path(&format!("{day}.csv"))), &|_| {}).unwrap();
        assert_eq!(found.path("result"), Some(&*path(&format!("{day}-results/result.json"))));
        holds(&found.outcome());
    }
    let [monday, tuesday] = ["monday", "tuesday"].map(|day| path(&format!("{day}-results/estimate.json")));
    let records = pipeline::Input::Records(vec![monday.clone(), tuesday]);
    holds(&identify(&pipeline::Job::of(records), &|_| {}).unwrap().outcome());
    let (record, table) = (monday.clone(), path("tuesday.csv"));
    let job = prediction::Job { record, table, sidecar: None, laws: Vec::new(), out: None };
    holds(&prediction::predict(&job).unwrap());
    for file in [monday, path("tuesday.csv")] {
        holds(&inspect(&file, None).unwrap().outcome());
    }
}

#[test]
fn sweeps_and_fronts() {
    let folder = tempfile::tempdir().unwrap();
    let amplitude = Some(Axis { low: 20_f64.to_radians(), high: 30_f64.to_radians(), n: 2 });
    let job = SweepJob {
        robot: robot("mamba-swim"),
        moves: Moves::Wave(gait()),
        ranges: Ranges { amplitude, ..Ranges::default() },
        motor: None,
        step_s: None,
        draws: None,
        out: folder.path().join("out"),
    };
    let objectives = [Objective::Speed, Objective::Power];
    for found in [sweep(&job, &|_, _| {}).unwrap(), optimise(&job, objectives, &|_, _| {}).unwrap()] {
        write_files(&found).unwrap();
        holds(&found);
    }
}
