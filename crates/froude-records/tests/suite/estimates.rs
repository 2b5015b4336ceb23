//! `estimate.json`: whole, without NaN, in the published schema, bit for bit.

use std::path::Path;

use froude_records::comparison::{
    CoefficientComparison, Comparison, JointComparison, LargestCoefficient, LargestLoad, LoadComparison, Side,
    Validation, Verdict,
};
use froude_records::estimate::{
    Attitude, Clusters, Coefficient, DataFile, Derived, Diagnostics, ESTIMATE_SCHEMA, Estimate, EstimateFile, Frame,
    Interval, Law, Measured, MethodUsed, NamedCorrelation, Range, ReferencePoint, RunScatter, SharedError, Status,
    TypeA, keyed,
};
use froude_records::finding::{Finding, Severity};
use froude_records::json::{parse_estimates, read_estimates, write_estimates};
use froude_records::run::step::Step;
use froude_records::schema::{ESTIMATE_1_JSON_SCHEMA, ESTIMATE_JSON_SCHEMA};
use proptest::prelude::*;

fn coefficient(value: Option<f64>, status: Status) -> Coefficient {
    Coefficient {
        label: Some("C".to_owned()),
        standard_uncertainty: Some(0.1),
        type_a: None,
        type_b: Some(0.0),
        interval_95: Some([-0.2, 0.3]),
        effective_dof: Some(7.5),
        ..Coefficient::of(value, "m/s", status)
    }
}

fn sample() -> EstimateFile {
    let estimate = Estimate {
        id: "tank/f4".to_owned(),
        source: "tank".to_owned(),
        kind: "tank".to_owned(),
        method: MethodUsed::of("table", "least squares"),
        frame: Frame::body(),
        point: ReferencePoint::stated(Some("centre".to_owned())),
        attitude: Some(Attitude { travel: "y".to_owned() }),
        law: Law {
            constants: [("v_ref".to_owned(), Measured::of(1.0, "m/s"))].into(),
            ..Law::of("f4", [("v_y", "m/s")]).giving("f_y", "N", Some("Y_v*v".to_owned()))
        },
        refers_to: [
            ("density".to_owned(), Measured::of(1025.0, "kg/m^3")),
            ("a".to_owned(), Measured::of(0.0588, "m")),
        ]
        .into(),
        data: vec!["d1".to_owned()],
        n_observations: 12,
        clusters: Some(Clusters::of("configuration", 3)),
        dof: [("f_x".to_owned(), Some(10.0)), ("f_y".to_owned(), None)].into(),
        sigma: [("f_x".to_owned(), Measured::of(0.02, "N"))].into(),
        run_scatter: [("f_x".to_owned(), RunScatter { constant: Measured::of(0.01, "N"), part: 0.02, dof: None })]
            .into(),
        coefficients: [
            ("C_d_I".to_owned(), coefficient(Some(0.4), Status::Free)),
            ("C_f_I".to_owned(), coefficient(None, Status::Undetermined)),
        ]
        .into(),
        derived: [(
            "D".to_owned(),
            Derived { interval_95: Some([0.6, 1.0]), ..Derived::of("2*C_d_I", Some(0.8), "1") },
        )]
        .into(),
        type_a: Some(TypeA::of(vec!["C_d_I".to_owned()], vec![vec![0.01]], &[7.5], "classical")),
        errors: [(
            "cal/1".to_owned(),
            SharedError {
                limits: Some([-0.5, 0.5]),
                ..SharedError::declared(["calibration", "f_y"], 0.5, 20.0, [0.2])
            },
        )]
        .into(),
        interval: Interval { level: 0.95, looks: 3, of: "coefficient".to_owned() },
        undetermined: vec!["k*G_T*C_f_II + G_HTx*C_fHT_II".to_owned()],
        validity: [("speed".to_owned(), Range::of([0.1, 1.0], "m/s"))].into(),
        diagnostics: Diagnostics {
            condition_number: Some(12.0),
            largest_correlation: Some(NamedCorrelation { first: "a".to_owned(), second: "b".to_owned(), value: -0.9 }),
            relative_residual: [("f_x".to_owned(), 0.05)].into(),
            cross_validation_note: Some("needs three".to_owned()),
            ..Diagnostics::default()
        },
        recommended: true,
        reason: Some("smallest AICc".to_owned()),
        ..Estimate::default()
    };
    EstimateFile {
        data: keyed(vec![DataFile {
            path: "tank.csv".to_owned(),
            sha256: "0".repeat(64),
            role: Some("table".to_owned()),
            steps: vec![Step::new("filter", "f_x", "a delay of 13 ms taken off").with("delay", 0.013, "s")],
        }]),
        versions: [("froude".to_owned(), "0.1.0".to_owned())].into(),
        comparison: Some(comparison()),
        findings: vec![Finding::new(Severity::Warning, "one-sided", "only one sign of angle was run".to_owned())],
        ..EstimateFile::of(vec![estimate])
    }
}

/// One row of each kind, with a number and with a note.
fn comparison() -> Comparison {
    let side = |source: &str| Side {
        source: source.to_owned(),
        value: Some(1.4),
        standard_uncertainty: Some(0.1),
        effective_dof: Some(4.0),
        coverage_factor: Some(2.776),
        expanded_uncertainty: Some(0.2776),
    };
    let text = str::to_owned;
    Comparison {
        verdicts: vec![Verdict {
            first: text("tank/f4"),
            second: text("CFD/f4"),
            agree: true,
            load: Some(LargestLoad {
                component: text("f_x"),
                n_links: Some(1.0),
                speed_m_s: 0.4,
                angle_rad: 0.0,
                e_n: 0.3,
            }),
            coefficient: Some(LargestCoefficient { coefficient: text("C_d"), e_n: 0.0 }),
            p: None,
        }],
        coefficients: vec![CoefficientComparison {
            model: text("f4"),
            coefficient: text("C_d_II"),
            label: Some(text("C_d")),
            unit: text("1"),
            first: side("tank/f4"),
            second: side("CFD/f4"),
            e_n: Some(0.0),
            note: String::new(),
        }],
        joint: vec![JointComparison { note: text("no covariance matrix"), ..JointComparison::default() }],
        loads: vec![LoadComparison {
            component: text("f_x"),
            unit: text("N"),
            n_links: Some(1.0),
            speed_m_s: 0.4,
            first: side("tank/f4"),
            second: Side { source: text("CFD/f4"), ..Side::default() },
            note: text("CFD/f4 gives no f_x"),
            ..LoadComparison::default()
        }],
        validation: vec![
            Validation {
                simulation: text("CFD/f4"),
                data: text("tank/f4"),
                quantity: text("C_d_II"),
                unit: text("1"),
                u_data: Some(0.057),
                ..Validation::default()
            },
            Validation { flows: Some(3), ratio: Some(0.8), beyond: Some(1), ..Validation::default() },
        ],
        coverage: vec![text("tank/f4: k = 2.78")],
        findings: Vec::new(),
    }
}

/// As a person writes it: without the line of the checksum.
fn text(file: &EstimateFile) -> String {
    let written = summed(file);
    written.lines().filter(|line| !line.starts_with("  \"checksum\"")).collect::<Vec<_>>().join("\n")
}

/// As Froude writes it.
fn summed(file: &EstimateFile) -> String {
    serde_json::to_string_pretty(file).unwrap()
}

fn parse(text: &str) -> Result<EstimateFile, String> {
    parse_estimates(Path::new("estimate.json"), text).map_err(|e| e.to_string())
}

/// The message for the sample with one passage changed.
#[track_caller]
fn refused(from: &str, to: &str, message: &str) {
    let text = text(&sample());
    assert!(text.contains(from), "{from} in {text}");
    assert_eq!(parse(&text.replacen(from, to, 1)).expect_err("accepted"), message);
}

fn line_with(passage: &str) -> usize {
    1 + text(&sample()).lines().position(|l| l.contains(passage)).unwrap()
}

#[test]
fn a_record_survives_being_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.json");
    let file = sample();
    write_estimates(&path, &file).unwrap();
    assert_eq!(read_estimates(&path).unwrap(), file);
    assert!(std::fs::read_to_string(&path).unwrap().ends_with("}\n"));
}

#[test]
fn records_are_valid_against_the_published_schema() {
    let schema: serde_json::Value = serde_json::from_str(ESTIMATE_JSON_SCHEMA).unwrap();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::draft202012::new(&schema).unwrap();
    let value = serde_json::to_value(sample()).unwrap();
    let errors: Vec<String> = validator.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");

    // What the schema must refuse.
    let spoilt = |pointer: &str, new: serde_json::Value| {
        let mut value = value.clone();
        *value.pointer_mut(pointer).unwrap() = new;
        assert!(!validator.is_valid(&value), "{pointer}");
    };
    spoilt("/schema", "froude/estimate/3".into());
    spoilt("/data/d1/sha256", "xyz".into());
    spoilt("/estimates/0/errors/cal~11/kind", "C".into());
    spoilt("/estimates/0/type_a/dof", 3.0.into());
    spoilt("/estimates/0/attitude/travel", "up".into());
    spoilt("/estimates/0/coefficients/C_d_I/status", "guessed".into());
    spoilt("/estimates/0/coefficients/C_d_I/value", "0.4".into());
    spoilt("/estimates/0/coefficients/C_d_I/interval_95", serde_json::json!([1.0]));
    spoilt("/estimates/0/coefficients/C_d_I/standard_uncertainty", (-1.0).into());
    spoilt("/estimates/0/coefficients/C_f_I/value", 0.0.into());
    spoilt("/findings/0/severity", "fatal".into());
    spoilt("/estimates/0/id", serde_json::Value::Null);
}

#[test]
fn every_status_and_every_key_of_the_types_is_in_the_schema() {
    let schema: serde_json::Value = serde_json::from_str(ESTIMATE_JSON_SCHEMA).unwrap();
    let written = schema.to_string();
    let value = serde_json::to_value(sample()).unwrap();
    for level in [
        &value,
        &value["estimates"][0],
        &value["estimates"][0]["diagnostics"],
        &value["estimates"][0]["coefficients"]["C_d_I"],
    ] {
        for key in level.as_object().unwrap().keys() {
            assert!(written.contains(&format!("\"{key}\"")), "{key}");
        }
    }
    for status in [
        Status::Free,
        Status::AtBound,
        Status::Fixed,
        Status::Excluded,
        Status::Prior,
        Status::Undetermined,
        Status::BoundContradicted,
    ] {
        assert!(written.contains(&serde_json::to_string(&status).unwrap()), "{status:?}");
    }
}

#[test]
fn versions_are_compared() {
    refused(
        "froude/estimate/2",
        "froude/estimate/3",
        "estimate.json:2: this is froude/estimate/3; this program reads up to froude/estimate/2: use a newer Froude",
    );
    refused(
        "froude/estimate/2",
        "froude/campaign/1",
        "estimate.json:2: `schema` is \"froude/campaign/1\"; expected froude/estimate/2",
    );
    assert_eq!(
        parse("{\"estimates\": []}").unwrap_err(),
        "estimate.json: `schema` is missing; expected froude/estimate/2"
    );
    // A newer record may look quite different: the version is reported first.
    assert_eq!(
        parse("{\"schema\": \"froude/estimate/7\", \"estimates\": 3}").unwrap_err(),
        "estimate.json:1: this is froude/estimate/7; this program reads up to froude/estimate/2: use a newer Froude"
    );
}

/// A record of version 1 says what it said: one covariance, words for axes and point, all of its files for all of its estimates.
#[test]
fn a_record_of_version_1_is_lifted() {
    let old = serde_json::json!({
        "schema": "froude/estimate/1",
        "data": [{ "path": "tank.csv", "sha256": "0".repeat(64) }],
        "versions": {},
        "estimates": [{
            "id": "tank/sway", "source": "tank", "kind": "tank", "model": "sway",
            "law": { "version": 1, "formulas": { "f_y": "Y_v*v" }, "constants": { "L": { "value": 2.0, "unit": "m" } } },
            "geometry": { "a": { "value": 0.0588, "unit": "m" } },
            "density": { "value": 1025.0, "unit": "kg/m^3" },
            "frame": "body axes", "reference_point": "centre", "method": "least squares", "covariance_kind": "HC3",
            "n_observations": 12,
            "coefficients": { "Y_v": {
                "value": 0.4, "unit": "kg/s", "status": "free", "standard_uncertainty": 0.1, "effective_dof": 7.5
            } },
            "covariance": { "names": ["Y_v"], "matrix": [[0.01]] },
            "recommended": true,
        }],
        "findings": [],
    });
    let schema: serde_json::Value = serde_json::from_str(ESTIMATE_1_JSON_SCHEMA).unwrap();
    assert!(jsonschema::draft202012::new(&schema).unwrap().is_valid(&old));
    let file = parse(&old.to_string()).unwrap();
    assert_eq!((file.schema.as_str(), file.data["d1"].path.as_str()), (ESTIMATE_SCHEMA, "tank.csv"));
    let e = &file.estimates[0];
    assert_eq!((e.law.name.as_str(), e.law.formulas()["f_y"].as_str(), e.n_observations), ("sway", "Y_v*v", 12));
    assert_eq!((e.frame.words.as_str(), e.point.words.as_str(), e.point.stated), ("body axes", "centre", false));
    assert_eq!(
        (e.density().unwrap().value, e.refers_to["a"].value, e.covariance_kind()),
        (1025.0, 0.0588, "HC3; type A and B together")
    );
    assert_eq!(e.covariance().unwrap().matrix, [[0.01]]);
    assert_eq!((e.type_a.as_ref().unwrap().dof.as_slice(), e.errors.len(), e.data.len()), (&[Some(7.5)][..], 0, 0));
    // What was lifted is a whole record of today.
    let schema: serde_json::Value = serde_json::from_str(ESTIMATE_JSON_SCHEMA).unwrap();
    assert!(jsonschema::draft202012::new(&schema).unwrap().is_valid(&serde_json::to_value(&file).unwrap()));
    assert_eq!(parse(&summed(&file)).unwrap(), file);
}

/// Cov = type A + S·C·Sᵀ.
#[test]
fn the_covariance_is_that_of_the_scatter_and_of_every_error() {
    let c = sample().estimates[0].covariance().unwrap();
    assert_eq!(c.names, ["C_d_I"]);
    assert!((c.matrix[0][0] - (0.01 + 0.2 * 0.25 * 0.2)).abs() < 1e-15);
}

#[test]
fn what_json_cannot_say_is_explained() {
    let at = line_with("\"value\": 0.4");
    refused(
        "\"value\": 0.4",
        "\"value\": NaN",
        &format!(
            "estimate.json:{at}: not an estimate record: expected value; JSON has no NaN and no Infinity: an undetermined number is null"
        ),
    );
    refused(
        "\"value\": 0.4",
        "\"value\": 1e999",
        &format!("estimate.json:{at}: not an estimate record: number out of range"),
    );
    refused(
        "\"value\": 0.4",
        "\"value\": \"0.4\"",
        &format!("estimate.json:{at}: not an estimate record: invalid type: string \"0.4\", expected f64"),
    );
    refused(
        "\"C_f_I\": {",
        "\"C_d_I\": {",
        &format!("estimate.json:{}: not an estimate record: the key `C_d_I` appears twice", line_with("\"C_f_I\": {")),
    );
    let cut = &text(&sample())[..300];
    assert!(parse(cut).unwrap_err().contains(": not an estimate record: EOF while parsing"));
}

#[test]
fn records_that_contradict_themselves_are_refused() {
    let id = line_with("\"id\"");
    refused(
        "\"value\": null",
        "\"value\": 0.0",
        &format!("estimate.json:{id}: estimate tank/f4: coefficient C_f_I is undetermined and has a value; write null"),
    );
    refused(
        "\"standard_uncertainty\": 0.1",
        "\"standard_uncertainty\": -0.1",
        &format!(
            "estimate.json:{id}: estimate tank/f4: coefficient C_d_I has standard_uncertainty -0.1; an uncertainty is not negative"
        ),
    );
    let spoil = |of: &dyn Fn(&mut TypeA)| {
        let mut file = sample();
        of(file.estimates[0].type_a.as_mut().unwrap());
        file
    };
    let file = spoil(&|a| a.matrix = vec![vec![0.01, 0.0]]);
    assert_eq!(
        parse(&text(&file)).unwrap_err(),
        format!("estimate.json:{id}: estimate tank/f4: the covariance names 1 coefficients, its matrix is not 1 by 1")
    );
    let file = spoil(&|a| a.names = vec!["C_q".to_owned()]);
    assert_eq!(
        parse(&text(&file)).unwrap_err(),
        format!("estimate.json:{id}: estimate tank/f4: the covariance names C_q, which is not one of its coefficients")
    );
    refused(
        "\"sensitivity\": [\n            [\n              0.2",
        "\"sensitivity\": [\n            [\n              0.1, 0.2",
        &format!(
            "estimate.json:{id}: estimate tank/f4: the sensitivity to the error cal/1 is not 1 by 1: a row per coefficient of the covariance"
        ),
    );
    let mut file = sample();
    file.estimates[0].data = vec!["d9".to_owned()];
    assert_eq!(
        parse(&text(&file)).unwrap_err(),
        format!("estimate.json:{id}: estimate tank/f4: its data names d9, which is not a file of the record")
    );
    let mut file = sample();
    file.estimates.push(file.estimates[0].clone());
    let second = 1 + text(&file).lines().enumerate().filter(|(_, l)| l.contains("\"id\"")).nth(1).unwrap().0;
    assert_eq!(
        parse(&text(&file)).unwrap_err(),
        format!("estimate.json:{second}: the id `tank/f4` appears twice; every estimate needs its own")
    );
    file.estimates[1].id = "tank/f5".to_owned();
    assert_eq!(
        parse(&text(&file)).unwrap_err(),
        format!(
            "estimate.json:{second}: estimate tank/f5: it is the second of source \"tank\" to be recommended; one is"
        )
    );
}

#[test]
fn a_record_may_be_laid_out_otherwise_and_not_say_otherwise() {
    let written = summed(&sample());
    let sorted: serde_json::Value = serde_json::from_str(&written).unwrap();
    assert_eq!(parse(&sorted.to_string()).unwrap(), sample(), "keys sorted, on one line");
    assert_eq!(parse(&text(&sample())).unwrap(), sample(), "without the checksum");
    let other = written.replacen("\"value\": 0.4", "\"value\": 0.5", 1);
    assert_ne!(other, written);
    assert_eq!(
        parse(&other).unwrap_err(),
        "estimate.json:3: the content is not what this checksum was written for: the file was edited or damaged. Copy it again \
         from where it was written; to adopt an edit, delete this line"
    );
}

type Spoil = fn(&mut Estimate);

#[test]
fn a_number_that_is_not_finite_is_never_written_as_null() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("estimate.json");
    write_estimates(&path, &sample()).unwrap();
    let before = std::fs::read(&path).unwrap();
    let cases: [(&str, &str, Spoil); 7] = [
        ("coefficients.C_d_I.value", "NaN", |e| e.coefficients["C_d_I"].value = Some(f64::NAN)),
        ("coefficients.C_d_I.interval_95", "inf", |e| e.coefficients["C_d_I"].interval_95 = Some([0.0, f64::INFINITY])),
        ("diagnostics.condition_number", "inf", |e| e.diagnostics.condition_number = Some(f64::INFINITY)),
        ("type_a.matrix", "NaN", |e| e.type_a.as_mut().unwrap().matrix[0][0] = f64::NAN),
        ("errors.cal/1", "NaN", |e| e.errors["cal/1"].sensitivity[0][0] = f64::NAN),
        ("refers_to.a", "NaN", |e| e.refers_to["a"].value = f64::NAN),
        ("dof.f_x", "inf", |e| e.dof["f_x"] = Some(f64::INFINITY)),
    ];
    for (item, value, spoil) in cases {
        let mut file = sample();
        spoil(&mut file.estimates[0]);
        assert_eq!(
            write_estimates(&path, &file).unwrap_err().to_string(),
            format!(
                "cannot write {}: tank/f4, {item} is {value}, not a finite number; nothing was changed",
                path.display()
            )
        );
        assert_eq!(std::fs::read(&path).unwrap(), before);
    }
    assert!(read_estimates(&path).is_ok());
}

proptest! {
    /// Numbers come back bit for bit, whatever they are, and stay valid against the schema.
    #[test]
    fn numbers_read_back_to_the_bits_that_were_written(
        value in proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        other in -1e6..1e6_f64,
    ) {
        let mut file = sample();
        file.estimates[0].coefficients["C_d_I"].value = Some(value);
        file.estimates[0].refers_to["density"] = Measured::of(other, "kg/m^3");
        let read = parse(&summed(&file)).unwrap();
        let found = read.estimates[0].coefficients["C_d_I"].value.unwrap();
        prop_assert_eq!(found.to_bits(), value.to_bits());
        prop_assert_eq!(read, file);
    }
}

/// Relative error that a factor of 100 and its inverse make: some units in the last place.
const ROUNDING: f64 = 1e-14;

/// Every `unit` of a JSON value, and every unit of a law's inputs, as JSON pointers.
fn unit_places(value: &serde_json::Value, at: &str, out: &mut Vec<String>) {
    let Some(object) = value.as_object() else {
        for (i, inner) in value.as_array().into_iter().flatten().enumerate() {
            unit_places(inner, &format!("{at}/{i}"), out);
        }
        return;
    };
    for (key, inner) in object {
        let here = format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
        if inner.is_string() && (key == "unit" || at.ends_with("/inputs")) {
            out.push(here);
        } else {
            unit_places(inner, &here, out);
        }
    }
}

/// What the schema says of a unit: `unit_converted` or `unit_si`.
fn stated_in_schema<'a>(schema: &'a serde_json::Value, pointer: &str) -> &'a str {
    fn resolve<'a>(root: &'a serde_json::Value, at: &'a serde_json::Value) -> &'a serde_json::Value {
        let target = at["$ref"].as_str().map(|to| root.pointer(to.trim_start_matches('#')).unwrap());
        target.map_or(at, |target| resolve(root, target))
    }
    let mut at = schema;
    for key in pointer.split('/').skip(1) {
        let level = resolve(schema, at);
        at = [&level["properties"][key], &level["items"], &level["additionalProperties"]]
            .into_iter()
            .find(|next| next.is_object())
            .unwrap_or_else(|| panic!("{pointer}: {key}"));
    }
    at["$ref"].as_str().and_then(|to| to.strip_prefix("#/$defs/")).unwrap_or_else(|| panic!("{pointer} says nothing"))
}

fn assert_close(a: &serde_json::Value, b: &serde_json::Value, at: &str) {
    match (a, b) {
        (serde_json::Value::Object(x), serde_json::Value::Object(y)) => {
            assert!(x.keys().eq(y.keys()), "{at}");
            x.iter()
                .filter(|(key, _)| *key != "checksum")
                .for_each(|(key, v)| assert_close(v, &y[key], &format!("{at}/{key}")));
        }
        (serde_json::Value::Array(x), serde_json::Value::Array(y)) => {
            assert_eq!(x.len(), y.len(), "{at}");
            x.iter().zip(y).for_each(|(v, w)| assert_close(v, w, at));
        }
        _ => match (a.as_f64(), b.as_f64()) {
            (Some(x), Some(y)) => assert!((x - y).abs() <= ROUNDING * x.abs(), "{at}: {x} and {y}"),
            _ => assert_eq!(a, b, "{at}"),
        },
    }
}

/// Every unit of a record, one by one: in percent of itself with numbers a hundred times as large the record says the same, or it is rejected as the
/// schema states; a unit that is no unit, or one of another quantity, is rejected with its line.
#[test]
fn every_unit_of_a_record_is_converted_or_rejected() {
    let schema: serde_json::Value = serde_json::from_str(ESTIMATE_JSON_SCHEMA).unwrap();
    let mut file = sample();
    file.comparison.as_mut().unwrap().validation.retain(|v| !v.unit.is_empty());
    let mut whole = serde_json::to_value(&file).unwrap();
    whole.as_object_mut().unwrap().remove("checksum");
    let mut places = Vec::new();
    unit_places(&whole, "", &mut places);
    let (mut converted, mut rejected) = (0, 0);
    for place in &places {
        let unit = whole.pointer(place).unwrap().as_str().unwrap().to_owned();
        let mut other = whole.clone();
        *other.pointer_mut(place).unwrap() = format!("% {unit}").replace("% 1", "%").into();
        let parent = place.rsplit_once('/').unwrap().0.to_owned();
        match stated_in_schema(&schema, place) {
            "unit_si" => {
                let said = parse(&serde_json::to_string_pretty(&other).unwrap()).expect_err(place);
                assert!(
                    said.starts_with("estimate.json:") && said.contains("is not converted here; write the SI unit"),
                    "{said}"
                );
                rejected += 1;
            }
            "unit_converted" => {
                let beside = other.pointer_mut(&parent).unwrap().as_object_mut().unwrap();
                for (key, number) in beside.iter_mut().filter(|(key, _)| *key != "effective_dof") {
                    let times = |v: &mut serde_json::Value| {
                        if let Some(x) = v.as_f64() {
                            *v = (100.0 * x).into();
                        }
                    };
                    assert!(key != "matrix", "{place}");
                    times(number);
                    number.as_array_mut().into_iter().flatten().for_each(times);
                }
                if place.ends_with("/C_d_I/unit") {
                    let estimate = &mut other["estimates"][0];
                    estimate["type_a"]["matrix"] = serde_json::json!([[100.0]]);
                    estimate["errors"]["cal/1"]["sensitivity"] = serde_json::json!([[20.0]]);
                }
                let read = parse(&other.to_string()).unwrap_or_else(|e| panic!("{place}: {e}"));
                let mut read = serde_json::to_value(&read).unwrap();
                read.as_object_mut().unwrap().remove("checksum");
                assert_close(&whole, &read, place);
                converted += 1;
            }
            said => panic!("{place}: {said}"),
        }
        let mut other = whole.clone();
        *other.pointer_mut(place).unwrap() = "nonsense".into();
        let said = parse(&serde_json::to_string_pretty(&other).unwrap()).expect_err(place);
        assert!(
            said.starts_with("estimate.json:") && said.contains("is rejected: unknown unit `nonsense`"),
            "{place}: {said}"
        );
    }
    assert_eq!((converted, rejected), (10, 5), "{places:#?}");
}

#[test]
fn a_unit_of_another_quantity_is_rejected_with_its_line() {
    let at = 1 + line_with("\"density\": {");
    let unit = 1 + at;
    refused(
        "\"unit\": \"kg/m^3\"",
        "\"unit\": \"kg\"",
        &format!(
            "estimate.json:{unit}: estimate tank/f4: the unit of refers_to.density is rejected: `kg` is a mass (kg); expected a density (kg/m^3)"
        ),
    );
}
