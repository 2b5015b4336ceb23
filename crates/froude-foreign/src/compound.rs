//! Compound elements of HDF5: records with named members.

use hdf5_pure::{CompoundMember, Datatype, DatatypeByteOrder};

use crate::variables::Value;

/// Whether a record is a complex number, as h5py and MATLAB write it.
pub(crate) fn is_complex(members: &[CompoundMember]) -> bool {
    let names: Vec<&str> = members.iter().map(|member| &*member.name).collect();
    matches!(names[..], ["r", "i"] | ["real", "imag"])
}

/// The members of `n` records as fields; a member that is an array of numbers has one column for each.
pub(crate) fn value(datatype: &Datatype, bytes: &[u8], n: usize) -> Value {
    let size = datatype.type_size() as usize;
    if size == 0 || bytes.len() != n.saturating_mul(size) {
        return Value::Unread(format!("announces {n} records of {size} bytes and has {} bytes", bytes.len()));
    }
    match datatype {
        Datatype::Compound { members, .. } => {
            let field = |member: &CompoundMember| (member.name.clone(), column(member, bytes, size, n));
            Value::Fields(members.iter().map(field).collect())
        }
        datatype => column_of(datatype, 0, bytes, size, n),
    }
}

fn column(member: &CompoundMember, bytes: &[u8], size: usize, n: usize) -> Value {
    column_of(&member.datatype, usize::try_from(member.byte_offset).unwrap_or(usize::MAX), bytes, size, n)
}

fn column_of(datatype: &Datatype, offset: usize, bytes: &[u8], size: usize, n: usize) -> Value {
    let own = datatype.type_size() as usize;
    let cells =
        || bytes.chunks(size).map(move |record| record.get(offset..offset.saturating_add(own)).unwrap_or_default());
    if let Datatype::String { .. } = datatype {
        let text = |cell: &[u8]| {
            let end = cell.iter().position(|b| *b == 0).unwrap_or(cell.len());
            String::from_utf8_lossy(cell.get(..end).unwrap_or_default()).trim_end().to_owned()
        };
        return Value::Texts(cells().map(text).collect());
    }
    let (base, columns) = match datatype {
        Datatype::Array { base_type, dimensions } => {
            (&**base_type, dimensions.iter().fold(1_usize, |n, side| n.saturating_mul(*side as usize)))
        }
        datatype => (datatype, 1),
    };
    let width = base.type_size() as usize;
    if width.saturating_mul(columns) != own {
        return Value::Unread(format!("has elements of the type {datatype}, whose size contradicts itself"));
    }
    let mut data = Vec::with_capacity(n.saturating_mul(columns).min(bytes.len()));
    for i in 0..columns {
        for cell in cells() {
            let number = cell.get(i * width..(i + 1) * width).and_then(|cell| number(base, cell));
            let Some(number) = number else {
                return Value::Unread(format!("has elements of the type {datatype}, which is not read"));
            };
            data.push(number);
        }
    }
    Value::Numbers { rows: n, columns, data, unit: String::new() }
}

/// A number of a whole number of bytes; true and false as 1 and 0.
fn number(datatype: &Datatype, cell: &[u8]) -> Option<f64> {
    let ordered = |order: &DatatypeByteOrder| {
        let mut cell = cell.to_vec();
        match order {
            DatatypeByteOrder::LittleEndian => {}
            DatatypeByteOrder::BigEndian => cell.reverse(),
            DatatypeByteOrder::Vax => return None,
        }
        Some(cell)
    };
    match datatype {
        Datatype::FloatingPoint { byte_order, layout, .. } if usize::from(layout.bit_precision) == 8 * cell.len() => {
            let cell = ordered(byte_order)?;
            match cell.len() {
                2 => Some(half::f16::from_le_bytes(*cell.first_chunk()?).to_f64()),
                4 => Some(f64::from(f32::from_le_bytes(*cell.first_chunk()?))),
                8 => Some(f64::from_le_bytes(*cell.first_chunk()?)),
                _ => None,
            }
        }
        Datatype::FixedPoint { byte_order, layout, .. }
            if usize::from(layout.bit_precision) == 8 * cell.len() && cell.len() <= 8 =>
        {
            let mut cell = ordered(byte_order)?;
            let is_negative = layout.signed && cell.last()? & 0x80 != 0;
            cell.resize(8, if is_negative { 0xFF } else { 0 });
            let bits = u64::from_le_bytes(*cell.first_chunk()?);
            Some(if layout.signed { bits as i64 as f64 } else { bits as f64 })
        }
        // PyTables stores true and false so.
        Datatype::BitField { size: 1, .. } => cell.first().copied().map(f64::from),
        Datatype::Enumeration { base_type, members, .. } => {
            let names: Vec<&str> = members.iter().map(|member| &*member.name).collect();
            if names == ["FALSE", "TRUE"] { number(base_type, cell) } else { None }
        }
        _ => None,
    }
}
