//! What a user sees when the input is wrong: exit code 2, one message, nothing written.

use std::path::Path;
use std::process::{Command, Output};

use crate::small_disk::SmallDisk;

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

/// Runs `identify` on files written to a fresh folder; asserts exit 2, the exact message and that nothing was made.
fn refuses(files: &[(&str, &str)], input: &str, message: &str) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    let output = froude(folder.path(), &["identify", input]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(said.trim_end(), format!("froude: {message}"), "exact message");
    assert_eq!(output.status.code(), Some(2), "exit code");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before, "nothing is written");
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";

#[test]
fn a_missing_unit_is_named_with_its_column() {
    refuses(
        &[("t.csv", "speed,f_x [N]\n0.1,-0.5\n")],
        "t.csv",
        "t.csv:1: column `speed` has no unit; write `speed [m/s]`, or map it with a sidecar t.toml",
    );
}

#[test]
fn a_length_where_a_speed_belongs_names_both_units() {
    refuses(
        &[("t.csv", "speed [m],f_x [N]\n0.1,-0.5\n")],
        "t.csv",
        "t.csv:1: column `speed [m]`: wrong unit: expected a speed (m/s), found a length (m)",
    );
}

#[test]
fn an_empty_cell_is_named_with_line_and_column() {
    refuses(
        &[("t.csv", "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,\n")],
        "t.csv",
        "t.csv:3: column `f_x [N]`: the cell is empty; fill it in or delete the row",
    );
}

#[test]
fn not_a_number_is_refused() {
    refuses(
        &[("t.csv", "speed [m/s],f_x [N]\n0.1,NaN\n")],
        "t.csv",
        "t.csv:2: column `f_x [N]`: `NaN` is not a finite number; correct it or delete the row",
    );
}

#[test]
fn a_ragged_row_is_named_with_its_line() {
    refuses(
        &[("t.csv", "speed [m/s],f_x [N]\n0.1,-0.5,3\n")],
        "t.csv",
        "t.csv:2: the row has 3 cells, the header has 2",
    );
}

#[test]
fn a_table_without_rows_is_refused() {
    refuses(
        &[("t.csv", "speed [m/s],f_x [N]\n")],
        "t.csv",
        "t.csv: the table has no rows; at least one observation is needed",
    );
}

#[test]
fn a_truncated_parquet_file_is_reported_as_such() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.parquet"), b"PAR1 and then nothing").unwrap();
    let output = froude(folder.path(), &["identify", "t.parquet"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.starts_with("froude: t.parquet: not a whole Parquet file ("), "{said}");
    assert!(said.trim_end().ends_with("it is truncated or damaged: copy or export it again"), "{said}");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn drag_models_without_a_body_name_the_missing_keys() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    let output = froude(folder.path(), &["identify", "t.csv", "--models", "f4"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(
        said.trim_end(),
        "froude: model f4: needs the body's geometry; the campaign lacks body.link (major_semi_axis, minor_semi_axis, \
         half_length), body.head_side_area, body.tail_side_area, fluid.density (or temperature), a table column \
         configuration (HkLT) or n_links [1]"
    );
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn an_unknown_model_on_the_command_line_is_told_the_nearest_or_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    let said = |models: &str| {
        let output = froude(folder.path(), &["identify", "t.csv", "--models", models]);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
    };
    assert_eq!(
        said("f7"),
        "froude: model \"f7\" is not known; built in are f1 to f6, quadratic, linear_quadratic, power_law, power_law_log, strut, \
         oblique, fossen_3dof, fossen_6dof, abkowitz, mmg, torpedo, thruster, propeller; \
         [[identify.model]] adds its own: none here"
    );
    assert_eq!(said("f44"), "froude: model \"f44\" is not known; did you mean `f4`?");
    assert_eq!(said("quadratic,powerlaw"), "froude: model \"powerlaw\" is not known; did you mean `power_law`?");
}

#[test]
fn an_unknown_model_of_a_campaign_is_reported_with_its_place() {
    let table = ("t.csv", TABLE);
    refuses(
        &[("c.toml", &format!("{CAMPAIGN}models = [\"quadratic\", \"F4\"]\n")), table],
        "c.toml",
        "c.toml:7:24: model \"F4\" is not known; did you mean `f4`?",
    );
    refuses(
        &[("c.toml", &format!("{CAMPAIGN}[identify]\nmodels = [\n  \"linear-quadratic\",\n]\n")), table],
        "c.toml",
        "c.toml:9:3: model \"linear-quadratic\" is not known; did you mean `linear_quadratic`?",
    );
}

#[test]
fn a_misspelt_key_that_is_needed_is_reported_as_misspelt_and_not_as_missing() {
    refuses(
        &[("c.toml", &CAMPAIGN.replace("table =", "tabel ="))],
        "c.toml",
        "c.toml:6:1: unknown key `tabel` in [[source]]; did you mean `table`?",
    );
    refuses(
        &[("c.toml", &CAMPAIGN.replace("kind =", "kinds ="))],
        "c.toml",
        "c.toml:5:1: unknown key `kinds` in [[source]]; did you mean `kind`?",
    );
    refuses(
        &[("c.toml", &CAMPAIGN.replace("schema =", "shema ="))],
        "c.toml",
        "c.toml:1:1: unknown key `shema` in the file; did you mean `schema`?",
    );
    let sidecar = "schema = 1\n[column]\nU = { name = \"speed\", unit = \"m/s\" }\n";
    refuses(
        &[("t.csv", "U,f_x [N]\n0.1,-0.5\n"), ("t.toml", sidecar)],
        "t.csv",
        "t.toml:2:2: unknown key `column` in the file; did you mean `columns`?",
    );
    refuses(
        &[("t.csv", "U\n0.1\n"), ("t.toml", "schema = 1\n[columns]\nU = { nane = \"speed\", unit = \"m/s\" }\n")],
        "t.csv",
        "t.toml:3:7: unknown key `nane` in [columns.U]; did you mean `name`?",
    );
}

#[test]
fn a_table_without_load_or_without_motion_says_which_and_what_it_has() {
    refuses(
        &[("t.csv", "speed [m/s],drag [N]\n0.1,-0.5\n0.2,-2.0\n")],
        "t.csv",
        "t.csv: no load to fit: a load is missing: a force f_x, f_y, f_z [N] or a moment m_x, m_y, m_z [N m]; name its \
         column so, or map it with a sidecar; the table has speed [m/s], drag [N]",
    );
    refuses(
        &[("t.csv", "U [m/s],f_x [mN]\n0.1,-500\n0.2,-2000\n")],
        "t.csv",
        "t.csv: no load to fit: the motion is missing for f_x: speed [m/s] (with angle [deg]), or v_x, v_y, v_z [m/s], \
         w_x, w_y, w_z [rad/s]; name its column so, or map it with a sidecar; the table has U [m/s], f_x [mN]",
    );
    refuses(
        &[("t.csv", "speed [m/s],f_y [N]\n0.1,-0.5\n0.2,-2.0\n")],
        "t.csv",
        "t.csv: no load to fit: the motion is along v_x, the load is f_y: a load is fitted to the motion along or about \
         its own axis; the table has speed [m/s], f_y [N]",
    );
}

#[test]
fn a_budget_over_a_column_that_is_not_there_names_those_that_are() {
    let budget = |quantity: &str, standard: &str| {
        format!(
            "{CAMPAIGN}[[source.uncertainty]]\nquantity = \"{quantity}\"\nstandard = \"{standard}\"\nshared = \"campaign\"\n"
        )
    };
    let has = "which t.csv does not have; it has speed, f_x, v_x, v_y, angle";
    refuses(
        &[("c.toml", &budget("force", "0.1 N")), ("t.csv", TABLE)],
        "c.toml",
        &format!("c.toml:8:12: `quantity` is \"force\", {has}; of a force (N) it has f_x"),
    );
    refuses(
        &[("c.toml", &budget("fx", "2 %")), ("t.csv", TABLE)],
        "c.toml",
        &format!("c.toml:8:12: `quantity` is \"fx\", {has}; did you mean `f_x`?"),
    );
    refuses(
        &[("c.toml", &budget("drag", "2 %")), ("t.csv", TABLE)],
        "c.toml",
        &format!("c.toml:8:12: `quantity` is \"drag\", {has}"),
    );
}

#[test]
fn a_unit_is_suggested_of_the_kind_that_belongs_there() {
    let fluid = |line: &str| format!("schema = 1\nname = \"x\"\n[fluid]\n{line}\n");
    let cases = [
        (
            "temperature = 18.9",
            "`temperature` is 18.9; expected a quantity with its unit in quotes, such as \"18.9 degC\"",
        ),
        ("temperature = \"18.9\"", "`temperature` cannot be read: `18.9` has no unit; write for example `18.9 degC`"),
        (
            "temperature = \"18.9 C\"",
            "`temperature` cannot be read: unknown unit `C`; did you mean `degC` (degree Celsius, a temperature)?",
        ),
        ("temperature = \"18.9 degc\"", "`temperature` cannot be read: unknown unit `degc`; did you mean `degC`?"),
        ("temperature = \"18.9 grad\"", "`temperature` cannot be read: unknown unit `grad`; write for example `degC`"),
        (
            "temperature = \"warm\"",
            "`temperature` cannot be read: `warm` does not begin with a number; write a quantity as `0.4 degC`",
        ),
        (
            "temperature = \"18.9 m/s\"",
            "`temperature` is \"18.9 m/s\": expected a temperature (degC or K), found a speed (m/s)",
        ),
        ("density = \"998\"", "`density` cannot be read: `998` has no unit; write for example `998 kg/m^3`"),
        ("salinity = \"35\"", "`salinity` cannot be read: `35` has no unit; write for example `35 g/kg`"),
    ];
    for (line, problem) in cases {
        let column = 1 + line.find(" = ").unwrap() + 3;
        refuses(&[("c.toml", &fluid(line))], "c.toml", &format!("c.toml:4:{column}: {problem}"));
    }
    refuses(
        &[("t.csv", "speed [m/s],temperature [celcius]\n0.1,18.9\n")],
        "t.csv",
        "t.csv:1: column `temperature [celcius]`: unknown unit `celcius`; write for example `degC`",
    );
}

#[test]
fn an_empty_cell_of_a_column_that_a_table_can_do_without_says_how() {
    let table = "speed [m/s],f_x [N],temperature [degC]\n0.1,-0.5,18\n0.2,-2.0,\n";
    refuses(
        &[("t.csv", table)],
        "t.csv",
        "t.csv:3: column `temperature [degC]`: the cell is empty; fill it in, delete the row, or do without the column: \
         name only the other columns in a sidecar t.toml; the campaign can give one temperature for all rows in [fluid]",
    );
    let sidecar = "schema = 1\n[columns]\nU = { name = \"speed\", unit = \"m/s\" }\nF = { name = \"f_x\", unit = \"N\" }\n\
                   s = { name = \"std_f_x\", unit = \"N\" }\n";
    refuses(
        &[("t.csv", "U,F,s\n0.1,-0.5,0.1\n0.2,-2.0,\n"), ("t.toml", sidecar)],
        "t.csv",
        "t.csv:3: column `s`: the cell is empty; fill it in, delete the row, or do without the column: take its line out \
         of t.toml; all rows then have the same weight",
    );
}

const CAMPAIGN: &str = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n";

#[test]
fn a_campaign_that_names_a_missing_file_is_refused_with_its_line() {
    refuses(&[("c.toml", CAMPAIGN)], "c.toml", "c.toml:6:9: `table` names t.csv, which does not exist");
}

#[test]
fn duplicate_coefficient_names_of_different_unit_are_refused() {
    let campaign =
        format!("{CAMPAIGN}[identify]\n[[identify.model]]\nname = \"m\"\nf_x = \"-A*u\"\nf_y = \"-A*v*abs(v)\"\n");
    refuses(
        &[("c.toml", &campaign), ("t.csv", "v_x [m/s],v_y [m/s],f_x [N],f_y [N]\n0.1,0.1,-0.5,-0.1\n")],
        "c.toml",
        "model \"m\": coefficient A would be kg/s in one formula and kg/m in another; give the two terms different names; A is a coefficient here, and a known number where [body] declares reference_area",
    );
}

/// A unit that is none of the coefficient's: of what is known, of its uncertainty, of a prior, of what is fixed.
#[test]
fn a_coefficient_that_is_stated_in_another_unit_is_refused_with_its_place() {
    let law = "[[identify.model]]\nname = \"m\"\nf_x = \"-A*v_x_dot - D*v_x*abs(v_x)\"\n";
    let table = "v_x [m/s],v_x_dot [m/s^2],f_x [N]\n0.1,0.1,-0.5\n0.2,0.1,-1.1\n0.3,0,-0.9\n0.4,0.2,-3.2\n0.5,0,-2.4\n";
    let stated = |kind: &str, value: &str, u: &str| {
        format!("[[identify.{kind}]]\ncoefficient = \"A\"\nvalue = {value}\nstandard_uncertainty = {u}\n")
    };
    for (text, place, unit) in [
        (stated("known", "\"10 kg/m\"", "\"1 kg\""), "c.toml:9:9", "kg/m"),
        (stated("known", "\"10 kg\"", "\"2 m\""), "c.toml:10:24", "m"),
        (stated("prior", "\"10 s\"", "1"), "c.toml:9:9", "s"),
        ("[identify.fixed]\nA = \"10 s\"\n".to_owned(), "c.toml:8:5", "s"),
    ] {
        let message = format!(
            "{place}: A of m is in kg, and is stated in {unit}: write it in its unit (a standard uncertainty also in %)"
        );
        refuses(&[("c.toml", &format!("{CAMPAIGN}{text}{law}")), ("t.csv", table)], "c.toml", &message);
    }
}

#[test]
fn an_output_folder_that_cannot_be_made_is_reported_and_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    std::fs::write(folder.path().join("file"), "in the way").unwrap();
    let output = froude(folder.path(), &["identify", "t.csv", "--out", "file/results"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.starts_with("froude: file/results: cannot be written: "), "{said}");
    assert!(said.trim_end().ends_with("choose another place with --out"), "{said}");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(std::fs::read_to_string(folder.path().join("file")).unwrap(), "in the way");
}

#[test]
fn rank_deficient_data_give_null_and_name_what_is_determined() {
    let folder = tempfile::tempdir().unwrap();
    // One speed: the linear and the quadratic term are the same column.
    std::fs::write(folder.path().join("t.csv"), "speed [m/s],f_x [N]\n0.5,-1.0\n0.5,-1.1\n0.5,-0.9\n").unwrap();
    let output = froude(folder.path(), &["--json", "identify", "t.csv", "--models", "linear_quadratic"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let estimate = &json["estimates"][0];
    assert!(estimate["coefficients"]["D_x_I"]["value"].is_null());
    assert_eq!(estimate["coefficients"]["D_x_II"]["status"], "undetermined");
    assert_eq!(estimate["undetermined"].as_array().unwrap().len(), 1);
    let codes: Vec<&str> = json["findings"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap()).collect();
    assert!(codes.contains(&"few-speeds"), "{codes:?}");
}

#[test]
fn radians_typed_into_a_column_of_degrees_are_suspected() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..9).map(|k| format!("0.5,{},-1.0,{}\n", f64::from(k) * 0.1, f64::from(k) * 0.2)).collect();
    std::fs::write(folder.path().join("t.csv"), format!("speed [m/s],angle [deg],f_x [N],f_y [N]\n{rows}")).unwrap();
    let output = froude(folder.path(), &["inspect", "t.csv"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        said.contains("all 9 angles lie within ±0.800 deg: they look like radians in a column of degrees; head the column `angle [rad]` if so"),
        "{said}"
    );
}

#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let Some(disk) = SmallDisk::mount("40k") else {
        eprintln!("this user may not mount a small disk; the failing writer of froude-records is tested instead");
        return;
    };
    let folder = disk.path();
    std::fs::write(folder.join("t.csv"), TABLE).unwrap();
    let output = froude(folder, &["identify", "t.csv"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.trim_end().ends_with("the disk is full; nothing was changed"), "{said}");
    let left: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left, ["t.csv"], "only the table is there");
}
