//! The published JSON Schema of `estimate.json`.

/// JSON Schema (draft 2020-12) of the record `froude/estimate/1`.
pub const ESTIMATE_JSON_SCHEMA: &str = include_str!("../schemas/estimate-1.schema.json");
