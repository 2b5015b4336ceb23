//! A delay of the loads that the runs show and nobody declared.
//!
//! 14 ms at one degree of phase move C_A by 3.8 %. A free delay is compared with zero, and one that is declared as exact with that of a second fit, where it is free, by Student's t. One that is
//! declared with a standard uncertainty is part of the fit, and `declared-contradicted` tests it.

use froude_fit::distribution::t_two_sided;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{p_equation, plain, significant};

use super::fit::fit;
use super::fitted::Fitted;
use super::method::MotorDriven;
use super::spec::Enters;
use crate::joint::DELAY;

/// Chance of reporting a delay that is not there.
const ALARM: f64 = 0.004;

/// What is said of it; nothing where the runs determine none, or show no other than the declared one.
#[must_use]
pub fn undeclared<M: MotorDriven>(fitted: &Fitted<'_, M>) -> Option<Finding> {
    let Fitted { fit: own, setup, runs, motions, campaign, .. } = fitted;
    let at = setup.enters(|enters| enters == Enters::Delay)?;
    let known = setup.constants.get(at)?.known;
    let of = |fit: &crate::joint::JointFit| {
        let unknown = fit.unknown(DELAY)?;
        unknown.value.zip(unknown.combined)
    };
    let (found, combined) = match known {
        None => of(own)?,
        Some(known) if known.standard > 0.0 => return None,
        Some(_) => {
            let mut free = (*setup).clone();
            free.constants.get_mut(at)?.known = None;
            of(&fit(runs, motions, &free, &campaign.identify).ok()?)?
        }
    };
    let stated = known.map_or(0.0, |known| known.value);
    let p = t_two_sided((found - stated).abs() / combined.standard, combined.dof);
    if p.is_nan() || p >= ALARM {
        return None;
    }
    let [low, high] = combined.interval(found);
    let (spec, ms) = (M::SPEC, |s: f64| significant(1e3 * s, 2));
    let loads: Vec<&str> = spec.loads.iter().map(|load| load.name).collect();
    let (severity, done) = match known {
        None => (Severity::Note, "and the fit takes that into account".to_owned()),
        Some(known) => (
            Severity::Warning,
            format!(
                "where delay is declared as {} ms, exact: added mass and damping are biased by the difference. A filter in one channel or separate clocks can cause this. Leave delay out of [source.{}] to have it fitted with the coefficients",
                plain(1e3 * known.value, 4),
                spec.name
            ),
        ),
    };
    let text = format!(
        "{}: the {} {} the {} by {} ± {} ms (95 %, {}), {done}",
        own.law,
        loads.join(" and "),
        match (found > 0.0, loads.len()) {
            (true, 1) => "lags",
            (true, _) => "lag",
            (false, 1) => "leads",
            (false, _) => "lead",
        },
        spec.motion.name,
        significant(1e3 * found.abs(), 3),
        ms(0.5 * (high - low)),
        p_equation(p)
    );
    Some(Finding::new(severity, "lag", text))
}
