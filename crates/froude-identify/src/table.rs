//! A table of observations as a source: its rows are fitted by every law that the campaign asks for.

use froude_records::campaign::{Campaign, Source};

use crate::method::{Found, Method, MethodError, Need};
use crate::source::identify_source;

/// The rows of a table, fitted with every law that the campaign asks for.
#[derive(Debug)]
pub struct Table;

impl Method for Table {
    fn names(&self) -> &'static [&'static str] {
        &["table"]
    }

    fn words(&self, _: &str) -> &'static str {
        "rows of a table"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const { &[Need::of(&["table"], &[])] }
    }

    fn runs(&self) -> &'static str {
        ""
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let mut result = identify_source(campaign, source, &|model| progress(&format!("fitting {model}")))?;
        let findings = std::mem::take(&mut result.findings);
        Ok(Found { results: vec![result.into()], findings, ..Found::default() })
    }
}
