//! Files beside the record: the pressure on the body, and what other programs read.

use std::path::Path;

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_identify::method::Export;
use froude_panel::matrix::{AddedMass, congruent};
use froude_panel::problem::Frame;

use super::frame::{Axes, Orientation};
use super::options::Asked;
use super::pressure::pressure;
use crate::error::AddedMassError;
use crate::files::AddedMassFile;
use crate::outcome::{BodyOutcome, Case};

/// The pressure on the body, and the files that were asked for.
pub(super) fn extras(outcome: &BodyOutcome, job: &Asked) -> Result<Vec<Export>, AddedMassError> {
    let pressure = pressure(&outcome.cases[0].refined.finest, outcome.density_kg_m3, &outcome.frame);
    let mut out = vec![Export { name: "pressure.vtp".to_owned(), content: pressure.into_bytes() }];
    let body =
        outcome.name.chars().map(|c| if c.is_ascii_alphanumeric() || " -.".contains(c) { c } else { '-' }).collect();
    let bodies = [body];
    for extension in &job.export {
        let frame = if is_of_waves(extension) { wave_frame(job) } else { outcome.frame };
        let rows = |case: &Case| -> Vec<Vec<f64>> {
            let own = AddedMass { matrix: case.refined.value, asymmetry: 0.0, frame: outcome.frame };
            let there = own.seen_from(&frame).matrix;
            there.iter().map(|row| row.iter().map(|a| outcome.density_kg_m3 * a).collect()).collect()
        };
        // Deeply submerged both limits are the same.
        let limit = |is_lid: bool| outcome.cases.iter().rfind(|c| c.is_lid.is_none_or(|l| l == is_lid)).map(rows);
        let (zero, infinite) = (limit(true), limit(false));
        let file = AddedMassFile {
            density_kg_m3: outcome.density_kg_m3,
            gravity_m_s2: GRAVITY_M_S2,
            length_m: 1.0,
            bodies: &bodies,
            zero_frequency: zero.as_deref(),
            infinite_frequency: infinite.as_deref(),
        };
        out.push(export(&file, extension)?);
    }
    Ok(out)
}

/// A matrix for another program.
pub(super) fn export(file: &AddedMassFile<'_>, extension: &str) -> Result<Export, AddedMassError> {
    let name = format!("added-mass.{extension}");
    Ok(Export { content: file.bytes(Path::new(&name))?, name })
}

/// Whether wave programs read a format: they take z up, about the origin of the mesh.
fn is_of_waves(extension: &str) -> bool {
    extension != "csv"
}

/// The frame of the files for wave programs.
fn wave_frame(job: &Asked) -> Frame {
    let mesh = job.orientation.unwrap_or_default();
    Frame { axes: mesh.wave_axes().vectors(mesh), ..Frame::at([0.0; 3]) }
}

/// The message about the exports of one body.
pub(super) fn words(job: &Asked) -> Vec<String> {
    let mut out = Vec::new();
    if job.export.iter().any(|e| is_of_waves(e)) {
        out.push(format!(
            "The files for WAMIT and Capytaine are about the origin of the mesh, in {}, as wave programs ask for.",
            wave_words(job.orientation.unwrap_or_default())
        ));
    }
    if job.export.contains(&"csv") {
        out.push("The CSV has the axes and the point of the record.".to_owned());
    }
    out
}

fn wave_words(mesh: Orientation) -> String {
    match mesh.wave_axes() {
        Axes::Mesh => "the axes of the mesh, z up".to_owned(),
        axes => format!("axes with {}", axes.own_words()),
    }
}

/// The same of parts, each about its own point; links have no mesh of their own that could lie otherwise.
pub(super) fn words_of_parts(job: &Asked, is_links: bool) -> Option<String> {
    job.export.iter().any(|e| is_of_waves(e)).then(|| {
        let mesh = job.orientation.unwrap_or_default();
        let z = if job.axes == mesh.wave_axes() {
            "the axes of the record".to_owned()
        } else if is_links {
            format!("axes with {}", Axes::Enu.own_words())
        } else {
            wave_words(mesh)
        };
        format!("The files for WAMIT and Capytaine are in {z}, as wave programs ask for, every part about its own point; the CSV is that of the record.")
    })
}

/// A matrix of parts in the axes that a format has, each part about its own point.
pub(super) fn of_parts_for_program(matrix: &[Vec<f64>], extension: &str, job: &Asked) -> Vec<Vec<f64>> {
    let mesh = job.orientation.unwrap_or_default();
    if !is_of_waves(extension) || job.axes == mesh.wave_axes() {
        return matrix.to_vec();
    }
    let own = Frame { axes: job.axes.vectors(mesh), ..Frame::at([0.0; 3]) };
    let t = own.motions_from(&wave_frame(job));
    let mut out = matrix.to_vec();
    for p in (0..matrix.len()).step_by(6) {
        for q in (0..matrix.len()).step_by(6) {
            let block = core::array::from_fn(|i| core::array::from_fn(|j| matrix[p + i][q + j]));
            for (i, row) in congruent(&block, &t).iter().enumerate() {
                out[p + i][q..q + 6].copy_from_slice(row);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::frame::Direction;
    use super::*;

    fn job(axes: Axes, orientation: Option<Orientation>, export: &[&'static str]) -> Asked {
        Asked { axes, orientation, export: export.to_vec(), ..Asked::of(Path::new("pod.obj")) }
    }

    const EVERY_PART: &str =
        ", as wave programs ask for, every part about its own point; the CSV is that of the record.";

    /// Orientations of a mesh, where they were said, and the axes that its files for wave programs are then in.
    fn lies() -> [(Option<Orientation>, &'static str); 4] {
        let up = |axis, is_against| Orientation::new(Direction::X, Direction { axis, is_against }).unwrap();
        let forward = |axis, is_against| Orientation::new(Direction { axis, is_against }, Direction::Z).unwrap();
        let turned = "axes with x forward, y port, z up (ROS REP 103)";
        [
            (None, "the axes of the mesh, z up"),
            (Some(forward(0, true)), "the axes of the mesh, z up"),
            (Some(up(2, true)), turned),
            (Some(up(1, false)), turned),
        ]
    }

    #[test]
    fn the_words_about_files_of_parts_say_the_axes_that_the_files_are_in() {
        for (orientation, of_the_mesh) in lies() {
            let mesh = orientation.unwrap_or_default();
            for axes in [Axes::Mesh, Axes::Ned, Axes::Enu] {
                let job = job(axes, orientation, &["1", "csv"]);
                let said = words_of_parts(&job, false).unwrap();
                let stays = axes == mesh.wave_axes();
                let where_ = if stays { "the axes of the record" } else { of_the_mesh };
                assert_eq!(said, format!("The files for WAMIT and Capytaine are in {where_}{EVERY_PART}"), "{axes:?}");
                // What is said is what is done: the record's own axes are left alone, and no others.
                let matrix: Vec<Vec<f64>> =
                    (0..6).map(|i| (0..6).map(|j| f64::from(1 + 6 * i.min(j) + i.max(j))).collect()).collect();
                let is_same = of_parts_for_program(&matrix, "1", &job) == matrix;
                let [own, wave] = [axes.vectors(mesh), wave_frame(&job).axes];
                assert_eq!(is_same, own == wave, "{axes:?} {orientation:?}");
                assert!(!stays || is_same, "{axes:?} {orientation:?}");
                assert_eq!(of_parts_for_program(&matrix, "csv", &job), matrix);
            }
        }
    }

    #[test]
    fn links_have_no_mesh_whose_axes_could_be_named_and_a_csv_alone_needs_no_word() {
        let said = words_of_parts(&job(Axes::Ned, None, &["nc"]), true).unwrap();
        assert!(said.contains("are in axes with x forward, y port, z up (ROS REP 103), as wave programs"), "{said}");
        let said = words_of_parts(&job(Axes::Mesh, None, &["nc"]), true).unwrap();
        assert!(said.contains("are in the axes of the record, as wave programs"), "{said}");
        assert_eq!(words_of_parts(&job(Axes::Ned, None, &["csv"]), true), None);
        assert_eq!(words_of_parts(&job(Axes::Ned, None, &[]), false), None);
    }
}
