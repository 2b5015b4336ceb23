//! `froude convert`: what is read comes back the same from CSV, Parquet and MCAP.

use crate::bench::{froude, text};

#[test]
fn a_log_goes_through_every_format_and_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("log.txt"), "t;u;Kraft\nms;V;N\n0;1,5;-2,25\n10;1,75;-2,5\n20;2,0;-2,75\n").unwrap();
    std::fs::write(
        at("log.toml"),
        "schema = 1\n[columns]\nt = { name = \"time\" }\nKraft = { name = \"f_x\" }\nu = { name = \"command\" }\n",
    )
    .unwrap();
    let convert = |input: &str, out: &str| {
        let output = froude(&["convert", text(&at(input)), text(&at(out))]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let said = convert("log.txt", "a.csv");
    assert!(said.contains("3 columns, 3 rows"), "{said}");
    assert!(
        said.contains("log.txt was read as: cells separated by semicolons, decimal comma, units in line 2"),
        "{said}"
    );
    let plain = "time [ms],f_x [N],command [V]\n0,-2.25,1.5\n10,-2.5,1.75\n20,-2.75,2\n";
    assert_eq!(std::fs::read_to_string(at("a.csv")).unwrap(), plain);
    convert("a.csv", "b.parquet");
    convert("b.parquet", "c.csv");
    assert_eq!(std::fs::read_to_string(at("c.csv")).unwrap(), plain);
    convert("c.csv", "d.mcap");
    let inspected = String::from_utf8(froude(&["inspect", text(&at("d.mcap"))]).stdout).unwrap();
    assert!(inspected.contains("/table") && inspected.contains("f_x"), "{inspected}");
    // Messages have no units: a sidecar states them.
    let columns = "time = { name = \"time\", unit = \"s\" }\nf_x = { name = \"f_x\", unit = \"N\" }\ncommand = { name = \"command\", unit = \"V\" }\n";
    std::fs::write(at("columns.toml"), format!("schema = 1\n[columns]\n{columns}")).unwrap();
    let (mcap, back, sidecar) = (at("d.mcap"), at("e.csv"), at("columns.toml"));
    let output = froude(&["convert", text(&mcap), text(&back), "--sidecar", text(&sidecar)]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let back = std::fs::read_to_string(at("e.csv")).unwrap();
    assert!(back.lines().next().unwrap().contains("f_x") && back.contains("-2.75"), "{back}");

    let again = froude(&["convert", text(&at("a.csv")), text(&at("c.csv"))]);
    assert_eq!(again.status.code(), Some(2));
    let told = String::from_utf8(again.stderr).unwrap();
    assert!(told.contains("c.csv is there already, and is not replaced"), "{told}");
    std::fs::write(at("f.csv"), "speed [m/s],f_x [N]\n1,2\n").unwrap();
    let without_time = froude(&["convert", text(&at("f.csv")), text(&at("f.mcap"))]);
    assert_eq!(without_time.status.code(), Some(2));
    assert!(!at("f.mcap").exists());
}

#[test]
fn what_it_prints_as_json_is_described() {
    let folder = tempfile::tempdir().unwrap();
    let [input, out] = ["a.csv", "b.csv"].map(|name| folder.path().join(name));
    std::fs::write(&input, "speed [m/s];f_x [N]\n1;2,5\n").unwrap();
    crate::held::of_verb("convert", &[&froude::records::convert::convert(&input, None, &out).unwrap()]);
}
