//! Motion of the head over a period of a gait, four at a time: what the search for the motion that repeats spends its time on.
//!
//! The joints of a gait do the same in every period, and so the places of the links in the head's axes, what they move by the joints alone and the inertia of the whole are known beforehand at
//! every half step. The momentum h of body and water about the head's centre then has
//!
//! ḣ + (head) ×* h = Σ loads of the water's drag,  h = M V + b,
//!
//! with V the head's motion, M the inertia of the whole and b the momentum of the joints' motion: no accelerations, and nothing but the drag is left for each link.
//! It is the same motion as [`crate::path`] has by accelerations, which is the reference. Four motions of one gait go side by side: one and its three neighbours, by which the map over a
//! period is differentiated.
//!
//! **Source.** Kirchhoff's equations of the whole, Lamb (1932), §124; our derivation.

use faer::Mat;

use crate::chain::{AddedMass, Chain};
use crate::drag_lanes::{DragLanes, LANES, Three};
use crate::gait::{Course, Shape};
use crate::newton::{Form, Map, STEP};
use crate::planar::{Inertia, Load, Motion, turned};

/// Motions side by side.
pub const SIDE_BY_SIDE: usize = LANES;

/// How many steps make one until the motion is nearly found.
pub const COARSE: usize = 4;

/// A link at a moment, in the head's axes.
#[derive(Debug, Clone, Copy)]
struct Posed {
    cos: f64,
    sin: f64,
    /// Place of its centre, m.
    at: [f64; 2],
    /// What it moves by the joints alone, in its own axes.
    by_joints: Motion,
}

/// A chain at a moment.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// Of the whole about the head's centre.
    inertia: Inertia,
    /// Its inverse, row by row.
    inverse: [[f64; 3]; 3],
    /// Momentum of what the joints move.
    by_joints: Load,
}

/// A gait of a chain, ready for any motion of its head.
#[derive(Debug, Clone)]
pub struct HeadMap {
    drag: Vec<DragLanes>,
    /// Added inertia of the links where its load is the printed one, which lacks the pair of Kirchhoff's.
    printed: Vec<Inertia>,
    nodes: Vec<Node>,
    posed: Vec<Posed>,
    step_s: f64,
    form: Form,
    periods: usize,
}

impl HeadMap {
    /// In `steps` steps of Runge and Kutta's fourth order a period; `None` where an inertia is not positive.
    #[must_use]
    pub fn new(chain: &Chain, course: &dyn Course, period_s: f64, steps: usize) -> Option<Self> {
        let step_s = period_s / steps as f64;
        let mut shape = Shape::straight(chain.joints());
        let (mut nodes, mut posed) = (Vec::new(), Vec::new());
        for k in 0..=2 * steps {
            course.at(0.5 * step_s * k as f64, &mut shape);
            let from = posed.len();
            poses(chain, &shape, &mut posed);
            nodes.push(node(chain, &posed[from..])?);
        }
        Some(Self {
            drag: chain.links.iter().map(|link| DragLanes::of(&[(link.drag, link.half_length_m); LANES])).collect(),
            printed: match chain.added_mass {
                AddedMass::Full => Vec::new(),
                AddedMass::Usr => chain.links.iter().map(|link| link.added).collect(),
            },
            nodes,
            posed,
            step_s,
            form: {
                let [turn, speed] = chain.per_period(period_s);
                Form { size: vec![turn, speed, speed], tilt: None, has_corners: false }
            },
            periods: 0,
        })
    }

    /// The head's motions at the end of a period from those at its beginning, in one step of so many, which divide their number.
    #[must_use]
    pub fn over(&self, heads: &[Motion; SIDE_BY_SIDE], one_of: usize) -> [Motion; SIDE_BY_SIDE] {
        froude_lanes::run(Over { map: self, heads, one_of })
    }
}

impl Map for HeadMap {
    fn form(&self) -> &Form {
        &self.form
    }

    fn over(&mut self, from: &[f64], one_of: usize) -> Option<Vec<f64>> {
        let [end, ..] = HeadMap::over(self, &[[from[0], from[1], from[2]]; SIDE_BY_SIDE], one_of);
        Some(end.to_vec())
    }

    fn periods(&self) -> usize {
        self.periods
    }

    /// One motion and its three neighbours.
    fn differentiated(&mut self, from: &[f64], _: Option<Vec<f64>>, one_of: usize) -> Option<(Vec<f64>, Mat<f64>)> {
        self.periods += 1;
        let (size, mut starts) = (&self.form.size, [[from[0], from[1], from[2]]; SIDE_BY_SIDE]);
        for j in 0..3 {
            starts[j + 1][j] += STEP * size[j];
        }
        let [end, moved @ ..] = HeadMap::over(self, &starts, one_of);
        let is_finite = end.iter().all(|x| x.is_finite());
        is_finite.then(|| (end.to_vec(), Mat::from_fn(3, 3, |i, j| (moved[j][i] - end[i]) / (STEP * size[j]))))
    }
}

/// A period, compiled for what the processor has.
struct Over<'a> {
    map: &'a HeadMap,
    heads: &'a [Motion; SIDE_BY_SIDE],
    one_of: usize,
}

impl froude_lanes::Kernel for Over<'_> {
    type Output = [Motion; SIDE_BY_SIDE];

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Self::Output {
        let map = self.map;
        let mut h = map.nodes[0].momentum(&transposed(self.heads));
        let (half, s) = (self.one_of, self.one_of as f64 * map.step_s);
        for at in (0..map.nodes.len() - 1).step_by(2 * half) {
            let k1 = map.rate(at, &h);
            let k2 = map.rate(at + half, &moved(&h, 0.5 * s, &k1));
            let k3 = map.rate(at + half, &moved(&h, 0.5 * s, &k2));
            let k4 = map.rate(at + 2 * half, &moved(&h, s, &k3));
            for a in 0..3 {
                for lane in 0..LANES {
                    h[a][lane] += s / 6.0 * (k1[a][lane] + 2.0 * (k2[a][lane] + k3[a][lane]) + k4[a][lane]);
                }
            }
        }
        let end = map.nodes[map.nodes.len() - 1].motion(&h);
        std::array::from_fn(|lane| [end[0][lane], end[1][lane], end[2][lane]])
    }
}

impl HeadMap {
    /// ḣ at a node.
    #[inline(always)]
    fn rate(&self, at: usize, h: &Three) -> Three {
        let head = self.nodes[at].motion(h);
        let mut sum = [[0.0; LANES]; 3];
        let n = self.drag.len();
        for (i, (link, drag)) in self.posed[at * n..(at + 1) * n].iter().zip(&self.drag).enumerate() {
            let own = link.motion(&head);
            let mut load = drag.load(&own);
            if let Some(added) = self.printed.get(i) {
                add_printed(added, &own, &mut load);
            }
            link.add_to(&load, &mut sum);
        }
        for lane in 0..LANES {
            let of = |v: &Three| [v[0][lane], v[1][lane], v[2][lane]];
            let pair = turned(of(&head), of(h));
            for a in 0..3 {
                sum[a][lane] -= pair[a];
            }
        }
        sum
    }
}

impl Node {
    #[inline(always)]
    fn motion(&self, h: &Three) -> Three {
        let mut out = [[0.0; LANES]; 3];
        for a in 0..3 {
            for b in 0..3 {
                for lane in 0..LANES {
                    out[a][lane] += self.inverse[a][b] * (h[b][lane] - self.by_joints[b]);
                }
            }
        }
        out
    }

    fn momentum(&self, motion: &Three) -> Three {
        let each: [Load; SIDE_BY_SIDE] = std::array::from_fn(|lane| {
            let h = self.inertia.times([motion[0][lane], motion[1][lane], motion[2][lane]]);
            [0, 1, 2].map(|a| h[a] + self.by_joints[a])
        });
        transposed(&each)
    }
}

impl Posed {
    #[inline(always)]
    fn motion(&self, head: &Three) -> Three {
        let mut out = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let [w, u, v] = [head[0][lane], head[1][lane], head[2][lane]];
            let (x, y) = (u - self.at[1] * w, v + self.at[0] * w);
            out[0][lane] = w + self.by_joints[0];
            out[1][lane] = self.cos * x + self.sin * y + self.by_joints[1];
            out[2][lane] = self.cos * y - self.sin * x + self.by_joints[2];
        }
        out
    }

    #[inline(always)]
    fn add_to(&self, load: &Three, sum: &mut Three) {
        for lane in 0..LANES {
            let x = self.cos * load[1][lane] - self.sin * load[2][lane];
            let y = self.sin * load[1][lane] + self.cos * load[2][lane];
            sum[0][lane] += load[0][lane] + self.at[0] * y - self.at[1] * x;
            sum[1][lane] += x;
            sum[2][lane] += y;
        }
    }
}

/// The printed load lacks what the turning of the axes makes of the water's momentum.
#[inline(always)]
fn add_printed(added: &Inertia, own: &Three, load: &mut Three) {
    for lane in 0..LANES {
        let motion = [own[0][lane], own[1][lane], own[2][lane]];
        let pair = turned(motion, added.times(motion));
        for a in 0..3 {
            load[a][lane] += pair[a];
        }
    }
}

#[inline(always)]
fn moved(h: &Three, by: f64, rate: &Three) -> Three {
    let mut out = *h;
    for a in 0..3 {
        for lane in 0..LANES {
            out[a][lane] += by * rate[a][lane];
        }
    }
    out
}

fn transposed(all: &[[f64; 3]; SIDE_BY_SIDE]) -> Three {
    [0, 1, 2].map(|a| std::array::from_fn(|lane| all[lane][a]))
}

/// Links in the head's axes, and what the joints move of them.
fn poses(chain: &Chain, shape: &Shape, out: &mut Vec<Posed>) {
    let (mut turning, mut joint) = (0.0, [0.0; 2]);
    for (i, (at, turn)) in chain.places([0.0; 2], 0.0, &shape.angle).enumerate() {
        let (sin, cos) = turn.sin_cos();
        let half = chain.links[i].half_length_m;
        if i > 0 {
            turning -= shape.rate[i - 1];
        }
        // From the joint before it to its centre, and on to the joint behind it.
        let by = half * turning;
        let centre = if i > 0 { [joint[0] + by * sin, joint[1] - by * cos] } else { [0.0; 2] };
        joint = [centre[0] + by * sin, centre[1] - by * cos];
        let own = [cos * centre[0] + sin * centre[1], cos * centre[1] - sin * centre[0]];
        out.push(Posed { cos, sin, at, by_joints: [turning, own[0], own[1]] });
    }
}

/// Inertia of the whole, with the momentum of what the joints move.
fn node(chain: &Chain, posed: &[Posed]) -> Option<Node> {
    let (mut columns, mut by_joints) = ([[0.0; 3]; 3], [0.0; 3]);
    for (link, posed) in chain.links.iter().zip(posed) {
        let inertia = link.inertia();
        let to_head = |load: Load| {
            let mut sum = [[0.0; LANES]; 3];
            posed.add_to(&load.map(|l| [l; SIDE_BY_SIDE]), &mut sum);
            [sum[0][0], sum[1][0], sum[2][0]]
        };
        let carried = to_head(inertia.times(posed.by_joints));
        for (a, column) in columns.iter_mut().enumerate() {
            let unit: Motion = std::array::from_fn(|b| f64::from(u8::from(a == b)));
            let still = Posed { by_joints: [0.0; 3], ..*posed };
            let moved = still.motion(&unit.map(|x| [x; SIDE_BY_SIDE]));
            let load = to_head(inertia.times([moved[0][0], moved[1][0], moved[2][0]]));
            for b in 0..3 {
                column[b] += load[b];
            }
        }
        for b in 0..3 {
            by_joints[b] += carried[b];
        }
    }
    let [turn, x, y] = columns;
    let inertia = Inertia { turn: turn[0], turn_x: turn[1], turn_y: turn[2], x: x[1], xy: x[2], y: y[2] };
    let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|load| inertia.solve(load));
    let (a, b, c) = (a?, b?, c?);
    Some(Node { inertia, inverse: [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]], by_joints })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::Link;
    use crate::drag::{Cross, LinkDrag, Turning};
    use crate::dynamics::{Dynamics, StateOf};
    use crate::gait::{Envelope, Gait};
    use crate::path::Swimmer;

    /// Both forms of the added mass and of the drag: the end of a period by momenta is that by accelerations. Two integrations of fourth order in 800 steps differ by some 1e-9 of the speed.
    #[test]
    fn a_period_by_momenta_is_that_by_accelerations() {
        let gait = Gait { turn: 0.1, ..Gait::wave(0.5, 1.4, 0.7, Envelope::Eel) };
        for (added_mass, turning) in
            [(AddedMass::Full, Turning::Strip), (AddedMass::Usr, Turning::Lumped([1e-3, 2e-3]))]
        {
            let drag = LinkDrag {
                along: [0.1, 0.4],
                across: [0.2, 15.0],
                cross: Some(Cross { of_speed: [-0.05, 0.5], smooth_m_s: 1e-2 }),
                turning,
            };
            let added = Inertia { turn: 4.5e-3, turn_y: 0.02, x: 0.1, y: 1.653, ..Inertia::default() };
            let link = Link { half_length_m: 0.09, rigid: Inertia::rigid(1.343, 4e-3, 0.01), added, drag };
            let chain = Chain { links: vec![link; 6], added_mass };
            let heads = [[0.1, 0.2, -0.05], [0.0, 0.1, 0.0], [-0.2, 0.0, 0.1], [0.3, 0.3, 0.0]];
            let found = HeadMap::new(&chain, &gait, gait.period_s(), 800).unwrap().over(&heads, 1);
            for (head, found) in heads.iter().zip(found) {
                let h = gait.period_s() / 800.0;
                let mut swimmer = Swimmer::new(&chain, &gait);
                let start = StateOf::<Chain> { head: *head, ..Chain::REST };
                let end = (0..800).fold(start, |s, i| swimmer.step(h * f64::from(i), h, &s).unwrap());
                for (a, b) in found.iter().zip(end.head) {
                    assert!((a - b).abs() < 1e-8, "{found:?} {:?}", end.head);
                }
            }
        }
    }
}
