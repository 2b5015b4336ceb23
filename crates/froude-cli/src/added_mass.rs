//! `froude added-mass`: parse, call, print.

use std::path::{Path, PathBuf};

use froude::Error;
use froude::added_mass::body::{self, BodyJob, BodyOutcome};
use froude::added_mass::frame::{Axes, Direction, Orientation, Point};
use froude::added_mass::links::{LinksJob, LinksOutcome, links, no_fits};
use froude::added_mass::load::Loaded;
use froude::added_mass::refine::{Forecast, Wanted, duration};
use froude::added_mass::several::{Apart, SeveralOutcome, several};
use froude::added_mass::{page, repair};
use froude::records::page::TextTable;
use froude::records::plausible;
use froude::records::units::{Dimension, parse_quantity, parse_unit};

use crate::args::{AddedMassArgs, BodyAxes, Export, MeshAxis};
use crate::out::{note, say};
use crate::print;

/// Links at most: more are a slip of the keyboard.
const MOST_LINKS: usize = 100;

pub fn added_mass(args: AddedMassArgs, json: bool) -> Result<(), Error> {
    renamed(&args)?;
    go_together(&args)?;
    if let Some(target) = &args.repair {
        return put_right(&args, target, json);
    }
    let wanted = Wanted {
        tolerance: ratio("--tolerance", &args.tolerance)?,
        most_panels: args.most_panels,
        ..Wanted::default()
    };
    let counted = args.links.as_deref().map(link_numbers).transpose()?;
    let density_kg_m3 = args.density.as_deref().map(density).transpose()?;
    if let Some(numbers) = counted.as_ref().filter(|n| n.len() > 1 && !args.check) {
        only_one(&args)?;
        let job = LinksJob {
            body: args.input,
            links: numbers.clone(),
            density_kg_m3,
            axes: args.axes.map_or(Axes::Mesh, axes),
            wanted,
            out: args.out,
            date: Some(crate::today()),
        };
        let bar = crate::spinner();
        let outcome = links(&job, &|step| bar.set_message(step.to_owned()))?;
        bar.finish_and_clear();
        replaced(outcome.replaced.as_deref(), json);
        if json {
            return print::json(&outcome.file);
        }
        table_of_links(&outcome);
        return Ok(());
    }
    let job = BodyJob {
        input: args.input,
        links: counted.as_ref().map(|n| n[0]),
        density_kg_m3,
        axes: args.axes.map_or(Axes::Mesh, axes),
        at: args.at.as_deref().map_or(Ok(Point::At([0.0; 3])), point)?,
        unit_m: args.unit.as_deref().map(unit).transpose()?,
        orientation: orientation(args.forward, args.up)?,
        tank_m: args.tank.as_deref().map(tank).transpose()?,
        surface_m: args.surface.as_deref().map(|h| length("--surface", h)).transpose()?,
        wanted,
        export: args.export.iter().map(|e| extension(*e)).collect(),
        out: args.out,
        date: Some(crate::today()),
    };
    if args.check {
        return check(&job, counted.as_deref().unwrap_or_default(), json);
    }
    let angle_rad = args.joint_angle.as_deref().map(angle).transpose()?;
    let apart = match (args.chain || angle_rad.is_some(), args.apart) {
        (true, _) => Some(Apart::Links { joint_angle_rad: angle_rad.unwrap_or(0.0) }),
        (false, true) => Some(Apart::Parts),
        (false, false) => None,
    };
    if let Some(apart) = apart {
        let why = if job.surface_m.is_some() {
            "--surface goes with one rigid body, not with --chain or --apart"
        } else if args.at.is_some() {
            "--at goes with one rigid body; with --chain or --apart every part is about its own point"
        } else {
            ""
        };
        if !why.is_empty() {
            return Err(Error::Nothing(why.to_owned()));
        }
        let bar = crate::spinner();
        let outcome = several(&job, apart, &|step| bar.set_message(step.to_owned()))?;
        bar.finish_and_clear();
        replaced(outcome.replaced.as_deref(), json);
        if json {
            return print::json(&outcome.file);
        }
        parts(&outcome);
        return Ok(());
    }
    let bar = crate::spinner();
    let outcome = body::body(&job, &|step| bar.set_message(step.to_owned()))?;
    bar.finish_and_clear();
    replaced(outcome.replaced.as_deref(), json);
    if json {
        return print::json(&outcome.file);
    }
    one_body(&outcome);
    Ok(())
}

const fn extension(format: Export) -> &'static str {
    match format {
        Export::Wamit => "1",
        Export::Capytaine => "nc",
        Export::Csv => "csv",
    }
}

fn wrong(option: &str, text: &str, why: impl std::fmt::Display) -> Error {
    Error::Nothing(format!("{option} {text:?}: {why}"))
}

fn quantity(option: &str, text: &str, dimension: Dimension) -> Result<f64, Error> {
    let usual = match dimension {
        Dimension::DENSITY => "kg/m^3",
        Dimension::LENGTH => "m",
        _ => "%",
    };
    let q = parse_quantity(text).map_err(|e| wrong(option, text, e.expecting(text, dimension, usual)))?;
    q.expect(dimension).map_err(|e| wrong(option, text, e))
}

/// A density of water, or 1 kg/m³ for added mass over ρ.
fn density(text: &str) -> Result<f64, Error> {
    let rho = positive("--density", text, Dimension::DENSITY)?;
    match plausible::density_of_displaced_water(rho) {
        Some(problem) => Err(wrong("--density", text, format!("it {problem}"))),
        None => Ok(rho),
    }
}

fn positive(option: &str, text: &str, dimension: Dimension) -> Result<f64, Error> {
    match quantity(option, text, dimension)? {
        x if x > 0.0 => Ok(x),
        _ => Err(wrong(option, text, "it must be larger than zero")),
    }
}

fn length(option: &str, text: &str) -> Result<f64, Error> {
    quantity(option, text, Dimension::LENGTH)
}

fn angle(text: &str) -> Result<f64, Error> {
    let q =
        parse_quantity(text).map_err(|e| wrong("--joint-angle", text, e.expecting(text, Dimension::ANGLE, "deg")))?;
    q.expect(Dimension::ANGLE).map_err(|e| wrong("--joint-angle", text, e))
}

fn ratio(option: &str, text: &str) -> Result<f64, Error> {
    match quantity(option, text, Dimension::ONE)? {
        x if x > 0.0 && x < 1.0 => Ok(x),
        _ => Err(wrong(option, text, "write a part above 0 and below 100 %: \"1 %\"")),
    }
}

fn unit(text: &str) -> Result<f64, Error> {
    let unit = parse_unit(text).ok().filter(|unit| unit.dimension == Dimension::LENGTH);
    let unit = unit.ok_or_else(|| wrong("--unit", text, "write a unit of length: mm, cm, m, in"))?;
    Ok(unit.to_si(1.0))
}

/// `3`, `1..9` (both ends), `1,3,6`.
fn link_numbers(text: &str) -> Result<Vec<usize>, Error> {
    let bad = || {
        wrong("--links", text, format!("write a number of links, \"1..9\" or \"1,3,6\", between 1 and {MOST_LINKS}"))
    };
    let one = |t: &str| t.trim().parse::<usize>().ok().filter(|n| (1..=MOST_LINKS).contains(n)).ok_or_else(bad);
    if let Some((from, to)) = text.split_once("..") {
        let (from, to) = (one(from)?, one(to.trim_start_matches('='))?);
        return if from <= to { Ok((from..=to).collect()) } else { Err(bad()) };
    }
    let mut out = text.split(',').map(one).collect::<Result<Vec<_>, _>>()?;
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

/// What an option was called before says what it is called now.
fn renamed(args: &AddedMassArgs) -> Result<(), Error> {
    if let Some(z) = &args.z {
        let up = if z == "down" { "--up -z" } else { "--up z" };
        return Err(Error::Nothing(format!(
            "--z is now --up: write {up} for how the mesh lies, and --axes ned or enu for the axes of the result"
        )));
    }
    if let Some(origin) = &args.origin {
        let at = if origin.trim() == "buoyancy" { "cb".to_owned() } else { format!("{origin:?}") };
        return Err(Error::Nothing(format!("--origin is now --at: write --at {at}")));
    }
    Ok(())
}

/// Options that say nothing without another.
fn go_together(args: &AddedMassArgs) -> Result<(), Error> {
    let why = if args.tank.is_some() && args.surface.is_none() {
        "--tank says how deep the water is, and not where the body lies in it: add --surface, the height of the water's surface over the origin of \
         the mesh, such as --surface \"0.5 m\""
    } else if args.weld.is_some() && args.repair.is_none() {
        "--weld is for a repair: add --repair FILE, the mesh to be written (.obj or .stl)"
    } else {
        return Ok(());
    };
    Err(Error::Nothing(why.to_owned()))
}

const fn axes(axes: BodyAxes) -> Axes {
    match axes {
        BodyAxes::Ned | BodyAxes::Fossen => Axes::Ned,
        BodyAxes::Enu => Axes::Enu,
    }
}

const fn direction(axis: MeshAxis) -> Direction {
    let (axis, is_against) = match axis {
        MeshAxis::X => (0, false),
        MeshAxis::AgainstX => (0, true),
        MeshAxis::Y => (1, false),
        MeshAxis::AgainstY => (1, true),
        MeshAxis::Z => (2, false),
        MeshAxis::AgainstZ => (2, true),
    };
    Direction { axis, is_against }
}

/// How a mesh lies, where it was said.
fn orientation(forward: Option<MeshAxis>, up: Option<MeshAxis>) -> Result<Option<Orientation>, Error> {
    if forward.is_none() && up.is_none() {
        return Ok(None);
    }
    let (forward, up) = (forward.map_or(Direction::X, direction), up.map_or(Direction::Z, direction));
    let lies = Orientation::new(forward, up).ok_or_else(|| {
        Error::Nothing(format!(
            "--forward {forward} and --up {up} lie along one axis of the mesh: give both, two different ones"
        ))
    })?;
    Ok(Some(lies))
}

/// `cg`, `cb`, or three lengths.
fn point(text: &str) -> Result<Point, Error> {
    match text.trim() {
        "cg" => return Ok(Point::Gravity),
        "cb" => return Ok(Point::Buoyancy),
        _ => {}
    }
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else {
        return Err(wrong("--at", text, "write cg, cb, or three lengths: \"0 m, 0 m, -0.2 m\""));
    };
    Ok(Point::At([length("--at", x.trim())?, length("--at", y.trim())?, length("--at", z.trim())?]))
}

/// Length, breadth, depth of water: `1.5 m x 0.9 m x 1 m`.
fn tank(text: &str) -> Result<[f64; 3], Error> {
    let sides: Vec<&str> = text.split(['x', '×']).collect();
    let [l, b, d] = sides[..] else {
        return Err(wrong("--tank", text, "write length, breadth and depth of water: \"1.5 m x 0.9 m x 1 m\""));
    };
    let side = |t: &str| positive("--tank", t.trim(), Dimension::LENGTH);
    Ok([side(l)?, side(b)?, side(d)?])
}

fn put_right(args: &AddedMassArgs, target: &Path, json: bool) -> Result<(), Error> {
    let unit_m = args.unit.as_deref().map(unit).transpose()?;
    let weld_m = args.weld.as_deref().map(|w| positive("--weld", w, Dimension::LENGTH)).transpose()?;
    let done = repair::repair(&args.input, unit_m, weld_m, target)?;
    if json {
        return print::json(&serde_json::json!({"written": target, "repairs": done.repairs, "left": done.left}));
    }
    for line in done.notes.iter().chain(&done.repairs) {
        say!("  {line}");
    }
    if done.repairs.is_empty() {
        say!("  nothing to correct");
    }
    say!("{}: {}, in metres", target.display(), froude::records::text::counted(done.panels, "panel", "panels"));
    for line in &done.left {
        say!("  still: {line}");
    }
    if !done.left.is_empty() {
        return Err(Error::Nothing(format!(
            "{}: written, but not yet fit for use; unite bodies that cross (a boolean union), and close holes, where the mesh was drawn",
            target.display()
        )));
    }
    say!("Next: froude added-mass {}", target.display());
    Ok(())
}

/// What has no meaning for several numbers of links is refused, not passed over.
fn only_one(args: &AddedMassArgs) -> Result<(), Error> {
    let given = [
        ("--at", args.at.is_some()),
        ("--unit", args.unit.is_some()),
        ("--forward", args.forward.is_some()),
        ("--up", args.up.is_some()),
        ("--surface", args.surface.is_some()),
        ("--export", !args.export.is_empty()),
        ("--chain", args.chain),
        ("--joint-angle", args.joint_angle.is_some()),
        ("--apart", args.apart),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            Err(Error::Nothing(format!("{option} is for one body; give one number of links with it: --links 3")))
        }
        None => Ok(()),
    }
}

/// Each number of links, or the one body where there is none.
fn check(job: &BodyJob, links: &[usize], json: bool) -> Result<(), Error> {
    let mut jobs: Vec<BodyJob> = links.iter().map(|n| BodyJob { links: Some(*n), ..job.clone() }).collect();
    if jobs.is_empty() {
        jobs.push(job.clone());
    }
    let checked = jobs.iter().map(body::forecasts).collect::<Result<Vec<_>, _>>()?;
    if json {
        let bodies: Vec<_> = checked
            .iter()
            .map(|(loaded, steps)| {
                let step = |(panels, f): &(usize, Forecast)| {
                    serde_json::json!({"panels": panels, "unknowns": f.unknowns, "seconds": f.seconds, "memory_bytes": f.memory_bytes})
                };
                let meshes: Vec<_> = steps.iter().map(step).collect();
                serde_json::json!({"name": loaded.name, "notes": loaded.notes, "findings": loaded.findings, "meshes": meshes})
            })
            .collect();
        return print::json(&bodies);
    }
    for (loaded, steps) in &checked {
        forecasts(loaded, steps);
    }
    Ok(())
}

fn forecasts(loaded: &Loaded, steps: &[(usize, Forecast)]) {
    say!("{}: fit for use", loaded.name);
    for note in loaded.notes.iter().chain(loaded.findings.iter().map(|f| &f.message)) {
        say!("  {note}");
    }
    let rows = steps
        .iter()
        .map(|(panels, f)| {
            vec![
                panels.to_string(),
                f.unknowns.to_string(),
                duration(f.seconds),
                format!("{:.0}", f.memory_bytes / 1e6),
            ]
        })
        .collect();
    table(&TextTable {
        caption: "What each mesh would require; the computation ends with the first that meets the tolerance."
            .to_owned(),
        head: ["panels", "unknowns", "time", "memory [MB]"].map(str::to_owned).to_vec(),
        rows,
    });
}

/// What became of an earlier record; beside JSON on standard error.
fn replaced(sentence: Option<&str>, json: bool) {
    match sentence {
        Some(text) if json => note!("{text}"),
        Some(text) => say!("{}\n", print::wrapped(text)),
        None => {}
    }
}

/// A table below its caption.
fn table(text: &TextTable) {
    say!("\n{}", print::wrapped(&text.caption));
    print::text_table(text);
}

fn table_of_links(outcome: &LinksOutcome) {
    say!("{}, density {} kg/m³", outcome.name, outcome.density_kg_m3);
    say!("{}", print::wrapped(&outcome.place));
    table(&page::links_table(&outcome.configurations, outcome.density_kg_m3));
    match no_fits(outcome.configurations.len()) {
        Some(why) => say!("\n{}", print::wrapped(&why)),
        None => table(&page::fits_table(&outcome.fits)),
    }
    print::findings(&outcome.file.findings);
    say!("\n{}\n{}\n{}", outcome.table.display(), outcome.estimate.display(), outcome.page.display());
}

fn one_body(outcome: &BodyOutcome) {
    say!("{}, density {} kg/m³", outcome.name, outcome.density_kg_m3);
    say!("{}", print::wrapped(&outcome.place));
    if let Some(limits) = froude::added_mass::limits::table(&outcome.cases, outcome.density_kg_m3) {
        table(&limits);
    }
    for case in &outcome.cases {
        say!("\n{} ({})", case.title, case.surroundings);
        table(&page::matrix_table(&case.refined, outcome.density_kg_m3));
        table(&page::dimensionless_table(&case.refined, outcome.length_m));
        table(&page::steps_table(&case.refined, outcome.density_kg_m3));
        for line in page::convergence_words(&case.refined) {
            say!("{line}");
        }
    }
    for text in &outcome.tables {
        table(text);
    }
    for note in &outcome.notes {
        say!("{note}");
    }
    print::findings(&outcome.file.findings);
    let paths: Vec<&PathBuf> = [&outcome.estimate, &outcome.page].into_iter().chain(&outcome.others).collect();
    say!("");
    for path in paths {
        say!("{}", path.display());
    }
}

fn parts(outcome: &SeveralOutcome) {
    say!("{}, density {} kg/m³", outcome.name, outcome.density_kg_m3);
    say!("{}", print::wrapped(&outcome.place));
    for text in &outcome.tables {
        table(text);
    }
    for note in &outcome.notes {
        say!("{}", print::wrapped(note));
    }
    print::findings(&outcome.file.findings);
    say!("");
    for path in [&outcome.estimate, &outcome.page].into_iter().chain(&outcome.others) {
        say!("{}", path.display());
    }
}
