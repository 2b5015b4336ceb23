//! Still runs on the page, in the record, and what is doubtful about them.

use froude_fit::distribution::t_two_sided;
use froude_records::block::{Block, ResultTable, TableBuilder};
use froude_records::finding::Finding;
use froude_records::number::{p_equation, significant};
use froude_records::page::{Chart, Mark};

use super::fit::fit;
use super::fitted::Fitted;
use super::method::MotorDriven;
use super::setup::Setup;
use super::still_run::{self, StillFit};
use crate::drawn::{panel, series};
use crate::findings::{note, warning};
use crate::joint::DeclaredError;

/// False-alarm probability of a finding.
const ALARM: f64 = 0.004;
/// The smaller side of the positions has at least this part of the larger one.
const BOTH_SIDES: f64 = 0.25;

/// What the still runs showed.
pub(super) fn blocks<M: MotorDriven>(setup: &Setup<M>) -> Vec<Block> {
    if setup.still_fits.is_empty() {
        return Vec::new();
    }
    vec![constants(setup).into(), runs::<M>(&setup.still_fits).into(), chart::<M>(&setup.still_fits).into()]
}

/// The constant of each configuration, with its budget.
pub(super) fn constants<M: MotorDriven>(setup: &Setup<M>) -> ResultTable {
    let unit = M::SPEC.loads[0].unit;
    let caption = "Still runs, one zero fitted for each configuration: value, and standard uncertainty by source.";
    let t = TableBuilder::new("from_still_runs", caption, &setup.still_fits);
    let head = |what: &str| format!("{what} [{unit}]");
    let mut columns = vec![
        t.text("constant", "constant", |fit| setup.constants[fit.constant].name.clone()),
        t.number(&format!("value_{unit}"), &head("value"), |fit| fit.value).significant(5),
        t.number(&format!("standard_{unit}"), &head("combined"), |fit| combined(fit, setup)).significant(2),
        t.number(&format!("noise_{unit}"), &head("noise"), |fit| fit.noise).significant(2),
        t.number(&format!("drift_{unit}"), &head("drift of the zero"), |fit| fit.drift).significant(2),
    ];
    let gains = setup.still_fits.first().map_or(&[][..], |fit| fit.gain_sensitivities.as_slice());
    columns.extend(gains.iter().enumerate().map(|(i, (constant, _))| {
        let name = setup.constants[*constant].name.as_str();
        t.number(&format!("{}_{unit}", name.replace(' ', "_")), &head(name), |fit| by_gain(fit, i, setup))
            .significant(2)
    }));
    t.build(columns)
}

/// Standard uncertainty of the constant from a gain.
fn by_gain<M>(fit: &StillFit, i: usize, setup: &Setup<M>) -> f64 {
    let (constant, by) = fit.gain_sensitivities[i];
    setup.constants[constant].known.map_or(0.0, |known| (by * known.standard).abs())
}

fn combined<M>(fit: &StillFit, setup: &Setup<M>) -> f64 {
    (0..fit.gain_sensitivities.len()).fold(fit.noise.hypot(fit.drift), |sum, i| sum.hypot(by_gain(fit, i, setup)))
}

fn runs<M: MotorDriven>(fits: &[StillFit]) -> ResultTable {
    let (motion, load) = (&M::SPEC.motion, &M::SPEC.loads[0]);
    let rows: Vec<&still_run::Fitted> = fits.iter().flat_map(|fit| &fit.runs).collect();
    let t = TableBuilder::new("still_runs", "Each still run: means over it.", &rows);
    let of = |key: &str| format!("{key}_{}", load.key());
    let (key, head) = (format!("{}_{}", motion.name, motion.unit), format!("{} [{}]", motion.name, motion.shown));
    t.build(vec![
        t.text("run", "run", |row| row.run.point.id.clone()),
        t.text("configuration", "configuration", |row| row.run.point.configuration.clone()),
        t.number(&key, &head, |row| row.run.position).plain(4),
        t.number("duration_s", "duration [s]", |row| row.run.duration_s).places(1),
        t.number(&of(load.name), &format!("{} [{}]", load.name, load.shown), |row| row.run.load).plain(5),
        t.number(&of("standard"), &format!("u of the mean [{}]", load.shown), |row| row.standard).significant(2),
        t.number(&of("residual"), &format!("residual [{}]", load.shown), |row| row.residual).significant(2),
    ])
}

fn chart<M: MotorDriven>(fits: &[StillFit]) -> Chart {
    let load = &M::SPEC.loads[0];
    let of = |fit: &StillFit| {
        let x: Vec<f64> = fit.runs.iter().map(|row| row.factor).collect();
        let y: Vec<f64> = fit.runs.iter().map(|row| row.run.load).collect();
        let ends =
            [x.iter().copied().fold(f64::INFINITY, f64::min), x.iter().copied().fold(f64::NEG_INFINITY, f64::max)];
        let line = ends.map(|x| fit.zero + fit.value * x);
        let configuration = fit.runs.first().map_or("", |row| row.run.point.configuration.as_str());
        let label = format!("{} {configuration} [{}]", load.name, load.unit);
        panel(label, vec![series("still runs", Mark::Points, x, y), series("fitted line", Mark::Line, ends, line)])
    };
    Chart {
        name: "still-runs".to_owned(),
        title: "Still runs".to_owned(),
        caption: format!(
            "Mean {} of each still run against the factor of the constant at rest, −sin φ of the net buoyancy.",
            load.name
        ),
        x_label: "factor of the constant [1]".to_owned(),
        panels: fits.iter().map(of).collect(),
        ..Chart::default()
    }
}

/// What is doubtful about the runs.
pub(super) fn findings<M: MotorDriven>(setup: &Setup<M>) -> Vec<Finding> {
    let (motion, load) = (M::SPEC.motion.name, &M::SPEC.loads[0]);
    let mut out = Vec::new();
    for fit in &setup.still_fits {
        let name = &setup.constants[fit.constant].name;
        let [low, high] = fit
            .runs
            .iter()
            .fold([0.0_f64, 0.0], |[low, high], row| [low.max(-row.run.position), high.max(row.run.position)]);
        if low.min(high) < BOTH_SIDES * low.max(high) {
            let text = format!(
                "the still runs of {name} lie on one side of zero {motion}, so that an offset of the {motion} or a load that is even in it biases the slope: add runs on \
                 the other side"
            );
            out.push(note("still-runs-on-one-side", text));
        }
        if let Some(p) = fit.p.filter(|p| *p < ALARM) {
            let worst = fit.runs.iter().map(|row| row.residual.abs()).fold(0.0, f64::max);
            let text = format!(
                "the still runs of {name} deviate from their line by up to {} {}, more than noise and declared drift explain ({}): the zero of the load cell moved, or the \
                 body was not at rest; declare the drift, still_runs = {{ drift = \"…\" }}",
                significant(worst, 2),
                load.unit,
                p_equation(p)
            );
            out.push(warning("still-runs-scatter", text));
        }
    }
    out
}

/// Runs in motion that contradict the still runs: those are fitted again without what the still runs showed.
///
/// The difference β − B has the scatter of β, the noise and the drift of B, and of each other error (∂β/∂e − ∂B/∂e) u(e): what both share cancels.
pub(super) fn contradicted<M: MotorDriven>(fitted: &Fitted<'_, M>) -> Vec<Finding> {
    let setup = fitted.setup;
    if setup.still_fits.is_empty() {
        return Vec::new();
    }
    let of_motion = Setup { still_fits: Vec::new(), ..setup.clone() };
    let Ok(alone) = fit(fitted.runs, fitted.motions, &of_motion, &fitted.campaign.identify) else { return Vec::new() };
    let one = |still: &StillFit| {
        let constant = &setup.constants[still.constant];
        let j = alone.position(&constant.unknown.as_ref()?.name)?;
        let found = alone.unknowns[j].value?;
        let of_error = |error: &DeclaredError| {
            let gain = still.gain_sensitivities.iter().find(|(k, _)| setup.constants[*k].name == error.name);
            ((error.sensitivity[j] - gain.map_or(0.0, |(_, by)| *by)) * error.standard).powi(2)
        };
        let scatter = alone.parts.first()?;
        let variance = scatter.covariance[(j, j)] + alone.errors.iter().map(of_error).sum::<f64>();
        let standard = variance.max(0.0).sqrt().hypot(still.standard());
        let p = t_two_sided((found - still.value).abs() / standard, scatter.dof.get(j).copied()?);
        (p * (setup.still_fits.len() as f64) < ALARM).then(|| {
            let text = format!(
                "{}: {} is {} ± {} {unit} by the still runs and {} ± {} {unit} by the runs in motion (standard uncertainties, {}): check the zero of the load cell, what was mounted, \
                 and the sign of the {}",
                alone.law,
                constant.name,
                significant(still.value, 4),
                significant(still.standard(), 2),
                significant(found, 4),
                significant(variance.max(0.0).sqrt(), 2),
                p_equation(p),
                M::SPEC.motion.name,
                unit = M::SPEC.loads[0].unit
            );
            warning("still-runs-contradicted", text)
        })
    };
    setup.still_fits.iter().filter_map(one).collect()
}

/// What the record says of them.
pub(super) fn notes<M: MotorDriven>(setup: &Setup<M>) -> Vec<String> {
    let unit = M::SPEC.loads[0].unit;
    let one = |fit: &StillFit| {
        format!(
            "{} from {} still runs with one zero: {} {unit}; standard uncertainties in {unit}: noise {}, drift of the zero {}, with the gains {}",
            setup.constants[fit.constant].name,
            fit.runs.len(),
            significant(fit.value, 5),
            significant(fit.noise, 2),
            significant(fit.drift, 2),
            significant(combined(fit, setup), 2)
        )
    };
    setup.still_fits.iter().map(one).collect()
}
