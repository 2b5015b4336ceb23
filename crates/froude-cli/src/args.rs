//! What the user can say on the command line.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, Command, Parser, Subcommand};
use froude::methods::added_mass::option_list::ADDED_MASS_OPTIONS;
use froude::records::given_option::GivenOption;

const EXIT_CODES: &str = "Exit code: 0 done, whatever the findings say; 1 failed; 2 bad input; 130 stopped by Ctrl-C; re-run the same command to resume.";

/// Froude turns tank tests, tows and potential flow into drag and added-mass coefficients with realistic uncertainties, and drives the towing carriage.
#[derive(Debug, Parser)]
#[command(name = "froude", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Print the result as JSON on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// Print the tables of the result as CSV on standard output, in SI units at full precision.
    #[arg(long, global = true, conflicts_with = "json")]
    pub csv: bool,
    #[command(subcommand)]
    pub verb: Verb,
}

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
    /// Predict the loads of a table's rows by a record's law, with bands, errors, E_n and one χ² over all rows.
    #[command(after_help = "Example: froude predict monday-results/estimate.json tuesday.csv --out predicted")]
    Predict {
        /// The record (estimate.json).
        record: PathBuf,
        /// The table (.csv, .parquet); where it has loads, they are compared.
        table: PathBuf,
        /// Sidecar of the table [default: the .toml of the same name beside it].
        #[arg(long)]
        sidecar: Option<PathBuf>,
        /// A law or an estimate's id, once for each [default: the recommended ones].
        #[arg(long = "law")]
        laws: Vec<String>,
        /// Folder for a table of all rows; without it nothing is written.
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
        /// Write a sidecar that proposes names, units and signs of the columns, to be checked and corrected.
        #[arg(long)]
        write_sidecar: bool,
    },
    /// Convert a table or log in any readable format to CSV, Parquet or MCAP, with names and units.
    #[command(after_help = "Examples:\n  froude convert tow.tdms tow.csv\n  froude convert drift.xlsx drift.parquet")]
    Convert {
        /// The table or log.
        input: PathBuf,
        /// The file to write (.csv, .parquet, .mcap); it must not exist yet.
        out: PathBuf,
        /// Sidecar of the table [default: the .toml of the same name beside it].
        #[arg(long)]
        sidecar: Option<PathBuf>,
    },
    /// Write a commented campaign of one kind, with only the keys that matter, to be filled in.
    #[command(after_help = froude::records::starter::help())]
    New {
        /// Kind of campaign.
        #[arg(value_parser = froude::records::starter::kinds())]
        kind: String,
        /// Folder to write into; nothing in it is replaced.
        #[arg(long, default_value = ".")]
        out: PathBuf,
    },
    /// Show the run matrix of a campaign, its time in the tank, and the interval to expect of each coefficient.
    #[command(after_help = "Example: froude plan campaign.toml")]
    Plan {
        /// The campaign, with `source.plan` blocks and, for the intervals, a `simulate` section; or that of a carriage.
        campaign: PathBuf,
    },
    /// Write the observation tables, or the runs, that a campaign would give for chosen true coefficients.
    #[command(after_help = "Example: froude simulate campaign.toml")]
    Simulate {
        /// The campaign, with its `simulate` section and `source.plan` blocks.
        campaign: PathBuf,
        /// Write over tables and runs that a twin wrote and nobody changed.
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
        after_help = "Examples:\n  froude added-mass hull.stl --unit mm --density '1025 kg/m^3'\n  froude added-mass robot.toml --links 1..9"
    )]
    AddedMass(Box<AddedMassArgs>),
    /// Swim a robot of modules with a gait: speed, powers, cost of transport, torques and stability of the motion that repeats.
    #[command(
        after_help = "Example: froude swim robot.toml --gait lateral --amplitude '30 deg' --frequency '80 deg/s' --phase '40 deg'"
    )]
    Swim(Box<SwimArgs>),
    /// Look at a robot before it swims: masses, volumes, trim, added mass and drag of each module, and what does not fit together.
    #[command(after_help = "Example: froude robot inspect robot.toml")]
    Robot {
        #[command(subcommand)]
        job: RobotJob,
    },
    /// Compute the flow about a body: a campaign of OpenFOAM cases, planned, run on this machine or a Slurm cluster, and collected for identify.
    #[command(
        after_help = "Examples:\n  froude cfd plan campaign.toml\n  froude cfd run campaign.toml --jobs 2\n  froude identify campaign.toml"
    )]
    Cfd {
        #[command(subcommand)]
        job: CfdJob,
    },
    /// Characterise a towing carriage: calibrate, identify and tune it, and find drag from its motor current.
    #[command(after_help = "Example: froude carriage drag campaign-runs")]
    Carriage {
        #[command(subcommand)]
        job: CarriageJob,
    },
    /// Print the JSON Schema of estimate.json, of what a verb prints with --json, or of a campaign, for completion and checks in an editor.
    #[command(after_help = "Examples:\n  froude schema plan\n  froude schema campaign > campaign.schema.json")]
    Schema {
        /// `campaign`, or the verb whose output to describe; hyphenate subcommands (`cfd-plan` for `froude cfd plan`).
        #[arg(default_value = "identify", value_parser = froude::records::schema::described())]
        of: String,
    },
}

#[derive(Debug, clap::Args)]
pub struct CfdCampaign {
    /// The campaign, with a source of `kind = "cfd"` that names a folder for its `cases`, or one of `method = "forced_oscillation"`, that has a [source.cfd].
    pub campaign: PathBuf,
    /// Which source, where several are computed.
    #[arg(long)]
    pub source: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum EngineName {
    /// This machine, one processor a case.
    Local,
    /// This machine, several processors a case.
    Mpi,
    /// A Slurm cluster that shares this folder.
    Slurm,
}

#[derive(Debug, Subcommand)]
pub enum CfdJob {
    /// Make the meshes and write the cases, with their cells, hours and disk; nothing runs.
    #[command(after_help = "Example: froude cfd plan campaign.toml")]
    Plan {
        #[command(flatten)]
        of: CfdCampaign,
        /// Cases side by side, for the hours [default: one for each processor].
        #[arg(long, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..))]
        jobs: Option<usize>,
    },
    /// Compute the cases that have no result; re-run to resume, even after a crash.
    #[command(
        after_help = "Examples:\n  froude cfd run campaign.toml --jobs 2\n  froude cfd run campaign.toml --engine slurm --time 60"
    )]
    Run {
        #[command(flatten)]
        of: CfdCampaign,
        /// What computes.
        #[arg(long, value_enum, default_value_t = EngineName::Local)]
        engine: EngineName,
        /// Cases side by side [default: one for each processor; all that Slurm grants; one with --engine mpi].
        #[arg(long, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..))]
        jobs: Option<usize>,
        /// Processors of a case [default: 2 with --engine mpi, else 1].
        #[arg(long, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1024))]
        ranks: Option<usize>,
        /// Minutes of work in a task of Slurm.
        #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
        batch: u16,
        /// Time limit of a task of Slurm, minutes [default: four times what it is expected to take].
        #[arg(long)]
        time: Option<u32>,
        /// Memory of a task of Slurm, MiB.
        #[arg(long)]
        memory: Option<u64>,
        /// Partition of Slurm.
        #[arg(long)]
        partition: Option<String>,
    },
    /// Show how far a campaign is: a row per case, those that fail first.
    #[command(after_help = "Example: froude cfd status campaign.toml")]
    Status {
        #[command(flatten)]
        of: CfdCampaign,
    },
    /// Write the table of computed forces, which identify reads by itself too.
    #[command(after_help = "Example: froude cfd collect campaign.toml")]
    Collect {
        #[command(flatten)]
        of: CfdCampaign,
    },
    /// Suggest settings to compute next, as plan blocks: those next to settings that interpolation from their neighbours predicts worst.
    #[command(after_help = "Example: froude cfd suggest campaign.toml --count 8")]
    Suggest {
        #[command(flatten)]
        of: CfdCampaign,
        /// New settings at most.
        #[arg(long, default_value_t = 6, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
        count: usize,
    },
    /// Compute the planned runs of a forced oscillation, as logs that `froude identify` reads like tank logs; re-run to resume.
    #[command(after_help = "Example: froude cfd swing campaign.toml && froude identify campaign.toml")]
    Swing {
        #[command(flatten)]
        of: CfdCampaign,
        /// Runs side by side [default: one for each processor].
        #[arg(long, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..))]
        jobs: Option<usize>,
    },
    /// Write a page of a campaign: status, meshes, forces against angle and speed, convergence, surface pressure and wake.
    #[command(
        after_help = "Examples:\n  froude cfd report campaign.toml\n  froude cfd report campaign.toml --case H5LT-u0.4-a45 --case H5LT-u0.4-a90"
    )]
    Report {
        #[command(flatten)]
        of: CfdCampaign,
        /// A case whose flow is shown, once for each [default: the middle configuration at its highest speed, at 0, 45 and 90 degrees].
        #[arg(long = "case", value_name = "ID")]
        cases: Vec<String>,
        /// Folder of the page and its figures [default: CAMPAIGN-cfd beside the campaign].
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Put cases that failed or diverged back among those to compute.
    #[command(after_help = "Example: froude cfd retry campaign.toml H3LT-u0.4-a30")]
    Retry {
        #[command(flatten)]
        of: CfdCampaign,
        /// Names of cases [default: all that failed or diverged].
        cases: Vec<String>,
    },
    /// Compute single cases, each by its folder: what a queue of any kind runs.
    #[command(after_help = "Example: froude cfd case cases/cases/H3LT-u0.4-a30")]
    Case {
        /// Folders of cases.
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// Processors of a case.
        #[arg(long, default_value_t = 1, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1024))]
        ranks: usize,
    },
}

#[derive(Debug, Subcommand)]
pub enum RobotJob {
    /// Show masses, volumes, trim, added mass and drag of each module, the forces of the whole, and what does not fit together.
    #[command(after_help = "Example: froude robot inspect robot.toml")]
    Inspect {
        /// The robot (.toml, or .urdf with a .toml of the same name for the water).
        robot: PathBuf,
    },
}

#[derive(Debug, Subcommand)]
pub enum CarriageJob {
    /// Identify inertia, friction, flexibility and repeatability from runs, or inertia and friction from any servo log (CSV with a sidecar).
    #[command(
        after_help = "Examples:\n  froude carriage identify campaign-runs\n  froude carriage identify servo.csv --validate pulses.csv"
    )]
    Identify {
        /// Folders of runs, runs (.mcap), or one log (.csv).
        #[arg(required = true)]
        input: Vec<PathBuf>,
        /// Sidecar of a log [default: the .toml of the same name beside it].
        #[arg(long)]
        sidecar: Option<PathBuf>,
        /// Log of another motion of the same axis (.csv with a sidecar): the force error of each rigid model there, where nothing was fitted.
        #[arg(long, value_name = "OTHER")]
        validate: Option<PathBuf>,
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

#[derive(Debug, Clone, clap::Args)]
pub struct SwimArgs {
    /// The robot (.toml): modules, drag and added mass by records; or a .urdf with a .toml of the same name for the water.
    pub robot: PathBuf,
    /// lateral: the amplitude alike at all joints; eel: growing to the tail; or a gait file (.toml).
    #[arg(long, value_name = "KIND|FILE", default_value = "lateral")]
    pub gait: String,
    /// Joint amplitude (eel: amplitude at a virtual joint n+1 behind the last). Overrides the gait file, as do --frequency, --phase and --turn.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub amplitude: Option<String>,
    /// Angular frequency, or cycles a second: '80 deg/s', '0.22 Hz'.
    #[arg(long, value_name = "FREQUENCY", allow_hyphen_values = true)]
    pub frequency: Option<String>,
    /// Phase from joint to joint.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub phase: Option<String>,
    /// Mean angle of every joint: turns [default: 0 deg].
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub turn: Option<String>,
    /// Amplitude of the joints that pitch, of a robot of three dimensions [default: 0 deg].
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true, conflicts_with_all = ["sweep", "track"])]
    pub pitch_amplitude: Option<String>,
    /// Phase lead of the pitch wave over the yaw wave; 90 deg gives a helix [default: 90 deg].
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true, conflicts_with_all = ["sweep", "track"])]
    pub pitch_ahead: Option<String>,
    /// Mean angle of every joint that pitches: bow up or down [default: 0 deg].
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true, conflicts_with_all = ["sweep", "track"])]
    pub pitch_turn: Option<String>,
    /// Recorded joint angles instead of a gait: a table (.csv, .parquet) with time and phi_1, phi_2, … from the head.
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["gait", "amplitude", "frequency", "phase", "turn", "periods"])]
    pub track: Option<PathBuf>,
    /// Many gaits instead of one: 'amplitude=10..50 deg:9, phase=10..80 deg:8'; also frequency and turn. Writes sweep.parquet; re-run to resume.
    #[arg(long, value_name = "RANGES", requires = "out", conflicts_with_all = ["track", "periods"])]
    pub sweep: Option<String>,
    /// Pareto-optimal gaits within the ranges of --sweep for two objectives: two of speed, power, cost. Refines between the grid's points and writes front.parquet.
    #[arg(long, value_name = "A,B", requires = "sweep", value_delimiter = ',', num_args = 1, value_parser = ["speed", "power", "cost"])]
    pub optimise: Vec<String>,
    /// Number of coefficient draws from the covariance of their record: 95 % intervals of speed, powers and cost; in a sweep, a row for each draw.
    #[arg(long, value_name = "N", conflicts_with = "track", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub draws: Option<u32>,
    /// Seed of the draws: same seed, same result.
    #[arg(long, default_value_t = 1, requires = "draws")]
    pub seed: u64,
    /// What speed and cost of transport owe to each coefficient, and which to measure next.
    #[arg(long, conflicts_with_all = ["track", "sweep"])]
    pub sensitivity: bool,
    /// Motor of the joints (.toml): largest torque over speed, efficiency.
    #[arg(long, value_name = "FILE")]
    pub motor: Option<PathBuf>,
    /// Largest time step of the servo loop: '2 ms' [default: as short as waves, drag and servos need].
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub step: Option<String>,
    /// Folder of trajectory.parquet, report.html, animation.html and result.json, or of sweep.parquet; without it nothing is written. The trajectory starts on the periodic motion, or at the robot file's initial state if it gives one.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Periods of the trajectory.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub periods: u32,
}

#[derive(Debug, clap::Args)]
pub struct AddedMassArgs {
    /// A body file (.toml), or a closed mesh: STL, OBJ, PLY, WAMIT .gdf, Nemoh .dat, Gmsh .msh, Collada .dae.
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
        Self::from_arg_matches(matches).map(|given| *self = given)
    }
}
