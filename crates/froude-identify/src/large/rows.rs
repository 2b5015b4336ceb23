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
        understood: like.understood.clone(),
        blank: Vec::new(),
        joined: like.joined.clone(),
    }
}

/// The columns of a chunk without its rows.
pub(super) fn without_rows(table: &Table) -> Table {
    table_of(table, [])
}

/// The rows at both ends of a number's range.
#[derive(Debug, Clone, Default)]
pub(super) struct Ends(Option<[End; 2]>);

/// One end: its value, and the first and the last row that have it.
#[derive(Debug, Clone)]
struct End {
    value: f64,
    rows: [Rc<Row>; 2],
}

impl Ends {
    /// Takes in numbers of a chunk, each with its row there.
    pub(super) fn take(&mut self, numbers: impl Iterator<Item = (usize, f64)>, table: &Table) {
        let mut found: Option<[(f64, usize, usize); 2]> = None;
        for (i, x) in numbers.filter(|(_, x)| !x.is_nan()) {
            for (end, sign) in found.get_or_insert([(x, i, i); 2]).iter_mut().zip([1.0, -1.0]) {
                if sign * x < sign * end.0 {
                    *end = (x, i, i);
                } else if x == end.0 {
                    end.2 = i;
                }
            }
        }
        let Some(found) = found else { return };
        let of = |(value, first, last)| End { value, rows: [first, last].map(|i| Row::of(table, i)) };
        let Some(ends) = &mut self.0 else {
            self.0 = Some(found.map(of));
            return;
        };
        for ((end, new), sign) in ends.iter_mut().zip(found).zip([1.0, -1.0]) {
            if new.0 == end.value {
                end.rows[1] = Row::of(table, new.2);
            } else if sign * new.0 < sign * end.value {
                *end = of(new);
            }
        }
    }

    /// The smallest and the largest value; zero before any.
    pub(super) fn range(&self) -> [f64; 2] {
        self.0.as_ref().map_or([0.0; 2], |ends| ends.each_ref().map(|end| end.value))
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = &Rc<Row>> {
        self.0.iter().flatten().flat_map(|end| &end.rows)
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
