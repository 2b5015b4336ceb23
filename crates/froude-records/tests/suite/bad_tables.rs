//! What a user reads when a table cannot be used, word for word.

use std::path::{Path, PathBuf};

use froude_records::csv_table::parse_csv;
use froude_records::sidecar::parse_sidecar;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::read_table;
use froude_records::units::Dimension;

fn csv(text: &str) -> Result<Table, String> {
    parse_csv(Path::new("tank.csv"), text, None).map_err(|e| e.to_string())
}

#[track_caller]
fn refused(text: &str, message: &str) {
    match csv(text) {
        Ok(table) => panic!("accepted with {} rows", table.n_rows),
        Err(found) => assert_eq!(found, message),
    }
}

#[test]
fn a_known_number_without_unit_is_told_its_usual_unit() {
    refused(
        "speed,f_x [N]\n0.1,2\n",
        "tank.csv:1: column `speed` has no unit; write `speed [m/s]`, or map it with a sidecar tank.toml",
    );
    refused(
        "angle,f_x [N]\n0.1,2\n",
        "tank.csv:1: column `angle` has no unit; write `angle [deg]`, or map it with a sidecar tank.toml",
    );
    refused(
        "tare_drag,run\n-1.9,0\n",
        "tank.csv:1: column `tare_drag` has no unit; write `tare_drag [unit]`, or map it with a sidecar tank.toml",
    );
}

#[test]
fn a_length_where_a_speed_belongs_names_both() {
    refused(
        "speed [m],f_x [N]\n0.1,2\n",
        "tank.csv:1: column `speed [m]`: wrong unit: expected a speed (m/s), found a length (m)",
    );
    refused(
        "w_z [m/s]\n0.1\n",
        "tank.csv:1: column `w_z [m/s]`: wrong unit: expected an angular speed (rad/s), found a speed (m/s)",
    );
    refused(
        "zero_before_f_x [N m]\n0.1\n",
        "tank.csv:1: column `zero_before_f_x [N m]`: wrong unit: expected a force (N), found a moment or energy (N m)",
    );
    refused(
        "v_x_dot [m/s]\n0.1\n",
        "tank.csv:1: column `v_x_dot [m/s]`: wrong unit: expected an acceleration (m/s^2), found a speed (m/s)",
    );
    refused("speed [mps]\n0.1\n", "tank.csv:1: column `speed [mps]`: unknown unit `mps`; did you mean `m/s`?");
    refused(
        "configuration [1]\n3\n",
        "tank.csv:1: column `configuration [1]`: configuration is text and has no unit; write `configuration`",
    );
}

#[test]
fn an_unknown_column_is_told_the_nearest_name() {
    let table = csv("speed [m/s],f_x [N]\n0.1,2\n").unwrap();
    let found = table.number("sped", Dimension::SPEED).unwrap_err().to_string();
    assert_eq!(found, "tank.csv: there is no column `sped`; did you mean `speed`?");
    let found = table.number("temperature", Dimension::TEMPERATURE).unwrap_err().to_string();
    assert_eq!(found, "tank.csv: there is no column `temperature`; known: speed, f_x");
    let found = table.number("speed", Dimension::LENGTH).unwrap_err().to_string();
    assert_eq!(found, "tank.csv: column `speed [m/s]`: wrong unit: expected a length (m), found a speed (m/s)");
    let found = table.text("speed").unwrap_err().to_string();
    assert_eq!(found, "tank.csv: column `speed` holds numbers; expected text");
}

#[test]
fn cells_that_are_no_numbers_name_line_and_column() {
    let with = |cell: &str| format!("speed [m/s],f_x [N]\n0.1,2\n0.2,{cell}\n");
    refused(&with(""), "tank.csv:3: column `f_x [N]`: the cell is empty; fill it in or delete the row");
    refused(&with("NaN"), "tank.csv:3: column `f_x [N]`: `NaN` is not a finite number; correct it or delete the row");
    refused(&with("-inf"), "tank.csv:3: column `f_x [N]`: `-inf` is not a finite number; correct it or delete the row");
    refused(
        &with("1e999"),
        "tank.csv:3: column `f_x [N]`: `1e999` is not a finite number; correct it or delete the row",
    );
    refused(&with("n/a"), "tank.csv:3: column `f_x [N]`: `n/a` is not a number");
    refused(
        "configuration,f_x [N]\nH1LT,1\n,2\n",
        "tank.csv:3: column `configuration`: the cell is empty; fill it in or delete the row",
    );
}

#[test]
fn ragged_rows_no_rows_and_no_file_are_distinguished() {
    refused("speed [m/s],f_x [N]\n0.1,2\n0.2\n", "tank.csv:3: the row has 1 cell, the header has 2");
    refused("speed [m/s],f_x [N]\n0.1,2,3\n", "tank.csv:2: the row has 3 cells, the header has 2");
    refused("speed [m/s],f_x [N]\n", "tank.csv: the table has no rows; at least one observation is needed");
    refused("", "tank.csv: the file is empty; its first line names the columns as `name [unit]`");
    refused("\n\n", "tank.csv: the file is empty; its first line names the columns as `name [unit]`");
    let found = read_table(Path::new("no/such/tank.csv"), None).unwrap_err().to_string();
    assert_eq!(found, "cannot read no/such/tank.csv: there is no such file or folder");
    let found = read_table(Path::new("tank.docx"), None).unwrap_err().to_string();
    assert!(found.starts_with("tank.docx: it is a document, which is not read; copy the table"), "{found}");
    let found = read_table(Path::new("tank.xyz"), None).unwrap_err().to_string();
    assert!(found.starts_with("tank.xyz: unknown file type; tables are read from text (.csv, .txt,"), "{found}");
}

#[test]
fn headers_are_held_to_one_form() {
    refused("speed [m/s],speed [km/h]\n1,2\n", "tank.csv:1: column `speed` appears twice; rename or delete one");
    refused("f_x [N],f_x [N]\n1,2\n", "tank.csv:1: column `f_x [N]` appears twice; rename or delete one");
    refused("speed [m/s\n1\n", "tank.csv:1: header `speed [m/s`: the unit must end with `]`; write `name [unit]`");
    refused("[m/s]\n1\n", "tank.csv:1: header `[m/s]`: the name is empty; write `name [unit]`");
    refused("speed []\n1\n", "tank.csv:1: column `speed []`: no unit is given; write for example `m/s`");
}

#[test]
fn nothing_that_is_not_a_row_is_skipped_in_silence() {
    let said = |text: &str| parse_csv(Path::new("tank.csv"), text, None).unwrap().understood;
    assert_eq!(said("# towed on Monday\nspeed [m/s]\n1\n").as_deref(), Some("names in line 2"));
    assert_eq!(
        said("speed [m/s],f_x [N]\n1,2\n # doubtful, leave out\n").as_deref(),
        Some("1 comment line passed over")
    );
    assert_eq!(said("speed [m/s]\n1\n\n2\n").as_deref(), Some("1 blank line passed over"));
    refused("a [1],b [1]\n\"1,2\n", "tank.csv:2: a quote is opened and not closed");
    refused(
        "a [1],b [1]\n\"1\"x,2\n",
        "tank.csv:2: text follows the closing quote of a cell; double the quotes inside a cell",
    );
    refused(
        "speed [m/s]\r1\r",
        "tank.csv:1: a carriage return stands without a line feed; save the file with LF or CRLF line ends",
    );
}

#[test]
fn lines_are_counted_through_quoted_line_breaks() {
    refused("note,f_x [N]\n\"first\nsecond\",1\nplain,x\n", "tank.csv:4: column `f_x [N]`: `x` is not a number");
}

#[test]
fn marks_line_ends_quotes_and_blank_last_lines_do_not_matter() {
    let plain = csv("configuration,speed [m/s]\nH1LT,0.1\nH3LT,0.2\n").unwrap();
    for text in [
        "\u{feff}configuration,speed [m/s]\nH1LT,0.1\nH3LT,0.2\n",
        "configuration,speed [m/s]\r\nH1LT,0.1\r\nH3LT,0.2\r\n",
        "configuration,speed [m/s]\nH1LT,0.1\nH3LT,0.2\n\n\n",
        "\"configuration\",\"speed [m/s]\"\n\"H1LT\",\"0.1\"\n\"H3LT\",0.2",
        " configuration , speed [m/s] \n H1LT , 0.1 \n H3LT , 0.2 ",
    ] {
        assert_eq!(csv(text).unwrap(), plain, "{text:?}");
    }
    assert_eq!(plain.line_of_row, [2, 3]);
}

#[test]
fn links_that_contradict_the_configuration_are_found() {
    refused(
        "configuration,n_links [1]\nH1LT,1\nH3LT,4\n",
        "tank.csv:3: `configuration` H3LT has 3 links, but `n_links` is 4; correct one of them",
    );
    refused("n_links [1]\n2.5\n", "tank.csv:2: `n_links` is 2.5; it counts links: 0, 1, 2, …");
    assert!(csv("configuration,n_links [1]\nMamba,4\nH3LT,3\n").is_ok());
}

#[test]
fn temperatures_are_kelvin_inside_and_their_uncertainties_have_no_offset() {
    let table = csv("temperature [degC],std_temperature [degC]\n15,0.1\n").unwrap();
    assert_eq!(table.number("temperature", Dimension::TEMPERATURE).unwrap(), [288.15]);
    assert_eq!(table.number("std_temperature", Dimension::TEMPERATURE).unwrap(), [0.1]);
}

#[test]
fn free_names_may_measure_anything_or_be_text() {
    let table = csv("test_type,delta [deg],repeat,note\nrudder,35,1,\n").unwrap();
    assert_eq!(table.text("test_type").unwrap(), ["rudder"]);
    assert!((table.number("delta", Dimension::ANGLE).unwrap()[0] - 0.6108652381980153).abs() < 1e-15);
    assert_eq!(table.text("repeat").unwrap(), ["1"]);
    assert_eq!(table.text("note").unwrap(), [""]);
    let counted = csv("repeat [1]\n2\n").unwrap();
    assert_eq!(counted.number("repeat", Dimension::ONE).unwrap(), [2.0]);
}

const SIDECAR: &str = r#"schema = 1
[constants]
L = "4.2667 m"
rho = "1000 kg/m^3"
[columns]
Y_prime = { name = "f_y", scale = "0.5*rho*L^2*speed^2" }
tow_speed = { name = "speed", unit = "m/s" }
tare_drag = { name = "f_x", unit = "N", sign = -1 }
run = { name = "run" }
"#;

fn through(sidecar: &str, table: &str) -> Result<Table, String> {
    let sidecar = parse_sidecar(Path::new("tank.toml"), sidecar).map_err(|e| e.to_string())?;
    parse_csv(Path::new("tank.csv"), table, Some(&sidecar)).map_err(|e| e.to_string())
}

#[test]
fn a_sidecar_gives_names_units_signs_and_scales() {
    let table = through(SIDECAR, "run,tow_speed,tare_drag,Y_prime,left_out\n0,0.5,12.5,0.01,\n").unwrap();
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["f_y", "speed", "f_x", "run"], "in the order of the sidecar");
    assert_eq!(table.number("f_x", Dimension::FORCE).unwrap(), [-12.5]);
    // Y' · ½ρL²U² = 0.01 · 0.5 · 1000 · 4.2667² · 0.25
    let expected = 0.01 * 0.5 * 1000.0 * 4.2667 * 4.2667 * 0.25;
    let found = table.number("f_y", Dimension::FORCE).unwrap()[0];
    assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected, "{found} {expected}");
    assert_eq!(table.text("run").unwrap(), ["0"]);
    assert_eq!(table.sidecar, Some(PathBuf::from("tank.toml")));
}

#[test]
fn sidecars_say_what_is_wrong_with_them() {
    let table = "run,tow_speed,tare_drag,Y_prime\n0,0.5,12.5,0.01\n";
    let cases: [(&str, &str, &str); 12] = [
        (
            "schema = 1",
            "schema = 2",
            "tank.toml:1:10: this is sidecar schema 2; this program reads up to sidecar schema 1: use a newer Froude",
        ),
        ("schema = 1\n", "", "tank.toml:1: `schema` is missing; expected schema = 1"),
        (
            "tow_speed =",
            "tow_sped =",
            "tank.toml:7:12: there is no column `tow_sped`; in tank.csv: did you mean `tow_speed`?",
        ),
        (
            "unit = \"m/s\"",
            "unit = \"m\"",
            "tank.toml:7:13: column `speed [m]`: wrong unit: expected a speed (m/s), found a length (m)",
        ),
        (
            "unit = \"m/s\"",
            "units = \"m/s\"",
            "tank.toml:7:31: unknown key `units` in [columns.tow_speed]; did you mean `unit`?",
        ),
        (
            ", unit = \"m/s\"",
            "",
            "tank.toml:7:13: column `speed` has no unit; write unit = \"…\" beside its name, or scale = \"…\" for a dimensionless column",
        ),
        ("sign = -1", "sign = -2", "tank.toml:8:13: `sign` is -2; it is 1 or -1, and a factor goes into scale"),
        (
            "L^2*speed^2",
            "L^2*speed",
            "tank.toml:6:11: column `f_y [kg/s]`: wrong unit: expected a force (N), found a quantity in kg/s",
        ),
        (
            "speed^2",
            "spee^2",
            "tank.toml:6:11: `scale` \"0.5*rho*L^2*spee^2\": spee is neither one of [constants] nor a column of numbers mapped above this one",
        ),
        (
            "speed^2",
            "speed^",
            "tank.toml:6:11: `scale` \"0.5*rho*L^2*speed^\" cannot be read: an exponent must be a whole number",
        ),
        (
            "\"4.2667 m\"",
            "4.2667",
            "tank.toml:3:5: `L` is 4.2667; expected a quantity with its unit in quotes, such as \"0.4 m/s\"",
        ),
        ("[columns]", "[column]", "tank.toml:5:2: unknown key `column` in the file; did you mean `columns`?"),
    ];
    for (from, to, message) in cases {
        assert!(SIDECAR.contains(from), "{from}");
        let found = through(&SIDECAR.replacen(from, to, 1), table).unwrap_err();
        assert_eq!(found, message);
    }
}

#[test]
fn a_campaign_of_the_same_name_is_no_sidecar() {
    let folder = tempfile::tempdir().unwrap();
    let table = folder.path().join("tank.csv");
    std::fs::write(&table, "speed [m/s]\n1\n").unwrap();
    std::fs::write(folder.path().join("tank.toml"), "schema = 1\nname = \"tank\"\n").unwrap();
    assert!(read_table(&table, None).unwrap().sidecar.is_none());
    std::fs::write(
        folder.path().join("tank.toml"),
        "schema = 1\n[columns]\n\"speed [m/s]\" = { name = \"v_x\", sign = -1 }\n",
    )
    .unwrap();
    let read = read_table(&table, None).unwrap();
    assert!(read.sidecar.is_some());
    assert_eq!(read.number("v_x", Dimension::SPEED).unwrap(), [-1.0]);
    std::fs::write(
        folder.path().join("tank.toml"),
        "schema = 1\n[columns]\n\"speed [m/s]\" = { name = \"speed\", unit = \"km/h\" }\n",
    )
    .unwrap();
    let told = read_table(&table, None).unwrap_err().to_string();
    assert!(told.contains("`unit` is \"km/h\", and the table states m/s"), "{told}");
}

/// What is mounted was passed over without a word where nothing was said of the columns.
#[test]
fn a_sidecar_without_columns_is_not_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let (table, beside) = (folder.path().join("r3.csv"), folder.path().join("r3.toml"));
    std::fs::write(&table, "time [s],position [m]\n0,1\n").unwrap();
    for text in [
        "[mounted]\nconfiguration = \"other\"\n",
        "method = \"sway\"\nrole=\"test\"\n",
        "[conditions]\nspeed = \"1 m/s\"\n",
    ] {
        std::fs::write(&beside, format!("schema = 1\n{text}")).unwrap();
        let found = read_table(&table, None).unwrap_err().to_string();
        assert!(found.contains("r3.toml") && found.contains("write [columns] with lines like"), "{found}");
    }
    // A campaign whose runs have roles, and a recorded run.
    for text in ["name = \"t\"\n[[run]]\nrole = \"test\"\n", "checksum = \"crc32:0\"\n[mounted]\nbody = \"a\"\n"] {
        std::fs::write(&beside, format!("schema = 1\n{text}")).unwrap();
        assert!(read_table(&table, None).unwrap().sidecar.is_none(), "{text}");
    }
}

#[test]
fn written_numbers_are_short() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tank.csv");
    let table = csv("speed [mm/s],angle [deg],f_x [N]\n300,3,1e-9\n").unwrap();
    froude_records::table_file::prepare_table(&table, &path).unwrap().take_place().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text, "speed [mm/s],angle [deg],f_x [N]\n300,3,1e-9\n");
    assert!(matches!(&table.columns[1].data, ColumnData::Number { unit, .. } if unit.text == "deg"));
}
