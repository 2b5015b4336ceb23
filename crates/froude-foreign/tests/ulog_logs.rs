//! ULog files by the format's own description, read by pyulog and by us.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod python;

use std::path::Path;

use froude_foreign::{Cells, Column, Contents, Part, ulog};
use serde_json::Value;

/// Writes logs with arrays, formats in formats, two instances, padding, dropouts and appended data, and what pyulog reads.
const ORACLE: &str = r#"
import json, struct
from pyulog import ULog

def message(kind, body): return struct.pack("<HB", len(body), ord(kind)) + body
def format(text): return message("F", text.encode())
def add(instance, number, name): return message("A", struct.pack("<BH", instance, number) + name.encode())
def data(number, body): return message("D", struct.pack("<H", number) + body)

HEAD = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1_000_000)
FORMATS = format("att:uint64_t timestamp;float[4] q;int8_t mode;bool is_on;uint8_t[2] _padding0;") \
    + format("esc:int32_t rpm;double volts;") + format("escs:uint64_t timestamp;esc[2] esc;uint16_t n;char[3] name;") \
    + format("bare:float x;") + message("I", b"\x0echar[4] sys_namePX4!")
ADDS = add(0, 0, "att") + add(1, 1, "att") + add(0, 2, "escs") + add(0, 3, "bare") + add(0, 4, "escs")
def att(number, t, i, padding=b""): return data(number, struct.pack("<Q4fbB", t, i, 0.5 * i, -i, 0.25, -i, i % 2) + padding)
def escs(t, i): return data(2, struct.pack("<Qidid", t, 10 * i, i / 4, -10 * i, 12.5) + struct.pack("<H", i) + b"abc")

body = b""
for i in range(20):
    body += att(0, 1_000_500 + 4000 * i, i)
    if i % 3 == 0: body += att(1, 1_000_700 + 4000 * i, 100 - i)
    if i == 7: body += message("O", struct.pack("<H", 24)) + message("S", b"\x2f\x73\x13\x20\x25\x0c\xbb\x12")
    if i % 5 == 0: body += escs(1_000_900 + 4000 * i, i)
whole = HEAD + message("B", bytes(40)) + FORMATS + ADDS + body
# What was appended after a crash: the section before ends within a message.
first = HEAD + message("B", bytes(8) + bytes([1]) + bytes(7) + struct.pack("<QQQ", 0, 0, 0)) + FORMATS + ADDS + body + att(0, 5, 5)[:9]
place = first.index(message("B", b"")[2:3], 16) + 1 + 16
first = first[:place] + struct.pack("<Q", len(first)) + first[place + 8:]
appended = first + att(0, 2_000_000, 42)
for name, contents in [("whole", whole), ("appended", appended), ("cut", whole[:-10])]:
    open(name + ".ulg", "wb").write(contents)
    log = ULog(name + ".ulg")
    found = {f"{d.name}_{d.multi_id}": {k: [float(x) for x in v] for k, v in d.data.items()} for d in log.data_list}
    json.dump({"topics": found, "dropouts": [d.duration for d in log.dropouts]}, open(name + ".json", "w"))
for name, contents in [
    ("padding", HEAD + FORMATS + ADDS + att(0, 1_000_000, 1, b"\0\0")), ("undeclared", HEAD + FORMATS + data(9, bytes(8))),
    ("no_format", HEAD + add(0, 0, "att")), ("short", HEAD + FORMATS + ADDS + data(0, bytes(10))), ("letter", HEAD + b"\1\0\x07x"),
    ("future", HEAD + message("B", bytes(8) + bytes([2]) + bytes(31))), ("flat", HEAD + FORMATS + add(0, 0, "bare") + data(0, bytes(4))),
    ("bomb", HEAD + format("a:b[65535] x;") + format("b:c[65535] x;") + format("c:;") + add(0, 0, "a")),
]:
    open(name + ".ulg", "wb").write(contents)
"#;

fn read(folder: &Path, name: &str) -> Result<Contents, String> {
    ulog::read(&std::fs::read(folder.join(format!("{name}.ulg"))).unwrap()).map_err(|error| error.to_string())
}

fn numbers<'a>(part: &'a Part, name: &str) -> &'a [f64] {
    let column = part.columns.iter().find(|column| column.name == name).unwrap_or_else(|| panic!("{name} is missing"));
    let Column { cells: Cells::Numbers(numbers), .. } = column else { panic!("{name} is text") };
    numbers
}

#[test]
fn topics_are_those_of_pyulog() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), ORACLE);
    // pyulog forgets the topics before it reads what was appended.
    for name in ["whole", "cut"] {
        let contents = read(folder.path(), name).unwrap();
        let text = std::fs::read(folder.path().join(format!("{name}.json"))).unwrap();
        let expected: Value = serde_json::from_slice(&text).unwrap();
        let topics = expected["topics"].as_object().unwrap();
        let mut n_columns = 0;
        for part in &contents.parts {
            for (field, cells) in topics[&part.name].as_object().unwrap() {
                let cells: Vec<f64> = cells.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
                if field == "timestamp" {
                    let seconds: Vec<f64> = cells.iter().map(|us| (us - 1e6) / 1e6).collect();
                    assert_eq!(numbers(part, "time"), seconds, "{name}: {}", part.name);
                } else if !field.starts_with("name") {
                    assert_eq!(numbers(part, field), cells, "{name}: {} {field}", part.name);
                    n_columns += 1;
                }
            }
        }
        assert_eq!(n_columns, 6 + 6 + 5, "{name}");
        let names: Vec<&str> = contents.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["att_0", "att_1", "escs_0"]);
        assert_eq!(contents.parts[0].columns[0].unit, "s");
        let cut = contents.notes.iter().any(|note| note.starts_with("the file ends within the message at byte "));
        assert_eq!(cut, name == "cut");
    }
    let of_whole: Vec<f64> = (0..20).map(f64::from).collect();
    let [whole, appended] = ["whole", "appended"].map(|name| read(folder.path(), name).unwrap());
    assert_eq!(numbers(&whole.parts[0], "q[0]"), of_whole);
    assert_eq!(numbers(&appended.parts[0], "q[0]"), [&of_whole[..], &[42.0]].concat());
    assert_eq!(appended.notes, whole.notes);
    assert_eq!(
        read(folder.path(), "whole").unwrap().notes,
        [
            "1 dropout of the recorder, 24 ms together: 24 ms after 0.029 s",
            "topic escs_0: not read: name (text)",
            "topic bare_0 is not read: it has no field `uint64_t timestamp`",
            "times count from the start of the log, 1.000000 s after the vehicle's",
        ]
    );
}

#[test]
fn what_contradicts_the_format_is_refused_with_its_byte() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), ORACLE);
    let padding = read(folder.path(), "padding").unwrap();
    assert_eq!(numbers(&padding.parts[0], "q[1]"), [0.5]);
    for (name, expected) in [
        ("undeclared", "a message is of topic 9, which nothing declares"),
        ("no_format", "byte 16: the format of att is missing"),
        ("short", "a message of att_0 has 10 bytes, too few for the 28 of its format"),
        ("letter", "byte 16: unknown ULog message type 7: the file is damaged; copy it again"),
        ("future", "byte 16: the log uses ULog features that are not read; convert it with ulog2csv (PyPI pyulog)"),
        (
            "flat",
            "no topic of this ULog file can be read; topic bare_0 is not read: it has no field `uint64_t timestamp`",
        ),
        ("bomb", "b describes messages that are longer than a message can be"),
    ] {
        let message = read(folder.path(), name).unwrap_err();
        assert!(message.ends_with(expected), "{name}: {message}");
    }
    let message = |bytes: &[u8]| ulog::read(bytes).unwrap_err().to_string();
    assert_eq!(message(b"time,x\n1,2\n"), "the file does not begin as ULog does");
    assert_eq!(message(b"ULog\x01\x12\x35\x01"), "the file ends within its first 16 bytes");
    assert!(message(b"ULogEnc\x01").starts_with("the log is encrypted"));
}

/// Bytes changed, one or four at a time, and every length cut: an answer, never a panic.
#[test]
fn damage_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), ORACLE);
    for name in ["whole", "appended"] {
        let whole = std::fs::read(folder.path().join(format!("{name}.ulg"))).unwrap();
        for at in 0..whole.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] ^= change;
                drop(ulog::read(&bytes));
            }
            let mut bytes = whole.clone();
            let end = (at + 4).min(bytes.len());
            bytes[at..end].fill(0xff);
            drop(ulog::read(&bytes));
            drop(ulog::read(&whole[..at]));
        }
    }
}
