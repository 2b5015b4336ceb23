//! Sources side by side: E_n per coefficient, a joint χ², and predicted forces.
//!
//! Coefficients of one model are compared with those of the same model only:
//! C_f of f1 and C_f of f6 share a name and nothing else. A published value
//! without uncertainty is shown as such; it never counts as exact.
//!
//! E_n = (a − b)/√(U_a² + U_b²) with U the expanded (95 %) uncertainties, where they have no error in common
//! (ISO 13528:2022, 9.7): |E_n| ≤ 1 says that the two agree within them.
//! U = k·u with k from Student's t of the effective degrees of freedom; 1.96
//! where the record states none, and [`Comparison::coverage`] says so.
//!
//! An interval that reaches to one side, or pays for looks, has the arm that points to the other value as its U.
//!
//! Errors that two records know by one key are one error: u²(a − b) = u_a² + u_b² − 2 cov(a, b) (GUM 5.2.2), and the part that is
//! common is removed from E_n and χ² exactly. Scatter from the same observations cannot be: two fits to the same
//! table or the same runs get [`SAME_DATA`] and no number.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use faer::Mat;
use faer::linalg::solvers::Solve;
use froude_fit::distribution::f_upper;
use froude_records::comparison::{
    CoefficientComparison, Comparison, JointComparison, LoadComparison, Side, coverage_note,
};
use froude_records::estimate::{Coefficient, DataFile, Estimate, EstimateFile, Range, Status};
use froude_records::finding::{Finding, Severity};
use froude_records::units::Dimension;

use crate::common::{self, Common, Number};
use crate::dataset::Dataset;
use crate::law::ForceLaw;
use crate::uncertainty::coverage_factor;
use crate::verdict::verdicts;

/// Speeds and angles at which forces are predicted, per axis of the common range.
const FORCE_POINTS: usize = 5;

/// Coverage factor where no degrees of freedom are stated: two-sided 95 % of the normal distribution.
const NORMAL_COVERAGE: f64 = 1.959_963_984_540_054;

/// The text in place of E_n where two estimates come from the same observations.
pub const SAME_DATA: &str = "same data: not independent, E_n not meaningful";
/// The text in place of χ² there.
const SAME_DATA_JOINTLY: &str = "same data: not independent, χ² not meaningful";

/// A number as one estimate states it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stated {
    pub value: Option<f64>,
    /// Standard uncertainty, in the unit of the value; `None` where none is stated.
    pub standard: Option<f64>,
    /// Effective degrees of freedom of it; `None` where the record states no finite ones.
    pub dof: Option<f64>,
}

impl Stated {
    /// As a side of a comparison: with the coverage factor k of the 95 % uncertainty U = k·u.
    fn of(self, source: &str) -> Side {
        let coverage_factor = self.standard.map(|_| self.dof.map_or(NORMAL_COVERAGE, coverage_factor));
        Side {
            source: source.to_owned(),
            value: self.value,
            standard_uncertainty: self.standard,
            effective_dof: self.dof,
            coverage_factor,
            expanded_uncertainty: coverage_factor.zip(self.standard).map(|(k, u)| k * u),
        }
    }
}

/// E_n and an empty note, or none and why.
fn noted(e_n: Result<f64, String>) -> (Option<f64>, String) {
    match e_n {
        Ok(e_n) => (Some(e_n), String::new()),
        Err(why) => (None, why),
    }
}

/// An estimate with the record that it comes from.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// The file, as the user named it.
    pub file: &'a str,
    /// The record in it, with the fingerprints of its data.
    pub record: &'a EstimateFile,
    /// The estimate.
    pub estimate: &'a Estimate,
}

/// All estimates of some files.
#[must_use]
pub fn named<'a>(files: &'a [(String, EstimateFile)]) -> Vec<Named<'a>> {
    files
        .iter()
        .flat_map(|(file, record)| record.estimates.iter().map(move |estimate| Named { file, record, estimate }))
        .collect()
}

/// Estimates named where nothing could be compared.
const MOST_NAMED: usize = 6;
/// Most estimates that are set side by side: 44,850 pairs, more than anybody reads.
pub const MOST_COMPARED: usize = 300;

/// Compares every pair of estimates of the same model, and predicts forces by the recommended ones.
///
/// More than [`MOST_COMPARED`] are not compared; the only finding says so.
///
/// E_n = (a − b)/U(a − b) for each coefficient and each predicted load, χ² = dᵀ(C_a + C_b − C_ab − C_abᵀ)⁻¹d for all coefficients of a pair together;
/// both are dimensionless, values and uncertainties have the units of the records.
///
/// # Source
///
/// ISO 13528:2022, 9.7 (E_n); JCGM 100:2008 (GUM), 5.2.2 (common errors) and G.4.1 (degrees of freedom).
#[must_use]
pub fn compare(all: &[Named<'_>]) -> Comparison {
    let mut out = Comparison::default();
    if all.len() > MOST_COMPARED {
        out.findings.push(Finding::new(Severity::Warning, "not-compared", too_many(all.len())));
        return out;
    }
    let (origins, labels) = (origins(all), labels(all));
    let mut told: BTreeSet<[(&str, &str); 2]> = BTreeSet::new();
    let mut shared: BTreeMap<[(&str, &str); 2], Vec<Common<'_>>> = BTreeMap::new();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            let is_same_data = same_data([a, b], [&origins[i], &origins[j]]);
            let pair = [(a.file, a.estimate.source.as_str()), (b.file, b.estimate.source.as_str())];
            if is_same_data && !is_one_source(a, b) && told.insert(pair) {
                out.findings.push(same_data_finding(a, b));
            }
            // Two methods of one source are not independent, and each is compared with its own kind where there is one.
            if a.estimate.law.name != b.estimate.law.name || is_one_source(a, b) || has_likes(all, a, b) {
                continue;
            }
            let methods = [a, b].map(|n| n.estimate.method.name.as_str());
            // An old record does not say its method.
            let is_one_method = methods[0] == methods[1] || methods.contains(&"");
            if a.estimate.source == b.estimate.source && is_one_method && !have_other_tables([&origins[i], &origins[j]])
            {
                out.findings.extend(contradiction(a, b));
            }
            let common = Common::of(a.estimate, b.estimate);
            let ids = [labels[i].as_str(), &labels[j]];
            out.coefficients.extend(coefficient_rows([a, b], ids, &common, is_same_data));
            let has_common = a.estimate.coefficients.keys().any(|name| b.estimate.coefficients.contains_key(name));
            if has_common {
                out.joint.push(joint([a, b], ids, &common, is_same_data));
            }
            if !is_same_data {
                let of_pair = shared.entry(pair).or_default();
                if of_pair.is_empty() {
                    out.findings.extend(axes_not_tied(a.estimate, b.estimate));
                }
                of_pair.push(common);
            }
        }
    }
    out.findings.extend(shared.into_values().flat_map(|all| common::findings(&all)));
    out.findings.extend(differing_constants(all));
    predict_forces(all, &labels, &mut out);
    out.verdicts = verdicts(&out);
    out
}

/// That no two estimates have anything in common, and what each has: for a command that asks for a comparison only.
#[must_use]
pub fn nothing_compared(all: &[Named<'_>], out: &Comparison) -> Option<Finding> {
    let is_said = out.findings.iter().any(|f| matches!(f.code.as_str(), "no-common-range" | "not-compared"));
    if is_said || !out.is_empty() {
        return None;
    }
    let each = all.iter().map(|n| {
        let estimate = n.estimate;
        let loads: Vec<&str> = estimate.law.outputs.keys().map(String::as_str).collect();
        let law = if loads.is_empty() { "no formula".to_owned() } else { loads.join(", ") };
        format!("{} ({}; {law})", estimate.id, estimate.law.name)
    });
    let each: Vec<String> = each.take(MOST_NAMED).collect();
    let more = if all.len() > MOST_NAMED { format!(" and {} more", all.len() - MOST_NAMED) } else { String::new() };
    Some(Finding::new(
        Severity::Warning,
        "nothing-compared",
        format!(
            "nothing could be compared: no two estimates have the same model, and fewer than two give forces over a common range of \
             speed; there are {}{more}",
            each.join(", ")
        ),
    ))
}

/// Which estimates are compared with no other, and why: for a command that asks for a comparison only.
#[must_use]
pub fn left_out(all: &[Named<'_>], out: &Comparison) -> Option<Finding> {
    let of_rows = out.coefficients.iter().flat_map(|row| [&row.first, &row.second]);
    let of_loads = out.loads.iter().flat_map(|row| [&row.first, &row.second]);
    let seen: BTreeSet<&str> = of_rows.chain(of_loads).map(|side| side.source.as_str()).collect();
    let is_seen = |n: &&Named<'_>| {
        let id = &n.estimate.id;
        seen.contains(id.as_str()) || seen.contains(format!("{id} ({})", n.file).as_str())
    };
    let why = |n: &Named<'_>| {
        let is_alike = |other: &&Named<'_>| other.estimate.law.name == n.estimate.law.name && !is_one_source(n, other);
        let alike: Vec<&Named<'_>> = all.iter().filter(is_alike).collect();
        let why = match alike.len() {
            1.. if alike.iter().any(|other| !has_likes(all, n, other)) => {
                "the other sources' estimates by its model have no coefficient in common with it"
            }
            1.. => "its method is compared with its own kind only",
            0 if gives_forces(n.estimate) => {
                "no other source has its model, and forces are compared for recommended models only"
            }
            0 => "no other source has its model, and it gives no force along or across from a steady motion",
        };
        format!("{} ({}): {why}", n.estimate.id, n.estimate.law.name)
    };
    let alone: Vec<String> = all.iter().filter(|n| !is_seen(n)).map(why).collect();
    if alone.is_empty() || out.is_empty() {
        return None;
    }
    let more = alone.len().saturating_sub(MOST_NAMED);
    let more = if more > 0 { format!("; and {more} more") } else { String::new() };
    let alone: Vec<String> = alone.into_iter().take(MOST_NAMED).collect();
    Some(Finding::new(Severity::Note, "beside-no-other", format!("compared with no other: {}{more}", alone.join("; "))))
}

/// Why so many estimates are not compared.
#[must_use]
pub fn too_many(estimates: usize) -> String {
    format!(
        "{estimates} estimates are not compared: at most {MOST_COMPARED} are; name fewer records, or fewer models in them"
    )
}

/// What each estimate is called: its id, with its file where two files have it.
fn labels(all: &[Named<'_>]) -> Vec<String> {
    let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
    for n in all {
        *ids.entry(&n.estimate.id).or_default() += 1;
    }
    let label = |n: &Named<'_>| {
        let id = &n.estimate.id;
        if ids[id.as_str()] > 1 { format!("{id} ({})", n.file) } else { id.clone() }
    };
    all.iter().map(label).collect()
}

/// What is read as something else than observations: it is the same error under its own key, or no error at all.
const NOT_OBSERVED: [&str; 4] = ["campaign", "sidecar", "record", "calibration"];

/// Whether a file holds observations; an old record does not say what it read a file as.
fn is_observed(data: &DataFile) -> bool {
    let is_table = |path: &str| {
        Path::new(path).extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml") && !e.eq_ignore_ascii_case("json"))
    };
    !data.sha256.is_empty()
        && data.role.as_deref().map_or_else(|| is_table(&data.path), |role| !NOT_OBSERVED.contains(&role))
}

/// Fingerprints of the observations among files.
fn fingerprints<'a>(files: impl Iterator<Item = &'a DataFile>) -> BTreeSet<&'a str> {
    files.filter(|data| is_observed(data)).map(|data| data.sha256.as_str()).collect()
}

/// Where an estimate comes from, as far as its record shows.
struct Origin<'a> {
    /// Fingerprints of its tables or runs.
    tables: BTreeSet<&'a str>,
    /// Whether these are its own, and not those of all estimates of its record.
    is_exact: bool,
    /// Whether all estimates of the record are of this one's source.
    is_alone: bool,
}

/// The origin of each estimate.
fn origins<'a>(all: &[Named<'a>]) -> Vec<Origin<'a>> {
    let of = |n: &Named<'a>| {
        let own = fingerprints(n.record.data_of(n.estimate));
        let is_exact = !own.is_empty();
        let first = n.record.estimates.first().map(|e| &e.source);
        let is_alone = || n.record.estimates.iter().all(|e| Some(&e.source) == first);
        if is_exact {
            Origin { tables: own, is_exact, is_alone: true }
        } else {
            Origin { tables: fingerprints(n.record.data.values()), is_exact, is_alone: is_alone() }
        }
    };
    all.iter().map(of).collect()
}

/// True for two models of one source in one record, which are not independent.
fn is_one_source(a: &Named<'_>, b: &Named<'_>) -> bool {
    std::ptr::eq(a.record, b.record) && a.estimate.source == b.estimate.source
}

/// True for two methods, of two sources that each have an estimate of the same law by the other's method too.
fn has_likes(all: &[Named<'_>], a: &Named<'_>, b: &Named<'_>) -> bool {
    let has = |source: &Named<'_>, method: &str| {
        all.iter().any(|n| {
            is_one_source(n, source)
                && n.estimate.law.name == source.estimate.law.name
                && n.estimate.method.name == method
        })
    };
    let [of_a, of_b] = [a, b].map(|n| n.estimate.method.name.as_str());
    // In this order: most pairs are of one method, and nothing is searched for them.
    of_a != of_b && has(a, of_b) && has(b, of_a)
}

/// True where both records name their tables and none of them is the same.
fn have_other_tables([a, b]: [&Origin<'_>; 2]) -> bool {
    !a.tables.is_empty() && !b.tables.is_empty() && a.tables.is_disjoint(&b.tables)
}

/// True where two estimates come from the same observations, as far as their records show.
///
/// A record says which files each estimate came from. An old one names its tables, but not which source read which: there a shared table counts where that is plain (one table, or
/// one source), and else if the sources have the same name or the same observations (number and ranges). Without
/// fingerprints only an equal fit is known to be the same.
fn same_data([a, b]: [&Named<'_>; 2], [first, second]: [&Origin<'_>; 2]) -> bool {
    let (x, y) = (a.estimate, b.estimate);
    if is_one_source(a, b) || x == y {
        return true;
    }
    let values = |e: &Estimate| e.coefficients.iter().map(|(n, c)| (n.clone(), c.value)).collect::<Vec<_>>();
    let same_observations = x.n_observations > 0 && x.n_observations == y.n_observations && x.validity == y.validity;
    if same_observations && x.law.name == y.law.name && x.sigma == y.sigma && values(x) == values(y) {
        return true;
    }
    if first.is_exact && second.is_exact {
        return !first.tables.is_disjoint(&second.tables);
    }
    if std::ptr::eq(a.record, b.record) {
        // Fitted sources read tables; a published one beside them does not.
        return first.tables.len() == 1 && x.n_observations > 0 && y.n_observations > 0;
    }
    let is_plain = |own: &Origin<'_>| own.tables.len() == 1 || own.is_alone;
    !first.tables.is_disjoint(&second.tables)
        && ((is_plain(first) && is_plain(second)) || x.source == y.source || same_observations)
}

fn same_data_finding(a: &Named<'_>, b: &Named<'_>) -> Finding {
    Finding::new(
        Severity::Warning,
        "same-data",
        format!(
            "{} ({}) and {} ({}) come from the same data: that they agree is no evidence, and E_n and χ², which assume \
             independent measurements, are not given",
            a.estimate.source, a.file, b.estimate.source, b.file
        ),
    )
}

fn coefficient_rows(
    [a, b]: [&Named<'_>; 2],
    [first, second]: [&str; 2],
    common: &Common<'_>,
    is_same_data: bool,
) -> Vec<CoefficientComparison> {
    a.estimate
        .coefficients
        .iter()
        .filter_map(|(name, x)| b.estimate.coefficients.get(name).map(|y| (name, x, y)))
        .map(|(name, x, y)| {
            let e_n = if x.unit == y.unit {
                let sides = [Number::of_coefficient(a.estimate, name), Number::of_coefficient(b.estimate, name)];
                e_n([&sides[0], &sides[1]], common, [first, second], is_same_data)
                    .and_then(|e_n| not_free(x, first).or_else(|| not_free(y, second)).map_or(Ok(e_n), Err))
            } else {
                Err(format!("units differ: {} and {}", x.unit, y.unit))
            };
            let (e_n, note) = noted(e_n);
            CoefficientComparison {
                model: a.estimate.law.name.clone(),
                coefficient: name.clone(),
                label: x.label.clone().or_else(|| y.label.clone()),
                unit: x.unit.clone(),
                first: stated(x).of(first),
                second: stated(y).of(second),
                e_n,
                note,
            }
        })
        .collect()
}

/// Why a coefficient is no measurement that stands by itself: a bound, whose uncertainty is that of the fit without it, or
/// a fit to a published value, which may be the other side.
fn not_free(c: &Coefficient, id: &str) -> Option<String> {
    match c.status {
        Status::AtBound => Some(format!("at its bound in {id}")),
        Status::Prior => Some(format!("rests on a published value in {id}")),
        _ => None,
    }
}

fn stated(c: &Coefficient) -> Stated {
    Stated { value: c.value, standard: c.standard_uncertainty, dof: c.effective_dof }
}

/// E_n of two numbers, or why there is none.
fn e_n(sides: [&Number<'_>; 2], common: &Common<'_>, ids: [&str; 2], is_same_data: bool) -> Result<f64, String> {
    let [Some(a), Some(b)] = sides.map(|side| side.stated.value) else { return Err("undetermined".to_owned()) };
    let without: Vec<&str> =
        sides.into_iter().zip(ids).filter(|(side, _)| side.stated.standard.is_none()).map(|(_, id)| id).collect();
    if !without.is_empty() {
        return Err(format!("no uncertainty stated by {}", without.join(" and ")));
    }
    if is_same_data {
        return Err(SAME_DATA.to_owned());
    }
    let u = common.expanded_difference(sides, a - b);
    if u > 0.0 { Ok((a - b) / u) } else { Err("both uncertainties are zero".to_owned()) }
}

/// χ² = dᵀC⁻¹d over the coefficients that both estimate, C = C_a + C_b less what common errors make of the covariance between them.
fn joint(
    [a, b]: [&Named<'_>; 2],
    [first, second]: [&str; 2],
    common: &Common<'_>,
    is_same_data: bool,
) -> JointComparison {
    let result = (|| {
        let (ca, cb) = (a.estimate.covariance(), b.estimate.covariance());
        let (Some(ca), Some(cb)) = (&ca, &cb) else {
            let without: Vec<&str> =
                [(&ca, first), (&cb, second)].into_iter().filter(|(c, _)| c.is_none()).map(|(_, id)| id).collect();
            return Err(format!("no covariance matrix stated by {}", without.join(" and ")));
        };
        if is_same_data {
            return Err(SAME_DATA_JOINTLY.to_owned());
        }
        let names: Vec<&String> = ca.names.iter().filter(|n| cb.names.contains(n)).collect();
        for (n, id) in [(a, first), (b, second)] {
            let mut constrained = names.iter().filter_map(|name| n.estimate.coefficients.get(*name));
            if let Some(why) = constrained.find_map(|c| not_free(c, id)) {
                return Err(format!("a coefficient is {why}: χ² is for estimates that are free"));
            }
        }
        if names.is_empty() {
            return Err("no coefficient is estimated by both".to_owned());
        }
        let value = |e: &Estimate, n: &str| e.coefficients.get(n).and_then(|c| c.value).unwrap_or(f64::NAN);
        let at = |c: &froude_records::estimate::Covariance, p: &str, q: &str| {
            let i = c.names.iter().position(|n| n == p);
            let j = c.names.iter().position(|n| n == q);
            i.zip(j).and_then(|(i, j)| c.matrix.get(i).and_then(|r| r.get(j)).copied()).unwrap_or(f64::NAN)
        };
        let m = names.len();
        let cross = |p: &str, q: &str| common.covariance([p, q]) + common.covariance([q, p]);
        let sum = Mat::from_fn(m, m, |i, j| {
            at(ca, names[i], names[j]) + at(cb, names[i], names[j]) - cross(names[i], names[j])
        });
        // Scaled to unit diagonal: the coefficients' sizes differ by orders of magnitude.
        let scale: Vec<f64> = (0..m).map(|i| sum[(i, i)].sqrt()).collect();
        let correlation = Mat::from_fn(m, m, |i, j| sum[(i, j)] / (scale[i] * scale[j]));
        let d = Mat::from_fn(m, 1, |i, _| (value(a.estimate, names[i]) - value(b.estimate, names[i])) / scale[i]);
        let solved = correlation
            .llt(faer::Side::Lower)
            .map_err(|_| "the joint covariance is not positive definite".to_owned())?
            .solve(&d);
        let chi2: f64 = (0..m).map(|i| d[(i, 0)] * solved[(i, 0)]).sum();
        if !chi2.is_finite() {
            return Err("a covariance is not finite".to_owned());
        }
        let dof = if common.is_empty() {
            least_dof([a, b], &names)
        } else {
            common.least_dof([a.estimate, b.estimate], &names)
        };
        Ok((chi2, m, probability(chi2, m, dof)))
    })();
    let (model, first, second) = (a.estimate.law.name.clone(), first.to_owned(), second.to_owned());
    match result {
        Ok((chi_squared, dof, p)) => JointComparison {
            chi_squared: Some(chi_squared),
            dof: Some(dof),
            p: Some(p),
            note: String::new(),
            model,
            first,
            second,
        },
        Err(note) => JointComparison { note, model, first, second, ..JointComparison::default() },
    }
}

/// Fewest degrees of freedom that one of the coefficients has; infinite where none are stated.
fn least_dof(sides: [&Named<'_>; 2], names: &[&String]) -> f64 {
    sides
        .iter()
        .flat_map(|n| names.iter().filter_map(|name| n.estimate.coefficients.get(*name)?.effective_dof))
        .fold(f64::INFINITY, f64::min)
}

/// Probability of a χ² as large, for covariances known with ν degrees of freedom: χ²/m is taken as F(m, ν), as Hotelling's
/// T² is but for its factor (ν − m + 1)/ν.
fn probability(chi2: f64, m: usize, dof: f64) -> f64 {
    f_upper(chi2 / m as f64, m as f64, dof)
}

/// Two records of the same source and model that say different things, with what looks like a slip.
fn contradiction(a: &Named<'_>, b: &Named<'_>) -> Option<Finding> {
    let value = |n: &Named<'_>, name: &str| n.estimate.coefficients.get(name).and_then(|c| c.value);
    let differing: Vec<(&String, f64, f64)> = a
        .estimate
        .coefficients
        .keys()
        .filter_map(|name| Some((name, value(a, name)?, value(b, name)?)))
        .filter(|(name, x, y)| {
            // What rounding leaves of a number that is nearly zero is small against its uncertainty.
            let standard = |n: &Named<'_>| n.estimate.coefficients[*name].standard_uncertainty.unwrap_or(0.0);
            let rounding = (1e-9 * x.abs().max(y.abs())).max(1e-3 * standard(a).min(standard(b)));
            (x - y).abs() > rounding
        })
        .collect();
    if differing.is_empty() {
        return None;
    }
    let mut slips = Vec::new();
    for (i, (p, p_a, p_b)) in differing.iter().enumerate() {
        for (q, q_a, q_b) in &differing[i + 1..] {
            if p_a == q_b && q_a == p_b {
                slips.push(format!("the values of {p} and {q} are exchanged ({p_a} and {q_a})"));
            }
        }
        if digits_exchanged(*p_a, *p_b) {
            slips.push(format!("{p}: {p_a} and {p_b} differ by two exchanged digits"));
        }
    }
    let list: Vec<String> = differing.iter().map(|(n, x, y)| format!("{n} {x} against {y}")).collect();
    let slips = if slips.is_empty() { String::new() } else { format!("; {}", slips.join("; ")) };
    Some(
        Finding::new(
            Severity::Error,
            "contradiction",
            format!(
                "{} states different values for the same fit in {} and {}: {}{slips}",
                a.estimate.id,
                a.file,
                b.file,
                list.join(", ")
            ),
        )
        .of_source(&a.estimate.source),
    )
}

/// True where the decimal digits of two numbers differ by one exchange of two digits.
fn digits_exchanged(a: f64, b: f64) -> bool {
    let (x, y) = (format!("{a}"), format!("{b}"));
    let (x, y) = (x.as_bytes(), y.as_bytes());
    if x.len() != y.len() {
        return false;
    }
    let wrong: Vec<usize> = (0..x.len()).filter(|&i| x[i] != y[i]).collect();
    matches!(wrong.as_slice(), [i, j] if x[*i] == y[*j] && x[*j] == y[*i])
}

/// Relative difference of density that a dimensional coefficient shows: a tenth of fresh against sea water.
const DENSITY_MATTERS: f64 = 0.002;

/// Densities of two estimates that differ, where the coefficients depend on them.
fn density_differs(a: &Estimate, b: &Estimate) -> Option<Finding> {
    let (x, y) = (a.density()?, b.density()?);
    let has_dimension = |e: &Estimate| e.coefficients.values().any(|c| c.unit.contains("kg") || c.unit.contains('N'));
    ((x.value - y.value).abs() > DENSITY_MATTERS * x.value && (has_dimension(a) || has_dimension(b))).then(|| {
        Finding::new(
            Severity::Warning,
            "density-differs",
            format!(
                "{} was measured in water of {} {}, {} in {} {}: coefficients with kg or N in their unit, and the forces that they give, depend on \
                 the density; scale one of them before comparing",
                a.id, x.value, x.unit, b.id, y.value, y.unit
            ),
        )
    })
}

/// Forces of a carriage, which has no axis of the body, beside those in body axes.
fn axes_not_tied(a: &Estimate, b: &Estimate) -> Option<Finding> {
    let (chain, body) = match [a, b].map(|e| e.frame.is_chain()) {
        [true, false] => (a, b),
        [false, true] => (b, a),
        _ => return None,
    };
    Some(Finding::new(
        Severity::Warning,
        "axes-not-tied",
        format!(
            "{} is along the chain of its carriage, {} in body axes: their f_x are compared as if the body had been towed along its x \
             axis; if it was towed across it, they are two different forces. Declare it by travel = \"x\" (or \"y\") in [body] of the carriage's campaign; of runs that are driven already, in \
             a campaign that `froude carriage drag --campaign` names",
            chain.id, body.id
        ),
    ))
}

/// Geometry or density that differ between estimates of one model: coefficients then mean different things.
fn differing_constants(all: &[Named<'_>]) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            if a.estimate.law.name != b.estimate.law.name || is_one_source(a, b) {
                continue;
            }
            out.extend(density_differs(a.estimate, b.estimate));
            for (key, x) in a.estimate.refers_to.iter().filter(|(key, _)| *key != "density") {
                if let Some(y) = b.estimate.refers_to.get(key)
                    && (x.value - y.value).abs() > 1e-9 * x.value.abs()
                {
                    out.push(Finding::new(
                        Severity::Warning,
                        "geometry-differs",
                        format!(
                            "{} and {} refer to different bodies ({key} {} {} and {} {}): compare their forces, not their coefficients",
                            a.estimate.id, b.estimate.id, x.value, x.unit, y.value, y.unit
                        ),
                    ));
                }
            }
        }
    }
    out
}

/// Whether an estimate's law gives forces along the body or across it from the motion that is set side by side; others have no part in its range.
fn gives_forces(estimate: &Estimate) -> bool {
    let one = Range { low: 1.0, high: 1.0, unit: String::new() };
    let data = operating_points(&one, &one, &[1.0], 1000.0);
    ForceLaw::of_estimate(estimate, &data).is_ok_and(|law| {
        law.responses.iter().any(|r| r == "f_x" || r == "f_y")
            && law.channels().iter().all(|c| data.values(c).is_some())
    })
}

/// Forces by the recommended estimates over the common range of speed and angle.
fn predict_forces(all: &[Named<'_>], labels: &[String], out: &mut Comparison) {
    let all: Vec<(&Named<'_>, &String)> = all.iter().zip(labels).filter(|(n, _)| gives_forces(n.estimate)).collect();
    let recommended: Vec<_> = all.iter().copied().filter(|(n, _)| n.estimate.recommended).collect();
    let chosen = if recommended.len() >= 2 { recommended } else { all };
    let range = |name: &str| -> Option<Range> {
        let stated: Vec<&Range> = chosen.iter().filter_map(|(n, _)| n.estimate.validity.get(name)).collect();
        let first = stated.first()?;
        Some(Range {
            low: stated.iter().map(|r| r.low).fold(f64::NEG_INFINITY, f64::max),
            high: stated.iter().map(|r| r.high).fold(f64::INFINITY, f64::min),
            unit: first.unit.clone(),
        })
    };
    let Some(speed) = range("speed") else { return };
    let angle = range("angle").unwrap_or(Range { low: 0.0, high: 0.0, unit: "rad".to_owned() });
    if speed.low > speed.high || angle.low > angle.high {
        out.findings.push(Finding::new(
            Severity::Warning,
            "no-common-range",
            "the fitted ranges of speed or angle do not overlap: no force can be compared without extrapolation"
                .to_owned(),
        ));
        return;
    }
    let links = range("n_links");
    if links.as_ref().is_some_and(|r| r.low > r.high) {
        out.findings.push(Finding::new(
            Severity::Warning,
            "no-common-range",
            "the numbers of links that were tested do not overlap: no force can be compared without extrapolation"
                .to_owned(),
        ));
        return;
    }
    let has_links = links.is_some()
        || chosen.iter().any(|(n, _)| froude_hydro::DragModel::from_name(&n.estimate.law.name).is_some());
    let links: Vec<f64> =
        links.map_or_else(|| vec![1.0], |r| if r.low == r.high { vec![r.low] } else { vec![r.low, r.high] });
    let data = operating_points(
        &speed,
        &angle,
        &links,
        chosen.first().and_then(|(n, _)| n.estimate.density()).map_or(1000.0, |d| d.value),
    );
    let (mut predictions, mut ids) = (Vec::new(), Vec::new());
    for &(n, label) in &chosen {
        let Ok(law) = ForceLaw::of_estimate(n.estimate, &data) else { continue };
        let values: Option<Vec<f64>> =
            law.coefficients.iter().map(|c| n.estimate.coefficients.get(&c.name)?.value).collect();
        let Some(values) = values else { continue };
        let (Ok(force), Ok(slopes)) = (law.predict(&data, &values), law.regressors(&data, &values)) else { continue };
        ids.push(label.clone());
        predictions.push((law, force, slopes, n));
    }
    if predictions.len() < 2 {
        return;
    }
    for (.., n) in &predictions {
        if !n.estimate.validity.contains_key("speed") {
            out.findings.push(
                Finding::new(
                    Severity::Note,
                    "range-not-stated",
                    format!(
                        "{} states no range of speed and angle: whether its forces are extrapolated is not known",
                        n.estimate.id
                    ),
                )
                .of_source(&n.estimate.source),
            );
        }
    }
    let first = predictions[0].3.estimate;
    for (.., other) in &predictions[1..] {
        // Of one model it is said already.
        if first.law.name != other.estimate.law.name {
            out.findings.extend(axes_not_tied(first, other.estimate));
            out.findings.extend(density_differs(first, other.estimate));
            out.findings.extend(common::findings(&[Common::of(first, other.estimate)]));
        }
    }
    let predicted_by: Vec<Named<'_>> = predictions.iter().map(|(.., n)| **n).collect();
    let origins = origins(&predicted_by);
    let is_same_data: Vec<bool> = (0..predicted_by.len())
        .map(|j| same_data([&predicted_by[0], &predicted_by[j]], [&origins[0], &origins[j]]))
        .collect();
    let commons: Vec<Common<'_>> = predicted_by.iter().map(|n| Common::of(first, n.estimate)).collect();
    for component in ["f_x", "f_y"] {
        for i in 0..data.rows {
            let sides: Vec<Number<'_>> = predictions
                .iter()
                .map(|(law, force, slopes, n)| {
                    let Some(r) = law.responses.iter().position(|name| name == component) else {
                        return Number::of_nothing(n.estimate);
                    };
                    let row = r * data.rows + i;
                    let slope = |name: &str| law.position(name).map_or(0.0, |j| slopes[(row, j)]);
                    Number::of_number(n.estimate, Some(force[row]).filter(|f| f.is_finite()), slope)
                })
                .collect();
            let forces: Vec<Stated> = sides.iter().map(|side| side.stated).collect();
            if forces.iter().all(|f| f.value.is_none()) {
                continue;
            }
            for j in 1..forces.len() {
                let missing = [0, j].into_iter().find(|k| forces[*k].value.is_none());
                let (e_n, note) = noted(match missing {
                    Some(k) => Err(format!("{} gives no {component}", ids[k])),
                    None => e_n([&sides[0], &sides[j]], &commons[j], [&ids[0], &ids[j]], is_same_data[j]),
                });
                out.loads.push(LoadComparison {
                    component: component.to_owned(),
                    unit: "N".to_owned(),
                    n_links: data.values("n_links").map(|v| v[i]).filter(|_| has_links),
                    speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                    angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                    first: forces[0].of(&ids[0]),
                    second: forces[j].of(&ids[j]),
                    e_n,
                    note,
                });
            }
        }
    }
    let of = |id: &String| {
        let sides = out.loads.iter().flat_map(|row| [&row.first, &row.second]);
        coverage_note(id, sides.filter(|side| &side.source == id))
    };
    out.coverage = if out.loads.is_empty() { Vec::new() } else { ids.iter().map(of).collect() };
}

fn operating_points(speed: &Range, angle: &Range, links: &[f64], density: f64) -> Dataset {
    let grid = |r: &Range| -> Vec<f64> {
        if r.high - r.low <= 1e-12 {
            vec![r.high]
        } else {
            (0..FORCE_POINTS).map(|k| r.low + (r.high - r.low) * k as f64 / (FORCE_POINTS - 1) as f64).collect()
        }
    };
    let (mut u, mut a, mut k) = (Vec::new(), Vec::new(), Vec::new());
    for &n in links {
        for &s in &grid(speed) {
            for &t in &grid(angle) {
                u.push(s);
                a.push(t);
                k.push(n);
            }
        }
    }
    let rows = u.len();
    let mut data = Dataset { rows, ..Dataset::default() };
    data.put("speed", u, Dimension::SPEED);
    data.put("angle", a, Dimension::ONE);
    data.put("n_links", k, Dimension::ONE);
    data.put("density", vec![density; rows], Dimension::DENSITY);
    data.put("f_x", vec![0.0; rows], Dimension::FORCE);
    data.put("f_y", vec![0.0; rows], Dimension::FORCE);
    data.velocity_from_speed_and_angle();
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_records::estimate::{DataFile, ErrorKind, SharedError, keyed};

    fn file(path: &str, sha256: &str) -> DataFile {
        DataFile { path: path.to_owned(), sha256: sha256.to_owned(), role: None }
    }

    /// A quadratic drag fit: `D` with its standard uncertainty and degrees of freedom.
    fn record(source: &str, table: &str, d: f64, standard: f64, dof: Option<f64>) -> EstimateFile {
        let estimate = serde_json::json!({
            "id": format!("{source}/quadratic"), "source": source, "kind": "towing",
            "law": {
                "name": "quadratic", "version": 1, "outputs": { "f_x": { "unit": "N", "formula": "-D*v_x*abs(v_x)" } },
            },
            "sigma": { "f_x": { "value": 0.1 * d, "unit": "N" } },
            "n": 12,
            "coefficients": { "D": {
                "value": d, "unit": "kg/m", "status": "free", "standard_uncertainty": standard, "effective_dof": dof
            } },
            "type_a": { "names": ["D"], "matrix": [[standard * standard]], "dof": [dof], "kind": "classical" },
            "validity": { "speed": { "low": 0.2, "high": 1.0, "unit": "m/s" } },
            "recommended": true,
        });
        EstimateFile {
            data: keyed(vec![file("campaign.toml", "campaign"), file("drag.csv", table)]),
            ..EstimateFile::of(vec![serde_json::from_value(estimate).unwrap()])
        }
    }

    fn compared(first: EstimateFile, second: EstimateFile) -> Comparison {
        let files = [("a.json".to_owned(), first), ("b.json".to_owned(), second)];
        compare(&named(&files))
    }

    fn codes(c: &Comparison) -> Vec<&str> {
        c.findings.iter().map(|f| f.code.as_str()).collect()
    }

    #[test]
    fn a_record_beside_itself_gets_no_normalised_difference() {
        let one = record("frame", "t1", 47.8, 0.4, Some(9.0));
        let c = compared(one.clone(), one);
        assert_eq!(c.coefficients[0].note, SAME_DATA);
        assert_eq!(c.joint[0].note, "same data: not independent, χ² not meaningful");
        assert!(!c.loads.is_empty());
        assert!(c.loads.iter().all(|f| f.note == SAME_DATA));
        assert_eq!(codes(&c), ["same-data"]);
    }

    /// Another selection of the rows, another source name: the fingerprint of the table tells.
    #[test]
    fn two_fits_to_one_table_are_not_independent() {
        let mut other = record("slow runs", "t1", 46.9, 0.7, Some(4.0));
        other.estimates[0].n_observations = 6;
        let c = compared(record("frame", "t1", 47.8, 0.4, Some(9.0)), other);
        assert_eq!(c.coefficients[0].note, SAME_DATA);
        assert_eq!(codes(&c), ["same-data"]);
    }

    /// The same run matrix on another day, a bare table of the same name: ranges and names agree, the tables do not.
    #[test]
    fn a_repeated_campaign_is_independent_and_no_contradiction() {
        let c = compared(record("drag", "t1", 47.8, 0.4, Some(9.0)), record("drag", "t2", 47.1, 0.4, Some(9.0)));
        assert!(c.coefficients[0].e_n.is_some());
        assert!(c.joint[0].p.is_some());
        assert_eq!(codes(&c), Vec::<&str>::new());
    }

    /// Two sources of one record share its list of tables, not their observations.
    #[test]
    fn sources_of_one_record_are_independent() {
        let mut both = record("frame", "t1", 47.8, 0.4, Some(9.0));
        both.estimates.extend(record("rotor", "t2", 51.0, 0.4, Some(9.0)).estimates);
        both.data.insert("d3".to_owned(), file("rotor.csv", "t2"));
        let files = [("a.json".to_owned(), both)];
        assert!(compare(&named(&files)).coefficients[0].e_n.is_some());
    }

    /// A record of one table: all its sources read it, whatever they kept of it.
    #[test]
    fn sources_of_one_table_in_one_record_are_not_independent() {
        let mut both = record("all", "t1", 47.8, 0.4, Some(9.0));
        both.estimates.extend(record("slow runs", "t1", 46.9, 0.7, Some(4.0)).estimates);
        both.estimates[1].n_observations = 6;
        let files = [("a.json".to_owned(), both)];
        assert_eq!(compare(&named(&files)).coefficients[0].note, SAME_DATA);
    }

    /// A record that says which estimate read which file: two sources of one table are found out, whatever their names, two of two are not.
    #[test]
    fn a_record_that_names_the_data_of_each_estimate_is_believed() {
        let mut both = record("all", "t1", 47.8, 0.4, Some(9.0));
        both.estimates.extend(record("slow runs", "t2", 46.9, 0.7, Some(4.0)).estimates);
        both.data.insert("d3".to_owned(), file("slow.csv", "t2"));
        for (second, is_same) in [("d2", true), ("d3", false)] {
            both.estimates[0].data = vec!["d2".to_owned()];
            both.estimates[1].data = vec![second.to_owned()];
            let c = compare(&named(&[("a.json".to_owned(), both.clone())]));
            assert_eq!(c.coefficients[0].note == SAME_DATA, is_same, "{second}");
        }
    }

    /// `D` with an error of its own scatter and one of a calibration, of 0.3 and 0.4.
    fn calibrated(source: &str, d: f64, key: &str) -> EstimateFile {
        let mut file = record(source, source, d, 0.3, None);
        let estimate = &mut file.estimates[0];
        estimate.coefficients["D"].standard_uncertainty = Some(0.5);
        let error = SharedError {
            name: "force per volt".to_owned(),
            quantity: "force_per_volt".to_owned(),
            kind: ErrorKind::B,
            covariance: vec![vec![1e-4]],
            dof: None,
            limits: None,
            sensitivity: vec![vec![40.0]],
        };
        estimate.errors.insert(key.to_owned(), error);
        file
    }

    /// u²(a − b) = 2·0.3² where both have one calibration, which moves both alike; 2·0.5² where each has its own. χ² and forces alike.
    #[test]
    fn what_two_records_share_by_its_key_is_taken_out() {
        let k = NORMAL_COVERAGE;
        for (key, u) in [("cal/1", 0.3), ("cal/2", 0.5)] {
            let c = compared(calibrated("a", 40.0, "cal/1"), calibrated("b", 41.0, key));
            let expected = -1.0 / (k * u * 2.0_f64.sqrt());
            assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-12, "{:?}", c.coefficients[0]);
            assert!((c.joint[0].chi_squared.unwrap() - 1.0 / (2.0 * u * u)).abs() < 1e-9, "{:?}", c.joint);
            assert!(c.loads.iter().all(|f| (f.e_n.unwrap() + expected).abs() < 1e-12), "{:?}", c.loads);
            assert_eq!(codes(&c).contains(&"errors-in-common"), key == "cal/1");
        }
    }

    /// An error that goes into the two with different strength leaves its difference: |40 − 20|·0.01 = 0.2.
    #[test]
    fn an_error_that_two_records_feel_differently_leaves_a_part() {
        let mut other = calibrated("b", 41.0, "cal/1");
        other.estimates[0].errors["cal/1"].sensitivity = vec![vec![20.0]];
        let c = compared(calibrated("a", 40.0, "cal/1"), other);
        let expected = -1.0 / (NORMAL_COVERAGE * (2.0_f64 * 0.09 + 0.04).sqrt());
        assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-12, "{:?}", c.coefficients[0]);
    }

    /// Scatter of 0.2 with four degrees of freedom beside a common calibration of 0.4: what stays has four, not the hundred of both together.
    #[test]
    fn what_stays_of_two_records_has_its_own_degrees_of_freedom() {
        let of = |source: &str, d: f64| {
            let mut file = calibrated(source, d, "cal/1");
            let estimate = &mut file.estimates[0];
            let scatter = estimate.type_a.as_mut().unwrap();
            (scatter.matrix[0][0], scatter.dof[0]) = (0.04, Some(4.0));
            let d = &mut estimate.coefficients["D"];
            (d.standard_uncertainty, d.effective_dof) = (Some(0.2_f64.hypot(0.4)), Some(100.0));
            file
        };
        let difference = 2.776_445 * 0.08_f64.sqrt();
        let c = compared(of("a", 40.0 + difference), of("b", 40.0));
        // Two-sided probability of t = 2.776 with four degrees of freedom.
        assert!((c.joint[0].p.unwrap() - 0.05).abs() < 1e-6, "{:?}", c.joint[0]);
    }

    /// A heave decay beside two tables: its range of speeds is no range of theirs, and the forces stay.
    #[test]
    fn a_law_that_gives_no_force_along_or_across_has_no_part_in_the_range() {
        let mut decay = record("springs", "t3", 40.0, 1.0, None);
        let law = &mut decay.estimates[0].law;
        law.name = "added_mass_linear_quadratic".to_owned();
        law.outputs = serde_json::from_value(serde_json::json!({
            "f_z": { "unit": "N", "formula": "-A33*v_z_dot - D*v_z*abs(v_z)" }
        }))
        .unwrap();
        decay.estimates[0].validity["speed"] = Range { low: 0.01, high: 0.05, unit: "m/s".to_owned() };
        let files = [record("a", "t1", 10.0, 1.0, None), record("b", "t2", 11.0, 1.0, None), decay]
            .map(|file| (file.estimates[0].source.clone(), file));
        let c = compare(&named(&files));
        assert_eq!(c.load_sources(), ["a/quadratic", "b/quadratic"]);
        assert!(!c.loads.is_empty() && codes(&c).is_empty(), "{:?}", c.findings);
    }

    /// One calibration, declared with two uncertainties: it is not known which is right.
    #[test]
    fn one_error_with_two_uncertainties_is_said_and_not_taken_out() {
        let mut other = calibrated("b", 41.0, "cal/1");
        other.estimates[0].errors["cal/1"].covariance = vec![vec![4e-4]];
        let c = compared(calibrated("a", 40.0, "cal/1"), other);
        assert_eq!(codes(&c), ["errors-contradict"]);
    }

    /// An interval that reaches to one side: from the other side the difference counts in full.
    #[test]
    fn an_interval_to_one_side_has_its_arm_to_the_other_value() {
        let mut one = record("a", "a", 40.0, 1e-9, None);
        let error = calibrated("a", 40.0, "own/limits").estimates.remove(0).errors.swap_remove("own/limits").unwrap();
        // The truth lies up to 4 below the value.
        let limits = Some([-4.0, 0.0]);
        let error = SharedError { limits, sensitivity: vec![vec![1.0]], covariance: vec![vec![16.0 / 3.0]], ..error };
        one.estimates[0].errors.insert("own/limits".to_owned(), error);
        one.estimates[0].coefficients["D"].standard_uncertainty = Some(2.3);
        let below = compared(one.clone(), record("b", "b", 39.0, 0.1, None)).coefficients[0].e_n.unwrap();
        let above = compared(one, record("b", "b", 41.0, 0.1, None)).coefficients[0].e_n.unwrap();
        assert!(below.abs() < 0.3 && above.abs() > 5.0, "{below} {above}");
    }

    /// Four degrees of freedom: Student's t is 2.776, not 1.96 (any printed table).
    #[test]
    fn few_degrees_of_freedom_widen_the_expanded_uncertainty() {
        let c = compared(record("a", "t1", 10.0, 1.0, Some(4.0)), record("b", "t2", 13.0, 1.0, None));
        let expected = -3.0 / 2.776_445f64.hypot(1.959_964);
        assert!((c.coefficients[0].e_n.unwrap() - expected).abs() < 1e-6);
        assert_eq!(
            c.coverage,
            [
                "a/quadratic: k = 2.78 (Student's t, effective degrees of freedom 4.0)",
                "b/quadratic: k = 1.96 (normal), its record states no degrees of freedom"
            ]
        );
    }

    /// F = D v²: whatever the speed, the forces differ by as many U as the coefficients do.
    #[test]
    fn a_law_of_one_coefficient_has_one_normalised_difference() {
        let c = compared(record("a", "t1", 10.0, 1.0, Some(4.0)), record("b", "t2", 13.0, 0.8, Some(30.0)));
        let of_d = c.coefficients[0].e_n.unwrap();
        for row in &c.loads {
            // Force on the body: the sign turns.
            let of_force = row.e_n.unwrap();
            assert!((of_force + of_d).abs() < 1e-12 * of_d.abs(), "{of_force} against {of_d} at {} m/s", row.speed_m_s);
        }
    }

    #[test]
    fn a_body_without_links_has_none() {
        let c = compared(record("a", "t1", 10.0, 1.0, None), record("b", "t2", 13.0, 1.0, None));
        assert!(c.loads.iter().all(|f| f.n_links.is_none()));
    }
}
