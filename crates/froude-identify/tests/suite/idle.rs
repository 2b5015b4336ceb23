//! Axes tested one at a time in one table, and readings at rest: each load has the rows in which it was measured.

use std::fmt::Write as _;
use std::path::Path;

use froude_identify::source::SourceResult;
use froude_identify::source::identify_source;
use froude_records::campaign::Campaign;
use froude_records::campaign_file::read_campaign;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

fn campaign(folder: &Path, keys: &str) -> Campaign {
    let text =
        format!("schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{keys}");
    std::fs::write(folder.join("c.toml"), text).unwrap();
    read_campaign(&folder.join("c.toml")).unwrap()
}

fn found(table: &str, keys: &str) -> Result<SourceResult, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let campaign = campaign(folder.path(), keys);
    identify_source(&campaign, &campaign.sources[0], &|_| {}).map_err(|e| e.to_string())
}

const QUADRATIC: &str = "models = [\"quadratic\"]\n";
const DRAG: [(&str, f64); 3] = [("D_x_II", 55.0), ("D_y_II", 98.0), ("D_z_II", 120.0)];

fn interval(of: &SourceResult, name: &str) -> [f64; 2] {
    of.estimates[0].coefficients[name].interval_95.unwrap()
}

/// Three axes at eight speeds each, loads with an error of 0.6 N; `idle` stands where an axis does not move.
fn axes(seed: u128, idle: &str) -> String {
    let mut rng = Pcg64::new(seed, 0);
    let mut out = "v_x [m/s],v_y [m/s],v_z [m/s],f_x [N],f_y [N],f_z [N]\n".to_owned();
    for (axis, (_, drag)) in DRAG.iter().enumerate() {
        for i in 0..8 {
            let u = if i % 2 == 0 { 0.3 } else { -0.3 } * (1.0 + 0.25 * f64::from(i / 2));
            let z: f64 = StandardNormal.sample(&mut rng);
            let mut cells = [idle; 6].map(str::to_owned);
            cells[axis] = u.to_string();
            cells[axis + 3] = (-drag * u * u.abs() + 0.6 * z).to_string();
            let _ = writeln!(out, "{}", cells.join(","));
        }
    }
    out
}

/// Zeros and empty cells give each axis what a table of it alone gives.
#[test]
fn each_axis_counts_its_own_rows() {
    let [zeros, blank] = ["0", ""].map(|idle| found(&axes(1, idle), QUADRATIC).unwrap());
    for (axis, (name, _)) in DRAG.iter().enumerate() {
        let rows = axes(1, "0");
        let of_axis = rows.lines().skip(1).skip(8 * axis).take(8);
        let letter = ["x", "y", "z"][axis];
        let mut alone = format!("v_{letter} [m/s],f_{letter} [N]\n");
        for line in of_axis {
            let cells: Vec<&str> = line.split(',').collect();
            let _ = writeln!(alone, "{},{}", cells[axis], cells[axis + 3]);
        }
        let alone = interval(&found(&alone, QUADRATIC).unwrap(), name);
        for of in [&zeros, &blank] {
            let both = interval(of, name);
            assert!((0..2).all(|k| (both[k] / alone[k] - 1.0).abs() < 1e-9), "{name}: {both:?} {alone:?}");
        }
    }
    for of in [&zeros, &blank] {
        let codes: Vec<&str> = of.findings.iter().map(|f| f.code.as_str()).collect();
        assert_eq!(codes.iter().filter(|c| **c == "load-not-measured").count(), 3, "{codes:?}");
        assert!(!codes.contains(&"uneven-scatter"), "{codes:?}");
    }
}

/// 95 % intervals of 400 tables contain the truth in 95 %, within three standard deviations.
#[test]
fn the_intervals_of_axes_tested_one_at_a_time_hold() {
    let held: usize = (0..400)
        .map(|seed| {
            let of = found(&axes(100 + seed, "0"), QUADRATIC).unwrap();
            let contains = |(name, drag): &&(&str, f64)| {
                let [low, high] = interval(&of, name);
                low <= *drag && *drag <= high
            };
            DRAG.iter().filter(contains).count()
        })
        .sum();
    let share = held as f64 / 1200.0;
    assert!((share - 0.95).abs() < 3.0 * (0.95 * 0.05 / 1200.0_f64).sqrt(), "{share}");
}

/// Readings at rest scatter by 0.02 N beside 0.5 N: they determine nothing and are left out of σ.
#[test]
fn quiet_readings_at_rest_do_not_narrow_an_interval() {
    let table = |seed: u128| {
        let mut rng = Pcg64::new(seed, 1);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut out = "speed [m/s],f_x [N]\n".to_owned();
        for i in 0..8 {
            let _ = writeln!(out, "0,{}", 0.02 * normal());
            let u = 0.4 + 0.1 * f64::from(i);
            let _ = writeln!(out, "{u},{}", -12.0 * u * u + 0.5 * normal());
        }
        out
    };
    let contains = |seed: &u128| {
        let [low, high] = interval(&found(&table(*seed), QUADRATIC).unwrap(), "D_x_II");
        low <= 12.0 && 12.0 <= high
    };
    let share = (0..400).filter(contains).count() as f64 / 400.0;
    assert!((share - 0.95).abs() < 3.0 * (0.95 * 0.05 / 400.0_f64).sqrt(), "{share}");
    let codes: Vec<String> = found(&table(0), "").unwrap().findings.into_iter().map(|f| f.code).collect();
    assert!(codes.iter().any(|c| c == "quiet-rows") && !codes.iter().any(|c| c == "load-at-rest"), "{codes:?}");
}

#[test]
fn an_empty_cell_of_a_needed_quantity_is_rejected_with_its_place() {
    let head = "v_x [m/s],v_y [m/s],f_x [N],f_y [N]\n0.1,0,-0.2,0\n";
    for (row, column) in [("0.2,,-0.4,-0.3", "v_y [m/s]"), ("0.2,0.1,,", "f_x [N]")] {
        let said = found(&format!("{head}{row}\n"), QUADRATIC).unwrap_err();
        assert!(said.contains(&format!("t.csv:3: column `{column}`: the cell is empty")), "{said}");
    }
}
