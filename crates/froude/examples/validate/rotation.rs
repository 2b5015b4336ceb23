//! Rotation: a link about its own centre on its twin, as the example campaign declares it.

use std::error::Error;
use std::path::Path;

use froude::fit::budget::Uncertain;
use froude::hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};
use froude::methods::tank::driven::forecast::Forecast;
use froude::methods::tank::rotation::derive::C_F_DIFFERENCE;
use froude::methods::tank::rotation::{LAMBDAS, Rotation};

use crate::claims::{Claims, Verdict};
use crate::driven::Case;

const SECTION: &str = "Rotation: a link about its own centre by its twin";
/// C_f^II and C_d^II of the f2 model in the circulation tank, USR Table 9; C_A of the tank, Table 12.
const TANK: LinkCoefficients = LinkCoefficients { c_f: 0.0544, c_d: 1.8601, c_a: 1.277, c_m: 1.0 };

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let case = Case::read(root, "mamba-rotation", &["delay"], 141)?;
    laws(claims, &case)?;
    beforehand(claims, &case)?;
    for noise in [("1 mN m", 1.0), ("10 mN m", 10.0)] {
        case.coverage(claims, SECTION, noise, seeds, &[C_F_DIFFERENCE])?;
    }
    Ok(())
}

/// λ₃ of the Mamba link by the two laws.
fn laws(claims: &mut Claims, case: &Case<Rotation>) -> Result<(), Box<dyn Error>> {
    let link = case.twin.setup.method.link.ok_or("no link")?;
    let of = |drag: YawDrag| LinkParameters::of(&link, 1025.0, &TANK, YawInertia::StripTheory, drag);
    let [friction, across] = [YawDrag::FrictionStrip, YawDrag::CrossFlow].map(|drag| of(drag).lambda_3_kg_m2);
    claims.holds(
        SECTION,
        "λ₃ of the Mamba link with the f2 set of the tank, by friction and by drag across it",
        "1.41e-4 and 3.68e-3 N m s², 26 times apart, computed beforehand",
        format!("{friction:.3e} and {across:.3e}, {:.1} times", across / friction),
        (friction - 1.41e-4).abs() < 0.5e-6 && (across - 3.68e-3).abs() < 0.5e-5,
    );
    Ok(())
}

/// Standard uncertainties to expect, against a second program and against the figures that were computed beforehand.
fn beforehand(claims: &mut Claims, case: &Case<Rotation>) -> Result<(), Box<dyn Error>> {
    let percent = |f: &Forecast, j: usize| 100.0 * f.expected[j].combined.standard / case.twin.truth.coefficients[j];
    let mut exactly = case.twin.setup.clone();
    for constant in &mut exactly.constants {
        constant.known = constant.known.map(|known| Uncertain::new(known.value, 0.0));
    }
    let found = case.forecast(&exactly, case.sensors())?;
    let r = |f: &Forecast| f.correlation(LAMBDAS[1], LAMBDAS[2]).unwrap_or(0.0);
    let figures = [percent(&found, 0), percent(&found, 1), percent(&found, 2), r(&found)];
    let words = |f: [f64; 4]| format!("{:.3} %, {:.2} %, {:.2} %, r {:.3}", f[0], f[1], f[2], f[3]);
    // The servo's sine is 0.06 % larger than the one of the other program: 0.5 % of each.
    let second = [0.9218, 10.643, 5.949, -0.9360];
    claims.holds(
        SECTION,
        "standard uncertainty of λ₁, λ₂, λ₃ to expect at 1 mN m correlated over 0.5 s, and the correlation of λ₂ with λ₃, rig and delay known",
        &format!("{} ± 0.5 %, by a second program (dense covariance matrices, rotation_forecast.py)", words(second)),
        words(figures),
        figures.iter().zip(second).all(|(a, b)| (a / b - 1.0).abs() < 0.005),
    );
    let full = case.forecast(&case.twin.setup, case.sensors())?;
    let figures = [percent(&full, 0), percent(&full, 1), percent(&full, 2), r(&full)];
    claims.add(
        SECTION,
        "the same with the full budget (inertia 1e-5 kg m², delay 5 ms, gain 0.2 %)",
        "λ₁ to 1 %, λ₂ to 8 %, correlated by −0.92, computed beforehand for a setting that is not stated",
        words(figures),
        Verdict::Finding,
    );
    Ok(())
}
