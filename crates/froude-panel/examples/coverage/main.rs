//! How often the numerical uncertainty holds, and how generous it is.
//!
//! `coverage [--bodies N] [--tuning] [--raw FILE]`
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod bodies;
mod exact;

use std::io::Write;

use bodies::{Body, Class, Random, Reference};
use froude_mesh::measure::Measure;
use froude_mesh::sections::Resolution;
use froude_panel::mirror::positive_part;
use froude_panel::problem::Problem;
use froude_panel::{dense, fast, revolution};

const LEVELS: [usize; 3] = [4, 6, 8];
const ENTRIES: [(usize, usize); 8] = [(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (1, 5), (2, 4)];

fn solve(body: &Body, level: usize) -> ([[f64; 6]; 6], f64, f64) {
    let mesh = body.shape.mesh(Resolution { along: level, around: body.around * level }).unwrap().mesh;
    let x = mesh.vertices.iter().map(|v| v[0]).fold([f64::MAX, f64::MIN], |[l, h], x| [l.min(x), h.max(x)]);
    let volume = Measure::of(&mesh).volume_m3;
    let problem = Problem::rigid(&positive_part(&mesh, &body.planes).unwrap(), &body.planes);
    let s = if problem.facets.len() < 200 { dense::solve(&problem) } else { fast::solve(&problem) };
    (s.added_mass(0).matrix, volume, x[1] - x[0])
}

fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: usize = a[1].parse().unwrap();
    let mut random = Random(a[2].parse().unwrap());
    let mut out = std::fs::File::create(&a[3]).unwrap();
    for k in 0..n {
        let class = if a.len() > 4 { Class::Flat } else { Class::ALL[k % 3] };
        let body = bodies::body(class, k / 3, &mut random);
        let t = std::time::Instant::now();
        let values = LEVELS.map(|m| solve(&body, m));
        let t1 = t.elapsed().as_secs_f64();
        let (_, volume, length) = values[2];
        let mut refs = vec![];
        let mut exact = [[0.0; 6]; 6];
        match &body.reference {
            Reference::Ellipsoid(axes) => {
                for (i, x) in exact::ellipsoid(*axes).into_iter().enumerate() {
                    exact[i][i] = x;
                }
            }
            Reference::Revolution(m) => {
                let r = revolution::solve(m);
                exact[0][0] = r.axial_m3;
                exact[1][1] = r.transverse_m3;
                exact[2][2] = r.transverse_m3;
                exact[4][4] = r.rotary_m5;
                exact[5][5] = r.rotary_m5;
                // z of the meridian is our x; its x our z (pitch about y, sign) and y.
                exact[1][5] = r.coupling_m4;
                exact[2][4] = -r.coupling_m4;
            }
            Reference::Finer => {
                refs = [12, 16].iter().map(|m| solve(&body, *m).0).collect();
                for i in 0..6 {
                    for j in 0..6 {
                        let (c, f) = (refs[0][i][j], refs[1][i][j]);
                        exact[i][j] = f + (f - c) / (16.0f64 * 16.0 / 144.0 - 1.0);
                    }
                }
            }
        }
        let t2 = t.elapsed().as_secs_f64() - t1;
        for (i, j) in ENTRIES {
            let reach = |i: usize| if i < 3 { 1.0 } else { 0.5 * length };
            let norm = volume * reach(i) * reach(j);
            let r = refs.first().map_or(0.0, |r| r[i][j] / norm);
            writeln!(
                out,
                "{} {} {} {i}{j} {:e} {:e} {:e} {:e} {:e} {:.2} {:.2}",
                k,
                class.name(),
                body.kind.replace(' ', "_"),
                values[0].0[i][j] / norm,
                values[1].0[i][j] / norm,
                values[2].0[i][j] / norm,
                r,
                exact[i][j] / norm,
                t1,
                t2
            )
            .unwrap();
        }
    }
}
