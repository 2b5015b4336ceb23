//! Lines of the recommended law with their 95 % bands.

use froude_records::page::{Against, Curve};
use froude_records::units::Dimension;

use super::points::abscissa;
use super::settings::{frequent, settings_of_angle, settings_of_speed};
use crate::IdentifyError;
use crate::dataset::{Dataset, unit_text};
use crate::regression::ModelFit;

/// Places along a curve.
const CURVE_POINTS: usize = 60;
/// Curves against speed drawn per configuration at most, one an angle; more would hide the points.
const MOST_ANGLES: usize = 5;
/// Curves against angle, one a speed: they lie apart, and a drift test has few; more shades cannot be distinguished.
const MOST_SPEEDS: usize = 12;

/// Lines of the recommended model: against speed at the most frequent angles, against angle at the most frequent speeds.
pub(super) fn of(model: &ModelFit, data: &Dataset) -> Result<Vec<Curve>, IdentifyError> {
    if let Some(channel) = abscissa(model, data) {
        return other_curves(model, data, &channel);
    }
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let rows: Vec<usize> = (0..data.rows).filter(|&i| data.configuration[i] == configuration).collect();
        let of = |name: &str| -> Vec<f64> {
            data.values(name).map_or_else(|| vec![0.0; rows.len()], |v| rows.iter().map(|&i| v[i]).collect())
        };
        let (by_angle, by_speed) = (settings_of_angle(&of("angle")), settings_of_speed(&of("speed")));
        let angles = frequent(&by_angle, &by_speed, MOST_ANGLES);
        let speeds = frequent(&by_speed, &by_angle, MOST_SPEEDS);
        let range = |name: &str| {
            let v = data.values(name).unwrap_or_default();
            rows.iter()
                .map(|&i| v.get(i).copied().unwrap_or(0.0))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let (slowest, fastest) = range("speed");
        let (least, most) = range("angle");
        for angle in angles {
            let x = line(slowest.min(0.0), fastest.max(0.0));
            let places = place(data, rows[0], &x, |d, x| {
                d.put("speed", x.to_vec(), Dimension::SPEED);
                d.put("angle", vec![angle; x.len()], Dimension::ONE);
                d.velocity_from_speed_and_angle();
            });
            out.extend(bands(model, &places, &configuration, &x, &Against::Speed { angle_rad: angle })?);
        }
        if most > least {
            for speed in speeds {
                let x = line(least, most);
                let places = place(data, rows[0], &x, |d, x| {
                    d.put("speed", vec![speed; x.len()], Dimension::SPEED);
                    d.put("angle", x.to_vec(), Dimension::ONE);
                    d.velocity_from_speed_and_angle();
                });
                out.extend(bands(model, &places, &configuration, &x, &Against::Angle { speed_m_s: speed })?);
            }
        }
    }
    Ok(out)
}

fn other_curves(model: &ModelFit, data: &Dataset, channel: &str) -> Result<Vec<Curve>, IdentifyError> {
    let Some(values) = data.values(channel) else { return Ok(Vec::new()) };
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let dimension = data.dimension(channel).unwrap_or(Dimension::ONE);
    let x = line(low, high);
    let against = Against::Other { quantity: channel.to_owned(), unit: dimension.to_string() };
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let row = data.configuration.iter().position(|c| *c == configuration).unwrap_or(0);
        let places = place(data, row, &x, |d, x| d.put(channel, x.to_vec(), dimension));
        out.extend(bands(model, &places, &configuration, &x, &against)?);
    }
    Ok(out)
}

fn line(low: f64, high: f64) -> Vec<f64> {
    (0..CURVE_POINTS).map(|k| low + (high - low) * k as f64 / (CURVE_POINTS - 1) as f64).collect()
}

/// Copies of one observation, moved along a line.
fn place(data: &Dataset, row: usize, x: &[f64], set: impl Fn(&mut Dataset, &[f64])) -> Dataset {
    let mut out = data.subset(&vec![row; x.len()]);
    set(&mut out, x);
    out
}

fn bands(
    model: &ModelFit,
    places: &Dataset,
    configuration: &str,
    x: &[f64],
    against: &Against,
) -> Result<Vec<Curve>, IdentifyError> {
    let coefficients = model.law_coefficients();
    let y = model.law.predict(places, coefficients)?;
    let slopes = model.law.regressors(places, coefficients)?;
    let n = places.rows;
    let mut out = Vec::new();
    for (r, response) in model.law.responses.iter().enumerate() {
        let scatter_dof = model.scatter_dof(&slopes, r * n..(r + 1) * n);
        let row = |i: usize| (0..slopes.ncols()).map(|j| slopes[(r * n + i, j)]).collect::<Vec<f64>>();
        let arms: Vec<[f64; 2]> = (0..n).map(|i| model.arms(&row(i), scatter_dof)).collect();
        let y = &y[r * n..(r + 1) * n];
        out.push(Curve {
            configuration: configuration.to_owned(),
            component: response.clone(),
            unit: unit_text(places, response),
            model: model.law.name.clone(),
            against: against.clone(),
            x: x.to_vec(),
            y: y.to_vec(),
            low: y.iter().zip(&arms).map(|(y, [below, _])| y - below).collect(),
            high: y.iter().zip(&arms).map(|(y, [_, above])| y + above).collect(),
        });
    }
    Ok(out)
}
