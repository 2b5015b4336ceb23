"""The other side: what a careful user of numpy and scipy would write.

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


def gelsy(X, y):
    import scipy.linalg as sl
    return sl.lstsq(X, y, lapack_driver="gelsy", check_finite=False)[0]




def shown(y):
    """The numbers of a filtered record that are compared: its ends and every 1009th."""
    return np.concatenate([y[:50], y[:-51:-1], y[::1009]])


def filtered(x):
    from scipy import signal
    sections = signal.butter(4, 10.0, fs=1000.0, output="sos")
    return lambda: shown(signal.sosfiltfilt(sections, x))


def shorter(x, n=1_000_000, rate_hz=1000.0):
    x = np.ascontiguousarray(x[:n])
    return np.arange(len(x)) / rate_hz, x


def harmonics(t, x):
    """Mean and three harmonics of 0.2 Hz about the middle of the record."""
    s = 2 * np.pi * 0.2 * (t - 0.5 * (t[0] + t[-1]))

    def solve():
        A = np.stack([np.ones(len(t))] + [f(k * s) for k in (1, 2, 3) for f in (np.cos, np.sin)], 1)
        return np.linalg.solve(A.T @ A, A.T @ x)
    return solve


def resampled(t, x):
    from scipy import interpolate
    at = np.arange(len(x) * 99 // 100) / 1000.0 * 1.007 + 0.3e-3
    at = at[at < t[-1]]
    return lambda: shown(interpolate.CubicSpline(t, x)(at))


def hour(path, rate_hz=10_000.0, factor=10, trim_s=0.2, lag_s=1.0):
    """Order 4 at 100 Hz, differences, parallel decimation, least squares, HAC by moving sums."""
    import scipy.linalg as sl
    from scipy import signal
    rows = np.fromfile(path).reshape(-1, 8)
    force = 6.0 * rows[:, 1]
    y = signal.sosfiltfilt(signal.butter(4, 100.0, fs=rate_hz, output="sos"), rows[:, 0])
    del rows
    v = np.gradient(y, 1 / rate_hz)
    a = np.gradient(v, 1 / rate_hz)
    trim = round(trim_s * rate_hz / factor)
    X = np.stack([signal.decimate(c, factor, ftype="fir")[trim:-trim] for c in (a, v, np.sign(v), np.ones(len(v)))], 1)
    f = signal.decimate(force, factor, ftype="fir")[trim:-trim]
    gram = sl.inv(X.T @ X)
    b = sl.lstsq(X, f, lapack_driver="gelsy", check_finite=False)[0]
    e = f - X @ b
    n, p = X.shape
    classical = np.sqrt(np.diag(gram) * (e @ e) / (n - p))
    # Bartlett's triangle is a box folded with itself: moving sums of the scores, at any lag.
    lag = round(lag_s * rate_hz / factor)
    total = np.cumsum(np.pad(X * e[:, None], ((lag + 1, lag), (0, 0))), 0)
    window = total[lag + 1:] - total[:-lag - 1]
    middle = window.T @ window / (lag + 1) * n / (n - p)
    return np.concatenate([b, classical, np.sqrt(np.diag(gram @ middle @ gram))])


def main(case, folder):
    runs = 5
    if case == "forward-backward":
        call = filtered(np.fromfile(os.path.join(folder, "u.f64")))
    elif case in ("harmonics", "resample"):
        t, x = shorter(np.fromfile(os.path.join(folder, "u.f64"), count=1_000_000))
        call = harmonics(t, x) if case == "harmonics" else resampled(t, x)
    elif case == "hour":
        import scipy.signal  # noqa: F401
        call, runs = (lambda: hour(os.path.join(folder, "hour.f64"))), 2
    else:
        *x, y = raw(folder)
        X = regressors(*x)
        del x
        call = lambda: gelsy(X, y)  # noqa: E731
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
