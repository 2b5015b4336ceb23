//! What is asked of a body or a mesh, read from its options as they were written, at the command line or in a campaign.

use std::path::{Path, PathBuf};

use froude_panel::refine::Wanted;
use froude_records::campaign::Source;
use froude_records::given_option::GivenOption;
use froude_records::plausible;
use froude_records::units::{Dimension, is_plausible, parse_quantity, parse_unit};

use crate::error::AddedMassError;
use crate::frame::{Axes, Direction, Orientation, Point};
use crate::option_list::given;

/// Links at most: more are a slip of the keyboard.
const MOST_LINKS: usize = 100;

/// What to compute.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Asked {
    /// A body file (.toml) or a mesh.
    pub input: PathBuf,
    /// Numbers of links of a robot: one for its matrix, several for a table with its least squares; none of another body.
    pub links: Vec<usize>,
    /// Density instead of the file's, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// Axes of the result.
    pub axes: Axes,
    /// Where moments are taken about; `None` where nobody said: the origin of the mesh.
    pub at: Option<Point>,
    /// Metres for a unit of the mesh; `None` where it is not stated.
    pub unit_m: Option<f64>,
    /// Length of the body over that of the mesh, where it is a model of what was drawn; `None` where it is not.
    pub model_scale: Option<f64>,
    /// How the mesh lies; `None` where nobody said: x forward, z up.
    pub orientation: Option<Orientation>,
    /// Height of the water's surface over the origin of the mesh, m; `None`: deeply submerged.
    pub surface_m: Option<f64>,
    /// Length, breadth and depth of water of a tank with the origin in the middle of its plan, m.
    pub tank_m: Option<[f64; 3]>,
    /// Whether the facets of a mesh are the body itself.
    pub is_polyhedron: bool,
    /// Whether they are those of a smooth body; where neither is said, the intervals contain both.
    pub is_smooth: bool,
    /// What moves apart; `None` for one rigid body.
    pub apart: Option<Apart>,
    /// Tolerance and limits.
    pub wanted: Wanted,
    /// Files to write beside the record: `1`, `nc`, `csv`.
    pub export: Vec<&'static str>,
}

impl Asked {
    /// What a source asks of a body or a mesh.
    ///
    /// # Errors
    ///
    /// As [`Asked::read`]; a section of the source that is wrong.
    pub fn of_source(input: &Path, source: &Source) -> Result<Self, AddedMassError> {
        Self::read(input, &given(source)?)
    }

    /// Nothing but the input.
    #[must_use]
    pub fn of(input: &Path) -> Self {
        Self { input: input.to_owned(), ..Self::default() }
    }

    /// What was given, read.
    ///
    /// # Errors
    ///
    /// [`AddedMassError::Refused`] for a text that says nothing, and for options that do not go with each other.
    pub fn read(input: &Path, given: &[GivenOption]) -> Result<Self, AddedMassError> {
        let mut out = Self::of(input);
        let (mut forward, mut up) = (None, None);
        for option in given {
            let text = option.text.as_str();
            let mut read = || -> Result<(), String> {
                match option.name.as_str() {
                    "links" => out.links = link_numbers(text)?,
                    "density" => out.density_kg_m3 = Some(density(text)?),
                    "axes" => out.axes = axes(text)?,
                    "at" => out.at = Some(point(text)?),
                    "unit" => (out.unit_m, out.model_scale) = unit(text)?,
                    "forward" => forward = Some(direction(text)?),
                    "up" => up = Some(direction(text)?),
                    "tolerance" => out.wanted.tolerance = ratio(text)?,
                    "most_panels" => out.wanted.most_panels = panels(text)?,
                    "surface" => out.surface_m = Some(quantity(text, Dimension::LENGTH)?),
                    "tank" => out.tank_m = Some(tank(text)?),
                    "joint_angle" => out.apart = Some(Apart::Links { joint_angle_rad: angle(text)? }),
                    "chain" => out.apart = out.apart.or(Some(Apart::Links { joint_angle_rad: 0.0 })),
                    "apart" => out.apart = out.apart.or(Some(Apart::Parts)),
                    "polyhedron" => out.is_polyhedron = true,
                    "smooth" => out.is_smooth = true,
                    "export" => out.export = exports(text)?,
                    other => return Err(format!("there is no option {other:?}")),
                }
                Ok(())
            };
            read().map_err(|why| AddedMassError::option(option, why))?;
        }
        // A chain goes before parts, wherever it stands.
        if let (Some(Apart::Parts), true) = (out.apart, given.iter().any(|option| option.name == "chain")) {
            out.apart = Some(Apart::Links { joint_angle_rad: 0.0 });
        }
        out.orientation = orientation(forward, up)?;
        out.go_together(given)?;
        Ok(out)
    }

    /// Refuses options that say nothing without another, or beside it.
    fn go_together(&self, given: &[GivenOption]) -> Result<(), AddedMassError> {
        let why = if self.tank_m.is_some() && self.surface_m.is_none() {
            "--tank says how deep the water is, and not where the body lies in it: add --surface, the height of the water's surface over the origin \
             of the mesh, such as --surface \"0.5 m\""
        } else if self.links.len() > 1 {
            // What has no meaning for several numbers of links is refused, not passed over.
            const OF_ONE: [&str; 11] = [
                "at",
                "unit",
                "forward",
                "up",
                "surface",
                "export",
                "chain",
                "joint_angle",
                "apart",
                "polyhedron",
                "smooth",
            ];
            let Some(name) = OF_ONE.into_iter().find(|name| given.iter().any(|option| option.name == *name)) else {
                return Ok(());
            };
            let option = name.replace('_', "-");
            let why = format!("--{option} is for one body; give one number of links with it: --links 3");
            return Err(AddedMassError::Refused(why));
        } else if self.apart.is_some() && self.surface_m.is_some() {
            "--surface goes with one rigid body, not with --chain or --apart"
        } else if self.is_smooth && self.is_polyhedron {
            "--smooth and --polyhedron contradict each other: give one of them"
        } else if self.apart.is_some() && self.at.is_some() {
            "--at goes with one rigid body; with --chain or --apart every part is about its own point"
        } else {
            return Ok(());
        };
        Err(AddedMassError::Refused(why.to_owned()))
    }
}

fn quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    let usual = match dimension {
        Dimension::DENSITY => "kg/m^3",
        Dimension::LENGTH => "m",
        _ => "%",
    };
    quantity_as(text, dimension, usual)
}

/// A quantity whose unit is usually this one.
fn quantity_as(text: &str, dimension: Dimension, usual: &str) -> Result<f64, String> {
    let q = parse_quantity(text).map_err(|e| e.expecting(text, dimension, usual).to_string())?;
    q.expect(dimension).map_err(|e| e.to_string())
}

fn positive(text: &str, dimension: Dimension) -> Result<f64, String> {
    match quantity(text, dimension)? {
        x if x > 0.0 => Ok(x),
        _ => Err("it must be larger than zero".to_owned()),
    }
}

/// A length above zero: how close vertices are that a repair makes one.
///
/// # Errors
///
/// [`AddedMassError::Refused`].
pub fn weld_m(text: &str) -> Result<f64, AddedMassError> {
    positive(text, Dimension::LENGTH).map_err(|why| {
        let given = GivenOption { name: "weld".to_owned(), text: text.to_owned(), place: None };
        AddedMassError::option(&given, why)
    })
}

/// A density of water, or 1 kg/m³ for added mass over ρ.
fn density(text: &str) -> Result<f64, String> {
    let rho = positive(text, Dimension::DENSITY)?;
    match plausible::density_of_displaced_water(rho) {
        Some(problem) => Err(format!("it {problem}")),
        None => Ok(rho),
    }
}

fn angle(text: &str) -> Result<f64, String> {
    quantity_as(text, Dimension::ANGLE, "deg")
}

fn ratio(text: &str) -> Result<f64, String> {
    match quantity(text, Dimension::ONE)? {
        x if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err("write a part above 0 and below 100 %: \"1 %\"".to_owned()),
    }
}

fn panels(text: &str) -> Result<usize, String> {
    text.trim().parse().map_err(|_| "write a whole number of panels, such as 120000".to_owned())
}

/// Metres for a unit (`mm`, `0.5 m`) and the scale of a model (`1:50`, `1:50 mm`).
fn unit(text: &str) -> Result<(Option<f64>, Option<f64>), String> {
    let wrong = || {
        "write the unit of the mesh: mm, cm, m, in, ft, or a length, \"0.5 m\"; or a scale: 1:50 if the mesh is full-size and the body is a model (\"1:50 mm\": mesh in millimetres), 50:1 if the mesh is model-size and the body is full-size"
            .to_owned()
    };
    let length = |text: &str| {
        let named =
            parse_unit(text).ok().filter(|unit| unit.dimension == Dimension::LENGTH).map(|unit| unit.to_si(1.0));
        named.or_else(|| quantity(text, Dimension::LENGTH).ok()).filter(|m| *m > 0.0).ok_or_else(wrong)
    };
    let Some((model, rest)) = text.trim().split_once(':') else { return Ok((Some(length(text.trim())?), None)) };
    let rest = rest.trim();
    let end = rest.find(|c: char| !matches!(c, '0'..='9' | '.')).unwrap_or(rest.len());
    let (full, name) = rest.split_at(end);
    let one = |text: &str| text.trim().parse::<f64>().ok().filter(|x| is_plausible(*x) && *x > 0.0).ok_or_else(wrong);
    let unit_m = if name.is_empty() { None } else { Some(length(name.trim())?) };
    Ok((unit_m, Some(one(model)? / one(full)?)))
}

/// How `--unit` writes a unit of so many metres.
#[must_use]
pub fn unit_of(metres: f64) -> String {
    let named = ["mm", "cm", "m", "in", "ft"].into_iter().find(|name| unit(name).is_ok_and(|(m, _)| m == Some(metres)));
    named.map_or_else(|| format!("\"{metres:?} m\""), str::to_owned)
}

/// `3`, `1..9` (both ends), `1,3,6`.
fn link_numbers(text: &str) -> Result<Vec<usize>, String> {
    let bad = || format!("write a number of links, \"1..9\" or \"1,3,6\", between 1 and {MOST_LINKS}");
    let one = |t: &str| t.trim().parse::<usize>().ok().filter(|n| (1..=MOST_LINKS).contains(n)).ok_or_else(bad);
    if let Some((from, to)) = text.split_once("..") {
        let (from, to) = (one(from)?, one(to.trim_start_matches('='))?);
        return if from <= to { Ok((from..=to).collect()) } else { Err(bad()) };
    }
    let mut out = text.split(',').map(one).collect::<Result<Vec<_>, _>>()?;
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

fn axes(text: &str) -> Result<Axes, String> {
    match text {
        "ned" | "fossen" => Ok(Axes::Ned),
        "enu" => Ok(Axes::Enu),
        _ => Err("write ned, fossen or enu".to_owned()),
    }
}

/// What to write instead of options under their former names `--z` and `--origin`, with the values that they were given; `None` of neither.
#[must_use]
pub fn renamed(z: Option<&str>, origin: Option<&str>) -> Option<String> {
    if let Some(z) = z {
        let up = if z == "down" { "--up -z" } else { "--up z" };
        return Some(format!(
            "--z is now --up: write {up} for how the mesh lies, and --axes ned or enu for the axes of the result"
        ));
    }
    let origin = origin?;
    let at = if origin.trim() == "buoyancy" { "cb".to_owned() } else { format!("{origin:?}") };
    Some(format!("--origin is now --at: write --at {at}"))
}

fn direction(text: &str) -> Result<Direction, String> {
    let axis = ["x", "y", "z"].iter().position(|letter| text.trim_start_matches('-') == *letter);
    axis.filter(|_| !text.starts_with("--"))
        .map(|axis| Direction { axis, is_against: text.starts_with('-') })
        .ok_or_else(|| "write x, -x, y, -y, z or -z".to_owned())
}

/// How a mesh lies, where it was said.
fn orientation(forward: Option<Direction>, up: Option<Direction>) -> Result<Option<Orientation>, AddedMassError> {
    if forward.is_none() && up.is_none() {
        return Ok(None);
    }
    let (forward, up) = (forward.unwrap_or(Direction::X), up.unwrap_or(Direction::Z));
    Orientation::new(forward, up).map(Some).ok_or_else(|| {
        AddedMassError::Refused(format!(
            "--forward {forward} and --up {up} lie along one axis of the mesh: give both, two different ones"
        ))
    })
}

/// `cg`, `cb`, or three lengths.
fn point(text: &str) -> Result<Point, String> {
    match text.trim() {
        "cg" => return Ok(Point::Gravity),
        "cb" => return Ok(Point::Buoyancy),
        _ => {}
    }
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else {
        return Err("write cg, cb, or three lengths: \"0 m, 0 m, -0.2 m\"".to_owned());
    };
    let length = |t: &str| quantity(t.trim(), Dimension::LENGTH);
    Ok(Point::At([length(x)?, length(y)?, length(z)?]))
}

/// Length, breadth, depth of water: `1.5 m x 0.9 m x 1 m`.
fn tank(text: &str) -> Result<[f64; 3], String> {
    let sides: Vec<&str> = text.split(['x', '×']).collect();
    let [l, b, d] = sides[..] else {
        return Err("write length, breadth and depth of water: \"1.5 m x 0.9 m x 1 m\"".to_owned());
    };
    let side = |t: &str| positive(t.trim(), Dimension::LENGTH);
    Ok([side(l)?, side(b)?, side(d)?])
}

/// Formats by the ends of their files' names.
fn exports(text: &str) -> Result<Vec<&'static str>, String> {
    let one = |word: &str| match word.trim() {
        "wamit" => Ok("1"),
        "capytaine" => Ok("nc"),
        "csv" => Ok("csv"),
        other => Err(format!("{other:?} is no format; there are wamit, capytaine and csv")),
    };
    let mut out = Vec::new();
    for extension in text.split(',').map(one) {
        let extension = extension?;
        if !out.contains(&extension) {
            out.push(extension);
        }
    }
    Ok(out)
}

/// What moves apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Apart {
    /// Links of a robot, its joints bent by this angle, rad.
    Links {
        /// About z, the same at every joint.
        joint_angle_rad: f64,
    },
    /// Parts of a mesh that do not hang together.
    Parts,
}
