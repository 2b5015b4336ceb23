//! Blocks as one JSON document.
//!
//! The only place where JSON is made of results. Columns are borrowed, and the rows of a table are written one by one.

use std::path::Path;

use serde::ser::{Serialize, SerializeMap as _, Serializer};

use super::{Block, Cells, ResultColumn, ResultTable};
use crate::estimate::Estimate;
use crate::finding::Finding;
use crate::outcome::{Content, Outcome, names_of_figures};

/// A place in a JSON document: a value, a list where it has items, else an object.
#[derive(Debug, Default)]
pub struct Tree<'a> {
    pub(super) name: &'a str,
    pub(super) value: Option<Value<'a>>,
    pub(super) items: Vec<Self>,
    pub(super) fields: Vec<Self>,
}

/// A value that lies in a block.
#[derive(Debug)]
pub(super) enum Value<'a> {
    /// An object for each row, with the columns of all these tables.
    Rows(Vec<&'a ResultTable>),
    Cell(&'a ResultColumn, usize),
    Number(Option<f64>),
    Texts(Vec<&'a String>),
    Path(&'a Path),
    /// Files of a folder.
    Figures(&'a Path, Vec<String>),
    Findings(&'a [Finding]),
    Estimates(&'a [Estimate]),
}

/// The document of an outcome.
pub(crate) fn tree(outcome: &Outcome) -> Tree<'_> {
    let mut root = Tree::default();
    root.put_all(&outcome.blocks);
    // Beside a record lie files whose folder may be moved; a program finds them by their names.
    for file in outcome.files.iter().filter(|_| outcome.records.is_empty()) {
        match file.content {
            Content::Figures => root.put(file.key, Value::Figures(&file.path, names_of_figures(&outcome.blocks))),
            _ => root.put(file.key, Value::Path(&file.path)),
        }
    }
    if let Some(findings) = &outcome.findings {
        root.put("findings", Value::Findings(findings));
    }
    root
}

impl<'a> Tree<'a> {
    fn put_all(&mut self, blocks: &'a [Block]) {
        for block in blocks {
            match block {
                Block::Text { key, texts } => self.put_texts(key, texts),
                Block::Table(table) if table.are_facts => self.at(&table.key).put_row(table, 0),
                Block::Table(table) => self.put_table(table),
                Block::Section(section) => self.at(&section.key).put_all(&section.blocks),
                Block::Estimates(estimates) => self.put("estimates", Value::Estimates(estimates)),
                Block::Chart(_) | Block::Map(_) | Block::Field(_) => {}
            }
        }
    }

    /// Tables of one key are one list: people read a wide one in parts.
    fn put_table(&mut self, table: &'a ResultTable) {
        if table.key.is_empty() {
            return;
        }
        match &mut self.at(&table.key).value {
            Some(Value::Rows(tables)) => tables.push(table),
            value => *value = Some(Value::Rows(vec![table])),
        }
    }

    /// Texts of one key are one list.
    fn put_texts(&mut self, key: &'a str, texts: &'a [String]) {
        if key.is_empty() {
            return;
        }
        match &mut self.at(key).value {
            Some(Value::Texts(all)) => all.extend(texts),
            value => *value = Some(Value::Texts(texts.iter().collect())),
        }
    }

    pub(super) fn put_row(&mut self, table: &'a ResultTable, row: usize) {
        for column in &table.columns {
            self.put(&column.key, Value::Cell(column, row));
            if let Some((key, all)) = &column.standard {
                self.put(key, Value::Number(all.get(row).copied()));
            }
        }
    }

    /// What has no key is not in JSON.
    fn put(&mut self, key: &'a str, value: Value<'a>) {
        if !key.is_empty() {
            self.at(key).value = Some(value);
        }
    }

    /// The place of a key; `a/b` lies in `a`, and `a[]` is a new item at the end of `a`.
    fn at(&mut self, key: &'a str) -> &mut Self {
        let mut place = self;
        for name in key.split('/').filter(|name| !name.is_empty()) {
            let (name, is_item) = name.strip_suffix("[]").map_or((name, false), |name| (name, true));
            let found = place.fields.iter().position(|field| field.name == name).unwrap_or_else(|| {
                place.fields.push(Self { name, ..Self::default() });
                place.fields.len() - 1
            });
            place = &mut place.fields[found];
            if is_item {
                place.items.push(Self::default());
                let last = place.items.len() - 1;
                place = &mut place.items[last];
            }
        }
        place
    }
}

impl Serialize for Tree<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match &self.value {
            Some(Value::Rows(tables)) => {
                let n_rows = tables.iter().map(|table| table.n_rows).max().unwrap_or(0);
                to.collect_seq((0..n_rows).map(|row| {
                    let mut object = Tree::default();
                    for table in tables {
                        object.put_row(table, row);
                    }
                    object
                }))
            }
            Some(Value::Cell(column, row)) => column.cells.serialize_cell(*row, to),
            Some(Value::Number(x)) => x.filter(|x| x.is_finite()).serialize(to),
            Some(Value::Texts(texts)) => texts.serialize(to),
            Some(Value::Path(path)) => to.collect_str(&path.display()),
            Some(Value::Figures(folder, names)) => {
                to.collect_seq(names.iter().map(|name| folder.join(name).display().to_string()))
            }
            Some(Value::Findings(findings)) => findings.serialize(to),
            Some(Value::Estimates(estimates)) => estimates.serialize(to),
            None if !self.items.is_empty() => self.items.serialize(to),
            None => {
                let mut map = to.serialize_map(Some(self.fields.len()))?;
                for field in &self.fields {
                    map.serialize_entry(field.name, field)?;
                }
                map.end()
            }
        }
    }
}

impl Cells {
    /// What is missing is null, and so is what JSON has no number for.
    fn serialize_cell<S: Serializer>(&self, row: usize, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(all) => all.get(row).filter(|x| x.is_finite()).serialize(to),
            Self::Count(all) => all.get(row).serialize(to),
            Self::Interval(all) => all.get(row).serialize(to),
            Self::Numbers(all) => all.get(row).serialize(to),
            Self::Text(all) => all.get(row).serialize(to),
            Self::Texts(all) => all.get(row).serialize(to),
            Self::Flag(all) => all.get(row).serialize(to),
        }
    }
}
