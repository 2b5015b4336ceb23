"""Writes one log in many formats, and `manifest.json`: what each file is, its sidecar, and what is expected of it.

The log has 50 rows: time in s, speed in m/s, and a drag in N that its file states aft, in gram-force where it is text.
"""

import datetime as d
import json
import struct
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import scipy.io

t = np.round(0.02 * np.arange(50), 6)
v = np.round(0.5 + 0.25 * np.sin(3 * t), 6)
f = np.round(-2.25 * v * v, 6)
GF = 9.80665e-3
MANIFEST = []

OWN = '"time [s]" = { name = "time" }\n"speed [m/s]" = { name = "v_x" }\n"force [N]" = { name = "f_x" }\n'
PLAIN = 'time = { name = "time", unit = "s" }\nspeed = { name = "v_x", unit = "m/s" }\nforce = { name = "f_x", unit = "N" }\n'
WITH_TIME = 'time = { name = "time" }\nspeed = { name = "v_x", unit = "m/s" }\nforce = { name = "f_x", unit = "N" }\n'
GERMAN = 'Zeit = { name = "time" }\nGeschwindigkeit = { name = "v_x" }\nWiderstand = { name = "f_x", sign = -1 }\n'


def add(name, form, words, columns="", expect="read", says="", file=""):
    sidecar = "schema = 1\n" + (f"[file]\n{file}\n" if file else "") + (f"[columns]\n{columns}" if columns else "")
    MANIFEST.append(dict(file=name, format=form, words=words, sidecar=sidecar if columns or file else "", expect=expect, says=says))


def text(name, content, encoding="utf-8"):
    Path(name).write_bytes(content.encode(encoding))


def rows(separator, mark=".", columns=(t, v, f), digits=(2, 6, 6)):
    line = lambda row: separator.join(f"{x:.{k}f}".replace(".", mark) for x, k in zip(row, digits))
    return "\n".join(line(row) for row in zip(*columns)) + "\n"


# Text.
text("plain.csv", "time [s],speed [m/s],force [N]\n" + rows(","))
add("plain.csv", "CSV", "commas, units in the headers", OWN)
aft = (t, v, -f / GF)
head = "Zeit;Geschwindigkeit;Widerstand\ns;m/s;gf\n"
text("german.csv", "\ufeff" + head.replace("\n", "\r\n") + rows(";", ",", aft).replace("\n", "\r\n"))
add("german.csv", "CSV", "semicolons, decimal comma, a row of units, byte order mark", GERMAN)
text("latin.csv", head.replace("Zeit", "Messzeit für β".replace("β", "a")) + rows(";", ",", aft), "cp1252")
add("latin.csv", "CSV", "the same in windows-1252", GERMAN.replace("Zeit", '"Messzeit für a"', 1))
text("utf16.txt", "\ufeff" + head.replace(";", "\t") + rows("\t", ",", aft), "utf-16-le")
add("utf16.txt", "text", "tabs in UTF-16", GERMAN)
text("blanks.dat", "# run 7\n  time  speed  force\n  (s)  (m/s)  (N)\n" + rows("   "))
add("blanks.dat", "text", "blanks, a comment, two lines of heads", PLAIN.replace(', unit = "s"', "").replace(', unit = "m/s"', "").replace(', unit = "N"', ""))
text("asked.csv", "time [s];speed [m/s];force [N]\n0;1,250;-2\n1;1,500;-3\n")
add("asked.csv", "CSV", "1,250 with nothing that decides", OWN, "asked", "can be 1.250 or 1250")
text("sum.csv", "time [s],speed [m/s],force [N]\n" + rows(",") + "Mean,0.6,-1\n")
add("sum.csv", "CSV", "a row of means below the log", OWN, "asked", "leave_out")
text("nounit.csv", "time,speed,force\n" + rows(","))
add("nounit.csv", "CSV", "no units anywhere", "", "asked", "unit")
text("openfast.out", "\nPredictions were generated on 01-Jan-2026 by OpenFAST\n\n Description\n\nTime\tspeed\tforce\n(s)\t(m/s)\t(kN)\n" + rows("\t", ".", (t, v, f / 1e3), (4, 6, 9)))
add("openfast.out", "OpenFAST .out", "names and units in lines 6 and 7", 'Time = { name = "time" }\nspeed = { name = "v_x" }\nforce = { name = "f_x" }\n')
Path("binary.outb").write_bytes(struct.pack("<hii", 2, 3, 50) + bytes(400))
add("binary.outb", "OpenFAST .outb", "its binary output", "", "rejected", "OpenFAST")

# Workbooks.
frame = pd.DataFrame({"time [s]": t, "speed [m/s]": v, "force [N]": f})
frame.to_excel("plain.xlsx", index=False)
add("plain.xlsx", "Excel .xlsx", "one sheet", OWN)
with pd.ExcelWriter("sheets.xlsx") as book:
    pd.DataFrame({"who": ["me"]}).to_excel(book, sheet_name="Info", index=False)
    frame.to_excel(book, sheet_name="Run 7", index=False, startrow=3, startcol=1)
add("sheets.xlsx", "Excel .xlsx", "the second sheet, from B4", OWN, file='sheet = "Run 7"')
add("sheets.xlsx", "Excel .xlsx", "the same, without the name of the sheet", "", "asked", "sheet")
shown = pd.ExcelWriter("shown.xlsx", engine="openpyxl")
pd.DataFrame({"time [s]": t, "speed [m/s]": v, "force [N]": f / 1e3}).to_excel(shown, index=False)
for row in shown.book.active.iter_rows(min_row=2, min_col=3):
    row[0].number_format = '0.000000" kN"'
shown.close()
add("shown.xlsx", "Excel .xlsx", "a unit in the number format that is not that of the header", OWN, "rejected", "kN")
import xlwt

book = xlwt.Workbook()
sheet = book.add_sheet("Lauf")
for j, words in enumerate(["Zeit", "Geschwindigkeit", "Widerstand"]):
    sheet.write(0, j, words)
    sheet.write(1, j, ["s", "m/s", "gf"][j])
    for i, x in enumerate(aft[j]):
        sheet.write(i + 2, j, float(x))
book.save("german.xls")
add("german.xls", "Excel .xls", "a row of units", GERMAN)
frame.to_excel("plain.ods", index=False, engine="odf")
add("plain.ods", "OpenDocument .ods", "one sheet", OWN)

# MATLAB, HDF5, NumPy.
scipy.io.savemat("vectors.mat", dict(time=t, speed=v[:, None], force=f))
add("vectors.mat", "MAT 5", "vectors, a row and columns", PLAIN)
scipy.io.savemat("struct.mat", dict(run=dict(time=t, speed=v, force=f)), do_compression=True)
add("struct.mat", "MAT 5", "a structure, compressed", PLAIN)
with h5py.File("run73.mat", "w", userblock_size=512) as file:
    for name, values in dict(time=t, speed=v, force=f).items():
        file.create_dataset(name, data=values[None, :]).attrs["MATLAB_class"] = np.bytes_("double")
with open("run73.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM")
add("run73.mat", "MAT 7.3", "vectors", PLAIN)
with h5py.File("groups.h5", "w") as file:
    for name, values, unit in [("time", t, "s"), ("speed", v, "m/s"), ("force", f, "N")]:
        file.create_dataset(f"tank/{name}", data=values, compression="gzip", chunks=(16,)).attrs["units"] = unit
add("groups.h5", "HDF5", "a group, units in attributes, compressed", WITH_TIME.replace(', unit = "m/s"', "").replace(', unit = "N"', ""))
with h5py.File("packed.h5", "w") as file:
    for name, values in [("time", t), ("speed", v)]:
        file[name] = values
    file["force"] = np.round(f * 1000).astype("i2")
    file["force"].attrs["scale_factor"] = 0.001
add("packed.h5", "HDF5", "numbers packed by scale_factor", PLAIN, "rejected", "scale_factor")
np.savez("arrays.npz", time=t, force=f)
add("arrays.npz", "NumPy .npz", "arrays", "", "rejected", "NumPy")

# Parquet and Arrow.
stamps = pd.DataFrame({"time": pd.to_timedelta(t, unit="s"), "speed": v, "force": f})
stamps.to_parquet("durations.parquet")
add("durations.parquet", "Parquet", "durations in nanoseconds", PLAIN.replace('unit = "s"', 'unit = "ns"', 1))
frame.to_parquet("plain.parquet")
add("plain.parquet", "Parquet", "units in the names", OWN)
frame.to_feather("plain.feather")
add("plain.feather", "Feather", "Arrow's own file", "", "rejected", "Parquet")

# Loggers.
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

with TdmsWriter("run.tdms") as file:
    parts = [("time", t, "s"), ("speed", v, "m/s"), ("force", f, "N")]
    file.write_segment([RootObject({}), GroupObject("tank", {})] + [ChannelObject("tank", n, x, {"unit_string": u}) for n, x, u in parts])
add("run.tdms", "TDMS", "a group with units", PLAIN.replace(', unit = "s"', "").replace(', unit = "m/s"', "").replace(', unit = "N"', ""))
with TdmsWriter("waveform.tdms") as file:
    wave = {"wf_increment": 0.02, "wf_samples": 50, "wf_start_offset": 0.0}
    file.write_segment([ChannelObject("tank", n, x, {**wave, "unit_string": u}) for n, x, u in parts[1:]])
add("waveform.tdms", "TDMS", "waveforms: the time follows from their increment", WITH_TIME.replace(', unit = "m/s"', "").replace(', unit = "N"', ""))


def message(kind, body):
    return struct.pack("<HB", len(body), ord(kind)) + body


log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1_000_000) + message("B", bytes(40))
log += message("F", b"tank:uint64_t timestamp;double speed;double force;") + message("A", struct.pack("<BH", 0, 0) + b"tank")
for i in range(50):
    log += message("D", struct.pack("<HQdd", 0, 1_000_000 + 20_000 * i, v[i], f[i]))
Path("flight.ulg").write_bytes(log)
add("flight.ulg", "ULog", "one topic", WITH_TIME)
from mcap.writer import Writer

with open("json.mcap", "wb") as out:
    writer = Writer(out)
    writer.start()
    channel = writer.register_channel("/tank", "json", writer.register_schema("Tank", "jsonschema", b'{"type": "object"}'))
    for i in range(50):
        at = 1_700_000_000_000_000_000 + i * 20_000_000
        writer.add_message(channel, at, json.dumps({"speed": v[i], "force": f[i]}).encode(), at)
    writer.finish()
add("json.mcap", "MCAP", "JSON messages of another program", WITH_TIME)
from mcap_ros2.writer import Writer as Ros2

with open("ros2.mcap", "wb") as out:
    writer = Ros2(out)
    schema = writer.register_msgdef("tank/Load", "float64 speed\nfloat64 force")
    for i in range(50):
        at = 1_700_000_000_000_000_000 + i * 20_000_000
        writer.write_message("/load", schema, {"speed": float(v[i]), "force": float(f[i])}, at, at)
    writer.finish()
add("ros2.mcap", "MCAP", "ROS 2 messages", WITH_TIME)
import sqlite3

sqlite3.connect("bag.db3").executescript("create table topics(id integer); insert into topics values (1);")
add("bag.db3", "ROS 2 bag .db3", "an SQLite database", "", "rejected", "SQLite")
Path("dewesoft.dxd").write_bytes(b"DEWESOFT" + bytes(600))
add("dewesoft.dxd", "DEWESoft .dxd", "its binary log", "", "rejected", "Dewesoft")
Path("picture.csv").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(200))
add("picture.csv", "PNG", "a picture under the name of a table", "", "rejected", "PNG")

json.dump(dict(columns=dict(time=list(t), v_x=list(v), f_x=list(f)), files=MANIFEST), open("manifest.json", "w"))
