//! A body file: a shape by its dimensions, for potential flow.
//!
//! ```toml
//! schema = 1
//! name = "Mamba, necked stand-in"
//!
//! [fluid]
//! density = "1025 kg/m^3"
//!
//! [body]
//! shape = "robot"                    # robot, ellipsoid, capsule or cylinder
//! link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
//! joint = { length = "60 mm", scale = 0.7, ramp = "4 mm" }   # without it the chain is smooth
//! ends = { length = "31 mm" }
//! centre_of_gravity = ["0 mm", "0 mm", "-12 mm"]             # may be left out: moments about it are asked for by name
//! ```
//!
//! The x axis runs along the body with the head to +x, y is lateral, z vertical; the origin is in the middle. The words are those of a
//! campaign: the major semi-axis is the vertical one, `half_length` that of a link from joint to joint.

use std::path::Path;

use froude_hydro::{Link, Neck, Robot};

use crate::error::{RecordError, read_bytes, utf8};
use crate::plausible;
use crate::section::{Section, Source, found, parse};
use crate::section_values::one_of;
use crate::units::Dimension;

/// Largest body file.
const LIMIT: u64 = 1 << 20;

/// A body by its dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFile {
    /// What it is called.
    pub name: String,
    /// Density of the water, kg/m³; `None` where the file does not say.
    pub density_kg_m3: Option<f64>,
    /// Centre of gravity from the middle of the body, m; `None` where the file does not say.
    pub centre_of_gravity_m: Option<[f64; 3]>,
    /// Shape.
    pub shape: Shape,
}

/// Half of a section's height and width, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SemiAxes {
    /// Vertical.
    pub major_m: f64,
    /// Lateral.
    pub minor_m: f64,
}

/// A shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A modular robot: head, links, tail; their number is asked for elsewhere.
    Robot(Robot),
    /// An ellipsoid: semi-axes along x, y, z, m.
    Ellipsoid {
        /// Semi-axes.
        semi_axes_m: [f64; 3],
    },
    /// An elliptic cylinder between half-ellipsoids.
    Capsule {
        /// From tip to tip, m.
        length_m: f64,
        /// Section.
        section: SemiAxes,
        /// Of each end, m.
        end_m: f64,
    },
    /// An elliptic cylinder with flat ends.
    Cylinder {
        /// Length, m.
        length_m: f64,
        /// Section.
        section: SemiAxes,
    },
}

/// Reads a body file.
///
/// # Errors
///
/// [`RecordError`] with line and column: not TOML, a key that is missing or unknown, a quantity of another kind, a shape that cannot be.
pub fn read_body(path: &Path) -> Result<BodyFile, RecordError> {
    let bytes = read_bytes(path, LIMIT, "a body")?;
    parse_body(path, utf8(path, &bytes)?)
}

/// The same from text.
///
/// # Errors
///
/// As [`read_body`].
pub fn parse_body(path: &Path, text: &str) -> Result<BodyFile, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let root = Section::new(source, "", document.get_ref(), 0);
    root.schema("body")?;
    root.only(&["schema", "name", "cite", "fluid", "body"])?;
    let density_kg_m3 = match root.section("fluid")? {
        Some(fluid) => {
            fluid.only(&["density"])?;
            let density_kg_m3 = fluid.positive("density", Dimension::DENSITY)?;
            if let (Some(rho), Some(value)) = (density_kg_m3, fluid.get("density"))
                && let Some(problem) = plausible::density_of_displaced_water(rho)
            {
                return Err(fluid.wrong("density", value, format!("is {}, which {problem}", found(value))));
            }
            density_kg_m3
        }
        None => None,
    };
    let body = root.section("body")?.ok_or_else(|| root.missing("body", "describe the shape in [body]"))?;
    let name = root.text("name")?.unwrap_or("body").to_owned();
    Ok(BodyFile { name, density_kg_m3, centre_of_gravity_m: centre_of_gravity(&body)?, shape: shape(&body)? })
}

/// How a shape is read.
type Reader = fn(&Section<'_>) -> Result<Shape, RecordError>;

fn shape(s: &Section<'_>) -> Result<Shape, RecordError> {
    let readers: [Reader; 4] = [robot, ellipsoid, capsule, cylinder];
    let read = one_of(s, "shape", &["robot", "ellipsoid", "capsule", "cylinder"], &readers)?.ok_or_else(|| {
        s.missing(
            "shape",
            "write shape = \"robot\", \"ellipsoid\", \"capsule\" or \"cylinder\"; any other hull comes as a mesh",
        )
    })?;
    read(s)
}

/// Lengths that a body can have, m: from a grain to some ships. Beyond them stands a slip of the unit, and no mesh that resolves both ends.
const LENGTHS_M: [f64; 2] = [1e-5, 1e3];

/// Every shape may have it.
const CENTRE_OF_GRAVITY: &str = "centre_of_gravity";

fn centre_of_gravity(s: &Section<'_>) -> Result<Option<[f64; 3]>, RecordError> {
    let Some(value) = s.get(CENTRE_OF_GRAVITY) else { return Ok(None) };
    let list = value.get_ref().as_array().map(|list| &list[..]);
    let Some([x, y, z]) = list else {
        let what = list.map_or_else(|| format!("is {}", found(value)), |list| format!("has {} entries", list.len()));
        let problem = format!("{what}; expected three lengths: [\"0 mm\", \"0 mm\", \"-12 mm\"]");
        return Err(s.wrong(CENTRE_OF_GRAVITY, value, problem));
    };
    let length = |v| s.as_quantity_of(CENTRE_OF_GRAVITY, v, Dimension::LENGTH);
    Ok(Some([length(x)?, length(y)?, length(z)?]))
}

/// A length of a body, m: it must be there and within what a body can have.
///
/// # Errors
///
/// [`RecordError`] with its place where it is missing, something else, or of no body.
pub fn need(s: &Section<'_>, key: &'static str) -> Result<f64, RecordError> {
    let length_m =
        s.positive(key, Dimension::LENGTH)?.ok_or_else(|| s.missing(key, "write it with its unit: \"60 mm\""))?;
    let [least, most] = LENGTHS_M;
    match s.get(key) {
        Some(value) if !(least..=most).contains(&length_m) => Err(s.wrong(
            key,
            value,
            format!("is {length_m} m; lengths of a body are from {least} m to {most} m: check its unit"),
        )),
        _ => Ok(length_m),
    }
}

fn section_of(s: &Section<'_>) -> Result<SemiAxes, RecordError> {
    Ok(SemiAxes { major_m: need(s, "major_semi_axis")?, minor_m: need(s, "minor_semi_axis")? })
}

fn end(s: &Section<'_>) -> Result<f64, RecordError> {
    let ends = s.section("ends")?.ok_or_else(|| s.missing("ends", "write ends = { length = \"31 mm\" }"))?;
    ends.only(&["length"])?;
    need(&ends, "length")
}

fn robot(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "link", "joint", "ends", CENTRE_OF_GRAVITY])?;
    let link = link(s)?.ok_or_else(|| {
        s.missing(
            "link",
            "write link = { major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }",
        )
    })?;
    let neck = s.section("joint")?.map(|j| neck(&j, 2.0 * link.half_length_m)).transpose()?;
    Ok(Shape::Robot(Robot { link, neck, end_m: end(s)? }))
}

/// The link of a `[body]`, of a body file and of a campaign.
pub(crate) fn link(s: &Section<'_>) -> Result<Option<Link>, RecordError> {
    let Some(link) = s.section("link")? else { return Ok(None) };
    link.only(&["major_semi_axis", "minor_semi_axis", "half_length"])?;
    let half_length_m = need(&link, "half_length")?;
    let SemiAxes { major_m, minor_m } = section_of(&link)?;
    Ok(Some(Link { major_semi_axis_m: major_m, minor_semi_axis_m: minor_m, half_length_m }))
}

fn neck(j: &Section<'_>, pitch_m: f64) -> Result<Neck, RecordError> {
    j.only(&["length", "scale", "ramp"])?;
    let neck = Neck {
        length_m: need(j, "length")?,
        scale: j
            .number("scale")?
            .ok_or_else(|| j.missing("scale", "write its section over that of the link: scale = 0.7"))?,
        ramp_m: need(j, "ramp")?,
    };
    let refused = |key: &'static str, problem: String| match j.get(key) {
        Some(value) => j.wrong(key, value, problem),
        None => j.missing(key, "write it"),
    };
    if !(neck.scale > 0.0 && neck.scale <= 1.0) {
        return Err(refused(
            "scale",
            format!("is {}; a joint's section lies between 0 and 1 of the link's", neck.scale),
        ));
    }
    if 2.0 * neck.ramp_m >= neck.length_m {
        return Err(refused(
            "ramp",
            format!("is {} m; two of them must be shorter than the joint of {} m", neck.ramp_m, neck.length_m),
        ));
    }
    if neck.length_m >= pitch_m {
        return Err(refused(
            "length",
            format!("is {} m; it must be shorter than the link from joint to joint, {pitch_m} m", neck.length_m),
        ));
    }
    Ok(neck)
}

fn ellipsoid(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "semi_axis_x", "semi_axis_y", "semi_axis_z", CENTRE_OF_GRAVITY])?;
    Ok(Shape::Ellipsoid { semi_axes_m: [need(s, "semi_axis_x")?, need(s, "semi_axis_y")?, need(s, "semi_axis_z")?] })
}

fn capsule(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "length", "major_semi_axis", "minor_semi_axis", "ends", CENTRE_OF_GRAVITY])?;
    let (length_m, end_m) = (need(s, "length")?, end(s)?);
    if 2.0 * end_m >= length_m {
        let problem = format!(
            "is {length_m} m from tip to tip; two ends of {end_m} m leave no cylinder; write shape = \"ellipsoid\""
        );
        return Err(s.get("length").map_or_else(|| s.missing("length", "write it"), |v| s.wrong("length", v, problem)));
    }
    Ok(Shape::Capsule { length_m, section: section_of(s)?, end_m })
}

fn cylinder(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "length", "major_semi_axis", "minor_semi_axis", CENTRE_OF_GRAVITY])?;
    Ok(Shape::Cylinder { length_m: need(s, "length")?, section: section_of(s)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROBOT: &str = r#"
schema = 1
name = "Mamba"
[fluid]
density = "1025 kg/m^3"
[body]
shape = "robot"
link = { major_semi_axis = "58.8 mm", minor_semi_axis = "39.4 mm", half_length = "90 mm" }
joint = { length = "60 mm", scale = 0.7, ramp = "4 mm" }
ends = { length = "31 mm" }
"#;

    fn read(text: &str) -> Result<BodyFile, RecordError> {
        parse_body(Path::new("body.toml"), text)
    }

    #[test]
    fn a_robot_is_read() {
        let body = read(ROBOT).unwrap();
        assert_eq!((body.density_kg_m3, body.shape), (Some(1025.0), Shape::Robot(Robot::NECKED_MAMBA)));
    }

    #[test]
    fn what_cannot_be_is_reported_with_its_place() {
        let refused = |from: &str, to: &str| read(&ROBOT.replace(from, to)).unwrap_err().to_string();
        assert_eq!(
            refused("ramp = \"4 mm\"", "ramp = \"40 mm\""),
            "body.toml:9:49: `ramp` is 0.04 m; two of them must be shorter than the joint of 0.06 m"
        );
        assert!(refused("\"31 mm\"", "\"31 kg\"").contains("body.toml:10"));
        assert!(refused("shape = \"robot\"", "shape = \"robo\"").contains("robot"));
        assert!(refused("scale = 0.7", "scale = 1.7").contains("between 0 and 1"));
        assert!(refused("shape = \"robot\"", "").contains("shape"));
        assert!(refused("ends = { length = \"31 mm\" }", "").contains("write ends"));
        let gravity = |list: &str| refused("ends =", &format!("centre_of_gravity = {list}\nends ="));
        assert_eq!(
            gravity("[\"0 mm\", \"1 mm\"]"),
            "body.toml:10:21: `centre_of_gravity` has 2 entries; expected three lengths: [\"0 mm\", \"0 mm\", \"-12 mm\"]"
        );
        assert!(gravity("[\"0 mm\", \"1 kg\", \"0 mm\"]").starts_with("body.toml:10"));
        assert!(gravity("\"0 mm\"").contains("expected three lengths"));
    }

    #[test]
    fn a_centre_of_gravity_is_read_where_there_is_one() {
        assert_eq!(read(ROBOT).unwrap().centre_of_gravity_m, None);
        let with = ROBOT.replace("ends =", "centre_of_gravity = [\"0 m\", \"1 cm\", \"-12 mm\"]\nends =");
        assert_eq!(read(&with).unwrap().centre_of_gravity_m, Some([0.0, 0.01, -0.012]));
    }
}
