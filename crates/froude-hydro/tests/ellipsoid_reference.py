"""Added mass of ellipsoids to 17 digits: the rows of `REFERENCE` in `ellipsoid.rs`.

Lamb (1932), 114-115, as printed, with Carlson's R_D from mpmath 1.4 at 80 digits, so that the cancellation of
b^2 - c^2 costs nothing. Semi-axes are taken as the doubles that Rust reads.

    pip install mpmath==1.4.1 && python ellipsoid_reference.py
"""
from mpmath import elliprd, mp, mpf, nstr, pi

mp.dps = 80

BODIES = [
    (1.0, 1.0, 1.0), (3.0, 2.0, 1.0), (1.0, 2.0, 3.0), (2.0, 1.0, 3.0), (5.0, 1.0, 1.0), (1.0, 1.0, 5.0),
    (1.0, 1.0, 0.2), (1.0, 1.0, 1e-6), (1e-6, 1.0, 2.0), (1e6, 1.0, 2.0), (1e3, 1.0, 1e-3), (1.0, 1e-12, 1e-6), (0.09, 0.0394, 0.0588),
    (2.0, 1.0, 1.0 + 1e-8), (2.0, 1.0, 1.0 + 1e-3), (2.0, 1.0 + 1e-12, 1.0), (1.0, 1.0 + 1e-5, 1.0 - 1e-5),
    (1.0, 0.999, 1.001), (0.01, 1.0, 1.0 + 1e-6), (1e-50, 2e-50, 3e-50), (1e60, 2e59, 3e60),
]


def integral(own, other, another):
    """Lamb's alpha_0 of the axis `own`."""
    return 2 * own * other * another * elliprd(other**2, another**2, own**2) / 3


def turning(volume, b, c, beta, gamma):
    if b == c:
        return mpf(0)
    q = b**2 - c**2
    return volume / 5 * q**2 * (gamma - beta) / (2 * q + (b**2 + c**2) * (beta - gamma))


for axes in BODIES:
    a, b, c = map(mpf, axes)
    volume = 4 * pi / 3 * a * b * c
    alpha, beta, gamma = integral(a, b, c), integral(b, c, a), integral(c, a, b)
    assert abs(alpha + beta + gamma - 2) < mpf(10) ** -60
    values = [volume * k / (2 - k) for k in (alpha, beta, gamma)]
    values += [turning(volume, b, c, beta, gamma), turning(volume, c, a, gamma, alpha), turning(volume, a, b, alpha, beta)]
    print(f"    ({list(axes)}, [{', '.join(nstr(v, 17, min_fixed=0, max_fixed=0) for v in values)}]),")
