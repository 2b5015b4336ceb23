//! Which runs are of one motion, and which are not.

use froude_records::units::Dimension;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::*;

/// A run of 20 s at 20 Hz: forward speed m/s, amplitude m/s and frequency Hz of its sway, how late its log begins, s.
type Run = [f64; 4];

/// Noise of every velocity, m/s.
const NOISE: f64 = 0.002;

fn logged(runs: &[Run], noise: f64) -> Dataset {
    let mut rng = Pcg64::new(5, 0);
    let mut normal = || -> f64 { noise * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
    let mut data = Dataset::default();
    let (mut time, mut u, mut v, mut group) = (vec![], vec![], vec![], vec![]);
    for (k, [speed, amplitude, hertz, late_s]) in runs.iter().enumerate() {
        for i in 0..400 {
            let t = 0.05 * f64::from(i);
            time.push(100.0 * k as f64 + t + 0.1 * normal());
            u.push(speed + normal());
            v.push(amplitude * (std::f64::consts::TAU * hertz * (t + late_s)).sin() + normal());
            group.push(format!("run {k}"));
        }
    }
    data.rows = time.len();
    data.configuration = vec![String::new(); data.rows].into();
    data.put("time", time, Dimension::ONE);
    data.put("v_x", u, Dimension::SPEED);
    data.put("v_y", v, Dimension::SPEED);
    data.group = Some(group.into());
    data
}

/// Each run of several twice, the second after all others.
fn twice(runs: &[Run]) -> Vec<Run> {
    [runs, runs].concat()
}

fn motions(data: &Dataset) -> usize {
    let mut of = Motions::default();
    of.span(data);
    of.probe(data);
    of.clusters(&[]).map_or(crate::dataset::distinct(data.group.as_ref().unwrap()).len(), |clusters| count(&clusters))
}

#[test]
fn runs_of_one_motion_are_one_cluster() {
    // The last begins a quarter of a period later.
    let late = [1.0, 0.2, 0.1, 2.5];
    let mut data =
        logged(&[[1.0, 0.2, 0.1, 0.0], [1.0, 0.3, 0.1, 0.0], [1.0, 0.2, 0.1, 0.03], [1.0, 0.3, 0.1, 0.0], late], NOISE);
    let said = merge(&mut data, &[]).unwrap();
    assert_eq!(crate::dataset::distinct(data.group.as_ref().unwrap()), ["run 0", "run 1", "run 4"]);
    assert!(
        said.message
            .starts_with("2 of the 5 groups in time repeat the motion of another (\"run 2\" that of \"run 0\")"),
        "{}",
        said.message
    );
    assert_eq!((data.grouped_by, said.severity), (GroupedBy::Motion, Severity::Note));
}

#[test]
fn too_few_motions_stay_groups_with_a_warning() {
    let mut data = logged(&twice(&[[1.0, 0.2, 0.1, 0.0]; 3]), NOISE);
    let said = merge(&mut data, &[]).unwrap();
    assert_eq!((data.grouped_by, said.severity), (GroupedBy::Column, Severity::Warning));
    assert!(said.message.contains("1 motion is too few for clusters"), "{}", said.message);
}

/// Small sways at a large speed, a sweep of amplitudes near to each other, and amplitudes a factor apart beside large ones.
#[test]
fn motions_that_differ_are_not_merged() {
    let at_3: Vec<Run> = (0..7).map(|k| [3.0, 0.02 + 0.01 * f64::from(k), 0.2, 0.0]).collect();
    let sweep: Vec<Run> = (0..6).map(|k| [1.0, 0.2 + 0.04 * f64::from(k), 0.2, 0.0]).collect();
    let apart: Vec<Run> = [0.01, 0.02, 0.03, 0.2, 0.3, 0.4].map(|a| [1.0, a, 0.2, 0.0]).to_vec();
    let periods: Vec<Run> = [0.1, 0.15, 0.2, 0.25].map(|hertz| [1.0, 0.2, hertz, 0.0]).to_vec();
    let ahead: Vec<Run> = [0.5, 0.6, 0.7].map(|u| [u, 0.2, 0.2, 0.0]).to_vec();
    for of in [at_3, sweep, apart, periods, ahead] {
        assert_eq!(motions(&logged(&of, NOISE)), of.len(), "{of:?}");
        assert_eq!(motions(&logged(&twice(&of), NOISE)), of.len(), "{of:?}, twice");
    }
}

#[test]
fn noise_hides_no_repeats() {
    let runs: Vec<Run> = [0.2, 0.3, 0.4].map(|a| [1.0, a, 0.2, 0.0]).to_vec();
    let mut data = logged(&twice(&runs), 0.02);
    let noise = logged(&twice(&[[0.0; 4]; 3]), 0.001);
    data.put("w_z", noise.values("v_x").unwrap().to_vec(), Dimension::ANGULAR_SPEED);
    assert_eq!(motions(&data), 3);
}

/// Tows at constant speed, means, other bodies, and rows that do not follow each other.
#[test]
fn what_is_no_motion_is_not_merged() {
    let steady = twice(&[0.5, 0.6, 0.7, 0.8].map(|u| [u, 0.0, 0.1, 0.0]));
    assert_eq!(motions(&logged(&steady, NOISE)), 8);
    let alike = twice(&[0.2, 0.3, 0.4].map(|a| [1.0, a, 0.2, 0.0]));
    let all = logged(&alike, NOISE);
    assert_eq!(motions(&all), 3);
    let mut means = all.clone();
    means.channels.shift_remove("time");
    assert_eq!(motions(&means), 6);
    let mut bodies = all.clone();
    bodies.configuration = (0..all.rows).map(|i| format!("H{}LT", i / 400)).collect();
    assert_eq!(motions(&bodies), 6);
    let back: Vec<usize> = (0..all.rows).rev().collect();
    assert_eq!(motions(&all.subset(&back)), 6);
    // One that was broken off stays by itself.
    let broken: Vec<usize> = (0..all.rows).filter(|i| *i < 2_000 || *i >= 2_360).collect();
    assert_eq!(motions(&all.subset(&broken)), 4);
}

#[test]
fn a_channel_of_the_law_that_differs_keeps_motions_apart() {
    let campaign = "schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\n[[identify.model]]\nname = \"ship\"\nf_x = \"-X_uu*v_x*abs(v_x) + T*rate*rate\"\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), "v_x [m/s],rate [1/s],f_x [N]\n1,2,3\n").unwrap();
    std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
    let campaign = froude_records::campaign_file::read_campaign(&folder.path().join("c.toml")).unwrap();
    let mut data = logged(&twice(&[0.2, 0.3, 0.4].map(|a| [1.0, a, 0.2, 0.0])), NOISE);
    let rate = (0..data.rows).map(|i| 4.0 + (i / 400) as f64).collect();
    data.put("rate", rate, Dimension::ANGULAR_SPEED);
    data.put("f_x", vec![1.0; data.rows], Dimension::FORCE);
    let laws = crate::source::laws(&campaign, &campaign.sources[0], &data).unwrap();
    let mut of = Motions::default();
    of.span(&data);
    of.probe(&data);
    assert!(of.clusters(&laws).is_none());
    assert_eq!(count(&of.clusters(&[]).unwrap()), 3);
}
