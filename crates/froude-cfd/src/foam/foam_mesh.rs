//! What a case must know of its mesh: the patches, and how many cells there are.

use std::io::Read as _;
use std::path::Path;

use crate::foam_error::FoamError;
use crate::input;
use crate::poly_mesh::{Patch, PatchKind};

/// A mesh's folder as a case sees it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoamMesh {
    /// The boundary.
    pub patches: Vec<Patch>,
    /// Cells.
    pub cells: usize,
}

impl FoamMesh {
    /// Reads `boundary` and the head of `owner`.
    ///
    /// # Errors
    ///
    /// [`FoamError`]: a file is missing or invalid, or a patch has a type that cases have no conditions for.
    pub fn read(folder: &Path) -> Result<Self, FoamError> {
        let boundary = folder.join("boundary");
        let text = input::text(&boundary).map_err(|e| FoamError::of_mesh(&boundary, e))?;
        let patches = patches_of(&text).map_err(|problem| FoamError::of_mesh(&boundary, problem))?;
        let owner = folder.join("owner");
        let mut head = Vec::new();
        froude_records::read::open(&owner)
            .map_err(|e| FoamError::of_mesh(&owner, e))?
            .take(4096)
            .read_to_end(&mut head)
            .map_err(|e| FoamError::of_mesh(&owner, e))?;
        let cells = cells_of(&String::from_utf8_lossy(&head))
            .ok_or_else(|| FoamError::of_mesh(&owner, "its head has no note that says nCells"))?;
        Ok(Self { patches, cells })
    }

    /// Names of the walls, as a list of OpenFOAM.
    #[must_use]
    pub fn walls(&self) -> String {
        let names: Vec<&str> = self.patches.iter().filter(|p| p.is_wall()).map(|p| p.name.as_str()).collect();
        format!("({})", names.join(" "))
    }
}

/// The patches of a `boundary` file: `N ( name { type wall; … } … )`.
fn patches_of(text: &str) -> Result<Vec<Patch>, String> {
    let plain = without_comments(text);
    let spaced = plain.replace('{', " { ").replace('}', " } ").replace(';', " ; ");
    let body = spaced.replace('(', " ( ").replace(')', " ) ");
    let mut words = body.split_whitespace().skip_while(|word| *word != "(").skip(1).peekable();
    let mut patches = Vec::new();
    while let Some(name) = words.next() {
        if name == ")" {
            break;
        }
        if words.next() != Some("{") {
            return Err(format!("the patch {name} has no braces"));
        }
        let (mut kind, mut start, mut count) = (None, None, None);
        loop {
            match words.next() {
                None => return Err(format!("the patch {name} does not end")),
                Some("}") => break,
                Some("type") if kind.is_none() => kind = words.next(),
                Some("startFace") => start = words.next().and_then(|word| word.parse().ok()),
                Some("nFaces") => count = words.next().and_then(|word| word.parse().ok()),
                Some(_) => {}
            }
        }
        let (Some(start), Some(count)) = (start, count) else {
            return Err(format!("the patch {name} does not say its startFace and nFaces"));
        };
        let Some(known) = PatchKind::ALL.into_iter().find(|known| kind == Some(known.word())) else {
            return Err(format!(
                "the patch {name} is of type {}; cases have conditions for wall, patch, symmetryPlane, symmetry, empty",
                kind.unwrap_or("none")
            ));
        };
        patches.push(Patch { name: name.to_owned(), kind: known, start, count });
    }
    if !patches.iter().any(Patch::is_wall) {
        return Err("no patch is a wall, and forces need one".to_owned());
    }
    if !patches.iter().any(Patch::is_open) {
        return Err("no patch is open, and water must come in".to_owned());
    }
    Ok(patches)
}

pub(crate) fn without_comments(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("/*") {
        plain.push_str(&rest[..start]);
        rest = rest[start..].find("*/").map_or("", |end| &rest[start + end + 2..]);
    }
    plain.push_str(rest);
    plain.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Of `note "nPoints:9 nCells:1 …";`.
fn cells_of(head: &str) -> Option<usize> {
    let behind = head.split("nCells:").nth(1)?.trim_start();
    let digits: String = behind.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const BOUNDARY: &str = "/* a banner */\nFoamFile\n{\n format ascii; // a comment\n}\n3\n(\n body\n {\n  type wall;\n  inGroups 1(wall);\n  nFaces 9; startFace 3;\n }\n far { type patch; nFaces 2; startFace 12; }\n mid { type symmetryPlane; nFaces 1; startFace 14; }\n)\n";

    #[test]
    fn a_boundary_is_read_with_its_patches_in_order() {
        let patches = patches_of(BOUNDARY).unwrap();
        let found: Vec<_> = patches.iter().map(|p| (p.name.as_str(), p.kind.word(), p.start, p.count)).collect();
        assert_eq!(found, [("body", "wall", 3, 9), ("far", "patch", 12, 2), ("mid", "symmetryPlane", 14, 1)]);
    }

    #[test]
    fn a_boundary_that_cases_cannot_stand_in_is_refused() {
        let refused = |from: &str, to: &str| patches_of(&BOUNDARY.replace(from, to)).unwrap_err();
        assert_eq!(refused("type wall", "type patch"), "no patch is a wall, and forces need one");
        assert_eq!(refused("type patch", "type wall"), "no patch is open, and water must come in");
        assert!(refused("symmetryPlane", "cyclic").starts_with("the patch mid is of type cyclic"));
        assert_eq!(refused("nFaces 1; startFace 14; }\n)\n", ""), "the patch mid does not end");
        assert_eq!(refused("startFace 12", ""), "the patch far does not say its startFace and nFaces");
    }

    #[test]
    fn the_number_of_cells_stands_in_the_note() {
        assert_eq!(cells_of("note \"nPoints:27 nCells:8  nFaces:36\";"), Some(8));
        assert_eq!(cells_of("note \"nPoints:27\";"), None);
    }

    proptest! {
        #[test]
        fn no_text_brings_the_reader_down(cut in 0..BOUNDARY.len(), text in "[a-z(){};/* \n]{0,80}") {
            let _ = patches_of(&BOUNDARY[..cut]);
            let _ = patches_of(&text);
            let _ = cells_of(&text);
        }
    }
}
