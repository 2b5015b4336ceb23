//! The flexible axis from its motor's side: records of a known axis, identified over and over.

use std::error::Error;

use froude::identify::servo::flexible::TwoMass;
use froude::identify::servo::synthetic::{Noise, carriage, record};
use froude::identify::servo::{FlexibleOptions, FlexibleReport, MotorSide, ServoError, identify_flexible};
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};

const SECTION: &str = "Flexible axis (two masses and a chain) from command and motor encoder, synthetic";

/// Half a record: pulses, then a sweep, s.
const HALF_S: f64 = 10.0;
/// Unrecorded force on the motor, N per sample at 1 kHz.
const FORCE_STD_N: f64 = 0.05;

/// Coverage of the intervals over `seeds` records.
pub fn coverage(claims: &mut Claims, seeds: u64) -> Result<(), Box<dyn Error>> {
    let axis = carriage();
    let noise = Noise { force_std_n: FORCE_STD_N, ..Noise::encoder_only() };
    let options = FlexibleOptions::new(MotorSide::MCD);
    let reports: Vec<FlexibleReport> = (0..seeds)
        .into_par_iter()
        .map(|seed| identify_flexible(&record(&axis, 1000.0, HALF_S, &noise, seed)?, &options))
        .collect::<Result<_, ServoError>>()?;
    let n = reports.len();
    // 95 %, and the scatter of a count out of n around it, four standard deviations wide.
    let band = 4.0 * (0.95 * 0.05 / n as f64).sqrt();
    for (name, truth) in truths(&axis) {
        let inside = reports
            .iter()
            .filter_map(|r| r.coefficient(name))
            .filter(|c| c.interval[0] <= truth && truth <= c.interval[1])
            .count();
        let values: Vec<f64> = reports.iter().filter_map(|r| r.coefficient(name)).map(|c| c.value).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        let std = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1) as f64).sqrt();
        let share = inside as f64 / n as f64;
        claims.holds(
            SECTION,
            &format!("{name}: truth inside the 95 % interval, encoder counts and {FORCE_STD_N} N of unrecorded force"),
            &format!("at least {:.3}: 0.95 less the scatter of {n} records", 0.95 - band),
            format!("{share:.3}; mean off by {:+.1e} of {truth:.4e}, scatter {:.1e}", mean / truth - 1.0, std / truth),
            share >= 0.95 - band,
        );
    }
    let converged = reports.iter().filter(|r| r.end.end == froude::fit::End::Converged).count();
    claims.add(SECTION, "searches that converged", "all", format!("{converged} of {n}"), Verdict::Measured);
    for (k, truth) in [(0, 0.4), (1, 0.35)] {
        let identified = reports.iter().filter(|r| r.splits[k].is_identified).count();
        let inside =
            reports.iter().filter(|r| r.splits[k].interval[0] <= truth && truth <= r.splits[k].interval[1]).count();
        let width: f64 =
            reports.iter().map(|r| r.splits[k].interval[1] - r.splits[k].interval[0]).sum::<f64>() / n as f64;
        claims.add(
            SECTION,
            &format!("split {} between motor and load", reports[0].splits[k].name),
            "identified only where its interval says so",
            format!("reported as identified in {identified} of {n}; truth inside in {inside}; mean width {width:.3} of the range 0 to 1"),
            Verdict::Measured,
        );
    }
    Ok(())
}

fn truths(axis: &TwoMass) -> Vec<(&'static str, f64)> {
    let motor = MotorSide::MCD;
    vec![
        ("J_m", motor.inertia_kg_m2(axis.motor_mass_kg)),
        ("M", axis.load_mass_kg),
        ("K_e", axis.stiffness_n_m),
        ("B_e", axis.damping_n_s_m),
        ("J_eff", 1.502e-5),
        ("B_eff", 4.657e-6),
        ("C_eff", 3.9e-3),
        ("f_antiresonance", 13.0),
    ]
}
