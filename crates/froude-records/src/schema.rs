//! The published JSON Schema of `estimate.json`.

/// JSON Schema (draft 2020-12) of the record `froude/estimate/2`.
pub const ESTIMATE_JSON_SCHEMA: &str = include_str!("../schemas/estimate-2.schema.json");
/// That of `froude/estimate/1`, which is read and lifted.
pub const ESTIMATE_1_JSON_SCHEMA: &str = include_str!("../schemas/estimate-1.schema.json");
