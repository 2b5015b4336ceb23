//! Project tasks: one command runs what the pipeline runs, its parts run alone.
//!
//! `cargo xtask test` is the whole of `.ci/run`: format, lints, tests, documentation, the firmware in its emulator, the demo and the
//! short validation. The firmware needs a cross linker and an emulator, the tests need strace and a Python with the
//! packages of `oracles.txt`; they are installed when they are absent.
//! What takes longer or needs more programs has its own task, which installs what it needs.

mod cycles;
mod firmware;
mod lines;
mod oracles;
mod unreached;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use clap::{Parser, Subcommand};

/// Project tasks.
#[derive(Parser)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Everything that the pipeline runs: format, lints, tests, docs, firmware, demo, short validation.
    Test,
    /// The validation, full length: coverage with 20,000 repetitions, real data, licences, book.
    Validate {
        /// 2,000 repetitions, no licences, no book: as the pipeline runs it.
        #[arg(long)]
        short: bool,
    },
    /// Fuzz every parser of our own (needs cargo-fuzz; installs it).
    Fuzz {
        /// Executions per target.
        #[arg(long, default_value_t = 1_000_000)]
        runs: u64,
    },
    /// Benches against numpy, scipy, polars, Capytaine and HAMS in the same run (installs them below bench/peers).
    Bench,
    /// Install the programs of others that tests compare with, into target/oracles.
    Oracles,
    /// Licences and advisories of the dependencies (needs cargo-deny; installs it).
    Deny,
    /// The carriage's firmware: images built, drivers and emulated board tested (installs compiler, linker and emulator).
    Firmware {
        /// The lock step over 20 simulated seconds.
        #[arg(long)]
        full: bool,
    },
    /// The book as HTML (needs mdbook; installs it).
    Book,
    /// Count lines and tokens of each crate, without and with comments, blank lines and tests.
    Lines,
}

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned);
    let started = Instant::now();
    let done = match Cli::parse().task {
        Task::Test => test(&root),
        Task::Validate { short } => validate(&root, short),
        Task::Fuzz { runs } => fuzz(&root, runs),
        Task::Bench => run(&root, "sh", &["bench/peers/run.sh"])
            .and_then(|()| run(&root, "sh", &["bench/peers/added_mass/run.sh"]))
            .and_then(|()| run(&root, "sh", &["bench/peers/swim/run.sh"]))
            .and_then(|()| run(&root, "sh", &["bench/peers/swim3d/run.sh"])),
        Task::Oracles => oracles::need_python(&root),
        Task::Deny => deny(&root),
        Task::Firmware { full } => firmware::firmware(&root, full),
        Task::Book => book(&root),
        Task::Lines => lines::lines(&root),
    };
    println!("xtask: {:.0} s", started.elapsed().as_secs_f64());
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(what) => {
            eprintln!("xtask: failed: {what}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a program; an error names the command line.
fn run(root: &Path, program: &str, args: &[&str]) -> Result<(), String> {
    let line = format!("{program} {}", args.join(" "));
    println!("xtask: {line}");
    let status = Command::new(program).args(args).current_dir(root).status().map_err(|e| format!("{line}: {e}"))?;
    if status.success() { Ok(()) } else { Err(line) }
}

fn cargo(root: &Path, args: &str) -> Result<(), String> {
    let args: Vec<&str> = args.split(' ').collect();
    run(root, "cargo", &args)
}

fn test(root: &Path) -> Result<(), String> {
    let docs =
        || run_env(root, "cargo", &["doc", "--workspace", "--no-deps", "--locked"], "RUSTDOCFLAGS", "-D warnings");
    let steps: [(&str, &dyn Fn() -> Result<(), String>); 9] = [
        ("format", &|| cargo(root, "fmt --all --check")),
        ("lints", &|| cargo(root, "clippy --workspace --all-targets --locked -- -D warnings")),
        ("packages", &|| need_packages(root).and_then(|()| oracles::need_python(root))),
        ("build of the tests", &|| cargo(root, "test --workspace --locked --no-run")),
        ("tests", &|| cargo(root, "test --workspace --locked")),
        ("documentation", &docs),
        ("firmware", &|| firmware::firmware(root, false)),
        ("demo", &|| demo(root)),
        ("validation", &|| validate(root, true)),
    ];
    let mut times = String::new();
    for (name, step) in steps {
        let started = Instant::now();
        let done = step();
        times += &format!("xtask: {:5.0} s  {name}\n", started.elapsed().as_secs_f64());
        if done.is_err() {
            print!("{times}");
            return done;
        }
    }
    print!("{times}");
    Ok(())
}

fn run_env(root: &Path, program: &str, args: &[&str], key: &str, value: &str) -> Result<(), String> {
    println!("xtask: {key}={value:?} {program} {}", args.join(" "));
    let status = Command::new(program).args(args).env(key, value).current_dir(root).status();
    match status {
        Ok(s) if s.success() => Ok(()),
        Ok(_) => Err(args.join(" ")),
        Err(e) => Err(e.to_string()),
    }
}

/// The demo as the README runs it, into a folder of its own below target.
fn demo(root: &Path) -> Result<(), String> {
    let folder = root.join("target").join("demo");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(|e| e.to_string())?;
    }
    let program = built(root, "--bin", "froude")?;
    run(root, &program.to_string_lossy(), &["demo", &folder.to_string_lossy()])
}

/// A program of this workspace in the development profile, built as the tests build it: `cargo run` would choose the features of one
/// package and compile half of the dependencies a second time for them.
fn built(root: &Path, kind: &str, name: &str) -> Result<PathBuf, String> {
    run(root, "cargo", &["build", "--workspace", "--locked", kind, name])?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let folder = target.join("debug");
    Ok(if kind == "--example" { folder.join("examples").join(name) } else { folder.join(name) })
}

fn validate(root: &Path, short: bool) -> Result<(), String> {
    if short {
        let program = built(root, "--example", "validate")?;
        return run(root, &program.to_string_lossy(), &["--short"]);
    }
    // The full length simulates thousands of campaigns: optimised, without the checks that the short one has.
    cargo(root, "run --locked --example validate --release --package froude -- --full")?;
    deny(root)?;
    book(root)
}

/// Installs a cargo program unless it is there.
fn need(root: &Path, program: &str) -> Result<(), String> {
    let there = Command::new("cargo").args([program, "--version"]).output().is_ok_and(|o| o.status.success());
    if there { Ok(()) } else { run(root, "cargo", &["install", "--locked", &format!("cargo-{program}")]) }
}

/// Programs that tests call, with the Debian packages that bring them: what lets calls of a job fail one after the other, a flow solver with MPI, a queue of a cluster.
const PACKAGES: [(&str, &str); 4] =
    [("strace", "strace"), ("simpleFoam", "openfoam"), ("slurmctld", "slurm-wlm"), ("munged", "munge")];

/// Installs the packages whose programs are not there. Where they cannot be, tests that need them say that they were left out; where CI is set that is a failure.
fn need_packages(root: &Path) -> Result<(), String> {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let folders = || std::env::split_paths(&paths).chain([PathBuf::from("/usr/sbin")]);
    let missing = PACKAGES.iter().filter(|(program, _)| !folders().any(|folder| folder.join(program).is_file()));
    let missing: Vec<&str> = missing.map(|(_, package)| *package).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let install = [&["install", "-y", "-qq", "--no-install-recommends"], &missing[..]].concat();
    let done = run(root, "apt-get", &["update", "-qq"]).and_then(|()| run(root, "apt-get", &install));
    match done {
        Err(line) if std::env::var_os("CI").is_none() => {
            println!("xtask: {line} failed: the tests that need {} are left out", missing.join(", "));
            Ok(())
        }
        done => done,
    }
}

fn fuzz(root: &Path, runs: u64) -> Result<(), String> {
    need(root, "fuzz")?;
    let targets = std::fs::read_dir(root.join("fuzz/fuzz_targets")).map_err(|e| e.to_string())?;
    let mut names: Vec<String> = targets
        .filter_map(Result::ok)
        .filter_map(|entry| Some(entry.path().file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    for name in names {
        // Found inputs go into the first folder, the committed ones are read from the second.
        let (corpus, seeds) = (format!("fuzz/corpus/{name}"), format!("fuzz/seeds/{name}"));
        std::fs::create_dir_all(root.join(&corpus)).map_err(|e| e.to_string())?;
        // The sanitizer flags are unstable; the stable compiler accepts them in bootstrap mode.
        println!("xtask: cargo fuzz run {name} ({runs} executions)");
        let status = Command::new("cargo")
            .args(["fuzz", "run", &name, &corpus, &seeds, "--", &format!("-runs={runs}"), "-max_len=4096"])
            .env("RUSTC_BOOTSTRAP", "1")
            .current_dir(root)
            .status()
            .map_err(|e| e.to_string())?;
        if !status.success() {
            return Err(format!("fuzz target {name}"));
        }
    }
    Ok(())
}

fn deny(root: &Path) -> Result<(), String> {
    need(root, "deny")?;
    cargo(root, "deny check bans licenses sources")
}

fn book(root: &Path) -> Result<(), String> {
    let there = Command::new("mdbook").arg("--version").output().is_ok_and(|o| o.status.success());
    if !there {
        run(root, "cargo", &["install", "--locked", "mdbook"])?;
    }
    run(root, "mdbook", &["build", "book"])
}
