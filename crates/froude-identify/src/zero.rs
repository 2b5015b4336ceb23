//! A load cell that was not zeroed: a load that is the same in every row, whatever the law.
//!
//! A constant is added to each law in turn and tested with Student's t. The test is exact if the law is true. Under a wrong law it is not: data with a linear and a quadratic term look offset to the
//! quadratic law. An offset is therefore reported only if it is significant with every law (fitted and default), except laws whose scatter, even with the constant, is significantly larger than that
//! of the best law. The test level is 0.5 % over all loads. Declared errors widen the test, so a declared zero is not reported.
//!
//! A row at rest is an ordinary row here, and the most informative one.

use std::collections::BTreeSet;

use froude_fit::distribution::{f_upper, t_two_sided};
use froude_records::campaign::{Source, SourceKind};
use froude_records::finding::{Finding, Severity};
use froude_records::number::{p_equation, significant};
use froude_records::text::counted;
use indexmap::IndexMap;

use crate::dataset::{Dataset, unit_text};
use crate::law::ForceLaw;
use crate::lint::motion::{AT_REST, moving};
use crate::motions;
use crate::regression::{ModelFit, Scatter, Settings, regress};
use crate::selection::widened;
use crate::source::models::{Drift, axes, polynomial, power_laws};

/// False-alarm probability, over all loads.
const LEVEL: f64 = 0.005;
/// Level of the F test that drops a law whose scatter exceeds that of the best one.
const CONTRADICTED: f64 = 0.001;

/// The default laws of a measured load, which a zero is looked for beside.
pub(crate) fn laws(source: &Source, data: &Dataset) -> Vec<ForceLaw> {
    if source.kind == SourceKind::Cfd || data.sample.is_some() {
        return Vec::new();
    }
    let polynomials = [("quadratic", false), ("linear_quadratic", true)];
    let polynomials = polynomials.into_iter().filter_map(|(name, linear)| polynomial(name, data, source, linear).ok());
    // A load of drift is no power of a speed.
    let is_askew = ["v_y", "v_z"].iter().any(|across| Drift::of(data, "v_x", across).is_askew);
    polynomials.chain(power_laws("power_law", &axes(data)).filter(|_| !is_askew)).collect()
}

/// A constant beside one law.
struct Constant {
    law: String,
    p: f64,
    value: f64,
    u: f64,
    sigma: f64,
    dof: f64,
}

/// The loads of which every law leaves a constant; `further` are laws to be asked beside those that were fitted.
pub(crate) fn findings(
    models: &[ModelFit],
    further: &[ForceLaw],
    data: &Dataset,
    settings: Settings<'_>,
) -> Vec<Finding> {
    // Where rows follow each other in time, a constant beside rows as if independent is no sign of an offset.
    let is_serial = matches!(settings.scatter, Scatter::Serial(_));
    if further.is_empty() || (motions::is_in_time(data) && !is_serial) {
        return Vec::new();
    }
    let is_same = |law: &ForceLaw, of: &ForceLaw| law.name == of.name && law.responses == of.responses;
    let further: Vec<ModelFit> = further
        .iter()
        .filter(|law| !models.iter().any(|model| is_same(law, &model.law)))
        .filter_map(|law| regress(law, data, settings).ok())
        .collect();
    let mut loads: Vec<&String> = models.iter().flat_map(|model| &model.law.responses).collect();
    loads.sort();
    loads.dedup();
    let level = LEVEL / loads.len().max(1) as f64;
    let rest = at_rest(data);
    let of_load = |load: &String| {
        // Readings at rest that are left out of σ are near zero.
        if rest.iter().any(|&i| !data.observes(load, i)) {
            return None;
        }
        let asked = models.iter().chain(&further);
        let asked = asked.filter(|m| m.law.responses.contains(load) && !m.law.in_logarithms());
        let of_all = constants(asked, load, data, settings)?;
        of_constants(&of_all, load, level, data, &rest)
    };
    loads.into_iter().filter_map(of_load).collect()
}

/// The constant beside each law; `None` where a law has one, or leaves too few rows to tell.
fn constants<'a>(
    laws: impl Iterator<Item = &'a ModelFit>,
    load: &str,
    data: &Dataset,
    settings: Settings<'_>,
) -> Option<Vec<Constant>> {
    let text = IndexMap::from([(load.to_owned(), "zero_of_the_load".to_owned())]);
    let constant = regress(&ForceLaw::formulas("constant", &text, data).ok()?, data, settings).ok()?;
    let laws: Vec<&ModelFit> = laws.collect();
    let is_plain = laws.iter().all(|law| law.whitened.is_none() && !law.is_weighted());
    let mut out = laws
        .into_iter()
        .map(|law| {
            let wide = widened(law, &constant, load, data, settings)?;
            let (along, u) = (wide.along[(0, 0)], wide.covariance[(0, 0)].sqrt());
            let component = wide.fitted.components.iter().find(|c| c.name == load)?;
            let sigma = component.sigma.filter(|sigma| *sigma > 0.0)?;
            let p = t_two_sided(wide.gamma[0] / u, wide.dof);
            let value = wide.gamma[0] / along;
            let u = u / along.abs();
            Some(Constant { law: law.law.name.clone(), p, value, u, sigma, dof: component.dof })
        })
        .collect::<Option<Vec<Constant>>>()?;
    // Weighted or whitened rows have a σ of their own.
    if !is_plain {
        return Some(out);
    }
    let best = out.iter().min_by(|a, b| a.sigma.total_cmp(&b.sigma)).map(|c| (c.sigma, c.dof))?;
    let is_left = |c: &Constant| f_upper((c.sigma / best.0).powi(2), c.dof, best.1) > CONTRADICTED;
    out.retain(is_left);
    Some(out)
}

fn of_constants(of_all: &[Constant], load: &str, level: f64, data: &Dataset, rest: &[usize]) -> Option<Finding> {
    let unit = unit_text(data, load);
    let mean = |f: &[f64]| rest.iter().map(|&i| f[i]).sum::<f64>() / rest.len() as f64;
    let rest = data.values(load).filter(|_| !rest.is_empty()).map(|f| (mean(f), rest.len()));
    let is_significant = |c: &&Constant| c.p < level;
    let least = of_all.iter().min_by(|a, b| a.p.total_cmp(&b.p))?;
    let largest = of_all.iter().max_by(|a, b| a.p.total_cmp(&b.p))?;
    if is_significant(&largest) {
        let (low, high) = of_all
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c.value), high.max(c.value)));
        let text = format!(
            "{load}: with every law ({}) a constant of {} is significant ({}){}: the load cell was not zeroed, or the rig has friction{}; the intervals do not \
             cover this. {}, or estimate it: as the offset of one group of all rows (group_offset = \"estimate\"), which `predict` leaves out, or as a constant of every law ([[identify.model]] \
             with {load} = \"F_0 + …\"), which `predict` takes for a load of the water",
            of_all.iter().map(|c| c.law.as_str()).collect::<Vec<_>>().join(", "),
            between(low, high, &unit),
            p_equation(largest.p),
            rest.map_or_else(String::new, |(mean, n)| format!(
                "; at rest it reads {} {unit} ({})",
                significant(mean, 3),
                counted(n, "row", "rows")
            )),
            if load == "f_x" { "" } else { ", or the body is not in line" },
            if rest.is_some() {
                format!("Subtract the reading at rest (column `zero_before_{load}`)")
            } else {
                format!("Record the load at rest and subtract it (column `zero_before_{load}`)")
            },
        );
        return Some(Finding::new(Severity::Warning, "load-at-rest", text));
    }
    // A law that excludes the constant of the other one has no offset as large as that.
    let is_possible = (largest.value - least.value).abs() <= 2.0 * largest.u;
    if rest.is_some() || !is_possible || !is_significant(&least) {
        return None;
    }
    let text = format!(
        "{load}: {}, none at rest, cannot distinguish a load-cell offset from a different law: with {} a constant of {} {unit} is significant ({}), with {} it is not ({}). Record the load at rest",
        counted(data.rows, "row", "rows"),
        least.law,
        significant(least.value, 2),
        p_equation(least.p),
        largest.law,
        p_equation(largest.p)
    );
    Some(Finding::new(Severity::Note, "no-row-at-rest", text))
}

fn between(low: f64, high: f64, unit: &str) -> String {
    let (a, b) = (significant(low, 2), significant(high, 2));
    if a == b { format!("{a} {unit}") } else { format!("{a} to {b} {unit}") }
}

/// The rows at rest.
fn at_rest(data: &Dataset) -> Vec<usize> {
    let Some(speed) = data.values("speed") else { return Vec::new() };
    let moves: BTreeSet<usize> = moving(speed, AT_REST).into_iter().collect();
    (0..data.rows).filter(|i| !moves.contains(i)).collect()
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use crate::small_tables::{identified_of, said};
    use crate::source::handed::TABLE;

    fn found(rows: &str, keys: &str) -> Vec<String> {
        said(rows, keys, &["load-at-rest", "no-row-at-rest"])
    }

    /// f_x = −(0.84 + 3.1 U²) N, read to 0.1 mN.
    const UNZEROED: &str =
        "0.2,-0.9626\n0.3,-1.1157\n0.4,-1.3347\n0.5,-1.6202\n0.6,-1.9524\n0.7,-2.3572\n0.8,-2.8261\n";

    #[test]
    fn an_offset_is_found_whatever_law_is_asked_for() {
        for models in ["", "models = [\"quadratic\"]\n", "models = [\"power_law\", \"power_law_log\"]\n"] {
            let found = found(UNZEROED, models);
            assert!(found.len() == 1 && found[0].contains("a constant of −0.84 N is significant"), "{found:?}");
        }
        let with_rest = found(&format!("0,-0.8430\n{UNZEROED}"), "");
        assert!(with_rest[0].contains("at rest it reads −0.843 N (1 row)"), "{with_rest:?}");
    }

    /// Each piece of advice is followed until the finding is gone.
    #[test]
    fn what_the_finding_advises_removes_it() {
        let declared = "[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"0.84 N\"\nshared = \"campaign\"\n";
        let law = "[identify]\n[[identify.model]]\nname = \"with_zero\"\nf_x = \"F_0 - D*v_x*abs(v_x)\"\n";
        let subtracted: String = UNZEROED
            .lines()
            .map(|line| {
                line.split_once(',').map(|(u, f)| format!("{u},{}\n", f.parse::<f64>().unwrap() + 0.84)).unwrap()
            })
            .collect();
        for (rows, keys) in [(UNZEROED, declared), (UNZEROED, law), (subtracted.as_str(), "")] {
            assert!(found(rows, keys).is_empty(), "{keys}: {:?}", found(rows, keys));
        }
        let of_one_group: String = UNZEROED.lines().map(|line| format!("{line},all\n")).collect();
        let keys = "group = \"tests\"\n[identify]\ngroup_offset = \"estimate\"\ncovariance = \"classical\"\n";
        let result = identified_of(&format!("speed [m/s],f_x [N],tests\n{of_one_group}"), TABLE, keys);
        assert!(result.findings.iter().all(|f| f.code != "load-at-rest"), "{:?}", result.findings);
    }

    /// A linear term takes up an offset; with a hundred rows of three speeds too.
    #[test]
    fn where_a_linear_term_takes_up_an_offset_a_reading_at_rest_is_asked_for() {
        let asked = |truth: fn(f64) -> f64, offset: f64, speeds: u32, repeats: u32| {
            let is_asked = |seed: u128| {
                let mut rng = Pcg64::new(seed, 9);
                let mut text = String::new();
                for i in 0..speeds * repeats {
                    let u = 0.4 + 0.8 * f64::from(i / repeats) / f64::from(speeds - 1);
                    let z: f64 = StandardNormal.sample(&mut rng);
                    let _ = writeln!(text, "{u},{}", -truth(u) - offset + 0.15 * z);
                }
                !found(&text, "").is_empty()
            };
            (0..100).filter(|seed| is_asked(*seed)).count()
        };
        let (unzeroed, sound) = (asked(|u| 9.0 * u * u, 0.5, 3, 14), asked(|u| 3.0 * u + 9.0 * u * u, 0.0, 40, 25));
        assert!(unzeroed >= 95, "{unzeroed} of 100 with an offset");
        assert!(sound <= 10, "{sound} of 100 with a linear term that many rows tell from one");
    }

    fn table(n: u32, seed: u128, truth: fn(f64) -> f64, offset: f64) -> String {
        let mut rng = Pcg64::new(seed, 7);
        let mut text = String::new();
        for i in 0..n {
            let u = 0.2 + 1.4 * f64::from(i) / f64::from(n - 1);
            let z: f64 = StandardNormal.sample(&mut rng);
            let _ = writeln!(text, "{u},{}", -truth(u) - offset + 0.3 * z);
        }
        text
    }

    const TRUTHS: [fn(f64) -> f64; 4] = [
        |u| 12.0 * u * u,
        |u| 3.0 * u + 9.0 * u * u,
        |u| 12.0 * u.powf(1.8),
        // The friction line of the ITTC (1957), for a length of 3 m.
        |u| 2400.0 * 0.075 / ((3e6 * u).log10() - 2.0).powi(2) * u * u,
    ];

    /// Of 300 sound tables each 0.5 % are reported and three standard deviations, at most; a tenth of the largest load is found in most of those with ten rows.
    #[test]
    fn sound_tables_are_passed_over_and_offsets_found() {
        let alarms = |n: u32, truth: fn(f64) -> f64, offset: f64| {
            let is_reported = |seed: u128| !said(&table(n, seed, truth, offset), "", &["load-at-rest"]).is_empty();
            (0..300).filter(|seed| is_reported(*seed)).count()
        };
        for truth in TRUTHS {
            for n in [5, 7, 16] {
                let sound = alarms(n, truth, 0.0);
                assert!(sound <= 5, "{n} rows: {sound} of 300");
            }
            let found = alarms(10, truth, 0.1 * truth(1.6));
            assert!(found >= 150, "10 rows: {found} of 300");
        }
    }
}
