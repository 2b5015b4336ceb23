//! The scale of an encoder, from distances that somebody measured.

use std::path::PathBuf;

use froude_carriage::drag::calibration::encoder_scale;
use froude_carriage::runs;
use froude_fit::budget::Uncertain;
use froude_records::block::Block;
use froude_records::number::short_form;
use froude_records::run::Role;

use crate::Error;

/// The radius of the sprocket that makes counted distances the known one; `None` where no run says which it has.
///
/// # Errors
///
/// Runs that cannot be read, fewer than two distances.
pub fn scale(paths: &[PathBuf], known_m: Uncertain, counted_m: &[f64]) -> Result<Option<Block>, Error> {
    let factor = encoder_scale(counted_m, known_m)?;
    let read = runs::read(paths, &[Role::Calibration, Role::Jog], None)?;
    Ok(read.logs.iter().find_map(|log| log.meta.moving_axis()).map(|axis| {
        let radius_mm = 1e3 * axis.sprocket_radius_m.value;
        Block::words([format!(
            "encoder scale {}: sprocket_radius = {{ value = \"{:.4} mm\", standard = \"{:.4} mm\" }} (declared {radius_mm:.4} mm)",
            short_form(factor.value, factor.standard),
            radius_mm * factor.value,
            radius_mm * factor.standard
        )])
    }))
}
