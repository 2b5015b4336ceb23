//! The contest of the models.

use froude_records::block::TableBuilder;
use froude_records::number::{self, MISSING};
use froude_records::page::{SelectionRow, SourceSection};
use maud::{Markup, html};

use super::counter::Tables;
use super::distinct;
use super::symbols::html_symbol;
use super::typed::table_markup;
use crate::symbol::unit_text;

impl Tables {
    /// The contest of the models.
    pub(crate) fn selection<'a>(&mut self, source: &'a SourceSection) -> Markup {
        let rows = &source.selection;
        let blocks = distinct(rows.iter().flat_map(|r| r.range_blocks.iter().map(|(name, _)| name)));
        let has_lack = rows.iter().any(|r| r.lack_of_fit_p.is_some());
        let components = distinct(rows.iter().map(|r| &r.component));
        let best = crate::figures::drawing::recommended(source).map(|e| e.law.name.as_str());
        let is_left = |r: &SelectionRow| {
            let id_of = |e: &&froude_records::estimate::Estimate| e.law.name == r.model;
            source
                .estimates
                .iter()
                .find(id_of)
                .is_some_and(|e| e.not_contradicted.len() > 1 && e.not_contradicted.contains(&e.id))
        };
        let has_scores = rows.iter().any(|r| r.cross_validation.is_ok());
        let scored = |r: &'a SelectionRow| r.cross_validation.as_ref().err().filter(|_| has_scores);
        let reasons = distinct(rows.iter().flat_map(|r| r.delta_aicc.as_ref().err().into_iter().chain(scored(r))));
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
                    th scope="row" { (r.model) @if Some(r.model.as_str()) == best { " " span class="mark" { "recommended" } }
                            @else if is_left(r) { " " span class="mark" { "not contradicted" } } }
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
                        @let units = distinct(own().map(|r| &r.unit));
                        tbody {
                            tr class="group" {
                                th scope="rowgroup" colspan=(n_columns) {
                                    (html_symbol(component))
                                    span class="mark" {
                                        @for (i, unit) in units.iter().enumerate() {
                                            @if i == 0 { ", σ and errors in " (unit_text(unit)) }
                                            @else {
                                                @if **unit == *"1" { ", dimensionless for " } @else { ", in " (unit_text(unit)) " for " }
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

    /// Each model beside the terms of the others.
    pub(crate) fn added_terms(&mut self, source: &SourceSection) -> Markup {
        let t = TableBuilder::new(
            "",
            "F tests of each model against the terms that another model would add. The data contradict a model if its smallest p, times the number of its tests, is below 0.5 %; loads that it gives and loads that it lacks are counted separately.",
            &source.tests,
        );
        let columns = vec![
            t.text("", "Model", |test| test.law.clone()),
            t.text("", "Terms of", |test| test.of.clone()),
            t.text("", "Load", |test| test.component.clone()).symbol(),
            t.number("", "F", |test| test.f).significant(3),
            t.text("", "Degrees of freedom", |test| test.dof.map(number::dof).join(", ")),
            t.number("", "p", |test| test.p).p_value(),
        ];
        table_markup(&t.build(columns), self)
    }
}

/// Why there is no cross-validation, without the words that say that there is none.
fn bare_reason(reason: &str) -> &str {
    reason.strip_prefix("not possible: ").unwrap_or(reason)
}

/// The sentence that stands for a column in which no model has a cross-validation.
fn unscored(rows: &[SelectionRow]) -> Markup {
    let reasons = distinct(rows.iter().filter_map(|r| r.cross_validation.as_ref().err()));
    let models = |reason: &str| {
        distinct(
            rows.iter().filter(|r| r.cross_validation.as_ref().err().is_some_and(|x| x == reason)).map(|r| &r.model),
        )
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
    html! { p class="notes" { "Cross-validation is not possible: " (sentence) "." } }
}
