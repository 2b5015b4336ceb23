use super::*;
use crate::outcome::Outcome;

struct Run {
    name: &'static str,
    speed_m_s: f64,
    drag_n: Option<f64>,
}

const RUNS: [Run; 2] =
    [Run { name: "slow", speed_m_s: 0.5, drag_n: Some(12.345) }, Run { name: "fast", speed_m_s: 1.0, drag_n: None }];

fn table() -> ResultTable {
    let t = TableBuilder::new("runs", "runs", &RUNS);
    t.build(vec![
        t.text("name", "run", |r| r.name.to_owned()),
        t.number("speed_m_s", "speed [cm/s]", |r| r.speed_m_s).places(1),
        t.number("load/drag_n", "drag [N]", |r| r.drag_n).significant(3),
        t.number("load/power_w", "", |r| r.drag_n.map(|drag| drag * r.speed_m_s)),
    ])
}

fn json(blocks: Vec<Block>) -> String {
    serde_json::to_string(&Outcome { blocks, ..Outcome::default() }.json()).unwrap()
}

#[test]
fn people_read_units_and_dashes_and_programs_si_and_null() {
    let text = laid_out(&table()).unwrap();
    assert_eq!(text.head, ["run", "speed [cm/s]", "drag [N]"]);
    assert_eq!(text.rows, [["slow", "50.0", "12.3"], ["fast", "100.0", "—"]]);
    assert_eq!(
        json(vec![table().into()]),
        r#"{"runs":[{"name":"slow","speed_m_s":0.5,"load":{"drag_n":12.345,"power_w":6.1725}},{"name":"fast","speed_m_s":1.0,"load":{"drag_n":null,"power_w":null}}]}"#
    );
}

/// Facts that are missing are left out for people, and are null for programs.
#[test]
fn facts_are_rows_for_people_and_values_for_programs() {
    let f = facts("tank", "the tank", &RUNS[1]);
    let facts = f.build(vec![
        f.number("depth_m", "depth [mm]", |r| r.speed_m_s),
        f.number("width_m", "width [mm]", |r| r.drag_n),
        f.interval("angles_rad", "angles [deg]", |_| [0.0, std::f64::consts::PI]),
    ]);
    assert_eq!(laid_out(&facts).unwrap().rows, [["depth", "1000", "mm"], ["angles", "[0, 180]", "deg"]]);
    assert_eq!(
        json(vec![facts.into()]),
        r#"{"tank":{"depth_m":1.0,"width_m":null,"angles_rad":[0.0,3.141592653589793]}}"#
    );
}

#[test]
fn tables_and_texts_of_one_key_are_one_list_and_sections_nest() {
    let t = TableBuilder::new("runs", "", &RUNS);
    let more = t.build(vec![t.flag("is_fast", "", |r| r.speed_m_s > 0.7)]);
    let part = |name: &str| {
        let texts = vec![name.to_owned()];
        Section { key: "parts[]".to_owned(), blocks: vec![Block::text("said", texts)], ..Section::default() }.into()
    };
    let mut first = table();
    first.columns.truncate(1);
    let blocks = vec![
        Block::text("remarks", vec!["one".to_owned()]),
        first.into(),
        more.into(),
        part("a"),
        part("b"),
        Block::text("remarks", vec!["two".to_owned()]),
        Block::text("", vec!["for people".to_owned()]),
    ];
    assert_eq!(
        json(blocks),
        r#"{"remarks":["one","two"],"runs":[{"name":"slow","is_fast":false},{"name":"fast","is_fast":true}],"parts":[{"said":["a"]},{"said":["b"]}]}"#
    );
}

/// A range of what was seen is no interval of uncertainty, and reads otherwise; a standard uncertainty has no zero of its unit.
#[test]
fn ranges_and_uncertainties_read_as_what_they_are() {
    let t = TableBuilder::new("", "", &RUNS);
    let roll = t.interval("roll_rad", "roll [deg]", |_| [-0.05, 0.05]);
    assert_eq!(roll.clone().text(0).unwrap(), "[−2.9, 2.9]");
    assert_eq!(roll.range().text(0).unwrap(), "−2.86 to 2.86");
    let water = t.uncertain(["temperature_k", "standard_k"], "water [degC]", |_| 288.15, |_| 0.2);
    assert_eq!(water.text(0).unwrap(), "15.00(20)");
}

/// Brackets that hold no unit belong to the name; the number is shown as it is.
#[test]
fn a_head_names_its_unit_in_brackets() {
    let t = TableBuilder::new("", "", &RUNS);
    let columns = [t.number("", "share [of all]", |_| 0.5), t.number("", "force [kN]", |_| 500.0)];
    assert_eq!((columns[0].head.as_str(), columns[0].unit.is_none()), ("share [of all]", true));
    assert_eq!((columns[1].head.as_str(), columns[1].text(0).unwrap().as_str()), ("force", "0.5000"));
    let programs_alone = t.build(vec![t.number("x_kg_m", "[kg m]", |_| 1.0)]);
    assert!(laid_out(&programs_alone).is_none());
}
