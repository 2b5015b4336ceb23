//! Small tables for tests: written, read as a campaign's source, identified.

use crate::reduce::reduce;
use crate::result::SourceResult;
use crate::source::handed::TABLE;
use crate::source::identify_observations;

/// The result of rows of speed and drag under more keys of the campaign.
pub(crate) fn identified(rows: &str, keys: &str) -> SourceResult {
    identified_by(TABLE, rows, keys)
}

/// The same of rows that a method has made.
pub(crate) fn identified_by(method: &str, rows: &str, keys: &str) -> SourceResult {
    identified_of(&format!("speed [m/s],f_x [N]\n{rows}"), method, keys)
}

/// The result of a table of any columns.
pub(crate) fn identified_of(table: &str, method: &str, keys: &str) -> SourceResult {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let campaign =
        format!("schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{keys}");
    std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
    let campaign = froude_records::campaign_file::read_campaign(&folder.path().join("c.toml")).unwrap();
    let source = &campaign.sources[0];
    identify_observations(&campaign, source, reduce(&campaign, source).unwrap(), method, &|_| {}).unwrap()
}

/// What its findings of some codes say.
pub(crate) fn said(rows: &str, keys: &str, codes: &[&str]) -> Vec<String> {
    let found = identified(rows, keys).findings.into_iter();
    found.filter(|f| codes.contains(&f.code.as_str())).map(|f| f.message).collect()
}
