//! VTK XML PolyData (`.vtp`), as ParaView opens it: the panels with named numbers on them.
//!
//! Source: VTK file formats, XML PolyData, `format="ascii"`.

use crate::mesh::Mesh;

/// The mesh with a number per panel for each name; names carry their units, such as `pressure surge [Pa/(m/s^2)]`.
///
/// Numbers beyond the panels are not written; where there are too few, the rest is NaN, which ParaView shows in its own colour.
#[must_use]
pub fn vtp(mesh: &Mesh, scalars: &[(&str, &[f64])]) -> String {
    let (points, polys) = (mesh.vertices.len(), mesh.panels.len());
    let mut out = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{polys}\">\n"
    );
    let mut array =
        |before: &str, kind: &str, attributes: &str, values: &mut dyn Iterator<Item = String>, after: &str| {
            out.push_str(&format!("{before}<DataArray type=\"{kind}\" {attributes}format=\"ascii\">\n"));
            for line in values {
                out.push_str(&line);
                out.push('\n');
            }
            out.push_str(&format!("</DataArray>\n{after}"));
        };
    let coordinates =
        &mut mesh.vertices.iter().map(|[x, y, z]| format!("{} {} {}", number(*x), number(*y), number(*z)));
    array("<Points>\n", "Float64", "NumberOfComponents=\"3\" ", coordinates, "</Points>\n");
    let corners = &mut mesh.panels.iter().map(|panel| {
        let corners: Vec<String> = panel.corners().iter().map(u32::to_string).collect();
        corners.join(" ")
    });
    array("<Polys>\n", "Int64", "Name=\"connectivity\" ", corners, "");
    let ends = &mut mesh.panels.iter().scan(0, |end, panel| {
        *end += panel.corners().len();
        Some(end.to_string())
    });
    array("", "Int64", "Name=\"offsets\" ", ends, "</Polys>\n<CellData>\n");
    for (name, values) in scalars {
        let values = &mut (0..polys).map(|i| number(values.get(i).copied().unwrap_or(f64::NAN)));
        array("", "Float64", &format!("Name=\"{}\" ", escaped(name)), values, "");
    }
    out.push_str("</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n");
    out
}

fn number(x: f64) -> String {
    if x.is_nan() { "nan".to_owned() } else { format!("{x:?}") }
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
