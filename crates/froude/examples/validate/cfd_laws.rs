//! The chapter on laws and computed forces: the snake robot's computed flows fitted over all angles and over the tank's, beside the published sets.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use froude::identify::dataset::Dataset;
use froude::identify::law::ForceLaw;
use froude::pipeline::Identified;
use froude::records::comparison::Comparison;
use froude::records::estimate::Estimate;
use froude::records::page::{Chart, ChartPanel, Mark, Scale, Series};
use froude::records::write::write_atomically;
use froude::report::chart;

use crate::cfd_evidence::{Pair, table as evidence_table};

/// Sources of the example: all angles, and those of the tank.
const OWN: [&str; 2] = ["CFD", "CFD, angles of the tank"];
/// The paper's, and the example's own.
const LAWS: [&str; 7] = ["f1", "f2", "f3", "f4", "f5", "f6", LIFT];
const LIFT: &str = "lift";
const CONFIGURATION: &str = "H2LT";
const SPEED_M_S: f64 = 0.4;

/// Writes the page and its figure.
pub fn write(found: &Identified, pairs: &[Pair], pages: &Path) -> Result<(), Box<dyn Error>> {
    let figure = figure(found)?;
    write_atomically(&pages.join("cfd-laws.svg"), chart::svg(&figure).as_bytes())?;
    write_atomically(&pages.join("cfd-laws.md"), page(found, pairs)?.as_bytes())?;
    Ok(())
}

fn of<'a>(found: &'a Identified, source: &str, law: &str) -> Option<&'a Estimate> {
    found.file.estimates.iter().find(|e| e.source == source && e.law.name == law)
}

fn value(estimate: Option<&Estimate>, name: &str) -> String {
    let value = estimate.and_then(|e| e.coefficients.get(name)?.value);
    value.map_or_else(|| "–".to_owned(), |v| format!("{v:.3}"))
}

/// A published set's coefficient, as the comparison has it.
fn published(comparison: &Comparison, source: &str, law: &str, name: &str) -> String {
    let sides = comparison
        .coefficients
        .iter()
        .filter(|pair| pair.model == law && pair.coefficient == name)
        .flat_map(|pair| [&pair.first, &pair.second]);
    let id = format!("{source}/{law}");
    let found = sides.into_iter().find(|side| side.source.starts_with(&id)).and_then(|side| side.value);
    found.map_or_else(|| "–".to_owned(), |v| format!("{v:.3}"))
}

fn table(found: &Identified) -> Result<String, Box<dyn Error>> {
    let comparison = found.file.comparison.as_ref().ok_or("nothing was compared")?;
    let mut out = "| law | coefficient | paper's CFD | computed here, 0 to 90° | computed here, to 39° | towing rig, to 39° | circulation tank, to 39° |\n| --- | --- | --- | --- | --- | --- | --- |\n".to_owned();
    for law in LAWS {
        let own = OWN.map(|source| of(found, source, law));
        let Some(first) = own[0] else { continue };
        for name in first.coefficients.keys() {
            let [cfd, rig, tank] = ["cfd", "towing_rig", "circulation_tank_restricted"]
                .map(|source| published(comparison, source, law, name));
            writeln!(
                out,
                "| {law} | {name} | {cfd} | {} | {} | {rig} | {tank} |",
                value(own[0], name),
                value(own[1], name)
            )?;
        }
    }
    Ok(out)
}

/// What each law leaves of the loads, and which is recommended.
fn left(found: &Identified) -> Result<String, Box<dyn Error>> {
    let mut out =
        "| law | 0 to 90°: f_x, N | f_y, N | to 39°: f_x, N | f_y, N |\n| --- | --- | --- | --- | --- |\n".to_owned();
    for law in LAWS {
        let cell = |source: &str, load: &str| {
            let estimate = of(found, source, law);
            estimate.and_then(|e| e.sigma.get(load)).map_or_else(|| "–".to_owned(), |s| format!("{:.3}", s.value))
        };
        let mark = |source: &str| if of(found, source, law).is_some_and(|e| e.recommended) { "**" } else { "" };
        let [all, tank] = OWN.map(mark);
        writeln!(
            out,
            "| {law} | {all}{}{all} | {all}{}{all} | {tank}{}{tank} | {tank}{}{tank} |",
            cell(OWN[0], "f_x"),
            cell(OWN[0], "f_y"),
            cell(OWN[1], "f_x"),
            cell(OWN[1], "f_y")
        )?;
    }
    Ok(out)
}

/// Computed loads of a configuration at a speed by angle, rad: rows in order.
fn rows(data: &Dataset) -> Option<Vec<usize>> {
    let (speed, angle) = (data.values("speed")?, data.values("angle")?);
    let is_meant = |row: &usize| data.configuration[*row] == CONFIGURATION && (speed[*row] - SPEED_M_S).abs() < 1e-9;
    let mut rows: Vec<usize> = (0..data.rows).filter(is_meant).collect();
    rows.sort_by(|a, b| angle[*a].total_cmp(&angle[*b]));
    Some(rows)
}

fn figure(found: &Identified) -> Result<Chart, Box<dyn Error>> {
    let data = &found.sources.iter().find_map(|s| s.fitted()).ok_or("no computed source")?.data;
    let rows = rows(data).ok_or("no speed or angle")?;
    let angle = data.values("angle").ok_or("no angle")?;
    let x: Vec<f64> = rows.iter().map(|row| angle[*row].to_degrees()).collect();
    let mut panels = Vec::new();
    for load in ["f_x", "f_y"] {
        let values = data.values(load).ok_or("no load")?;
        let mut series = vec![Series {
            name: "computed".to_owned(),
            mark: Mark::Points,
            x: x.clone(),
            y: rows.iter().map(|row| values[*row]).collect(),
            ..Series::default()
        }];
        for (source, law, words) in [
            (OWN[0], "f2", "f2 fitted to 90°"),
            (OWN[1], "f2", "f2 fitted to 39°"),
            (OWN[0], LIFT, "lift fitted to 90°"),
            (OWN[1], LIFT, "lift fitted to 39°"),
        ] {
            let Some(estimate) = of(found, source, law) else { continue };
            let law = ForceLaw::of_estimate(estimate, data)?;
            let values: Option<Vec<f64>> =
                law.coefficients.iter().map(|c| estimate.coefficients.get(&c.name)?.value).collect();
            let (Some(values), Some(response)) = (values, law.responses.iter().position(|r| r == load)) else {
                continue;
            };
            let force = law.predict(data, &values)?;
            series.push(Series {
                name: words.to_owned(),
                mark: if source == OWN[0] { Mark::Line } else { Mark::Dashed },
                x: x.clone(),
                y: rows.iter().map(|row| force[response * data.rows + row]).collect(),
                ..Series::default()
            });
        }
        panels.push(ChartPanel { y_label: format!("{load} [N]"), y_scale: Scale::Linear, series });
    }
    Ok(Chart {
        name: "cfd-laws".to_owned(),
        title:
            "Computed forces of two links against the angle, with laws fitted to all angles and to those of the tank"
                .to_owned(),
        caption: format!("{CONFIGURATION} at {SPEED_M_S} m/s."),
        x_label: "angle [deg]".to_owned(),
        x_scale: Scale::Linear,
        panels,
    })
}

/// How far computed f_y lies above v_y|v_y| through its value at 90°, at each angle of the configuration and speed of the figure.
fn above_square(found: &Identified) -> Result<String, Box<dyn Error>> {
    let data = &found.sources.iter().find_map(|s| s.fitted()).ok_or("no computed source")?.data;
    let rows = rows(data).ok_or("no speed or angle")?;
    let (angle, force) = (data.values("angle").ok_or("no angle")?, data.values("f_y").ok_or("no f_y")?);
    let across = rows.last().map(|row| force[*row] / angle[*row].sin().powi(2)).ok_or("no rows")?;
    let of = |row: &usize| {
        format!("{:.0}° {:.2}", angle[*row].to_degrees(), force[*row] / (across * angle[*row].sin().powi(2)))
    };
    Ok(rows.iter().filter(|row| angle[**row] > 0.01).map(of).collect::<Vec<_>>().join(", "))
}

/// By how much fits to 39° lie above fits to 90°, and the tanks above both, in the square terms across.
fn ratios(found: &Identified) -> Result<String, Box<dyn Error>> {
    let comparison = found.file.comparison.as_ref().ok_or("nothing was compared")?;
    let mut out = "| law | coefficient | to 39° over 0 to 90°, computed here | tank over computed here to 39° | rig over computed here to 39° | tank over the paper's CFD |\n| --- | --- | --- | --- | --- | --- |\n".to_owned();
    for (law, name) in [("f2", "C_d_II"), ("f4", "C_d_II"), ("f6", "C_d"), ("f2", "C_f_II"), ("f6", "C_f")] {
        let own = OWN.map(|source| of(found, source, law).and_then(|e| e.coefficients.get(name)?.value));
        let of = |source: &str| published(comparison, source, law, name).parse::<f64>().ok();
        let over = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) if b != 0.0 => format!("{:.2}", a / b),
            _ => "–".to_owned(),
        };
        let (tank, rig, cfd) = (of("circulation_tank_restricted"), of("towing_rig"), of("cfd"));
        writeln!(
            out,
            "| {law} | {name} | {} | {} | {} | {} |",
            over(own[1], own[0]),
            over(tank, own[1]),
            over(rig, own[1]),
            over(tank, cfd)
        )?;
    }
    Ok(out)
}

fn page(found: &Identified, pairs: &[Pair]) -> Result<String, Box<dyn Error>> {
    Ok(format!(
        "# Which law do computed forces support?\n\n\
         This page is written by `cargo xtask validate --full cfd-campaign --page`; no figure is typed by hand. It takes the campaign of `examples/mamba-cfd`: the smooth stand-in of the snake robot Mamba, nine configurations, k-ω SST on 22,400 cells over half a turn ([computed flows](cfd.md)). \
         The paper's CFD coefficients lie 1.4 to 6 times below those of its tanks. The question is why, and which of the six laws the computed forces support.\n\n\
         ## Two ranges of angles\n\n\
         The paper fits its CFD to angles from 0 to 90°, its towing rig and its circulation tank to 39° at most. The same computed flows are fitted here over both ranges.\n\n{}\n\
         The ratios of the square terms:\n\n{}\n\
         ![Computed forces of two links against the angle, with laws fitted over both ranges](cfd-laws.svg)\n\n\
         **f_y grows more slowly than v_y².** Over v_y² through the value at 90°, computed f_y of {CONFIGURATION} at {SPEED_M_S} m/s lies at {}. \
         Two things make it so. An end that the flow separates from keeps a load that goes with sin 2α and does not grow with the length (Allen & Perkins, NACA Report 1048, 1951). And the cross-flow drag of a section depends on how far its vortices have developed, that is on the distance that the cross-flow has travelled since the nose. \
         A law with v_y² alone, fitted to 39°, makes its coefficient of the loads there, and its force at 90° is far beyond the computed one; fitted to 90° it misses the small angles. None of the six laws has a term v_x v_y in f_y: in f4 and f5 the cross terms act on f_x. \
         The law `lift` of the example has one. It is empirical, and its terms along the body are odd in v_x, as the symmetry fore and aft wants it.\n\n\
         So a part of the difference between the paper's CFD and its tanks is the range of angles of the fits: the ratios above say how much. Coefficients from different ranges cannot be compared in these laws; forces in the common range can. \
         The forces near 90° that enter the wider range are the less certain ones: a steady flow with a plane of symmetry cannot shed vortices, which takes from the drag of a bluff section.\n\n\
         ## What each law leaves\n\n\
         Standard deviation of the residuals; the recommended law of each range is bold.\n\n{}\n\
         ## Walls, necks and the model\n\n\
         Two computations each, of two links (four for the finer mesh), that differ in one thing, as far as meshes allow: cubes are what snappyHexMesh cuts, as an O-grid does not follow necks (8 mm at the surface, so that the necks' ramps of 4 mm are steps), and the far cubes of a tank are those that fit into it. In time is the mean over 21 seconds with its standard deviation, for which neighbours in time count as what they are, alike. In per cent is the change of the force itself, where that is far from zero.\n\n{}\n\
         ## What remains\n\n\
         Forces in the range of the tank, by ASME V&V 20, stand on the [validation page](validation.md). What remains between computed and measured forces there may come from: the module's geometry, which is not published in full (joints, screws and cables add area and separate the flow); the rig (struts and mounting in the water, surface, blockage of a narrow tank, none of which the paper states); the model of turbulence, which has the layer turbulent nominally from the nose on; the steady flow, which cannot shed; and the mesh. The steady flows of short bodies have two mirrored states at 90°, of which each has a force along the body; their mean has none.\n",
        table(found)?,
        ratios(found)?,
        above_square(found)?,
        left(found)?,
        evidence_table(pairs),
    ))
}
