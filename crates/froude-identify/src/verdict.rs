//! Whether two estimates agree: forces, coefficients and the whole vector together.
//!
//! Coefficients alone do not decide. Two that are collinear, as the linear and the quadratic term over a narrow range of speed, have wide
//! uncertainties each, while the force that they predict together is known well: each can agree and the force differ.

use froude_records::comparison::{Comparison, LargestCoefficient, LargestLoad, Verdict};

/// Chance below which a joint statistic says that two estimates differ.
const SIGNIFICANT: f64 = 0.05;

/// A verdict for each pair that has an E_n or a p: of the estimates whose loads are predicted (the recommended ones, where there are several), or,
/// where there are no loads, of all that share a coefficient.
pub(crate) fn verdicts(c: &Comparison) -> Vec<Verdict> {
    let ids = c.load_sources();
    let mut pairs: Vec<[&str; 2]> =
        ids.iter().enumerate().flat_map(|(i, a)| ids[i + 1..].iter().map(move |b| [*a, *b])).collect();
    if pairs.is_empty() {
        pairs = c.coefficients.iter().map(|r| [r.first.source.as_str(), r.second.source.as_str()]).collect();
        pairs.dedup();
    }
    pairs.into_iter().filter_map(|pair| verdict(c, pair)).collect()
}

fn verdict(c: &Comparison, pair: [&str; 2]) -> Option<Verdict> {
    let is_pair = |first: &str, second: &str| pair == [first, second] || pair == [second, first];
    let finite = |e_n: Option<f64>| e_n.filter(|x| x.is_finite());
    let load = c
        .loads
        .iter()
        .filter(|r| is_pair(&r.first.source, &r.second.source))
        .filter_map(|r| Some((finite(r.e_n)?, r)))
        .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        .map(|(e_n, r)| LargestLoad {
            component: r.component.clone(),
            n_links: r.n_links,
            speed_m_s: r.speed_m_s,
            angle_rad: r.angle_rad,
            e_n,
        });
    let coefficient = c
        .coefficients
        .iter()
        .filter(|r| is_pair(&r.first.source, &r.second.source))
        .filter_map(|r| Some((finite(r.e_n)?, r)))
        .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        .map(|(e_n, r)| LargestCoefficient {
            coefficient: r.label.clone().unwrap_or_else(|| r.coefficient.clone()),
            e_n,
        });
    // Of several models in common the least p.
    let joint = c.joint.iter().filter(|j| is_pair(&j.first, &j.second));
    let p = joint.filter_map(|j| finite(j.p)).min_by(f64::total_cmp);
    if load.is_none() && coefficient.is_none() && p.is_none() {
        return None;
    }
    let within = |e_n: Option<f64>| e_n.is_none_or(|e_n| e_n.abs() <= 1.0);
    Some(Verdict {
        first: pair[0].to_owned(),
        second: pair[1].to_owned(),
        agree: within(load.as_ref().map(|l| l.e_n))
            && within(coefficient.as_ref().map(|c| c.e_n))
            && p.is_none_or(|p| p >= SIGNIFICANT),
        load,
        coefficient,
        p,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_records::comparison::{CoefficientComparison, JointComparison, LoadComparison, Side};

    fn side(source: &str) -> Side {
        Side { source: source.to_owned(), ..Side::default() }
    }

    fn coefficient(name: &str, e_n: Option<f64>) -> CoefficientComparison {
        CoefficientComparison {
            coefficient: name.to_owned(),
            first: side("a"),
            second: side("b"),
            e_n,
            ..CoefficientComparison::default()
        }
    }

    fn load(speed_m_s: f64, [first, second]: [&str; 2], e_n: Option<f64>) -> LoadComparison {
        let component = "f_x".to_owned();
        LoadComparison {
            component,
            speed_m_s,
            first: side(first),
            second: side(second),
            e_n,
            ..LoadComparison::default()
        }
    }

    fn joint(p: f64) -> JointComparison {
        JointComparison { first: "a".to_owned(), second: "b".to_owned(), p: Some(p), ..JointComparison::default() }
    }

    #[test]
    fn coefficients_that_agree_do_not_hide_forces_or_a_vector_that_differ() {
        let mut c = Comparison {
            coefficients: vec![coefficient("D_x_I", Some(0.2)), coefficient("D_x_II", Some(-0.4))],
            loads: vec![load(0.1, ["a", "b"], Some(0.3)), load(0.4, ["a", "b"], Some(-0.7))],
            joint: vec![joint(0.6)],
            ..Comparison::default()
        };
        let [verdict] = &verdicts(&c)[..] else { panic!("one pair") };
        assert!(verdict.agree, "{verdict:?}");
        assert_eq!((verdict.load.as_ref().unwrap().speed_m_s, verdict.load.as_ref().unwrap().e_n), (0.4, -0.7));
        assert_eq!(verdict.coefficient.as_ref().unwrap().coefficient, "D_x_II");
        c.joint[0].p = Some(0.01);
        assert!(!verdicts(&c)[0].agree);
        c.joint[0].p = Some(0.6);
        c.loads[0].e_n = Some(1.5);
        assert!(!verdicts(&c)[0].agree);
        assert_eq!(verdicts(&c)[0].load.as_ref().unwrap().speed_m_s, 0.1);
    }

    #[test]
    fn estimates_of_other_laws_are_judged_by_their_forces_and_no_number_gives_no_verdict() {
        let mut c = Comparison {
            loads: vec![load(0.1, ["a", "b"], Some(0.9)), load(0.1, ["a", "c"], None)],
            ..Comparison::default()
        };
        let all = verdicts(&c);
        assert_eq!(all.len(), 1, "{all:?}");
        assert!(all[0].agree && all[0].coefficient.is_none() && all[0].p.is_none());
        c.loads[0].e_n = Some(f64::NAN);
        assert!(verdicts(&c).is_empty());
        // Parameters of a drive give no load on a body.
        c = Comparison {
            coefficients: vec![coefficient("M", Some(0.2)), coefficient("F_v", None)],
            ..Comparison::default()
        };
        let all = verdicts(&c);
        assert_eq!((all.len(), all[0].agree), (1, true), "{all:?}");
    }
}
