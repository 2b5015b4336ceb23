//! The list of all methods that read runs.

use froude_carriage::axis::any::AnyServo;
use froude_carriage::axis::source::Servo;
use froude_carriage::drag::calibration::source::KnownWeights;
use froude_carriage::source::Carriage;
use froude_carriage::tuning::source::{Resonance, Tuning};
use froude_cfd::forces::source::OpenFoamForces;
use froude_identify::method::Method;
use froude_tank::{accelerated_tow, decay, excited_response, oscillation, rotation, steady, sway, weight_tow};

pub(crate) const METHODS: [&dyn Method; 15] = [
    &Carriage,
    &Servo,
    &AnyServo,
    &KnownWeights,
    &Tuning,
    &Resonance,
    &decay::source::DECAY,
    &oscillation::FORCED,
    &rotation::TURNED,
    &sway::SWAYED,
    &steady::STEADY_TOW,
    &weight_tow::PULLED,
    &accelerated_tow::source::ACCELERATED,
    &excited_response::source::EXCITED,
    &OpenFoamForces,
];
