//! Sections read by their declared keys: defaults, kinds, ranges, and where a message points.

use std::path::Path;

use froude_identify::declare::{IfMissing, Key, Kind, Range, Values};
use froude_records::RecordError;
use froude_records::section::{Section, Source, parse};
use froude_records::units::Dimension;

const KEYS: &[Key] = &[
    Key::new("role", Kind::Word(&["test", "tare"]), IfMissing::Is("test"), "of the runs"),
    Key::new("names", Kind::Texts, IfMissing::Nothing("one"), "of bodies"),
    Key::new("mass", Kind::PerConfiguration(Dimension::MASS), IfMissing::Required("write mass = \"1 kg\""), "dry")
        .within(Range::NotNegative("a mass is not")),
    Key::new("radius", Kind::Constant(Dimension::LENGTH), IfMissing::Is("20 mm"), "of the pivot")
        .within(Range::NotZero("the body swings about a pivot")),
    Key::new("speed", Kind::Axis(Dimension::SPEED), IfMissing::Is("0 m/s"), "of the stream"),
    Key::new("frequency", Kind::Frequency, IfMissing::Is("1 Hz"), "of the motion").within(Range::Positive),
    Key::new("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), IfMissing::Is("100 Hz"), "of samples"),
    Key::new("repeats", Kind::Count(9), IfMissing::Is("1"), "of each run"),
    Key::new(
        "cycles",
        Kind::Table(&[Key::new("skip", Kind::Whole, IfMissing::Is("1"), "left out")]),
        IfMissing::Is("{ skip = 2 }"),
        "that are used",
    ),
];

fn read(text: &str) -> Result<Values, RecordError> {
    let source = Source { path: Path::new("c.toml"), text };
    let document = parse(source).unwrap();
    Values::read(&Section::new(source, "source.swing", document.get_ref(), 0), KEYS)
}

fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn what_is_missing_has_its_default() {
    let values = read("mass = \"2 kg\"").unwrap();
    assert_eq!(values.word("role", &['t', 'a']), Some('t'));
    assert!(values.texts("names").is_empty());
    assert_eq!(values.table("cycles").and_then(|cycles| cycles.count("skip")), Some(2));
    assert_eq!(values.by_configuration("mass").of("any").map(|mass| mass.value), Some(2.0));
    assert_eq!(values.constant("radius").map(|radius| radius.value), Some(0.02));
    assert_eq!((values.numbers("speed"), values.numbers("frequency")), (vec![0.0], vec![std::f64::consts::TAU]));
    assert_eq!((values.number("rate"), values.count("repeats")), (Some(100.0), Some(1)));
}

#[test]
fn every_kind_is_read_in_si() {
    let values = read(
        "role = \"tare\"\nnames = [\"a\", \"b\"]\nmass = { a = \"500 g\", b = { value = \"1 kg\", standard = \"1 %\" } }\n\
         radius = { value = \"1 cm\", standard = \"1 mm\" }\nspeed = { start = \"10 cm/s\", stop = \"30 cm/s\", step = \"10 cm/s\" }\n\
         frequency = [\"1 Hz\", \"2 Hz\"]\nrate = \"2 kHz\"\nrepeats = 3\ncycles = { skip = 0 }\n",
    )
    .unwrap();
    assert_eq!(values.word("role", &['t', 'a']), Some('a'));
    let mass = values.by_configuration("mass");
    assert_eq!((mass.of("a").unwrap().value, mass.of("b").unwrap().standard_uncertainty), (0.5, 0.01));
    assert!(mass.of("c").is_none());
    assert_eq!(values.constant("radius").unwrap().standard_uncertainty, 1e-3);
    assert_eq!(values.numbers("speed"), [0.1, 0.2, 0.3]);
    assert_eq!(values.numbers("frequency"), [1.0, 2.0].map(|hz| hz * std::f64::consts::TAU));
    assert_eq!((values.number("rate"), values.table("cycles").unwrap().count("skip")), (Some(2000.0), Some(0)));
    // Two names at three speeds and two frequencies, three times.
    assert!(values.at_most(36).is_ok());
    let more = values.at_most(35).unwrap_err().to_string();
    assert!(more.contains("(2) × `speed` (3) × `frequency` (2) × `repeats` (3) is 36; at most 35 are made"), "{more}");
}

#[test]
fn what_is_wrong_is_said_where_it_stands() {
    for (text, expected) in [
        ("", "c.toml:1:1: [source.swing] has no `mass`; write mass = \"1 kg\""),
        ("mass = {}", "c.toml:1:1: [source.swing] has no `mass`; write mass = \"1 kg\""),
        ("mas = \"1 kg\"", "c.toml:1:1: unknown key `mas` in [source.swing]; did you mean `mass`?"),
        ("mass = \"-1 kg\"", "c.toml:1:8: `mass` is negative; a mass is not"),
        ("mass = { a = \"1 kg\", b = \"-1 kg\" }", "c.toml:1:26: `mass` is negative; a mass is not"),
        ("mass = \"1 kg\"\nradius = \"0 m\"", "c.toml:2:10: `radius` is zero; the body swings about a pivot"),
        (
            "mass = \"1 kg\"\nfrequency = [\"1 Hz\", \"0 Hz\"]",
            "c.toml:2:22: `frequency` is \"0 Hz\"; it must be larger than zero",
        ),
        ("mass = \"1 kg\"\nfrequency = \"0 Hz\"", "c.toml:2:13: `frequency` is \"0 Hz\"; all must be larger than zero"),
        ("mass = \"1 kg\"\nfrequency = [\"1 Hz\", \"1 rad/s\"]", "c.toml:2:13: `frequency` is partly in Hz"),
        ("mass = \"1 kg\"\nrole = \"tar\"", "c.toml:2:8: `role` is \"tar\"; did you mean `tare`?"),
        ("mass = \"1 kg\"\nrepeats = 10", "c.toml:2:11: `repeats` is 10; it must lie between 1 and 9"),
        ("mass = \"1 kg\"\ncycles = { skp = 1 }", "unknown key `skp` in [source.swing.cycles]; did you mean `skip`?"),
    ] {
        let message = refused(text);
        assert!(message.contains(expected), "{text}: {message}");
    }
    let values = read("mass = \"1 kg\"\nrole = \"tare\"").unwrap();
    assert_eq!(values.wrong("role", "stands alone").to_string(), "c.toml:2:8: `role` stands alone");
    assert!(values.missing("radius", "write it").to_string().contains("[source.swing] has no `radius`; write it"));
}
