//! Steady towing, and bodies held in a stream: from raw series to one observation per run ([`crate::observed`]).
//!
//! A run is at rest, comes up to speed, stays there, and comes to rest. Its steady window is found by a stated rule ([`mod@window`]), its zero is that of
//! the still parts before and after, drawn as a straight line between them, and its mean counts the correlation of its samples ([`mod@point`]). The motion
//! in water with the body off (role `tare`) is subtracted at the same speed and angle ([`tare`]). The rows go the way of every table: the same laws,
//! budget and choice.
//!
//! **Setting.** Constant speed and attitude, one body; forces in the body's axes.
//! **Units.** SI; angles in radians.
//!
//! | module       | what                                           | source                                    |
//! |--------------|------------------------------------------------|-------------------------------------------|
//! | [`mod@window`]   | the steady window and the still parts          | –                                         |
//! | [`mod@point`] | means and zeros of one run                     | Sokal 1997; ITTC 7.5-02-02-02             |
//! | [`row`]      | observations as the rows of a table            | –                                         |
//! | [`section`]  | what a campaign declares and plans             | –                                         |
//! | [`tare`]     | rig without body, subtracted                   | JCGM 100:2008 (GUM), 5.2                  |
//! | [`walls`]    | blockage and clearance at the angle of a run   | USR eq. 14; ITTC 7.5-02-02-01             |
//!
//! Not here: unsteady motion, waves, moments about another point than the sensor's.

mod channels;
mod findings;
pub mod page;
pub mod point;
pub mod row;
pub mod section;
mod still;
pub mod tare;
pub mod walls;
pub mod window;

use std::cell::RefCell;

use froude_identify::method::{MethodError, Need};
use froude_identify::uncertainty::SharedError;
use froude_records::block::{Digits, ResultColumn, Section, TableBuilder};
use froude_records::campaign::SensorSpec;
use froude_records::finding::Finding;
use froude_records::run::Role;
use froude_records::run::marks::SegmentKind;
use froude_records::run::step::Step;
use froude_records::text::counted;
use froude_records::units::Dimension;
use froude_rig::steady::tow;

use self::channels::{LOADS, WAYS};
use self::row::Row;
use self::section::SteadySpec;
use self::still::Still;
use self::tare::Tare;
use self::window::Motion;
use crate::channel::Channel;
use crate::error::TankError;
use crate::findings::note;
use crate::log::TankLog;
use crate::logs;
use crate::method::TankMethod;
use crate::names::STEADY;
use crate::observed::linear::variance;
use crate::observed::method::{Declared, Observed};
use crate::observed::reduced::{Planned, Reduced};
use crate::observed::rig::{Loads, Rig, Trace};
use crate::observed::source;
use crate::observed::spec::{ANGLE, Condition, Point as Setting, Run as Logged, Spec, Unstated};
use crate::sensors::reading;

pub use point::{Load, Point, Run, point, point_told};
pub use window::{Told, Window, window, window_told};

/// Windows of raw runs as observations.
pub const STEADY_TOW: TankMethod = source::method::<Steady>(
    &[STEADY],
    &["steady windows of raw tows, or of a body held in a stream, each an observation"],
    &[
        Need::of(&["test"], &[]),
        Need { is_optional: true, is_observed: false, ..Need::of(&["tare"], &[]) },
        Need { is_optional: true, is_observed: false, ..Need::of(&["still"], &[]) },
    ],
    &[STEADY, "models", "uncertainty", "plan", "keep", "group", "tare"],
);

/// How steady tows are reduced, with the still runs beside them.
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// What is declared.
    pub spec: SteadySpec,
    stills: Vec<Still>,
}

impl Steady {
    /// A log as it is reduced.
    fn run<'a>(logged: &'a Logged<'a>) -> Run<'a> {
        let of = |name: &str| logged.channel(name);
        let motion = match [of("speed"), of("position"), of("y/position")] {
            [speed @ [_, ..], ..] => Motion::Speed(speed),
            [_, position @ [_, ..], _] | [_, _, position @ [_, ..]] => Motion::Position(position),
            _ => Motion::Stream(logged.point.condition("speed")),
        };
        let is_load = |(name, _): &&(&str, &[f64])| LOADS.iter().any(|load| load.name == *name);
        let loads = logged.channels.iter().filter(is_load).copied().collect();
        Run { id: &logged.point.id, time_s: logged.time_s, motion, loads, zero: None }
    }

    /// Speed of a planned tow, and how long it is driven, s, and how far, m.
    fn driven(&self, run: &Setting) -> [f64; 3] {
        let (tow, speed) = (self.spec.tow, run.condition("speed"));
        let ramp_s = speed.abs() / tow.acceleration_m_s2;
        [speed, 2.0 * (tow.still_s + ramp_s) + tow.steady_s, speed.abs() * (ramp_s + tow.steady_s)]
    }

    /// Lengths of the window and of the part at rest before it, s, of a planned run.
    fn parts_s(&self, run: &Point) -> [f64; 2] {
        [run.window.steady.len(), run.window.before.len()].map(|n| n as f64 / self.spec.tow.rate_hz)
    }
}

impl Observed for Steady {
    const SPEC: Spec = Spec {
        name: STEADY,
        called: "a steady tow",
        roles: &[Role::Test, Role::Tare, Role::Still],
        keys: section::KEYS,
        plan: section::PLAN,
        reads: "time, speed or position, and loads",
        conditions: &[
            Condition {
                name: "speed",
                dimension: Dimension::SPEED,
                column: ["speed_m_s", "speed [m/s]"],
                digits: Digits::Significant(3),
                otherwise: Unstated::Nothing,
            },
            ANGLE,
            Condition {
                name: "at",
                dimension: Dimension::TIME,
                column: ["at_s", "at [s]"],
                digits: Digits::Plain(4),
                otherwise: Unstated::Nothing,
            },
        ],
        channels: &[WAYS[0], WAYS[1], WAYS[2], LOADS[0], LOADS[1], LOADS[2], LOADS[3], LOADS[4], LOADS[5]],
        senses: &[("speed", true)],
        loads: &["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"],
        ..Spec::GENERAL
    };

    type Found = ();

    fn read(declared: &Declared<'_>) -> Result<Self, MethodError> {
        Ok(Self { spec: SteadySpec::of(declared.values)?, stills: Vec::new() })
    }

    fn reduce(&self, logged: &Logged<'_>, _: &[f64]) -> Result<(Point, ()), TankError> {
        let mut run = Self::run(logged);
        if let (Some(at_s), [_, ..]) = (logged.point.conditions.get("at"), self.stills.as_slice()) {
            run.zero = still::zero(*at_s, &run, &self.stills, &self.spec)?;
        }
        Ok((point_told(&run, &self.spec, &logged.told)?, ()))
    }

    fn speed(&self, run: &Setting, _: &Loads<'_>) -> Result<f64, String> {
        Ok(run.condition("speed"))
    }

    fn twin(&self, _: &Setting, rig: &mut Rig<'_>) -> Trace {
        let readings: Vec<_> =
            std::iter::once(reading(rig.sensors, &["speed"], 0.0, rig.stretch)).chain(rig.readings.clone()).collect();
        let last: RefCell<Option<(f64, Vec<f64>)>> = RefCell::new(None);
        let loads = |speed: f64| {
            if let Some((_, loads)) = last.borrow().as_ref().filter(|(at, _)| *at == speed) {
                return loads.clone();
            }
            let loads = rig.loads.at(speed);
            *last.borrow_mut() = Some((speed, loads.clone()));
            loads
        };
        let trace = tow(self.spec.tow, rig.speed_m_s, &readings, &loads, rig.seed);
        let loads = rig.loads.names().iter().cloned().zip(trace.loads_n);
        let columns = std::iter::once(("speed".to_owned(), trace.speed_m_s)).chain(loads).collect();
        Trace { time_s: trace.time_s, columns }
    }

    fn takes(&self, log: &TankLog) -> Result<Vec<&'static Channel>, String> {
        let has = |channel: &&Channel| log.log.channels.contains_key(channel.name);
        let way = WAYS.iter().find(has);
        if way.is_none() && !log.log.meta.conditions.contains_key("speed") {
            return Err(
                "no channel speed or position shows how it moves; for a body held in a stream write [conditions] speed = \"0.2 m/s\" in its sidecar".to_owned(),
            );
        }
        let loads: Vec<&Channel> = LOADS.iter().filter(has).collect();
        if loads.is_empty() {
            let there: Vec<&str> = log.log.channels.keys().map(String::as_str).collect();
            return Err(format!(
                "a run needs a load (f_x, f_y, …, of the water on the body), and has {}",
                there.join(", ")
            ));
        }
        Ok(way.into_iter().chain(loads).collect())
    }

    fn beside(self, logs: &[TankLog]) -> Result<Self, MethodError> {
        Ok(Self { stills: still::stills(logs)?, ..self })
    }

    fn corrected(
        &self,
        rows: &mut [Row],
        others: &[Reduced<()>],
        source: &str,
    ) -> Result<(Vec<SharedError>, Vec<Finding>), TankError> {
        let tare = |run: &Reduced<()>| Tare { angle_rad: run.point.condition("angle"), point: run.observation.clone() };
        let tares: Vec<Tare> = others.iter().map(tare).collect();
        if tares.is_empty() {
            return Ok((Vec::new(), Vec::new()));
        }
        let errors = tare::subtract(rows, &tares, source)?;
        let text = format!(
            "{} subtracted at the same speed and angle; the uncertainty of their mean is shared by all observations there",
            counted(tares.len(), "run without the body is", "runs without the body are")
        );
        Ok((errors, vec![note("tare-subtracted", text)]))
    }

    fn variance(&self, run: &Reduced<()>, load: &str, sensors: &[SensorSpec]) -> Option<f64> {
        Some(variance(sensors, load, self.parts_s(&run.observation), 1.0 / self.spec.tow.rate_hz))
    }

    fn duration_s(&self, run: &Setting, _: f64) -> f64 {
        self.driven(run)[1]
    }

    fn step(&self, log: &TankLog, run: &Reduced<()>) -> Step {
        let window = &run.observation.window;
        let named = log.declared.segments.iter().any(|segment| segment.kind == SegmentKind::Steady);
        let by = if named { "as it is named in [[segments]]" } else { "by the rule of [source.steady]" };
        let words = format!(", {by}; mean tapered at both ends, the zero between the parts at rest taken off");
        let rest = |rows: &std::ops::Range<usize>| rows.len() as f64 * log.steps.median_s;
        let step = logs::window_step(log, &window.steady, &words);
        let step = step.with("at_rest_before", rest(&window.before), "s");
        step.with("at_rest_after", rest(&window.after), "s").with("speed", run.observation.speed_m_s, "m/s")
    }

    fn about_run(&self, log: &TankLog, run: &Logged<'_>, found: &Reduced<()>) -> Vec<Finding> {
        let own = Self::run(run);
        let named = findings::of_named_window(log, &own, &found.observation, &self.spec);
        findings::of_point(own.id, &found.observation).into_iter().chain(named).collect()
    }

    fn columns<'r>(&self, t: &TableBuilder<'r, Planned<'r, ()>>) -> Vec<ResultColumn> {
        let window_s = |row: &Planned<'r, ()>| self.parts_s(&row.run.observation)[0];
        vec![
            t.number("duration_s", "duration [s]", |row| row.duration_s).places(1),
            t.number("travel_m", "travel [m]", |row| self.driven(&row.run.point)[2]).places(2),
            t.number("window_s", "steady window [s]", window_s).places(1),
            t.number("steady_distance_m", "steady distance [m]", |row| window_s(row) * row.speed_m_s.abs()).places(2),
        ]
    }

    fn about_plan(&self, runs: &[Reduced<()>]) -> String {
        let steady_m = |run: &Reduced<()>| self.parts_s(&run.observation)[0] * self.driven(&run.point)[0].abs();
        format!(
            "waits between them and the way back not counted; {:.1} m of steady distance; the longest needs {:.2} m of travel",
            runs.iter().map(steady_m).sum::<f64>(),
            runs.iter().map(|run| self.driven(&run.point)[2]).fold(0.0, f64::max)
        )
    }

    fn section(&self, _: &[Reduced<()>], rows: &[Row], logs: &[TankLog]) -> Section {
        page::section(logs, rows, &self.spec)
    }
}
