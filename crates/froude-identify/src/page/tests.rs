use froude_records::campaign::Campaign;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::error_models::error_models;
use super::selection::rows;
use crate::result::SourceResult;
use crate::source::identify_source;

/// Every model of a bare table.
fn identified(name: &str, table: &str, models: &[&str]) -> SourceResult {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{name}.csv"));
    std::fs::write(&path, table).unwrap();
    let mut campaign = Campaign::of_table(&path, None);
    campaign.identify.models = models.iter().map(|m| (*m).to_owned()).collect();
    identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap()
}

/// Unit noise from a seed of its own.
fn noise(seed: u128) -> impl FnMut() -> f64 {
    let mut rng = Pcg64::new(seed, 0);
    move || StandardNormal.sample(&mut rng)
}

/// F = 20 U^1.8 at 40 speeds, with errors of the size that `size` gives for a force.
fn power_law_table(seed: u128, size: impl Fn(f64) -> f64) -> String {
    let mut noise = noise(seed);
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for i in 1..=40 {
        let speed = 0.05 * f64::from(i);
        let force = 20.0 * speed.powf(1.8);
        out += &format!("{speed},{}\n", -force + size(force) * noise());
    }
    out
}

const SEED: u128 = 7;

#[test]
fn the_error_model_that_made_the_data_is_the_one_that_the_method_names() {
    let models = ["power_law", "power_law_log"];
    let relative = identified("relative", &power_law_table(SEED, |f| 0.05 * f), &models);
    let absolute = identified("absolute", &power_law_table(SEED, |_| 0.02), &models);
    let said = |source: &SourceResult| error_models(source).concat();
    assert!(
        said(&relative).starts_with(
            "relative.csv, f_x: power_law_log is fitted to logarithms and assumes every point to have the same relative error, \
             power_law is fitted in N and assumes every point to have the same absolute error; \
             the residuals support the same relative error ("
        ),
        "{}",
        said(&relative)
    );
    assert!(said(&absolute).contains("the residuals support the same absolute error ("), "{}", said(&absolute));
    let alone = identified("alone", &power_law_table(SEED, |f| 0.05 * f), &["power_law_log"]);
    assert!(said(&alone).ends_with("no law was fitted in N to compare it with."), "{}", said(&alone));
    let none = identified("none", &power_law_table(SEED, |f| 0.05 * f), &["power_law"]);
    assert_eq!(said(&none), "");
}

/// A power law of f_x alone has an AICc far below that of a law of two loads: it sums over fewer observations.
#[test]
fn aicc_is_compared_load_by_load() {
    let mut noise = noise(SEED);
    let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for i in 1..=30 {
        let (speed, angle) = (0.1 * f64::from(i), 5.0 * f64::from(i % 6 + 1));
        let (u, w) = (speed * angle.to_radians().cos(), speed * angle.to_radians().sin());
        table += &format!("{speed},{angle},{},{}\n", -5.0 * u * u + 0.01 * noise(), 90.0 * w * w + 5.0 * noise());
    }
    let source = identified("two loads", &table, &["quadratic", "linear_quadratic", "power_law"]);
    let names: Vec<&str> = source.models.iter().map(|m| m.law.name.as_str()).collect();
    assert_eq!(names, ["quadratic", "linear_quadratic", "power_law_x", "power_law_y"]);
    let aicc = |i: usize| source.estimates[i].diagnostics.aicc.unwrap();
    assert!(aicc(2) < aicc(0).min(aicc(1)), "the trap is not there: {} {} {}", aicc(0), aicc(1), aicc(2));
    let chosen = source.recommendation.as_ref().unwrap();
    assert_eq!(chosen.index, 0, "of the laws of both loads the simplest: {}", chosen.reason);
    assert_eq!(chosen.not_contradicted, [0, 1, 2, 3], "{}", chosen.reason);
    let rows = rows(&source);
    for load in ["f_x", "f_y"] {
        let behind: Vec<f64> =
            rows.iter().filter(|r| r.component == load).map(|r| *r.delta_aicc.as_ref().unwrap()).collect();
        assert_eq!(behind.len(), 3, "the power law of the other axis is not asked about {load}");
        assert_eq!(behind.iter().copied().fold(f64::INFINITY, f64::min), 0.0, "{behind:?}");
        // All three can follow the data: none lies far behind in its own load.
        assert!(behind.iter().all(|d| *d < 6.0), "{behind:?}");
    }
}
