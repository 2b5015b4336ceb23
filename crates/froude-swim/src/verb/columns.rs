//! A trajectory as a table.

use std::path::Path;

use crate::trajectory::Moment;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};

/// Columns with their units, a row per moment.
pub(super) fn table(moments: &[Moment], is_driven: bool, path: &Path) -> Table {
    let mut columns = Vec::new();
    // The units are written below.
    let mut put = |name: String, unit: &str, si: Vec<f64>| {
        let unit = parse_unit(unit).unwrap_or_else(|_| Unit::si(Dimension::ONE));
        let dimension = unit.dimension;
        columns.push(Column { name, data: ColumnData::Number { unit, dimension, si } });
    };
    let all = |of: &dyn Fn(&Moment) -> f64| moments.iter().map(of).collect::<Vec<f64>>();
    let energy = moments.first().map_or(0.0, |m| m.energy_j);
    put("time".to_owned(), "s", all(&|m| m.time_s));
    put("x".to_owned(), "m", all(&|m| m.centre_m[0]));
    put("y".to_owned(), "m", all(&|m| m.centre_m[1]));
    put("heading".to_owned(), "rad", all(&|m| m.state.heading));
    put("v_x".to_owned(), "m/s", all(&|m| m.state.head[1]));
    put("v_y".to_owned(), "m/s", all(&|m| m.state.head[2]));
    put("w_z".to_owned(), "rad/s", all(&|m| m.state.head[0]));
    for i in 0..moments.first().map_or(0, |m| m.torque_n_m.len()) {
        put(format!("phi_{}", i + 1), "rad", all(&|m| m.shape.angle[i]));
        put(format!("phi_dot_{}", i + 1), "rad/s", all(&|m| m.shape.rate[i]));
        put(format!("tau_{}", i + 1), "N m", all(&|m| m.torque_n_m[i]));
    }
    put("power_net".to_owned(), "W", all(&|m| m.power_w[0]));
    put("power_pos".to_owned(), "W", all(&|m| m.power_w[1]));
    put("power_loss".to_owned(), "W", all(&|m| m.power_w[2]));
    if is_driven {
        put("power_friction".to_owned(), "W", all(&|m| m.power_w[3]));
    }
    put("energy_kinetic".to_owned(), "J", all(&|m| m.energy_j));
    put(
        "energy_residual".to_owned(),
        "J",
        all(&|m| m.state.work_j - m.state.loss_j - m.friction_j - (m.energy_j - energy)),
    );
    Table::of(path.to_owned(), columns, (1..=moments.len()).collect())
}
