//! What a log's sidecar declares of its data, at `froude identify`: ranges, marks, segments, frames, a load cell's matrix, clocks, delays, filters; logs as CSV,
//! Parquet and MCAP; and the steps in the record and on the page.

use std::fmt::Write as _;
use std::path::Path;

use crate::tank::{froude, refused, replace_in, said};
use froude::records::run::{ChannelSpec, Frame, Kind, Layout, Meaning, Packing, Recorder, Role, RunMeta, RunStatus};
use froude::records::table::{Column, ColumnData, Table};
use froude::records::table_file::prepare_table;
use froude::records::units::parse_unit;
use serde_json::Value;

/// The arguments of what is refused.
const IDENTIFY: &[&str] = &["identify", "campaign.toml"];

fn identified(folder: &Path) -> Value {
    let output = froude(folder, &["identify", "campaign.toml", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn codes(record: &Value) -> Vec<(String, String)> {
    let text = |f: &Value, key: &str| f[key].as_str().unwrap().to_owned();
    record["findings"].as_array().unwrap().iter().map(|f| (text(f, "code"), text(f, "message"))).collect()
}

fn of_code(record: &Value, code: &str) -> Vec<String> {
    codes(record).into_iter().filter(|(own, _)| own == code).map(|(_, message)| message).collect()
}

/// Steps of a file of the record, by the end of its path.
fn steps(record: &Value, file: &str) -> Vec<Value> {
    let all = record["data"].as_object().unwrap();
    let data = all.values().find(|data| data["path"].as_str().unwrap().ends_with(file)).unwrap();
    data["steps"].as_array().cloned().unwrap_or_default()
}

fn step(record: &Value, file: &str, kind: &str) -> Value {
    let found = steps(record, file).into_iter().find(|step| step["step"] == kind);
    found.unwrap_or_else(|| panic!("no step {kind} of {file}: {:?}", steps(record, file)))
}

fn parameter(step: &Value, name: &str) -> f64 {
    step["parameters"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name}: {step}"))
}

fn coefficient(record: &Value, name: &str) -> f64 {
    record["estimates"][0]["coefficients"][name]["value"].as_f64().unwrap_or_else(|| panic!("{record}"))
}

/// The only coefficient, without its sign.
fn drag(record: &Value) -> f64 {
    let coefficients = record["estimates"][0]["coefficients"].as_object().unwrap();
    coefficients.values().next().unwrap()["value"].as_f64().unwrap().abs()
}

const CAMPAIGN: &str = "schema = 1\nname = \"ball\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\nruns = \"runs\"\n\
                        method = \"steady\"\nmodels = [\"quadratic\"]\n[source.steady]\ndrift = { rate = \"1 mN/min\", most = \"5 mN\" }\n";

const HEAD: &str = "schema = 1\nmethod = \"steady\"\nrole = \"test\"\n[conditions]\nangle = \"0 deg\"\n";
const TIME: &str = "t = { name = \"time\", unit = \"s\" }\n";
const SPEED: &str = "u = { name = \"speed\", unit = \"m/s\", sign = 1, frame = \"body\", clock = \"log\" }\n";
const FORCE: &str = "fx = { name = \"f_x\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }\n";

fn sidecar() -> String {
    format!("{HEAD}[columns]\n{TIME}{SPEED}{FORCE}")
}

/// A tow of 50 Hz: 4 s at rest, 10 s at `speed`, 4 s at rest. Rows of time, speed and force: a zero of 0.3 N, less 50 U², and 2 mN of noise that repeats nowhere.
fn tow(speed: f64) -> Vec<[f64; 3]> {
    (0..=900)
        .map(|i| {
            let t = 0.02 * f64::from(i);
            let u = if (4.0..14.0).contains(&t) { speed } else { 0.0 };
            [t, u, 0.3 - 50.0 * u * u + 2e-3 * (997.0 * t * t).sin()]
        })
        .collect()
}

fn csv(head: &str, rows: &[Vec<f64>]) -> String {
    let mut text = format!("{head}\n");
    for row in rows {
        let cells: Vec<String> = row.iter().map(|x| format!("{x:.9}")).collect();
        writeln!(text, "{}", cells.join(",")).unwrap();
    }
    text
}

fn write(runs: &Path, id: &str, rows: &[[f64; 3]], sidecar: &str) {
    let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    std::fs::write(runs.join(format!("{id}.csv")), csv("t,u,fx", &rows)).unwrap();
    std::fs::write(runs.join(format!("{id}.toml")), sidecar).unwrap();
}

fn folder(campaign: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("campaign.toml"), campaign).unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    folder
}

/// Three tows.
fn three() -> tempfile::TempDir {
    let folder = folder(CAMPAIGN);
    for u in [0.2, 0.3, 0.4] {
        write(&folder.path().join("runs"), &format!("t{u}"), &tow(u), &sidecar());
    }
    folder
}

/// 2 mN of noise on 8 N.
const SAME: f64 = 1e-3;

/// A cell of ± 8 N: a tow of 12 N is left out, and a pull of 0.2 s to its end in another costs those samples alone.
#[test]
fn readings_at_the_end_of_a_declared_range_are_marked_and_not_used() {
    let clean = drag(&identified(three().path()));
    let folder = three();
    let runs = folder.path().join("runs");
    let ranged = sidecar().replace(FORCE, &FORCE.replace(" }", ", range = \"±8 N\", resolution = \"1 mN\" }"));
    let mut pulled = tow(0.4);
    pulled.iter_mut().filter(|row| (8.0..8.2).contains(&row[0])).for_each(|row| row[2] = 8.0);
    write(&runs, "t0.4", &pulled, &ranged);
    let mut beyond = tow(0.5);
    for row in &mut beyond {
        row[2] = row[2].max(-8.0);
    }
    write(&runs, "t0.5", &beyond, &ranged);
    let record = identified(folder.path());
    assert!((drag(&record) / clean - 1.0).abs() < SAME, "{} {clean}", drag(&record));
    assert_eq!(record["estimates"][0]["n"], 3);
    let own = step(&record, "t0.4.csv", "clipped");
    // 8.00 s to 8.18 s by 0.02 s, one more where 8.2 is a little below itself.
    assert!((10.0..=11.0).contains(&parameter(&own, "samples")), "{own}");
    assert!(own["words"].as_str().unwrap().contains("at the end of its range (−8 to 8 N)"), "{own}");
    // From the end of the pull to the end of the tow: the longest part without a mark.
    let window = step(&record, "t0.4.csv", "window");
    assert!(parameter(&window, "from") > 8.19 && parameter(&window, "to") > 13.0, "{window}");
    let left_out = of_code(&record, "run-left-out");
    assert!(
        left_out.len() == 1
            && left_out[0].contains("\"t0.5\"")
            && left_out[0].contains("its steady window holds 1 mark, the first from 4"),
        "{left_out:?}"
    );
    let clipped = of_code(&record, "channel-clipped");
    assert!(
        clipped.iter().any(|text| text.contains("t0.5.csv: f_x: the sensor is clipped: 500 samples in 1 stretch")),
        "{clipped:?}"
    );
}

/// 50 mN steps under 2 mN of noise: no mean averages them down.
#[test]
fn a_step_that_is_larger_than_the_noise_is_a_finding() {
    let folder = three();
    let mut coarse = tow(0.3);
    for row in &mut coarse {
        row[2] = (row[2] / 0.05).round() * 0.05;
    }
    let fine = FORCE.replace(" }", ", resolution = \"1 mN\" }");
    let rough = FORCE.replace(" }", ", resolution = \"50 mN\" }");
    write(&folder.path().join("runs"), "t0.3", &coarse, &sidecar().replace(FORCE, &rough));
    write(&folder.path().join("runs"), "t0.2", &tow(0.2), &sidecar().replace(FORCE, &fine));
    let found = of_code(&identified(folder.path()), "quantised");
    // 50 mN/√12 = 14.4 mN, and in two digits 14.
    assert!(
        found.len() == 1
            && found[0].contains("t0.3.csv: f_x is read in steps of 0.05")
            && found[0].contains("standard uncertainty of 0.014 N"),
        "{found:?}"
    );
}

const MARK: &str = "[[marks]]\nfrom = \"7 s\"\nto = \"7.4 s\"\nwhy = \"outlier\"\nby = \"J. Froude\"\nnote = \"somebody leaned on the rail\"\n";

#[test]
fn marks_are_left_out_of_windows_and_named_windows_are_used_and_checked() {
    let clean = drag(&identified(three().path()));
    let folder = three();
    let runs = folder.path().join("runs");
    let mut leaned = tow(0.4);
    leaned.iter_mut().filter(|row| (7.0..7.4).contains(&row[0])).for_each(|row| row[2] += 5.0);
    write(&runs, "t0.4", &leaned, &sidecar());
    // 5 N over 0.4 s of some 8.5 s are 0.24 N of 8.
    let biased = drag(&identified(folder.path()));
    assert!((biased / clean - 1.0).abs() > 0.01, "{biased} {clean}");
    write(&runs, "t0.4", &leaned, &format!("{}{MARK}", sidecar()));
    let record = identified(folder.path());
    assert!((drag(&record) / clean - 1.0).abs() < SAME, "{} {clean}", drag(&record));
    let mark = step(&record, "t0.4.csv", "mark");
    assert_eq!(mark["words"], "7 s to 7.4 s are not used: outlier, by J. Froude (somebody leaned on the rail)");

    let named = |from: &str, to: &str| {
        format!(
            "{}{MARK}[[segments]]\nname = \"steady\"\nfrom = \"{from}\"\nto = \"{to}\"\nby = \"W. Froude\"\n",
            sidecar()
        )
    };
    write(&runs, "t0.4", &leaned, &named("9 s", "12 s"));
    let record = identified(folder.path());
    assert!((drag(&record) / clean - 1.0).abs() < SAME, "{} {clean}", drag(&record));
    let window = step(&record, "t0.4.csv", "window");
    assert!(
        (parameter(&window, "from") - 9.0).abs() < 0.021 && (parameter(&window, "to") - 12.0).abs() < 0.021,
        "{window}"
    );
    let found = of_code(&record, "named-window");
    assert!(found.len() == 1 && found[0].contains("was named by W. Froude; it is steady by the rule too"), "{found:?}");

    // A window with a mark in it, one that is not steady, and one that is none.
    write(&runs, "t0.4", &leaned, &named("6 s", "12 s"));
    let left_out = of_code(&identified(folder.path()), "run-left-out");
    assert!(
        left_out.len() == 1
            && left_out[0]
                .contains("its steady window holds 1 mark, the first from 7 s to 7.4 s, outlier by J. Froude"),
        "{left_out:?}"
    );
    write(&runs, "t0.4", &tow(0.4), &named("3 s", "6.5 s"));
    let found = of_code(&identified(folder.path()), "named-window-not-steady");
    assert!(found.len() == 1 && found[0].contains("and 1.00 % is steady by the rule"), "{found:?}");
    write(&runs, "t0.4", &tow(0.4), &named("60 s", "65 s"));
    let left_out = of_code(&identified(folder.path()), "run-left-out");
    assert!(left_out[0].contains("the segment steady, from 60.000 s to 65.000 s, has 0 samples"), "{left_out:?}");
}

#[test]
fn words_of_a_sidecar_that_are_not_known_are_refused_with_the_nearest_and_their_place() {
    let folder = three();
    let path = folder.path().join("runs/t0.4.toml");
    let refused_with = |to: &str| {
        std::fs::write(&path, to).unwrap();
        refused(folder.path(), IDENTIFY)
    };
    let with = |words: &str| sidecar().replace(FORCE, &FORCE.replace(" }", &format!(", {words} }}")));
    for (text, place, expected) in [
        (with("rnage = \"8 N\""), "t0.4.toml:9:", "did you mean `range`?"),
        (with("range = \"8 m\""), "t0.4.toml:9:", "a force (N)"),
        (with("range = [\"8 N\", \"-8 N\"]"), "t0.4.toml:9:", "the smaller end stands first"),
        (with("filter = { kind = \"butterwort\", causal = true }"), "t0.4.toml:9:", "did you mean `butterworth`?"),
        (with("filter = { kind = \"butterworth\", order = 2, corner = \"20 Hz\" }"), "t0.4.toml:9:", "causal"),
        (format!("{}{}", sidecar(), MARK.replace("why", "whhy")), "t0.4.toml:13:", "did you mean `why`?"),
        (
            format!("{}{}", sidecar(), MARK.replace("\"outlier\"", "\"outlyer\"")),
            "t0.4.toml:13:",
            "did you mean `outlier`?",
        ),
        (format!("{}{}", sidecar(), MARK.replace("7.4 s", "6 s")), "t0.4.toml:12:", "before from"),
        (format!("{}[[segment]]\nname = \"steady\"\n", sidecar()), "t0.4.toml:10:", "did you mean `segments`?"),
        (
            format!("{}[clocks.camera]\noffset = \"1 ms\"\nstandart = \"1 ms\"\n", sidecar()),
            "t0.4.toml:12:",
            "did you mean `standard`?",
        ),
        (
            sidecar().replace("frame = \"body\", clock = \"log\" }\nfx", "frame = \"bdy\", clock = \"log\" }\nfx"),
            "t0.4.toml:8:",
            "did you mean `body`?",
        ),
        (sidecar().replace("method = \"steady\"\n", "") + MARK, "t0.4.toml:", "state what that is with method"),
    ] {
        let said = refused_with(&text);
        assert!(said.contains(place) && said.contains(expected), "{expected}: {said}\n{text}");
    }
}

const CELL: &str = "[frames.cell]\nparent = \"body\"\nrotation = { axis = \"z\", angle = \"90 deg\" }\norigin = [\"0.1 m\", \"0 m\", \"0 m\"]\n";

/// The cell is turned by 90° about z: its x is the body's y, its y the body's −x.
fn turned(u: f64) -> Vec<[f64; 4]> {
    tow(u).into_iter().map(|[t, u, fx]| [t, u, 0.1 + 0.01 * (31.0 * t).sin(), -fx]).collect()
}

fn cell_column(header: &str, load: &str) -> String {
    format!("{header} = {{ name = \"{load}\", unit = \"N\", sign = 1, frame = \"cell\", clock = \"log\" }}\n")
}

fn write_four(runs: &Path, id: &str, head: &str, rows: &[[f64; 4]], sidecar: &str) {
    let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    std::fs::write(runs.join(format!("{id}.csv")), csv(head, &rows)).unwrap();
    std::fs::write(runs.join(format!("{id}.toml")), sidecar).unwrap();
}

#[test]
fn loads_are_turned_from_the_cell_and_made_of_its_bridges() {
    let clean = drag(&identified(three().path()));
    let along = |sidecar: &str, head: &str, rows: &dyn Fn(f64) -> Vec<[f64; 4]>| {
        let folder = folder(CAMPAIGN);
        for u in [0.2, 0.3, 0.4] {
            write_four(&folder.path().join("runs"), &format!("t{u}"), head, &rows(u), sidecar);
        }
        folder
    };
    let of_cell =
        format!("{HEAD}[columns]\n{TIME}{SPEED}{}{}{CELL}", cell_column("cx", "f_x"), cell_column("cy", "f_y"));
    let tank = along(&of_cell, "t,u,cx,cy", &turned);
    let record = identified(tank.path());
    // f_x of the body is −f_y of the cell: the same numbers to their nine printed digits.
    assert!((drag(&record) / clean - 1.0).abs() < 1e-7, "{} {clean}", drag(&record));
    let frame = step(&record, "t0.4.csv", "frame");
    assert!((parameter(&frame, "r12") + 1.0).abs() < 1e-12 && parameter(&frame, "origin_x") == 0.1, "{frame}");

    // Two bridges in mV: f = M g in the cell's axes.
    let m = [[2.0, 0.5], [-0.3, 1.5]];
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let bridges = |u: f64| -> Vec<[f64; 4]> {
        let inverse = |[t, u, x, y]: [f64; 4]| {
            [t, u, (m[1][1] * x - m[0][1] * y) / determinant, (m[0][0] * y - m[1][0] * x) / determinant]
        };
        turned(u).into_iter().map(inverse).collect()
    };
    let bridge = |name: &str| {
        format!("{name} = {{ name = \"{name}\", unit = \"mV\", sign = 1, frame = \"sensor\", clock = \"log\" }}\n")
    };
    let matrix = "[cell]\ncolumns = [\"g1\", \"g2\"]\nloads = [\"f_x\", \"f_y\"]\nunits = [\"N\", \"N\"]\nframe = \"cell\"\nmatrix = [[2.0, 0.5], [-0.3, 1.5]]\n";
    let of_bridges = format!("{HEAD}[columns]\n{TIME}{SPEED}{}{}{CELL}{matrix}", bridge("g1"), bridge("g2"));
    let tank = along(&of_bridges, "t,u,g1,g2", &bridges);
    let record = identified(tank.path());
    // Nine printed digits of a bridge, 12 N of both.
    assert!((drag(&record) / clean - 1.0).abs() < 1e-6, "{} {clean}", drag(&record));
    let cell = step(&record, "t0.3.csv", "cell");
    assert_eq!((parameter(&cell, "g1"), parameter(&cell, "g2")), (2.0, 0.5), "{cell}");

    // What turns nothing, what is not there, and what is half a load.
    let path = tank.path().join("runs/t0.4.toml");
    let rotation = "rotation = { axis = \"z\", angle = \"90 deg\" }";
    for (from, to, expected) in [
        (rotation, "rotation = [[0, -1, 0], [1, 0, 0], [0, 0, -1]]", "is a reflection"),
        (rotation, "rotation = [[0, -1, 0], [1.1, 0, 0], [0, 0, 1]]", "off unit vectors at right angles by 2.1"),
        ("parent = \"body\"", "parent = \"rod\"", "`parent` is \"rod\"; known: body"),
        ("parent = \"body\"", "parent = \"cell\"", "never to the body"),
        ("columns = [\"g1\", \"g2\"]", "columns = [\"g1\", \"g3\"]", "names the bridge \"g3\", which no column is"),
        ("units = [\"N\", \"N\"]", "units = [\"N\", \"N m\"]", "has \"N m\" for f_y, a moment"),
        ("frame = \"cell\"\nmatrix", "frame = \"cel\"\nmatrix", "did you mean `cell`?"),
        (
            "unit = \"mV\", sign = 1, frame = \"sensor\"",
            "unit = \"mV\", frame = \"sensor\"",
            "the bridge g1 states no sign",
        ),
    ] {
        std::fs::write(&path, &of_bridges).unwrap();
        replace_in(&path, from, to);
        let said = refused(tank.path(), IDENTIFY);
        assert!(said.contains("t0.4.toml:") && said.contains(expected), "{expected}: {said}");
    }
    let half = format!("{HEAD}[columns]\n{TIME}{SPEED}{}{CELL}", cell_column("cx", "f_x")).replace("90 deg", "80 deg");
    let tank = along(&half, "t,u,cx,cy", &turned);
    let said = refused(tank.path(), IDENTIFY);
    assert!(said.contains("none of f_x can be turned from the frame \"cell\""), "{said}");
}

const SWING: &str = "schema = 1\nname = \"rod\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nvolume = \"1e-3 m^3\"\n[[source]]\nname = \"tank\"\nkind = \"tank\"\nruns = \"runs\"\n\
                     method = \"forced_oscillation\"\nmodels = [\"linear\"]\n[source.forced_oscillation]\npivot = \"upright\"\nradius = \"0.5 m\"\nmass = \"1 kg\"\n\
                     [[identify.model]]\nname = \"linear\"\nf_y = \"-D*v_y\"\n";
const SWUNG: &str = "schema = 1\nmethod = \"forced_oscillation\"\nrole = \"test\"\n[conditions]\nflow = \"0 m/s\"\n[columns]\nt = { name = \"time\", unit = \"s\" }\n\
                     phi = { name = \"angle\", unit = \"rad\", sign = 1, frame = \"sensor\", clock = \"log\" }\n\
                     f = { name = \"force\", unit = \"N\", sign = 1, frame = \"body\", clock = \"log\" }\n";

/// 1 kg and C_A = 0.8 of 1 kg of water on a rod of 0.5 m, drag of 4 kg/s, 1.2, 1.6 and 2 rad/s by 0.3 rad, twelve periods at 50 Hz. The angle is stamped `stamp(t)` of the log's
/// time for its rows; the force is `late_s(ω)` late.
fn swings(stamp: impl Fn(f64) -> f64, late_s: impl Fn(f64) -> f64, sidecar: &str) -> tempfile::TempDir {
    let folder = folder(SWING);
    for (i, omega) in [1.2, 1.6, 2.0].into_iter().enumerate() {
        let n = (12.0 * std::f64::consts::TAU / omega * 50.0) as u32;
        let rows: Vec<[f64; 3]> = (0..n)
            .map(|k| {
                let t = 0.02 * f64::from(k);
                let (sin, cos) = (omega * (t - late_s(omega))).sin_cos();
                let force = 0.5 * 0.3 * omega * (-1.8 * omega * sin + 4.0 * cos) + 1e-3 * (997.0 * t * t).sin();
                [t, 0.3 * (omega * stamp(t)).sin(), force]
            })
            .collect();
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
        let runs = folder.path().join("runs");
        std::fs::write(runs.join(format!("{i}.csv")), csv("t,phi,f", &rows)).unwrap();
        std::fs::write(runs.join(format!("{i}.toml")), sidecar).unwrap();
    }
    folder
}

/// Noise of 1 mN on 0.5 N over 1,500 samples and more; a spline of 150 samples a period errs by (2π/150)⁴/48 = 6e-8.
const C_A_SAME: f64 = 1e-3;
const DELAY_SAME_S: f64 = 2e-4;

#[test]
fn a_camera_is_brought_onto_the_clock_of_the_log() {
    let (offset, skew) = (0.05, 2e-3);
    let stamp = |t: f64| t + offset + skew * t;
    let camera = SWUNG.replace("sensor\", clock = \"log\"", "sensor\", clock = \"camera\"");
    let silent = swings(stamp, |_| 0.0, &camera);
    let said = refused(silent.path(), IDENTIFY);
    assert!(
        said.contains(
            "angle has the clock \"camera\", which cannot be aligned with that of the log: declare [clocks.camera]"
        ),
        "{said}"
    );

    let clocks = "[clocks.camera]\noffset = \"50 ms\"\nskew = \"2 ms/s\"\nstandard = \"1 ms\"\nfound = \"by a light in the picture, 2026-11-20\"\n";
    let aligned = swings(stamp, |_| 0.0, &format!("{camera}{clocks}"));
    let record = identified(aligned.path());
    assert!((coefficient(&record, "C_A") - 0.8).abs() < C_A_SAME, "{record}");
    assert!(coefficient(&record, "delay").abs() < DELAY_SAME_S, "{record}");
    let clock = step(&record, "0.csv", "clock");
    assert!(
        (parameter(&clock, "offset") - 0.05).abs() < 1e-12 && (parameter(&clock, "skew") - 2e-3).abs() < 1e-12,
        "{clock}"
    );
    // Rows before 50 ms have no picture: 0, 0.02 and 0.04 s.
    assert_eq!(parameter(&step(&record, "0.csv", "cut"), "beginning"), 3.0);

    // A skew that is left in moves the delay by 2 ms a second; in ppm it is the same skew.
    let text = clocks.replace("skew = \"2 ms/s\"", "skew = \"2000 ppm\"");
    let record = identified(swings(stamp, |_| 0.0, &format!("{camera}{text}")).path());
    assert!((coefficient(&record, "C_A") - 0.8).abs() < C_A_SAME, "{record}");
    let text = clocks.replace("50 ms", "900 s");
    let said = refused(swings(stamp, |_| 0.0, &format!("{camera}{text}")).path(), IDENTIFY);
    assert!(said.contains("clocks that cannot be aligned: as its sidecar states"), "{said}");
}

/// RC filter of 5 Hz and 10 ms of a converter: at ω the filter delays atan(ω/2πf_c)/ω, some 31.6 ms.
#[test]
fn what_filter_and_converter_delay_is_taken_off() {
    let corner = 5.0;
    let late = |omega: f64| 0.01 + (omega / (std::f64::consts::TAU * corner)).atan() / omega;
    let left_in = identified(swings(|t| t, late, SWUNG).path());
    let delay = coefficient(&left_in, "delay");
    assert!((delay - late(1.6)).abs() < 1e-3, "{delay} {}", late(1.6));
    let words = "frame = \"body\", clock = \"log\", delay = \"10 ms\", filter = { kind = \"butterworth\", order = 1, corner = \"5 Hz\", causal = true }";
    let sidecar = SWUNG.replace("frame = \"body\", clock = \"log\"", words);
    let record = identified(swings(|t| t, late, &sidecar).path());
    assert!(coefficient(&record, "delay").abs() < DELAY_SAME_S, "{record}");
    assert!((coefficient(&record, "C_A") - 0.8).abs() < C_A_SAME, "{record}");
    let filter = step(&record, "1.csv", "filter");
    assert!((parameter(&filter, "signal") - 1.6 / std::f64::consts::TAU).abs() < 1e-4, "{filter}");
    assert!((parameter(&filter, "delay") - (late(1.6) - 0.01)).abs() < 1e-5, "{filter}");
    // f_c π/2 of order 1, and cos atan(f/f_c).
    assert!((parameter(&filter, "noise_bandwidth") - corner * std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{filter}");
    assert!(
        (parameter(&filter, "gain") - (1.6 / (std::f64::consts::TAU * corner)).atan().cos()).abs() < 1e-5,
        "{filter}"
    );
    // A corner near the signal takes from it, and that is said.
    let low = sidecar.replace("corner = \"5 Hz\"", "corner = \"0.5 Hz\"");
    let found = of_code(&identified(swings(|t| t, late, &low).path()), "filter-at-the-signal");
    assert_eq!(found.len(), 3, "{found:?}");
}

/// Cycles that a mark touches are dropped; a run that has too few left is refused, with how many and where.
#[test]
fn cycles_with_a_mark_are_dropped() {
    let mark = |from: &str, to: &str| {
        format!("{SWUNG}[[marks]]\nfrom = \"{from}\"\nto = \"{to}\"\nwhy = \"dropped\"\nby = \"J. Froude\"\n")
    };
    let tank = swings(|t| t, |_| 0.0, SWUNG);
    let log = tank.path().join("runs/1.csv");
    let spoilt: String = std::fs::read_to_string(&log)
        .unwrap()
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            match cells[0].parse::<f64>() {
                Ok(t) if (20.0..21.0).contains(&t) => format!("{},{},3.0{}\n", cells[0], cells[1], &cells[0][3..5]),
                _ => format!("{line}\n"),
            }
        })
        .collect();
    std::fs::write(&log, spoilt).unwrap();
    let biased = coefficient(&identified(tank.path()), "C_A");
    assert!((biased - 0.8).abs() > 10.0 * C_A_SAME, "{biased}");
    std::fs::write(tank.path().join("runs/1.toml"), mark("20 s", "21 s")).unwrap();
    let record = identified(tank.path());
    assert!((coefficient(&record, "C_A") - 0.8).abs() < C_A_SAME, "{record}");
    let dropped = of_code(&record, "cycles-dropped");
    assert!(dropped.len() == 1 && dropped[0].starts_with("run \"1\": "), "{dropped:?}");
    let dropped = parameter(&step(&record, "1.csv", "window"), "dropped");
    assert!((1.0..=2.0).contains(&dropped), "{dropped}");
    std::fs::write(tank.path().join("runs/1.toml"), mark("8 s", "40 s")).unwrap();
    let said = refused(tank.path(), IDENTIFY);
    assert!(
        said.contains(
            "are left without a mark, and 5 are needed: 1 mark, the first from 8 s to 40 s, dropped by J. Froude"
        ),
        "{said}"
    );
}

#[test]
fn the_report_has_the_steps_of_the_runs() {
    let folder = three();
    write(&folder.path().join("runs"), "t0.4", &tow(0.4), &format!("{}{MARK}", sidecar()));
    let output = froude(folder.path(), &["identify", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let page = std::fs::read_to_string(folder.path().join("campaign-results/report.html")).unwrap();
    for words in [
        "Steps from 3 logs to channels in SI.",
        "column fx [N], times 1, frame body, clock log",
        "by J. Froude (somebody leaned on the rail)",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // The record is one that its own schema knows.
    let record: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("campaign-results/estimate.json")).unwrap()).unwrap();
    let schema: Value = serde_json::from_str(froude::records::schema::ESTIMATE_JSON_SCHEMA).unwrap();
    assert!(jsonschema::is_valid(&schema, &record));
    assert_eq!(steps(&record, "t0.4.csv").iter().filter(|step| step["step"] == "read").count(), 2);
}

/// The same three tows as CSV, as Parquet and as MCAP that Froude recorded.
#[test]
fn parquet_and_mcap_are_read_as_csv_is() {
    let of_csv = drag(&identified(three().path()));
    // As the CSV prints them.
    let rounded = |x: f64| format!("{x:.9}").parse::<f64>().unwrap();

    let parquet = folder(CAMPAIGN);
    for u in [0.2, 0.3, 0.4] {
        let rows = tow(u);
        let column = |name: &str, unit: &str, at: usize| {
            let unit = parse_unit(unit).unwrap();
            let si = rows.iter().map(|row| rounded(row[at])).collect();
            Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } }
        };
        let path = parquet.path().join(format!("runs/t{u}.parquet"));
        let table = Table::of(
            path.clone(),
            vec![column("t", "s", 0), column("u", "m/s", 1), column("fx", "N", 2)],
            (1..=rows.len()).collect(),
        );
        prepare_table(&table, &path).unwrap().take_place().unwrap();
        let sidecar = sidecar()
            .replace("\nt = ", "\n\"t [s]\" = ")
            .replace("\nu = ", "\n\"u [m/s]\" = ")
            .replace("\nfx = ", "\n\"fx [N]\" = ");
        std::fs::write(path.with_extension("toml"), sidecar).unwrap();
    }
    let record = identified(parquet.path());
    assert!((drag(&record) / of_csv - 1.0).abs() < 1e-12, "{} {of_csv}", drag(&record));

    let mcap = folder(CAMPAIGN);
    let runs = mcap.path().join("runs");
    for u in [0.2, 0.3, 0.4] {
        let channel =
            |name: &str, unit: &str| ChannelSpec { name: name.to_owned(), unit: unit.to_owned(), kind: Kind::F64 };
        let layout = Layout::new(vec![channel("speed", "m/s"), channel("f_x", "N")]).unwrap();
        let meaning = |name: &str, unit: &str, sign: i8| {
            (name.to_owned(), Meaning { frame: Frame::Body, sign, ..Meaning::of(name, unit, "board") })
        };
        let meta = RunMeta {
            id: format!("t{u}"),
            method: "steady".to_owned(),
            role: Role::Test,
            log_rate_hz: 50.0,
            // Recorded as the rig's load on the body: the sign is undone when it is read.
            channels: [meaning("speed", "m/s", 1), meaning("f_x", "N", -1)].into_iter().collect(),
            ..RunMeta::default()
        };
        let mut recorder = Recorder::create(&runs, meta, layout, Packing::Lz4).unwrap();
        for (tick, [_, u, fx]) in tow(u).into_iter().enumerate() {
            recorder.record(tick as u64, &[rounded(u), -rounded(fx)]).unwrap();
        }
        recorder.finish(RunStatus::Complete).unwrap();
    }
    let record = identified(mcap.path());
    // Times are ticks here and printed there.
    assert!((drag(&record) / of_csv - 1.0).abs() < 1e-9, "{} {of_csv}", drag(&record));
    assert!(step(&record, "t0.3.mcap", "read")["words"].as_str().unwrap().contains("clock board"), "{record}");

    // One run twice, a log that is another's, and one that is not complete.
    write(&runs, "t0.3", &tow(0.3), &std::fs::read_to_string(runs.join("t0.3.toml")).unwrap());
    assert!(refused(mcap.path(), IDENTIFY).contains("is one run with"), "{}", refused(mcap.path(), IDENTIFY));
    std::fs::remove_file(runs.join("t0.3.csv")).unwrap();
    std::fs::copy(runs.join("t0.4.mcap"), runs.join("t0.3.mcap")).unwrap();
    let said = refused(mcap.path(), IDENTIFY);
    assert!(said.contains("t0.3.mcap") && (said.contains("exchanged") || said.contains("SHA-256")), "{said}");
}

/// 1,200 s at 1 mN/min are 20 mN, and 5 mN are allowed: nothing is left, and both numbers are said.
#[test]
fn a_still_run_longer_ago_than_the_drift_allows_is_refused_with_both_numbers() {
    let folder = folder(CAMPAIGN);
    let runs = folder.path().join("runs");
    let moving: Vec<[f64; 3]> = tow(0.3).into_iter().filter(|row| (4.1..13.9).contains(&row[0])).collect();
    let at = |role: &str, at: &str| {
        sidecar()
            .replace("role = \"test\"", &format!("role = \"{role}\""))
            .replace("[columns]", &format!("at = \"{at}\"\n[columns]"))
    };
    write(&runs, "still", &tow(0.0), &at("still", "0 s"));
    write(&runs, "test", &moving, &at("test", "1200 s"));
    let said = refused(folder.path(), IDENTIFY);
    assert!(
        said.contains("the nearest still run is 1200 s away")
            && said.contains("2.000e-2 N")
            && said.contains("5.000e-3 N is allowed"),
        "{said}"
    );
}

/// The sidecar that the book shows is one.
#[test]
fn the_sidecar_of_the_book_is_read() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src/logs.md")).unwrap();
    let text = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let sidecar = froude::records::sidecar::parse_sidecar(Path::new("logs.md"), text).unwrap();
    let declared = &sidecar.run.declared;
    assert_eq!(
        (declared.clocks.len(), declared.frames.len(), declared.marks.len(), declared.segments.len()),
        (1, 1, 1, 1)
    );
    assert!(declared.cell.is_some() && sidecar.columns["g1"].sensor.filter.is_some());
}
