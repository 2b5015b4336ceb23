//! The page of what a verb returns: its blocks in order, what its checks found behind them.

use froude_records::block::{Block, Section};
use froude_records::outcome::{Head, Outcome};
use maud::{Markup, PreEscaped, html};

use crate::error::ReportError;
use crate::findings::findings_by_severity;
use crate::sheet::{count, sheet};
use crate::tables::counter::Tables;
use crate::tables::typed::table_markup;
use crate::{chart, field, map};

/// An outcome as one self-contained HTML file.
///
/// # Errors
///
/// [`ReportError::Figure`] when the numbers of a map are not those of its axes.
pub fn page(outcome: &Outcome, head: &Head) -> Result<String, ReportError> {
    let mut numbers = Numbers::default();
    let is_section = |block: &&Block| matches!(block, Block::Section(_));
    let (sections, summary): (Vec<&Block>, Vec<&Block>) = outcome.blocks.iter().partition(is_section);
    let mut parts = vec![(head.summary.as_str(), numbers.markup(&summary)?)];
    for block in sections {
        let Block::Section(Section { title, blocks, .. }) = block else { continue };
        parts.push((title.as_str(), numbers.markup(&blocks.iter().collect::<Vec<_>>())?));
    }
    let found = outcome.findings.as_deref().unwrap_or_default();
    if !found.is_empty() {
        parts.push(("Findings", findings_by_severity(found, &mut numbers.tables)));
    }
    let contents = html! {
        ol { @for (i, (title, _)) in parts.iter().enumerate() { li { a href={ "#section-" (i + 1) } { span { (i + 1) } (title) } } } }
    };
    let main = html! {
        header class="title" {
            p class="sort" { (head.sort) }
            h1 { (head.title) }
            @if !head.subtitle.is_empty() { p class="subtitle" { (head.subtitle) } }
            @if let Some(date) = &head.date { p class="meta" { span { (date) } } }
        }
        @for (i, (title, part)) in parts.iter().enumerate() {
            section {
                h2 id={ "section-" (i + 1) } { span class="n" { (i + 1) } (title) }
                (part)
            }
        }
    };
    Ok(sheet(&head.title, &contents, &main))
}

/// Tables and figures are numbered through.
#[derive(Default)]
struct Numbers {
    tables: Tables,
    figures: usize,
}

impl Numbers {
    fn markup(&mut self, blocks: &[&Block]) -> Result<Markup, ReportError> {
        let each = blocks.iter().map(|block| {
            Ok(match block {
                Block::Text { texts, .. } => html! { @for text in texts { p { (text) } } },
                Block::Table(table) => table_markup(table, &mut self.tables),
                Block::Chart(chart) => self.figure(&chart::svg(chart), &chart.caption),
                Block::Map(map) => self.figure(&map::svg(map)?, &map.caption),
                Block::Field(field) => self.figure(&field::svg(field), &field::caption(field)),
                Block::Estimates(_) => Markup::default(),
                Block::Section(section) => {
                    let inner = self.markup(&section.blocks.iter().collect::<Vec<_>>())?;
                    html! { h3 { (section.title) } (inner) }
                }
            })
        });
        let parts = each.collect::<Result<Vec<Markup>, ReportError>>()?;
        Ok(html! { @for part in &parts { (part) } })
    }

    fn figure(&mut self, svg: &str, caption: &str) -> Markup {
        html! { figure { (PreEscaped(svg)) figcaption { b { "Figure " (count(&mut self.figures)) ". " } (caption) } } }
    }
}
