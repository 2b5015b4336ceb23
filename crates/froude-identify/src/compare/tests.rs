use froude_records::comparison::Comparison;
use froude_records::estimate::{Clusters, DataFile, ErrorKind, EstimateFile, Range, SharedError, keyed};
use froude_records::run::step::Step;

use super::coefficients::SAME_DATA;
use super::*;
use crate::compare::stated::NORMAL_COVERAGE;
use crate::data_files::PART;

fn file(path: &str, sha256: &str) -> DataFile {
    DataFile { path: path.to_owned(), sha256: sha256.to_owned(), ..DataFile::default() }
}

/// A quadratic drag fit: `D` with its standard uncertainty and degrees of freedom.
fn record(source: &str, table: &str, d: f64, standard: f64, dof: Option<f64>) -> EstimateFile {
    let estimate = serde_json::json!({
        "id": format!("{source}/quadratic"), "source": source, "kind": "towing",
        "law": {
            "name": "quadratic", "version": 1, "outputs": { "f_x": { "unit": "N", "formula": "-D*v_x*abs(v_x)" } },
        },
        "sigma": { "f_x": { "value": 0.1 * d, "unit": "N" } },
        "n": 12,
        "coefficients": { "D": {
            "value": d, "unit": "kg/m", "status": "free", "standard_uncertainty": standard, "effective_dof": dof
        } },
        "type_a": { "names": ["D"], "matrix": [[standard * standard]], "dof": [dof], "kind": "classical" },
        "validity": { "speed": { "low": 0.2, "high": 1.0, "unit": "m/s" } },
        "recommended": true,
    });
    EstimateFile {
        data: keyed(vec![file("campaign.toml", "campaign"), file("drag.csv", table)]),
        ..EstimateFile::of(vec![serde_json::from_value(estimate).unwrap()])
    }
}

fn compared(first: EstimateFile, second: EstimateFile) -> Comparison {
    let files = [("a.json".to_owned(), first), ("b.json".to_owned(), second)];
    compare(&named(&files))
}

fn codes(c: &Comparison) -> Vec<&str> {
    c.findings.iter().map(|f| f.code.as_str()).collect()
}

#[test]
fn a_record_beside_itself_gets_no_normalised_difference() {
    let one = record("frame", "t1", 47.8, 0.4, Some(9.0));
    let c = compared(one.clone(), one);
    assert_eq!(c.coefficients[0].note, SAME_DATA);
    assert_eq!(c.joint[0].note, "same data: not independent, χ² not meaningful");
    assert!(!c.loads.is_empty());
    assert!(c.loads.iter().all(|f| f.note == SAME_DATA));
    assert_eq!(codes(&c), ["same-data"]);
}

/// Another selection of the rows, another source name: the fingerprint of the table tells.
#[test]
fn two_fits_to_one_table_are_not_independent() {
    let mut other = record("slow runs", "t1", 46.9, 0.7, Some(4.0));
    other.estimates[0].n_observations = 6;
    let c = compared(record("frame", "t1", 47.8, 0.4, Some(9.0)), other);
    assert_eq!(c.coefficients[0].note, SAME_DATA);
    assert_eq!(codes(&c), ["same-data"]);
}

/// The same run matrix on another day, a bare table of the same name: ranges and names agree, the tables do not.
#[test]
fn a_repeated_campaign_is_independent_and_no_contradiction() {
    let c = compared(record("drag", "t1", 47.8, 0.4, Some(9.0)), record("drag", "t2", 47.1, 0.4, Some(9.0)));
    assert!(c.coefficients[0].e_n.is_some());
    assert!(c.joint[0].p.is_some());
    assert_eq!(codes(&c), Vec::<&str>::new());
}

/// Two sources of one record share its list of tables, not their observations.
#[test]
fn sources_of_one_record_are_independent() {
    let mut both = record("frame", "t1", 47.8, 0.4, Some(9.0));
    both.estimates.extend(record("rotor", "t2", 51.0, 0.4, Some(9.0)).estimates);
    both.data.insert("d3".to_owned(), file("rotor.csv", "t2"));
    let files = [("a.json".to_owned(), both)];
    assert!(compare(&named(&files)).coefficients[0].e_n.is_some());
}

/// A record of one table: all its sources read it, whatever they kept of it.
#[test]
fn sources_of_one_table_in_one_record_are_not_independent() {
    let mut both = record("all", "t1", 47.8, 0.4, Some(9.0));
    both.estimates.extend(record("slow runs", "t1", 46.9, 0.7, Some(4.0)).estimates);
    both.estimates[1].n_observations = 6;
    let files = [("a.json".to_owned(), both)];
    assert_eq!(compare(&named(&files)).coefficients[0].note, SAME_DATA);
}

/// A record that says which estimate read which file: two sources of one table are found out, whatever their names, two of two are not.
#[test]
fn a_record_that_names_the_data_of_each_estimate_is_believed() {
    let mut both = record("all", "t1", 47.8, 0.4, Some(9.0));
    both.estimates.extend(record("slow runs", "t2", 46.9, 0.7, Some(4.0)).estimates);
    both.data.insert("d3".to_owned(), file("slow.csv", "t2"));
    // Another sheet of the same workbook.
    let sheet = |name: &str| DataFile { steps: vec![Step::new(PART, "", name)], ..file("all.csv", "t1") };
    both.data.insert("d2".to_owned(), sheet("hull"));
    both.data.insert("d4".to_owned(), sheet("strut"));
    for (second, is_same) in [("d2", true), ("d3", false), ("d4", false)] {
        both.estimates[0].data = vec!["d2".to_owned()];
        both.estimates[1].data = vec![second.to_owned()];
        let c = compare(&named(&[("a.json".to_owned(), both.clone())]));
        assert_eq!(c.coefficients[0].note == SAME_DATA, is_same, "{second}");
    }
}

/// `D` with an error of its own scatter and one of a calibration, of 0.3 and 0.4.
fn calibrated(source: &str, d: f64, key: &str) -> EstimateFile {
    let mut file = record(source, source, d, 0.3, None);
    let estimate = &mut file.estimates[0];
    estimate.coefficients["D"].standard_uncertainty = Some(0.5);
    let error = SharedError {
        name: "force per volt".to_owned(),
        quantity: "force_per_volt".to_owned(),
        kind: ErrorKind::B,
        covariance: vec![vec![1e-4]],
        dof: None,
        limits: None,
        sensitivity: vec![vec![40.0]],
    };
    estimate.errors.insert(key.to_owned(), error);
    file
}

/// u²(a − b) = 2·0.3² where both have one calibration, which moves both alike; 2·0.5² where each has its own. χ² and forces alike.
#[test]
fn what_two_records_share_by_its_key_is_taken_out() {
    let k = NORMAL_COVERAGE;
    for (key, u) in [("cal/1", 0.3), ("cal/2", 0.5)] {
        let c = compared(calibrated("a", 40.0, "cal/1"), calibrated("b", 41.0, key));
        let expected = -1.0 / (k * u * 2.0_f64.sqrt());
        assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-12, "{:?}", c.coefficients[0]);
        assert!((c.joint[0].chi_squared.unwrap() - 1.0 / (2.0 * u * u)).abs() < 1e-9, "{:?}", c.joint);
        assert!(c.loads.iter().all(|f| (f.e_n.unwrap() + expected).abs() < 1e-12), "{:?}", c.loads);
        assert_eq!(codes(&c).contains(&"errors-in-common"), key == "cal/1");
    }
}

/// An error that goes into the two with different strength leaves its difference: |40 − 20|·0.01 = 0.2.
#[test]
fn an_error_that_two_records_feel_differently_leaves_a_part() {
    let mut other = calibrated("b", 41.0, "cal/1");
    other.estimates[0].errors["cal/1"].sensitivity = vec![vec![20.0]];
    let c = compared(calibrated("a", 40.0, "cal/1"), other);
    let expected = -1.0 / (NORMAL_COVERAGE * (2.0_f64 * 0.09 + 0.04).sqrt());
    assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-12, "{:?}", c.coefficients[0]);
}

/// Scatter of 0.2 with four degrees of freedom beside a common calibration of 0.4: what stays has four, not the hundred of both together.
#[test]
fn what_stays_of_two_records_has_its_own_degrees_of_freedom() {
    let of = |source: &str, d: f64| {
        let mut file = calibrated(source, d, "cal/1");
        let estimate = &mut file.estimates[0];
        let scatter = estimate.type_a.as_mut().unwrap();
        (scatter.matrix[0][0], scatter.dof[0]) = (0.04, Some(4.0));
        let d = &mut estimate.coefficients["D"];
        (d.standard_uncertainty, d.effective_dof) = (Some(0.2_f64.hypot(0.4)), Some(100.0));
        file
    };
    let difference = 2.776_445 * 0.08_f64.sqrt();
    let c = compared(of("a", 40.0 + difference), of("b", 40.0));
    // Two-sided probability of t = 2.776 with four degrees of freedom.
    assert!((c.joint[0].p.unwrap() - 0.05).abs() < 1e-6, "{:?}", c.joint[0]);
}

/// A heave decay beside two tables: its range of speeds is no range of theirs, and the forces stay.
#[test]
fn a_law_that_gives_no_force_along_or_across_has_no_part_in_the_range() {
    let mut decay = record("springs", "t3", 40.0, 1.0, None);
    let law = &mut decay.estimates[0].law;
    law.name = "added_mass_linear_quadratic".to_owned();
    law.outputs = serde_json::from_value(serde_json::json!({
        "f_z": { "unit": "N", "formula": "-A33*v_z_dot - D*v_z*abs(v_z)" }
    }))
    .unwrap();
    decay.estimates[0].validity["speed"] = Range::of([0.01, 0.05], "m/s");
    let files = [record("a", "t1", 10.0, 1.0, None), record("b", "t2", 11.0, 1.0, None), decay]
        .map(|file| (file.estimates[0].source.clone(), file));
    let c = compare(&named(&files));
    assert_eq!(c.load_sources(), ["a/quadratic", "b/quadratic"]);
    assert!(!c.loads.is_empty() && codes(&c).is_empty(), "{:?}", c.findings);
}

/// One calibration, declared with two uncertainties: it is not known which is right.
#[test]
fn one_error_with_two_uncertainties_is_said_and_not_taken_out() {
    let mut other = calibrated("b", 41.0, "cal/1");
    other.estimates[0].errors["cal/1"].covariance = vec![vec![4e-4]];
    let c = compared(calibrated("a", 40.0, "cal/1"), other);
    assert_eq!(codes(&c), ["errors-contradict"]);
}

/// An interval that reaches to one side: from the other side the difference counts in full.
#[test]
fn an_interval_to_one_side_has_its_arm_to_the_other_value() {
    let mut one = record("a", "a", 40.0, 1e-9, None);
    let error = calibrated("a", 40.0, "own/limits").estimates.remove(0).errors.swap_remove("own/limits").unwrap();
    // The truth lies up to 4 below the value.
    let limits = Some([-4.0, 0.0]);
    let error = SharedError { limits, sensitivity: vec![vec![1.0]], covariance: vec![vec![16.0 / 3.0]], ..error };
    one.estimates[0].errors.insert("own/limits".to_owned(), error);
    one.estimates[0].coefficients["D"].standard_uncertainty = Some(2.3);
    let below = compared(one.clone(), record("b", "b", 39.0, 0.1, None)).coefficients[0].e_n.unwrap();
    let above = compared(one, record("b", "b", 41.0, 0.1, None)).coefficients[0].e_n.unwrap();
    assert!(below.abs() < 0.3 && above.abs() > 5.0, "{below} {above}");
}

/// Four degrees of freedom: Student's t is 2.776, not 1.96 (any printed table).
#[test]
fn few_degrees_of_freedom_widen_the_expanded_uncertainty() {
    let c = compared(record("a", "t1", 10.0, 1.0, Some(4.0)), record("b", "t2", 13.0, 1.0, None));
    let expected = -3.0 / 2.776_445f64.hypot(1.959_964);
    assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-6);
    assert_eq!(
        c.coverage,
        [
            "a/quadratic: k = 2.78 (Student's t, effective degrees of freedom 4.0)",
            "b/quadratic: k = 1.96 (normal), its record states no degrees of freedom"
        ]
    );
}

/// F = D v²: whatever the speed, the forces differ by as many U as the coefficients do.
#[test]
fn a_law_of_one_coefficient_has_one_normalised_difference() {
    let c = compared(record("a", "t1", 10.0, 1.0, Some(4.0)), record("b", "t2", 13.0, 0.8, Some(30.0)));
    let of_d = c.coefficients[0].e_n.unwrap();
    for row in &c.loads {
        // Force on the body: the sign turns.
        let of_force = row.e_n.unwrap();
        assert!((of_force + of_d).abs() < 1e-12 * of_d.abs(), "{of_force} against {of_d} at {} m/s", row.speed_m_s);
    }
}

#[test]
fn a_body_without_links_has_none() {
    let c = compared(record("a", "t1", 10.0, 1.0, None), record("b", "t2", 13.0, 1.0, None));
    assert!(c.loads.iter().all(|f| f.n_links.is_none()));
}

/// Weights are observations of a calibration. To a drag that its force per volt scales they are none: there they are an error under its own key.
#[test]
fn two_reductions_of_one_calibration_are_not_independent() {
    let of = |source: &str, method: &str, tow: &str, value: f64| {
        let mut out = record(source, tow, value, 0.4, Some(9.0));
        out.estimates[0].method.name = method.to_owned();
        out.data
            .insert("d3".to_owned(), DataFile { role: Some("calibration".to_owned()), ..file("weight.mcap", "w1") });
        out.estimates[0].data =
            if method == "calibration" { vec!["d3".to_owned()] } else { vec!["d2".to_owned(), "d3".to_owned()] };
        out
    };
    let c = compared(of("one", "calibration", "t1", 47.8), of("two", "calibration", "t2", 46.9));
    assert_eq!(c.coefficients[0].note, SAME_DATA);
    let c = compared(of("one", "mcd", "t1", 47.8), of("two", "mcd", "t2", 46.9));
    assert_ne!(c.coefficients[0].note, SAME_DATA);
}

/// One cluster decides D: where its record gives no interval, none is made of its standard uncertainty beside another.
#[test]
fn what_has_no_interval_has_no_expanded_uncertainty() {
    let mut one = record("a", "t1", 10.0, 1.0, Some(1.4));
    one.estimates[0].clusters = Some(Clusters { by: "run".to_owned(), n: 6 });
    let c = compared(one, record("b", "t2", 13.0, 1.0, None));
    let row = &c.coefficients[0];
    assert_eq!((row.first.expanded_uncertainty, row.first.coverage_factor, row.e_n), (None, None, None));
    assert_eq!(row.first.standard_uncertainty, Some(1.0));
    assert_eq!(
        row.note,
        "a/quadratic gives no interval, or one of the laws that its data do not contradict gives none"
    );
    assert_eq!(c.joint[0].note, row.note);
    assert!(!c.loads.is_empty() && c.loads.iter().all(|l| l.e_n.is_none() && l.first.expanded_uncertainty.is_none()));
    assert_eq!(c.coverage[0], "a/quadratic: no interval stated");
    assert!(c.verdicts.is_empty());
}
