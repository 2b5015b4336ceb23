"""Intervals to expect of a rotation, by dense covariance matrices: the parent of the figures in tests/suite/rotation.rs and in the validation.

Nine runs of five periods of a sine, 100 Hz, three amplitudes at three angular frequencies; torque noise of 1 mN m correlated as exp(-t / 0.5 s); a zero for each
run; rig and delay known. Needs NumPy; last run with 2.4.6. Prints the relative standard uncertainties and r(lambda_2, lambda_3) of ordinary and of generalised
least squares.
"""

import numpy as np

LAMBDA = np.array([6.9096e-3, 2.0901e-3, 3.6777e-3])  # kg m2, N m s, N m s2
SIGMA_N_M, CORRELATION_S, RATE_HZ, PERIODS = 1e-3, 0.5, 100.0, 5

gram, noise, whitened = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
for amplitude in np.radians([30.0, 45.0, 60.0]):
    for omega in np.radians([60.0, 70.0, 80.0]):
        t = np.arange(round(PERIODS * 2 * np.pi / omega * RATE_HZ)) / RATE_HZ
        rate = amplitude * omega * np.cos(omega * t)
        x = -np.column_stack([-amplitude * omega**2 * np.sin(omega * t), rate, rate * np.abs(rate)])
        covariance = SIGMA_N_M**2 * np.exp(-np.abs(t[:, None] - t[None, :]) / CORRELATION_S)
        free = x - x.mean(axis=0)
        gram += free.T @ free
        noise += free.T @ covariance @ free
        solved = np.linalg.solve(covariance, np.column_stack([x, np.ones_like(t)]))
        whole = np.column_stack([x, np.ones_like(t)]).T @ solved
        whitened += whole[:3, :3] - np.outer(whole[:3, 3], whole[3, :3]) / whole[3, 3]

inverse = np.linalg.inv(gram)
for name, c in [("ordinary", inverse @ noise @ inverse), ("generalised", np.linalg.inv(whitened))]:
    standard = np.sqrt(np.diag(c))
    print(name, *(f"{u:.6f}" for u in standard / LAMBDA), f"{c[1, 2] / (standard[1] * standard[2]):.4f}")
