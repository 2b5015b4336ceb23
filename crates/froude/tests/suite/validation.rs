//! A computed source held against a measured one, by ASME V&V 20, through the pipeline.

use froude::pipeline::{Identified, Job, identify};
use froude::records::comparison::Validation;

const SPEEDS: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
/// N/(m/s)², and how far the measured loads lie from the law, N.
const MEASURED: f64 = 20.0;
const NOISE: [f64; 6] = [0.1, -0.1, 0.05, 0.0, -0.05, 0.02];
/// Computed over measured.
const RATIO: f64 = 0.8;

fn validated(folder: &std::path::Path, budget: &str) -> Identified {
    let table = |of: &dyn Fn(usize, f64) -> f64| {
        let rows = SPEEDS.iter().enumerate().map(|(k, u)| format!("{u},{}\n", of(k, -u * u)));
        format!("speed [m/s],f_x [N]\n{}", rows.collect::<String>())
    };
    std::fs::write(folder.join("tank.csv"), table(&|k, square| MEASURED * square + NOISE[k])).unwrap();
    std::fs::write(folder.join("cfd.csv"), table(&|_, square| RATIO * MEASURED * square)).unwrap();
    let campaign = format!(
        "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n\
         [[source]]\nname = \"computed\"\nkind = \"cfd\"\ntable = \"cfd.csv\"\n{budget}\
         [[source]]\nname = \"tank\"\nkind = \"tank\"\ntable = \"tank.csv\"\n\
         [identify]\nmodels = [\"quadratic\"]\n"
    );
    std::fs::write(folder.join("c.toml"), campaign).unwrap();
    identify(&Job::new(folder.join("c.toml")), &|_| {}).unwrap()
}

fn number<'a>(found: &'a Identified, quantity: &str) -> &'a Validation {
    let all = &found.file.comparison.as_ref().unwrap().validation;
    all.iter().find(|v| v.quantity == quantity).unwrap_or_else(|| panic!("no {quantity} in {all:?}"))
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9 * expected.abs() + 1e-12, "{found}, not {expected}");
}

/// E, and what u_val is made of, by the formulas of the standard for one coefficient: F = −c U², so that a part of q of all loads is q of c.
#[test]
fn the_comparison_error_and_its_uncertainty_are_those_of_the_standard() {
    let folder = tempfile::tempdir().unwrap();
    let entry = |kind: &str, percent: f64| {
        format!(
            "[[source.uncertainty]]\nname = \"{kind}\"\nquantity = \"f_x\"\nstandard = \"{percent} %\"\nshared = \"campaign\"\nkind = \"{kind}\"\n"
        )
    };
    let budget = entry("numerical", 1.0) + &entry("input", 2.0) + &entry("model_form", 20.0);
    let found = validated(folder.path(), &budget);

    let tank = found.file.estimates.iter().find(|e| e.source == "tank").unwrap();
    let d = &tank.coefficients["D_x_II"];
    let (d, u_d) = (d.value.unwrap(), d.standard_uncertainty.unwrap());
    let c = number(&found, "D_x_II");
    let s = RATIO * MEASURED;
    close(c.error, s - d);
    close(c.u_numerical, 0.01 * s);
    close(c.u_input, 0.02 * s);
    close(c.u_data.unwrap(), u_d);
    close(c.declared_model_form, 0.2 * s);
    let u_fit = c.u_fit;
    assert!(u_fit < 1e-9, "the computed loads follow the law: {u_fit}");
    close(c.u_validation, (0.01 * s).hypot(0.02 * s).hypot(u_d));
    assert!(c.is_beyond());

    // The same of the loads: roots of mean squares over six flows, with U² as the only regressor.
    let mean = (SPEEDS.iter().map(|u| u.powi(4)).sum::<f64>() / 6.0).sqrt();
    let f = number(&found, "f_x");
    assert_eq!((f.flows, f.beyond), (Some(6), Some(6)));
    close(f.computed, s * mean);
    close(f.measured, d * mean);
    close(f.error, (s - d).abs() * mean);
    close(f.ratio.unwrap(), s / d);
    close(f.u_numerical, 0.01 * s * mean);
    close(f.u_input, 0.02 * s * mean);
    close(f.u_data.unwrap(), u_d * mean);
    close(f.declared_model_form, 0.2 * s * mean);

    // The record, the page and the table of flows have it.
    let html = std::fs::read_to_string(found.path("report").unwrap()).unwrap();
    assert!(html.contains("Validation of computed") && html.contains("V&amp;V 20"));
    let flows = found.path("exports").filter(|path| path.ends_with("validation-computed.csv")).unwrap();
    let table = froude::records::table_file::read_table(flows, None).unwrap();
    let headers: Vec<String> = table.columns.iter().map(froude::records::table::Column::header).collect();
    assert_eq!(table.n_rows, 6);
    assert!(
        ["S [N]", "E [N]", "u_D [N]", "u_val [N]"].iter().all(|h| headers.iter().any(|own| own == h)),
        "{headers:?}"
    );
}

/// An error that the uncertainties explain is no error of the model.
#[test]
fn what_the_uncertainties_explain_is_not_beyond_them() {
    let folder = tempfile::tempdir().unwrap();
    let budget =
        "[[source.uncertainty]]\nquantity = \"f_x\"\nstandard = \"15 %\"\nshared = \"campaign\"\nkind = \"input\"\n";
    let found = validated(folder.path(), budget);
    assert!(!number(&found, "D_x_II").is_beyond());
    assert_eq!(number(&found, "f_x").beyond, Some(0));
}

#[test]
fn a_kind_that_is_none_is_refused_and_without_measurements_nothing_is_validated() {
    let folder = tempfile::tempdir().unwrap();
    validated(folder.path(), "");
    let path = folder.path().join("c.toml");
    let campaign = std::fs::read_to_string(&path).unwrap();
    let wrong = campaign.replacen(
        "[[source]]\nname = \"tank\"",
        "[[source.uncertainty]]\nquantity = \"f_x\"\nstandard = \"1 %\"\nshared = \"campaign\"\nkind = \"mesh\"\n[[source]]\nname = \"tank\"",
        1,
    );
    std::fs::write(&path, wrong).unwrap();
    let refused = identify(&Job::new(&path), &|_| {}).unwrap_err().to_string();
    assert!(refused.contains("kind") && refused.contains("numerical") && refused.contains("model_form"), "{refused}");
    std::fs::write(&path, campaign.replacen("kind = \"tank\"", "kind = \"cfd\"", 1)).unwrap();
    let found = identify(&Job::new(&path), &|_| {}).unwrap();
    assert!(found.file.comparison.unwrap().validation.is_empty());
}
