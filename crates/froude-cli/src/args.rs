//! What the user can say on the command line.

use std::path::PathBuf;

use clap::{Parser, Subcommand};

/// Hydrodynamic coefficients that can be trusted, from tank tests and computations.
#[derive(Debug, Parser)]
#[command(name = "froude", version, about, arg_required_else_help = true)]
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
    Demo {
        /// Folder to write; must be empty or new.
        #[arg(default_value = "froude-demo")]
        dir: PathBuf,
    },
    /// Fit every force model asked for, choose, and write estimate.json and report.html.
    Identify {
        /// A campaign (.toml) or a bare table (.csv, .parquet).
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
    /// Set estimate records side by side: coefficients, jointly, and as predicted forces.
    Compare {
        /// Records (estimate.json), at least one.
        #[arg(required = true)]
        estimates: Vec<PathBuf>,
        /// Print every pair of coefficients, not only those of the recommended models.
        #[arg(long)]
        all: bool,
    },
    /// Say what is in a table, campaign or record, with units, ranges and every finding.
    Inspect {
        /// The file.
        file: PathBuf,
        /// Sidecar of a table.
        #[arg(long)]
        sidecar: Option<PathBuf>,
    },
    /// Write the observation tables that a campaign would give for its chosen true coefficients.
    Simulate {
        /// The campaign, with its `simulate` section and `source.plan` blocks.
        campaign: PathBuf,
        /// Write over an existing table.
        #[arg(long)]
        replace: bool,
    },
    /// Print the JSON Schema of estimate.json.
    Schema,
}
