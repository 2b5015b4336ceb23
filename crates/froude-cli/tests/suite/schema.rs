//! `froude schema campaign`: what an editor accepts is what the program reads.

use std::path::{Path, PathBuf};

use froude::records::campaign_file::parse_campaign;
use serde_json::Value;

use crate::documents::{blocks, root};
use crate::tank::{example, froude, json};

fn schema() -> Value {
    json(&froude(Path::new("."), &["schema", "campaign"]))
}

/// What is wrong with a campaign by the schema, first by draft 2020-12 and then by draft 7, which some editors read instead.
fn problems(schema: &Value, campaign: &str) -> Vec<String> {
    let value: Value = toml::from_str(campaign).unwrap();
    let of = |validator: jsonschema::Validator| -> Vec<String> {
        validator.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect()
    };
    let newer = of(jsonschema::draft202012::new(schema).unwrap());
    let older = of(jsonschema::draft7::new(schema).unwrap());
    assert_eq!(newer.len(), older.len(), "{newer:?}, {older:?}");
    newer
}

fn toml_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            toml_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "toml") {
            out.push(path);
        }
    }
}

#[test]
fn every_campaign_that_is_read_is_valid() {
    let schema = schema();
    jsonschema::meta::validate(&schema).unwrap();
    let (mut files, mut texts) = (Vec::new(), Vec::new());
    for folder in ["examples", "fuzz/seeds/campaign"] {
        toml_files(&root().join(folder), &mut files);
    }
    texts.extend(files.iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())));
    for page in std::fs::read_dir(root().join("book/src")).unwrap() {
        let path = page.unwrap().path();
        texts.extend(blocks(&std::fs::read_to_string(&path).unwrap(), "toml").into_iter().map(|b| (path.clone(), b)));
    }
    texts.retain(|(path, text)| parse_campaign(path, text).is_ok());
    assert!(texts.len() > 20, "{} campaigns", texts.len());
    for (path, text) in texts {
        let problems = problems(&schema, &text);
        assert!(problems.is_empty(), "{}: {problems:#?}\n{text}", path.display());
    }
}

#[test]
fn mistakes_are_refused_by_both() {
    let schema = schema();
    let folder = example("mamba-rotation", &[]);
    let whole = std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    assert_eq!(problems(&schema, &whole), [""; 0]);
    for (from, to) in [
        ("density =", "densty ="),
        ("kind   = \"tank\"", "kind   = \"tnak\""),
        ("kind   = \"tank\"\n", ""),
        ("runs   = \"runs\"\n", ""),
        ("runs   = \"runs\"\n", "runs   = \"runs\"\ntable  = \"t.csv\"\n"),
        ("density = \"1025 kg/m^3\"", "density = 1025"),
        ("density = \"1025 kg/m^3\"", "density = { vlaue = \"1025 kg/m^3\" }"),
        ("name   = \"turning rig\"", "name   = { it = \"turning rig\" }"),
        ("method = \"rotation\"", "method = \"rotatoin\""),
        ("method = \"rotation\"", "method = \"sway\""),
        ("method = \"rotation\"", "method = [\"rotation\"]\nkeep   = \"angle > 1 deg\""),
        ("axis    = \"upright\"", "axis    = \"upwards\""),
        ("axis    = \"upright\"", ""),
        ("axis    = \"upright\"", "axis    = \"upright\"\npivot   = \"upright\""),
        ("standard = \"1e-5 kg m^2\"", "standrad = \"1e-5 kg m^2\""),
        ("cycles  = { skip = 1, used = 5 }", "cycles  = { skip = -1, used = 5 }"),
        ("shared   = \"campaign\"\n", ""),
        ("periods   = 7", "periods   = 7.5"),
        ("periods   = 7", "flow      = \"0.1 m/s\""),
        (
            "frequency = [\"60 deg/s\", \"70 deg/s\", \"80 deg/s\"]",
            "frequency = { start = \"60 deg/s\", stop = \"80 deg/s\" }",
        ),
        ("seed  = 6", "seed  = \"six\""),
    ] {
        let mistaken = whole.replacen(from, to, 1);
        assert_ne!(mistaken, whole, "{from}");
        assert!(!problems(&schema, &mistaken).is_empty(), "{to:?} for {from:?} is valid by the schema");
        std::fs::write(folder.path().join("campaign.toml"), mistaken).unwrap();
        let refused = froude(folder.path(), &["plan", "campaign.toml"]);
        assert_eq!(refused.status.code(), Some(2), "{to:?} for {from:?} is read");
    }
}

#[test]
fn a_person_reads_unit_default_and_what_a_key_means() {
    let schema = schema();
    let source = &schema["properties"]["source"]["items"]["properties"];
    let key = |of: &Value, key: &str| of["properties"][key]["description"].as_str().unwrap().to_owned();
    assert_eq!(
        key(&source["steady"], "shortest"),
        "Shortest window that is accepted. A time (s) with its unit in quotes: \"0.2 s\". Left out: \"2 s\"."
    );
    assert_eq!(
        key(&source["decay"], "noise"),
        "Standard deviation of a sample of the position, by which peaks are counted. By `axis` a length (m) with its unit in quotes: \"0.2 m\"; \
         or a pure number or angle (1) with its unit in quotes: \"5 %\" or \"30 deg\". Left out: from the logs."
    );
    assert_eq!(source["steady"]["properties"]["shortest"]["default"], "2 s");
    assert_eq!(source["rotation"]["required"], serde_json::json!(["axis"]));
}
