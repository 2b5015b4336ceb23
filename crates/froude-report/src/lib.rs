#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]
//! Tables, figures and self-contained HTML reports.
//!
//! [`html`] turns a [`Report`] into one file that holds everything: summary,
//! method, data with fingerprints, findings, coefficient tables as papers print
//! them, loads with model and 95 % band, residuals, uncertainty budget, model
//! selection, validity, sources side by side. [`figures()`] gives the same figures
//! as SVG documents of their own. [`froude_records::number`] writes numbers with the digits that
//! their uncertainty allows; the tables of the program use it too.
//!
//! The input is plain records with public fields ([`Report`], [`SourceSection`],
//! …). The same input always gives the same bytes: no clock, no random order.
//!
//! What the data do not determine is printed as "—", never as a zero; a
//! published value without uncertainty is marked †; numbers that are not finite
//! are treated as missing. No input makes it panic.
//!
//! ```
//! use froude_report::{Report, html};
//!
//! let page = html(&Report { title: "Tare drag".to_owned(), ..Report::default() });
//! assert!(page.starts_with("<!DOCTYPE html>"));
//! ```
//!
//! Not here: fitting, propagation, reading and writing of files, PDF (print the
//! page).

mod canvas;
pub mod chart;
pub mod csv;
mod error;
pub mod field;
mod figures;
mod filled;
mod findings;
pub mod map;
pub mod outcome;
mod page;
mod plot;
mod sheet;
pub mod side_by_side;
mod statistics;
mod style;
mod symbol;
mod tables;
pub mod terminal;
pub mod write;

pub use error::ReportError;
pub use figures::{Figure, figures};
pub use froude_records::page::{
    Abscissa, Against, BudgetRow, Curve, InputFile, Observed, Point, Report, SelectionRow, SourceSection,
};
pub use page::html;
