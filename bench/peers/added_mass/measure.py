"""Mesh files, timing and the line of results that the peers of this folder share.

A mesh file is plain text: a line `vertices N`, N lines `x y z` in metres, a line `panels M`, M lines of four vertex
numbers from 0; a triangle repeats its last one. Seen from the fluid the corners go anticlockwise: normals point into
the fluid. Lines that begin with # are passed over.
"""
import argparse
import importlib.metadata
import json
import os
import resource
import statistics
import time

import numpy as np


def arguments(description):
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", help="mesh file")
    parser.add_argument("--runs", type=int, default=5, help="timed runs, after one to warm up")
    parser.add_argument("--planes", default="", choices=["", "x", "y", "xy"],
                        help="the mesh is the part with positive x, y or both; planes of symmetry do the rest")
    return parser


def read_mesh(path):
    """(vertices, panels) as arrays of N x 3 and M x 4."""
    with open(path) as file:
        lines = [line.split() for line in file if line.strip() and not line.startswith("#")]

    def block(at, word, kind, width):
        if len(lines[at]) != 2 or lines[at][0] != word:
            raise SystemExit(f"{path}: `{word} N` expected, found `{' '.join(lines[at])}`")
        count = int(lines[at][1])
        rows = np.array(lines[at + 1:at + 1 + count], dtype=kind)
        if rows.shape != (count, width):
            raise SystemExit(f"{path}: {count} lines of {width} numbers expected after `{word} {count}`")
        return rows, at + 1 + count

    vertices, at = block(0, "vertices", float, 3)
    panels, at = block(at, "panels", int, 4)
    if panels.min() < 0 or panels.max() >= len(vertices) or at != len(lines):
        raise SystemExit(f"{path}: a panel names a vertex that is not there, or lines are left over")
    return vertices, panels


def peak_mib():
    """Most memory that this process has held, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def measured(work, runs):
    """(result, times): `work` once to warm up, then `runs` times by wall and by processor."""
    base = peak_mib()
    result = work()
    wall, cpu = [], []
    for _ in range(runs):
        result = None  # two results at once would count as memory
        start, busy = time.perf_counter(), time.process_time()
        result = work()
        wall.append(time.perf_counter() - start)
        cpu.append(time.process_time() - busy)
    times = dict(runs=runs, seconds_median=statistics.median(wall), seconds_min=min(wall),
                 cpu_seconds=statistics.median(cpu), peak_mib_over_base=round(peak_mib() - base, 1))
    return result, times


def report(tool, panels, planes, times, added_mass, **more):
    """One JSON line. `added_mass` is 6 x 6 about the origin over density, m^3, m^4, m^5; row force, column motion."""
    line = dict(tool=tool, version=importlib.metadata.version(tool), panels=int(panels), planes=planes,
                threads=os.environ.get("OMP_NUM_THREADS"), **times, **more,
                added_mass_over_density=np.asarray(added_mass, dtype=float).tolist())
    print(json.dumps(line), flush=True)
