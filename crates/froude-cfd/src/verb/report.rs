//! `froude cfd report`: how a campaign stands, its meshes, its forces, and pictures of its flows, on one page.
//!
//! | module | content |
//! | --- | --- |
//! | `convergence` | forces over the iterations of a case, and the window that was judged |
//! | `forces` | forces against angle and speed |
//! | `meshes` | quality of the meshes, and y+ |
//! | `pictures` | pressure on the surface, and the wake |
//! | `solved` | cases that have a result |

mod convergence;
mod forces;
mod meshes;
mod pictures;
mod solved;

use std::path::Path;

use froude_records::block::{Block, ResultColumn, Section, TableBuilder};
use froude_records::outcome::{Content, Head, Outcome, OutputFile};
use froude_records::page::Field;
use froude_records::text::counted;

use self::convergence::Convergence;
use self::pictures::Pictures;
use self::solved::Solved;
use super::asked::Asked;
use super::error::VerbError;
use super::status::of_store;
use crate::case::Case;
use crate::store::Store;

/// Cases that failed or diverged whose convergence is shown.
const MOST_TROUBLED: usize = 12;
/// Angles whose flows are shown where none are named, rad.
const TELLING_RAD: [f64; 3] = [0.0, std::f64::consts::FRAC_PI_4, std::f64::consts::FRAC_PI_2];

/// What is shown of a case.
#[derive(Debug)]
struct Shown {
    id: String,
    status: &'static str,
    iterations: usize,
    reason: String,
    /// The history of its forces, or why it cannot be shown.
    convergence: Result<Convergence, String>,
    /// Pictures of its flow, or why they cannot be drawn; `None` if they were not requested.
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

    /// Columns from the histories of cases.
    fn convergence_columns(t: &TableBuilder<'_, Self>) -> Vec<ResultColumn> {
        let window = |s: &Shown| s.convergence.as_ref().ok()?.window;
        let first = |s: &Shown| {
            let found = s.convergence.as_ref().ok()?;
            Some(found.first(found.window.as_ref()?))
        };
        vec![
            t.number("convergence/window/first", "judged from", first).plain(9),
            t.number("convergence/last", "to", |s| s.convergence.as_ref().ok().map(|c| c.last)).plain(9),
            t.count("convergence/window/iterations", "", |s| window(s).map(|w| w.length)),
            t.numbers("convergence/window/mean", "", |s| window(s).map(|w| w.mean.to_vec())),
            t.numbers("convergence/window/drift", "", |s| window(s).map(|w| w.drift.to_vec())),
            t.numbers("convergence/window/spread", "", |s| window(s).map(|w| w.spread.to_vec())),
            t.text("convergence/problem", "", |s| s.convergence.as_ref().err().cloned()),
        ]
    }

    /// Columns from the pictures of cases.
    fn picture_columns(t: &TableBuilder<'_, Self>) -> Vec<ResultColumn> {
        fn of(shown: &Shown) -> Option<&Pictures> {
            shown.pictures.as_ref()?.as_ref().ok()
        }
        let file = |field: &Field| format!("figures/{}.svg", field.name);
        vec![
            t.number("pictures/iteration", "", |s| of(s).map(|p| p.time)),
            t.interval("pictures/pressure_coefficient", "C_p", |s| of(s).map(|p| p.pressure_coefficient)).range(),
            t.numbers("pictures/pressure_force_n", "", |s| of(s).map(|p| p.pressure_force_n.to_vec())),
            t.number("pictures/largest_speed_ratio", "largest |U|/U", |s| of(s).map(|p| p.largest_speed_ratio))
                .places(2),
            t.text("pictures/surface", "", |s| of(s).map(|p| file(&p.surface))),
            t.text("pictures/wake", "", |s| of(s).map(|p| file(&p.wake))),
            t.text("pictures/problem", "", |s| s.pictures.as_ref()?.as_ref().err().cloned()),
        ]
    }
}

/// The page of a campaign with its figures, for the folder `out`; `named` are the cases whose flows are shown, or those of a few angles.
/// `tell` hears what is done.
///
/// # Errors
///
/// As the campaign is read; a case that it does not have, or that has no result.
pub fn report(
    campaign: &Path,
    source: Option<&str>,
    named: &[String],
    out: &Path,
    date: Option<String>,
    tell: &dyn Fn(&str),
) -> Result<Outcome, VerbError> {
    let asked = Asked::read(campaign, source)?;
    let store = Store::open(&asked.folder)?;
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
                let problem = "it has no result to show; froude cfd run computes it";
                Err(VerbError::input(&store.case_folder(id), problem))
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
    let section = |key: &str, title: &str, blocks| Section {
        key: key.to_owned(),
        title: title.to_owned(),
        blocks,
        is_detail: true,
    };
    let unshown = troubled.len().saturating_sub(MOST_TROUBLED);
    let mut blocks = vec![Block::text("", said(&shown, standings.counts()))];
    blocks.push(section("status", "Status", standings.blocks()).into());
    blocks.push(section("", "Meshes and y+", meshes::blocks(&solved)).into());
    blocks.push(section("", "Forces", forces::blocks(&solved)).into());
    blocks.push(section("", "Cases", cases(&shown, unshown)).into());
    let pictures = shown.iter().filter_map(|s| s.pictures.as_ref()?.as_ref().ok());
    let pictures: Vec<Block> = pictures.flat_map(Pictures::fields).map(Block::Field).collect();
    if !pictures.is_empty() {
        blocks.push(section("", "Pictures", pictures).into());
    }
    let head = Head {
        sort: "CFD campaign".to_owned(),
        title: asked.title,
        subtitle: format!("source {}, cases in {}", asked.source.name, store.root().display()),
        summary: "How it stands".to_owned(),
        date,
    };
    let files = vec![
        OutputFile { key: "report", path: out.join("report.html"), content: Content::Page(head) },
        OutputFile { key: "figures", path: out.join("figures"), content: Content::Figures },
    ];
    Ok(Outcome { blocks, files, ..Outcome::default() })
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

/// What a person reads at the terminal.
fn said(shown: &[Shown], counts: String) -> Vec<String> {
    let pictured = shown.iter().filter(|s| matches!(s.pictures, Some(Ok(_)))).map(|s| s.id.as_str());
    let pictured: Vec<&str> = pictured.collect();
    let mut out = vec![counts];
    if !pictured.is_empty() {
        out.push(format!("pictures of {}", pictured.join(", ")));
    }
    for shown in shown {
        if let Some(Err(why)) = &shown.pictures {
            out.push(format!("no pictures of {}: {why}", shown.id));
        }
    }
    out
}

/// On single cases.
fn cases(shown: &[Shown], unshown: usize) -> Vec<Block> {
    if shown.is_empty() {
        return vec![Block::text("", vec!["No case has a result yet.".to_owned()])];
    }
    let t = TableBuilder::new("cases", "Single cases: those that are shown, and those that failed or diverged.", shown);
    let mut columns: Vec<ResultColumn> = vec![
        t.text("case", "case", |s| s.id.clone()),
        t.text("is", "status", |s| s.status.to_owned()),
        t.count("iterations", "iterations", |s| s.iterations),
        t.text("reason", "reason", |s| s.reason.clone()),
    ];
    columns.extend(Shown::convergence_columns(&t));
    columns.extend(Shown::picture_columns(&t));
    let mut out = vec![t.build(columns).into()];
    if unshown > 0 {
        let more = counted(unshown, "more case", "more cases");
        out.push(Block::text("", vec![format!("{more} failed or diverged; --case with its name shows one.")]));
    }
    let charts = shown.iter().filter_map(|s| s.convergence.as_ref().ok());
    out.extend(charts.map(|c| Block::Chart(c.chart.clone())));
    out
}
