//! Estimates side by side: coefficients, whole vectors, predicted loads.

use froude_records::comparison::{CoefficientComparison, Comparison, JointComparison, LoadComparison, Side};
use indexmap::IndexMap;
use maud::{Markup, html};

use super::{Tables, counted, dagger, head_unit, html_symbol, union};
use froude_records::number::{self, MISSING};

/// Most places with predicted loads on the page itself; where there are more, all are folded and three speeds by three
/// angles are shown.
const MOST_PREDICTIONS: usize = 36;

/// Most sources beside the first one in a table of predicted loads.
const MOST_SIDES: usize = 3;

impl Tables {
    /// E_n of every coefficient that two sources share; pairs that have none are folded.
    pub(crate) fn differences(&mut self, comparison: &Comparison) -> Markup {
        let mut pairs: IndexMap<[&str; 3], Vec<&CoefficientComparison>> = IndexMap::new();
        for c in &comparison.coefficients {
            pairs.entry([&c.model, &c.first.source, &c.second.source]).or_default().push(c);
        }
        let (with, without): (Vec<_>, Vec<_>) =
            pairs.into_values().partition(|pair| pair.iter().any(|c| number::finite(c.e_n).is_some()));
        let shown = (!with.is_empty()).then(|| {
            let caption = self.caption(
                "Coefficients of the same model from two sources, with standard uncertainties in brackets and the normalised difference \
                 Eₙ = (first − second)/U, U the expanded (95 %) uncertainty of the difference: √(U₁² + U₂²) where the two have no error in \
                 common. |Eₙ| ≤ 1: they agree within their stated uncertainties.",
            );
            pair_table(&with, &caption)
        });
        let folded = (!without.is_empty()).then(|| {
            let caption =
                self.caption("Coefficients of the same model from two sources that have no normalised difference.");
            html! {
                details {
                    summary { (counted(without.len(), "pair", "pairs")) " of estimates without Eₙ" }
                    (pair_table(&without, &caption))
                }
                (why_not(&without))
            }
        });
        html! { @if let Some(table) = shown { (table) } @if let Some(table) = folded { (table) } }
    }

    /// χ² of whole coefficient vectors; pairs that have none are folded.
    pub(crate) fn joint(&mut self, comparison: &Comparison) -> Markup {
        let (with, without): (Vec<&JointComparison>, Vec<&JointComparison>) =
            comparison.joint.iter().partition(|j| number::finite(j.chi_squared).is_some());
        let shown = (!with.is_empty()).then(|| {
            let caption = self.caption(
                "All coefficients of a model together, with their covariances. Collinear coefficients can each agree while the vectors do \
                 not, and the other way round.",
            );
            joint_table(&with, &caption)
        });
        let folded = (!without.is_empty()).then(|| {
            let caption = self.caption("Pairs of estimates that have no χ².");
            html! {
                details {
                    summary { (counted(without.len(), "pair", "pairs")) " of estimates without χ²" }
                    (joint_table(&without, &caption))
                }
            }
        });
        html! { @if let Some(table) = shown { (table) } @if let Some(table) = folded { (table) } }
    }

    /// Predicted loads over the common range: a row per place, a column per source.
    pub(crate) fn predictions(&mut self, comparison: &Comparison) -> Markup {
        let mut parts = Vec::new();
        let mut by_sides: IndexMap<&str, IndexMap<&str, Vec<(usize, &LoadComparison)>>> = IndexMap::new();
        for (i, f) in comparison.loads.iter().enumerate() {
            by_sides.entry(&f.first.source).or_default().entry(&f.second.source).or_default().push((i, f));
        }
        for (first, others) in by_sides {
            let names: Vec<&str> = others.keys().copied().collect();
            let rows_of: Vec<_> = others.into_values().collect();
            for (block, rows) in names.chunks(MOST_SIDES).zip(rows_of.chunks(MOST_SIDES)) {
                let mut rows = rows.concat();
                rows.sort_by_key(|(i, _)| *i);
                let rows: Vec<&LoadComparison> = rows.into_iter().map(|(_, f)| f).collect();
                let places = by_place(&rows);
                let (shown, is_all) = corners(&places);
                let caption = self.caption(&format!(
                    "Loads that the sources predict over their common range{}. ± U: expanded uncertainty, 95 %, U = k·u; \
                     Eₙ = (a − b)/U, a from {first}, U the \
                     expanded uncertainty of the difference: √(U²(a) + U²(b)) where the two have no error in common; for an \
                     asymmetric interval U is the half-width on the side of the other value.",
                    if is_all { "" } else { ", at its ends and middle" }
                ));
                parts.push(prediction_table(&shown, first, block, &caption));
                if !is_all {
                    let caption = self.caption("Predicted loads at all places of the common range.");
                    parts.push(html! {
                        details {
                            summary { "all " (number::count(places.len())) " places" }
                            (prediction_table(&places, first, block, &caption))
                        }
                    });
                }
            }
        }
        html! { @for part in &parts { (part) } }
    }
}

/// One place of the common range with its predictions, one for each other source.
type PredictedPlace<'a> = Vec<&'a LoadComparison>;

/// Predictions gathered by number of links, load, speed and angle, in the order of appearance.
fn by_place<'a>(rows: &[&'a LoadComparison]) -> Vec<PredictedPlace<'a>> {
    let mut out: IndexMap<(Option<u64>, &str, u64, u64), PredictedPlace<'a>> = IndexMap::new();
    for &r in rows {
        let links = r.n_links.map(f64::to_bits);
        let key = (links, r.component.as_str(), r.speed_m_s.to_bits(), r.angle_rad.to_bits());
        out.entry(key).or_default().push(r);
    }
    out.into_values().collect()
}

/// The places at the least, middle and largest speed and angle, and whether these are all.
fn corners<'a>(places: &[PredictedPlace<'a>]) -> (Vec<PredictedPlace<'a>>, bool) {
    if places.len() <= MOST_PREDICTIONS {
        return (places.to_vec(), true);
    }
    let three = |of: fn(&LoadComparison) -> f64| {
        let mut all: Vec<f64> = places.iter().map(|p| of(p[0])).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        [0, all.len() / 2, all.len() - 1].map(|i| all[i].to_bits())
    };
    let (speeds, angles) = (three(|f| f.speed_m_s), three(|f| f.angle_rad));
    let is_corner = |p: &&PredictedPlace<'a>| {
        speeds.contains(&p[0].speed_m_s.to_bits()) && angles.contains(&p[0].angle_rad.to_bits())
    };
    (places.iter().filter(is_corner).cloned().collect(), false)
}

/// Why estimates that state their uncertainties have no Eₙ: said outside the fold, each reason once with its pairs.
fn why_not(pairs: &[Vec<&CoefficientComparison>]) -> Markup {
    let states = |side: &Side| number::finite(side.expanded_uncertainty).is_some();
    let mut reasons: IndexMap<&str, Vec<String>> = IndexMap::new();
    for pair in pairs.iter().filter(|pair| pair.iter().any(|c| states(&c.first) && states(&c.second))) {
        if let Some(note) = common_note(pair.iter().map(|c| c.note.as_str())) {
            reasons.entry(note).or_default().push(format!("{} and {}", pair[0].first.source, pair[0].second.source));
        }
    }
    html! {
        @for (note, pairs) in &reasons { p class="remarks" { (pairs.join("; ")) " – " (note) "." } }
    }
}

/// Pairs of estimates with the coefficients that they share; each pair names its columns.
fn pair_table(pairs: &[Vec<&CoefficientComparison>], caption: &Markup) -> Markup {
    html! {
        div class="table" {
            table class="pairs" {
                (caption)
                @for own in pairs {
                    @let common = common_note(own.iter().map(|c| c.note.as_str()));
                    tbody {
                        tr class="group" {
                            th scope="col" { "Model " (own[0].model) }
                            th scope="col" class="num source" { (own[0].first.source) }
                            th scope="col" class="num source" { (own[0].second.source) }
                            th scope="col" class="num" { "E" sub { "n" } }
                            th scope="col" class="remark" { @if let Some(note) = common { (note) } }
                        }
                        @for c in own {
                            tr {
                                th scope="row" {
                                    (html_symbol(&c.coefficient))
                                    @if let Some(label) = &c.label { " (" (html_symbol(label)) ")" }
                                    (head_unit(&c.unit))
                                }
                                td class="num" { (side(&c.first)) }
                                td class="num" { (side(&c.second)) }
                                td class="num" { (normalised(c.e_n)) }
                                td class="remark" { @if common.is_none() { (c.note) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn joint_table(rows: &[&JointComparison], caption: &Markup) -> Markup {
    html! {
        div class="table" {
            table {
                (caption)
                thead {
                    tr {
                        th scope="col" { "Model" }
                        th scope="col" { "First" }
                        th scope="col" { "Second" }
                        th scope="col" class="num" { "χ²" }
                        th scope="col" class="num" { "Degrees of freedom" }
                        th scope="col" class="num" { "p" }
                        th scope="col" { "" }
                    }
                }
                tbody {
                    @for j in rows {
                        tr {
                            th scope="row" { (j.model) }
                            td { (j.first) }
                            td { (j.second) }
                            td class="num" { (number::finite(j.chi_squared).map_or_else(|| MISSING.to_owned(), |x| number::significant(x, 3))) }
                            td class="num" { (if j.chi_squared.is_some() { number::dof(j.dof.map_or(f64::NAN, |m| m as f64)) } else { MISSING.to_owned() }) }
                            td class="num" {
                                @match j.p {
                                    Some(p) if p < 0.05 => span class="bad" { (number::p_value(p)) },
                                    Some(p) => (number::p_value(p)),
                                    None => (MISSING),
                                }
                            }
                            td { (j.note) }
                        }
                    }
                }
            }
        }
    }
}

fn prediction_table(places: &[PredictedPlace<'_>], first: &str, others: &[&str], caption: &Markup) -> Markup {
    let has_configuration = places.iter().any(|p| p[0].n_links.is_some());
    let units = union(places.iter().map(|p| &p[0].unit));
    let is_one_unit = units.len() < 2;
    let unit = html! { @if is_one_unit { (head_unit(units.first().copied().unwrap_or(""))) } };
    let of = |other: &str| places.iter().flatten().copied().filter(|r| r.second.source == other).collect::<Vec<_>>();
    let has_e_n = |other: &str| of(other).iter().any(|r| number::finite(r.e_n).is_some());
    let states = |side: &Side| number::finite(side.expanded_uncertainty).is_some();
    let first_states = places.iter().flatten().any(|r| states(&r.first));
    let other_states = |other: &str| of(other).iter().any(|r| states(&r.second));
    let head = |id: &str, is_stated: bool| html! { (id) @if is_stated { ", ± U" } (unit) };
    // Where a side has no uncertainty, the † says why there is no Eₙ.
    let has_uncertainty = |side: &Side| number::finite(side.standard_uncertainty).is_some();
    let notes: Vec<(&str, &str)> = others
        .iter()
        .flat_map(|other| {
            let own = of(other).into_iter().filter(|r| has_uncertainty(&r.first) && has_uncertainty(&r.second));
            union(own.map(|r| &r.note).filter(|n| !n.is_empty())).into_iter().map(move |n| (*other, n))
        })
        .collect();
    let has_dagger = !first_states || others.iter().any(|other| !other_states(other));
    html! {
        div class="table" {
            table {
                (caption)
                thead {
                    tr {
                        @if has_configuration { th scope="col" { "Body" } }
                        th scope="col" class="num" { "Speed " span class="unit" { "[m/s]" } }
                        th scope="col" class="num" { "Angle" }
                        th scope="col" { "Load" }
                        th scope="col" class="num source" { (head(first, first_states)) }
                        @for other in others {
                            th scope="col" class="num source" { (head(other, other_states(other))) }
                            @if has_e_n(other) { th scope="col" class="num" { "E" sub { "n" } } }
                        }
                    }
                }
                tbody {
                    @for place in places {
                        @let r = place[0];
                        tr {
                            @if has_configuration { td { @if let Some(k) = r.n_links { "k = " (k) } } }
                            td class="num" { (number::plain(r.speed_m_s, 4)) }
                            td class="num" { (number::degrees(r.angle_rad)) }
                            td { (html_symbol(&r.component)) @if !is_one_unit { (head_unit(&r.unit)) } }
                            td class="num" { (load(&r.first)) }
                            @for other in others {
                                @let own = place.iter().find(|r| r.second.source == *other);
                                td class="num" { @if let Some(r) = own { (load(&r.second)) } }
                                @if has_e_n(other) { td class="num" { @if let Some(r) = own { (normalised(r.e_n)) } } }
                            }
                        }
                    }
                }
            }
        }
        @if has_dagger || !notes.is_empty() {
            p class="notes" {
                @if has_dagger { "† no interval stated, no E" sub { "n" } ". " }
                @for (other, note) in &notes { (other) ": " (note) ". " }
            }
        }
    }
}

/// The remark that all rows share, if they share one.
fn common_note<'a>(mut notes: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let first = notes.next().filter(|n| !n.is_empty())?;
    notes.all(|n| n == first).then_some(first)
}

/// A predicted load: value ± U, † without an uncertainty.
fn load(side: &Side) -> Markup {
    match (number::finite(side.value), number::usable(side.expanded_uncertainty)) {
        (Some(value), Some(u)) => html! { (number::plus_minus(value, u)) },
        // A load that is zero whatever the coefficients are.
        (Some(value), None) if side.expanded_uncertainty == Some(0.0) => html! { (number::plain(value, 4)) },
        (Some(value), None) => html! { (number::plain(value, 4)) (dagger()) },
        (None, _) => html! { (MISSING) },
    }
}

/// One side of a comparison: value with uncertainty, † without one.
fn side(side: &Side) -> Markup {
    match (number::finite(side.value), number::usable(side.standard_uncertainty)) {
        (Some(value), Some(u)) => html! { (number::short_form(value, u)) },
        (Some(value), None) => html! { (number::plain(value, 4)) (dagger()) },
        (None, _) => html! { (MISSING) },
    }
}

fn normalised(e_n: Option<f64>) -> Markup {
    match number::finite(e_n) {
        Some(e) if e.abs() > 1.0 => html! { span class="bad" { (number::fixed(e, 2)) } },
        Some(e) => html! { span class="good" { (number::fixed(e, 2)) } },
        None => html! { (MISSING) },
    }
}
