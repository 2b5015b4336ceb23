//! The one place that says where a campaign may have files written: below its own folder.
//!
//! A campaign may come from anybody. What a person names on the command line (`--out`) may be anywhere.

use std::path::{Component, Path};

use crate::error::{Place, RecordError};

/// Checks that a path which a campaign names for output lies below the campaign's folder, also through links.
///
/// `path` is as the reader made it: the campaign's folder with what is written under `key` at `place`; `verb` writes there.
///
/// # Errors
///
/// [`RecordError::Value`]: `..`, an absolute path, the campaign's folder itself, or a link on the way that leads elsewhere.
pub fn inside(campaign: &Path, path: &Path, place: &Place, key: &str, verb: &str) -> Result<(), RecordError> {
    let own = campaign.parent().unwrap_or(Path::new(""));
    let rest = path.strip_prefix(own).unwrap_or(path);
    let is_below = rest.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if is_below && rest.components().any(|c| matches!(c, Component::Normal(_))) && stays(own, path) {
        return Ok(());
    }
    let problem = format!(
        "is {:?}, which leads out of the campaign's folder; {verb} writes below it only: name a folder there",
        rest.display().to_string()
    );
    Err(RecordError::value(place.clone(), key, problem))
}

/// Whether a path stays below a folder when links are followed; what does not exist yet is made there.
#[must_use]
pub fn stays(folder: &Path, path: &Path) -> bool {
    let real = |folder: &Path| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.canonicalize();
    let there = path.ancestors().find(|p| p.symlink_metadata().is_ok()).unwrap_or(folder);
    matches!((real(folder), real(there)), (Ok(own), Ok(there)) if there.starts_with(&own))
}
