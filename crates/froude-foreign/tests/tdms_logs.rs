//! TDMS against npTDMS: its own test files and scenarios, and files that its writer makes.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod python;

use froude_foreign::{Cells, Column, Contents, Part, tdms};
use serde_json::Value;

/// Writes every file of npTDMS' own tests, and beside each what npTDMS reads in it.
const ORACLE: &str = r#"
import json, os, shutil, glob, inspect
import numpy as np
import nptdms
from nptdms import TdmsFile, tdms
from nptdms.test import util, scenarios, test_daqmx, test_scaling
from nptdms.timestamp import TimestampArray

def numbers(data):
    if isinstance(data, TimestampArray):
        seconds = data['seconds'].astype(object); fractions = data['second_fractions'].astype(object)
        return {"stamps": [[int(s), int(f)] for s, f in zip(seconds, fractions)]}
    data = np.asarray(data)
    if data.dtype.kind in "US" or data.dtype == object:
        return {"texts": [str(x) for x in data]}
    if data.dtype.kind == "c":
        return {"complex": len(data)}
    return {"numbers": [float(x) for x in data]}

def expect(name):
    try:
        file = TdmsFile.read(name + ".tdms", raw_timestamps=True)
        found = {c.path: numbers(c[:]) for g in file.groups() for c in g.channels()}
    except Exception as error:
        found = {"error": str(error)}
    json.dump(found, open(name + ".json", "w"))

count = 0
def keep(contents):
    global count
    name = f"case{count:03}"
    count += 1
    open(name + ".tdms", "wb").write(contents)
    expect(name)
    return name

data = os.path.join(os.path.dirname(nptdms.__file__), "test", "data")
for path in sorted(glob.glob(data + "/*.tdms")):
    shutil.copy(path, ".")
    expect(os.path.basename(path)[:-5])

for param in scenarios.get_scenarios():
    file = param.values[0]
    keep(file._get_contents())

original = util.GeneratedFile.load
seen = []
def load(self, *args, **kwargs):
    seen.append(self._get_contents())
    return original(self, *args, **kwargs)
util.GeneratedFile.load = load
for name, function in inspect.getmembers(test_daqmx, inspect.isfunction):
    if name.startswith("test_") and not inspect.signature(function).parameters and "large" not in name:
        try:
            function()
        except Exception:
            pass
for contents in seen:
    keep(contents)
print(count)
"#;

fn channel<'a>(contents: &'a Contents, path: &str) -> Option<&'a Column> {
    let names: Vec<&str> = path.trim_matches(['/', '\'']).split("'/'").collect();
    let [group, channel] = names.as_slice() else { panic!("{path}") };
    let own = format!("{group}/{channel}");
    contents
        .parts
        .iter()
        .filter(|part| part.name == *group || part.name == own)
        .flat_map(|part| &part.columns)
        .find(|column| column.name == *channel)
}

#[test]
fn every_file_of_npt_dms_gives_its_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let count: usize = python::python(folder.path(), ORACLE).trim().parse().unwrap();
    assert!(count > 40, "{count} files");
    let (mut n_channels, mut n_files) = (0, 0);
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "tdms") {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let expected: Value = serde_json::from_slice(&std::fs::read(path.with_extension("json")).unwrap()).unwrap();
        let expected = expected.as_object().unwrap();
        let found = tdms::read(&std::fs::read(&path).unwrap());
        if let Some(error) = expected.get("error") {
            assert!(found.is_err(), "{name}: npTDMS says {error}");
            continue;
        }
        n_files += 1;
        let has_values = expected.values().any(|cells| {
            cells
                .as_object()
                .unwrap()
                .iter()
                .any(|(kind, cells)| kind != "complex" && !cells.as_array().unwrap().is_empty())
        });
        if !has_values {
            assert!(found.is_err(), "{name}");
            continue;
        }
        let found = found.unwrap_or_else(|error| panic!("{name}: {error}"));
        for (path, cells) in expected {
            let cells = cells.as_object().unwrap();
            if let Some(numbers) = cells.get("numbers") {
                let numbers: Vec<f64> = numbers.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
                if numbers.is_empty() {
                    continue;
                }
                let column = channel(&found, path).unwrap_or_else(|| panic!("{name}: {path} is missing"));
                let Cells::Numbers(own) = &column.cells else { panic!("{name}: {path}") };
                assert_eq!(own.len(), numbers.len(), "{name}: {path}");
                for (own, other) in own.iter().zip(&numbers) {
                    // A scale on single precision is single there.
                    assert!((own - other).abs() <= 1e-6 * other.abs().max(1e-6), "{name}: {path}: {own} {other}");
                }
                n_channels += 1;
            } else if let Some(texts) = cells.get("texts") {
                let texts: Vec<&str> = texts.as_array().unwrap().iter().map(|x| x.as_str().unwrap()).collect();
                let own = channel(&found, path).map(|column| column.cells.clone());
                assert_eq!(own, Some(Cells::Texts(texts.iter().map(|t| (*t).to_owned()).collect())), "{name}: {path}");
            } else if let Some(stamps) = cells.get("stamps") {
                let stamps: Vec<(i64, u64)> = stamps
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|x| (x[0].as_i64().unwrap(), x[1].as_u64().unwrap()))
                    .collect();
                let Some(Column { cells: Cells::Numbers(own), unit, .. }) = channel(&found, path) else {
                    panic!("{name}")
                };
                assert_eq!(unit, "s");
                let seconds = |(s, f): (i64, u64)| s as f64 + f as f64 / 2.0_f64.powi(64);
                assert_eq!(own.len(), stamps.len());
                for (cell, stamp) in own.iter().zip(&stamps) {
                    let apart = seconds(*stamp) - seconds(stamps[0]);
                    assert!((cell - (own[0] + apart)).abs() < 1e-6, "{name}: {path}");
                }
            }
        }
    }
    assert!(n_files > 30 && n_channels > 60, "{n_files} files, {n_channels} channels");
}

const WAVEFORMS: &str = r#"
import numpy as np
from datetime import datetime
from nptdms import TdmsWriter, ChannelObject, GroupObject, RootObject
start = np.datetime64("2026-03-31T10:00:00")
def wave(group, name, data, dt, at, **more):
    return ChannelObject(group, name, data, properties={"wf_increment": dt, "wf_start_offset": 0.0, "wf_start_time": at, "wf_samples": len(data), **more})
with TdmsWriter("wave.tdms") as w:
    w.write_segment([RootObject({"author": "lab"}), GroupObject("tank"),
        wave("tank", "force", np.array([1.0, 2.0, 3.0]), 0.01, start, unit_string="N"),
        wave("tank", "o'clock", np.array([4, 5, 6], dtype=np.int16), 0.01, start, NI_UnitDescription="mm")])
    w.write_segment([wave("two rates", "fast", np.arange(4.0), 0.5, start), wave("two rates", "slow", np.arange(2.0), 1.0, start + np.timedelta64(250, "ms"))])
    w.write_segment([ChannelObject("scaled", "both", np.array([1.0, 2.0]), properties={"unit_string": "N", "Unit": "kN"})])
    w.write_segment([ChannelObject("plain", "note", ["a", "bc"]), ChannelObject("plain", "x", np.array([1.5, 2.5], dtype=np.float32)),
        ChannelObject("plain", "counts", np.array([3, 4], dtype=np.int16), properties={"Slope": 0.005, "Offset": 2.0}),
        ChannelObject("scaled", "volts", np.array([0, 100], dtype=np.int16), properties={"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
            "NI_Scale[0]_Linear_Slope": 0.5, "NI_Scale[0]_Linear_Y_Intercept": 1.0, "NI_Scale[0]_Linear_Input_Source": np.uint32(0xFFFFFFFF), "unit_string": "V"}),
        ChannelObject("scaled", "strain", np.array([0, 100], dtype=np.int16), properties={"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Strain"})])
    w.write_segment([wave("tank", "force", np.array([7.0]), 0.01, start, unit_string="N"), wave("tank", "o'clock", np.array([8], dtype=np.int16), 0.01, start, NI_UnitDescription="mm")])
"#;

#[test]
fn waveforms_give_times_and_units_come_from_their_properties() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), WAVEFORMS);
    let contents = tdms::read(&std::fs::read(folder.path().join("wave.tdms")).unwrap()).unwrap();
    let column = |name: &str, unit: &str, numbers: &[f64]| Column {
        name: name.to_owned(),
        unit: unit.to_owned(),
        cells: Cells::Numbers(numbers.to_vec()),
    };
    let part = |name: &str, columns: Vec<Column>| Part { name: name.to_owned(), columns };
    let texts = Column {
        name: "note".to_owned(),
        unit: String::new(),
        cells: Cells::Texts(vec!["a".to_owned(), "bc".to_owned()]),
    };
    assert_eq!(
        contents.parts,
        [
            part(
                "tank",
                vec![
                    column("time", "s", &[0.0, 0.01, 0.02, 0.03]),
                    column("force", "N", &[1.0, 2.0, 3.0, 7.0]),
                    column("o'clock", "mm", &[4.0, 5.0, 6.0, 8.0]),
                ]
            ),
            part(
                "two rates/fast",
                vec![column("time", "s", &[0.0, 0.5, 1.0, 1.5]), column("fast", "", &[0.0, 1.0, 2.0, 3.0])]
            ),
            part("two rates/slow", vec![column("time", "s", &[0.25, 1.25]), column("slow", "", &[0.0, 1.0])]),
            part("plain", vec![texts, column("x", "", &[1.5, 2.5]), column("counts", "", &[3.0, 4.0])]),
            part("scaled", vec![column("volts", "V", &[1.0, 51.0])]),
        ]
    );
    assert_eq!(
        contents.notes,
        [
            "channel scaled/both is not read: it states two units, N and kN",
            "channel plain/counts holds whole numbers; its properties Offset = 2, Slope = 0.005 are not applied: if they turn counts into the quantity, declare `scale` and \
             `offset` of this column, the offset being the count at zero (−Offset/Slope)",
            "channel scaled/strain is not read: it has a scale of the kind Strain, which is not read; write scaled values",
            "times count from 1774951200.000000 s after 1970-01-01 00:00 UTC",
        ]
    );
}

/// Each scale adds the one before to itself: followed blindly, a thousand of them never end.
const DOUBLINGS: &str = r#"
import numpy as np
from nptdms import TdmsWriter, ChannelObject
p = {"NI_Number_Of_Scales": 60, "NI_Scale[0]_Scale_Type": "AdvancedAPI"}
for i in range(1, 60):
    p[f"NI_Scale[{i}]_Scale_Type"] = "Add"
    for side in ("Left", "Right"): p[f"NI_Scale[{i}]_Add_{side}_Operand_Input_Source"] = np.uint32(i - 1)
q = {"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "AdvancedAPI", "NI_Scale[0]_AdvancedAPI_Input_Source": np.uint32(0)}
with TdmsWriter("doublings.tdms") as w:
    w.write_segment([ChannelObject("g", "x", np.array([1.0]), properties=p), ChannelObject("g", "y", np.array([1.0]), properties=q)])
"#;

#[test]
fn scales_that_lead_nowhere_end() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), DOUBLINGS);
    let message = tdms::read(&std::fs::read(folder.path().join("doublings.tdms")).unwrap()).unwrap_err().to_string();
    assert_eq!(
        message,
        "no channel of this TDMS file can be read; channel g/x is not read: it has scales that take their values from each other \
         more than 1000 times; channel g/y is not read: it takes its values from scale 0, which is not there or takes them from itself"
    );
}

#[test]
fn what_is_no_tdms_is_refused_in_words() {
    let message = |bytes: &[u8]| tdms::read(bytes).unwrap_err().to_string();
    assert_eq!(message(b"time,x\n1,2\n"), "the file does not begin as TDMS does");
    assert_eq!(message(b"TDSh"), "it is the index of a TDMS file (.tdms_index); name the .tdms file beside it");
    assert_eq!(message(b""), "no channel of this TDMS file can be read");
    assert_eq!(
        message(b"TDSm\0\0"),
        "no channel of this TDMS file can be read; the file ends in the segment that begins at byte 0: what was recorded last is missing"
    );
}

#[test]
fn a_channel_that_is_declared_with_no_values_is_named_and_left_out() {
    let bytes = include_bytes!("../../../fuzz/seeds/foreign_logs/tdms-channel-without-values.tdms");
    let message = match tdms::read(bytes) {
        Ok(contents) => {
            assert!(contents.parts.iter().flat_map(|part| &part.columns).all(|column| match &column.cells {
                Cells::Numbers(numbers) => !numbers.is_empty(),
                Cells::Texts(texts) => !texts.is_empty(),
            }));
            contents.notes.join("; ")
        }
        Err(error) => error.to_string(),
    };
    assert!(message.contains("has no values"), "{message}");
}

/// Bytes changed, one or four at a time, and lengths cut: an answer, never a panic or memory that the file cannot hold.
#[test]
fn damage_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    python::python(folder.path(), ORACLE);
    python::python(folder.path(), WAVEFORMS);
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "tdms") {
            continue;
        }
        let whole = std::fs::read(&path).unwrap();
        for at in (0..whole.len()).step_by(1 + whole.len() / 300) {
            for change in [0x01, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] ^= change;
                drop(tdms::read(&bytes));
            }
            let mut bytes = whole.clone();
            let end = (at + 4).min(bytes.len());
            bytes[at..end].fill(0xff);
            drop(tdms::read(&bytes));
            drop(tdms::read(&whole[..at]));
        }
    }
}
