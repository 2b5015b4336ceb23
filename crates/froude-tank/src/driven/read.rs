//! Section, plan and budget of a campaign, read for each law.

use froude_identify::declare::Values;
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Source};
use froude_records::section::Section;

use super::matrix;
use super::method::{Declared, MotorDriven};
use super::setup::Setup;
use super::spec::Enters;
use crate::declared::{cycles, gain, needed};
use crate::error::undeclared;
use crate::logs;

/// Reads the section of a method.
pub(super) fn section<M: MotorDriven>(s: &Section<'_>) -> Result<Values, RecordError> {
    let values = Values::read(s, M::SPEC.keys)?;
    M::check(&values)?;
    M::zeroing(&values)?;
    Ok(values)
}

/// Reads section and plan of a source, so that an error in them is not passed over.
pub(super) fn check<M: MotorDriven>(source: &Source) -> Result<(), RecordError> {
    source.section(M::SPEC.name)?.map(|s| section::<M>(&s)).transpose()?;
    matrix::planned::<M>(source).map(drop)
}

/// A setup for each law that the source asks for, or for `law` alone.
///
/// # Errors
///
/// No section of the method, or one that cannot be read; a budget entry of a quantity that this method does not have, or that is no part of it.
pub fn setups<M: MotorDriven>(
    campaign: &Campaign,
    source: &Source,
    configurations: &[String],
    law: Option<&str>,
) -> Result<Vec<Setup<M>>, MethodError> {
    let values = needed(source, M::SPEC.name, section::<M>, M::SPEC.missing)?;
    let declared = Declared { campaign, source, values: &values, configurations };
    let cycles = cycles(&values)?;
    let harmonics = values.need("harmonics", values.count("harmonics"))?;
    let one = |method: M| {
        let mut constants = method.constants(&declared)?;
        for entry in &source.uncertainty {
            logs::is_of_all_runs(entry)?;
            let quantity = entry.quantity.as_str();
            let Some(constant) = constants.iter_mut().find(|c| c.quantities.contains(&quantity)) else {
                let all: Vec<&str> = constants.iter().filter_map(|c| c.quantities.first()).copied().collect();
                let what = format!(
                    "quantity = {quantity:?} is not a quantity of {}, which has {}; write the standard uncertainty of any other constant in [source.{}]",
                    M::SPEC.called,
                    all.join(", "),
                    M::SPEC.name
                );
                return Err(undeclared(&entry.place, what));
            };
            let is_gain = !matches!(constant.enters, Enters::Equation(_) | Enters::Derived);
            let part = if is_gain { gain(entry, "the zero of each run is fitted")? } else { entry.standard };
            if let Some(known) = &mut constant.known {
                known.standard = if entry.relative { part * known.value } else { part };
            }
        }
        Ok(Setup { method, constants, cycles, harmonics, zeroing: M::zeroing(&values)?, still_fits: Vec::new() })
    };
    M::read(&declared, law)?.into_iter().map(one).collect()
}
