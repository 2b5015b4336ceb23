//! The step of a reading against its noise.
//!
//! A reading in steps of q has a standard uncertainty of q/√12 that is independent from sample to sample only where noise of that size or more moves it from
//! step to step. Below that it repeats, and no mean averages it down. The noise is that of second differences, √(Σ(xᵢ₋₁ − 2xᵢ + xᵢ₊₁)²/6n) without the largest
//! of them, which neither a smooth motion nor a start enters; what the steps themselves add to it is in there too.
//!
//! **Source.** JCGM 100:2008 (GUM), F.2.2.1; Widrow & Kollár (2008), *Quantization Noise*, ch. 4.

use crate::findings::warning;
use crate::log::TankLog;
use froude_records::number::significant;

/// This part of the second differences, the largest, are left out: a start, a stop, an outlier.
const LEFT_OUT: f64 = 0.05;
/// What is left then of the variance of a normal noise: 1 − 2·1.96 φ(1.96)/0.95.
const LEFT: f64 = 0.759;

/// Standard deviation of the noise by second differences; `None` for fewer than three samples.
#[must_use]
pub fn noise(values: &[f64]) -> Option<f64> {
    let mut squares: Vec<f64> = values.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(((1.0 - LEFT_OUT) * squares.len() as f64).ceil() as usize);
    let n = squares.len();
    (n > 0).then(|| (squares.iter().sum::<f64>() / (6.0 * LEFT * n as f64)).sqrt())
}

/// Says where the step of a channel is larger than its noise.
pub fn check(run: &mut TankLog) {
    let mut found = Vec::new();
    for (name, told) in &run.told {
        let (Some(step), Some(channel)) = (told.sensor.resolution, run.log.channels.get(name)) else { continue };
        let standard = step / 12.0_f64.sqrt();
        // Noise of its own and steps add in squares.
        let Some(noise) = noise(&channel.values).filter(|noise| noise.powi(2) < 2.0 * standard.powi(2)) else {
            continue;
        };
        let unit = &channel.meaning.unit;
        let text = format!(
            "{}: {name} is read in steps of {} {unit}, a standard uncertainty of {} {unit} (q/√12), and its noise, the steps included, is {} {unit}: quantisation dominates, and means do \
             not average it down; read it more finely, or declare it in [[source.uncertainty]]",
            run.log.path.display(),
            significant(step, 3),
            significant(standard, 2),
            significant(noise, 2)
        );
        found.push(warning("quantised", text));
    }
    run.findings.extend(found);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise of σ through Σ(1, −2, 1)² = 6 gives σ; a sine of 100 samples a period adds (2π/100)² of its amplitude.
    #[test]
    fn second_differences_give_the_noise_and_not_the_motion() {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let values: Vec<f64> =
            (0..20_000).map(|i| 0.3 * (std::f64::consts::TAU * f64::from(i) / 100.0).sin() + 0.1 * uniform()).collect();
        // 0.1/√12 = 28.9 mN; the motion adds 0.3·3.9e-3/√12 = 0.3 mN in squares; 20,000 samples tell it to 1 %. Three evenly distributed numbers have fewer large
        // differences than normal ones (excess kurtosis −0.6), of which the largest 5 % hold 18 % of the squares and not 24 %: 4 % of the root.
        let found = noise(&values).unwrap();
        assert!((found / (0.1 / 12.0_f64.sqrt()) - 1.0).abs() < 0.06, "{found}");
        let mut jumps = values;
        jumps.iter_mut().skip(7_000).for_each(|x| *x += 50.0);
        assert!((noise(&jumps).unwrap() / found - 1.0).abs() < 1e-3);
        assert_eq!(noise(&[1.0, 2.0]), None);
    }
}
