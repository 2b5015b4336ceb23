//! What a run is expected to do, and what speaks against it.

/// What a run asks of the rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// The run.
    pub id: String,
    /// Time from the start of the profile to its end, s.
    pub duration_s: f64,
    /// Steady part, s.
    pub steady_s: f64,
    /// Largest command, V.
    pub command_v: f64,
    /// Largest current, A.
    pub current_a: f64,
    /// Root-mean-square current over the profile, A.
    pub rms_current_a: f64,
    /// Coast from the steady speed with the lower bound of friction, m.
    pub coast_m: f64,
    /// Free way ahead of the end of the profile that is left after stopping, m.
    pub margin_m: f64,
    /// Expected drag in the steady part, N; `None` without a body in the water.
    pub drag_n: Option<f64>,
}

/// Why a campaign is refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection {
    /// The run, or the section of the campaign that it stands in.
    pub id: String,
    /// What kind it is: `travel`, `coast`, `weight`, `speed`, `acceleration`, `command`, `current`, `heating`, `steady`, `still`,
    /// `controller`.
    pub kind: &'static str,
    /// The sentence, with the numbers.
    pub text: String,
}

/// Declared drag and mass of the body, efficiency of the gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// D_d, N s²/m²; 0 where unknown.
    pub drag_n_s2_m2: f64,
    /// Extra mass of the body, its water and its added mass when wet, kg.
    pub wet_mass_kg: f64,
    /// Mass of the dry body, kg.
    pub dry_mass_kg: f64,
    /// η; 1 where it is part of the declared friction.
    pub efficiency: f64,
    /// Volume that was taken for the body because none is declared, m³.
    pub assumed_volume_m3: Option<f64>,
}

impl Expected {
    /// What a sentence about a coast must add where the mass behind it is a guess.
    pub(crate) fn guess(&self) -> String {
        self.assumed_volume_m3.map_or_else(String::new, |v| {
            format!(". There is no volume in [body]: that of a {:.1} litre body is assumed", 1e3 * v)
        })
    }
}

/// Shortest part at constant speed that can be averaged, s: the reduction drops 0.5 s at its start and 0.05 s at its end and needs 1 s
/// between. A test of the `froude` crate compares this with the reduction's own settings.
pub const SHORTEST_STEADY_S: f64 = 0.5 + 0.05 + 1.0;

/// Two decimals of a number that advice may quote as the most: never rounded up.
pub(crate) fn at_most(value: f64) -> f64 {
    (1e2 * value * (1.0 - 1e-9)).floor() / 1e2
}
