//! How a case is solved: the folders `system` and `constant`.
//!
//! Steady: SIMPLEC with little relaxation, momentum by second-order upwind, turbulence by first order, which keeps omega positive. In time: PIMPLE with two outer corrections, momentum of laminar cases by central differences.

use crate::case::{Case, Model};
use crate::dictionary::{Dictionary, vector};
use crate::foam_mesh::FoamMesh;

/// How a case goes through time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// Iterations towards a state that stands still.
    Steady,
    /// Steps of time.
    Transient {
        /// Length of a step, s.
        step_s: f64,
    },
}

impl Pace {
    /// The program that goes so.
    #[must_use]
    pub fn program(self) -> &'static str {
        match self {
            Self::Steady => "simpleFoam",
            Self::Transient { .. } => "pimpleFoam",
        }
    }
}

/// `system/controlDict` of a run from one time or iteration, which is the last that was written, to another.
///
/// At its end it writes all fields and the y+ of the walls; at each step forces, moments and the largest speed.
#[must_use]
pub fn control(case: &Case, mesh: &FoamMesh, pace: Pace, [from, to]: [f64; 2]) -> Dictionary {
    let step = match pace {
        Pace::Steady => 1.0,
        Pace::Transient { step_s } => step_s,
    };
    let each_step = |kind: &str, library: &str| {
        Dictionary::default()
            .with("type", kind)
            .with("libs", format!("({library})"))
            .with("writeControl", "timeStep")
            .with("writeInterval", 1)
            .with("log", "no")
    };
    let forces = each_step("forces", "forces")
        .with("patches", mesh.walls())
        .with("rho", "rhoInf")
        .with("rhoInf", case.water.density_kg_m3)
        .with("CofR", vector(case.reference.point_m));
    let speed = each_step("fieldMinMax", "fieldFunctionObjects")
        .with("fields", "(U)")
        .with("mode", "magnitude")
        .with("location", "yes");
    let y_plus = Dictionary::default()
        .with("type", "yPlus")
        .with("libs", "(fieldFunctionObjects)")
        .with("executeControl", "writeTime")
        .with("writeControl", "writeTime")
        .with("log", "no");
    Dictionary::default()
        .with("application", pace.program())
        .with("startFrom", "latestTime")
        .with("startTime", 0)
        .with("stopAt", "endTime")
        .with("endTime", number(to))
        .with("deltaT", number(step))
        .with("writeControl", "runTime")
        .with("writeInterval", number(to - from))
        .with("writeFormat", "binary")
        .with("writePrecision", 12)
        .with("writeCompression", "off")
        .with("timeFormat", "general")
        .with("timePrecision", 9)
        .with("runTimeModifiable", "no")
        .with("functions", Dictionary::default().with("forces", forces).with("speed", speed).with("yPlus", y_plus))
}

/// Without an exponent, as names of times are made of it.
fn number(value: f64) -> String {
    value.to_string()
}

/// `system/fvSchemes`.
#[must_use]
pub fn schemes(case: &Case, pace: Pace) -> Dictionary {
    let (time, bounded) = match pace {
        Pace::Steady => ("steadyState", "bounded "),
        Pace::Transient { .. } => ("backward", ""),
    };
    // Upwinding damps the vortices that a laminar case in time is there for.
    let (gradient, convection) = match (pace, case.model) {
        (Pace::Transient { .. }, Model::Laminar) => ("Gauss linear", "Gauss linear"),
        _ => ("cellLimited Gauss linear 1", "Gauss linearUpwind grad(U)"),
    };
    Dictionary::default()
        .with("ddtSchemes", Dictionary::default().with("default", time))
        .with("gradSchemes", Dictionary::default().with("default", "Gauss linear").with("grad(U)", gradient))
        .with(
            "divSchemes",
            Dictionary::default()
                .with("default", "none")
                .with("div(phi,U)", format!("{bounded}{convection}"))
                .with("div(phi,k)", format!("{bounded}Gauss upwind"))
                .with("div(phi,omega)", format!("{bounded}Gauss upwind"))
                .with("div((nuEff*dev2(T(grad(U)))))", "Gauss linear"),
        )
        .with("laplacianSchemes", Dictionary::default().with("default", "Gauss linear corrected"))
        .with("interpolationSchemes", Dictionary::default().with("default", "linear"))
        .with("snGradSchemes", Dictionary::default().with("default", "corrected"))
        .with("wallDist", Dictionary::default().with("method", "meshWave"))
}

/// `system/fvSolution`.
#[must_use]
pub fn solution(pace: Pace) -> Dictionary {
    let pressure = |tolerance: f64| {
        Dictionary::default()
            .with("solver", "GAMG")
            .with("smoother", "GaussSeidel")
            .with("tolerance", 1e-10)
            .with("relTol", tolerance)
    };
    let transported = |tolerance: f64| {
        Dictionary::default()
            .with("solver", "smoothSolver")
            .with("smoother", "symGaussSeidel")
            .with("tolerance", 1e-12)
            .with("relTol", tolerance)
    };
    let equations = |factors: Dictionary| Dictionary::default().with("equations", factors);
    match pace {
        Pace::Steady => Dictionary::default()
            .with("solvers", Dictionary::default().with("p", pressure(0.05)).with("\"(U|k|omega)\"", transported(0.1)))
            .with("SIMPLE", Dictionary::default().with("consistent", "yes").with("nNonOrthogonalCorrectors", 0))
            .with("relaxationFactors", equations(Dictionary::default().with("U", 0.9).with("\"(k|omega)\"", 0.7))),
        Pace::Transient { .. } => Dictionary::default()
            .with(
                "solvers",
                Dictionary::default()
                    .with("p", pressure(0.05))
                    .with("pFinal", pressure(0.01))
                    .with("\"(U|k|omega)\"", transported(0.1))
                    .with("\"(U|k|omega)Final\"", transported(0.01)),
            )
            .with(
                "PIMPLE",
                Dictionary::default()
                    .with("consistent", "yes")
                    .with("nOuterCorrectors", 2)
                    .with("nCorrectors", 1)
                    // A mesh that moves as a whole keeps its fluxes.
                    .with("correctPhi", "no")
                    .with("nNonOrthogonalCorrectors", 0),
            )
            .with("relaxationFactors", equations(Dictionary::default().with("\".*\"", 0.9).with("\".*Final\"", 1.0))),
    }
}

/// `system/decomposeParDict`: slices along the body.
#[must_use]
pub fn decomposition(ranks: usize) -> Dictionary {
    let slices = Dictionary::default().with("n", format!("({ranks} 1 1)")).with("delta", 0.001);
    Dictionary::default().with("numberOfSubdomains", ranks).with("method", "simple").with("simpleCoeffs", slices)
}

/// `constant/transportProperties`.
#[must_use]
pub fn transport(case: &Case) -> Dictionary {
    Dictionary::default().with("transportModel", "Newtonian").with("nu", case.water.viscosity_m2_s)
}

/// `constant/turbulenceProperties`.
#[must_use]
pub fn turbulence(case: &Case) -> Dictionary {
    match case.model {
        Model::Laminar => Dictionary::default().with("simulationType", "laminar"),
        Model::Sst { .. } => {
            let model =
                Dictionary::default().with("RASModel", "kOmegaSST").with("turbulence", "on").with("printCoeffs", "off");
            Dictionary::default().with("simulationType", "RAS").with("RAS", model)
        }
    }
}
