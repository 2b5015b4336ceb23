//! The report of a campaign: what its sources, records and findings say, put together for the page.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use froude_records::block::Section;
use froude_records::campaign::Campaign;
use froude_records::estimate::Estimate;
use froude_records::estimate::EstimateFile;
use froude_records::page::{InputFile, Report};
use froude_records::text::counted;

use super::{method, named, section, steps};
use crate::IdentifyError;
use crate::answer::Answer;

/// The whole report of a campaign; `blocks` are what methods state of their runs together.
///
/// # Errors
///
/// As [`section`].
pub fn report(
    campaign: &Campaign,
    file: &EstimateFile,
    sources: &[Answer],
    published: Vec<Estimate>,
    blocks: Vec<Section>,
    date: Option<String>,
) -> Result<Report, IdentifyError> {
    // A line per file and source that reads it; a file that several name is one file.
    let mut data: Vec<InputFile> = Vec::new();
    for d in file.data.values() {
        if data.iter().any(|seen| seen.path == d.path) {
            continue;
        }
        let line = InputFile { path: d.path.clone(), sha256: d.sha256.clone(), ..InputFile::default() };
        let readers = sources.iter().filter(|s| s.files().first().is_some_and(|f| f.path.ends_with(&d.path)));
        // The observations of several runs are those of no single file.
        let lines: Vec<InputFile> = readers
            .filter(|s| s.observations() > 0)
            .map(|s| {
                let is_alone = s.files().iter().filter(|f| f.role != "sidecar").count() == 1;
                InputFile {
                    n_rows: s.fitted().filter(|_| is_alone).map(|fitted| fitted.n_read),
                    n_used: is_alone.then(|| s.observations()),
                    source: Some(s.name().to_owned()),
                    ..line.clone()
                }
            })
            .collect();
        data.extend(if lines.is_empty() { vec![line] } else { lines });
    }
    Ok(Report {
        title: campaign.name.clone(),
        subtitle: subtitle(sources, &published),
        blocks: (sources.iter().flat_map(named::sections))
            .chain(blocks)
            .chain(steps::section(file.data.values()))
            .collect(),
        date,
        method: method::sentences(campaign, sources, &published),
        sources: sources.iter().map(section).collect::<Result<_, _>>()?,
        published,
        findings: file.findings.clone(),
        data,
        versions: file.versions.clone(),
        citations: campaign.cite.clone(),
        comparison: file.comparison.clone().filter(|c| !c.coefficients.is_empty() || !c.loads.is_empty()),
    })
}

fn subtitle(sources: &[Answer], published: &[Estimate]) -> String {
    // Several laws of the same files have the same observations.
    let mut of_files: BTreeMap<Vec<&Path>, usize> = BTreeMap::new();
    for source in sources {
        let files = source.files().iter().map(|file| file.path.as_path()).collect();
        let most = of_files.entry(files).or_default();
        *most = source.observations().max(*most);
    }
    let observations: usize = of_files.values().sum();
    if sources.is_empty() {
        return format!("{} side by side", counted(published.len(), "estimate", "estimates"));
    }
    let name = |s: &Answer| s.estimates().first().map_or_else(|| s.name().to_owned(), |e| e.source.clone());
    let names: BTreeSet<String> = sources.iter().map(name).collect();
    let what = if observations > 0 {
        counted(observations, "observation", "observations")
    } else {
        counted(sources.iter().map(|s| s.estimates().len()).sum(), "estimate", "estimates")
    };
    let mut out = format!("{what} from {}", counted(names.len(), "source", "sources"));
    if !published.is_empty() {
        out += &format!(", beside {}", counted(published.len(), "published estimate", "published estimates"));
    }
    out
}
