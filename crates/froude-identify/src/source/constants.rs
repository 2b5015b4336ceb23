//! Known numbers that the formulas of a campaign may name.
//!
//! | name | what | from |
//! |------|------|------|
//! | `rho`, `nu` | density, kinematic viscosity | the columns of these quantities, which `[fluid]` fills |
//! | `L` | length | `reference_length` in `[body]` |
//! | `A` | area | `reference_area` in `[body]` |
//! | `g` | standard gravity, 9.80665 m/s² | |
//! | any other | | `[constants]` |
//!
//! A column of the table with such a name comes before it; `L` and `A` that nobody declares are coefficients as any other name.

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_records::campaign::Campaign;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::formula::{Constant, aliased};
use crate::law::exponents;

/// The constants of the formulas, in SI.
///
/// # Errors
///
/// One of `[constants]` whose name means something else already.
pub(crate) fn constants(campaign: &Campaign, data: &Dataset) -> Result<Vec<Constant>, IdentifyError> {
    let body = campaign.body.as_ref();
    let length = body.and_then(|body| body.reference_length_m);
    let area = body.and_then(|body| body.reference_area_m2);
    let implied = [
        ("L", length, Dimension::LENGTH, "reference_length of [body]"),
        ("A", area, Dimension::AREA, "reference_area of [body]"),
    ];
    let mut out: Vec<Constant> = Vec::new();
    for (name, quantity) in &campaign.constants {
        let meaning =
            if let Some((.., where_from)) = implied.iter().find(|(own, value, ..)| own == name && value.is_some()) {
                Some(format!("{where_from}, which is declared too: delete one of them"))
            } else if data.channels.contains_key(name) {
                Some("a column of the table: rename one of them".to_owned())
            } else if aliased(name) != name || matches!(name.as_str(), "pi" | "Re" | "Fr") {
                let meant = if aliased(name) == name { "a number of its own" } else { aliased(name) };
                Some(format!("{meant} in formulas: rename it"))
            } else if !is_a_name(name) {
                Some("no name of a formula, which is made of letters, digits and _: rename it".to_owned())
            } else {
                None
            };
        if let Some(meaning) = meaning {
            let what = format!("[constants] {name} is {meaning}");
            return Err(IdentifyError::Campaign { place: campaign.path.display().to_string(), what });
        }
        out.push((name.clone(), quantity.value_si, exponents(quantity.unit.dimension)));
    }
    let gravity = ("g", Some(GRAVITY_M_S2), Dimension::ACCELERATION, "");
    for (name, value, dimension, _) in implied.into_iter().chain([gravity]) {
        let is_other = data.channels.contains_key(name) || campaign.constants.contains_key(name);
        if let Some(value) = value.filter(|_| !is_other) {
            out.push((name.to_owned(), value, exponents(dimension)));
        }
    }
    Ok(out)
}

/// The error of a law, with the names in it that would be known numbers if they were declared.
pub(crate) fn with_undeclared(
    error: IdentifyError,
    formulas: &IndexMap<String, String>,
    known: &[Constant],
    data: &Dataset,
) -> IdentifyError {
    let IdentifyError::Refused(problem) = error else { return error };
    let stands_in = |name: &str| {
        let words = |text: &String| text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name);
        formulas.values().any(words)
    };
    let is_unknown = |name: &str| known.iter().all(|(own, ..)| own != name) && !data.channels.contains_key(name);
    let declared = [("L", "reference_length"), ("A", "reference_area")];
    let hints = declared.into_iter().filter(|(name, _)| stands_in(name) && is_unknown(name));
    let hints = hints
        .map(|(name, key)| format!("; {name} is a coefficient here, and a known number where [body] declares {key}"));
    IdentifyError::Refused(problem + &hints.collect::<String>())
}

fn is_a_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
