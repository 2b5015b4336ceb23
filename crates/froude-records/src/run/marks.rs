//! Marks and segments of a log: times that are not to be used, and times that a person has named.
//!
//! ```toml
//! [[marks]]
//! from = "3.2 s"
//! to   = "3.4 s"
//! why  = "outlier"           # clipped, dropped, outlier, or another word
//! by   = "J. Froude"         # a person, or a rule
//! note = "somebody leaned on the rail"
//!
//! [[segments]]
//! name = "steady"            # still, steady, test
//! from = "6 s"
//! to   = "12 s"
//! ```

use crate::error::RecordError;
use crate::nearest::meant;
use crate::section::Section;
use crate::section_values::one_of;
use crate::units::Dimension;

/// Reasons that are known; any other word does too.
pub const REASONS: [&str; 3] = ["clipped", "dropped", "outlier"];
/// Most of either of one log.
const MOST: usize = 10_000;

/// A stretch of a log that is not to be used.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Its first moment, s of the log.
    pub from_s: f64,
    /// Its last moment, s of the log.
    pub to_s: f64,
    /// Why, in a word.
    pub why: String,
    /// Who set it: a person, or a rule.
    pub by: String,
    /// What else is said about it.
    pub note: String,
}

/// What a stretch of a log is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SegmentKind {
    /// Nothing moves.
    Still,
    /// The motion is constant: the window of a steady tow.
    Steady,
    /// The test: what lies outside is not looked at.
    Test,
}

impl SegmentKind {
    const ALL: [Self; 3] = [Self::Still, Self::Steady, Self::Test];
    const NAMES: [&'static str; 3] = ["still", "steady", "test"];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// A stretch of a log that a person has named.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// What it is.
    pub kind: SegmentKind,
    /// Its first moment, s of the log.
    pub from_s: f64,
    /// Its last moment, s of the log.
    pub to_s: f64,
    /// Who said so; empty where nobody signed.
    pub by: String,
    /// What else is said about it.
    pub note: String,
}

impl Mark {
    /// Whether it has a moment in common with a stretch.
    #[must_use]
    pub fn touches(&self, from_s: f64, to_s: f64) -> bool {
        self.from_s <= to_s && from_s <= self.to_s
    }
}

/// `[[marks]]`.
pub(crate) fn marks(root: &Section<'_>) -> Result<Vec<Mark>, RecordError> {
    few(root, "marks")?.iter().map(mark).collect()
}

fn mark(s: &Section<'_>) -> Result<Mark, RecordError> {
    s.only(&["from", "to", "why", "by", "note"])?;
    let (from_s, to_s) = stretch(s)?;
    let why = s.need_text("why", "write why = \"clipped\", \"dropped\", \"outlier\", or another word")?;
    s.refuse("why", why.trim().is_empty(), "is empty; write clipped, dropped, outlier, or another word")?;
    if let Some(advice) = meant(why, REASONS) {
        s.refuse("why", !REASONS.contains(&why), format!("is {why:?}; {advice}"))?;
    }
    let by = s
        .text("by")?
        .filter(|by| !by.trim().is_empty())
        .ok_or_else(|| s.missing("by", "state who set it: by = \"J. Froude\", or the rule that did"))?;
    let note = s.text("note")?.unwrap_or_default();
    Ok(Mark { from_s, to_s, why: why.to_owned(), by: by.to_owned(), note: note.to_owned() })
}

/// `[[segments]]`.
pub(crate) fn segments(root: &Section<'_>) -> Result<Vec<Segment>, RecordError> {
    let out: Vec<Segment> = few(root, "segments")?.iter().map(segment).collect::<Result<_, _>>()?;
    for kind in [SegmentKind::Steady, SegmentKind::Test] {
        let (n, name) = (out.iter().filter(|segment| segment.kind == kind).count(), kind.name());
        let problem =
            format!("name {n} of the kind {name:?}; a log has one, so split the log, or mark what lies between");
        root.refuse("segments", n > 1, problem)?;
    }
    Ok(out)
}

fn segment(s: &Section<'_>) -> Result<Segment, RecordError> {
    s.only(&["name", "from", "to", "by", "note"])?;
    let kind = one_of(s, "name", &SegmentKind::NAMES, &SegmentKind::ALL)?
        .ok_or_else(|| s.missing("name", "write name = \"still\", \"steady\" or \"test\""))?;
    let (from_s, to_s) = stretch(s)?;
    let text = |key| Ok::<_, RecordError>(s.text(key)?.unwrap_or_default().to_owned());
    Ok(Segment { kind, from_s, to_s, by: text("by")?, note: text("note")? })
}

fn few<'a>(root: &Section<'a>, key: &'static str) -> Result<Vec<Section<'a>>, RecordError> {
    let out = root.sections(key)?;
    root.refuse(key, out.len() > MOST, format!("are {}; at most {MOST} are read", out.len()))?;
    Ok(out)
}

/// `from` and `to`, times of the log.
fn stretch(s: &Section<'_>) -> Result<(f64, f64), RecordError> {
    let need = |key: &'static str| {
        s.quantity(key, Dimension::TIME)?
            .ok_or_else(|| s.missing(key, &format!("write {key} = \"3.2 s\", in the time of the log")))
    };
    let (from_s, to_s) = (need("from")?, need("to")?);
    s.refuse("to", to_s < from_s, format!("is {to_s} s, before from ({from_s} s)"))?;
    Ok((from_s, to_s))
}
