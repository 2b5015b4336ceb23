//! Laws that any chain obeys, whatever its numbers.

use crate::adaptive;
use crate::adaptive::path;
use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::drag::{LinkDrag, Turning};
use froude_swim::drive::Limp;
use froude_swim::driven::Driven;
use froude_swim::dynamics::Dynamics;
use froude_swim::gait::{Envelope, Gait};
use froude_swim::path::Swimmer;
use froude_swim::planar::Inertia;
use froude_swim::state::Energy;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn link(drag: LinkDrag) -> Link {
    let (mass, sway, l) = (1.343, 1.653, 0.09);
    Link {
        half_length_m: l,
        rigid: Inertia::rigid(mass, mass * l * l / 3.0, 0.0),
        added: Inertia { turn: sway * l * l / 3.0, y: sway, x: 0.1, ..Inertia::default() },
        drag,
    }
}

/// Energy and momentum of a limp chain without drag, thrown at random, at the beginning and after 1.5 s.
fn thrown(added_mass: AddedMass) -> [(f64, [f64; 3]); 2] {
    let chain = Chain { links: vec![link(LinkDrag::NONE); 6], added_mass };
    let mut swimmer = Driven::new(&chain, Limp);
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let start: Vec<f64> = (0..swimmer.size()).map(|_| rng.random_range(-1.0..1.0)).collect();
    let end = path(&[0.0, 1.5], &start, 1e-13, |t, x, out| swimmer.rates(t, x, out)).remove(1);
    let mut scratch = vec![0.0; start.len()];
    [start, end].map(|state| {
        swimmer.rates(0.0, &state, &mut scratch).unwrap();
        energy_and_momentum(&swimmer, &state)
    })
}

/// Kinetic energy of body and water, J, and their momentum, kg m/s, with its moment about the origin of the tank, kg m²/s, of the state that was evaluated last.
fn energy_and_momentum(swimmer: &Driven<'_, Limp>, state: &[f64]) -> (f64, [f64; 3]) {
    let (chain, motions) = (swimmer.chain, swimmer.work.motions());
    let places = chain.places([state[0], state[1]], state[2], &state[3..]);
    let mut sum = [0.0; 3];
    for ((link, motion), (place, heading)) in chain.links.iter().zip(motions).zip(places) {
        let [turn, along, across] = link.inertia().times(*motion);
        let (s, c) = heading.sin_cos();
        let (x, y) = (c * along - s * across, s * along + c * across);
        sum = [sum[0] + x, sum[1] + y, sum[2] + turn + place[0] * y - place[1] * x];
    }
    (chain.energy_j(motions), sum)
}

fn drift(a: [f64; 3], b: [f64; 3], k: usize) -> f64 {
    let size = a[..2].iter().map(|x| x * x).sum::<f64>().sqrt();
    (b[k] - a[k]).abs() / if k < 2 { size } else { a[2].abs() }
}

/// Kirchhoff's equations keep energy and both momenta; steps are exact to 1e-13, and there are some hundred.
#[test]
fn full_added_mass_conserves_energy_and_momentum() {
    let [(energy, momentum), (later, after)] = thrown(AddedMass::Full);
    assert!((later / energy - 1.0).abs() < 1e-10, "{energy} {later}");
    for k in 0..3 {
        assert!(drift(momentum, after, k) < 1e-10, "{momentum:?} {after:?}");
    }
}

/// The form that the paper prints keeps the energy only: a finding about its model.
#[test]
fn added_mass_as_printed_conserves_energy_but_no_impulse() {
    let [(energy, momentum), (later, after)] = thrown(AddedMass::Usr);
    assert!((later / energy - 1.0).abs() < 1e-10, "{energy} {later}");
    assert!((0..2).any(|k| drift(momentum, after, k) > 0.1), "{momentum:?} {after:?}");
}

/// Half a step has a sixteenth of the error: 4 ± 0.1, since drag without corners leaves only the next order, of a tenth of it.
#[test]
fn the_steps_of_a_gait_are_of_fourth_order() {
    let drag = LinkDrag { along: [0.1, 0.0], across: [2.0, 0.0], cross: None, turning: Turning::Strip };
    let chain = Chain { links: vec![link(drag); 5], added_mass: AddedMass::Full };
    let gait =
        Gait { amplitude: 0.5, frequency: 1.4, phase: 0.7, turn: 0.0, envelope: Envelope::Lateral, pitching: None };
    let mut swimmer = Swimmer::new(&chain, &gait);
    let exact = adaptive::followed(&mut swimmer, &[0.0, 2.0], &Chain::REST, 1e-13)[1];
    let mut error = |steps: u32| {
        let h = 2.0 / f64::from(steps);
        let end = (0..steps).fold(Chain::REST, |s, i| swimmer.step(h * f64::from(i), h, &s).unwrap());
        (end.pose[0] - exact.pose[0]).hypot(end.pose[1] - exact.pose[1])
    };
    let order = (error(100) / error(200)).log2();
    assert!((order - 4.0).abs() < 0.1, "{order}");
}

/// A current carries: relative to the water everything is as without it.
#[test]
fn a_swimmer_does_not_know_a_uniform_current() {
    let drag = LinkDrag { along: [0.1, 0.4], across: [0.2, 15.0], cross: None, turning: Turning::Strip };
    let chain = Chain { links: vec![link(drag); 5], added_mass: AddedMass::Full };
    let mut rng = Pcg64Mcg::seed_from_u64(9);
    let mut still = Driven::new(&chain, Limp);
    let start: Vec<f64> = (0..still.size()).map(|_| rng.random_range(-0.5..0.5)).collect();
    let mut stream = still.clone();
    stream.current_m_s = [0.3, -0.2, 0.0];
    let a = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| still.rates(t, x, out)).remove(1);
    let b = path(&[0.0, 1.0], &start, 1e-13, |t, x, out| stream.rates(t, x, out)).remove(1);
    for k in 0..a.len() {
        let carried = [0.3, -0.2].get(k).copied().unwrap_or(0.0);
        // Steps of their own, each exact to 1e-13; corners of the drag cost ten times as much.
        assert!((a[k] + carried - b[k]).abs() < 1e-11, "{k}: {} {}", a[k], b[k]);
    }
}

/// One link along its axis: M u̇ = −c u², u = u₀/(1 + c u₀ t/M); what it loses is what drag takes.
#[test]
fn a_link_that_glides_slows_down_as_its_law_says() {
    let drag = LinkDrag { along: [0.0, 0.4], across: [0.0; 2], cross: None, turning: Turning::Strip };
    let chain = Chain { links: vec![link(drag)], added_mass: AddedMass::Full };
    let mut glider = Driven::new(&chain, Limp);
    let mut start = vec![0.0; glider.size()];
    start[4] = 0.8;
    let state = path(&[0.0, 20.0], &start, 1e-13, |t, x, out| glider.rates(t, x, out)).remove(1);
    let expected = 0.8 / (1.0 + 0.4 * 0.8 * 20.0 / 1.443);
    assert!((state[4] - expected).abs() < 1e-11, "{} {expected}", state[4]);
    let lost = 0.5 * 1.443 * (0.8 * 0.8 - expected * expected);
    assert!((state[glider.at(Energy::Loss)] - lost).abs() < 1e-11, "{} {lost}", state[glider.at(Energy::Loss)]);
}
