//! The tables of the page, numbered through.

use std::collections::BTreeSet;

use froude_records::comparison::{CoefficientComparison, Comparison, JointComparison, LoadComparison, Side};
use froude_records::estimate::{Coefficient, Estimate, Status};
use indexmap::IndexMap;
use maud::{Markup, html};

use crate::figures::{budget_rows, ranked_inputs, share};
use crate::symbol::{Rich, Style, symbol, unit_text};
use froude_records::number::{self, MISSING};
use froude_records::page::{BudgetRow, SelectionRow, SourceSection};

/// Most models side by side in one table.
const MOST_COLUMNS: usize = 6;

/// Most places with predicted loads on the page itself; where there are more, all are folded and three speeds by three
/// angles are shown.
const MOST_PREDICTIONS: usize = 36;

/// Most sources beside the first one in a table of predicted loads.
const MOST_SIDES: usize = 3;

/// A count with its noun.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", number::count(n), if n == 1 { one } else { many })
}

/// Counter of the tables.
#[derive(Default)]
pub(crate) struct Tables {
    n: usize,
}

/// A quantity of the range of validity in words; channels of the table as symbols.
fn quantity(name: &str) -> Markup {
    let words = match name {
        "n_links" => "links of the body",
        "Re" => "Reynolds number",
        "Fr_length" => "Froude number by length",
        "Fr_depth" => "Froude number by depth of water",
        "Fr_submergence" => "Froude number by submergence",
        "KC" => "Keulegan–Carpenter number",
        _ if name.len() > 2 && name.as_bytes()[1] == b'_' => return html_symbol(name),
        _ => return html! { (name.replace('_', " ")) },
    };
    html! { (words) }
}

/// A name as a symbol, with the name itself in its tooltip.
pub(crate) fn html_symbol(name: &str) -> Markup {
    let Rich { runs } = symbol(name);
    html! {
        span class="symbol" title=(name) {
            @for (i, (style, text)) in runs.iter().enumerate() {
                @match style {
                    Style::Upright => (text),
                    Style::Bold => b { (text) },
                    Style::Italic => i { (text) },
                    Style::Subscript => {
                        @if let Some((Style::Superscript, upper)) = runs.get(i + 1) {
                            span class="both" { sup { (upper) } sub { (text) } }
                        } @else {
                            sub { (text) }
                        }
                    },
                    Style::Superscript => {
                        @if !matches!(i.checked_sub(1).and_then(|k| runs.get(k)), Some((Style::Subscript, _))) {
                            sup { (text) }
                        }
                    },
                }
            }
        }
    }
}

/// What an estimate is called beside others: its law, or, where several have that one, what its id ends with.
pub(crate) fn called<'a>(e: &'a Estimate, beside: &[&Estimate]) -> &'a str {
    let is_alone = beside.iter().filter(|other| other.law.name == e.law.name).count() < 2;
    if is_alone { &e.law.name } else { e.id.rsplit_once('/').map_or(e.id.as_str(), |(_, method)| method) }
}

/// A coefficient's symbol, with what a paper calls it.
pub(crate) fn named(name: &str, c: &Coefficient) -> Markup {
    html! { (html_symbol(name)) @if let Some(label) = &c.label { " (" (html_symbol(label)) ")" } }
}

/// A unit behind a number; nothing for a pure number.
pub(crate) fn html_unit(unit: &str) -> Markup {
    html! { @if unit != "1" && !unit.is_empty() { " " span class="unit" { (unit_text(unit)) } } }
}

/// A unit in brackets for a head.
fn head_unit(unit: &str) -> Markup {
    html! { @if !unit.is_empty() { " " span class="unit" { "[" (unit_text(unit)) "]" } } }
}

/// Whether a value is given without any uncertainty although one belongs to it.
fn is_bare(c: &Coefficient, estimate: &Estimate) -> bool {
    let is_given = match c.status {
        Status::Free | Status::Prior => true,
        Status::Fixed => estimate.kind == "published",
        _ => false,
    };
    is_given
        && number::finite(c.value).is_some()
        && number::usable(c.standard_uncertainty).is_none()
        && c.interval_95.is_none()
}

fn dagger() -> Markup {
    html! { span class="mark" title="no uncertainty stated" { "†" } }
}

/// Value ± U with its unit, for the summary; the unit goes with a number only.
pub(crate) fn expanded(c: &Coefficient, estimate: &Estimate) -> Markup {
    let has_number = number::finite(c.value).is_some() && !matches!(c.status, Status::Undetermined | Status::Excluded);
    html! {
        (number::coefficient_expanded(c))
        @if is_bare(c, estimate) { (dagger()) }
        @if has_number { (html_unit(&c.unit)) }
    }
}

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

/// Keys over several estimates, in the order of appearance.
fn union<'a, I: IntoIterator<Item = &'a String>>(keys: I) -> Vec<&'a str> {
    let mut out: Vec<&str> = Vec::new();
    for key in keys {
        if !out.contains(&key.as_str()) {
            out.push(key);
        }
    }
    out
}

/// Motions of a 6×6 matrix.
const MOTIONS: [&str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];

impl Tables {
    /// The next table's caption.
    pub(crate) fn caption(&mut self, text: &str) -> Markup {
        self.n += 1;
        html! { caption { b { "Table " (self.n) ". " } (text) } }
    }

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
        let names = union(group.iter().flat_map(|e| e.coefficients.keys()));
        let recommended = group.iter().any(|e| e.recommended);
        let class = |e: &Estimate| if e.recommended { "best" } else { "" };
        let has_interval = group.iter().any(|e| e.coefficients.values().any(|c| c.interval_95.is_some()));
        let mut text = format!("Coefficients of {source} by force model");
        if has_interval {
            text.push_str("; standard uncertainty in brackets, 95 % interval below");
        }
        text.push('.');
        if recommended && group.len() > 1 {
            text.push_str(" The recommended model is shaded.");
        }
        let caption = self.caption(&text);
        let rows: Vec<Markup> = names
            .iter()
            .map(|name| {
                let mut units: Vec<&str> = group.iter().filter_map(|e| e.coefficients.get(*name)).map(|c| c.unit.as_str()).collect();
                units.dedup();
                let is_one_unit = units.len() < 2;
                let cells: Vec<Markup> = group
                    .iter()
                    .map(|e| {
                        let Some(c) = e.coefficients.get(*name) else { return html! { td class=(class(e)) {} } };
                        let inner = cell(c, e, &mut marks);
                        html! { td class=(class(e)) { (inner) @if !is_one_unit { (html_unit(&c.unit)) } } }
                    })
                    .collect();
                html! {
                    tr {
                        th scope="row" {
                            @match group.iter().find_map(|e| e.coefficients.get(*name)) {
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
        let units = union(estimate.coefficients.values().map(|c| &c.unit));
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
        let caption = self.caption(&format!(
            "Model {} in detail: standard uncertainty from the scatter of the data (type A), from the declared budget (type B), combined, \
             and with its effective degrees of freedom.",
            e.law.name
        ));
        // Nothing is known about a coefficient that is not determined, whatever its record holds.
        let known = |c: &Coefficient, x: Option<f64>| number::finite(x).filter(|_| c.status != Status::Undetermined);
        let u = |c: &Coefficient, x: Option<f64>| {
            known(c, x).map_or_else(|| MISSING.to_owned(), |x| number::significant(x, 2))
        };
        html! {
            div class="table" {
                table {
                    (caption)
                    thead {
                        tr {
                            th scope="col" { "Coefficient" }
                            th scope="col" class="num" { "Value" }
                            th scope="col" class="num" { "u" sub { "A" } }
                            th scope="col" class="num" { "u" sub { "B" } }
                            th scope="col" class="num" { "u" sub { "c" } }
                            th scope="col" class="num" { "ν" sub { "eff" } }
                            th scope="col" class="num" { "95 % interval" }
                            th scope="col" { "Unit" }
                        }
                    }
                    tbody {
                        @for (name, c) in &e.coefficients {
                            tr {
                                th scope="row" { (named(name, c)) }
                                td class="num" { (number::coefficient(c)) }
                                td class="num" { (u(c, c.type_a)) }
                                td class="num" { (u(c, c.type_b)) }
                                td class="num" { (u(c, number::usable(c.standard_uncertainty))) }
                                td class="num" { (known(c, c.effective_dof).map_or_else(|| MISSING.to_owned(), number::dof)) }
                                td class="num" { (c.interval_95.filter(|_| c.status != Status::Undetermined).map_or_else(|| MISSING.to_owned(), number::interval)) }
                                td { (unit_text(if c.unit.is_empty() { "1" } else { &c.unit })) }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Contributions by coefficient, the largest first.
    pub(crate) fn budget(&mut self, source: &SourceSection) -> Markup {
        let rows = budget_rows(source);
        let model = rows.first().map_or("", |r| r.model.as_str());
        let caption = self.caption(&format!(
            "Uncertainty budget of model {model}: standard uncertainty that each input alone gives to each coefficient, and its share of the \
             variance. What is shared by a setup or a campaign does not average down."
        ));
        let table = budget_table(&rows, &caption);
        let others =
            union(source.budget.iter().map(|r| &r.model)).into_iter().filter(|m| *m != model).collect::<Vec<_>>();
        let folded: Vec<Markup> = others
            .into_iter()
            .map(|other| {
                let rows: Vec<&BudgetRow> = source.budget.iter().filter(|r| r.model == other).collect();
                let caption = self.caption(&format!("Uncertainty budget of model {other}."));
                html! { details { summary { "Uncertainty budget of model " (other) } (budget_table(&rows, &caption)) } }
            })
            .collect();
        html! { (table) @for part in &folded { (part) } }
    }

    /// The contest of the models.
    pub(crate) fn selection<'a>(&mut self, source: &'a SourceSection) -> Markup {
        let rows = &source.selection;
        let blocks = union(rows.iter().flat_map(|r| r.range_blocks.iter().map(|(name, _)| name)));
        let has_lack = rows.iter().any(|r| r.lack_of_fit_p.is_some());
        let components = union(rows.iter().map(|r| &r.component));
        let best = crate::figures::recommended(source).map(|e| e.law.name.as_str());
        let has_scores = rows.iter().any(|r| r.cross_validation.is_ok());
        let scored = |r: &'a SelectionRow| r.cross_validation.as_ref().err().filter(|_| has_scores);
        let reasons = union(rows.iter().flat_map(|r| r.delta_aicc.as_ref().err().into_iter().chain(scored(r))));
        let footnote = |reason: &String| {
            html! {
                @if let Some(i) = reasons.iter().position(|x| x == reason) { sup { (i + 1) } }
            }
        };
        let caption = self.caption(&format!(
            "Models against each other, by load component. p: estimated coefficients; σ: residual standard deviation; r: norm of the \
             residual over norm of the measurement; ΔAICc: above the best model of this load{}.",
            if has_scores { "; cross-validation: root mean square error when one configuration is left out" } else { "" }
        ));
        let row = |r: &SelectionRow| {
            html! {
                tr class=(if Some(r.model.as_str()) == best { "best" } else { "" }) {
                    th scope="row" { (r.model) @if Some(r.model.as_str()) == best { " " span class="mark" { "recommended" } } }
                    td class="num" { (r.n_coefficients) }
                    td class="num" { (number::significant(r.sigma, 3)) }
                    td class="num" { (number::percent(r.relative_residual)) }
                    td class="num" {
                        @match &r.delta_aicc {
                            Ok(delta) => (number::fixed(*delta, 1)),
                            Err(reason) => { (MISSING) (footnote(reason)) },
                        }
                    }
                    @if has_scores {
                        td class="num" {
                            @match &r.cross_validation {
                                Ok(error) => (number::significant(*error, 3)),
                                Err(reason) => { (MISSING) (footnote(reason)) },
                            }
                        }
                    }
                    @for block in &blocks {
                        td class="num" {
                            (r.range_blocks.iter().find(|(name, _)| name == block).map_or_else(|| MISSING.to_owned(), |(_, x)| number::significant(*x, 3)))
                        }
                    }
                    @if has_lack { td class="num" { (r.lack_of_fit_p.map_or_else(|| MISSING.to_owned(), number::p_value)) } }
                }
            }
        };
        let n_columns = 5 + usize::from(has_scores) + blocks.len() + usize::from(has_lack);
        html! {
            div class="table" {
                table {
                    (caption)
                    thead {
                        tr {
                            th scope="col" { "Model" }
                            th scope="col" class="num" { "p" }
                            th scope="col" class="num" { "σ" }
                            th scope="col" class="num" { "r" }
                            th scope="col" class="num" { "ΔAICc" }
                            @if has_scores { th scope="col" class="num" { "Cross-validation" } }
                            @for block in &blocks { th scope="col" class="num" { "Error for " (block) } }
                            @if has_lack { th scope="col" class="num" { "Lack of fit, p" } }
                        }
                    }
                    @for component in &components {
                        @let own = || rows.iter().filter(|r| r.component == *component);
                        @let units = union(own().map(|r| &r.unit));
                        tbody {
                            tr class="group" {
                                th scope="rowgroup" colspan=(n_columns) {
                                    (html_symbol(component))
                                    span class="mark" {
                                        @for (i, unit) in units.iter().enumerate() {
                                            @if i == 0 { ", σ and errors in " (unit_text(unit)) }
                                            @else {
                                                ", in " (unit_text(unit)) " for "
                                                (own().filter(|r| r.unit == *unit).map(|r| r.model.as_str()).collect::<Vec<_>>().join(", "))
                                            }
                                        }
                                    }
                                }
                            }
                            @for r in own() { (row(r)) }
                        }
                    }
                    @if !source.not_fitted.is_empty() {
                        tbody {
                            tr class="group" { th scope="rowgroup" colspan=(n_columns) { "Not fitted" } }
                            @for (model, why) in &source.not_fitted {
                                tr { th scope="row" { (model) } td colspan=(n_columns - 1) { (why) } }
                            }
                        }
                    }
                }
            }
            @if !reasons.is_empty() {
                p class="notes" {
                    @for (i, reason) in reasons.iter().enumerate() { sup { (i + 1) } " " (bare_reason(reason)) ". " }
                }
            }
            @if !has_scores { (unscored(rows)) }
        }
    }

    /// F tests along the nesting.
    pub(crate) fn nested(&mut self, source: &SourceSection) -> Markup {
        let caption = self.caption(
            "F tests of the simpler model inside the more general one. A small p means that the data contradict the restriction.",
        );
        html! {
            div class="table" {
                table class="compact" {
                    (caption)
                    thead {
                        tr {
                            th scope="col" { "Restriction" }
                            th scope="col" { "Load" }
                            th scope="col" class="num" { "F" }
                            th scope="col" class="num" { "Degrees of freedom" }
                            th scope="col" class="num" { "p" }
                            th scope="col" { "At 5 %" }
                        }
                    }
                    tbody {
                        @for t in &source.tests {
                            tr {
                                th scope="row" { (t.simple) " ⊂ " (t.general) }
                                td { (html_symbol(&t.component)) }
                                td class="num" { (number::significant(t.f, 3)) }
                                td class="num" { (number::dof(t.dof[0])) ", " (number::dof(t.dof[1])) }
                                td class="num" { (number::p_value(t.p)) }
                                td {
                                    @if !t.p.is_finite() { (MISSING) }
                                    @else if t.p < 0.05 { (t.general) " fits better" }
                                    @else { "no evidence against " (t.simple) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Ranges of the observations behind an estimate.
    pub(crate) fn validity(&mut self, e: &Estimate) -> Markup {
        let caption = self.caption(&format!(
            "Range of the observations behind model {}. Outside it every prediction is extrapolation.",
            e.law.name
        ));
        html! {
            div class="table" {
                table class="compact" {
                    (caption)
                    thead {
                        tr {
                            th scope="col" { "Quantity" }
                            th scope="col" class="num" { "From" }
                            th scope="col" class="num" { "To" }
                            th scope="col" { "Unit" }
                        }
                    }
                    tbody {
                        @for (name, range) in &e.validity {
                            @let (scale, unit) = if range.unit == "rad" { (1f64.to_degrees(), "°") } else { (1.0, range.unit.as_str()) };
                            tr {
                                th scope="row" { (quantity(name)) }
                                td class="num" { (number::plain(range.low * scale, 4)) }
                                td class="num" { (number::plain(range.high * scale, 4)) }
                                td { (unit_text(unit)) }
                            }
                        }
                    }
                }
            }
        }
    }

    /// E_n of every coefficient that two sources share; pairs that have none are folded.
    pub(crate) fn differences(&mut self, comparison: &Comparison) -> Markup {
        let mut pairs: IndexMap<[&str; 3], Vec<&CoefficientComparison>> = IndexMap::new();
        for c in &comparison.coefficients {
            pairs.entry([&c.model, &c.first.source, &c.second.source]).or_default().push(c);
        }
        let (with, without): (Vec<_>, Vec<_>) =
            pairs.into_values().partition(|pair| pair.iter().any(|c| number::finite(c.e_n).is_some()));
        let shown = (!with.is_empty()).then(|| {
            let caption = self.caption(
                "Coefficients of the same model from two sources, with standard uncertainties in brackets and the normalised difference \
                 Eₙ = (first − second)/U, U the expanded (95 %) uncertainty of the difference: √(U₁² + U₂²) where the two have no error in \
                 common. |Eₙ| ≤ 1: they agree within their stated uncertainties.",
            );
            pair_table(&with, &caption)
        });
        let folded = (!without.is_empty()).then(|| {
            let caption =
                self.caption("Coefficients of the same model from two sources that have no normalised difference.");
            html! {
                details {
                    summary { (counted(without.len(), "pair", "pairs")) " of estimates without Eₙ" }
                    (pair_table(&without, &caption))
                }
                (why_not(&without))
            }
        });
        html! { @if let Some(table) = shown { (table) } @if let Some(table) = folded { (table) } }
    }

    /// χ² of whole coefficient vectors; pairs that have none are folded.
    pub(crate) fn joint(&mut self, comparison: &Comparison) -> Markup {
        let (with, without): (Vec<&JointComparison>, Vec<&JointComparison>) =
            comparison.joint.iter().partition(|j| number::finite(j.chi_squared).is_some());
        let shown = (!with.is_empty()).then(|| {
            let caption = self.caption(
                "All coefficients of a model together, with their covariances. Collinear coefficients can each agree while the vectors do \
                 not, and the other way round.",
            );
            joint_table(&with, &caption)
        });
        let folded = (!without.is_empty()).then(|| {
            let caption = self.caption("Pairs of estimates that have no χ².");
            html! {
                details {
                    summary { (counted(without.len(), "pair", "pairs")) " of estimates without χ²" }
                    (joint_table(&without, &caption))
                }
            }
        });
        html! { @if let Some(table) = shown { (table) } @if let Some(table) = folded { (table) } }
    }

    /// Predicted loads over the common range: a row per place, a column per source.
    pub(crate) fn predictions(&mut self, comparison: &Comparison) -> Markup {
        let mut parts = Vec::new();
        let mut by_sides: IndexMap<&str, IndexMap<&str, Vec<(usize, &LoadComparison)>>> = IndexMap::new();
        for (i, f) in comparison.loads.iter().enumerate() {
            by_sides.entry(&f.first.source).or_default().entry(&f.second.source).or_default().push((i, f));
        }
        for (first, others) in by_sides {
            let names: Vec<&str> = others.keys().copied().collect();
            let rows_of: Vec<_> = others.into_values().collect();
            for (block, rows) in names.chunks(MOST_SIDES).zip(rows_of.chunks(MOST_SIDES)) {
                let mut rows = rows.concat();
                rows.sort_by_key(|(i, _)| *i);
                let rows: Vec<&LoadComparison> = rows.into_iter().map(|(_, f)| f).collect();
                let places = by_place(&rows);
                let (shown, is_all) = corners(&places);
                let caption = self.caption(&format!(
                    "Loads that the sources predict over their common range{}. ± U: expanded uncertainty, 95 %, U = k·u; \
                     Eₙ = (a − b)/U, a from {first}, U the \
                     expanded uncertainty of the difference: √(U²(a) + U²(b)) where the two have no error in common; of a \
                     one-sided interval the arm that points to the other value.",
                    if is_all { "" } else { ", at its ends and middle" }
                ));
                parts.push(prediction_table(&shown, first, block, &caption));
                if !is_all {
                    let caption = self.caption("Predicted loads at all places of the common range.");
                    parts.push(html! {
                        details {
                            summary { "all " (number::count(places.len())) " places" }
                            (prediction_table(&places, first, block, &caption))
                        }
                    });
                }
            }
        }
        html! { @for part in &parts { (part) } }
    }
}

/// One place of the common range with its predictions, one for each other source.
type PredictedPlace<'a> = Vec<&'a LoadComparison>;

/// Predictions gathered by number of links, load, speed and angle, in the order of appearance.
fn by_place<'a>(rows: &[&'a LoadComparison]) -> Vec<PredictedPlace<'a>> {
    let mut out: IndexMap<(Option<u64>, &str, u64, u64), PredictedPlace<'a>> = IndexMap::new();
    for &r in rows {
        let links = r.n_links.map(f64::to_bits);
        let key = (links, r.component.as_str(), r.speed_m_s.to_bits(), r.angle_rad.to_bits());
        out.entry(key).or_default().push(r);
    }
    out.into_values().collect()
}

/// The places at the least, middle and largest speed and angle, and whether these are all.
fn corners<'a>(places: &[PredictedPlace<'a>]) -> (Vec<PredictedPlace<'a>>, bool) {
    if places.len() <= MOST_PREDICTIONS {
        return (places.to_vec(), true);
    }
    let three = |of: fn(&LoadComparison) -> f64| {
        let mut all: Vec<f64> = places.iter().map(|p| of(p[0])).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        [0, all.len() / 2, all.len() - 1].map(|i| all[i].to_bits())
    };
    let (speeds, angles) = (three(|f| f.speed_m_s), three(|f| f.angle_rad));
    let is_corner = |p: &&PredictedPlace<'a>| {
        speeds.contains(&p[0].speed_m_s.to_bits()) && angles.contains(&p[0].angle_rad.to_bits())
    };
    (places.iter().filter(is_corner).cloned().collect(), false)
}

/// Why estimates that state their uncertainties have no Eₙ: said outside the fold, each reason once with its pairs.
fn why_not(pairs: &[Vec<&CoefficientComparison>]) -> Markup {
    let states = |side: &Side| number::finite(side.expanded_uncertainty).is_some();
    let mut reasons: IndexMap<&str, Vec<String>> = IndexMap::new();
    for pair in pairs.iter().filter(|pair| pair.iter().any(|c| states(&c.first) && states(&c.second))) {
        if let Some(note) = common_note(pair.iter().map(|c| c.note.as_str())) {
            reasons.entry(note).or_default().push(format!("{} and {}", pair[0].first.source, pair[0].second.source));
        }
    }
    html! {
        @for (note, pairs) in &reasons { p class="remarks" { (pairs.join("; ")) " – " (note) "." } }
    }
}

/// Pairs of estimates with the coefficients that they share; each pair names its columns.
fn pair_table(pairs: &[Vec<&CoefficientComparison>], caption: &Markup) -> Markup {
    html! {
        div class="table" {
            table class="pairs" {
                (caption)
                @for own in pairs {
                    @let common = common_note(own.iter().map(|c| c.note.as_str()));
                    tbody {
                        tr class="group" {
                            th scope="col" { "Model " (own[0].model) }
                            th scope="col" class="num source" { (own[0].first.source) }
                            th scope="col" class="num source" { (own[0].second.source) }
                            th scope="col" class="num" { "E" sub { "n" } }
                            th scope="col" class="remark" { @if let Some(note) = common { (note) } }
                        }
                        @for c in own {
                            tr {
                                th scope="row" {
                                    (html_symbol(&c.coefficient))
                                    @if let Some(label) = &c.label { " (" (html_symbol(label)) ")" }
                                    (head_unit(&c.unit))
                                }
                                td class="num" { (side(&c.first)) }
                                td class="num" { (side(&c.second)) }
                                td class="num" { (normalised(c.e_n)) }
                                td class="remark" { @if common.is_none() { (c.note) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn joint_table(rows: &[&JointComparison], caption: &Markup) -> Markup {
    html! {
        div class="table" {
            table {
                (caption)
                thead {
                    tr {
                        th scope="col" { "Model" }
                        th scope="col" { "First" }
                        th scope="col" { "Second" }
                        th scope="col" class="num" { "χ²" }
                        th scope="col" class="num" { "Degrees of freedom" }
                        th scope="col" class="num" { "p" }
                        th scope="col" { "" }
                    }
                }
                tbody {
                    @for j in rows {
                        tr {
                            th scope="row" { (j.model) }
                            td { (j.first) }
                            td { (j.second) }
                            td class="num" { (number::finite(j.chi_squared).map_or_else(|| MISSING.to_owned(), |x| number::significant(x, 3))) }
                            td class="num" { (if j.chi_squared.is_some() { number::dof(j.dof.map_or(f64::NAN, |m| m as f64)) } else { MISSING.to_owned() }) }
                            td class="num" {
                                @match j.p {
                                    Some(p) if p < 0.05 => span class="bad" { (number::p_value(p)) },
                                    Some(p) => (number::p_value(p)),
                                    None => (MISSING),
                                }
                            }
                            td { (j.note) }
                        }
                    }
                }
            }
        }
    }
}

/// Why there is no cross-validation, without the words that say that there is none.
fn bare_reason(reason: &str) -> &str {
    reason.strip_prefix("not scorable: ").unwrap_or(reason)
}

/// The sentence that stands for a column in which no model has a cross-validation.
fn unscored(rows: &[SelectionRow]) -> Markup {
    let reasons = union(rows.iter().filter_map(|r| r.cross_validation.as_ref().err()));
    let models = |reason: &str| {
        union(rows.iter().filter(|r| r.cross_validation.as_ref().err().is_some_and(|x| x == reason)).map(|r| &r.model))
    };
    let sentence = match reasons.as_slice() {
        [] => return Markup::default(),
        [one] => bare_reason(one).to_owned(),
        several => several
            .iter()
            .map(|reason| format!("{} ({})", bare_reason(reason), models(reason).join(", ")))
            .collect::<Vec<_>>()
            .join("; "),
    };
    html! { p class="notes" { "Cross-validation is not scorable: " (sentence) "." } }
}

fn prediction_table(places: &[PredictedPlace<'_>], first: &str, others: &[&str], caption: &Markup) -> Markup {
    let has_configuration = places.iter().any(|p| p[0].n_links.is_some());
    let units = union(places.iter().map(|p| &p[0].unit));
    let is_one_unit = units.len() < 2;
    let unit = html! { @if is_one_unit { (head_unit(units.first().copied().unwrap_or(""))) } };
    let of = |other: &str| places.iter().flatten().copied().filter(|r| r.second.source == other).collect::<Vec<_>>();
    let has_e_n = |other: &str| of(other).iter().any(|r| number::finite(r.e_n).is_some());
    let states = |side: &Side| number::finite(side.expanded_uncertainty).is_some();
    let first_states = places.iter().flatten().any(|r| states(&r.first));
    let other_states = |other: &str| of(other).iter().any(|r| states(&r.second));
    let head = |id: &str, is_stated: bool| html! { (id) @if is_stated { ", ± U" } (unit) };
    // Where a side states no uncertainty, the † says why there is no Eₙ.
    let notes: Vec<(&str, &str)> = others
        .iter()
        .filter(|other| first_states && other_states(other))
        .flat_map(|other| {
            union(of(other).into_iter().map(|r| &r.note).filter(|n| !n.is_empty()))
                .into_iter()
                .map(move |n| (*other, n))
        })
        .collect();
    let has_dagger = !first_states || others.iter().any(|other| !other_states(other));
    html! {
        div class="table" {
            table {
                (caption)
                thead {
                    tr {
                        @if has_configuration { th scope="col" { "Body" } }
                        th scope="col" class="num" { "Speed " span class="unit" { "[m/s]" } }
                        th scope="col" class="num" { "Angle" }
                        th scope="col" { "Load" }
                        th scope="col" class="num source" { (head(first, first_states)) }
                        @for other in others {
                            th scope="col" class="num source" { (head(other, other_states(other))) }
                            @if has_e_n(other) { th scope="col" class="num" { "E" sub { "n" } } }
                        }
                    }
                }
                tbody {
                    @for place in places {
                        @let r = place[0];
                        tr {
                            @if has_configuration { td { @if let Some(k) = r.n_links { "k = " (k) } } }
                            td class="num" { (number::plain(r.speed_m_s, 4)) }
                            td class="num" { (number::degrees(r.angle_rad)) }
                            td { (html_symbol(&r.component)) @if !is_one_unit { (head_unit(&r.unit)) } }
                            td class="num" { (load(&r.first)) }
                            @for other in others {
                                @let own = place.iter().find(|r| r.second.source == *other);
                                td class="num" { @if let Some(r) = own { (load(&r.second)) } }
                                @if has_e_n(other) { td class="num" { @if let Some(r) = own { (normalised(r.e_n)) } } }
                            }
                        }
                    }
                }
            }
        }
        @if has_dagger || !notes.is_empty() {
            p class="notes" {
                @if has_dagger { "† no uncertainty stated, no E" sub { "n" } ". " }
                @for (other, note) in &notes { (other) ": " (note) ". " }
            }
        }
    }
}

/// The remark that all rows share, if they share one.
fn common_note<'a>(mut notes: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let first = notes.next().filter(|n| !n.is_empty())?;
    notes.all(|n| n == first).then_some(first)
}

/// A predicted load: value ± U, † without an uncertainty.
fn load(side: &Side) -> Markup {
    match (number::finite(side.value), number::usable(side.expanded_uncertainty)) {
        (Some(value), Some(u)) => html! { (number::plus_minus(value, u)) },
        // A load that is zero whatever the coefficients are.
        (Some(value), None) if side.expanded_uncertainty == Some(0.0) => html! { (number::plain(value, 4)) },
        (Some(value), None) => html! { (number::plain(value, 4)) (dagger()) },
        (None, _) => html! { (MISSING) },
    }
}

/// One side of a comparison: value with uncertainty, † without one.
fn side(side: &Side) -> Markup {
    match (number::finite(side.value), number::usable(side.standard_uncertainty)) {
        (Some(value), Some(u)) => html! { (number::short_form(value, u)) },
        (Some(value), None) => html! { (number::plain(value, 4)) (dagger()) },
        (None, _) => html! { (MISSING) },
    }
}

fn normalised(e_n: Option<f64>) -> Markup {
    match number::finite(e_n) {
        Some(e) if e.abs() > 1.0 => html! { span class="bad" { (number::fixed(e, 2)) } },
        Some(e) => html! { span class="good" { (number::fixed(e, 2)) } },
        None => html! { (MISSING) },
    }
}

/// Shares of a variance below this are rounding: double precision, squared, with room.
const ROUNDING: f64 = 1e-20;

/// Most inputs that get a column each.
const MOST_INPUTS: usize = 6;

/// A budget: a column per input where they fit, else a row per input and coefficient.
fn budget_table(rows: &[&BudgetRow], caption: &Markup) -> Markup {
    let mut inputs: Vec<(&str, &str)> = Vec::new();
    for (input, _) in ranked_inputs(rows) {
        for r in rows.iter().filter(|r| r.input == input) {
            if !inputs.contains(&(input, r.shared.as_str())) {
                inputs.push((input, r.shared.as_str()));
            }
        }
    }
    if inputs.len() > MOST_INPUTS {
        return long_budget_table(rows, caption);
    }
    let of = |coefficient: &str, input: &(&str, &str)| {
        rows.iter().copied().find(|r| r.coefficient == coefficient && r.input == input.0 && r.shared == input.1)
    };
    html! {
        div class="table" {
            table class="coefficients" {
                (caption)
                thead {
                    tr {
                        th scope="col" { "Coefficient" }
                        @for (input, shared) in &inputs {
                            th scope="col" {
                                (input)
                                @if !shared.is_empty() { br; span class="mark" { "shared by " (shared) } }
                            }
                        }
                    }
                }
                tbody {
                    @for coefficient in union(rows.iter().map(|r| &r.coefficient)) {
                        @let unit = rows.iter().find(|r| r.coefficient == coefficient).map_or("1", |r| r.unit.as_str());
                        @let largest = rows.iter().filter(|r| r.coefficient == coefficient).map(|r| share(r)).fold(0.0, f64::max);
                        tr {
                            th scope="row" { (html_symbol(coefficient)) (head_unit(if unit.is_empty() { "1" } else { unit })) }
                            @for input in &inputs {
                                td {
                                    @if let Some(r) = of(coefficient, input) {
                                        @if share(r) >= largest && largest > 0.0 { b { (number::significant(r.contribution, 2)) } }
                                        @else if share(r) < ROUNDING { "0" }
                                        @else { (number::significant(r.contribution, 2)) }
                                        span class="interval" { (number::percent(if share(r) < ROUNDING { 0.0 } else { r.share })) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn long_budget_table(rows: &[&BudgetRow], caption: &Markup) -> Markup {
    let order: Vec<&str> = ranked_inputs(rows).into_iter().map(|(input, _)| input).collect();
    let coefficients = union(rows.iter().map(|r| &r.coefficient));
    html! {
        div class="table" {
            table {
                (caption)
                thead {
                    tr {
                        th scope="col" { "Coefficient" }
                        th scope="col" { "Input" }
                        th scope="col" { "Shared by" }
                        th scope="col" class="num" { "Standard uncertainty" }
                        th scope="col" { "Unit" }
                        th scope="col" class="num" { "Share of variance" }
                    }
                }
                @for coefficient in &coefficients {
                    @let own = sorted(rows, coefficient, &order);
                    tbody {
                        @for (i, r) in own.iter().enumerate() {
                            tr {
                                @if i == 0 { th scope="rowgroup" rowspan=(own.len()) { (html_symbol(coefficient)) } }
                                td { (r.input) }
                                td { (if r.shared.is_empty() { MISSING } else { r.shared.as_str() }) }
                                td class="num" { (number::significant(r.contribution, 2)) }
                                td { (unit_text(if r.unit.is_empty() { "1" } else { &r.unit })) }
                                td class="num" { (number::percent(r.share)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Rows of one coefficient, the largest share first; ties as the inputs rank overall.
fn sorted<'a>(rows: &[&'a BudgetRow], coefficient: &str, order: &[&str]) -> Vec<&'a BudgetRow> {
    let rank = |input: &str| order.iter().position(|o| *o == input).unwrap_or(usize::MAX);
    let mut own: Vec<&BudgetRow> = rows.iter().copied().filter(|r| r.coefficient == coefficient).collect();
    own.sort_by(|a, b| share(b).total_cmp(&share(a)).then(rank(&a.input).cmp(&rank(&b.input))));
    own
}

/// σ of a load; of its logarithm where a force or a moment has a σ without unit.
pub(crate) fn sigma(component: &str, unit: &str) -> Markup {
    let is_load = component.starts_with("f_") || component.starts_with("m_");
    html! { "σ(" @if is_load && unit == "1" { "ln " } (html_symbol(component)) ")" }
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
    let components = union(group.iter().flat_map(|e| e.sigma.keys().chain(e.diagnostics.relative_residual.keys())));
    let finite = |x: Option<f64>, text: &dyn Fn(f64) -> String| number::finite(x).map(text);
    let rows = html! {
        (row(html! { "observations" }, each(&|e| (e.n_observations > 0).then(|| number::count(e.n_observations)))))
        @for component in &components {
            // A fit of logarithms has a σ without unit: a row for each unit.
            @for unit in union(group.iter().filter_map(|e| e.sigma.get(*component)).map(|m| &m.unit)) {
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
        (row(html! { "largest power to the body " span class="unit" { "[W]" } },
            each(&|e| finite(e.diagnostics.largest_power_w, &|x| number::plain(x, 2)))))
    };
    html! { @if !rows.0.is_empty() { tfoot { (rows) } } }
}
