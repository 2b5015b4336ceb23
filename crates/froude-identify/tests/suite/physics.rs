//! From a table to coefficients on made-up observations whose answer is known.

use std::fmt::Write as _;
use std::path::Path;

use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign_file::read_campaign;
use froude_records::estimate::{Coefficient, Estimate, EstimateFile, Status, TypeA};
use froude_records::json::write_estimates;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Runs a campaign of one source over a table.
fn identify(folder: &Path, table: &str, campaign: &str) -> SourceResult {
    std::fs::write(folder.join("t.csv"), table).unwrap();
    let head = "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n";
    std::fs::write(folder.join("c.toml"), format!("{head}{campaign}")).unwrap();
    let campaign = read_campaign(&folder.join("c.toml")).unwrap();
    identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap()
}

const SOURCE: &str = "[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n";
const QUADRATIC: &str = "[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"quadratic\"]\n";

/// f_x = −10 v|v| and a ripple of 0.01 N, at ten speeds.
fn quadratic_table() -> String {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for (k, sign) in [1, -1, 0, 1, -1, -1, 1, 0, -1, 1].into_iter().enumerate() {
        let v = 0.1 * (k + 1) as f64;
        writeln!(table, "{v},{}", -10.0 * v * v + 0.01 * f64::from(sign)).unwrap();
    }
    table
}

fn budget(quantity: &str, standard: &str, shared: &str) -> String {
    format!(
        "{QUADRATIC}[[source.uncertainty]]\nquantity = \"{quantity}\"\nstandard = \"{standard}\"\nshared = \"{shared}\"\n"
    )
}

#[test]
fn a_relative_calibration_error_shared_by_all_does_not_average_down() {
    let folder = tempfile::tempdir().unwrap();
    let result = identify(folder.path(), &quadratic_table(), &budget("f_x", "1 %", "campaign"));
    let c = &result.estimates[0].coefficients["D_x_II"];
    // A gain error of 1 % is 1 % of the coefficient, however many rows share it.
    let expected = 0.01 * c.value.unwrap();
    assert!((c.type_b.unwrap() - expected).abs() < 1e-9 * expected, "{c:?}");
    let combined = c.type_a.unwrap().hypot(c.type_b.unwrap());
    assert!((c.standard_uncertainty.unwrap() - combined).abs() < 1e-12);
}

#[test]
fn a_speed_error_enters_a_quadratic_law_twice() {
    let folder = tempfile::tempdir().unwrap();
    let result = identify(folder.path(), &quadratic_table(), &budget("speed", "1 %", "campaign"));
    let c = &result.estimates[0].coefficients["D_x_II"];
    let expected = 0.02 * c.value.unwrap();
    // Central differences of a quadratic are exact to rounding.
    assert!((c.type_b.unwrap() - expected).abs() < 1e-6 * expected, "{c:?}");
}

#[test]
fn an_error_that_no_two_rows_share_is_part_of_the_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let result = identify(folder.path(), &quadratic_table(), &budget("f_x", "0.01 N", "sample"));
    let c = &result.estimates[0].coefficients["D_x_II"];
    assert_eq!(c.type_b, Some(0.0), "it is in type A already");
}

#[test]
fn identical_copies_are_dropped_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let table = quadratic_table() + "0.55,-3.0\n0.55,-3.0\n0.55,-3.0\n";
    let result = identify(folder.path(), &table, QUADRATIC);
    let copy = result.findings.iter().find(|f| f.code == "identical-copies").unwrap();
    assert_eq!(result.data.rows, 11);
    assert_eq!(
        copy.message,
        "2 of 13 rows are identical copies of earlier ones and are dropped (lines 13 = 12, 14 = 12); real repeats differ in their loads"
    );
}

/// Each of eight speeds twice, the second reading equal to the first; a reading is a whole number of steps, N.
fn doubled(step_n: f64) -> String {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 1..=8 {
        let speed = 0.1 * f64::from(i);
        let load = ((-10.0 * speed * speed + 0.1 * (7.0 * speed).sin()) / step_n).round() * step_n;
        table += &format!("{speed},{load:.6}\n{speed},{load:.6}\n");
    }
    table
}

#[test]
fn equal_repeats_of_a_fine_sensor_are_copies_and_those_of_a_coarse_one_are_not() {
    let rows = |step_n: f64| {
        let folder = tempfile::tempdir().unwrap();
        let result = identify(folder.path(), &doubled(step_n), QUADRATIC);
        (result.data.rows, result.findings.iter().any(|f| f.code == "identical-rows"))
    };
    assert_eq!(rows(1e-5), (8, false));
    assert_eq!(rows(0.25), (16, true));
}

/// Repeats of a sensor of fine steps, in any order and read off text: now and then two are the same, and are kept.
#[test]
fn few_equal_repeats_among_many_that_differ_are_kept_in_any_order() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut kept = 0;
    for _ in 0..40 {
        let mut rows: Vec<String> = Vec::new();
        for i in 0..50 {
            let speed = 0.2 + 0.02 * f64::from(i);
            for _ in 0..2 {
                let noise: f64 = StandardNormal.sample(&mut rng);
                rows.push(format!("{speed:.2},{:.3}", ((-10.0 * speed * speed + 0.002 * noise) * 1e3).round() / 1e3));
            }
        }
        // Strides apart, so that no order helps.
        let order: Vec<&str> = (0..rows.len()).map(|i| rows[i * 37 % rows.len()].as_str()).collect();
        let folder = tempfile::tempdir().unwrap();
        let table = format!("speed [m/s],f_x [N]\n{}\n", order.join("\n"));
        kept += usize::from(identify(folder.path(), &table, QUADRATIC).data.rows == rows.len());
    }
    assert!(kept >= 38, "{kept} of 40");
}

#[test]
fn an_angle_offset_is_found_from_pairs_of_opposite_angle_and_taken_out_of_the_cross_term() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1025 kg/m^3\"\n[body]\n\
         link = {{ major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }}\n\
         head_side_area = \"0.011 m^2\"\ntail_side_area = \"0.008 m^2\"\n{SOURCE}[[source.plan]]\n\
         configurations = [\"H1LT\", \"H2LT\", \"H4LT\"]\nspeed = [\"0.2 m/s\", \"0.4 m/s\", \"0.6 m/s\", \"0.8 m/s\"]\n\
         angle = {{ start = \"-39 deg\", stop = \"39 deg\", step = \"3 deg\" }}\n\
         [identify]\nmodels = [\"f4\"]\nangle_offset = \"estimate\"\n\
         [simulate]\nseed = 3\nmodel = \"f4\"\nmisalignment = \"1 deg\"\n[simulate.coefficients]\nC_f_I = 0.01\nC_d_I = 0.06\n\
         C_f_II = 0.0133\nC_d_II = 1.4272\nC_fHT_I = 0.0148\nC_dHT_I = 0.1769\nC_fHT_II = 0.2451\nC_dHT_II = 1.177\n\
         C_XY_I = 0.0351\nC_XY_II = 0.4612\n[[simulate.sensor]]\nquantity = \"f_x\"\nnoise = \"0.005 N\"\n\
         [[simulate.sensor]]\nquantity = \"f_y\"\nnoise = \"0.005 N\"\n"
    );
    std::fs::write(folder.path().join("c.toml"), text).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    let mut data = froude_identify::simulate::observations(&campaign, &campaign.sources[0], 0).unwrap();
    // The sensor is mounted once: one setup.
    data.setup = vec!["mount".to_owned(); data.rows].into();
    let table = froude_identify::simulate::table(&data, &campaign.sources[0]).unwrap();
    froude_records::table_file::prepare_table(&table, &folder.path().join("t.csv")).unwrap().take_place().unwrap();
    let result = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
    let c = &result.estimates[0].coefficients;
    // One seeded draw: four standard uncertainties hold all but one in 10⁴.
    let holds = |name: &str, truth: f64| {
        let c = &c[name];
        assert!(
            (c.value.unwrap() - truth).abs() < 4.0 * c.standard_uncertainty.unwrap(),
            "{name}: {c:?}, truth {truth}"
        );
    };
    holds("angle_offset_mount", 1_f64.to_radians());
    holds("C_XY_II", 0.4612);
    assert!(c["angle_offset_mount"].standard_uncertainty.unwrap() < 0.1_f64.to_radians());
    assert!(!result.findings.iter().any(|f| f.code == "one-sign-of-angle"));
}

#[test]
fn a_fitted_tare_is_subtracted_with_its_covariance_as_a_shared_error() {
    let folder = tempfile::tempdir().unwrap();
    let first = identify(folder.path(), &quadratic_table(), QUADRATIC);
    let record = froude_records::estimate::EstimateFile::of(first.estimates.clone());
    froude_records::json::write_estimates(&folder.path().join("tare.json"), &record).unwrap();
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for k in 1..=10 {
        let v = 0.1 * f64::from(k);
        writeln!(table, "{v},{}", -15.0 * v * v).unwrap();
    }
    let result = identify(folder.path(), &table, &format!("{QUADRATIC}tare = {{ record = \"tare.json\" }}\n"));
    let c = &result.estimates[0].coefficients["D_x_II"];
    let tare = &first.estimates[0].coefficients["D_x_II"];
    assert!((c.value.unwrap() - (15.0 - tare.value.unwrap())).abs() < 1e-9, "{c:?}");
    let (got, expected) = (c.type_b.unwrap(), tare.standard_uncertainty.unwrap());
    assert!((got - expected).abs() < 1e-9 * expected, "the whole tare uncertainty stays: {got} against {expected}");
}

#[test]
fn a_drag_coefficient_that_no_body_has_is_reported() {
    // The MCD paper prints D_d = 0.0878 N s²/m² for a cylinder of 0.04 m²: C_D = 0.0044.
    let finding = froude_identify::lint::drag_coefficient("D_d", 0.0878, 1000.0, 0.04).unwrap();
    assert!(finding.message.contains("is C_D = 0.0044: no body has such a value"), "{}", finding.message);
    assert!(froude_identify::lint::drag_coefficient("D_d", 20.0, 1000.0, 0.04).is_none());
}

#[test]
fn a_force_along_the_motion_names_the_sign_to_write() {
    let folder = tempfile::tempdir().unwrap();
    let result = identify(folder.path(), &quadratic_table().replace(",-", ","), QUADRATIC);
    let finding = result.findings.iter().find(|f| f.code == "force-along-motion").unwrap();
    assert!(finding.message.contains("write sign = -1 for its column"), "{}", finding.message);
}

#[test]
fn zeros_before_and_after_a_run_are_subtracted_and_their_drift_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "speed [m/s],f_x [N],zero_before_f_x [N],zero_after_f_x [N]\n".to_owned();
    for k in 1..=6 {
        let v = 0.2 * f64::from(k);
        writeln!(table, "{v},{},0.3,0.5", -10.0 * v * v + 0.4).unwrap();
    }
    let result = identify(folder.path(), &table, QUADRATIC);
    let d = result.estimates[0].coefficients["D_x_II"].value.unwrap();
    assert!((d - 10.0).abs() < 1e-9, "{d}");
    let finding = result.findings.iter().find(|f| f.code == "zero-drift").unwrap();
    assert!(finding.message.contains("moved by up to 2.000e-1"), "{}", finding.message);
}

/// The finding of one code, if there is one.
fn finding<'a>(result: &'a SourceResult, code: &str) -> Option<&'a str> {
    result.findings.iter().find(|f| f.code == code).map(|f| f.message.as_str())
}

#[test]
fn a_force_along_the_motion_counts_the_rows_that_are_large_enough_to_tell() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "speed [m/s],f_x [N]\n0.01,-0.001\n0.02,0.004\n".to_owned();
    for k in 1..=10 {
        let v = 0.3 + 0.1 * f64::from(k);
        writeln!(table, "{v},{}", 10.0 * v * v).unwrap();
    }
    let result = identify(folder.path(), &table, QUADRATIC);
    assert_eq!(
        finding(&result, "force-along-motion").unwrap(),
        "f_x points along v_x in 10 of the 10 rows large enough to tell (12 in all): a drag must oppose the motion; if the \
         sensor is mounted the other way round, write sign = -1 for its column, or remove it if it is there; if an actuator \
         exerts it, call the column thrust or write actuator = [\"f_x\"] in [[source]]"
    );
}

#[test]
fn a_wrong_prefix_is_suspected_from_the_area_that_the_force_stands_for() {
    let folder = tempfile::tempdir().unwrap();
    let newtons = identify(folder.path(), &quadratic_table(), QUADRATIC);
    assert_eq!(finding(&newtons, "implausible-drag-area"), None);
    // Numbers in mN under a header that says MN: 9990 mN is 10 N, read as 1e10 N.
    let mut table = "speed [m/s],f_x [MN]\n".to_owned();
    for k in 1..=10 {
        let v = 0.1 * f64::from(k);
        writeln!(table, "{v},{}", -9990.0 * v * v).unwrap();
    }
    let mega = identify(folder.path(), &table, QUADRATIC);
    // 9.99e9 N / (500 kg/m^3 · 1 m²/s²)
    assert_eq!(
        finding(&mega, "implausible-drag-area").unwrap(),
        "line 11: f_x = -9.990e9 N at 1.000 m/s is the drag of 2.0e7 m^2 (|F|/(½ρU²)), more than 1e3 m^2; a loaded \
         tanker has some 50 m^2: a prefix may be wrong in the unit of `f_x [MN]`, or in that of the speed"
    );
    let nano = identify(folder.path(), &quadratic_table().replace("[N]", "[nN]"), QUADRATIC);
    let message = finding(&nano, "implausible-drag-area").unwrap();
    assert!(message.contains("is the drag of 2.0e-11 m^2 (|F|/(½ρU²)), less than 1e-7 m^2"), "{message}");
    // A tanker of 50 m² at 8 m/s is in order.
    let ship = "speed [m/s],f_x [kN]\n4,-400\n6,-900\n8,-1600\n".to_owned();
    assert_eq!(finding(&identify(folder.path(), &ship, QUADRATIC), "implausible-drag-area"), None);
}

#[test]
fn a_zero_that_was_read_once_leaves_its_drift_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "speed [m/s],f_x [N],zero_before_f_x [N]\n".to_owned();
    for k in 1..=6 {
        let v = 0.2 * f64::from(k);
        writeln!(table, "{v},{},0.4", -10.0 * v * v + 0.4).unwrap();
    }
    let result = identify(folder.path(), &table, QUADRATIC);
    let d = result.estimates[0].coefficients["D_x_II"].value.unwrap();
    assert!((d - 10.0).abs() < 1e-9, "{d}");
    assert_eq!(
        finding(&result, "zero-drift").unwrap(),
        "f_x: the zero before each run is subtracted; its drift is unknown, since there is no reading after the run (a \
         column zero_after_f_x)"
    );
}

#[test]
fn a_measured_density_is_used_unless_one_is_stated_and_then_it_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = "speed [m/s],f_x [N],density [kg/m^3],temperature [degC]\n".to_owned();
    for k in 1..=6 {
        let v = 0.2 * f64::from(k);
        writeln!(table, "{v},{},{},15", -10.0 * v * v, 1020 + k).unwrap();
    }
    let result = identify(folder.path(), &table, QUADRATIC);
    assert_eq!(result.data.values("density").unwrap(), [1000.0; 6]);
    assert_eq!(
        finding(&result, "stated-over-measured").unwrap(),
        "density = 1000 kg/m^3 of [fluid] is used for every run, and the table's column density (1021 to 1026 kg/m^3) is \
         not; take density out of [fluid] to use what was measured"
    );
    let bare = format!("schema = 1\nname = \"x\"\n[fluid]\ntemperature = \"20 degC\"\n{QUADRATIC}");
    std::fs::write(folder.path().join("bare.toml"), bare).unwrap();
    let campaign = read_campaign(&folder.path().join("bare.toml")).unwrap();
    let bare = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
    assert_eq!(bare.data.values("density").unwrap(), [1021.0, 1022.0, 1023.0, 1024.0, 1025.0, 1026.0]);
    assert_eq!(finding(&bare, "stated-over-measured"), None);
    assert_eq!(
        finding(&bare, "measured-over-stated").unwrap(),
        "density and viscosity, where they follow from a temperature, use the table's temperatures; temperature = 20.00 degC of \
         [fluid] is not used"
    );
}

#[test]
fn scatter_that_the_std_columns_explain_is_not_uneven() {
    let folder = tempfile::tempdir().unwrap();
    // Sizes without order, so that the rank correlation of size and speed is small: once forwards, once backwards.
    let half = [1.0, -2.0, 0.5, -1.5, 2.5, -0.7, 1.2, -2.2, 0.9, -1.1, 1.9, -0.6];
    let size: Vec<f64> = half.into_iter().chain(half.into_iter().rev().map(|e| -e)).collect();
    let table = |scatter: &dyn Fn(f64) -> f64, std: Option<&dyn Fn(f64) -> f64>| {
        let mut table = "speed [m/s],f_x [N]".to_owned() + if std.is_some() { ",std_f_x [N]\n" } else { "\n" };
        for (k, e) in size.iter().enumerate() {
            let v = 0.2 * (k + 1) as f64;
            write!(table, "{v},{}", -10.0 * v * v + e * scatter(v)).unwrap();
            table += &std.map_or_else(|| "\n".to_owned(), |std| format!(",{}\n", std(v)));
        }
        table
    };
    let (even, growing) = (|_: f64| 0.05, |v: f64| 0.05 * v * v);
    let told = |table: String| {
        let result = identify(folder.path(), &table, QUADRATIC);
        finding(&result, "uneven-scatter").map(str::to_owned)
    };
    assert!(told(table(&growing, None)).unwrap().contains("errors grow with the fitted |f_x|"));
    assert_eq!(told(table(&growing, Some(&growing))), None, "over its std the scatter is even");
    assert_eq!(told(table(&even, None)), None);
    let wrong = told(table(&even, Some(&growing))).unwrap();
    assert!(wrong.contains("errors over their weights fall with the fitted |f_x|"), "{wrong}");
}

/// A slip is named with its run at any speed, also where it makes the scatter look uneven; sound campaigns are accused in one of a hundred.
#[test]
fn a_row_that_the_others_do_not_explain_is_named_and_sound_ones_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let table = |seed: u64, (row, slip): (i32, f64)| {
        let mut noise = Pcg64Mcg::seed_from_u64(seed);
        let mut table = "run,speed [m/s],f_x [N]\n".to_owned();
        for k in 0..16 {
            let v = 0.1 * f64::from(k + 1);
            let error: f64 = StandardNormal.sample(&mut noise);
            let slip = if k == row { slip } else { 0.0 };
            writeln!(table, "A{k},{v},{}", -10.0 * v * v + 0.05 * error + slip).unwrap();
        }
        table
    };
    let identified = |table: &str| identify(folder.path(), table, QUADRATIC);
    for (row, speed) in [(4, "0.5"), (9, "1"), (15, "1.6")] {
        let named = (0..20).filter(|seed| {
            let result = identified(&table(*seed, (row, -1.0)));
            let told = finding(&result, "outlying-row").unwrap_or_default();
            told.starts_with(&format!("quadratic, f_x: line {}, run A{row} ({speed} m/s) lies −", row + 2))
        });
        // In one of twenty the scatter of the others looks uneven by chance: then it is said to be, and no row is named.
        assert!(named.count() >= 16, "{row}");
    }
    // 1 % of 300, and three binomial deviations; a screen that never asks would never find the slips.
    let accused = (0..300).filter(|seed| finding(&identified(&table(*seed, (0, 0.0))), "outlying-row").is_some());
    assert!((1..=8).contains(&accused.count()));
    // A row that alone determines a coefficient has no residual to be judged by.
    let mut alone = "run,speed [m/s],f_x [N]\nB,1,-10.5\n".to_owned();
    for (k, error) in [0.03, -0.05, 0.01, 0.04, -0.02, -0.03, 0.02].into_iter().enumerate() {
        writeln!(alone, "A{k},0.5,{}", -2.5 + error).unwrap();
    }
    let both = QUADRATIC.replace("quadratic", "linear_quadratic");
    assert_eq!(finding(&identify(folder.path(), &alone, &both), "outlying-row"), None);
}

/// A body that is towed and accelerated: its drag, its mass, and a force that goes with the sway acceleration.
fn accelerated() -> (String, Vec<[f64; 3]>) {
    let mut table = "v_x [m/s],v_y [m/s],v_x_dot [m/s^2],v_y_dot [m/s^2],f_x [N]\n".to_owned();
    let mut rows = Vec::new();
    for i in 0..24 {
        let t = f64::from(i);
        let (v, a, b) = (0.6 + 0.3 * (0.7 * t).sin(), 0.2 * (1.3 * t).cos(), 0.1 * (2.1 * t).sin());
        let f = -10.0 * v * v.abs() - 12.0 * a - 3.0 * b + 0.01 * (5.0 * t * t).cos();
        writeln!(table, "{v},0,{a},{b},{f}").unwrap();
        rows.push([v * v.abs(), a, b]);
    }
    (table, rows)
}

const ACCELERATED: &str = "[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"towed\"]\n\
     [[identify.model]]\nname = \"towed\"\nf_x = \"-D*v_x*abs(v_x) - A*v_x_dot - B*v_y_dot\"\n";

/// The others are fitted to what the known terms leave over, and err with them: ∂β/∂c = −(XᵀX)⁻¹Xᵀx.
#[test]
fn a_known_mass_is_held_and_its_error_goes_through_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let (table, rows) = accelerated();
    let known = "[[identify.known]]\ncoefficient = \"A\"\nvalue = \"12 kg\"\nstandard_uncertainty = \"0.5 kg\"\n";
    let exact = identify(folder.path(), &table, &format!("{ACCELERATED}[identify.fixed]\nA = \"12 kg\"\n"));
    let with = identify(folder.path(), &table, &format!("{ACCELERATED}{known}"));
    let [exact, with] = [&exact.estimates[0], &with.estimates[0]];
    let sum = |a: usize, b: usize| rows.iter().map(|r| r[a] * r[b]).sum::<f64>();
    let determinant = sum(0, 0) * sum(2, 2) - sum(0, 2) * sum(0, 2);
    let of_drag = -(sum(2, 2) * sum(0, 1) - sum(0, 2) * sum(2, 1)) / determinant;
    let of_sway = -(sum(0, 0) * sum(2, 1) - sum(0, 2) * sum(0, 1)) / determinant;
    for (name, moved) in [("D", of_drag), ("B", of_sway)] {
        let (a, b) = (&exact.coefficients[name], &with.coefficients[name]);
        assert_eq!(a.value, b.value);
        assert!((b.type_b.unwrap() / (0.5 * moved.abs()) - 1.0).abs() < 1e-9, "{name}: {b:?}");
        assert!(b.interval_95.unwrap()[0] < a.interval_95.unwrap()[0]);
    }
    let mass = &with.coefficients["A"];
    assert_eq!((mass.value, mass.type_b), (Some(12.0), Some(0.5)));
    let [low, high] = mass.interval_95.unwrap();
    assert!((0.5 * (high - low) / 0.5 - 1.96).abs() < 0.01 && (low + high - 24.0).abs() < 1e-12);
    assert_eq!(exact.coefficients["A"].interval_95, None);
    let all = with.covariance().unwrap();
    let place = |name: &str| all.names.iter().position(|n| n == name).unwrap();
    let between = all.matrix[place("D")][place("A")];
    assert!((between / (0.25 * of_drag) - 1.0).abs() < 1e-9, "{between}");
}

/// Two entries of one record keep their covariance: what they do to a third coefficient together is less than each does alone.
#[test]
fn known_coefficients_of_one_record_keep_their_covariance() {
    let folder = tempfile::tempdir().unwrap();
    let (table, rows) = accelerated();
    let entry = |value: f64| Coefficient {
        standard_uncertainty: Some(0.5),
        type_a: Some(0.5),
        interval_95: Some([value - 1.0, value + 1.0]),
        ..Coefficient::of(Some(value), "kg", Status::Free)
    };
    let estimate = Estimate {
        id: "hull/added_mass_6x6".to_owned(),
        source: "hull".to_owned(),
        coefficients: [("A11".to_owned(), entry(12.0)), ("A12".to_owned(), entry(3.0))].into_iter().collect(),
        type_a: Some(TypeA {
            names: vec!["A11".to_owned(), "A12".to_owned()],
            matrix: vec![vec![0.25, -0.2], vec![-0.2, 0.25]],
            dof: vec![None; 2],
            kind: "mesh".to_owned(),
        }),
        recommended: true,
        ..Estimate::default()
    };
    write_estimates(&folder.path().join("am.json"), &EstimateFile::of(vec![estimate])).unwrap();
    let known: String = [("A", "A11"), ("B", "A12")]
        .map(|(c, e)| format!("[[identify.known]]\ncoefficient = \"{c}\"\nrecord = \"am.json\"\nentry = \"{e}\"\n"))
        .concat();
    let result = identify(folder.path(), &table, &format!("{ACCELERATED}{known}"));
    let e = &result.estimates[0];
    let sum = |a: usize, b: usize| rows.iter().map(|r| r[a] * r[b]).sum::<f64>();
    let [m, n] = [-sum(0, 1) / sum(0, 0), -sum(0, 2) / sum(0, 0)];
    let variance = 0.25 * m * m + 0.25 * n * n - 2.0 * 0.2 * m * n;
    assert!((e.coefficients["D"].type_b.unwrap() / variance.sqrt() - 1.0).abs() < 1e-9, "{:?}", e.coefficients["D"]);
    let all = e.covariance().unwrap();
    let place = |name: &str| all.names.iter().position(|n| n == name).unwrap();
    assert!((all.matrix[place("A")][place("B")] + 0.2).abs() < 1e-12);
    assert_eq!(e.errors.len(), 1);
}

/// An acceleration that is read with errors makes least squares too small by its reliability; the regression in variables does not.
#[test]
fn errors_of_an_acceleration_do_not_shrink_the_mass() {
    let folder = tempfile::tempdir().unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut normal = |s: f64| {
        s * {
            let x: f64 = StandardNormal.sample(&mut rng);
            x
        }
    };
    let mut table = "v_x [m/s],v_y [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
    for i in 0..2000 {
        let t = f64::from(i);
        let (v, a) = (0.6 + 0.3 * (0.7 * t).sin(), 0.2 * (1.3 * t).cos());
        let f = -10.0 * v * v.abs() - 12.0 * a + normal(0.05);
        writeln!(table, "{v},0,{},{f}", a + normal(0.1)).unwrap();
    }
    let law = "[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\nmodels = [\"towed\"]\n\
               [[source.uncertainty]]\nquantity = \"v_x_dot\"\nstandard = \"0.1 m/s^2\"\nshared = \"sample\"\n\
               [[identify.model]]\nname = \"towed\"\nf_x = \"-D*v_x*abs(v_x) - A*v_x_dot\"\n";
    let mass = |more: &str| {
        let result = identify(folder.path(), &table, &format!("{law}{more}"));
        let c = &result.estimates[0].coefficients["A"];
        // A row scatters by its own 0.05 N and 12 kg × 0.1 m/s², however they were told apart; by the shrunk mass a little less.
        let sigma = result.estimates[0].sigma["f_x"].value;
        assert!((0.9..1.3).contains(&sigma), "{sigma}");
        (c.value.unwrap(), c.standard_uncertainty.unwrap())
    };
    let ((plain, _), (found, u)) = (mass(""), mass("[identify]\nerrors_in_variables = true\n"));
    // An error of the load that all rows share by a part goes into the mass by that part, and not by the reliability's share of it.
    let scale =
        "[[source.uncertainty]]\nname = \"gauge\"\nquantity = \"f_x\"\nstandard = \"1 %\"\nshared = \"campaign\"\n";
    let with = law.replace("[[identify.model]]", &format!("{scale}[[identify.model]]"));
    let result = identify(folder.path(), &table, &format!("{with}[identify]\nerrors_in_variables = true\n"));
    let by_gauge = result.estimates[0].coefficients["A"].type_b.unwrap();
    assert!((by_gauge / (0.01 * found) - 1.0).abs() < 0.02, "{by_gauge} of {found}");
    // Reliability σ_a²/(σ_a² + u²) = 0.02/0.03.
    assert!((plain / 8.0 - 1.0).abs() < 0.05, "{plain}");
    assert!((found - 12.0).abs() < 3.0 * u && u < 0.3, "{found} ± {u}");
}

/// A law of speed and acceleration is drawn against speed at the median acceleration of the rows, and not at that of whichever row comes first.
#[test]
fn a_drawn_line_holds_the_median_of_what_it_does_not_run_against() {
    let folder = tempfile::tempdir().unwrap();
    let (table, rows) = accelerated();
    let result = identify(folder.path(), &table, ACCELERATED);
    let answer = froude_identify::answer::Answer::Fitted(Box::new(result.clone()));
    let page = froude_identify::page::section(&answer).unwrap();
    let curve = page.curves.first().unwrap();
    let median = |k: usize| {
        let mut all: Vec<f64> = rows.iter().map(|r| r[k]).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let held: Vec<(&str, f64)> = curve.held.iter().map(|h| (h.quantity.as_str(), h.value)).collect();
    assert_eq!(held, [("v_x_dot", median(1)), ("v_y_dot", median(2))]);
    let c = |name: &str| result.estimates[0].coefficients[name].value.unwrap();
    for (v, f) in curve.x.iter().zip(&curve.y) {
        let expected = -c("D") * v * v.abs() - c("A") * median(1) - c("B") * median(2);
        assert!((f - expected).abs() < 1e-9, "{v}: {f} {expected}");
    }
}
