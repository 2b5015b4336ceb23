//! What a mean, a track or a fit leaves of the runs, as a chart of its power density.

use froude_records::page::{Chart, ChartPanel, Mark, Scale};
use froude_signal::spectrum::density;

use crate::drawn::series;

/// Segments that the shortest run is cut into, at least.
const SEGMENTS: usize = 4;
/// Fewest samples of a segment.
const FEWEST: usize = 16;
/// Runs whose rates differ by more than this part have no frequencies in common.
const SAME_RATE: f64 = 1e-3;

/// What is left of one run, evenly spaced.
pub(crate) struct Left {
    pub rate_hz: f64,
    pub values: Vec<f64>,
}

impl Left {
    /// Of samples at these times.
    pub fn of(time_s: &[f64], values: Vec<f64>) -> Self {
        let lasts_s = time_s.last().copied().unwrap_or(0.0) - time_s.first().copied().unwrap_or(0.0);
        Self { rate_hz: time_s.len().saturating_sub(1) as f64 / lasts_s, values }
    }
}

/// Mean power density over the runs that have the rate of the first and 4 segments of 16 samples; `None` where none has.
///
/// `what` stands in the caption, with its unit; `says` is what a reader may take from the shape.
pub(crate) fn chart(runs: &[Left], what: (&str, &str), says: &str) -> Option<Chart> {
    let is_whole = |run: &&Left| run.values.len() >= SEGMENTS * FEWEST && run.values.iter().all(|x| x.is_finite());
    let rate_hz = runs.iter().find(is_whole)?.rate_hz;
    let is_alike = |run: &&Left| (run.rate_hz / rate_hz - 1.0).abs() <= SAME_RATE;
    let alike: Vec<&Left> = runs.iter().filter(is_whole).filter(is_alike).collect();
    let shortest = alike.iter().map(|run| run.values.len()).min()?;
    let segment = (shortest / SEGMENTS).checked_ilog2().map(|bits| 1_usize << bits).filter(|n| *n >= FEWEST)?;
    let densities = alike.iter().map(|run| density(&run.values, rate_hz, segment).ok());
    let densities: Vec<(Vec<f64>, Vec<f64>)> = densities.collect::<Option<_>>()?;
    let mean = |k: usize| densities.iter().map(|(_, power)| power[k]).sum::<f64>() / densities.len() as f64;
    // The mean of a segment was taken off, and the line at half the rate is one of two sides: both would be steps that are none.
    let lines = 1..densities[0].0.len() - 1;
    let (name, unit) = what;
    let squared = if unit.contains(' ') { format!("({unit})²") } else { format!("{unit}²") };
    let of = if alike.len() < runs.len() {
        format!("the {} of {} runs that are long enough and have one rate", alike.len(), runs.len())
    } else {
        "the runs".to_owned()
    };
    let frequencies = &densities[0].0[lines.clone()];
    let series = series("residual", Mark::Line, frequencies, lines.map(mean).collect::<Vec<f64>>());
    Some(Chart {
        name: "residual-spectrum".to_owned(),
        title: "Spectrum of the residuals".to_owned(),
        caption: format!("Power density of {name}, mean over {of}. {says}"),
        x_label: "frequency [Hz]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: vec![ChartPanel {
            y_label: format!("power density [{squared}/Hz]"),
            y_scale: Scale::Logarithmic,
            series: vec![series],
        }],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(rate_hz: f64, samples: u32) -> Left {
        let at = |i: u32| 0.3 * (std::f64::consts::TAU * 4.0 * f64::from(i) / rate_hz).sin();
        Left { rate_hz, values: (0..samples).map(at).collect() }
    }

    /// By Parseval the area below the density of a sine is half of its amplitude squared.
    #[test]
    fn the_area_below_it_is_the_mean_square_and_its_peak_stands_at_the_frequency() {
        let chart = chart(&[sine(100.0, 1000), sine(100.0, 900)], ("a sine", "N"), "").unwrap();
        let series = &chart.panels[0].series[0];
        let area: f64 = series.y.iter().sum::<f64>() * series.x[0];
        // Segments do not hold whole periods, and the lines at rest and at half the rate are left out: NumPy has 2e-4.
        assert!((area / (0.5 * 0.3 * 0.3) - 1.0).abs() < 1e-3, "{area}");
        let peak = (0..series.y.len()).max_by(|&a, &b| series.y[a].total_cmp(&series.y[b])).unwrap();
        assert!((series.x[peak] - 4.0).abs() <= series.x[0]);
        assert_eq!(chart.panels[0].y_label, "power density [N²/Hz]");
    }

    #[test]
    fn a_run_of_another_rate_is_left_out_and_said() {
        let chart = chart(&[sine(100.0, 1000), sine(50.0, 1000)], ("it", "N m"), "").unwrap();
        assert!(chart.caption.contains("the 1 of 2 runs that are long enough and have one rate"), "{}", chart.caption);
        assert_eq!(chart.panels[0].y_label, "power density [(N m)²/Hz]");
        assert!(super::chart(&[sine(100.0, 60)], ("it", "N"), "").is_none());
        assert!(super::chart(&[], ("it", "N"), "").is_none());
    }
}
