//! The style of all pages, and what they may load.

pub(crate) const STYLE: &str = include_str!("report.css");

/// What a browser may do with a page: use the styles that stand in it. It loads nothing, runs nothing, sends nothing, whatever a name or a
/// cell of somebody's file holds.
pub(crate) const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";
