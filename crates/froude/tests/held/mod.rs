//! What holds for every outcome, and the schema of what each verb prints with `--json`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use froude::records::block::{Block, Cells, ResultColumn, ResultTable, Schema, laid_out};
use froude::records::outcome::Outcome;
use froude::records::schema::RESULTS;
use serde_json::Value;

/// How a key ends whose numbers are shown in a unit that is not the SI unit.
const ENDS: [(&str, &str); 10] = [
    ("1", ""),
    ("%", ""),
    ("deg", "_rad"),
    ("°", "_rad"),
    ("deg/s", "_rad_s"),
    ("mm", "_m"),
    ("mm/s", "_m_s"),
    ("cm/s", "_m_s"),
    ("ms", "_s"),
    ("l", "_m3"),
];

/// `N m/rad` is `_n_m_rad`.
fn end_of(unit: &str) -> String {
    let own = ENDS.iter().find(|(of, _)| *of == unit).map(|(_, end)| (*end).to_owned());
    own.unwrap_or_else(|| {
        let text = unit.to_lowercase().replace('²', "2").replace('³', "3").replace(['(', ')'], "");
        format!("_{}", text.replace(['/', ' '], "_"))
    })
}

/// A value by its path in a document.
fn at<'v>(document: &'v Value, path: &str) -> &'v Value {
    path.split('/')
        .filter(|name| !name.is_empty())
        .fold(document, |value, name| value.get(name).unwrap_or_else(|| panic!("no {name} of {path} in {value}")))
}

fn column_agrees(place: &Value, table: &ResultTable, column: &ResultColumn) {
    let unit = column.unit.as_ref().map(|unit| unit.text.as_str());
    // Loads have the names that tables of observations give them, which are in N and N m.
    let is_load =
        ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"].iter().any(|load| column.key.rsplit('/').next() == Some(load));
    if let (Some(unit), false, Cells::Number(_) | Cells::Interval(_)) = (unit, is_load, &column.cells) {
        let end = end_of(unit);
        assert!(column.key.ends_with(&end), "{} is shown in {unit}", column.key);
    }
    for row in 0..table.n_rows {
        let object = if table.are_facts { place } else { &place[row] };
        let value = at(object, &column.key);
        match (&column.cells, column.text(row)) {
            (_, None) => {
                assert!(
                    value.is_null() || value.as_array().is_some_and(|all| all.iter().all(Value::is_null)),
                    "{}: {value}",
                    column.key
                );
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

/// That the outcome holds, and that its document is of the schema that its blocks give.
pub fn holds(outcome: &Outcome) {
    let read = |text: String| -> Value { serde_json::from_str(&text).unwrap() };
    let document = read(serde_json::to_string(&outcome.result()).unwrap());
    let mut recorded = BTreeSet::new();
    numbers(&read(serde_json::to_string(&outcome.json()).unwrap()), &mut recorded);
    agrees(&outcome.blocks, &document, &recorded);
    let schema = serde_json::to_value(outcome.schema()).unwrap();
    let problem = jsonschema::validator_for(&schema).unwrap().iter_errors(&document).next().map(|e| e.to_string());
    assert_eq!(problem, None, "{document}");
    for file in &outcome.files {
        if let Some(path) = document[file.key].as_str() {
            assert_eq!(Some(path), file.path.to_str(), "{}", file.key);
        }
        assert!(file.path.exists(), "{}", file.path.display());
    }
}

/// That all these hold, and that `froude schema VERB` prints what their blocks give. With `FROUDE_WRITE_SCHEMAS=1` it is written instead.
pub fn of_verb(verb: &str, outcomes: &[&Outcome]) {
    for outcome in outcomes {
        holds(outcome);
    }
    let schema = outcomes.iter().map(|outcome| outcome.schema()).reduce(Schema::or).unwrap();
    let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
    if std::env::var_os("FROUDE_WRITE_SCHEMAS").is_some() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../froude-records/schemas/results");
        std::fs::write(folder.join(format!("{verb}.json")), text).unwrap();
        return;
    }
    let (_, published) = RESULTS.iter().find(|(name, _)| *name == verb).unwrap();
    assert!(
        text == *published,
        "schemas/results/{verb}.json is not what its blocks give; write it with FROUDE_WRITE_SCHEMAS=1 cargo test"
    );
}
