//! The values of the channels, segment by segment.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::bytes::{Stamp, Type, stamp};
use super::segment::{Index, Object, Scaler, Segment};

/// The values of a channel as they are stored.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Raw {
    pub numbers: Vec<f64>,
    pub texts: Vec<String>,
    pub stamps: Vec<Stamp>,
    /// Values of DAQmx by the number of their scaler.
    pub scalers: BTreeMap<u32, Vec<f64>>,
    /// Values of a type that is not read.
    pub n_complex: usize,
}

/// Values that were read, in all channels together.
pub(super) struct Values {
    pub channels: BTreeMap<Rc<str>, Raw>,
    /// What a person should know.
    pub notes: Vec<String>,
    left: usize,
}

impl Values {
    /// None yet, and so many at most.
    pub fn new(most: usize) -> Self {
        Self { channels: BTreeMap::new(), notes: Vec::new(), left: most }
    }

    /// Reads those of a segment.
    ///
    /// # Errors
    ///
    /// What contradicts the format.
    pub fn read(&mut self, bytes: &[u8], segment: &Segment) -> Result<(), String> {
        let at = segment.start;
        let data = bytes.get(segment.start..segment.end).unwrap_or_default();
        let objects: Vec<(&Object, &Index)> = segment
            .objects
            .iter()
            .filter(|object| object.has_data)
            .filter_map(|object| Some((object, object.index.as_deref().filter(|index| index.count > 0)?)))
            .collect();
        let n_daqmx =
            objects.iter().filter(|(_, index)| !index.scalers.is_empty() || index.kind == Type::Daqmx).count();
        let has_texts = objects.iter().any(|(_, index)| index.kind == Type::Text);
        if objects.is_empty() {
            return Err(format!("the segment has {} bytes of data at byte {at} and no channel for them", data.len()));
        }
        let rest = if n_daqmx > 0 {
            if n_daqmx != objects.len() {
                return Err(format!(
                    "the segment with data at byte {at} mixes DAQmx and plain channels, which is not read; save them in separate TDMS files"
                ));
            }
            self.daqmx(data, &objects, segment)?
        } else if segment.is_interleaved && !(has_texts && objects.len() == 1) {
            self.interleaved(data, &objects, segment)?
        } else {
            self.contiguous(data, &objects, segment)?
        };
        if rest > 0 || segment.is_cut {
            let end = if segment.is_cut { "ends before its data do" } else { "is not a whole number of chunks" };
            self.notes.push(format!(
                "the segment with data from byte {at} {end}: {rest} bytes at its end are of no whole value or row"
            ));
        }
        Ok(())
    }

    /// A row after the other; how many bytes are left.
    fn interleaved(&mut self, data: &[u8], objects: &[(&Object, &Index)], segment: &Segment) -> Result<usize, String> {
        let mut width = 0;
        for (object, index) in objects {
            let size = index.kind.size().ok_or_else(|| format!("{}: texts cannot be interleaved", object.path))?;
            width += size;
            if objects.first().is_some_and(|(_, first)| first.count != index.count) {
                return Err(format!("{}: interleaved channels have different numbers of values", object.path));
            }
        }
        let mut offset = 0;
        for (object, index) in objects {
            let size = index.kind.size().unwrap_or(0);
            let rows = data.chunks_exact(width.max(1)).filter_map(|row| row.get(offset..offset + size));
            self.take(&object.path, index.kind, rows, segment.is_big)?;
            offset += size;
        }
        Ok(data.len() % width.max(1))
    }

    /// A channel after the other in each chunk; how many bytes are left.
    fn contiguous(&mut self, data: &[u8], objects: &[(&Object, &Index)], segment: &Segment) -> Result<usize, String> {
        let total = objects.iter().try_fold(0_usize, |sum, (_, index)| sum.checked_add(index.bytes));
        let chunk = total.filter(|chunk| *chunk > 0).ok_or("a chunk claims no bytes, or more than memory has")?;
        let mut rest = data;
        while rest.len() >= chunk {
            for (object, index) in objects {
                let (own, behind) = rest.split_at(index.bytes);
                rest = behind;
                self.own(object, index, own, segment.is_big)?;
            }
        }
        // The last chunk, which is not whole.
        if rest.is_empty() {
            return Ok(0);
        }
        if objects.iter().any(|(_, index)| index.kind.size().is_none()) {
            return Ok(rest.len());
        }
        let last = rest.len();
        for (object, index) in objects {
            let size = index.kind.size().unwrap_or(1);
            // A segment that was ended has less of every channel; one that was cut off has the first channels whole.
            let count = if segment.is_cut {
                index.count.min(rest.len() / size)
            } else {
                (index.count as u128 * last as u128 / chunk as u128) as usize
            };
            let Some((own, behind)) = rest.split_at_checked(count * size) else { break };
            rest = behind;
            self.own(object, index, own, segment.is_big)?;
        }
        Ok(rest.len())
    }

    fn own(&mut self, object: &Object, index: &Index, own: &[u8], is_big: bool) -> Result<(), String> {
        match index.kind.size() {
            Some(size) => self.take(&object.path, index.kind, own.chunks_exact(size), is_big),
            None => self.texts(object, index.count, own, is_big),
        }
    }

    /// Texts: the place of the end of each, then all of them.
    fn texts(&mut self, object: &Object, count: usize, own: &[u8], is_big: bool) -> Result<(), String> {
        let bad = || format!("{}: the places of its texts lie outside of them", object.path);
        let (ends, letters) = count.checked_mul(4).and_then(|n| own.split_at_checked(n)).ok_or_else(bad)?;
        self.spend(count)?;
        let texts = &mut self.channels.entry(Rc::clone(&object.path)).or_default().texts;
        let mut start = 0;
        for end in ends.chunks_exact(4) {
            let end = Type::U32.number(end, is_big).unwrap_or(0.0) as usize;
            let text = letters.get(start..end).ok_or_else(bad)?;
            texts.push(String::from_utf8_lossy(text).into_owned());
            start = end;
        }
        Ok(())
    }

    /// Samples of a device in the buffers of its cards; how many bytes are left.
    fn daqmx(&mut self, data: &[u8], objects: &[(&Object, &Index)], segment: &Segment) -> Result<usize, String> {
        let Some((_, first)) = objects.first() else { return Ok(data.len()) };
        let mut counts = vec![0_usize; first.widths.len()];
        for (object, index) in objects {
            if index.widths != first.widths {
                return Err(format!(
                    "{}: its samples have other widths than those of the channels before",
                    object.path
                ));
            }
            for scaler in &index.scalers {
                match counts.get_mut(scaler.buffer) {
                    Some(count) if *count == 0 || *count == index.count => *count = index.count,
                    _ => return Err(format!("{}: its number of samples is not that of its buffer", object.path)),
                }
            }
        }
        let buffers: Vec<(usize, usize)> = counts.into_iter().zip(first.widths.iter().copied()).collect();
        let chunk = buffers.iter().try_fold(0_usize, |sum, (n, width)| sum.checked_add(n.checked_mul(*width)?));
        let chunk = chunk.filter(|chunk| *chunk > 0).ok_or("a chunk claims no bytes, or more than memory has")?;
        let mut left = 0;
        for chunk in data.chunks(chunk) {
            let mut rest = chunk;
            for (number, (n, width)) in buffers.iter().enumerate().filter(|(_, (n, width))| *n > 0 && *width > 0) {
                let whole = (*n).min(rest.len() / width);
                let (own, behind) = rest.split_at(whole * width);
                rest = behind;
                for (object, index) in objects {
                    for scaler in index.scalers.iter().filter(|scaler| scaler.buffer == number) {
                        self.spend(whole)?;
                        let raw = self.channels.entry(Rc::clone(&object.path)).or_default();
                        let rows = own.chunks_exact(*width);
                        if scaler.kind == Type::Stamp {
                            let at = |row: &[u8]| stamp(row.get(scaler.offset..)?, segment.is_big);
                            raw.stamps.extend(rows.filter_map(at));
                            continue;
                        }
                        let is_raw = index.kind == Type::Daqmx;
                        let to = if is_raw { raw.scalers.entry(scaler.id).or_default() } else { &mut raw.numbers };
                        to.extend(rows.filter_map(|row| sample(row, scaler, segment.is_big)));
                    }
                }
                if whole < *n {
                    break;
                }
            }
            left = rest.len();
        }
        Ok(left)
    }

    fn take<'b>(
        &mut self,
        path: &Rc<str>,
        kind: Type,
        values: impl Iterator<Item = &'b [u8]> + Clone,
        is_big: bool,
    ) -> Result<(), String> {
        self.spend(values.clone().count())?;
        let raw = self.channels.entry(Rc::clone(path)).or_default();
        match kind {
            Type::Stamp => raw.stamps.extend(values.filter_map(|bytes| stamp(bytes, is_big))),
            Type::Complex64 | Type::Complex128 => raw.n_complex += values.count(),
            _ => raw.numbers.extend(values.filter_map(|bytes| kind.number(bytes, is_big))),
        }
        Ok(())
    }

    fn spend(&mut self, n: usize) -> Result<(), String> {
        let left = self.left.checked_sub(n).ok_or("its channels have more values than are read into memory")?;
        self.left = left;
        Ok(())
    }
}

fn sample(row: &[u8], scaler: &Scaler, is_big: bool) -> Option<f64> {
    let value = scaler.kind.number(row.get(scaler.offset..)?, is_big)?;
    match scaler.bit {
        None => Some(value),
        Some(bit) => Some(f64::from(u8::from((value as i64) >> bit & 1 == 1))),
    }
}
