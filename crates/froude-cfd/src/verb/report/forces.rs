//! Forces of a campaign against angle and speed, body by body.

use froude_records::block::{Block, ResultTable, TableBuilder};
use froude_records::number::plain;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};
use froude_records::text::counted;

use super::solved::Solved;
use crate::case::Model;
use crate::outcome::Status;
use crate::verb::loads::LOADS;

/// Loads that are drawn against the angle, with their labels.
const DRAWN: [(usize, &str); 3] = [(0, "f_x [N]"), (1, "f_y [N]"), (5, "m_z [N m]")];

/// Body by body.
pub(super) fn blocks(solved: &[Solved]) -> Vec<Block> {
    // A repeat lies on what it repeats, and another plane has no abscissa here.
    let level: Vec<&Solved> = solved.iter().filter(|s| !s.is_repeat() && s.case.flow.pitch_rad == 0.0).collect();
    let mut names: Vec<&str> = Vec::new();
    for own in &level {
        if !names.contains(&own.case.configuration.as_str()) {
            names.push(&own.case.configuration);
        }
    }
    let mut charts = Vec::new();
    for name in names {
        let own: Vec<&Solved> = level.iter().filter(|s| s.case.configuration == name).copied().collect();
        charts.extend(against_angle(name, &own));
        charts.extend(against_speed(name, &own));
    }
    let outside = solved.len() - level.len();
    let mut paragraphs = Vec::new();
    if outside > 0 {
        paragraphs.push(format!(
            "Not drawn: {}, of settings that are computed again or of angles out of the plane.",
            counted(outside, "case", "cases")
        ));
    }
    let charts = charts.into_iter().map(Block::Chart);
    [table(solved).into(), Block::text("", paragraphs)].into_iter().chain(charts).collect()
}

/// Name of a series: its speed, and the model where it is laminar.
fn series_name(solved: &Solved) -> String {
    format!("{} m/s{}", plain(solved.case.flow.speed_m_s, 3), model_words(solved))
}

fn model_words(solved: &Solved) -> &'static str {
    if solved.case.model == Model::Laminar { ", laminar" } else { "" }
}

/// Lines and points of those that count, by the name of their series; over them points of those that oscillate or are in no fit, in colours of their own.
fn series(own: &[&Solved], name: &dyn Fn(&Solved) -> String, at: &dyn Fn(&Solved) -> [f64; 2]) -> Vec<Series> {
    let mut named: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
    for solved in own.iter().filter(|s| s.outcome.status.is_usable()) {
        let name = name(solved);
        match named.iter_mut().find(|(of, _)| *of == name) {
            Some((_, points)) => points.push(at(solved)),
            None => named.push((name, vec![at(solved)])),
        }
    }
    let with = |name: &str, mark: Mark, points: &[[f64; 2]]| Series {
        name: name.to_owned(),
        mark,
        x: points.iter().map(|p| p[0]).collect(),
        y: points.iter().map(|p| p[1]).collect(),
        ..Series::default()
    };
    let of_status = |status: Status| -> Vec<[f64; 2]> {
        own.iter().filter(|s| s.outcome.status == status).map(|s| at(s)).filter(|p| p[1].is_finite()).collect()
    };
    let others = [(Status::Oscillating, "oscillating"), (Status::Diverged, "diverged, in no fit")];
    let others = others.map(|(status, words)| with(words, Mark::Points, &of_status(status)));
    let lines = named.iter_mut().flat_map(|(name, points)| {
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        [with(name, Mark::Line, points), with(name, Mark::Points, points)]
    });
    let lines: Vec<Series> = lines.collect();
    // What is drawn later covers what lies under it.
    lines.into_iter().chain(others.into_iter().filter(|other| !other.x.is_empty())).collect()
}

fn load(solved: &Solved, load: usize) -> f64 {
    solved.outcome.loads.map_or(f64::NAN, |loads| loads[load])
}

fn against_angle(configuration: &str, own: &[&Solved]) -> Option<Chart> {
    let speed = |s: &Solved| s.case.flow.speed_m_s;
    let angles = |of: f64| own.iter().filter(|s| speed(s) == of).count();
    let mut swept: Vec<&Solved> = own.iter().filter(|s| angles(speed(s)) > 1).copied().collect();
    swept.sort_by(|a, b| speed(a).total_cmp(&speed(b)));
    let panel = |(k, label): (usize, &str)| ChartPanel {
        y_label: label.to_owned(),
        series: series(&swept, &series_name, &|s| [s.case.flow.angle_rad.to_degrees(), load(s, k)]),
        ..ChartPanel::default()
    };
    (!swept.is_empty()).then(|| Chart {
        name: format!("forces-{configuration}-against-angle"),
        title: format!("Forces of {configuration} against the angle"),
        caption: format!(
            "{configuration}: forces of the water on the whole body and its moment about the reference point against the angle of the motion, a colour for each speed. Lines join the points; those that oscillate or diverged have a colour of their own."
        ),
        x_label: "angle [deg]".to_owned(),
        panels: DRAWN.map(panel).to_vec(),
        ..Chart::default()
    })
}

/// Head on: the force in decades, and over ½ρU²A.
fn against_speed(configuration: &str, own: &[&Solved]) -> Option<Chart> {
    let head_on: Vec<&Solved> = own.iter().filter(|s| s.case.flow.angle_rad == 0.0).copied().collect();
    let scale_n =
        |s: &Solved| 0.5 * s.case.water.density_kg_m3 * s.case.flow.speed_m_s.powi(2) * s.case.reference.area_m2;
    let name = |s: &Solved| format!("head on{}", model_words(s));
    let speed = |s: &Solved| s.case.flow.speed_m_s;
    let drag = series(&head_on, &name, &|s| [speed(s), -load(s, 0)]);
    let coefficient = series(&head_on, &name, &|s| [speed(s), -load(s, 0) / scale_n(s)]);
    (head_on.len() > 1).then(|| Chart {
        name: format!("forces-{configuration}-against-speed"),
        title: format!("Force of {configuration} head on against the speed"),
        caption: format!(
            "{configuration}: force against the motion head on, and over ½ρU²A with A the largest plan area. Lines join the points."
        ),
        x_label: "speed [m/s]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: vec![
            ChartPanel { y_label: "−f_x [N]".to_owned(), y_scale: Scale::Logarithmic, series: drag },
            ChartPanel { y_label: "−f_x/(½ρU²A) [-]".to_owned(), series: coefficient, ..ChartPanel::default() },
        ],
    })
}

/// All loads, for a program.
fn table(solved: &[Solved]) -> ResultTable {
    let t = TableBuilder::new("forces", "", solved);
    let mut columns = vec![
        t.text("case", "", |s| s.case.id.clone()),
        t.text("configuration", "", |s| s.case.configuration.clone()),
        t.number("speed_m_s", "", |s| s.case.flow.speed_m_s),
        t.number("angle_rad", "", |s| s.case.flow.angle_rad),
        t.number("pitch_rad", "", |s| s.case.flow.pitch_rad),
        t.flag("is_laminar", "", |s| s.case.model == Model::Laminar),
        t.text("is", "", |s| s.outcome.status.word().to_owned()),
        t.numbers("y_plus", "", |s| s.outcome.y_plus.map(|y| y.to_vec())),
    ];
    let load = |(k, name): (usize, &&str)| t.number(&format!("loads/{name}"), "", |s| load(s, k));
    columns.extend(LOADS.iter().enumerate().map(load));
    t.build(columns)
}
