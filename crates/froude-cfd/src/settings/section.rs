//! `[source.cfd]`: how the flow about a body is computed.
//!
//! ```toml
//! [source.cfd]
//! body          = "body.toml"       # a body file, or a closed surface mesh
//! unit          = "mm"              # of a surface mesh; left out: m
//! forward       = "x"               # its axis that points forward
//! up            = "z"               # its axis that points up
//! mesh          = "coarse"          # coarse, medium, fine, { stations, layers, azimuth, first_layer }, or { surface_cell, first_layer, layers, growth }
//! radius        = 3.0               # of the domain, in lengths of the body; left out: 3, and 25 widths at least
//! domain        = "half"            # half: cut at the body's plane of symmetry z = 0; full
//! tank          = { width = "2 m", depth = "1.5 m", submergence = "0.75 m" }   # walls instead of unbounded water
//! model         = "sst"             # sst, laminar
//! laminar_below = 2000              # Reynolds number U W/ν of the width, below which a case is laminar whatever the model
//! both_below    = 10000             # below it a case is computed by both models
//! iterations    = 600               # at most
//! window        = 60                # iterations that forces are judged over
//! cold          = 0.1               # part of the cases that are repeated from the inflow
//! fine          = { mesh = "medium", every = 5 }   # every n-th case of a configuration also on a finer mesh
//! [[source.cfd.study]]              # settings of the plan computed again
//! configurations = ["H4LT"]         # left out: all
//! speed         = "0.3 m/s"
//! angle         = ["0 deg", "90 deg"]
//! grids         = 4                 # on meshes by √2: one coarser than the campaign's, itself, and finer ones
//! radius        = [6, 12]           # in other domains, in lengths of the body
//! ```

use std::path::PathBuf;

use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::declare::Values;
use froude_records::given_option::GivenOption;
use froude_records::section::Section;
use froude_records::section_values::{at_most, one_of};

use super::keys::{CUBES, FINE, KEYS, O_GRID, STUDY};

/// The section of a source.
pub(crate) const CFD: &str = "cfd";

/// Most cells of a mesh.
const MOST_CELLS_IN_ALL: usize = 20_000_000;
/// Most cases of one study of a configuration: it repeats some settings of a plan, not all.
const MOST_STUDIED: usize = 1_000;
/// Least and most grids of a study: three have an order, and the sixth has 64 times the cells of the third.
const GRIDS: [usize; 2] = [3, 6];
/// Grids of a study that does not say.
const USUAL_GRIDS: usize = 4;
/// Least refinement of a fine mesh in any direction: below it the difference of two meshes is mostly rounding of their counts.
const LEAST_REFINEMENT: f64 = 1.2;

/// How the flow about a body is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct CfdSpec {
    /// A body file or a surface mesh; `None`: the campaign's own body.
    pub body: Option<PathBuf>,
    /// `unit`, `forward` and `up` of a surface mesh, as they were written.
    pub lies: Vec<GivenOption>,
    /// Cells about it.
    pub mesh: MeshSpec,
    /// What makes the mesh.
    pub mesher: Mesher,
    /// Radius of the domain over the body's length \[-\]; `None`: 3, and 25 widths at least.
    pub radius: Option<f64>,
    /// Whether the domain ends at the plane of symmetry z = 0.
    pub is_half: bool,
    /// The tank that the body moves in; `None`: unbounded water.
    pub tank: Option<TankSpec>,
    /// Whether no model of turbulence is used.
    pub is_laminar: bool,
    /// Reynolds number of the width below which no case has one \[-\].
    pub laminar_below: f64,
    /// Reynolds number below which a case is computed with and without \[-\].
    pub both_below: f64,
    /// Most iterations of a case.
    pub iterations: usize,
    /// Iterations that forces are judged over.
    pub window: usize,
    /// Part of the cases that are repeated from the inflow.
    pub cold: f64,
    /// Cases that are also computed on a finer mesh.
    pub fine: Option<FineSpec>,
    /// Settings of the plan that are computed again on other grids and in other domains.
    pub study: Vec<StudySpec>,
}

/// Which cases are also computed on a finer mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineSpec {
    /// The finer mesh.
    pub mesh: MeshSpec,
    /// Every so many of the cases of a configuration.
    pub every: usize,
}

/// Settings of the plan that are computed again on other grids and in other domains.
#[derive(Debug, Clone, PartialEq)]
pub struct StudySpec {
    /// `HkLT`; all where there are none.
    pub configurations: Vec<String>,
    /// Speeds, m/s.
    pub speed_m_s: Vec<f64>,
    /// Angles, rad.
    pub angle_rad: Vec<f64>,
    /// Angles out of the plane, rad.
    pub pitch_rad: Vec<f64>,
    /// Grids of a family by √2 in all directions, the second coarsest the campaign's own; 0: no other grids.
    pub grids: usize,
    /// Radii of other domains over the body's length \[-\].
    pub radius: Vec<f64>,
}

/// What makes a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mesher {
    /// An O-grid where one goes around the body, and otherwise cubes with as many cells on the surface.
    ByBody,
    /// An O-grid.
    OGrid,
    /// Cubes that are halved towards the surface and cut by it.
    Cubes(CubeSpec),
}

/// Cells of a mesh of cubes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeSpec {
    /// Edge of the cubes at the surface, m.
    pub surface_cell_m: f64,
    /// Height of the layer at the wall, m.
    pub first_layer_m: f64,
    /// Layers; `None`: until the last is 0.15 times as high as the cubes.
    pub layers: Option<usize>,
    /// Each layer over the one before \[-\].
    pub growth: f64,
}

impl CubeSpec {
    /// Growth of layers where nothing is said \[-\].
    pub const GROWTH: f64 = 1.3;
}

/// The section of a tank, and where the body is in it: halfway between the walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TankSpec {
    /// From wall to wall, m.
    pub width_m: f64,
    /// Of the water, m.
    pub depth_m: f64,
    /// Of the body's origin below the surface, m.
    pub submergence_m: f64,
}

/// Cells of an O-grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshSpec {
    /// Along the meridian, from tip to tip.
    pub stations: usize,
    /// From the wall to the far field.
    pub layers: usize,
    /// Over half a turn.
    pub azimuth: usize,
    /// Height of the layer at the wall, m; the others grow so that they reach the far field.
    pub first_layer_m: f64,
}

impl MeshSpec {
    /// 22,400 cells.
    pub const COARSE: Self = Self { stations: 40, layers: 35, azimuth: 16, first_layer_m: 1.2e-4 };
    /// 92,160 cells.
    pub const MEDIUM: Self = Self { stations: 60, layers: 48, azimuth: 32, first_layer_m: 1.0e-4 };
    /// 263,712 cells.
    pub const FINE: Self = Self { stations: 82, layers: 67, azimuth: 48, first_layer_m: 7e-5 };

    /// How much finer it is than another in the direction in which it is refined least \[-\]: what the error of a pair that is not similar is taken by.
    #[must_use]
    pub fn refinement(self, other: Self) -> f64 {
        let of = |own: usize, other: usize| own as f64 / other as f64;
        of(self.stations, other.stations).min(of(self.layers, other.layers)).min(of(self.azimuth, other.azimuth))
    }

    /// Cells over half a turn.
    #[must_use]
    pub const fn cells(self) -> usize {
        self.stations * self.layers * self.azimuth
    }
}

impl Default for CfdSpec {
    fn default() -> Self {
        Self {
            body: None,
            lies: Vec::new(),
            mesh: MeshSpec::COARSE,
            mesher: Mesher::ByBody,
            radius: None,
            is_half: true,
            tank: None,
            is_laminar: false,
            laminar_below: 0.0,
            both_below: 0.0,
            iterations: 600,
            window: 60,
            cold: 0.1,
            fine: None,
            study: Vec::new(),
        }
    }
}

/// What a source says of how its flow is computed; `None` where it says nothing.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn declared(source: &Source) -> Result<Option<CfdSpec>, RecordError> {
    source.section(CFD)?.map(|s| cfd(&s)).transpose()
}

/// Reads `[source.cfd]`.
fn cfd(s: &Section<'_>) -> Result<CfdSpec, RecordError> {
    let values = Values::read(s, KEYS)?;
    let number = |key: &str| values.need(key, values.number(key));
    let count = |key: &str| values.need(key, values.count(key));
    let usual = CfdSpec::default();
    let (own_mesh, mesher) = mesh(s)?.unwrap_or((usual.mesh, usual.mesher));
    let out = CfdSpec {
        body: values.text("body").map(|text| s.source.relative(text)),
        lies: lies(s)?,
        mesh: own_mesh,
        mesher,
        radius: values.number("radius"),
        is_half: values.need("domain", values.word("domain", &[true, false]))?,
        tank: values.table("tank").map(tank).transpose()?,
        is_laminar: values.need("model", values.word("model", &[false, true]))?,
        laminar_below: number("laminar_below")?,
        both_below: number("both_below")?,
        iterations: count("iterations")?,
        window: count("window")?,
        cold: number("cold")?,
        fine: s.section("fine")?.map(|f| fine(&f, own_mesh)).transpose()?,
        study: s.sections("study")?.iter().map(study).collect::<Result<_, _>>()?,
    };
    if let (Some(tank), Some(value)) = (out.tank, s.get("tank")) {
        let problem = if out.mesher == Mesher::OGrid {
            "goes with cubes, and mesh asks for an O-grid, which ends in a sphere; write mesh = \"coarse\" or { surface_cell, first_layer }".to_owned()
        } else if out.is_half && (tank.depth_m - 2.0 * tank.submergence_m).abs() > 1e-9 * tank.depth_m {
            format!(
                "has the body {} m below the surface of {} m of water, and half a domain needs it in the middle; write domain = \"full\"",
                tank.submergence_m, tank.depth_m
            )
        } else {
            String::new()
        };
        if !problem.is_empty() {
            return Err(s.wrong("tank", value, problem));
        }
    }
    if let Some(value) = s.get("window").or(s.get("iterations")).filter(|_| 2 * out.window > out.iterations) {
        let problem = format!(
            "leaves no room: forces are judged over {} iterations of at most {}; a window is half of them or less",
            out.window, out.iterations
        );
        return Err(s.wrong("window", value, problem));
    }
    Ok(out)
}

fn fine(s: &Section<'_>, own: MeshSpec) -> Result<FineSpec, RecordError> {
    let values = Values::read(s, FINE)?;
    let (finer, mesher) = values.need("mesh", mesh(s)?)?;
    if let Some(value) = s.get("mesh").filter(|_| matches!(mesher, Mesher::Cubes(_))) {
        let problem = "asks for cubes, which are not similar to another mesh; write \"medium\", \"fine\" or an O-grid";
        return Err(s.wrong("mesh", value, problem));
    }
    let refinement = finer.refinement(own);
    if let Some(value) = s.get("mesh").filter(|_| refinement < LEAST_REFINEMENT) {
        let problem = format!(
            "has {} cells, and the mesh of the campaign {}: {refinement:.2} times as fine where it is refined least; a difference of meshes needs {LEAST_REFINEMENT} at least",
            finer.cells(),
            own.cells()
        );
        return Err(s.wrong("mesh", value, problem));
    }
    Ok(FineSpec { mesh: finer, every: values.need("every", values.count("every"))? })
}

fn study(s: &Section<'_>) -> Result<StudySpec, RecordError> {
    let values = Values::read(s, STUDY)?;
    let radius: Vec<f64> = s.get("radius").map_or(Ok(Vec::new()), |value| {
        let all = value.get_ref().as_array().map_or_else(|| vec![value], |list| list.iter().collect());
        all.into_iter()
            .map(|value| match s.as_number("radius", value)? {
                x if (1.0..=1000.0).contains(&x) => Ok(x),
                x => Err(s.wrong("radius", value, format!("is {x}; expected a number from 1 to 1000"))),
            })
            .collect()
    })?;
    let grids = match values.count("grids") {
        Some(n) if !(GRIDS[0]..=GRIDS[1]).contains(&n) => {
            return Err(values.wrong("grids", format!("is {n}; expected {} to {}", GRIDS[0], GRIDS[1])));
        }
        Some(n) => n,
        None if radius.is_empty() => USUAL_GRIDS,
        None => 0,
    };
    let out = StudySpec {
        configurations: values.texts("configurations").to_vec(),
        speed_m_s: values.numbers("speed"),
        angle_rad: values.numbers("angle"),
        pitch_rad: values.numbers("pitch"),
        grids,
        radius,
    };
    let numbers = [
        ("speed", out.speed_m_s.len()),
        ("angle", out.angle_rad.len()),
        ("pitch", out.pitch_rad.len()),
        ("grids + radius", out.grids + out.radius.len()),
    ];
    at_most(&s.place(), &numbers, MOST_STUDIED)?;
    Ok(out)
}

fn lies(s: &Section<'_>) -> Result<Vec<GivenOption>, RecordError> {
    let mut out = Vec::new();
    for name in ["unit", "forward", "up"] {
        if let (Some(text), Some(value)) = (s.text(name)?, s.get(name)) {
            let place = Some(s.source.place(value.span().start));
            out.push(GivenOption { name: name.to_owned(), text: text.to_owned(), place });
        }
    }
    Ok(out)
}

fn tank(values: &Values) -> Result<TankSpec, RecordError> {
    let length = |key: &str| values.need(key, values.number(key));
    let out = TankSpec { width_m: length("width")?, depth_m: length("depth")?, submergence_m: length("submergence")? };
    if out.submergence_m >= out.depth_m {
        let problem = format!("is {} m, and the water is {} m deep", out.submergence_m, out.depth_m);
        return Err(values.wrong("submergence", problem));
    }
    Ok(out)
}

fn mesh(s: &Section<'_>) -> Result<Option<(MeshSpec, Mesher)>, RecordError> {
    let Some(value) = s.get("mesh") else { return Ok(None) };
    if value.get_ref().is_str() {
        let named = [MeshSpec::COARSE, MeshSpec::MEDIUM, MeshSpec::FINE];
        let found = one_of(s, "mesh", &["coarse", "medium", "fine"], &named)?;
        return Ok(found.map(|spec| (spec, Mesher::ByBody)));
    }
    let m = s.as_section("mesh", value)?;
    if m.get("surface_cell").is_some() {
        return Ok(Some((MeshSpec::COARSE, Mesher::Cubes(cubes(&m)?))));
    }
    let values = Values::read(&m, O_GRID)?;
    let first_layer_m = values.need("first_layer", values.number("first_layer"))?;
    let cells = |key: &str| match values.need(key, values.count(key))? {
        n if n < 4 => Err(values.wrong(key, format!("is {n}; expected 4 or more"))),
        n => Ok(n),
    };
    let spec =
        MeshSpec { stations: cells("stations")?, layers: cells("layers")?, azimuth: cells("azimuth")?, first_layer_m };
    if spec.cells() > MOST_CELLS_IN_ALL {
        let problem = format!("and layers and azimuth make {} cells; at most {MOST_CELLS_IN_ALL}", spec.cells());
        return Err(values.wrong("stations", problem));
    }
    Ok(Some((spec, Mesher::OGrid)))
}

fn cubes(m: &Section<'_>) -> Result<CubeSpec, RecordError> {
    let values = Values::read(m, CUBES)?;
    let number = |key: &str| values.need(key, values.number(key));
    let spec = CubeSpec {
        surface_cell_m: number("surface_cell")?,
        first_layer_m: number("first_layer")?,
        layers: values.count("layers"),
        growth: number("growth")?,
    };
    if spec.first_layer_m > spec.surface_cell_m {
        let problem = format!(
            "is {} m, higher than the cubes at the surface, {} m; expected a part of them",
            spec.first_layer_m, spec.surface_cell_m
        );
        return Err(values.wrong("first_layer", problem));
    }
    Ok(spec)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use froude_records::campaign_file::parse_campaign;

    use super::*;

    const CAMPAIGN: &str = "schema = 1\nname = \"a\"\n\n[[source]]\nname = \"flow\"\nkind = \"cfd\"\ncases = \"cases\"\n\
         [source.cfd]\nbody = \"body.toml\"\nmesh = \"medium\"\ndomain = \"full\"\n\
         [[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.4 m/s\"\nangle = [\"0 deg\", \"90 deg\"]\npitch = \"10 deg\"\n";

    fn parse(from: &str, to: &str) -> Result<(Source, CfdSpec), String> {
        assert!(CAMPAIGN.contains(from), "{from}");
        let campaign = parse_campaign(Path::new("lab/campaign.toml"), &CAMPAIGN.replacen(from, to, 1));
        let source = campaign.map_err(|e| e.to_string())?.sources.remove(0);
        let spec = declared(&source).map_err(|e| e.to_string())?.unwrap();
        Ok((source, spec))
    }

    #[test]
    fn a_campaign_says_how_its_flow_is_computed() {
        let (source, spec) = parse("", "").unwrap();
        assert_eq!(spec.body.as_deref(), Some(Path::new("lab/body.toml")));
        assert_eq!((spec.mesh, spec.is_half), (MeshSpec::MEDIUM, false));
        assert_eq!(spec.mesh.cells(), 92_160);
        assert!((source.plan[0].pitch_rad[0] - 10_f64.to_radians()).abs() < 1e-15);
        let own = "mesh = { stations = 20, layers = 18, azimuth = 8, first_layer = \"0.2 mm\" }";
        let (_, spec) = parse("mesh = \"medium\"", own).unwrap();
        assert_eq!((spec.mesh.cells(), spec.mesh.first_layer_m, spec.mesher), (2880, 2e-4, Mesher::OGrid));
    }

    #[test]
    fn a_surface_lies_somehow_in_cubes_within_a_tank() {
        let own = "unit = \"mm\"\nup = \"-y\"\nmesh = { surface_cell = \"4 mm\", first_layer = \"0.2 mm\", layers = 8 }\n\
             tank = { width = \"1.5 m\", depth = \"1 m\", submergence = \"0.3 m\" }";
        let (_, spec) = parse("mesh = \"medium\"", own).unwrap();
        let cubes = CubeSpec { surface_cell_m: 4e-3, first_layer_m: 2e-4, layers: Some(8), growth: 1.3 };
        assert_eq!(spec.mesher, Mesher::Cubes(cubes));
        assert_eq!(spec.tank, Some(TankSpec { width_m: 1.5, depth_m: 1.0, submergence_m: 0.3 }));
        let given: Vec<_> = spec.lies.iter().map(|o| (o.name.as_str(), o.text.as_str())).collect();
        assert_eq!(given, [("unit", "mm"), ("up", "-y")]);
        assert!(spec.lies[1].place.is_some());
    }

    #[test]
    fn a_campaign_names_what_is_computed_again() {
        let text = "\"full\"\nfine = { mesh = \"fine\" }\n[[source.cfd.study]]\nconfigurations = [\"H1LT\"]\nspeed = \"0.4 m/s\"\nangle = [\"0 deg\", \"90 deg\"]\n\
                    [[source.cfd.study]]\nspeed = [\"0.4 m/s\"]\nradius = [6, 12.5]\n";
        let (_, spec) = parse("\"full\"", text).unwrap();
        assert_eq!(spec.fine, Some(FineSpec { mesh: MeshSpec::FINE, every: 5 }));
        let [grids, domains] = &spec.study[..] else { panic!("{:?}", spec.study) };
        assert_eq!((grids.grids, grids.angle_rad.len(), &grids.radius[..]), (4, 2, &[][..]));
        assert_eq!((domains.grids, &domains.radius[..], domains.configurations.len()), (0, &[6.0, 12.5][..], 0));
    }

    #[test]
    fn what_cannot_be_is_refused_where_it_stands() {
        for (from, to, said) in [
            ("\"full\"", "\"full\"\nfine = { mesh = \"coarse\", every = 5 }", "0.50 times as fine"),
            ("\"full\"", "\"full\"\nfine = { every = 5 }", "mesh"),
            ("\"full\"", "\"full\"\n[[source.cfd.study]]\nspeed = \"0.4 m/s\"\ngrids = 2", "3 to 6"),
            ("\"full\"", "\"full\"\n[[source.cfd.study]]\nspeed = \"0.4 m/s\"\nradius = [0.5]", "from 1 to 1000"),
            ("\"full\"", "\"full\"\n[[source.cfd.study]]\ngrids = 4", "speed"),
            ("\"medium\"", "\"meduim\"", "medium"),
            ("\"full\"", "\"full\"\nwindow = 400", "no room"),
            ("\"full\"", "\"full\"\nradius = 0.2", "from 1 to 1000"),
            ("\"medium\"", "{ stations = 20, layers = 18, azimuth = 8 }", "first_layer"),
            ("\"medium\"", "{ stations = 2000, layers = 2000, azimuth = 8, first_layer = \"1 mm\" }", "32000000"),
            ("\"medium\"", "{ surface_cell = \"4 mm\", first_layer = \"5 mm\" }", "higher than the cubes"),
            ("\"medium\"", "{ surface_cell = \"4 mm\" }", "first_layer"),
            (
                "\"full\"",
                "\"half\"\ntank = { width = \"1 m\", depth = \"1 m\", submergence = \"0.3 m\" }",
                "domain = \"full\"",
            ),
            ("\"full\"", "\"full\"\ntank = { width = \"1 m\", depth = \"1 m\", submergence = \"2 m\" }", "1 m deep"),
            ("\"full\"", "\"full\"\ntank = { width = \"1 m\", depth = \"1 m\" }", "submergence"),
            ("cases = \"cases\"", "table = \"t.csv\"", "names no cases"),
            ("pitch", "repeats", "repeats"),
        ] {
            let found = parse(from, to).unwrap_err();
            assert!(found.contains(said) && found.contains("campaign.toml"), "{to}: {found}");
        }
    }
}
