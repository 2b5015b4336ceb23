//! Results as a person reads them, and as JSON.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table};
use froude::Error;
use froude::identify::compare::Comparison;
use froude::inspect::{ColumnFacts, Inspection, SourceFacts};
use froude::pipeline::Outcome;
use froude::records::estimate::{Diagnostics, Estimate, Status};
use froude::records::finding::{Finding, Severity};
use froude::report::number;

/// One JSON document on standard output.
pub fn json<T: serde::Serialize>(value: &T) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::Nothing(format!("the result cannot be written as JSON: {e}")))?;
    println!("{text}");
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
        .set_header(header.iter().map(Cell::new));
    table
}

fn right(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

/// The coefficient tables, the findings, and where the report lies.
pub fn outcome(outcome: &Outcome) {
    for source in &outcome.sources {
        println!("\n{} ({} observations)", source.name, source.data.rows);
        if let Some(r) = &source.recommendation {
            println!("  recommended: {}", r.reason);
        }
        for estimate in source.estimates.iter().filter(|e| e.recommended) {
            println!("{}", coefficients(estimate));
            for combination in &estimate.undetermined {
                println!("  determined only together: {combination}");
            }
        }
        let others: Vec<&str> = source.estimates.iter().filter(|e| !e.recommended).map(|e| e.model.as_str()).collect();
        if !others.is_empty() {
            println!("  also fitted: {} (see the report)", others.join(", "));
        }
    }
    findings(&outcome.file.findings);
    println!("\nestimates {}", outcome.estimate.display());
    println!("report    {}", outcome.report.display());
}

fn coefficients(estimate: &Estimate) -> Table {
    let mut out = table(&["coefficient", "value", "unit", "95 % interval", "type A", "type B", "status"]);
    for (name, c) in &estimate.coefficients {
        out.add_row(vec![
            Cell::new(name),
            right(number::coefficient(c)),
            Cell::new(&c.unit),
            right(c.interval_95.map_or("—".to_owned(), number::interval)),
            right(c.type_a.map_or("—".to_owned(), |x| format!("{x:.2e}"))),
            right(c.type_b.map_or("—".to_owned(), |x| format!("{x:.2e}"))),
            Cell::new(status(c.status)),
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
        println!("\nNo findings.");
        return;
    }
    println!("\nFindings");
    for f in findings {
        let grade = match f.severity {
            Severity::Error => "ERROR  ",
            Severity::Warning => "warning",
            Severity::Note => "note   ",
        };
        let source = f.source.as_ref().map_or(String::new(), |s| format!("{s}: "));
        println!("  {grade}  [{}] {source}{}", f.code, f.message);
    }
}

/// Prints a sentence in lines of at most [`WIDEST`] characters, two spaces in.
fn sentence(text: &str) {
    let mut line = " ".to_owned();
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > usize::from(WIDEST) && !line.trim().is_empty() {
            println!("{line}");
            line.clear();
            line.push_str("   ");
        }
        line = line + " " + word;
    }
    println!("{line}");
}

/// What is in a file.
pub fn inspection(i: &Inspection) {
    println!("{}", i.kind);
    for (name, value) in &i.facts {
        sentence(&format!("{name}: {value}"));
    }
    if !i.columns.is_empty() {
        println!("{}", columns(&i.columns));
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
    let mut out = table(&["column", "unit", "from", "to", "distinct"]);
    for c in columns {
        let show = |x: Option<f64>| right(x.map_or(String::new(), |x| number::plain(x, 7)));
        let unit = if c.unit.is_empty() { "text" } else { &c.unit };
        out.add_row(vec![
            Cell::new(&c.name),
            Cell::new(unit),
            show(c.low),
            show(c.high),
            right(c.distinct.to_string()),
        ]);
    }
    out
}

fn source_facts(s: &SourceFacts) {
    println!("\nsource {} ({})", s.name, s.kind);
    let there = match (s.rows, s.kept, s.exists) {
        (Some(rows), Some(kept), _) if kept == rows => format!(", {rows} observations"),
        (Some(rows), Some(kept), _) => format!(", {kept} of {rows} observations are fitted"),
        (_, _, true) => String::new(),
        (_, _, false) => ", not there yet: froude simulate makes it".to_owned(),
    };
    sentence(&format!("{}: {}{there}", s.input, s.path));
    if let Some(runs) = s.planned_runs {
        println!("  plan: {runs} runs");
    }
    let what = if s.input == "record" { "estimates" } else { "models" };
    if !s.models.is_empty() {
        sentence(&format!("{what}: {}", s.models.join(", ")));
    }
    if !s.columns.is_empty() {
        println!("{}", columns(&s.columns));
    }
    if s.input == "table" && s.budget.is_empty() {
        println!("  budget: none; without [[source.uncertainty]] the uncertainties hold the scatter alone");
    }
    if !s.budget.is_empty() {
        let mut out = table(&["budget", "standard", "shared by", "dof", "name"]);
        for b in &s.budget {
            out.add_row(vec![
                Cell::new(&b.quantity),
                right(b.standard.clone()),
                Cell::new(&b.shared),
                right(number::dof(b.dof.unwrap_or(f64::INFINITY))),
                Cell::new(b.name.as_deref().unwrap_or("")),
            ]);
        }
        println!("{out}");
    }
}

fn estimate_facts(e: &Estimate) {
    println!("\n{}{}", e.id, if e.recommended { " (recommended)" } else { "" });
    if let Some(reason) = &e.reason {
        sentence(reason);
    }
    let mut about = vec![format!("{} observations", e.n_observations)];
    about.extend([&e.kind, &e.method, &e.covariance_kind].into_iter().filter(|t| !t.is_empty()).cloned());
    sentence(&about.join("; "));
    let mut out = table(&["coefficient", "value", "unit", "standard uncertainty", "95 % interval", "status"]);
    for (name, c) in &e.coefficients {
        let or_none = |x: Option<f64>, digits: usize| right(x.map_or("—".to_owned(), |x| number::plain(x, digits)));
        out.add_row(vec![
            Cell::new(name),
            or_none(c.value, 5),
            Cell::new(&c.unit),
            or_none(c.standard_uncertainty, 2),
            right(c.interval_95.map_or("—".to_owned(), number::interval)),
            Cell::new(if c.status == Status::Free { "free" } else { status(c.status) }),
        ]);
    }
    println!("{out}");
    for combination in &e.undetermined {
        sentence(&format!("determined only together: {combination}"));
    }
    if !e.validity.is_empty() {
        let mut out = table(&["valid for", "from", "to", "unit"]);
        for (name, r) in &e.validity {
            let (low, high) = (right(number::plain(r.low, 5)), right(number::plain(r.high, 5)));
            out.add_row(vec![Cell::new(name), low, high, Cell::new(&r.unit)]);
        }
        println!("{out}");
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

/// Sources side by side.
pub fn comparison(c: &Comparison, all: bool) {
    let recommended = |id: &str| c.force_ids.iter().any(|f| f == id);
    let mut out = table(&["model", "coefficient", "unit", "first", "second", "value", "value", "E_n"]);
    let mut hidden = 0;
    for r in &c.coefficients {
        if !all && !(recommended(&r.first) && recommended(&r.second)) && c.coefficients.len() > 40 {
            hidden += 1;
            continue;
        }
        let show = |v: Option<f64>| right(v.map_or("—".to_owned(), |x| format!("{x:.4}")));
        out.add_row(vec![
            Cell::new(&r.model),
            Cell::new(&r.coefficient),
            Cell::new(&r.unit),
            Cell::new(&r.first),
            Cell::new(&r.second),
            show(r.value_first),
            show(r.value_second),
            match &r.e_n {
                Ok(e) => right(format!("{e:+.2}")),
                Err(why) => Cell::new(why),
            },
        ]);
    }
    if !out.is_empty() {
        println!("{out}");
    }
    if hidden > 0 {
        println!("{hidden} further pairs; --all prints them");
    }
    for j in &c.joint {
        match &j.result {
            Ok((chi2, dof, p)) => {
                println!(
                    "jointly, {} and {}: χ² = {chi2:.2} with {dof} degrees of freedom, p = {p:.3}",
                    j.first, j.second
                );
            }
            Err(why) => {
                if all {
                    println!("jointly, {} and {}: {why}", j.first, j.second);
                }
            }
        }
    }
    if !c.forces.is_empty() {
        println!("\nPredicted force over the common range");
        let mut header = vec!["load".to_owned(), "k".to_owned(), "speed m/s".to_owned(), "angle deg".to_owned()];
        header.extend(c.force_ids.iter().map(|id| format!("{id} N")));
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let mut out = table(&header);
        for r in &c.forces {
            let mut row = vec![
                Cell::new(&r.component),
                right(format!("{}", r.n_links)),
                right(format!("{:.3}", r.speed_m_s)),
                right(format!("{:.1}", r.angle_rad.to_degrees())),
            ];
            row.extend(
                r.forces
                    .iter()
                    .map(|(f, u)| right(u.map_or_else(|| format!("{f:.4}"), |u| format!("{f:.4} ± {:.4}", 1.96 * u)))),
            );
            out.add_row(row);
        }
        println!("{out}");
    }
    findings(&c.findings);
}

/// The comparison as JSON.
pub fn comparison_json(c: &Comparison) -> serde_json::Value {
    let text = |r: &Result<f64, String>| match r {
        Ok(x) => serde_json::json!(x),
        Err(_) => serde_json::Value::Null,
    };
    serde_json::json!({
        "coefficients": c.coefficients.iter().map(|r| serde_json::json!({
            "model": r.model, "coefficient": r.coefficient, "unit": r.unit, "first": r.first, "second": r.second,
            "value_first": r.value_first, "value_second": r.value_second, "e_n": text(&r.e_n),
            "note": r.e_n.as_ref().err(),
        })).collect::<Vec<_>>(),
        "joint": c.joint.iter().map(|r| serde_json::json!({
            "model": r.model, "first": r.first, "second": r.second,
            "chi_squared": r.result.as_ref().ok().map(|x| x.0), "dof": r.result.as_ref().ok().map(|x| x.1),
            "p": r.result.as_ref().ok().map(|x| x.2), "note": r.result.as_ref().err(),
        })).collect::<Vec<_>>(),
        "forces": c.forces.iter().map(|r| serde_json::json!({
            "component": r.component, "n_links": r.n_links, "speed_m_s": r.speed_m_s, "angle_rad": r.angle_rad,
            "by": c.force_ids.iter().zip(&r.forces).map(|(id, (f, u))| serde_json::json!({
                "id": id, "force_n": f, "standard_uncertainty_n": u })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "findings": c.findings,
    })
}
