//! Tables as laboratories, instruments and spreadsheets write them: read as they stand, or asked about; never read wrongly.

use std::path::Path;

use froude_records::convert::convert;
use froude_records::csv_table::read_csv;
use froude_records::file_words::FileWords;
use froude_records::outcome::Exit;
use froude_records::proposal;
use froude_records::sidecar::parse_sidecar;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::{read_table, read_table_with_blanks};

/// A table of bytes through a sidecar of text.
fn read(bytes: &[u8], sidecar: &str) -> Result<Table, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.csv");
    std::fs::write(&path, bytes).unwrap();
    let sidecar = (!sidecar.is_empty()).then(|| parse_sidecar(Path::new("t.toml"), sidecar).unwrap());
    read_csv(&path, sidecar.as_ref()).map_err(|e| e.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

fn si(table: &Table, name: &str) -> Vec<f64> {
    match &table.column(name).unwrap().data {
        ColumnData::Number { si, .. } => si.clone(),
        ColumnData::Text(_) => panic!("{name} is text"),
    }
}

/// Two columns, speed in m/s and f_x in N, of 0.5, 1.25 and -2, -12.5.
fn is_the_table(table: &Table) -> bool {
    si(table, "speed") == [0.5, 1.25] && si(table, "f_x") == [-2.0, -12.5]
}

#[test]
fn one_table_in_any_encoding_separator_and_mark() {
    let german = "speed [m/s];f_x [N]\r\n0,5;-2\r\n1,25;-12,5\r\n";
    let utf16 = |text: &str, mark: &[u8], big: bool| -> Vec<u8> {
        let unit = |u: u16| if big { u.to_be_bytes() } else { u.to_le_bytes() };
        mark.iter().copied().chain(text.encode_utf16().flat_map(unit)).collect()
    };
    let plain = "speed [m/s],f_x [N]\n0.5,-2\n1.25,-12.5\n";
    let cases: [(Vec<u8>, &str); 17] = [
        (plain.into(), ""),
        (german.into(), "cells separated by semicolons, decimal comma"),
        (format!("\u{feff}{german}").into(), "cells separated by semicolons, decimal comma"),
        (utf16(german, b"\xff\xfe", false), "text in UTF-16LE, cells separated by semicolons, decimal comma"),
        (utf16(german, b"\xfe\xff", true), "text in UTF-16BE, cells separated by semicolons, decimal comma"),
        (utf16(plain, b"", false), "text in UTF-16LE (by its letters)"),
        ("speed [m/s]\tf_x [N]\n0,5\t-2\n1,25\t-12,5\n".into(), "cells separated by tabs, decimal comma"),
        ("speed [m/s]|f_x [N]\n0.5|-2\n1.25|-12.5\n".into(), "cells separated by bars"),
        ("# towed\n# twice\nspeed [m/s],f_x [N]\n0.5,-2\n1.25,-12.5\n".into(), "names in line 3"),
        ("% speed [m/s],f_x [N]\n0.5,-2\n1.25,-12.5\n".into(), ""),
        ("speed [m/s],f_x [N]\n\n0.5,-2\n\n1.25,-12.5\n\n\n".into(), "2 blank lines passed over"),
        ("speed [m/s];f_x [N];;\n0,5;-2;;\n1,25;-12,5;;\n;;;\n".into(), "cells separated by semicolons, decimal comma"),
        (
            "Drift tests\nDate;2026-11-30\n\nspeed;f_x\nm/s;N\n0,5;-2\n1,25;-12,5\n".into(),
            "cells separated by semicolons, decimal comma, 2 lines above the names passed over, names in line 4, units in line 5",
        ),
        ("speed;f_x\n[m/s];[N]\n0.5;-2.0\n1.25;-12.5\n".into(), "cells separated by semicolons, units in line 2"),
        ("speed,f_x\n(m/s),(N)\n0.5,-2\n1.25,-12.5\n".into(), "units in line 2"),
        (
            "  speed     f_x\n  (m/s)     (N)\n  0.50E+00 -0.20D+01\n  1.25E+00 -1.25D+01\n".into(),
            "cells separated by blanks, units in line 2",
        ),
        (
            "\"speed [m/s]\";\"f_x [N]\"\n\"0,5\";\"-2\"\n\"1,25\";\"−12,5\"\n".into(),
            "cells separated by semicolons, decimal comma",
        ),
    ];
    for (bytes, said) in cases {
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let table = read(&bytes, "").unwrap_or_else(|e| panic!("{shown}\n{e}"));
        assert!(is_the_table(&table), "{shown}");
        assert_eq!(table.understood.unwrap_or_default(), said, "{shown}");
    }
}

#[test]
fn letters_of_old_encodings_are_read() {
    let text = "Résistance (gf);Température (°C);speed [m/s]\n-1,5;18,2;1\n-2,5;18,3;2\n";
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let sidecar = "schema = 1\n[columns]\n\"Résistance (gf)\" = { name = \"f_x\", sign = -1 }\n\"Température\" = { name = \"temperature\" }\n\"speed [m/s]\" = { name = \"speed\" }\n";
    let table = read(&latin, sidecar).unwrap();
    assert!((si(&table, "f_x")[0] - 1.5 * 9.80665e-3).abs() < 1e-15);
    assert!((si(&table, "temperature")[1] - 291.45).abs() < 1e-12);
    assert_eq!(
        table.understood.unwrap(),
        "text in windows-1252 (by its letters), cells separated by semicolons, decimal comma"
    );
    let japanese = "schema = 1\n[file]\nencoding = \"shift_jis\"\n[columns]\n\"速度\" = { name = \"speed\" }\n\"抵抗\" = { name = \"f_x\", sign = -1 }\n";
    let bytes = b"\x91\xac\x93x,\x92\xef\x8dR\nm/s,N\n0.5,2\n1.25,12.5\n";
    assert!(is_the_table(&read(bytes, japanese).unwrap()));
}

#[test]
fn what_can_be_read_in_two_ways_is_asked_with_both_lines() {
    let text = "speed [m/s];f_x [N]\n1,234;-2\n2,500;-3\n";
    assert_eq!(
        read(text.as_bytes(), "").unwrap_err(),
        "t.csv:2: `1,234` can be 1.234 or 1234, and nothing else in the file decides; write in t.toml, for 1.234:\n  schema = 1\n  [file]\n  decimal = \",\"\nor for 1234:\n  schema = 1\n  [file]\n  thousands = \",\""
    );
    let first = |line: &str| si(&read(text.as_bytes(), &format!("schema = 1\n[file]\n{line}\n")).unwrap(), "speed")[0];
    assert_eq!((first("decimal = \",\""), first("thousands = \",\"")), (1.234, 1234.0));
    let both = read(b"speed [m/s];f_x [N]\n0,5;-2.5\n1;-3\n", "").unwrap_err();
    assert!(both.contains("`0,5` has a decimal comma and `-2.5` in line 2 a decimal point"), "{both}");
    let late = format!("speed [m/s];f_x [N]\n{}0.5;1\n", "0,5;1\n".repeat(60_000));
    let late = read(late.as_bytes(), "").unwrap_err();
    assert!(late.starts_with("t.csv:60002: column `speed [m/s]`: `0.5` is not a number"), "{late}");
}

#[test]
fn sums_and_numbers_that_were_not_measured_are_named_and_asked() {
    let sums = b"run,speed [m/s],f_x [N]\n1,0.5,-2\n2,1.25,-12.5\nMean,0.9,-7\nStd,0.5,5\n";
    let said = read(sums, "").unwrap_err();
    assert!(
        said.starts_with("t.csv:4: the row begins with `Mean`: where it sums up others it is no observation; write in t.toml:\n  schema = 1\n  [file]\n  leave_out = [\"Mean\"]\nor leave_out = [] if it is an observation\n1 more thing keeps this table from being read:\n  - line 5: the row begins with `Std`"),
        "{said}"
    );
    let table = read(sums, "schema = 1\n[file]\nleave_out = [\"mean\", \"std\"]\n").unwrap();
    assert!(is_the_table(&table));
    assert_eq!(table.understood.unwrap(), "2 rows left out as declared");
    for word in ["Mittelwert", "Average", "Écart-type", "標準偏差", "Max:"] {
        let text = format!("Lauf;speed [m/s]\n1;0,5\n{word};1,5\n");
        assert!(read(text.as_bytes(), "").is_err(), "{word}");
    }
    // Neither is a word below the numbers of runs, unless somebody says so.
    let tare = b"run,speed [m/s],f_x [N]\n1,0.5,-2\n2,1,-8\n3,1.25,-12.5\nTara,0,-0.1\n";
    assert!(read(tare, "").unwrap_err().starts_with("t.csv:5: the row begins with `Tara`"));
    assert_eq!(read(tare, "schema = 1\n[file]\nleave_out = []\n").unwrap().n_rows, 4);
    assert!(read(b"run,f_x [N]\n1,-2\n2,-8\n3,-9\n3b,-9.1\n", "").is_ok());
    for (number, written) in
        [("32767", "32767"), ("-9999", "-9999"), ("-999.25", "-999.25"), ("1e30", "1E+30"), ("9999", "9999.0")]
    {
        let text = format!("speed [m/s],f_x [N]\n0.5,-2\n1,{written}\n1.25,-12.5\n");
        let said = read(text.as_bytes(), "").unwrap_err();
        assert!(said.starts_with("t.csv:3: column `f_x [N]`: ") && said.contains("not_measured = ["), "{said}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, &text).unwrap();
        let sidecar = format!("schema = 1\n[file]\nnot_measured = [\"{number}\"]\n");
        std::fs::write(folder.path().join("t.toml"), sidecar).unwrap();
        let table = read_table_with_blanks(&path, None).unwrap();
        assert_eq!(table.blank, [("f_x".to_owned(), 1)]);
    }
    let marked = read(b"run,speed [m/s],f_x [N]\n1,0.5,-2\n#2,1,-8\n3,1.25,-12.5\n", "").unwrap_err();
    assert!(marked.starts_with("t.csv:3: the line begins as a comment and has the cells of a row"), "{marked}");
    let left = read(
        b"run,speed [m/s],f_x [N]\n1,0.5,-2\n#2,1,-8\n3,1.25,-12.5\n",
        "schema = 1\n[file]\nleave_out = [\"#\"]\n",
    );
    assert!(is_the_table(&left.unwrap()));
    // Such numbers among others of their size were measured.
    for values in ["-998.7,-999.9,-1000.4", "1,10,100,1000,10000,100000,1000000", "9980,9999.99,10010"] {
        let rows: String = values.split(',').map(|value| format!("0.5,{value}\n")).collect();
        assert!(read(format!("speed [m/s],f_x [N]\n{rows}").as_bytes(), "").is_ok(), "{values}");
    }
    let huge = read(b"speed [m/s],f_x [N]\n0.5,-2\n1,3.4028235e38\n", "").unwrap_err();
    assert!(huge.contains("not_measured = [\"3.4028235e38\"]"), "{huge}");
    // A counter that reaches 9999 is one.
    let count: String = (9990..10_010).map(|i| format!("{i},1\n")).collect();
    assert!(read(format!("time [ms],f_x [N]\n{count}").as_bytes(), "").is_ok());
}

#[test]
fn what_may_scale_or_sum_up_others_is_never_taken_for_data() {
    let refused = |text: &str, sidecar: &str| read(text.as_bytes(), sidecar).unwrap_err();
    // Lines among names and units.
    let below = "speed;f_x\nm/s;N\nx1;x1000\n0.5;-2\n1.25;-12.5\n";
    assert!(refused(below, "").starts_with("t.csv:3: `x1; x1000` stands between the units and the numbers"));
    let passed = read(below.as_bytes(), "schema = 1\n[file]\nleave_out = [\"x1\"]\n").unwrap();
    assert!(is_the_table(&passed));
    assert!(read(b"speed;f_x\nm/s;N\nAvg;Smp\n0.5;-2\n1.25;-12.5\n", "").is_ok());
    for above in ["x1;x1000\nspeed [m/s];f_x [N]\n", "speed;f_x\n\u{d7}1;\u{d7}10\u{207b}\u{b3}\nm/s;N\n"] {
        let text = format!("{above}0.5;-2\n1.25;-12.5\n");
        assert!(read(text.as_bytes(), "").is_err(), "{text}");
    }
    let factors = "Faktor;1;1000\nrun;speed [m/s];f_x [N]\n1;0.5;-2\n2;1.25;-12.5\n";
    assert!(refused(factors, "").starts_with("t.csv:1: `Faktor; 1; 1000` stands above the names"));
    assert!(is_the_table(&read(factors.as_bytes(), "schema = 1\n[file]\nleave_out = [\"Faktor\"]\n").unwrap()));
    let names = "x10;x20\n0.5;-2\n1.25;-12.5\n";
    assert!(
        refused(names, "")
            .contains("state which line holds the names, in t.toml:\n  schema = 1\n  [file]\n  names = 1")
    );
    assert!(refused(names, "schema = 1\n[file]\nnames = 1\n").contains("has no unit"));
    let blank = below.replace("x1;x1000", ";x1000");
    assert!(refused(&blank, "").starts_with("t.csv:3: "));
    assert!(is_the_table(&read(blank.as_bytes(), "schema = 1\n[file]\nleave_out = [\"x1000\"]\n").unwrap()));
    let empty = parse_sidecar(Path::new("t.toml"), "schema = 1\n[file]\nleave_out = [\"\"]\n").unwrap_err();
    assert!(empty.to_string().contains("has an empty word; write what the row begins with"), "{empty}");
    // Statistics in a line below the units, above the names, or below a name.
    for text in [
        "speed;f_x\nm/s;N\nAvg;Std\n0.5;-2\n1.25;-12.5\n",
        "mean;;std\nspeed [m/s];f_x [N];f_y [N]\n0.5;-2;1\n1.25;-12.5;2\n",
        "speed [m/s],f_x [N]\n,std\n0.5,-2\n1.25,-12.5\n",
    ] {
        refused(text, "");
    }
    let above = "speed [m/s];f_x [N];f_y [N]\n0.5;-2;1\n1.25;-12.5;2\n";
    let understood = read(format!(";Experiment;CFD\n{above}").as_bytes(), "").unwrap().understood.unwrap();
    assert!(understood.contains("`Experiment; CFD` above the names"), "{understood}");
    // A long name over its symbol is none, whatever word is in it.
    let long = "Mean speed;Total resistance\nU;R_T\nm/s;N\n0.5;2\n1.25;12.5\n";
    assert!(refused(long, "").contains("column `U [m/s]` would not be used; is it speed?"));
    // The unit that the table states holds, whatever brackets it stands in, and a scale multiplies values in it.
    let bridge = "speed (m/s),bridge (mV/V)\n0.4,-0.0162\n";
    let scaled = |unit: &str| {
        format!(
            "schema = 1\n[constants]\nk = \"50 kN\"\n[columns]\n\"speed (m/s)\" = {{ name = \"speed\" }}\n\"bridge (mV/V)\" = {{ name = \"f_x\", scale = \"k\"{unit} }}\n"
        )
    };
    assert!(refused(bridge, &scaled("")).contains("add unit = \"mV/V\""));
    let force = si(&read(bridge.as_bytes(), &scaled(", unit = \"mV/V\"")).unwrap(), "f_x")[0];
    assert!((force + 0.81).abs() < 1e-12, "{force}");
    let mixed = "schema = 1\n[columns]\n\"speed [m/s]\" = { name = \"speed\" }\n\"F (kN)\" = { name = \"f_x\", unit = \"N\" }\n";
    assert!(refused("speed [m/s],F (kN)\n0.4,-1.62\n", mixed).contains("the table states kN"));
    for between in [",", "\t", " "] {
        let text = ["speed:0.5|force:-2\n", "speed:1|force:-8\n"].concat().replace('|', between);
        assert!(refused(&text, "").contains("states a number with its name"), "{text}");
    }
    let titled =
        read(b"Scale factor: 1000\nspeed [m/s];f_x [N]\n0.5;-2\n1.25;-12.5\n", "").unwrap().understood.unwrap();
    assert!(titled.contains("`Scale factor: 1000`, which nothing applies"), "{titled}");
    assert!(refused("speed;f_x\nm/s;N\nm/s;kN\n0.5;-2\n1.25;-3\n", "").contains("hold units"));
    // Rows, also where a sidecar leaves their labels out.
    let mapped = "schema = 1\n[columns]\n\"speed [m/s]\" = { name = \"speed\" }\n\"f_x [N]\" = { name = \"f_x\" }\n";
    for (word, says) in [("Max.", "sums up others"), ("Gain", "nothing applies it"), ("Tare", "a sum, a tare, a scale")]
    {
        let text = format!("Point;speed [m/s];f_x [N]\n1;0.5;-2\n2;0.8;-5\n3;1.25;-12.5\n{word};0.8;-1.6\n");
        assert!(refused(&text, mapped).contains(says), "{word}");
        assert!(
            refused(
                &text.replacen("1;0.5;-2\n", "", 1).replace(
                    "Point;speed [m/s];f_x [N]\n",
                    &format!("Point;speed [m/s];f_x [N]\n{word};1;10\n4;1;-8\n")
                ),
                mapped
            )
            .starts_with("t.csv:2: ")
        );
    }
    // The word that is advised names that row and no other.
    let noted = "speed [m/s];f_x [N];note\n0.5;-2;me\n1.25;-12.5;you\n0.5;-7;Mean\n";
    assert!(refused(noted, "").contains("leave_out = [\"Mean\"]"));
    assert!(is_the_table(&read(noted.as_bytes(), "schema = 1\n[file]\nleave_out = [\"Mean\"]\n").unwrap()));
}

#[test]
fn letters_of_sname_are_read_where_they_measure_what_they_name() {
    let table = read(b"u [m/s],v [m/s],r [rad/s],X [N],Y [N],N [N m]\n1,0.1,0,-10,-6,-2\n", "").unwrap();
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["v_x", "v_y", "w_z", "f_x", "f_y", "m_z"]);
    assert_eq!(table.understood.unwrap(), "u, v, r, X, Y, N by SNAME as v_x, v_y, w_z, f_x, f_y, m_z");
    let table = read(b"v_x [m/s],p [Pa],X [m],f_x [N]\n1,100,5,-10\n", "").unwrap();
    assert_eq!(table.columns[1].name, "p");
    assert_eq!(table.columns[2].name, "X");
    assert_eq!(table.understood, None);
}

#[test]
fn all_obstacles_are_named_at_once() {
    let text = "Lauf;Geschwindigkeit;Widerstand;Winkel\n-;m/s;N;°\n1;0,5;2;0\n2;1,25;12,5;NaN\n3;1,5;-9999;4\nMittelwert;0,9;7;1\n";
    let said = read(text.as_bytes(), "").unwrap_err();
    assert_eq!(
        said.lines().collect::<Vec<_>>(),
        [
            "t.csv:1: column `Geschwindigkeit [m/s]` would not be used; is it speed?",
            "5 more things keep this table from being read (cells separated by semicolons, decimal comma, units in line 2):",
            "  - column `Widerstand [N]`: would not be used; is it f_x?",
            "  - column `Winkel [°]`: would not be used; is it angle?",
            "  - line 6: the row begins with `Mittelwert`; where it sums up others, declare it in leave_out",
            "  - line 5: column `Widerstand [N]`: -9999 is far from all other numbers, and many programs write it where nothing was measured; if so, declare not_measured = [\"-9999\"], or not_measured = [] where it was",
            "  - line 4: `NaN` is not a number; where it means not measured, declare it in not_measured",
            "froude inspect t.csv --write-sidecar writes t.toml, which proposes names, units and signs for you to check and correct",
        ]
    );
}

#[test]
fn a_proposed_sidecar_reads_the_table_that_it_was_made_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drift.csv");
    let text = "Lauf;Geschwindigkeit;Driftwinkel;Résistance;Seitenkraft;Bemerkung\n-;m/s;°;gf;gf;\n1;0,5;-12;204,1;10;gut\n2;1,25;6;NaN;-20;\nMittelwert;0,9;0;1;1;\n";
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    std::fs::write(&path, latin).unwrap();
    assert_eq!(proposal::write_sidecar(&path, None).unwrap(), folder.path().join("drift.toml"));
    let sidecar = std::fs::read_to_string(folder.path().join("drift.toml")).unwrap();
    for line in [
        "not_measured = [\"NaN\"]",
        "leave_out = [\"Mittelwert\"]",
        "Lauf = { name = \"run\" }",
        "Geschwindigkeit = { name = \"speed\", unit = \"m/s\" }",
        "\"Résistance\" = { name = \"f_x\", unit = \"gf\", sign = -1 }  # a resistance is written positive; f_x points forward",
        "Bemerkung = { name = \"Bemerkung\" }",
    ] {
        assert!(sidecar.lines().any(|own| own == line), "{line}\n{sidecar}");
    }
    let table = read_table_with_blanks(&path, None).unwrap();
    assert!((si(&table, "f_x")[0] + 2.0015).abs() < 1e-3);
    assert_eq!((table.n_rows, table.blank.len()), (2, 1));
    let again = proposal::write_sidecar(&path, None).unwrap_err().to_string();
    assert!(again.contains("drift.toml: already exists and names columns"), "{again}");
    // What is stated of the file stays; another sidecar is named.
    let other = folder.path().join("other.toml");
    std::fs::write(&other, "schema = 1\n[file]\nseparator = \";\"  # as I said\n").unwrap();
    assert_eq!(proposal::write_sidecar(&path, Some(&other)).unwrap(), other);
    let kept = std::fs::read_to_string(&other).unwrap();
    assert!(
        kept.starts_with("schema = 1\n[file]\nseparator = \";\"  # as I said\n\n# Suggested for [file] above:"),
        "{kept}"
    );
    assert!(
        kept.contains("\n# leave_out = [\"Mittelwert\"]\n")
            && kept.contains("\n[columns]\n")
            && parse_sidecar(&other, &kept).is_ok(),
        "{kept}"
    );
    // A converted table must not be read through a sidecar that is of another.
    let said = convert(&path, None, &folder.path().join("other.csv")).unwrap().exit;
    assert!(
        matches!(said, Exit::Refused(why) if why.contains("which belongs to another file; choose another output name"))
    );
}

#[test]
fn what_is_no_table_is_named() {
    let said = |bytes: &[u8]| read(bytes, "").unwrap_err();
    assert_eq!(
        said(b"\x89PNG\r\n\x1a\n\x00\x00"),
        "t.csv: the file is a PNG image, not text; name the table itself, saved as CSV"
    );
    assert_eq!(
        said(b"PK\x03\x04\x14\x00"),
        "t.csv: the file is a zip archive or an office document, not text; name the table itself, saved as CSV"
    );
    assert_eq!(
        said(b"1,2\n3,4\n"),
        "t.csv:1: there are numbers where the columns should be named; write a line of headers above them, as `speed [m/s],f_x [N]`"
    );
}

#[test]
fn endings_of_text_are_read_alike() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["csv", "txt", "dat", "tsv", "out", "exp", "TXT"] {
        let path = folder.path().join(format!("t.{ending}"));
        std::fs::write(&path, "speed [m/s]\tf_x [N]\n0,5\t-2\n1,25\t-12,5\n").unwrap();
        assert!(is_the_table(&read_table(&path, None).unwrap()), "{ending}");
    }
}

/// Headers as instruments, towing tanks and students write them, and the line of the sidecar that is proposed for each; one that begins with `#` has to be filled in.
const HEADERS: [(&str, &str); 66] = [
    ("Carriage Speed (m/s)", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Towing speed [m/s]", "{ name = \"speed\", unit = \"m/s\" }"),
    ("U / m/s", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Vm (m/s)", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Geschwindigkeit in m/s", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Schleppgeschwindigkeit [m/s]", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Vitesse du chariot (m/s)", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Velocidad, km/h", "{ name = \"speed\", unit = \"km/h\" }"),
    ("Hastighet (m/s)", "{ name = \"speed\", unit = \"m/s\" }"),
    ("曳航速度 [m/s]", "{ name = \"speed\", unit = \"m/s\" }"),
    ("Drag (N)", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Total Resistance [N]", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("RT (N)", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Widerstand / N", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Gesamtwiderstand [N]", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Résistance totale (N)", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Traînée (mN)", "{ name = \"f_x\", unit = \"mN\", sign = -1 }"),
    ("Arrastre [N]", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Motstand (N)", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("抵抗 [N]", "{ name = \"f_x\", unit = \"N\", sign = -1 }"),
    ("Fx (N)", "{ name = \"f_x\", unit = \"N\" }"),
    ("FX [N]", "{ name = \"f_x\", unit = \"N\" }"),
    ("F_y (N)", "{ name = \"f_y\", unit = \"N\" }"),
    ("Side force (N)", "{ name = \"f_y\", unit = \"N\" }"),
    ("Seitenkraft [N]", "{ name = \"f_y\", unit = \"N\" }"),
    ("Querkraft in N", "{ name = \"f_y\", unit = \"N\" }"),
    ("Effort latéral (N)", "{ name = \"f_y\", unit = \"N\" }"),
    ("Fuerza lateral (N)", "{ name = \"f_y\", unit = \"N\" }"),
    ("Sidekraft [N]", "{ name = \"f_y\", unit = \"N\" }"),
    ("横力 [N]", "{ name = \"f_y\", unit = \"N\" }"),
    ("Fz (N)", "{ name = \"f_z\", unit = \"N\" }"),
    ("Mx (N m)", "{ name = \"m_x\", unit = \"N m\" }"),
    ("Pitch moment (N m)", "{ name = \"m_y\", unit = \"N m\" }"),
    ("Yaw Moment [Nm]", "{ name = \"m_z\", unit = \"Nm\" }"),
    ("Giermoment [Nm]", "{ name = \"m_z\", unit = \"Nm\" }"),
    ("Moment de lacet (N m)", "{ name = \"m_z\", unit = \"N m\" }"),
    ("回頭モーメント [Nm]", "{ name = \"m_z\", unit = \"Nm\" }"),
    ("Beta (deg)", "{ name = \"angle\", unit = \"deg\" }"),
    ("Drift angle (°)", "{ name = \"angle\", unit = \"°\" }"),
    ("Driftwinkel [°]", "{ name = \"angle\", unit = \"°\" }"),
    ("Angle de dérive (°)", "{ name = \"angle\", unit = \"°\" }"),
    ("斜航角 [deg]", "{ name = \"angle\", unit = \"deg\" }"),
    ("Yaw rate (rad/s)", "{ name = \"w_z\", unit = \"rad/s\" }"),
    ("Gierrate [deg/s]", "{ name = \"w_z\", unit = \"deg/s\" }"),
    ("Water temp (degC)", "{ name = \"temperature\", unit = \"degC\" }"),
    ("Wassertemperatur [°C]", "{ name = \"temperature\", unit = \"°C\" }"),
    ("Température (°C)", "{ name = \"temperature\", unit = \"°C\" }"),
    ("水温 [°C]", "{ name = \"temperature\", unit = \"°C\" }"),
    ("Density (kg/m^3)", "{ name = \"density\", unit = \"kg/m^3\" }"),
    ("Dichte [kg/m³]", "{ name = \"density\", unit = \"kg/m³\" }"),
    ("t (s)", "{ name = \"time\", unit = \"s\" }"),
    ("Time [ms]", "{ name = \"time\", unit = \"ms\" }"),
    ("Zeit / s", "{ name = \"time\", unit = \"s\" }"),
    ("Temps (s)", "{ name = \"time\", unit = \"s\" }"),
    ("時間 [s]", "{ name = \"time\", unit = \"s\" }"),
    ("Position (mm)", "{ name = \"position\", unit = \"mm\" }"),
    ("Weg [mm]", "{ name = \"position\", unit = \"mm\" }"),
    ("Spannung [V]", "{ name = \"command\", unit = \"V\" }"),
    ("Motor current (A)", "{ name = \"current\", unit = \"A\" }"),
    ("Thrust (N)", "{ name = \"thrust\", unit = \"N\" }"),
    ("Run No.", "{ name = \"run\" }"),
    ("Lauf", "{ name = \"run\" }"),
    ("Drag", "# { name = \"f_x\", unit = \"\", sign = -1 }"),
    ("Geschwindigkeit", "# { name = \"speed\", unit = \"\" }"),
    ("enc", "# { name = \"enc\", unit = \"\" }"),
    ("Strain (N) raw", "# { name = \"Strain (N) raw\", unit = \"\" }"),
];

#[test]
fn headers_of_six_languages_are_proposed_and_none_is_proposed_wrongly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.txt");
    for (header, expected) in HEADERS {
        // Tabs: some headers hold commas.
        std::fs::write(&path, format!("{header}\tother (m)\n1.5\t2.5\n2.5\t3.5\n")).unwrap();
        let proposed = proposal::sidecar(&path, &FileWords::default()).unwrap();
        let key = proposed.lines().find(|line| line.contains(header)).unwrap_or_else(|| panic!("{header}\n{proposed}"));
        let is_open = key.starts_with('#');
        let value = key.split_once(" = {").map(|(_, value)| value).unwrap();
        let value = format!("{}{{{}", if is_open { "# " } else { "" }, value.split_once('}').unwrap().0) + "}";
        assert_eq!(value, expected, "{header}");
    }
}

#[test]
fn exports_of_openfast_orcaflex_and_wec_sim_are_read() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../froude-foreign/tests/data");
    let proposed = |name: &str| proposal::sidecar(&data.join(name), &FileWords::default()).unwrap();
    let openfast = proposed("openfast.out");
    for line in ["Time = { name = \"time\", unit = \"s\" }", "HydroFxi = { name = \"HydroFxi\", unit = \"kN\" }"] {
        assert!(openfast.lines().any(|own| own == line), "{openfast}");
    }
    let multiple = proposed("orcaflex-multiple.csv");
    assert!(
        multiple.contains("\"Towfish Declination\" = { name = \"Towfish Declination\", unit = \"deg\" }"),
        "{multiple}"
    );
    let history = proposed("orcaflex-history.csv");
    assert!(history.contains("\"Time (s)\" = { name = \"time\", unit = \"s\" }"), "{history}");
    // Nothing in the file says what its numbers are in.
    let body = proposed("wec-sim-body.txt");
    assert!(body.contains("# time = { name = \"time\", unit = \"\" }  # state the unit"), "{body}");
    let table = read_table(&data.join("openfast.out"), None).unwrap();
    assert_eq!(si(&table, "HydroFxi")[1], 7.199);
    assert_eq!(
        table.understood.unwrap(),
        "cells separated by tabs, 3 lines above the names passed over, names in line 7, units in line 8"
    );
}

#[test]
fn a_workbook_is_read_as_the_same_table_of_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drift.xlsx");
    std::fs::write(&path, include_bytes!("../golden/drift.xlsx")).unwrap();
    let said = read_table(&path, None).unwrap_err().to_string();
    assert!(
        said.contains("drift.xlsx, row 1: column `Geschwindigkeit [m/s]` would not be used; is it speed?"),
        "{said}"
    );
    proposal::write_sidecar(&path, None).unwrap();
    let table = read_table(&path, None).unwrap();
    assert_eq!(table.n_rows, 90);
    assert_eq!(table.understood.as_deref(), Some("units in row 2"));
    let drag = si(&table, "f_x");
    assert!(drag.iter().all(|f| *f < 0.0) && (drag[0] + 1.05).abs() < 0.1, "{}", drag[0]);
}

#[test]
fn a_unit_that_a_number_format_shows_agrees_with_the_header() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.xlsx");
    std::fs::write(&path, include_bytes!("../golden/shown.xlsx")).unwrap();
    let table = read_table(&path, None).unwrap();
    assert_eq!((si(&table, "speed"), si(&table, "f_x")), (vec![0.5, 1.25], vec![-2.0, -12.5]));
    let text = "speed [m/s];f_x [N]\n0.5;-2 Mio\n1.25;-12.5 Mio\n";
    assert!(read(text.as_bytes(), "").unwrap_err().contains("if `Mio` does not change the number, take it out"));
    let mapped = "schema = 1\n[columns]\ndrag = { name = \"f_y\", unit = \"N\" }\n";
    std::fs::write(folder.path().join("t.toml"), mapped).unwrap();
    let said = read_table(&path, None).unwrap_err().to_string();
    assert!(said.contains("`-2 kN` is not a number; the unit `kN` belongs in the header"), "{said}");
}

/// What was not measured is so in every format.
#[test]
fn a_converted_table_keeps_what_was_not_measured() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("t.csv"), "speed [m/s],f_x [N],f_y [N]\n0.4,-1.62,0.5\n0.6,,0.6\n1.0,-10.1,\n").unwrap();
    for name in ["a.parquet", "a.csv"] {
        assert!(matches!(convert(&at("t.csv"), None, &at(name)).unwrap().exit, Exit::Done));
        let table = read_table_with_blanks(&at(name), None).unwrap();
        assert_eq!(table.blank, [("f_x".to_owned(), 1), ("f_y".to_owned(), 2)], "{name}");
        assert_eq!(si(&table, "f_x"), [-1.62, 0.0, -10.1], "{name}");
    }
}

/// A current sensor that reads 2.5 V at zero, one behind a converter of ten bits, and one that counts the other way: (x − offset) · unit or scale · sign.
#[test]
fn the_reading_at_zero_is_subtracted_before_scale_and_sign() {
    let head = "schema = 1\n[constants]\ngain = \"2 N/V\"\nlsb = \"0.5 N\"\n[columns]\n";
    let columns = "u = { name = \"f_x\", unit = \"V\", scale = \"gain\", offset = \"2500 mV\" }\n\
                   n = { name = \"f_y\", scale = \"lsb\", offset = 512 }\n\
                   f = { name = \"f_z\", unit = \"N\", sign = -1, offset = \"12 N\" }\n";
    let text = format!("{head}{columns}");
    let table = read(b"u,n,f\n2.5,512,12\n3.5,514,-38\n", &text).unwrap();
    assert_eq!(
        (si(&table, "f_x"), si(&table, "f_y"), si(&table, "f_z")),
        (vec![0.0, 2.0], vec![0.0, 1.0], vec![-0.0, 50.0])
    );
    // The cell still ends at ± 50 N of what it shows.
    let of_run = text.replace("offset = \"12 N\" }", "offset = \"12 N\", range = \"±50 N\" }");
    let of_run = of_run.replace("schema = 1\n", "schema = 1\nmethod = \"steady\"\nrole = \"test\"\n");
    let sidecar = parse_sidecar(Path::new("t.toml"), &of_run).unwrap();
    assert_eq!(sidecar.columns["f"].sensor.range, Some([-62.0, 38.0]));
    for (column, said) in [
        ("t = { name = \"temperature\", unit = \"degC\", offset = \"1 K\" }", "is ambiguous for a column in degC"),
        ("u = { name = \"f_x\", unit = \"N\", offset = \"1 V\" }", "offset"),
        ("u = { name = \"f_x\", unit = \"N\", offset = 1 }", "offset"),
    ] {
        let found = parse_sidecar(Path::new("t.toml"), &format!("{head}{column}\n")).unwrap_err().to_string();
        assert!(found.contains(said), "{column}: {found}");
    }
}
