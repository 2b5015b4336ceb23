//! Cells that no spreadsheet runs.
//!
//! **Text is only text.** A spreadsheet takes a cell that begins with `=`, `+`, `-`, `@`, a tab or a line end for a formula and runs it.
//! Cells of text and headers that begin so are written with an apostrophe before them, as are those that begin with apostrophes and then so;
//! numbers are not. Reading takes that one apostrophe off again, so names come back as they were; another program sees it.

/// A text that no spreadsheet takes for a formula.
#[must_use]
pub fn guarded(cell: String) -> String {
    if is_formula(&cell) { format!("'{cell}") } else { cell }
}

/// What [`guarded`] was made of.
pub(crate) fn unguarded(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|rest| is_formula(rest)).unwrap_or(cell)
}

/// True for what begins as a formula, and for that with apostrophes before it: they would be taken off when it is read.
fn is_formula(cell: &str) -> bool {
    // The wide forms are formulas in East Asian editions.
    const BEGINNINGS: [char; 11] = ['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠'];
    cell.trim_start_matches('\'').starts_with(BEGINNINGS)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// What is written is no formula, and comes back as it was.
        #[test]
        fn a_guarded_cell_is_no_formula_and_comes_back(cell in "'{0,3}[-=+@\\t\\ra＝]?.{0,5}") {
            let written = guarded(cell.clone());
            prop_assert!(!written.starts_with(['=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠']));
            prop_assert_eq!(unguarded(&written), cell);
        }
    }
}
