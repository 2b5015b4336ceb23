//! Reading a campaign.

use std::path::Path;

use crate::campaign::Campaign;
use crate::campaign_toml;
use crate::error::{RecordError, read_bytes, utf8};
use crate::prior_record;

/// The largest campaign that is read.
pub(crate) const LARGEST_BYTES: u64 = 4 << 20;

/// Reads a campaign; the files that it names must exist, except those that a plan will make.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_campaign(path: &Path) -> Result<Campaign, RecordError> {
    let bytes = read_bytes(path, LARGEST_BYTES, "a campaign")?;
    let mut campaign = campaign_toml::parse(path, utf8(path, &bytes)?)?;
    campaign.check_files()?;
    prior_record::resolve(&mut campaign)?;
    Ok(campaign)
}

/// The same from text, without looking at the files that it names.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_campaign(path: &Path, text: &str) -> Result<Campaign, RecordError> {
    campaign_toml::parse(path, text)
}
