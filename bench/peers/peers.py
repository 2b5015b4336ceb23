"""The other side: what a careful user of numpy, scipy, polars or pandas would write.

    peers.py CASE DIR       one line of JSON; threads by OMP_NUM_THREADS and the like

The problem lies in DIR, written by `peer-bench make`. Each case is the fastest correct way
found with these libraries; where one is both slower and more exact (gelsy), it stands for
accuracy. Imports, reading of the problem and one warm-up call are outside the timing.
"""
import json
import os
import resource
import statistics
import sys
import time

import numpy as np


def peak_mib():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def raw(folder, rows=None):
    names = ("u", "v", "theta", "w", "y")
    return [np.fromfile(os.path.join(folder, name + ".f64"), count=-1 if rows is None else rows) for name in names]


def regressors(u, v, theta, w):
    return np.stack([u, u * np.abs(u), v, v * np.abs(v), w, w * np.abs(w), theta, v * np.abs(u), u * np.abs(v),
                     np.ones(len(u))], 1)


def gram(X, y):
    import scipy.linalg as sl
    return sl.cho_solve(sl.cho_factor(X.T @ X), X.T @ y)


def gelsy(X, y):
    import scipy.linalg as sl
    return sl.lstsq(X, y, lapack_driver="gelsy", check_finite=False)[0]


def nnls_on_gram(X, y):
    import scipy.linalg as sl
    from scipy.optimize import nnls
    L = sl.cholesky(X.T @ X, lower=True)
    return nnls(L.T, sl.solve_triangular(L, X.T @ y, lower=True))[0]


def bootstrap(X, y, resamples=10_000, batch=500):
    """Resampling as integer weights: all Gram matrices by one product of counts with products of columns."""
    rng = np.random.default_rng(1)
    n, p = X.shape
    Z = np.concatenate([X, y[:, None]], 1)
    i, j = np.triu_indices(p + 1)
    products = Z[:, i] * Z[:, j]
    shift = np.arange(batch)[:, None] * n
    out = np.empty((resamples, p))
    for start in range(0, resamples, batch):
        drawn = rng.integers(0, n, (batch, n), dtype=np.int32) + shift
        counts = np.bincount(drawn.ravel(), minlength=batch * n).reshape(batch, n)
        G = np.zeros((batch, p + 1, p + 1))
        G[:, i, j] = counts.astype(float) @ products
        G[:, j, i] = G[:, i, j]
        out[start:start + batch] = np.linalg.solve(G[:, :p, :p], G[:, :p, p:])[..., 0]
    return out.std(0, ddof=1)


def force_regressors(vx, vy, theta, omega):
    c, s = np.cos(theta), np.sin(theta)
    u, v = c * vx + s * vy, c * vy - s * vx
    return np.stack([u, u * np.abs(u), v, v * np.abs(v), omega, omega * np.abs(omega), v * np.abs(u), u * np.abs(v)], 1)


def csv(path, reader):
    columns = ["t", "fx", "fy", "vx", "vy", "theta", "omega"]
    if reader == "polars":
        import polars as pl
        frame = pl.read_csv(path)
    elif reader == "pyarrow":
        import pyarrow.csv as pc
        frame = pc.read_csv(path, read_options=pc.ReadOptions(use_threads=os.environ["OMP_NUM_THREADS"] != "1"))
    else:
        import pandas as pd
        frame = pd.read_csv(path)
    t, fx, fy, vx, vy, theta, omega = (frame[c].to_numpy() for c in columns)
    X = force_regressors(vx, vy, theta, omega)
    b = np.linalg.solve(X.T @ X, X.T @ np.stack([fx, fy], 1))
    return np.concatenate([b[:, 0], b[:, 1]])


def main(case, folder):
    runs = 5
    if case.startswith("csv-"):
        reader = case.removeprefix("csv-")
        __import__({"polars": "polars", "pyarrow": "pyarrow.csv", "pandas": "pandas"}[reader])
        call, runs = (lambda: csv(os.path.join(folder, "record.csv"), reader)), 3
    elif case == "bootstrap":
        *x, y = raw(folder, 1000)
        X = regressors(*x)
        call, runs = (lambda: bootstrap(X, y)), 7
    elif case.startswith("features"):
        *x, y = raw(folder)
        call = lambda: gram(regressors(*x), y)  # noqa: E731
    else:
        *x, y = raw(folder)
        X = regressors(*x)
        del x
        solve = {"gram": gram, "gelsy": gelsy, "nnls-on-gram": nnls_on_gram}[case]
        call = lambda: solve(X, y)  # noqa: E731
    before = peak_mib()
    values = call()
    wall, cpu = [], []
    for _ in range(runs):
        t, c = time.perf_counter(), time.process_time()
        values = call()
        wall.append(time.perf_counter() - t)
        cpu.append(time.process_time() - c)
    print(json.dumps({
        "tool": "peer", "case": case, "threads": int(os.environ.get("OMP_NUM_THREADS", "0")), "wall_s": min(wall),
        "wall_median_s": statistics.median(wall), "cpu_s": min(cpu), "extra_mib": round(peak_mib() - before, 1),
        "values": [float(v) for v in values]}))


if __name__ == "__main__":
    main(*sys.argv[1:])
