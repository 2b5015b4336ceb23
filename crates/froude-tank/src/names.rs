//! Names of the methods, by which runs and campaigns know them.

/// The method of a body that a motor swings.
pub const FORCED_OSCILLATION: &str = "forced_oscillation";
/// The method of a body that a motor turns to and fro about its own centre.
pub const ROTATION: &str = "rotation";
/// The method of a body in waves, held in one run and free in the other.
pub const EXCITED_RESPONSE: &str = "excited_response";
/// The method of a body that is towed, or held in a stream, at constant speed.
pub const STEADY: &str = "steady";
/// The method of a wagon that a hanging weight pulls.
pub const WEIGHT_TOW: &str = "weight_tow";
/// The method of a body that is towed up to speed and down again.
pub const ACCELERATED_TOW: &str = "accelerated_tow";
/// The method of a body that is let go and swings out.
pub const FREE_DECAY: &str = "free_decay";
