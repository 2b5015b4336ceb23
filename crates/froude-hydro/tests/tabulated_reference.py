"""Potential flow on the cylinders of DNV-RP-C205, Table D-2: the constants of `tabulated.rs` in this folder.

Capytaine, direct method, no free surface, three meshes, extrapolated at the order that they show. About a minute.

    pip install numpy==2.4.6 scipy==1.17.1 capytaine==3.0.0 && python tabulated_reference.py
"""
import capytaine as cpt
import numpy as np
from scipy.optimize import brentq

cpt.set_logging("ERROR")


def cosines(n):
    return -np.cos(np.linspace(0, np.pi, n + 1))


def cylinder(ratio, n):
    """Cylinder of diameter 1 along z; its polygon has the circle's area."""
    around, k = 4 * n, int(round(n * (1.5 + 0.6 * ratio)))
    cap = [np.sin(np.pi / 2 * i / n) for i in range(n + 1)]
    profile = [(r, -1.0) for r in cap] + [(1.0, z) for z in cosines(k)[1:]] + [(r, 1.0) for r in cap[-2::-1]]
    radius = 0.5 * np.sqrt(2 * np.pi / around / np.sin(2 * np.pi / around))
    angle = 2 * np.pi * np.arange(around) / around
    vertices = [(radius * r * np.cos(t), radius * r * np.sin(t), 0.5 * ratio * z) for r, z in profile for t in angle]
    faces = [[i * around + j, i * around + (j + 1) % around, (i + 1) * around + (j + 1) % around, (i + 1) * around + j]
             for i in range(len(profile) - 1) for j in range(around)]
    return cpt.Mesh(np.array(vertices), np.array(faces)), "Surge", np.pi / 4 * ratio


def coefficient(mesh, dof, volume):
    body = cpt.FloatingBody(mesh=mesh, dofs=cpt.rigid_body_dofs(rotation_center=(0, 0, 0)))
    problem = cpt.RadiationProblem(body=body, radiating_dof=dof, omega=np.inf, rho=1.0, free_surface=np.inf)
    return cpt.BEMSolver(method="direct").solve(problem, _check_wavelength=False).added_masses[dof] / volume


def extrapolated(values, ns):
    """(limit, order) of three values with an error C n^-order."""
    part = lambda p: (ns[0] ** -p - ns[1] ** -p) / (ns[1] ** -p - ns[2] ** -p)
    p = brentq(lambda p: (values[0] - values[1]) / (values[1] - values[2]) - part(p), 0.3, 5)
    return values[2] - (values[1] - values[2]) * ns[2] ** -p / (ns[1] ** -p - ns[2] ** -p), p


for ratio in (1.2, 2.5, 5, 9):
    ns = (4, 6, 9) if ratio > 3 else (5, 8, 12)
    print(f"cylinder {ratio} %.4f, order %.1f" % extrapolated([coefficient(*cylinder(ratio, n)) for n in ns], ns), flush=True)
