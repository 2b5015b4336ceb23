//! A body that hangs in a stream: the method that CONTRIBUTING.md writes, compiled and used as one of the registry would be.

use froude_identify::declare::{IfMissing, Key, Kind, Range};
use froude_identify::method::MethodError;
use froude_records::block::Digits;
use froude_records::units::Dimension;
use froude_tank::TankError;
use froude_tank::channel::Channel;
use froude_tank::declared::{REPEATS, uncertain};
use froude_tank::method::TankMethod;
use froude_tank::observed::method::{Declared, Observed};
use froude_tank::observed::rig::{Loads, Rig, Trace};
use froude_tank::observed::source::{NEEDS, method};
use froude_tank::observed::spec::{Condition, Constant, Point, Run, Spec, Unstated};
use froude_tank::steady::point::{Load, Point as Observation};

/// A body of submerged weight W hangs on a thin wire in a stream of speed U. Its drag tilts the wire by θ: f_x = −W tan θ.
#[derive(Debug, Clone)]
pub struct Hanging {
    weight: Constant,
}

/// As it stands in the registry: its name, what it does, what runs it needs, and what a source of it takes.
pub const HANGING: TankMethod = method::<Hanging>(
    &["hanging"],
    &["drag of a body that hangs in a stream, by the tilt of its wire"],
    NEEDS,
    &["hanging", "models", "uncertainty", "plan"],
);

const KEYS: &[Key] = &[Key::new(
    "weight",
    Kind::Constant(Dimension::FORCE),
    IfMissing::Required("write weight = { value = \"2 N\", standard = \"5 mN\" }"),
    "weight of the body in water",
)
.within(Range::Positive)];
const PLAN: &[Key] = &[
    Key::new(
        "speed",
        Kind::Axis(Dimension::SPEED),
        IfMissing::Required("write \"0.2 m/s\" or a list"),
        "of the stream",
    )
    .within(Range::Positive),
    REPEATS,
];

impl Observed for Hanging {
    const SPEC: Spec = Spec {
        name: "hanging",
        called: "a hanging body",
        keys: KEYS,
        missing: "write [source.hanging] with weight",
        plan: PLAN,
        reads: "time and tilt",
        conditions: &[Condition {
            name: "speed",
            dimension: Dimension::SPEED,
            column: ["speed_m_s", "speed [m/s]"],
            digits: Digits::Significant(3),
            otherwise: Unstated::Refused("write [conditions] speed = \"0.2 m/s\", that of the stream, in its sidecar"),
        }],
        channels: &[Channel {
            name: "tilt",
            along: "the wire's lower end downstream",
            column: ("tilt", "sensor", "", 6),
            ..Channel::GENERAL
        }],
        senses: &[("tilt", true)],
        ..Spec::GENERAL
    };

    type Found = ();

    fn read(declared: &Declared<'_>) -> Result<Self, MethodError> {
        let known = declared.values.constant("weight").map(uncertain);
        Ok(Self { weight: Constant { name: "weight in water", known, otherwise: 0.0 } })
    }

    fn constants(&self) -> Vec<Constant> {
        vec![self.weight.clone()]
    }

    fn reduce(&self, run: &Run<'_>, constants: &[f64]) -> Result<(Observation, ()), TankError> {
        let tilt = run.channel("tilt");
        if tilt.is_empty() {
            return Err(run.refused("no sample of the tilt"));
        }
        let mean = tilt.iter().sum::<f64>() / tilt.len() as f64;
        let drag = Load::stated("f_x", -constants[0] * mean.tan());
        Ok((Observation::stated(run.point.condition("speed"), vec![drag], 0..tilt.len()), ()))
    }

    fn speed(&self, run: &Point, _: &Loads<'_>) -> Result<f64, String> {
        Ok(run.condition("speed"))
    }

    fn twin(&self, _: &Point, rig: &mut Rig<'_>) -> Trace {
        // A log states the speed `stretch` times too large.
        let drag_n = -rig.loads.of("f_x", rig.speed_m_s / rig.stretch);
        let time_s: Vec<f64> = (0..600).map(|i| 0.05 * f64::from(i)).collect();
        let tilt = vec![(drag_n / rig.constants[0]).atan(); time_s.len()];
        rig.log(time_s, &[("tilt", tilt)])
    }
}
// The method ends here; what follows uses it.

use froude_identify::answer::Answer;
use froude_identify::method::Method as _;
use froude_records::campaign_file::read_campaign;
use froude_records::finding::Severity;
use froude_tank::observed::plan::{exact, expected};
use froude_tank::observed::twin::Twin;

/// The campaign of CONTRIBUTING.md.
const CAMPAIGN: &str = r#"schema = 1
name = "A body that hangs in a stream"

[fluid]
density = "998 kg/m^3"

[[source]]
name   = "channel"
kind   = "tank"
runs   = "runs"
method = "hanging"
models = ["quadratic"]

[source.hanging]
weight = { value = "2 N", standard = "10 mN" }

[[source.plan]]
speed   = ["0.1 m/s", "0.2 m/s", "0.3 m/s", "0.4 m/s"]
repeats = 3

[simulate]
seed  = 1
model = "quadratic"

[simulate.coefficients]
D_x_II = "6 kg/m"

[[simulate.sensor]]
quantity    = "tilt"
noise       = "0.5 deg"
correlation = "0.2 s"
"#;

/// Writes the campaign and the twin's runs with this seed; its path.
fn written(folder: &std::path::Path, seed: u64) -> std::path::PathBuf {
    let path = folder.join("campaign.toml");
    std::fs::write(&path, CAMPAIGN.replace("seed  = 1", &format!("seed  = {seed}"))).unwrap();
    let campaign = read_campaign(&path).unwrap();
    std::fs::create_dir_all(folder.join("runs")).unwrap();
    for file in HANGING.simulate(&campaign, &campaign.sources[0]).unwrap().unwrap() {
        std::fs::write(folder.join("runs").join(file.name), file.content).unwrap();
    }
    path
}

/// Value, standard uncertainty and interval of the coefficient, of the twin with this seed.
fn fitted(seed: u64) -> (f64, f64, [f64; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let campaign = read_campaign(&written(folder.path(), seed)).unwrap();
    let found = HANGING.identify(&campaign, &campaign.sources[0], &["hanging"], &|_| {}).unwrap();
    assert!(
        found.blocks.len() == 1 && found.findings.iter().all(|f| f.severity < Severity::Error),
        "{:?}",
        found.findings
    );
    let estimate = found.results.iter().flat_map(Answer::estimates).next().unwrap();
    let d = &estimate.coefficients["D_x_II"];
    (d.value.unwrap(), d.standard_uncertainty.unwrap(), d.interval_95.unwrap())
}

#[test]
fn a_method_of_single_observations_has_plan_twin_record_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = read_campaign(&written(folder.path(), 1)).unwrap();
    HANGING.check(&campaign.sources[0]).unwrap();
    let plan = HANGING.plan(&campaign, &campaign.sources[0]).unwrap().unwrap();
    assert_eq!(plan.runs, 12);
    // Of 60 campaigns an interval of 95 % holds the truth in 51 to 60 with a probability of 0.9996.
    let found: Vec<_> = (1..=60).map(fitted).collect();
    let holds = found.iter().filter(|(.., [low, high])| (*low..=*high).contains(&6.0)).count();
    assert!(holds >= 51, "{holds}");
    let z: Vec<f64> = found.iter().map(|(value, standard, _)| (value - 6.0) / standard).collect();
    let square = z.iter().map(|z| z * z).sum::<f64>() / 60.0;
    // Its standard deviation is √(2/60).
    assert!((square - 1.0).abs() < 3.0 * (2.0_f64 / 60.0).sqrt(), "{square}");
}

/// D = Σ f x/Σ x² with x = −U², f = −W tan θ: u(D)² = D² (u(W)/W)² + Σ x² (W u(θ)/cos² θ)²/(Σ x²)², u(θ) being that of a mean of n samples whose errors keep c from one to the
/// next, σ² (n (1 − c²) − 2 c (1 − cⁿ))/(n (1 − c))².
#[test]
fn the_interval_to_expect_is_that_of_the_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = read_campaign(&written(folder.path(), 1)).unwrap();
    let (source, sensors) = (&campaign.sources[0], &campaign.simulate.as_ref().unwrap().sensors);
    let twin = Twin::<Hanging>::of(&campaign, source).unwrap();
    let (_, reduced) = exact(&twin, sensors).unwrap();
    let found = expected(&twin, source, &reduced, (sensors, false)).unwrap();
    let (n, keep, weight_n, sigma) = (600.0_f64, (-0.05_f64 / 0.2).exp(), 2.0, 0.5_f64.to_radians());
    let of_mean =
        sigma.powi(2) * (n * (1.0 - keep.powi(2)) - 2.0 * keep * (1.0 - keep.powf(n))) / (n * (1.0 - keep)).powi(2);
    let (mut squares, mut noise) = (0.0, 0.0);
    for u in [0.1_f64, 0.2, 0.3, 0.4] {
        let tan = 6.0 * u * u / weight_n;
        squares += 3.0 * u.powi(4);
        noise += 3.0 * u.powi(4) * (weight_n * (1.0 + tan * tan)).powi(2) * of_mean;
    }
    let by_noise = noise.sqrt() / squares;
    let standard = by_noise.hypot(6.0 * 0.01 / weight_n);
    let part = found[0].combined.standard / standard - 1.0;
    // Repeats of 12 runs, 200 each, of which the three fastest count most, tell a variance to √(2/600), its root to half of that; three times.
    assert!(part.abs() < 3.0 * 0.5 * (2.0_f64 / 600.0).sqrt(), "{part}");
}

/// CONTRIBUTING.md quotes the method and its campaign as they are here.
#[test]
fn contributing_quotes_the_method_as_it_is() {
    let text = include_str!("../../../../CONTRIBUTING.md");
    let method = include_str!("hanging.rs").split("\n// The method ends here").next().unwrap();
    let method = method.split_once("\n\n").unwrap().1.trim_end();
    assert!(text.contains(method) && text.contains(CAMPAIGN));
}
