//! Why there is no added mass.

use std::path::PathBuf;

use froude_hydro::fluid::FluidError;
use froude_identify::IdentifyError;
use froude_identify::method::MethodError;
use froude_mesh::files::{Format, ReadError};
use froude_mesh::plausible::{Crosses, TooLarge};
use froude_mesh::sections::SectionError;
use froude_panel::chain::ChainError;
use froude_panel::refine::RefineError;
use froude_records::RecordError;
use froude_records::added_mass_options::GivenOption;
use froude_records::text::counted;

use crate::files::FileError;
use crate::frame::Direction;

/// Why there is no added mass; each message says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AddedMassError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A mesh file cannot be read.
    #[error(transparent)]
    Mesh(#[from] ReadError),
    /// The dimensions give no body.
    #[error(transparent)]
    Sections(#[from] SectionError),
    /// The chain cannot be bent so.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// No mesh could be solved on.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// The least squares over the numbers of links refused.
    #[error(transparent)]
    Fit(#[from] IdentifyError),
    /// There is no such water.
    #[error("[fluid]: {0}")]
    Water(#[from] FluidError),

    /// An option that says nothing sensible.
    #[error("{given}: {why}")]
    Option {
        /// The option.
        given: GivenOption,
        /// What it takes.
        why: String,
    },
    /// Options that say nothing without another, or beside it.
    #[error("{why}")]
    Together {
        /// Which, and what to do.
        why: &'static str,
    },
    /// An option that has no meaning for several numbers of links.
    #[error("--{option} is for one body; give one number of links with it: --links 3")]
    OfOne {
        /// The option.
        option: String,
    },
    /// Forward and up along one axis.
    #[error("--forward {forward} and --up {up} lie along one axis of the mesh: give both, two different ones")]
    OneAxis {
        /// Forward.
        forward: Direction,
        /// Up.
        up: Direction,
    },

    /// Nothing can be said in kilograms.
    #[error("{}: no density of the water; write {}", .path.display(), if *.is_campaign {
        "density = \"1025 kg/m^3\" in [fluid] of the campaign"
    } else {
        "--density \"1025 kg/m^3\", or [fluid] density in the body file"
    })]
    NoDensity {
        /// The body or mesh.
        path: PathBuf,
        /// Whether a campaign names it.
        is_campaign: bool,
    },
    /// A number of links where there are none.
    #[error(
        "{}: --links counts the links of a body file of shape \"robot\"; leave it out for another shape, or a mesh",
        .path.display()
    )]
    NoLinks {
        /// The body or mesh.
        path: PathBuf,
    },
    /// A robot without a number of links.
    #[error("{}: a robot has links; say how many: --links 3, or --links 1..9 for a table", .path.display())]
    HowManyLinks {
        /// The body file.
        path: PathBuf,
    },
    /// A chain of what is no robot.
    #[error("{}: a chain is a body file of shape \"robot\" with --links", .path.display())]
    NoChain {
        /// The body or mesh.
        path: PathBuf,
    },
    /// What only a mesh needs, said of a body file.
    #[error("{}: {what}", .path.display())]
    OfAMesh {
        /// The body file.
        path: PathBuf,
        /// Which option, and what a body file has instead.
        what: &'static str,
    },
    /// A centre of gravity that nobody gave.
    #[error("{}: --at cg: {}", .path.display(), if *.is_body_file {
        "no centre of gravity is known; write centre_of_gravity = [\"0 mm\", \"0 mm\", \"-12 mm\"] in [body], or the point: --at \"0 mm, 0 mm, -12 mm\""
    } else {
        "a mesh says nothing of masses; write the point in the axes of the mesh: --at \"0 mm, 0 mm, -12 mm\""
    })]
    NoGravity {
        /// The body or mesh.
        path: PathBuf,
        /// Whether it is a body file.
        is_body_file: bool,
    },
    /// A mesh that potential flow cannot be computed on.
    #[error("{}: potential flow cannot be computed on this mesh:\n{}", .path.display(), .troubles.join("\n"))]
    Unfit {
        /// The mesh.
        path: PathBuf,
        /// What is wrong with it, a line each.
        troubles: Vec<String>,
    },
    /// A mesh whose unit nobody said, of a doubtful size.
    #[error("{}: {doubt}", .path.display())]
    TooLarge {
        /// The mesh.
        path: PathBuf,
        /// How large it is.
        doubt: TooLarge,
    },
    /// A body through the water's surface.
    #[error(
        "{}: {crossing}: the body pierces the water's surface; bodies that float are not computed here, submerge it",
        .path.display()
    )]
    Pierces {
        /// The body or mesh.
        path: PathBuf,
        /// Where.
        crossing: Crosses,
    },
    /// A hull cut off at the water's surface of its format, which nobody says is submerged.
    #[error(
        "{}: the mesh is closed by {} in the plane z = 0, which is the water's surface in a {format} file: this is a floating hull, and floating \
         bodies are not computed here. If the body is submerged, state where the surface is: --surface \"5 m\" puts it 5 m above the origin of the mesh",
        .path.display(),
        counted(*panels, "panel", "panels")
    )]
    Lid {
        /// The mesh.
        path: PathBuf,
        /// Panels in the plane.
        panels: usize,
        /// The format.
        format: Format,
    },
    /// A body above the water's surface.
    #[error(
        "{}: the body lies above the water's surface at {letter} = {at_m} m; give --surface the height of the surface over the origin of the mesh, \
         and --up the axis of the mesh that points up, as --up -z",
        .path.display()
    )]
    Above {
        /// The body or mesh.
        path: PathBuf,
        /// The vertical axis of the mesh.
        letter: &'static str,
        /// Where the surface is on it, m.
        at_m: f64,
    },
    /// A panel in the water's surface.
    #[error(
        "{}: panel {panel} lies in the water's surface at {letter} = {at_m} m: bodies that float are not computed here, submerge it",
        .path.display()
    )]
    Touches {
        /// The body or mesh.
        path: PathBuf,
        /// The panel.
        panel: usize,
        /// The vertical axis of the mesh.
        letter: &'static str,
        /// Where the surface is on it, m.
        at_m: f64,
    },
    /// A tank around a mesh that does not lie with z up.
    #[error(
        "{}: in a tank the z axis of the mesh must point up, and here {up} does; export the mesh with z up",
        .path.display()
    )]
    TankUp {
        /// The mesh.
        path: PathBuf,
        /// What points up.
        up: Direction,
    },
    /// Parts of what is no mesh.
    #[error("{}: --apart takes a mesh of several closed parts", .path.display())]
    NoParts {
        /// The body file.
        path: PathBuf,
    },
    /// Parts of a mesh that has one.
    #[error("{}: the mesh hangs together, it has one part; leave --apart out", .path.display())]
    OnePart {
        /// The mesh.
        path: PathBuf,
    },

    /// An added mass that its format cannot hold.
    #[error("cannot write {}: {reason}; nothing was changed", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: FileError,
    },
    /// A target of a repair of another format.
    #[error("{}: a repaired mesh is written as .obj or .stl", .path.display())]
    RepairFormat {
        /// The target.
        path: PathBuf,
    },
    /// A repair of a body file.
    #[error("{}: --repair is for a mesh; a body file has none", .path.display())]
    RepairBody {
        /// The body file.
        path: PathBuf,
    },
    /// A repair into its own input.
    #[error("{}: name another file than the input; it stays as it is", .path.display())]
    RepairInput {
        /// The target.
        path: PathBuf,
    },
    /// A repair into a file that is there.
    #[error("{} exists, and a repair writes over nothing; name another file, or delete that one", .path.display())]
    RepairExists {
        /// The target.
        path: PathBuf,
    },
}

impl From<AddedMassError> for MethodError {
    fn from(error: AddedMassError) -> Self {
        match error {
            AddedMassError::Record(error) => Self::Record(error),
            AddedMassError::Fit(error) => Self::Identify(error),
            other => Self::refused(other),
        }
    }
}
