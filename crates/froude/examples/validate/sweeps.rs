//! Friction sweeps of a campaign: what a rigid axis learns from runs that differ from each other.

use froude::fit::coverage::Count;
use froude::methods::carriage::servo::report::of_runs;
use froude::methods::carriage::servo::{Chain, Friction, ServoError, ServoLog, ServoReport};
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::scenario::Scenario;

const SECTION: &str = "Friction sweeps: 24 runs of one axis, friction 2 % and force per volt 0.5 % from run to run";

/// Six speeds out and back, twice.
const SWEEPS: u32 = 2;
/// Between which the runs go, m; also where the map has its outer knots.
const FROM_TO_M: [f64; 2] = [0.5, 4.5];

/// Coverage over `seeds` campaigns: one friction everywhere, and a map.
pub fn coverage(claims: &mut Claims, seeds: u64) -> Result<(), ServoError> {
    let flat = Scenario {
        bump: 0.0,
        // A metre wide: straight pieces between the map's knots follow it within 5 mN.
        bump_width_m: 1.0,
        efficiency: 1.0,
        pairs: SWEEPS,
        friction_m: Some(FROM_TO_M),
        ..Scenario::pinned(0.0)
    };
    let constant = [("M", flat.moving_mass_kg), ("F_v", flat.viscous_n_s_m), ("F_c", flat.coulomb_n)];
    of(claims, &flat, "constant friction", &Friction::default(), &constant.map(|(n, t)| (n.to_owned(), t)), seeds)?;
    let bumpy = Scenario { bump: 0.2, ..flat };
    let knots_m: Vec<f64> = (0..=16).map(|i| FROM_TO_M[0] + 0.25 * f64::from(i)).collect();
    // Not the outer knots: there runs gather speed.
    let names = knots_m[2..15].iter().step_by(3);
    let truths: Vec<(String, f64)> = names.map(|y| (format!("F_c(y = {y} m)"), bumpy.coulomb_at_n(*y))).collect();
    of(claims, &bumpy, "a map over position", &Friction { knots_m, ..Friction::default() }, &truths, seeds)
}

fn of(
    claims: &mut Claims,
    scenario: &Scenario,
    what: &str,
    friction: &Friction,
    truths: &[(String, f64)],
    seeds: u64,
) -> Result<(), ServoError> {
    let reports: Vec<ServoReport> =
        (0..seeds).into_par_iter().map(|seed| identified(scenario, friction, seed)).collect::<Result<_, _>>()?;
    let n = reports.len() as f64;
    // 95 %, less three standard deviations of a count.
    let bar = 0.95 - 3.0 * (0.95 * 0.05 / n).sqrt();
    for (name, truth) in truths {
        let mut inside = Count::default();
        let (mut square, mut stated) = (0.0, [0.0; 3]);
        for c in reports.iter().filter_map(|r| r.fit.coefficient(name)) {
            inside.add((c.interval[0]..=c.interval[1]).contains(truth));
            square += (c.value - truth).powi(2);
            stated.iter_mut().zip([c.classical_std, c.hac_std, c.block_std]).for_each(|(s, x)| *s += x * x);
        }
        let [classical, hac, runs] = stated.map(|s| (s / square).sqrt());
        let line = format!("{what}, {name}: truth inside the 95 % interval of whole runs as clusters");
        let found = format!(
            "{:.3}; error {:.1e} of {truth:.4} rms; stated over true {classical:.2} classical, {hac:.2} HAC, {runs:.2} runs",
            inside.rate(),
            (square / n).sqrt() / truth
        );
        // The position of slow runs is filtered at 3 Hz to keep the chain's modes out, the force is not: a bias of the mass that no
        // interval holds. The mass is read from the pulses.
        if name == "M" {
            claims.add(SECTION, &line, "no band: runs at constant speed are for friction", found, Verdict::Measured);
        } else {
            let expected = format!("at least {bar:.3}: 0.95 less the scatter of {n} campaigns");
            claims.holds(SECTION, &line, &expected, found, inside.rate() >= bar);
        }
    }
    Ok(())
}

/// As a campaign's runs are identified: rows at 20 Hz of the moving part, positions filtered at 3 Hz.
fn identified(scenario: &Scenario, friction: &Friction, seed: u64) -> Result<ServoReport, ServoError> {
    let chain = Chain {
        corner_hz: 3.0,
        decimation: (scenario.rate_hz / 20.0).round() as usize,
        ..Chain::new(scenario.ideal_force_per_volt_n, friction.clone())
    };
    let runs = scenario
        .runs(seed)
        .into_iter()
        .filter(|run| run.kind == froude::methods::carriage::drag::RunKind::Friction)
        .map(|run| {
            let moves = |v: &f64| *v != 0.0;
            let first = run.reference_speed_m_s.iter().position(moves).unwrap_or(0);
            let last = run.reference_speed_m_s.iter().rposition(moves).unwrap_or(0);
            let within = |x: &[f64]| x[first..=last].to_vec();
            chain.rows(&ServoLog {
                time_s: within(&run.time_s),
                position_m: within(&run.position_m),
                command_v: within(&run.command_v),
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    of_runs(runs, &chain)
}
