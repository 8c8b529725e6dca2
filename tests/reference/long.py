"""Trains of 3,000 vehicles, a few springs of each, in 60 digits: writes long.json.

The equal train from (10) and (19), written out anew here; the unequal one from eigenvalues that bisection in double
precision brackets and Rayleigh quotient iteration sharpens, held to the same two facts as all decompositions in
chain.py (a pair missed or found twice would show there).

Run: pip install gmpy2 numpy; python3 tests/reference/long.py        (about ten minutes)
"""

import os
import sys

import gmpy2
import numpy as np
from gmpy2 import mpfr

from chain import Chain, Modes, Scene, Search, write
from unequal import INF, mixed, transit

BITS = 200
# A third of a radian of the fastest mode finds every swing of a train without stiff or light parts.
Search.STOP = 0.4
WATCHED = [0, 1, 749, 1500, 2500, 2997, 2998]


class Few:
    """Some springs of a chain, to a Scene that has its modes from elsewhere."""

    def __init__(self, static):
        self.k = self.stiffness = [0.0] * len(WATCHED)
        self.mass, self.held_head, self.held_tail = [], True, False
        self.bits, self.values = BITS, static

    def static(self, _source):
        return self.values


def equal(n):
    """Held head, n live unit masses, a unit forward force on the last: minus (19)'s terms, and minus its sum at t = 0."""
    pi = gmpy2.const_pi()
    omega, share = [], []
    for j in range(1, n + 1):
        beta = pi * (2 * j - 1) / (2 * n + 1)
        s, c = gmpy2.sin_cos(beta)
        size = 2 * (-1) ** j * s / ((2 * n + 1) * (1 - c))
        omega.append(2 * gmpy2.sin(beta / 2))
        share.append([size * gmpy2.cos(beta / 2 * (2 * i + 1)) for i in WATCHED])
    for row, i in enumerate(WATCHED):
        assert abs(sum(s[row] for s in share) + 1) < mpfr("1e-45"), i
    return Modes(omega, share)


def brackets(a, b2):
    """Eigenvalues in double precision, by bisection on all at once."""
    n = len(a)
    lo, hi = np.zeros(n), np.full(n, max(a) * 2.0)
    target = np.arange(n)
    for _ in range(60):
        x = 0.5 * (lo + hi)
        d = a[0] - x
        count = (d < 0).astype(int)
        for i in range(1, n):
            d = a[i] - x - b2[i - 1] / np.where(d == 0, 1e-300, d)
            count += d < 0
        hi, lo = np.where(count > target, x, hi), np.where(count > target, lo, x)
    return 0.5 * (lo + hi)


def unequal(chain, source):
    a, b2 = chain.matrix()
    springs = len(a)
    root = [gmpy2.sqrt(k) for k in chain.k]
    start = brackets(np.array([float(x) for x in a]), np.array([float(x) for x in b2]))
    rng = np.random.default_rng(2)
    omega, share, drive = [], [], []
    for x in start:
        lam = mpfr(float(x))
        v = [mpfr(float(y)) for y in rng.uniform(-1, 1, springs)]
        for _ in range(6):
            v = solve(a, b2, lam, v)
            norm = sum(y * y for y in v)
            # (A - lam) w = v0 with v0 of unit size: the Rayleigh quotient of w.
            change = quotient(a, b2, lam, v) / norm
            lam += change
            v = [y / gmpy2.sqrt(norm) for y in v]
            if abs(change) < mpfr("1e-45") * lam:
                break
        push = -root[source - 1] * chain.inv_mass[source] * v[source - 1] / lam
        omega.append(gmpy2.sqrt(lam))
        share.append([root[i] * v[i] * push for i in WATCHED])
        drive.append(lam)
    assert all(x < y for x, y in zip(omega, omega[1:]))
    static = chain.static(source)
    for row, i in enumerate(WATCHED):
        assert abs(sum(s[row] for s in share) - static[i]) < mpfr("1e-40"), i
        due = -chain.k[i] * chain.inv_mass[source] if i == source - 1 else 0
        assert abs(sum(s[row] * lam for s, lam in zip(share, drive)) - due) < mpfr("1e-40"), i
    return Modes(omega, share), [static[i] for i in WATCHED]


def solve(a, b2, lam, v):
    """One step of inverse iteration."""
    n = len(a)
    b = solve.b
    d, w = [a[0] - lam], list(v)
    for i in range(1, n):
        f = b[i - 1] / d[-1]
        d.append(a[i] - lam - b2[i - 1] / d[-1])
        w[i] = w[i] - f * w[i - 1]
    w[-1] = w[-1] / d[-1]
    for i in range(n - 2, -1, -1):
        w[i] = (w[i] - b[i] * w[i + 1]) / d[i]
    return w


def quotient(a, b2, lam, v):
    """v . (A - lam) v"""
    b = solve.b
    return sum((x - lam) * y * y for x, y in zip(a, v)) + 2 * sum(x * y * z for x, y, z in zip(b, v, v[1:]))


def record(name, chain, modes, static, force, initial, horizon):
    springs = len(chain.stiffness)
    scene = Scene(Few(static), springs, force, INF, [initial] * len(WATCHED), 1.0, 1.0, horizon)
    scene.modes = modes
    out = scene.record(name, [], springs=None)
    for row, entry in zip(WATCHED, out["springs"]):
        entry["spring"] = row
    out |= {"mass": chain.mass, "stiffness": chain.stiffness, "held_head": True, "held_tail": False}
    out |= {key: [out[key][0]] * springs for key in ("initial", "rated_draft", "rated_buff")}
    print(name, file=sys.stderr, flush=True)
    return out


if __name__ == "__main__":
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "long.json")
    chain = Chain([1.0] * 3000, [1.0] * 2999, True, bits=BITS)
    out = [record("3000 vehicles, equal", chain, equal(2999), [mpfr(-1)] * len(WATCHED), 1.0, 1.0, 12000.0)]
    write(path, out)
    m, k = mixed(3000, 21, 2.0, 1.5)
    # Few digits keep the file small; any double is as good as another.
    m, k = [round(x, 3) for x in m], [round(x, 3) for x in k]
    chain = Chain(m, k, True, bits=BITS)
    solve.b = [-gmpy2.sqrt(x) for x in chain.matrix()[1]]
    modes, static = unequal(chain, 2999)
    out.append(record("3000 vehicles, unequal", chain, modes, static, 0.8, 0.8, round(1.1 * transit(chain))))
    write(path, out)
