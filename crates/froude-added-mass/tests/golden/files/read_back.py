"""Reads the files of this folder with xarray and Capytaine and compares them with each other.

The files are those that `tests/files.rs` writes and compares bit by bit. Two bodies, elements that differ in
every place, so that a transposed or shifted matrix shows.

    pip install capytaine==3.0.0 scipy==1.17.1 netcdf4==1.7.5.1.post1 && python read_back.py
"""
import pathlib
import tempfile

import capytaine as cpt
import numpy as np
import xarray as xr
from capytaine.io.wamit import export_wamit_1

here = pathlib.Path(__file__).parent
DENSITY, LENGTH = 1025.0, 2.0
expected = np.array([[[1000.0 * (1 + limit) + 20.0 * i + j + 0.125 for j in range(12)] for i in range(12)] for limit in (0, 1)])
dofs = [f"{body}__{dof}" for body in ("head", "link 1") for dof in ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")]

for engine in ("scipy", "netcdf4"):
    ds = xr.open_dataset(here / "two_bodies.nc", engine=engine)
    assert ds.added_mass.dims == ("omega", "influenced_dof", "radiating_dof")
    assert (ds.added_mass.values == expected).all() and (ds.radiation_damping == 0).all()
    assert list(ds.influenced_dof.values) == dofs == list(ds.radiating_dof.values)
    assert list(ds.omega.values) == [0.0, np.inf] == list(ds.period.values[::-1])
    assert ds.rho == DENSITY and ds.g == 9.80665 and ds.water_depth == np.inf and ds.body_name.item() == "head+link 1"
    one = ds.added_mass.sel(omega=np.inf, influenced_dof="link 1__Sway", radiating_dof="head__Yaw").item()
    assert one == 2000.0 + 20 * 7 + 5 + 0.125
    # As Capytaine writes it, and back.
    with tempfile.TemporaryDirectory() as folder:
        cpt.export_dataset(f"{folder}/again.nc", ds)
        assert (xr.open_dataset(f"{folder}/again.nc").load().added_mass == ds.added_mass).all()
    ds.close()

k = lambda i, j: 3 + (i % 6 > 2) + (j % 6 > 2)
rows = np.loadtxt(here / "two_bodies.1")
for period, limit in ((-1.0, 0), (0.0, 1)):
    for _, i, j, bar in rows[rows[:, 0] == period]:
        i, j = int(i) - 1, int(j) - 1
        assert abs(bar * DENSITY * LENGTH ** k(i, j) / expected[limit, i, j] - 1) < 1e-15

# Capytaine's own WAMIT writer takes one body. It writes I as the motion and J as the force: transposed.
ds = xr.open_dataset(here / "one_body.nc").load()
with tempfile.TemporaryDirectory() as folder:
    export_wamit_1(ds, f"{folder}/one_body.1", length_scale=LENGTH)
    theirs = np.loadtxt(f"{folder}/one_body.1")
ours = np.loadtxt(here / "one_body.1")
assert (np.unique(theirs[:, 0]) == np.unique(ours[:, 0])).all()
table = {(p, int(i), int(j)): bar for p, i, j, bar in ours}
for p, motion, force, bar in theirs:
    assert abs(table[p, int(force), int(motion)] / bar - 1) < 1e-6, (p, force, motion)
print("read back as written")
