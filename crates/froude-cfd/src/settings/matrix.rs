//! The run matrix of a campaign as cases: which settings, by which model, and from which case each starts.
//!
//! **Chains.** Cases of one configuration and model lie on a comb. Those head on go from the fastest to the slowest, each from the one before. At every speed the others follow in the order of their angle from head on, each from the one that is nearest in the direction of its flow: where a flow has two steady states, settings equivalent by symmetry then reach the same one. A chain is one job after another, the chains of different combs and of different speeds are independent. Fields are scaled by the ratio of speeds (Reynolds similarity, which holds nearly).
//! **Tanks.** In a tank each angle has a mesh of its own, and its cases go from the fastest to the slowest.
//! **Cold repeats.** Of every `1/cold` cases that start warm one is computed once more from the inflow, under the same name with `-cold`: how far its forces lie from the warm ones' is the hysteresis.
//! **Computed again.** Settings of a study run on the other grids of a family and in other domains, and of the cases of a configuration that a table has, in the order of angles and of speeds within each, some at equal distances run on a finer mesh, the first and the last among them ([`Again`]). All of these start from the inflow. Iterations and window grow with the refinement, as a change of pressure or flux goes a cell an iteration.
//! **Model.** By the Reynolds number of the width, Re = U W/ν: laminar below one bound, with and without a model of turbulence between that and another, as campaigns say (`[source.cfd]`). The two are limits and no interval.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use crate::section::{CfdSpec, FineSpec, StudySpec};
use froude_records::campaign::Source;

use crate::again::Again;
use crate::case::{Case, Flow, Model, Reference, Stop, Water};

/// Turbulence of the inflow: intensity 1 %, ν_t/ν = 1.
pub const SST: Model = Model::Sst { intensity: 0.01, viscosity_ratio: 1.0 };
/// Largest drift of a converged force over a window, of ½ρU²A: head on a slender body has some fortieth of that, of which this is 0.4 %.
const DRIFT: f64 = 1e-4;
/// Largest spread, likewise.
const SPREAD: f64 = 1e-3;
/// Two speeds or angles closer than this part of a step are one.
const SAME: f64 = 1e-9;

/// A configuration with its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Meshed {
    /// `HkLT`, or the name of the body.
    pub configuration: String,
    /// Folder of its mesh under `meshes/`.
    pub mesh: String,
    /// Lengths of the body.
    pub reference: Reference,
    /// Folders of the meshes that settings are computed again on, as [`computed_again`] asks for them.
    pub others: Vec<(Again, String)>,
    /// The only angle that the mesh is for, as in a tank, whose walls lie along the velocity; `None`: all.
    pub angle_rad: Option<f64>,
}

/// A point of the matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    speed_m_s: f64,
    angle_rad: f64,
    pitch_rad: f64,
}

/// All cases of a source for its configurations, in the order in which they may run: each behind the one it starts from.
///
/// # Errors
///
/// A study of settings that the plan does not have, in words.
pub fn cases(source: &Source, spec: &CfdSpec, water: Water, meshed: &[Meshed]) -> Result<Vec<Case>, String> {
    let named = spec.study.iter().flat_map(|study| &study.configurations);
    if let Some(name) = named.into_iter().find(|name| !meshed.iter().any(|body| body.configuration == **name)) {
        return Err(format!(
            "a [[source.cfd.study]] names {name:?}, which the plan does not compute; a study repeats settings of [[source.plan]]"
        ));
    }
    let (mut out, mut again) = (Vec::new(), Vec::new());
    for body in meshed {
        let mut points = points(source, &body.configuration);
        points.retain(|point| body.angle_rad.is_none_or(|angle| (angle - point.angle_rad).abs() <= SAME));
        let from = out.len();
        for is_laminar in [false, true] {
            let of_model = |p: &&Point| {
                models(spec, p.speed_m_s * body.reference.width_m / water.viscosity_m2_s)[usize::from(is_laminar)]
            };
            let chosen: Vec<Point> = points.iter().filter(of_model).copied().collect();
            let comb = Comb { spec, water, body, model: if is_laminar { Model::Laminar } else { SST } };
            out.extend(comb.cases(&chosen));
        }
        again.extend(cases_again(spec, body, &out[from..])?);
    }
    out = with_cold(out, spec.cold);
    out.extend(again);
    Ok(out)
}

/// How settings of a configuration are computed again, each with a mesh of its own.
#[must_use]
pub fn computed_again(spec: &CfdSpec, configuration: &str) -> Vec<Again> {
    let mut out: Vec<Again> = spec.fine.iter().map(|_| Again::Fine).collect();
    for again in spec.study.iter().filter(|study| is_of(study, configuration)).flat_map(of_study) {
        if !out.contains(&again) {
            out.push(again);
        }
    }
    out
}

fn is_of(study: &StudySpec, configuration: &str) -> bool {
    study.configurations.is_empty() || study.configurations.iter().any(|c| c == configuration)
}

fn of_study(study: &StudySpec) -> Vec<Again> {
    // The campaign's own mesh is the second coarsest.
    let finest = study.grids as i32 - 2;
    let levels = (-1..=finest).filter(|level| study.grids > 0 && *level != 0).map(Again::Grid);
    levels.chain(study.radius.iter().map(|radius| Again::Domain(*radius))).collect()
}

/// The cases of a body that repeat some of `own`.
fn cases_again(spec: &CfdSpec, body: &Meshed, own: &[Case]) -> Result<Vec<Case>, String> {
    let is_turbulent = |case: &Case| case.model != Model::Laminar;
    // Of a setting that both models compute the table has the one with turbulence.
    let counts = |case: &&Case| is_turbulent(case) || !own.iter().any(|c| is_turbulent(c) && c.flow == case.flow);
    let counted: Vec<&Case> = own.iter().filter(counts).collect();
    let mut chosen: Vec<(&Case, Again)> = Vec::new();
    if let Some(fine) = spec.fine {
        for model in [true, false] {
            let of_model = counted.iter().copied().filter(|case| is_turbulent(case) == model).collect();
            chosen.extend(spread(of_model, fine).into_iter().map(|case| (case, Again::Fine)));
        }
    }
    for study in spec.study.iter().filter(|study| is_of(study, &body.configuration)) {
        for (speed_m_s, angle_rad, pitch_rad) in settings(study) {
            let is_it = |case: &&&Case| {
                let flow = case.flow;
                is_same(flow.speed_m_s, speed_m_s)
                    && is_same(flow.angle_rad, angle_rad)
                    && is_same(flow.pitch_rad, pitch_rad)
            };
            let Some(case) = counted.iter().find(is_it) else {
                return Err(format!(
                    "a [[source.cfd.study]] has {} at {speed_m_s} m/s and {}°, which the plan does not compute; a study repeats settings of [[source.plan]]",
                    body.configuration,
                    shortest(angle_rad.to_degrees())
                ));
            };
            chosen.extend(of_study(study).into_iter().map(|again| (*case, again)));
        }
    }
    let mesh = |again: Again| body.others.iter().find(|(other, _)| *other == again).map(|(_, mesh)| mesh.clone());
    let mut seen = BTreeSet::new();
    let made = chosen.into_iter().filter_map(|(case, again)| {
        let id = format!("{}-{}", case.id, again.suffix());
        let refinement = match (again, spec.fine) {
            (Again::Fine, Some(fine)) => (fine.mesh.cells() as f64 / spec.mesh.cells() as f64).cbrt(),
            _ => again.refinement(),
        };
        let more = |n: usize| (n as f64 * refinement.max(1.0)).round() as usize;
        let stop = Stop { iterations: more(case.stop.iterations), window: more(case.stop.window), ..case.stop };
        let is_new = seen.insert(id.clone());
        Some(Case { id, mesh: mesh(again)?, start_from: None, stop, ..case.clone() }).filter(|_| is_new)
    });
    Ok(made.collect())
}

/// Some of the cases at equal distances in the order of angles and of speeds within each.
fn spread(mut cases: Vec<&Case>, fine: FineSpec) -> Vec<&Case> {
    cases.sort_by(|a, b| {
        let angles = a.flow.pitch_rad.total_cmp(&b.flow.pitch_rad).then(a.flow.angle_rad.total_cmp(&b.flow.angle_rad));
        angles.then(b.flow.speed_m_s.total_cmp(&a.flow.speed_m_s))
    });
    // Two at least, for a difference between them.
    let count = cases.len().div_ceil(fine.every).max(2).min(cases.len());
    let last = cases.len().saturating_sub(1);
    let places: BTreeSet<usize> = (0..count).map(|k| (k * last + (count - 1) / 2) / (count - 1).max(1)).collect();
    places.into_iter().filter_map(|place| cases.get(place).copied()).collect()
}

fn settings(study: &StudySpec) -> impl Iterator<Item = (f64, f64, f64)> {
    study.speed_m_s.iter().flat_map(|speed| {
        let angles = study.angle_rad.iter();
        angles.flat_map(|angle| study.pitch_rad.iter().map(|pitch| (*speed, *angle, *pitch)))
    })
}

/// The model of a case of a Reynolds number; where both are asked for, that with turbulence.
#[must_use]
pub fn model(spec: &CfdSpec, reynolds: f64) -> Model {
    if models(spec, reynolds)[0] { SST } else { Model::Laminar }
}

/// Whether a case of a Reynolds number is computed with and without a model of turbulence.
fn models(spec: &CfdSpec, reynolds: f64) -> [bool; 2] {
    let is_between = !spec.is_laminar && (spec.laminar_below..spec.both_below).contains(&reynolds);
    let is_laminar = spec.is_laminar || reynolds < spec.laminar_below;
    [!is_laminar, is_laminar || is_between]
}

/// Speeds down, angles up within each; each point once.
fn points(source: &Source, configuration: &str) -> Vec<Point> {
    let of_it = source.plan.iter().filter(|b| b.configurations.iter().any(|c| c == configuration));
    let mut all: Vec<Point> = of_it
        .flat_map(|block| {
            block.speed_m_s.iter().flat_map(move |&speed_m_s| {
                block.angle_rad.iter().flat_map(move |&angle_rad| {
                    block.pitch_rad.iter().map(move |&pitch_rad| ahead(Point { speed_m_s, angle_rad, pitch_rad }))
                })
            })
        })
        .collect();
    all.sort_by(|a, b| {
        let angles = a.pitch_rad.total_cmp(&b.pitch_rad).then(a.angle_rad.total_cmp(&b.angle_rad));
        b.speed_m_s.total_cmp(&a.speed_m_s).then(angles)
    });
    all.dedup_by(|a, b| {
        is_same(a.speed_m_s, b.speed_m_s) && is_same(a.angle_rad, b.angle_rad) && is_same(a.pitch_rad, b.pitch_rad)
    });
    all
}

/// The same velocity with a speed above zero: who goes astern at an angle goes ahead at the one opposite.
fn ahead(point: Point) -> Point {
    if point.speed_m_s >= 0.0 {
        return point;
    }
    let turn = if point.angle_rad > 0.0 { -PI } else { PI };
    Point { speed_m_s: -point.speed_m_s, angle_rad: point.angle_rad + turn, pitch_rad: -point.pitch_rad }
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs()).max(SAME)
}

/// The angle between the velocities of two points.
fn apart_rad(a: Point, b: Point) -> f64 {
    let across = ((a.angle_rad - b.angle_rad) / 2.0).sin().powi(2) * a.pitch_rad.cos() * b.pitch_rad.cos();
    2.0 * (((a.pitch_rad - b.pitch_rad) / 2.0).sin().powi(2) + across).min(1.0).sqrt().asin()
}

/// The cases of a configuration and a model.
struct Comb<'a> {
    spec: &'a CfdSpec,
    water: Water,
    body: &'a Meshed,
    model: Model,
}

impl Comb<'_> {
    fn cases(&self, points: &[Point]) -> Vec<Case> {
        // Where each angle has a mesh of its own, fields go from speed to speed only.
        let root_rad = self.body.angle_rad.unwrap_or(0.0);
        let is_head_on = |p: &&Point| (p.angle_rad - root_rad).abs() <= SAME && p.pitch_rad == 0.0;
        let (head_on, mut others): (Vec<&Point>, Vec<&Point>) = points.iter().partition(is_head_on);
        let mut out = Vec::with_capacity(points.len());
        let mut before: Option<String> = None;
        for point in &head_on {
            let case = self.case(point, before.take());
            before = Some(case.id.clone());
            out.push(case);
        }
        let root = |speed_m_s| Point { speed_m_s, angle_rad: root_rad, pitch_rad: 0.0 };
        let from_root = |p: &Point| apart_rad(*p, root(p.speed_m_s));
        others.sort_by(|a, b| b.speed_m_s.total_cmp(&a.speed_m_s).then(from_root(a).total_cmp(&from_root(b))));
        let mut done = head_on;
        for point in others {
            let at_its_speed = done.iter().copied().filter(|p| p.speed_m_s == point.speed_m_s);
            let nearest = at_its_speed.min_by(|a, b| apart_rad(**a, *point).total_cmp(&apart_rad(**b, *point)));
            out.push(self.case(point, nearest.map(|p| self.id(p))));
            done.push(point);
        }
        out
    }

    fn id(&self, point: &Point) -> String {
        let model = if self.model == Model::Laminar { "-laminar" } else { "" };
        let angle = |letter: &str, rad: f64| format!("-{letter}{}", shortest(rad.to_degrees()));
        let pitch = if point.pitch_rad == 0.0 { String::new() } else { angle("p", point.pitch_rad) };
        let name = if self.body.configuration.is_empty() { "body" } else { &self.body.configuration };
        format!("{name}-u{}{}{pitch}{model}", shortest(point.speed_m_s), angle("a", point.angle_rad))
    }

    fn case(&self, point: &Point, start_from: Option<String>) -> Case {
        let Point { speed_m_s, angle_rad, pitch_rad } = *point;
        Case {
            id: self.id(point),
            configuration: self.body.configuration.clone(),
            mesh: self.body.mesh.clone(),
            is_half: self.spec.is_half,
            flow: Flow { speed_m_s, angle_rad, pitch_rad },
            water: self.water,
            model: self.model,
            stop: Stop { iterations: self.spec.iterations, window: self.spec.window, drift: DRIFT, spread: SPREAD },
            reference: self.body.reference,
            start_from,
        }
    }
}

/// A number with the digits that tell it from its neighbours in a plan: a thousandth of a unit, of smaller numbers four digits.
fn shortest(x: f64) -> String {
    // A ten-millionth is nothing: what conversion leaves of zero degrees.
    let step =
        if x.abs() < 1.0 && x.abs() > 1e-7 { 10_f64.powf(x.abs().log10().floor() - 3.0).min(1e-3) } else { 1e-3 };
    let per = (1.0 / step).round();
    let rounded = (x * per).round() / per;
    // Zero has no sign.
    format!("{}", rounded + 0.0)
}

/// The cases with the repeats of some of them from the inflow.
fn with_cold(cases: Vec<Case>, part: f64) -> Vec<Case> {
    let mut out = Vec::with_capacity(cases.len());
    let mut due = 0.0;
    for case in cases {
        due += if case.start_from.is_some() { part } else { 0.0 };
        let cold = (due >= 1.0).then(|| Case {
            id: format!("{}-{}", case.id, Again::Cold.suffix()),
            start_from: None,
            ..case.clone()
        });
        due -= if cold.is_some() { 1.0 } else { 0.0 };
        out.push(case);
        out.extend(cold);
    }
    out
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use froude_records::campaign_file::parse_campaign;

    use super::*;
    use crate::section::declared;

    const REFERENCE: Reference = Reference { length_m: 0.6, width_m: 0.08, area_m2: 0.05, point_m: [0.0; 3] };
    const WATER: Water = Water { density_kg_m3: 1025.0, viscosity_m2_s: 1.19e-6 };

    fn made(plan: &str, spec: &str) -> Result<Vec<Case>, String> {
        let text = format!(
            "schema = 1\nname = \"a\"\n[[source]]\nname = \"flow\"\nkind = \"cfd\"\ncases = \"cases\"\n[source.cfd]\n{spec}\n{plan}"
        );
        let source = parse_campaign(Path::new("campaign.toml"), &text).unwrap().sources.remove(0);
        let spec = declared(&source).unwrap().unwrap();
        let meshed = ["H1LT", "H2LT"].map(|c| Meshed {
            configuration: c.to_owned(),
            mesh: format!("mesh of {c}"),
            reference: REFERENCE,
            others: computed_again(&spec, c).into_iter().map(|a| (a, format!("{c} {}", a.suffix()))).collect(),
            angle_rad: None,
        });
        cases(&source, &spec, WATER, &meshed)
    }

    fn of(plan: &str, spec: &str) -> Vec<Case> {
        made(plan, spec).unwrap()
    }

    /// Table 2 of the USR paper: 174 settings of each configuration.
    const TABLE_2: &str = "[[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\"]\nspeed = { start = \"0.02 m/s\", stop = \"1 m/s\", step = \"0.02 m/s\" }\n\
         [[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\"]\nspeed = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\", \"0.4 m/s\"]\nangle = { start = \"0 deg\", stop = \"90 deg\", step = \"3 deg\" }\n";

    #[test]
    fn astern_is_ahead_at_the_opposite_angle() {
        for (speed_m_s, angle_rad, pitch_rad) in
            [(-0.3, 0.0, 0.0), (-0.3, 0.7, 0.2), (-0.3, -0.7, -0.2), (0.3, 0.7, 0.2)]
        {
            let flow = |p: &Point| Flow { speed_m_s: p.speed_m_s, angle_rad: p.angle_rad, pitch_rad: p.pitch_rad };
            let point = Point { speed_m_s, angle_rad, pitch_rad };
            let (before, after) = (flow(&point).velocity_m_s(), flow(&ahead(point)));
            assert!(after.speed_m_s > 0.0 && after.angle_rad.abs() <= PI);
            for (a, b) in before.iter().zip(after.velocity_m_s()) {
                assert!((a - b).abs() < 1e-15, "{before:?} {after:?}");
            }
        }
    }

    #[test]
    fn the_matrix_of_the_paper_has_each_setting_once_behind_the_one_it_starts_from() {
        let cases = of(TABLE_2, "cold = 0");
        // 50 speeds ahead and 30 more angles at four of them.
        assert_eq!(cases.len(), 2 * (50 + 4 * 30));
        let mut seen = BTreeSet::new();
        for case in &cases {
            assert!(case.start_from.as_ref().is_none_or(|from| seen.contains(from)), "{case:?}");
            assert!(seen.insert(case.id.clone()), "{} is there twice", case.id);
        }
        assert_eq!(cases.iter().filter(|c| c.start_from.is_none()).count(), 2);
        let at = |id: &str| cases.iter().find(|c| c.id == id).unwrap();
        assert_eq!(at("H2LT-u0.3-a3").start_from.as_deref(), Some("H2LT-u0.3-a0"));
        assert_eq!(at("H2LT-u0.3-a90").start_from.as_deref(), Some("H2LT-u0.3-a87"));
        assert_eq!(at("H2LT-u0.02-a0").start_from.as_deref(), Some("H2LT-u0.04-a0"));
    }

    #[test]
    fn symmetric_settings_start_from_symmetric_cases() {
        let plan = "[[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\"]\nspeed = \"0.4 m/s\"\n\
             angle = [\"-15 deg\", \"-7.5 deg\", \"0 deg\", \"7.5 deg\", \"15 deg\"]\npitch = [\"0 deg\", \"7.5 deg\", \"15 deg\"]\n";
        let cases = of(plan, "cold = 0\ndomain = \"full\"");
        let from = |id: &str| cases.iter().find(|c| c.id == id).and_then(|c| c.start_from.clone());
        for (id, expected) in [
            ("H1LT-u0.4-a7.5", "H1LT-u0.4-a0"),
            ("H1LT-u0.4-a-7.5", "H1LT-u0.4-a0"),
            ("H1LT-u0.4-a0-p7.5", "H1LT-u0.4-a0"),
            ("H1LT-u0.4-a15", "H1LT-u0.4-a7.5"),
            ("H1LT-u0.4-a-15", "H1LT-u0.4-a-7.5"),
            ("H1LT-u0.4-a0-p15", "H1LT-u0.4-a0-p7.5"),
        ] {
            assert_eq!(from(id).as_deref(), Some(expected), "{id}");
        }
    }

    #[test]
    fn a_tenth_is_repeated_from_the_inflow_and_is_the_same_case() {
        let cases = of(TABLE_2, "");
        let cold: Vec<&Case> = cases.iter().filter(|c| c.id.ends_with("-cold")).collect();
        assert_eq!(cold.len(), 33);
        for case in cold {
            let warm = cases.iter().find(|c| format!("{}-cold", c.id) == case.id).unwrap();
            assert_eq!((case.hash(), &case.start_from), (warm.hash(), &None));
        }
    }

    #[test]
    fn where_each_angle_has_a_mesh_fields_go_from_speed_to_speed() {
        let text = format!(
            "schema = 1\nname = \"a\"\n[[source]]\nname = \"flow\"\nkind = \"cfd\"\ncases = \"cases\"\n[source.cfd]\ncold = 0\n{TABLE_2}"
        );
        let source = parse_campaign(Path::new("campaign.toml"), &text).unwrap().sources.remove(0);
        let spec = declared(&source).unwrap().unwrap();
        let meshed = [0.0, 45.0_f64.to_radians()].map(|angle| Meshed {
            configuration: "H1LT".to_owned(),
            mesh: format!("mesh at {angle}"),
            reference: REFERENCE,
            others: Vec::new(),
            angle_rad: Some(angle),
        });
        let cases = cases(&source, &spec, WATER, &meshed).unwrap();
        assert_eq!(cases.len(), 50 + 4);
        let at = |id: &str| cases.iter().find(|c| c.id == id).unwrap();
        assert_eq!(at("H1LT-u0.4-a45").start_from, None);
        assert_eq!(at("H1LT-u0.3-a45").start_from.as_deref(), Some("H1LT-u0.4-a45"));
        assert_eq!(at("H1LT-u0.3-a45").mesh, meshed[1].mesh);
    }

    #[test]
    fn slow_cases_have_names_of_their_own() {
        let plan = "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = [\"0.2 mm/s\", \"0.24 mm/s\", \"0.3 m/s\"]\n";
        let ids: Vec<String> = of(plan, "cold = 0").into_iter().map(|c| c.id).collect();
        assert_eq!(ids, ["H1LT-u0.3-a0", "H1LT-u0.00024-a0", "H1LT-u0.0002-a0"]);
        assert_eq!([1e-12, -1e-9, 0.30000000004, 11.702_059, 0.02].map(shortest), ["0", "0", "0.3", "11.702", "0.02"]);
    }

    /// Re = U W/ν: 2000 at 0.02975 m/s.
    #[test]
    fn slow_cases_are_laminar_and_those_between_are_both() {
        let plan = "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = [\"0.02 m/s\", \"0.1 m/s\", \"0.2 m/s\"]\n";
        let ids = |spec: &str| of(plan, spec).into_iter().map(|c| c.id).collect::<Vec<_>>();
        assert_eq!(
            ids("cold = 0\nlaminar_below = 2000\nboth_below = 10000"),
            ["H1LT-u0.2-a0", "H1LT-u0.1-a0", "H1LT-u0.1-a0-laminar", "H1LT-u0.02-a0-laminar"]
        );
        assert_eq!(ids("cold = 0\nmodel = \"laminar\"").len(), 3);
    }

    #[test]
    fn settings_of_a_study_run_on_other_grids_and_in_other_domains_from_the_inflow() {
        let study = "cold = 0\niterations = 600\nwindow = 60\n[[source.cfd.study]]\nconfigurations = [\"H2LT\"]\nspeed = \"0.3 m/s\"\nangle = [\"0 deg\", \"90 deg\"]\ngrids = 4\nradius = [6]";
        let cases = of(TABLE_2, study);
        let again: Vec<&Case> = cases.iter().filter(|c| Again::of(&c.id).is_some()).collect();
        let ids: Vec<&str> = again.iter().map(|c| c.id.as_str()).collect();
        let of_angle = |a: u32| ["coarser", "finer", "finer2", "r6"].map(|s| format!("H2LT-u0.3-a{a}-{s}"));
        assert_eq!(ids, [of_angle(0), of_angle(90)].concat());
        for case in &again {
            assert_eq!((&case.start_from, case.flow.speed_m_s), (&None, 0.3));
            assert!(case.mesh.starts_with("H2LT "), "{case:?}");
        }
        // Twice as fine, twice as long; none shorter than the campaign's.
        let stops: Vec<[usize; 2]> = again.iter().take(4).map(|c| [c.stop.iterations, c.stop.window]).collect();
        assert_eq!(stops, [[600, 60], [849, 85], [1200, 120], [600, 60]]);
        let refused = made(TABLE_2, &study.replace("0.3 m/s", "0.31 m/s")).unwrap_err();
        assert!(refused.contains("H2LT at 0.31 m/s and 0°, which the plan does not compute"), "{refused}");
    }

    /// Of 170 cases every fifth, from one end of the angles to the other, at each of the four speeds.
    #[test]
    fn fine_cases_are_spread_over_angles_and_speeds() {
        let cases = of(TABLE_2, "cold = 0.1\nfine = { mesh = \"medium\", every = 5 }");
        let fine: Vec<&Case> = cases.iter().filter(|c| matches!(Again::of(&c.id), Some((_, Again::Fine)))).collect();
        assert_eq!(fine.len(), 2 * 34);
        let of_it = || fine.iter().filter(|c| c.configuration == "H1LT").map(|c| c.flow);
        let angles: Vec<f64> = of_it().map(|f| f.angle_rad.to_degrees()).collect();
        assert_eq!((angles[0], *angles.last().unwrap()), (0.0, 90_f64.to_radians().to_degrees()));
        let gaps = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(gaps < 6.1, "{angles:?}");
        for speed in [0.1, 0.2, 0.3, 0.4] {
            let n = of_it().filter(|f| f.angle_rad > 0.0 && (f.speed_m_s - speed).abs() < 1e-9).count();
            assert!(n >= 4, "{speed}: {n}");
        }
        let few = "[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.4 m/s\"\nangle = [\"0 deg\", \"45 deg\", \"90 deg\"]\n";
        let ids: Vec<String> = of(few, "cold = 0\nfine = { mesh = \"medium\" }").into_iter().map(|c| c.id).collect();
        assert_eq!(ids[3..], ["H1LT-u0.4-a0-fine", "H1LT-u0.4-a90-fine"]);
    }
}
