//! A trajectory as a table.

use std::path::Path;

use crate::trajectory::Moment;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};

/// A column in SI.
pub(super) fn column(name: &str, unit: &str, si: Vec<f64>) -> Column {
    // Units are written in this crate, and can be read.
    let unit = parse_unit(unit).unwrap_or_else(|_| Unit::si(Dimension::ONE));
    let dimension = unit.dimension;
    Column { name: name.to_owned(), data: ColumnData::Number { unit, dimension, si } }
}

/// Columns with their units, a row per moment.
pub(super) fn table(moments: &[Moment], is_driven: bool, path: &Path) -> Table {
    let mut columns = Vec::new();
    let mut put = |name: &str, unit: &str, of: &dyn Fn(&Moment) -> f64| {
        columns.push(column(name, unit, moments.iter().map(of).collect()));
    };
    let energy = moments.first().map_or(0.0, |m| m.energy_j);
    put("time", "s", &|m| m.time_s);
    put("x", "m", &|m| m.centre_m[0]);
    put("y", "m", &|m| m.centre_m[1]);
    put("heading", "rad", &|m| m.state.heading);
    put("v_x", "m/s", &|m| m.state.head[1]);
    put("v_y", "m/s", &|m| m.state.head[2]);
    put("w_z", "rad/s", &|m| m.state.head[0]);
    for i in 0..moments.first().map_or(0, |m| m.torque_n_m.len()) {
        put(&format!("phi_{}", i + 1), "rad", &|m| m.shape.angle[i]);
        put(&format!("phi_dot_{}", i + 1), "rad/s", &|m| m.shape.rate[i]);
        put(&format!("tau_{}", i + 1), "N m", &|m| m.torque_n_m[i]);
    }
    put("power_net", "W", &|m| m.power_w[0]);
    put("power_pos", "W", &|m| m.power_w[1]);
    put("power_loss", "W", &|m| m.power_w[2]);
    if is_driven {
        put("power_friction", "W", &|m| m.power_w[3]);
    }
    put("energy_kinetic", "J", &|m| m.energy_j);
    put("energy_residual", "J", &|m| m.state.work_j - m.state.loss_j - m.friction_j - (m.energy_j - energy));
    Table::of(path.to_owned(), columns, (1..=moments.len()).collect())
}
