//! Workbooks as openpyxl, XlsxWriter, xlwt and odfpy write them.
#![allow(clippy::unwrap_used, reason = "a test")]

mod python;

use std::path::Path;

use froude_foreign::sheet::{Cell, Region, Sheet, Workbook};
use python::python;
use tempfile::TempDir;

/// The workbooks of a script, run in a folder of its own.
fn written(script: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    python(folder.path(), script);
    folder
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

fn sheet(folder: &Path, name: &str, sheet: &str, range: Option<&str>) -> Result<Sheet, String> {
    let bytes = bytes(folder, name);
    let range = range.map(|range| range.parse::<Region>().unwrap());
    let mut book = Workbook::open(&bytes).map_err(|e| e.0)?;
    book.sheet(sheet, range).map_err(|e| e.0)
}

fn text(text: &str) -> Cell {
    Cell::Text(text.to_owned())
}

fn date(text: &str) -> Cell {
    Cell::Date(text.to_owned())
}

/// One table, written in three formats: merged heads, units, blank cells, dates, percent, a number as text, true.
const TABLE: &str = r#"
import datetime as d
TABLE = [
    ["Drift tests", None, None, None, None, None, None],
    [None] * 7,
    ["speed", "force", None, "time", "slip", "note", "ok"],
    ["m/s", "x", "y", None, "%", None, None],
    [0.5, -1.25, None, d.datetime(2024, 3, 1, 12, 30, 0, 250000), 0.12, "7.5", True],
    [1, 1e-9, 3.0, d.datetime(2024, 3, 2), 0.5, "tare & <zero>", False],
]
"#;

/// Rows of the table, from row 3 of the sheet.
fn table() -> Vec<Vec<Cell>> {
    let (empty, number) = (Cell::Empty, Cell::Number);
    let heads = [text("speed"), text("force"), empty.clone(), text("time"), text("slip"), text("note"), text("ok")];
    let units = [text("m/s"), text("x"), text("y"), empty.clone(), text("%"), empty.clone(), empty.clone()];
    let first = [
        number(0.5),
        number(-1.25),
        empty,
        date("2024-03-01T12:30:00.250"),
        Cell::Percent(0.12),
        text("7.5"),
        Cell::Bool(true),
    ];
    let note = text("tare & <zero>");
    let second =
        [number(1.0), number(1e-9), number(3.0), date("2024-03-02"), Cell::Percent(0.5), note, Cell::Bool(false)];
    [heads, units, first, second].map(Vec::from).into()
}

fn check_table(read: &Sheet) {
    assert_eq!((read.first_row, read.first_column), (1, 2));
    assert_eq!(read.rows[0][0], text("Drift tests"));
    assert_eq!(read.rows[2..], table());
    assert_eq!(read.head(2, 2), &text("force"));
    assert_eq!(read.cell_name(4, 1), "C5");
    assert_eq!(read.merged, ["C3:D3".parse().unwrap()]);
}

#[test]
fn an_xlsx_table_of_openpyxl_is_read_cell_by_cell() {
    let folder = written(&format!(
        r#"{TABLE}
import openpyxl
from openpyxl.chart import LineChart
book = openpyxl.Workbook()
sheet = book.active
sheet.title = "drift ü"
for i, row in enumerate(TABLE):
    for j, value in enumerate(row):
        cell = sheet.cell(i + 1, j + 2, value)
        if j == 4 and i > 3: cell.number_format = "0%"
        if j == 3 and value == d.datetime(2024, 3, 2): cell.number_format = "dd.mm.yyyy"
sheet.merge_cells("C3:D3")
# Formats without content, far below: they do not count.
sheet.cell(5000, 30).number_format = "0%"
book.create_sheet("old").sheet_state = "hidden"
book.create_chartsheet("plot").add_chart(LineChart())
book.defined_names["drift"] = openpyxl.workbook.defined_name.DefinedName("drift", attr_text="'drift ü'!$B$3:$H$6")
book.save("t.xlsx")
"#
    ));
    let bytes = bytes(folder.path(), "t.xlsx");
    let mut book = Workbook::open(&bytes).unwrap();
    let sheets: Vec<_> = book.sheets().iter().map(|sheet| (&*sheet.name, sheet.is_hidden)).collect();
    assert_eq!(sheets, [("drift ü", false), ("old", true)]);
    assert_eq!(book.defined_names(), [("drift".to_owned(), "'drift ü'!$B$3:$H$6".to_owned())]);
    check_table(&book.sheet("drift ü", None).unwrap());
    let part = book.sheet("drift ü", Some("C5:D7".parse().unwrap())).unwrap();
    assert_eq!((part.first_row, part.first_column), (5, 3));
    assert_eq!(part.rows, [[Cell::Number(-1.25), Cell::Empty], [Cell::Number(1e-9), Cell::Number(3.0)]]);
    assert!(book.sheet("old", None).unwrap().rows.is_empty());
    let error = book.sheet("plot", None).unwrap_err().0;
    assert_eq!(error, "has no sheet \"plot\"; its sheets are \"drift ü\", \"old\"");
}

#[test]
fn what_a_number_format_shows_is_not_lost() {
    let folder = written(
        r#"
import openpyxl, xlwt
sheet = (book := openpyxl.Workbook()).active
for i, form in enumerate(['0.0" kN"', "0.00", "0.0,"]):
    sheet.cell(1, i + 1, 1500.5).number_format = form
book.save("t.xlsx")
book = xlwt.Workbook()
sheet = book.add_sheet("Sheet")
for i, form in enumerate(['0.0" kN"', "0.00", "0.0,"]):
    sheet.write(0, i, 1500.5, xlwt.easyxf(num_format_str=form))
book.save("t.xls")
"#,
    );
    for (file, sheet) in [("t.xlsx", "Sheet"), ("t.xls", "Sheet")] {
        let bytes = bytes(folder.path(), file);
        let read = Workbook::open(&bytes).unwrap().sheet(sheet, None).unwrap();
        assert_eq!(
            read.rows,
            [[Cell::Shown(1500.5, "kN".to_owned()), Cell::Number(1500.5), text("1500.5 shown in thousands")]],
            "{file}"
        );
    }
}

#[test]
fn an_xls_table_of_xlwt_is_read_cell_by_cell() {
    let folder = written(&format!(
        r#"{TABLE}
import xlwt
book = xlwt.Workbook()
sheet = book.add_sheet("drift ü")
percent, stamp, day = (xlwt.easyxf(num_format_str=f) for f in ("0%", "yyyy-mm-dd hh:mm:ss.000", "dd.mm.yyyy"))
for i, row in enumerate(TABLE):
    for j, value in enumerate(row):
        if value is None or (i, j) == (2, 1): continue
        style = percent if j == 4 and i > 3 else stamp if j == 3 and i == 4 else day if j == 3 and i == 5 else None
        # xlwt drops what is below a second.
        if (i, j) == (4, 3): value = (value - d.datetime(1899, 12, 30)) / d.timedelta(days=1)
        sheet.write(i, j + 1, value, *([style] if style else []))
sheet.write_merge(2, 2, 2, 3, "force")
book.add_sheet("old").visibility = 1
book.save("t.xls")
"#
    ));
    let bytes = bytes(folder.path(), "t.xls");
    let mut book = Workbook::open(&bytes).unwrap();
    let sheets: Vec<_> = book.sheets().iter().map(|sheet| (&*sheet.name, sheet.is_hidden)).collect();
    assert_eq!(sheets, [("drift ü", false), ("old", true)]);
    check_table(&book.sheet("drift ü", None).unwrap());
}

/// Writes an `.ods` file with odfpy, as LibreOffice would: values in attributes, repeated cells.
const ODS: &str = r#"
from odf.opendocument import OpenDocumentSpreadsheet
from odf.table import Table, TableRow, TableCell, CoveredTableCell
from odf.style import Style, TableProperties
from odf.text import P, S
from odf.office import Annotation
import datetime as d
def cell(value, **more):
    if value is None: return TableCell(**more)
    kind, name, shown = {
        bool: ("boolean", "booleanvalue", str(value).lower()), str: ("string", None, value),
        d.datetime: ("date", "datevalue", value.isoformat(timespec="milliseconds") if type(value) is d.datetime and value.microsecond else str(value)[:10]),
    }.get(type(value), ("float", "value", repr(value)))
    kind = more.pop("kind", kind)
    out = TableCell(valuetype=kind, **({name: shown} if name else {}), **more)
    out.addElement(P(text=shown))
    return out
"#;

#[test]
fn an_ods_table_of_odfpy_is_read_cell_by_cell() {
    let folder = written(&format!(
        r#"{TABLE}{ODS}
book = OpenDocumentSpreadsheet()
hidden = Style(name="ta2", family="table")
hidden.addElement(TableProperties(display="false"))
book.automaticstyles.addElement(hidden)
sheet = Table(name="drift ü")
for i, row in enumerate(TABLE):
    line = TableRow()
    line.addElement(TableCell())
    for j, value in enumerate(row):
        if i == 2 and j == 2: line.addElement(CoveredTableCell())
        elif i == 2 and j == 1: line.addElement(cell(value, numbercolumnsspanned=2, numberrowsspanned=1))
        elif j == 4 and i > 3: line.addElement(cell(value, kind="percentage"))
        else: line.addElement(cell(value))
    line.addElement(TableCell(numbercolumnsrepeated=16376))
    sheet.addElement(line)
empty = TableRow(numberrowsrepeated=1048570)
empty.addElement(TableCell(numbercolumnsrepeated=16384))
sheet.addElement(empty)
book.spreadsheet.addElement(sheet)
book.spreadsheet.addElement(Table(name="old", stylename=hidden))
book.save("t.ods")
"#
    ));
    let bytes = bytes(folder.path(), "t.ods");
    let mut book = Workbook::open(&bytes).unwrap();
    let sheets: Vec<_> = book.sheets().iter().map(|sheet| (&*sheet.name, sheet.is_hidden)).collect();
    assert_eq!(sheets, [("drift ü", false), ("old", true)]);
    check_table(&book.sheet("drift ü", None).unwrap());
}

#[test]
fn ods_cells_keep_their_texts_errors_and_repeats() {
    let folder = written(&format!(
        r##"{ODS}
book = OpenDocumentSpreadsheet()
sheet = Table(name="s")
line = TableRow(numberrowsrepeated=2)
line.addElement(cell(2.5, numbercolumnsrepeated=2))
spaced = TableCell(valuetype="string")
paragraph = P(text="a")
paragraph.addElement(S(c=2))
paragraph.addText("b")
spaced.addElement(paragraph)
spaced.addElement(P(text="c"))
note = Annotation()
note.addElement(P(text="a remark"))
spaced.addElement(note)
from odf.draw import Frame, TextBox
frame, box = Frame(), TextBox()
box.addElement(P(text="a text box"))
frame.addElement(box)
spaced.addElement(frame)
line.addElement(spaced)
line.addElement(TableCell(valuetype="time", timevalue="PT00H01M30.5S"))
wrong = TableCell(valuetype="string", stringvalue="")
wrong.setAttrNS("urn:org:documentfoundation:names:experimental:calc:xmlns:calcext:1.0", "value-type", "error")
wrong.addElement(P(text="#DIV/0!"))
line.addElement(wrong)
line.addElement(TableCell(valuetype="float", value="4", formula="of:=[.A1]+1.5"))
sheet.addElement(line)
book.spreadsheet.addElement(sheet)
book.save("t.ods")
for name, attributes in {{
    "none": dict(formula="of:=[.A1]*2"),
    "link": dict(valuetype="float", value="4", formula="of:='file:///tmp/x.ods'#$Runs.A1"),
}}.items():
    book = OpenDocumentSpreadsheet()
    sheet = Table(name="s")
    line = TableRow()
    line.addElement(cell(1))
    line.addElement(TableCell(**attributes))
    sheet.addElement(line)
    book.spreadsheet.addElement(sheet)
    book.save(name + ".ods")
"##
    ));
    let read = sheet(folder.path(), "t.ods", "s", None).unwrap();
    let line = [
        Cell::Number(2.5),
        Cell::Number(2.5),
        text("a  b\nc"),
        date("PT00H01M30.5S"),
        Cell::Error("#DIV/0!".into()),
        Cell::Number(4.0),
    ];
    assert_eq!(read.rows, [line.to_vec(), line.to_vec()]);
    let error = sheet(folder.path(), "none.ods", "s", None).unwrap_err();
    assert_eq!(error, NO_VALUE.replace("CELL", "B1"));
    assert_eq!(sheet(folder.path(), "link.ods", "s", None).unwrap_err(), LINK.replace("CELL", "B1"));
    assert_eq!(sheet(folder.path(), "link.ods", "s", Some("A1:A9")).unwrap().rows, [[Cell::Number(1.0)]]);
}

const NO_VALUE: &str = "sheet \"s\": cell CELL is a formula that has not been computed; open the file in Excel or LibreOffice and save it there";
const LINK: &str = "sheet \"s\": cell CELL is a formula that reads another file, so its stored value may be old; replace the formula by \
                    its value (copy, then paste special, values) and save the file";

/// A formula with a stored value as Excel writes it: XlsxWriter asks Excel to compute all formulas again.
const COMPUTED: &str = r#"
import xlsxwriter, zipfile
def write(name, cells, is_computed=True, names=()):
    book = xlsxwriter.Workbook("raw.xlsx")
    for pair in names: book.define_name(*pair)
    sheet = book.add_worksheet("s")
    for place, formula, value in cells:
        sheet.write_formula(place, formula, None, value) if formula else sheet.write(place, value)
    book.close()
    with zipfile.ZipFile("raw.xlsx") as old, zipfile.ZipFile(name, "w", zipfile.ZIP_DEFLATED) as new:
        for part in old.namelist():
            text = old.read(part)
            # Excel marks the text "" of a formula as a text, XlsxWriter does not.
            text = text.replace(b'<c r="B1"><f>IF', b'<c r="B1" t="str"><f>IF')
            new.writestr(part, text.replace(b' fullCalcOnLoad="1"', b"") if is_computed else text)
"#;

#[test]
fn a_formula_counts_as_its_stored_value_and_none_without_one() {
    let folder = written(&format!(
        r##"{COMPUTED}
cells = [("A1", "=1+1", 2), ("B1", '=IF(1,"","x")', ""), ("C1", "=1/0", "#DIV/0!"), ("D1", '="ab"', "ab"), ("E1", None, 5)]
write("computed.xlsx", cells)
write("stale.xlsx", cells, False)
write("link.xlsx", [("A1", None, 1), ("B2", "='C:\\tank\\[runs.xlsx]Sheet1'!$A$1", 3)])
names = [("tare", "='C:\tank\[runs.xlsx]Sheet1'!$A$1"), ("gain", "=s!$A$1")]
write("named.xlsx", [("A1", None, 1), ("B1", "=2*gain", 2), ("B3", "=2*Tare", 3)], names=names)
import openpyxl, xlwt
book = openpyxl.Workbook()
book.active.title = "s"
book.active["B3"] = "=1+1"
book.save("none.xlsx")
book = xlwt.Workbook()
sheet = book.add_sheet("s")
sheet.write(0, 0, 1.5)
book.add_sheet("other").write(0, 0, 2)
sheet.write(1, 0, xlwt.Formula("other!A1*2"))
book.save("inner.xls")
raw = open("inner.xls", "rb").read()
at = raw.index(b"\xae\x01\x04\x00")
open("link.xls", "wb").write(raw[:at + 6] + b"\x00\x00" + raw[at + 8:])
open("password.xls", "wb").write(raw[:532] + b"\x2f\x00" + raw[534:])
"##
    ));
    let read = sheet(folder.path(), "computed.xlsx", "s", None).unwrap();
    let line = [Cell::Number(2.0), Cell::Empty, Cell::Error("#DIV/0!".into()), text("ab"), Cell::Number(5.0)];
    assert_eq!(read.rows, [line]);
    let error = |name: &str| sheet(folder.path(), name, "s", None).unwrap_err();
    assert_eq!(error("none.xlsx"), NO_VALUE.replace("CELL", "B3"));
    assert_eq!(error("stale.xlsx"), NO_VALUE.replace("CELL", "A1"));
    assert_eq!(error("link.xlsx"), LINK.replace("CELL", "B2"));
    assert_eq!(error("named.xlsx"), LINK.replace("CELL", "B3"));
    assert_eq!(sheet(folder.path(), "named.xlsx", "s", Some("A1:B2")).unwrap().rows[0], [1.0, 2.0].map(Cell::Number));
    assert_eq!(error("link.xls"), LINK.replace("CELL", "A2"));
    // xlwt stores 0 for a formula, as a computed value; nothing in the file tells it from one.
    assert_eq!(sheet(folder.path(), "inner.xls", "s", None).unwrap().rows[0], [Cell::Number(1.5)]);
    let password = "the workbook is protected by a password; open it in Excel, remove the password";
    assert!(error("password.xls").starts_with(password), "{}", error("password.xls"));
}

#[test]
fn a_workbook_with_a_password_is_rejected_with_the_way_to_remove_it() {
    let folder = written(
        r#"
import openpyxl, msoffcrypto
book = openpyxl.Workbook()
book.save("t.xlsx")
from msoffcrypto.format.ooxml import OOXMLFile
with open("t.xlsx", "rb") as plain, open("locked.xlsx", "wb") as locked:
    OOXMLFile(plain).encrypt("secret", locked)
import zipfile
with zipfile.ZipFile("locked.ods", "w") as book:
    book.writestr("content.xml", b"encrypted")
    book.writestr("META-INF/manifest.xml", """<manifest:manifest xmlns:manifest="urn:oasis:names:tc:opendocument:xmlns:manifest:1.0">
        <manifest:file-entry manifest:full-path="content.xml"><manifest:encryption-data/></manifest:file-entry></manifest:manifest>""")
"#,
    );
    let error = sheet(folder.path(), "locked.xlsx", "s", None).unwrap_err();
    assert_eq!(
        error,
        "the workbook is protected by a password; open it in Excel, remove the password (File, Info, Protect Workbook, Encrypt with \
         Password) and save it"
    );
    let error = sheet(folder.path(), "locked.ods", "s", None).unwrap_err();
    assert!(error.starts_with("the workbook is protected by a password; open it in LibreOffice"), "{error}");
}

#[test]
fn a_file_that_would_fill_the_memory_is_rejected_before_it_does() {
    let folder = written(&format!(
        r#"{COMPUTED}{ODS}
import struct
write("far.xlsx", [("A1", None, 1), ("XFD1048576", None, 2)])
write("t.xlsx", [("A1", None, "text")])
with zipfile.ZipFile("t.xlsx") as old:
    parts = {{part: old.read(part) for part in old.namelist()}}
def pack(name, **changed):
    with zipfile.ZipFile(name, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as new:
        for part, text in parts.items():
            new.writestr(part, changed.get(part.split("/")[-1].split(".")[0], text))
pack("texts.xlsx", sharedStrings=b" " * (257 << 20))
pack("count.xlsx", sharedStrings=parts["xl/sharedStrings.xml"].replace(b'uniqueCount="1"', b'uniqueCount="99999999999"'))
# A part that unpacks to more than it states, and one that states more than is read.
raw = open("t.xlsx", "rb").read()
size = len(parts["xl/worksheets/sheet1.xml"])
def stated(name, size_stated):
    out = raw
    at = 0
    while (at := out.find(struct.pack("<I", size), at)) >= 0:
        out = out[:at] + struct.pack("<I", size_stated) + out[at + 4:]
        at += 4
    open(name, "wb").write(out)
stated("more.xlsx", size - 1)
stated("huge.xlsx", 3 << 30)
import xlwt
book = xlwt.Workbook()
sheet = book.add_sheet("s")
sheet.write(0, 0, 1)
sheet.write(65535, 255, 2)
book.save("far.xls")
book = OpenDocumentSpreadsheet()
sheet = Table(name="s")
line = TableRow(numberrowsrepeated=1048576)
line.addElement(cell(1.5, numbercolumnsrepeated=16384))
sheet.addElement(line)
book.spreadsheet.addElement(sheet)
book.save("far.ods")
"#
    ));
    let error = |name: &str| sheet(folder.path(), name, "s", None).unwrap_err();
    let far = "sheet \"s\": with cell XFD1048576 the cells with content span A1:XFD1048576, more than the limit of 50 million; name the \
               range that holds the table, as in B3:H40";
    assert_eq!(error("far.xlsx"), far);
    assert_eq!(sheet(folder.path(), "far.xlsx", "s", Some("A1:B9")).unwrap().rows, [[Cell::Number(1.0)]]);
    assert_eq!(
        error("far.xls"),
        "2 cells with content of a sheet are spread over A1:IV65536; delete what lies far from the tables, or save the workbook as .xlsx"
    );
    assert!(error("far.ods").contains("more than the limit of 50 million"), "{}", error("far.ods"));
    assert_eq!(
        error("texts.xlsx"),
        "\"xl/sharedStrings.xml\" in it unpacks to 257 MiB, 257 MiB in all; at most 256 MiB of this part and 2048 MiB in all are read; \
         save the sheet that is needed as CSV"
    );
    assert!(error("count.xlsx").contains("it announces more texts than it has bytes"), "{}", error("count.xlsx"));
    assert!(
        error("more.xlsx").contains("File is larger than its declared uncompressed size"),
        "{}",
        error("more.xlsx")
    );
    assert!(error("huge.xlsx").contains("unpacks to 3072 MiB"), "{}", error("huge.xlsx"));
}

#[test]
fn what_is_no_workbook_is_said_to_be_none() {
    let of = |bytes: &[u8]| Workbook::open(bytes).err().unwrap().0;
    assert!(of(b"speed;force\n1;2\n").starts_with("is not a workbook: .xlsx and .ods begin as zip files do"));
    assert!(of(b"").starts_with("is not a workbook"));
    assert!(of(b"PK\x03\x04 and no more").starts_with("begins as a zip file does"));
    let folder = written(
        r#"
import zipfile
for name, part in [("b.xlsb", "xl/workbook.bin"), ("z.zip", "readme.md")]:
    zipfile.ZipFile(name, "w").writestr(part, "x")
"#,
    );
    assert!(of(&bytes(folder.path(), "b.xlsb")).starts_with("is a binary workbook (.xlsb), which is not read"));
    assert!(of(&bytes(folder.path(), "z.zip")).starts_with("is a zip file without a workbook"));
    let mut ole = vec![0xD0, 0xCF, 0x11, 0xE0, 0xA1, 0xB1, 0x1A, 0xE1];
    assert!(of(&ole).contains("its table of sectors is damaged"));
    ole.resize(4096, 0xFF);
    assert!(of(&ole).contains("its table of sectors is damaged"));
}

#[test]
fn random_sheets_read_as_their_writers_read_them() {
    // Place, kind and content of each cell; numbers as bits.
    let folder = written(
        r#"
import json, random, string, struct, datetime as d, openpyxl, xlwt
random.seed(46)
LETTERS = string.printable.replace("\x0b", "").replace("\x0c", "").replace("\r", "") + "äß€Ω漢字😀\u00a0"
def content():
    kind = random.choice("nnnnitbd")
    # openpyxl writes 16 digits, of which a number may need 17.
    if kind == "n": return float("%.14g" % (random.gauss(0, 1) * 10 ** random.randint(-12, 12)))
    if kind == "i": return random.randint(-10**9, 10**9)
    if kind == "b": return random.random() < 0.5
    if kind == "d": return d.datetime(1901, 1, 1) + d.timedelta(seconds=random.randint(0, 6 * 10**9))
    text = "".join(random.choice(LETTERS) for _ in range(random.randint(1, 30)))
    return text.lstrip("=") or "x"
def expected(value):
    if isinstance(value, bool): return ["b", value]
    if isinstance(value, (int, float)): return ["n", struct.unpack("<Q", struct.pack("<d", value))[0]]
    if isinstance(value, d.datetime): return ["d", value.isoformat() if value.time() != d.time() else value.date().isoformat()]
    return ["t", value]
out = []
for i in range(20):
    places = {(random.randint(1, 60) + random.choice([0, 0, 0, 3000]), random.randint(1, 40)): content() for _ in range(150)}
    book, old = openpyxl.Workbook(), xlwt.Workbook()
    old_sheet, stamp = old.add_sheet("Sheet"), xlwt.easyxf(num_format_str="yyyy-mm-dd hh:mm:ss")
    for (row, column), value in places.items():
        book.active.cell(row, column).value = value
        old_sheet.write(row - 1, column - 1, value, *([stamp] if isinstance(value, d.datetime) else []))
    book.save(f"{i}.xlsx")
    old.save(f"{i}.xls")
    out.append([[*place, *expected(value)] for place, value in places.items()])
json.dump(out, open("expected.json", "w"))
"#,
    );
    let expected: Vec<Vec<(usize, usize, String, serde_json::Value)>> =
        serde_json::from_slice(&bytes(folder.path(), "expected.json")).unwrap();
    for (i, cells) in expected.iter().enumerate() {
        for ending in ["xlsx", "xls"] {
            let read = sheet(folder.path(), &format!("{i}.{ending}"), "Sheet", None).unwrap();
            for (row, column, kind, content) in cells {
                let found = &read.rows[row - read.first_row][column - read.first_column];
                let expected = match (&**kind, content) {
                    ("b", is) => Cell::Bool(is.as_bool().unwrap()),
                    ("n", bits) => Cell::Number(f64::from_bits(bits.as_u64().unwrap())),
                    ("d", day) => date(day.as_str().unwrap()),
                    (_, letters) => text(letters.as_str().unwrap()),
                };
                assert_eq!(*found, expected, "{i}.{ending}, row {row}, column {column}");
            }
            let n_found = read.rows.iter().flatten().filter(|cell| **cell != Cell::Empty).count();
            assert_eq!(n_found, cells.len(), "{i}.{ending}");
        }
    }
}

#[test]
fn a_chain_of_empty_sectors_in_an_old_workbook_ends() {
    let bytes = include_bytes!("../../../fuzz/seeds/workbook/chain-of-empty-sectors.xls");
    let Err(error) = Workbook::open(&bytes[..]) else { panic!("the stream of the workbook is damaged") };
    assert_eq!(
        error.0,
        "the workbook is damaged: its stream \"Workbook\" cannot be read; open it in Excel or LibreOffice and save it again"
    );
}

#[test]
fn a_list_of_sectors_that_leads_to_itself_is_refused() {
    let bytes = include_bytes!("../../../fuzz/seeds/workbook/fat-list-that-leads-to-itself.xls");
    let Err(error) = Workbook::open(&bytes[..]) else { panic!("the table of sectors is damaged") };
    assert!(error.0.contains("its table of sectors is damaged"), "{}", error.0);
}
