//! A point in words.

use froude_mesh::Vec3;
use froude_records::number;

/// A point in words; what is less than a nanometre is nothing.
#[must_use]
pub fn point(at_m: Vec3, origin: &str) -> String {
    let [x, y, z] = at_m.map(|x| if x.abs() < 1e-9 { 0.0 } else { x });
    if [x, y, z] == [0.0; 3] {
        return origin.to_owned();
    }
    let [x, y, z] = [x, y, z].map(|x| number::plain(x, 6));
    format!("({x}, {y}, {z}) m from {origin}")
}
