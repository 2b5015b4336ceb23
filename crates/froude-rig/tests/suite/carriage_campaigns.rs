//! Campaigns that drive a carriage.

use std::path::Path;

use froude_records::RecordError;
use froude_records::campaign::Campaign;
use froude_records::campaign_file::parse_campaign;
use froude_records::run::{Axis, Declared};
use froude_rig::carriage::{CarriageCampaign, Directions, DrivenCampaign, Order, RigKind, declared};

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/towing-carriage/campaign.toml");

fn example() -> String {
    std::fs::read_to_string(EXAMPLE).unwrap()
}

fn read(text: &str) -> Result<(Campaign, Option<CarriageCampaign>), RecordError> {
    let campaign = parse_campaign(Path::new("c.toml"), text)?;
    let carriage = declared(&campaign)?;
    Ok((campaign, carriage))
}

fn driven(text: &str) -> CarriageCampaign {
    read(text).unwrap().1.unwrap()
}

/// The message about the example with one text replaced by another.
fn refused(from: &str, to: &str) -> String {
    let text = example();
    assert_eq!(text.matches(from).count(), 1, "{from:?} stands once in the example");
    read(&text.replace(from, to)).unwrap_err().to_string()
}

/// `c.toml:line` of a text of the example.
fn line(of: &str) -> String {
    let at = example().lines().position(|l| l.starts_with(of)).unwrap() + 1;
    format!("c.toml:{at}")
}

#[test]
fn the_papers_campaign_is_read_as_it_is_written() {
    let DrivenCampaign { campaign, carriage, .. } = DrivenCampaign::read(Path::new(EXAMPLE)).unwrap();
    assert!(campaign.sources.is_empty(), "what drives a rig needs no source");
    let CarriageCampaign { rig, plan } = carriage.unwrap();
    let RigKind::Twin { seed, truths } = &rig.kind else { panic!("{:?}", rig.kind) };
    assert_eq!(*seed, 1);
    assert_eq!((truths[0].name.as_str(), truths[0].quantity.value_si), ("drag", 20.0));
    assert_eq!(rig.log_rate_hz, 1000.0);
    assert_eq!(rig.y.travel_m, [-0.05, 4.95]);
    let constants = rig.y.constants;
    assert_eq!(constants.gear_ratio, Declared::exact(34.97));
    assert_eq!(constants.torque_constant_n_m_a.value, 26.7e-3);
    assert!((constants.torque_constant_n_m_a.standard_uncertainty - 26.7e-5).abs() < 1e-12, "1 % of the value");
    assert!((constants.efficiency_forward.unwrap().standard_uncertainty - 0.04).abs() < 1e-12, "5 % of 0.8");
    // n/R · K_T K_amp, newtons at the chain per volt: the constant of eq. 8 and 9 of the paper.
    let n_per_v = constants.gear_ratio.value / constants.sprocket_radius_m.value
        * constants.torque_constant_n_m_a.value
        * constants.amplifier_a_v.value;
    assert!((n_per_v - 5.976).abs() < 5e-4, "{n_per_v}");
    assert_eq!((rig.y.gains.proportional_v_rad, rig.y.gains.shaped_mode_hz), (20.8, Some(3.6)));
    let plan = plan.unwrap();
    assert_eq!(plan.axis, Axis::Y);
    assert_eq!(plan.speed_m_s, [0.05, 0.15, 0.25, 0.35, 0.45, 0.55]);
    assert_eq!((plan.repeats, plan.order, plan.directions), (5, Order::Abba, Directions::Both));
    assert_eq!((plan.distance_m, plan.settling_dry_s, plan.settling_wet_s), (2.2, 5.0, 120.0));
    assert_eq!(plan.stop_at_relative_half_width, Some(0.025));
    assert_eq!(plan.expected_drag_n_s2_m2, Some(20.0));
    assert_eq!(plan.calibration.unwrap().weights_n.len(), 2);
    assert_eq!(plan.excitation.unwrap().duty, 0.6);
    assert!(plan.is_ballasted);
    assert_eq!(campaign.body.unwrap().reference_area_m2, Some(0.04));
}

#[test]
fn speeds_may_be_written_as_a_range_in_steps() {
    let text = example().replace(
        "speeds = [\"0.05 m/s\", \"0.15 m/s\", \"0.25 m/s\", \"0.35 m/s\", \"0.45 m/s\", \"0.55 m/s\"]",
        "speeds = { start = \"5 cm/s\", stop = \"55 cm/s\", step = \"10 cm/s\" }",
    );
    let plan = driven(&text).plan.unwrap();
    assert_eq!(plan.speed_m_s.len(), 6);
    // A centimetre per second is no binary fraction: one rounding.
    let written = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55];
    assert!(plan.speed_m_s.iter().zip(written).all(|(v, w)| (v - w).abs() <= f64::EPSILON * w));
}

#[test]
fn a_board_at_a_serial_port_has_a_port_and_no_seed() {
    let twin = "kind = \"twin\"                     # \"serial\" drives a board: port = \"/dev/ttyUSB0\", baud = 3_000_000\nseed = 1";
    let text = example().replace(twin, "kind = \"serial\"\nport = \"/dev/ttyUSB0\"");
    let text = text.replace(
        "[rig.twin]                        # the truth that identification has to find\ndrag = \"20 N s^2/m^2\"\npulley_friction = \"1 %\"",
        "",
    );
    let rig = driven(&text).rig;
    assert_eq!(rig.kind, RigKind::Serial { port: "/dev/ttyUSB0".to_owned(), baud: 3_000_000 });
    let at = line("kind = \"twin\"");
    assert_eq!(
        refused(twin, "kind = \"serial\"\nseed = 1"),
        format!("{}:8: `seed` does not belong to a rig of kind \"serial\"; take it out", line("seed = 1"))
    );
    assert!(
        refused("kind = \"twin\" ", "kind = \"twins\" ")
            .starts_with(&format!("{at}:8: `kind` is \"twins\"; did you mean `twin`?"))
    );
}

#[test]
fn what_is_wrong_is_reported_with_its_line_and_what_to_write() {
    let cases = [
        (
            "gear_ratio = \"34.97 1\"",
            "gear_ratio = \"34.97 m\"",
            format!(
                "{}:14: `gear_ratio` is \"34.97 m\": expected a pure number or angle (1), found a length (m)",
                line("gear_ratio")
            ),
        ),
        (
            "speed_limit = \"0.6 m/s\"  ",
            "sped_limit = \"0.6 m/s\"  ",
            format!("{}:1: unknown key `sped_limit` in [rig.y]; did you mean `speed_limit`?", line("speed_limit")),
        ),
        (
            "travel = [\"-0.05 m\", \"4.95 m\"] ",
            "travel = [\"4.95 m\", \"0 m\"] ",
            format!("{}:10: `travel` goes from 4.95 m to 0 m; the first hard stop is the lower one", line("travel")),
        ),
        (
            "efficiency = { value = \"80 %\"",
            "efficiency = { value = \"80 1\"",
            format!("{}:14: `efficiency` is 80; an efficiency is at most 1, or 100 %", line("efficiency = ")),
        ),
        (
            "order = \"ABBA\"",
            "order = \"ABAB\"",
            format!("{}:9: `order` is \"ABAB\"; did you mean `ABBA`?", line("order")),
        ),
        (
            "\"0.45 m/s\", \"0.55 m/s\"]\nrepeats = 5",
            "\"0.55 m/s\", \"0.55 m/s\"]\nrepeats = 5",
            format!(
                "{}:10: `speeds` names 0.55 m/s twice; give the number in repeats",
                line("speeds = [\"0.05 m/s\", \"0.15")
            ),
        ),
        (
            "stop_when = \"2.5 %\"",
            "stop_when = \"1 1\"",
            format!(
                "{}:13: `stop_when` is \"1 1\"; the relative half-width of D_d's 95 % interval lies between 0 and 100 %",
                line("stop_when")
            ),
        ),
        (
            "distance = \"2.2 m\"\n",
            "",
            format!(
                "{}:1: [carriage] has no `distance`; write the travel of a run with its ramps, \"2.2 m\", for example",
                line("[carriage]")
            ),
        ),
        (
            "proportional = \"20.8 V/rad\"",
            "proportional = \"20.8 V\"\nintegrall = \"1 V/s\"",
            format!(
                "c.toml:{}:1: unknown key `integrall` in [rig.y.controller]; did you mean `integral`?",
                example().lines().position(|l| l.starts_with("proportional")).unwrap() + 2
            ),
        ),
    ];
    for (from, to, message) in cases {
        assert_eq!(refused(from, to), message);
    }
}

#[test]
fn an_encoder_that_counts_backwards_is_declared_with_a_negative_number() {
    let text = example().replace("counts_per_revolution = 4000 ", "counts_per_revolution = -4000 ");
    let rig = driven(&text).rig;
    assert_eq!(rig.y.constants.counts_per_revolution, -4000.0);
    assert_eq!(
        refused("counts_per_revolution = 4000 ", "counts_per_revolution = 0 "),
        format!(
            "{}:25: `counts_per_revolution` is zero; write 4000 for 1000 lines decoded fourfold, -4000 where the encoder counts backwards",
            line("counts_per_revolution")
        )
    );
}

#[test]
fn a_stop_that_the_steps_do_not_reach_is_refused_with_steps_that_do() {
    let speeds = "speeds = [\"0.05 m/s\", \"0.15 m/s\", \"0.25 m/s\", \"0.35 m/s\", \"0.45 m/s\", \"0.55 m/s\"]";
    let range =
        |stop: &str, step: &str| format!("speeds = {{ start = \"0.1 m/s\", stop = \"{stop}\", step = \"{step}\" }}");
    assert_eq!(
        refused(speeds, &range("0.5 m/s", "0.15 m/s")),
        format!(
            "{}:10: `speeds` goes from 0.1 m/s in steps of 0.15 m/s to 0.4 m/s and does not reach 0.5 m/s; write step = \"0.2 m/s\" or \
             \"0.1 m/s\", or another stop",
            line("speeds = [\"0.05 m/s\", \"0.15")
        )
    );
    // Larger than the range, and in another unit.
    let wide = refused(speeds, &range("0.5 m/s", "70 cm/s"));
    assert!(wide.contains("to 0.1 m/s and does not reach 0.5 m/s; write step = \"40 cm/s\" or \"20 cm/s\""), "{wide}");
    // The steps that are advised are taken, also where they have no end.
    let odd = refused(speeds, &range("0.8 m/s", "0.3 m/s"));
    for part in odd.split("step = ").nth(1).unwrap().split(" m/s\"").take(2) {
        let step: f64 = part.rsplit('"').next().unwrap().parse().unwrap();
        let text = example().replace(speeds, &range("0.8 m/s", &format!("{step} m/s")));
        let plan = driven(&text).plan.unwrap();
        assert!((plan.speed_m_s.last().unwrap() - 0.8).abs() < 1e-6, "{step}: {:?}", plan.speed_m_s);
    }
}

#[test]
fn litres_are_read_and_decimal_commas_reported() {
    let volume = "volume = \"6.283e-3 m^3\"";
    let text = example().replace(volume, "volume = \"6.283 l\"");
    let body = read(&text).unwrap().0.body.unwrap();
    assert_eq!(body.volume_m3, Some(6.283e-3));
    let comma = refused(volume, "volume = \"2,5 l\"");
    assert!(comma.ends_with("`2,5 l` has a decimal comma; write a decimal point, `2.5 l`"), "{comma}");
    let word = read(&example().replace(volume, "volume = \"6.283 litres\"")).unwrap().0.body.unwrap();
    assert_eq!(word.volume_m3, body.volume_m3);
}

#[test]
fn a_carriage_without_a_rig_is_told_to_name_one() {
    let text = "schema = 1\nname = \"a\"\n[carriage]\nspeeds = [\"0.1 m/s\"]\ndistance = \"1 m\"\nacceleration = \"1 m/s^2\"\n";
    assert_eq!(
        read(text).unwrap_err().to_string(),
        "c.toml:1:1: the file has no `rig`; [carriage] states what to do; [rig] states with what: kind = \"twin\", for example"
    );
}
