"""Trains of unequal masses and stiffnesses, in 120 digits: writes unequal.json.

Run: pip install gmpy2 numpy; python3 tests/reference/unequal.py        (about two minutes)
"""

import math
import os
import sys

import numpy as np

from chain import Chain, Scene, write

INF = float("inf")


def mixed(n, seed, spread_m, spread_k):
    """n masses and n - 1 stiffnesses, log-uniform over the given ratios."""
    rng = np.random.default_rng(seed)
    m = np.exp(np.log(spread_m) * (rng.random(n) - 0.5))
    k = np.exp(np.log(spread_k) * (rng.random(n - 1) - 0.5))
    return m.tolist(), k.tolist()


def transit(c):
    return sum(math.sqrt(0.5 * (c.mass[i] + c.mass[i + 1]) / c.stiffness[i]) for i in range(len(c.stiffness)))


def scenes():
    m, k = mixed(60, 1, 8.0, 3.0)
    for name, head, tail, source in [
        ("60 vehicles, held head, last coupler broken", True, False, 59),
        ("60 vehicles, free head, step on the first", False, False, 0),
        ("60 vehicles, held tail, step on the first", False, True, 0),
        ("60 vehicles, both ends held, step inside", True, True, 20),
    ]:
        c = Chain(m, k, head, tail)
        force = 0.8 if source == 59 else -0.8
        yield name, Scene(c, source, force, INF, 0.8, 1.0, 1.1, 4 * transit(c))
    c = Chain(m, k, True, False)
    yield "60 vehicles, pulse in the middle", Scene(c, 30, -0.9, 7.3, 0.3, 1.0, 0.7, 4 * transit(c))
    c = Chain(m, k, True, True)
    yield "60 vehicles, both ends held, pulse in the middle", Scene(c, 30, 1.1, 9.1, 0.2, 0.7, 0.6, 2 * transit(c))
    c = Chain(m, k, False, False)
    yield "60 vehicles, free, pulse in the middle", Scene(c, 31, -1.3, 5.5, 0.0, 0.6, 0.5, 2 * transit(c))

    c = Chain([2.0, 3.0], [5.0])
    yield "2 vehicles, free, pulse", Scene(c, 1, -1.5, 1.9, 0.1, 0.9, 0.4, 20.0)
    for source, force in [(2, 1.0), (1, -1.0), (0, 1.0)]:
        c = Chain([1.0, 1e6, 1.0], [1.0, 1.0])
        yield f"masses 1 : 1e6 : 1, step on vehicle {source + 1}", Scene(c, source, force, INF, 0.6, 1.0, 1.2, 40.0)
    c = Chain([1.0, 1e6, 1.0], [1.0, 1.0], True)
    yield "masses 1 : 1e6 : 1, held head, pulse", Scene(c, 2, 1.0, 3.0, 0.6, 1.0, 1.2, 3000.0)

    m, k = mixed(24, 2, 4.0, 1e8)
    k[3], k[9] = 1e-4, 1e4
    for name, head, tail, source, duration in [
        ("stiffness ratio 1e8, held head", True, False, 23, INF),
        ("stiffness ratio 1e8, free", False, False, 0, INF),
        ("stiffness ratio 1e8, both held, pulse", True, True, 12, 3.0),
    ]:
        c = Chain(m, k, head, tail)
        yield name, Scene(c, source, 0.7, duration, 0.7, 1.0, 1.0, 300.0)
    m, k = mixed(30, 3, 1e8, 2.0)
    c = Chain(m, k, True, False)
    yield "mass ratio 1e8, held head", Scene(c, 29, 0.7, INF, 0.7, 1.0, 1.0, 300.0)


if __name__ == "__main__":
    out = []
    for name, scene in scenes():
        h = scene.horizon
        out.append(scene.record(name, [0.013 * h, 0.21 * h, 0.5003 * h, h]))
        print(name, file=sys.stderr)
    write(os.path.join(os.path.dirname(__file__), "unequal.json"), out)
