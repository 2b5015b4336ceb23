//! Coefficients: models side by side, a 6×6 matrix, one model in detail.

use std::collections::BTreeSet;

use froude_records::block::TableBuilder;
use froude_records::estimate::words;
use froude_records::estimate::{Coefficient, Estimate, Status};
use froude_records::number::{self, MISSING};
use indexmap::IndexMap;
use maud::{Markup, html};

use super::counter::Tables;
use super::symbols::{head_unit, html_symbol, html_unit};
use super::typed::table_markup;
use super::{called, dagger, distinct, is_bare, named, sigma, wider_range};
use crate::symbol::unit_text;

/// Most models side by side in one table.
const MOST_COLUMNS: usize = 6;

/// A mark of a coefficient table that needs a footnote, in the order of the footnotes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    Bare,
    Bound,
    BoundWithInterval,
    Contradicted,
    Fixed,
    Prior,
    Excluded,
    Undetermined,
}

/// The marks that a table shows.
type Marks = BTreeSet<Mark>;

fn cell(c: &Coefficient, estimate: &Estimate, marks: &mut Marks) -> Markup {
    let Some(value) = number::finite(c.value).filter(|_| c.status != Status::Undetermined) else {
        if c.status == Status::Excluded {
            marks.insert(Mark::Excluded);
            return html! { span class="mark" { "excluded" } };
        }
        marks.insert(Mark::Undetermined);
        return html! { span title="not determined by these data" { (MISSING) } };
    };
    if c.status == Status::Excluded {
        marks.insert(Mark::Excluded);
        return html! { span class="mark" { "excluded" } };
    }
    let is_bare = is_bare(c, estimate);
    if is_bare {
        marks.insert(Mark::Bare);
    }
    let number = number::usable(c.standard_uncertainty)
        .map_or_else(|| number::plain(value, 5), |u| number::short_form(value, u));
    let interval = html! {
        @if let Some(ends) = c.interval_95 { span class="interval" { (number::interval(ends)) } }
        @if let Some(ends) = wider_range(c) { span class="interval" { "range " (number::interval(ends)) } }
    };
    match c.status {
        Status::AtBound => {
            marks.insert(if c.interval_95.is_some() { Mark::BoundWithInterval } else { Mark::Bound });

            html! { (number::plain(value, 5)) " " span class="mark" { "(bound)" } (interval) }
        }
        Status::BoundContradicted => {
            marks.insert(Mark::Contradicted);
            html! { (number::plain(value, 5)) " " span class="bad" { "(bound contradicted)" } (interval) }
        }
        Status::Fixed if estimate.kind != "published" => {
            marks.insert(Mark::Fixed);
            html! { (number) " " span class="mark" { "(fixed)" } }
        }
        Status::Prior => {
            marks.insert(Mark::Prior);
            html! { (number) " " span class="mark" { "(prior)" } @if is_bare { (dagger()) } (interval) }
        }
        _ => html! { (number) @if is_bare { (dagger()) } (interval) },
    }
}

fn footnotes(marks: &Marks) -> Markup {
    let has_interval = marks.contains(&Mark::BoundWithInterval);
    let notes: Vec<&str> = marks
        .iter()
        .filter(|mark| **mark != Mark::Bound || !has_interval)
        .map(|mark| match mark {
            Mark::Bare => "† no uncertainty stated",
            Mark::Bound => "(bound) the constrained fit lies on the bound",
            Mark::BoundWithInterval => {
                "(bound) the constrained fit lies on the bound; the interval is the unconstrained one, cut by it"
            }
            Mark::Contradicted => "(bound contradicted) the data put the coefficient wholly outside its bounds",
            Mark::Fixed => "(fixed) given, not estimated",
            Mark::Prior => "(prior) estimated together with a published value",
            Mark::Excluded => "excluded: left out of the model by the campaign",
            Mark::Undetermined => "— not determined by these data",
        })
        .collect();
    html! { @if !notes.is_empty() { p class="notes" { (notes.join(". ")) "." } } }
}

/// `f1` … `f6`, which belong into one table.
fn is_robot_model(model: &str) -> bool {
    matches!(model, "f1" | "f2" | "f3" | "f4" | "f5" | "f6")
}

/// Models that share coefficients, side by side; others in tables of their own.
fn groups(estimates: &[Estimate]) -> Vec<Vec<&Estimate>> {
    let mut groups: Vec<Vec<&Estimate>> = Vec::new();
    for e in estimates {
        let belongs = |group: &Vec<&Estimate>| {
            group.len() < MOST_COLUMNS
                && group.iter().any(|o| {
                    (is_robot_model(&o.law.name) && is_robot_model(&e.law.name))
                        || o.coefficients.keys().any(|name| e.coefficients.contains_key(name))
                })
        };
        match groups.iter_mut().find(|g| belongs(g)) {
            Some(group) => group.push(e),
            None => groups.push(vec![e]),
        }
    }
    groups
}

/// Motions of a 6×6 matrix.
const MOTIONS: [&str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];

impl Tables {
    /// Coefficients of all models of one source: rows coefficients, columns models.
    pub(crate) fn coefficients(&mut self, source: &str, estimates: &[Estimate]) -> Markup {
        let tables: Vec<Markup> = groups(estimates)
            .into_iter()
            .map(|group| match group.as_slice() {
                [single] if single.law.name == "added_mass_6x6" => self.matrix(source, single),
                _ => self.coefficient_group(source, &group),
            })
            .collect();
        html! { @for table in &tables { (table) } }
    }

    fn coefficient_group(&mut self, source: &str, group: &[&Estimate]) -> Markup {
        let mut marks = Marks::default();
        // Derived numbers follow the coefficients that they are made of.
        let all: Vec<IndexMap<String, Coefficient>> = group
            .iter()
            .map(|e| e.derived_coefficients().into_iter().chain(e.coefficients.clone()).collect())
            .collect();
        let names = distinct(
            group.iter().flat_map(|e| e.coefficients.keys()).chain(group.iter().flat_map(|e| e.derived.keys())),
        );
        let recommended = group.iter().any(|e| e.recommended);
        let class = |e: &Estimate| if e.recommended { "best" } else { "" };
        let has_interval = group.iter().any(|e| e.coefficients.values().any(|c| c.interval_95.is_some()));
        let mut text = format!("Coefficients from {source} for each force model");
        if has_interval {
            text.push_str("; standard uncertainty in brackets, below it the 95 % interval if the model is true");
        }
        if group.iter().any(|e| e.coefficients.values().any(|c| wider_range(c).is_some())) {
            text.push_str(", and the range over all models that the data do not contradict");
        }
        text.push('.');
        if recommended && group.len() > 1 {
            text.push_str(" The recommended model is shaded.");
        }
        let caption = self.caption(&text);
        let rows: Vec<Markup> = names
            .iter()
            .map(|name| {
                let mut units: Vec<&str> = all.iter().filter_map(|own| own.get(*name)).map(|c| c.unit.as_str()).collect();
                units.dedup();
                let is_one_unit = units.len() < 2;
                let cells: Vec<Markup> = group
                    .iter()
                    .zip(&all)
                    .map(|(e, own)| {
                        let Some(c) = own.get(*name) else { return html! { td class=(class(e)) {} } };
                        let inner = cell(c, e, &mut marks);
                        html! { td class=(class(e)) { (inner) @if !is_one_unit { (html_unit(&c.unit)) } } }
                    })
                    .collect();
                html! {
                    tr {
                        th scope="row" {
                            @match all.iter().find_map(|own| own.get(*name)) {
                                Some(c) => (named(name, c)),
                                None => (html_symbol(name)),
                            }
                            @if is_one_unit { (head_unit(units.first().copied().filter(|u| !u.is_empty()).unwrap_or("1"))) }
                            " " code { (name) }
                        }
                        @for cell in &cells { (cell) }
                    }
                }
            })
            .collect();
        html! {
            div class="table" {
                table class=(if group.len() > 2 { "coefficients" } else { "coefficients compact" }) {
                    (caption)
                    thead {
                        tr {
                            th scope="col" { "Coefficient" }
                            @for e in group { th scope="col" class=(class(e)) { (called(e, group)) } }
                        }
                    }
                    tbody { @for row in &rows { (row) } }
                    (diagnostics(group))
                }
            }
            (footnotes(&marks))
        }
    }

    /// A 6×6 added mass as a matrix, other names below it.
    fn matrix(&mut self, source: &str, estimate: &Estimate) -> Markup {
        let mut marks = Marks::default();
        let name = |i: usize, j: usize| format!("A{}{}", i + 1, j + 1);
        let is_in_matrix = |key: &str| (0..36).any(|k| name(k / 6, k % 6) == key);
        let others: Vec<&String> = estimate.coefficients.keys().filter(|k| !is_in_matrix(k)).collect();
        let units = distinct(estimate.coefficients.values().map(|c| &c.unit));
        let caption = self.caption(&format!(
            "Added mass of {source}, rows forces and moments, columns accelerations{}.",
            if units.is_empty() {
                String::new()
            } else {
                format!(" [{}]", units.iter().map(|u| unit_text(u)).collect::<Vec<_>>().join(", "))
            }
        ));
        let rows: Vec<Markup> = MOTIONS
            .iter()
            .enumerate()
            .map(|(i, motion)| {
                let cells: Vec<Markup> = (0..6)
                    .map(|j| {
                        let key = name(i, j);
                        let Some(c) = estimate.coefficients.get(&key) else { return html! { td {} } };
                        let inner = cell(c, estimate, &mut marks);
                        html! { td title=(key) { (inner) } }
                    })
                    .collect();
                html! { tr { th scope="row" { (motion) } @for cell in &cells { (cell) } } }
            })
            .collect();
        let other_rows: Vec<Markup> = others
            .into_iter()
            .filter_map(|key| estimate.coefficients.get(key).map(|c| (key, c)))
            .map(|(key, c)| {
                let inner = cell(c, estimate, &mut marks);
                html! { tr { th scope="row" { (html_symbol(key)) " " code { (key) } } td colspan="6" { (inner) (html_unit(&c.unit)) } } }
            })
            .collect();
        html! {
            div class="table" {
                table class="coefficients" {
                    (caption)
                    thead { tr { th scope="col" { "" } @for motion in MOTIONS { th scope="col" { (motion) } } } }
                    tbody { @for row in &rows { (row) } }
                    @if !other_rows.is_empty() { tbody { @for row in &other_rows { (row) } } }
                }
            }
            (footnotes(&marks))
        }
    }

    /// The recommended model in detail: both types of uncertainty.
    pub(crate) fn detail(&mut self, e: &Estimate) -> Markup {
        let has_types = e.coefficients.values().any(|c| c.type_a.is_some() || c.type_b.is_some());
        if !has_types {
            return Markup::default();
        }
        let caption = format!(
            "Model {} in detail: standard uncertainty from the scatter of the data (type A), from the declared budget (type B), combined, \
             and with its effective degrees of freedom. The interval is valid if this model is true. The range is the envelope of the intervals over all models that the data do not \
             contradict.",
            e.law.name
        );
        // Nothing is known about a coefficient that is not determined, whatever its record holds.
        let known = |c: &Coefficient| c.status != Status::Undetermined;
        let rows: Vec<(&String, &Coefficient)> = e.coefficients.iter().collect();
        let t = TableBuilder::new("", caption, &rows);
        let name = |(name, c): &(&String, &Coefficient)| match &c.label {
            Some(label) => format!("{name} ({label})"),
            None => (*name).clone(),
        };
        let mut columns = vec![
            t.text("", "Coefficient", name).symbol(),
            t.text("", "Value", |(_, c)| words::coefficient(c)),
            t.number("", "u_A", |(_, c)| c.type_a.filter(|_| known(c))).significant(2),
            t.number("", "u_B", |(_, c)| c.type_b.filter(|_| known(c))).significant(2),
            t.number("", "u_c", |(_, c)| number::usable(c.standard_uncertainty).filter(|_| known(c))).significant(2),
            t.text("", "ν_eff", |(_, c)| number::finite(c.effective_dof).filter(|_| known(c)).map(number::dof)),
            t.interval("", "95 % interval", |(_, c)| c.interval_95.filter(|_| known(c))),
        ];
        if e.coefficients.values().any(|c| c.range_95.is_some()) {
            columns.push(t.interval("", "Range", |(_, c)| c.range_95));
        }
        columns.push(t.text("", "Unit", |(_, c)| unit_text(if c.unit.is_empty() { "1" } else { &c.unit })));
        table_markup(&t.build(columns), self)
    }
}

/// Foot of a coefficient table: how well each model does.
fn diagnostics(group: &[&Estimate]) -> Markup {
    let class = |e: &Estimate| if e.recommended { "best" } else { "" };
    let row = |head: Markup, texts: Vec<Option<String>>| {
        html! {
            @if texts.iter().any(Option::is_some) {
                tr {
                    th scope="row" { (head) }
                    @for (e, text) in group.iter().zip(&texts) { td class=(class(e)) { (text.as_deref().unwrap_or("")) } }
                }
            }
        }
    };
    let each = |of: &dyn Fn(&Estimate) -> Option<String>| group.iter().map(|e| of(e)).collect::<Vec<_>>();
    let components = distinct(group.iter().flat_map(|e| e.sigma.keys().chain(e.diagnostics.relative_residual.keys())));
    let finite = |x: Option<f64>, text: &dyn Fn(f64) -> String| number::finite(x).map(text);
    let rows = html! {
        (row(html! { "observations" }, each(&|e| (e.n_observations > 0).then(|| number::count(e.n_observations)))))
        @for component in &components {
            // A fit of logarithms has a σ without unit: a row for each unit.
            @for unit in distinct(group.iter().filter_map(|e| e.sigma.get(*component)).map(|m| &m.unit)) {
                @let own = |e: &Estimate| e.sigma.get(*component).filter(|m| m.unit == unit).map(|m| m.value);
                (row(html! { (sigma(component, unit)) (head_unit(unit)) },
                    each(&|e| finite(own(e), &|x| number::significant(x, 3)))))
            }
            (row(html! { "relative residual " (html_symbol(component)) },
                each(&|e| finite(e.diagnostics.relative_residual.get(*component).copied(), &number::percent))))
            (row(html! { "degrees of freedom " (html_symbol(component)) },
                each(&|e| e.dof.get(*component).copied().flatten().map(number::dof))))
            (row(html! { "Durbin–Watson " (html_symbol(component)) },
                each(&|e| finite(e.diagnostics.durbin_watson.get(*component).copied(), &|x| number::fixed(x, 2)))))
        }
        (row(html! { "condition number" }, each(&|e| finite(e.diagnostics.condition_number, &|x| number::significant(x, 2)))))
        (row(html! { "largest correlation" }, each(&|e| {
            e.diagnostics.largest_correlation.as_ref().and_then(|c| finite(Some(c.value), &|x| number::fixed(x, 3)))
        })))
        (row(html! { "largest power fed to the body (≤ 0: dissipative) " span class="unit" { "[W]" } },
            each(&|e| finite(e.diagnostics.largest_power_w, &|x| number::plain(x, 2)))))
    };
    html! { @if !rows.0.is_empty() { tfoot { (rows) } } }
}
