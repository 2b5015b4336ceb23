//! Advice is followed: what a finding tells to write is written, and the finding is gone. None of the findings before comes back, so that no advice goes in circles.

use std::fmt::Write as _;

use froude_identify::source::identify_source;
use froude_records::campaign_file::read_campaign;
use froude_records::finding::{Finding, Severity};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Warnings about a table, by keys of its source and of the identification.
fn warnings(table: &str, source: &str, identify: &str) -> Vec<Finding> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let text = format!(
        "schema = 1\nname = \"a\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{source}\n[identify]\n{identify}\n"
    );
    std::fs::write(folder.path().join("c.toml"), text).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    let found = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
    found.findings.into_iter().filter(|f| f.severity >= Severity::Warning).collect()
}

/// Keys of the source, those of the identification, and the code that they are written for.
type Step<'a> = (&'a str, &'a str, &'a str);

/// Writes what each finding tells, in turn: its message names the key, and neither it nor one before it is there afterwards.
fn follow(table: &str, first: [&str; 2], steps: &[Step<'_>]) {
    let mut now = warnings(table, first[0], first[1]);
    let mut gone: Vec<&str> = Vec::new();
    for (source, identify, code) in steps {
        let said = now.iter().find(|f| f.code == *code).expect(code);
        let key = [*identify, *source].into_iter().find_map(|keys| keys.lines().last()).unwrap();
        assert!(said.message.contains(key), "{code} does not name {key}: {}", said.message);
        gone.push(code);
        now = warnings(table, source, identify);
        assert!(!now.iter().any(|f| gone.contains(&f.code.as_str())), "{code}, {key}: {now:?}");
    }
}

/// A finding names what to do, and is not there once that is done.
fn ends(code: &str, names: &str, before: &[Finding], after: &[Finding]) {
    assert!(before.iter().any(|f| f.code == code && f.message.contains(names)), "{before:?}");
    assert!(!after.iter().any(|f| f.code == code), "{after:?}");
}

fn rng(seed: u128) -> impl FnMut() -> f64 {
    let mut rng = Pcg64::new(seed, 18);
    move || StandardNormal.sample(&mut rng)
}

const QUADRATIC: &str = "models = [\"quadratic\"]";

#[test]
fn scatter_that_grows_with_the_load() {
    let mut normal = rng(1);
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..45 {
        let u = 0.2 + 0.04 * f64::from(i);
        let _ = writeln!(table, "{u},{}", -12.0 * u * u * (1.0 + 0.03 * normal()));
    }
    for advice in ["weights = \"fitted\"", "covariance = \"HC3\""] {
        follow(&table, ["", QUADRATIC], &[("", &format!("{QUADRATIC}\n{advice}"), "uneven-scatter")]);
    }
}

/// Six days with a zero of their own: it is declared, estimated, or each day is one observation.
#[test]
fn offsets_of_setups() {
    let mut normal = rng(2);
    let mut table = "speed [m/s],setup,f_x [N]\n".to_owned();
    for day in 0..6 {
        let zero = 1.5 * normal();
        for i in 0..8 {
            let u = 0.3 + 0.2 * f64::from(i);
            let _ = writeln!(table, "{u},day {day},{}", -12.0 * u * u + zero + 0.2 * normal());
        }
    }
    let zero = "[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"1.5 N\"\nshared = \"setup\"";
    follow(&table, ["", QUADRATIC], &[(zero, "", "setup-offset")]);
    let group = "group = \"setup\"";
    for advice in ["group_offset = \"estimate\"", "covariance = \"cluster\""] {
        follow(&table, ["", QUADRATIC], &[(group, &format!("{QUADRATIC}\n{advice}"), "setup-offset")]);
    }
}

/// A bend that a law lacks: with one more term it is gone.
#[test]
fn a_missing_term() {
    let mut normal = rng(4);
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..30 {
        let u = 0.3 + 0.06 * f64::from(i);
        let _ = writeln!(table, "{u},{}", -(4.0 * u + 2.0 * u * u + 4.0 * u.powi(3)) + 0.2 * normal());
    }
    let more = "models = [\"long\"]\n[[identify.model]]\nname = \"long\"\nf_x = \"-A*u - B*u*abs(u) - C*u^3\"";
    let now = warnings(&table, "", "models = [\"linear_quadratic\"]");
    ends("lack-of-fit", "[[identify.model]]", &now, &warnings(&table, "", more));
}

/// A row that lies apart is left out by its name.
#[test]
fn a_row_that_lies_apart() {
    let mut normal = rng(5);
    let mut table = "run,speed [m/s],f_x [N]\n".to_owned();
    for i in 0..16 {
        let u = 0.3 + 0.1 * f64::from(i);
        let slip = if i == 9 { 4.0 } else { 0.0 };
        let _ = writeln!(table, "r{i},{u},{}", -12.0 * u * u + slip + 0.2 * normal());
    }
    let kept = warnings(&table, "keep = \"run != \\\"r9\\\"\"", QUADRATIC);
    ends("outlying-row", "`keep`", &warnings(&table, "", QUADRATIC), &kept);
}

/// A prior that the data contradict: without it the data say what they say.
#[test]
fn a_prior_that_the_data_contradict() {
    let mut normal = rng(6);
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..16 {
        let u = 0.3 + 0.1 * f64::from(i);
        let _ = writeln!(table, "{u},{}", -12.0 * u * u + 0.2 * normal());
    }
    let prior = format!(
        "{QUADRATIC}\n[[identify.prior]]\ncoefficient = \"D_x_II\"\nvalue = \"20 kg/m\"\nstandard_uncertainty = \"1 kg/m\""
    );
    assert!(warnings(&table, "", &prior).iter().any(|f| f.code == "prior-contradicted"));
    assert!(warnings(&table, "", QUADRATIC).is_empty());
}

/// Rows in time whose errors follow each other.
#[test]
fn rows_that_follow_each_other() {
    let mut normal = rng(7);
    let mut table = "time [s],speed [m/s],f_x [N]\n".to_owned();
    let mut error = 0.0;
    for i in 0..200 {
        let t = 0.1 * f64::from(i);
        let u = 1.0 + 0.6 * (0.5 * t).sin();
        error = 0.8 * error + 0.12 * normal();
        let _ = writeln!(table, "{t:.1},{u:.5},{:.5}", -12.0 * u * u + error);
    }
    let serial = format!("{QUADRATIC}\ncovariance = \"serial\"");
    follow(&table, ["", QUADRATIC], &[("", &serial, "serial-correlation")]);
}

/// A load cell that was not zeroed: with its reading at rest subtracted it is as if it had been.
#[test]
fn a_load_cell_that_was_not_zeroed() {
    let mut normal = rng(8);
    let mut rows = Vec::new();
    for i in 0..12 {
        let u = 0.1 * f64::from(i);
        rows.push(format!("{u:.1},{:.4}", -12.0 * u * u + 0.8 + 0.05 * normal()));
    }
    let as_read = format!("speed [m/s],f_x [N]\n{}\n", rows.join("\n"));
    let zeroed = format!("speed [m/s],f_x [N],zero_before_f_x [N]\n{},0.8\n", rows.join(",0.8\n"));
    ends("load-at-rest", "zero_before_f_x", &warnings(&as_read, "", ""), &warnings(&zeroed, "", ""));
}

/// Drag that grows faster than U²: a term of the polynomial is below zero, and the power law has none.
#[test]
fn a_term_below_zero() {
    let mut normal = rng(9);
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 0..20 {
        let u = 0.3 + 0.1 * f64::from(i);
        let _ = writeln!(table, "{u},{}", -9.0 * u.powf(2.4) + 0.1 * normal());
    }
    let now = warnings(&table, "", "models = [\"linear_quadratic\"]");
    let after = warnings(&table, "", "models = [\"power_law\"]");
    ends("negative-drag", "power law", &now, &after);
    assert!(after.is_empty(), "{after:?}");
}
