//! HDF5 files of h5py, pandas, PyTables and MATLAB.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

mod python;

use froude_foreign::{Cells, Column, Contents, hdf5};
use python::python;

fn numbers(column: &Column) -> &[f64] {
    match &column.cells {
        Cells::Numbers(numbers) => numbers,
        Cells::Texts(texts) => panic!("{} has texts: {texts:?}", column.name),
    }
}

/// Names and units of the columns of each part.
fn shape(contents: &Contents) -> Vec<String> {
    let names = |columns: &[Column]| {
        let named =
            columns.iter().map(|c| if c.unit.is_empty() { c.name.clone() } else { format!("{} [{}]", c.name, c.unit) });
        named.collect::<Vec<_>>().join(" ")
    };
    contents.parts.iter().map(|part| format!("{}: {}", part.name, names(&part.columns))).collect()
}

fn column<'a>(contents: &'a Contents, part: &str, name: &str) -> &'a Column {
    let part = contents.parts.iter().find(|own| own.name == part).unwrap();
    part.columns.iter().find(|column| column.name == name).unwrap()
}

fn left_out(contents: &Contents) -> Vec<String> {
    contents.left_out.iter().map(|out| format!("{} {}", out.name, out.reason)).collect()
}

fn written(script: &str) -> impl Fn(&str) -> Result<Contents, String> {
    let folder = tempfile::tempdir().unwrap();
    python(folder.path(), script);
    move |name| hdf5::read(std::fs::read(folder.path().join(name)).unwrap()).map_err(|e| e.0)
}

#[test]
fn attributes_that_change_what_numbers_mean_are_heeded() {
    let read = written(
        r#"
import h5py, numpy as np
with h5py.File("t.h5", "w") as file:
    for name, key, value, kind in [
        ("two", "unit", "mm", "f8"), ("unsigned", "_Unsigned", "true", "i2"), ("raw", "Gain", 0.5, "i2"), ("fine", "Gain", 0.5, "f8"),
        ("range", "valid_range", np.array([0, 2], "f4"), "f4"), ("low", "valid_min", 1.0, "f8"),
    ]:
        file[name] = np.arange(4).astype(kind)
        file[name].attrs[key] = value
    file["two"].attrs["units"] = "m"
"#,
    );
    let read = read("t.h5").unwrap();
    assert_eq!(shape(&read), [": fine low range"]);
    let of =
        |name: &str| numbers(column(&read, "", name)).iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    assert_eq!([of("fine"), of("low"), of("range")], ["0 1 2 3", "NaN 1 2 3", "0 1 2 NaN"]);
    let out = left_out(&read).join("; ");
    for expected in [
        "two states two units, m and mm",
        "unsigned holds unsigned numbers",
        "raw has whole numbers with the attribute Gain",
    ] {
        assert!(out.contains(expected), "{out}");
    }
}

#[test]
fn datasets_of_h5py_are_columns_with_units_or_are_named() {
    let read = written(
        r#"
import h5py, numpy as np
t = np.arange(6) / 4
with h5py.File("t.h5", "w") as file:
    run = file.create_group("tank/run 1")
    run["time"] = t
    run["time"].attrs["units"] = "s"
    run.create_dataset("force", data=np.stack([t, -t], axis=1), chunks=(4, 1), compression="gzip", shuffle=True, fletcher32=True)
    run["force"].attrs["Unit"] = np.bytes_("N")
    for name, kind in dict(i1="i1", u8="u8", be=">f8", bei=">i2", half="f2", single="f4", flag="?").items():
        run[name] = np.arange(6).astype(kind)
    run["lzf"] = t
    run["i8"] = np.array([-2**53, -1, 0, 1, 2, 2**53])
    run["note"] = ["dry", "wet", "wet", "ü", "", "dry"]
    run["fixed"] = np.array([b"a", b"bc", b"", b"d", b"e", b"f"])
    run["z"] = t + 1j
    run["cube"] = np.zeros((2, 3, 4))
    run["none"] = np.zeros((0,))
    run["packed"] = np.arange(6)
    run["packed"].attrs["scale_factor"] = 0.01
    run["gaps"] = np.array([1.0, -9999.0, 3, 4, 5, 6])
    run["gaps"].attrs["_FillValue"] = -9999.0
    run["reference"] = np.array([run.ref], dtype=h5py.ref_dtype)
    record = np.dtype([("n", ">u2"), ("load", "f4", (2,)), ("name", "S4"), ("ok", "?")])
    file["records"] = np.array([(1, (0.5, 1.5), b"dry", True), (65535, (2.5, 3.5), b"wet", False)], record)
    file["speed"] = 0.75
"#,
    );
    let read = read("t.h5").unwrap();
    assert_eq!(
        shape(&read),
        [
            ": speed",
            "records: n load_1 load_2 name ok",
            "tank.run 1: be bei fixed flag force_1 [N] force_2 [N] gaps half i1 i8 lzf note single time [s] u8",
        ]
    );
    let run = |name: &str| numbers(column(&read, "tank.run 1", name)).to_vec();
    let counted = vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    for name in ["i1", "u8", "be", "bei", "half", "single"] {
        assert_eq!(run(name), counted, "{name}");
    }
    let quarters: Vec<f64> = counted.iter().map(|x| x / 4.0).collect();
    let negative: Vec<f64> = quarters.iter().map(|x| -x).collect();
    assert_eq!(
        [run("time"), run("force_1"), run("force_2"), run("lzf")],
        [quarters.clone(), quarters.clone(), negative, quarters]
    );
    assert_eq!(run("flag"), [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(run("i8"), [-9_007_199_254_740_992.0, -1.0, 0.0, 1.0, 2.0, 9_007_199_254_740_992.0]);
    assert!(run("gaps")[1].is_nan() && run("gaps")[2] == 3.0);
    let texts = |texts: [&str; 6]| Cells::Texts(texts.map(str::to_owned).into());
    assert_eq!(column(&read, "tank.run 1", "note").cells, texts(["dry", "wet", "wet", "ü", "", "dry"]));
    assert_eq!(column(&read, "tank.run 1", "fixed").cells, texts(["a", "bc", "", "d", "e", "f"]));
    assert_eq!(numbers(column(&read, "records", "n")), [1.0, 65535.0]);
    assert_eq!(numbers(column(&read, "records", "load_2")), [1.5, 3.5]);
    assert_eq!(numbers(column(&read, "records", "ok")), [1.0, 0.0]);
    assert_eq!(
        left_out(&read),
        [
            "tank.run 1.none is empty",
            "tank.run 1.cube has 3 dimensions; write its slices as datasets of their own",
            "tank.run 1.packed is packed: its attributes scale_factor and add_offset turn its numbers into values; unpack it, in Python \
             with xarray.open_dataset(\"FILE\")[\"packed\"].to_dataframe().to_csv(\"packed.csv\")",
            "tank.run 1.reference has references to other datasets; write their numbers instead",
            "tank.run 1.z is complex; write its real and its imaginary part as datasets of their own",
        ]
    );
}

#[test]
fn a_file_of_matlab_7_3_reads_as_its_variables() {
    // As MATLAB writes it: 512 bytes of its own first, dimensions reversed, classes as attributes, references into #refs#.
    let read = written(
        r##"
import h5py, numpy as np
with h5py.File("t.mat", "w", userblock_size=512) as file:
    def put(where, name, data, kind, **more):
        where[name] = data
        where[name].attrs["MATLAB_class"] = np.bytes_(kind)
        for key, value in more.items(): where[name].attrs[key] = value
        return where[name]
    def char(where, name, *rows):
        return put(where, name, np.array([[ord(c) for c in row] for row in rows], "u2").T, "char")
    t = np.arange(4.0)
    put(file, "t", t[None, :], "double")                      # 4 × 1 in MATLAB
    put(file, "force", np.stack([t, 10 + t]), "single")       # 4 × 2 in MATLAB
    put(file, "wet", np.array([[1, 0, 1, 1]], "u1"), "logical", MATLAB_int_decode=np.int32(1))
    char(file, "note", "dry", "wet", "wet", "tow")
    put(file, "none", np.array([0, 0], "u8"), "double", MATLAB_empty=np.uint8(1))
    put(file, "z", np.zeros((1, 4), [("real", "f8"), ("imag", "f8")]), "double")
    put(file, "start", np.zeros((1, 6), "u4"), "datetime", MATLAB_object_decode=np.int32(3))
    refs = file.create_group("#refs#")
    cells = [char(refs, f"c{i}", text).ref for i, text in enumerate(["a", "bc", "d", "e"])]
    put(file, "cells", np.array(cells, h5py.ref_dtype)[None, :], "cell")
    mixed = [cells[0], put(refs, "m", t[None, :], "double").ref]
    put(file, "mixed", np.array(mixed, h5py.ref_dtype)[None, :], "cell")
    run = file.create_group("run")
    run.attrs["MATLAB_class"] = np.bytes_("struct")
    put(run, "speed", np.array([[0.5, 1.0]]).T, "double")     # 1 × 2 in MATLAB
    runs = file.create_group("runs")
    runs.attrs["MATLAB_class"] = np.bytes_("struct")
    speeds = [put(refs, f"s{i}", np.array([[float(i)]]), "double").ref for i in range(3)]
    runs["speed"] = np.array(speeds, h5py.ref_dtype)[None, :]
open_file = open("t.mat", "r+b")
open_file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
"##,
    );
    let read = read("t.mat").unwrap();
    assert_eq!(shape(&read), [": cells force_1 force_2 note t wet", "run: speed", "runs: speed"]);
    assert_eq!(numbers(column(&read, "", "force_2")), [10.0, 11.0, 12.0, 13.0]);
    assert_eq!(numbers(column(&read, "", "wet")), [1.0, 0.0, 1.0, 1.0]);
    assert_eq!(column(&read, "", "note").cells, Cells::Texts(["dry", "wet", "wet", "tow"].map(str::to_owned).into()));
    assert_eq!(column(&read, "", "cells").cells, Cells::Texts(["a", "bc", "d", "e"].map(str::to_owned).into()));
    assert_eq!(numbers(column(&read, "runs", "speed")), [0.0, 1.0, 2.0]);
    assert_eq!(
        left_out(&read),
        [
            "mixed is a cell array; save a matrix of it, cell2mat(mixed), or a file of it, writetable(cell2table(mixed), \"mixed.csv\")",
            "none is empty",
            "start is a datetime object, which MATLAB alone reads; in MATLAB, save start = posixtime(start), seconds since 1970",
            "z is complex; write its real and its imaginary part as datasets of their own",
        ]
    );
}

#[test]
fn a_frame_of_pandas_is_read_where_the_file_names_its_columns() {
    let read = written(
        r#"
import pandas as pd, numpy as np
frame = pd.DataFrame({"time": np.arange(3) / 10, "force": [1.5, -2.5, np.nan], "n": [1, 2, 3]})
frame.to_hdf("fixed.h5", key="run")
frame.to_hdf("table.h5", key="run", format="table")
"#,
    );
    let fixed = read("fixed.h5").unwrap();
    assert_eq!(shape(&fixed), ["run: index time force n"]);
    assert_eq!(numbers(column(&fixed, "run", "force"))[..2], [1.5, -2.5]);
    assert_eq!(numbers(column(&fixed, "run", "n")), [1.0, 2.0, 3.0]);
    assert_eq!(
        read("table.h5").unwrap_err(),
        "has nothing that is read: \"run\" is a frame_table of pandas, whose columns Python alone can name; in Python, \
         pandas.read_hdf(\"FILE\", \"run\").to_csv(\"run.csv\")"
    );
}

#[test]
fn files_of_matlab_and_pytables_have_the_numbers_that_h5py_reads() {
    let folder = tempfile::tempdir().unwrap();
    let listed = python(
        folder.path(),
        r#"
import glob, json, os, h5py, numpy as np, tables
from scipy.io import matlab
import tables.tests
files = glob.glob(os.path.dirname(tables.tests.__file__) + "/*.h5") + glob.glob(os.path.dirname(tables.tests.__file__) + "/*.mat")
files += glob.glob(os.path.join(os.path.dirname(matlab.__file__), "tests", "data", "testhdf5*.mat"))
files += glob.glob(os.path.dirname(h5py.__file__) + "/tests/data_files/*.h5")
out = []
for path in sorted(files):
    columns = []
    def visit(name, item):
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or item.ndim not in (1, 2) or name.startswith(chr(35)): return
        try: value = item[...]
        except Exception: return
        if value.size and max(value.shape) == value.size:
            columns.append([name.replace("/", "."), value.astype("f8").ravel().view("u8").tolist()])
    try:
        with h5py.File(path) as file: file.visititems(visit)
    except Exception: continue
    out.append([path, columns])
print(json.dumps(out))
"#,
    );
    let listed: Vec<(String, Vec<(String, Vec<u64>)>)> = serde_json::from_str(&listed).unwrap();
    let (mut n_equal, mut n_named) = (0, 0);
    for (path, columns) in listed {
        let read = hdf5::read(std::fs::read(&path).unwrap());
        for (name, expected) in columns {
            let Ok(contents) = &read else {
                println!("{path}: {name}: {}", read.as_ref().unwrap_err());
                n_named += 1;
                continue;
            };
            let (part, own) = name.rsplit_once('.').unwrap_or(("", &name));
            let parts = contents
                .parts
                .iter()
                .filter(|p| p.name == part || p.name.starts_with(&format!("{part} (")) || part.is_empty());
            let found = parts
                .flat_map(|part| &part.columns)
                .find(|column| column.name == own && column.cells.len() == expected.len());
            match found {
                Some(column) => {
                    let bits: Vec<u64> = numbers(column).iter().map(|x| x.to_bits()).collect();
                    assert!(bits == expected, "{path}: {name}");
                    n_equal += 1;
                }
                None => {
                    let out = contents.left_out.iter().find(|out| out.name == name);
                    println!(
                        "{path}: {name}: {}",
                        out.unwrap_or_else(|| panic!("{path}: {name} in {:?}", shape(contents))).reason
                    );
                    n_named += 1;
                }
            }
        }
    }
    println!("{n_equal} datasets equal to h5py, {n_named} named");
    assert!(n_equal > 20);
}

#[test]
fn a_damaged_file_is_said_to_be_damaged() {
    let error = hdf5::read(b"\x89HDF\r\n\x1a\n and no more".to_vec()).unwrap_err().0;
    assert!(error.starts_with("the HDF5 file is damaged, or was not closed by the program that wrote it: "), "{error}");
}
