//! How the columns of a run lie in messages: topics, fields, bytes.
//!
//! A channel `y/position` is the field `position` of topic `/axis/y`; `truth/y/drag` is `drag` of `/truth/y`; `force` is
//! `force` of `/force`. A topic has one message per tick: a flat ROS 2 message of fixed length, which robotics viewers and
//! PlotJuggler open as it is. Units and the way back to channel names stand in the topic's metadata.
//!
//! **Bytes.** CDR, little endian (OMG DDSI-RTPS 10.2): four bytes `00 01 00 00`, then the fields in order, each aligned to
//! its own size counted from behind those four. Eight-byte fields come first, codes of one byte last: nothing is padding.

use std::collections::BTreeMap;

use crate::error::RecordError;
use crate::units::parse_unit;

/// What stands before every message.
pub(crate) const CDR_HEADER: [u8; 4] = [0, 1, 0, 0];

/// Key of a topic's metadata that turns its fields into channel names; no field can have a dot in its name.
pub(crate) const PREFIX_KEY: &str = "froude.prefix";

/// The axes' channels, in the order of [`AxisSample`].
pub(crate) const AXIS: [(&str, &str, Kind); 9] = [
    ("encoder", "1", Kind::I64),
    ("position", "m", Kind::F64),
    ("reference_position", "m", Kind::F64),
    ("reference_velocity", "m/s", Kind::F64),
    ("reference_acceleration", "m/s^2", Kind::F64),
    ("command", "V", Kind::F64),
    ("current", "A", Kind::F64),
    ("state", "1", Kind::U8),
    ("fault", "1", Kind::U8),
];

/// Type of a field in its message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    F64,
    /// A number in single precision; written by other programs.
    F32,
    /// A count; exact as a column up to 2⁵³.
    I64,
    /// A count of 32 bits; written by other programs.
    I32,
    /// The same without sign.
    U32,
    /// A code.
    U8,
}

impl Kind {
    const ALL: [(Self, &'static str); 6] = [
        (Self::F64, "float64"),
        (Self::F32, "float32"),
        (Self::I64, "int64"),
        (Self::I32, "int32"),
        (Self::U32, "uint32"),
        (Self::U8, "uint8"),
    ];

    fn ros_name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    fn of_ros_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, ros)| *ros == name).map(|(kind, _)| kind)
    }

    fn size(self) -> usize {
        match self {
            Self::F64 | Self::I64 => 8,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::U8 => 1,
        }
    }

    fn write(self, value: f64, out: &mut Vec<u8>) {
        // Float to integer saturates and takes NaN to 0: a code or a count is always in range.
        match self {
            Self::F64 => out.extend_from_slice(&value.to_le_bytes()),
            Self::F32 => out.extend_from_slice(&(value as f32).to_le_bytes()),
            Self::I64 => out.extend_from_slice(&(value as i64).to_le_bytes()),
            Self::I32 => out.extend_from_slice(&(value as i32).to_le_bytes()),
            Self::U32 => out.extend_from_slice(&(value as u32).to_le_bytes()),
            Self::U8 => out.push(value as u8),
        }
    }

    /// The field at the beginning of `bytes`; `None` where they are too few.
    fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
            Self::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
            Self::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Self::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Self::U8 => f64::from(*bytes.first()?),
        })
    }
}

/// One column: its name, unit, and type in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Name without unit (`y/position`).
    pub name: String,
    /// Unit text.
    pub unit: String,
    /// Type in the file.
    pub kind: Kind,
}

/// The columns of a run, in the order in which values are handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    channels: Vec<ChannelSpec>,
    topics: Vec<Topic>,
}

/// One topic: which columns are its fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Topic {
    pub name: String,
    /// What stands before the field in a channel's name: `y/`, `truth/y/`, or nothing.
    pub prefix: String,
    pub fields: Vec<Field>,
}

/// One field: its name in the message, and the column that it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Field {
    pub name: String,
    pub kind: Kind,
    pub unit: String,
    pub column: usize,
}

impl Layout {
    /// The columns of a carriage: the long axis, the short one and the force sensor where there are any, and a twin's truths (name, unit).
    ///
    /// # Errors
    ///
    /// A truth whose name does not begin with `truth/`, or as [`Layout::new`].
    pub fn carriage(has_x: bool, has_force: bool, truths: &[(&str, &str)]) -> Result<Self, RecordError> {
        let axis = |axis: &'static str| {
            AXIS.iter().map(move |(name, unit, kind)| ChannelSpec {
                name: format!("{axis}/{name}"),
                unit: (*unit).to_owned(),
                kind: *kind,
            })
        };
        let number =
            |(name, unit): (&str, &str)| ChannelSpec { name: name.to_owned(), unit: unit.to_owned(), kind: Kind::F64 };
        if let Some((name, _)) = truths.iter().find(|(name, _)| !name.starts_with("truth/")) {
            return Err(refuse(name, "is a twin's truth; its name begins with `truth/`"));
        }
        let force = has_force.then_some(("force", "N"));
        let others = force.into_iter().chain(truths.iter().copied()).map(number);
        let short = has_x.then(|| axis("x")).into_iter().flatten();
        Self::new(axis("y").chain(short).chain(others).collect())
    }

    /// Any columns.
    ///
    /// # Errors
    ///
    /// A name that is not made of `a-z`, `0-9`, `_` and `/`, a name that appears twice, a unit that cannot be read.
    pub fn new(channels: Vec<ChannelSpec>) -> Result<Self, RecordError> {
        if channels.is_empty() {
            return Err(refuse("", "a run needs at least one channel"));
        }
        let mut topics: Vec<Topic> = Vec::new();
        for (column, channel) in channels.iter().enumerate() {
            check(channel)?;
            if channels[..column].iter().any(|other| other.name == channel.name) {
                return Err(refuse(&channel.name, "appears twice; rename or leave out one"));
            }
            let (prefix, field) = match channel.name.rfind('/') {
                Some(at) => channel.name.split_at(at + 1),
                None => ("", channel.name.as_str()),
            };
            let name = topic_name(prefix, field);
            let field = Field { name: field.to_owned(), kind: channel.kind, unit: channel.unit.clone(), column };
            match topics.iter_mut().find(|t| t.name == name) {
                Some(topic) if topic.prefix == prefix => topic.fields.push(field),
                Some(topic) => {
                    return Err(refuse(
                        &channel.name,
                        &format!("would share the topic {name} with {}{}", topic.prefix, topic.fields[0].name),
                    ));
                }
                None => topics.push(Topic { name, prefix: prefix.to_owned(), fields: vec![field] }),
            }
        }
        for topic in &mut topics {
            // Large fields first: then none needs padding.
            topic.fields.sort_by_key(|field| std::cmp::Reverse(field.kind.size()));
        }
        Ok(Self { channels, topics })
    }

    /// The columns, in the order in which values are handed in.
    #[must_use]
    pub fn channels(&self) -> &[ChannelSpec] {
        &self.channels
    }

    pub(crate) fn topics(&self) -> &[Topic] {
        &self.topics
    }
}

fn refuse(name: &str, problem: &str) -> RecordError {
    RecordError::Refused(format!("channel `{name}` {problem}"))
}

fn check(channel: &ChannelSpec) -> Result<(), RecordError> {
    let is_word = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_lowercase())
            && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
            && !part.ends_with('_')
            && !part.contains("__")
    };
    if !channel.name.split('/').all(is_word) {
        let problem = "is not a name: write words of a-z, 0-9 and _, joined by /, as in `y/position`";
        return Err(refuse(&channel.name, problem));
    }
    parse_unit(&channel.unit)
        .map(|_| ())
        .map_err(|e| refuse(&channel.name, &format!("has the unit {:?}, which cannot be read: {e}", channel.unit)))
}

/// `/axis/y` for `y/`, `/truth/y` for `truth/y/`, `/force` for a channel without prefix.
fn topic_name(prefix: &str, field: &str) -> String {
    match prefix.trim_end_matches('/') {
        "" => format!("/{field}"),
        axis @ ("y" | "x") => format!("/axis/{axis}"),
        other => format!("/{other}"),
    }
}

impl Topic {
    /// ROS 2 name of the message: `froude_msgs/msg/AxisY`.
    pub fn schema_name(&self) -> String {
        let camel = self.name.split(['/', '_']).filter_map(|word| {
            let mut letters = word.chars();
            Some(letters.next()?.to_ascii_uppercase().to_string() + letters.as_str())
        });
        format!("froude_msgs/msg/{}", camel.collect::<String>())
    }

    /// The message's definition, a field a line.
    pub fn schema_text(&self) -> String {
        self.fields.iter().map(|f| format!("{} {}  # [{}]\n", f.kind.ros_name(), f.name, f.unit)).collect()
    }

    /// Units by field, and the prefix of the channels' names.
    pub fn metadata(&self) -> BTreeMap<String, String> {
        let units = self.fields.iter().map(|f| (f.name.clone(), f.unit.clone()));
        units.chain([(PREFIX_KEY.to_owned(), self.prefix.clone())]).collect()
    }

    /// Appends the message of one tick.
    pub fn encode(&self, row: &[f64], out: &mut Vec<u8>) {
        out.extend_from_slice(&CDR_HEADER);
        let start = out.len();
        for field in &self.fields {
            let size = field.kind.size();
            out.resize(start + (out.len() - start).next_multiple_of(size), 0);
            field.kind.write(row.get(field.column).copied().unwrap_or(f64::NAN), out);
        }
    }
}

/// Where the fields of a topic lie in its messages, as its schema says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Decoder {
    /// Field name, type, offset behind the CDR header.
    pub fields: Vec<(String, Kind, usize)>,
}

impl Decoder {
    /// Reads a flat message definition; `None` where it holds anything but plain numbers.
    pub fn parse(schema: &str) -> Option<Self> {
        let mut fields = Vec::new();
        let mut at: usize = 0;
        for line in schema.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            let (kind, name) = line.split_once(char::is_whitespace)?;
            let name = name.trim();
            if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                return None;
            }
            let kind = Kind::of_ros_name(kind)?;
            at = at.next_multiple_of(kind.size());
            fields.push((name.to_owned(), kind, at));
            at += kind.size();
        }
        (!fields.is_empty() && fields.len() <= 10_000).then_some(Self { fields })
    }

    /// Field of a message; `None` where the message is too short or of another byte order.
    pub fn field(message: &[u8], kind: Kind, offset: usize) -> Option<f64> {
        let body = message.strip_prefix(&CDR_HEADER[..])?;
        kind.read(body.get(offset..)?)
    }
}

/// What one axis did in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisSample {
    /// Unwrapped count.
    pub encoder: i64,
    /// Position, m.
    pub position_m: f64,
    /// Reference position, m.
    pub reference_position_m: f64,
    /// Reference speed, m/s.
    pub reference_velocity_m_s: f64,
    /// Reference acceleration, m/s².
    pub reference_acceleration_m_s2: f64,
    /// Drive command v_c, V.
    pub command_v: f64,
    /// Motor current, A.
    pub current_a: f64,
    /// Phase of the controller, as it numbers them.
    pub state: u8,
    /// Latched fault, as the controller numbers them; 0 for none.
    pub fault: u8,
}

/// What a carriage did in one tick, for [`Layout::carriage`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarriageSample {
    /// The long axis.
    pub y: AxisSample,
    /// The short one; `None` where the layout has none.
    pub x: Option<AxisSample>,
    /// What the water exerts against +y motion, N; left out where the layout has no sensor.
    pub force_n: f64,
}

impl CarriageSample {
    /// The row that [`Layout::carriage`] describes, into a buffer that is used again.
    pub fn row(&self, has_force: bool, truths: &[f64], row: &mut Vec<f64>) {
        row.clear();
        for axis in [Some(&self.y), self.x.as_ref()].into_iter().flatten() {
            row.extend([
                axis.encoder as f64,
                axis.position_m,
                axis.reference_position_m,
                axis.reference_velocity_m_s,
                axis.reference_acceleration_m_s2,
                axis.command_v,
                axis.current_a,
                f64::from(axis.state),
                f64::from(axis.fault),
            ]);
        }
        if has_force {
            row.push(self.force_n);
        }
        row.extend_from_slice(truths);
    }
}

/// A message as the Log panels of viewers read it (`rcl_interfaces/msg/Log`), for events.
pub(crate) mod text {
    use super::CDR_HEADER;

    pub const TOPIC: &str = "/events";
    pub const SCHEMA_NAME: &str = "rcl_interfaces/msg/Log";
    pub const SCHEMA: &str = "\
builtin_interfaces/Time stamp
uint8 level
string name
string msg
string file
string function
uint32 line
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

    /// The message of an event: `level` 20 is information, 30 a warning, 40 an error.
    pub fn encode(log_time_ns: u64, level: u8, name: &str, text: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(&CDR_HEADER);
        let start = out.len();
        let align = |out: &mut Vec<u8>| out.resize(start + (out.len() - start).next_multiple_of(4), 0);
        let seconds = i32::try_from(log_time_ns / 1_000_000_000).unwrap_or(i32::MAX);
        out.extend_from_slice(&seconds.to_le_bytes());
        out.extend_from_slice(&((log_time_ns % 1_000_000_000) as u32).to_le_bytes());
        out.push(level);
        for part in [name, text, "", ""] {
            align(out);
            let length = u32::try_from(part.len() + 1).unwrap_or(u32::MAX);
            out.extend_from_slice(&length.to_le_bytes());
            out.extend_from_slice(part.as_bytes());
            out.push(0);
        }
        align(out);
        out.extend_from_slice(&0u32.to_le_bytes());
    }

    /// Name and text of an event; `None` where the message is cut short.
    pub fn decode(message: &[u8]) -> Option<(String, String)> {
        let body = message.strip_prefix(&CDR_HEADER[..])?;
        let mut at = 9;
        let mut string = || {
            at = usize::next_multiple_of(at, 4);
            let length = u32::from_le_bytes(*body.get(at..)?.first_chunk()?) as usize;
            at += 4;
            let bytes = body.get(at..at.checked_add(length)?)?;
            at += length;
            Some(String::from_utf8_lossy(bytes.strip_suffix(&[0]).unwrap_or(bytes)).into_owned())
        };
        Some((string()?, string()?))
    }
}
