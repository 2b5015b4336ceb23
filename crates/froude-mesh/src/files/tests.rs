//! Each format from a text or bytes made by its public description; round trips; other programs' readers; bad input.
//!
//! By hand, once: one body of 590 panels as Gmsh 4 (MSH 2.2 and 4.1, text and binary), meshio 5 and trimesh 5 (OBJ, PLY, STL, MSH) write
//! it is read with the same volume to nine digits; Capytaine 3.0 reads the boxes of the WAMIT and Nemoh tests with the same panels,
//! volumes and outward normals; VTK 9 the `.vtp` with the same volume.

use proptest::prelude::*;

use super::*;
use crate::check::check;
use crate::measure::Measure;
use crate::mesh::Panel;
use crate::sections::{Resolution, SectionBody};
use crate::vector::Vec3;

fn good(name: &str, bytes: impl AsRef<[u8]>) -> MeshFile {
    read(name, bytes.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn error(name: &str, bytes: impl AsRef<[u8]>) -> String {
    read(name, bytes.as_ref()).unwrap_err().to_string()
}

fn ellipsoid() -> Mesh {
    SectionBody::ellipsoid([2.0, 1.0, 1.5], 2).mesh(Resolution { along: 2, around: 8 }).unwrap().mesh
}

/// Corners of the unit cube and its sides, outward.
const CUBE: [Vec3; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const SIDES: [[u32; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn cube() -> Mesh {
    Mesh { vertices: CUBE.to_vec(), panels: SIDES.map(|[a, b, c, d]| Panel::quad(a, b, c, d)).to_vec() }
}

fn is_unit_cube(mesh: &Mesh) {
    assert_eq!(check(mesh), []);
    let m = Measure::of(mesh);
    assert!((m.volume_m3 - 1.0).abs() < 1e-15 && (m.area_m2 - 6.0).abs() < 1e-14, "{m:?}");
}

const FACET: &str =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.5e0 0\n endloop\nendfacet\n";

#[test]
fn stl_is_read_as_text_and_as_bytes() {
    let file = good("a.STL", format!("solid hull of\n{FACET}endsolid hull of\nsolid\n{FACET}endsolid\n"));
    assert_eq!((file.format, file.mesh.vertices.len(), file.mesh.panels.len()), (Format::Stl, 3, 2));
    assert_eq!(file.notes, ["2 solids in one mesh"]);

    let mut bytes = write_stl_binary(&cube());
    is_unit_cube(&good("a.stl", &bytes).mesh);
    // Some programs write "solid" into the header of a binary file.
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(good("a.stl", &bytes).notes, <[&str; 0]>::default());
    bytes[84 + 48] = 1;
    bytes.extend([0; 7]);
    bytes[6] = 0;
    let notes = ["attributes of 1 triangle left out", "7 bytes after the last triangle left out"];
    assert_eq!(good("a.stl", &bytes).notes, notes);
}

#[test]
fn normals_of_an_stl_against_its_corners_are_reported() {
    let text = format!("solid\n{}endsolid", FACET.replace("normal 0 0 1", "normal 0 0 -1"));
    let told = "the normals of 1 of 1 triangles contradict the order of their corners; the order was used";
    assert_eq!(good("a.stl", text).notes, [told]);
}

#[test]
fn corners_of_an_stl_that_differ_in_the_last_bit_are_two_vertices() {
    let mut mesh = cube();
    assert_eq!(good("a.stl", write_stl_binary(&mesh)).mesh.vertices.len(), 8);
    mesh.vertices.push([1.0, 1.0, f64::from(1.0_f32.next_up())]);
    mesh.panels[4] = Panel::quad(2, 3, 7, 8);
    assert_eq!(good("a.stl", write_stl_binary(&mesh)).mesh.vertices.len(), 9);
}

#[test]
fn obj_is_read_with_its_ways_to_name_a_corner() {
    let text = "# a cube\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 .5 .5 .5\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                f 1//1 4//1 3//1 2//1\nf 1 2 6 5 # below\nf -3/1 -2/1/1 7 \\\n 6\nf 3 4 8 7\n\
                f 4 1 5 8\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf -4 -3 -2 -1\n";
    let file = good("cube.obj", text);
    is_unit_cube(&file.mesh);
    assert_eq!(file.notes, ["statements without panels left out: 1 mtllib, 1 vn, 1 vt"]);
    let file = good("a.obj", "\u{feff}# marked\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(file.mesh.panels.len(), 1);
    let fan = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5";
    let file = good("a.obj", fan);
    assert_eq!(file.mesh.panels.len(), 3);
    assert_eq!(file.notes, ["1 face with more than four corners divided into triangles"]);
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex 8\nproperty float x\nproperty double y\nproperty float z\n\
         property uchar red\nelement face 6\nproperty short group\nproperty list uchar int vertex_indices\nelement edge 1\n\
         property int vertex1\nproperty list uint16 float32 weights\nend_header\n"
    )
}

#[test]
fn ply_is_read_as_text_and_in_both_orders_of_bytes() {
    let mut text = ply_header("ascii");
    for [x, y, z] in CUBE {
        text += &format!("{x} {y} {z} 255\n");
    }
    for [a, b, c, d] in SIDES {
        text += &format!("7 4 {a} {b} {c} {d}\n");
    }
    text += "0 2 0.5 0.5\n";
    let file = good("a.ply", text.replace('\n', "\r\n"));
    is_unit_cube(&file.mesh);
    assert_eq!(file.notes, ["1 edge left out"]);

    for (format, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = ply_header(format).into_bytes();
        let mut push = |number: &[u8]| {
            let mut number = number.to_vec();
            if is_big {
                number.reverse();
            }
            bytes.extend(number);
        };
        for [x, y, z] in CUBE {
            push(&(x as f32).to_le_bytes());
            push(&y.to_le_bytes());
            push(&(z as f32).to_le_bytes());
            push(&[255]);
        }
        for side in SIDES {
            push(&(-3_i16).to_le_bytes());
            push(&[4]);
            for v in side {
                push(&v.to_le_bytes());
            }
        }
        push(&0_i32.to_le_bytes());
        push(&2_u16.to_le_bytes());
        push(&0.5_f32.to_le_bytes());
        push(&0.5_f32.to_le_bytes());
        let file = good("a.ply", &bytes);
        is_unit_cube(&file.mesh);
        assert_eq!(file.notes, ["1 edge left out"]);
        let end = bytes.len();
        bytes.pop();
        let expected =
            format!("a.ply, byte {}: the file ends where a value of edge should be; copy or export it again", end - 1);
        assert_eq!(error("a.ply", &bytes), expected);
    }
}

/// A quarter of a box 2 × 2 × 1: three full sides, two halves of sides, as triangle with a corner twice or quadrilateral.
const GDF: &str = "quarter of a box\n1.0 9.80665 ULEN GRAV\n1 1 ISX ISY\n5 panels\n\
    1 0 0  1 1 0  1 1 1  1 0 1\n0. 1. 0. 0. 1. 1. 1. 1. 1. 1. 1. 0.\n0 0 0, 0 1 0, 1 1 0, 1 0 0\n\
    0 0 1  1 0 1  1 1 1  1 1 1\n0 0 1\n 1 1 1 0 1.0D0 1 0 1 1\n";

#[test]
fn wamit_mirrors_in_both_planes() {
    let file = good("box.gdf", GDF);
    assert_eq!(check(&file.mesh), []);
    assert_eq!(file.mesh.panels.len(), 20);
    // Points on both planes are there once: 18 in all for the corners, edges and middles of a box.
    assert_eq!(file.mesh.vertices.len(), 18);
    assert!((Measure::of(&file.mesh).volume_m3 - 4.0).abs() < 1e-14);
    let notes = ["ISX = 1: 5 panels mirrored in the plane x = 0", "ISY = 1: 10 panels mirrored in the plane y = 0"];
    assert_eq!(file.notes, notes);
}

#[test]
fn wamit_in_feet_with_walls_and_more_lines_is_reported() {
    let text = "one\n1 32.174\n0 -1\n1\n0 0 0 1 0 0 1 1 0 0 1 0\nmore";
    let notes = [
        "GRAV is 32.174: the file is not in metres and seconds (in feet it is 32.17)",
        "what follows the last panel, from line 6, column 1, left out",
        "ISY = -1, a wall at y = 0, left out",
    ];
    assert_eq!(good("a.gdf", text).notes, notes);
    let crossing = "one\n1 9.81\n0 1\n1\n0 -1 0 1 -1 0 1 1 0 0 1 0\n";
    let notes = good("a.gdf", crossing).notes;
    assert_eq!(notes[1], "the mirrored part lies on both sides of y = 0: it and its image may overlap");
}

#[test]
fn nemoh_is_read_with_its_symmetry() {
    let mut text = String::from("  2   1\n");
    let half: Vec<Vec3> = CUBE.iter().map(|[x, y, z]| [*x, 0.5 * y, *z]).collect();
    (1..).zip(&half).for_each(|(n, [x, y, z])| text += &format!(" {n} {x:.3} {y:.3} {z:.3}\n"));
    text += " 0 0. 0. 0.\n";
    // Without the side in the plane y = 0; the lid as two triangles.
    for (number, side) in SIDES.iter().enumerate().filter(|(number, _)| *number != 2) {
        let [a, b, c, d] = side.map(|v| v + 1);
        let lines = if number == 1 { vec![[a, b, c, c], [a, c, d, a]] } else { vec![[a, b, c, d]] };
        for [a, b, c, d] in lines {
            text += &format!("{a} {b} {c} {d}\n");
        }
    }
    let whole = format!("{text}0 0 0 0\n");
    for name in ["mesh.dat", "mesh"] {
        let file = good(name, &whole);
        assert_eq!((file.format, file.mesh.panels.len(), file.mesh.vertices.len()), (Format::Nemoh, 12, 12));
        is_unit_cube(&file.mesh);
        assert_eq!(file.notes, ["symmetry 1: 6 panels mirrored in the plane y = 0"]);
    }
    let cut = "mesh.dat, line 17, column 1: the file ends where a vertex from 1 to 8, or 0 after the last panel, should be; \
               copy or export it again";
    assert_eq!(error("mesh.dat", &text), cut);
}

fn msh_2() -> String {
    let mut text = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"hull $Nodes\"\n$EndPhysicalNames\n$Nodes\n9\n",
    );
    CUBE.iter().zip(10..).for_each(|([x, y, z], n)| text += &format!("{n} {x} {y} {z}\n"));
    text += "99 0.5 0.5 0.5\n$EndNodes\n$Elements\n9\n1 15 2 0 1 10\n2 1 2 0 1 10 11\n3 2 2 0 1 10 13 12\n4 2 2 0 1 10 12 11\n";
    for ([a, b, c, d], n) in SIDES[1..].iter().map(|side| side.map(|v| v + 10)).zip(5..) {
        text += &format!("{n} 3 2 0 1 {a} {b} {c} {d}\n");
    }
    text + "$EndElements\n"
}

fn msh_4() -> String {
    let mut text = String::from(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n$EndEntities\n$Nodes\n2 9 1 99\n2 1 1 8\n",
    );
    for n in 1..=8 {
        text += &format!("{n}\n");
    }
    for [x, y, z] in CUBE {
        text += &format!("{x} {y} {z} 0.1 0.2\n");
    }
    text += "3 1 0 1\n99\n0.5 0.5 0.5\n$EndNodes\n$Elements\n2 7 1 7\n2 1 3 6\n";
    for ([a, b, c, d], n) in SIDES.iter().map(|side| side.map(|v| v + 1)).zip(1..) {
        text += &format!("{n} {a} {b} {c} {d}\n");
    }
    text + "3 1 4 1\n7 1 2 3 99\n$EndElements\n"
}

/// Numbers of a text section as bytes; each word of `kinds` is the kind of the next number, `i`, `s` or `d`.
fn packed(numbers: &[(char, f64)], is_big: bool) -> Vec<u8> {
    let mut out = Vec::new();
    for (kind, x) in numbers {
        let mut bytes = match kind {
            'i' => (*x as i32).to_le_bytes().to_vec(),
            's' => (*x as u64).to_le_bytes().to_vec(),
            _ => x.to_le_bytes().to_vec(),
        };
        if is_big {
            bytes.reverse();
        }
        out.extend(bytes);
    }
    out
}

fn msh_2_binary(is_big: bool) -> Vec<u8> {
    let mut out = b"$MeshFormat\n2.2 1 8\n".to_vec();
    out.extend(packed(&[('i', 1.0)], is_big));
    out.extend(b"\n$EndMeshFormat\n$Nodes\n8\n");
    for (point, n) in CUBE.iter().zip(10..) {
        out.extend(packed(&[('i', f64::from(n))], is_big));
        out.extend(packed(&point.map(|x| ('d', x)), is_big));
    }
    out.extend(b"\n$EndNodes\n$Elements\n7\n");
    out.extend(packed(&[15.0, 1.0, 2.0, 1.0, 0.0, 1.0, 10.0, 3.0, 6.0, 2.0].map(|x| ('i', x)), is_big));
    for side in SIDES {
        out.extend(packed(&[7.0, 0.0, 1.0].map(|x| ('i', x)), is_big));
        out.extend(packed(&side.map(|v| ('i', f64::from(v + 10))), is_big));
    }
    out.extend(b"\n$EndElements\n");
    out
}

fn msh_4_binary(is_big: bool) -> Vec<u8> {
    let mut out = b"$MeshFormat\n4.1 1 8\n".to_vec();
    out.extend(packed(&[('i', 1.0)], is_big));
    out.extend(b"\n$EndMeshFormat\n$Nodes\n");
    out.extend(packed(&[1.0, 8.0, 1.0, 8.0].map(|x| ('s', x)), is_big));
    out.extend(packed(&[('i', 2.0), ('i', 1.0), ('i', 0.0), ('s', 8.0)], is_big));
    for n in 1..=8 {
        out.extend(packed(&[('s', f64::from(n))], is_big));
    }
    for point in CUBE {
        out.extend(packed(&point.map(|x| ('d', x)), is_big));
    }
    out.extend(b"\n$EndNodes\n$Elements\n");
    out.extend(packed(&[1.0, 6.0, 1.0, 6.0].map(|x| ('s', x)), is_big));
    out.extend(packed(&[('i', 2.0), ('i', 1.0), ('i', 3.0), ('s', 6.0)], is_big));
    for side in SIDES {
        out.extend(packed(&[('s', 1.0)], is_big));
        out.extend(packed(&side.map(|v| ('s', f64::from(v + 1))), is_big));
    }
    out.extend(b"\n$EndElements\n");
    out
}

#[test]
fn gmsh_is_read_in_its_four_forms() {
    let file = good("cube.msh", msh_2());
    is_unit_cube(&file.mesh);
    let panels = "panels are triangles and quadrilaterals of first and second order";
    assert_eq!(
        file.notes,
        [format!("left out: 1 line, 1 point; {panels}"), "1 node that no panel uses left out".into()]
    );
    let file = good("cube", msh_4());
    is_unit_cube(&file.mesh);
    assert_eq!(file.notes, [format!("left out: 1 tetrahedron; {panels}"), "1 node that no panel uses left out".into()]);
    for is_big in [false, true] {
        let file = good("cube.msh", msh_2_binary(is_big));
        is_unit_cube(&file.mesh);
        assert_eq!(file.notes, [format!("left out: 1 point; {panels}")]);
        let file = good("cube.msh", msh_4_binary(is_big));
        is_unit_cube(&file.mesh);
        assert_eq!(file.notes, <[&str; 0]>::default());
    }
}

#[test]
fn a_mistake_is_reported_with_its_place_and_the_next_step() {
    let correct = "correct the line, or export the file again";
    let told = [
        (
            "a.obj",
            "v 0 0 0\nv 1 0 zero\n",
            "a.obj, line 2, column 7: \"zero\" where a number, z of a vertex, should be",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 2 1\n",
            "a.obj, line 2, column 5: \"2\" where a vertex from 1 to 1, or from -1 to -1, should be",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1\n",
            "a.obj, line 2, column 1: a face with 2 corners where one with three or more should be",
        ),
        (
            "a.obj",
            "hello\n",
            "a.obj, line 1, column 1: \"hello\" where v, f or another statement of the format should be",
        ),
        (
            "a.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex",
            "a.stl, line 5, column 1: \"vertex\" where a number, z of a corner, should be",
        ),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
            "a.ply, line 3, column 1: one without them where an element vertex with the properties x, y and z should be",
        ),
        (
            "a.ply",
            "ply\nformat ascii 2.0\n",
            "a.ply, line 2, column 1: \"format ascii 2.0\" where a line of the header (format, element, property, comment, end_header) should be",
        ),
        (
            "a.gdf",
            "box\n1 9.81\n0 2\n",
            "a.gdf, line 3, column 3: \"2\" where -1, 0 or 1, the symmetries ISX and ISY, should be",
        ),
        (
            "a.dat",
            "2 0\n1 0 0 0\n3 0 0 0\n",
            "a.dat, line 3, column 1: \"3\" where vertex 2, or 0 after the last, should be",
        ),
        (
            "a.msh",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 2 0 1 1 2\n",
            "a.msh, line 10, column 11: node 2 where one of the nodes above should be",
        ),
    ];
    for (name, text, sentence) in told {
        assert_eq!(error(name, text), format!("{sentence}; {correct}"), "{text}");
    }
    let higher = "a.gdf, line 4, column 3: a file of higher order (IGDEF = 1) is not read; export panels of low order (ILOWGDF in WAMIT \
                  writes them)";
    assert_eq!(error("a.gdf", "box\n1 9.81\n0 0\n2 1\n"), higher);
    let kind = "a.msh, line 6, column 3: element type 34 is not read; save triangles and quadrilaterals only";
    assert_eq!(error("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n1\n1 34 0 1\n"), kind);
    let parameters = "a.msh, line 4, column 1: the section $ParametricNodes is not read; save it without Mesh.SaveParametric, or as \
                      version 4.1";
    assert_eq!(error("a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n1\n"), parameters);
    let version = "a.msh, line 2, column 1: version 4.0 is not read; save it with gmsh -save -format msh41 or msh22";
    assert_eq!(error("a.msh", "$MeshFormat\n4.0 0 8\n"), version);
    let unknown = "hull.step: neither extension nor content is that of STL, OBJ, PLY, WAMIT GDF, Nemoh, Gmsh or Collada; give it the \
                   extension of its format (.stl .obj .ply .gdf .dat .msh .dae)";
    assert_eq!(error("hull.step", "ISO-10303-21;"), unknown);
    let cut = "a.stl, byte 90: the file ends where triangle 1 of 4294967295 should be; copy or export it again";
    let mut bytes = vec![0; 90];
    bytes[80..84].fill(0xff);
    assert_eq!(error("a.stl", &bytes), cut);
}

#[test]
fn numbers_that_are_none_come_through_to_the_check() {
    let mesh = good("a.obj", "v 0 0 nan\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n").mesh;
    assert!(check(&mesh)[0].to_string().starts_with("vertex 0 has the coordinates [0.0, 0.0, NaN]"));
    assert_eq!(check(&mesh).len(), 2);
}

#[test]
fn the_content_tells_the_format_where_the_extension_does_not() {
    let stl = write_stl_binary(&cube());
    let obj = write_obj(&cube());
    let samples: [(&[u8], Format); 6] = [
        (&stl, Format::Stl),
        (b"solid x\nendsolid x\n", Format::Stl),
        (obj.as_bytes(), Format::Obj),
        (b"ply\nformat ascii 1.0\nend_header\n", Format::Ply),
        (GDF.as_bytes(), Format::Gdf),
        (b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", Format::Msh),
    ];
    for (bytes, format) in samples {
        assert_eq!(good("hull", bytes).format, format);
    }
}

#[test]
fn a_mesh_is_written_and_read_back() {
    let mesh = ellipsoid();
    let obj = good("a.obj", write_obj(&mesh));
    assert_eq!(obj.mesh, mesh);
    let stl = good("a.stl", write_stl_binary(&mesh)).mesh;
    assert_eq!(check(&stl), []);
    // Half a unit of the last place of f32 in each coordinate, three of them in a volume.
    let (a, b) = (Measure::of(&stl).volume_m3, Measure::of(&mesh).volume_m3);
    assert!((a / b - 1.0).abs() < 3.0 * 6e-8, "{a} {b}");
}

#[test]
fn a_vtp_file_has_the_panels_and_their_numbers() {
    let mesh = Mesh { vertices: CUBE[..5].to_vec(), panels: vec![Panel::quad(0, 1, 2, 3), Panel::triangle(0, 1, 4)] };
    let text = vtk::vtp(&mesh, &[("pressure surge [Pa/(m/s^2)]", &[1.5, -2e-9]), ("a<b", &[1.0])]);
    let expected = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n<PolyData>\n\
        <Piece NumberOfPoints=\"5\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"2\">\n\
        <Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n\
        0.0 0.0 0.0\n1.0 0.0 0.0\n1.0 1.0 0.0\n0.0 1.0 0.0\n0.0 0.0 1.0\n</DataArray>\n</Points>\n\
        <Polys>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n0 1 2 3\n0 1 4\n</DataArray>\n\
        <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n4\n7\n</DataArray>\n</Polys>\n<CellData>\n\
        <DataArray type=\"Float64\" Name=\"pressure surge [Pa/(m/s^2)]\" format=\"ascii\">\n1.5\n-2e-9\n</DataArray>\n\
        <DataArray type=\"Float64\" Name=\"a&lt;b\" format=\"ascii\">\n1.0\nnan\n</DataArray>\n\
        </CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
    assert_eq!(text, expected);
}

/// The readers of the ecosystem find the same surface in what we write, and we in what they do.
#[test]
fn other_programs_read_the_same_surface() {
    let mesh = ellipsoid();
    let bytes = write_stl_binary(&mesh);
    let ours = good("a.stl", &bytes).mesh;
    let theirs = stl_io::read_stl(&mut std::io::Cursor::new(&bytes)).unwrap();
    assert_eq!((theirs.vertices.len(), theirs.faces.len()), (ours.vertices.len(), ours.panels.len()));
    for (face, panel) in theirs.faces.iter().zip(&ours.panels) {
        let corners = face.vertices.map(|v| theirs.vertices[v].0.map(f64::from));
        assert_eq!(corners.to_vec(), ours.corners(*panel).collect::<Vec<_>>());
    }

    let text = write_obj(&mesh);
    let options = tobj::LoadOptions::default();
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
    let theirs = &models[0].mesh;
    let ends = theirs.face_arities.iter().scan(0, |end, arity| {
        *end += *arity as usize;
        Some((*end - *arity as usize, *end))
    });
    for ((from, to), panel) in ends.zip(&mesh.panels) {
        let corner = |v: &u32| [0, 1, 2].map(|axis| theirs.positions[3 * *v as usize + axis]);
        let corners: Vec<Vec3> = theirs.indices[from..to].iter().map(corner).collect();
        assert_eq!(corners, mesh.corners(*panel).collect::<Vec<_>>());
    }
}

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let mut ply = ply_header("ascii");
    for [x, y, z] in CUBE {
        ply += &format!("{x} {y} {z} 255\n");
    }
    for [a, b, c, d] in SIDES {
        ply += &format!("7 4 {a} {b} {c} {d}\n");
    }
    vec![
        ("a.stl", write_stl_binary(&cube())),
        ("a.stl", format!("solid\n{FACET}endsolid\n").into_bytes()),
        ("a.obj", write_obj(&cube()).into_bytes()),
        ("a.ply", (ply + "0 1 0.5\n").into_bytes()),
        ("a.gdf", GDF.as_bytes().to_vec()),
        ("a.dat", b"2 1\n1 0 0 0\n2 1 0 0\n3 0 1 0\n0 0. 0. 0.\n1 2 3 3\n0 0 0 0\n".to_vec()),
        ("a.msh", msh_2().into_bytes()),
        ("a.msh", msh_4().into_bytes()),
        ("a.msh", msh_2_binary(false)),
        ("a.msh", msh_4_binary(true)),
    ]
}

/// Every panel of what is read has corners that exist, and the mesh is no larger than the file allows.
fn is_sound(name: &str, bytes: &[u8]) {
    match read(name, bytes) {
        Ok(file) => {
            let vertices = file.mesh.vertices.len();
            assert!(file.mesh.panels.iter().all(|p| p.corners().iter().all(|v| (*v as usize) < vertices)));
            assert!(24 * vertices + 16 * file.mesh.panels.len() <= 24 * bytes.len(), "{} bytes", bytes.len());
        }
        Err(error) => assert!(error.to_string().starts_with(name), "{error}"),
    }
}

proptest! {
    #[test]
    fn a_file_cut_anywhere_is_read_or_refused_in_words(sample in 0..10_usize, cut in 0.0..1.0_f64) {
        let (name, bytes) = samples().swap_remove(sample);
        let length = (cut * bytes.len() as f64) as usize;
        is_sound(name, &bytes[..length]);
    }

    #[test]
    fn a_file_with_bytes_changed_is_read_or_refused_in_words(
        sample in 0..10_usize,
        changes in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 1..6),
    ) {
        let (name, mut bytes) = samples().swap_remove(sample);
        for (at, byte) in changes {
            let at = (at * bytes.len() as f64) as usize;
            bytes[at] = byte;
        }
        is_sound(name, &bytes);
    }

    #[test]
    fn any_bytes_are_read_or_refused_in_words(
        name in prop::sample::select(vec!["a.stl", "a.obj", "a.ply", "a.gdf", "a.dat", "a.msh", "a"]),
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        is_sound(name, &bytes);
    }

    #[test]
    fn any_words_are_read_or_refused_in_words(
        name in prop::sample::select(vec!["a.stl", "a.obj", "a.ply", "a.gdf", "a.dat", "a.msh", "a"]),
        text in "((v|f|0|1|2|-1|4.1|2.2|8|ply|format|ascii|element|face|vertex|end_header|solid|facet|\\$Nodes|\\$MeshFormat|nan|1e9)[ \n]){0,60}",
    ) {
        is_sound(name, text.as_bytes());
    }
}
