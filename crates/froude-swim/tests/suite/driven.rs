//! Servos at the joints: steps of fourth order, a period that closes its energy, and the exact gait as their limit.

use crate::adaptive::path;
use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::course::Recorded;
use froude_swim::drag::{LinkDrag, Turning};
use froude_swim::drive::{Following, Motor, Servo};
use froude_swim::driven::Driven;
use froude_swim::dynamics::Dynamics;
use froude_swim::gait::{Course, Envelope, Gait, Shape};
use froude_swim::moving::{Exact, go};
use froude_swim::path::Swimmer;
use froude_swim::period::Periodic;
use froude_swim::planar::Inertia;
use froude_swim::stability::stiffness;
use froude_swim::state::Energy;

fn chain(drag: LinkDrag) -> Chain {
    let (mass, sway, l) = (1.343, 1.653, 0.09);
    let link = Link {
        half_length_m: l,
        rigid: Inertia::rigid(mass, mass * l * l / 3.0, 0.0),
        added: Inertia { turn: sway * l * l / 3.0, y: sway, ..Inertia::default() },
        drag,
    };
    Chain { links: vec![link; 6], added_mass: AddedMass::Full }
}

const SQUARE: LinkDrag = LinkDrag { along: [0.0, 0.8], across: [0.65, 20.0], cross: None, turning: Turning::Strip };

fn servos(stiffness_n_m: f64) -> Vec<Following> {
    vec![Following { stiffness_n_m, damping_n_m_s: 0.05 * stiffness_n_m, ..Following::default() }; 5]
}

fn repeats(chain: &Chain, gait: &Gait, following: &[Following], motor: &Motor) -> Periodic {
    let longest = stiffness(chain, gait, following).unwrap().longest_step_s;
    let steps = (2.0 * gait.period_s() / longest).ceil().max(400.0) as usize;
    Driven::new(chain, Servo::new(gait, following, motor)).periodic_seen(&Chain::REST, steps, &mut |_| ()).unwrap()
}

/// Half a step has a sixteenth of the error: 4 ± 0.1 where drag and servos have no corners.
#[test]
fn steps_of_a_driven_chain_are_of_fourth_order() {
    let chain = chain(LinkDrag { along: [0.1, 0.0], across: [2.0, 0.0], cross: None, turning: Turning::Strip });
    let gait = Gait::wave(0.4, 1.4, 0.7, Envelope::Lateral);
    let (following, motor) = (servos(2.0), Motor::default());
    let mut driven = Driven::new(&chain, Servo::new(&gait, &following, &motor));
    let start = vec![0.0; driven.size()];
    let exact = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| driven.rates(t, x, out)).remove(1);
    // Without the positive and the absolute power, which have corners.
    let smooth = driven.at(Energy::Positive);
    let mut error = |steps: u32| {
        let h = 1.0 / f64::from(steps);
        let mut state = start.clone();
        (0..steps).for_each(|i| driven.step(h * f64::from(i), h, &mut state).unwrap());
        state[..smooth].iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let order = (error(200) / error(400)).log2();
    assert!((order - 4.0).abs() < 0.1, "{order}");
}

/// What servos give, drag and friction take; and the motion repeats.
#[test]
fn a_period_of_servos_with_friction_closes_its_energy() {
    let (chain, gait) = (chain(SQUARE), Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral));
    let mut following = servos(20.0);
    for servo in &mut following {
        (servo.viscous_n_m_s, servo.dry_n_m) = (0.05, 0.02);
    }
    let found = repeats(&chain, &gait, &following, &Motor::default());
    assert!(found.means.friction_w > 0.1 * found.means.net_w, "{found:?}");
    // Dry friction turns about within some steps.
    assert!(((found.means.loss_w + found.means.friction_w) / found.means.net_w - 1.0).abs() < 1e-5, "{found:?}");
    assert!(found.residual < 1e-6 && found.multipliers[0] < 1.0, "{found:?}");
}

/// Twice as stiff, half as far from the gait that joints follow exactly: the error of speed and power is of first order in 1/k_p.
#[test]
fn ever_stiffer_servos_come_to_the_exact_gait() {
    let (chain, gait) = (chain(SQUARE), Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral));
    let exact = Swimmer::new(&chain, &gait).periodic(400).unwrap();
    let away = |stiffness: f64| {
        let found = repeats(&chain, &gait, &servos(stiffness), &Motor::default());
        [found.means.speed_m_s / exact.means.speed_m_s - 1.0, found.means.net_w / exact.means.net_w - 1.0]
    };
    let (soft, stiff) = (away(200.0), away(400.0));
    for k in 0..2 {
        assert!(stiff[k].abs() < 0.01, "{stiff:?}");
        // A tenth for what is of second order.
        assert!((soft[k] / stiff[k] - 2.0).abs() < 0.2, "{soft:?} {stiff:?}");
    }
}

/// A motor that gives less than the gait needs makes it slower, and a torque never exceeds its curve.
#[test]
fn a_weak_motor_slows_the_swimmer() {
    let (chain, gait) = (chain(SQUARE), Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral));
    let strong = repeats(&chain, &gait, &servos(20.0), &Motor::default());
    let motor = Motor { curve: vec![[0.0, 0.15], [3.0, 0.0]], ..Motor::default() };
    let following = servos(20.0);
    let driven = Driven::new(&chain, Servo::new(&gait, &following, &motor));
    let mut beyond = 0.0_f64;
    let weak = driven
        .periodic_seen(&Chain::REST, 2000, &mut |now| {
            for (torque, rate) in now.torque_n_m.iter().zip(&now.shape.rate) {
                beyond = beyond.max(torque.abs() - motor.most_n_m(*torque, *rate));
            }
        })
        .unwrap();
    assert!(beyond < 1e-12, "{beyond}");
    assert!(
        weak.means.speed_m_s < 0.95 * strong.means.speed_m_s,
        "{} {}",
        weak.means.speed_m_s,
        strong.means.speed_m_s
    );
}

/// A recording of five periods of a gait, followed from the motion that repeats, has its means: the spline of 100 rows a period is off by 3e-7 of an angle.
#[test]
fn a_recording_of_a_gait_has_its_speed_and_power() {
    let (chain, gait) = (chain(SQUARE), Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral));
    let found = Swimmer::new(&chain, &gait).periodic(400).unwrap();
    let time: Vec<f64> = (0..=500).map(|i| gait.period_s() * f64::from(i) / 100.0).collect();
    let mut angles = vec![Vec::new(); 5];
    let mut shape = Shape::straight(5);
    for t in &time {
        gait.at(*t, &mut shape);
        angles.iter_mut().zip(&shape.angle).for_each(|(row, angle)| row.push(*angle));
    }
    let track = Recorded::track(&time, &angles).unwrap();
    let mut moving = Exact::new(Swimmer::new(&chain, &track), found.start);
    let passage = go(&mut moving, track.period_s() / 2000.0, 2000, &mut |_| ()).unwrap();
    let speed = passage.way_m[0].hypot(passage.way_m[1]) / track.period_s();
    // The gait turns by nothing in a period, and so the five ways add up. Ends of the spline: second derivatives off by some per cent in the first rows.
    assert!((speed / found.means.speed_m_s - 1.0).abs() < 1e-3, "{speed} {}", found.means.speed_m_s);
    let [work, loss] = [Energy::Work, Energy::Loss].map(|of| passage.energy_j[of as usize]);
    assert!((loss / track.period_s() / found.means.loss_w - 1.0).abs() < 1e-3, "{passage:?} {found:?}");
    let residual = work - loss - passage.gained_j[0];
    assert!(residual.abs() < 1e-6 * work, "{residual}");
}
