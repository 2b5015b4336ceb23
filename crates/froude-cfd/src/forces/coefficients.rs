//! Force and moment coefficients as loads.
//!
//! F = ½ρU²A (C_d d + C_s s + C_l l) along the directions d, s, l of drag, side force and lift, and M = ½ρU²A L (C_roll r + C_pitch p + C_yaw y); U, A and L are
//! magUInf, Aref and lRef. A load along or about an axis is known if the directions that have a coefficient span it: `forceCoeffs.dat` of OpenFOAM.org has no side force.
//!
//! **Source.** OpenFOAM, `forceCoeffs.C`: coefficients over `pDyn*Aref`, moments over `pDyn*Aref*lRef`, with `pDyn = 0.5*rhoRef*sqr(magUInf)`.

use std::path::Path;

use froude_identify::method::MethodError;

use super::dat::{Dat, triple};
use crate::history::Sample;

/// Columns of forces and moments, with the comment lines that state their directions.
const FORCES: [(&str, &str); 3] = [("Cd", "dragDir"), ("Cs", "sideDir"), ("Cl", "liftDir")];
const MOMENTS: [(&str, &str); 4] =
    [("CmRoll", "rollAxis"), ("CmPitch", "pitchAxis"), ("Cm", "pitchAxis"), ("CmYaw", "yawAxis")];
/// Directions are square to each other up to this, as files round them.
const ROUNDING: f64 = 2e-3;

/// What the campaign declares of coefficients: magUInf (m/s), Aref (m²), lRef (m), and the density of the water (kg/m³).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Declared {
    pub(super) speed_m_s: Option<f64>,
    pub(super) area_m2: Option<f64>,
    pub(super) length_m: Option<f64>,
    pub(super) density_kg_m3: Option<f64>,
}

/// Loads of every row in N and N m, axes of the mesh, and which of them the file determines.
pub(super) fn samples(path: &Path, file: &Dat, declared: Declared) -> Result<(Vec<Sample>, [bool; 6]), MethodError> {
    let refuse = |what: String| MethodError::input(path, what);
    let reference = |key: &str, own: &str, declared: Option<f64>, unit: &str| {
        let stated = match file.stated(key) {
            None => None,
            Some(text) => Some(
                text.parse::<f64>()
                    .ok()
                    .filter(|x| x.is_finite() && *x > 0.0)
                    .ok_or_else(|| refuse(format!("{key} is {text:?}; expected a number above zero")))?,
            ),
        };
        match (stated, declared) {
            (Some(stated), Some(declared)) if (stated - declared).abs() > 1e-4 * declared => Err(refuse(format!(
                "{key} is {stated} in the comment lines, and {own} = {declared} {unit} in the campaign; leave out the wrong one"
            ))),
            (Some(x), _) | (None, Some(x)) => Ok(x),
            (None, None) => Err(refuse(format!(
                "its comment lines do not state {key}; write {own} = \"1 {unit}\", as it is in the function object"
            ))),
        }
    };
    let speed = reference("magUInf", "mag_u_inf", declared.speed_m_s, "m/s")?;
    let area = reference("Aref", "a_ref", declared.area_m2, "m^2")?;
    let length = reference("lRef", "l_ref", declared.length_m, "m")?;
    let density = declared.density_kg_m3.ok_or_else(|| {
        refuse("coefficients become loads by the density of the water; write density = \"998 kg/m^3\" in [fluid], or its temperature".to_owned())
    })?;
    let force = 0.5 * density * speed * speed * area;
    let (forces, moments) = (directions(file, &FORCES).map_err(refuse)?, directions(file, &MOMENTS).map_err(refuse)?);
    if forces.is_empty() {
        return Err(refuse("its comment lines state no direction (dragDir, liftDir) of a coefficient; use the files of the function object forces".to_owned()));
    }
    let sum = |all: &[(&str, [f64; 3])], row: usize, scale: f64| -> [f64; 3] {
        let each =
            |k: usize| all.iter().map(|(column, d)| file.number(row, column).unwrap_or(f64::NAN) * d[k]).sum::<f64>();
        std::array::from_fn(|k| scale * each(k))
    };
    let samples = file.times.iter().enumerate().map(|(row, time)| {
        let ([x, y, z], [k, m, n]) = (sum(&forces, row, force), sum(&moments, row, force * length));
        Sample { time: *time, pressure: [x, y, z, k, m, n], viscous: [0.0; 6] }
    });
    let is_spanned =
        |all: &[(&str, [f64; 3])], k: usize| all.iter().map(|(_, d)| d[k] * d[k]).sum::<f64>() > 1.0 - ROUNDING;
    let is_known = std::array::from_fn(|k| if k < 3 { is_spanned(&forces, k) } else { is_spanned(&moments, k - 3) });
    Ok((samples.collect(), is_known))
}

/// The columns of a file whose directions it states: unit vectors square to each other.
fn directions<'a>(file: &Dat, columns: &[(&'a str, &str)]) -> Result<Vec<(&'a str, [f64; 3])>, String> {
    let mut out: Vec<(&str, [f64; 3])> = Vec::new();
    for (column, key) in columns {
        let (true, Some(text)) = (file.columns.iter().any(|own| own == column), file.stated(key)) else { continue };
        let d = triple(text).ok_or_else(|| format!("{key} is {text:?}; expected three numbers in parentheses"))?;
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let is_unit = (dot(&d, &d) - 1.0).abs() < ROUNDING;
        if !is_unit || out.iter().any(|(_, other)| dot(other, &d).abs() > ROUNDING) {
            return Err(format!("{key} is {text}; expected a direction of length 1, square to the others"));
        }
        out.push((column, d));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::super::dat::read;
    use super::*;

    const WATER: Declared = Declared { speed_m_s: None, area_m2: None, length_m: None, density_kg_m3: Some(998.0) };

    /// OpenFOAM 1912 wrote both for one flow, with six digits after the point.
    #[test]
    fn coefficients_of_openfoam_are_its_forces() {
        let [force, moment, coefficient] = [
            include_str!("../../tests/data/foam-1912/force.dat"),
            include_str!("../../tests/data/foam-1912/moment.dat"),
            include_str!("../../tests/data/foam-1912/coefficient.dat"),
        ]
        .map(|text| read(text).unwrap());
        let forces = force.samples(Some(&moment)).unwrap();
        let (found, is_known) = samples(Path::new("c.dat"), &coefficient, WATER).unwrap();
        assert_eq!((found.len(), is_known), (30, [true; 6]));
        for (a, b) in found.iter().zip(&forces) {
            let (a, b) = (a.total(), b.total());
            let largest = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-6 * largest), "{a:?} instead of {b:?}");
        }
    }

    #[test]
    fn two_directions_do_not_determine_the_third() {
        let text = "# Force coefficients\n# liftDir : (0 0 1)\n# dragDir : (1 0 0)\n# pitchAxis : (0 1 0)\n# magUInf : 2\n# lRef : 1\n# Aref : 0.5\n# Time Cm Cd Cl Cl(f) Cl(r)\n1 0.1 0.2 0.3 0.1 0.2\n";
        let of = |text: &str, declared| samples(Path::new("c.dat"), &read(text).unwrap(), declared);
        let (found, is_known) = of(text, WATER).unwrap();
        assert_eq!(is_known, [true, false, true, false, true, false]);
        let scale = 0.5 * 998.0 * 4.0 * 0.5;
        assert!((found[0].total()[0] - 0.2 * scale).abs() < 1e-9 && (found[0].total()[4] - 0.1 * scale).abs() < 1e-9);
        let refused = |text: &str, declared| of(text, declared).unwrap_err().to_string();
        assert!(
            refused(&text.replace("# Aref : 0.5\n", ""), WATER).contains("do not state Aref; write a_ref = \"1 m^2\"")
        );
        assert!(refused(&text.replace("(1 0 0)", "(1 1 0)"), WATER).contains("expected a direction of length 1"));
        assert!(
            refused(text, Declared { area_m2: Some(2.0), ..WATER })
                .contains("Aref is 0.5 in the comment lines, and a_ref = 2 m^2")
        );
        assert!(refused(text, Declared::default()).contains("write density ="));
    }
}
