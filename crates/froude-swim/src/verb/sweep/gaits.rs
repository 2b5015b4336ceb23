//! A table of gaits, of a sweep or of a front.

use froude_records::block::{ResultColumn, TableBuilder};

use crate::sweep::{COLUMNS, Row};

/// What people read of a gait, with its head.
const SHOWN: [(&str, &str); 8] = [
    ("amplitude", "amplitude [deg]"),
    ("frequency", "frequency [deg/s]"),
    ("phase", "phase [deg]"),
    ("turn", "turn [deg]"),
    ("speed", "speed [m/s]"),
    ("power_net", "net power [W]"),
    ("cot", "cost [J/m]"),
    ("torque_peak", "torque [N m]"),
];

/// The numbers of gaits: some for people, all of them for programs.
pub(in crate::verb) fn columns<'r, R>(t: &TableBuilder<'r, R>, of: impl Fn(&'r R) -> &'r Row) -> Vec<ResultColumn> {
    let one = |(name, unit): &(&str, &str)| {
        let head = SHOWN.iter().find(|(shown, _)| shown == name).map_or("", |(_, head)| *head);
        let column = t.number(&key(name, unit), head, |row| of(row).get(name));
        if head.ends_with("[deg]") || head.ends_with("[deg/s]") { column.places(2) } else { column }
    };
    COLUMNS.iter().map(one).collect()
}

/// The name of a column of the table in a result: in full, with its unit.
fn key(name: &str, unit: &str) -> String {
    let name = match name {
        "power_pos" => "power_positive",
        "power_abs" => "power_absolute",
        "cot" | "cot_weight" => "cost_of_transport",
        "cot_pos" => "cost_of_transport_positive",
        name => name,
    };
    let unit = unit.to_lowercase().replace([' ', '/'], "_");
    if unit == "1" { name.to_owned() } else { format!("{name}_{unit}") }
}
