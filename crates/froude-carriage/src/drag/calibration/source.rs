//! A calibration as a source: force per volt from known weights over a pulley, beside what is declared, and polarity from the jogs.

use froude_identify::answer::{Answer, Made};
use froude_identify::method::{Found, Method, MethodError, Need};
use froude_records::block::{Block, Section, TableBuilder};
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::run::{Role, RunLog, TOW};
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::{Calibration, Jog as Verdict, jog as judged, record};
use crate::drag::{DragRun, DragSetup};
use crate::reduction::{calibration_of, known_of_calibration, rig_key, setup_of};
use crate::runs::{EXCITING, Runs, for_drag};
use crate::source::{DRIVEN, files_of, runs_of};

/// Known weights over a pulley.
#[derive(Debug)]
pub struct KnownWeights;

/// Its only name.
const NAME: &str = "calibration";

/// A run with a weight.
const NEEDS: [Need; 1] = [Need::of(&["calibration"], DRIVEN)];

impl Method for KnownWeights {
    fn names(&self) -> &'static [&'static str] {
        &[NAME]
    }

    fn words(&self, _: &str) -> &'static str {
        "force per volt from known weights over a pulley"
    }

    fn needs(&self, name: &str) -> &'static [Need] {
        // What is declared rests on no run.
        if name == NAME { &NEEDS } else { &[] }
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    /// Without a calibration there are no answers, and what the jogs show is said all the same.
    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let roles = [Role::Calibration, Role::Jog];
        let Some(runs) = runs_of(campaign, source, &roles, progress)? else { return Ok(Found::default()) };
        progress("calibrating");
        let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
        let mut setup = setup_of(runs.campaign.as_ref(), constants);
        if !source.name.is_empty() {
            setup.name.clone_from(&source.name);
        }
        let hung: Vec<DragRun<'_>> =
            runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        let (calibration, why_not) = calibration_of(&hung, runs.campaign.as_ref(), &setup);
        let jogs: Vec<Jog> =
            runs.logs.iter().filter(|l| l.meta.role == Role::Jog).map(jog).collect::<Result<_, _>>()?;
        let mut findings = runs.findings.clone();
        findings.extend(why_not);
        findings.extend(jogs.iter().map(polarity));
        if calibration.is_none() {
            findings.extend(uncalibrated(source, &runs));
        }
        let results = calibration.as_ref().map_or_else(Vec::new, |c| {
            let known = known_of_calibration(runs.campaign.as_ref(), rig_key(&runs, constants).as_deref());
            let of = |estimate: Estimate, files| -> Answer {
                Made { name: format!("{}, {}", setup.name, estimate.method.name), estimate, files }.into()
            };
            vec![
                of(record::calibrated(&setup.name, c, &known), files_of(&runs)),
                of(record::declared(&setup.name, &setup), Vec::new()),
            ]
        });
        let beside = calibration.is_some().then(|| runs.results(NAME));
        let summary = section(calibration.as_ref(), &setup, &results, &jogs);
        Ok(Found { results, summary: Some(summary), findings, beside, is_part: runs.beside > 0, ..Found::default() })
    }
}

/// What a jog showed.
#[derive(Debug, Clone, PartialEq)]
struct Jog {
    /// The run.
    id: String,
    /// Mean command while it moved, V.
    command_v: f64,
    /// How far it went, m.
    way_m: f64,
    /// Whether it went where the command pushed.
    verdict: Verdict,
}

fn jog(log: &RunLog) -> Result<Jog, MethodError> {
    let axis = log.meta.carriage.axis.name();
    let position = log.channel(&format!("{axis}/position"), Dimension::LENGTH)?;
    let command = log.channel(&format!("{axis}/command"), Dimension::VOLTAGE)?;
    let state = log.channel(&format!("{axis}/state"), Dimension::ONE)?;
    // Only while the loop is open: what holds before and brakes after pushes the other way.
    let first = state.iter().position(|s| *s == EXCITING).unwrap_or(0);
    let end = state.iter().rposition(|s| *s == EXCITING).map_or(first, |i| i + 1);
    let (position, command) = (&position[first..end], &command[first..end]);
    let way_m = position.last().zip(position.first()).map_or(0.0, |(last, first)| last - first);
    Ok(Jog {
        id: log.meta.id.clone(),
        command_v: command.iter().sum::<f64>() / command.len().max(1) as f64,
        way_m,
        verdict: judged(position, command),
    })
}

/// What a jog says of the wiring.
fn polarity(jog: &Jog) -> Finding {
    let (id, command_v, way_mm) = (&jog.id, jog.command_v, 1e3 * jog.way_m);
    let (severity, text) = match jog.verdict {
        Verdict::Right => {
            (Severity::Note, format!("{id}: {command_v:.2} V moved the axis {way_mm:.2} mm: the polarity is right"))
        }
        Verdict::NoMotion { largest_v } => (
            Severity::Error,
            format!("{id}: up to {largest_v:.2} V did not move the axis; raise the jog above breakaway"),
        ),
        Verdict::Reversed { .. } => (
            Severity::Error,
            format!(
                "{id}: {command_v:.2} V moved the axis {way_mm:.2} mm the other way: motor or encoder is wired in reverse; swap the encoder's \
                 channels or make counts_per_revolution negative"
            ),
        ),
    };
    Finding::new(severity, "polarity", text)
}

/// What runs without a calibration cost, and where others may lie.
fn uncalibrated(source: &Source, runs: &Runs) -> Vec<Finding> {
    let Input::Runs { paths, .. } = &source.input else { return Vec::new() };
    let single = paths.iter().all(|p| p.is_file()).then(|| {
        let text = format!(
            "{} named and read; the folder {} may hold others",
            counted(paths.len(), "run was", "runs were"),
            runs.folder.display()
        );
        Finding::new(Severity::Note, "single-runs", text)
    });
    let cost = Finding::new(
        Severity::Warning,
        "not-calibrated",
        "no D_d from motor currents is stated better than the declared gear efficiency and K_T allow; hang known weights over a \
         pulley and drive both ways ([carriage.calibration])"
            .to_owned(),
    );
    single.into_iter().chain([cost]).collect()
}

/// What was found, beside what was declared, and the jogs.
fn section(c: Option<&Calibration>, setup: &DragSetup, results: &[Answer], jogs: &[Jog]) -> Section {
    let mut blocks: Vec<Block> = Vec::new();
    if c.is_some() {
        let estimates: Vec<&Estimate> = results.iter().flat_map(Answer::estimates).collect();
        let caption = "Force per volt of the command, the motor driving the gear (not back-driven).";
        let t = TableBuilder::new("force_per_volt", caption, &estimates);
        let of = |estimate: &Estimate| estimate.coefficients[record::FORCE_PER_VOLT].clone();
        let table = t.build(vec![
            t.text("from", "from", |e| e.method.words.clone()),
            t.number("value_n_v", "force per volt [N/V]", |e| of(e).value),
            t.number("standard_uncertainty_n_v", "standard uncertainty [N/V]", |e| of(e).standard_uncertainty),
            t.interval("interval_95_n_v", "95 % interval [N/V]", |e| of(e).interval_95),
        ]);
        blocks.push(table.into());
    }
    if !jogs.is_empty() {
        let verdict = |j: &Jog| match j.verdict {
            Verdict::Right => "correct".to_owned(),
            Verdict::Reversed { after_m } => format!("REVERSED, seen after {:.2} mm", 1e3 * after_m),
            Verdict::NoMotion { .. } => "not known: it did not move".to_owned(),
        };
        let t = TableBuilder::new("jogs", "Jogs.", jogs);
        let table = t.build(vec![
            t.text("run", "run", |j| j.id.clone()),
            t.number("command_v", "mean command [V]", |j| j.command_v).plain(3),
            t.number("distance_m", "distance [mm]", |j| j.way_m).plain(3),
            t.text("polarity", "polarity", verdict),
        ]);
        blocks.push(table.into());
    }
    blocks.extend(c.map(|c| Block::words(sentences(c, setup))));
    Section::new("Force per volt", blocks)
}

fn sentences(c: &Calibration, setup: &DragSetup) -> Vec<String> {
    let k = c.force_per_volt;
    let mut out = vec![
        format!(
            "The drive gives {} N per volt of its command, 95 % interval {} N/V, from {}; {} left out.",
            number::short_form(k.value, k.standard),
            number::interval(c.interval_95),
            counted(c.used, "driving run", "driving runs"),
            counted(
                c.overhauled,
                "run in which the weight may have back-driven the gear was",
                "runs in which the weight may have back-driven the gear were"
            )
        ),
        format!(
            "Gear efficiency {}, with the uncertainty of the motor constant, amplifier and radius, against the ideal {:.4} N/V; carriage friction {:.3} N.",
            number::short_form(c.efficiency.value, c.efficiency.standard),
            setup.ideal_force_per_volt_n,
            c.friction_n
        ),
    ];
    out.extend(c.notes.iter().cloned());
    out
}
