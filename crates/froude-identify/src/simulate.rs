//! The statistical twin: the table that a campaign would give for chosen true coefficients.
//!
//! The truth is a force law over the planned settings. The sensor adds, in this
//! order: a misalignment between sensor and body, a bias, a linear drift over
//! each setup, noise, and its resolution. Seeded: the same campaign gives the
//! same table on any machine.

pub mod tables;

use froude_hydro::fluid::Water;
use froude_records::campaign::{Campaign, Source, StatedTruth, Truth};
use froude_records::json::read_estimates;
use froude_records::nearest::suggestion;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};
use rand_distr::{Distribution, StandardNormal};

use crate::dataset::{Dataset, distinct, labels};
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::uncertainty::generator;

/// The planned settings of a source: a row per run, with motion and water, loads at zero.
///
/// # Errors
///
/// A campaign without density.
pub fn planned(campaign: &Campaign, source: &Source) -> Result<Dataset, IdentifyError> {
    let mut data = Dataset::default();
    let (mut speed, mut angle, mut links, mut repeat) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for block in &source.plan {
        for configuration in &block.configurations {
            let k = froude_records::table::links_of_configuration(configuration);
            for &u in &block.speed_m_s {
                for &a in &block.angle_rad {
                    for r in 1..=block.repeats {
                        data.configuration.push(configuration.clone());
                        data.setup.push(configuration.clone());
                        data.run.push(format!("{}", data.run.len() + 1));
                        speed.push(u);
                        angle.push(a);
                        links.push(k.map(f64::from));
                        repeat.push(r as f64);
                    }
                }
            }
        }
    }
    data.rows = speed.len();
    data.line = (2..2 + data.rows).collect();
    data.put("speed", speed, Dimension::SPEED);
    data.put("angle", angle, Dimension::ONE);
    // Where all are HkLT; a law that needs links says so where they are missing.
    if let Some(links) = links.into_iter().collect() {
        data.put("n_links", links, Dimension::ONE);
    }
    data.put("repeat", repeat, Dimension::ONE);
    let density = match (campaign.fluid.density_kg_m3, campaign.fluid.temperature_degc) {
        (Some(rho), _) => rho,
        (None, Some(t)) => {
            Water::at(t, campaign.fluid.salinity_g_kg.unwrap_or(0.0))
                .map_err(|e| IdentifyError::Campaign { place: "[fluid]".to_owned(), what: e.to_string() })?
                .density_kg_m3
        }
        (None, None) => {
            return Err(IdentifyError::Campaign {
                place: "[fluid]".to_owned(),
                what: "a twin needs the water: state density, or temperature and salinity".to_owned(),
            });
        }
    };
    data.put("density", vec![density; data.rows], Dimension::DENSITY);
    data.put("f_x", vec![0.0; data.rows], Dimension::FORCE);
    data.put("f_y", vec![0.0; data.rows], Dimension::FORCE);
    data.velocity_from_speed_and_angle();
    Ok(data)
}

/// The true law and its coefficients, from `[simulate]`.
///
/// # Errors
///
/// No `[simulate]`, an unreadable record, or a truth that is no force law.
pub fn truth(campaign: &Campaign, data: &Dataset) -> Result<(ForceLaw, Vec<f64>), IdentifyError> {
    let simulate = campaign.simulate.as_ref().ok_or_else(|| IdentifyError::Campaign {
        place: campaign.path.display().to_string(),
        what: "a twin needs [simulate]: seed, and the true coefficients as record or coefficients".to_owned(),
    })?;
    match &simulate.truth {
        Truth::Record { path, select } => {
            let file = read_estimates(path)?;
            let estimate = crate::select::one_estimate(&file, select.as_deref(), path)?;
            let law = ForceLaw::of_estimate(estimate, data)?;
            let unknown = |name: &str| IdentifyError::Campaign {
                place: path.display().to_string(),
                what: format!("{} does not state {name}, which a truth needs", estimate.id),
            };
            let values = law.values_of(estimate).map_err(unknown)?;
            Ok((law, values))
        }
        Truth::Coefficients { model, values } => {
            let mut alone = campaign.clone();
            alone.identify.models = vec![model.clone()];
            let mut source = campaign.sources.first().cloned().ok_or_else(|| IdentifyError::Campaign {
                place: campaign.path.display().to_string(),
                what: "the campaign has no source".to_owned(),
            })?;
            source.models = vec![model.clone()];
            source.model_places.clear();
            let law = crate::source::models::laws(&alone, &source, data)?.remove(0);
            let chosen = law
                .coefficients
                .iter()
                .map(|c| {
                    values.get(&c.name).copied().ok_or_else(|| IdentifyError::Campaign {
                        place: "[simulate.coefficients]".to_owned(),
                        what: format!("model {model} also needs {}", c.name),
                    })
                })
                .collect::<Result<_, _>>()?;
            let own: Vec<(&str, &str)> = law.coefficients.iter().map(|c| (c.name.as_str(), c.unit.as_str())).collect();
            let stated = campaign.simulate.as_ref().map_or(&[][..], |simulate| &simulate.stated);
            check_stated(stated, model, &own, &[])?;
            Ok((law, chosen))
        }
    }
}

/// Refuses a true coefficient that `model` does not have, or that is stated in a unit of another kind; `own` are those that it has, with their units, `others`
/// names that it may have beside them.
///
/// # Errors
///
/// The first such coefficient, with its place.
pub fn check_stated(
    stated: &[StatedTruth],
    model: &str,
    own: &[(&str, &str)],
    others: &[String],
) -> Result<(), IdentifyError> {
    for StatedTruth { coefficient: name, unit, place } in stated {
        let what = match (own.iter().find(|(own, _)| own == name), unit) {
            (Some((_, own)), Some(unit)) if parse_unit(own).is_ok_and(|own| own.dimension != unit.dimension) => {
                format!("{name} of {model} is in {own}, and is stated in {}: write it in its unit", unit.text)
            }
            (None, _) if !others.contains(name) => {
                let names = own.iter().map(|(name, _)| *name);
                format!("model {model} has no coefficient {name}; {}", suggestion(name, names.collect::<Vec<_>>()))
            }
            _ => continue,
        };
        return Err(IdentifyError::Campaign { place: place.to_string(), what });
    }
    Ok(())
}

/// The observations of a source as its sensors would report them.
///
/// `stream` separates the sources of a campaign; the same seed and stream give the same table.
///
/// The sensor adds, in this order: misalignment δ (f_x cos δ + f_y sin δ, f_y cos δ − f_x sin δ), bias, drift, noise, resolution. SI units.
///
/// # Errors
///
/// See [`planned`] and [`truth`].
pub fn observations(campaign: &Campaign, source: &Source, stream: u64) -> Result<Dataset, IdentifyError> {
    let mut data = planned(campaign, source)?;
    let (law, values) = truth(campaign, &data)?;
    let force = law.predict(&data, &values)?;
    let n = data.rows;
    for (r, response) in law.responses.iter().enumerate() {
        data.put(response, force[r * n..(r + 1) * n].to_vec(), Dimension::FORCE);
    }
    let Some(simulate) = &campaign.simulate else { return Ok(data) };
    if let Some(delta) = simulate.misalignment_rad
        && let (Some(x), Some(y)) = (data.values("f_x").map(<[f64]>::to_vec), data.values("f_y").map(<[f64]>::to_vec))
    {
        let (sin, cos) = delta.sin_cos();
        data.put("f_x", x.iter().zip(&y).map(|(x, y)| cos * x + sin * y).collect(), Dimension::FORCE);
        data.put("f_y", x.iter().zip(&y).map(|(x, y)| cos * y - sin * x).collect(), Dimension::FORCE);
    }
    let mut rng = generator(simulate.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(stream));
    let setups = labels(&data.setup);
    let n_setups = distinct(&data.setup).len();
    for sensor in &simulate.sensors {
        let quantity = data.meant(&sensor.quantity);
        if sensor.correlation_s.is_some() {
            return Err(IdentifyError::Campaign {
                place: sensor.place.as_ref().map_or_else(|| "[[simulate.sensor]]".to_owned(), ToString::to_string),
                what: "correlation applies to noise over time, and the rows of a table have no times: leave it out"
                    .to_owned(),
            });
        }
        let Some(channel) = data.channels.get_mut(quantity) else {
            return Err(IdentifyError::Campaign {
                place: "[[simulate.sensor]]".to_owned(),
                what: format!("quantity = {:?} is not measured here; use f_x, f_y, speed or angle", sensor.quantity),
            });
        };
        let slope: Vec<f64> = (0..n_setups)
            .map(|_| {
                let unit: f64 = StandardNormal.sample(&mut rng);
                unit * sensor.drift.unwrap_or(0.0)
            })
            .collect();
        let mut seen = vec![0_usize; n_setups];
        let mut total = vec![0_usize; n_setups];
        for &s in &setups {
            total[s] += 1;
        }
        for i in 0..n {
            let s = setups[i];
            let progress = seen[s] as f64 / (total[s].max(2) - 1) as f64;
            seen[s] += 1;
            let unit: f64 = StandardNormal.sample(&mut rng);
            let mut value = channel.values[i]
                + sensor.bias.unwrap_or(0.0)
                + slope[s] * progress
                + unit * sensor.noise.unwrap_or(0.0);
            if let Some(step) = sensor.resolution.filter(|s| *s > 0.0) {
                value = (value / step).round() * step;
            }
            channel.values[i] = value;
        }
    }
    Ok(data)
}

/// The observations as a table in the units a person reads.
///
/// # Errors
///
/// None for the columns written here; a unit that does not parse would be a slip of ours.
pub fn table(data: &Dataset, source: &Source) -> Result<Table, IdentifyError> {
    let path = match &source.input {
        froude_records::campaign::Input::Table(path) => path.clone(),
        _ => std::path::PathBuf::from(format!("{}.csv", source.name)),
    };
    let mut columns: Vec<Column> = data.named_columns().collect();
    for (name, unit) in [("repeat", "1"), ("speed", "m/s"), ("angle", "deg"), ("f_x", "N"), ("f_y", "N")] {
        if let Some(channel) = data.channels.get(name) {
            let unit = unit_of(unit);
            columns.push(Column {
                name: name.to_owned(),
                data: ColumnData::Number { unit, dimension: channel.dimension, si: channel.values.clone() },
            });
        }
    }
    Ok(Table { n_rows: data.rows, ..Table::of(path, columns, data.line.clone()) })
}

/// A unit that is written here; one that did not parse would be written as SI.
fn unit_of(text: &str) -> Unit {
    parse_unit(text).unwrap_or_else(|_| Unit::one())
}
