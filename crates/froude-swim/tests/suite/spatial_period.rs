//! The motion that repeats in three dimensions: that of the plane where nothing leaves it, upright where its buoyancy is above its mass, and a motion that steps alone reach.

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_swim::chain::{AddedMass, Chain as Planar, Link as PlanarLink};
use froude_swim::drag::{LinkDrag as PlanarDrag, Turning};
use froude_swim::dynamics::Dynamics;
use froude_swim::gait::{Envelope, Gait, Pitching};
use froude_swim::path::Swimmer;
use froude_swim::planar;
use froude_swim::spatial::chain::{Chain, Link};
use froude_swim::spatial::drag::LinkDrag;
use froude_swim::spatial::vector::{Axis, Inertia};

const MASS_KG: f64 = 1.343;
const ADDED: [f64; 6] = [0.1, 1.653, 0.742, 2e-4, 2.0e-3, 4.463e-3];
const TURN_KG_M2: f64 = 4.1e-3;

/// A link of the plane: c_N and c_T of f2 by the tank.
fn plane() -> PlanarLink {
    PlanarLink {
        half_length_m: 0.09,
        rigid: planar::Inertia::rigid(MASS_KG, TURN_KG_M2, 0.0),
        added: planar::Inertia { turn: ADDED[5], x: ADDED[0], y: ADDED[1], ..planar::Inertia::default() },
        drag: PlanarDrag { along: [0.0, 0.775], across: [0.654, 20.18], cross: None, turning: Turning::Strip },
    }
}

/// The same with six motions, its mass below and its buoyancy above its centre.
fn link(below_m: f64, above_m: f64) -> Link {
    let flat = plane().drag;
    let mut added = [[0.0; 6]; 6];
    for k in 0..6 {
        added[k][k] = ADDED[k];
    }
    let centre = [0.0, 0.0, below_m];
    let tensor = [[1.7e-3, 0.0, 0.0], [0.0, TURN_KG_M2 + 6e-4, 0.0], [0.0, 0.0, TURN_KG_M2]];
    Link {
        half_length_m: 0.09,
        rigid: Inertia::rigid(MASS_KG, tensor, centre),
        added: Inertia::of_added_mass(&added),
        drag: LinkDrag {
            along: flat.along,
            sideways: flat.across,
            upright: [0.438, 13.52],
            cross: None,
            roll: [0.01, 0.02],
        },
        weight_n: MASS_KG * GRAVITY_M_S2,
        centre_of_mass_m: centre,
        buoyancy_n: MASS_KG * GRAVITY_M_S2,
        centre_of_buoyancy_m: [0.0, 0.0, -above_m],
    }
}

fn lateral() -> Gait {
    Gait::wave(30_f64.to_radians(), 80_f64.to_radians(), 40_f64.to_radians(), Envelope::Lateral)
}

/// Without a righting moment and in the plane: the speed and power of the plane to what both repeat by, and two multipliers of one, of roll and pitch.
#[test]
fn in_the_plane_the_motion_that_repeats_is_that_of_the_plane() {
    let gait = lateral();
    let plane = Planar { links: vec![plane(); 10], added_mass: AddedMass::Full };
    let expected = Swimmer::new(&plane, &gait).periodic(200).unwrap();
    let chain = Chain { links: vec![link(0.0, 0.0); 10], joints: vec![Axis::Yaw; 9] };
    let found = Swimmer::new(&chain, &gait).periodic(200).unwrap();
    assert!((found.means.speed_m_s / expected.means.speed_m_s - 1.0).abs() < 1e-7, "{found:?} {expected:?}");
    assert!((found.means.net_w / expected.means.net_w - 1.0).abs() < 1e-7, "{found:?} {expected:?}");
    assert!((found.means.turn - expected.means.turn).abs() < 1e-7);
    assert!(found.tilt[0][1] - found.tilt[0][0] < 1e-12 && found.way_m[2].abs() < 1e-12, "{found:?}");
    assert_eq!(found.multipliers.iter().filter(|m| (*m - 1.0).abs() < 1e-6).count(), 2, "{:?}", found.multipliers);
}

/// A gait of both kinds of joints with a righting moment: thirty periods of steps from rest come to the motion that Newton's method finds. What is left of the start is the slowest multiplier to the
/// thirtieth power.
#[test]
fn steps_alone_come_to_the_motion_that_repeats() {
    let joints: Vec<Axis> = (0..9).map(|i| if i % 2 == 0 { Axis::Yaw } else { Axis::Pitch }).collect();
    let chain = Chain { links: vec![link(0.01, 0.01); 10], joints: joints.clone() };
    let pitching = Some(Pitching { amplitude: 0.2, ahead: 1.57, turn: 0.0, axes: joints });
    let gait = Gait { pitching, ..lateral() };
    let mut swimmer = Swimmer::new(&chain, &gait);
    let found = swimmer.periodic(200).unwrap();
    assert!(found.multipliers[0] < 0.8, "{:?}", found.multipliers);
    assert!(found.tilt[0][1] - found.tilt[0][0] > 0.01, "{found:?}");
    let h = std::f64::consts::TAU / lateral().frequency / 200.0;
    let mut state = Chain::REST;
    for i in 0..30 * 200 {
        state = swimmer.step(f64::from(i) * h, h, &state).unwrap();
    }
    let left = found.multipliers[0].powi(30).max(1e-8);
    for (a, b) in state.head.iter().zip(found.start.head) {
        assert!((a - b).abs() < 10.0 * left, "{:?} {:?}", state.head, found.start.head);
    }
    let (a, b) = (Chain::angles(&state.pose), Chain::angles(&found.start.pose));
    assert!((a[0] - b[0]).abs() < 10.0 * left && (a[1] - b[1]).abs() < 10.0 * left, "{a:?} {b:?}");
    // A motion that repeats stores nothing but height.
    assert!(((found.means.loss_w + found.means.lifting_w) / found.means.net_w - 1.0).abs() < 1e-6, "{found:?}");
}

/// One per cent too heavy: it sinks at a speed that repeats, and what that gives, drag takes.
#[test]
fn a_heavy_swimmer_sinks_at_a_speed_that_repeats() {
    let heavy = link(0.01, 0.01);
    let heavy = Link { buoyancy_n: 0.99 * heavy.buoyancy_n, ..heavy };
    let chain = Chain { links: vec![heavy; 6], joints: vec![Axis::Yaw; 5] };
    let gait = lateral();
    let found = Swimmer::new(&chain, &gait).periodic(200).unwrap();
    assert!(found.way_m[2] > 0.01, "{found:?}");
    let sinks = 0.01 * 6.0 * MASS_KG * GRAVITY_M_S2 * found.way_m[2] / gait.frequency.recip() / std::f64::consts::TAU;
    assert!((found.means.lifting_w / -sinks - 1.0).abs() < 1e-6, "{found:?}");
    assert!(((found.means.loss_w + found.means.lifting_w) / found.means.net_w - 1.0).abs() < 1e-6, "{found:?}");
}
