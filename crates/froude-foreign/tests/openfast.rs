//! Output of OpenFAST as the program lays it out.
#![allow(clippy::panic, clippy::unwrap_used)]

use froude_foreign::{Cells, openfast};

#[test]
fn a_file_of_openfast_is_read_with_its_names_and_units() {
    let part = openfast::read(include_str!("data/openfast.out")).unwrap();
    let heads: Vec<String> = part.columns.iter().map(|c| format!("{} [{}]", c.name, c.unit)).collect();
    assert_eq!(heads, ["Time [s]", "PtfmSurge [m]", "PtfmTVxi [m/s]", "HydroFxi [kN]"]);
    let Cells::Numbers(time) = &part.columns[0].cells else { panic!("{part:?}") };
    assert_eq!((time.len(), time[11]), (12, 0.55));
}
