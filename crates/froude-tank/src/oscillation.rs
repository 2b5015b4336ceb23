//! Forced oscillation: added mass, drag, buoyancy and the delay between motion and force, from runs of a body that a motor swings.
//!
//! The body hangs at a radius r from a pivot and is swung by an angle φ(t) in a stream of speed U, with a load cell between rod and body. The cell
//! shows the force of the rig on the body, across it,
//!
//! f_m = m a − f_A − f_D − B sin φ, f_A = −C_A ρ V v̇_y, f_D = f_D(v_x, v_y; C); in air m a + m g sin φ,
//!
//! and C_A, the drag coefficients, the net buoyancy B of each configuration and the delay of the force behind the angle are fitted together in time
//! ([`crate::driven`]). Velocity and acceleration: [`froude_hydro::swing`]. Drag laws are those of every other test: the simulator, the towing tank and this fit
//! share one expression.
//!
//! **Setting.** One body, rigid rod, water at rest or an even stream; the pivot lies along the stream, or upright ([`Pivot`]).
//! **Frame.** Body axes, x along the stream at rest, y across; φ > 0 moves the body towards +y. Loads of the fluid on the body.
//! **Units.** SI; angles in radians. **Source.** USR eq. 5, 16, 17, 19 (consistent form) and 20; [`computed`] for runs that a computation of the flow gives.
//!
//! Over whole periods drag is orthogonal to acceleration, whatever the law: that two drag laws then give one C_A (USR, Table 13) is an identity and
//! no evidence for either.
//!
//! Not here: moments, two axes at once, the memory of the free surface (C_A is that of the frequencies driven), rods that bend.

pub mod computed;
pub mod drag;
mod keys;

use std::f64::consts::TAU;

use crate::names::FORCED_OSCILLATION;
use froude_hydro::similarity::keulegan_carpenter;
use froude_hydro::sloshing::rectangular_tank_modes_rad_s;
use froude_hydro::swing::{Kinematics, Medium, Pivot};
use froude_identify::declare::Values;
use froude_identify::method::{MethodError, Need};
use froude_records::RecordError;
use froude_records::block::{Digits, ResultColumn, TableBuilder};
use froude_records::estimate::{Law, Measured};
use froude_records::finding::Finding;
use froude_records::run::Role;
use froude_records::table::links_of_configuration;
use froude_records::text::counted;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use self::drag::{Drag, LOAD, drags};
use crate::declared::uncertain;
use crate::driven::fitted::Fitted;
use crate::driven::method::{Declared, MotorDriven};
use crate::driven::setup::Setup;
use crate::driven::source;
use crate::driven::spec::{
    Channel, Coefficient, Condition, Constant, Enters, Factor, Number, Point, Spec, Terms, Unknown,
};
use crate::driven::still_run::Zeroing;
use crate::error::{TankError, undeclared};
use crate::findings::{note, warning};
use crate::joint::findings::are_whole;
use crate::method::TankMethod;
use crate::motion::Motion;
use crate::reference;

pub use keys::{KEYS, PLAN};

/// Name of the added-mass coefficient.
const ADDED: &str = "C_A";
/// A harmonic this near to a natural frequency of the tank makes waves grow, as part of that frequency.
const NEAR: f64 = 0.1;
/// Gravity in the tank, m/s².
const G_M_S2: f64 = 9.80665;

/// Constants, by their place; mass and buoyancy of each body follow.
const RADIUS: usize = 0;
const DENSITY: usize = 1;
const FLOW: usize = 4;
const FIRST_BODY: usize = 6;

/// The joint fit in time.
pub const FORCED: TankMethod = source::method::<Oscillation>(
    &[FORCED_OSCILLATION],
    &["added mass, drag, buoyancy and delay fitted together in time, to runs of a body that a motor swings"],
    &[
        Need::of(&["test"], CHANNELS),
        Need { is_optional: true, ..Need::of(&["dry_air"], CHANNELS) },
        Need { is_optional: true, ..Need::of(&["still"], CHANNELS) },
    ],
    &[FORCED_OSCILLATION, "models", "uncertainty", "plan", "cfd"],
);
const CHANNELS: &[&str] = &["angle", "force"];

/// A configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name; empty where there is one body without a name.
    pub name: String,
    /// k, links of a snake robot between head and tail; `None` for a body that is no `HkLT`.
    pub n_links: Option<f64>,
    /// V: the volume that C_A refers to, m³.
    pub reference_volume_m3: f64,
}

/// The pivot, the bodies, and one drag law.
#[derive(Debug, Clone)]
pub struct Oscillation {
    /// How the pivot lies.
    pub pivot: Pivot,
    /// The configurations.
    pub bodies: Vec<Body>,
    /// The drag law.
    pub drag: Drag,
    link_volume_m3: Option<f64>,
    height_m: Option<f64>,
    viscosity_m2_s: Option<f64>,
}

impl Oscillation {
    /// The place of a body by its configuration.
    fn body(&self, configuration: &str) -> usize {
        self.bodies.iter().position(|body| body.name == configuration).unwrap_or(0)
    }

    /// Place of the mass of a body among the constants.
    fn mass(body: usize) -> usize {
        FIRST_BODY + 2 * body
    }
}

/// `what of body`, and `what` of one without a name.
fn of_body(what: &str, between: &str, body: &str) -> String {
    if body.is_empty() { what.to_owned() } else { format!("{what}{between}{body}") }
}

impl MotorDriven for Oscillation {
    const SPEC: Spec = Spec {
        name: FORCED_OSCILLATION,
        called: "a forced oscillation",
        keys: KEYS,
        missing: "nothing is declared of the body that swings: write [source.forced_oscillation] with pivot, radius and mass",
        plan: PLAN,
        roles: ("medium", &[Role::Test, Role::DryAir, Role::Still]),
        changed: "configuration",
        conditions: &[Condition { name: "flow", dimension: Dimension::SPEED, unit: "m/s", of: stream }],
        motion: Channel {
            name: "angle",
            load: "angle",
            dimension: Dimension::ANGLE,
            unit: "rad",
            shown: "deg",
            digits: Digits::Plain(3),
            along: "the pivot; positive where the body moves towards +y",
            column: ("phi", "sensor", "   # positive towards +y", 8),
            zero: 0.0,
        },
        loads: &[Channel {
            name: "force",
            load: LOAD,
            dimension: Dimension::FORCE,
            unit: "N",
            shown: "N",
            digits: Digits::Plain(3),
            along: "the rig on the body along +y",
            column: ("force", "body", "       # of the rig on the body, along +y", 6),
            zero: 0.2,
        }],
        repeats: "force that the law lacks, a wrong sign, or the other pivot",
        undetermined: "At one frequency added mass and buoyancy are both in phase with the angle: drive at another frequency, or declare the buoyancy. On one configuration the terms of head and \
                       tail are parallel to those of the links",
        unplanned: "the planned runs do not tell its coefficients apart: plan a second frequency, a second configuration for terms of head and tail, or declare the buoyancy",
        found: "added mass, drag and buoyancy",
        law: "",
        only_law: "the only drag law that was asked for",
        added: (ADDED, 1.0),
        ..Spec::GENERAL
    };

    fn check(values: &Values) -> Result<(), RecordError> {
        let pivot = values.need("pivot", values.word("pivot", &Pivot::ALL))?;
        let buoyancy = values.by_configuration("buoyancy");
        if pivot == Pivot::Upright && (buoyancy.all.is_some() || !buoyancy.named.is_empty()) {
            let problem = "stands with an upright pivot, about which it has no part across the body; leave it out, or write pivot = \"stream\"";
            return Err(values.wrong("buoyancy", problem));
        }
        if pivot == Pivot::Upright && values.is_stated("still_runs") {
            let problem = "cannot be used with an upright pivot, about which the net buoyancy has no component across the body: remove it and the still runs, or write pivot = \"stream\"";
            return Err(values.wrong("still_runs", problem));
        }
        Ok(())
    }

    fn check_plan(values: &Values) -> Result<(), RecordError> {
        keys::check_plan(values)
    }

    fn zeroing(values: &Values) -> Result<Option<Zeroing>, RecordError> {
        let Some(stills) = values.table("still_runs") else { return Ok(None) };
        if !stills.need("zeroed", stills.word("zeroed", &[true, false]))? {
            let problem = "removes what the still runs are for, −B sin φ: repeat them with the load cell zeroed once, or leave them out";
            return Err(stills.wrong("zeroed", problem));
        }
        Ok(Some(Zeroing { drift: stills.number("drift").unwrap_or(0.0) }))
    }

    fn read(declared: &Declared<'_>, law: Option<&str>) -> Result<Vec<Self>, MethodError> {
        let Declared { campaign, source, values, configurations } = declared;
        let body = |name: &String| {
            Ok(Body {
                name: name.clone(),
                n_links: links_of_configuration(name).map(f64::from),
                reference_volume_m3: reference::volume_m3(campaign, source, name)?,
            })
        };
        let bodies = configurations.iter().map(body).collect::<Result<Vec<Body>, MethodError>>()?;
        let pivot = values.need("pivot", values.word("pivot", &Pivot::ALL))?;
        let mut asking = (*source).clone();
        if let Some(law) = law {
            asking.models = vec![law.to_owned()];
            asking.model_places.clear();
        }
        let density = reference::density_kg_m3(campaign, source)?;
        let are_links = bodies.iter().all(|body| body.n_links.is_some());
        let of = campaign.body.as_ref();
        let one = |drag: Drag| Self {
            pivot,
            bodies: bodies.clone(),
            drag,
            link_volume_m3: of.and_then(|b| b.link_volume_m3),
            height_m: of.and_then(|b| b.link).map(|link| 2.0 * link.major_semi_axis_m),
            viscosity_m2_s: campaign.fluid.kinematic_viscosity_m2_s,
        };
        Ok(drags(campaign, &asking, density, are_links)?.into_iter().map(one).collect())
    }

    fn constants(&self, declared: &Declared<'_>) -> Result<Vec<Constant>, MethodError> {
        let Declared { campaign, source, values, .. } = declared;
        let radius = values.need("radius", values.constant("radius")).map(uncertain)?;
        let density = reference::density_kg_m3(campaign, source)?;
        let exactly = |value| Some(froude_fit::budget::Uncertain::new(value, 0.0));
        let mut out = vec![
            Constant::new("radius", Some(radius), radius.value.abs(), ""),
            Constant { quantities: &["density"], ..Constant::new("density", exactly(density), density, "") },
            Constant::gain("gain of the angle", Enters::Motion, &["angle"]),
            Constant::gain("gain of the force", Enters::Load(0), &["force", LOAD]),
            Constant::gain("speed of the stream", Enters::Factor, &["flow", "speed"]),
            Constant::delay(values.constant("delay").map(uncertain)),
        ];
        let (masses, buoyancies) = (values.by_configuration("mass"), values.by_configuration("buoyancy"));
        for Body { name, .. } in &self.bodies {
            let unknown =
                |what: &str, unit, role, if_exact| Unknown { name: of_body(what, "_", name), unit, role, if_exact };
            let mass = masses.of(name).ok_or_else(|| {
                let of = of_body("", " of ", name);
                undeclared(&source.place, format!("no mass is declared{of}: write it in [source.forced_oscillation] mass, {name} = {{ value = \"1.63 kg\", standard = \"5 g\" }}"))
            })?;
            let of_this = |constant: Constant| Constant { configuration: Some(name.clone()), ..constant };
            // The force is linear in it.
            let mass = Constant::new(of_body("mass", " of ", name), Some(uncertain(mass)), 1.0, "");
            out.push(of_this(mass.or_found(unknown("m", "kg", Role::DryAir, true))));
            let known = buoyancies.of(name).map(uncertain);
            let buoyancy = Constant::new(of_body("buoyancy", " of ", name), known, 1.0, "").of_role(Role::Test);
            let is_across = self.pivot == Pivot::Stream;
            let found = Some(unknown("B_buoyancy", "N", Role::Test, false)).filter(|_| is_across);
            out.push(of_this(Constant { unknown: found, otherwise: Ok(0.0), ..buoyancy }));
        }
        Ok(out)
    }

    fn coefficients(&self) -> Vec<Coefficient> {
        let one = |name: &str, unit: &str, is_bounded| Coefficient {
            name: name.to_owned(),
            unit: unit.to_owned(),
            is_wanted: true,
            is_bounded,
            varies: is_bounded.then_some(0),
            role: Role::Test,
        };
        let of_drag = self.drag.coefficients().map(|(name, unit)| one(name, unit, true));
        std::iter::once(one(ADDED, "1", false)).chain(of_drag).collect()
    }

    fn law(&self) -> &str {
        &self.drag.law.name
    }

    fn unused(&self) -> Vec<String> {
        self.drag.law.coefficients.iter().map(|c| c.name.clone()).collect()
    }

    fn terms(&self, run: &Point, constants: &[f64], motion: &[[f64; 3]], add: &mut Terms<'_>) -> Result<(), TankError> {
        let place = self.body(&run.configuration);
        let body = &self.bodies[place];
        let medium = if run.role == Role::DryAir { Medium::Air } else { Medium::Water };
        let flow = run.condition("flow") * constants[FLOW];
        let of = |m: &[f64; 3]| Kinematics::of(*m, self.pivot, constants[RADIUS], flow);
        let kinematics: Vec<Kinematics> = motion.iter().map(of).collect();
        let each = |of: &dyn Fn(&Kinematics) -> f64| kinematics.iter().map(of).collect::<Vec<f64>>();
        let mass = Factor::Constant(Self::mass(place));
        if medium == Medium::Air {
            add(0, mass, &each(&|k| k.per_mass(medium)));
            return Ok(());
        }
        let displaced_kg = constants[DENSITY] * body.reference_volume_m3;
        add(0, Factor::Coefficient(0), &each(&|k| displaced_kg * k.sway_rate_m_s2));
        let velocity = [each(&|k| k.velocity_m_s[0]), each(&|k| k.velocity_m_s[1])];
        for (j, column) in self.drag.columns_at(velocity, constants[DENSITY], body.n_links)?.iter().enumerate() {
            add(0, Factor::Coefficient(1 + j), column);
        }
        add(0, mass, &each(&|k| k.per_mass(medium)));
        add(0, Factor::Constant(Self::mass(place) + 1), &each(&|k| -k.upward));
        Ok(())
    }

    fn held(&self) -> String {
        self.pivot.words().to_owned()
    }

    fn mounted<'p>(&self, t: &TableBuilder<'p, &'p Point>) -> Vec<ResultColumn> {
        vec![
            t.text("configuration", "configuration", |point| point.configuration.clone()),
            t.number("flow_m_s", "stream [m/s]", |point| point.condition("flow")).significant(3),
        ]
    }

    fn numbers(&self, _: &Point, setup: &Setup<Self>, amplitude: f64, omega_rad_s: f64) -> Vec<Number> {
        let speed = setup.known("radius").map_or(0.0, |radius| radius.value.abs()) * amplitude * omega_rad_s;
        let period = TAU / omega_rad_s;
        let beta = |height: f64, nu: f64| height * height / (nu * period);
        vec![
            Number {
                column: Some(["speed_m_s", "speed amplitude [m/s]"]),
                validity: Some(["speed", "m/s"]),
                value: Some(speed),
            },
            Number {
                column: Some(["acceleration_m_s2", "acceleration amplitude [m/s²]"]),
                validity: None,
                value: Some(speed * omega_rad_s),
            },
            Number {
                column: Some(["kc", "KC [1]"]),
                validity: Some(["KC", "1"]),
                value: self.height_m.map(|height| keulegan_carpenter(speed, period, height)),
            },
            Number {
                column: None,
                validity: Some(["beta", "1"]),
                value: self.height_m.zip(self.viscosity_m2_s).map(|(height, nu)| beta(height, nu)),
            },
        ]
    }

    /// The load as a formula, where the drag law is one; `volume` is the reference volume of the configuration.
    fn law_of_record(&self, _: &Setup<Self>) -> Law {
        let formula = self.drag.law.texts.get(LOAD).map(|text| format!("{text} - {ADDED}*density*volume*v_y_dot"));
        let channels = self.drag.law.channels().into_iter().chain(["v_y_dot", "density", "volume"]);
        let constants = self
            .bodies
            .iter()
            .map(|body| (of_body("volume", "_", &body.name), Measured::of(body.reference_volume_m3, "m^3")));
        let inputs = channels.map(|name| (name, unit_of(name)));
        let law = Law::of(format!("added_mass_{}", self.law()), inputs).giving(LOAD, "N", formula);
        Law { constants: constants.collect(), ..law }
    }

    fn refers_to(&self, setup: &Setup<Self>, _: &[&Point]) -> IndexMap<String, Measured> {
        let measured = |name: &str, value: f64, unit: &str| (name.to_owned(), Measured::of(value, unit));
        let density = setup.known("density").map(|known| measured("density", known.value, "kg/m^3"));
        let volume = match (self.link_volume_m3, self.bodies.as_slice()) {
            (Some(volume), _) => Some(measured("link_volume", volume, "m^3")),
            (None, [only]) => Some(measured("volume", only.reference_volume_m3, "m^3")),
            _ => None,
        };
        density.into_iter().chain(volume).collect()
    }

    fn about_runs(&self, fitted: &Fitted<'_, Self>) -> Vec<Finding> {
        let all = || fitted.runs.iter().zip(fitted.motions);
        let wet = all().filter(|(run, _)| run.point.role == Role::Test);
        let whole = are_whole(wet.map(|(run, motion)| motion.periods(run.time_s))).then(|| {
            let text = "all runs are used over whole periods: drag is then orthogonal to acceleration whatever its law, so that drag laws agreeing on C_A is no evidence for any of them";
            note("whole-periods", text.to_owned())
        });
        sloshing(fitted).into_iter().chain(whole).collect()
    }
}

/// Motions near a natural frequency of the water across the tank.
fn sloshing(fitted: &Fitted<'_, Oscillation>) -> Option<Finding> {
    let tank = fitted.campaign.tank.as_ref()?;
    let (width, depth) = (tank.width_m?, tank.depth_m?);
    let [mode, _] = rectangular_tank_modes_rad_s(width, width, depth, G_M_S2).ok()?;
    let near = |m: &Motion| (1..=3).any(|k| (f64::from(k) * m.angle.omega_rad_s / mode - 1.0).abs() < NEAR);
    let all = fitted.runs.iter().zip(fitted.motions);
    let found: Vec<&str> = all.filter(|(_, m)| near(m)).map(|(run, _)| run.id).collect();
    (!found.is_empty()).then(|| {
        let text = format!(
            "{} ({}) within 10 % of the water's own {:.2} s across the tank, in its first three harmonics: waves grow and press on the body; drive at another period",
            counted(found.len(), "run swings", "runs swing"),
            found.join(", "),
            TAU / mode
        );
        warning("near-sloshing", text)
    })
}

fn stream(role: Role, flow: Option<f64>) -> Result<f64, String> {
    let what = "the speed of the stream is not declared; write [conditions] flow = \"0.2 m/s\" in its sidecar (\"0 m/s\" in water at rest)";
    flow.or((role != Role::Test).then_some(0.0)).ok_or_else(|| what.to_owned())
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

#[cfg(test)]
mod tests;
