//! The published JSON Schema of `estimate.json`.

/// JSON Schema (draft 2020-12) of the record `froude/estimate/2`.
pub const ESTIMATE_JSON_SCHEMA: &str = include_str!("../schemas/estimate-2.schema.json");
/// That of `froude/estimate/1`, which is read and lifted.
pub const ESTIMATE_1_JSON_SCHEMA: &str = include_str!("../schemas/estimate-1.schema.json");

/// What each verb prints with `--json`, by its name: the record, or the JSON Schema of its blocks.
pub const RESULTS: [(&str, &str); 19] = [
    ("identify", ESTIMATE_JSON_SCHEMA),
    ("added-mass-check", include_str!("../schemas/results/added-mass-check.json")),
    ("cfd-collect", include_str!("../schemas/results/cfd-collect.json")),
    ("cfd-plan", include_str!("../schemas/results/cfd-plan.json")),
    ("cfd-report", include_str!("../schemas/results/cfd-report.json")),
    ("cfd-retry", include_str!("../schemas/results/cfd-retry.json")),
    ("cfd-run", include_str!("../schemas/results/cfd-run.json")),
    ("cfd-status", include_str!("../schemas/results/cfd-status.json")),
    ("cfd-suggest", include_str!("../schemas/results/cfd-suggest.json")),
    ("cfd-swing", include_str!("../schemas/results/cfd-swing.json")),
    ("convert", include_str!("../schemas/results/convert.json")),
    ("inspect", include_str!("../schemas/results/inspect.json")),
    ("new", include_str!("../schemas/results/new.json")),
    ("plan", include_str!("../schemas/results/plan.json")),
    ("predict", include_str!("../schemas/results/predict.json")),
    ("robot-inspect", include_str!("../schemas/results/robot-inspect.json")),
    ("run", include_str!("../schemas/results/run.json")),
    ("simulate", include_str!("../schemas/results/simulate.json")),
    ("swim", include_str!("../schemas/results/swim.json")),
];

/// What has a JSON Schema: a campaign, whose schema the methods make, and the verbs of [`RESULTS`].
#[must_use]
pub fn described() -> Vec<&'static str> {
    [&["campaign"][..], &RESULTS.map(|(verb, _)| verb)].concat()
}

/// The schema of what a verb prints.
#[must_use]
pub fn of_verb(name: &str) -> Option<&'static str> {
    RESULTS.iter().find(|(verb, _)| *verb == name).map(|(_, schema)| schema.trim_end())
}
