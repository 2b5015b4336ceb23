//! Results as a person reads them, and as JSON.

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table};
use froude::identify::answer::Answer;
use froude::identify::source::SourceResult;
use froude::inspect::{ChannelFacts, ColumnFacts, Inspection, SourceFacts};
use froude::pipeline::{Outcome, Summary};
use froude::records::block::{Block, laid_out};
use froude::records::estimate::{Diagnostics, Estimate, Status};
use froude::records::finding::{Finding, Severity};
use froude::records::number;
use froude::records::outcome::{Exit, Outcome as Answered};
use froude::records::page::TextTable;
use froude::records::text::{counted, visible, visible_json};
use froude::results::Written;

use crate::cells::{WIDEST, cell, right, sentence, table};
use crate::failure::Failure;
use crate::out::say;
use crate::side_by_side::{comparison, verdicts};

/// One JSON document on standard output.
pub fn json<T: serde::Serialize>(value: &T) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::Json)?;
    // As JSON's own escapes: what a program reads is the same.
    say!("{}", visible_json(&text));
    Ok(())
}

/// The coefficient tables or the summaries, records side by side, the findings, and where the report lies.
pub fn outcome(outcome: &Outcome, all: bool) {
    for of_none in outcome.summaries.iter().filter(|summary| summary.sources.is_empty()) {
        blocks_after(&of_none.section.blocks, &mut true);
    }
    for (i, result) in outcome.sources.iter().enumerate() {
        match outcome.summaries.iter().find(|summary| summary.sources.contains(&i)) {
            Some(Summary { sources, section }) if sources.start == i => blocks_after(&section.blocks, &mut true),
            Some(_) => {}
            None => source(result),
        }
    }
    match &outcome.file.comparison {
        Some(c) if outcome.sources.is_empty() => comparison(c, all),
        Some(c) if !c.coefficients.is_empty() => {
            say!("\nThe sources are compared in the report.");
            verdicts(c);
        }
        _ => {}
    }
    findings(&outcome.file.findings);
    if let Some(written) = &outcome.written {
        self::written(written);
    }
}

/// What a verb returns, for a person or as one JSON document.
pub fn answer(answer: &Answered, is_json: bool) -> Result<(), Failure> {
    if is_json {
        json(&answer.json())?;
    } else {
        blocks(&answer.blocks);
        if let Some(found) = &answer.findings {
            findings(found);
        }
        if !answer.files.is_empty() {
            say!("");
        }
        for file in &answer.files {
            say!("{:<10} {}", file.key.trim_end_matches("[]"), file.path.display());
        }
    }
    match &answer.exit {
        Exit::Done => Ok(()),
        Exit::Failed(why) => Err(Failure::Part(why.clone())),
        Exit::Refused(why) => Err(Failure::Refused(why.clone())),
        Exit::Stopped(why) => Err(Failure::Stopped(why.clone())),
    }
}

/// The blocks of an answer, with an empty line between them.
pub fn blocks(all: &[Block]) {
    blocks_after(all, &mut false);
}

/// `is_begun` says whether something stands above.
fn blocks_after(all: &[Block], is_begun: &mut bool) {
    let gap = |is_begun: &mut bool| {
        if std::mem::replace(is_begun, true) {
            say!("");
        }
    };
    for block in all {
        match block {
            Block::Text { texts, .. } if !texts.is_empty() => {
                gap(is_begun);
                for text in texts {
                    say!("{text}");
                }
            }
            Block::Table(table) => {
                let Some(table) = laid_out(table).filter(|table| !table.rows.is_empty()) else { continue };
                gap(is_begun);
                if !table.caption.is_empty() {
                    say!("{}", wrapped(&table.caption));
                }
                text_table(&table);
            }
            Block::Section(section) if !section.is_detail => blocks_after(&section.blocks, is_begun),
            Block::Text { .. } | Block::Section(_) | Block::Chart(_) | Block::Map(_) | Block::Field(_) => {}
        }
    }
}

/// Where record and page lie.
pub fn written(Written { estimate, report, exports, .. }: &Written) {
    say!("\nestimates {}", estimate.display());
    say!("report    {}", report.display());
    for export in exports {
        say!("export    {}", export.display());
    }
}

fn source(answer: &Answer) {
    match answer.observations() {
        0 => say!("\n{}", answer.name()),
        n => say!("\n{} ({})", answer.name(), observations(n)),
    }
    if let Some(source) = answer.fitted() {
        choice(source);
    }
    // Of several models the recommended one; of a method's only one, that.
    let all = answer.estimates();
    let (shown, others): (Vec<&Estimate>, Vec<&Estimate>) = all.iter().partition(|e| e.recommended || all.len() == 1);
    for estimate in shown {
        say!("{}", coefficients(estimate));
        for combination in &estimate.undetermined {
            say!("  determined only together: {combination}");
        }
    }
    let others: Vec<&str> = others.into_iter().map(|e| e.law.name.as_str()).collect();
    if !others.is_empty() {
        say!("  also fitted: {} (see the report)", others.join(", "));
    }
    for n in answer.fitted().iter().flat_map(|source| &source.not_fitted) {
        say!("  not fitted: {}: {}", n.model, n.why);
    }
}

/// Which of the fitted models, and why.
fn choice(source: &SourceResult) {
    if let Some(r) = &source.recommendation {
        let is_recommended = source.estimates[r.index].recommended;
        say!("  {}: {}", if is_recommended { "recommended" } else { "method" }, r.reason);
        if let Some(why) = source.scores[r.index].note.as_ref().filter(|_| source.data.configurations().len() > 1) {
            say!("  cross-validation: {why}");
        }
    }
}

fn observations(n: usize) -> String {
    counted(n, "observation", "observations")
}

fn coefficients(estimate: &Estimate) -> Table {
    let has_others = estimate.not_contradicted.len() > 1;
    let intervals =
        if has_others { &["95 % interval if law is true", "range over laws"][..] } else { &["95 % interval"] };
    let mut out = table(&[&["coefficient", "value", "unit"], intervals, &["type A", "type B", "status"]].concat());
    let ends = |ends: Option<[f64; 2]>| right(ends.map_or("—".to_owned(), number::interval));
    for (name, c) in &estimate.coefficients {
        let mut row = vec![cell(name), right(number::coefficient(c)), cell(&c.unit), ends(c.interval_95)];
        row.extend(has_others.then(|| ends(c.range_95)));
        row.extend([c.type_a, c.type_b].map(|x| right(x.map_or("—".to_owned(), |x| number::significant(x, 2)))));
        row.push(cell(status(c.status)));
        out.add_row(row);
    }
    out
}

fn status(s: Status) -> &'static str {
    match s {
        Status::Free => "",
        Status::AtBound => "at bound",
        Status::Fixed => "fixed",
        Status::Excluded => "excluded",
        Status::Prior => "with prior",
        Status::Undetermined => "not determined",
        Status::BoundContradicted => "bound contradicted",
    }
}

/// Findings, the gravest first.
pub fn findings(findings: &[Finding]) {
    if findings.is_empty() {
        say!("\nNo findings.");
        return;
    }
    say!("\nFindings");
    for f in findings {
        let grade = match f.severity {
            Severity::Error => "ERROR  ",
            Severity::Warning => "warning",
            Severity::Note => "note   ",
        };
        let source = f.source.as_ref().map_or(String::new(), |s| format!("{s}: "));
        say!("  {grade}  [{}] {source}{}", f.code, f.message);
    }
}

/// A text in lines of at most [`WIDEST`] characters.
pub fn wrapped(text: &str) -> String {
    wrap(text, usize::from(WIDEST))
}

/// What is in a file.
pub fn inspection(i: &Inspection) {
    say!("{}", i.kind);
    for (name, value) in &i.facts {
        sentence(&format!("{name}: {value}"));
    }
    if !i.columns.is_empty() {
        say!("{}", columns(&i.columns));
    }
    for source in &i.sources {
        source_facts(source);
    }
    for estimate in &i.estimates {
        estimate_facts(estimate);
    }
    findings(&i.findings);
}

fn columns(columns: &[ColumnFacts]) -> Table {
    let is_run = columns.iter().any(|c| c.channel.is_some());
    let of_run: &[&str] = if is_run { &["quantity", "positive along", "clock"] } else { &[] };
    let mut out = table(&[&["column", "unit", "from", "to", "distinct"], of_run].concat());
    for c in columns {
        let show = |x: Option<f64>| right(x.map_or(String::new(), |x| number::plain(x, 7)));
        let unit = if c.unit.is_empty() { "text" } else { &c.unit };
        let mut row = vec![cell(&c.name), cell(unit), show(c.low), show(c.high), right(c.distinct.to_string())];
        if let Some(ChannelFacts { quantity, frame, sign, clock }) = &c.channel {
            let along = if frame == "none" {
                "–".to_owned()
            } else {
                format!("{}{frame}", if *sign < 0 { "−" } else { "+" })
            };
            row.extend([cell(quantity), cell(along), cell(clock)]);
        }
        out.add_row(row);
    }
    out
}

fn source_facts(s: &SourceFacts) {
    say!("\nsource {} ({})", s.name, s.kind);
    let there = match (s.rows, s.kept, s.exists) {
        (Some(rows), Some(kept), _) if kept == rows => format!(", {}", observations(rows)),
        (Some(rows), Some(kept), _) => {
            format!(", {kept} of {} {} fitted", observations(rows), if kept == 1 { "is" } else { "are" })
        }
        (_, _, true) => String::new(),
        (_, _, false) => {
            let verb = match (s.input.as_str(), s.kind.as_str()) {
                ("cases", _) => "froude cfd plan",
                ("runs", "cfd") => "froude cfd swing",
                _ => "froude simulate",
            };
            format!(", not there yet: {verb} makes it")
        }
    };
    sentence(&format!("{}: {}{there}", s.input, s.path));
    if let Some(runs) = s.planned_runs {
        say!("  plan: {}", counted(runs, "run", "runs"));
    }
    let what = if s.input == "record" { "estimates" } else { "models" };
    if !s.models.is_empty() {
        sentence(&format!("{what}: {}", s.models.join(", ")));
    }
    if !s.columns.is_empty() {
        say!("{}", columns(&s.columns));
    }
    if s.input == "table" && s.budget.is_empty() {
        say!("  budget: none; without [[source.uncertainty]] the uncertainties include the scatter only");
    }
    if !s.budget.is_empty() {
        let mut out = table(&["budget", "standard", "shared by", "dof", "name"]);
        for b in &s.budget {
            out.add_row(vec![
                cell(&b.quantity),
                right(b.standard.clone()),
                cell(&b.shared),
                right(number::dof(b.dof.unwrap_or(f64::INFINITY))),
                cell(b.name.as_deref().unwrap_or("")),
            ]);
        }
        say!("{out}");
    }
}

fn estimate_facts(e: &Estimate) {
    say!("\n{}{}", e.id, if e.recommended { " (recommended)" } else { "" });
    if let Some(reason) = &e.reason {
        sentence(reason);
    }
    if e.not_contradicted.len() > 1 {
        sentence(&format!("laws of this source that the data do not contradict: {}", e.not_contradicted.join(", ")));
    }
    let mut about = vec![observations(e.n_observations)];
    about.extend(
        [e.kind.as_str(), &e.method.words, e.covariance_kind()]
            .into_iter()
            .filter(|t| !t.is_empty())
            .map(str::to_owned),
    );
    sentence(&about.join("; "));
    let head = ["coefficient", "value", "unit", "standard uncertainty", "95 % interval", "range", "status"];
    let mut out = table(&head);
    for (name, c) in &e.coefficients {
        let or_none = |x: Option<f64>, digits: usize| right(x.map_or("—".to_owned(), |x| number::plain(x, digits)));
        out.add_row(vec![
            cell(name),
            or_none(c.value, 5),
            cell(&c.unit),
            or_none(c.standard_uncertainty, 2),
            right(c.interval_95.map_or("—".to_owned(), number::interval)),
            right(c.range_95.map_or("—".to_owned(), number::interval)),
            cell(if c.status == Status::Free { "free" } else { status(c.status) }),
        ]);
    }
    say!("{out}");
    for combination in &e.undetermined {
        sentence(&format!("determined only together: {combination}"));
    }
    if !e.validity.is_empty() {
        let mut out = table(&["valid for", "from", "to", "unit"]);
        for (name, r) in &e.validity {
            let (low, high) = (right(number::plain(r.low, 5)), right(number::plain(r.high, 5)));
            out.add_row(vec![cell(name), low, high, cell(&r.unit)]);
        }
        say!("{out}");
    }
    for (name, value) in diagnostics(&e.diagnostics) {
        sentence(&format!("{name}: {value}"));
    }
}

/// The diagnostics that a record has, in words.
fn diagnostics(d: &Diagnostics) -> Vec<(&'static str, String)> {
    let by_load = |values: &mut dyn Iterator<Item = (&String, &f64)>| {
        values.map(|(load, x)| format!("{load} {}", number::plain(*x, 3))).collect::<Vec<_>>().join(", ")
    };
    let one = |x: Option<f64>| x.map_or(String::new(), |x| number::plain(x, 4));
    let correlation = d.largest_correlation.as_ref();
    let mut out = vec![
        ("relative residual", by_load(&mut d.relative_residual.iter())),
        ("Durbin–Watson", by_load(&mut d.durbin_watson.iter())),
        ("lack of fit, p", by_load(&mut d.lack_of_fit_p.iter())),
        ("cross-validation, rms error", by_load(&mut d.cross_validation_rmse.iter())),
        ("cross-validation", d.cross_validation_note.clone().unwrap_or_default()),
        ("AICc", one(d.aicc)),
        ("condition number", one(d.condition_number)),
        (
            "largest correlation",
            correlation
                .map_or(String::new(), |c| format!("{} of {} and {}", number::plain(c.value, 3), c.first, c.second)),
        ),
        ("largest leverage", one(d.largest_leverage)),
        ("largest power fed to the body (at most 0 where dissipative), W", one(d.largest_power_w)),
    ];
    out.extend(d.notes.iter().map(|note| ("note", note.clone())));
    out.retain(|(_, value)| !value.is_empty());
    out
}

/// A table whose cells are written already; numbers to the right. No word is broken: a table of long words is wider than [`WIDEST`].
pub fn text_table(text: &TextTable) {
    // Control characters are escaped before the text is wrapped: a carriage return would count as a space.
    let all = |cells: &[String]| cells.iter().map(|cell| visible(cell).into_owned()).collect::<Vec<_>>();
    let rows = text.rows.iter().map(|row| all(row)).collect();
    let text = TextTable { caption: String::new(), head: all(&text.head), rows };
    say!("{}", fitted(&text, usize::from(WIDEST)));
}

fn fitted(text: &TextTable, widest: usize) -> Table {
    let widths = widths(text, widest);
    let wrapped = |row: &[String]| -> Vec<String> {
        row.iter().enumerate().map(|(i, cell)| wrap(cell, widths.get(i).copied().unwrap_or(usize::MAX))).collect()
    };
    let mut out = Table::new();
    out.load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(wrapped(&text.head));
    for row in &text.rows {
        out.add_row(wrapped(row).into_iter().enumerate().map(|(i, cell)| {
            self::cell(cell).set_alignment(if i == 0 { CellAlignment::Left } else { CellAlignment::Right })
        }));
    }
    out
}

/// A first column up to this is not wrapped.
const LONGEST_NAME: usize = 24;

/// A width for each column: that of its longest word, and what is left of the line to the columns that would be wrapped most.
fn widths(text: &TextTable, widest: usize) -> Vec<usize> {
    let columns = || 0..text.head.len();
    let cells = |i: usize| std::iter::once(&text.head).chain(&text.rows).filter_map(move |row| row.get(i));
    let length = |t: &str| t.chars().count();
    let whole: Vec<usize> = columns().map(|i| cells(i).map(|c| length(c)).max().unwrap_or(0)).collect();
    let mut out: Vec<usize> =
        columns().map(|i| cells(i).flat_map(|c| words(c)).map(|w| length(&w)).max().unwrap_or(0)).collect();
    // A space on either side of each column.
    let mut left = widest.saturating_sub(out.iter().sum::<usize>() + 2 * out.len());
    // What names the row stays on one line, where it is a name and not a sentence.
    if let (Some(first), Some(&name)) = (out.first_mut(), whole.first())
        && name <= LONGEST_NAME
        && name - *first <= left
    {
        left -= name - *first;
        *first = name;
    }
    while left > 0 {
        let lines = |i: &usize| whole[*i] as f64 / out[*i].max(1) as f64;
        let Some(most) = columns().filter(|&i| out[i] < whole[i]).max_by(|a, b| lines(a).total_cmp(&lines(b))) else {
            break;
        };
        out[most] += 1;
        left -= 1;
    }
    out
}

/// Words, of which an interval, a unit in brackets or a number with thin spaces is one.
fn words(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let is_break = |c: char| c.is_whitespace() && !matches!(c, '\u{a0}' | '\u{202f}');
    for word in text.split(is_break).filter(|word| !word.is_empty()) {
        match out.last_mut().filter(|last| last.starts_with('[') && !last.contains(']')) {
            Some(open) => {
                open.push(' ');
                open.push_str(word);
            }
            None => out.push(word.to_owned()),
        }
    }
    out
}

/// The text in lines of at most `width` characters, broken between words only.
fn wrap(text: &str, width: usize) -> String {
    let (mut out, mut column) = (String::new(), 0);
    for word in words(text) {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > width {
            out.push('\n');
            column = 0;
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out += &word;
        column += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preflight() -> TextTable {
        let texts = |cells: &[&str]| cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>();
        let head = [
            "kind",
            "speed [m/s]",
            "direction",
            "time [s]",
            "steady [s]",
            "command [V]",
            "rms current [A]",
            "coast [m]",
        ];
        let row = ["excitation", "0.100", "backward", "123.4", "112.3", "12.34", "1.23", "0.123"];
        let named = ["calibration 10 N", "measured response", "backward", "123.4", "112.3", "12.34", "1.23", "0.123"];
        TextTable { caption: String::new(), head: texts(&head), rows: vec![texts(&row), texts(&named)] }
    }

    #[test]
    fn no_word_of_a_table_is_broken_at_any_width() {
        let table = preflight();
        let words: Vec<&str> =
            std::iter::once(&table.head).chain(&table.rows).flatten().flat_map(|c| c.split_whitespace()).collect();
        for widest in [10, 60, 80, 100, 120] {
            let printed = fitted(&table, widest).to_string();
            let found: Vec<&str> = printed.split_whitespace().collect();
            for word in &words {
                assert!(found.contains(word), "{word} at {widest} columns:\n{printed}");
            }
        }
    }

    #[test]
    fn a_table_is_as_wide_as_the_page_where_its_words_fit() {
        for widest in [90, 100, 120] {
            let printed = fitted(&preflight(), widest).to_string();
            let longest = printed.lines().map(|l| l.chars().count()).max().unwrap_or(0);
            assert!(longest <= widest, "{longest} of {widest}:\n{printed}");
        }
    }
}
