//! Numbers and texts of TDMS in either byte order, and the types of its values.

/// Seconds from 1904-01-01, from which TDMS counts, to 1970-01-01.
pub(super) const TO_1970_S: i64 = 2_082_844_800;

/// A property of the file, a group or a channel.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Text(String),
    Time(Stamp),
    /// Of a type that no property here has.
    Other,
}

impl Value {
    pub fn number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    pub fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }
}

/// A time: seconds since 1904-01-01 UTC without leap seconds, and 2⁻⁶⁴ of a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stamp {
    pub seconds: i64,
    pub fraction: u64,
}

impl Stamp {
    /// From another moment to this, s.
    pub fn since(self, origin: Self) -> f64 {
        let seconds = i128::from(self.seconds) - i128::from(origin.seconds);
        let fraction = i128::from(self.fraction) - i128::from(origin.fraction);
        seconds as f64 + fraction as f64 / 2.0_f64.powi(64)
    }

    /// Seconds since 1970-01-01 UTC.
    pub fn unix_s(self) -> f64 {
        self.seconds.saturating_sub(TO_1970_S) as f64 + self.fraction as f64 / 2.0_f64.powi(64)
    }
}

/// Type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Type {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Bool,
    Text,
    Stamp,
    Complex64,
    Complex128,
    /// Raw values of a DAQmx device, which scales make numbers.
    Daqmx,
}

impl Type {
    /// By its code; the name of a type that is not read.
    pub fn of(code: u32) -> Result<Self, String> {
        Ok(match code {
            1 => Self::I8,
            2 => Self::I16,
            3 => Self::I32,
            4 => Self::I64,
            5 => Self::U8,
            6 => Self::U16,
            7 => Self::U32,
            8 => Self::U64,
            9 | 0x19 => Self::F32,
            10 | 0x1a => Self::F64,
            0x20 => Self::Text,
            0x21 => Self::Bool,
            0x44 => Self::Stamp,
            0x0008_000c => Self::Complex64,
            0x0010_000d => Self::Complex128,
            0xffff_ffff => Self::Daqmx,
            11 | 0x1b => return Err("an extended float".to_owned()),
            0x4f => return Err("a fixed-point number".to_owned()),
            other => return Err(format!("of the unknown type {other:#x}")),
        })
    }

    /// By its code in a scaler of DAQmx.
    pub fn of_scaler(code: u32) -> Option<Self> {
        let all = [
            Self::U8,
            Self::I8,
            Self::U16,
            Self::I16,
            Self::U32,
            Self::I32,
            Self::U64,
            Self::I64,
            Self::F32,
            Self::F64,
        ];
        if code == u32::MAX { Some(Self::Stamp) } else { all.get(code as usize).copied() }
    }

    /// Bytes of a value; none for texts, whose length varies, and raw values.
    pub fn size(self) -> Option<usize> {
        Some(match self {
            Self::I8 | Self::U8 | Self::Bool => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 | Self::Complex64 => 8,
            Self::Stamp | Self::Complex128 => 16,
            Self::Text | Self::Daqmx => return None,
        })
    }

    /// The number in these bytes; none for what is no number.
    pub fn number(self, bytes: &[u8], is_big: bool) -> Option<f64> {
        let size = self.size().filter(|size| *size <= 8)?;
        let mut low = [0; 8];
        for (to, from) in low.iter_mut().zip(bytes.get(..size)?) {
            *to = *from;
        }
        if is_big {
            low.get_mut(..size)?.reverse();
        }
        let whole = u64::from_le_bytes(low);
        Some(match self {
            Self::U8 | Self::U16 | Self::U32 | Self::U64 | Self::Bool => whole as f64,
            Self::I8 => f64::from(whole as u8 as i8),
            Self::I16 => f64::from(whole as u16 as i16),
            Self::I32 => f64::from(whole as u32 as i32),
            Self::I64 => whole as i64 as f64,
            Self::F32 => f64::from(f32::from_bits(whole as u32)),
            Self::F64 => f64::from_bits(whole),
            _ => return None,
        })
    }
}

/// The time in 16 bytes: fraction first in little endian, seconds first in big endian.
pub(super) fn stamp(bytes: &[u8], is_big: bool) -> Option<Stamp> {
    let (first, second) = (*bytes.first_chunk::<8>()?, *bytes.get(8..)?.first_chunk::<8>()?);
    Some(if is_big {
        Stamp { seconds: i64::from_be_bytes(first), fraction: u64::from_be_bytes(second) }
    } else {
        Stamp { seconds: i64::from_le_bytes(second), fraction: u64::from_le_bytes(first) }
    })
}

/// Bytes from a place on.
pub(super) struct Cursor<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    pub is_big: bool,
}

impl<'a> Cursor<'a> {
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(n);
        let found = end.and_then(|end| self.bytes.get(self.at..end));
        let found = found.ok_or_else(|| format!("at byte {} it claims {n} bytes more than there are", self.at))?;
        self.at += n;
        Ok(found)
    }

    pub fn u32(&mut self) -> Result<u32, String> {
        let bytes = self.take(4)?.first_chunk().copied().unwrap_or_default();
        Ok(if self.is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    pub fn u64(&mut self) -> Result<u64, String> {
        let bytes = self.take(8)?.first_chunk().copied().unwrap_or_default();
        Ok(if self.is_big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) })
    }

    pub fn text(&mut self) -> Result<String, String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// A property's value behind its type.
    pub fn value(&mut self) -> Result<Value, String> {
        let at = self.at;
        let code = self.u32()?;
        if code == 0 {
            return Ok(Value::Other);
        }
        let kind = Type::of(code).map_err(|kind| format!("at byte {at} a property is {kind}"))?;
        match (kind, kind.size()) {
            (Type::Text, _) => self.text().map(Value::Text),
            (_, None) => Err(format!("at byte {at} a property has the type of raw data")),
            (Type::Stamp, Some(size)) => Ok(stamp(self.take(size)?, self.is_big).map_or(Value::Other, Value::Time)),
            (_, Some(size)) => Ok(kind.number(self.take(size)?, self.is_big).map_or(Value::Other, Value::Number)),
        }
    }
}
