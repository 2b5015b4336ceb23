//! One table both ways: the rows in memory, and the passes over chunks.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use froude_records::campaign::Campaign;
use froude_records::campaign_file::read_campaign;
use froude_records::table_file::read_table;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde_json::Value;

use super::identify_source;
use crate::error::IdentifyError;
use crate::result::SourceResult;
use crate::source::identify_source as in_memory;

/// Two ways of adding the same rows up, at condition numbers below 100.
const AGREE: f64 = 1e-10;
/// Rows: two chunks of CSV and two of Parquet.
const ROWS: usize = 20_000;
/// A sample smaller than the table.
const SMALL: usize = 1_000;

/// A planar record at 1 kHz of a body whose law is known; 10 runs of two configurations.
fn record() -> String {
    let mut rng = Pcg64::new(3, 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut out =
        "time [s],run,configuration,f_x [N],f_y [N],v_x [m/s],v_y [m/s],temperature [degC],heading [rad]\n".to_owned();
    for i in 0..ROWS {
        let run = i * 10 / ROWS;
        let (u, v) = (1.0 + 0.4 * normal(), 0.3 * normal());
        let drift = 0.05 * (run as f64 - 4.5);
        let x = -0.4 * u - 2.2 * u * u.abs() + drift + 0.1 * normal();
        let y = -1.5 * v - 12.0 * v * v.abs() - drift + 0.1 * normal();
        let t = 18.0 + 0.1 * normal();
        let _ = writeln!(
            out,
            "{:.3},r{run},H{}LT,{x:.6},{y:.6},{u:.6},{v:.6},{t:.2},{:.4}",
            0.001 * i as f64,
            2 + i % 2,
            0.1 * normal()
        );
    }
    out
}

const HEAD: &str = r#"
schema = 1
name = "A long record"
[fluid]
salinity = "0 g/kg"
[body]
reference_length = "0.5 m"
reference_area = "0.02 m^2"
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
head_side_area = "0.011 m^2"
tail_side_area = "0.008 m^2"
[tank]
width = "2 m"
depth = "1 m"
submergence = "0.3 m"
"#;

fn written(folder: &Path, source: &str, identify: &str) -> Campaign {
    std::fs::write(folder.join("record.csv"), record()).unwrap();
    let path = folder.join("campaign.toml");
    let text = format!("{HEAD}\n[[source]]\nname = \"tank\"\nkind = \"tank\"\n{source}\n[identify]\n{identify}\n");
    std::fs::write(&path, text).unwrap();
    read_campaign(&path).unwrap()
}

fn both(campaign: &Campaign) -> [SourceResult; 2] {
    let source = &campaign.sources[0];
    [in_memory(campaign, source, &|_| {}).unwrap(), identify_source(campaign, source, SMALL, &|_| {}).unwrap().unwrap()]
}

/// What is not judged in chunks, or from the sample.
const LEFT_OUT: [&str; 3] = ["lack_of_fit_p", "cross_validation_rmse", "cross_validation_note"];
const OF_ROWS: [&str; 6] =
    ["setup-offset", "read-in-chunks", "uneven-scatter", "lack-of-fit", "no-repeats", "not-fitted"];

fn agree(at: &str, a: &Value, b: &Value) {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|x| x.as_f64().unwrap());
            assert!((a - b).abs() <= AGREE * a.abs().max(b.abs()), "{at}: {a} and {b}");
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{at}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| agree(&format!("{at}/{i}"), a, b));
        }
        (Value::Object(a), Value::Object(b)) => {
            let keys = |of: &serde_json::Map<String, Value>| -> Vec<String> {
                of.keys().filter(|key| !LEFT_OUT.contains(&key.as_str())).cloned().collect()
            };
            assert_eq!(keys(a), keys(b), "{at}");
            for key in keys(a) {
                agree(&format!("{at}/{key}"), &a[&key], &b[&key]);
            }
        }
        // The words of a recommendation have the numbers of its criteria, to a tenth.
        _ => assert_eq!(a, b, "{at}"),
    }
}

fn findings(of: &SourceResult) -> Vec<String> {
    let said = of.findings.iter().filter(|f| !OF_ROWS.contains(&f.code.as_str()));
    let mut out: Vec<String> = said.map(|f| format!("{}: {}", f.code, f.message)).collect();
    out.sort();
    out
}

fn check(campaign: &Campaign) {
    let [rows, chunks] = both(campaign);
    assert_eq!(rows.estimates.len(), chunks.estimates.len());
    for (a, b) in rows.estimates.iter().zip(&chunks.estimates) {
        let [a, b] = [a, b].map(|estimate| serde_json::to_value(estimate).unwrap());
        agree(a["id"].as_str().unwrap(), &a, &b);
    }
    assert_eq!(findings(&rows), findings(&chunks));
    assert_eq!(rows.recommendation, chunks.recommendation);
    assert_eq!(rows.tests.len(), chunks.tests.len());
    for (a, b) in rows.tests.iter().zip(&chunks.tests) {
        assert!((a.f - b.f).abs() < AGREE * a.f.max(1.0) * 1e3, "{a:?} {b:?}");
    }
    assert_eq!(rows.n_read, chunks.n_read);
    assert_eq!(rows.data.rows, chunks.data.observations());
    assert_eq!(chunks.data.rows, SMALL);
}

#[test]
fn laws_of_a_bare_table_are_the_same_from_its_rows_and_from_chunks() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "table = \"record.csv\"", "");
    let mut campaign = Campaign::of_table(&folder.path().join("record.csv"), None);
    campaign.identify.models = ["quadratic", "linear_quadratic", "strut"].map(str::to_owned).to_vec();
    check(&campaign);
}

#[test]
fn keep_clusters_bounds_and_drag_models_are_the_same_from_rows_and_from_chunks() {
    let folder = tempfile::tempdir().unwrap();
    let source = "table = \"record.csv\"\nkeep = \"v_x >= 0.2 m/s\"\ngroup = \"run\"";
    let law = "[[identify.model]]\nname = \"own\"\nf_y = \"Y_v*v + Y_vav*v*abs(v) + Y_0\"";
    check(&written(
        folder.path(),
        source,
        &format!("models = [\"f1\", \"f4\", \"f6\", \"own\"]\ncovariance = \"cluster\"\n{law}"),
    ));
    check(&written(folder.path(), source, "models = [\"f4\"]\nbounds = \"non-negative\"\ndissipative = true"));
}

/// Runs of a body that sways by six amplitudes, each twice.
fn repeated() -> String {
    let mut rng = Pcg64::new(7, 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut out = "time [s],run,f_x [N],f_y [N],v_x [m/s],v_y [m/s]\n".to_owned();
    for run in 0..12 {
        let amplitude = 0.1 + 0.05 * f64::from(run % 6);
        for i in 0..1_000 {
            let t = 0.01 * f64::from(i);
            let (u, v) = (1.0, amplitude * (std::f64::consts::TAU * 0.2 * t).sin());
            let (x, y) = (-2.0 * u * u + 0.1 * normal(), -1.5 * v - 12.0 * v * v.abs() + 0.1 * normal());
            let _ = writeln!(out, "{:.3},r{run},{x:.6},{y:.6},{u:.6},{v:.6}", 20.0 * f64::from(run) + t);
        }
    }
    out
}

#[test]
fn runs_that_repeat_a_motion_are_one_cluster_in_rows_and_in_chunks() {
    let folder = tempfile::tempdir().unwrap();
    let law = "models = [\"own\"]\n[[identify.model]]\nname = \"own\"\nf_y = \"Y_v*v + Y_vav*v*abs(v)\"";
    std::fs::write(folder.path().join("repeated.csv"), repeated()).unwrap();
    let campaign = written(
        folder.path(),
        "table = \"repeated.csv\"\ngroup = \"run\"",
        &format!("covariance = \"cluster\"\n{law}"),
    );
    check(&campaign);
    let [rows, chunks] = both(&campaign);
    for result in [rows, chunks] {
        let clusters = result.estimates[0].clusters.clone().unwrap();
        assert_eq!((clusters.by.as_str(), clusters.n), ("motion", 6));
        let said = result.findings.iter().find(|f| f.code == "repeated-motions").unwrap();
        assert!(
            said.message.contains("6 of the 12 groups in time repeat the motion of another (\"r6\" that of \"r0\")")
        );
    }
}

/// A propeller pushes: a load along the motion is no sign of a sensor that is mounted the other way round.
#[test]
fn a_load_that_has_another_cause_is_passed_over_in_rows_and_in_chunks() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64::new(11, 0);
    let mut text = "v_x [m/s],rate [rad/s],f_x [N]\n".to_owned();
    for i in 0..2_000 {
        let (u, rate, z): (f64, f64, f64) =
            (0.05 * f64::from(1 + i % 40), f64::from(2 + i % 7), StandardNormal.sample(&mut rng));
        let _ = writeln!(text, "{u},{rate},{:.6}", 0.5 * rate * rate - 2.0 * u * u + 0.1 * z);
    }
    std::fs::write(folder.path().join("pushed.csv"), text).unwrap();
    let law = "models = [\"own\"]\n[[identify.model]]\nname = \"own\"\nf_x = \"T*rate^2 - D*v_x*abs(v_x)\"";
    let campaign = written(folder.path(), "table = \"pushed.csv\"", law);
    check(&campaign);
    assert!(both(&campaign).iter().flat_map(|found| &found.findings).all(|f| f.code != "force-along-motion"));
}

#[test]
fn a_parquet_table_gives_what_the_csv_gives() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = written(folder.path(), "table = \"record.csv\"", "models = [\"linear_quadratic\"]");
    let parquet = folder.path().join("record.parquet");
    froude_records::table_file::prepare_table(&read_table(&folder.path().join("record.csv"), None).unwrap(), &parquet)
        .unwrap()
        .take_place()
        .unwrap();
    let of = |path: PathBuf| {
        let mut campaign = campaign.clone();
        campaign.sources[0].input = froude_records::campaign::Input::Table(path);
        identify_source(&campaign, &campaign.sources[0], SMALL, &|_| {}).unwrap().unwrap()
    };
    let [csv, parquet] = [of(folder.path().join("record.csv")), of(parquet)];
    assert_eq!(csv.estimates, parquet.estimates);
}

fn refused(source: &str, identify: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let campaign = written(folder.path(), source, identify);
    match identify_source(&campaign, &campaign.sources[0], SMALL, &|_| {}) {
        Err(error @ IdentifyError::Campaign { .. }) => error.to_string(),
        other => panic!("{:?}", other.map(|r| r.map(|r| r.n_read))),
    }
}

#[test]
fn what_needs_all_rows_at_once_is_refused_with_the_way_out() {
    let table = "table = \"record.csv\"";
    let said = refused(table, "covariance = \"HC3\"");
    assert!(said.contains("more than 2000000 rows") && said.contains("give fewer rows"), "{said}");
    let said = refused(table, "angle_offset = \"estimate\"");
    assert!(said.contains("angle_offset"), "{said}");
}

#[test]
fn a_table_that_weighs_its_rows_is_kept_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let is_kept = |source: &str, identify: &str| {
        let campaign = written(folder.path(), source, identify);
        identify_source(&campaign, &campaign.sources[0], SMALL, &|_| {}).unwrap().is_none()
    };
    assert!(!is_kept("table = \"record.csv\"", ""));
    let path = folder.path().join("weighted.csv");
    let of = |line: &str| format!("{line},{}\n", if line.starts_with("time") { "std_f_x [N]" } else { "0.1" });
    std::fs::write(&path, record().lines().map(of).collect::<String>()).unwrap();
    assert!(is_kept("table = \"weighted.csv\"", "models = [\"linear_quadratic\"]"));
}

#[test]
fn a_power_law_costs_its_own_row() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = written(folder.path(), "table = \"record.csv\"", "models = [\"quadratic\", \"power_law\"]");
    let result = identify_source(&campaign, &campaign.sources[0], SMALL, &|_| {}).unwrap().unwrap();
    assert_eq!(result.models.len(), 1);
    assert!(result.not_fitted[0].why.contains("not linear in its coefficients"), "{:?}", result.not_fitted);
}
