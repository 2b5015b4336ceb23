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

/// Lines of the recommended model: against speed at the most frequent angles, against angle at the most frequent speeds, or against another
/// channel.
pub(super) fn of(source: &SourceResult, model: &ModelFit, data: &Dataset) -> Result<Vec<Curve>, IdentifyError> {
    let other = abscissa(model, data);
    let moved = other.as_deref().map_or_else(|| vec!["speed", "angle", "v_x", "v_y"], |channel| vec![channel]);
    let mut out = Vec::new();
    for configuration in data.configurations() {
        let rows: Vec<usize> = (0..data.rows).filter(|&i| data.configuration[i] == configuration).collect();
        let held = held(model, data, &rows, &moved);
        let lines = match &other {
            Some(channel) => over_channel(data, channel).into_iter().collect(),
            None => over_motion(data, &rows),
        };
        for line in lines {
            out.extend(bands(source, model, data, &rows, line, &held)?);
        }
    }
    Ok(out)
}

/// Places on a line, and what it runs against.
type Line = (Vec<f64>, Against);

fn over_motion(data: &Dataset, rows: &[usize]) -> Vec<Line> {
    let of = |name: &str| -> Vec<f64> {
        data.values(name).map_or_else(|| vec![0.0; rows.len()], |v| rows.iter().map(|&i| v[i]).collect())
    };
    let (speed, angle) = (of("speed"), of("angle"));
    let (by_angle, by_speed) = (settings_of_angle(&angle), settings_of_speed(&speed));
    let ((slowest, fastest), (least, most)) = (ends(&speed), ends(&angle));
    let angles = frequent(&by_angle, &by_speed, MOST_ANGLES).into_iter();
    let speeds = frequent(&by_speed, &by_angle, MOST_SPEEDS).into_iter().filter(|_| most > least);
    let at_angle = |angle_rad| (line(slowest.min(0.0), fastest.max(0.0)), Against::Speed { angle_rad });
    let at_speed = |speed_m_s| (line(least, most), Against::Angle { speed_m_s });
    angles.map(at_angle).chain(speeds.map(at_speed)).collect()
}

fn over_channel(data: &Dataset, channel: &str) -> Option<Line> {
    let (low, high) = ends(data.values(channel)?);
    let unit = data.dimension(channel).unwrap_or(Dimension::ONE).to_string();
    Some((line(low, high), Against::Other { quantity: channel.to_owned(), unit }))
}

fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
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

/// Loads and bands at copies of the first of these observations, moved along a line.
fn bands(
    source: &SourceResult,
    model: &ModelFit,
    data: &Dataset,
    rows: &[usize],
    (x, against): Line,
    held: &[Abscissa],
) -> Result<Vec<Curve>, IdentifyError> {
    let first = rows.first().copied().unwrap_or(0);
    let mut places = data.subset(&vec![first; x.len()]);
    let mut put = |name: &str, values: Vec<f64>| {
        places.put(name, values, data.dimension(name).unwrap_or(Dimension::ONE));
    };
    for Abscissa { quantity, value, .. } in held {
        put(quantity, vec![*value; x.len()]);
    }
    let moves = match &against {
        Against::Speed { angle_rad } => Some((x.clone(), vec![*angle_rad; x.len()])),
        Against::Angle { speed_m_s } => Some((vec![*speed_m_s; x.len()], x.clone())),
        Against::Other { quantity, .. } => {
            put(quantity, x.clone());
            None
        }
    };
    if let Some((speed, angle)) = moves {
        places.put("speed", speed, Dimension::SPEED);
        places.put("angle", angle, Dimension::ONE);
        places.velocity_from_speed_and_angle();
    }
    let bands = envelope::of_source(source, &places)?;
    let curve = |(response, bands): (&String, &[Band])| Curve {
        configuration: data.configuration[first].clone(),
        component: response.clone(),
        unit: unit_text(&places, response),
        model: model.law.name.clone(),
        against: against.clone(),
        held: held.to_vec(),
        x: x.clone(),
        y: bands.iter().map(|band| band.load).collect(),
        low: bands.iter().map(|band| band.low).collect(),
        high: bands.iter().map(|band| band.high).collect(),
    };
    Ok(model.law.responses.iter().zip(bands.chunks(places.rows)).map(curve).collect())
}
