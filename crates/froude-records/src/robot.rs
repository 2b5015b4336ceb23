//! A robot file: a swimmer of modules in a chain, and where its coefficients come from.
//!
//! ```toml
//! schema = 1
//! name = "Mamba, ten equal links"
//!
//! [fluid]
//! density = "1025 kg/m^3"
//! current = ["0 m/s", "0 m/s"]       # of the water over the ground; may be left out
//!
//! [coefficients]
//! drag = { record = "tank.json", select = "tank/f2" }
//! added_mass = { sway = "1.653 kg", yaw = "4.463e-3 kg m^2" }   # of a link; or { record = …, select = … } with C_A
//!
//! [model]
//! added_mass = "full"                # usr: as the paper prints it
//! drag = "strip"                     # lumped: at the centres, with a torque
//! torque = "friction"                # of lumped drag: friction, cross_flow, none
//! distribution = "uniform"           # by-origin: head, links and tail what is theirs
//! epsilon = "1 mm/s"                 # how smooth cross terms pass broadside
//!
//! [[module]]
//! name = "link"
//! count = 10
//! major_semi_axis = "58.8 mm"        # vertical
//! minor_semi_axis = "39.4 mm"
//! half_length = "90 mm"
//! mass = "1.343 kg"
//! inertia = "4.15e-3 kg m^2"         # about its centre of mass; left out: m (l²/3 + b²/4)
//! center_of_mass = "0 mm"            # ahead of its centre
//! volume = "1.31e-3 m^3"             # may be left out; with it, what it weighs in water is said
//!
//! [joint]
//! limit = "90 deg"                   # may be left out, each of them
//! rate = "120 deg/s"
//! torque = "3 N m"
//! ```
//!
//! Modules stand from head to tail. The words of the sections are those of a campaign.

use std::path::{Path, PathBuf};

use froude_hydro::Link;

use crate::body::need;
use crate::error::{Place, RecordError, read_bytes, utf8};
use crate::plausible;
use crate::section::{Section, Source, found, parse};
use crate::section_values::{count, one_of};
use crate::units::Dimension;

/// Largest robot file.
const LIMIT: u64 = 1 << 20;
/// Most modules of a chain.
const MOST_MODULES: u64 = 1_000;
/// kg m².
const INERTIA: Dimension = Dimension::new(2, 1, 0);

/// A swimmer.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotFile {
    /// What it is called.
    pub name: String,
    /// Density of the water, kg/m³.
    pub density_kg_m3: f64,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 2],
    /// From head to tail, each as often as it stands in the chain; two at least.
    pub modules: Vec<ModuleFile>,
    /// Where its drag comes from.
    pub drag: FromRecord,
    /// Where its added mass comes from.
    pub added_mass: AddedFrom,
    /// How it is modelled.
    pub model: ModelFile,
    /// What its joints allow.
    pub joint: JointFile,
}

/// One module.
#[derive(Debug, Clone, PartialEq)]
pub struct ModuleFile {
    /// Its name.
    pub name: String,
    /// Its section and length.
    pub link: Link,
    /// kg.
    pub mass_kg: f64,
    /// About its centre of mass, kg m².
    pub inertia_kg_m2: f64,
    /// Of its centre of mass ahead of its centre, m.
    pub ahead_m: f64,
    /// What it displaces, m³.
    pub volume_m3: Option<f64>,
}

/// An estimate in a record.
#[derive(Debug, Clone, PartialEq)]
pub struct FromRecord {
    /// The file.
    pub path: PathBuf,
    /// Id of the estimate; `None`: the only one, or the recommended one.
    pub select: Option<String>,
    /// Where the robot file names it.
    pub place: Place,
}

/// Added mass of a module.
#[derive(Debug, Clone, PartialEq)]
pub enum AddedFrom {
    /// C_A of a record, with the volume that it refers to.
    Record(FromRecord),
    /// Alike for all modules: surge and sway, kg, yaw about the centre, kg m².
    Declared([f64; 3]),
}

/// Load of the fluid's inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AddedForm {
    /// Kirchhoff's.
    Full,
    /// As USR eq. 4 prints it.
    Usr,
}

/// How drag across a module turns it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DragForm {
    /// By strips.
    Strip,
    /// Lumped, with the torque of skin friction.
    Friction,
    /// Lumped, with the torque of cross-flow.
    CrossFlow,
    /// Lumped, without a torque.
    Lumped,
}

/// `[model]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelFile {
    /// Load of the fluid's inertia.
    pub added_mass: AddedForm,
    /// Form of the drag.
    pub drag: DragForm,
    /// Whether head, links and tail have what is theirs; else every module the same.
    pub is_by_origin: bool,
    /// ε, m/s.
    pub smooth_m_s: f64,
}

/// `[joint]`: limits, where they are declared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointFile {
    /// Largest angle to either side, rad.
    pub limit_rad: Option<f64>,
    /// Largest rate, rad/s.
    pub rate_rad_s: Option<f64>,
    /// Largest torque, N m.
    pub torque_n_m: Option<f64>,
}

/// Reads a robot file.
///
/// # Errors
///
/// [`RecordError`] with line and column: not TOML, a key that is missing or unknown, a quantity of another kind, strips together with a torque, fewer than two modules.
pub fn read_robot(path: &Path) -> Result<RobotFile, RecordError> {
    let bytes = read_bytes(path, LIMIT, "a robot")?;
    parse_robot(path, utf8(path, &bytes)?)
}

/// The same from text.
///
/// # Errors
///
/// As [`read_robot`].
pub fn parse_robot(path: &Path, text: &str) -> Result<RobotFile, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let root = Section::new(source, "", document.get_ref(), 0);
    root.schema("robot")?;
    root.only(&["schema", "name", "cite", "fluid", "coefficients", "model", "module", "joint"])?;
    let name = root.text("name")?.unwrap_or("robot").to_owned();
    let (density_kg_m3, current_m_s) = fluid(&root)?;
    let coefficients = root.section("coefficients")?.ok_or_else(|| {
        root.missing(
            "coefficients",
            "write [coefficients] with drag = { record = \"tank.json\", select = \"tank/f2\" }",
        )
    })?;
    coefficients.only(&["drag", "added_mass"])?;
    let drag = coefficients
        .section("drag")?
        .ok_or_else(|| coefficients.missing("drag", "write drag = { record = \"tank.json\", select = \"tank/f2\" }"))?;
    let drag = from_record(source, &drag)?;
    let added_mass = added_mass(source, &coefficients)?;
    let model = match root.section("model")? {
        Some(section) => model(&section)?,
        None => ModelFile { added_mass: AddedForm::Full, drag: DragForm::Strip, is_by_origin: false, smooth_m_s: 1e-3 },
    };
    let mut modules = Vec::new();
    for section in root.sections("module")? {
        let (module, times) = module(&section)?;
        if modules.len() + times > MOST_MODULES as usize {
            let problem = format!("makes more than {MOST_MODULES} modules; a chain has {MOST_MODULES} at most");
            return Err(RecordError::Value { place: section.place(), key: "count".to_owned(), problem });
        }
        modules.extend(std::iter::repeat_n(module, times));
    }
    if modules.len() < 2 {
        let advice =
            "a chain has two modules at least: describe each kind in a [[module]], with count = 10 for ten of it";
        return Err(root.missing("module", advice));
    }
    let joint = root.section("joint")?.map(|s| joint(&s)).transpose()?.unwrap_or_default();
    Ok(RobotFile { name, density_kg_m3, current_m_s, modules, drag, added_mass, model, joint })
}

fn fluid(root: &Section<'_>) -> Result<(f64, [f64; 2]), RecordError> {
    let advice = "write [fluid] with density = \"1025 kg/m^3\"";
    let fluid = root.section("fluid")?.ok_or_else(|| root.missing("fluid", advice))?;
    fluid.only(&["density", "current"])?;
    let density = fluid.positive("density", Dimension::DENSITY)?.ok_or_else(|| fluid.missing("density", advice))?;
    if let (Some(value), Some(problem)) = (fluid.get("density"), plausible::density_of_displaced_water(density)) {
        return Err(fluid.wrong("density", value, format!("is {}, which {problem}", found(value))));
    }
    let Some(value) = fluid.get("current") else { return Ok((density, [0.0; 2])) };
    let Some([x, y]) = value.get_ref().as_array().map(|list| &list[..]) else {
        return Err(fluid.wrong(
            "current",
            value,
            format!("is {}; expected two speeds: [\"0.1 m/s\", \"0 m/s\"]", found(value)),
        ));
    };
    let speed = |v| fluid.as_quantity_of("current", v, Dimension::SPEED);
    Ok((density, [speed(x)?, speed(y)?]))
}

fn from_record(source: Source<'_>, s: &Section<'_>) -> Result<FromRecord, RecordError> {
    s.only(&["record", "select"])?;
    let written =
        s.text("record")?.ok_or_else(|| s.missing("record", "name the estimate record: record = \"tank.json\""))?;
    let path = source.relative(written);
    let place = s.place();
    if path.is_dir() {
        let problem = format!("is the folder {}; name the record in it", path.display());
        return Err(RecordError::Value { place, key: "record".to_owned(), problem });
    }
    if !path.is_file() {
        return Err(RecordError::MissingFile { place, key: "record".to_owned(), path });
    }
    Ok(FromRecord { path, select: s.text("select")?.map(str::to_owned), place })
}

fn added_mass(source: Source<'_>, coefficients: &Section<'_>) -> Result<AddedFrom, RecordError> {
    let advice = "write added_mass = { sway = \"1.65 kg\", yaw = \"4.5e-3 kg m^2\" } of a link, or { record = \"tank.json\", select = \"tank/f4\" } with C_A";
    let s = coefficients.section("added_mass")?.ok_or_else(|| coefficients.missing("added_mass", advice))?;
    if s.get("record").is_some() {
        return Ok(AddedFrom::Record(from_record(source, &s)?));
    }
    s.only(&["surge", "sway", "yaw"])?;
    let positive = |key, dimension| s.positive(key, dimension)?.ok_or_else(|| s.missing(key, advice));
    let sway = positive("sway", Dimension::MASS)?;
    let yaw = positive("yaw", INERTIA)?;
    let surge = s.quantity("surge", Dimension::MASS)?.unwrap_or(0.0);
    match s.get("surge") {
        Some(value) if surge < 0.0 => {
            Err(s.wrong("surge", value, format!("is {}; an added mass is zero or more", found(value))))
        }
        _ => Ok(AddedFrom::Declared([surge, sway, yaw])),
    }
}

fn model(s: &Section<'_>) -> Result<ModelFile, RecordError> {
    s.only(&["added_mass", "drag", "torque", "distribution", "epsilon"])?;
    let added_mass =
        one_of(s, "added_mass", &["full", "usr"], &[AddedForm::Full, AddedForm::Usr])?.unwrap_or(AddedForm::Full);
    let is_strip = one_of(s, "drag", &["strip", "lumped"], &[true, false])?.unwrap_or(true);
    let torques = [DragForm::Friction, DragForm::CrossFlow, DragForm::Lumped];
    let torque = one_of(s, "torque", &["friction", "cross_flow", "none"], &torques)?;
    let drag = match (is_strip, torque, s.get("torque")) {
        (true, Some(_), Some(value)) => {
            let problem = format!(
                "is {}, and strips have their torque already: both would count it twice; leave it out, or write drag = \"lumped\"",
                found(value)
            );
            return Err(s.wrong("torque", value, problem));
        }
        (true, _, _) => DragForm::Strip,
        (false, Some(torque), _) => torque,
        (false, None, _) => {
            return Err(s.missing("torque", "lumped drag needs one: torque = \"friction\", \"cross_flow\" or \"none\""));
        }
    };
    let is_by_origin = one_of(s, "distribution", &["uniform", "by-origin"], &[false, true])?.unwrap_or(false);
    let smooth_m_s = s.positive("epsilon", Dimension::SPEED)?.unwrap_or(1e-3);
    Ok(ModelFile { added_mass, drag, is_by_origin, smooth_m_s })
}

fn module(s: &Section<'_>) -> Result<(ModuleFile, usize), RecordError> {
    s.only(&[
        "name",
        "count",
        "major_semi_axis",
        "minor_semi_axis",
        "half_length",
        "mass",
        "inertia",
        "center_of_mass",
        "volume",
    ])?;
    let link = Link {
        major_semi_axis_m: need(s, "major_semi_axis")?,
        minor_semi_axis_m: need(s, "minor_semi_axis")?,
        half_length_m: need(s, "half_length")?,
    };
    let mass_kg = s.positive("mass", Dimension::MASS)?.ok_or_else(|| s.missing("mass", "write mass = \"1.343 kg\""))?;
    let (l, b) = (link.half_length_m, link.minor_semi_axis_m);
    let inertia_kg_m2 = s.positive("inertia", INERTIA)?.unwrap_or(mass_kg * (l * l / 3.0 + b * b / 4.0));
    let ahead_m = s.quantity("center_of_mass", Dimension::LENGTH)?.unwrap_or(0.0);
    if let Some(value) = s.get("center_of_mass")
        && ahead_m.abs() > l
    {
        let problem =
            format!("is {}, which lies outside of the module: from its centre it reaches {l} m", found(value));
        return Err(s.wrong("center_of_mass", value, problem));
    }
    let module = ModuleFile {
        name: s.text("name")?.unwrap_or("module").to_owned(),
        link,
        mass_kg,
        inertia_kg_m2,
        ahead_m,
        volume_m3: s.positive("volume", Dimension::VOLUME)?,
    };
    Ok((module, count(s, "count", MOST_MODULES)?.unwrap_or(1)))
}

fn joint(s: &Section<'_>) -> Result<JointFile, RecordError> {
    s.only(&["limit", "rate", "torque"])?;
    Ok(JointFile {
        limit_rad: s.positive("limit", Dimension::ANGLE)?,
        rate_rad_s: s.positive("rate", Dimension::ANGULAR_SPEED)?,
        torque_n_m: s.positive("torque", Dimension::MOMENT)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROBOT: &str = r#"schema = 1
name = "Mamba"
[fluid]
density = "1025 kg/m^3"
current = ["0.1 m/s", "0 m/s"]
[coefficients]
drag = { record = "Cargo.toml", select = "tank/f2" }
added_mass = { sway = "1.653 kg", yaw = "4.463e-3 kg m^2" }
[model]
added_mass = "full"
drag = "strip"
[[module]]
name = "head"
major_semi_axis = "58.8 mm"
minor_semi_axis = "39.4 mm"
half_length = "90 mm"
mass = "1.343 kg"
[[module]]
name = "link"
count = 9
major_semi_axis = "58.8 mm"
minor_semi_axis = "39.4 mm"
half_length = "90 mm"
mass = "1.343 kg"
center_of_mass = "5 mm"
volume = "1.31e-3 m^3"
[joint]
limit = "90 deg"
torque = "3 N m"
"#;

    fn read(text: &str) -> Result<RobotFile, RecordError> {
        parse_robot(Path::new("robot.toml"), text)
    }

    #[test]
    fn a_robot_is_read() {
        let robot = read(ROBOT).unwrap();
        assert_eq!((robot.modules.len(), robot.current_m_s), (10, [0.1, 0.0]));
        assert_eq!(robot.added_mass, AddedFrom::Declared([0.0, 1.653, 4.463e-3]));
        assert_eq!(robot.drag.select.as_deref(), Some("tank/f2"));
        assert_eq!(robot.modules[9].ahead_m, 0.005);
        let (l, b) = (0.09_f64, 0.0394_f64);
        assert!((robot.modules[0].inertia_kg_m2 - 1.343 * (l * l / 3.0 + b * b / 4.0)).abs() < 1e-15);
        assert_eq!((robot.joint.limit_rad, robot.joint.rate_rad_s), (Some(std::f64::consts::FRAC_PI_2), None));
    }

    #[test]
    fn what_cannot_be_is_reported_with_its_place() {
        let refused = |from: &str, to: &str| {
            assert!(ROBOT.contains(from), "{from}");
            read(&ROBOT.replacen(from, to, 1)).unwrap_err().to_string()
        };
        let twice = refused("drag = \"strip\"", "drag = \"strip\"\ntorque = \"friction\"");
        assert!(twice.starts_with("robot.toml:12:10") && twice.contains("count it twice"), "{twice}");
        assert!(refused("drag = \"strip\"", "drag = \"lumped\"").contains("torque = \"friction\""));
        assert!(refused("mass = \"1.343 kg\"", "mass = \"-1 kg\"").starts_with("robot.toml:17"));
        assert!(refused("count = 9", "count = 1000").contains("1000 at most"));
        assert!(refused("\"5 mm\"", "\"95 mm\"").contains("outside of the module"));
        assert!(refused("[\"0.1 m/s\", \"0 m/s\"]", "\"0.1 m/s\"").contains("two speeds"));
        assert!(refused("sway = \"1.653 kg\", ", "").contains("sway"));
        assert!(refused("record = \"Cargo.toml\"", "record = \"none.json\"").contains("none.json"));
        assert!(refused("\"1025 kg/m^3\"", "\"1.025 kg/m^3\"").contains("density"));
    }
}
