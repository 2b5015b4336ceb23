//! JSON Schema of declared keys, for editors.

use serde_json::{Map, Value, json};

use crate::declare::key::{IfMissing, Key, Kind, Range};
use crate::units::Dimension;

/// The schema of a table that has these keys and no others. It keeps to what draft 7 has too, the newest draft of some editors.
#[must_use]
pub fn object_schema(keys: &[Key]) -> Value {
    let properties: Map<String, Value> = keys.iter().map(|key| (key.name.to_owned(), property(key))).collect();
    let is_required = |key: &&Key| matches!(key.default, IfMissing::Required(_));
    let required: Vec<&str> = keys.iter().filter(is_required).map(|key| key.name).collect();
    json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false })
}

/// The schema of a value, with what a person should know of it.
fn property(key: &Key) -> Value {
    let mut out = of(key.kind);
    match (key.kind, key.range) {
        (Kind::Number, Range::Positive) => out["exclusiveMinimum"] = json!(0),
        (Kind::Number, Range::Between(low, high)) => {
            (out["minimum"], out["maximum"]) = (json!(low), json!(high));
        }
        _ => {}
    }
    let default = match key.default {
        IfMissing::Required(_) | IfMissing::Nothing("") => String::new(),
        IfMissing::Nothing(words) => format!("Left out: {words}"),
        IfMissing::Is(text) if key.kind.is_bare() => {
            // A table is no JSON, and its words say it.
            serde_json::from_str(text).map(|value: Value| out["default"] = value).ok();
            format!("Left out: {text}")
        }
        IfMissing::Is(text) => {
            out["default"] = json!(text);
            format!("Left out: {text:?}")
        }
    };
    let said = [key.doc.to_owned(), written(key.kind), default];
    let sentences: Vec<String> = said.iter().filter(|text| !text.is_empty()).map(|text| sentence(text)).collect();
    out["description"] = sentences.join(" ").into();
    out
}

/// Which values a kind has: keywords of each type, none of which says anything of the others.
fn of(kind: Kind) -> Value {
    let text = || json!({ "type": "string" });
    let constant = || json!({ "type": ["string", "object"], "properties": { "value": text(), "standard": text() }, "required": ["value"], "additionalProperties": false });
    match kind {
        Kind::Quantity(_) | Kind::AnyQuantity | Kind::Text => text(),
        Kind::Coefficient => json!({ "type": ["string", "number"] }),
        Kind::Constant(_) => constant(),
        Kind::PerConfiguration(_) => {
            json!({ "type": ["string", "object"], "properties": { "value": text() }, "additionalProperties": constant() })
        }
        Kind::Axis(_) | Kind::Frequency => json!({
            "type": ["string", "array", "object"],
            "items": text(),
            "minItems": 1,
            "properties": { "start": text(), "stop": text(), "step": text() },
            "required": ["start", "stop", "step"],
            "additionalProperties": false,
        }),
        Kind::Count(most) => json!({ "type": "integer", "minimum": 1, "maximum": most }),
        Kind::Whole => json!({ "type": "integer", "minimum": 0 }),
        Kind::Number => json!({ "type": "number" }),
        Kind::Word(words) => json!({ "type": "string", "enum": words }),
        Kind::Texts => json!({ "type": ["string", "array"], "items": text() }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Table(keys) => object_schema(keys),
        Kind::Named(keys, others) => {
            let mut table = object_schema(keys);
            table["additionalProperties"] = of(*others);
            table
        }
        Kind::List(of_each) => json!({ "type": "array", "items": of(*of_each) }),
        // They differ in their dimensions.
        Kind::By(_, kinds) => kinds.first().map_or_else(|| json!({}), |kind| of(*kind)),
        Kind::Either(kinds) => json!({ "anyOf": kinds.iter().map(|kind| of(*kind)).collect::<Vec<_>>() }),
        Kind::Any => json!({}),
    }
}

/// How a quantity is written; nothing of kinds that the schema itself describes.
fn written(kind: Kind) -> String {
    match kind {
        Kind::Quantity(dimension) => quantity(dimension),
        Kind::Constant(dimension) => {
            format!("{}, or {{ value, standard }} with its standard uncertainty", quantity(dimension))
        }
        Kind::PerConfiguration(dimension) => {
            format!(
                "{}, or {{ value, standard }}; one, or a table with one for each configuration",
                quantity(dimension)
            )
        }
        Kind::Axis(dimension) => format!("{}, a list, or {{ start, stop, step }}", quantity(dimension)),
        Kind::Frequency => format!("{}, a list, or {{ start, stop, step }}", quantity(Dimension::ANGULAR_SPEED)),
        Kind::By(key, kinds) => {
            let mut all: Vec<String> = kinds.iter().map(|kind| written(*kind)).collect();
            all.dedup();
            format!("by `{key}` {}", all.join("; or "))
        }
        Kind::AnyQuantity => "a quantity with its unit in quotes: \"0.01 N\"".to_owned(),
        Kind::Coefficient => "a quantity with its unit in quotes, or a plain number in SI".to_owned(),
        _ => String::new(),
    }
}

fn quantity(dimension: Dimension) -> String {
    let example = match dimension {
        Dimension::ONE => "5 %\" or \"30 deg".to_owned(),
        Dimension::ANGULAR_SPEED => "2 Hz\" or \"70 deg/s".to_owned(),
        Dimension::TEMPERATURE => "20 degC".to_owned(),
        _ => format!("0.2 {dimension}"),
    };
    format!("{} with its unit in quotes: \"{example}\"", dimension.describe())
}

/// A text as a sentence.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let end = if text.ends_with('.') { "" } else { "." };
    letters.next().map_or_else(String::new, |first| format!("{}{}{end}", first.to_uppercase(), letters.as_str()))
}
