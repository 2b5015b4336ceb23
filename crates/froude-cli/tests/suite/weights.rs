//! The weight-driven rig at the verbs: plan, simulate and identify of the example campaign, and what is refused.

use crate::tank::{example, froude, is_as_planned, json, refused, said, simulated};

const EXAMPLE: &str = "mamba-weights";
/// The arguments of what is refused.
const IDENTIFY: &[&str] = &["identify", "campaign.toml"];

const FEW: (&str, &str) = ("step = \"3 deg\"", "step = \"12 deg\"");
const HEAVY: (&str, &str) = ("moving_mass = { value", "# moving_mass = { value");

#[test]
fn a_campaign_is_planned_simulated_and_identified() {
    let folder = example(EXAMPLE, &[]);
    let plan = json(&froude(folder.path(), &["plan", "campaign.toml", "--json"]));
    assert_eq!(plan["sources"][0]["runs"].as_u64(), Some(78));
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "towing rig: 78 runs in runs");
    let record = json(&froude(folder.path(), &["identify", "campaign.toml", "--json"]));
    let f4 = &record["estimates"][0];
    assert_eq!(f4["method"]["name"].as_str(), Some("weight_tow"));
    // χ with 68 degrees of freedom has a standard deviation of a twelfth; what all runs share is no scatter.
    is_as_planned(&plan, f4, 0.7..1.35);
    let errors: Vec<&String> = f4["errors"].as_object().unwrap().keys().collect();
    for shared in ["scale of the picture", "moving mass", "friction of the rig", "law of the drag in the balance"] {
        assert!(errors.iter().any(|key| key.contains(shared)), "{shared}: {errors:?}");
    }
    let report = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    assert!(report.contains("Tracks") && report.contains("Spectrum of the residuals"));
}

/// Four kilograms do not become steady in 0.8 m: without their mass such runs are refused, with it they are balanced.
#[test]
fn runs_that_are_not_steady_need_the_moving_mass() {
    let folder = simulated(EXAMPLE, &[FEW]);
    let text = String::from_utf8_lossy(&froude(folder.path(), &["identify", "campaign.toml"]).stdout).into_owned();
    assert!(text.contains("[not-steady]") && text.contains("inertia"), "{text}");
    let without = simulated(EXAMPLE, &[FEW, HEAVY, ("\"35 mN\", \"75 mN\", \"125 mN\"", "\"125 mN\"")]);
    let output = froude(without.path(), &["identify", "campaign.toml"]);
    let all = format!("{}{}", String::from_utf8_lossy(&output.stdout), said(&output));
    assert!(all.contains("not steady: the speed changes by") && all.contains("declare moving_mass"), "{all}");
}

#[test]
fn a_run_that_has_hardly_begun_is_refused() {
    let folder = simulated(
        EXAMPLE,
        &[FEW, ("travel = \"0.8 m\"", "travel = \"0.25 m\""), ("window      = \"0.2 m\"", "window      = \"0.1 m\"")],
    );
    let text = String::from_utf8_lossy(&froude(folder.path(), &["identify", "campaign.toml"]).stdout).into_owned();
    let error = said(&froude(folder.path(), &["identify", "campaign.toml"]));
    assert!(
        text.contains("of its terminal speed is reached") || error.contains("of its terminal speed is reached"),
        "{text}{error}"
    );
}

#[test]
fn what_a_run_lacks_is_said_with_its_place() {
    let folder = simulated(EXAMPLE, &[FEW]);
    let sidecar = folder.path().join("runs/001.toml");
    let original = std::fs::read_to_string(&sidecar).unwrap();
    std::fs::write(&sidecar, original.replace("weight = \"0.035 N\"\n", "")).unwrap();
    let text = refused(folder.path(), IDENTIFY);
    assert!(
        text.contains("001.csv: the weight that pulls is not stated") && text.contains("[conditions] weight"),
        "{text}"
    );
    std::fs::write(
        &sidecar,
        original.replace("name = \"mark\", unit = \"1\", sign = 1", "name = \"mark\", unit = \"1\""),
    )
    .unwrap();
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("001.toml:") && text.contains("mark states no sign"), "{text}");
    std::fs::write(&sidecar, &original).unwrap();
    let campaign = folder.path().join("campaign.toml");
    let declared = std::fs::read_to_string(&campaign).unwrap();
    std::fs::write(&campaign, declared.replace("scale       = {", "# scale = {")).unwrap();
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("its mark is in pixels") && text.contains("scale = { value = \"1.2 mm\""), "{text}");
    std::fs::write(&campaign, declared.replace("value = \"10 mN\", standard = \"1 mN\"", "value = \"500 mN\""))
        .unwrap();
    let text = refused(folder.path(), IDENTIFY);
    assert!(text.contains("is not above the friction of 0.5000 N"), "{text}");
}
