//! A gait file: what the joints of a swimmer do.
//!
//! ```toml
//! schema = 1
//! kind = "lateral"                   # eel; envelope: a factor of each joint; table: one period in a file
//! amplitude = "30 deg"
//! frequency = "80 deg/s"             # or cycles: "0.22 Hz"
//! phase = "40 deg"                   # from joint to joint
//! turn = "0 deg"                     # mean angle of every joint
//! ramp = "5 s"                       # of a trajectory that begins straight and at rest; may be left out
//! pitch = { amplitude = "10 deg", ahead = "90 deg", turn = "0 deg" }   # of joints that pitch, in three dimensions; may be left out
//! ```
//!
//! | kind | what it needs beside |
//! | --- | --- |
//! | `lateral`, `eel` | nothing |
//! | `envelope` | `envelope = [1, 0.8, …]`: a factor of the amplitude for each joint, from the head |
//! | `table` | `table = "period.csv"` with `time`, `phi_1`, `phi_2`, …: one period, whose last row is the first one again; no amplitude, frequency, phase or turn |

use std::path::{Path, PathBuf};

use froude_records::read;
use froude_records::section::{Section, Source, found, parse};
use froude_records::section_values::one_of;
use froude_records::units::Dimension;
use froude_records::{Place, RecordError};

/// Largest gait file.
const LIMIT: u64 = 1 << 20;

/// How the angles go along the body.
#[derive(Debug, Clone, PartialEq)]
pub enum GaitForm {
    /// Alike at all joints.
    Lateral,
    /// i/(n+1) at joint i.
    Eel,
    /// A factor for each joint.
    Factors(Vec<f64>),
    /// One period in a table.
    Table {
        /// The file.
        path: PathBuf,
        /// Where the gait names it.
        place: Place,
    },
}

/// A gait.
#[derive(Debug, Clone, PartialEq)]
pub struct GaitFile {
    /// How the angles go along the body.
    pub form: GaitForm,
    /// rad.
    pub amplitude_rad: Option<f64>,
    /// rad/s.
    pub frequency_rad_s: Option<f64>,
    /// From joint to joint, rad.
    pub phase_rad: Option<f64>,
    /// Mean angle, rad.
    pub turn_rad: Option<f64>,
    /// Of joints that pitch.
    pub pitch: Option<PitchFile>,
    /// How long a trajectory takes to reach it from straight joints, s.
    pub ramp_s: Option<f64>,
}

/// The wave of the joints that pitch.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PitchFile {
    /// rad.
    pub amplitude_rad: Option<f64>,
    /// By which it is ahead of that of the others, rad.
    pub ahead_rad: Option<f64>,
    /// Mean angle, rad.
    pub turn_rad: Option<f64>,
}

/// Reads a gait file.
///
/// # Errors
///
/// [`RecordError`] with line and column: not TOML, a key that is missing or unknown, a quantity of another kind.
pub fn read_gait(path: &Path) -> Result<GaitFile, RecordError> {
    parse_gait(path, &read::text(path, LIMIT, "a gait")?)
}

/// The same from text.
///
/// # Errors
///
/// As [`read_gait`].
pub fn parse_gait(path: &Path, text: &str) -> Result<GaitFile, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let s = Section::new(source, "", document.get_ref(), 0);
    s.schema("gait")?;
    s.only(&["schema", "kind", "amplitude", "frequency", "phase", "turn", "envelope", "table", "ramp", "pitch"])?;
    let form = form(source, &s)?;
    let wave = ["amplitude", "frequency", "phase", "turn", "pitch"];
    if matches!(form, GaitForm::Table { .. }) {
        for key in wave {
            if let Some(value) = s.get(key) {
                let problem =
                    format!("is {}, and a table has its own; leave it out, or take another kind", found(value));
                return Err(s.wrong(key, value, problem));
            }
        }
    }
    Ok(GaitFile {
        form,
        amplitude_rad: s.quantity("amplitude", Dimension::ANGLE)?,
        frequency_rad_s: frequency(&s)?,
        phase_rad: s.quantity("phase", Dimension::ANGLE)?,
        turn_rad: s.quantity("turn", Dimension::ANGLE)?,
        pitch: s.section("pitch")?.map(|s| pitch(&s)).transpose()?,
        ramp_s: s.positive("ramp", Dimension::TIME)?,
    })
}

fn pitch(s: &Section<'_>) -> Result<PitchFile, RecordError> {
    s.only(&["amplitude", "ahead", "turn"])?;
    Ok(PitchFile {
        amplitude_rad: s.quantity("amplitude", Dimension::ANGLE)?,
        ahead_rad: s.quantity("ahead", Dimension::ANGLE)?,
        turn_rad: s.quantity("turn", Dimension::ANGLE)?,
    })
}

fn form(source: Source<'_>, s: &Section<'_>) -> Result<GaitForm, RecordError> {
    let kinds = ["lateral", "eel", "envelope", "table"];
    let kind = one_of(s, "kind", &kinds, &[0, 1, 2, 3])?
        .ok_or_else(|| s.missing("kind", "write kind = \"lateral\", \"eel\", \"envelope\" or \"table\""))?;
    for (key, of) in [("envelope", 2), ("table", 3)] {
        match s.get(key) {
            Some(value) if kind != of => {
                return Err(s.wrong(
                    key,
                    value,
                    format!("belongs to kind = {key:?}, and this one is {:?}", kinds[kind]),
                ));
            }
            None if kind == of => {
                let advice = if of == 2 {
                    "write a factor for each joint: envelope = [1, 0.8]"
                } else {
                    "name it: table = \"period.csv\""
                };
                return Err(s.missing(key, advice));
            }
            _ => {}
        }
    }
    match kind {
        0 => Ok(GaitForm::Lateral),
        1 => Ok(GaitForm::Eel),
        2 => factors(s),
        _ => table(source, s),
    }
}

fn factors(s: &Section<'_>) -> Result<GaitForm, RecordError> {
    let Some(value) = s.get("envelope") else { return Ok(GaitForm::Factors(Vec::new())) };
    let Some(list) = value.get_ref().as_array() else {
        return Err(s.wrong("envelope", value, format!("is {}; expected a list of factors: [1, 0.8]", found(value))));
    };
    list.iter().map(|factor| s.as_number("envelope", factor)).collect::<Result<_, _>>().map(GaitForm::Factors)
}

fn table(source: Source<'_>, s: &Section<'_>) -> Result<GaitForm, RecordError> {
    let path = source.relative(s.text("table")?.unwrap_or_default());
    let place = s.get("table").map_or_else(|| s.place(), |value| source.place(value.span().start));
    if path.is_file() {
        Ok(GaitForm::Table { path, place })
    } else {
        Err(RecordError::MissingFile { place, key: "table".to_owned(), path })
    }
}

/// rad/s, from an angular speed or from cycles a second.
fn frequency(s: &Section<'_>) -> Result<Option<f64>, RecordError> {
    let Some(value) = s.get("frequency") else { return Ok(None) };
    let quantity = s.as_quantity("frequency", value)?;
    angular_frequency(&quantity)
        .map(Some)
        .map_err(|problem| s.wrong("frequency", value, format!("{problem}: write \"80 deg/s\" or \"0.22 Hz\"")))
}

/// rad/s of an angular speed, or of cycles a second, above zero.
///
/// # Errors
///
/// What is wrong with it, in words.
pub fn angular_frequency(quantity: &froude_records::units::Quantity) -> Result<f64, String> {
    let text = &quantity.unit.text;
    if quantity.unit.dimension != Dimension::ANGULAR_SPEED {
        return Err(format!("is {}", quantity.unit.dimension.describe()));
    }
    let is_cycles = text.ends_with("Hz");
    // One over a second is either.
    if !is_cycles && !["deg", "°", "rad", "rev", "rpm", "gon"].iter().any(|angle| text.contains(angle)) {
        return Err("does not say whether it counts radians or cycles".to_owned());
    }
    let found = if is_cycles { std::f64::consts::TAU * quantity.value_si } else { quantity.value_si };
    if found > 0.0 && found.is_finite() { Ok(found) } else { Err("is not above zero".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<GaitFile, RecordError> {
        parse_gait(Path::new("gait.toml"), text)
    }

    #[test]
    fn a_gait_is_read() {
        let gait = read("schema = 1\nkind = \"envelope\"\nenvelope = [1, 0.5]\namplitude = \"30 deg\"\nfrequency = \"0.25 Hz\"\nphase = \"40 deg\"\nramp = \"2 s\"\n").unwrap();
        assert_eq!(gait.form, GaitForm::Factors(vec![1.0, 0.5]));
        assert_eq!(gait.frequency_rad_s, Some(std::f64::consts::FRAC_PI_2));
        assert_eq!((gait.ramp_s, gait.turn_rad, gait.pitch), (Some(2.0), None, None));
        let both =
            read("schema = 1\nkind = \"lateral\"\npitch = { amplitude = \"0.2 rad\", turn = \"0.1 rad\" }\n").unwrap();
        let pitch = PitchFile { amplitude_rad: Some(0.2), ahead_rad: None, turn_rad: Some(0.1) };
        assert_eq!(both.pitch, Some(pitch));
    }

    #[test]
    fn what_cannot_be_is_reported_with_its_place() {
        let refused = |text: &str| read(text).unwrap_err().to_string();
        let unknown = refused("schema = 1\nkind = \"laterl\"\n");
        assert!(unknown.starts_with("gait.toml:2:8") && unknown.contains("lateral"), "{unknown}");
        let other = refused("schema = 1\nkind = \"eel\"\nenvelope = [1]\n");
        assert!(other.starts_with("gait.toml:3:12") && other.contains("\"eel\""), "{other}");
        let bare = refused("schema = 1\nkind = \"eel\"\nfrequency = \"2 1/s\"\n");
        assert!(bare.contains("radians or cycles"), "{bare}");
        let missing = refused("schema = 1\nkind = \"table\"\ntable = \"none.csv\"\n");
        assert!(missing.starts_with("gait.toml:3:9") && missing.contains("none.csv"), "{missing}");
        let both = refused("schema = 1\nkind = \"table\"\ntable = \"Cargo.toml\"\nphase = \"1 deg\"\n");
        assert!(both.starts_with("gait.toml:4:9"), "{both}");
        assert!(refused("schema = 1\nkind = \"table\"\n").contains("period.csv"));
    }
}
