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
