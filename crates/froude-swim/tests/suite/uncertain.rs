//! Draws and sensitivities of a robot whose record states a covariance.

use std::path::{Path, PathBuf};

use froude_records::estimate::TypeA;
use froude_records::json::{read_estimates, write_estimates};
use froude_swim::blueprint::Blueprint;
use froude_swim::draws::Beyond;
use froude_swim::gait::{Envelope, Gait};
use froude_swim::joints::Drives;
use froude_swim::robot::Robot;
use froude_swim::robot_file::{AddedFile, RobotFile, read_robot};
use froude_swim::shares::Distribution;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-swim/robot.toml")
}

fn answer(robot: &Robot) -> Option<[f64; 2]> {
    let gait = Gait::wave(30_f64.to_radians(), 80_f64.to_radians(), 40_f64.to_radians(), Envelope::Lateral);
    let swim = robot.swim(&gait, &Drives::free(robot.chain.joints()), None).ok()?;
    Some([swim.periodic.means.speed_m_s, swim.periodic.means.cost_j_m()])
}

/// The example with a covariance of f2: each coefficient's standard uncertainty is this part of it, the first two correlated by 0.5.
fn with_covariance(folder: &Path, part: &dyn Fn(&str) -> f64) -> RobotFile {
    covariance_of(read_robot(&example()).unwrap(), folder, part)
}

/// The same of any robot file.
pub fn covariance_of(mut file: RobotFile, folder: &Path, part: &dyn Fn(&str) -> f64) -> RobotFile {
    let mut record = read_estimates(&file.drag.path).unwrap();
    let id = file.drag.select.clone().unwrap();
    let e = record.estimates.iter_mut().find(|e| e.id == id).unwrap();
    let names: Vec<String> = e.coefficients.keys().cloned().collect();
    let u: Vec<f64> = e.coefficients.iter().map(|(name, c)| part(name) * c.value.unwrap().abs()).collect();
    let r = |i: usize, j: usize| if i == j { 1.0 } else { f64::from(u8::from(i + j == 1)) * 0.5 };
    let matrix = (0..u.len()).map(|i| (0..u.len()).map(|j| r(i, j) * u[i] * u[j]).collect()).collect();
    e.type_a = Some(TypeA { dof: vec![None; names.len()], names, matrix, kind: "classical".to_owned() });
    let path = folder.join("stated.json");
    write_estimates(&path, &record).unwrap();
    file.drag.path = path;
    file
}

/// All forces and all inertias times s: the motion is the same and the cost s times it. Elasticities of all coefficients, added mass and mass add up to 0 for speed and 1 for cost, whatever the law.
#[test]
fn elasticities_of_all_that_has_a_mass_add_up() {
    let file = read_robot(&example()).unwrap();
    let found = Blueprint::of(&file).unwrap().sensitivities(answer).unwrap();
    assert_eq!(found.standard, None);
    let mut sum = [0.0; 2];
    for s in found.each.iter().filter_map(|s| s.effects) {
        sum = [sum[0] + s[0].elasticity, sum[1] + s[1].elasticity];
    }
    let scaled = |s: f64| {
        let mut file = file.clone();
        for module in &mut file.modules {
            module.mass_kg *= s;
            module.inertia_kg_m2[2] *= s;
        }
        if let AddedFile::Declared(matrix) = &mut file.added_mass {
            matrix.iter_mut().flatten().for_each(|a| *a *= s);
        }
        answer(&Robot::of(&file).unwrap()).unwrap()
    };
    let (above, below) = (scaled(1.0 + 1e-3), scaled(1.0 - 1e-3));
    for k in 0..2 {
        sum[k] += (above[k] / below[k]).ln() / 2e-3;
        // Differences over a thousandth: a millionth of third derivatives of order one.
        assert!((sum[k] - k as f64).abs() < 1e-5, "{sum:?}");
    }
}

/// Sensitivities against Richardson's extrapolation of two wider differences.
#[test]
fn derivatives_are_those_of_wider_differences_extrapolated() {
    let blueprint = Blueprint::of(&read_robot(&example()).unwrap()).unwrap();
    let found = blueprint.sensitivities(answer).unwrap();
    for (j, s) in found.each.iter().enumerate() {
        let Some(effects) = s.effects else { continue };
        let difference = |part: f64| {
            let at = |side: f64| {
                let mut values = blueprint.values();
                values[j] *= 1.0 + side * part;
                answer(&blueprint.robot(&values)).unwrap()
            };
            let (above, below) = (at(1.0), at(-1.0));
            [0, 1].map(|k| (above[k] - below[k]) / (2.0 * part * s.number.value))
        };
        let (wide, close) = (difference(0.04), difference(0.02));
        for k in 0..2 {
            let expected = (4.0 * close[k] - wide[k]) / 3.0;
            let size = (answer(&blueprint.robot(&blueprint.values())).unwrap()[k] / s.number.value).abs();
            // Of what is proportional: h² of the differences, 1e-6, and the fourth power of 0.04.
            assert!(
                (effects[k].derivative - expected).abs() < 1e-5 * size,
                "{}: {effects:?} {expected}",
                s.number.name
            );
        }
    }
}

/// Four thousand draws have the stated covariance; small ones move speed and cost as the derivatives say.
#[test]
fn draws_have_the_covariance_and_move_the_speed_as_derivatives_say() {
    let folder = tempfile::tempdir().unwrap();
    let blueprint = Blueprint::of(&with_covariance(folder.path(), &|_| 0.02)).unwrap();
    let stated = blueprint.covariance().unwrap();
    let (n, mean) = (4000, blueprint.values());
    let draws = blueprint.draws(n, 3).unwrap();
    assert_eq!((draws.beyond, draws.values.len()), (Beyond::default(), n));
    for i in 0..mean.len() {
        for j in 0..mean.len() {
            let away = draws.values.iter().map(|x| (x[i] - mean[i]) * (x[j] - mean[j]));
            let found = away.sum::<f64>() / n as f64;
            // Five standard deviations of a covariance: √((1 + r²)/n) of the product of both.
            let size = (stated[i][i] * stated[j][j]).sqrt();
            assert!((found - stated[i][j]).abs() <= 5.0 * size * (1.25 / n as f64).sqrt(), "{i} {j}");
        }
    }
    assert_eq!(blueprint.draws(10, 3).unwrap().values, draws.values[..10]);
    assert_ne!(blueprint.draws(10, 4).unwrap().values, draws.values[..10]);

    let found = blueprint.sensitivities(answer).unwrap();
    let swum: Vec<[f64; 2]> = draws.values[..400].iter().map(|v| answer(&blueprint.robot(v)).unwrap()).collect();
    for k in 0..2 {
        let mean = swum.iter().map(|s| s[k]).sum::<f64>() / 400.0;
        let deviation = (swum.iter().map(|s| (s[k] - mean).powi(2)).sum::<f64>() / 399.0).sqrt();
        // Five standard deviations of one from 400 draws, 1/√800 each.
        assert!((deviation / found.standard.unwrap()[k] - 1.0).abs() < 0.18, "{deviation} {:?}", found.standard);
    }
    let known: Vec<f64> = found.each.iter().filter_map(|s| Some(s.effects?[0].known.unwrap())).collect();
    assert!(known.iter().all(|part| (0.0..=1.0 + 1e-12).contains(part)), "{known:?}");
}

/// A coefficient of which a third of all draws are negative: water would drive such a body, and each becomes the one with nothing of it.
#[test]
fn draws_that_water_would_drive_are_brought_to_the_nearest_body() {
    let folder = tempfile::tempdir().unwrap();
    let blueprint =
        Blueprint::of(&with_covariance(folder.path(), &|name| if name == "C_d_I" { 3.0 } else { 0.0 })).unwrap();
    let Some(at) = blueprint.numbers().iter().position(|c| c.name == "C_d_I" && c.value > 0.0) else {
        panic!("the example's f2 has no C_d_I: {:?}", blueprint.numbers())
    };
    let draws = blueprint.draws(300, 1).unwrap();
    // The slowest of the speeds that are looked at, 1 mm/s, sees a linear term beyond 1.86e-3 of a square one of 1.86.
    let least = -2e-3;
    assert!(draws.values.iter().all(|v| v[at] > least));
    let at_the_face = draws.values.iter().filter(|v| v[at] < 0.0).count();
    assert!(at_the_face >= draws.beyond.brought_back, "{at_the_face} {:?}", draws.beyond);
    // Below zero at −1/3 of a deviation: 0.369 of all.
    let part = draws.beyond.brought_back as f64 / 300.0;
    assert!((part - 0.369).abs() < 0.11, "{part}");
    assert_eq!(draws.beyond.refused, 0);
}

/// What is known to a millionth is drawn to a millionth, also by a law that shared out by origin gives single modules power, and the whole none.
#[test]
fn draws_shrink_onto_the_estimate_however_the_law_is_shared_out() {
    for distribution in [Distribution::Uniform, Distribution::ByOrigin] {
        let folder = tempfile::tempdir().unwrap();
        let mut file = read_robot(&example()).unwrap();
        file.drag.select = Some("circulation_tank_restricted/f4".to_owned());
        file.model.distribution = distribution;
        let blueprint = Blueprint::of(&covariance_of(file, folder.path(), &|_| 1e-6)).unwrap();
        assert_eq!(
            blueprint.driven_by_water(&blueprint.estimated::<froude_swim::chain::Chain>()).is_some(),
            distribution == Distribution::ByOrigin
        );
        let draws = blueprint.draws(50, 1).unwrap();
        for drawn in &draws.values {
            for (x, c) in drawn.iter().zip(blueprint.values()) {
                assert!((x - c).abs() <= 1e-5 * c.abs(), "{x} {c} {:?}", draws.beyond);
            }
        }
    }
}

/// Draws lie about the estimate without bounds, and as wide as its few degrees of freedom make them: t of 4 has a variance of 2.
#[test]
fn draws_lie_about_the_estimate_without_bounds_as_wide_as_its_dof() {
    let folder = tempfile::tempdir().unwrap();
    let mut file = with_covariance(folder.path(), &|_| 0.01);
    let mut record = read_estimates(&file.drag.path).unwrap();
    let id = file.drag.select.clone().unwrap();
    let e = record.estimates.iter_mut().find(|e| e.id == id).unwrap();
    let c = &mut e.coefficients["C_d_II"];
    c.effective_dof = Some(4.0);
    c.unconstrained = Some(1.05 * c.value.unwrap());
    let expected = (c.unconstrained.unwrap(), 0.01 * c.value.unwrap() * 2_f64.sqrt());
    file.drag.path = folder.path().join("bounded.json");
    write_estimates(&file.drag.path, &record).unwrap();
    let blueprint = Blueprint::of(&file).unwrap();
    let at = blueprint.numbers().iter().position(|c| c.name == "C_d_II").unwrap();
    let n = 4000;
    let draws = blueprint.draws(n, 1).unwrap();
    let mean = draws.values.iter().map(|v| v[at]).sum::<f64>() / n as f64;
    let mut away: Vec<f64> = draws.values.iter().map(|v| (v[at] - mean).abs()).collect();
    // Five standard deviations of a mean.
    assert!((mean - expected.0).abs() < 5.0 * expected.1 / (n as f64).sqrt(), "{mean} {expected:?}");
    // Half of t of 4 is within 0.741; a median is known to 1/(2 f √n) with a density 2·0.28 of its absolute value there.
    away.sort_by(f64::total_cmp);
    let half = away[n / 2] / (expected.1 / 2_f64.sqrt());
    assert!((half - 0.741).abs() < 5.0 / (2.0 * 0.56 * (n as f64).sqrt()), "{half}");
}

/// A published table has no interval, and says so.
#[test]
fn a_record_without_covariance_has_no_draws() {
    let told = Blueprint::of(&read_robot(&example()).unwrap()).unwrap().draws(10, 1).unwrap_err().to_string();
    assert!(told.contains("states neither covariance") && told.contains("leave out --draws"), "{told}");
}
