//! What the rows of a table hand over the seam.

use froude_fit::FEWEST_CLUSTERS;
use froude_fit::serial::{RowErrors, RowWindow};
use froude_records::campaign::{Campaign, Source, SourceKind};
use froude_records::estimate::{Measured, ReferencePoint};
use froude_records::finding::{Finding, Severity};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::Scatter;
use crate::seam::reduced::Reduced;
use crate::uncertainty::SharedError;

/// The method of rows that are read as they are.
pub(crate) const TABLE: &str = "table";

/// Observations of a table, with what the campaign states of them.
pub(crate) fn of_table(
    campaign: &Campaign,
    source: &Source,
    method: &str,
    data: Dataset,
    laws: Vec<ForceLaw>,
) -> Reduced {
    let length = campaign.body.as_ref().and_then(|body| body.reference_length_m);
    let length = length.filter(|_| laws.iter().any(|law| law.named.is_some()));
    let mut out = Reduced::new(&source.name, source.kind, method, data, laws);
    // Nobody but the campaign knows the point that moments are about.
    let words = campaign.body.as_ref().and_then(|b| b.reference_point.clone());
    out.stated.point = ReferencePoint::stated(words);
    // Primes refer to it.
    out.stated.refers_to.extend(length.map(|length| ("length".to_owned(), Measured::of(length, "m"))));
    Reduced { budget: source.uncertainty.clone(), campaign: campaign.key.clone(), ..out }
}

/// That no error of an instrument is declared, where none is; `stated` are the errors that the method brings itself.
pub(crate) fn no_budget(campaign: &Campaign, source: &Source, stated: &[SharedError]) -> Option<Finding> {
    source.uncertainty.is_empty().then(|| {
        let mut names: Vec<&str> = stated.iter().map(|error| error.name.as_str()).collect();
        names.dedup();
        let stated = names.iter().map(|name| format!(", the error \"{name}\"")).collect::<String>();
        let known = if campaign.identify.known.is_empty() { "" } else { ", that of what is known" };
        let text = if source.kind == SourceKind::Cfd {
            format!(
                "no uncertainty of the computation is declared: the intervals include the scatter about the law{stated}{known} and nothing else \
                 (the error of the model form does not appear in the scatter); declare what is known ([[source.uncertainty]])"
            )
        } else {
            format!(
                "no uncertainty of an instrument is declared: the intervals include the scatter of the observations{stated}{known} and nothing else \
                 (a calibration error does not appear in the scatter); declare the uncertainty of each instrument ([[source.uncertainty]])"
            )
        };
        Finding::new(Severity::Note, "no-budget", text)
    })
}

/// Whether runs that repeat a motion are one cluster: wherever groups may be clusters, and are no offsets.
pub(crate) fn merges_motions(campaign: &Campaign, source: &Source) -> bool {
    let is_asked = match campaign.identify.covariance.as_deref() {
        Some(kind) => kind.eq_ignore_ascii_case("cluster") || kind.eq_ignore_ascii_case("cr3"),
        None => source.kind == SourceKind::Cfd,
    };
    is_asked && !campaign.identify.group_offset
}

/// That groups are named and change no interval, where nobody said how they count.
fn group_not_used(campaign: &Campaign, source: &Source) -> Option<Finding> {
    let identify = &campaign.identify;
    let is_used = identify.covariance.is_some() || identify.group_offset;
    let is_open = !is_used && source.kind != SourceKind::Cfd;
    let group = source.group.as_ref().filter(|_| is_open)?;
    let text = format!(
        "group = {group:?} is named, and rows are taken for independent all the same: write covariance = \"cluster\" in [identify] where the rows of a group err alike, or group_offset = \"estimate\" where \
         each has an offset of its own"
    );
    Some(Finding::new(Severity::Note, "group-not-used", text))
}

/// The scatter that the campaign asks for, else what suits the source: rows that a method has reduced from runs err by a part of their load too, and residuals of a computation are model
/// error, alike within a configuration.
pub(crate) fn scatter(
    campaign: &Campaign,
    source: &Source,
    method: &str,
    data: &Dataset,
    findings: &mut Vec<Finding>,
) -> Result<Scatter, IdentifyError> {
    match campaign.identify.covariance.as_deref() {
        Some("classical") => return Ok(Scatter::Classical),
        Some("HC3" | "hc3") => return Ok(Scatter::Hc3),
        Some("cluster" | "CR3" | "cr3") => return Ok(Scatter::Cluster),
        Some("serial") => return Ok(Scatter::Serial(RowErrors { window: RowWindow::single(), white: None })),
        Some(other) => {
            return Err(IdentifyError::Campaign {
                place: "[identify]".to_owned(),
                what: format!("covariance = {other:?} is not known; use classical, HC3, cluster or serial"),
            });
        }
        None if source.kind != SourceKind::Cfd => {
            findings.extend(group_not_used(campaign, source));
            return Ok(if method == TABLE { Scatter::Classical } else { Scatter::Runs });
        }
        None => {}
    }
    let clusters = data.clusters();
    if clusters >= FEWEST_CLUSTERS {
        return Ok(Scatter::Cluster);
    }
    let text = format!(
        "residuals of CFD are model error, not noise, and alike within a configuration; intervals by cluster need a `group` of five and more, and \
         this source has {}: HC3 takes each row for itself",
        if clusters == 0 { "none".to_owned() } else { clusters.to_string() }
    );
    findings.push(Finding::new(Severity::Warning, "cfd-few-clusters", text));
    Ok(Scatter::Hc3)
}
