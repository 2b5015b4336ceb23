//! Drag of four links, or of one link in four motions, side by side: [`crate::drag`] in numbers alone, where strips with a reach of zero are the lumped form.

use crate::drag::{LinkDrag, POINTS, Turning, WEIGHTS};

/// Numbers worked on side by side.
pub(crate) const LANES: usize = 4;
/// One number of each.
pub(crate) type Four = [f64; LANES];
/// (ω, u, v), or (N, X, Y), of each.
pub(crate) type Three = [Four; 3];

/// Drag of each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DragLanes {
    along: [Four; 2],
    across: [Four; 2],
    torque: [Four; 2],
    reach_m: Four,
    cross: [Four; 2],
    smooth_squared: Four,
    has_cross: bool,
}

impl DragLanes {
    /// Of four links with their half-lengths, m.
    pub(crate) fn of(links: &[(LinkDrag, f64); LANES]) -> Self {
        let all = |of: &dyn Fn(&LinkDrag, f64) -> f64| links.each_ref().map(|(drag, half)| of(drag, *half));
        let pair = |of: &dyn Fn(&LinkDrag) -> [f64; 2]| [0, 1].map(|k| all(&|drag, _| of(drag)[k]));
        Self {
            along: pair(&|drag| drag.along),
            across: pair(&|drag| drag.across),
            torque: pair(&|drag| match drag.turning {
                Turning::Strip => [0.0; 2],
                Turning::Lumped(torque) => torque,
            }),
            reach_m: all(&|drag, half| if drag.turning == Turning::Strip { half } else { 0.0 }),
            cross: pair(&|drag| drag.cross.map_or([0.0; 2], |cross| cross.of_speed)),
            smooth_squared: all(&|drag, _| drag.cross.map_or(1.0, |cross| cross.smooth_m_s * cross.smooth_m_s)),
            has_cross: links.iter().any(|(drag, _)| drag.cross.is_some()),
        }
    }

    /// Load of the water on each.
    #[inline(always)]
    pub(crate) fn load(&self, [w, u, v]: &Three) -> Three {
        let mut out = [[0.0; LANES]; 3];
        for i in 0..LANES {
            out[0][i] = -(self.torque[0][i] + self.torque[1][i] * w[i].abs()) * w[i];
            out[1][i] = -(self.along[0][i] + self.along[1][i] * u[i].abs()) * u[i];
        }
        for (point, weight) in POINTS.iter().zip(WEIGHTS) {
            for i in 0..LANES {
                let at = self.reach_m[i] * point;
                let speed = v[i] + at * w[i];
                let strip = weight * (self.across[0][i] + self.across[1][i] * speed.abs()) * speed;
                out[0][i] -= at * strip;
                out[2][i] -= strip;
            }
        }
        if self.has_cross {
            for i in 0..LANES {
                let across = v[i].abs();
                let smooth = (u[i] * u[i] + self.smooth_squared[i]).sqrt();
                out[1][i] -= (self.cross[0][i] + self.cross[1][i] * across) * across * u[i] / smooth;
            }
        }
        out
    }
}
