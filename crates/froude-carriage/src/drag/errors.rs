//! Errors of the forces that a carriage measures, as the budget needs them.

use froude_identify::uncertainty::SharedError;

use crate::drag::point::{Method, Point};
use crate::drag::setup::{Ballast, DragSetup, Efficiency, UNDECLARED_EFFICIENCY, UNDECLARED_ROLLING};
use crate::servo::scale::{COUNT, SPROCKET_RADIUS};

/// Errors that all pairs share, and those that the scatter already shows.
pub(super) fn shared(method: Method, points: &[Point], measured: f64, setup: &DragSetup) -> Vec<SharedError> {
    // An error of the resistance is one of the load with the other sign.
    let by = |of: &dyn Fn(&Point) -> f64| points.iter().map(|p| -of(p)).collect::<Vec<f64>>();
    let of_force = by(&|p| p.force_n);
    let of = |name: &str, direction: &[f64], standard: f64, dof: f64| {
        SharedError::of_load(name, setup.load(), direction, standard, dof)
    };
    let never = f64::INFINITY;
    let mut out = Vec::new();
    if method.is_sensorless() {
        match (setup.calibration, setup.efficiency) {
            (Some(f), _) => {
                let error = of(setup.drive.error, &of_force, f.relative(), f.dof);
                out.push(error.known_as(setup.keys.calibration.clone(), setup.drive.name));
            }
            (None, efficiency) => {
                let error = of("K_T and amplifier gain, declared", &of_force, setup.torque_constant_relative, never);
                out.push(error.known_as(setup.keys.of_rig("torque_constant"), "torque_constant"));
                out.push(match efficiency {
                    Efficiency::Declared(e) => of("gear efficiency, declared", &of_force, e.relative(), e.dof)
                        .known_as(
                            setup.keys.of_rig(&format!("efficiency {:e} {:e}", e.value, e.standard)),
                            "efficiency",
                        ),
                    Efficiency::Undeclared => {
                        let limits = UNDECLARED_EFFICIENCY.map(|e| e - 1.0);
                        SharedError::between("gear efficiency, not declared", setup.load(), &of_force, limits)
                            .known_as(setup.keys.of_rig("efficiency, not declared"), "efficiency")
                    }
                });
            }
        }
        let drift = by(&|p| setup.torque_constant_drift_relative * measured * p.speed_m_s.powi(2));
        out.push(SharedError::of_each_row("drift of K_T from run to run, on the drag", setup.load(), &drift));
        if let Ballast::Unballasted { unloaded_n, rolling } = setup.ballast {
            let of_load = by(&|p| unloaded_n * p.speed_m_s.signum());
            out.push(match rolling {
                Some(r) => of("rolling friction removed by buoyancy", &of_load, r.standard, r.dof),
                None => {
                    let name = "rolling friction removed by buoyancy, not declared";
                    SharedError::between(name, setup.load(), &of_load, UNDECLARED_ROLLING)
                }
            });
        }
    } else {
        let error = of("gain of the sensor", &of_force, setup.sensor.gain_relative, never);
        out.push(error.known_as(setup.keys.sensor.clone(), "sensor_gain"));
        let zero = by(&|p| p.standard_n);
        out.push(SharedError::of_each_row("noise, zero of the sensor and its drift", setup.load(), &zero));
    }
    // v² takes the sprocket's radius twice; newtons that are not calibrated, (n/R) K_T K_amp, once more in the same direction.
    let times = if method.is_sensorless() && setup.calibration.is_none() { 3.0 } else { 2.0 };
    // A radius that is taken too large makes the speed too large, and the drag too small.
    let of_length: Vec<f64> = points.iter().map(|p| times * p.force_n).collect();
    let error = of(COUNT, &of_length, setup.speed_scale_relative, never);
    out.push(error.known_as(setup.keys.of_rig(SPROCKET_RADIUS), SPROCKET_RADIUS));
    if let Some(strut) = setup.strut_n_s2_m2 {
        // What is taken off too much is missing in the drag.
        let of_strut: Vec<f64> = points.iter().map(|p| p.speed_m_s * p.speed_m_s.abs()).collect();
        let key = setup.keys.rig.as_ref().map(|_| format!("strut/{:e} {:e}", strut.value, strut.standard));
        out.push(of("drag of the strut", &of_strut, strut.standard, strut.dof).known_as(key, "strut_drag"));
    }
    out
}
