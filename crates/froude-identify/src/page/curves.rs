//! Lines of the recommended law with the envelope of the 95 % bands of all laws that the data do not contradict.

use froude_records::page::{Abscissa, Against, Curve};
use froude_records::units::Dimension;

use super::points::abscissa;
use super::settings::{frequent, settings_of_angle, settings_of_speed};
use crate::IdentifyError;
use crate::dataset::{Dataset, unit_text};
use crate::envelope::{self, Band};
use crate::regression::ModelFit;
use crate::result::SourceResult;

/// Places along a curve.
const CURVE_POINTS: usize = 60;
/// Curves against speed drawn per configuration at most, one an angle; more would hide the points.
const MOST_ANGLES: usize = 5;
/// Curves against angle, one a speed: they lie apart, and a drift test has few; more shades cannot be distinguished.
const MOST_SPEEDS: usize = 12;

/// Lines of the recommended model: against speed at the most frequent angles, against angle at the most frequent speeds.
pub(super) fn of(source: &SourceResult, model: &ModelFit, data: &Dataset) -> Result<Vec<Curve>, IdentifyError> {
    if let Some(channel) = abscissa(model, data) {
        return other_curves(source, model, data, &channel);
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
        let held = held(model, data, &rows, &["speed", "angle", "v_x", "v_y"]);
        let (slowest, fastest) = range("speed");
        let (least, most) = range("angle");
        for angle in angles {
            let x = line(slowest.min(0.0), fastest.max(0.0));
            let places = place(data, &rows, &held, &x, |d, x| {
                d.put("speed", x.to_vec(), Dimension::SPEED);
                d.put("angle", vec![angle; x.len()], Dimension::ONE);
                d.velocity_from_speed_and_angle();
            });
            let of = Along { configuration: &configuration, x: &x, against: Against::Speed { angle_rad: angle } };
            out.extend(bands(source, model, &places, &of, &held)?);
        }
        if most > least {
            for speed in speeds {
                let x = line(least, most);
                let places = place(data, &rows, &held, &x, |d, x| {
                    d.put("speed", vec![speed; x.len()], Dimension::SPEED);
                    d.put("angle", x.to_vec(), Dimension::ONE);
                    d.velocity_from_speed_and_angle();
                });
                let of = Along { configuration: &configuration, x: &x, against: Against::Angle { speed_m_s: speed } };
                out.extend(bands(source, model, &places, &of, &held)?);
            }
        }
    }
    Ok(out)
}

fn other_curves(
    source: &SourceResult,
    model: &ModelFit,
    data: &Dataset,
    channel: &str,
) -> Result<Vec<Curve>, IdentifyError> {
    let Some(values) = data.values(channel) else { return Ok(Vec::new()) };
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let dimension = data.dimension(channel).unwrap_or(Dimension::ONE);
    let x = line(low, high);
    let against = Against::Other { quantity: channel.to_owned(), unit: dimension.to_string() };
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let rows: Vec<usize> = (0..data.rows).filter(|&i| data.configuration[i] == configuration).collect();
        let held = held(model, data, &rows, &[channel]);
        let places = place(data, &rows, &held, &x, |d, x| d.put(channel, x.to_vec(), dimension));
        let of = Along { configuration: &configuration, x: &x, against: against.clone() };
        out.extend(bands(source, model, &places, &of, &held)?);
    }
    Ok(out)
}

fn line(low: f64, high: f64) -> Vec<f64> {
    (0..CURVE_POINTS).map(|k| low + (high - low) * k as f64 / (CURVE_POINTS - 1) as f64).collect()
}

/// The other channels that the law reads and the rows vary in, each at its median.
fn held(model: &ModelFit, data: &Dataset, rows: &[usize], moved: &[&str]) -> Vec<Abscissa> {
    let at_median = |name: &str| {
        let mut own: Vec<f64> = rows.iter().map(|&i| data.values(name).map_or(f64::NAN, |v| v[i])).collect();
        own.sort_by(f64::total_cmp);
        let varies = own.last().zip(own.first()).is_some_and(|(most, least)| most > least);
        varies.then(|| Abscissa { quantity: name.to_owned(), unit: unit_text(data, name), value: own[own.len() / 2] })
    };
    model.law.channels().into_iter().filter(|name| !moved.contains(name)).filter_map(at_median).collect()
}

/// Copies of the first of these observations, moved along a line.
fn place(data: &Dataset, rows: &[usize], held: &[Abscissa], x: &[f64], set: impl Fn(&mut Dataset, &[f64])) -> Dataset {
    let mut out = data.subset(&vec![rows.first().copied().unwrap_or(0); x.len()]);
    for Abscissa { quantity, value, .. } in held {
        let dimension = data.dimension(quantity).unwrap_or(Dimension::ONE);
        out.put(quantity, vec![*value; x.len()], dimension);
    }
    set(&mut out, x);
    out
}

/// The line that places lie on.
struct Along<'a> {
    configuration: &'a str,
    x: &'a [f64],
    against: Against,
}

fn bands(
    source: &SourceResult,
    model: &ModelFit,
    places: &Dataset,
    along: &Along<'_>,
    held: &[Abscissa],
) -> Result<Vec<Curve>, IdentifyError> {
    let bands = envelope::of_source(source, places)?;
    let curve = |(response, bands): (&String, &[Band])| Curve {
        configuration: along.configuration.to_owned(),
        component: response.clone(),
        unit: unit_text(places, response),
        model: model.law.name.clone(),
        against: along.against.clone(),
        held: held.to_vec(),
        x: along.x.to_vec(),
        y: bands.iter().map(|band| band.load).collect(),
        low: bands.iter().map(|band| band.low).collect(),
        high: bands.iter().map(|band| band.high).collect(),
    };
    Ok(model.law.responses.iter().zip(bands.chunks(places.rows)).map(curve).collect())
}
