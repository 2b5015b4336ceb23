//! Reads the cells of a workbook's first sheet by calamine alone: a peer of `bench/peers/tables.py`.

use calamine::{Data, Reader, open_workbook_auto};

fn main() -> Result<(), calamine::Error> {
    let mut book = open_workbook_auto(std::env::args().nth(1).unwrap_or_default())?;
    let sheet = book.worksheet_range_at(0).ok_or(calamine::Error::Msg("no sheet"))??;
    let sum: f64 =
        sheet.used_cells().filter_map(|(_, _, cell)| if let Data::Float(x) = cell { Some(x) } else { None }).sum();
    println!("{} cells, sum {sum}", sheet.used_cells().count());
    Ok(())
}
