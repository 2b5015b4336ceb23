//! Random bodies of three classes.

use core::f64::consts::PI;

use froude_hydro::Link;
use froude_mesh::robot::{Neck, Robot, sections};
use froude_mesh::sections::{Curve, Grading, Piece, Section, SectionBody};
use froude_panel::mirror::Mirror;
use froude_panel::revolution::{Meridian, Stretch};

/// Proportions of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// Length over breadth from 4 to 12.
    Slender,
    /// Breadth over height, either way, from 2 to 5; length over breadth from 1.2 to 4.
    Flat,
    /// All three dimensions within a factor of 1.7.
    NearSphere,
}

impl Class {
    /// All.
    pub const ALL: [Self; 3] = [Self::Slender, Self::Flat, Self::NearSphere];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slender => "slender",
            Self::Flat => "flat",
            Self::NearSphere => "near-sphere",
        }
    }
}

/// What its matrix is compared with.
pub enum Reference {
    /// The closed form of an ellipsoid with these semi-axes.
    Ellipsoid([f64; 3]),
    /// The solver for bodies of revolution, on this meridian.
    Revolution(Vec<Stretch>),
    /// Meshes twice as fine, extrapolated.
    Finer,
}

/// A body of the study.
pub struct Body {
    /// Its kind, for the table.
    pub kind: &'static str,
    /// Its shape.
    pub shape: SectionBody,
    /// Its planes.
    pub planes: Vec<Mirror>,
    /// What its matrix is compared with.
    pub reference: Reference,
    /// Panels around of the coarsest mesh.
    pub around: usize,
}

/// Numbers without a pattern, the same on every machine (Steele, Lea & Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// The next, in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Between two positive numbers, their ratios equally likely.
    pub fn ratio(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// Half-width, half-height and half-length of a class; the larger of the first two is 1.
fn proportions(class: Class, random: &mut Random) -> [f64; 3] {
    let (section, length) = match class {
        Class::Slender => (random.ratio(0.6, 1.0), random.ratio(4.0, 12.0)),
        Class::Flat => (random.ratio(0.2, 0.5), random.ratio(1.2, 4.0)),
        Class::NearSphere => (random.ratio(0.8, 1.0), random.ratio(0.8, 1.35)),
    };
    if random.next() < 0.5 { [1.0, section, length] } else { [section, 1.0, length] }
}

/// Cells of a stretch: one for every twice the half-breadth at the coarsest.
fn cells(length: f64) -> usize {
    (length / 2.0).round().clamp(1.0, 6.0) as usize
}

const QUARTER: [Mirror; 2] = [Mirror::body(1), Mirror::body(2)];
const OCTANT: [Mirror; 3] = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];

/// A body of a class, one of five kinds.
pub fn body(class: Class, kind: usize, random: &mut Random) -> Body {
    let mut body = any(class, kind, random);
    if class == Class::Flat {
        body.around = 8;
    }
    body
}

fn any(class: Class, kind: usize, random: &mut Random) -> Body {
    let [width, height, half] = proportions(class, random);
    match kind % 5 {
        0 => Body {
            kind: "ellipsoid",
            shape: SectionBody::ellipsoid([half, width, height], cells(half).max(2)),
            planes: OCTANT.to_vec(),
            reference: Reference::Ellipsoid([half, width, height]),
            around: 4,
        },
        // No circular section is flat: the class gets a second tri-axial ellipsoid, spheroids among them.
        1 if class == Class::Flat => {
            let length = if random.next() < 0.3 { width } else { half };
            Body {
                kind: "ellipsoid",
                shape: SectionBody::ellipsoid([length, width, height], cells(length).max(2)),
                planes: OCTANT.to_vec(),
                reference: Reference::Ellipsoid([length, width, height]),
                around: 4,
            }
        }
        1 => capsule("round capsule", [1.0, 1.0, half], random),
        2 => capsule("capsule", [width, height, half], random),
        3 => necked([width, height, half], random),
        _ => {
            let tube = cells(2.0 * half);
            Body {
                kind: "flat ends",
                shape: SectionBody::flat_cylinder(half, width, height, [2, tube]),
                planes: OCTANT.to_vec(),
                reference: Reference::Finer,
                around: 4,
            }
        }
    }
}

/// A cylinder between half-ellipsoids of different lengths, the middle of the whole at the origin.
fn capsule(kind: &'static str, [width, height, half]: [f64; 3], random: &mut Random) -> Body {
    let most = 0.8 * half;
    let ends = [0, 1].map(|_| random.between(0.3_f64.min(0.5 * most), most.min(2.0)));
    let [low, high] = [-half + ends[0], half - ends[1]];
    let section = |x_m| Section::new(x_m, width, height);
    let tip = |x_m| Section::new(x_m, 0.0, 0.0);
    let piece = |ends, curve, grading, cells| Piece { ends, curve, grading, cells, part: 0 };
    let shape = SectionBody {
        pieces: vec![
            piece([tip(-half), section(low)], Curve::Elliptic, Grading::Even, 2),
            piece([section(low), section(high)], Curve::Straight, Grading::Both, cells(high - low)),
            piece([section(high), tip(half)], Curve::Elliptic, Grading::Even, 2),
        ],
    };
    let reference = if width == height { Reference::Revolution(meridian(low, high, ends)) } else { Reference::Finer };
    Body { kind, shape, planes: QUARTER.to_vec(), reference, around: 4 }
}

/// The meridian of a capsule of radius 1, finer towards the junctions.
fn meridian(low: f64, high: f64, ends: [f64; 2]) -> Vec<Stretch> {
    let cap = |centre_m, along_m, angle_rad| Meridian::Ellipse { centre_m, along_m, across_m: 1.0, angle_rad };
    let tube = Meridian::Cylinder { radius_m: 1.0, z_m: [low, high] };
    let cut = |piece: Meridian, cuts: &[f64]| -> Vec<Stretch> {
        cuts.windows(2).map(|w| Stretch { piece, t: [w[0], w[1]] }).collect()
    };
    let fine: Vec<f64> = (0..=6).map(|i| 1.0 - 0.5_f64.powi(i)).chain([1.0]).collect();
    let back: Vec<f64> = fine.iter().rev().map(|t| 1.0 - t).collect();
    let half_fine: Vec<f64> = back.iter().map(|t| 0.5 * t).collect();
    let tube_cuts: Vec<f64> = half_fine.iter().copied().chain(fine[1..].iter().map(|t| 0.5 + 0.5 * t)).collect();
    let mut out = cut(cap(low, ends[0], [0.0, 0.5 * PI]), &fine);
    out.extend(cut(tube, &tube_cuts));
    out.extend(cut(cap(high, ends[1], [0.5 * PI, PI]), &back));
    out
}

/// A chain with necks, its head longer or shorter than its tail.
fn necked([width, height, half]: [f64; 3], random: &mut Random) -> Body {
    let links = if half > 6.0 { 2 } else { 1 };
    let end_m = random.between(0.3, 0.5) * half / links as f64;
    let neck_m = random.between(0.25, 0.5) * half / links as f64;
    let pitch_m = (2.0 * (half - end_m) - neck_m) / links as f64;
    let robot = Robot {
        link: Link { major_semi_axis_m: height, minor_semi_axis_m: width, half_length_m: 0.5 * pitch_m },
        neck: Some(Neck {
            length_m: neck_m,
            scale: random.between(0.6, 0.9),
            ramp_m: random.between(0.1, 0.3) * neck_m,
        }),
        end_m,
    };
    let mut shape = sections(&robot, links, 2.0);
    if let Some(head) = shape.pieces.last_mut() {
        head.ends[1].x_m += random.between(-0.3, 0.5) * end_m;
        head.cells = 2;
    }
    shape.pieces[0].cells = 2;
    Body { kind: "necked", shape, planes: QUARTER.to_vec(), reference: Reference::Finer, around: 4 }
}
