//! The report of a campaign: what its sources, records and findings say, put together for the page.

use std::collections::BTreeSet;

use froude_identify::IdentifyError;
use froude_identify::answer::Answer;
use froude_identify::page::{method, section};
use froude_records::campaign::Campaign;
use froude_records::estimate::Estimate;
use froude_records::page::DocumentSection;
use froude_records::text::counted;
use froude_report::{InputFile, Report};

use crate::pipeline::Outcome;

/// The whole report of a campaign.
pub fn report(
    campaign: &Campaign,
    outcome: &Outcome,
    published: Vec<Estimate>,
    blocks: Vec<DocumentSection>,
    date: Option<String>,
) -> Result<Report, IdentifyError> {
    let Outcome { file, sources, summaries, .. } = outcome;
    // A line per file and source that reads it; a file that several name is one file.
    let mut data: Vec<InputFile> = Vec::new();
    for d in file.data.values() {
        if data.iter().any(|seen| seen.path == d.path) {
            continue;
        }
        let line = InputFile { path: d.path.clone(), sha256: d.sha256.clone(), ..InputFile::default() };
        let readers = sources.iter().filter(|s| s.files().first().is_some_and(|f| f.path.ends_with(&d.path)));
        let lines: Vec<InputFile> = readers
            .filter(|s| s.observations() > 0)
            .map(|s| InputFile {
                n_rows: s.fitted().map(|fitted| fitted.n_read),
                n_used: Some(s.observations()),
                source: Some(s.name().to_owned()),
                ..line.clone()
            })
            .collect();
        data.extend(if lines.is_empty() { vec![line] } else { lines });
    }
    Ok(Report {
        title: campaign.name.clone(),
        subtitle: subtitle(sources, &published),
        blocks: summaries.iter().map(|summary| summary.section.clone()).chain(blocks).collect(),
        date,
        method: method::sentences(campaign, sources),
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
    let observations: usize = sources.iter().map(Answer::observations).sum();
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

#[cfg(test)]
mod tests {
    use super::*;
    use froude_identify::source::identify_source;
    use froude_report::Against;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// Six speeds at nine angles, each run twice; no speed is measured twice as the same number.
    #[test]
    fn a_drift_test_has_a_line_for_every_speed() {
        let mut rng = Pcg64::new(7, 0);
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
        for speed in [0.3, 0.5, 0.7, 0.9, 1.1, 1.3] {
            for i in -4..=4 {
                for _ in 0..2 {
                    let (u, angle) = (speed * (1.0 + 0.003 * noise()), 5.0 * f64::from(i) + 0.05 * noise());
                    let (x, y) = (u * angle.to_radians().cos(), -u * angle.to_radians().sin());
                    table += &format!(
                        "{u},{angle},{},{}\n",
                        -5.0 * x * x + 0.01 * noise(),
                        -90.0 * y * y.abs() + 0.01 * noise()
                    );
                }
            }
        }
        // A speed that was run straight ahead only: no line against angle, but its points.
        table += "1.7,0,-14.45,0.0\n1.7,0,-14.46,0.01\n";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drift.csv");
        std::fs::write(&path, table).unwrap();
        let mut campaign = Campaign::of_table(&path, None);
        campaign.identify.models = vec!["quadratic".to_owned()];
        let source = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
        let section = section(&Answer::from(source)).unwrap();
        let speeds: Vec<f64> = section
            .curves
            .iter()
            .filter(|c| c.component == "f_y")
            .filter_map(|c| match c.against {
                Against::Angle { speed_m_s } => Some(speed_m_s),
                _ => None,
            })
            .collect();
        assert_eq!(speeds.len(), 6, "{speeds:?}");
        for (found, run) in speeds.iter().zip([0.3, 0.5, 0.7, 0.9, 1.1, 1.3]) {
            assert!((found / run - 1.0).abs() < 0.005, "{found} for {run}");
        }
        let report = Report { sources: vec![section], ..Report::default() };
        let figures = froude_report::figures(&report).unwrap();
        let drift = figures.iter().find(|f| f.title.ends_with("f_y against angle")).unwrap();
        assert!(!drift.caption.contains("not drawn"), "{}", drift.caption);
        assert!(drift.svg.contains("other speeds"), "the points at 1.7 m/s");
    }
}
