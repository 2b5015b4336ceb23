//! Forecast of an excitation: pulses, relay, sweep, jog, and what a hung weight does.

use crate::carriage::plan::PlannedRun;
use froude_control::config::Config;
use froude_control::request::Excitation;
use froude_control::travel::{Rigid, foresee_excitation, preflight_excitation};

use super::tow::{Load, beyond_the_drive};
use crate::campaign::preflight::forecast::{Expected, Forecast, Objection};

/// Pulses, relay, sweep and jog. The controller holds them inside the soft limits by ending them: what would be ended is refused here.
pub(super) fn excitation(
    run: &PlannedRun,
    asked: Excitation,
    control: &Config,
    expected: &Expected,
) -> (Forecast, Vec<Objection>) {
    let axis = &control.axes[run.axis as usize];
    let (drive, limits) = (&axis.drive, &axis.limits);
    let n_m_v = drive.torque_constant_n_m_a * drive.amplifier_a_v;
    let from_m = run.drive.from_m();
    // Largest command, its root mean square, how long, and what to do about too much.
    let (command_v, rms_v, duration_s, advice) = match asked {
        Excitation::Pulses { volts, duty, duration_s, .. } => {
            (volts.abs(), volts.abs() * duty.sqrt(), duration_s, "lower the amplitude of [carriage.excitation]")
        }
        Excitation::Relay { volts, duration_s, .. } => {
            (volts.abs(), volts.abs(), duration_s, "the relay's height is fixed, this drive is too weak for it")
        }
        Excitation::Sweep { speed_m_s, volts, duration_s, .. } => {
            // The sine comes on top of what the tow below it takes.
            let steady_v = Load::of(run, speed_m_s, axis, expected).steady_n_m / n_m_v;
            let rms_v = steady_v.hypot(volts / std::f64::consts::SQRT_2);
            let advice = "the sweep's amplitude is fixed, this drive is too weak for it";
            (steady_v + volts.abs(), rms_v, duration_s, advice)
        }
        Excitation::Jog { volts, duration_s, .. } => {
            (volts.abs(), volts.abs(), duration_s, "the jog's command is fixed, this drive is too weak for it")
        }
    };
    let (current_a, rms_current_a) = (command_v * drive.amplifier_a_v, rms_v * drive.amplifier_a_v);
    let mut out = beyond_the_drive("it", advice, [command_v, current_a, rms_current_a], axis);
    if out.is_empty()
        && let Some(refusal) = preflight_excitation(control, axis, from_m, &asked)
    {
        let text = match refusal {
            froude_control::status::Refusal::BeyondTravel => format!(
                "it starts at {from_m:.3} m and its travel does not fit between the end switches at {:.3} and {:.3} m: start elsewhere",
                limits.low_switch_m, limits.high_switch_m
            ),
            _ => format!("the controller would refuse it: {asked:?} has a number out of its range"),
        };
        out.push(("controller", text));
    }
    if out.is_empty()
        && let Some(text) = excursion(run, &asked, from_m, duration_s, control, expected)
    {
        out.push(("travel", text));
    }
    let forecast = Forecast {
        id: run.id.clone(),
        duration_s,
        steady_s: 0.0,
        command_v,
        current_a,
        rms_current_a,
        coast_m: 0.0,
        margin_m: f64::INFINITY,
        drag_n: None,
    };
    (forecast, out.into_iter().map(|(kind, text)| Objection { id: run.id.clone(), kind, text }).collect())
}

/// Where the controller would end an excitation before its time, with the declared friction or with its lower end.
fn excursion(
    run: &PlannedRun,
    asked: &Excitation,
    from_m: f64,
    duration_s: f64,
    control: &Config,
    expected: &Expected,
) -> Option<String> {
    let (what, are, advice) = match asked {
        Excitation::Pulses { .. } => {
            ("pulses", "are", "Write a lower amplitude or a shorter period in [carriage.excitation], or move the start")
        }
        Excitation::Relay { .. } => ("relay", "is", "Start further from the ends"),
        Excitation::Jog { .. } => ("jog", "is", "Start further from the ends"),
        Excitation::Sweep { .. } => return None,
    };
    let axis = &control.axes[run.axis as usize];
    let drive = &axis.drive;
    let inertia_kg_m2 = Load::of(run, 0.0, axis, expected).inertia_kg_m2;
    let frictions =
        [[drive.viscous_n_m_s_rad, drive.coulomb_n_m], [drive.viscous_lower_n_m_s_rad, drive.coulomb_lower_n_m]];
    let cuts = frictions.map(|[viscous_n_m_s_rad, coulomb_n_m]| {
        let on = Rigid { inertia_kg_m2, viscous_n_m_s_rad, coulomb_n_m };
        let excursion = foresee_excitation(control, axis, from_m, asked, on);
        excursion.cut_s.map(|cut_s| (cut_s, excursion.end_m))
    });
    let (cut_s, end_m) = cuts.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "its {what} {are} predicted to reach {end_m:.3} m after {cut_s:.1} s of {duration_s} s, where the controller ends what could not be \
         stopped inside the soft limits any more. {advice}"
    ))
}
