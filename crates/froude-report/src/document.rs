//! A page of sections with paragraphs, tables and charts, in the style of the report.
//!
//! For results that are not a fit of loads: a carriage's identification, its drag, its tuning. The caller says every word and
//! every number; nothing is computed here.

use froude_records::finding::Finding;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::visible;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::chart;
use crate::error::ReportError;
use crate::findings::findings_by_severity;
use crate::style::{POLICY, STYLE};
use crate::tables::Tables;

/// Cells longer than this are sentences, and break into lines.
const WORDS: usize = 44;

/// A page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// What sort of page, above the title: `Carriage · drag from motor current`.
    pub sort: String,
    /// Title.
    pub title: String,
    /// Second line.
    pub subtitle: String,
    /// Date as text.
    pub date: Option<String>,
    /// Sections in order; the first is the summary.
    pub sections: Vec<DocumentSection>,
    /// What the checks found.
    pub findings: Vec<Finding>,
}

impl Document {
    /// The page as one self-contained HTML file.
    ///
    /// # Errors
    ///
    /// [`ReportError::Figure`] when the drawing library refuses a chart.
    pub fn html(&self) -> Result<String, ReportError> {
        let mut figure = 0;
        let mut tables = Tables::default();
        let mut body = Vec::new();
        for (i, section) in self.sections.iter().enumerate() {
            body.push(section_markup(i, section, &mut tables, &mut figure)?);
        }
        let findings = findings_by_severity(&self.findings, &mut tables);
        let contents = html! {
            ol {
                @for (i, section) in self.sections.iter().enumerate() {
                    li { a href={ "#section-" (i + 1) } { span { (i + 1) } (section.title) } }
                }
                @if !self.findings.is_empty() { li { a href="#findings" { span {} "Findings" } } }
            }
        };
        let main = html! {
            header class="title" {
                p class="sort" { (self.sort) }
                h1 { (self.title) }
                @if !self.subtitle.is_empty() { p class="subtitle" { (self.subtitle) } }
                @if let Some(date) = &self.date { p class="meta" { span { (date) } } }
            }
            @for part in &body { (part) }
            @if !self.findings.is_empty() {
                section { h2 id="findings" { "Findings" } (findings) }
            }
        };
        Ok(sheet(&self.title, &contents, &main))
    }
}

/// A page around its contents: everything stands in it.
pub(crate) fn sheet(title: &str, contents: &Markup, main: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content="Froude";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                div class="sheet" {
                    nav aria-label="Sections" { p { "Contents" } (contents) }
                    main { (main) }
                }
            }
        }
    };
    visible(&page.into_string()).into_owned()
}

fn section_markup(
    i: usize,
    section: &DocumentSection,
    tables: &mut Tables,
    figure: &mut usize,
) -> Result<Markup, ReportError> {
    let pictures = section.charts.iter().map(chart::svg).collect::<Result<Vec<_>, _>>()?;
    Ok(html! {
        section {
            h2 id={ "section-" (i + 1) } { span class="n" { (i + 1) } (section.title) }
            (section_text(section, tables))
            @for (chart, svg) in section.charts.iter().zip(&pictures) {
                figure {
                    (PreEscaped(svg))
                    figcaption { b { "Figure " (count(figure)) ". " } (chart.caption) }
                }
            }
        }
    })
}

/// Paragraphs and tables.
pub(crate) fn section_text(section: &DocumentSection, tables: &mut Tables) -> Markup {
    html! {
        @for paragraph in &section.paragraphs { p { (paragraph) } }
        @for t in &section.tables { (table_markup(t, tables)) }
    }
}

pub(crate) fn table_markup(table: &TextTable, tables: &mut Tables) -> Markup {
    let caption = tables.caption(&table.caption);
    let is_words =
        |column: usize| table.rows.iter().any(|row| row.get(column).is_some_and(|c| c.chars().count() > WORDS));
    let class: Vec<&str> =
        (0..table.head.len()).map(|column| if is_words(column) { "message" } else { "num" }).collect();
    let class_of = |column: usize| class.get(column).copied().unwrap_or("num");
    html! {
        div class="table wide" {
            table class=[class.contains(&"message").then_some("named")] {
                (caption)
                thead {
                    tr {
                        @for (i, head) in table.head.iter().enumerate() {
                            th scope="col" class=[(i > 0).then(|| class_of(i))] { (head) }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr {
                            @for (i, cell) in row.iter().enumerate() {
                                @if i == 0 { th scope="row" { (cell) } } @else { td class=(class_of(i)) { (cell) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

pub(crate) fn count(n: &mut usize) -> usize {
    *n += 1;
    *n
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_records::page::Chart;

    #[test]
    fn every_word_of_a_document_is_escaped_and_stands_in_the_page() {
        let page = Document {
            title: "Drag of <body>".to_owned(),
            sections: vec![DocumentSection {
                title: "Summary".to_owned(),
                paragraphs: vec!["D_d = 20.1 N s²/m²".to_owned()],
                tables: vec![TextTable {
                    caption: "By method.".to_owned(),
                    head: vec!["method".to_owned(), "D_d [N s²/m²]".to_owned()],
                    rows: vec![vec!["MCD & FSM".to_owned(), "20.1 ± 0.2".to_owned()]],
                }],
                charts: vec![Chart::default()],
            }],
            ..Document::default()
        }
        .html()
        .unwrap();
        for text in ["Drag of &lt;body&gt;", "MCD &amp; FSM", "Table 1", "Figure 1", "20.1 ± 0.2"] {
            assert!(page.contains(text), "{text} is missing");
        }
        assert!(!page.contains("<script"));
    }
}
