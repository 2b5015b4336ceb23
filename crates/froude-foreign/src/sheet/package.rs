//! The zip file around a workbook: what it unpacks to is checked before anything is unpacked.

use std::io::Cursor;

use quick_xml::events::Event;
use quick_xml::{Reader, XmlVersion};
use zip::ZipArchive;
use zip::read::ZipFile;

use crate::{ForeignError, MAX_BYTES};

/// Most bytes of the texts of a workbook, which are kept in memory.
const MAX_TEXT_BYTES: u64 = 256 << 20;
/// Most bytes of a part that lists sheets, styles or relations.
const MAX_LIST_BYTES: u64 = 16 << 20;

pub(crate) type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// Opens the zip file. No part gives more than the zip directory states: the crate zip ends with an error there.
///
/// # Errors
///
/// If the zip file is damaged, or its parts are too large.
pub(crate) fn open(bytes: &[u8]) -> Result<Archive<'_>, ForeignError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| {
        ForeignError(format!("begins as a zip file does, as workbooks do, but cannot be unpacked: {e}"))
    })?;
    let mut total = 0_u64;
    for index in 0..archive.len() {
        let part = archive.by_index_raw(index).map_err(|e| damaged("", &e))?;
        let (name, size) = (part.name().map_err(|e| damaged("", &e))?.into_owned(), part.size());
        total = total.saturating_add(size);
        let lower = name.to_ascii_lowercase();
        let limit = match lower.rsplit('/').next() {
            Some("sharedstrings.xml") => MAX_TEXT_BYTES,
            Some("styles.xml" | "workbook.xml" | "manifest.xml" | "[content_types].xml") => MAX_LIST_BYTES,
            _ if lower.contains("_rels/") || lower.contains("/theme/") => MAX_LIST_BYTES,
            _ => MAX_BYTES,
        };
        if size > limit || total > MAX_BYTES {
            return Err(ForeignError(format!(
                "{name:?} in it unpacks to {} MiB, {} MiB in all; at most {} MiB of this part and {} MiB in all are read; \
                 save the sheet that is needed as CSV",
                size >> 20,
                total >> 20,
                limit >> 20,
                MAX_BYTES >> 20
            )));
        }
    }
    Ok(archive)
}

/// Names of the parts.
pub(crate) fn parts(archive: &Archive<'_>) -> Vec<String> {
    archive.file_names().filter_map(Result::ok).map(std::borrow::Cow::into_owned).collect()
}

/// An error of the zip reader, with the part where it happened.
pub(crate) fn damaged(part: &str, error: &dyn std::fmt::Display) -> ForeignError {
    let place = if part.is_empty() { String::new() } else { format!("{part:?} in it: ") };
    ForeignError(format!("{place}the workbook is damaged: {error}; open it in its program and save it again"))
}

/// Value of an attribute by its full name; `None` if it is not there or cannot be read.
pub(crate) fn attribute(tag: &quick_xml::events::BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().filter_map(Result::ok).find(|attribute| attribute.key.as_ref() == name)?;
    found.normalized_value(XmlVersion::Implicit1_0).ok().map(std::borrow::Cow::into_owned)
}

/// A part as XML.
pub(crate) fn xml<'a, 'z>(
    archive: &'a mut Archive<'z>,
    part: &str,
) -> Result<Reader<std::io::BufReader<ZipFile<'a, Cursor<&'z [u8]>>>>, ForeignError> {
    let file = archive.by_name(part).map_err(|e| damaged(part, &e))?;
    let mut reader = Reader::from_reader(std::io::BufReader::new(file));
    reader.config_mut().expand_empty_elements = true;
    Ok(reader)
}

/// The first start tag of a part with that local name for which `pick` gives something.
pub(crate) fn first_tag<T>(
    archive: &mut Archive<'_>,
    part: &str,
    name: &str,
    pick: impl Fn(&quick_xml::events::BytesStart<'_>) -> Option<T>,
) -> Result<Option<T>, ForeignError> {
    let mut reader = xml(archive, part)?;
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer).map_err(|e| damaged(part, &e))? {
            Event::Start(tag) if tag.local_name().as_ref() == name => {
                if let Some(found) = pick(&tag) {
                    return Ok(Some(found));
                }
            }
            Event::Eof => return Ok(None),
            _ => {}
        }
    }
}
