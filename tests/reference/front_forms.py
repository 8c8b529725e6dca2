"""Polynomials of src/solve/fronts/forms.rs, and a check of its bound on fourth derivatives.

    python3 tests/reference/front_forms.py

Needs mpmath, numpy and scipy. With y = (x - nu) / (x + nu), |y| <= 0.3, and phi, zeta, A and B of DLMF 10.20 it prints

    ZETA = zeta / y,  PHI = phi nu / x,  A0 = (1 - phi^3 / 2) / zeta,  B0 = -(phi^3 / 2) B_0 - d A0 / d zeta,  J1 = B_0(zeta)

as powers of y with the size of what the fit leaves out, ARCTAN = arctan(u) / u as powers of u^2 <= 1, and then the largest ratio of
|d^4 P / dt^4| to sqrt(2 / pi) 16 nu w^(5/2) / x^4, w^2 = max(x^2 - nu^2, 0) + 4 nu^(4/3), x at least nu, on a grid of orders and instants.
"""
import mpmath as mp
import numpy as np
from scipy.special import jv

mp.mp.dps = 50
HALF = mp.mpf(3) / 2
WIDTH = mp.mpf("0.30")
NODES = 40


def zeta(z):
    """zeta of the uniform expansion, z = x / nu."""
    root = mp.sqrt(abs(1 - z * z))
    if z < 1:
        return (HALF * (mp.log((1 + root) / z) - root)) ** (mp.mpf(2) / 3)
    return -((HALF * (root - mp.acos(1 / z))) ** (mp.mpf(2) / 3))


def phi(z):
    return (4 * zeta(z) / (1 - z * z)) ** mp.mpf("0.25")


def olver_b0(z):
    """B_0(zeta), DLMF 10.20.12 for k = 0."""
    p, root = 1 / mp.sqrt(mp.mpc(1 - z * z)), mp.sqrt(mp.mpc(zeta(z)))
    u1 = (3 * p - 5 * p**3) / 24
    return mp.re(-(u1 + HALF / (zeta(z) * root) * mp.mpf(5) / 72) / root)


def a0(z):
    return (1 - phi(z) ** 3 / 2) / zeta(z)


def b0(z):
    slope = -(1 / z) * mp.sqrt((1 - z * z) / zeta(z))
    return -(phi(z) ** 3) / 2 * olver_b0(z) - mp.diff(a0, z, h=mp.mpf(10) ** -14) / slope


def fit(function, degree, middle=mp.mpf(0), width=WIDTH):
    """Powers of y of the Chebyshev sum up to a degree, and the sum of the other coefficients' sizes."""
    at = [mp.cos(mp.pi * (2 * k + 1) / (2 * NODES)) for k in range(NODES)]
    values = [function((1 + y) / (1 - y), y) for y in (middle + width * c for c in at)]
    term = lambda j, k: values[k] * mp.cos(mp.pi * j * (2 * k + 1) / (2 * NODES))
    chebyshev = [2 * sum(term(j, k) for k in range(NODES)) / NODES for j in range(NODES)]
    chebyshev[0] /= 2
    basis = [[mp.mpf(1)], [-middle / width, 1 / width]]
    for _ in range(2, degree + 1):
        following = [mp.mpf(0)] + [2 / width * c for c in basis[-1]]
        for power, c in enumerate(basis[-1]):
            following[power] -= 2 * middle / width * c
        for power, c in enumerate(basis[-2]):
            following[power] -= c
        basis.append(following)
    powers = [mp.mpf(0)] * (degree + 1)
    for c, polynomial in zip(chebyshev, basis):
        for power, p in enumerate(polynomial):
            powers[power] += c * p
    left_out = sum(abs(c) for c in chebyshev[degree + 1 :])
    return [float(p) for p in powers], float(left_out)


def roughness(nu):
    """Largest ratio of the fourth derivative in time to its bound."""
    root = nu ** (1 / 3)
    x = np.concatenate(
        [np.linspace(max(0.0, nu - 6 * root), nu + 40 * root, 4000), np.geomspace(nu + 40 * root, 20 * nu + 200, 8000)]
    )
    third = lambda n: jv(n - 3, x) - 3 * jv(n - 1, x) + 3 * jv(n + 1, x) - jv(n + 3, x)
    w = np.sqrt(np.maximum(x * x - nu * nu, 0) + 4 * nu ** (4 / 3))
    at = np.maximum(x, nu)
    return (abs(third(nu - 1) + third(nu + 1)) / (np.sqrt(2 / np.pi) * 16 * nu * w**2.5 / at**4)).max()


if __name__ == "__main__":
    for name, function, degree in [
        ("ZETA", lambda z, y: zeta(z) / y, 11),
        ("PHI", lambda z, y: phi(z) / z, 8),
        ("A0", lambda z, y: a0(z), 6),
        ("B0", lambda z, y: b0(z), 4),
        ("J1", lambda z, y: olver_b0(z), 4),
    ]:
        powers, left_out = fit(function, degree)
        print(name, powers, f"leaves out {left_out:.1e}")
    half = mp.mpf("0.5")
    powers, left_out = fit(lambda z, y: mp.atan(mp.sqrt(y)) / mp.sqrt(y), 15, half, half)
    print("ARCTAN", powers, f"leaves out {left_out:.1e}")
    for nu in [2, 4, 6, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 20000]:
        print(nu, f"{roughness(nu):.4f}")
