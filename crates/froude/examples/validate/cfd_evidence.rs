//! What else than the law may lie between computed and measured forces: the body's necks, the walls of a tank, the model of turbulence, the plane of symmetry and the steady flow, each by two computations of two links that differ in it alone, as far as meshes allow.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_added_mass::body_file::read_body;
use froude_cfd::again::Again;
use froude_cfd::body::shaped;
use froude_cfd::case::Case;
use froude_cfd::collect::collect;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::outcome::Loads;
use froude_cfd::section::CfdSpec;
use froude_cfd::solve::How;
use froude_cfd::store::Store;
use froude_cfd::transient::{Times, solve_in_time};
use froude_cfd::window::std_of_mean;
use froude_records::hash::sha256_of_bytes;
use froude_records::write::write_atomically;

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

const FINEST: &str = "a mesh twice as fine in all directions";

/// Loads of one flow with and without a thing.
pub struct Pair {
    /// What differs.
    what: &'static str,
    configuration: String,
    speed_m_s: f64,
    angle_deg: f64,
    /// f_x and f_y with it, N; `None`: the computation has no result that counts.
    with: Option<[f64; 2]>,
    /// Standard deviations of these means, N.
    std: [f64; 2],
    /// Without it.
    without: [f64; 2],
    /// ½ρU²A, N.
    scale_n: f64,
}

impl Pair {
    /// The change over ½ρU²A, and of a load that is far from zero over itself too.
    fn change(&self) -> String {
        let Some(with) = self.with else { return "no result: the flow diverges".to_owned() };
        // Head on there is no force across, and across none along.
        let loads: &[usize] = match self.angle_deg {
            0.0 => &[0],
            90.0 => &[1],
            _ => &[0, 1],
        };
        let of = |k: &usize| {
            let over = (with[*k] - self.without[*k]) / self.scale_n;
            let std =
                if self.std[*k] > 0.0 { format!(" ± {:.4}", self.std[*k] / self.scale_n) } else { String::new() };
            let part = 100.0 * (with[*k] / self.without[*k] - 1.0);
            // f_x changes its sign between 33° and 60°.
            let part = if loads.len() == 1 || *k == 1 { format!(" ({part:+.1} %)") } else { String::new() };
            format!("{} {over:+.4}{std}{part}", ["f_x", "f_y"][*k])
        };
        loads.iter().map(of).collect::<Vec<_>>().join(", ")
    }
}

/// All of them; `reduced` is the folder of the campaign's cases.
pub fn evidence(claims: &mut Claims, root: &Path, reduced: &Path) -> Result<Vec<Pair>, Failed> {
    let smooth = loads(reduced)?;
    let of = |name: &str, cfd: &str, body: &str, speeds: &[&str], angles: &[f64]| {
        computed(root, name, cfd, body, speeds, angles)
    };
    let at = ["0.4 m/s"];
    let laminar =
        of("laminar", "model = \"laminar\"\nmesh = \"coarse\"", "body.toml", &["0.1 m/s", "0.4 m/s"], &ANGLES)?;
    let cubes = of("cubes", CUBES, "body.toml", &at, &ANGLES)?;
    let necked = of("necked", CUBES, "necked.toml", &at, &ANGLES)?;
    // At other angles the cubes of a tank are turned against the body.
    let tank = of("tank", &format!("{CUBES}\n{TANK}"), "body.toml", &at, &[0.0, 90.0])?;
    let whole = of("whole", "mesh = \"coarse\"\ndomain = \"full\"", "body.toml", &at, &[66.0, 90.0])?;
    let finest: Vec<Computed> =
        smooth.iter().filter(|(case, _)| matches!(Again::of(&case.id), Some((_, Again::Grid(2))))).cloned().collect();
    let mut out = Vec::new();
    for (what, with, without) in [
        ("cubes in place of an O-grid", &cubes, &smooth),
        ("necks between the links", &necked, &cubes),
        ("the walls of a tank of 0.8 by 0.75 m", &tank, &cubes),
        ("no model of turbulence", &laminar, &smooth),
        ("no plane of symmetry", &whole, &smooth),
        (FINEST, &finest, &smooth),
    ] {
        out.extend(with.iter().filter_map(|case| pair(what, case, without)));
    }
    let dir = reduced.with_file_name("in-time");
    for (case, loads) in &whole {
        let Some(without) = loads else { continue };
        let [with, std] = in_time(root, case, &dir)?;
        out.push(Pair {
            what: "in time, without a plane of symmetry, of the steady flow without one",
            configuration: case.configuration.clone(),
            speed_m_s: case.flow.speed_m_s,
            angle_deg: case.flow.angle_rad.to_degrees().round(),
            with: Some(with),
            std,
            without: [without[0], without[1]],
            scale_n: case.load_scales()[0],
        });
    }
    for pair in &out {
        claims.add(
            ROOM,
            &format!(
                "{}: {} at {} m/s and {}°, change over ½ρU²A",
                pair.what, pair.configuration, pair.speed_m_s, pair.angle_deg
            ),
            &format!("without: f_x {:.4} N, f_y {:.4} N", pair.without[0], pair.without[1]),
            pair.change(),
            Verdict::Measured,
        );
    }
    Ok(out)
}

/// A case with its loads, where it has a result that counts.
type Computed = (Case, Option<Loads>);

/// A campaign of the configuration alone.
fn computed(
    root: &Path,
    name: &str,
    cfd: &str,
    body: &str,
    speeds: &[&str],
    angles: &[f64],
) -> Result<Vec<Computed>, Failed> {
    let text = example(root)?;
    let head = text.split("[[source]]").next().unwrap_or_default();
    let angles: Vec<String> = angles.iter().map(|a| format!("{a} deg")).collect();
    let text = format!(
        "{head}[[source]]\nname = \"CFD\"\nkind = \"cfd\"\ncases = \"cfd\"\n[source.cfd]\nbody = \"{body}\"\n{cfd}\ncold = 0\n\
         [[source.plan]]\nconfigurations = [\"{CONFIGURATION}\"]\nspeed = {speeds:?}\nangle = {angles:?}\n"
    );
    let path = campaign(root, name, &text)?;
    std::fs::copy(root.join("examples/mamba-necked/body.toml"), path.with_file_name("necked.toml"))?;
    finish(&path)?;
    loads(&path.with_file_name("cfd"))
}

fn loads(folder: &Path) -> Result<Vec<Computed>, Failed> {
    let store = Store::open(folder)?;
    let found = collect(&store).rows;
    let of = |id: &str| {
        let loads = found.iter().find(|row| row.case.id == id).map(|row| row.loads);
        Ok((store.case(id)?, loads))
    };
    store.ids().map(of).collect()
}

/// The same flow in another set, where that has a result.
fn pair(what: &'static str, (case, loads): &Computed, without: &[Computed]) -> Option<Pair> {
    let is_same = |(other, _): &&Computed| {
        other.configuration == case.configuration && other.flow == case.flow && Again::of(&other.id).is_none()
    };
    let other = without.iter().find(is_same)?.1?;
    Some(Pair {
        what,
        configuration: case.configuration.clone(),
        speed_m_s: case.flow.speed_m_s,
        angle_deg: case.flow.angle_rad.to_degrees().round(),
        with: loads.map(|loads| [loads[0], loads[1]]),
        std: [0.0; 2],
        without: [other[0], other[1]],
        scale_n: case.load_scales()[0],
    })
}

/// Mean f_x and f_y of a whole flow in time over its last three quarters, and their standard deviations of samples that are alike; kept in a file named after all inputs, as it takes minutes.
fn in_time(root: &Path, steady: &Case, dir: &Path) -> Result<[[f64; 2]; 2], Failed> {
    let body = shaped(&read_body(&root.join("examples/mamba-cfd/body.toml"))?, &steady.configuration)?;
    let grid = body.grid(&CfdSpec { is_half: false, ..CfdSpec::default() });
    let sections = body.sections.as_ref().ok_or("a body of sections")?;
    std::fs::create_dir_all(dir.join("meshes"))?;
    let mesh = grid.mesh(sections)?.0.write(&dir.join("meshes"))?;
    // A tenth of the width a step; the wake has gone by 35 widths when the mean begins.
    let times = Times { step_s: 0.02, from_s: 7.0, to_s: 28.0 };
    let inputs = format!("{} {times:?}", steady.hash());
    let file = dir.join(format!("{}-{}.json", steady.id, &sha256_of_bytes(inputs.as_bytes())[..12]));
    if let Ok(text) = std::fs::read_to_string(&file) {
        return Ok(serde_json::from_str(&text)?);
    }
    let folder = tempfile::tempdir_in(dir)?;
    let case = Case { start_from: None, ..steady.clone() };
    let openfoam = OpenFoam::find()?;
    let how = How { openfoam: &openfoam, ranks: 1, cancel: &AtomicBool::new(false), tell: &|_| {} };
    let found = solve_in_time(&case, times, &mesh, None, folder.path(), &how)?;
    let loads = [0, 1].map(|load| -> Vec<f64> {
        found.samples.iter().filter(|sample| sample.time >= times.from_s).map(|sample| sample.total()[load]).collect()
    });
    let means = [[0, 1].map(|load| found.window.mean[load]), loads.map(|load| std_of_mean(&load))];
    write_atomically(&file, serde_json::to_string(&means)?.as_bytes())?;
    Ok(means)
}

/// The same as a table of the chapter.
pub fn table(pairs: &[Pair]) -> String {
    let mut out =
        "| what is changed | configuration | speed, m/s | angle | change of the force over ½ρU²A |\n| --- | --- | --- | --- | --- |\n"
            .to_owned();
    for pair in pairs {
        let _ = writeln!(
            out,
            "| {} | {} | {} | {}° | {} |",
            pair.what,
            pair.configuration,
            pair.speed_m_s,
            pair.angle_deg,
            pair.change()
        );
    }
    out
}
