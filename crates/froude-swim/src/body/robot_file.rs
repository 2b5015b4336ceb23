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
//! [joint]                            # or [[joint]] with between or index, of some of them
//! limit = "90 deg"                   # may be left out, each of them
//! rate = "120 deg/s"
//! torque = "3 N m"
//! kp = "40 N m/rad"                  # with kd: servos that follow the gait; without, joints follow it exactly
//! kd = "1 N m s/rad"
//! friction = { viscous = "0.05 N m s/rad", coulomb = "0.1 N m" }   # of joints with servos
//! efficiency = 0.6                   # from the battery to the joint
//! regeneration = 0                   # the part of what braking gives that goes back
//!
//! [start]                            # where a trajectory begins; without, with the motion that repeats
//! place = ["0 m", "0 m"]             # of the head's centre in the tank
//! heading = "0 deg"
//! velocity = ["0 m/s", "0 m/s"]      # of the head through the water, along and across it
//! turn_rate = "0 deg/s"
//! ```
//!
//! What three dimensions need beside it stands in `robot_file/spatial.rs`, joints one by one in `robot_file/joints.rs`.
//!
//! Modules stand from head to tail. The words of the sections are those of a campaign.

use std::path::{Path, PathBuf};

mod joint;
mod joints;
mod spatial;
#[cfg(test)]
mod spatial_tests;
mod start;
mod urdf;

use froude_hydro::Link;
use froude_records::body::need;
use froude_records::plausible;
use froude_records::read;
use froude_records::section::{self, Section, Source, found};
use froude_records::section_values::{count, one_of};
use froude_records::units::Dimension;
use froude_records::{Place, RecordError};
pub use joint::JointFile;
pub(crate) use joint::part;
use joints::joints;
pub use spatial::{AddedFile, MOTIONS, negative};
pub use start::StartFile;
use start::start;
pub use urdf::{UrdfLink, parse_urdf};

use crate::chain::AddedMass;
use crate::shares::{Distribution, SMOOTH_M_S, Torque};
use crate::spatial::vector::Axis;

/// Largest robot file.
const LIMIT: u64 = 1 << 20;
/// Most modules of a chain.
const MOST_MODULES: u64 = 1_000;
/// What an added mass is written as.
const ADDED_ADVICE: &str = "write added_mass = { sway = \"1.65 kg\", yaw = \"4.5e-3 kg m^2\" } of a link, or { record = \"tank.json\", select = \"tank/f4\" } with C_A";

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
    /// Added mass of a module that has none of its own.
    pub added_mass: AddedFile,
    /// How it is modelled.
    pub model: ModelFile,
    /// What its joints allow, and what drives them, where they have nothing of their own.
    pub joint: JointFile,
    /// Each of them, from the head.
    pub joints: Vec<JointFile>,
    /// What each turns about.
    pub axes: Vec<Axis>,
    /// Where a trajectory begins; `None`: with the motion that repeats.
    pub start: Option<StartFile>,
    /// What a URDF was taken as: links in others, joints of the opposite sign.
    pub remarks: Vec<String>,
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
    /// Of roll, pitch and yaw about its centre of mass, kg m².
    pub inertia_kg_m2: [f64; 3],
    /// Ahead, to starboard and down from its centre, m.
    pub centre_of_mass_m: [f64; 3],
    /// The same.
    pub centre_of_buoyancy_m: [f64; 3],
    /// What it displaces, m³.
    pub volume_m3: Option<f64>,
    /// By which part of itself its mass may differ from the water that it displaces, by the digits in which mass, volume and density are written: half a unit of the last of each.
    pub neutral_within: f64,
    /// Its own added mass.
    pub added: Option<AddedFile>,
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

/// `[model]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelFile {
    /// Load of the fluid's inertia.
    pub added_mass: AddedMass,
    /// Who has which part of the drag.
    pub distribution: Distribution,
    /// How drag across a module turns it.
    pub torque: Torque,
    /// ε, m/s.
    pub smooth_m_s: f64,
    /// Whether it swims in three dimensions.
    pub is_3d: bool,
    /// Drag up and down over that across; `None`: by the areas.
    pub heave_drag: Option<f64>,
    /// Of a module about its own axis, linear and quadratic: N m s, N m s².
    pub roll_drag: [f64; 2],
}

impl RobotFile {
    /// Drag up and down over that across, of a module in three dimensions.
    #[must_use]
    pub fn heave_drag(&self, module: &ModuleFile) -> f64 {
        self.model.heave_drag.unwrap_or(module.link.minor_semi_axis_m / module.link.major_semi_axis_m)
    }
}

/// Reads a robot file.
///
/// # Errors
///
/// [`RecordError`] with line and column: not TOML, a key that is missing or unknown, a quantity of another kind, strips together with a torque, fewer than two modules.
pub fn read_robot(path: &Path) -> Result<RobotFile, RecordError> {
    let text = read::text(path, LIMIT, "a robot")?;
    if !is_urdf(path) {
        return parse_robot(path, &text);
    }
    let chain = parse_urdf(path, &text)?;
    let sidecar = sidecar_of_urdf(path);
    if !sidecar.is_file() {
        let problem = format!("says nothing of the water: write {}:\n{}", sidecar.display(), lacking(&chain));
        return Err(RecordError::Syntax { place: Place::whole(path), problem });
    }
    parse(&sidecar, &read::text(&sidecar, LIMIT, "a robot")?, Some(&chain))
}

/// What a robot file states that a URDF does not, to be filled in.
fn lacking(chain: &[UrdfLink]) -> String {
    let ends = [0, chain.len().saturating_sub(1)];
    let module = |(i, link): (usize, &UrdfLink)| {
        let length = if ends.contains(&i) { "  half_length = \"… mm\"\n" } else { "" };
        format!(
            "  [[module]]\n  name = {:?}\n  major_semi_axis = \"… mm\"\n  minor_semi_axis = \"… mm\"\n{length}",
            link.name
        )
    };
    let modules: String = chain.iter().enumerate().map(module).collect();
    format!(
        "  schema = 1\n  [fluid]\n  density = \"1000 kg/m^3\"\n  [coefficients]\n  drag = {{ record = \"drag.json\" }}\n  \
         added_mass = {{ sway = \"… kg\", yaw = \"… kg m^2\" }}\n{modules}",
    )
    .trim_end()
    .to_owned()
}

/// Whether a robot is described by a URDF.
#[must_use]
pub fn is_urdf(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("urdf"))
}

/// What says the rest of it: the `.toml` of the same name.
#[must_use]
pub fn sidecar_of_urdf(path: &Path) -> PathBuf {
    path.with_extension("toml")
}

/// The same from text.
///
/// # Errors
///
/// As [`read_robot`].
pub fn parse_robot(path: &Path, text: &str) -> Result<RobotFile, RecordError> {
    parse(path, text, None)
}

fn parse(path: &Path, text: &str, chain: Option<&[UrdfLink]>) -> Result<RobotFile, RecordError> {
    let source = Source { path, text };
    let document = section::parse(source)?;
    let root = Section::new(source, "", document.get_ref(), 0);
    root.schema("robot")?;
    root.only(&["schema", "name", "cite", "fluid", "coefficients", "model", "module", "joint", "start"])?;
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
    let model = match root.section("model")? {
        Some(section) => model(&section)?,
        None => ModelFile {
            added_mass: AddedMass::Full,
            distribution: Distribution::Uniform,
            torque: Torque::Strip,
            smooth_m_s: SMOOTH_M_S,
            is_3d: false,
            heave_drag: None,
            roll_drag: [0.0; 2],
        },
    };
    let is_3d = model.is_3d;
    let added_mass = added_mass(source, &coefficients, is_3d)?;
    if let (Some(_), true) = (chain, is_3d) {
        return Err(root.missing("model", "a URDF is read as a chain in a plane: write space = \"planar\" in [model]"));
    }
    let modules = match chain {
        Some(chain) => urdf::modules(&root, chain)?,
        None => modules(source, &root, is_3d)?,
    };
    let density_digit = root.section("fluid")?.map_or(0.0, |fluid| fluid.half_digit("density"));
    let modules: Vec<ModuleFile> =
        modules.into_iter().map(|m| ModuleFile { neutral_within: m.neutral_within + density_digit, ..m }).collect();
    let names: Vec<&str> = modules.iter().map(|m| m.name.as_str()).collect();
    let (joint, mut joints, axes) = joints(&root, &names, is_3d)?;
    for (own, link) in joints.iter_mut().zip(chain.unwrap_or_default()) {
        own.limits = own.limits.or(link.limits);
    }
    let start = root.section("start")?.map(|s| start(&s)).transpose()?;
    Ok(RobotFile {
        name,
        density_kg_m3,
        current_m_s,
        modules,
        drag,
        added_mass,
        model,
        joint,
        joints,
        axes,
        start,
        remarks: chain.map_or_else(Vec::new, urdf::remarks),
    })
}

fn modules(source: Source<'_>, root: &Section<'_>, is_3d: bool) -> Result<Vec<ModuleFile>, RecordError> {
    let mut modules = Vec::new();
    for section in root.sections("module")? {
        let (module, times) = module(source, &section, is_3d)?;
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
    Ok(modules)
}

fn fluid(root: &Section<'_>) -> Result<(f64, [f64; 2]), RecordError> {
    let advice = "write [fluid] with density = \"1025 kg/m^3\"";
    let fluid = root.section("fluid")?.ok_or_else(|| root.missing("fluid", advice))?;
    fluid.only(&["density", "current"])?;
    let density = fluid.positive("density", Dimension::DENSITY)?.ok_or_else(|| fluid.missing("density", advice))?;
    if let (Some(value), Some(problem)) = (fluid.get("density"), plausible::density_of_displaced_water(density)) {
        return Err(fluid.wrong("density", value, format!("is {}, which {problem}", found(value))));
    }
    let current = pair(&fluid, "current", Dimension::SPEED, "two speeds: [\"0.1 m/s\", \"0 m/s\"]")?;
    Ok((density, current.unwrap_or_default()))
}

/// Two quantities in a list.
fn pair(
    s: &Section<'_>,
    key: &'static str,
    dimension: Dimension,
    expected: &str,
) -> Result<Option<[f64; 2]>, RecordError> {
    let Some(value) = s.get(key) else { return Ok(None) };
    let Some([x, y]) = value.get_ref().as_array().map(|list| &list[..]) else {
        return Err(s.wrong(key, value, format!("is {}; expected {expected}", found(value))));
    };
    let quantity = |v| s.as_quantity_of(key, v, dimension);
    Ok(Some([quantity(x)?, quantity(y)?]))
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

fn added_mass(source: Source<'_>, coefficients: &Section<'_>, is_3d: bool) -> Result<AddedFile, RecordError> {
    let s = coefficients.section("added_mass")?.ok_or_else(|| coefficients.missing("added_mass", ADDED_ADVICE))?;
    spatial::added(source, &s, is_3d)
}

fn model(s: &Section<'_>) -> Result<ModelFile, RecordError> {
    s.only(&["added_mass", "drag", "torque", "distribution", "epsilon", "space", "heave_drag", "roll_drag"])?;
    let added_mass =
        one_of(s, "added_mass", &["full", "usr"], &[AddedMass::Full, AddedMass::Usr])?.unwrap_or(AddedMass::Full);
    let is_strip = one_of(s, "drag", &["strip", "lumped"], &[true, false])?.unwrap_or(true);
    let torques = [Torque::Friction, Torque::CrossFlow, Torque::None];
    let torque = one_of(s, "torque", &["friction", "cross_flow", "none"], &torques)?;
    let torque = match (is_strip, torque, s.get("torque")) {
        (true, Some(_), Some(value)) => {
            let problem = format!(
                "is {}, and strips have their torque already: both would count it twice; leave it out, or write drag = \"lumped\"",
                found(value)
            );
            return Err(s.wrong("torque", value, problem));
        }
        (true, _, _) => Torque::Strip,
        (false, Some(torque), _) => torque,
        (false, None, _) => {
            return Err(s.missing("torque", "lumped drag needs one: torque = \"friction\", \"cross_flow\" or \"none\""));
        }
    };
    let distributions = [Distribution::Uniform, Distribution::ByOrigin];
    let distribution = one_of(s, "distribution", &["uniform", "by-origin"], &distributions)?.unwrap_or_default();
    let smooth_m_s = s.positive("epsilon", Dimension::SPEED)?.unwrap_or(SMOOTH_M_S);
    let is_3d = one_of(s, "space", &["planar", "3d"], &[false, true])?.unwrap_or(false);
    if is_3d {
        if let (AddedMass::Usr, Some(value)) = (added_mass, s.get("added_mass")) {
            let problem = "is \"usr\", which is printed for the plane only; three dimensions have \"full\"";
            return Err(s.wrong("added_mass", value, problem));
        }
        if let (false, Some(value)) = (is_strip, s.get("drag")) {
            let problem = "is \"lumped\", and three dimensions have strips only: write \"strip\", or leave it out";
            return Err(s.wrong("drag", value, problem));
        }
    }
    let (heave_drag, roll_drag) = (spatial::heave_drag(s)?, spatial::roll_drag(s)?);
    Ok(ModelFile { added_mass, distribution, torque, smooth_m_s, is_3d, heave_drag, roll_drag })
}

fn module(source: Source<'_>, s: &Section<'_>, is_3d: bool) -> Result<(ModuleFile, usize), RecordError> {
    s.only(&[
        "name",
        "count",
        "major_semi_axis",
        "minor_semi_axis",
        "half_length",
        "mass",
        "inertia",
        "center_of_mass",
        "center_of_buoyancy",
        "added_mass",
        "volume",
    ])?;
    let link = Link {
        major_semi_axis_m: need(s, "major_semi_axis")?,
        minor_semi_axis_m: need(s, "minor_semi_axis")?,
        half_length_m: need(s, "half_length")?,
    };
    let mass_kg = s.positive("mass", Dimension::MASS)?.ok_or_else(|| s.missing("mass", "write mass = \"1.343 kg\""))?;
    let Link { major_semi_axis_m: a, minor_semi_axis_m: b, half_length_m: l } = link;
    // A solid elliptic cylinder.
    let turn = |across: f64| mass_kg * (l * l / 3.0 + across * across / 4.0);
    let inertia_kg_m2 = spatial::inertia(s, [mass_kg * (a * a + b * b) / 4.0, turn(a), turn(b)])?;
    let centre_of_mass_m = spatial::place(s, "center_of_mass", [l, b, a])?.unwrap_or_default();
    let centre_of_buoyancy_m = spatial::place(s, "center_of_buoyancy", [l, b, a])?.unwrap_or_default();
    if let Some(value) = s.get("center_of_mass")
        && !is_3d
        && centre_of_mass_m[1] != 0.0
    {
        let problem = format!(
            "lies {} m to starboard, which the model of the plane does not have: write 0 mm, or space = \"3d\" in [model]",
            centre_of_mass_m[1]
        );
        return Err(s.wrong("center_of_mass", value, problem));
    }
    let volume_m3 = s.positive("volume", Dimension::VOLUME)?;
    if is_3d && volume_m3.is_none() {
        return Err(s.missing("volume", "three dimensions need what a module displaces: volume = \"1.31e-3 m^3\""));
    }
    let added = s.section("added_mass")?.map(|own| spatial::added(source, &own, is_3d)).transpose()?;
    let module = ModuleFile {
        name: s.text("name")?.unwrap_or("module").to_owned(),
        link,
        mass_kg,
        inertia_kg_m2,
        centre_of_mass_m,
        centre_of_buoyancy_m,
        volume_m3,
        neutral_within: s.half_digit("mass") + s.half_digit("volume"),
        added,
    };
    Ok((module, count(s, "count", MOST_MODULES)?.unwrap_or(1)))
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
        let AddedFile::Declared(added) = robot.added_mass else { panic!("{:?}", robot.added_mass) };
        assert_eq!([0, 1, 2, 5].map(|k| added[k][k]), [0.0, 1.653, 0.0, 4.463e-3]);
        assert_eq!(robot.drag.select.as_deref(), Some("tank/f2"));
        assert_eq!(robot.modules[9].centre_of_mass_m[0], 0.005);
        let (l, b) = (0.09_f64, 0.0394_f64);
        assert!((robot.modules[0].inertia_kg_m2[2] - 1.343 * (l * l / 3.0 + b * b / 4.0)).abs() < 1e-15);
        assert_eq!(
            (robot.joint.limits.angle_rad, robot.joint.limits.rate_rad_s),
            (Some(std::f64::consts::FRAC_PI_2), None)
        );
    }

    #[test]
    fn servos_and_a_start_are_read() {
        let servo = "kp = \"40 N m/rad\"\nkd = \"1 N m s/rad\"\nefficiency = 0.6\nregeneration = 0.2\nfriction = { viscous = \"0.05 N m s/rad\" }";
        let start = "[start]\nplace = [\"1 m\", \"-2 m\"]\nheading = \"90 deg\"\nturn_rate = \"1 rad/s\"";
        let robot = read(&ROBOT.replace("torque = \"3 N m\"", &format!("{servo}\n{start}"))).unwrap();
        let drives = robot.joint.servo.unwrap();
        assert_eq!((drives.stiffness_n_m, drives.damping_n_m_s), (40.0, 1.0));
        assert_eq!((drives.viscous_n_m_s, drives.dry_n_m), (0.05, 0.0));
        assert_eq!((robot.joint.efficiency, robot.joint.regeneration), (Some(0.6), 0.2));
        let start = robot.start.unwrap();
        assert_eq!((start.place_m, start.motion), ([1.0, -2.0], [1.0, 0.0, 0.0]));
        assert_eq!(start.heading_rad, std::f64::consts::FRAC_PI_2);
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
        let alone = refused("torque = \"3 N m\"", "kp = \"40 N m/rad\"");
        assert!(alone.contains("kd") && alone.starts_with("robot.toml:27:1"), "{alone}");
        let exact = refused("torque = \"3 N m\"", "friction = { coulomb = \"0.1 N m\" }");
        assert!(exact.starts_with("robot.toml:29:12") && exact.contains("kp"), "{exact}");
        assert!(refused("torque = \"3 N m\"", "efficiency = 1.2").contains("above zero and at most 1"));
        let place = refused("torque = \"3 N m\"", "[start]\nplace = [\"0 m\"]");
        assert!(place.starts_with("robot.toml:30:9") && place.contains("two lengths"), "{place}");
    }
}
