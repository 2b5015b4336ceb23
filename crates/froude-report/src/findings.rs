//! The findings of a page.

use froude_records::finding::{Finding, Severity};
use maud::{Markup, html};

use crate::tables::counter::Tables;

/// A table of findings for each severity, the gravest first.
pub(crate) fn findings_by_severity(findings: &[Finding], tables: &mut Tables) -> Markup {
    let groups = [
        (
            Severity::Error,
            "Errors",
            "error",
            "contradict physics or the file itself: do not use the numbers as they are.",
        ),
        (Severity::Warning, "Warnings", "warning", "check these before trusting the numbers."),
        (Severity::Note, "Notes", "note", "worth knowing; nothing was changed because of them."),
    ];
    let mut parts = Vec::new();
    for (severity, word, class, meaning) in groups {
        let group: Vec<&Finding> = findings.iter().filter(|f| f.severity == severity).collect();
        if !group.is_empty() {
            let caption = tables.caption(&format!("{word}: {meaning}"));
            parts.push(findings_table(&group, class, &caption));
        }
    }
    html! { @for part in &parts { (part) } }
}

pub(crate) fn findings_table(group: &[&Finding], class: &str, caption: &Markup) -> Markup {
    let has_source = group.iter().any(|f| f.source.is_some());
    let has_place = group.iter().any(|f| f.place.is_some());
    html! {
        div class="table wide" {
            table {
                (caption)
                thead {
                    tr {
                        th scope="col" { "Check" }
                        @if has_source { th scope="col" { "Source" } }
                        th scope="col" { "Finding" }
                        @if has_place { th scope="col" { "Place" } }
                    }
                }
                tbody {
                    @for finding in group {
                        tr {
                            th scope="row" { span class={ "tag " (class) } { (finding.code) } }
                            @if has_source { td { (finding.source.as_deref().unwrap_or("")) } }
                            td class="message" { (finding.message) }
                            @if has_place {
                                td class="place" { @if let Some(place) = &finding.place { code { (place) } } }
                            }
                        }
                    }
                }
            }
        }
    }
}
