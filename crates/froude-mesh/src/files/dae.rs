//! Collada 1.4 and 1.5: the triangles and polygons of the scene, each where its node places it.
//!
//! `<unit meter>` states the unit of the file, metres if it is left out; `<up_axis>` which axis points up, y if it is left out: the mesh is
//! turned so that z does. A geometry that is not of triangles and polygons, and one that follows a skeleton, is rejected by name.
//!
//! **Source.** Barnes and Finch, COLLADA digital asset schema release 1.4.1, Khronos 2008: chapter 5, `asset`, `node`, `accessor`,
//! `polylist`; its appendix B for axes.

use indexmap::IndexMap;
use roxmltree::{Document, Node, ParsingOptions};

use super::cursor::{CORRECT, Cursor};
use crate::files::soup::{Polygons, ReadError, counted};
use crate::mesh::Mesh;
use crate::vector::Vec3;

/// Most nodes of a document.
const MOST_NODES: u32 = 5_000_000;
/// Panels and vertices at most: an instance of instances grows as a power.
const MOST_PANELS: usize = 4_000_000;
/// Nodes placed at most, with their children, and 16 bytes of a geometry each time that it is placed.
const MOST_PLACED: usize = 20_000_000;

/// Elements that others name by their id.
const TARGETS: [&str; 6] = ["visual_scene", "node", "geometry", "vertices", "source", "float_array"];

/// Vertices of a geometry as its node places them: rows of three numbers, and a fourth that is added.
type Affine = [[f64; 4]; 3];

const UNMOVED: Affine = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1024)];
    head.windows(8).any(|window| window == b"<COLLADA")
}

/// The mesh, what was left out, and the metres of its unit.
pub(super) fn read(cursor: &Cursor<'_>) -> Result<(Mesh, Vec<String>, f64), ReadError> {
    let text = match std::str::from_utf8(cursor.rest()) {
        Ok(text) => text,
        Err(e) => return Err(cursor.unexpected(e.valid_up_to(), "a byte that is not UTF-8", "UTF-8 text")),
    };
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let at = error.pos();
        ReadError(format!(
            "{}, line {}, column {}: the text is not XML: {error}; {CORRECT}",
            cursor.name(),
            at.row,
            at.col
        ))
    })?;
    let root = document.root_element();
    let mut dae = Dae {
        cursor,
        ids: IndexMap::new(),
        mesh: Mesh::default(),
        polygons: Polygons::default(),
        left_out: 0,
        placed: 0,
    };
    if root.tag_name().name() != "COLLADA" {
        return Err(dae.unexpected(root, &format!("<{}>", root.tag_name().name()), "<COLLADA>"));
    }
    for node in root.descendants() {
        let tag = node.tag_name().name();
        if let Some(id) = node.attribute("id").filter(|_| TARGETS.contains(&tag))
            && dae.ids.insert((tag, id), node).is_some()
        {
            let found = format!("<{tag}> with the id {id:?} for a second time");
            return Err(dae.unexpected(node, &found, "an id that is not there yet"));
        }
    }
    let mut notes = Vec::new();
    let (unit_m, up) = dae.asset(root, &mut notes)?;
    let scene = root.children().filter(|n| n.has_tag_name_of("scene")).find_map(|n| n.child("instance_visual_scene"));
    let scene = match scene {
        Some(instance) => dae.target(instance, "url", "visual_scene")?,
        None => {
            let mut all = root.descendants().filter(|n| n.has_tag_name_of("visual_scene"));
            match (all.next(), all.next()) {
                (Some(only), None) => only,
                _ => return Err(dae.unexpected(root, "no <instance_visual_scene>", "the scene to be read")),
            }
        }
    };
    let mut open: Vec<(Node<'_, '_>, Affine, usize)> = vec![(scene, up, 0)];
    while let Some((node, above, depth)) = open.pop() {
        dae.place(node, 1 + node.children().count())?;
        // A node within itself is deeper than all nodes of the file.
        if depth > dae.ids.len() + MOST_DEPTH {
            return Err(dae.unexpected(node, "a node that is placed within itself", "one that is not"));
        }
        let mut place = above;
        for step in node.children().filter(Node::is_element) {
            place = after(
                &place,
                &match step.tag_name().name() {
                    "matrix" => dae.matrix(step)?,
                    "translate" => dae.translation(step)?,
                    "rotate" => dae.rotation(step)?,
                    "scale" => dae.scaling(step)?,
                    kind @ ("lookat" | "skew") => {
                        return Err(dae.not_read(step, kind, "apply the transforms and export again"));
                    }
                    _ => continue,
                },
            );
        }
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "node" => open.push((child, place, depth + 1)),
                "instance_node" => open.push((dae.target(child, "url", "node")?, place, depth + 1)),
                "instance_geometry" => dae.geometry(dae.target(child, "url", "geometry")?, &place)?,
                kind @ "instance_controller" => {
                    return Err(dae.not_read(child, kind, "apply the skeleton or the morph, and export again"));
                }
                _ => {}
            }
        }
    }
    notes.extend(dae.polygons.note());
    if dae.left_out > 0 {
        notes.push(format!("{} left out", counted(dae.left_out, "set of lines", "sets of lines")));
    }
    let mut mesh = Mesh { panels: dae.polygons.panels, ..dae.mesh };
    mesh.drop_unused_vertices();
    Ok((mesh, notes, unit_m))
}

/// Depth of nodes beside those with a name.
const MOST_DEPTH: usize = 1000;

/// A transform after which another is applied to what the first one moves.
fn after(outer: &Affine, inner: &Affine) -> Affine {
    let column = |j: usize| [inner[0][j], inner[1][j], inner[2][j]];
    let turned = |row: &[f64; 4], v: Vec3| row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
    core::array::from_fn(|i| {
        core::array::from_fn(|j| turned(&outer[i], column(j)) + if j == 3 { outer[i][3] } else { 0.0 })
    })
}

/// Children and names without their namespace.
trait Named<'d, 'i> {
    fn has_tag_name_of(&self, name: &str) -> bool;
    fn child(&self, name: &str) -> Option<Node<'d, 'i>>;
}

impl<'d, 'i> Named<'d, 'i> for Node<'d, 'i> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }

    fn child(&self, name: &str) -> Option<Self> {
        self.children().find(|n| n.has_tag_name_of(name))
    }
}

struct Dae<'d, 'i> {
    cursor: &'d Cursor<'i>,
    /// By tag and id.
    ids: IndexMap<(&'d str, &'d str), Node<'d, 'i>>,
    mesh: Mesh,
    polygons: Polygons,
    left_out: usize,
    placed: usize,
}

impl<'d, 'i> Dae<'d, 'i> {
    fn unexpected(&self, node: Node<'_, '_>, found: &str, expected: &str) -> ReadError {
        self.cursor.unexpected(node.range().start, found, expected)
    }

    /// Counts what is placed.
    fn place(&mut self, node: Node<'_, '_>, count: usize) -> Result<(), ReadError> {
        self.placed += count;
        if self.placed <= MOST_PLACED {
            return Ok(());
        }
        Err(self.unexpected(
            node,
            "one instance too many",
            "a scene of at most 20,000,000 nodes, or 320 MB of geometry,",
        ))
    }

    fn not_read(&self, node: Node<'_, '_>, what: &str, advice: &str) -> ReadError {
        self.cursor.not_read(self.cursor.place(node.range().start), format!("<{what}>"), advice)
    }

    fn need(&self, node: Node<'d, 'i>, name: &str) -> Result<Node<'d, 'i>, ReadError> {
        let found = || format!("<{}> without <{name}>", node.tag_name().name());
        node.child(name).ok_or_else(|| self.unexpected(node, &found(), &format!("<{name}>")))
    }

    /// The element that an attribute names: `#id`.
    fn target(&self, node: Node<'d, 'i>, attribute: &str, tag: &str) -> Result<Node<'d, 'i>, ReadError> {
        let text = node.attribute(attribute).unwrap_or_default();
        let found = text.strip_prefix('#').and_then(|id| self.ids.get(&(tag, id))).copied();
        found.ok_or_else(|| {
            let expected = format!("the # and id of a <{tag}> of this file");
            self.unexpected(node, &format!("{attribute}={text:?}"), &expected)
        })
    }

    /// Numbers of the text of an element.
    fn numbers<T: std::str::FromStr>(&self, node: Node<'_, '_>, expected: &str) -> Result<Vec<T>, ReadError> {
        let one = |word: &str| {
            let shown: String = word.chars().take(32).collect();
            word.parse().map_err(|_| self.unexpected(node, &format!("{shown:?}"), expected))
        };
        let texts = node.children().filter(Node::is_text).filter_map(|text| text.text());
        texts.flat_map(str::split_ascii_whitespace).map(one).collect()
    }

    /// As many numbers as a transform has.
    fn exactly<const N: usize>(&self, node: Node<'_, '_>) -> Result<[f64; N], ReadError> {
        let numbers = self.numbers::<f64>(node, "a number")?;
        let count = counted(numbers.len(), "number", "numbers");
        numbers.try_into().map_err(|_| self.unexpected(node, &count, &format!("{N} numbers")))
    }

    fn matrix(&self, node: Node<'_, '_>) -> Result<Affine, ReadError> {
        let m = self.exactly::<16>(node)?;
        if m[12..] != [0.0, 0.0, 0.0, 1.0] {
            return Err(self.unexpected(node, &format!("the last row {:?}", &m[12..]), "0 0 0 1"));
        }
        Ok(core::array::from_fn(|i| core::array::from_fn(|j| m[4 * i + j])))
    }

    fn translation(&self, node: Node<'_, '_>) -> Result<Affine, ReadError> {
        let by = self.exactly::<3>(node)?;
        let mut out = UNMOVED;
        (0..3).for_each(|i| out[i][3] = by[i]);
        Ok(out)
    }

    fn scaling(&self, node: Node<'_, '_>) -> Result<Affine, ReadError> {
        let by = self.exactly::<3>(node)?;
        let mut out = UNMOVED;
        (0..3).for_each(|i| out[i][i] = by[i]);
        Ok(out)
    }

    /// About an axis by an angle in degrees (Rodrigues).
    fn rotation(&self, node: Node<'_, '_>) -> Result<Affine, ReadError> {
        let [x, y, z, degrees] = self.exactly(node)?;
        let length = f64::hypot(x, y).hypot(z);
        if !(length > 0.0 && length.is_finite()) {
            return Err(self.unexpected(node, "an axis without a direction", "an axis and an angle in degrees"));
        }
        let n = [x, y, z].map(|x| x / length);
        let (s, c) = degrees.to_radians().sin_cos();
        let mut out = UNMOVED;
        for i in 0..3 {
            for j in 0..3 {
                out[i][j] = n[i] * n[j] * (1.0 - c) + if i == j { c } else { 0.0 };
            }
            out[i][(i + 1) % 3] -= s * n[(i + 2) % 3];
            out[i][(i + 2) % 3] += s * n[(i + 1) % 3];
        }
        Ok(out)
    }

    /// Metres of the unit, and the turn that lets z point up.
    fn asset(&self, root: Node<'d, 'i>, notes: &mut Vec<String>) -> Result<(f64, Affine), ReadError> {
        let asset = root.child("asset");
        let unit = asset.and_then(|asset| asset.child("unit"));
        let unit_m = match unit.and_then(|unit| Some((unit, unit.attribute("meter")?))) {
            None => 1.0,
            Some((unit, text)) => match text.trim().parse() {
                Ok(m) if m > 0.0 && f64::is_finite(m) => m,
                _ => return Err(self.unexpected(unit, &format!("meter={text:?}"), "a number of metres above zero")),
            },
        };
        let up = asset.and_then(|asset| asset.child("up_axis"));
        let text = up.and_then(|up| up.text()).map_or("Y_UP", str::trim);
        let stated = if up.is_some() { "as the file states" } else { "which Collada means where a file states none" };
        let rows: [[f64; 3]; 3] = match text {
            "Z_UP" => return Ok((unit_m, UNMOVED)),
            "Y_UP" => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            "X_UP" => [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
            _ => return Err(self.unexpected(up.unwrap_or(root), &format!("{text:?}"), "X_UP, Y_UP or Z_UP")),
        };
        notes.push(format!("turned from {} up, {stated}, to z up", text[..1].to_ascii_lowercase()));
        Ok((unit_m, rows.map(|[x, y, z]| [x, y, z, 0.0])))
    }

    /// The panels of a geometry, where a node places them.
    fn geometry(&mut self, geometry: Node<'d, 'i>, place: &Affine) -> Result<(), ReadError> {
        self.place(geometry, geometry.range().len() / 16)?;
        let Some(mesh) = geometry.child("mesh") else {
            let kind = geometry.children().find(Node::is_element).map_or("geometry", |n| n.tag_name().name());
            return Err(self.not_read(geometry, kind, "export it as triangles"));
        };
        let column = |j: usize| [place[0][j], place[1][j], place[2][j]];
        let is_mirrored = crate::vector::dot(column(0), crate::vector::cross(column(1), column(2))) < 0.0;
        // First vertex of each source, and how many it has.
        let mut sources: IndexMap<usize, (u32, usize)> = IndexMap::new();
        for primitive in mesh.children().filter(Node::is_element) {
            let kind = primitive.tag_name().name();
            if matches!(kind, "lines" | "linestrips") {
                self.left_out += 1;
            }
            if !matches!(kind, "triangles" | "polylist" | "polygons" | "tristrips" | "trifans") {
                continue;
            }
            let (source, offset, stride) = self.inputs(primitive)?;
            let (first, count) = match sources.get(&source.range().start) {
                Some(known) => *known,
                None => {
                    let known = (self.mesh.vertices.len() as u32, self.points(source, place)?);
                    sources.insert(source.range().start, known);
                    known
                }
            };
            for corners in self.polygons_of(primitive, offset, stride)? {
                if let Some(wrong) = corners.iter().find(|v| **v as usize >= count) {
                    return Err(self.unexpected(
                        primitive,
                        &format!("vertex {wrong}"),
                        &format!("one of the {count} of its source,"),
                    ));
                }
                let mut corners: Vec<u32> = corners.iter().map(|v| first + v).collect();
                if is_mirrored {
                    corners.reverse();
                }
                self.polygons.push(&corners);
            }
            if self.polygons.panels.len().max(self.mesh.vertices.len()) > MOST_PANELS {
                return Err(self.unexpected(primitive, "more than 4,000,000 panels or vertices", "a coarser mesh"));
            }
        }
        Ok(())
    }

    /// The source of the positions, where among the numbers of a corner theirs is, and how many a corner has.
    fn inputs(&self, primitive: Node<'d, 'i>) -> Result<(Node<'d, 'i>, usize, usize), ReadError> {
        let (mut vertex, mut stride) = (None, 1);
        for input in primitive.children().filter(|n| n.has_tag_name_of("input")) {
            let text = input.attribute("offset").unwrap_or("0");
            let offset = text.trim().parse::<usize>().ok().filter(|n| *n < 64);
            let offset =
                offset.ok_or_else(|| self.unexpected(input, &format!("offset={text:?}"), "a number below 64"))?;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((self.target(input, "source", "vertices")?, offset));
            }
        }
        let none = || self.unexpected(primitive, "no input with the semantic VERTEX", "one");
        let (vertices, offset) = vertex.ok_or_else(none)?;
        let position = vertices.children().find(|n| n.attribute("semantic") == Some("POSITION"));
        let none = || self.unexpected(vertices, "no input with the semantic POSITION", "one");
        Ok((self.target(position.ok_or_else(none)?, "source", "source")?, offset, stride))
    }

    /// Adds the points of a source; how many.
    fn points(&mut self, source: Node<'d, 'i>, place: &Affine) -> Result<usize, ReadError> {
        let accessor = self.need(self.need(source, "technique_common")?, "accessor")?;
        let whole = |name: &str, otherwise: usize| {
            let Some(text) = accessor.attribute(name) else { return Ok(otherwise) };
            let wrong = || self.unexpected(accessor, &format!("{name}={text:?}"), "a whole number");
            text.trim().parse::<usize>().map_err(|_| wrong())
        };
        let (count, stride, offset) = (whole("count", 0)?, whole("stride", 1)?, whole("offset", 0)?);
        let params: Vec<&str> = accessor
            .children()
            .filter(|n| n.has_tag_name_of("param"))
            .map(|n| n.attribute("name").unwrap_or(""))
            .collect();
        let axes = ["X", "Y", "Z"].map(|axis| params.iter().position(|name| *name == axis));
        let [Some(x), Some(y), Some(z)] = axes else {
            return Err(self.unexpected(accessor, &format!("the parameters {params:?}"), "X, Y and Z"));
        };
        let array = self.target(accessor, "source", "float_array")?;
        let values = self.numbers::<f64>(array, "a number")?;
        let needed = count.checked_mul(stride).and_then(|n| n.checked_add(offset));
        if needed.is_none_or(|n| n > values.len()) || [x, y, z].iter().any(|i| *i >= stride) {
            let found = format!("{count} points of {stride} numbers");
            return Err(self.unexpected(
                accessor,
                &found,
                &format!("such as the {} numbers of its source give", values.len()),
            ));
        }
        let moved = |p: Vec3| place.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
        let points = values[offset..].chunks_exact(stride.max(1)).take(count);
        self.mesh.vertices.extend(points.map(|p| moved([p[x], p[y], p[z]])));
        Ok(count)
    }

    /// Corners of all polygons of a primitive, by the numbers of their source.
    fn polygons_of(&self, primitive: Node<'d, 'i>, offset: usize, stride: usize) -> Result<Vec<Vec<u32>>, ReadError> {
        let kind = primitive.tag_name().name();
        if let Some(hole) = primitive.child("ph") {
            return Err(self.not_read(hole, "ph", "divide faces with holes into triangles, and export again"));
        }
        let mut out = Vec::new();
        for p in primitive.children().filter(|n| n.has_tag_name_of("p")) {
            let numbers = self.numbers::<u32>(p, "a whole number from 0")?;
            if !numbers.len().is_multiple_of(stride) {
                let found = counted(numbers.len(), "number", "numbers");
                return Err(self.unexpected(p, &found, &format!("a multiple of {stride}, those of a corner,")));
            }
            let corners: Vec<u32> =
                numbers.chunks_exact(stride).filter_map(|corner| corner.get(offset).copied()).collect();
            match kind {
                "triangles" if corners.len().is_multiple_of(3) => {
                    out.extend(corners.chunks_exact(3).map(<[u32]>::to_vec));
                }
                "triangles" => {
                    return Err(self.unexpected(p, &format!("{} corners", corners.len()), "three for each triangle"));
                }
                "tristrips" => out.extend(
                    corners.windows(3).enumerate().map(
                        |(i, t)| {
                            if i % 2 == 0 { t.to_vec() } else { vec![t[1], t[0], t[2]] }
                        },
                    ),
                ),
                "trifans" => {
                    out.extend(corners.get(1..).unwrap_or_default().windows(2).map(|t| vec![corners[0], t[0], t[1]]));
                }
                "polylist" => {
                    let counts = self.numbers::<usize>(self.need(primitive, "vcount")?, "a number of corners")?;
                    let mut rest = corners.as_slice();
                    for count in counts {
                        let Some((polygon, more)) = rest.split_at_checked(count) else {
                            return Err(self.unexpected(
                                p,
                                &format!("{} corners", corners.len()),
                                "as many as <vcount> says,",
                            ));
                        };
                        out.push(polygon.to_vec());
                        rest = more;
                    }
                    if !rest.is_empty() {
                        return Err(self.unexpected(
                            p,
                            &format!("{} corners", corners.len()),
                            "as many as <vcount> says,",
                        ));
                    }
                }
                _ => out.push(corners),
            }
        }
        match out.iter().find(|corners| corners.len() < 3) {
            Some(few) => {
                Err(self.unexpected(primitive, &format!("a face with {} corners", few.len()), "one with three or more"))
            }
            None => Ok(out),
        }
    }
}
