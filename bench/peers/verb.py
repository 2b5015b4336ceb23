"""The verb on a long table, from the file to the report, beside polars and numpy, from the file to coefficients.

    verb.py FROUDE DIR [--threads N] [--rounds N]

`DIR/record.csv` is that of `peer-bench make` (10^7 rows, 652 MB); its Parquet twin is written beside it. Both sides fit a linear and
a quadratic term to each of two forces; Froude also fits the quadratic law, chooses, propagates, looks for what is doubtful and
writes record, figures and report. Times are of the whole process, the best of all rounds.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

SIDECAR = """schema = 1
[columns]
t = { name = "time", unit = "s" }
fx = { name = "f_x", unit = "N", sign = -1 }
fy = { name = "f_y", unit = "N", sign = -1 }
vx = { name = "v_x", unit = "m/s" }
vy = { name = "v_y", unit = "m/s" }
theta = { name = "heading", unit = "rad" }
omega = { name = "w_z", unit = "rad/s" }
"""
PEER = """
import sys, numpy as np, polars as pl
d = (pl.read_csv if sys.argv[1].endswith("csv") else pl.read_parquet)(sys.argv[1])
for f, v in (("fx", "vx"), ("fy", "vy")):
    f, v = d[f].to_numpy(), d[v].to_numpy()
    X = np.stack([v, v * np.abs(v)], 1)
    print(*np.linalg.solve(X.T @ X, X.T @ f))
"""
NAMES = ("D_x_I", "D_x_II", "D_y_I", "D_y_II")


def run(command, threads):
    """Output, wall and processor time in s and largest memory in MiB of a process."""
    names = ("OMP", "OPENBLAS", "RAYON")
    env = dict(os.environ, POLARS_MAX_THREADS=str(threads), **{f"{n}_NUM_THREADS": str(threads) for n in names})
    cpus = ",".join(map(str, sorted(os.sched_getaffinity(0))[:threads]))
    timed = ["/usr/bin/time", "-f", "%e %U %S %M", "taskset", "-c", cpus]
    done = subprocess.run(timed + command, env=env, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
    wall, user, system, kib = map(float, done.stderr.splitlines()[-1].split())
    return done.stdout, wall, user + system, kib / 1024


def froude(program, path, threads):
    with tempfile.TemporaryDirectory() as folder:
        laws = "quadratic,linear_quadratic"
        command = [program, "identify", path, "--models", laws, "--json", "--out", os.path.join(folder, "results")]
        out, *cost = run(command, threads)
    best = next(e for e in json.loads(out)["estimates"] if e["recommended"])
    return [best["coefficients"][name]["value"] for name in NAMES], cost


def peer(path, threads):
    out, *cost = run([sys.executable, "-c", PEER, path], threads)
    return [float(x) for x in out.split()], cost


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=3)
    a = parser.parse_args()
    csv, parquet = (os.path.join(a.folder, "record." + ending) for ending in ("csv", "parquet"))
    with open(os.path.join(a.folder, "record.toml"), "w") as sidecar:
        sidecar.write(SIDECAR)
    if not os.path.exists(parquet):
        import polars as pl
        pl.scan_csv(csv).sink_parquet(parquet + ".part")
        shutil.move(parquet + ".part", parquet)
    print(f"{a.threads} thread(s), load {os.getloadavg()[0]:.1f}; wall and processor time in s, memory in MiB")
    for path in (csv, parquet):
        sides = {"froude identify": lambda: froude(a.program, path, a.threads), "polars + numpy": lambda: peer(path, a.threads)}
        runs = {name: [side() for _ in range(a.rounds)] for name, side in sides.items()}
        values = [runs[name][0][0] for name in sides]
        apart = max(abs(x - y) for x, y in zip(*values)) / max(map(abs, values[1]))
        for name, found in runs.items():
            wall, cpu, memory = (min(cost[k] for _, cost in found) for k in range(3))
            print(f"{os.path.basename(path):<15} {name:<16} {wall:7.2f} {cpu:7.2f} {memory:7.0f}")
        print(f"{'':<15} differ by {apart:.0e}", flush=True)


if __name__ == "__main__":
    main()
