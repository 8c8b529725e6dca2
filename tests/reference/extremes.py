"""Extreme trains, in 120 digits and more: writes extremes.json.

Run: pip install gmpy2 numpy; python3 tests/reference/extremes.py        (some minutes)
Scenes that the file holds already are kept, but for those whose names begin with an argument; `all` makes all anew.
"""

import json
import os
import sys

import gmpy2

from chain import Chain, Scene, write
from unequal import INF, mixed


def step(chain, source, horizon, force=0.7, load=0.7, rated=1.0, duration=INF):
    return Scene(chain, source, force, duration, load, rated, rated, horizon)


def ratios():
    thirty = ([1.0, 1e-12] * 15)
    # The light mass turns 1e6 times faster than the others: a short horizon holds hundreds of its periods.
    yield "mass ratio 1e12, alternating, step on a light mass", step(Chain(thirty, [1.0] * 29, True), 29, 0.004)
    yield "mass ratio 1e12, alternating, step on a heavy mass", step(Chain(thirty[::-1], [1.0] * 29, True), 29, 60.0)
    yield "mass ratio 1e12, alternating, free, pulse", step(Chain(thirty, [1.0] * 29), 14, 60.0, duration=2.5)
    light = [1.0] * 15 + [1e-12] + [1.0] * 14
    heavy = [1.0] * 15 + [1e12] + [1.0] * 14
    yield "one mass of 1e-12", step(Chain(light, [1.0] * 29, True), 29, 120.0)
    yield "one mass of 1e-12, step on it", step(Chain(light, [1.0] * 29), 15, 0.004)
    yield "one mass of 1e12", step(Chain(heavy, [1.0] * 29, True), 29, 120.0)
    yield "one mass of 1e12, step on it", step(Chain(heavy, [1.0] * 29, True), 15, 120.0, force=-0.7)
    springs = ([1.0, 1e12] * 15)[:29]
    yield "stiffness ratio 1e12, alternating", step(Chain([1.0] * 30, springs, True), 29, 60.0)
    yield "stiffness ratio 1e12, alternating, free", step(Chain([1.0] * 30, springs), 0, 60.0, force=-0.7)
    stiff = [1.0] * 14 + [1e12] + [1.0] * 14
    soft = [1.0] * 14 + [1e-12] + [1.0] * 14
    yield "one spring of 1e12", step(Chain([1.0] * 30, stiff, True), 29, 120.0)
    yield "one spring of 1e12, step beside it", step(Chain([1.0] * 30, stiff, True), 15, 30.0)
    yield "one spring of 1e-12", step(Chain([1.0] * 30, soft, True), 29, 120.0)
    m = [1e5] * 50 + [1.0] + [1e5] * 50
    yield "1 kg in 10000 t", step(Chain(m, [3e7] * 100, True), 100, 8.0, force=0.7e6, load=0.7e6, rated=1.5e6)
    yield "1 kg in 10000 t, break beside it", step(Chain(m[:51], [3e7] * 50, True), 50, 8.0, force=0.7e6, load=0.7e6, rated=1.5e6)
    for stiffness in (1e4, 1e9):
        springs = [stiffness if i % 10 == 4 else 1.0 for i in range(59)]
        c = Chain([1.0] * 60, springs, True, bits=1200)
        yield f"drawbars {stiffness:.0e} in every tenth place", step(c, 59, 160.0)
        yield f"drawbars {stiffness:.0e}, pulse inside", step(c, 30, 160.0, duration=4.2)


def times():
    m, k = mixed(12, 5, 5.0, 3.0)
    yield "horizon 1e6, equal", step(Chain([1.0] * 11, [1.0] * 10, True), 10, 1e6)
    yield "horizon 1e6, unequal", step(Chain(m, k), 0, 1e6, force=-0.7)
    m, k = mixed(20, 6, 5.0, 3.0)
    c = Chain(m, k, True)
    omega = [gmpy2.sqrt(x) for x in c.eigenvalues()]
    period = lambda j: float(2 * gmpy2.const_pi() / omega[j])
    short = 1e-9 * period(len(omega) - 1)
    yield "pulse of 1e-9 of a period", step(c, 10, 80.0, load=0.99999999, force=1.0, duration=short)
    yield "pulse of 1e-9 of a period, hard", step(c, 10, 80.0, load=0.3, force=2e9, duration=short)
    yield "pulse of a period of a mode", step(c, 19, 80.0, load=0.0, duration=period(2), rated=0.9)
    yield "pulse of the fastest mode's period", step(c, 10, 80.0, load=0.0, duration=period(-1), rated=0.5)
    yield "pulse longer than the horizon", step(c, 19, 30.0, load=0.0, duration=30.5, rated=0.9)
    yield "pulse as long as the horizon", step(c, 19, 30.0, load=0.0, duration=30.0, rated=0.9)


def few():
    yield "one coupler, held head", step(Chain([1.0, 2.0], [3.0], True), 1, 10.0)
    yield "one coupler, free", step(Chain([1.0, 2.0], [3.0]), 0, 10.0, force=-0.7)
    yield "one coupler, free, pulse", step(Chain([1.0, 2.0], [3.0]), 1, 10.0, duration=0.8, load=0.0, rated=0.3)
    yield "two couplers, equal", step(Chain([1.0] * 3, [1.0] * 2, True), 2, 20.0)
    yield "two couplers, both held", step(Chain([1.0, 2.0, 1.0], [1.0, 3.0], True, True), 1, 20.0)
    yield "two couplers, unequal, free", step(Chain([1.0, 2.0, 5.0], [1.0, 3.0]), 2, 20.0)


def alike():
    half, springs = mixed(10, 7, 3.0, 2.0)
    for soft in (1e-8, 1e-16, 1e-40):
        c = Chain(half + half[::-1], springs + [soft] + springs[::-1], bits=1000)
        yield f"equal halves joined by {soft:.0e}", step(c, 0, 80.0, force=-0.7)
    # Blocks of equal masses walled off by masses of 1e14: frequencies agree to 1e-14 and less.
    block = [1.0, 2.0, 1.5]
    m = (block + [1e14]) * 4 + block
    yield "equal blocks between walls", step(Chain(m, [1.0] * (len(m) - 1), True, bits=1000), len(m) - 1, 60.0)


# Of a long chain of the same few kinds of springs a handful says all.
WATCHED = {"mass ratio 1e12, alternating, step on a light mass": [0, 14, 27, 28]}


def main(beginnings):
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "extremes.json")
    known = {}
    if os.path.exists(path):
        with open(path) as file:
            known = {r["name"]: r for r in json.load(file)}
    out = []
    for name, scene in [*few(), *times(), *alike(), *ratios()]:
        if name in known and beginnings != ['all'] and not any(name.startswith(b) for b in beginnings):
            out.append(known[name])
            continue
        print(name, file=sys.stderr, flush=True)
        h = scene.horizon
        times_of_values = [0.013 * h, 0.21 * h, 0.5003 * h, h]
        out.append(scene.record(name, times_of_values, springs=WATCHED.get(name)))
        write(path, out)
    write(path, out)


if __name__ == "__main__":
    main(sys.argv[1:])
