//! Rotation: the fluid torque on a body that a motor turns to and fro about its own centre, in water at rest.
//!
//! A torque cell between shaft and body shows the moment of the rig on the body about the axis, m_m = J θ̈ − m_F + K sin θ, m_F = −λ₁ θ̈ − λ₂ θ̇ − λ₃ θ̇|θ̇|:
//!
//! | run          | moment of the rig on what is mounted, without its zero                                        |
//! |--------------|-----------------------------------------------------------------------------------------------|
//! | body         | J θ̈ + (λ₁ + t₁) θ̈ + (λ₂ + t₂) θ̇ + (λ₃ + t₃) θ̇\|θ̇\| + K sin θ                                  |
//! | body in air  | J θ̈ + K_air sin θ                                                                             |
//! | shaft alone  | J_shaft θ̈ + t₁ θ̈ + t₂ θ̇ + t₃ θ̇\|θ̇\|                                                          |
//!
//! λ₁, λ₂, λ₃ and the delay of the torque behind the angle are fitted together in time ([`crate::driven`]). t₁, t₂, t₃ are fitted if there are runs of the shaft
//! alone, K and K_air only about a level axis, J if there are runs in air.
//!
//! **Setting.** One rigid body, its centre on the axis, water at rest; small corrections of the flow that a body in rotation drags along are left out.
//! **Frame.** The body's z axis lies along the axis of rotation; θ and the moment are positive the same way round. **Units.** SI; angles in radians.
//!
//! **Source.** USR eq. 7 (the fluid's torque); [`mod@derive`] for what follows from the λs.
//!
//! Not here: turning without end (the water turns with the body), a body away from its axis (see [`crate::oscillation`]), a stream, shafts that twist,
//! roll damping of a hull with a free surface.

pub mod derive;
mod keys;

use std::f64::consts::TAU;

use crate::names::ROTATION;
use froude_fit::budget::Uncertain;
use froude_hydro::Link;
use froude_hydro::swing::Pivot;
use froude_identify::declare::Values;
use froude_identify::method::{MethodError, Need};
use froude_records::RecordError;
use froude_records::block::{Block, Digits, ResultColumn, TableBuilder};
use froude_records::campaign::Campaign;
use froude_records::estimate::{Law, Measured, ReferencePoint};
use froude_records::finding::{Finding, Severity};
use froude_records::number::significant;
use froude_records::run::Role;
use froude_records::units::{Dimension, Unit};
use indexmap::IndexMap;

use self::derive::law_behind;
use crate::declared::uncertain;
use crate::driven::derived::Sum;
use crate::driven::fitted::Fitted;
use crate::driven::forecast::Forecast;
use crate::driven::method::{Declared, MotorDriven};
use crate::driven::setup::Setup;
use crate::driven::source;
use crate::driven::spec::{
    Channel, Coefficient, Condition, Constant, Enters, Factor, Number, Point, Spec, Terms, Unknown,
};
use crate::error::{TankError, undeclared};
use crate::findings::warning;
use crate::fluid::density_kg_m3;
use crate::joint::correlation;
use crate::joint::forecast::total;
use crate::method::TankMethod;

pub use derive::LAMBDAS;
pub use keys::{KEYS, PLAN};

/// Names of the shaft's coefficients t₁, t₂, t₃.
pub const TARES: [&str; 3] = ["tare_1", "tare_2", "tare_3"];
/// Their units.
const UNITS: [&str; 3] = ["kg*m^2", "N*m*s", "N*m*s^2"];
/// Name of the law.
const LAW: &str = "fluid_torque";
/// Fastest rate over slowest below which λ₂ and λ₃ are told apart by the third harmonic alone.
const APART: f64 = 1.2;

/// Constants, by their place.
const INERTIA: usize = 0;
const TARE_INERTIA: usize = 1;
const RESTORING: usize = 2;
const RESTORING_IN_AIR: usize = 3;

/// The joint fit in time.
pub const TURNED: TankMethod = source::method::<Rotation>(
    &[ROTATION],
    &[
        "added inertia and damping of a body about its own axis, fitted in time to runs in which a motor turns it to and fro",
    ],
    &[
        Need::of(&["test"], CHANNELS),
        Need { is_optional: true, ..Need::of(&["dry_air"], CHANNELS) },
        Need { is_optional: true, ..Need::of(&["tare"], CHANNELS) },
    ],
    &[ROTATION, "uncertainty", "plan"],
);
const CHANNELS: &[&str] = &["angle", "torque"];

/// The body and its axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// How the axis lies; about an upright one gravity does nothing.
    pub axis: Pivot,
    /// The body, if it is one link, for what is derived.
    pub link: Option<Link>,
    viscosity_m2_s: Option<f64>,
}

impl MotorDriven for Rotation {
    const SPEC: Spec = Spec {
        name: ROTATION,
        called: "a rotation",
        keys: KEYS,
        missing: "nothing is declared of the body that turns: write [source.rotation] with axis and inertia",
        plan: PLAN,
        roles: ("role", &keys::ROLES),
        conditions: &[Condition { name: "flow", dimension: Dimension::SPEED, unit: "m/s", of: at_rest }],
        motion: Channel {
            name: "angle",
            load: "angle",
            dimension: Dimension::ANGLE,
            unit: "rad",
            shown: "deg",
            digits: Digits::Significant(3),
            along: "the body about the axis of rotation",
            column: ("theta", "sensor", "   # positive about the body's z axis", 8),
            zero: 0.0,
        },
        loads: &[Channel {
            name: "torque",
            load: "m_z",
            dimension: Dimension::MOMENT,
            unit: "N m",
            shown: "mN m",
            digits: Digits::Significant(3),
            along: "the rig on the body, about the same axis",
            column: ("torque", "body", "    # of the rig on the body, about the same axis", 8),
            zero: 0.02,
        }],
        guessed: "a wrong guess can make the added inertia wrong by its own size",
        repeats: "torque that λ₁, λ₂ and λ₃ do not hold, a wrong sign, or a body whose centre is off the axis",
        undetermined: "Inertia and added inertia need runs in air or a declared inertia; a restoring moment is in phase with the angle as they are, and needs a second frequency; \
                       λ₂ and λ₃ need a second amplitude",
        unplanned: "the planned runs do not tell lambda_1, lambda_2 and lambda_3 apart; plan a second amplitude or frequency, and runs in water (role = \"test\")",
        found: "λ₁, λ₂, λ₃",
        law: LAW,
        only_law: "the only law of the fluid torque",
        added: (LAMBDAS[0], 1.0),
        ..Spec::GENERAL
    };

    fn check(values: &Values) -> Result<(), RecordError> {
        let axis = values.need("axis", values.word("axis", &Pivot::ALL))?;
        match (axis, values.constant("restoring")) {
            (Pivot::Upright, Some(_)) => {
                let problem = "stands with an upright axis, about which gravity restores nothing; leave it out, or write axis = \"stream\"";
                Err(values.wrong("restoring", problem))
            }
            (Pivot::Stream, None) => Err(values.missing(
                "restoring",
                "about a level axis weight and buoyancy give a moment K sin θ, in phase with the added inertia: declare K, restoring = { value = \"2 mN m\", standard = \
                 \"0.2 mN m\" }, from the torque at rest at two angles; \"0 N m\" where the body is trimmed",
            )),
            _ => Ok(()),
        }
    }

    fn read(declared: &Declared<'_>, _: Option<&str>) -> Result<Vec<Self>, MethodError> {
        let Declared { campaign, values, .. } = declared;
        let axis = values.need("axis", values.word("axis", &Pivot::ALL))?;
        let link = campaign.body.as_ref().and_then(|b| b.link);
        Ok(vec![Self { axis, link, viscosity_m2_s: campaign.fluid.kinematic_viscosity_m2_s }])
    }

    fn constants(&self, declared: &Declared<'_>) -> Result<Vec<Constant>, MethodError> {
        let Declared { campaign, source, values, .. } = declared;
        let of = |key: &str| values.constant(key).map(uncertain);
        let in_air = |name: &str, unit| Unknown { name: name.to_owned(), unit, role: Role::DryAir, if_exact: true };
        let restoring = Unknown { if_exact: false, role: Role::Test, ..in_air("restoring", "N*m") };
        let is_level = self.axis == Pivot::Stream;
        let at_level = |unknown: Unknown| Some(unknown).filter(|_| is_level);
        let density = density_kg_m3(&campaign.fluid).map_err(|what| undeclared(&source.place, what))?;
        Ok(vec![
            Constant { role: None, ..Constant::new("inertia", of("inertia"), 1.0, NO_INERTIA) }
                .or_found(in_air("inertia", UNITS[0])),
            Constant::new("inertia of the shaft", of("tare_inertia"), 1.0, NO_TARE_INERTIA).of_role(Role::Tare),
            Constant {
                unknown: at_level(restoring),
                otherwise: Ok(0.0),
                ..Constant::new("restoring", of("restoring"), 1.0, "")
            },
            Constant {
                unknown: at_level(in_air("restoring_air", "N*m")),
                otherwise: if is_level { Err("") } else { Ok(0.0) },
                ..Constant::new("restoring in air", None, 1.0, "").of_role(Role::DryAir)
            },
            Constant::delay(of("delay")),
            Constant::gain("gain of the angle", Enters::Motion, &["angle"]),
            Constant::gain("gain of the torque", Enters::Load(0), &["torque"]),
            Constant {
                known: density.map(|value| Uncertain::new(value, 0.0)),
                otherwise: Ok(0.0),
                ..Constant::gain("density", Enters::Derived, &["density"])
            },
        ])
    }

    fn coefficients(&self) -> Vec<Coefficient> {
        let of = |names: [&str; 3], role, is_wanted| {
            let one = |(j, (name, unit)): (usize, (&str, &str))| Coefficient {
                name: name.to_owned(),
                unit: unit.to_owned(),
                is_wanted,
                // Damping resists; an added inertia that comes out negative is a finding, not a bound.
                is_bounded: is_wanted && j > 0,
                varies: (is_wanted && j > 0).then_some(0),
                role,
            };
            names.into_iter().zip(UNITS).enumerate().map(one).collect::<Vec<_>>()
        };
        [of(LAMBDAS, Role::Test, true), of(TARES, Role::Tare, false)].concat()
    }

    fn terms(&self, run: &Point, _: &[f64], motion: &[[f64; 3]], add: &mut Terms<'_>) -> Result<(), TankError> {
        let each = |of: fn(&[f64; 3]) -> f64| motion.iter().map(of).collect::<Vec<f64>>();
        let second = each(|m| m[2]);
        let fluid = [second.clone(), each(|m| m[1]), each(|m| m[1] * m[1].abs())];
        let mut put = |factor: Factor, term: &[f64]| add(0, factor, term);
        match run.role {
            Role::DryAir => {
                put(Factor::Constant(INERTIA), &second);
                put(Factor::Constant(RESTORING_IN_AIR), &each(|m| m[0].sin()));
            }
            Role::Tare => {
                put(Factor::Constant(TARE_INERTIA), &second);
                (0..3).for_each(|j| put(Factor::Coefficient(3 + j), &fluid[j]));
            }
            _ => {
                put(Factor::Constant(INERTIA), &second);
                (0..6).for_each(|j| put(Factor::Coefficient(j), &fluid[j % 3]));
                put(Factor::Constant(RESTORING), &each(|m| m[0].sin()));
            }
        }
        Ok(())
    }

    fn held(&self) -> String {
        match self.axis {
            Pivot::Upright => "the axis is upright".to_owned(),
            Pivot::Stream => "the axis lies level, and the restoring moment is taken off".to_owned(),
        }
    }

    fn mounted<'p>(&self, t: &TableBuilder<'p, &'p Point>) -> Vec<ResultColumn> {
        let words = |role: Role| match role {
            Role::DryAir => "body, in air",
            Role::Tare => "shaft alone",
            _ => "body",
        };
        vec![t.text("mounted", "mounted", |point| words(point.role).to_owned())]
    }

    /// KC of the tip is Keulegan and Carpenter's number of the end of the link, u T/D = 2π α l/(2a).
    fn numbers(&self, _: &Point, _: &Setup<Self>, amplitude: f64, omega_rad_s: f64) -> Vec<Number> {
        let height_m = self.link.map(|link| 2.0 * link.major_semi_axis_m);
        let kc = self.link.zip(height_m).map(|(link, height)| TAU * amplitude * link.half_length_m / height);
        let beta = |height: f64, nu: f64| height * height * omega_rad_s / (TAU * nu);
        vec![
            Number {
                column: Some(["rate_rad_s", "rate amplitude [rad/s]"]),
                validity: Some(["speed", "rad/s"]),
                value: Some(amplitude * omega_rad_s),
            },
            Number { column: Some(["tip_kc", "KC of the tip [1]"]), validity: Some(["KC", "1"]), value: kc },
            Number {
                column: None,
                validity: Some(["beta", "1"]),
                value: height_m.zip(self.viscosity_m2_s).map(|(height, nu)| beta(height, nu)),
            },
        ]
    }

    fn sums(&self, setup: &Setup<Self>, _: &[&Point]) -> Vec<Sum> {
        self.link.zip(setup.known("density")).map_or_else(Vec::new, |(link, density)| derive::sums(&link, density))
    }

    fn law_of_record(&self, _: &Setup<Self>) -> Law {
        let unit = |dimension| Unit::si(dimension).text;
        let [l1, l2, l3] = LAMBDAS;
        let formula = Some(format!("-{l1}*w_z_dot - {l2}*w_z - {l3}*w_z*abs(w_z)"));
        let inputs = [("w_z", Dimension::ANGULAR_SPEED), ("w_z_dot", Dimension::ANGULAR_ACCELERATION)];
        let inputs = inputs.map(|(name, dimension)| (name, unit(dimension)));
        Law::of(LAW, inputs).giving("m_z", unit(Dimension::MOMENT), formula)
    }

    fn refers_to(&self, setup: &Setup<Self>, _: &[&Point]) -> IndexMap<String, Measured> {
        let density = setup.known("density").map(|known| ("density", known.value, "kg/m^3"));
        let of_link = self.link.into_iter().flat_map(|link| {
            [
                ("a", link.major_semi_axis_m, "m"),
                ("b", link.minor_semi_axis_m, "m"),
                ("l", link.half_length_m, "m"),
                ("v_ref", derive::V_REF_M_S, "m/s"),
            ]
        });
        let measured = |(name, value, unit): (&str, f64, &str)| (name.to_owned(), Measured::of(value, unit));
        density.into_iter().chain(of_link).map(measured).collect()
    }

    fn reference_point(&self, _: &Campaign) -> ReferencePoint {
        ReferencePoint { words: "the axis that it turned about".to_owned(), stated: false }
    }

    fn about_fit(&self, fitted: &Fitted<'_, Self>) -> Vec<Finding> {
        let in_water = fitted.runs.iter().zip(fitted.motions).filter(|(run, _)| run.point.role == Role::Test);
        let rates = in_water
            .map(|(_, m)| m.angle.amplitude(1) * m.angle.omega_rad_s)
            .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], rate| [low.min(rate), high.max(rate)]);
        let mut out: Vec<Finding> =
            one_rate(rates, together(fitted)).map(|text| warning("not-told-apart", text)).into_iter().collect();
        let is_exact = fitted.setup.constants[INERTIA].known.is_some_and(|known| known.standard == 0.0);
        if fitted.fit.unknown("inertia").is_none() && is_exact {
            let text = "the inertia is declared without a standard uncertainty and counts as exact, and all of its error is lambda_1's: write inertia = { value = …, standard = … }, or turn the body in air";
            out.push(warning("declared-as-exact", text.to_owned()));
        }
        if let Some(found) = law_behind(fitted.derived) {
            let is_open = found.law == derive::Behind::FrictionOrCrossFlow;
            let severity = if is_open { Severity::Note } else { Severity::Warning };
            out.push(Finding::new(severity, "law-behind-lambda-3", found.words()));
        }
        out
    }

    fn notes(&self, fitted: &Fitted<'_, Self>) -> Vec<String> {
        let [_, l2, l3] = LAMBDAS;
        let correlation = together(fitted).map(|r| format!("correlation of {l2} and {l3}: {r:.3}"));
        let law = law_behind(fitted.derived).map(|found| format!("the law behind {l3}: {}", found.words()));
        correlation.into_iter().chain(law).collect()
    }

    fn blocks(&self, fitted: &Fitted<'_, Self>) -> Vec<Block> {
        let said = "C_M is what the printed formula of λ₁ would need: that formula gives kg m⁴, so that its C_M is a number of 1/m² and no coefficient of added mass; C_A is.";
        let of_derived = (!fitted.derived.is_empty()).then(|| said.to_owned());
        let law = law_behind(fitted.derived).map(|found| format!("The law behind λ₃: {}.", found.words()));
        vec![Block::words(of_derived.into_iter().chain(law))]
    }

    fn about_plan(&self, forecast: &Forecast, rates: [f64; 2]) -> Vec<String> {
        let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(i, j)| {
            let r = forecast.correlation(LAMBDAS[i], LAMBDAS[j])?;
            Some(format!("{} with {} {r:.2}", LAMBDAS[i], LAMBDAS[j]))
        });
        let pairs: Vec<String> = pairs.collect();
        let pairs = (!pairs.is_empty()).then(|| format!("Correlations to expect: {}.", pairs.join(", ")));
        let mind = one_rate(rates, forecast.correlation(LAMBDAS[1], LAMBDAS[2])).map(|text| format!("Mind: {text}."));
        pairs.into_iter().chain(mind).collect()
    }
}

const NO_INERTIA: &str = "the inertia of the body is neither declared nor measured, and added inertia cannot be told from it: write [source.rotation] inertia = { value = \
                          \"3.4e-3 kg m^2\", standard = \"1e-5 kg m^2\" }, or turn the body in air (role = \"dry_air\")";
const NO_TARE_INERTIA: &str = "there are runs of the shaft alone (role = \"tare\"), and its own inertia is not declared: write [source.rotation] tare_inertia, of all that moves below the torque \
                               cell without the body";

fn at_rest(_: Role, flow: Option<f64>) -> Result<f64, String> {
    match flow.filter(|flow| *flow != 0.0) {
        None => Ok(0.0),
        Some(flow) => Err(format!(
            "was done in a stream of {flow} m/s, which turns on the body with a moment of its own; these coefficients are of water at rest: repeat it there"
        )),
    }
}

/// Correlation of λ₂ and λ₃ from all errors together.
fn together(fitted: &Fitted<'_, Rotation>) -> Option<f64> {
    let (fit, [_, l2, l3]) = (fitted.fit, LAMBDAS);
    correlation(&total(&fit.parts, fit.unknowns.len()), fit.position(l2)?, fit.position(l3)?)
}

/// Why one amplitude of the rate says little, if there is only one; `correlation` is that of λ₂ and λ₃.
fn one_rate([low, high]: [f64; 2], correlation: Option<f64>) -> Option<String> {
    (high < APART * low).then(|| {
        let with = correlation.map_or_else(String::new, |r| format!(" (correlation {r:.2})"));
        format!(
            "lambda_2 and lambda_3 are separated by the third harmonic alone{with}, a fifth of λ₃'s first: all runs have one amplitude of the rate, {} to {} rad/s. Add runs at half of it, by \
             amplitude or frequency",
            significant(low, 3),
            significant(high, 3)
        )
    })
}
