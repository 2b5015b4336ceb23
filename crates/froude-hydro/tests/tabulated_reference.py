"""Potential flow on the bodies of DNV-RP-C205, Table D-2: the constants of `tabulated.rs` in this folder.

Plates: doublets constant over rectangles, spaced by cosines, no flow at their (cosine) middles; extrapolated from
24 and 36 cells a side at second order. Prisms and cylinders: Capytaine, direct method, no free surface, three
meshes, extrapolated at the order that they show. About two minutes.

    pip install numpy==2.4.6 scipy==1.17.1 capytaine==3.0.0 && python tabulated_reference.py
"""
import capytaine as cpt
import numpy as np
from scipy.optimize import brentq

cpt.set_logging("ERROR")


def cosines(n):
    return -np.cos(np.linspace(0, np.pi, n + 1))


def plate(ratio, n):
    """Coefficient on pi/4 a^2 b of a plate 1 x ratio, n cells across."""
    m = int(n * (1 + 0.25 * (ratio - 1)))
    x, y = 0.5 * cosines(n), 0.5 * ratio * cosines(m)
    middle = lambda k: -0.5 * np.cos((np.arange(k) + 0.5) * np.pi / k)
    px, py = (q.ravel() for q in np.meshgrid(middle(n), ratio * middle(m), indexing="ij"))
    x0, y0 = (q.ravel() for q in np.meshgrid(x[:-1], y[:-1], indexing="ij"))
    x1, y1 = (q.ravel() for q in np.meshgrid(x[1:], y[1:], indexing="ij"))

    def corner(cx, cy):
        dx, dy = px[:, None] - cx, py[:, None] - cy
        return np.hypot(dx, dy) / (dx * dy)

    w = (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)) / (4 * np.pi)
    doublets = np.linalg.solve(w, np.ones(n * m))
    return abs((doublets * (x1 - x0) * (y1 - y0)).sum()) / (np.pi / 4 * ratio)


def box(ratio, n):
    """Square prism 1 x 1 x ratio along z."""
    k = int(round(n * (1 + 0.3 * (ratio - 1))))
    side, long = 0.5 * cosines(n), 0.5 * ratio * cosines(k)
    vertices, faces = [], []

    def face(u, v, place):
        first = len(vertices)
        vertices.extend(place(a, b) for a in u for b in v)
        c = len(v)
        faces.extend([first + i * c + j, first + (i + 1) * c + j, first + (i + 1) * c + j + 1, first + i * c + j + 1]
                     for i in range(len(u) - 1) for j in range(c - 1))

    face(side, side, lambda a, b: (a, b, ratio / 2))
    face(side, side, lambda a, b: (b, a, -ratio / 2))
    face(side, long, lambda a, b: (0.5, a, b))
    face(long, side, lambda a, b: (-0.5, b, a))
    face(long, side, lambda a, b: (b, 0.5, a))
    face(side, long, lambda a, b: (a, -0.5, b))
    return cpt.Mesh(np.array(vertices), np.array(faces)), "Heave", float(ratio)


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


for ratio in (1, 1.25, 1.5, 1.59, 2, 2.5, 3, 3.17, 4, 5, 6.25, 8, 10):
    low, high = plate(ratio, 24), plate(ratio, 36)
    print(f"plate {ratio} {high + (high - low) / (1.5**2 - 1):.5f}", flush=True)
for ratio in (1, 2, 5, 10):
    ns = (7, 11, 17) if ratio < 5 else (6, 9, 14)
    print(f"prism {ratio} %.4f, order %.1f" % extrapolated([coefficient(*box(ratio, n)) for n in ns], ns), flush=True)
for ratio in (1.2, 2.5, 5, 9):
    ns = (4, 6, 9) if ratio > 3 else (5, 8, 12)
    print(f"cylinder {ratio} %.4f, order %.1f" % extrapolated([coefficient(*cylinder(ratio, n)) for n in ns], ns), flush=True)
