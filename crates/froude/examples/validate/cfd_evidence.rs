//! What else than the law may lie between computed and measured forces: the body's necks, the walls of a tank, the model of turbulence, the steady flow, each by two computations that differ in it alone.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_cfd::body::shaped;
use froude_cfd::case::Case;
use froude_cfd::collect::collect;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::outcome::Loads;
use froude_cfd::solve::How;
use froude_cfd::store::Store;
use froude_cfd::transient::{Times, solve_in_time};
use froude_records::body::read_body;
use froude_records::cfd::CfdSpec;

use crate::cfd::{campaign, example, finish};
use crate::claims::{Claims, Verdict};

type Failed = Box<dyn Error>;

const ROOM: &str = "Computed flows: what the walls, the necks and the model do";
const CONFIGURATION: &str = "H2LT";
const ANGLES: [f64; 3] = [0.0, 33.0, 90.0];
/// Cells on the surface of those that snappyHexMesh makes, as the necks have no O-grid.
const CUBES: &str = "mesh = { surface_cell = \"8 mm\", first_layer = \"0.4 mm\" }";
/// A section that the body across it blocks by a twelfth.
const TANK: &str = "tank = { width = \"0.8 m\", depth = \"0.75 m\", submergence = \"0.375 m\" }";

/// Loads of one flow with and without a thing.
pub struct Pair {
    /// What differs.
    pub what: &'static str,
    pub speed_m_s: f64,
    pub angle_deg: f64,
    /// f_x and f_y with it and without, N.
    pub with: [f64; 2],
    pub without: [f64; 2],
}

impl Pair {
    /// With over without, of the loads that are not zero by symmetry.
    fn ratios(&self) -> String {
        let of = |k: usize| format!("{:.3}", self.with[k] / self.without[k]);
        match self.angle_deg {
            0.0 => format!("f_x × {}", of(0)),
            90.0 => format!("f_y × {}", of(1)),
            _ => format!("f_x × {}, f_y × {}", of(0), of(1)),
        }
    }
}

/// All of them; `reduced` is the folder of the campaign's cases.
pub fn evidence(claims: &mut Claims, root: &Path, reduced: &Path) -> Result<Vec<Pair>, Failed> {
    let smooth = loads(reduced)?;
    let laminar =
        computed(root, "laminar", "model = \"laminar\"\nmesh = \"coarse\"", "body.toml", &["0.1 m/s", "0.4 m/s"])?;
    let cubes = computed(root, "cubes", CUBES, "body.toml", &["0.4 m/s"])?;
    let necked = computed(root, "necked", CUBES, "necked.toml", &["0.4 m/s"])?;
    let tank = computed(root, "tank", &format!("{CUBES}\n{TANK}"), "body.toml", &["0.4 m/s"])?;
    let mut out = Vec::new();
    for (what, with, without) in [
        ("cubes in place of an O-grid", &cubes, &smooth),
        ("necks between the links", &necked, &cubes),
        ("the walls of a tank of 0.8 by 0.75 m", &tank, &cubes),
        ("a laminar layer", &laminar, &smooth),
    ] {
        out.extend(pairs(what, with, without));
    }
    let dir = reduced.with_file_name("in-time");
    for angle_deg in [66.0, 90.0] {
        let id = format!("{CONFIGURATION}-u0.4-a{angle_deg}");
        let Some((case, without)) = smooth.iter().find(|(case, _)| case.id == id) else { continue };
        let with = in_time(root, case, &dir)?;
        out.push(Pair {
            what: "the whole flow in time",
            speed_m_s: 0.4,
            angle_deg,
            with,
            without: [without[0], without[1]],
        });
    }
    for pair in &out {
        claims.add(
            ROOM,
            &format!("{}: {CONFIGURATION} at {} m/s and {}°", pair.what, pair.speed_m_s, pair.angle_deg),
            &format!("without: f_x {:.4} N, f_y {:.4} N", pair.without[0], pair.without[1]),
            format!("f_x {:.4} N, f_y {:.4} N: {}", pair.with[0], pair.with[1], pair.ratios()),
            Verdict::Measured,
        );
    }
    Ok(out)
}

/// A campaign of the configuration alone.
fn computed(root: &Path, name: &str, cfd: &str, body: &str, speeds: &[&str]) -> Result<Vec<(Case, Loads)>, Failed> {
    let text = example(root)?;
    let head = text.split("[[source]]").next().unwrap_or_default();
    let (speeds, angles) = (format!("{speeds:?}"), ANGLES.map(|a| format!("{a} deg")));
    let text = format!(
        "{head}[[source]]\nname = \"CFD\"\nkind = \"cfd\"\ncases = \"cfd\"\n[source.cfd]\nbody = \"{body}\"\n{cfd}\ncold = 0\n\
         [[source.plan]]\nconfigurations = [\"{CONFIGURATION}\"]\nspeed = {speeds}\nangle = {angles:?}\n"
    );
    let path = campaign(root, name, &text)?;
    std::fs::copy(root.join("examples/mamba-necked/body.toml"), path.with_file_name("necked.toml"))?;
    finish(&path)?;
    loads(&path.with_file_name("cfd"))
}

fn loads(folder: &Path) -> Result<Vec<(Case, Loads)>, Failed> {
    Ok(collect(&Store::open(folder)?).rows.into_iter().map(|row| (row.case, row.loads)).collect())
}

/// Flows that both have.
fn pairs(what: &'static str, with: &[(Case, Loads)], without: &[(Case, Loads)]) -> Vec<Pair> {
    let of = |(case, loads): &(Case, Loads)| {
        let is_same = |other: &&(Case, Loads)| {
            other.0.configuration == case.configuration && other.0.flow == case.flow && !other.0.id.ends_with("cold")
        };
        let (_, other) = without.iter().find(is_same)?;
        Some(Pair {
            what,
            speed_m_s: case.flow.speed_m_s,
            angle_deg: case.flow.angle_rad.to_degrees().round(),
            with: [loads[0], loads[1]],
            without: [other[0], other[1]],
        })
    };
    with.iter().filter_map(of).collect()
}

/// Mean f_x and f_y of the whole flow in time over its second half; kept in a file, as it takes minutes.
fn in_time(root: &Path, half: &Case, dir: &Path) -> Result<[f64; 2], Failed> {
    let file = dir.join(format!("{}.json", half.id));
    if let Ok(text) = std::fs::read_to_string(&file) {
        return Ok(serde_json::from_str(&text)?);
    }
    let body = shaped(&read_body(&root.join("examples/mamba-cfd/body.toml"))?, &half.configuration)?;
    let grid = body.grid(&CfdSpec { is_half: false, ..CfdSpec::default() });
    let sections = body.sections.as_ref().ok_or("a body of sections")?;
    std::fs::create_dir_all(dir.join("meshes"))?;
    let mesh = grid.mesh(sections)?.0.write(&dir.join("meshes"))?;
    let folder = tempfile::tempdir_in(dir)?;
    let case = Case { is_half: false, start_from: None, ..half.clone() };
    let openfoam = OpenFoam::find()?;
    let how = How { openfoam: &openfoam, ranks: 1, cancel: &AtomicBool::new(false), tell: &|_| {} };
    // A tenth of the width a step; the wake has gone by 35 widths when the mean begins.
    let times = Times { step_s: 0.02, from_s: 7.0, to_s: 14.0 };
    let found = solve_in_time(&case, times, &mesh, None, folder.path(), &how)?;
    let mean = [found.window.mean[0], found.window.mean[1]];
    std::fs::write(&file, serde_json::to_string(&mean)?)?;
    Ok(mean)
}

/// The same as a table of the chapter.
pub fn table(pairs: &[Pair]) -> String {
    let mut out =
        "| what is changed | speed, m/s | angle | forces, changed over unchanged |\n| --- | --- | --- | --- |\n"
            .to_owned();
    for pair in pairs {
        let _ = writeln!(out, "| {} | {} | {}° | {} |", pair.what, pair.speed_m_s, pair.angle_deg, pair.ratios());
    }
    out
}
