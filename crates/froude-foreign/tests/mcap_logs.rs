//! MCAP logs as the Python packages mcap and mcap-ros2-support write them.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod python;

use std::path::Path;

use froude_foreign::{Cells, Contents, ForeignError, Part, mcap};

fn read(path: &Path) -> Result<Contents, ForeignError> {
    of_bytes(&std::fs::read(path).unwrap())
}

fn of_bytes(bytes: &[u8]) -> Result<Contents, ForeignError> {
    mcap::read(&mut &bytes[..], bytes.len() as u64)
}

fn part<'a>(contents: &'a Contents, name: &str) -> &'a Part {
    contents.parts.iter().find(|part| part.name == name).unwrap()
}

fn numbers<'a>(part: &'a Part, name: &str) -> &'a [f64] {
    let column = part.columns.iter().find(|column| column.name == name).unwrap();
    let Cells::Numbers(numbers) = &column.cells else { panic!("{name} is text") };
    numbers
}

fn names(part: &Part) -> Vec<&str> {
    part.columns.iter().map(|column| column.name.as_str()).collect()
}

const JSON: &str = r#"
import json
from mcap.writer import Writer
with open("json.mcap", "wb") as f:
    w = Writer(f)
    w.start()
    s = w.register_schema("Force", "jsonschema", b'{"type": "object"}')
    force = w.register_channel("/force", "json", s)
    speed = w.register_channel("/speed", "json", 0)
    proto = w.register_channel("/proto", "protobuf", w.register_schema("P", "protobuf", b"x"))
    start = 1_700_000_000_000_000_000
    for i in range(10):
        w.add_message(force, start + i * 10_000_000, json.dumps({"f": {"x": i / 8, "y": -i}, "unit": "N", "raw": [i, 2 * i]}).encode(), start + i * 10_000_000)
        if i % 5 == 0:
            w.add_message(speed, start + i * 10_000_000 + 1_000_000, json.dumps({"v": 0.5 + i} if i else {"v": 0.5, "is_on": True}).encode(), start)
    w.add_message(proto, start, b"\x01", start)
    w.finish()
"#;

#[test]
fn topics_of_json_have_their_own_stamps() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), JSON);
    let contents = read(&folder.path().join("json.mcap")).unwrap();
    assert_eq!(contents.parts.len(), 2);
    let force = part(&contents, "/force");
    assert_eq!(names(force), ["time", "f.x", "f.y", "raw_0", "raw_1"]);
    assert_eq!(force.columns[0].unit, "s");
    let times: Vec<f64> = (0..10).map(|i| f64::from(i) / 100.0).collect();
    assert_eq!(numbers(force, "time"), times);
    assert_eq!(numbers(force, "f.x")[9], 9.0 / 8.0);
    let speed = part(&contents, "/speed");
    assert_eq!(numbers(speed, "time"), [0.001, 0.051]);
    assert_eq!(numbers(speed, "v"), [0.5, 5.5]);
    assert!(numbers(speed, "is_on")[1].is_nan());
    assert_eq!(
        contents.notes,
        [
            "topic /force: not read: unit (text)",
            "topic /force: time is the log time",
            "topic /speed: is_on is missing or not a number in 1 of 2 messages",
            "topic /speed: time is the log time",
            "topic /proto is not read (1 message): messages in protobuf with the schema P (protobuf); write the topic as JSON (Python: \
         mcap-protobuf-support) or as CSV with PlotJuggler",
        ]
    );
}

const ROS2: &str = r#"
import sys
from mcap_ros2.writer import Writer
IMU = """std_msgs/Header header
geometry_msgs/Vector3 gyro
float64[9] covariance
float64[36] long_covariance
float32[] ranges
string note
bool is_valid
===
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
===
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
===
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
with open("ros2.mcap", "wb") as f:
    w = Writer(f)
    imu = w.register_msgdef("sensor_msgs/msg/Imu", IMU)
    plain = w.register_msgdef("lab_msgs/msg/Plain", "int16 a\nuint64 b\nint8[3] c\nfloat32 d")
    sim = w.register_msgdef("lab_msgs/msg/Sim", "std_msgs/Header header\nfloat32 x\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id")
    for i in range(8):
        t = 1_700_000_000_000_000_000 + i * 20_000_000
        stamp = {"sec": 1_700_000_000, "nanosec": i * 20_000_000 + 5_000_000}
        w.write_message("/imu", imu, {"header": {"stamp": stamp, "frame_id": "f" * i}, "gyro": {"x": i / 4, "y": -1.0, "z": 3.5},
            "covariance": [i + k for k in range(9)], "long_covariance": [0.0] * 36, "ranges": [1.0] * i, "note": "ok" * i, "is_valid": i % 2 == 0}, t, t, i)
        if i % 4 == 0:
            w.write_message("/plain", plain, {"a": -i, "b": 2**40 + i, "c": [1, -2, 3], "d": 0.25}, t, t, i)
            w.write_message("/sim", sim, {"header": {"stamp": {"sec": 3, "nanosec": i * 1000}, "frame_id": ""}, "x": i}, t, t, i)
    w.finish()
"#;

#[test]
fn ros2_messages_are_read_by_their_definitions() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), ROS2);
    let contents = read(&folder.path().join("ros2.mcap")).unwrap();
    let imu = part(&contents, "/imu");
    let mut expected = vec!["time", "gyro.x", "gyro.y", "gyro.z"];
    let covariance: Vec<String> = (0..9).map(|i| format!("covariance_{i}")).collect();
    expected.extend(covariance.iter().map(String::as_str));
    expected.push("is_valid");
    assert_eq!(names(imu), expected);
    let times: Vec<f64> = (0..8).map(|i| f64::from(20 * i + 5) / 1e3).collect();
    assert_eq!(numbers(imu, "time"), times);
    assert_eq!(numbers(imu, "gyro.x"), [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75]);
    assert_eq!(numbers(imu, "covariance_8")[7], 15.0);
    assert_eq!(numbers(imu, "is_valid")[..3], [1.0, 0.0, 1.0]);
    let plain = part(&contents, "/plain");
    assert_eq!(names(plain), ["time", "a", "b", "c_0", "c_1", "c_2", "d"]);
    assert_eq!(numbers(plain, "time"), [0.0, 0.08]);
    assert_eq!(numbers(plain, "a"), [0.0, -4.0]);
    assert_eq!(numbers(plain, "b"), [1_099_511_627_776.0, 1_099_511_627_780.0]);
    assert_eq!(numbers(plain, "c_1"), [-2.0, -2.0]);
    assert_eq!(numbers(part(&contents, "/sim"), "time"), [0.0, 4e-6]);
    assert_eq!(
        contents.notes,
        [
            "topic /imu: not read: header.frame_id (text), long_covariance (36 float64 values), ranges (a varying number of float32 \
         values), note (text)",
            "topic /imu: time is header.stamp",
            "topic /plain: time is the log time",
            "topic /sim: not read: header.frame_id (text)",
            "topic /sim: time is header.stamp, from the topic's first on: its clock is not that of the log",
        ]
    );
}

const OTHERS: &str = r#"
from mcap.writer import Writer
def one(name, encoding, schema, data):
    with open(name + ".mcap", "wb") as f:
        w = Writer(f)
        w.start()
        s = w.register_schema("pkg/msg/T", *schema) if schema else 0
        c = w.register_channel("/t", encoding, s)
        if data is not None:
            w.add_message(c, 1, data, 1)
        w.finish()
one("idl", "cdr", ("ros2idl", b"module"), b"")
one("ros1", "ros1", ("ros1msg", b"float64 x"), b"")
one("flat", "flatbuffer", ("flatbuffer", b""), b"")
one("bare", "cdr", None, b"")
one("bad_json", "json", None, b"{")
one("short", "cdr", ("ros2msg", b"float64 x"), b"\x00\x01\x00\x00\x00")
one("none", "json", None, None)
one("text", "json", None, b'{"a": "b"}')
"#;

#[test]
fn what_is_not_read_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), OTHERS);
    let no_topic = "no topic of this MCAP file can be read: ";
    for (name, expected) in [
        (
            "idl",
            "topic /t is not read (1 message): messages in cdr with the schema pkg/msg/T (ros2idl); CDR is read with definitions as \
             ros2msg: record again in ROS 2 Humble or later, or write the topic as CSV with PlotJuggler",
        ),
        (
            "ros1",
            "topic /t is not read (1 message): messages in ros1 with the schema pkg/msg/T (ros1msg); convert the file to ROS 2 with \
             rosbags-convert, or write the topic as CSV with PlotJuggler",
        ),
        (
            "flat",
            "topic /t is not read (1 message): messages in flatbuffer with the schema pkg/msg/T (flatbuffer); expected json, or cdr \
             with ros2msg; write the topic as one of these, or as CSV",
        ),
        (
            "bare",
            "topic /t is not read (1 message): messages in cdr without a schema; CDR is read with definitions as ros2msg: record \
             again in ROS 2 Humble or later, or write the topic as CSV with PlotJuggler",
        ),
        ("none", "topic /t has no messages"),
        ("text", "topic /t: not read: a (text); topic /t has no numbers"),
    ] {
        let message = read(&folder.path().join(format!("{name}.mcap"))).unwrap_err().to_string();
        assert_eq!(message, format!("{no_topic}{expected}"));
    }
    let message = |name: &str| read(&folder.path().join(name)).unwrap_err().to_string();
    assert_eq!(
        message("bad_json.mcap"),
        "topic /t, message 1 (log time 1 ns): it is not JSON: EOF while parsing an object at line 1 column 1"
    );
    assert_eq!(
        message("short.mcap"),
        "topic /t, message 1 (log time 1 ns): it has 1 bytes behind its head, too few for its definition"
    );
    assert_eq!(of_bytes(b"time,x\n1,2\n3,4\n").unwrap_err().to_string(), "the file does not begin as MCAP does");
}

#[test]
fn a_log_that_was_cut_off_gives_what_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let script = JSON.replace("Writer(f)", "Writer(f, chunk_size=200)");
    python::python(folder.path(), &script);
    let whole = std::fs::read(folder.path().join("json.mcap")).unwrap();
    let cut = of_bytes(&whole[..whole.len() / 2]).unwrap();
    let n = numbers(part(&cut, "/force"), "f.y").len();
    assert!((1..10).contains(&n), "{n}");
    assert_eq!(
        cut.notes[0],
        format!(
            "the file ends at byte {} without its end mark: messages that were recorded last may be missing (`mcap recover` writes a \
             whole file of what is there)",
            whole.len() / 2
        )
    );
}

/// Bytes changed, one or four at a time, and every length cut: an answer, never a panic or memory that the file cannot hold.
#[test]
fn damage_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), JSON);
    python::python(folder.path(), ROS2);
    for name in ["json.mcap", "ros2.mcap"] {
        let whole = std::fs::read(folder.path().join(name)).unwrap();
        for at in 0..whole.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] ^= change;
                drop(of_bytes(&bytes));
            }
            let mut bytes = whole.clone();
            let end = (at + 4).min(bytes.len());
            bytes[at..end].fill(0xff);
            drop(of_bytes(&bytes));
            drop(of_bytes(&whole[..at]));
        }
    }
}

/// The crate that reads records subtracts what a chunk does not have.
#[test]
fn a_record_that_is_longer_than_its_chunk_never_panics() {
    let bytes = include_bytes!("../../../fuzz/seeds/foreign_logs/mcap-record-beyond-its-chunk.mcap");
    // Where overflow is not checked, the same bytes have no topic.
    let message = of_bytes(bytes).unwrap_err().to_string();
    assert!(message.contains("damaged") || message.contains("no topic"), "{message}");
}
