//! Chains of links: the parts add up to the whole.

use froude_mesh::robot::Robot;
use froude_mesh::sections::Resolution;
use froude_panel::chain::{Chain, diagonal_form, whole};
use froude_panel::problem::{Frame, Problem};
use froude_panel::{dense, solve};

const RESOLUTION: Resolution = Resolution { along: 1, around: 12 };

#[test]
fn the_links_of_a_bent_chain_add_up_to_the_body() {
    let chain = Chain::new(&Robot::NECKED_MAMBA, 2, &[0.3, -0.4, 0.2], 0.05, RESOLUTION).unwrap();
    let links = dense::solve(&chain.problem(false).unwrap());
    let mesh = &chain.surface.mesh;
    let body = Frame { origin_m: [0.1, -0.2, 0.3], axes: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]] };
    let sum = whole(&links, &body).matrix;
    let rigid = Problem::of_parts(mesh, &vec![0; mesh.panels.len()], &[body], &[]);
    let direct = dense::solve(&rigid).added_mass(0).matrix;
    let half = whole(&dense::solve(&chain.problem(true).unwrap()), &body).matrix;
    let mut apart = 0.0_f64;
    for i in 0..6 {
        for j in 0..6 {
            let size = (direct[i][i] * direct[j][j]).sqrt();
            apart = apart.max((sum[i][j] - direct[i][j]).abs() / size).max((half[i][j] - direct[i][j]).abs() / size);
        }
    }
    println!("links against the whole: {apart:.1e}");
    // Sums of some 500 terms.
    assert!(apart < 1e-10, "{apart}");
}

/// The statement about the diagonal form: the range that the rms errors of both robots lie in, 0 to 30 degrees.
const ALIKE: [f64; 2] = [0.02, 0.03];
const ALTERNATING: [f64; 2] = [0.53, 0.61];
const TRAVELLING: [f64; 2] = [0.16, 0.19];

#[test]
fn bending_a_joint_changes_the_matrix_and_the_diagonal_form_errs() {
    for robot in [Robot::NECKED_MAMBA, Robot::SMOOTH_MAMBA] {
        let mut sway = Vec::new();
        for degrees in [0.0_f64, 15.0, 30.0] {
            let angles = [0.0, degrees.to_radians(), 0.0, 0.0];
            let chain = Chain::new(&robot, 3, &angles, 0.04, Resolution { along: 2, around: 16 }).unwrap();
            let s = solve(&chain.problem(true).unwrap());
            let own = [1, 2].map(|p| s.matrix[6 * p + 1][6 * p + 1]);
            let coupling = s.matrix[7][13];
            let form = diagonal_form(&s);
            for (pattern, [low, high]) in
                [(form.alike, ALIKE), (form.alternating, ALTERNATING), (form.travelling, TRAVELLING)]
            {
                assert!(pattern.rms > low && pattern.rms < high && pattern.largest < 1.5 * pattern.rms, "{form:?}");
            }
            println!(
                "joint at {degrees} deg: sway of links 1, 2 {:.4e} {:.4e} m3, their coupling {coupling:.4e}, {:?}",
                own[0], own[1], form
            );
            sway.push(own[0]);
        }
        assert!((sway[1] / sway[0] - 1.0).abs() < 0.05 && (sway[2] / sway[0] - 1.0).abs() < 0.1, "{sway:?}");
    }
}
