//! Coefficients that are known from elsewhere: the mass of a body, an added mass from a record.
//!
//! They are held at their values c, so that the others are fitted to y − X_k c: β̂ = S(y − X_k c), with S = ∂β/∂y of the fit. An error of c is one that all rows
//! share; it moves the others by −S X_k and the known ones by itself, and stays in the covariance between them. A prior is another thing: the data move it.
//!
//! Source: JCGM 100:2008 (GUM), 5.2.2 and F.1.2.

use froude_fit as fit;
use froude_fit::budget::{Kind, Origin, Part, Shape};
use froude_fit::faer::Mat;
use froude_records::campaign::PriorSpec;

use crate::law::ForceLaw;
use crate::regression::fitted::Settings;
use crate::regression::known_of;

/// A line of the budget for each set of known coefficients that are correlated.
pub(crate) fn parts(law: &ForceLaw, settings: Settings<'_>, problem: &fit::Problem, fitted: &fit::Fit) -> Vec<Part> {
    let covariance = &settings.identify.known_covariance;
    let place = |known: &PriorSpec| law.coefficients.iter().position(|c| c.name == known.coefficient);
    let mut sets: Vec<Vec<(usize, usize, &PriorSpec)>> = Vec::new();
    for (k, known) in known_of(settings.identify, law) {
        let Some(j) = place(known) else { continue };
        let goes_with =
            |set: &&mut Vec<(usize, usize, &PriorSpec)>| set.iter().any(|(other, ..)| covariance[k][*other] != 0.0);
        match sets.iter_mut().find(goes_with) {
            Some(set) => set.push((k, j, known)),
            None => sets.push(vec![(k, j, known)]),
        }
    }
    sets.iter().map(|set| part(set, settings, problem, fitted)).collect()
}

fn part(set: &[(usize, usize, &PriorSpec)], settings: Settings<'_>, problem: &fit::Problem, fitted: &fit::Fit) -> Part {
    let (p, x) = (fitted.coefficients.len(), &problem.design);
    let moved = Mat::from_fn(p, set.len(), |i, k| {
        let j = set[k].1;
        if i == j {
            return 1.0;
        }
        -(0..x.nrows()).map(|row| fitted.sensitivity[(i, row)] * x[(row, j)]).sum::<f64>()
    });
    let covariance = Mat::from_fn(set.len(), set.len(), |a, b| settings.identify.known_covariance[set[a].0][set[b].0]);
    let names: Vec<&str> = set.iter().map(|(.., known)| known.coefficient.as_str()).collect();
    // Two laws that take one value from one place have its error in common.
    let values: Vec<String> = set.iter().map(|(.., known)| format!("{:e}", known.value)).collect();
    let is_named = !settings.campaign.is_empty();
    let key = is_named.then(|| format!("{}/known {}/{}", settings.campaign, names.join(" "), values.join(" ")));
    Part {
        name: format!("known {}", names.join(", ")),
        shared: "campaign",
        kind: Kind::B,
        covariance: &moved * &covariance * moved.transpose(),
        dof: vec![f64::INFINITY; p],
        shape: Shape::Normal,
        in_scatter: false,
        origin: key.map(|key| Origin {
            key,
            quantity: names.join(", "),
            covariance: covariance.clone(),
            sensitivity: moved.clone(),
            limits: None,
        }),
    }
}
