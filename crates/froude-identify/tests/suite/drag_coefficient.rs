//! C_D of rows and laws: which rows are drawn, and of which loads there is one.

use std::fmt::Write as _;

use froude_identify::drag_coefficient::state;
use froude_identify::method::Found;
use froude_identify::source::identify_source;
use froude_records::block::Block;
use froude_records::campaign_file::read_campaign;
use froude_records::page::Mark;

/// f = 0.4 N − 3 kg/m v|v| with alternating errors, N, at three angles and four speeds; the load is called `load`.
const ERROR_N: f64 = 1e-4;
const SLOWEST_M_S: f64 = 0.5;

fn stated(load: &str, keys: &str) -> Found {
    let mut table = format!("speed [m/s],angle [deg],{load} [N]\n");
    for k in 0..12 {
        let (speed, angle) = (SLOWEST_M_S + 0.25 * f64::from(k / 3), [0.0_f64, 6.0, 20.0][k as usize % 3]);
        let u = speed * angle.to_radians().cos();
        let error = if k % 2 == 0 { ERROR_N } else { -ERROR_N };
        writeln!(table, "{speed},{angle},{}", 0.4 - 3.0 * u * u + error).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let text = format!(
        "schema = 1\nname = \"a\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nreference_area = \"0.01 m^2\"\n[identify]\nmodels = [\"own\"]\n\
         [[identify.model]]\nname = \"own\"\n{load} = \"F_0 - D*v_x*abs(v_x)\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n{keys}"
    );
    std::fs::write(folder.path().join("c.toml"), text).unwrap();
    let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
    let result = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
    let mut found = Found { results: vec![result.into()], ..Found::default() };
    state(&mut found, &campaign);
    found
}

/// The points lie on the law: 2·3/(1000·0.01), but for the errors of the row and of the zero over ½ρU²A.
#[test]
fn rows_across_the_axis_are_not_drawn_and_the_load_at_rest_is_taken_off() {
    let found = stated("f_x", "");
    let charts = found.blocks.iter().flat_map(|section| &section.blocks).filter_map(|block| match block {
        Block::Chart(chart) => Some(chart),
        _ => None,
    });
    let series: Vec<_> = charts.flat_map(|chart| &chart.panels).flat_map(|panel| &panel.series).collect();
    let measured = series.iter().find(|series| series.mark == Mark::Points).unwrap();
    assert_eq!(measured.y.len(), 8, "{measured:?}");
    let off = 2.0 * ERROR_N / (0.5 * 1000.0 * (SLOWEST_M_S * 6.0_f64.to_radians().cos()).powi(2) * 0.01);
    assert!(measured.y.iter().all(|c_d| (c_d - 0.6).abs() < off), "{measured:?}");
}

/// What an actuator exerts is no drag of the body.
#[test]
fn a_thrust_has_no_drag_coefficient() {
    let found = stated("f_x", "actuator = [\"f_x\"]\n");
    assert!(found.blocks.is_empty() && found.results[0].estimates()[0].derived.get("C_D").is_none());
}
