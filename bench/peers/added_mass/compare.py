"""Our added mass beside Capytaine's and HAMS's on the same meshes, in the same run.

    python compare.py PROGRAM [--quick] [--json FILE]

PROGRAM is `target/release/examples/peer` of froude-panel. For each case our program writes its mesh, both sides solve it pinned to
one processor, matrices are compared before times are, and the case is judged by its bar. --quick leaves out what takes minutes.
Exits with 1 when a bar is missed.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
# Case, peers, bar in seconds and MiB (one thread; PERFORMANCE of the project), largest difference of the matrices that the two
# discretisations and Capytaine's point sources beyond seven radii (3e-4..1e-3) explain.
CASES = [
    ("spheroid-2000", ["capytaine_direct.py", "pyhams.py"], None, None),
    ("robot-8064", ["capytaine_direct.py"], 2.0, 600),
    ("spheroid-20000", ["capytaine_direct.py --planes xy"], 5.0, None),
    ("robot-20064", [], 5.0, None),
    ("spheroid-100000", [], 30.0, 3000),
    ("spectral-spheroid", [], 0.010, None),
    ("spectral-capsule", [], 0.030, None),
]
AGREE = 5e-3


def one_line(command, threads):
    """The last JSON line that a program prints; pinned to as many processors as it may use threads."""
    names = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]
    env = dict(os.environ, **{n: str(threads) for n in names})
    cpus = ",".join(str(c) for c in sorted(os.sched_getaffinity(0))[:threads])
    out = subprocess.run(["taskset", "-c", cpus, *command], env=env, cwd=HERE, capture_output=True, text=True)
    lines = [l for l in out.stdout.splitlines() if l.startswith("{")]
    if out.returncode or not lines:
        raise SystemExit(f"{' '.join(command)}: {out.stderr[-2000:]}")
    return json.loads(lines[-1])


def quarter(name):
    """Leaves of a mesh file the panels with positive x and y: a whole one of 20,000 panels takes 21 GB."""
    lines = open(name).read().splitlines()
    count = int(lines[0].split()[1])
    vertices = np.array([l.split() for l in lines[1:count + 1]], float)
    panels = np.array([l.split() for l in lines[count + 2:]], int)
    slack = 1e-9 * np.abs(vertices).max()
    kept = panels[(vertices[panels][:, :, :2] > -slack).all(axis=(1, 2))]
    with open(name, "w") as file:
        file.write("\n".join(lines[:count + 1] + [f"panels {len(kept)}"] + [" ".join(map(str, p)) for p in kept]) + "\n")


def apart(a, b):
    """Largest difference of two matrices, entry by entry over the roots of the diagonal."""
    size = np.sqrt(np.abs(np.diag(b)))
    size = np.maximum(size, 1e-3 * np.array([size[:3].max()] * 3 + [size[3:].max()] * 3))
    return float((np.abs(a - b) / np.outer(size, size)).max())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    rows, missed = [], False
    print(f"{'case':18} {'1 thread':>9} {'2 threads':>9} {'MiB':>6} {'peer':>10} {'time':>8} {'MiB':>6} {'ratio':>6} {'apart':>8}  bar")
    for case, peers, bar_s, bar_mib in CASES:
        rounds = 3 if bar_s is None or bar_s < 6 else 1
        ours = one_line([program, "--case", case, "--rounds", str(rounds)], 1)
        two = one_line([program, "--case", case, "--rounds", str(rounds)], 2)
        verdict = ""
        if bar_s:
            is_in = ours["seconds"] <= bar_s and (bar_mib is None or ours["peak_mib"] <= bar_mib)
            missed |= not is_in
            verdict = f"{bar_s} s" + (f", {bar_mib} MiB" if bar_mib else "") + ("" if is_in else "  MISSED")
        row = dict(case=case, ours=ours, two_threads=two, peers=[])
        head = f"{case:18} {ours['seconds']:9.4f} {two['seconds']:9.4f} {ours['peak_mib']:6.0f}"
        if not peers or options.quick:
            print(f"{head} {'':10} {'':8} {'':6} {'':6} {'':8}  {verdict}", flush=True)
        else:
            with tempfile.NamedTemporaryFile(suffix=".mesh") as mesh:
                subprocess.run([program, "--case", case, "--write-mesh", mesh.name], check=True)
                for peer in peers:
                    script, *more = peer.split()
                    if more:
                        quarter(mesh.name)
                    theirs = one_line([sys.executable, script, mesh.name, "--runs", "1", *more], 1)
                    seconds = theirs["seconds_min"] / (3 if "ham" in theirs["tool"] else 1)
                    far = apart(np.array(ours["matrix"]), np.array(theirs["added_mass_over_density"]))
                    missed |= far > AGREE
                    ratio = seconds / ours["seconds"]
                    print(f"{head} {theirs['tool']:>10} {seconds:8.3f} {theirs['peak_mib_over_base']:6.0f} {ratio:5.1f}x {far:8.1e}  {verdict}",
                          flush=True)
                    head, verdict = " " * len(head), ""
                    row["peers"].append(dict(theirs, ratio=ratio, apart=far))
        rows.append(row)
    if options.json:
        with open(options.json, "w") as file:
            json.dump(rows, file, indent=1)
    sys.exit(1 if missed else 0)


main()
