"""Writes one small file of each format, with most of what its reader distinguishes."""
import datetime as d

TABLE = [
    ["speed", "force", None, "time", "slip"],
    ["m/s", "x", "y", None, "%"],
    [0.5, -1.25, None, d.datetime(2024, 3, 1, 12, 30), 0.12],
    [1, 1e-9, 3.0, d.datetime(2024, 3, 2), 0.5],
    [True, "7.5", "a & b", d.datetime(2024, 3, 3), "#x"],
]

import openpyxl

book = openpyxl.Workbook()
sheet = book.active
for row in TABLE:
    sheet.append(row)
sheet.merge_cells("B1:C1")
sheet["E3"].number_format = "0%"
book.create_sheet("hidden").sheet_state = "hidden"
book.save("t.xlsx")

import xlwt

book = xlwt.Workbook()
sheet = book.add_sheet("drift")
day, percent = (xlwt.easyxf(num_format_str=f) for f in ("dd.mm.yyyy", "0%"))
for i, row in enumerate(TABLE):
    for j, value in enumerate(row):
        if value is not None:
            sheet.write(i, j, value, *([day] if j == 3 and i > 1 else [percent] if j == 4 else []))
book.add_sheet("other").write_merge(0, 0, 0, 2, "force")
sheet.write(9, 0, xlwt.Formula("other!A1*SUM(A1:B2)"))
book.save("t.xls")

from odf.opendocument import OpenDocumentSpreadsheet
from odf.table import Table, TableCell, TableRow
from odf.text import P

book = OpenDocumentSpreadsheet()
sheet = Table(name="drift")
for row in TABLE:
    line = TableRow(numberrowsrepeated=2)
    for value in row:
        cell = TableCell()
        if isinstance(value, float):
            cell = TableCell(valuetype="float", value=value, numbercolumnsrepeated=2)
        elif isinstance(value, str):
            cell = TableCell(valuetype="string", numbercolumnsspanned=2, numberrowsspanned=1)
            cell.addElement(P(text=value))
        elif isinstance(value, d.datetime):
            cell = TableCell(valuetype="date", datevalue=value.isoformat())
        line.addElement(cell)
    sheet.addElement(line)
book.spreadsheet.addElement(sheet)
book.save("t.ods")

import h5py
import numpy as np
import scipy.io
import scipy.sparse

t = np.arange(5) / 4
many = {
    "t": t, "force": np.stack([t, -t], axis=1), "n": np.arange(5), "note": np.array(["dry", "wet", "wet", "tow", "dry"]),
    "run": {"time": t[:3], "tank": {"rho": 998.0}}, "runs": np.array([(0.5, "a"), (1.5, "b")], [("u", "O"), ("s", "O")]),
    "z": t + 1j, "s": scipy.sparse.csc_matrix([[0.0, 1.0]]), "cells": np.array(["a", "bc"], object),
}
scipy.io.savemat("t.mat", many, do_compression=False)
scipy.io.savemat("packed.mat", many, do_compression=True)

for name, more in {"old.h5": {}, "new.h5": {"libver": "latest"}}.items():
    with h5py.File(name, "w", **more) as file:
        run = file.create_group("tank/run")
        run["time"] = t
        run["time"].attrs["units"] = "s"
        run.create_dataset("force", data=np.stack([t, -t], axis=1), chunks=(4, 1), compression="gzip", shuffle=True)
        run["note"] = ["dry", "wet", "wet", "tow", "dry"]
        run["fixed"] = np.array([b"a", b"bc", b"", b"d", b"e"])
        file["records"] = np.array([(1, (0.5, 1.5), b"dry")], [("n", ">u2"), ("load", "f4", (2,)), ("name", "S4")])
with h5py.File("matlab.h5", "w", userblock_size=512) as file:
    refs = file.create_group("#refs#")
    refs["c"] = np.array([[97], [98]], "u2")
    refs["c"].attrs["MATLAB_class"] = np.bytes_("char")
    file["cells"] = np.array([[refs["c"].ref] * 3], h5py.ref_dtype)
    file["cells"].attrs["MATLAB_class"] = np.bytes_("cell")
    file["t"] = t[None, :]
    file["t"].attrs["MATLAB_class"] = np.bytes_("double")
with open("matlab.h5", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
