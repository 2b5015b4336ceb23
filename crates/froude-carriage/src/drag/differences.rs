//! D_d by differences of runs.

use froude_fit::budget::{Kind, Part, Uncertain, jackknife_of_one};
use froude_identify::IdentifyError;
use froude_identify::seam::fit;
use froude_records::campaign::Identify;

use crate::drag::coefficient::Coefficient;
use crate::drag::detectability::Detectability;
use crate::drag::observed::Observed;
use crate::drag::point::{Point, pairs};
use crate::drag::record;
use crate::drag::setup::DragSetup;

/// F = F₀ sgn v + D v|v|: F₀ with its uncertainty over pairs.
pub(crate) fn offset(points: &[Point]) -> Option<Uncertain> {
    let fit = |skip: Option<u32>| {
        let (mut n, mut x1, mut x2, mut y0, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in points.iter().filter(|p| Some(p.pair) != skip) {
            let (x, y) = (p.speed_m_s * p.speed_m_s, p.force_n * p.speed_m_s.signum());
            n += 1.0;
            x1 += x;
            x2 += x * x;
            y0 += y;
            xy += x * y;
        }
        let determinant = n * x2 - x1 * x1;
        // Points at one speed do not tell a constant from a square.
        (determinant > 1e-6 * n * x2).then(|| (x2 * y0 - x1 * xy) / determinant)
    };
    let pairs = pairs(points);
    let (standard, dof) = jackknife_of_one(pairs.len(), |g| fit(Some(pairs[g])))?;
    Some(Uncertain { value: fit(None)?, standard, dof })
}

/// D_d from wet-minus-dry differences, its scatter compared with what the dry repeats show; `None` without a moving point.
///
/// # Errors
///
/// Numbers that leave what a computer holds.
pub fn of_differences(
    points: Vec<Point>,
    promised: Option<&Detectability>,
    setup: &DragSetup,
) -> Result<Option<Coefficient>, IdentifyError> {
    coefficient(Observed::of_differences(points, promised, setup), setup)
}

/// D_d of points already in newtons, by the common fit; `None` without a moving point.
pub(super) fn coefficient(observed: Observed, setup: &DragSetup) -> Result<Option<Coefficient>, IdentifyError> {
    let Some(reduced) = record::reduced(&observed, setup)? else { return Ok(None) };
    let result = fit(reduced, &Identify::default(), &|_| {})?;
    let model = &result.models[0];
    let (value, stated) = (model.coefficients[0], model.combined[0]);
    // Without pairs or runs to leave out nothing tells the scatter.
    let counts = |part: &&Part| match part.kind {
        Kind::A => stated.is_some(),
        _ => part.standard(0) > 0.0,
    };
    let budget: Vec<Part> = model.budget.iter().filter(counts).cloned().collect();
    let declared = |part: &&Part| part.kind.is_type_b() && !part.in_scatter;
    let Observed { method, points, .. } = observed;
    Ok(Some(Coefficient {
        method,
        value,
        standard: stated.map(|c| c.standard),
        type_a: stated.map(|c| c.type_a),
        type_b: budget.iter().filter(declared).map(|part| part.covariance[(0, 0)]).sum::<f64>().sqrt(),
        dof: stated.map_or(f64::NAN, |c| c.dof),
        interval_95: stated.map(|c| c.interval(value)),
        looks: setup.looks,
        pairs: pairs(&points).len(),
        offset_n: offset(&points),
        budget,
        points,
        result,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::point::{Method, slope};

    fn point(pair: u32, speed_m_s: f64, force_n: f64) -> Point {
        Point {
            run: String::new(),
            speed_m_s,
            force_n,
            standard_n: 0.01,
            effective_n: 10.0,
            pair,
            position_m: [0.0, 1.0],
            trend_n: None,
        }
    }

    /// Equal pairs: the jackknife is the standard deviation of the pairs' slopes over √pairs.
    #[test]
    fn the_scatter_of_equal_pairs_is_that_of_their_means() {
        let d = [19.0, 20.5, 20.1, 19.8];
        let points: Vec<Point> =
            (0..4).flat_map(|k| [0.2, -0.5].map(|v: f64| point(k, v, d[k as usize] * v * v.abs()))).collect();
        let mean = d.iter().sum::<f64>() / 4.0;
        let s = (d.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 3.0).sqrt();
        let c = of_differences(points.clone(), None, &DragSetup::of_the_paper()).unwrap().unwrap();
        let scatter = &c.budget[0];
        assert!((scatter.standard(0) - s / 2.0).abs() < 1e-12 && scatter.dof == [3.0], "{scatter:?}");
        assert!((slope(&points).unwrap() - mean).abs() < 1e-12);
    }

    #[test]
    fn a_constant_force_beside_the_drag_is_reported() {
        let points: Vec<Point> = (0..3)
            .flat_map(|k| {
                [0.1, 0.3, -0.5]
                    .map(|v: f64| point(k, v, 20.0 * v * v.abs() - (0.6 + 0.01 * f64::from(k)) * v.signum()))
            })
            .collect();
        let offset = offset(&points).unwrap();
        assert!((offset.value + 0.61).abs() < 1e-9 && offset.standard < 0.01, "{offset:?}");
    }

    #[test]
    fn one_pair_alone_says_so_and_one_run_alone_has_no_interval() {
        let setup = DragSetup::of_the_paper();
        let of = |points: Vec<Point>| coefficient(Observed::of(Method::Fsm, points, &setup), &setup).unwrap().unwrap();
        let alone = of(vec![point(1, 0.5, 5.0)]);
        assert!(alone.interval_95.is_none() && (alone.value - 20.0).abs() < 1e-12);
        let pair = of(vec![point(1, 0.5, 5.0), point(1, 0.3, 1.9)]);
        assert_eq!(pair.budget[0].shared, "run");
        assert!(pair.interval_95.is_some());
    }
}
