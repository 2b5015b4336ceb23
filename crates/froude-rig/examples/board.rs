//! A board at a pseudo-terminal, for driving `froude run` without hardware: the firmware's own application, in real time, on the twin.
//!
//! `cargo run --release -p froude-rig --example board -- LINK [PATIENCE]` makes `LINK` a link to the terminal; a campaign with
//! `kind = "serial"`, `port = "LINK"` and `baud = 3_000_000` drives it. Every change of phase or fault is printed, and once a minute how much
//! memory this process has. `PATIENCE` is how many seconds the board's time may stand still for a host that the computer keeps from its
//! heartbeats; none unless given. It runs until it is interrupted.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::time::{Duration, Instant};

#[path = "../tests/board/mod.rs"]
mod board;

use board::{BoardAtTerminal, BoardConfig};

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let patience = arguments.get(1).map_or(Some(0.0), |text| text.parse().ok());
    let (Some(link), Some(patience_s)) = (arguments.first(), patience) else {
        eprintln!("usage: board LINK [PATIENCE in seconds]");
        std::process::exit(2);
    };
    let patience = Duration::try_from_secs_f64(patience_s).map_err(std::io::Error::other)?;
    let board = BoardAtTerminal::new(&BoardConfig { start_m: [0.02, 0.02], patience })?;
    let link = Path::new(link);
    if link.symlink_metadata().is_ok_and(|m| m.is_symlink()) {
        std::fs::remove_file(link)?;
    }
    std::os::unix::fs::symlink(&board.port, link)?;
    println!("{} is {}", link.display(), board.port.display());
    let began = Instant::now();
    let (mut last, mut minutes) = (board.watched(), 0);
    loop {
        std::thread::sleep(Duration::from_millis(20));
        let now = board.watched();
        let since_s = began.elapsed().as_secs_f64();
        if (now.fault, now.phases) != (last.fault, last.phases) {
            println!("{since_s:9.2} s  {:?}  {:?}", now.phases, now.fault);
        }
        if since_s >= 60.0 * f64::from(minutes) {
            minutes += 1;
            println!("{since_s:9.2} s  {} ticks, memory {}", now.ticks, memory());
        }
        last = now;
    }
}

/// Resident memory, as the system says it.
fn memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status.lines().find_map(|l| l.strip_prefix("VmRSS:")).map_or_else(|| "unknown".to_owned(), |l| l.trim().to_owned())
}
