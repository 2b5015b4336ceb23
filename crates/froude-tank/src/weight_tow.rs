//! The weight-driven rig: a wagon on a rail, pulled by a hanging weight and filmed, with the body on a load cell below it.
//!
//! The mark's track is turned from pixels into metres by scale and lens; the speed is that of the last part of the way. Where the moving mass is
//! declared, the drag along the rail is what the weight leaves for it less friction and inertia ([`mod@balance`]), if half of the terminal speed is reached;
//! where it is not, the run must be shown to be steady, and the cell gives the drag. Any other run is left out. Each run is a row of a table ([`crate::observed`]).
//!
//! **Setting.** Straight rail, stiff string, friction that does not depend on the speed; drag between linear and quadratic.
//! **Units.** SI, and pixels; angles in radians.
//!
//! | module          | what                                            | source                    |
//! |-----------------|-------------------------------------------------|---------------------------|
//! | [`track`]       | pixels to metres, the moving part, its last part | –                        |
//! | [`mod@balance`] | the drag of a wagon that still accelerates      | USR eq. 16, Newton        |
//! | [`reduce`]      | the observation of a run                        | –                         |
//! | [`rig`]         | the runs that a campaign would give             | –                         |
//!
//! Not here: tracking the mark in the film, distortion across the rail, two clocks (track and loads stand in one log).

pub mod balance;
mod channels;
mod keys;
pub mod page;
pub mod reduce;
pub mod rig;
pub mod track;

use froude_identify::method::MethodError;
use froude_identify::uncertainty::SharedError;
use froude_records::block::{Digits, ResultColumn, Section, TableBuilder};
use froude_records::campaign::SensorSpec;
use froude_records::finding::Finding;
use froude_records::number;
use froude_records::run::Declared as Number;
use froude_records::run::step::Step;
use froude_records::units::Dimension;

use self::channels::{LOADS, MARK, WAYS};
use self::reduce::Found;
use crate::channel::Channel;
use crate::declared::uncertain;
use crate::error::TankError;
use crate::findings::{note, warning};
use crate::log::TankLog;
use crate::logs;
use crate::method::TankMethod;
use crate::names::WEIGHT_TOW;
use crate::observed::linear::variance;
use crate::observed::method::{Declared, Observed};
use crate::observed::reduced::{Planned, Reduced};
use crate::observed::rig::{Loads, Rig, Trace};
use crate::observed::source;
use crate::observed::spec::{ANGLE, Condition, Constant, Moves, Point, Run, Spec, Unstated};
use crate::steady::point::Point as Observation;
use crate::steady::row::Row;

use keys::USUAL_SCALE_M;
pub use keys::{KEYS, PLAN, WeightTow};

/// The last part of the way of a wagon, each run an observation.
pub const PULLED: TankMethod = source::method::<WeightTow>(
    &[WEIGHT_TOW],
    &[
        "runs of a wagon that a hanging weight pulls, filmed: the speed at the end of the way, the drag by load cell or by the equation of motion",
    ],
    source::NEEDS,
    &[WEIGHT_TOW, "models", "uncertainty", "plan", "keep", "group", "tare"],
);

/// What the budget of a balanced run lacks.
const WITHOUT_ANGLE: &str = "an error of the angle also puts the drag of a balanced run along the wrong axis, which moves a load by up to that across the rail times the error (1 % of the \
drag for 0.6 deg where both loads are equal); the budget does not have this, so that intervals at an angle are too short";
/// Residuals of the equation of motion above this many times the errors of the track are not due to the camera.
const MISFIT: f64 = 3.0;
/// Moving mass of a twin whose campaign declares none, kg.
const USUAL_KG: f64 = 4.0;
impl Observed for WeightTow {
    const SPEC: Spec = Spec {
        name: WEIGHT_TOW,
        called: "a weight-driven run",
        keys: KEYS,
        missing: "nothing is declared of wagon and camera: write [source.weight_tow] with scale (the size of a pixel), moving_mass and friction",
        plan: PLAN,
        reads: "time, mark or position, and loads",
        conditions: &[
            Condition {
                name: "weight",
                dimension: Dimension::FORCE,
                column: ["weight_n", "weight [N]"],
                digits: Digits::Significant(3),
                otherwise: Unstated::Refused(
                    "the weight that pulls is not stated; write [conditions] weight = \"0.1 N\" in its sidecar",
                ),
            },
            ANGLE,
        ],
        channels: &[MARK, WAYS[1], WAYS[2], LOADS[0], LOADS[1]],
        senses: &[("mark", false)],
        loads: &["f_x", "f_y"],
        speed_error: "errors of the tracks",
        ..Spec::GENERAL
    };

    type Found = Found;

    fn read(declared: &Declared<'_>) -> Result<Self, MethodError> {
        let has_angle_error = declared.source.uncertainty.iter().any(|entry| entry.quantity == ANGLE.name);
        Ok(Self { has_angle_error, ..Self::of(declared.values)? })
    }

    fn constants(&self) -> Vec<Constant> {
        let one = |name, known: Option<Number>, otherwise| Constant { name, known: known.map(uncertain), otherwise };
        let [scale, mass, friction, _] = reduce::ERRORS;
        vec![
            one(scale, self.scale_m, USUAL_SCALE_M),
            one(mass, self.moving_mass_kg, USUAL_KG),
            one(friction, Some(self.friction_n), 0.0),
        ]
    }

    fn reduce(&self, run: &Run<'_>, _: &[f64]) -> Result<(Observation, Found), TankError> {
        reduce::reduce(run, self)
    }

    fn speed(&self, run: &Point, loads: &Loads<'_>) -> Result<f64, String> {
        rig::terminal_m_s(self, run, loads)
    }

    fn twin(&self, run: &Point, rig: &mut Rig<'_>) -> Trace {
        rig::pulled(self, run, rig)
    }

    fn takes(&self, log: &TankLog) -> Result<Vec<&'static Channel>, String> {
        let has = |name: &str| log.log.channels.contains_key(name);
        let way = WAYS.iter().find(|way| has(way.name)).unwrap_or(&WAYS[2]);
        if way.name == MARK.name && self.scale_m.is_none() {
            return Err(
                "its mark is in pixels, and nothing says how large one is: write scale = { value = \"1.2 mm\", standard = \"1 %\" } in [source.weight_tow]".to_owned(),
            );
        }
        Ok(std::iter::once(way).chain(LOADS.iter().filter(|load| has(load.name))).collect())
    }

    /// Noise and steps of the mark are the errors of the track.
    fn planned(&self, sensors: &[SensorSpec]) -> Self {
        let mark = sensors.iter().find(|s| s.quantity == MARK.name);
        let step = |s: &SensorSpec| s.resolution.unwrap_or(0.0) / 12.0_f64.sqrt();
        let noise_px = mark.map_or(0.0, |s| s.noise.unwrap_or(0.0).hypot(step(s)));
        Self { noise_m: Some(self.pixel_m() * noise_px), ..*self }
    }

    fn speed_standard_m_s(&self, found: &Found) -> f64 {
        found.track.standard_m_s
    }

    /// Of a run that accelerates only what is across the rail comes from the cell.
    fn variance(&self, run: &Reduced<Found>, load: &str, sensors: &[SensorSpec]) -> Option<f64> {
        let (found, step_s) = (&run.found, 1.0 / self.rate_hz);
        let parts_s = [found.track.window.len(), found.track.before.len()].map(|n| n as f64 * step_s);
        let own = |name: &str| variance(sensors, name, parts_s, step_s);
        if found.balance.is_none() {
            return Some(own(load));
        }
        let (sin, cos) = run.point.condition("angle").sin_cos();
        let across = sin * sin * own("f_x") + cos * cos * own("f_y");
        let along = found.drag_standard_n.powi(2);
        let [by_across, by_along] = if load == "f_x" { [sin * sin, cos * cos] } else { [cos * cos, sin * sin] };
        Some(by_across * across + by_along * along)
    }

    fn errors(&self) -> Vec<&'static str> {
        reduce::ERRORS.to_vec()
    }

    fn moves(&self, _: &Run<'_>, _: &Observation, found: &Found) -> Result<Vec<Moves>, TankError> {
        Ok(found.moves.to_vec())
    }

    fn step(&self, log: &TankLog, run: &Reduced<Found>) -> Step {
        let found = &run.found;
        let by = if found.balance.is_some() { "the equation of motion over all that moves" } else { "shown steady" };
        let step = logs::window_step(log, &found.track.window, &format!(", the last part of the way; {by}"));
        step.with("speed", found.track.speed_m_s, "m/s")
    }

    fn about_run(&self, _: &TankLog, _: &Run<'_>, run: &Reduced<Found>) -> Vec<Finding> {
        let (id, found) = (&run.point.id, &run.found);
        let Some(balance) = &found.balance else { return Vec::new() };
        let mut out = Vec::new();
        let pull_n = run.point.condition("weight") - self.friction_n.value;
        let [change, standard] = found.track.change;
        out.extend((change > 2.0 * standard).then(|| {
            note("not-steady",
                format!(
                    "run {id:?}: its speed changes by {:.1} ± {:.1} % over its window, at {:.0} % of its terminal speed: {:.2} of the {:.2} mN that pull are inertia",
                    1e2 * change,
                    1e2 * standard,
                    1e2 * found.track.speed_m_s / balance.terminal_m_s,
                    1e3 * (pull_n - found.drag_n),
                    1e3 * pull_n
                ),
            )
        }));
        if balance.residual_m > MISFIT * found.track.noise_m {
            out.push(warning("track-misfit",
                format!(
                    "run {id:?}: the equation of motion misses the track by {:.2} mm, and the errors of the track are {:.2} mm: check weight, friction and moving_mass, at a string that \
                     stretches, or a push at the start",
                    1e3 * balance.residual_m,
                    1e3 * found.track.noise_m
                ),
            ));
        }
        out
    }

    /// With the angle off by δ the loads err by −L δ along the stated rail, L being the load across it, beside what the law makes of δ.
    fn corrected(
        &self,
        _: &mut [Row],
        _: &[Reduced<Found>],
        _: &str,
    ) -> Result<(Vec<SharedError>, Vec<Finding>), TankError> {
        let is_lacking = self.has_angle_error && self.moving_mass_kg.is_some();
        let lacking = is_lacking.then(|| warning("angle-in-the-balance", WITHOUT_ANGLE.to_owned()));
        Ok((Vec::new(), lacking.into_iter().collect()))
    }

    fn columns<'r>(&self, t: &TableBuilder<'r, Planned<'r, Found>>) -> Vec<ResultColumn> {
        vec![
            t.number("speed_m_s", "speed at the end [m/s]", |row| row.run.found.track.speed_m_s).significant(3),
            t.text("", "fraction of terminal speed", |row| {
                row.run.found.reached().map_or_else(|| "steady".to_owned(), number::percent)
            }),
            t.number("reached", "", |row| row.run.found.reached()),
            t.number("terminal_m_s", "terminal speed [m/s]", |row| row.speed_m_s).significant(3),
            t.number("duration_s", "duration [s]", |row| row.duration_s).places(1),
        ]
    }

    fn about_plan(&self, runs: &[Reduced<Found>]) -> String {
        format!(
            "over {} m of way, waits between them not counted; {} of them do not become steady and are balanced",
            number::plain(self.travel_m, 3),
            runs.iter().filter(|run| run.found.balance.is_some()).count()
        ) + &if self.has_angle_error { format!("; {WITHOUT_ANGLE}") } else { String::new() }
    }

    fn section(&self, runs: &[Reduced<Found>], _: &[Row], logs: &[TankLog]) -> Section {
        page::section(runs, logs, self)
    }
}
