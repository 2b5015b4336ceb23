//! Forces over the iterations of a case, and the window that it was judged over.

use froude_records::page::{Chart, ChartPanel, Mark, Series};

use super::solved::Solved;
use crate::history;
use crate::judge::judged_window;
use crate::window::Window;

/// Part of the iterations that is not drawn: forces begin wild, and hide what they settle to.
const BEGINNING: f64 = 0.1;
/// Loads that are drawn, with their place among all.
const DRAWN: [(usize, &str); 2] = [(0, "f_x [N]"), (1, "f_y [N]")];

/// What a case's history says.
#[derive(Debug)]
pub(super) struct Convergence {
    pub chart: Chart,
    pub(super) window: Option<Window>,
    /// Of the last iteration.
    pub(super) last: f64,
}

impl Convergence {
    /// Of a case; or why there is none.
    pub fn of(solved: &Solved) -> Result<Self, String> {
        let samples = history::read(&solved.folder, solved.case.is_half).map_err(|e| e.to_string())?;
        let last = samples.last().ok_or("it has no forces")?.time;
        let window = judged_window(&solved.case, &samples);
        let drawn = &samples[(BEGINNING * samples.len() as f64) as usize..];
        let panel = |(load, label): (usize, &str)| {
            let mut series = vec![Series {
                name: "of an iteration".to_owned(),
                x: drawn.iter().map(|s| s.time).collect(),
                y: drawn.iter().map(|s| s.total()[load]).collect(),
                ..Series::default()
            }];
            series.extend(window.as_ref().map(|w| {
                let ends = |of: f64| vec![of; 2];
                let (mean, spread) = (w.mean[load], w.spread[load]);
                Series {
                    name: "window that was judged: its mean, and the farthest from it".to_owned(),
                    mark: Mark::Dashed,
                    x: vec![last - w.length as f64 + 1.0, last],
                    y: ends(mean),
                    low: ends(mean - spread),
                    high: ends(mean + spread),
                }
            }));
            ChartPanel { y_label: label.to_owned(), series, ..ChartPanel::default() }
        };
        let id = &solved.case.id;
        let judged = window.as_ref().map_or_else(String::new, |w| {
            format!(" It was judged over its last {} iterations: {}.", w.length, solved.outcome.status.word())
        });
        let chart = Chart {
            name: format!("convergence-{id}"),
            title: format!("Forces of {id} over iterations"),
            caption: format!(
                "{id}: forces of the water on the whole body over iterations, without the first tenth of them.{judged}"
            ),
            x_label: "iteration".to_owned(),
            panels: DRAWN.map(panel).to_vec(),
            ..Chart::default()
        };
        Ok(Self { chart, window, last })
    }

    pub(super) fn first(&self, window: &Window) -> f64 {
        self.last - window.length as f64 + 1.0
    }
}
