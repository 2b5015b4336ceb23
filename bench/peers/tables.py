"""Reads large tables with froude and with pandas, in turn: wall time and peak memory of each, as processes of their own.

    cargo build --release --bin froude
    cargo build --release --package froude-foreign --example sheet_alone
    target/oracles/bin/python bench/peers/tables.py target/release/froude

The workbook is also read by calamine alone, where its example lies beside the program.
"""

import os
import subprocess
import sys
import tempfile
import time

ROUNDS = 3
READERS = {
    "csv": "import pandas as pd; pd.read_csv('t.csv')",
    "german.csv": "import pandas as pd; pd.read_csv('t.german.csv', sep=';', decimal=',', encoding='cp1252', skiprows=[1])",
    "xlsx": "import pandas as pd; pd.read_excel('t.xlsx')",
    "xlsx, calamine alone": None,
    "parquet": "import pandas as pd; pd.read_parquet('t.parquet')",
    "mat": "import scipy.io; scipy.io.loadmat('t.mat')",
    "h5": "import h5py; f = h5py.File('t.h5'); [f[k][:] for k in f]",
    "tdms": "import nptdms; f = nptdms.TdmsFile.read('t.tdms'); [c[:] for g in f.groups() for c in g.channels()]",
}


def measured(command):
    """Wall time in s and peak memory in MB of a process."""
    started = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    told = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status:
        sys.exit(f"{' '.join(command)}: {told.decode()}")
    return time.perf_counter() - started, used.ru_maxrss / 1024


def write(rows, rows_of_sheet):
    import numpy as np
    import pandas as pd

    random = np.random.default_rng(1)
    names = {"time": "s", "v_x": "m/s", "v_y": "m/s", "f_x": "N", "f_y": "N", "m_z": "N m"}
    data = {name: np.round(random.normal(0, 10, rows), 6) for name in names}
    data["time"] = np.round(np.arange(rows) * 0.01, 2)
    frame = pd.DataFrame({f"{name} [{unit}]": data[name] for name, unit in names.items()})
    frame.to_csv("t.csv", index=False)
    with open("t.german.csv", "w", encoding="cp1252") as out:
        out.write(";".join(names) + "\n" + ";".join(names.values()) + "\n")
        frame.to_csv(out, sep=";", decimal=",", header=False, index=False)
    frame.to_parquet("t.parquet")
    with pd.ExcelWriter("t.xlsx", engine="xlsxwriter") as book:
        frame.head(rows_of_sheet).to_excel(book, index=False)
    import h5py
    import nptdms
    import scipy.io

    scipy.io.savemat("t.mat", data)
    with h5py.File("t.h5", "w") as out:
        for name, unit in names.items():
            out[name] = data[name]
            out[name].attrs["units"] = unit
    with nptdms.TdmsWriter("t.tdms") as out:
        out.write_segment([nptdms.ChannelObject("tank", n, data[n], {"unit_string": u}) for n, u in names.items()])
    columns = "".join(f'{name} = {{ name = "{name}", unit = "{unit}" }}\n' for name, unit in names.items())
    open("columns.toml", "w").write("schema = 1\n[columns]\n" + columns)


if sys.argv[1] == "--write":
    write(1_000_000, 200_000)
    sys.exit()

FROUDE = os.path.abspath(sys.argv[1])
CALAMINE = os.path.join(os.path.dirname(FROUDE), "examples", "sheet_alone")
SCRIPT = os.path.abspath(__file__)

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    # The peak of a child is at least that of the process that started it, so that this one stays small.
    subprocess.run([sys.executable, SCRIPT, "--write"], check=True)
    print("| file | froude convert to Parquet | peer | peer time / Froude time |\n| --- | --- | --- | --- |")
    for kind, script in READERS.items():
        file = f"t.{kind.split(',')[0]}"
        peer_command = [sys.executable, "-c", script] if script else [CALAMINE, file]
        if not os.path.exists(peer_command[0]):
            continue
        sidecar = ["--sidecar", "columns.toml"] if kind in ("mat", "german.csv") else []
        best = {}
        for k in range(ROUNDS):
            out = f"out-{k}.parquet"
            for who, command in [("ours", [FROUDE, "convert", file, out, *sidecar]), ("peer", peer_command)]:
                best[who] = min(best.get(who, (1e9, 0)), measured(command))
            os.remove(out)
        (ours, memory), (peer, of_peer) = best["ours"], best["peer"]
        size = os.path.getsize(file) / 1e6
        print(f"| {kind}, {size:.0f} MB | {ours:.2f} s, {memory:.0f} MB | {peer:.2f} s, {of_peer:.0f} MB | {peer / ours:.2f} |")
