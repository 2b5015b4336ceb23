//! Frames beside the body's: how a load that a sensor states along its own axes is one along the body's, about the body's reference point.
//!
//! ```toml
//! [frames.cell]
//! parent   = "body"                                # or another declared frame
//! rotation = { axis = "z", angle = "90 deg" }      # or three rows: v_parent = R v_cell
//! origin   = ["0.1 m", "0 m", "-0.2 m"]            # of the cell, in the parent's axes, from the parent's origin
//! ```
//!
//! f_body = R f, m_body = R m + r × (R f).

use indexmap::IndexMap;
use toml::Spanned;
use toml::de::DeValue;

use crate::error::{Place, RecordError};
use crate::nearest::suggestion;
use crate::run::channel::Frame;
use crate::section::{Section, found};
use crate::section_values::one_of;
use crate::units::Dimension;

/// Entries of RᵀR may be off those of the identity by as much: four digits a number.
const ORTHONORMAL: f64 = 2e-4;

/// Three rows.
pub type Rotation = [[f64; 3]; 3];

/// How a frame lies in another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// R: v in the other is R times v in the frame.
    pub rotation: Rotation,
    /// r: its origin in the other, m.
    pub origin_m: [f64; 3],
}

impl Pose {
    /// Axes and origin of the other.
    pub const SAME: Self = Self { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin_m: [0.0; 3] };

    /// The vector along the other's axes.
    #[must_use]
    pub fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// The pose in a third frame, in which the other has the pose `outer`.
    #[must_use]
    pub fn within(&self, outer: &Self) -> Self {
        let column = |j: usize| outer.turned(self.rotation.map(|row| row[j]));
        let [a, b, c] = [column(0), column(1), column(2)];
        let away = outer.turned(self.origin_m);
        Self {
            rotation: std::array::from_fn(|i| [a[i], b[i], c[i]]),
            origin_m: std::array::from_fn(|i| outer.origin_m[i] + away[i]),
        }
    }
}

/// A declared frame with its pose in the body's.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSpec {
    /// The frame that it is declared in.
    pub parent: String,
    /// Its pose there.
    pub pose: Pose,
    /// Its pose in the body's frame, by way of its parents.
    pub in_body: Pose,
}

/// `[frames.NAME]`, each with its way to the body's.
pub(crate) fn frames(root: &Section<'_>) -> Result<IndexMap<String, FrameSpec>, RecordError> {
    let Some(section) = root.section("frames")? else { return Ok(IndexMap::new()) };
    let mut out: IndexMap<String, (FrameSpec, Place)> = IndexMap::new();
    for (name, _, value) in section.entries() {
        if Frame::NAMES.contains(&name) {
            let problem = "is a frame that is known already; give the sensor's another name, \"cell\" for example";
            return Err(section.wrong(name, value, problem));
        }
        let s = section.as_section(name, value)?;
        let spec = frame(&s)?;
        let place = s.get("parent").map_or_else(|| s.place(), |v| s.source.place(v.span().start));
        out.insert(name.to_owned(), (spec, place));
    }
    let resolved = out.iter().map(|(name, (spec, place))| {
        let refuse = |problem: String| RecordError::value(place.clone(), "parent", problem);
        let (mut pose, mut parent) = (spec.pose, spec.parent.as_str());
        for _ in 0..=out.len() {
            if parent == Frame::Body.name() {
                return Ok((name.clone(), FrameSpec { in_body: pose, ..spec.clone() }));
            }
            let Some((next, _)) = out.get(parent) else {
                let known = out.keys().map(String::as_str).filter(|known| known != name).chain(["body"]);
                return Err(refuse(format!("is {parent:?}; {}", suggestion(parent, known))));
            };
            pose = pose.within(&next.pose);
            parent = &next.parent;
        }
        Err(refuse(format!(
            "is {:?}, which leads back to {name} and never to the body; one of them lies in \"body\"",
            spec.parent
        )))
    });
    resolved.collect()
}

fn frame(s: &Section<'_>) -> Result<FrameSpec, RecordError> {
    s.only(&["parent", "rotation", "origin"])?;
    let parent = s.need_text("parent", "write parent = \"body\"")?.to_owned();
    let value = s.need("rotation", "write rotation = { axis = \"z\", angle = \"90 deg\" }, or three rows")?;
    let rotation =
        if value.get_ref().as_array().is_some() { rows(s, value)? } else { about(&s.as_section("rotation", value)?)? };
    let advice = "write origin = [\"0.1 m\", \"0 m\", \"0 m\"], all zero where it lies in the parent's";
    let value = s.need("origin", advice)?;
    let list = value.get_ref().as_array().filter(|list| list.len() == 3);
    let list = list.ok_or_else(|| s.wrong("origin", value, format!("is {}; expected three lengths", found(value))))?;
    let mut origin_m = [0.0; 3];
    for (m, value) in origin_m.iter_mut().zip(list.iter()) {
        *m = s.as_quantity_of("origin", value, Dimension::LENGTH)?;
    }
    let pose = Pose { rotation, origin_m };
    Ok(FrameSpec { parent, pose, in_body: pose })
}

/// Three rows of three numbers: orthonormal, and right-handed.
fn rows<'a>(s: &Section<'a>, value: &'a Spanned<DeValue<'a>>) -> Result<Rotation, RecordError> {
    let shape = || {
        s.wrong("rotation", value, "is not three rows of three numbers, [[0, -1, 0], [1, 0, 0], [0, 0, 1]] for example")
    };
    let list = value.get_ref().as_array().filter(|list| list.len() == 3).ok_or_else(shape)?;
    let mut out: Rotation = [[0.0; 3]; 3];
    for (row, value) in out.iter_mut().zip(list.iter()) {
        let numbers = value.get_ref().as_array().filter(|list| list.len() == 3).ok_or_else(shape)?;
        for (x, number) in row.iter_mut().zip(numbers.iter()) {
            *x = s.as_number("rotation", number)?;
        }
    }
    let dot = |i: usize, j: usize| out.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let off = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let off = off.map(|(i, j)| (dot(i, j) - f64::from(u8::from(i == j))).abs()).fold(0.0, f64::max);
    if off.is_nan() || off > ORTHONORMAL {
        let problem = format!(
            "turns nothing: its columns are off unit vectors at right angles by {off:.2e}, and {ORTHONORMAL:.0e} is allowed; write four digits or more, or an axis and an angle"
        );
        return Err(s.wrong("rotation", value, problem));
    }
    let [a, b, c] = out;
    let determinant =
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    if determinant < 0.0 {
        return Err(s.wrong("rotation", value, "is a reflection (its determinant is -1): a left-handed frame; turn the sign of one axis, and that of its loads"));
    }
    Ok(out)
}

/// A right-handed turn of the frame about an axis of its parent.
fn about(s: &Section<'_>) -> Result<Rotation, RecordError> {
    s.only(&["axis", "angle"])?;
    let axis = one_of(s, "axis", &["x", "y", "z"], &[0_usize, 1, 2])?
        .ok_or_else(|| s.missing("axis", "write axis = \"x\", \"y\" or \"z\""))?;
    let angle = s.quantity("angle", Dimension::ANGLE)?.ok_or_else(|| s.missing("angle", "write angle = \"90 deg\""))?;
    let (sin, cos) = angle.sin_cos();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out: Rotation = [[0.0; 3]; 3];
    out[axis][axis] = 1.0;
    (out[j][j], out[j][k], out[k][j], out[k][k]) = (cos, -sin, sin, cos);
    Ok(out)
}
