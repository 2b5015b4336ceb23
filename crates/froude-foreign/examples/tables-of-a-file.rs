//! Prints the tables of a workbook, a MAT file or an HDF5 file, and what took how long:
//! `cargo run --example tables-of-a-file -- FILE [RANGE]`
#![allow(clippy::print_stdout, reason = "a program")]

use std::time::Instant;

use froude_foreign::sheet::{Region, Workbook};
use froude_foreign::{Contents, ForeignError, hdf5, mat5};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("write the name of a file")?;
    let range = arguments.next().map(|range| range.parse::<Region>()).transpose()?;
    let bytes = std::fs::read(&path)?;
    let started = Instant::now();
    if mat5::is_mat5(&bytes) {
        contents(&mat5::read(&bytes)?);
    } else if hdf5::is_hdf5(&bytes) {
        contents(&hdf5::read(bytes)?);
    } else {
        workbook(&bytes, range)?;
    }
    println!("read in {:.3} s", started.elapsed().as_secs_f64());
    Ok(())
}

fn contents(read: &Contents) {
    for part in &read.parts {
        let n = part.columns.first().map_or(0, |column| column.cells.len());
        println!("table {:?}, {n} rows", part.name);
        for column in &part.columns {
            println!("  {} [{}]", column.name, column.unit);
        }
    }
    for out in &read.left_out {
        println!("not read: {} {}", out.name, out.reason);
    }
}

fn workbook(bytes: &[u8], range: Option<Region>) -> Result<(), ForeignError> {
    let mut book = Workbook::open(bytes)?;
    for name in book.sheets().to_vec() {
        let sheet = book.sheet(&name.name, range)?;
        let width = sheet.rows.first().map_or(0, Vec::len);
        println!("sheet {:?}, from {}, {} × {width}", name.name, sheet.cell_name(0, 0), sheet.rows.len());
        for row in sheet.rows.iter().take(4) {
            println!("  {row:?}");
        }
    }
    Ok(())
}
