//! Loads that were not measured in every row: axes tested one at a time in one table, and readings at rest.
//!
//! A row says nothing of a load that was not recorded there; counted as an observation it would narrow every interval of that load. There are three cases:
//!
//! - a load whose cell is empty; the cell of the motion along or about its axis may also be empty, which means no motion;
//! - a load that is exactly 0 in every row in which its own axis does not move and another one does: a measured load is never exactly that. Such rows are not observations of that load, under any law;
//! - rows in which every law predicts zero for any coefficients (at rest, for example) and whose loads scatter less than the others (F, 1 % over the loads; classical fits without weights only).
//!   They determine no coefficient and are left out of σ.

use std::collections::BTreeSet;

use froude_fit::distribution::f_upper;
use froude_records::RecordError;
use froude_records::finding::{Finding, Severity};
use froude_records::table::Table;
use froude_records::text::counted;

use crate::dataset::Dataset;
use crate::regression::{ModelFit, Scatter};

/// Chance of leaving out rows that scatter like the others, over all loads.
const LEVEL: f64 = 0.01;

/// Motions that make a load; where none of them is there, its axis is idle.
const MAKE: [(&str, &[&str]); 6] = [
    ("f_x", &["v_x"]),
    ("f_y", &["v_y", "w_z"]),
    ("f_z", &["v_z", "w_y"]),
    ("m_x", &["w_x", "v_y"]),
    ("m_y", &["w_y", "v_z"]),
    ("m_z", &["w_z", "v_y"]),
];

/// The rows in which a load was recorded.
///
/// # Errors
///
/// An empty cell of a motion beside a load of its axis, and a row without any load.
pub(crate) fn of_blanks(table: &Table, data: &mut Dataset) -> Result<(), RecordError> {
    let blank: BTreeSet<(&str, usize)> = table.blank.iter().map(|(name, row)| (name.as_str(), *row)).collect();
    let is_blank = |name: &str, row: usize| blank.contains(&(name, row));
    let loads = data.loads();
    for (name, row) in &table.blank {
        let has_load = |load: &str| loads.contains(&load) && !is_blank(load, *row);
        let of_axis = MAKE.iter().any(|(load, motions)| motions.contains(&name.as_str()) && has_load(load));
        let has_none = !loads.iter().any(|load| has_load(load));
        if of_axis || has_none {
            let advice = if has_none {
                "fill it in or delete the row"
            } else {
                "fill it in; only a load that was not measured, and the motion along its axis, may be left empty"
            };
            return Err(RecordError::empty_cell(table.place_of_row(*row), data.header(name), advice));
        }
        if loads.contains(&name.as_str()) {
            data.observed.entry(name.clone()).or_insert_with(|| vec![true; table.n_rows])[*row] = false;
        }
    }
    Ok(())
}

/// Marks loads that are exactly 0 in every row in which their axis is idle beside another one that moves.
pub(crate) fn mark(data: &mut Dataset) -> Vec<Finding> {
    let mut out = Vec::new();
    let moves = |name: &str, i: usize| data.values(name).is_some_and(|v| v[i] != 0.0);
    let motions = ["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"];
    let mut observed = data.observed.clone();
    for load in data.loads() {
        let (Some(f), Some((_, own))) = (data.values(load), MAKE.iter().find(|(of, _)| *of == load)) else { continue };
        let makes = |i: usize| own.iter().any(|m| moves(m, i) || moves(&format!("{m}_dot"), i));
        let is_idle = |i: usize| !makes(i) && motions.iter().any(|m| moves(m, i));
        let idle: Vec<usize> = (0..data.rows).filter(|&i| data.observes(load, i) && is_idle(i)).collect();
        let is_measured = |i: usize| f[i] != 0.0 && makes(i);
        if idle.is_empty() || idle.iter().any(|&i| f[i] != 0.0) || !(0..data.rows).any(is_measured) {
            continue;
        }
        let of_load = observed.entry(load.to_owned()).or_insert_with(|| vec![true; data.rows]);
        for i in idle {
            of_load[i] = false;
        }
    }
    for (load, is) in &observed {
        let left = is.iter().filter(|is| !**is).count();
        if left > 0 {
            let text = format!(
                "{load}: not measured in {} (cell empty, or exactly 0 while only other axes move); not used for this load",
                counted(left, "row", "rows")
            );
            out.push(Finding::new(Severity::Note, "load-not-measured", text));
        }
    }
    data.observed = observed;
    out
}

/// Rows that scatter less than the others and determine nothing, by load; marks them.
pub(crate) fn mark_quiet(models: &[&ModelFit], data: &mut Dataset) -> Vec<Finding> {
    if models.iter().any(|m| m.scatter != Scatter::Classical || m.is_weighted() || m.in_variables) {
        return Vec::new();
    }
    let mut out = Vec::new();
    let loads = data.loads();
    for load in &loads {
        let of_load = models.iter().filter_map(|m| Some((*m, m.law.responses.iter().position(|r| r == load)?)));
        let of_load: Vec<(&ModelFit, usize)> = of_load.collect();
        let n = data.rows;
        let is_zero = |(m, r): &(&ModelFit, usize), i: usize| {
            let row = m.problem.design.row(r * n + i);
            m.problem.response.len() == m.law.responses.len() * n && row.iter().all(|x| *x == 0.0)
        };
        let quiet: Vec<usize> = (0..n)
            .filter(|&i| data.observes(load, i) && !of_load.is_empty() && of_load.iter().all(|m| is_zero(m, i)))
            .collect();
        let Some(f) = data.values(load) else { continue };
        let k = quiet.len() as f64;
        let own = quiet.iter().map(|&i| f[i] * f[i]).sum::<f64>();
        let others = of_load.iter().filter_map(|(m, r)| {
            let component = m.fit.components.get(*r)?;
            let (left, dof) = (component.rss - own, component.dof - k);
            (dof >= 1.0 && left > 0.0 && !m.law.in_logarithms()).then_some((left / dof, dof))
        });
        let Some((variance, dof)) = others.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let p = 1.0 - f_upper(own / k / variance, k, dof);
        if quiet.is_empty() || p >= LEVEL / loads.len() as f64 {
            continue;
        }
        let text = format!(
            "{load}: {} in which every law predicts zero (at rest, for example) {} less than the others and {} left out of σ",
            counted(quiet.len(), "row", "rows"),
            if quiet.len() == 1 { "scatters" } else { "scatter" },
            if quiet.len() == 1 { "is" } else { "are" },
        );
        out.push((*load, quiet, Finding::new(Severity::Note, "quiet-rows", text)));
    }
    for (load, quiet, _) in &out {
        let is = data.observed.entry((*load).to_owned()).or_insert_with(|| vec![true; data.rows]);
        for &i in quiet {
            is[i] = false;
        }
    }
    out.into_iter().map(|(_, _, finding)| finding).collect()
}
