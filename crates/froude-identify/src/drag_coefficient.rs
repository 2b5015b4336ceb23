//! C_D of every law that gives a force along one axis, wherever area and density are known: as a derived number of its record, and over the Reynolds number beside published curves.
//!
//! C_D = −(f(U) − f(0))/(½ρU²A), the load at rest taken off, as it is the zero of a sensor. Its uncertainty is that of the law at that speed, with the area's and the density's own as they are declared:
//! u²(C_D)/C_D² = u²(f)/f² + u²(ρ)/ρ² + u²(A)/A², degrees of freedom by Welch and Satterthwaite.
//! Of a law of U² it is one number; of any other law the record has that at the fastest speed observed, and the figure all of them. The interval holds if the law is true.
//!
//! | known                                                | from                                                              |
//! |------------------------------------------------------|-------------------------------------------------------------------|
//! | A, ρ                                                 | the record, else `reference_area` in `[body]` and `density` in `[fluid]` |
//! | Re = U L/ν                                           | `reference_length`, and ν of the rows or of `[fluid]`             |
//! | curves                                               | `shape` in `[body]`; [`froude_hydro::drag_curves`]                |
//!
//! Not here: laws that read anything but a motion (links, volts, depths), and the coefficient across the travel of an oblique tow.
//!
//! **Source.** JCGM 100:2008 (GUM), 5.1.2 and G.4.

use std::f64::consts::FRAC_PI_4;

use froude_fit::distribution::coverage_factor;
use froude_hydro::drag_curves::Curve;
use froude_hydro::fluid::Water;
use froude_hydro::similarity;
use froude_records::block::{ResultTable, Section, TableBuilder};
use froude_records::campaign::Campaign;
use froude_records::estimate::{Derived, Estimate, Measured, Range};
use froude_records::number::plain;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};
use froude_records::units::{Dimension, parse_unit};

use crate::dataset::Dataset;
use crate::method::Found;
use crate::predict::{above_first, combined};

/// Name in the records.
const NAME: &str = "C_D";
/// Speeds of a line, and the slowest of them as part of the fastest.
const POINTS: usize = 40;
const SLOWEST: f64 = 0.05;
/// A law whose C_D differs by less over its speeds has one.
const ONE_NUMBER: f64 = 1e-9;
/// How far published curves are drawn beyond the Reynolds numbers of the test.
const BEYOND: f64 = 3.0;
/// Largest angle off the axis at which the frontal area still applies, rad: 8°.
const MOST_OBLIQUE: f64 = 0.14;
/// Two values that are one, but for the text between them.
const SAME: f64 = 1e-9;

/// What C_D refers to: values, the first two with their standard uncertainties.
#[derive(Debug, Clone, Copy)]
struct Reference {
    area: [f64; 2],
    density: [f64; 2],
    length_m: Option<f64>,
    viscosity_m2_s: Option<f64>,
}

/// C_D of a law over its speeds, with its 95 % intervals.
struct Line {
    name: String,
    reference: Reference,
    /// The load, the velocity along its axis, and the load at rest, N.
    axis: (&'static str, &'static str),
    rest_n: f64,
    speed_m_s: Vec<f64>,
    c_d: Vec<f64>,
    standard: Vec<Option<f64>>,
    interval_95: Vec<Option<[f64; 2]>>,
}

/// States C_D in the records that a method found, on its page, and, where the method has a summary of its own, there.
pub fn state(found: &mut Found, campaign: &Campaign) {
    let mut lines = Vec::new();
    let mut points = Vec::new();
    for answer in &mut found.results {
        let rows = answer.fitted().map(|source| source.data.clone());
        let name = answer.name().to_owned();
        let is_one = answer.estimates().len() == 1;
        for estimate in answer.estimates_mut() {
            let Some(mut line) = line(estimate, &name, rows.as_ref(), campaign) else { continue };
            put(estimate, &mut line);
            if is_one || estimate.recommended {
                points.extend(rows.as_ref().and_then(|rows| line.observed(rows)));
                lines.push(line);
            }
        }
    }
    if lines.is_empty() {
        return;
    }
    let mut blocks = vec![chart(&lines, points, campaign).into()];
    let table = table(&lines, campaign).into();
    match &mut found.summary {
        Some(summary) => summary.blocks.push(table),
        None => blocks.insert(0, table),
    }
    found.blocks.push(Section::new("Drag coefficient", blocks));
}

impl Reference {
    fn of(estimate: &Estimate, rows: Option<&Dataset>, campaign: &Campaign) -> Option<Self> {
        let (body, fluid) = (campaign.body.as_ref(), &campaign.fluid);
        let stated = |key: &str| estimate.refers_to.get(key).map(|m| m.value);
        // The uncertainty is that of the campaign's value, and of no other.
        let with = |value: f64, declared: Option<f64>, standard: f64| {
            let is_same = declared.is_some_and(|declared| (value / declared - 1.0).abs() < SAME);
            [value, if is_same { standard } else { 0.0 }]
        };
        let declared = body.and_then(|body| body.reference_area_m2);
        let area = stated("area").or(declared)?;
        let density = stated("density").or(fluid.density_kg_m3)?;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let water = || Water::at(fluid.temperature_degc?, fluid.salinity_g_kg.unwrap_or(0.0)).ok();
        Some(Self {
            area: with(area, declared, body.map_or(0.0, |body| body.reference_area_standard_m2)),
            density: with(density, fluid.density_kg_m3, fluid.density_standard_kg_m3),
            length_m: body.and_then(|body| body.reference_length_m),
            viscosity_m2_s: rows
                .and_then(|rows| rows.values("kinematic_viscosity").map(mean))
                .or(fluid.kinematic_viscosity_m2_s)
                .or_else(|| water().map(|water| water.kinematic_viscosity_m2_s())),
        })
    }

    /// Re at a speed.
    fn reynolds(&self, speed_m_s: f64) -> Option<f64> {
        Some(similarity::reynolds(speed_m_s.abs(), self.length_m?, self.viscosity_m2_s?)).filter(|re| re.is_finite())
    }
}

/// C_D of a law; `None` where it gives none.
fn line(estimate: &Estimate, name: &str, rows: Option<&Dataset>, campaign: &Campaign) -> Option<Line> {
    let reference = Reference::of(estimate, rows, campaign)?;
    let axis = axis(estimate)?;
    let (load, velocity) = axis;
    // What an actuator exerts is no drag.
    if rows.is_some_and(|rows| !rows.is_of_water(load)) {
        return None;
    }
    let range = ahead(estimate, velocity)?;
    // Ahead where it went ahead at all: a law need not be the same astern.
    let [fastest, nearest] = if range.high > 0.0 { [range.high, range.low.max(0.0)] } else { [range.low, range.high] };
    if fastest == 0.0 || !fastest.is_finite() {
        return None;
    }
    let slowest = if nearest.abs() > SLOWEST * fastest.abs() { nearest } else { SLOWEST * fastest };
    let speed_m_s: Vec<f64> =
        (0..POINTS).map(|k| slowest + (fastest - slowest) * k as f64 / (POINTS - 1) as f64).collect();
    let places = places(estimate, velocity, &speed_m_s, &reference)?;
    let (rest_n, forces) = above_first(estimate, &places, load).ok()?;
    let [[area, of_area], [density, of_density]] = [reference.area, reference.density];
    let (mut c_d, mut standard, mut interval_95) = (Vec::new(), Vec::new(), Vec::new());
    for (u, (force, uncertainty)) in speed_m_s.iter().zip(forces.get(1..)?) {
        let scale = -2.0 / (density * u * u.abs() * area);
        let value = scale * force;
        let whole = uncertainty.map(|(of_force, dof)| {
            let exact = |part: f64| ((value * part).abs(), f64::INFINITY);
            combined(&[((scale * of_force).abs(), dof), exact(of_area / area), exact(of_density / density)])
        });
        let half = whole.map(|(u, dof)| coverage_factor(0.95, dof) * u).filter(|half| half.is_finite());
        c_d.push(value);
        standard.push(whole.map(|(u, _)| u));
        interval_95.push(half.map(|half| [value - half, value + half]));
    }
    // A law of the angle alone, or of a thruster at rest, gives no drag along the axis.
    let is_drag = c_d.iter().all(|x| x.is_finite()) && c_d.iter().any(|x| *x != 0.0);
    is_drag.then(|| Line { name: name.to_owned(), reference, axis, rest_n, speed_m_s, c_d, standard, interval_95 })
}

/// Forces with the velocity along the same axis.
const AXES: [(&str, &str); 3] = [("f_x", "v_x"), ("f_y", "v_y"), ("f_z", "v_z")];

/// The force that a law gives along one axis, and the velocity there: along x where it gives several.
fn axis(estimate: &Estimate) -> Option<(&'static str, &'static str)> {
    let given: Vec<_> = AXES.into_iter().filter(|(load, _)| estimate.law.outputs.contains_key(*load)).collect();
    match given[..] {
        [one] => Some(one),
        [first, ..] if first.0 == "f_x" => Some(first),
        _ => None,
    }
}

/// The speeds that the body moved at along an axis; `None` where it only drifted.
fn ahead<'a>(estimate: &'a Estimate, velocity: &str) -> Option<&'a Range> {
    let of = |name: &str| estimate.validity.get(name);
    let is_oblique = of("angle_off_axis").is_some_and(|off| off.low > MOST_OBLIQUE);
    if velocity == "v_x" {
        return of(velocity).or_else(|| of("speed")).filter(|_| !is_oblique);
    }
    // The speed of a body that moves along x too is not that along another axis.
    of(velocity).or_else(|| of("speed").filter(|_| of("angle").is_none() && of("v_x").is_none()))
}

/// Rest, then these speeds along an axis, for everything that the law reads; `None` where it reads what is no motion.
fn places(estimate: &Estimate, velocity: &str, speed_m_s: &[f64], reference: &Reference) -> Option<Dataset> {
    let speed: Vec<f64> = std::iter::once(0.0).chain(speed_m_s.iter().copied()).collect();
    let n = speed.len();
    if ![velocity, "speed"].iter().any(|name| estimate.law.inputs.contains_key(*name)) {
        return None;
    }
    // A speed of a table has a sign where one of its runs went astern.
    let has_sign = estimate.validity.get("speed").is_some_and(|speed| speed.low < 0.0);
    let towed = || speed.iter().map(|u| if has_sign { *u } else { u.abs() }).collect::<Vec<f64>>();
    let mut data = Dataset { rows: n, ..Dataset::default() };
    for (name, unit) in &estimate.law.inputs {
        let is_motion = name.starts_with("v_") || name.starts_with("w_");
        let values = match name.as_str() {
            name if name == velocity => speed.clone(),
            "speed" => towed(),
            "density" => vec![reference.density[0]; n],
            "kinematic_viscosity" => vec![reference.viscosity_m2_s?; n],
            "angle" if velocity == "v_x" => vec![0.0; n],
            _ if is_motion => vec![0.0; n],
            _ => return None,
        };
        let dimension = parse_unit(unit).map_or(Dimension::ONE, |unit| unit.dimension);
        data.put(name, values, dimension);
    }
    for (name, values) in [(velocity, speed.clone()), ("speed", towed())] {
        if data.values(name).is_none() {
            data.put(name, values, Dimension::SPEED);
        }
    }
    Some(data)
}

/// The number in the record, with what it refers to; where a method has stated it, for a force of U², that one is drawn.
fn put(estimate: &mut Estimate, line: &mut Line) {
    if let Some(own) = estimate.derived.get(NAME) {
        line.standard.fill(own.standard_uncertainty);
        line.interval_95.fill(own.interval_95);
        return;
    }
    let (load, velocity) = line.axis;
    let Some((c_d, fastest)) = line.c_d.last().copied().zip(line.speed_m_s.last().copied()) else { return };
    let [[area, _], [density, _]] = [line.reference.area, line.reference.density];
    let is_one_number = line.c_d.iter().all(|x| (x - c_d).abs() <= ONE_NUMBER * c_d.abs());
    // A law of one coefficient says it shorter.
    let is_it = |value: f64| (2.0 * value / (density * area) - c_d).abs() <= ONE_NUMBER * c_d.abs();
    let coefficient = estimate.coefficients.iter().find(|(_, c)| c.unit == "kg/m" && c.value.is_some_and(is_it));
    let formula = match coefficient.filter(|_| is_one_number) {
        Some((name, _)) => format!("2*{name}/(density*area)"),
        None if is_one_number => format!("-2*{load}/(density*area*{velocity}^2)"),
        None => format!(
            "-2*({load} - {load} at rest)/(density*area*{velocity}^2) at {velocity} = {} m/s",
            plain(fastest, 4)
        ),
    };
    let number = Derived {
        standard_uncertainty: line.standard.last().copied().flatten(),
        interval_95: line.interval_95.last().copied().flatten(),
        ..Derived::of(formula, Some(c_d), "1")
    };
    estimate.derived.insert(NAME.to_owned(), number);
    estimate.refers_to.entry("area".to_owned()).or_insert_with(|| Measured::of(area, "m^2"));
    estimate.refers_to.entry("density".to_owned()).or_insert_with(|| Measured::of(density, "kg/m^3"));
}

/// The curves of the declared shape.
fn published(campaign: &Campaign) -> &'static [Curve] {
    campaign.body.as_ref().and_then(|body| body.shape).map_or(&[], |shape| shape.curves())
}

impl Line {
    /// C_D of each row along the axis, the load at rest taken off, over its speed and its Reynolds number.
    fn observed(&self, rows: &Dataset) -> Option<(String, Vec<[f64; 2]>, Vec<f64>)> {
        let (load, velocity) = self.axis;
        let [[area, _], [density, _]] = [self.reference.area, self.reference.density];
        let force = rows.values(load)?;
        let along = rows.values(velocity).or_else(|| rows.values("speed"))?;
        let across = AXES.map(|(_, other)| rows.values(other).filter(|_| other != velocity));
        let off_axis = |i: usize| across.iter().flatten().fold(0.0_f64, |sum, v| sum.hypot(v[i])).atan2(along[i].abs());
        let kept = (0..rows.rows).filter(|i| rows.observes(load, *i) && off_axis(*i) <= MOST_OBLIQUE);
        let of = |i: usize| {
            let u = along[i];
            let c_d = -2.0 * (force[i] - self.rest_n) / (density * u * u.abs() * area);
            ([u.abs(), self.reference.reynolds(u).unwrap_or(f64::NAN)], c_d)
        };
        let (x, y) = kept.map(of).filter(|(_, c_d)| c_d.is_finite()).unzip();
        Some((self.name.clone(), x, y))
    }

    /// Fastest speed.
    fn fastest(&self) -> f64 {
        self.speed_m_s.last().copied().unwrap_or(f64::NAN)
    }

    /// Length over diameter: the diameter of a body of revolution is that of its area.
    fn slenderness(&self) -> f64 {
        let diameter_m = (self.reference.area[0] / FRAC_PI_4).sqrt();
        self.reference.length_m.map_or(1.0, |length_m| length_m / diameter_m)
    }
}

/// The numbers at the fastest speed.
fn table(lines: &[Line], campaign: &Campaign) -> ResultTable {
    let curve = published(campaign).first();
    let re = |line: &Line| line.reference.reynolds(line.fastest());
    let caption = "Drag coefficient of each law at the fastest speed observed; its interval holds if the law is true, and has the declared uncertainty of area and density in it.";
    let t = TableBuilder::new("drag_coefficient", caption, lines);
    let mut columns = vec![
        t.text("source", "source", |line| line.name.clone()),
        t.number("c_d", "C_D [1]", |line| line.c_d.last().copied()).significant(4),
        t.interval("interval_95", "95 % interval", |line| line.interval_95.last().copied().flatten()),
        t.number("speed_m_s", "at speed [m/s]", Line::fastest).significant(4),
        t.number("reynolds", "Re [1]", re).significant(3),
        t.number("area_m2", "area [m²]", |line| line.reference.area[0]).significant(4),
        t.number("density_kg_m3", "density [kg/m³]", |line| line.reference.density[0]).significant(5),
    ];
    if let Some(curve) = curve {
        let at = |line: &Line| re(line).and_then(|re| curve.at(re, line.slenderness()));
        columns.push(t.number("published", &format!("{} [1]", curve.name), at).significant(3));
    }
    t.build(columns)
}

/// Rows, laws and published curves.
fn chart(lines: &[Line], points: Vec<(String, Vec<[f64; 2]>, Vec<f64>)>, campaign: &Campaign) -> Chart {
    let has_reynolds = lines.iter().all(|line| line.reference.reynolds(line.fastest()).is_some());
    let mut series: Vec<Series> = points
        .into_iter()
        .map(|(name, x, y)| {
            let x = x.iter().map(|at| at[usize::from(has_reynolds)]).collect();
            Series { name: format!("{name}, measured"), mark: Mark::Points, x, y, ..Series::default() }
        })
        .collect();
    for line in lines {
        let ends = |k: usize| -> Vec<f64> { line.interval_95.iter().flatten().map(|ends| ends[k]).collect() };
        let has_band = line.interval_95.iter().all(Option::is_some);
        series.push(Series {
            name: line.name.clone(),
            mark: Mark::Line,
            x: line
                .speed_m_s
                .iter()
                .map(|u| line.reference.reynolds(*u).filter(|_| has_reynolds).unwrap_or(u.abs()))
                .collect(),
            y: line.c_d.clone(),
            low: if has_band { ends(0) } else { Vec::new() },
            high: if has_band { ends(1) } else { Vec::new() },
        });
    }
    let span = series.iter().flat_map(|s| s.x.iter().copied().filter(|x| *x > 0.0));
    let [low, high] = span.fold([f64::INFINITY, 0.0_f64], |[low, high], x| [low.min(x), high.max(x)]);
    let slender = lines.first().map_or(1.0, Line::slenderness);
    for curve in published(campaign).iter().filter(|_| has_reynolds) {
        let ends = [curve.reynolds[0].max(low / BEYOND), curve.reynolds[1].min(high * BEYOND)];
        let at = |k: usize| ends[0] * (ends[1] / ends[0]).powf(k as f64 / (POINTS - 1) as f64);
        let drawn = (0..POINTS).map(at).filter_map(|re| Some((re, curve.at(re, slender)?)));
        let (x, y): (Vec<f64>, Vec<f64>) = drawn.filter(|_| ends[1] > ends[0]).unzip();
        if !x.is_empty() {
            series.push(Series { name: curve.name.to_owned(), mark: Mark::Dashed, x, y, ..Series::default() });
        }
    }
    let caption = "Drag coefficient of rows and laws, with the 95 % band of each law; dashed what is published, in the range of its source.";
    Chart {
        name: "drag-coefficient".to_owned(),
        title: "Drag coefficient".to_owned(),
        caption: caption.to_owned(),
        x_label: if has_reynolds { "Re [1]" } else { "speed [m/s]" }.to_owned(),
        x_scale: if has_reynolds { Scale::Logarithmic } else { Scale::Linear },
        panels: vec![ChartPanel { y_label: "C_D [1]".to_owned(), series, ..ChartPanel::default() }],
    }
}
