//! The head of a section: observations, configurations, covariance, range blocks.

use crate::result::SourceResult;

/// Facts as `(name, value)`, as they shall be read.
pub(super) fn of(source: &SourceResult) -> Vec<(String, String)> {
    let mut out = vec![
        ("Observations".to_owned(), format!("{} used of {} read", source.data.observations(), source.n_read)),
        ("Configurations".to_owned(), {
            let of_rows = || source.data.configurations();
            let names = source.data.sample.as_ref().map_or_else(of_rows, |all| all.configurations.clone());
            if names.iter().all(String::is_empty) { "one, not named".to_owned() } else { names.join(", ") }
        }),
    ];
    if let Some(estimate) = source.estimates.first() {
        out.push(("Covariance".to_owned(), estimate.covariance_kind().to_owned()));
    }
    for estimate in source.estimates.iter().filter(|e| e.recommended) {
        for note in &estimate.diagnostics.notes {
            out.push(("Propagation".to_owned(), note.clone()));
        }
    }
    for block in &source.blocks {
        let rmse: Vec<String> =
            block.rmse.iter().map(|(c, e, r)| format!("{c} {e:.3e} ({:.0} %)", 100.0 * r)).collect();
        let worst: Vec<String> = block.worst_ratio.iter().map(|(c, w)| format!("{c} {:+.0} %", 100.0 * w)).collect();
        let moved: Vec<String> = block.moved.iter().map(|(n, a, b)| format!("{n} {a:.4e} → {b:.4e}")).collect();
        out.push((
            format!("Range block, {}", block.model),
            format!(
                "{}: prediction error outside {}; worst {}; coefficients {}",
                block.block,
                rmse.join(", "),
                worst.join(", "),
                moved.join(", ")
            ),
        ));
    }
    out
}
