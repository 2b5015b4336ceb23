//! The records of an MCAP file, one after the other, whatever bytes are in it.
//!
//! Lengths are believed only as far as the file goes, and as far as [`LARGEST_CHUNK`] and [`LARGEST_RECORD`] allow; records
//! that nobody needs are only summed. A file that ends too early ends; it is not an error here.
//!
//! Format: the MCAP specification, version 0 (mcap.dev/spec).

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom};

use mcap::MAGIC;
use mcap::records::op;

use crate::hash::{Fingerprint, fingerprint_of};

/// Largest chunk, packed and unpacked. Froude writes at most 1 MiB, other programs usually 1 to 8.
const LARGEST_CHUNK: u64 = 64 << 20;

/// Largest schema, channel or metadata record.
const LARGEST_RECORD: u64 = 1 << 20;

/// Opcode and length before every record.
const HEAD: u64 = 9;

/// The last record: two offsets and the checksum of the summary, which is of everything from the summary's beginning to itself.
const FOOTER: u64 = HEAD + 20;
const SUM_IN_FOOTER: usize = HEAD as usize + 16;

/// How far a file could be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// To the end of its data.
    Whole,
    /// To the end of its data, which are not those that were written.
    Changed { problem: String },
    /// It ends before its end mark; `lost` bytes are left of the record at `offset`.
    CutOff { offset: u64, lost: u64 },
    /// At `offset` stands something that cannot be passed over.
    Broken { offset: u64, lost: u64, problem: String },
}

/// What comes next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Step {
    /// A record that somebody may need: its bytes are in the buffer.
    Record { opcode: u8, offset: u64 },
    /// Nothing more.
    End(End),
}

/// What a file's summary is worth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Summary {
    /// There is none, or its place cannot be found: the file was cut off.
    None,
    /// The walk stands at its beginning.
    Here,
    /// Its checksum is another: nothing in it is believed.
    Damaged(String),
}

/// A walk over the records.
pub(crate) struct Walk<R> {
    input: R,
    length: u64,
    at: u64,
    /// Of all bytes passed since the beginning of the file.
    sum: crc32fast::Hasher,
    /// The record's bytes.
    pub body: Vec<u8>,
}

impl<R: Read + Seek> Walk<R> {
    /// `None` where the file does not begin as MCAP does; an empty or cut beginning counts as one that does.
    pub fn new(mut input: R) -> io::Result<Option<Self>> {
        let length = input.seek(SeekFrom::End(0))?;
        input.seek(SeekFrom::Start(0))?;
        let mut magic = Vec::new();
        input.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
        let is_mcap = MAGIC.starts_with(&magic);
        let mut sum = crc32fast::Hasher::new();
        sum.update(&magic);
        Ok(is_mcap.then_some(Self { input, length, at: magic.len() as u64, sum, body: Vec::new() }))
    }

    /// Bytes of the file.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Back to the first record.
    pub fn rewind(&mut self) -> io::Result<()> {
        let at = (MAGIC.len() as u64).min(self.length);
        self.sum.reset();
        self.sum.update(&MAGIC[..at as usize]);
        self.go_to(at)
    }

    /// To the summary at the end of a whole file, when its checksum is right.
    pub fn go_to_summary(&mut self) -> io::Result<Summary> {
        let magic = MAGIC.len() as u64;
        let Some(footer) = self.length.checked_sub(FOOTER + magic).filter(|at| *at >= magic) else {
            return Ok(Summary::None);
        };
        self.input.seek(SeekFrom::Start(footer))?;
        let mut end = Vec::new();
        self.input.by_ref().take(FOOTER + magic).read_to_end(&mut end)?;
        let is_footer = end.first() == Some(&op::FOOTER) && end.ends_with(MAGIC);
        let number = |at: usize| end.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |b| u64::from_le_bytes(*b));
        let start = number(HEAD as usize);
        if !is_footer || start < magic || start >= footer {
            return Ok(Summary::None);
        }
        let said = end.get(SUM_IN_FOOTER..).and_then(<[u8]>::first_chunk).map_or(0, |b| u32::from_le_bytes(*b));
        let found = self.sum_of(start, footer + SUM_IN_FOOTER as u64)?;
        if said != 0 && said != found {
            return Ok(Summary::Damaged(format!("the checksum of its summary is {found:08x} and not {said:08x}")));
        }
        self.go_to(start)?;
        Ok(Summary::Here)
    }

    /// CRC-32 of these bytes, in pieces.
    fn sum_of(&mut self, from: u64, to: u64) -> io::Result<u32> {
        self.input.seek(SeekFrom::Start(from))?;
        let mut sum = crc32fast::Hasher::new();
        pass(&mut self.input.by_ref().take(to - from), &mut sum)?;
        Ok(sum.finalize())
    }

    /// All bytes from the beginning to the end, for a fingerprint; the walk begins again.
    pub fn fingerprint(&mut self) -> io::Result<Fingerprint> {
        self.input.seek(SeekFrom::Start(0))?;
        let found = fingerprint_of(&mut self.input)?;
        self.rewind()?;
        Ok(found)
    }

    fn go_to(&mut self, at: u64) -> io::Result<()> {
        self.at = at;
        self.input.seek(SeekFrom::Start(at)).map(|_| ())
    }

    /// The next record that [`is_needed`]; the end is given again and again.
    pub fn next(&mut self) -> io::Result<Step> {
        loop {
            let offset = self.at;
            let lost = self.length.saturating_sub(offset);
            let cut = Ok(Step::End(End::CutOff { offset, lost }));
            let broken = |problem: String| Ok(Step::End(End::Broken { offset, lost, problem }));
            let mut head = [0; HEAD as usize];
            if lost < HEAD {
                return cut;
            }
            self.input.read_exact(&mut head)?;
            let opcode = head[0];
            let length = head[1..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
            let limit = if opcode == op::CHUNK { LARGEST_CHUNK + LARGEST_RECORD } else { LARGEST_RECORD };
            if opcode == 0 {
                // Also what a power cut leaves: zeros where the disk had not come yet.
                self.go_to(offset)?;
                return if length == 0 { cut } else { broken("there is no record that begins with 0".to_owned()) };
            }
            if opcode == op::DATA_END {
                return Ok(Step::End(self.end_of_data(offset, length)?));
            }
            if opcode == op::FOOTER {
                self.go_to(offset)?;
                let is_last = offset + FOOTER + MAGIC.len() as u64 == self.length;
                return if is_last {
                    Ok(Step::End(End::Changed { problem: "the mark of the end of its data is not there".to_owned() }))
                } else {
                    broken(format!("a footer stands there, and the file goes on for {lost} bytes"))
                };
            }
            if is_needed(opcode) && length > limit {
                self.go_to(offset)?;
                return broken(format!("a record of {length} bytes begins there; at most {limit} are read"));
            }
            if length > lost - HEAD {
                self.go_to(offset)?;
                return cut;
            }
            self.at = offset + HEAD + length;
            self.sum.update(&head);
            if !is_needed(opcode) {
                pass(&mut self.input.by_ref().take(length), &mut self.sum)?;
                continue;
            }
            self.body.clear();
            let read = self.input.by_ref().take(length).read_to_end(&mut self.body)?;
            if read as u64 != length {
                self.go_to(offset)?;
                return cut;
            }
            self.sum.update(&self.body);
            return Ok(Step::Record { opcode, offset });
        }
    }

    /// The record that ends the data; it has the checksum of everything before it, zero where none was computed.
    fn end_of_data(&mut self, offset: u64, length: u64) -> io::Result<End> {
        let lost = self.length.saturating_sub(offset);
        let mut said = [0; 4];
        let end = if length != 4 {
            let problem = format!("an end of data of {length} bytes stands there; it has 4");
            End::Broken { offset, lost, problem }
        } else if lost < HEAD + 4 {
            End::CutOff { offset, lost }
        } else {
            self.input.read_exact(&mut said)?;
            let (said, found) = (u32::from_le_bytes(said), self.sum.clone().finalize());
            if said == 0 || said == found {
                End::Whole
            } else {
                End::Changed { problem: format!("the checksum of its data is {found:08x} and not {said:08x}") }
            }
        };
        self.go_to(offset)?;
        Ok(end)
    }

    /// The next record of the summary that declares something; `None` at its end.
    pub fn next_of_summary(&mut self) -> io::Result<Option<u8>> {
        loop {
            match self.next()? {
                Step::Record { opcode: opcode @ (op::SCHEMA | op::CHANNEL), .. } => return Ok(Some(opcode)),
                Step::Record { .. } => {}
                Step::End(_) => return Ok(None),
            }
        }
    }
}

/// Reads to the end and keeps nothing but the sum.
fn pass(input: &mut impl Read, sum: &mut crc32fast::Hasher) -> io::Result<()> {
    let mut buffer = [0; 4096];
    loop {
        match input.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(n) => sum.update(&buffer[..n]),
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
}

/// Records that a run is made of.
fn is_needed(opcode: u8) -> bool {
    matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::METADATA)
}

/// The records of a chunk, unpacked and checked; `unpacked` is memory that is used again.
pub(crate) fn unpack<'a>(body: &'a [u8], unpacked: &'a mut Vec<u8>) -> Result<&'a [u8], String> {
    unpacked.clear();
    let chunk = Chunk::parse(body).ok_or_else(|| "its head does not fit into it".to_owned())?;
    let Chunk { size, sum, packing, packed } = chunk;
    if size > LARGEST_CHUNK {
        return Err(format!("it unpacks to {size} bytes; at most {LARGEST_CHUNK} are read"));
    }
    let limit = size + 1;
    let in_words = |e: io::Error| format!("it cannot be unpacked ({e})");
    let content = match packing {
        "" => packed,
        "lz4" => {
            let decoder = lz4::Decoder::new(packed).map_err(in_words)?;
            decoder.take(limit).read_to_end(unpacked).map_err(in_words)?;
            unpacked
        }
        "zstd" => {
            let decoder = zstd::stream::read::Decoder::with_buffer(packed).map_err(in_words)?;
            decoder.take(limit).read_to_end(unpacked).map_err(in_words)?;
            unpacked
        }
        other => {
            return Err(format!(
                "it is packed with {:?}, which is not known",
                other.chars().take(40).collect::<String>()
            ));
        }
    };
    if content.len() as u64 != size {
        return Err(format!("it unpacks to {} bytes and not to {size}", content.len()));
    }
    let found = crc32fast::hash(content);
    // Zero stands for a sum that was not computed.
    if sum != 0 && found != sum {
        return Err(format!("its checksum is {found:08x} and not {sum:08x}"));
    }
    Ok(content)
}

/// The records inside a chunk: opcode and bytes, or an error where they do not fit.
pub(crate) fn records(mut content: &[u8]) -> impl Iterator<Item = Result<(u8, &[u8]), ()>> {
    std::iter::from_fn(move || {
        let (opcode, rest) = content.split_first()?;
        if *opcode == 0 {
            // No record begins so; 64 MiB of zeros would be seven million of them.
            content = &[];
            return Some(Err(()));
        }
        let Some((length, rest)) = rest.split_first_chunk::<8>() else {
            content = &[];
            return Some(Err(()));
        };
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let Some((body, rest)) = rest.split_at_checked(length) else {
            content = &[];
            return Some(Err(()));
        };
        content = rest;
        Some(Ok((*opcode, body)))
    })
}

/// The parts of a record, taken one after the other; `None` where they are not there.
///
/// Not the library's own parser: it reserves as much memory as a length asks for, whatever the record's size.
#[derive(Debug, Clone, Copy)]
struct Parts<'a>(&'a [u8]);

impl<'a> Parts<'a> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn bytes(&mut self, length: u64) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(usize::try_from(length).ok()?)?;
        self.0 = rest;
        Some(head)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()?;
        std::str::from_utf8(self.bytes(u64::from(length))?).ok()
    }

    fn map(&mut self) -> Option<BTreeMap<String, String>> {
        let length = self.u32()?;
        let mut entries = Parts(self.bytes(u64::from(length))?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            map.insert(entries.text()?.to_owned(), entries.text()?.to_owned());
        }
        Some(map)
    }
}

/// A packed chunk.
struct Chunk<'a> {
    size: u64,
    sum: u32,
    packing: &'a str,
    packed: &'a [u8],
}

impl<'a> Chunk<'a> {
    fn parse(body: &'a [u8]) -> Option<Self> {
        let mut parts = Parts(body);
        let _times = (parts.u64()?, parts.u64()?);
        let (size, sum, packing) = (parts.u64()?, parts.u32()?, parts.text()?);
        let length = parts.u64()?;
        Some(Self { size, sum, packing, packed: parts.bytes(length)? })
    }
}

/// A schema: its number, encoding and text.
pub(crate) fn schema(body: &[u8]) -> Option<(u16, &str, &[u8])> {
    let mut parts = Parts(body);
    let (id, _name, encoding) = (parts.u16()?, parts.text()?, parts.text()?);
    let length = parts.u32()?;
    Some((id, encoding, parts.bytes(u64::from(length))?))
}

/// A channel of the file.
pub(crate) struct FileChannel<'a> {
    pub id: u16,
    pub schema: u16,
    pub topic: &'a str,
    pub encoding: &'a str,
    pub metadata: BTreeMap<String, String>,
}

impl<'a> FileChannel<'a> {
    pub fn parse(body: &'a [u8]) -> Option<Self> {
        let mut parts = Parts(body);
        Some(Self {
            id: parts.u16()?,
            schema: parts.u16()?,
            topic: parts.text()?,
            encoding: parts.text()?,
            metadata: parts.map()?,
        })
    }
}

/// A metadata record: its name and entries.
pub(crate) fn metadata(body: &[u8]) -> Option<(&str, BTreeMap<String, String>)> {
    let mut parts = Parts(body);
    Some((parts.text()?, parts.map()?))
}

/// The head of a message, and the message.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Message<'a> {
    pub channel: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub data: &'a [u8],
}

impl<'a> Message<'a> {
    pub fn parse(body: &'a [u8]) -> Option<Self> {
        let mut parts = Parts(body);
        let (channel, sequence, log_time) = (parts.u16()?, parts.u32()?, parts.u64()?);
        let _publish_time = parts.u64()?;
        Some(Self { channel, sequence, log_time, data: parts.0 })
    }
}
