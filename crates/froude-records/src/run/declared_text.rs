//! What is declared of a run's data as values of TOML, in one line each: as the run's sidecar and the log itself hold them.

use crate::run::channel::Meaning;
use crate::run::declarations::{Declarations, Stated};
use crate::run::declared::Declared;
use crate::run::sensor::Filter;
use crate::toml_text::{key_word, quoted};
use crate::units::{Unit, parse_unit};

/// Sections whose values are written as they are.
const VERBATIM: [&str; 3] = ["channels.", "clocks.", "frames."];
/// Keys whose values are.
const KEYS: [&str; 3] = ["cell", "marks", "segments"];

/// Whether an entry's value is TOML already.
pub(crate) fn is_verbatim(key: &str) -> bool {
    VERBATIM.iter().any(|section| key.starts_with(section)) || KEYS.contains(&key)
}

/// Those without a section of their own, which stand before all sections.
pub(crate) fn at_the_head(declared: &Declarations) -> Vec<(String, String)> {
    let mut out = Vec::new();
    if let Some(cell) = &declared.cell {
        let rows = cell.matrix.iter().map(|row| list(row.iter().map(f64::to_string)));
        let value = format!(
            "{{ columns = {}, loads = {}, units = {}, frame = {}, matrix = {} }}",
            texts(&cell.columns),
            texts(&cell.loads),
            list(cell.units.iter().map(|unit| quoted(&unit.text))),
            quoted(&cell.frame),
            list(rows)
        );
        out.push(("cell".to_owned(), value));
    }
    if !declared.marks.is_empty() {
        let marks = declared.marks.iter().map(|mark| {
            let [why, by, note] = [&mark.why, &mark.by, &mark.note].map(|text| quoted(text));
            format!(
                "{{ from = \"{} s\", to = \"{} s\", why = {why}, by = {by}, note = {note} }}",
                mark.from_s, mark.to_s
            )
        });
        out.push(("marks".to_owned(), list(marks)));
    }
    if !declared.segments.is_empty() {
        let segments = declared.segments.iter().map(|s| {
            let (name, by, note) = (s.kind.name(), quoted(&s.by), quoted(&s.note));
            format!(
                "{{ name = \"{name}\", from = \"{} s\", to = \"{} s\", by = {by}, note = {note} }}",
                s.from_s, s.to_s
            )
        });
        out.push(("segments".to_owned(), list(segments)));
    }
    out
}

/// Clocks and frames, by `clocks.NAME` and `frames.NAME`.
pub(crate) fn in_sections(declared: &Declarations) -> Vec<(String, String)> {
    let clocks = declared.clocks.iter().map(|(name, clock)| {
        let value = format!(
            "{{ offset = \"{} s\", skew = \"{} 1\", origin = \"{} s\", standard = \"{} s\", found = {} }}",
            clock.offset_s,
            clock.skew,
            clock.origin_s,
            clock.standard_s,
            quoted(&clock.found)
        );
        (format!("clocks.{}", key_word(name)), value)
    });
    let frames = declared.frames.iter().map(|(name, frame)| {
        let rows = frame.pose.rotation.iter().map(|row| list(row.iter().map(f64::to_string)));
        let origin = frame.pose.origin_m.iter().map(|x| format!("\"{x} m\""));
        let value =
            format!("{{ parent = {}, rotation = {}, origin = {} }}", quoted(&frame.parent), list(rows), list(origin));
        (format!("frames.{}", key_word(name)), value)
    });
    clocks.chain(frames).collect()
}

/// A channel: its meaning, and what is stated beside it.
pub(crate) fn channel(meaning: &Meaning, stated: Option<&Stated>) -> String {
    let silent = Stated::default();
    let stated = stated.unwrap_or(&silent);
    let mut parts = vec![("quantity", quoted(&meaning.quantity)), ("unit", quoted(&meaning.unit))];
    parts.push(("frame", quoted(stated.frame.as_deref().unwrap_or_else(|| meaning.frame.name()))));
    parts.push(("sign", meaning.sign.to_string()));
    parts.push(("clock", quoted(&meaning.clock)));
    parts.retain(|(key, _)| !stated.undeclared.contains(key));
    let si = parse_unit(&meaning.unit).map_or_else(|_| "1".to_owned(), |unit| Unit::si(unit.dimension).text);
    let sensor = &stated.sensor;
    if let Some([low, high]) = sensor.range {
        parts.push(("range", format!("[\"{low} {si}\", \"{high} {si}\"]")));
    }
    if let Some(step) = sensor.resolution {
        parts.push(("resolution", format!("\"{step} {si}\"")));
    }
    if let Some(Declared { value, standard_uncertainty }) = sensor.delay_s {
        parts.push(("delay", format!("{{ value = \"{value} s\", standard = \"{standard_uncertainty} s\" }}")));
    }
    match sensor.filter {
        Some(Filter::Butterworth { order, corner_hz, is_causal }) => parts.push((
            "filter",
            format!("{{ kind = \"butterworth\", order = {order}, corner = \"{corner_hz} Hz\", causal = {is_causal} }}"),
        )),
        Some(Filter::MovingAverage { length_s, is_causal }) => parts.push((
            "filter",
            format!("{{ kind = \"moving_average\", length = \"{length_s} s\", causal = {is_causal} }}"),
        )),
        None => {}
    }
    let parts: Vec<String> = parts.into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", parts.join(", "))
}

fn texts(texts: &[String]) -> String {
    list(texts.iter().map(|text| quoted(text)))
}

fn list(values: impl Iterator<Item = String>) -> String {
    format!("[{}]", values.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::run::sidecar::{of_record, to_record};
    use crate::run::{parse_run_meta, run_meta_text};

    const SIDECAR: &str = r#"
schema = 2
id = "t1"
method = "steady"
role = "test"
status = "complete"
[channels]
speed = { unit = "m/s", frame = "body", sign = 1, clock = "camera", delay = "2 ms" }
f_x = { unit = "mN", frame = "cell", sign = -1, clock = "board", range = "±5 N", resolution = "1 mN", filter = { kind = "butterworth", order = 4, corner = "20 Hz", causal = true } }
g = { unit = "mV", frame = "sensor", sign = 1, clock = "board", filter = { kind = "moving_average", length = "50 ms", causal = false } }
bare = { unit = "N" }
[clocks.camera]
offset = "12 ms"
skew = "-7.3 ms/s"
standard = "1 ms"
found = "by a \"light\""
[frames.arm]
parent = "body"
rotation = { axis = "z", angle = "30 deg" }
origin = ["0.1 m", "0 m", "-20 mm"]
[frames.cell]
parent = "arm"
rotation = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
origin = ["0 m", "0 m", "0 m"]
[cell]
columns = ["g"]
loads = ["m_z"]
units = ["N cm"]
frame = "cell"
matrix = [[2.5]]
[[marks]]
from = "3.2 s"
to = "3.4 s"
why = "outlier"
by = "J. Froude"
[[segments]]
name = "steady"
from = "6 s"
to = "12 s"
"#;

    /// One form: the sidecar, and the record inside the log, say what was read.
    #[test]
    fn what_is_declared_is_written_as_it_was_read() {
        let path = Path::new("t1.toml");
        let read = parse_run_meta(path, SIDECAR).unwrap();
        assert_eq!((read.declared.frames.len(), read.declared.clocks.len(), read.stated.len()), (2, 1, 4));
        assert_eq!(read.stated["bare"].undeclared, ["sign", "frame", "clock"]);
        let again = parse_run_meta(path, &run_meta_text(&read)).unwrap();
        assert_eq!(again, read);
        assert_eq!(of_record(path, &to_record(&read)).unwrap(), read);
    }
}
