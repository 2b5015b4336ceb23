//! Laws that any chain obeys, whatever its numbers.

#![allow(clippy::unwrap_used)]

use froude_swim::chain::{AddedMass, Chain, Link};
use froude_swim::drag::{LinkDrag, Turning};
use froude_swim::driven::{Driven, Limp, runge_kutta};
use froude_swim::planar::Inertia;
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
fn thrown(added_mass: AddedMass, steps: usize) -> [(f64, [f64; 3]); 2] {
    let chain = Chain { links: vec![link(LinkDrag::NONE); 6], added_mass };
    let mut swimmer = Driven::new(&chain, Limp);
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let mut state: Vec<f64> = (0..swimmer.size()).map(|_| rng.random_range(-1.0..1.0)).collect();
    let mut scratch = vec![0.0; state.len()];
    swimmer.rates(0.0, &state, &mut scratch).unwrap();
    let before = swimmer.energy_and_momentum(&state);
    let h = 1.5 / steps as f64;
    for _ in 0..steps {
        state = runge_kutta(0.0, h, &state, |t, x, out| swimmer.rates(t, x, out)).unwrap();
    }
    swimmer.rates(0.0, &state, &mut scratch).unwrap();
    [before, swimmer.energy_and_momentum(&state)]
}

fn drift(a: [f64; 3], b: [f64; 3], k: usize) -> f64 {
    let size = a[..2].iter().map(|x| x * x).sum::<f64>().sqrt();
    (b[k] - a[k]).abs() / if k < 2 { size } else { a[2].abs() }
}

/// Kirchhoff's equations keep energy and both momenta; steps of 0.15 ms leave rounding.
#[test]
fn full_added_mass_conserves_energy_and_momentum() {
    let [(energy, momentum), (later, after)] = thrown(AddedMass::Full, 10_000);
    assert!((later / energy - 1.0).abs() < 1e-10, "{energy} {later}");
    for k in 0..3 {
        assert!(drift(momentum, after, k) < 1e-10, "{momentum:?} {after:?}");
    }
}

/// The form that the paper prints keeps the energy only: a finding about its model.
#[test]
fn added_mass_as_printed_conserves_energy_but_no_impulse() {
    let [(energy, momentum), (later, after)] = thrown(AddedMass::Usr, 10_000);
    assert!((later / energy - 1.0).abs() < 1e-10, "{energy} {later}");
    assert!((0..2).any(|k| drift(momentum, after, k) > 0.1), "{momentum:?} {after:?}");
}

/// Half a step has a sixteenth of the error.
#[test]
fn runge_and_kutta_are_of_fourth_order() {
    let energy = |steps| thrown(AddedMass::Full, steps).map(|(energy, _)| energy);
    let error = |steps| energy(steps)[1] - energy(steps)[0];
    let order = (error(200) / error(400)).abs().log2();
    // A Hamiltonian system loses energy one order slower than the path.
    assert!((3.7..5.5).contains(&order), "{order}");
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
    stream.current_m_s = [0.3, -0.2];
    let (mut a, mut b) = (start.clone(), start);
    for i in 0..1_000 {
        let t = 1e-3 * f64::from(i);
        a = runge_kutta(t, 1e-3, &a, |t, x, out| still.rates(t, x, out)).unwrap();
        b = runge_kutta(t, 1e-3, &b, |t, x, out| stream.rates(t, x, out)).unwrap();
    }
    for k in 0..a.len() {
        let carried = [0.3, -0.2].get(k).copied().unwrap_or(0.0);
        // A thousand steps of rounding.
        assert!((a[k] + carried - b[k]).abs() < 1e-12, "{k}: {} {}", a[k], b[k]);
    }
}

/// One link along its axis: M u̇ = −c u², u = u₀/(1 + c u₀ t/M); what it loses is what drag takes.
#[test]
fn a_link_that_glides_slows_down_as_its_law_says() {
    let drag = LinkDrag { along: [0.0, 0.4], across: [0.0; 2], cross: None, turning: Turning::Strip };
    let chain = Chain { links: vec![link(drag)], added_mass: AddedMass::Full };
    let mut glider = Driven::new(&chain, Limp);
    let mut state = vec![0.0; glider.size()];
    state[4] = 0.8;
    for i in 0..2_000 {
        state = runge_kutta(0.01 * f64::from(i), 0.01, &state, |t, x, out| glider.rates(t, x, out)).unwrap();
    }
    let expected = 0.8 / (1.0 + 0.4 * 0.8 * 20.0 / 1.443);
    assert!((state[4] - expected).abs() < 1e-9, "{} {expected}", state[4]);
    let lost = 0.5 * 1.443 * (0.8 * 0.8 - expected * expected);
    assert!((state[7] - lost).abs() < 1e-9, "{} {lost}", state[7]);
}
