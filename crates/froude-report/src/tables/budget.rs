//! The budget: what each input contributes to each coefficient.

use maud::{Markup, html};

use super::counter::Tables;
use super::distinct;
use super::symbols::{head_unit, html_symbol};
use super::typed::table_markup;
use crate::figures::{budget_rows, ranked_inputs, share};
use crate::symbol::unit_text;
use froude_records::block::TableBuilder;
use froude_records::number;
use froude_records::page::{BudgetRow, SourceSection};

/// Shares of a variance below this are rounding: double precision, squared, with room.
const ROUNDING: f64 = 1e-20;

/// Most inputs that get a column each.
const MOST_INPUTS: usize = 6;

/// A budget: a column per input where they fit, else a row per input and coefficient.
fn budget_table(rows: &[&BudgetRow], caption: String, tables: &mut Tables) -> Markup {
    let mut inputs: Vec<(&str, &str)> = Vec::new();
    for (input, _) in ranked_inputs(rows) {
        for r in rows.iter().filter(|r| r.input == input) {
            if !inputs.contains(&(input, r.shared.as_str())) {
                inputs.push((input, r.shared.as_str()));
            }
        }
    }
    if inputs.len() > MOST_INPUTS {
        return long_budget_table(rows, caption, tables);
    }
    let caption = tables.caption(&caption);
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
                    @for coefficient in distinct(rows.iter().map(|r| &r.coefficient)) {
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

fn long_budget_table(rows: &[&BudgetRow], caption: String, tables: &mut Tables) -> Markup {
    let order: Vec<&str> = ranked_inputs(rows).into_iter().map(|(input, _)| input).collect();
    let coefficients = distinct(rows.iter().map(|r| &r.coefficient));
    let own = |coefficient| sorted(rows, coefficient, &order).into_iter().enumerate();
    let rows: Vec<(usize, &BudgetRow)> = coefficients.into_iter().flat_map(own).collect();
    let t = TableBuilder::new("", caption, &rows);
    let columns = vec![
        t.text("", "Coefficient", |(i, r)| if *i == 0 { r.coefficient.clone() } else { String::new() }).symbol(),
        t.text("", "Input", |(_, r)| r.input.clone()),
        t.text("", "Shared by", |(_, r)| Some(r.shared.clone()).filter(|shared| !shared.is_empty())),
        t.number("", "Standard uncertainty", |(_, r)| r.contribution).significant(2),
        t.text("", "Unit", |(_, r)| unit_text(if r.unit.is_empty() { "1" } else { &r.unit })),
        t.number("", "Share of variance", |(_, r)| r.share).percent(),
    ];
    table_markup(&t.build(columns), tables)
}

/// Rows of one coefficient, the largest share first; ties as the inputs rank overall.
fn sorted<'a>(rows: &[&'a BudgetRow], coefficient: &str, order: &[&str]) -> Vec<&'a BudgetRow> {
    let rank = |input: &str| order.iter().position(|o| *o == input).unwrap_or(usize::MAX);
    let mut own: Vec<&BudgetRow> = rows.iter().copied().filter(|r| r.coefficient == coefficient).collect();
    own.sort_by(|a, b| share(b).total_cmp(&share(a)).then(rank(&a.input).cmp(&rank(&b.input))));
    own
}

impl Tables {
    /// Contributions by coefficient, the largest first.
    pub(crate) fn budget(&mut self, source: &SourceSection) -> Markup {
        let rows = budget_rows(source);
        let model = rows.first().map_or("", |r| r.model.as_str());
        let caption = format!(
            "Uncertainty budget of model {model}: standard uncertainty that each input alone gives to each coefficient, and its share of the \
             variance. What is shared by a setup or a campaign does not average down."
        );
        let table = budget_table(&rows, caption, self);
        let others =
            distinct(source.budget.iter().map(|r| &r.model)).into_iter().filter(|m| *m != model).collect::<Vec<_>>();
        let folded: Vec<Markup> = others
            .into_iter()
            .map(|other| {
                let rows: Vec<&BudgetRow> = source.budget.iter().filter(|r| r.model == other).collect();
                let table = budget_table(&rows, format!("Uncertainty budget of model {other}."), self);
                html! { details { summary { "Uncertainty budget of model " (other) } (table) } }
            })
            .collect();
        html! { (table) @for part in &folded { (part) } }
    }
}
