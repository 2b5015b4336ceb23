//! `froude new`: every campaign that it writes runs on data of its kind, as it is.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use froude::records::starter::kinds;

use crate::student_tank::Tank;
use crate::tank::froude;

/// Starts a campaign, puts data into its folder and runs each line, where every truth is among the coefficients of the record within 2 %.
fn run(kind: &str, data: impl Fn(&Path), lines: &[&[&str]], truths: &[(&str, f64)]) {
    let folder = tempfile::tempdir().unwrap();
    let output = froude(folder.path(), &["new", kind, "--out", "lab"]);
    assert_eq!(output.status.code(), Some(0), "{kind}: {}", String::from_utf8_lossy(&output.stderr));
    let lab = folder.path().join("lab");
    data(&lab);
    for line in lines {
        let output = froude(&lab, line);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{kind}: froude {}: {error}", line.join(" "));
    }
    for (name, truth) in truths {
        let text = std::fs::read_to_string(lab.join("campaign-results/estimate.json")).unwrap();
        let record: serde_json::Value = serde_json::from_str(&text).unwrap();
        let estimates = record["estimates"].as_array().unwrap();
        let value = estimates.iter().find_map(|e| e["coefficients"][name]["value"].as_f64()).unwrap();
        assert!((value / truth - 1.0).abs() < 0.02, "{kind}: {name} is {value}, and {truth} was put in");
    }
}

const INSPECT: &[&str] = &["inspect", "campaign.toml"];
const IDENTIFY: &[&str] = &["identify", "campaign.toml"];

/// Numbers that look like noise, between −1 and 1.
fn noise(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

fn table(lab: &Path) {
    let mut noise = noise(1);
    let mut text = "speed [m/s],f_x [N]\n".to_owned();
    for i in 1..=10 {
        let speed = 0.1 * f64::from(i);
        writeln!(text, "{speed},{}", -3.0 * speed * speed + 0.005 * noise()).unwrap();
    }
    std::fs::write(lab.join("table.csv"), text).unwrap();
}

fn drift(lab: &Path) {
    let mut noise = noise(2);
    let mut text = "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]\n".to_owned();
    for speed in [0.5, 1.0, 1.5] {
        for degrees in [-12.0, -6.0, 0.0, 6.0, 12.0_f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (u, v) = (speed * cos, -speed * sin);
            let loads = [-4.0 * u * u, -28.0 * u * v - 115.0 * v * v.abs(), -14.0 * u * v];
            let [x, y, n] = loads.map(|load| load + 0.02 * noise());
            writeln!(text, "{speed},{degrees},{x},{y},{n}").unwrap();
        }
    }
    std::fs::write(lab.join("drift.csv"), text).unwrap();
}

/// M + A 20 kg, D_I 2 kg/s, D_II 15 kg/m, C 180 N/m, released from 0.1 m.
fn decay(lab: &Path) {
    std::fs::create_dir(lab.join("releases")).unwrap();
    for run in 1..=3_u32 {
        let mut noise = noise(run);
        let (mut q, mut v) = (0.1, 0.0_f64);
        let mut text = "time [s],position [m]\n".to_owned();
        for i in 0..2000 {
            writeln!(text, "{},{}", f64::from(i) * 0.01, q + 1e-4 * noise()).unwrap();
            for _ in 0..10 {
                v += -0.001 * (180.0 * q + 2.0 * v + 15.0 * v * v.abs()) / 20.0;
                q += 0.001 * v;
            }
        }
        std::fs::write(lab.join(format!("releases/run_{run}.csv")), text).unwrap();
    }
}

/// −3 N s²/m² of the water; the cell shows the force of the rig.
fn steady(lab: &Path) {
    let sidecar = std::fs::read_to_string(lab.join("runs/run_01.toml")).unwrap();
    for run in 1..=6_u32 {
        let (speed, mut noise) = (0.2 * f64::from(run), noise(run));
        let mut text = "t,v,fx\n".to_owned();
        for i in 0..1000 {
            let time = f64::from(i) * 0.02;
            let v = speed * ((time - 4.0) / 1.0).clamp(0.0, 1.0) * ((17.0 - time) / 1.0).clamp(0.0, 1.0);
            writeln!(text, "{time},{},{}", v + 1e-5 * noise(), 3.0 * v * v + 0.01 * noise()).unwrap();
        }
        std::fs::write(lab.join(format!("runs/run_{run:02}.csv")), text).unwrap();
        std::fs::write(lab.join(format!("runs/run_{run:02}.toml")), &sidecar).unwrap();
    }
}

/// Loads over the density along a mesh whose x is the flow's and whose z is up.
fn openfoam(lab: &Path) {
    for speed in [1.0, 2.0] {
        for degrees in [0, 5, 10] {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let (u, v) = (speed * cos, -speed * sin);
            let place = lab.join(format!("cases/U{speed}_b{degrees}/postProcessing/forces/0"));
            std::fs::create_dir_all(&place).unwrap();
            let mut noise = noise(degrees);
            for (file, title, x, y, z) in [
                ("force.dat", "Force", 4.0 * u * u, -28.0 * u * v - 115.0 * v * v.abs(), 0.0),
                ("moment.dat", "Moment", 0.0, 0.0, 14.0 * u * v),
            ] {
                let mut text = format!(
                    "# {title}\n# CofR : (0 0 0)\n# Time (total_x total_y total_z) (pressure_x pressure_y pressure_z) (viscous_x viscous_y viscous_z)\n"
                );
                for i in 1..=200 {
                    let now = [x, y, z].map(|load| load * (1.0 + 1e-3 * noise()) / 998.0);
                    let three = now.map(|load| format!("{load:.8e}")).join(" ");
                    writeln!(text, "{i} ({three}) ({three}) (0 0 0)").unwrap();
                }
                std::fs::write(place.join(file), text).unwrap();
            }
        }
    }
}

/// An octahedron of 1 m, in mm.
fn mesh(lab: &Path) {
    let tips = [[500, 0, 0], [-500, 0, 0], [0, 500, 0], [0, -500, 0], [0, 0, 500], [0, 0, -500]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let mut text = "solid hull\n".to_owned();
    for face in faces {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in face {
            let [x, y, z]: [i32; 3] = tips[corner];
            writeln!(text, "vertex {x} {y} {z}").unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    std::fs::write(lab.join("hull.stl"), text + "endsolid hull\n").unwrap();
}

/// 0.0049 kg m², 0.010 N m s, 0.020 N m and gravity of 0.20 N m, at 0.35 N m/A.
fn servo(lab: &Path) {
    std::fs::create_dir(lab.join("logs")).unwrap();
    for log in 1..=5_u32 {
        let mut noise = noise(log);
        let mut text = "time [s],angle [rad],current [A]\n".to_owned();
        for i in 0..2400 {
            let time = f64::from(i) * 0.005;
            let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
            for (amplitude, hertz) in [(0.5, 0.3), (0.3, 0.7), (0.1, 1.7)] {
                let (omega, phase) = (TAU * hertz, f64::from(log));
                x += amplitude * (omega * time + phase).sin();
                v += amplitude * omega * (omega * time + phase).cos();
                a -= amplitude * omega * omega * (omega * time + phase).sin();
            }
            let torque = 0.0049 * a + 0.010 * v + 0.020 * f64::signum(v) + 0.20 * f64::sin(x);
            writeln!(text, "{time:.3},{},{}", x + 1e-6 * noise(), torque / 0.35 + 1e-3 * noise()).unwrap();
        }
        std::fs::write(lab.join(format!("logs/log_{log}.csv")), text).unwrap();
    }
}

/// The cell shows the force of the rig: what moves the 46 kg less what the water does.
fn sway(lab: &Path) {
    let sidecar = std::fs::read_to_string(lab.join("runs/run_01.toml")).unwrap();
    for (run, hertz) in [(1_u32, 0.1), (2, 0.2), (3, 0.3)] {
        let (omega, mut noise) = (TAU * hertz, noise(run));
        let mut text = "t,y,fy,mz\n".to_owned();
        let rows = (7.0 / hertz * 50.0) as u32;
        for i in 0..rows {
            let time = f64::from(i) * 0.02;
            let (y, v, a) = (
                0.08 * (omega * time).sin(),
                0.08 * omega * (omega * time).cos(),
                -0.08 * omega * omega * (omega * time).sin(),
            );
            let (water_n, water_n_m) = (-38.0 * a - 42.0 * v, 1.5 * a - 35.0 * v);
            let (rig_n, rig_n_m) = (46.0 * a - water_n, 46.0 * 0.012 * a - water_n_m);
            writeln!(
                text,
                "{time:.2},{},{},{}",
                1e3 * y + 0.05 * noise(),
                rig_n + 0.05 * noise(),
                rig_n_m + 0.02 * noise()
            )
            .unwrap();
        }
        std::fs::write(lab.join(format!("runs/run_{run:02}.csv")), text).unwrap();
        std::fs::write(lab.join(format!("runs/run_{run:02}.toml")), &sidecar).unwrap();
    }
}

#[test]
fn every_campaign_runs_as_it_is_written() {
    let check: &[&str] = &["run", "campaign.toml", "--check"];
    for kind in kinds() {
        match kind {
            "table" => run(kind, table, &[INSPECT, IDENTIFY], &[("D_x_II", 3.0)]),
            "drift" => run(kind, drift, &[INSPECT, IDENTIFY], &[("D_x_II", 4.0), ("Y_uv", -28.0), ("N_uv", -14.0)]),
            "decay" => run(kind, decay, &[INSPECT, IDENTIFY], &[("A33", 8.0), ("D_z_II", 15.0)]),
            "steady" => run(kind, steady, &[INSPECT, IDENTIFY], &[("D_x_II", 3.0)]),
            "carriage" => run(kind, |_| {}, &[INSPECT, check], &[]),
            // What it gives is in the story of the student's tank.
            "carriage-logs" => {
                let lines: [&[&str]; 4] = [INSPECT, &["inspect", "logs"], &["carriage", "drag", "logs"], IDENTIFY];
                run(kind, |lab| Tank::default().write(lab), &lines, &[]);
            }
            "openfoam" => {
                let lines: [&[&str]; 3] = [&["inspect", "cases"], INSPECT, IDENTIFY];
                run(kind, openfoam, &lines, &[("D_x_II", 4.0), ("Y_uv", -28.0), ("N_uv", -14.0)]);
            }
            "mesh" => run(kind, mesh, &[INSPECT, &["added-mass", "hull.stl", "--unit", "mm", "--check"]], &[]),
            "servo" => {
                let lines: [&[&str]; 3] = [&["inspect", "logs/log_1.csv"], INSPECT, IDENTIFY];
                run(kind, servo, &lines, &[("J", 0.0049), ("m_g_l", 0.2)]);
            }
            "sway" => run(kind, sway, &[INSPECT, IDENTIFY], &[("Y_v_dot", -38.0), ("N_v", -35.0)]),
            other => panic!("no data for froude new {other}"),
        }
    }
}

#[test]
fn a_file_that_is_there_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("campaign.toml"), "mine").unwrap();
    let output = froude(folder.path(), &["new", "decay"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&output.stderr).trim_end(),
        "froude: ./campaign.toml exists and is not replaced; name another folder: froude new decay --out DIR"
    );
    assert_eq!(std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap(), "mine");
}
