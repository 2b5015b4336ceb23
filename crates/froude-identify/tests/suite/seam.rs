//! Every fit to rows passes through one function: what a method states about weights and scatter is what its record states.

use froude_fit::replicates::Replicates;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::regression::{Scatter, Weight};
use froude_identify::seam::{Choice, Derived, Reduced, Stated, fit};
use froude_identify::source::SourceResult;
use froude_records::campaign::{Identify, SourceKind};
use froude_records::estimate::Measured;
use froude_records::units::Dimension;
use indexmap::IndexMap;

const RUNS: usize = 6;
const SPEEDS: [f64; 3] = [0.2, 0.5, 0.9];

/// Load of a run at a speed, N: 3 v + 8 v², off by a part that the whole run shares and one that its rows do not.
fn load(run: usize, speed: f64) -> f64 {
    let shared = [0.04, -0.02, 0.05, -0.06, 0.01, 0.03][run];
    -(3.0 * speed + 8.0 * speed * speed) * (1.0 + shared) + 0.02 * (40.0 * speed + run as f64).sin()
}

fn rows() -> impl Iterator<Item = (usize, f64)> {
    (0..RUNS).flat_map(|run| SPEEDS.map(|speed| (run, speed)))
}

fn data() -> Dataset {
    let of = |value: &dyn Fn(usize, f64) -> f64| rows().map(|(run, speed)| value(run, speed)).collect::<Vec<f64>>();
    let n = rows().count();
    let mut data = Dataset {
        rows: n,
        configuration: vec![String::new(); n].into(),
        setup: vec![String::new(); n].into(),
        run: rows().map(|(run, _)| run.to_string()).collect(),
        group: Some(rows().map(|(run, _)| run.to_string()).collect()),
        line: (1..=n).collect(),
        ..Dataset::default()
    };
    data.put("v_x", of(&|_, speed| speed), Dimension::SPEED);
    data.put("f_x", of(&load), Dimension::FORCE);
    data.put("std_f_x", of(&|run, _| 0.1 + run as f64), Dimension::FORCE);
    data
}

/// D_I and D_II without a run, by the normal equations.
fn without(skip: Option<usize>) -> Vec<f64> {
    let (mut a, mut b, mut c, mut d, mut e) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (run, v) in rows().filter(|(run, _)| Some(*run) != skip) {
        let (x, y, f) = (v, v * v, -load(run, v));
        (a, b, c, d, e) = (a + x * x, b + x * y, c + y * y, d + x * f, e + y * f);
    }
    let determinant = a * c - b * b;
    vec![(c * d - b * e) / determinant, (a * e - b * d) / determinant]
}

fn fitted(weight: Weight, scatter: Scatter) -> SourceResult {
    let data = data();
    let texts = IndexMap::from([("f_x".to_owned(), "-D_I*v_x - D_II*v_x*abs(v_x)".to_owned())]);
    let law = ForceLaw::formulas("law", &texts, &data).unwrap();
    let derived = Derived {
        name: "C_D".to_owned(),
        formula: "2*D_II/(1000*area)".to_owned(),
        of: "D_II".to_owned(),
        factor: 0.004,
        factor_relative: 0.0,
        unit: "1".to_owned(),
    };
    let mut reduced = Reduced {
        choice: Choice::Method("a method of its own".to_owned()),
        weight,
        scatter,
        looks: 2,
        ..Reduced::new("tank", SourceKind::Towing, "own", data, vec![law])
    };
    reduced.stated = Stated {
        refers_to: IndexMap::from([("area".to_owned(), Measured::of(0.5, "m^2"))]),
        labels: IndexMap::from([("D_II".to_owned(), "D_d".to_owned())]),
        derived: vec![derived],
        ..reduced.stated
    };
    fit(reduced, &Identify::default(), &|_| {}).unwrap()
}

fn by_runs(sets: Vec<Replicates>) -> Scatter {
    Scatter::Replicates { name: "scatter between runs".to_owned(), sets }
}

/// Leaving the runs out by hand is the cluster covariance of the same rows, which takes the changes about the whole: less (G − 1) times the square
/// of the distance between the mean of the replicates and the whole (Efron & Stein).
#[test]
fn replicates_by_hand_are_clusters_about_their_own_mean() {
    let set = Replicates::leaving_out("run", RUNS, |run| Some(without(Some(run)))).unwrap();
    let own = fitted(Weight::One, by_runs(vec![set.clone()]));
    let clustered = fitted(Weight::One, Scatter::Cluster);
    let [own, clustered] = [&own, &clustered].map(|result| result.estimates[0].type_a.clone().unwrap());
    let whole = without(None);
    let off = |j: usize| set.without.iter().map(|w| w[j]).sum::<f64>() / RUNS as f64 - whole[j];
    for (j, k) in [(0, 0), (0, 1), (1, 1)] {
        let expected = clustered.matrix[j][k] - (RUNS - 1) as f64 * off(j) * off(k);
        assert!((own.matrix[j][k] / expected - 1.0).abs() < 1e-9, "{j} {k}: {} {expected}", own.matrix[j][k]);
    }
    assert_eq!((own.dof, own.kind.as_str()), (vec![Some(5.0); 2], "scatter between runs"));
}

#[test]
fn a_method_has_its_own_names_and_the_common_numbers() {
    let set = Replicates::leaving_out("run", RUNS, |run| Some(without(Some(run)))).unwrap();
    let result = fitted(Weight::One, by_runs(vec![set]));
    let estimate = &result.estimates[0];
    let clusters = estimate.clusters.as_ref().unwrap();
    assert_eq!((estimate.id.as_str(), clusters.by.as_str(), clusters.n), ("tank/own", "run", RUNS));
    assert_eq!((estimate.dof["f_x"], estimate.sigma.len(), estimate.interval.looks), (Some(5.0), 0, 2));
    assert_eq!((estimate.recommended, result.recommendation.unwrap().reason.as_str()), (false, "a method of its own"));
    let (d, c) = (&estimate.coefficients["D_II"], &estimate.derived["C_D"]);
    assert_eq!((d.label.as_deref(), estimate.refers_to["area"].value), (Some("D_d"), 0.5));
    assert_eq!(c.interval_95, d.interval_95.map(|ends| ends.map(|end| 0.004 * end)));
    // Two looks: the interval holds 97.5 %; Student's t of 5 degrees of freedom there is 3.163.
    let half = d.interval_95.unwrap()[1] - d.value.unwrap();
    assert!((half / d.standard_uncertainty.unwrap() - 3.163).abs() < 1e-3);
}

#[test]
fn weights_are_what_the_method_says() {
    let of = |weight| fitted(weight, Scatter::Classical).models[0].coefficients.clone();
    let (alike, weighted) = (of(Weight::One), of(Weight::Std));
    for (found, expected) in alike.iter().zip(without(None)) {
        assert!((found - expected).abs() < 1e-9);
    }
    // The first run alone counts for nearly all: its shared part is 4 % of both.
    assert!((weighted[1] - alike[1]).abs() > 0.1, "{weighted:?} {alike:?}");
}

#[test]
fn where_no_replicate_tells_the_scatter_the_value_has_no_interval() {
    let result = fitted(Weight::One, by_runs(Vec::new()));
    let estimate = &result.estimates[0];
    let d = &estimate.coefficients["D_II"];
    assert!(d.value.is_some() && d.interval_95.is_none() && d.standard_uncertainty.is_none());
    assert!(estimate.type_a.is_none() && estimate.errors.is_empty() && estimate.clusters.is_none());
    assert_eq!(result.models[0].covariance[(1, 1)], 0.0);
    // Replicates of another law are no scatter of this one.
    let other = Replicates { left_out: "run", without: vec![vec![1.0], vec![2.0]], floor: None };
    assert!(fitted(Weight::One, by_runs(vec![other])).estimates[0].type_a.is_none());
}
