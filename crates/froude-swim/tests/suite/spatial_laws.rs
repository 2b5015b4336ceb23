//! Laws that any chain in three dimensions obeys, whatever its numbers.

use crate::adaptive;
use crate::adaptive::path;
use froude_hydro::similarity::GRAVITY_M_S2;
use froude_swim::drive::Limp;
use froude_swim::driven::Driven;
use froude_swim::dynamics::{Dynamics, StateOf};
use froude_swim::gait::{Envelope, Gait};
use froude_swim::path::Swimmer;
use froude_swim::spatial::attitude::{LEVEL, angles, of_angles, to_world, unit, world_from_body};
use froude_swim::spatial::chain::{Chain, Link, Pose};
use froude_swim::spatial::drag::LinkDrag;
use froude_swim::spatial::vector::{Axis, Inertia, cross, parts};
use froude_swim::state::Energy;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const MASS_KG: f64 = 1.343;
const ADDED: [f64; 6] = [0.1, 1.653, 0.742, 2e-4, 2.0e-3, 4.463e-3];
const ROLL_KG_M2: f64 = 1.5e-3;
const TURN_KG_M2: f64 = 4.1e-3;
const HALF_LENGTH_M: f64 = 0.09;

/// A neutral link with its mass a little below its centre and its buoyancy above it.
fn link(drag: LinkDrag, below_m: f64, above_m: f64) -> Link {
    let mut added = [[0.0; 6]; 6];
    for k in 0..6 {
        added[k][k] = ADDED[k];
    }
    let tensor = [[ROLL_KG_M2, 0.0, 0.0], [0.0, TURN_KG_M2, 0.0], [0.0, 0.0, TURN_KG_M2 + 3e-4]];
    let centre = [0.0, 0.0, below_m];
    Link {
        half_length_m: HALF_LENGTH_M,
        rigid: Inertia::rigid(MASS_KG, tensor, centre),
        added: Inertia::of_added_mass(&added),
        drag,
        weight_n: MASS_KG * GRAVITY_M_S2,
        centre_of_mass_m: centre,
        buoyancy_n: MASS_KG * GRAVITY_M_S2,
        centre_of_buoyancy_m: [0.0, 0.0, -above_m],
    }
}

fn weightless(mut link: Link) -> Link {
    (link.weight_n, link.buoyancy_n) = (0.0, 0.0);
    link
}

fn one(link: &Link) -> Chain {
    Chain { links: vec![*link], joints: Vec::new() }
}

/// Joints that yaw and pitch in turn.
fn chain(link: &Link, n: usize) -> Chain {
    let joints = (1..n).map(|i| if i % 2 == 0 { Axis::Pitch } else { Axis::Yaw }).collect();
    Chain { links: vec![*link; n], joints }
}

const DRAG: LinkDrag =
    LinkDrag { along: [0.1, 0.4], sideways: [0.2, 15.0], upright: [0.1, 9.0], cross: None, roll: [1e-3, 2e-3] };
/// Without the corners of |v|.
const SMOOTH: LinkDrag =
    LinkDrag { along: [0.1, 0.0], sideways: [2.0, 0.0], upright: [1.5, 0.0], cross: None, roll: [1e-3, 0.0] };

/// A random start, on the unit sphere.
fn thrown(swimmer: &Driven<'_, Limp, Chain>, size: f64) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let mut start: Vec<f64> = (0..swimmer.size()).map(|_| rng.random_range(-size..size)).collect();
    let attitude = unit(std::array::from_fn(|k| start[3 + k]));
    start[3..7].copy_from_slice(&attitude);
    start
}

fn lies(state: &[f64]) -> Pose {
    let attitude = std::array::from_fn(|k| state[3 + k]);
    Pose { place_m: std::array::from_fn(|k| state[k]), world_from_link: world_from_body(attitude) }
}

/// Kinetic and potential energy, J, of the state that was evaluated last.
fn energy_j(swimmer: &Driven<'_, Limp, Chain>, state: &[f64]) -> [f64; 2] {
    let pose = std::array::from_fn(|k| state[k]);
    Dynamics::energy_j(swimmer.chain, &pose, &state[7..], swimmer.work.motions())
}

/// Momentum of body and water, kg m/s, and its moment about the tank's origin, kg m²/s, of the state that was evaluated last.
fn momentum(swimmer: &Driven<'_, Limp, Chain>, state: &[f64]) -> [[f64; 3]; 2] {
    let mut sum = [[0.0; 3]; 2];
    let poses = swimmer.chain.poses(lies(state), &state[7..]);
    for ((link, motion), pose) in swimmer.chain.links.iter().zip(swimmer.work.motions()).zip(poses) {
        let [turning, moving] = parts(link.inertia().times(*motion)).map(|x| to_world(&pose.world_from_link, x));
        let about = cross(pose.place_m, moving);
        for k in 0..3 {
            sum[0][k] += moving[k];
            sum[1][k] += turning[k] + about[k];
        }
    }
    sum
}

/// Limp, without drag, at the beginning and after 1.5 s: (kinetic and potential energy, both momenta).
fn limp(link: &Link) -> [([f64; 2], [[f64; 3]; 2]); 2] {
    let chain = chain(link, 6);
    let mut swimmer = Driven::new(&chain, Limp);
    let start = thrown(&swimmer, 1.0);
    let end = path(&[0.0, 1.5], &start, 1e-13, |t, x, out| swimmer.rates(t, x, out)).remove(1);
    let mut scratch = vec![0.0; start.len()];
    [start, end].map(|state| {
        swimmer.rates(0.0, &state, &mut scratch).unwrap();
        (energy_j(&swimmer, &state), momentum(&swimmer, &state))
    })
}

/// Steps are exact to 1e-13, and there are some hundred.
#[test]
fn without_loads_energy_and_both_momenta_stay() {
    let [([energy, _], before), ([later, _], after)] = limp(&weightless(link(LinkDrag::NONE, 0.01, 0.0)));
    assert!((later / energy - 1.0).abs() < 1e-10, "{energy} {later}");
    for (a, b) in before.iter().zip(after) {
        let size = a.iter().map(|x| x * x).sum::<f64>().sqrt();
        for k in 0..3 {
            assert!((a[k] - b[k]).abs() < 1e-10 * size, "{before:?} {after:?}");
        }
    }
}

/// Weight and buoyancy at different points: what the motion gains, the heights lose. They differ by 5 %, and so it sinks too.
#[test]
fn with_weight_and_buoyancy_the_sum_of_both_energies_stays() {
    let heavy = Link { weight_n: 1.05 * MASS_KG * GRAVITY_M_S2, ..link(LinkDrag::NONE, 0.01, 0.02) };
    let [([kinetic, potential], _), ([later, lower], _)] = limp(&heavy);
    assert!((later - kinetic).abs() > 0.1, "{kinetic} {later}");
    assert!((later + lower - kinetic - potential).abs() < 1e-10 * kinetic, "{kinetic} {potential} {later} {lower}");
}

/// Roll: ω² = W (c + b)/(I + A44 − (m c)²/(m + A22)), I about the link's centre, mass c below and buoyancy b above it: the centre gives way sideways. Pitch: the same with heave, where m c couples
/// with surge. At 1e-4 rad the pendulum's own change of the period is 6e-10, and what turned axes add of second order.
#[test]
fn a_neutral_link_rolls_and_pitches_with_the_period_of_its_righting_moment() {
    let (below, above) = (0.012, 0.02);
    let coupled = MASS_KG * below;
    let cases = [
        (0, ROLL_KG_M2 + MASS_KG * below * below + ADDED[3] - coupled * coupled / (MASS_KG + ADDED[1])),
        (1, TURN_KG_M2 + MASS_KG * below * below + ADDED[4] - coupled * coupled / (MASS_KG + ADDED[0])),
    ];
    for (which, inertia) in cases {
        let chain = one(&link(LinkDrag::NONE, below, above));
        let mut swimmer = Driven::new(&chain, Limp);
        let mut start = vec![0.0; swimmer.size()];
        let mut away = [0.0; 3];
        away[which] = 1e-4;
        start[3..7].copy_from_slice(&of_angles(away));
        let omega = (MASS_KG * GRAVITY_M_S2 * (below + above) / inertia).sqrt();
        let times = [0.0, 0.5, 1.0, 1.25].map(|periods| periods * std::f64::consts::TAU / omega);
        let found = path(&times, &start, 1e-13, |t, x, out| swimmer.rates(t, x, out));
        for (state, expected) in found.iter().zip([1e-4, -1e-4, 1e-4, 0.0]) {
            let angle = angles(std::array::from_fn(|k| state[3 + k]))[which];
            assert!((angle - expected).abs() < 1e-10, "{which}: {angle} {expected}");
        }
    }
}

/// A link that is 5 % too heavy sinks level: (m + A33) ẇ = ΔW − e w|w|, w = w∞ tanh(t/T) with w∞² = ΔW/e and T = (m + A33)/(e w∞).
#[test]
fn a_heavy_link_sinks_as_its_law_says() {
    let drag = LinkDrag { upright: [0.0, 9.0], ..LinkDrag::NONE };
    let excess = 0.05 * MASS_KG * GRAVITY_M_S2;
    let level = link(drag, 0.0, 0.0);
    let chain = one(&Link { weight_n: level.weight_n + excess, ..level });
    let mut swimmer = Driven::new(&chain, Limp);
    let start = {
        let mut start = vec![0.0; swimmer.size()];
        start[3..7].copy_from_slice(&LEVEL);
        start
    };
    let terminal = (excess / 9.0).sqrt();
    let settles = (MASS_KG + ADDED[2]) / (9.0 * terminal);
    let times = [0.0, 0.5 * settles, 2.0 * settles, 20.0 * settles];
    let found = path(&times, &start, 1e-13, |t, x, out| swimmer.rates(t, x, out));
    let w = 7 + 5;
    for (time, state) in times.iter().zip(&found) {
        let expected = terminal * (time / settles).tanh();
        assert!((state[w] - expected).abs() < 1e-11, "{time} s: {} {expected}", state[w]);
    }
    // What it has lost of its height is motion and drag.
    let end = &found[3];
    let [kinetic, potential] = {
        swimmer.rates(0.0, end, &mut vec![0.0; end.len()]).unwrap();
        energy_j(&swimmer, end)
    };
    assert!((kinetic + potential + end[swimmer.at(Energy::Loss)]).abs() < 1e-10, "{kinetic} {potential}");
}

/// A current carries: relative to the water everything is as without it.
#[test]
fn a_swimmer_does_not_know_a_uniform_current() {
    let chain = chain(&link(SMOOTH, 0.01, 0.02), 5);
    let mut still = Driven::new(&chain, Limp);
    let start = thrown(&still, 0.5);
    let mut stream = still.clone();
    stream.current_m_s = [0.3, -0.2, 0.1];
    let a = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| still.rates(t, x, out)).remove(1);
    let b = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| stream.rates(t, x, out)).remove(1);
    for k in 0..a.len() {
        let carried = [0.3, -0.2, 0.1].get(k).copied().unwrap_or(0.0);
        // Steps of their own, some hundred, each exact to 1e-13.
        assert!((a[k] + carried - b[k]).abs() < 1e-11, "{k}: {} {}", a[k], b[k]);
    }
}

fn gait() -> Gait {
    Gait { turn: 0.1, ..Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral) }
}

fn away(a: &StateOf<Chain>, b: &StateOf<Chain>) -> f64 {
    let [a, b] = [a, b].map(|s| [&s.pose[..], &s.head].concat());
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Half a step has a sixteenth of the error in place, attitude and motion: 4 ± 0.1, since drag without corners leaves only the next order, of a tenth of it. Each step ends on the unit sphere.
#[test]
fn steps_are_of_fourth_order_and_stay_on_the_sphere() {
    let chain = chain(&link(SMOOTH, 0.01, 0.02), 5);
    let gait = gait();
    let mut swimmer = Swimmer::new(&chain, &gait);
    let start = StateOf::<Chain> { pose: Chain::pose([0.0; 3], [0.3, -0.2, 1.0]), ..Chain::REST };
    let exact = adaptive::followed(&mut swimmer, &[0.0, 2.0], &start, 1e-13)[1];
    let mut error = |steps: u32| {
        let h = 2.0 / f64::from(steps);
        let end = (0..steps).fold(start, |s, i| swimmer.step(h * f64::from(i), h, &s).unwrap());
        assert!((end.pose[3..].iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-15);
        away(&end, &exact)
    };
    let order = (error(200) / error(400)).log2();
    assert!((order - 4.0).abs() < 0.1, "{order}");
    // Driven, the same steps.
    let mut limp = Driven::new(&chain, Limp);
    let start = thrown(&limp, 0.5);
    let exact = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| limp.rates(t, x, out)).remove(1);
    let mut error = |steps: u32| {
        let (h, mut state) = (1.0 / f64::from(steps), start.clone());
        for i in 0..steps {
            limp.step(h * f64::from(i), h, &mut state).unwrap();
        }
        (0..13 + chain.joints.len()).map(|k| (state[k] - exact[k]).powi(2)).sum::<f64>().sqrt()
    };
    let order = (error(400) / error(800)).log2();
    assert!((order - 4.0).abs() < 0.1, "{order}");
}

/// What the joints put in, drag takes, or it moves and lifts: to 1e-10 of the work, over ten seconds of a gait that yaws and pitches.
#[test]
fn a_gait_closes_its_energy() {
    let chain = chain(&link(DRAG, 0.01, 0.02), 8);
    let gait = gait();
    let mut swimmer = Swimmer::new(&chain, &gait);
    let start = Chain::REST;
    let mut energy = |time_s: f64, state: &StateOf<Chain>| {
        swimmer.rates(time_s, state).unwrap();
        swimmer.energy_j(state).iter().sum::<f64>()
    };
    let at_start = energy(0.0, &start);
    let end = adaptive::followed(&mut Swimmer::new(&chain, &gait), &[0.0, 10.0], &start, 1e-13)[1];
    let [work, loss, absolute] = [Energy::Work, Energy::Loss, Energy::Absolute].map(|of| end.energy(of));
    let residual = work - loss - (energy(10.0, &end) - at_start);
    assert!(absolute > 1.0, "{end:?}");
    assert!(residual.abs() < 1e-10 * absolute, "{residual} J of {absolute}");
}
