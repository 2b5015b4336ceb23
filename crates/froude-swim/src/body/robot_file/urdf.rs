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
//! **Rigid bodies.** Links that fixed joints hold together are one module: their masses and inertias are added in its frame (parallel axes, turned tensors). A module names any one of them. Links without mass,
//! such as a `world` above the head, may be among them.
//!
//! **Frames.** The root is in the head. x of each module points to the head, z up, and each module but the head begins at its joint: the next joint lies at (−length, 0, 0) in axes that are not rotated. Axes are (0, 0, ±1):
//! the chain lies in a plane. The frame of a module is that of the link behind its joint; of the head, that of its first link whose axes are those of the link behind it.
//!
//! **Signs.** φ of a joint is the URDF's angle where its axis points up, and minus that where it points down.
//!
//! **Units.** SI, rad, as URDF has them. **Source.** wiki.ros.org/urdf/XML.

use std::path::Path;

use froude_hydro::Link;
use froude_records::body::need;
use froude_records::section::{Section, found};
use froude_records::text::counted;
use froude_records::units::{Dimension, is_plausible};
use froude_records::{Place, RecordError};
use indexmap::IndexMap;
use roxmltree::{Document, Node, ParsingOptions};

use super::{MOST_MODULES, ModuleFile};
use crate::joints::Limits;

/// Most nodes of a document.
const MOST_NODES: u32 = 200_000;
/// Directions that differ by less, rad, are the same: π written as 3.142 is off by 4e-4, and a robot is not built to a tenth of that of a degree.
const TURNED: f64 = 1e-3;
/// A centre of mass may lie beside the axis by this, m: with π written as 3.1416 a mass 1 m away is off by 7e-6 m.
const BESIDE_M: f64 = 1e-5;
/// A length that is written twice agrees to this part.
const SAME: f64 = 0.01;

/// A module: the links of a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    /// Its first link that has a mass.
    pub name: String,
    /// The links that fixed joints hold together, with their masses, kg; [`UrdfLink::name`] is among them.
    pub links: Vec<(String, f64)>,
    /// kg.
    pub mass_kg: f64,
    /// About its centre of mass, about x, y and z, kg m².
    pub inertia_kg_m2: [f64; 3],
    /// Centre of mass in its frame, m.
    pub centre_of_mass_m: [f64; 3],
    /// Where its next joint lies along x, m; `None` of the tail.
    pub next_m: Option<f64>,
    /// The joint to its next; that of the tail says nothing.
    pub limits: Limits,
    /// The name of that joint, where its axis points down.
    pub turns_down: Option<String>,
}

/// The modules of a URDF, from the head.
///
/// # Errors
///
/// [`RecordError`] with line and column: not XML, a body without a mass, a joint that is neither fixed nor turns about z, bodies that are not one chain.
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
    let tree = Tree::of(&file, root)?;
    let mut bodies: Vec<Body<'_, '_>> = Vec::new();
    let (mut next, mut seen) = (Some(tree.root), 0);
    while let Some(first) = next {
        let body = tree.body(&file, first, bodies.is_empty())?;
        seen += body.parts.len();
        next = body.joint.as_ref().map(|joint| joint.child);
        bodies.push(body);
    }
    if seen < tree.links.len() {
        return Err(file.wrong(root, "robot", "is not one chain: some links form a closed loop".to_owned()));
    }
    if !(2..=MOST_MODULES as usize).contains(&bodies.len()) {
        let bodies = counted(bodies.len(), "rigid body", "rigid bodies");
        let problem =
            format!("is a chain of {bodies}; expected 2 to {MOST_MODULES}, with a revolute joint between each two");
        return Err(file.wrong(root, "robot", problem));
    }
    bodies.iter().map(|body| body.module(&file)).collect()
}

/// Links with the joints that lead away from each.
struct Tree<'n, 'i> {
    links: Vec<(&'n str, Node<'n, 'i>)>,
    /// Of each link: its joints, with the links that they lead to.
    joints: Vec<Vec<(Node<'n, 'i>, usize)>>,
    root: usize,
}

impl<'n, 'i> Tree<'n, 'i> {
    fn of(file: &File<'_, '_>, robot: Node<'n, 'i>) -> Result<Self, RecordError> {
        let named = |tag: &'static str| robot.children().filter(move |n| n.has_tag_name(tag));
        let (mut links, mut places) = (Vec::new(), IndexMap::new());
        for link in named("link") {
            let name = file.text(link, "name")?;
            if places.insert(name, links.len()).is_some() {
                return Err(file.wrong(link, "link", format!("{name:?} is there twice")));
            }
            links.push((name, link));
        }
        let at = |joint: Node<'n, 'i>, tag: &'static str| {
            let end = file.child(joint, tag)?;
            let name = file.text(end, "link")?;
            let unknown = || file.wrong(end, tag, format!("is {name:?}, and there is no such link"));
            places.get(name).copied().ok_or_else(unknown)
        };
        let (mut joints, mut is_child) = (vec![Vec::new(); links.len()], vec![false; links.len()]);
        for joint in named("joint") {
            let (parent, child) = (at(joint, "parent")?, at(joint, "child")?);
            if is_child[child] {
                let problem = format!("gives link {:?} a second parent; a link has one", links[child].0);
                return Err(file.wrong(joint, "joint", problem));
            }
            is_child[child] = true;
            joints[parent].push((joint, child));
        }
        let roots: Vec<usize> = (0..links.len()).filter(|i| !is_child[*i]).collect();
        let [root] = roots[..] else {
            let problem = match roots[..] {
                [] => "has no root: expected one link, in the head, that has no parent".to_owned(),
                [a, b, ..] => format!(
                    "is not one chain: {:?} and {:?} both have no parent; expected one link, in the head, without",
                    links[a].0, links[b].0
                ),
                [_] => String::new(),
            };
            return Err(file.wrong(robot, "robot", problem));
        };
        Ok(Self { links, joints, root })
    }

    /// The rigid body whose first link is `first`, in its own frame.
    fn body(&self, file: &File<'_, '_>, first: usize, is_head: bool) -> Result<Body<'n, 'i>, RecordError> {
        let (mut parts, mut joint) = (Vec::new(), None::<JointPlace<'n, 'i>>);
        let mut open = vec![(first, Frame::default())];
        // Parents stand before their children, and children in the order of the file.
        while let Some((i, frame)) = open.pop() {
            let (name, node) = self.links[i];
            parts.push(Part { name, node, frame });
            for (node, child) in self.joints[i].iter().rev() {
                let place = frame.of(&file.origin(*node)?);
                if file.is_fixed(*node)? {
                    open.push((*child, place));
                } else if let Some(other) = joint.replace(JointPlace { node: *node, child: *child, frame: place }) {
                    let later = if other.node.range().start > node.range().start { other.node } else { *node };
                    let problem =
                        format!("branches at link {name:?}: a chain has one moving joint behind each rigid body");
                    return Err(file.wrong(later, "joint", problem));
                }
            }
        }
        let own = match &joint {
            Some(joint) if is_head => head_frame(&parts, &joint.frame),
            _ => None,
        };
        let own = own.unwrap_or_default();
        for part in &mut parts {
            part.frame = own.seen(&part.frame);
        }
        if let Some(joint) = &mut joint {
            joint.frame = own.seen(&joint.frame);
        }
        Ok(Body { parts, joint })
    }
}

/// The frame of the head, of those of its links: axes as at the joint, which lies behind on the x axis. Links with a mass come first, as a `world` may lie anywhere.
fn head_frame(parts: &[Part<'_, '_>], joint: &Frame) -> Option<Frame> {
    let is_heavy = |part: &&Part<'_, '_>| part.node.children().any(|n| n.has_tag_name("inertial"));
    let ordered = || parts.iter().filter(is_heavy).chain(parts).map(|part| part.frame);
    let is_behind = |frame: &Frame| {
        let [x, y, z] = frame.seen(joint).place_m;
        x < 0.0 && y.hypot(z) <= TURNED * x.abs()
    };
    let mut aligned = ordered().filter(|frame| frame.is_aligned(joint));
    aligned.clone().find(is_behind).or_else(|| aligned.next())
}

/// A joint that moves, with the link behind it and its frame in that of the body.
struct JointPlace<'n, 'i> {
    node: Node<'n, 'i>,
    child: usize,
    frame: Frame,
}

/// A link of a body.
struct Part<'n, 'i> {
    name: &'n str,
    node: Node<'n, 'i>,
    frame: Frame,
}

/// Links that fixed joints hold together, and the joint to the next such body.
struct Body<'n, 'i> {
    parts: Vec<Part<'n, 'i>>,
    joint: Option<JointPlace<'n, 'i>>,
}

impl Body<'_, '_> {
    fn module(&self, file: &File<'_, '_>) -> Result<UrdfLink, RecordError> {
        let mut rigid = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            rigid.push(file.rigid(part, self.parts.len() == 1)?);
        }
        let mass_kg: f64 = rigid.iter().map(|r| r.mass_kg).sum();
        // A body has a mass, be it in one link only.
        let heavy = rigid.iter().position(|r| r.mass_kg > 0.0);
        let first = &self.parts[heavy.unwrap_or(0)];
        let sum = |k: usize| rigid.iter().map(|r| r.mass_kg * r.centre_m[k]).sum::<f64>();
        let centre_of_mass_m = [0, 1, 2].map(|k| sum(k) / mass_kg);
        let inertia_kg_m2 = [0, 1, 2].map(|k| {
            let own = |r: &Rigid| {
                let [a, b] = [(k + 1) % 3, (k + 2) % 3].map(|j| r.centre_m[j] - centre_of_mass_m[j]);
                r.inertia_kg_m2[k] + r.mass_kg * (a * a + b * b)
            };
            rigid.iter().map(own).sum::<f64>()
        });
        if heavy.is_none() {
            let names: Vec<&str> = self.parts.iter().map(|part| part.name).collect();
            let problem = format!(
                "has no mass, and no link that is fixed to it has one ({}); write <inertial> in one of them",
                names.join(", ")
            );
            return Err(file.wrong(first.node, "link", problem));
        }
        if inertia_kg_m2.iter().any(|i| *i <= 0.0) {
            let problem = format!(
                "has a mass of {mass_kg} kg and inertias of {inertia_kg_m2:?} kg m² with all links that are fixed to it; expected values above zero"
            );
            return Err(file.wrong(first.node, "link", problem));
        }
        if centre_of_mass_m[1].abs() > BESIDE_M {
            let problem = format!(
                "the centre of mass lies {:.6} m beside the x axis, with all links that are fixed to it; a planar chain has its masses on the axis",
                centre_of_mass_m[1]
            );
            return Err(file.wrong(first.node, "inertial", problem));
        }
        let (next_m, limits, turns_down) = match &self.joint {
            Some(joint) => {
                let (next_m, limits, is_down) = file.joint(joint)?;
                let name = joint.node.attribute("name").unwrap_or("not named");
                (Some(next_m), limits, is_down.then(|| name.to_owned()))
            }
            None => (None, Limits::default(), None),
        };
        let masses = rigid.iter().map(|r| r.mass_kg);
        Ok(UrdfLink {
            name: first.name.to_owned(),
            links: self.parts.iter().map(|part| part.name.to_owned()).zip(masses).collect(),
            mass_kg,
            inertia_kg_m2,
            centre_of_mass_m,
            next_m,
            limits,
            turns_down,
        })
    }
}

/// Mass, centre of mass and inertia about it of a link, in the axes of its body.
struct Rigid {
    mass_kg: f64,
    centre_m: [f64; 3],
    /// About x, y and z.
    inertia_kg_m2: [f64; 3],
}

/// A frame in another: R and the place of its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    rotation: [[f64; 3]; 3],
    place_m: [f64; 3],
}

impl Default for Frame {
    fn default() -> Self {
        Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], place_m: [0.0; 3] }
    }
}

impl Frame {
    /// Of an `origin`: R = R_z(yaw) R_y(pitch) R_x(roll).
    fn new(rpy: [f64; 3], place_m: [f64; 3]) -> Self {
        let ([sr, sp, sy], [cr, cp, cy]) = (rpy.map(f64::sin), rpy.map(f64::cos));
        let rotation = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        Self { rotation, place_m }
    }

    fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    fn point(&self, v: [f64; 3]) -> [f64; 3] {
        let turned = self.turned(v);
        [0, 1, 2].map(|k| self.place_m[k] + turned[k])
    }

    /// A frame that is given in this one, where this one is given.
    fn of(&self, inner: &Self) -> Self {
        let column = |j: usize| self.turned([0, 1, 2].map(|k| inner.rotation[k][j]));
        let columns = [column(0), column(1), column(2)];
        Self { rotation: [0, 1, 2].map(|k| columns.map(|c| c[k])), place_m: self.point(inner.place_m) }
    }

    /// Another frame of where this one is given, in this one.
    fn seen(&self, other: &Self) -> Self {
        let back = Self { rotation: [0, 1, 2].map(|k| self.rotation.map(|row| row[k])), place_m: [0.0; 3] };
        back.of(&Self { place_m: [0, 1, 2].map(|k| other.place_m[k] - self.place_m[k]), ..*other })
    }

    /// Whether the axes of both point alike.
    fn is_aligned(&self, other: &Self) -> bool {
        let own = Self::default().rotation;
        let found = self.seen(other).rotation;
        (0..9).all(|k| (found[k / 3][k % 3] - own[k / 3][k % 3]).abs() <= TURNED)
    }
}

/// Modules of a sidecar for the bodies of a URDF.
pub(super) fn modules(root: &Section<'_>, chain: &[UrdfLink]) -> Result<Vec<ModuleFile>, RecordError> {
    let sections = root.sections("module")?;
    let mut body_of: IndexMap<&str, usize> = IndexMap::new();
    for (i, body) in chain.iter().enumerate() {
        body_of.extend(body.links.iter().map(|(name, _)| (name.as_str(), i)));
    }
    let mut known: Vec<Option<(usize, &str)>> = vec![None; chain.len()];
    for (k, s) in sections.iter().enumerate() {
        s.only(&["name", "major_semi_axis", "minor_semi_axis", "half_length", "volume"])?;
        let name = s.text("name")?.ok_or_else(|| s.missing("name", "write that of a link of the URDF"))?;
        let wrong = |problem: String| RecordError::Value { place: s.place(), key: "name".to_owned(), problem };
        let Some(body) = body_of.get(name) else {
            let names: Vec<&str> = chain.iter().map(|body| body.name.as_str()).collect();
            return Err(wrong(format!(
                "is {name:?}; expected a link of the URDF, one of each rigid body: {}",
                names.join(", ")
            )));
        };
        if let Some((_, other)) = known[*body] {
            return Err(wrong(format!(
                "the rigid body of {name:?} already has a module, {other:?}: write one for each body"
            )));
        }
        known[*body] = Some((k, name));
    }
    let of = |(i, body): (usize, &UrdfLink)| {
        let Some((k, name)) = known[i] else {
            let advice = format!("there is none for the link {:?} of the URDF: write one with its name", body.name);
            return Err(root.missing("module", &advice));
        };
        Ok(ModuleFile { name: name.to_owned(), ..module(&sections[k], body, i == 0)? })
    };
    chain.iter().enumerate().map(of).collect()
}

/// Links that were added to others, and joints whose sign is another than the URDF's.
pub(super) fn remarks(chain: &[UrdfLink]) -> Vec<String> {
    let mut out = Vec::new();
    for body in chain {
        let others = body.links.iter().filter(|(name, _)| *name != body.name);
        let others: Vec<String> = others.map(|(name, mass_kg)| format!("{name} ({mass_kg} kg)")).collect();
        if !others.is_empty() {
            let (is, counts) = if others.len() == 1 {
                ("is", "its mass and inertia count")
            } else {
                ("are", "their masses and inertias count")
            };
            out.push(format!("{} {is} fixed to {}: {counts} as part of it", others.join(", "), body.name));
        }
    }
    for (i, body) in chain.iter().enumerate() {
        if let Some(name) = &body.turns_down {
            let joint = i + 1;
            out.push(format!(
                "joint {joint} ({name}) turns about -z: phi_{joint} is minus its URDF angle; change its sign in recordings of URDF angles before they are read (trajectories hold phi_{joint})"
            ));
        }
    }
    out
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
        inertia_kg_m2: link.inertia_kg_m2,
        // URDF: y to port, z up.
        centre_of_mass_m: [ahead_m, -y, -z],
        centre_of_buoyancy_m: [0.0; 3],
        volume_m3: s.positive("volume", Dimension::VOLUME)?,
        neutral_within: s.half_digit("volume"),
        added: None,
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

    /// `origin`; where it is left out, that of the parent.
    fn origin(&self, node: Node<'_, '_>) -> Result<Frame, RecordError> {
        let Some(origin) = node.children().find(|n| n.has_tag_name("origin")) else { return Ok(Frame::default()) };
        Ok(Frame::new(self.three(origin, "rpy")?, self.three(origin, "xyz")?))
    }

    fn is_fixed(&self, joint: Node<'_, '_>) -> Result<bool, RecordError> {
        match self.text(joint, "type")? {
            "fixed" => Ok(true),
            "revolute" | "continuous" => Ok(false),
            kind => {
                let problem = format!("is {kind:?}; joints of a chain are revolute, continuous or fixed");
                Err(self.wrong(joint, "type", problem))
            }
        }
    }

    /// Where a joint lies along x, with its limits, and whether its axis points down.
    fn joint(
        &self,
        JointPlace { node: joint, frame, .. }: &JointPlace<'_, '_>,
    ) -> Result<(f64, Limits, bool), RecordError> {
        let joint = *joint;
        let kind = self.text(joint, "type")?;
        if !frame.is_aligned(&Frame::default()) {
            let [_, _, z] = frame.rotation;
            let problem = format!(
                "is rotated against the frame of the module before it (its z axis has the components {:.4}, {:.4}, {:.4} in x, y, z there), and rotated frames are not read: write the URDF with the axes of all moving links alike, x to the head, z up",
                frame.rotation[0][2], frame.rotation[1][2], z[2]
            );
            return Err(self.wrong(joint, "origin", problem));
        }
        // Left out it is (1, 0, 0).
        let axis = joint.children().find(|n| n.has_tag_name("axis"));
        let direction = axis.map_or(Ok([1.0, 0.0, 0.0]), |axis| self.three(axis, "xyz"))?;
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = direction.map(|x| x / length);
        // An axis without a length has no direction, and its components are NaN.
        let is_vertical = x.hypot(y) <= TURNED;
        if !is_vertical {
            let problem =
                format!("is {direction:?}; joints of a planar chain turn about z: write xyz=\"0 0 1\" or \"0 0 -1\"");
            return Err(self.wrong(axis.unwrap_or(joint), "axis", problem));
        }
        let is_down = z < 0.0;
        let [x, y, z] = frame.place_m;
        if !(x < 0.0 && y.hypot(z) <= TURNED * x.abs()) {
            let problem = format!(
                "is ({x}, {y}, {z}) in the frame of the module before it; the joint of the next link lies behind its own on the x axis: (−length, 0, 0)"
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
                Ok((x, Limits::default(), is_down))
            };
        };
        let mut found = Limits::default();
        if kind == "revolute" {
            let [lower, upper] = [self.number(limit, "lower")?, self.number(limit, "upper")?];
            if upper <= 0.0 || (upper + lower).abs() > TURNED * upper {
                let problem = format!(
                    "is from {lower} to {upper}; limits must be the same in both directions: write the smaller one for both"
                );
                return Err(self.wrong(limit, "limit", problem));
            }
            found.angle_rad = Some(upper.min(-lower));
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
        Ok((x, found, is_down))
    }

    /// Mass and inertia of a link; one of several in a body may have none.
    fn rigid(&self, part: &Part<'_, '_>, is_alone: bool) -> Result<Rigid, RecordError> {
        let inertial = part.node.children().find(|n| n.has_tag_name("inertial"));
        let Some(inertial) = inertial else {
            if is_alone {
                return Err(self.wrong(part.node, "link", "has no <inertial>".to_owned()));
            }
            return Ok(Rigid { mass_kg: 0.0, centre_m: part.frame.place_m, inertia_kg_m2: [0.0; 3] });
        };
        let not_negative = |node: Node<'_, '_>, key: &str| {
            let number = self.number(node, key)?;
            match (is_alone, number) {
                (true, 0.0) | (_, ..0.0) => {
                    let zero = if is_alone { "a number" } else { "zero or a number" };
                    Err(self.wrong(node, key, format!("is {number}; expected {zero} above zero")))
                }
                _ => Ok(number),
            }
        };
        let mass_kg = not_negative(self.child(inertial, "mass")?, "value")?;
        let inertia = self.child(inertial, "inertia")?;
        let mut tensor = [[0.0; 3]; 3];
        for (k, key) in ["ixx", "iyy", "izz"].into_iter().enumerate() {
            tensor[k][k] = not_negative(inertia, key)?;
        }
        for (i, j, key) in [(0, 1, "ixy"), (0, 2, "ixz"), (1, 2, "iyz")] {
            if inertia.has_attribute(key) {
                let product = self.number(inertia, key)?;
                (tensor[i][j], tensor[j][i]) = (product, product);
            }
        }
        let frame = part.frame.of(&self.origin(inertial)?);
        // Of R I Rᵀ the diagonal.
        let about = |row: [f64; 3]| (0..9).map(|k| row[k / 3] * tensor[k / 3][k % 3] * row[k % 3]).sum::<f64>();
        Ok(Rigid { mass_kg, centre_m: frame.place_m, inertia_kg_m2: frame.rotation.map(about) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a quarter turn about z, then one about the new x, takes x to y, y to z and z to x.
    #[test]
    fn frames_follow_each_other_as_a_urdf_has_them() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let frame =
            Frame::new([0.0, 0.0, quarter], [1.0, 0.0, 0.0]).of(&Frame::new([quarter, 0.0, 0.0], [0.0, 2.0, 0.0]));
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
        assert!(near(frame.place_m, [-1.0, 0.0, 0.0]), "{frame:?}");
        assert!(near(frame.turned([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]), "{frame:?}");
        assert!(near(frame.turned([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]), "{frame:?}");
        assert!(near(frame.turned([0.0, 0.0, 1.0]), [1.0, 0.0, 0.0]), "{frame:?}");
        let fixed = Frame::new([0.0, 0.0, quarter], [0.0; 3]).of(&Frame::new([quarter, 0.0, 0.0], [0.0; 3]));
        let rpy = Frame::new([quarter, 0.0, quarter], [0.0; 3]);
        assert!((0..3).all(|k| near(fixed.rotation[k], rpy.rotation[k])), "{fixed:?} {rpy:?}");
        let back = frame.seen(&frame);
        assert!(near(back.place_m, [0.0; 3]) && back.is_aligned(&Frame::default()), "{back:?}");
    }
}
