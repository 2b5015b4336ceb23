//! What every report holds, whatever it is made from.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod sample;

use std::sync::Arc;

use froude_records::block::{Block, Section, TableBuilder};
use froude_records::comparison::{
    AddedTerms, CoefficientComparison, Comparison, JointComparison, LargestCoefficient, LargestLoad, LoadComparison,
    Side, Verdict,
};
use froude_records::estimate::{Coefficient, Estimate, Measured, Range, Status};
use froude_records::finding::{Finding, Severity};
use froude_records::page::Chart;
use froude_report::{
    Abscissa, Against, BudgetRow, Curve, InputFile, Observed, Point, Report, SelectionRow, SourceSection, figures, html,
};
use proptest::prelude::*;

/// The text between tags, entities left as they are.
fn visible_text(page: &str) -> String {
    let body = page.split_once("</style>").expect("a style element").1;
    let mut out = String::new();
    let mut is_tag = false;
    for c in body.chars() {
        match c {
            '<' => is_tag = true,
            '>' => {
                is_tag = false;
                out.push(' ');
            }
            c if !is_tag => out.push(c),
            _ => {}
        }
    }
    out
}

/// Values of all attributes that load or link.
fn links(page: &str) -> Vec<String> {
    ["src=\"", "href=\"", "url(", "@import", "action=\"", "data=\""]
        .iter()
        .flat_map(|key| {
            page.match_indices(key)
                .map(|(at, _)| page[at + key.len()..].split(['"', ')']).next().unwrap_or("").to_owned())
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A small check that elements close in the order in which they open.
fn is_well_formed(svg: &str) -> bool {
    let mut open: Vec<&str> = Vec::new();
    for piece in svg.split('<').skip(1) {
        let Some((tag, _)) = piece.split_once('>') else { return false };
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name.trim()) {
                return false;
            }
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap_or(""));
        }
    }
    open.is_empty()
}

#[test]
fn every_coefficient_of_every_estimate_appears() {
    let report = sample::report();
    let page = html(&report);
    let estimates = report.sources.iter().flat_map(|s| &s.estimates).chain(&report.published);
    for estimate in estimates {
        for name in estimate.coefficients.keys() {
            assert!(page.contains(&format!("<code>{name}</code>")), "{name} of {}", estimate.id);
        }
    }
    // Values, in the short form and with their expanded uncertainty.
    assert!(page.contains("0.01330(96)") && page.contains("0.0133 ± 0.0019"));
    assert!(page.contains("k*G_T*C_f_II + G_HTx*C_fHT_II"));
}

#[test]
fn the_page_loads_nothing_and_runs_nothing() {
    let page = html(&sample::report());
    for link in links(&page) {
        assert!(link.starts_with('#'), "{link}");
    }
    assert!(!page.contains("<script") && !page.contains("<link") && !page.contains("<img"));
}

#[test]
fn every_link_of_the_navigation_has_its_place_and_ids_are_unique() {
    let page = html(&sample::report());
    for link in links(&page) {
        assert!(page.contains(&format!("id=\"{}\"", &link[1..])), "{link}");
    }
    let mut ids: Vec<&str> =
        page.match_indices(" id=\"").map(|(at, _)| page[at + 5..].split('"').next().unwrap()).collect();
    let n = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), n);
}

#[test]
fn tables_have_captions_and_figures_have_titles_and_descriptions() {
    let report = sample::report();
    let page = html(&report);
    assert_eq!(page.matches("<table").count(), page.matches("<caption>").count());
    let figures = figures(&report);
    assert_eq!(page.matches("<figure").count(), figures.len());
    assert_eq!(page.matches("<figcaption>").count(), figures.len());
    for figure in &figures {
        assert!(figure.svg.contains("<title") && figure.svg.contains("<desc") && figure.svg.contains("role=\"img\""));
        assert!(page.contains(&figure.svg), "{}", figure.file_name);
    }
}

#[test]
fn figures_are_well_formed_and_have_names_of_their_own() {
    let figures = figures(&sample::report());
    assert!(figures.len() > 15);
    let mut names: Vec<&str> = figures.iter().map(|f| f.file_name.as_str()).collect();
    for figure in &figures {
        assert!(is_well_formed(&figure.svg), "{}", figure.file_name);
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"), "{}", figure.file_name);
        assert_eq!(figure.file_name.rsplit_once('.').map(|(_, end)| end), Some("svg"));
        let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_.".contains(c);
        assert!(figure.file_name.chars().all(allowed), "{}", figure.file_name);
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), figures.len());
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    assert_eq!(html(&sample::report()), html(&sample::report()));
}

fn coefficient(value: Option<f64>, status: Status) -> Coefficient {
    Coefficient::of(value, "1", status)
}

fn estimate(source: &str, model: &str, coefficients: &[(&str, Coefficient)]) -> Estimate {
    Estimate {
        id: format!("{source}/{model}"),
        source: source.to_owned(),
        kind: "tank".to_owned(),
        law: froude_records::estimate::Law { name: model.to_owned(), ..Default::default() },
        coefficients: coefficients.iter().map(|(n, c)| ((*n).to_owned(), c.clone())).collect(),
        recommended: true,
        not_contradicted: Vec::new(),
        ..Estimate::default()
    }
}

fn report_of(estimates: Vec<Estimate>) -> Report {
    let section = SourceSection { name: "tank".to_owned(), estimates, ..SourceSection::default() };
    let data = vec![InputFile { path: "tank.csv".to_owned(), ..InputFile::default() }];
    Report { title: "t".to_owned(), sources: vec![section], data, ..Report::default() }
}

/// A value of zero or NaN behind an undetermined coefficient must not leak.
#[test]
fn undetermined_is_a_dash_and_never_a_number() {
    for value in [None, Some(0.0), Some(f64::NAN), Some(7.25)] {
        let mut undetermined = coefficient(value, Status::Undetermined);
        undetermined.standard_uncertainty = Some(0.0);
        undetermined.type_a = Some(3.25);
        undetermined.effective_dof = Some(f64::NAN);
        undetermined.interval_95 = Some([6.5, 8.5]);
        let page = html(&report_of(vec![estimate("tank", "f3", &[("C_f_II", undetermined)])]));
        let text = visible_text(&page);
        assert!(text.contains('—'), "{value:?}");
        for wrong in ["NaN", "7.25", "3.25", "3.2", "6.5", " 0 ", "inf"] {
            assert!(!text.contains(wrong), "{value:?}: {wrong}");
        }
        assert!(page.contains("not determined by these data"));
    }
}

#[test]
fn marks_tell_what_became_of_a_coefficient() {
    let mut prior = coefficient(Some(0.5), Status::Prior);
    prior.standard_uncertainty = Some(0.012);
    let page = html(&report_of(vec![estimate(
        "tank",
        "f4",
        &[
            ("C_f_I", coefficient(Some(0.0), Status::AtBound)),
            ("C_d_I", coefficient(Some(0.0), Status::BoundContradicted)),
            ("C_f_II", coefficient(Some(0.0133), Status::Fixed)),
            ("C_d_II", prior),
            ("C_XY_I", coefficient(Some(0.0), Status::Excluded)),
            ("C_XY_II", coefficient(Some(0.46), Status::Free)),
        ],
    )]));
    let text = visible_text(&page).split_whitespace().collect::<Vec<_>>().join(" ");
    for sentence in [
        "0 (bound)",
        "0 (bound contradicted)",
        "0.0133 (fixed)",
        "0.500(12) (prior)",
        "excluded",
        "0.46 †",
        "† no uncertainty stated",
    ] {
        assert!(text.contains(sentence), "{sentence}");
    }
}

#[test]
fn a_published_value_without_uncertainty_is_open_and_says_so() {
    let report = sample::report();
    let page = html(&report);
    assert!(page.contains("no uncertainty stated"));
    let forest = figures(&report).into_iter().find(|f| f.title.contains("model f4")).unwrap();
    assert!(forest.svg.contains("no interval stated"));
    assert!(!page.contains("± 0<") && !page.contains("(0)"));
}

fn observed(configuration: &str, component: &str, unit: &str) -> Arc<Observed> {
    let [configuration, component, unit] = [configuration, component, unit].map(str::to_owned);
    Arc::new(Observed { configuration, component, unit, other: None })
}

const HOSTILE: &str = "\"><script>alert('x')</script><svg onload=x>&amp;\u{0}\u{7}\u{e000}";

#[test]
fn hostile_names_are_escaped_everywhere() {
    let h = || HOSTILE.to_owned();
    let mut e = estimate(HOSTILE, HOSTILE, &[(HOSTILE, coefficient(Some(1.0), Status::Free))]);
    let kind = &mut e.type_a.get_or_insert_default().kind;
    for text in [&mut e.method.words, &mut e.frame.words, &mut e.kind, &mut e.point.words, kind] {
        *text = h();
    }
    e.undetermined = vec![h()];
    e.diagnostics.notes = vec![h()];
    e.law.outputs.insert(h(), froude_records::estimate::Output { unit: h(), formula: Some(h()) });
    e.refers_to.insert(h(), Measured::of(1.0, h()));
    e.sigma.insert(h(), Measured::of(1.0, h()));
    e.validity.insert(h(), Range::of([0.0, 1.0], h()));
    let side = || Side { source: h(), value: Some(1.0), ..Side::default() };
    let table = TableBuilder::new("", h(), &[()]);
    let report = Report {
        title: h(),
        subtitle: h(),
        date: Some(h()),
        method: vec![h()],
        blocks: vec![Section::new(
            h(),
            [
                Block::words([h()]),
                table.build(vec![table.text("", &h(), |()| h())]).into(),
                Chart { title: h(), caption: h(), ..Chart::default() }.into(),
            ],
        )],
        sources: vec![SourceSection {
            not_fitted: Vec::new(),
            name: h(),
            kind: h(),
            facts: vec![(h(), h())],
            estimates: vec![e.clone()],
            sample_of: None,
            points: vec![Point { of: observed(&h(), &h(), &h()), measured: 1.0, ..Point::default() }],
            curves: vec![Curve {
                configuration: h(),
                component: h(),
                unit: h(),
                model: h(),
                against: Against::Other { quantity: h(), unit: h() },
                x: vec![0.0, 1.0],
                y: vec![0.0, 1.0],
                held: Vec::new(),
                low: vec![],
                high: vec![],
            }],
            budget: vec![BudgetRow {
                model: h(),
                coefficient: h(),
                input: h(),
                shared: h(),
                unit: h(),
                contribution: 1.0,
                share: 1.0,
            }],
            selection: vec![SelectionRow {
                model: h(),
                component: h(),
                cross_validation: Err(h()),
                ..SelectionRow::default()
            }],
            tests: vec![AddedTerms { law: h(), of: h(), component: h(), ..AddedTerms::default() }],
            recommendation: h(),
        }],
        published: vec![e],
        findings: vec![Finding { place: Some(h()), ..Finding::new(Severity::Error, HOSTILE, h()).of_source(HOSTILE) }],
        data: vec![InputFile { path: h(), sha256: h(), n_rows: None, n_used: None, source: Some(h()) }],
        versions: [(h(), h())].into(),
        citations: vec![h()],
        comparison: Some(Comparison {
            verdicts: vec![Verdict {
                first: h(),
                second: h(),
                load: Some(LargestLoad { component: h(), ..LargestLoad::default() }),
                coefficient: Some(LargestCoefficient { coefficient: h(), ..LargestCoefficient::default() }),
                ..Verdict::default()
            }],
            coefficients: vec![CoefficientComparison {
                model: h(),
                coefficient: h(),
                label: None,
                unit: h(),
                first: side(),
                second: side(),
                e_n: None,
                note: h(),
            }],
            joint: vec![JointComparison {
                model: h(),
                first: h(),
                second: h(),
                note: h(),
                ..JointComparison::default()
            }],
            loads: vec![LoadComparison {
                component: h(),
                unit: h(),
                first: side(),
                second: side(),
                note: h(),
                ..LoadComparison::default()
            }],
            validation: Vec::new(),
            coverage: vec![h()],
            findings: vec![Finding::new(Severity::Note, HOSTILE, h())],
        }),
    };
    let page = html(&report);
    assert!(!page.contains("<script") && !page.contains("<svg onload"));
    for figure in figures(&report) {
        assert!(is_well_formed(&figure.svg), "{}", figure.file_name);
        assert!(!figure.svg.contains('\u{0}') && !figure.svg.contains("<script"));
    }
}

fn words(page: &str) -> String {
    visible_text(page).split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn what_no_model_can_be_scored_on_is_said_once() {
    let row = |model: &str, component: &str| SelectionRow {
        model: model.to_owned(),
        component: component.to_owned(),
        delta_aicc: Ok(0.0),
        cross_validation: Err(
            "not possible: leaving one configuration out needs at least three configurations; the table has 2"
                .to_owned(),
        ),
        ..SelectionRow::default()
    };
    let mut e = estimate("tank", "f1", &[("C_d", coefficient(Some(1.0), Status::Free))]);
    e.diagnostics.cross_validation_note = row("f1", "f_x").cross_validation.err();
    let mut report = report_of(vec![e]);
    report.sources[0].selection = vec![row("f1", "f_x"), row("f1", "f_y"), row("f2", "f_x"), row("f2", "f_y")];
    let text = words(&html(&report));
    assert_eq!(text.matches("leaving one configuration out").count(), 1, "{text}");
    assert!(text.contains(
        "Cross-validation is not possible: leaving one configuration out needs at least three configurations; the table has 2."
    ));
}

#[test]
fn a_model_without_an_aicc_has_a_footnote() {
    let row = |model: &str, delta_aicc: Result<f64, String>| SelectionRow {
        model: model.to_owned(),
        component: "f_x".to_owned(),
        delta_aicc,
        cross_validation: Ok(0.1),
        ..SelectionRow::default()
    };
    let mut report = report_of(Vec::new());
    report.sources[0].selection =
        vec![row("quadratic", Ok(0.0)), row("power_law_x", Err("no AICc: an exact fit".to_owned()))];
    let text = words(&html(&report));
    assert!(text.contains("power_law_x 0 — — — 1 0.100"), "{text}");
    assert!(text.contains("1 no AICc: an exact fit."), "{text}");
}

#[test]
fn predicted_loads_say_what_their_uncertainty_is() {
    let text = words(&html(&sample::report()));
    assert!(text.contains("± U: expanded uncertainty, 95 %, U = k·u"));
    assert!(
        text.contains("circulation tank: k = 2.00 (Student&#39;s t, effective degrees of freedom 57.3)")
            || text.contains("circulation tank: k = 2.00 (Student's t, effective degrees of freedom 57.3)"),
        "{text}"
    );
}

#[test]
fn sources_of_the_same_data_get_words_and_no_normalised_difference() {
    const SAME: &str = "same data: not independent, E_n not meaningful";
    let side = |source: &str| Side {
        source: source.to_owned(),
        value: Some(-4.25),
        standard_uncertainty: Some(0.5),
        expanded_uncertainty: Some(1.0),
        ..Side::default()
    };
    let coefficient =
        CoefficientComparison { first: side("a"), second: side("b"), note: SAME.to_owned(), ..Default::default() };
    let force = LoadComparison { first: side("a"), second: side("b"), note: SAME.to_owned(), ..Default::default() };
    let comparison = Comparison {
        coefficients: vec![coefficient.clone(), coefficient],
        loads: vec![force.clone(), force],
        ..Comparison::default()
    };
    let text = words(&html(&Report { comparison: Some(comparison), ..Report::default() }));
    assert_eq!(text.matches(SAME).count(), 2, "below the coefficients and below the loads: {text}");
    assert!(
        text.contains(&format!("no E_n: {SAME}")) && text.contains(&format!("no E_n of b against a: {SAME}")),
        "{text}"
    );
    assert!(text.contains("−4.2 ± 1.0"), "{text}");
}

#[test]
fn an_empty_report_is_a_page() {
    let page = html(&Report::default());
    assert!(page.contains("No source was fitted") && page.contains("No data file is recorded"));
    assert!(figures(&Report::default()).is_empty());
}

#[test]
fn many_configurations_are_spread_over_figures_of_at_most_nine_panels() {
    let points: Vec<Point> = (0..23)
        .flat_map(|k| {
            (0..5).map(move |i| Point {
                of: observed(&format!("body {k}"), "f_x", "N"),
                speed_m_s: f64::from(i) * 0.1,
                measured: -f64::from(i * i),
                fitted: -f64::from(i * i) + 0.1,
                ..Point::default()
            })
        })
        .collect();
    let section = SourceSection { name: "tank".to_owned(), points, ..SourceSection::default() };
    let report = Report { sources: vec![section], ..Report::default() };
    let figures = figures(&report);
    let loads: Vec<_> = figures.iter().filter(|f| f.title.contains("against speed")).collect();
    assert_eq!(loads.len(), 3);
    for k in 0..23 {
        assert!(loads.iter().any(|f| f.svg.contains(&format!(">body {k}</tspan>"))), "body {k}");
    }
    assert!(loads[0].caption.contains("(1 of 3)"));
}

#[test]
fn a_million_points_give_a_picture_that_can_be_opened() {
    let of = observed("", "f_x", "N");
    let points: Vec<Point> = (0..200_000u32)
        .map(|i| Point {
            of: of.clone(),
            speed_m_s: f64::from(i) * 1e-5,
            measured: f64::from(i % 97),
            fitted: 48.0,
            ..Point::default()
        })
        .collect();
    let section = SourceSection { name: "tank".to_owned(), points, ..SourceSection::default() };
    let page = html(&Report { sources: vec![section], ..Report::default() });
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    assert!(page.contains("observations are not drawn") && page.contains("thinned"));
}

/// Loads against a channel of its own: a rotor's rate at no speed.
#[test]
fn another_abscissa_gets_its_own_axis() {
    let other = Some(["w_x", "rad/s"].map(str::to_owned));
    let of = Arc::new(Observed { other, ..Observed::clone(&observed("", "m_x", "N m")) });
    let points = (0..6)
        .map(|i| Point {
            of: of.clone(),
            other: f64::from(i),
            measured: -0.849 + 0.01 * f64::from(i),
            fitted: -0.849 + 0.01 * f64::from(i),
            ..Point::default()
        })
        .collect();
    let section = SourceSection { name: "tare".to_owned(), points, ..SourceSection::default() };
    let figures = figures(&Report { sources: vec![section], ..Report::default() });
    assert!(figures[0].title.contains("against w_x"), "{}", figures[0].title);
    assert!(figures[0].svg.contains(" [rad/s]"));
}

/// A 6×6 added mass stands as a matrix; what does not fit into it stands below.
#[test]
fn an_added_mass_is_printed_as_a_matrix() {
    let mut own: Vec<(String, Coefficient)> = (1..=6)
        .flat_map(|i| (1..=6).map(move |j| (format!("A{i}{j}"), f64::from(i * 10 + j) / 8.0)))
        .map(|(name, value)| (name, coefficient(Some(value), Status::Free)))
        .collect();
    own.push(("A11_body_2".to_owned(), coefficient(Some(0.33), Status::Free)));
    let borrowed: Vec<(&str, Coefficient)> = own.iter().map(|(n, c)| (n.as_str(), c.clone())).collect();
    let page = html(&report_of(vec![estimate("tank", "added_mass_6x6", &borrowed)]));
    for word in ["surge", "yaw", "title=\"A66\"", "A11_body_2"] {
        assert!(page.contains(word), "{word}");
    }
}

/// Numbers that hurt: the edges of the doubles among ordinary ones.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -10.0..10.0f64,
        prop::sample::select(vec![
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            5e-324,
            1e300,
            -1e300,
        ]),
    ]
}

fn any_status() -> impl Strategy<Value = Status> {
    prop::sample::select(vec![
        Status::Free,
        Status::AtBound,
        Status::Fixed,
        Status::Excluded,
        Status::Prior,
        Status::Undetermined,
        Status::BoundContradicted,
    ])
}

fn numbers(n: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(any_number(), n)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// No numbers bring the report down, and none of them is printed as NaN.
    #[test]
    fn any_numbers_give_a_page(
        status in any_status(),
        values in numbers(8..9),
        loads in prop::collection::vec((any_number(), any_number(), any_number(), any_number()), 0..12),
        x in numbers(0..6),
        y in numbers(0..6),
        band in numbers(0..6),
        against in 0..3,
    ) {
        let mut c = coefficient(Some(values[0]), status);
        c.standard_uncertainty = Some(values[1]);
        c.interval_95 = Some([values[2], values[3]]);
        (c.type_a, c.type_b, c.effective_dof) = (Some(values[4]), Some(values[5]), Some(values[6]));
        let mut e = estimate("tank", "f4", &[("C_d_II", c.clone()), ("C_f_II", c)]);
        e.validity.insert("speed".to_owned(), Range::of([values[0], values[1]], "rad"));
        e.sigma.insert("f_x".to_owned(), Measured::of(values[2], "N"));
        e.refers_to.insert("density".to_owned(), Measured::of(values[7], "kg/m^3"));
        e.diagnostics.relative_residual.insert("f_x".to_owned(), values[3]);
        e.diagnostics.condition_number = Some(values[4]);
        let side = Side { source: "s".to_owned(), value: Some(values[0]), standard_uncertainty: Some(values[1]), expanded_uncertainty: Some(values[2]), ..Side::default() };
        let section = SourceSection {
            name: "tank".to_owned(),
            estimates: vec![e.clone()],
            points: loads.iter().enumerate().map(|(i, (a, b, f, g))| Point {
                of: observed(&format!("H{}LT", i % 3), "f_x", "N"),
                speed_m_s: *a,
                angle_rad: *b,
                measured: *f,
                fitted: *g,
                standard: Some(values[5]),
                other: 0.0,
            }).collect(),
            curves: vec![Curve {
                configuration: "H1LT".to_owned(),
                component: "f_x".to_owned(),
                unit: "N".to_owned(),
                model: "f4".to_owned(),
                against: match against {
                    0 => Against::Speed { angle_rad: values[0] },
                    1 => Against::Angle { speed_m_s: values[0] },
                    _ => Against::Other { quantity: "w_x".to_owned(), unit: "rad/s".to_owned() },
                },
                held: Vec::new(),
                x, y,
                low: band.clone(),
                high: band,
            }],
            budget: vec![BudgetRow { model: "f4".to_owned(), coefficient: "C_d_II".to_owned(), input: "speed".to_owned(),
                shared: "run".to_owned(), contribution: values[6], unit: "1".to_owned(), share: values[7] }],
            selection: vec![SelectionRow { model: "f4".to_owned(), component: "f_x".to_owned(), sigma: values[0],
                delta_aicc: Ok(values[1]), cross_validation: Ok(values[2]), range_blocks: vec![("r".to_owned(), values[3])],
                lack_of_fit_p: Some(values[4]), ..SelectionRow::default() }],
            tests: vec![AddedTerms { f: values[5], dof: [values[6], values[7]], p: values[0], ..AddedTerms::default() }],
            ..SourceSection::default()
        };
        let report = Report {
            sources: vec![section],
            published: vec![e],
            comparison: Some(Comparison {
                verdicts: vec![Verdict {
                    load: Some(LargestLoad { speed_m_s: values[1], angle_rad: values[5], e_n: values[0], ..LargestLoad::default() }),
                    p: Some(values[4]),
                    ..Verdict::default()
                }],
                coefficients: vec![CoefficientComparison { first: side.clone(), second: side.clone(), e_n: Some(values[2]), ..CoefficientComparison::default() }],
                joint: vec![JointComparison { chi_squared: Some(values[3]), p: Some(values[4]), dof: Some(7), ..JointComparison::default() }],
                loads: vec![LoadComparison { first: side.clone(), second: side, speed_m_s: values[6], angle_rad: values[7], e_n: Some(values[0]), ..LoadComparison::default() }],
                ..Comparison::default()
            }),
            ..Report::default()
        };
        let page = html(&report);
        prop_assert!(!visible_text(&page).contains("NaN"));
        prop_assert!(!page.contains("=\"NaN") && !page.contains("=\"inf"));
        for figure in figures(&report) {
            prop_assert!(is_well_formed(&figure.svg));
            prop_assert!(figure.svg.len() < 500_000, "{} bytes", figure.svg.len());
        }
    }
}

/// Estimates side by side are pairs, and the page costs so much a pair: twice the estimates take four times as long, and not sixteen times.
#[test]
fn a_comparison_costs_as_much_as_it_has_pairs() {
    let page = |estimates: usize| {
        let side = |i: usize| Side { source: format!("source {i}/quadratic"), value: Some(1.0), ..Side::default() };
        let pairs = (0..estimates).flat_map(|i| (i + 1..estimates).map(move |j| (i, j)));
        let coefficients = pairs
            .map(|(i, j)| CoefficientComparison {
                model: "quadratic".to_owned(),
                coefficient: "D_x_II".to_owned(),
                label: None,
                unit: "kg/m".to_owned(),
                first: side(i),
                second: side(j),
                note: "no uncertainty stated".to_owned(),
                ..CoefficientComparison::default()
            })
            .collect();
        Report { comparison: Some(Comparison { coefficients, ..Comparison::default() }), ..Report::default() }
    };
    let seconds = |report: &Report| {
        let once = || {
            let begun = std::time::Instant::now();
            let page = html(report);
            assert!(page.contains("further pairs of coefficients"));
            begun.elapsed().as_secs_f64()
        };
        (0..3).map(|_| once()).fold(f64::INFINITY, f64::min)
    };
    let [half, whole] = [150, 300].map(|n| seconds(&page(n)));
    assert!(whole < 8.0 * half, "{half} s for 150 estimates, {whole} s for 300");
}

/// A law of speed and acceleration is drawn at one acceleration, and the caption says at which.
#[test]
fn a_line_says_what_else_it_holds() {
    let mut source = sample::report().sources.remove(0);
    for curve in &mut source.curves {
        curve.held = vec![Abscissa { quantity: "a_x".to_owned(), unit: "m/s^2".to_owned(), value: 0.125 }];
    }
    let report = Report { sources: vec![source.clone()], ..Report::default() };
    let page = visible_text(&html(&report));
    assert!(page.contains("with its 95 % band, for a_x = 0.125 m/s²."), "{page}");
    for (i, curve) in source.curves.iter_mut().enumerate() {
        curve.held[0].value = i as f64;
    }
    let page = visible_text(&html(&Report { sources: vec![source], ..Report::default() }));
    assert!(page.contains("for a_x at its median in each panel."), "{page}");
}
