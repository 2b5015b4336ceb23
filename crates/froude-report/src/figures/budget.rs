//! The uncertainty budget as bars: which input makes which part of each variance.

use std::fmt::Write as _;

use froude_records::number;
use froude_records::page::{BudgetRow, SourceSection};

use crate::canvas::{Align, Canvas, WHITE, shortened, text_width};
use crate::figures::drawing::{Drawing, MOST_ROWS, recommended};
use crate::plot::{
    AXIS, Entry, LABEL_SIZE, MUTED, Panel, RULE, Span, Swatch, TEXT, TICK_SIZE, WIDTH, category, draw_legend,
    legend_height,
};
use crate::symbol::{Rich, symbol};
use crate::tables::{counted, distinct};

/// The rows of the budget that the report shows first: those of the recommended
/// model, else of the first model in the budget.
pub(crate) fn budget_rows(section: &SourceSection) -> Vec<&BudgetRow> {
    let model = recommended(section)
        .map(|e| e.law.name.as_str())
        .filter(|m| section.budget.iter().any(|r| r.model == *m))
        .or_else(|| section.budget.first().map(|r| r.model.as_str()));
    section.budget.iter().filter(|r| Some(r.model.as_str()) == model).collect()
}

/// A share between 0 and 1; what is no number counts nothing.
pub(crate) fn share(row: &BudgetRow) -> f64 {
    if row.share.is_finite() { row.share.clamp(0.0, 1.0) } else { 0.0 }
}

/// Inputs with their mean share over the coefficients, largest first.
pub(crate) fn ranked_inputs<'a>(rows: &[&'a BudgetRow]) -> Vec<(&'a str, f64)> {
    let n = distinct(rows.iter().map(|r| r.coefficient.as_str())).len().max(1) as f64;
    let mut inputs: Vec<(&str, f64)> = distinct(rows.iter().map(|r| r.input.as_str()))
        .into_iter()
        .map(|input| (input, rows.iter().filter(|r| r.input == input).map(|r| share(r)).sum::<f64>() / n))
        .collect();
    inputs.sort_by(|a, b| b.1.total_cmp(&a.1));
    inputs
}

pub(super) fn budget_drawing(section: &SourceSection) -> Option<Drawing> {
    let rows = budget_rows(section);
    let model = rows.first()?.model.clone();
    let inputs = ranked_inputs(&rows);
    let named: Vec<&str> = inputs.iter().take(6).map(|i| i.0).collect();
    let ink_of = |input: &str| named.iter().position(|n| *n == input).map_or(RULE, category);
    let coefficients = distinct(rows.iter().map(|r| r.coefficient.as_str()));
    let shown: Vec<&str> = coefficients.iter().copied().take(MOST_ROWS).collect();
    let mut legend: Vec<Entry> = named
        .iter()
        .map(|n| Entry { swatch: Swatch::Square, ink: ink_of(n), text: Rich::plain(&shortened(n, 36)) })
        .collect();
    if inputs.len() > named.len() {
        legend.push(Entry { swatch: Swatch::Square, ink: RULE, text: Rich::plain("others") });
    }
    let widest = shown.iter().map(|c| text_width(&symbol(&shortened(c, 24)), LABEL_SIZE)).fold(0.0, f64::max);
    let left = (widest + 22.0).clamp(66.0, 220.0);
    let legend_tall = legend_height(&legend, left);
    let pitch = 26.0;
    let panel = Panel {
        left,
        top: legend_tall + 6.0,
        width: WIDTH - left - 20.0,
        height: shown.len() as f64 * pitch + 4.0,
        x: Span { low: 0.0, high: 100.0 },
        y: Span { low: 0.0, high: 1.0 },
    };
    let total = panel.bottom() + 48.0;
    let mut canvas = Canvas::new(WIDTH, total);
    draw_legend(&mut canvas, &legend, left, 0.0);
    let ticks = panel.x.ticks_every(20.0);
    for &place in &ticks.places {
        canvas.line((panel.at_x(place), panel.top), (panel.at_x(place), panel.bottom()), RULE, 0.8);
        let text = Rich::plain(&ticks.label(place));
        canvas.text(&text, (panel.at_x(place), panel.bottom() + 14.0), TICK_SIZE, MUTED, Align::Center);
    }
    canvas.line((panel.left, panel.top), (panel.left, panel.bottom()), AXIS, 1.0);
    for (i, coefficient) in shown.iter().enumerate() {
        let middle = panel.top + 2.0 + (i as f64 + 0.5) * pitch;
        canvas.text(&symbol(&shortened(coefficient, 24)), (left - 10.0, middle), LABEL_SIZE, TEXT, Align::Right);
        let mut mine: Vec<&BudgetRow> = rows.iter().copied().filter(|r| r.coefficient == *coefficient).collect();
        mine.sort_by_key(|r| named.iter().position(|n| *n == r.input).unwrap_or(usize::MAX));
        let sum: f64 = mine.iter().map(|r| share(r)).sum();
        let scale = if sum > 1.0 { 1.0 / sum } else { 1.0 };
        let mut at = 0.0;
        for row in mine {
            let part = share(row) * scale * 100.0;
            if part <= 0.0 {
                continue;
            }
            let (x0, x1) = (panel.at_x(at), panel.at_x((at + part).min(100.0)));
            canvas.rectangle((x0, middle - 8.5), ((x1 - 1.0).max(x0 + 0.2), middle + 8.5), ink_of(&row.input));
            if part >= 8.0 && named.contains(&row.input.as_str()) {
                let text = Rich::plain(&number::percent(part / 100.0));
                canvas.text(&text, (x0.midpoint(x1), middle), TICK_SIZE - 0.5, WHITE, Align::Center);
            }
            at += part;
        }
    }
    let title = Rich::plain("Share of the coefficient's variance [%]");
    canvas.text(&title, (panel.left + panel.width / 2.0, total - 12.0), LABEL_SIZE, TEXT, Align::Center);
    let mut caption = format!(
        "Uncertainty budget of model {model}, {}: what part of each coefficient's variance comes from which input.",
        section.name
    );
    if shown.len() < coefficients.len() {
        let further =
            counted(coefficients.len() - shown.len(), "further coefficient stands", "further coefficients stand");
        let _ = write!(caption, " {further} in the table only.");
    }
    Some(Drawing {
        slug: format!("{}-budget", section.name),
        title: format!("{}: uncertainty budget", section.name),
        caption,
        canvas,
    })
}
