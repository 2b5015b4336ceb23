//! Logs of other programs as tows: C_D of a sphere from counts and volts, with an interval that covers.

use std::path::Path;

use froude_carriage::axis::{AxisModel, of_runs};
use froude_carriage::drag::point::Method;
use froude_carriage::reduction::{Reduction, reduce};
use froude_carriage::runs::read;
use froude_records::run::Role;

use crate::student_tank::{C_D, Tank, normal};

const CAMPAIGN: &str = "schema = 1\nname = \"sphere\"\n[fluid]\ndensity = \"998 kg/m^3\"\n[body]\nreference_area = \"78.54 cm^2\"\n\
    [rig]\nkind = \"logs\"\nforce_per_volt = { value = \"4.77 N/V\", standard = \"0.5 %\" }\nposition_standard = \"0.05 %\"\nballasted = true\n";
const SIDECAR: &str = "schema = 1\nmethod = \"tow\"\nfiles = \"run_*.csv\"\nlist = \"../runs.csv\"\n[constants]\ncount = \"0.1 mm\"\n[columns]\n\
    t = { name = \"time\" }\nenc = { name = \"position\", scale = \"count\" }\nu = { name = \"command\" }\n";

fn written(tank: Tank) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    tank.write(folder.path());
    put(folder.path(), "campaign.toml", CAMPAIGN);
    put(folder.path(), "logs/logs.toml", SIDECAR);
    folder
}

fn put(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

fn changed(folder: &Path, name: &str, from: &str, to: &str) {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    assert!(text.contains(from), "{name} has no {from}");
    put(folder, name, &text.replace(from, to));
}

fn reduced(folder: &Path) -> Result<Reduction, String> {
    let runs =
        read(&[folder.join("logs")], &[Role::Wet, Role::Dry, Role::Friction], None).map_err(|e| e.to_string())?;
    reduce(runs, &Method::ALL).map_err(|e| e.to_string())
}

/// C_D by a method, with its interval.
fn c_d(reduction: &Reduction, method: Method) -> (f64, [f64; 2]) {
    let coefficient = reduction.report.coefficients.iter().find(|c| c.method == method).unwrap();
    let (value, interval) = coefficient.drag_coefficient().unwrap();
    (value, interval.unwrap())
}

/// 40 tanks, whose force per volt and count err by what is declared of them: 38 are to be expected in the interval, 36 are one and a half binomial deviations fewer. The
/// scatter of a run is 0.019 N, and the slope of 12 differences has √2 · 0.019 N/√(Σ v⁴) = 0.04 N s²/m², 2.3 % of the drag; with 0.5 % of the force and twice
/// 0.05 % of a length and Student's t of 11 degrees of freedom that is ± 5.1 %. The larger of s² and of the jackknife is 11 % wider in the mean (20,000 draws of twelve
/// normal errors, 96.5 % of them covered): ± 5.65 %, of which the mean of 40 s scatters by 1/√(2 · 11 · 40) = 3 %: three.
#[test]
fn the_interval_of_c_d_covers_over_many_tanks() {
    let seeds = std::env::var("FROUDE_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(40_u64);
    let (mut covered, mut width) = ([0; 2], [0.0; 2]);
    for seed in 0..seeds {
        let mut normal = normal(1000 + seed);
        let wrong = [0.005 * normal(), 0.0005 * normal()];
        let folder = written(Tank { seed, wrong, ..Tank::default() });
        let reduction = reduced(folder.path()).unwrap();
        for (k, method) in [Method::Mcd, Method::MbdpMapped].into_iter().enumerate() {
            let (_, [low, high]) = c_d(&reduction, method);
            covered[k] += u64::from(low <= C_D && C_D <= high);
            width[k] += 0.5 * (high - low) / C_D / seeds as f64;
        }
    }
    let least = 0.95 - 1.5 * (0.95 * 0.05 / seeds as f64).sqrt();
    assert!(covered.iter().all(|covered| *covered as f64 >= least * seeds as f64), "{covered:?} of {seeds}");
    println!("C_D in the interval: {covered:?} of {seeds}, mean half-widths {width:?}");
    assert!((width[0] / 0.0565 - 1.0).abs() < 0.09, "{width:?}");
}

/// What noise of 0.02 V leaves of the drag where runs repeat: 0.095 N a sample, 6.4 mN in a tapered window of 270 samples at the fastest, √2 · 6.4 mN/√(Σ v⁴) of a
/// slope over differences, 0.76 %. Three of them.
const NOISE: f64 = 0.023;

/// The friction of the rail changes by 0.25 N over 0.4 m, the drag at 0.2 m/s is 0.07 N: paired by time, runs that begin 0.2 m apart would be wrong by
/// as much as the drag.
#[test]
fn friction_along_the_rail_cancels_where_wet_and_dry_begin_elsewhere() {
    let folder = written(Tank { wet_starts_m: 0.2, run_to_run_v: 0.0, ..Tank::default() });
    let (value, _) = c_d(&reduced(folder.path()).unwrap(), Method::Mcd);
    assert!((value / C_D - 1.0).abs() < NOISE, "{value}");
}

/// A drive without a loop is 3 % slower in the water: 1.9 N s/m of friction then take 0.03 · 1.9 v from the difference, 10 % of the drag.
#[test]
fn wet_runs_that_are_slower_are_corrected_and_said_to_be() {
    let folder = written(Tank { wet_slower: 0.03, run_to_run_v: 0.0, ..Tank::default() });
    let reduction = reduced(folder.path()).unwrap();
    let (value, interval) = c_d(&reduction, Method::Mcd);
    assert!((value / C_D - 1.0).abs() < NOISE, "{value}");
    assert!(interval[0] <= C_D && C_D <= interval[1], "{interval:?}");
    // Student's t of 11 degrees of freedom, 2.20, of a third of NOISE and 0.5 % of the force, and as much again by chance.
    assert!(0.5 * (interval[1] - interval[0]) < 2.0 * 2.20 * (NOISE / 3.0).hypot(0.005) * C_D, "{interval:?}");
    let said = reduction.report.findings.iter().find(|f| f.code == "speeds-differ").unwrap();
    assert!(
        said.message
            .starts_with("mcd: wet and dry runs differ in speed by up to 3.1 %; friction changes with speed by 1.89"),
        "{}",
        said.message
    );
    assert!((c_d(&reduction, Method::MbdpMapped).0 / C_D - 1.0).abs() < NOISE);
}

/// Slower by 0.15 %, below what is said, takes 0.3 % of the drag: it is corrected, to a tenth.
#[test]
fn speeds_that_hardly_differ_are_corrected_too() {
    let [same, slower] = [0.0, 0.0015].map(|wet_slower| {
        let folder = written(Tank { wet_slower, run_to_run_v: 0.0, ..Tank::default() });
        let reduction = reduced(folder.path()).unwrap();
        assert!(reduction.report.findings.iter().all(|f| f.code != "speeds-differ"));
        c_d(&reduction, Method::Mcd).0
    });
    assert!((slower / same - 1.0).abs() < 0.0003, "{same} {slower}");
}

/// Leaves only these runs of the list.
fn keep(folder: &Path, is_kept: impl Fn(&str) -> bool) {
    let list = std::fs::read_to_string(folder.join("runs.csv")).unwrap();
    for line in list.lines().skip(1).filter(|line| !is_kept(line)) {
        std::fs::remove_file(folder.join("logs").join(line.split(',').next().unwrap())).unwrap();
    }
}

/// Without the only dry run at a second speed nothing shows how friction changes with it: all of the correction is its error, 1.9 N s/m · 0.03 · Σ v³/Σ v⁴ to a tenth.
#[test]
fn friction_over_speed_that_one_dry_run_shows_is_an_error_as_large_as_itself() {
    let folder = written(Tank { wet_slower: 0.03, run_to_run_v: 0.0, ..Tank::default() });
    keep(folder.path(), |line| line.contains(",0.6,") || line.contains(",0.4,out"));
    let reduction = reduced(folder.path()).unwrap();
    let mcd = reduction.report.coefficients.iter().find(|c| c.method == Method::Mcd).unwrap();
    let of_speed = mcd.budget.iter().find(|part| part.name.starts_with("friction between the speeds")).unwrap();
    let sum = |n: i32| 2.0 * 0.6_f64.powi(n) + 0.4_f64.powi(n);
    let expected = 1.9 * 0.03 * sum(3) / sum(4);
    assert!((of_speed.standard(0) / expected - 1.0).abs() < 0.1, "{} for {expected}", of_speed.standard(0));
    let (value, _) = c_d(&reduction, Method::Mcd);
    assert!((value / C_D - 1.0).abs() < NOISE, "{value}");
}

/// A command that is constant takes the carriage to its speed in seconds: what accelerates it is missing from the drag by more than noise, and said to be.
#[test]
fn a_drive_without_a_loop_is_said_to_accelerate() {
    let folder = written(Tank { is_open_loop: true, run_to_run_v: 0.0, ..Tank::default() });
    let reduction = reduced(folder.path()).unwrap();
    let (value, _) = c_d(&reduction, Method::Mcd);
    assert!(value / C_D - 1.0 < -NOISE, "{value}");
    let said = reduction.report.findings.iter().find(|f| f.code == "speed-drifts").unwrap();
    assert!(said.message.ends_with("Tow further, or hold the speed with a loop"), "{}", said.message);
    let folder = written(Tank::default());
    assert!(reduced(folder.path()).unwrap().report.findings.iter().all(|f| f.code != "speed-drifts"));
}

/// Dry tows of three repeats and wet ones of one. A wet run scatters by 0.019 N and the mean of three dry ones by a third of its variance:
/// √(4/3) · 0.019 N/√(Σ v⁴); 24 degrees of freedom scatter by 14 %: three.
#[test]
fn friction_of_several_repeats_is_in_the_interval_of_one_wet_pair() {
    let folder = written(Tank { repeats: 3, ..Tank::default() });
    keep(folder.path(), |line| line.contains(",dry,") || line.ends_with(",1"));
    let reduction = reduced(folder.path()).unwrap();
    let mapped = reduction.report.coefficients.iter().find(|c| c.method == Method::MbdpMapped).unwrap();
    let scatter = &mapped.budget[0];
    assert_eq!(scatter.name, "scatter of wet runs about the law and of dry runs");
    let quartic = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6_f64].iter().map(|v| 2.0 * v.powi(4)).sum::<f64>();
    let expected = (4.0_f64 / 3.0).sqrt() * 0.0191 / quartic.sqrt();
    assert!((scatter.standard(0) / expected - 1.0).abs() < 0.42, "{} for {expected}", scatter.standard(0));
    assert!(reduction.report.findings.iter().all(|f| f.code != "friction-uncertain"));
    let folder = written(Tank::default());
    keep(folder.path(), |line| line.contains(",wet,") || line.contains("dry,0.1,out"));
    let reduction = reduced(folder.path()).unwrap();
    let said: Vec<&str> = reduction.report.findings.iter().map(|f| f.message.as_str()).collect();
    let expected = "mbdp_mapped: the interval does not include the uncertainty of the friction, which a single dry run does not show; add dry runs";
    assert!(said.contains(&expected), "{said:?}");
}

/// Repeats are pairs: each is left out in turn.
#[test]
fn a_column_repeat_makes_pairs_and_without_it_doubled_settings_are_asked_about() {
    let folder = written(Tank { repeats: 3, ..Tank::default() });
    let reduction = reduced(folder.path()).unwrap();
    let mcd = reduction.report.coefficients.iter().find(|c| c.method == Method::Mcd).unwrap();
    assert_eq!((mcd.pairs, mcd.points.len()), (3, 36));
    let (_, [low, high]) = c_d(&reduction, Method::Mcd);
    assert!(low <= C_D && C_D <= high, "{low} {high}");
    // 2.3 % of one pair over √3, with Student's t of two degrees of freedom, and as much again by chance.
    assert!(0.5 * (high - low) < 2.0 * 4.30 * (0.023 / 3.0_f64.sqrt()).hypot(0.005) * C_D, "{low} {high}");
    let list = std::fs::read_to_string(folder.path().join("runs.csv")).unwrap();
    let cut: Vec<&str> = list.lines().map(|line| line.rsplit_once(',').unwrap().0).collect();
    put(folder.path(), "runs.csv", &cut.join("\n"));
    let why = reduced(folder.path()).err().unwrap();
    assert!(
        why.contains("run_01.csv and ") && why.contains("run_25.csv are both dry runs at 0.1 m/s in one direction"),
        "{why}"
    );
    assert!(why.ends_with("write a column repeat (1, 2, …) that says which wet and dry runs belong together"), "{why}");
}

/// Two bodies on one carriage have its errors in common: of force and lengths, whatever is declared of ballast and strut.
#[test]
fn bodies_on_one_carriage_have_its_errors_in_common() {
    let folder = written(Tank::default());
    let keys = || {
        let reduction = reduced(folder.path()).unwrap();
        let mcd = reduction.report.coefficients.iter().find(|c| c.method == Method::Mcd).unwrap();
        let errors = mcd.result.estimates[0].errors.keys();
        errors.filter(|key| key.starts_with("rig/")).cloned().collect::<Vec<String>>()
    };
    let one = keys();
    assert_eq!(one.len(), 2, "{one:?}");
    changed(folder.path(), "campaign.toml", "ballasted = true", "ballasted = true\nstrut_drag = \"0.1 kg/m\"");
    assert_eq!(keys(), one);
    changed(folder.path(), "campaign.toml", "\"0.05 %\"", "\"0.06 %\"");
    assert!(keys().iter().all(|key| !one.contains(key)));
}

/// A count that is too long makes speed and acceleration too large, M and F_v too small and F_c not: M v̇, F_v v and F_c are forces.
#[test]
fn the_length_of_a_count_is_in_mass_and_viscous_friction() {
    let folder = written(Tank::default());
    let runs = read(&[folder.path().join("logs")], &[Role::Dry], None).unwrap();
    let axis = of_runs(&runs, &[AxisModel::Symmetric], "carriage").unwrap();
    let (estimate, _) = &axis.estimates[0];
    let (_, error) = estimate.errors.iter().find(|(key, _)| key.ends_with("/sprocket_radius")).unwrap();
    for ((name, c), slope) in estimate.coefficients.iter().zip(&error.sensitivity) {
        let power = if name == "M" || name == "F_v" { -1.0 } else { 0.0 };
        let of_both = 0.005_f64.hypot(0.0005 * power) * c.value.unwrap().abs();
        assert!((slope[0] - power * c.value.unwrap()).abs() < 1e-12, "{name}: {slope:?}");
        assert!((c.type_b.unwrap() / of_both - 1.0).abs() < 1e-9, "{name}: {c:?} for {of_both}");
    }
}

#[test]
fn what_nobody_declared_is_asked_by_name() {
    let (campaign, sidecar) = ("campaign.toml", "logs/logs.toml");
    let force = "force_per_volt = { value = \"4.77 N/V\", standard = \"0.5 %\" }";
    for (file, from, to, asked) in [
        (campaign, force, "", "write force_per_volt = { value = \"4.77 N/V\", standard = \"1 %\" }"),
        (campaign, force, "force_per_volt = \"4.77 N/V\"", "has no standard uncertainty"),
        (
            campaign,
            force,
            "force_per_ampere = { value = \"4.77 N A^-1\", standard = \"1 %\" }",
            "no column is its current",
        ),
        (campaign, "position_standard = \"0.05 %\"", "", "write position_standard = \"0.1 %\""),
        (campaign, "ballasted = true", "", "write ballasted = true where the wheels carry the same load wet and dry"),
        (campaign, "ballasted = true", "ballasted = false", "Write volume ="),
        (campaign, "[fluid]\ndensity = \"998 kg/m^3\"", "", "write [fluid] density = \"998 kg/m^3\""),
        (campaign, "kind = \"logs\"", "kind = \"logs\"\nseed = 1", "does not belong to a rig of kind \"logs\""),
        (sidecar, "method = \"tow\"", "", "write method = \"tow\" at its head"),
        (sidecar, "enc = { name = \"position\", scale = \"count\" }", "", "no column is its position: write enc = "),
        (sidecar, "count = \"0.1 mm\"", "count = \"1 mm\"", "no stretch within 10 % of the listed 0.1 m/s"),
        (
            sidecar,
            "u = { name = \"command\" }",
            "u = { name = \"command\", sign = -1 }",
            "the command opposes the motion. If this holds for all runs, set sign = -1",
        ),
        (
            sidecar,
            "u = { name = \"command\" }",
            "u = { name = \"command\", delay = \"1 ms\" }",
            "is not applied to logs of a carriage",
        ),
        ("runs.csv", "file,state,", "file,what,", "is no column of a list"),
        ("runs.csv", "run_05.csv,dry,0.2,out", "run_05.csv,dry,0.2,back", "it is listed as \"back\""),
        ("runs.csv", "run_05.csv,dry,0.2,out", "run_05.csv,trocken,0.2,out", "is \"trocken\""),
        ("runs.csv", "run_05.csv,dry,0.2,out\n", "", "has no row for run_05.csv"),
        ("runs.csv", "run_05.csv,dry,0.2,out\n", "run_05.csv,dry,0,out\n", "its listed speed is 0 m/s"),
    ] {
        let folder = written(Tank::default());
        changed(folder.path(), file, from, to);
        let why = reduced(folder.path()).err().unwrap_or_else(|| panic!("{from} -> {to} was read"));
        assert!(why.contains(asked), "{from} -> {to}: {why}");
    }
    let folder = written(Tank::default());
    std::fs::remove_file(folder.path().join("campaign.toml")).unwrap();
    let why = reduced(folder.path()).err().unwrap();
    assert!(why.contains("no campaign.toml lies with these logs") && why.contains("froude new carriage-logs"), "{why}");
}

#[test]
fn a_log_that_is_missing_doubled_or_without_its_speed_is_named() {
    let folder = written(Tank::default());
    std::fs::remove_file(folder.path().join("logs/run_07.csv")).unwrap();
    changed(folder.path(), "runs.csv", "run_10.csv,wet,0.3", "run_10.csv,wet,0.5");
    let reduction = reduced(folder.path()).unwrap();
    let said: Vec<&str> = reduction.report.findings.iter().map(|f| f.message.as_str()).collect();
    for part in [
        "1 log is listed and not there: run_07.csv",
        "run_10.csv: left out: no stretch within 10 % of the listed 0.5 m/s",
    ] {
        assert!(said.iter().any(|text| text.contains(part)), "{part}: {said:?}");
    }
    let logs = folder.path().join("logs");
    std::fs::copy(logs.join("run_01.csv"), logs.join("run_07.csv")).unwrap();
    assert!(reduced(folder.path()).err().unwrap().contains("is the same log as"));
}

/// A current in place of a voltage, and a gap of a second in the steady stretch: the record names the ampere, the window ends at the gap.
#[test]
fn a_current_and_a_gap() {
    let folder = written(Tank::default());
    changed(
        folder.path(),
        "campaign.toml",
        "force_per_volt = { value = \"4.77 N/V\"",
        "force_per_ampere = { value = \"4.77 N A^-1\"",
    );
    changed(folder.path(), "logs/logs.toml", "u = { name = \"command\" }", "i = { name = \"current\" }");
    for entry in std::fs::read_dir(folder.path().join("logs")).unwrap().flatten() {
        let text = std::fs::read_to_string(entry.path()).unwrap();
        let is_kept = |line: &&str| {
            line.split(',').next().and_then(|t| t.parse::<f64>().ok()).is_none_or(|t| !(2000.0..3000.0).contains(&t))
        };
        let kept: Vec<&str> = text.lines().filter(is_kept).collect();
        if entry.path().extension().is_some_and(|e| e == "csv") {
            std::fs::write(entry.path(), kept.join("\n").replace("u [V]", "i [A]")).unwrap();
        }
    }
    let reduction = reduced(folder.path()).unwrap();
    let mcd = reduction.report.coefficients.iter().find(|c| c.method == Method::Mcd).unwrap();
    let record = &mcd.result.estimates[0];
    assert!((record.law.constants["force_per_ampere"].value - 4.77).abs() < 1e-12);
    let (_, [low, high]) = c_d(&reduction, Method::Mcd);
    assert!(low <= C_D && C_D <= high, "{low} {high}");
    // The gap leaves the fast runs no window. A difference scatters by √2 · 0.019 N, D_d = 3.919 C_D; Student's t of five degrees of freedom, and the larger of s² and of the jackknife, which is
    // 2.9 of the true scatter in one of 200 cases at three speeds (20,000 draws).
    assert!(mcd.points.len() >= 6);
    let quartic: f64 = mcd.points.iter().map(|p| p.speed_m_s.powi(4)).sum();
    assert!(0.5 * (high - low) < 2.9 * 2.57 * 0.027 / quartic.sqrt() / 3.919, "{low} {high}");
    assert!(reduction.report.findings.iter().any(|f| f.code == "time-gaps"));
}
