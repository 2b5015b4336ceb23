//! The carriage's firmware: images for the Cortex-A8, built with a compiler that has its library's source, and run in an emulator.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::run;

/// Debian's names of what is needed.
const PACKAGES: [&str; 5] = ["rustc-web", "cargo-web", "rust-web-src", "binutils-arm-none-eabi", "qemu-system-arm"];
const TARGET: &str = "armv7a-none-eabihf";
/// The symbol that a reachable panic leaves undefined.
const PANIC: &str = "a_panic_is_still_reachable";

/// Builds all images, shows that a panic would not link, and runs the tests of drivers, application and emulated board.
///
/// `is_full` runs the lock step over 20 simulated seconds instead of 2.
pub fn firmware(root: &Path, is_full: bool) -> Result<(), String> {
    let folder = root.join("firmware");
    let tools = Tools::find().map_or_else(|| install(root), Ok)?;
    println!("xtask: images with {}", tools.rustc.display());
    let built = tools.build(&folder, &[])?;
    if !built.status.success() {
        return Err(format!("images:\n{}", String::from_utf8_lossy(&built.stderr)));
    }
    let provoked = tools.build(&folder, &["--bin", "carriage-realview", "--features", "reachable-panic"])?;
    let reported = String::from_utf8_lossy(&provoked.stderr);
    if provoked.status.success() || !reported.contains(PANIC) {
        return Err(format!("an image with a reachable panic was linked:\n{reported}"));
    }
    println!("xtask: a reachable panic does not link");
    let release = folder.join("target").join(TARGET).join("release");
    let (image, binary) = (release.join("carriage-am335x"), release.join("carriage-am335x.bin"));
    run(root, "arm-none-eabi-objcopy", &["-O", "binary", &image.to_string_lossy(), &binary.to_string_lossy()])?;

    run(&folder, "cargo", &["fmt", "--all", "--check"])?;
    run(&folder, "cargo", &["clippy", "--all-targets", "--locked", "--", "-D", "warnings"])?;
    println!("xtask: cargo test in firmware/");
    let mut tests = Command::new("cargo");
    tests.args(["test", "--locked", "--", "--nocapture"]).current_dir(&folder);
    if is_full {
        tests.env("FROUDE_FULL", "1");
    }
    let status = tests.status().map_err(|e| e.to_string())?;
    if status.success() { Ok(()) } else { Err("tests of the firmware".into()) }
}

/// A compiler with the source of its library, and the cargo beside it.
struct Tools {
    rustc: PathBuf,
    cargo: PathBuf,
}

impl Tools {
    /// The first in the path whose sysroot has the source, if linker and emulator are there, too.
    fn find() -> Option<Self> {
        let is_there = |program| Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
        if !is_there("arm-none-eabi-ld") || !is_there("arm-none-eabi-objdump") || !is_there("qemu-system-arm") {
            return None;
        }
        let path = std::env::var_os("PATH")?;
        std::env::split_paths(&path).find_map(|folder| {
            let (rustc, cargo) = (folder.join("rustc"), folder.join("cargo"));
            let asked = bare(&rustc).args(["--print", "sysroot"]).output().ok()?;
            let sysroot = PathBuf::from(String::from_utf8_lossy(&asked.stdout).trim());
            let has_source = sysroot.join("lib/rustlib/src/rust/library/core/Cargo.toml").exists();
            (has_source && cargo.exists()).then_some(Self { rustc, cargo })
        })
    }

    fn build(&self, folder: &Path, more: &[&str]) -> Result<Output, String> {
        bare(&self.cargo)
            .args(["build", "--release", "--locked"])
            .args(more)
            .env("RUSTC", &self.rustc)
            .env("RUSTC_BOOTSTRAP", "1") // build-std
            .current_dir(folder.join("images"))
            .output()
            .map_err(|e| e.to_string())
    }
}

/// A program that does not inherit which toolchain this one was started with.
fn bare(program: &Path) -> Command {
    let mut command = Command::new(program);
    for key in ["RUSTUP_TOOLCHAIN", "CARGO", "RUSTC", "RUSTFLAGS", "CARGO_TARGET_DIR"] {
        command.env_remove(key);
    }
    command
}

fn install(root: &Path) -> Result<Tools, String> {
    run(root, "apt-get", &["update", "-qq"])?;
    let mut args = vec!["install", "-y", "--no-install-recommends"];
    args.extend(PACKAGES);
    run(root, "apt-get", &args)?;
    Tools::find().ok_or_else(|| {
        format!("no compiler with its library's source, linker and emulator; needed are {}", PACKAGES.join(", "))
    })
}
