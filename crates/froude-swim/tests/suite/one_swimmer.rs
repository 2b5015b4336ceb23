//! One swimmer in both spaces: with servos, a recording, in a sweep and in draws, three dimensions are the plane where nothing leaves it; where something does, a mirrored gait has the mirrored path, and energy is kept.

use std::path::{Path, PathBuf};

use crate::uncertain::covariance_of;
use froude_swim::blueprint::Blueprint;
use froude_swim::chain::Chain as Planar;
use froude_swim::course::Recorded;
use froude_swim::drive::Following;
use froude_swim::dynamics::Dynamics;
use froude_swim::front::{Objective, front};
use froude_swim::gait::{Course, Envelope, Gait, Pitching, Shape};
use froude_swim::joints::Drives;
use froude_swim::robot::Robot;
use froude_swim::robot_file::{RobotFile, read_robot};
use froude_swim::spatial::chain::Chain;
use froude_swim::spatial::vector::Axis;
use froude_swim::state::Energy;
use froude_swim::sweep::{Axis as Range, Grid, Row};
use froude_swim::swim::Status;
use froude_swim::trajectory::Cut;

/// Of figures over a period: both searches repeat to 1e-9, and the same steps round apart.
const SAME: f64 = 1e-7;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-3d/robot.toml")
}

/// The example with joints that all yaw and its mass in the plane of them.
fn flat() -> RobotFile {
    let mut file = read_robot(&example()).unwrap();
    file.axes = vec![Axis::Yaw; file.axes.len()];
    file.modules.iter_mut().for_each(|module| module.centre_of_mass_m = [0.0; 3]);
    file
}

fn both(file: &RobotFile) -> (Robot<Planar>, Robot<Chain>) {
    (Robot::of(file).unwrap(), Robot::of(file).unwrap())
}

fn lateral() -> Gait {
    Gait::wave(30_f64.to_radians(), 80_f64.to_radians(), 40_f64.to_radians(), Envelope::Lateral)
}

/// A wave of yaw that turns, and one of pitch.
fn helix(side: f64) -> Gait {
    let axes = read_robot(&example()).unwrap().axes;
    let pitching = Some(Pitching { amplitude: 0.15, ahead: 1.2, turn: 0.02, axes });
    let yaw = lateral();
    Gait { amplitude: side * yaw.amplitude, turn: side * 0.05, pitching, ..yaw }
}

/// Servos with friction.
fn servos() -> Drives {
    let how = Following { stiffness_n_m: 8.0, damping_n_m_s: 0.3, viscous_n_m_s: 0.05, ..Following::default() };
    Drives { following: vec![how; 9], ..Drives::free(9) }
}

/// Two periods of a gait in rows.
fn recorded(gait: &Gait) -> Recorded {
    let time: Vec<f64> = (0..=120).map(|i| gait.period_s() * f64::from(i) / 60.0).collect();
    let (mut angles, mut shape) = (vec![Vec::new(); 9], Shape::straight(9));
    for t in &time {
        gait.at(*t, &mut shape);
        angles.iter_mut().zip(&shape.angle).for_each(|(row, angle)| row.push(*angle));
    }
    Recorded::track(&time, &angles).unwrap()
}

fn near(a: f64, b: f64, within: f64, what: &str) {
    assert!((a - b).abs() <= within * a.abs().max(b.abs()), "{what}: {a} {b}");
}

#[test]
fn servos_in_the_plane_have_the_motion_of_the_plane() {
    let (plane, space) = both(&flat());
    let a = plane.swim(&lateral(), &servos(), None).unwrap();
    let b = space.swim(&lateral(), &servos(), None).unwrap();
    let (m, n) = (a.periodic.means, b.periodic.means);
    assert!(m.friction_w > 0.02 * m.net_w, "{m:?}");
    for (a, b, what) in [
        (m.speed_m_s, n.speed_m_s, "speed"),
        (m.net_w, n.net_w, "net power"),
        (m.friction_w, n.friction_w, "friction"),
        (a.effort.needs.away_rad, b.effort.needs.away_rad, "distance from the gait"),
        (a.effort.needs.torque_n_m, b.effort.needs.torque_n_m, "torque"),
    ] {
        near(a, b, SAME, what);
    }
    let (a, b) = (a.effort.stiffness.unwrap(), b.effort.stiffness.unwrap());
    near(a.longest_step_s, b.longest_step_s, 1e-9, "step");
    assert!(b.longest_step_s.is_finite());
}

#[test]
fn a_recording_in_the_plane_has_the_path_of_the_plane() {
    let ((plane, space), track) = (both(&flat()), recorded(&lateral()));
    for drives in [Drives::free(9), servos()] {
        let a = plane.follow(&track, &drives, &Planar::REST, None).unwrap();
        let b = space.follow(&track, &drives, &Chain::REST, None).unwrap();
        assert!(a.passage.way_m[0].abs() > 0.05, "{a:?}");
        // A step integrates a heading there and a quaternion here: they differ by the fifth power of the turn of a step, some 0.03 rad, over 120, in 400 steps.
        for k in 0..2 {
            assert!((a.passage.way_m[k] - b.passage.way_m[k]).abs() < 1e-8, "{a:?} {b:?}");
        }
        assert!((a.passage.turn - b.passage.turn).abs() < 1e-8, "{a:?} {b:?}");
        near(a.means.net_w, b.means.net_w, 1e-9, "power");
        near(a.passage.gained_j[0], b.passage.gained_j[0], 1e-8, "energy");
        assert!(b.passage.gained_j[1].abs() < 1e-9 && b.passage.way_m[2].abs() < 1e-9, "{b:?}");
    }
}

#[test]
fn a_sweep_in_the_plane_has_the_rows_of_the_plane() {
    let (plane, space) = both(&flat());
    let mut grid = Grid::of(&lateral());
    grid.amplitude = Range { low: 0.3, high: 0.6, n: 2 };
    for drives in [Drives::free(9), servos()] {
        let rows = |row: &dyn Fn(&Gait) -> Row| (0..2).map(|i| row(&grid.gait(i))).collect::<Vec<Row>>();
        let of_plane = rows(&|gait| Row::of(&plane, &drives, None, gait, 0));
        let of_space = rows(&|gait| Row::of(&space, &drives, None, gait, 0));
        // Nothing rights this body: two multipliers of space are 1 but for differences, and lose no gait.
        let on_front = |rows: &[Row]| front(rows, [Objective::Speed, Objective::Cost]).len();
        assert_eq!(on_front(&of_plane), on_front(&of_space));
        for gait in (0..2).map(|i| grid.gait(i)) {
            let (a, b) = (Row::of(&plane, &drives, None, &gait, 0), Row::of(&space, &drives, None, &gait, 0));
            assert_eq!((a.status, b.status), (Status::Periodic, Status::Periodic));
            assert!((0.999..=1.0).contains(&b.get("floquet")));
            for name in ["amplitude", "speed", "power_net", "power_pos", "power_friction", "cot", "torque_peak"] {
                near(a.get(name), b.get(name), SAME, name);
            }
        }
    }
}

#[test]
fn draws_in_the_plane_have_the_figures_of_the_plane() {
    let folder = tempfile::tempdir().unwrap();
    let blueprint = Blueprint::of(&covariance_of(flat(), folder.path(), &|_| 0.1)).unwrap();
    let mut speeds = Vec::new();
    for values in &blueprint.draws(3, 1).unwrap().values {
        let a = blueprint.robot::<Planar>(values).swim(&lateral(), &Drives::free(9), None).unwrap().periodic.means;
        let b = blueprint.robot::<Chain>(values).swim(&lateral(), &Drives::free(9), None).unwrap().periodic.means;
        near(a.speed_m_s, b.speed_m_s, SAME, "speed");
        near(a.net_w, b.net_w, SAME, "power");
        speeds.push(b.speed_m_s);
    }
    // Coefficients that are known to a tenth move it by per cents.
    assert!((speeds[0] / speeds[1] - 1.0).abs() > 1e-3, "{speeds:?}");
    fn figures<C: Dynamics>(robot: &Robot<C>) -> Option<[f64; 2]> {
        let means = robot.swim(&lateral(), &Drives::free(9), None).ok()?.periodic.means;
        Some([means.speed_m_s, means.cost_j_m()])
    }
    let a = blueprint.sensitivities(figures::<Planar>).unwrap().standard.unwrap();
    let b = blueprint.sensitivities(figures::<Chain>).unwrap().standard.unwrap();
    // Differences over a thousandth of what is the same to 1e-9.
    near(a[0], b[0], 1e-5, "standard uncertainty");
}

/// Left and right exchanged: the path to the other side, as deep and as far, with the same powers.
#[test]
fn a_mirrored_gait_has_the_mirrored_path() {
    let robot = Robot::<Chain>::of(&read_robot(&example()).unwrap()).unwrap();
    let cut = Cut { moments: 60, apart_s: lateral().period_s() / 20.0, steps: 20 };
    for drives in [Drives::free(9), servos()] {
        let [a, b] = [1.0, -1.0].map(|side| {
            let begin = (&Chain::REST, &[][..]);
            robot.trajectory(&helix(side), &drives, begin, cut, [0.0; 2]).unwrap().pop().unwrap()
        });
        let ([roll, ..], [other, ..]) = (Chain::angles(&a.state.pose), Chain::angles(&b.state.pose));
        assert!(a.centre_m[1].abs() > 0.01 && a.centre_m[2].abs() > 1e-3, "{:?}", a.centre_m);
        for (k, side) in [1.0, -1.0, 1.0].into_iter().enumerate() {
            assert!((a.centre_m[k] - side * b.centre_m[k]).abs() < 1e-10, "{:?} {:?}", a.centre_m, b.centre_m);
        }
        assert!(roll.abs() > 1e-4 && (roll + other).abs() < 1e-9, "{roll} {other}");
        near(a.state.energy(Energy::Work), b.state.energy(Energy::Work), 1e-10, "work");
        let track = |side: f64| robot.follow(&recorded(&helix(side)), &drives, &Chain::REST, None).unwrap().passage;
        let (a, b) = (track(1.0), track(-1.0));
        assert!(a.turn.abs() > 0.01, "{a:?}");
        assert!((a.turn + b.turn).abs() < 1e-9 && (a.way_m[2] - b.way_m[2]).abs() < 1e-10, "{a:?} {b:?}");
    }
}

/// Of a sweep and of draws the same: the mirrored gait is as fast and turns to the other side.
#[test]
fn mirrored_gaits_have_mirrored_rows_for_drawn_robots_too() {
    let folder = tempfile::tempdir().unwrap();
    let blueprint = Blueprint::of(&covariance_of(read_robot(&example()).unwrap(), folder.path(), &|_| 0.1)).unwrap();
    let draws = blueprint.draws(2, 1).unwrap();
    for values in [&blueprint.values(), &draws.values[1]] {
        let robot = blueprint.robot::<Chain>(values);
        let row = |side: f64| Row::of(&robot, &Drives::free(9), None, &helix(side), 0);
        let (a, b) = (row(1.0), row(-1.0));
        assert_eq!((a.status, b.status), (Status::Periodic, Status::Periodic));
        near(a.get("speed"), b.get("speed"), SAME, "speed");
        near(a.get("power_net"), b.get("power_net"), SAME, "power");
        assert!(a.get("turn_rate").abs() > 1e-3, "{a:?}");
        near(a.get("turn_rate"), -b.get("turn_rate"), 1e-6, "turn");
    }
}

/// What motors give, drag and friction take, and the rest moves and lifts: of servos over a period, and over a recording from rest.
#[test]
fn servos_and_recordings_in_space_close_their_energy() {
    let robot = Robot::<Chain>::of(&read_robot(&example()).unwrap()).unwrap();
    let means = robot.swim(&helix(1.0), &servos(), None).unwrap().periodic.means;
    assert!(means.friction_w > 0.02 * means.net_w, "{means:?}");
    // Fourth order in some 400 steps a period.
    near(means.net_w, means.loss_w + means.friction_w + means.lifting_w, 1e-6, "period");
    for drives in [Drives::free(9), servos()] {
        // From rest with joints at full rate: steps of 22 ms are off by 1e-5, a tenth of them by 1e-9.
        let found = robot.follow(&recorded(&helix(1.0)), &drives, &Chain::REST, Some(2e-3)).unwrap();
        let of = |energy: Energy| found.passage.energy_j[energy as usize];
        let [kinetic, potential] = found.passage.gained_j;
        assert!(kinetic.abs() > 0.01 * of(Energy::Work) && potential.abs() > 1e-4, "{found:?}");
        let taken = of(Energy::Loss) + of(Energy::Friction) + kinetic + potential;
        near(of(Energy::Work), taken, 1e-6, "recording");
    }
}

/// A gait that is unstable in the plane: in three dimensions too the figures are of the circle that it settles into, with the straight motion beside them.
#[test]
fn an_unstable_gait_settles_into_the_circle_of_the_plane() {
    let mut file = flat();
    file.drag.path = example().with_file_name("../mamba/published/cfd.json");
    file.drag.select = Some("cfd/f6".to_owned());
    file.modules.iter_mut().for_each(|module| module.centre_of_mass_m = [0.0, 0.0, 0.004]);
    let gait = Gait { amplitude: 20_f64.to_radians(), phase: 60_f64.to_radians(), ..lateral() };
    let (plane, space) = both(&file);
    let a = plane.swim(&gait, &Drives::free(9), None).unwrap();
    let b = space.swim(&gait, &Drives::free(9), None).unwrap();
    // The head rolls by hundredths of a degree on the circle.
    near(a.periodic.means.net_w, b.periodic.means.net_w, 1e-3, "circle");
    near(a.unstable.unwrap().means.speed_m_s, b.unstable.unwrap().means.speed_m_s, 1e-5, "straight");
}
