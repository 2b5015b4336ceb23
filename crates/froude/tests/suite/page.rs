//! What the page of a drift test draws.

use froude::identify::answer::Answer;
use froude::identify::page::section;
use froude::identify::source::identify_source;
use froude::records::campaign::Campaign;
use froude::report::Against;
use froude::report::Report;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Six speeds at nine angles, each run twice; no speed is measured twice as the same number.
#[test]
fn a_drift_test_has_a_line_for_every_speed() {
    let mut rng = Pcg64::new(7, 0);
    let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for speed in [0.3, 0.5, 0.7, 0.9, 1.1, 1.3] {
        for i in -4..=4 {
            for _ in 0..2 {
                let (u, angle) = (speed * (1.0 + 0.003 * noise()), 5.0 * f64::from(i) + 0.05 * noise());
                let (x, y) = (u * angle.to_radians().cos(), -u * angle.to_radians().sin());
                table += &format!(
                    "{u},{angle},{},{}\n",
                    -5.0 * x * x + 0.01 * noise(),
                    -90.0 * y * y.abs() + 0.01 * noise()
                );
            }
        }
    }
    // A speed that was run straight ahead only: no line against angle, but its points.
    table += "1.7,0,-14.45,0.0\n1.7,0,-14.46,0.01\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drift.csv");
    std::fs::write(&path, table).unwrap();
    let mut campaign = Campaign::of_table(&path, None);
    campaign.identify.models = vec!["quadratic".to_owned()];
    let source = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
    let section = section(&Answer::from(source)).unwrap();
    let speeds: Vec<f64> = section
        .curves
        .iter()
        .filter(|c| c.component == "f_y")
        .filter_map(|c| match c.against {
            Against::Angle { speed_m_s } => Some(speed_m_s),
            _ => None,
        })
        .collect();
    assert_eq!(speeds.len(), 6, "{speeds:?}");
    for (found, run) in speeds.iter().zip([0.3, 0.5, 0.7, 0.9, 1.1, 1.3]) {
        assert!((found / run - 1.0).abs() < 0.005, "{found} for {run}");
    }
    let report = Report { sources: vec![section], ..Report::default() };
    let figures = froude::report::figures(&report);
    let drift = figures.iter().find(|f| f.title.ends_with("f_y against angle")).unwrap();
    assert!(!drift.caption.contains("not drawn"), "{}", drift.caption);
    assert!(drift.svg.contains("other speeds"), "the points at 1.7 m/s");
}
