//! The people around a drive: who may stop it, who confirms, and who is informed.
//!
//! The carriage is driven by a thread that knows none of this. Everything for the terminal goes to a thread that writes it as the
//! terminal takes it: who drives and records never waits for standard error, and a line that nobody reads is no failure.

use std::io::{IsTerminal, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use froude::carriage::drive::Prepared;
use froude::records::text::visible;
use froude::rig::campaign::runner::{Operator, Progress};
use froude::rig::campaign::stop::StopSwitch;
use froude::rig::carriage::plan::PlannedRun;
use froude::rig::drive::Sample;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::Failure;
use crate::signals;

/// Words that may wait for a slow terminal; more are dropped.
const WORDS: usize = 256;
/// What is said before the first question about a rig that is none.
const TWIN: &str =
    "This is the twin, a simulated rig: nothing real moves. It asks as the rig would; --yes confirms every step.\n";
/// How often a wait looks up.
const LOOK_UP: Duration = Duration::from_millis(50);

/// Everybody around a drive.
pub struct Stage {
    /// Ctrl-C, SIGTERM and SIGHUP.
    pub switch: StopSwitch,
    pub person: Person,
    pub bar: Bar,
}

impl Stage {
    /// Sets the stage for a drive of so many runs.
    ///
    /// # Errors
    ///
    /// Nobody is there to confirm, or nobody could stop it: nothing has moved then, and nothing may.
    pub fn set(prepared: &Prepared, yes: bool, runs: usize) -> Result<Self, Failure> {
        if yes && !prepared.is_twin() {
            let why = "at a real rig a person must be present and confirm each step";
            return Err(Failure::refused(format_args!("--yes is for the twin: {why}")));
        }
        if !yes && !std::io::stdin().is_terminal() {
            let or = if prepared.is_twin() { ", or give --yes, which the twin accepts" } else { "" };
            return Err(Failure::refused(format_args!(
                "nothing was moved: nobody can confirm, because standard input is not a terminal. Run it in a terminal{or}"
            )));
        }
        // Nobody who stops reading ends a drive half way.
        crate::out::go_on_unread();
        let switch = StopSwitch::default();
        let watch = || {
            for signal in [SIGINT, SIGTERM, SIGHUP] {
                flag::register(signal, switch.stop_flag())?;
            }
            flag::register(SIGINT, switch.press_flag())
        };
        let unwatched = |e| Failure::refused(format_args!("Ctrl-C cannot be watched: {e}; nothing was moved"));
        watch().map_err(unwatched)?;
        signals::take_over();
        let (words, heard) = sync_channel(WORDS);
        let terminal = Terminal::new(runs, switch.clone());
        let thread = std::thread::spawn(move || terminal.write(&heard));
        let bar = Bar { words: words.clone(), thread: Some(thread), is_seen: std::io::stderr().is_terminal() };
        let person = Person { is_yes: yes, is_twin: prepared.is_twin(), has_asked: false, words };
        Ok(Self { switch, person, bar })
    }
}

enum Word {
    /// A run begins: its number, how many there are, its name.
    Run(usize, usize, String),
    /// What the bar shows.
    Live(String),
    Line(String),
    /// A question, without the end of its line.
    Question(String),
    End,
}

/// Who writes to the terminal.
struct Terminal {
    /// Not there while a question waits for its answer: the line is the person's.
    bar: Option<ProgressBar>,
    /// Where the bar stands, and of how many.
    at: [usize; 2],
    since: Instant,
    switch: StopSwitch,
}

impl Terminal {
    fn new(runs: usize, switch: StopSwitch) -> Self {
        Self { bar: None, at: [0, runs], since: Instant::now(), switch }
    }

    /// The bar, drawn again where a question has taken it away.
    fn bar(&mut self) -> &ProgressBar {
        let [at, runs] = self.at.map(|n| n as u64);
        let since = self.since;
        self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::new(runs).with_position(at).with_elapsed(since.elapsed());
            match ProgressStyle::with_template("{elapsed_precise} [{bar:24}] {pos}/{len} {msg}") {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        })
    }

    fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    fn write(mut self, words: &Receiver<Word>) {
        let is_seen = std::io::stderr().is_terminal();
        let mut is_stop_told = false;
        loop {
            match words.recv_timeout(LOOK_UP) {
                Ok(Word::Run(number, runs, id)) => {
                    self.at = [number - 1, runs];
                    self.bar().set_length(runs as u64);
                    self.bar().set_position(number as u64 - 1);
                    if !is_seen {
                        self.put(&format!("{number}/{runs} {id}\n"));
                    }
                }
                Ok(Word::Live(message)) => self.bar().set_message(visible(&message).into_owned()),
                Ok(Word::Line(line)) => self.put(&format!("{line}\n")),
                Ok(Word::Question(question)) => {
                    self.clear();
                    self.put(&question);
                }
                Ok(Word::End) | Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if !is_stop_told && self.switch.is_asked() {
                is_stop_told = true;
                let more = if self.switch.was_pressed() { "again" } else { "twice" };
                self.put(&format!("\nstopping the carriage under control; Ctrl-C {more} cuts the torque\n"));
            }
        }
        self.clear();
    }

    /// Where nobody reads it, it is not written; that is nobody's failure.
    fn put(&self, text: &str) {
        let write = || {
            let mut stderr = std::io::stderr();
            let _ = stderr.write_all(visible(text).as_bytes()).and_then(|()| stderr.flush());
        };
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}

/// The operator at the terminal.
pub struct Person {
    is_yes: bool,
    is_twin: bool,
    has_asked: bool,
    words: SyncSender<Word>,
}

impl Operator for Person {
    fn confirm(&mut self, prompt: &str, is_over: &dyn Fn() -> bool) -> bool {
        if self.is_yes {
            return true;
        }
        // What was typed before the question is no answer to it.
        let _ = rustix::termios::tcflush(std::io::stdin(), rustix::termios::QueueSelector::IFlush);
        let is_first = !std::mem::replace(&mut self.has_asked, true);
        let hint = if self.is_twin && is_first { TWIN } else { "" };
        let whom = if self.is_twin { "on the twin: " } else { "" };
        let mut question =
            Word::Question(format!("\n{hint}>>> {whom}{prompt}; confirm with y and Enter (anything else stops): "));
        while let Err(error) = self.words.try_send(question) {
            use std::sync::mpsc::TrySendError::{Disconnected, Full};
            question = match error {
                Full(question) if !is_over() => question,
                Full(_) | Disconnected(_) => return false,
            };
            std::thread::sleep(LOOK_UP);
        }
        // Reading cannot be called off: who reads is left behind when nobody waits for the answer any more, and the program ends then.
        let (answers, answered) = sync_channel(1);
        std::thread::spawn(move || {
            let mut line = String::new();
            let is_read = std::io::stdin().read_line(&mut line).is_ok();
            let _ = answers.send(is_read && matches!(line.trim(), "y" | "yes"));
        });
        loop {
            match answered.recv_timeout(LOOK_UP) {
                Ok(is_confirmed) => return is_confirmed,
                Err(RecvTimeoutError::Timeout) if !is_over() => {}
                Err(_) => return false,
            }
        }
    }
}

/// Live progress on standard error.
pub struct Bar {
    words: SyncSender<Word>,
    thread: Option<JoinHandle<()>>,
    is_seen: bool,
}

impl Bar {
    /// The drive is over; waits until all is written.
    pub fn end(&mut self) {
        // From now on a signal ends the program.
        signals::give_back();
        let _ = self.words.send(Word::End);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Progress for Bar {
    fn run_begins(&mut self, run: &PlannedRun, number: usize, total: usize) {
        let _ = self.words.try_send(Word::Run(number, total, run.id.clone()));
    }

    fn sample(&mut self, run: &PlannedRun, sample: &Sample, time_s: f64) {
        if self.is_seen {
            let y = &sample.axes[run.axis as usize];
            let force = sample.force_n.map_or_else(String::new, |f| format!(", sensor {f:.2} N"));
            let _ = self.words.try_send(Word::Live(format!(
                "{} {time_s:.1} s: {:.3} m, {:.3} m/s, {:.2} V, {:.2} A{force}",
                run.id, y.position_m, y.reference_m_s, y.command_v, y.current_a
            )));
        }
    }

    fn say(&mut self, line: &str) {
        let _ = self.words.try_send(Word::Line(line.to_owned()));
    }
}
