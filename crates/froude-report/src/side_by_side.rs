//! Estimates side by side: coefficients, whole vectors, predicted loads. The numbers are those of the record.

use std::collections::BTreeMap;

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::comparison::{
    CoefficientComparison, Comparison, JointComparison, LoadComparison, Side, coverage_note,
};
use froude_records::number::{self, MISSING};
use froude_records::text::counted;

use crate::tables::distinct;

/// Most rows of coefficients that are shown, whichever they are; of more, those of the recommended laws.
const MOST_ROWS: usize = 40;
/// Most places with predicted loads; of more, the ends and the middle of speed and angle.
const MOST_PLACES: usize = 36;
/// What U is.
const EXPANDED: &str = "± U: expanded uncertainty, 95 %, U = k·u; E_n = (first − second)/U of the difference; of an asymmetric interval, E_n takes the side of the other value.";

/// A comparison; what only some readers ask for are details.
#[must_use]
pub fn blocks(c: &Comparison) -> Vec<Block> {
    let predicted = c.load_sources();
    let is_predicted = |side: &Side| predicted.contains(&side.source.as_str());
    let is_shown = |pair: &&[CoefficientComparison]| {
        c.coefficients.len() <= MOST_ROWS || is_predicted(&pair[0].first) && is_predicted(&pair[0].second)
    };
    let of_pair = |r: &CoefficientComparison| [r.model.clone(), r.first.source.clone(), r.second.source.clone()];
    let (shown, further): (Vec<_>, Vec<_>) =
        c.coefficients.chunk_by(|a, b| of_pair(a) == of_pair(b)).partition(is_shown);
    let joint = c.joint.iter().map(|j| ([j.model.as_str(), &j.first, &j.second], j)).collect();
    let mut out: Vec<Block> = shown.into_iter().flat_map(|pair| coefficients(&joint, pair)).collect();
    if !further.is_empty() {
        let n = further.iter().map(|pair| pair.len()).sum();
        let title = counted(n, "further pair of coefficients", "further pairs of coefficients");
        let blocks = further.into_iter().flat_map(|pair| coefficients(&joint, pair));
        out.push(Block::words([format!(
            "{title}; froude compare --all prints {}.",
            if n == 1 { "it" } else { "them" }
        )]));
        out.push(Section { is_detail: true, ..Section::new(title, blocks) }.into());
    }
    out.extend(loads(c));
    out
}

/// Whether the estimates agree, a sentence for each pair.
#[must_use]
pub fn verdicts(c: &Comparison) -> Block {
    Block::words(c.verdicts.iter().map(|verdict| format!("  {}.", verdict.words())))
}

/// The joint comparison of each model in two estimates.
type Joint<'a> = BTreeMap<[&'a str; 3], &'a JointComparison>;

/// The coefficients that two estimates share, and what is said of them together.
fn coefficients(joint: &Joint<'_>, rows: &[CoefficientComparison]) -> Vec<Block> {
    let [one, other] = [&rows[0].first.source, &rows[0].second.source];
    let is_stated = rows.iter().any(|r| [&r.first, &r.second].iter().any(|side| side.standard_uncertainty.is_some()));
    let head = |number: &str, id: &str| {
        let id = if one == other { format!("{number}: {id}") } else { id.to_owned() };
        if is_stated { format!("{id}, ± U") } else { id }
    };
    let t = TableBuilder::new("", format!("Model {}", rows[0].model), rows);
    let name = |r: &CoefficientComparison| match &r.label {
        Some(label) => format!("{} ({label})", r.coefficient),
        None => r.coefficient.clone(),
    };
    let mut columns = vec![
        t.text("", "coefficient", name).symbol(),
        t.text("", "unit", |r| r.unit.clone()),
        t.text("", &head("1", one), |r| with_expanded(&r.first)),
        t.text("", &head("2", other), |r| with_expanded(&r.second)),
    ];
    if rows.iter().any(|r| r.e_n.is_some()) {
        columns.push(t.number("", "E_n", |r| r.e_n).normalised());
    }
    let mut said = Vec::new();
    if is_stated {
        said.push(EXPANDED.to_owned());
        said.push(coverage_note(one, rows.iter().map(|r| &r.first)));
        said.extend((one != other).then(|| coverage_note(other, rows.iter().map(|r| &r.second))));
    }
    let reasons = distinct(rows.iter().map(|r| &r.note).filter(|note| !note.is_empty()));
    said.extend(reasons.iter().map(|why| format!("no E_n: {why}")));
    if let Some(j) = joint.get(&[rows[0].model.as_str(), one, other]) {
        said.extend(match (j.chi_squared, j.dof, j.p) {
            (Some(chi2), Some(dof), Some(p)) => Some(format!(
                "jointly: χ² = {} with {}, {}",
                number::significant(chi2, 3),
                number::degrees_of_freedom(dof as f64),
                number::p_equation(p)
            )),
            // A missing uncertainty has been named with the missing E_n.
            _ if rows.iter().any(|r| r.note == j.note) => None,
            _ => Some(format!("no joint χ²: {}", j.note)),
        });
    }
    vec![t.build(columns).into(), notes(said)]
}

/// Predicted loads: a row for each place, a column for each estimate.
fn loads(c: &Comparison) -> Vec<Block> {
    let ids = c.load_sources();
    let Some((first, others)) = ids.split_first() else { return Vec::new() };
    // Every other estimate has a row for each place, in one order.
    let rows_of = |id: &str| c.loads.iter().filter(|r| r.second.source == id).collect::<Vec<_>>();
    let places: Vec<(usize, &LoadComparison)> =
        others.first().map_or_else(Vec::new, |id| rows_of(id)).into_iter().enumerate().collect();
    let Some((_, one)) = places.first() else { return Vec::new() };
    // Forces and moments in one table: each row says its unit.
    let is_one_unit = c.loads.iter().all(|r| r.unit == one.unit);
    let what = if is_one_unit { "force" } else { "forces and moments" };
    let caption = format!("Predicted {what} over the common range");
    let t = TableBuilder::new("", caption, &places);
    let mut columns = vec![if is_one_unit {
        t.text("", "load", |(_, r)| r.component.clone()).symbol()
    } else {
        t.text("", "load", |(_, r)| format!("{} [{}]", r.component, r.unit))
    }];
    if c.loads.iter().any(|r| r.n_links.is_some()) {
        columns.push(t.number("", "links", |(_, r)| r.n_links).plain(3));
    }
    columns.push(t.number("", "speed [m/s]", |(_, r)| r.speed_m_s).places(3));
    columns.push(t.number("", "angle [deg]", |(_, r)| r.angle_rad).places(1));
    let more_names = columns.len() - 1;
    let states = |side: &Side| side.standard_uncertainty.is_some();
    let unit = if is_one_unit { format!(" [{}]", one.unit) } else { String::new() };
    let head = |id: &str, is_stated: bool| format!("{id}{}{unit}", if is_stated { ", ± U" } else { "" });
    let own = rows_of(others[0]);
    columns.push(
        t.text("", &head(first, own.iter().any(|r| states(&r.first))), |(i, _)| own.get(*i).map(|r| load(&r.first))),
    );
    for id in others {
        let own = rows_of(id);
        let is_stated = own.iter().any(|r| states(&r.second));
        columns.push(t.text("", &head(id, is_stated), |(i, _)| own.get(*i).map(|r| load(&r.second))));
        if own.iter().any(|r| r.e_n.is_some()) {
            columns.push(t.number("", "E_n", |(i, _)| own.get(*i).and_then(|r| r.e_n)).normalised());
        }
    }
    let all = ResultTable { more_names, ..t.build(columns) };
    let mut said = Vec::new();
    if c.loads.iter().any(|r| states(&r.first) || states(&r.second)) {
        said.push(EXPANDED.to_owned());
    }
    said.extend(c.coverage.iter().cloned());
    for id in others {
        // A missing uncertainty has just been named.
        let notes = rows_of(id).into_iter().map(|r| &r.note).filter(|note| !note.is_empty());
        let notes = distinct(notes).into_iter().filter(|why| !why.starts_with("no uncertainty stated"));
        said.extend(notes.map(|why| format!("no E_n of {id} against {first}: {why}")));
    }
    if places.len() <= MOST_PLACES {
        return vec![all.into(), notes(said)];
    }
    let title = format!("all {} places of the common range", number::count(places.len()));
    let caption = format!("{}, at its ends and middle", all.caption);
    let few = ResultTable { caption, shown_rows: Some(corners(&places)), ..all.clone() };
    vec![few.into(), notes(said), Section { is_detail: true, ..Section::new(title, [all.into()]) }.into()]
}

/// What is said of a table.
fn notes(said: Vec<String>) -> Block {
    Block::words(said.into_iter().map(|text| format!("  {text}")))
}

/// The places at the least, middle and largest speed and angle.
fn corners(places: &[(usize, &LoadComparison)]) -> Vec<usize> {
    let three = |of: fn(&LoadComparison) -> f64| {
        let mut all: Vec<f64> = places.iter().map(|(_, r)| of(r)).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        [0, all.len() / 2, all.len() - 1].map(|i| all[i])
    };
    let (speeds, angles) = (three(|r| r.speed_m_s), three(|r| r.angle_rad));
    let is_corner = |(_, r): &&(usize, &LoadComparison)| speeds.contains(&r.speed_m_s) && angles.contains(&r.angle_rad);
    places.iter().filter(is_corner).map(|(i, _)| *i).collect()
}

/// Value and expanded uncertainty, digits after the uncertainty; the value alone where none is stated.
fn with_expanded(s: &Side) -> String {
    match (number::finite(s.value), number::usable(s.expanded_uncertainty)) {
        (Some(value), Some(u)) => number::plus_minus(value, u),
        (Some(value), None) => number::plain(value, 5),
        (None, _) => MISSING.to_owned(),
    }
}

fn load(side: &Side) -> String {
    match side.value {
        Some(load) if side.standard_uncertainty.is_none() => number::fixed(load, 4),
        _ => with_expanded(side),
    }
}
