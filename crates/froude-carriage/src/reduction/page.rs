//! What belongs to all methods of the carriage on the page: the methods side by side, the calibration, the runs.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::text::counted;

use super::Reduction;
use crate::drag::point::Method;
use crate::drag::report::DragReport;
use crate::drag::setup::DragSetup;

/// What belongs to all methods on the page: the paper's Table IV with its figure, which is the summary; calibration and runs.
pub fn sections(reduction: &Reduction) -> (DocumentSection, Vec<DocumentSection>) {
    let Reduction { runs, setup, calibration, report } = reduction;
    let drag = DocumentSection {
        title: "Drag by every method".to_owned(),
        paragraphs: summary(report, setup),
        tables: vec![methods_table(report)],
        charts: vec![force_chart(report)],
    };
    let mut more = Vec::new();
    if let Some(c) = calibration {
        let mut paragraphs = vec![format!(
            "{} N/V with its interval {} N/V, from {}; the gear's efficiency is {}.",
            number::short_form(c.force_per_volt.force_per_volt_n.value, c.force_per_volt.force_per_volt_n.standard),
            number::interval(c.interval_95),
            counted(c.used, "driving run", "driving runs"),
            number::short_form(c.efficiency.value, c.efficiency.standard),
        )];
        paragraphs.extend(c.notes.iter().cloned());
        more.push(DocumentSection { title: "Calibration".to_owned(), paragraphs, ..DocumentSection::default() });
    }
    let rows = runs
        .logs
        .iter()
        .map(|log| {
            let m = &log.meta;
            vec![
                m.id.clone(),
                m.role.name().to_owned(),
                m.carriage.pair.map_or_else(|| "–".to_owned(), |p| p.to_string()),
                m.carriage.target_speed_m_s.map_or_else(|| "–".to_owned(), |v| number::plain(v, 3)),
                crate::runs::way(m.carriage.direction).to_owned(),
                number::plain(log.duration_s(), 3),
            ]
        })
        .collect();
    more.push(DocumentSection {
        title: "Runs".to_owned(),
        tables: vec![TextTable {
            caption: "Complete runs that were read.".to_owned(),
            head: ["run", "kind", "pair", "speed [m/s]", "direction", "length [s]"].map(str::to_owned).to_vec(),
            rows,
        }],
        ..DocumentSection::default()
    });
    (drag, more)
}

/// Value and 95 % interval: `20.1 ± 0.2` where that is symmetric about the value within 1 % of its half-width, `0.22 [−0.18, 0.82]` where it is not.
fn with_interval(value: f64, [low, high]: [f64; 2]) -> String {
    let half = 0.5 * (high - low);
    if (0.5 * (low + high) - value).abs() <= 0.01 * half {
        number::plus_minus(value, half)
    } else {
        format!("{} {}", number::plain(value, 4), number::interval([low, high]))
    }
}

/// What the runs say, in sentences.
fn summary(report: &DragReport, setup: &DragSetup) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(c) = report.coefficients.iter().find(|c| Some(c.method) == report.recommended) {
        let value = c.interval_95.map_or_else(|| number::plain(c.value, 4), |ends| with_interval(c.value, ends));
        out.push(format!("Recommended: {}, D_d = {value} N s²/m² (95 %).", c.method.words()));
    } else {
        let has_interval = report.coefficients.iter().any(|c| c.interval_95.is_some());
        let why = if has_interval {
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

/// The methods side by side: the paper's Table IV.
fn methods_table(report: &DragReport) -> TextTable {
    let rows = report
        .coefficients
        .iter()
        .zip(&report.drag_coefficients)
        .zip(&report.ratios)
        .map(|((c, drag), ratio)| {
            let missing = || number::MISSING.to_owned();
            vec![
                format!("{} ({})", c.method.words(), c.method.name()),
                number::plain(c.value, 5),
                c.interval_95.map_or_else(missing, number::interval),
                c.relative_half_width().map_or_else(missing, number::percent),
                drag.map_or_else(missing, |(value, _)| number::plain(value, 4)),
                drag.and_then(|(_, i)| i).map_or_else(missing, number::interval),
                number::plain(*ratio, 4),
                c.pairs.to_string(),
            ]
        })
        .collect();
    TextTable {
        caption: "D_d by every method that the runs allow; ratio to the force sensor, or to MCD where there is none."
            .to_owned(),
        head: [
            "method",
            "D_d [N s²/m²]",
            "95 % interval",
            "half-width",
            "C_D [1]",
            "95 % interval",
            "ratio",
            "pairs per speed",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
    }
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
