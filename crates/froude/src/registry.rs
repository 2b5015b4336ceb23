//! The list of all methods that read runs.

use froude_carriage::axis::source::Servo;
use froude_carriage::drag::calibration::source::KnownWeights;
use froude_carriage::source::Carriage;
use froude_carriage::tuning::source::{Resonance, Tuning};
use froude_identify::method::Method;
use froude_tank::accelerated_tow::source::AcceleratedTow;
use froude_tank::decay::source::FreeDecay;
use froude_tank::excited_response::source::ExcitedResponse;
use froude_tank::oscillation::source::ForcedOscillation;
use froude_tank::rotation::source::Rotation;
use froude_tank::steady::source::Steady;
use froude_tank::weight_tow::source::WeightTow;

/// Names of the methods that read runs of a method.
pub(crate) fn readers(runs: &str) -> Vec<&'static str> {
    METHODS.iter().filter(|method| method.runs() == runs).flat_map(|method| method.names()).copied().collect()
}

/// All methods that read runs.
pub(crate) const METHODS: [&dyn Method; 12] = [
    &Carriage,
    &Servo,
    &KnownWeights,
    &Tuning,
    &Resonance,
    &FreeDecay,
    &ForcedOscillation,
    &Rotation,
    &Steady,
    &WeightTow,
    &AcceleratedTow,
    &ExcitedResponse,
];
