//! Pure heave: the method that CONTRIBUTING.md writes, compiled and used as one of the registry would be.

use froude_identify::declare::{IfMissing, Key, Kind, Range};
use froude_identify::method::{MethodError, Need};
use froude_records::estimate::{Law, Output};
use froude_records::run::Role;
use froude_records::units::Dimension;
use froude_tank::TankError;
use froude_tank::declared::{CYCLES, FREQUENCY, HARMONICS, PERIODS, RATE, REPEATS, STILL, amplitude, uncertain};
use froude_tank::driven::method::{Declared, MotorDriven};
use froude_tank::driven::setup::Setup;
use froude_tank::driven::source::method;
use froude_tank::driven::spec::{Channel, Coefficient, Constant, Enters, Factor, Point, Spec, Terms};
use froude_tank::method::TankMethod;
use indexmap::IndexMap;

/// A motor moves a deeply submerged body up and down, w = ż: f_z = (m − Z_ẇ) ẇ − Z_w w.
#[derive(Debug, Clone)]
pub struct Heave;

/// As it stands in the registry: needs a folder of runs of the role `test`, and takes a section of its own, a budget and a plan.
pub const HEAVED: TankMethod = method::<Heave>(
    &["heave"],
    &["heave added mass and damping"],
    &[Need::of(&["test"], &["heave", "f_z"])],
    &["heave", "uncertainty", "plan"],
);

const KEYS: &[Key] = &[
    Key::new("mass", Kind::Constant(Dimension::MASS), IfMissing::Required("write mass = \"12 kg\""), "dry mass")
        .within(Range::Positive),
    Key::new("delay", Kind::Constant(Dimension::TIME), IfMissing::Nothing("to be found"), "of the force"),
    CYCLES,
    HARMONICS,
];
const PLAN: &[Key] =
    &[amplitude(Dimension::LENGTH, "write \"50 mm\"", "of the heave"), FREQUENCY, PERIODS, STILL, RATE, REPEATS];

impl MotorDriven for Heave {
    const SPEC: Spec = Spec {
        name: "heave",
        called: "a pure heave",
        keys: KEYS,
        missing: "write [source.heave] with mass",
        plan: PLAN,
        motion: Channel {
            name: "heave",
            load: "heave",
            dimension: Dimension::LENGTH,
            unit: "m",
            shown: "mm",
            along: "the body's way down",
            column: ("z", "sensor", "", 6),
            ..Channel::GENERAL
        },
        loads: &[Channel {
            name: "f_z",
            load: "f_z",
            dimension: Dimension::FORCE,
            unit: "N",
            shown: "N",
            along: "the rig on the body, downwards",
            column: ("f_z", "body", "", 6),
            ..Channel::GENERAL
        }],
        law: "heave",
        // Z_ẇ is a load of the water on the body, and negative.
        added: ("Z_w_dot", -1.0),
        ..Spec::GENERAL
    };

    fn read(_: &Declared<'_>, _: Option<&str>) -> Result<Vec<Self>, MethodError> {
        Ok(vec![Self])
    }

    fn constants(&self, declared: &Declared<'_>) -> Result<Vec<Constant>, MethodError> {
        let of = |key: &str| declared.values.constant(key).map(uncertain);
        let gain = Constant::gain("gain of f_z", Enters::Load(0), &["f_z"]);
        Ok(vec![Constant::new("mass", of("mass"), 1.0, ""), Constant::delay(of("delay")), gain])
    }

    fn coefficients(&self) -> Vec<Coefficient> {
        let one = |name: &str, unit: &str| Coefficient {
            name: name.to_owned(),
            unit: unit.to_owned(),
            is_wanted: true,
            is_bounded: false,
            varies: (name == "Z_w").then_some(0),
            role: Role::Test,
        };
        vec![one("Z_w_dot", "kg"), one("Z_w", "N*s/m")]
    }

    fn terms(&self, _: &Point, _: &[f64], motion: &[[f64; 3]], add: &mut Terms<'_>) -> Result<(), TankError> {
        let each = |factor: f64, of: usize| motion.iter().map(|m| factor * m[of]).collect::<Vec<f64>>();
        add(0, Factor::Constant(0), &each(1.0, 2));
        add(0, Factor::Coefficient(0), &each(-1.0, 2));
        add(0, Factor::Coefficient(1), &each(-1.0, 1));
        Ok(())
    }

    fn held(&self) -> String {
        "the mass is removed".to_owned()
    }

    fn law_of_record(&self, _: &Setup<Self>) -> Law {
        let text = |text: &str| text.to_owned();
        let output = Output { unit: text("N"), formula: Some(text("Z_w_dot*v_z_dot + Z_w*v_z")) };
        Law {
            name: text("heave"),
            version: 1,
            inputs: IndexMap::from([(text("v_z"), text("m/s")), (text("v_z_dot"), text("m/s^2"))]),
            outputs: IndexMap::from([(text("f_z"), output)]),
            constants: IndexMap::new(),
        }
    }
}
// The method ends here; what follows uses it.

use froude_identify::answer::Answer;
use froude_identify::method::Method as _;
use froude_records::campaign_file::read_campaign;

/// The campaign of CONTRIBUTING.md.
const CAMPAIGN: &str = r#"schema = 1
name = "A submerged body in heave"

[[source]]
name   = "rig"
kind   = "tank"
runs   = "runs"
method = "heave"

[source.heave]
mass  = { value = "12 kg", standard = "0.02 kg" }
delay = { value = "0 ms", standard = "2 ms" }

[[source.plan]]
amplitude = "50 mm"
frequency = ["0.3 Hz", "0.4 Hz", "0.5 Hz", "0.6 Hz", "0.7 Hz"]

[simulate]
seed  = 1
model = "heave"

[simulate.coefficients]
Z_w_dot = "-9 kg"
Z_w     = "-14 N s/m"

[[simulate.sensor]]
quantity = "f_z"
noise    = "0.1 N"
"#;

#[test]
fn a_method_of_one_s_own_has_plan_twin_record_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, CAMPAIGN).unwrap();
    let campaign = read_campaign(&path).unwrap();
    let source = &campaign.sources[0];
    HEAVED.check(source).unwrap();
    let plan = HEAVED.plan(&campaign, source).unwrap().unwrap();
    assert_eq!(plan.runs, 5);
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    for file in HEAVED.simulate(&campaign, source).unwrap().unwrap() {
        std::fs::write(folder.path().join("runs").join(file.name), file.content).unwrap();
    }
    let found = HEAVED.identify(&campaign, source, &["heave"], &|_| {}).unwrap();
    let estimate = found.results.iter().flat_map(Answer::estimates).next().unwrap();
    for (name, truth) in [("Z_w_dot", -9.0), ("Z_w", -14.0)] {
        let interval = estimate.coefficients[name].interval_95.unwrap();
        assert!((interval[0]..=interval[1]).contains(&truth), "{name}: {interval:?}");
    }
    assert!(found.summary.is_some() && !found.blocks.is_empty());
    assert!(
        found.findings.iter().all(|f| f.severity < froude_records::finding::Severity::Error),
        "{:?}",
        found.findings
    );
}

/// CONTRIBUTING.md quotes the method and its campaign as they are here.
#[test]
fn contributing_quotes_the_toy_as_it_is() {
    let text = include_str!("../../../../CONTRIBUTING.md");
    let method = include_str!("toy.rs").split("\n// The method ends here").next().unwrap();
    let method = method.split_once("\n\n").unwrap().1.trim_end();
    assert!(text.contains(method) && text.contains(CAMPAIGN));
}
