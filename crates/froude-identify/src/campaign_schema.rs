//! JSON Schema of a campaign, for editors.

use froude_records::campaign_file::{INPUTS, OF_TABLES};
use froude_records::campaign_keys::{CASES, ROOT, ROWS};
use froude_records::declare::{Key, object_schema};
use serde_json::{Map, Value, json};

use crate::method::Method;

/// JSON Schema (draft 2020-12) of a campaign, from the keys that its readers and the methods declare: `methods` are those of runs, `others` those of another input, with its key, and
/// `sections` those of the campaign that another crate reads.
///
/// Like each of its parts it keeps to what draft 7 has too.
#[must_use]
pub fn campaign_schema(methods: &[&dyn Method], others: &[(&dyn Method, &str)], sections: &[(&str, &[Key])]) -> Value {
    let mut schema = object_schema(ROOT);
    let mut forms = Map::from_iter([form("rows", ROWS), form("cases", CASES)]);
    for (section, keys) in sections {
        let description = schema["properties"][*section]["description"].take();
        schema["properties"][*section] = object_schema(keys);
        schema["properties"][*section]["description"] = description;
    }
    let source = &mut schema["properties"]["source"]["items"];
    let names: Vec<&str> = methods.iter().flat_map(|method| method.names()).copied().collect();
    source["properties"]["method"]["anyOf"] =
        json!([{ "enum": names }, { "type": "array", "items": { "enum": names } }]);
    source["oneOf"] = INPUTS.map(has).to_vec().into();

    let mut rules = Vec::new();
    let takers = |key: &str| takers(methods, key);
    let of_runs = methods.iter().map(|method| (*method, None));
    let of_others = others.iter().map(|(method, input)| (*method, Some(*input)));
    for (method, input) in of_runs.chain(of_others) {
        let Some(own) = method.declares() else { continue };
        source["properties"][own.section] = object_schema(own.keys);
        source["properties"][own.section]["description"] = method.words(method.names()[0]).into();
        let mut sources: Vec<Value> = input.map(has).into_iter().collect();
        sources.push(is_of(&takers(own.section)));
        rules.push(rule(has(own.section), json!({ "anyOf": sources })));
        if !own.plan.is_empty() {
            forms.extend([form(own.section, own.plan)]);
            rules.push(rule(json!({ "allOf": [has("runs"), is_of(method.names())] }), plan_of(own.section)));
        }
    }
    let is_other = json!({ "not": { "anyOf": [has("runs"), has("cases")] } });
    rules.extend([rule(is_other, plan_of("rows")), rule(has("cases"), plan_of("cases"))]);
    for key in OF_TABLES {
        rules.push(rule(json!({ "required": ["runs", key] }), is_of(&takers(key))));
        rules.push(rule(has("mesh"), json!({ "properties": { key: false } })));
    }

    // Each form is offered; the rules say which applies.
    let mut offered: Vec<Value> = forms.keys().map(|name| reference(name)).collect();
    offered.push(json!(true));
    source["properties"]["plan"]["items"] = json!({ "anyOf": offered });
    // An editor that looks for keys passes over what has `allOf`, but not over a condition.
    source["if"] = json!(true);
    source["then"] = json!({ "allOf": rules });
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "A campaign of Froude".into();
    schema["$defs"] = forms.into();
    schema
}

fn has(key: &str) -> Value {
    json!({ "required": [key] })
}

/// A source with one of these methods.
fn is_of(methods: &[&str]) -> Value {
    if methods.is_empty() {
        return json!(false);
    }
    let is_one = json!([{ "enum": methods }, { "type": "array", "contains": { "enum": methods } }]);
    json!({ "required": ["method"], "properties": { "method": { "anyOf": is_one } } })
}

/// Names of the methods that take a key of a source.
fn takers(methods: &[&dyn Method], key: &str) -> Vec<&'static str> {
    methods.iter().filter(|method| method.takes().contains(&key)).flat_map(|method| method.names()).copied().collect()
}

fn rule(condition: Value, then: Value) -> Value {
    json!({ "if": condition, "then": then })
}

/// The keys of a block of a plan, under their name.
fn form(name: &str, keys: &[Key]) -> (String, Value) {
    (format!("plan_{name}"), object_schema(keys))
}

fn plan_of(name: &str) -> Value {
    json!({ "properties": { "plan": { "items": reference(&format!("plan_{name}")) } } })
}

fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}
