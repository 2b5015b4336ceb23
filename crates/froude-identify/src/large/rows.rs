//! Few rows of a long table: those at the ends of its ranges, and a sample of all.

use std::collections::BTreeMap;
use std::rc::Rc;

use froude_records::table::{Column, ColumnData, Table};
use rand::RngExt;
use rand_pcg::Pcg64;

/// A row as it was read.
#[derive(Debug, Clone)]
pub(super) struct Row {
    line: usize,
    cells: Vec<Cell>,
}

#[derive(Debug, Clone)]
enum Cell {
    Number(f64),
    Text(String),
}

impl Row {
    /// Row `i` of a chunk.
    pub(super) fn of(table: &Table, i: usize) -> Rc<Self> {
        let cell = |column: &Column| match &column.data {
            ColumnData::Number { si, .. } => Cell::Number(si[i]),
            ColumnData::Text(texts) => Cell::Text(texts[i].clone()),
        };
        Rc::new(Self { line: table.line_of_row[i], cells: table.columns.iter().map(cell).collect() })
    }

    pub(super) fn line(&self) -> usize {
        self.line
    }
}

/// The rows as a table, in the order of the file and each once; `like` has its columns.
pub(super) fn table_of<'a>(like: &Table, rows: impl IntoIterator<Item = &'a Rc<Row>>) -> Table {
    let rows: BTreeMap<usize, &Row> = rows.into_iter().map(|row| (row.line, row.as_ref())).collect();
    let column = |(j, column): (usize, &Column)| {
        let data = match &column.data {
            ColumnData::Number { unit, dimension, .. } => {
                let number = |row: &&Row| if let Cell::Number(si) = row.cells[j] { si } else { f64::NAN };
                let si = rows.values().map(number).collect();
                ColumnData::Number { unit: unit.clone(), dimension: *dimension, si }
            }
            ColumnData::Text(_) => {
                let text = |row: &&Row| if let Cell::Text(text) = &row.cells[j] { text.clone() } else { String::new() };
                ColumnData::Text(rows.values().map(text).collect())
            }
        };
        Column { name: column.name.clone(), data }
    };
    Table {
        path: like.path.clone(),
        columns: like.columns.iter().enumerate().map(column).collect(),
        n_rows: rows.len(),
        line_of_row: rows.keys().copied().collect(),
        sidecar: like.sidecar.clone(),
        left_out: like.left_out.clone(),
        blank: Vec::new(),
    }
}

/// The columns of a chunk without its rows.
pub(super) fn without_rows(table: &Table) -> Table {
    table_of(table, [])
}

/// The rows at both ends of a number's range.
#[derive(Debug, Clone, Default)]
pub(super) struct Ends {
    least: Option<End>,
    most: Option<End>,
}

/// One end: its value, how many rows have it, the first and the last of them.
#[derive(Debug, Clone)]
pub(super) struct End {
    pub(super) value: f64,
    pub(super) count: usize,
    first: Rc<Row>,
    last: Rc<Row>,
}

impl Ends {
    /// Takes in numbers of a chunk, each with its row there.
    pub(super) fn take(&mut self, numbers: impl Iterator<Item = (usize, f64)>, table: &Table) {
        let mut found: Option<[(f64, usize, usize, usize); 2]> = None;
        for (i, x) in numbers {
            let [least, most] = found.get_or_insert([(x, 0, i, i), (x, 0, i, i)]);
            for (end, sign) in [(least, 1.0), (most, -1.0)] {
                if sign * x < sign * end.0 {
                    *end = (x, 1, i, i);
                } else if x == end.0 {
                    *end = (x, end.1 + 1, end.2, i);
                }
            }
        }
        let Some([least, most]) = found else { return };
        join(&mut self.least, least, table, |new, old| new < old);
        join(&mut self.most, most, table, |new, old| new > old);
    }

    pub(super) fn least(&self) -> Option<&End> {
        self.least.as_ref()
    }

    pub(super) fn most(&self) -> Option<&End> {
        self.most.as_ref()
    }

    /// The largest size.
    pub(super) fn largest(&self) -> f64 {
        [&self.least, &self.most].into_iter().flatten().fold(0.0, |m, end| m.max(end.value.abs()))
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Rc<Row>> {
        [&self.least, &self.most].into_iter().flatten().flat_map(|end| [&end.first, &end.last])
    }
}

fn join(
    end: &mut Option<End>,
    (value, count, first, last): (f64, usize, usize, usize),
    table: &Table,
    is_beyond: fn(f64, f64) -> bool,
) {
    match end {
        Some(end) if end.value == value => {
            end.count += count;
            end.last = Row::of(table, last);
        }
        Some(old) if !is_beyond(value, old.value) => {}
        _ => *end = Some(End { value, count, first: Row::of(table, first), last: Row::of(table, last) }),
    }
}

/// Seed of the sample: the same table gives the same one.
const SEED: u128 = 1;

/// A sample of the rows, each as likely as any other (Vitter 1985, algorithm R).
#[derive(Debug)]
pub(super) struct Sample {
    size: usize,
    seen: usize,
    rows: Vec<Rc<Row>>,
    generator: Pcg64,
}

impl Sample {
    pub(super) fn of(size: usize) -> Self {
        Self { size, seen: 0, rows: Vec::new(), generator: Pcg64::new(SEED, 0) }
    }

    /// Takes in a row of a chunk.
    pub(super) fn take(&mut self, table: &Table, i: usize) {
        self.seen += 1;
        if self.rows.len() < self.size {
            self.rows.push(Row::of(table, i));
            return;
        }
        let place = self.generator.random_range(0..self.seen);
        if let Some(row) = self.rows.get_mut(place) {
            *row = Row::of(table, i);
        }
    }

    pub(super) fn rows(&self) -> &[Rc<Row>] {
        &self.rows
    }
}
