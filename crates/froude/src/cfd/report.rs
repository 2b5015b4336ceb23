//! `froude cfd report`: how a campaign stands, its meshes, its forces, and pictures of its flows, on one page.
//!
//! | module | content |
//! | --- | --- |
//! | `convergence` | forces over the iterations of a case, and the window that was judged |
//! | `forces` | forces against angle and speed |
//! | `meshes` | quality of the meshes, and y+ |
//! | `pictures` | pressure on the surface, and the wake |

mod convergence;
mod forces;
mod meshes;
mod pictures;

use std::path::{Path, PathBuf};

use froude_cfd::again::Again;
use froude_cfd::case::Case;
use froude_cfd::outcome::Outcome;
use froude_cfd::result::attempt_folder;
use froude_cfd::store::{State, Store};
use froude_records::RecordError;
use froude_records::page::{Chart, DocumentSection, TextTable};
use froude_records::text::counted;
use froude_records::write::write_atomically;
use froude_report::chart;
use froude_report::document::Document;
use serde_json::{Value, json};

use self::convergence::Convergence;
use self::pictures::Pictures;
use super::status::{Standings, of_store};
use super::{Asked, CfdInput};
use crate::pipeline::default_out;
use crate::{Error, results};

/// Cases that failed or diverged whose convergence is shown.
const MOST_TROUBLED: usize = 12;
/// Angles whose flows are shown where none are named, rad.
const TELLING_RAD: [f64; 3] = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2];

/// A page that was written.
#[derive(Debug)]
pub struct Reported {
    /// The page.
    pub report: PathBuf,
    /// Its figures, a file each.
    pub figures: Vec<PathBuf>,
    standings: Standings,
    meshes: Value,
    forces: Value,
    shown: Vec<Shown>,
}

/// A case that has a result.
#[derive(Debug, Clone)]
struct Solved {
    case: Case,
    outcome: Outcome,
    /// Where it was solved.
    folder: PathBuf,
    mesh: PathBuf,
}

impl Solved {
    fn of(store: &Store, id: &str) -> Result<Option<Self>, Error> {
        let State::Done(attempted) = store.state(id) else { return Ok(None) };
        let case = store.case(id)?;
        Ok(Some(Self {
            folder: attempt_folder(&store.case_folder(id), attempted.attempt),
            mesh: store.mesh_folder(&case),
            outcome: attempted.outcome,
            case,
        }))
    }

    /// Whether it computes another again, and enters no fit.
    fn is_repeat(&self) -> bool {
        Again::of(&self.case.id).is_some()
    }
}

/// What is shown of a case.
#[derive(Debug)]
struct Shown {
    id: String,
    status: &'static str,
    iterations: usize,
    reason: String,
    /// Or why there is none.
    convergence: Result<Convergence, String>,
    /// Or why there are none; `None` where they were not asked for.
    pictures: Option<Result<Pictures, String>>,
}

impl Shown {
    fn of(solved: &Solved, has_pictures: bool) -> Self {
        Self {
            id: solved.case.id.clone(),
            status: solved.outcome.status.word(),
            iterations: solved.outcome.iterations,
            reason: solved.outcome.reason.clone(),
            convergence: Convergence::of(solved),
            pictures: has_pictures.then(|| Pictures::of(solved)),
        }
    }
}

/// Writes the page of a campaign with its figures into `out`, a folder beside the campaign where it names none; `named` are the cases whose flows are shown, or those of a few angles. `tell` hears what is done.
///
/// # Errors
///
/// As the campaign is read; a case that it does not have, or that has no result; a folder that cannot be written.
pub fn report(
    campaign: &Path,
    source: Option<&str>,
    named: &[String],
    out: Option<&Path>,
    date: Option<String>,
    tell: &dyn Fn(&str),
) -> Result<Reported, Error> {
    let asked = Asked::read(campaign, source)?;
    let store = Store::open(&asked.folder)?;
    let out = out.map_or_else(|| default_out(campaign, "cfd"), Path::to_owned);
    results::can_be_written(&out)?;
    tell("results");
    let standings = of_store(&store, &asked);
    let mut solved = Vec::new();
    for id in store.ids() {
        solved.extend(Solved::of(&store, id)?);
    }
    let chosen = if named.is_empty() {
        telling(&solved)
    } else {
        let place = |id: &String| match solved.iter().position(|s| s.case.id == *id) {
            Some(place) => Ok(place),
            None => {
                store.case(id)?;
                let problem = "it has no result to show; froude cfd run computes it".to_owned();
                Err(Error::from(CfdInput { path: store.case_folder(id), problem }))
            }
        };
        named.iter().map(place).collect::<Result<_, _>>()?
    };
    let troubled = solved.iter().enumerate().filter(|(i, s)| !s.outcome.status.is_usable() && !chosen.contains(i));
    let troubled: Vec<usize> = troubled.map(|(i, _)| i).collect();
    let mut shown = Vec::new();
    for (index, has_pictures) in
        chosen.iter().map(|i| (*i, true)).chain(troubled.iter().take(MOST_TROUBLED).map(|i| (*i, false)))
    {
        tell(&solved[index].case.id);
        shown.push(Shown::of(&solved[index], has_pictures));
    }
    tell("meshes");
    let (meshes, meshes_json) = meshes::section(&solved);
    let unshown = troubled.len().saturating_sub(MOST_TROUBLED);
    let page = Document {
        sort: "CFD campaign".to_owned(),
        title: asked.title,
        subtitle: format!("source {}, cases in {}", asked.source.name, store.root().display()),
        date,
        sections: vec![standings.section(), meshes, forces::section(&solved), cases(&shown, unshown)],
        fields: shown.iter().filter_map(|s| s.pictures.as_ref()?.as_ref().ok()).flat_map(Pictures::fields).collect(),
        ..Document::default()
    };
    tell("the page");
    let figures = write(&out, &page)?;
    Ok(Reported {
        report: out.join("report.html"),
        figures: figures.into_iter().map(|name| out.join("figures").join(name)).collect(),
        standings,
        meshes: meshes_json,
        forces: forces::as_json(&solved),
        shown,
    })
}

/// Those whose flows say most: of the configuration in the middle, at its highest speed with several angles, head on, at 45° and at 90° or as near as there are.
fn telling(solved: &[Solved]) -> Vec<usize> {
    let usable: Vec<(usize, &Case)> = (solved.iter().enumerate())
        .filter(|(_, s)| s.outcome.status.is_usable() && !s.is_repeat() && s.case.flow.pitch_rad == 0.0)
        .map(|(i, s)| (i, &s.case))
        .collect();
    let mut names: Vec<&str> = usable.iter().map(|(_, c)| c.configuration.as_str()).collect();
    names.dedup();
    let Some(name) = names.get(names.len() / 2) else { return Vec::new() };
    let own: Vec<(usize, &Case)> = usable.into_iter().filter(|(_, c)| c.configuration == *name).collect();
    let angles = |speed: f64| own.iter().filter(|(_, c)| c.flow.speed_m_s == speed).count();
    let most = own.iter().max_by(|(_, a), (_, b)| {
        let rank = |c: &Case| (angles(c.flow.speed_m_s).min(TELLING_RAD.len()), c.flow.speed_m_s);
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let Some(speed) = most.map(|(_, c)| c.flow.speed_m_s) else { return Vec::new() };
    let mut chosen = Vec::new();
    for angle_rad in TELLING_RAD {
        let off = |c: &Case| (c.flow.angle_rad.abs() - angle_rad).abs();
        let of_speed = own.iter().filter(|(_, c)| c.flow.speed_m_s == speed);
        let nearest = of_speed.min_by(|(_, a), (_, b)| off(a).total_cmp(&off(b))).map(|(i, _)| *i);
        chosen.extend(nearest.filter(|i| !chosen.contains(i)));
    }
    chosen
}

/// The section on single cases.
fn cases(shown: &[Shown], unshown: usize) -> DocumentSection {
    let row = |s: &Shown| {
        let (window, converges) = match &s.convergence {
            Ok(found) => (found.window_words(), String::new()),
            Err(why) => (String::new(), why.clone()),
        };
        let (pressure, speed, pictured) = match &s.pictures {
            None => <(String, String, String)>::default(),
            Some(Ok(found)) => (found.pressure_words(), found.speed_words(), String::new()),
            Some(Err(why)) => (String::new(), String::new(), why.clone()),
        };
        let because = [s.reason.as_str(), &converges, &pictured];
        let because: Vec<&str> = because.into_iter().filter(|words| !words.is_empty()).collect();
        vec![s.id.clone(), s.status.to_owned(), s.iterations.to_string(), window, pressure, speed, because.join("; ")]
    };
    let mut paragraphs = Vec::new();
    if shown.is_empty() {
        paragraphs.push("No case has a result yet.".to_owned());
    }
    if unshown > 0 {
        let more = counted(unshown, "more case", "more cases");
        paragraphs.push(format!("{more} failed or diverged; --case with its name shows one."));
    }
    let head = ["case", "is", "iterations", "judged over", "C_p", "largest |U|/U", "because"];
    let table = TextTable {
        caption: "Single cases: those that are shown, and those that failed or diverged.".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: shown.iter().map(row).collect(),
    };
    DocumentSection {
        title: "Cases".to_owned(),
        paragraphs,
        tables: if shown.is_empty() { Vec::new() } else { vec![table] },
        charts: shown.iter().filter_map(|s| s.convergence.as_ref().ok()).map(|c| c.chart.clone()).collect(),
    }
}

/// Writes page and figures in one folder; the names of the figures.
fn write(out: &Path, page: &Document) -> Result<Vec<String>, Error> {
    let charts = page.sections.iter().flat_map(|s| &s.charts);
    let mut figures: Vec<(String, String)> =
        charts.map(|c: &Chart| Ok((format!("{}.svg", c.name), chart::svg(c)?))).collect::<Result<_, Error>>()?;
    for field in &page.fields {
        figures.push((format!("{}.svg", field.name), field.svg()?));
    }
    let html = page.html()?;
    results::replace(out, |folder| {
        let place = folder.join("figures");
        std::fs::create_dir(&place).map_err(|source| RecordError::output(&place, &source))?;
        for (name, svg) in &figures {
            write_atomically(&place.join(name), svg.as_bytes())?;
        }
        Ok(write_atomically(&folder.join("report.html"), html.as_bytes())?)
    })?;
    Ok(figures.into_iter().map(|(name, _)| name).collect())
}

impl Reported {
    /// What a person reads at the terminal.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let counts = self.standings.counts();
        let pictured: Vec<&str> =
            self.shown.iter().filter(|s| matches!(s.pictures, Some(Ok(_)))).map(|s| s.id.as_str()).collect();
        let mut paragraphs = vec![counts];
        if !pictured.is_empty() {
            paragraphs.push(format!("pictures of {}", pictured.join(", ")));
        }
        for shown in &self.shown {
            if let Some(Err(why)) = &shown.pictures {
                paragraphs.push(format!("no pictures of {}: {why}", shown.id));
            }
        }
        DocumentSection { title: "Report".to_owned(), paragraphs, ..DocumentSection::default() }
    }

    /// All that the page has, for a program, in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let case = |s: &Shown| {
            json!({
                "case": s.id,
                "is": s.status,
                "iterations": s.iterations,
                "reason": s.reason,
                "convergence": s.convergence.as_ref().map_or_else(|why| json!({"problem": why}), Convergence::as_json),
                "pictures": s.pictures.as_ref().map(|p| {
                    p.as_ref().map_or_else(|why| json!({"problem": why}), Pictures::as_json)
                }),
            })
        };
        json!({
            "report": self.report,
            "figures": self.figures,
            "status": self.standings.as_json(),
            "meshes": self.meshes,
            "forces": self.forces,
            "cases": self.shown.iter().map(case).collect::<Vec<_>>(),
        })
    }
}
