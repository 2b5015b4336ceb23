//! Lengths of a body, as a campaign, a body file and a robot file write them.

use froude_hydro::Link;

use crate::declare::{Key, Kind, Range, names, required};
use crate::error::RecordError;
use crate::section::Section;
use crate::units::Dimension;

/// Lengths that a body can have, m: from a grain to some ships. Beyond them stands a slip of the unit, and no mesh that resolves both ends.
const LENGTHS_M: [f64; 2] = [1e-5, 1e3];

/// Half of a section's height and width, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SemiAxes {
    /// Vertical.
    pub major_m: f64,
    /// Lateral.
    pub minor_m: f64,
}

/// A length of a body, m: it must be there and within what a body can have.
///
/// # Errors
///
/// [`RecordError`] with its place where it is missing, something else, or of no body.
pub fn need(s: &Section<'_>, key: &'static str) -> Result<f64, RecordError> {
    let length_m =
        s.positive(key, Dimension::LENGTH)?.ok_or_else(|| s.missing(key, "write it with its unit: \"60 mm\""))?;
    let [least, most] = LENGTHS_M;
    let problem = format!("is {length_m} m; lengths of a body are from {least} m to {most} m: check its unit");
    s.refuse(key, !(least..=most).contains(&length_m), problem)?;
    Ok(length_m)
}

/// Half of a section's height and width, `major_semi_axis` and `minor_semi_axis`.
///
/// # Errors
///
/// As [`need`].
pub fn semi_axes(s: &Section<'_>) -> Result<SemiAxes, RecordError> {
    Ok(SemiAxes { major_m: need(s, "major_semi_axis")?, minor_m: need(s, "minor_semi_axis")? })
}

const fn length(name: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Quantity(Dimension::LENGTH), "write it with its unit: \"60 mm\"", doc).within(Range::Positive)
}

/// Keys of `[body.link]`.
pub const LINK: &[Key] = &[
    length("major_semi_axis", "half of the height of its section"),
    length("minor_semi_axis", "half of the width of its section"),
    length("half_length", "half of its length"),
];

/// The link of a `[body]`, of a body file and of a campaign.
///
/// # Errors
///
/// As [`need`].
pub fn link(s: &Section<'_>) -> Result<Option<Link>, RecordError> {
    let Some(link) = s.section("link")? else { return Ok(None) };
    link.only(&names(LINK))?;
    let half_length_m = need(&link, "half_length")?;
    let SemiAxes { major_m, minor_m } = semi_axes(&link)?;
    Ok(Some(Link { major_semi_axis_m: major_m, minor_semi_axis_m: minor_m, half_length_m }))
}
