//! The tables of an outcome as CSV, for spreadsheets: a column for each key, in SI units at full precision.
//!
//! Where there are several tables, each stands below a line with its name, with a blank line before the next.

use froude_records::block::{Block, Cells, LaidOut, ResultColumn, ResultTable, TableBuilder, laid_out};
use froude_records::csv_table::quoted;
use froude_records::estimate::{Coefficient, Estimate, EstimateFile};
use froude_records::guard::guarded;
use froude_records::outcome::Outcome;

/// The coefficients of its records, and every table that a program can read, in order; where there is none, the tables as people see them.
#[must_use]
pub fn tables(outcome: &Outcome) -> String {
    let mut all = Vec::new();
    if !outcome.records.is_empty() {
        gather(&[coefficients(&outcome.records).into()], "", &mut all);
    }
    gather(&outcome.blocks, "", &mut all);
    if all.is_empty() {
        gather_shown(&outcome.blocks, &mut all);
    }
    match &all[..] {
        [(_, one)] => one.clone(),
        several => several.iter().map(|(name, table)| format!("{name}\n{table}")).collect::<Vec<_>>().join("\n"),
    }
}

fn coefficients(records: &[EstimateFile]) -> ResultTable {
    let mut rows: Vec<(&Estimate, &String, &Coefficient)> = Vec::new();
    for estimate in records.iter().flat_map(|file| &file.estimates) {
        rows.extend(estimate.coefficients.iter().map(|(name, c)| (estimate, name, c)));
    }
    let t = TableBuilder::new("coefficients", "", &rows);
    t.build(vec![
        t.text("estimate", "", |(estimate, ..)| estimate.id.clone()),
        t.flag("recommended", "", |(estimate, ..)| estimate.recommended),
        t.text("coefficient", "", |(_, name, _)| (*name).clone()),
        t.text("unit", "", |(.., c)| c.unit.clone()),
        t.number("value", "", |(.., c)| c.value),
        t.number("standard_uncertainty", "", |(.., c)| c.standard_uncertainty),
        t.interval("interval_95", "", |(.., c)| c.interval_95),
        t.interval("range_95", "", |(.., c)| c.range_95),
    ])
}

fn gather(blocks: &[Block], place: &str, all: &mut Vec<(String, String)>) {
    for block in blocks {
        match block {
            Block::Table(table) if table.n_rows > 0 && table.columns.iter().any(|column| !column.key.is_empty()) => {
                all.push((named(place, &table.key), written(table)));
            }
            Block::Section(section) => gather(&section.blocks, &named(place, &section.key), all),
            _ => {}
        }
    }
}

fn gather_shown(blocks: &[Block], all: &mut Vec<(String, String)>) {
    for block in blocks {
        match block {
            Block::Table(table) => {
                let lines =
                    |shown: LaidOut| (shown.caption, std::iter::once(shown.head).chain(shown.rows).map(line).collect());
                all.extend(laid_out(table).map(lines));
            }
            Block::Section(section) => gather_shown(&section.blocks, all),
            _ => {}
        }
    }
}

fn line(cells: Vec<String>) -> String {
    format!("{}\n", cells.into_iter().map(|cell| quoted(guarded(cell))).collect::<Vec<_>>().join(","))
}

fn named(place: &str, key: &str) -> String {
    [place, key].into_iter().filter(|name| !name.is_empty()).collect::<Vec<_>>().join("/")
}

fn written(table: &ResultTable) -> String {
    let columns: Vec<_> =
        table.columns.iter().filter(|column| !column.key.is_empty()).flat_map(written_columns).collect();
    let line = |cells: Vec<String>| format!("{}\n", cells.join(","));
    let head = line(columns.iter().map(|(key, _)| key.clone()).collect());
    let row = |row: usize| line(columns.iter().map(|(_, cells)| cells.get(row).cloned().unwrap_or_default()).collect());
    head + &(0..table.n_rows).map(row).collect::<String>()
}

/// A column; of an interval one for each end, and the standard uncertainties behind their numbers.
fn written_columns(column: &ResultColumn) -> Vec<(String, Vec<String>)> {
    let key = &column.key;
    let text = |text: &String| quoted(guarded(text.clone()));
    let cells: Vec<String> = match &column.cells {
        Cells::Number(all) => all.iter().map(|x| number(*x)).collect(),
        Cells::Count(all) => all.iter().map(|n| n.map_or_else(String::new, |n| n.to_string())).collect(),
        Cells::Flag(all) => all.iter().map(|is| is.map_or_else(String::new, |is| is.to_string())).collect(),
        Cells::Text(all) => all.iter().map(|words| words.as_ref().map_or_else(String::new, text)).collect(),
        Cells::Texts(all) => all.iter().map(|words| text(&words.join("; "))).collect(),
        Cells::Numbers(all) => {
            let joined = |all: &Vec<f64>| all.iter().map(|x| number(*x)).collect::<Vec<_>>().join("; ");
            all.iter().map(|all| all.as_ref().map_or_else(String::new, joined)).collect()
        }
        Cells::Interval(all) => {
            let end = |i: usize| all.iter().map(|ends| ends.map_or_else(String::new, |ends| number(ends[i]))).collect();
            return vec![(format!("{key}_low"), end(0)), (format!("{key}_high"), end(1))];
        }
    };
    let standard = column.standard.as_ref().map(|(key, all)| (key.clone(), all.iter().map(|x| number(*x)).collect()));
    std::iter::once((key.clone(), cells)).chain(standard).collect()
}

fn number(x: f64) -> String {
    if x.is_finite() { x.to_string() } else { String::new() }
}

#[cfg(test)]
mod tests {
    use froude_records::block::{Section, TableBuilder};

    use super::*;

    #[test]
    fn a_table_has_a_column_for_each_key_in_si_and_what_is_missing_is_empty() {
        let rows = [(0.1 + 0.2, Some([1.0, 2.0]), "a, \"b\""), (f64::NAN, None, "=1+1")];
        let t = TableBuilder::new("runs", "Runs", &rows);
        let table = t.build(vec![
            t.number("angle_rad", "angle [deg]", |row| row.0),
            t.interval("load_n", "load [N]", |row| row.1),
            t.text("name", "name", |row| row.2.to_owned()),
            t.text("", "for people", |row| row.2.to_owned()),
        ]);
        let one = "angle_rad,load_n_low,load_n_high,name\n0.30000000000000004,1,2,\"a, \"\"b\"\"\"\n,,,'=1+1\n";
        let read = |blocks: Vec<Block>| tables(&Outcome { blocks, ..Outcome::default() });
        assert_eq!(read(vec![table.clone().into()]), one);
        let section = Section::new("", vec![Block::Table(table.clone())]);
        let section = Section { key: "draws".to_owned(), ..section };
        let both = vec![Block::Table(table), Block::Section(section)];
        assert_eq!(read(both), format!("runs\n{one}\ndraws/runs\n{one}"));
    }
}
