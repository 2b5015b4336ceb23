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

for name, more in {"old.h5": {}, "new.h5": {"libver": ("v110", "v110")}}.items():
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

# Files below 4 kB, for the fuzz targets: the least that a workbook needs.
import struct
import zipfile

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
RELATION = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"
with zipfile.ZipFile("small.xlsx", "w", zipfile.ZIP_DEFLATED) as book:
    for name, text in {
        "_rels/.rels": f'<Relationships xmlns="{PACKAGE}"><Relationship Id="r1" Type="{RELATION}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{RELATION}"><sheets><sheet name="drift" sheetId="1" r:id="r1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{PACKAGE}"><Relationship Id="r1" Type="{RELATION}/worksheet" Target="worksheets/s.xml"/></Relationships>',
        "xl/sharedStrings.xml": f'<sst xmlns="{MAIN}" uniqueCount="2"><si><t>speed</t></si><si><r><t>for</t></r><r><t>ce</t></r></si></sst>',
        "xl/styles.xml": f'<styleSheet xmlns="{MAIN}"><cellXfs><xf numFmtId="0"/><xf numFmtId="14"/><xf numFmtId="9"/></cellXfs></styleSheet>',
        "xl/worksheets/s.xml": f'<worksheet xmlns="{MAIN}"><sheetData><row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c></row>'
        '<row r="2"><c r="A2"><v>0.5</v></c><c r="B2" s="2"><v>0.12</v></c><c r="C2" s="1"><v>45352</v></c><c r="D2"><f>A2*2</f><v>1</v></c></row>'
        '</sheetData><mergeCells><mergeCell ref="B1:C1"/></mergeCells></worksheet>',
    }.items():
        book.writestr(name, text)

with zipfile.ZipFile("small.ods", "w", zipfile.ZIP_DEFLATED) as book:
    names = " ".join(f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"' for name in ("office", "table", "text", "style"))
    book.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
    book.writestr(
        "content.xml",
        f'<office:document-content {names}><office:body><office:spreadsheet><table:table table:name="drift"><table:table-row table:number-rows-repeated="2">'
        '<table:table-cell office:value-type="string" table:number-columns-spanned="2"><text:p>speed<text:s/>&amp;</text:p></table:table-cell>'
        '<table:covered-table-cell/><table:table-cell office:value-type="float" office:value="0.5" table:number-columns-repeated="2"/>'
        '<table:table-cell office:value-type="date" office:date-value="2024-03-01"/></table:table-row></table:table></office:spreadsheet></office:body></office:document-content>',
    )


def record(kind, content):
    return struct.pack("<HH", kind, len(content)) + content


bof = lambda kind: record(0x0809, struct.pack("<HHHHII", 0x0600, kind, 0, 0, 0, 0))
formats = b"".join(record(0x00E0, struct.pack("<HH16x", 0, format)) for format in (0, 9, 14))
sst = record(0x00FC, struct.pack("<II", 1, 1) + struct.pack("<HB", 5, 0) + b"speed")
head = bof(5) + formats
sheet_entry = lambda at: record(0x0085, struct.pack("<IBBBB", at, 0, 0, 5, 0) + b"drift")
at = len(head + sheet_entry(0) + sst + record(0x000A, b""))
cells = record(0x0200, struct.pack("<IIHHH", 0, 2, 0, 4, 0))
cells += record(0x00FD, struct.pack("<HHHI", 0, 0, 0, 0)) + record(0x0203, struct.pack("<HHHd", 1, 0, 0, 0.5))
cells += record(0x0203, struct.pack("<HHHd", 1, 1, 1, 0.12)) + record(0x027E, struct.pack("<HHHI", 1, 2, 2, 45352 << 2 | 2))
cells += record(0x0006, struct.pack("<HHHdHIH", 1, 3, 0, 1.0, 0, 0, 7) + b"\x1e\x02\x00\x1e\x01\x00\x04")
cells += record(0x00E5, struct.pack("<HHHHH", 1, 0, 0, 0, 1))
stream = head + sheet_entry(at) + sst + record(0x000A, b"") + bof(16) + cells + record(0x000A, b"")
n_mini = -(-len(stream) // 64)
n_sectors = -(-n_mini * 64 // 512)
END, FREE, FAT = 0xFFFFFFFE, 0xFFFFFFFF, 0xFFFFFFFD
chain = lambda first, n: [*range(first + 1, first + n), END]
# Sectors: the table of sectors, the directory, the table of mini sectors, the mini stream.
fat = [FAT, END, END, *chain(3, n_sectors)]
header = bytes.fromhex("d0cf11e0a1b11ae1") + bytes(16) + struct.pack("<HHHHH6x9I", 0x3E, 3, 0xFFFE, 9, 6, 0, 1, 1, 0, 4096, 2, 1, END, 0)
header += struct.pack("<109I", 0, *[FREE] * 108)


def entry(name, kind, child, start, size):
    letters = (name + "\0").encode("utf-16-le")
    return letters.ljust(64, b"\0") + struct.pack("<HBBIII36xIQ", len(letters), kind, 1, FREE, FREE, child, start, size)


def padded(numbers):
    return struct.pack("<128I", *(numbers + [FREE] * 128)[:128])


directory = entry("Root Entry", 5, 1, 3, n_mini * 64) + entry("Workbook", 2, FREE, 0, len(stream))
body = padded(fat) + directory.ljust(512, b"\0") + padded(chain(0, n_mini)) + stream.ljust(n_sectors * 512, b"\0")
with open("small.xls", "wb") as file:
    file.write(header + body)
small = {"t": t, "run": {"n": np.arange(3), "note": "dry"}, "z": 1j}
scipy.io.savemat("small.mat", small, do_compression=False)
scipy.io.savemat("small-packed.mat", small, do_compression=True)

for name, oldest in {"small-old.h5": h5py.h5f.LIBVER_EARLIEST, "small.h5": h5py.h5f.LIBVER_V110}.items():
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_libver_bounds(oldest, h5py.h5f.LIBVER_V110)
    access.set_meta_block_size(0)
    compact = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    compact.set_layout(h5py.h5d.COMPACT)
    with h5py.File(h5py.h5f.create(name.encode(), fapl=access)) as file:
        file.create_dataset("force", data=t, dcpl=compact).attrs["units"] = np.bytes_("N")
        file.create_dataset("records", data=np.array([(1, b"dry")], [("n", "u2"), ("text", "S3")]), dcpl=compact)
        file.create_group("run").create_dataset("n", data=np.arange(3), dcpl=compact)
