//! What 95 % means at the verb: tables of a known truth go through a campaign as a user's do, and what the answer says is counted.
//!
//! Every row has its own generator and seeds. Rows that are exact are judged two-sided at their binomial scatter, approximate ones against their floor; widths against those
//! that the same tables give another way.

mod choice;
mod f4;
mod groups;
mod stated;
mod uneven;

pub use groups::six_setups;

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use froude::identify::envelope::of_source;
use froude::identify::source::{SourceResult, identify_source};
use froude::records::campaign::Campaign;
use froude::records::campaign_file::read_campaign;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};

const ROOM: &str = "What 95 % means: intervals and tests at the verb";
/// Standard deviations of a count that a row may lie off.
const BAND: f64 = 3.0;

/// What answers without an interval are counted under.
const WITHOUT: &str = "no interval";
/// What tables that are refused are counted under.
const REFUSED: &str = "refused";

type Failed = Box<dyn Error>;

/// What one table's answer says of a question: held or not, and how wide.
#[derive(Debug, Clone, Copy)]
pub struct Said {
    pub holds: bool,
    pub width: f64,
}

/// A question over all seeds.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    name: String,
    holds: u64,
    width: f64,
    count: u64,
}

impl Tally {
    /// Of so many seeds with one answer each.
    fn of(name: &str, said: &[Said]) -> Self {
        Self {
            name: name.to_owned(),
            holds: said.iter().filter(|said| said.holds).count() as u64,
            width: said.iter().map(|said| said.width).sum(),
            count: said.len() as u64,
        }
    }

    pub fn percent(&self) -> f64 {
        100.0 * self.holds as f64 / self.count as f64
    }

    fn width(&self) -> f64 {
        self.width / self.count as f64
    }
}

/// Tables of seeds through one campaign; `table` writes the rows, `judge` reads the answer. A table without answer is counted as one that does not hold.
pub fn run(
    campaign: &str,
    seeds: u64,
    stream: u128,
    table: impl Fn(&mut Pcg64) -> String + Sync,
    judge: impl Fn(&SourceResult) -> Vec<(String, Said)> + Sync,
) -> Result<Vec<Tally>, Failed> {
    let found: Result<Vec<Vec<(String, Said)>>, String> = (0..seeds)
        .into_par_iter()
        .map_init(
            || room(campaign),
            |room, seed| {
                let (folder, campaign) = room.as_ref().map_err(Clone::clone)?;
                let text = table(&mut Pcg64::new(u128::from(seed), stream));
                std::fs::write(folder.path().join("table.csv"), text).map_err(|e| e.to_string())?;
                // A refusal is an answer too, and holds nothing.
                Ok(match identify_source(campaign, &campaign.sources[0], &|_| {}) {
                    Ok(found) => judge(&found),
                    Err(_) => vec![(REFUSED.to_owned(), Said { holds: false, width: 0.0 })],
                })
            },
        )
        .collect();
    let mut out: Vec<Tally> = Vec::new();
    for (name, said) in found?.into_iter().flatten() {
        let place = out.iter().position(|tally| tally.name == name).unwrap_or_else(|| {
            out.push(Tally { name, ..Tally::default() });
            out.len() - 1
        });
        let tally = &mut out[place];
        tally.holds += u64::from(said.holds);
        tally.width += said.width;
        tally.count += 1;
    }
    Ok(out)
}

/// A folder with a campaign, which is read once.
pub fn room(text: &str) -> Result<(tempfile::TempDir, Campaign), String> {
    let shared = Path::new("/dev/shm");
    let folder = if shared.is_dir() { tempfile::tempdir_in(shared) } else { tempfile::tempdir() };
    let folder = folder.map_err(|e| e.to_string())?;
    let path = folder.path().join("campaign.toml");
    // What a campaign names has to be there when it is read.
    std::fs::write(folder.path().join("tare.json"), "{}").map_err(|e| e.to_string())?;
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    std::fs::write(folder.path().join("table.csv"), "speed [m/s],f_x [N]\n1,-1\n").map_err(|e| e.to_string())?;
    let campaign = read_campaign(&path).map_err(|e| e.to_string())?;
    Ok((folder, campaign))
}

/// A campaign of one table, with more keys of its source and sections.
pub fn campaign(rest: &str) -> String {
    format!(
        "schema = 1\nname = \"a known truth\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\ntable = \"table.csv\"\n{rest}"
    )
}

/// The same under a name, or that there is none.
fn told(found: &SourceResult, name: &str, truth: f64, words: &str) -> (String, Said) {
    interval(found, 0, name, truth).map_or_else(
        || (format!("{name}{words}: {WITHOUT}"), Said { holds: false, width: 0.0 }),
        |said| (format!("{name}{words}"), said),
    )
}

/// Whether the interval of a coefficient in the record of a law holds a truth.
fn interval(found: &SourceResult, index: usize, name: &str, truth: f64) -> Option<Said> {
    let [low, high] = found.estimates.get(index)?.coefficients.get(name)?.interval_95?;
    Some(Said { holds: low <= truth && truth <= high, width: high - low })
}

/// Loads of the recommended law at each row, with the ends of their band: the envelope over all laws that the data do not contradict.
fn band(found: &SourceResult) -> Vec<[f64; 3]> {
    let bands = of_source(found, &found.data).unwrap_or_default();
    bands.iter().map(|band| [band.load, band.low, band.high]).collect()
}

/// Counts beside a floor: an exact row two-sided, another one from below.
fn judged(claims: &mut Claims, what: &str, tally: &Tally, floor: f64, exact: bool, more: &str) {
    let n = tally.count as f64;
    let scatter = BAND * 100.0 * (0.01 * floor * (1.0 - 0.01 * floor) / n).sqrt();
    let found = tally.percent();
    if tally.name == REFUSED {
        claims.holds(
            ROOM,
            &format!("{what}: tables refused"),
            "1 at most",
            format!("{} of those asked", tally.count),
            n <= 1.0,
        );
        return;
    }
    if tally.name.ends_with(WITHOUT) {
        let found = format!("{} tables, and the count beside is of the others", tally.count);
        claims.add(ROOM, &format!("{what}: {}", tally.name), "reported", found, Verdict::Measured);
        return;
    }
    let holds = found >= floor - scatter && (!exact || found <= floor + scatter);
    let band =
        if exact { format!("{floor} ± {scatter:.2} %") } else { format!("{floor} % at least, less {scatter:.2}") };
    claims.holds(
        ROOM,
        &format!("{what}: {}", tally.name),
        &band,
        format!("{found:.2} % of {}{more}", tally.count),
        holds,
    );
}

/// All rows; `seeds` tables each.
pub fn all(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    choice::all(claims, seeds)?;
    f4::all(claims, root, seeds)?;
    stated::all(claims, seeds)?;
    groups::all(claims, seeds)?;
    uneven::all(claims, seeds)?;
    Ok(())
}

/// Speeds of 16 runs.
fn sixteen() -> Vec<f64> {
    (0..16).map(|i| 0.2 + 0.12 * f64::from(i)).collect()
}

fn rows(speed: &[f64], force: impl FnMut(usize, f64) -> f64) -> String {
    let mut force = force;
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for (i, u) in speed.iter().enumerate() {
        let _ = writeln!(out, "{u},{}", force(i, *u));
    }
    out
}

/// Alarms of sound tables: at most so many per cent.
fn rare(claims: &mut Claims, what: &str, tally: &Tally, level: f64) {
    let scatter = BAND * 100.0 * (0.01 * level * (1.0 - 0.01 * level) / tally.count as f64).sqrt();
    let found = tally.percent();
    let band = format!("{level} % at most, and {scatter:.2}");
    claims.holds(
        ROOM,
        &format!("{what}: {}", tally.name),
        &band,
        format!("{found:.2} % of {}", tally.count),
        found <= level + scatter,
    );
}

/// Mean width beside that of the same tables another way, of which it may be a part at most; measured without one.
fn capped(claims: &mut Claims, what: &str, [width, other]: [f64; 2], (most, words): (Option<f64>, &str)) {
    let (what, part) = (format!("{what}: width"), width / other);
    let found = format!("{part:.3} of it ({width:.3} of {other:.3})");
    match most {
        Some(most) => claims.holds(ROOM, &what, &format!("{most} of {words} at most"), found, part <= most),
        None => claims.add(ROOM, &what, &format!("beside {words}"), found, Verdict::Measured),
    }
}

/// Whether a finding of a code is there.
fn alarm(code: &'static str) -> impl Fn(&SourceResult) -> Vec<(String, Said)> + Sync {
    move |found| vec![(code.to_owned(), Said { holds: found.findings.iter().any(|f| f.code == code), width: 0.0 })]
}
