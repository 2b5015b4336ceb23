//! Boxes in boxes: which panels act on which points in closed form, and which by expansion.
//!
//! A cube around everything is halved again and again. A panel lies in the smallest box whose half-width is at least [`ROOM`] times the
//! panel's radius, so that fine panels lie in small boxes and coarse ones in large: that is all the adaptation there is. A point has the level
//! of the panel that it belongs to. A panel and a point are near each other when their boxes touch, both taken at the coarser of the two
//! levels; otherwise there is exactly one level at which their boxes are apart while the boxes around them touch, and there one box acts
//! on the other as a whole.

use froude_mesh::vector::Vec3;

/// Half-width of a box over the radius of a panel in it, at least.
pub(crate) const ROOM: f64 = 4.0;
/// Finest level.
const DEEPEST: u32 = 20;

/// Something in the tree: where, and the finest level whose boxes it may lie in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placed {
    pub(crate) point: Vec3,
    pub(crate) radius: f64,
}

/// The cube around everything.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cube {
    corner: Vec3,
    half_width: f64,
}

/// Place of a box among those of its level.
pub(crate) type Cell = [i32; 3];

impl Cube {
    /// Around points, larger by the factor given.
    pub(crate) fn around(items: &[Placed], factor: f64) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for item in items {
            for axis in 0..3 {
                low[axis] = low[axis].min(item.point[axis]);
                high[axis] = high[axis].max(item.point[axis]);
            }
        }
        let widest = (0..3).map(|a| high[a] - low[a]).fold(f64::MIN_POSITIVE, f64::max);
        let half_width = 0.5 * factor * 1.000_001 * widest;
        Self { corner: core::array::from_fn(|a| 0.5 * (low[a] + high[a]) - half_width), half_width }
    }

    /// Half-width of the boxes of a level.
    pub(crate) fn half_width(&self, level: u32) -> f64 {
        self.half_width * 0.5_f64.powi(level as i32)
    }

    /// Centre of a box.
    pub(crate) fn centre(&self, level: u32, cell: Cell) -> Vec3 {
        let h = self.half_width(level);
        core::array::from_fn(|a| self.corner[a] + h * f64::from(2 * cell[a] + 1))
    }

    fn cell(&self, level: u32, point: Vec3) -> Cell {
        let side = 2.0 * self.half_width(level);
        let last = (1 << level) - 1;
        core::array::from_fn(|a| (((point[a] - self.corner[a]) / side) as i32).clamp(0, last))
    }

    fn level(&self, radius: f64) -> u32 {
        let levels = (self.half_width / (ROOM * radius)).log2().floor();
        if levels > 0.0 { (levels as u32).min(DEEPEST) } else { 0 }
    }
}

/// Boxes of one level that hold something of it or of finer levels, in order of their cells along a curve.
#[derive(Debug, Clone, Default)]
pub(crate) struct Level {
    /// Places.
    pub(crate) cells: Vec<Cell>,
    codes: Vec<u64>,
    /// Things whose level this is, by box.
    pub(crate) own: Vec<Vec<u32>>,
    /// Range of all things within the box, in the order of the side.
    within: Vec<[u32; 2]>,
}

impl Level {
    /// Number of a box.
    pub(crate) fn find(&self, cell: Cell) -> Option<usize> {
        self.codes.binary_search(&code(cell)).ok()
    }
}

/// Sources, or targets.
#[derive(Debug, Clone, Default)]
pub(crate) struct Side {
    /// From the root to the finest.
    pub(crate) levels: Vec<Level>,
    /// Things along the curve.
    order: Vec<u32>,
    /// Level of each thing.
    level_of: Vec<u32>,
}

/// Bits of three coordinates in turn.
fn code(cell: Cell) -> u64 {
    let spread = |x: i32| {
        let mut x = u64::from(x as u32) & 0x1f_ffff;
        x = (x | x << 32) & 0x001f_0000_0000_ffff;
        x = (x | x << 16) & 0x001f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

impl Side {
    pub(crate) fn new(cube: &Cube, items: &[Placed]) -> Self {
        let codes: Vec<u64> = items.iter().map(|i| code(cube.cell(DEEPEST, i.point))).collect();
        let level_of: Vec<u32> = items.iter().map(|i| cube.level(i.radius)).collect();
        let mut order: Vec<u32> = (0..items.len() as u32).collect();
        order.sort_by_key(|&i| codes[i as usize]);
        let finest = level_of.iter().max().map_or(0, |l| *l);
        let mut levels: Vec<Level> = vec![Level::default(); finest as usize + 1];
        for (level, out) in levels.iter_mut().enumerate() {
            let shift = 3 * (DEEPEST - level as u32);
            let mut start = 0;
            while start < order.len() {
                let prefix = codes[order[start] as usize] >> shift;
                let length = order[start..].partition_point(|&i| codes[i as usize] >> shift == prefix);
                let members = &order[start..start + length];
                if members.iter().any(|&i| level_of[i as usize] as usize >= level) {
                    out.codes.push(prefix);
                    out.cells.push(cube.cell(level as u32, items[members[0] as usize].point));
                    let is_own = |i: &u32| level_of[*i as usize] as usize == level;
                    out.own.push(members.iter().copied().filter(is_own).collect());
                    out.within.push([start as u32, (start + length) as u32]);
                }
                start += length;
            }
        }
        Self { levels, order, level_of }
    }

    /// Things that are near those of a box of the other side.
    pub(crate) fn near(&self, level: u32, cell: Cell) -> Vec<u32> {
        let mut out = Vec::new();
        for m in 0..=level.min(self.levels.len() as u32 - 1) {
            let boxes = &self.levels[m as usize];
            let around = cell.map(|c| c >> (level - m));
            for neighbour in neighbours(m, around) {
                let Some(k) = boxes.find(neighbour) else { continue };
                if m == level {
                    let [from, to] = boxes.within[k];
                    let finer = |i: &&u32| self.level_of[**i as usize] >= level;
                    out.extend(self.order[from as usize..to as usize].iter().filter(finer));
                } else {
                    out.extend_from_slice(&boxes.own[k]);
                }
            }
        }
        out
    }

    /// Boxes of this side that act as a whole on a box of the other one, with their offset in boxes.
    pub(crate) fn far(&self, level: u32, cell: Cell) -> Vec<(usize, Cell)> {
        let Some(boxes) = self.levels.get(level as usize) else { return Vec::new() };
        let mut out = Vec::new();
        for around in neighbours(level - 1, cell.map(|c| c >> 1)) {
            for octant in 0..8 {
                let other: Cell = core::array::from_fn(|a| 2 * around[a] + (octant >> a & 1));
                let offset: Cell = core::array::from_fn(|a| other[a] - cell[a]);
                if offset.iter().any(|d| d.abs() > 1)
                    && let Some(k) = boxes.find(other)
                {
                    out.push((k, offset));
                }
            }
        }
        out
    }
}

/// Cells that touch one of a level, itself included.
fn neighbours(level: u32, cell: Cell) -> impl Iterator<Item = Cell> {
    let last = (1_i32 << level) - 1;
    (0..27)
        .map(move |k| [cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1])
        .filter(move |c| c.iter().all(|x| (0..=last).contains(x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coarse and fine things: each pair is met once, near or at one level.
    #[test]
    fn every_pair_is_met_exactly_once() {
        let items: Vec<Placed> = (0..300_u32)
            .map(|i| {
                let t = f64::from(i);
                let point = [(1.3 * t).sin(), (2.9 * t).cos() * (0.01 * t), (0.7 * t).sin() * 0.2];
                Placed { point, radius: if i % 7 == 0 { 0.1 } else { 0.002 * (1.0 + t / 40.0) } }
            })
            .collect();
        let cube = Cube::around(&items, 1.1);
        let side = &Side::new(&cube, &items);
        let mut met = vec![vec![0; items.len()]; items.len()];
        let inside = |level: usize, k: usize| {
            let [from, to] = side.levels[level].within[k];
            side.order[from as usize..to as usize].iter().filter(move |i| side.level_of[**i as usize] as usize >= level)
        };
        for (level, boxes) in side.levels.iter().enumerate() {
            for (k, cell) in boxes.cells.iter().enumerate() {
                for &t in &boxes.own[k] {
                    for s in side.near(level as u32, *cell) {
                        met[t as usize][s as usize] += 1;
                    }
                }
                if level < 2 {
                    continue;
                }
                for (other, _) in side.far(level as u32, *cell) {
                    for t in inside(level, k) {
                        for s in inside(level, other) {
                            met[*t as usize][*s as usize] += 1;
                        }
                    }
                }
            }
        }
        assert!(met.iter().flatten().all(|m| *m == 1));
        assert!(side.levels.len() > 5);
    }
}
