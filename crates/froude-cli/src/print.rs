//! Results as a person reads them, and as JSON.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table};
use froude::Error;
use froude::identify::compare::Comparison;
use froude::inspect::Inspection;
use froude::pipeline::Outcome;
use froude::records::estimate::{Estimate, Status};
use froude::records::finding::{Finding, Severity};
use froude::report::number;

/// One JSON document on standard output.
pub fn json<T: serde::Serialize>(value: &T) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::Nothing(format!("the result cannot be written as JSON: {e}")))?;
    println!("{text}");
    Ok(())
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY)
        .set_content_arrangement(ContentArrangement::Dynamic)
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

/// What is in a file.
pub fn inspection(i: &Inspection) {
    println!("{}", i.kind);
    for (name, value) in &i.facts {
        println!("  {name}: {value}");
    }
    if !i.columns.is_empty() {
        let mut out = table(&["column", "unit", "from", "to", "distinct"]);
        for c in &i.columns {
            let show = |x: Option<f64>| right(x.map_or(String::new(), |x| format!("{x:.6}")));
            let unit = if c.unit.is_empty() { "text" } else { &c.unit };
            out.add_row(vec![
                Cell::new(&c.name),
                Cell::new(unit),
                show(c.low),
                show(c.high),
                right(c.distinct.to_string()),
            ]);
        }
        println!("{out}");
    }
    findings(&i.findings);
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
