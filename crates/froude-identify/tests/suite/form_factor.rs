//! Named numbers in a campaign's formulas, and with them the form factor of a hull by Prohaska's method.

use std::fmt::Write as _;
use std::path::Path;

use froude_hydro::similarity::{friction_ittc57, froude, reynolds};
use froude_identify::prediction::of_rows;
use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign::Campaign;
use froude_records::campaign_file::read_campaign;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Model of a hull: length, wetted surface, form factor, wave resistance at Fr = 1 by the fourth power.
const LENGTH_M: f64 = 4.0;
const WETTED_M2: f64 = 3.2;
const ONE_PLUS_K: f64 = 1.22;
const WAVE: f64 = 0.9;
const DENSITY_KG_M3: f64 = 999.1;
const VISCOSITY_M2_S: f64 = 1.138e-6;
/// Scatter of the load cell, N; the drag is 3 to 12 N.
const SCATTER_N: f64 = 0.05;

const LAW: &str = "f_x = \"-0.5*rho*S*u*abs(u)*(one_plus_k*CF_ITTC57(Re) + c_w*Fr^4)\"\n";

fn drag_n(speed_m_s: f64) -> f64 {
    let friction = friction_ittc57(reynolds(speed_m_s, LENGTH_M, VISCOSITY_M2_S)).unwrap();
    let coefficient = ONE_PLUS_K * friction + WAVE * froude(speed_m_s, LENGTH_M).powi(4);
    0.5 * DENSITY_KG_M3 * WETTED_M2 * speed_m_s * speed_m_s * coefficient
}

/// Twelve speeds from Fr 0.1 to 0.2.
fn tows(seed: u128) -> String {
    let mut rng = Pcg64::new(seed, 0);
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..12 {
        let speed = 0.65 + 0.05 * f64::from(i);
        let z: f64 = StandardNormal.sample(&mut rng);
        let _ = writeln!(out, "{speed},{}", SCATTER_N * z - drag_n(speed));
    }
    out
}

fn campaign(folder: &Path, body: &str, constants: &str, law: &str) -> Campaign {
    let text = format!(
        "schema = 1\nname = \"hull\"\n[fluid]\ndensity = \"{DENSITY_KG_M3} kg/m^3\"\nkinematic_viscosity = \"{VISCOSITY_M2_S} m^2/s\"\n\
         {body}{constants}[[source]]\nname = \"tank\"\nkind = \"towing\"\ntable = \"t.csv\"\n\
         [[identify.model]]\nname = \"prohaska\"\n{law}"
    );
    std::fs::write(folder.join("c.toml"), text).unwrap();
    read_campaign(&folder.join("c.toml")).unwrap()
}

const BODY: &str = "[body]\nreference_length = \"4 m\"\n";
const CONSTANTS: &str = "[constants]\nS = \"3.2 m^2\"\n";

fn found(table: &str, body: &str, constants: &str, law: &str) -> Result<SourceResult, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let campaign = campaign(folder.path(), body, constants, law);
    identify_source(&campaign, &campaign.sources[0], &|_| {}).map_err(|e| e.to_string())
}

#[test]
fn the_record_carries_what_the_law_reads() {
    let result = found(&tows(1), BODY, CONSTANTS, LAW).unwrap();
    let estimate = &result.estimates[0];
    let constants: Vec<(&str, f64, &str)> =
        estimate.law.constants.iter().map(|(name, m)| (name.as_str(), m.value, m.unit.as_str())).collect();
    assert_eq!(constants, [("S", 3.2, "m^2"), ("L", 4.0, "m"), ("g", 9.80665, "m/s^2")]);
    assert_eq!(estimate.refers_to["kinematic_viscosity"].value, VISCOSITY_M2_S);
    assert_eq!(estimate.coefficients["one_plus_k"].unit, "1");
    // Neither the campaign nor the water is at hand where the record is used.
    let mut data = result.data.clone();
    data.channels.shift_remove("kinematic_viscosity");
    data.channels.shift_remove("density");
    let found = of_rows(&[estimate], &[estimate], data).unwrap();
    let [one_plus_k, wave] = ["one_plus_k", "c_w"].map(|name| estimate.coefficients[name].value.unwrap());
    for (row, speed) in found.estimates[0].rows.iter().zip(result.data.values("speed").unwrap()) {
        let friction = friction_ittc57(reynolds(*speed, LENGTH_M, VISCOSITY_M2_S)).unwrap();
        let coefficient = one_plus_k * friction + wave * froude(*speed, LENGTH_M).powi(4);
        let drag_n = 0.5 * DENSITY_KG_M3 * WETTED_M2 * speed * speed * coefficient;
        assert!((row.predicted / -drag_n - 1.0).abs() < 1e-12, "{} {drag_n}", row.predicted);
    }
}

/// 95 % intervals of 200 tables contain the form factor in 95 %, within three standard deviations of a count.
#[test]
fn the_interval_of_a_form_factor_holds() {
    const TABLES: u128 = 200;
    let held = (0..TABLES).filter(|&seed| {
        let result = found(&tows(seed), BODY, CONSTANTS, LAW).unwrap();
        let [low, high] = result.estimates[0].coefficients["one_plus_k"].interval_95.unwrap();
        assert!(high - low < 0.2, "{low} {high}");
        (low..=high).contains(&ONE_PLUS_K)
    });
    let held = held.count();
    assert!((181..=199).contains(&held), "{held} of {TABLES}");
}

#[test]
fn a_name_that_means_something_else_already_is_refused() {
    let refused = |body: &str, constants: &str, law: &str| {
        let error = found(&tows(1), body, constants, law).map(drop).unwrap_err();
        error.rsplit_once("c.toml: ").map_or(error.clone(), |(_, what)| what.to_owned())
    };
    let twice = "[constants] L is reference_length of [body], which is declared too: delete one of them";
    assert_eq!(refused(BODY, "[constants]\nL = \"4 m\"\n", LAW), twice);
    assert_eq!(
        refused("", "[constants]\nrho = \"1 t/m^3\"\n", LAW),
        "[constants] rho is density in formulas: rename it"
    );
    assert_eq!(
        refused("", "[constants]\nspeed = \"1 m/s\"\n", LAW),
        "[constants] speed is a column of the table: rename one of them"
    );
    let undeclared = refused(BODY, "", "f_x = \"-0.5*rho*A*u*abs(u)*C_D\"\n");
    assert_eq!(
        undeclared,
        "model \"prohaska\", f_x: the formula is not linear in its coefficients: A*(-0.5*rho*u*abs(u))*C_D multiplies coefficients with each \
         other; A is a coefficient here, and a known number where [body] declares reference_area"
    );
    let area = "[body]\nreference_length = \"4 m\"\nreference_area = \"3.2 m^2\"\n";
    assert!(found(&tows(1), area, "", "f_x = \"-0.5*rho*A*u*abs(u)*C_D\"\n").is_ok());
}

/// At rest there is no friction line.
#[test]
fn a_row_at_rest_is_named() {
    let table = format!("{}0,0.01\n", tows(1));
    let error = found(&table, BODY, CONSTANTS, LAW).map(drop).unwrap_err();
    assert_eq!(
        error,
        "source \"tank\", model prohaska: in line 14, at 0 m/s the factor of one_plus_k in f_x is NaN: a root or logarithm of a negative \
         number, a division by zero, or CF_ITTC57 below Re = 1000; leave the row out with `keep`"
    );
}
