//! What the keys of `[identify]` do to coefficients whose answer is known.

use std::fmt::Write as _;
use std::path::Path;

use froude_identify::IdentifyError;
use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::{Coefficient, Status};

const HEAD: &str = "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n";
const SOURCE: &str = "[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n";

/// A source's result for a campaign over the table `t.csv` in the folder.
fn run(folder: &Path, campaign: &str) -> Result<SourceResult, IdentifyError> {
    std::fs::write(folder.join("c.toml"), campaign).unwrap();
    let campaign = read_campaign(&folder.join("c.toml")).unwrap();
    identify_source(&campaign, &campaign.sources[0], &|_| {})
}

fn identify(table: &str, campaign: &str) -> SourceResult {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    run(folder.path(), &format!("{HEAD}{campaign}")).unwrap()
}

fn value(c: &Coefficient) -> f64 {
    c.value.unwrap()
}

/// f_x = −2 v − 10 v|v| and a ripple of 0.01 N, at ten speeds.
fn table() -> String {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for (k, sign) in [1, -1, 0, 1, -1, -1, 1, 0, -1, 1].into_iter().enumerate() {
        let v = 0.1 * (k + 1) as f64;
        writeln!(table, "{v},{}", -2.0 * v - 10.0 * v * v + 0.01 * f64::from(sign)).unwrap();
    }
    table
}

#[test]
fn a_prior_counts_by_its_uncertainty() {
    let with = |standard: &str, model: &str| {
        let prior = format!(
            "[[identify.prior]]\ncoefficient = \"D_x_II\"\nvalue = \"12 kg/m\"\nstandard_uncertainty = \"{standard}\"\n{model}"
        );
        let r = identify(&table(), &format!("{SOURCE}models = [\"linear_quadratic\"]\n{prior}"));
        let is_told = r.findings.iter().any(|f| f.code == "prior-contradicted");
        assert_eq!(is_told, standard.starts_with("1e-6") && model.is_empty(), "{:?}", r.findings);
        value(&r.estimates[0].coefficients["D_x_II"])
    };
    let free = with("1e6 kg/m", "");
    assert!((with("1e-6 kg/m", "") - 12.0).abs() < 1e-6);
    assert!((free - 10.0).abs() < 0.1, "{free}");
    // A prior of another model is not this one's.
    assert!((with("1e-6 kg/m", "model = \"quadratic\"\n") - free).abs() < 1e-6);
}

#[test]
fn a_fixed_coefficient_is_exact_and_the_others_are_fitted_around_it() {
    let r = identify(
        &table(),
        &format!("{SOURCE}models = [\"linear_quadratic\"]\n[identify]\nfixed = {{ D_x_II = \"10 kg/m\" }}\n"),
    );
    let c = &r.estimates[0].coefficients;
    assert_eq!(c["D_x_II"].status, Status::Fixed);
    assert_eq!(c["D_x_II"].value, Some(10.0));
    // One unknown left: Σ v·(−f − 10 v²) / Σ v².
    let (mut top, mut bottom) = (0.0, 0.0);
    for line in table().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let (v, f): (f64, f64) = (cells[0].parse().unwrap(), cells[1].parse().unwrap());
        top += v * (-f - 10.0 * v * v);
        bottom += v * v;
    }
    assert!((value(&c["D_x_I"]) - top / bottom).abs() < 1e-12);
}

#[test]
fn a_bare_table_with_both_axes_gets_a_power_law_each() {
    let mut table = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for speed in [0.2, 0.4, 0.6, 0.8_f64] {
        for angle in [10.0, 30.0, 50.0_f64] {
            let (vx, vy) = (speed * angle.to_radians().cos(), -speed * angle.to_radians().sin());
            writeln!(table, "{speed},{angle},{},{}", -3.0 * vx.powf(1.8), 40.0 * (-vy).powf(2.1)).unwrap();
        }
    }
    let r = identify(&table, SOURCE);
    let law = |name: &str| r.estimates.iter().find(|e| e.law.name == name).unwrap_or_else(|| panic!("no {name}"));
    for (name, axis, k, n) in [("power_law_x", "x", 3.0, 1.8), ("power_law_y", "y", 40.0, 2.1)] {
        let c = &law(name).coefficients;
        assert!((value(&c[&format!("k_{axis}")]) - k).abs() < 1e-9 * k, "{name}: {c:?}");
        assert!((value(&c[&format!("n_{axis}")]) - n).abs() < 1e-9, "{name}: {c:?}");
    }
}

#[test]
fn a_calibration_error_moves_the_factor_of_a_log_law_and_not_its_exponent() {
    let budget = "[[source.uncertainty]]\nquantity = \"f_x\"\nstandard = \"1 %\"\nshared = \"campaign\"\n";
    let r = identify(&table(), &format!("{SOURCE}models = [\"power_law_log\"]\n{budget}"));
    let c = &r.estimates[0].coefficients;
    let k = &c["k_x"];
    assert!((k.type_b.unwrap() - 0.01 * value(k)).abs() < 1e-9 * value(k), "{k:?}");
    assert!(c["n_x"].type_b.unwrap() < 1e-12, "{:?}", c["n_x"]);
}

/// Truth of the simulated f4 tables.
const F4: &str = "C_f_I = 0.01\nC_d_I = 0.06\nC_f_II = 0.0133\nC_d_II = 1.4272\nC_fHT_I = 0.0148\nC_dHT_I = 0.1769\n\
                  C_fHT_II = 0.2451\nC_dHT_II = 1.177\nC_XY_I = 0.0351\nC_XY_II = 0.4612\n";

/// A campaign whose table is simulated from f4 at angles from 6° to 90°: at 0° the head's drag has a kink, and the folder it lies in.
fn f4_campaign(kind: &str, source: &str, identify: &str, simulate: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let plan = "[[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\", \"H4LT\"]\n\
                speed = [\"0.2 m/s\", \"0.4 m/s\", \"0.6 m/s\", \"0.8 m/s\"]\n\
                angle = { start = \"6 deg\", stop = \"90 deg\", step = \"6 deg\" }\n";
    let text = format!(
        "{HEAD}[body]\nlink = {{ major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }}\n\
         head_side_area = \"0.011 m^2\"\ntail_side_area = \"0.008 m^2\"\n\
         [[source]]\nname = \"s\"\nkind = \"{kind}\"\ntable = \"t.csv\"\n{source}{plan}[identify]\nmodels = [\"f4\"]\n{identify}\
         [simulate]\nseed = 3\nmodel = \"f4\"\n{simulate}[simulate.coefficients]\n{F4}"
    );
    std::fs::write(folder.path().join("c.toml"), &text).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    let mut data = froude_identify::simulate::observations(&campaign, &campaign.sources[0], 0).unwrap();
    data.setup = vec!["mount".to_owned(); data.rows].into();
    let table = froude_identify::simulate::table(&data, &campaign.sources[0]).unwrap();
    froude_records::table_file::prepare_table(&table, &folder.path().join("t.csv")).unwrap().take_place().unwrap();
    (folder, text)
}

/// The table with every angle turned by so many degrees; speeds and loads stay.
fn turned(table: &str, by_deg: f64) -> String {
    let mut lines = table.lines();
    let head = lines.next().unwrap();
    let place = head.split(',').position(|c| c.starts_with("angle")).unwrap_or_else(|| panic!("{head}"));
    let scale = if head.split(',').nth(place).unwrap().contains("deg") { 1.0 } else { 1_f64.to_radians() };
    let mut out = format!("{head}\n");
    for line in lines {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let angle: f64 = cells[place].parse().unwrap();
        cells[place] = (angle + by_deg * scale).to_string();
        out += &(cells.join(",") + "\n");
    }
    out
}

#[test]
fn an_angle_error_moves_the_coefficients_as_its_budget_says_broadside_included() {
    let budget = "[[source.uncertainty]]\nquantity = \"angle\"\nstandard = \"0.1 deg\"\nshared = \"campaign\"\n";
    let (folder, campaign) = f4_campaign("tank", budget, "", "");
    let stated = run(folder.path(), &campaign).unwrap();
    let path = folder.path().join("t.csv");
    let table = std::fs::read_to_string(&path).unwrap();
    // Turned backwards, so that broadside stays on its own side: 89.9°.
    std::fs::write(&path, turned(&table, -0.1)).unwrap();
    let moved = run(folder.path(), &campaign).unwrap();
    for (name, c) in &stated.estimates[0].coefficients {
        let change = (value(&moved.estimates[0].coefficients[name]) - value(c)).abs();
        let type_b = c.type_b.unwrap();
        assert!((change - type_b).abs() < 0.05 * type_b + 1e-5, "{name}: moved by {change}, the budget says {type_b}");
    }
}

#[test]
fn a_known_angle_offset_may_be_fixed() {
    let identify = "angle_offset = \"estimate\"\nfixed = { angle_offset_mount = \"1 deg\" }\n";
    let (folder, campaign) = f4_campaign("tank", "", identify, "misalignment = \"1 deg\"\n");
    let r = run(folder.path(), &campaign).unwrap();
    let c = &r.estimates[0].coefficients;
    assert_eq!(c["angle_offset_mount"].status, Status::Fixed);
    for (name, truth) in [("C_XY_II", 0.4612), ("C_d_II", 1.4272), ("C_fHT_II", 0.2451)] {
        assert!((value(&c[name]) - truth).abs() < 1e-4, "{name}: {:?}, truth {truth}", c[name]);
    }
}

#[test]
fn a_prior_on_the_angle_offset_decides_where_one_sign_of_the_angle_cannot() {
    let identify = "angle_offset = \"estimate\"\n[[identify.prior]]\ncoefficient = \"angle_offset_mount\"\nvalue = \"1 deg\"\n\
                    standard_uncertainty = \"0.001 deg\"\n";
    let (folder, campaign) = f4_campaign("tank", "", identify, "misalignment = \"1 deg\"\n");
    let r = run(folder.path(), &campaign).unwrap();
    let c = &r.estimates[0].coefficients;
    assert!((value(&c["angle_offset_mount"]) - 1_f64.to_radians()).abs() < 1e-5, "{:?}", c["angle_offset_mount"]);
    assert!((value(&c["C_XY_II"]) - 0.4612).abs() < 1e-3, "{:?}", c["C_XY_II"]);
}

#[test]
fn errors_in_speed_and_angle_are_fitted_at_broadside_too_and_counted_once() {
    let budget = "[[source.uncertainty]]\nquantity = \"speed\"\nstandard = \"0.002 m/s\"\nshared = \"sample\"\n\
                  [[source.uncertainty]]\nquantity = \"angle\"\nstandard = \"0.3 deg\"\nshared = \"sample\"\n";
    let noise = "[[simulate.sensor]]\nquantity = \"f_x\"\nnoise = \"0.01 N\"\n[[simulate.sensor]]\nquantity = \"f_y\"\nnoise = \"0.01 N\"\n";
    for kind in ["tank", "cfd"] {
        let choices = "errors_in_variables = true\ncovariance = \"classical\"\n";
        let (folder, campaign) = f4_campaign(kind, budget, choices, "");
        // The sensors come last, after the truth.
        let campaign = format!("{campaign}{noise}");
        std::fs::write(folder.path().join("c.toml"), &campaign).unwrap();
        let with_noise = read_campaign(&folder.path().join("c.toml")).unwrap();
        let data = froude_identify::simulate::observations(&with_noise, &with_noise.sources[0], 0).unwrap();
        let table = froude_identify::simulate::table(&data, &with_noise.sources[0]).unwrap();
        froude_records::table_file::prepare_table(&table, &folder.path().join("t.csv")).unwrap().take_place().unwrap();
        let r = run(folder.path(), &campaign).unwrap();
        let e = &r.estimates[0];
        for line in F4.lines() {
            let (name, truth) = line.split_once(" = ").unwrap();
            let c = &e.coefficients[name];
            let u = c.standard_uncertainty.unwrap();
            assert!((value(c) - truth.parse::<f64>().unwrap()).abs() < 4.5 * u, "{kind}, {name}: {c:?}, truth {truth}");
            assert!(u < 0.2, "{kind}, {name}: {c:?}");
            // Row errors of the inputs are in the regression's covariance; they are not added again.
            assert_eq!(c.type_b, Some(0.0), "{kind}, {name}");
        }
    }
}

#[test]
fn speeds_that_differ_in_the_last_digits_are_repeats() {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    let mut noise = [3, -2, -1, 0, 4, -3, -4, 1, 2, 2, -3, 0, -1, 3, -2, 1, -4, 4].into_iter();
    for k in 1..=6 {
        for wobble in [-2e-4, 0.0, 3e-4] {
            let v = 0.1 * f64::from(k) * (1.0 + wobble);
            writeln!(table, "{v},{}", -10.0 * v * v + 0.003 * f64::from(noise.next().unwrap())).unwrap();
        }
    }
    let r = identify(&table, &format!("{SOURCE}models = [\"quadratic\"]\n"));
    assert!(!r.findings.iter().any(|f| f.code == "no-repeats"), "{:?}", r.findings);
    assert!(r.estimates[0].diagnostics.lack_of_fit_p["f_x"] > 0.01, "{:?}", r.estimates[0].diagnostics);
    // A sweep of steps of 1 % of its largest has none.
    let sweep: String = (1..=100).map(|k| format!("{},{}\n", 0.01 * f64::from(k), -0.001 * f64::from(k * k))).collect();
    let r = identify(&format!("speed [m/s],f_x [N]\n{sweep}"), &format!("{SOURCE}models = [\"quadratic\"]\n"));
    assert!(r.findings.iter().any(|f| f.code == "no-repeats"), "{:?}", r.findings);
}

#[test]
fn the_relative_residual_of_the_power_law_is_that_of_its_loads() {
    let r = identify(&table(), &format!("{SOURCE}models = [\"power_law\", \"power_law_log\"]\n"));
    for e in &r.estimates {
        let (k, n) = (value(&e.coefficients["k_x"]), value(&e.coefficients["n_x"]));
        let (mut top, mut bottom) = (0.0, 0.0);
        for line in table().lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let (v, f): (f64, f64) = (cells[0].parse().unwrap(), cells[1].parse().unwrap());
            top += (f + k * v.powf(n)).powi(2);
            bottom += f * f;
        }
        let found = e.diagnostics.relative_residual["f_x"];
        assert!((found - (top / bottom).sqrt()).abs() < 1e-9, "{}: {found}", e.law.name);
    }
}

#[test]
fn fits_of_loads_and_of_logarithms_are_judged_by_one_likelihood() {
    // A relative error of 3 % stated in a column: in both fits every point has the same probability, to first order.
    let mut table = "speed [m/s],f_x [N],std_f_x [N]\n".to_owned();
    for k in 1..=40 {
        let v = 0.05 * f64::from(k);
        let f = 20.0 * v.powf(1.8) * (1.0 + 0.03 * (f64::from(k) * 2.4).sin());
        writeln!(table, "{v},{},{}", -f, 0.03 * f).unwrap();
    }
    let r = identify(&table, &format!("{SOURCE}models = [\"power_law\", \"power_law_log\"]\n"));
    let aicc = |k: usize| r.estimates[k].diagnostics.aicc.unwrap();
    assert!((aicc(0) - aicc(1)).abs() < 2.0, "{} and {}", aicc(0), aicc(1));
}

#[test]
fn units_that_were_mixed_up_are_suspected_for_any_law() {
    let body = "[body]\nreference_area = \"0.002827 m^2\"\n";
    let source = format!("{body}{SOURCE}models = [\"power_law\"]\n");
    let codes =
        |table: &str| -> Vec<String> { identify(table, &source).findings.iter().map(|f| f.code.to_string()).collect() };
    let rows = |speed: f64, load: f64| -> String {
        (1..=6).map(|k| format!("{},{}\n", speed * f64::from(k), -load * f64::from(k * k))).collect()
    };
    let has = |codes: &[String], code: &str| codes.iter().any(|c| c == code);
    let right = codes(&format!("speed [cm/s],f_x [gf]\n{}", rows(10.0, 0.8)));
    assert!(!has(&right, "unphysical-drag-coefficient") && !has(&right, "implausible-speed"), "{right:?}");
    assert!(has(&codes(&format!("speed [cm/s],f_x [N]\n{}", rows(10.0, 0.8))), "unphysical-drag-coefficient"));
    assert!(has(&codes(&format!("speed [m/s],f_x [gf]\n{}", rows(10.0, 0.8))), "implausible-speed"));
}

#[test]
fn a_drag_term_that_pushes_is_reported() {
    let rows: String =
        (2..=9).map(|k| format!("{},{}\n", 0.1 * f64::from(k), -0.1 * f64::from(k * k) + 0.2 * f64::from(k))).collect();
    let r = identify(&format!("speed [m/s],f_x [N]\n{rows}"), &format!("{SOURCE}models = [\"linear_quadratic\"]\n"));
    let finding = r.findings.iter().find(|f| f.code == "negative-drag").expect("a finding");
    assert!(finding.message.contains("D_x_I = -2.0000 kg/s is below zero"), "{}", finding.message);
}

#[test]
fn a_side_force_is_not_held_against_the_frontal_area() {
    // A torpedo of 0.6 m and 60 mm at broadside: C = 1.1 on its side area is 14 on its frontal area.
    let body = "[body]\nreference_area = \"0.002827 m^2\"\n";
    let rows: String = (1..=6)
        .map(|k| 0.1 * f64::from(k))
        .map(|u| format!("{u},90,{},{}\n", -0.001 * u * u, 0.5 * 1000.0 * 0.036 * 1.1 * u * u))
        .collect();
    let table = format!("speed [m/s],angle [deg],f_x [N],f_y [N]\n{rows}");
    let r = identify(&table, &format!("{body}{SOURCE}models = [\"quadratic\"]\n"));
    assert!(!r.findings.iter().any(|f| f.code == "unphysical-drag-coefficient"), "{:?}", r.findings);
}

/// −5 v of drag that pushes is held at zero, and takes D_x_II out of the interval that it has beside −5 v: that interval is not printed with the other value.
#[test]
fn a_value_that_bounds_move_has_no_interval_of_another_value() {
    let mut rows = "speed [m/s],f_x [N]\n".to_owned();
    for (k, sign) in [1, -1, 0, 1, -1, -1, 1, 0, -1, 1].into_iter().enumerate() {
        let v = 0.1 * (k + 1) as f64;
        writeln!(rows, "{v},{}", 5.0 * v - 20.0 * v * v + 0.05 * f64::from(sign)).unwrap();
    }
    let campaign =
        format!("{SOURCE}models = [\"linear_quadratic\"]\n[identify]\nbounds = {{ D_x_I = \"non-negative\" }}\n");
    let found = identify(&rows, &campaign);
    let [linear, square] = ["D_x_I", "D_x_II"].map(|name| found.estimates[0].coefficients[name].clone());
    assert_eq!((linear.value, linear.status, linear.interval_95), (Some(0.0), Status::BoundContradicted, None));
    assert!(square.value.unwrap() < 15.0 && square.interval_95.is_none(), "{square:?}");
    let said = found.findings.iter().find(|f| f.code == "moved-by-bounds").unwrap();
    assert!(said.message.contains("move D_x_II out of the interval"), "{}", said.message);
    // Without bounds there is one.
    let free = identify(&rows, &format!("{SOURCE}models = [\"linear_quadratic\"]\n"));
    let [low, high] = free.estimates[0].coefficients["D_x_II"].interval_95.unwrap();
    assert!(low < 20.0 && 20.0 < high && !free.findings.iter().any(|f| f.code == "moved-by-bounds"));
}

/// Inertia and drag cancel near 0.78 m/s of a body that slows down: these rows are small by the law, and in no other unit. Rows in gram-force are refused all the same.
#[test]
fn rows_in_which_inertia_and_drag_cancel_are_not_taken_for_another_unit() {
    let folder = tempfile::tempdir().unwrap();
    let law = "[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\n[[identify.model]]\nname = \"free\"\nf_x = \"-A*v_x_dot - X_uu*v_x*abs(v_x)\"\n";
    std::fs::write(folder.path().join("c.toml"), format!("{HEAD}{law}")).unwrap();
    let found = |has_gram_force: bool| {
        let mut table = "v_x [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
        let mut row = 0;
        for a in [-0.3, 0.1, 0.4] {
            for repeat in 0..3 {
                for k in 0..6 {
                    let v = 0.781 + 0.3 * f64::from(k);
                    let error = 0.02 * f64::from((row * 7 + repeat) % 5 - 2);
                    let by = if has_gram_force && a > 0.0 && row % 2 == 1 { 101.97 } else { 1.0 };
                    let _ = writeln!(table, "{v},{a},{}", by * (-30.0 * a - 15.0 * v * v + error));
                    row += 1;
                }
            }
        }
        std::fs::write(folder.path().join("t.csv"), table).unwrap();
        let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
        identify_source(&campaign, &campaign.sources[0], &|_| {}).map_err(|e| e.to_string())
    };
    let sound = found(false).unwrap();
    assert!((sound.estimates[0].coefficients["A"].value.unwrap() / 30.0 - 1.0).abs() < 0.01);
    let said = found(true).err().unwrap();
    assert!(said.contains("gram-force") && said.contains("configuration"), "{said}");
}
