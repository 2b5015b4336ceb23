//! What a page says of the method.

use froude_records::campaign::Campaign;
use froude_records::estimate::{Estimate, Signs};
use indexmap::IndexSet;

use super::error_models::error_models;
use crate::answer::Answer;
use crate::result::SourceResult;

/// Frame and signs of loads on a body.
const OF_A_BODY: &str = "Loads are those that the fluid exerts on the body, in body axes: x forward, y to starboard, z down. \
                         A body towed at speed U and drift angle θ has the velocity v = (U cos θ, −U sin θ) through the water.";

/// The sentences on frame, fit, uncertainty, selection and error models that hold for these sources; where there are none, what the signs of the
/// records mean that are set side by side.
#[must_use]
pub fn sentences(campaign: &Campaign, answers: &[Answer], records: &[Estimate]) -> Vec<String> {
    let sources: Vec<&SourceResult> = answers.iter().filter_map(Answer::fitted).collect();
    let made = answers.iter().filter(|answer| answer.fitted().is_none()).flat_map(Answer::estimates);
    let made = made.map(|estimate| format!("{}: {}.", estimate.source, estimate.method.words));
    let made: IndexSet<String> = made.collect();
    // Nothing was fitted to loads: of least squares there is nothing to say.
    if sources.is_empty() && !answers.is_empty() {
        return made.into_iter().collect();
    }
    if answers.is_empty() {
        let signs: IndexSet<&str> = records.iter().map(|estimate| estimate.signs.0.as_str()).collect();
        let of_a_body = Signs::default();
        let sentence = |signs: &str| match signs {
            _ if signs == of_a_body.0 => OF_A_BODY.to_owned(),
            other => format!("Signs: {other}."),
        };
        return signs.into_iter().map(sentence).collect();
    }
    let mut out = vec![OF_A_BODY.to_owned()];
    out.push(
        "Coefficients are estimated by least squares with orthogonal factorisation. Each load component has its own \
         residual standard deviation and degrees of freedom. Type A uncertainty comes from the scatter about the law; \
         type B from the declared budget, whose shared errors do not average down (GUM, JCGM 100:2008). Intervals are \
         95 %, from Student's t with effective degrees of freedom (Welch–Satterthwaite)."
            .to_owned(),
    );
    let bounded = sources.iter().flat_map(|s| &s.models).any(|m| m.options.bounds.iter().any(|b| b.lower == 0.0));
    if bounded {
        out.push(
            "Coefficients are bounded below by zero, as the campaign asks. Where one is at its bound, the values \
             are those of the constrained fit and the intervals those of the unconstrained fit, cut at the bounds: a value need not be in the middle of its interval."
                .to_owned(),
        );
    }
    if sources.iter().any(|s| s.models.len() > 1) {
        out.push(
            "The recommended force law is the simplest that the data do not contradict. A law is contradicted if the terms of another one, added to it, differ from zero (F tests, \
             0.5 % in total). The 95 % interval of a coefficient is valid if its law is true. The range of a coefficient is the envelope of its \
             intervals in all laws that contain it and are not contradicted, and the band of a load is the envelope of their bands; both are valid whichever of the compared laws is true."
                .to_owned(),
        );
    }
    out.extend(sources.iter().copied().flat_map(error_models));
    out.extend(made);
    if let Some(rho) = campaign.fluid.density_kg_m3 {
        out.push(format!("Water density {rho} kg/m³ is stated by the campaign."));
    }
    out
}
