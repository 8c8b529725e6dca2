"""Damped, struck and breaking trains in 40-digit arithmetic: writes motions.json beside itself. Needs mpmath.

Another way than the program's: displacements and speeds of the masses with the forces from outside that hold the steady
state, carried on by series of the whole state; what a coupler carries is read off, and a coupler that passes its rating is taken
out. Crossings and extremes are bracketed on a grid of instants and closed in on by bisection.
"""

import json
import os

from mpmath import matrix, mp, mpf

mp.dps = 40


class Train:
    def __init__(self, case):
        self.case = case
        self.m = [mpf(x) for x in case["mass"]]
        self.k = [mpf(x) for x in case["stiffness"]]
        self.c = [mpf(x) for x in case["dashpot"]]
        self.load = [mpf(x) for x in case["initial"]]
        self.n = len(self.m)
        self.whole = [i not in case["broken"] for i in range(self.n - 1)]
        self.held = [False] * self.n
        self.held[0], self.held[-1] = case["held_head"], case["held_tail"]
        # Displacements that make the load, speeds as given, and a last entry of 1 for the forces from outside.
        x, z = mpf(0), []
        for i in range(self.n):
            z.append(x)
            if i < self.n - 1:
                x -= self.load[i] / self.k[i]
        self.start = matrix(z + [mpf(v) for v in case["velocity"]] + [mpf(1)])
        padded = [mpf(0)] + self.load + [mpf(0)]
        self.outside = [padded[v + 1] - padded[v] for v in range(self.n)]

    def row(self, i):
        """Force in coupler i as a row on the state."""
        row = matrix(1, 2 * self.n + 1)
        if self.whole[i]:
            row[i], row[i + 1] = self.k[i], -self.k[i]
            row[self.n + i], row[self.n + i + 1] = self.c[i], -self.c[i]
        return row

    def rates(self):
        size = 2 * self.n + 1
        a = matrix(size, size)
        for v in range(self.n):
            a[v, self.n + v] = 1
            if self.held[v]:
                continue
            for i, sign in ((v - 1, 1), (v, -1)):
                if 0 <= i < self.n - 1:
                    row = self.row(i)
                    for j in range(size):
                        a[self.n + v, j] += sign * row[j] / self.m[v]
            a[self.n + v, size - 1] += self.outside[v] / self.m[v]
        return a


def dot(row, z):
    return sum(row[j] * z[j] for j in range(len(z)))


TERMS = 27  # of a Taylor series over a step of 1/20: the rates are under 10, so 0.5^27 / 27! is under 1e-36


def series(a, z):
    """Terms of the state's Taylor series."""
    terms = [z]
    for k in range(1, TERMS):
        terms.append((a * terms[-1]) / k)
    return terms


def value(poly, t):
    total = mpf(0)
    for c in reversed(poly):
        total = total * t + c
    return total


def bisect(f, lo, hi):
    sign = f(lo) < 0
    for _ in range(110):
        mid = (lo + hi) / 2
        if (f(mid) < 0) == sign:
            lo = mid
        else:
            hi = mid
    return (lo + hi) / 2


def play(case):
    train = Train(case)
    horizon, z, t = mpf(case["horizon"]), train.start, mpf(0)
    h = mpf(1) / 20
    springs = range(train.n - 1)
    peaks = [[mpf(0), mpf(0)] for _ in springs]
    events, samples, wanted = [], [], [mpf(s) for s in case["times"]]

    def see(forces):
        for i in springs:
            if train.whole[i]:
                peaks[i][0] = max(peaks[i][0], forces[i])
                peaks[i][1] = max(peaks[i][1], -forces[i])

    see(train.load)
    while t < horizon:
        width = min(h, horizon - t)
        a, rows = train.rates(), [train.row(i) for i in springs]
        terms = series(a, z)
        polys = [[dot(r, term) for term in terms] for r in rows]
        slopes = [[k * p[k] for k in range(1, TERMS)] for p in polys]
        turns, found = [[] for _ in springs], None
        for i in springs:
            if train.whole[i] and value(slopes[i], mpf(0)) * value(slopes[i], width) < 0:
                turns[i] = [bisect(lambda s: value(slopes[i], s), mpf(0), width)]
        for i in springs:
            for sign, rated in ((1, case["rated_draft"][i]), (-1, case["rated_buff"][i])):
                if not train.whole[i] or case["rule"] == "keep" or (case["rule"] == "draft" and sign < 0):
                    continue
                over = lambda s: sign * value(polys[i], s) - mpf(rated)
                points = [mpf(0)] + turns[i] + [width]
                for lo, hi in zip(points, points[1:]):
                    if over(lo) <= 0 < over(hi):
                        at = bisect(over, lo, hi)
                        if found is None or at < found[0]:
                            found = (at, i)
                        break
        end = width if found is None else found[0]
        for i in springs:
            for s in [mpf(0)] + turns[i] + [end]:
                if s <= end:
                    see([value(polys[i], s) if j == i else mpf(0) for j in springs])
        while wanted and t <= wanted[0] <= t + end:
            samples.append([value(p, wanted[0] - t) for p in polys])
            wanted.pop(0)
        z = terms[-1]
        for term in reversed(terms[:-1]):
            z = z * end + term
        t += end
        if found is not None:
            i = found[1]
            events.append({"time": mp.nstr(t, 25), "spring": i, "force": mp.nstr(value(polys[i], end), 25)})
            train.whole[i] = False
    out = dict(case)
    out["events"] = events
    out["peaks"] = [[mp.nstr(p, 25) for p in pair] for pair in peaks]
    out["samples"] = [[mp.nstr(f, 25) for f in row] for row in samples]
    return out


M = [3.25, 1.0, 0.375, 1.5, 1.0, 2.125]
K = [1.0, 2.5, 0.75, 1.25, 4.0]
C = [0.5, 0.0, 0.25, 1.75, 0.125]
LOAD = [0.875, 0.75, 0.625, 0.375, 0.25]
ZERO = [0.0] * 5
BASE = {"mass": M, "stiffness": K, "dashpot": C, "initial": LOAD, "velocity": [0.0] * 6, "broken": [], "held_head": False,
        "held_tail": False, "rated_draft": [9.0] * 5, "rated_buff": [9.0] * 5, "rule": "keep", "horizon": 20.0,
        "times": [0.5, 1.75, 4.0, 8.25, 13.0, 19.5]}
CASES = [
    {**BASE, "name": "dashpots of no proportion, break", "broken": [2]},
    {**BASE, "name": "dashpots, held head, break at the tail", "broken": [4], "held_head": True},
    {**BASE, "name": "dashpots, both held, break", "broken": [1], "held_head": True, "held_tail": True},
    {**BASE, "name": "dashpots, struck at the tail", "initial": ZERO, "velocity": [0.0] * 4 + [0.75] * 2},
    {**BASE, "name": "cascade without damping, held head", "dashpot": ZERO, "broken": [4], "held_head": True,
     "initial": [0.75] * 5, "rated_draft": [0.875, 1.0, 0.875, 0.875, 0.875], "rule": "draft"},
    {**BASE, "name": "cascade with dashpots, struck at the head", "initial": ZERO,
     "velocity": [-1.0, -1.0, 0.0, 0.0, 0.0, 0.0], "rated_draft": [0.25] * 5, "rated_buff": [1.5] * 5, "rule": "both"},
    {**BASE, "name": "cascade with dashpots, struck hard", "initial": ZERO, "velocity": [0.0] * 5 + [2.0],
     "rated_draft": [0.125, 0.25, 0.25, 0.25, 0.5], "rated_buff": [0.5, 0.75, 1.0, 9.0, 9.0], "rule": "both"},
]

if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, "motions.json"), "w") as out:
        json.dump([play(case) for case in CASES], out, indent=1)
        out.write("\n")
