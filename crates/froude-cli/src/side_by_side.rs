//! Estimates side by side, as a person reads them.

use comfy_table::{LineStyle, Table};
use froude::records::comparison::{
    CoefficientComparison, Comparison, JointComparison, LoadComparison, Side, coverage_note,
};
use froude::records::number;
use froude::records::text::counted;
use froude::report::verdict::verdict_words;

use crate::cells::{cell, right, sentence, table};
use crate::out::say;

/// Widest table; a wider one is wrapped or printed in blocks.
const MOST_CHARACTERS: u16 = 118;
/// Widest head of a force column; a longer name is wrapped.
const MOST_OF_A_HEAD: usize = 28;

/// A table of a comparison, never wider than [`MOST_CHARACTERS`] or the terminal.
fn narrow(header: &[String]) -> Table {
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let mut out = table(&header);
    out.load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    out.set_width(out.width().map_or(MOST_CHARACTERS, |w| w.min(MOST_CHARACTERS)));
    out
}

/// Value and expanded uncertainty, digits after the uncertainty; the value alone where none is stated.
fn value_and_uncertainty(s: &Side) -> String {
    match (s.value, s.expanded_uncertainty) {
        (Some(value), Some(u)) => number::plus_minus(value, u),
        (Some(value), None) => number::plain(value, 5),
        (None, _) => number::MISSING.to_owned(),
    }
}

fn normalised(e_n: Option<f64>) -> String {
    e_n.map_or_else(|| number::MISSING.to_owned(), |e| number::fixed(e, 2))
}

/// Reasons in the order of appearance, each once.
fn reasons<'a>(notes: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut out: Vec<&str> = Vec::new();
    for reason in notes.filter(|note| !note.is_empty()) {
        if !out.contains(&reason) {
            out.push(reason);
        }
    }
    out
}

/// Sources side by side.
pub fn comparison(c: &Comparison, all: bool) {
    verdicts(c);
    let predicted = c.load_sources();
    let recommended = |side: &Side| predicted.contains(&side.source.as_str());
    let is_shown = |r: &CoefficientComparison| {
        all || c.coefficients.len() <= 40 || (recommended(&r.first) && recommended(&r.second))
    };
    let (shown, hidden): (Vec<_>, Vec<_>) = c.coefficients.iter().partition(|r| is_shown(r));
    for pair in shown.chunk_by(|a, b| sources(a) == sources(b)) {
        coefficient_pair(pair);
        let own = |j: &&JointComparison| pair.iter().any(|r| sources(r) == [&j.first, &j.second]);
        for j in c.joint.iter().filter(own) {
            match (j.chi_squared, j.dof, j.p) {
                (Some(chi2), Some(dof), Some(p)) => say!(
                    "  jointly: χ² = {} with {}, p {}{}",
                    number::significant(chi2, 3),
                    number::degrees_of_freedom(dof as f64),
                    if p < 0.001 { "" } else { "= " },
                    number::p_value(p)
                ),
                // A missing uncertainty has been named with the missing E_n.
                _ if pair.iter().any(|r| r.note == j.note) => {}
                _ => say!("  no joint χ²: {}", j.note),
            }
        }
    }
    if !hidden.is_empty() {
        let further = counted(hidden.len(), "further pair of coefficients", "further pairs of coefficients");
        say!("\n{further}; --all prints {}", if hidden.len() == 1 { "it" } else { "them" });
    }
    if !c.loads.is_empty() {
        forces(c);
    }
}

fn sources(r: &CoefficientComparison) -> [&String; 2] {
    [&r.first.source, &r.second.source]
}

/// Whether the estimates agree, a line per pair.
pub fn verdicts(c: &Comparison) {
    for verdict in &c.verdicts {
        sentence(&verdict_words(verdict));
    }
}

/// The coefficients that two estimates share, a column each.
fn coefficient_pair(rows: &[&CoefficientComparison]) {
    let Some(one) = rows.first() else { return };
    let has_e_n = rows.iter().any(|r| r.e_n.is_some());
    let [one_id, other_id] = sources(one);
    say!("\nModel {}", one.model);
    let (first, second) = if one_id == other_id {
        (format!("1: {one_id}"), format!("2: {other_id}"))
    } else {
        (one_id.clone(), other_id.clone())
    };
    let is_stated = rows.iter().any(|r| [&r.first, &r.second].iter().any(|s| s.standard_uncertainty.is_some()));
    let head = |id: String| if is_stated { format!("{id}, ± U") } else { id };
    let mut header = vec!["coefficient".to_owned(), "unit".to_owned(), head(first), head(second)];
    if has_e_n {
        header.push("E_n".to_owned());
    }
    let mut out = narrow(&header);
    for r in rows {
        let mut row = vec![
            cell(
                r.label.as_ref().map_or_else(|| r.coefficient.clone(), |label| format!("{} ({label})", r.coefficient)),
            ),
            cell(&r.unit),
            right(value_and_uncertainty(&r.first)),
            right(value_and_uncertainty(&r.second)),
        ];
        if has_e_n {
            row.push(right(normalised(r.e_n)));
        }
        out.add_row(row);
    }
    say!("{out}");
    if is_stated {
        say!(
            "  ± U: expanded uncertainty, 95 %, U = k·u; of an asymmetric interval, E_n takes the side of the other value"
        );
        say!("    {}", coverage_note(one_id, rows.iter().map(|r| &r.first)));
        if one_id != other_id {
            say!("    {}", coverage_note(other_id, rows.iter().map(|r| &r.second)));
        }
    }
    for why in reasons(rows.iter().map(|r| r.note.as_str())) {
        say!("  no E_n: {why}");
    }
}

/// A column of predicted loads or of E_n: its head, and a cell for each place.
type Column = (String, Vec<String>);

/// Predicted loads: a column per estimate, in blocks that fit beside each other.
fn forces(c: &Comparison) {
    let has_links = c.loads.iter().any(|r| r.n_links.is_some());
    // Forces and moments in one table: each row says its unit.
    let is_one_unit = c.loads.iter().all(|r| r.unit == c.loads[0].unit);
    say!("\nPredicted {} over the common range", if is_one_unit { "force" } else { "forces and moments" });
    let mut place = vec!["load".to_owned()];
    if has_links {
        place.push("links".to_owned());
    }
    place.extend(["speed [m/s]".to_owned(), "angle [deg]".to_owned()]);
    let at = |r: &LoadComparison| {
        let mut row =
            vec![if is_one_unit { cell(&r.component) } else { cell(format!("{} [{}]", r.component, r.unit)) }];
        if has_links {
            row.push(right(r.n_links.map_or_else(String::new, |k| format!("{k}"))));
        }
        row.push(right(format!("{:.3}", r.speed_m_s)));
        row.push(right(format!("{:.1}", r.angle_rad.to_degrees())));
        row
    };
    let ids = c.load_sources();
    let Some((first, others)) = ids.split_first() else { return };
    let rows_of = |id: &str| c.loads.iter().filter(|r| r.second.source == id).collect::<Vec<_>>();
    // Every other estimate has a row for each place, in one order.
    let places = rows_of(others[0]);
    let unit = if is_one_unit { format!(" [{}]", c.loads[0].unit) } else { String::new() };
    let mut columns = vec![vec![loads(first, &unit, places.iter().map(|r| &r.first))]];
    for id in others {
        let rows = rows_of(id);
        let mut own = vec![loads(id, &unit, rows.iter().map(|r| &r.second))];
        if rows.iter().any(|r| r.e_n.is_some()) {
            own.push(("E_n".to_owned(), rows.iter().map(|r| normalised(r.e_n)).collect()));
        }
        columns.push(own);
    }
    for block in blocks(&columns, usize::from(MOST_CHARACTERS) - place.iter().map(|p| p.len() + 2).sum::<usize>()) {
        let mut header = place.clone();
        header.extend(block.iter().map(|(head, _)| head.clone()));
        let mut out = narrow(&header);
        for (i, r) in places.iter().enumerate() {
            let mut row = at(r);
            row.extend(block.iter().map(|(_, cells)| right(cells[i].clone())));
            out.add_row(row);
        }
        say!("{out}");
    }
    if c.loads.iter().any(|r| [&r.first, &r.second].iter().any(|side| side.standard_uncertainty.is_some())) {
        say!(
            "  ± U: expanded uncertainty, 95 %, U = k·u; of an asymmetric interval, E_n takes the side of the other value"
        );
    }
    for note in &c.coverage {
        say!("    {note}");
    }
    for id in others {
        // A missing uncertainty has just been named.
        let notes = reasons(rows_of(id).into_iter().map(|r| r.note.as_str()));
        for why in notes.into_iter().filter(|why| !why.starts_with("no uncertainty stated")) {
            say!("  no E_n of {id} against {first}: {why}");
        }
    }
}

/// Columns, those of one estimate together, in blocks that fit into `room`.
fn blocks(columns: &[Vec<Column>], room: usize) -> Vec<Vec<&Column>> {
    let width = |(head, cells): &Column| {
        let cell = cells.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        cell.max(head.chars().count().min(MOST_OF_A_HEAD)) + 2
    };
    let mut out: Vec<Vec<&Column>> = Vec::new();
    let mut left = 0;
    for own in columns {
        let wanted: usize = own.iter().map(width).sum();
        if out.is_empty() || wanted > left {
            out.push(Vec::new());
            left = room;
        }
        left = left.saturating_sub(wanted);
        if let Some(block) = out.last_mut() {
            block.extend(own);
        }
    }
    out
}

/// Head and cells of an estimate's loads; `unit` is that of all rows, or empty.
fn loads<'a>(id: &str, unit: &str, sides: impl Iterator<Item = &'a Side>) -> Column {
    let sides: Vec<&Side> = sides.collect();
    let is_stated = sides.iter().any(|side| side.standard_uncertainty.is_some());
    let head = if is_stated { format!("{id} ± U{unit}") } else { format!("{id}{unit}") };
    let cells = sides.iter().map(|side| match side.value {
        Some(force) if side.standard_uncertainty.is_none() => number::fixed(force, 4),
        _ => value_and_uncertainty(side),
    });
    (head, cells.collect())
}
