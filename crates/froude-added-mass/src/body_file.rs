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
//! centre_of_gravity = ["0 mm", "0 mm", "-12 mm"]             # optional; `--at cg` takes moments about it
//! ```
//!
//! The x axis runs along the body with the head to +x, y is lateral, z vertical; the origin is in the middle. The words are those of a
//! campaign: the major semi-axis is the vertical one, `half_length` that of a link from joint to joint.

use std::path::Path;

use froude_hydro::{Neck, Robot};
use froude_records::RecordError;
use froude_records::body::{SemiAxes, link, need, semi_axes};
use froude_records::plausible;
use froude_records::read;
use froude_records::section::{Section, Source, found, parse};
use froude_records::section_values::one_of;
use froude_records::units::Dimension;

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

/// A shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A modular robot: head, links and tail; `--links` gives the number of links.
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
    parse_body(path, &read::text(path, LIMIT, "a body")?)
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
    let density_kg_m3 = root.section("fluid")?.map_or(Ok(None), |fluid| density(&fluid))?;
    let body = root.section("body")?.ok_or_else(|| root.missing("body", "describe the shape in [body]"))?;
    let name = root.text("name")?.unwrap_or("body").to_owned();
    Ok(BodyFile { name, density_kg_m3, centre_of_gravity_m: centre_of_gravity(&body)?, shape: shape(&body)? })
}

fn density(fluid: &Section<'_>) -> Result<Option<f64>, RecordError> {
    fluid.only(&["density"])?;
    let density_kg_m3 = fluid.positive("density", Dimension::DENSITY)?;
    match (fluid.get("density"), density_kg_m3.and_then(plausible::density_of_displaced_water)) {
        (Some(value), Some(problem)) => {
            Err(fluid.wrong("density", value, format!("is {}, which {problem}", found(value))))
        }
        _ => Ok(density_kg_m3),
    }
}

/// How a shape is read.
type Reader = fn(&Section<'_>) -> Result<Shape, RecordError>;

fn shape(s: &Section<'_>) -> Result<Shape, RecordError> {
    let readers: [Reader; 4] = [robot, ellipsoid, capsule, cylinder];
    let advice = "write shape = \"robot\", \"ellipsoid\", \"capsule\" or \"cylinder\"; any other hull comes as a mesh";
    let read = one_of(s, "shape", &["robot", "ellipsoid", "capsule", "cylinder"], &readers)?;
    read.ok_or_else(|| s.missing("shape", advice))?(s)
}

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

fn end(s: &Section<'_>) -> Result<f64, RecordError> {
    let ends = s.section("ends")?.ok_or_else(|| s.missing("ends", "write ends = { length = \"31 mm\" }"))?;
    ends.only(&["length"])?;
    need(&ends, "length")
}

fn robot(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "link", "joint", "ends", CENTRE_OF_GRAVITY])?;
    let advice =
        "write link = { major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }";
    let link = link(s)?.ok_or_else(|| s.missing("link", advice))?;
    let neck = s.section("joint")?.map(|j| neck(&j, 2.0 * link.half_length_m)).transpose()?;
    Ok(Shape::Robot(Robot { link, neck, end_m: end(s)? }))
}

fn neck(j: &Section<'_>, pitch_m: f64) -> Result<Neck, RecordError> {
    j.only(&["length", "scale", "ramp"])?;
    let neck = Neck {
        length_m: need(j, "length")?,
        scale: j.as_number("scale", j.need("scale", "write its section over that of the link: scale = 0.7")?)?,
        ramp_m: need(j, "ramp")?,
    };
    let Neck { length_m, scale, ramp_m } = neck;
    let problem = format!("is {scale}; a joint's section lies between 0 and 1 of the link's");
    j.refuse("scale", !(scale > 0.0 && scale <= 1.0), problem)?;
    let problem = format!("is {ramp_m} m; two of them must be shorter than the joint of {length_m} m");
    j.refuse("ramp", 2.0 * ramp_m >= length_m, problem)?;
    let problem = format!("is {length_m} m; it must be shorter than the link from joint to joint, {pitch_m} m");
    j.refuse("length", length_m >= pitch_m, problem)?;
    Ok(neck)
}

fn ellipsoid(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "semi_axis_x", "semi_axis_y", "semi_axis_z", CENTRE_OF_GRAVITY])?;
    Ok(Shape::Ellipsoid { semi_axes_m: [need(s, "semi_axis_x")?, need(s, "semi_axis_y")?, need(s, "semi_axis_z")?] })
}

fn capsule(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "length", "major_semi_axis", "minor_semi_axis", "ends", CENTRE_OF_GRAVITY])?;
    let (length_m, end_m) = (need(s, "length")?, end(s)?);
    let problem = format!(
        "is {length_m} m from tip to tip; two ends of {end_m} m leave no cylinder; write shape = \"ellipsoid\""
    );
    s.refuse("length", 2.0 * end_m >= length_m, problem)?;
    Ok(Shape::Capsule { length_m, section: semi_axes(s)?, end_m })
}

fn cylinder(s: &Section<'_>) -> Result<Shape, RecordError> {
    s.only(&["shape", "length", "major_semi_axis", "minor_semi_axis", CENTRE_OF_GRAVITY])?;
    Ok(Shape::Cylinder { length_m: need(s, "length")?, section: semi_axes(s)? })
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

    fn body(text: &str) -> Result<BodyFile, RecordError> {
        parse_body(Path::new("body.toml"), text)
    }

    #[test]
    fn a_robot_is_read() {
        let read = body(ROBOT).unwrap();
        assert_eq!((read.density_kg_m3, read.shape), (Some(1025.0), Shape::Robot(Robot::NECKED_MAMBA)));
    }

    #[test]
    fn what_cannot_be_is_reported_with_its_place() {
        let refused = |from: &str, to: &str| body(&ROBOT.replace(from, to)).unwrap_err().to_string();
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
        assert_eq!(body(ROBOT).unwrap().centre_of_gravity_m, None);
        let with = ROBOT.replace("ends =", "centre_of_gravity = [\"0 m\", \"1 cm\", \"-12 mm\"]\nends =");
        assert_eq!(body(&with).unwrap().centre_of_gravity_m, Some([0.0, 0.01, -0.012]));
    }
}
