//! URDF: a serial chain of links with revolute joints, as other robot programs describe it.
//!
//! A URDF says nothing of the water: the sidecar of the same name (`.toml`) is a robot file without what the URDF has.
//!
//! ```toml
//! schema = 1
//! [fluid]
//! density = "1025 kg/m^3"
//! [coefficients]
//! drag = { record = "tank.json", select = "tank/f2" }
//! added_mass = { sway = "1.653 kg", yaw = "4.463e-3 kg m^2" }
//! [[module]]                         # one for each link of the URDF, in any order
//! name = "head"                      # of the link
//! major_semi_axis = "58.8 mm"        # vertical
//! minor_semi_axis = "39.4 mm"
//! half_length = "90 mm"              # of head and tail; that of the others lies between their joints
//! volume = "1.31e-3 m^3"             # may be left out
//! ```
//!
//! **Frames.** The root is the head. x of each link points to the head, z up, and each link but the head begins at its joint: the next joint lies at (−length, 0, 0). Origins are not turned (`rpy` zero), axes are (0, 0, ±1): the chain lies in a plane.
//! **Units.** SI, rad, as URDF has them. **Source.** wiki.ros.org/urdf/XML.

use std::path::Path;

use froude_hydro::Link;
use roxmltree::{Document, Node, ParsingOptions};

use super::spatial::SpatialModule;
use super::{JointFile, MOST_MODULES, ModuleFile};
use crate::body::need;
use crate::error::{Place, RecordError};
use crate::section::{Section, found};
use crate::units::{Dimension, is_plausible};

/// Most nodes of a document.
const MOST_NODES: u32 = 200_000;
/// Of a length, m, a sine or a component of an axis, what is none.
const NONE: f64 = 1e-6;
/// A length that is written twice agrees to this part.
const SAME: f64 = 0.01;

/// A link.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    /// Its name.
    pub name: String,
    /// kg.
    pub mass_kg: f64,
    /// About its centre of mass, about x, y and z, kg m².
    pub inertia_kg_m2: [f64; 3],
    /// Centre of mass in its frame, m.
    pub centre_of_mass_m: [f64; 3],
    /// Where its next joint lies along x, m; `None` of the tail.
    pub next_m: Option<f64>,
    /// The joint to its next; that of the tail says nothing.
    pub joint: JointFile,
}

/// The links of a URDF, from the head.
///
/// # Errors
///
/// [`RecordError`] with line and column: not XML, a link without a mass, a joint that is not revolute or not about z, a tree that is not one chain.
pub fn parse_urdf(path: &Path, text: &str) -> Result<Vec<UrdfLink>, RecordError> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        let problem = format!("the text is not XML: {error}");
        RecordError::Syntax { place: Place::character(path, at.row as usize, at.col as usize), problem }
    })?;
    let file = File { path, document: &document };
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let problem = format!("begins with <{}>, and a URDF with <robot>", root.tag_name().name());
        return Err(file.wrong(root, "robot", problem));
    }
    let named = |tag: &'static str| root.children().filter(move |n| n.has_tag_name(tag));
    let links: Vec<Node<'_, '_>> = named("link").collect();
    if !(2..=MOST_MODULES as usize).contains(&links.len()) {
        let problem = format!("has {} links; a chain has 2 at least and {MOST_MODULES} at most", links.len());
        return Err(file.wrong(root, "robot", problem));
    }
    let mut names = Vec::with_capacity(links.len());
    for link in &links {
        let name = file.text(*link, "name")?;
        if names.contains(&name) {
            return Err(file.wrong(*link, "link", format!("{name:?} is there twice")));
        }
        names.push(name);
    }
    let at = |joint: Node<'_, '_>, tag: &'static str| {
        let end = file.child(joint, tag)?;
        let name = file.text(end, "link")?;
        let unknown = || file.wrong(end, tag, format!("is {name:?}, and no link is called so"));
        names.iter().position(|n| *n == name).ok_or_else(unknown)
    };
    let (mut next, mut is_child) = (vec![None; links.len()], vec![false; links.len()]);
    for joint in named("joint") {
        let (parent, child) = (at(joint, "parent")?, at(joint, "child")?);
        if next[parent].is_some() || is_child[child] {
            let which = if is_child[child] { names[child] } else { names[parent] };
            let problem = format!("branches at link {which:?}; a chain has one link behind each");
            return Err(file.wrong(joint, "joint", problem));
        }
        (next[parent], is_child[child]) = (Some((child, joint)), true);
    }
    let mut heads = (0..links.len()).filter(|i| !is_child[*i]);
    let (Some(head), None) = (heads.next(), heads.next()) else {
        let problem = "is not one chain: exactly one link, the head, hangs on no other".to_owned();
        return Err(file.wrong(root, "robot", problem));
    };
    let mut chain = Vec::with_capacity(links.len());
    let mut here = Some(head);
    while let Some(i) = here {
        let (next_m, joint) = match next[i] {
            Some((_, joint)) => file.joint(joint).map(|(at, limits)| (Some(at), limits))?,
            None => (None, JointFile::default()),
        };
        chain.push(file.link(links[i], names[i], next_m, joint)?);
        here = next[i].map(|(child, _)| child);
    }
    if chain.len() < links.len() {
        let problem = "is not one chain: some links hang on one another in a ring".to_owned();
        return Err(file.wrong(root, "robot", problem));
    }
    Ok(chain)
}

/// Modules of a sidecar for the links of a URDF.
pub(super) fn modules(root: &Section<'_>, chain: &[UrdfLink]) -> Result<Vec<ModuleFile>, RecordError> {
    let sections = root.sections("module")?;
    let mut known = Vec::with_capacity(sections.len());
    for s in &sections {
        s.only(&["name", "major_semi_axis", "minor_semi_axis", "half_length", "volume"])?;
        let name = s.text("name")?.ok_or_else(|| s.missing("name", "write that of a link of the URDF"))?;
        if !chain.iter().any(|link| link.name == name) || known.contains(&name) {
            let names: Vec<&str> = chain.iter().map(|link| link.name.as_str()).collect();
            let problem = format!("is {name:?}, of which there is one for each link of the URDF: {}", names.join(", "));
            return Err(RecordError::Value { place: s.place(), key: "name".to_owned(), problem });
        }
        known.push(name);
    }
    let of = |(i, link): (usize, &UrdfLink)| {
        let Some(at) = known.iter().position(|name| *name == link.name) else {
            let advice = format!("the link {:?} of the URDF has none: write one with its name", link.name);
            return Err(root.missing("module", &advice));
        };
        module(&sections[at], link, i == 0)
    };
    chain.iter().enumerate().map(of).collect()
}

fn module(s: &Section<'_>, link: &UrdfLink, is_head: bool) -> Result<ModuleFile, RecordError> {
    let between = link.next_m.filter(|_| !is_head).map(|next| 0.5 * next.abs());
    let half_length_m = match (between, s.get("half_length")) {
        (None, _) => need(s, "half_length")?,
        (Some(between), None) => between,
        (Some(between), Some(value)) => {
            if (need(s, "half_length")? / between - 1.0).abs() > SAME {
                let problem = format!(
                    "is {}, and the joints of the URDF are {} m apart; leave it out",
                    found(value),
                    2.0 * between
                );
                return Err(s.wrong("half_length", value, problem));
            }
            between
        }
    };
    // The head ends at its joint, wherever its frame is; the others begin at theirs.
    let centre_m = if is_head { link.next_m.unwrap_or(0.0) + half_length_m } else { -half_length_m };
    let [x, y, z] = link.centre_of_mass_m;
    let ahead_m = x - centre_m;
    if ahead_m.abs() > half_length_m {
        let problem = format!(
            "of {half_length_m} m leaves the centre of mass of link {:?} outside of the module, {ahead_m:.4} m ahead of its centre",
            link.name
        );
        return Err(RecordError::Value { place: s.place(), key: "half_length".to_owned(), problem });
    }
    Ok(ModuleFile {
        name: link.name.clone(),
        link: Link {
            major_semi_axis_m: need(s, "major_semi_axis")?,
            minor_semi_axis_m: need(s, "minor_semi_axis")?,
            half_length_m,
        },
        mass_kg: link.mass_kg,
        inertia_kg_m2: link.inertia_kg_m2[2],
        ahead_m,
        volume_m3: s.positive("volume", Dimension::VOLUME)?,
        spatial: SpatialModule {
            // y to port and z up there, to starboard and down here.
            centre_of_mass_m: [ahead_m, -y, -z],
            centre_of_buoyancy_m: [0.0; 3],
            inertia_kg_m2: link.inertia_kg_m2,
            added: None,
        },
    })
}

struct File<'a, 'i> {
    path: &'a Path,
    document: &'a Document<'i>,
}

impl File<'_, '_> {
    fn wrong(&self, node: Node<'_, '_>, key: &str, problem: String) -> RecordError {
        let at = self.document.text_pos_at(node.range().start);
        let place = Place::character(self.path, at.row as usize, at.col as usize);
        RecordError::Value { place, key: key.to_owned(), problem }
    }

    fn text<'n>(&self, node: Node<'n, '_>, name: &str) -> Result<&'n str, RecordError> {
        let tag = node.tag_name().name();
        node.attribute(name).ok_or_else(|| self.wrong(node, tag, format!("has no {name}")))
    }

    fn child<'n, 'i>(&self, node: Node<'n, 'i>, tag: &str) -> Result<Node<'n, 'i>, RecordError> {
        let own = node.tag_name().name();
        let found = node.children().find(|n| n.has_tag_name(tag));
        found.ok_or_else(|| self.wrong(node, own, format!("has no <{tag}>")))
    }

    fn number(&self, node: Node<'_, '_>, name: &str) -> Result<f64, RecordError> {
        let text = self.text(node, name)?;
        let number: Option<f64> = text.trim().parse().ok().filter(|x| is_plausible(*x));
        number.ok_or_else(|| self.wrong(node, name, format!("is {text:?}; expected a number in SI")))
    }

    /// Three numbers, zero where they are left out.
    fn three(&self, node: Node<'_, '_>, name: &str) -> Result<[f64; 3], RecordError> {
        let Some(text) = node.attribute(name) else { return Ok([0.0; 3]) };
        let numbers: Vec<f64> =
            text.split_whitespace().filter_map(|x| x.parse().ok()).filter(|x| is_plausible(*x)).collect();
        match numbers[..] {
            [a, b, c] if text.split_whitespace().count() == 3 => Ok([a, b, c]),
            _ => Err(self.wrong(node, name, format!("is {text:?}; expected three numbers"))),
        }
    }

    /// Where something lies, in axes that are not turned.
    fn origin(&self, node: Node<'_, '_>) -> Result<[f64; 3], RecordError> {
        let Some(origin) = node.children().find(|n| n.has_tag_name("origin")) else { return Ok([0.0; 3]) };
        let turned = self.three(origin, "rpy")?;
        if turned.iter().any(|x| x.abs() > NONE) {
            let problem = format!(
                "is {turned:?}, and frames that are turned are not read: write the URDF with all axes alike, x to the head, z up"
            );
            return Err(self.wrong(origin, "rpy", problem));
        }
        self.three(origin, "xyz")
    }

    /// Where a joint lies along x, with its limits.
    fn joint(&self, joint: Node<'_, '_>) -> Result<(f64, JointFile), RecordError> {
        let kind = self.text(joint, "type")?;
        if !["revolute", "continuous"].contains(&kind) {
            let problem = format!(
                "is {kind:?}; joints of a chain are revolute or continuous{}",
                if kind == "fixed" { ": make one link of the two that it joins" } else { "" }
            );
            return Err(self.wrong(joint, "type", problem));
        }
        // Left out it is (1, 0, 0).
        let axis = joint.children().find(|n| n.has_tag_name("axis"));
        let direction = axis.map_or(Ok([1.0, 0.0, 0.0]), |axis| self.three(axis, "xyz"))?;
        if direction[0].abs() > NONE || direction[1].abs() > NONE || (direction[2] - 1.0).abs() > NONE {
            let problem = format!("is {direction:?}; in a plane all joints turn about z: write xyz=\"0 0 1\"");
            return Err(self.wrong(axis.unwrap_or(joint), "axis", problem));
        }
        let [x, y, z] = self.origin(joint)?;
        if x >= -NONE || y.abs() > NONE || z.abs() > NONE {
            let problem = format!(
                "is ({x}, {y}, {z}); the joint of the next link lies behind its own on the x axis: (−length, 0, 0)"
            );
            return Err(self.wrong(joint, "origin", problem));
        }
        let Some(limit) = joint.children().find(|n| n.has_tag_name("limit")) else {
            return if kind == "revolute" {
                Err(self.wrong(
                    joint,
                    "joint",
                    "is revolute and has no <limit>; without one it is continuous".to_owned(),
                ))
            } else {
                Ok((x, JointFile::default()))
            };
        };
        let mut found = JointFile::default();
        if kind == "revolute" {
            let [lower, upper] = [self.number(limit, "lower")?, self.number(limit, "upper")?];
            if upper <= 0.0 || (upper + lower).abs() > NONE * upper {
                let problem = format!(
                    "is from {lower} to {upper}; an angle is limited alike to both sides: write the smaller one for both"
                );
                return Err(self.wrong(limit, "limit", problem));
            }
            found.limit_rad = Some(upper);
        }
        for (name, place) in [("velocity", &mut found.rate_rad_s), ("effort", &mut found.torque_n_m)] {
            if limit.has_attribute(name) {
                let number = self.number(limit, name)?;
                if number <= 0.0 {
                    return Err(self.wrong(
                        limit,
                        name,
                        format!("is {number}; write what the drive gives, above zero, or leave it out"),
                    ));
                }
                *place = Some(number);
            }
        }
        Ok((x, found))
    }

    fn link(
        &self,
        link: Node<'_, '_>,
        name: &str,
        next_m: Option<f64>,
        joint: JointFile,
    ) -> Result<UrdfLink, RecordError> {
        let inertial = self.child(link, "inertial")?;
        let positive = |node: Node<'_, '_>, key: &str| {
            let number = self.number(node, key)?;
            if number > 0.0 {
                Ok(number)
            } else {
                Err(self.wrong(node, key, format!("is {number}; expected more than zero")))
            }
        };
        let mass_kg = positive(self.child(inertial, "mass")?, "value")?;
        let inertia = self.child(inertial, "inertia")?;
        let mut inertia_kg_m2 = [0.0; 3];
        for (own, key) in inertia_kg_m2.iter_mut().zip(["ixx", "iyy", "izz"]) {
            *own = positive(inertia, key)?;
        }
        let centre_of_mass_m = self.origin(inertial)?;
        if centre_of_mass_m[1].abs() > NONE {
            let problem =
                format!("lies {} m beside the x axis, which a chain in a plane does not have", centre_of_mass_m[1]);
            return Err(self.wrong(inertial, "origin", problem));
        }
        Ok(UrdfLink { name: name.to_owned(), mass_kg, inertia_kg_m2, centre_of_mass_m, next_m, joint })
    }
}
