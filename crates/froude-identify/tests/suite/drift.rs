//! Tables of a hull at drift: the default laws include lift and the Munk moment, and lack of fit is reported if a law omits them.

use std::fmt::Write as _;

use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::Coefficient;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const X_UU: f64 = -4.2;
const Y_V: f64 = -6.0;
const Y_UV: f64 = -28.0;
const Y_VV: f64 = -115.0;
const N_V: f64 = -1.5;
const N_UV: f64 = -14.0;

/// One row a setting, and what a campaign has beside its source.
fn found(speeds: &[f64], angles_deg: &[f64], keys: &str) -> SourceResult {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64::new(13, 0);
    let mut noise = |standard: f64| -> f64 {
        let z: f64 = StandardNormal.sample(&mut rng);
        standard * z
    };
    let mut text = "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]\n".to_owned();
    for speed in speeds {
        for angle in angles_deg {
            let (sin, cos) = angle.to_radians().sin_cos();
            let (u, v) = (speed * cos, -speed * sin);
            let x = X_UU * u * u.abs() + noise(0.02);
            let y = Y_V * v + Y_UV * u * v + Y_VV * v * v.abs() + noise(0.05);
            let n = N_V * v + N_UV * u * v + noise(0.02);
            writeln!(text, "{speed},{angle},{x},{y},{n}").unwrap();
        }
    }
    std::fs::write(folder.path().join("t.csv"), text).unwrap();
    let campaign =
        format!("schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{keys}");
    std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap()
}

fn recommended<'a>(of: &'a SourceResult, name: &str) -> &'a Coefficient {
    &of.estimates.iter().find(|e| e.recommended).unwrap().coefficients[name]
}

fn codes(of: &SourceResult) -> Vec<&str> {
    of.findings.iter().map(|f| f.code.as_str()).collect()
}

const SPEEDS: [f64; 6] = [0.5, 0.8, 1.1, 1.4, 1.7, 2.0];
const ANGLES: [f64; 5] = [-12.0, -6.0, 0.0, 6.0, 12.0];

#[test]
fn default_laws_include_lift() {
    let found = found(&SPEEDS, &ANGLES, "");
    let truths = [("D_x_II", -X_UU), ("D_y_I", -Y_V), ("D_y_II", -Y_VV), ("Y_uv", Y_UV), ("N_v", N_V), ("N_uv", N_UV)];
    for (name, truth) in truths {
        let [low, high] = recommended(&found, name).range_95.unwrap();
        assert!(low <= truth && truth <= high && high - low < 0.5 * truth.abs(), "{name}: {low} to {high}, {truth}");
    }
    assert!(!codes(&found).iter().any(|code| matches!(*code, "lack-of-fit" | "one-drift")), "{:?}", codes(&found));
}

/// No setting is repeated; the residuals of a law without lift correlate with u·v.
#[test]
fn lack_of_fit_finds_missing_lift_without_repeats() {
    let without = |law: &str| {
        let keys = format!("[[identify.model]]\nname = \"own\"\nf_y = \"{law}\"\n");
        let found = found(&SPEEDS, &ANGLES, &keys);
        found.findings.iter().filter(|f| f.code == "lack-of-fit").map(|f| f.message.clone()).collect::<Vec<_>>()
    };
    let said = without("Y_v*v + Y_vv*v*abs(v)");
    assert!(said.len() == 1 && said[0].contains("the residuals correlate with v_x*v_y (p < 0.001)"), "{said:?}");
    assert_eq!(without("Y_v*v + Y_uv*u*v + Y_vv*v*abs(v)"), Vec::<String>::new());
}

/// At one speed v and u·v have one shape: Y_uv stands for both, and a note says so.
#[test]
fn at_one_speed_one_term_stands_for_two() {
    let found = found(&[1.0], &[-12.0, -9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0, 12.0], "");
    let larger = found.estimates.iter().find(|e| e.law.name == "linear_quadratic").unwrap();
    let names: Vec<&str> = larger.coefficients.keys().map(String::as_str).collect();
    assert!(names.contains(&"Y_uv") && !names.contains(&"D_y_I") && !names.contains(&"N_v"), "{names:?}");
    let note = found.findings.iter().find(|f| f.code == "one-drift").unwrap();
    assert!(note.message.contains("Y_uv includes D_y_I; N_uv includes N_v"), "{}", note.message);
    let y_uv = recommended(&found, "Y_uv").value.unwrap();
    assert!((y_uv / (Y_V + Y_UV) - 1.0).abs() < 0.05, "{y_uv}");
}
