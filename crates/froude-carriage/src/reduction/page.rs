//! What belongs to all methods of the carriage on the page: the methods side by side, the calibration, the runs.

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Series};
use froude_records::run::RunLog;
use froude_records::text::counted;

use super::Reduction;
use crate::drag::coefficient::Coefficient;
use crate::drag::point::Method;
use crate::drag::report::DragReport;
use crate::drag::setup::DragSetup;
use crate::drag::tracking::Tracking;
use crate::runs::mounted;

/// What belongs to all methods on the page: the paper's Table IV with its figure, which is the summary; calibration and runs.
pub fn sections(reduction: &Reduction) -> (Section, Vec<Section>) {
    let Reduction { runs, setup, calibration, report, tracking } = reduction;
    let said = Block::words(summary(report, setup));
    let followed = (!tracking.is_empty()).then(|| tracking_table(tracking).into());
    let blocks = [methods_table(report).into(), said].into_iter().chain(followed).chain([force_chart(report).into()]);
    let drag = Section::new("Drag by every method", blocks);
    let mut more = Vec::new();
    if let Some(c) = calibration {
        let value = format!(
            "{} N/V with its interval {} N/V, from {}; the gear's efficiency is {}.",
            number::short_form(c.force_per_volt.value, c.force_per_volt.standard),
            number::interval(c.interval_95),
            counted(c.used, "driving run", "driving runs"),
            number::short_form(c.efficiency.value, c.efficiency.standard),
        );
        let said = Block::words(std::iter::once(value).chain(c.notes.iter().cloned()));
        more.push(Section::new("Calibration", [said]));
    }
    let t = TableBuilder::new("runs", "Complete runs that were read.", &runs.logs);
    let table = t.build(vec![
        t.text("run", "run", |log| log.meta.id.clone()),
        t.text("kind", "kind", |log| log.meta.role.name().to_owned()),
        t.count("pair", "pair", |log| log.meta.carriage.pair.map(|pair| pair as usize)),
        t.number("speed_m_s", "speed [m/s]", |log| log.meta.carriage.target_speed_m_s).plain(3),
        t.text("direction", "direction", |log| log.meta.carriage.direction.map(|way| way.name().to_owned())),
        t.number("duration_s", "length [s]", RunLog::duration_s).plain(3),
    ]);
    more.push(Section::new("Runs", [table.into()]));
    (drag, more)
}

/// What the runs say, in sentences.
fn summary(report: &DragReport, setup: &DragSetup) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(c) = report.coefficients.iter().find(|c| Some(c.method) == report.recommended) {
        let value =
            c.interval_95.map_or_else(|| number::plain(c.value, 4), |ends| number::value_and_interval(c.value, ends));
        out.push(format!("Recommended: {}, D_d = {value} N s²/m² (95 %).", c.method.words()));
        out.extend(drag_coefficient(c, setup));
    } else {
        let is_unphysical = report.findings.iter().any(|f| f.code == "unphysical-drag-coefficient");
        let has_interval = report.coefficients.iter().any(|c| c.interval_95.is_some());
        let why = if is_unphysical {
            "C_D is outside the range of real bodies; check the reference area, the units, and which runs are listed as wet and as dry"
        } else if has_interval {
            "neither the force sensor nor the difference of wet and dry runs gives an interval here, and those of the models depend on \
             their own friction"
        } else {
            "no method can state an interval from these runs"
        };
        out.push(format!("No D_d is recommended: {why}."));
    }
    if setup.calibration.is_none() {
        out.push(
            "The force per volt was not calibrated with known weights: no D_d from motor currents is stated more accurately than the declared \
             efficiency of the gear and K_T allow."
                .to_owned(),
        );
    }
    if let Some(d) = &report.detectability {
        out.push(format!(
            "One wet-minus-dry difference scatters by {} N (dry repeats, {}); {} at one speed {} a drag above {} N.",
            number::significant(d.difference_n, 2),
            number::degrees_of_freedom(d.dof),
            counted(d.differences, "difference", "differences"),
            if d.differences == 1 { "shows" } else { "show" },
            number::significant(d.expanded_n, 2),
        ));
        out.push(format!(
            "The detection limit of all speeds together is D_d = {} N s²/m² (of the scatter alone: scale errors are proportional to the drag).",
            number::significant(d.smallest_n_s2_m2, 2)
        ));
        let speeds = report.coefficients.iter().flat_map(|c| c.points.iter().map(|p| p.speed_m_s.abs()));
        let slowest = speeds.fold(f64::INFINITY, f64::min);
        if let Some(c) = report.coefficients.iter().find(|c| c.method == Method::Mcd) {
            out.extend(d.advice(c.value, slowest));
        }
    }
    if let Some(a) = &report.agreement {
        out.push(format!(
            "The wet repeats scatter by {} N where {} N was predicted ({}).",
            number::significant(a.observed_n, 2),
            number::significant(a.predicted_n, 2),
            number::p_equation(a.p),
        ));
    }
    if let Some(m) = &report.added_mass {
        let what = match m.ballast_kg {
            Some(kg) if kg != 0.0 => {
                format!(
                    "added mass plus entrained water (the {} kg of ballast of the wet runs subtracted)",
                    number::plain(kg, 3)
                )
            }
            Some(_) => "added mass plus entrained water".to_owned(),
            None => {
                "additional mass of the wet run over the dry one (added mass, entrained water, ballast of unknown mass)"
                    .to_owned()
            }
        };
        out.push(format!(
            "From the ramps: {what}: {} kg, interval {} kg, {}.",
            number::short_form(m.mass_kg.value, m.mass_kg.standard),
            number::interval(m.interval_95),
            counted(m.runs, "pair of runs", "pairs of runs")
        ));
    }
    out
}

/// C_D with its interval, and what it refers to; `None` where no area is declared.
fn drag_coefficient(c: &Coefficient, setup: &DragSetup) -> Option<String> {
    let ((value, interval), area_m2) = (c.drag_coefficient()?, setup.reference_area_m2?);
    let value = interval.map_or_else(|| number::plain(value, 4), |ends| number::value_and_interval(value, ends));
    Some(format!(
        "C_D = {value} (95 %), for an area of {} m² and {} kg/m³.",
        number::plain(area_m2, 4),
        number::plain(setup.density_kg_m3, 5)
    ))
}

/// The methods side by side: the paper's Table IV.
fn methods_table(report: &DragReport) -> ResultTable {
    let caption = "D_d by every method that the runs allow; ratio to the force sensor, or to MCD where there is none.";
    let t = TableBuilder::new("methods", caption, &report.coefficients);
    let drag = Coefficient::drag_coefficient;
    t.build(vec![
        t.text("method", "", |c| c.method.name().to_owned()),
        t.text("", "method", |c| format!("{} ({})", c.method.words(), c.method.name())),
        t.number("d_d_n_s2_m2", "D_d [N s²/m²]", |c| c.value).plain(5),
        t.interval("d_d_interval_95_n_s2_m2", "D_d, 95 % interval", |c| c.interval_95),
        t.number("d_d_relative_half_width", "D_d, relative half-width", Coefficient::relative_half_width).percent(),
        t.number("c_d", "C_D [1]", |c| drag(c).map(|(value, _)| value)).plain(4),
        t.interval("c_d_interval_95", "C_D, 95 % interval", |c| drag(c).and_then(|(_, interval)| interval)),
        t.number("ratio", "ratio to reference", |c| c.value / report.reference_n_s2_m2.unwrap_or(f64::NAN)).plain(4),
        t.count("pairs", "pairs per speed", |c| c.pairs),
    ])
}

/// Errors of the motion while a speed was held: the paper's Table III.
fn tracking_table(tracking: &[Tracking]) -> ResultTable {
    let caption = "Reference less measured position and speed (over 0.1 s) while the speed was held, positive where the carriage lags behind; the paper's Table III beside them.";
    let t = TableBuilder::new("tracking", caption, tracking);
    let of_paper = |k: usize| move |row: &Tracking| row.of_the_paper().map(|errors| errors[k]);
    let body = |row: &Tracking| mounted(&[row.body]).trim_start_matches(", ").to_owned();
    t.build(vec![
        t.number("speed_m_s", "speed [m/s]", |row| row.speed_m_s).plain(3),
        t.text("body", "carriage", body),
        t.count("runs", "runs", |row| row.runs),
        t.number("position_mean_m", "position error, mean [mm]", |row| row.position_m.mean).significant(3),
        t.number("position_std_m", "std [mm]", |row| row.position_m.std).significant(2),
        t.number("position_largest_m", "largest [mm]", |row| row.position_m.largest).significant(3),
        t.number("position_paper_m", "paper [mm]", of_paper(0)).plain(3),
        t.number("velocity_mean_m_s", "velocity error, mean [mm/s]", |row| row.velocity_m_s.mean).significant(3),
        t.number("velocity_std_m_s", "std [mm/s]", |row| row.velocity_m_s.std).significant(2),
        t.number("velocity_largest_m_s", "largest [mm/s]", |row| row.velocity_m_s.largest).significant(3),
        t.number("velocity_paper_m_s", "paper [mm/s]", of_paper(1)).plain(3),
    ])
}

/// Force over speed by method, with the recommended curve: the paper's Figure 2.
fn force_chart(report: &DragReport) -> Chart {
    let mut series: Vec<Series> = report
        .coefficients
        .iter()
        .map(|c| Series {
            name: c.method.name().to_owned(),
            mark: Mark::Points,
            x: c.points.iter().map(|p| p.speed_m_s).collect(),
            y: c.points.iter().map(|p| p.force_n).collect(),
            ..Series::default()
        })
        .collect();
    if let Some(c) = report.coefficients.iter().find(|c| Some(c.method) == report.recommended) {
        let fastest = c.points.iter().map(|p| p.speed_m_s).fold(0.0, f64::max);
        let slowest = c.points.iter().map(|p| p.speed_m_s).fold(0.0, f64::min);
        let x: Vec<f64> = (0..=100).map(|i| slowest + (fastest - slowest) * f64::from(i) / 100.0).collect();
        let [low, high] = c.interval_95.unwrap_or([c.value; 2]);
        let curve = |d: f64| x.iter().map(|v| d * v * v.abs()).collect::<Vec<f64>>();
        series.push(Series {
            name: format!("D_d v|v|, {}", c.method.name()),
            mark: Mark::Line,
            y: curve(c.value),
            low: x.iter().map(|v| (low * v * v.abs()).min(high * v * v.abs())).collect(),
            high: x.iter().map(|v| (low * v * v.abs()).max(high * v * v.abs())).collect(),
            x,
        });
    }
    Chart {
        name: "drag".to_owned(),
        title: "Drag over speed".to_owned(),
        caption:
            "Drag of each steady window by method; the line is D_d v|v| of the recommended one with its 95 % band."
                .to_owned(),
        x_label: "speed [m/s]".to_owned(),
        panels: vec![ChartPanel { y_label: "drag [N]".to_owned(), series, ..ChartPanel::default() }],
        ..Chart::default()
    }
}
