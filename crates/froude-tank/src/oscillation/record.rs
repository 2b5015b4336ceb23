//! A forced oscillation as an estimate, and which of several drag laws is recommended.

use froude_fit::select::aicc;
use froude_hydro::similarity::keulegan_carpenter;
use froude_hydro::swing::Medium;
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{
    Clusters, Diagnostics, Estimate, Frame, Law, Measured, MethodUsed, Output, Range, ReferencePoint,
};
use froude_records::run::FORCED_OSCILLATION;
use indexmap::IndexMap;

use super::fit::{ADDED, BUOYANCY, DELAY, OscillationFit};
use super::forces::Drag;
use super::setup::{LOAD, OscillationRun, Setup};
use crate::joint::record;
use crate::motion::Motion;

/// Laws whose criterion lies within this of the smallest are not told apart.
const ALIKE: f64 = 2.0;

/// What an estimate is made from beside its fit.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// The source.
    pub source: &'a Source,
    /// What is declared.
    pub setup: &'a Setup,
    /// The runs.
    pub runs: &'a [OscillationRun<'a>],
    /// Their motions.
    pub motions: &'a [Motion],
}

/// AICc of every law, at one effective number of observations: that of the law which leaves the least. What a wrong law leaves repeats with the
/// motion, and would count as correlation.
///
/// Its coefficients are those found and the zero of each run; `None` where the observations are too few.
#[must_use]
pub fn criteria(fits: &[(Drag, OscillationFit)]) -> Vec<Option<f64>> {
    let best = fits.iter().map(|(_, fit)| fit).min_by(|a, b| a.sigma.total_cmp(&b.sigma));
    let n = best.map_or(0, |fit| fit.effective.round() as usize);
    let of = |(_, fit): &(Drag, OscillationFit)| {
        let found = fit.unknowns.iter().filter(|u| u.value.is_some()).count() + fit.fitted.len();
        aicc(n, n as f64 * fit.sigma.powi(2), found as f64).ok()
    };
    fits.iter().map(of).collect()
}

/// The law with the fewest coefficients among those whose criterion lies within 2 of the smallest.
#[must_use]
pub fn chosen(fits: &[(Drag, OscillationFit)]) -> usize {
    let criteria = criteria(fits);
    let score = |i: usize| criteria[i].unwrap_or(f64::INFINITY);
    let least = (0..fits.len()).map(score).fold(f64::INFINITY, f64::min);
    let near = |i: &usize| score(*i) <= least + ALIKE;
    (0..fits.len()).filter(near).min_by_key(|&i| fits[i].0.columns.len()).unwrap_or(0)
}

/// The estimate of one drag law; `of` is how many laws it was chosen from, where it is the recommended one.
#[must_use]
pub fn estimate(fit: &OscillationFit, drag: &Drag, context: &Context<'_>, of: Option<usize>) -> Estimate {
    let Context { campaign, source, setup, runs, motions } = *context;
    let scatter = &fit.parts[0];
    let measured = |value: f64, unit: &str| Measured { value, unit: unit.to_owned() };
    let body = campaign.body.as_ref();
    let mut refers_to = IndexMap::from([("density".to_owned(), measured(setup.density_kg_m3.value, "kg/m^3"))]);
    if let Some(volume) = body.and_then(|b| b.link_volume_m3) {
        refers_to.insert("link_volume".to_owned(), measured(volume, "m^3"));
    } else if let [only] = setup.bodies.as_slice() {
        refers_to.insert("volume".to_owned(), measured(only.reference_volume_m3, "m^3"));
    }
    let words = body.and_then(|b| b.reference_point.clone());
    let wet = || runs.iter().zip(motions).filter(|(run, _)| run.medium == Medium::Water);
    let reason = of.map(|laws| {
        if laws == 1 {
            "the only drag law that was asked for".to_owned()
        } else {
            "fewest coefficients of the drag laws whose AICc, at the effective number of observations, lies within 2 of the smallest".to_owned()
        }
    });
    Estimate {
        id: format!("{}/{FORCED_OSCILLATION} {}", source.name, fit.law),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        method: MethodUsed {
            name: FORCED_OSCILLATION.to_owned(),
            version: 1,
            words: record::words(fit, setup.cycles, setup.harmonics, "force", setup.pivot.words()),
        },
        frame: Frame::body(),
        point: ReferencePoint { stated: words.is_some(), words: words.unwrap_or_default() },
        law: law(fit, drag, setup),
        refers_to,
        n_observations: fit.samples,
        clusters: Some(Clusters { by: fit.by.to_owned(), n: fit.clusters }),
        dof: IndexMap::from([(LOAD.to_owned(), scatter.dof.first().copied().filter(|d| d.is_finite()))]),
        coefficients: record::coefficients(fit, &|name| name == DELAY || name.starts_with(BUOYANCY)),
        type_a: Some(record::type_a(fit)),
        errors: record::errors(fit, campaign),
        validity: validity(wet(), setup, campaign),
        diagnostics: Diagnostics { notes: record::notes(fit, "N"), ..Diagnostics::default() },
        recommended: of.is_some(),
        reason,
        ..Estimate::default()
    }
}

/// The load as a formula, where the drag law is one; `volume` is the reference volume of the configuration.
fn law(fit: &OscillationFit, drag: &Drag, setup: &Setup) -> Law {
    let formula = drag.law.texts.get(LOAD).map(|text| format!("{text} - {ADDED}*density*volume*v_y_dot"));
    let mut inputs: IndexMap<String, String> =
        drag.law.channels().into_iter().map(|name| (name.to_owned(), unit_of(name).to_owned())).collect();
    for name in ["v_y_dot", "density", "volume"] {
        inputs.insert(name.to_owned(), unit_of(name).to_owned());
    }
    let constants = setup.bodies.iter().map(|body| {
        let of = if body.name.is_empty() { String::new() } else { format!("_{}", body.name) };
        (format!("volume{of}"), Measured { value: body.reference_volume_m3, unit: "m^3".to_owned() })
    });
    Law {
        name: format!("added_mass_{}", fit.law),
        version: 1,
        inputs,
        outputs: IndexMap::from([(LOAD.to_owned(), Output { unit: "N".to_owned(), formula })]),
        constants: constants.collect(),
    }
}

fn unit_of(channel: &str) -> &'static str {
    match channel {
        "v_x" | "v_y" | "speed" => "m/s",
        "v_y_dot" => "m/s^2",
        "density" => "kg/m^3",
        "volume" => "m^3",
        "angle" => "rad",
        _ => "1",
    }
}

/// Where the coefficients are supported: speeds, amplitudes, periods, and the numbers of oscillation.
fn validity<'a>(
    runs: impl Iterator<Item = (&'a OscillationRun<'a>, &'a Motion)>,
    setup: &Setup,
    campaign: &Campaign,
) -> IndexMap<String, Range> {
    let mut ranges: IndexMap<&str, (f64, f64, &str)> = IndexMap::new();
    let mut take = |name: &'static str, value: f64, unit: &'static str| {
        let range = ranges.entry(name).or_insert((f64::INFINITY, f64::NEG_INFINITY, unit));
        (range.0, range.1) = (range.0.min(value), range.1.max(value));
    };
    let height_m = campaign.body.as_ref().and_then(|b| b.link).map(|link| 2.0 * link.major_semi_axis_m);
    for (run, motion) in runs {
        let amplitude = motion.angle.amplitude(1);
        let (period, speed) =
            (motion.angle.period_s(), setup.radius_m.value.abs() * amplitude * motion.angle.omega_rad_s);
        take("flow", run.flow_m_s, "m/s");
        take("amplitude", amplitude, "rad");
        take("period", period, "s");
        take("speed", speed, "m/s");
        if let Some(height) = height_m {
            take("KC", keulegan_carpenter(speed, period, height), "1");
            if let Some(viscosity) = campaign.fluid.kinematic_viscosity_m2_s {
                take("beta", height * height / (viscosity * period), "1");
            }
        }
    }
    let range = |(name, (low, high, unit)): (&str, (f64, f64, &str))| {
        (name.to_owned(), Range { low, high, unit: unit.to_owned() })
    };
    ranges.into_iter().map(range).collect()
}
