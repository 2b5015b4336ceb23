//! Still runs on the page, and what is doubtful about them.

use froude_records::block::{Block, ResultTable, TableBuilder};
use froude_records::finding::Finding;
use froude_records::number::{p_equation, significant};
use froude_records::page::{Chart, Mark};

use super::{Slope, Still};
use crate::drawn::{panel, series};
use crate::driven::method::MotorDriven;
use crate::driven::setup::Setup;
use crate::findings::{note, warning};

/// Chance of calling a set that keeps its zero one that does not.
const ALARM: f64 = 0.004;

/// What they showed.
pub(crate) fn blocks<M: MotorDriven>(setup: &Setup<M>) -> Vec<Block> {
    if setup.slopes.is_empty() {
        return Vec::new();
    }
    vec![found(setup).into(), runs::<M>(&setup.slopes).into(), chart::<M>(&setup.slopes).into()]
}

/// The constant of each configuration, with its budget.
pub(crate) fn found<M: MotorDriven>(setup: &Setup<M>) -> ResultTable {
    let unit = M::SPEC.loads[0].unit;
    let t = TableBuilder::new(
        "from_stills",
        "From still runs, one zero for all of a configuration: value, and standard uncertainties by error.",
        &setup.slopes,
    );
    let head = |what: &str| format!("{what} [{unit}]");
    let mut columns = vec![
        t.text("constant", "constant", |slope| setup.constants[slope.constant].name.clone()),
        t.number(&format!("value_{unit}"), &head("value"), |slope| slope.value).significant(5),
        t.number(&format!("standard_{unit}"), &head("combined"), |slope| combined(slope, setup)).significant(2),
        t.number(&format!("noise_{unit}"), &head("noise"), |slope| slope.noise).significant(2),
        t.number(&format!("drift_{unit}"), &head("drift of the zero"), |slope| slope.drift).significant(2),
    ];
    let gains = setup.slopes.first().map_or(0, |slope| slope.moves.len());
    columns.extend((0..gains).map(|i| {
        let of = |slope: &Slope| by_gain(slope, i, setup);
        let name = setup.slopes[0].moves[i].0;
        let name = setup.constants[name].name.as_str();
        t.number(&format!("{}_{unit}", name.replace(' ', "_")), &head(name), of).significant(2)
    }));
    t.build(columns)
}

/// What a gain does to the constant.
fn by_gain<M>(slope: &Slope, i: usize, setup: &Setup<M>) -> f64 {
    let (constant, by) = slope.moves[i];
    setup.constants[constant].known.map_or(0.0, |known| (by * known.standard).abs())
}

fn combined<M>(slope: &Slope, setup: &Setup<M>) -> f64 {
    (0..slope.moves.len()).fold(slope.noise.hypot(slope.drift), |sum, i| sum.hypot(by_gain(slope, i, setup)))
}

fn runs<M: MotorDriven>(slopes: &[Slope]) -> ResultTable {
    let (motion, load) = (&M::SPEC.motion, &M::SPEC.loads[0]);
    let rows: Vec<(&Still, f64, f64)> = slopes
        .iter()
        .flat_map(|slope| slope.runs.iter().zip(&slope.standards).map(|((still, _, left), u)| (still, *left, *u)))
        .collect();
    let t = TableBuilder::new("stills", "Each still run: means over it.", &rows);
    let of = |key: &str| format!("{key}_{}", load.key());
    t.build(vec![
        t.text("run", "run", |(still, ..)| still.point.id.clone()),
        t.text("configuration", "configuration", |(still, ..)| still.point.configuration.clone()),
        t.number(
            &format!("{}_{}", motion.name, motion.unit),
            &format!("{} [{}]", motion.name, motion.shown),
            |(s, ..)| s.position,
        )
        .plain(4),
        t.number("duration_s", "duration [s]", |(still, ..)| still.duration_s).places(1),
        t.number(&of(load.name), &format!("{} [{}]", load.name, load.shown), |(still, ..)| still.load).plain(5),
        t.number(&of("standard"), &format!("u of the mean [{}]", load.shown), |(.., u)| *u).significant(2),
        t.number(&of("residual"), &format!("residual [{}]", load.shown), |(_, left, _)| *left).significant(2),
    ])
}

fn chart<M: MotorDriven>(slopes: &[Slope]) -> Chart {
    let load = &M::SPEC.loads[0];
    let of = |slope: &Slope| {
        let x: Vec<f64> = slope.runs.iter().map(|(_, x, _)| *x).collect();
        let y: Vec<f64> = slope.runs.iter().map(|(still, ..)| still.load).collect();
        let ends =
            [x.iter().copied().fold(f64::INFINITY, f64::min), x.iter().copied().fold(f64::NEG_INFINITY, f64::max)];
        let line = ends.map(|x| slope.zero + slope.value * x);
        let configuration = slope.runs.first().map_or("", |(still, ..)| still.point.configuration.as_str());
        let label = format!("{} {configuration} [{}]", load.name, load.unit);
        panel(
            label,
            vec![series("still runs", Mark::Points, x, y), series("one slope, one zero", Mark::Line, ends, line)],
        )
    };
    Chart {
        name: "stills".to_owned(),
        title: "Still runs".to_owned(),
        caption: format!(
            "Mean {} of each still run over the factor of the constant in the equation at rest.",
            load.name
        ),
        x_label: "factor [1]".to_owned(),
        panels: slopes.iter().map(of).collect(),
        ..Chart::default()
    }
}

/// What is doubtful.
pub(crate) fn findings<M: MotorDriven>(setup: &Setup<M>) -> Vec<Finding> {
    let name = |slope: &Slope| setup.constants[slope.constant].name.clone();
    let (motion, load) = (M::SPEC.motion.name, M::SPEC.loads[0].name);
    let mut out = Vec::new();
    for slope in &setup.slopes {
        let signs = slope.runs.iter().map(|(still, ..)| still.position.signum());
        if signs.clone().all(|sign| sign > 0.0) || signs.clone().all(|sign| sign < 0.0) {
            let text = format!(
                "the still runs of {} lie on one side of {motion} zero: an error of the zero of the {motion} and what grows with its square are then part of the slope; hold the body on the other side, too",
                name(slope)
            );
            out.push(note("still-runs-on-one-side", text));
        }
        if let Some(p) = slope.p.filter(|p| *p < ALARM) {
            let worst = slope.runs.iter().map(|(_, _, left)| left.abs()).fold(0.0, f64::max);
            let text = format!(
                "the still runs of {} leave up to {} {} of the {load} beside the line, more than the noise within them and the declared drift explain ({}): the zero of the cell moved between them, or the body was not at rest; declare the drift in stills = {{ drift = \"…\" }}",
                name(slope),
                significant(worst, 2),
                M::SPEC.loads[0].unit,
                p_equation(p)
            );
            out.push(warning("still-runs-scatter", text));
        }
    }
    out
}

/// What the record says of them.
pub(crate) fn notes<M: MotorDriven>(setup: &Setup<M>) -> Vec<String> {
    let unit = M::SPEC.loads[0].unit;
    let one = |slope: &Slope| {
        format!(
            "{} from {} still runs with one zero: {} {unit}; standard uncertainties in {unit}: noise {}, drift of the zero {}, with the gains {}",
            setup.constants[slope.constant].name,
            slope.runs.len(),
            significant(slope.value, 5),
            significant(slope.noise, 2),
            significant(slope.drift, 2),
            significant(combined(slope, setup), 2)
        )
    };
    setup.slopes.iter().map(one).collect()
}
