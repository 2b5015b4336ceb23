//! A report of invented numbers, to look at.
//!
//! `cargo run -p froude-report --example sample_report -- FOLDER` writes
//! `sample.html` and its figures. The coefficients are near those that
//! Kelasidi et al. publish for the snake robot Mamba; forces, noise and
//! uncertainties are made up.

#[path = "../tests/sample/mod.rs"]
mod sample;

use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "sample-report".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let report = sample::report();
    std::fs::write(folder.join("sample.html"), froude_report::html(&report))?;
    for figure in froude_report::figures(&report) {
        std::fs::write(folder.join(figure.file_name), figure.svg)?;
    }
    println!("{}", folder.join("sample.html").display());
    Ok(())
}
