//! What the water does to each link at a moment of a trajectory, and how fast the swimmer is.
//!
//! **Frame.** The tank's, z down: seen from above, y is to the right of x. **Units.** SI.

use crate::chain::Chain;
use crate::dynamics::Dynamics;
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

/// Links from the head, of a chain that the plane sees as `flat`.
pub(super) fn links<C: Dynamics>((chain, flat): (&C, &Chain), moment: &Moment<C>) -> impl Iterator<Item = LinkInWater> {
    let each = moment.motions.iter().enumerate().zip(places(flat, moment));
    each.map(|((i, motion), (place_m, heading))| {
        let [x, y, _] = chain.dragged(i, *motion).force_n;
        let (s, c) = heading.sin_cos();
        LinkInWater { place_m, heading, drag_n: [x * c - y * s, x * s + y * c] }
    })
}

fn places<C: Dynamics>(flat: &Chain, moment: &Moment<C>) -> impl Iterator<Item = ([f64; 2], f64)> {
    let ([x, y, _], [.., heading]) = (C::place_m(&moment.state.pose), C::angles(&moment.state.pose));
    flat.places([x, y], heading, &moment.shape.angle)
}

/// Speed of the centre of mass through the water, m/s.
pub(super) fn speed_m_s<C: Dynamics>(flat: &Chain, moment: &Moment<C>) -> f64 {
    let (mut momentum, mut mass) = ([0.0; 2], 0.0);
    for ((link, motion), (_, heading)) in flat.links.iter().zip(&moment.motions).zip(places(flat, moment)) {
        let [_, _, w, u, v, _] = C::six(motion);
        let (s, c) = heading.sin_cos();
        let (x, y) = (link.rigid.x * u, link.rigid.x * v + link.rigid.turn_y * w);
        momentum = [momentum[0] + x * c - y * s, momentum[1] + x * s + y * c];
        mass += link.rigid.x;
    }
    momentum[0].hypot(momentum[1]) / mass
}
