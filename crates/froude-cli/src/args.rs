//! What the user can say on the command line.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, Parser, Subcommand};
use froude::records::added_mass_options::{ADDED_MASS_OPTIONS, GivenOption};

/// What stands below the help.
const EXIT_CODES: &str = "Exit code: 0 done, whatever the findings say; 1 failed; 2 bad input.";

/// Froude turns tank tests, tows and potential flow into drag and added-mass coefficients with realistic uncertainties, and drives the towing carriage.
#[derive(Debug, Parser)]
#[command(name = "froude", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Print the result as JSON on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// What to do.
    #[command(subcommand)]
    pub verb: Verb,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Run the main job on embedded data: real tow-tank runs and the snake robot's twin.
    #[command(after_help = "Example: froude demo")]
    Demo {
        /// Folder to write; must be empty or new.
        #[arg(default_value = "froude-demo")]
        dir: PathBuf,
    },
    /// Fit every force model asked for, select one, and write estimate.json and report.html; identify the servo of a log.
    #[command(after_help = "Examples:\n  froude identify campaign.toml\n  froude identify tow.csv --models quadratic")]
    Identify {
        /// A campaign (.toml), a bare table (.csv, .parquet), or a servo's log whose sidecar names time, position and command.
        input: PathBuf,
        /// Folder of the results [default: INPUT-results beside the input].
        #[arg(long)]
        out: Option<PathBuf>,
        /// Sidecar of a bare table [default: the .toml of the same name beside it].
        #[arg(long)]
        sidecar: Option<PathBuf>,
        /// Models to fit instead of the campaign's, separated by commas.
        #[arg(long, value_delimiter = ',')]
        models: Vec<String>,
    },
    /// Compare estimate records: single coefficients, all of them jointly, and the predicted forces.
    #[command(
        after_help = "Example: froude compare monday-results/estimate.json tuesday-results/estimate.json --out both"
    )]
    Compare {
        /// Records (estimate.json), at least one.
        #[arg(required = true)]
        estimates: Vec<PathBuf>,
        /// Print every pair of coefficients, not only those of the recommended models.
        #[arg(long)]
        all: bool,
        /// Folder for record and report; without it nothing is written.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Show what a table, campaign, record, run (.mcap) or folder of runs contains, with units, ranges and every finding.
    #[command(after_help = "Example: froude inspect tow.csv")]
    Inspect {
        /// The file or folder.
        file: PathBuf,
        /// Sidecar of a table.
        #[arg(long)]
        sidecar: Option<PathBuf>,
    },
    /// Show the run matrix of a campaign, its time in the tank, and the interval to expect of each coefficient.
    #[command(after_help = "Example: froude plan campaign.toml")]
    Plan {
        /// The campaign, with `source.plan` blocks and, for the intervals, a `simulate` section.
        campaign: PathBuf,
    },
    /// Write the observation tables, or the runs, that a campaign would give for chosen true coefficients.
    #[command(after_help = "Example: froude simulate campaign.toml")]
    Simulate {
        /// The campaign, with its `simulate` section and `source.plan` blocks.
        campaign: PathBuf,
        /// Write over existing tables and runs of a twin.
        #[arg(long)]
        replace: bool,
    },
    /// Drive a towing carriage, or its simulated twin, through a campaign: pre-flight, runs, records; resumes where it stopped.
    #[command(after_help = "Examples:\n  froude run campaign.toml --check\n  froude run campaign.toml")]
    Run {
        /// The campaign, with its `rig` and `carriage` sections.
        campaign: PathBuf,
        /// Folder of the runs [default: CAMPAIGN-runs beside the campaign].
        #[arg(long)]
        out: Option<PathBuf>,
        /// Run the pre-flight only: nothing moves, nothing is written.
        #[arg(long)]
        check: bool,
        /// Confirm the operator's steps without asking, on the twin only; otherwise a person confirms them at the terminal.
        #[arg(long)]
        yes: bool,
    },
    /// Added mass from potential flow, of a mesh, a shape given by its dimensions, or a snake robot with any number of links.
    #[command(
        after_help = "Examples:\n  froude added-mass hull.stl --density '1025 kg/m^3'\n  froude added-mass robot.toml --links 1..9"
    )]
    AddedMass(Box<AddedMassArgs>),
    /// Swim a robot of modules with a gait: speed, powers, cost of transport, torques and stability of the motion that repeats.
    #[command(
        after_help = "Example: froude swim robot.toml --gait lateral --amplitude '30 deg' --frequency '80 deg/s' --phase '40 deg'"
    )]
    Swim(SwimArgs),
    /// Characterise a towing carriage: calibrate, identify and tune it, and find drag from its motor current.
    #[command(after_help = "Example: froude carriage drag campaign-runs")]
    Carriage {
        /// What to do.
        #[command(subcommand)]
        job: CarriageJob,
    },
    /// Print the JSON Schema of estimate.json.
    #[command(after_help = "Example: froude schema > estimate.schema.json")]
    Schema,
}

/// What `froude carriage` does.
#[derive(Debug, Subcommand)]
pub enum CarriageJob {
    /// Identify inertia, friction, flexibility and repeatability from runs, or inertia and friction from any servo log (CSV with a sidecar).
    #[command(after_help = "Examples:\n  froude carriage identify campaign-runs\n  froude carriage identify servo.csv")]
    Identify {
        /// Folders of runs, runs (.mcap), or one log (.csv).
        #[arg(required = true)]
        input: Vec<PathBuf>,
        /// Sidecar of a log [default: the .toml of the same name beside it].
        #[arg(long)]
        sidecar: Option<PathBuf>,
        /// Folder of the results [default: INPUT-servo beside the input].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Compare D_d and C_D by force sensor, motor current difference and model.
    #[command(after_help = "Example: froude carriage drag campaign-runs")]
    Drag {
        /// Folders of runs, or runs (.mcap).
        #[arg(required = true)]
        runs: Vec<PathBuf>,
        /// Campaign to use instead of the copy stored with the runs.
        #[arg(long)]
        campaign: Option<PathBuf>,
        /// Folder of the results [default: RUNS-drag or ID-drag beside the input].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Find force per volt from known weights over a pulley, and polarity from the jogs.
    #[command(after_help = "Example: froude carriage calibrate campaign-runs")]
    Calibrate {
        /// Folders of runs, or runs (.mcap).
        #[arg(required = true)]
        runs: Vec<PathBuf>,
        /// Campaign to use instead of the copy stored with the runs.
        #[arg(long)]
        campaign: Option<PathBuf>,
        /// Folder of the results [default: RUNS-calibration beside the input].
        #[arg(long)]
        out: Option<PathBuf>,
        /// A distance that was measured on the carriage; needs --counted.
        #[arg(long, requires = "counted", value_name = "QUANTITY")]
        measured: Option<String>,
        /// Standard uncertainty of the measured distance.
        #[arg(long, default_value = "0.5 mm", value_name = "QUANTITY")]
        measured_standard: String,
        /// The same distance according to the encoder counts, once for each traverse (two at least), separated by commas.
        #[arg(long, requires = "measured", value_name = "QUANTITY", value_delimiter = ',')]
        counted: Vec<String>,
    },
    /// Run a relay test and a sweep on the position loop: margins on the measured response, proposed gains.
    #[command(after_help = "Example: froude carriage tune campaign.toml")]
    Tune(Experiment),
    /// Sweep the carriage bare, dry and wet: find the load mode, and propose an input shaper.
    #[command(after_help = "Example: froude carriage resonance campaign.toml")]
    Resonance(Experiment),
}

/// An experiment on the rig of a campaign.
#[derive(Debug, clap::Args)]
pub struct Experiment {
    /// The campaign, with its `rig` and `carriage` sections.
    pub campaign: PathBuf,
    /// Folder of the runs and the report.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Confirm the operator's steps without asking, on the twin only; otherwise a person confirms them at the terminal.
    #[arg(long)]
    pub yes: bool,
}

/// What `froude swim` takes.
#[derive(Debug, clap::Args)]
pub struct SwimArgs {
    /// The robot (.toml): modules, drag and added mass by records.
    pub robot: PathBuf,
    /// How the amplitude goes along the body: alike at all joints, or growing to the tail.
    #[arg(long, value_enum, default_value = "lateral")]
    pub gait: GaitKind,
    /// Amplitude of a joint; of the eel that of joint n+1, one behind the last.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub amplitude: String,
    /// Angular frequency, or cycles a second: '80 deg/s', '0.22 Hz'.
    #[arg(long, value_name = "FREQUENCY", allow_hyphen_values = true)]
    pub frequency: String,
    /// Phase from joint to joint.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub phase: String,
    /// Mean angle of every joint: turns.
    #[arg(long, value_name = "ANGLE", default_value = "0 deg", allow_hyphen_values = true)]
    pub turn: String,
    /// Folder of trajectory.parquet; without it nothing is written.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Periods of the trajectory.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub periods: u32,
}

/// How the amplitude of a gait goes along the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum GaitKind {
    /// Alike at all joints.
    Lateral,
    /// i/(n+1) at joint i of n modules, from the head.
    Eel,
}

/// What `froude added-mass` takes.
#[derive(Debug, clap::Args)]
pub struct AddedMassArgs {
    /// A body file (.toml), or a closed mesh: STL, OBJ, PLY, WAMIT .gdf, Nemoh .dat, Gmsh .msh.
    pub input: PathBuf,
    #[command(flatten)]
    pub options: AddedMassOptions,
    /// What --up was called.
    #[arg(long, hide = true)]
    pub z: Option<String>,
    /// What --at was called.
    #[arg(long, hide = true, allow_hyphen_values = true)]
    pub origin: Option<String>,
    /// Only check the mesh, and state the time and memory that each resolution would take.
    #[arg(long)]
    pub check: bool,
    /// Write a mesh with the unambiguous faults corrected to this file (.obj or .stl); nothing is computed.
    #[arg(long, value_name = "FILE")]
    pub repair: Option<PathBuf>,
    /// Merge vertices closer than this, in a repair [default: a millionth of the mesh's extent].
    #[arg(long, value_name = "QUANTITY")]
    pub weld: Option<String>,
    /// Folder of the results [default: INPUT-added-mass beside the input].
    #[arg(long)]
    pub out: Option<PathBuf>,
}

/// What is asked of an added mass: a flag for every option that a campaign may have.
#[derive(Debug)]
pub struct AddedMassOptions(pub Vec<GivenOption>);

impl clap::Args for AddedMassOptions {
    fn augment_args(command: Command) -> Command {
        ADDED_MASS_OPTIONS.iter().fold(command, |command, option| {
            let flag = Arg::new(option.name).long(option.flag).help(option.help);
            command.arg(match option.takes {
                None => flag.action(ArgAction::SetTrue),
                Some(takes) => {
                    let flag = flag.value_name(takes).allow_hyphen_values(true).action(ArgAction::Set);
                    if option.words.is_empty() { flag } else { flag.value_parser(option.words.to_vec()) }
                }
            })
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for AddedMassOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = ADDED_MASS_OPTIONS.iter().filter_map(|option| {
            let text = match option.takes {
                None => matches.get_flag(option.name).then(|| "true".to_owned())?,
                Some(_) => matches.get_one::<String>(option.name)?.clone(),
            };
            Some(GivenOption { name: option.name.to_owned(), text, place: None })
        });
        Ok(Self(given.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
