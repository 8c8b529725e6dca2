"""Frequencies of graded trains to 40 digits, by Sturm bisection in 120 digits: writes frequencies.json.

Run: pip install gmpy2 numpy; python3 tests/reference/frequencies.py        (about two minutes)
"""

import os
import sys

import gmpy2

from chain import Chain, digits, write
from unequal import mixed


def chains():
    yield "mass ratio 1e12, alternating, 200", Chain([1.0, 1e-12] * 100, [1.0] * 199, True)
    yield "stiffness ratio 1e12, alternating, 200", Chain([1.0] * 200, ([1.0, 1e12] * 100)[:199], True)
    yield "both alternating, 100", Chain([1.0, 1e-12] * 50, ([1.0, 1e12] * 50)[:99], True)
    m, k = mixed(200, 11, 1e12, 1e12)
    yield "both ratios 1e12, random, 200, held head", Chain(m, k, True)
    yield "both ratios 1e12, random, 200, free", Chain(m, k)
    yield "both ratios 1e12, random, 200, both held", Chain(m, k, True, True)
    m, k = mixed(120, 12, 1e12, 1e6)
    yield "mass ratio 1e12, stiffness ratio 1e6, random, 120, held tail", Chain(m, k, False, True)
    light = [1.0] * 50 + [1e-12] + [1.0] * 50
    yield "one mass of 1e-12", Chain(light, [1.0] * 100, True)
    heavy = [1.0] * 50 + [1e12] + [1.0] * 50
    yield "one mass of 1e12", Chain(heavy, [1.0] * 100, True)
    stiff = [1.0] * 50 + [1e12] + [1.0] * 50
    yield "one spring of 1e12", Chain([1.0] * 102, stiff, True)
    soft = [1.0] * 50 + [1e-12] + [1.0] * 50
    yield "one spring of 1e-12, equal halves", Chain([1.0] * 102, soft, bits=800)
    graded = [10.0 ** (-12 * i / 99) for i in range(100)]
    yield "masses falling evenly by 1e12", Chain(graded, [1.0] * 99, True)
    yield "masses rising evenly by 1e12", Chain(graded[::-1], [1.0] * 99, True)
    drawbars = [1e9 if i % 10 == 4 else 1.0 for i in range(99)]
    yield "drawbars 1e9 in every tenth place", Chain([1.0] * 100, drawbars, True, bits=1500)


if __name__ == "__main__":
    out = []
    for name, chain in chains():
        gmpy2.get_context().precision = chain.bits
        omega = [digits(gmpy2.sqrt(x), 36) for x in chain.eigenvalues()]
        out.append(
            {
                "name": name,
                "mass": chain.mass,
                "stiffness": chain.stiffness,
                "held_head": chain.held_head,
                "held_tail": chain.held_tail,
                "omega": omega,
            }
        )
        print(name, file=sys.stderr)
    write(os.path.join(os.path.dirname(__file__), "frequencies.json"), out)
