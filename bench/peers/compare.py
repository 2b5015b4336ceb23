"""Both sides of every case in the same run, and the table.

    compare.py PEER_BENCH DIR [--threads 1 2] [--cases ...] [--json FILE]

One thread is pinned to one CPU. A case is repeated until told otherwise by `--rounds`, the sides
taking turns, and the best time of each side counts: other work on the machine makes times longer,
never shorter.
"""
import argparse
import json
import os
import platform
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))

# ours, peer, bar at one thread (times faster), what, name of the peer
CASES = [
    ("columns", "gelsy", 15.0, "10^7 x 10 from memory (QR)", "scipy lstsq gelsy"),
    ("forward-backward", "forward-backward", 1.7, "forward-backward, order 4", "scipy sosfiltfilt"),
    ("harmonics", "harmonics", None, "harmonic fit, 3 of 0.2 Hz, 10^6", "numpy Gram"),
    ("resample", "resample", None, "cubic spline, another clock, 10^6", "scipy CubicSpline"),
    ("hour", "hour", None, "axis, an hour of 10 kHz x 8", "numpy + scipy in memory"),
]


def run(command, threads):
    names = ("OMP", "OPENBLAS", "MKL", "RAYON", "ARROW")
    env = dict(os.environ, POLARS_MAX_THREADS=str(threads), **{f"{n}_NUM_THREADS": str(threads) for n in names})
    cpus = ",".join(map(str, sorted(os.sched_getaffinity(0))[:threads]))
    pinned = ["taskset", "-c", cpus] if threads < os.cpu_count() else []
    done = subprocess.run(pinned + command, env=env, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
    return json.loads(done.stdout)


def best(old, new):
    if old is None:
        return new
    return dict(new, **{k: min(old[k], new[k]) for k in ("wall_s", "wall_median_s", "cpu_s")})


def agreement(case, ours, peer):
    """Largest difference between the two sides' numbers, relative to the largest number."""
    a, b = ours["values"], peer["values"]
    return max(abs(x - y) for x, y in zip(a, b)) / max(map(abs, b))


def seconds(s):
    return f"{s * 1e3:7.1f} ms" if s < 10 else f"{s:7.2f} s "


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--cases", nargs="+")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--json")
    a = parser.parse_args()
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if "model name" in line), "?")
    print(f"{cpu}, {os.cpu_count()} CPUs, Python {platform.python_version()}, load {os.getloadavg()[0]:.2f}\n")
    head = ("case", "threads", "peer", "peer's time", "ours", "ratio", "by CPU", "bar", "MiB peer/ours", "differ by")
    form = "| {:<34} | {:>7} | {:<24} | {:>11} | {:>11} | {:>6} | {:>6} | {:>9} | {:>13} | {:>9} |"
    print(form.format(*head))
    print(form.format(*("-" * len(h) for h in head)))
    records, seen, missed = [], {}, 0
    for threads in a.threads:
        for ours, peer, bar, what, name in CASES:
            if a.cases and ours not in a.cases:
                continue
            mine, other = ("froude", ours, threads), ("peer", peer, threads)
            fresh = [key for key in (mine, other) if key not in seen]
            for _ in range(a.rounds if fresh else 0):
                for key in fresh:
                    command = ([a.program, ours, a.folder, str(threads)] if key[0] == "froude" else
                               [sys.executable, os.path.join(HERE, "peers.py"), peer, a.folder])
                    seen[key] = best(seen.get(key), run(command, threads))
            m, p = seen[mine], seen[other]
            ratio, by_cpu = p["wall_s"] / m["wall_s"], p["cpu_s"] / m["cpu_s"]
            verdict = "-" if bar is None or threads != 1 else f"{bar:g}x " + ("met" if ratio >= bar else "MISSED")
            missed += "MISSED" in verdict
            print(form.format(what, threads, name, seconds(p["wall_s"]), seconds(m["wall_s"]), f"{ratio:.1f}x",
                              f"{by_cpu:.1f}x", verdict, f"{p['extra_mib']:.0f} / {m['extra_mib']:.0f}",
                              f"{agreement(ours, m, p):.0e}"), flush=True)
            records.append({"what": what, "threads": threads, "bar": bar, "ratio": ratio, "ours": m, "peer": p})
    if a.json:
        with open(a.json, "w") as f:
            json.dump(records, f, indent=1)
    print("\nTimes are the best of all runs; CPU counts user and system time of all threads. 'Differ by' is the "
          "largest difference of the\ntwo sides' coefficients "
          "over the largest coefficient.")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
