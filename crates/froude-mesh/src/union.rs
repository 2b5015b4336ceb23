//! Solids that overlap or touch, as CAD programs export them, united: one surface, that which the water touches.
//!
//! The union is that of `boolmesh`, a port of Manifold. A sentence states what was united. The volumes must add up: with the union's and
//! the intersection's, V(A ∪ B) + V(A ∩ B) = V(A) + V(B) within [`VOLUME_PART`]; a union that fails this is refused.
//!
//! What the seam leaves in slivers is cleaned (`seam.rs`).
//!
//! `boolmesh` is not ours and may panic or never end on degenerate solids: it runs on a thread of its own, and after two minutes the
//! solids are refused. That thread cannot be ended and runs on until the program does.

use std::panic::catch_unwind;
use std::sync::mpsc::channel;
use std::thread::Builder;
use std::time::Duration;

use boolmesh::prelude::{Manifold, OpType, compute_boolean};
use indexmap::IndexSet;

use crate::check::{Kind, Trouble, is_closed, is_readable};
use crate::crossing::pairs;
use crate::files::soup::counted;
use crate::mesh::{Mesh, Panel};
use crate::panel::halves;
use crate::parts::volume;
use crate::seam::{Cleaned, cleaned};
use crate::solids::{Solids, solids};
use crate::topology::Groups;
use crate::vector::Vec3;

/// Part of both volumes by which those of union and intersection may miss them \[-\]: rounding, of solids of a million panels.
pub const VOLUME_PART: f64 = 1e-9;
/// Panels of all solids to unite; more take minutes.
const MOST_PANELS: usize = 400_000;
/// Longest time for one union: a hundred times what solids of [`MOST_PANELS`] take.
const LONGEST: Duration = Duration::from_mins(2);
/// Stack of the thread, bytes.
const STACK: usize = 64 << 20;

/// A mesh whose solids were united.
#[derive(Debug, Clone, PartialEq)]
pub struct United {
    /// Solids that met nothing are unchanged; the united ones are triangles.
    pub mesh: Mesh,
    /// A sentence for each group of solids: what was united and what was cleaned.
    pub notes: Vec<String>,
}

/// Unites the solids of a mesh that overlap or touch along an edge; `None` if there are none, or if some surface is open or inside out.
///
/// # Errors
///
/// [`Trouble`] of kind [`Kind::Crossing`] where the union fails.
pub fn united(mesh: &Mesh) -> Result<Option<United>, Trouble> {
    let Some(Solids { meshes, touching }) = is_readable(mesh).then(|| solids(mesh)).flatten() else { return Ok(None) };
    if meshes.len() < 2 || !meshes.iter().all(|solid| volume_m3(solid) > 0.0) {
        return Ok(None);
    }
    let all = meshes.iter().fold(Mesh::default(), Mesh::with);
    let number_of: Vec<usize> =
        (0..).zip(&meshes).flat_map(|(i, solid)| std::iter::repeat_n(i, solid.panels.len())).collect();
    let crossing = pairs(&all).into_iter().flatten().map(|(a, b, _)| (number_of[a as usize], number_of[b as usize]));
    let meeting: IndexSet<(usize, usize)> = crossing.chain(touching).collect();
    // Which side of a surface through itself is the water's is not known.
    if meeting.is_empty() || meeting.iter().any(|(a, b)| a == b) {
        return Ok(None);
    }
    let mut groups = Groups::new(meshes.len());
    for (a, b) in &meeting {
        groups.join(*a as u32, *b as u32);
    }
    let mut out = United { mesh: Mesh::default(), notes: Vec::new() };
    for root in 0..meshes.len() {
        let members: Vec<usize> = (root..meshes.len()).filter(|i| groups.of(*i as u32) as usize == root).collect();
        if members.len() > 1 {
            let (mesh, note) = group(&meshes, &members, &meeting)?;
            out.mesh = out.mesh.with(&mesh);
            out.notes.push(note);
        } else if members == [root] {
            out.mesh = out.mesh.with(&meshes[root]);
        }
    }
    Ok(Some(out))
}

/// What to do about solids that cannot be united.
const ELSEWHERE: &str = "unite them where they were drawn, or move them clearly into one another or apart";

/// Some solids as one, and the sentence about it.
fn group(meshes: &[Mesh], members: &[usize], meeting: &IndexSet<(usize, usize)>) -> Result<(Mesh, String), Trouble> {
    let own = || members.iter().map(|i| &meshes[*i]);
    let panels: usize = own().map(|solid| solid.panels.len()).sum();
    let first = own().find_map(|solid| solid.vertices.first()).copied().unwrap_or_default();
    let which = format!("{} solids that overlap or touch, the first at {first:?} m,", members.len());
    let refused = |why: String| Trouble::new(Kind::Crossing, format!("{which} cannot be united: {why}"));
    if panels > MOST_PANELS {
        return Err(refused(format!(
            "they have {panels} panels and the limit is {MOST_PANELS}; export them more coarsely"
        )));
    }
    let mut whole = own().next().cloned().unwrap_or_default();
    let mut inside: Vec<usize> = members.iter().take(1).copied().collect();
    let meets = |inside: &[usize], i: usize| {
        meeting.iter().any(|(a, b)| (*a == i && inside.contains(b)) || (*b == i && inside.contains(a)))
    };
    // Each next one meets what is united already.
    while let Some(next) = members.iter().copied().find(|i| !inside.contains(i) && meets(&inside, *i)) {
        whole = pair(&whole, &meshes[next]).map_err(|why| refused(format!("{why}; {ELSEWHERE}")))?;
        inside.push(next);
    }
    let given: Vec<Vec3> = own().flat_map(|solid| solid.vertices.iter().copied()).collect();
    let clean = cleaned(&whole, &given, volume_m3(&whole));
    let is_sound = |mesh: &Mesh| is_closed(mesh) && pairs(mesh).iter().all(Vec::is_empty);
    let Cleaned { mesh, merged, turned, volume_part } = if is_sound(&clean.mesh) {
        clean
    } else if is_sound(&whole) {
        Cleaned { mesh: whole, merged: 0, turned: 0, volume_part: 0.0 }
    } else {
        return Err(refused(format!(
            "panels of the union cross or touch, as of solids that have an edge or a point in common, or faces that nearly coincide; {ELSEWHERE}"
        )));
    };
    let sum_m3: f64 = own().map(volume_m3).sum();
    let mut note = format!(
        "{which} were united: of {panels} panels there are {}, of {sum_m3:.4e} m³ there are {:.4e} m³",
        mesh.panels.len(),
        volume_m3(&mesh)
    );
    if merged + turned > 0 {
        let merged = counted(merged, "edge merged", "edges merged");
        let turned = counted(turned, "diagonal turned", "diagonals turned");
        note += &format!("; slivers at the seam cleaned ({merged}, {turned}: at most {volume_part:.1e} of the volume)");
    }
    Ok((mesh, note))
}

fn volume_m3(mesh: &Mesh) -> f64 {
    volume(mesh, &(0..mesh.panels.len()).collect::<Vec<_>>())
}

/// The union of two solids, if the volumes add up.
fn pair(a: &Mesh, b: &Mesh) -> Result<Mesh, String> {
    let [union, both] = guarded([arrays(a), arrays(b)])?;
    let (sum, found) = (volume_m3(a) + volume_m3(b), volume_m3(&union) + volume_m3(&both));
    if (found - sum).abs() <= VOLUME_PART * sum {
        return Ok(union);
    }
    Err(format!("the volumes of union and intersection are {found:.6e} m³, those of the two solids {sum:.6e} m³"))
}

/// Coordinates and corners of the triangles of a mesh.
type Arrays = (Vec<f64>, Vec<usize>);

fn arrays(mesh: &Mesh) -> Arrays {
    let corners = mesh.panels.iter().flat_map(|panel| halves(mesh, *panel)).flatten();
    (mesh.vertices.iter().flatten().copied().collect(), corners.map(|v| v as usize).collect())
}

/// Union and intersection of two solids, on a thread that may fail.
fn guarded(solids: [Arrays; 2]) -> Result<[Mesh; 2], String> {
    let (answer, answered) = channel();
    let work = move || {
        let result = catch_unwind(|| {
            let [a, b] = solids.map(|(points, corners)| Manifold::<f64>::new_with_values(&points, &corners, &[]));
            let (a, b) = (a?, b?);
            let union = mesh_of(&compute_boolean(&a, &b, OpType::Add)?);
            // Of solids that only touch nothing is in both.
            let both =
                compute_boolean(&a, &b, OpType::Intersect).map_or_else(|_| Mesh::default(), |both| mesh_of(&both));
            Ok([union, both])
        });
        // Nobody waits for an answer that comes too late.
        let said = |why: String| format!("the union failed ({why})");
        let _ = answer.send(result.unwrap_or_else(|_| Err("boolmesh panicked".to_owned())).map_err(said));
    };
    Builder::new().stack_size(STACK).spawn(work).map_err(|e| format!("the system gives no thread ({e})"))?;
    match answered.recv_timeout(LONGEST) {
        Ok(result) => result,
        Err(_) => Err(format!("they take longer than {} s", LONGEST.as_secs())),
    }
}

fn mesh_of(solid: &Manifold<f64>) -> Mesh {
    let corner = |i: usize| solid.hs[i].tail as u32;
    let panels = (0..solid.hs.len() / 3).map(|t| Panel::triangle(corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)));
    Mesh { vertices: solid.ps.iter().map(|p| [p.x, p.y, p.z]).collect(), panels: panels.collect() }
}
