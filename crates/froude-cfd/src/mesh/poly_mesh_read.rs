//! A mesh read back from the files of OpenFOAM, as text.

use std::path::Path;

use crate::foam_error::FoamError;
use crate::foam_mesh::{FoamMesh, without_comments};
use crate::input;
use crate::poly_mesh::PolyMesh;

impl PolyMesh {
    /// Reads points, faces, owner, neighbour and boundary of a folder.
    ///
    /// # Errors
    ///
    /// [`FoamError`]: a file is missing, is not written as text, does not hold what it says, or names what another has not.
    pub fn read(folder: &Path) -> Result<Self, FoamError> {
        let found = FoamMesh::read(folder)?;
        let read = |name: &str| {
            let path = folder.join(name);
            let text = input::text(&path).map_err(|e| FoamError::of_mesh(&path, e))?;
            Ok::<_, FoamError>((path, text))
        };
        let (path, text) = read("points")?;
        let points_m = points_of(&text).map_err(|problem| FoamError::of_mesh(&path, problem))?;
        let (path, text) = read("faces")?;
        let faces = faces_of(&text, points_m.len()).map_err(|problem| FoamError::of_mesh(&path, problem))?;
        let (path, text) = read("owner")?;
        let owner = labels_of(&text, found.cells).map_err(|problem| FoamError::of_mesh(&path, problem))?;
        if owner.len() != faces.len() {
            return Err(FoamError::of_mesh(&path, format!("it has {} entries for {} faces", owner.len(), faces.len())));
        }
        let (path, text) = read("neighbour")?;
        let neighbour = labels_of(&text, found.cells).map_err(|problem| FoamError::of_mesh(&path, problem))?;
        let mut next = neighbour.len();
        for patch in &found.patches {
            if patch.start != next || patch.count > faces.len().saturating_sub(next) {
                let problem = format!(
                    "the patch {} has {} faces from {} on; {next} of {} come before it",
                    patch.name,
                    patch.count,
                    patch.start,
                    faces.len()
                );
                return Err(FoamError::of_mesh(&folder.join("boundary"), problem));
            }
            next += patch.count;
        }
        if next != faces.len() {
            let problem = format!("its patches end at the face {next} of {}", faces.len());
            return Err(FoamError::of_mesh(&folder.join("boundary"), problem));
        }
        Ok(Self { points_m, faces, owner, neighbour, patches: found.patches, cells: found.cells })
    }
}

/// The words of a list behind the file's head, without parentheses: how many there are, then each.
struct Words<'a>(Box<dyn Iterator<Item = &'a str> + 'a>);

impl<'a> Words<'a> {
    fn of(plain: &'a str) -> Result<Self, String> {
        let (head, list) = plain.split_once('}').ok_or("it has no head")?;
        if !head.contains("ascii") {
            return Err("it is not written as text".to_owned());
        }
        let is_between = |c: char| c.is_whitespace() || c == '(' || c == ')';
        Ok(Self(Box::new(list.split(is_between).filter(|word| !word.is_empty()))))
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result<T, String> {
        let word = self.0.next().ok_or("it ends before its list does")?;
        word.parse().map_err(|_| format!("{word:?} is no number of the kind that was expected"))
    }

    /// A number below another.
    fn label(&mut self, below: usize) -> Result<u32, String> {
        let label: u32 = self.number()?;
        if (label as usize) < below { Ok(label) } else { Err(format!("it names {label}, and there are {below}")) }
    }

    /// The list, each entry read by `entry`.
    fn list<T>(mut self, entry: impl Fn(&mut Self) -> Result<T, String>) -> Result<Vec<T>, String> {
        let count: usize = self.number()?;
        let entries = (0..count).map(|_| entry(&mut self)).collect::<Result<Vec<T>, String>>()?;
        match self.0.next() {
            None => Ok(entries),
            Some(word) => Err(format!("{word:?} stands behind its list of {count}")),
        }
    }
}

fn points_of(text: &str) -> Result<Vec<[f64; 3]>, String> {
    let points =
        Words::of(&without_comments(text))?.list(|words| Ok([words.number()?, words.number()?, words.number()?]))?;
    match points.iter().position(|point: &[f64; 3]| !point.iter().all(|x| x.is_finite())) {
        None => Ok(points),
        Some(index) => Err(format!("its point {index} is not finite")),
    }
}

fn faces_of(text: &str, points: usize) -> Result<Vec<Vec<u32>>, String> {
    Words::of(&without_comments(text))?.list(|words| {
        let corners: usize = words.number()?;
        if corners < 3 {
            return Err(format!("a face has {corners} corners"));
        }
        (0..corners).map(|_| words.label(points)).collect()
    })
}

fn labels_of(text: &str, below: usize) -> Result<Vec<u32>, String> {
    Words::of(&without_comments(text))?.list(|words| words.label(below))
}

#[cfg(test)]
mod tests {
    use froude_mesh::sections::SectionBody;
    use proptest::prelude::*;

    use super::*;
    use crate::o_grid::OGrid;

    fn mesh() -> PolyMesh {
        let grid = OGrid { stations: 6, layers: 4, around: 3, first_layer_m: 0.2, outer_radius_m: 2.0, is_half: true };
        grid.mesh(&SectionBody::ellipsoid([0.3, 0.1, 0.1], 1)).unwrap().0
    }

    #[test]
    fn what_was_written_comes_back_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = mesh();
        let written = mesh.write(folder.path()).unwrap();
        assert_eq!(PolyMesh::read(&written).unwrap(), mesh);
    }

    #[test]
    fn files_that_do_not_belong_together_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mesh = mesh();
        let written = mesh.write(folder.path()).unwrap();
        let (points, faces, inner) = (mesh.points_m.len(), mesh.faces.len(), mesh.neighbour.len());
        let refused = |name: &str, from: &str, to: &str| {
            let path = written.join(name);
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.contains(from), "{from}");
            std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
            let error = PolyMesh::read(&written).unwrap_err();
            std::fs::write(&path, text).unwrap();
            let words = error.to_string();
            let (_, problem) = words.split_once(&format!("/{name}: ")).unwrap();
            let files = ": a mesh has the files points, faces, owner, neighbour and boundary of OpenFOAM";
            problem.strip_suffix(files).unwrap().to_owned()
        };
        assert_eq!(refused("points", "ascii", "binary"), "it is not written as text");
        let named = refused("faces", "\n(\n4(", "\n(\n4(9999 ");
        assert_eq!(named, format!("it names 9999, and there are {points}"));
        let shifted = refused("boundary", "startFace ", "startFace 1");
        let said = format!("the patch body has 18 faces from 1{inner} on; {inner} of {faces} come before it");
        assert_eq!(shifted, said);
        assert!(refused("owner", "\n(\n0\n", "\n(\n").contains("ends before its list does"));
    }

    proptest! {
        #[test]
        fn no_text_brings_the_reader_down(text in "[0-9(){}a-z \n.-]{0,60}") {
            for text in [text.clone(), format!("ascii}}{text}")] {
                let _ = points_of(&text);
                let _ = faces_of(&text, 9);
                let _ = labels_of(&text, 9);
            }
        }
    }
}
