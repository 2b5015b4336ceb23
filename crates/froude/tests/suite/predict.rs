//! Predictions at the verb's own function: the band covers, E_n and χ² reject as often as they say, and what the table does not have is said.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use froude::identify::prediction::{Job as Asked, Prediction, predict as answered, predicted as predict};
use froude::pipeline::{Job, identify};
use froude::report::write::write_files;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const SIGMA_N: f64 = 0.4;
/// D_I and D_II of the truth, N s/m and N s²/m².
const TRUTH: [f64; 2] = [2.0, 55.0];

/// Runs at the speeds, each so often, with noise.
fn table(path: &Path, speeds: &[f64], repeats: usize, rng: &mut Pcg64Mcg) {
    let mut text = "speed [m/s],f_x [N]\n".to_owned();
    for u in speeds {
        for _ in 0..repeats {
            let z: f64 = rng.sample(StandardNormal);
            let force = -TRUTH[0] * u - TRUTH[1] * u * u + SIGMA_N * z;
            writeln!(text, "{u},{force}").unwrap();
        }
    }
    std::fs::write(path, text).unwrap();
}

fn asked(record: PathBuf, table: PathBuf) -> Asked {
    Asked { record, table, sidecar: None, laws: Vec::new(), out: None }
}

fn fitted(folder: &Path, rng: &mut Pcg64Mcg) -> PathBuf {
    let fit = folder.join("fit.csv");
    table(&fit, &[0.2, 0.4, 0.6, 0.8, 1.0], 4, rng);
    let out = folder.join("results");
    fit_by(&fit, out, "linear_quadratic")
}

fn fit_by(fit: &Path, out: PathBuf, law: &str) -> PathBuf {
    let models = vec![law.to_owned()];
    identify(&Job { out: Some(out.clone()), models, ..Job::new(fit) }, &|_| {}).unwrap();
    out.join("estimate.json")
}

/// 300 records, each held against ten runs of its own: the error of a coefficient is in all ten of them, so that single rows may be beyond together, while χ² counts it once.
#[test]
fn one_number_over_all_rows_rejects_as_often_as_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(20_261_126);
    let (mut rejected, mut beyond, mut rows, mut outside_band) = (0, 0, 0, 0);
    let draws = 300;
    for _ in 0..draws {
        let record = fitted(folder.path(), &mut rng);
        let new = folder.path().join("new.csv");
        table(&new, &[0.3, 0.5, 0.7, 0.9, 1.0], 2, &mut rng);
        let found = predict(&asked(record, new)).unwrap();
        let predicted = &found.estimates[0];
        let joint = predicted.joint.unwrap();
        assert_eq!((joint.n, joint.dof), (10, 18.0));
        rejected += usize::from(joint.p.unwrap() < 0.05);
        for row in &predicted.rows {
            rows += 1;
            beyond += usize::from(row.e_n.unwrap().abs() > 1.0);
            let u = [0.3, 0.5, 0.7, 0.9, 1.0][row.row / 2];
            let truth = -TRUTH[0] * u - TRUTH[1] * u * u;
            outside_band += usize::from(!(row.band_95.unwrap()[0]..=row.band_95.unwrap()[1]).contains(&truth));
        }
    }
    let part = |n: usize, of: usize| n as f64 / of as f64;
    println!(
        "rejected {:.3}, beyond E_n {:.3}, outside of the band {:.3}",
        part(rejected, draws),
        part(beyond, rows),
        part(outside_band, rows)
    );
    // Three standard deviations of 300 draws at 5 %: 3.8 %; rows of one record go together.
    assert!((part(rejected, draws) - 0.05).abs() < 0.038);
    assert!((part(beyond, rows) - 0.05).abs() < 0.03 && (part(outside_band, rows) - 0.05).abs() < 0.038);
}

/// The scatter of a fit in logarithms is a part of the load, not newtons.
#[test]
fn a_law_in_logarithms_scatters_by_a_part_of_its_force() {
    let folder = tempfile::tempdir().unwrap();
    let fit = folder.path().join("fit.csv");
    table(&fit, &[0.2, 0.4, 0.6, 0.8, 1.0], 4, &mut Pcg64Mcg::seed_from_u64(3));
    let record = fit_by(&fit, folder.path().join("log"), "power_law_log");
    let found = predict(&asked(record, fit)).unwrap();
    let rows = &found.estimates[0].rows;
    let part: Vec<f64> = rows.iter().map(|row| row.scatter.unwrap() / row.predicted.abs()).collect();
    assert!(part.iter().all(|p| (p / part[0] - 1.0).abs() < 1e-12 && (0.01..0.3).contains(p)), "{part:?}");
}

/// Rows of a day err alike: of a record by days χ² has no p, and where one day decides the law there is no band either.
#[test]
fn a_record_of_clusters_has_no_p_and_no_band_where_one_cluster_decides() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for (sizes, has_band) in [([6; 6], true), ([40, 4, 4, 4, 4, 4], false)] {
        let mut text = "speed [m/s],f_x [N],day\n".to_owned();
        for (day, n) in sizes.iter().enumerate() {
            let z: f64 = rng.sample(StandardNormal);
            for i in 0..*n {
                let u = 0.2 + (f64::from(i) + 0.5) / f64::from(*n);
                let own: f64 = rng.sample(StandardNormal);
                writeln!(text, "{u},{},day {day}", -TRUTH[1] * u * u + z + 0.1 * own).unwrap();
            }
        }
        std::fs::write(place("days.csv"), text).unwrap();
        let campaign = "schema = 1\nname = \"days\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\ntable = \"days.csv\"\ngroup = \"day\"\n\
                        models = [\"quadratic\"]\n[identify]\ncovariance = \"cluster\"\n";
        std::fs::write(place("days.toml"), campaign).unwrap();
        identify(&Job { out: Some(place("days")), ..Job::new(place("days.toml")) }, &|_| {}).unwrap();
        table(&place("new.csv"), &[0.5, 0.9], 2, &mut rng);
        let found = predict(&asked(place("days").join("estimate.json"), place("new.csv"))).unwrap();
        assert!(found.estimates[0].joint.is_some() && joint_p(&found).is_none());
        let rows = &found.estimates[0].rows;
        assert!(rows.iter().all(|row| row.band_95.is_some() == has_band && row.e_n.is_some() == has_band));
        assert_eq!(found.findings.iter().any(|f| f.code == "no-band"), !has_band, "{:?}", found.findings);
    }
}

fn joint_p(found: &Prediction) -> Option<f64> {
    found.estimates[0].joint.and_then(|joint| joint.p)
}

#[test]
fn what_lies_outside_is_flagged_and_a_changed_body_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let record = fitted(folder.path(), &mut rng);
    let at = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    // A tenth more drag, and a speed beyond those that were fitted.
    let changed = at("changed.csv", "speed [m/s],f_x [N]\n0.8,-40.5\n1.0,-62.7\n1.6,-158\n");
    let found = predict(&asked(record.clone(), changed)).unwrap();
    assert!(joint_p(&found).unwrap() < 1e-6, "{found:?}");
    let rows = &found.estimates[0].rows;
    assert_eq!(rows.iter().map(|row| row.outside.len()).collect::<Vec<_>>()[..2], [0, 0]);
    assert!(rows[2].outside.contains(&"speed".to_owned()) && found.estimates[0].joint.unwrap().n == 2);
    // Without loads there are forces with their bands, and nothing is compared.
    let bare = at("bare.csv", "speed [m/s]\n0.5\n0.9\n");
    let out = folder.path().join("predicted");
    let job = Asked { out: Some(out), ..asked(record.clone(), bare) };
    let found = predict(&job).unwrap();
    assert!(joint_p(&found).is_none() && found.estimates[0].rows.iter().all(|row| row.measured.is_none()));
    let answer = answered(&job).unwrap();
    write_files(&answer).unwrap();
    let text = std::fs::read_to_string(&answer.files[0].path).unwrap();
    assert!(
        text.starts_with("line [1],speed [m/s]") && text.contains("f_x_low_95 [N]") && !text.contains("f_x_e_n"),
        "{text}"
    );
    assert_eq!(text.lines().count(), 3);
    // Its own uncertainty of each row, where the table states one.
    let stated = at("stated.csv", "speed [m/s],f_x [N],std_f_x [N]\n0.8,-36.8,10\n1.0,-57.0,10\n");
    let found = predict(&asked(record.clone(), stated)).unwrap();
    let joint = found.estimates[0].joint.unwrap();
    assert!(joint.dof.is_infinite() && joint.p.unwrap() > 0.9, "{joint:?}");
    // What the law reads and the table lacks, and a law that the record does not have.
    let lacking = at("lacking.csv", "f_x [N]\n-3\n");
    assert!(predict(&asked(record.clone(), lacking)).is_err());
    let table = at("again.csv", "speed [m/s]\n0.5\n");
    let refused = predict(&Asked { laws: vec!["f4".to_owned()], ..asked(record, table) }).unwrap_err();
    assert!(refused.to_string().contains("linear_quadratic"), "{refused}");
    assert!(froude::Error::from(refused).is_bad_input());
}

/// A source of `role = "validation"` is fitted by nothing: what was fitted is held against it, on the terminal and in the record.
#[test]
fn a_source_may_be_held_back_for_validation() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    table(&place("monday.csv"), &[0.2, 0.4, 0.6, 0.8, 1.0], 4, &mut rng);
    table(&place("tuesday.csv"), &[0.3, 0.5, 0.7, 0.9], 3, &mut rng);
    let wrong = std::fs::read_to_string(place("tuesday.csv")).unwrap();
    let wrong: Vec<String> = wrong
        .lines()
        .map(|line| match line.split_once(',').map(|(u, f)| (u, f.parse::<f64>())) {
            Some((u, Ok(f))) => format!("{u},{}", 1.3 * f),
            _ => line.to_owned(),
        })
        .collect();
    std::fs::write(place("wrong.csv"), wrong.join("\n") + "\n").unwrap();
    let source = |name: &str, role: &str| {
        format!("[[source]]\nname = \"{name}\"\nkind = \"towing\"\ntable = \"{name}.csv\"\n{role}")
    };
    let held = "role = \"validation\"\n";
    let text = format!(
        "schema = 1\nname = \"x\"\n{}{}{}",
        source("monday", ""),
        source("tuesday", held),
        source("wrong", held)
    );
    std::fs::write(place("campaign.toml"), text).unwrap();
    let found = identify(&Job { out: Some(place("results")), ..Job::new(place("campaign.toml")) }, &|_| {}).unwrap();
    assert!(found.file.estimates.iter().all(|e| e.source == "monday"), "only Monday is fitted");
    let of = |source: &str| found.file.findings.iter().find(|f| f.source.as_deref() == Some(source)).unwrap();
    assert_eq!(
        (of("tuesday").code.as_str(), of("wrong").code.as_str()),
        ("validation", "validation-fails"),
        "{:?}",
        of("tuesday")
    );
    assert!(of("tuesday").message.contains("|E_n| > 1 in 0 of 12 rows"), "{}", of("tuesday").message);
    let html = std::fs::read_to_string(place("results/report.html")).unwrap();
    assert!(html.contains("tuesday: Predicted by monday/"), "the report has the rows that were predicted worst");

    let alone = format!("schema = 1\nname = \"x\"\n{}", source("tuesday", held));
    std::fs::write(place("alone.toml"), alone).unwrap();
    let error = identify(&Job::new(place("alone.toml")), &|_| {}).unwrap_err().to_string();
    assert!(error.contains("no other source of the campaign gave an estimate"), "{error}");
}

/// One row states a standard deviation a hundred times too small: it decides the fit, which a finding says, and new rows still scatter as the others do.
#[test]
fn a_row_that_dominates_is_named_and_new_rows_scatter_as_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut rows = |speeds: &[f64], first_std: Option<f64>| {
        let head = if first_std.is_some() { "speed [m/s],f_x [N],std_f_x [N]\n" } else { "speed [m/s],f_x [N]\n" };
        let mut text = head.to_owned();
        for (i, u) in speeds.iter().enumerate() {
            let z: f64 = rng.sample(StandardNormal);
            write!(text, "{u},{}", -3.0 * u * u + 0.6 * z).unwrap();
            if let Some(first) = first_std {
                write!(text, ",{}", if i == 0 { first } else { 0.6 }).unwrap();
            }
            text.push('\n');
        }
        text
    };
    let of = |n: u32| (0..n).map(|i| 0.6 + 0.9 * f64::from(i) / f64::from(n - 1)).collect::<Vec<f64>>();
    let [fit, new] = [("fit.csv", rows(&of(12), Some(0.006))), ("new.csv", rows(&of(30), None))].map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    });
    let out = folder.path().join("results");
    let models = vec!["quadratic".to_owned()];
    let found = identify(&Job { out: Some(out.clone()), models, ..Job::new(&fit) }, &|_| {}).unwrap();
    let said = found.file.findings.iter().find(|f| f.code == "one-row-dominates").unwrap();
    assert!(said.message.contains("(std_f_x 0.006") && said.message.contains("leverage 98"), "{}", said.message);
    let estimate = &found.file.estimates[0];
    let sigma = estimate.sigma["f_x"].value;
    // 0.6 N, and what the others lie beside a law that follows one wrong row; that of a row of mean weight is 0.01 N.
    assert!((0.3..2.4).contains(&sigma), "{sigma}");
    assert!(estimate.diagnostics.relative_residual["f_x"] > 0.05, "{:?}", estimate.diagnostics.relative_residual);
    let found = predict(&asked(out.join("estimate.json"), new)).unwrap();
    let beyond = found.estimates[0].rows.iter().filter(|row| row.e_n.unwrap().abs() > 1.0).count();
    assert!(beyond <= 5, "{beyond} of 30");
}

/// A power law of f_x alone is left beside the law of three loads; its χ² says nothing of the side force, and does not stand for it.
#[test]
fn a_law_of_fewer_loads_hides_no_wrong_load() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    let mut rows = |shift_n: f64| {
        let mut text = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
        for speed in [0.5_f64, 0.8, 1.1, 1.4] {
            for angle in [-12.0_f64, -6.0, 0.0, 6.0, 12.0] {
                let (sin, cos) = angle.to_radians().sin_cos();
                let (u, v) = (speed * cos, -speed * sin);
                let [a, b]: [f64; 2] = [rng.sample(StandardNormal), rng.sample(StandardNormal)];
                let side = -28.0 * u * v - 115.0 * v * v.abs() + shift_n + 0.1 * b;
                writeln!(text, "{speed},{angle},{},{side}", -4.2 * u * u + 0.05 * a).unwrap();
            }
        }
        text
    };
    let [fit, new] = [("fit.csv", rows(0.0)), ("new.csv", rows(1.0))].map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    });
    let out = folder.path().join("results");
    let found = identify(&Job { out: Some(out.clone()), ..Job::new(&fit) }, &|_| {}).unwrap();
    let left = &found.file.estimates.iter().find(|e| e.recommended).unwrap().not_contradicted;
    assert!(left.iter().any(|id| id.ends_with("power_law_x")), "{left:?}");
    let found = predict(&asked(out.join("estimate.json"), new)).unwrap();
    assert!(found.estimates[0].joint.unwrap().p.unwrap() < 1e-6, "{:?}", found.estimates[0].joint);
}
