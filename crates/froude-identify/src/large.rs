//! Tables of more rows than are kept in memory: the same answers from passes over the rows.
//!
//! A law that is linear in its coefficients needs of its rows no more than the triangle of `[X | y]`: coefficients, bounds, priors, F tests,
//! AICc, classical and cluster-robust covariance follow from it as from the rows. So the table is read four times, a chunk at a time:
//!
//! 1. how many rows, the ends of every channel, a sample (`facts`), how long each group moves;
//! 2. the ends among the rows that move, what the lints count, and which groups repeat a motion;
//! 3. the triangles of every law (`fold`);
//! 4. Durbin–Watson and the largest leverage, from the residuals.
//!
//! **From all rows:** coefficients, uncertainties, selection, ranges, the lints of motion, loads and signs. **From the sample,** and said so:
//! figures, the table of observations, uneven scatter, two units in a load. **Not looked for,** and said so: identical copies (unless a
//! column rises from row to row), repeats of a setting and with them lack of fit, prediction of left-out configurations. **Refused,** with
//! the reason: what needs all rows at once.

mod facts;
mod fold;
mod limits;
mod rows;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::path::Path;

use facts::{Chunk, Facts, Seconds};
use fold::{Fold, Residuals};
use froude_records::campaign::{AngleOffset, Campaign, Source};
use froude_records::chunks::{for_each_chunk, has_more_rows};
use froude_records::finding::{Finding, Severity};
use froude_records::table::Table;
use rows::table_of;

use crate::dataset::{Dataset, Drawn};
use crate::dissipation;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::motions::{self, Motions};
use crate::reduce::{Observations, files_of, kept_rows, left_out, motion_and_zeros, observed, one_unit};
use crate::regression::{Condensed, ModelFit, Scatter, Settings, regress};
use crate::result::SourceResult;
use crate::seam::{Choice, Reduced, conclude};
use crate::source::asked::{Asked, reduced, with_recommended};
use crate::source::handed::{TABLE, merges_motions, scatter};
use crate::source::models::laws;

pub use crate::large::limits::MOST_KEPT;
pub(crate) use crate::large::limits::{SAMPLE, refused_above};

/// Most rows that are kept all the same where something is asked for that needs all of them at once: some 4 GB and minutes.
const MOST_AT_ONCE: usize = 2_000_000;
/// Identifies one source whose table is read in chunks; `None` where its rows turn out to be needed at once, and are few enough for that.
///
/// # Errors
///
/// As [`identify_source`](crate::source::identify_source), and what was asked for that needs more rows at once than are kept.
pub(crate) fn identify_source(
    campaign: &Campaign,
    source: &Source,
    sample: usize,
    progress: &dyn Fn(&str),
) -> Result<Option<SourceResult>, IdentifyError> {
    if let Some(what) = at_once(campaign, source) {
        return Err(refused_above(MOST_AT_ONCE, source, what));
    }
    progress("the ranges of a long table");
    let (mut facts, mut motions) = (Facts::new(sample), Motions::default());
    let has_motions = merges_motions(campaign, source);
    each(campaign, source, true, &mut |chunk| {
        facts.take(chunk, source)?;
        if has_motions {
            motions.span(&chunk.data);
        }
        Ok(())
    })?;
    if facts.n_used == 0 {
        return Err(IdentifyError::NothingKept { source_name: source.name.clone(), n_read: facts.n_read });
    }
    let mut seconds = Seconds::default();
    each(campaign, source, true, &mut |chunk| {
        seconds.take(chunk, &facts, campaign);
        motions.probe(&chunk.data);
        Ok(())
    })?;
    let (table, mut few) = few(&facts, &seconds, campaign, source)?;
    let mut laws = laws(campaign, source, &few.data)?;
    if nobody_asked(campaign, source) {
        laws.retain(|law| !law.is_nonlinear());
    }
    if let Some(clusters) = motions.clusters(&laws) {
        few.findings.push(motions::found(&clusters));
        if motions::is_enough(&clusters) {
            motions::rename(&mut few.data, &clusters);
            facts.merge(&clusters);
        }
    }
    let scatter = scatter(campaign, source, TABLE, &few.data, &mut few.findings)?;
    let lines: BTreeSet<usize> = facts.sample().iter().map(|row| row.line()).collect();
    let of_sample: Vec<usize> = (0..few.data.rows).filter(|&i| lines.contains(&few.data.line[i])).collect();
    let sample = few.data.subset(&of_sample);
    one_unit(&table, &sample, campaign, source)?;
    few.findings.push(in_chunks(&facts, &sample).of_source(&source.name));
    let asked = Asked { method: TABLE, laws, scatter, choice: Choice::Selection, has_budget: false };
    let mut reduced = reduced(campaign, source, few, &seconds.counts, asked)?;
    let ends = std::mem::replace(&mut reduced.data, sample);
    if let Some(what) = weighs_all(&reduced) {
        let is_kept = facts.n_read <= MOST_AT_ONCE;
        return if is_kept { Ok(None) } else { Err(refused_above(MOST_AT_ONCE, source, &what)) };
    }
    progress("all rows of a long table");
    let fitted = regressed(campaign, source, &facts, &ends, &reduced)?;
    let (fitted, leverage) = with_residuals(campaign, source, fitted, &reduced.data)?;
    let mut result = conclude(reduced, &campaign.identify, fitted)?;
    for ((estimate, model), leverage) in result.estimates.iter_mut().zip(&result.models).zip(leverage) {
        let diagnostics = &mut estimate.diagnostics;
        diagnostics.largest_leverage = leverage;
        if diagnostics.largest_power_w.is_some() {
            let power = dissipation::largest_power_w(&model.law, &ends, model.law_coefficients())?;
            diagnostics.largest_power_w = Some(power);
        }
        if let (Some(density), Some(mean)) = (facts.density(), estimate.refers_to.get_mut("density")) {
            mean.value = density;
        }
    }
    Ok(Some(with_recommended(result, campaign)))
}

/// What of the table itself, and not of the campaign, needs all rows at once.
fn weighs_all(reduced: &Reduced) -> Option<String> {
    let mut loads = reduced.laws.iter().flat_map(|law| &law.responses);
    if let Some(load) = loads.find(|load| reduced.data.channels.contains_key(&format!("std_{load}"))) {
        return Some(format!("std_{load} (the weights of all rows are scaled to each other)"));
    }
    let is_hc3 = reduced.scatter == Scatter::Hc3;
    is_hc3.then(|| "HC3, which suits computations without five clusters (each row weighs by its residual)".to_owned())
}

/// Whether a law or `keep` reads the speed or the angle of the motion, and not only its velocities.
fn reads_speed(source: &Source, laws: &[ForceLaw]) -> bool {
    let is_one = |name: &str| matches!(name, "speed" | "angle");
    let clauses = source.keep.iter().flat_map(|keep| &keep.clauses);
    laws.iter().flat_map(ForceLaw::channels).any(is_one)
        || clauses.map(|clause| &clause.column).any(|name| is_one(name))
}

/// Reads the table once; `has_speed` as of a chunk.
fn each(
    campaign: &Campaign,
    source: &Source,
    has_speed: bool,
    take: &mut dyn FnMut(&Chunk) -> Result<(), IdentifyError>,
) -> Result<(), IdentifyError> {
    for_each_chunk(source.input.path(), source.sidecar.as_deref(), &mut |table| {
        take(&Chunk::of(table, campaign, source, has_speed)?)
    })
}

/// Whether a table is read in chunks: one of many rows, and one that asks for what needs all of them at once only where it is too long for that.
pub(crate) fn is_long(campaign: &Campaign, source: &Source, path: &Path) -> bool {
    let most = if at_once(campaign, source).is_some() { MOST_AT_ONCE } else { MOST_KEPT };
    has_more_rows(path, most)
}

/// What a campaign asks for that needs all rows at once, and why.
fn at_once(campaign: &Campaign, source: &Source) -> Option<&'static str> {
    let identify = &campaign.identify;
    let is_hc3 = identify.covariance.as_deref().is_some_and(|kind| kind.eq_ignore_ascii_case("hc3"));
    let asked = [
        (source.tare.is_some(), "tare (its error differs from row to row)"),
        (!source.uncertainty.is_empty(), "[[source.uncertainty]] (its errors go through every row)"),
        (identify.errors_in_variables, "errors_in_variables (each row has a true speed of its own)"),
        (!identify.known.is_empty(), "known (its error goes through every row)"),
        (identify.angle_offset == AngleOffset::Estimate, "angle_offset = \"estimate\" (it is iterated over the rows)"),
        (identify.fitted_weights, "weights = \"fitted\" (each row weighs by the fitted load)"),
        (identify.group_offset, "group_offset = \"estimate\" (each group has columns of its own)"),
        (
            identify.covariance.as_deref() == Some("serial"),
            "covariance = \"serial\" (rows are compared with their neighbours)",
        ),
        (is_hc3, "covariance = \"HC3\" (each row weighs by its residual); \"cluster\" goes with it"),
        (!identify.cross_validation.is_empty(), "cross_validation (its blocks are fitted by themselves)"),
    ];
    asked.into_iter().find(|(is_asked, _)| *is_asked).map(|(_, what)| what)
}

/// Whether the laws are the defaults, and not those of the campaign.
fn nobody_asked(campaign: &Campaign, source: &Source) -> bool {
    let identify = &campaign.identify;
    source.models.is_empty() && identify.models.is_empty() && identify.user_models.is_empty()
}

/// The few rows that stand for all where these are judged: the table, and its observations.
fn few(
    facts: &Facts,
    seconds: &Seconds,
    campaign: &Campaign,
    source: &Source,
) -> Result<(Table, Observations), IdentifyError> {
    let nothing = || IdentifyError::NothingKept { source_name: source.name.clone(), n_read: facts.n_read };
    let table = table_of(facts.like.as_ref().ok_or_else(nothing)?, facts.rows().chain(seconds.rows()));
    let mut findings: Vec<Finding> = facts.like.as_ref().map(Table::findings).unwrap_or_default();
    let all = observed(&table, campaign, source, &mut findings)?;
    let keep = kept_rows(&all, source)?;
    let drawn = Drawn {
        rows: facts.n_used,
        clusters: if source.group.is_some() { facts.clusters() } else { 0 },
        configurations: facts.configurations.iter().cloned().collect(),
    };
    let data = Dataset { sample: Some(drawn), ..all.keeping(&keep) };
    findings.extend(left_out(facts.n_used, facts.n_read));
    findings.extend(motion_and_zeros(&table, &keep, &data));
    let files = files_of(&table);
    Ok((table, Observations { data, n_read: facts.n_read, findings, shared_errors: Vec::new(), files }))
}

/// The message about a table that was read in chunks.
fn in_chunks(facts: &Facts, sample: &Dataset) -> Finding {
    let copies = if facts.has_no_copies() { "" } else { "identical copies of rows, " };
    let all = facts.n_used;
    let judged = if sample.rows < all {
        format!(
            "; figures, the table of observations, uneven scatter and units that change within a load are judged from {} of them, drawn \
             at random",
            sample.rows
        )
    } else {
        String::new()
    };
    Finding::new(
        Severity::Note,
        "read-in-chunks",
        format!(
            "the table has {} rows, more than {MOST_KEPT}: the coefficients, their uncertainties and the ranges are those of all {all} \
             observations{judged}; not looked for are {copies}repeats of a setting and lack of fit",
            facts.n_read
        ),
    )
}

/// A law that was fitted, or the name of one that was not.
type Fitted = Result<ModelFit, (String, IdentifyError)>;

/// Every law, fitted to all rows.
fn regressed(
    campaign: &Campaign,
    source: &Source,
    facts: &Facts,
    ends: &Dataset,
    reduced: &Reduced,
) -> Result<Vec<Fitted>, IdentifyError> {
    let is_clustered = reduced.scatter == Scatter::Cluster;
    let linear: Vec<&ForceLaw> = reduced.laws.iter().filter(|law| !law.is_nonlinear()).collect();
    let mut fold = Fold::new(linear, &source.name, is_clustered);
    each(campaign, source, reads_speed(source, &reduced.laws), &mut |chunk| {
        let group = chunk.data.group.as_ref().filter(|_| is_clustered);
        let clusters = group.map_or_else(|| vec![0; chunk.data.rows], |group| facts.numbered(group));
        fold.take(&chunk.data, &clusters);
        Ok(())
    })?;
    let settings = reduced.settings(&campaign.identify);
    let fit =
        |law: &ForceLaw, condensed: &Condensed| regress(law, ends, Settings { condensed: Some(condensed), ..settings });
    let mut condensed = fold.finish().into_iter();
    let finish = |law: &ForceLaw| {
        let rows = if law.is_nonlinear() { None } else { condensed.next() };
        let model = rows.unwrap_or_else(|| Err(iterated(law, source))).and_then(|rows| fit(law, &rows));
        model.map_err(|error| (law.name.clone(), error))
    };
    Ok(reduced.laws.iter().map(finish).collect())
}

/// Why a law is not fitted to rows that are read once.
fn iterated(law: &ForceLaw, source: &Source) -> IdentifyError {
    IdentifyError::NoFit {
        source_name: source.name.clone(),
        model: law.name.clone(),
        why: format!(
            "it is not linear in its coefficients, and would be iterated over a table of more than {MOST_KEPT} rows, which is read in \
             chunks; give fewer rows, or a law with a given exponent (quadratic)"
        ),
    }
}

/// The models with what the residuals of all rows say, and the largest leverage of each.
fn with_residuals(
    campaign: &Campaign,
    source: &Source,
    mut fitted: Vec<Fitted>,
    sample: &Dataset,
) -> Result<(Vec<Fitted>, Vec<Option<f64>>), IdentifyError> {
    let models: Vec<&mut ModelFit> = fitted.iter_mut().filter_map(|model| model.as_mut().ok()).collect();
    let mut residuals: Vec<Residuals> = models.iter().map(|model| Residuals::new(model)).collect();
    let laws: Vec<ForceLaw> = models.iter().map(|model| model.law.clone()).collect();
    each(campaign, source, reads_speed(source, &laws), &mut |chunk| {
        models.iter().zip(&mut residuals).try_for_each(|(model, residuals)| residuals.take(model, &chunk.data))
    })?;
    let into = |(model, residuals): (&mut ModelFit, Residuals)| residuals.into_model(model, sample);
    let leverage = models.into_iter().zip(residuals).map(into).collect::<Result<_, _>>()?;
    Ok((fitted, leverage))
}
