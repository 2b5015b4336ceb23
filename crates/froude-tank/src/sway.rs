//! Pure sway: sway added mass and damping of a body that a planar motion mechanism moves from side to side while it is towed, from side force and yaw moment.
//!
//! A carriage tows the body at a constant speed U, its heading kept, while the mechanism moves it sideways by y(t), one frequency a run: v = ẏ. Load cells show the
//! loads of the rig on the body at the reference point,
//!
//! f_y = (m − Y_v̇) v̇ − Y_v v, m_z = (m x_G − N_v̇) v̇ − N_v v; in air m v̇ and m x_G v̇,
//!
//! and Y_v̇, N_v̇, Y_v, N_v and the delay of the loads behind the motion are fitted together in time ([`crate::driven`]), both loads of all runs at once.
//! [`mod@by_itself`] gives amplitude and phase of the loads of each run.
//!
//! **Setting.** Small motions of a rigid body at one speed, waves of its own making left out. **Frame.** Body axes at the reference point: x forward, y to starboard,
//! z down; moments about z. Y and N are of the water on the body (SNAME), so that Y_v̇ and Y_v are negative. **Units.** SI.
//!
//! **Source.** SNAME (1950), Nomenclature for treating the motion of a submerged body through a fluid; Lewandowski (2004), The Dynamics of Marine Craft.
//!
//! Not here: yaw and combined motion, forces with v|v|, the memory of the free surface (the coefficients are those of the frequencies driven).

pub mod by_itself;
mod keys;

use froude_identify::method::{MethodError, Need};
use froude_records::block::{Block, Digits, ResultColumn, TableBuilder};
use froude_records::estimate::{Law, Measured};
use froude_records::finding::Finding;
use froude_records::run::Role;
use froude_records::units::{Dimension, Unit};
use indexmap::IndexMap;

use self::by_itself::by_itself;
use crate::declared::uncertain;
use crate::driven::derived::Sum;
use crate::driven::fitted::Fitted;
use crate::driven::method::{Declared, MotorDriven};
use crate::driven::setup::Setup;
use crate::driven::source;
use crate::driven::spec::{
    Channel, Coefficient, Condition, Constant, Enters, Factor, Number, Point, Spec, Terms, Unknown,
};
use crate::error::{TankError, undeclared};
use crate::findings::warning;
use crate::fluid::density_kg_m3;
use crate::method::TankMethod;

pub use keys::{KEYS, PLAN};

/// Name of the method, of its section and of its law.
pub const SWAY: &str = "sway";
/// The coefficients and their units.
pub const COEFFICIENTS: [(&str, &str); 4] = [("Y_v_dot", "kg"), ("Y_v", "N*s/m"), ("N_v_dot", "kg*m"), ("N_v", "N*s")];
/// Those whose load may change from run to run.
const VARIES: [&str; 2] = ["Y_v", "N_v"];
/// Speeds that differ by less than this part of the largest are one.
const ONE_SPEED: f64 = 0.02;
/// Constants, by their place.
const MASS: usize = 0;
const X_G: usize = 1;

/// The joint fit in time.
pub const SWAYED: TankMethod = source::method::<Sway>(
    &[SWAY],
    &[
        "sway added mass and damping, of force and yaw moment, fitted in time to runs in which a planar motion mechanism moves a body sideways",
    ],
    &[Need::of(&["test"], CHANNELS), Need { is_optional: true, ..Need::of(&["dry_air"], CHANNELS) }],
    &[SWAY, "uncertainty", "plan"],
);
const CHANNELS: &[&str] = &["sway", "f_y", "m_z"];

/// The body.
#[derive(Debug, Clone, PartialEq)]
pub struct Sway {
    /// L.
    pub length_m: Option<f64>,
}

impl MotorDriven for Sway {
    const SPEC: Spec = Spec {
        name: SWAY,
        called: "a pure sway",
        keys: KEYS,
        missing: "nothing is declared of the body that is moved sideways: write [source.sway] with mass",
        plan: PLAN,
        roles: ("medium", &[Role::Test, Role::DryAir]),
        changed: "speed",
        conditions: &[Condition { name: "speed", dimension: Dimension::SPEED, unit: "m/s", of: forward }],
        motion: Channel {
            name: "sway",
            load: "sway",
            dimension: Dimension::LENGTH,
            unit: "m",
            shown: "mm",
            digits: Digits::Significant(3),
            along: "the body's displacement to starboard",
            column: ("y", "sensor", "      # to starboard", 6),
            zero: 0.0,
        },
        loads: &[
            Channel {
                name: "f_y",
                load: "f_y",
                dimension: Dimension::FORCE,
                unit: "N",
                shown: "N",
                digits: Digits::Significant(3),
                along: "the rig on the body, to starboard",
                column: ("f_y", "body", "        # of the rig on the body, to starboard", 5),
                zero: 0.5,
            },
            Channel {
                name: "m_z",
                load: "m_z",
                dimension: Dimension::MOMENT,
                unit: "N m",
                shown: "N m",
                digits: Digits::Significant(3),
                along: "the rig on the body about its z axis, bow to starboard",
                column: ("m_z", "body", "      # of the rig on the body about z, bow to starboard", 5),
                zero: 0.1,
            },
        ],
        repeats: "a load that is not linear in v, or memory effects of the free surface",
        undetermined: "A delay looks like damping at one frequency, whatever the amplitudes: drive at another frequency, do runs in air, or declare the delay",
        unplanned: "the planned runs do not tell its coefficients and the delay apart; plan another frequency, runs in air, or declare the delay",
        found: "Y_v̇, N_v̇, Y_v, N_v",
        law: SWAY,
        added: (COEFFICIENTS[0].0, -1.0),
        ..Spec::GENERAL
    };

    fn read(declared: &Declared<'_>, _: Option<&str>) -> Result<Vec<Self>, MethodError> {
        Ok(vec![Self { length_m: declared.values.number("length") }])
    }

    fn constants(&self, declared: &Declared<'_>) -> Result<Vec<Constant>, MethodError> {
        let Declared { campaign, source, values, .. } = declared;
        let of = |key: &str| values.constant(key).map(uncertain);
        let found = Unknown { name: "mass".to_owned(), unit: "kg", role: Role::DryAir, if_exact: true };
        let density = density_kg_m3(&campaign.fluid).map_err(|what| undeclared(&source.place, what))?;
        let density = density.map(|value| froude_fit::budget::Uncertain::new(value, 0.0));
        Ok(vec![
            // The loads are linear in both.
            Constant::new("mass", of("mass"), 1.0, "").or_found(found),
            Constant::new("x_g", of("x_g"), 1.0, ""),
            Constant::delay(of("delay")),
            Constant::gain("gain of the sway", Enters::Motion, &["sway"]),
            Constant::gain("gain of f_y", Enters::Load(0), &["f_y"]),
            Constant::gain("gain of m_z", Enters::Load(1), &["m_z"]),
            Constant { known: density, otherwise: Ok(0.0), ..Constant::gain("density", Enters::Derived, &["density"]) },
        ])
    }

    fn coefficients(&self) -> Vec<Coefficient> {
        let one = |(name, unit): (&str, &str)| Coefficient {
            name: name.to_owned(),
            unit: unit.to_owned(),
            is_wanted: true,
            is_bounded: false,
            // Wake and mount change force and moment each for itself.
            varies: VARIES.iter().position(|varies| *varies == name),
            role: Role::Test,
        };
        COEFFICIENTS.map(one).to_vec()
    }

    fn terms(&self, run: &Point, constants: &[f64], motion: &[[f64; 3]], add: &mut Terms<'_>) -> Result<(), TankError> {
        let each = |factor: f64, of: usize| motion.iter().map(|m| factor * m[of]).collect::<Vec<f64>>();
        for (load, arm) in [1.0, constants[X_G]].into_iter().enumerate() {
            add(load, Factor::Constant(MASS), &each(arm, 2));
            if run.role == Role::Test {
                add(load, Factor::Coefficient(2 * load), &each(-1.0, 2));
                add(load, Factor::Coefficient(2 * load + 1), &each(-1.0, 1));
            }
        }
        Ok(())
    }

    fn held(&self) -> String {
        "the rigid body is removed from force and moment".to_owned()
    }

    fn mounted<'p>(&self, t: &TableBuilder<'p, &'p Point>) -> Vec<ResultColumn> {
        let medium = |role| if role == Role::Test { "water" } else { "air" };
        vec![
            t.text("medium", "medium", |point| medium(point.role).to_owned()),
            t.number("speed_m_s", "speed [m/s]", |point| point.condition("speed")).significant(3),
        ]
    }

    /// Y_v and N_v are those of one speed.
    fn check_runs(&self, runs: &[&Point]) -> Result<(), TankError> {
        let speeds = speeds(runs);
        let (low, high) = speeds.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), u| (l.min(*u), h.max(*u)));
        if high - low > ONE_SPEED * high.abs().max(low.abs()) {
            let what = format!(
                "the runs have speeds from {low} to {high} m/s, but Y_v and N_v hold for one speed only: give each speed a folder and a [[source]] of its own"
            );
            return Err(TankError::new(what));
        }
        Ok(())
    }

    fn numbers(&self, run: &Point, _: &Setup<Self>, amplitude: f64, omega_rad_s: f64) -> Vec<Number> {
        let (speed, sway) = (run.condition("speed"), amplitude * omega_rad_s);
        let reduced = self.length_m.filter(|_| speed != 0.0).map(|length| omega_rad_s * length / speed.abs());
        vec![
            Number {
                column: Some(["sway_speed_m_s", "sway speed [m/s]"]),
                validity: Some(["v", "m/s"]),
                value: Some(sway),
            },
            Number {
                column: Some(["drift_rad", "largest drift angle [deg]"]),
                validity: Some(["drift", "rad"]),
                value: (speed != 0.0).then(|| sway.atan2(speed.abs())),
            },
            Number {
                column: Some(["reduced_frequency", "ωL/U [1]"]),
                validity: Some(["reduced_frequency", "1"]),
                value: reduced,
            },
        ]
    }

    /// Nondimensional coefficients: Y_v̇/(½ρL³), Y_v/(½ρL²U), N_v̇/(½ρL⁴), N_v/(½ρL³U).
    fn sums(&self, setup: &Setup<Self>, runs: &[&Point]) -> Vec<Sum> {
        let (Some(length), Some(density)) = (self.length_m, setup.known("density")) else { return Vec::new() };
        let speed = mean_speed(runs);
        let half = 0.5 * density.value;
        let [y_a, y, n_a, n] = COEFFICIENTS.map(|(name, _)| name);
        let l3 = half * length.powi(3);
        let mut all = vec![
            ("Y_v_dot_prime", "Y_v_dot/(0.5*density*length^3)", y_a, l3),
            ("N_v_dot_prime", "N_v_dot/(0.5*density*length^4)", n_a, l3 * length),
        ];
        if speed.abs() > 0.0 {
            let l2 = half * length * length * speed.abs();
            all.push(("Y_v_prime", "Y_v/(0.5*density*length^2*speed)", y, l2));
            all.push(("N_v_prime", "N_v/(0.5*density*length^3*speed)", n, l2 * length));
        }
        let over = Some(("density", density));
        let sum = |(name, formula, of, by)| Sum { name, formula, unit: "1", factors: vec![(of, 1.0 / by)], over };
        all.into_iter().map(sum).collect()
    }

    fn law_of_record(&self, _: &Setup<Self>) -> Law {
        let unit = |dimension| Unit::si(dimension).text;
        let inputs = [("v_y", unit(Dimension::SPEED)), ("v_y_dot", unit(Dimension::ACCELERATION))];
        let formula = |letter: &str| Some(format!("{letter}_v_dot*v_y_dot + {letter}_v*v_y"));
        Law::of(SWAY, inputs).giving("f_y", unit(Dimension::FORCE), formula("Y")).giving(
            "m_z",
            unit(Dimension::MOMENT),
            formula("N"),
        )
    }

    fn refers_to(&self, setup: &Setup<Self>, runs: &[&Point]) -> IndexMap<String, Measured> {
        let speed = Some(("speed", mean_speed(runs), "m/s"));
        let density = setup.known("density").map(|known| ("density", known.value, "kg/m^3"));
        let length = self.length_m.map(|length| ("length", length, "m"));
        let measured = |(name, value, unit): (&str, f64, &str)| (name.to_owned(), Measured::of(value, unit));
        density.into_iter().chain(length).chain(speed).map(measured).collect()
    }

    fn about_fit(&self, fitted: &Fitted<'_, Self>) -> Vec<Finding> {
        let mut out = Vec::new();
        let is_exact = |k: usize| fitted.setup.constants[k].known.is_some_and(|known| known.standard == 0.0);
        let is_found = fitted.fit.unknown("mass").is_some();
        for (k, name, of) in [(MASS, "mass", "Y_v_dot"), (X_G, "x_g", "N_v_dot")] {
            if is_exact(k) && !(k == MASS && is_found) {
                let text = format!(
                    "{name} is declared without a standard uncertainty and counts as exact, and all of its error is {of}'s: write {name} = {{ value = …, standard = … }}"
                );
                out.push(warning("declared-as-exact", text));
            }
        }
        let damping = fitted.fit.unknown("Y_v").and_then(|u| u.value.zip(u.combined));
        if damping.is_some_and(|(value, combined)| combined.interval(value)[0] > 0.0) {
            let text = "Y_v is above zero beyond its interval: the water would drive the motion; check the signs of sway and f_y, and the delay";
            out.push(warning("negative-damping", text.to_owned()));
        }
        out
    }

    /// Amplitude and phase of both loads of each run, and the coefficients that it gives by itself.
    fn blocks(&self, fitted: &Fitted<'_, Self>) -> Vec<Block> {
        let mass = fitted.fit.unknown("mass").and_then(|u| u.value).or(fitted.setup.known("mass").map(|m| m.value));
        let x_g = fitted.setup.known("x_g").map_or(0.0, |x| x.value);
        let rigid = mass.unwrap_or(0.0);
        let of_load = |run, motion, load| by_itself(run, motion, load, fitted.fit.delay_s);
        let in_water = fitted.runs.iter().zip(fitted.motions).filter(|(run, _)| run.point.role == Role::Test);
        let rows: Vec<_> = in_water
            .filter_map(|(run, motion)| Some((run, motion, of_load(run, motion, 0)?, of_load(run, motion, 1)?)))
            .collect();
        let caption = "Each run by itself: amplitude of each load and its phase lead over the sway, at the frequency of the run, and the coefficients that follow with the fitted delay.";
        let t = TableBuilder::new("by_run", caption, &rows);
        vec![
            t.build(vec![
                t.text("run", "run", |(run, ..)| run.id.to_owned()),
                t.number("omega_rad_s", "ω [rad/s]", |(_, motion, ..)| motion.angle.omega_rad_s).plain(4),
                t.number("f_y_n", "f_y [N]", |(.., f, _)| f.amplitude).significant(4),
                t.number("f_y_ahead_rad", "phase [deg]", |(.., f, _)| f.ahead_rad).places(1),
                t.number("m_z_n_m", "m_z [N m]", |(.., m)| m.amplitude).significant(4),
                t.number("m_z_ahead_rad", "phase [deg]", |(.., m)| m.ahead_rad).places(1),
                t.number("Y_v_dot", "Y_v̇ [kg]", |(.., f, _)| rigid - f.of_acceleration).significant(4),
                t.number("Y_v", "Y_v [N s/m]", |(.., f, _)| -f.of_velocity).significant(4),
                t.number("N_v_dot", "N_v̇ [kg m]", |(.., m)| rigid * x_g - m.of_acceleration).significant(4),
                t.number("N_v", "N_v [N s]", |(.., m)| -m.of_velocity).significant(4),
            ])
            .into(),
        ]
    }
}

/// Speeds of the runs in water.
fn speeds(runs: &[&Point]) -> Vec<f64> {
    runs.iter().filter(|run| run.role == Role::Test).map(|run| run.condition("speed")).collect()
}

fn mean_speed(runs: &[&Point]) -> f64 {
    let speeds = speeds(runs);
    speeds.iter().sum::<f64>() / speeds.len() as f64
}

/// The speed of a run; of one in air there is none.
fn forward(role: Role, speed: Option<f64>) -> Result<f64, String> {
    let what = "the carriage speed is not declared; write [conditions] speed = \"1 m/s\" in the sidecar of this log (\"0 m/s\" at standstill)";
    speed.or((role == Role::DryAir).then_some(0.0)).ok_or_else(|| what.to_owned())
}
