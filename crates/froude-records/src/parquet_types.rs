//! Types of the columns of a Parquet file: what each cell becomes.
//!
//! | type in the file                                   | read as                                             |
//! |----------------------------------------------------|-----------------------------------------------------|
//! | float16, float, double, integers, decimal          | its number, in the unit of the header               |
//! | boolean                                            | 0 or 1; dimensionless without a unit in the header  |
//! | timestamp (also INT96), in ms, µs or ns            | time since the first row of the first such column   |
//! | time of day, duration (Arrow), in s, ms, µs or ns  | that time                                           |
//! | date                                               | text, `2026-03-31`                                  |
//! | UTF-8 text, categories                             | text                                                |
//!
//! A time has the unit of its type: a header without a unit gives s, one that states another unit is refused. Times since 1970 as a
//! double would lose digits below 0.2 µs, so timestamps count from the first row.
//!
//! Source: `LogicalTypes.md` and `parquet.thrift` of the Parquet format, version 2.11.

use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit as Unit, Type as Physical};
use parquet::schema::types::Type;

/// Unit of a type of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TimeUnit {
    Seconds,
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

impl TimeUnit {
    /// In the order of Arrow's `TimeUnit`.
    pub const ALL: [Self; 4] = [Self::Seconds, Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];

    pub fn symbol(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Milliseconds => "ms",
            Self::Microseconds => "us",
            Self::Nanoseconds => "ns",
        }
    }

    pub fn nanoseconds(self) -> i128 {
        match self {
            Self::Seconds => 1_000_000_000,
            Self::Milliseconds => 1_000_000,
            Self::Microseconds => 1_000,
            Self::Nanoseconds => 1,
        }
    }

    fn of(unit: Unit) -> Self {
        match unit {
            Unit::MILLIS => Self::Milliseconds,
            Unit::MICROS => Self::Microseconds,
            Unit::NANOS => Self::Nanoseconds,
        }
    }
}

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CellType {
    /// A number of 32 or 64 bits.
    Number,
    /// An integer without a sign.
    Unsigned,
    /// An integer times ten to the power of `-scale`.
    Decimal {
        scale: i32,
    },
    /// A number of 16 bits.
    Half,
    Boolean,
    Text,
    /// Days since 1970-01-01.
    Date,
    Timestamp(TimeUnit),
    TimeOfDay(TimeUnit),
    Duration(TimeUnit),
}

impl CellType {
    /// What a column holds; the name of its type where that is not read. `duration` is the unit that Arrow's schema gives it.
    pub fn of(field: &Type, duration: Option<TimeUnit>) -> Result<Self, String> {
        let info = field.get_basic_info();
        if info.has_repetition() && info.repetition() == Repetition::REPEATED {
            return Err("list".to_owned());
        }
        let (logical, converted) = (info.logical_type_ref(), info.converted_type());
        if !field.is_primitive() {
            let name = match (logical, converted) {
                (Some(LogicalType::List), _) | (_, ConvertedType::LIST) => "list",
                (Some(LogicalType::Map), _) | (_, ConvertedType::MAP | ConvertedType::MAP_KEY_VALUE) => "map",
                _ => "struct",
            };
            return Err(name.to_owned());
        }
        let physical = field.get_physical_type();
        let read = match logical {
            Some(logical) => of_logical(logical, physical),
            None => of_converted(converted, physical, field),
        };
        match (read, duration) {
            (Some(Self::Number), Some(unit)) if physical == Physical::INT64 => Ok(Self::Duration(unit)),
            (Some(read), _) => Ok(read),
            (None, _) => Err(match logical {
                Some(logical) => format!("{logical:?} ({physical})"),
                None if converted == ConvertedType::NONE => physical.to_string(),
                None => format!("{converted} ({physical})"),
            }),
        }
    }

    /// The unit that the type itself has.
    pub fn time_unit(self) -> Option<TimeUnit> {
        match self {
            Self::Timestamp(unit) | Self::TimeOfDay(unit) | Self::Duration(unit) => Some(unit),
            _ => None,
        }
    }

    /// Its name, for messages about times and dates.
    pub fn name(self) -> String {
        let word = match self {
            Self::Timestamp(_) => "timestamp",
            Self::TimeOfDay(_) => "time of day",
            Self::Duration(_) => "duration",
            Self::Date => "date",
            Self::Text => "text",
            Self::Boolean => "boolean",
            _ => "number",
        };
        self.time_unit().map_or_else(|| word.to_owned(), |unit| format!("{word}[{}]", unit.symbol()))
    }

    /// Whether its cells are kept as text.
    pub fn is_text(self) -> bool {
        matches!(self, Self::Text | Self::Date)
    }
}

fn of_logical(logical: &LogicalType, physical: Physical) -> Option<CellType> {
    Some(match (logical, physical) {
        (LogicalType::String | LogicalType::Enum | LogicalType::Json, Physical::BYTE_ARRAY) => CellType::Text,
        (LogicalType::Integer(integer), Physical::INT32 | Physical::INT64) if integer.is_signed => CellType::Number,
        (LogicalType::Integer(_), Physical::INT32 | Physical::INT64) => CellType::Unsigned,
        (LogicalType::Decimal(decimal), _) => of_decimal(decimal.scale, physical)?,
        (LogicalType::Date, Physical::INT32) => CellType::Date,
        (LogicalType::Time(time), Physical::INT32 | Physical::INT64) => CellType::TimeOfDay(TimeUnit::of(time.unit)),
        (LogicalType::Timestamp(time), Physical::INT64) => CellType::Timestamp(TimeUnit::of(time.unit)),
        (LogicalType::Float16, Physical::FIXED_LEN_BYTE_ARRAY) => CellType::Half,
        // A column of nothing but nulls.
        (LogicalType::Unknown, Physical::INT32 | Physical::INT64 | Physical::DOUBLE) => CellType::Number,
        _ => return None,
    })
}

/// By the older annotation, which files of older writers have alone.
fn of_converted(converted: ConvertedType, physical: Physical, field: &Type) -> Option<CellType> {
    use ConvertedType as C;
    Some(match (converted, physical) {
        (C::NONE, Physical::BOOLEAN) => CellType::Boolean,
        (C::NONE, Physical::INT32 | Physical::INT64 | Physical::FLOAT | Physical::DOUBLE) => CellType::Number,
        (C::NONE, Physical::INT96) => CellType::Timestamp(TimeUnit::Nanoseconds),
        (C::NONE | C::UTF8 | C::ENUM | C::JSON, Physical::BYTE_ARRAY) => CellType::Text,
        (C::INT_8 | C::INT_16 | C::INT_32, Physical::INT32) | (C::INT_64, Physical::INT64) => CellType::Number,
        (C::UINT_8 | C::UINT_16 | C::UINT_32, Physical::INT32) | (C::UINT_64, Physical::INT64) => CellType::Unsigned,
        (C::DECIMAL, _) => of_decimal(field.get_scale(), physical)?,
        (C::DATE, Physical::INT32) => CellType::Date,
        (C::TIME_MILLIS, Physical::INT32) => CellType::TimeOfDay(TimeUnit::Milliseconds),
        (C::TIME_MICROS, Physical::INT64) => CellType::TimeOfDay(TimeUnit::Microseconds),
        (C::TIMESTAMP_MILLIS, Physical::INT64) => CellType::Timestamp(TimeUnit::Milliseconds),
        (C::TIMESTAMP_MICROS, Physical::INT64) => CellType::Timestamp(TimeUnit::Microseconds),
        _ => return None,
    })
}

fn of_decimal(scale: i32, physical: Physical) -> Option<CellType> {
    let is_held =
        matches!(physical, Physical::INT32 | Physical::INT64 | Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY);
    is_held.then_some(CellType::Decimal { scale })
}
