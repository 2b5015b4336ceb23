//! Campaigns as text, with changes.

use std::path::Path;

use froude_records::campaign::Campaign;
use froude_records::campaign_file::parse_campaign;

/// The campaign of a text with these changes, each of something that is there.
pub fn campaign(text: &str, changes: &[(&str, &str)]) -> Campaign {
    let mut text = text.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    parse_campaign(Path::new("campaign.toml"), &text).unwrap()
}
