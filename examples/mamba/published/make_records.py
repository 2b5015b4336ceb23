"""Writes the published coefficient sets of the USR paper as estimate records.

Parent of the JSON files beside it: reads drag_coefficients_tables5_8_9.csv, writes one record per source, and
table10_as_printed.json / table11_as_printed.json with the rows exactly as the paper prints them (they contradict
Tables 5, 8 and 9, which `froude compare` finds). Published values carry no uncertainty: the fields are null.
Run: python3 make_records.py
"""
import csv
import json
import pathlib

HERE = pathlib.Path(__file__).parent
NAMES = ["C_f", "C_d", "C_f_I", "C_d_I", "C_f_II", "C_d_II", "C_fHT_I", "C_dHT_I", "C_fHT_II", "C_dHT_II", "C_XY_I", "C_XY_II"]
GEOMETRY = {
    "major_semi_axis": {"value": 0.0588, "unit": "m"},
    "minor_semi_axis": {"value": 0.0394, "unit": "m"},
    "half_length": {"value": 0.09, "unit": "m"},
    "head_side_area": {"value": 0.011, "unit": "m^2"},
    "tail_side_area": {"value": 0.008, "unit": "m^2"},
}
# Speeds and angles of Tables 2 and 3; the towing rig's are outcomes of three weights and not published.
VALIDITY = {
    "cfd": {"speed": (0.02, 1.0, "m/s"), "angle": (0.0, 1.5707963267948966, "rad")},
    "circulation_tank_restricted": {"speed": (0.1, 1.0, "m/s"), "angle": (0.0, 0.6806784082777885, "rad")},
    "circulation_tank_unrestricted": {"speed": (0.1, 1.0, "m/s"), "angle": (0.0, 1.5707963267948966, "rad")},
}


def unit(name):
    return "m/s" if name.endswith("_I") else "1"


def estimate(source, model, values, table):
    return {
        "id": f"{source}/{model}", "source": source, "kind": "published", "model": model,
        "law": {"version": 1, "constants": {"v_ref": {"value": 1.0, "unit": "m/s"}}},
        "geometry": GEOMETRY, "density": {"value": 1025.0, "unit": "kg/m^3"},
        "frame": "body axes, x forward, y to starboard, z down", "reference_point": "body centre",
        "method": f"published: USR paper, Table {table}. Geometry: stand-in of the example campaign, not published.",
        "covariance_kind": "none stated", "n_observations": 0,
        "coefficients": {n: {"value": v, "unit": unit(n), "status": "fixed", "standard_uncertainty": None} for n, v in values.items()},
        "covariance": None,
        "validity": {k: {"low": a, "high": b, "unit": u} for k, (a, b, u) in VALIDITY.get(source, {}).items()},
        "recommended": model == "f4",
    }


def write(name, estimates):
    record = {"schema": "froude/estimate/1", "data": [], "versions": {}, "estimates": estimates, "findings": []}
    (HERE / f"{name}.json").write_text(json.dumps(record, indent=2) + "\n")


rows = list(csv.DictReader(open(HERE / "drag_coefficients_tables5_8_9.csv")))
by_source = {}
for r in rows:
    values = {n: float(r[n]) for n in NAMES if r[n] != ""}
    by_source.setdefault(r["source"], []).append(estimate(r["source"], r["model"], values, r["paper_table"]))
for source, estimates in by_source.items():
    write(source, estimates)

PRINTED_10 = {
    "cfd": [0, 0.0191, 0.0066, 0.4064, 0.0063, 0.1956, 0.1050, 0, 0.0055, 0.1957],
    "towing_rig": [0.0152, 0, 0.0045, 1.5249, 0, 0.0795, 0.2498, 1.8852, 0.0870, 0.8704],
    "circulation_tank_unrestricted": [0, 0.0569, 0.0126, 1.2402, 0.0141, 0.1929, 0.2531, 1.4444, 0.0412, 0.6654],
    "circulation_tank_restricted": [0, 0, 0.0133, 1.4272, 0.0148, 0.1769, 0.2451, 1.1770, 0.0351, 0.4612],
}
ROWS_10 = ["C_f_I", "C_f_II", "C_d_I", "C_d_II", "C_fHT_I", "C_dHT_I", "C_fHT_II", "C_dHT_II", "C_XY_I", "C_XY_II"]
write("table10_as_printed", [estimate(s, "f4", dict(zip(ROWS_10, v)), "10 (as printed)") for s, v in PRINTED_10.items()])
PRINTED_11 = {"cfd": (0.0046, 0.1206), "towing_rig": (0.0242, 0.2813), "circulation_tank_unrestricted": (0.0167, 0.3835),
              "circulation_tank_restricted": (0.0207, 0.3628)}
write("table11_as_printed", [estimate(s, "f1", dict(zip(["C_f", "C_d"], v)), "11 (as printed)") for s, v in PRINTED_11.items()])
