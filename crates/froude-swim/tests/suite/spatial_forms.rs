//! Three dimensions: the O(n) engine against the links one by one, and against the engine of the plane where nothing leaves it.

use crate::adaptive;
use crate::dense;
use froude_hydro::similarity::GRAVITY_M_S2;
use froude_swim::chain::{AddedMass, Chain as Planar, Link as PlanarLink};
use froude_swim::drag::{Cross, LinkDrag as PlanarDrag, Turning};
use froude_swim::dynamics::{Dynamics, StateOf};
use froude_swim::engine::{Given, Joints, Workspace as PlanarWorkspace};
use froude_swim::gait::{Envelope, Gait};
use froude_swim::path::Swimmer;
use froude_swim::planar;
use froude_swim::spatial::attitude::{of_angles, world_from_body};
use froude_swim::spatial::chain::{Chain, Link};
use froude_swim::spatial::drag::LinkDrag;
use froude_swim::spatial::engine::{Head, Workspace};
use froude_swim::spatial::vector::{Axis, Inertia};
use froude_swim::state::Energy;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A link with all that a link may have: centres anywhere, a full tensor, an added mass that is a sum of squares.
fn any_link(rng: &mut Pcg64Mcg) -> Link {
    let mut any = |low: f64, high: f64| rng.random_range(low..high);
    let half_length_m = any(0.05, 0.12);
    let mass_kg = any(0.8, 1.6);
    let roll = any(1e-3, 2e-3);
    let turn = mass_kg * half_length_m.powi(2) / 3.0;
    let (k, m) = (any(-2e-4, 2e-4), any(-2e-4, 2e-4));
    let centre = [any(-0.02, 0.02), any(-0.01, 0.01), any(-0.02, 0.02)];
    let tensor = [[roll, k, 0.0], [k, turn, m], [0.0, m, turn + 0.5 * roll]];
    let sizes = [0.3, 1.3, 0.9, 0.01, 0.05, 0.07];
    let rows: [[f64; 6]; 6] = std::array::from_fn(|_| std::array::from_fn(|j| sizes[j] * any(-0.5, 0.5)));
    let mut added = [[0.0; 6]; 6];
    for i in 0..6 {
        added[i][i] = 0.25 * sizes[i] * sizes[i];
        for j in 0..6 {
            added[i][j] += rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
        }
    }
    Link {
        half_length_m,
        rigid: Inertia::rigid(mass_kg, tensor, centre),
        added: Inertia::of_added_mass(&added),
        drag: LinkDrag {
            along: [any(0.0, 0.2), any(0.0, 2.0)],
            sideways: [any(0.0, 0.5), any(0.0, 20.0)],
            upright: [any(0.0, 0.5), any(0.0, 20.0)],
            cross: Some(Cross { of_speed: [any(-0.1, 0.1), any(0.0, 1.0)], smooth_m_s: 1e-2 }),
            roll: [any(0.0, 1e-2), any(0.0, 1e-2)],
        },
        weight_n: mass_kg * GRAVITY_M_S2,
        centre_of_mass_m: centre,
        buoyancy_n: any(0.9, 1.1) * mass_kg * GRAVITY_M_S2,
        centre_of_buoyancy_m: [any(-0.02, 0.02), any(-0.01, 0.01), any(-0.02, 0.02)],
    }
}

/// Rounding grows with the chain: 1e-12 for each link, relative to the largest acceleration or torque.
#[test]
fn the_engine_has_the_accelerations_of_the_links_one_by_one() {
    let mut rng = Pcg64Mcg::seed_from_u64(15);
    for n in 1..=20 {
        let links = (0..n).map(|_| any_link(&mut rng)).collect();
        let joints = (1..n).map(|_| if rng.random_range(0..2) == 0 { Axis::Yaw } else { Axis::Pitch }).collect();
        let chain = Chain { links, joints };
        let mut any = |size: f64| rng.random_range(-size..size);
        let state = dense::State {
            attitude: of_angles([any(3.0), any(1.5), any(3.0)]),
            head: std::array::from_fn(|_| any(1.0)),
            angle: (1..n).map(|_| any(1.5)).collect(),
            rate: (1..n).map(|_| any(2.0)).collect(),
        };
        let torque: Vec<f64> = (1..n).map(|_| any(0.5)).collect();
        let expected = dense::rates(&chain, &state, Given::Torque(&torque)).unwrap();
        let joints = Joints { angle: &state.angle, rate: &state.rate };
        let head = Head { motion: state.head, down: world_from_body(state.attitude)[2] };
        let mut work = Workspace::new(&chain);
        let found = work.evaluate(&chain, head, joints, Given::Torque(&torque)).unwrap();
        let largest = expected.joints.iter().chain(&expected.head).fold(1.0_f64, |m, x| m.max(x.abs()));
        let near = |a: &f64, b: &f64, what: &str| {
            assert!((a - b).abs() <= 1e-12 * f64::from(n) * largest, "{n} links, {what}: {a} {b}");
        };
        found.iter().zip(&expected.head).for_each(|(a, b)| near(a, b, "head"));
        work.answer.iter().zip(&expected.joints).for_each(|(a, b)| near(a, b, "joint"));
        // Prescribed, the same accelerations need the same torques, in both.
        let given = Given::Acceleration(&expected.joints);
        let by_dense = dense::rates(&chain, &state, given).unwrap();
        let again = work.evaluate(&chain, head, joints, given).unwrap();
        again.iter().zip(&expected.head).for_each(|(a, b)| near(a, b, "head, prescribed"));
        by_dense.head.iter().zip(&expected.head).for_each(|(a, b)| near(a, b, "head, prescribed, dense"));
        work.answer.iter().zip(&torque).for_each(|(a, b)| near(a, b, "torque"));
        by_dense.joints.iter().zip(&torque).for_each(|(a, b)| near(a, b, "torque, dense"));
    }
}

/// A link of the plane, and the same in three dimensions with what the plane does not see.
fn both(rng: &mut Pcg64Mcg) -> (PlanarLink, Link) {
    let mut any = |low: f64, high: f64| rng.random_range(low..high);
    let half_length_m = any(0.06, 0.1);
    let (mass, yaw) = (any(1.0, 1.5), any(3e-3, 5e-3));
    let (ahead, surge, sway, cross) = (any(-0.02, 0.02), any(0.0, 0.2), any(0.5, 2.0), any(-0.02, 0.02));
    let turn = sway * half_length_m.powi(2) / 3.0 + cross * cross / sway;
    let drag = PlanarDrag {
        along: [any(0.0, 0.2), any(0.0, 2.0)],
        across: [any(0.0, 0.5), any(0.0, 20.0)],
        cross: Some(Cross { of_speed: [any(-0.1, 0.1), any(0.0, 1.0)], smooth_m_s: 1e-2 }),
        turning: Turning::Strip,
    };
    let plane = PlanarLink {
        half_length_m,
        rigid: planar::Inertia::rigid(mass, yaw, ahead),
        added: planar::Inertia { turn, turn_y: cross, x: surge, y: sway, ..planar::Inertia::default() },
        drag,
    };
    let mut added = [[0.0; 6]; 6];
    for (k, a) in [surge, sway, any(0.5, 1.0), any(1e-4, 1e-3), any(1e-3, 4e-3), turn].into_iter().enumerate() {
        added[k][k] = a;
    }
    (added[1][5], added[5][1], added[2][4], added[4][2]) = (cross, cross, -0.01, -0.01);
    let weight_n = mass * GRAVITY_M_S2;
    let spatial = Link {
        half_length_m,
        rigid: Inertia::rigid(mass, [[1.5e-3, 0.0, 0.0], [0.0, 0.9 * yaw, 0.0], [0.0, 0.0, yaw]], [ahead, 0.0, 0.0]),
        added: Inertia::of_added_mass(&added),
        drag: LinkDrag {
            along: drag.along,
            sideways: drag.across,
            upright: [0.1, 9.0],
            cross: drag.cross,
            roll: [1e-3, 1e-3],
        },
        weight_n,
        centre_of_mass_m: [ahead, 0.0, 0.0],
        buoyancy_n: weight_n,
        centre_of_buoyancy_m: [ahead, 0.0, 0.0],
    };
    (plane, spatial)
}

fn chains(n: usize, rng: &mut Pcg64Mcg) -> (Planar, Chain) {
    let (plane, spatial) = (0..n).map(|_| both(rng)).unzip();
    (Planar { links: plane, added_mass: AddedMass::Full }, Chain { links: spatial, joints: vec![Axis::Yaw; n - 1] })
}

/// 1e-12 for the largest acceleration, at torques and at prescribed joints.
#[test]
fn in_the_plane_the_accelerations_are_those_of_the_plane() {
    let mut rng = Pcg64Mcg::seed_from_u64(24);
    for n in 1..=20 {
        let (plane, spatial) = chains(n, &mut rng);
        let mut any = |size: f64| rng.random_range(-size..size);
        let (r, u, v) = (any(2.0), any(0.5), any(0.5));
        let angle: Vec<f64> = (1..n).map(|_| any(1.0)).collect();
        let rate: Vec<f64> = (1..n).map(|_| any(2.0)).collect();
        let given: Vec<f64> = (1..n).map(|_| any(0.5)).collect();
        let joints = Joints { angle: &angle, rate: &rate };
        let head = Head { motion: [0.0, 0.0, r, u, v, 0.0], down: [0.0, 0.0, 1.0] };
        for given in [Given::Torque(&given), Given::Acceleration(&given)] {
            let (mut a, mut b) = (PlanarWorkspace::new(&plane), Workspace::new(&spatial));
            let [turn, x, y] = a.evaluate([r, u, v], joints, given).unwrap();
            let found = b.evaluate(&spatial, head, joints, given).unwrap();
            let largest = a.answer.iter().chain(&[turn, x, y]).fold(1.0_f64, |m, x| m.max(x.abs()));
            for (a, b) in [0.0, 0.0, turn, x, y, 0.0].iter().zip(found).chain(a.answer.iter().zip(b.answer.clone())) {
                assert!((a - b).abs() <= 1e-12 * largest, "{n} links: {a} {b}, largest {largest}");
            }
        }
    }
}

/// Which entries of the added mass leave the plane: those that couple surge, sway or yaw with heave, roll or pitch, nine of them. A26 couples sway with yaw and A35 heave with pitch, each within its own half.
#[test]
fn an_entry_that_couples_both_halves_leaves_the_plane_and_no_other_does() {
    let plane = [0, 1, 5];
    for i in 0..6 {
        for j in i + 1..6 {
            let (_, mut chain) = chains(3, &mut Pcg64Mcg::seed_from_u64(7));
            for link in &mut chain.links {
                let mut added = [[0.0; 6]; 6];
                let own: [f64; 6] = [0.1, 1.5, 0.7, 5e-4, 3e-3, 5e-3];
                for k in 0..6 {
                    added[k][k] = own[k];
                }
                let coupling = 0.3 * (own[i] * own[j]).sqrt();
                (added[i][j], added[j][i]) = (coupling, coupling);
                link.added = Inertia::of_added_mass(&added);
            }
            let head = Head { motion: [0.0, 0.0, 0.5, 0.3, -0.2, 0.0], down: [0.0, 0.0, 1.0] };
            let joints = Joints { angle: &[0.4, -0.3], rate: &[0.5, 0.8] };
            let mut work = Workspace::new(&chain);
            let found = work.evaluate(&chain, head, joints, Given::Acceleration(&[0.2, -0.6])).unwrap();
            let largest = found.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let leaves = [0, 1, 5].iter().any(|k| found[*k].abs() > 1e-6 * largest);
            let couples = plane.contains(&i) != plane.contains(&j);
            assert_eq!(leaves, couples, "A{}{}: {found:?}", i + 1, j + 1);
        }
    }
}

fn gait() -> Gait {
    Gait::wave(30_f64.to_radians(), 80_f64.to_radians(), 40_f64.to_radians(), Envelope::Lateral)
}

/// Ten links swim for ten seconds: the head is within 1e-9 m of where the plane has it, and never leaves the plane.
#[test]
fn in_the_plane_a_path_of_ten_seconds_is_that_of_the_plane() {
    let (plane, spatial) = chains(10, &mut Pcg64Mcg::seed_from_u64(13));
    let gait = gait();
    let times: Vec<f64> = (0..=10).map(f64::from).collect();
    let start = StateOf::<Planar> { head: [0.1, 0.2, 0.0], ..Planar::REST };
    let expected = adaptive::followed(&mut Swimmer::new(&plane, &gait), &times, &start, 1e-13);
    let start = StateOf::<Chain> { head: [0.0, 0.0, 0.1, 0.2, 0.0, 0.0], ..Chain::REST };
    let found = adaptive::followed(&mut Swimmer::new(&spatial, &gait), &times, &start, 1e-13);
    for (a, b) in expected.iter().zip(&found) {
        let away = (a.pose[0] - b.pose[0]).hypot(a.pose[1] - b.pose[1]);
        assert!(away < 1e-9, "{away} m");
        assert!(b.pose[2].abs() < 1e-12, "{b:?}");
        assert!(
            (a.energy(Energy::Work) - b.energy(Energy::Work)).abs() < 1e-9 * a.energy(Energy::Absolute).max(1.0),
            "{a:?} {b:?}"
        );
    }
    assert!(found[10].pose[0].hypot(found[10].pose[1]) > 0.3, "it swims: {:?}", found[10]);
}

/// What does not reduce: buoyancy 10 mm above the mass, and the mass below the axis of the joints, and the same gait rolls, in a turn the more.
#[test]
fn a_mass_below_the_joints_rolls() {
    let (_, mut spatial) = chains(10, &mut Pcg64Mcg::seed_from_u64(13));
    for link in &mut spatial.links {
        let mass = link.rigid.0[3][3];
        let ahead = link.centre_of_mass_m[0];
        link.centre_of_mass_m = [ahead, 0.0, 0.01];
        link.rigid =
            Inertia::rigid(mass, [[1.5e-3, 0.0, 0.0], [0.0, 3.6e-3, 0.0], [0.0, 0.0, 4e-3]], [ahead, 0.0, 0.01]);
    }
    let rolled = |turn: f64| {
        let gait = Gait { turn, ..gait() };
        let start = StateOf::<Chain> { head: [0.0, 0.0, 0.0, 0.2, 0.0, 0.0], ..Chain::REST };
        let times: Vec<f64> = (0..=100).map(|k| 0.1 * f64::from(k)).collect();
        let found = adaptive::followed(&mut Swimmer::new(&spatial, &gait), &times, &start, 1e-10);
        found.iter().map(|s| Chain::angles(&s.pose)[0].sin().abs()).fold(0.0, f64::max)
    };
    let (straight, turning) = (rolled(0.0), rolled(0.2));
    // A degree at least, and far from over.
    assert!(straight > 0.017 && straight < 1.0 && turning > 0.017, "{straight} {turning}");
}
