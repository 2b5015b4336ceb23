//! Nemoh's mesh: `2 symmetry`, vertices `n x y z` until `0 0. 0. 0.`, panels of four numbers until `0 0 0 0`.
//!
//! Symmetry 1 means that the file has the half on one side of the plane y = 0. A panel with a number twice is a triangle.

use super::cursor::Cursor;
use crate::files::soup::{Read, ReadError, mirrored_whole};
use crate::mesh::{Mesh, Panel};

pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new("", bytes);
    cursor.has_commas = true;
    head(&mut cursor).is_ok() && cursor.word().is_some_and(|word| word.text == b"1" || word.text == b"0")
}

fn head(cursor: &mut Cursor<'_>) -> Result<bool, ReadError> {
    cursor.whole(2, 2, "2, the first number of a Nemoh mesh,")?;
    let symmetry = cursor.whole(0, 1, "the symmetry, 0 or 1,")?;
    cursor.line();
    Ok(symmetry == 1)
}

pub(super) fn read(mut cursor: Cursor<'_>) -> Read {
    cursor.has_commas = true;
    let is_half = head(&mut cursor)?;
    let mut mesh = Mesh::default();
    loop {
        let next = mesh.vertices.len() as i64 + 1;
        let expected = format!("vertex {next}, or 0 after the last,");
        let word = cursor.word().ok_or_else(|| cursor.ends(&expected))?;
        let number = word.whole().filter(|n| *n == next || *n == 0);
        let number = number.ok_or_else(|| cursor.unexpected(word.at, &word.shown(), &expected))?;
        let [x, y, z] = ["x of a vertex", "y of a vertex", "z of a vertex"];
        let point = [cursor.number_of_line(x)?, cursor.number_of_line(y)?, cursor.number_of_line(z)?];
        cursor.line();
        if number == 0 {
            break;
        }
        mesh.vertices.push(point);
    }
    let last = mesh.vertices.len() as i64;
    let expected = format!("a vertex from 1 to {last}, or 0 after the last panel,");
    loop {
        let mut panel = [0; 4];
        let first = cursor.word().ok_or_else(|| cursor.ends(&expected))?;
        panel[0] = cursor.as_whole(first, 0, last, &expected)?;
        let low = i64::from(panel[0] > 0);
        for corner in &mut panel[1..] {
            *corner = cursor.whole(low, low * last, &expected)?;
        }
        cursor.line();
        if panel[0] == 0 {
            break;
        }
        let [a, b, c, d] = panel.map(|n| (n - 1) as u32);
        mesh.panels.push(Panel::quad(a, b, c, d));
    }
    let mut notes = Vec::new();
    if let Some(word) = cursor.word() {
        notes.push(format!("what follows the last panel, from {}, left out", cursor.place(word.at)));
    }
    if is_half {
        mesh = mirrored_whole(&mesh, 1, "symmetry 1", &mut notes);
    }
    Ok((mesh, notes))
}
