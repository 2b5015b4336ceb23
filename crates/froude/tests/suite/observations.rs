//! The table of observations beside the record.

use froude::pipeline::{Job, identify};
use froude::records::table::{ColumnData, Table};
use froude::records::table_file::read_table;

fn column<'a>(table: &'a Table, header: &str) -> &'a [f64] {
    let known: Vec<String> = table.columns.iter().map(froude::records::table::Column::header).collect();
    let place = known.iter().position(|h| h == header).unwrap_or_else(|| panic!("no {header} in {known:?}"));
    match &table.columns[place].data {
        ColumnData::Number { si, .. } => si,
        ColumnData::Text(_) => panic!("{header} is text"),
    }
}

#[test]
fn every_row_has_its_numbers_of_similarity_what_was_fitted_and_what_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let loads = [-0.12, -0.39, -0.92, -1.58, -2.52];
    let rows: Vec<String> =
        loads.iter().enumerate().map(|(k, f)| format!("{},{},{f}", 0.1 * (k + 1) as f64, 20 + k)).collect();
    std::fs::write(
        folder.path().join("t.csv"),
        format!("speed [m/s],temperature [degC],f_x [N]\n{}\n", rows.join("\n")),
    )
    .unwrap();
    std::fs::write(
        folder.path().join("c.toml"),
        "schema = 1\nname = \"x\"\n[body]\nreference_length = \"2 m\"\nreference_area = \"0.1 m^2\"\n\
         [tank]\nwidth = \"4 m\"\ndepth = \"2.5 m\"\n\
         [[source]]\nname = \"day 1\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"quadratic\"]\n\
         [[source]]\nname = \"day-1\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"linear_quadratic\"]\n",
    )
    .unwrap();
    let done = identify(&Job::new(folder.path().join("c.toml")), &|_| {}).unwrap();
    let written: Vec<_> =
        done.told.files.iter().filter(|file| file.key == "observations[]").map(|file| &file.path).collect();
    let names: Vec<_> = written.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["observations-day-1.csv", "observations-day-1-2.csv"]);
    let table = read_table(written[0], None).unwrap();
    let d = done.file.estimates[0].coefficients["D_x_II"].value.unwrap();
    for i in 0..loads.len() {
        let (u, t) = (0.1 * (i + 1) as f64, 20.0 + i as f64);
        let nu = froude::hydro::fluid::Water::at(t, 0.0).unwrap().kinematic_viscosity_m2_s();
        let close = |header: &str, expected: f64| {
            let found = column(&table, header)[i];
            assert!(
                (found - expected).abs() <= 1e-9 * expected.abs() + 1e-12,
                "{header}, row {i}: {found}, not {expected}"
            );
        };
        close("line [1]", (i + 2) as f64);
        close("Re [1]", u * 2.0 / nu);
        close("Fr_length [1]", u / (9.806_65 * 2.0_f64).sqrt());
        close("Fr_depth [1]", u / (9.806_65 * 2.5_f64).sqrt());
        close("blockage [1]", 0.01);
        close(
            "C_D [1]",
            -loads[i] / (0.5 * froude::hydro::fluid::Water::at(t, 0.0).unwrap().density_kg_m3 * u * u * 0.1),
        );
        close("f_x_quadratic [N]", -d * u * u);
        close("f_x_residual [N]", loads[i] + d * u * u);
    }
    // Leverages of one coefficient add up to one.
    assert!((column(&table, "f_x_leverage [1]").iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn a_law_of_ones_own_that_the_list_of_models_names_too_is_fitted_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), "speed [m/s],f_x [N]\n0.1,-0.12\n0.2,-0.39\n0.3,-0.92\n0.4,-1.58\n")
        .unwrap();
    std::fs::write(
        folder.path().join("c.toml"),
        "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n\
         [[source]]\nname = \"day\"\nkind = \"towing\"\ntable = \"t.csv\"\n\
         [identify]\nmodels = [\"quadratic\", \"own\", \"quadratic\"]\n\
         [[identify.model]]\nname = \"own\"\nf_x = \"-A*v_x*abs(v_x)\"\n",
    )
    .unwrap();
    let done = identify(&Job::new(folder.path().join("c.toml")), &|_| {}).unwrap();
    let ids: Vec<&str> = done.file.estimates.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["day/quadratic", "day/own"]);
}
