//! `[source.excited_response]`: a body in waves, held in one run and free in the other, and the runs that are planned of it.
//!
//! ```toml
//! [source.excited_response]
//! axis      = "heave"
//! mass      = { value = "46.8 kg", standard = "0.1 kg" }     # all that moves
//! restoring = { value = "2299.5 N/m", standard = "0.5 %" }   # C33: water plane and springs
//! delay     = { value = "0 ms", standard = "1 ms" }          # of the force behind the motion, each as it stands against the wavemaker
//! window    = { from = "14 s", to = "20.5 s" }               # after the wavemaker's start: the wave is there, its reflections are not
//! harmonics = 3
//!
//! [[source.plan]]
//! period = ["1.2 s", "0.8 s"]
//! stroke = "9 mm"                                            # amplitude of the wavemaker
//! force  = "12 N"                                            # amplitude of the exciting force on the held body
//! held   = 1
//! free   = 2
//! ```

use froude_identify::declare::{Key, Kind, Range, Values, optional, required, usual};
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::section::Section;
use froude_records::section_values::MOST_RUNS;
use froude_records::units::Dimension;

use super::setup::{ACCELERATION, FORCE, POSITION, Setup};
use crate::decay::axis::Motion;
use crate::declared::{STIFFNESS, gain as gain_of, needed, uncertain};
use crate::error::undeclared;
use crate::logs;
use crate::matrix::{Plan, Point};
use crate::names::EXCITED_RESPONSE;

const WINDOW: &[Key] = &[
    required(
        "from",
        Kind::Quantity(Dimension::TIME),
        "write from = \"14 s\", counted from the start of the wavemaker",
        "begin",
    ),
    required(
        "to",
        Kind::Quantity(Dimension::TIME),
        "write to = \"20 s\", before the reflected wave is back at the body",
        "end",
    ),
];

/// The keys of `[source.excited_response]`.
pub const KEYS: &[Key] = &[
    required(
        "axis",
        Kind::Word(&Motion::NAMES),
        "state what the free body does: axis = \"heave\"",
        "what the free body does: `heave`",
    ),
    required(
        "mass",
        Kind::Constant(Dimension::MASS),
        "write mass = { value = \"46.8 kg\", standard = \"0.1 kg\" }, all that moves",
        "all that moves, with its `standard` uncertainty; a number without one counts as exact, here and below, and the report says so",
    )
    .within(Range::Positive),
    required(
        "restoring",
        Kind::Constant(STIFFNESS),
        "write restoring = { value = \"2300 N/m\", standard = \"0.5 %\" }: C33 = rho g times the water plane, and springs",
        "C33",
    )
    .within(Range::Positive),
    usual(
        "delay",
        Kind::Constant(Dimension::TIME),
        "0 s",
        "delay of the force relative to the motion, from filters that differ; both are timed from the start of the wavemaker in their own logs",
    ),
    optional(
        "window",
        Kind::Table(WINDOW),
        "none",
        "`from` and `to`, counted from the start of the wavemaker of each run. It begins when the wave has come up at the body, and ends before its reflections are back. Without it there is no B33",
    ),
    usual("harmonics", Kind::Count(20), "3", "of every fit"),
];

const fn passing(name: &'static str, default: &'static str, doc: &'static str) -> Key {
    usual(name, Kind::Quantity(Dimension::TIME), default, doc).within(Range::NotNegative("a time that passes is not"))
}

/// The keys of a block of a plan.
pub const PLAN: &[Key] = &[
    required(
        "period",
        Kind::Axis(Dimension::TIME),
        "write \"1.2 s\", a list, or { start, stop, step }",
        "period of the wave",
    )
    .within(Range::Positive),
    required(
        "stroke",
        Kind::Quantity(Dimension::LENGTH),
        "write stroke = \"9 mm\", the amplitude of the wavemaker",
        "amplitude of the wavemaker",
    )
    .within(Range::Positive),
    required(
        "force",
        Kind::Quantity(Dimension::FORCE),
        "write force = \"12 N\", the amplitude to expect of the exciting force on the held body",
        "amplitude to expect of the exciting force on the held body",
    )
    .within(Range::Positive),
    usual("held", Kind::Count(MOST_RUNS as u64), "1", "runs with the body held, at each period"),
    usual("free", Kind::Count(MOST_RUNS as u64), "1", "runs with it free, at each period"),
    passing("still", "2 s", "at rest on the log before the wavemaker starts"),
    passing("ramp", "2 s", "time in which the wavemaker reaches its full stroke"),
    passing("travel", "5 s", "from the wavemaker's start until the wave is at the body"),
    usual("lasts", Kind::Quantity(Dimension::TIME), "25 s", "how long the wavemaker runs; the log ends with it")
        .within(Range::Positive),
    usual("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), "200 Hz", "sampling rate of the log")
        .within(Range::Positive),
];

/// Reads `[source.excited_response]`; the errors of the budget are not in it.
pub(super) fn excited(s: &Section<'_>) -> Result<Setup, RecordError> {
    let values = Values::read(s, KEYS)?;
    if values.word("axis", &Motion::ALL) != Some(Motion::Heave) {
        let problem = "is not reduced from waves: only heave of a body that is symmetric fore and aft stands alone, whereas sway and roll (surge and pitch) are coupled by \
                       added masses off the diagonal, which one equation does not hold; write axis = \"heave\"";
        return Err(values.wrong("axis", problem));
    }
    let window_s = values.table("window").map(|window| {
        let time = |key: &str| window.need(key, window.number(key));
        let (from, to) = (time("from")?, time("to")?);
        let problem = || {
            format!(
                "makes a window from {from} s to {to} s; it must begin at 0 s or later, and end after its beginning"
            )
        };
        if from >= 0.0 && to > from { Ok([from, to]) } else { Err(window.wrong("to", problem())) }
    });
    let constant = |key: &str| values.need(key, values.constant(key)).map(uncertain);
    Ok(Setup {
        delay_s: constant("delay")?,
        window_s: window_s.transpose()?,
        harmonics: values.need("harmonics", values.count("harmonics"))?,
        ..Setup::new(constant("mass")?, constant("restoring")?)
    })
}

/// Everything that the source declares.
///
/// # Errors
///
/// No `[source.excited_response]`, or one that cannot be read; a budget entry of a quantity that this method does not have.
pub fn setup_of(source: &Source) -> Result<Setup, MethodError> {
    let what = "nothing is declared of the body in waves: write [source.excited_response] with axis = \"heave\", mass, restoring, and the window before reflections";
    let mut out = needed(source, EXCITED_RESPONSE, excited, what)?;
    for entry in &source.uncertainty {
        logs::is_of_all_runs(entry)?;
        let gain = match entry.quantity.as_str() {
            "force" | FORCE => &mut out.force_relative,
            ACCELERATION => &mut out.acceleration_relative,
            "position" | POSITION => &mut out.position_relative,
            other => {
                let what = format!(
                    "quantity = {other:?} is not a quantity of an excited response, which has f_z, acceleration and heave; mass, restoring and delay take their standard uncertainties in \
                     [source.excited_response]"
                );
                return Err(undeclared(&entry.place, what));
            }
        };
        *gain = gain_of(entry, "a zero drops out of the harmonics")?;
    }
    Ok(out)
}

/// The waves that a source plans, each with so many runs held and free.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan(source: &Source) -> Result<Vec<Point>, RecordError> {
    Plan::of(PLAN, asks).points(source, EXCITED_RESPONSE)
}

/// Runs of a wave, and how long each lasts, s.
fn asks(wave: &Point) -> (usize, f64) {
    let lasts_s = ["still", "ramp", "travel", "lasts"].map(|name| wave.condition(name)).iter().sum();
    ((wave.condition("held") + wave.condition("free")) as usize, lasts_s)
}
