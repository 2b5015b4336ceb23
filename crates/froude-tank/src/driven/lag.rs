//! A delay of the loads that the runs show and nobody declared.
//!
//! 14 ms at one degree of phase move C_A by 3.8 %: where the delay is declared, as exact or as far as a standard uncertainty goes, the fit is repeated with the delay free, and the two are compared by Student's t.

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
/// A delay with a standard uncertainty is looked for again where the runs move it by more than this many.
const MOVED: f64 = 1.5;

/// What is said of it; nothing where the runs determine none, or show no other than the declared one.
pub(super) fn undeclared<M: MotorDriven>(fitted: &Fitted<'_, M>) -> Option<Finding> {
    let Fitted { fit: own, setup, runs, motions, campaign, .. } = fitted;
    let at = setup.enters(|enters| enters == Enters::Delay)?;
    let known = setup.constants.get(at)?.known;
    let of = |fit: &crate::joint::JointFit| {
        let unknown = fit.unknown(DELAY)?;
        unknown.value.zip(unknown.combined)
    };
    let (found, combined) = match known {
        None => of(own)?,
        Some(known) => {
            let moved = of(own).is_none_or(|(value, _)| (value - known.value).abs() > MOVED * known.standard);
            if !moved {
                return None;
            }
            let mut free = (*setup).clone();
            free.constants.get_mut(at)?.known = None;
            of(&fit(runs, motions, &free, &campaign.identify).ok()?)?
        }
    };
    let stated = known.map_or(0.0, |known| known.value);
    let standard = combined.standard.hypot(known.map_or(0.0, |known| known.standard));
    let p = t_two_sided((found - stated).abs() / standard, combined.dof);
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
                "where delay is declared as {} ± {} ms (standard uncertainty): added mass and damping are biased by the difference",
                plain(1e3 * known.value, 4),
                ms(known.standard)
            ),
        ),
    };
    let text = format!(
        "{}: the {} {} the {} by {} ± {} ms (95 %, {}), {done}. A filter of one channel or two clocks do it; if it is that of the rig, write delay = {{ value = \"{} ms\", standard = \"{} ms\" }} in [source.{}]",
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
        p_equation(p),
        significant(1e3 * found, 3),
        ms(combined.standard),
        spec.name
    );
    Some(Finding::new(severity, "lag", text))
}
