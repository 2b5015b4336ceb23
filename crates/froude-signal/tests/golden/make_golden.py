"""Writes scipy.txt: what scipy makes of one record. Run with numpy 2.4.6 and scipy 1.17.1:

    python make_golden.py > scipy.txt

A line is a name and its numbers, each with all its digits. The seed is 5.
"""
import numpy as np
import scipy
from scipy import signal

print("# numpy", np.__version__, "scipy", scipy.__version__, "seed 5")


def line(name, values):
    print(name, *(repr(float(v)) for v in np.ravel(values)))


rng = np.random.default_rng(5)
t = np.arange(700) / 1000.0
x = np.sin(2 * np.pi * 3 * t) + 0.2 * np.sin(2 * np.pi * 140 * t + 1) + 0.05 * rng.normal(size=700) + 0.3 * t
line("record", x)
for order, corner in ((1, 100.0), (2, 30.0), (4, 100.0), (5, 60.0)):
    sos = signal.butter(order, corner, fs=1000.0, output="sos")
    line(f"sosfiltfilt_{order}", signal.sosfiltfilt(sos, x))
b, a = signal.butter(4, 100.0, fs=1000.0)
line("filtfilt_4", signal.filtfilt(b, a, x))
line("gradient", np.gradient(x, 1e-3))
line("decimate_10", signal.decimate(x, 10, ftype="fir", zero_phase=True))
line("decimate_7", signal.decimate(x, 7, ftype="fir", zero_phase=True))
y = signal.lfilter([0.2, 0.1], [1, -0.7], x) + 0.02 * rng.normal(size=700)
line("output", y)
f, pxx = signal.welch(x, fs=1000.0, nperseg=128)
_, pyy = signal.welch(y, fs=1000.0, nperseg=128)
line("welch_x", pxx)
line("welch_y", pyy)
from scipy import interpolate, optimize

# Times of another clock: an offset, a skew of 7 ms/s, and some that lie unevenly.
late = 0.0123 + (t[5:-20] - 0.35) * (1 + 0.007) + 0.35 + 2e-4 * np.sin(40 * t[5:-20])
line("late", late)
line("cubic_spline", interpolate.CubicSpline(t, x)(late))
uneven = t + 3e-4 * np.sin(200 * t)
line("uneven", uneven)
line("cubic_spline_uneven", interpolate.CubicSpline(uneven, x)(t[3:-3]))


def harmonics(p):
    w = 2 * np.pi * p[0]
    return p[1] + sum(p[2 * k] * np.cos(k * w * (t - 0.3495)) + p[2 * k + 1] * np.sin(k * w * (t - 0.3495)) for k in (1, 2)) - x


found = optimize.least_squares(harmonics, [3, 0, 1, 0, 0, 0], xtol=1e-15, ftol=1e-15, gtol=1e-15)
line("harmonics_2", found.x)

# Ends and corners of the recursive filters: a record hardly longer than its extension, a low corner, and a high order.
line("short", x[:40])
for name, order, corner, record in (("short", 8, 200.0, x[:40]), ("low", 4, 5.0, x), ("high", 8, 60.0, x)):
    line(f"sosfiltfilt_{name}", signal.sosfiltfilt(signal.butter(order, corner, fs=1000.0, output="sos"), record))

# Harmonics of a frequency that is known: linear least squares, with the covariance of independent residuals.
tau = t - 0.3495
A = np.stack([np.ones(700)] + [f(k * 2 * np.pi * 3 * tau) for k in (1, 2, 3) for f in (np.cos, np.sin)], 1)
p, squares, *_ = np.linalg.lstsq(A, x, rcond=None)
line("held", p)
line("held_covariance", squares[0] / (700 - 7) * np.linalg.inv(A.T @ A))

# Two channels of one motion, the second 20 ms ahead at 2 s and by 7 ms more each second: leads of windows of four periods, and their line.
w, late_time = 2 * np.pi * 1.7, np.arange(1200) / 200.0


def motion(s):
    return 0.2 + np.sin(w * s) + 0.1 * np.cos(2 * w * s)


first = motion(late_time) + 1e-3 * np.sin(731 * late_time)
second = 0.86 * motion(late_time + 0.02 + 7e-3 * (late_time - 2.0)) + 1e-3 * np.cos(613 * late_time)
line("skew_first", first)
line("skew_second", second)
middles, leads, gains = [], [], []
start, period = late_time[0], 2 * np.pi / w
while start + 4 * period <= late_time[-1]:
    rows = (late_time >= start) & (late_time < start + 4 * period)
    s = late_time[rows]
    m = 0.5 * (s[0] + s[-1])
    B = np.stack([np.ones(len(s))] + [f(k * w * (s - m)) for k in (1, 2, 3) for f in (np.cos, np.sin)], 1)
    a, b = (np.linalg.lstsq(B, c[rows], rcond=None)[0] for c in (first, second))
    middles.append(m)
    leads.append((np.arctan2(a[2], a[1]) - np.arctan2(b[2], b[1])) / w)
    gains.append(np.hypot(b[1], b[2]) / np.hypot(a[1], a[2]))
    start = late_time[0] + len(leads) * period
leads = np.unwrap(np.array(leads) * w) / w
skew, offset = np.polyfit(np.array(middles) - np.mean(middles), leads, 1)
line("skew_found", [np.mean(middles), offset, skew, np.sort(gains)[len(gains) // 2]])
