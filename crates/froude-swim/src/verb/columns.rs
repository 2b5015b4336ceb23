//! A trajectory as a table.

use std::path::Path;

use crate::dynamics::Dynamics;
use crate::state::Energy;
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
pub(super) fn table<C: Dynamics>(moments: &[Moment<C>], is_driven: bool, path: &Path) -> Table {
    let mut columns = Vec::new();
    let mut put = |name: &str, unit: &str, of: &dyn Fn(&Moment<C>) -> f64| {
        columns.push(column(name, unit, moments.iter().map(of).collect()));
    };
    // What the plane has of three dimensions.
    let level = |names: [&'static str; 3], plane: usize| {
        let all = names.into_iter().enumerate();
        all.filter(move |(k, _)| C::TILTS || if plane == 1 { *k == 2 } else { *k < plane })
    };
    put("time", "s", &|m| m.time_s);
    for (k, name) in level(["x", "y", "z"], 2) {
        put(name, "m", &|m| m.centre_m[k]);
    }
    for (k, name) in level(["roll", "pitch", "heading"], 1) {
        put(name, "rad", &|m| C::angles(&m.state.pose)[k]);
    }
    if C::TILTS {
        for (k, name) in ["q_w", "q_x", "q_y", "q_z"].into_iter().enumerate() {
            put(name, "1", &|m| m.state.pose.as_ref()[3 + k]);
        }
    }
    for (k, name) in level(["v_x", "v_y", "v_z"], 2) {
        put(name, "m/s", &|m| C::six(&m.state.head)[3 + k]);
    }
    for (k, name) in level(["w_x", "w_y", "w_z"], 1) {
        put(name, "rad/s", &|m| C::six(&m.state.head)[k]);
    }
    for i in 0..moments.first().map_or(0, |m| m.torque_n_m.len()) {
        put(&format!("phi_{}", i + 1), "rad", &|m| m.shape.angle[i]);
        put(&format!("phi_dot_{}", i + 1), "rad/s", &|m| m.shape.rate[i]);
        put(&format!("tau_{}", i + 1), "N m", &|m| m.torque_n_m[i]);
    }
    let powers = ["power_net", "power_pos", "power_loss", "power_friction"].into_iter().enumerate();
    for (k, name) in powers.take(if is_driven { 4 } else { 3 }) {
        put(name, "W", &|m| m.power_w[k]);
    }
    let all = |m: &Moment<C>| m.energy_j[0] + m.energy_j[1];
    let (first, lowest) = moments.first().map_or((0.0, 0.0), |m| (all(m), m.energy_j[1]));
    put("energy_kinetic", "J", &|m| m.energy_j[0]);
    if C::TILTS {
        put("energy_potential", "J", &|m| m.energy_j[1] - lowest);
    }
    let given = |m: &Moment<C>| {
        let [work, loss, friction] = [Energy::Work, Energy::Loss, Energy::Friction].map(|of| m.state.energy(of));
        work - loss - friction
    };
    put("energy_residual", "J", &|m| given(m) - (all(m) - first));
    Table::of(path.to_owned(), columns, (1..=moments.len()).collect())
}
