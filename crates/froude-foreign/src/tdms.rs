//! TDMS, the logs of LabVIEW, DAQmx and DIAdem.
//!
//! Read are plain and interleaved data in both byte orders, and raw samples of DAQmx devices through their scalers, digital lines
//! included; scales of the kinds linear, polynomial, table, sum and difference are applied. A channel with a scale of another
//! kind (strain gauge, RTD, thermistor, thermocouple) or of complex numbers is left out and named; types without a known size and
//! mixtures of DAQmx and plain data are refused.
//!
//! **Parts.** A group whose channels have one length and one waveform is a part; the channels of any other group are parts of their
//! own, `group/channel`. A waveform (`wf_increment`, `wf_start_offset`, `wf_start_time`) gives the column `time [s]`; where channels
//! start at different moments, it counts from the earliest. Stamps stored as values count from the first stamp in the file.
//!
//! Source: NI, "TDMS File Format Internal Structure"; what it leaves open, as npTDMS 1.13 reads it.

mod bytes;
mod data;
mod scale;
mod segment;

use std::collections::BTreeMap;

use crate::{Cells, Column, Contents, ForeignError, MAX_CELLS, Part};
use bytes::{Stamp, Value};
use data::{Raw, Values};
use segment::Layout;

type Properties = BTreeMap<String, Value>;

/// Reads a file.
///
/// # Errors
///
/// What is no TDMS, contradicts the format, or holds no channel that can be read; each with its place.
pub fn read(bytes: &[u8]) -> Result<Contents, ForeignError> {
    let layout = Layout::read(bytes).map_err(ForeignError)?;
    let mut values = Values::new(MAX_CELLS);
    for segment in &layout.segments {
        values.read(bytes, segment).map_err(ForeignError)?;
    }
    let mut notes = std::mem::take(&mut values.notes);
    if let Some(at) = layout.cut_at {
        notes.push(format!("the file ends in the segment that begins at byte {at}: what was recorded last is missing"));
    }
    let none = Properties::new();
    let properties = |path: &str| layout.objects.iter().find(|(own, _)| **own == *path).map_or(&none, |(_, own)| own);
    let mut groups: Vec<Group> = Vec::new();
    let mut first_stamp = None;
    for (path, own) in &layout.objects {
        let names = parts_of(path);
        let [group, channel] = names.as_slice() else { continue };
        let raw = values.channels.remove(path).unwrap_or_default();
        let levels = [own, properties(&path_of(group)), properties("/")];
        match Channel::new(channel, &raw, levels, &mut first_stamp) {
            Ok(channel) if channel.len == 0 => {
                notes.push(format!("channel {group}/{} has no values", channel.column.name));
            }
            Ok(channel) => {
                if let Some(stated) = scale::not_applied(&raw, own) {
                    notes.push(format!(
                        "channel {group}/{} holds whole numbers; its properties {stated} are not applied: if they turn counts into the quantity, declare `scale` and \
                         `offset` of this column, the offset being the count at zero (−Offset/Slope)",
                        channel.column.name
                    ));
                }
                match groups.iter_mut().find(|other| other.name == *group) {
                    Some(group) => group.channels.push(channel),
                    None => groups.push(Group { name: group.clone(), channels: vec![channel] }),
                }
            }
            Err(problem) => notes.push(format!("channel {group}/{channel} is not read: it {problem}")),
        }
    }
    let start = groups.iter().flat_map(|group| &group.channels).filter_map(|c| c.waveform.as_ref()?.start).min();
    let parts: Vec<Part> = groups.into_iter().flat_map(|group| group.parts(start, &mut notes)).collect();
    if parts.is_empty() {
        notes.insert(0, "no channel of this TDMS file can be read".to_owned());
        return Err(ForeignError(notes.join("; ")));
    }
    if let Some(start) = start.or(first_stamp) {
        notes.push(format!("times count from {:.6} s after 1970-01-01 00:00 UTC", start.unix_s()));
    }
    Ok(Contents { parts, notes, left_out: Vec::new() })
}

/// `/'group'/'channel'` as names; an apostrophe in a name is doubled.
fn parts_of(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut letters = path.chars().peekable();
    while letters.next() == Some('/') {
        if letters.next() != Some('\'') {
            break;
        }
        let mut name = String::new();
        while let Some(letter) = letters.next() {
            if letter == '\'' && letters.next_if_eq(&'\'').is_none() {
                break;
            }
            name.push(letter);
        }
        names.push(name);
    }
    names
}

fn path_of(group: &str) -> String {
    format!("/'{}'", group.replace('\'', "''"))
}

struct Group {
    name: String,
    channels: Vec<Channel>,
}

struct Channel {
    column: Column,
    len: usize,
    waveform: Option<Waveform>,
}

/// Properties of a channel that state its unit.
const UNITS: [&str; 5] = ["unit_string", "NI_UnitDescription", "Unit", "unit", "Units"];

/// Times of a channel's values.
#[derive(Debug, Clone, PartialEq)]
struct Waveform {
    /// What the values are over, `time` as a rule.
    name: String,
    unit: String,
    increment: f64,
    offset: f64,
    start: Option<Stamp>,
}

impl Channel {
    fn new(name: &str, raw: &Raw, levels: [&Properties; 3], first_stamp: &mut Option<Stamp>) -> Result<Self, String> {
        let [own, ..] = levels;
        let kinds = [!raw.numbers.is_empty() || !raw.scalers.is_empty(), !raw.texts.is_empty(), !raw.stamps.is_empty()];
        if raw.n_complex > 0 {
            return Err(format!("has {} complex numbers", raw.n_complex));
        }
        if kinds.into_iter().filter(|is_there| *is_there).count() > 1 {
            return Err("changes from one kind of values to another".to_owned());
        }
        let stated = |key: &str| own.get(key).and_then(Value::text).filter(|text| !text.is_empty());
        let mut units: Vec<&str> = UNITS.iter().filter_map(|key| stated(key)).map(str::trim).collect();
        units.dedup();
        if let [one, other, ..] = units.as_slice() {
            return Err(format!("states two units, {one} and {other}"));
        }
        let mut unit = units.first().copied().unwrap_or_default().to_owned();
        let cells = match (raw.stamps.first(), raw.texts.is_empty()) {
            (Some(first), _) => {
                let origin = *first_stamp.get_or_insert(*first);
                "s".clone_into(&mut unit);
                Cells::Numbers(raw.stamps.iter().map(|stamp| stamp.since(origin)).collect())
            }
            (None, false) => Cells::Texts(raw.texts.clone()),
            (None, true) => Cells::Numbers(scale::scaled(raw, levels)?),
        };
        let len = match &cells {
            Cells::Numbers(numbers) => numbers.len(),
            Cells::Texts(texts) => texts.len(),
        };
        let column = Column { name: name.to_owned(), unit, cells };
        Ok(Self { column, len, waveform: Waveform::of(own) })
    }
}

impl Waveform {
    /// None where the channel has no increment.
    fn of(properties: &Properties) -> Option<Self> {
        let number = |key: &str| properties.get(key).and_then(Value::number);
        let text = |key: &str| properties.get(key).and_then(Value::text).filter(|text| !text.is_empty());
        let increment = number("wf_increment").filter(|increment| *increment != 0.0)?;
        let name = text("wf_xname").filter(|name| !name.eq_ignore_ascii_case("time")).unwrap_or("time");
        let start =
            properties.get("wf_start_time").and_then(|v| if let Value::Time(time) = v { Some(*time) } else { None });
        Some(Self {
            name: name.to_owned(),
            unit: text("wf_xunit_string").unwrap_or(if name == "time" { "s" } else { "" }).to_owned(),
            increment,
            offset: number("wf_start_offset").unwrap_or(0.0),
            // LabVIEW writes 1904 where nobody set a start.
            start: start.filter(|start| start.seconds > 0),
        })
    }

    fn column(&self, len: usize, earliest: Option<Stamp>) -> Column {
        let is_time = self.name == "time" && self.unit == "s";
        let late = self.start.zip(earliest).filter(|_| is_time).map_or(0.0, |(own, earliest)| own.since(earliest));
        let values = (0..len).map(|i| late + self.offset + i as f64 * self.increment).collect();
        Column { name: self.name.clone(), unit: self.unit.clone(), cells: Cells::Numbers(values) }
    }
}

impl Group {
    fn parts(self, earliest: Option<Stamp>, notes: &mut Vec<String>) -> Vec<Part> {
        let Some(first) = self.channels.first().map(|first| (first.len, first.waveform.clone())) else {
            return Vec::new();
        };
        let is_one = self.channels.iter().all(|c| (c.len, &c.waveform) == (first.0, &first.1));
        let mut part = |name: String, channels: Vec<Channel>| {
            let mut columns = Vec::new();
            if let Some((len, waveform)) = channels.first().and_then(|c| Some((c.len, c.waveform.as_ref()?))) {
                let own = waveform.column(len, earliest);
                if channels.iter().any(|channel| channel.column.name == own.name) {
                    notes.push(format!(
                        "group {name}: its waveform would be a second column {}, and is not read",
                        own.name
                    ));
                } else {
                    columns.push(own);
                }
            }
            columns.extend(channels.into_iter().map(|channel| channel.column));
            Part { name, columns }
        };
        if is_one {
            return vec![part(self.name, self.channels)];
        }
        let group = self.name;
        self.channels.into_iter().map(|c| part(format!("{group}/{}", c.column.name), vec![c])).collect()
    }
}
