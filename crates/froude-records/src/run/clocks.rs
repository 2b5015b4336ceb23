//! Clocks beside that of the log: how their stamps become its time.
//!
//! ```toml
//! [clocks.camera]
//! offset   = "12 ms"          # time of the log = stamp + offset + skew · (stamp − origin)
//! skew     = "-7.3 ms/s"      # or in ppm
//! origin   = "0 s"
//! standard = "1 ms"           # of a time of the log computed from it
//! found    = "by cross-correlation with acc_heave, 2026-11-20"
//! ```

use indexmap::IndexMap;

use crate::error::RecordError;
use crate::run::channel::{BOARD, LOG};
use crate::section::Section;
use crate::units::Dimension;

/// A skew beyond this is of no two clocks.
const MOST_SKEW: f64 = 0.1;

/// How a stamp t of a clock becomes a time of the log: t + offset + skew (t − origin).
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// What is added to its stamps at the origin, s.
    pub offset_s: f64,
    /// What is added more for each second after it, 1.
    pub skew: f64,
    /// Stamp at which the offset holds, s.
    pub origin_s: f64,
    /// Standard uncertainty of a time computed from it, s.
    pub standard_s: f64,
    /// How it was found.
    pub found: String,
}

/// Whether a name is that of the log's own clock.
#[must_use]
pub fn is_own(name: &str) -> bool {
    name == LOG || name == BOARD
}

/// `[clocks.NAME]`.
pub(crate) fn clocks(root: &Section<'_>) -> Result<IndexMap<String, Clock>, RecordError> {
    let Some(section) = root.section("clocks")? else { return Ok(IndexMap::new()) };
    let mut out = IndexMap::new();
    for (name, _, value) in section.entries() {
        if is_own(name) {
            let problem = "is the log's own clock, which all others are aligned with; declare the others";
            return Err(section.wrong(name, value, problem));
        }
        out.insert(name.to_owned(), clock(&section.as_section(name, value)?)?);
    }
    Ok(out)
}

fn clock(s: &Section<'_>) -> Result<Clock, RecordError> {
    s.only(&["offset", "skew", "origin", "standard", "found"])?;
    let need =
        |key: &'static str, advice: &str| s.quantity(key, Dimension::TIME)?.ok_or_else(|| s.missing(key, advice));
    let offset_s = need("offset", "write offset = \"12 ms\": what is added to its stamps")?;
    let skew = s.quantity("skew", Dimension::ONE)?.unwrap_or(0.0);
    let standard_s =
        need("standard", "write standard = \"1 ms\": the standard uncertainty of a time computed from it")?;
    let found = s
        .text("found")?
        .filter(|found| !found.trim().is_empty())
        .ok_or_else(|| s.missing("found", "state how it was found: found = \"by cross-correlation with acc_heave\""))?;
    s.refuse("skew", skew.abs() > MOST_SKEW, "is beyond 100 ms/s, which no two clocks differ by")?;
    s.refuse("standard", standard_s < 0.0, "is negative; a standard uncertainty is not")?;
    let origin_s = s.quantity("origin", Dimension::TIME)?.unwrap_or(0.0);
    Ok(Clock { offset_s, skew, origin_s, standard_s, found: found.to_owned() })
}
