//! Starting a case from another's last fields on the same mesh, scaled to its own speed.
//!
//! With r the ratio of speeds, U and the flux φ scale by r, p and k by r², ω and ν_t by r. That would be the same flow were the Reynolds number the same; as it is not, it is a start and no answer. Fields inside come from the other case, the conditions at the boundary are the new case's own; the flux is taken with its boundary, which the first correction of pressure replaces.

use std::path::Path;

use crate::case::Case;
use crate::foam_binary::{List, MARK, find, numbers_of, split};
use crate::foam_case::times;
use crate::foam_error::FoamError;
use crate::foam_fields::fields;
use crate::foam_mesh::FoamMesh;
use crate::input;

/// Writes the fields of `folder/0` from the last time of the case in `from`, each number scaled by the power of the ratio of speeds that its field has.
///
/// A field that the other case has not, as those of turbulence behind a laminar one, starts from the inflow.
///
/// # Errors
///
/// [`FoamError`]: the other case has no time but its start, or a file there is no binary field of OpenFOAM.
pub fn write(case: &Case, mesh: &FoamMesh, from: &Path, folder: &Path) -> Result<(), FoamError> {
    let last = times(from)?.pop().filter(|(time, _)| *time > 0.0).map(|(_, path)| path);
    let last = last.ok_or_else(|| FoamError::at(from, "it has no fields of a later time to start from"))?;
    let velocity = last.join("U");
    let its_speed_m_s = inflow_m_s(&get(&velocity)?)
        .ok_or_else(|| FoamError::at(&velocity, "it has no freestreamValue, which says the speed of its inflow"))?;
    let ratio = case.flow.speed_m_s / its_speed_m_s;
    for field in fields(case) {
        let source = last.join(field.name);
        if source.is_file() {
            let scale = if matches!(field.name, "p" | "k") { ratio.powi(2) } else { ratio };
            let (mut inner, boundary) = scaled(&source, scale)?;
            inner.truncate(boundary);
            inner.extend_from_slice(b";\n\n");
            inner.extend_from_slice(field.boundary(mesh).as_bytes());
            put(&folder.join("0").join(field.name), &inner)?;
        }
    }
    let (flux, _) = scaled(&last.join("phi"), ratio)?;
    put(&folder.join("0/phi"), &flux)
}

/// Speed of the inflow that a field of velocities was computed with, m/s.
fn inflow_m_s(velocity: &[u8]) -> Option<f64> {
    let value = &velocity[find(velocity, b"freestreamValue")?..];
    let (open, end) = (find(value, b"(")?, find(value, b")")?);
    let text = String::from_utf8_lossy(value.get(open + 1..end)?);
    let parts: Vec<f64> = text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let speed_m_s = parts.iter().map(|x| x * x).sum::<f64>().sqrt();
    (speed_m_s > 0.0 && speed_m_s.is_finite()).then_some(speed_m_s)
}

fn get(path: &Path) -> Result<Vec<u8>, FoamError> {
    input::bytes(path).map_err(|e| FoamError::at(path, e))
}

fn put(path: &Path, content: &[u8]) -> Result<(), FoamError> {
    std::fs::write(path, content).map_err(|e| FoamError::at(path, e))
}

/// The file's bytes with all its numbers scaled, and where its internal field ends.
fn scaled(path: &Path, scale: f64) -> Result<(Vec<u8>, usize), FoamError> {
    scaled_field(&get(path)?, scale).map_err(|problem| FoamError::at(path, problem))
}

fn scaled_field(content: &[u8], scale: f64) -> Result<(Vec<u8>, usize), String> {
    let (head, mut rest) = split(content)?;
    let mut scaled = head.to_vec();
    let mut internal_end = None;
    while let Some(at) = find(rest, MARK) {
        let (text, value) = rest.split_at(at + MARK.len());
        scaled.extend_from_slice(text);
        rest = if value.starts_with(b"List<") {
            let list = List::read(value)?;
            scaled.extend_from_slice(list.head);
            for number in list.numbers {
                scaled.extend_from_slice(&(f64::from_le_bytes(*number) * scale).to_le_bytes());
            }
            scaled.push(b')');
            list.rest
        } else {
            scale_text(value, scale, &mut scaled)?
        };
        internal_end.get_or_insert(scaled.len());
    }
    scaled.extend_from_slice(rest);
    Ok((scaled, internal_end.ok_or("its internalField has no value")?))
}

/// `1e-06;`, `(0.4 0 0);`, or the `0();` of an empty list: writes it scaled, and returns what follows it.
fn scale_text<'a>(value: &'a [u8], scale: f64, scaled: &mut Vec<u8>) -> Result<&'a [u8], String> {
    let end = value.iter().position(|byte| *byte == b';').ok_or("a value does not end")?;
    let (text, rest) = value.split_at(end);
    let text = String::from_utf8_lossy(text);
    if text.trim() == "0()" {
        scaled.extend_from_slice(text.as_bytes());
        return Ok(rest);
    }
    let numbers: Vec<String> = numbers_of(&text)?.into_iter().map(|x| format!("{:e}", x * scale)).collect();
    let numbers = numbers.join(" ");
    scaled.extend_from_slice(if text.contains('(') { format!("({numbers})") } else { numbers }.as_bytes());
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn field() -> Vec<u8> {
        let mut content = b"FoamFile\n{\nformat binary;\narch \"LSB;label=32;scalar=64\";\n}\ninternalField   nonuniform List<vector> \n2\n(".to_vec();
        for number in [1.0_f64, 2.0, -3.0, 0.5, 0.0, 1e-300] {
            content.extend_from_slice(&number.to_le_bytes());
        }
        content.extend_from_slice(b")\n;\n\nboundaryField\n{\nfar { type calculated; value uniform (0.4 0 -1e-3); }\nnone { value nonuniform 0(); }\n}\n");
        content
    }

    #[test]
    fn numbers_of_lists_and_of_uniform_values_are_scaled() {
        let (scaled, end) = scaled_field(&field(), 2.0).unwrap();
        let start = find(&scaled, b"(").unwrap() + 1;
        let numbers: Vec<f64> =
            scaled[start..start + 48].as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
        assert_eq!(numbers, [2.0, 4.0, -6.0, 1.0, 0.0, 2e-300]);
        assert!(scaled[end..].starts_with(b"\n;\n\nboundaryField"));
        assert!(find(&scaled, b"value uniform (8e-1 0e0 -2e-3);").is_some());
        assert!(find(&scaled, b"nonuniform 0();").is_some());
    }

    #[test]
    fn the_speed_of_an_inflow_is_that_of_the_open_water() {
        assert_eq!(inflow_m_s(b"far { freestreamValue uniform (-0.3 4e-1 0); value uniform (1 1 1); }"), Some(0.5));
        for text in ["far { value uniform (1 1 1); }", "freestreamValue uniform (0 0 0)", "freestreamValue uniform )x("]
        {
            assert_eq!(inflow_m_s(text.as_bytes()), None);
        }
    }

    #[test]
    fn what_is_no_binary_field_is_refused_with_what_it_is() {
        let with = |from: &str, to: &str| {
            let content = field();
            let at = find(&content, from.as_bytes()).unwrap();
            let edited = [&content[..at], to.as_bytes(), &content[at + from.len()..]].concat();
            scaled_field(&edited, 2.0).unwrap_err()
        };
        assert_eq!(with("binary", "ascii"), "it is not written in binary numbers of 64 bits, the lowest byte first");
        assert_eq!(with("internalField", "field"), "it has no internalField");
        assert_eq!(with("vector", "tensor"), "a list is of the kind List<tensor>; expected scalar or vector");
        assert_eq!(with("\n2\n", "\n3\n"), "a list of 3 does not end where its numbers do");
        assert_eq!(with("\n2\n", "\n900\n"), "a list of 900 ends before its numbers do");
        assert_eq!(with("0.4", "x"), "\"x\" is no number");
    }

    proptest! {
        #[test]
        fn no_bytes_bring_the_reader_down(cut in 0..300_usize, at in 0..300_usize, with in any::<Vec<u8>>()) {
            let content = field();
            let _ = scaled_field(&content[..cut.min(content.len())], 2.0);
            let at = at.min(content.len() - 1);
            let mut edited = content.clone();
            edited.splice(at..=at, with);
            let _ = scaled_field(&edited, 2.0);
            let _ = inflow_m_s(&edited);
        }
    }
}
