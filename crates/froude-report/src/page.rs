//! The report as one HTML page.
//!
//! Everything stands in the file: style, figures, text. It loads nothing, runs
//! no script, and prints on A4. All text from records is escaped.

use std::collections::BTreeSet;

use froude_records::block::{Block, TableBuilder};
use froude_records::estimate::{Estimate, Measured};
use froude_records::finding::Severity;
use froude_records::number;
use froude_records::page::SourceSection;
use maud::{Markup, PreEscaped, html};

use crate::figures::drawing::recommended;
use crate::figures::{Figure, Place, budget_rows, placed_figures, ranked_inputs};
use crate::findings::findings_by_severity;
use crate::sheet::sheet;
use crate::side_by_side;
use crate::symbol::unit_text;
use crate::tables::counter::Tables;
use crate::tables::symbols::{html_symbol, html_unit};
use crate::tables::typed::table_markup;
use crate::tables::{self, counted, distinct};
use froude_records::page::Report;

/// What a reader of two sources needs to know first.
const SIDE_BY_SIDE: &str = "Coefficients of the same model are set side by side; their normalised difference Eₙ is stated only where both sides state an \
     uncertainty and rest on different data. Coefficients of one fit are correlated: the predicted forces over the common range are what a user of the \
     coefficients needs.";

/// The report as one self-contained HTML file.
#[must_use]
pub fn html(report: &Report) -> String {
    let figures = placed_figures(report);
    let mut page = Page { report, figures, sections: Vec::new(), tables: Tables::default() };
    let summary = page.summary();
    let mut body = Vec::new();
    for (i, block) in report.blocks.iter().enumerate() {
        let heading = page.open(&format!("block-{}", i + 1), &block.title, "");
        let mut pictures = page.pictures(Place::Block(i)).into_iter();
        let text = blocks(&block.blocks, &mut page.tables, &mut pictures);
        body.push(html! { section { (heading) (text) } });
    }
    body.push(page.method());
    body.push(page.data());
    body.push(page.findings());
    for i in 0..report.sources.len() {
        body.push(page.source(i));
    }
    body.push(page.published());
    body.push(page.side_by_side());
    body.push(page.citations());
    body.push(page.versions());
    let files: BTreeSet<_> = report.data.iter().map(|file| &file.path).collect();
    let title = if report.title.trim().is_empty() { "Report" } else { report.title.trim() };
    let main = html! {
        header class="title" {
            p class="sort" { "Test report · identified coefficients" }
            h1 { (title) }
            @if !report.subtitle.is_empty() { p class="subtitle" { (report.subtitle) } }
            p class="meta" {
                @if let Some(date) = &report.date { span { (date) } }
                span { (counted(page.source_names(), "source", "sources")) }
                span { (counted(files.len(), "data file", "data files")) }
                @for (name, version) in report.versions.iter().take(1) { span { (name) " " (version) } }
            }
        }
        (summary)
        @for part in &body { (part) }
    };
    sheet(title, &page.navigation(), &main)
}

/// An entry of the navigation.
struct Section {
    id: String,
    number: String,
    title: String,
    parts: Vec<(String, String)>,
}

struct Page<'a> {
    report: &'a Report,
    figures: Vec<(Place, Figure)>,
    sections: Vec<Section>,
    tables: Tables,
}

impl Page<'_> {
    /// How many sources there are; several results may come from one.
    fn source_names(&self) -> usize {
        let name = |s: &SourceSection| s.estimates.first().map_or_else(|| s.name.clone(), |e| e.source.clone());
        self.report.sources.iter().map(name).collect::<BTreeSet<_>>().len()
    }

    /// Opens a numbered section and gives its heading.
    fn open(&mut self, id: &str, title: &str, kind: &str) -> Markup {
        let number = (self.sections.len() + 1).to_string();
        let markup = html! {
            h2 id=(id) {
                span class="n" { (number) } (title)
                @if !kind.is_empty() { span class="kind" { (kind) } }
            }
        };
        self.sections.push(Section { id: id.to_owned(), number, title: title.to_owned(), parts: Vec::new() });
        markup
    }

    /// Opens a part of the current section.
    fn part(&mut self, name: &str, title: &str) -> Markup {
        let Some(section) = self.sections.last_mut() else { return html! { h3 { (title) } } };
        let id = format!("{}-{name}", section.id);
        let number = format!("{}.{}", section.number, section.parts.len() + 1);
        section.parts.push((id.clone(), title.to_owned()));
        html! { h3 id=(id) { span class="n" { (number) } (title) } }
    }

    fn navigation(&self) -> Markup {
        html! {
            ol {
                li { a href="#summary" { span {} "Summary" } }
                @for section in &self.sections {
                    li {
                        a href={ "#" (section.id) } { span { (section.number) } (section.title) }
                        @if section.parts.len() > 1 {
                            ol { @for (id, title) in &section.parts { li { a href={ "#" (id) } { (title) } } } }
                        }
                    }
                }
            }
        }
    }

    /// The figures of one place, each with its number and caption.
    fn pictures(&self, place: Place) -> Vec<Markup> {
        let own = self.figures.iter().enumerate().filter(|(_, (p, _))| *p == place);
        let each = own.map(|(i, (_, figure))| {
            html! {
                figure id={ "fig-" (i + 1) } {
                    (PreEscaped(&figure.svg))
                    figcaption { b { "Figure " (i + 1) ". " } (figure.caption) }
                }
            }
        });
        each.collect()
    }

    /// All of them.
    fn figures_at(&self, place: Place) -> Markup {
        html! { @for picture in self.pictures(place) { (picture) } }
    }

    fn has_figures_at(&self, place: Place) -> bool {
        self.figures.iter().any(|(p, _)| *p == place)
    }

    fn summary(&self) -> Markup {
        let n = |severity| self.report.findings.iter().filter(|f| f.severity == severity).count();
        let (errors, warnings, notes) = (n(Severity::Error), n(Severity::Warning), n(Severity::Note));
        html! {
            section class="summary" id="summary" aria-labelledby="summary-title" {
                h2 id="summary-title" { "Summary" }
                div class="chips" {
                    @if errors > 0 { span class="error" { (counted(errors, "error", "errors")) } }
                    @if warnings > 0 { span class="warning" { (counted(warnings, "warning", "warnings")) } }
                    @if notes > 0 { span class="note" { (counted(notes, "note", "notes")) } }
                    @if self.report.findings.is_empty() { span { "no findings" } }
                    @else { span { a href="#findings" { "read the findings" } } }
                }
                @if self.report.sources.is_empty() {
                    p { @if self.report.published.is_empty() { "No source was fitted." } @else { "Records side by side; nothing was fitted." } }
                }
                @if let Some(comparison) = &self.report.comparison {
                    @for verdict in &comparison.verdicts { p { (verdict.words()) "." } }
                }
                @for (i, source) in self.report.sources.iter().enumerate().filter(|(_, s)| !self.is_beside_the_recommended(s)) {
                    (summary_of(i, source))
                }
                @if !self.report.sources.is_empty() {
                    p class="legend" {
                        "± is the expanded uncertainty: half of the 95 % interval. Digits in brackets, as in 0.0133(12), are \
                         the standard uncertainty in the last digits of the value, of which no interval is given where they stand alone. (bound): the constrained fit lies on a \
                         bound. —: the data do not determine the coefficient. †: no uncertainty is stated."
                    }
                }
            }
        }
    }

    /// Whether another result of the same source is the recommended one: the method's own table has both.
    fn is_beside_the_recommended(&self, section: &SourceSection) -> bool {
        let of = |s: &SourceSection| s.estimates.first().map(|e| e.source.clone());
        let is_other = |s: &SourceSection| s.name != section.name && of(s) == of(section) && recommended(s).is_some();
        recommended(section).is_none() && of(section).is_some() && self.report.sources.iter().any(is_other)
    }

    fn method(&mut self) -> Markup {
        if self.report.method.is_empty() {
            return Markup::default();
        }
        let heading = self.open("method", "Method", "");
        html! { section { (heading) @for paragraph in &self.report.method { p { (paragraph) } } } }
    }

    fn data(&mut self) -> Markup {
        let heading = self.open("data", "Data", "");
        let data = &self.report.data;
        if data.is_empty() {
            return html! { section { (heading) p { "No data file is recorded." } } };
        }
        let t = TableBuilder::new("", "Files that the numbers come from, with their fingerprints.", data);
        let mut columns = vec![t.text("", "File", |file| file.path.clone())];
        if data.iter().any(|file| file.source.is_some()) {
            columns.push(t.text("", "Source", |file| file.source.clone()));
        }
        if data.iter().any(|file| file.n_rows.is_some()) {
            columns.push(t.count("", "Rows", |file| file.n_rows));
        }
        if data.iter().any(|file| file.n_used.is_some()) {
            columns.push(t.count("", "Used", |file| file.n_used));
        }
        columns.push(t.text("", "SHA-256", |file| Some(file.sha256.clone()).filter(|hash| !hash.is_empty())));
        let table = table_markup(&t.build(columns), &mut self.tables);
        html! { section { (heading) (table) } }
    }

    fn findings(&mut self) -> Markup {
        let heading = self.open("findings", "Findings", "");
        if self.report.findings.is_empty() {
            return html! { section { (heading) p { "The checks found nothing to report." } } };
        }
        let parts = findings_by_severity(&self.report.findings, &mut self.tables);
        html! { section { (heading) (parts) } }
    }

    fn source(&mut self, i: usize) -> Markup {
        let report = self.report;
        let Some(source) = report.sources.get(i) else { return Markup::default() };
        let id = format!("source-{}", i + 1);
        let heading = self.open(&id, &source.name, &source.kind);
        let best = recommended(source);
        let shown = best.or_else(|| source.estimates.first());
        let mut parts: Vec<Markup> = Vec::new();

        if !source.estimates.is_empty() {
            parts.push(self.part("coefficients", "Coefficients"));
            parts.push(self.tables.coefficients(&source.name, &source.estimates));
            if let Some(best) = best {
                parts.push(self.tables.detail(best));
            }
            parts.push(determined(&source.estimates));
            // Where there is a selection table, it says what could not be cross-validated.
            parts.push(notes(&source.estimates, source.selection.is_empty()));
        }
        if self.has_figures_at(Place::Loads(i)) {
            parts.push(self.part("loads", "Loads and model"));
            parts.push(self.figures_at(Place::Loads(i)));
        }
        if self.has_figures_at(Place::Residuals(i)) {
            parts.push(self.part("residuals", "Residuals"));
            parts.push(self.figures_at(Place::Residuals(i)));
        }
        if !source.budget.is_empty() {
            parts.push(self.part("budget", "Uncertainty budget"));
            parts.push(improve_first(source));
            parts.push(self.figures_at(Place::Budget(i)));
            parts.push(self.tables.budget(source));
        }
        let has_contest = !source.selection.is_empty() || !source.not_fitted.is_empty();
        if has_contest || !source.tests.is_empty() {
            parts.push(self.part("selection", "Model selection"));
            if has_contest {
                parts.push(self.tables.selection(source));
            }
            if !source.tests.is_empty() {
                parts.push(self.tables.added_terms(source));
            }
        }
        if let Some(estimate) = shown
            && !estimate.validity.is_empty()
        {
            parts.push(self.part("validity", "Range of validity"));
            parts.push(self.tables.validity(estimate));
        }
        html! {
            section {
                (heading)
                @if !source.recommendation.is_empty() { p class="lead" { (source.recommendation) } }
                (facts(source, shown))
                @for part in &parts { (part) }
            }
        }
    }

    fn published(&mut self) -> Markup {
        let report = self.report;
        if report.published.is_empty() {
            return Markup::default();
        }
        let is_beside = !report.sources.is_empty();
        let heading = self.open("published", if is_beside { "Published coefficients" } else { "Records" }, "");
        let tables: Vec<Markup> = distinct(report.published.iter().map(|estimate| &estimate.source))
            .into_iter()
            .map(|source| {
                let own: Vec<Estimate> = report.published.iter().filter(|e| e.source == source).cloned().collect();
                html! { (self.tables.coefficients(source, &own)) (determined(&own)) (notes(&own, true)) }
            })
            .collect();
        html! {
            section {
                (heading)
                p { "As " @if is_beside { "published" } @else { "the records state them" } ". A value without an uncertainty is marked †: nothing is known about how far it can be trusted, \
                     which is not the same as being exact." }
                @for table in &tables { (table) }
            }
        }
    }

    fn side_by_side(&mut self) -> Markup {
        let report = self.report;
        let has_forest = self.has_figures_at(Place::Forest);
        if !has_forest && report.comparison.is_none() {
            return Markup::default();
        }
        let heading = self.open("comparison", "Sources side by side", "");
        let mut parts: Vec<Markup> = Vec::new();
        if report.comparison.is_some() {
            parts.push(html! { p { (SIDE_BY_SIDE) } });
        }
        if has_forest {
            parts.push(self.part("forest", "Coefficients by source"));
            parts.push(self.figures_at(Place::Forest));
        }
        if let Some(comparison) = &report.comparison {
            parts.push(self.part("differences", "Normalised differences"));
            parts.push(blocks(&side_by_side::blocks(comparison), &mut self.tables, &mut std::iter::empty()));
            let notes = comparison.findings.iter().map(|finding| &finding.message);
            parts.push(html! { @if !comparison.findings.is_empty() { ul class="plain" { @for note in notes { li { (note) } } } } });
        }
        html! { section { (heading) @for part in &parts { (part) } } }
    }

    fn citations(&mut self) -> Markup {
        if self.report.citations.is_empty() {
            return Markup::default();
        }
        let heading = self.open("citations", "How to cite", "");
        html! {
            section { (heading) ol class="citations" { @for work in &self.report.citations { li { (work) } } } }
        }
    }

    fn versions(&mut self) -> Markup {
        if self.report.versions.is_empty() {
            return Markup::default();
        }
        let heading = self.open("versions", "Versions", "");
        let rows: Vec<(&String, &String)> = self.report.versions.iter().collect();
        let t = TableBuilder::new(
            "",
            "Programs that made this report. Together with the fingerprints of the data they allow it to be reproduced.",
            &rows,
        );
        let columns = vec![
            t.text("", "Program", |(name, _)| (*name).clone()),
            t.text("", "Version", |(_, version)| (*version).clone()),
        ];
        let table = table_markup(&t.build(columns), &mut self.tables);
        html! { section { (heading) (table) } }
    }
}

/// Blocks in their order; `pictures` are those of their figures.
fn blocks(blocks: &[Block], tables: &mut Tables, pictures: &mut dyn Iterator<Item = Markup>) -> Markup {
    let each = blocks.iter().map(|block| match block {
        Block::Text { texts, .. } => html! { @for text in texts { p { (text) } } },
        Block::Table(table) => table_markup(table, tables),
        Block::Section(section) if section.is_detail => {
            let inner = self::blocks(&section.blocks, tables, pictures);
            html! { details { summary { (section.title) } (inner) } }
        }
        Block::Section(section) => {
            let inner = self::blocks(&section.blocks, tables, pictures);
            html! { h3 { (section.title) } (inner) }
        }
        Block::Estimates(_) => Markup::default(),
        Block::Chart(_) | Block::Map(_) | Block::Field(_) => pictures.next().unwrap_or_default(),
    });
    let parts: Vec<Markup> = each.collect();
    html! { @for part in &parts { (part) } }
}

fn summary_of(i: usize, source: &SourceSection) -> Markup {
    let best = recommended(source);
    let reason = if source.recommendation.is_empty() {
        best.and_then(|e| e.reason.as_deref()).unwrap_or("")
    } else {
        &source.recommendation
    };
    html! {
        article {
            h3 {
                a href={ "#source-" (i + 1) } { (source.name) }
                @match best {
                    Some(best) => span class="chosen" { "model " (best.law.name) },
                    None => span class="chosen" { "no model is recommended" },
                }
                span class="kind" {
                    (source.kind)
                    @if let Some(best) = best {
                        @if best.n_observations > 0 { " · " (counted(best.n_observations, "observation", "observations")) }
                        @for (component, sigma) in &best.sigma {
                            @if sigma.value.is_finite() {
                                " · " (tables::sigma(component, &sigma.unit)) " " (number::significant(sigma.value, 2))
                                (html_unit(&sigma.unit))
                            }
                        }
                    }
                }
            }
            @if !reason.is_empty() { p class="reason" { (reason) } }
            @if let Some(best) = best {
                ul class="keys" {
                    @for (name, c) in &best.coefficients {
                        li {
                            (tables::named(name, c)) span { (tables::expanded(c, best)) }
                            @if let Some(ends) = tables::wider_range(c) { span class="kind" { "range " (number::interval(ends)) } }
                        }
                    }
                }
            }
        }
    }
}

/// Facts that the caller gives, and what the coefficients refer to.
fn facts(source: &SourceSection, estimate: Option<&Estimate>) -> Markup {
    let mut rows: Vec<(String, Markup)> =
        source.facts.iter().map(|(name, value)| (name.clone(), html! { (value) })).collect();
    let said: Vec<String> = rows.iter().map(|(name, _)| name.to_lowercase()).collect();
    let measured = |m: &Measured| {
        html! { (number::plain(m.value, 6)) @if m.unit != "1" { " " (unit_text(&m.unit)) } }
    };
    let mut add = |name: &str, value: Markup| {
        if !said.contains(&name.to_lowercase()) {
            rows.push((name.to_owned(), value));
        }
    };
    if let Some(e) = estimate {
        if !e.method.words.is_empty() {
            add("Method", html! { (e.method.words) });
        }
        add("Covariance", html! { (e.covariance_kind()) });
        if !e.frame.words.is_empty() {
            add("Axes", html! { (e.frame.words) });
        }
        if !e.point.words.is_empty() {
            add("Reference point", html! { (e.point.words) });
        }
        if let Some(density) = e.density() {
            add("Density", measured(density));
        }
        let geometry: Vec<(&String, &Measured)> = e.refers_to.iter().filter(|(name, _)| *name != "density").collect();
        let list = |entries: &[(&String, &Measured)]| {
            html! {
                @for (i, (name, m)) in entries.iter().enumerate() {
                    @if i > 0 { "; " }
                    (name.replace('_', " ")) " " (measured(m))
                }
            }
        };
        if !geometry.is_empty() {
            add("Geometry", list(&geometry));
        }
        if !e.law.constants.is_empty() {
            let constants = html! {
                @for (i, (name, m)) in e.law.constants.iter().enumerate() {
                    @if i > 0 { "; " }
                    (html_symbol(name)) " = " (measured(m))
                }
            };
            add("Constants of the law", constants);
        }
        for (load, formula) in &e.law.formulas() {
            add(&format!("Formula of {load}"), html! { code { (load) " = " (formula) } });
        }
    }
    html! {
        @if !rows.is_empty() {
            dl class="facts" { @for (name, value) in &rows { dt { (name) } dd { (value) } } }
        }
    }
}

/// Combinations that the data do determine although their members are not.
fn determined(estimates: &[Estimate]) -> Markup {
    html! {
        @for e in estimates.iter().filter(|e| !e.undetermined.is_empty()) {
            p {
                "Model " (tables::called(e, &estimates.iter().collect::<Vec<_>>())) " is not determined coefficient by coefficient; determined are the combinations "
                @for (i, combination) in e.undetermined.iter().enumerate() {
                    @if i > 0 { ", " }
                    code { (combination) }
                }
                "."
            }
        }
    }
}

/// Sentences of the diagnostics, by model.
fn notes(estimates: &[Estimate], with_cross_validation: bool) -> Markup {
    let all: Vec<&Estimate> = estimates.iter().collect();
    let rows: Vec<(&str, &str)> = estimates
        .iter()
        .flat_map(|e| {
            let note = e.diagnostics.cross_validation_note.as_deref().filter(|_| with_cross_validation);
            let name = tables::called(e, &all);
            e.diagnostics.notes.iter().map(String::as_str).chain(note).map(move |n| (name, n))
        })
        .collect();
    // The same sentence of several models is printed once.
    let mut printed: Vec<(Vec<&str>, &str)> = Vec::new();
    for (model, note) in rows {
        match printed.iter_mut().find(|(_, n)| *n == note) {
            Some((models, _)) => models.push(model),
            None => printed.push((vec![model], note)),
        }
    }
    html! {
        @if !printed.is_empty() {
            ul class="plain" { @for (models, note) in &printed { li { b { (models.join(", ")) } ": " (note) } } }
        }
    }
}

/// The sentence that says which input contributes most.
fn improve_first(source: &SourceSection) -> Markup {
    let rows = budget_rows(source);
    let ranked = ranked_inputs(&rows);
    let model = rows.first().map_or("", |r| r.model.as_str());
    html! {
        @if let Some((input, part)) = ranked.first() {
            p class="lead" {
                "Largest contribution: " b { (input) } ", " (number::percent(*part))
                " of the variance, averaged over the coefficients of model " (model)
                @if let Some((next, part)) = ranked.get(1) { "; next: " (next) ", " (number::percent(*part)) }
                "."
            }
        }
    }
}
