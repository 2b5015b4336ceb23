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
                froude::identify::unevenness::rank_correlation(&size, source.data.values("speed").unwrap_or_default());
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
    rotor(claims, root)
}

const ROTOR: &str = "UNH RM2 rotor drag over tip speed ratio (Bachant et al. 2016, CC BY 4.0)";
/// Frontal area, m².
const AREA_M2: f64 = 0.8675;

/// Drag of the rotor about the peak of its power, the tare that its tables have removed already restored as an error that all rows share.
fn rotor(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    for entry in std::fs::read_dir(root.join("examples/unh-rm2"))? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            std::fs::copy(entry.path(), folder.path().join(entry.file_name()))?;
        }
    }
    let tare = identify(&Job::new(folder.path().join("tare.toml")), &|_| {})?;
    let done = identify(&Job::new(folder.path().join("rotor-drag.toml")), &|_| {})?;
    let k = tare
        .file
        .estimates
        .iter()
        .find(|e| e.id == "mounting frame/quadratic")
        .and_then(|e| e.coefficients.get("D_x_II"))
        .ok_or("no k")?;
    let relative = 100.0 * k.standard_uncertainty.unwrap_or(f64::NAN) / k.value.unwrap_or(f64::NAN);
    claims.near(ROTOR, "standard uncertainty of k of the tare, %", relative, 1.141, 0.0005, "second program");
    for (source, speed_m_s, power, drag) in [
        ("rotor at 1.2 m/s", 1.2, [0.365, 0.375], [0.835, 0.845]),
        ("rotor at 1.0 m/s", 1.0, [0.3535, 0.3547], [0.842, 0.846]),
    ] {
        let fitted = done.sources.iter().filter_map(|s| s.fitted()).find(|s| s.name == source).ok_or(source)?;
        let values = |name: &str| fitted.data.values(name).unwrap_or_default();
        let (ratio, c_p, f_x, speed) =
            (values("tip_speed_ratio"), values("power_coefficient"), values("f_x"), values("speed"));
        let peak = (0..c_p.len()).max_by(|&a, &b| c_p[a].total_cmp(&c_p[b])).ok_or("no rows")?;
        let c_d = -f_x[peak] / (500.0 * AREA_M2 * speed[peak].powi(2));
        let within = |x: f64, [low, high]: [f64; 2]| x >= low - 5e-4 && x <= high + 5e-4;
        claims.holds(
            ROTOR,
            &format!("{source}: peak C_P of its rows, and C_D there"),
            if speed_m_s > 1.1 { "0.37 and 0.84, published" } else { "0.354 and 0.842 to 0.846, computed beforehand" },
            format!("{:.4} and {c_d:.4}, at a tip speed ratio of {:.2}", c_p[peak], ratio[peak]),
            within(c_p[peak], power) && within(c_d, drag),
        );
        let estimate = fitted.estimates.first().ok_or("no estimate")?;
        let area = estimate.coefficients.get("S_0").ok_or("no S_0")?;
        let standard = area.standard_uncertainty.unwrap_or(f64::NAN);
        let of_tare: f64 = (estimate.errors.iter())
            .filter(|(key, _)| key.starts_with("tare/"))
            .map(|(_, e)| {
                let row = &e.sensitivity[estimate.coefficients.get_index_of("S_0").unwrap_or(0)];
                (0..row.len())
                    .map(|i| (0..row.len()).map(|j| row[i] * e.covariance[i][j] * row[j]).sum::<f64>())
                    .sum::<f64>()
            })
            .sum();
        // k U² is a drag area of k/(ρ/2) at every speed, and so is its error.
        let expected = k.standard_uncertainty.unwrap_or(f64::NAN) / 500.0;
        claims.holds(
            ROTOR,
            &format!("{source}: what the tare does to the drag area at 3.1, m²"),
            &format!("{expected:.6}: u(k)/(ρ/2), to 1e-6 of it"),
            format!("{:.6}", of_tare.sqrt()),
            (of_tare.sqrt() / expected - 1.0).abs() < 1e-6,
        );
        let interval = area.interval_95.map_or([f64::NAN; 2], |i| i.map(|x| x / AREA_M2));
        claims.add(
            ROTOR,
            &format!(
                "{source}: C_D at 3.1 by a quadratic through its rows from 2.5 on, and the tare's share of its variance"
            ),
            "–",
            format!(
                "{:.4}, 95 % from {:.4} to {:.4}; {:.0} %",
                area.value.unwrap_or(f64::NAN) / AREA_M2,
                interval[0],
                interval[1],
                100.0 * of_tare / (standard * standard)
            ),
            Verdict::Measured,
        );
    }
    let said = done.file.findings.iter().find(|f| f.code == "blockage");
    claims.holds(
        ROTOR,
        "the report says what the rotor blocks of 3.66 m by 2.44 m",
        "9.7 %",
        said.map_or("nothing".to_owned(), |f| f.message.clone()),
        said.is_some_and(|f| f.message.contains("blocks 9.7 %")),
    );
    Ok(())
}
