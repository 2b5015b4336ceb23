//! Coefficients that are known from elsewhere: the mass of a body, an added mass from a record.
//!
//! They are held at their values c, so that the others are fitted to y − X_k c: β̂ = S(y − X_k c), with S = ∂β/∂y of the fit. An error of c is one that all rows
//! share; it moves the others by −S X_k and the known ones by itself, and stays in the covariance between them. A prior is another thing: the data move it.
//!
//! Source: JCGM 100:2008 (GUM), 5.2.2 and F.1.2.

use froude_fit as fit;
use froude_fit::budget::{Kind, Origin, Part, Shape};
use froude_fit::faer::Mat;
use froude_records::campaign::{Identify, PriorSpec};

use crate::law::ForceLaw;
use crate::regression::settings::Settings;

/// A line of the budget for each set of known coefficients that are correlated, as far as the law has any of it.
pub(crate) fn parts(law: &ForceLaw, settings: Settings<'_>, problem: &fit::Problem, fitted: &fit::Fit) -> Vec<Part> {
    let known = &settings.identify.known;
    let place = |k: usize| {
        let is_meant = known[k].model.as_ref().is_none_or(|model| *model == law.name);
        law.coefficients.iter().position(|c| is_meant && c.name == known[k].coefficient)
    };
    let of_law = |set: &Vec<usize>| set.iter().any(|k| place(*k).is_some());
    let part = |set: Vec<usize>| {
        let places: Vec<Option<usize>> = set.iter().map(|k| place(*k)).collect();
        part(&set, &places, settings, problem, fitted)
    };
    sets(settings.identify).into_iter().filter(of_law).map(part).collect()
}

/// Known coefficients that are correlated with one another, directly or through others.
fn sets(identify: &Identify) -> Vec<Vec<usize>> {
    let mut out: Vec<Vec<usize>> = Vec::new();
    for k in 0..identify.known.len() {
        let goes_with = |set: &Vec<usize>| set.iter().any(|other| identify.known_covariance[k][*other] != 0.0);
        let (with, mut apart): (Vec<_>, Vec<_>) = out.into_iter().partition(goes_with);
        apart.push(with.into_iter().flatten().chain([k]).collect());
        out = apart;
    }
    out
}

fn part(
    set: &[usize],
    places: &[Option<usize>],
    settings: Settings<'_>,
    problem: &fit::Problem,
    fitted: &fit::Fit,
) -> Part {
    let Settings { identify, campaign, .. } = settings;
    let (p, x) = (fitted.coefficients.len(), &problem.design);
    let moved = Mat::from_fn(p, set.len(), |i, k| match places[k] {
        None => 0.0,
        Some(j) if i == j => 1.0,
        Some(j) => -(0..x.nrows()).map(|row| fitted.sensitivity()[(i, row)] * x[(row, j)]).sum::<f64>(),
    });
    let covariance = Mat::from_fn(set.len(), set.len(), |a, b| identify.known_covariance[set[a]][set[b]]);
    let of = |text: fn(&PriorSpec) -> String| set.iter().map(|k| text(&identify.known[*k])).collect::<Vec<_>>();
    let (names, values) = (of(|known| known.coefficient.clone()), of(|known| format!("{:e}", known.value)));
    let dof = set.iter().filter_map(|k| identify.known[*k].dof).fold(f64::INFINITY, f64::min);
    // Two laws that take one value from one place have its error in common.
    let key = (!campaign.is_empty()).then(|| format!("{campaign}/known {}/{}", names.join(" "), values.join(" ")));
    Part {
        name: format!("known {}", names.join(", ")),
        shared: "campaign",
        kind: Kind::B,
        covariance: &moved * &covariance * moved.transpose(),
        dof: vec![dof; p],
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
