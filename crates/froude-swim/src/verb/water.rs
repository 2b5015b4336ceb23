//! What the water does to each link at a moment of a trajectory, and how fast the swimmer is.
//!
//! **Frame.** The tank's, z down: seen from above, y is to the right of x. **Units.** SI.

use crate::chain::Chain;
use crate::trajectory::Moment;

/// A link at a moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkInWater {
    /// Its centre.
    pub(super) place_m: [f64; 2],
    /// rad.
    pub(super) heading: f64,
    /// Drag on it, over the tank's x and y.
    pub(super) drag_n: [f64; 2],
}

/// Links from the head.
pub(super) fn links<'a>(chain: &'a Chain, moment: &'a Moment) -> impl Iterator<Item = LinkInWater> + 'a {
    let places = chain.places(moment.state.place_m, moment.state.heading, &moment.shape.angle);
    chain.links.iter().zip(&moment.motions).zip(places).map(|((link, &motion), (place_m, heading))| {
        let [_, x, y] = link.drag.load(link.half_length_m, motion);
        let (s, c) = heading.sin_cos();
        LinkInWater { place_m, heading, drag_n: [x * c - y * s, x * s + y * c] }
    })
}

/// Speed of the centre of mass through the water, m/s.
pub(super) fn speed_m_s(chain: &Chain, moment: &Moment) -> f64 {
    let places = chain.places(moment.state.place_m, moment.state.heading, &moment.shape.angle);
    let (mut momentum, mut mass) = ([0.0; 2], 0.0);
    for ((link, &[w, u, v]), (_, heading)) in chain.links.iter().zip(&moment.motions).zip(places) {
        let (s, c) = heading.sin_cos();
        let (x, y) = (link.rigid.x * u, link.rigid.x * v + link.rigid.turn_y * w);
        momentum = [momentum[0] + x * c - y * s, momentum[1] + x * s + y * c];
        mass += link.rigid.x;
    }
    momentum[0].hypot(momentum[1]) / mass
}
