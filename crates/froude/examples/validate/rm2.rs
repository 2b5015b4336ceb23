//! UNH RM2: real tow-tank data, published without uncertainty columns for the tare runs.

use std::error::Error;
use std::path::Path;

use froude::pipeline::{Job, identify};

use crate::claims::{Claims, Verdict};

const SECTION: &str = "UNH RM2 tare drag and tare torque (Bachant et al. 2016, CC BY 4.0)";

pub fn all(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mut job = Job::new(root.join("examples/unh-rm2/tare.toml"));
    job.out = Some(folder.path().to_owned());
    let done = identify(&job, &|_| {})?;
    let coefficient = |id: &str, name: &str| {
        done.file.estimates.iter().find(|e| e.id == id).and_then(|e| e.coefficients.get(name)).cloned()
    };
    let need = |id: &str, name: &str| coefficient(id, name).ok_or(format!("{id} has no {name}"));
    let k = need("mounting frame/quadratic", "D_x_II")?;
    claims.near(
        SECTION,
        "k of F = k U², least squares in newtons, N s²/m²",
        k.value.unwrap_or(f64::NAN),
        47.83,
        0.005,
        "data README",
    );
    let log = need("mounting frame/power_law_log", "n_x")?;
    let newton = need("mounting frame/power_law", "n_x")?;
    claims.near(
        SECTION,
        "free exponent, equal relative errors (log–log)",
        log.value.unwrap_or(f64::NAN),
        1.995,
        0.0005,
        "data README",
    );
    claims.near(
        SECTION,
        "free exponent, equal absolute errors (newtons)",
        newton.value.unwrap_or(f64::NAN),
        1.89,
        0.005,
        "issue",
    );
    let half = |c: &froude::records::estimate::Coefficient| c.interval_95.map_or(f64::NAN, |[a, b]| 0.5 * (b - a));
    claims.near(SECTION, "half-width of its 95 % interval, log–log", half(&log), 0.05, 0.01, "issue");
    claims.near(SECTION, "half-width of its 95 % interval, newtons", half(&newton), 0.10, 0.02, "issue");
    let frame: Vec<_> = done.sources.iter().filter_map(|s| s.fitted()).filter(|s| s.name == "mounting frame").collect();
    for source in &frame {
        for (model, estimate) in source.models.iter().zip(&source.estimates) {
            let n = source.data.rows;
            let size: Vec<f64> = model.fit.residuals.iter().map(|r| r.abs()).collect();
            let rho =
                froude::identify::diagnosis::rank_correlation(&size, source.data.values("speed").unwrap_or_default());
            claims.add(
                SECTION,
                &format!("{}: rank correlation of |residual| with speed; AICc in newtons", model.law.name),
                "near 0 where the error model holds (standard error 0.30)",
                format!("{rho:+.2} over {n} runs; AICc {:.2}", estimate.diagnostics.aicc.unwrap_or(f64::NAN)),
                Verdict::Measured,
            );
        }
        if let Some(r) = &source.recommendation {
            claims.add(SECTION, "what the program recommends for the frame", "–", r.reason.clone(), Verdict::Measured);
        }
    }
    let t0 = need("bearing torque/coulomb_viscous", "T_0")?;
    let b = need("bearing torque/coulomb_viscous", "B")?;
    claims.near(SECTION, "tare torque at rest, N m", t0.value.unwrap_or(f64::NAN), -0.849, 0.0005, "data README");
    claims.near(SECTION, "its slope, N m s/rad", b.value.unwrap_or(f64::NAN), 0.0100, 0.00005, "data README");
    let dw = done
        .file
        .estimates
        .iter()
        .find(|e| e.id == "bearing torque/coulomb_viscous")
        .and_then(|e| e.diagnostics.durbin_watson.values().next().copied())
        .unwrap_or(f64::NAN);
    claims.near(SECTION, "Durbin–Watson of its residuals", dw, 0.47, 0.005, "issue");
    let reported = done
        .file
        .findings
        .iter()
        .find(|f| f.code == "serial-correlation" && f.source.as_deref() == Some("bearing torque"));
    claims.holds(
        SECTION,
        "the report says that its classical interval is too narrow",
        "a finding",
        reported.map_or("no finding".to_owned(), |f| f.message.clone()),
        reported.is_some(),
    );
    Ok(())
}
