//! Accelerated tows as a source of a campaign: a folder of logs, one run each, reduced to the rows of a table.

use crate::names::ACCELERATED_TOW;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_identify::reduce::Observations;
use froude_identify::regression::Scatter;
use froude_identify::seam::Choice;
use froude_identify::source::{Asked, identify_laws};
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::Derived;
use froude_records::finding::{Finding, Severity};
use froude_records::run::Role;
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::law::{asked, names};
use super::reduce::{Mounted, Reduced, reduce};
use super::rows::{Rows, TowRun, Way, root_mean_square};
use super::section::AcceleratedTowSpec;
use super::setup::{Setup, declared, no_mass, setup_of, without_rig};
use super::{lag, page, plan, section, simulate};
use crate::between_runs::FEWEST_RUNS;
use crate::declared::check;
use crate::findings::{note, warning};
use crate::log::TankLog;
use crate::logs::{self, Logs, Wanted, no_run};
use crate::method::TankMethod;

const WHY: &str = "drag and added mass are wrong by its size or its sign where one is guessed";
/// A row whose acceleration is below this part of the largest is one of constant speed.
const STEADY: f64 = 0.05;
/// Noise in the acceleration lowers C_A; reported if by more than this fraction of its standard uncertainty.
const ATTENUATED: f64 = 0.5;
/// Masses by runs in air and by declaration further apart than so many standard uncertainties are reported.
const APART: f64 = 2.5;

/// Drag and added mass by weighted rows.
pub const ACCELERATED: TankMethod = TankMethod {
    names: &[ACCELERATED_TOW],
    words: &["drag and added mass of one axis, from a body that is towed up to speed and back to rest"],
    needs: &[
        Need::of(&["test"], &["force"]),
        Need { is_optional: true, is_observed: false, ..Need::of(&["dry_air"], &["force"]) },
    ],
    runs: ACCELERATED_TOW,
    takes: &[ACCELERATED_TOW, "models", "uncertainty", "plan"],
    identify: |campaign, source, _, progress| identify(campaign, source, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    declares: Declares { section: ACCELERATED_TOW, keys: section::KEYS, plan: section::PLAN },
    check: |source| check(source, ACCELERATED_TOW, section::accelerated_tow, section::plan),
};

fn identify(campaign: &Campaign, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, MethodError> {
    let spec = declared(source)?;
    progress("reading the runs");
    let roles = [Role::Test, Role::DryAir];
    let wanted = Wanted::of(ACCELERATED_TOW, &roles, "time, position or speed, and force");
    let Logs { runs: logs, files, mut findings } = logs::read(source.input.path(), &wanted, progress)?;
    let mut setup = setup_of(campaign, source, &spec, &logs::configurations(&logs))?;
    let late = |log: &TankLog| {
        let of = ["position", "y/position", "speed"].map(|motion| logs::stamps_standard_s(log, [motion, "force"]));
        of.into_iter().fold(0.0, f64::max)
    };
    let clocks_s = logs.iter().map(late).fold(0.0, f64::max);
    setup.delay_s.standard_uncertainty = setup.delay_s.standard_uncertainty.hypot(clocks_s);
    progress("weighting motion and force");
    let mounted = logs.iter().map(|log| run(log, &setup)).collect::<Result<Vec<_>, _>>()?;
    let reduced = reduce(&mounted, &setup).ok_or_else(|| no_mass(source, &setup))?;
    if reduced.runs.is_empty() {
        return Err(no_run(source, reduced.left_out.into_iter().next()));
    }
    findings.extend(reduced.left_out.iter().map(logs::left_out));
    findings.extend(driven(&reduced, &setup));
    findings.extend(few(&reduced));
    let laws = asked(campaign, source, &reduced.data, &setup.axis)?;
    let scatter = if reduced.is_by_run { Scatter::Cluster } else { Scatter::Serial(reduced.of_rows.clone()) };
    if laws.len() > 1 {
        let text = "several laws are compared as if the rows of a run were independent, so that a law with more terms wins too easily: trust it where its extra coefficients \
                    are outside their intervals of zero";
        findings.push(warning("laws-by-rows", text.to_owned()));
    }
    if let Some(other) = &campaign.identify.covariance {
        let text = format!(
            "covariance = {other:?} of [identify] is not used: rows of a run follow each other in time, and their scatter is that of runs, or counts their correlation"
        );
        findings.push(note("covariance-of-the-method", text));
    }
    let observations = Observations {
        data: reduced.data.clone(),
        n_read: reduced.data.rows,
        findings: Vec::new(),
        shared_errors: reduced.errors.clone(),
        files,
    };
    let own = without_rig(source);
    let asked = Asked { method: ACCELERATED_TOW, laws, scatter, choice: Choice::Selection, has_budget: true };
    let mut result = identify_laws(campaign, &own, observations, asked, &|model| {
        progress(&format!("fitting {model}"));
    })?;
    for estimate in &mut result.estimates {
        refer(estimate, campaign, &setup);
    }
    findings.append(&mut result.findings);
    let best = result.recommendation.as_ref().map_or(0, |r| r.index);
    let added = result.estimates.get(best).and_then(|e| e.coefficients.get(&names(&setup.axis)[3]));
    let relative = added.and_then(|c| Some((c.standard_uncertainty? / c.value?).abs())).unwrap_or(f64::INFINITY);
    findings.extend(of_runs(&reduced, &setup, &spec, relative));
    findings.extend(result.models.get(best).and_then(|model| lag::finding(campaign, &reduced, &setup, model)));
    let blocks = vec![page::section(&logs, &reduced, &setup, result.models.get(best))];
    Ok(Found { results: vec![result.into()], blocks, findings, ..Found::default() })
}

/// What the record says of volumes and steps, beside the fit.
fn refer(estimate: &mut froude_records::estimate::Estimate, campaign: &Campaign, setup: &Setup) {
    let measured = |value: f64| froude_records::estimate::Measured { value, unit: "m^3".to_owned() };
    if let Some(volume) = campaign.body.as_ref().and_then(|b| b.link_volume_m3) {
        estimate.refers_to.insert("link_volume".to_owned(), measured(volume));
    } else if let [only] = setup.bodies.as_slice() {
        estimate.refers_to.insert("volume".to_owned(), measured(only.volume_m3));
    }
    let name = names(&setup.axis)[3].clone();
    if let ([only], Some(c)) = (setup.bodies.as_slice(), estimate.coefficients.get(&name)) {
        let kg = setup.density_kg_m3 * only.volume_m3;
        let added = Derived {
            formula: format!("{name}*density*volume"),
            value: c.value.map(|x| kg * x),
            unit: "kg".to_owned(),
            standard_uncertainty: c.standard_uncertainty.map(|u| kg * u),
            interval_95: c.interval_95.map(|ends| ends.map(|x| kg * x)),
        };
        estimate.derived.insert("added_mass".to_owned(), added);
    }
    estimate.method.words = format!(
        "{}; motion and force weighted by cos⁴ windows of {} s, a third of that apart; acceleration by the windows' derivatives; force taken {} ms after the motion; zero of each run \
         the straight line between its parts at rest",
        estimate.method.words,
        setup.window_s,
        1e3 * setup.delay_s.value
    );
}

/// A log as a run; nothing about it is taken for granted.
fn run<'a>(log: &'a TankLog, setup: &Setup) -> Result<Mounted<'a>, MethodError> {
    let channel = |name: &str, dimension, along: &str| {
        logs::channel(log, name, dimension, WHY, along).map(|c| c.values.as_slice())
    };
    let axis = &setup.axis;
    let way = format!("the body's way through the water along +{axis}");
    let has = |name: &str| log.log.channels.contains_key(name);
    let way = if has("speed") {
        Way::Speed(channel("speed", Dimension::SPEED, &way)?)
    } else {
        let name = if has("y/position") { "y/position" } else { "position" };
        Way::Position(channel(name, Dimension::LENGTH, &way)?)
    };
    let force_n = channel("force", Dimension::FORCE, &format!("the rig on the body along +{axis}"))?;
    let meta = &log.log.meta;
    Ok(Mounted {
        run: TowRun { id: &meta.id, time_s: &log.log.time_s, way, force_n, marks: &log.declared.marks },
        body: setup.bodies.iter().position(|b| b.name == meta.configuration).unwrap_or(0),
        is_dry: meta.role == Role::DryAir,
    })
}

/// A load of the water that drives the body: the force has the other sign, or the motion has.
fn driven(reduced: &Reduced, setup: &Setup) -> Option<Finding> {
    let [load, speed, acceleration, _] = names(&setup.axis);
    let of = |name: &str| reduced.data.values(name).unwrap_or_default();
    let (f, v, a) = (of(&load), of(&speed), of(&acceleration));
    let largest = a.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
    let steady = |i: &usize| a[*i].abs() < STEADY * largest;
    let work: f64 = (0..reduced.data.rows).filter(steady).map(|i| f[i] * v[i]).sum();
    (work > 0.0).then(|| {
        let text = format!(
            "{load} points along {speed} where the speed is constant: the water would drive the body; `force` is that of the rig on the body, and its sign, or that of the motion, is the other \
             one: look at sign in the sidecars"
        );
        Finding::new(Severity::Error, "force-along-motion", text)
    })
}

/// That what changes from run to run is in no interval, of one run or two.
fn few(reduced: &Reduced) -> Option<Finding> {
    let n = reduced.runs.len();
    (n < FEWEST_RUNS).then(|| {
        let text = format!(
            "{}: what changes from run to run is not included in the intervals; {FEWEST_RUNS} runs show it, five show it well",
            counted(n, "run", "runs")
        );
        warning("few-runs", text)
    })
}

/// What the runs show; `relative` is the standard uncertainty of C_A as part of it.
fn of_runs(reduced: &Reduced, setup: &Setup, spec: &AcceleratedTowSpec, relative: f64) -> Vec<Finding> {
    let mut out = Vec::new();
    // The same noise stands in m a; a mass weighed by it comes out too small alike.
    let factor = |body: usize| {
        let (mass, added_kg) = (reduced.masses[body], reduced.added_kg[body]);
        if mass.is_weighed || added_kg <= 0.0 { 1.0 } else { (mass.value_kg + added_kg) / added_kg }
    };
    let squares = |rows: &Rows| {
        let n = rows.acceleration_m_s2.len() as f64;
        [rows.noise_m_s2.powi(2), root_mean_square(&rows.acceleration_m_s2).powi(2)].map(|square| n * square)
    };
    let part_of = |(id, body, rows): &(String, usize, Rows)| {
        let [noise, all] = squares(rows);
        (id.clone(), noise / all, factor(*body) * noise / all)
    };
    let parts: Vec<(String, f64, f64)> = reduced.runs.iter().map(part_of).collect();
    // All runs tell one C_A.
    let sums = reduced.runs.iter().fold([0.0, 0.0], |[noise, all], (_, body, rows)| {
        let own = squares(rows);
        [noise + factor(*body) * own[0], all + own[1]]
    });
    let mean = sums[0] / sums[1];
    if let Some((id, noise, part)) =
        parts.into_iter().max_by(|a, b| a.2.total_cmp(&b.2)).filter(|_| mean > ATTENUATED * relative)
    {
        let text = format!(
            "noise in the acceleration makes C_A{} about {:.2} % too small, more than half of its standard uncertainty; the worst run is {id:?} ({:.2} %, with noise of {:.2} % in the mean \
             square): set a window longer than {} s in [source.accelerated_tow], or use a finer encoder",
            setup.axis,
            1e2 * mean,
            1e2 * part,
            1e2 * noise,
            setup.window_s
        );
        out.push(warning("acceleration-noise", text));
    }
    for (body, mass) in setup.bodies.iter().zip(&reduced.masses) {
        if let Some(stated) = body.mass_kg.filter(|_| mass.is_weighed) {
            let gains = mass.value_kg * setup.force_relative.hypot(setup.motion_relative);
            let apart =
                (mass.value_kg - stated.value) / mass.standard_kg.hypot(stated.standard_uncertainty).hypot(gains);
            if apart.abs() > APART {
                let text = format!(
                    "the mass of {} is {:.4} ± {:.4} kg by its runs in air and is declared as {:.4} ± {:.4} kg: one of them is wrong, or so is the gain of the force; the runs in air are used",
                    if body.name.is_empty() { "the body" } else { &body.name },
                    mass.value_kg,
                    mass.standard_kg,
                    stated.value,
                    stated.standard_uncertainty
                );
                out.push(warning("mass-contradicted", text));
            }
        }
    }
    if spec.delay_s.is_none() && setup.delay_s.standard_uncertainty == 0.0 {
        let text = "no delay of the force behind the motion is declared, and none is taken: a filter of the cell that the encoder does not have moves drag into added mass; write \
                    delay = { value = \"0 ms\", standard = \"2 ms\" } in [source.accelerated_tow]";
        out.push(note("no-delay", text.to_owned()));
    }
    out
}
