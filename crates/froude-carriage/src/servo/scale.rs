//! Declared errors of what makes volts into forces and counts into metres: each scales the coefficients.

use froude_fit::propagate::expanded;
use froude_records::estimate::{Coefficient, SharedError};
use froude_records::number::finite;
use indexmap::IndexMap;

use crate::servo::motor::Drive;
use crate::servo::report::ServoCoefficient;

/// The force or torque per unit of a command, with what is declared of its error.
#[derive(Debug, Clone)]
pub struct ForcePerVolt<'a> {
    /// N/V, or in `unit`.
    pub n_v: f64,
    /// Its name in a record.
    pub name: &'static str,
    /// Its unit.
    pub unit: String,
    /// What is said where it has no error.
    pub exact: &'static str,
    /// Its errors; none where it is taken as exact.
    pub scales: Vec<Scale>,
    /// The drive that it follows from; `None` of a log without a rig.
    pub drive: Option<&'a Drive>,
}

/// What is said of a force per volt that has no error.
const EXACT: &str = "the force per volt is taken as exact: an error of it scales all coefficients alike; declare it by [[source.uncertainty]] with \
                     quantity = \"drive_gain\"";

impl<'a> ForcePerVolt<'a> {
    /// As it follows from a declared drive.
    #[must_use]
    pub fn of_drive(drive: &'a Drive) -> Self {
        Self {
            scales: drive.scales().into(),
            drive: Some(drive),
            ..Self::of_log(drive.motor.force_per_volt_n_v(), None)
        }
    }

    /// As a number, with its error where one is declared.
    #[must_use]
    pub fn of_log(n_v: f64, scale: Option<Scale>) -> Self {
        let scales = scale.into_iter().collect();
        Self { n_v, name: "force_per_volt", unit: "N/V".to_owned(), exact: EXACT, scales, drive: None }
    }
}

/// An error of a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Its key: what has the same one has the same error.
    pub key: String,
    /// What errs, in words.
    pub name: String,
    /// The same as a file names it.
    pub quantity: String,
    /// Standard uncertainty, as a part of the factor.
    pub relative: f64,
    /// Degrees of freedom behind it; infinite where none are given.
    pub dof: Option<f64>,
    /// What it scales.
    pub errs: Errs,
}

/// What an uncertain factor scales.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Errs {
    /// The force.
    Factor,
    /// Lengths, and by the torque the force: the sprocket's radius.
    Radius,
    /// Lengths alone.
    Length,
}

/// An error of lengths in words, and its key: that of the drag has the same.
pub(crate) const COUNT: &str = "length of an encoder count";
pub(crate) const SPROCKET_RADIUS: &str = "sprocket_radius";

impl Scale {
    /// What a part of it changes in a coefficient, as a part of that; `radii` is the power of the radius, with one for the torque.
    fn power(&self, name: &str, radii: &dyn Fn(&str) -> f64) -> f64 {
        match self.errs {
            Errs::Factor => 1.0,
            Errs::Radius => radii(name),
            Errs::Length => radii(name) + 1.0,
        }
    }
}

impl Drive {
    /// Errors of K_T with the amplifier's gain, and of the radius.
    #[must_use]
    pub fn scales(&self) -> [Scale; 2] {
        let scale = |name: &str, quantity: &str, relative, errs| Scale {
            key: format!("{}/{quantity}", self.rig),
            name: name.to_owned(),
            quantity: quantity.to_owned(),
            relative,
            dof: None,
            errs,
        };
        [
            scale("K_T and amplifier gain, declared", "torque_constant", self.torque_relative, Errs::Factor),
            scale(COUNT, SPROCKET_RADIUS, self.radius_relative, Errs::Radius),
        ]
    }
}

/// Errors of an estimate by their keys; `radii` is the power by which the radius goes into a coefficient.
pub(super) fn errors_of(
    scales: &[Scale],
    coefficients: &[ServoCoefficient],
    radii: &dyn Fn(&str) -> f64,
) -> IndexMap<String, SharedError> {
    let error = |scale: &Scale| {
        let slopes = coefficients.iter().map(|c| scale.power(&c.name, radii) * c.value);
        let dof = scale.dof.unwrap_or(f64::INFINITY);
        SharedError::declared([&scale.name, &scale.quantity], scale.relative, dof, slopes)
    };
    scales.iter().filter(|scale| scale.relative > 0.0).map(|scale| (scale.key.clone(), error(scale))).collect()
}

/// What the errors add to the scatter of a coefficient, `of_scatter`.
pub(super) fn combined(
    of_scatter: Coefficient,
    (c, dof): (&ServoCoefficient, f64),
    scales: &[Scale],
    radii: &dyn Fn(&str) -> f64,
) -> Coefficient {
    let variance = |scale: &Scale| (scale.power(&c.name, radii) * scale.relative * c.value).powi(2);
    let known = scales.iter().map(|scale| (variance(scale), scale.dof.unwrap_or(f64::INFINITY)));
    let parts: Vec<(f64, f64)> = std::iter::once((c.block_std * c.block_std, dof)).chain(known).collect();
    let type_b = parts[1..].iter().map(|(variance, _)| variance).sum::<f64>().sqrt();
    if !c.block_std.is_finite() || type_b <= 0.0 {
        return of_scatter;
    }
    let all = expanded(&parts, 0.95);
    Coefficient {
        standard_uncertainty: Some(all.standard),
        type_b: Some(type_b),
        interval_95: finite(Some(all.expanded)).map(|half| [c.value - half, c.value + half]),
        effective_dof: finite(Some(all.dof)),
        ..of_scatter
    }
}
