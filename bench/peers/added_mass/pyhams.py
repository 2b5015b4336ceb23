"""HAMS by pyhams: 6 x 6 added mass of a mesh file (see measure.py) far below the surface, one JSON line.

HAMS always has a free surface and works through files, with at least one frequency between the limits. The mesh is
therefore sunk by `--depth`, by default 100 times its reach, in water without a bed; a run is three conditions (zero,
infinity, one frequency), and `conditions` says so: a third of the time is one assembly with factorisation. The matrix
is that at infinite frequency. One plane of symmetry at most: with two HAMS 1.3.1 writes empty results. Timed: the whole of `run_hams`. HAMS writes on standard output; that goes nowhere.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 taskset -c 0 python pyhams.py hull.mesh --runs 5
"""
import importlib
import os
import pathlib
import sys
import tempfile

import numpy as np

from measure import arguments, measured, read_mesh, report

parser = arguments(__doc__)
parser.add_argument("--depth", type=float, help="of the origin below the surface, m, to a millimetre")
options = parser.parse_args()
if len(options.planes) > 1:
    raise SystemExit("HAMS takes one plane of symmetry: give --planes x or --planes y with half of the mesh")

# This file has the package's name: look for the package where it is installed.
here = os.path.dirname(os.path.abspath(__file__))
sys.modules.pop("pyhams", None)
sys.path = [folder for folder in sys.path if os.path.abspath(folder or ".") != here]
hams = importlib.import_module("pyhams.pyhams")

vertices, panels = read_mesh(options.mesh)
depth = options.depth or float(np.ceil(100 * np.linalg.norm(vertices, axis=1).max()))
work = tempfile.TemporaryDirectory(prefix="hams-")
folder = pathlib.Path(work.name)
hams.create_hams_dirs(str(folder))
hams.write_hydrostatic_file(str(folder), cog=np.array([0.0, 0.0, -depth]))
hams.write_control_file(str(folder), waterDepth=1.0, incFLim=1, iFType=3, oFType=3, numFreqs=-1, minFreq=1.0, dFreq=0.1,
                        numHeadings=1, headingList=[0.0], refBodyCenter=[0.0, 0.0, -depth],
                        numThreads=int(os.environ.get("OMP_NUM_THREADS", "1")))


def write_mesh(path):
    """The mesh in HAMS's own form: numbers from 1, triangles with three of them."""
    symmetry = [int(axis in options.planes) for axis in "xy"]
    rows = ["--------------Hull Mesh File---------------", "", "# Number of Panels, Nodes, X-Symmetry and Y-Symmetry",
            f"{len(panels)} {len(vertices)} {symmetry[0]} {symmetry[1]}", "",
            "#Start Definition of Node Coordinates     ! node_number   x   y   z"]
    rows += [f"{i} {x:.15e} {y:.15e} {z - depth:.15e}" for i, (x, y, z) in enumerate(vertices, 1)]
    rows += ["#End Definition of Node Coordinates", "",
             "#Start Definition of Node Relations   ! panel_number  number_of_vertices   Vertex1_ID   Vertex2_ID   ..."]
    for i, panel in enumerate(panels, 1):
        corners = list(dict.fromkeys(int(v) + 1 for v in panel))
        rows.append(" ".join(map(str, [i, len(corners), *corners])))
    rows += ["#End Definition of Node Relations", "", "--------------End Hull Mesh File---------------"]
    path.write_text("\n".join(rows) + "\n")


write_mesh(folder / "Input" / "HullMesh.pnl")
# Fortran keeps what it prints until the program ends: our own line goes by another way.
sys.stdout = os.fdopen(os.dup(1), "w")
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
_, times = measured(lambda: hams.run_hams(str(folder)), options.runs)
limits = {}
for row in (folder / "Output" / "Wamit_format" / "Buoy.1").read_text().splitlines():
    frequency, i, j, value = row.split()[:4]
    limits.setdefault(float(frequency), np.zeros((6, 6)))[int(i) - 1, int(j) - 1] = float(value)
# Output by frequency: HAMS writes -1 for infinity and 0 for zero (by period it would be WAMIT's other way round).
report("pyhams", len(panels), options.planes, times, limits[-1.0], conditions=len(limits), depth_m=depth)
