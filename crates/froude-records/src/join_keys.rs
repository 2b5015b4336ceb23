//! `[[log.join]]` of a sidecar: another log of the same run, with a clock of its own.
//!
//! ```toml
//! [[log.join]]
//! file = "load.csv"
//! same = ["position", "heave"]                        # what both recorded: a channel here, a channel there
//! lag  = { value = "0.4 s", standard = "0.1 s" }      # beside `same`: where to look for it
//!
//! [[log.join]]
//! file   = "wave.csv"
//! lag    = { value = "0.37 s", standard = "2 ms" }    # time of this log = stamp − lag − drift (stamp − origin)
//! drift  = { value = "50 ppm", standard = "5 ppm" }
//! origin = "12 s"                                     # stamp at which the lag holds; else the first
//! ```

use froude_signal::lag::MOST_DRIFT;

use crate::error::{Place, RecordError};
use crate::run::declared::{Declared, declared};
use crate::section::Section;
use crate::units::Dimension;

/// Most logs that are joined to one.
const MOST: usize = 20;

/// What is declared of a log that is joined.
#[derive(Debug, Clone, PartialEq)]
pub struct Join {
    /// Its file, from the folder of the sidecar on; `*` is what `*` of `files` stands for.
    pub file: String,
    /// The channels of this log and of that one that show the same.
    pub same: Option<[String; 2]>,
    /// How much its stamps exceed the time of the first log, s.
    pub lag_s: Option<Declared>,
    /// How fast that grows.
    pub drift: Option<Declared>,
    /// Its stamp at which the lag holds, s.
    pub origin_s: Option<f64>,
    /// Where that is written.
    pub place: Place,
}

/// `[[log.join]]`, each with its section, which may have columns.
pub(crate) fn joins<'a>(root: &Section<'a>) -> Result<Vec<(Join, Section<'a>)>, RecordError> {
    let Some(log) = root.section("log")? else { return Ok(Vec::new()) };
    log.only(&["join"])?;
    let all = log.sections("join")?;
    log.refuse("join", all.len() > MOST, format!("are {}; at most {MOST} logs are joined to one", all.len()))?;
    all.into_iter().map(|section| Ok((join(&section)?, section))).collect()
}

fn join(s: &Section<'_>) -> Result<Join, RecordError> {
    s.only(&["file", "same", "lag", "drift", "origin", "columns"])?;
    let file = s.need_text("file", "write file = \"load.csv\", the log of the other program")?.to_owned();
    let same = match s.texts("same")?.try_into() {
        Ok(pair) => Some(pair),
        Err(texts) => {
            let texts: Vec<String> = texts;
            let problem = format!(
                "names {}; write two, the channel of this log and that of the other: same = [\"position\", \"position\"]",
                crate::text::counted(texts.len(), "channel", "channels")
            );
            s.refuse("same", true, problem)?;
            None
        }
    };
    let known = |key: &'static str, dimension, example: &str| {
        let found = declared(s, key, dimension)?;
        let lacks = found.is_some_and(|found| found.standard_uncertainty == 0.0);
        let problem =
            format!("has no standard uncertainty; write {key} = {{ value = \"…\", standard = \"{example}\" }}");
        s.refuse(key, lacks, problem)?;
        Ok::<_, RecordError>(found)
    };
    let lag_s = known("lag", Dimension::TIME, "2 ms")?;
    let drift = known("drift", Dimension::ONE, "50 ppm")?;
    let is_beyond = drift.is_some_and(|drift| drift.value.abs() >= MOST_DRIFT);
    s.refuse("drift", is_beyond, "is beyond 100 ms/s, which no two clocks differ by")?;
    if same.is_none() {
        let what = "write same = [\"position\", \"position\"], the channels of this log and of the other that recorded one thing; or state how far its clock is off: \
                    lag = { value = \"0.37 s\", standard = \"2 ms\" } and drift = { value = \"0 ppm\", standard = \"50 ppm\" } (time of this log = stamp − lag − drift · (stamp − origin))";
        let lacks = if lag_s.is_none() { Some("lag") } else { drift.is_none().then_some("drift") };
        if let Some(key) = lacks {
            return Err(s.missing(key, what));
        }
    }
    let origin_s = s.quantity("origin", Dimension::TIME)?;
    s.refuse("origin", same.is_some(), "belongs to a declared lag; beside `same` the lag is that of the first sample")?;
    Ok(Join { file, same, lag_s, drift, origin_s, place: s.place() })
}
