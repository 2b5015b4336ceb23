//! Folders of OpenFOAM cases of others as a source of `froude identify`: the mean loads of each case are a row, and the rows go the way of every table.

use std::collections::BTreeMap;

use froude_fit::budget::Kind;
use froude_identify::answer::Answer;
use froude_identify::method::{Declares, Found, Method, MethodError, Need};
use froude_identify::page::told;
use froude_identify::reduce::{Observations, reduce_table};
use froude_identify::source::identify_observations;
use froude_identify::uncertainty::SharedError;
use froude_identify::validation::STD_ITERATIVE;
use froude_records::RecordError;
use froude_records::block::Section;
use froude_records::campaign::{Campaign, Source};
use froude_records::finding::Finding;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit};

use super::convert::Conversion;
use super::files::{Read, read, stated_rho_inf};
use super::gathered::{Case, Gathered};
use super::judged::{Even, even, judged, norm};
use super::keys::{ForcesSpec, KEYS, NAME};
use super::page;
use super::settings::{Setting, settings};
use crate::history::Sample;
use crate::outcome::Loads;
use crate::verb::{LOADS, is_of_a_rig};

/// Force files of OpenFOAM cases.
#[derive(Debug)]
pub struct OpenFoamForces;

impl Method for OpenFoamForces {
    fn names(&self) -> &'static [&'static str] {
        &[NAME]
    }

    fn words(&self, _: &str) -> &'static str {
        "force files of OpenFOAM cases, each case an observation"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const { &[Need::of(&["case"], &[])] }
    }

    fn runs(&self) -> &'static str {
        NAME
    }

    fn takes(&self) -> &'static [&'static str] {
        &[NAME, "models", "uncertainty", "keep", "group"]
    }

    fn declares(&self) -> Option<Declares> {
        Some(Declares { section: NAME, keys: KEYS, plan: &[] })
    }

    fn check(&self, source: &Source) -> Result<(), RecordError> {
        let is_asked = source.methods.iter().any(|method| method == NAME);
        if is_asked { ForcesSpec::of(source).map(drop) } else { Ok(()) }
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let spec = ForcesSpec::of(source)?;
        let gathered = gathered(campaign, source, &spec, progress)?;
        let files = gathered.cases.iter().flat_map(Case::files).collect();
        let table = table(source, &gathered);
        let mut observations = reduce_table(campaign, source, &table, files)?;
        let errors = errors(&observations, &gathered.cases);
        observations.shared_errors.extend(errors);
        observations.findings.extend(page::findings(&gathered, &spec));
        let mut result = identify_observations(campaign, source, observations, NAME, &|model| {
            progress(&format!("fitting {model}"));
        })?;
        // A computation that is repeated says nothing new.
        let is_of_runs = |f: &Finding| is_of_a_rig(f) || f.code == "no-repeats";
        let findings = std::mem::take(&mut result.findings).into_iter().filter(|f| !is_of_runs(f)).collect();
        let answer = Answer::from(result);
        let blocks = std::iter::once(page::cases(&gathered).into()).chain(told::source(&answer));
        let summary = Some(Section::new("Loads of the cases", blocks.collect::<Vec<_>>()));
        Ok(Found { results: vec![answer], summary, findings, ..Found::default() })
    }
}

fn gathered(
    campaign: &Campaign,
    source: &Source,
    spec: &ForcesSpec,
    progress: &dyn Fn(&str),
) -> Result<Gathered, MethodError> {
    progress("reading the cases");
    let settings = settings(source.input.path(), spec)?;
    let density_kg_m3 = density(campaign)?;
    let (mut even_cases, mut without) = (Vec::new(), Vec::new());
    let (mut determined, mut density_ratio, mut origin_m) = ([true; 6], None, None);
    let mut first_centre: Option<([f64; 3], String)> = None;
    for setting in &settings.cases {
        let mut read = read(&setting.folder, spec, density_kg_m3)?;
        let ratio = if read.is_of_coefficients { 1.0 } else { ratio(spec, density_kg_m3, campaign, setting)? };
        if !read.is_of_coefficients {
            density_ratio = Some(ratio);
        }
        let centre_m = centre(spec, &mut read, setting)?;
        match (&first_centre, centre_m) {
            (Some((first, name)), Some(own)) if *first != own && spec.origin_m.is_none() => {
                let what = format!(
                    "its moments are about {own:?} m (CofR), those of {name} about {first:?}: write origin = \"0 m, 0 m, 0 m\", the point of the mesh that all are wanted about"
                );
                return Err(MethodError::input(&setting.folder, what));
            }
            (None, Some(own)) => first_centre = Some((own, setting.name.clone())),
            _ => {}
        }
        let centre = centre_m.unwrap_or_default();
        let origin = spec.origin_m.unwrap_or(centre);
        origin_m = centre_m.map(|_| origin).or(origin_m);
        let conversion = Conversion {
            density_ratio: ratio,
            plane: spec.plane,
            centre_m: centre,
            origin_m: origin,
            body: spec.body,
            turn_rad: if spec.is_body_turned == Some(true) { setting.angle_rad } else { 0.0 },
        };
        let own = conversion.determined(read.is_known);
        determined = std::array::from_fn(|k| determined[k] && own[k]);
        let convert = |sample: &Sample| Sample {
            time: sample.time,
            pressure: conversion.loads(&sample.total()),
            viscous: [0.0; 6],
        };
        let samples = std::mem::take(&mut read.samples).iter().map(convert).collect();
        match even(samples) {
            Ok(even) => even_cases.push((setting, read, even)),
            Err(why) => without.push((setting.name.clone(), why)),
        }
    }
    progress("judging the loads");
    let lever_m = lever_m(campaign, even_cases.iter().map(|(.., even)| even));
    let mut cases = Vec::new();
    for (setting, read, even) in even_cases {
        match judged(&even, lever_m, spec.window) {
            Ok(judged) => cases.push(Case {
                setting: setting.clone(),
                read,
                rows: even.rows,
                is_resampled: even.is_resampled,
                judged,
            }),
            Err(why) => without.push((setting.name.clone(), why)),
        }
    }
    let loads: Vec<usize> = (0..6).filter(|k| determined[*k]).collect();
    match (cases.is_empty(), without.first()) {
        (true, Some((name, why))) => {
            let more = without.len() - 1;
            let others = if more > 0 { format!(" ({more} more)") } else { String::new() };
            Err(MethodError::input(
                source.input.path(),
                format!("no case has usable mean loads: {name}: {why}{others}"),
            ))
        }
        _ if loads.is_empty() => {
            let what = "the force files determine no load along or about an axis of the body: coefficients of some directions only do not where the body is turned";
            Err(MethodError::input(source.input.path(), what))
        }
        _ => Ok(Gathered { cases, without, settings, loads, density_ratio, origin_m }),
    }
}

/// Density of the water, kg/m³; `None` if the campaign declares neither it nor the temperature.
fn density(campaign: &Campaign) -> Result<Option<f64>, MethodError> {
    let fluid = &campaign.fluid;
    match (fluid.density_kg_m3, fluid.temperature_degc) {
        (Some(density), _) => Ok(Some(density)),
        (None, Some(temperature)) => froude_hydro::fluid::Water::at(temperature, fluid.salinity_g_kg.unwrap_or(0.0))
            .map(|water| Some(water.density_kg_m3))
            .map_err(|e| MethodError::input(&campaign.path, e.to_string())),
        (None, None) => Ok(None),
    }
}

/// Density of the water over that which the forces are of.
fn ratio(
    spec: &ForcesSpec,
    density_kg_m3: Option<f64>,
    campaign: &Campaign,
    setting: &Setting,
) -> Result<f64, MethodError> {
    let Some(rho_inf) = spec.rho_inf_kg_m3 else {
        let advice = "the files do not state the density that their forces are of; write rho_inf = \"998 kg/m^3\", as rhoInf is in the function object (system/controlDict), or rho_inf = \"1 kg/m^3\" for forces divided by the density";
        return Err(spec.missing("rho_inf", advice).into());
    };
    if let Some((own, file)) = stated_rho_inf(&setting.folder).filter(|(own, _)| (own / rho_inf - 1.0).abs() > 1e-6) {
        let problem =
            format!("is {rho_inf} kg/m^3, and rhoInf is {own} in {}; write rho_inf = \"{own} kg/m^3\"", file.display());
        return Err(spec.wrong("rho_inf", problem).into());
    }
    density_kg_m3.map(|density| density / rho_inf).ok_or_else(|| {
        let what = "[fluid] states no density, which the forces are scaled to from that of rho_inf; write density = \"998 kg/m^3\", or temperature = \"20 degC\"";
        MethodError::input(&campaign.path, what)
    })
}

/// The point that the moments of a case are about: of its files, or declared; `None` where neither says and moments are left out.
fn centre(spec: &ForcesSpec, read: &mut Read, setting: &Setting) -> Result<Option<[f64; 3]>, MethodError> {
    match (read.centre_m, spec.centre_m) {
        (Some(own), Some(declared)) if own.iter().zip(declared).any(|(a, b)| (a - b).abs() > 1e-6) => {
            let problem = format!(
                "is {declared:?} m, and the files of {} state CofR {own:?}; leave out the wrong one",
                setting.name
            );
            Err(spec.wrong("centre_of_rotation", problem).into())
        }
        (Some(centre), _) | (None, Some(centre)) => Ok(Some(centre)),
        (None, None) => {
            if read.is_known[3..].contains(&true) {
                read.is_known = std::array::from_fn(|k| k < 3 && read.is_known[k]);
                read.notes.push(format!(
                    "the files of {} do not state CofR, so that their moments are left out; write centre_of_rotation = \"0 m, 0 m, 0 m\", as CofR is in the function object",
                    setting.name
                ));
            }
            Ok(None)
        }
    }
}

/// The length that moments are compared with forces by: the body's, or else the largest arm of a case.
fn lever_m<'a>(campaign: &Campaign, cases: impl Iterator<Item = &'a Even>) -> f64 {
    let declared = campaign.body.as_ref().and_then(|body| body.reference_length_m);
    declared.unwrap_or_else(|| {
        let arm = |even: &Even| {
            let [x, y, z, k, m, n] = even.late_mean();
            norm(&[k, m, n, 0.0, 0.0, 0.0]) / norm(&[x, y, z, 0.0, 0.0, 0.0])
        };
        cases.map(arm).filter(|arm| arm.is_finite()).fold(0.0, f64::max)
    })
}

fn table(source: &Source, gathered: &Gathered) -> Table {
    let cases = &gathered.cases;
    let text = |name: &str, of: &dyn Fn(&Case) -> String| Column {
        name: name.to_owned(),
        data: ColumnData::Text(cases.iter().map(of).collect()),
    };
    let number = |name: &str, dimension: Dimension, of: &dyn Fn(&Case) -> f64| Column {
        name: name.to_owned(),
        data: ColumnData::Number { unit: Unit::si(dimension), dimension, si: cases.iter().map(of).collect() },
    };
    let mut columns = vec![text("run", &|case| case.setting.name.clone())];
    if cases.iter().any(|case| !case.setting.configuration.is_empty()) {
        columns.push(text("configuration", &|case| case.setting.configuration.clone()));
    }
    columns.push(number("speed", Dimension::SPEED, &|case| case.setting.speed_m_s));
    columns.push(number("angle", Dimension::ANGLE, &|case| case.setting.angle_rad));
    let dimension = |load: usize| if load < 3 { Dimension::FORCE } else { Dimension::MOMENT };
    for prefix in ["", STD_ITERATIVE] {
        for &k in &gathered.loads {
            let of = |case: &Case| {
                let window = &case.judged.window;
                if prefix.is_empty() { window.mean[k] } else { window.std_of_mean[k] }
            };
            columns.push(number(&format!("{prefix}{}", LOADS[k]), dimension(k), &of));
        }
    }
    Table::of(source.input.path().to_owned(), columns, (1..=cases.len()).collect())
}

/// The error of the means: the scatter within its window is that of each case alone, and what the start of the flow leaves is alike in all, as they settle alike.
fn errors(observations: &Observations, cases: &[Case]) -> Vec<SharedError> {
    let by_run: BTreeMap<&str, &Case> = cases.iter().map(|case| (case.setting.name.as_str(), case)).collect();
    let rows = |of: &dyn Fn(&Loads, &Loads) -> f64| -> Vec<f64> {
        let one = |run: &String| {
            let window = by_run.get(run.as_str()).map(|case| &case.judged.window);
            window.map_or(0.0, |window| of(&window.std_of_mean, &window.still_to_go))
        };
        observations.data.run.iter().map(one).collect()
    };
    let loads = || LOADS.iter().enumerate().filter(|(_, load)| observations.data.values(load).is_some());
    let scatter = loads().map(|(k, load)| {
        let standard = rows(&|std, to_go| (std[k] * std[k] - to_go[k] * to_go[k]).max(0.0).sqrt());
        SharedError::of_each_row("scatter of the computed loads in time", load, &standard)
    });
    let start = loads().map(|(k, load)| {
        let left = rows(&|_, to_go| to_go[k]);
        SharedError::of_load(&format!("start-up transient ({load})"), load, &left, 1.0, f64::INFINITY)
    });
    let out: Vec<SharedError> = scatter.chain(start).collect();
    out.into_iter().map(|error| error.evaluated_as(Kind::Numerical)).collect()
}
