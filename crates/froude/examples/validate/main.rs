//! The validation page: every claim of the project beside the figure that a run gives.
//!
//! `validate --short` runs what the pipeline runs; `--full` runs 2,000 to 20,000 repetitions per coverage case and writes
//! `book/src/validation.md`. Names of parts after it run these alone (snake, tanks, predict, servo, two-mass, sweeps, carriage, decay, oscillation, rotation, sway, hour, steady, weights, accelerated, excited, swim, swim-coverage, cfd, cfd-moved, cfd-campaign, foreign, clocks,
//! dynamic, potential, facets, intervals, lints, power, coverage); no page is written then, unless `--page` asks for their sections to replace those of the page. A line that misses its bar fails the
//! run. A line whose data are absent counts as
//! skipped, never as passed. A finding is a figure that contradicts a paper or a data set: it is reported, not tuned.

mod accelerated;
mod best;
#[path = "../../../froude-panel/examples/coverage/bodies.rs"]
mod bodies;
mod carriage;
mod cfd;
mod cfd_evidence;
mod cfd_laws;
mod cfd_swing;
mod claims;
mod clocks;
// Its own example tells more of each row.
#[allow(dead_code, clippy::unwrap_used)]
#[path = "../../../froude-panel/examples/coverage/count.rs"]
mod count;
mod coverage;
mod decay;
mod driven;
mod dynamic;
mod eiv;
mod emps;
mod excited;
mod family;
mod flexible;
#[path = "../../../froude-carriage/tests/flexible_axis/mod.rs"]
mod flexible_axis;
#[path = "../../../froude-cfd/examples/known_flows/flows.rs"]
mod flows;
mod foreign;
mod hour;
mod intervals;
mod kvlcc2;
mod lints;
mod oscillation;
mod potential;
mod potential_facets;
mod potential_laws;
mod power;
mod predicted;
mod rm2;
mod rotation;
#[path = "../../../froude-carriage/tests/scenario/mod.rs"]
mod scenario;
mod snake;
mod steady;
mod sway;
mod sweeps;
mod swim;
mod swim_coverage;
mod swim_sources;
mod tessellations;
mod two_mass_rig;
mod weights;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use claims::{Claims, Verdict};

/// Repetitions per coverage case.
const FULL_REPETITIONS: usize = 20_000;
/// Repetitions in the short run.
const SHORT_REPETITIONS: usize = 2_000;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [hour::CHILD, campaign] = &arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        return match hour::child(Path::new(campaign)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("validate: {error}");
                ExitCode::FAILURE
            }
        };
    }
    let full = arguments.iter().any(|a| a == "--full");
    let chosen: Vec<&String> = arguments.iter().filter(|a| !a.starts_with("--")).collect();
    let started = Instant::now();
    let wants = |part: &str| {
        let is_wanted = chosen.is_empty() || chosen.iter().any(|c| *c == part);
        if is_wanted {
            eprintln!("validate: {part} from {:.0} s on", started.elapsed().as_secs_f64());
        }
        is_wanted
    };
    let is_part = arguments.iter().any(|a| a == "--page");
    let repetitions = if full { FULL_REPETITIONS } else { SHORT_REPETITIONS };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = std::env::var_os("FROUDE_SHARED_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from);
    let mut claims = Claims::default();
    // OpenFOAM solves on one core: its flows go beside the rest.
    let flows = |claims: &mut Claims| -> Result<(), Box<dyn std::error::Error>> {
        if wants("cfd") {
            cfd::all(claims, full)?;
        }
        if full && wants("cfd-moved") {
            cfd::moved(claims, &root)?;
        }
        if full && wants("cfd-campaign") {
            let pages = root.join("book/src");
            cfd::campaigns(claims, &root, (chosen.is_empty() || is_part).then_some(pages.as_path()))?;
        }
        Ok(())
    };
    let run = |claims: &mut Claims| -> Result<(), Box<dyn std::error::Error>> {
        if wants("snake") {
            snake::added_mass(claims, &root)?;
            snake::contradictions(claims, &root)?;
            snake::undetermined(claims)?;
            snake::dissipativity(claims, &root)?;
            snake::residuals(claims, &root)?;
            snake::recommendation(claims, &root, if full { 2_000 } else { 40 })?;
        }
        if wants("tanks") {
            rm2::all(claims, &root)?;
            kvlcc2::hmri(claims, &shared)?;
            kvlcc2::fhr(claims, &shared)?;
        }
        if wants("predict") {
            predicted::all(claims, &root)?;
        }
        if wants("servo") {
            emps::all(claims, &root)?;
        }
        if wants("two-mass") {
            flexible::coverage(claims, if full { 200 } else { 30 })?;
            two_mass_rig::coverage(claims, if full { 60 } else { 6 })?;
        }
        if wants("sweeps") {
            sweeps::coverage(claims, if full { 200 } else { 20 })?;
        }
        if wants("carriage") {
            carriage::all(claims, if full { 400 } else { 60 });
        }
        if wants("decay") {
            decay::all(claims, if full { 2_000 } else { 200 });
            decay::mamba(claims, &root, if full { 2_000 } else { 40 })?;
        }
        if wants("oscillation") {
            oscillation::all(claims, &root, if full { 2_000 } else { 30 })?;
        }
        if wants("rotation") {
            rotation::all(claims, &root, if full { 2_000 } else { 40 })?;
        }
        if wants("sway") {
            sway::all(claims, &root, if full { 2_000 } else { 40 })?;
        }
        if wants("hour") {
            // An hour, or two minutes: twenty-four periods are beyond a million rows too.
            hour::all(claims, &root, if full { 720 } else { 24 })?;
        }
        if wants("steady") {
            steady::all(claims, &root, if full { 4_000 } else { 60 })?;
        }
        if wants("weights") {
            weights::all(claims, &root, if full { 2_000 } else { 20 })?;
        }
        if wants("accelerated") {
            accelerated::all(claims, &root, if full { 4_000 } else { 40 })?;
        }
        if wants("excited") {
            excited::all(claims, &root, &shared, if full { 2_000 } else { 40 })?;
        }
        if wants("swim") {
            swim::all(claims, &root)?;
            let pages = root.join("book/src");
            swim_sources::all(claims, &root, (full && (chosen.is_empty() || is_part)).then_some(pages.as_path()))?;
        }
        if wants("swim-coverage") {
            swim_coverage::all(claims, &root, if full { 200 } else { 6 })?;
        }
        if wants("foreign") {
            foreign::all(claims, &root)?;
        }
        if wants("clocks") {
            clocks::all(claims, &shared)?;
        }
        if wants("dynamic") {
            dynamic::all(claims, &root, if full { 60 } else { 8 })?;
        }
        if wants("potential") {
            potential::all(claims, &root, full)?;
            potential_laws::all(claims, full)?;
        }
        // Full run only: a short one has too few bodies for an acceptance band.
        if full && wants("facets") {
            potential_facets::facets(claims)?;
        }
        if chosen.is_empty() {
            family::whole(claims);
        }
        if wants("intervals") {
            intervals::all(claims, &root, if full { 4_000 } else { 200 })?;
        }
        if wants("lints") {
            lints::clean(claims, if full { 10_000 } else { 200 })?;
            lints::short(claims, if full { 200_000 } else { 2_000 });
        }
        if full && wants("power") {
            power::all(claims)?;
        }
        if wants("coverage") {
            coverage::all(claims, &root, repetitions)?;
        }
        Ok(())
    };
    let done = std::thread::scope(|scope| {
        let beside = scope.spawn(|| {
            let mut own = Claims::default();
            flows(&mut own).map(|()| own).map_err(|error| error.to_string())
        });
        let done = run(&mut claims).map_err(|error| error.to_string());
        let own = beside.join().map_err(|_| "the flows panicked".to_owned()).flatten();
        done.and_then(|()| own.map(|own| claims.lines.extend(own.lines)))
    });
    if let Err(error) = done {
        eprintln!("validate: {error}");
        return ExitCode::FAILURE;
    }
    eprintln!("validate: {:.0} s", started.elapsed().as_secs_f64());
    print!("{}", claims.text());
    if full && (chosen.is_empty() || is_part) {
        let page = root.join("book/src/validation.md");
        let mut text = claims.page(repetitions);
        if !chosen.is_empty() {
            let old = std::fs::read_to_string(&page).unwrap_or_default();
            text = claims::with_sections_of(&old, &text);
        }
        if let Err(error) = std::fs::write(&page, claims::with_overview(&text)) {
            eprintln!("validate: {}: {error}", page.display());
            return ExitCode::FAILURE;
        }
        println!("written {}", page.display());
    }
    let count = |v: Verdict| claims.lines.iter().filter(|l| l.verdict == v).count();
    println!(
        "validate: {} passed, {} findings, {} measured, {} skipped, {} missed",
        count(Verdict::Pass),
        count(Verdict::Finding),
        count(Verdict::Measured),
        count(Verdict::Skipped),
        count(Verdict::Miss)
    );
    // Again at the end: hundreds of rows stand between a missed one and the last line of a log.
    for line in claims.lines.iter().filter(|line| line.verdict == Verdict::Miss) {
        println!("validate: missed: {}: {}", line.section, line.text());
    }
    if count(Verdict::Miss) == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
