//! The track of the mark: from pixels to metres, the part that moves, and the speed over the last part of the way.
//!
//! x = s (u − c)(1 + k (u − c)²). Over the window x = x̄ + v τ + ½ a (τ² − …), orthogonal polynomials of time about its middle, so that v is the speed
//! there and a T its change over the window; their standard uncertainties are those of white errors of the track, times √τ where they are correlated.
//!
//! **Source.** Brown (1966), radial distortion; Forsythe (1957), orthogonal polynomials.

use std::ops::Range;

use froude_fit::autocorrelation::integrated_time;

use crate::error::TankError;

/// The wagon moves from this part of its way …
const FROM: f64 = 0.01;
/// Fewest frames of a window.
const FEWEST_FRAMES: usize = 8;

/// Radial distortion along the rail: x ← (x − c)(1 + k (x − c)²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// c, pixels.
    pub centre_px: f64,
    /// k, 1/pixel².
    pub radial: f64,
}

/// Positions of a mark, m; `scale_m` is the size of a pixel.
#[must_use]
pub fn metres(pixels: &[f64], scale_m: f64, lens: Option<Lens>) -> Vec<f64> {
    let of = |u: &f64| match lens {
        Some(Lens { centre_px, radial }) => {
            let away = u - centre_px;
            scale_m * away * (1.0 + radial * away * away)
        }
        None => scale_m * u,
    };
    pixels.iter().map(of).collect()
}

/// The speed over the last part of the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Samples at rest before.
    pub before: Range<usize>,
    /// Samples that move.
    pub moving: Range<usize>,
    /// The last part of those.
    pub window: Range<usize>,
    /// Samples at rest after.
    pub after: Range<usize>,
    /// Speed at the middle of the window, m/s.
    pub speed_m_s: f64,
    /// Standard uncertainty of that by the track's own errors, m/s.
    pub standard_m_s: f64,
    /// Acceleration there, m/s².
    pub acceleration_m_s2: f64,
    /// Change of the speed over the window, as part of it, with its standard uncertainty.
    pub change: [f64; 2],
    /// What the parabola leaves of the window, m.
    pub left_m: Vec<f64>,
    /// Standard deviation of that, m.
    pub noise_m: f64,
    /// Standard uncertainty of the speed by white errors of one metre, 1/s.
    pub per_noise: f64,
    /// The same of its change over the window, as part of it, 1/m.
    pub change_per_noise: f64,
}

/// Reads a track; positions may run either way.
///
/// # Errors
///
/// No motion, too few frames.
pub fn track(run: &str, time_s: &[f64], position_m: &[f64], window_m: f64) -> Result<Track, TankError> {
    let n = position_m.len();
    let way = position_m[n - 1] - position_m[0];
    let sense = way.signum();
    let progress = |i: usize| sense * (position_m[i] - position_m[0]);
    let moved_m = way.abs();
    if moved_m.is_nan() || moved_m < window_m {
        let what = format!(
            "the mark moves {moved_m:.3} m, less than the {window_m:.3} m evaluated; check the scale, or shorten the window in [source.weight_tow]"
        );
        return Err(TankError::of_run(run, what));
    }
    let start = (0..n).rev().find(|&i| progress(i) < FROM * moved_m).map_or(0, |i| i + 1);
    // Its last step may hold the stop.
    let end = (start..n).find(|&i| progress(i) > (1.0 - FROM) * moved_m).unwrap_or(n).saturating_sub(1).max(start);
    let is_at_end = progress(n - 1) - progress(n - 1 - (n - 1) / 50) > 0.5 * FROM * moved_m;
    let end = if is_at_end { n } else { end };
    let from = progress(end.saturating_sub(1)) - window_m;
    let first = (start..end).find(|&i| progress(i) >= from).unwrap_or(end);
    let window = first..end;
    if window.len() < FEWEST_FRAMES {
        let what = format!(
            "{} frames in the last {window_m:.3} m of the way, {FEWEST_FRAMES} are needed; film faster, or state a longer window in [source.weight_tow]",
            window.len()
        );
        return Err(TankError::of_run(run, what));
    }
    let t = &time_s[window.clone()];
    let x: Vec<f64> = window.clone().map(progress).collect();
    let m = x.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / m;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let middle = mean(t);
    let p1: Vec<f64> = t.iter().map(|t| t - middle).collect();
    let squares: Vec<f64> = p1.iter().map(|t| t * t).collect();
    let (level, tilt) = (mean(&squares), dot(&squares, &p1) / dot(&p1, &p1));
    let p2: Vec<f64> = squares.iter().zip(&p1).map(|(s, t)| s - level - tilt * t).collect();
    let (at, slope, bend) = (mean(&x), dot(&x, &p1) / dot(&p1, &p1), dot(&x, &p2) / dot(&p2, &p2));
    let left: Vec<f64> = (0..x.len()).map(|i| x[i] - at - slope * p1[i] - bend * p2[i]).collect();
    let noise_m = (dot(&left, &left) / (m - 3.0)).sqrt();
    let factor = integrated_time(&left).unwrap_or(1.0).max(1.0).sqrt();
    // dx/dt at the middle, where p1 = 0: slope − tilt·bend.
    let speed_m_s = slope - tilt * bend;
    let standard_m_s = factor * noise_m / dot(&p1, &p1).sqrt();
    let lasts_s = t[t.len() - 1] - t[0];
    let change = 2.0 * bend * lasts_s / speed_m_s;
    let change_standard = 2.0 * factor * noise_m / dot(&p2, &p2).sqrt() * lasts_s / speed_m_s;
    Ok(Track {
        before: 0..start.saturating_sub(1),
        moving: start..end,
        window,
        after: (end + 1).min(n)..n,
        speed_m_s,
        standard_m_s,
        acceleration_m_s2: 2.0 * bend,
        change: [change, change_standard],
        left_m: left,
        noise_m,
        per_noise: 1.0 / dot(&p1, &p1).sqrt(),
        change_per_noise: 2.0 / dot(&p2, &p2).sqrt() * lasts_s / speed_m_s.abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_its_speed_and_its_change() {
        // 1 s of rest, then 0.1 t + 0.02 t² for 5 s, then rest: 1 m of way.
        let time_s: Vec<f64> = (0..400).map(|i| 0.02 * f64::from(i)).collect();
        let position = |t: f64| {
            let t = (t - 1.0).clamp(0.0, 5.0);
            0.1 * t + 0.02 * t * t
        };
        let x: Vec<f64> = time_s.iter().map(|t| position(*t)).collect();
        let found = track("a", &time_s, &x, 0.3).unwrap();
        let t = |i: usize| time_s[i] - 1.0;
        let middle = 0.5 * (t(found.window.start) + t(found.window.end - 1));
        assert!((found.speed_m_s - (0.1 + 0.04 * middle)).abs() < 1e-12, "{found:?}");
        assert!((found.acceleration_m_s2 - 0.04).abs() < 1e-10);
        // The other way round it is the same.
        let back: Vec<f64> = x.iter().map(|x| 3.0 - x).collect();
        assert!((track("a", &time_s, &back, 0.3).unwrap().speed_m_s - found.speed_m_s).abs() < 1e-12);
    }

    #[test]
    fn a_lens_is_taken_out_as_it_was_put_in() {
        let lens = Lens { centre_px: 960.0, radial: -2e-8 };
        let [at] = metres(&[1700.0], 1.2e-3, Some(lens))[..] else { panic!() };
        assert!((at - 1.2e-3 * 740.0 * (1.0 - 2e-8 * 740.0 * 740.0)).abs() < 1e-15);
    }
}
