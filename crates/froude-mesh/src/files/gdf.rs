//! WAMIT's low-order geometry: a header line, `ULEN GRAV`, `ISX ISY`, the number of panels, four corners a panel.
//!
//! Corners run counter-clockwise seen from the fluid, as ours do. Two corners at one point make a triangle. A body that is symmetric
//! about x = 0 (ISX = 1) or y = 0 (ISY = 1) is given by a half or a quarter.

use super::cursor::Cursor;
use crate::files::soup::{Read, ReadError, Soup, mirrored_whole};
use crate::mesh::Panel;
use crate::vector::Vec3;

/// Gravity in m/s² lies in this range everywhere on Earth; in ft/s² it is 32.
const GRAVITY_M_S2: std::ops::RangeInclusive<f64> = 9.7..=9.9;

pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let mut cursor = cursor_of(Cursor::new("", bytes));
    head(&mut cursor).is_ok()
}

fn cursor_of(mut cursor: Cursor<'_>) -> Cursor<'_> {
    cursor.has_commas = true;
    cursor
}

struct Head {
    gravity: f64,
    symmetry: [i64; 2],
    panels: i64,
}

fn head(cursor: &mut Cursor<'_>) -> Result<Head, ReadError> {
    cursor.line().ok_or_else(|| cursor.ends("a header line"))?;
    cursor.number("the length ULEN")?;
    let gravity = cursor.number("the gravity GRAV")?;
    cursor.line();
    let mut symmetry = || cursor.whole(-1, 1, "-1, 0 or 1, the symmetries ISX and ISY,");
    let symmetry = [symmetry()?, symmetry()?];
    cursor.line();
    let panels = cursor.whole(0, i64::from(u32::MAX), "the number of panels")?;
    if let Some(word) = cursor.word_of_line().filter(|word| word.whole().is_some()) {
        let what = format!("a file of higher order (IGDEF = {})", String::from_utf8_lossy(word.text));
        return Err(cursor.not_read(
            cursor.place(word.at),
            what,
            "export panels of low order (ILOWGDF in WAMIT writes them)",
        ));
    }
    cursor.line();
    Ok(Head { gravity, symmetry, panels })
}

pub(super) fn read(cursor: Cursor<'_>) -> Read {
    let mut cursor = cursor_of(cursor);
    let Head { gravity, symmetry, panels } = head(&mut cursor)?;
    let mut soup = Soup::default();
    for _ in 0..panels {
        let mut corner = || -> Result<u32, ReadError> {
            let point: Vec3 =
                [cursor.number("x of a corner")?, cursor.number("y of a corner")?, cursor.number("z of a corner")?];
            Ok(soup.vertex(point))
        };
        let panel = Panel::quad(corner()?, corner()?, corner()?, corner()?);
        soup.mesh.panels.push(panel);
    }
    let mut notes = Vec::new();
    if !GRAVITY_M_S2.contains(&gravity) {
        notes.push(format!("GRAV is {gravity}: the file is not in metres and seconds (in feet it is 32.17)"));
    }
    if let Some(word) = cursor.word() {
        let line = cursor.place(word.at);
        notes.push(format!("what follows the last panel, from {line}, left out"));
    }
    let mut mesh = soup.mesh;
    for (axis, (name, value)) in ["ISX", "ISY"].into_iter().zip(symmetry).enumerate() {
        match value {
            1 => mesh = mirrored_whole(&mesh, axis, &format!("{name} = 1"), &mut notes),
            -1 => notes.push(format!("{name} = -1, a wall at {} = 0, left out", ["x", "y"][axis])),
            _ => {}
        }
    }
    Ok((mesh, notes))
}
