//! The planned runs: every configuration in every condition, with every amplitude at every frequency.

use std::f64::consts::TAU;

use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_rig::swung::Swing;

use super::method::MotorDriven;
use super::spec::Point;
use super::still_fit::is_still;
use crate::matrix::Plan;

/// One planned run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// What it is.
    pub point: Point,
    /// How the body is moved.
    pub swing: Swing,
    /// Samples a second.
    pub rate_hz: f64,
    /// One factor \[-\] for each group of coefficients that vary from run to run; a missing factor is 1.
    pub of_drag: Vec<f64>,
}

impl From<Point> for Planned {
    fn from(point: Point) -> Self {
        let [rate_hz, angle, hold_s] = ["rate", "angle", "hold"].map(|name| point.condition(name));
        let [amplitude, omega_rad_s] = ["amplitude", "frequency"].map(|name| point.condition(name));
        let [still_s, periods] = ["still", "periods"].map(|name| point.condition(name));
        let swing = if is_still(&point) {
            Swing { middle: angle, amplitude: 0.0, omega_rad_s: 1.0, still_s: hold_s, periods: 0.0 }
        } else {
            Swing { middle: 0.0, amplitude, omega_rad_s, still_s, periods }
        };
        Self { id: point.id.clone(), swing, rate_hz, of_drag: Vec::new(), point }
    }
}

/// The runs that a source plans.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn planned<M: MotorDriven>(source: &Source) -> Result<Vec<Planned>, RecordError> {
    let (keys, roles) = (M::SPEC.plan, M::SPEC.roles);
    let points = Plan { roles, check: M::check_plan, ..Plan::of(keys, asks) }.points(source, M::SPEC.name)?;
    Ok(points.into_iter().map(Planned::from).collect())
}

/// One run, with still water before and behind its periods.
fn asks(point: &Point) -> (usize, f64) {
    if is_still(point) {
        return (1, point.condition("hold"));
    }
    (1, TAU * point.condition("periods") / point.condition("frequency") + 2.0 * point.condition("still"))
}
