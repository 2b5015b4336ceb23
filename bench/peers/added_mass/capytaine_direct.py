"""Capytaine, direct method, no free surface: 6 x 6 added mass of a mesh file (see measure.py), one JSON line.

Timed: a fresh solver, influence matrices, factorisation, six right-hand sides, the matrix. Not timed: imports, reading,
the body, Capytaine's table of wave integrals (not needed here). Set OMP_NUM_THREADS for a fair comparison.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 taskset -c 0 python capytaine_direct.py hull.mesh --runs 5
"""
import numpy as np

from measure import arguments, measured, read_mesh, report

options = arguments(__doc__).parse_args()

import capytaine as cpt  # noqa: E402

cpt.set_logging("ERROR")
mesh = cpt.Mesh(*read_mesh(options.mesh))
n_panels = mesh.nb_faces
for axis in options.planes:
    mesh = cpt.ReflectionSymmetricMesh(mesh, plane={"x": "yOz", "y": "xOz"}[axis])
body = cpt.FloatingBody(mesh=mesh, dofs=cpt.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.0)))
green_function = cpt.Delhommeau(floating_point_precision="float64")
names = ["Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw"]


def solve():
    engine = cpt.DefaultMatrixEngine(green_function=green_function, linear_solver="lu_decomposition_with_overwrite")
    solver = cpt.BEMSolver(method="direct", engine=engine)
    matrix = np.zeros((6, 6))
    for column, motion in enumerate(names):
        problem = cpt.RadiationProblem(body=body, radiating_dof=motion, omega=np.inf, rho=1.0, free_surface=np.inf)
        forces = solver.solve(problem, keep_details=False, _check_wavelength=False).added_masses
        matrix[:, column] = [forces[name] for name in names]
    return matrix


added_mass, times = measured(solve, options.runs)
report("capytaine", n_panels, options.planes, times, added_mass, method="direct")
