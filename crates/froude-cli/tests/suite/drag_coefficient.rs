//! C_D with its interval wherever area and density are known, beside what is published.

use std::f64::consts::FRAC_PI_4;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::bench::{froude, json, refusal, text};

/// A sphere of 100 mm in water of 998 kg/m³.
const AREA_M2: f64 = FRAC_PI_4 * 0.01;
const BODY: &str = "shape = \"sphere\"\nreference_length = \"100 mm\"\n";

/// Tows of it with C_D 0.45, a zero of the sensor and alternating errors of 1 %, and a campaign about them.
fn tows(folder: &Path, fluid: &str, body: &str, zero_n: f64) -> PathBuf {
    let mut rows = "speed [m/s],f_x [N]\n".to_owned();
    for k in 0..12 {
        let u = 0.3 + 0.1 * f64::from(k);
        let error = if k % 4 < 2 { 1.01 } else { 0.99 };
        writeln!(rows, "{u:.2},{:.5}", zero_n - 0.5 * 998.0 * AREA_M2 * 0.45 * u * u * error).unwrap();
    }
    std::fs::write(folder.join("t.csv"), rows).unwrap();
    let path = folder.join("c.toml");
    let text = format!(
        "schema = 1\nname = \"sphere\"\n[fluid]\n{fluid}\n[body]\n{body}\n[[source]]\nname = \"tows\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"quadratic\"]\n"
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn c_d(record: &Value) -> (f64, [f64; 2]) {
    let number = &record["estimates"][0]["derived"]["C_D"];
    let of = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{number}"));
    (of(&number["value"]), [of(&number["interval_95"][0]), of(&number["interval_95"][1])])
}

/// The coefficient of the record times 2/(ρA), with the uncertainty of area and density in it; on the page beside Brown and Lawler's curve.
#[test]
fn a_sphere_has_its_drag_coefficient_in_the_record_and_beside_the_published_one() {
    let folder = tempfile::tempdir().unwrap();
    let fluid = "density = \"998 kg/m^3\"\nkinematic_viscosity = \"1.0e-6 m^2/s\"";
    let campaign = tows(folder.path(), fluid, BODY, 0.0);
    let record = json(&["identify", text(&campaign), "--json"]);
    let estimate = &record["estimates"][0];
    let (value, [low, high]) = c_d(&record);
    let d = estimate["coefficients"]["D_x_II"]["value"].as_f64().unwrap();
    assert!((value / (2.0 * d / (998.0 * AREA_M2)) - 1.0).abs() < 1e-9, "{value}");
    assert!(low < 0.45 && 0.45 < high && high - low < 0.02, "[{low}, {high}]");
    assert_eq!(estimate["derived"]["C_D"]["formula"], "2*D_x_II/(density*area)");
    let output = froude(&["identify", text(&campaign)]);
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.lines().any(|line| line.contains("C_D") && line.contains("derived")), "{shown}");
    let page = std::fs::read_to_string(folder.path().join("c-results/report.html")).unwrap();
    assert!(page.contains("Drag coefficient") && page.contains("sphere, Brown &amp; Lawler 2003"));
    // 3 % of the area and 1 % of the density, in quadrature with the scatter.
    let fluid = "density = { value = \"998 kg/m^3\", standard = \"1 %\" }\nkinematic_viscosity = \"1.0e-6 m^2/s\"";
    let body = format!("{BODY}reference_area = {{ value = \"78.53982 cm^2\", standard = \"3 %\" }}\n");
    let (_, wider) = c_d(&json(&["identify", text(&tows(folder.path(), fluid, &body, 0.0)), "--json"]));
    let u = |[low, high]: [f64; 2]| 0.5 * (high - low) / value;
    let expected = 1.96 * 0.03_f64.hypot(0.01);
    assert!((u(wider) / expected.hypot(u([low, high])) - 1.0).abs() < 0.05, "{wider:?} {}", u(wider));
}

/// The zero of a sensor is no drag: with a law that has one, C_D is that of the rest.
#[test]
fn the_load_at_rest_is_no_drag() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = tows(folder.path(), "density = \"998 kg/m^3\"", BODY, -0.3);
    let own = std::fs::read_to_string(&campaign).unwrap().replace("[\"quadratic\"]", "[\"zeroed\"]");
    let law = "[[identify.model]]\nname = \"zeroed\"\nf_x = \"F_0 - D*v_x*abs(v_x)\"\n";
    std::fs::write(&campaign, format!("{own}{law}")).unwrap();
    let (value, [low, high]) = c_d(&json(&["identify", text(&campaign), "--json"]));
    assert!((value / 0.45 - 1.0).abs() < 0.02 && low < 0.45 && 0.45 < high, "{value} [{low}, {high}]");
}

/// No number without area or density, and an area that is not that of the sphere is refused with its place.
#[test]
fn nothing_is_derived_of_what_is_not_known() {
    let folder = tempfile::tempdir().unwrap();
    let none = json(&["identify", text(&tows(folder.path(), "density = \"998 kg/m^3\"", "", 0.0)), "--json"]);
    assert!(none["estimates"][0]["derived"].get("C_D").is_none(), "{none}");
    let body = format!("{BODY}reference_area = \"78.5 mm^2\"\n");
    let said = refusal(&["identify", text(&tows(folder.path(), "density = \"998 kg/m^3\"", &body, 0.0))]);
    assert!(said.contains("c.toml:8:18") && said.contains("has 7.8540e-3 m^2: correct one of them"), "{said}");
    let said = refusal(&["identify", text(&tows(folder.path(), "", "shape = \"ball\"", 0.0))]);
    assert!(said.contains("sphere, cylinder, plate"), "{said}");
}
