//! Streams of an OLE compound file, with every chain of sectors checked. Microsoft, MS-CFB.

use crate::ForeignError;

/// First bytes of an OLE file.
pub(crate) const MAGIC: [u8; 8] = [0xD0, 0xCF, 0x11, 0xE0, 0xA1, 0xB1, 0x1A, 0xE1];
/// Ids of sectors from here on have other meanings; the end of a chain is one.
const MAX_SECTOR: u32 = 0xFFFF_FFFA;
/// Streams shorter than this lie in the mini stream.
const MINI_CUTOFF: usize = 4096;
const MINI_SECTOR: usize = 64;

/// The little-endian number of two bytes at `at`.
pub(crate) fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// The little-endian number of four bytes at `at`.
pub(crate) fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A compound file.
pub(crate) struct Ole<'a> {
    bytes: &'a [u8],
    sector: usize,
    fat: Vec<u32>,
    mini_fat: Vec<u32>,
    mini_stream: Vec<u8>,
    /// Name, first sector and length of each entry of the directory.
    entries: Vec<(String, u32, usize)>,
}

impl<'a> Ole<'a> {
    /// Reads the tables of sectors and the directory.
    ///
    /// # Errors
    ///
    /// If a chain of sectors does not end or leaves the file.
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, ForeignError> {
        Self::parse(bytes).ok_or_else(|| {
            ForeignError(
                "begins as an old Excel workbook (OLE) does, but its table of sectors is damaged; copy the file again from its source"
                    .into(),
            )
        })
    }

    fn parse(bytes: &'a [u8]) -> Option<Self> {
        let sector = match u16_at(bytes, 30)? {
            9 => 512,
            12 => 4096,
            _ => return None,
        };
        let mut file = Self { bytes, sector, fat: vec![], mini_fat: vec![], mini_stream: vec![], entries: vec![] };
        let n_sectors = bytes.len() / sector + 1;
        // The sectors of the FAT are listed in the header, and on in a chain of their own.
        let mut fat_sectors: Vec<u32> = (0..109).map(|i| u32_at(bytes, 76 + 4 * i)).collect::<Option<_>>()?;
        let mut next = u32_at(bytes, 68)?;
        for _ in 0..=n_sectors {
            if next >= MAX_SECTOR {
                break;
            }
            let list = file.sector(next)?;
            fat_sectors.extend(list.as_chunks().0.iter().copied().map(u32::from_le_bytes));
            next = fat_sectors.pop()?;
        }
        if next < MAX_SECTOR {
            return None;
        }
        fat_sectors.retain(|id| *id < MAX_SECTOR);
        if fat_sectors.len() > n_sectors {
            return None;
        }
        for id in fat_sectors {
            file.fat.extend(file.sector(id)?.as_chunks().0.iter().copied().map(u32::from_le_bytes));
        }
        let directory = file.chain(u32_at(bytes, 48)?, usize::MAX)?;
        for entry in directory.chunks_exact(128) {
            let units: Vec<u16> = entry.get(..64)?.as_chunks().0.iter().copied().map(u16::from_le_bytes).collect();
            let name = String::from_utf16_lossy(&units);
            let name = name.split('\0').next().unwrap_or_default().to_owned();
            file.entries.push((name, u32_at(entry, 116)?, u32_at(entry, 120)? as usize));
        }
        if u32_at(bytes, 64)? > 0 {
            let (_, start, length) = file.entries.first()?;
            file.mini_stream = file.chain(*start, *length)?;
            let list = file.chain(u32_at(bytes, 60)?, usize::MAX)?;
            file.mini_fat = list.as_chunks().0.iter().copied().map(u32::from_le_bytes).collect();
        }
        Some(file)
    }

    /// Whether it has a stream or folder of that name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.entries.iter().any(|(own, ..)| own.eq_ignore_ascii_case(name))
    }

    /// The bytes of a stream; `None` if there is none of that name or its chain is damaged.
    pub(crate) fn stream(&self, name: &str) -> Option<Vec<u8>> {
        let (_, start, length) = self.entries.iter().find(|(own, ..)| own.eq_ignore_ascii_case(name))?;
        if *length >= MINI_CUTOFF {
            return self.chain(*start, *length);
        }
        let mut out = Vec::new();
        let mut id = *start;
        while out.len() < *length {
            let start = id as usize * MINI_SECTOR;
            // A sector at the very end is empty: a chain in it would never grow.
            out.extend(self.mini_stream.get(start..).filter(|rest| !rest.is_empty())?.iter().take(MINI_SECTOR));
            id = *self.mini_fat.get(id as usize)?;
            if out.len() > self.mini_stream.len() {
                return None;
            }
        }
        out.truncate(*length);
        Some(out)
    }

    /// The last sector of a file may be cut short.
    fn sector(&self, id: u32) -> Option<&'a [u8]> {
        let start = (id as usize + 1).checked_mul(self.sector)?;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        Some(rest.get(..self.sector).unwrap_or(rest))
    }

    /// The bytes of a chain, no more than `length`, or all of it. No chain is longer than the file.
    fn chain(&self, start: u32, length: usize) -> Option<Vec<u8>> {
        let mut out = Vec::new();
        let mut id = start;
        while id < MAX_SECTOR && out.len() < length {
            out.extend_from_slice(self.sector(id)?);
            if out.len() > self.bytes.len() {
                return None;
            }
            id = *self.fat.get(id as usize)?;
        }
        if length != usize::MAX && out.len() < length {
            return None;
        }
        out.truncate(length);
        Some(out)
    }
}
