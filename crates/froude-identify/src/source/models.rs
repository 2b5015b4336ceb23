//! The laws that a source asks for, as its observations allow them.

use std::collections::BTreeSet;

use froude_hydro::{Body, CrossTerm, DragModel};
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Source};
use froude_records::nearest::meant;
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::law::terms::{LAWS, NamedLaw, THRUSTER};
use crate::lint::motion::moving;
use crate::named;
use crate::source::constants::{constants, with_undeclared};
use crate::validity::{AT_REST, off_axis};

/// Built-in models that need no body.
pub(crate) const PLAIN_MODELS: [&str; 5] = ["quadratic", "linear_quadratic", "power_law", "power_law_log", "strut"];

/// Those that are fitted where none is asked for.
pub(crate) const DEFAULT_MODELS: [&str; 3] = ["quadratic", "linear_quadratic", "power_law"];

/// The models that are fitted to a source: its own, else those of `[identify]`, else the defaults.
///
/// # Errors
///
/// A name that nothing answers to, with its place and the nearest known one.
pub fn asked_models(campaign: &Campaign, source: &Source) -> Result<Vec<String>, IdentifyError> {
    let identify = &campaign.identify;
    let user: Vec<&str> = identify.user_models.iter().map(|m| m.name.as_str()).collect();
    let (named, places) = if source.models.is_empty() {
        (&identify.models, &identify.model_places)
    } else {
        (&source.models, &source.model_places)
    };
    let built_in = || PLAIN_MODELS.into_iter().chain(LAWS.iter().map(|law| law.name));
    let is_known =
        |name: &str| DragModel::from_name(name).is_some() || built_in().any(|own| own == name) || user.contains(&name);
    if let Some((i, unknown)) = named.iter().enumerate().find(|(_, name)| !is_known(name)) {
        let known = DragModel::ALL.iter().map(|m| m.name()).chain(built_in()).chain(user.iter().copied());
        let advice = meant(unknown, known).unwrap_or_else(|| {
            let own = if user.is_empty() { "none here".to_owned() } else { user.join(", ") };
            format!(
                "built in are f1 to f6, {}; [[identify.model]] adds its own: {own}",
                built_in().collect::<Vec<_>>().join(", ")
            )
        });
        let place = places.get(i).map_or_else(String::new, |place| format!("{place}: "));
        return Err(IdentifyError::Refused(format!("{place}model {unknown:?} is not known; {advice}")));
    }
    let mut asked = if !source.models.is_empty() {
        source.models.clone()
    } else if !identify.models.is_empty() || !user.is_empty() {
        identify.models.iter().cloned().chain(user.iter().map(|name| (*name).to_owned())).collect()
    } else {
        DEFAULT_MODELS.map(str::to_owned).to_vec()
    };
    // A person may name a law of their own in the list too.
    let mut seen = BTreeSet::new();
    asked.retain(|name| seen.insert(name.clone()));
    Ok(asked)
}

/// Every quantity of the budget must be a channel of the data.
///
/// # Errors
///
/// The first that is not, with its place, the channels that there are and the likely one.
pub fn check_budget(source: &Source, data: &Dataset) -> Result<(), IdentifyError> {
    let Some(entry) = source.uncertainty.iter().find(|e| data.values(data.meant(&e.quantity)).is_none()) else {
        return Ok(());
    };
    let known: Vec<&str> = data.channels.keys().map(String::as_str).collect();
    // Where no name is near, the channels of the same kind are what may have been meant.
    let alike = || {
        let is_alike = |name: &&str| !entry.relative && data.dimension(name) == Some(entry.dimension);
        let alike: Vec<&str> = known.iter().copied().filter(is_alike).collect();
        if alike.is_empty() {
            String::new()
        } else {
            format!("; of {} it has {}", entry.dimension.describe(), alike.join(", "))
        }
    };
    let advice = meant(&entry.quantity, known.iter().copied()).map_or_else(alike, |meant| format!("; {meant}"));
    Err(IdentifyError::Record(RecordError::Value {
        place: entry.place.clone(),
        key: "quantity".to_owned(),
        problem: format!(
            "is {:?}, which {} does not have; it has {}{advice}",
            entry.quantity,
            source.input.path().display(),
            known.join(", ")
        ),
    }))
}

/// The laws that the campaign asks for, over the channels of the table.
///
/// # Errors
///
/// An unknown name, a drag model without a body, a formula that cannot be used.
pub fn laws(campaign: &Campaign, source: &Source, data: &Dataset) -> Result<Vec<ForceLaw>, IdentifyError> {
    let identify = &campaign.identify;
    let nobody_asked = source.models.is_empty() && identify.models.is_empty();
    let mut asked = asked_models(campaign, source)?;
    if nobody_asked && identify.user_models.is_empty() && named::is_thruster(data) {
        asked = vec![THRUSTER.to_owned()];
    }
    let mut out = Vec::new();
    for name in &asked {
        if let Some(model) = DragModel::from_name(name) {
            moving_axes(data, source)?;
            out.push(ForceLaw::drag(model, body(campaign, data, name)?, CrossTerm::AsPrinted));
        } else if let Some(user) = identify.user_models.iter().find(|m| &m.name == name) {
            let known = constants(campaign, data)?;
            let law = ForceLaw::with_constants(name, &user.formulas, data, &known);
            out.push(law.map_err(|error| with_undeclared(error, &user.formulas, &known, data))?);
        } else if let Some(named) = NamedLaw::of_name(name) {
            out.push(named.law(data, &constants(campaign, data)?)?);
        } else {
            match name.as_str() {
                "quadratic" => out.push(polynomial(name, data, source, false)?),
                "linear_quadratic" => out.push(polynomial(name, data, source, true)?),
                "strut" => out.push(strut(data, source)?),
                // A moment over drift has no power law; where nobody asked for one, it gets the others.
                "power_law" if nobody_asked && axes(data).is_empty() && !moments(data).is_empty() => {}
                "power_law" | "power_law_log" => {
                    out.extend(power_laws(name, &moving_axes(data, source)?));
                }
                _ => {}
            }
        }
    }
    Ok(out)
}

/// A power law of each load, called after it where there are several.
pub(crate) fn power_laws(name: &str, axes: &[(&str, &str)]) -> impl Iterator<Item = ForceLaw> {
    axes.iter().map(move |(load, channel)| {
        let mut law = ForceLaw::power_law(load, channel, name == "power_law_log");
        if axes.len() > 1 {
            law.name = format!("{name}_{}", load.replace("f_", "").replace("m_", "r"));
        }
        law
    })
}

/// Loads with the velocity along or about the same axis.
pub(crate) const PAIRS: [(&str, &str); 6] =
    [("f_x", "v_x"), ("f_y", "v_y"), ("f_z", "v_z"), ("m_x", "w_x"), ("m_y", "w_y"), ("m_z", "w_z")];

/// Moments of a body that moves askew: the moment, the velocity along the body and the one across it, and the moment's letter.
pub(crate) const MOMENTS: [(&str, &str, &str, &str); 2] = [("m_z", "v_x", "v_y", "N"), ("m_y", "v_x", "v_z", "M")];

/// Whether there is motion along or about an axis in some row; cos 90° is 6e-17, which is none.
pub(crate) fn moves(data: &Dataset, channel: &str) -> bool {
    let largest = data.values("speed").map_or(0.0, |u| u.iter().fold(0.0_f64, |m, u| m.max(u.abs())));
    let least = if channel.starts_with("v_") { 1e-9 * largest } else { 0.0 };
    data.values(channel).is_some_and(|v| v.iter().any(|x| x.abs() > least))
}

/// Loads of the table with the velocity along or about the same axis, where there is motion.
pub(crate) fn axes(data: &Dataset) -> Vec<(&'static str, &'static str)> {
    let is_water = |load: &str| data.channels.contains_key(load) && data.is_of_water(load);
    PAIRS.into_iter().filter(|(load, motion)| is_water(load) && moves(data, motion)).collect()
}

/// The same; at least one.
pub(crate) fn moving_axes(data: &Dataset, source: &Source) -> Result<Vec<(&'static str, &'static str)>, IdentifyError> {
    let out = axes(data);
    if out.is_empty() {
        let moving: Vec<&str> = PAIRS.into_iter().map(|(_, motion)| motion).filter(|m| moves(data, m)).collect();
        return Err(no_load(data, source, &moving));
    }
    Ok(out)
}

/// Moments of the table that motion across the body makes.
pub(crate) fn moments(data: &Dataset) -> Vec<(&'static str, &'static str, &'static str, &'static str)> {
    MOMENTS
        .into_iter()
        .filter(|(moment, _, across, _)| data.channels.contains_key(*moment) && moves(data, across))
        .collect()
}

/// What keeps a table from being fitted: no load, no motion, or loads across every motion.
pub(crate) fn no_load(data: &Dataset, source: &Source, moving: &[&str]) -> IdentifyError {
    let loads = data.loads();
    let has_motion =
        ["speed", "v_x", "v_y", "v_z", "w_x", "w_y", "w_z"].iter().any(|name| data.channels.contains_key(*name));
    let own = loads.iter().find(|load| !data.is_of_water(load));
    let own = own.copied().or_else(|| ["thrust", "torque"].into_iter().find(|load| data.values(load).is_some()));
    let lacks = if let Some(load) = own.filter(|_| loads.iter().all(|load| !data.is_of_water(load))) {
        let of_log = if data.channels.contains_key("time") && data.values("v_x_dot").is_none() && has_motion {
            "method = \"servo\" with friction = \"viscous\" and loads = [\"D_II*speed*abs(speed)\"] (froude new servo) gives mass with added mass, drag and the lag of the \
             speed from such a log; or "
        } else {
            ""
        };
        format!(
            "{load} is exerted by an actuator, and the built-in laws describe water loads: {of_log}write a law of your own ([[identify.model]], {load} = \"…\"), or \
             models = [\"{THRUSTER}\"] where the table has the command, in V or rpm"
        )
    } else if loads.is_empty() {
        let servo = if data.channels.contains_key("time") {
            ". A sidecar that names time, position and command makes it the log of a servo"
        } else {
            ""
        };
        format!(
            "a load is missing: a force f_x, f_y, f_z [N] or a moment m_x, m_y, m_z [N m]; name its column so, or map it with a \
             sidecar{servo}"
        )
    } else if !has_motion {
        format!(
            "the motion is missing for {}: speed [m/s] (with angle [deg]), or v_x, v_y, v_z [m/s], w_x, w_y, w_z [rad/s]; \
             name its column so, or map it with a sidecar",
            loads.join(", ")
        )
    } else if moving.is_empty() {
        "nothing moves: every speed is zero".to_owned()
    } else {
        format!(
            "the motion is along {}, the load is {}: a load is fitted to the motion along or about its own axis",
            moving.join(", "),
            loads.join(", ")
        )
    };
    let (path, columns) = (source.input.path().display(), data.headers.join(", "));
    IdentifyError::Refused(format!("{path}: no load to fit: {lacks}; the table has {columns}"))
}

/// f = −D_I·v − D_II·v|v| per axis, or the quadratic term alone; of motion across the body with lift, Y_uv·v_x·v_y, and with the moments
/// m_z = N_v·v_y + N_uv·v_x·v_y + N_vv·v_y|v_y|, the first again only in the linear law.
///
/// Y_uv holds the lift, N_uv the moment of an ideal fluid (Munk) and what lift takes off it, D_y_II and N_vv cross-flow. At one magnitude of
/// drift u·v and v|v| have the same shape: Y_uv and N_uv stand for the sum, and the others are left out. At one speed of the rows with drift they also include the linear term, which is then left out.
///
/// Range: lift is of motion ahead. Astern Y_uv·v_x·v_y has the sign of v_y, and would push the body: a body alike at both ends has |v_x|·v_y, another one a coefficient of its own for each way.
///
/// # Source
///
/// SNAME (1952), Technical and Research Bulletin 1-5 (symbols); Clarke, Gedling & Hine (1983), Trans. RINA 125, 45 (linear terms of a hull grow with U).
pub(crate) fn polynomial(name: &str, data: &Dataset, source: &Source, linear: bool) -> Result<ForceLaw, IdentifyError> {
    let askew = moments(data);
    let axes = if askew.is_empty() { moving_axes(data, source)? } else { axes(data) };
    let mut texts: IndexMap<String, String> = IndexMap::new();
    for (load, v) in axes {
        let axis = load.replace("f_", "").replace("m_", "r");
        let drift = LIFTS
            .iter()
            .find(|(of, ..)| *of == load)
            .map(|(_, across, letter)| (Drift::of(data, "v_x", across), *letter));
        let has_lift = drift.as_ref().is_some_and(|(drift, _)| drift.is_askew);
        let mut text = String::new();
        if linear && !(has_lift && drift.as_ref().is_some_and(|(drift, _)| drift.is_of_one_speed)) {
            text += &format!("-D_{axis}_I*{v} ");
        }
        if !(has_lift && drift.as_ref().is_some_and(|(drift, _)| drift.is_at_one_angle)) {
            text += &format!("-D_{axis}_II*{v}*abs({v}) ");
        }
        if let Some((_, letter)) = drift.filter(|_| has_lift) {
            text += &format!("+ {letter}_u{}*v_x*{v}", sname(v));
        }
        texts.insert(load.to_owned(), text.trim().trim_start_matches("+ ").to_owned());
    }
    for (moment, along, across, letter) in askew {
        let (u, v) = (sname(along), sname(across));
        let drift = Drift::of(data, along, across);
        let mut terms = Vec::new();
        if linear && !(drift.is_askew && drift.is_of_one_speed) {
            terms.push(format!("{letter}_{v}*{across}"));
        }
        let moves_along = moves(data, along);
        if moves_along {
            terms.push(format!("{letter}_{u}{v}*{along}*{across}"));
        }
        if !moves_along || !drift.is_at_one_angle {
            terms.push(format!("{letter}_{v}{v}*{across}*abs({across})"));
        }
        let text = terms.join(" + ");
        texts.entry(moment.to_owned()).and_modify(|about| *about = format!("{about} + {text}")).or_insert(text);
    }
    ForceLaw::formulas(name, &texts, data)
}

/// Loads across a body that moves askew: the load, the velocity along it, and its letter.
const LIFTS: [(&str, &str, &str); 2] = [("f_y", "v_y", "Y"), ("f_z", "v_z", "Z")];

/// A velocity as SNAME writes it.
fn sname(channel: &str) -> &'static str {
    match channel {
        "v_x" => "u",
        "v_y" => "v",
        _ => "w",
    }
}

/// Relative spread of speed below which rows with drift count as one speed.
const ONE_SPEED: f64 = 0.02;

/// What the rows with drift can tell apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drift {
    /// Whether there are any.
    pub(crate) is_askew: bool,
    /// Whether all have one magnitude of the angle.
    pub(crate) is_at_one_angle: bool,
    /// Whether all have one speed.
    pub(crate) is_of_one_speed: bool,
}

impl Drift {
    /// Of a velocity along the body and one across it.
    pub(crate) fn of(data: &Dataset, along: &str, across_name: &str) -> Self {
        let (Some(u), Some(v)) = (data.values(along), data.values(across_name)) else {
            return Self { is_askew: false, is_at_one_angle: true, is_of_one_speed: true };
        };
        let largest = u.iter().zip(v).map(|(u, v)| u.hypot(*v)).fold(0.0, f64::max);
        let is_there = |x: &f64| x.abs() > 1e-9 * largest;
        let is_askew = u.iter().zip(v).any(|(u, v)| is_there(u) && is_there(v));
        // Ahead, astern and straight across the sign of u v and v differ.
        let across = u.iter().zip(v).filter(|(_, v)| is_there(v));
        let of_sign = across.clone().map(|(u, _)| if is_there(u) { u.signum() } else { 0.0 });
        let is_one_way = of_sign.clone().all(|sign| Some(sign) == of_sign.clone().next());
        let speeds = across.map(|(u, v)| u.hypot(*v));
        let (low, high) = speeds.fold((f64::INFINITY, 0.0_f64), |(low, high), speed| (low.min(speed), high.max(speed)));
        Self {
            is_askew,
            is_at_one_angle: !has_two_angles(data, along, across_name),
            is_of_one_speed: is_one_way && high - low <= ONE_SPEED * high,
        }
    }
}

/// Whether the rows that move askew do so at two angles to the axis at least; ahead and astern are two.
pub(crate) fn has_two_angles(data: &Dataset, along: &str, across: &str) -> bool {
    let (Some(u), Some(v)) = (data.values(along), data.values(across)) else { return false };
    let largest = u.iter().zip(v).map(|(u, v)| u.hypot(*v)).fold(0.0, f64::max);
    let askew = u.iter().zip(v).filter(|(_, v)| v.abs() > 1e-9 * largest);
    are_apart(askew.map(|(u, v)| v.abs().atan2(*u)))
}

/// Whether angles differ by 1° at least, rad.
pub(crate) fn are_apart(angles: impl Iterator<Item = f64>) -> bool {
    let (low, high) =
        angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| (low.min(angle), high.max(angle)));
    high - low > std::f64::consts::PI / 180.0
}

/// What a strut that turns with the body carries, f_x = −D_xU·v_x·U + X_vv·v_y²·sign(v_x), f_y = −D_yU·v_y·U − X_vv·|v_x|·v_y, m_z = N_vU·v_y·U.
///
/// Exact for a round one (D_xU = D_yU, X_vv = 0) and for a section up to its stall, whose lift of slope X_vv stands across the flow beside a
/// drag D_xU = D_yU along it. Where X_vv is not determined, D_yU holds the lift too, and is right at the angles of the test only. U is without
/// a sign: a table may write a run astern as a speed below zero. Astern the forward part turns round with the flow, for a section that is the
/// same fore and aft; another one wants a tare for each way.
pub(crate) fn strut(data: &Dataset, source: &Source) -> Result<ForceLaw, IdentifyError> {
    // Ahead and astern are one angle: at one alone, straight ahead included, the two terms of f_x have one shape; straight ahead and
    // straight across the second one is zero.
    let rows = moving(data.values("speed").unwrap_or_default(), AT_REST);
    let angles: Vec<f64> = rows.into_iter().map(|i| off_axis(data.velocity_m_s(i))).collect();
    let is_askew = angles.iter().any(|angle| (2.0 * angle).sin() > 1e-9);
    // The lift is determined by its forward part; sideways it has nearly the shape of the drag.
    let has_lift = is_askew && are_apart(angles.into_iter()) && data.channels.contains_key("f_x");
    let [along, across] = if has_lift {
        ["-D_xU*v_x*abs(speed) + X_vv*v_y*v_y*sign(v_x)", "-D_yU*v_y*abs(speed) - X_vv*abs(v_x)*v_y"]
    } else {
        ["-D_xU*v_x*abs(speed)", "-D_yU*v_y*abs(speed)"]
    };
    let terms = [("f_x", "v_x", along), ("f_y", "v_y", across), ("m_z", "v_y", "N_vU*v_y*abs(speed)")];
    let texts: IndexMap<String, String> = terms
        .into_iter()
        .filter(|(load, motion, _)| data.channels.contains_key(*load) && moves(data, motion))
        .map(|(load, _, text)| (load.to_owned(), text.to_owned()))
        .collect();
    if texts.is_empty() {
        moving_axes(data, source)?;
    }
    ForceLaw::formulas("strut", &texts, data)
}

/// The body of f1 … f6, or the keys that the campaign lacks.
pub(crate) fn body(campaign: &Campaign, data: &Dataset, model: &str) -> Result<Body, IdentifyError> {
    let spec = campaign.body.as_ref();
    let link = spec.and_then(|b| b.link);
    let (head, tail) = (spec.and_then(|b| b.head_side_area_m2), spec.and_then(|b| b.tail_side_area_m2));
    let mut missing = Vec::new();
    let mut need = |there: bool, key: &str| {
        if !there {
            missing.push(key.to_owned());
        }
    };
    need(link.is_some(), "body.link (major_semi_axis, minor_semi_axis, half_length)");
    need(head.is_some(), "body.head_side_area");
    need(tail.is_some(), "body.tail_side_area");
    need(data.dimension("density").is_some(), "fluid.density (or temperature)");
    need(data.dimension("n_links").is_some(), "a table column configuration (HkLT) or n_links [1]");
    match (link, head, tail) {
        (Some(link), Some(head), Some(tail)) if missing.is_empty() => {
            Ok(Body { link, head_side_area_m2: head, tail_side_area_m2: tail })
        }
        _ => {
            let missing = missing.join(", ");
            let problem = format!("model {model}: needs the body's geometry; the campaign lacks {missing}");
            Err(IdentifyError::Refused(problem))
        }
    }
}
