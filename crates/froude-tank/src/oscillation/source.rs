//! Forced oscillation as a source of a campaign: a folder of logs, one run each, with a sidecar that states what it is.

use froude_hydro::swing::Medium;
use froude_identify::answer::Made;
use froude_identify::dataset::Dataset;
use froude_identify::method::{Found, MethodError, Need};
use froude_identify::source::laws;
use froude_records::campaign::{Campaign, Source};
use froude_records::run::{Channel, FORCED_OSCILLATION, ImportedRun, Role};
use froude_records::table::links_of_configuration;
use froude_records::texts::Texts;
use froude_records::units::Dimension;

use super::forces::{Drag, LOAD};
use super::section::OscillationSpec;
use super::setup::{Body, OscillationRun, Setup, motions_without};
use super::{findings, fit, page, plan, record, section, simulate};
use crate::declared::{self, check, needed, uncertain};
use crate::error::undeclared;
use crate::joint::findings::warning;
use crate::logs::{self, Logs, distinct};
use crate::long_logs::{self, LENGTHS, Lengths};
use crate::method::TankMethod;
use crate::motion::Sampled;
use crate::reference;

const WORDS: &str =
    "added mass, drag, buoyancy and delay fitted together in time, to runs of a body that a motor swings";
const DRY: Need = Need { is_optional: true, ..Need::of(&["dry_air"], &["angle", "force"]) };
const ROLES: [Role; 2] = [Role::Test, Role::DryAir];
const CHANNELS: &str = "time, angle and force";
/// The drag law where none is asked for.
const DEFAULT_LAW: &str = "linear_quadratic";

/// The joint fit in time.
pub const FORCED: TankMethod = TankMethod {
    names: &[FORCED_OSCILLATION],
    words: &[WORDS],
    needs: &[Need::of(&["test"], &["angle", "force"]), DRY],
    runs: FORCED_OSCILLATION,
    identify: |campaign, source, _, progress| identified(campaign, source, LENGTHS, progress),
    simulate: simulate::files,
    plan: plan::prospect,
    check: |source| check(source, FORCED_OSCILLATION, section::oscillation, section::plan),
};

/// Reads, fits, chooses; logs beyond `lengths` are averaged.
fn identified(
    campaign: &Campaign,
    source: &Source,
    lengths: Lengths,
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let spec = declared(source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } =
        logs::read_averaging(source.input.path(), FORCED_OSCILLATION, &ROLES, CHANNELS, lengths, progress)?;
    let mut setup = setup_of(campaign, source, &spec, &logs::configurations(&logs))?;
    let clocks_s = logs.iter().map(|log| logs::stamps_standard_s(log, ["angle", "force"])).fold(0.0, f64::max);
    if let Some(delay) = &mut setup.delay_s {
        // One that is found needs no word of the clocks; of one that is declared their error is an error too.
        delay.standard = delay.standard.hypot(clocks_s);
    }
    let runs = logs.iter().map(|log| run(log, &setup)).collect::<Result<Vec<_>, _>>()?;
    progress("fitting the angles");
    let sampled: Vec<Sampled<'_>> = logs.iter().map(Sampled::of).collect();
    let motions = motions_without(&runs, &setup, &sampled).map_err(MethodError::refused)?;
    for (log, motion) in logs.iter().zip(&motions) {
        logs::add_step(&mut files, log, logs::cycles_step(log, motion));
    }
    let fastest_hz: Vec<f64> = motions.iter().map(|m| setup.harmonics as f64 / m.angle.period_s()).collect();
    let (mut fits, mut failed) = (Vec::new(), Vec::new());
    for drag in drags(campaign, source, &setup)? {
        progress(&format!("{FORCED_OSCILLATION} with {}", drag.law.name));
        match fit(&runs, &motions, &setup, &drag, &campaign.identify) {
            Ok(fit) => fits.push((drag, fit)),
            Err(why) => failed.push((drag.law.name.clone(), why)),
        }
    }
    // A law that fails costs itself alone; where all fail, nothing is found.
    if fits.is_empty()
        && let Some((_, why)) = failed.pop()
    {
        return Err(MethodError::refused(why));
    }
    findings.extend(
        failed
            .into_iter()
            .map(|(law, why)| warning("not-fitted", format!("{law} could not be fitted and is left out: {why}"))),
    );
    let chosen = record::chosen(&fits);
    findings.extend(findings::of_runs(&runs, &motions, &setup, campaign));
    findings.extend(logs.iter().zip(&fastest_hz).filter_map(|(log, hz)| long_logs::too_coarse(log, *hz)));
    findings.extend(fits.iter().flat_map(|(_, fit)| findings::of_fit(fit, &runs, &motions, &setup)));
    let blocks = fits.get(chosen).map(|(_, fit)| page::section(fit, &runs, &motions, &setup)).into_iter().collect();
    let estimate = |(i, (drag, fit)): (usize, &(Drag, _))| {
        let context = record::Context { campaign, source, setup: &setup, runs: &runs, motions: &motions };
        let mut estimate = record::estimate(fit, drag, &context, (i == chosen).then_some(fits.len()));
        if let Some(step) = long_logs::step(&logs, &fastest_hz) {
            estimate.method.words = format!("{step}; {}", estimate.method.words);
        }
        Made { name: estimate.id.clone(), estimate, files: files.clone() }.into()
    };
    let results = fits.iter().enumerate().map(estimate).collect();
    let summary = (!fits.is_empty()).then(|| page::laws(&fits, chosen));
    Ok(Found { results, summary, blocks, findings: distinct(findings), ..Found::default() })
}

/// `[source.forced_oscillation]`.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<OscillationSpec, MethodError> {
    let what =
        "nothing is declared of the body that swings: write [source.forced_oscillation] with pivot, radius and mass";
    needed(source, FORCED_OSCILLATION, section::oscillation, what)
}

/// Everything that the campaign declares, for the configurations that there are.
///
/// # Errors
///
/// What is missing, and what to write; a budget entry of a quantity that this method does not have.
pub fn setup_of(
    campaign: &Campaign,
    source: &Source,
    spec: &OscillationSpec,
    configurations: &[String],
) -> Result<Setup, MethodError> {
    let body = |name: &String| {
        let of = if name.is_empty() { String::new() } else { format!(" of {name}") };
        let volume = reference::volume_m3(campaign, source, name)?;
        let mass = spec.mass_kg.of(name).ok_or_else(|| {
            undeclared(&source.place, format!("no mass is declared{of}: write it in [source.forced_oscillation] mass, {name} = {{ value = \"1.63 kg\", standard = \"5 g\" }}"))
        })?;
        Ok(Body {
            name: name.clone(),
            n_links: links_of_configuration(name).map(f64::from),
            reference_volume_m3: volume,
            mass_kg: uncertain(mass),
            buoyancy_n: spec.buoyancy_n.of(name).map(uncertain),
        })
    };
    let density = reference::density_kg_m3(campaign, source)?;
    let bodies = configurations.iter().map(body).collect::<Result<_, MethodError>>()?;
    let mut out = Setup {
        pivot: spec.pivot,
        delay_s: spec.delay_s.map(uncertain),
        cycles: spec.cycles,
        harmonics: spec.harmonics,
        ..Setup::new(uncertain(spec.radius_m), density, bodies)
    };
    for entry in &source.uncertainty {
        logs::is_of_all_runs(entry)?;
        let gain = match entry.quantity.as_str() {
            "density" => {
                out.density_kg_m3.standard = if entry.relative { entry.standard * density } else { entry.standard };
                continue;
            }
            "angle" => &mut out.angle_relative,
            "force" | LOAD => &mut out.force_relative,
            "flow" | "speed" => &mut out.flow_relative,
            other => {
                let what = format!(
                    "quantity = {other:?} is none that a forced oscillation has: it has force, angle, flow and density; radius, mass, buoyancy and \
                     delay take their standard uncertainties in [source.forced_oscillation]"
                );
                return Err(undeclared(&entry.place, what));
            }
        };
        *gain = declared::gain(entry, "the zero of each run is fitted")?;
    }
    Ok(out)
}

/// The drag laws that the source asks for, as the force across the body.
///
/// # Errors
///
/// An unknown law, or one that cannot be used here.
pub fn drags(campaign: &Campaign, source: &Source, setup: &Setup) -> Result<Vec<Drag>, MethodError> {
    let mut data = Dataset { rows: 1, ..Dataset::default() };
    data.configuration = Texts::repeated("", 1);
    (data.setup, data.run, data.line) = (data.configuration.clone(), data.configuration.clone(), vec![1]);
    data.put("v_x", vec![0.1], Dimension::SPEED);
    data.put("v_y", vec![0.1], Dimension::SPEED);
    data.speed_and_angle_from_velocity();
    data.put("density", vec![setup.density_kg_m3.value], Dimension::DENSITY);
    if setup.bodies.iter().all(|body| body.n_links.is_some()) {
        data.put("n_links", vec![1.0], Dimension::ONE);
    }
    data.put(LOAD, vec![0.0], Dimension::FORCE);
    let mut asking = source.clone();
    let nobody =
        source.models.is_empty() && campaign.identify.models.is_empty() && campaign.identify.user_models.is_empty();
    if nobody {
        asking.models = vec![DEFAULT_LAW.to_owned()];
    }
    let laws = laws(campaign, &asking, &data)?;
    laws.into_iter().map(|law| Drag::new(law).map_err(MethodError::refused)).collect()
}

/// A log as a run: its angle and its force, and the stream that it was done in.
fn run<'a>(log: &'a ImportedRun, setup: &Setup) -> Result<OscillationRun<'a>, MethodError> {
    let meta = &log.log.meta;
    let medium = if meta.role == Role::DryAir { Medium::Air } else { Medium::Water };
    let flow_m_s = match logs::condition(log, "flow", Dimension::SPEED)? {
        Some(flow) => flow,
        None if medium == Medium::Air => 0.0,
        None => {
            let what = "the speed of the stream is not declared; write [conditions] flow = \"0.2 m/s\" in its sidecar (\"0 m/s\" in water at rest)";
            return Err(MethodError::input(&log.log.path, what));
        }
    };
    let body = setup.bodies.iter().position(|body| body.name == meta.configuration).unwrap_or(0);
    Ok(OscillationRun {
        id: &meta.id,
        body,
        medium,
        flow_m_s,
        time_s: &log.log.time_s,
        angle_rad: &channel(log, "angle", Dimension::ANGLE)?.values,
        force_n: &channel(log, "force", Dimension::FORCE)?.values,
    })
}

fn channel<'a>(log: &'a ImportedRun, name: &str, dimension: Dimension) -> Result<&'a Channel, MethodError> {
    let along = if name == "angle" {
        "the pivot; positive where the body moves towards +y"
    } else {
        "the rig on the body along +y"
    };
    logs::channel(log, name, dimension, "added mass is wrong by its size where one is guessed", along)
}

#[cfg(test)]
mod tests;
