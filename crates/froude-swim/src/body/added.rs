//! Added mass of each module: in numbers, by C_A of a record, or by the 6 × 6 matrix of one.
//!
//! | what is named | what a module gets |
//! | --- | --- |
//! | numbers | the matrix as it stands |
//! | C_A, with the volume of a link that it refers to | μ = ρ V C_A of sway, and λ₁ = μ l²/3 of yaw (strips) |
//! | A11 to A66 of potential flow, of one module, in axes with z down | the matrix, times the robot's water over that of the record |
//!
//! **Source.** USR eq. 4 and 8 for C_A.

use froude_records::estimate::Estimate;

use crate::robot::{RobotError, measure, selected};
use crate::robot_file::{AddedFile, FromRecord, ModuleFile, RobotFile, negative};

/// Law of a record with a matrix.
const MATRIX: &str = "added_mass_6x6";
/// A module's length may be so many times that of the body of a record, or as small a part.
const OF_A_MODULE: f64 = 1.5;

/// Axes in which a robot's matrices are.
const AXES: &str = "x forward, y starboard, z down";

/// Added mass of a module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Added {
    /// In the order surge, sway, heave, roll, pitch, yaw.
    pub(crate) matrix: [[f64; 6]; 6],
    /// By C_A: sway and yaw alone, of a link.
    pub(crate) is_by_link: bool,
}

/// Added mass of every module, with the ids of the records that it comes from.
pub(crate) fn added_masses(file: &RobotFile) -> Result<(Vec<Added>, Vec<String>), RobotError> {
    let (mut all, mut ids) = (Vec::with_capacity(file.modules.len()), Vec::new());
    let mut known: Vec<(&FromRecord, f64, Added)> = Vec::new();
    for module in &file.modules {
        let from = module.added.as_ref().unwrap_or(&file.added_mass);
        let found = match from {
            AddedFile::Declared(matrix) => Added { matrix: *matrix, is_by_link: false },
            AddedFile::Record(from) => {
                let length = module.link.half_length_m;
                if let Some((.., found)) = known.iter().find(|(known, l, _)| *known == from && *l == length) {
                    *found
                } else {
                    let (found, id) = of_record(file, module, from)?;
                    known.push((from, length, found));
                    if !ids.contains(&id) {
                        ids.push(id);
                    }
                    found
                }
            }
        };
        all.push(found);
    }
    Ok((all, ids))
}

fn of_record(file: &RobotFile, module: &ModuleFile, from: &FromRecord) -> Result<(Added, String), RobotError> {
    let (record, at) = selected(from)?;
    let e = &record.estimates[at];
    if e.law.name == MATRIX {
        let matrix = matrix(file, module, from, e)?;
        return Ok((Added { matrix, is_by_link: false }, e.id.clone()));
    }
    let Some((_, c_a)) = c_a_of(e) else {
        let problem = format!(
            "{} has no C_A. The added mass of a link comes from C_A with the volume of a link that it refers to (forced oscillation, accelerated tow), or is written in numbers: \
             added_mass = {{ sway = \"1.65 kg\", yaw = \"4.5e-3 kg m^2\" }}",
            e.id
        );
        return Err(RobotError::of(&from.path, problem));
    };
    if c_a.is_nan() || c_a <= 0.0 {
        return Err(RobotError::of(&from.path, format!("C_A of {} is {c_a}; an added mass is above zero", e.id)));
    }
    let volume = measure(from, e, "link_volume", "C_A refers to, of a link")?;
    let (sway, l) = (file.density_kg_m3 * volume * c_a, module.link.half_length_m);
    let mut matrix = [[0.0; 6]; 6];
    (matrix[1][1], matrix[5][5]) = (sway, sway * l * l / 3.0);
    Ok((Added { matrix, is_by_link: true }, e.id.clone()))
}

/// C_A of sway, with its name.
pub(crate) fn c_a_of(e: &Estimate) -> Option<(&'static str, f64)> {
    ["C_A", "C_Ay"].into_iter().find_map(|name| Some((name, e.coefficients.get(name)?.value?)))
}

fn matrix(file: &RobotFile, module: &ModuleFile, from: &FromRecord, e: &Estimate) -> Result<[[f64; 6]; 6], RobotError> {
    let wrong = |problem: String| RobotError::of(&from.path, format!("the added mass of {} {problem}", e.id));
    let length = measure(from, e, "length", "matrix refers to")?;
    let own = 2.0 * module.link.half_length_m;
    if !(1.0 / OF_A_MODULE..=OF_A_MODULE).contains(&(length / own)) {
        return Err(wrong(format!(
            "is of a body that is {length} m long, and module {:?} is {own} m: name the record of one module",
            module.name
        )));
    }
    if !e.frame.words.contains(AXES) {
        return Err(wrong(format!(
            "is in {:?}; a robot's matrices are in axes with x forward, y to starboard and z down: make it with --axes ned",
            e.frame.words
        )));
    }
    let water = file.density_kg_m3 / measure(from, e, "density", "matrix refers to")?;
    let mut all = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in i..6 {
            let name = format!("A{}{}", i + 1, j + 1);
            let Some(value) = e.coefficients.get(&name).and_then(|c| c.value) else {
                return Err(RobotError::undetermined(from, e, &name));
            };
            (all[i][j], all[j][i]) = (water * value, water * value);
        }
    }
    match negative(&all) {
        Some(least) => Err(wrong(format!(
            "is not positive semi-definite: with its diagonal scaled to one, some motion has an inertia of {least:.3e}"
        ))),
        None => Ok(all),
    }
}
