//! Campaigns: what is read, and what a user reads when it cannot be, word for word.

use std::path::{Path, PathBuf};

use froude_records::campaign::{
    AngleOffset, BoundKind, Campaign, Comparison, Input, KeepValue, Shared, SourceKind, Truth,
};
use froude_records::campaign_file::{parse_campaign, read_campaign};
use froude_records::units::Dimension;

const CAMPAIGN: &str = r#"schema = 1
name = "Mamba in the circulation tank"

[fluid]
density = "1025 kg/m^3"

[body]
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
head_side_area = "0.011 m^2"
tail_side_area = "0.008 m^2"

[[source]]
name  = "circulation tank"
kind  = "tank"
table = "tank.csv"
keep  = "angle <= 39 deg"
group = "configuration"
[[source.uncertainty]]
quantity = "f_x"
standard = "0.01 N"
shared   = "setup"

[identify]
models = ["f1", "f2", "f3", "f4", "f5", "f6"]
bounds = "non-negative"
[[identify.model]]
name = "sway"
f_y = "Y_v*v + Y_vav*v*abs(v) + Y_0"
"#;

fn parse(text: &str) -> Result<Campaign, String> {
    parse_campaign(Path::new("lab/campaign.toml"), text).map_err(|e| e.to_string())
}

/// The message for the campaign above with one passage changed.
#[track_caller]
fn refused(from: &str, to: &str, message: &str) {
    assert!(CAMPAIGN.contains(from), "{from}");
    assert_eq!(parse(&CAMPAIGN.replacen(from, to, 1)).expect_err("accepted"), message);
}

#[test]
fn the_campaign_of_the_design_is_read_in_si() {
    let campaign = parse(CAMPAIGN).unwrap();
    assert_eq!(campaign.fluid.density_kg_m3, Some(1025.0));
    let body = campaign.body.unwrap();
    let link = body.link.unwrap();
    assert_eq!((link.major_semi_axis_m, link.minor_semi_axis_m, link.half_length_m), (0.0588, 0.0394, 0.09));
    assert_eq!((body.head_side_area_m2, body.tail_side_area_m2), (Some(0.011), Some(0.008)));
    let source = &campaign.sources[0];
    assert_eq!(source.kind, SourceKind::Tank);
    assert_eq!(source.input, Input::Table(PathBuf::from("lab/tank.csv")));
    assert_eq!(source.place.to_string(), "lab/campaign.toml:15:9");
    let clause = &source.keep.as_ref().unwrap().clauses[0];
    assert_eq!((clause.column.as_str(), clause.comparison), ("angle", Comparison::Le));
    assert!(matches!(&clause.value, KeepValue::Quantity(q) if q.value_si == 39.0 * std::f64::consts::PI / 180.0));
    let entry = &source.uncertainty[0];
    assert_eq!(
        (entry.quantity.as_str(), entry.standard, entry.relative, entry.shared),
        ("f_x", 0.01, false, Shared::Setup)
    );
    assert_eq!(entry.place.to_string(), "lab/campaign.toml:19:12");
    assert_eq!(campaign.identify.models.len(), 6);
    assert_eq!(campaign.identify.bounds.default, BoundKind::NonNegative);
    assert_eq!(campaign.identify.user_models[0].formulas["f_y"], "Y_v*v + Y_vav*v*abs(v) + Y_0");
}

#[test]
fn everything_that_a_campaign_can_say_is_read() {
    let text = r#"schema = 1
name = "all keys"
cite = ["someone (1871)"]
[fluid]
temperature = "15 degC"
salinity = "35 g/kg"
kinematic_viscosity = "1.19e-6 m^2/s"
[body]
reference_length = "1 m"
reference_area = "0.1 m^2"
volume = "2 L"
volumes = { H1LT = "1 L", H2LT = "2 L" }
link_volume = "1 L"
[tank]
width = "3.66 m"
depth = "2.44 m"
submergence = "1 ft"
[[source]]
name = "twin"
kind = "towing"
table = "twin.csv"
sidecar = "other.toml"
models = ["f1"]
keep = "configuration != H1LT and speed > 50 mm/s and run == '3 b'"
tare = { record = "tare.json", select = "frame/quadratic" }
[[source.uncertainty]]
name = "calibration"
quantity = "f_y"
standard = "0.5 %"
shared = "campaign"
dof = 9
[[source.uncertainty]]
quantity = "temperature"
standard = "0.1 degC"
shared = "run"
[[source.plan]]
configurations = ["H1LT", "H2LT"]
speed = { start = "0.02 m/s", stop = "1 m/s", step = "0.02 m/s" }
angle = ["0 deg", "30 deg"]
repeats = 2
[[source]]
name = "published"
kind = "published"
record = "p.json"
select = "tank/f4"
[identify]
bounds = { default = "non-negative", C_XY_I = "free" }
fixed = { C_f = 0.0046, m = "2 t" }
exclude = ["C_XY_II"]
covariance = "HC3"
angle_offset = "estimate"
dissipative = true
errors_in_variables = true
[[identify.prior]]
coefficient = "C_d"
value = 0.36
standard_uncertainty = 0.02
model = "f1"
[[identify.cross_validation]]
column = "angle"
low = "-12 deg"
high = "12 deg"
[simulate]
seed = 20
record = "p.json"
misalignment = "1 deg"
[[simulate.sensor]]
quantity = "f_x"
noise = "20 mN"
resolution = "10 mN"
drift = "5 mN"
bias = "-1 mN"
"#;
    let c = parse(text).unwrap();
    assert_eq!(c.cite, ["someone (1871)"]);
    assert!((c.fluid.temperature_degc.unwrap() - 15.0).abs() < 1e-12);
    assert!((c.fluid.salinity_g_kg.unwrap() - 35.0).abs() < 1e-12);
    let body = c.body.unwrap();
    assert_eq!((body.volume_m3, body.volumes["H2LT"], body.link_volume_m3), (Some(0.002), 0.002, Some(0.001)));
    assert_eq!(c.tank.unwrap().submergence_m, Some(0.3048));
    let twin = &c.sources[0];
    assert_eq!(twin.keep.as_ref().unwrap().clauses.len(), 3);
    assert_eq!(twin.keep.as_ref().unwrap().clauses[2].value, KeepValue::Text("3 b".to_owned()));
    assert_eq!(twin.tare.as_ref().unwrap().record, PathBuf::from("lab/tare.json"));
    assert_eq!((twin.uncertainty[0].standard, twin.uncertainty[0].relative), (0.005, true));
    assert_eq!(twin.uncertainty[0].dof, Some(9.0));
    assert_eq!((twin.uncertainty[1].standard, twin.uncertainty[1].dimension), (0.1, Dimension::TEMPERATURE));
    let plan = &twin.plan[0];
    assert_eq!((plan.speed_m_s.len(), plan.angle_rad.len(), plan.repeats), (50, 2, 2));
    assert_eq!((plan.speed_m_s[0], plan.speed_m_s[14], plan.speed_m_s[49]), (0.02, 0.3, 1.0));
    assert!(matches!(&c.sources[1].input, Input::Record { select: Some(s), .. } if s == "tank/f4"));
    let identify = &c.identify;
    assert_eq!((identify.bounds.default, identify.bounds.named["C_XY_I"]), (BoundKind::NonNegative, BoundKind::None));
    assert_eq!((identify.fixed["C_f"], identify.fixed["m"]), (0.0046, 2000.0));
    assert_eq!(identify.covariance.as_deref(), Some("HC3"));
    assert_eq!(identify.angle_offset, AngleOffset::Estimate);
    assert!(identify.dissipative && identify.errors_in_variables);
    assert_eq!(identify.prior[0].model.as_deref(), Some("f1"));
    assert!((identify.cross_validation[0].low + 0.20943951023931953).abs() < 1e-15);
    let simulate = c.simulate.unwrap();
    assert!(matches!(simulate.truth, Truth::Record { .. }));
    assert_eq!(simulate.sensors[0].noise, Some(0.02));
    assert_eq!(simulate.sensors[0].bias, Some(-0.001));
}

#[test]
fn unknown_keys_are_told_the_nearest_known_one() {
    refused("density =", "densty =", "lab/campaign.toml:5:1: unknown key `densty` in [fluid]; did you mean `density`?");
    refused(
        "angle <= 39 deg",
        "angle <= 39",
        "lab/campaign.toml:16:9: `keep` cannot be read: \"angle <= 39\" is not a condition: 39 has no unit; write 39 deg; \
         write for example \"angle <= 39 deg and configuration != H1LT\"",
    );
    refused("keep  =", "kep  =", "lab/campaign.toml:16:1: unknown key `kep` in [[source]]; did you mean `keep`?");
    refused(
        "shared   = \"setup\"",
        "shared   = \"setup\"\nshape = 1",
        "lab/campaign.toml:22:1: unknown key `shape` in [[source.uncertainty]]; did you mean `shared`?",
    );
    refused("[fluid]", "[fluids]", "lab/campaign.toml:4:2: unknown key `fluids` in the file; did you mean `fluid`?");
    refused(
        "half_length = \"90 mm\"",
        "half_length = \"90 mm\", colour = \"red\"",
        "lab/campaign.toml:8:91: unknown key `colour` in [body.link]; known: half_length, major_semi_axis, minor_semi_axis",
    );
}

#[test]
fn a_missing_key_is_not_taken_for_another_that_is_spelt_like_it() {
    let range =
        "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = { start = \"0 m/s\", step = \"1 m/s\" }\n[identify]";
    refused(
        "[identify]",
        range,
        "lab/campaign.toml:25:9: [source.plan.speed] has no `stop`; a range needs start, stop and step",
    );
    refused(
        "[identify]",
        &range.replace("step =", "stoop ="),
        "lab/campaign.toml:25:28: unknown key `stoop` in [source.plan.speed]; did you mean `stop`?",
    );
    refused(
        "name = \"sway\"",
        "nmae = \"sway\"",
        "lab/campaign.toml:27:1: unknown key `nmae` in [[identify.model]]; did you mean `name`?",
    );
}

#[test]
fn quantities_of_another_kind_name_both() {
    refused(
        "\"1025 kg/m^3\"",
        "\"1025 kg\"",
        "lab/campaign.toml:5:11: `density` is \"1025 kg\": expected a density (kg/m^3), found a mass (kg)",
    );
    refused(
        "\"1025 kg/m^3\"",
        "1025",
        "lab/campaign.toml:5:11: `density` is 1025; expected a quantity with its unit in quotes, such as \"1025 kg/m^3\"",
    );
    refused(
        "\"1025 kg/m^3\"",
        "\"1025\"",
        "lab/campaign.toml:5:11: `density` cannot be read: `1025` has no unit; write for example `1025 kg/m^3`",
    );
    refused(
        "\"1025 kg/m^3\"",
        "\"-1 kg/m^3\"",
        "lab/campaign.toml:5:11: `density` is \"-1 kg/m^3\", which is not a density of water (500 to 2000 kg/m^3 are accepted); \
         fresh water has 1000 kg/m^3, sea water 1025",
    );
    refused(
        "\"1025 kg/m^3\"",
        "\"1.025 kg/m^3\"",
        "lab/campaign.toml:5:11: `density` is \"1.025 kg/m^3\", which is not a density of water (500 to 2000 kg/m^3 are accepted); \
         write 1.025 g/cm^3 or 1025 kg/m^3; if the test was in air, state its kinematic viscosity too, some 1.5e-5 m^2/s: \
         kinematic_viscosity beside density, in [fluid] of the campaign or as columns",
    );
    // What the message proposes is no water of 1.025 kg/m^3.
    refused(
        "\"1025 kg/m^3\"",
        "1.025",
        "lab/campaign.toml:5:11: `density` is 1.025; expected a quantity with its unit in quotes, such as \"1.025 g/cm^3\"",
    );
    refused(
        "\"1025 kg/m^3\"",
        "\"1.025\"",
        "lab/campaign.toml:5:11: `density` cannot be read: `1.025` has no unit; write for example `1.025 g/cm^3`",
    );
    refused(
        "angle <= 39 deg",
        "angle <= 39 rad",
        "lab/campaign.toml:16:9: `keep` cannot be read: \"angle <= 39 rad\" is not a condition: 39 rad is more than a whole turn: \
         degrees under a header in radians, probably: write the unit deg; of an angle counted on over several turns take the whole ones \
         off (1.30089 rad); write for example \"angle <= 39 deg and configuration != H1LT\"",
    );
    refused(
        "\"0.01 N\"",
        "\"0.01 N m\"",
        "lab/campaign.toml:20:12: `standard` is \"0.01 N m\", but f_x is a force (N)",
    );
    refused(
        "angle <= 39 deg",
        "angle <= 39 N",
        "lab/campaign.toml:16:9: `keep` cannot be read: \"angle <= 39 N\" is not a condition: angle is an angle (deg), 39 N is a force (N); \
         write for example \"angle <= 39 deg and configuration != H1LT\"",
    );
    refused(
        "angle <= 39 deg",
        "angle = 39 deg",
        "lab/campaign.toml:16:9: `keep` cannot be read: \"angle = 39 deg\" is not a condition: a single = or ! is not a comparison; write == or !=; \
         write for example \"angle <= 39 deg and configuration != H1LT\"",
    );
}

#[test]
fn a_source_has_one_input() {
    refused(
        "table = \"tank.csv\"",
        "table = \"tank.csv\"\nrecord = \"e.json\"",
        "lab/campaign.toml:12:1: `circulation tank` names table and record; a source needs exactly one of table, runs, cases, mesh, record",
    );
    refused(
        "table = \"tank.csv\"\n",
        "",
        "lab/campaign.toml:12:1: `circulation tank` names none; a source needs exactly one of table, runs, cases, mesh, record",
    );
    refused("\"tank\"", "\"tnak\"", "lab/campaign.toml:14:9: `kind` is \"tnak\"; did you mean `tank`?");
    refused(
        "\"setup\"",
        "\"day\"",
        "lab/campaign.toml:21:12: `shared` is \"day\"; known: sample, run, setup, campaign",
    );
    refused(
        "bounds = \"non-negative\"",
        "bounds = \"positive\"",
        "lab/campaign.toml:25:10: `bounds` is \"positive\"; expected \"none\", \"free\" or \"non-negative\"",
    );
    refused(
        "name  = \"circulation tank\"\n",
        "",
        "lab/campaign.toml:12:1: [[source]] has no `name`; write name = \"circulation tank\", for example",
    );
}

#[test]
fn versions_are_compared() {
    refused(
        "schema = 1",
        "schema = 2",
        "lab/campaign.toml:1:10: this is campaign schema 2; this program reads up to campaign schema 1: use a newer Froude",
    );
    refused("schema = 1\n", "", "lab/campaign.toml:1: `schema` is missing; expected schema = 1");
    refused("schema = 1", "schema = 0", "lab/campaign.toml:1:10: `schema` is 0; expected 1");
    refused("density =", "density", "lab/campaign.toml:5:9: not TOML: key with no value, expected `=`");
}

#[test]
fn files_that_do_not_exist_are_named_with_the_line_that_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, CAMPAIGN).unwrap();
    let missing = folder.path().join("tank.csv");
    assert_eq!(
        read_campaign(&path).unwrap_err().to_string(),
        format!("{}:15:9: `table` names {}, which does not exist", path.display(), missing.display())
    );
    let planned =
        CAMPAIGN.replace("[identify]", "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.1 m/s\"\n[identify]");
    std::fs::write(&path, planned).unwrap();
    assert!(read_campaign(&path).is_ok(), "a table with a plan may still have to be made");
    std::fs::write(&path, CAMPAIGN).unwrap();
    std::fs::write(&missing, "").unwrap();
    assert!(read_campaign(&path).is_ok());
    let gone = folder.path().join("gone.toml");
    assert_eq!(
        read_campaign(&gone).unwrap_err().to_string(),
        format!("cannot read {}: there is no such file or folder", gone.display())
    );
}

#[test]
fn numbers_that_make_no_sense_are_refused_and_not_bent() {
    let plan = |line: &str| {
        CAMPAIGN.replace(
            "[identify]\n",
            &format!("[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = [\"0.1 m/s\"]\n{line}\n[identify]\n"),
        )
    };
    assert_eq!(
        parse(&plan("repeats = 0")).unwrap_err(),
        "lab/campaign.toml:26:11: `repeats` is 0; it must lie between 1 and 10000"
    );
    assert_eq!(
        parse(&plan("angle = []")).unwrap_err(),
        "lab/campaign.toml:26:9: `angle` is an empty list; write at least one quantity"
    );
    assert_eq!(
        parse(&plan("angle = { start = \"0 deg\", stop = \"90 deg\", step = \"0 deg\" }")).unwrap_err(),
        "lab/campaign.toml:26:9: `angle` must go from start to stop in at most 100000 steps of the step's sign"
    );
    refused(
        "shared   = \"setup\"",
        "shared   = \"setup\"\ndof = -1",
        "lab/campaign.toml:22:7: `dof` is -1; it must be larger than zero",
    );
    refused(
        "bounds = \"non-negative\"",
        "covariance = \"hc3\"",
        "lab/campaign.toml:25:14: `covariance` is \"hc3\"; did you mean `HC3`?",
    );
}

#[test]
fn removed_keys_are_refused_with_what_to_do_instead() {
    let bounds = "bounds = \"non-negative\"";
    refused(
        bounds,
        "huber = 1.345",
        "lab/campaign.toml:25:9: `huber` was removed: its intervals covered less often than they claim; use `keep` to \
         leave out a row that does not belong, for a reason that you can state (the finding `outlying-row` names such rows)",
    );
    refused(
        bounds,
        "wild_bootstrap = 9999",
        "lab/campaign.toml:25:18: `wild_bootstrap` was removed: its p values covered the scatter alone; write \
         covariance = \"cluster\", whose intervals have degrees of freedom of their own",
    );
    refused(
        bounds,
        "monte_carlo = 10000",
        "lab/campaign.toml:25:15: `monte_carlo` was removed: it only checked the linear propagation of the budget, which \
         every interval has; delete it",
    );
}

/// The examples that a reader runs are campaigns in good order, their tables included.
#[test]
fn the_examples_are_read() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for folder in std::fs::read_dir(&examples).unwrap() {
        let path = folder.unwrap().path().join("campaign.toml");
        if !path.exists() {
            continue;
        }
        let campaign = read_campaign(&path).unwrap();
        for source in &campaign.sources {
            match &source.input {
                Input::Table(table) if table.exists() => {
                    froude_records::table_file::read_table(table, source.sidecar.as_deref()).unwrap();
                }
                Input::Record { path, .. } => {
                    froude_records::json::read_estimates(path).unwrap();
                }
                _ => {}
            }
        }
    }
}
