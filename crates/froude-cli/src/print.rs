//! Results as a person reads them, and as JSON.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table};
use froude::Error;
use froude::identify::compare::{CoefficientRow, Comparison, ForceRow, JointRow, Stated, coverage_note};
use froude::inspect::{ChannelFacts, ColumnFacts, Inspection, SourceFacts};
use froude::pipeline::Outcome;
use froude::records::estimate::{Diagnostics, Estimate, Status};
use froude::records::finding::{Finding, Severity};
use froude::records::text::{counted, visible_json};
use froude::report::number;

use crate::out::say;

/// One JSON document on standard output.
pub fn json<T: serde::Serialize>(value: &T) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::Nothing(format!("the result cannot be written as JSON: {e}")))?;
    // As JSON's own escapes: what a program reads is the same.
    say!("{}", visible_json(&text));
    Ok(())
}

/// Widest line of a table: what a printed page and most terminals hold.
const WIDEST: u16 = 120;

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDEST)
        .set_header(header.iter().map(cell));
    table
}

/// Longest text of a cell, in characters: the table is laid out letter by letter.
const LONGEST_CELL: usize = 1000;

/// A cell; of a text that no table can show, its beginning.
fn cell(text: impl ToString) -> Cell {
    let text = text.to_string();
    match text.char_indices().nth(LONGEST_CELL) {
        Some((end, _)) => Cell::new(format!("{}…", &text[..end])),
        None => Cell::new(text),
    }
}

fn right(text: String) -> Cell {
    cell(text).set_alignment(CellAlignment::Right)
}

/// The coefficient tables, the findings, and where the report lies.
pub fn outcome(outcome: &Outcome) {
    for source in &outcome.sources {
        say!("\n{} ({})", source.name, observations(source.data.rows));
        if let Some(r) = &source.recommendation {
            let is_recommended = source.estimates[r.index].recommended;
            say!("  {}: {}", if is_recommended { "recommended" } else { "method" }, r.reason);
            if let Some(why) = source.scores[r.index].note.as_ref().filter(|_| source.data.configurations().len() > 1) {
                say!("  cross-validation: {why}");
            }
        }
        // Of several models the recommended one; of a method's only one, that.
        let (shown, others): (Vec<&Estimate>, Vec<&Estimate>) =
            source.estimates.iter().partition(|e| e.recommended || source.estimates.len() == 1);
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
        for n in &source.not_fitted {
            say!("  not fitted: {}: {}", n.model, n.why);
        }
    }
    if !outcome.comparison.coefficients.is_empty() {
        say!("\nThe sources are compared in the report (E_n, χ², predicted forces).");
    }
    findings(&outcome.file.findings);
    say!("\nestimates {}", outcome.estimate.display());
    say!("report    {}", outcome.report.display());
}

fn observations(n: usize) -> String {
    counted(n, "observation", "observations")
}

fn coefficients(estimate: &Estimate) -> Table {
    let mut out = table(&["coefficient", "value", "unit", "95 % interval", "type A", "type B", "status"]);
    for (name, c) in &estimate.coefficients {
        out.add_row(vec![
            cell(name),
            right(number::coefficient(c)),
            cell(&c.unit),
            right(c.interval_95.map_or("—".to_owned(), number::interval)),
            right(c.type_a.map_or("—".to_owned(), |x| number::significant(x, 2))),
            right(c.type_b.map_or("—".to_owned(), |x| number::significant(x, 2))),
            cell(status(c.status)),
        ]);
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

/// Prints a sentence in lines of at most [`WIDEST`] characters, two spaces in.
fn sentence(text: &str) {
    let mut line = " ".to_owned();
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > usize::from(WIDEST) && !line.trim().is_empty() {
            say!("{line}");
            line.clear();
            line.push_str("   ");
        }
        line = line + " " + word;
    }
    say!("{line}");
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
    let of_run: &[&str] = if is_run { &["quantity", "along", "clock"] } else { &[] };
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
        (_, _, false) => ", not there yet: froude simulate makes it".to_owned(),
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
        say!("  budget: none; without [[source.uncertainty]] the uncertainties hold the scatter alone");
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
    let mut about = vec![observations(e.n_observations)];
    about.extend(
        [e.kind.as_str(), &e.method.words, e.covariance_kind()]
            .into_iter()
            .filter(|t| !t.is_empty())
            .map(str::to_owned),
    );
    sentence(&about.join("; "));
    let mut out = table(&["coefficient", "value", "unit", "standard uncertainty", "95 % interval", "status"]);
    for (name, c) in &e.coefficients {
        let or_none = |x: Option<f64>, digits: usize| right(x.map_or("—".to_owned(), |x| number::plain(x, digits)));
        out.add_row(vec![
            cell(name),
            or_none(c.value, 5),
            cell(&c.unit),
            or_none(c.standard_uncertainty, 2),
            right(c.interval_95.map_or("—".to_owned(), number::interval)),
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
        ("largest power to the body, W", one(d.largest_power_w)),
    ];
    out.extend(d.notes.iter().map(|note| ("note", note.clone())));
    out.retain(|(_, value)| !value.is_empty());
    out
}

/// Widest table; a wider one is wrapped or told in blocks.
const MOST_CHARACTERS: u16 = 118;
/// Widest head of a force column; a longer name is wrapped.
const MOST_OF_A_HEAD: usize = 28;

/// A table of a comparison, never wider than [`MOST_CHARACTERS`] or the terminal.
fn narrow(header: &[String]) -> Table {
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let mut out = table(&header);
    out.load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    out.set_width(out.width().map_or(MOST_CHARACTERS, |w| w.min(MOST_CHARACTERS)));
    out
}

/// Value and expanded uncertainty, digits after the uncertainty; the value alone where none is stated.
fn value_and_uncertainty(s: &Stated) -> String {
    match (s.value, s.expanded()) {
        (Some(value), Some(u)) => number::plus_minus(value, u),
        (Some(value), None) => number::plain(value, 5),
        (None, _) => number::MISSING.to_owned(),
    }
}

fn normalised(e_n: &Result<f64, String>) -> String {
    e_n.as_ref().map_or_else(|_| number::MISSING.to_owned(), |e| number::fixed(*e, 2))
}

/// Reasons in the order of appearance, each once.
fn reasons<'a>(results: impl Iterator<Item = &'a Result<f64, String>>) -> Vec<&'a str> {
    let mut out: Vec<&str> = Vec::new();
    for reason in results.filter_map(|r| r.as_ref().err()) {
        if !out.contains(&reason.as_str()) {
            out.push(reason);
        }
    }
    out
}

/// Sources side by side.
pub fn comparison(c: &Comparison, all: bool) {
    let recommended = |id: &str| c.force_ids.iter().any(|f| f == id);
    let is_shown =
        |r: &CoefficientRow| all || c.coefficients.len() <= 40 || (recommended(&r.first) && recommended(&r.second));
    let (shown, hidden): (Vec<_>, Vec<_>) = c.coefficients.iter().partition(|r| is_shown(r));
    for pair in shown.chunk_by(|a, b| a.first == b.first && a.second == b.second) {
        coefficient_pair(pair);
        let own = |j: &&JointRow| pair.iter().any(|r| r.first == j.first && r.second == j.second);
        for j in c.joint.iter().filter(own) {
            match &j.result {
                Ok((chi2, dof, p)) => say!(
                    "  jointly: χ² = {} with {}, p {}{}",
                    number::significant(*chi2, 3),
                    number::degrees_of_freedom(*dof as f64),
                    if *p < 0.001 { "" } else { "= " },
                    number::p_value(*p)
                ),
                // A missing uncertainty has been named with the missing E_n.
                Err(why) if reasons(pair.iter().map(|r| &r.e_n)).contains(&why.as_str()) => {}
                Err(why) => say!("  no joint χ²: {why}"),
            }
        }
    }
    if !hidden.is_empty() {
        let further = counted(hidden.len(), "further pair of coefficients", "further pairs of coefficients");
        say!("\n{further}; --all prints {}", if hidden.len() == 1 { "it" } else { "them" });
    }
    if !c.forces.is_empty() {
        forces(c);
    }
    findings(&c.findings);
}

/// The coefficients that two estimates share, a column each.
fn coefficient_pair(rows: &[&CoefficientRow]) {
    let Some(one) = rows.first() else { return };
    let has_e_n = rows.iter().any(|r| r.e_n.is_ok());
    say!("\nModel {}", one.model);
    let (first, second) = if one.first == one.second {
        (format!("1: {}", one.first), format!("2: {}", one.second))
    } else {
        (one.first.clone(), one.second.clone())
    };
    let is_stated = rows.iter().any(|r| r.by_first.standard.is_some() || r.by_second.standard.is_some());
    let head = |id: String| if is_stated { format!("{id}, ± U") } else { id };
    let mut header = vec!["coefficient".to_owned(), "unit".to_owned(), head(first), head(second)];
    if has_e_n {
        header.push("E_n".to_owned());
    }
    let mut out = narrow(&header);
    for r in rows {
        let mut row = vec![
            cell(&r.coefficient),
            cell(&r.unit),
            right(value_and_uncertainty(&r.by_first)),
            right(value_and_uncertainty(&r.by_second)),
        ];
        if has_e_n {
            row.push(right(normalised(&r.e_n)));
        }
        out.add_row(row);
    }
    say!("{out}");
    if is_stated {
        say!("  ± U: expanded uncertainty, 95 %, U = k·u");
        say!("    {}", coverage_note(&one.first, rows.iter().map(|r| &r.by_first)));
        if one.first != one.second {
            say!("    {}", coverage_note(&one.second, rows.iter().map(|r| &r.by_second)));
        }
    }
    for why in reasons(rows.iter().map(|r| &r.e_n)) {
        say!("  no E_n: {why}");
    }
}

/// Predicted forces: a column per estimate, in blocks that fit beside each other.
fn forces(c: &Comparison) {
    say!("\nPredicted force over the common range");
    let has_links = c.forces.iter().any(|r| r.n_links.is_some());
    let mut place = vec!["load".to_owned()];
    if has_links {
        place.push("links".to_owned());
    }
    place.extend(["speed [m/s]".to_owned(), "angle [deg]".to_owned()]);
    let at = |r: &ForceRow| {
        let mut row = vec![cell(&r.component)];
        if has_links {
            row.push(right(r.n_links.map_or_else(String::new, |k| format!("{k}"))));
        }
        row.push(right(format!("{:.3}", r.speed_m_s)));
        row.push(right(format!("{:.1}", r.angle_rad.to_degrees())));
        row
    };
    let columns: Vec<Vec<(String, Vec<String>)>> =
        c.force_ids.iter().enumerate().map(|(i, id)| force_columns(c, i, id)).collect();
    let width = |(head, cells): &(String, Vec<String>)| {
        let cell = cells.iter().map(|t| t.chars().count()).max().unwrap_or(0);
        cell.max(head.chars().count().min(MOST_OF_A_HEAD)) + 2
    };
    let room = usize::from(MOST_CHARACTERS) - place.iter().map(|p| p.len() + 2).sum::<usize>();
    let mut blocks: Vec<Vec<&(String, Vec<String>)>> = Vec::new();
    let mut left = 0;
    for own in &columns {
        let wanted: usize = own.iter().map(width).sum();
        if blocks.is_empty() || wanted > left {
            blocks.push(Vec::new());
            left = room;
        }
        left = left.saturating_sub(wanted);
        if let Some(block) = blocks.last_mut() {
            block.extend(own);
        }
    }
    for block in blocks {
        let mut header = place.clone();
        header.extend(block.iter().map(|(head, _)| head.clone()));
        let mut out = narrow(&header);
        for (i, r) in c.forces.iter().enumerate() {
            let mut row = at(r);
            row.extend(block.iter().map(|(_, cells)| right(cells[i].clone())));
            out.add_row(row);
        }
        say!("{out}");
    }
    if c.forces.iter().flat_map(|r| &r.forces).any(|f| f.standard.is_some()) {
        say!("  ± U: expanded uncertainty, 95 %, U = k·u");
    }
    for note in c.coverage_notes() {
        say!("    {note}");
    }
    for (j, id) in c.force_ids.iter().enumerate().skip(1) {
        // A missing uncertainty has just been named.
        let others = reasons(c.forces.iter().map(|r| &r.e_n[j - 1]));
        for why in others.into_iter().filter(|why| !why.starts_with("no uncertainty stated")) {
            say!("  no E_n of {id} against {}: {why}", c.force_ids[0]);
        }
    }
}

/// Head and cells of an estimate's forces, and of its E_n against the first estimate where there is one.
fn force_columns(c: &Comparison, i: usize, id: &str) -> Vec<(String, Vec<String>)> {
    let is_stated = c.forces.iter().any(|r| r.forces[i].standard.is_some());
    let head = if is_stated { format!("{id} ± U [N]") } else { format!("{id} [N]") };
    let cells = c.forces.iter().map(|r| match r.forces[i].value {
        Some(force) if r.forces[i].standard.is_none() => number::fixed(force, 4),
        _ => value_and_uncertainty(&r.forces[i]),
    });
    let mut out = vec![(head, cells.collect())];
    if i > 0 && c.forces.iter().any(|r| r.e_n[i - 1].is_ok()) {
        out.push(("E_n".to_owned(), c.forces.iter().map(|r| normalised(&r.e_n[i - 1])).collect()));
    }
    out
}

/// The comparison as JSON; where there is no E_n or χ², `note` says why.
pub fn comparison_json(c: &Comparison) -> serde_json::Value {
    serde_json::json!({
        "coefficients": c.coefficients.iter().map(|r| serde_json::json!({
            "model": r.model, "coefficient": r.coefficient, "unit": r.unit, "first": r.first, "second": r.second,
            "value_first": r.by_first.value, "value_second": r.by_second.value,
            "expanded_uncertainty_first": r.by_first.expanded(), "expanded_uncertainty_second": r.by_second.expanded(),
            "coverage_factor_first": r.by_first.coverage(), "coverage_factor_second": r.by_second.coverage(),
            "e_n": r.e_n.as_ref().ok(), "note": r.e_n.as_ref().err(),
        })).collect::<Vec<_>>(),
        "joint": c.joint.iter().map(|r| serde_json::json!({
            "model": r.model, "first": r.first, "second": r.second,
            "chi_squared": r.result.as_ref().ok().map(|x| x.0), "dof": r.result.as_ref().ok().map(|x| x.1),
            "p": r.result.as_ref().ok().map(|x| x.2), "note": r.result.as_ref().err(),
        })).collect::<Vec<_>>(),
        "forces": c.forces.iter().map(|r| serde_json::json!({
            "component": r.component, "n_links": r.n_links, "speed_m_s": r.speed_m_s, "angle_rad": r.angle_rad,
            "by": c.force_ids.iter().zip(&r.forces).map(|(id, f)| serde_json::json!({
                "id": id, "force_n": f.value, "standard_uncertainty_n": f.standard,
                "expanded_uncertainty_n": f.expanded(), "coverage_factor": f.coverage(), "effective_dof": f.dof,
            })).collect::<Vec<_>>(),
            "e_n": c.force_ids.iter().skip(1).zip(&r.e_n).map(|(id, e)| serde_json::json!({
                "first": c.force_ids[0], "second": id, "e_n": e.as_ref().ok(), "note": e.as_ref().err(),
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "findings": c.findings,
    })
}

/// A table whose cells are written already; numbers to the right. No word is broken: a table of long words is wider than [`WIDEST`].
pub fn text_table(text: &froude::report::document::TextTable) {
    say!("{}", laid_out(text, usize::from(WIDEST)));
}

fn laid_out(text: &froude::report::document::TextTable, widest: usize) -> Table {
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
fn widths(text: &froude::report::document::TextTable, widest: usize) -> Vec<usize> {
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

/// Words, of which an interval or a unit in brackets is one.
fn words(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
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
    use froude::report::document::TextTable;

    use super::*;

    fn preflight() -> TextTable {
        let texts = |cells: &[&str]| cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>();
        let head =
            ["kind", "speed [m/s]", "way", "takes [s]", "steady [s]", "command [V]", "rms current [A]", "coast [m]"];
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
            let printed = laid_out(&table, widest).to_string();
            let found: Vec<&str> = printed.split_whitespace().collect();
            for word in &words {
                assert!(found.contains(word), "{word} at {widest} columns:\n{printed}");
            }
        }
    }

    #[test]
    fn a_table_is_as_wide_as_the_page_where_its_words_fit() {
        for widest in [90, 100, 120] {
            let printed = laid_out(&preflight(), widest).to_string();
            let longest = printed.lines().map(|l| l.chars().count()).max().unwrap_or(0);
            assert!(longest <= widest, "{longest} of {widest}:\n{printed}");
        }
    }
}
