//! Tables in time: rows whose errors follow each other.

use std::fmt::Write as _;

use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign_file::read_campaign;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const TRUTH: [(&str, f64); 7] = [
    ("Y_vd", -170.0),
    ("Y_v", -220.0),
    ("Y_r", 60.0),
    ("N_rd", -110.0),
    ("N_v", -130.0),
    ("N_r", -190.0),
    ("N_rr", -60.0),
];

/// Pure sway and pure yaw at two frequencies, 10 Hz, with noise that is correlated over 1 s.
fn planar(seed: u128) -> String {
    let mut rng = Pcg64::new(seed, 16);
    let mut out =
        "time [s],run,v_x [m/s],v_y [m/s],w_z [rad/s],v_y_dot [m/s^2],w_z_dot [rad/s^2],f_y [N],m_z [N m]\n".to_owned();
    let mut start_s = 0.0;
    for (kind, w) in [("sway", 0.4), ("sway", 0.7), ("yaw", 0.4), ("yaw", 0.7_f64)] {
        let keep = (-0.1_f64).exp();
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let scale = 1.0 / (1.0 - keep * keep).sqrt();
        let (mut y, mut n) = (0.35 * scale * normal(), 0.2 * scale * normal());
        let rows = (6.0 * std::f64::consts::TAU / w / 0.1) as usize;
        for i in 0..rows {
            let t = 0.1 * i as f64;
            let (sin, cos) = (w * t).sin_cos();
            let (v, vd, q, qd) = if kind == "sway" {
                (0.16 * sin, 0.16 * w * cos, 0.0, 0.0)
            } else {
                (0.0, 0.0, 0.12 * sin, 0.12 * w * cos)
            };
            y = keep * y + 0.35 * normal();
            n = keep * n + 0.2 * normal();
            let f_y = -170.0 * vd - 220.0 * v + 60.0 * q + y;
            let m_z = -110.0 * qd - 130.0 * v - 190.0 * q - 60.0 * q * q.abs() + n;
            let _ = writeln!(out, "{},{kind}_{w},1.2,{v},{q},{vd},{qd},{f_y},{m_z}", start_s + t);
        }
        start_s += 0.1 * rows as f64 + 60.0;
    }
    out
}

fn found(table: &str, keys: &str) -> SourceResult {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let text = format!(
        "schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\ngroup = \"run\"\n[identify]\n{keys}\
         [[identify.model]]\nname = \"planar\"\nf_y = \"Y_vd*v_y_dot + Y_v*v_y + Y_r*w_z\"\nm_z = \"N_rd*w_z_dot + N_v*v_y + N_r*w_z + N_rr*w_z*abs(w_z)\"\n"
    );
    std::fs::write(folder.path().join("c.toml"), text).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap()
}

/// The advice does not go in circles: rows as if independent, then runs as clusters, then rows by their correlation, and there it ends.
#[test]
fn the_advice_about_rows_in_time_ends() {
    let table = planar(0);
    let said = |keys: &str, code: &str| {
        let findings = found(&table, keys).findings;
        findings.into_iter().find(|f| f.code == code).map(|f| f.message)
    };
    let alike = said("", "serial-correlation").unwrap();
    assert!(alike.contains("covariance = \"serial\""), "{alike}");
    let decides = said("covariance = \"cluster\"\n", "one-group-decides").unwrap();
    assert!(decides.contains("covariance = \"serial\"") && !decides.contains("classical"), "{decides}");
    for code in ["serial-correlation", "one-group-decides", "setup-offset", "uneven-scatter"] {
        assert_eq!(said("covariance = \"serial\"\n", code), None, "{code}");
    }
}

/// Every coefficient has an interval; over 40 seeds at least 93 % contain the truth, within three standard deviations.
#[test]
fn serial_intervals_of_rows_in_time_contain_the_truth() {
    let mut held = [0; 7];
    for seed in 0..40 {
        let of = found(&planar(seed), "covariance = \"serial\"\n");
        for (k, (name, truth)) in TRUTH.iter().enumerate() {
            let [low, high] = of.estimates[0].coefficients[*name].interval_95.expect("an interval");
            held[k] += u32::from(low <= *truth && *truth <= high);
        }
    }
    assert!(held.iter().all(|held| *held >= 32) && held.iter().sum::<u32>() >= 248, "{held:?}");
}
