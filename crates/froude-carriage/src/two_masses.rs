//! Two masses and a chain from the run of a campaign that excites them.

use froude_fit::budget::Uncertain;
use froude_identify::method::MethodError;
use froude_records::finding::{Finding, Severity};
use froude_records::run::{AxisConstants, Declared, Role, RunLog};
use froude_records::units::Dimension;

use crate::runs::{column, drive};
use crate::servo::motor::MotorSide;
use crate::servo::two_mass::{FlexibleOptions, FlexibleReport, identify_flexible};
use crate::servo::{Gear, ServoLog};

/// Columns of a run for the servo's identification.
///
/// # Errors
///
/// A channel that is missing, of another dimension, or beyond any carriage.
pub fn servo_log(log: &RunLog) -> Result<ServoLog, MethodError> {
    let axis = log.meta.carriage.axis.name();
    let column = |name: &str, dimension| column(log, &format!("{axis}/{name}"), dimension).map(<[f64]>::to_vec);
    Ok(ServoLog {
        time_s: log.time_s.clone(),
        position_m: column("position", Dimension::LENGTH)?,
        command_v: drive(log)?.to_vec(),
    })
}

/// What the motor side of a drive is, as a campaign or a run declares it.
#[must_use]
pub fn motor_of(constants: &AxisConstants) -> MotorSide {
    MotorSide {
        torque_constant_n_m_a: constants.torque_constant_n_m_a.value,
        amplifier_a_v: constants.amplifier_a_v.value,
        gear_ratio: constants.gear_ratio.value,
        sprocket_radius_m: constants.sprocket_radius_m.value,
    }
}

/// Standard uncertainties of what makes volts into torques, and of the radius that makes these into forces, as parts.
#[must_use]
pub fn relative_errors(constants: &AxisConstants) -> [f64; 2] {
    let part = |d: &Declared| d.standard_uncertainty / d.value;
    let torque = part(&constants.torque_constant_n_m_a).hypot(part(&constants.amplifier_a_v));
    [torque, part(&constants.sprocket_radius_m)]
}

/// The run that determines the two masses.
#[must_use]
pub fn pulses(logs: &[RunLog]) -> Option<&RunLog> {
    logs.iter().find(|l| l.meta.role == Role::Excitation)
}

/// Two masses and a chain from the first run with pulses; a finding where there is one that does not determine them.
#[must_use]
pub fn two_masses(logs: &[RunLog]) -> (Option<FlexibleReport>, Option<Finding>) {
    let Some((log, constants)) = pulses(logs).and_then(|l| l.meta.moving_axis().map(|c| (l, c))) else {
        return (None, None);
    };
    let identified = servo_log(log).and_then(|columns| {
        identify_flexible(&columns, &flexible_options(motor_of(constants), constants)).map_err(MethodError::refused)
    });
    match identified {
        Ok(report) => (Some(report), None),
        Err(error) => (None, Some(Finding::new(Severity::Warning, "two-mass", format!("{}: {error}", log.meta.id)))),
    }
}

/// From a command to the force on the rotor: half a tick of the controller and the amplifier's current loop, which a campaign does not
/// declare; 0.5 to 2 kHz is usual.
const DELAY_S: Uncertain = Uncertain::new(2e-4, 1e-4);

/// What the campaign declares of the drive.
fn flexible_options(motor: MotorSide, constants: &AxisConstants) -> FlexibleOptions {
    let uncertain = |d: &Declared| Uncertain::new(d.value, d.standard_uncertainty);
    let gear = match (&constants.efficiency_forward, &constants.efficiency_backward) {
        (Some(forward), Some(backward)) => {
            Gear::Declared { forward: uncertain(forward), backward: uncertain(backward) }
        }
        _ if motor.gear_ratio == 1.0 => Gear::Lossless,
        _ => Gear::Undeclared,
    };
    let [force_relative, radius_relative] = relative_errors(constants);
    FlexibleOptions { gear, delay_s: DELAY_S, force_relative, radius_relative, ..FlexibleOptions::new(motor) }
}
