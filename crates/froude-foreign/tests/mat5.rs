//! MAT files of level 5: of SciPy, and of MATLAB and Octave, which SciPy has as test data.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

mod python;

use froude_foreign::{Cells, Column, Contents, mat5};
use python::python;

fn numbers(column: &Column) -> &[f64] {
    match &column.cells {
        Cells::Numbers(numbers) => numbers,
        Cells::Texts(texts) => panic!("{} has texts: {texts:?}", column.name),
    }
}

/// Names of the columns of each part.
fn shape(contents: &Contents) -> Vec<String> {
    let names = |columns: &[Column]| columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>().join(" ");
    contents.parts.iter().map(|part| format!("{}: {}", part.name, names(&part.columns))).collect()
}

const MANY: &str = r#"
import numpy as np, scipy.io, scipy.sparse
t = np.arange(5) / 4
many = {
    "t": t, "force": np.stack([t, -t, 2 * t], axis=1), "flow": np.stack([t, 3 * t]), "fs": 4.0,
    "i8": np.array([-128, 0, 1, 2, 127], "i1"), "u8": np.array([0, 1, 2, 3, 255], "u1"),
    "i16": np.array([-32768, 0, 1, 2, 32767], "i2"), "u16": np.array([0, 1, 2, 3, 65535], "u2"),
    "i32": np.array([-2**31, 0, 1, 2, 2**31 - 1], "i4"), "u32": np.array([0, 1, 2, 3, 2**32 - 1], "u4"),
    "i64": np.array([-2**53, 0, 1, 2, 2**53], "i8"), "u64": np.array([0, 1, 2, 3, 2**53], "u8"),
    "f32": np.array([0.5, np.inf, -np.inf, np.nan, 1e-3], "f4"), "b": np.array([True, False, True, True, False]),
    "note": np.array(["dry", "wet", "wet", "tare ü", "dry"]), "cells": np.array(["a", "bc", "", "d", "e"], object),
    "run": {"time": t[:3], "load": 2 * t[:3], "tank": {"rho": 998.0}},
    "z": t + 1j, "s": scipy.sparse.csc_matrix([[0.0, 1.0]]), "mixed": np.array([1.0, "a"], object), "cube": np.zeros((2, 3, 4)),
    "none": np.zeros((0, 3)),
}
scipy.io.savemat("plain.mat", many, do_compression=False)
scipy.io.savemat("packed.mat", many, do_compression=True)
"#;

#[test]
fn every_kind_of_variable_that_scipy_writes_is_a_column_or_named() {
    let folder = tempfile::tempdir().unwrap();
    python(folder.path(), MANY);
    let of = |name: &str| mat5::read(&std::fs::read(folder.path().join(name)).unwrap()).unwrap();
    let read = of("plain.mat");
    assert_eq!(of("packed.mat").left_out, read.left_out);
    assert_eq!(shape(&of("packed.mat")), shape(&read));
    assert_eq!(
        shape(&read),
        [
            ": t force_1 force_2 force_3 flow_1 flow_2 i8 u8 i16 u16 i32 u32 i64 u64 f32 b note cells",
            "(1 row): fs",
            "run: time load",
            "run.tank: rho",
        ]
    );
    let column = |name: &str| read.parts[0].columns.iter().find(|column| column.name == name).unwrap();
    for (name, expected) in [
        ("t", [0.0, 0.25, 0.5, 0.75, 1.0]),
        ("force_2", [0.0, -0.25, -0.5, -0.75, -1.0]),
        ("flow_2", [0.0, 0.75, 1.5, 2.25, 3.0]),
        ("i8", [-128.0, 0.0, 1.0, 2.0, 127.0]),
        ("u8", [0.0, 1.0, 2.0, 3.0, 255.0]),
        ("i16", [-32768.0, 0.0, 1.0, 2.0, 32767.0]),
        ("u16", [0.0, 1.0, 2.0, 3.0, 65535.0]),
        ("i32", [-2_147_483_648.0, 0.0, 1.0, 2.0, 2_147_483_647.0]),
        ("u32", [0.0, 1.0, 2.0, 3.0, 4_294_967_295.0]),
        ("i64", [-9_007_199_254_740_992.0, 0.0, 1.0, 2.0, 9_007_199_254_740_992.0]),
        ("u64", [0.0, 1.0, 2.0, 3.0, 9_007_199_254_740_992.0]),
        ("b", [1.0, 0.0, 1.0, 1.0, 0.0]),
    ] {
        assert_eq!(numbers(column(name)), expected, "{name}");
    }
    let single = numbers(column("f32"));
    assert_eq!(single[..3], [0.5, f64::INFINITY, f64::NEG_INFINITY]);
    assert!(single[3].is_nan() && single[4] == f64::from(1e-3_f32));
    let texts = |texts: [&str; 5]| Cells::Texts(texts.map(str::to_owned).into());
    assert_eq!(column("note").cells, texts(["dry", "wet", "wet", "tare ü", "dry"]));
    assert_eq!(column("cells").cells, texts(["a", "bc", "", "d", "e"]));
    let left_out: Vec<String> = read.left_out.iter().map(|out| format!("{} {}", out.name, out.reason)).collect();
    assert_eq!(
        left_out,
        [
            "none is empty",
            "z is complex; save real(z) and imag(z) as variables of their own",
            "s is sparse; save full(s)",
            "mixed is a cell array; save a matrix of it, cell2mat(mixed), or a file of it, writetable(cell2table(mixed), \"mixed.csv\")",
            "cube has 3 dimensions; save its slices, cube(:,:,1) and so on, as variables of their own",
        ]
    );
}

#[test]
fn files_of_matlab_of_many_years_have_the_numbers_that_scipy_reads() {
    let folder = tempfile::tempdir().unwrap();
    // For each variable of real numbers: name, rows, columns, the bits of the numbers column by column and row by row. For the others: no numbers.
    let listed = python(
        folder.path(),
        r#"
import glob, json, os, numpy as np, scipy.io
from scipy.io import matlab
folder = os.path.join(os.path.dirname(matlab.__file__), "tests", "data")
out = []
for path in sorted(glob.glob(folder + "/*.mat")):
    try:
        if scipy.io.matlab.matfile_version(path)[0] != 1: continue
        read = scipy.io.loadmat(path)
    except Exception as error:
        out.append([path, None]); continue
    variables = []
    for name, value in read.items():
        if name.startswith("__"): continue
        is_plain = isinstance(value, np.ndarray) and value.dtype.kind in "fiub" and value.ndim == 2 and value.size > 0
        variables.append([name, *(value.shape if is_plain else (0, 0)), [value.ravel(order).astype("f8").view("u8").tolist() for order in "FC"] if is_plain else None])
    out.append([path, variables])
print(json.dumps(out))
"#,
    );
    let listed: Vec<(String, Option<Vec<(String, usize, usize, Option<[Vec<u64>; 2]>)>>)> =
        serde_json::from_str(&listed).unwrap();
    let (mut n_variables, mut n_named, mut n_rejected) = (0, 0, 0);
    for (path, variables) in listed {
        let read = mat5::read(&std::fs::read(&path).unwrap());
        let Some(variables) = variables else {
            n_rejected += 1;
            continue;
        };
        let (parts, left_out) = match &read {
            Ok(contents) => (&contents.parts[..], contents.left_out.iter().map(|out| out.name.clone()).collect()),
            Err(error) => (&[][..], vec![error.0.clone()]),
        };
        for (name, rows, columns, expected) in variables {
            let Some(expected) = expected else {
                let is_named = left_out.iter().any(|out: &String| out.contains(&name));
                let is_part = parts.iter().any(|part| {
                    part.name.starts_with(&name) || part.columns.iter().any(|column| column.name.starts_with(&name))
                });
                assert!(is_named || is_part, "{path}: {name} in {read:?}");
                n_named += 1;
                continue;
            };
            let find = |wanted: &str| parts.iter().flat_map(|part| &part.columns).find(|column| column.name == wanted);
            let read: Vec<f64> = match find(&name) {
                Some(column) => numbers(column).to_vec(),
                None => (1..=rows.max(columns))
                    .filter_map(|i| find(&format!("{name}_{i}")))
                    .flat_map(|column| numbers(column).to_vec())
                    .collect(),
            };
            let read: Vec<u64> = read.into_iter().map(f64::to_bits).collect();
            // A matrix lies as the vectors beside it in the file.
            assert!(expected.contains(&read), "{path}: {name}");
            n_variables += 1;
        }
    }
    println!(
        "{n_variables} variables read, {n_named} of other kinds read or named, {n_rejected} files rejected by SciPy"
    );
    assert!(n_variables > 20 && n_named > 20);
}

#[test]
fn a_damaged_file_is_named_with_its_byte() {
    let folder = tempfile::tempdir().unwrap();
    python(folder.path(), "import scipy.io; scipy.io.savemat('t.mat', {'t': [1.5, 2.5]})");
    let bytes = std::fs::read(folder.path().join("t.mat")).unwrap();
    let error = mat5::read(&bytes[..bytes.len() - 4]).unwrap_err().0;
    assert_eq!(
        error,
        "the MAT file is damaged at byte 128: an element of 64 bytes is announced, 60 follow; copy it again, or load and save it in MATLAB"
    );
    let error = mat5::read(b"time,force\n").unwrap_err().0;
    assert!(error.starts_with("is not a MAT file of level 5"), "{error}");
    let error = mat5::read(b"# Created by Octave 8.4.0, Mon Nov 30\n# name: t\n").unwrap_err().0;
    assert!(error.contains("save it with save -v7 NAME.mat"), "{error}");
}

#[test]
fn objects_of_matlab_are_named_with_the_command_that_saves_them() {
    // As MATLAB writes `t = datetime(...)`: flags, name, kind of system, class, and a reference into the data of objects.
    let element = |kind: u32, bytes: &[u8]| {
        let mut out = [kind.to_le_bytes(), (bytes.len() as u32).to_le_bytes()].concat();
        out.extend(bytes);
        out.resize(out.len().next_multiple_of(8), 0);
        out
    };
    let flags = [17_u32.to_le_bytes(), [0; 4]].concat();
    for (class, way) in [
        ("datetime", "save t = posixtime(t), seconds since 1970"),
        ("table", "save it as a file, writetable(t, \"t.csv\"), or as t = table2struct(t, \"ToScalar\", true)"),
    ] {
        let body = [element(6, &flags), element(1, b"t"), element(1, b"MCOS"), element(1, class.as_bytes())].concat();
        let mut file = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".to_vec();
        file.resize(124, b' ');
        file.extend([0, 1, b'I', b'M']);
        file.extend(element(14, &body));
        let error = mat5::read(&file).unwrap_err().0;
        assert_eq!(
            error,
            format!("has nothing that is read: \"t\" is a {class} object, which MATLAB alone reads; in MATLAB, {way}")
        );
    }
}
