//! Where the observations lie: speed, angle and the similarity numbers of the water and the tank.
//!
//! The ranges go into every record. A prediction outside them is extrapolation.

use froude_hydro::similarity;
use froude_records::campaign::Campaign;
use froude_records::estimate::Range;
use froude_records::finding::{Finding, Severity};
use indexmap::IndexMap;

use crate::dataset::{Dataset, unit_text};
use crate::law::ForceLaw;
use crate::lint::motion::{OF_RESISTANCE, moving};

/// Blockage above which a correction or a remark is due (ITTC 7.5-02-02-01 corrects resistance for blockage well below it).
pub const BLOCKAGE_LIMIT: f64 = 0.05;
/// Submergence Froude number above which a body near the surface makes waves that matter.
const WAVE_LIMIT: f64 = 0.4;

/// Rows slower than this part of the fastest are at rest: a slow tow has a hundredth of the speed of a fast one, and what a sensor shows at
/// rest is less.
pub(crate) const AT_REST: f64 = 0.01;

/// Name of the range of the angle between the motion and the x axis, ahead or astern: what a strut sees of the angle.
pub const OFF_AXIS: &str = "angle_off_axis";

/// Name of the range of the velocity along x, over the rows that move: whether a tare was towed ahead, astern or both.
pub const ALONG: &str = "v_x";

/// Angle between a velocity and the x axis, ahead or astern, rad.
pub(crate) fn off_axis([v_x, v_y]: [f64; 2]) -> f64 {
    v_y.abs().atan2(v_x.abs())
}

/// Ranges of what laws read beside the motion and the water, a tip speed ratio or the rate of a propeller, by name.
pub(crate) fn of_laws(data: &Dataset, laws: &[ForceLaw]) -> IndexMap<String, Range> {
    let is_other = |name: &&str| !OF_RESISTANCE.contains(name) && !name.ends_with("_dot");
    let of = |name: &str| {
        let values = data.values(name)?;
        let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(*x), h.max(*x)]);
        Some((name.to_owned(), Range::of([low, high], unit_text(data, name))))
    };
    laws.iter().flat_map(ForceLaw::channels).filter(is_other).filter_map(of).collect()
}

/// Ranges of the observations, by name, with the findings that they give rise to.
///
/// At rest there is no angle: those of rows that do not move are passed over.
#[must_use]
pub fn ranges(data: &Dataset, campaign: &Campaign) -> (IndexMap<String, Range>, Vec<Finding>) {
    let mut out = IndexMap::new();
    let mut findings = Vec::new();
    let mut put = |name: &str, values: &[f64], unit: &str| {
        if !values.is_empty() {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            out.insert(name.to_owned(), Range::of([low, high], unit));
        }
    };
    let moving = moving(data.values("speed").unwrap_or_default(), AT_REST);
    for (name, unit) in [("speed", "m/s"), ("angle", "rad"), ("n_links", "1"), ("temperature", "K")] {
        match data.values(name) {
            Some(values) if name == "angle" => {
                put(name, &moving.iter().map(|&i| values[i]).collect::<Vec<_>>(), unit);
                put(OFF_AXIS, &moving.iter().map(|&i| off_axis(data.velocity_m_s(i))).collect::<Vec<_>>(), unit);
            }
            Some(values) => put(name, values, unit),
            None => {}
        }
    }
    if data.values("v_x").is_some() {
        put(ALONG, &moving.iter().map(|&i| data.velocity_m_s(i)[0]).collect::<Vec<_>>(), "m/s");
    }
    for (name, channel) in &data.channels {
        let is_rate = matches!(name.as_str(), "v_z" | "w_x" | "w_y" | "w_z") || name.ends_with("_dot");
        if is_rate {
            put(name, &channel.values, &channel.dimension.to_string());
        }
    }
    for (name, values) in per_observation(data, campaign) {
        put(name, &values, "1");
        let worst = values.iter().copied().fold(0.0, f64::max);
        if name == "Fr_submergence" && worst > WAVE_LIMIT {
            findings.push(Finding::new(
                Severity::Warning,
                "wave-making",
                format!(
                    "U/√(g h) reaches {worst:.2}, h being the submergence: the drag includes wave-making resistance, which a deeply submerged \
                     body does not have"
                ),
            ));
        }
        if name == "blockage" && worst > BLOCKAGE_LIMIT {
            findings.push(Finding::new(
                Severity::Warning,
                "blockage",
                format!(
                    "the body blocks {:.1} % of the tank's cross-section: the flow speeds up around it, and the drag is not that in unbounded water",
                    100.0 * worst
                ),
            ));
        }
    }
    (out, findings)
}

/// Numbers of similarity of every row, as far as body, tank and water are stated.
///
/// | name | what | needs |
/// |------|------|-------|
/// | `Re` | U L/ν | `body.reference_length`, viscosity |
/// | `Fr_length` | U/√(g L) | `body.reference_length` |
/// | `Fr_depth` | U/√(g d) | `tank.depth` |
/// | `Fr_submergence` | U/√(g h) | `tank.submergence` |
/// | `KC` | 2π a/L | `body.reference_length`, columns `amplitude` and `period` |
/// | `blockage` | A/(w d) | `body.reference_area`, `tank.width`, `tank.depth` |
///
/// All dimensionless. U is the speed in m/s, L, d and h are lengths in m, ν in m²/s, a the amplitude in m.
///
/// # Source
///
/// Froude (1874); Keulegan & Carpenter (1958).
#[must_use]
pub fn per_observation(data: &Dataset, campaign: &Campaign) -> Vec<(&'static str, Vec<f64>)> {
    let mut out = Vec::new();
    let body = campaign.body.as_ref();
    let length = body.and_then(|b| b.reference_length_m);
    let tank = campaign.tank.as_ref();
    if let Some(speed) = data.values("speed") {
        if let (Some(l), Some(nu)) = (length, data.values("kinematic_viscosity")) {
            out.push(("Re", speed.iter().zip(nu).map(|(u, nu)| similarity::reynolds(*u, l, *nu)).collect()));
        }
        let lengths = [
            ("Fr_length", length),
            ("Fr_depth", tank.and_then(|t| t.depth_m)),
            ("Fr_submergence", tank.and_then(|t| t.submergence_m)),
        ];
        for (name, l) in lengths {
            if let Some(l) = l {
                out.push((name, speed.iter().map(|u| similarity::froude(*u, l)).collect()));
            }
        }
        if let (Some(l), Some(amplitude), Some(period)) = (length, data.values("amplitude"), data.values("period")) {
            let kc = |(a, t): (&f64, &f64)| similarity::keulegan_carpenter(std::f64::consts::TAU * a / t, *t, l);
            out.push(("KC", amplitude.iter().zip(period).map(kc).collect()));
        }
    }
    if let (Some(area), Some((w, d))) =
        (body.and_then(|b| b.reference_area_m2), tank.and_then(|t| Some((t.width_m?, t.depth_m?))))
    {
        out.push(("blockage", vec![similarity::blockage(area, w * d); data.rows]));
    }
    out
}

/// C_D = −f·v/(½ρU³A) of every row on `body.reference_area`: the force against the motion, before any model.
///
/// For planar motion; `None` without the area, the density or f_x, and where the table has v_z.
///
/// f in N, v and U in m/s, ρ in kg/m³, A in m²; dimensionless. NaN or infinite where a row is at rest.
#[must_use]
pub fn drag_coefficient(data: &Dataset, campaign: &Campaign) -> Option<Vec<f64>> {
    if data.channels.contains_key("v_z") {
        return None;
    }
    let area_m2 = campaign.body.as_ref()?.reference_area_m2?;
    let (density, f_x) = (data.values("density")?, data.values("f_x")?);
    let f_y = data.values("f_y");
    let at = |i: usize| {
        let [v_x, v_y] = data.velocity_m_s(i);
        let power_w = -(f_x[i] * v_x + f_y.map_or(0.0, |f| f[i] * v_y));
        power_w / (0.5 * density[i] * v_x.hypot(v_y).powi(3) * area_m2)
    };
    Some((0..data.rows).map(at).collect())
}

/// The words for a prediction outside the ranges of an estimate, if it is outside.
#[must_use]
pub fn extrapolation(name: &str, low: f64, high: f64, fitted: &Range) -> Option<Finding> {
    let slack = 1e-9 * fitted.high.abs().max(fitted.low.abs());
    (low < fitted.low - slack || high > fitted.high + slack).then(|| {
        Finding::new(
            Severity::Warning,
            "extrapolation",
            format!(
                "{name} {low:.4} to {high:.4} {} is outside the fitted range {:.4} to {:.4}: this is extrapolation",
                fitted.unit, fitted.low, fitted.high
            ),
        )
    })
}
