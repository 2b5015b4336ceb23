//! Added mass in WAMIT's, NetCDF's and CSV's form: bit-equal files, read back, and by others' readers.
//!
//! `golden/files/read_back.py` reads the same files with xarray and Capytaine. `FROUDE_BLESS=1` writes them anew.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use froude_added_mass::files::AddedMassFile;
use froude_records::csv_table::read_csv;
use froude_records::units::Dimension;
use netcdf3::FileReader;
use proptest::prelude::*;

/// Elements that differ in every place; no added mass has these, but a transposed one shows.
fn matrix(size: usize, limit: usize) -> Vec<Vec<f64>> {
    let element = |i: usize, j: usize| 1000.0 * (1 + limit) as f64 + (20 * i + j) as f64 + 0.125;
    (0..size).map(|i| (0..size).map(|j| element(i, j)).collect()).collect()
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|&n| n.to_owned()).collect()
}

fn file<'a>(bodies: &'a [String], zero: &'a [Vec<f64>], infinite: &'a [Vec<f64>]) -> AddedMassFile<'a> {
    AddedMassFile {
        density_kg_m3: 1025.0,
        gravity_m_s2: 9.80665,
        length_m: 2.0,
        bodies,
        zero_frequency: Some(zero),
        infinite_frequency: Some(infinite),
    }
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/files").join(name)
}

#[test]
fn files_are_bit_for_bit_those_that_others_have_read() {
    let one = (names(&["hull"]), matrix(6, 0), matrix(6, 1));
    let two = (names(&["head", "link 1"]), matrix(12, 0), matrix(12, 1));
    let folder = tempfile::tempdir().unwrap();
    for ((bodies, zero, infinite), stem) in [(&one, "one_body"), (&two, "two_bodies")] {
        for extension in ["1", "nc", "csv"] {
            let name = format!("{stem}.{extension}");
            let path = folder.path().join(&name);
            file(bodies, zero, infinite).write(&path).unwrap();
            let written = std::fs::read(&path).unwrap();
            if std::env::var_os("FROUDE_BLESS").is_some() {
                std::fs::write(golden(&name), &written).unwrap();
            }
            assert!(written == std::fs::read(golden(&name)).unwrap(), "{name} differs from the one that was read");
        }
    }
}

#[test]
fn netcdf_reads_back_with_a_reader_that_is_not_ours() {
    let mut reader = FileReader::open(golden("two_bodies.nc")).unwrap();
    assert_eq!(
        reader.data_set().get_var("added_mass").unwrap().dim_names(),
        ["omega", "influenced_dof", "radiating_dof"]
    );
    let expected: Vec<f64> = [matrix(12, 0), matrix(12, 1)].concat().concat();
    assert_eq!(reader.read_var_f64("added_mass").unwrap(), expected);
    assert_eq!(reader.read_var_f64("radiation_damping").unwrap(), vec![0.0; 288]);
    assert_eq!(reader.read_var_f64("omega").unwrap(), [0.0, f64::INFINITY]);
    assert_eq!(reader.read_var_f64("period").unwrap(), [f64::INFINITY, 0.0]);
    assert_eq!(reader.read_var_f64("rho").unwrap(), [1025.0]);
    let width = "link 1__Surge".len();
    let text = reader.read_var_u8("radiating_dof").unwrap();
    let dofs: Vec<_> =
        text.chunks(width).map(|c| String::from_utf8_lossy(c).trim_end_matches('\0').to_owned()).collect();
    assert_eq!((dofs.len(), dofs[1].as_str(), dofs[11].as_str()), (12, "head__Sway", "link 1__Yaw"));
    assert_eq!(reader.data_set().get_var_attr_as_string("rho", "units").unwrap(), "kg/m^3");
}

#[test]
fn one_limit_alone_makes_one_frequency() {
    let (bodies, only) = (names(&["hull"]), matrix(6, 1));
    let infinite = AddedMassFile { zero_frequency: None, ..file(&bodies, &[], &only) };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hull.nc");
    infinite.write(&path).unwrap();
    let mut reader = FileReader::open(&path).unwrap();
    assert_eq!(reader.read_var_f64("omega").unwrap(), [f64::INFINITY]);
    assert_eq!(reader.read_var_f64("added_mass").unwrap(), only.concat());
    let path = folder.path().join("hull.1");
    infinite.write(&path).unwrap();
    let [zero, infinite] = wamit_rows(&std::fs::read_to_string(&path).unwrap());
    assert_eq!((zero.len(), infinite.len()), (0, 36));
}

/// Rows of WAMIT's `.1`, `PER I J ABAR`: those of frequency zero, whose PER is −1, and those of frequency infinity.
fn wamit_rows(text: &str) -> [Vec<Vec<f64>>; 2] {
    let row = |line: &str| line.split_whitespace().map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
    let (zero, infinite) = text.lines().map(row).partition(|row| row[0] < 0.0);
    [zero, infinite]
}

/// WAMIT's table of scales: force by translation L³, mixed L⁴, moment by rotation L⁵; PER −1 is frequency zero.
#[test]
fn wamit_rows_are_over_density_and_length() {
    let (bodies, zero, infinite) = (names(&["head", "link 1"]), matrix(12, 0), matrix(12, 1));
    let text = file(&bodies, &zero, &infinite).wamit().unwrap();
    let rows = wamit_rows(&text).concat();
    assert_eq!(rows.len(), 288);
    assert_eq!(text.lines().next().unwrap(), " -1.0000000000000000E+00     1     1   1.2196646341463414E-01");
    for (row, l) in [(0, 8.0), (5, 16.0), (6, 8.0), (12 * 3, 16.0), (12 * 3 + 4, 32.0), (12 * 9 + 10, 32.0)] {
        let (i, j) = (row / 12, row % 12);
        assert_eq!(rows[row][..3], [-1.0, (i + 1) as f64, (j + 1) as f64]);
        assert!((rows[row][3] * 1025.0 * l / zero[i][j] - 1.0).abs() < 1e-15);
        assert_eq!(rows[row + 144][..3], [0.0, (i + 1) as f64, (j + 1) as f64]);
        assert!((rows[row + 144][3] * 1025.0 * l / infinite[i][j] - 1.0).abs() < 1e-15);
    }
}

#[test]
fn csv_is_a_table_with_units_that_our_own_reader_takes() {
    let table = read_csv(&golden("two_bodies.csv"), None).unwrap();
    assert_eq!((table.n_rows, table.columns.len()), (8, 39));
    let text = |name: &str| table.text(name).unwrap().iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(text("frequency")[3..5], ["zero", "infinite"]);
    assert_eq!(text("force_on")[..4], ["head", "head", "link 1", "link 1"]);
    assert_eq!(text("motion_of")[..4], ["head", "link 1", "head", "link 1"]);
    // Force on the second body's sway (row 7) by the first one's yaw (column 5).
    assert_eq!(table.number("A26", Dimension { kg: 1, m: 1, ..Dimension::ONE }).unwrap()[2], matrix(12, 0)[7][5]);
    assert_eq!(table.number("A66", Dimension { kg: 1, m: 2, ..Dimension::ONE }).unwrap()[7], matrix(12, 1)[11][11]);
}

#[test]
fn what_no_format_can_hold_is_refused_and_the_old_file_stays() {
    let (bodies, six) = (names(&["hull"]), matrix(6, 0));
    let good = file(&bodies, &six, &six);
    let told = |f: &AddedMassFile| f.csv().unwrap_err().to_string();
    assert_eq!(
        told(&AddedMassFile { zero_frequency: None, infinite_frequency: None, ..good }),
        "there is neither an added mass at zero nor one at infinite frequency; at least one is needed"
    );
    assert_eq!(
        told(&AddedMassFile { infinite_frequency: Some(&six[..5]), ..good }),
        "added mass at infinite frequency: rows: 5; 6 are needed, 6 a body"
    );
    let mut broken = six.clone();
    broken[2][4] = f64::NAN;
    assert_eq!(
        told(&AddedMassFile { zero_frequency: Some(&broken), ..good }),
        "added mass at zero frequency: element 3, 5 is NaN, not a finite number"
    );
    assert_eq!(
        told(&AddedMassFile { bodies: &names(&["a__b"]), ..good }),
        "the name \"a__b\" of body 1 has more than letters, digits, blanks, `-`, `.` and single `_`"
    );
    assert_eq!(told(&AddedMassFile { length_m: 0.0, ..good }), "reference length is 0; it must be finite and above 0");
    assert_eq!(told(&AddedMassFile { bodies: &[], ..good }), "0 bodies; a file holds 1 to 999");
    let twice = AddedMassFile { bodies: &names(&["a", "a"]), ..good }.netcdf().unwrap_err();
    assert_eq!(twice.to_string(), "the name \"a\" of body 2 appears twice");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hull.csv");
    std::fs::write(&path, "old").unwrap();
    let error = AddedMassFile { zero_frequency: Some(&broken), ..good }.write(&path).unwrap_err().to_string();
    assert!(error.ends_with("is NaN, not a finite number; nothing was changed"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    let error = good.write(&folder.path().join("hull.txt")).unwrap_err().to_string();
    assert!(error.ends_with("the file name must end in .1 (WAMIT), .nc (NetCDF) or .csv; nothing was changed"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// `A/(ρLᵏ)` is rounded once and multiplied back: two or three roundings.
    #[test]
    fn wamit_reads_back_what_it_wrote(
        elements in prop::collection::vec(prop::collection::vec(-1e6..1e6_f64, 12), 12), length_m in 0.01..300.0_f64,
    ) {
        let bodies = names(&["a", "b"]);
        let written = AddedMassFile { length_m, ..file(&bodies, &elements, &elements) };
        let rows = wamit_rows(&written.wamit().unwrap());
        prop_assert_eq!(&rows[0].iter().map(|row| &row[1..]).collect::<Vec<_>>(), &rows[1].iter().map(|row| &row[1..]).collect::<Vec<_>>());
        for (row, expected) in rows[0].iter().zip(elements.concat()) {
            let turning = row[1..3].iter().filter(|index| (**index as usize - 1) % 6 > 2).count();
            let found = row[3] * 1025.0 * length_m.powi(3) * [1.0, length_m, length_m * length_m][turning];
            prop_assert!((found - expected).abs() <= 1e-15 * expected.abs());
        }
    }
}
